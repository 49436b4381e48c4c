// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Distance look-ups and leaps of packets. Included once per target of Highway.
#if defined(FFD_SIMD_LEAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_LEAP_INL_H_
#undef FFD_SIMD_LEAP_INL_H_
#else
#define FFD_SIMD_LEAP_INL_H_
#endif

#include "FFDMinMaxBlocks.h"
#include "FFDPacketCaster.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

constexpr float BlockEdge = static_cast<float>(MinMaxBlocks::BlockSize);

/// Distance, in blocks, of the block that holds each position; positions inside the volume.
HWY_INLINE Vf LookUpDistance(const PacketScene& scene, const Vec3& q, Vec3& block)
{
  const Df d;
  const Di di;
  const Vf zero = hn::Zero(d);
  const auto blockOf = [&](Vf x, int a)
  {
    return Clamp(hn::Floor(hn::Mul(x, Splat(1.0f / BlockEdge))), zero,
      Splat(static_cast<float>(scene.Blocks[a] - 1)));
  };
  block = { blockOf(q.x, 0), blockOf(q.y, 1), blockOf(q.z, 2) };
  const Vi index = hn::Add(hn::ConvertTo(di, block.x),
    hn::Mul(hn::Set(di, scene.Blocks[0]),
      hn::Add(hn::ConvertTo(di, block.y),
        hn::Mul(hn::Set(di, scene.Blocks[1]), hn::ConvertTo(di, block.z)))));
  const Vi word =
    hn::GatherOffset(di, reinterpret_cast<const int*>(scene.Distances), index);
  return hn::ConvertTo(d, hn::And(word, hn::Set(di, 255)));
}

HWY_INLINE Mf IsInside(const PacketScene& scene, const Vec3& q)
{
  const Vf zero = hn::Zero(Df());
  const auto within = [&](Vf x, int a)
  { return hn::And(hn::Ge(x, zero), hn::Le(x, Splat(scene.Upper[a]))); };
  return hn::And(within(q.x, 0), hn::And(within(q.y, 1), within(q.z, 2)));
}

/**
 * What is left of the distances from a packet to the faces of the empty boxes around its rays,
 * least over the rays, while it is followed piece by piece without being evaluated: LIPSCHITZ.
 */
class PacketSlack
{
public:
  void Clear() { this->Valid = false; }

  /// Whether all lanes of `lanes` are in empty surroundings; if so, keep their distances.
  bool Find(const PacketScene& scene, const Vec3& q, Mf lanes, float guard,
    CastStatistics& statistics)
  {
    const Df d;
    const Mf inside = IsInside(scene, q);
    const Mf looked = hn::And(inside, lanes);
    Vec3 block;
    const Vf distance = LookUpDistance(scene, q, block);
    this->Valid = false;
    if (!hn::AllFalse(d, hn::And(looked, hn::Eq(distance, hn::Zero(d)))))
    {
      return false;
    }
    statistics.DistanceLookups += static_cast<std::int64_t>(hn::CountTrue(d, looked));

    // Outside of the volume: the half space beyond the side it is farthest from.
    const Vf far = Splat(Far);
    const Vf beyond[6] = { hn::Neg(q.x), hn::Neg(q.y), hn::Neg(q.z),
      hn::Sub(q.x, Splat(scene.Upper[0])), hn::Sub(q.y, Splat(scene.Upper[1])),
      hn::Sub(q.z, Splat(scene.Upper[2])) };
    Vf most = beyond[0];
    for (int side = 1; side < 6; ++side)
    {
      most = hn::Max(most, beyond[side]);
    }
    const Vf edge = Splat(BlockEdge);
    const Vf below = hn::Sub(distance, Splat(1.0f));
    const Vf axis[3] = { q.x, q.y, q.z };
    const Vf blocks[3] = { block.x, block.y, block.z };
    for (int a = 0; a < 3; ++a)
    {
      Vf low = hn::Sub(axis[a], hn::Mul(edge, hn::Sub(blocks[a], below)));
      Vf high = hn::Sub(hn::Mul(edge, hn::Add(blocks[a], distance)), axis[a]);
      // Leaving through the side it is beyond of is what a ray outside may not do.
      const Vf lowOutside = hn::IfThenElse(hn::Eq(beyond[a + 3], most), beyond[a + 3], far);
      const Vf highOutside = hn::IfThenElse(hn::Eq(beyond[a], most), beyond[a], far);
      low = hn::IfThenElse(lanes, hn::IfThenElse(inside, low, lowOutside), far);
      high = hn::IfThenElse(lanes, hn::IfThenElse(inside, high, highOutside), far);
      this->Low[a] = SmallestLane(low) - guard;
      this->High[a] = SmallestLane(high) - guard;
    }
    this->Valid = true;
    return true;
  }

  /// Whether a piece of length dt with velocities [lo, hi] stays inside; if so, pass it.
  bool Pass(const float lo[3], const float hi[3], float dt)
  {
    if (!this->Valid)
    {
      return false;
    }
    bool stays = true;
    for (int a = 0; a < 3; ++a)
    {
      stays = stays && this->High[a] - std::max(hi[a], 0.0f) * dt >= 0.0f &&
        this->Low[a] + std::min(lo[a], 0.0f) * dt >= 0.0f;
    }
    if (!stays)
    {
      this->Valid = false;
      return false;
    }
    for (int a = 0; a < 3; ++a)
    {
      this->High[a] -= hi[a] * dt;
      this->Low[a] += lo[a] * dt;
    }
    return true;
  }

private:
  static constexpr float Far = 1e30f;

  bool Valid = false;
  float Low[3] = {};
  float High[3] = {};
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
