// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTileSpans.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

bool AllFinite(const glm::dvec3& v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Adds the range of a * b to [lo, hi].
void AddProduct(double aMin, double aMax, double bMin, double bMax, double& lo, double& hi)
{
  const double p[4] = { aMin * bMin, aMin * bMax, aMax * bMin, aMax * bMax };
  lo += std::min(std::min(p[0], p[1]), std::min(p[2], p[3]));
  hi += std::max(std::max(p[0], p[1]), std::max(p[2], p[3]));
}

/// Range of m * v for an interval matrix and an interval vector.
void MultiplyIntervals(const glm::dmat3& mMin, const glm::dmat3& mMax, const glm::dvec3& vMin,
  const glm::dvec3& vMax, glm::dvec3& lo, glm::dvec3& hi)
{
  glm::dvec3 sumMin(0.0);
  glm::dvec3 sumMax(0.0);
  for (int column = 0; column < 3; ++column)
  {
    for (int row = 0; row < 3; ++row)
    {
      AddProduct(mMin[column][row], mMax[column][row], vMin[column], vMax[column], sumMin[row],
        sumMax[row]);
    }
  }
  lo = sumMin;
  hi = sumMax;
}

/// Upper bound of the spectral norm, at most 1 % above it: |M|^2 = |B| with B = M^T M, and
/// |B| <= |B^32|_F^(1/32) <= 3^(1/64) |B|.
double FindLargestStretch(const glm::dmat3& m)
{
  const auto frobenius = [](const glm::dmat3& a)
  { return std::sqrt(glm::dot(a[0], a[0]) + glm::dot(a[1], a[1]) + glm::dot(a[2], a[2])); };
  const double scale = frobenius(m);
  if (!(scale > 0.0))
  {
    return scale;
  }
  const glm::dmat3 unit = m / scale;
  glm::dmat3 power = glm::transpose(unit) * unit;
  for (int squaring = 0; squaring < 5; ++squaring)
  {
    power = power * power;
  }
  return scale * std::pow(frobenius(power), 1.0 / 64.0);
}

/// Upper bound of the spectral norm of any matrix in an interval.
double FindLargestStretch(const glm::dmat3& mMin, const glm::dmat3& mMax)
{
  double sum = 0.0;
  for (int column = 0; column < 3; ++column)
  {
    const glm::dvec3 most = glm::max(glm::abs(mMin[column]), glm::abs(mMax[column]));
    sum += glm::dot(most, most);
  }
  return std::sqrt(sum);
}

glm::dmat3 Largest(const glm::dmat3& a, const glm::dmat3& b)
{
  return glm::dmat3(glm::max(a[0], b[0]), glm::max(a[1], b[1]), glm::max(a[2], b[2]));
}

glm::dmat3 Smallest(const glm::dmat3& a, const glm::dmat3& b)
{
  return glm::dmat3(glm::min(a[0], b[0]), glm::min(a[1], b[1]), glm::min(a[2], b[2]));
}

} // namespace

//------------------------------------------------------------------------------
void SetDirectionBends(
  SpanSettings& settings, const CameraView& camera, const glm::dmat3& worldToData)
{
  // From the near to the far plane: affine in the image position. The directions are these vectors
  // over their lengths, and the shortest is as long as their plane is far from the origin.
  const auto path = [&camera](double x, double y)
  {
    const ViewRay ray = camera.MakeRay(x, y);
    return ray.Far * ray.Direction;
  };
  const double width = std::max(1, camera.ImageSize.x);
  const double height = std::max(1, camera.ImageSize.y);
  const glm::dvec3 start = path(0.0, 0.0);
  const glm::dvec3 perX = (path(width, 0.0) - start) / width;
  const glm::dvec3 perY = (path(0.0, height) - start) / height;
  const double steepest = std::max(glm::length(perX), glm::length(perY));
  settings.DirectionBend2 = 0.0;
  settings.DirectionBend3 = 0.0;
  // Parallel rays, but for rounding.
  if (!(steepest * std::max(width, height) > 1e-9 * glm::length(start)))
  {
    return;
  }
  const glm::dvec3 normal = glm::cross(perX, perY);
  const double distance = std::abs(glm::dot(start, normal)) / glm::length(normal);
  constexpr double PixelsPerNode = 5.0;
  const double angle = PixelsPerNode * steepest / distance;
  // Along a line that passes the origin at distance 1 with speed k a unit vector has derivatives of
  // at most k, 2 k^2 / sqrt 3 and 3 k^3.
  const double scale = FindLargestStretch(worldToData);
  settings.DirectionBend2 = scale * 2.0 / std::sqrt(3.0) * angle * angle;
  settings.DirectionBend3 = scale * 3.0 * angle * angle * angle;
}

