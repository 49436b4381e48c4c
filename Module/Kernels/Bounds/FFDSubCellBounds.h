// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSubCellBounds_h
#define FFDSubCellBounds_h

#include "Bounds/FFDSubCellGrid.h"

#include "FFDBSplineField.h"
#include "FFDParallelFor.h"

#include <functional>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace ffd
{

/**
 * Range of D and of every entry of dD/dp over one sub-cell, kept as upper bounds only (lower ones
 * negated), so that the union of two is an element-wise maximum of 24 floats. Rounded outwards.
 */
struct SubCellBounds
{
  static constexpr int Size = 24;
  static constexpr int NegatedJacobianMin = 0; ///< 9: -min of entry [column * 3 + row]
  static constexpr int JacobianMax = 9;        ///< 9
  static constexpr int NegatedMin = 18;        ///< 3: -min of the displacement
  static constexpr int Max = 21;               ///< 3
  float Value[Size];
};

/// Leaves what it makes room for as it is: all of it is written, by several threads.
template <class T>
struct UninitializedAllocator : std::allocator<T>
{
  template <class U>
  struct rebind
  {
    using other = UninitializedAllocator<U>;
  };
  template <class U>
  void construct(U* p) noexcept
  {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Arguments>
  void construct(U* p, Arguments&&... arguments)
  {
    ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
  }
};

using SubCellBoundsVector = std::vector<SubCellBounds, UninitializedAllocator<SubCellBounds>>;

/**
 * Bounds of D over every sub-cell of `grid` from its Bezier coefficients (convex hull property).
 * `bounds` is resized to grid.Count(). Single precision with the rounding error added; SIMD. About
 * 64 * 3 coefficients per sub-cell.
 */
void ComputeSubCellBounds(const BSplineField& field, const SubCellGrid& grid,
  SubCellBoundsVector& bounds, const ParallelFor& parallelFor = ParallelFor());

/**
 * The same of the sub-cells of `cells` in slabs along z, from the first one on, so that those of a
 * lattice of many control points need little memory: calls work(grid, bounds) for each slab.
 */
void ForSlabsOfSubCells(const BSplineField& field, const CellRange& cells,
  const ParallelFor& parallelFor,
  const std::function<void(const SubCellGrid&, const SubCellBoundsVector&)>& work);

/// Upper bounds of the norm of the inverse of J_T = I + dD/dp over `cells`, x fastest: the largest
/// over their sub-cells. NaN where J_T may be singular, or turn space inside out.
std::vector<float> BoundInverseNorms(
  const BSplineField& field, const CellRange& cells, const ParallelFor& parallelFor);

/// Weights of one axis: those of four control points for each of four Bezier coefficients, and the
/// offsets that are added to these.
struct BezierWeights
{
  double Weight[4][4]; ///< [control point][coefficient]
  double Shift[4];
};

/// Least and largest of the 64 Bezier coefficients of a tricubic, whose control points are `net`, x
/// fastest: its range is within them. In double precision, up to its rounding.
void FindBezierRange(const double net[64], const BezierWeights& x, const BezierWeights& y,
  const BezierWeights& z, double range[2]);

} // namespace ffd

#endif
