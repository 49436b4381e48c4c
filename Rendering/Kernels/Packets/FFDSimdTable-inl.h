// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Looks up transfer tables, a value a lane. Included once per target of Highway.
#if defined(FFD_SIMD_TABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_TABLE_INL_H_
#undef FFD_SIMD_TABLE_INL_H_
#else
#define FFD_SIMD_TABLE_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketTable.h"
#include "Optics/FFDTransferInterval.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Finds the entries, and their fractions, of values in a table whose first one stands for `low`; 0
/// for what is not a number.
HWY_INLINE Vf FindEntries(Vf values, Vf low, Vf scale, Vf intervals)
{
  const Vf x = hn::Mul(hn::Sub(values, low), scale);
  // Comparisons with what is not a number are false.
  return hn::IfThenElseZero(hn::Eq(x, x), Clamp(x, hn::Zero(Df()), intervals));
}

/// Loads intervals by their numbers.
HWY_INLINE Quads LoadIntervals(const TransferInterval* intervals, Vi numbers)
{
  return LoadQuads(reinterpret_cast<const std::uint32_t*>(intervals), numbers);
}

/// Interpolates the numbers of intervals.
HWY_INLINE Vf InterpolateEnds(const Quads& intervals, Vf part)
{
  const Df d;
  return Lerp(hn::BitCast(d, intervals.x), hn::BitCast(d, intervals.y), part);
}

/// Interpolates the colors of intervals; `weights` is PairWeights(part).
HWY_INLINE Vec3 InterpolateColors(const Quads& intervals, Vi weights)
{
  // `first`: in the lowest bits, `second`: in those of the upper half.
  const auto channel = [&](Vi first, Vi second) FFD_INLINE_LAMBDA {
    const Vi low = hn::Set(Di(), TransferInterval::LargestColor);
    const Vi high = hn::Set(Di(), TransferInterval::LargestColor << 16);
    const Vi pair = hn::Or(hn::And(first, low), hn::And(second, high));
    return hn::Mul(hn::ConvertTo(Df(), MultiplyPairs(pair, weights)),
      Splat(1.0f / (static_cast<float>(FixedOne) * TransferInterval::LargestColor)));
  };
  constexpr int Bits = TransferInterval::ColorBits;
  const Vi first = intervals.z;
  const Vi second = intervals.w;
  return { channel(first, hn::ShiftLeft<16>(second)),
    channel(hn::ShiftRight<Bits>(first), hn::ShiftLeft<16 - Bits>(second)),
    channel(hn::ShiftRight<2 * Bits>(first), hn::ShiftRight<2 * Bits - 16>(second)) };
}

/// Looks values up in a transfer table; Extinction() and Color() interpolate when they are called.
class TableLookup
{
public:
  TableLookup() = default;

  /// `values`: as they are fetched (PacketVolume); `table`: number of the table.
  HWY_INLINE TableLookup(const PacketScene& scene, Vf values, std::size_t table = 0)
  {
    const PacketTable::Range& range = scene.Table.GetRange(table);
    this->Find(scene.Table, values, Splat(range.Low), Splat(range.Scale), Splat(range.Intervals),
      hn::Set(Di(), range.First));
  }

  /// `tables`: number of the table of each lane.
  HWY_INLINE TableLookup(const PacketScene& scene, Vf values, Vi tables)
  {
    if (HWY_LIKELY(IsCommon(tables)))
    {
      *this = TableLookup(scene, values, static_cast<std::size_t>(hn::GetLane(tables)));
      return;
    }
    const Df d;
    const Quads range =
      LoadQuads(reinterpret_cast<const std::uint32_t*>(scene.Table.GetRanges()), tables);
    this->Find(scene.Table, values, hn::BitCast(d, range.z), hn::BitCast(d, range.w),
      hn::BitCast(d, range.y), range.x);
  }

  /// Per data unit; of what is no number that of the first entry.
  HWY_INLINE Vf Extinction() const
  {
    return hn::Max(hn::Zero(Df()), InterpolateEnds(this->Interval, this->Fraction));
  }

  HWY_INLINE Vec3 Color() const
  {
    return InterpolateColors(this->Interval, PairWeights(this->Fraction));
  }

private:
  HWY_INLINE void Find(
    const PacketTable& table, Vf values, Vf low, Vf scale, Vf intervals, Vi first)
  {
    const Vf entry = FindEntries(values, low, scale, intervals);
    const Vf whole = hn::Min(hn::Floor(entry), hn::Sub(intervals, Splat(1.0f)));
    this->Fraction = hn::Sub(entry, whole);
    this->Interval = LoadIntervals(table.GetIntervals(), hn::Add(first, Truncate(whole)));
  }

  Vf Fraction;
  Quads Interval;
};

/// Interpolates the two numbers that elements of an array begin with.
template <class Element>
HWY_INLINE Vf InterpolatePairs(const Element* elements, Vi numbers, Vf part)
{
  const Df d;
  HWY_ALIGN int offsets[16];
  StoreIndices(numbers, offsets);
  const Pairs ends = LoadPairLanes<sizeof(Element)>(elements, 0, offsets);
  return Lerp(hn::BitCast(d, ends.x), hn::BitCast(d, ends.y), part);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
