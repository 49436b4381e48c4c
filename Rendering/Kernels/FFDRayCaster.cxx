// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDRayCaster.h"

#include "FFDSamplePhase.h"
#include "Packets/FFDPacketTrace.h"
#include "Reference/FFDSegmentSampler.h"

#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace ffd
{

//------------------------------------------------------------------------------
RayCaster::RayCaster(
  const CastScene& scene, const CastSettings& settings, const ParallelFor& parallelFor)
  : Scene(scene)
  , Settings(settings)
  , RestBox(FindRestBox(scene.Volume, scene.WholeAtRest))
  , Visible(scene.Blend.Mode == BlendMode::Slice || !scene.Distances ||
      settings.Leaping == SpaceLeaping::Off ||
      // The paper's method counts what it does in empty space, too.
      (settings.Segments == Segmentation::GreedyAngle &&
        settings.Leaping == SpaceLeaping::Segment) ||
      scene.Distances->IsAnythingVisible())
{
  if (!this->Scene.Classifier)
  {
    this->OwnClassifier.reset(
      new SampleClassifier(this->Scene.Volume, this->Scene.VolumeInterpolation, *this->Scene.Table,
        this->Scene.Material, this->Settings.Shade));
    this->Scene.Classifier = this->OwnClassifier.get();
  }
  this->Frame.Classifier = this->Scene.Classifier;
  this->Frame.Scene = &this->Scene;
  this->Frame.Settings = &this->Settings;
  this->Frame.IndexToData = scene.Volume.IndexToData;
  if (!CanClassifyIntervals(scene, settings, *this->Scene.Classifier))
  {
    this->Settings.Classify = Classification::Samples;
  }
  if (this->ClassifiesIntervals())
  {
    this->Frame.Intervals = IntervalTable(*scene.Table, settings.SampleDistance);
  }
  if (this->Visible && PacketCaster::Supports(this->Scene, settings))
  {
    this->Packets.reset(new PacketCaster(this->Scene, this->Settings, this->Frame, parallelFor));
  }
  // Slices have no segments that packets could tell of: the reference caster traces their rays.
  if (!this->Packets || scene.Blend.Mode == BlendMode::Slice)
  {
    this->Reference.reset(new ReferenceCaster(this->Scene, this->Settings, this->RestBox));
  }
}

//------------------------------------------------------------------------------
CastStatistics RayCaster::GetStatistics(const Scratch& scratch)
{
  CastStatistics sum = scratch.Statistics;
  sum.Add(scratch.Packets.Statistics);
  return sum;
}

//------------------------------------------------------------------------------
RayCaster::~RayCaster() = default;

//------------------------------------------------------------------------------
int RayCaster::GetNumberOfTiles(const CastImage& image) const
{
  return GetTilesPerRow(image.Width) * ((image.Height + TileSize - 1) / TileSize);
}

//------------------------------------------------------------------------------
int RayCaster::GetGroup(int tile, const CastImage& image) const
{
  if (!this->Packets || this->Packets->GetRootSide() <= TileSize)
  {
    return tile;
  }
  constexpr int tiles = GroupSize / TileSize;
  const int tilesPerRow = GetTilesPerRow(image.Width);
  const int groupsPerRow = (tilesPerRow + tiles - 1) / tiles;
  return tile / tilesPerRow / tiles * groupsPerRow + tile % tilesPerRow / tiles;
}

//------------------------------------------------------------------------------
int RayCaster::SetUpTile(int x0, int y0, int x1, int y1, CastRay* rays) const
{
  int count = 0;
  for (int y = y0; y <= y1; ++y)
  {
    for (int x = x0; x <= x1; ++x)
    {
      CastRay& ray = rays[count];
      if (MakeCastRay(this->Scene, this->Settings, this->RestBox, x, y, ray))
      {
        ++count;
      }
    }
  }
  return count;
}

//------------------------------------------------------------------------------
void RayCaster::TraceRay(
  int x, int y, const CastImage& image, Scratch& scratch, TracedRay& traced) const
{
  traced = TracedRay();
  CastRay ray;
  traced.Hit = MakeCastRay(this->Scene, this->Settings, this->RestBox, x, y, ray);
  traced.Viewing = ray.Viewing;
  if (!traced.Hit)
  {
    return;
  }
  traced.From = ray.From;
  traced.To = ray.To;
  RayPixel pixel(this->Frame, ray);
  pixel.Trace = &traced;
  if (!this->Reference)
  {
    TracePackets(
      *this->Packets, this->Scene, this->Settings, ray, image, scratch.Packets, pixel, traced);
    return;
  }
  this->Reference->Cast(ray, pixel, scratch.Statistics);
  traced.Terminated = pixel.Done;
  const RayIntegrator::Result result = pixel.Integrator.End();
  traced.Color = glm::vec4(result.Color, 1.0f - result.Transmittance);
}

//------------------------------------------------------------------------------
bool RayCaster::IsTileEmpty(int tile, const CastImage& image) const
{
  const TileRange range(tile, { image.Width, image.Height });
  return this->Packets && this->Packets->IsTileEmpty(range.First.x, range.First.y);
}

//------------------------------------------------------------------------------
int RayCaster::RenderTile(int tile, const CastImage& image, Scratch& scratch, unsigned int subtiles,
  int first, Deadline deadline) const
{
  const TileRange range(tile, { image.Width, image.Height });
  const int x0 = range.First.x;
  const int y0 = range.First.y;
  if (this->Packets)
  {
    return this->Packets->RenderTile(x0, y0, subtiles, image, scratch.Packets, first, deadline);
  }
  const int x1 = range.End.x - 1;
  const int y1 = range.End.y - 1;
  const auto isWanted = [&](int x, int y) {
    const int subtile = (x - x0) / SubtileSize + 2 * ((y - y0) / SubtileSize);
    return (subtiles >> subtile & 1u) != 0;
  };
  for (int y = y0; y <= y1 && first == 0; ++y)
  {
    for (int x = x0; x <= x1; x += SubtileSize)
    {
      if (!isWanted(x, y))
      {
        continue;
      }
      const std::size_t at = static_cast<std::size_t>(y) * image.Width + x;
      const int width = std::min(SubtileSize, x1 - x + 1);
      std::fill_n(image.GetColor(x, y), 4 * width, 0.0f);
      if (image.Depths)
      {
        std::fill_n(image.Depths + at, width, 1.0f);
      }
      if (image.Reaches)
      {
        const int perRow = (image.Width + SubtileSize - 1) / SubtileSize;
        image.Reaches[y / SubtileSize * perRow + x / SubtileSize] =
          std::numeric_limits<float>::infinity();
      }
    }
  }
  if (!this->Visible)
  {
    return 0;
  }
  std::array<CastRay, TileSize * TileSize> rays;
  const int count = this->SetUpTile(x0, y0, x1, y1, rays.data());
  for (int i = first; i < count; ++i)
  {
    const CastRay& ray = rays[i];
    if (!isWanted(ray.X, ray.Y))
    {
      continue;
    }
    ++scratch.Statistics.Rays;
    RayPixel pixel(this->Frame, ray);
    this->Reference->Cast(ray, pixel, scratch.Statistics);
    const std::size_t at = static_cast<std::size_t>(ray.Y) * image.Width + ray.X;
    const RayIntegrator::Result result = pixel.Integrator.End();
    float* const color = image.GetColor(ray.X, ray.Y);
    color[0] = result.Color.r;
    color[1] = result.Color.g;
    color[2] = result.Color.b;
    color[3] = 1.0f - result.Transmittance;
    if (image.Depths && result.FirstVisible < std::numeric_limits<double>::infinity())
    {
      image.Depths[at] =
        static_cast<float>(this->Scene.Camera.ToDepth(ray.At(result.FirstVisible)));
    }
    if (deadline != NoDeadline && std::chrono::steady_clock::now() >= deadline)
    {
      return i + 1;
    }
  }
  return 0;
}

} // namespace ffd
