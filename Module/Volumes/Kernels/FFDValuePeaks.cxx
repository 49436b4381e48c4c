// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDValuePeaks.h"

#include "FFDGridIndex.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Bytes that may be read beyond the last code, as words of 32 bits are loaded.
constexpr std::size_t Padding = 3;

using Codes = std::vector<std::uint8_t>;

/// The largest of 2 x 2 x 2 cells of a grid.
std::uint8_t FindLargest(const Codes& codes, const glm::ivec3& size, const glm::ivec3& first)
{
  const glm::ivec3 last = glm::min(first + 1, size - 1);
  std::uint8_t largest = 0;
  for (int z = first.z; z <= last.z; ++z)
  {
    for (int y = first.y; y <= last.y; ++y)
    {
      for (int x = first.x; x <= last.x; ++x)
      {
        largest = std::max(largest, codes[GridIndex(x, y, z, size)]);
      }
    }
  }
  return largest;
}

/// codeOf(cell) for all cells of a grid.
template <class CodeOf>
Codes Fill(const glm::ivec3& size, const ParallelFor& parallelFor, const CodeOf& codeOf)
{
  Codes codes(GridSize(size) + Padding);
  parallelFor(static_cast<std::size_t>(size.z), [&](std::size_t first, std::size_t last) {
    for (int z = static_cast<int>(first); z < static_cast<int>(last); ++z)
    {
      for (int y = 0; y < size.y; ++y)
      {
        for (int x = 0; x < size.x; ++x)
        {
          codes[GridIndex(x, y, z, size)] = codeOf(glm::ivec3(x, y, z));
        }
      }
    }
  });
  return codes;
}

} // namespace

//------------------------------------------------------------------------------
ValuePeaks::ValuePeaks(const MinMaxBlocks& blocks, int sign, const ParallelFor& parallelFor)
{
  const MinMaxBlocks::Limits range = blocks.GetRange();
  const bool any = range.Min <= range.Max;
  this->Low = !any ? 0.0 : sign > 0 ? range.Min : -range.Max;
  this->High = !any ? 0.0 : sign > 0 ? range.Max : -range.Min;
  this->Step = any && range.Max > range.Min ? (range.Max - range.Min) / LastCode : 1.0;
  const auto codeOf = [&](const MinMaxBlocks::Limits& limits) {
    if (limits.Min > limits.Max)
    {
      return std::uint8_t{ 0 };
    }
    const double steps = ((sign > 0 ? limits.Max : -limits.Min) - this->Low) / this->Step;
    return static_cast<std::uint8_t>(std::clamp(std::ceil(steps), 0.0, double{ LastCode }));
  };
  this->Grids[0].Edge = static_cast<float>(MinMaxBlocks::BlockSize);
  this->Grids[0].Size = blocks.GetBlocks();
  this->Grids[0].Codes = Fill(this->Grids[0].Size, parallelFor,
    [&](const glm::ivec3& block) { return codeOf(blocks.GetLimits(block)); });
  for (std::size_t i = 1; i < this->Grids.size(); ++i)
  {
    const Grid& finer = this->Grids[i - 1];
    Grid& grid = this->Grids[i];
    grid.Edge = 2.0f * finer.Edge;
    grid.Size = (finer.Size + 1) / 2;
    grid.Codes = Fill(grid.Size, parallelFor,
      [&](const glm::ivec3& cell) { return FindLargest(finer.Codes, finer.Size, 2 * cell); });
  }
  for (Grid& grid : this->Grids)
  {
    grid.Codes = Fill(grid.Size, parallelFor,
      [&](const glm::ivec3& cell) { return FindLargest(grid.Codes, grid.Size, cell); });
  }
}

//------------------------------------------------------------------------------
const ValuePeaks::Grid* ValuePeaks::FindGrid(float extent) const
{
  const auto found = std::find_if(this->Grids.begin(), this->Grids.end(),
    [extent](const Grid& grid) { return extent <= grid.Edge; });
  return found == this->Grids.end() ? nullptr : &*found;
}

//------------------------------------------------------------------------------
std::size_t ValuePeaks::GetMemorySize() const
{
  std::size_t size = 0;
  for (const Grid& grid : this->Grids)
  {
    size += grid.Codes.capacity();
  }
  return size;
}

} // namespace ffd
