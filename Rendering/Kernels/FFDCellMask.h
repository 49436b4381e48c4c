// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCellMask_h
#define FFDCellMask_h

#include "FFDGridIndex.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/**
 * A set of cells of a grid, one bit each. Rows along x begin with a byte of their own, and the
 * outermost cells are repeated Pad times beyond the grid, so that vector code can load the bits of
 * neighboring cells at once. Blocks of 8^3 cells know whether there are any of the set in them or
 * nearby.
 */
class CellMask
{
public:
  static constexpr int Pad = 2; ///< cells beyond the grid on each side
  static constexpr int LogBlockSize = 3;
  static constexpr int Nearby = 2; ///< cells along each axis

  CellMask() = default;

  /// No cell of `cells` cells along each axis.
  explicit CellMask(const glm::ivec3& cells)
    : Cells(cells)
    , RowBytes((static_cast<std::size_t>(cells.x) + 2 * Pad + 7) / 8)
    , SliceBytes(this->RowBytes * (static_cast<std::size_t>(cells.y) + 2 * Pad))
    // The last word that is loaded may reach beyond the last row.
    , Bytes(this->SliceBytes * (static_cast<std::size_t>(cells.z) + 2 * Pad) + 8)
    , Blocks((cells + (2 * Pad + (1 << LogBlockSize) - 1)) / (1 << LogBlockSize))
    , NearBlocks(GridSize(this->Blocks) + 3)
  {
  }

  const glm::ivec3& GetCells() const { return this->Cells; }

  void Add(const glm::ivec3& cell)
  {
    glm::ivec3 first = cell;
    glm::ivec3 last = cell;
    for (int a = 0; a < 3; ++a)
    {
      first[a] -= cell[a] == 0 ? Pad : 0;
      last[a] += cell[a] == this->Cells[a] - 1 ? Pad : 0;
    }
    for (int k = first.z; k <= last.z; ++k)
    {
      for (int j = first.y; j <= last.y; ++j)
      {
        for (int i = first.x; i <= last.x; ++i)
        {
          this->Bytes[this->FindByte(i, j, k)] |= static_cast<std::uint8_t>(1 << (i + Pad) % 8);
        }
      }
    }
    const glm::ivec3 firstBlock = glm::max(cell - Nearby + Pad, 0) >> LogBlockSize;
    const glm::ivec3 lastBlock = glm::min((cell + Nearby + Pad) >> LogBlockSize, this->Blocks - 1);
    for (int k = firstBlock.z; k <= lastBlock.z; ++k)
    {
      for (int j = firstBlock.y; j <= lastBlock.y; ++j)
      {
        for (int i = firstBlock.x; i <= lastBlock.x; ++i)
        {
          this->NearBlocks[GridIndex(i, j, k, this->Blocks)] = 1;
        }
      }
    }
  }

  bool Has(const glm::ivec3& cell) const
  {
    return (this->Bytes[this->FindByte(cell.x, cell.y, cell.z)] >> (cell.x + Pad) % 8 & 1) != 0;
  }

  /// Whether all cells from `first` to `last` are in the set.
  bool HasAll(const glm::ivec3& first, const glm::ivec3& last) const
  {
    for (int k = first.z; k <= last.z; ++k)
    {
      for (int j = first.y; j <= last.y; ++j)
      {
        for (int i = first.x; i <= last.x; ++i)
        {
          if (!this->Has({ i, j, k }))
          {
            return false;
          }
        }
      }
    }
    return true;
  }

  /// The bits, from that of cell (-Pad, -Pad, -Pad) on; a byte holds those of eight cells along x,
  /// the first in its lowest bit. Behind the last one 32 bits can be loaded.
  const std::uint8_t* GetBytes() const { return this->Bytes.data(); }
  std::size_t GetRowBytes() const { return this->RowBytes; }
  std::size_t GetSliceBytes() const { return this->SliceBytes; }

  ///@{
  /// A byte for each block of 8^3 cells, from cell (-Pad, -Pad, -Pad) on, x fastest: 1 where a cell
  /// of the set is in the block or at most Nearby from one that is, else 0. Three more bytes may be
  /// read behind the last one.
  const std::uint8_t* GetNearBlocks() const { return this->NearBlocks.data(); }
  const glm::ivec3& GetBlocks() const { return this->Blocks; }
  ///@}

  std::size_t GetMemorySize() const { return this->Bytes.capacity() + this->NearBlocks.capacity(); }

private:
  std::size_t FindByte(int i, int j, int k) const
  {
    return static_cast<std::size_t>(k + Pad) * this->SliceBytes +
      static_cast<std::size_t>(j + Pad) * this->RowBytes + static_cast<std::size_t>(i + Pad) / 8;
  }

  glm::ivec3 Cells{ 0 };
  std::size_t RowBytes = 0;
  std::size_t SliceBytes = 0;
  std::vector<std::uint8_t> Bytes;
  glm::ivec3 Blocks{ 0 };
  std::vector<std::uint8_t> NearBlocks;
};

} // namespace ffd

#endif
