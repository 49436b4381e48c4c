// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDReferenceCaster_h
#define FFDReferenceCaster_h

#include "FFDCastRay.h"
#include "FFDCastScene.h"
#include "FFDOrientedInverse.h"
#include "FFDSegmentSampler.h"

#include <glm/vec3.hpp>

#include <memory>

namespace ffd
{

/**
 * The reference kernels: casts one ray after the other in double precision. Follows the deformed
 * ray of a viewing ray segment by segment, by one of the segmentations, and hands each segment to
 * the SegmentSampler.
 */
class ReferenceCaster
{
public:
  /// Keeps references to the scene and the settings. `restBox`: FindRestBox().
  ReferenceCaster(const CastScene& scene, const CastSettings& settings, const Box& restBox);

  /// Casts a ray.
  void Cast(const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const;

private:
  /// Phi(p), data coordinates. `start`, if not null: an estimate of it.
  glm::dvec3 PullBackPoint(
    const glm::dvec3& p, const glm::dvec3* start, CastStatistics& statistics) const;

  /// Takes the only sample of BlendMode::Slice, where the ray crosses the plane.
  void CastSlice(const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const;

  /// GREEDY_ANGLE: follows the paper's polyline.
  void CastPolyline(const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const;

  /**
   * ERROR_BOUND, as the truth that interpolants are measured by: pulls every sample back by itself.
   * Where T is inverted, Newton's method starts from the sample before, and anew where that fails.
   */
  void CastPerSample(const CastRay& ray, RayPixel& pixel, CastStatistics& statistics) const;

  const CastScene& Scene;
  const CastSettings& Settings;
  std::unique_ptr<OrientedInverse> Inverse; // null: T is one to one, or is not inverted
};

} // namespace ffd

#endif