//------------------------------------------------------------------------------
void TileSpans::Start(const DeformedSpaceBounds& bounds, const SpanSettings& settings,
  const glm::dmat3& dataToIndex, const glm::dvec3 origins[4], const glm::dvec3 directions[4],
  double tMin, double tMax)
{
  this->Bounds = &bounds;
  this->Settings = settings;
  this->DataToIndex = dataToIndex;
  this->VoxelsPerDataUnit = FindLargestStretch(dataToIndex);
  this->DirectionMin = directions[0];
  this->DirectionMax = directions[0];
  this->LargestSpeed = 0.0;
  double across = 0.0;
  for (int c = 0; c < 4; ++c)
  {
    this->Origins[c] = origins[c];
    this->Directions[c] = directions[c];
    this->DirectionMin = glm::min(this->DirectionMin, directions[c]);
    this->DirectionMax = glm::max(this->DirectionMax, directions[c]);
    this->LargestSpeed = std::max(this->LargestSpeed, glm::length(directions[c]));
    across = std::max(across, glm::length(directions[c] - directions[0]));
  }
  // Directions have unit length in the world, so they lie on a cap, a little beyond the box of its
  // corners; the square of the chord is more than that, whatever the scale of the volume's matrix.
  this->Sagitta =
    this->LargestSpeed > 0.0 ? across * across / this->LargestSpeed + 1e-12 * this->LargestSpeed : 0.0;
  // The same from the rays' second derivatives, (3 nodes)^2 / 8 of them along either side.
  this->Sagitta = std::max(this->Sagitta, 2.25 * settings.DirectionBend2);
  this->DirectionMin -= this->Sagitta;
  this->DirectionMax += this->Sagitta;
  this->LargestSpeed += this->Sagitta;

  this->First = static_cast<int>(std::floor(tMin / settings.Length));
  const int last = static_cast<int>(std::floor(tMax / settings.Length)) + 1;
  this->Spans.assign(static_cast<std::size_t>(std::max(1, last - this->First + 1)), Span());
}

//------------------------------------------------------------------------------
struct TileSpans::Course
{
  Box Space;             // that the rays cross
  glm::dvec3 AlongX;     // sides of the tile, largest
  glm::dvec3 AlongY;
  VectorRange NodeX;     // steps from node to node
  VectorRange NodeY;
  double NodeSecond;     // bounds of the second and third derivatives by such steps
  double NodeThird;
  double NodeFirst;      // of the first
  double Margin;
};

//------------------------------------------------------------------------------
struct TileSpans::LocalCourse
{
  glm::dmat3 JacobianMin;
  glm::dmat3 JacobianMax;
  double Stretch = 0.0;
  double Third = 0.0; ///< of the rays by t
  /// By steps of a node along the sides of the tile, all but what the Jacobian makes of their bends.
  double Bends[2] = { 0.0, 0.0 };
};

