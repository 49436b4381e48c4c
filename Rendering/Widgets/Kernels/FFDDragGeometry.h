// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDDragGeometry_h
#define FFDDragGeometry_h

#include "FFDExport.h"

#include <glm/vec3.hpp>

#include <optional>

namespace ffd
{

/// Constraint of a drag: the plane of the view, an axis of the data, or the plane across one. The
/// values are those of vtkFFDLatticeRepresentation.
enum class MoveConstraint
{
  Free = 0,
  AlongX,
  AlongY,
  AlongZ,
  AcrossX,
  AcrossY,
  AcrossZ
};

/// True of AlongX, AlongY and AlongZ.
FFD_WIDGETS_EXPORT bool IsAlongAxis(MoveConstraint constraint);

/// The axis that a constraint is along or across (0, 1, 2); -1: Free.
FFD_WIDGETS_EXPORT int GetAxis(MoveConstraint constraint);

/// Unit vector of an axis.
FFD_WIDGETS_EXPORT glm::dvec3 GetUnitVector(int axis);

/// A line of sight through a pixel.
struct LineOfSight
{
  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 Direction{ 0.0, 0.0, 1.0 }; ///< of length 1
};

/**
 * Finds the motion of an anchor along an axis, or in the plane across one, when the mouse is
 * dragged from one line of sight to another. None when the axis is seen end on (or the plane edge
 * on), where a pixel would be any distance. `constraint` is not Free.
 */
FFD_WIDGETS_EXPORT std::optional<glm::dvec3> FindConstrainedMove(MoveConstraint constraint,
  const glm::dvec3& anchor, const LineOfSight& from, const LineOfSight& to);

/// The angle (radians, -pi to pi) by which a drag turns about a unit axis through a center, which
/// is seen in the direction `view`. None when the plane across the axis is seen edge on.
FFD_WIDGETS_EXPORT std::optional<double> FindDragAngle(const glm::dvec3& axis,
  const glm::dvec3& center, const glm::dvec3& view, const LineOfSight& from, const LineOfSight& to);

/// The factor by which a drag scales along an axis (0, 1, 2) from a center; at least 0.01, so that
/// it can be scaled back. None when the axis is seen end on.
FFD_WIDGETS_EXPORT std::optional<double> FindDragFactor(
  int axis, const glm::dvec3& center, const LineOfSight& from, const LineOfSight& to);

/**
 * The move of `right` and `up` steps of unit length on the screen, whose directions in data
 * coordinates are viewRight and viewUp (of any length): along an axis by right + up, in the plane
 * across one along what is left of the directions, else along these.
 */
FFD_WIDGETS_EXPORT glm::dvec3 FindScreenMove(MoveConstraint constraint, double right, double up,
  const glm::dvec3& viewRight, const glm::dvec3& viewUp);

} // namespace ffd

#endif
