// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSegmentSampler.h"

#include <algorithm>

namespace ffd
{
namespace
{

/// Distance, index units, that a leap keeps from the faces of the empty box, for rounding errors.
constexpr double LeapGuard = 1e-3;

bool Contains(const EmptyBox& box, const glm::dvec3& q)
{
  return q.x >= box.Min.x && q.y >= box.Min.y && q.z >= box.Min.z && q.x <= box.Max.x &&
    q.y <= box.Max.y && q.z <= box.Max.z;
}

/// Counts the further steps of `ds` from s of the segment that stay inside the box for certain.
int CountStepsInside(
  const CurveSegment& segment, double s, double ds, int stepsLeft, const EmptyBox& box)
{
  const glm::dvec3 q = segment.At(s);
  const glm::dvec3 v0 = segment.Velocity(s);
  // The velocity is linear in s, so the ends of what is left of the segment bound it.
  const glm::dvec3 v1 = segment.Velocity(s + stepsLeft * ds);
  double steps = stepsLeft;
  for (int a = 0; a < 3; ++a)
  {
    const double up = std::max(v0[a], v1[a]) * ds;
    const double down = -std::min(v0[a], v1[a]) * ds;
    if (up > 0.0)
    {
      steps = std::min(steps, (box.Max[a] - q[a] - LeapGuard) / up);
    }
    if (down > 0.0)
    {
      steps = std::min(steps, (q[a] - box.Min[a] - LeapGuard) / down);
    }
  }
  return steps > 0.0 ? static_cast<int>(steps) : 0;
}

} // namespace

//------------------------------------------------------------------------------
bool IsInside(const VolumeView& volume, const glm::dvec3& q)
{
  const double lower = -volume.Margin;
  const glm::dvec3 upper = volume.UpperIndex();
  // False for positions that are not a number, too.
  return q.x >= lower && q.y >= lower && q.z >= lower && q.x <= upper.x && q.y <= upper.y &&
    q.z <= upper.z;
}

//------------------------------------------------------------------------------
void SegmentSampler::Integrate(const SampledSegment& segment, const SampleSchedule& schedule)
{
  const VolumeView& volume = this->Scene.Volume;
  const glm::dvec3 upper = volume.UpperIndex();
  const bool leap = this->Settings.Leaping != SpaceLeaping::Off;
  const bool lipschitz = this->Settings.Leaping == SpaceLeaping::Lipschitz;
  const bool intervals = this->Scene.Blend.UsesIntervals();
  const bool classified = this->Settings.Classify == Classification::Intervals;
  for (int i = 0; i < schedule.Count; ++i)
  {
    const double s = schedule.Position(i);
    const glm::dvec3 q = segment.Curve.At(s);
    const bool inside = IsInside(volume, q);
    // Leaps of the paper end with the segment; LIPSCHITZ uses the box of an earlier segment, too.
    const auto isEmpty = [&] {
      // An interval that ends at the sample is empty only if its beginning is in the box, too.
      return Contains(this->LastEmptyBox, q) &&
        (!classified || Contains(this->LastEmptyBox, segment.Curve.At(s - schedule.Step)));
    };
    const bool known = lipschitz && isEmpty();
    if (known ||
      (leap && this->Scene.Distances->FindEmptyBox(q, upper, this->LastEmptyBox, volume.Margin) &&
        (!classified || isEmpty())))
    {
      if (inside && !known)
      {
        ++this->Statistics.DistanceLookups;
        this->Pixel.NoteSample(
          q, segment.T0 + s * segment.Dt, schedule.Interval(i) * segment.Dt, true, 0.0f);
      }
      if (!intervals)
      {
        i += CountStepsInside(
          segment.Curve, s, schedule.Step, schedule.Count - 1 - i, this->LastEmptyBox);
        continue;
      }
      // An interval is empty only if its end is in the box, too.
      const int empty =
        CountStepsInside(segment.Curve, s, schedule.Step, schedule.Count - i, this->LastEmptyBox);
      if (empty > 0)
      {
        i += empty - 1;
        continue;
      }
    }
    if (!intervals && (!inside || !this->IsShown(q, segment.T0 + s * segment.Dt)))
    {
      continue;
    }
    ++this->Statistics.Samples;
    const RayIntegrator::Outcome outcome =
      this->Pixel.Integrator.AddSample(segment, s, schedule.Interval(i));
    this->Pixel.NoteSample(
      q, segment.T0 + s * segment.Dt, schedule.Interval(i) * segment.Dt, false, outcome.Extinction);
    this->Statistics.VisibleSamples += outcome.Visible ? 1 : 0;
    if (outcome.Done)
    {
      this->Pixel.Done = true;
      return;
    }
  }
}

//------------------------------------------------------------------------------
bool SegmentSampler::IsInLastEmptyBox(const glm::dvec3& q) const
{
  return Contains(this->LastEmptyBox, q);
}

//------------------------------------------------------------------------------
bool SegmentSampler::IsShown(const glm::dvec3& q, double t) const
{
  const Cropping& crop = this->Scene.Crop;
  switch (crop.Space)
  {
    case Cropping::Spaces::Rest:
      return crop.Shows(q);
    case Cropping::Spaces::Deformed:
      return crop.Shows(this->Ray.At(t));
    default:
      return true;
  }
}

} // namespace ffd
