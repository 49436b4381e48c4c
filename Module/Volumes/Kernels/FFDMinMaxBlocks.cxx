// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDMinMaxBlocks.h"

#include "FFDAxisMap.h"
#include "FFDGridIndex.h"
#include "FFDRowSteps.h"
#include "FFDScalarDispatch.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>
#include <utility>

namespace ffd
{
namespace
{

/// Whether every scalar of a type has a code of its own.
template <class T>
constexpr bool HasCodes = std::is_integral_v<T> && sizeof(T) <= 2;

/// Of children that hold no number, or do not exist.
constexpr MinMaxBlocks::CodeLimits NoCodes{ std::numeric_limits<std::uint16_t>::max() + 1, -1 };

/// Whether a scalar has no place in the range of the volume: differences of the very largest
/// numbers are infinite, so these count as infinite, too.
template <class T>
bool IsOutOfRange(T value)
{
  return !(std::abs(value) <= std::numeric_limits<T>::max() / 4);
}

/**
 * Smallest and largest number at each position of a row, over the rows that were added. What is not
 * a number is left out.
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
    const std::size_t count = this->Min.size();
    if (increment != 1)
    {
      this->Gathered.resize(count);
      for (std::size_t i = 0; i < count; ++i, row += increment)
      {
        this->Gathered[i] = *row;
      }
      row = this->Gathered.data();
    }
    this->Steps.Include(row, count, this->Min.data(), this->Max.data());
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

  /// Makes the extremes at each position those of the positions of a block that begins there.
  void Widen()
  {
    static_assert(MinMaxBlocks::BlockSize == 4, "the step is for blocks of four");
    this->Steps.WidenByFour(this->Min.data(), this->Max.data(), this->Min.size());
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
  std::vector<T> Min;
  std::vector<T> Max;
  std::vector<T> Gathered; // scalars of a row, one after the other
  ExtremesSteps<T> Steps = GetExtremesSteps<T>();
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

/// The extremes of the rows of blocks of plane `k`, which may lie beyond the last one.
template <class T>
void FindExtremes(const VolumeView& volume, const std::vector<Window> windows[3], std::size_t k,
  std::vector<RowExtremes<T>>& rows)
{
  for (RowExtremes<T>& row : rows)
  {
    row.Clear();
  }
  if (k >= windows[2].size())
  {
    return;
  }
  for (int slice = windows[2][k].First; slice <= windows[2][k].Last; ++slice)
  {
    for (std::size_t j = 0; j < windows[1].size(); ++j)
    {
      for (int row = windows[1][j].First; row <= windows[1][j].Last; ++row)
      {
        rows[j].Add(FindRow<T>(volume, row, slice), volume.Increments[0]);
      }
    }
  }
  if (!volume.Axes)
  {
    for (RowExtremes<T>& row : rows)
    {
      row.Widen();
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
MinMaxBlocks::MinMaxBlocks(const VolumeView& volume, const ParallelFor& parallelFor)
{
  this->Blocks = (volume.Dimensions - 1 + BlockSize - 1) / BlockSize;
  this->NumberOfBlocks = GridSize(this->Blocks);
  this->Parents = (this->Blocks + 1) / 2;
  const std::size_t parents = GridSize(this->Parents);
  DispatchScalarType(volume.Type, [&](auto zero) {
    using T = decltype(zero);
    const bool exact = HasCodes<T> && this->NumberOfBlocks > 0;
    if (exact)
    {
      this->FirstScalar = static_cast<double>(std::numeric_limits<T>::lowest());
      this->LastCode = sizeof(T) == 1 ? 255 : 65535;
    }
    else
    {
      this->Range = FindRange<T>(volume, parallelFor);
      this->FirstScalar = this->Range.Min;
      const double width = this->Range.Max - this->Range.Min;
      this->LastCode = std::is_integral_v<T> && width <= 255.0 ? 255 : 65535;
      this->CodeStep = this->LastCode == 65535 && width > 0.0 ? width / 65535.0 : 1.0;
    }
    this->Codes.resize(this->NumberOfBlocks);
    this->LastCode == 255 ? this->ParentBytes.resize(2 * parents)
                          : this->ParentWords.resize(2 * parents);
    this->EncodeBlocks<T>(volume, parallelFor);
    if (exact)
    {
      this->Range = this->LastCode == 255 ? this->FindRangeOfParents(this->ParentBytes)
                                          : this->FindRangeOfParents(this->ParentWords);
    }
  });
}

//------------------------------------------------------------------------------
template <class Code>
MinMaxBlocks::Limits MinMaxBlocks::FindRangeOfParents(const std::vector<Code>& parents) const
{
  Code min = parents[0];
  Code max = parents[1];
  for (std::size_t i = 0; i < parents.size(); i += 2)
  {
    min = std::min(min, parents[i]);
    max = std::max(max, parents[i + 1]);
  }
  return this->Decode({ min, max });
}

//------------------------------------------------------------------------------
template <class T>
MinMaxBlocks::CodeLimits MinMaxBlocks::Encode(const std::pair<T, T>& limits) const
{
  const auto [min, max] = limits;
  if (!(min <= max))
  {
    return NoCodes;
  }
  if constexpr (HasCodes<T>)
  {
    constexpr int first = std::numeric_limits<T>::lowest();
    return { min - first, max - first };
  }
  else
  {
    // Ordered so that infinite scalars end at the first or last code.
    const auto toCode = [this](T scalar) {
      const double code = (static_cast<double>(scalar) - this->FirstScalar) / this->CodeStep;
      return std::max(0.0, std::min<double>(this->LastCode, code));
    };
    const double last = toCode(max);
    const int whole = static_cast<int>(last);
    return { static_cast<int>(toCode(min)), whole < last ? whole + 1 : whole };
  }
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
  for (Window& window : windows[0])
  {
    // RowExtremes::Widen() has taken the others in.
    window.Last = volume.Axes ? window.Last : window.First;
  }
  parallelFor(
    static_cast<std::size_t>(this->Parents.z), [&](std::size_t firstPlane, std::size_t lastPlane) {
      // Of the rows of blocks of a plane: slices are read from end to end. Two planes of blocks
      // make one of parents; what is beyond the last block holds no number.
      const std::vector<RowExtremes<T>> rows(
        2 * static_cast<std::size_t>(this->Parents.y), RowExtremes<T>(volume.Dimensions.x));
      std::vector<RowExtremes<T>> planes[2] = { rows, rows };
      Children children(static_cast<std::size_t>(this->Parents.x));
      for (std::size_t z = firstPlane; z < lastPlane; ++z)
      {
        for (std::size_t half = 0; half < 2; ++half)
        {
          FindExtremes(volume, windows, 2 * z + half, planes[half]);
        }
        for (int y = 0; y < this->Parents.y; ++y)
        {
          for (int c = 0; c < 8; ++c)
          {
            const RowExtremes<T>& row = planes[c >> 2][2 * y + (c >> 1 & 1)];
            for (int x = 0; x < this->Parents.x; ++x)
            {
              const int i = 2 * x + (c & 1);
              const bool exists = i < this->Blocks.x;
              const CodeLimits codes =
                exists ? this->Encode(row.Get(windows[0][i].First, windows[0][i].Last)) : NoCodes;
              children.Min[c][x] = static_cast<float>(codes.Min);
              children.Max[c][x] = static_cast<float>(codes.Max);
            }
          }
          this->EncodeParents(y, static_cast<int>(z), children);
        }
      }
    });
}

//------------------------------------------------------------------------------
/// Encodes a row of parents, step by step for all of them, so that compilers make vector code of
/// it. What holds no number has no part in the limits of its parent.
void MinMaxBlocks::EncodeParents(int y, int z, Children& children)
{
  const std::size_t count = static_cast<std::size_t>(this->Parents.x);
  float* const least = children.Least.data();
  float* const width = children.Width.data();
  std::copy_n(children.Min[0].data(), count, least);
  std::copy_n(children.Max[0].data(), count, width);
  for (int c = 1; c < 8; ++c)
  {
    const float* const min = children.Min[c].data();
    const float* const max = children.Max[c].data();
    for (std::size_t x = 0; x < count; ++x)
    {
      least[x] = min[x] < least[x] ? min[x] : least[x];
      width[x] = max[x] > width[x] ? max[x] : width[x];
    }
  }
  for (std::size_t x = 0; x < count; ++x)
  {
    const CodeLimits all{ static_cast<int>(least[x]), static_cast<int>(width[x]) };
    this->SetParentCodes(
      { static_cast<int>(x), y, z }, all.Min <= all.Max ? all : CodeLimits{ 1, 0 });
  }
  constexpr float steps = static_cast<float>(LastMaximum);
  for (std::size_t x = 0; x < count; ++x)
  {
    width[x] = width[x] - least[x] > steps ? width[x] - least[x] : steps;
  }
  for (int c = 0; c < 8; ++c)
  {
    const glm::ivec3 first(c & 1, 2 * y + (c >> 1 & 1), 2 * z + (c >> 2));
    if (glm::any(glm::greaterThanEqual(first, this->Blocks)))
    {
      continue;
    }
    const float* const min = children.Min[c].data();
    const float* const max = children.Max[c].data();
    int* const codes = children.Codes.data();
    for (std::size_t x = 0; x < count; ++x)
    {
      // Quotients of whole numbers below 2^24, all below 2^7 where they count: rounded to floats
      // they stay on the same side of every whole number.
      const int low =
        static_cast<int>(static_cast<float>(LastMinimum) * (min[x] - least[x]) / width[x]);
      const int high = static_cast<int>((steps * (max[x] - least[x]) + width[x] - 1.0f) / width[x]);
      codes[x] = min[x] <= max[x] ? low | high << MinimumBits : NoNumber;
    }
    std::uint8_t* const to = &this->Codes[GridIndex(first, this->Blocks)];
    const std::size_t existing = static_cast<std::size_t>((this->Blocks.x - first.x + 1) / 2);
    for (std::size_t x = 0; x < existing; ++x)
    {
      to[2 * x] = static_cast<std::uint8_t>(codes[x]);
    }
  }
}

//------------------------------------------------------------------------------
void MinMaxBlocks::SetParentCodes(const glm::ivec3& parent, const CodeLimits& codes)
{
  const std::size_t at = 2 * GridIndex(parent, this->Parents);
  if (!this->ParentBytes.empty())
  {
    this->ParentBytes[at] = static_cast<std::uint8_t>(codes.Min);
    this->ParentBytes[at + 1] = static_cast<std::uint8_t>(codes.Max);
  }
  else
  {
    this->ParentWords[at] = static_cast<std::uint16_t>(codes.Min);
    this->ParentWords[at + 1] = static_cast<std::uint16_t>(codes.Max);
  }
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::Decode(const CodeLimits& codes) const
{
  return { this->FirstScalar + codes.Min * this->CodeStep,
    this->FirstScalar + codes.Max * this->CodeStep };
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::GetParentLimits(const glm::ivec3& parent) const
{
  return this->Decode(this->GetParentCodes(parent));
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits MinMaxBlocks::GetLimits(const glm::ivec3& block) const
{
  return this->Decode(this->GetCodes(block, this->GetParentCodes(block / 2)));
}

} // namespace ffd
