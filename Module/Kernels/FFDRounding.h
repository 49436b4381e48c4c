// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRounding_h
#define FFDRounding_h

#include <algorithm>
#include <cmath>
#include <limits>

namespace ffd
{

/// The least float that is not below `value`: floats compare with it as they do with `value`, and
/// an upper bound stays one. Values above the largest float give infinity.
inline float RoundUp(double value)
{
  const float rounded = static_cast<float>(value);
  return static_cast<double>(rounded) < value
    ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
    : rounded;
}

/// The largest float that is not above `value`: a lower bound stays one.
inline float RoundDown(double value) { return -RoundUp(-value); }

/// What is beyond this is made less in single precision, which holds ten times as much.
constexpr double LargestSingle = 1e37;

/// A number in single precision, finite unless it is not a number.
inline float ToFinite(double value)
{
  return static_cast<float>(std::clamp(value, -LargestSingle, LargestSingle));
}

/// A number in single precision; one that is finite stays so, however large.
inline float ToSingle(double value)
{
  return std::isinf(value) ? static_cast<float>(value) : ToFinite(value);
}

} // namespace ffd

#endif
