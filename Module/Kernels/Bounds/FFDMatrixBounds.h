// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDMatrixBounds_h
#define FFDMatrixBounds_h

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{

/// |m| entry by entry.
inline glm::dmat3 Absolute(const glm::dmat3& m)
{
  return glm::dmat3(glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2]));
}

/// The norm that belongs to the largest magnitude of vectors, of a matrix without negative entries.
inline double LargestRowSum(const glm::dmat3& m)
{
  const glm::dvec3 sums = m[0] + m[1] + m[2];
  return std::max({ sums.x, sums.y, sums.z });
}

/// Least and largest entries of matrices, as their middle and half their difference.
struct MatrixRange
{
  glm::dmat3 Center;
  glm::dmat3 Spread;
};

/**
 * The inverses of all matrices of a range. With J = C + E, |E| <= Delta entry-wise, W = |C^-1|
 * Delta: J^-1 - C^-1 = -C^-1 E J^-1, so |J^-1 - C^-1| <= (W + W^2 + ...) |C^-1| = (I - W)^-1 W
 * |C^-1| when the spectral radius of W is below one; the largest row or column sum proves that.
 * Returns false where it is not shown so, and where a determinant is not positive: space is turned
 * inside out.
 */
inline bool FindInverse(const MatrixRange& range, MatrixRange& inverse)
{
  const double determinant = glm::determinant(range.Center);
  // Also refuses what is not a number, and what is so near to singular that the inverse is
  // rounding.
  if (!(determinant > 1e-9 && determinant < 1e30))
  {
    return false;
  }
  inverse.Center = glm::inverse(range.Center);
  const glm::dmat3 size = Absolute(inverse.Center);
  const glm::dmat3 w = size * range.Spread;
  if (!(std::min(LargestRowSum(w), LargestRowSum(glm::transpose(w))) < 0.999))
  {
    return false;
  }
  inverse.Spread = glm::inverse(glm::dmat3(1.0) - w) * w * size;
  for (int column = 0; column < 3; ++column)
  {
    constexpr double rounding = 1e-9;
    inverse.Spread[column] += rounding * (1.0 + size[column]);
  }
  return true;
}

/// An upper bound of the norms of all matrices of a range: |A|_2 <= sqrt(|A|_1 |A|_inf).
inline double BoundNorm(const MatrixRange& range)
{
  const glm::dmat3 largest = Absolute(range.Center) + range.Spread;
  return std::sqrt(LargestRowSum(largest) * LargestRowSum(glm::transpose(largest)));
}

} // namespace ffd

#endif
