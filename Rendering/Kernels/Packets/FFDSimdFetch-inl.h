// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Trilinear samples and their gradients, a position a lane. Included once per target of Highway.
#if defined(FFD_SIMD_FETCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_FETCH_INL_H_
#undef FFD_SIMD_FETCH_INL_H_
#else
#define FFD_SIMD_FETCH_INL_H_
#endif

#include "FFDPacketVolume.h"
#include "FFDScalarDispatch.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdWide-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

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
  Vi Weights; ///< 1 - Fx and Fx as PairWeights()
  const PacketIntegers* Integers;
};

/// First voxel, along an axis, of the cell that holds a position.
HWY_INLINE Vf CellOf(const PacketVolume& v, Vf x, int a)
{
  return hn::Floor(Clamp(x, hn::Zero(Df()), Splat(static_cast<float>(v.Dimensions[a] - 2))));
}

/// Finds the cells that hold positions. `inner`: all positions that count lie between voxels.
HWY_INLINE SamplePosition FindCells(
  const PacketVolume& v, const Vec3& q, bool inner, SampleCells& cells)
{
  const Df d;
  const Di di;
  SamplePosition at;
  at.Integers = &v.Integers;
  const auto locate = [&](Vf x, int a, Vi& cell, Vf& part) {
    if (inner)
    {
      cell = Truncate(x);
      part = hn::Sub(x, hn::ConvertTo(d, cell));
      return;
    }
    const Vf first = CellOf(v, x, a);
    cell = hn::ConvertTo(di, first);
    part = hn::Sub(x, first);
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
        return this->FitThin(v, cells, lanes, offsets);
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

/**
 * Fetches rows of voxels of one scalar type and interpolates them along x. Offsets name the voxel
 * at the start of the cell; a fetch may read from the voxel before it to the second one behind it.
 *
 * Row: the voxels from one before the cell to one behind it.
 * Along: values along x, as they are interpolated and subtracted.
 * Middle(), Before(), Behind(): at the position, and one voxel before and behind it.
 * Middle(v, offsets, delta, at): Middle() without fetching the voxels further out.
 * Repeat(row, first, last): of the first four voxels of a line, the row of the cell before them in
 * the lanes of `first`, of the last four that of the cell behind them in the lanes of `last`, whose
 * missing voxel is the outermost one.
 * Value(), Difference(): the value, or the difference of two, that an interpolated one stands for.
 */
template <class T>
struct Fetch;

/// Fetches voxels that are interpolated in single precision. Loader::LoadRow() loads the four
/// voxels of a row, and Loader::LoadCell() those of the cells.
template <class Loader>
struct FetchFloats
{
  using Row = Row4;
  using Along = Vf;
  static HWY_INLINE Vf ToFloat(Vf along) { return along; }
  static HWY_INLINE Vf Value(Vf value, const SamplePosition&) { return value; }
  static HWY_INLINE Vec3 Difference(const Vec3& g, const SamplePosition&) { return g; }
  static HWY_INLINE Row LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    return Loader::LoadRow(v, offsets, delta);
  }
  static HWY_INLINE Row Repeat(const Row& r, Mi first, Mi last)
  {
    const Mf isFirst = hn::RebindMask(Df(), first);
    const Mf isLast = hn::RebindMask(Df(), last);
    const auto choose = [&](Vf one, Vf other, Vf same) {
      return hn::IfThenElse(isFirst, one, hn::IfThenElse(isLast, other, same));
    };
    return { choose(r.A, r.B, r.A), choose(r.A, r.C, r.B), choose(r.B, r.D, r.C),
      choose(r.C, r.D, r.D) };
  }
  static HWY_INLINE Vf Before(const Row& r, const SamplePosition& at)
  {
    return Lerp(r.A, r.B, at.Fx);
  }
  static HWY_INLINE Vf Middle(const Row& r, const SamplePosition& at)
  {
    return Lerp(r.B, r.C, at.Fx);
  }
  static HWY_INLINE Vf Behind(const Row& r, const SamplePosition& at)
  {
    return Lerp(r.C, r.D, at.Fx);
  }
  static HWY_INLINE Vf Middle(
    const PacketVolume& v, const int* offsets, int delta, const SamplePosition& at)
  {
    Vf cell[2];
    Loader::LoadCell(v, offsets, delta, cell);
    return Lerp(cell[0], cell[1], at.Fx);
  }
};

template <class T>
struct WideLoader
{
  static HWY_INLINE Row4 LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    return WideVoxels::Load<T, Row4>(v, offsets, delta - 1);
  }
  static HWY_INLINE void LoadCell(
    const PacketVolume& v, const int* offsets, int delta, Vf (&cell)[2])
  {
    const Row2 pair = WideVoxels::Load<T, Row2>(v, offsets, delta);
    cell[0] = pair.A;
    cell[1] = pair.B;
  }
};
template <>
struct Fetch<WideScalar> : FetchFloats<WideLoader<WideScalar>>
{
};
template <>
struct Fetch<double> : FetchFloats<WideLoader<double>>
{
};

