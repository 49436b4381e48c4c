// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDCastRay.h"

#include "FFDClipToBox.h"
#include "FFDSamplePhase.h"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ffd
{
namespace
{

/// Narrows [from, to] to the part of a ray where dot(plane, (P, 1)) >= 0.
void ClipToPlane(const glm::dvec4& plane, const ViewRay& ray, double& from, double& to)
{
  const double slope = glm::dot(glm::dvec3(plane), ray.Direction);
  const double start = glm::dot(plane, glm::dvec4(ray.Origin, 1.0));
  if (slope > 0.0)
  {
    from = std::max(from, -start / slope);
  }
  else if (slope < 0.0)
  {
    to = std::min(to, -start / slope);
  }
  else if (!(start >= 0.0))
  {
    to = from;
  }
}

} // namespace

//------------------------------------------------------------------------------
bool MakeCastRay(const CastScene& scene, const CastSettings& settings, const Box& restBox, int x,
  int y, CastRay& ray)
{
  const CameraView& camera = scene.Camera;
  ray.X = x;
  ray.Y = y;
  ray.Viewing = camera.MakeRay(x + 0.5, y + 0.5);
  ray.From = 0.0;
  ray.To = ray.Viewing.Far;
  if (scene.Depths)
  {
    const std::size_t at = static_cast<std::size_t>(y) * camera.ImageSize.x + x;
    const double depth = scene.Depths[at];
    if (depth < 1.0)
    {
      ray.To = std::min(ray.To, camera.DepthToT(ray.Viewing, x + 0.5, y + 0.5, depth));
    }
  }
  for (const glm::dvec4& plane : scene.ClippingPlanes)
  {
    ClipToPlane(plane, ray.Viewing, ray.From, ray.To);
  }
  if (scene.Blend.UsesIntervals())
  {
    // Intervals lie at whole multiples from the middle, wherever the clipping planes of the camera
    // are.
    const double middle =
      camera.FindMiddleT(ray.Viewing, FindMiddle(scene)) / settings.SampleDistance;
    ray.Phase = middle - std::floor(middle);
  }
  else
  {
    ray.Jitter =
      settings.Jitter ? FindJitter(x + camera.PixelOrigin.x, y + camera.PixelOrigin.y) : 0.0;
    const VolumeView& volume = scene.Volume;
    ray.Phase = FindPhase(volume.ToIndex(ray.Viewing.Origin),
      volume.DataToIndex * ray.Viewing.Direction, restBox, settings.SampleDistance, ray.Jitter);
  }
  // Where a matrix presses the volume flat by more than double precision resolves, steps along the
  // ray, which begins far away then, would lead nowhere.
  return ClipToBox(
           ray.Viewing.Origin, ray.Viewing.Direction, scene.DeformedBounds, ray.From, ray.To) &&
    ray.To + 0.1 * settings.SampleDistance > ray.To;
}

} // namespace ffd
