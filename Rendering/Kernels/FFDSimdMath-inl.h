// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Small vector types and functions of the packet kernels. Included once per target of Highway.
#if defined(FFD_SIMD_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_MATH_INL_H_
#undef FFD_SIMD_MATH_INL_H_
#else
#define FFD_SIMD_MATH_INL_H_
#endif

#include <glm/vec3.hpp>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

/// Lanes of a packet: neighbouring rays, at most 16.
using Df = hn::CappedTag<float, 16>;
using Di = hn::RebindToSigned<Df>;
using Vf = hn::Vec<Df>;
using Vi = hn::Vec<Di>;
using Mf = hn::Mask<Df>;

/// Three coordinates of every lane.
struct Vec3
{
  Vf x;
  Vf y;
  Vf z;
};

HWY_INLINE Vf Splat(float value)
{
  return hn::Set(Df(), value);
}

HWY_INLINE Vf Clamp(Vf x, Vf lo, Vf hi)
{
  return hn::Min(hn::Max(x, lo), hi);
}

/// a + t * (b - a)
HWY_INLINE Vf Lerp(Vf a, Vf b, Vf t)
{
  return hn::MulAdd(t, hn::Sub(b, a), a);
}

HWY_INLINE Vf Dot(const Vec3& a, const Vec3& b)
{
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE Vec3 Cross(const Vec3& a, const Vec3& b)
{
  return { hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
    hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
    hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x)) };
}

HWY_INLINE Vec3 Add(const Vec3& a, const Vec3& b)
{
  return { hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z) };
}

HWY_INLINE Vec3 Sub(const Vec3& a, const Vec3& b)
{
  return { hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z) };
}

/// a + s * b
HWY_INLINE Vec3 MulAdd(Vf s, const Vec3& b, const Vec3& a)
{
  return { hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z) };
}

HWY_INLINE Vec3 Scale(Vf s, const Vec3& a)
{
  return { hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z) };
}

/// m * a for a 3 x 3 matrix stored row by row.
HWY_INLINE Vec3 Transform(const float m[9], const Vec3& a)
{
  const auto row = [&](const float* r)
  {
    return hn::MulAdd(
      Splat(r[0]), a.x, hn::MulAdd(Splat(r[1]), a.y, hn::Mul(Splat(r[2]), a.z)));
  };
  return { row(m), row(m + 3), row(m + 6) };
}

/**
 * `values`, but for the lanes of `lanes` what function(position of the lane) gives: the few lanes
 * of a packet that have to go through code for single points.
 */
template <class Function>
HWY_INLINE Vec3 ReplaceLanes(
  Mf lanes, const Vec3& positions, const Vec3& values, const Function& function)
{
  const Df d;
  HWY_ALIGN float px[16], py[16], pz[16], x[16], y[16], z[16], flag[16];
  hn::Store(positions.x, d, px);
  hn::Store(positions.y, d, py);
  hn::Store(positions.z, d, pz);
  hn::Store(values.x, d, x);
  hn::Store(values.y, d, y);
  hn::Store(values.z, d, z);
  hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, flag);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i)
  {
    if (flag[i] != 0.0f)
    {
      const glm::dvec3 replacement = function(glm::dvec3(px[i], py[i], pz[i]));
      x[i] = static_cast<float>(replacement.x);
      y[i] = static_cast<float>(replacement.y);
      z[i] = static_cast<float>(replacement.z);
    }
  }
  return { hn::Load(d, x), hn::Load(d, y), hn::Load(d, z) };
}

HWY_INLINE float SmallestLane(Vf v)
{
  return hn::GetLane(hn::MinOfLanes(Df(), v));
}

HWY_INLINE float LargestLane(Vf v)
{
  return hn::GetLane(hn::MaxOfLanes(Df(), v));
}

/// 2^x for x <= 0; relative error below 3e-7, zero below -80.
HWY_INLINE Vf Exp2(Vf x)
{
  const Df d;
  const Di di;
  const Mf tiny = hn::Lt(x, Splat(-80.0f));
  x = hn::Max(x, Splat(-80.0f));
  const Vf whole = hn::Floor(x);
  const Vf f = hn::Sub(x, whole);
  // Minimax polynomial of 2^f on [0, 1].
  Vf p = Splat(1.8775767e-3f);
  p = hn::MulAdd(p, f, Splat(8.9893397e-3f));
  p = hn::MulAdd(p, f, Splat(5.5826318e-2f));
  p = hn::MulAdd(p, f, Splat(2.4015361e-1f));
  p = hn::MulAdd(p, f, Splat(6.9315308e-1f));
  p = hn::MulAdd(p, f, Splat(9.9999994e-1f));
  const Vi exponent = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, whole), hn::Set(di, 127)));
  return hn::IfThenZeroElse(tiny, hn::Mul(p, hn::BitCast(d, exponent)));
}

/// log2(x) for positive normal x; absolute error below 1e-5.
HWY_INLINE Vf Log2(Vf x)
{
  const Df d;
  const Di di;
  const Vi bits = hn::BitCast(di, x);
  const Vi exponent = hn::Sub(hn::ShiftRight<23>(bits), hn::Set(di, 127));
  const Vi mantissa =
    hn::Or(hn::And(bits, hn::Set(di, 0x007FFFFF)), hn::Set(di, 0x3F800000));
  const Vf m = hn::BitCast(d, mantissa); // 1 <= m < 2
  // log2(m) = 2 / ln 2 * atanh(u), u = (m - 1) / (m + 1) <= 1 / 3.
  const Vf u = hn::Div(hn::Sub(m, Splat(1.0f)), hn::Add(m, Splat(1.0f)));
  const Vf u2 = hn::Mul(u, u);
  Vf s = Splat(1.0f / 9.0f);
  s = hn::MulAdd(s, u2, Splat(1.0f / 7.0f));
  s = hn::MulAdd(s, u2, Splat(1.0f / 5.0f));
  s = hn::MulAdd(s, u2, Splat(1.0f / 3.0f));
  s = hn::MulAdd(s, u2, Splat(1.0f));
  return hn::MulAdd(hn::Mul(Splat(2.8853900818f), u), s, hn::ConvertTo(d, exponent));
}

/// x^power for 0 <= x, power >= 0.
HWY_INLINE Vf Power(Vf x, float power)
{
  const Mf zero = hn::Lt(x, Splat(1e-20f));
  const Vf y = Exp2(hn::Min(hn::Mul(Splat(power), Log2(hn::Max(x, Splat(1e-20f)))), hn::Zero(Df())));
  return hn::IfThenZeroElse(zero, y);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
