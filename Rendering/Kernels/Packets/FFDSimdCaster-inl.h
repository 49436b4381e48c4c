// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Casts the rays of a packet, front to back. Included once per target of Highway.
#if defined(FFD_SIMD_CASTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_CASTER_INL_H_
#undef FFD_SIMD_CASTER_INL_H_
#else
#define FFD_SIMD_CASTER_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"
#include "FFDSamplePhase.h"
#include "FFDTileSegment.h"

#include "FFDSimdBlend-inl.h"
#include "FFDSimdComposite-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSampleFollower-inl.h"
#include "FFDSimdSegmentTrees-inl.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Finds the samples that the rays `active` take, of a phase that is known, and which any of them
/// takes. In blend modes that use intervals the first is the one that holds From.
HWY_INLINE SampleRange FindSamples(
  const PacketScene& scene, const RayPacket& rays, Mf active, SampleNumbers& numbers)
{
  const Vf inverse = Splat(static_cast<float>(1.0 / scene.Settings.SampleDistance));
  // Both ends by the same arithmetic: where one part of a ray ends and another begins, each sample
  // is taken by exactly one of them.
  const auto firstFrom = [&](Vf t, Vf early) {
    return hn::Ceil(hn::Sub(hn::Mul(t, inverse), early));
  };
  const Vf slack = hn::Add(Splat(static_cast<float>(SampleSlack)), numbers.Phase);
  const Vf early = scene.Intervals ? Splat(1.0f - static_cast<float>(SampleSlack)) : slack;
  numbers.First = firstFrom(rays.From, early);
  numbers.Stop = firstFrom(rays.To, slack);
  const Vf big = Splat(1e9f);
  SampleRange range;
  range.IsCast = true;
  range.First = static_cast<int>(SmallestLane(hn::IfThenElse(active, numbers.First, big)));
  range.End = static_cast<int>(LargestLane(hn::IfThenElse(active, numbers.Stop, hn::Neg(big))));
  return range;
}

/// Samples at which a packet found its extremes, by channel: those of the packet beside it are
/// likely to be near them.
struct ExtremeSamples
{
  static constexpr int None = std::numeric_limits<int>::min();
  std::array<int, LargestNumberOfChannels> Numbers{ { None, None, None, None } };
};

/// Casts the rays of a packet: finds the samples that they take, front to back.
template <class T>
class Packet
{
public:
  /**
   * Keeps references to all but the numbers.
   * (x, y): first pixel of the packet, from that of the roots. `rows`: rows of its pixels from y
   * on. `numbers`, `range`: FindSamples(). `extremes`: on entry those of a packet beside it, or
   * none.
   */
  Packet(const PacketScene& scene, SegmentTrees& trees, PacketScratch& scratch,
    const RayPacket& rays, int x, int y, Vf rows, const SampleNumbers& numbers,
    const SampleRange& range, Mf active, ExtremeSamples& extremes)
    : Scene(scene)
    , Trees(trees)
    , Scratch(scratch)
    , Rays(rays)
    , X(x)
    , Y(y)
    , Rows(rows)
    , Numbers(numbers)
    , FirstSample(range.First)
    , EndSample(range.End)
    , Extremes(extremes)
    , Samples(scene, trees, scratch, rays, x, y, rows, active)
    , Blending(scene, scratch, this->Samples)
  {
  }

  const PacketPixels& GetPixels() const { return this->Samples.State.Out; }

  void Cast()
  {
    const int top = this->Scene.SamplesPerRoot;
    const int first = std::max(this->Trees.GetFirst(), FloorDivide(this->FirstSample, top));
    const int last = std::min(this->Trees.GetLast(), FloorDivide(this->EndSample - 1, top));
    for (std::size_t c = 0; HWY_UNLIKELY(c < this->Scene.Peaks.size()); ++c)
    {
      this->SampleLikelyPart(c, first, last);
    }
    const auto cast = [this](TileSegment& segment) { return this->CastSegment(segment); };
    for (int index = first; index <= last; ++index)
    {
      if (!this->ForLeaves(this->Trees.GetRoot(index), cast))
      {
        return;
      }
    }
  }

