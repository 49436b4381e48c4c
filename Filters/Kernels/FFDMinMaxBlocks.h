// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDMinMaxBlocks_h
#define FFDMinMaxBlocks_h

#include "FFDExport.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace ffd
{

/**
 * Smallest and largest scalar of every block of 4^3 cells (5^3 voxels: neighbours share a layer,
 * so a trilinear sample lies between the limits of the block that holds it). Built once per input.
 *
 * Limits are stored as codes of equal steps over the scalar range, rounded outwards: one byte each
 * where the range is at most 255 whole numbers (then they are exact), else two. So they take
 * 3 % of an 8 or 16-bit volume and less of others.
 *
 * Voxels that are not a number are left out: a sample next to one is not a number either and
 * contributes nothing. Infinite ones, and floating-point numbers above a quarter of the largest
 * one, count as the nearest end of the range.
 */
class FFD_KERNEL_EXPORT MinMaxBlocks
{
public:
  static constexpr int BlockSize = 4;

  struct Limits
  {
    double Min;
    double Max; ///< < Min where a block has no number at all
  };

  /// Runs work(first, last) over [0, count), possibly split over threads.
  using ParallelFor = std::function<void(std::size_t count,
    const std::function<void(std::size_t first, std::size_t last)>& work)>;

  MinMaxBlocks() = default;
  MinMaxBlocks(const VolumeView& volume, const ParallelFor& parallelFor);

  const glm::ivec3& GetBlocks() const { return this->Blocks; }
  std::size_t GetNumberOfBlocks() const { return this->NumberOfBlocks; }

  /// Limits of block `index`, x fastest.
  Limits GetLimits(std::size_t index) const;

  /// Range of the finite scalars of the whole volume; Min > Max when there is none.
  const Limits& GetRange() const { return this->Range; }

  std::size_t GetMemorySize() const
  {
    return this->ByteCodes.capacity() + 2 * this->WordCodes.capacity();
  }

private:
  template <class T, class Code>
  void EncodeBlocks(
    const VolumeView& volume, std::vector<Code>& codes, const ParallelFor& parallelFor);

  glm::ivec3 Blocks{ 0 };
  std::size_t NumberOfBlocks = 0;
  Limits Range{ 0.0, -1.0 };
  double CodeStep = 0.0;                // scalar units per code
  std::vector<std::uint8_t> ByteCodes;  // min, max of each block; one of the two is used
  std::vector<std::uint16_t> WordCodes;
};

} // namespace ffd

#endif
