// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDIntervalTable.h"

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Of an interval whose values are all opaque.
constexpr double LargestOpticalDepth = 256.0;

/// Differences of integrals are signed numbers of 32 bits.
constexpr double LargestIntegral = 2147480000.0;

/// Packets have them in single precision.
constexpr double LargestUnits = 1e30;

/// Of IsSteep().
constexpr std::size_t SteepParts = 32;
constexpr double SteepChange = 0.25;

/// Optical depths below this have no place that matters.
constexpr double LeastOpticalDepth = 1e-6;

constexpr double LogarithmOfTwo = 0.69314718;

double OpacityOf(double opticalDepth) { return 1.0 - std::exp2(-opticalDepth); }

/// Mean place, 0 to 1, that the light of a homogeneous interval comes from: 1/2 if it is thin,
/// 1 / (its depth in powers of e) if it is thick, and within 0.03 of the truth between them.
double FindPlaceOfLight(double opticalDepth)
{
  const double depth = LogarithmOfTwo * opticalDepth;
  return 1.0 / std::sqrt(4.0 + depth * (4.0 / 3.0 + depth));
}

/// n for opacities n / (1 + n): the first terms of a power series.
double WeighOpacity(double opticalDepth)
{
  const double depth = LogarithmOfTwo * opticalDepth;
  return depth * (1.0 + 0.5 * depth);
}

/// The place that light comes from if the optical depth would be `front` and `back` with the
/// extinctions at the ends, one of which changes into the other at once.
double FindPlaceOfLight(double front, double back, double opticalDepth)
{
  if (!(opticalDepth > std::min(front, back) && opticalDepth < std::max(front, back)))
  {
    return FindPlaceOfLight(opticalDepth);
  }
  const double change = (back - opticalDepth) / (back - front);
  const double depths[2] = { front * change, back * (1.0 - change) };
  const double first = WeighOpacity(depths[0]);
  const double behind = WeighOpacity(depths[1]);
  const double second = behind / (1.0 + behind);
  return first + second > LeastOpticalDepth
    ? (first * change * FindPlaceOfLight(depths[0]) +
        second * (change + (1.0 - change) * FindPlaceOfLight(depths[1]))) /
      (first + second)
    : 0.5;
}

/// The optical depth in an interval from which its light comes, in the mean. That does not depend
/// on where in the interval the extinction is.
double FindDepthOfLight(double opticalDepth)
{
  return opticalDepth * FindPlaceOfLight(opticalDepth);
}

/// The place, 0 to 1, where the optical depth in an interval is `depth`, at most `opticalDepth`,
/// that of all. `front` and `back`: those with the extinctions at the ends, one of which changes
/// into the other at once.
double FindPlaceOfDepth(double front, double back, double opticalDepth, double depth)
{
  double change = 0.0;
  double all = opticalDepth;
  if (opticalDepth > std::min(front, back) && opticalDepth < std::max(front, back))
  {
    change = (back - opticalDepth) / (back - front);
    const bool behind = depth > front * change;
    all = behind ? back : front;
    depth -= behind ? front * change : 0.0;
    change = behind ? change : 0.0;
  }
  return all > LeastOpticalDepth ? std::clamp(change + depth / all, 0.0, 1.0) : 0.5;
}

} // namespace

//------------------------------------------------------------------------------
IntervalTable::IntervalTable(const TransferTable& table, double length)
  : Table(&table)
  , LargestExtinction(LargestOpticalDepth / length)
{
  const float* const entries = table.GetEntries();
  const std::size_t size = table.GetSize();
  const auto extinctionAt = [&](std::size_t i) {
    return std::min(static_cast<double>(entries[4 * i + 3]), this->LargestExtinction);
  };
  std::vector<double> sums(size, 0.0);
  for (std::size_t i = 1; i < size; ++i)
  {
    sums[i] = sums[i - 1] + 0.5 * (extinctionAt(i - 1) + extinctionAt(i));
  }
  this->Units = sums.back() > 0.0 ? std::min(LargestIntegral / sums.back(), LargestUnits) : 1.0;
  this->Integrals.resize(size);
  for (std::size_t i = 0; i < size; ++i)
  {
    this->Integrals[i] = static_cast<std::uint32_t>(std::llround(sums[i] * this->Units));
  }
  // Extinctions are interpolated: from the entry before to the one behind, and beyond the table as
  // at its ends.
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  const auto valueAt = [&](std::size_t i) {
    return table.GetLow() + static_cast<double>(i) / table.GetScale();
  };
  for (std::size_t i = 0; i < size; ++i)
  {
    if (entries[4 * i + 3] > 0.0f)
    {
      this->VisibleLow = std::min(this->VisibleLow, i == 0 ? -Infinity : valueAt(i - 1));
      this->VisibleHigh = i + 1 == size ? Infinity : valueAt(i + 1);
    }
  }
}

