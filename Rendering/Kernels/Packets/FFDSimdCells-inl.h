// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The cells that samples lie in, and what 32-bit offsets can reach of them. Included once per
// target of Highway.
#if defined(FFD_SIMD_CELLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_CELLS_INL_H_
#undef FFD_SIMD_CELLS_INL_H_
#else
#define FFD_SIMD_CELLS_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// First voxels of the cells that the lanes sample.
struct SampleCells
{
  Vi X;
  Vi Y;
  Vi Z;
};

/// The position of each lane's sample in its cell, 0 to 1.
struct SamplePosition
{
  Vf Fx;
  Vf Fy;
  Vf Fz;
  Vi Weights;            ///< 1 - Fx and Fx as PairWeights()
  bool AtVoxels = false; ///< PacketVolume::AtVoxels
  const PacketIntegers* Integers;
};

/// As Copy() of vectors.
HWY_INLINE SamplePosition Copy(const SamplePosition& at)
{
  return { at.Fx, at.Fy, at.Fz, at.Weights, at.AtVoxels, at.Integers };
}

/// The value between two neighboring voxels, at a part of the way from `a` to `b`. At a voxel the
/// other one does not count: what is not a finite number would, whatever its weight in a sum.
HWY_INLINE Vf Between(Vf a, Vf b, Vf part, const SamplePosition& at)
{
  const Vf sum = Lerp(a, b, part);
  return HWY_LIKELY(!at.AtVoxels) ? sum
                                  : hn::IfThenElse(hn::Eq(part, hn::Zero(Df())), a,
                                      hn::IfThenElse(hn::Eq(part, Splat(1.0f)), b, sum));
}

/// First voxel, along an axis, of the cell that holds a position.
HWY_INLINE Vf CellOf(const PacketVolume& v, Vf x, int a)
{
  return hn::Floor(Clamp(x, hn::Zero(Df()), Splat(static_cast<float>(v.Dimensions[a] - 2))));
}

/// Finds the cells that hold positions, for what is beyond the outermost voxels the nearest place
/// of these. `inner`: all positions that count lie between voxels.
HWY_INLINE SamplePosition FindCells(
  const PacketVolume& v, const Vec3& q, bool inner, SampleCells& cells)
{
  const Df d;
  const Di di;
  SamplePosition at;
  at.Integers = &v.Integers;
  at.AtVoxels = v.AtVoxels;
  const auto locate = [&](Vf x, int a, Vi& cell, Vf& part) {
    if (inner)
    {
      cell = Truncate(x);
      part = hn::Sub(x, hn::ConvertTo(d, cell));
      return;
    }
    const Vf first = CellOf(v, x, a);
    cell = hn::ConvertTo(di, first);
    part = Clamp(hn::Sub(x, first), hn::Zero(d), Splat(1.0f));
  };
  locate(q.x, 0, cells.X, at.Fx);
  locate(q.y, 1, cells.Y, at.Fy);
  locate(q.z, 2, cells.Z, at.Fz);
  if (HWY_UNLIKELY(v.Nearest))
  {
    // The nearest voxel is linear interpolation with weights of zero and one.
    const auto snap = [&](Vf f) { return hn::IfThenElseZero(hn::Ge(f, Splat(0.5f)), Splat(1.0f)); };
    at.Fx = snap(at.Fx);
    at.Fy = snap(at.Fy);
    at.Fz = snap(at.Fz);
  }
  at.Weights = PairWeights(at.Fx);
  return at;
}

/// The first slice of the cells of some lanes; 1 if there are no lanes.
HWY_INLINE int FindFirstSlice(const SampleCells& cells, Mf lanes)
{
  const Di di;
  const Vi z = hn::IfThenElse(hn::RebindMask(di, lanes), cells.Z, hn::Set(di, 1 << 30));
  return hn::AllFalse(Df(), lanes) ? 1 : hn::GetLane(hn::MinOfLanes(di, z));
}

/**
 * Finds the lanes of `lanes` whose cells have neighbors on all sides, so that the voxels one
 * further out exist. In large volumes they are near each other; the others are fetched as those at
 * faces.
 */
HWY_INLINE Mf FindInterior(const PacketVolume& v, const SampleCells& cells, Mf lanes)
{
  const Di di;
  const auto within = [&](Vi c, int a) {
    return hn::And(hn::Gt(c, hn::Zero(di)), hn::Lt(c, hn::Set(di, v.Dimensions[a] - 2)));
  };
  Mf interior = hn::And(lanes,
    hn::RebindMask(
      Df(), hn::And(within(cells.X, 0), hn::And(within(cells.Y, 1), within(cells.Z, 2)))));
  if (HWY_UNLIKELY(v.SlicesInReach > 0))
  {
    const int last = FindFirstSlice(cells, interior) + v.SlicesInReach;
    interior = hn::And(interior, hn::RebindMask(Df(), hn::Lt(cells.Z, hn::Set(di, last))));
  }
  return interior;
}

