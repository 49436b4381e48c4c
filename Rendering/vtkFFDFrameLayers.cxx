// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameLayers.h"

#include "vtkFFDFinalColors.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDTileWorkers.h"

#include "FFDCastScene.h"
#include "FFDClipToBox.h"
#include "FFDRayCaster.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <vector>

namespace
{

/// The rays of a frame are drawn over more pixels: those whose centers are nearer than a step.
class Footprints
{
public:
  Footprints(const vtkFFDImageRegion& region, const glm::ivec2& pixels)
    : Pixels(pixels)
    , Step(region.Step)
    , Reach(region.Step > 1.0 ? region.Step : 0.5)
  {
  }

  /// Rows or columns of pixels of a ray, from the first to the last.
  struct Range
  {
    int First;
    int Last;
  };
  Range GetColumns(int x) const { return this->GetRange(x, this->Pixels.x - 1); }
  Range GetRows(int y) const { return this->GetRange(y, this->Pixels.y - 1); }

  /// The nearest of the window depths, `all` of them, of the pixels of a ray between two depths; 1
  /// if there is none.
  float FindNearest(const std::vector<float>& all, int x, int y, float low, float high) const
  {
    const Range columns = this->GetColumns(x);
    const Range rows = this->GetRows(y);
    float nearest = 1.0f;
    for (int py = rows.First; py <= rows.Last; ++py)
    {
      for (int px = columns.First; px <= columns.Last; ++px)
      {
        const float depth = all[static_cast<std::size_t>(py) * this->Pixels.x + px];
        nearest = depth > low && depth < high ? std::min(nearest, depth) : nearest;
      }
    }
    return nearest;
  }

private:
  Range GetRange(int ray, int lastPixel) const
  {
    const double center = (ray + 0.5) * this->Step;
    Range range;
    range.First =
      std::clamp(static_cast<int>(std::floor(center - this->Reach + 0.5)), 0, lastPixel);
    range.Last = std::clamp(
      static_cast<int>(std::ceil(center + this->Reach - 0.5)) - 1, range.First, lastPixel);
    return range;
  }

  glm::ivec2 Pixels;
  double Step;
  double Reach;
};

} // namespace

//------------------------------------------------------------------------------
/// The depths where rays end: at the farthest geometry of their pixels. Thin geometry would end
/// those of the pixels beside it, too. The nearest are for Cast().
const float* vtkFFDFrameLayers::FindRayDepths(
  const vtkFFDImageRegion& region, const glm::ivec2& pixels, const vtkFFDParallelFor& parallelFor)
{
  const std::size_t columns = static_cast<std::size_t>(region.Rays.x);
  this->RayDepths.resize(columns * static_cast<std::size_t>(region.Rays.y));
  this->NearestDepths.resize(this->RayDepths.size());
  const Footprints footprints(region, pixels);
  const std::size_t width = static_cast<std::size_t>(pixels.x);
  std::vector<Footprints::Range> pixelColumns(columns); // of the rays of each row
  for (std::size_t x = 0; x < columns; ++x)
  {
    pixelColumns[x] = footprints.GetColumns(static_cast<int>(x));
  }
  parallelFor(static_cast<std::size_t>(region.Rays.y), [&](std::size_t first, std::size_t last) {
    std::vector<float> farthest(width); // of the rows of pixels of a row of rays
    std::vector<float> nearest(width);
    for (std::size_t y = first; y < last; ++y)
    {
      const Footprints::Range rows = footprints.GetRows(static_cast<int>(y));
      std::fill(farthest.begin(), farthest.end(), 0.0f);
      std::fill(nearest.begin(), nearest.end(), 1.0f);
      for (int py = rows.First; py <= rows.Last; ++py)
      {
        const float* depths = &this->WindowDepths[static_cast<std::size_t>(py) * width];
        for (std::size_t px = 0; px < width; ++px)
        {
          farthest[px] = std::max(farthest[px], depths[px]);
          nearest[px] = std::min(nearest[px], depths[px]);
        }
      }
      for (std::size_t x = 0; x < columns; ++x)
      {
        const Footprints::Range& range = pixelColumns[x];
        this->RayDepths[y * columns + x] =
          *std::max_element(&farthest[range.First], &farthest[range.Last] + 1);
        this->NearestDepths[y * columns + x] =
          *std::min_element(&nearest[range.First], &nearest[range.Last] + 1);
      }
    }
  });
  return this->RayDepths.data();
}

