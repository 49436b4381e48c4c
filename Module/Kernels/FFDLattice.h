// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLattice_h
#define FFDLattice_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDBSplineField.h"
#include "FFDControlNet.h"
#include "FFDExport.h"
#include "FFDLatticeFit.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace ffd
{

/**
 * Stores a free-form deformation as a plain value: a uniform, axis-aligned grid of control points,
 * the displacement of each, and how these make a map. It can be copied, compared and changed
 * without VTK; LatticeMap evaluates it. vtkFFDLattice is its VTK class, whose documentation defines
 * the domain, the border modes and the map.
 *
 * All lengths are data units. The methods expect a lattice without a problem (FindProblem()) and
 * arguments in the stated ranges; they throw std::bad_alloc where there is not enough memory.
 */
struct FFD_CORE_EXPORT Lattice
{
  static constexpr int MinimumNodes = 4; ///< control points per axis: a cubic cell has four
  static constexpr int MaximumNodes = 1024;
  /// Largest factor of Refine() and number of layers of Extend().
  static constexpr int MaximumFactor = 64;
  /// Largest coordinate and displacement, and smallest spacing its inverse: products of three, as
  /// in a determinant, are finite numbers.
  static constexpr double LargestLength = 1e100;

  ControlNet Net;                       ///< displacements, before Scale
  glm::dvec3 Origin{ -1.0 };            ///< rest position of control point (0, 0, 0)
  glm::dvec3 Spacing{ 1.0 };            ///< of the control points at rest
  BorderMode Border = BorderMode::Edge; ///< the displacement beyond the control points
  double Scale = 1.0;                   ///< factor on all displacements
  bool Inverse = false;                 ///< the map is T^-1 instead of T(X) = X + Scale * D(X)

  /// 4 x 4 x 4 control points over the unit cube, no deformation.
  Lattice();

  /// A net of control points, the first of which rests at `origin`. A net without values makes a
  /// lattice that has a geometry only.
  Lattice(ControlNet net, const glm::dvec3& origin, const glm::dvec3& spacing);

  /// `nodes` control points over a domain (Min < Max), no deformation.
  Lattice(const glm::ivec3& nodes, const Box& domain);

  /// Whether there are 4 to 1024 control points along each axis.
  bool HasPossibleDimensions() const;

  /// Says what makes the values unusable: sizes, ranges, or numbers that are not finite. Empty when
  /// there is no problem.
  std::string FindProblem() const;

  //----------------------------------------------------------------------------
  // Control points: (i, j, k) from 0, or an index with i fastest

  bool HasPoint(const glm::ivec3& at) const;
  std::size_t IndexOf(const glm::ivec3& at) const;
  glm::ivec3 IndicesOf(std::size_t point) const;
  glm::dvec3 GetRestPoint(const glm::ivec3& at) const;
  /// Rest point + displacement; Scale is not applied.
  glm::dvec3 GetControlPoint(std::size_t point) const;
  /// All of them, in the order of their indices.
  std::vector<glm::dvec3> GetControlPoints() const;

  /// True when no displacement, or the scale, differs from zero; NaN differ.
  bool IsIdentity() const;

  //----------------------------------------------------------------------------
  // The domain: the box from control point 1 to n - 2 at rest

  Box GetDomain() const;

  /**
   * Moves the control points to another domain; their displacements stay. Returns -1, or the first
   * axis on which the domain is empty, inverted, not finite or too large; then nothing changes.
   */
  int SetDomain(const Box& domain);

  //----------------------------------------------------------------------------
  // Other control points for the same map

  /**
   * Returns the lattice with other numbers of control points over the same domain, where the map is
   * as near to the same as it can be, see ResizeControlNet().
   */
  Lattice Resize(const glm::ivec3& nodes) const;

  /// Returns the lattice with factors.x/y/z times as many cells: the same map in the domain
  /// (RefineControlNet()).
  Lattice Refine(const glm::ivec3& factors) const;

  /// Returns the lattice with `layers` more control points on every side and the same map
  /// everywhere. Border is Edge or Zero: ZeroAtBorder cannot be continued.
  Lattice Extend(int layers) const;

  /// Makes this the lattice of a net that was fitted, with border mode Edge, scale 1 and the map T.
  void Take(const FittedNet& fit);

  /// The displacement field of the map, Scale and Border applied.
  BSplineField MakeField() const;
};

/// Replaces axes without extent by that of the thinnest other axis, centered. Returns false, and
/// leaves the box, when no axis has an extent.
FFD_CORE_EXPORT bool WidenFlatAxes(Box& box);

} // namespace ffd

#endif
