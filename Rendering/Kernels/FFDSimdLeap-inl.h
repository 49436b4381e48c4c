// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Empty-space queries and leaps. Included once per target of Highway.
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

/// Numbers, along an axis, of the blocks that hold positions. Positions outside of the volume count
/// as in the nearest block.
HWY_INLINE Vf BlockOf(const PacketScene& scene, Vf x, int a)
{
  constexpr float PerVoxel = 1.0f / static_cast<float>(MinMaxBlocks::BlockSize);
  return hn::Floor(Clamp(hn::Mul(x, Splat(PerVoxel)), hn::Zero(Df()), Splat(scene.LastBlock[a])));
}

/// The distances to the nearest visible block of four blocks along x, from block (x, y, z) on; a
/// byte each.
HWY_INLINE Vi DistancesFrom(const PacketScene& scene, Vf x, Vf y, Vf z)
{
  const Di di;
  const Vi index = hn::Add(Truncate(x),
    hn::Mul(hn::Set(di, scene.Blocks[0]),
      hn::Add(Truncate(y), hn::Mul(hn::Set(di, scene.Blocks[1]), Truncate(z)))));
  HWY_ALIGN int offsets[16];
  StoreIndices(index, offsets);
  return LoadLanes<int, 1>(scene.Distances, 0, offsets);
}

/// Looks up the bounds of the values in boxes from the lowest corners of the lanes, whose sides fit
/// in a cell of `grid`.
HWY_INLINE Vi PeaksFrom(const ValuePeaks::Grid& grid, const Vec3& low)
{
  const Df d;
  const Di di;
  const Vf perVoxel = Splat(1.0f / grid.Edge);
  const auto along = [&](Vf x, int a) {
    const Vf last = Splat(static_cast<float>(grid.Size[a] - 1));
    return Truncate(Clamp(hn::Mul(x, perVoxel), hn::Zero(d), last));
  };
  const Vi index = hn::Add(along(low.x, 0),
    hn::Mul(hn::Set(di, grid.Size.x),
      hn::Add(along(low.y, 1), hn::Mul(hn::Set(di, grid.Size.y), along(low.z, 2)))));
  HWY_ALIGN int offsets[16];
  StoreIndices(index, offsets);
  return hn::And(LoadLanes<int, 1>(grid.Codes.data(), 0, offsets), hn::Set(di, 0xff));
}

/// Whether boxes of a radius touch at most three blocks along each axis, as FindEmptyBoxes() needs.
inline bool CanQueryBoxes(const std::array<float, 3>& radius)
{
  return std::max({ radius[0], radius[1], radius[2] }) <=
    static_cast<float>(MinMaxBlocks::BlockSize);
}

/// Finds the lanes of `lanes` whose boxes of `radius` around q touch empty blocks only, if
/// CanQueryBoxes().
HWY_INLINE Mf FindEmptyBoxes(
  const PacketScene& scene, const Vec3& q, const std::array<float, 3>& radius, Mf lanes)
{
  const Df d;
  const Di di;
  const Vf position[3] = { q.x, q.y, q.z };
  // The first block along each axis, the last one, and one between them.
  Vf blocks[3][3];
  int count[3];
  for (std::size_t a = 0; a < 3; ++a)
  {
    const int axis = static_cast<int>(a);
    blocks[a][0] = BlockOf(scene, hn::Sub(position[a], Splat(radius[a])), axis);
    blocks[a][1] = BlockOf(scene, hn::Add(position[a], Splat(radius[a])), axis);
    blocks[a][2] = hn::Min(hn::Add(blocks[a][0], Splat(1.0f)), blocks[a][1]);
    count[a] = 2.0f * radius[a] <= static_cast<float>(MinMaxBlocks::BlockSize) ? 2 : 3;
  }
  // A load holds the blocks along x; the bytes behind them count as empty.
  const auto byteIf = [&](Vf less, Vf more, int byte) {
    return hn::IfThenZeroElse(hn::RebindMask(di, hn::Lt(less, more)), hn::Set(di, byte));
  };
  const Vi behind = hn::Or(hn::Set(di, static_cast<int>(0xff000000u)),
    hn::Or(
      byteIf(blocks[0][0], blocks[0][1], 0xff00), byteIf(blocks[0][2], blocks[0][1], 0xff0000)));
  for (int z = 0; z < count[2]; ++z)
  {
    for (int y = 0; y < count[1]; ++y)
    {
      if (hn::AllFalse(d, lanes))
      {
        return lanes;
      }
      const Vi distances =
        hn::Or(DistancesFrom(scene, blocks[0][0], blocks[1][y], blocks[2][z]), behind);
      // The highest bits of bytes that are zero, and maybe of those behind such a byte.
      const Vi zeros = hn::And(hn::AndNot(distances, hn::Sub(distances, hn::Set(di, 0x01010101))),
        hn::Set(di, static_cast<int>(0x80808080u)));
      lanes = hn::And(lanes, hn::RebindMask(d, hn::Eq(zeros, hn::Zero(di))));
    }
  }
  return lanes;
}

/// Asks whether the block of each lane's position is empty, by the distance map, and how far the
/// lane may move within the empty cube around that block.
class EmptySpaceQuery
{
public:
  /// `q`: index coordinates. Positions outside of the volume count as in the nearest block.
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
    const Vf distance = hn::ConvertTo(
      d, hn::And(DistancesFrom(scene, block[0], block[1], block[2]), hn::Set(Di(), 0xff)));
    this->Empty = hn::Gt(distance, zero);
    for (int a = 0; a < 3; ++a)
    {
      // The blocks at the faces extend beyond the volume.
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
   * Counts the steps, a whole number, after which a box of `radius` around each lane's position is
   * still in its empty cube; negative if it is not in it at all. A step moves by at most `up` and
   * `down` along each axis (index units, not negative).
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
