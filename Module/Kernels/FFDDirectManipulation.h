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

/// A wish: the material that rests at RestPoint shall move by Move, from where it is now.
struct MaterialMove
{
  glm::dvec3 RestPoint{ 0.0 };
  glm::dvec3 Move{ 0.0 };
};

/// Changes of the displacements that fulfil wishes.
struct DirectManipulation
{
  std::vector<std::size_t> Nodes;   ///< control points that change, ascending, x fastest
  std::vector<glm::dvec3> Changes;  ///< of the displacement of each (scale included)
  std::vector<glm::dvec3> Achieved; ///< by how much the material of each wish moves
};

/**
 * Direct manipulation of free-form deformations (Hsu, Hughes and Kaufman 1992): the smallest
 * changes of the displacements (least sum of squares) that move the material as wished. T is linear
 * in the displacements, so wishes are linear equations, one per point and axis, all axes with the
 * same matrix; the minimum-norm solution lies in the span of its rows. They are orthonormalised in
 * the order of the wishes: a wish that the earlier ones and the locked control points leave no room
 * for (the rest of its row is below 1e-4 of the row) is not fulfilled, which Achieved tells. So
 * pins, wishes with Move 0, go first.
 *
 * `locked`, empty or one value per control point, names control points that must not change.
 * `field` gives the geometry and border mode; its displacements do not matter. Cost: the square of
 * the number of wishes times 64.
 */
FFD_KERNEL_EXPORT DirectManipulation MoveMaterial(const BSplineField& field,
  const std::vector<unsigned char>& locked, const std::vector<MaterialMove>& wishes);

} // namespace ffd

#endif
