// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDMinMaxBlocks.h"

#include "FFDScalarDispatch.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace ffd
{
namespace
{

/// Smallest and largest number of a row-wise box of voxels, both ends included.
template <class T>
struct Extremes
{
  T Min = std::numeric_limits<T>::max();
  T Max = std::numeric_limits<T>::lowest();
  bool Any = false;
};

/// Whether a scalar has no place in the range of the volume: differences of the very largest
/// numbers are infinite, so these count as infinite, too.
template <class T>
bool IsOutOfRange(T value)
{
  return !(std::abs(value) <= std::numeric_limits<T>::max() / 4);
}

template <class T>
void ScanVoxels(const VolumeView& v, const glm::ivec3& first, const glm::ivec3& last,
  bool countInfinite, Extremes<T>& found)
{
  const T* scalars = static_cast<const T*>(v.Scalars);
  for (int k = first.z; k <= last.z; ++k)
  {
    for (int j = first.y; j <= last.y; ++j)
    {
      const T* p = scalars + first.x * v.Increments[0] + j * v.Increments[1] + k * v.Increments[2];
      for (int i = first.x; i <= last.x; ++i, p += v.Increments[0])
      {
        if constexpr (std::is_floating_point_v<T>)
        {
          if (std::isnan(*p) || (!countInfinite && IsOutOfRange(*p)))
          {
            continue;
          }
        }
        found.Any = true;
        found.Min = std::min(found.Min, *p);
        found.Max = std::max(found.Max, *p);
      }
    }
  }
}

template <class T>
MinMaxBlocks::Limits FindRange(
  const VolumeView& volume, const MinMaxBlocks::ParallelFor& parallelFor)
{
  std::vector<Extremes<T>> slices(static_cast<std::size_t>(volume.Dimensions.z));
  parallelFor(slices.size(),
    [&volume, &slices](std::size_t firstSlice, std::size_t lastSlice)
    {
      for (std::size_t k = firstSlice; k < lastSlice; ++k)
      {
        const glm::ivec3 first(0, 0, static_cast<int>(k));
        const glm::ivec3 last(volume.Dimensions.x - 1, volume.Dimensions.y - 1, first.z);
        ScanVoxels<T>(volume, first, last, false, slices[k]);
      }
    });
  MinMaxBlocks::Limits range{ std::numeric_limits<double>::infinity(),
    -std::numeric_limits<double>::infinity() };
  for (const Extremes<T>& slice : slices)
  {
    if (slice.Any)
    {
      range.Min = std::min(range.Min, static_cast<double>(slice.Min));
      range.Max = std::max(range.Max, static_cast<double>(slice.Max));
    }
  }
  return range;
}

} // namespace

//------------------------------------------------------------------------------
MinMaxBlocks::MinMaxBlocks(const VolumeView& volume, const ParallelFor& parallelFor)
{
  this->Blocks = (volume.Dimensions - 1 + BlockSize - 1) / BlockSize;
  this->NumberOfBlocks = static_cast<std::size_t>(this->Blocks.x) *
    static_cast<std::size_t>(this->Blocks.y) * static_cast<std::size_t>(this->Blocks.z);
  DispatchScalarType(volume.Type,
    [&](auto zero)
    {
      using T = decltype(zero);
      this->Range = FindRange<T>(volume, parallelFor);
      const double width = this->Range.Max - this->Range.Min;
      if (std::is_integral_v<T> && width <= 255.0)
      {
        this->CodeStep = 1.0;
        this->EncodeBlocks<T>(volume, this->ByteCodes, parallelFor);
      }
      else
      {
        this->CodeStep = width > 0.0 ? width / 65535.0 : 1.0;
        this->EncodeBlocks<T>(volume, this->WordCodes, parallelFor);
      }
    });
}

//------------------------------------------------------------------------------
template <class T, class Code>
void MinMaxBlocks::EncodeBlocks(
  const VolumeView& volume, std::vector<Code>& codes, const ParallelFor& parallelFor)
{
  codes.resize(2 * this->NumberOfBlocks);
  const double lastCode = std::numeric_limits<Code>::max();
  // Ordered so that infinite scalars end at the first or last code.
  const auto encode = [this, lastCode](double value, double (*round)(double))
  {
    const double code = round((value - this->Range.Min) / this->CodeStep);
    return static_cast<Code>(std::max(0.0, std::min(lastCode, code)));
  };
  const auto floor = [](double x) { return std::floor(x); };
  const auto ceil = [](double x) { return std::ceil(x); };
  const glm::ivec3 lastVoxel = volume.Dimensions - 1;
  parallelFor(static_cast<std::size_t>(this->Blocks.z),
    [&](std::size_t firstPlane, std::size_t lastPlane)
    {
      for (std::size_t bz = firstPlane; bz < lastPlane; ++bz)
      {
        for (int by = 0; by < this->Blocks.y; ++by)
        {
          for (int bx = 0; bx < this->Blocks.x; ++bx)
          {
            const glm::ivec3 first = glm::ivec3(bx, by, static_cast<int>(bz)) * BlockSize;
            const glm::ivec3 last = glm::min(first + BlockSize, lastVoxel);
            Extremes<T> found;
            ScanVoxels<T>(volume, first, last, true, found);
            const std::size_t block = bx +
              static_cast<std::size_t>(this->Blocks.x) *
                (by + static_cast<std::size_t>(this->Blocks.y) * bz);
            codes[2 * block] = found.Any ? encode(static_cast<double>(found.Min), floor) : 1;
            codes[2 * block + 1] = found.Any ? encode(static_cast<double>(found.Max), ceil) : 0;
          }
        }
      }
    });
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::GetLimits(std::size_t index) const
{
  const bool bytes = !this->ByteCodes.empty();
  const double min = bytes ? this->ByteCodes[2 * index] : this->WordCodes[2 * index];
  const double max = bytes ? this->ByteCodes[2 * index + 1] : this->WordCodes[2 * index + 1];
  return { this->Range.Min + min * this->CodeStep, this->Range.Min + max * this->CodeStep };
}

} // namespace ffd
