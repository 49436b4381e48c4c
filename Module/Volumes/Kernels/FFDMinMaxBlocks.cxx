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

/// Whether the difference of two scalars of a type is infinite.
template <class T>
bool IsTooWide(const MinMaxBlocks::Limits& range)
{
  return range.Max - range.Min > static_cast<double>(std::numeric_limits<T>::max());
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

  /// `rows` rows, the first one at `row`, which are `stride` apart, their scalars `increment`.
  void Add(const T* row, std::ptrdiff_t increment, std::ptrdiff_t stride, int rows)
  {
    const std::size_t count = this->Min.size();
    if (increment == 1)
    {
      this->Steps.Include(row, stride, rows, count, this->Min.data(), this->Max.data());
      return;
    }
    this->Gathered.resize(count);
    for (int r = 0; r < rows; ++r)
    {
      const T* scalar = row + r * stride;
      for (std::size_t i = 0; i < count; ++i, scalar += increment)
      {
        this->Gathered[i] = *scalar;
      }
      this->Steps.Include(this->Gathered.data(), 0, 1, count, this->Min.data(), this->Max.data());
    }
  }

  /// What another one has of rows.
  void Add(const RowExtremes& other)
  {
    this->Steps.Merge(
      other.Min.data(), other.Max.data(), this->Min.size(), this->Min.data(), this->Max.data());
  }

  /// The same of a row without numbers of which the magnitude is above `largest`.
  void AddUpTo(T largest, const T* row, std::ptrdiff_t increment)
  {
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(this->Min.size());
    T* const min = this->Min.data();
    T* const max = this->Max.data();
    for (std::ptrdiff_t i = 0; i < count; ++i)
    {
      const T value = row[i * increment];
      const bool counts = std::abs(value) <= largest;
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

  /// Those at `count` positions, `step` apart from `first` on, less the least number of the type.
  void GetCodes(int first, int step, int count, float* min, float* max) const
  {
    constexpr int least = static_cast<int>(std::numeric_limits<T>::lowest());
    const T* const low = this->Min.data() + first;
    const T* const high = this->Max.data() + first;
    for (int i = 0; i < count; ++i)
    {
      min[i] = static_cast<float>(static_cast<int>(low[i * step]) - least);
      max[i] = static_cast<float>(static_cast<int>(high[i * step]) - least);
    }
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

/// The range of the scalars of which the magnitude is at most `largest`.
template <class T>
MinMaxBlocks::Limits FindRangeUpTo(
  T largest, const VolumeView& volume, const ParallelFor& parallelFor)
{
  std::vector<std::pair<T, T>> slices(static_cast<std::size_t>(volume.Dimensions.z));
  parallelFor(slices.size(), [&](std::size_t firstSlice, std::size_t lastSlice) {
    RowExtremes<T> rows(volume.Dimensions.x);
    for (std::size_t k = firstSlice; k < lastSlice; ++k)
    {
      rows.Clear();
      for (int j = 0; j < volume.Dimensions.y; ++j)
      {
        const T* row = FindRow<T>(volume, j, static_cast<int>(k));
        if constexpr (std::is_floating_point_v<T>)
        {
          rows.AddUpTo(largest, row, volume.Increments[0]);
        }
        else
        {
          rows.Add(row, volume.Increments[0], 0, 1);
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

/// Finds the extremes of the rows of blocks, plane by plane: rows are read from end to end, and a
/// slice that two planes share is read once, if they follow each other.
template <class T>
class PlaneReader
{
public:
  /// Keeps references.
  PlaneReader(const VolumeView& volume, const std::vector<Window> (&windows)[3])
    : Volume(volume)
    , Windows(windows)
    , Shared(windows[1].size(), RowExtremes<T>(volume.Dimensions.x))
  {
  }

  /// Of plane `k`, which may lie beyond the last one; `rows`: at least as many as there are.
  void Find(std::size_t k, std::vector<RowExtremes<T>>& rows)
  {
    for (RowExtremes<T>& row : rows)
    {
      row.Clear();
    }
    if (k >= this->Windows[2].size())
    {
      return;
    }
    const Window& slices = this->Windows[2][k];
    int slice = slices.First;
    if (slice == this->SharedSlice)
    {
      std::swap_ranges(this->Shared.begin(), this->Shared.end(), rows.begin());
      ++slice;
    }
    // Several slices at once: the extremes stay in the first-level cache.
    this->AddSlices({ slice, slices.Last - 1 }, rows);
    if (slice <= slices.Last)
    {
      this->ShareSlice(slices.Last, rows);
    }
    if (!this->Volume.Axes)
    {
      for (RowExtremes<T>& row : rows)
      {
        row.Widen();
      }
    }
  }

private:
  void AddSlices(const Window& slices, std::vector<RowExtremes<T>>& rows) const
  {
    for (std::size_t j = 0; j < this->Windows[1].size(); ++j)
    {
      const Window& window = this->Windows[1][j];
      for (int slice = slices.First; slice <= slices.Last; ++slice)
      {
        rows[j].Add(FindRow<T>(this->Volume, window.First, slice), this->Volume.Increments[0],
          this->Volume.Increments[1], window.Last - window.First + 1);
      }
    }
  }

  /// Adds a slice that may be the first one of the next plane.
  void ShareSlice(int slice, std::vector<RowExtremes<T>>& rows)
  {
    for (RowExtremes<T>& row : this->Shared)
    {
      row.Clear();
    }
    this->AddSlices({ slice, slice }, this->Shared);
    this->SharedSlice = slice;
    for (std::size_t j = 0; j < this->Shared.size(); ++j)
    {
      rows[j].Add(this->Shared[j]);
    }
  }

  const VolumeView& Volume;
  const std::vector<Window> (&Windows)[3];
  std::vector<RowExtremes<T>> Shared; ///< of SharedSlice alone
  int SharedSlice = -1;
};

/// The windows along all axes. Those along x have what RowExtremes::Widen() has not taken in.
void FindAllWindows(
  const VolumeView& volume, const glm::ivec3& blocks, std::vector<Window> (&windows)[3])
{
  for (int a = 0; a < 3; ++a)
  {
    windows[a] = FindWindows(volume, a, blocks[a]);
  }
  for (Window& window : windows[0])
  {
    window.Last = volume.Axes ? window.Last : window.First;
  }
}

/// Finds the extremes of all blocks, x fastest; the minimum is above the maximum where there is no
/// number.
template <class T>
std::vector<std::pair<T, T>> FindBlockExtremes(
  const VolumeView& volume, const glm::ivec3& blocks, const ParallelFor& parallelFor)
{
  std::vector<Window> windows[3];
  FindAllWindows(volume, blocks, windows);
  std::vector<std::pair<T, T>> extremes(GridSize(blocks));
  parallelFor(static_cast<std::size_t>(blocks.z), [&](std::size_t first, std::size_t end) {
    std::vector<RowExtremes<T>> rows(
      static_cast<std::size_t>(blocks.y), RowExtremes<T>(volume.Dimensions.x));
    PlaneReader<T> reader(volume, windows);
    for (std::size_t k = first; k < end; ++k)
    {
      reader.Find(k, rows);
      for (int j = 0; j < blocks.y; ++j)
      {
        std::pair<T, T>* const to = &extremes[GridIndex(0, j, static_cast<int>(k), blocks)];
        for (int i = 0; i < blocks.x; ++i)
        {
          const Window& window = windows[0][static_cast<std::size_t>(i)];
          to[i] = rows[static_cast<std::size_t>(j)].Get(window.First, window.Last);
        }
      }
    }
  });
  return extremes;
}

/// The range of the finite scalars, from the extremes of the blocks if these say it.
template <class T>
MinMaxBlocks::Limits FindRange(const VolumeView& volume,
  const std::vector<std::pair<T, T>>& extremes, const ParallelFor& parallelFor)
{
  MinMaxBlocks::Limits range{ std::numeric_limits<double>::infinity(),
    -std::numeric_limits<double>::infinity() };
  for (const auto& [min, max] : extremes)
  {
    if (min <= max)
    {
      range.Min = std::min(range.Min, static_cast<double>(min));
      range.Max = std::max(range.Max, static_cast<double>(max));
    }
  }
  constexpr T largest = std::numeric_limits<T>::max();
  const bool infinite = range.Min <= range.Max && !std::isfinite(range.Max - range.Min);
  if (extremes.empty() || infinite)
  {
    range = FindRangeUpTo<T>(largest, volume, parallelFor);
  }
  return std::is_floating_point_v<T> && IsTooWide<T>(range)
    ? FindRangeUpTo<T>(largest / 4, volume, parallelFor)
    : range;
}

/// Leaves out the ends of a range that are farther from all other scalars than these from each
/// other. `extremes`: of blocks, each of which holds the end or not.
template <class T>
MinMaxBlocks::Limits FindCommonRange(
  const MinMaxBlocks::Limits& range, const std::vector<std::pair<T, T>>& extremes)
{
  MinMaxBlocks::Limits inner{ range.Max, range.Min };
  const auto include = [&](T end) {
    const double scalar = static_cast<double>(end);
    inner.Min = scalar > range.Min ? std::min(inner.Min, scalar) : inner.Min;
    inner.Max = scalar < range.Max ? std::max(inner.Max, scalar) : inner.Max;
  };
  for (const auto& [min, max] : extremes)
  {
    if (min <= max)
    {
      include(min);
      include(max);
    }
  }
  MinMaxBlocks::Limits common = range;
  const double width = inner.Max - inner.Min;
  if (width >= 0.0)
  {
    common.Min = inner.Min - range.Min > width ? inner.Min : range.Min;
    common.Max = range.Max - inner.Max > width ? inner.Max : range.Max;
  }
  return common;
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
    std::vector<std::pair<T, T>> extremes;
    if (exact)
    {
      this->FirstScalar = static_cast<double>(std::numeric_limits<T>::lowest());
      this->LastCode = sizeof(T) == 1 ? 255 : 65535;
    }
    else
    {
      if (this->NumberOfBlocks > 0)
      {
        extremes = FindBlockExtremes<T>(volume, this->Blocks, parallelFor);
      }
      this->Range = FindRange<T>(volume, extremes, parallelFor);
      this->CommonRange = FindCommonRange<T>(this->Range, extremes);
      this->SetCodes(std::is_integral_v<T>);
    }
    this->Codes.resize(this->NumberOfBlocks);
    this->LastCode == 255 ? this->ParentBytes.resize(2 * parents)
                          : this->ParentWords.resize(2 * parents);
    if (!exact)
    {
      this->EncodeExtremes<T>(extremes, parallelFor);
    }
    else if constexpr (HasCodes<T>)
    {
      this->EncodeVolume<T>(volume, parallelFor);
      this->Range = this->LastCode == 255 ? this->FindRangeOfParents(this->ParentBytes)
                                          : this->FindRangeOfParents(this->ParentWords);
      this->CommonRange = this->Range;
    }
  });
}

//------------------------------------------------------------------------------
void MinMaxBlocks::SetCodes(bool integral)
{
  const Limits& common = this->CommonRange;
  this->FirstScalar = this->Range.Min;
  this->LastCode = integral && this->Range.Max - this->Range.Min <= 255.0 ? 255 : 65535;
  if (this->LastCode == 255)
  {
    return;
  }
  // What lies beyond the common range has the first or the last code.
  const bool below = common.Min > this->Range.Min;
  const bool above = common.Max < this->Range.Max;
  const double width = common.Max - common.Min;
  if (width > 0.0)
  {
    this->CodeStep = width / (this->LastCode - (below ? 1 : 0) - (above ? 1 : 0));
  }
  else if (below || above)
  {
    const double gaps[2] = { common.Min - this->Range.Min, this->Range.Max - common.Max };
    this->CodeStep = below && above ? std::min(gaps[0], gaps[1]) : std::max(gaps[0], gaps[1]);
  }
  // Scalars that differ by rounding errors alone have one code: none is the first or the last one
  // because of these.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double largest = std::max(std::abs(common.Min), std::abs(common.Max));
  this->CodeStep = std::max(this->CodeStep, 16.0 * epsilon * largest);
  this->FirstScalar = common.Min - (below ? this->CodeStep : 0.0);
  this->Rounding = 8.0 * epsilon * std::max(std::abs(this->FirstScalar), std::abs(common.Max));
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
template <class Find>
void MinMaxBlocks::EncodeRow(int y, int z, Children& children, const Find& find)
{
  for (std::size_t c = 0; c < 8; ++c)
  {
    const int place = static_cast<int>(c);
    const glm::ivec3 first(place & 1, 2 * y + (place >> 1 & 1), 2 * z + (place >> 2));
    const bool exist = glm::all(glm::lessThan(first, this->Blocks));
    const int existing = exist ? (this->Blocks.x - first.x + 1) / 2 : 0;
    float* const min = children.Min[c].data();
    float* const max = children.Max[c].data();
    if (exist)
    {
      find(first, existing, min, max);
    }
    std::fill(min + existing, min + this->Parents.x, static_cast<float>(NoCodes.Min));
    std::fill(max + existing, max + this->Parents.x, static_cast<float>(NoCodes.Max));
  }
  this->EncodeParents(y, z, children);
}

//------------------------------------------------------------------------------
template <class T>
void MinMaxBlocks::EncodeExtremes(
  const std::vector<std::pair<T, T>>& extremes, const ParallelFor& parallelFor)
{
  const auto find = [&](const glm::ivec3& first, int count, float* min, float* max) {
    const std::pair<T, T>* const from = &extremes[GridIndex(first, this->Blocks)];
    for (int x = 0; x < count; ++x)
    {
      const CodeLimits codes = this->Encode(from[2 * x]);
      min[x] = static_cast<float>(codes.Min);
      max[x] = static_cast<float>(codes.Max);
    }
  };
  const int planes = extremes.empty() ? 0 : this->Parents.z;
  parallelFor(static_cast<std::size_t>(planes), [&](std::size_t firstPlane, std::size_t lastPlane) {
    Children children(static_cast<std::size_t>(this->Parents.x));
    for (std::size_t z = firstPlane; z < lastPlane; ++z)
    {
      for (int y = 0; y < this->Parents.y; ++y)
      {
        this->EncodeRow(y, static_cast<int>(z), children, find);
      }
    }
  });
}

//------------------------------------------------------------------------------
template <class T>
void MinMaxBlocks::EncodeVolume(const VolumeView& volume, const ParallelFor& parallelFor)
{
  std::vector<Window> windows[3];
  FindAllWindows(volume, this->Blocks, windows);
  // Of `count` blocks of a row, every second one from `first` on.
  const auto findCodes = [&](const RowExtremes<T>& row, int first, int count, float* min,
                           float* max) {
    if (!volume.Axes)
    {
      row.GetCodes(first * BlockSize, 2 * BlockSize, count, min, max);
      return;
    }
    for (int x = 0; x < count; ++x)
    {
      const Window& window = windows[0][static_cast<std::size_t>(first + 2 * x)];
      const CodeLimits codes = this->Encode(row.Get(window.First, window.Last));
      min[x] = static_cast<float>(codes.Min);
      max[x] = static_cast<float>(codes.Max);
    }
  };
  parallelFor(
    static_cast<std::size_t>(this->Parents.z), [&](std::size_t firstPlane, std::size_t lastPlane) {
      // Of the rows of blocks of a plane: slices are read from end to end. Two planes of blocks
      // make one of parents; what is beyond the last block holds no number.
      const std::vector<RowExtremes<T>> rows(
        2 * static_cast<std::size_t>(this->Parents.y), RowExtremes<T>(volume.Dimensions.x));
      std::vector<RowExtremes<T>> planes[2] = { rows, rows };
      PlaneReader<T> reader(volume, windows);
      Children children(static_cast<std::size_t>(this->Parents.x));
      for (std::size_t z = firstPlane; z < lastPlane; ++z)
      {
        for (std::size_t half = 0; half < 2; ++half)
        {
          reader.Find(2 * z + half, planes[half]);
        }
        for (int y = 0; y < this->Parents.y; ++y)
        {
          this->EncodeRow(y, static_cast<int>(z), children,
            [&](const glm::ivec3& first, int count, float* min, float* max) {
              const std::vector<RowExtremes<T>>& plane = planes[first.z & 1];
              findCodes(plane[static_cast<std::size_t>(first.y)], first.x, count, min, max);
            });
        }
      }
    });
}

//------------------------------------------------------------------------------
/// Encodes a row of parents, step by step for all of them. What holds no number has no part in the
/// limits of its parent.
void MinMaxBlocks::EncodeParents(int y, int z, Children& children)
{
  const BlockSteps steps = GetBlockSteps();
  const std::size_t count = static_cast<std::size_t>(this->Parents.x);
  float* const least = children.Least.data();
  float* const width = children.Width.data();
  const float* min[8];
  const float* max[8];
  for (std::size_t c = 0; c < 8; ++c)
  {
    min[c] = children.Min[c].data();
    max[c] = children.Max[c].data();
  }
  steps.FindParents(min, max, count, least, width);
  for (std::size_t x = 0; x < count; ++x)
  {
    const CodeLimits all{ static_cast<int>(least[x]), static_cast<int>(width[x]) };
    this->SetParentCodes(
      { static_cast<int>(x), y, z }, all.Min <= all.Max ? all : CodeLimits{ 1, 0 });
    width[x] = std::max(width[x] - least[x], static_cast<float>(LastMaximum));
  }
  for (int c = 0; c < 8; ++c)
  {
    const glm::ivec3 first(c & 1, 2 * y + (c >> 1 & 1), 2 * z + (c >> 2));
    if (glm::any(glm::greaterThanEqual(first, this->Blocks)))
    {
      continue;
    }
    steps.Encode(BlockEncoding, min[c], max[c], least, width, count, children.Codes.data());
    std::uint8_t* const to = &this->Codes[GridIndex(first, this->Blocks)];
    const std::size_t existing = static_cast<std::size_t>((this->Blocks.x - first.x + 1) / 2);
    for (std::size_t x = 0; x < existing; ++x)
    {
      to[2 * x] = children.Codes[x];
    }
  }
}

//------------------------------------------------------------------------------
MinMaxBlocks::BlockThresholds MinMaxBlocks::FindThresholds(
  const CodeLimits& parent, const std::vector<int>& least) const
{
  BlockThresholds thresholds;
  thresholds.fill(LastMaximum + 1);
  const int range = parent.Max - parent.Min;
  if (range < 0 || parent.Max < least[static_cast<std::size_t>(parent.Min)])
  {
    return thresholds;
  }
  const int width = std::max(LastMaximum, range);
  for (int low = 0; low <= LastMinimum; ++low)
  {
    // The maximum of `high` is the limit of the parent, or high / LastMaximum of the width rounded
    // up, whichever is less. Minima above the limit occur where there is no number alone.
    const int minimum = parent.Min + width * low / (LastMinimum + 1);
    const int more =
      minimum > parent.Max ? range + 1 : least[static_cast<std::size_t>(minimum)] - parent.Min;
    if (more <= range)
    {
      // Quotients as those of BlockSteps::Encode.
      const float high = static_cast<float>(LastMaximum * (more - 1)) / static_cast<float>(width);
      thresholds[static_cast<std::size_t>(low)] =
        static_cast<std::uint8_t>(more <= 0 ? 0 : static_cast<int>(high) + 1);
    }
  }
  return thresholds;
}

//------------------------------------------------------------------------------
void MinMaxBlocks::FindReaching(
  int y, int z, const std::vector<int>& least, std::uint8_t* distances) const
{
  const std::size_t count = static_cast<std::size_t>(this->Blocks.x);
  std::vector<std::uint8_t> thresholds[LastMinimum + 1];
  for (std::vector<std::uint8_t>& each : thresholds)
  {
    each.resize(count + 1);
  }
  for (int x = 0; x < this->Parents.x; ++x)
  {
    const BlockThresholds found = this->FindThresholds(this->GetParentCodes({ x, y, z }), least);
    for (std::size_t low = 0; low < found.size(); ++low)
    {
      std::fill_n(&thresholds[low][2 * static_cast<std::size_t>(x)], 2, found[low]);
    }
  }
  const BlockSteps steps = GetBlockSteps();
  const std::uint8_t* const of[LastMinimum + 1] = { thresholds[0].data(), thresholds[1].data() };
  for (int k = 2 * z; k < std::min(2 * z + 2, this->Blocks.z); ++k)
  {
    for (int j = 2 * y; j < std::min(2 * y + 2, this->Blocks.y); ++j)
    {
      const std::size_t first = GridIndex(0, j, k, this->Blocks);
      steps.FindReaching(BlockEncoding, &this->Codes[first], of, count, distances + first);
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
  const Limits limits{ this->FirstScalar + codes.Min * this->CodeStep,
    this->FirstScalar + codes.Max * this->CodeStep };
  if (this->Rounding == 0.0)
  {
    return limits;
  }
  // A block with the first code as its maximum has the smallest scalar alone, one with the last
  // code as its minimum the largest, if that is not common.
  const bool isLargest = codes.Min == this->LastCode && this->CommonRange.Max < this->Range.Max;
  const double min = codes.Min == 0 ? this->Range.Min
    : isLargest                     ? this->Range.Max
                                    : std::max(this->Range.Min, limits.Min - this->Rounding);
  const double max = codes.Max == 0 ? this->Range.Min
    : codes.Max == this->LastCode   ? this->Range.Max
                                    : std::min(this->Range.Max, limits.Max + this->Rounding);
  return { min, max };
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