struct FloatLoader
{
  static HWY_INLINE Row4 LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    const Df d;
    const Quads words =
      LoadQuadLanes<4>(v.Scalars, 4 * static_cast<std::ptrdiff_t>(delta - 1), offsets);
    return { hn::BitCast(d, words.x), hn::BitCast(d, words.y), hn::BitCast(d, words.z),
      hn::BitCast(d, words.w) };
  }
  static HWY_INLINE void LoadCell(
    const PacketVolume& v, const int* offsets, int delta, Vf (&cell)[2])
  {
    const Df d;
    const Pairs words =
      LoadPairLanes<4>(v.Scalars, 4 * static_cast<std::ptrdiff_t>(delta), offsets);
    cell[0] = hn::BitCast(d, words.x);
    cell[1] = hn::BitCast(d, words.y);
  }
};
template <>
struct Fetch<float> : FetchFloats<FloatLoader>
{
};

// Integers of at most 16 bits are interpolated along x as such (PairWeights): a pair of voxels
// times a pair of weights in one instruction. So positions along x are rounded to 1 / FixedOne of a
// voxel, which is about what single precision has left of them.

/// Fetches whole numbers that become signed 16-bit ones by PacketIntegers.
struct FetchIntegers
{
  using Along = Vi;
  static HWY_INLINE Vf ToFloat(Vi along) { return hn::ConvertTo(Df(), along); }
  static HWY_INLINE Vf Value(Vf value, const SamplePosition& at)
  {
    return hn::MulAdd(value, Splat(at.Integers->Unit), Splat(at.Integers->Zero));
  }
  static HWY_INLINE Vec3 Difference(const Vec3& g, const SamplePosition& at)
  {
    return Scale(Splat(at.Integers->Unit), g);
  }
};

/// 8-bit types: one 32-bit load holds the four voxels of a row.
template <>
struct Fetch<std::uint8_t> : FetchIntegers
{
  using Row = Vi;
  static HWY_INLINE Vi LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    return LoadLanes<int, 1>(v.Scalars, delta - 1, offsets);
  }
  static HWY_INLINE Vi Repeat(Vi row, Mi first, Mi last)
  {
    const Di di;
    const Vi low = hn::Set(di, 0xff);
    const Vi up = hn::Or(hn::ShiftLeft<8>(row), hn::And(row, low));
    const Vi high = hn::Set(di, static_cast<int>(0xff000000u));
    const Vi down = hn::Or(hn::AndNot(high, hn::ShiftRight<8>(row)), hn::And(row, high));
    return hn::IfThenElse(first, up, hn::IfThenElse(last, down, row));
  }
  static HWY_INLINE Vi Before(Vi row, const SamplePosition& at)
  {
    return MultiplyPairs(Pair<0>(row, at), at.Weights);
  }
  static HWY_INLINE Vi Middle(Vi row, const SamplePosition& at)
  {
    return MultiplyPairs(Pair<1>(row, at), at.Weights);
  }
  static HWY_INLINE Vi Behind(Vi row, const SamplePosition& at)
  {
    return MultiplyPairs(Pair<2>(row, at), at.Weights);
  }
  static HWY_INLINE Vi Middle(
    const PacketVolume& v, const int* offsets, int delta, const SamplePosition& at)
  {
    return Middle(LoadRow(v, offsets, delta), at);
  }

