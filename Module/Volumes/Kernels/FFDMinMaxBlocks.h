// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDMinMaxBlocks_h
#define FFDMinMaxBlocks_h

#include "FFDExport.h"
#include "FFDGridIndex.h"
#include "FFDParallelFor.h"
#include "FFDRowSteps.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace ffd
{

/**
 * Smallest and largest scalar of every block of 4^3 cells (5^3 voxels: neighbors share a layer,
 * so a trilinear sample lies between the limits of the block that holds it). Built once per input,
 * of one component. Blocks are those of index coordinates; where VolumeView::Axes says that voxels
 * lie elsewhere, a block has all voxels that a sample in it is interpolated from.
 *
 * Limits are codes of equal steps, rounded outwards: whole numbers of 8 or 16 bits and ranges of at
 * most 255 whole numbers, else 65535 steps over the common range. They are stored for parents of
 * 2^3 blocks; a block keeps seven bits that say where, between the limits of its parent, its own
 * maximum is, again rounded outwards, and one that says whether its minimum is in the upper half.
 * So they take 2 % of an 8-bit volume and less of others.
 *
 * Voxels that are not a number are left out: a sample next to one is not a number either and
 * contributes nothing. Infinite ones count as the nearest end of the range; so do floating-point
 * numbers above a quarter of the largest one where differences of scalars would be infinite.
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

  /// The range without its ends where these are far from all other scalars, as values that stand
  /// for no data. Of what lies beyond it limits say no more than that.
  const Limits& GetCommonRange() const { return this->CommonRange; }

  /// Parents along each axis; parent p holds the blocks 2 p and 2 p + 1.
  const glm::ivec3& GetParents() const { return this->Parents; }

  /// Limits of a parent: of all its blocks together.
  Limits GetParentLimits(const glm::ivec3& parent) const;

  /// Limits of a block.
  Limits GetLimits(const glm::ivec3& block) const;

  /// Limits in codes; Max < Min: no number at all.
  struct CodeLimits
  {
    int Min;
    int Max;
  };

  /// The largest code.
  int GetLastCode() const { return this->LastCode; }

  Limits Decode(const CodeLimits& codes) const;
  CodeLimits GetParentCodes(const glm::ivec3& parent) const
  {
    const std::size_t at = 2 * GridIndex(parent, this->Parents);
    return this->ParentBytes.empty()
      ? CodeLimits{ this->ParentWords[at], this->ParentWords[at + 1] }
      : CodeLimits{ this->ParentBytes[at], this->ParentBytes[at + 1] };
  }

  /// `parent`: GetParentCodes() of block / 2.
  CodeLimits GetCodes(const glm::ivec3& block, const CodeLimits& parent) const
  {
    const int code = this->Codes[GridIndex(block, this->Blocks)];
    if (parent.Min > parent.Max || code == NoNumber)
    {
      return { 1, 0 };
    }
    const int low = code & LastMinimum;
    const int high = code >> MinimumBits;
    const int width = std::max(LastMaximum, parent.Max - parent.Min);
    return { parent.Min + width * low / (LastMinimum + 1),
      std::min(parent.Max, parent.Min + (width * high + LastMaximum - 1) / LastMaximum) };
  }

  /**
   * Finds which blocks of a row of parents have a maximum as their minimum asks for. `least`: for
   * each code of a minimum the least one that maxima must have, above the last one if none has.
   * `distances`, of all blocks, x fastest: 0 where a block has it, LargestBlockDistance where it
   * has not, or holds no number.
   */
  void FindReaching(int y, int z, const std::vector<int>& least, std::uint8_t* distances) const;

  std::size_t GetMemorySize() const
  {
    return this->Codes.capacity() + this->ParentBytes.capacity() + 2 * this->ParentWords.capacity();
  }

private:
  /**
   * Bits of the minimum in the code of a block, the others are the maximum's: most opacity
   * functions rise, so what is empty depends on the maximum.
   */
  static constexpr int MinimumBits = 1;
  static constexpr int LastMinimum = (1 << MinimumBits) - 1;
  static constexpr int LastMaximum = (1 << (8 - MinimumBits)) - 1;

  /// Code of a block that holds no number: no minimum is so far above the maximum.
  static constexpr int NoNumber = LastMinimum;

  static constexpr BlockSteps::Encoding BlockEncoding{ LastMinimum, LastMaximum, MinimumBits,
    NoNumber };

  /// For each minimum that a block can have, the least number that its maximum must have.
  using BlockThresholds = std::array<std::uint8_t, LastMinimum + 1>;

  /// Finds the thresholds of the blocks of a parent, as FindReaching() does.
  BlockThresholds FindThresholds(const CodeLimits& parent, const std::vector<int>& least) const;

  /// Codes of the blocks of a row of parents, by their places in them, and what is found of these.
  struct Children
  {
    std::array<std::vector<float>, 8> Min;
    std::array<std::vector<float>, 8> Max;
    std::vector<float> Least;
    std::vector<float> Width;
    std::vector<std::uint8_t> Codes;

    explicit Children(std::size_t parents)
      : Least(parents)
      , Width(parents)
      , Codes(parents)
    {
      this->Min.fill(this->Least);
      this->Max.fill(this->Least);
    }
  };

  /// Encodes the blocks of a type whose scalars are codes.
  template <class T>
  void EncodeVolume(const VolumeView& volume, const ParallelFor& parallelFor);
  /// Encodes the blocks by their extremes, x fastest.
  template <class T>
  void EncodeExtremes(const std::vector<std::pair<T, T>>& extremes, const ParallelFor& parallelFor);
  /// Encodes the blocks of a row of parents. find(first, count, min, max) finds the codes of
  /// `count` of them, every second one along x from `first` on.
  template <class Find>
  void EncodeRow(int y, int z, Children& children, const Find& find);
  /// `limits`: in scalar units; the minimum is above the maximum where there is no number.
  template <class T>
  CodeLimits Encode(const std::pair<T, T>& limits) const;
  void EncodeParents(int y, int z, Children& children);
  void SetParentCodes(const glm::ivec3& parent, const CodeLimits& codes);
  /// Finds the codes of scalars of Range, most of them in CommonRange.
  void SetCodes(bool integral);
  template <class Code>
  Limits FindRangeOfParents(const std::vector<Code>& parents) const;

  glm::ivec3 Blocks{ 0 };
  glm::ivec3 Parents{ 0 };
  std::size_t NumberOfBlocks = 0;
  Limits Range{ 0.0, -1.0 };
  Limits CommonRange{ 0.0, -1.0 };
  double FirstScalar = 0.0; // of code 0
  double CodeStep = 1.0;    // scalar units per code
  double Rounding = 0.0;    // of scalars and codes into each other, at most
  int LastCode = 255;
  std::vector<std::uint8_t> Codes;       // of a block: minimum in the low two bits, maximum above
  std::vector<std::uint8_t> ParentBytes; // min, max of each parent; one of the two is used
  std::vector<std::uint16_t> ParentWords;
};

} // namespace ffd

#endif
