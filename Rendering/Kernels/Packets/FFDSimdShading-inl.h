// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Blinn-Phong shading of packets, as Shading::Shade(). Included once per target of Highway.
#if defined(FFD_SIMD_SHADING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SHADING_INL_H_
#undef FFD_SIMD_SHADING_INL_H_
#else
#define FFD_SIMD_SHADING_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// 1 / length of vectors; zero where it is zero, or has no direction that single precision can
/// tell.
HWY_INLINE Vf InverseLength(const Vec3& v)
{
  const Vf squared = Dot(v, v);
  const Mf some = hn::And(hn::Gt(squared, Splat(1e-37f)), hn::Lt(squared, Splat(1e37f)));
  return hn::IfThenElseZero(some, InverseSqrt(hn::IfThenElse(some, squared, Splat(1.0f))));
}

/// Unit vectors; zero where InverseLength() is.
HWY_INLINE Vec3 Normalize(const Vec3& v)
{
  const Vf inverse = InverseLength(v);
  const Mf some = hn::Gt(inverse, hn::Zero(Df()));
  return { hn::IfThenElseZero(some, hn::Mul(v.x, inverse)),
    hn::IfThenElseZero(some, hn::Mul(v.y, inverse)),
    hn::IfThenElseZero(some, hn::Mul(v.z, inverse)) };
}

/// Light that samples send to the eye, without that of headlights.
struct Lighting
{
  Vec3 Ambient;
  Vec3 Diffuse;
  Vec3 Specular;
};

/// x to the specular power, 0 <= x <= 1.
HWY_INLINE Vf Highlight(const PacketSurface& surface, Vf x)
{
  const Vf some = hn::IfThenElseZero(hn::Ge(x, Splat(surface.SmallestCosine)), x);
  return surface.WholeSpecularPower >= 0 ? WholePower(some, surface.WholeSpecularPower)
                                         : Power(some, surface.SpecularPower);
}

/// Cosine of an angle between directions as it counts for lighting.
HWY_INLINE Vf LitCosine(const PacketScene& scene, Vf cosine)
{
  return hn::Min(hn::Max(scene.TwoSided ? hn::Abs(cosine) : cosine, hn::Zero(Df())), Splat(1.0f));
}

/// Directions to a light, unit vectors, and how much of its light arrives.
struct Arrival
{
  Vec3 Towards;
  Vf Strength;
};

/// Those of a light that has a position.
HWY_INLINE Arrival FindArrival(const PacketLight& light, const Vec3& position)
{
  const Vec3 path = Sub(Broadcast(light.Position), position);
  const Vf inverse = InverseLength(path);
  Arrival arrival{ Scale(inverse, path), Splat(1.0f) };
  if (light.Attenuates)
  {
    const Vf distance = hn::Mul(Dot(path, path), inverse);
    arrival.Strength = hn::Div(arrival.Strength,
      hn::MulAdd(hn::MulAdd(Splat(light.Attenuation[2]), distance, Splat(light.Attenuation[1])),
        distance, Splat(light.Attenuation[0])));
  }
  if (light.Cone)
  {
    const Vf cosine = hn::Neg(Dot(arrival.Towards, Broadcast(light.Axis)));
    const Mf inCone = hn::Ge(cosine, Splat(light.ConeCosine));
    arrival.Strength = hn::IfThenElseZero(inCone,
      hn::Mul(arrival.Strength, Power(hn::Max(cosine, hn::Zero(Df())), light.ConeExponent)));
  }
  return arrival;
}

/// Adds the lights that are no headlights, but for their ambient terms.
HWY_NOINLINE inline void AddLights(const PacketScene& scene, const PacketSurface& surface,
  const Vec3& position, const Vec3& normal, const Vec3& toEye, Lighting& lit)
{
  // Below this the half vector has no direction.
  constexpr float SmallestSquare = 1e-6f;
  const Vf two = Splat(2.0f);
  const Vf nDotE = Dot(normal, toEye);
  for (const PacketLight& light : surface.Lights)
  {
    const Arrival arrival = light.Positional ? FindArrival(light, position)
                                             : Arrival{ Broadcast(light.Towards), Splat(1.0f) };
    const Vf nDotL = Dot(normal, arrival.Towards);
    lit.Diffuse = MulAdd(
      hn::Mul(arrival.Strength, LitCosine(scene, nDotL)), Broadcast(light.Diffuse), lit.Diffuse);
    if (light.HasHighlight)
    {
      // The half vector is the sum of two unit vectors: its length follows from their angle.
      const Vf squared = hn::MulAdd(two, Dot(arrival.Towards, toEye), two);
      const Vf nDotH =
        hn::Mul(hn::Add(nDotL, nDotE), InverseSqrt(hn::Max(squared, Splat(SmallestSquare))));
      lit.Specular = MulAdd(hn::Mul(arrival.Strength, Highlight(surface, LitCosine(scene, nDotH))),
        Broadcast(light.Specular), lit.Specular);
    }
  }
}

/**
 * Colors of lit samples, at most 1. `gradient`: of any length, the normal is opposite to it;
 * `toEye`: unit vectors; `positionOf()`: where the samples are. All in the space of the lights.
 */
template <class PositionOf>
HWY_INLINE Vec3 Shade(const PacketScene& scene, const PacketSurface& surface, const Vec3& color,
  const Vec3& gradient, const Vec3& toEye, const PositionOf& positionOf)
{
  const Vf inverse = InverseLength(gradient);
  // The half vector of headlights is the direction to the eye.
  const Vf facing = LitCosine(scene,
    hn::IfThenElseZero(
      hn::Gt(inverse, hn::Zero(Df())), hn::Neg(hn::Mul(Dot(gradient, toEye), inverse))));
  const Vf highlight = Highlight(surface, facing);
  const PacketLight& headlights = surface.Headlights;
  Lighting lit{ Broadcast(surface.Ambient), Scale(facing, Broadcast(headlights.Diffuse)),
    Scale(highlight, Broadcast(headlights.Specular)) };
  if (HWY_UNLIKELY(!surface.Lights.empty()))
  {
    const Vec3 normal = Scale(Splat(-1.0f), Normalize(gradient));
    AddLights(scene, surface, positionOf(), normal, toEye, lit);
  }
  const auto mix = [&](Vf Vec3::*c) FFD_INLINE_LAMBDA {
    const Vf light = hn::Add(lit.Ambient.*c, lit.Diffuse.*c);
    return hn::Min(hn::MulAdd(color.*c, light, lit.Specular.*c), Splat(1.0f));
  };
  return { mix(&Vec3::x), mix(&Vec3::y), mix(&Vec3::z) };
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
