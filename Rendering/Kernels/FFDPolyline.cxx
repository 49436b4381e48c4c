// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPolyline.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{

//------------------------------------------------------------------------------
PolylineWalker::PolylineWalker(const PullBack& pullBack, const PolylineSettings& settings,
  const glm::dvec3& origin, const glm::dvec3& direction, double from, double to, bool withJacobian)
  : Map(pullBack)
  , Settings(settings)
  , Origin(origin)
  , Direction(direction)
  , End(to)
  , WithJacobian(withJacobian)
  , LastDirection(direction)
  , LastLength(settings.MinimumLength)
{
  this->Vertex = this->Evaluate(from);
}

//------------------------------------------------------------------------------
PolylineVertex PolylineWalker::Evaluate(double t)
{
  PolylineVertex vertex;
  vertex.T = t;
  PullBackStatus status;
  const glm::dvec3 p = this->Origin + t * this->Direction;
  vertex.Rest = this->WithJacobian ? this->Map.Evaluate(p, vertex.Jacobian, status)
                                   : this->Map.Evaluate(p, status);
  this->Evaluations += status.Evaluations;
  this->Unconverged += status.Converged ? 0 : 1;
  return vertex;
}

//------------------------------------------------------------------------------
bool PolylineWalker::TurnsTooMuch(const glm::dvec3& segment) const
{
  // atan2 keeps small angles exact; a segment of no length has no direction and never turns.
  const double across = glm::length(glm::cross(segment, this->LastDirection));
  const double along = glm::dot(segment, this->LastDirection);
  return std::atan2(across, along) > this->Settings.AngleThreshold;
}

//------------------------------------------------------------------------------
bool PolylineWalker::Next()
{
  const double rest = this->End - this->Vertex.T;
  if (!(rest > 1e-9 * this->Settings.MinimumLength))
  {
    return false;
  }
  const double minimum = this->Settings.MinimumLength;
  const double maximum = std::max(minimum, this->Settings.MaximumLength);
  double length = std::min(2.0 * this->LastLength, maximum);
  for (;;)
  {
    const double step = std::min(length, rest);
    const PolylineVertex next = this->Evaluate(step < rest ? this->Vertex.T + step : this->End);
    const glm::dvec3 segment = next.Rest - this->Vertex.Rest;
    if (step <= minimum || !this->TurnsTooMuch(segment))
    {
      this->Vertex = next;
      this->LastLength = length;
      if (glm::dot(segment, segment) > 0.0)
      {
        this->LastDirection = segment;
      }
      return true;
    }
    length = std::max(minimum, 0.5 * length);
  }
}

} // namespace ffd
