// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTransferTable_h
#define FFDTransferTable_h

#include "FFDExport.h"

#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace ffd
{

/// Where the entries of a table are: `Size` of them at equal steps from Low to High.
struct TableLayout
{
  double Low;
  double High;
  int Size;
};

/**
 * Lays out a table of functions for scalars from `low` to `high`. They are constant beyond [first,
 * last], where no entries are spent, so that a few extreme scalars do not coarsen the table; first
 * > last: nowhere. estimate(lo, hi) returns how many equal steps the functions need there.
 * changes(at, beyond) tells whether they differ: where scalars go beyond an end at which functions
 * have a step there is one entry more.
 */
FFD_VOLUMES_EXPORT TableLayout LayOutTable(double low, double high, double first, double last,
  const std::function<int(double, double)>& estimate,
  const std::function<bool(double, double)>& changes);

/// Opacity of an interval of a length, data units, by its extinction per data unit.
inline double OpacityOver(double extinction, double length)
{
  return -std::expm1(-extinction * length * 0.69314718055994531);
}

/**
 * Color and extinction over the scalar range, sampled at equal steps and interpolated linearly.
 *
 * Extinction is stored as -log2(1 - opacity) per data unit, so that the opacity of an interval of
 * any length is 1 - 2^(-extinction * length): the opacity correction of section 4.4 of the paper
 * (its reference [20]) for every interval, the last one of a segment included.
 */
class FFD_VOLUMES_EXPORT TransferTable
{
public:
  /// Extinction of full opacity over an interval, by its length: opaque over any that is longer
  /// than a millionth of it.
  static constexpr double OpaqueExtinction = 2.4e7;

  TransferTable() = default;

  /**
   * `rgb`: 3 * size colors, `opacity`: size opacities in [0, 1] for an interval of
   * `unitDistance` (> 0, data units), both at `size` >= 2 equal steps from scalar `lo` to
   * scalar `hi` (lo < hi). Opacities are clamped; values that are not a number count as 0.
   */
  TransferTable(double lo, double hi, std::size_t size, const float* rgb, const float* opacity,
    double unitDistance);

  struct Sample
  {
    glm::vec3 Color;
    float Extinction; ///< per data unit; 0: transparent
  };

  /// Entry of a scalar; scalars outside of the range get the first or last entry, a scalar that
  /// is not a number a transparent one.
  Sample Lookup(double scalar) const;

  /// Whether every scalar of [lo, hi], and beyond it by less than GetMargin(), is fully
  /// transparent; true for an empty interval.
  bool IsTransparent(double lo, double hi) const;

  std::size_t GetMemorySize() const;

  /// Whether IsTransparent() says the same of both for all scalars: tables of other colors or
  /// other opacities where something is visible at all.
  bool HasSameVisibility(const TransferTable& other) const
  {
    return this->Low == other.Low && this->Scale == other.Scale &&
      this->VisibleUpTo == other.VisibleUpTo;
  }

  /// The table itself: red, green, blue, extinction of each entry; entry i stands for the scalar
  /// GetLow() + i / GetScale().
  const float* GetEntries() const { return &this->Entries[0].Color.x; }
  std::size_t GetSize() const { return this->Entries.size(); }
  double GetLow() const { return this->Low; }
  double GetScale() const { return this->Scale; }
  double GetUnitDistance() const { return this->UnitDistance; }

  /// Scalars this near to a transparent entry, in entries, are transparent, too. In single
  /// precision an interpolated one may leave the limits of its voxels by less: IsTransparent()
  /// holds for it.
  float GetMargin() const { return this->Margin; }

  /// The extinction at an entry from which that of scalars towards a neighbor is interpolated; what
  /// is below 0 then is 0, as within the margin.
  float GetInterpolated(float extinction, float ofNeighbor) const
  {
    return extinction > 0.0f ? extinction : -this->Margin / (1.0f - this->Margin) * ofNeighbor;
  }

private:
  struct Entry
  {
    glm::vec3 Color;
    float Extinction;
  };
  static_assert(sizeof(Entry) == 4 * sizeof(float), "entries are read as an array of floats");

  double Low = 0.0;
  double Scale = 0.0; // entries per scalar unit
  double UnitDistance = 1.0;
  float Margin = 0.0f;
  std::vector<Entry> Entries;
  std::vector<unsigned int> VisibleUpTo; // number of non-transparent entries before each
};

/**
 * Table of 2^-x: the transmittance of an optical depth x >= 0 in powers of two. Linear between
 * entries; error below 2e-6, zero beyond 24.
 */
class FFD_VOLUMES_EXPORT TransmittanceTable
{
public:
  TransmittanceTable();
  float operator()(float opticalDepth) const;

private:
  static constexpr int EntriesPerUnit = 256;
  static constexpr int Range = 24;

  static std::vector<float> MakeEntries();

  const float* Entries; // the same of all
};

} // namespace ffd

#endif