private:
  /// Two neighboring bytes of each lane as halves of 16 bits.
  template <int First>
  static HWY_INLINE Vi Pair(Vi row, const SamplePosition& at)
  {
    const Di di;
#if HWY_TARGET == HWY_SCALAR
    const Vi byte = hn::Set(di, 255);
    const Vi low = hn::And(hn::ShiftRight<8 * First>(row), byte);
    const Vi high = hn::And(hn::ShiftRight<8 * First + 8>(row), byte);
    const Vi pair = hn::Or(low, hn::ShiftLeft<16>(high));
    return at.Integers->Signed ? hn::ShiftLeft<8>(pair) : pair;
#else
    const hn::Repartition<std::uint8_t, Di> bytes;
    const auto from = hn::LoadDup128(hn::RebindToUnsigned<Di>(), at.Integers->Pairs[First]);
    return hn::BitCast(
      di, hn::TableLookupBytesOr0(hn::BitCast(bytes, row), hn::BitCast(bytes, from)));
#endif
  }
};

/// 16-bit types: a 32-bit load holds two voxels, which is a pair already.
template <>
struct Fetch<std::uint16_t> : FetchIntegers
{
  struct Row
  {
    Vi AB;
    Vi CD;
  };
  static HWY_INLINE Row LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    const Pairs words =
      LoadPairLanes<2>(v.Scalars, 2 * static_cast<std::ptrdiff_t>(delta - 1), offsets);
    return { ToSigned(v, words.x), ToSigned(v, words.y) };
  }
  /// Two voxels as they are in memory, as they are in a row.
  static HWY_INLINE Vi ToSigned(const PacketVolume& v, Vi pair)
  {
    return hn::Xor(pair, hn::Set(Di(), static_cast<int>(v.Integers.Flip)));
  }
  static HWY_INLINE Row Repeat(const Row& r, Mi first, Mi last)
  {
    const Di di;
    const Vi low = hn::Set(di, 0xffff);
    const Vi bc = hn::Or(hn::And(hn::ShiftRight<16>(r.AB), low), hn::ShiftLeft<16>(r.CD));
    const Vi aa = hn::Or(hn::ShiftLeft<16>(r.AB), hn::And(r.AB, low));
    const Vi dd = hn::Or(hn::And(hn::ShiftRight<16>(r.CD), low), hn::AndNot(low, r.CD));
    return { hn::IfThenElse(first, aa, hn::IfThenElse(last, bc, r.AB)),
      hn::IfThenElse(first, bc, hn::IfThenElse(last, dd, r.CD)) };
  }
  static HWY_INLINE Vi Before(const Row& r, const SamplePosition& at)
  {
    return MultiplyPairs(r.AB, at.Weights);
  }
  static HWY_INLINE Vi Middle(const Row& r, const SamplePosition& at)
  {
    const Vi b = hn::And(hn::ShiftRight<16>(r.AB), hn::Set(Di(), 0xFFFF));
    return MultiplyPairs(hn::Or(b, hn::ShiftLeft<16>(r.CD)), at.Weights);
  }
  static HWY_INLINE Vi Behind(const Row& r, const SamplePosition& at)
  {
    return MultiplyPairs(r.CD, at.Weights);
  }
  static HWY_INLINE Vi Middle(
    const PacketVolume& v, const int* offsets, int delta, const SamplePosition& at)
  {
    return MultiplyPairs(Load(v, offsets, delta), at.Weights);
  }

private:
  static HWY_INLINE Vi Load(const PacketVolume& v, const int* offsets, int delta)
  {
    return ToSigned(
      v, LoadLanes<int, 2>(v.Scalars, 2 * static_cast<std::ptrdiff_t>(delta), offsets));
  }
};

/// Calls use(T()) with the type that Fetch has for scalars of a type. Whole numbers with a sign are
/// read as those without, see PacketIntegers.
template <class Use>
HWY_INLINE auto ForFetched(ScalarType type, const Use& use)
{
  switch (type)
  {
    case ScalarType::Int8:
    case ScalarType::UInt8:
      return use(std::uint8_t());
    case ScalarType::Int16:
    case ScalarType::UInt16:
      return use(std::uint16_t());
    case ScalarType::Float32:
      return use(float());
    case ScalarType::Float64:
      return use(double());
    default:
      return use(WideScalar());
  }
}

