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

#include "FFDSimdChannels-inl.h"
#include "FFDSimdComposite-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSurfaces-inl.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Blends the samples of a packet in the modes that do not composite.
template <class T>
class PacketBlending
{
public:
  /// Keeps references to all.
  PacketBlending(const PacketScene& scene, PacketScratch& scratch, PacketCompositor<T>& samples)
    : Scene(scene)
    , Scratch(scratch)
    , Samples(samples)
    , State(samples.State)
    , Channels(scene, scratch.Statistics, samples)
    , Surfaces(samples)
  {
  }

  /// Begins a packet, before its samples.
  HWY_NOINLINE void Begin()
  {
    if (this->HasChannels())
    {
      return this->Channels.Begin();
    }
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        this->State.Out.Tally = Splat(-NoExtreme);
        return;
      case PacketSampling::Surface:
        return this->Surfaces.Begin();
      default:
        return;
    }
  }

  /// Takes the samples of the lanes of `sampled` at q, the position at s of a curve. `number`:
  /// theirs; `inner`: all are the samples n, and all voxels that they and the intervals behind them
  /// need exist.
  HWY_NOINLINE void Take(
    const PacketCurve& curve, const Vec3& q, Vf s, int n, Vf number, Mf sampled, bool inner)
  {
    const bool surfaces = this->Scene.Sampling == PacketSampling::Surface;
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
        return this->AddUp(curve,
          inner ? this->Samples.FindInnerValue(q, sampled) : this->Samples.FindValue(q, sampled), s,
          sampled);
      case PacketSampling::Slice:
        return this->TakeSlice(curve, q, s, sampled);
      default:
        return this->Surfaces.Cross(
          curve, q, s, n, number, sampled, nullptr, inner && this->Scene.Volume.Components == 1);
    }
  }

  /// Whether TakePart() can take samples of a segment.
  template <bool AtFaces>
  HWY_INLINE bool HasLoop() const
  {
    return this->Scene.InnerBlending || this->Channels.template HasLoop<AtFaces>();
  }

  /**
   * Takes extremes, sums or surfaces of the samples from `from` on, before `to`, of a curve of a
   * segment as Take() does. Without `AtFaces` all voxels that they and the intervals behind them
   * need must exist. Returns the number of the sample with which all rays have ended, or `to`.
   */
  template <bool AtFaces>
  HWY_INLINE int TakePart(const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    if (this->HasChannels())
    {
      return this->Channels.template TakePart<AtFaces>(curve, numbers, from, to);
    }
    if (this->Scene.Sampling == PacketSampling::Extreme)
    {
      return this->Samples.template ForValues<0, AtFaces>(
        curve, numbers, from, to, [&](int, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
          this->Count(sampled);
          this->TakeExtreme(curve, value, s, sampled);
        });
    }
    if (this->Scene.Sampling == PacketSampling::Sum)
    {
      return this->Samples.template ForValues<0, AtFaces>(
        curve, numbers, from, to, [&](int, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
          this->Count(sampled);
          this->AddUp(curve, value, s, sampled);
        });
    }
    return this->Samples.template ForValues<1, AtFaces>(
      curve, numbers, from, to, [&](int n, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
        this->Count(sampled);
        const Vf number = Splat(static_cast<float>(n));
        if constexpr (AtFaces)
        {
          this->Surfaces.Cross(
            curve, curve.At(this->Scene, s), s, n, number, sampled, &value, false);
        }
        else
        {
          this->Surfaces.CrossInner(curve, s, number, sampled, value);
        }
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

  /// From now on samples are taken for the extremes of the channels `wanted`, a bit each.
  HWY_INLINE void Want(unsigned int wanted) { this->Channels.Wanted = wanted; }

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
  HWY_INLINE void EndCurve(const PacketCurve& curve) { this->Surfaces.EndCurve(curve); }

private:
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

  HWY_INLINE void AddUp(const PacketCurve& curve, Vf value, Vf s, Mf sampled)
  {
    const Df d;
    Mf counts = hn::And(sampled, hn::Eq(value, value));
    if (this->Scene.Source->Blend.Mode == BlendMode::Average)
    {
      counts = hn::And(counts,
        hn::And(hn::Ge(value, Splat(this->Scene.AverageMin)),
          hn::Le(value, Splat(this->Scene.AverageMax))));
    }
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, counts));
    const Vf opacity = HWY_UNLIKELY(this->Scene.Plane.Intervals != nullptr)
      ? FindOpacityOfLastRow(this->Scene.Plane, value)
      : OpticsLookup(this->Scene, value).Opacity();
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
    if (HWY_UNLIKELY(this->Scene.Plane.Intervals != nullptr))
    {
      texel = LookUpLastRow(this->Scene.Plane, value);
      some = hn::Gt(texel.Opacity, zero);
    }
    else
    {
      const OpticsLookup lookup(this->Scene, value);
      texel = { lookup.Color(), lookup.Opacity() };
      some = lookup.IsVisible();
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

  const PacketScene& Scene;
  PacketScratch& Scratch;
  PacketCompositor<T>& Samples;
  PacketState& State;
  ChannelBlending<T> Channels; ///< of several components
  SurfaceCrossings<T> Surfaces;
  bool News = false; ///< see TakeNews()
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
