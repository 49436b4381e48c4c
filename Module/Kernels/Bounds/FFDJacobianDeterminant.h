// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDJacobianDeterminant_h
#define FFDJacobianDeterminant_h

#include "FFDBSplineField.h"
#include "FFDExport.h"

namespace ffd
{

/// Range of a quantity: [Min, Max] is proven to contain it.
struct Range
{
  double Min = 0.0;
  double Max = 0.0;
};

/**
 * Bounds of det J_T over the cells [firstCell, endCell) of every axis (cell indices as in
 * BSplineField): positive everywhere means that T does not fold there. det J is a polynomial of
 * degree 8 per axis in each cell; its Bernstein coefficients enclose it (convex hull property),
 * and cells where the enclosure is loose are subdivided until each end is within `tolerance` (a
 * fraction of the larger of 1 and its magnitude) of a value that is attained, or 5 times. Cells
 * that interval arithmetic on the Jacobian already shows not to matter are skipped. Infinite for
 * coefficients that are not finite; {1, 1} for no cells.
 */
FFD_CORE_EXPORT Range BoundJacobianDeterminant(const BSplineField& field,
  const glm::ivec3& firstCell, const glm::ivec3& endCell, double tolerance = 1e-3);

/// Whether det J_T is proven to be positive over these cells: BoundJacobianDeterminant() for that
/// question alone, which ends with the first value that is not, and subdivides where the sign is
/// open.
FFD_CORE_EXPORT bool HasPositiveJacobian(
  const BSplineField& field, const glm::ivec3& firstCell, const glm::ivec3& endCell);

} // namespace ffd

#endif
