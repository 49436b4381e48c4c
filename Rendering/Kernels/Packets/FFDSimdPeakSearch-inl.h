// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Finds where the extremes of a packet may lie. Included once per target of Highway.
#if defined(FFD_SIMD_PEAK_SEARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PEAK_SEARCH_INL_H_
#undef FFD_SIMD_PEAK_SEARCH_INL_H_
#else
#define FFD_SIMD_PEAK_SEARCH_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTileSegment.h"

#include "FFDSimdCurve-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPacketSegments-inl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Samples at which a packet found its extremes, by channel: those of the packet beside it are
/// likely to be near them.
struct ExtremeSamples
{
  static constexpr int None = std::numeric_limits<int>::min();
  std::array<int, LargestNumberOfChannels> Numbers{ { None, None, None, None } };
};

/// Knows which parts of segments may hold values above the extremes that the rays of a packet have
/// found so far, by the bounds of the values in each part (ValuePeaks).
class PeakSearch
{
public:
  /// Part of a segment.
  struct Peak
  {
    TileSegment* Segment = nullptr;
    int Part = 0;
    int Code = 0; ///< of ValuePeaks, of the values in it
  };

  /// `extremes`: on entry those of a packet beside this one, or none; later those of this one.
  PeakSearch(const PacketScene& scene, PacketSegments& segments, ExtremeSamples& extremes)
    : Scene(scene)
    , Peaks(scene.Peaks)
    , Segments(segments)
    , Extremes(extremes)
  {
    std::fill_n(this->PassedByRays, LargestNumberOfChannels, hn::Set(Di(), -1));
  }

  /// Finds the channels of which a part may hold values above the extremes of rays, a bit each.
  HWY_INLINE unsigned int FindChannels(const TileSegment& segment, int block, int part) const
  {
    unsigned int channels = 0;
    for (std::size_t c = 0; c < this->Peaks.size(); ++c)
    {
      channels |= CodeOf(segment, c, block, part) > this->PassedCodes[c] ? 1u << c : 0u;
    }
    return channels;
  }

  /// Notes the extremes of a channel that the rays `alive` have found, after a part whose first
  /// sample is n. `single`: also those of each ray, for CountPassed().
  void Note(std::size_t channel, Vf found, Mf alive, int n, bool single)
  {
    const Df d;
    const PacketPeaks& peaks = this->Peaks[channel];
    const float least = SmallestLane(hn::IfThenElse(alive, found, Splat(NoExtreme)));
    const int passed = FindPassed(peaks, least);
    if (passed > this->PassedCodes[channel])
    {
      this->Extremes.Numbers[channel] = n;
    }
    this->PassedCodes[channel] = passed;
    if (single)
    {
      HWY_ALIGN float values[16];
      HWY_ALIGN int codes[16];
      hn::Store(found, d, values);
      for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
      {
        codes[lane] = FindPassed(peaks, values[lane]);
      }
      this->PassedByRays[channel] = hn::Load(Di(), codes);
    }
  }

  /// Finds how many samples, from those of the lanes of `querying` at q, index coordinates, on a
  /// curve, are no larger than the extremes that their rays have found, or beside the volume, for
  /// certain; 0 for other lanes.
  HWY_NOINLINE Vf CountPassed(const PacketCurve& curve, const Vec3& q, Mf querying) const
  {
    const Df d;
    const TileSegment& segment = *curve.Segment;
    const float steps = segment.StepsPerPeak;
    const auto below = [&](Vf x, std::size_t a) {
      return hn::Sub(x, Splat(steps * segment.Down[a] + PeakGuard));
    };
    const auto above = [&](Vf x, std::size_t a) {
      return hn::Add(x, Splat(steps * segment.Up[a] + PeakGuard));
    };
    const Vec3 low{ below(q.x, 0), below(q.y, 1), below(q.z, 2) };
    const Vec3 high{ above(q.x, 0), above(q.y, 1), above(q.z, 2) };
    Mf passed = querying;
    for (std::size_t c = 0; c < this->Peaks.size(); ++c)
    {
      const Vi codes = PeaksFrom(this->Peaks[c].Values->GetFinestGrid(), low);
      passed = hn::AndNot(hn::RebindMask(d, hn::Gt(codes, this->PassedByRays[c])), passed);
    }
    passed = hn::Or(passed, hn::And(querying, AreBesideVolume(this->Scene, low, high)));
    return hn::IfThenElseZero(passed, Splat(steps + 1.0f));
  }

  /**
   * The part in which the packet beside this one found the extreme of a channel or, if there is
   * nothing, that with the largest bound of its values: if it is sampled before all others, few of
   * these can hold larger values. Its Segment is null if no part can hold anything.
   */
  HWY_NOINLINE Peak FindLikelyPart(std::size_t channel)
  {
    Peak peak;
    peak.Code = std::max(0, this->PassedCodes[channel]);
    const int n = this->Extremes.Numbers[channel];
    this->Segments.ForLeavesAt(n, [&](TileSegment& segment) {
      const int offset = n - segment.FirstSample;
      if (offset < 0 || offset >= segment.Samples)
      {
        return true;
      }
      const int part = offset / segment.SamplesPerPart;
      this->FindPeak(segment, { part, part + 1 }, channel, peak);
      return false;
    });
    if (!peak.Segment)
    {
      this->Segments.ForLeaves([&](TileSegment& segment) {
        this->FindPeak(segment, { 0, std::numeric_limits<int>::max() }, channel, peak);
        return true;
      });
    }
    return peak;
  }

private:
  /// The code up to which boxes hold no value above one that was found; -1: there is none.
  static int FindPassed(const PacketPeaks& peaks, float found)
  {
    // In double precision: one value, of what is no number, may be far away from all others.
    const double steps = (double{ found } - peaks.Low) * peaks.Scale;
    const int code = static_cast<int>(std::clamp(steps, 0.0, ValuePeaks::LastCode + 1.0)) - 1;
    return found < peaks.High ? std::min(code, ValuePeaks::LastCode - 1) : code;
  }

  static HWY_INLINE int CodeOf(const TileSegment& segment, std::size_t channel, int block, int part)
  {
    return segment.Peaks[channel][static_cast<std::size_t>(part)][static_cast<std::size_t>(block)];
  }

  /// Makes `peak` the one among parts of a segment without children, as far as they hold samples of
  /// the packet, that has the largest bound of the values of a channel, if that is larger.
  void FindPeak(TileSegment& segment, const PartRange& parts, std::size_t channel, Peak& peak)
  {
    if (segment.Known != TileSegment::State::Curves)
    {
      return;
    }
    const int block = this->Segments.BlockIn(segment);
    const PartRange held = this->Segments.FindParts(segment);
    const int end = std::min(parts.End, held.End);
    const auto find = [&](
                        int from) { return this->Segments.FindNeeded(segment, block, from, end); };
    for (int part = find(std::max(parts.First, held.First)); part < end; part = find(part + 1))
    {
      const int code = CodeOf(segment, channel, block, part);
      if (code > peak.Code)
      {
        peak = { &segment, part, code };
      }
    }
  }

  const PacketScene& Scene;
  const std::vector<PacketPeaks>& Peaks;
  PacketSegments& Segments;
  ExtremeSamples& Extremes;
  /// The codes of ValuePeaks up to which parts hold no value above the extremes of all rays.
  std::array<int, LargestNumberOfChannels> PassedCodes{ { -1, -1, -1, -1 } };
  /// The same for each ray by itself.
  Vi PassedByRays[LargestNumberOfChannels];
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