/// The four rows of a cell, kept by a sample for its gradient, and their values at the position.
template <class T>
struct SampleRows
{
  typename Fetch<T>::Row R00;
  typename Fetch<T>::Row R10; // y + 1
  typename Fetch<T>::Row R01; // z + 1
  typename Fetch<T>::Row R11;
  typename Fetch<T>::Along M00;
  typename Fetch<T>::Along M10;
  typename Fetch<T>::Along M01;
  typename Fetch<T>::Along M11;
};

/// Interpolates along y and z between four values along x.
template <class T>
HWY_INLINE Vf Across(const SamplePosition& at, typename Fetch<T>::Along a00,
  typename Fetch<T>::Along a10, typename Fetch<T>::Along a01, typename Fetch<T>::Along a11)
{
  using F = Fetch<T>;
  return Lerp(Lerp(F::ToFloat(a00), F::ToFloat(a10), at.Fy),
    Lerp(F::ToFloat(a01), F::ToFloat(a11), at.Fy), at.Fz);
}

/// Difference along x, over two voxels, in a row.
template <class T>
HWY_INLINE typename Fetch<T>::Along Slope(
  const SamplePosition& at, const typename Fetch<T>::Row& row)
{
  return hn::Sub(Fetch<T>::Behind(row, at), Fetch<T>::Before(row, at));
}

/**
 * Rows of voxels that lie dy and dz from those of the cells, loaded lane by lane. Row() gives all
 * four voxels, Middle() what Fetch::Middle() does of those of the cell.
 */
template <class T>
class OffsetRows
{
public:
  /// Fetches from the cells of `lanes`, FindInterior(); other lanes get a cell that can be fetched.
  HWY_INLINE void Fit(const PacketVolume& v, const SampleCells& cells, Mf lanes)
  {
    this->Voxels.Fit(v, cells, lanes, this->Offsets);
  }

  /// Uses cells at offsets, elements, that the caller knows.
  HWY_INLINE void Set(const PacketVolume& v, const int offsets[16])
  {
    this->Voxels.Set(v);
    std::copy_n(offsets, 16, this->Offsets);
  }

  /// All voxels are at hand for Gradient().
  HWY_INLINE void Widen() const {}

  /// Whether the outermost voxels are repeated beyond the volume.
  static constexpr bool IsRepeating() { return false; }

  HWY_INLINE typename Fetch<T>::Row Row(int dy, int dz) const
  {
    return Fetch<T>::LoadRow(this->Voxels.Get(), this->Offsets, this->Delta(dy, dz));
  }
  HWY_INLINE typename Fetch<T>::Along Middle(int dy, int dz, const SamplePosition& at) const
  {
    return Fetch<T>::Middle(this->Voxels.Get(), this->Offsets, this->Delta(dy, dz), at);
  }

private:
  HWY_INLINE int Delta(int dy, int dz) const
  {
    return dy * this->Voxels.Get().IncrementY + dz * this->Voxels.Get().IncrementZ;
  }

  VoxelsInReach Voxels;
  HWY_ALIGN int Offsets[16]; ///< elements
};

/// Rows of voxels as OffsetRows, or those of any cells, with the outermost voxels of the volume
/// repeated beyond it.
template <class T>
class FaceRows
{
public:
  /// Whether Repeat() can be used: not where a slice may be out of reach, or a line too short.
  static HWY_INLINE bool CanRepeat(const PacketVolume& v)
  {
    return !v.Nearest && v.SlicesInReach <= 0 && v.Dimensions[0] >= 4;
  }

  /// As OffsetRows::Fit().
  HWY_INLINE void Fit(const PacketVolume& v, const SampleCells& cells, Mf lanes)
  {
    this->Repeating = false;
    this->Inner.Fit(v, cells, lanes);
  }

  /// Fetches from all cells. Keeps a pointer to `v`.
  HWY_INLINE void Repeat(const PacketVolume& v, const SampleCells& cells)
  {
    const Di di;
    const Vi zero = hn::Zero(di);
    this->Repeating = true;
    this->Volume = &v;
    this->First = hn::Eq(cells.X, zero);
    this->Last = hn::Eq(cells.X, hn::Set(di, v.Dimensions[0] - 2));
    this->AtEnds = !hn::AllFalse(di, hn::Or(this->First, this->Last));
    this->X = hn::Min(hn::Max(cells.X, hn::Set(di, 1)), hn::Set(di, v.Dimensions[0] - 3));
    for (int i = 0; i < 4; ++i)
    {
      const auto offset = [&](Vi cell, int a, int increment) {
        const Vi place = hn::Add(cell, hn::Set(di, i - 1));
        return hn::Mul(
          hn::Min(hn::Max(place, zero), hn::Set(di, v.Dimensions[a] - 1)), hn::Set(di, increment));
      };
      this->Y[i] = offset(cells.Y, 1, v.IncrementY);
      this->Z[i] = offset(cells.Z, 2, v.IncrementZ);
    }
  }

