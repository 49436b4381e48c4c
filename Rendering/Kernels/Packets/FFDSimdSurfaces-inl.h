// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Finding and compositing isosurfaces. Included once per target of Highway.
#if defined(FFD_SIMD_SURFACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SURFACES_INL_H_
#undef FFD_SIMD_SURFACES_INL_H_
#else
#define FFD_SIMD_SURFACES_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdComponents-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdGradients-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdOptics-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSampler-inl.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Finds, lights and composites the isosurfaces that the rays of a packet cross between their
/// samples.
template <class T>
class SurfaceCrossings
{
public:
  /// Keeps a reference to what finds the samples.
  explicit SurfaceCrossings(PacketGradients<T>& samples)
    : Samples(samples)
    , Scene(samples.Scene)
    , Pending(hn::FirstN(Df(), 0))
  {
  }

  /// Begins a packet, before its samples.
  HWY_INLINE void Begin()
  {
    const Vf zero = hn::Zero(Df());
    this->Samples.State.Out.TallyStep = Splat(NoNumber);
    // Lanes that cross nothing are numbers, too.
    this->Next = { { zero, zero, zero, zero }, zero, zero, zero, { zero, zero, zero }, true };
  }

  /// Composites the surfaces between samples, at q and s of a curve, and the next ones, as
  /// RayIntegrator does: an interval that leaves or enters the volume ends at the face. `number`:
  /// that of the samples; `next`: the values at the next samples that are in the volume, or null;
  /// `inner`: all are the samples n, and all voxels that they and the intervals behind them need
  /// exist.
  HWY_NOINLINE void Cross(const PacketCurve& curve, const Vec3& q, Vf s, int n, Vf number, Mf lanes,
    const Vf* next, bool inner)
  {
    this->Inner = inner;
    const Df d;
    const Vec3 end = curve.At(this->Scene, hn::Add(s, curve.PerStep));
    const Mf insideA = this->Inner ? lanes : hn::And(lanes, IsInside(this->Scene, q));
    const Mf insideB = this->Inner ? lanes : hn::And(lanes, IsInside(this->Scene, end));
    const Mf any = hn::Or(insideA, insideB);
    if (hn::AllFalse(d, any))
    {
      return;
    }
    Interval interval{ s, hn::Add(s, curve.PerStep), this->Samples.State.Out.Tally, hn::Zero(d) };
    const Mf faces = hn::Xor(insideA, insideB);
    if (HWY_UNLIKELY(!hn::AllFalse(d, faces)))
    {
      this->FindFaces(curve, faces, insideA, interval);
      next = nullptr;
    }
    this->FindBeginning(curve, number, insideA, any, interval);
    interval.B = next ? *next
      : this->Inner   ? this->Samples.FindInnerValue(n + 1, end, any)
                      : this->ValuesAt(this->PositionAt(curve, interval.To), any, false);
    this->Cross(curve, number, insideB, any, interval);
  }

  /// Does what Cross() does of samples all of whose voxels, and those of the intervals behind them,
  /// exist; `next`: the values at the next samples.
  HWY_INLINE void CrossInner(const PacketCurve& curve, Vf s, Vf number, Mf lanes, Vf next)
  {
    this->Inner = true;
    Interval interval{ s, hn::Add(s, curve.PerStep), this->Samples.State.Out.Tally, next };
    this->FindBeginning(curve, number, lanes, lanes, interval);
    this->Cross(curve, number, lanes, lanes, interval);
  }

  /// Composites what the samples of a curve have crossed, before another curve begins.
  HWY_INLINE void EndCurve(const PacketCurve& curve)
  {
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), this->Pending)))
    {
      this->Add(curve);
    }
  }

