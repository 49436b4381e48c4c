// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRayDeflector_h
#define FFDRayDeflector_h

#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace ffd
{

/**
 * A deflector after Kurzion and Yagel, "Space Deformation using Ray Deflectors", 1995: reference
 * [10] of the paper. Within a sphere space is moved, most at its center and not at all at its
 * border, by the weight a = (1 - (distance / Radius)^2)^3, which has two continuous derivatives.
 */
struct FFD_CORE_EXPORT RayDeflector
{
  enum class Shape
  {
    Translate, ///< X + a * Vector
    Rotate,    ///< turned by a * Angle about the axis Vector through Center
    Scale      ///< Center + (1 + a * (Factor - 1)) * (X - Center)
  };

  Shape Kind = Shape::Translate;
  glm::dvec3 Center{ 0.0 };
  double Radius = 1.0;
  glm::dvec3 Vector{ 0.0, 0.0, 1.0 };
  double Angle = 0.0; ///< radians
  double Factor = 1.0;

  glm::dvec3 Forward(const glm::dvec3& p) const;
  /// The Jacobian as [column][row].
  glm::dvec3 Forward(const glm::dvec3& p, glm::dmat3& jacobian) const;
  /// In closed form (Rotate), or by a bracketed search in one unknown; one of the solutions where
  /// the deflector folds.
  glm::dvec3 Inverse(const glm::dvec3& p) const;

  /// Whether the map is one-to-one; decided by the largest slope of the weight.
  bool IsFoldFree() const;

private:
  /// Weight at a distance from the center, in radii.
  static double FindWeight(double distance);
  /// The weight and its gradient.
  double FindWeight(const glm::dvec3& fromCenter, glm::dvec3& gradient) const;
};

} // namespace ffd

#endif
