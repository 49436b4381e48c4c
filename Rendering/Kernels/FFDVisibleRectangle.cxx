// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDVisibleRectangle.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ffd
{
namespace
{

/// A row of an image.
class PixelRow
{
public:
  /// `colors`: from the column `first` on.
  PixelRow(const float* colors, int first)
    : Colors(colors)
    , First(first)
  {
  }

  /// The first visible pixel of [first, end), or end.
  int FindFirst(int first, int end) const
  {
    while (first + Together <= end && !this->IsAnyVisible<Together>(first))
    {
      first += Together;
    }
    while (first < end && !this->IsAnyVisible<1>(first))
    {
      ++first;
    }
    return first;
  }

  /// One past the last visible pixel of [first, end), or first.
  int FindEnd(int first, int end) const
  {
    while (first + Together <= end && !this->IsAnyVisible<Together>(end - Together))
    {
      end -= Together;
    }
    while (first < end && !this->IsAnyVisible<1>(end - 1))
    {
      --end;
    }
    return end;
  }

private:
  static constexpr int Together = 8; ///< pixels looked at in one step

  template <int Count>
  bool IsAnyVisible(int first) const
  {
    std::uint64_t halves[2 * Count]; // of pixels
    std::memcpy(
      halves, this->Colors + 4 * static_cast<std::size_t>(first - this->First), sizeof(halves));
    std::uint64_t any = 0;
    for (const std::uint64_t half : halves)
    {
      any |= half;
    }
    return any != 0;
  }

  const float* Colors;
  int First;
};

} // namespace

//------------------------------------------------------------------------------
void VisibleRectangle::AddPixels(
  const float* colors, int width, const glm::ivec2& first, const glm::ivec2& end)
{
  for (int y = first.y; y < end.y; ++y)
  {
    const std::size_t before =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(y - first.y);
    const PixelRow row(colors + 4 * before, first.x);
    // Columns [inner, outer) of these are within the rectangle.
    const int inner = std::clamp(this->Low.x, first.x, end.x);
    const int outer = std::clamp(this->High.x, inner, end.x);
    const int low = row.FindFirst(first.x, inner);
    const int high = row.FindEnd(outer, end.x);
    const bool isBeside = low < inner || high > outer;
    const bool isInside = this->Low.y <= y && y < this->High.y;
    if (!isInside && (isBeside || row.FindFirst(inner, outer) < outer))
    {
      this->Low.y = std::min(this->Low.y, y);
      this->High.y = std::max(this->High.y, y + 1);
    }
    if (low < inner)
    {
      this->Low.x = low;
      this->High.x = std::max(this->High.x, row.FindEnd(low, inner));
    }
    if (high > outer)
    {
      this->High.x = high;
    }
  }
}

} // namespace ffd
