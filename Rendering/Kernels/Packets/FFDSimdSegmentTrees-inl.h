// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Cuts the rays of a tile into segments. Included once per target of Highway.
#if defined(FFD_SIMD_SEGMENT_TREES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SEGMENT_TREES_INL_H_
#undef FFD_SIMD_SEGMENT_TREES_INL_H_
#else
#define FFD_SIMD_SEGMENT_TREES_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"
#include "FFDSamplePhase.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Viewing rays through the 4 x 4 nodes of a square of pixels, the outermost pixels included.
struct NodeRays
{
  alignas(64) NodeVectors Origins;    ///< local coordinates
  alignas(64) NodeVectors Directions; ///< local coordinates per unit of t

  /// (x0, y0): first pixel of the square; `at`: columns and rows of the nodes, 0 to 1.
  NodeRays(const ImageMap& near, const ImageMap& far, int x0, int y0, int side, const float at[4])
  {
    const Df d;
    HWY_ALIGN float x[TileNodes];
    HWY_ALIGN float y[TileNodes];
    // Rounded as in the whole image: taking its columns and rows off again is exact.
    const float left = near.Column + static_cast<float>(x0) + 0.5f;
    const float low = near.Row + static_cast<float>(y0) + 0.5f;
    for (int i = 0; i < TileNodes; ++i)
    {
      x[i] = left + at[i % NodesPerSide] * static_cast<float>(side - 1) - near.Column;
      y[i] = low + at[i / NodesPerSide] * static_cast<float>(side - 1) - near.Row;
    }
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      Vf unused;
      const RayPacket rays = MakeRays(near, far, hn::Load(d, x + i), hn::Load(d, y + i), unused);
      StoreNodes(rays.Origin, this->Origins, i);
      StoreNodes(rays.Direction, this->Directions, i);
    }
  }

  HWY_INLINE Vec3 At(Vf t, std::size_t first) const
  {
    return MulAdd(t, LoadNodes(this->Directions, first), LoadNodes(this->Origins, first));
  }
};

/// Positions of the columns and rows of nodes in the square, 0 to 1.
constexpr float NodeAt[4] = { 0.0f, 1.0f / 3.0f, 2.0f / 3.0f, 1.0f };

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
 * Cuts the rays of a tile into segments. The longest segments, of a square of tiles, are the roots
 * of trees, which grow front to back as rays reach them, so that nothing is evaluated behind the
 * point where all rays have ended. Where segments begin and end depends on the square and the
 * deformation alone; where samples lie does not depend on the segments.
 *
 * In a segment an interpolant with exact nodes replaces the pull-back. Its error is measured as the
 * length of a Newton step at check points between the nodes, times a safety factor. A segment whose
 * error is too large is halved along the rays or quartered across them. One of several tiles is
 * quartered where it is close enough, too: its quarters have the same interpolant.
 */
class SegmentTrees
{
public:
  /// (x0, y0): first pixel of the roots. `near` and `far` are kept by pointer.
  SegmentTrees(const PacketScene& scene, PacketScratch& scratch, const ImageMap& near,
    const ImageMap& far, int x0, int y0)
    : Scene(scene)
    , Scratch(scratch)
    , Near(near)
    , Far(far)
    , X0(x0)
    , Y0(y0)
  {
    scratch.Roots.Begin(scene.Number, x0, y0);
  }

  /// Sets the range of t of all rays of the tile.
  void Start(float tMin, float tMax)
  {
    const double length = this->Scene.SamplesPerRoot * this->Scene.Settings.SampleDistance;
    // A ray takes samples that lie a little before its range, see SampleSlack, but for the near
    // plane.
    const double around = 2.0 * SampleSlack * this->Scene.Settings.SampleDistance;
    this->First = static_cast<int>(std::floor(std::max(tMin - around, 0.0) / length));
    this->Last = static_cast<int>(std::floor((tMax + around) / length));
  }

  /// First pixel of the roots.
  int GetX() const { return this->X0; }
  int GetY() const { return this->Y0; }

  int GetFirst() const { return this->First; }
  int GetLast() const { return this->Last; }

