// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBoxOrientation_h
#define FFDBoxOrientation_h

#include "FFDBoxImages.h"
#include "FFDExport.h"

#include <glm/vec3.hpp>

namespace ffd
{

class BSplineField;

/// Largest magnitudes of the third derivatives of a field, by axes.
struct ThirdDerivatives
{
  glm::dvec3 Largest[3][3][3];
};

/// Bounds them by the third differences of the control net.
FFD_RENDERING_EXPORT ThirdDerivatives BoundThirdDerivatives(const BSplineField& field);

/// Tells boxes that T(x) = x + D(x) turns over, all of each: where the sign of its Jacobian
/// determinant is not the one of points that are shown.
class FFD_RENDERING_EXPORT BoxOrientation
{
public:
  /// Keeps references. `images`: those of boxes by T. `third`: of D. `orientation`: the sign of
  /// points that are shown, 1 or -1.
  BoxOrientation(const BoxImages& images, const BSplineField& field, const ThirdDerivatives& third,
    double orientation);

  /**
   * Whether the boxes from `first` on, before `end`, are proven to be turned over. The determinant
   * is expanded about their middle: with the first and second derivatives of D there, and bounds of
   * the third ones.
   */
  bool AreTurnedOver(const glm::ivec3& first, const glm::ivec3& end) const;

private:
  struct Expansion;
  Expansion Expand(const glm::dvec3& middle) const;
  bool HasDerivatives(const Box& box) const;

  const BoxImages& Images;
  const BSplineField& Field;
  ThirdDerivatives Third;
  double Orientation;
};

} // namespace ffd

#endif
