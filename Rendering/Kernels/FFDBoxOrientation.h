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

/// Tells boxes that T(x) = x + D(x) turns over, all of each: where the sign of its Jacobian
/// determinant is not the one of points that are shown.
class FFD_RENDERING_EXPORT BoxOrientation
{
public:
  /// Keeps references. `images`: those of T. `orientation`: the sign of points that are shown, 1 or
  /// -1.
  BoxOrientation(
    const BoxGrid& boxes, const BoxImages& images, const BSplineField& field, double orientation);

  /**
   * Whether the boxes from `first` on, before `end`, are proven to be turned over. The determinant
   * is expanded about their middle: with the first and second derivatives of D there, and bounds of
   * the third ones, the control net's third differences.
   */
  bool AreTurnedOver(const glm::ivec3& first, const glm::ivec3& end) const;

private:
  struct Expansion;
  Expansion Expand(const glm::dvec3& middle) const;
  bool HasDerivatives(const Box& box) const;

  const BoxGrid& Boxes;
  const BoxImages& Images;
  const BSplineField& Field;
  double Orientation;
  glm::dvec3 LargestThird[3][3][3]; ///< magnitudes of third derivatives of D, by axes
};

} // namespace ffd

#endif
