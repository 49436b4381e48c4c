// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The error of interpolants. Included once per target of Highway.
#if defined(FFD_SIMD_CHECK_POINTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_CHECK_POINTS_INL_H_
#undef FFD_SIMD_CHECK_POINTS_INL_H_
#else
#define FFD_SIMD_CHECK_POINTS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTileSegment.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdNodes-inl.h"
#include "FFDSimdPullBack-inl.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Check points between the nodes: their columns and rows in the square, and s along the rays.
struct CheckSet
{
  float Across[4];
  float Along[4];
};
/// The points of the first set are near the largest errors of interpolants of smooth functions.
constexpr CheckSet CheckSets[3] = { { { 0.12f, 0.39f, 0.61f, 0.88f },
                                      { 0.08f, 0.36f, 0.64f, 0.94f } },
  { { 0.06f, 0.22f, 0.5f, 0.93f }, { 0.04f, 0.19f, 0.55f, 0.98f } },
  { { 0.17f, 0.45f, 0.79f, 0.96f }, { 0.13f, 0.45f, 0.72f, 0.88f } } };

/**
 * The errors of the pull-backs of check points. For the kinds that invert T they are steps of
 * Newton's method, whose Jacobian is found for the first points of a segment; after that each point
 * takes that of the point which had about the same s, in its own column of the square.
 */
class PullBackErrors
{
public:
  /// Keeps references.
  PullBackErrors(const PacketScene& scene, CastStatistics& statistics)
    : Scene(scene)
    , Statistics(statistics)
  {
  }

  /// `turn`: of the points of a set, see CheckPoints.
  void Begin(int turn)
  {
    if (this->Begun++ > 0 && InvertsTheField(this->Scene.Kind))
    {
      const std::size_t other = NodesPerSide * static_cast<std::size_t>(turn);
      for (std::size_t row = 0; row < 3; ++row)
      {
        for (std::size_t a = 0; a < 3; ++a)
        {
          for (std::size_t i = 0; i < TileNodes; i += NodesPerSide)
          {
            std::copy_n(&this->FirstRows[row][a][i ^ other], NodesPerSide, &this->Rows[row][a][i]);
          }
        }
      }
    }
  }

  /// The errors of q as Phi(p), of the points from `first` on; to first order if T is inverted.
  HWY_INLINE Vec3 Find(const Vec3& p, const Vec3& q, std::size_t first)
  {
    const PacketScene& scene = this->Scene;
    this->Statistics.Evaluations += static_cast<std::int64_t>(hn::Lanes(Df()));
    if (!InvertsTheField(scene.Kind))
    {
      return Sub(EvaluateForward(scene, p), q);
    }
    const Vec3 rest = MirrorAt(scene, p, q);
    if (this->Begun == 1)
    {
      const NewtonStep step = FindNewtonStep(scene.Field, p, rest);
      for (std::size_t row = 0; row < 3; ++row)
      {
        StoreNodes(Scale(step.Inverse, step.Rows[row]), this->FirstRows[row], first);
      }
      return step.Delta;
    }
    const Vec3 residual = Add(Sub(rest, p), Displacement(scene.Field, rest));
    const auto along = [&](std::size_t row) {
      return Dot(residual, LoadNodes(this->Rows[row], first));
    };
    return { along(0), along(1), along(2) };
  }

private:
  const PacketScene& Scene;
  CastStatistics& Statistics;
  int Begun = 0;                        ///< turns
  alignas(64) NodeVectors FirstRows[3]; ///< of J_T^-1
  alignas(64) NodeVectors Rows[3];      ///< in the order of the points of the turn
};

/// The points between the nodes of a segment where its error is measured.
class CheckPoints
{
public:
  static constexpr int Turns = 4;

  CheckPoints(const PacketScene& scene, const RootRays& rays, const TileSegment& segment, int set,
    PullBackErrors& errors)
    : Scene(scene)
    , Segment(segment)
    , Along(CheckSets[set].Along)
    , Rays(rays.Find(segment, CheckSets[set].Across))
    , Errors(errors)
  {
    const NodePositions positions(CheckSets[set].Across);
    for (std::size_t k = 0; k < TileLayers; ++k)
    {
      TransformNodes(segment.Terms[k], positions.Weight, positions.Weight, this->Terms[k]);
    }
  }

  /// The longest error at the points, voxels; huge if one is not a number. A point has four values
  /// of s, one a turn: that of the turn n is the first one of the point n rows away (by exclusive
  /// or).
  HWY_NOINLINE float FindError(int turn) const
  {
    const Df d;
    const PacketScene& scene = this->Scene;
    Vf largest = hn::Zero(d);
    HWY_ALIGN float at[TileNodes];
    for (int i = 0; i < TileNodes; ++i)
    {
      at[i] = this->Along[i % NodesPerSide ^ i / NodesPerSide ^ turn];
    }
    this->Errors.Begin(turn);
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vf s = hn::Load(d, at + i);
      const Vec3 q = LoadQuartic(this->Terms, i).At(s);
      const Vec3 p =
        this->Rays.At(hn::MulAdd(s, Splat(this->Segment.Dt), Splat(this->Segment.T0)), i);
      const Vec3 error =
        Transform(scene.LocalToIndex, this->Errors.Find(p, WholeToLocal(scene, q), i));
      const Vf length = Dot(error, error);
      // Comparisons with what is not a number are false.
      const Vf huge = Splat(1e20f);
      largest = hn::Max(largest, hn::IfThenElse(hn::Lt(length, huge), length, huge));
    }
    return std::sqrt(LargestLane(largest));
  }

