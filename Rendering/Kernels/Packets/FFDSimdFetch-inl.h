// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Loads the voxels of cells, a cell a lane. Included once per target of Highway.
#if defined(FFD_SIMD_FETCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_FETCH_INL_H_
#undef FFD_SIMD_FETCH_INL_H_
#else
#define FFD_SIMD_FETCH_INL_H_
#endif

#include "FFDPacketVolume.h"
#include "FFDScalarDispatch.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdWide-inl.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

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
    return Between(r.A, r.B, at.Fx, at);
  }
  static HWY_INLINE Vf Middle(const Row& r, const SamplePosition& at)
  {
    return Between(r.B, r.C, at.Fx, at);
  }
  static HWY_INLINE Vf Behind(const Row& r, const SamplePosition& at)
  {
    return Between(r.C, r.D, at.Fx, at);
  }
  static HWY_INLINE Vf Middle(
    const PacketVolume& v, const int* offsets, int delta, const SamplePosition& at)
  {
    Vf cell[2];
    Loader::LoadCell(v, offsets, delta, cell);
    return Between(cell[0], cell[1], at.Fx, at);
  }
};

struct WideLoader
{
  static HWY_INLINE Row4 LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    return WideVoxels::Load<Row4>(v, offsets, delta - 1);
  }
  static HWY_INLINE void LoadCell(
    const PacketVolume& v, const int* offsets, int delta, Vf (&cell)[2])
  {
    const Row2 pair = WideVoxels::Load<Row2>(v, offsets, delta);
    cell[0] = pair.A;
    cell[1] = pair.B;
  }
};
/// Doubles, and all other types that no other Fetch is for.
template <>
struct Fetch<double> : FetchFloats<WideLoader>
{
};

/// An integer of 32 bits, with or without a sign, that is read by PacketWords.
struct WordScalar
{
  std::uint32_t Bits;
};

/// Words of 32 bits, which are of type T and a component, as numbers.
template <class T>
HWY_INLINE Vf FromWords(const PacketVolume& v, Vi words, int component)
{
  if constexpr (std::is_same<T, float>::value)
  {
    return hn::BitCast(Df(), words);
  }
  else
  {
    const PacketWords& of = v.Words[component];
    return hn::MulAdd(hn::ConvertTo(Df(), hn::Sub(words, hn::Set(Di(), of.Origin))), Splat(of.Unit),
      Splat(of.Zero));
  }
}

template <class T>
struct WordLoader
{
  static HWY_INLINE Row4 LoadRow(const PacketVolume& v, const int* offsets, int delta)
  {
    const Quads words =
      LoadQuadLanes<4>(v.Scalars, 4 * static_cast<std::ptrdiff_t>(delta - 1), offsets);
    return { FromWords<T>(v, words.x, 0), FromWords<T>(v, words.y, 0), FromWords<T>(v, words.z, 0),
      FromWords<T>(v, words.w, 0) };
  }
  static HWY_INLINE void LoadCell(
    const PacketVolume& v, const int* offsets, int delta, Vf (&cell)[2])
  {
    const Pairs words =
      LoadPairLanes<4>(v.Scalars, 4 * static_cast<std::ptrdiff_t>(delta), offsets);
    cell[0] = FromWords<T>(v, words.x, 0);
    cell[1] = FromWords<T>(v, words.y, 0);
  }
};
template <>
struct Fetch<float> : FetchFloats<WordLoader<float>>
{
};
template <>
struct Fetch<WordScalar> : FetchFloats<WordLoader<WordScalar>>
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

/// Calls use(T()) with the type that Fetch has for the scalars of a volume. Whole numbers with a
/// sign are read as those without, see PacketIntegers.
template <class Use>
HWY_INLINE auto ForFetched(const PacketVolume& v, const Use& use)
{
  switch (FindFetchedScalars(v))
  {
    case FetchedScalars::Bytes:
      return use(std::uint8_t());
    case FetchedScalars::Shorts:
      return use(std::uint16_t());
    case FetchedScalars::Words:
      return use(WordScalar());
    case FetchedScalars::Floats:
      return use(float());
    default:
      return use(double());
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
