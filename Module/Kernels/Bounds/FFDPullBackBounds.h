// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPullBackBounds_h
#define FFDPullBackBounds_h

#include "Bounds/FFDBox.h"
#include "Bounds/FFDSubCellGrid.h"

#include "FFDExport.h"
#include "FFDParallelFor.h"
#include "FFDPullBack.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <vector>

namespace ffd
{

/// Limits of a pull-back that hold everywhere.
struct PullBackLimits
{
  bool OneToOne = true;        ///< proven: every point of deformed space comes from one point alone
  double LargestStretch = 1.0; ///< of lengths, by T^-1, of the kinds that invert T; may be infinite
  /// Of the kinds that invert T, if it is one to one: it stays so if D goes on linearly beyond the
  /// lattice for up to so many cells (ExtendLinearly()). At most 16; 0 for small lattices.
  int LinearCells = 0;
};

/**
 * Bounds of a pull-back Phi from the control net alone (convex hull property): of the deformed
 * object, of the displacement, and whether T has one inverse. Each cell of the lattice is cut into
 * 2^3 sub-cells, over which the Bezier coefficients of the field bound D and every entry of dD/dp.
 *
 * Kept between edits is a bound of the inverse Jacobian of T for each cell, of the kinds that
 * invert T alone; everything else is found where it is asked for, over the cells that matter. No
 * result depends on the number of threads.
 */
class FFD_CORE_EXPORT PullBackBounds
{
public:
  PullBackBounds() = default;
  explicit PullBackBounds(const PullBack& pullBack, const ParallelFor& parallelFor = ParallelFor())
  {
    this->Update(pullBack, parallelFor);
  }

  /**
   * Bounds of another pull-back; its field must outlive them. Where the lattice is that of the last
   * one, only cells are bounded anew whose control points have changed. Returns how many these
   * were.
   */
  std::size_t Update(const PullBack& pullBack, const ParallelFor& parallelFor = ParallelFor());

  /// Range of the displacement D over `region` (of the underlying field, whatever the kind), a box
  /// in the space where the field is evaluated: rest space for the kinds that invert T.
  Box DisplacementOver(const Box& region) const;

  /**
   * A box that contains every deformed point P with Phi(P) inside `rest`: the bounds of the
   * deformed object. Exact: the image of `rest` under T, tight. The other kinds: sub-cells whose
   * Phi cannot reach `rest` are excluded. Points whose inverse does not converge do not count.
   * Conservative, never too small; empty when `rest` is. Within PullBack::GetDomain().
   */
  Box DeformedBounds(const Box& rest, const ParallelFor& parallelFor = ParallelFor()) const;

  PullBackLimits GetLimits() const;

  /// True when J_T is proven regular everywhere, so that T has one inverse (kinds that invert T).
  bool IsProvenInvertible() const { return this->ProvenInvertible; }

  /**
   * Bound of how fast a deformed ray turns, radians per data unit of its viewing ray: the largest
   * curvature of section 4.5, times the speed, |Q' x Q''| / |Q'|^2 <= |Q''| / |Q'|. `region` as for
   * DisplacementOver(). Infinite where that cannot be bounded, as where BorderMode::ZeroAtBorder
   * meets the outside. Looks at all cells of the region at every call.
   */
  double FindLargestTurnRate(const Box& region) const;

  std::size_t GetMemorySize() const { return this->InverseNorms.capacity() * sizeof(float); }

private:
  class SubCells;
  CellRange FindChangedCells() const;
  void BoundInverse(
    const CellRange& cells, const ParallelFor& parallelFor, std::vector<float>& norms) const;
  void ProveInvertible(std::vector<float>& norms);
  int FindLinearCells() const;
  std::size_t CellIndex(const glm::ivec3& cell) const;
  bool TouchesKink(const Box& region) const;
  template <class Reach>
  Box UnionOfSubCells(const glm::ivec3& first, const glm::ivec3& last, const Reach& reach,
    const ParallelFor& parallelFor) const;
  Box Preimage(const Box& rest, double factor, const ParallelFor& parallelFor) const;

  const BSplineField* Field = nullptr; // null: the identity
  PullBackKind Kind = PullBackKind::Exact;
  double Tolerance = 0.0;
  std::optional<Box> Domain; // of the pull-back
  bool ProvenInvertible = true;

  // For kinds that invert T, a bound of the norm of the inverse of J_T for each cell of the
  // lattice, x fastest: infinite where only its determinant is bounded, NaN where nothing is known.
  std::vector<float> InverseNorms;
  std::optional<BSplineField> Last; // they were found from it
};

} // namespace ffd

#endif
