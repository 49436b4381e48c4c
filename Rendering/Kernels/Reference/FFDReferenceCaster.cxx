// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDReferenceCaster.h"

#include "FFDCurveSegment.h"
#include "FFDPolyline.h"
#include "FFDSamplePhase.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace ffd
{

//------------------------------------------------------------------------------
ReferenceCaster::ReferenceCaster(
  const CastScene& scene, const CastSettings& settings, const Box& restBox)
  : Scene(scene)
  , Settings(settings)
{
  if (settings.Segments == Segmentation::ErrorBound && !scene.Map->IsIdentity() &&
    InvertsTheField(scene.Map->GetKind()) && !scene.Limits.OneToOne)
  {
    this->Inverse.reset(new OrientedInverse(
      *scene.Map->GetField(), scene.Map->GetTolerance(), scene.Volume, restBox));
  }
}

//------------------------------------------------------------------------------
void ReferenceCaster::Cast(const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const
{
  if (this->Scene.Blend.Mode == BlendMode::Slice)
  {
    this->CastSlice(ray, pixel, statistics);
  }
  else if (this->Settings.Segments == Segmentation::GreedyAngle)
  {
    this->CastPolyline(ray, pixel, statistics);
  }
  else
  {
    this->CastPerSample(ray, pixel, statistics);
  }
}

//------------------------------------------------------------------------------
glm::dvec3 ReferenceCaster::PullBackPoint(
  const glm::dvec3& p, const glm::dvec3* start, CastStatistics& statistics) const
{
  const PullBack& map = *this->Scene.Map;
  const bool mirrored = map.GetKind() == PullBackKind::FirstOrderOfInverse;
  const auto mirror = [&](const glm::dvec3& q) { return mirrored ? 2.0 * p - q : q; };
  PullBackStatus status;
  glm::dvec3 q;
  if (this->Inverse)
  {
    status.Converged = this->Inverse->Solve(p, start ? mirror(*start) : p, q, status.Evaluations);
    q = mirror(q);
  }
  else if (start && InvertsTheField(map.GetKind()) && !map.IsIdentity() &&
    SolveInverse(*map.GetField(), p, mirror(*start), map.GetTolerance(), q, status.Evaluations))
  {
    q = mirror(q);
  }
  else
  {
    const int before = status.Evaluations;
    q = map.Evaluate(p, status);
    status.Evaluations += before;
  }
  statistics.Evaluations += status.Evaluations;
  statistics.Unconverged += status.Converged ? 0 : 1;
  return q;
}

//------------------------------------------------------------------------------
void ReferenceCaster::CastSlice(
  const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const
{
  const glm::dvec3& normal = this->Scene.Blend.SliceNormal;
  const double slope = glm::dot(normal, ray.Viewing.Direction);
  const double t = glm::dot(normal, this->Scene.Blend.SliceOrigin - ray.Viewing.Origin) / slope;
  // False where the ray runs along the plane, too.
  if (!(t >= ray.From && t < ray.To))
  {
    return;
  }
  const glm::dvec3 p = ray.At(t);
  const glm::dvec3 q = this->Scene.Volume.ToIndex(this->PullBackPoint(p, nullptr, statistics));
  const Cropping& crop = this->Scene.Crop;
  pixel.NoteSegment(CurveSegment::Line(q, q), t, t, false);
  if (!IsInside(this->Scene.Volume, q) ||
    (crop.Space == Cropping::Spaces::Rest && !crop.Shows(q)) ||
    (crop.Space == Cropping::Spaces::Deformed && !crop.Shows(p)))
  {
    return;
  }
  ++statistics.Samples;
  const RayIntegrator::Outcome outcome = pixel.Integrator.AddSlice(q, t);
  statistics.VisibleSamples += outcome.Visible ? 1 : 0;
  pixel.NoteSample(q, t, 0.0, false, outcome.Extinction);
}

//------------------------------------------------------------------------------
void ReferenceCaster::CastPolyline(
  const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const
{
  const VolumeView& volume = this->Scene.Volume;
  PolylineWalker walker(*this->Scene.Map, this->Settings.Polyline, ray.Viewing.Origin,
    ray.Viewing.Direction, ray.From, ray.To, this->Settings.Shade);
  SegmentSampler sampler(this->Scene, this->Settings, ray, pixel, statistics);
  PolylineVertex start = walker.GetVertex();
  glm::dvec3 startIndex = volume.ToIndex(start.Rest);
  while (!pixel.Done && walker.Next())
  {
    const PolylineVertex end = walker.GetVertex();
    const glm::dvec3 endIndex = volume.ToIndex(end.Rest);
    const double dt = end.T - start.T;
    ++statistics.Segments;
    statistics.SegmentLength += dt / this->Scene.VoxelSize;
    // An empty box found on an earlier segment holds this one whole if it holds both ends.
    const bool empty = this->Settings.Leaping == SpaceLeaping::Lipschitz &&
      sampler.IsInLastEmptyBox(startIndex) && sampler.IsInLastEmptyBox(endIndex);
    const CurveSegment segment = CurveSegment::Line(startIndex, endIndex);
    pixel.NoteSegment(segment, start.T, end.T, empty);
    if (!empty)
    {
      sampler.ForgetEmptyBox();
      const double length = glm::length(volume.IndexToData * segment.Terms[1]);
      const auto jacobianAt = [&](
                                double s) { return start.Jacobian * (1.0 - s) + end.Jacobian * s; };
      sampler.Integrate(
        JacobianSegment<decltype(jacobianAt)>(volume, segment, start.T, dt, jacobianAt),
        ScheduleWithRemainder(length, this->Settings.SampleDistance, ray.Jitter));
    }
    start = end;
    startIndex = endIndex;
  }
  statistics.Evaluations += walker.GetEvaluations();
  statistics.Unconverged += walker.GetUnconverged();
}

//------------------------------------------------------------------------------
void ReferenceCaster::CastPerSample(
  const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const
{
  const VolumeView& volume = this->Scene.Volume;
  const PullBack& map = *this->Scene.Map;
  const bool identity = map.IsIdentity();
  const bool intervals = this->Scene.Blend.UsesIntervals();
  const double distance = this->Settings.SampleDistance;
  SegmentSampler sampler(this->Scene, this->Settings, ray, pixel, statistics);

  // Phi at t, data coordinates. `start`: an estimate of it.
  const auto pullBack = [&](double t, const glm::dvec3* start) {
    return this->PullBackPoint(ray.At(t), start, statistics);
  };

  // Both ends by the same arithmetic, see SampleSlack.
  const double slack = SampleSlack + ray.Phase;
  const double early = intervals ? 1.0 - SampleSlack + ray.Phase : slack;
  const double first = std::ceil(ray.From / distance - early);
  const double stop = std::ceil(ray.To / distance - slack);
  if (!(first < stop))
  {
    // Too short for a sample: a segment without one.
    ++statistics.Segments;
    statistics.SegmentLength += (ray.To - ray.From) / this->Scene.VoxelSize;
    pixel.NoteSegment(CurveSegment::Line(volume.ToIndex(pullBack(ray.From, nullptr)),
                        volume.ToIndex(pullBack(ray.To, nullptr))),
      ray.From, ray.To, false);
    return;
  }
  // Curves lead to the next sample; where intervals are classified, from the one before. That may
  // lie outside of the volume where T^-1 of a point by itself leads elsewhere.
  const double behind = this->Settings.Classify == Classification::Intervals ? 1.0 : 0.0;
  glm::dvec3 rest = pullBack((first + ray.Phase) * distance, nullptr);
  glm::dvec3 move(0.0);
  if (behind > 0.0)
  {
    const glm::dvec3 firstRest = rest;
    rest = pullBack((first - behind + ray.Phase) * distance, &firstRest);
    move = firstRest - rest;
  }
  glm::dvec3 index = volume.ToIndex(rest);
  for (double n = first; n < stop && !pixel.Done; n += 1.0)
  {
    const double t = (n - behind + ray.Phase) * distance;
    const glm::dvec3 guess = rest + move;
    const glm::dvec3 nextRest = pullBack(t + distance, &guess);
    const glm::dvec3 next = volume.ToIndex(nextRest);
    CurveSegment segment = CurveSegment::Line(index, next);
    if ((intervals || behind > 0.0) && !identity)
    {
      const glm::dvec3 halfway = rest + 0.5 * move;
      segment =
        CurveSegment::Parabola(index, volume.ToIndex(pullBack(t + 0.5 * distance, &halfway)), next);
    }
    ++statistics.Segments;
    statistics.SegmentLength += distance / this->Scene.VoxelSize;
    pixel.NoteSegment(segment, t, t + distance, false);
    const auto jacobianAt = [&](double s) {
      const glm::dvec3 q = volume.IndexToData * segment.At(s) + volume.FirstVoxel;
      return map.FindJacobian(ray.At(t + s * distance), q);
    };
    SampleSchedule schedule;
    schedule.Count = 1;
    schedule.First = behind;
    schedule.Step = 1.0;
    schedule.LastInterval = 1.0;
    sampler.Integrate(
      JacobianSegment<decltype(jacobianAt)>(volume, segment, t, distance, jacobianAt), schedule);
    move = nextRest - rest;
    rest = nextRest;
    index = next;
  }
}

} // namespace ffd
