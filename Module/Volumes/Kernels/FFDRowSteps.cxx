// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSimdTargets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FFDRowSteps.cxx"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
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

// Loops without branches, of which compilers make vector code; comparisons with what is not a
// number are false.

template <class T>
void Include(const T* HWY_RESTRICT row, std::size_t count, T* HWY_RESTRICT min, T* HWY_RESTRICT max)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    const T value = row[i];
    min[i] = value < min[i] ? value : min[i];
    max[i] = value > max[i] ? value : max[i];
  }
}

template <class T>
void WidenByFour(T* HWY_RESTRICT min, T* HWY_RESTRICT max, std::size_t count)
{
  for (const std::size_t step : { 1, 2, 1 })
  {
    for (std::size_t i = 0; i + step < count; ++i)
    {
      min[i] = min[i + step] < min[i] ? min[i + step] : min[i];
      max[i] = max[i + step] > max[i] ? max[i + step] : max[i];
    }
  }
}

std::uint8_t Lower(const std::uint8_t* HWY_RESTRICT below, const std::uint8_t* HWY_RESTRICT above,
  std::uint8_t gap, std::uint8_t* HWY_RESTRICT out, std::size_t count)
{
  std::uint8_t largest = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    out[i] = std::min(out[i], std::max(gap, std::min(below[i], above[i])));
    largest = std::max(largest, out[i]);
  }
  return largest;
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

/// A row of DistanceMap::GetData(): whether blocks next to each one, in positive direction, may be
/// visible.
void AddNeighbors(std::uint8_t* HWY_RESTRICT row, const std::uint8_t* HWY_RESTRICT behindY,
  const std::uint8_t* HWY_RESTRICT behindZ, const std::uint8_t* HWY_RESTRICT behindYZ,
  std::size_t count)
{
  const auto code = [](std::uint8_t own, bool x, bool y, bool z, bool xy, bool xz, bool yz,
                      bool xyz) -> std::uint8_t {
    const int near = x | y << 1 | (x | y | xy) << 2 | z << 3 | (x | z | xz) << 4 |
      (y | z | yz) << 5 | (x | y | z | xy | xz | yz | xyz) << 6;
    return static_cast<std::uint8_t>(own == 1 && near != 0 ? 128 | near : own);
  };
  for (std::size_t i = 0; i + 1 < count; ++i)
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
  all = std::tuple<Steps...>(Steps{ &Include, &WidenByFour }...);
}

void SelectExtremesSteps(AllExtremesSteps& all) { SelectFrom(all); }

void SelectDistanceSteps(DistanceSteps& steps)
{
  steps = { &Lower, &Copy, &FindDistances, &AddNeighbors };
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
DistanceSteps GetDistanceSteps()
{
  DistanceSteps steps;
  HWY_DYNAMIC_DISPATCH(SelectDistanceSteps)(steps);
  return steps;
}

} // namespace ffd
#endif