  HWY_INLINE void Widen() const {}

  HWY_INLINE bool IsRepeating() const { return this->Repeating; }

  HWY_INLINE typename Fetch<T>::Row Row(int dy, int dz) const
  {
    if (HWY_LIKELY(!this->Repeating))
    {
      return this->Inner.Row(dy, dz);
    }
    HWY_ALIGN int offsets[16];
    hn::Store(hn::Add(this->X, hn::Add(this->Y[1 + dy], this->Z[1 + dz])), Di(), offsets);
    const auto row = Fetch<T>::LoadRow(*this->Volume, offsets, 0);
    return this->AtEnds ? Fetch<T>::Repeat(row, this->First, this->Last) : row;
  }

  HWY_INLINE typename Fetch<T>::Along Middle(int dy, int dz, const SamplePosition& at) const
  {
    return HWY_LIKELY(!this->Repeating) ? this->Inner.Middle(dy, dz, at)
                                        : Fetch<T>::Middle(this->Row(dy, dz), at);
  }

private:
  bool Repeating = false;
  bool AtEnds = false; ///< of lines along x
  OffsetRows<T> Inner;
  const PacketVolume* Volume = nullptr;
  Mi First;
  Mi Last;
  Vi X;    ///< of the first voxel of the cell from which a line has all four, elements
  Vi Y[4]; ///< of lines from one before the cell to one behind it, elements
  Vi Z[4];
};

/// Trilinear scalar of interior lanes; rows are kept for Gradient.
template <class T, class Source>
HWY_INLINE Vf Sample(const Source& source, const SamplePosition& at, SampleRows<T>& rows)
{
  using F = Fetch<T>;
  rows.R00 = source.Row(0, 0);
  rows.R10 = source.Row(1, 0);
  rows.R01 = source.Row(0, 1);
  rows.R11 = source.Row(1, 1);
  rows.M00 = F::Middle(rows.R00, at);
  rows.M10 = F::Middle(rows.R10, at);
  rows.M01 = F::Middle(rows.R01, at);
  rows.M11 = F::Middle(rows.R11, at);
  return F::Value(Across<T>(at, rows.M00, rows.M10, rows.M01, rows.M11), at);
}

/**
 * f(q + e) - f(q - e) by index coordinates, e one voxel along each axis: central differences of
 * interpolated samples, from the 32 voxels that the seven samples touch. The inner eight, and the
 * eight beside them along x, come with the sample.
 */
template <class T, class Source>
HWY_INLINE Vec3 Gradient(const Source& source, const SamplePosition& at, const SampleRows<T>& rows)
{
  using F = Fetch<T>;
  const auto middle = [&](int dy, int dz) { return source.Middle(dy, dz, at); };
  const Vec3 g{ //
    Across<T>(at, Slope<T>(at, rows.R00), Slope<T>(at, rows.R10), Slope<T>(at, rows.R01),
      Slope<T>(at, rows.R11)),
    Across<T>(at, hn::Sub(rows.M10, middle(-1, 0)), hn::Sub(middle(2, 0), rows.M00),
      hn::Sub(rows.M11, middle(-1, 1)), hn::Sub(middle(2, 1), rows.M01)),
    Across<T>(at, hn::Sub(rows.M01, middle(0, -1)), hn::Sub(rows.M11, middle(1, -1)),
      hn::Sub(middle(0, 2), rows.M00), hn::Sub(middle(1, 2), rows.M10))
  };
  return F::Difference(g, at);
}

/// Values one voxel behind and one voxel before samples along each axis.
struct NeighborValues
{
  Vf Behind[3];
  Vf Before[3];
};