//------------------------------------------------------------------------------
TileSpans::Course TileSpans::FindCourse(const double t[2]) const
{
  Course course;
  course.Space = { glm::dvec3(std::numeric_limits<double>::infinity()),
    glm::dvec3(-std::numeric_limits<double>::infinity()) };
  course.AlongX = glm::dvec3(0.0);
  course.AlongY = glm::dvec3(0.0);
  double across = 0.0;
  Box sidesX = course.Space;
  Box sidesY = course.Space;
  const auto include = [](Box& box, const glm::dvec3& p)
  {
    box.Min = glm::min(box.Min, p);
    box.Max = glm::max(box.Max, p);
  };
  for (int end = 0; end < 2; ++end)
  {
    glm::dvec3 p[4];
    for (int c = 0; c < 4; ++c)
    {
      p[c] = this->Origins[c] + t[end] * this->Directions[c];
      include(course.Space, p[c]);
    }
    for (int side = 0; side < 2; ++side)
    {
      const glm::dvec3 x = p[2 * side + 1] - p[2 * side];
      const glm::dvec3 y = p[2 + side] - p[side];
      include(sidesX, x);
      include(sidesY, y);
      course.AlongX = glm::max(course.AlongX, glm::abs(x));
      course.AlongY = glm::max(course.AlongY, glm::abs(y));
      across = std::max({ across, glm::length(x), glm::length(y) });
    }
  }
  const double farthest = std::max(std::abs(t[0]), std::abs(t[1]));
  course.Margin = this->Sagitta * farthest;
  course.Space.Min -= course.Margin;
  course.Space.Max += course.Margin;
  course.NodeSecond = farthest * this->Settings.DirectionBend2;
  course.NodeThird = farthest * this->Settings.DirectionBend3;
  // A side of the tile is three steps; within the tile a step differs from its mean over a side by
  // at most a step and a half of the second derivative along that side and as much across.
  course.NodeFirst = across / 3.0 + 3.0 * course.NodeSecond;
  const auto steps = [&](const Box& sides)
  {
    return VectorRange{ (sides.Min + sides.Max) / 6.0,
      (sides.Max - sides.Min) / 6.0 + 3.0 * course.NodeSecond };
  };
  course.NodeX = steps(sidesX);
  course.NodeY = steps(sidesY);
  return course;
}

//------------------------------------------------------------------------------
void TileSpans::SetPieces(double third, const double bends[2], Span& span) const
{
  // Error of the parabola through three points a distance d apart: |d3Q/dt3| d^3 / (9 sqrt 3).
  const double along = third * this->VoxelsPerDataUnit;
  const auto errorOf = [along](double half)
  { return along > 0.0 ? along * half * half * half / (9.0 * std::sqrt(3.0)) : 0.0; };
  const double tolerance = 0.5 * this->Settings.PositionTolerance;
  const double longest = 0.5 * this->Settings.Length;
  span.Level = 0;
  while (span.Level < this->Settings.LargestLevel &&
    !(errorOf(std::ldexp(longest, -span.Level)) <= tolerance))
  {
    ++span.Level;
  }
  // Where nothing is proven, the shortest pieces would prove nothing, either.
  if (!std::isfinite(along))
  {
    span.Level = std::min(this->Settings.LargestLevel, this->Settings.UnprovenLevel);
  }
  const double half = std::ldexp(longest, -span.Level);
  span.PositionError = errorOf(half);

  // Four equidistant nodes, spacing d, |d3f/du3| <= M: the interpolation error is at most
  // 0.0713 M d^3 (Peano kernel), once for each direction, the second amplified by the Lebesgue
  // constant 1.632 of the first, whichever comes first. The parabola in t amplifies what its points
  // have by 5/4.
  const double both = std::max(bends[0], bends[1]) + 1.632 * std::min(bends[0], bends[1]);
  const double lateral = 1.25 * 0.0713 * both * this->VoxelsPerDataUnit;
  // Nodes of a quarter are less than half as far apart: all terms of the bends fall by that cubed.
  const double inQuarters = lateral / 8.0;
  // What the parabola has left of the tolerance.
  const double left = this->Settings.PositionTolerance - span.PositionError;
  span.Lateral = lateral <= left;
  span.LateralInQuarters = !span.Lateral && inQuarters <= left;
  span.PositionError += span.Lateral ? lateral : span.LateralInQuarters ? inQuarters : 0.0;
}

