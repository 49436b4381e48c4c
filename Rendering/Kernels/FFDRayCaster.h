// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRayCaster_h
#define FFDRayCaster_h

#include "FFDCastRay.h"
#include "FFDCastScene.h"
#include "FFDExport.h"
#include "FFDParallelFor.h"
#include "FFDTracedRay.h"
#include "Optics/FFDSampleClassifier.h"
#include "Packets/FFDPacketCaster.h"
#include "Reference/FFDRayIntegrator.h"
#include "Reference/FFDReferenceCaster.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <memory>
#include <vector>

namespace ffd
{

/**
 * Renders a frame tile by tile: front-to-back compositing of equidistant samples along inversely
 * deformed rays (section 4.4 of the paper). RenderTile() is const, so that any number of threads
 * can render tiles, each with its own scratch; the image does not depend on which thread renders
 * which.
 *
 * PacketCaster casts the rays, or ReferenceCaster if CastSettings::Reference is set or
 * PacketCaster::Supports() is false. Both give the same picture within the tolerances, since they
 * share SampleClassifier, which finds color and opacity of a sample, and RayIntegrator, which
 * combines the samples of a ray.
 */
class FFD_RENDERING_EXPORT RayCaster
{
public:
  static constexpr int TileSize = TileSide;
  /// Rays along each side of a group of tiles, which share work where one thread renders them in
  /// turn.
  static constexpr int GroupSize = SharedRootSide;
  static constexpr int SubtileSize = TileSize / 2;
  static constexpr unsigned int AllSubtiles = 15;

  /// The pixels of a tile that lie in an image of this size: [First, End).
  struct TileRange
  {
    glm::ivec2 First;
    glm::ivec2 End;

    TileRange(int tile, const glm::ivec2& size)
      : First(glm::ivec2(tile % GetTilesPerRow(size.x), tile / GetTilesPerRow(size.x)) * TileSize)
      , End(glm::min(this->First + TileSize, size))
    {
    }
  };

  /// `parallelFor` makes what is needed for all rays beforehand.
  RayCaster(const CastScene& scene, const CastSettings& settings,
    const ParallelFor& parallelFor = ParallelFor());
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Buffers that a thread keeps between tiles; aligned so that no two share a line of the cache.
  struct alignas(128) Scratch
  {
    PacketScratch Packets;
    CastStatistics Statistics;
  };

  /// Whether the frame is cast with Classification::Intervals: asked for, and possible.
  bool ClassifiesIntervals() const { return this->Settings.Classify == Classification::Intervals; }

  /// The statistics of a thread.
  static CastStatistics GetStatistics(const Scratch& scratch);

  static int GetTilesPerRow(int width) { return (width + TileSize - 1) / TileSize; }
  int GetNumberOfTiles(const CastImage& image) const;
  /// The number of the group that a tile is in, see GroupSize; a group of its own if the tiles of
  /// this scene share nothing.
  int GetGroup(int tile, const CastImage& image) const;
  /// Whether it is known that nothing can be seen through a tile: RenderTile() would cast no ray.
  bool IsTileEmpty(int tile, const CastImage& image) const;
  /// `subtiles`: of which subtiles of the tile the pixels are asked for, a bit each, x fastest.
  /// Stops at the deadline, with some pixels done: returns 0 when the tile is finished, else the
  /// number to go on with, as `first`. The pixels do not depend on the stops.
  int RenderTile(int tile, const CastImage& image, Scratch& scratch,
    unsigned int subtiles = AllSubtiles, int first = 0, Deadline deadline = NoDeadline) const;

  /// Casts the ray of one pixel as for the picture and records its segments and samples; with
  /// packets the segments are those of its tile. Of `image` only the size matters.
  void TraceRay(int x, int y, const CastImage& image, Scratch& scratch, TracedRay& traced) const;

private:
  int SetUpTile(int x0, int y0, int x1, int y1, CastRay* rays) const;

  CastScene Scene;
  CastSettings Settings;
  std::unique_ptr<SampleClassifier> OwnClassifier; // where the scene has none
  IntegrationFrame Frame;
  std::unique_ptr<PacketCaster> Packets; // one of both renders
  std::unique_ptr<ReferenceCaster> Reference;
  Box RestBox;  // the whole volume at rest, index coordinates
  bool Visible; // false: all samples would be leaped over, so no ray is cast
};

} // namespace ffd

#endif
