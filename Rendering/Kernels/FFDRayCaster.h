// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRayCaster_h
#define FFDRayCaster_h

#include "FFDCastScene.h"
#include "FFDExport.h"
#include "FFDOrientedInverse.h"
#include "FFDPacketCaster.h"
#include "FFDRayIntegrator.h"
#include "FFDSampleClassifier.h"
#include "FFDSamplePhase.h"
#include "FFDTracedRay.h"

#include <memory>
#include <vector>

namespace ffd
{

/**
 * Front-to-back compositing of equidistant samples along inversely deformed rays (section 4.4 of
 * the paper). One instance renders one frame; RenderTile is const, so tiles can be rendered by any
 * number of threads, each with its own scratch, and the image does not depend on who renders
 * which.
 *
 * SampleClassifier finds color and opacity of a sample, RayIntegrator combines the samples of a
 * ray; all kernels share both.
 *
 * The kernels here are the reference: one ray after the other, double precision. PacketCaster
 * renders the same picture, within the tolerances, faster, and does so unless
 * CastSettings::Reference is set or PacketCaster::Supports() is false.
 */
class FFD_RENDERING_EXPORT RayCaster
{
public:
  static constexpr int TileSize = TileSide;
  static constexpr int SubtileSize = TileSize / 2;
  static constexpr unsigned int AllSubtiles = 15;

  RayCaster(const CastScene& scene, const CastSettings& settings);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Buffers that a thread keeps between tiles; aligned so that no two share a line of the cache.
  struct alignas(128) Scratch
  {
    PacketScratch Packets;
    CastStatistics Statistics;
  };

  /// The counts of a thread.
  static CastStatistics GetStatistics(const Scratch& scratch);

  int GetTilesPerRow(const CastImage& image) const;
  int GetNumberOfTiles(const CastImage& image) const;
  /// `subtiles`: of which subtiles of the tile the pixels are asked for, a bit each, x fastest.
  /// Stops at the deadline, with some pixels done: returns 0 when the tile is finished, else the
  /// number to go on with, as `first`. The pixels do not depend on the stops.
  int RenderTile(int tile, const CastImage& image, Scratch& scratch,
    unsigned int subtiles = AllSubtiles, int first = 0, Deadline deadline = NoDeadline) const;

  /// Cast the ray of one pixel as for the picture and note what was done on the way: by packets the
  /// segments of its tile. Of `image` only the size matters.
  void TraceRay(int x, int y, const CastImage& image, Scratch& scratch, TracedRay& traced) const;

private:
  struct Ray;
  struct Pixel;
  class Sampler;
  template <class JacobianAt>
  class JacobianSegment;

  bool SetUpRay(int x, int y, Ray& ray) const;
  int SetUpTile(int x0, int y0, int x1, int y1, Ray* rays) const;
  void TracePackets(const Ray& ray, const CastImage& image, Scratch& scratch, Pixel& pixel,
    TracedRay& traced) const;
  glm::dvec3 PullBackAlone(
    const glm::dvec3& p, const glm::dvec3* start, CastStatistics& statistics) const;
  void CastSlice(const Ray& ray, Pixel& pixel, CastStatistics& statistics) const;
  void CastSamples(Ray& ray, Pixel& pixel, CastStatistics& statistics) const;
  void CastPolyline(Ray& ray, Pixel& pixel, CastStatistics& statistics) const;

  CastScene Scene;
  CastSettings Settings;
  std::unique_ptr<SampleClassifier> OwnClassifier; // where the scene has none
  IntegrationFrame Frame;
  std::unique_ptr<PacketCaster> Packets;    // null: the reference kernels render
  std::unique_ptr<OrientedInverse> Inverse; // of the reference kernels; null: T is one to one
  glm::dmat3 GradientToRest; // gradient by index coordinates to gradient by data coordinates
  Box RestBox;               // the whole volume at rest, index coordinates
  bool Visible;              // false: all samples would be leaped over, so no ray is cast
};

} // namespace ffd

#endif
