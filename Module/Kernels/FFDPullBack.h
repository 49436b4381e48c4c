// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPullBack_h
#define FFDPullBack_h

#include "Bounds/FFDBox.h"

#include "FFDBSplineField.h"
#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace ffd
{

/// The map from deformed space to rest space that bends the rays.
enum class PullBackKind
{
  /// Phi(P) = P - D(P) = 2P - T(P): the inverse ray deformation of the paper, equation (3).
  FirstOrder,
  /// Phi = T^-1, by Newton's method with the full Jacobian.
  Exact,
  /// Phi = T: the field already maps deformed points to rest points.
  Forward,
  /// Phi(P) = 2P - T^-1(P): equation (3) for a transform that is itself given inverted.
  FirstOrderOfInverse
};

/// Whether a kind solves T(Q) = P, so that the field is evaluated in rest space.
inline bool InvertsTheField(PullBackKind kind)
{
  return kind == PullBackKind::Exact || kind == PullBackKind::FirstOrderOfInverse;
}

/// Methods for the pull-back of a deformation T; the values are those of the public classes.
enum class InverseMode
{
  FirstOrder = 0, ///< 2P - T(P)
  Exact = 1,      ///< T^-1
  PullBack = 2    ///< T itself
};

/// The kind for a deformation that is the field's map, or (`inverted`) the inverse of that.
FFD_CORE_EXPORT PullBackKind FindPullBackKind(InverseMode mode, bool inverted);

/// Outcome of an evaluation of the pull-back.
struct PullBackStatus
{
  bool Converged = true; ///< false: no solution within the tolerance, the first-order point is used
  int Evaluations = 0;   ///< evaluations of the field this call made
};

/**
 * Phi: deformed point P -> rest point Q, both in data coordinates.
 *
 * Every evaluation depends on P alone, never on what was evaluated before, so an image does not
 * depend on which points space leaping skipped. Where Newton's method does not converge (folds,
 * points that no rest point maps to) the first-order point of equation (3) is returned and the
 * status says so: the result is always finite for finite input.
 */
class FFD_CORE_EXPORT PullBack
{
public:
  PullBack() = default;
  /// `tolerance`: largest distance |T(Q) - P| of a converged point, data units, > 0. Only for the
  /// kinds that invert T. `field` is kept by pointer and must outlive this object. `domain`: of the
  /// kind Forward alone, a box beyond which nothing comes from the volume, whatever the field is
  /// there; none: the field tells everywhere.
  PullBack(const BSplineField* field, PullBackKind kind, double tolerance,
    const std::optional<Box>& domain = std::nullopt);

  PullBackKind GetKind() const { return this->Kind; }
  const BSplineField* GetField() const { return this->Field; }
  double GetTolerance() const { return this->Tolerance; }
  const std::optional<Box>& GetDomain() const { return this->Domain; }

  /// True when Phi is exactly the identity (no field, or one of zeros).
  bool IsIdentity() const { return this->Field == nullptr || this->Field->IsZero(); }

  /// Q = Phi(p).
  glm::dvec3 Evaluate(const glm::dvec3& p, PullBackStatus& status) const;

  /// Q = Phi(p) and dPhi/dp: jacobian[column][row] (GLM is column major).
  glm::dvec3 Evaluate(const glm::dvec3& p, glm::dmat3& jacobian, PullBackStatus& status) const;

  /// dPhi/dp at p, of which it is known that Phi(p) = q.
  glm::dmat3 FindJacobian(const glm::dvec3& p, const glm::dvec3& q) const;

private:
  const BSplineField* Field = nullptr;
  PullBackKind Kind = PullBackKind::Exact;
  double Tolerance = 1e-3;
  std::optional<Box> Domain;
};

/**
 * Solve T(Q) = X + D(X) = p for Q. Damped Newton from `start`; if that fails, continuation in the
 * strength of the deformation from the identity. Returns whether |T(q) - p| <= tolerance;
 * `q` is then the solution, else the last iterate. `evaluations` is increased.
 */
FFD_CORE_EXPORT bool SolveInverse(const BSplineField& field, const glm::dvec3& p,
  const glm::dvec3& start, double tolerance, glm::dvec3& q, int& evaluations);

/// The same by damped Newton alone: of several solutions one near `start`, if there is one.
FFD_CORE_EXPORT bool SolveInverseNear(const BSplineField& field, const glm::dvec3& p,
  const glm::dvec3& start, double tolerance, glm::dvec3& q, int& evaluations);

} // namespace ffd

#endif
