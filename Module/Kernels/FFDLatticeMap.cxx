// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeMap.h"

#include "FFDLattice.h"

#include <limits>
#include <utility>

namespace ffd
{

//------------------------------------------------------------------------------
LatticeMap::LatticeMap() { this->Reset(PullBack().GetTolerance()); }

//------------------------------------------------------------------------------
void LatticeMap::Update(const Lattice& lattice, double tolerance)
{
  this->SetField(lattice.MakeField(), lattice.Inverse, tolerance);
}

//------------------------------------------------------------------------------
void LatticeMap::Reset(double tolerance) { this->SetField(BSplineField(), false, tolerance); }

//------------------------------------------------------------------------------
void LatticeMap::SetField(BSplineField field, bool inverse, double tolerance)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Field = std::move(field);
  this->Exact = PullBack(&this->Field, PullBackKind::Exact, tolerance);
  this->Inverse = inverse;
  this->BoundsAreCurrent[0] = this->BoundsAreCurrent[1] = false;
  this->DeterminantIsCurrent = false;
}

//------------------------------------------------------------------------------
glm::dvec3 LatticeMap::Invert(const glm::dvec3& p) const
{
  PullBackStatus status;
  return this->Exact.Evaluate(p, status);
}

//------------------------------------------------------------------------------
glm::dvec3 LatticeMap::Invert(const glm::dvec3& p, glm::dmat3& jacobian) const
{
  const glm::dvec3 q = this->Invert(p);
  this->Field.Displacement(q, jacobian);
  jacobian += glm::dmat3(1.0);
  return q;
}

//------------------------------------------------------------------------------
const PullBackBounds& LatticeMap::UpdateBounds()
{
  const int which = this->Inverse ? 1 : 0;
  if (!this->BoundsAreCurrent[which])
  {
    // The image of the object under T^-1 holds the points P with T(P) in it: the forward kind.
    this->Bounds[which].Update(PullBack(&this->Field,
      this->Inverse ? PullBackKind::Forward : PullBackKind::Exact, this->Exact.GetTolerance()));
    this->BoundsAreCurrent[which] = true;
  }
  return this->Bounds[which];
}

//------------------------------------------------------------------------------
Box LatticeMap::GetDeformedBounds(const Box& rest)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->UpdateBounds().DeformedBounds(rest);
}

//------------------------------------------------------------------------------
Box LatticeMap::GetDisplacementBounds()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  constexpr double largest = std::numeric_limits<double>::max();
  return this->UpdateBounds().DisplacementOver({ glm::dvec3(-largest), glm::dvec3(largest) });
}

//------------------------------------------------------------------------------
Range LatticeMap::GetDeterminantBounds()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (!this->DeterminantIsCurrent)
  {
    // The cells of the domain.
    this->Determinant =
      BoundJacobianDeterminant(this->Field, glm::ivec3(1), this->Field.GetNodes() - 2);
    this->DeterminantIsCurrent = true;
  }
  return this->Determinant;
}

} // namespace ffd
