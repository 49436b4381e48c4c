// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCameraView_h
#define FFDCameraView_h

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>

namespace ffd
{

/// A viewing ray in deformed space, data coordinates: P(t) = Origin + t * Direction, 0 <= t <= Far,
/// t in data units.
struct ViewRay
{
  glm::dvec3 Origin;    ///< on the near clipping plane
  glm::dvec3 Direction; ///< unit length
  double Far;           ///< t at the far clipping plane

  glm::dvec3 At(double t) const { return this->Origin + t * this->Direction; }

  /// t of the point of the ray that is nearest to another one.
  double FindNearestT(const glm::dvec3& to) const
  {
    return glm::dot(to - this->Origin, this->Direction);
  }
};

/**
 * Rays through the pixels of an image, perspective or parallel, in data coordinates.
 *
 * t is measured from the near clipping plane.
 */
struct CameraView
{
  glm::dmat4 NdcToData{ 1.0 };
  glm::dmat4 DataToNdc{ 1.0 };
  glm::ivec2 ImageSize{ 0 };
  /// Normalized device coordinates of the lower left corner of the whole image, of which this may
  /// be a part, and of one pixel.
  glm::dvec2 NdcOrigin{ -1.0 };
  glm::dvec2 NdcPerPixel{ 0.0 };
  /// Column and row of pixel (0, 0) in the whole image. Rays and the pattern of FindJitter() follow
  /// from columns and rows there, so that those of a pixel are the same, to the last bit, whatever
  /// part of the image is cast.
  glm::ivec2 PixelOrigin{ 0 };
  /// Position of the camera, data coordinates. Lighting uses it with parallel projection, too, as
  /// vtkGPUVolumeRayCastMapper does.
  glm::dvec3 Eye{ 0.0 };
  bool Parallel = false;

  /// Normalized device coordinates of image position (x, y).
  glm::dvec2 ToNdc(double x, double y) const
  {
    return this->NdcOrigin + (glm::dvec2(this->PixelOrigin) + glm::dvec2(x, y)) * this->NdcPerPixel;
  }

  /// Rows of a projective map from data coordinates to image positions: position p, with 1 as its
  /// fourth coordinate, is seen at (X . p, Y . p) / W . p, where W . p is above zero.
  struct PixelRows
  {
    glm::dvec4 X;
    glm::dvec4 Y;
    glm::dvec4 W;
  };
  PixelRows GetPixelRows() const
  {
    // The first two rows, each less the corner of the image, in units of a pixel.
    const glm::dmat4 rows = glm::transpose(this->DataToNdc);
    const glm::dvec2 corner = this->ToNdc(0.0, 0.0);
    return { (rows[0] - corner.x * rows[3]) / this->NdcPerPixel.x,
      (rows[1] - corner.y * rows[3]) / this->NdcPerPixel.y, rows[3] };
  }

  /// The ray through image position (x, y); pixel (i, j) has its center at (i + 0.5, j + 0.5).
  ViewRay MakeRay(double x, double y) const
  {
    const glm::dvec2 ndc = this->ToNdc(x, y);
    const glm::dvec3 near = this->ToData(glm::dvec3(ndc, -1.0));
    const glm::dvec3 far = this->ToData(glm::dvec3(ndc, 1.0));
    ViewRay ray;
    ray.Origin = near;
    ray.Far = glm::length(far - near);
    ray.Direction = (far - near) / ray.Far;
    return ray;
  }

  /// Where all viewing rays meet, homogeneous coordinates.
  const glm::dvec4& GetMeetingPoint() const { return this->NdcToData[2]; }

  /// Whether that is at infinity, but for the rounding errors of matrices.
  bool HasParallelRays() const
  {
    const glm::dvec4& meeting = this->GetMeetingPoint();
    const auto direction = [&meeting](const glm::dvec4& point) {
      return glm::length(meeting.w * glm::dvec3(point) - point.w * glm::dvec3(meeting));
    };
    return std::max(direction(this->NdcToData[0]), direction(this->NdcToData[1])) <=
      1e-13 * direction(this->NdcToData[3]);
  }

  /**
   * t of the point of a ray that is as far from where all rays meet as `middle` is. Neighboring
   * rays have there neighboring points, on a sphere, or on a plane if they are parallel, that all
   * rays cross at right angles, in data coordinates; and it is no farther from any point of the ray
   * than that is from `middle`.
   */
  double FindMiddleT(const ViewRay& ray, const glm::dvec3& middle) const
  {
    const double nearest = ray.FindNearestT(middle);
    if (this->HasParallelRays())
    {
      return nearest;
    }
    const glm::dvec4& meeting = this->GetMeetingPoint();
    const glm::dvec3 eye = glm::dvec3(meeting) / meeting.w - middle;
    const glm::dvec3 moment = glm::cross(ray.Origin - middle, ray.Direction);
    const double distance = glm::length(eye);
    const double along = glm::dot(eye, ray.Direction);
    // Their sum, which is a small difference where the eye is far away.
    return nearest +
      (along > 0.0 ? distance + along
                   : glm::dot(moment, moment) / std::max(distance - along, 1e-300));
  }

  /// Unit vector from a point of a ray to the camera.
  glm::dvec3 ToEye(const ViewRay& ray, const glm::dvec3& position) const
  {
    const glm::dvec3 path = this->Eye - position;
    const double distance = glm::length(path);
    return this->Parallel && distance > 0.0 ? path / distance : -ray.Direction;
  }

  /// Position of normalized device coordinates (z: -1 near, 1 far).
  glm::dvec3 ToData(const glm::dvec3& ndc) const
  {
    const glm::dvec4 p = this->NdcToData * glm::dvec4(ndc, 1.0);
    return glm::dvec3(p) / p.w;
  }

  /// Window depth (0 near, 1 far) of a position.
  double ToDepth(const glm::dvec3& position) const
  {
    const glm::dvec4 p = this->DataToNdc * glm::dvec4(position, 1.0);
    return 0.5 * (p.z / p.w + 1.0);
  }

  /// t of the point of a ray through image position (x, y) at a window depth.
  double DepthToT(const ViewRay& ray, double x, double y, double depth) const
  {
    const glm::dvec2 ndc = this->ToNdc(x, y);
    return ray.FindNearestT(this->ToData(glm::dvec3(ndc, 2.0 * depth - 1.0)));
  }
};

} // namespace ffd

#endif
