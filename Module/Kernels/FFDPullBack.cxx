// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBack.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

/// Newton steps per solve. Quadratic convergence needs 2 to 4; the rest is for damped steps.
constexpr int MaximumNewtonSteps = 40;
/// Halvings of one Newton step before the solve counts as stuck.
constexpr int MaximumHalvings = 12;
/// Least decrease of the residual, relative to the step taken (Armijo's rule).
constexpr double SufficientDecrease = 1e-4;
/// Continuation gives up below this step in the strength, which it also starts a search with.
constexpr double SmallestStrengthStep = 1.0 / 512.0;
constexpr double FirstStrengthStep = 1.0 / 8.0;

/// T_s(Q) - p for the deformation at strength s, with everything a Newton step needs.
struct Residual
{
  glm::dvec3 Point{ 0.0 };
  glm::dvec3 Displacement{ 0.0 }; // at full strength
  glm::dmat3 Jacobian{ 1.0 };     // of T_s
  glm::dvec3 Value{ 0.0 };
  double Length = 0.0;
};

Residual EvaluateResidual(const BSplineField& field, const glm::dvec3& p, const glm::dvec3& q,
  double strength, int& evaluations)
{
  Residual r;
  r.Point = q;
  r.Displacement = field.Displacement(q, r.Jacobian);
  ++evaluations;
  r.Jacobian = r.Jacobian * strength + glm::dmat3(1.0);
  // (q - p) first: far from the origin it is exact where q + D would round.
  r.Value = (q - p) + strength * r.Displacement;
  r.Length = glm::length(r.Value);
  return r;
}

/// x with m x = b, or false for a matrix that is singular to working precision.
bool Solve(const glm::dmat3& m, const glm::dvec3& b, glm::dvec3& x)
{
  const glm::dvec3 c12 = glm::cross(m[1], m[2]);
  const double det = glm::dot(m[0], c12);
  const double scale = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
  if (!(std::abs(det) > 1e-12 * scale))
  {
    return false;
  }
  x = glm::dvec3(glm::dot(b, c12), glm::dot(m[0], glm::cross(b, m[2])),
        glm::dot(m[0], glm::cross(m[1], b))) /
    det;
  return true;
}

/// The tolerance, but no less than the residual that the rounding of positions alone leaves, which
/// the map may enlarge.
double ReachableTolerance(const glm::dvec3& p, const Residual& r, double tolerance)
{
  const glm::dvec3 a = glm::max(glm::abs(p), glm::abs(r.Point));
  const double enlarged = std::max(
    { 1.0, glm::length(r.Jacobian[0]), glm::length(r.Jacobian[1]), glm::length(r.Jacobian[2]) });
  return std::max(tolerance,
    8.0 * std::numeric_limits<double>::epsilon() * std::max({ a.x, a.y, a.z }) * enlarged);
}

/**
 * Damped Newton for T_s(Q) = p from r.Point; r is the residual there on entry, at the last
 * accepted point on return. Where J is regular everywhere the residual has no stationary points
 * but the solution, so the damped iteration cannot stop short of it.
 */
bool Newton(const BSplineField& field, const glm::dvec3& p, double strength, double tolerance,
  int maximumSteps, Residual& r, int& evaluations)
{
  for (int step = 0; step <= maximumSteps; ++step)
  {
    if (r.Length <= ReachableTolerance(p, r, tolerance))
    {
      return true;
    }
    glm::dvec3 delta;
    if (step == maximumSteps || !Solve(r.Jacobian, r.Value, delta))
    {
      return false;
    }
    bool accepted = false;
    double fraction = 1.0;
    for (int halving = 0; halving <= MaximumHalvings && !accepted; ++halving)
    {
      const Residual next =
        EvaluateResidual(field, p, r.Point - fraction * delta, strength, evaluations);
      // The comparison is false for NaN, too.
      if (next.Length <= (1.0 - SufficientDecrease * fraction) * r.Length)
      {
        r = next;
        accepted = true;
      }
      fraction *= 0.5;
    }
    if (!accepted)
    {
      return false;
    }
  }
  return false;
}

/**
 * Follow the solution of Q + s D(Q) = p from s = 0, where it is p itself, to s = 1: a tangent
 * predictor dQ/ds = -J_s^-1 D and a few Newton steps as corrector, the step in s halved when the
 * corrector fails and doubled when it succeeds.
 */
bool Continuation(
  const BSplineField& field, const glm::dvec3& p, double tolerance, Residual& r, int& evaluations)
{
  constexpr int correctorSteps = 4;
  Residual current = EvaluateResidual(field, p, p, 0.0, evaluations);
  double strength = 0.0;
  double step = FirstStrengthStep;
  while (strength < 1.0)
  {
    const double next = std::min(1.0, strength + step);
    glm::dvec3 tangent;
    if (!Solve(current.Jacobian, current.Displacement, tangent))
    {
      break;
    }
    Residual trial =
      EvaluateResidual(field, p, current.Point - (next - strength) * tangent, next, evaluations);
    const int steps = next < 1.0 ? correctorSteps : MaximumNewtonSteps;
    if (Newton(field, p, next, tolerance, steps, trial, evaluations))
    {
      current = trial;
      strength = next;
      step *= 2.0;
    }
    else
    {
      step = 0.5 * std::min(step, next - strength);
      if (step < SmallestStrengthStep)
      {
        break;
      }
    }
  }
  r = current;
  return strength >= 1.0;
}