  /// Does what Cast() does where samples are not composited.
  HWY_NOINLINE void Blend()
  {
    this->Blending.Begin();
    this->Cast();
    this->Blending.End();
  }

  /// Does what Blend() does where rays take one sample, on a plane.
  HWY_NOINLINE void CastSlice()
  {
    this->Blending.Begin();
    this->TakeSliceSample();
    this->Blending.End();
  }

  /// The t at which the last ray has ended; infinite where one went on to the end.
  float GetReach() const { return this->Reach; }

private:
  /// Samples over which single rays are bounded by themselves.
  static constexpr int FewSamples = 8;
  /// Kept between a leap and the faces of an empty cube, index units: rounding errors.
  static constexpr float LeapGuard[3] = { 2e-3f, 2e-3f, 2e-3f };

  /// Tolerance for slices at the faces of the volume and the ends of rays, voxels.
  static constexpr float SliceGuard = 1e-3f;

  static int FloorDivide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

  HWY_INLINE bool HasSamplesIn(const TileSegment& segment) const
  {
    return segment.FirstSample < this->EndSample &&
      segment.FirstSample + segment.Samples > this->FirstSample;
  }

  /// The quarter of a segment that the packet is in.
  HWY_INLINE TileSegment& QuarterOf(const TileSegment& segment) const
  {
    const int half = segment.Side / 2;
    const std::size_t right = this->X - segment.X >= half ? 1 : 0;
    const std::size_t high = this->Y - segment.Y >= half ? 2 : 0;
    return *segment.Children[right + high];
  }

  /// Calls visit(segment) for the segments without children, of a segment, that hold samples of the
  /// packet and something visible, front to back, until it returns false; returns that.
  template <class Visit>
  bool ForLeaves(TileSegment& segment, const Visit& visit)
  {
    if (!this->HasSamplesIn(segment))
    {
      return true;
    }
    switch (this->Trees.Find(segment))
    {
      case TileSegment::State::Empty:
        return true;
      case TileSegment::State::Halved:
        return this->ForLeaves(*segment.Children[0], visit) &&
          this->ForLeaves(*segment.Children[1], visit);
      case TileSegment::State::Quartered:
        return this->ForLeaves(this->QuarterOf(segment), visit);
      default:
        return visit(segment);
    }
  }

  /// Takes the samples of the packet that lie in a segment without children; false where all rays
  /// have ended.
  HWY_NOINLINE bool CastSegment(TileSegment& segment)
  {
    if (segment.Known == TileSegment::State::PerSample)
    {
      this->CastPerSample(segment);
    }
    else
    {
      this->CastCurves(segment, this->FindParts(segment));
    }
    return !hn::AllFalse(Df(), this->Samples.State.Alive);
  }

