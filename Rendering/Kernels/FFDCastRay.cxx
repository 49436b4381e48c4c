// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDCastRay.h"

#include "FFDClipToBox.h"
#include "FFDSamplePhase.h"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
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
  if (!scene.Blend.UsesIntervals())
  {
    ray.Jitter =
      settings.Jitter ? FindJitter(x + camera.PixelOrigin.x, y + camera.PixelOrigin.y) : 0.0;
    const VolumeView& volume = scene.Volume;
    ray.Phase = FindPhase(volume.ToIndex(ray.Viewing.Origin),
      volume.DataToIndex * ray.Viewing.Direction, restBox, settings.SampleDistance, ray.Jitter);
  }
  return ClipToBox(
    ray.Viewing.Origin, ray.Viewing.Direction, scene.DeformedBounds, ray.From, ray.To);
}

} // namespace ffd
