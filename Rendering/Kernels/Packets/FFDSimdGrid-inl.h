// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rectilinear grids, hidden cells and clipping planes, a position a lane. Included once per target
// of Highway.
#if defined(FFD_SIMD_GRID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_GRID_INL_H_
#undef FFD_SIMD_GRID_INL_H_
#else
#define FFD_SIMD_GRID_INL_H_
#endif

#include "FFDPacketGrid.h"
#include "FFDPacketScene.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMask-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdOpacityNormals-inl.h"
#include "FFDSimdRows-inl.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Entries of a table near the one of the first lane: rays of a packet are neighbors.
class NearEntries
{
public:
  HWY_INLINE explicit NearEntries(Vi entries)
  {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    const Di di;
    this->First = std::max(hn::GetLane(entries) - 7, 0);
    this->Numbers = hn::Sub(entries, hn::Set(di, this->First));
    const hn::RebindToUnsigned<Di> du;
    this->Near = hn::AllTrue(du, hn::Lt(hn::BitCast(du, this->Numbers), hn::Set(du, 15)));
#else
    static_cast<void>(entries);
#endif
  }

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  /// Whether LookUp() can look up the entries of all lanes, and the next ones.
  HWY_INLINE bool AreNear() const { return this->Near; }

  HWY_INLINE Vf LookUp(const std::vector<float>& table, int next = 0) const
  {
    const Vi numbers = next == 0 ? this->Numbers : hn::Add(this->Numbers, hn::Set(Di(), next));
    return Vf{ _mm512_permutexvar_ps(numbers.raw, _mm512_loadu_ps(table.data() + this->First)) };
  }

private:
  int First;
  Vi Numbers;
  bool Near;
#else
  static constexpr bool AreNear() { return false; }
  HWY_INLINE Vf LookUp(const std::vector<float>&, int = 0) const { return hn::Zero(Df()); }
#endif
};

/// Voxel coordinates along an axis of index coordinates.
HWY_INLINE Vf ToVoxels(const PacketAxis& axis, Vf x)
{
  const Df d;
  const Vf zero = hn::Zero(d);
  const Vf part = hn::Mul(hn::Sub(x, Splat(axis.Whole.Low)), Splat(axis.Whole.PerIndex));
  Vi entry = Truncate(Clamp(part, zero, Splat(axis.Whole.Last)));
  if (HWY_UNLIKELY(!axis.Bins.empty()))
  {
    const Quads bin = LoadQuads(reinterpret_cast<const std::uint32_t*>(axis.Bins.data()), entry);
    const Vf inBin = hn::Mul(hn::Sub(x, hn::BitCast(d, bin.x)), hn::BitCast(d, bin.y));
    entry = hn::Add(bin.z, Truncate(Clamp(inBin, zero, hn::BitCast(d, bin.w))));
  }
  const NearEntries near(entry);
  if (HWY_LIKELY(near.AreNear()))
  {
    const Vf way = hn::Sub(x, near.LookUp(axis.Columns[0]));
    const Vf slope =
      hn::IfThenElse(hn::Lt(way, zero), near.LookUp(axis.Columns[2]), near.LookUp(axis.Columns[3]));
    return hn::MulAdd(way, slope, near.LookUp(axis.Columns[1]));
  }
  const Quads bend = LoadQuads(reinterpret_cast<const std::uint32_t*>(axis.Bends.data()), entry);
  const Vf way = hn::Sub(x, hn::BitCast(d, bend.x));
  const Vf slope =
    hn::IfThenElse(hn::Lt(way, zero), hn::BitCast(d, bend.z), hn::BitCast(d, bend.w));
  return hn::MulAdd(way, slope, hn::BitCast(d, bend.y));
}

/// Voxel coordinates of index coordinates where PacketGrid::Uneven is true.
HWY_NOINLINE inline Vec3 ToVoxels(const PacketGrid& grid, const Vec3& q)
{
  return { ToVoxels(grid.Axes[0], q.x), ToVoxels(grid.Axes[1], q.y), ToVoxels(grid.Axes[2], q.z) };
}

/// Voxel coordinates of index coordinates, whatever is hidden.
HWY_INLINE Vec3 FindVoxels(const PacketScene& scene, const Vec3& q)
{
  return scene.Grid.Uneven ? ToVoxels(scene.Grid, Copy(q)) : Copy(q);
}

