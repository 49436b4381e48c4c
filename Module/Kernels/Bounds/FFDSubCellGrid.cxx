// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDSubCellGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ffd
{

//------------------------------------------------------------------------------
SubCellEnds FindSubCellEnds(const BSplineField& field, int axis, int i)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double h = field.GetSpacing()[axis];
  const double origin = field.GetOrigin()[axis];
  const int begin = field.GetFirstCell()[axis];
  const int size = 2 * (field.GetEndCell()[axis] - begin) + 2;
  const double lower = begin + 0.5 * (i - 1);
  const double from = origin + (i == 0 ? -infinity : lower) * h;
  const double to = origin + (i == size - 1 ? infinity : lower + 0.5) * h;
  return { std::min(from, to), std::max(from, to) };
}

//------------------------------------------------------------------------------
int FindCellOfSubCell(const BSplineField& field, int axis, int i)
{
  const int begin = field.GetFirstCell()[axis];
  return std::clamp(begin + (i - 1) / 2, begin, field.GetEndCell()[axis] - 1);
}

//------------------------------------------------------------------------------
bool FindSubCells(const BSplineField& field, const Box& region, glm::ivec3& first, glm::ivec3& last)
{
  if (region.IsEmpty())
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    const double h = field.GetSpacing()[a];
    double lo = (region.Min[a] - field.GetOrigin()[a]) / h;
    double hi = (region.Max[a] - field.GetOrigin()[a]) / h;
    if (h < 0.0)
    {
      std::swap(lo, hi);
    }
    const double begin = field.GetFirstCell()[a];
    const double end = field.GetEndCell()[a];
    // A face within rounding of the region counts as touched. Clamped before the cast.
    constexpr double touch = 1e-9;
    lo = std::clamp(2.0 * (lo - begin) - touch, -1.0, 2.0 * (end - begin) + 1.0);
    hi = std::clamp(2.0 * (hi - begin) + touch, -1.0, 2.0 * (end - begin));
    // Sub-cell s covers [s - 1, s]: both ends count.
    first[a] = std::max(0, static_cast<int>(std::ceil(lo)));
    last[a] = static_cast<int>(std::floor(hi)) + 1;
  }
  return true;
}

} // namespace ffd
