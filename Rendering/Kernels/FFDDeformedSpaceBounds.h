// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDDeformedSpaceBounds_h
#define FFDDeformedSpaceBounds_h

#include "FFDExport.h"
#include "FFDLocalBounds.h"
#include "FFDPullBackBounds.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/**
 * The bounds of a pull-back arranged by where the rays run: a grid over deformed space whose cells
 * hold what PullBackBounds proves about every rest point that can map into the cell. Built once
 * per edit; afterwards a piece of a ray asks with its own box, whatever the kind of pull-back. The
 * outermost cells reach to infinity, so that any box has an answer.
 *
 * Bounds of T^-1 get better with smaller boxes very fast. So the second and third derivatives are
 * kept for eight parts of each cell, and where they are not close, the lattice is refined.
 */
class FFD_KERNEL_EXPORT DeformedSpaceBounds
{
public:
  DeformedSpaceBounds() = default;

  /**
   * `region`: the part of deformed space, data coordinates, that rays will ask about most; `rest`:
   * the part of rest space that they will be pulled back to, where bounds should be close.
   * `resolution`: size of the cells, data units; there are at most `mostCells`, each 34 bytes,
   * larger ones if need be. `pullBack` is kept by pointer.
   */
  DeformedSpaceBounds(const PullBack& pullBack, const PullBackBounds& bounds, const Box& region,
    const Box& rest, double resolution, int mostCells = 1000,
    const ParallelFor& parallelFor = ParallelFor());

  /// Bounds of Phi over a box of deformed space.
  MapBounds Over(const Box& box) const;

  /// Whether every point of deformed space is proven to come from one point alone.
  bool IsOneToOne() const { return this->OneToOne; }

  /// Closer bounds for small boxes, for more work. Where Over() is not bounded and the map not one
  /// to one they may be those of another branch.
  const LocalBounds& GetLocal() const { return this->Local; }

  std::size_t GetMemorySize() const
  {
    return this->Jacobians.capacity() * sizeof(JacobianCode) +
      this->Derivatives.capacity() * sizeof(DerivativeCode) + this->Local.GetMemorySize();
  }

  /// The lattice is refined where the third derivative times resolution^2 may be larger.
  static constexpr double CloseEnough = 1.0;

private:
  static constexpr int Parts = 2; ///< of a cell, per axis

  /// Of the Jacobian, as in SubCellBounds.
  struct UpperBounds
  {
    float Jacobian[18];
  };
  struct UpperDerivatives
  {
    float Second;
    float Third;
  };

  /// The same in few bytes, rounded upwards: entries count from the least one in the grid in steps
  /// of their own, and 255 is infinite.
  struct JacobianCode
  {
    std::uint8_t Entry[18];
  };
  /// Powers of a ratio to the largest one in the grid; 0 is infinite.
  struct DerivativeCode
  {
    std::uint8_t Second;
    std::uint8_t Third;
  };
  /// What a code of a derivative stands for.
  struct PowerTable
  {
    float Value[256] = {};
    void Set(float largest);
    std::uint8_t Encode(float value) const;
  };

  struct Grids
  {
    std::vector<UpperBounds> Jacobians;
    std::vector<UpperDerivatives> Derivatives;
    void Include(const Grids& other);
  };

  glm::ivec3 PartOf(const glm::dvec3& p) const;
  int PartOf(int axis, double x) const
  {
    // Clamped first: a cast of what is not negative rounds downwards.
    const double part = (x - this->Region.Min[axis]) * this->PartsPerUnit[axis];
    return static_cast<int>(std::max(0.0, std::min(this->LastPart[axis], part)));
  }
  std::size_t IndexOf(const glm::ivec3& cell) const;
  std::size_t IndexOfPart(const glm::ivec3& part) const;
  CellRange FindRefinedCells(
    const PullBackBounds& bounds, const BSplineField& field, const CellRange& cells) const;
  void FindOverCells(const PullBackBounds& bounds, const PullBackBounds& refined,
    const CellRange& refinedCells, const BSplineField& field, const ParallelFor& parallelFor,
    Grids& grids) const;
  void FindFromRest(const PullBackBounds& bounds, const PullBackBounds& refined,
    const CellRange& refinedCells, const glm::ivec3& factors, const BSplineField& field,
    const ParallelFor& parallelFor, Grids& grids) const;
  class Scatter;
  Grids EmptyGrids() const;
  void Encode(const Grids& grids);

  bool OneToOne = true;
  bool Identity = false; ///< then the bounds are those of the identity, everywhere
  Box Region;
  double Resolution = 1.0;
  glm::ivec3 Cells{ 1 };
  glm::dvec3 PartSize{ 1.0 };
  glm::dvec3 PartsPerUnit{ 1.0 };
  glm::dvec3 LastPart{ 0.0 };
  float Least[18] = {};
  float Step[18] = {};
  std::vector<JacobianCode> Jacobians;     // by cell, x fastest
  std::vector<DerivativeCode> Derivatives; // by part, x fastest
  PowerTable SecondPowers;
  PowerTable ThirdPowers;
  LocalBounds Local;
};

} // namespace ffd

#endif