/// The values whose differences Gradient() gives, from the same voxels.
template <class T, class Source>
HWY_INLINE NeighborValues FindNeighborValues(
  const Source& source, const SamplePosition& at, const SampleRows<T>& rows)
{
  using F = Fetch<T>;
  using Along = typename F::Along;
  const auto value = [&](Along a00, Along a10, Along a01, Along a11) FFD_INLINE_LAMBDA {
    return F::Value(Across<T>(at, a00, a10, a01, a11), at);
  };
  const auto middle = [&](int dy, int dz) { return source.Middle(dy, dz, at); };
  const auto behind = [&](const typename F::Row& row) { return F::Behind(row, at); };
  const auto before = [&](const typename F::Row& row) { return F::Before(row, at); };
  NeighborValues of;
  of.Behind[0] = value(behind(rows.R00), behind(rows.R10), behind(rows.R01), behind(rows.R11));
  of.Before[0] = value(before(rows.R00), before(rows.R10), before(rows.R01), before(rows.R11));
  of.Behind[1] = value(rows.M10, middle(2, 0), rows.M11, middle(2, 1));
  of.Before[1] = value(middle(-1, 0), rows.M00, middle(-1, 1), rows.M01);
  of.Behind[2] = value(rows.M01, rows.M11, middle(0, 2), middle(1, 2));
  of.Before[2] = value(middle(0, -1), middle(1, -1), rows.M00, rows.M10);
  return of;
}

/// The positions around which FindDifferences() takes differences: in the volume, or of the nearest
/// voxels.
HWY_INLINE Vec3 FindMiddle(const PacketVolume& v, const Vec3& q)
{
  const auto within = [&](Vf x, int a) {
    const Vf last = Splat(static_cast<float>(v.Dimensions[a] - 1));
    const Vf inside = Clamp(x, hn::Zero(Df()), last);
    return v.Nearest ? hn::Min(hn::Floor(hn::Add(inside, Splat(0.5f))), last) : inside;
  };
  return { within(q.x, 0), within(q.y, 1), within(q.z, 2) };
}

/// The coordinate of a position.
HWY_INLINE Vf& CoordinateOf(Vec3& q, int a) { return a == 0 ? q.x : a == 1 ? q.y : q.z; }

/// Moves positions of FindMiddle() by `step` voxels along an axis, in the volume.
HWY_INLINE Vec3 MoveAlong(const PacketVolume& v, Vec3 middle, int a, float step)
{
  Vf& x = CoordinateOf(middle, a);
  x =
    Clamp(hn::Add(x, Splat(step)), hn::Zero(Df()), Splat(static_cast<float>(v.Dimensions[a] - 1)));
  return middle;
}

/// Rescales gradients from repeated voxels: their differences are over less than two voxels at the
/// faces of the volume.
HWY_INLINE Vec3 AtFaces(const PacketVolume& v, const Vec3& q, const Vec3& gradient)
{
  const auto scale = [&](Vf x, int a) {
    const Vf one = Splat(1.0f);
    const Vf after = hn::Min(hn::Add(x, one), Splat(static_cast<float>(v.Dimensions[a] - 1)));
    return hn::Div(Splat(2.0f), hn::Sub(after, hn::Max(hn::Sub(x, one), hn::Zero(Df()))));
  };
  return { hn::Mul(gradient.x, scale(q.x, 0)), hn::Mul(gradient.y, scale(q.y, 1)),
    hn::Mul(gradient.z, scale(q.z, 2)) };
}

/// The gradients, as Gradient() gives them, of what has these values around the samples q, of which
/// those of `border` lie at faces.
HWY_INLINE Vec3 GradientOfNeighbors(
  const PacketVolume& v, const Vec3& q, Mf border, const NeighborValues& of)
{
  const auto difference = [&](int a) { return hn::Sub(of.Behind[a], of.Before[a]); };
  const Vec3 gradient{ difference(0), difference(1), difference(2) };
  return HWY_LIKELY(hn::AllFalse(Df(), border))
    ? gradient
    : Select(border, AtFaces(v, FindMiddle(v, q), gradient), gradient);
}

/**
 * The 4 x 4 x 4 voxels around the cells of some lanes, those at the faces of the volume repeated
 * beyond it: with them a sample near a face is fetched as any other.
 */
template <class T>
class RepeatedVoxels
{
public:
  /// Copies to `voxels`, which is kept: those of 16 lanes, and 16 bytes that vectors may read
  /// beyond the last one.
  explicit RepeatedVoxels(void* voxels)
    : Voxels(voxels)
  {
  }

