// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketTable_h
#define FFDPacketTable_h

#include "FFDTransferTable.h"
#include "Optics/FFDTransferInterval.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/// Transfer tables in the form that the packet kernels read; extinctions are GetInterpolated().
class PacketTable
{
public:
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
      TransferInterval interval;
      for (std::size_t end = 0; end < 2; ++end)
      {
        const float* entry = entries + 4 * (i + end);
        const float* neighbor = entries + 4 * (i + 1 - end);
        interval.Ends[end] = table.GetInterpolated(entry[3], neighbor[3]);
        interval.Colors[end] = TransferInterval::PackColor(entry);
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
    const auto find = [length](float extinction) {
      return static_cast<float>(OpacityOver(static_cast<double>(extinction), length));
    };
    const std::size_t first = static_cast<std::size_t>(range.First);
    const std::size_t end = first + static_cast<std::size_t>(range.Intervals);
    for (std::size_t i = first; i < end; ++i)
    {
      const float* const extinctions = this->Intervals[i].Ends;
      this->Opacities[i] = { { find(extinctions[0]), find(extinctions[1]) } };
    }
  }

  const OpacityPair* GetOpacities() const { return this->Opacities.data(); }

  const TransferInterval* GetIntervals() const { return this->Intervals.data(); }
  std::size_t GetSize() const { return this->Ranges.size(); }
  const Range& GetRange(std::size_t table) const { return this->Ranges[table]; }
  const Range* GetRanges() const { return this->Ranges.data(); }

private:
  std::vector<Range> Ranges;
  std::vector<TransferInterval> Intervals;
  std::vector<OpacityPair> Opacities; // of the intervals, where FindOpacities() was asked for them
};

} // namespace ffd

#endif
