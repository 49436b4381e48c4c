// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Compositing the intervals between the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_INTERVALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_INTERVALS_INL_H_
#undef FFD_SIMD_INTERVALS_INL_H_
#else
#define FFD_SIMD_INTERVALS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "Optics/FFDIntervalTable.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdGradients-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdSampler-inl.h"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Optical depths below this have no place that matters.
constexpr float LeastOpticalDepth = 1e-6f;

/// In the place of where rays enter the volume, where they do not.
constexpr float Nowhere = -1e30f;

/// Entries of the interval table at values.
struct IntervalPoint
{
  Vf Entry;      ///< of the transfer table, and its fraction
  Vf Extinction; ///< per data unit
  Vi Integral;   ///< modulo 2^32
};

/// As Copy() of vectors.
HWY_INLINE IntervalPoint Copy(const IntervalPoint& point)
{
  return { point.Entry, point.Extinction, point.Integral };
}

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

/// Classifies, lights and composites the intervals between the samples of a packet, front to back:
/// pre-integrated classification, see IntervalTable.
template <class T>
class IntervalCompositor
{
public:
  /// Keeps a reference to what finds the samples.
  explicit IntervalCompositor(PacketGradients<T>& samples)
    : Samples(samples)
    , Scene(samples.Scene)
    , LastNumber(Splat(NoNumber))
    , LastValue(hn::Zero(Df()))
    , LastPointNumber(Splat(NoNumber))
  {
  }

  /**
   * Takes the intervals that end at samples, at s of a curve, in the lanes of `sampled`, as
   * RayIntegrator::CompositeInterval(). `number`: that of the samples; n: the same, where a window
   * of voxels follows them; `inner`: all are the samples n, and all voxels that they and their
   * gradients need exist.
   */
  HWY_NOINLINE void Take(const PacketCurve& curve, int n, Vf number, Vf s, Mf sampled, bool inner)
  {
    const Vec3 end = curve.At(this->Scene, s);
    this->Take(curve, n, number, s, sampled,
      inner ? this->Samples.FindInnerValue(n, end, sampled) : this->Samples.FindValue(end, sampled),
      inner);
  }

  /// Takes intervals as PacketCompositor::TakeSamples() takes samples.
  template <bool AtFaces>
  HWY_INLINE int TakeAll(const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    return this->Samples.template ForValues<0, AtFaces>(
      curve, numbers, from, to, [&](int n, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
        this->Take(curve, n, Splat(static_cast<float>(n)), s, sampled, value, !AtFaces);
      });
  }

private:
  /// Take() of intervals at whose ends the values are `back`.
  HWY_INLINE void Take(
    const PacketCurve& curve, int n, Vf number, Vf s, Mf sampled, Vf back, bool inner)
  {
    const Df d;
    const PacketIntegrals& integrals = this->Scene.Integrals;
    this->Samples.Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    const Mf unknown = hn::AndNot(hn::Eq(this->LastNumber, hn::Sub(number, Splat(1.0f))), sampled);
    Vf front = this->LastValue;
    Vf face = Splat(Nowhere);
    const bool known = hn::AllFalse(d, unknown);
    if (HWY_UNLIKELY(!known))
    {
      // Straight rays begin at the faces.
      face = inner || this->Scene.Identity ? face : this->FindEntry(curve, s, unknown);
      front =
        hn::IfThenElse(unknown, this->FindFront(curve, n, s, face, unknown, back, inner), front);
    }
    this->LastValue = hn::IfThenElse(sampled, back, this->LastValue);
    this->LastNumber = hn::IfThenElse(sampled, number, this->LastNumber);
    // As IntervalTable::MayShow(). Comparisons with what is not a number are false.
    const Vf difference = hn::Abs(hn::Sub(back, front));
    sampled = hn::And(sampled,
      hn::And(hn::Ge(hn::Add(hn::Max(front, back), difference), Splat(integrals.VisibleLow)),
        hn::Le(hn::Sub(hn::Min(front, back), difference), Splat(integrals.VisibleHigh))));
    if (!hn::AllFalse(d, sampled))
    {
      inner ? this->template Show<false>(curve, n, number, s, face, sampled, front, back, known)
            : this->template Show<true>(curve, n, number, s, face, sampled, front, back, known);
    }
  }