private:
  const PacketScene& Scene;
  const TileSegment& Segment;
  const float* Along;
  NodeRays Rays;
  PullBackErrors& Errors;
  alignas(64) NodeLayers Terms;
};

/// Measures the error of the interpolants of segments.
class InterpolantError
{
public:
  /// Keeps references to all but `rays`.
  InterpolantError(const PacketScene& scene, const RootRays& rays, CastStatistics& statistics)
    : Scene(scene)
    , Rays(rays)
    , Statistics(statistics)
  {
  }

  /// The largest error with which the interpolant of a segment is close enough, voxels. To split a
  /// segment of many samples takes little beside these, and leaves a small part of its error:
  /// pictures are then much closer to the true ones.
  HWY_INLINE float FindTolerance(const TileSegment& segment) const
  {
    const bool large = segment.Side * segment.Side * segment.Samples >= ManySamples;
    return (large ? PartForMany : 1.0f) * this->Scene.PositionTolerance;
  }

  /// Estimates the error of the interpolant from few check points, voxels.
  float Estimate(const TileSegment& segment)
  {
    if (this->Scene.Identity)
    {
      return 0.0f;
    }
    PullBackErrors errors(this->Scene, this->Statistics);
    return 2.0f * SafetyFactor *
      CheckPoints(this->Scene, this->Rays, segment, 0, errors).FindError(0);
  }

  /**
   * Measures the error of the interpolant, voxels: the longest Newton step at the check points
   * times the safety factor. The points are evaluated 16 at a time. The measurement ends early when
   * a step is above the tolerance, or when all steps are well below it: the fewer points there have
   * been, the smaller they must be. A segment that extends over several cells of the lattice has
   * more check points.
   */
  HWY_NOINLINE float Measure(const TileSegment& segment, const BezierHull& hull)
  {
    if (this->Scene.Identity)
    {
      return 0.0f;
    }
    const float enough = this->FindTolerance(segment) / SafetyFactor;
    const float cells = this->CountCells(hull);
    const int sets = cells > 4.0f ? 3 : cells > 2.0f ? 2 : 1;
    PullBackErrors errors(this->Scene, this->Statistics);
    float largest = 0.0f;
    for (int set = 0; set < sets; ++set)
    {
      CheckPoints points(this->Scene, this->Rays, segment, set, errors);
      for (int turn = 0; turn < CheckPoints::Turns; ++turn)
      {
        largest = std::max(largest, points.FindError(turn));
        const float seen = static_cast<float>(set * CheckPoints::Turns + turn + 1) /
          static_cast<float>(sets * CheckPoints::Turns);
        if (largest > enough || largest <= 0.5f * seen / static_cast<float>(sets) * enough)
        {
          return SafetyFactor * largest;
        }
      }
    }
    return SafetyFactor * largest;
  }

  /// Whether the derivatives of an interpolant are close enough for normals. An error e that is
  /// zero at nodes a third of a width w apart has a derivative of at most 18 e / w.
  bool HasCloseSlopes(const TileSegment& segment) const
  {
    if (!this->Scene.Shade || segment.Error <= FinestForSlopes * this->Scene.PositionTolerance)
    {
      return true;
    }
    alignas(64) NodeVectors middle;
    alignas(64) NodeVectors end;
    FindLayer(segment.Terms, 0.5f, middle);
    FindLayer(segment.Terms, 1.0f, end);
    const float* m = this->Scene.IndexToLocal;
    const auto length = [m](float x, float y, float z) {
      float squared = 0.0f;
      for (int row = 0; row < 9; row += 3)
      {
        const float along = m[row] * x + m[row + 1] * y + m[row + 2] * z;
        squared += along * along;
      }
      return std::sqrt(squared);
    };
    const auto distance = [&](const NodeVectors& a, std::size_t i, const NodeVectors& b,
                            std::size_t j) {
      return length(b[0][j] - a[0][i], b[1][j] - a[1][i], b[2][j] - a[2][i]);
    };
    const float extent = std::min({ distance(middle, 0, middle, NodesPerSide - 1),
      distance(middle, 0, middle, TileNodes - NodesPerSide),
      distance(segment.Terms[0], 5, end, 5) });
    // Errors are in voxels: data units along the longest edge of one.
    const float edge =
      std::max({ length(1.0f, 0.0f, 0.0f), length(0.0f, 1.0f, 0.0f), length(0.0f, 0.0f, 1.0f) });
    return 18.0f / SafetyFactor * segment.Error * edge <= LargestSlopeError * extent;
  }

private:
  /// The largest Newton step at the check points times this stands for the largest of all points.
  static constexpr float SafetyFactor = 2.0f;
  /// Segments of as many samples of all rays must be closer than the tolerance, by a factor.
  static constexpr int ManySamples = 8192;
  static constexpr float PartForMany = 0.5f;
  /// Largest relative error of the derivatives of an interpolant; they are not checked where the
  /// error of positions is below FinestForSlopes times its tolerance.
  static constexpr float LargestSlopeError = 0.1f;
  static constexpr float FinestForSlopes = 0.1f;

  /// The number of cells of the lattice that a hull extends over, the largest of the axes.
  float CountCells(const BezierHull& hull) const
  {
    float cells = 0.0f;
    for (int a = 0; a < 3; ++a)
    {
      float extent = 0.0f;
      for (int b = 0; b < 3; ++b)
      {
        extent += std::abs(this->Scene.IndexToLocal[3 * a + b]) * (hull.High[b] - hull.Low[b]);
      }
      cells = std::max(cells, extent * std::abs(this->Scene.Field.InverseSpacing[a]));
    }
    return cells;
  }

  const PacketScene& Scene;
  RootRays Rays;
  CastStatistics& Statistics;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
