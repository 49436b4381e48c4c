// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDFoldGuard_h
#define FFDFoldGuard_h

#include "FFDControlNet.h"
#include "FFDExport.h"

#include <glm/vec3.hpp>

namespace ffd
{

/// The result of LimitFold(): how far an edit may go.
struct FoldLimit
{
  double Fraction = 1.0;    ///< of the way from the net before to the net after, 0 to 1
  double Determinant = 1.0; ///< proven lower bound of det J_T there, over the cells that change
};

/**
 * The largest part of an edit that does not fold: where on the straight way from the displacements
 * `before` to `after` the proven lower bound of det J_T (BoundJacobianDeterminant, within 1 %) over
 * the domain's cells that the edit touches still is at least `minimum`. If `before` itself is below
 * the minimum, its own bound takes the place of the minimum, so that such a lattice can be
 * unfolded, but not folded further. By bisection to 1/256 of the way; the state returned is always
 * one that was checked. The displacements are those that count (scale included), the spacing is
 * that of the control points. Equal nets: fraction 1.
 */
FFD_CORE_EXPORT FoldLimit LimitFold(
  const ControlNet& before, const ControlNet& after, const glm::dvec3& spacing, double minimum);

} // namespace ffd

#endif
