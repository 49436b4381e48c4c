// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPullBackChange_h
#define FFDPullBackChange_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDExport.h"
#include "FFDPullBack.h"

#include <glm/vec3.hpp>

#include <functional>
#include <vector>

namespace ffd
{

/**
 * The difference between a pull-back and the one before an edit: parts of deformed space, and how
 * far what was in each has moved at most. Each part is the hull of 8 neighboring corners of a bent
 * grid, with a margin around it. What can be seen outside of all parts has not moved, and what has
 * moved is now that far from its part at most.
 *
 * For Phi = T^-1 that is how far the material has moved in deformed space,
 * |T_after(Q) - T_before(Q)| for all Q with T_before(Q) in the part, which is what a picture shows
 * of it. For the other kinds it is how far rest points have, |Phi_after(P) - Phi_before(P)| for all
 * P in the part.
 */
struct PullBackChange
{
  glm::ivec3 Parts{ 0 };           ///< along each axis; 0 where nothing has changed
  std::vector<glm::dvec3> Corners; ///< Parts + 1 along each axis, x fastest, data coordinates
  glm::dvec3 Margin{ 0.0 };        ///< to either side along each axis, data units
  std::vector<double> Moved;       ///< of each part, data units, x fastest; may be infinite

  bool IsEmpty() const { return this->Moved.empty(); }
};

/// Whether nothing can be seen of a box at rest, data coordinates.
using IsEmptyAtRest = std::function<bool(const Box& rest)>;

/**
 * The change from `before` to `after` by an edit of control points, as far as one of the two maps
 * into `region` (rest space for the kinds that invert T, else deformed space).
 *
 * |D_after - D_before| is bounded over parts of the cells that the edited control points count in,
 * by the largest values of the basis functions over each part. Phi of T^-1 moves by no more than
 * that times the Lipschitz constant of the inverse, of `limits`, those of `after`.
 * `resolution`: size of the parts, data units. `isEmpty` may be null; where it is true nothing
 * counts as moved, for Phi = T^-1, whose parts are boxes at rest.
 *
 * Returns false when nothing can be said: another grid of control points or another kind, an
 * inverse that is not proven to be one to one, or too many parts. `before` must be one to one, too.
 */
FFD_RENDERING_EXPORT bool FindChange(const PullBack& before, const PullBack& after,
  const PullBackLimits& limits, const Box& region, double resolution, const IsEmptyAtRest& isEmpty,
  PullBackChange& change);

} // namespace ffd

#endif
