// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Extremes, sums and slices of several components. Included once per target of Highway.
#if defined(FFD_SIMD_CHANNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_CHANNELS_INL_H_
#undef FFD_SIMD_CHANNELS_INL_H_
#else
#define FFD_SIMD_CHANNELS_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdComponents-inl.h"
#include "FFDSimdComposite-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdOptics-inl.h"
#include "FFDSimdPlane-inl.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Extremes are above -NoExtreme once a sample has been taken.
constexpr float NoExtreme = 3e38f;

/// A little less than an extreme, and than the last one, with which rays end.
HWY_INLINE Vf BelowExtreme(Vf extreme, float last)
{
  const Vf below = hn::Sub(
    hn::Min(extreme, Splat(last)), hn::MulAdd(hn::Abs(extreme), Splat(1e-6f), Splat(1e-30f)));
  return hn::Max(below, Splat(-NoExtreme));
}

/// Blends the samples of a packet of several components, as RayIntegrator does: by channel, which
/// are the independent components, or all dependent ones together.
template <class T>
class ChannelBlending
{
public:
  /// Keeps references to all.
  ChannelBlending(
    const PacketScene& scene, CastStatistics& statistics, PacketCompositor<T>& samples)
    : Scene(scene)
    , Statistics(statistics)
    , Samples(samples)
    , State(samples.State)
    , Any(hn::FirstN(Df(), 0))
  {
  }

  HWY_NOINLINE void Begin()
  {
    const Vf zero = hn::Zero(Df());
    this->Position = { zero, zero, zero };
    ForComponents([&](auto c) {
      this->Extremes[c] = Splat(-NoExtreme);
      this->Places[c] = zero;
      this->Sums[c] = zero;
      this->Lengths[c] = zero;
    });
  }

  /// Takes the samples of the lanes of `sampled` at q, the position at s of a curve.
  HWY_NOINLINE void Take(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    Vf values[LargestNumberOfComponents];
    if (this->Scene.Sampling == PacketSampling::Extreme)
    {
      const unsigned int wanted =
        this->IsDependent() ? FindDensityComponents(this->Scene) : this->Wanted;
      this->Samples.FindComponents(q, sampled, wanted, values);
      for (std::size_t c = 0; c < this->Scene.Channels.size(); ++c)
      {
        if (IsWanted(this->Wanted, static_cast<int>(c)))
        {
          this->TakeExtreme(c, curve, DensityOf(this->Scene, c, values), s, sampled);
        }
      }
      return;
    }
    this->Samples.FindComponents(q, sampled, AllComponents, values);
    Mf visible;
    if (this->Scene.Sampling == PacketSampling::Sum)
    {
      visible = this->AddUp(curve, values, s, sampled);
    }
    else
    {
      const Mf lanes[LargestNumberOfComponents] = { sampled, sampled, sampled, sampled };
      const Vf t = curve.TimeAt(s);
      const Vf places[LargestNumberOfComponents] = { t, t, t, t };
      visible = this->Show(values, lanes, places);
    }
    this->Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(Df(), visible));
  }

  /// Whether TakePart() can take samples of a segment. Those of more than two channels are fetched
  /// lane by lane: that costs less than to look up each by itself.
  template <bool AtFaces>
  HWY_INLINE bool HasLoop() const
  {
    return this->Scene.InnerChannels && (this->IsOneWanted() || this->Scene.Channels.size() == 2) &&
      this->Samples.template HasComponentWindow<AtFaces>();
  }

  /// Takes extremes as PacketBlending::TakePart(), of the channels that are wanted.
  template <bool AtFaces>
  HWY_INLINE int TakePart(const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    if (!this->IsOneWanted())
    {
      return this->Samples.template ForPairsOfValues<AtFaces>(curve, numbers, from, to,
        [&](int, Vf s, Mf sampled, Vf first, Vf second) FFD_INLINE_LAMBDA {
          this->Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(Df(), sampled));
          this->TakeExtreme(0, curve, first, s, sampled);
          this->TakeExtreme(1, curve, second, s, sampled);
        });
    }
    const std::size_t c = hwy::Num0BitsBelowLS1Bit_Nonzero32(this->Wanted);
    return this->Samples.template ForComponentValues<AtFaces>(curve, numbers, from, to,
      this->Scene.Channels[c].Component, [&](int, Vf s, Mf sampled, Vf value) FFD_INLINE_LAMBDA {
        this->Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(Df(), sampled));
        this->TakeExtreme(c, curve, value, s, sampled);
      });
  }

  /// Finds the pixels of the rays, after their last samples.
  HWY_NOINLINE void End()
  {
    if (this->Scene.Sampling == PacketSampling::Extreme)
    {
      Mf lanes[LargestNumberOfComponents];
      Vf values[LargestNumberOfComponents];
      const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
      ForComponents([&](auto c) {
        lanes[c] = hn::Gt(this->Extremes[c], Splat(-NoExtreme));
        values[c] = maximum ? this->Extremes[c] : hn::Neg(this->Extremes[c]);
      });
      if (this->IsDependent())
      {
        this->Samples.FindComponents(this->Position, lanes[0], AllComponents, values);
      }
      this->Show(values, lanes, this->Places);
    }
    else if (this->Scene.Sampling == PacketSampling::Sum)
    {
      this->EndSums();
    }
  }

  /// The largest values of a channel so far, or the smallest ones negated.
  Vf GetExtreme(std::size_t channel) const { return this->Extremes[channel]; }

  /// Makes the extremes so far a little less, so that they are found again.
  HWY_NOINLINE void LowerExtremes()
  {
    for (std::size_t c = 0; c < this->Scene.Channels.size(); ++c)
    {
      this->Extremes[c] = BelowExtreme(this->Extremes[c], this->LastExtreme(c));
    }
  }

  bool News = false; ///< whether extremes have changed since this was set to false
  unsigned int Wanted =
    AllComponents; ///< channels whose extremes samples are taken for, a bit each