  /// Where the intervals that end at s begin, on the curve. `face`: where the rays enter the volume
  /// in them, or Nowhere.
  HWY_INLINE Vf FindBegin(const PacketCurve& curve, Vf s, Vf face) const
  {
    return hn::Max(face,
      hn::Max(
        hn::Sub(s, curve.PerStep), hn::Div(hn::Sub(this->Samples.Rays.From, curve.T0), curve.Dt)));
  }

  /// Where the rays of `lanes` enter the volume in the intervals that end at s, or Nowhere.
  HWY_NOINLINE Vf FindEntry(const PacketCurve& curve, Vf s, Mf lanes) const
  {
    const Vf nowhere = Splat(Nowhere);
    const Vf begin = this->FindBegin(curve, s, nowhere);
    const Mf enter = hn::AndNot(IsInside(this->Scene, curve.At(this->Scene, begin)), lanes);
    return hn::AllFalse(Df(), enter)
      ? nowhere
      : hn::IfThenElse(enter, FindFace(this->Scene, curve, s, begin), nowhere);
  }

  /// Intervals whose ends are looked up.
  struct Interval
  {
    IntervalPoint First;
    IntervalPoint Last;
    Vf Begin; ///< on the curve
    Vf Extent;
    Vf Length; ///< data units
    Vf At;     ///< the place, 0 to 1, of the value that tells more of it
  };

  /// Looks up the intervals of `lanes` that end at the samples `number`, at s of a curve, between
  /// two values. `face`: as of FindBegin(); `known`: whether they begin with the ends of those
  /// before.
  HWY_INLINE Interval FindInterval(
    const PacketCurve& curve, Vf number, Vf s, Vf face, Mf lanes, Vf front, Vf back, bool known)
  {
    const PacketScene& scene = this->Scene;
    const Vf begin = this->FindBegin(curve, s, face);
    const Vf extent = hn::Sub(s, begin);
    const Vf length = hn::Mul(extent,
      scene.Settings.Opacity == OpacityLength::Deformed
        ? curve.Dt
        : FindLength(scene, curve.Position.Slope(s)));
    // Where the interval before was looked up, this one begins with its end.
    const Mf behind = hn::Eq(this->LastPointNumber, hn::Sub(number, Splat(1.0f)));
    const IntervalPoint first = known && hn::AllFalse(Df(), hn::AndNot(behind, lanes))
      ? Copy(this->LastPoint)
      : FindIntervalPoint(scene, front);
    const IntervalPoint last = FindIntervalPoint(scene, back);
    this->LastPoint.Entry = last.Entry;
    this->LastPoint.Extinction = last.Extinction;
    this->LastPoint.Integral = last.Integral;
    // Rays that wait for others to take their samples have no value here.
    const Mf taken = hn::Eq(this->LastNumber, number);
    this->LastPointNumber = hn::IfThenElse(taken, number, Splat(NoNumber));
    const Vf guess = hn::Mul(FindMeanExtinction(scene, first, last), length);
    const Vf place =
      FindPlaceOfLight(hn::Mul(first.Extinction, length), hn::Mul(last.Extinction, length), guess);
    const Vf at = hn::IfThenElse(hn::Gt(guess, hn::Zero(Df())), place, Splat(0.5f));
    return { Copy(first), Copy(last), begin, extent, length, at };
  }

  /// Classifies, lights and composites intervals of the lanes of `sampled`, whose voxels are
  /// fetched at q, in the voxel coordinates `voxel`; `value`: what they hold there.
  template <class Source>
  HWY_INLINE void Composite(Source& voxels, const SamplePosition& in, const SampleRows<T>& rows,
    Vf value, Mf border, const PacketCurve& curve, const Interval& interval, const Vec3& q,
    const Vec3& voxel, Mf sampled)
  {
    const Df d;
    const PacketScene& scene = this->Scene;
    const ClassifiedIntervals classified = ClassifyIntervals(scene, interval.First,
      FindIntervalPoint(scene, value), interval.Last, interval.At, interval.Length);
    const Mf visible =
      hn::And(sampled, hn::And(hn::Gt(classified.OpticalDepth, hn::Zero(d)), hn::Eq(value, value)));
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    this->Samples.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
    this->Samples.State.Expecting = visible;
    const PacketTable::Range& range = scene.Table.GetRange(0);
    Vec3 color =
      OpticsLookup(scene, hn::MulAdd(classified.Entry, Splat(1.0f / range.Scale), Splat(range.Low)))
        .Color();
    if (scene.Shade)
    {
      voxels.Widen();
      const Vf middle = hn::MulAdd(interval.At, interval.Extent, interval.Begin);
      const Vec3 gradient = this->Samples.FindGradient(
        voxels, in, rows, curve, q, voxel, middle, visible, border, scene.NormalsOfOpacity);
      color = this->Samples.Normals.Light(
        scene.Surface, curve, q, color, gradient, middle, curve.TimeAt(middle));
    }
    this->Samples.State.Add(visible, color, Exp2(hn::Neg(classified.OpticalDepth)),
      curve.TimeAt(hn::MulAdd(classified.Place, interval.Extent, interval.Begin)),
      scene.Settings.TerminationTransmittance);
  }

