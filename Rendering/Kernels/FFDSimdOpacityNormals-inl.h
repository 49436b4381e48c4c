// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Gradients of the opacity at the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_OPACITY_NORMALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_OPACITY_NORMALS_INL_H_
#undef FFD_SIMD_OPACITY_NORMALS_INL_H_
#else
#define FFD_SIMD_OPACITY_NORMALS_INL_H_
#endif

#include "FFDPacketCaster.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdTable-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The opacity over the unit distance of values, as SampleClassifier::ClassifyValue().
HWY_NOINLINE Vf OpacityOfValues(const PacketScene& scene, Vf values)
{
  if (scene.Plane.Texels)
  {
    return LookUpPlane(scene.Plane, values, Splat(1e30f)).Opacity;
  }
  const Vf depth = hn::Mul(FindExtinction(scene, values), Splat(scene.UnitDistance));
  // The opacity is a difference from one, of which little is left where it is small; gradients are
  // differences of that.
  const Vf one = Splat(1.0f);
  const Vf y = hn::Mul(depth, Splat(0.69314718f));
  const Vf series = hn::Mul(y,
    hn::NegMulAdd(y,
      hn::NegMulAdd(y, hn::NegMulAdd(y, Splat(1.0f / 24.0f), Splat(1.0f / 6.0f)), Splat(0.5f)),
      one));
  return hn::IfThenElse(hn::Lt(depth, Splat(0.0625f)), series, hn::Sub(one, Exp2(hn::Neg(depth))));
}

/// The same as Gradient() of the opacity: that of the values one voxel before and behind the
/// samples, which come from the same 32 voxels.
template <class T, class Source>
HWY_NOINLINE Vec3 InnerOpacityGradient(const PacketScene& scene, const Source& source,
  const SamplePosition& at, const SampleRows<T>& rows)
{
  using F = Fetch<T>;
  using Along = typename F::Along;
  const auto opacity = [&](Along a00, Along a10, Along a01, Along a11) {
    return OpacityOfValues(scene, F::Value(Across<T>(at, a00, a10, a01, a11), at));
  };
  const auto middle = [&](int dy, int dz) { return source.Middle(dy, dz, at); };
  const auto behind = [&](const typename F::Row& row) { return F::Behind(row, at); };
  const auto before = [&](const typename F::Row& row) { return F::Before(row, at); };
  Vec3 gradient;
  gradient.x =
    hn::Sub(opacity(behind(rows.R00), behind(rows.R10), behind(rows.R01), behind(rows.R11)),
      opacity(before(rows.R00), before(rows.R10), before(rows.R01), before(rows.R11)));
  gradient.y = hn::Sub(opacity(rows.M10, middle(2, 0), rows.M11, middle(2, 1)),
    opacity(middle(-1, 0), rows.M00, middle(-1, 1), rows.M01));
  gradient.z = hn::Sub(opacity(rows.M01, rows.M11, middle(0, 2), middle(1, 2)),
    opacity(middle(0, -1), middle(1, -1), rows.M00, rows.M10));
  return gradient;
}

/// The same near the faces of the volume, in the lanes of `lanes`: as FindDifferences().
template <class T>
HWY_NOINLINE Vec3 BorderOpacityGradient(
  const PacketScene& scene, BorderSamples<T>& border, const Vec3& q, Mf lanes)
{
  const PacketVolume& v = scene.Volume;
  const Vf zero = hn::Zero(Df());
  const Vf one = Splat(1.0f);
  Vf inside[3] = { q.x, q.y, q.z };
  Vf last[3];
  for (int a = 0; a < 3; ++a)
  {
    last[a] = Splat(static_cast<float>(v.Dimensions[a] - 1));
    inside[a] = Clamp(inside[a], zero, last[a]);
    if (v.Nearest)
    {
      inside[a] = hn::Min(hn::Floor(hn::Add(inside[a], Splat(0.5f))), last[a]);
    }
  }
  Vf gradient[3];
  for (int a = 0; a < 3; ++a)
  {
    Vf at[3] = { inside[0], inside[1], inside[2] };
    const auto opacity = [&](Vf place) {
      at[a] = place;
      return OpacityOfValues(scene, border.Value({ at[0], at[1], at[2] }, lanes, zero));
    };
    const Vf high = hn::Min(hn::Add(inside[a], one), last[a]);
    const Vf low = hn::Max(hn::Sub(inside[a], one), zero);
    gradient[a] =
      hn::Div(hn::Sub(opacity(high), opacity(low)), hn::Mul(Splat(0.5f), hn::Sub(high, low)));
  }
  return { gradient[0], gradient[1], gradient[2] };
}

/// The gradient of the opacity at the samples q, as Gradient() gives that of the values.
/// `atBorder`: lanes at faces, of which `border` knows; its last samples are forgotten.
template <class T, class Source>
HWY_INLINE Vec3 OpacityGradient(const PacketScene& scene, const Source& source,
  const SamplePosition& at, const SampleRows<T>& rows, BorderSamples<T>& border, const Vec3& q,
  Mf atBorder)
{
  const Vec3 inner = InnerOpacityGradient<T>(scene, source, at, rows);
  if (HWY_LIKELY(hn::AllFalse(Df(), atBorder)))
  {
    return inner;
  }
  Mf between;
  const Vec3 gradient = source.IsRepeating()
    ? border.Rescale(q, atBorder, inner, between)
    : border.GradientBy(
        [&](const OffsetRows<T>& voxels, const SamplePosition& in, const SampleRows<T>& own) {
          return InnerOpacityGradient<T>(scene, voxels, in, own);
        },
        q, atBorder, inner, between);
  const Mf others = hn::AndNot(between, atBorder);
  return hn::AllFalse(Df(), others)
    ? gradient
    : Select(others, BorderOpacityGradient<T>(scene, border, q, others), gradient);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
