// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBSplineBasis_h
#define FFDBSplineBasis_h

#include <algorithm>
#include <cmath>

namespace ffd
{

/// Weights of the four control points of a cell, uniform cubic B-spline, 0 <= u <= 1.
inline void BSplineWeights(double u, double w[4])
{
  const double v = 1.0 - u;
  const double u2 = u * u;
  const double u3 = u2 * u;
  w[0] = v * v * v / 6.0;
  w[1] = (4.0 - 6.0 * u2 + 3.0 * u3) / 6.0;
  w[2] = (1.0 + 3.0 * u + 3.0 * u2 - 3.0 * u3) / 6.0;
  w[3] = u3 / 6.0;
}

/// Derivatives of those weights by u.
inline void BSplineDerivativeWeights(double u, double w[4])
{
  const double v = 1.0 - u;
  const double u2 = u * u;
  w[0] = -0.5 * v * v;
  w[1] = 1.5 * u2 - 2.0 * u;
  w[2] = 0.5 + u - 1.5 * u2;
  w[3] = 0.5 * u2;
}

/// Their second derivatives by u.
inline void BSplineSecondDerivativeWeights(double u, double w[4])
{
  w[0] = 1.0 - u;
  w[1] = 3.0 * u - 2.0;
  w[2] = 1.0 - 3.0 * u;
  w[3] = u;
}

/// Cell and position in it of a clamped parameter on one axis.
struct AxisPosition
{
  int Cell;
  double U;
  bool Constant; ///< the parameter was outside: no variation along this axis
};

/// `lo` and `hi`: whole numbers, the first cell and one past the last.
inline AxisPosition LocateOnAxis(double x, double lo, double hi)
{
  const bool inside = x > lo && x < hi;
  // Written so that NaN goes to lo, too: no index is ever computed from it.
  const double c = inside ? x : (x >= hi ? hi : lo);
  const int cell = std::min(static_cast<int>(std::floor(c)), static_cast<int>(hi) - 1);
  return { cell, c - cell, !inside };
}

} // namespace ffd

#endif