/// Numbers of cells, whole numbers from -Pad on, from those beyond the grid on.
HWY_INLINE Vi FindPaddedCells(Vf cell)
{
  return Truncate(hn::Add(cell, Splat(static_cast<float>(CellMask::Pad))));
}

/// Whether cells may be hidden that are at most CellMask::Nearby from some of these.
HWY_INLINE bool MayHideNearby(const PacketGrid& grid, const Vec3& cells)
{
  const Di di;
  const auto block = [](Vf cell) {
    return hn::ShiftRight<CellMask::LogBlockSize>(FindPaddedCells(cell));
  };
  const Vi index = hn::Add(block(cells.x),
    hn::Add(hn::Mul(block(cells.y), hn::Set(di, grid.NearRow)),
      hn::Mul(block(cells.z), hn::Set(di, grid.NearSlice))));
  return !hn::AllTrue(di, hn::Eq(LoadBytes(grid.NearHidden, index), hn::Zero(di)));
}

/// The bits of PacketGrid::Hidden around a cell of each lane.
class HiddenBits
{
public:
  /// `cells`: whole numbers, from -1 on.
  HWY_INLINE HiddenBits(const PacketGrid& grid, const Vec3& cells)
    : Grid(grid)
  {
    const Di di;
    const Vi x = FindPaddedCells(cells.x);
    const Vi row = hn::Add(hn::Mul(FindPaddedCells(cells.y), hn::Set(di, grid.HiddenRow)),
      hn::Mul(FindPaddedCells(cells.z), hn::Set(di, grid.HiddenSlice)));
    // The bit before that of the cell is the first one.
    const Vi first = hn::Sub(x, hn::Set(di, 1));
    this->Shift = hn::And(first, hn::Set(di, 7));
    StoreIndices(hn::Add(row, hn::ShiftRight<3>(first)), this->Offsets);
  }

  /// The bits of the row that lies dy and dz from that of the cells, from one before these on.
  HWY_INLINE Vi Row(int dy, int dz) const
  {
    const std::ptrdiff_t bytes =
      std::ptrdiff_t{ dy } * this->Grid.HiddenRow + std::ptrdiff_t{ dz } * this->Grid.HiddenSlice;
    return hn::Shr(LoadLanes<int, 1>(this->Grid.Hidden, bytes, this->Offsets), this->Shift);
  }

private:
  const PacketGrid& Grid;
  Vi Shift;
  HWY_ALIGN int Offsets[16]; ///< bytes
};

/// Bits of HiddenBits::Row(): of the cell, and of cells from it on along x.
constexpr int OwnBit = 2;
constexpr int CornerBits = 2 + 4;
constexpr int WideBits = 1 + 2 + 4 + 8;

HWY_INLINE Mf HasBits(Vi bits, int some)
{
  const Di di;
  return hn::RebindMask(Df(), hn::Ne(hn::And(bits, hn::Set(di, some)), hn::Zero(di)));
}

/// Whether the cells that hold voxel coordinates are hidden.
HWY_INLINE Mf IsInHiddenCell(const PacketGrid& grid, const Vec3& voxel)
{
  const auto cell = [&](Vf x, int a) {
    return hn::Floor(
      Clamp(hn::Add(x, Splat(grid.Margin)), hn::Zero(Df()), Splat(grid.LastCell[a])));
  };
  const Vec3 cells{ cell(voxel.x, 0), cell(voxel.y, 1), cell(voxel.z, 2) };
  return HWY_LIKELY(!MayHideNearby(grid, cells))
    ? hn::FirstN(Df(), 0)
    : HasBits(HiddenBits(grid, cells).Row(0, 0), OwnBit);
}

/// Where scalars on the grid of a mask are looked up.
HWY_INLINE Vec3 FindMaskPosition(const PacketScene& scene, const Vec3& q)
{
  return scene.Mask.SameGrid ? FindVoxels(scene, q) : Copy(q);
}

/// The lanes of `lanes` whose positions neither a binary mask nor a cell hides.
HWY_NOINLINE inline Mf LeaveOutHidden(const PacketScene& scene, const Vec3& q, Mf lanes)
{
  if (scene.Mask.Scalars && !scene.Mask.Labels)
  {
    lanes = hn::And(lanes, IsInMask(scene.Mask, FindMaskPosition(scene, q)));
  }
  if (scene.Grid.Hidden)
  {
    lanes = hn::AndNot(IsInHiddenCell(scene.Grid, FindVoxels(scene, q)), lanes);
  }
  return lanes;
}

