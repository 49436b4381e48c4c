// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTransferInterval_h
#define FFDTransferInterval_h

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ffd
{

/**
 * An entry of a transfer function and the next one, in the form that the packet kernels read: a
 * single load of 128 bits gives what they interpolate. Extinctions and opacities are as precise as
 * they were: where a ray ends depends on them. Colors have ten bits, 0.13 of 255 apart from what
 * they were at most.
 */
struct TransferInterval
{
  static constexpr int ColorBits = 10;
  static constexpr int LargestColor = (1 << ColorBits) - 1;

  float Ends[2];           ///< extinctions or opacities
  std::uint32_t Colors[2]; ///< red in the lowest bits, green, blue

  /// `rgb`: in [0, 1] (clamped).
  static std::uint32_t PackColor(const float rgb[3])
  {
    std::uint32_t packed = 0;
    for (int c = 0; c < 3; ++c)
    {
      const float whole = static_cast<float>(LargestColor) * std::clamp(rgb[c], 0.0f, 1.0f);
      packed |= static_cast<std::uint32_t>(std::lround(whole)) << ColorBits * c;
    }
    return packed;
  }
};
static_assert(sizeof(TransferInterval) == 16, "intervals are loaded as 128 bits");

} // namespace ffd

#endif
