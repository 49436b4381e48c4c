// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDDirectManipulation_h
#define FFDDirectManipulation_h

#include "FFDBSplineField.h"
#include "FFDExport.h"

#include <glm/vec3.hpp>

#include <vector>

namespace ffd
{

/// A constraint: the material that rests at RestPoint moves by Move, from where it is now.
struct MaterialMove
{
  glm::dvec3 RestPoint{ 0.0 };
  glm::dvec3 Move{ 0.0 };
};

/// Changes of the displacements that meet constraints.
struct DirectManipulation
{
  std::vector<std::size_t> Nodes;   ///< control points that change, ascending, x fastest
  std::vector<glm::dvec3> Changes;  ///< of the displacement of each (scale included)
  std::vector<glm::dvec3> Achieved; ///< by how much the material of each constraint moves
};

/**
 * Finds the smallest changes of the displacements (least sum of squares) that move the material as
 * the constraints say: direct manipulation of free-form deformations (Hsu, Hughes and Kaufman
 * 1992). T is linear in the displacements, so constraints are linear equations, one per point and
 * axis, all axes with the same matrix; the minimum-norm solution lies in the span of its rows. They
 * are made orthonormal in the order of the constraints: one that the earlier ones and the locked
 * control points leave no room for (the rest of its row is below 1e-4 of the row) is not met, which
 * Achieved tells. So pins, constraints with Move 0, go first.
 *
 * `locked`, empty or one value per control point, names control points that must not change.
 * `field` gives the geometry and border mode; its displacements do not matter. Cost: the square of
 * the number of constraints times 64.
 */
FFD_CORE_EXPORT DirectManipulation MoveMaterial(const BSplineField& field,
  const std::vector<unsigned char>& locked, const std::vector<MaterialMove>& constraints);

} // namespace ffd

#endif
