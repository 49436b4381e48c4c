// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDEighthPowers_h
#define FFDEighthPowers_h

#include <cmath>
#include <cstdint>
#include <cstring>

namespace ffd
{

/// 2^(-power / 8).
inline float EighthPower(int power) { return std::exp2(-0.125f * static_cast<float>(power)); }

/**
 * The largest power with 2^(power / 8) <= ratio, for 1 <= ratio, infinite ones included: the power
 * of a code that must not be below `largest / ratio`. Right up to the rounding of the thresholds,
 * for which whoever uses it has to allow. Far cheaper than a logarithm.
 */
inline int FindEighthPower(float ratio)
{
  std::uint32_t bits;
  std::memcpy(&bits, &ratio, sizeof(bits));
  const int exponent = static_cast<int>(bits >> 23) - 127;
  bits = (bits & 0x007fffffu) | 0x3f800000u;
  float mantissa; // from 1 to 2
  std::memcpy(&mantissa, &bits, sizeof(mantissa));
  int eighths = 0;
  for (const float threshold :
    { 1.0905077f, 1.1892071f, 1.2968396f, 1.4142136f, 1.5422108f, 1.6817928f, 1.8340081f })
  {
    eighths += mantissa >= threshold ? 1 : 0;
  }
  return 8 * exponent + eighths;
}

} // namespace ffd

#endif
