// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPullBackChange_h
#define FFDPullBackChange_h

#include "FFDDeformedSpaceBounds.h"
#include "FFDExport.h"
#include "FFDPullBack.h"

#include <glm/vec3.hpp>

#include <vector>

namespace ffd
{

/**
 * Where a pull-back differs from what it was before an edit: parts of deformed space, and how far
 * rest points in each have moved at most, |after(P) - before(P)|. Each part is the hull of 8
 * neighbouring corners of a bent grid, with a margin around it; outside of all parts nothing has moved.
 */
struct PullBackChange
{
  glm::ivec3 Parts{ 0 };            ///< along each axis; 0 where nothing has changed
  std::vector<glm::dvec3> Corners;  ///< Parts + 1 along each axis, x fastest, data coordinates
  double Margin = 0.0;              ///< data units
  std::vector<double> Moved;        ///< of each part, data units, x fastest; may be infinite

  bool IsEmpty() const { return this->Moved.empty(); }
};

/**
 * The change from `before` to `after` by an edit of control points, as far as one of the two maps
 * into `region` (rest space for the kinds that invert T, else deformed space).
 *
 * |D_after - D_before| is bounded over parts of the cells that the edited control points count in,
 * by the largest values of the basis functions over each part; an inverse moves by no more than that
 * times the Lipschitz constant of `after`. `bounds` are those of `after`. `resolution`: size of the
 * parts, data units.
 *
 * Returns false when nothing can be said: another grid of control points or another kind, an
 * inverse that is not proven to be one to one, or too many parts. `before` must be one to one, too.
 */
FFD_KERNEL_EXPORT bool FindChange(const PullBack& before, const PullBack& after,
  const DeformedSpaceBounds& bounds, const Box& region, double resolution, PullBackChange& change);

} // namespace ffd

#endif
