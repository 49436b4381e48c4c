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

#include <algorithm>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Whether single precision can tell the squares of lengths.
HWY_INLINE Mf HasSquare(Vf squared)
{
  return hn::And(hn::Gt(squared, Splat(1e-37f)), hn::Lt(squared, Splat(1e37f)));
}

/// 1 / length of vectors; zero where it is zero, or HasSquare() is false.
HWY_INLINE Vf InverseLength(const Vec3& v)
{
  const Vf squared = Dot(v, v);
  const Mf some = HasSquare(squared);
  return hn::IfThenElseZero(some, InverseSqrt(hn::IfThenElse(some, squared, Splat(1.0f))));
}

/// Makes vectors whose lengths HasSquare() does not know longer or shorter.
HWY_NOINLINE inline void BringIntoReach(Vec3& v)
{
  const Df d;
  const Vf squared = Dot(v, v);
  const Mf within = HasSquare(squared);
  if (HWY_UNLIKELY(!hn::AllTrue(d, within)))
  {
    // Squares of very short ones are zero.
    const Vf factor = hn::IfThenElse(hn::Lt(squared, Splat(1.0f)), Splat(0x1p70f), Splat(0x1p-70f));
    v = Scale(hn::IfThenElse(within, Splat(1.0f), factor), v);
  }
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

/// Light that samples send to the eye.
struct Lighting
{
  Vec3 Diffuse;
  Vec3 Specular;
};

/// x to the specular power, 0 <= x <= 1; 0 where x is.
HWY_INLINE Vf Highlight(const PacketSurface& surface, Vf x)
{
  const Vf some = hn::Max(x, Splat(surface.SmallestCosine));
  return surface.WholeSpecularPower >= 0 ? WholePower(some, surface.WholeSpecularPower)
                                         : Power(some, surface.SpecularPower);
}

/// Cosine of an angle between directions as it counts for lighting.
HWY_INLINE Vf LitCosine(const PacketScene& scene, Vf cosine)
{
  return scene.TwoSided ? hn::Abs(cosine) : hn::Max(cosine, hn::Zero(Df()));
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

/// The inverse length of the sum of two unit vectors, whose direction is that of the half vector.
HWY_INLINE Vf InverseLengthOfSum(const Vec3& a, const Vec3& b)
{
  // It follows from their angle. Below this the sum has no direction.
  constexpr float SmallestSquare = 1e-6f;
  const Vf two = Splat(2.0f);
  return InverseSqrt(hn::Max(hn::MulAdd(two, Dot(a, b), two), Splat(SmallestSquare)));
}

/// The directions to the eye from the samples of a packet, and what follows from them.
struct EyeDirections
{
  static constexpr std::size_t Kept = 8;

  /// Unit vectors in the space of the lights, if they are the same all along the rays.
  Vec3 ToEye;
  /// Then InverseLengthOfSum() with the directions to the first lights; found when it is needed.
  Vf InverseHalves[Kept];
  bool HaveHalves = false;

  HWY_NOINLINE void FindHalves(const PacketSurface& surface)
  {
    this->HaveHalves = true;
    for (std::size_t i = 0; i < std::min(surface.Lights.size(), Kept); ++i)
    {
      this->InverseHalves[i] =
        InverseLengthOfSum(Broadcast(surface.Lights[i].Towards), this->ToEye);
    }
  }
};

/// The light of those that are no headlights, but for their ambient terms. `inverseHalves`: those
/// of EyeDirections, or null.
HWY_NOINLINE inline Lighting AddLights(const PacketScene& scene, const PacketSurface& surface,
  const Vec3& position, const Vec3& normal, const Vec3& toEye, const Vf* inverseHalves)
{
  const Vf nDotE = Dot(normal, toEye);
  const Vf zero = hn::Zero(Df());
  Lighting lit{ { zero, zero, zero }, { zero, zero, zero } };
  Vf diffuse = zero; // of lights that are gray
  Vf specular = zero;
  const auto add = [](const PacketLight& light, Vf part, const float(&color)[3], Vf& gray,
                     Vec3& sum) FFD_INLINE_LAMBDA {
    if (HWY_LIKELY(light.IsGray))
    {
      gray = hn::MulAdd(part, Splat(color[0]), gray);
    }
    else
    {
      sum = MulAdd(part, Broadcast(color), sum);
    }
  };
  for (std::size_t i = 0; i < surface.Lights.size(); ++i)
  {
    const PacketLight& light = surface.Lights[i];
    Vec3 towards = Broadcast(light.Towards);
    Vf strength = Splat(1.0f);
    if (HWY_UNLIKELY(light.Positional))
    {
      const Arrival arrival = FindArrival(light, position);
      towards = Copy(arrival.Towards);
      strength = arrival.Strength;
    }
    const auto arriving = [&](Vf part) FFD_INLINE_LAMBDA {
      return HWY_UNLIKELY(light.Positional) ? hn::Mul(strength, part) : part;
    };
    const Vf nDotL = Dot(normal, towards);
    add(light, arriving(LitCosine(scene, nDotL)), light.Diffuse, diffuse, lit.Diffuse);
    if (light.HasHighlight)
    {
      const bool isKept = inverseHalves && !light.Positional && i < EyeDirections::Kept;
      const Vf inverseHalf = isKept ? inverseHalves[i] : InverseLengthOfSum(towards, toEye);
      const Vf nDotH = LitCosine(scene, hn::Mul(hn::Add(nDotL, nDotE), inverseHalf));
      // Where a light is opposite to the eye rounding makes it more than 1.
      add(light, arriving(Highlight(surface, hn::Min(nDotH, Splat(1.0f)))), light.Specular,
        specular, lit.Specular);
    }
  }
  lit.Diffuse = Add(lit.Diffuse, { diffuse, diffuse, diffuse });
  lit.Specular = Add(lit.Specular, { specular, specular, specular });
  return lit;
}

/**
 * Colors of lit samples, at most 1. `gradient`: of any length, the normal is opposite to it;
 * `positionOf()`: where the samples are. All in the space of the lights.
 */
template <class PositionOf>
HWY_INLINE Vec3 Shade(const PacketScene& scene, const PacketSurface& surface, const Vec3& color,
  Vec3 gradient, EyeDirections& eye, const PositionOf& positionOf)
{
  if (HWY_UNLIKELY(scene.FarGradients))
  {
    BringIntoReach(gradient);
  }
  const Vec3 toEye =
    scene.Parallel ? Normalize(Sub(Broadcast(scene.Eye), positionOf())) : Copy(eye.ToEye);
  const Vf inverse = InverseLength(gradient);
  // The half vector of headlights is the direction to the eye.
  const Vf facing = LitCosine(scene,
    hn::IfThenElseZero(
      hn::Gt(inverse, hn::Zero(Df())), hn::Neg(hn::Mul(Dot(gradient, toEye), inverse))));
  const Vf highlight = Highlight(surface, facing);
  const PacketLight& headlights = surface.Headlights;
  Vec3 diffuse = MulAdd(facing, Broadcast(headlights.Diffuse), Broadcast(surface.Ambient));
  Vec3 specular = Scale(highlight, Broadcast(headlights.Specular));
  if (HWY_UNLIKELY(!surface.Lights.empty()))
  {
    const Vec3 normal = Scale(Splat(-1.0f), Normalize(gradient));
    if (!scene.Parallel && !eye.HaveHalves)
    {
      eye.FindHalves(surface);
    }
    const Lighting lit = AddLights(scene, surface, positionOf(), normal, Copy(toEye),
      scene.Parallel ? nullptr : eye.InverseHalves);
    diffuse = Add(diffuse, lit.Diffuse);
    specular = Add(specular, lit.Specular);
  }
  const auto mix = [&](Vf Vec3::*c) FFD_INLINE_LAMBDA {
    return hn::Min(hn::MulAdd(color.*c, diffuse.*c, specular.*c), Splat(1.0f));
  };
  return { mix(&Vec3::x), mix(&Vec3::y), mix(&Vec3::z) };
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
