// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPullBackBounds_h
#define FFDPullBackBounds_h

#include "FFDExport.h"
#include "FFDPullBack.h"
#include "FFDSubCellBounds.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <memory>
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

/// What is known of a pull-back everywhere.
struct PullBackLimits
{
  bool OneToOne = true;        ///< proven: every point of deformed space comes from one point alone
  double LargestStretch = 1.0; ///< of lengths, by Phi; may be infinite
};

/**
 * Bounds of the pull-back Phi from the control net alone (convex hull property), recomputed at
 * every edit. Each lattice cell is cut into 2^3 sub-cells; over each the Bezier coefficients of
 * the field bound the displacement and every entry of the Jacobian, over each cell the second and
 * third derivatives. For the kinds that invert T, the bounds of the derivatives of T^-1 follow
 * from those of T by the inverse-matrix perturbation bound; they are infinite over sub-cells
 * where J cannot be proven regular. The field's derivatives jump where BorderMode::ZeroAtBorder
 * meets the outside: a region that touches this border has infinite second and third derivatives
 * (D itself and the Jacobian interval stay valid: the map is Lipschitz there).
 *
 * Construction may be split over threads, and its result does not depend on that. Time and memory
 * are proportional to the number of sub-cells (24^3 for 8^3 control points; 104 bytes each); those
 * of Over() to the number of sub-cells that the region meets.
 *
 * "Region" is a box in the space where the field is evaluated: deformed space for FirstOrder and
 * Forward, REST space for Exact and FirstOrderOfInverse (that is where T's Jacobian lives).
 */
class FFD_KERNEL_EXPORT PullBackBounds
{
public:
  PullBackBounds() = default;
  explicit PullBackBounds(const PullBack& pullBack, const ParallelFor& parallelFor = ParallelFor());

  /**
   * The same over some cells of the lattice only, each cut into 2 * factors sub-cells per axis (by
   * knot insertion, so the map is the same): closer bounds where they are needed. Everything is
   * unbounded outside of these cells, and DeformedBounds() must not be called.
   */
  PullBackBounds(const PullBack& pullBack, const CellRange& cells, const glm::ivec3& factors,
    const ParallelFor& parallelFor = ParallelFor());

  /// True when regions are boxes of rest space (see above).
  bool RegionsAreInRestSpace() const { return this->RestRegions; }

  /// Union of the bounds over all sub-cells that touch `region`; of a large one by several threads.
  MapBounds Over(const Box& region, const ParallelFor& parallelFor = ParallelFor()) const;

  /// Sub-cells per axis: two a cell, and the constant outside before the first and after the last
  /// of them; and the bounds over one of these.
  const glm::ivec3& GetSize() const { return this->Size; }
  const SubCellBounds& GetSubCell(const glm::ivec3& at) const
  {
    return this->SubCells[this->IndexOf(at.x, at.y, at.z)];
  }

  /// Second and third derivatives of D over the cells of the lattice, x fastest, with a constant
  /// cell before the first and after the last of each axis.
  const std::vector<CellDerivatives>& GetDerivatives() const { return this->Derivatives; }

  /// Range of the displacement D over `region` (of the underlying field, whatever the kind).
  Box DisplacementOver(const Box& region) const;

  /**
   * A box that contains every deformed point P with Phi(P) inside `rest`: the bounds of the
   * deformed object. Exact: the image of `rest` under T from the control net (with the points
   * added that fall back to first order, unless T is proven free of folds). The other kinds:
   * cells whose Phi cannot reach `rest` are excluded. Conservative, never too small; empty when
   * `rest` is.
   */
  Box DeformedBounds(const Box& rest, const ParallelFor& parallelFor = ParallelFor()) const;

  std::size_t GetMemorySize() const
  {
    return this->SubCells.capacity() * sizeof(SubCellBounds) +
      this->Derivatives.capacity() * sizeof(CellDerivatives);
  }

  /// What is left of the bounds where only the whole counts.
  PullBackLimits GetLimits() const;

  /// True when J_T is proven regular everywhere, so that T has one inverse (kinds that invert T).
  bool IsProvenInvertible() const { return this->ProvenInvertible; }

private:
  void Find(const BSplineField& field, const SubCellGrid& grid, const ParallelFor& parallelFor);
  std::size_t IndexOf(int i, int j, int k) const
  {
    return static_cast<std::size_t>(i) +
      static_cast<std::size_t>(this->Size.x) *
      (static_cast<std::size_t>(j) +
        static_cast<std::size_t>(this->Size.y) * static_cast<std::size_t>(k));
  }
  /// Sub-cells [first, last] per axis that touch `region`; false when there are none.
  bool FindSubCells(const Box& region, glm::ivec3& first, glm::ivec3& last) const;
  /// Where the sub-cells lie, in data coordinates; the constant outside ones are infinite.
  struct SubCellEnds
  {
    std::vector<double> Min[3];
    std::vector<double> Max[3];
    explicit SubCellEnds(const PullBackBounds& bounds);
    Box GetBox(const glm::ivec3& at) const
    {
      return { glm::dvec3(this->Min[0][at.x], this->Min[1][at.y], this->Min[2][at.z]),
        glm::dvec3(this->Max[0][at.x], this->Max[1][at.y], this->Max[2][at.z]) };
    }
  };
  SubCellBounds Union(const glm::ivec3& first, const glm::ivec3& last) const;
  SubCellBounds Union(
    const glm::ivec3& first, const glm::ivec3& last, const ParallelFor& parallelFor) const;
  bool TouchesKink(const Box& region) const;
  Box GetDisplacement(const glm::ivec3& subCell) const;
  struct AxisParts;
  /// Add one component of the image under T of part of a sub-cell, tight.
  void IncludeImage(const AxisParts axes[3], const glm::ivec3& at, int component, Box& image) const;
  /// Image of `region` under T, tight; and {P : P + factor * D(P) in rest}.
  Box ForwardImage(const Box& region, const ParallelFor& parallelFor) const;
  Box Preimage(const Box& rest, double factor) const;

  bool RestRegions = false;
  bool ProvenInvertible = true;
  const BSplineField* Field = nullptr;
  PullBackKind Kind = PullBackKind::Exact;
  double Tolerance = 0.0;
  SubCellBoundsVector SubCells; // of Phi's derivatives and of D, x fastest
  std::vector<CellDerivatives> Derivatives;
  glm::ivec3 Size{ 0 };
  CellRange Cells;                             // of Field, that have sub-cells
  std::shared_ptr<const BSplineField> Refined; // null: Field is that of the pull-back
};

} // namespace ffd

#endif
