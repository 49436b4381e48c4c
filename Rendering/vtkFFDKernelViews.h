// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Plain views of VTK objects for the kernels. Private to this module: not installed, not wrapped.
 */
#ifndef vtkFFDKernelViews_h
#define vtkFFDKernelViews_h

#include "FFDCameraView.h"
#include "FFDMinMaxBlocks.h"
#include "FFDShading.h"
#include "FFDTransferTable.h"

#include <glm/mat4x4.hpp>

#include <string>

class vtkMatrix4x4;
class vtkRenderer;
class vtkVolumeProperty;

namespace ffd
{

/// GLM copy of a VTK matrix (GLM is column major, VTK row major).
glm::dmat4 ToMatrix(vtkMatrix4x4* matrix);

/**
 * Transfer table of a property's first component over the scalar range of the volume. `integers`:
 * entries are to meet whole numbers. `roundUp`: interpolated scalars are classified half a unit
 * higher, which is on average what vtkFixedPointVolumeRayCastMapper's rounding up to whole numbers
 * comes to.
 */
bool MakeTransferTable(vtkVolumeProperty* property, const MinMaxBlocks::Limits& range,
  bool roundUp, bool integers, TransferTable& table, std::string& message);

/**
 * Camera of a renderer for an image of `viewport` pixels (the whole viewport) of which the pixels
 * [origin, origin + size * step) are rendered, `step` viewport pixels apart.
 */
CameraView MakeCameraView(vtkRenderer* renderer, const glm::ivec2& viewport,
  const glm::ivec2& origin, const glm::ivec2& size, double step);

/// Material of a property's first component under the lights of a renderer; a headlight if it has
/// none that is switched on.
Shading MakeShading(vtkRenderer* renderer, vtkVolumeProperty* property);

} // namespace ffd

#endif