  /// The root number `index`, GetFirst() to GetLast().
  HWY_INLINE TileSegment& GetRoot(int index)
  {
    TileSegment*& root = this->Scratch.Roots.At(index);
    if (HWY_UNLIKELY(!root))
    {
      root = &this->MakeRoot(index);
    }
    return *root;
  }

  /// Whether the interpolant of a root is close enough.
  bool IsRootClose(int index)
  {
    const TileSegment& root = this->GetRoot(index);
    return root.Known == TileSegment::State::Unknown &&
      this->MeasureError(root, BezierHull(root.Terms)) <= this->Scene.PositionTolerance;
  }

  /// The state of a segment, found on first use.
  HWY_INLINE TileSegment::State Find(TileSegment& segment)
  {
    if (HWY_UNLIKELY(segment.Known == TileSegment::State::Unknown))
    {
      this->Expand(segment);
    }
    return segment.Known;
  }

  /// Makes TileSegment::Needed and Inside of a part known.
  HWY_INLINE void NeedPart(TileSegment& segment, int part)
  {
    while (HWY_UNLIKELY(segment.KnownParts <= part))
    {
      this->FindMoreParts(segment);
    }
  }

  /// Makes TileSegment::Columns known.
  HWY_INLINE void NeedColumns(TileSegment& segment)
  {
    if (HWY_UNLIKELY(!segment.HasColumns))
    {
      this->FindColumns(segment);
    }
  }

  /// The spread of the rays of the packet at (x, y) of the roots, whose pixels are in `rows` from y
  /// on.
  HWY_NOINLINE RaySpread FindSpread(int x, int y, Vf rows, const RayPacket& rays) const
  {
    const Df d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    HWY_ALIGN float columns[16];
    for (int lane = 0; lane < lanes; ++lane)
    {
      columns[lane] = static_cast<float>(lane % std::min(lanes, 4));
    }
    const Vf px = hn::Add(hn::Load(d, columns), Splat(static_cast<float>(this->X0 + x) + 0.5f));
    const Vf py = hn::Add(rows, Splat(static_cast<float>(this->Y0 + y) + 0.5f));
    return RaySpread(this->Near, this->Far, rays, px, py);
  }

private:
  using Layers = std::array<NodeVectors, TileLayers>;

  /// The largest Newton step at the check points times this stands for the largest of all points.
  static constexpr float SafetyFactor = 2.0f;
  /// Interpolants over several tiles of a smaller error are estimates for their quarters, voxels.
  static constexpr float GoodEstimate = 1.0f;
  /// Errors above this are not known well, voxels.
  static constexpr float LargestKnownError = 20.0f;
  /// Halving has not helped if more than this part of the error is left.
  static constexpr float LittleHelp = 0.3f;
  /// Largest relative error of the derivatives of an interpolant; they are not checked where the
  /// error of positions is below FinestForSlopes times its tolerance.
  static constexpr float LargestSlopeError = 0.1f;
  static constexpr float FinestForSlopes = 0.1f;
  static constexpr int SmallestSide = 4;
  static constexpr float Rounding = 0.01f;
  /// Distance from everything visible, voxels, at which a coarse estimate of the error suffices.
  static constexpr float FarFromVisible = 4.0f;

  void SetTimes(TileSegment& segment, int firstSample, int samples) const
  {
    const double distance = this->Scene.Settings.SampleDistance;
    segment.FirstSample = firstSample;
    segment.Samples = samples;
    segment.T0 = static_cast<float>(firstSample * distance);
    segment.Dt =
      static_cast<float>((firstSample + static_cast<double>(samples)) * distance) - segment.T0;
  }

  NodeRays GetRays(const TileSegment& segment, const float at[4]) const
  {
    return NodeRays(
      this->Near, this->Far, this->X0 + segment.X, this->Y0 + segment.Y, segment.Side, at);
  }

