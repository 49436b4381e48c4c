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
#include <utility>

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

/// Whether a scalar has no place in the range of the volume: differences of the very largest
/// numbers are infinite, so these count as infinite, too.
template <class T>
bool IsOutOfRange(T value)
{
  return !(std::abs(value) <= std::numeric_limits<T>::max() / 4);
}

/**
 * Smallest and largest number at each position of a row, over the rows that were added. The loops
 * over the positions have no branches, so that compilers make vector code of them; comparisons with
 * what is not a number are false, which leaves it out.
 */
template <class T>
class RowExtremes
{
public:
  explicit RowExtremes(int count)
    : Min(static_cast<std::size_t>(count))
    , Max(static_cast<std::size_t>(count))
  {
    this->Clear();
  }

  void Clear()
  {
    using Limits = std::numeric_limits<T>;
    std::fill(this->Min.begin(), this->Min.end(),
      Limits::has_infinity ? Limits::infinity() : Limits::max());
    std::fill(this->Max.begin(), this->Max.end(),
      Limits::has_infinity ? -Limits::infinity() : Limits::lowest());
  }

  /// The row that begins at `row`, its scalars `increment` apart.
  void Add(const T* row, std::ptrdiff_t increment)
  {
    // Of constant increment where it can be.
    increment == 1 ? this->AddScalars(row, std::integral_constant<std::ptrdiff_t, 1>())
                   : this->AddScalars(row, increment);
  }

  /// The same without numbers that have no place in the range of the volume.
  void AddInRange(const T* row, std::ptrdiff_t increment)
  {
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(this->Min.size());
    T* const min = this->Min.data();
    T* const max = this->Max.data();
    for (std::ptrdiff_t i = 0; i < count; ++i)
    {
      const T value = row[i * increment];
      const bool counts = !IsOutOfRange(value);
      const T low = counts ? value : min[i];
      const T high = counts ? value : max[i];
      min[i] = low < min[i] ? low : min[i];
      max[i] = high > max[i] ? high : max[i];
    }
  }

  /// Over the positions from `first` to `last`; the minimum is above the maximum where there was no
  /// number.
  std::pair<T, T> Get(int first, int last) const
  {
    T min = this->Min[static_cast<std::size_t>(first)];
    T max = this->Max[static_cast<std::size_t>(first)];
    for (int i = first + 1; i <= last; ++i)
    {
      min = std::min(min, this->Min[static_cast<std::size_t>(i)]);
      max = std::max(max, this->Max[static_cast<std::size_t>(i)]);
    }
    return { min, max };
  }

private:
  template <class Increment>
  void AddScalars(const T* row, Increment increment)
  {
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(this->Min.size());
    T* const min = this->Min.data();
    T* const max = this->Max.data();
    for (std::ptrdiff_t i = 0; i < count; ++i)
    {
      const T value = row[i * increment];
      min[i] = value < min[i] ? value : min[i];
      max[i] = value > max[i] ? value : max[i];
    }
  }

  std::vector<T> Min;
  std::vector<T> Max;
};

template <class T>
const T* FindRow(const VolumeView& volume, int j, int k)
{
  return static_cast<const T*>(volume.Scalars) + j * volume.Increments[1] +
    k * volume.Increments[2];
}

template <class T>
MinMaxBlocks::Limits FindRange(const VolumeView& volume, const ParallelFor& parallelFor)
{
  std::vector<std::pair<T, T>> slices(static_cast<std::size_t>(volume.Dimensions.z));
  parallelFor(slices.size(), [&volume, &slices](std::size_t firstSlice, std::size_t lastSlice) {
    RowExtremes<T> rows(volume.Dimensions.x);
    for (std::size_t k = firstSlice; k < lastSlice; ++k)
    {
      rows.Clear();
      for (int j = 0; j < volume.Dimensions.y; ++j)
      {
        const T* row = FindRow<T>(volume, j, static_cast<int>(k));
        if constexpr (std::is_floating_point_v<T>)
        {
          rows.AddInRange(row, volume.Increments[0]);
        }
        else
        {
          rows.Add(row, volume.Increments[0]);
        }
      }
      slices[k] = rows.Get(0, volume.Dimensions.x - 1);
    }
  });
  MinMaxBlocks::Limits range{ std::numeric_limits<double>::infinity(),
    -std::numeric_limits<double>::infinity() };
  for (const auto& [min, max] : slices)
  {
    range.Min = std::min(range.Min, static_cast<double>(min));
    range.Max = std::max(range.Max, static_cast<double>(max));
  }
  return range;
}

