// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDVoxelDistance.h"

#include "FFDScalarDispatch.h"

#include <algorithm>
#include <vector>

namespace ffd
{
namespace
{

/// Slices between two reports.
constexpr int SlicesPerReport = 16;

/// `nearest` = min(nearest, row and its neighbors along x).
void IncludeRow(const std::uint16_t* row, int count, std::uint16_t* nearest)
{
  for (int i = 0; i < count; ++i)
  {
    nearest[i] = std::min(nearest[i], row[i]);
  }
  for (int i = 1; i < count; ++i)
  {
    nearest[i] = std::min(nearest[i], row[i - 1]);
    nearest[i - 1] = std::min(nearest[i - 1], row[i]);
  }
}

std::uint16_t IncrementDistance(std::uint16_t distance)
{
  return static_cast<std::uint16_t>(distance + (distance < NothingVisible ? 1 : 0));
}

/// One row from the rows that its sweep has passed already, then along itself.
void SweepRow(std::uint16_t* row, int count, bool backward, const std::uint16_t* nearest)
{
  for (int i = 0; i < count; ++i)
  {
    row[i] = std::min(row[i], IncrementDistance(nearest[i]));
  }
  if (backward)
  {
    for (int i = count - 2; i >= 0; --i)
    {
      row[i] = std::min(row[i], IncrementDistance(row[i + 1]));
    }
  }
  else
  {
    for (int i = 1; i < count; ++i)
    {
      row[i] = std::min(row[i], IncrementDistance(row[i - 1]));
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
void MarkVisibleVoxels(
  const VolumeView& volume, const TransferTable& table, int first, int last, std::uint16_t* marks)
{
  DispatchScalarType(volume.Type, [&](auto zero) {
    using T = decltype(zero);
    const T* const voxels = static_cast<const T*>(volume.Scalars);
    std::size_t at = static_cast<std::size_t>(first) *
      static_cast<std::size_t>(volume.Dimensions.x) * static_cast<std::size_t>(volume.Dimensions.y);
    for (int k = first; k < last; ++k)
    {
      for (int j = 0; j < volume.Dimensions.y; ++j)
      {
        const T* row = voxels + j * volume.Increments[1] + k * volume.Increments[2];
        for (int i = 0; i < volume.Dimensions.x; ++i, ++at)
        {
          const double value = static_cast<double>(row[i * volume.Increments[0]]);
          marks[at] = table.Lookup(value).Extinction > 0.0f ? 0 : NothingVisible;
        }
      }
    }
  });
}

//------------------------------------------------------------------------------
bool FindChebyshevDistances(const glm::ivec3& dimensions, std::uint16_t* distances,
  const std::function<bool(double)>& progress)
{
  const std::size_t rowLength = static_cast<std::size_t>(dimensions.x);
  const std::size_t sliceLength = rowLength * static_cast<std::size_t>(dimensions.y);
  std::vector<std::uint16_t> nearest(rowLength);
  for (const bool backward : { false, true })
  {
    for (int step = 0; step < dimensions.z; ++step)
    {
      const int k = backward ? dimensions.z - 1 - step : step;
      const int beforeK = backward ? k + 1 : k - 1;
      std::uint16_t* const slice = distances + sliceLength * static_cast<std::size_t>(k);
      for (int line = 0; line < dimensions.y; ++line)
      {
        const int j = backward ? dimensions.y - 1 - line : line;
        const int beforeJ = backward ? j + 1 : j - 1;
        std::fill(nearest.begin(), nearest.end(), NothingVisible);
        if (beforeJ >= 0 && beforeJ < dimensions.y)
        {
          IncludeRow(
            slice + rowLength * static_cast<std::size_t>(beforeJ), dimensions.x, nearest.data());
        }
        if (beforeK >= 0 && beforeK < dimensions.z)
        {
          const std::uint16_t* other = distances + sliceLength * static_cast<std::size_t>(beforeK);
          for (int n = std::max(0, j - 1); n <= std::min(dimensions.y - 1, j + 1); ++n)
          {
            IncludeRow(
              other + rowLength * static_cast<std::size_t>(n), dimensions.x, nearest.data());
          }
        }
        SweepRow(
          slice + rowLength * static_cast<std::size_t>(j), dimensions.x, backward, nearest.data());
      }
      if (step % SlicesPerReport == SlicesPerReport - 1 &&
        !progress((backward ? 0.5 : 0.0) + 0.5 * (step + 1) / dimensions.z))
      {
        return false;
      }
    }
  }
  return true;
}

} // namespace ffd
