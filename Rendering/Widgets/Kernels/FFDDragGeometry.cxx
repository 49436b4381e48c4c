// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDragGeometry.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Below this sine between a line of sight and an axis (or plane) it counts as end on.
constexpr double EndOn = 0.05;

/// Below this cosine between the view and the axis of a rotation its plane is edge on.
constexpr double EdgeOn = 0.2;

constexpr double SmallestFactor = 0.01;

/// Finds the t at which the line point + t * axis is nearest to a line of sight.
std::optional<double> FindNearestOnLine(
  const LineOfSight& line, const glm::dvec3& point, const glm::dvec3& axis)
{
  const glm::dvec3 between = point - line.Origin;
  const double aa = glm::dot(axis, axis);
  const double ad = glm::dot(axis, line.Direction);
  const double sine2 = aa - ad * ad;
  if (!(sine2 > EndOn * EndOn * aa))
  {
    return std::nullopt;
  }
  return (ad * glm::dot(line.Direction, between) - glm::dot(axis, between)) / sine2;
}

std::optional<glm::dvec3> FindOnPlane(
  const LineOfSight& line, const glm::dvec3& point, const glm::dvec3& normal)
{
  const double cosine = glm::dot(line.Direction, normal);
  if (!(std::abs(cosine) > EndOn * glm::length(normal)))
  {
    return std::nullopt;
  }
  return line.Origin + glm::dot(point - line.Origin, normal) / cosine * line.Direction;
}

} // namespace

//------------------------------------------------------------------------------
bool IsAlongAxis(MoveConstraint constraint)
{
  return constraint >= MoveConstraint::AlongX && constraint <= MoveConstraint::AlongZ;
}

//------------------------------------------------------------------------------
int GetAxis(MoveConstraint constraint)
{
  return constraint == MoveConstraint::Free
    ? -1
    : (static_cast<int>(constraint) - static_cast<int>(MoveConstraint::AlongX)) % 3;
}

//------------------------------------------------------------------------------
glm::dvec3 GetUnitVector(int axis)
{
  glm::dvec3 unit(0.0);
  unit[axis] = 1.0;
  return unit;
}

//------------------------------------------------------------------------------
std::optional<glm::dvec3> FindConstrainedMove(MoveConstraint constraint, const glm::dvec3& anchor,
  const LineOfSight& from, const LineOfSight& to)
{
  const int axis = GetAxis(constraint);
  const glm::dvec3 unit = GetUnitVector(axis);
  if (IsAlongAxis(constraint))
  {
    const std::optional<double> t0 = FindNearestOnLine(from, anchor, unit);
    const std::optional<double> t1 = FindNearestOnLine(to, anchor, unit);
    if (!t0 || !t1)
    {
      return std::nullopt;
    }
    return (*t1 - *t0) * unit;
  }
  const std::optional<glm::dvec3> p0 = FindOnPlane(from, anchor, unit);
  const std::optional<glm::dvec3> p1 = FindOnPlane(to, anchor, unit);
  if (!p0 || !p1)
  {
    return std::nullopt;
  }
  glm::dvec3 move = *p1 - *p0;
  move[axis] = 0.0;
  return move;
}

//------------------------------------------------------------------------------
std::optional<double> FindDragAngle(const glm::dvec3& axis, const glm::dvec3& center,
  const glm::dvec3& view, const LineOfSight& from, const LineOfSight& to)
{
  const std::optional<glm::dvec3> p0 = FindOnPlane(from, center, axis);
  const std::optional<glm::dvec3> p1 = FindOnPlane(to, center, axis);
  if (!p0 || !p1 || !(std::abs(glm::dot(axis, view)) > EdgeOn))
  {
    return std::nullopt;
  }
  const glm::dvec3 a = *p0 - center;
  const glm::dvec3 b = *p1 - center;
  return std::atan2(glm::dot(glm::cross(a, b), axis), glm::dot(a, b));
}

//------------------------------------------------------------------------------
std::optional<double> FindDragFactor(
  int axis, const glm::dvec3& center, const LineOfSight& from, const LineOfSight& to)
{
  const glm::dvec3 unit = GetUnitVector(axis);
  const std::optional<double> t0 = FindNearestOnLine(from, center, unit);
  const std::optional<double> t1 = FindNearestOnLine(to, center, unit);
  if (!t0 || !t1 || !(std::abs(*t0) > 0.0))
  {
    return std::nullopt;
  }
  return std::max(SmallestFactor, *t1 / *t0);
}

//------------------------------------------------------------------------------
glm::dvec3 FindScreenMove(MoveConstraint constraint, double right, double up,
  const glm::dvec3& viewRight, const glm::dvec3& viewUp)
{
  if (IsAlongAxis(constraint))
  {
    return (right + up) * GetUnitVector(GetAxis(constraint));
  }
  const auto along = [constraint](glm::dvec3 direction) {
    if (constraint != MoveConstraint::Free)
    {
      direction[GetAxis(constraint)] = 0.0;
    }
    const double length = glm::length(direction);
    return length > 0.0 ? direction / length : direction;
  };
  return right * along(viewRight) + up * along(viewUp);
}

} // namespace ffd
