// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBarrDeformation_h
#define FFDBarrDeformation_h

#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace ffd
{

/**
 * The global deformations of Barr, "Global and Local Deformations of Solid Primitives", SIGGRAPH
 * 1984: reference [1] of the paper. Along the axis u the coordinate runs from Low to
 * High; beyond, the deformation goes on as at the end: constant scale, constant angle, straight.
 */
struct FFD_CORE_EXPORT BarrDeformation
{
  enum class Shape
  {
    Taper, ///< the axes v and w are scaled, from Scale[0] at Low to Scale[1] at High
    Twist, ///< they are turned about u, by 0 at Low to Angle at High
    Bend   ///< u is bent towards v, into an arc of Angle
  };

  Shape Kind = Shape::Bend;
  int U = 2;
  int V = 0; ///< of Bend, not U; the others take the axes after U in cyclic order
  glm::dvec3 Center{ 0.0 };
  double Low = -0.5;
  double High = 0.5;
  double Angle = 0.0; ///< radians
  double Scale[2] = { 1.0, 1.0 };
  bool Smooth = false; ///< taper and twist: a quintic instead of a line between the ends

  glm::dvec3 Forward(const glm::dvec3& p) const;
  /// The Jacobian as [column][row].
  glm::dvec3 Forward(const glm::dvec3& p, glm::dmat3& jacobian) const;
  /// In closed form. Exact for all points but those of Bend beyond the center of curvature, where
  /// the deformation folds.
  glm::dvec3 Inverse(const glm::dvec3& p) const;

private:
  /// Position between the ends, 0 to 1, and its derivative by u.
  double FindProfile(double u, double& slope) const;
  /// The axes after U, in cyclic order.
  int FirstOther() const { return (this->U + 1) % 3; }
  int SecondOther() const { return (this->U + 2) % 3; }
};

} // namespace ffd

#endif
