// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSimdTargets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FFDRowSteps.cxx"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "FFDRowSteps.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

#ifndef FFDRowSteps_cxx
#define FFDRowSteps_cxx
namespace ffd
{

/// Of all types that DispatchScalarType() tells apart.
using AllExtremesSteps = std::tuple<ExtremesSteps<std::int8_t>, ExtremesSteps<std::uint8_t>,
  ExtremesSteps<std::int16_t>, ExtremesSteps<std::uint16_t>, ExtremesSteps<std::int32_t>,
  ExtremesSteps<std::uint32_t>, ExtremesSteps<std::int64_t>, ExtremesSteps<std::uint64_t>,
  ExtremesSteps<float>, ExtremesSteps<double>>;

} // namespace ffd
#endif

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

namespace hn = hwy::HWY_NAMESPACE;

// Loops without branches, of which compilers make vector code; comparisons with what is not a
// number are false.

// The least and the largest of numbers; `b` where one is not a number, as x86 does it, too.
#if HWY_ARCH_X86
template <class V>
HWY_INLINE V Least(V a, V b)
{
  return hn::Min(a, b);
}
template <class V>
HWY_INLINE V Most(V a, V b)
{
  return hn::Max(a, b);
}
#else
template <class V>
HWY_INLINE V Least(V a, V b)
{
  return hn::IfThenElse(hn::Lt(a, b), a, b);
}
template <class V>
HWY_INLINE V Most(V a, V b)
{
  return hn::IfThenElse(hn::Gt(a, b), a, b);
}
#endif

template <class T>
void IncludeRow(
  const T* HWY_RESTRICT row, std::size_t count, T* HWY_RESTRICT min, T* HWY_RESTRICT max)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    const T value = row[i];
    min[i] = value < min[i] ? value : min[i];
    max[i] = value > max[i] ? value : max[i];
  }
}

/// Blocks have five rows of voxels: together they load and store the extremes once. Those of the
/// next blocks, of which the first one is the last one here, are read soon.
template <class T>
void IncludeFiveRows(const T* HWY_RESTRICT row, std::ptrdiff_t stride, std::size_t count,
  T* HWY_RESTRICT min, T* HWY_RESTRICT max)
{
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
  {
    auto low = hn::LoadU(d, min + i);
    auto high = hn::LoadU(d, max + i);
    for (int r = 0; r < 5; ++r)
    {
      const T* const from = row + r * stride + static_cast<std::ptrdiff_t>(i);
      hwy::Prefetch(from + 4 * stride);
      const auto value = hn::LoadU(d, from);
      low = Least(value, low);
      high = Most(value, high);
    }
    hn::StoreU(low, d, min + i);
    hn::StoreU(high, d, max + i);
  }
  for (int r = 0; r < 5; ++r)
  {
    IncludeRow(row + r * stride + static_cast<std::ptrdiff_t>(i), count - i, min + i, max + i);
  }
}

template <class T>
void Include(const T* row, std::ptrdiff_t stride, int rows, std::size_t count, T* min, T* max)
{
  for (; rows >= 5; rows -= 5, row += 5 * stride)
  {
    IncludeFiveRows(row, stride, count, min, max);
  }
  for (; rows > 0; --rows, row += stride)
  {
    IncludeRow(row, count, min, max);
  }
}

template <class T>
void Merge(const T* HWY_RESTRICT otherMin, const T* HWY_RESTRICT otherMax, std::size_t count,
  T* HWY_RESTRICT min, T* HWY_RESTRICT max)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    min[i] = otherMin[i] < min[i] ? otherMin[i] : min[i];
    max[i] = otherMax[i] > max[i] ? otherMax[i] : max[i];
  }
}

template <class T>
void WidenByFour(T* HWY_RESTRICT min, T* HWY_RESTRICT max, std::size_t count)
{
  // What is read is not written before: numbers behind a position are those of before.
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes + 4 <= count; i += lanes)
  {
    auto low = hn::LoadU(d, min + i);
    auto high = hn::LoadU(d, max + i);
    for (std::size_t step = 1; step <= 4; ++step)
    {
      low = hn::Min(low, hn::LoadU(d, min + i + step));
      high = hn::Max(high, hn::LoadU(d, max + i + step));
    }
    hn::StoreU(low, d, min + i);
    hn::StoreU(high, d, max + i);
  }
  for (; i < count; ++i)
  {
    for (std::size_t other = i + 1; other < std::min(i + 5, count); ++other)
    {
      min[i] = std::min(min[i], min[other]);
      max[i] = std::max(max[i], max[other]);
    }
  }
}

