// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rectilinear grids and hidden cells, a position a lane. Included once per target of Highway.
#if defined(FFD_SIMD_GRID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_GRID_INL_H_
#undef FFD_SIMD_GRID_INL_H_
#else
#define FFD_SIMD_GRID_INL_H_
#endif

#include "FFDPacketGrid.h"
#include "FFDPacketScene.h"
#include "Optics/FFDDifferences.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMask-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdOpacityNormals-inl.h"
#include "FFDSimdRows-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
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
  return scene.Grid.Uneven ? ToVoxels(scene.Grid, q) : q;
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
    const auto padded = [&](Vf cell) {
      return Truncate(hn::Add(cell, Splat(static_cast<float>(CellMask::Pad))));
    };
    const Vi x = padded(cells.x);
    const Vi row = hn::Add(hn::Mul(padded(cells.y), hn::Set(di, grid.HiddenRow)),
      hn::Mul(padded(cells.z), hn::Set(di, grid.HiddenSlice)));
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
  const HiddenBits bits(grid, { cell(voxel.x, 0), cell(voxel.y, 1), cell(voxel.z, 2) });
  return HasBits(bits.Row(0, 0), OwnBit);
}

/// Where scalars on the grid of a mask are looked up.
HWY_INLINE Vec3 FindMaskPosition(const PacketScene& scene, const Vec3& q)
{
  return scene.Mask.SameGrid ? FindVoxels(scene, q) : q;
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
  const HiddenBits bits(grid, { floor(voxel.x, 0), floor(voxel.y, 1), floor(voxel.z, 2) });
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

/// Values along each axis: one voxel before and behind a sample, and at the ends of its cell.
struct ValuesAround
{
  Vf Before[3];
  Vf Behind[3];
  Vf First[3];
  Vf Last[3];
  Vf Own;
};

/// Interpolates the values around samples of which all rows are at hand, or their opacities.
template <class T, class Source>
HWY_NOINLINE void FindValuesAround(const PacketScene& scene, const Source& source,
  const SamplePosition& at, const SampleRows<T>& rows, bool ofOpacity, ValuesAround& values)
{
  using F = Fetch<T>;
  using Along = typename F::Along;
  const auto value = [&](const SamplePosition& in, Along a00, Along a10, Along a01, Along a11) {
    const Vf v = F::Value(Across<T>(in, a00, a10, a01, a11), in);
    return ofOpacity ? OpacityOfValues(scene, v) : v;
  };
  const auto middle = [&](int dy, int dz) { return source.Middle(dy, dz, at); };
  values.Own = value(at, rows.M00, rows.M10, rows.M01, rows.M11);
  values.Before[0] = value(at, F::Before(rows.R00, at), F::Before(rows.R10, at),
    F::Before(rows.R01, at), F::Before(rows.R11, at));
  values.Behind[0] = value(at, F::Behind(rows.R00, at), F::Behind(rows.R10, at),
    F::Behind(rows.R01, at), F::Behind(rows.R11, at));
  values.Before[1] = value(at, middle(-1, 0), rows.M00, middle(-1, 1), rows.M01);
  values.Behind[1] = value(at, rows.M10, middle(2, 0), rows.M11, middle(2, 1));
  values.Before[2] = value(at, middle(0, -1), middle(1, -1), rows.M00, rows.M10);
  values.Behind[2] = value(at, rows.M01, rows.M11, middle(0, 2), middle(1, 2));
  const auto end = [&](int axis, float part) {
    SamplePosition in = at;
    (axis == 0 ? in.Fx : axis == 1 ? in.Fy : in.Fz) = Splat(part);
    in.Weights = PairWeights(in.Fx);
    return value(in, F::Middle(rows.R00, in), F::Middle(rows.R10, in), F::Middle(rows.R01, in),
      F::Middle(rows.R11, in));
  };
  for (int a = 0; a < 3; ++a)
  {
    values.First[a] = end(a, 0.0f);
    values.Last[a] = end(a, 1.0f);
  }
}

/// Which differences along each axis end at hidden cells, or are those of the nearest voxels
/// (PacketGrid::Snaps).
struct HiddenSides
{
  Mf Before[3];
  Mf Behind[3];
  Mf Snaps[3];
  Mf Any; ///< lanes whose gradients may differ from those without hidden cells
};

HWY_INLINE HiddenSides FindHiddenSides(const PacketScene& scene, const Vec3& voxel)
{
  const PacketGrid& grid = scene.Grid;
  const Df d;
  const auto floor = [&](Vf x, int a) {
    return hn::Floor(Clamp(x, hn::Zero(d), Splat(grid.LastCell[a])));
  };
  const HiddenBits bits(grid, { floor(voxel.x, 0), floor(voxel.y, 1), floor(voxel.z, 2) });
  HiddenSides sides;
  const auto findSides = [&sides](const HiddenBits& of) {
    const Vi own = of.Row(0, 0);
    sides.Before[0] = HasBits(own, OwnBit >> 1);
    sides.Behind[0] = HasBits(own, OwnBit << 1);
    sides.Before[1] = HasBits(of.Row(-1, 0), OwnBit);
    sides.Behind[1] = HasBits(of.Row(1, 0), OwnBit);
    sides.Before[2] = HasBits(of.Row(0, -1), OwnBit);
    sides.Behind[2] = HasBits(of.Row(0, 1), OwnBit);
  };
  const Mf none = hn::FirstN(d, 0);
  if (!grid.Snaps)
  {
    findSides(bits);
    sides.Any = none;
    for (int a = 0; a < 3; ++a)
    {
      sides.Snaps[a] = none;
      sides.Any = hn::Or(sides.Any, hn::Or(sides.Before[a], sides.Behind[a]));
    }
    if (scene.Volume.Nearest)
    {
      // Differences about the nearest voxel reach into one cell more.
      sides.Any = hn::Or(sides.Any,
        hn::Or(HasBits(bits.Row(0, 0), WideBits),
          HasBits(hn::Or(bits.Row(2, 0), bits.Row(0, 2)), OwnBit)));
    }
    return sides;
  }
  // As TouchesHidden().
  const auto both = [&bits](int y, int z, int dy, int dz) {
    return hn::Or(bits.Row(y, z), bits.Row(y + dy, z + dz));
  };
  const Vi inner = hn::Or(both(0, 0, 1, 0), both(0, 1, 1, 0));
  const Vi alongY = hn::Or(both(-1, 0, 0, 1), both(2, 0, 0, 1));
  const Vi alongZ = hn::Or(both(0, -1, 1, 0), both(0, 2, 1, 0));
  const Mf own = HasBits(inner, CornerBits);
  sides.Snaps[0] = HasBits(inner, WideBits);
  sides.Snaps[1] = hn::Or(own, HasBits(alongY, CornerBits));
  sides.Snaps[2] = hn::Or(own, HasBits(alongZ, CornerBits));
  sides.Any = hn::Or(sides.Snaps[0], hn::Or(sides.Snaps[1], sides.Snaps[2]));
  if (scene.Volume.Nearest)
  {
    sides.Snaps[0] = sides.Snaps[1] = sides.Snaps[2] = hn::Not(none);
  }
  findSides(HiddenBits(grid, FindNearestCells(grid, voxel)));
  return sides;
}

/// Does what FindShownGradient() does, one by one.
HWY_NOINLINE inline Vec3 ShownGradientByReference(const PacketScene& scene, const Vec3& voxel,
  Mf lanes, const Vec3& gradient, int component, bool ofOpacity)
{
  const SampleClassifier& classifier = *scene.Frame->Classifier;
  const VolumeView& volume = scene.Source->Volume;
  const VolumeView view = volume.Components > 1 ? GetComponent(volume, component) : volume;
  const auto value = [&](const glm::dvec3& at, bool nearest) {
    const double scalar = (nearest ? scene.Nearest : scene.Reference).Value(view, at);
    return ofOpacity ? static_cast<double>(classifier.ClassifyValue(0, scalar).a) : scalar;
  };
  const double unit = 2.0 * (ofOpacity ? 1.0 : scene.Volume.Scale[component]);
  return ReplaceLanes(lanes, voxel, gradient, [&](const glm::dvec3& at) {
    return unit * FindDifferences(view, at, scene.Volume.Nearest, classifier.GetHidden(), value);
  });
}

/// The gradients by index coordinates at voxel coordinates of one component, or of its opacity, as
/// fetched, where differences end at hidden cells, as FindDifferences(); elsewhere `gradient`.
template <class T>
HWY_NOINLINE Vec3 FindShownGradient(const PacketScene& scene, BorderSamples<T>& border,
  const Vec3& voxel, Mf lanes, const Vec3& gradient, int component, bool ofOpacity)
{
  const Df d;
  const PacketGrid& grid = scene.Grid;
  const PacketVolume& volume = scene.Volume;
  const HiddenSides sides = FindHiddenSides(scene, voxel);
  lanes = hn::And(lanes, sides.Any);
  if (HWY_LIKELY(hn::AllFalse(d, lanes)))
  {
    return gradient;
  }
  if (volume.Components > 1 || (volume.Nearest && !grid.Snaps))
  {
    return ShownGradientByReference(scene, voxel, lanes, gradient, component, ofOpacity);
  }
  const Vf zero = hn::Zero(d);
  const Vf one = Splat(1.0f);
  const auto clamp = [&](Vf x, int a) {
    return Clamp(x, zero, Splat(static_cast<float>(volume.Dimensions[a] - 1)));
  };
  const Vec3 inside = grid.Snaps ? FindNearestCells(grid, voxel)
                                 : Vec3{ clamp(voxel.x, 0), clamp(voxel.y, 1), clamp(voxel.z, 2) };
  FetchedSample<T> fetched;
  FetchSample(volume, inside, lanes, border, fetched);
  ValuesAround values;
  FindValuesAround<T>(scene, fetched.Voxels, fetched.At, fetched.Rows, ofOpacity, values);
  const auto difference = [&](Vf at, Vf plain, int a) {
    const Vf last = Splat(static_cast<float>(volume.Dimensions[a] - 1));
    const Vf cell = hn::Min(hn::Floor(at), Splat(grid.LastCell[a]));
    const Vf first = grid.Snaps ? at : cell;
    const Vf end = grid.Snaps ? at : hn::Add(cell, one);
    const Vf low = hn::IfThenElse(sides.Before[a], first, hn::Max(hn::Sub(at, one), zero));
    const Vf high = hn::IfThenElse(sides.Behind[a], end, hn::Min(hn::Add(at, one), last));
    const Vf below =
      hn::IfThenElse(sides.Before[a], grid.Snaps ? values.Own : values.First[a], values.Before[a]);
    const Vf above =
      hn::IfThenElse(sides.Behind[a], grid.Snaps ? values.Own : values.Last[a], values.Behind[a]);
    Vf width = hn::Sub(high, low);
    if (grid.Uneven)
    {
      const PacketAxis& axis = grid.Axes[a];
      width = hn::Sub(
        InterpolatePlaces(axis, axis.Places, high), InterpolatePlaces(axis, axis.Places, low));
    }
    const Mf some = hn::Gt(width, zero);
    const Vf slope = hn::IfThenElseZero(
      some, hn::Div(hn::Mul(Splat(2.0f), hn::Sub(above, below)), hn::IfThenElse(some, width, one)));
    return hn::IfThenElse(grid.Snaps ? hn::And(lanes, sides.Snaps[a]) : lanes, slope, plain);
  };
  const Vec3 shown{ difference(inside.x, gradient.x, 0), difference(inside.y, gradient.y, 1),
    difference(inside.z, gradient.z, 2) };
  // At some faces not all rows are at hand.
  const Mf others =
    fetched.Voxels.IsRepeating() ? hn::FirstN(d, 0) : hn::And(lanes, fetched.AtBorder);
  return HWY_LIKELY(hn::AllFalse(d, others))
    ? shown
    : ShownGradientByReference(scene, voxel, others, shown, component, ofOpacity);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
