// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Two-dimensional transfer functions, a sample a lane. Included once per target of Highway.
#if defined(FFD_SIMD_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PLANE_INL_H_
#undef FFD_SIMD_PLANE_INL_H_
#else
#define FFD_SIMD_PLANE_INL_H_
#endif

#include "FFDPacketPlane.h"

#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Texels of a two-dimensional transfer function, interpolated.
struct PlaneTexel
{
  Vec3 Color;
  Vf Opacity;
};

/// Interpolates the scalars of the second axis at positions in the volume.
HWY_NOINLINE Vf FindSecondAxis(const PacketPlane& plane, const Vec3& q)
{
  const Df d;
  const PacketVolume& v = plane.SecondAxis;
  SampleCells cells;
  SamplePosition at = FindCells(v, q, false, cells);
  // The outermost voxels hold beyond the volume.
  at.Fx = Clamp(at.Fx, hn::Zero(d), Splat(1.0f));
  at.Fy = Clamp(at.Fy, hn::Zero(d), Splat(1.0f));
  at.Fz = Clamp(at.Fz, hn::Zero(d), Splat(1.0f));
  at.Weights = PairWeights(at.Fx);
  return ForFetched(v.Type, [&](auto zero) {
    FaceRows<decltype(zero)> voxels;
    voxels.Repeat(v, cells);
    SampleRows<decltype(zero)> rows;
    return Sample<decltype(zero)>(voxels, at, rows);
  });
}

/// Looks up the texels at (x, y); transparent where x or y is not a number.
HWY_NOINLINE PlaneTexel LookUpPlane(const PacketPlane& plane, Vf x, Vf y)
{
  const Df d;
  const Di di;
  const Mf known = hn::And(hn::Eq(x, x), hn::Eq(y, y));
  struct Axis
  {
    Vi First;
    Vi Second;
    Vf Part;
  };
  const auto locate = [&](Vf value, int a) {
    const Vf last = Splat(static_cast<float>(plane.Size[a] - 1));
    const Vf texel = hn::Mul(hn::Sub(value, Splat(plane.Low[a])), Splat(plane.Scale[a]));
    const Vf at = hn::IfThenElseZero(known, Clamp(texel, hn::Zero(d), last));
    const Vf first = hn::Floor(plane.Nearest ? hn::Add(at, Splat(0.5f)) : at);
    return Axis{ Truncate(first), Truncate(hn::Min(hn::Add(first, Splat(1.0f)), last)),
      plane.Nearest ? hn::Zero(d) : hn::Sub(at, first) };
  };
  const Axis u = locate(x, 0);
  const Axis v = locate(y, 1);
  const auto* const words = reinterpret_cast<const std::uint32_t*>(plane.Texels);
  const Vi width = hn::Set(di, plane.Size[0]);
  const auto row = [&](Vi number) {
    const Vi begin = hn::Mul(number, width);
    const Quads a = LoadQuads(words, hn::Add(begin, u.First));
    const Quads b = LoadQuads(words, hn::Add(begin, u.Second));
    const auto mix = [&](Vi first, Vi second) {
      return Lerp(hn::BitCast(d, first), hn::BitCast(d, second), u.Part);
    };
    return PlaneTexel{ { mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z) }, mix(a.w, b.w) };
  };
  PlaneTexel texel = row(v.First);
  if (!plane.Nearest)
  {
    const PlaneTexel next = row(v.Second);
    texel.Color = { Lerp(texel.Color.x, next.Color.x, v.Part),
      Lerp(texel.Color.y, next.Color.y, v.Part), Lerp(texel.Color.z, next.Color.z, v.Part) };
    texel.Opacity = Lerp(texel.Opacity, next.Opacity, v.Part);
  }
  texel.Opacity = hn::IfThenElseZero(known, texel.Opacity);
  return texel;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