private:
  /// Nothing is beyond the ends of the range.
  float LastExtreme(std::size_t channel) const
  {
    const PacketChannel& of = this->Scene.Channels[channel];
    return this->Scene.Source->Blend.Mode == BlendMode::Maximum ? of.High : -of.Low;
  }

  bool IsOneWanted() const { return (this->Wanted & (this->Wanted - 1u)) == 0; }

  bool IsDependent() const { return this->Scene.KindOfComponents != ComponentKind::Independent; }

  /// Keeps the largest density of a channel; minima are found as maxima of the negated ones.
  HWY_INLINE void TakeExtreme(std::size_t c, const PacketCurve& curve, Vf density, Vf s, Mf sampled)
  {
    const Df d;
    const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
    const Vf value = maximum ? density : hn::Neg(density);
    // Comparisons with what is not a number are false.
    const Mf better = hn::And(sampled, hn::Gt(value, this->Extremes[c]));
    if (hn::AllFalse(d, better))
    {
      return;
    }
    this->News = true;
    this->Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, better));
    this->Extremes[c] = hn::IfThenElse(better, value, this->Extremes[c]);
    this->Places[c] = hn::IfThenElse(better, curve.TimeAt(s), this->Places[c]);
    if (this->IsDependent())
    {
      this->Position = Select(better, curve.At(this->Scene, s), this->Position);
    }
    Mf done = this->State.Alive;
    for (std::size_t i = 0; i < this->Scene.Channels.size(); ++i)
    {
      done = hn::And(done, hn::Ge(this->Extremes[i], Splat(this->LastExtreme(i))));
    }
    this->State.Alive = hn::AndNot(done, this->State.Alive);
  }

  /// Adds up intensities times opacities.
  HWY_INLINE Mf AddUp(const PacketCurve& curve, const Vf* values, Vf s, Mf sampled)
  {
    const Df d;
    const bool average = this->Scene.Source->Blend.Mode == BlendMode::Average;
    const Vf length = this->Scene.Settings.Opacity == OpacityLength::Deformed
      ? Splat(static_cast<float>(this->Scene.Settings.SampleDistance))
      : hn::Mul(curve.PerStep, FindLength(this->Scene, curve.Position.Slope(s)));
    Mf visible = hn::FirstN(d, 0);
    for (std::size_t c = 0; c < this->Scene.Channels.size(); ++c)
    {
      const PacketChannel& channel = this->Scene.Channels[c];
      const Vf density = DensityOf(this->Scene, c, values);
      const Vf intensity = IntensityOf(this->Scene, c, values);
      Mf counts = hn::And(sampled, hn::And(hn::Eq(intensity, intensity), hn::Eq(density, density)));
      if (average)
      {
        counts = hn::And(counts,
          hn::And(hn::Ge(intensity, Splat(channel.AverageMin)),
            hn::Le(intensity, Splat(channel.AverageMax))));
      }
      const Vf relative =
        hn::Mul(hn::Sub(intensity, Splat(channel.Low)), Splat(1.0f / (channel.High - channel.Low)));
      const PacketPlane& plane = this->Scene.Components[c].Plane;
      const Vf opacity = HWY_UNLIKELY(plane.Intervals != nullptr)
        ? FindOpacityOfLastRow(plane, density)
        : OpticsLookup(this->Scene, density, c).Opacity();
      this->Sums[c] = hn::Add(
        this->Sums[c], hn::IfThenElseZero(counts, hn::Mul(hn::Mul(opacity, relative), length)));
      this->Lengths[c] = hn::Add(this->Lengths[c], hn::IfThenElseZero(counts, length));
      visible = hn::Or(visible, counts);
    }
    this->Any = hn::Or(this->Any, visible);
    Vf& first = this->State.Out.FirstVisible;
    first = hn::IfThenElse(visible, hn::Min(first, curve.TimeAt(s)), first);
    return visible;
  }

  HWY_INLINE void EndSums()
  {
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    const bool average = this->Scene.Source->Blend.Mode == BlendMode::Average;
    Vf sum = zero;
    for (std::size_t c = 0; c < this->Scene.Channels.size(); ++c)
    {
      const PacketChannel& channel = this->Scene.Channels[c];
      const Vf over = average ? this->Lengths[c] : Splat(channel.AdditiveDistance);
      const Mf some = hn::Gt(over, zero);
      sum = hn::Add(sum,
        hn::IfThenElseZero(some,
          hn::Div(hn::Mul(Splat(channel.Weight), this->Sums[c]), hn::IfThenElse(some, over, one))));
    }
    const Vf gray = hn::IfThenElseZero(this->Any, Clamp(sum, zero, one));
    this->State.Out.Color = { gray, gray, gray };
    this->State.Out.Transmittance = hn::IfThenElse(this->Any, zero, one);
  }

  /// Makes the pixels of the rays those of one value of each channel, in the lanes of `lanes`; they
  /// are where the first channel that is visible is. Returns those that are visible.
  HWY_NOINLINE Mf Show(const Vf* values, const Mf* lanes, const Vf* places)
  {
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    Vec3 color{ zero, zero, zero };
    Vf sum = zero;
    Vf first = this->State.Out.FirstVisible;
    for (std::size_t c = 0; c < this->Scene.Channels.size(); ++c)
    {
      const PacketChannel& channel = this->Scene.Channels[c];
      const Vf density = DensityOf(this->Scene, c, values);
      // Gradients count as large.
      PlaneTexel texel;
      Mf some;
      if (HWY_UNLIKELY(this->Scene.Components[c].Plane.Intervals != nullptr))
      {
        texel = LookUpLastRow(this->Scene.Components[c].Plane, density);
        some = hn::Gt(texel.Opacity, zero);
      }
      else
      {
        const OpticsLookup lookup(this->Scene, density, c);
        texel = { lookup.Color(), lookup.Opacity() };
        some = lookup.IsVisible();
      }
      // NaN is not shown: comparisons with it are false.
      const Mf shows = hn::And(hn::And(lanes[c], hn::Eq(density, density)), some);
      const Vf alpha = hn::IfThenElseZero(shows, hn::Mul(Splat(channel.Weight), texel.Opacity));
      const Vec3 own = this->IsDependent() ? DependentColor(this->Scene, values) : texel.Color;
      color = MulAdd(alpha, own, color);
      first = hn::IfThenElse(hn::And(hn::Eq(sum, zero), hn::Gt(alpha, zero)), places[c], first);
      sum = hn::Add(sum, alpha);
    }
    const Vf shown = hn::Min(sum, one);
    this->State.Out.Color = { hn::Min(color.x, shown), hn::Min(color.y, shown),
      hn::Min(color.z, shown) };
    this->State.Out.Transmittance = hn::Sub(one, shown);
    this->State.Out.FirstVisible = first;
    return hn::Gt(shown, zero);
  }

  const PacketScene& Scene;
  CastStatistics& Statistics;
  PacketCompositor<T>& Samples;
  PacketState& State;
  Vf Extremes[LargestNumberOfComponents]; ///< by channel
  Vf Places[LargestNumberOfComponents];   ///< by channel: t where these are
  Vec3 Position;                          ///< where these are of dependent components
  Vf Sums[LargestNumberOfComponents];     ///< by channel
  Vf Lengths[LargestNumberOfComponents];  ///< over which these are
  Mf Any;                                 ///< rays that have taken a sample that counts
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
