// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Extremes, sums and surfaces along the rays of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_BLEND_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_BLEND_INL_H_
#undef FFD_SIMD_BLEND_INL_H_
#else
#define FFD_SIMD_BLEND_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdChannels-inl.h"
#include "FFDSimdComposite-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdNormals-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdTable-inl.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <type_traits>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Blends the samples of a packet in the modes that do not composite, and in all modes where the
/// RayIntegrator of each ray takes them.
template <class T>
class PacketBlending
{
public:
  /// Keeps references to all.
  PacketBlending(const PacketScene& scene, PacketScratch& scratch, const RayPacket& rays,
    PacketCompositor<T>& samples)
    : Scene(scene)
    , Scratch(scratch)
    , Rays(rays)
    , Samples(samples)
    , State(samples.State)
    , Normals(samples.Normals)
    , Border(samples.Border)
    , Channels(scene, scratch.Statistics, samples)
    , Pending(hn::FirstN(Df(), 0))
  {
  }

  /// Begins the packet whose first pixel is (x0, y0), `width` pixels wide, before its samples.
  HWY_NOINLINE void Begin(int x0, int y0, int width)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    if (this->HasChannels())
    {
      this->Channels.Begin();
      return;
    }
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        this->State.Out.Tally = Splat(-NoExtreme);
        return;
      case PacketSampling::Surface:
        this->State.Out.TallyStep = Splat(-1e30f);
        // Lanes that cross nothing are numbers, too.
        this->Next = { { zero, zero, zero, zero }, zero, zero, zero, { zero, zero, zero }, true };
        return;
      case PacketSampling::PerRay:
        break;
      default:
        return;
    }
    HWY_ALIGN float from[16], to[16];
    hn::Store(this->Rays.From, d, from);
    hn::Store(this->Rays.To, d, to);
    std::vector<RayIntegrator>& integrators = this->Scratch.Integrators;
    integrators.resize(hn::MaxLanes(Df()));
    for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane)
    {
      integrators[static_cast<std::size_t>(lane)].Begin(*this->Scene.Frame,
        this->Scene.Source->Camera.MakeRay(x0 + lane % width + 0.5, y0 + lane / width + 0.5),
        static_cast<double>(from[lane]), static_cast<double>(to[lane]));
    }
  }

  /// Takes the samples n of the lanes of `sampled` at q, the position at s of a curve; `inner`: all
  /// voxels that they and the intervals behind them need exist.
  HWY_NOINLINE void Take(
    const PacketCurve& curve, const Vec3& q, Vf s, int n, Mf sampled, bool inner)
  {
    const bool surfaces = this->Scene.Sampling == PacketSampling::Surface;
    this->Inner = inner && this->Scene.Volume.Components == 1;
    this->Count(sampled);
    if (this->Scene.HidesSamples && !surfaces)
    {
      sampled = LeaveOutHidden(this->Scene, q, sampled);
      if (hn::AllFalse(Df(), sampled))
      {
        return;
      }
    }
    if (this->HasChannels())
    {
      return this->Channels.Take(curve, q, s, sampled);
    }
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        return this->TakeExtreme(curve,
          inner ? this->Samples.FindInnerValue(n, q, sampled) : this->Samples.FindValue(q, sampled),
          s, sampled);
      case PacketSampling::Sum:
        return this->AddUp(curve, q, s, sampled);
      case PacketSampling::Slice:
        return this->TakeSlice(curve, q, s, sampled);
      case PacketSampling::Surface:
        return this->CrossSurfaces(curve, q, s, n, sampled, nullptr);
      default:
        return this->TakeSamplePerRay(curve, s, sampled);
    }
  }

  /**
   * Takes extremes or surfaces of the samples from `from` on, before `to`, of a curve of a segment
   * as Take() does. Without `AtFaces` all voxels that they and the intervals behind them need must
   * exist. Returns the number of the sample with which all rays have ended, or `to`.
   */
  template <bool AtFaces>
  HWY_INLINE int TakePart(const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    this->Inner = !AtFaces;
    if (this->Scene.Sampling == PacketSampling::Extreme)
    {
      return this->Samples.template ForValues<0, AtFaces>(
        curve, numbers, from, to, [&](int, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
          this->Count(sampled);
          this->TakeExtreme(curve, value, s, sampled);
        });
    }
    return this->Samples.template ForValues<1, AtFaces>(
      curve, numbers, from, to, [&](int n, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
        this->Count(sampled);
        if constexpr (AtFaces)
        {
          return this->CrossSurfaces(curve, curve.At(this->Scene, s), s, n, sampled, &value);
        }
        Interval interval{ s, hn::Add(s, curve.PerStep), this->State.Out.Tally, value };
        this->FindBeginning(curve, n, sampled, sampled, interval);
        this->CrossSurfaces(curve, n, sampled, sampled, interval);
      });
  }

  /// Finds the pixels of the rays, after their last samples.
  HWY_NOINLINE void End()
  {
    if (this->HasChannels())
    {
      return this->Channels.End();
    }
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        return this->EndExtremes();
      case PacketSampling::Sum:
        return this->EndSums();
      case PacketSampling::PerRay:
        return this->EndIntegrators();
      default:
        return;
    }
  }

  /// Whether extremes have changed since this was asked for last.
  HWY_INLINE bool TakeNews()
  {
    bool& kept = this->HasChannels() ? this->Channels.News : this->News;
    const bool news = kept;
    kept = false;
    return news;
  }

  /// The largest values of a channel so far, or the smallest ones negated.
  HWY_INLINE Vf GetExtreme(std::size_t channel) const
  {
    return this->HasChannels() ? this->Channels.GetExtreme(channel) : this->State.Out.Tally;
  }

  /// Makes the extremes so far a little less, so that they are found again.
  HWY_INLINE void LowerExtremes()
  {
    if (this->HasChannels())
    {
      return this->Channels.LowerExtremes();
    }
    Vf& tally = this->State.Out.Tally;
    tally = BelowExtreme(tally, this->Scene.LastExtreme);
  }

  /// Composites what the samples of a curve have crossed, before another curve begins.
  HWY_INLINE void EndCurve(const PacketCurve& curve)
  {
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), this->Pending)))
    {
      this->AddSurfaces(curve);
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

  static constexpr int FaceSteps = 20;
  /// The search for a crossing ends when it is known to this part of an interval, or after so many
  /// steps.
  static constexpr float CloseCrossing = 1e-2f;
  static constexpr int CrossingSteps = 40;

  /// The segment of one ray of the packet, as its RayIntegrator takes it.
  class LaneSegment : public SampledSegment
  {
  public:
    LaneSegment(PacketNormals& normals, const PacketCurve& curve, std::size_t lane,
      const CurveSegment& segment, double t0, double dt)
      : SampledSegment(segment, t0, dt)
      , Normals(normals)
      , OfAll(curve)
      , Lane(lane)
    {
    }

    glm::dvec3 GradientToDeformed(double s, const glm::dvec3& byIndex) const override
    {
      return this->Normals.GradientOfRay(this->OfAll, this->Lane, static_cast<float>(s), byIndex);
    }

  private:
    PacketNormals& Normals;
    const PacketCurve& OfAll;
    std::size_t Lane;
  };

  void EndIntegrators()
  {
    const Df d;
    HWY_ALIGN float r[16], g[16], b[16], transmittance[16], t[16];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      const RayIntegrator::Result result = this->Scratch.Integrators[lane].End();
      r[lane] = result.Color.r;
      g[lane] = result.Color.g;
      b[lane] = result.Color.b;
      transmittance[lane] = result.Transmittance;
      t[lane] = static_cast<float>(std::min(result.FirstVisible, 1e30));
    }
    this->State.Out.Color = { hn::Load(d, r), hn::Load(d, g), hn::Load(d, b) };
    this->State.Out.Transmittance = hn::Load(d, transmittance);
    this->State.Out.FirstVisible = hn::Load(d, t);
  }

  /// Whether samples are those of several components; surfaces are of one, or of the intensity.
  bool HasChannels() const
  {
    return this->Scene.Volume.Components > 1 && this->Scene.Sampling != PacketSampling::Surface;
  }

  void EndExtremes()
  {
    PacketPixels& out = this->State.Out;
    const Mf any = hn::Gt(out.Tally, Splat(-NoExtreme));
    const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
    const Vf extreme = hn::IfThenElseZero(any, out.Tally);
    this->ShowValues(maximum ? extreme : hn::Neg(extreme), any);
    out.FirstVisible =
      hn::IfThenElse(hn::Lt(out.Transmittance, Splat(1.0f)), out.FirstVisible, Splat(1e30f));
  }

  void EndSums()
  {
    const Blending& blend = this->Scene.Source->Blend;
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    const Mf any = hn::Gt(this->State.Out.TallyLength, zero);
    const Vf over = blend.Mode == BlendMode::Average
      ? hn::IfThenElse(any, this->State.Out.TallyLength, one)
      : Splat(static_cast<float>(blend.UnitDistance[0]));
    const Vf gray = hn::IfThenElseZero(any,
      Clamp(
        hn::Mul(Splat(static_cast<float>(blend.Weight[0])), hn::Div(this->State.Out.Tally, over)),
        zero, one));
    this->State.Out.Color = { gray, gray, gray };
    this->State.Out.Transmittance = hn::IfThenElse(any, zero, one);
  }

  /// Interpolates values at positions in the volume.
  HWY_INLINE Vf ValuesAt(const Vec3& q, Mf lanes, bool inner)
  {
    if (HWY_UNLIKELY(this->Scene.Volume.Components > 1))
    {
      Vf values[LargestNumberOfComponents];
      this->Samples.FindComponents(q, lanes, values);
      return IntensityOf(this->Scene, this->GetSurfaceChannel(), values);
    }
    return HWY_LIKELY(inner) ? this->Samples.FindInnerValue(q, lanes)
                             : this->Samples.FindValue(q, lanes);
  }

  std::size_t GetSurfaceChannel() const
  {
    return this->Scene.KindOfComponents == ComponentKind::Independent
      ? static_cast<std::size_t>(this->Scene.Source->Blend.IsoComponent)
      : 0;
  }

  HWY_INLINE void Count(Mf sampled)
  {
    this->Scratch.Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(Df(), sampled));
  }

  /// Keeps the largest value; minima are found as maxima of the negated values.
  HWY_INLINE void TakeExtreme(const PacketCurve& curve, Vf value, Vf s, Mf sampled)
  {
    const Df d;
    const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
    value = maximum ? value : hn::Neg(value);
    // Comparisons with what is not a number are false.
    const Mf better = hn::And(sampled, hn::Gt(value, this->State.Out.Tally));
    if (hn::AllFalse(d, better))
    {
      return;
    }
    this->News = true;
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, better));
    this->State.Out.Tally = hn::IfThenElse(better, value, this->State.Out.Tally);
    this->State.Out.FirstVisible =
      hn::IfThenElse(better, curve.TimeAt(s), this->State.Out.FirstVisible);
    const Vf end = Splat(this->Scene.LastExtreme);
    this->State.Alive = hn::AndNot(hn::Ge(this->State.Out.Tally, end), this->State.Alive);
  }

  HWY_INLINE void AddUp(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Df d;
    const Vf one = Splat(1.0f);
    const Vf value = this->ValuesAt(q, sampled, this->Inner);
    Mf counts = hn::And(sampled, hn::Eq(value, value));
    if (this->Scene.Source->Blend.Mode == BlendMode::Average)
    {
      counts = hn::And(counts,
        hn::And(hn::Ge(value, Splat(this->Scene.AverageMin)),
          hn::Le(value, Splat(this->Scene.AverageMax))));
    }
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, counts));
    const Vf opacity = HWY_UNLIKELY(this->Scene.Plane.Texels != nullptr)
      ? FindOpacityOfLastRow(this->Scene.Plane, value)
      : this->OpacityOver(TableLookup(this->Scene, value).Extinction());
    const Vf relative = hn::Mul(hn::Sub(value, Splat(this->Scene.ValueLow)),
      Splat(1.0f / (this->Scene.ValueHigh - this->Scene.ValueLow)));
    const Vf length = this->Scene.Settings.Opacity == OpacityLength::Deformed
      ? Splat(static_cast<float>(this->Scene.Settings.SampleDistance))
      : hn::Mul(curve.PerStep, FindLength(this->Scene, curve.Position.Slope(s)));
    this->State.Out.Tally = hn::Add(this->State.Out.Tally,
      hn::IfThenElseZero(counts, hn::Mul(hn::Mul(opacity, relative), length)));
    this->State.Out.TallyLength =
      hn::Add(this->State.Out.TallyLength, hn::IfThenElseZero(counts, length));
    this->State.Out.FirstVisible = hn::IfThenElse(
      counts, hn::Min(this->State.Out.FirstVisible, curve.TimeAt(s)), this->State.Out.FirstVisible);
  }

  /// The opacity over the unit distance that an extinction gives.
  HWY_INLINE Vf OpacityOver(Vf extinction) const
  {
    return hn::Sub(
      Splat(1.0f), Exp2(hn::Neg(hn::Mul(extinction, Splat(this->Scene.UnitDistance)))));
  }

  /// Shows the values of the lanes of `sampled`; as RayIntegrator::AddSlice().
  HWY_NOINLINE void TakeSlice(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Df d;
    const Mf visible = this->ShowValues(this->Samples.FindValue(q, sampled), sampled);
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
    this->State.Out.FirstVisible =
      hn::IfThenElse(visible, curve.TimeAt(s), this->State.Out.FirstVisible);
  }

  /// Makes the pixels of the rays of `lanes` those of one value each; returns those that are
  /// visible.
  HWY_INLINE Mf ShowValues(Vf value, Mf lanes)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    const Vf one = Splat(1.0f);
    // Gradients count as large.
    PlaneTexel texel;
    Mf some;
    if (HWY_UNLIKELY(this->Scene.Plane.Texels != nullptr))
    {
      texel = LookUpLastRow(this->Scene.Plane, value);
      some = hn::Gt(texel.Opacity, zero);
    }
    else
    {
      const TableLookup lookup(this->Scene, value);
      texel = { lookup.Color(), this->OpacityOver(lookup.Extinction()) };
      some = hn::Gt(lookup.Extinction(), zero);
    }
    const Vf weight = Splat(static_cast<float>(this->Scene.Source->Blend.Weight[0]));
    // NaN is not shown: comparisons with it are false.
    const Mf visible =
      hn::And(hn::And(lanes, hn::Eq(value, value)), hn::And(some, hn::Gt(weight, zero)));
    const Vf shown = hn::IfThenElseZero(visible, hn::Min(hn::Mul(weight, texel.Opacity), one));
    this->State.Out.Color = Scale(shown, texel.Color);
    this->State.Out.Transmittance = hn::Sub(one, shown);
    return visible;
  }

  /// Composites the surfaces between a sample and the next one, as RayIntegrator does: an interval
  /// that leaves or enters the volume ends at the face. `next`: the values at the next samples that
  /// are in the volume, or null.
  HWY_NOINLINE void CrossSurfaces(
    const PacketCurve& curve, const Vec3& q, Vf s, int n, Mf lanes, const Vf* next)
  {
    const Df d;
    const Vec3 end = curve.At(this->Scene, hn::Add(s, curve.PerStep));
    const Mf insideA = this->Inner ? lanes : hn::And(lanes, IsInside(this->Scene, q));
    const Mf insideB = this->Inner ? lanes : hn::And(lanes, IsInside(this->Scene, end));
    const Mf any = hn::Or(insideA, insideB);
    if (hn::AllFalse(d, any))
    {
      return;
    }
    Interval interval{ s, hn::Add(s, curve.PerStep), this->State.Out.Tally, hn::Zero(d) };
    const Mf faces = hn::Xor(insideA, insideB);
    if (HWY_UNLIKELY(!hn::AllFalse(d, faces)))
    {
      this->FindFaces(curve, faces, insideA, interval);
      next = nullptr;
    }
    this->FindBeginning(curve, n, insideA, any, interval);
    interval.B = next ? *next
      : this->Inner   ? this->Samples.FindInnerValue(n + 1, end, any)
                      : this->ValuesAt(this->PositionAt(curve, interval.To), any, false);
    this->CrossSurfaces(curve, n, insideB, any, interval);
  }

  /// Finds the values where the intervals behind the samples n begin, of the lanes of `any`;
  /// `inside`: rays whose samples are in the volume.
  HWY_INLINE void FindBeginning(
    const PacketCurve& curve, int n, Mf inside, Mf any, Interval& interval)
  {
    // Intervals that follow each other share a value: no surface slips through between them.
    const Mf known =
      hn::And(inside, hn::Eq(this->State.Out.TallyStep, Splat(static_cast<float>(n))));
    const Mf unknown = hn::AndNot(known, any);
    if (!hn::AllFalse(Df(), unknown))
    {
      interval.A = hn::IfThenElse(unknown,
        this->ValuesAt(this->PositionAt(curve, interval.From), unknown, this->Inner), interval.A);
    }
  }

  /// Composites the surfaces in the intervals behind the samples n, of the lanes of `any`;
  /// `inside`: rays that are in the volume at the next sample.
  HWY_INLINE void CrossSurfaces(
    const PacketCurve& curve, int n, Mf inside, Mf any, const Interval& interval)
  {
    const Df d;
    this->State.Out.Tally = hn::IfThenElse(any, interval.B, this->State.Out.Tally);
    this->State.Out.TallyStep =
      hn::IfThenElse(inside, Splat(static_cast<float>(n + 1)), Splat(-1e30f));
    // Values ascend, so do the crossings, or they descend. One at an end belongs to the interval
    // where the scalar passes it. Comparisons with what is not a number find none.
    const Mf up = hn::And(any, hn::Lt(interval.A, interval.B));
    const Mf down = hn::And(any, hn::Gt(interval.A, interval.B));
    const Vf low = hn::Min(interval.A, interval.B);
    const Vf high = hn::Max(interval.A, interval.B);
    const std::size_t count = this->Scene.IsoValues.size();
    const auto cross = [&](const PacketSurfaceValue& iso, Mf way) {
      const Vf value = Splat(iso.Value);
      const Mf crossed =
        hn::And(hn::And(way, this->State.Alive), hn::And(hn::Lt(low, value), hn::Le(value, high)));
      if (!hn::AllFalse(d, crossed))
      {
        this->AwaitSurface(curve, interval, iso, crossed);
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
    if (!curve.Segment || hn::AllFalse(d, hn::AndNot(this->Pending, this->State.Alive)))
    {
      this->AddSurfaces(curve);
    }
  }

  /// Remembers the surface of a value between the ends of an interval. Surfaces of several
  /// intervals are found together, each ray's before its next one.
  HWY_NOINLINE void AwaitSurface(
    const PacketCurve& curve, const Interval& interval, const PacketSurfaceValue& iso, Mf lanes)
  {
    if (!hn::AllFalse(Df(), hn::And(lanes, this->Pending)))
    {
      this->AddSurfaces(curve);
      lanes = hn::And(lanes, this->State.Alive);
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
    const Vec3 q = curve.At(this->Scene, s);
    const Vf lower = Splat(this->Scene.Lower);
    const float* upper = this->Scene.Upper;
    return { Clamp(q.x, lower, Splat(upper[0])), Clamp(q.y, lower, Splat(upper[1])),
      Clamp(q.z, lower, Splat(upper[2])) };
  }

  /// Moves the ends of intervals that are outside of the volume to its faces.
  HWY_NOINLINE void FindFaces(
    const PacketCurve& curve, Mf lanes, Mf insideA, Interval& interval) const
  {
    Vf inside = hn::IfThenElse(insideA, interval.From, interval.To);
    Vf outside = hn::IfThenElse(insideA, interval.To, interval.From);
    for (int i = 0; i < FaceSteps; ++i)
    {
      const Vf middle = hn::Mul(Splat(0.5f), hn::Add(inside, outside));
      const Mf in = IsInside(this->Scene, curve.At(this->Scene, middle));
      inside = hn::IfThenElse(in, middle, inside);
      outside = hn::IfThenElse(in, outside, middle);
    }
    interval.From = hn::IfThenElse(hn::AndNot(insideA, lanes), inside, interval.From);
    interval.To = hn::IfThenElse(hn::And(insideA, lanes), inside, interval.To);
  }

  /// Composites the surfaces of the rays of Pending.
  HWY_NOINLINE void AddSurfaces(const PacketCurve& curve)
  {
    const Df d;
    const Mf lanes = hn::And(this->Pending, this->State.Alive);
    this->Pending = hn::FirstN(d, 0);
    if (hn::AllFalse(d, lanes))
    {
      return;
    }
    const Crossing& next = this->Next;
    const Vf s = this->FindCrossing(curve, next, lanes);
    const Vec3 q = this->PositionAt(curve, s);
    const Vf t = curve.TimeAt(s);
    Mf shown = hn::And(lanes, hn::And(hn::Ge(t, this->Rays.From), hn::Lt(t, this->Rays.To)));
    shown = hn::And(shown, IsShown(this->Scene, this->Rays, curve, q, s));
    if (this->Scene.HidesSamples && !hn::AllFalse(d, shown))
    {
      shown = LeaveOutHidden(this->Scene, q, shown);
    }
    if (hn::AllFalse(d, shown))
    {
      return;
    }
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, shown));
    Vec3 color = next.Color;
    if (this->Scene.Shade)
    {
      const bool several = this->Scene.Volume.Components > 1;
      color = this->Normals.Light(
        several ? this->Scene.Components[this->GetSurfaceChannel()].Surface : this->Scene.Surface,
        curve, q, color, this->GradientsAt(curve, q, s, shown), s, t);
    }
    this->State.Add(shown, color, hn::Sub(Splat(1.0f), next.Opacity), t,
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
    typename PacketCompositor<T>::CellValues cells(this->Scene.Volume);
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
      ? this->Samples.FindIntensityGradient(curve, q, s, lanes, this->GetSurfaceChannel())
      : this->Samples.FindNormalGradient(curve, q, s, lanes);
  }

  /// Hands a sample of each lane to the RayIntegrator of its ray.
  HWY_NOINLINE void TakeSamplePerRay(const PacketCurve& curve, Vf s, Mf sampled)
  {
    const Df d;
    HWY_ALIGN float at[16], interval[16], t0[16], dt[16], flag[16];
    HWY_ALIGN float terms[3 * TileLayers][16];
    hn::Store(s, d, at);
    hn::Store(curve.PerStep, d, interval);
    hn::Store(curve.T0, d, t0);
    hn::Store(curve.Dt, d, dt);
    hn::Store(hn::IfThenElseZero(sampled, Splat(1.0f)), d, flag);
    for (int k = 0; k < TileLayers; ++k)
    {
      hn::Store(curve.Position.Terms[k].x, d, terms[3 * k]);
      hn::Store(curve.Position.Terms[k].y, d, terms[3 * k + 1]);
      hn::Store(curve.Position.Terms[k].z, d, terms[3 * k + 2]);
    }
    HWY_ALIGN float done[16] = {};
    CastStatistics& statistics = this->Scratch.Statistics;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      if (flag[lane] == 0.0f)
      {
        continue;
      }
      CurveSegment segment;
      for (int k = 0; k < TileLayers; ++k)
      {
        segment.Terms[k] =
          glm::dvec3(terms[3 * k][lane], terms[3 * k + 1][lane], terms[3 * k + 2][lane]);
      }
      for (int a = 0; a < 3; ++a)
      {
        segment.Terms[0][a] -= this->Scene.IndexShift[a];
      }
      const LaneSegment one(this->Normals, curve, lane, segment, static_cast<double>(t0[lane]),
        static_cast<double>(dt[lane]));
      const RayIntegrator::Outcome outcome = this->Scratch.Integrators[lane].AddSample(
        one, static_cast<double>(at[lane]), static_cast<double>(interval[lane]));
      statistics.VisibleSamples += outcome.Visible ? 1 : 0;
      done[lane] = outcome.Done ? 1.0f : 0.0f;
    }
    this->State.Alive = hn::AndNot(hn::Gt(hn::Load(d, done), hn::Zero(d)), this->State.Alive);
  }

  const PacketScene& Scene;
  PacketScratch& Scratch;
  const RayPacket& Rays;
  PacketCompositor<T>& Samples;
  PacketState& State;
  PacketNormals& Normals;
  BorderSamples<T>& Border;
  ChannelBlending<T> Channels; ///< of several components
  bool News = false;           ///< see TakeNews()
  bool Inner = false;          ///< of the samples that are taken, see Take()
  Crossing Next;               ///< of the rays of Pending
  Mf Pending;                  ///< rays whose last surface was crossed, but not composited
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