//------------------------------------------------------------------------------
/// In front of the first visible sample there is nothing; a second ray is cast to the nearest
/// geometry behind that.
vtkFFDImageDisplay::Layers vtkFFDFrameLayers::Cast(const ffd::CastScene& scene,
  const ffd::CastSettings& settings, const vtkFFDImageRegion& region, const glm::ivec2& pixels,
  const Picture& picture, const vtkFFDParallelFor& parallelFor, ffd::VisibleRectangle& visible)
{
  const ffd::BlendMode mode = scene.Blend.Mode;
  const bool startsAtSample =
    mode == ffd::BlendMode::Composite || mode == ffd::BlendMode::Isosurface;
  const glm::ivec2& rays = region.Rays;
  const std::size_t count = this->RayDepths.size();
  const Footprints footprints(region, pixels);
  this->NearDepths.assign(count, 0.0f); // not cast
  this->LayerDepths.assign(3 * count, -1.0f);
  std::atomic<bool> any{ false };
  parallelFor(static_cast<std::size_t>(rays.y), [&](std::size_t firstRow, std::size_t lastRow) {
    bool hasLayers = false;
    for (int y = static_cast<int>(firstRow); y < static_cast<int>(lastRow); ++y)
    {
      for (int x = 0; x < rays.x; ++x)
      {
        const std::size_t at = static_cast<std::size_t>(y) * rays.x + x;
        // Most rays have no geometry before their ends, or nothing that it could hide.
        if (!(this->NearestDepths[at] < this->RayDepths[at]) || picture.Colors[4 * at + 3] == 0.0f)
        {
          continue;
        }
        float* const layers = &this->LayerDepths[3 * at];
        if (startsAtSample)
        {
          const float start = picture.FirstVisible[at];
          hasLayers = true;
          std::fill_n(layers, 3, start);
          if (footprints.FindNearest(this->WindowDepths, x, y, start, this->RayDepths[at]) == 1.0f)
          {
            continue;
          }
        }
        const glm::dvec2 p(x + 0.5, y + 0.5);
        const ffd::CameraView& camera = scene.Camera;
        const ffd::ViewRay ray = camera.MakeRay(p.x, p.y);
        double from = 0.0;
        double to = ray.Far;
        if (!ClipToBox(ray.Origin, ray.Direction, scene.DeformedBounds, from, to))
        {
          continue;
        }
        const auto toT = [&](float depth) {
          return camera.DepthToT(ray, p.x, p.y, static_cast<double>(depth));
        };
        const auto toDepth = [&](
                               double t) { return static_cast<float>(camera.ToDepth(ray.At(t))); };
        const float start = startsAtSample ? picture.FirstVisible[at] : toDepth(from);
        to = std::min(to, toT(this->RayDepths[at]));
        std::fill_n(layers, 3, start);
        const float nearest = footprints.FindNearest(this->WindowDepths, x, y,
          toDepth(toT(start) + scene.VoxelSize), toDepth(to - scene.VoxelSize));
        if (nearest < 1.0f)
        {
          this->NearDepths[at] = layers[1] = nearest;
          layers[2] = toDepth(to);
        }
        hasLayers = true;
      }
    }
    if (hasLayers)
    {
      any = true;
    }
  });
  if (!any)
  {
    return {};
  }
  this->CastNearer(scene, settings, region, picture, parallelFor, visible);
  vtkFFDImageDisplay::Layers layers;
  layers.Colors = this->NearColors.data();
  layers.Depths = this->LayerDepths.data();
  layers.PixelDepths = this->WindowDepths.data();
  for (int a = 0; a < 2; ++a)
  {
    layers.Pixels[a] = pixels[a];
    layers.Origin[a] = region.Origin[a];
    layers.Viewport[a] = region.Viewport[a];
  }
  return layers;
}

//------------------------------------------------------------------------------
/// Cast the rays that end at NearDepths; those of depth 0 are as they were cast.
void vtkFFDFrameLayers::CastNearer(ffd::CastScene scene, const ffd::CastSettings& settings,
  const vtkFFDImageRegion& region, const Picture& picture, const vtkFFDParallelFor& parallelFor,
  ffd::VisibleRectangle& visible)
{
  scene.Depths = this->NearDepths.data();
  const ffd::RayCaster caster(scene, settings);
  this->NearColors = picture.Colors;
  ffd::CastImage image;
  image.Width = region.Rays.x;
  image.Height = region.Rays.y;
  image.Colors = this->NearColors.data();
  const auto forEachRay = [&](int tile, const auto& work) {
    const ffd::RayCaster::TileRange range(tile, region.Rays);
    for (int y = range.First.y; y < range.End.y; ++y)
    {
      for (int x = range.First.x; x < range.End.x; ++x)
      {
        work(static_cast<std::size_t>(y) * image.Width + x);
      }
    }
  };
  vtkFFDTileWorkers workers(parallelFor);
  std::atomic<int> nextTile{ 0 };
  parallelFor.RunWorkers([&](int number) {
    vtkFFDTileWorker& worker = workers.Get(number);
    const int tiles = caster.GetNumberOfTiles(image);
    for (int tile = nextTile++; tile < tiles; tile = nextTile++)
    {
      bool any = false;
      forEachRay(tile, [&](std::size_t at) { any = any || this->NearDepths[at] > 0.0f; });
      if (!any)
      {
        continue;
      }
      const vtkFFDFrameCoherence::Part part{ tile, ffd::RayCaster::AllSubtiles };
      caster.RenderTile(tile, image, worker.Scratch, part.Subtiles);
      picture.FinalColors.Apply(image, part);
      forEachRay(tile, [&](std::size_t at) {
        if (this->NearDepths[at] == 0.0f)
        {
          std::copy_n(&picture.Colors[4 * at], 4, &this->NearColors[4 * at]);
        }
      });
      const ffd::RayCaster::TileRange range(tile, region.Rays);
      worker.Visible.AddPixels(
        image.GetColor(range.First.x, range.First.y), image.Width, range.First, range.End);
    }
  });
  visible.Add(workers.FindVisible());
}

//------------------------------------------------------------------------------
void vtkFFDFrameLayers::ReleaseImages() { *this = vtkFFDFrameLayers(); }
