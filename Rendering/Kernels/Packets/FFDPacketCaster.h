// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketCaster_h
#define FFDPacketCaster_h

#include "FFDExport.h"
#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"
#include "FFDParallelFor.h"

namespace ffd
{

/**
 * The fast ray caster: packets of neighboring rays in lockstep, a ray a lane of the widest vector
 * instructions that the machine has (Highway, chosen at run time). The pull-back is evaluated on a
 * coarse grid of 4 x 4 nodes a tile and interpolated, with an error that is measured (TileSegment);
 * where it is too large it is evaluated for each sample. Takes the samples of the reference ray
 * caster.
 */
class FFD_RENDERING_EXPORT PacketCaster
{
public:
  /// `scene` and `frame` must outlive the caster.
  PacketCaster(const CastScene& scene, const CastSettings& settings, const IntegrationFrame& frame,
    const ParallelFor& parallelFor);

  /// Whether packets can render this scene, which has a classifier; else the reference ray caster
  /// has to: the paper's polyline, and slices that are beyond the reach of 32-bit offsets.
  static bool Supports(const CastScene& scene, const CastSettings& settings);

  /// See RayCaster::RenderTile(); `first` counts packets.
  int RenderTile(int x0, int y0, unsigned int subtiles, const CastImage& image,
    PacketScratch& scratch, int first, Deadline deadline) const;

  /// Whether RenderTile() casts no ray of the tile at (x0, y0): nothing can be seen through it.
  bool IsTileEmpty(int x0, int y0) const;

  /// PacketScene::RootSide.
  int GetRootSide() const { return this->Scene.RootSide; }

private:
  PacketScene Scene;
};

} // namespace ffd

#endif
