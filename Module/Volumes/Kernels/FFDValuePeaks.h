// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDValuePeaks_h
#define FFDValuePeaks_h

#include "FFDExport.h"
#include "FFDMinMaxBlocks.h"
#include "FFDParallelFor.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/**
 * Upper bounds of the values in boxes of a volume: rays that look for the largest value leave out
 * boxes that hold none above what they have found. Minima are the largest of the negated values.
 *
 * A box is looked up in cells of 4^3, 8^3, 16^3 or 32^3 voxels that are no smaller than it: it lies
 * in the cell that holds its lowest corner and the next ones, and the largest value of these eight
 * is kept for each cell, as a code: one of 256 equal steps over the range of the values, rounded
 * up. That takes 1.8 bytes for 100 voxels; without the cells of 4^3, which few boxes fit, 0.22.
 */
class FFD_VOLUMES_EXPORT ValuePeaks
{
public:
  static constexpr int LastCode = 255;

  /// Codes of cells of one size, x fastest.
  struct Grid
  {
    float Edge = 0.0f; ///< of a cell, voxels
    glm::ivec3 Size{ 0 };
    std::vector<std::uint8_t> Codes; ///< and three bytes that vectors may read beyond the last one
  };

  ValuePeaks() = default;
  /// `sign`: 1 for the largest values, -1 for the smallest ones. `sparing`: without cells of 4^3.
  ValuePeaks(const MinMaxBlocks& blocks, int sign, bool sparing, const ParallelFor& parallelFor);

  bool IsEmpty() const { return this->Grids.empty(); }

  /// The finest grid for boxes whose sides are at most `extent` voxels; null where there is none.
  const Grid* FindGrid(float extent) const;

  const Grid& GetFinestGrid() const { return this->Grids.front(); }

  /// Code c stands for values, times the sign, of at most GetLow() + c * GetStep(), the last one
  /// for those of at most GetHigh().
  double GetLow() const { return this->Low; }
  double GetStep() const { return this->Step; }

  /// The largest value, times the sign.
  double GetHigh() const { return this->High; }

  std::size_t GetMemorySize() const;

private:
  std::vector<Grid> Grids; ///< finest first
  double Low = 0.0;
  double High = 0.0;
  double Step = 1.0;
};

} // namespace ffd

#endif
