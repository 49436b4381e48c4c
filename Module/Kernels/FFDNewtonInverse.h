// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDNewtonInverse_h
#define FFDNewtonInverse_h

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace ffd
{

/**
 * q with T(q) = p by Newton's method, for a map T that displaces points: map(q, jacobian) gives
 * T(q) and its Jacobian. A step that brings T(q) no nearer to p is halved. Ends within `tolerance`
 * of p, after `iterations`, or where no step helps; the best point is given, which is never farther
 * off than 2 p - T(p) unless that is farther off than p.
 */
template <class Map>
glm::dvec3 FindInverse(const Map& map, const glm::dvec3& p, double tolerance, int iterations)
{
  glm::dmat3 jacobian;
  glm::dvec3 best = p;
  glm::dvec3 residual = map(best, jacobian) - p;
  const auto improve = [&](const glm::dvec3& candidate) {
    glm::dmat3 slope;
    const glm::dvec3 off = map(candidate, slope) - p;
    if (!(glm::length(off) < glm::length(residual)))
    {
      return false;
    }
    best = candidate;
    residual = off;
    jacobian = slope;
    return true;
  };
  improve(p - residual);
  constexpr double smallestStep = 1e-3;
  for (int i = 0; i < iterations && glm::length(residual) > tolerance; ++i)
  {
    const double determinant = glm::determinant(jacobian);
    const glm::dvec3 step =
      std::abs(determinant) > 0.0 ? glm::inverse(jacobian) * residual : residual;
    double part = 1.0;
    while (part > smallestStep && !improve(best - part * step))
    {
      part *= 0.5;
    }
    if (part <= smallestStep)
    {
      break;
    }
  }
  return best;
}

} // namespace ffd

#endif