/// The voxels that are nearest to voxel coordinates, where voxels are cells.
HWY_INLINE Vec3 FindNearestCells(const PacketGrid& grid, const Vec3& voxel)
{
  const auto snap = [&](Vf x, int a) {
    return hn::Floor(Clamp(hn::Add(x, Splat(0.5f)), hn::Zero(Df()), Splat(grid.LastCell[a])));
  };
  return { snap(voxel.x, 0), snap(voxel.y, 1), snap(voxel.z, 2) };
}

/// Voxel coordinates of index coordinates in the volume, and beside hidden cells, where values are
/// not interpolated, those of the nearest voxels.
HWY_NOINLINE inline Vec3 FindMovedVoxels(const PacketScene& scene, const Vec3& q)
{
  const PacketGrid& grid = scene.Grid;
  const Vec3 voxel = FindVoxels(scene, q);
  if (!grid.Snaps)
  {
    return voxel;
  }
  // As TouchesHidden().
  const Df d;
  const auto floor = [&](Vf x, int a) {
    return hn::Floor(Clamp(x, Splat(-1.0f), Splat(grid.LastCell[a])));
  };
  const Vec3 cells{ floor(voxel.x, 0), floor(voxel.y, 1), floor(voxel.z, 2) };
  if (HWY_LIKELY(!MayHideNearby(grid, cells)))
  {
    return voxel;
  }
  const HiddenBits bits(grid, cells);
  const Mf touches =
    HasBits(hn::Or(hn::Or(bits.Row(0, 0), bits.Row(1, 0)), hn::Or(bits.Row(0, 1), bits.Row(1, 1))),
      CornerBits);
  if (HWY_LIKELY(hn::AllFalse(d, touches)))
  {
    return voxel;
  }
  return Select(touches, FindNearestCells(grid, voxel), voxel);
}

/// Voxel coordinates at which values are interpolated.
HWY_INLINE Vec3 FindSampledVoxels(const PacketScene& scene, const Vec3& q)
{
  return HWY_LIKELY(!scene.Grid.MovesSamples()) ? q : FindMovedVoxels(scene, q);
}

/// Interpolates a table of an axis at voxel coordinates, not beyond the outermost voxels.
HWY_INLINE Vf InterpolatePlaces(const PacketAxis& axis, const std::vector<float>& table, Vf voxel)
{
  const Df d;
  const Vf entry = hn::Mul(voxel, Splat(axis.PlacesPerVoxel));
  const Vf whole = hn::Min(hn::Floor(entry), Splat(axis.LastPlace - 1.0f));
  const Vf part = hn::Sub(entry, whole);
  const Vi number = Truncate(whole);
  const NearEntries near(number);
  if (HWY_LIKELY(near.AreNear()))
  {
    return Lerp(near.LookUp(table), near.LookUp(table, 1), part);
  }
  HWY_ALIGN int offsets[16];
  StoreIndices(number, offsets);
  const Pairs pair = LoadPairLanes<4>(table.data(), 0, offsets);
  return Lerp(hn::BitCast(d, pair.x), hn::BitCast(d, pair.y), part);
}

/// Gradients by index coordinates, over two of them, of differences by voxel coordinates over two
/// voxels: those over less, at the faces of the volume, are scaled to that already.
HWY_NOINLINE inline Vec3 ToIndexGradient(
  const PacketScene& scene, const Vec3& voxel, const Vec3& gradient)
{
  const bool nearest = scene.Volume.Nearest;
  const auto scale = [&](Vf x, Vf difference, int a) {
    const PacketAxis& axis = scene.Grid.Axes[a];
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    const Vf last = Splat(static_cast<float>(scene.Volume.Dimensions[a] - 1));
    const Vf at = Clamp(nearest ? hn::Floor(hn::Add(x, Splat(0.5f))) : x, zero, last);
    const Vf width = InterpolatePlaces(axis, axis.Widths, at);
    const Vf voxels = hn::Sub(hn::Min(hn::Add(at, one), last), hn::Max(hn::Sub(at, one), zero));
    return hn::Mul(difference, hn::Mul(voxels, Reciprocal(width)));
  };
  return { scale(voxel.x, gradient.x, 0), scale(voxel.y, gradient.y, 1),
    scale(voxel.z, gradient.z, 2) };
}

