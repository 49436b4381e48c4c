// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Blend mode, cropping and clipping planes of a volume mapper for the kernels. Private to this
 * module: not installed, not wrapped.
 */
#ifndef vtkFFDBlendingView_h
#define vtkFFDBlendingView_h

#include "FFDBlending.h"
#include "FFDCropping.h"
#include "FFDMinMaxBlocks.h"
#include "FFDVolumeView.h"

#include <glm/vec4.hpp>

#include <string>
#include <vector>

class vtkDataSet;
class vtkVolumeMapper;
class vtkVolumeProperty;

namespace ffd
{

struct ScalarFacts;

/**
 * The blend mode of a mapper with what it takes of the mapper, of the property and of the scalars.
 * False, and why, if something is missing or makes no sense. The plane of a slice is still that of
 * the world.
 */
bool MakeBlending(vtkVolumeMapper* mapper, vtkVolumeProperty* property, const ScalarFacts& facts,
  Blending& blend, std::string& message);

/**
 * The cropping regions of a mapper; `deformed`: of deformed space, not of the volume at rest. False,
 * and why, if its planes make no sense.
 */
bool MakeCropping(vtkVolumeMapper* mapper, vtkDataSet* input, const VolumeView& volume,
  bool deformed, Cropping& crop, std::string& message);

/// The clipping planes of a mapper as CastScene::ClippingPlanes.
bool MakeClippingPlanes(
  vtkVolumeMapper* mapper, std::vector<glm::dvec4>& planes, std::string& message);

/// Whether two frames can leap over the same blocks, the transfer functions being the same.
bool HaveSameLeaps(const Blending& a, const Blending& b);

} // namespace ffd

#endif
