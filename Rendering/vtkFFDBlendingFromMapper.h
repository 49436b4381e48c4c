// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The blend mode of a volume mapper for the kernels. Private to this module: not installed, not
 * wrapped.
 */
#ifndef vtkFFDBlendingFromMapper_h
#define vtkFFDBlendingFromMapper_h

#include "Optics/FFDBlending.h"

#include <string>

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

/// Whether two frames can leap over the same blocks, the transfer functions being the same.
bool HaveSameLeaps(const Blending& a, const Blending& b);

} // namespace ffd

#endif
