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

#include "FFDSimdCheckPoints-inl.h"
#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdNodes-inl.h"
#include "FFDSimdParts-inl.h"
#include "FFDSimdRayBounds-inl.h"
#include "FFDSimdRays-inl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

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
  /// (x0, y0): first pixel of the roots.
  SegmentTrees(const PacketScene& scene, PacketScratch& scratch, int x0, int y0)
    : Scene(scene)
    , Scratch(scratch)
    , Rays{ scene.Rays, x0, y0 }
    , Nodes(scene, scratch.Statistics)
    , Error(scene, this->Rays, scratch.Statistics)
    , Parts(scene, scratch.Statistics)
    , SpaceOnDemand(scratch.Positions ? nullptr : scene.Space.get())
    , Space(this->SpaceOnDemand ? this->SpaceOnDemand->Find() : nullptr)
    , NotedEvaluations(scratch.Statistics.Evaluations)
  {
    scratch.Roots.Begin(scene.Number, x0, y0);
  }

  /// Sets the range of t of all rays of the tile.
  void Start(float tMin, float tMax)
  {
    const double length = this->Scene.SamplesPerRoot * this->Scene.Settings.SampleDistance;
    // A ray takes samples that lie a little before its range, see SampleSlack.
    const double around = 2.0 * SampleSlack * this->Scene.Settings.SampleDistance;
    this->First = static_cast<int>(std::floor((tMin - around) / length));
    this->Last = static_cast<int>(std::floor((tMax + around) / length));
  }

  /// First pixel of the roots.
  int GetX() const { return this->Rays.X0; }
  int GetY() const { return this->Rays.Y0; }

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
      this->Error.Measure(root, BezierHull(root.Terms)) <= this->Error.FindTolerance(root);
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
      this->Parts.FindMore(segment);
    }
  }

  /// Leaves out the last ones of the samples of rays from `first` on, before `end`, at which
  /// nothing can be seen wherever T^-1 leads; returns their new end.
  int FindEndOfSight(const RayPacket& rays, int first, int end) const
  {
    constexpr int few = 4;
    if (!this->Space)
    {
      return end;
    }
    RayBounds bounds(this->Scene.Rays.EyeDistance);
    bounds.Include(rays.Origin, rays.Direction);
    for (; end > first; end -= few)
    {
      const double to = end * this->Scene.Settings.SampleDistance;
      if (bounds.Meet(*this->Space, this->FindSightFrom(std::max(first, end - few)),
            static_cast<float>(to), BoxLength / this->Scene.VoxelsPerUnit))
      {
        return end;
      }
    }
    return first;
  }

  /// Notes what has been evaluated since: much of that makes VisibleSpace pay.
  void NoteWork()
  {
    if (this->SpaceOnDemand)
    {
      const std::int64_t evaluations = this->Scratch.Statistics.Evaluations;
      this->SpaceOnDemand->NoteWork(evaluations - this->NotedEvaluations);
      this->NotedEvaluations = evaluations;
      this->Space = this->SpaceOnDemand->Find();
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
    const Vf px =
      hn::Add(hn::Load(d, columns), Splat(static_cast<float>(this->Rays.X0 + x) + 0.5f));
    const Vf py = hn::Add(rows, Splat(static_cast<float>(this->Rays.Y0 + y) + 0.5f));
    return RaySpread(this->Scene.Rays, rays, px, py);
  }

private:
  /// Interpolants over several tiles of a smaller error are estimates for their quarters, voxels.
  static constexpr float GoodEstimate = 1.0f;
  /// Errors above this are not known well, voxels.
  static constexpr float LargestKnownError = 20.0f;
  /// Halving has not helped if more than this part of the error is left.
  static constexpr float LittleHelp = 0.3f;
  static constexpr int SmallestSide = 4;
  /// So many samples of all rays take less each by itself than the nodes of smaller segments.
  static constexpr int FewSamples = 256;
  /// Rays are looked up in VisibleSpace in boxes of this length, voxels.
  static constexpr float BoxLength = 8.0f;
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

  HWY_NOINLINE TileSegment& MakeRoot(int index)
  {
    TileSegment& segment = this->Scratch.Roots.Add();
    segment.Side = this->Scene.RootSide;
    segment.X = 0;
    segment.Y = 0;
    this->SetTimes(segment, index * this->Scene.SamplesPerRoot, this->Scene.SamplesPerRoot);
    if (this->IsOutOfSight(segment))
    {
      segment.Known = TileSegment::State::Empty;
      return segment;
    }
    alignas(64) NodeLayers layers = {};
    const bool found = this->Nodes.SolveAnew(this->Rays.Find(segment, NodeAt), segment, layers);
    FitQuartics(layers, segment.Terms);
    if (!found)
    {
      segment.Error = std::numeric_limits<float>::infinity();
      this->Quarter(segment, false);
    }
    return segment;
  }

  /// Whether nothing can be seen in a segment, wherever T^-1 leads there.
  HWY_INLINE bool IsOutOfSight(const TileSegment& segment) const
  {
    return HWY_UNLIKELY(this->Space) && !this->MeetsVisible(segment);
  }

  HWY_NOINLINE bool MeetsVisible(const TileSegment& segment) const
  {
    const NodeRays rays = this->Rays.Find(segment, NodeAt);
    RayBounds bounds(this->Scene.Rays.EyeDistance);
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(Df()))
    {
      bounds.Include(LoadNodes(rays.Origins, i), LoadNodes(rays.Directions, i));
    }
    return bounds.Meet(*this->Space, this->FindSightFrom(segment.FirstSample),
      segment.T0 + segment.Dt, BoxLength / this->Scene.VoxelsPerUnit);
  }

  /// The t from which something may be seen at the sample n: the beginning of its interval.
  HWY_INLINE float FindSightFrom(int n) const
  {
    return static_cast<float>((n - 1) * this->Scene.Settings.SampleDistance);
  }

  /// Solves the layers that are estimates. Errors of a shared interpolant may be so large that its
  /// tiles do better without.
  HWY_NOINLINE void SolveEstimates(TileSegment& segment)
  {
    if (segment.Estimated == TileSegment::Estimates::None)
    {
      return;
    }
    const NodeRays rays = this->Rays.Find(segment, NodeAt);
    alignas(64) NodeLayers layers;
    const bool all = segment.Estimated == TileSegment::Estimates::All;
    if (all && segment.Side >= TileSide && !(segment.Error < GoodEstimate))
    {
      this->Nodes.SolveAnew(rays, segment, layers);
    }
    else
    {
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        const float s = 0.25f * static_cast<float>(k);
        FindLayer(segment.Terms, s, layers[k]);
        if (all || k % 2 == 1)
        {
          this->Nodes.Solve(rays, segment.T0 + s * segment.Dt, layers[k]);
        }
      }
    }
    FitQuartics(layers, segment.Terms);
    segment.Estimated = TileSegment::Estimates::None;
  }

  HWY_NOINLINE void Expand(TileSegment& segment)
  {
    if (this->IsOutOfSight(segment))
    {
      segment.Known = TileSegment::State::Empty;
      return;
    }
    this->SolveEstimates(segment);
    const float tolerance = this->Scene.PositionTolerance;
    const BezierHull hull(segment.Terms);
    // Samples lie on the interpolant, or within its error of it. Far from everything visible a
    // coarse estimate of the error suffices.
    const float before = this->FindStepBefore(segment, hull);
    bool close = segment.IsClose;
    if (!close)
    {
      if (IsEmptyBox(this->Scene, hull.Low, hull.High, FarFromVisible + before) &&
        this->Error.Estimate(segment) + tolerance <= FarFromVisible)
      {
        segment.Known = TileSegment::State::Empty;
        return;
      }
      segment.Error = this->Error.Measure(segment, hull);
      close =
        segment.Error <= this->Error.FindTolerance(segment) && this->Error.HasCloseSlopes(segment);
    }
    if (segment.Error < LargestKnownError)
    {
      const float margin = (close ? 0.0f : segment.Error + tolerance) + PositionRounding + before;
      if (IsEmptyBox(this->Scene, hull.Low, hull.High, margin))
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
      this->Parts.Begin(segment, hull);
      segment.Known = TileSegment::State::Curves;
    }
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

  /// Decides what becomes of a segment whose interpolant is not close enough.
  HWY_NOINLINE void Split(TileSegment& segment)
  {
    const float length = segment.Dt * this->Scene.VoxelsPerUnit;
    const float width = this->Rays.FindWidth(segment) * this->Scene.VoxelsPerUnit;
    const bool canHalve =
      segment.Samples > 1 && 0.5f * length >= this->Scene.ShortestSegment * 0.999f;
    const bool canQuarter = segment.Side > SmallestSide && width > 0.5f;
    // No interpolant is close enough where T folds or nearly does.
    const float longest = this->Scene.Folds ? 32.0f : 8.0f;
    const bool hopeless = !(segment.Error < 1.0f) && length <= longest && segment.Side <= 16;
    const bool halvedInVain = length <= this->Scene.LongestPlain &&
      (segment.Error > LittleHelp * segment.ErrorBefore ||
        (segment.Side > TileSide && IsRougherAcross(segment)));
    const bool few = segment.Side * segment.Side * segment.Samples <= FewSamples;
    this->NoteWork();
    if (few || hopeless || !(canHalve || canQuarter))
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
      alignas(64) NodeLayers layers;
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
  RootRays Rays;
  NodeSolver Nodes;
  InterpolantError Error;
  SegmentParts Parts;
  int First = 0;
  int Last = -1;
  VisibleSpaceOnDemand* SpaceOnDemand; ///< null, too, where empty segments are looked at
  const SpaceCells* Space;             ///< null as long as there is none
  std::int64_t NotedEvaluations;       ///< of the thread
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