private:
  /// Parts of curves, and the values at their ends.
  struct Interval
  {
    Vf From;
    Vf To;
    Vf A;
    Vf B;
  };

  /// Surfaces that are crossed in intervals, one of each ray.
  struct Crossing
  {
    Interval Place;
    Vf Value;
    Vf Excess;
    Vf Opacity;
    Vec3 Color;
    bool Inner; ///< whether all voxels of the intervals and their gradients exist
  };

  /// The search for a crossing ends when it is known to this part of an interval, or after so many
  /// steps.
  static constexpr float CloseCrossing = 1e-2f;
  static constexpr int CrossingSteps = 40;

  /// Interpolates values at positions in the volume.
  HWY_INLINE Vf ValuesAt(const Vec3& q, Mf lanes, bool inner)
  {
    if (HWY_UNLIKELY(this->Scene.Volume.Components > 1))
    {
      Vf values[LargestNumberOfComponents];
      const unsigned int wanted = this->Scene.KindOfComponents == ComponentKind::Independent
        ? 1u << this->GetChannel()
        : AllComponents;
      this->Samples.FindComponents(q, lanes, wanted, values);
      return IntensityOf(this->Scene, this->GetChannel(), values);
    }
    return HWY_LIKELY(inner) ? this->Samples.FindInnerValue(q, lanes)
                             : this->Samples.FindValue(q, lanes);
  }

  std::size_t GetChannel() const
  {
    return this->Scene.KindOfComponents == ComponentKind::Independent
      ? static_cast<std::size_t>(this->Scene.Source->Blend.IsoComponent)
      : 0;
  }

  /// Finds the values where the intervals behind the samples `number` begin, of the lanes of `any`;
  /// `inside`: rays whose samples are in the volume.
  HWY_INLINE void FindBeginning(
    const PacketCurve& curve, Vf number, Mf inside, Mf any, Interval& interval)
  {
    // Intervals that follow each other share a value: no surface slips through between them.
    const Mf known = hn::And(inside, hn::Eq(this->Samples.State.Out.TallyStep, number));
    const Mf unknown = hn::AndNot(known, any);
    if (!hn::AllFalse(Df(), unknown))
    {
      interval.A = hn::IfThenElse(unknown,
        this->ValuesAt(this->PositionAt(curve, interval.From), unknown, this->Inner), interval.A);
    }
  }

  /// Composites the surfaces in the intervals behind the samples `number`, of the lanes of `any`;
  /// `inside`: rays that are in the volume at the next sample.
  HWY_INLINE void Cross(
    const PacketCurve& curve, Vf number, Mf inside, Mf any, const Interval& interval)
  {
    const Df d;
    this->Samples.State.Out.Tally = hn::IfThenElse(any, interval.B, this->Samples.State.Out.Tally);
    this->Samples.State.Out.TallyStep =
      hn::IfThenElse(inside, hn::Add(number, Splat(1.0f)), Splat(NoNumber));
    // Values ascend, so do the crossings, or they descend. One at an end belongs to the interval
    // where the scalar passes it. Comparisons with what is not a number find none.
    const Mf up = hn::And(any, hn::Lt(interval.A, interval.B));
    const Mf down = hn::And(any, hn::Gt(interval.A, interval.B));
    const Vf low = hn::Min(interval.A, interval.B);
    const Vf high = hn::Max(interval.A, interval.B);
    const std::size_t count = this->Scene.IsoValues.size();
    const auto cross = [&](const PacketSurfaceValue& iso, Mf way) {
      const Vf value = Splat(iso.Value);
      const Mf crossed = hn::And(
        hn::And(way, this->Samples.State.Alive), hn::And(hn::Lt(low, value), hn::Le(value, high)));
      if (!hn::AllFalse(d, crossed))
      {
        this->Await(curve, interval, iso, crossed);
      }
    };
    for (std::size_t i = 0; i < count; ++i)
    {
      cross(this->Scene.IsoValues[i], count > 1 ? up : hn::Or(up, down));
    }
    for (std::size_t i = count; i-- > 0 && count > 1;)
    {
      cross(this->Scene.IsoValues[i], down);
    }
    if (!curve.Segment || hn::AllFalse(d, hn::AndNot(this->Pending, this->Samples.State.Alive)))
    {
      this->Add(curve);
    }
  }

  /// Remembers the surface of a value between the ends of an interval. Surfaces of several
  /// intervals are found together, each ray's before its next one.
  HWY_NOINLINE void Await(
    const PacketCurve& curve, const Interval& interval, const PacketSurfaceValue& iso, Mf lanes)
  {
    if (!hn::AllFalse(Df(), hn::And(lanes, this->Pending)))
    {
      this->Add(curve);
      lanes = hn::And(lanes, this->Samples.State.Alive);
    }
    const auto keep = [lanes](Vf& kept, Vf v) { kept = hn::IfThenElse(lanes, v, kept); };
    Crossing& next = this->Next;
    keep(next.Place.From, interval.From);
    keep(next.Place.To, interval.To);
    keep(next.Place.A, interval.A);
    keep(next.Place.B, interval.B);
    keep(next.Value, Splat(iso.Value));
    keep(next.Excess, Splat(iso.Excess));
    keep(next.Opacity, Splat(iso.Opacity));
    keep(next.Color.x, Splat(iso.Color[0]));
    keep(next.Color.y, Splat(iso.Color[1]));
    keep(next.Color.z, Splat(iso.Color[2]));
    next.Inner = this->Inner && (next.Inner || hn::AllFalse(Df(), this->Pending));
    this->Pending = hn::Or(this->Pending, lanes);
  }

  /// Positions on the curves, clamped to the volume against rounding errors.
  HWY_INLINE Vec3 PositionAt(const PacketCurve& curve, Vf s) const
  {
    return this->Samples.ClampToVolume(curve.At(this->Scene, s));
  }

  /// Moves the ends of intervals that are outside of the volume to its faces.
  HWY_NOINLINE void FindFaces(
    const PacketCurve& curve, Mf lanes, Mf insideA, Interval& interval) const
  {
    const Vf face =
      FindFace(this->Scene, curve, hn::IfThenElse(insideA, interval.From, interval.To),
        hn::IfThenElse(insideA, interval.To, interval.From));
    interval.From = hn::IfThenElse(hn::AndNot(insideA, lanes), face, interval.From);
    interval.To = hn::IfThenElse(hn::And(insideA, lanes), face, interval.To);
  }

  /// Composites the surfaces of the rays of Pending.
  HWY_NOINLINE void Add(const PacketCurve& curve)
  {
    const Df d;
    const Mf lanes = hn::And(this->Pending, this->Samples.State.Alive);
    this->Pending = hn::FirstN(d, 0);
    if (hn::AllFalse(d, lanes))
    {
      return;
    }
    const Crossing& next = this->Next;
    const Vf s = this->FindCrossing(curve, next, lanes);
    const Vec3 q = this->PositionAt(curve, s);
    const Vf t = curve.TimeAt(s);
    Mf shown =
      hn::And(lanes, hn::And(hn::Ge(t, this->Samples.Rays.From), hn::Lt(t, this->Samples.Rays.To)));
    shown = hn::And(shown, IsShown(this->Scene, this->Samples.Rays, curve, q, s));
    if (this->Scene.HidesSamples && !hn::AllFalse(d, shown))
    {
      shown = LeaveOutHidden(this->Scene, Copy(q), shown);
    }
    if (hn::AllFalse(d, shown))
    {
      return;
    }
    this->Samples.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, shown));
    Vec3 color = next.Color;
    if (this->Scene.Shade)
    {
      const bool several = this->Scene.Volume.Components > 1;
      color = this->Samples.Normals.Light(
        several ? this->Scene.Components[this->GetChannel()].Surface : this->Scene.Surface, curve,
        q, color, this->GradientsAt(curve, q, s, shown), s, t);
    }
    this->Samples.State.Add(shown, color, hn::Sub(Splat(1.0f), next.Opacity), t,
      this->Scene.Settings.TerminationTransmittance);
  }

  /// Finds s where the scalar is that of a surface, by the Illinois method: the secant rule in
  /// which the value at an end that has not moved counts half. The last secant is the result.
  HWY_NOINLINE Vf FindCrossing(const PacketCurve& curve, const Crossing& crossing, Mf lanes)
  {
    const Df d;
    const Interval& interval = crossing.Place;
    const Vf half = Splat(0.5f);
    const Vf zero = hn::Zero(d);
    const Vf one = Splat(1.0f);
    const Vf shortStep = Splat(0.5f * CloseCrossing);
    const Vf length = hn::Sub(interval.To, interval.From);
    const auto above = [&crossing](Vf value) {
      return hn::Add(hn::Sub(value, crossing.Value), crossing.Excess);
    };
    Vf fa = above(interval.A);
    Vf fb = above(interval.B);
    // Parts of the interval.
    Vf a = zero;
    Vf b = hn::IfThenElse(hn::Eq(fa, zero), zero, one);
    Vf stayed = zero;
    const auto findSecant = [&] {
      return hn::Div(hn::Sub(hn::Mul(fa, b), hn::Mul(fb, a)), hn::Sub(fa, fb));
    };
    const auto isOpen = [&] {
      return hn::And(lanes, hn::And(hn::Gt(hn::Sub(b, a), Splat(CloseCrossing)), hn::Ne(fb, zero)));
    };
    Mf open = isOpen();
    Vf secant = findSecant();
    Vf part = secant;
    Mf wasShort = hn::FirstN(d, 0);
    const bool inner = crossing.Inner && this->Scene.Volume.SlicesInReach == 0;
    typename PacketSampler<T>::CellValues cells(this->Scene.Volume);
    for (int i = 0; i < CrossingSteps && !hn::AllFalse(d, open); ++i)
    {
      const Mf between = hn::And(hn::Gt(part, a), hn::Lt(part, b));
      part = hn::IfThenElse(between, part, hn::Mul(half, hn::Add(a, b)));
      const Vec3 at = this->PositionAt(curve, hn::MulAdd(part, length, interval.From));
      const Vf f = above(HWY_LIKELY(inner) ? cells.Find(FindSampledVoxels(this->Scene, at), open)
                                           : this->ValuesAt(at, open, crossing.Inner));
      // A point at the crossing counts as behind it.
      const Mf behind =
        hn::And(open, hn::Or(hn::Eq(f, zero), hn::Xor(hn::Lt(f, zero), hn::Ge(fb, zero))));
      const Mf before = hn::AndNot(behind, open);
      b = hn::IfThenElse(behind, part, b);
      fb = hn::IfThenElse(behind, f, fb);
      a = hn::IfThenElse(before, part, a);
      fa = hn::IfThenElse(before, f, fa);
      const Mf again = hn::And(behind, hn::Lt(stayed, zero));
      const Mf againBefore = hn::And(before, hn::Gt(stayed, zero));
      fa = hn::IfThenElse(again, hn::Mul(half, fa), fa);
      fb = hn::IfThenElse(againBefore, hn::Mul(half, fb), fb);
      stayed = hn::IfThenElse(behind, Splat(-1.0f), hn::IfThenElse(before, one, stayed));
      open = isOpen();
      // A short step goes beyond the crossing, which closes the interval from the other side. Where
      // it does not, as values jump or stay there, the next point is the middle.
      secant = findSecant();
      const Mf isShort = hn::Le(hn::Abs(hn::Sub(secant, part)), shortStep);
      const Mf failed = hn::And(wasShort, hn::Or(again, againBefore));
      const Vf beyond = hn::Add(secant, hn::CopySign(shortStep, stayed));
      part = hn::IfThenElse(failed, zero, hn::IfThenElse(isShort, beyond, secant));
      wasShort = hn::AndNot(failed, isShort);
    }
    // Where values jump, the voxel behind the crossing is the one that is seen.
    if (this->Scene.Volume.Nearest || this->Scene.Grid.Snaps)
    {
      return hn::MulAdd(b, length, interval.From);
    }
    const Mf inside = hn::And(hn::Gt(secant, a), hn::Lt(secant, b));
    return hn::MulAdd(hn::IfThenElse(inside, secant, b), length, interval.From);
  }

  /// Gradients that give normals at q, the position at s of a curve, in the volume.
  HWY_INLINE Vec3 GradientsAt(const PacketCurve& curve, const Vec3& q, Vf s, Mf lanes)
  {
    return this->Scene.Volume.Components > 1
      ? this->Samples.FindIntensityGradient(curve, q, s, lanes, this->GetChannel())
      : this->Samples.FindNormalGradient(curve, q, s, lanes);
  }

  PacketGradients<T>& Samples;
  const PacketScene& Scene;
  bool Inner = false; ///< of the samples whose intervals are looked at
  Crossing Next;      ///< of the rays of Pending
  Mf Pending;         ///< rays whose last surface was crossed, but not composited
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
