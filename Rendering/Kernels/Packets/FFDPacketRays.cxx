// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketRays.h"

#include "FFDSingleArrays.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <algorithm>

namespace ffd
{
namespace
{

/// An affine function of normalized device coordinates.
template <class Vector>
struct OfNdc
{
  Vector Base;
  Vector PerX;
  Vector PerY;
};

/// Homogeneous local coordinates at a depth.
OfNdc<glm::dvec4> PointsAt(const glm::dmat4& ndcToLocal, double depth)
{
  return { ndcToLocal * glm::dvec4(0.0, 0.0, depth, 1.0), ndcToLocal[0], ndcToLocal[1] };
}

/// By columns and rows of the whole image.
void ToPixels(
  const CameraView& camera, double base, double perX, double perY, PacketRays::Affine& to)
{
  to[0] = static_cast<float>(base + perX * camera.NdcOrigin.x + perY * camera.NdcOrigin.y);
  to[1] = static_cast<float>(perX * camera.NdcPerPixel.x);
  to[2] = static_cast<float>(perY * camera.NdcPerPixel.y);
}

void ToPixels(const CameraView& camera, const OfNdc<glm::dvec4>& points, PacketRays::Affine& to)
{
  ToPixels(camera, points.Base.w, points.PerX.w, points.PerY.w, to);
}

void ToPixels(
  const CameraView& camera, const OfNdc<glm::dvec3>& vectors, PacketRays::Affine (&to)[3])
{
  for (int a = 0; a < 3; ++a)
  {
    ToPixels(camera, vectors.Base[a], vectors.PerX[a], vectors.PerY[a], to[a]);
  }
}

void CopyPlane(const glm::dvec4& plane, float to[4])
{
  const double scale = 1.0 / glm::length(glm::dvec3(plane));
  for (int i = 0; i < 4; ++i)
  {
    to[i] = static_cast<float>(scale * plane[i]);
  }
}

} // namespace

//------------------------------------------------------------------------------
PacketRays::PacketRays(const CameraView& camera, const glm::dvec3& origin)
  : Column(static_cast<float>(camera.PixelOrigin.x))
  , Row(static_cast<float>(camera.PixelOrigin.y))
{
  const glm::dmat4 ndcToLocal = glm::translate(glm::dmat4(1.0), -origin) * camera.NdcToData;
  const OfNdc<glm::dvec4> near = PointsAt(ndcToLocal, -1.0);
  const OfNdc<glm::dvec4> middle = PointsAt(ndcToLocal, 0.0);
  const OfNdc<glm::dvec4> far = PointsAt(ndcToLocal, 1.0);
  const glm::dvec4& meeting = ndcToLocal[2];
  const bool parallel = camera.HasParallelRays();
  const auto direction = [&meeting](const glm::dvec4& point) {
    return meeting.w * glm::dvec3(point) - point.w * glm::dvec3(meeting);
  };
  const auto moment = [&meeting](const glm::dvec4& point) {
    return glm::cross(glm::dvec3(meeting), glm::dvec3(point));
  };
  // From the near to the far plane, and of unit length in the middle.
  const glm::dvec3 along = direction(middle.Base);
  const glm::dvec3 path = glm::dvec3(far.Base) / far.Base.w - glm::dvec3(near.Base) / near.Base.w;
  const double scale = (glm::dot(along, path) < 0.0 ? -1.0 : 1.0) / glm::length(along);
  const auto take = [&](const auto& of, Affine(&to)[3]) {
    ToPixels(camera,
      OfNdc<glm::dvec3>{
        scale * of(middle.Base), scale * of(middle.PerX), scale * of(middle.PerY) },
      to);
  };
  take(moment, this->Moment);
  if (parallel)
  {
    const glm::dvec3 none(0.0);
    ToPixels(camera, OfNdc<glm::dvec3>{ scale * along, none, none }, this->Direction);
  }
  else
  {
    take(direction, this->Direction);
    const glm::dvec3 eye = glm::dvec3(meeting) / meeting.w;
    Copy(eye, this->Eye);
    this->EyeDistance =
      static_cast<float>(std::min(glm::length(eye), static_cast<double>(LargestDistance)));
  }
  ToPixels(camera, near, this->NearW);
  ToPixels(camera, far, this->FarW);

  const glm::dmat4 localToNdc = camera.DataToNdc * glm::translate(glm::dmat4(1.0), origin);
  const glm::dvec4 depth = glm::row(localToNdc, 2);
  const glm::dvec4 w = glm::row(localToNdc, 3);
  CopyPlane(w + depth, this->NearPlane);
  CopyPlane(w - depth, this->FarPlane);
}

} // namespace ffd
