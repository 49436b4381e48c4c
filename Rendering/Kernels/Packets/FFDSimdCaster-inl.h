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
#include "FFDSimdPacketSegments-inl.h"
#include "FFDSimdPeakSearch-inl.h"
#include "FFDSimdRayLeaps-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSampleFollower-inl.h"
#include "FFDSimdSegmentTrees-inl.h"
#include "FFDSimdSlice-inl.h"

#include <algorithm>
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
    , Segments(scene, trees, x, y, range)
    , Rows(rows)
    , Numbers(numbers)
    , Leaps(scene, scratch.Statistics)
    , Peaks(scene, this->Segments, extremes)
    , Samples(scene, trees, scratch, rays, x, y, rows, active)
    , Blending(scene, scratch, this->Samples)
  {
  }

  const PacketPixels& GetPixels() const { return this->Samples.State.Out; }

  void Cast()
  {
    for (std::size_t c = 0; HWY_UNLIKELY(c < this->Scene.Peaks.size()); ++c)
    {
      this->SampleLikelyPart(c);
    }
    this->Segments.ForLeaves([this](TileSegment& segment) { return this->CastSegment(segment); });
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
    PacketCurve curve;
    const Mf crossing = FindSliceCurve(
      this->Scene, this->Rays, this->Samples.State.Alive, this->Scratch.Statistics, curve);
    if (!hn::AllFalse(Df(), crossing))
    {
      const Vf zero = hn::Zero(Df());
      this->Numbers.First = zero;
      this->Numbers.Stop = hn::IfThenElseZero(crossing, Splat(1.0f));
      this->TakeSamples(curve, 0, zero, false);
    }
    this->Blending.End();
  }

  /// The t at which the last ray has ended; infinite where one went on to the end.
  float GetReach() const { return this->Reach; }

