// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSubCellGrid_h
#define FFDSubCellGrid_h

#include "Bounds/FFDBox.h"

#include "FFDBSplineField.h"
#include "FFDGridIndex.h"

#include <glm/vec3.hpp>

#include <cstddef>

namespace ffd
{

/// Cells First ... End - 1 of a field, per axis.
struct CellRange
{
  glm::ivec3 First{ 0 };
  glm::ivec3 End{ 0 };
};

/**
 * The sub-cells of a field: 2 per cell of [FirstCell, EndCell) and axis, and one on either side
 * for the constant outside; x fastest. Of part of a field, those on either side mean nothing.
 */
struct SubCellGrid
{
  explicit SubCellGrid(const BSplineField& field)
    : SubCellGrid(CellRange{ field.GetFirstCell(), field.GetEndCell() })
  {
  }
  explicit SubCellGrid(const CellRange& cells)
    : FirstCell(cells.First)
    , Size(2 * (cells.End - cells.First) + 2)
  {
  }
  std::size_t Index(int i, int j, int k) const { return GridIndex(i, j, k, this->Size); }
  std::size_t Count() const { return GridSize(this->Size); }
  /// Cells per axis, the constant outside ones included.
  glm::ivec3 GetCells() const { return this->Size / 2 + 1; }

  glm::ivec3 FirstCell;
  glm::ivec3 Size;
};

/// Ends of a sub-cell along an axis, data coordinates; the constant outside ones are infinite.
struct SubCellEnds
{
  double Min;
  double Max;
};

/// The ends of sub-cell i of the whole field along an axis.
SubCellEnds FindSubCellEnds(const BSplineField& field, int axis, int i);

/// The cell of a sub-cell; of the constant outside ones that beside it.
int FindCellOfSubCell(const BSplineField& field, int axis, int i);

/// Sub-cells [first, last] per axis that touch `region`; false when there are none.
bool FindSubCells(
  const BSplineField& field, const Box& region, glm::ivec3& first, glm::ivec3& last);

} // namespace ffd

#endif
