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
  /// Include(row, count, min, max) makes min[i] and max[i] hold row[i], too; what is not a number
  /// is left out.
  void (*Include)(const T* row, std::size_t count, T* min, T* max);

  /// WidenByFour(min, max, count) makes the extremes at each position those of it and the four
  /// positions behind it, where these exist.
  void (*WidenByFour)(T* min, T* max, std::size_t count);
};

/// Distances between blocks are not told apart above this.
constexpr std::uint8_t LargestBlockDistance = 127;

/// Steps over rows of distances, in vector code. Rows do not overlap.
struct DistanceSteps
{
  /// Lower(below, above, gap, out, count) lowers out[i] to max(gap, min(below[i], above[i])) where
  /// that is less, and returns the largest of `out`.
  std::uint8_t (*Lower)(const std::uint8_t* below, const std::uint8_t* above, std::uint8_t gap,
    std::uint8_t* out, std::size_t count);

  /// Copy(from, to, count) copies a row, and returns the largest of its numbers.
  std::uint8_t (*Copy)(const std::uint8_t* from, std::uint8_t* to, std::size_t count);

  /// FindDistances(row, count, work) replaces numbers, each of them 0 or LargestBlockDistance, by
  /// their distances from the nearest 0, at most that. `work`: 6 * count bytes, all of them
  /// LargestBlockDistance before the first call, and left to the next one.
  void (*FindDistances)(std::uint8_t* row, std::size_t count, std::uint8_t* work);

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
DistanceSteps GetDistanceSteps();
///@}

} // namespace ffd

#endif