private:
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
      this->CastCurves(segment, this->Segments.FindParts(segment));
    }
    return !hn::AllFalse(Df(), this->Samples.State.Alive);
  }

  /// Notes what a part of a segment has changed of the extremes.
  HWY_NOINLINE void NoteExtremes(const TileSegment& segment, int part)
  {
    const int n = segment.FirstSample + part * segment.SamplesPerPart;
    for (std::size_t c = 0; c < this->Scene.Peaks.size(); ++c)
    {
      this->Peaks.Note(
        c, this->Blending.GetExtreme(c), this->Samples.State.Alive, n, segment.LeapsRays);
    }
  }

  /// Samples the part of the packet first that is likely to hold the extreme of a channel. What is
  /// found there is kept as a little less, and found again on the way from front to back.
  HWY_NOINLINE void SampleLikelyPart(std::size_t channel)
  {
    const PeakSearch::Peak peak = this->Peaks.FindLikelyPart(channel);
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
    this->NoteExtremes(*peak.Segment, peak.Part);
    this->Reach = std::numeric_limits<float>::infinity();
  }

  HWY_NOINLINE void BeginCurves(TileSegment& segment, int block, PacketCurve& curve)
  {
    this->FindCurve(segment, curve);
    this->CountSegment(segment);
    this->Samples.Normals.BeginCurve();
    if (segment.LeapsRays)
    {
      this->Leaps.Begin(curve);
    }
    if constexpr (HasVoxelWindow())
    {
      if (HWY_UNLIKELY(segment.LeapsRays))
      {
        this->Samples.Window.Leave();
      }
      else
      {
        this->Samples.Window.Follow(
          curve, this->Numbers, this->Samples.State.Alive, block, this->Scene.ClassifiesIntervals);
      }
    }
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
    PacketSegments& segments = this->Segments;
    const int block = segments.BlockIn(segment);
    const bool seeking = !this->Scene.Peaks.empty();
    PacketCurve curve;
    if (HWY_UNLIKELY(segment.LeapsRays && !seeking))
    {
      // Rays that leap by themselves need not know which parts are empty.
      this->BeginCurves(segment, block, curve);
      this->TakeParts(curve, parts, false);
      this->Blending.EndCurve(curve);
      return;
    }
    bool begun = false;
    PartRange run{ parts.First, parts.First };
    for (run.First = segments.FindNeeded(segment, block, parts.First, parts.End);
         run.First < parts.End; run.First = segments.FindNeeded(segment, block, run.End, parts.End))
    {
      run.End = run.First + 1;
      if (HWY_UNLIKELY(seeking))
      {
        const unsigned int channels =
          this->Peaks.FindChannels(segment, block, run.First) & this->Sought;
        if (channels == 0)
        {
          continue;
        }
        this->Blending.Want(channels);
      }
      if (!begun)
      {
        this->BeginCurves(segment, block, curve);
        begun = true;
      }
      if (HWY_LIKELY(!seeking && !this->Scratch.Positions))
      {
        run.End = std::min(parts.End, FindEndOfRun(segment, block, run.First));
      }
      const bool within = !this->Scene.Grid.Snaps && HasAllVoxels(segment, block, run.First);
      if (HWY_UNLIKELY(!this->TakeParts(curve, run, within)))
      {
        return;
      }
      if (HWY_UNLIKELY(seeking) && this->Blending.TakeNews())
      {
        this->NoteExtremes(segment, run.First);
      }
    }
    this->Blending.EndCurve(curve);
  }

  /// Takes the samples of parts of a segment; false where all rays have ended. `within`: all voxels
  /// of the samples exist.
  HWY_INLINE bool TakeParts(const PacketCurve& curve, const PartRange& parts, bool within)
  {
    const TileSegment& segment = *curve.Segment;
    const int from = std::max(
      segment.FirstSample + parts.First * segment.SamplesPerPart, this->Segments.FirstSample);
    const int to = std::min({ segment.FirstSample + parts.End * segment.SamplesPerPart,
      segment.FirstSample + segment.Samples, this->Segments.EndSample });
    int n;
    if (HWY_UNLIKELY(segment.LeapsRays))
    {
      n = this->TakeSpreadSamples(curve, from, to);
    }
    else if (HWY_UNLIKELY(this->Scratch.Positions))
    {
      n = this->TakeEachSample(curve, from, to, within);
    }
    else
    {
      n = within ? this->template TakePart<false>(curve, from, to)
                 : this->template TakePart<true>(curve, from, to);
    }
    if (HWY_UNLIKELY(n < to))
    {
      this->EndAt(n);
      return false;
    }
    return true;
  }

  /**
   * Takes the samples from `from` on, before `to`, of a segment in which single rays leap, and
   * which are too far apart to come upon something together: each goes on to its next sample that
   * may be visible, and then all take theirs, whichever these are. Returns what
   * PacketCompositor::TakeSamples() does.
   */
  HWY_NOINLINE int TakeSpreadSamples(const PacketCurve& curve, int from, int to)
  {
    const Df d;
    PacketState& state = this->Samples.State;
    const Vf one = Splat(1.0f);
    const Vf first = Splat(static_cast<float>(curve.Segment->FirstSample));
    const Vf stop = hn::Min(this->Numbers.Stop, Splat(static_cast<float>(to)));
    Vf number = hn::Max(this->Numbers.First, Splat(static_cast<float>(from)));
    for (;;)
    {
      Mf active;
      Vf s;
      Vec3 q;
      for (;;)
      {
        active = hn::And(state.Alive, hn::Lt(number, stop));
        s = hn::Mul(hn::Add(this->Numbers.Phase, hn::Sub(number, first)), curve.PerStep);
        q = curve.At(this->Scene, s);
        const Mf querying = hn::AndNot(state.Expecting, active);
        const Vf steps = this->Scene.Peaks.empty() ? this->Leaps.CountEmpty(curve, q, s, querying)
                                                   : this->Peaks.CountPassed(curve, q, querying);
        state.Expecting = hn::Or(state.Expecting, hn::AndNot(hn::Gt(steps, hn::Zero(d)), active));
        if (hn::AllFalse(d, hn::Gt(steps, hn::Zero(d))))
        {
          break;
        }
        number = hn::Add(number, steps);
      }
      if (hn::AllFalse(d, active))
      {
        return to;
      }
      state.Expecting = hn::FirstN(d, 0);
      this->TakeAt(curve, q, s, from, number, active, false);
      number = hn::IfThenElse(active, hn::Add(number, one), number);
      if (HWY_UNLIKELY(hn::AllFalse(d, state.Alive)))
      {
        return static_cast<int>(LargestLane(hn::Min(number, stop))) - 1;
      }
    }
  }

  /// Whether samples are classified and composited, not intervals.
  HWY_INLINE bool CompositesSamples() const
  {
    return this->Scene.Sampling == PacketSampling::Composite && !this->Scene.ClassifiesIntervals;
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
      this->Rays, from, std::min(segment.FirstSample + segment.Samples, this->Segments.EndSample));
    if (to <= from)
    {
      return;
    }
    this->Trees.NoteWork();
    this->CountSegment(segment);
    this->Blending.Want(AllComponents);
    PacketCurve about;
    this->FindCurve(segment, about);
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

  HWY_INLINE void FindCurve(TileSegment& segment, PacketCurve& curve)
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
    const int x = this->Segments.X - segment.X;
    const float y = static_cast<float>(this->Segments.Y - segment.Y);
    curve.Interpolated = true;
    curve.X = x;
    curve.Row =
      hn::Mul(hn::Add(this->Rows, Splat(y)), Splat(3.0f / static_cast<float>(segment.Side - 1)));
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
    this->TakeAt(curve, q, s, n, Splat(static_cast<float>(n)), active, within);
  }

  /// Takes samples at q, the position at s of a curve. `number`: theirs; n: that of all rays, where
  /// these take samples of one number; `within`: all voxels of the samples exist, and they are of
  /// one number.
  HWY_INLINE void TakeAt(
    const PacketCurve& curve, const Vec3& q, Vf s, int n, Vf number, Mf active, bool within)
  {
    const Df d;
    if (HWY_UNLIKELY(this->Scratch.Positions))
    {
      this->NotePositions(q, curve.TimeAt(s), hn::And(active, IsInside(this->Scene, q)));
    }
    if (HWY_LIKELY(this->CompositesSamples()))
    {
      return this->CompositeAt(curve, q, s, active, within);
    }
    if (!this->Scene.Intervals)
    {
      active = this->FindShown(curve, q, s, active, within);
      if (hn::AllFalse(d, active))
      {
        return;
      }
    }
    if (this->Scene.ClassifiesIntervals)
    {
      this->Samples.Intervals.Take(
        curve, n, number, s, active, within && this->Scene.Options == CompositeOptions::None);
    }
    else
    {
      this->Blending.Take(curve, q, s, n, number, active, within);
    }
  }

  /// The lanes of `active` whose samples at q, the position at s of a curve, are in the volume and
  /// not cropped; `within`: they are in the volume.
  HWY_INLINE Mf FindShown(
    const PacketCurve& curve, const Vec3& q, Vf s, Mf active, bool within) const
  {
    return within && this->Scene.CropSpace == Cropping::Spaces::None
      ? active
      : hn::And(active, IsShown(this->Scene, this->Rays, curve, q, s));
  }

  /// Composites samples at q, the position at s of a curve; `within` as for FindShown().
  HWY_INLINE void CompositeAt(const PacketCurve& curve, const Vec3& q, Vf s, Mf active, bool within)
  {
    active = this->FindShown(curve, q, s, active, within);
    if (hn::AllFalse(Df(), active))
    {
      return;
    }
    if (HWY_LIKELY(this->Scene.Options == CompositeOptions::None))
    {
      this->Samples.template TakeSample<CompositeOptions::None>(curve, q, s, active);
    }
    else if (this->Scene.Volume.Components > 1)
    {
      this->Samples.Components.Take(curve, q, s, active);
    }
    else
    {
      this->Samples.template TakeSample<CompositeOptions::Any>(curve, q, s, active);
    }
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
        this->Scratch.Positions->push_back({ this->Trees.GetX() + this->Segments.X + lane % width,
          this->Trees.GetY() + this->Segments.Y + lane / width, times[lane],
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
  PacketSegments Segments;
  Vf Rows; ///< of the pixels, from the first one on
  SampleNumbers Numbers;
  float Reach = std::numeric_limits<float>::infinity();
  RayLeaps Leaps;
  PeakSearch Peaks;
  unsigned int Sought = AllComponents; ///< channels whose extremes are looked for, a bit each
  PacketCompositor<T> Samples;
  PacketBlending<T> Blending;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
