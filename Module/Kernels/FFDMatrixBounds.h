// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDMatrixBounds_h
#define FFDMatrixBounds_h

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <algorithm>

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

} // namespace ffd

#endif
