// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDWideTile.h"

#include "FFDSimdTargets.h"

// The packet kernels are compiled once for every instruction set of FFDSimdTargets.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "Packets/FFDWideTile.cxx"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "FFDSimdFetch-inl.h"
#include "FFDSimdTile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

int CastWideTileOfTarget(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  return ForWideFetched(scene.Volume, [&](auto zero) {
    return CastTile<decltype(zero)>(scene, x0, y0, subtiles, image, scratch, first, deadline);
  });
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ffd
{
namespace
{

HWY_EXPORT(CastWideTileOfTarget);

} // namespace

//------------------------------------------------------------------------------
int CastWideTile(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  return HWY_DYNAMIC_DISPATCH(CastWideTileOfTarget)(
    scene, x0, y0, subtiles, image, scratch, first, deadline);
}

} // namespace ffd

#endif
