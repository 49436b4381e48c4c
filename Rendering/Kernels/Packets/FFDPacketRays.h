// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketRays_h
#define FFDPacketRays_h

#include "FFDCameraView.h"

#include <glm/vec3.hpp>

namespace ffd
{

/**
 * The viewing rays of an image in the form that packet kernels read, local coordinates.
 *
 * As lines in Pluecker coordinates, direction d and moment m = P x d of any of their points, rays
 * are an affine function of the image position, whatever the projection and the matrix of the
 * volume are: they all meet in one point, which may be at infinity.
 *
 * Packets count t from the point of a ray that is as far from the eye as the middle of the whole,
 * the local origin: that of ViewRay less CameraView::FindMiddleT(). There t is small wherever
 * something may be seen, and about the same for neighboring rays. From plane to plane of the camera
 * it is not: where the matrix of the volume presses it flat, these are oblique to the rays, which
 * begin at very different t.
 */
struct PacketRays
{
  float Column = 0.0f; ///< of image position (0, 0) in the whole image
  float Row = 0.0f;

  /// Coefficients of 1, and of the column and the row in the whole image.
  using Affine = float[3];
  Affine Direction[3] = {}; ///< by component, of about unit length
  Affine Moment[3] = {};
  /// Where they meet, and its distance from the local origin, which is LargestDistance for parallel
  /// rays.
  float Eye[3] = {};
  float EyeDistance = LargestDistance;
  static constexpr float LargestDistance = 1e30f;
  Affine NearW = {}; ///< what homogeneous coordinates are divided by at the near plane,
  Affine FarW = {};  ///< and at the far plane

  float NearPlane[4] = {}; ///< zero on the near plane for local coordinates and 1
  float FarPlane[4] = {};

  PacketRays() = default;

  /// `origin`: of the local coordinates, data coordinates.
  PacketRays(const CameraView& camera, const glm::dvec3& origin);
};

} // namespace ffd

#endif
