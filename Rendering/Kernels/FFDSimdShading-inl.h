// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Blinn-Phong shading of packets, as Shading::Shade. Included once per target of Highway.
#if defined(FFD_SIMD_SHADING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SHADING_INL_H_
#undef FFD_SIMD_SHADING_INL_H_
#else
#define FFD_SIMD_SHADING_INL_H_
#endif

#include "FFDPacketCaster.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Unit vectors; zero where the length is.
HWY_INLINE Vec3 Normalize(const Vec3& v)
{
  const Vf squared = Dot(v, v);
  const Mf some = hn::Gt(squared, Splat(1e-30f));
  // Very long and infinite vectors have no direction that single precision can tell.
  const Mf finite = hn::Lt(squared, Splat(1e37f));
  const Vf inverse = hn::IfThenElseZero(
    hn::And(some, finite), hn::Div(Splat(1.0f), hn::Sqrt(hn::Max(squared, Splat(1e-30f)))));
  return { hn::IfThenElseZero(some, hn::Mul(v.x, inverse)),
    hn::IfThenElseZero(some, hn::Mul(v.y, inverse)),
    hn::IfThenElseZero(some, hn::Mul(v.z, inverse)) };
}

/// Colours of lit samples; `normal` and `toEye`: unit vectors. All in the space of the lights.
HWY_INLINE Vec3 Shade(const PacketScene& scene, const Vec3& colour, const Vec3& position,
  const Vec3& normal, const Vec3& toEye)
{
  const Df d;
  const Vf zero = hn::Zero(d);
  Vec3 ambient{ zero, zero, zero };
  Vec3 diffuse = ambient;
  Vec3 specular = ambient;
  for (const PacketLight& light : scene.Lights)
  {
    Vec3 toLight = light.Headlight ? toEye : Broadcast(light.Towards);
    Vf strength = Splat(1.0f);
    if (light.Positional)
    {
      const Vec3 path = Sub(Broadcast(light.Position), position);
      const Vf distance = hn::Sqrt(Dot(path, path));
      toLight = Normalize(path);
      strength = hn::Div(strength,
        hn::MulAdd(hn::MulAdd(Splat(light.Attenuation[2]), distance, Splat(light.Attenuation[1])),
          distance, Splat(light.Attenuation[0])));
      if (light.Cone)
      {
        const Vf cosine = hn::Neg(Dot(toLight, Broadcast(light.Axis)));
        const Mf lit = hn::Ge(cosine, Splat(light.ConeCosine));
        strength = hn::IfThenElseZero(
          lit, hn::Mul(strength, Power(hn::Max(cosine, zero), light.ConeExponent)));
      }
    }
    Vf nDotL = Dot(normal, toLight);
    // The half vector of a headlight is the direction to the eye.
    Vf nDotH = light.Headlight ? nDotL : Dot(normal, Normalize(Add(toLight, toEye)));
    if (scene.TwoSided)
    {
      nDotL = hn::Abs(nDotL);
      nDotH = hn::Abs(nDotH);
    }
    nDotL = hn::Mul(strength, hn::Max(nDotL, zero));
    const Vf highlight = hn::Mul(
      strength, Power(hn::Min(hn::Max(nDotH, zero), Splat(1.0f)), scene.SpecularPower));
    ambient = Add(ambient, Broadcast(light.Ambient));
    diffuse = MulAdd(nDotL, Broadcast(light.Diffuse), diffuse);
    specular = MulAdd(highlight, Broadcast(light.Specular), specular);
  }
  const auto mix = [&](Vf c, Vf a, Vf f, Vf s)
  {
    return hn::MulAdd(c, hn::MulAdd(Splat(scene.Ambient), a, hn::Mul(Splat(scene.Diffuse), f)),
      hn::Mul(Splat(scene.Specular), s));
  };
  return { mix(colour.x, ambient.x, diffuse.x, specular.x),
    mix(colour.y, ambient.y, diffuse.y, specular.y),
    mix(colour.z, ambient.z, diffuse.z, specular.z) };
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
