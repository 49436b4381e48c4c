// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSegmentSampler_h
#define FFDSegmentSampler_h

#include "FFDCastRay.h"
#include "FFDCastScene.h"
#include "FFDCurveSegment.h"
#include "FFDDistanceMap.h"
#include "FFDRayIntegrator.h"
#include "FFDTracedRay.h"

#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <limits>

namespace ffd
{

/// The pixel of a ray while it is cast: its integrator, and the record of the trace.
struct RayPixel
{
  RayIntegrator Integrator;
  bool Done = false;          ///< the ray has ended early, as nothing more would show
  TracedRay* Trace = nullptr; ///< to which segments and samples are added, or null

  RayPixel(const IntegrationFrame& frame, const CastRay& ray)
  {
    this->Integrator.Begin(frame, ray.Viewing, ray.From, ray.To);
  }

  /// Records a segment over [from, to]; the samples that are recorded next lie on it.
  void NoteSegment(const CurveSegment& curve, double from, double to, bool passed)
  {
    if (this->Trace)
    {
      const std::size_t at = this->Trace->Samples.size();
      this->Trace->Segments.push_back({ curve, from, to, passed, at, at });
    }
  }
  /// Records a sample, or a leap that starts at its position.
  void NoteSample(const glm::dvec3& q, double t, double interval, bool leap, float extinction)
  {
    if (this->Trace)
    {
      this->Trace->Samples.push_back({ q, t, interval, leap, extinction });
      this->Trace->Segments.back().EndSample = this->Trace->Samples.size();
    }
  }
};

/// A segment whose J_Phi is jacobianAt(s), which is called for shaded samples only.
template <class JacobianAt>
class JacobianSegment : public SampledSegment
{
public:
  /// `volume`: of the index coordinates of the curve. Keeps references to it and `jacobianAt`.
  JacobianSegment(const VolumeView& volume, const CurveSegment& curve, double t0, double dt,
    const JacobianAt& jacobianAt)
    : SampledSegment(curve, t0, dt)
    , Volume(volume)
    , At(jacobianAt)
  {
  }
  glm::dvec3 GradientToDeformed(double s, const glm::dvec3& byIndex) const override
  {
    // Scalars on the ray are f(Phi(P)), so their gradient in deformed space is J_Phi^T grad f.
    const glm::dvec3 rest = glm::transpose(this->Volume.DataToIndex) * byIndex;
    return glm::transpose(this->At(s)) * rest;
  }

private:
  const VolumeView& Volume;
  const JacobianAt& At;
};

/// Whether a position, index coordinates, is in the volume.
bool IsInside(const VolumeView& volume, const glm::dvec3& q);

/// Takes the samples of the segments of one deformed ray, whatever the segmentation, and leaps over
/// empty space.
class SegmentSampler
{
public:
  /// Keeps references to all.
  SegmentSampler(const CastScene& scene, const CastSettings& settings, const CastRay& ray,
    RayPixel& pixel, CastStatistics& statistics)
    : Scene(scene)
    , Settings(settings)
    , Ray(ray)
    , Pixel(pixel)
    , Statistics(statistics)
  {
  }

  /// Takes the samples of a segment at the positions of `schedule`.
  void Integrate(const SampledSegment& segment, const SampleSchedule& schedule);

  /// Whether the empty box that was found last holds a position, index coordinates.
  bool IsInLastEmptyBox(const glm::dvec3& q) const;

  /// Forgets the empty box, so that the next segment is not left out by it.
  void ForgetEmptyBox() { this->LastEmptyBox = NoBox(); }

private:
  static EmptyBox NoBox()
  {
    constexpr double Infinity = std::numeric_limits<double>::infinity();
    return { glm::dvec3(Infinity), glm::dvec3(-Infinity) };
  }

  /// Whether a sample at q, t is not cropped.
  bool IsShown(const glm::dvec3& q, double t) const;

  const CastScene& Scene;
  const CastSettings& Settings;
  const CastRay& Ray;
  RayPixel& Pixel;
  CastStatistics& Statistics;
  EmptyBox LastEmptyBox = NoBox();
};

} // namespace ffd

#endif