/// Index coordinates of voxel coordinates in the volume.
HWY_NOINLINE inline Vec3 FindIndex(const PacketScene& scene, const Vec3& voxel)
{
  const PacketGrid& grid = scene.Grid;
  const auto along = [&](Vf x, int a) {
    return InterpolatePlaces(grid.Axes[a], grid.Axes[a].Places, x);
  };
  return grid.Uneven ? Vec3{ along(voxel.x, 0), along(voxel.y, 1), along(voxel.z, 2) } : voxel;
}

/// The positions of NeighborValues that clipping planes hide, the deformation being linear around
/// the samples, as SampleClassifier.
struct ClippedNeighbors
{
  Mf Behind[3];
  Mf Before[3];

  /// Replaces the values there.
  HWY_INLINE void Replace(float value, NeighborValues& of) const
  {
    for (int a = 0; a < 3; ++a)
    {
      of.Behind[a] = hn::IfThenElse(this->Behind[a], Splat(value), of.Behind[a]);
      of.Before[a] = hn::IfThenElse(this->Before[a], Splat(value), of.Before[a]);
    }
  }
};

/// `q`, `p`: the samples, index and local coordinates; `steps`: PacketNormals::FindSteps(). `ends`:
/// where the values are.
HWY_NOINLINE inline ClippedNeighbors FindClippedNeighbors(const PacketScene& scene, const Vec3& q,
  const Vec3& p, const Vec3 (&steps)[3], const DifferenceEnds& ends)
{
  constexpr float Slack = 1e-3f; // voxels
  const Df d;
  const Vf zero = hn::Zero(d);
  Vec3 ways[2][3];
  ClippedNeighbors clipped;
  for (int a = 0; a < 3; ++a)
  {
    ways[0][a] = Sub(FindIndex(scene, ends.Behind[a]), q);
    ways[1][a] = Sub(FindIndex(scene, ends.Before[a]), q);
    clipped.Behind[a] = hn::FirstN(d, 0);
    clipped.Before[a] = hn::FirstN(d, 0);
  }
  for (const std::array<float, 4>& plane : scene.ClippingPlanes)
  {
    const Vec3 across{ Splat(plane[0]), Splat(plane[1]), Splat(plane[2]) };
    const Vec3 normal{ Dot(across, steps[0]), Dot(across, steps[1]), Dot(across, steps[2]) };
    // The sample is shown, whatever is rounded, and so is what lies along the plane from it.
    const Vf offset = hn::MulAdd(Splat(Slack), FastSqrt(Dot(normal, normal)),
      hn::Max(hn::Add(Dot(across, p), Splat(plane[3])), zero));
    for (int a = 0; a < 3; ++a)
    {
      const auto has = [&](const Vec3& way) {
        return hn::Lt(hn::Add(Dot(normal, way), offset), zero);
      };
      clipped.Behind[a] = hn::Or(clipped.Behind[a], has(ways[0][a]));
      clipped.Before[a] = hn::Or(clipped.Before[a], has(ways[1][a]));
    }
  }
  return clipped;
}

/// The ends of differences of which some end at hidden cells.
struct ShownEnds : DifferenceEnds
{
  Mf Lanes[3]; ///< by axis: whose differences are not those without hidden cells
};

/**
 * Finds the differences of `lanes` at voxel coordinates as FindDifferences(): they end at hidden
 * cells, or are those of the nearest voxels (PacketGrid::Snaps). Returns whether any are others
 * than those without hidden cells; else nothing is set.
 */
