// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Makes FFD_TILE_CASTER, one of FFDTileCasters.h, of scalars that are read as FFD_TILE_SCALAR. Both
// are defined by the file that includes this one. Included once per target of Highway.
#include "FFDTileCasters.h"

#include "FFDSimdTargets.h"

// The packet kernels are compiled once for every instruction set of FFDSimdTargets.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "Packets/FFDTileCaster-inl.h"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "FFDSimdTile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

int FFD_TILE_CASTER(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  return CastTile<FFD_TILE_SCALAR>(scene, x0, y0, subtiles, image, scratch, first, deadline);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ffd
{
namespace
{

HWY_EXPORT(FFD_TILE_CASTER);

} // namespace

//------------------------------------------------------------------------------
int FFD_TILE_CASTER(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  return HWY_DYNAMIC_DISPATCH(FFD_TILE_CASTER)(
    scene, x0, y0, subtiles, image, scratch, first, deadline);
}

} // namespace ffd

#endif
