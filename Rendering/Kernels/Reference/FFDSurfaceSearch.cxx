// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSurfaceSearch.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>

namespace ffd
{
namespace
{

/// Length of the next step, as a part of the longest one, so that not every second step has to be
/// repeated.
constexpr double Aim = 0.9;

/// Longest step, voxels along the ray, however little the material moves there.
constexpr double LongestOnRay = 4.0;

double ShortestEdge(const glm::dmat3& fromIndex)
{
  return std::min(
    glm::length(fromIndex[0]), std::min(glm::length(fromIndex[1]), glm::length(fromIndex[2])));
}

double LargestComponent(const glm::dvec3& v)
{
  const glm::dvec3 size = glm::abs(v);
  return std::max(size.x, std::max(size.y, size.z));
}

} // namespace

//------------------------------------------------------------------------------
SurfaceSearch::SurfaceSearch(const VolumeView& volume, const PullBack& map,
  const glm::dvec3& origin, const glm::dvec3& direction, bool oneToOne)
  : Volume(volume)
  , Map(map.GetField(), map.GetKind(), Accuracy * ShortestEdge(volume.IndexToData))
  , Origin(origin)
  , Direction(direction)
  , TPerVoxel(ShortestEdge(volume.IndexToData) / std::max(glm::length(direction), 1e-300))
  , OneToOne(oneToOne)
{
}

//------------------------------------------------------------------------------
SurfacePoint SurfaceSearch::Evaluate(double t) const
{
  SurfacePoint point;
  point.T = t;
  point.Deformed = this->Origin + t * this->Direction;
  point.Rest = this->Map.IsIdentity() ? point.Deformed : this->FindRest(point.Deformed);
  point.Index = this->Volume.ToIndex(point.Rest);
  return point;
}

//------------------------------------------------------------------------------
glm::dvec3 SurfaceSearch::FindRest(const glm::dvec3& deformed) const
{
  PullBackStatus status;
  const glm::dvec3 rest = this->Map.Evaluate(deformed, status);
  if (!InvertsTheField(this->Map.GetKind()) ||
    (status.Converged && (this->OneToOne || this->IsInside(this->Volume.ToIndex(rest)))))
  {
    return rest;
  }
  if (!this->Inverse)
  {
    this->Inverse.reset(new OrientedInverse(*this->Map.GetField(), this->Map.GetTolerance(),
      this->Volume, { this->Volume.LowerIndex(), this->Volume.UpperIndex() }));
  }
  const bool mirrored = this->Map.GetKind() == PullBackKind::FirstOrderOfInverse;
  glm::dvec3 q;
  int evaluations = 0;
  const bool found = this->Inverse->Solve(deformed, deformed, q, evaluations);
  q = mirrored ? 2.0 * deformed - q : q;
  return found && this->IsInside(this->Volume.ToIndex(q)) ? q : rest;
}

//------------------------------------------------------------------------------
glm::dmat3 SurfaceSearch::EvaluateJacobian(const SurfacePoint& point) const
{
  glm::dmat3 jacobian(1.0);
  if (!this->Map.IsIdentity())
  {
    jacobian = this->Map.FindJacobian(point.Deformed, point.Rest);
  }
  return jacobian;
}

//------------------------------------------------------------------------------
bool SurfaceSearch::IsInside(const glm::dvec3& q) const
{
  const glm::dvec3 lower = this->Volume.LowerIndex();
  const glm::dvec3 upper = this->Volume.UpperIndex();
  return q.x >= lower.x && q.y >= lower.y && q.z >= lower.z && q.x <= upper.x && q.y <= upper.y &&
    q.z <= upper.z;
}

//------------------------------------------------------------------------------
/// Narrow two points, `after` of them beyond something, to neighbors in floating point.
void SurfaceSearch::Bisect(const Condition& beyond, SurfacePoint& before, SurfacePoint& after) const
{
  while (true)
  {
    const double middle = 0.5 * (before.T + after.T);
    if (!(middle > before.T && middle < after.T))
    {
      return;
    }
    const SurfacePoint point = this->Evaluate(middle);
    (beyond(point) ? after : before) = point;
  }
}

//------------------------------------------------------------------------------
bool SurfaceSearch::FindFirst(double from, double to, const Condition& condition,
  const Label& label, SurfacePoint& hit, SurfacePoint& before) const
{
  if (!(from <= to))
  {
    return false;
  }
  before = this->Evaluate(from);
  if (condition(before))
  {
    hit = before;
    return true;
  }
  int lastLabel = label(before);
  double step = LongestStep * this->TPerVoxel;
  while (before.T < to)
  {
    hit = this->Evaluate(std::min(before.T + step, to));
    const double moved = LargestComponent(hit.Index - before.Index);
    if (moved > LongestStep && step > ShortestStep * this->TPerVoxel)
    {
      step *= std::max(0.25, Aim * LongestStep / moved);
      continue;
    }
    if (!(hit.T > before.T))
    {
      return false; // steps are lost in rounding
    }
    if (label(hit) != lastLabel)
    {
      SurfacePoint inLast = before;
      this->Bisect(
        [&](const SurfacePoint& point) { return label(point) != lastLabel; }, inLast, hit);
      if (!condition(hit))
      {
        if (!condition(inLast))
        {
          before = hit;
          lastLabel = label(hit);
          continue;
        }
        hit = inLast;
      }
    }
    if (condition(hit))
    {
      this->Bisect(condition, before, hit);
      return true;
    }
    before = hit;
    step *= moved > 0.0 ? std::min(2.0, Aim * LongestStep / moved) : 2.0;
    step = std::clamp(step, ShortestStep * this->TPerVoxel, LongestOnRay * this->TPerVoxel);
  }
  return false;
}

} // namespace ffd
