// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Look-ups of distances to what is visible, and leaps. Included once per target of Highway.
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

/// Numbers, along an axis, of the blocks that positions are in; what is outside of the volume
/// counts as in the nearest block.
HWY_INLINE Vf BlockOf(const PacketScene& scene, Vf x, int a)
{
  constexpr float PerVoxel = 1.0f / static_cast<float>(MinMaxBlocks::BlockSize);
  return hn::Floor(Clamp(hn::Mul(x, Splat(PerVoxel)), hn::Zero(Df()), Splat(scene.LastBlock[a])));
}

/// Distances of blocks to the nearest visible one.
HWY_INLINE Vf DistanceOf(const PacketScene& scene, Vf x, Vf y, Vf z)
{
  const Di di;
  const Vi index = hn::Add(hn::ConvertTo(di, x),
    hn::Mul(hn::Set(di, scene.Blocks[0]),
      hn::Add(hn::ConvertTo(di, y), hn::Mul(hn::Set(di, scene.Blocks[1]), hn::ConvertTo(di, z)))));
  HWY_ALIGN int offsets[16];
  hn::Store(index, di, offsets);
  return hn::ConvertTo(
    Df(), hn::And(LoadLanes<int, 1>(scene.Distances, 0, offsets), hn::Set(di, 255)));
}

/// Whether boxes of a radius touch eight blocks at most.
inline bool CanTellBoxes(const float radius[3])
{
  constexpr float Half = 0.5f * static_cast<float>(MinMaxBlocks::BlockSize);
  return std::max({ radius[0], radius[1], radius[2] }) <= Half;
}

/// The lanes of `lanes` whose boxes of `radius` around q touch empty blocks only, if
/// CanTellBoxes().
HWY_INLINE Mf FindEmptyBoxes(
  const PacketScene& scene, const Vec3& q, const float radius[3], Mf lanes)
{
  const Df d;
  if (!CanTellBoxes(radius))
  {
    return hn::FirstN(d, 0);
  }
  const Vf position[3] = { q.x, q.y, q.z };
  Vf ends[3][2];
  for (int a = 0; a < 3; ++a)
  {
    ends[a][0] = BlockOf(scene, hn::Sub(position[a], Splat(radius[a])), a);
    ends[a][1] = BlockOf(scene, hn::Add(position[a], Splat(radius[a])), a);
  }
  for (int corner = 0; corner < 8 && !hn::AllFalse(d, lanes); ++corner)
  {
    const Vf distance =
      DistanceOf(scene, ends[0][corner & 1], ends[1][corner >> 1 & 1], ends[2][corner >> 2]);
    lanes = hn::And(lanes, hn::Gt(distance, hn::Zero(d)));
  }
  return lanes;
}

/// Positions from which nothing visible is near: the empty cube around each lane's block, and how
/// far its lane may move in it.
class EmptySpaceQuery
{
public:
  /// `q`: index coordinates; what is outside of the volume counts as in the nearest block.
  HWY_INLINE EmptySpaceQuery(const PacketScene& scene, const Vec3& q)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    const Vf edge = Splat(BlockEdge);
    const Vf far = Splat(Far);
    this->Position[0] = q.x;
    this->Position[1] = q.y;
    this->Position[2] = q.z;
    Vf block[3];
    for (int a = 0; a < 3; ++a)
    {
      block[a] = BlockOf(scene, this->Position[a], a);
    }
    const Vf distance = DistanceOf(scene, block[0], block[1], block[2]);
    this->Empty = hn::Gt(distance, zero);
    for (int a = 0; a < 3; ++a)
    {
      // What lies before the first voxels or behind the last ones belongs to their blocks.
      const Vf low = hn::Add(hn::Sub(block[a], distance), Splat(1.0f));
      const Vf high = hn::Add(block[a], distance);
      this->Low[a] = hn::IfThenElse(hn::Le(low, zero), hn::Neg(far), hn::Mul(edge, low));
      this->High[a] =
        hn::IfThenElse(hn::Gt(high, Splat(scene.LastBlock[a])), far, hn::Mul(edge, high));
    }
  }

  /// Lanes whose blocks are empty.
  HWY_INLINE Mf IsEmpty() const { return this->Empty; }

  /**
   * How many steps, a whole number, each lane may make and stay in its cube with a box of `radius`
   * around it; negative where the box is not in it. A step leads at most `up` and `down` along each
   * axis (index units, not negative).
   */
  HWY_INLINE Vf CountSteps(const float radius[3], const float up[3], const float down[3]) const
  {
    Vf steps = Splat(Most);
    for (int a = 0; a < 3; ++a)
    {
      const Vf r = Splat(radius[a]);
      const Vf above = hn::Sub(hn::Sub(this->High[a], this->Position[a]), r);
      const Vf below = hn::Sub(hn::Sub(this->Position[a], this->Low[a]), r);
      steps = hn::Min(steps,
        hn::Min(hn::Mul(above, Splat(1.0f / std::max(up[a], Slowest))),
          hn::Mul(below, Splat(1.0f / std::max(down[a], Slowest)))));
    }
    return hn::IfThenElse(this->Empty, hn::Floor(steps), Splat(-1.0f));
  }

private:
  static constexpr float BlockEdge = static_cast<float>(MinMaxBlocks::BlockSize);
  static constexpr float Far = 1e30f;
  static constexpr float Most = 1e6f;
  static constexpr float Slowest = 1e-6f;

  Vf Position[3];
  Vf Low[3];
  Vf High[3];
  Mf Empty;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
