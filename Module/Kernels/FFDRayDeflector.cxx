// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDRayDeflector.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Largest slope of the weight, at a distance of 1 / sqrt(5) radii.
const double LargestSlope = 6.0 / std::sqrt(5.0) * 0.64;

/// Least value of (d * weight)' at d^2 = 3/7: below -1 / (factor - 1) a scaling folds.
constexpr double LeastRadialSlope = -2.0 * 16.0 / 49.0;

/// A root of f in [low, high], f(low) <= 0 <= f(high), by bisection: f is monotonic unless the
/// deflector folds, and cheap.
template <class Function>
double FindRoot(double low, double high, const Function& f)
{
  constexpr int halvings = 60;
  for (int i = 0; i < halvings; ++i)
  {
    const double middle = 0.5 * (low + high);
    (f(middle) > 0.0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// `v` turned about a unit axis.
glm::dvec3 Turned(const glm::dvec3& v, const glm::dvec3& axis, double angle)
{
  const double c = std::cos(angle);
  return c * v + std::sin(angle) * glm::cross(axis, v) + (1.0 - c) * glm::dot(axis, v) * axis;
}

} // namespace

//------------------------------------------------------------------------------
double RayDeflector::FindWeight(double distance)
{
  const double rest = 1.0 - distance * distance;
  return rest > 0.0 ? rest * rest * rest : 0.0;
}

//------------------------------------------------------------------------------
double RayDeflector::FindWeight(const glm::dvec3& fromCenter, glm::dvec3& gradient) const
{
  const double square = this->Radius * this->Radius;
  const double rest = 1.0 - glm::dot(fromCenter, fromCenter) / square;
  if (!(rest > 0.0))
  {
    gradient = glm::dvec3(0.0);
    return 0.0;
  }
  gradient = (-6.0 * rest * rest / square) * fromCenter;
  return rest * rest * rest;
}

//------------------------------------------------------------------------------
glm::dvec3 RayDeflector::Forward(const glm::dvec3& p) const
{
  glm::dmat3 jacobian;
  return this->Forward(p, jacobian);
}

//------------------------------------------------------------------------------
glm::dvec3 RayDeflector::Forward(const glm::dvec3& p, glm::dmat3& jacobian) const
{
  const glm::dvec3 x = p - this->Center;
  glm::dvec3 gradient;
  const double weight = this->FindWeight(x, gradient);
  jacobian = glm::dmat3(1.0);
  if (weight == 0.0)
  {
    return p;
  }
  switch (this->Kind)
  {
    case Shape::Rotate:
    {
      const glm::dvec3 axis = glm::normalize(this->Vector);
      const double angle = weight * this->Angle;
      const glm::dvec3 turned = Turned(x, axis, angle);
      for (int b = 0; b < 3; ++b)
      {
        glm::dvec3 unit(0.0);
        unit[b] = 1.0;
        jacobian[b] =
          Turned(unit, axis, angle) + this->Angle * gradient[b] * glm::cross(axis, turned);
      }
      return this->Center + turned;
    }
    case Shape::Scale:
    {
      const double more = this->Factor - 1.0;
      jacobian = glm::dmat3(1.0 + weight * more) + glm::outerProduct(more * x, gradient);
      return this->Center + (1.0 + weight * more) * x;
    }
    case Shape::Translate:
    default:
      jacobian += glm::outerProduct(this->Vector, gradient);
      return p + weight * this->Vector;
  }
}

//------------------------------------------------------------------------------
glm::dvec3 RayDeflector::Inverse(const glm::dvec3& p) const
{
  const glm::dvec3 x = p - this->Center;
  const double distance = glm::length(x);
  switch (this->Kind)
  {
    case Shape::Rotate:
      // Distances from the center stay.
      return distance < this->Radius ? this->Center +
          Turned(
            x, glm::normalize(this->Vector), -this->Angle * FindWeight(distance / this->Radius))
                                     : p;
    case Shape::Scale:
    {
      if (!(distance > 0.0 && distance < this->Radius))
      {
        return p;
      }
      const double more = this->Factor - 1.0;
      const double radius = this->Radius;
      const double rest = FindRoot(0.0, radius,
        [=](double r) { return r * (1.0 + more * FindWeight(r / radius)) - distance; });
      return this->Center + (rest / distance) * x;
    }
    case Shape::Translate:
    default:
    {
      // The rest point is p - t * Vector with t the weight there.
      const double t = FindRoot(0.0, 1.0,
        [&](double s) { return s - FindWeight(glm::length(x - s * this->Vector) / this->Radius); });
      return t < 1e-15 ? p : p - t * this->Vector;
    }
  }
}

//------------------------------------------------------------------------------
bool RayDeflector::IsFoldFree() const
{
  switch (this->Kind)
  {
    case Shape::Rotate:
      return true;
    case Shape::Scale:
      return this->Factor > 0.0 && 1.0 + (this->Factor - 1.0) * LeastRadialSlope > 0.0;
    case Shape::Translate:
    default:
      return glm::length(this->Vector) * LargestSlope < this->Radius;
  }
}

} // namespace ffd
