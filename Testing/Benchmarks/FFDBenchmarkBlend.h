// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Blend modes other than compositing, and composites of more than one function of one component,
// against VTK's mappers.
#ifndef FFDBenchmarkBlend_h
#define FFDBenchmarkBlend_h

#include "FFDBenchmarkGroup.h"

#include <memory>
#include <string>

namespace ffdBenchmark
{

/// Which blend mode, or what is composited.
enum class BlendRows
{
  Mip,
  Isosurface,
  TwoComponents,  ///< the volume and its mirror image, independent
  GradientOpacity ///< of the volume
};

/**
 * Rows "fixedpoint" (vtkFixedPointVolumeRayCastMapper, which has no isosurfaces) and "gpu"
 * (vtkOpenGLGPUVolumeRayCastMapper by whatever OpenGL there is; in tests by Mesa on the CPU), and
 * ours: "identity", "exact" (deformed by smooth45) and "reference" (the reference kernels). A row
 * of ours is refused when its picture is not that of VTK's or of the reference kernels.
 */
std::shared_ptr<void> PrepareBlend(
  Group& group, BlendRows rows, int size, const std::string& folder);

} // namespace ffdBenchmark

#endif