void FindParents(const float* const min[8], const float* const max[8], std::size_t count,
  float* HWY_RESTRICT least, float* HWY_RESTRICT most)
{
  std::copy_n(min[0], count, least);
  std::copy_n(max[0], count, most);
  for (int c = 1; c < 8; ++c)
  {
    Merge(min[c], max[c], count, least, most);
  }
}

void Encode(const BlockSteps::Encoding& encoding, const float* HWY_RESTRICT min,
  const float* HWY_RESTRICT max, const float* HWY_RESTRICT least, const float* HWY_RESTRICT width,
  std::size_t count, std::uint8_t* HWY_RESTRICT codes)
{
  // Quotients of whole numbers below 2^24, all below 2^8 where they count: rounded to floats they
  // stay on the same side of every whole number.
  const float last = static_cast<float>(encoding.LastMinimum);
  const float highs = static_cast<float>(encoding.LastMaximum);
  const int shift = encoding.MinimumBits;
  const int none = encoding.NoNumber;
  for (std::size_t x = 0; x < count; ++x)
  {
    const int low =
      static_cast<int>(std::min(last, (last + 1.0f) * (min[x] - least[x]) / width[x]));
    const int high = static_cast<int>((highs * (max[x] - least[x]) + width[x] - 1.0f) / width[x]);
    codes[x] = static_cast<std::uint8_t>(min[x] <= max[x] ? low | high << shift : none);
  }
}

void FindReaching(const BlockSteps::Encoding& encoding, const std::uint8_t* HWY_RESTRICT codes,
  const std::uint8_t* const thresholds[2], std::size_t count, std::uint8_t* HWY_RESTRICT distances)
{
  const std::uint8_t* HWY_RESTRICT first = thresholds[0];
  const std::uint8_t* HWY_RESTRICT second = thresholds[1];
  const int none = encoding.NoNumber;
  const int shift = encoding.MinimumBits;
  const int minimum = encoding.LastMinimum;
  for (std::size_t i = 0; i < count; ++i)
  {
    const int code = codes[i];
    const int threshold = (code & minimum) != 0 ? second[i] : first[i];
    const bool reaches = (code != none) & (code >> shift >= threshold);
    distances[i] = reaches ? std::uint8_t(0) : LargestBlockDistance;
  }
}

void TransformLines(
  std::uint8_t* lines, std::size_t count, std::size_t stride, std::size_t width, std::uint8_t* work)
{
  const hn::CappedTag<std::uint8_t, DistanceSteps::LinesAtOnce> d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t first = 0; first < width; first += lanes)
  {
    const std::size_t here = std::min(lanes, width - first);
    for (std::size_t i = 0; i < count; ++i)
    {
      std::copy_n(lines + i * stride + first, here, work + i * lanes);
      std::fill_n(work + i * lanes + here, lanes - here, std::uint8_t(0));
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      auto out = hn::LoadU(d, work + i * lanes);
      // Only neighbors closer than the distances found so far can lower them.
      for (std::size_t gap = 1; gap < LargestBlockDistance && (gap <= i || i + gap < count); ++gap)
      {
        const auto away = hn::Set(d, static_cast<std::uint8_t>(gap));
        // Numbers up to `gap` are not lowered any more.
        if (hn::AllTrue(d, hn::Eq(hn::Min(out, away), out)))
        {
          break;
        }
        // Beyond either end there is nothing: the other neighbor stands for both.
        const std::size_t below = gap <= i ? i - gap : i + gap;
        const std::size_t above = i + gap < count ? i + gap : i - gap;
        const auto near =
          hn::Min(hn::LoadU(d, work + below * lanes), hn::LoadU(d, work + above * lanes));
        out = hn::Min(out, hn::Max(away, near));
      }
      if (here == lanes)
      {
        hn::StoreU(out, d, lines + i * stride + first);
      }
      else
      {
        std::uint8_t numbers[DistanceSteps::LinesAtOnce];
        hn::StoreU(out, d, numbers);
        std::copy_n(numbers, here, lines + i * stride + first);
      }
    }
  }
}

