// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTableSampling.h"

#include <algorithm>
#include <cmath>

namespace
{

/// Entries of a transfer table: at least, and at most (then it takes 320 kB).
constexpr int SmallestTable = 4096;
constexpr int LargestTable = 16384;

} // namespace

//------------------------------------------------------------------------------
vtkFFDTableSampling vtkFFDFindTableSampling(const ffd::MinMaxBlocks::Limits& range, bool integers,
  const double* nodes, const std::function<int(double low, double high)>& estimate)
{
  double lo = range.Min;
  double hi = range.Max;
  // Beyond their last points clamped functions are constant: spend no entries there, so that a
  // few extreme scalars do not coarsen the table.
  if (nodes)
  {
    lo = std::min(std::max(lo, nodes[0]), hi);
    hi = std::max(std::min(hi, nodes[1]), lo);
  }
  if (!(hi - lo > 1e-12 * std::max(std::abs(lo), std::abs(hi))))
  {
    hi = lo + std::max(1.0, std::abs(lo));
  }
  if (integers && hi - lo <= LargestTable)
  {
    // A whole number of entries a unit, so that whole scalars are met exactly.
    const int width = static_cast<int>(hi - lo);
    const int perUnit = std::max(1, SmallestTable / std::max(1, width));
    lo = std::floor(lo);
    return { lo, lo + width + 1, perUnit * (width + 1) + 1 };
  }
  return { lo, hi, std::clamp(estimate(lo, hi), SmallestTable, LargestTable) };
}
