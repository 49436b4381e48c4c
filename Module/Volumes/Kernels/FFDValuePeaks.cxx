// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDValuePeaks.h"

#include "FFDGridIndex.h"
#include "FFDRounding.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

constexpr float Infinity = std::numeric_limits<float>::infinity();

/// The largest of 2 x 2 x 2 cells of a grid.
float FindLargest(const std::vector<float>& peaks, const glm::ivec3& size, const glm::ivec3& first)
{
  const glm::ivec3 last = glm::min(first + 1, size - 1);
  float largest = -Infinity;
  for (int z = first.z; z <= last.z; ++z)
  {
    for (int y = first.y; y <= last.y; ++y)
    {
      for (int x = first.x; x <= last.x; ++x)
      {
        largest = std::max(largest, peaks[GridIndex(x, y, z, size)]);
      }
    }
  }
  return largest;
}

/// valueOf(cell) for all cells of a grid.
template <class ValueOf>
std::vector<float> Fill(
  const glm::ivec3& size, const ParallelFor& parallelFor, const ValueOf& valueOf)
{
  std::vector<float> values(GridSize(size));
  parallelFor(static_cast<std::size_t>(size.z), [&](std::size_t first, std::size_t last) {
    for (int z = static_cast<int>(first); z < static_cast<int>(last); ++z)
    {
      for (int y = 0; y < size.y; ++y)
      {
        for (int x = 0; x < size.x; ++x)
        {
          values[GridIndex(x, y, z, size)] = valueOf(glm::ivec3(x, y, z));
        }
      }
    }
  });
  return values;
}

} // namespace

//------------------------------------------------------------------------------
ValuePeaks::ValuePeaks(const MinMaxBlocks& blocks, int sign, const ParallelFor& parallelFor)
{
  this->Grids[0].Edge = 2.0f * static_cast<float>(MinMaxBlocks::BlockSize);
  this->Grids[0].Size = blocks.GetParents();
  this->Grids[0].Peaks = Fill(this->Grids[0].Size, parallelFor, [&](const glm::ivec3& cell) {
    const MinMaxBlocks::Limits limits = blocks.GetParentLimits(cell);
    return limits.Min > limits.Max ? -Infinity : RoundUp(sign > 0 ? limits.Max : -limits.Min);
  });
  for (std::size_t i = 1; i < this->Grids.size(); ++i)
  {
    const Grid& finer = this->Grids[i - 1];
    Grid& grid = this->Grids[i];
    grid.Edge = 2.0f * finer.Edge;
    grid.Size = (finer.Size + 1) / 2;
    grid.Peaks = Fill(grid.Size, parallelFor,
      [&](const glm::ivec3& cell) { return FindLargest(finer.Peaks, finer.Size, 2 * cell); });
  }
  for (Grid& grid : this->Grids)
  {
    grid.Peaks = Fill(grid.Size, parallelFor,
      [&](const glm::ivec3& cell) { return FindLargest(grid.Peaks, grid.Size, cell); });
  }
}

//------------------------------------------------------------------------------
float ValuePeaks::FindBound(const float low[3], const float high[3]) const
{
  const float extent = std::max({ high[0] - low[0], high[1] - low[1], high[2] - low[2] });
  for (const Grid& grid : this->Grids)
  {
    if (extent <= grid.Edge)
    {
      const auto along = [&](int a) {
        const float last = static_cast<float>(grid.Size[a] - 1);
        return static_cast<int>(std::clamp(std::floor(low[a] / grid.Edge), 0.0f, last));
      };
      return grid.Peaks[GridIndex(along(0), along(1), along(2), grid.Size)];
    }
  }
  return Infinity;
}

//------------------------------------------------------------------------------
std::size_t ValuePeaks::GetMemorySize() const
{
  std::size_t size = 0;
  for (const Grid& grid : this->Grids)
  {
    size += grid.Peaks.capacity() * sizeof(float);
  }
  return size;
}

} // namespace ffd
