// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSingularMatrix_h
#define FFDSingularMatrix_h

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace ffd
{

/// Whether a matrix has no inverse to working precision, or one of them is not finite. The
/// determinant is compared with the lengths of the columns: a small scale is no collapse, unless
/// its reciprocal overflows.
inline bool IsSingular(const glm::dmat3& m)
{
  const double determinant = std::abs(glm::determinant(m));
  const double scale = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
  const glm::dmat3 inverse = glm::inverse(m);
  const double inverseScale =
    glm::length(inverse[0]) + glm::length(inverse[1]) + glm::length(inverse[2]);
  return !(determinant > 1e-12 * scale) || !std::isfinite(scale) || !std::isfinite(inverseScale);
}

} // namespace ffd

#endif
