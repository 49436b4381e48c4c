// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDUniformSpline_h
#define FFDUniformSpline_h

#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/**
 * A uniform B-spline field D of degree Order, 1 to 3, and the map T(X) = X + D(X); slow and
 * general, for what registration tools write besides cubic splines (BSplineField is for those).
 * Control point (i, j, k) rests at Origin + (i, j, k) * Spacing; its weight is the product of
 * centered B-splines of the distance in spacings. Beyond the grid control points are zero, or
 * repeated (Repeat). Without control points T is the identity.
 */
struct FFD_CORE_EXPORT UniformSpline
{
  int Order = 2;
  glm::ivec3 Size{ 0 };
  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 Spacing{ 1.0 };
  std::vector<glm::dvec3> Values; // x fastest
  bool Repeat = false;

  /// T(p), and its Jacobian: column b holds dT/dp_b.
  glm::dvec3 Forward(const glm::dvec3& p) const;
  glm::dvec3 Forward(const glm::dvec3& p, glm::dmat3& jacobian) const;
};

} // namespace ffd

#endif