std::uint8_t Copy(
  const std::uint8_t* HWY_RESTRICT from, std::uint8_t* HWY_RESTRICT to, std::size_t count)
{
  std::uint8_t largest = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    to[i] = from[i];
    largest = std::max(largest, from[i]);
  }
  return largest;
}

/// Distances up to r become distances up to 2 r + 1 by looking at both neighbors r + 1 away.
void FindDistances(std::uint8_t* row, std::size_t count, std::uint8_t* work)
{
  // In the middle of rows of nothing, so that all numbers have neighbors.
  std::uint8_t* HWY_RESTRICT now = work + count;
  std::uint8_t* HWY_RESTRICT next = work + 4 * count;
  std::uint8_t largest = Copy(row, now, count);
  for (std::size_t away = 1;
       away < count && away < LargestBlockDistance && largest == LargestBlockDistance; away *= 2)
  {
    const std::uint8_t* HWY_RESTRICT before = now - away;
    const std::uint8_t* HWY_RESTRICT behind = now + away;
    const std::uint8_t farthest = static_cast<std::uint8_t>(LargestBlockDistance - away);
    largest = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      const std::uint8_t near = std::min(std::min(before[i], behind[i]), farthest);
      next[i] = std::min<std::uint8_t>(now[i], static_cast<std::uint8_t>(near + away));
      largest = std::max(largest, next[i]);
    }
    std::swap(now, next);
  }
  std::copy_n(now, count, row);
}

/// Lowers the distances of a row by those of a row next to it.
void PassOn(const std::uint8_t* HWY_RESTRICT from, std::uint8_t* HWY_RESTRICT to, std::size_t count)
{
  const auto lower = [from, to, count](std::size_t i) {
    const std::uint8_t left = from[i > 0 ? i - 1 : i];
    const std::uint8_t right = from[i + 1 < count ? i + 1 : i];
    const std::uint8_t near = std::min(std::min(left, from[i]), right);
    to[i] = std::min<std::uint8_t>(to[i], static_cast<std::uint8_t>(near + 1));
  };
  std::size_t i = 0;
  const auto lowerBy = [from, to, count, &i](auto d) {
    const std::size_t lanes = hn::Lanes(d);
    for (; i + lanes < count; i += lanes)
    {
      const auto near = hn::Min(
        hn::Min(hn::LoadU(d, from + i - 1), hn::LoadU(d, from + i)), hn::LoadU(d, from + i + 1));
      hn::StoreU(
        hn::Min(hn::LoadU(d, to + i), hn::Add(near, hn::Set(d, std::uint8_t(1)))), d, to + i);
    }
  };
  lower(i++);
  lowerBy(hn::ScalableTag<std::uint8_t>());
  lowerBy(hn::CappedTag<std::uint8_t, 8>());
  for (; i < count; ++i)
  {
    lower(i);
  }
}

void TransformPlane(std::uint8_t* plane, std::size_t width, std::size_t rows)
{
  for (std::size_t j = 1; j < rows; ++j)
  {
    PassOn(plane + (j - 1) * width, plane + j * width, width);
  }
  for (std::size_t j = rows; j-- > 1;)
  {
    PassOn(plane + j * width, plane + (j - 1) * width, width);
  }
}

