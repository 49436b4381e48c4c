// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketTable_h
#define FFDPacketTable_h

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace ffd
{

/**
 * Transfer table in the form that the packet kernels read: a single load of 128 bits gives what
 * they interpolate between an entry and the next one. Extinctions are as precise as they were:
 * where a ray ends depends on them. Colours have ten bits, 0.13 of 255 apart from what they were at
 * most.
 */
class PacketTable
{
public:
  static constexpr int ColourBits = 10;
  static constexpr int LargestColour = (1 << ColourBits) - 1;

  struct Interval
  {
    std::uint32_t Extinctions[2]; ///< floats, of the entry and of the next one
    std::uint32_t Colours[2];     ///< red in the lowest bits, green, blue
  };
  static_assert(sizeof(Interval) == 16, "intervals are loaded as 128 bits");

  PacketTable() = default;

  /// `entries`: red, green, blue, extinction of each.
  PacketTable(const float* entries, std::size_t size)
    : Intervals(size - 1)
  {
    for (std::size_t i = 0; i < this->Intervals.size(); ++i)
    {
      for (std::size_t end = 0; end < 2; ++end)
      {
        const float* entry = entries + 4 * (i + end);
        std::memcpy(&this->Intervals[i].Extinctions[end], entry + 3, sizeof(float));
        this->Intervals[i].Colours[end] = ColourOf(entry[0]) | ColourOf(entry[1]) << ColourBits |
          ColourOf(entry[2]) << 2 * ColourBits;
      }
    }
  }

  const std::uint32_t* GetWords() const { return this->Intervals[0].Extinctions; }
  int GetNumberOfIntervals() const { return static_cast<int>(this->Intervals.size()); }

private:
  static std::uint32_t ColourOf(float channel)
  {
    return static_cast<std::uint32_t>(
      std::lround(static_cast<float>(LargestColour) * std::clamp(channel, 0.0f, 1.0f)));
  }

  std::vector<Interval> Intervals;
};

} // namespace ffd

#endif
