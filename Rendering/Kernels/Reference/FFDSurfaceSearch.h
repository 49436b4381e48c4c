// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSurfaceSearch_h
#define FFDSurfaceSearch_h

#include "FFDExport.h"
#include "FFDOrientedInverse.h"
#include "FFDPullBack.h"
#include "FFDVolumeView.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <functional>
#include <memory>

namespace ffd
{

/// A point of a ray in deformed space, and its rest point.
struct SurfacePoint
{
  double T = 0.0;             ///< ray parameter
  glm::dvec3 Deformed{ 0.0 }; ///< data coordinates
  glm::dvec3 Rest{ 0.0 };     ///< data coordinates
  glm::dvec3 Index{ 0.0 };    ///< the same in index coordinates
};

/**
 * Follows one viewing ray through deformed space and finds the first point where a condition on the
 * material holds, for picking: exact instead of fast.
 *
 * Evaluates the pull-back point by point, to `Accuracy` voxels, without interpolation. In a step
 * the rest position moves by at most half a voxel along each axis, so that nothing that is a voxel
 * thick is missed. A change of the condition is bisected down to the resolution of doubles.
 */
class FFD_RENDERING_EXPORT SurfaceSearch
{
public:
  /// Largest distance of a rest position from the true one, voxels, for maps that are inverted.
  static constexpr double Accuracy = 1e-9;
  /// Largest motion of the rest position in a step, voxels along each axis.
  static constexpr double LongestStep = 0.5;
  /// Shortest step, voxels, for folds, where the rest position jumps.
  static constexpr double ShortestStep = 1.0 / 64.0;

  /// P(t) = origin + t * direction, data coordinates; the map's field outlives this object.
  /// `oneToOne`: it is proven that every deformed point comes from one rest point alone.
  SurfaceSearch(const VolumeView& volume, const PullBack& map, const glm::dvec3& origin,
    const glm::dvec3& direction, bool oneToOne = false);

  using Condition = std::function<bool(const SurfacePoint& point)>;
  using Label = std::function<int(const SurfacePoint& point)>;

  /**
   * Finds the first t of [from, to] where `condition` holds; false if it holds nowhere. `hit` is
   * the first point where it holds, `before` the last one where it does not, or `hit` itself if it
   * holds at `from`.
   *
   * `label` numbers the regions that a point can be in (sides of the faces of the volume, of
   * cropping planes). Where it changes, the condition is tested on both sides of the change, so
   * that regions that the ray crosses in less than a step are not missed.
   */
  bool FindFirst(double from, double to, const Condition& condition, const Label& label,
    SurfacePoint& hit, SurfacePoint& before) const;

  /// The point at t, pulled back.
  SurfacePoint Evaluate(double t) const;

  /// dPhi/dP at a point: jacobian[column][row].
  glm::dmat3 EvaluateJacobian(const SurfacePoint& point) const;

  /// Whether an index position lies in the volume, faces included.
  bool IsInside(const glm::dvec3& index) const;

private:
  glm::dvec3 FindRest(const glm::dvec3& deformed) const;
  void Bisect(const Condition& beyond, SurfacePoint& before, SurfacePoint& after) const;

  VolumeView Volume;
  PullBack Map;
  glm::dvec3 Origin;
  glm::dvec3 Direction;
  double TPerVoxel; // along the ray
  bool OneToOne;
  /// Made where the inverse that is followed from the point itself leads out of the volume, unless
  /// there is no other one.
  mutable std::unique_ptr<OrientedInverse> Inverse;
};

} // namespace ffd

#endif
