// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Parts of segments that are empty for blocks of 4 x 4 rays. Included once per target of Highway.
#if defined(FFD_SIMD_PARTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PARTS_INL_H_
#undef FFD_SIMD_PARTS_INL_H_
#else
#define FFD_SIMD_PARTS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTileSegment.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// What rounding may move positions by, index units.
constexpr float PositionRounding = 0.01f;

/// Empty-space query of a box, index coordinates of the whole, extended by `margin`.
HWY_INLINE bool IsEmptyBox(
  const PacketScene& scene, const float low[3], const float high[3], float margin)
{
  glm::dvec3 from;
  glm::dvec3 to;
  bool outside = false;
  for (int a = 0; a < 3; ++a)
  {
    const float shift = scene.IndexShift[a];
    const float first = low[a] - shift - margin;
    const float last = high[a] - shift + margin;
    from[a] = static_cast<double>(first);
    to[a] = static_cast<double>(last);
    outside = outside || last < scene.Lower || first > scene.Upper[a];
  }
  return outside ||
    (scene.LeapsSegments &&
      scene.Source->Distances->IsEmptyIn(
        from, to, scene.Source->Volume.UpperIndex(), static_cast<double>(-scene.Lower)));
}

/// Tells which parts of segments may show something, for blocks of 4 x 4 rays.
class SegmentParts
{
public:
  /// Keeps references.
  SegmentParts(const PacketScene& scene, CastStatistics& statistics)
    : Scene(scene)
    , Statistics(statistics)
  {
  }

  /// Finds what FindMore() needs: the curves in the middle of the blocks, and bounds of the
  /// motion along them and of the distance from them.
  HWY_NOINLINE void Begin(TileSegment& segment, const BezierHull& hull)
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
        2.0f * PositionRounding;
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
    if (!this->Scene.Peaks.empty())
    {
      this->FindStepsPerPeak(segment);
    }
    // Blocks that are too wide for a query of their boxes let their rays leap one by one.
    segment.LeapsRays = (this->Scene.Distances || !this->Scene.Peaks.empty()) &&
      !BoxQuery::TellsAll(this->FindRadius(segment, 1));
  }

  /// Fills Needed and Inside for the next parts.
  HWY_NOINLINE void FindMore(TileSegment& segment)
  {
    const Df d;
    const Di di;
    const PacketScene& scene = this->Scene;
    const std::array<float, 3> radius = this->FindRadius(segment, 1);
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
    const float extent = 2.0f * std::max({ radius[0], radius[1], radius[2] });
    const float perSample = 1.0f / static_cast<float>(segment.Samples);
    // s in the middle of the parts from `from` on, before `to`.
    const auto middleOf = [&](int from, int to) {
      const int twice = (from + to) * segment.SamplesPerPart - this->CountSamplesBefore();
      return 0.5f * static_cast<float>(twice) * perSample;
    };
    const int end = std::min(segment.Parts, segment.KnownParts + PartsAtOnce);
    const std::array<float, 3> radiusOfAll = this->FindRadius(segment, end - segment.KnownParts);
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
      // One look-up tells of blocks whose next parts all lie in an empty cube.
      Mf open = blocksHere;
      if (scene.Distances)
      {
        const Vec3 middle = curve.At(Splat(middleOf(segment.KnownParts, end)));
        open = hn::AndNot(EmptyCubes(scene, middle).Hold(radiusOfAll), blocksHere);
        this->Statistics.DistanceLookups += static_cast<std::int64_t>(hn::CountTrue(d, blocksHere));
        if (hn::AllFalse(d, open))
        {
          continue;
        }
      }
      for (int part = segment.KnownParts; part < end; ++part)
      {
        const Vec3 at = curve.At(Splat(middleOf(part, part + 1)));
        const Vf q[3] = { at.x, at.y, at.z };
        Mf within = blocksHere;
        Mf seen = open;
        for (int a = 0; a < 3; ++a)
        {
          const Vf distance = hn::Abs(hn::Sub(q[a], middles[a]));
          within = hn::And(within, hn::Lt(hn::Abs(hn::Sub(q[a], innerMiddles[a])), inner[a]));
          seen = hn::And(seen, hn::Le(distance, reach[a]));
        }
        if (scene.Distances)
        {
          this->Statistics.DistanceLookups += static_cast<std::int64_t>(hn::CountTrue(d, seen));
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

private:
  /// Samples before a part that belong to it: those where its intervals begin.
  int CountSamplesBefore() const { return this->Scene.ClassifiesIntervals ? 1 : 0; }

  /// Sets TileSegment::StepsPerPeak, by its speeds. The cells of all channels are of one size.
  void FindStepsPerPeak(TileSegment& segment) const
  {
    constexpr float slowest = 1e-6f;
    const float longest = std::max({ slowest, segment.Up[0] + segment.Down[0],
      segment.Up[1] + segment.Down[1], segment.Up[2] + segment.Down[2] });
    const float edge = this->Scene.Peaks.front().Values->GetFinestGrid().Edge;
    segment.StepsPerPeak = std::floor((edge - 2.0f * PeakGuard) / longest);
  }

  /// Bounds of the distances of the positions of a block in parts that follow each other from their
  /// middle, index units.
  std::array<float, 3> FindRadius(const TileSegment& segment, int parts) const
  {
    std::array<float, 3> radius;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const float steps =
        0.5f * static_cast<float>(parts * segment.SamplesPerPart + this->CountSamplesBefore());
      radius[a] = segment.Radius[a] + steps * std::max(segment.Up[a], segment.Down[a]);
    }
    return radius;
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

  const PacketScene& Scene;
  CastStatistics& Statistics;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