  /// Does what Show() does where the voxels are not in reach of a source of rows.
  HWY_NOINLINE void ShowFetched(const PacketCurve& curve, const Interval& interval, const Vec3& q,
    const Vec3& voxel, Mf sampled)
  {
    FetchedSample<T> fetched;
    FetchSample(this->Scene.Volume, voxel, sampled, this->Samples.Border, fetched);
    this->Composite(fetched.Voxels, fetched.At, fetched.Rows, fetched.Value, fetched.AtBorder,
      curve, interval, q, voxel, sampled);
  }

  /// Classifies, lights and composites the intervals of the lanes of `sampled`, between two values,
  /// as FindInterval(). Without `AtFaces` all voxels that they and their gradients need must exist.
  template <bool AtFaces>
  HWY_NOINLINE void Show(const PacketCurve& curve, int n, Vf number, Vf s, Vf face, Mf sampled,
    Vf front, Vf back, bool known)
  {
    const Interval interval =
      this->FindInterval(curve, number, s, face, sampled, front, back, known);
    const Vec3 q = this->Samples.ClampToVolume(
      curve.At(this->Scene, hn::MulAdd(interval.At, interval.Extent, interval.Begin)));
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    const auto otherwise = [&]() FFD_INLINE_LAMBDA {
      this->ShowFetched(curve,
        { Copy(interval.First), Copy(interval.Last), interval.Begin, interval.Extent,
          interval.Length, interval.At },
        Copy(q), Copy(voxel), sampled);
    };
    if (AtFaces && !curve.Segment)
    {
      return otherwise();
    }
    this->Samples.template UseRows<AtFaces>(
      n, voxel, sampled,
      [&](auto& voxels, const SamplePosition& in, Mf border) FFD_INLINE_LAMBDA {
        SampleRows<T> rows;
        const Vf value = Sample<T>(voxels, in, rows);
        this->Composite(voxels, in, rows, value, border, curve, interval, q, voxel, sampled);
      },
      otherwise);
  }

  /// Values where the intervals that end at the samples n begin, if the samples before were not
  /// taken: those of `lanes`. `face`: as of FindBegin(). What is cropped there looks as the ends of
  /// the intervals.
  HWY_NOINLINE Vf FindFront(
    const PacketCurve& curve, int n, Vf s, Vf face, Mf lanes, Vf back, bool inner)
  {
    const Vf begin = this->FindBegin(curve, s, face);
    const Vec3 q = curve.At(this->Scene, begin);
    const Vf value = inner ? this->Samples.FindInnerValue(n, q, lanes)
                           : this->Samples.FindValue(this->Samples.ClampToVolume(q), lanes);
    if (this->Scene.CropSpace == Cropping::Spaces::None)
    {
      return value;
    }
    const bool rest = this->Scene.CropSpace == Cropping::Spaces::Rest;
    const Vec3 p = rest
      ? q
      : MulAdd(curve.TimeAt(begin), this->Samples.Rays.Direction, this->Samples.Rays.Origin);
    return hn::IfThenElse(IsUncropped(this->Scene, p), value, back);
  }

  PacketGradients<T>& Samples;
  const PacketScene& Scene;

  // The last samples, their numbers and values.
  Vf LastNumber;
  Vf LastValue;

  // The points at the ends of the last intervals that were looked up, and their numbers.
  IntervalPoint LastPoint;
  Vf LastPointNumber;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