  /// `lanes`: positions that lie between voxels of the volume, at least one.
  HWY_NOINLINE void Fill(const PacketVolume& v, const Vec3& q, Mf lanes)
  {
    const Df d;
    const Di di;
    this->View = v;
    this->View.Scalars = this->Voxels;
    const int components = v.Components;
    this->View.IncrementY = Side * components;
    this->View.IncrementZ = Side * Side * components;
    this->View.SlicesInReach = 0;
    HWY_ALIGN int cells[3][16];
    const auto locate = [&](Vf x, int a) {
      const Vf cell = CellOf(v, x, a);
      hn::Store(hn::ConvertTo(di, cell), di, cells[a]);
      return hn::Sub(x, cell);
    };
    this->At.Fx = locate(q.x, 0);
    this->At.Fy = locate(q.y, 1);
    this->At.Fz = locate(q.z, 2);
    this->At.Weights = PairWeights(this->At.Fx);
    this->At.Integers = &v.Integers;
    HWY_ALIGN float flags[16];
    hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, flags);
    int block = 0;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      // Lanes that take no sample read the voxels of others.
      this->Offsets[lane] = components * (1 + Side + Side * Side);
      if (flags[lane] != 0.0f)
      {
        const int cell[3] = { cells[0][lane], cells[1][lane], cells[2][lane] };
        switch (components)
        {
          case 1:
            this->Copy<1>(v, cell, block);
            break;
          case 2:
            this->Copy<2>(v, cell, block);
            break;
          case 3:
            this->Copy<3>(v, cell, block);
            break;
          default:
            this->Copy<4>(v, cell, block);
            break;
        }
        this->Offsets[lane] += block;
        block += Side * Side * Side * components;
      }
    }
  }

  const PacketVolume& GetView() const { return this->View; }
  const SamplePosition& GetPosition() const { return this->At; }
  const int* GetOffsets() const { return this->Offsets; }

private:
  static constexpr int Side = 4;

  /// Copies the voxels from one before the cell to one behind it, to `block` elements.
  template <int Components>
  HWY_INLINE void Copy(const PacketVolume& v, const int cell[3], int block)
  {
    if constexpr (std::is_same<T, WideScalar>::value)
    {
      // Their bits do, whatever they stand for.
      v.ElementSize == 4
        ? Copy<Components>(v, cell, static_cast<std::uint32_t*>(this->Voxels) + block)
        : Copy<Components>(v, cell, static_cast<std::uint64_t*>(this->Voxels) + block);
    }
    else
    {
      Copy<Components>(v, cell, static_cast<T*>(this->Voxels) + block);
    }
  }
  template <int Components, class Word>
  static void Copy(const PacketVolume& v, const int cell[3], Word* to)
  {
    const auto place = [&](int a, int i) {
      return static_cast<std::ptrdiff_t>(std::clamp(cell[a] + i - 1, 0, v.Dimensions[a] - 1));
    };
    const std::ptrdiff_t x[Side] = { place(0, 0), place(0, 1), place(0, 2), place(0, 3) };
    const Word* rows[Side];
    for (int j = 0; j < Side; ++j)
    {
      rows[j] = static_cast<const Word*>(v.Scalars) + place(1, j) * v.IncrementY;
    }
    const bool whole = x[3] - x[0] == Side - 1;
    for (int k = 0; k < Side; ++k)
    {
      const std::ptrdiff_t slice = place(2, k) * v.IncrementZ;
      for (int j = 0; j < Side; ++j, to += Side * Components)
      {
        // As words, which is how they are read: loads wait for smaller stores.
        const Word* const row = rows[j] + slice;
        if (HWY_LIKELY(whole))
        {
          std::memcpy(to, row + x[0] * Components, Side * Components * sizeof(Word));
        }
        else
        {
          Word voxels[Side * Components];
          for (int i = 0; i < Side; ++i)
          {
            std::copy_n(row + x[i] * Components, Components, voxels + i * Components);
          }
          std::memcpy(to, voxels, sizeof(voxels));
        }
      }
    }
  }

  void* Voxels;
  PacketVolume View;
  SamplePosition At;
  HWY_ALIGN int Offsets[16] = {}; ///< elements
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
