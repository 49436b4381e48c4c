// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketTable_h
#define FFDPacketTable_h

#include "FFDTransferTable.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace ffd
{

/**
 * Transfer tables in the form that the packet kernels read: a single load of 128 bits gives what
 * they interpolate between an entry and the next one. Extinctions are as precise as they were:
 * where a ray ends depends on them. Colors have ten bits, 0.13 of 255 apart from what they were at
 * most.
 */
class PacketTable
{
public:
  static constexpr int ColorBits = 10;
  static constexpr int LargestColor = (1 << ColorBits) - 1;

  struct Interval
  {
    std::uint32_t Extinctions[2]; ///< floats, of the entry and of the next one, GetInterpolated()
    std::uint32_t Colors[2];      ///< red in the lowest bits, green, blue
  };
  static_assert(sizeof(Interval) == 16, "intervals are loaded as 128 bits");

  /// The position of a table and the range of its values; loaded as 128 bits, too.
  struct Range
  {
    std::int32_t First; ///< interval
    float Intervals;    ///< number of intervals
    float Low;          ///< value of the first entry
    float Scale;        ///< entries a unit of values
  };
  static_assert(sizeof(Range) == 16, "ranges are loaded as 128 bits");

  /// Another table behind those that there are. `low`: the value of its first entry; `scale`:
  /// entries a unit of values.
  void Add(const TransferTable& table, float low, float scale)
  {
    const float* const entries = table.GetEntries();
    const std::size_t size = table.GetSize();
    this->Ranges.push_back({ static_cast<std::int32_t>(this->Intervals.size()),
      static_cast<float>(size - 1), low, scale });
    for (std::size_t i = 0; i + 1 < size; ++i)
    {
      Interval interval;
      for (std::size_t end = 0; end < 2; ++end)
      {
        const float* entry = entries + 4 * (i + end);
        const float* neighbor = entries + 4 * (i + 1 - end);
        const float extinction = table.GetInterpolated(entry[3], neighbor[3]);
        std::memcpy(&interval.Extinctions[end], &extinction, sizeof(float));
        interval.Colors[end] =
          ColorOf(entry[0]) | ColorOf(entry[1]) << ColorBits | ColorOf(entry[2]) << 2 * ColorBits;
      }
      this->Intervals.push_back(interval);
    }
  }

  /// What is interpolated between the ends of an interval: opacities over a length, which may be
  /// below zero as GetInterpolated() is.
  struct OpacityPair
  {
    float Ends[2];
  };

  /// Finds the opacities of a table over a length, in data units.
  void FindOpacities(std::size_t table, double length)
  {
    const Range& range = this->Ranges[table];
    this->Opacities.resize(this->Intervals.size());
    const auto find = [length](std::uint32_t word) {
      float extinction;
      std::memcpy(&extinction, &word, sizeof(float));
      return static_cast<float>(
        -std::expm1(-std::log(2.0) * static_cast<double>(extinction) * length));
    };
    const std::size_t first = static_cast<std::size_t>(range.First);
    const std::size_t end = first + static_cast<std::size_t>(range.Intervals);
    for (std::size_t i = first; i < end; ++i)
    {
      const std::uint32_t* const extinctions = this->Intervals[i].Extinctions;
      this->Opacities[i] = { { find(extinctions[0]), find(extinctions[1]) } };
    }
  }

  const OpacityPair* GetOpacities() const { return this->Opacities.data(); }

  const std::uint32_t* GetWords() const { return this->Intervals[0].Extinctions; }
  std::size_t GetSize() const { return this->Ranges.size(); }
  const Range& GetRange(std::size_t table) const { return this->Ranges[table]; }
  const Range* GetRanges() const { return this->Ranges.data(); }

private:
  static std::uint32_t ColorOf(float channel)
  {
    return static_cast<std::uint32_t>(
      std::lround(static_cast<float>(LargestColor) * std::clamp(channel, 0.0f, 1.0f)));
  }

  std::vector<Range> Ranges;
  std::vector<Interval> Intervals;
  std::vector<OpacityPair> Opacities; // of the intervals, where FindOpacities() was asked for them
};

} // namespace ffd

#endif
