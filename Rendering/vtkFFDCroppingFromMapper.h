// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The cropping regions and the clipping planes of a volume mapper for the kernels. Private to this
 * module: not installed, not wrapped.
 */
#ifndef vtkFFDCroppingFromMapper_h
#define vtkFFDCroppingFromMapper_h

#include "FFDCropping.h"
#include "FFDVolumeView.h"

#include <glm/vec4.hpp>

#include <string>
#include <vector>

class vtkDataSet;
class vtkVolumeMapper;

namespace ffd
{

/**
 * The cropping regions of a mapper; `deformed`: of deformed space, not of the volume at rest.
 * False, and why, if its planes make no sense.
 */
bool MakeCropping(vtkVolumeMapper* mapper, vtkDataSet* input, const VolumeView& volume,
  bool deformed, Cropping& crop, std::string& message);

/// The clipping planes of a mapper as CastScene::ClippingPlanes.
bool MakeClippingPlanes(
  vtkVolumeMapper* mapper, std::vector<glm::dvec4>& planes, std::string& message);

} // namespace ffd

#endif
