// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPullBackBounds_h
#define FFDPullBackBounds_h

#include "FFDExport.h"
#include "FFDPullBack.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace ffd
{

/// An axis-aligned box of data coordinates; empty when Min > Max on an axis.
struct Box
{
  glm::dvec3 Min{ 0.0 };
  glm::dvec3 Max{ 0.0 };
  bool IsEmpty() const { return !(Min.x <= Max.x && Min.y <= Max.y && Min.z <= Max.z); }
};

/// Proven bounds of a map over a region. Unbounded entries are infinite.
struct MapBounds
{
  /// Entry-wise interval of the Jacobian, [column][row].
  glm::dmat3 JacobianMin{ 1.0 };
  glm::dmat3 JacobianMax{ 1.0 };
  /// |d^2 Phi(O + t d) / dt^2| <= SecondDerivative * |d|^2, likewise the third.
  double SecondDerivative = 0.0;
  double ThirdDerivative = 0.0;
};

/**
 * Bounds of the pull-back Phi from the control net alone (convex hull property), recomputed at
 * every edit. Each lattice cell is cut into 2^3 sub-cells; over each the Bezier coefficients of
 * the field bound the displacement, every entry of the Jacobian and the second and third
 * derivatives. For the kinds that invert T, the bounds of the derivatives of T^-1 follow from
 * those of T by the inverse-matrix perturbation bound; they are infinite over sub-cells where
 * det J cannot be proven positive.
 *
 * "Region" is a box in the space where the field is evaluated: deformed space for FirstOrder and
 * Forward, REST space for Exact and FirstOrderOfInverse (that is where T's Jacobian lives).
 */
class FFD_KERNEL_EXPORT PullBackBounds
{
public:
  PullBackBounds() = default;
  explicit PullBackBounds(const PullBack& pullBack);

  /// True when regions are boxes of rest space (see above).
  bool RegionsAreInRestSpace() const { return this->RestRegions; }

  /// Union of the bounds over all sub-cells that touch `region`.
  MapBounds Over(const Box& region) const;

  /// Range of the displacement D over `region` (of the underlying field, whatever the kind).
  Box DisplacementOver(const Box& region) const;

  /**
   * A box that contains every deformed point P with Phi(P) inside `rest`: the bounds of the
   * deformed object. Exact: the image of `rest` under T from the control net. FirstOrder and
   * Forward: cells whose Phi cannot reach `rest` are excluded. Conservative, never too small.
   */
  Box DeformedBounds(const Box& rest) const;

private:
  struct SubCell;
  bool RestRegions = false;
  const BSplineField* Field = nullptr;
  PullBackKind Kind = PullBackKind::Exact;
  glm::ivec3 FirstSubCell{ 0 };
  glm::ivec3 SubCells{ 0 };
  std::vector<MapBounds> Derivatives; // per sub-cell, x fastest, one constant cell on each border
  std::vector<Box> Displacements;     // per sub-cell
};

} // namespace ffd

#endif
