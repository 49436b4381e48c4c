// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTransferTable.h"

#include "FFDRounding.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

/// Extinctions end here, whatever the unit distance: interpolating infinite ones gives no number.
constexpr double LargestExtinction = 1e30;

/// Entries of a table: at least, and at most, but for one beyond each end.
constexpr int SmallestTable = 1024;
constexpr int LargestTable = 16384;

/// Least width of a table, by the larger one of its ends: a few double-precision numbers.
constexpr double LeastWidth = 1e-15;

/// Limits of GetMargin().
constexpr double LeastMargin = 1e-3;
constexpr double LargestMargin = 0.5;

float ExtinctionOf(float opacity, double unitDistance)
{
  // Written so that NaN counts as transparent.
  if (!(opacity > 0.0f))
  {
    return 0.0f;
  }
  const double perUnit = opacity >= 1.0f ? TransferTable::OpaqueExtinction
                                         : -std::log2(1.0 - static_cast<double>(opacity));
  return static_cast<float>(std::min(perUnit / unitDistance, LargestExtinction));
}

float ColorOf(float channel) { return channel > 0.0f ? std::min(channel, 1.0f) : 0.0f; }

} // namespace

//------------------------------------------------------------------------------
TableLayout LayOutTable(double low, double high, double first, double last,
  const std::function<int(double, double)>& estimate,
  const std::function<bool(double, double)>& changes)
{
  double lo = low;
  double hi = high;
  if (first <= last)
  {
    lo = std::min(std::max(lo, first), hi);
    hi = std::max(std::min(hi, last), lo);
  }
  if (!(hi - lo > LeastWidth * std::max(std::abs(lo), std::abs(hi))))
  {
    hi = lo + std::max(1.0, std::abs(lo));
  }
  int size = std::clamp(estimate(lo, hi), SmallestTable, LargestTable);
  const double width = std::ceil(hi) - std::floor(lo);
  const bool whole = hi - lo >= 1.0 && width < LargestTable;
  if (whole)
  {
    // A whole number of entries a unit: whole scalars, and the points of functions that lie there,
    // are met exactly.
    lo = std::floor(lo);
    hi = lo + width;
    const int perUnit = std::max(1, static_cast<int>(size / width));
    size = perUnit * static_cast<int>(width) + 1;
  }
  // At a point where a function has a step it has the value of one side.
  const double step = (hi - lo) / (size - 1);
  if (low < lo && changes(lo, lo - step))
  {
    lo -= step;
    ++size;
  }
  if (high > hi && changes(hi, hi + step))
  {
    hi += step;
    ++size;
  }
  if (!whole && std::abs(lo) < static_cast<double>(std::numeric_limits<float>::max()))
  {
    // Packets take differences to it in single precision.
    lo = static_cast<double>(RoundDown(lo));
  }
  return { lo, hi, size };
}

//------------------------------------------------------------------------------
TransferTable::TransferTable(double lo, double hi, std::size_t size, const float* rgb,
  const float* opacity, double unitDistance)
  : Low(lo)
  , Scale(static_cast<double>(size - 1) / (hi - lo))
  , UnitDistance(unitDistance)
{
  const double largest =
    std::max(std::max(std::abs(lo), std::abs(hi)) * this->Scale, static_cast<double>(size));
  this->Margin = static_cast<float>(
    std::clamp(4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest,
      LeastMargin, LargestMargin));
  this->Entries.resize(size);
  this->VisibleUpTo.assign(size + 1, 0);
  for (std::size_t i = 0; i < size; ++i)
  {
    this->Entries[i] = { glm::vec3(
                           ColorOf(rgb[3 * i]), ColorOf(rgb[3 * i + 1]), ColorOf(rgb[3 * i + 2])),
      ExtinctionOf(opacity[i], unitDistance) };
    this->VisibleUpTo[i + 1] =
      this->VisibleUpTo[i] + (this->Entries[i].Extinction > 0.0f ? 1u : 0u);
  }
}

//------------------------------------------------------------------------------
TransferTable::Sample TransferTable::Lookup(double scalar) const
{
  if (std::isnan(scalar))
  {
    return { this->Entries[0].Color, 0.0f };
  }
  const double last = static_cast<double>(this->Entries.size() - 1);
  const double x = std::clamp((scalar - this->Low) * this->Scale, 0.0, last);
  const std::size_t i = std::min(static_cast<std::size_t>(x), this->Entries.size() - 2);
  const float f = static_cast<float>(x - static_cast<double>(i));
  const Entry& a = this->Entries[i];
  const Entry& b = this->Entries[i + 1];
  const float from = this->GetInterpolated(a.Extinction, b.Extinction);
  const float to = this->GetInterpolated(b.Extinction, a.Extinction);
  return { a.Color + f * (b.Color - a.Color), std::max(0.0f, from + f * (to - from)) };
}

//------------------------------------------------------------------------------
bool TransferTable::IsTransparent(double lo, double hi) const
{
  if (!(lo <= hi))
  {
    return true;
  }
  const double last = static_cast<double>(this->Entries.size() - 1);
  const double from = std::clamp((lo - this->Low) * this->Scale, 0.0, last);
  const double to = std::clamp((hi - this->Low) * this->Scale, 0.0, last);
  // Entries from that below `from` to that above `to`.
  const std::size_t below = static_cast<std::size_t>(to);
  const std::size_t end = static_cast<double>(below) < to ? below + 2 : below + 1;
  return this->VisibleUpTo[end] == this->VisibleUpTo[static_cast<std::size_t>(from)];
}

//------------------------------------------------------------------------------
std::size_t TransferTable::GetMemorySize() const
{
  return this->Entries.capacity() * sizeof(Entry) +
    this->VisibleUpTo.capacity() * sizeof(unsigned int);
}

//------------------------------------------------------------------------------
TransmittanceTable::TransmittanceTable()
{
  static const std::vector<float> entries = MakeEntries();
  this->Entries = entries.data();
}

//------------------------------------------------------------------------------
std::vector<float> TransmittanceTable::MakeEntries()
{
  std::vector<float> entries(Range * EntriesPerUnit + 2, 0.0f);
  for (int i = 0; i < Range * EntriesPerUnit; ++i)
  {
    entries[i] = std::exp2(-static_cast<float>(i) / EntriesPerUnit);
  }
  return entries;
}

//------------------------------------------------------------------------------
float TransmittanceTable::operator()(float opticalDepth) const
{
  // In this order what is not a number becomes the last entry.
  const float x =
    std::min(static_cast<float>(Range * EntriesPerUnit), opticalDepth * EntriesPerUnit);
  const int i = static_cast<int>(x);
  const float f = x - static_cast<float>(i);
  return this->Entries[i] + f * (this->Entries[i + 1] - this->Entries[i]);
}

} // namespace ffd