bool SolveInverseAt(const BSplineField& field, const glm::dvec3& p, const glm::dvec3& start,
  double tolerance, Residual& r, int& evaluations)
{
  r = EvaluateResidual(field, p, start, 1.0, evaluations);
  return Newton(field, p, 1.0, tolerance, MaximumNewtonSteps, r, evaluations) ||
    Continuation(field, p, tolerance, r, evaluations);
}

} // namespace

//------------------------------------------------------------------------------
bool SolveInverse(const BSplineField& field, const glm::dvec3& p, const glm::dvec3& start,
  double tolerance, glm::dvec3& q, int& evaluations)
{
  Residual r;
  const bool converged = SolveInverseAt(field, p, start, tolerance, r, evaluations);
  q = r.Point;
  return converged;
}

//------------------------------------------------------------------------------
bool SolveInverseNear(const BSplineField& field, const glm::dvec3& p, const glm::dvec3& start,
  double tolerance, glm::dvec3& q, int& evaluations)
{
  Residual r = EvaluateResidual(field, p, start, 1.0, evaluations);
  const bool converged = Newton(field, p, 1.0, tolerance, MaximumNewtonSteps, r, evaluations);
  q = r.Point;
  return converged;
}

//------------------------------------------------------------------------------
PullBackKind FindPullBackKind(InverseMode mode, bool inverted)
{
  switch (mode)
  {
    case InverseMode::FirstOrder:
      return inverted ? PullBackKind::FirstOrderOfInverse : PullBackKind::FirstOrder;
    case InverseMode::PullBack:
      return inverted ? PullBackKind::Exact : PullBackKind::Forward;
    case InverseMode::Exact:
    default:
      return inverted ? PullBackKind::Forward : PullBackKind::Exact;
  }
}

//------------------------------------------------------------------------------
PullBack::PullBack(
  const BSplineField* field, PullBackKind kind, double tolerance, const std::optional<Box>& domain)
  : Field(field)
  , Kind(kind)
  , Tolerance(tolerance)
  , Domain(kind == PullBackKind::Forward ? domain : std::nullopt)
{
}

//------------------------------------------------------------------------------
glm::dvec3 PullBack::Evaluate(const glm::dvec3& p, PullBackStatus& status) const
{
  if (InvertsTheField(this->Kind))
  {
    glm::dmat3 jacobian;
    return this->Evaluate(p, jacobian, status);
  }
  status = PullBackStatus();
  if (this->IsIdentity())
  {
    return p;
  }
  status.Evaluations = 1;
  const glm::dvec3 d = this->Field->Displacement(p);
  return this->Kind == PullBackKind::Forward ? p + d : p - d;
}

//------------------------------------------------------------------------------
glm::dvec3 PullBack::Evaluate(
  const glm::dvec3& p, glm::dmat3& jacobian, PullBackStatus& status) const
{
  status = PullBackStatus();
  jacobian = glm::dmat3(1.0);
  if (this->IsIdentity())
  {
    return p;
  }
  const bool inverts = InvertsTheField(this->Kind);
  if (inverts)
  {
    // Always started from p, never from a neighbor's solution: where several rest points map to
    // p the choice must not depend on what was evaluated before.
    Residual r;
    status.Converged = SolveInverseAt(*this->Field, p, p, this->Tolerance, r, status.Evaluations);
    glm::dvec3 columns[3];
    bool regular = status.Converged;
    for (int a = 0; a < 3 && regular; ++a)
    {
      glm::dvec3 unit(0.0);
      unit[a] = 1.0;
      regular = Solve(r.Jacobian, unit, columns[a]);
    }
    if (regular)
    {
      const glm::dmat3 inverse(columns[0], columns[1], columns[2]);
      const bool exact = this->Kind == PullBackKind::Exact;
      jacobian = exact ? inverse : glm::dmat3(2.0) - inverse;
      return exact ? r.Point : p + (p - r.Point);
    }
    status.Converged = false;
  }
  // T^-1(P) = P - D(P) to first order, so 2P - T^-1(P) = P + D(P) to first order.
  const bool plus =
    this->Kind == PullBackKind::Forward || this->Kind == PullBackKind::FirstOrderOfInverse;
  const double sign = plus ? 1.0 : -1.0;
  const glm::dvec3 d = this->Field->Displacement(p, jacobian);
  ++status.Evaluations;
  jacobian = glm::dmat3(1.0) + sign * jacobian;
  return p + sign * d;
}

//------------------------------------------------------------------------------
glm::dmat3 PullBack::FindJacobian(const glm::dvec3& p, const glm::dvec3& q) const
{
  if (this->IsIdentity())
  {
    return glm::dmat3(1.0);
  }
  glm::dmat3 jacobian;
  switch (this->Kind)
  {
    case PullBackKind::FirstOrder:
      this->Field->Displacement(p, jacobian);
      return glm::dmat3(1.0) - jacobian;
    case PullBackKind::Forward:
      this->Field->Displacement(p, jacobian);
      return glm::dmat3(1.0) + jacobian;
    default:
      break;
  }
  const bool mirrored = this->Kind == PullBackKind::FirstOrderOfInverse;
  this->Field->Displacement(mirrored ? p + (p - q) : q, jacobian);
  jacobian += glm::dmat3(1.0);
  glm::dmat3 inverse(1.0);
  for (int a = 0; a < 3; ++a)
  {
    glm::dvec3 unit(0.0);
    unit[a] = 1.0;
    if (!Solve(jacobian, unit, inverse[a]))
    {
      return glm::dmat3(1.0);
    }
  }
  return mirrored ? glm::dmat3(2.0) - inverse : inverse;
}

} // namespace ffd