/// The voxels from First to Last of an axis that samples in a block depend on.
struct Window
{
  int First;
  int Last;
};

/// Of all blocks of an axis.
std::vector<Window> FindWindows(const VolumeView& volume, int axis, int blocks)
{
  constexpr int size = MinMaxBlocks::BlockSize;
  const int end = volume.Dimensions[axis] - 1;
  std::vector<Window> windows;
  for (int block = 0; block < blocks; ++block)
  {
    Window window{ block * size, std::min((block + 1) * size, end) };
    if (volume.Axes)
    {
      // The first and the last block of a row have what lies beyond them, too.
      const double from = volume.Axes->ToVoxel(axis, block * size);
      const double to = volume.Axes->ToVoxel(axis, (block + 1) * size);
      window.First = block == 0 ? 0 : std::clamp(static_cast<int>(std::floor(from)), 0, end);
      window.Last = block == blocks - 1 ? end : std::clamp(static_cast<int>(std::ceil(to)), 0, end);
    }
    windows.push_back(window);
  }
  return windows;
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
MinMaxBlocks::CodeLimits MinMaxBlocks::Encode(double min, double max) const
{
  if (!(min <= max))
  {
    return { 1, 0 };
  }
  // Ordered so that infinite scalars end at the first or last code.
  const auto toCode = [this](double scalar) {
    const double code = (scalar - this->Range.Min) / this->CodeStep;
    return std::max(0.0, std::min<double>(this->LastCode, code));
  };
  const double last = toCode(max);
  const int whole = static_cast<int>(last);
  return { static_cast<int>(toCode(min)), whole < last ? whole + 1 : whole };
}

//------------------------------------------------------------------------------
template <class T>
void MinMaxBlocks::EncodeBlocks(const VolumeView& volume, const ParallelFor& parallelFor)
{
  std::vector<Window> windows[3];
  for (int a = 0; a < 3; ++a)
  {
    windows[a] = FindWindows(volume, a, this->Blocks[a]);
  }
  parallelFor(
    static_cast<std::size_t>(this->Parents.z), [&](std::size_t firstPlane, std::size_t lastPlane) {
      RowExtremes<T> rows(volume.Dimensions.x);
      // Four rows of blocks make one of parents; what is beyond the last block holds no number.
      std::vector<CodeLimits> limits[4];
      for (std::size_t z = firstPlane; z < lastPlane; ++z)
      {
        for (int y = 0; y < this->Parents.y; ++y)
        {
          for (int line = 0; line < 4; ++line)
          {
            limits[line].assign(2 * static_cast<std::size_t>(this->Parents.x), CodeLimits{ 1, 0 });
            const int j = 2 * y + (line & 1);
            const int k = 2 * static_cast<int>(z) + (line >> 1);
            if (j >= this->Blocks.y || k >= this->Blocks.z)
            {
              continue;
            }
            rows.Clear();
            for (int slice = windows[2][k].First; slice <= windows[2][k].Last; ++slice)
            {
              for (int row = windows[1][j].First; row <= windows[1][j].Last; ++row)
              {
                rows.Add(FindRow<T>(volume, row, slice), volume.Increments[0]);
              }
            }
            for (int i = 0; i < this->Blocks.x; ++i)
            {
              const auto [min, max] = rows.Get(windows[0][i].First, windows[0][i].Last);
              limits[line][i] = this->Encode(static_cast<double>(min), static_cast<double>(max));
            }
          }
          for (int x = 0; x < this->Parents.x; ++x)
          {
            CodeLimits children[8];
            for (int c = 0; c < 8; ++c)
            {
              children[c] = limits[c >> 1][2 * x + (c & 1)];
            }
            this->EncodeParent({ x, y, static_cast<int>(z) }, children);
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
  // Quotients of whole numbers below 2^24, all below 2^7: rounded to floats they stay on the same
  // side of every whole number.
  const float width = static_cast<float>(std::max(LastMaximum, all.Max - all.Min));
  for (int c = 0; c < 8; ++c)
  {
    const glm::ivec3 block = 2 * parent + glm::ivec3(c & 1, c >> 1 & 1, c >> 2);
    if (glm::all(glm::lessThan(block, this->Blocks)))
    {
      int code = NoNumber;
      if (children[c].Min <= children[c].Max)
      {
        const int low =
          static_cast<int>(static_cast<float>(LastMinimum * (children[c].Min - all.Min)) / width);
        const int high = static_cast<int>(
          (static_cast<float>(LastMaximum * (children[c].Max - all.Min)) + width - 1.0f) / width);
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
