// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDWideTile_h
#define FFDWideTile_h

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

namespace ffd
{

/// PacketCaster::RenderTile() of scenes that do not HasShortScalars(): those of 32 and 64 bits. It
/// has a file of its own because each of the two takes minutes to compile.
int CastWideTile(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline);

} // namespace ffd

#endif
