// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLocalBounds_h
#define FFDLocalBounds_h

#include "FFDExport.h"
#include "FFDPullBackBounds.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/// Every vector that differs from Middle by at most Spread on each axis.
struct VectorRange
{
  glm::dvec3 Middle{ 0.0 };
  glm::dvec3 Spread{ 0.0 };
};

/**
 * What is proven of a pull-back over a small box of deformed space, from the derivatives at its
 * middle and how much they can change up to its faces.
 */
class FFD_KERNEL_EXPORT LocalMap
{
public:
  /// Entry-wise interval of the Jacobian, [column][row].
  glm::dmat3 JacobianMin{ 1.0 };
  glm::dmat3 JacobianMax{ 1.0 };

  /// Bounds of |d^3 Phi(O + t v) / dt^3| for the vectors of a range, and of |d^2 Phi| likewise.
  double ThirdAlong(const VectorRange& v) const;
  double SecondAlong(const VectorRange& v) const;

private:
  friend class LocalBounds;
  struct Along
  {
    glm::dvec3 First;      ///< Q', at the middle
    glm::dvec3 FirstMost;  ///< |Q'| anywhere, entry-wise
    glm::dvec3 Second;     ///< Q'', at the middle of box and range
    glm::dvec3 SecondMost; ///< |Q''|
  };
  Along FindAlong(const VectorRange& v) const;

  bool Inverse = false;           ///< Phi is T^-1, or a mirrored one
  glm::dmat3 Linear{ 1.0 };       ///< J_T^-1 at the middle
  glm::dmat3 LinearSpread{ 0.0 }; ///< how much it changes
  glm::dmat3 LinearMost{ 1.0 };   ///< |Linear| + LinearSpread
  double Second[6][3] = {};       ///< derivatives of D at the middle: xx, xy, xz, yy, yz, zz
  double SecondSpread[6][3] = {};
  double Third[10][3] = {}; ///< bounds: xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz
};

/**
 * Bounds over boxes much smaller than the cells of the lattice: the second derivatives are taken
 * at the middle of the box, and only the third ones, which change little within a cell, from the
 * control net. For the kinds that invert T the box is first enclosed in rest space by a region that
 * a Newton step maps into itself (Brouwer's theorem; as Neumaier, Interval Methods for Systems of
 * Equations, 1990, chapter 5), over which T is proven to be one to one. For where
 * PullBackBounds, which is far cheaper to ask, is too loose, as bounds of T^-1 grow with the fifth
 * power of those of its Jacobian.
 *
 * The answer depends on the box alone. Where T folds somewhere else, Phi may still take the other
 * branch, and nothing is proven then.
 */
class FFD_KERNEL_EXPORT LocalBounds
{
public:
  LocalBounds() = default;

  /// `pullBack` is kept by pointer. `bounds`: those of it, over the whole lattice. `cells`: those
  /// that points of interest are pulled back to; nothing can be proven elsewhere.
  LocalBounds(const PullBack& pullBack, const PullBackBounds& bounds, const CellRange& cells);

  /// Over a box of deformed space; false where nothing can be proven.
  bool Find(const Box& box, LocalMap& map) const;

  std::size_t GetMemorySize() const { return this->Third.capacity() * sizeof(CellThird); }

  /// A lattice that has more cells where it is needed has small ones, too, and no use for this.
  static constexpr int LargestNumberOfCells = 2000;

private:
  /// Of the third derivatives in a cell: the power of a ratio to the largest one of all cells.
  struct CellThird
  {
    std::uint8_t Power[10][3];
  };

  bool FindThird(const glm::dvec3& middle, const glm::dvec3& radius, double third[10][3]) const;
  /// First and second derivatives of D at p.
  void FindDerivatives(
    const glm::dvec3& p, glm::dmat3& jacobian, double second[6][3]) const;
  /// What changes from `point` to as far as `radius`.
  struct Change
  {
    glm::dmat3 Jacobian;  ///< of D, entry-wise bounds
    glm::dvec3 Remainder; ///< of D, beyond the linear part
  };
  bool FindChange(const glm::dvec3& point, const glm::dvec3& radius, LocalMap& map,
    Change& change) const;
  bool FindInverse(const glm::dmat3& change, LocalMap& map) const;

  const PullBack* Map = nullptr;
  CellRange Cells;
  float Powers[256] = {}; ///< descending, from the largest third derivative; the last is zero
  std::vector<CellThird> Third; // x fastest
};

} // namespace ffd

#endif
