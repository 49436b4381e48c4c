// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTileSpans.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

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
void TileSpans::Find(int index, Span& span) const
{
  const double t[2] = { index * this->Settings.Length, (index + 1) * this->Settings.Length };
  Box box{ this->Origins[0] + t[0] * this->Directions[0],
    this->Origins[0] + t[0] * this->Directions[0] };
  for (int c = 0; c < 4; ++c)
  {
    for (const double end : t)
    {
      const glm::dvec3 p = this->Origins[c] + end * this->Directions[c];
      box.Min = glm::min(box.Min, p);
      box.Max = glm::max(box.Max, p);
    }
  }
  const double margin = this->Sagitta * std::max(std::abs(t[0]), std::abs(t[1]));
  box.Min -= margin;
  box.Max += margin;

  const MapBounds bounds = this->Bounds->Over(box);
  span.Known = true;

  // Error of the parabola through three points a distance d apart: |d3Q/dt3| d^3 / (9 sqrt 3).
  const double third = bounds.ThirdDerivative * this->VoxelsPerDataUnit * this->LargestSpeed *
    this->LargestSpeed * this->LargestSpeed;
  const auto errorOf = [third](double half)
  { return third > 0.0 ? third * half * half * half / (9.0 * std::sqrt(3.0)) : 0.0; };
  const double tolerance = 0.5 * this->Settings.PositionTolerance;
  double half = 0.5 * this->Settings.Length;
  span.Level = 0;
  while (span.Level < this->Settings.LargestLevel && !(errorOf(half) <= tolerance))
  {
    ++span.Level;
    half *= 0.5;
  }
  span.PositionError = errorOf(half);

  // Four equidistant nodes, spacing d, |d3f/du3| <= M: the interpolation error is at most
  // 0.0713 M d^3 (Peano kernel), once for each direction, the second amplified by the Lebesgue
  // constant 1.632 of the first. The parabola in t amplifies what its points have by 5/4.
  double across = 0.0;
  glm::dvec3 alongX(0.0);
  glm::dvec3 alongY(0.0);
  for (const double end : t)
  {
    glm::dvec3 p[4];
    for (int c = 0; c < 4; ++c)
    {
      p[c] = this->Origins[c] + end * this->Directions[c];
    }
    alongX = glm::max(alongX, glm::max(glm::abs(p[1] - p[0]), glm::abs(p[3] - p[2])));
    alongY = glm::max(alongY, glm::max(glm::abs(p[2] - p[0]), glm::abs(p[3] - p[1])));
    across = std::max({ across, glm::length(p[1] - p[0]), glm::length(p[3] - p[2]),
      glm::length(p[2] - p[0]), glm::length(p[3] - p[1]) });
  }
  // M d^3 follows from the derivatives P1, P2, P3 of the rays by steps of a node by the chain rule:
  // Phi3(P1, P1, P1) + 3 Phi2(P1, P2) + Phi1(P3).
  const double farthest = std::max(std::abs(t[0]), std::abs(t[1]));
  const double second = farthest * this->Settings.DirectionBend2;
  // A side of the tile is three steps; within the tile P1 differs from its mean over a side by at
  // most a step and a half of P2 along that side and as much across.
  const double first = across / 3.0 + 3.0 * second;
  // What does not move has no error, however unbounded the map is.
  const auto product = [](double bound, double moves) { return moves > 0.0 ? bound * moves : 0.0; };
  const double bend = product(bounds.ThirdDerivative, first * first * first) +
    product(bounds.SecondDerivative, 3.0 * first * second) +
    product(FindLargestStretch(bounds.JacobianMin, bounds.JacobianMax),
      farthest * this->Settings.DirectionBend3);
  const double lateral = 1.25 * 0.0713 * (1.0 + 1.632) * bend * this->VoxelsPerDataUnit;
  span.Lateral = lateral <= tolerance;
  span.PositionError += span.Lateral ? lateral : 0.0;

  span.Bounded = std::isfinite(span.PositionError);
  for (int column = 0; column < 3; ++column)
  {
    span.Bounded = span.Bounded && AllFinite(bounds.JacobianMin[column]) &&
      AllFinite(bounds.JacobianMax[column]);
  }
  if (span.Bounded)
  {
    glm::dvec3 lo;
    glm::dvec3 hi;
    MultiplyIntervals(bounds.JacobianMin, bounds.JacobianMax, this->DirectionMin,
      this->DirectionMax, lo, hi);
    MultiplyIntervals(
      this->DataToIndex, this->DataToIndex, lo, hi, span.VelocityMin, span.VelocityMax);
    // Half the distance between nodes is a sixth of the tile.
    const glm::dvec3 reach = (alongX + alongY) / 6.0 + 2.0 * margin;
    glm::dvec3 moved(0.0);
    span.NodeRadius = glm::dvec3(0.0);
    for (int column = 0; column < 3; ++column)
    {
      moved += reach[column] *
        glm::max(glm::abs(bounds.JacobianMin[column]), glm::abs(bounds.JacobianMax[column]));
    }
    for (int column = 0; column < 3; ++column)
    {
      span.NodeRadius += moved[column] * glm::abs(this->DataToIndex[column]);
    }
  }
}

} // namespace ffd
