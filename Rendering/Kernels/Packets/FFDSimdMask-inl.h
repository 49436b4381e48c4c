// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Looking up masks and labels, a position a lane. Included once per target of Highway.
#if defined(FFD_SIMD_MASK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_MASK_INL_H_
#undef FFD_SIMD_MASK_INL_H_
#else
#define FFD_SIMD_MASK_INL_H_
#endif

#include "FFDPacketMask.h"
#include "FFDScalarDispatch.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Finds the voxels of a mask that are nearest to positions q, index coordinates of the volume:
/// their places in rows, and these by number, through all slices; -1 outside of a mask on a grid of
/// its own.
HWY_INLINE void FindMaskVoxels(
  const PacketMask& mask, const Vec3& q, int (&places)[16], int (&rows)[16])
{
  const Df d;
  const Di di;
  const Vec3 at = mask.SameGrid ? q : Add(Transform(mask.FromIndex, q), Broadcast(mask.Offset));
  const Vf half = Splat(0.5f);
  Mf outside = hn::FirstN(d, 0);
  const auto find = [&](Vf x, int a) {
    const Vf last = Splat(static_cast<float>(mask.Dimensions[a] - 1));
    outside = hn::Or(outside, hn::Or(hn::Lt(x, hn::Neg(half)), hn::Gt(x, hn::Add(last, half))));
    return Truncate(Clamp(hn::Add(x, half), hn::Zero(d), last));
  };
  const Vi x = find(at.x, 0);
  const Vi y = find(at.y, 1);
  Vi row = hn::Add(y, hn::Mul(find(at.z, 2), hn::Set(di, mask.Dimensions[1])));
  if (!mask.SameGrid)
  {
    row = hn::IfThenElse(hn::RebindMask(di, outside), hn::Set(di, -1), row);
  }
  StoreIndices(x, places);
  StoreIndices(row, rows);
}

/// Returns function(scalar of the mask at the voxel nearest to q) of each lane, a number; 0 outside
/// of the mask.
template <class Number, class Function>
HWY_INLINE auto LookUpMask(const PacketMask& mask, const Vec3& q, const Function& function)
{
  const hn::Rebind<Number, Df> d;
  HWY_ALIGN int places[16];
  HWY_ALIGN int rows[16];
  FindMaskVoxels(mask, q, places, rows);
  HWY_ALIGN Number numbers[16];
  DispatchScalarType(mask.Type, [&](auto zero) {
    const auto* const scalars = static_cast<const decltype(zero)*>(mask.Scalars);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      const std::ptrdiff_t at = places[lane] + rows[lane] * mask.RowIncrement;
      numbers[lane] = rows[lane] >= 0 ? function(scalars[at]) : Number(0);
    }
  });
  return hn::Load(d, numbers);
}

/// Lanes that are inside of a binary mask.
HWY_NOINLINE inline Mf IsInMask(const PacketMask& mask, const Vec3& q)
{
  const Vf inside = LookUpMask<float>(mask, q, [](auto value) { return value > 0 ? 1.0f : 0.0f; });
  return hn::Gt(inside, hn::Zero(Df()));
}

/// Numbers of the tables in PacketScene::Table of the labels at positions.
HWY_NOINLINE inline Vi FindLabelTables(const PacketMask& mask, const Vec3& q)
{
  return LookUpMask<int>(mask, q, [&](auto label) { return mask.TableOf(label); });
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
