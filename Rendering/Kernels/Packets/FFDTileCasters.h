// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTileCasters_h
#define FFDTileCasters_h

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

namespace ffd
{

/// PacketCaster::RenderTile() of scenes whose scalars are of one kind. Each has a file of its own,
/// as it takes a minute and more to compile.
using TileCaster = int(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline);

TileCaster CastByteTile;
TileCaster CastShortTile;
TileCaster CastWordTile;
TileCaster CastFloatTile;
TileCaster CastDoubleTile;

} // namespace ffd

#endif
