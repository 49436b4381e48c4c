// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Opacities of samples, as SampleClassifier. Included once per target of Highway.
#if defined(FFD_SIMD_OPTICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_OPTICS_INL_H_
#undef FFD_SIMD_OPTICS_INL_H_
#else
#define FFD_SIMD_OPTICS_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdLookup-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPlane-inl.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The opacity of texels over PacketScene::OpacityLength.
HWY_INLINE Vf OpacityOf(const PacketScene& scene, const PacketPlane& plane, const PlaneTexel& texel)
{
  return plane.UnitDistance == scene.OpacityLength
    ? texel.Opacity
    : OpacityOver(ExtinctionOver(texel.Opacity, plane.UnitDistance), scene.OpacityLength);
}

/// Squared length of a gradient whose components are scaled.
HWY_INLINE Vf FindSquaredMagnitude(const float scale[3], const Vec3& gradient)
{
  const Vec3 scaled{ hn::Mul(gradient.x, Splat(scale[0])), hn::Mul(gradient.y, Splat(scale[1])),
    hn::Mul(gradient.z, Splat(scale[2])) };
  return Dot(scaled, scaled);
}

/// Length of a gradient whose components are scaled; zero where it is not a number.
HWY_INLINE Vf FindMagnitude(const float scale[3], const Vec3& gradient)
{
  // The root of what is infinite, beside infinite scalars, would be no number.
  const Vf squared = FindSquaredMagnitude(scale, gradient);
  const Vf largest = Splat(1e30f);
  const Vf magnitude = FastSqrt(hn::IfThenElse(hn::Gt(squared, largest), largest, squared));
  return hn::IfThenElseZero(hn::Eq(magnitude, magnitude), magnitude);
}

/// The factor at `entry`, not negative, of those that begin at `first`; `last`: number of the last.
HWY_INLINE Vf InterpolateFactors(const float* factors, Vi first, Vf last, Vf entry)
{
  const Vf x = hn::Min(entry, last);
  const Vf whole = hn::Min(hn::Floor(x), hn::Sub(last, Splat(1.0f)));
  HWY_ALIGN int offsets[16];
  StoreIndices(hn::Add(first, Truncate(whole)), offsets);
  const Df d;
  const Pairs pair = LoadPairLanes<4>(factors, 0, offsets);
  return Lerp(hn::BitCast(d, pair.x), hn::BitCast(d, pair.y), hn::Sub(x, whole));
}

/// Factors of opacities, by the length of the gradient.
HWY_INLINE Vf FactorOf(const PacketGradientOpacity& gradients, const Vec3& gradient)
{
  const Vf magnitude = FindMagnitude(gradients.Scale, gradient);
  return HWY_LIKELY(PieceLookup::Knows(gradients.Pieces))
    ? PieceLookup(gradients.Pieces, magnitude).Opacity()
    : InterpolateFactors(gradients.Factors, hn::Zero(Di()),
        Splat(static_cast<float>(gradients.Size - 1)), magnitude);
}

/// Factors of opacities by the gradient opacities of one of the tables of labels.
HWY_INLINE Vf FactorOf(const PacketMask& mask, std::size_t table, const Vec3& gradient)
{
  const PacketMask::GradientRange& range = mask.GradientRanges[table];
  return InterpolateFactors(mask.GradientFactors.data(), hn::Set(Di(), range.First),
    Splat(range.Last), hn::Mul(FindMagnitude(mask.MagnitudeScale, gradient), Splat(range.Scale)));
}

/// Factors of opacities by the gradient opacities of the tables of labels, one table a lane.
HWY_INLINE Vf FactorOf(const PacketMask& mask, Vi tables, const Vec3& gradient)
{
  if (HWY_LIKELY(IsCommon(tables)))
  {
    return FactorOf(mask, static_cast<std::size_t>(hn::GetLane(tables)), gradient);
  }
  const Df d;
  const Quads range =
    LoadQuads(reinterpret_cast<const std::uint32_t*>(mask.GradientRanges.data()), tables);
  return InterpolateFactors(mask.GradientFactors.data(), range.x, hn::BitCast(d, range.y),
    hn::Mul(FindMagnitude(mask.MagnitudeScale, gradient), hn::BitCast(d, range.z)));
}

