// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDResampler_h
#define FFDResampler_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDExport.h"
#include "FFDOrientedInverse.h"
#include "FFDParallelFor.h"
#include "FFDPullBack.h"
#include "FFDSplineRows.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ffd
{

/// Interpolation of values between voxels.
enum class ResampleInterpolation
{
  Nearest,
  Linear,
  Cubic ///< Catmull-Rom, as vtkImageReslice; voxels at the border are repeated outwards
};

struct ResampleSettings
{
  ResampleInterpolation Interpolation = ResampleInterpolation::Linear;
  double Background = 0.0; ///< of points that do not come from the volume
  /// Positions outside of the volume by up to this (data units, at most half a voxel) count as on
  /// its faces: the error of positions, without which faces that stay in place would have holes.
  double Border = 0.0;
  /// True when the inverse of the map is proven to be unique: then it is followed from voxel to
  /// voxel, else every point is solved for on its own, as the ray caster does.
  bool UniqueInverse = false;
  /// The whole volume at rest, index coordinates of the volume that is given, which may be a part
  /// of it; empty: that is the whole.
  Box Rest{ glm::dvec3(1.0), glm::dvec3(0.0) };
};

/**
 * A box that contains Phi(P) for every P in `deformed`: what has to be known of the volume at rest
 * to resample that part of deformed space. Conservative, unconverged points included.
 */
FFD_FILTERS_EXPORT Box FindRestRegion(
  const PullBack& map, const PullBackBounds& bounds, const Box& deformed);

/**
 * The deformed volume on an image grid: the value at P is f(Phi(P)), as the ray caster sees it.
 *
 * Kinds of pull-back that need no inverse take the displacement row by row (SplineRows). Those that
 * invert T solve at every fourth point of each axis and interpolate the result with cubics; at
 * every point the residual of T is then computed, and where it exceeds the tolerance of the
 * pull-back (seldom) the point is solved for. So every point is as exact as one that is solved for.
 * Where T may fold every point is solved for, see OrientedInverse.
 *
 * A point counts as inside up to ResampleSettings::Border and a millionth of a voxel beyond the
 * outermost voxels. Whole numbers
 * are rounded and clamped to the range of their type; voxels that are not finite reach just the
 * points that they have weight in. The result does not depend on how the grid is split into
 * extents, nor on the number of threads.
 */
class FFD_FILTERS_EXPORT Resampler
{
public:
  /// `volume` and `map` are kept by pointer. Components: Increments[0] of the volume.
  Resampler(const VolumeView& volume, const PullBack& map, const ImageGrid& grid,
    const ResampleSettings& settings);

  /**
   * Resample the points first ... last (indices of the grid) to `out`, which holds them x fastest,
   * all components of a point together, in the scalar type of the volume. Returns the number of
   * points where the inverse did not converge.
   */
  std::int64_t Resample(const glm::ivec3& first, const glm::ivec3& last, void* out,
    const ParallelFor& parallelFor) const;

private:
  class Extent;

  bool Inverts() const;

  const VolumeView* Volume;
  const PullBack* Map;
  ImageGrid Grid;
  ResampleSettings Settings;
  std::unique_ptr<OrientedInverse> Inverse; ///< null: the inverse is unique, or is not needed
  /// Index of the grid to index of the volume, exact where the two share their points.
  glm::dmat3 ToVolume;
  glm::dvec3 ToVolumeOffset;
};

} // namespace ffd

#endif
