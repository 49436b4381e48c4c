// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSampling_h
#define FFDSampling_h

#include "FFDExport.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

namespace ffd
{

/// Interpolation of values between voxels.
enum class Interpolation
{
  Nearest,
  Linear
};

/**
 * Sample fetches for one scalar type, chosen once per image: the only code of the ray caster that
 * depends on the type. Positions are index coordinates inside [LowerIndex(), UpperIndex()]; beyond
 * the outermost voxels these hold. VolumeView::Axes is not looked at.
 */
struct SampleFunctions
{
  /// Trilinear (or nearest) value.
  double (*Value)(const VolumeView& volume, const glm::dvec3& q);

  /// The same of all components, written to `values`.
  void (*Values)(const VolumeView& volume, const glm::dvec3& q, double* values);

  /// FindDifferences() of the values, per index unit, of a volume that nothing is hidden of.
  glm::dvec3 (*Gradient)(const VolumeView& volume, const glm::dvec3& q);
};

/// View of one component of a volume of several.
FFD_RENDERING_EXPORT VolumeView GetComponent(const VolumeView& volume, int component);

FFD_RENDERING_EXPORT SampleFunctions SelectSampleFunctions(
  ScalarType type, Interpolation interpolation);

} // namespace ffd

#endif