  /// Pulls the nodes at t back to index coordinates of the whole; `layer`: on entry estimates of
  /// them.
  HWY_NOINLINE void Solve(const NodeRays& rays, float t, NodeVectors& layer)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 q = PullBackFrom(this->Scene, rays.At(Splat(t), i),
        WholeToLocal(this->Scene, LoadNodes(layer, i)), this->Scene.NodeTolerance, all,
        this->Scratch.Statistics);
      StoreNodes(LocalToWhole(this->Scene, q), layer, i);
    }
  }

  /// Pulls the layers of a segment back without estimates, front to back; each one is estimated
  /// from those before it. Returns false as soon as nodes of a shared root have no pull-back: it
  /// would not be close enough.
  HWY_NOINLINE bool SolveAnew(const NodeRays& rays, const TileSegment& segment, Layers& layers)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    const float step = 0.25f * segment.Dt;
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 path = Scale(Splat(step), LoadNodes(rays.Directions, i));
      Vec3 q[TileLayers];
      Vec3 move = path;
      for (int k = 0; k < TileLayers; ++k)
      {
        const Vec3 p = rays.At(Splat(segment.T0 + step * static_cast<float>(k)), i);
        // The first layer starts without an estimate, not from the segment before: a segment must
        // not depend on where the rays of a picture, or of a part of one, begin. The next ones
        // start from the polynomial through the layers before, with the derivative of the last one.
        Vec3 start;
        switch (k)
        {
          case 0:
            start = EstimatePullBack(this->Scene, p);
            break;
          case 1:
            start = Add(q[0], move);
            break;
          case 2:
            start = MulAdd(Splat(2.0f), move, q[0]);
            break;
          default:
            start = MulAdd(Splat(3.0f), Add(move, q[k - 2]),
              Scale(Splat(-0.5f), MulAdd(Splat(3.0f), q[k - 1], q[k - 3])));
            break;
        }
        move = path;
        q[k] = PullBackFrom(
          this->Scene, p, start, this->Scene.NodeTolerance, all, this->Scratch.Statistics, &move);
        if (segment.Side > TileSide && !hn::AllFalse(d, IsNowhere(this->Scene, q[k])))
        {
          return false;
        }
        StoreNodes(LocalToWhole(this->Scene, q[k]), layers[static_cast<std::size_t>(k)], i);
      }
    }
    return true;
  }

  HWY_NOINLINE TileSegment& MakeRoot(int index)
  {
    TileSegment& segment = this->Scratch.Roots.Add();
    segment.Side = this->Scene.RootSide;
    segment.X = 0;
    segment.Y = 0;
    this->SetTimes(segment, index * this->Scene.SamplesPerRoot, this->Scene.SamplesPerRoot);
    alignas(64) Layers layers = {};
    const bool found = this->SolveAnew(this->GetRays(segment, NodeAt), segment, layers);
    FitQuartics(layers, segment.Terms);
    if (!found)
    {
      segment.Error = std::numeric_limits<float>::infinity();
      this->Quarter(segment, false);
    }
    return segment;
  }

  /// Solves the layers that are estimates. Errors of a shared interpolant may be so large that its
  /// tiles do better without.
  HWY_NOINLINE void SolveEstimates(TileSegment& segment)
  {
    if (segment.Estimated == TileSegment::Estimates::None)
    {
      return;
    }
    const NodeRays rays = this->GetRays(segment, NodeAt);
    alignas(64) Layers layers;
    const bool all = segment.Estimated == TileSegment::Estimates::All;
    if (all && segment.Side >= TileSide && !(segment.Error < GoodEstimate))
    {
      this->SolveAnew(rays, segment, layers);
    }
    else
    {
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        const float s = 0.25f * static_cast<float>(k);
        FindLayer(segment.Terms, s, layers[k]);
        if (all || k % 2 == 1)
        {
          this->Solve(rays, segment.T0 + s * segment.Dt, layers[k]);
        }
      }
    }
    FitQuartics(layers, segment.Terms);
    segment.Estimated = TileSegment::Estimates::None;
  }

  HWY_NOINLINE void Expand(TileSegment& segment)
  {
    this->SolveEstimates(segment);
    const float tolerance = this->Scene.PositionTolerance;
    const BezierHull hull(segment.Terms);
    // Samples lie on the interpolant, or within its error of it. Far from everything visible a
    // coarse estimate of the error suffices.
    const float before = this->FindStepBefore(segment, hull);
    bool close = segment.IsClose;
    if (!close)
    {
      if (this->IsEmptyBox(hull.Low, hull.High, FarFromVisible + before) &&
        this->EstimateError(segment) + tolerance <= FarFromVisible)
      {
        segment.Known = TileSegment::State::Empty;
        return;
      }
      segment.Error = this->MeasureError(segment, hull);
      close = segment.Error <= tolerance && this->HasCloseSlopes(segment);
    }
    if (segment.Error < LargestKnownError)
    {
      const float margin = (close ? 0.0f : segment.Error + tolerance) + Rounding + before;
      if (this->IsEmptyBox(hull.Low, hull.High, margin))
      {
        segment.Known = TileSegment::State::Empty;
        return;
      }
    }
    if (!close)
    {
      this->Split(segment);
    }
    else if (segment.Side > TileSide)
    {
      this->Quarter(segment, true);
    }
    else
    {
      this->BeginParts(segment, hull);
      segment.Known = TileSegment::State::Curves;
    }
  }

  /// Estimates the error of the interpolant from few check points, voxels.
  float EstimateError(const TileSegment& segment)
  {
    return this->Scene.Identity ? 0.0f
                                : 2.0f * SafetyFactor * CheckPoints(*this, segment, 0).FindError(0);
  }

  /**
   * Measures the error of the interpolant, voxels: the longest Newton step at the check points
   * times the safety factor. The points are evaluated 16 at a time. The measurement ends early when
   * a step is above the tolerance, or when all steps are well below it: the fewer points there have
   * been, the smaller they must be. A segment that extends over several cells of the lattice has
   * more check points.
   */
  HWY_NOINLINE float MeasureError(const TileSegment& segment, const BezierHull& hull)
  {
    if (this->Scene.Identity)
    {
      return 0.0f;
    }
    const float enough = this->Scene.PositionTolerance / SafetyFactor;
    const float cells = this->CountCells(hull);
    const int sets = cells > 2.0f ? 3 : cells > 1.0f ? 2 : 1;
    float largest = 0.0f;
    for (int set = 0; set < sets; ++set)
    {
      CheckPoints points(*this, segment, set);
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

  /// The points between the nodes of a segment where its error is measured.
  class CheckPoints
  {
  public:
    static constexpr int Turns = 4;

    CheckPoints(const SegmentTrees& trees, const TileSegment& segment, int set)
      : Trees(trees)
      , Segment(segment)
      , Along(CheckSets[set].Along)
      , Rays(trees.GetRays(segment, CheckSets[set].Across))
    {
      const NodePositions positions(CheckSets[set].Across);
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        TransformNodes(segment.Terms[k], positions.Weight, positions.Weight, this->Terms[k]);
      }
    }

    /// The longest Newton step at the points, voxels; huge if one is not a number. A point has four
    /// values of s, one a turn.
    HWY_NOINLINE float FindError(int turn) const
    {
      const Df d;
      const PacketScene& scene = this->Trees.Scene;
      Vf largest = hn::Zero(d);
      HWY_ALIGN float at[TileNodes];
      for (int i = 0; i < TileNodes; ++i)
      {
        at[i] = this->Along[(i % 4 + i / 4 + turn) % 4];
      }
      for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
      {
        const Vf s = hn::Load(d, at + i);
        const Vec3 q = LoadQuartic(this->Terms, i).At(s);
        const Vec3 p =
          this->Rays.At(hn::MulAdd(s, Splat(this->Segment.Dt), Splat(this->Segment.T0)), i);
        const Vec3 error = Transform(scene.LocalToIndex,
          FindPullBackError(scene, p, WholeToLocal(scene, q), this->Trees.Scratch.Statistics));
        const Vf length = Dot(error, error);
        // Comparisons with what is not a number are false.
        const Vf huge = Splat(1e20f);
        largest = hn::Max(largest, hn::IfThenElse(hn::Lt(length, huge), length, huge));
      }
      return std::sqrt(LargestLane(largest));
    }

  private:
    const SegmentTrees& Trees;
    const TileSegment& Segment;
    const float* Along;
    NodeRays Rays;
    alignas(64) Layers Terms;
  };

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

  /**
   * Finds the distance from the beginning of the interval that ends at the first sample of a
   * segment to that segment, index units; 0 if samples are classified, not intervals. The sample
   * before lies on another curve, whose speed is nearly the same.
   */
  float FindStepBefore(const TileSegment& segment, const BezierHull& hull) const
  {
    if (!this->Scene.ClassifiesIntervals)
    {
      return 0.0f;
    }
    constexpr float Guard = 1.25f;
    float across[3];
    float up[3];
    float down[3];
    hull.GetSpeeds(across, up, down);
    const float speed = std::max({ up[0], up[1], up[2], down[0], down[1], down[2] });
    return Guard * speed / static_cast<float>(segment.Samples);
  }

  /// Empty-space query of a box, index coordinates of the whole, extended by `margin`.
  bool IsEmptyBox(const float low[3], const float high[3], float margin) const
  {
    glm::dvec3 from;
    glm::dvec3 to;
    bool outside = false;
    for (int a = 0; a < 3; ++a)
    {
      const float shift = this->Scene.IndexShift[a];
      const float first = low[a] - shift - margin;
      const float last = high[a] - shift + margin;
      from[a] = static_cast<double>(first);
      to[a] = static_cast<double>(last);
      outside = outside || last < this->Scene.Lower || first > this->Scene.Upper[a];
    }
    return outside ||
      (this->Scene.LeapsSegments &&
        this->Scene.Source->Distances->IsEmptyIn(from, to, this->Scene.Source->Volume.UpperIndex(),
          static_cast<double>(-this->Scene.Lower)));
  }

  /// Decides what becomes of a segment whose interpolant is not close enough.
  HWY_NOINLINE void Split(TileSegment& segment)
  {
    const float length = segment.Dt * this->Scene.VoxelsPerUnit;
    const float width = this->FindWidth(segment) * this->Scene.VoxelsPerUnit;
    const bool canHalve =
      segment.Samples > 1 && 0.5f * length >= this->Scene.ShortestSegment * 0.999f;
    const bool canQuarter = segment.Side > SmallestSide && width > 0.5f;
    // No interpolant is close enough where T folds or nearly does.
    const float longest = this->Scene.Folds ? 32.0f : 8.0f;
    const bool hopeless = !(segment.Error < 1.0f) && length <= longest && segment.Side <= 16;
    const bool halvedInVain = segment.Error > LittleHelp * segment.ErrorBefore ||
      (segment.Side > TileSide && IsRougherAcross(segment));
    if (hopeless || !(canHalve || canQuarter))
    {
      segment.Known = TileSegment::State::PerSample;
    }
    else if (canQuarter && (!canHalve || halvedInVain || length <= 0.5f * width))
    {
      this->Quarter(segment, false);
    }
    else
    {
      this->Halve(segment);
    }
  }

  /// Whether the cubics across a segment bend so much, compared with the quartics along it, that
  /// halving is likely not to help.
  static bool IsRougherAcross(const TileSegment& segment)
  {
    constexpr float Part = 0.1f;
    float across = 0.0f;
    float along = 0.0f;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const std::array<float, TileNodes>& q = segment.Terms[0][a];
      const auto include = [&](std::size_t first, std::size_t step) {
        const float difference =
          q[first + 3 * step] - q[first] - 3.0f * (q[first + 2 * step] - q[first + step]);
        across = std::max(across, std::abs(difference));
      };
      for (std::size_t i = 0; i < NodesPerSide; ++i)
      {
        include(NodesPerSide * i, 1);
        include(i, NodesPerSide);
      }
      for (float term : segment.Terms[TileLayers - 1][a])
      {
        along = std::max(along, std::abs(term));
      }
    }
    return across > Part * along;
  }

  /// The width of the square of pixels in the middle of the segment, data units.
  float FindWidth(const TileSegment& segment) const
  {
    const NodeRays rays = this->GetRays(segment, NodeAt);
    float squared = 0.0f;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const auto at = [&](std::size_t i) {
        return rays.Origins[a][i] + (segment.T0 + 0.5f * segment.Dt) * rays.Directions[a][i];
      };
      const float path = at(15) - at(0);
      squared += path * path;
    }
    return std::sqrt(0.5f * squared);
  }

  void Halve(TileSegment& segment)
  {
    const int half = segment.Samples / 2;
    for (int h = 0; h < 2; ++h)
    {
      TileSegment& child = this->Scratch.Roots.Add();
      child.Side = segment.Side;
      child.X = segment.X;
      child.Y = segment.Y;
      child.Error = segment.Error;
      child.ErrorBefore = segment.Error;
      child.Estimated = TileSegment::Estimates::Odd;
      this->SetTimes(child, segment.FirstSample + h * half, h == 0 ? half : segment.Samples - half);
      alignas(64) Layers layers;
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        const float s =
          (child.T0 - segment.T0 + 0.25f * static_cast<float>(k) * child.Dt) / segment.Dt;
        FindLayer(segment.Terms, s, layers[k]);
      }
      FitQuartics(layers, child.Terms);
      segment.Children[static_cast<std::size_t>(h)] = &child;
    }
    segment.Known = TileSegment::State::Halved;
  }

  /// `close`: the interpolant is close enough.
  void Quarter(TileSegment& segment, bool close)
  {
    const int half = segment.Side / 2;
    for (int q = 0; q < 4; ++q)
    {
      TileSegment& child = this->Scratch.Roots.Add();
      child.Side = half;
      child.X = segment.X + q % 2 * half;
      child.Y = segment.Y + q / 2 * half;
      this->SetTimes(child, segment.FirstSample, segment.Samples);
      const auto positions = [&](int part) {
        float at[4];
        for (int i = 0; i < 4; ++i)
        {
          at[i] = (static_cast<float>(part * half) + NodeAt[i] * static_cast<float>(half - 1)) /
            static_cast<float>(segment.Side - 1);
        }
        return NodePositions(at);
      };
      const NodePositions x = positions(q % 2);
      const NodePositions y = positions(q / 2);
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        TransformNodes(segment.Terms[k], x.Weight, y.Weight, child.Terms[k]);
      }
      segment.Children[static_cast<std::size_t>(q)] = &child;
      child.Error = segment.Error;
      child.IsClose = close;
      child.Estimated = close ? TileSegment::Estimates::None : TileSegment::Estimates::All;
    }
    segment.Known = TileSegment::State::Quartered;
  }

  /// Finds what FindMoreParts() needs: the curves in the middle of the blocks, and bounds of the
  /// motion along them and of the distance from them.
  HWY_NOINLINE void BeginParts(TileSegment& segment, const BezierHull& hull)
  {
    const Df d;
    segment.SamplesPerPart = std::min(segment.Samples,
      std::max(this->Scene.SamplesPerPart,
        (segment.Samples + LargestNumberOfParts - 1) / LargestNumberOfParts));
    segment.Parts = (segment.Samples + segment.SamplesPerPart - 1) / segment.SamplesPerPart;
    segment.KnownParts = 0;
    float across[3];
    hull.GetSpeeds(across, segment.Up, segment.Down);
    for (int a = 0; a < 3; ++a)
    {
      segment.Radius[a] = across[a] * 0.5f * static_cast<float>(BlockSide - 1) /
          static_cast<float>(segment.Side - 1) +
        2.0f * Rounding;
      segment.Up[a] /= static_cast<float>(segment.Samples);
      segment.Down[a] /= static_cast<float>(segment.Samples);
    }
    const int blocksPerRow = segment.Side / BlockSide;
    const int blocks = blocksPerRow * blocksPerRow;
    const Vf toNodes = Splat(3.0f / static_cast<float>(segment.Side - 1));
    int column = 0;
    int row = 0;
    for (int first = 0; first < blocks; first += static_cast<int>(hn::Lanes(d)))
    {
      HWY_ALIGN float x[16];
      HWY_ALIGN float y[16];
      for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
      {
        constexpr float Middle = 0.5f * static_cast<float>(BlockSide - 1);
        x[lane] = static_cast<float>(column * BlockSide) + Middle;
        y[lane] = static_cast<float>(row * BlockSide) + Middle;
        const bool ends = column + 1 == blocksPerRow;
        column = ends ? 0 : column + 1;
        row += ends ? 1 : 0;
      }
      Vf wx[4];
      Vf wy[4];
      LagrangeWeights(hn::Mul(toNodes, hn::Load(d, x)), wx);
      LagrangeWeights(hn::Mul(toNodes, hn::Load(d, y)), wy);
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        hn::StoreInterleaved4(Interpolate(segment.Terms[k][0].data(), wx, wy),
          Interpolate(segment.Terms[k][1].data(), wx, wy),
          Interpolate(segment.Terms[k][2].data(), wx, wy), hn::Zero(d), d,
          segment.MiddleTerms[k][static_cast<std::size_t>(first)].data());
      }
    }
    std::fill_n(segment.Needed.begin(), blocks, 0u);
    std::fill_n(segment.Inside.begin(), blocks, 0u);
    // Blocks that are too wide for a query of their boxes let their rays leap one by one.
    segment.LeapsRays = this->Scene.Distances != nullptr &&
      (this->Scene.LeapsRays || !BoxQuery::TellsAll(this->FindPartRadius(segment)));
  }

  /// Samples before a part that belong to it: those where its intervals begin.
  int CountSamplesBefore() const { return this->Scene.ClassifiesIntervals ? 1 : 0; }

  /// Bounds of the distances of the positions of a block in a part from its middle, index units.
  std::array<float, 3> FindPartRadius(const TileSegment& segment) const
  {
    std::array<float, 3> radius;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const float steps =
        0.5f * static_cast<float>(segment.SamplesPerPart + this->CountSamplesBefore());
      radius[a] = segment.Radius[a] + steps * std::max(segment.Up[a], segment.Down[a]);
    }
    return radius;
  }

  /// Fills Needed and Inside for the next parts.
  HWY_NOINLINE void FindMoreParts(TileSegment& segment)
  {
    const Df d;
    const Di di;
    const PacketScene& scene = this->Scene;
    const std::array<float, 3> radius = this->FindPartRadius(segment);
    const BoxQuery query(scene, radius);
    // How far the middles of boxes may be from that of the volume: so that boxes reach the samples'
    // box, and so that all voxels exist.
    Vf middles[3];
    Vf reach[3];
    Vf innerMiddles[3];
    Vf inner[3];
    for (int a = 0; a < 3; ++a)
    {
      const float middle = 0.5f * static_cast<float>(scene.Volume.Dimensions[a] - 1);
      const float r = radius[static_cast<std::size_t>(a)];
      middles[a] = Splat(middle);
      reach[a] = Splat(middle - scene.Lower + r);
      innerMiddles[a] = Splat(scene.Grid.InnerMiddle[a]);
      inner[a] = Splat(scene.Grid.InnerReach[a] - r);
    }
    const float samples = static_cast<float>(segment.SamplesPerPart);
    const float extent = 2.0f * std::max({ radius[0], radius[1], radius[2] });
    const float perSample = 1.0f / static_cast<float>(segment.Samples);
    const float toMiddle =
      0.5f * static_cast<float>(segment.SamplesPerPart - this->CountSamplesBefore());
    const int end = std::min(segment.Parts, segment.KnownParts + PartsAtOnce);
    const int blocks = (segment.Side / BlockSide) * (segment.Side / BlockSide);
    for (std::size_t first = 0; first < static_cast<std::size_t>(blocks); first += hn::Lanes(d))
    {
      Quartic curve;
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        Vf unused;
        Vec3& term = curve.Terms[k];
        hn::LoadInterleaved4(
          d, segment.MiddleTerms[k][first].data(), term.x, term.y, term.z, unused);
      }
      curve.Terms[0] = WholeToIndex(scene, curve.Terms[0]);
      const hn::Rebind<std::uint32_t, Df> du;
      auto needed = hn::BitCast(di, hn::Load(du, segment.Needed.data() + first));
      auto inside = hn::BitCast(di, hn::Load(du, segment.Inside.data() + first));
      const Mf blocksHere = hn::FirstN(d, static_cast<std::size_t>(blocks) - first);
      for (int part = segment.KnownParts; part < end; ++part)
      {
        const Vec3 at =
          curve.At(Splat((static_cast<float>(part) * samples + toMiddle) * perSample));
        const Vf q[3] = { at.x, at.y, at.z };
        Mf within = blocksHere;
        Mf seen = blocksHere;
        for (int a = 0; a < 3; ++a)
        {
          const Vf distance = hn::Abs(hn::Sub(q[a], middles[a]));
          within = hn::And(within, hn::Lt(hn::Abs(hn::Sub(q[a], innerMiddles[a])), inner[a]));
          seen = hn::And(seen, hn::Le(distance, reach[a]));
        }
        if (scene.Distances)
        {
          this->Scratch.Statistics.DistanceLookups +=
            static_cast<std::int64_t>(hn::CountTrue(d, seen));
          seen = query.MayShow(at, seen);
        }
        for (std::size_t c = 0; HWY_UNLIKELY(c < scene.Peaks.size()); ++c)
        {
          const ValuePeaks::Grid* const peaks = scene.Peaks[c].Values->FindGrid(extent);
          const Vi codes = peaks
            ? PeaksFrom(*peaks, Sub(at, { Splat(radius[0]), Splat(radius[1]), Splat(radius[2]) }))
            : hn::Set(di, ValuePeaks::LastCode);
          const hn::Rebind<std::uint8_t, Df> du8;
          hn::StoreU(hn::DemoteTo(du8, codes), du8,
            segment.Peaks[c][static_cast<std::size_t>(part)].data() + first);
        }
        const Vi bit = hn::Set(di, static_cast<int>(1u << part));
        needed = hn::Or(needed, hn::IfThenElseZero(hn::RebindMask(di, seen), bit));
        inside = hn::Or(inside, hn::IfThenElseZero(hn::RebindMask(di, within), bit));
      }
      hn::Store(hn::BitCast(du, needed), du, segment.Needed.data() + first);
      hn::Store(hn::BitCast(du, inside), du, segment.Inside.data() + first);
    }
    segment.KnownParts = end;
  }

  static HWY_INLINE Vf Interpolate(const float* nodes, const Vf wx[4], const Vf wy[4])
  {
    Vf sum = hn::Zero(Df());
    for (int j = 0; j < NodesPerSide; ++j)
    {
      sum = hn::MulAdd(wy[j], InterpolateRow(nodes + NodesPerSide * j, wx), sum);
    }
    return sum;
  }

  HWY_NOINLINE void FindColumns(TileSegment& segment) const
  {
    const Df d;
    const float nodesPerPixel = 3.0f / static_cast<float>(segment.Side - 1);
    for (int x = 0; x < segment.Side; x += static_cast<int>(hn::Lanes(d)))
    {
      const Vf u =
        hn::Mul(Splat(nodesPerPixel), hn::Add(hn::Iota(d, 0.0f), Splat(static_cast<float>(x))));
      Vf w[4];
      Vf slope[4];
      LagrangeWeights(u, w);
      LagrangeSlopes(u, slope);
      for (Vf& v : slope)
      {
        v = hn::Mul(v, Splat(nodesPerPixel));
      }
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        for (std::size_t a = 0; a < 3; ++a)
        {
          for (std::size_t j = 0; j < NodesPerSide; ++j)
          {
            const float* row = segment.Terms[k][a].data() + NodesPerSide * j;
            hn::Store(InterpolateRow(row, w), d, segment.Columns[k][a][j].data() + x);
            hn::Store(InterpolateRow(row, slope), d, segment.ColumnSlopes[k][a][j].data() + x);
          }
        }
      }
    }
    segment.HasColumns = true;
  }

  const PacketScene& Scene;
  PacketScratch& Scratch;
  const ImageMap& Near;
  const ImageMap& Far;
  int X0;
  int Y0;
  int First = 0;
  int Last = -1;
};

/// Finds the curves of a packet whose first pixel is in column `x` of the square of a segment, or
/// their derivatives by pixels. `rows`: weights of the rows of nodes, or the slopes of these.
HWY_INLINE Quartic FindPacketCurve(
  const std::array<TileSegment::ColumnTerms, TileLayers>& columns, int x, const Vf rows[4])
{
  const Df d;
  Quartic curve;
  for (std::size_t k = 0; k < TileLayers; ++k)
  {
    const auto component = [&](std::size_t a) {
      const auto row = [&](std::size_t j) {
#if HWY_TARGET == HWY_SCALAR
        return hn::Load(d, columns[k][a][j].data() + x);
#else
        return hn::LoadDup128(d, columns[k][a][j].data() + x);
#endif
      };
      Vf sum = hn::Mul(rows[0], row(0));
      sum = hn::MulAdd(rows[1], row(1), sum);
      sum = hn::MulAdd(rows[2], row(2), sum);
      return hn::MulAdd(rows[3], row(3), sum);
    };
    curve.Terms[k] = { component(0), component(1), component(2) };
  }
  return curve;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
