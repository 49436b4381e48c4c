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

/// Whether a matrix has no inverse to working precision, or is not finite. The determinant is
/// compared with the lengths of the columns: a small scale is no collapse.
inline bool IsSingular(const glm::dmat3& m)
{
  const double determinant = std::abs(glm::determinant(m));
  const double scale = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
  return !(determinant > 1e-12 * scale) || !std::isfinite(scale);
}

} // namespace ffd

#endif