/**
 * Whether the rows of the cells of all of `lanes` lie in the memory of the volume, from one voxel
 * before the cells to one behind them: those of the very first and the very last cell do not. At
 * other faces they hold voxels of the rows beside them, which values do not depend on.
 */
HWY_INLINE bool HasRowsOfCells(const PacketVolume& v, const SampleCells& cells, Mf lanes)
{
  const Di di;
  if (HWY_UNLIKELY(v.SlicesInReach > 0))
  {
    return false;
  }
  const auto toLast = [&](Vi c, int a) { return hn::Sub(c, hn::Set(di, v.Dimensions[a] - 2)); };
  const Vi first = hn::Or(cells.X, hn::Or(cells.Y, cells.Z));
  const Vi last = hn::Or(toLast(cells.X, 0), hn::Or(toLast(cells.Y, 1), toLast(cells.Z, 2)));
  const Vi zero = hn::Zero(di);
  return hn::AllFalse(
    di, hn::And(hn::RebindMask(di, lanes), hn::Or(hn::Eq(first, zero), hn::Eq(last, zero))));
}

/// What is read in the place of the voxels around cells that no lane is in.
alignas(64) constexpr char NoVoxels[256] = {};

/// A view of the voxels that the 32-bit offsets of some lanes can reach.
class VoxelsInReach
{
public:
  /// Stores the offsets of the first voxels of the cells of `lanes`, FindInterior(); other lanes
  /// get a cell that can be fetched. Keeps a pointer to `v`.
  HWY_INLINE void Fit(const PacketVolume& v, const SampleCells& cells, Mf lanes, int (&offsets)[16])
  {
    const Di di;
    this->Volume = &v;
    Vi z = cells.Z;
    int slice = 1;
    if (HWY_UNLIKELY(v.SlicesInReach != 0))
    {
      if (v.SlicesInReach < 0)
      {
        return this->FitThin(v, { cells.X, cells.Y, cells.Z }, lanes, offsets);
      }
      const int first = FindFirstSlice(cells, lanes);
      this->Shifted = v;
      this->Shifted.Scalars = static_cast<const char*>(v.Scalars) +
        static_cast<std::ptrdiff_t>(first) * v.IncrementZ * v.ElementSize;
      this->Volume = &this->Shifted;
      z = hn::Sub(z, hn::Set(di, first));
      slice = 0;
    }
    const Vi offset = hn::Add(hn::Mul(cells.X, hn::Set(di, v.Components)),
      hn::Add(hn::Mul(cells.Y, hn::Set(di, v.IncrementY)), hn::Mul(z, hn::Set(di, v.IncrementZ))));
    const Vi safe = hn::Set(di, v.Components + v.IncrementY + slice * v.IncrementZ);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, lanes), offset, safe), di, offsets);
  }

  /// Uses offsets that the caller knows.
  HWY_INLINE void Set(const PacketVolume& v) { this->Volume = &v; }

  HWY_INLINE const PacketVolume& Get() const { return *this->Volume; }

private:
  /// Fit() where some cell is not known to have voxels on all sides: that of one of `lanes` is
  /// taken, if there are any.
  HWY_NOINLINE void FitThin(
    const PacketVolume& v, const SampleCells& cells, Mf lanes, int (&offsets)[16])
  {
    const Di di;
    if (hn::AllFalse(Df(), lanes))
    {
      this->Shifted = v;
      this->Shifted.Scalars = NoVoxels + sizeof(NoVoxels) / 4;
      this->Shifted.IncrementY = 0;
      this->Shifted.IncrementZ = 0;
      this->Volume = &this->Shifted;
      return hn::Store(hn::Zero(di), di, offsets);
    }
    const Vi offset = hn::Add(hn::Mul(cells.X, hn::Set(di, v.Components)),
      hn::Add(
        hn::Mul(cells.Y, hn::Set(di, v.IncrementY)), hn::Mul(cells.Z, hn::Set(di, v.IncrementZ))));
    const auto ofLanes = hn::RebindMask(di, lanes);
    const Vi safe = hn::MinOfLanes(di, hn::IfThenElse(ofLanes, offset, hn::Set(di, LargestOffset)));
    hn::Store(hn::IfThenElse(ofLanes, offset, safe), di, offsets);
  }

  static constexpr int LargestOffset = 2147483647;

  const PacketVolume* Volume = nullptr;
  PacketVolume Shifted;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
