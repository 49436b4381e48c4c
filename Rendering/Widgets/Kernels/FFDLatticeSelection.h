// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLatticeSelection_h
#define FFDLatticeSelection_h

#include "FFDExport.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/// One value per control point, x fastest: 1 if it belongs to a set.
using PointSet = std::vector<unsigned char>;

/// The set and its neighbors along the axes.
FFD_WIDGETS_EXPORT PointSet GrowSelection(const glm::ivec3& nodes, const PointSet& set);

/// The set without its points that have a neighbor outside it. The end of the lattice is none.
FFD_WIDGETS_EXPORT PointSet ShrinkSelection(const glm::ivec3& nodes, const PointSet& set);

/// Every row along `axis` (0, 1, 2) that a point of the set lies in.
FFD_WIDGETS_EXPORT PointSet SelectRows(const glm::ivec3& nodes, const PointSet& set, int axis);

/// Every plane across `axis` that a point of the set lies in.
FFD_WIDGETS_EXPORT PointSet SelectPlanes(const glm::ivec3& nodes, const PointSet& set, int axis);

/**
 * The outermost `layers` control points on every side. Without three of them changed, nothing moves
 * outside the domain and on its faces: the map there depends on no others.
 */
FFD_WIDGETS_EXPORT PointSet BoundaryPoints(const glm::ivec3& nodes, int layers);

/// Index of the point that lies opposite, across the mid-plane of `axis`.
FFD_WIDGETS_EXPORT std::size_t MirrorPoint(const glm::ivec3& nodes, std::size_t point, int axis);

/// The set and its mirror images across the mid-planes of the axes with mirror[axis].
FFD_WIDGETS_EXPORT PointSet MirrorSelection(
  const glm::ivec3& nodes, const PointSet& set, const bool mirror[3]);

/**
 * Make changes symmetric: those of the half that `active` lies in (the lower one if it lies in the
 * middle) are mirrored onto the other half, axis by axis; points in the middle keep what lies in
 * the mid-plane.
 */
FFD_WIDGETS_EXPORT void MirrorChanges(const glm::ivec3& nodes, std::vector<glm::dvec3>& changes,
  const bool mirror[3], std::size_t active);

/// Falloff of proportional editing: the part of the motion that a point takes at a part t of the
/// radius (0: selected, 1: not moved any more).
enum class Falloff
{
  Smooth,  ///< 1 - 3 t^2 + 2 t^3
  Linear,  ///< 1 - t
  Sphere,  ///< sqrt(1 - t^2)
  Sharp,   ///< (1 - t)^2
  Constant ///< 1
};
FFD_WIDGETS_EXPORT double GetFalloff(Falloff falloff, double t);

/**
 * Weights of proportional editing: 1 in the set, elsewhere by the distance of `positions` to the
 * nearest point of the set; 0 from `radius` on. Radius 0, or not positive: the set alone.
 */
FFD_WIDGETS_EXPORT std::vector<double> SoftWeights(
  const std::vector<glm::dvec3>& positions, const PointSet& set, double radius, Falloff falloff);

} // namespace ffd

#endif
