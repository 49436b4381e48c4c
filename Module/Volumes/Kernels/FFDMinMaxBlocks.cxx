// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDMinMaxBlocks.h"

#include "FFDAxisMap.h"
#include "FFDGridIndex.h"
#include "FFDScalarDispatch.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace ffd
{
namespace
{

/**
 * Bits of the minimum in the code of a block, the others are the maximum's: most opacity functions
 * rise, so what is empty depends on the maximum.
 */
constexpr int MinimumBits = 2;
constexpr int LastMinimum = (1 << MinimumBits) - 1;
constexpr int LastMaximum = (1 << (8 - MinimumBits)) - 1;

/// Code of a block that holds no number: no minimum is so far above the maximum.
constexpr int NoNumber = LastMinimum;

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
MinMaxBlocks::Limits FindRange(const VolumeView& volume, const ParallelFor& parallelFor)
{
  std::vector<Extremes<T>> slices(static_cast<std::size_t>(volume.Dimensions.z));
  parallelFor(slices.size(), [&volume, &slices](std::size_t firstSlice, std::size_t lastSlice) {
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
  this->NumberOfBlocks = GridSize(this->Blocks);
  this->Parents = (this->Blocks + 1) / 2;
  DispatchScalarType(volume.Type, [&](auto zero) {
    using T = decltype(zero);
    this->Range = FindRange<T>(volume, parallelFor);
    const double width = this->Range.Max - this->Range.Min;
    this->Codes.resize(this->NumberOfBlocks);
    const std::size_t parents = GridSize(this->Parents);
    if (std::is_integral_v<T> && width <= 255.0)
    {
      this->CodeStep = 1.0;
      this->LastCode = 255;
      this->ParentBytes.resize(2 * parents);
    }
    else
    {
      this->CodeStep = width > 0.0 ? width / 65535.0 : 1.0;
      this->LastCode = 65535;
      this->ParentWords.resize(2 * parents);
    }
    this->EncodeBlocks<T>(volume, parallelFor);
  });
}

//------------------------------------------------------------------------------
template <class T>
MinMaxBlocks::CodeLimits MinMaxBlocks::FindLimits(
  const VolumeView& volume, const glm::ivec3& block) const
{
  Extremes<T> found;
  glm::ivec3 first = block * BlockSize;
  glm::ivec3 last = glm::min((block + 1) * BlockSize, volume.Dimensions - 1);
  if (volume.Axes)
  {
    // The first and the last block of a row have what lies beyond them, too.
    const glm::dvec3 from = volume.Axes->ToVoxel(glm::dvec3(first));
    const glm::dvec3 to = volume.Axes->ToVoxel(glm::dvec3((block + 1) * BlockSize));
    for (int a = 0; a < 3; ++a)
    {
      const int end = volume.Dimensions[a] - 1;
      first[a] = block[a] == 0 ? 0 : std::clamp(static_cast<int>(std::floor(from[a])), 0, end);
      last[a] = block[a] == this->Blocks[a] - 1
        ? end
        : std::clamp(static_cast<int>(std::ceil(to[a])), 0, end);
    }
  }
  ScanVoxels<T>(volume, first, last, true, found);
  if (!found.Any)
  {
    return { 1, 0 };
  }
  // Ordered so that infinite scalars end at the first or last code.
  const auto clamp = [this](double code) {
    return static_cast<int>(std::max(0.0, std::min<double>(this->LastCode, code)));
  };
  return { clamp(std::floor((static_cast<double>(found.Min) - this->Range.Min) / this->CodeStep)),
    clamp(std::ceil((static_cast<double>(found.Max) - this->Range.Min) / this->CodeStep)) };
}

//------------------------------------------------------------------------------
template <class T>
void MinMaxBlocks::EncodeBlocks(const VolumeView& volume, const ParallelFor& parallelFor)
{
  parallelFor(
    static_cast<std::size_t>(this->Parents.z), [&](std::size_t firstPlane, std::size_t lastPlane) {
      for (std::size_t z = firstPlane; z < lastPlane; ++z)
      {
        for (int y = 0; y < this->Parents.y; ++y)
        {
          for (int x = 0; x < this->Parents.x; ++x)
          {
            const glm::ivec3 parent(x, y, static_cast<int>(z));
            CodeLimits children[8];
            for (int c = 0; c < 8; ++c)
            {
              const glm::ivec3 block = 2 * parent + glm::ivec3(c & 1, c >> 1 & 1, c >> 2);
              const bool exists = glm::all(glm::lessThan(block, this->Blocks));
              children[c] = exists ? this->FindLimits<T>(volume, block) : CodeLimits{ 1, 0 };
            }
            this->EncodeParent(parent, children);
          }
        }
      }
    });
}

//------------------------------------------------------------------------------
void MinMaxBlocks::EncodeParent(const glm::ivec3& parent, const CodeLimits children[8])
{
  CodeLimits all{ 1, 0 };
  for (int c = 0; c < 8; ++c)
  {
    if (children[c].Min <= children[c].Max)
    {
      const bool first = all.Min > all.Max;
      all.Min = first ? children[c].Min : std::min(all.Min, children[c].Min);
      all.Max = first ? children[c].Max : std::max(all.Max, children[c].Max);
    }
  }
  const std::size_t at = 2 * GridIndex(parent, this->Parents);
  if (!this->ParentBytes.empty())
  {
    this->ParentBytes[at] = static_cast<std::uint8_t>(all.Min);
    this->ParentBytes[at + 1] = static_cast<std::uint8_t>(all.Max);
  }
  else
  {
    this->ParentWords[at] = static_cast<std::uint16_t>(all.Min);
    this->ParentWords[at + 1] = static_cast<std::uint16_t>(all.Max);
  }
  const int width = std::max(LastMaximum, all.Max - all.Min);
  for (int c = 0; c < 8; ++c)
  {
    const glm::ivec3 block = 2 * parent + glm::ivec3(c & 1, c >> 1 & 1, c >> 2);
    if (glm::all(glm::lessThan(block, this->Blocks)))
    {
      int code = NoNumber;
      if (children[c].Min <= children[c].Max)
      {
        const int low = LastMinimum * (children[c].Min - all.Min) / width;
        const int high = (LastMaximum * (children[c].Max - all.Min) + width - 1) / width;
        code = low | high << MinimumBits;
      }
      this->Codes[GridIndex(block, this->Blocks)] = static_cast<std::uint8_t>(code);
    }
  }
}

//------------------------------------------------------------------------------
MinMaxBlocks::CodeLimits MinMaxBlocks::GetParentCodes(const glm::ivec3& parent) const
{
  const std::size_t at = 2 * GridIndex(parent, this->Parents);
  return this->ParentBytes.empty() ? CodeLimits{ this->ParentWords[at], this->ParentWords[at + 1] }
                                   : CodeLimits{ this->ParentBytes[at], this->ParentBytes[at + 1] };
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::Decode(const CodeLimits& codes) const
{
  return { this->Range.Min + codes.Min * this->CodeStep,
    this->Range.Min + codes.Max * this->CodeStep };
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::GetParentLimits(const glm::ivec3& parent) const
{
  return this->Decode(this->GetParentCodes(parent));
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::GetLimits(const glm::ivec3& block) const
{
  const CodeLimits parent = this->GetParentCodes(block / 2);
  const int code = this->Codes[GridIndex(block, this->Blocks)];
  const int low = code & LastMinimum;
  const int high = code >> MinimumBits;
  if (parent.Min > parent.Max || code == NoNumber)
  {
    return this->Decode({ 1, 0 });
  }
  const int width = std::max(LastMaximum, parent.Max - parent.Min);
  return this->Decode({ parent.Min + width * low / LastMinimum,
    std::min(parent.Max, parent.Min + (width * high + LastMaximum - 1) / LastMaximum) });
}

} // namespace ffd
