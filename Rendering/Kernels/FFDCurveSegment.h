// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCurveSegment_h
#define FFDCurveSegment_h

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{

/**
 * A segment of one deformed ray: a quartic Q(s), 0 <= s <= 1, in index coordinates of the volume.
 * Both segmentations hand their segments to the sampler in this form; those of the paper's polyline
 * are linear.
 */
struct CurveSegment
{
  static constexpr int NumberOfTerms = 5;
  glm::dvec3 Terms[NumberOfTerms] = {}; ///< of s^0 to s^4

  glm::dvec3 At(double s) const
  {
    return this->Terms[0] +
      s * (this->Terms[1] + s * (this->Terms[2] + s * (this->Terms[3] + s * this->Terms[4])));
  }
  glm::dvec3 Velocity(double s) const
  {
    return this->Terms[1] +
      s * (2.0 * this->Terms[2] + s * (3.0 * this->Terms[3] + (4.0 * s) * this->Terms[4]));
  }
  /// Whether it is a line with constant velocity.
  bool IsLine() const
  {
    const double rest =
      glm::length(this->Terms[2]) + glm::length(this->Terms[3]) + glm::length(this->Terms[4]);
    return rest <= 1e-12 * glm::length(this->Terms[1]);
  }

  static CurveSegment Line(const glm::dvec3& a, const glm::dvec3& b) { return { { a, b - a } }; }

  /// The parabola through the positions at s = 0, 1/2 and 1.
  static CurveSegment Parabola(const glm::dvec3& a, const glm::dvec3& middle, const glm::dvec3& b)
  {
    const glm::dvec3 linear = 4.0 * middle - 3.0 * a - b;
    return { { a, linear, b - a - linear } };
  }
};

/// The largest number of samples of a segment, a guard against lengths that make no sense.
constexpr int LargestSampleCount = 1 << 20;

/**
 * The sample positions of a segment: Count intervals that begin at First + i * Step and have length
 * Step, the last one LastInterval (all in the parameter s of the segment). Each interval is sampled
 * Jitter times its length behind its start.
 */
struct SampleSchedule
{
  int Count = 0;
  double First = 0.0;
  double Step = 0.0;
  double LastInterval = 0.0;
  double Jitter = 0.0;

  double Position(int i) const
  {
    return this->First + i * this->Step + this->Jitter * this->Interval(i);
  }
  double Interval(int i) const { return i + 1 < this->Count ? this->Step : this->LastInterval; }
};

/**
 * The rule of section 4.4 of the paper: samples at the start of intervals of `sampleDistance` and
 * one more for the remainder, which the caller corrects the opacity of. `length` is the length of
 * the segment in the unit of `sampleDistance`.
 */
inline SampleSchedule ScheduleWithRemainder(
  double length, double sampleDistance, double jitter = 0.0)
{
  SampleSchedule schedule;
  schedule.Jitter = jitter;
  // In this order of arguments a NaN becomes the limit.
  const double count = std::min<double>(LargestSampleCount, length / sampleDistance);
  if (!(count < LargestSampleCount))
  {
    schedule.Count = LargestSampleCount;
    schedule.Step = 1.0 / LargestSampleCount;
    schedule.LastInterval = schedule.Step;
    return schedule;
  }
  // A remainder of rounding errors does not count.
  const double whole = std::floor(count + 1e-6);
  const double remainder = length - whole * sampleDistance;
  const bool extra = remainder > 1e-6 * sampleDistance;
  schedule.Count = static_cast<int>(whole) + (extra ? 1 : 0);
  schedule.Step = length > 0.0 ? sampleDistance / length : 1.0;
  schedule.LastInterval = extra ? remainder / length : schedule.Step;
  if (schedule.Count == 0)
  {
    // A segment that collapsed to a point in rest space still has a length in deformed space.
    schedule.Count = 1;
    schedule.LastInterval = 1.0;
  }
  return schedule;
}

} // namespace ffd

#endif
