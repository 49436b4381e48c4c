// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Pre-integrated classification, an interval a lane, as IntervalTable. Included once per target of
// Highway.
#if defined(FFD_SIMD_INTERVAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_INTERVAL_INL_H_
#undef FFD_SIMD_INTERVAL_INL_H_
#else
#define FFD_SIMD_INTERVAL_INL_H_
#endif

#include "FFDIntervalTable.h"
#include "FFDPacketCaster.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Entries of the interval table at values.
struct IntervalPoint
{
  Vf Entry;      ///< of the transfer table, and its fraction
  Vf Extinction; ///< per data unit
  Vi Integral;   ///< modulo 2^32
};

/// `values`: as they are fetched; what is no number counts as the first entry.
HWY_INLINE IntervalPoint FindIntervalPoint(const PacketScene& scene, Vf values)
{
  const Df d;
  const PacketTable::Range& range = scene.Table.GetRange(0);
  const Vf x = hn::Mul(hn::Sub(values, Splat(range.Low)), Splat(range.Scale));
  IntervalPoint point;
  point.Entry = hn::IfThenElseZero(hn::Eq(x, x), Clamp(x, hn::Zero(d), Splat(range.Intervals)));
  const Vf whole = hn::Min(hn::Floor(point.Entry), Splat(range.Intervals - 1.0f));
  const Vf f = hn::Sub(point.Entry, whole);
  const Quads entry = LoadQuads(scene.Integrals.Entries[0].Words, Truncate(whole));
  const Vf extinction = hn::BitCast(d, entry.x);
  const Vf change = hn::BitCast(d, entry.y);
  point.Extinction = hn::MulAdd(f, change, extinction);
  const Vf part = hn::Mul(f, hn::MulAdd(hn::Mul(Splat(0.5f), f), change, extinction));
  point.Integral = hn::Add(entry.z, hn::NearestInt(hn::Mul(part, Splat(scene.Integrals.Units))));
  return point;
}

/// The mean extinction between two points, per data unit.
HWY_INLINE Vf FindMeanExtinction(
  const PacketScene& scene, const IntervalPoint& a, const IntervalPoint& b)
{
  const Df d;
  const Vf entries = hn::Sub(b.Entry, a.Entry);
  const Mf near = hn::Lt(hn::Abs(entries), Splat(static_cast<float>(IntervalTable::NearEntries)));
  const Vf integral = hn::ConvertTo(d, hn::Sub(b.Integral, a.Integral));
  const Vf mean = hn::Mul(hn::Mul(integral, Splat(1.0f / scene.Integrals.Units)),
    Reciprocal(hn::IfThenElse(near, Splat(1.0f), entries)));
  return hn::IfThenElse(
    near, hn::Mul(Splat(0.5f), hn::Add(a.Extinction, b.Extinction)), hn::Max(mean, hn::Zero(d)));
}

/// Mean place that the light of homogeneous intervals comes from.
HWY_INLINE Vf PlaceInInterval(Vf opticalDepth)
{
  const Vf depth = hn::Mul(Splat(0.69314718f), opticalDepth);
  return InverseSqrt(hn::MulAdd(depth, hn::Add(Splat(4.0f / 3.0f), depth), Splat(4.0f)));
}

HWY_INLINE Vf OpacityOfDepth(Vf opticalDepth)
{
  return hn::Sub(Splat(1.0f), Exp2(hn::Neg(opticalDepth)));
}

/// Mean place that the light of intervals comes from whose ends may differ. `front` and `back`:
/// optical depths with the extinctions at the ends.
HWY_INLINE Vf PlaceInInterval(Vf front, Vf back, Vf opticalDepth)
{
  const Vf one = Splat(1.0f);
  const Mf crosses =
    hn::And(hn::Gt(opticalDepth, hn::Min(front, back)), hn::Lt(opticalDepth, hn::Max(front, back)));
  const Vf homogeneous = PlaceInInterval(opticalDepth);
  if (hn::AllFalse(Df(), crosses))
  {
    return homogeneous;
  }
  const Vf change = hn::Mul(
    hn::Sub(back, opticalDepth), Reciprocal(hn::IfThenElse(crosses, hn::Sub(back, front), one)));
  const Vf rest = hn::Sub(one, change);
  const Vf depths[2] = { hn::Mul(front, change), hn::Mul(back, rest) };
  const Vf first = OpacityOfDepth(depths[0]);
  const Vf second = hn::Mul(hn::Sub(one, first), OpacityOfDepth(depths[1]));
  const Vf sum = hn::Add(first, second);
  const Mf some = hn::Gt(sum, Splat(1e-6f));
  const Vf weighted = hn::MulAdd(hn::Mul(first, change), PlaceInInterval(depths[0]),
    hn::Mul(second, hn::MulAdd(rest, PlaceInInterval(depths[1]), change)));
  const Vf place = hn::IfThenElse(
    some, hn::Mul(weighted, Reciprocal(hn::IfThenElse(some, sum, one))), Splat(0.5f));
  return hn::IfThenElse(crosses, place, homogeneous);
}

/// Optical properties of the lanes' intervals.
struct ClassifiedIntervals
{
  Vf OpticalDepth;
  Vf Transmittance;
  Vf Value; ///< as fetched
  Vf Place;
};

/// IntervalTable::Classify() of two intervals with a point at the place `at` between them.
HWY_INLINE ClassifiedIntervals ClassifyIntervals(const PacketScene& scene,
  const IntervalPoint& front, const IntervalPoint& middle, const IntervalPoint& back, Vf at,
  Vf length)
{
  const Vf one = Splat(1.0f);
  const Vf rest = hn::Sub(one, at);
  const Vf first = hn::Mul(FindMeanExtinction(scene, front, middle), hn::Mul(at, length));
  const Vf second = hn::Mul(FindMeanExtinction(scene, middle, back), hn::Mul(rest, length));
  const Vf passed = Exp2(hn::Neg(first));
  const Vf a = hn::Sub(one, passed);
  ClassifiedIntervals interval;
  interval.OpticalDepth = hn::Add(first, second);
  interval.Transmittance = hn::Mul(passed, Exp2(hn::Neg(second)));
  const Vf b = hn::Sub(passed, interval.Transmittance);
  const Vf sum = hn::Add(a, b);
  const Mf some = hn::Gt(sum, Splat(1e-6f));
  const Vf part = hn::Mul(a, Reciprocal(hn::IfThenElse(some, sum, one)));
  const Vf lengths[2] = { hn::Mul(at, length), hn::Mul(rest, length) };
  const auto placeOf = [&](const IntervalPoint& from, const IntervalPoint& to, Vf depth, Vf over) {
    return PlaceInInterval(hn::Mul(from.Extinction, over), hn::Mul(to.Extinction, over), depth);
  };
  const Vf places[2] = { placeOf(front, middle, first, lengths[0]),
    placeOf(middle, back, second, lengths[1]) };
  const Vf entries[2] = { Lerp(front.Entry, middle.Entry, places[0]),
    Lerp(middle.Entry, back.Entry, places[1]) };
  const PacketTable::Range& range = scene.Table.GetRange(0);
  const Vf entry = hn::IfThenElse(some, Lerp(entries[1], entries[0], part), middle.Entry);
  interval.Value = hn::MulAdd(entry, Splat(1.0f / range.Scale), Splat(range.Low));
  interval.Place =
    hn::IfThenElse(some, Lerp(hn::MulAdd(rest, places[1], at), hn::Mul(at, places[0]), part), at);
  return interval;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
