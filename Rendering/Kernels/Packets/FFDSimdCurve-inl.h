// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The deformed rays of a packet, and their pixels. Included once per target of Highway.
#if defined(FFD_SIMD_CURVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_CURVE_INL_H_
#undef FFD_SIMD_CURVE_INL_H_
#else
#define FFD_SIMD_CURVE_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTileSegment.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRays-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// In the place of the number of a sample, where there is none.
constexpr float NoNumber = -1e30f;

/// The pixels of a packet: the samples so far, blended.
struct PacketPixels
{
  Vec3 Color;
  Vf Transmittance;
  Vf FirstVisible; ///< t
  Vf Tally;        ///< the extreme, or the sum; of surfaces, the value at TallyStep
  Vf TallyLength;  ///< length over which samples were summed up, data units
  Vf TallyStep;    ///< number of the sample whose value is known, or NoNumber
};

HWY_INLINE Mf IsInside(const PacketScene& scene, const Vec3& q)
{
  const Vf lower = Splat(scene.Lower);
  const auto within = [&](Vf x, int a) {
    return hn::And(hn::Ge(x, lower), hn::Le(x, Splat(scene.Upper[a])));
  };
  return hn::And(within(q.x, 0), hn::And(within(q.y, 1), within(q.z, 2)));
}

/// The deformed rays of a packet over some samples; s runs from 0 to 1.
struct PacketCurve
{
  Quartic Position; ///< index coordinates of the whole that the volume is a part of
  Vf T0;            ///< t = T0 + s * Dt
  Vf Dt;
  Vf PerStep;                     ///< s from sample to sample
  TileSegment* Segment = nullptr; ///< whose curves these are, or null
  bool Interpolated = false;      ///< whether the curves are those of its interpolant
  int X = 0; ///< first pixel of the packet, from that of the square of the segment
  Vf Row;    ///< rows of pixels in the square

  HWY_INLINE Vf TimeAt(Vf s) const { return hn::MulAdd(s, this->Dt, this->T0); }

  /// The positions at s, index coordinates of the voxels here.
  HWY_INLINE Vec3 At(const PacketScene& scene, Vf s) const
  {
    // Without a deformation rays are straight.
    return WholeToIndex(scene,
      scene.Identity ? MulAdd(s, this->Position.Terms[1], this->Position.Terms[0])
                     : this->Position.At(s));
  }
};

/// Finds the last places inside of the volume on the ways out of it, between s `inside` and s
/// `outside` of a curve; what it finds of other rays means nothing.
HWY_NOINLINE inline Vf FindFace(
  const PacketScene& scene, const PacketCurve& curve, Vf inside, Vf outside)
{
  constexpr int steps = 20;
  for (int i = 0; i < steps; ++i)
  {
    const Vf middle = hn::Mul(Splat(0.5f), hn::Add(inside, outside));
    const Mf in = IsInside(scene, curve.At(scene, middle));
    inside = hn::IfThenElse(in, middle, inside);
    outside = hn::IfThenElse(in, outside, middle);
  }
  return inside;
}

/// The samples that the rays of a packet take: those of numbers n, at t = (n + Phase) * sample
/// distance, with First <= n < Stop.
struct SampleNumbers
{
  Vf Phase;
  Vf First;
  Vf Stop;

  /// The lanes of `rays` that take the sample n.
  HWY_INLINE Mf FindActive(Mf rays, int n) const
  {
    const Vf number = Splat(static_cast<float>(n));
    return hn::And(rays, hn::And(hn::Ge(number, this->First), hn::Lt(number, this->Stop)));
  }

  /// The samples n in s of a curve of a segment.
  HWY_INLINE Vf FindPlaces(const PacketCurve& curve, int n) const
  {
    const float number = static_cast<float>(n - curve.Segment->FirstSample);
    return hn::Mul(hn::Add(this->Phase, Splat(number)), curve.PerStep);
  }
};

/// Finds the positions that are not cropped; index or local coordinates as CropSpace says.
HWY_NOINLINE inline Mf IsUncropped(const PacketScene& scene, const Vec3& p)
{
  const Df d;
  const Di di;
  const Vf one = Splat(1.0f);
  const auto slab = [&](Vf x, int a) {
    return hn::Add(hn::IfThenElseZero(hn::Ge(x, Splat(scene.CropLow[a])), one),
      hn::IfThenElseZero(hn::Ge(x, Splat(scene.CropHigh[a])), one));
  };
  const Vf region =
    hn::MulAdd(Splat(9.0f), slab(p.z, 2), hn::MulAdd(Splat(3.0f), slab(p.y, 1), slab(p.x, 0)));
  const Vi flag = hn::Shl(hn::Set(di, 1), hn::ConvertTo(di, region));
  return hn::RebindMask(d, hn::Ne(hn::And(flag, hn::Set(di, scene.CropFlags)), hn::Zero(di)));
}

/// Finds the positions that are inside of the volume and not cropped.
HWY_INLINE Mf IsShown(
  const PacketScene& scene, const RayPacket& rays, const PacketCurve& curve, const Vec3& q, Vf s)
{
  const Mf inside = IsInside(scene, q);
  if (scene.CropSpace == Cropping::Spaces::None)
  {
    return inside;
  }
  if (scene.CropSpace == Cropping::Spaces::Rest)
  {
    return hn::And(inside, IsUncropped(scene, Copy(q)));
  }
  return hn::And(inside, IsUncropped(scene, MulAdd(curve.TimeAt(s), rays.Direction, rays.Origin)));
}

/// The state of the rays of a packet.
struct PacketState
{
  Mf Alive;     ///< rays that go on
  Mf Expecting; ///< rays whose last sample was visible
  PacketPixels Out;

  explicit PacketState(Mf active)
    : Alive(active)
    , Expecting(hn::FirstN(Df(), 0))
  {
    const Vf zero = hn::Zero(Df());
    this->Out = { { zero, zero, zero }, Splat(1.0f), Splat(1e30f), zero, zero, zero };
  }

  /// Composites lit colors at t behind what there is; rays of less than `least` end.
  HWY_INLINE void Add(Mf visible, const Vec3& color, Vf transmittance, Vf t, float least)
  {
    PacketPixels& out = this->Out;
    const Vf weight =
      hn::IfThenElseZero(visible, hn::Mul(out.Transmittance, hn::Sub(Splat(1.0f), transmittance)));
    out.Color = MulAdd(weight, color, out.Color);
    out.Transmittance =
      hn::IfThenElse(visible, hn::Mul(out.Transmittance, transmittance), out.Transmittance);
    out.FirstVisible = hn::IfThenElse(visible, hn::Min(out.FirstVisible, t), out.FirstVisible);
    this->Alive = hn::AndNot(hn::Lt(out.Transmittance, Splat(least)), this->Alive);
  }
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
