// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The camera and the lights of a renderer for the kernels. Private to this module: not installed,
 * not wrapped.
 */
#ifndef vtkFFDViewFromRenderer_h
#define vtkFFDViewFromRenderer_h

#include "vtkFFDImageRegion.h"

#include "FFDCameraView.h"
#include "Optics/FFDShading.h"

#include <glm/mat4x4.hpp>

class vtkMatrix4x4;
class vtkRenderer;
class vtkVolumeProperty;

namespace ffd
{

/// GLM copy of a VTK matrix (GLM is column major, VTK row major).
glm::dmat4 ToMatrix(vtkMatrix4x4* matrix);

/// Camera of a renderer for the rays of a part of its viewport, in the data coordinates that
/// `dataToWorld`, the matrix of the volume, takes to the world.
CameraView MakeCameraView(
  vtkRenderer* renderer, const vtkFFDImageRegion& region, const glm::dmat4& dataToWorld);

/// Material of a property's first component under the lights of a renderer, these in the world; a
/// headlight if it has none at all.
Shading MakeShading(
  vtkRenderer* renderer, vtkVolumeProperty* property, const glm::dmat4& dataToWorld);

} // namespace ffd

#endif