//------------------------------------------------------------------------------
IntervalTable::Point IntervalTable::Find(double value) const
{
  const TransferTable& table = *this->Table;
  const double last = static_cast<double>(table.GetSize() - 1);
  Point point;
  point.Entry = std::clamp((value - table.GetLow()) * table.GetScale(), 0.0, last);
  const std::size_t i = std::min(static_cast<std::size_t>(point.Entry), table.GetSize() - 2);
  const float* const entry = table.GetEntries() + 4 * i;
  double f = point.Entry - static_cast<double>(i);
  const double margin = static_cast<double>(table.GetMargin());
  if (!(entry[3] > 0.0f) && f < margin)
  {
    f = 0.0;
  }
  else if (!(entry[7] > 0.0f) && f > 1.0 - margin)
  {
    f = 1.0;
  }
  point.Entry = static_cast<double>(i) + f;
  const double a = std::min(static_cast<double>(entry[3]), this->LargestExtinction);
  const double b = std::min(static_cast<double>(entry[7]), this->LargestExtinction);
  point.Extinction = a + f * (b - a);
  point.Integral = this->Integrals[i] +
    static_cast<std::uint32_t>(std::llround(this->Units * f * (a + 0.5 * f * (b - a))));
  return point;
}

//------------------------------------------------------------------------------
/// The mean extinction between two points.
double IntervalTable::FindExtinction(const Point& a, const Point& b) const
{
  const double entries = b.Entry - a.Entry;
  if (std::abs(entries) < NearEntries)
  {
    return 0.5 * (a.Extinction + b.Extinction);
  }
  const double integral = static_cast<double>(static_cast<std::int32_t>(b.Integral - a.Integral));
  return std::max(integral / (this->Units * entries), 0.0);
}

//------------------------------------------------------------------------------
/// Beyond the table everything looks as at its ends: values there, infinite ones, too, count as
/// these.
double IntervalTable::FindValue(const Point& a, const Point& b, double place) const
{
  return this->Table->GetLow() + (a.Entry + place * (b.Entry - a.Entry)) / this->Table->GetScale();
}

//------------------------------------------------------------------------------
ClassifiedInterval IntervalTable::Classify(const Point& a, const Point& b, double length) const
{
  const double depth = this->FindExtinction(a, b) * length;
  const double place = FindPlaceOfLight(a.Extinction * length, b.Extinction * length, depth);
  return { depth, this->FindValue(a, b, place), place };
}

//------------------------------------------------------------------------------
ClassifiedInterval IntervalTable::Classify(double front, double back, double length) const
{
  if (std::isnan(front) || std::isnan(back))
  {
    return { 0.0, front, 0.5 };
  }
  return this->Classify(this->Find(front), this->Find(back), length);
}

//------------------------------------------------------------------------------
ClassifiedInterval IntervalTable::Classify(
  double front, double middle, double back, double at, double length) const
{
  if (std::isnan(front) || std::isnan(middle) || std::isnan(back))
  {
    return { 0.0, middle, at };
  }
  const Point points[3] = { this->Find(front), this->Find(middle), this->Find(back) };
  const double lengths[2] = { at * length, (1.0 - at) * length };
  const double depths[2] = { lengths[0] * this->FindExtinction(points[0], points[1]),
    lengths[1] * this->FindExtinction(points[1], points[2]) };
  const double all = depths[0] + depths[1];
  const double depth = FindDepthOfLight(all);
  const int half = depth > depths[0] ? 1 : 0;
  const Point& from = points[half];
  const Point& to = points[half + 1];
  const double place = FindPlaceOfDepth(from.Extinction * lengths[half],
    to.Extinction * lengths[half], depths[half], half == 1 ? depth - depths[0] : depth);
  return { all, this->FindValue(from, to, place),
    half == 1 ? at + (1.0 - at) * place : at * place };
}

//------------------------------------------------------------------------------
bool IsSteep(const TransferTable& table, double length)
{
  // Of the parts of half that width, and of each and the next one.
  const std::size_t size = table.GetSize();
  double low[SteepParts + 1];
  double high[SteepParts + 1];
  std::fill_n(low, SteepParts + 1, 1.0);
  std::fill_n(high, SteepParts + 1, 0.0);
  for (std::size_t i = 0; i < size; ++i)
  {
    const double opacity = OpacityOf(static_cast<double>(table.GetEntries()[4 * i + 3]) * length);
    const std::size_t part = i * SteepParts / size;
    low[part] = std::min(low[part], opacity);
    high[part] = std::max(high[part], opacity);
  }
  for (std::size_t part = 0; part < SteepParts; ++part)
  {
    if (std::max(high[part], high[part + 1]) - std::min(low[part], low[part + 1]) > SteepChange)
    {
      return true;
    }
  }
  return false;
}

} // namespace ffd
