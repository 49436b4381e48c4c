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

/// Optical depths below this have no place that matters.
constexpr float LeastOpticalDepth = 1e-6f;

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
  const Quads entry = LoadQuads(scene.Integrals.Entries[0].Words, Truncate(whole));
  const Vf extinction = hn::BitCast(d, entry.x);
  const Vf change = hn::BitCast(d, entry.y);
  // TransferTable::GetMargin()
  const Vf zero = hn::Zero(d);
  const Vf one = Splat(1.0f);
  const Vf margin = Splat(scene.Integrals.Margin);
  Vf f = hn::Sub(point.Entry, whole);
  f = hn::IfThenZeroElse(hn::And(hn::Le(extinction, zero), hn::Lt(f, margin)), f);
  f = hn::IfThenElse(
    hn::And(hn::Le(hn::Add(extinction, change), zero), hn::Gt(f, hn::Sub(one, margin))), one, f);
  point.Entry = hn::Add(whole, f);
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

constexpr float LogarithmOfTwo = 0.69314718f;

/// Mean place that the light of homogeneous intervals comes from. `depth`: in powers of e.
HWY_INLINE Vf FindPlaceOfLight(Vf depth)
{
  return RoughInverseSqrt(hn::MulAdd(depth, hn::Add(Splat(4.0f / 3.0f), depth), Splat(4.0f)));
}

HWY_INLINE Vf WeighOpacity(Vf depth)
{
  return hn::Mul(depth, hn::MulAdd(Splat(0.5f), depth, Splat(1.0f)));
}

/// Mean place that the light of intervals comes from whose ends may differ. `front` and `back`:
/// optical depths with the extinctions at the ends.
HWY_INLINE Vf FindPlaceOfLight(Vf front, Vf back, Vf opticalDepth)
{
  const Vf one = Splat(1.0f);
  const Vf scale = Splat(LogarithmOfTwo);
  const Mf crosses =
    hn::And(hn::Gt(opticalDepth, hn::Min(front, back)), hn::Lt(opticalDepth, hn::Max(front, back)));
  const Vf change = hn::Mul(hn::Sub(back, opticalDepth),
    RoughReciprocal(hn::IfThenElse(crosses, hn::Sub(back, front), one)));
  const Vf rest = hn::Sub(one, change);
  const Vf depths[2] = { hn::Mul(scale, hn::Mul(front, change)),
    hn::Mul(scale, hn::Mul(back, rest)) };
  const Vf first = WeighOpacity(depths[0]);
  const Vf behind = WeighOpacity(depths[1]);
  const Vf second = hn::Mul(behind, RoughReciprocal(hn::Add(one, behind)));
  const Vf sum = hn::Add(first, second);
  const Mf some = hn::Gt(sum, Splat(LeastOpticalDepth));
  const Vf weighed = hn::MulAdd(hn::Mul(first, change), FindPlaceOfLight(depths[0]),
    hn::Mul(second, hn::MulAdd(rest, FindPlaceOfLight(depths[1]), change)));
  const Vf place = hn::IfThenElse(
    some, hn::Mul(weighed, RoughReciprocal(hn::IfThenElse(some, sum, one))), Splat(0.5f));
  return hn::IfThenElse(crosses, place, FindPlaceOfLight(hn::Mul(scale, opticalDepth)));
}

/// The optical depth in intervals from which their light comes, in the mean.
HWY_INLINE Vf FindDepthOfLight(Vf opticalDepth)
{
  return hn::Mul(opticalDepth, FindPlaceOfLight(hn::Mul(Splat(LogarithmOfTwo), opticalDepth)));
}

/// The place, 0 to 1, where the optical depth in intervals is `depth`, at most `opticalDepth`, that
/// of all. `front` and `back`: those with the extinctions at the ends.
HWY_INLINE Vf FindPlaceOfDepth(Vf front, Vf back, Vf opticalDepth, Vf depth)
{
  const Vf one = Splat(1.0f);
  const Mf crosses =
    hn::And(hn::Gt(opticalDepth, hn::Min(front, back)), hn::Lt(opticalDepth, hn::Max(front, back)));
  const Vf change = hn::Mul(hn::Sub(back, opticalDepth),
    RoughReciprocal(hn::IfThenElse(crosses, hn::Sub(back, front), one)));
  const Vf before = hn::Mul(front, change);
  const Mf behind = hn::And(crosses, hn::Gt(depth, before));
  const Vf all = hn::IfThenElse(behind, back, hn::IfThenElse(crosses, front, opticalDepth));
  const Mf some = hn::Gt(all, Splat(LeastOpticalDepth));
  const Vf part = hn::Mul(hn::IfThenElse(behind, hn::Sub(depth, before), depth),
    RoughReciprocal(hn::IfThenElse(some, all, one)));
  const Vf place = hn::Add(part, hn::IfThenElseZero(behind, change));
  return hn::IfThenElse(some, Clamp(place, hn::Zero(Df()), one), Splat(0.5f));
}

/// Optical properties of the lanes' intervals.
struct ClassifiedIntervals
{
  Vf OpticalDepth;
  Vf Entry; ///< of the transfer table, and its fraction
  Vf Place;
};

/// IntervalTable::Classify() of two intervals with a point at the place `at` between them.
HWY_INLINE ClassifiedIntervals ClassifyIntervals(const PacketScene& scene,
  const IntervalPoint& front, const IntervalPoint& middle, const IntervalPoint& back, Vf at,
  Vf length)
{
  const Vf rest = hn::Sub(Splat(1.0f), at);
  const Vf lengths[2] = { hn::Mul(at, length), hn::Mul(rest, length) };
  const Vf first = hn::Mul(FindMeanExtinction(scene, front, middle), lengths[0]);
  const Vf second = hn::Mul(FindMeanExtinction(scene, middle, back), lengths[1]);
  ClassifiedIntervals interval;
  interval.OpticalDepth = hn::Add(first, second);
  const Vf depth = FindDepthOfLight(interval.OpticalDepth);
  const Mf behind = hn::Gt(depth, first);
  const Vf over = hn::IfThenElse(behind, lengths[1], lengths[0]);
  const Vf place =
    FindPlaceOfDepth(hn::Mul(over, hn::IfThenElse(behind, middle.Extinction, front.Extinction)),
      hn::Mul(over, hn::IfThenElse(behind, back.Extinction, middle.Extinction)),
      hn::IfThenElse(behind, second, first), hn::IfThenElse(behind, hn::Sub(depth, first), depth));
  interval.Entry = Lerp(hn::IfThenElse(behind, middle.Entry, front.Entry),
    hn::IfThenElse(behind, back.Entry, middle.Entry), place);
  interval.Place = hn::IfThenElse(behind, hn::MulAdd(rest, place, at), hn::Mul(at, place));
  return interval;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
