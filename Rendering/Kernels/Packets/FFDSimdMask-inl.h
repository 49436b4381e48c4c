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

#include "Optics/FFDLabelBlocks.h"

#include "FFDSimdMath-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The voxels of a mask that are nearest to positions.
struct MaskVoxels
{
  Vi X;
  Vi Y;
  Vi Z;
  Mf Outside; ///< lanes that are outside of a mask on a grid of its own
};

/// Finds those of positions q, index coordinates of the volume.
HWY_INLINE MaskVoxels FindMaskVoxels(const PacketMask& mask, const Vec3& q)
{
  const Df d;
  const Vec3 at = mask.SameGrid ? q : Add(Transform(mask.FromIndex, q), Broadcast(mask.Offset));
  const Vf half = Splat(0.5f);
  Mf outside = hn::FirstN(d, 0);
  const auto find = [&](Vf x, int a) FFD_INLINE_LAMBDA {
    const Vf last = Splat(static_cast<float>(mask.Dimensions[a] - 1));
    if (!mask.SameGrid)
    {
      outside = hn::Or(outside, hn::Or(hn::Lt(x, hn::Neg(half)), hn::Gt(x, hn::Add(last, half))));
    }
    return Truncate(Clamp(hn::Add(x, half), hn::Zero(d), last));
  };
  const Vi x = find(at.x, 0);
  const Vi y = find(at.y, 1);
  const Vi z = find(at.z, 2);
  return { x, y, z, outside };
}

/// The labels of the blocks that voxels are in, see LabelBlocks; these must be there.
HWY_INLINE Vi LoadBlockLabels(const PacketMask& mask, const MaskVoxels& voxels)
{
  const Di di;
  const auto block = [](Vi voxel) { return hn::ShiftRight<LabelBlocks::LogBlockSize>(voxel); };
  const Vi index = hn::Add(block(voxels.X),
    hn::Add(hn::Mul(block(voxels.Y), hn::Set(di, mask.BlocksPerRow)),
      hn::Mul(block(voxels.Z), hn::Set(di, mask.BlocksPerSlice))));
  return LoadBytes(mask.Blocks, index);
}

/// Returns function(scalar of the mask at the voxel nearest to q) of each lane, its label; 0
/// outside of the mask.
template <class Function>
HWY_INLINE Vi LookUpMask(const PacketMask& mask, const Vec3& q, const Function& function)
{
  const Di di;
  const MaskVoxels voxels = FindMaskVoxels(mask, q);
  if (mask.Blocks)
  {
    const Vi labels = LoadBlockLabels(mask, voxels);
    if (HWY_LIKELY(hn::AllFalse(di, hn::Eq(labels, hn::Set(di, LabelBlocks::Mixed)))))
    {
      return hn::IfThenZeroElse(hn::RebindMask(di, voxels.Outside), labels);
    }
  }
  const Vi row = hn::Add(voxels.Y, hn::Mul(voxels.Z, hn::Set(di, mask.Dimensions[1])));
  HWY_ALIGN int places[16]; // in all of the mask, or in rows
  HWY_ALIGN int rows[16];
  if (HWY_LIKELY(mask.InReach))
  {
    StoreIndices(
      hn::Add(voxels.X, hn::Mul(row, hn::Set(di, static_cast<int>(mask.RowIncrement)))), places);
  }
  else
  {
    StoreIndices(voxels.X, places);
    StoreIndices(row, rows);
  }
  HWY_ALIGN int numbers[16];
  DispatchScalarType(mask.Type, [&](auto zero) {
    const auto* const scalars = static_cast<const decltype(zero)*>(mask.Scalars);
    const auto find = [&](const auto& placeOf) {
      for (std::size_t lane = 0; lane < hn::Lanes(di); ++lane)
      {
        numbers[lane] = function(scalars[placeOf(lane)]);
      }
    };
    if (HWY_LIKELY(mask.InReach))
    {
      find([&](std::size_t lane) { return places[lane]; });
    }
    else
    {
      find([&](std::size_t lane) { return places[lane] + rows[lane] * mask.RowIncrement; });
    }
  });
  return hn::IfThenZeroElse(hn::RebindMask(di, voxels.Outside), hn::Load(di, numbers));
}

/// Lanes that are inside of a binary mask.
HWY_NOINLINE inline Mf IsInMask(const PacketMask& mask, const Vec3& q)
{
  const Vi inside = LookUpMask(mask, q, [](auto value) { return value > 0 ? 1 : 0; });
  return hn::RebindMask(Df(), hn::Gt(inside, hn::Zero(Di())));
}

/// Numbers of the tables in PacketScene::Table of the labels at positions.
HWY_NOINLINE inline Vi FindLabelTables(const PacketMask& mask, const Vec3& q)
{
  const Di di;
  const Vi labels = LookUpMask(mask, q, [&](auto scalar) { return mask.LabelOf(scalar); });
  if (HWY_LIKELY(IsCommon(labels)))
  {
    return hn::Set(di, mask.TableOf(hn::GetLane(labels)));
  }
  HWY_ALIGN int numbers[16];
  hn::Store(labels, di, numbers);
  for (std::size_t lane = 0; lane < hn::Lanes(di); ++lane)
  {
    numbers[lane] = mask.TableOf(numbers[lane]);
  }
  return hn::Load(di, numbers);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
