// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDIntervalTable_h
#define FFDIntervalTable_h

#include "FFDExport.h"
#include "FFDTransferTable.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace ffd
{

/// Optical properties of an interval of a ray.
struct ClassifiedInterval
{
  double OpticalDepth; ///< the part of light that passes is 2 to the power of less than that
  double Value;        ///< the scalar at Place
  double Place;        ///< where the light comes from, in the mean: from 0, the front end, to 1
};

/**
 * Pre-integrated classification (Engel, Kraus, Ertl 2001): the effect of an interval of a ray
 * between values that are known, over which scalars run linearly. It follows from the integral of
 * the extinction over the scalars, a table of the size of the transfer table: it holds for all
 * scalar types, and is made in the time of a transfer table. The difference of two entries is the
 * extinction of an interval, exactly. As light from behind is attenuated, it comes from one optical
 * depth in the mean, whatever the scalars are; where that is follows from the extinctions at the
 * ends, as if the one changed into the other at once: true for steps, and near the truth where a
 * function is steep.
 *
 * Integrals are fixed-point numbers modulo 2^32: their difference is as exact behind values that
 * are opaque as elsewhere.
 */
class FFD_RENDERING_EXPORT IntervalTable
{
public:
  IntervalTable() = default;

  /// `length`: of intervals, about, data units. `table` must outlive this one.
  IntervalTable(const TransferTable& table, double length);

  bool IsEmpty() const { return this->Integrals.empty(); }

  /// Values from `front` to `back` over `length`, data units. What is not a number makes the
  /// interval transparent.
  ClassifiedInterval Classify(double front, double back, double length) const;

  /// The same of two intervals, with the value `middle` at the place `at`, 0 to 1, between them.
  ClassifiedInterval Classify(
    double front, double middle, double back, double at, double length) const;

  /**
   * Whether scalars between two samples may be visible, the samples themselves being so or not:
   * what is between two voxels may be beyond the values at both ends, by as much as they differ.
   */
  bool MayShow(double front, double back) const
  {
    const double difference = front < back ? back - front : front - back;
    const double low = (front < back ? front : back) - difference;
    const double high = (front < back ? back : front) + difference;
    return high >= this->VisibleLow && low <= this->VisibleHigh;
  }

  /// The least and the largest scalar that may be visible.
  double GetVisibleLow() const { return this->VisibleLow; }
  double GetVisibleHigh() const { return this->VisibleHigh; }

  /// Extinctions are at most this, per data unit: an interval is opaque where a small part of it
  /// is.
  double GetLargestExtinction() const { return this->LargestExtinction; }

  /// The integral up to each entry of the transfer table, of the extinction by entries, modulo
  /// 2^32. GetUnits() stand for 1.
  const std::uint32_t* GetIntegrals() const { return this->Integrals.data(); }
  double GetUnits() const { return this->Units; }

  /// Scalars that are nearer than this, in entries, are classified by the mean of their
  /// extinctions.
  static constexpr double NearEntries = 0.25;

  std::size_t GetMemorySize() const { return this->Integrals.capacity() * sizeof(std::uint32_t); }

private:
  struct Point
  {
    double Entry;      ///< of the transfer table, and its fraction
    double Extinction; ///< per data unit
    std::uint32_t Integral;
  };
  Point Find(double value) const;
  double FindExtinction(const Point& a, const Point& b) const;
  double FindValue(const Point& a, const Point& b, double place) const;
  ClassifiedInterval Classify(const Point& a, const Point& b, double length) const;

  const TransferTable* Table = nullptr;
  double LargestExtinction = 0.0;
  double Units = 1.0;
  double VisibleLow = std::numeric_limits<double>::infinity();
  double VisibleHigh = -std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> Integrals;
};

/**
 * Whether samples show rings: whether, over a sixteenth of the range of a table, the opacity of an
 * interval of `length`, data units, changes by more than a quarter.
 */
FFD_RENDERING_EXPORT bool IsSteep(const TransferTable& table, double length);

} // namespace ffd

#endif
