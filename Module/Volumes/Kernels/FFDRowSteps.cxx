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
namespace RowSteps
{

constexpr std::uint8_t Farthest = 255;

/// The steps over rows of a scalar type.
template <class T>
struct StepsOf
{
  void (*Include)(const T*, std::size_t, T*, T*);
  void (*WidenByFour)(T*, T*, std::size_t);
};

struct StepsOfDistances
{
  std::uint8_t (*Lower)(
    const std::uint8_t*, const std::uint8_t*, std::uint8_t, std::uint8_t*, std::size_t);
  std::uint8_t (*Copy)(const std::uint8_t*, std::uint8_t*, std::size_t);
  void (*FindDistances)(std::uint8_t*, std::size_t, std::uint8_t*);
};

template <class... T>
struct StepsOfTypes
{
  std::tuple<StepsOf<T>...> Extremes;
  StepsOfDistances Distances;
};

/// Of all types that DispatchScalarType() tells apart.
using AllSteps = StepsOfTypes<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
  std::uint32_t, std::int64_t, std::uint64_t, float, double>;

} // namespace RowSteps
} // namespace ffd
#endif

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace RowSteps
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
  for (std::size_t away = 1; away < count && away < Farthest && largest == Farthest; away *= 2)
  {
    const std::uint8_t* HWY_RESTRICT before = now - away;
    const std::uint8_t* HWY_RESTRICT behind = now + away;
    const std::uint8_t farthest = static_cast<std::uint8_t>(Farthest - away);
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

template <class... T>
void Select(StepsOfTypes<T...>& steps)
{
  steps = { { StepsOf<T>{ &Include<T>, &WidenByFour<T> }... }, { &Lower, &Copy, &FindDistances } };
}

void SelectAll(AllSteps& steps) { Select(steps); }

} // namespace HWY_NAMESPACE
} // namespace RowSteps
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffd
{
namespace RowSteps
{
namespace
{

HWY_EXPORT(SelectAll);

const AllSteps& GetSteps()
{
  static const AllSteps steps = [] {
    AllSteps all;
    HWY_DYNAMIC_DISPATCH(SelectAll)(all);
    return all;
  }();
  return steps;
}

} // namespace

//------------------------------------------------------------------------------
template <class T>
void Include(const T* row, std::size_t count, T* min, T* max)
{
  std::get<StepsOf<T>>(GetSteps().Extremes).Include(row, count, min, max);
}

//------------------------------------------------------------------------------
template <class T>
void WidenByFour(T* min, T* max, std::size_t count)
{
  std::get<StepsOf<T>>(GetSteps().Extremes).WidenByFour(min, max, count);
}

//------------------------------------------------------------------------------
std::uint8_t Lower(const std::uint8_t* below, const std::uint8_t* above, std::uint8_t gap,
  std::uint8_t* out, std::size_t count)
{
  return GetSteps().Distances.Lower(below, above, gap, out, count);
}

//------------------------------------------------------------------------------
std::uint8_t Copy(const std::uint8_t* from, std::uint8_t* to, std::size_t count)
{
  return GetSteps().Distances.Copy(from, to, count);
}

//------------------------------------------------------------------------------
void FindDistances(std::uint8_t* row, std::size_t count, std::uint8_t* work)
{
  GetSteps().Distances.FindDistances(row, count, work);
}

#define FFD_INSTANTIATE(T)                                                                         \
  template void Include(const T*, std::size_t, T*, T*);                                            \
  template void WidenByFour(T*, T*, std::size_t)
FFD_INSTANTIATE(std::int8_t);
FFD_INSTANTIATE(std::uint8_t);
FFD_INSTANTIATE(std::int16_t);
FFD_INSTANTIATE(std::uint16_t);
FFD_INSTANTIATE(std::int32_t);
FFD_INSTANTIATE(std::uint32_t);
FFD_INSTANTIATE(std::int64_t);
FFD_INSTANTIATE(std::uint64_t);
FFD_INSTANTIATE(float);
FFD_INSTANTIATE(double);
#undef FFD_INSTANTIATE

} // namespace RowSteps
} // namespace ffd
#endif