/// Mixes the color and the opacity of labels into those of the scalars alone, in the lanes that
/// have a label; as SampleClassifier.
HWY_INLINE void MixInLabels(const PacketScene& scene, const OpticsLookup& ofLabel, Vi tables,
  const Vec3& gradient, Vf& opacity, Vec3& color)
{
  const Df d;
  const Vf factor = hn::IfThenElse(
    hn::RebindMask(d, hn::Gt(tables, hn::Zero(Di()))), Splat(scene.Mask.BlendFactor), hn::Zero(d));
  color = Lerp(color, ofLabel.Color(), factor);
  Vf second = ofLabel.Opacity();
  if (!scene.Mask.GradientRanges.empty())
  {
    second = hn::Mul(second, FactorOf(scene.Mask, tables, gradient));
  }
  opacity = Lerp(opacity, second, factor);
}

/// Does MixInLabels() where the scalars alone are looked up in a table: `base`.
HWY_INLINE void MixWithLabels(const PacketScene& scene, const OpticsLookup& base,
  const OpticsLookup& ofLabel, Vi tables, const Vec3& gradient, Vf& opacity, Vec3& color)
{
  color = base.Color();
  opacity = base.Opacity();
  if (!scene.Mask.GradientRanges.empty())
  {
    opacity = hn::Mul(opacity, FactorOf(scene.Mask, std::size_t(0), gradient));
  }
  MixInLabels(scene, ofLabel, tables, gradient, opacity, color);
}

/// Texels of a two-dimensional transfer function at values whose gradients are `gradient`, at q.
HWY_INLINE PlaneTexel LookUpPlane(
  const PacketPlane& plane, Vf values, const Vec3& gradient, const Vec3& q)
{
  return LookUpPlane(plane, values,
    plane.SecondAxis.Scalars ? FindSecondAxis(plane, q)
                             : FindMagnitude(plane.MagnitudeScale, gradient));
}

/// Does what MixWithLabels() does where the scalars alone are looked up in a two-dimensional
/// transfer function; returns the color, and the opacity over PacketScene::OpacityLength.
HWY_NOINLINE inline PlaneTexel MixPlaneWithLabels(
  const PacketScene& scene, Vf values, OpticsLookup ofLabel, Vi tables, Vec3 gradient, Vec3 q)
{
  PlaneTexel texel = LookUpPlane(scene.Plane, values, gradient, q);
  texel.Opacity = OpacityOf(scene, scene.Plane, texel);
  MixInLabels(scene, ofLabel, tables, gradient, texel.Opacity, texel.Color);
  return texel;
}

/// The value, of those of all components at a sample, whose opacity is that of `component` and
/// whose gradient gives its normals.
HWY_INLINE Vf DensityOf(const PacketScene& scene, std::size_t component, const Vf* values)
{
  const auto weight = [](int c) { return Splat(static_cast<float>(LuminanceWeights[c])); };
  switch (scene.KindOfComponents)
  {
    case ComponentKind::ColorOpacity:
      return values[1];
    case ComponentKind::Rgb:
      return hn::MulAdd(
        weight(0), values[0], hn::MulAdd(weight(1), values[1], hn::Mul(weight(2), values[2])));
    case ComponentKind::Rgba:
      return values[3];
    default:
      return values[component];
  }
}

/// The value, of those of all components at a sample, that a channel adds up.
HWY_INLINE Vf IntensityOf(const PacketScene& scene, std::size_t channel, const Vf* values)
{
  switch (scene.KindOfComponents)
  {
    case ComponentKind::ColorOpacity:
    case ComponentKind::Rgba:
      return values[0];
    default:
      return DensityOf(scene, channel, values);
  }
}

/// The color of dependent components; gradients count as large.
HWY_INLINE Vec3 DependentColor(const PacketScene& scene, const Vf* values)
{
  if (scene.KindOfComponents == ComponentKind::ColorOpacity)
  {
    return scene.ColorPlane.Intervals ? LookUpLastRow(scene.ColorPlane, values[0]).Color
                                      : OpticsLookup(scene, values[0], scene.ColorTable).Color();
  }
  // NaN is black: comparisons with it are false.
  const auto channel = [&](int c) {
    const Vf value = hn::Mul(values[c], Splat(scene.ColorScale));
    return hn::IfThenElseZero(hn::Gt(value, hn::Zero(Df())), hn::Min(value, Splat(1.0f)));
  };
  return { channel(0), channel(1), channel(2) };
}

/// The components that DensityOf() takes, a bit each.
HWY_INLINE unsigned int FindDensityComponents(const PacketScene& scene)
{
  switch (scene.KindOfComponents)
  {
    case ComponentKind::ColorOpacity:
      return 1u << 1;
    case ComponentKind::Rgb:
      return 1u << 0 | 1u << 1 | 1u << 2;
    case ComponentKind::Rgba:
      return 1u << 3;
    default:
      return (1u << scene.Volume.Components) - 1u;
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