HWY_NOINLINE inline bool FindShownEnds(
  const PacketScene& scene, const Vec3& voxel, Mf lanes, ShownEnds& ends)
{
  const PacketGrid& grid = scene.Grid;
  const PacketVolume& v = scene.Volume;
  const Df d;
  const auto floor = [&](Vf x, int a) {
    return hn::Floor(Clamp(x, hn::Zero(d), Splat(grid.LastCell[a])));
  };
  Vec3 cell{ floor(voxel.x, 0), floor(voxel.y, 1), floor(voxel.z, 2) };
  if (HWY_LIKELY(!MayHideNearby(grid, cell)))
  {
    return false;
  }
  const HiddenBits bits(grid, cell);
  // Sides of cells that are hidden.
  Mf before[3];
  Mf behind[3];
  const auto findSides = [&](const HiddenBits& of) {
    const Vi own = of.Row(0, 0);
    before[0] = HasBits(own, OwnBit >> 1);
    behind[0] = HasBits(own, OwnBit << 1);
    before[1] = HasBits(of.Row(-1, 0), OwnBit);
    behind[1] = HasBits(of.Row(1, 0), OwnBit);
    before[2] = HasBits(of.Row(0, -1), OwnBit);
    behind[2] = HasBits(of.Row(0, 1), OwnBit);
  };
  const auto change = [&](Mf x, Mf y, Mf z) {
    ends.Lanes[0] = hn::And(lanes, x);
    ends.Lanes[1] = hn::And(lanes, y);
    ends.Lanes[2] = hn::And(lanes, z);
    return !hn::AllFalse(d, hn::Or(ends.Lanes[0], hn::Or(ends.Lanes[1], ends.Lanes[2])));
  };
  if (!grid.Snaps)
  {
    findSides(bits);
    if (HWY_LIKELY(!change(hn::Or(before[0], behind[0]), hn::Or(before[1], behind[1]),
          hn::Or(before[2], behind[2]))))
    {
      return false;
    }
    static_cast<DifferenceEnds&>(ends) = FindEnds(v, voxel);
    for (int a = 0; a < 3; ++a)
    {
      // A position on the upper face of a cell is one of the next cell.
      const Vf first = CoordinateOf(cell, a);
      const Vf last = hn::Add(first, Splat(1.0f));
      const Vf end = v.Nearest ? last : JustBelow(last);
      Vf& low = CoordinateOf(ends.Before[a], a);
      Vf& high = CoordinateOf(ends.Behind[a], a);
      low = hn::IfThenElse(before[a], hn::Max(low, first), low);
      high = hn::IfThenElse(behind[a], hn::Min(high, end), high);
    }
    return true;
  }
  // As TouchesHidden().
  const auto both = [&bits](int y, int z, int dy, int dz) {
    return hn::Or(bits.Row(y, z), bits.Row(y + dy, z + dz));
  };
  const Vi inner = hn::Or(both(0, 0, 1, 0), both(0, 1, 1, 0));
  const Vi alongY = hn::Or(both(-1, 0, 0, 1), both(2, 0, 0, 1));
  const Vi alongZ = hn::Or(both(0, -1, 1, 0), both(0, 2, 1, 0));
  const Mf own = HasBits(inner, CornerBits);
  if (HWY_LIKELY(!change(HasBits(inner, WideBits), hn::Or(own, HasBits(alongY, CornerBits)),
        hn::Or(own, HasBits(alongZ, CornerBits)))))
  {
    return false;
  }
  const Vec3 nearest = FindNearestCells(grid, voxel);
  findSides(HiddenBits(grid, nearest));
  for (int a = 0; a < 3; ++a)
  {
    const auto end = [&](float step, Mf hidden) {
      return Select(hidden, nearest, MoveAlong(v, nearest, a, step));
    };
    ends.Behind[a] = end(1.0f, behind[a]);
    ends.Before[a] = end(-1.0f, before[a]);
  }
  return true;
}

/// Replaces gradients by index coordinates, over two of them, by those of what has these values at
/// the ends of differences.
HWY_NOINLINE inline void ReplaceShown(
  const PacketScene& scene, const ShownEnds& ends, const NeighborValues& of, Vec3& gradient)
{
  const auto replace = [&](int a, Vf low, Vf high, Vf& slope) {
    const PacketAxis& axis = scene.Grid.Axes[a];
    const Vf width = scene.Grid.Uneven ? hn::Sub(InterpolatePlaces(axis, axis.Places, high),
                                           InterpolatePlaces(axis, axis.Places, low))
                                       : hn::Sub(high, low);
    const Mf some = hn::Gt(width, hn::Zero(Df()));
    const Vf difference = hn::Mul(Splat(2.0f), hn::Sub(of.Behind[a], of.Before[a]));
    const Vf own =
      hn::IfThenElseZero(some, hn::Div(difference, hn::IfThenElse(some, width, Splat(1.0f))));
    slope = hn::IfThenElse(ends.Lanes[a], own, slope);
  };
  replace(0, ends.Before[0].x, ends.Behind[0].x, gradient.x);
  replace(1, ends.Before[1].y, ends.Behind[1].y, gradient.y);
  replace(2, ends.Before[2].z, ends.Behind[2].z, gradient.z);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
