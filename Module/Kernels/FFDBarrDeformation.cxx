// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBarrDeformation.h"

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

constexpr double Turn = 6.283185307179586;

} // namespace

//------------------------------------------------------------------------------
double BarrDeformation::FindProfile(double u, double& slope) const
{
  const double length = this->High - this->Low;
  const double t = (u - this->Low) / length;
  slope = 0.0;
  if (!(t > 0.0))
  {
    return 0.0;
  }
  if (t >= 1.0)
  {
    return 1.0;
  }
  if (!this->Smooth)
  {
    slope = 1.0 / length;
    return t;
  }
  // Two continuous derivatives at the ends.
  slope = 30.0 * t * t * (1.0 - t) * (1.0 - t) / length;
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

//------------------------------------------------------------------------------
glm::dvec3 BarrDeformation::Forward(const glm::dvec3& p) const
{
  glm::dmat3 jacobian;
  return this->Forward(p, jacobian);
}

//------------------------------------------------------------------------------
glm::dvec3 BarrDeformation::Forward(const glm::dvec3& p, glm::dmat3& jacobian) const
{
  jacobian = glm::dmat3(1.0);
  glm::dvec3 moved = p;
  const int u = this->U;
  if (this->Kind == Shape::Bend)
  {
    const double k = this->Angle / (this->High - this->Low);
    if (k == 0.0)
    {
      return p;
    }
    const int v = this->V;
    const double along = std::clamp(p[u], this->Low, this->High);
    const bool inside = along == p[u];
    const double theta = k * (along - this->Center[u]);
    const double s = std::sin(theta);
    const double c = std::cos(theta);
    const double y = p[u] - along;
    const double z = p[v] - this->Center[v];
    // The limit of small k: 1/k cancels in sin(theta)/k and (1 - cos(theta))/k.
    moved[u] = this->Center[u] - s * z + s / k + c * y;
    moved[v] =
      this->Center[v] + c * z + 2.0 * std::sin(0.5 * theta) * std::sin(0.5 * theta) / k + s * y;
    const double stretch = inside ? 1.0 - k * z : 1.0;
    jacobian[u][u] = c * stretch;
    jacobian[u][v] = s * stretch;
    jacobian[v][u] = -s;
    jacobian[v][v] = c;
    return moved;
  }
  const int v = this->FirstOther();
  const int w = this->SecondOther();
  const double y = p[v] - this->Center[v];
  const double z = p[w] - this->Center[w];
  double slope;
  const double profile = this->FindProfile(p[u], slope);
  if (this->Kind == Shape::Taper)
  {
    const double scale = this->Scale[0] + (this->Scale[1] - this->Scale[0]) * profile;
    const double scaleSlope = (this->Scale[1] - this->Scale[0]) * slope;
    moved[v] = this->Center[v] + scale * y;
    moved[w] = this->Center[w] + scale * z;
    jacobian[v][v] = scale;
    jacobian[w][w] = scale;
    jacobian[u][v] = scaleSlope * y;
    jacobian[u][w] = scaleSlope * z;
    return moved;
  }
  const double theta = this->Angle * profile;
  const double s = std::sin(theta);
  const double c = std::cos(theta);
  moved[v] = this->Center[v] + c * y - s * z;
  moved[w] = this->Center[w] + s * y + c * z;
  jacobian[v][v] = c;
  jacobian[v][w] = s;
  jacobian[w][v] = -s;
  jacobian[w][w] = c;
  jacobian[u][v] = this->Angle * slope * (-s * y - c * z);
  jacobian[u][w] = this->Angle * slope * (c * y - s * z);
  return moved;
}

//------------------------------------------------------------------------------
glm::dvec3 BarrDeformation::Inverse(const glm::dvec3& p) const
{
  glm::dvec3 rest = p;
  const int u = this->U;
  if (this->Kind == Shape::Bend)
  {
    const double k = this->Angle / (this->High - this->Low);
    if (k == 0.0)
    {
      return p;
    }
    const int v = this->V;
    const double y = p[u] - this->Center[u];
    const double z = p[v] - this->Center[v] - 1.0 / k;
    const double first = k * (this->Low - this->Center[u]);
    const double last = k * (this->High - this->Center[u]);
    const double middle = 0.5 * (first + last);
    // The angle as seen from the center of curvature, on the turn that the arc lies on.
    double theta = k > 0.0 ? std::atan2(y, -z) : std::atan2(-y, z);
    theta += Turn * std::round((middle - theta) / Turn);
    const double clamped = std::clamp(theta, std::min(first, last), std::max(first, last));
    const double along = this->Center[u] + clamped / k;
    if (clamped == theta)
    {
      rest[u] = along;
      rest[v] = this->Center[v] + 1.0 / k - std::copysign(std::hypot(y, z), k);
      return rest;
    }
    const double s = std::sin(clamped);
    const double c = std::cos(clamped);
    rest[u] = along + c * y + s * z;
    rest[v] = this->Center[v] + 1.0 / k - s * y + c * z;
    return rest;
  }
  const int v = this->FirstOther();
  const int w = this->SecondOther();
  const double y = p[v] - this->Center[v];
  const double z = p[w] - this->Center[w];
  double slope;
  const double profile = this->FindProfile(p[u], slope);
  if (this->Kind == Shape::Taper)
  {
    const double scale = this->Scale[0] + (this->Scale[1] - this->Scale[0]) * profile;
    rest[v] = this->Center[v] + y / scale;
    rest[w] = this->Center[w] + z / scale;
    return rest;
  }
  const double theta = this->Angle * profile;
  rest[v] = this->Center[v] + std::cos(theta) * y + std::sin(theta) * z;
  rest[w] = this->Center[w] - std::sin(theta) * y + std::cos(theta) * z;
  return rest;
}

} // namespace ffd
