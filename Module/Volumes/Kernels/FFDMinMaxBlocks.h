// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDMinMaxBlocks_h
#define FFDMinMaxBlocks_h

#include "FFDExport.h"
#include "FFDParallelFor.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/**
 * Smallest and largest scalar of every block of 4^3 cells (5^3 voxels: neighbors share a layer,
 * so a trilinear sample lies between the limits of the block that holds it). Built once per input,
 * of one component. Blocks are those of index coordinates; where VolumeView::Axes says that voxels
 * lie elsewhere, a block has all voxels that a sample in it is interpolated from.
 *
 * Limits are codes of equal steps over the scalar range, rounded outwards: whole numbers where the
 * range is at most 255 of them, else 65535 steps. They are stored for parents of 2^3 blocks; a
 * block keeps two bits and six that say where, between the limits of its parent, its own minimum
 * and maximum are, again rounded outwards. So they take 2 % of an 8-bit volume and less of others.
 *
 * Voxels that are not a number are left out: a sample next to one is not a number either and
 * contributes nothing. Infinite ones, and floating-point numbers above a quarter of the largest
 * one, count as the nearest end of the range.
 */
class FFD_VOLUMES_EXPORT MinMaxBlocks
{
public:
  static constexpr int BlockSize = 4;

  struct Limits
  {
    double Min;
    double Max; ///< < Min where a block has no number at all
  };

  MinMaxBlocks() = default;
  MinMaxBlocks(const VolumeView& volume, const ParallelFor& parallelFor);

  const glm::ivec3& GetBlocks() const { return this->Blocks; }
  std::size_t GetNumberOfBlocks() const { return this->NumberOfBlocks; }

  /// Range of the finite scalars of the whole volume; Min > Max when there is none.
  const Limits& GetRange() const { return this->Range; }

  /// Parents along each axis; parent p holds the blocks 2 p and 2 p + 1.
  const glm::ivec3& GetParents() const { return this->Parents; }

  /// Limits of a parent: of all its blocks together.
  Limits GetParentLimits(const glm::ivec3& parent) const;

  /// Limits of a block.
  Limits GetLimits(const glm::ivec3& block) const;

  std::size_t GetMemorySize() const
  {
    return this->Codes.capacity() + this->ParentBytes.capacity() + 2 * this->ParentWords.capacity();
  }

private:
  /// Limits in codes; Max < Min: no number at all.
  struct CodeLimits
  {
    int Min;
    int Max;
  };

  template <class T>
  void EncodeBlocks(const VolumeView& volume, const ParallelFor& parallelFor);
  /// Limits in scalar units; `min` > `max` where there is no number.
  CodeLimits Encode(double min, double max) const;
  void EncodeParent(const glm::ivec3& parent, const CodeLimits children[8]);
  CodeLimits GetParentCodes(const glm::ivec3& parent) const;
  Limits Decode(const CodeLimits& codes) const;

  glm::ivec3 Blocks{ 0 };
  glm::ivec3 Parents{ 0 };
  std::size_t NumberOfBlocks = 0;
  Limits Range{ 0.0, -1.0 };
  double CodeStep = 0.0; // scalar units per code
  int LastCode = 255;
  std::vector<std::uint8_t> Codes;       // of a block: minimum in the low two bits, maximum above
  std::vector<std::uint8_t> ParentBytes; // min, max of each parent; one of the two is used
  std::vector<std::uint16_t> ParentWords;
};

} // namespace ffd

#endif
