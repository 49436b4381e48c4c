// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDValuePeaks_h
#define FFDValuePeaks_h

#include "FFDExport.h"
#include "FFDMinMaxBlocks.h"
#include "FFDParallelFor.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace ffd
{

/**
 * Upper bounds of the values in boxes of a volume: rays that look for the largest value leave out
 * boxes that hold none above what they have found. Minima are the largest of the negated values.
 *
 * A box is looked up in cells of 8^3, 16^3 or 32^3 voxels that are no smaller than it: it lies in
 * the cell that holds its lowest corner and the next ones, and the largest value of these eight is
 * kept for each cell. 0.9 % of an 8-bit volume.
 */
class FFD_VOLUMES_EXPORT ValuePeaks
{
public:
  ValuePeaks() = default;
  /// `sign`: 1 for the largest values, -1 for the smallest ones.
  ValuePeaks(const MinMaxBlocks& blocks, int sign, const ParallelFor& parallelFor);

  bool IsEmpty() const { return this->Grids[0].Peaks.empty(); }

  /// No value in the box from `low` to `high`, index coordinates, times the sign is larger;
  /// infinite where the box is larger than all cells.
  float FindBound(const float low[3], const float high[3]) const;

  std::size_t GetMemorySize() const;

private:
  static constexpr int NumberOfGrids = 3;
  struct Grid
  {
    float Edge = 0.0f; ///< of a cell, voxels
    glm::ivec3 Size{ 0 };
    std::vector<float> Peaks;
  };
  std::array<Grid, NumberOfGrids> Grids;
};

} // namespace ffd

#endif