  /// Finds the first part from `part` on, before `end`, in which something may be visible; `end` or
  /// more if there is none.
  HWY_INLINE int FindNeeded(TileSegment& segment, int block, int part, int end)
  {
    while (part < end)
    {
      this->Trees.NeedPart(segment, part);
      const std::uint32_t needed = segment.Needed[static_cast<std::size_t>(block)] >> part;
      if (needed != 0)
      {
        return part + static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(needed));
      }
      part = segment.KnownParts;
    }
    return part;
  }

  /// Parts of a segment, before End.
  struct PartRange
  {
    int First;
    int End;
  };

  /// The parts of a segment that hold samples of the packet.
  HWY_INLINE PartRange FindParts(const TileSegment& segment) const
  {
    const int samples = std::min(segment.Samples, this->EndSample - segment.FirstSample);
    return { std::max(0, this->FirstSample - segment.FirstSample) / segment.SamplesPerPart,
      (samples + segment.SamplesPerPart - 1) / segment.SamplesPerPart };
  }

  /// The block of a segment that the packet is.
  HWY_INLINE int BlockIn(const TileSegment& segment) const
  {
    return (this->Y - segment.Y) / BlockSide * (segment.Side / BlockSide) +
      (this->X - segment.X) / BlockSide;
  }

  static HWY_INLINE int PeakOf(const TileSegment& segment, std::size_t channel, int block, int part)
  {
    return segment.Peaks[channel][static_cast<std::size_t>(part)][static_cast<std::size_t>(block)];
  }

  /// Finds PassedCodes anew, after a part whose first sample is n.
  HWY_NOINLINE void FindPassedCodes(int n)
  {
    for (std::size_t c = 0; c < this->Scene.Peaks.size(); ++c)
    {
      const int before = this->PassedCodes[c];
      const PacketPeaks& peaks = this->Scene.Peaks[c];
      const float least = SmallestLane(
        hn::IfThenElse(this->Samples.State.Alive, this->Blending.GetExtreme(c), Splat(NoExtreme)));
      // In double precision: one value, of what is no number, may be far away from all others.
      const double steps = (double{ least } - peaks.Low) * peaks.Scale;
      const int code = static_cast<int>(std::clamp(steps, 0.0, ValuePeaks::LastCode + 1.0)) - 1;
      this->PassedCodes[c] = least < peaks.High ? std::min(code, ValuePeaks::LastCode - 1) : code;
      if (this->PassedCodes[c] > before)
      {
        this->Extremes.Numbers[c] = n;
      }
    }
  }

  /// Finds the channels of which a part may hold values above the extremes of rays, a bit each.
  HWY_INLINE unsigned int FindChannels(const TileSegment& segment, int block, int part) const
  {
    unsigned int channels = 0;
    for (std::size_t c = 0; c < this->Scene.Peaks.size(); ++c)
    {
      channels |= PeakOf(segment, c, block, part) > this->PassedCodes[c] ? 1u << c : 0u;
    }
    return channels;
  }

  /// Part of a segment.
  struct Peak
  {
    TileSegment* Segment = nullptr;
    int Part = 0;
    int Code = 0; ///< of ValuePeaks, of the values in it
  };

  /// Makes `peak` the part among `parts` of a segment without children that has the largest bound
  /// of the values of a channel, if that is larger.
  void FindPeak(TileSegment& segment, const PartRange& parts, std::size_t channel, Peak& peak)
  {
    const int block = this->BlockIn(segment);
    for (int part = this->FindNeeded(segment, block, parts.First, parts.End); part < parts.End;
         part = this->FindNeeded(segment, block, part + 1, parts.End))
    {
      const int code = PeakOf(segment, channel, block, part);
      if (code > peak.Code)
      {
        peak = { &segment, part, code };
      }
    }
  }

  /// FindPeak() of the part that holds the sample n alone; `first`, `last`: roots of the packet.
  void FindPeakAt(int n, int first, int last, std::size_t channel, Peak& peak)
  {
    const int root = FloorDivide(n, this->Scene.SamplesPerRoot);
    if (root < first || root > last)
    {
      return;
    }
    this->ForLeaves(this->Trees.GetRoot(root), [&](TileSegment& segment) {
      const int offset = n - segment.FirstSample;
      if (offset < 0 || offset >= segment.Samples)
      {
        return true;
      }
      if (segment.Known == TileSegment::State::Curves)
      {
        const PartRange parts = this->FindParts(segment);
        const int part = offset / segment.SamplesPerPart;
        this->FindPeak(
          segment, { std::max(part, parts.First), std::min(part + 1, parts.End) }, channel, peak);
      }
      return false;
    });
  }

  /**
   * Samples the part of the packet before all others in which the packet beside it found the
   * extreme of a channel or, if there is nothing, that with the largest bound of its values: so
   * that few others can hold larger values. What is found there is kept as a little less, and found
   * again on the way from front to back.
   */
  HWY_NOINLINE void SampleLikelyPart(std::size_t channel, int first, int last)
  {
    Peak peak;
    peak.Code = std::max(0, this->PassedCodes[channel]);
    this->FindPeakAt(this->Extremes.Numbers[channel], first, last, channel, peak);
    const auto find = [this, channel, &peak](TileSegment& segment) {
      if (segment.Known == TileSegment::State::Curves)
      {
        this->FindPeak(segment, this->FindParts(segment), channel, peak);
      }
      return true;
    };
    if (!peak.Segment)
    {
      for (int index = first; index <= last; ++index)
      {
        this->ForLeaves(this->Trees.GetRoot(index), find);
      }
    }
    if (!peak.Segment)
    {
      return;
    }
    PacketState& state = this->Samples.State;
    const Mf alive = state.Alive;
    this->Sought = 1u << channel;
    this->CastCurves(*peak.Segment, { peak.Part, peak.Part + 1 });
    this->Sought = AllComponents;
    state.Alive = alive;
    this->Blending.LowerExtremes();
    this->FindPassedCodes(peak.Segment->FirstSample + peak.Part * peak.Segment->SamplesPerPart);
    this->Reach = std::numeric_limits<float>::infinity();
  }

  HWY_NOINLINE void BeginCurves(TileSegment& segment, int x, int y, int block, PacketCurve& curve)
  {
    this->FindCurve(segment, x, y, curve);
    this->CountSegment(segment);
    this->Samples.Normals.BeginCurve();
    if constexpr (HasVoxelWindow())
    {
      this->Samples.Window.Follow(
        curve, this->Numbers, this->Samples.State.Alive, block, this->Scene.ClassifiesIntervals);
    }
    if (segment.LeapsRays)
    {
      const Vf scale =
        hn::Mul(Splat(static_cast<float>(FewSamples)), hn::Mul(curve.PerStep, curve.PerStep));
      this->MoveChanges = Scale(scale, FindLargestCurvature(curve.Position));
    }
    this->SkipTo = Splat(-1e30f);
    this->Samples.State.Expecting = hn::FirstN(Df(), 0);
  }

  /// Whether all voxels that samples of a part need exist.
  static HWY_INLINE bool HasAllVoxels(const TileSegment& segment, int block, int part)
  {
    return (segment.Inside[static_cast<std::size_t>(block)] >> part & 1u) != 0;
  }

  /// The end of the parts that are taken with a needed one: those that follow it without a gap, as
  /// far as they are known, and are inside if it is.
  static HWY_INLINE int FindEndOfRun(const TileSegment& segment, int block, int part)
  {
    const auto at = static_cast<std::size_t>(block);
    const std::uint32_t inside = segment.Inside[at];
    const std::uint32_t alike =
      segment.Needed[at] & (HasAllVoxels(segment, block, part) ? inside : ~inside);
    const std::size_t length = hwy::Num0BitsBelowLS1Bit_Nonzero64(~std::uint64_t{ alike >> part });
    return std::min(segment.KnownParts, part + static_cast<int>(length));
  }

  HWY_INLINE void CastCurves(TileSegment& segment, const PartRange& parts)
  {
    const int x = this->X - segment.X;
    const int y = this->Y - segment.Y;
    const int block = this->BlockIn(segment);
    PacketCurve curve;
    bool begun = false;
    const bool seeking = !this->Scene.Peaks.empty();
    const bool whole = !segment.LeapsRays && !this->Scratch.Positions;
    PartRange run{ parts.First, parts.First };
    for (run.First = this->FindNeeded(segment, block, parts.First, parts.End);
         run.First < parts.End; run.First = this->FindNeeded(segment, block, run.End, parts.End))
    {
      run.End = run.First + 1;
      if (HWY_UNLIKELY(seeking))
      {
        const unsigned int channels = this->FindChannels(segment, block, run.First) & this->Sought;
        if (channels == 0)
        {
          continue;
        }
        this->Blending.Want(channels);
      }
      const int from = segment.FirstSample + run.First * segment.SamplesPerPart;
      if (!begun)
      {
        this->BeginCurves(segment, x, y, block, curve);
        begun = true;
      }
      const bool within = !this->Scene.Grid.Snaps && HasAllVoxels(segment, block, run.First);
      if (HWY_LIKELY(!seeking && whole))
      {
        run.End = std::min(parts.End, FindEndOfRun(segment, block, run.First));
      }
      const int to = std::min({ segment.FirstSample + run.End * segment.SamplesPerPart,
        segment.FirstSample + segment.Samples, this->EndSample });
      const int first = std::max(from, this->FirstSample);
      int n;
      if (HWY_UNLIKELY(!whole))
      {
        n = this->TakeEachSample(curve, first, to, within);
      }
      else
      {
        n = within ? this->template TakePart<false>(curve, first, to)
                   : this->template TakePart<true>(curve, first, to);
      }
      if (HWY_UNLIKELY(n < to))
      {
        this->EndAt(n);
        return;
      }
      if (HWY_UNLIKELY(seeking) && this->Blending.TakeNews())
      {
        this->FindPassedCodes(from);
      }
    }
    this->Blending.EndCurve(curve);
  }

  /// Takes the samples from `from` on, before `to`, of a segment whose rays do not leap. `AtFaces`:
  /// not all voxels that they need are known to exist. Returns what
  /// PacketCompositor::TakeSamples() does.
  template <bool AtFaces>
  HWY_INLINE int TakePart(const PacketCurve& curve, int from, int to)
  {
    if (HWY_LIKELY(
          this->Scene.Options != CompositeOptions::Any && !this->Scene.ClassifiesIntervals))
    {
      return HWY_LIKELY(this->Scene.Options == CompositeOptions::None)
        ? this->template Composite<AtFaces, CompositeOptions::None>(curve, from, to)
        : this->Scene.Options == CompositeOptions::Plane
        ? this->template Composite<AtFaces, CompositeOptions::Plane>(curve, from, to)
        : this->template Composite<AtFaces, CompositeOptions::GradientOpacity>(curve, from, to);
    }
    if (this->Blending.template HasLoop<AtFaces>())
    {
      return this->Blending.template TakePart<AtFaces>(curve, this->Numbers, from, to);
    }
    if (this->Samples.Components.template HasLoop<AtFaces>())
    {
      return this->Samples.Components.template TakeSamples<AtFaces>(curve, this->Numbers, from, to);
    }
    if (!this->Scene.Inner)
    {
      return this->TakeEachSample(curve, from, to, !AtFaces);
    }
    return this->Scene.ClassifiesIntervals
      ? this->Samples.Intervals.template TakeAll<AtFaces>(curve, this->Numbers, from, to)
      : this->template Composite<AtFaces, CompositeOptions::Any>(curve, from, to);
  }

  /// PacketCompositor::TakeSamples()
  template <bool AtFaces, CompositeOptions Options>
  HWY_INLINE int Composite(const PacketCurve& curve, int from, int to)
  {
    return this->Samples.template TakeSamples<Options, AtFaces>(curve, this->Numbers, from, to);
  }

  /// Takes the samples from `from` on, before `to`, one by one: those that have no loop of their
  /// own. As PacketCompositor::TakeSamples(); `within` as for TakeSamples().
  HWY_INLINE int TakeEachSample(const PacketCurve& curve, int from, int to, bool within)
  {
    for (int n = from; n < to; ++n)
    {
      this->TakeSamples(curve, n, this->Numbers.FindPlaces(curve, n), within);
      if (HWY_UNLIKELY(hn::AllFalse(Df(), this->Samples.State.Alive)))
      {
        return n;
      }
    }
    return to;
  }

  /// Pulls each sample back by itself; Newton's method starts from the previous sample.
  HWY_NOINLINE void CastPerSample(TileSegment& segment)
  {
    const Df d;
    // Begins at the start of the segment wherever the rays begin: the branch of T^-1 that is
    // followed must not depend on that.
    const int from = segment.FirstSample;
    const int to = this->Trees.FindEndOfSight(
      this->Rays, from, std::min(segment.FirstSample + segment.Samples, this->EndSample));
    if (to <= from)
    {
      return;
    }
    this->Trees.NoteWork();
    this->CountSegment(segment);
    this->Blending.Want(AllComponents);
    const int x = this->X - segment.X;
    const int y = this->Y - segment.Y;
    PacketCurve about;
    this->FindCurve(segment, x, y, about);
    PacketCurve curve;
    const Vf zero = hn::Zero(d);
    for (Vec3& term : curve.Position.Terms)
    {
      term = { zero, zero, zero };
    }
    curve.Dt = Splat(static_cast<float>(this->Scene.Settings.SampleDistance));
    curve.PerStep = Splat(1.0f);
    // Curves lead to the next sample; where intervals are classified, from the one before.
    const int behind = this->Scene.ClassifiesIntervals ? 1 : 0;
    const Vf s =
      hn::Mul(hn::Sub(this->Numbers.Phase, Splat(static_cast<float>(behind))), about.PerStep);
    const Mf& alive = this->Samples.State.Alive;
    SampleFollower follower(this->Scene, this->Rays, this->Numbers.Phase, this->Scratch.Statistics);
    Vec3 next = follower.Find(from - behind, about.Position.At(s), alive);
    Vec3 move = Scale(about.PerStep, about.Position.Slope(s));
    Mf nowhere = IsNowhere(this->Scene, WholeToLocal(this->Scene, next));
    const Vec3 none{ zero, zero, zero };
    for (int n = from; n < to; ++n)
    {
      const Vec3 here = next;
      const Mf fromNowhere = nowhere;
      next = follower.Find(n - behind + 1, Add(here, move), alive);
      nowhere = IsNowhere(this->Scene, WholeToLocal(this->Scene, next));
      // There is no way from or to nowhere.
      move = Select(hn::Or(fromNowhere, nowhere), none, Sub(next, here));
      curve.Position.Terms[0] = behind == 0 ? here : Sub(next, move);
      curve.Position.Terms[1] = move;
      curve.T0 = follower.TimeOf(n - behind);
      this->TakeSamples(curve, n, Splat(static_cast<float>(behind)), false);
      if (HWY_UNLIKELY(hn::AllFalse(d, this->Samples.State.Alive)))
      {
        this->EndAt(n);
        return;
      }
    }
  }

  /// Takes the sample of each ray on the plane of Slice.
  HWY_INLINE void TakeSliceSample()
  {
    const Df d;
    const Vec3 normal = Broadcast(this->Scene.SliceNormal);
    const Vf t = hn::Div(hn::Sub(Splat(this->Scene.SliceOffset), Dot(normal, this->Rays.Origin)),
      Dot(normal, this->Rays.Direction));
    // Planes that touch the volume, or are clipping planes, are seen in spite of rounding errors.
    const Vf slack = hn::Max(
      Splat(SliceGuard / this->Scene.VoxelsPerUnit), hn::Mul(hn::Abs(this->Rays.To), Splat(1e-6f)));
    // False where the ray runs along the plane, too.
    const Mf crosses = hn::And(this->Samples.State.Alive,
      hn::And(
        hn::Ge(t, hn::Sub(this->Rays.From, slack)), hn::Lt(t, hn::Add(this->Rays.To, slack))));
    if (hn::AllFalse(d, crosses))
    {
      return;
    }
    const Vec3 p = MulAdd(t, this->Rays.Direction, this->Rays.Origin);
    const Vec3 local = PullBackFrom(this->Scene, p, EstimatePullBack(this->Scene, p),
      this->Scene.Tolerance, crosses, this->Scratch.Statistics);
    const Vec3 q = WholeToIndex(this->Scene, LocalToWhole(this->Scene, local));
    const Vf near = hn::Mul(slack, Splat(this->Scene.VoxelsPerUnit));
    const auto inside = [&](Vf x, int a) {
      const Vf clamped = Clamp(x, Splat(this->Scene.Lower), Splat(this->Scene.Upper[a]));
      return hn::IfThenElse(hn::Le(hn::Abs(hn::Sub(x, clamped)), near), clamped, x);
    };
    const Vf zero = hn::Zero(d);
    PacketCurve curve;
    for (Vec3& term : curve.Position.Terms)
    {
      term = { zero, zero, zero };
    }
    curve.Position.Terms[0] =
      IndexToWhole(this->Scene, { inside(q.x, 0), inside(q.y, 1), inside(q.z, 2) });
    curve.T0 = t;
    curve.Dt = Splat(static_cast<float>(this->Scene.Settings.SampleDistance));
    curve.PerStep = Splat(1.0f);
    this->Numbers.First = zero;
    this->Numbers.Stop = hn::IfThenElseZero(crosses, Splat(1.0f));
    this->TakeSamples(curve, 0, zero, false);
  }

  HWY_INLINE void FindCurve(TileSegment& segment, int x, int y, PacketCurve& curve)
  {
    const Df d;
    curve.Segment = &segment;
    curve.T0 = Splat(segment.T0);
    curve.Dt = Splat(segment.Dt);
    curve.PerStep = Splat(1.0f / static_cast<float>(segment.Samples));
    if (this->Scene.Identity)
    {
      // Straight rays need no interpolation.
      const Vf zero = hn::Zero(d);
      const Vec3 nothing{ zero, zero, zero };
      curve.Position.Terms[0] =
        LocalToWhole(this->Scene, MulAdd(curve.T0, this->Rays.Direction, this->Rays.Origin));
      curve.Position.Terms[1] =
        Transform(this->Scene.LocalToIndex, Scale(curve.Dt, this->Rays.Direction));
      curve.Position.Terms[2] = nothing;
      curve.Position.Terms[3] = nothing;
      curve.Position.Terms[4] = nothing;
      return;
    }
    this->Trees.NeedColumns(segment);
    curve.Interpolated = true;
    curve.X = x;
    curve.Row = hn::Mul(hn::Add(this->Rows, Splat(static_cast<float>(y))),
      Splat(3.0f / static_cast<float>(segment.Side - 1)));
    Vf rows[4];
    LagrangeWeights(curve.Row, rows);
    curve.Position = FindPacketCurve(segment.Columns, x, rows);
  }

  /// All rays have ended with the sample n.
  HWY_INLINE void EndAt(int n)
  {
    this->Reach = static_cast<float>((n + 2) * this->Scene.Settings.SampleDistance);
  }

  /// The rays that take the sample n.
  HWY_INLINE Mf FindActive(int n) const
  {
    return this->Numbers.FindActive(this->Samples.State.Alive, n);
  }

  /// Takes the sample n of every ray, at s of a curve; `within`: all voxels of the sample exist.
  HWY_INLINE void TakeSamples(const PacketCurve& curve, int n, Vf s, bool within)
  {
    const Df d;
    const Vf number = Splat(static_cast<float>(n));
    Mf active = this->FindActive(n);
    if (HWY_UNLIKELY(hn::AllFalse(d, active)))
    {
      return;
    }
    const Vec3 q = curve.At(this->Scene, s);
    if (!curve.Segment && this->Scene.Distances && !this->Scene.Intervals &&
      !this->Scene.ClassifiesIntervals)
    {
      active = hn::AndNot(EmptyCubes(this->Scene, q).IsEmpty(), active);
      if (hn::AllFalse(d, active))
      {
        return;
      }
    }
    if (curve.Segment && curve.Segment->LeapsRays)
    {
      active = this->LeapFrom(curve, q, s, number, active);
      if (hn::AllFalse(d, active))
      {
        return;
      }
    }
    if (HWY_UNLIKELY(this->Scratch.Positions))
    {
      this->NotePositions(q, curve.TimeAt(s), hn::And(active, IsInside(this->Scene, q)));
    }
    if (HWY_LIKELY(this->Scene.Options == CompositeOptions::None))
    {
      if (!within)
      {
        active = hn::And(active, IsInside(this->Scene, q));
        if (hn::AllFalse(d, active))
        {
          return;
        }
      }
      if (HWY_UNLIKELY(this->Scene.ClassifiesIntervals))
      {
        this->Samples.Intervals.Take(curve, n, s, active, within);
      }
      else
      {
        this->Samples.template TakeSample<CompositeOptions::None>(curve, q, s, active);
      }
    }
    else
    {
      const bool shown = within && this->Scene.CropSpace == Cropping::Spaces::None;
      if (!this->Scene.Intervals && !shown)
      {
        active = hn::And(active, IsShown(this->Scene, this->Rays, curve, q, s));
        if (hn::AllFalse(d, active))
        {
          return;
        }
      }
      if (this->Scene.Sampling == PacketSampling::Composite)
      {
        if (this->Scene.Volume.Components > 1)
        {
          this->Samples.Components.Take(curve, q, s, active);
        }
        else if (this->Scene.ClassifiesIntervals)
        {
          this->Samples.Intervals.Take(curve, n, s, active, false);
        }
        else
        {
          this->Samples.template TakeSample<CompositeOptions::Any>(curve, q, s, active);
        }
      }
      else
      {
        this->Blending.Take(curve, q, s, n, active, within);
      }
    }
  }

  /**
   * Returns the lanes of `active` whose samples may be visible. A lane whose last sample was
   * visible expects the next one to be; the others query how many samples of the segment are empty
   * for certain.
   */
  HWY_NOINLINE Mf LeapFrom(const PacketCurve& curve, const Vec3& q, Vf s, Vf number, Mf active)
  {
    const Df d;
    active = hn::And(active, hn::Ge(number, this->SkipTo));
    const Mf querying = hn::AndNot(this->Samples.State.Expecting, active);
    this->Samples.State.Expecting = hn::FirstN(d, 0);
    if (hn::AllFalse(d, querying))
    {
      return active;
    }
    const TileSegment& segment = *curve.Segment;
    float radius[3];
    for (int a = 0; a < 3; ++a)
    {
      // An interval that ends at a sample is empty if its beginning lies in the cube, too.
      radius[a] = LeapGuard[a] +
        (this->Scene.ClassifiesIntervals ? std::max(segment.Up[a], segment.Down[a]) : 0.0f);
    }
    // Two bounds of the way: that of the rays of all of the tile over all of the segment, and that
    // of each ray over the next samples.
    const EmptyCubes cubes(this->Scene, q);
    const StepsPerUnit ofTile(segment.Up, segment.Down);
    const StepsPerUnit ofRays(Scale(curve.PerStep, curve.Position.Slope(s)), this->MoveChanges);
    const Vf steps = hn::Max(cubes.CountSteps(radius, ofTile),
      hn::Min(cubes.CountSteps(radius, ofRays), Splat(static_cast<float>(FewSamples))));
    // An interval is empty only if its end lies in the cube, too.
    const Mf empty =
      hn::And(querying, hn::Ge(steps, this->Scene.Intervals ? Splat(1.0f) : hn::Zero(d)));
    const Vf more = this->Scene.Intervals ? steps : hn::Add(steps, Splat(1.0f));
    this->SkipTo = hn::IfThenElse(empty, hn::Add(number, more), this->SkipTo);
    this->Scratch.Statistics.DistanceLookups +=
      static_cast<std::int64_t>(hn::CountTrue(d, hn::And(empty, IsInside(this->Scene, q))));
    return hn::AndNot(empty, active);
  }

  HWY_NOINLINE void NotePositions(const Vec3& q, Vf t, Mf lanes)
  {
    const Df d;
    HWY_ALIGN float x[16], y[16], z[16], times[16], flag[16];
    hn::Store(q.x, d, x);
    hn::Store(q.y, d, y);
    hn::Store(q.z, d, z);
    hn::Store(t, d, times);
    hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, flag);
    const int width = std::min(static_cast<int>(hn::Lanes(d)), 4);
    for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane)
    {
      if (flag[lane] != 0.0f)
      {
        this->Scratch.Positions->push_back({ this->Trees.GetX() + this->X + lane % width,
          this->Trees.GetY() + this->Y + lane / width, times[lane],
          { x[lane], y[lane], z[lane] } });
      }
    }
  }

  HWY_INLINE void CountSegment(const TileSegment& segment)
  {
    CastStatistics& statistics = this->Scratch.Statistics;
    const int rays = static_cast<int>(hn::CountTrue(Df(), this->Samples.State.Alive));
    statistics.Segments += rays;
    statistics.SegmentLength +=
      rays * (static_cast<double>(segment.Dt) / this->Scene.Source->VoxelSize);
  }

  const PacketScene& Scene;
  SegmentTrees& Trees;
  PacketScratch& Scratch;
  const RayPacket& Rays;
  int X; ///< first pixel, from that of the roots
  int Y;
  Vf Rows; ///< of the pixels, from Y on
  SampleNumbers Numbers;
  int FirstSample; ///< of all rays
  int EndSample;
  ExtremeSamples& Extremes;
  float Reach = std::numeric_limits<float>::infinity();
  Vec3 MoveChanges; ///< bounds for few samples, where single rays leap
  Vf SkipTo;        ///< samples of the segment before this one are empty for certain
  /// Where extremes of channels are looked for, the codes of ValuePeaks up to which parts hold no
  /// value above the extremes of all rays.
  std::array<int, LargestNumberOfChannels> PassedCodes{ { -1, -1, -1, -1 } };
  unsigned int Sought = AllComponents; ///< channels whose extremes are looked for, a bit each
  PacketCompositor<T> Samples;
  PacketBlending<T> Blending;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
