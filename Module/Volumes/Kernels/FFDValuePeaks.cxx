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

/// The edge of the largest cells, voxels.
constexpr float LargestEdge = 32.0f;

/// The codes of a grid, by the cell.
auto CodesOf(const Codes& codes, const glm::ivec3& size)
{
  return [&codes, size](const glm::ivec3& cell) { return codes[GridIndex(cell, size)]; };
}

/// The largest of codeOf(cell) for 2 x 2 x 2 cells of a grid.
template <class CodeOf>
std::uint8_t FindLargest(const CodeOf& codeOf, const glm::ivec3& size, const glm::ivec3& first)
{
  const glm::ivec3 last = glm::min(first + 1, size - 1);
  std::uint8_t largest = 0;
  for (int z = first.z; z <= last.z; ++z)
  {
    for (int y = first.y; y <= last.y; ++y)
    {
      for (int x = first.x; x <= last.x; ++x)
      {
        largest = std::max(largest, codeOf(glm::ivec3(x, y, z)));
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
ValuePeaks::ValuePeaks(
  const MinMaxBlocks& blocks, int sign, bool sparing, const ParallelFor& parallelFor)
{
  const MinMaxBlocks::Limits& range = blocks.GetRange();
  if (range.Min <= range.Max)
  {
    const MinMaxBlocks::Limits& known = blocks.GetCommonRange();
    const MinMaxBlocks::Limits& common = known.Max > known.Min ? known : range;
    this->Low = sign > 0 ? common.Min : -common.Max;
    this->High = sign > 0 ? range.Max : -range.Min;
    // What is larger than all that is common has the last code.
    const double width = common.Max - common.Min;
    const int codes = this->High > this->Low + width ? LastCode - 1 : LastCode;
    this->Step = width > 0.0 ? width / codes : 1.0;
  }
  const glm::ivec3 size = blocks.GetBlocks();
  const auto codeOf = [&](const glm::ivec3& block) {
    const MinMaxBlocks::Limits limits = blocks.GetLimits(block);
    if (limits.Min > limits.Max)
    {
      return std::uint8_t{ 0 };
    }
    const double steps = ((sign > 0 ? limits.Max : -limits.Min) - this->Low) / this->Step;
    return static_cast<std::uint8_t>(std::clamp(std::ceil(steps), 0.0, double{ LastCode }));
  };
  constexpr float BlockEdge = MinMaxBlocks::BlockSize;
  if (sparing)
  {
    const glm::ivec3 cells = (size + 1) / 2;
    this->Grids.push_back(
      { 2.0f * BlockEdge, cells, Fill(cells, parallelFor, [&](const glm::ivec3& cell) {
         return FindLargest(codeOf, size, 2 * cell);
       }) });
  }
  else
  {
    this->Grids.push_back({ BlockEdge, size, Fill(size, parallelFor, codeOf) });
  }
  while (this->Grids.back().Edge < LargestEdge)
  {
    const Grid& finer = this->Grids.back();
    const glm::ivec3 cells = (finer.Size + 1) / 2;
    this->Grids.push_back(
      { 2.0f * finer.Edge, cells, Fill(cells, parallelFor, [&](const glm::ivec3& cell) {
         return FindLargest(CodesOf(finer.Codes, finer.Size), finer.Size, 2 * cell);
       }) });
  }
  for (Grid& grid : this->Grids)
  {
    grid.Codes = Fill(grid.Size, parallelFor, [&](const glm::ivec3& cell) {
      return FindLargest(CodesOf(grid.Codes, grid.Size), grid.Size, cell);
    });
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
