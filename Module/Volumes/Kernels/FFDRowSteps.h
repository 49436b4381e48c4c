// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRowSteps_h
#define FFDRowSteps_h

#include <cstddef>
#include <cstdint>

namespace ffd
{

/// Steps over rows of the numbers of a type, in vector code. Rows do not overlap.
template <class T>
struct ExtremesSteps
{
  /// Include(row, stride, rows, count, min, max) makes min[i] and max[i] hold the numbers i of
  /// `rows` rows, too, which begin `stride` numbers apart; what is not a number is left out.
  void (*Include)(const T* row, std::ptrdiff_t stride, int rows, std::size_t count, T* min, T* max);

  /// Merge(otherMin, otherMax, count, min, max) makes extremes those of others, too.
  void (*Merge)(const T* otherMin, const T* otherMax, std::size_t count, T* min, T* max);

  /// WidenByFour(min, max, count) makes the extremes at each position those of it and the four
  /// positions behind it, where these exist.
  void (*WidenByFour)(T* min, T* max, std::size_t count);
};

/// Distances between blocks are not told apart above this.
constexpr std::uint8_t LargestBlockDistance = 127;

/// Steps over the blocks of a row of parents of MinMaxBlocks, in vector code. Codes are floats;
/// where there is no number the minimum is above the maximum.
struct BlockSteps
{
  /// FindParents(min, max, count, least, most) finds the limits of parents from those of their
  /// eight children.
  void (*FindParents)(const float* const min[8], const float* const max[8], std::size_t count,
    float* least, float* most);

  /// How the limits of a block are encoded in a byte.
  struct Encoding
  {
    int LastMinimum;
    int LastMaximum;
    int MinimumBits;
    int NoNumber;
  };

  /// Encode(encoding, min, max, least, width, count, codes) encodes a child of each parent;
  /// `width`: of the range of the parent, at least LastMaximum.
  void (*Encode)(const Encoding& encoding, const float* min, const float* max, const float* least,
    const float* width, std::size_t count, std::uint8_t* codes);

  /// FindReaching(encoding, codes, thresholds, count, distances) makes distances 0 of blocks that
  /// hold a number and whose maximum is at least the threshold of their minimum, and
  /// LargestBlockDistance of others. `codes`: of the blocks of a row; `thresholds`: for each
  /// minimum, of the parent of each block.
  void (*FindReaching)(const Encoding& encoding, const std::uint8_t* codes,
    const std::uint8_t* const thresholds[2], std::size_t count, std::uint8_t* distances);
};

/// Steps over rows of distances, in vector code. Rows do not overlap.
struct DistanceSteps
{
  /// Lines that a vector has a number of, at most.
  static constexpr std::size_t LinesAtOnce = 64;

  /**
   * TransformLines(lines, count, stride, width, work) makes one more axis of the Chebyshev distance
   * transform, of `width` lines that lie side by side; the `count` numbers of a line are `stride`
   * apart: out[i] = min over j of max(|i - j|, in[j]). The search for a number ends at the largest
   * distance found so far in as many lines as a vector has numbers, so it is short wherever the
   * volume is not empty. `work`: count * LinesAtOnce bytes.
   */
  void (*TransformLines)(std::uint8_t* lines, std::size_t count, std::size_t stride,
    std::size_t width, std::uint8_t* work);

  /// FindDistances(row, count, work) replaces numbers, each of them 0 or LargestBlockDistance, by
  /// their distances from the nearest 0, at most that. `work`: 6 * count bytes, all of them
  /// LargestBlockDistance before the first call, and left to the next one.
  void (*FindDistances)(std::uint8_t* row, std::size_t count, std::uint8_t* work);

  /// TransformPlane(plane, width, rows) makes one more axis of the Chebyshev distance transform, of
  /// a plane of `rows` rows of `width` distances along the first axis: a number is at most one more
  /// than those of the row before, next to it and diagonally, and of the row behind.
  void (*TransformPlane)(std::uint8_t* plane, std::size_t width, std::size_t rows);

  /// AddNeighbors(row, behindY, behindZ, behindYZ, count) replaces the distances of 1 in a row by
  /// what DistanceMap::GetData() says of them. The other rows are the next one along y, along z,
  /// and along both, of which only zeros count.
  void (*AddNeighbors)(std::uint8_t* row, const std::uint8_t* behindY, const std::uint8_t* behindZ,
    const std::uint8_t* behindYZ, std::size_t count);
};

///@{
/**
 * The steps for the best instruction set that the machine has. T: the types of scalars.
 */
template <class T>
ExtremesSteps<T> GetExtremesSteps();
BlockSteps GetBlockSteps();
DistanceSteps GetDistanceSteps();
///@}

} // namespace ffd

#endif