/// A row of DistanceMap::GetData(): whether blocks next to each one, in positive direction, may be
/// visible.
void AddNeighbors(std::uint8_t* HWY_RESTRICT row, const std::uint8_t* HWY_RESTRICT behindY,
  const std::uint8_t* HWY_RESTRICT behindZ, const std::uint8_t* HWY_RESTRICT behindYZ,
  std::size_t count)
{
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto one = hn::Set(d, std::uint8_t(1));
  const auto isZero = [&d, zero](const std::uint8_t* from) {
    return hn::VecFromMask(d, hn::Eq(hn::LoadU(d, from), zero));
  };
  const auto bit = [&d](auto all, int n) {
    return hn::And(all, hn::Set(d, static_cast<std::uint8_t>(1 << n)));
  };
  std::size_t i = 0;
  for (; i + lanes < count; i += lanes)
  {
    const auto own = hn::LoadU(d, row + i);
    const auto changes = hn::Eq(own, one);
    if (hn::AllFalse(d, changes))
    {
      continue;
    }
    const auto x = isZero(row + i + 1);
    const auto y = isZero(behindY + i);
    const auto z = isZero(behindZ + i);
    const auto xy = hn::Or(hn::Or(x, y), isZero(behindY + i + 1));
    const auto xz = hn::Or(hn::Or(x, z), isZero(behindZ + i + 1));
    const auto yz = hn::Or(hn::Or(y, z), isZero(behindYZ + i));
    const auto xyz = hn::Or(hn::Or(xy, xz), hn::Or(yz, isZero(behindYZ + i + 1)));
    auto near = hn::Or(hn::Or(bit(x, 0), bit(y, 1)), hn::Or(bit(xy, 2), bit(z, 3)));
    near = hn::Or(near, hn::Or(hn::Or(bit(xz, 4), bit(yz, 5)), hn::Or(bit(xyz, 6), bit(xyz, 7))));
    hn::StoreU(hn::IfThenElse(hn::And(changes, hn::Ne(near, zero)), near, own), d, row + i);
  }
  const auto code = [](std::uint8_t own, bool x, bool y, bool z, bool xy, bool xz, bool yz,
                      bool xyz) -> std::uint8_t {
    const int near = x | y << 1 | (x | y | xy) << 2 | z << 3 | (x | z | xz) << 4 |
      (y | z | yz) << 5 | (x | y | z | xy | xz | yz | xyz) << 6;
    return static_cast<std::uint8_t>(
      own == 1 && near != 0 ? (LargestBlockDistance + 1) | near : own);
  };
  for (; i + 1 < count; ++i)
  {
    row[i] = code(row[i], row[i + 1] == 0, behindY[i] == 0, behindZ[i] == 0, behindY[i + 1] == 0,
      behindZ[i + 1] == 0, behindYZ[i] == 0, behindYZ[i + 1] == 0);
  }
  const std::size_t last = count - 1;
  row[last] = code(row[last], false, behindY[last] == 0, behindZ[last] == 0, false, false,
    behindYZ[last] == 0, false);
}

template <class... Steps>
void SelectFrom(std::tuple<Steps...>& all)
{
  all = std::tuple<Steps...>(Steps{ &Include, &Merge, &WidenByFour }...);
}

void SelectExtremesSteps(AllExtremesSteps& all) { SelectFrom(all); }

void SelectBlockSteps(BlockSteps& steps) { steps = { &FindParents, &Encode, &FindReaching }; }

void SelectDistanceSteps(DistanceSteps& steps)
{
  steps = { &TransformLines, &FindDistances, &TransformPlane, &AddNeighbors };
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffd
{
namespace
{

HWY_EXPORT(SelectExtremesSteps);
HWY_EXPORT(SelectBlockSteps);
HWY_EXPORT(SelectDistanceSteps);

} // namespace

//------------------------------------------------------------------------------
template <class T>
ExtremesSteps<T> GetExtremesSteps()
{
  AllExtremesSteps all;
  HWY_DYNAMIC_DISPATCH(SelectExtremesSteps)(all);
  return std::get<ExtremesSteps<T>>(all);
}
template ExtremesSteps<std::int8_t> GetExtremesSteps();
template ExtremesSteps<std::uint8_t> GetExtremesSteps();
template ExtremesSteps<std::int16_t> GetExtremesSteps();
template ExtremesSteps<std::uint16_t> GetExtremesSteps();
template ExtremesSteps<std::int32_t> GetExtremesSteps();
template ExtremesSteps<std::uint32_t> GetExtremesSteps();
template ExtremesSteps<std::int64_t> GetExtremesSteps();
template ExtremesSteps<std::uint64_t> GetExtremesSteps();
template ExtremesSteps<float> GetExtremesSteps();
template ExtremesSteps<double> GetExtremesSteps();

//------------------------------------------------------------------------------
BlockSteps GetBlockSteps()
{
  BlockSteps steps;
  HWY_DYNAMIC_DISPATCH(SelectBlockSteps)(steps);
  return steps;
}

//------------------------------------------------------------------------------
DistanceSteps GetDistanceSteps()
{
  DistanceSteps steps;
  HWY_DYNAMIC_DISPATCH(SelectDistanceSteps)(steps);
  return steps;
}

} // namespace ffd
#endif
