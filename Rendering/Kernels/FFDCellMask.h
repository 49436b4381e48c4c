// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCellMask_h
#define FFDCellMask_h

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
    , Bits((static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) *
               static_cast<std::size_t>(cells.z) +
             63) /
        64)
  {
  }

  const glm::ivec3& GetCells() const { return this->Cells; }

  void Add(const glm::ivec3& cell)
  {
    const std::size_t at = this->IndexOf(cell);
    this->Bits[at / 64] |= std::uint64_t{ 1 } << at % 64;
  }

  bool Has(const glm::ivec3& cell) const
  {
    const std::size_t at = this->IndexOf(cell);
    return (this->Bits[at / 64] >> at % 64 & 1) != 0;
  }

  std::size_t GetMemorySize() const { return this->Bits.capacity() * sizeof(std::uint64_t); }

private:
  std::size_t IndexOf(const glm::ivec3& cell) const
  {
    return cell.x +
      static_cast<std::size_t>(this->Cells.x) *
      (cell.y + static_cast<std::size_t>(this->Cells.y) * cell.z);
  }

  glm::ivec3 Cells{ 0 };
  std::vector<std::uint64_t> Bits; // x fastest
};

} // namespace ffd

#endif