//------------------------------------------------------------------------------
void TileSpans::SetMotion(const Course& course, const glm::dmat3& jacobianMin,
  const glm::dmat3& jacobianMax, Span& span) const
{
  span.Bounded = std::isfinite(span.PositionError);
  for (int column = 0; column < 3; ++column)
  {
    span.Bounded =
      span.Bounded && AllFinite(jacobianMin[column]) && AllFinite(jacobianMax[column]);
  }
  if (!span.Bounded)
  {
    return;
  }
  glm::dvec3 lo;
  glm::dvec3 hi;
  MultiplyIntervals(jacobianMin, jacobianMax, this->DirectionMin, this->DirectionMax, lo, hi);
  MultiplyIntervals(
    this->DataToIndex, this->DataToIndex, lo, hi, span.VelocityMin, span.VelocityMax);
  // Half the distance between nodes is a sixth of the tile.
  const glm::dvec3 reach = (course.AlongX + course.AlongY) / 6.0 + 2.0 * course.Margin;
  glm::dvec3 moved(0.0);
  for (int column = 0; column < 3; ++column)
  {
    moved +=
      reach[column] * glm::max(glm::abs(jacobianMin[column]), glm::abs(jacobianMax[column]));
  }
  span.NodeRadius = glm::dvec3(0.0);
  for (int column = 0; column < 3; ++column)
  {
    span.NodeRadius += moved[column] * glm::abs(this->DataToIndex[column]);
  }
}

//------------------------------------------------------------------------------
void TileSpans::Find(int index, Span& span) const
{
  const double t[2] = { index * this->Settings.Length, (index + 1) * this->Settings.Length };
  const Course course = this->FindCourse(t);
  span.Known = true;

  // How positions bend from node to node follows from the derivatives P1, P2, P3 of the rays by
  // steps of a node by the chain rule: Phi3(P1, P1, P1) + 3 Phi2(P1, P2) + Phi1(P3). What does not
  // move has no error, however unbounded the map is.
  const auto product = [](double bound, double moves) { return moves > 0.0 ? bound * moves : 0.0; };
  const double first = course.NodeFirst;
  const double second = course.NodeSecond;

  const MapBounds bounds = this->Bounds->Over(course.Space);
  const double stretch = FindLargestStretch(bounds.JacobianMin, bounds.JacobianMax);
  const double speed = this->LargestSpeed;
  const double third = product(bounds.ThirdDerivative, speed * speed * speed);
  const double bend = product(bounds.ThirdDerivative, first * first * first) +
    product(bounds.SecondDerivative, 3.0 * first * second) + product(stretch, course.NodeThird);
  const double bends[2] = { bend, bend };
  this->SetPieces(third, bends, span);
  this->SetMotion(course, bounds.JacobianMin, bounds.JacobianMax, span);
  if (span.Level == 0 && span.Lateral && span.Bounded)
  {
    return;
  }

  // Other branches of an inverse are none of what is found around a point of one.
  LocalCourse local;
  if (!(span.Bounded || this->Bounds->IsOneToOne()) || !this->FindLocalCourse(course, local))
  {
    return;
  }
  const double further = product(local.Stretch, course.NodeThird);
  const double closer[2] = { std::min(bend, local.Bends[0] + further),
    std::min(bend, local.Bends[1] + further) };
  this->SetPieces(std::min(third, local.Third), closer, span);
  this->SetMotion(course, Largest(bounds.JacobianMin, local.JacobianMin),
    Smallest(bounds.JacobianMax, local.JacobianMax), span);
}

//------------------------------------------------------------------------------
bool TileSpans::FindLocalCourse(const Course& course, LocalCourse& local) const
{
  LocalMap map;
  if (!this->Bounds->GetLocal().Find(course.Space, map))
  {
    return false;
  }
  local.JacobianMin = map.JacobianMin;
  local.JacobianMax = map.JacobianMax;
  local.Stretch = FindLargestStretch(map.JacobianMin, map.JacobianMax);
  local.Third = map.ThirdAlong({ 0.5 * (this->DirectionMin + this->DirectionMax),
    0.5 * (this->DirectionMax - this->DirectionMin) });
  const double first = course.NodeFirst;
  const double second = course.NodeSecond;
  const VectorRange steps[2] = { course.NodeX, course.NodeY };
  for (int side = 0; side < 2; ++side)
  {
    const VectorRange& step = steps[side];
    double bend = map.ThirdAlong(step);
    if (second > 0.0)
    {
      // 4 Phi2(P1, P2) = Phi2(P1 + P2, P1 + P2) - Phi2(P1 - P2, P1 - P2), with P2 as long as P1.
      VectorRange either = step;
      either.Spread += first;
      bend += 3.0 * second / first * 0.5 * map.SecondAlong(either);
    }
    local.Bends[side] = bend;
  }
  return true;
}

} // namespace ffd
