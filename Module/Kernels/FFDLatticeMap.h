// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLatticeMap_h
#define FFDLatticeMap_h

#include "Bounds/FFDJacobianDeterminant.h"
#include "Bounds/FFDPullBackBounds.h"
#include "FFDBSplineField.h"
#include "FFDExport.h"
#include "FFDPullBack.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <mutex>

namespace ffd
{

struct Lattice;

/**
 * Evaluates the map of a Lattice and bounds it. What is evaluated is made by Update(); bounds are
 * computed when they are asked for and kept until the next update, which bounds only those cells
 * anew whose control points have moved.
 *
 * Between updates all methods may be called from several threads; the queries of bounds wait for
 * each other and for an update. Evaluation does not, so an update excludes it.
 */
class FFD_CORE_EXPORT LatticeMap
{
public:
  /// The identity.
  LatticeMap();
  LatticeMap(const LatticeMap&) = delete;
  LatticeMap& operator=(const LatticeMap&) = delete;

  /**
   * Takes over a lattice without a problem. `tolerance`: largest distance |T(Q) - P| of an inverse
   * point Q of P, data units, > 0.
   */
  void Update(const Lattice& lattice, double tolerance);

  /// Becomes the identity.
  void Reset(double tolerance);

  /// The displacement field D, scaled: T(X) = X + D(X).
  const BSplineField& GetField() const { return this->Field; }

  /// T^-1(p), whether or not the lattice is inverted; by the rules of PullBackKind::Exact where T
  /// folds.
  glm::dvec3 Invert(const glm::dvec3& p) const;

  /// As above, with the Jacobian of T at the point that is returned: jacobian[column][row].
  glm::dvec3 Invert(const glm::dvec3& p, glm::dmat3& jacobian) const;

  /// Bounds of what an object within `rest` becomes: conservative, tight to a fraction of a cell.
  Box GetDeformedBounds(const Box& rest);

  /// Range of D over all space, conservative.
  Box GetDisplacementBounds();

  /// Proven bounds of det J_T over the domain (BoundJacobianDeterminant()). T does not fold there
  /// when the minimum is positive.
  Range GetDeterminantBounds();

private:
  void SetField(BSplineField field, bool inverse, double tolerance);
  const PullBackBounds& UpdateBounds();

  BSplineField Field;
  PullBack Exact;
  bool Inverse = false;

  std::mutex Mutex;         // of what follows
  PullBackBounds Bounds[2]; // of T, of T^-1
  bool BoundsAreCurrent[2] = { false, false };
  Range Determinant;
  bool DeterminantIsCurrent = false;
};

} // namespace ffd

#endif
