// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCellMask_h
#define FFDCellMask_h

#include "FFDGridIndex.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/// A set of cells of a grid, one bit each.
class CellMask
{
public:
  CellMask() = default;

  /// No cell of `cells` cells along each axis.
  explicit CellMask(const glm::ivec3& cells)
    : Cells(cells)
    , Bits((GridSize(cells) + 63) / 64)
  {
  }

  const glm::ivec3& GetCells() const { return this->Cells; }

  void Add(const glm::ivec3& cell)
  {
    const std::size_t at = GridIndex(cell, this->Cells);
    this->Bits[at / 64] |= std::uint64_t{ 1 } << at % 64;
  }

  bool Has(const glm::ivec3& cell) const
  {
    const std::size_t at = GridIndex(cell, this->Cells);
    return (this->Bits[at / 64] >> at % 64 & 1) != 0;
  }

  std::size_t GetMemorySize() const { return this->Bits.capacity() * sizeof(std::uint64_t); }

private:
  glm::ivec3 Cells{ 0 };
  std::vector<std::uint64_t> Bits; // x fastest
};

} // namespace ffd

#endif
