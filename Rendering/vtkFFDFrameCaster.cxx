// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameCaster.h"

#include "vtkFFDFrame.h"
#include "vtkFFDFrameCache.h"
#include "vtkFFDFramePlan.h"
#include "vtkFFDFrameScene.h"
#include "vtkFFDFrameStages.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDRayStatistics.h"
#include "vtkFFDViewFromRenderer.h"

#include "FFDClipToBox.h"
#include "FFDPixelBytes.h"
#include "FFDRayCaster.h"

#include "vtkMatrix4x4.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

namespace
{

/// Reports of the progress of a frame of which no time is known, if somebody follows it; else the
/// clock says when.
constexpr std::size_t LeastReports = 16;

/// Which part of an image of `rays` some subtiles of tiles are, by their number.
double FindPart(const std::vector<vtkFFDFrameCoherence::Part>& tiles, const glm::ivec2& rays)
{
  std::size_t count = 0;
  for (const vtkFFDFrameCoherence::Part& tile : tiles)
  {
    count += std::bitset<4>(tile.Subtiles).count();
  }
  // At the border of the image there may be fewer subtiles to a tile.
  const glm::ivec2 all = (rays + ffd::RayCaster::SubtileSize - 1) / ffd::RayCaster::SubtileSize;
  return std::min(1.0, static_cast<double>(count) / std::max(1, all.x * all.y));
}

/// Finds what is visible of an image.
ffd::VisibleRectangle FindVisible(
  const std::vector<float>& colors, const glm::ivec2& rays, const vtkFFDParallelFor& parallelFor)
{
  std::mutex mutex;
  ffd::VisibleRectangle all;
  parallelFor(static_cast<std::size_t>(rays.y), [&](std::size_t first, std::size_t last) {
    ffd::VisibleRectangle visible;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      visible = all;
    }
    for (std::size_t i = first; i < last; ++i)
    {
      // Rows from both ends: most of those in the middle then lie within what is known.
      const int half = static_cast<int>(i / 2);
      const int y = i % 2 == 0 ? half : rays.y - 1 - half;
      visible.AddPixels(colors.data() + 4 * static_cast<std::size_t>(y) * rays.x, rays.x, { 0, y },
        { rays.x, y + 1 });
    }
    const std::lock_guard<std::mutex> lock(mutex);
    all.Add(visible);
  });
  return all;
}

/// What a thread keeps between tiles; aligned so that no two share a line of the cache.
struct alignas(128) Worker
{
  ffd::RayCaster::Scratch Scratch;
  ffd::VisibleRectangle Visible; ///< of its tiles
  /// Of a tile of a picture of bytes.
  std::array<float, std::size_t{ 4 } * ffd::RayCaster::TileSize * ffd::RayCaster::TileSize> Colors;

  /// The image that a tile is cast into before its colors are rounded.
  ffd::CastImage GetTile(const ffd::CastImage& image, const ffd::RayCaster::TileRange& range)
  {
    ffd::CastImage tile = image;
    tile.Colors = this->Colors.data();
    tile.FirstColor = range.First;
    tile.ColorsInRow = ffd::RayCaster::TileSize;
    return tile;
  }
};

/// Colors of the tiles of a picture of bytes that are not finished.
class BegunTiles
{
public:
  void Keep(int tile, const Worker& worker)
  {
    this->Colors[tile].assign(worker.Colors.begin(), worker.Colors.end());
  }
  void Restore(int tile, Worker& worker) const
  {
    const std::vector<float>& colors = this->Colors.at(tile);
    std::copy(colors.begin(), colors.end(), worker.Colors.begin());
  }

private:
  std::map<int, std::vector<float>> Colors;
};

/// Those of a frame. Each thread makes its own, all at the same time.
class Workers
{
public:
  explicit Workers(const vtkFFDParallelFor& parallelFor)
    : All(static_cast<std::size_t>(parallelFor.GetNumberOfWorkers()))
  {
  }

  std::size_t GetSize() const { return this->All.size(); }

  Worker& Get(int number)
  {
    std::unique_ptr<Worker>& worker = this->All[static_cast<std::size_t>(number)];
    if (!worker)
    {
      worker.reset(new Worker); // std::make_unique() would fill its 100 kB with zeros
    }
    return *worker;
  }

  template <class Work>
  void ForEach(const Work& work) const
  {
    for (const std::unique_ptr<Worker>& worker : this->All)
    {
      if (worker)
      {
        work(*worker);
      }
    }
  }

private:
  std::vector<std::unique_ptr<Worker>> All;
};

/// Brings the tiles of each group together. They are few: by counting, in one pass.
void SortByGroup(const ffd::RayCaster& caster, const ffd::CastImage& image,
  std::vector<vtkFFDFrameCoherence::Part>& tiles)
{
  std::vector<std::size_t> places; // where the tiles of each group begin
  std::vector<std::size_t> groups;
  groups.reserve(tiles.size());
  for (const vtkFFDFrameCoherence::Part& tile : tiles)
  {
    groups.push_back(static_cast<std::size_t>(caster.GetGroup(tile.Tile, image)));
    places.resize(std::max(places.size(), groups.back() + 2));
    ++places[groups.back() + 1];
  }
  std::partial_sum(places.begin(), places.end(), places.begin());
  std::vector<vtkFFDFrameCoherence::Part> sorted(tiles.size());
  for (std::size_t i = 0; i < tiles.size(); ++i)
  {
    sorted[places[groups[i]]++] = tiles[i];
  }
  tiles.swap(sorted);
}

/// What a frame that was not finished, by an abort or an exception, leaves is nothing to go on
/// from.
class UnfinishedFrame
{
public:
  explicit UnfinishedFrame(vtkFFDFrameCoherence& coherence)
    : Coherence(coherence)
  {
  }
  ~UnfinishedFrame()
  {
    if (!this->Finished)
    {
      this->Coherence.Clear();
    }
  }
  UnfinishedFrame(const UnfinishedFrame&) = delete;
  void operator=(const UnfinishedFrame&) = delete;

  void SetFinished() { this->Finished = true; }

private:
  vtkFFDFrameCoherence& Coherence;
  bool Finished = false;
};

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
vtkFFDFrameCaster::vtkFFDFrameCaster(
  vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache)
  : Mapper(mapper)
  , Cache(cache)
{
}

//------------------------------------------------------------------------------
vtkFFDFrameCaster::~vtkFFDFrameCaster() = default;

//------------------------------------------------------------------------------
vtkFFDParallelFor vtkFFDFrameCaster::MakeParallelFor() const
{
  return vtkFFDParallelFor(this->Mapper->GetNumberOfThreads());
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCaster::CanReuse(vtkVolume* volume) const
{
  return !this->Mapper->GetCollectStatistics() &&
    this->Cache.GetBlending().Mode != ffd::BlendMode::Slice &&
    (vtkFFDFramePlan::IsMoving(this->Mapper, volume) ? this->Mapper->GetFrameCoherence()
                                                     : this->Mapper->GetStillFrameCoherence());
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCaster::Cast(
  vtkFFDFrame& frame, const View& view, const float* depths, float* outDepths)
{
  UnfinishedFrame unfinished(this->Coherence);
  const vtkFFDImageRegion& region = view.Region;
  const vtkFFDFrameScene views(
    this->Mapper, this->Cache, view.Renderer, view.Volume, region, depths);
  const ffd::CastScene& scene = views.Get();
  const ffd::CastSettings settings = vtkFFDFramePlan::MakeSettings(
    this->Mapper, this->Cache, view.Volume, view.Interactive, view.Region.Step);
  ffd::CastImage image;
  image.Width = region.Rays.x;
  image.Height = region.Rays.y;
  const std::size_t rays =
    static_cast<std::size_t>(image.Width) * static_cast<std::size_t>(image.Height);
  const bool layers = view.InWindow && depths && region.Step > 1.0;
  if (layers == this->FirstVisible.empty())
  {
    this->Coherence.Clear();
    this->FirstVisible.resize(layers ? rays : 0);
  }
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  std::unique_ptr<const ffd::RayCaster> made;
  std::vector<vtkFFDFrameCoherence::Part> tiles;
  const bool reuses = view.InWindow && this->CanReuse(view.Volume);
  if (reuses)
  {
    const vtkFFDFrameCoherence::Sources sources = { view.SettingsTime,
      this->Cache.GetVoxelsVersion(), this->Cache.GetFunctionsVersion(),
      ffd::FindSource(view.Volume->GetProperty()), ffd::ToMatrix(view.Volume->GetMatrix()),
      view.Interactive, !vtkFFDFramePlan::IsMoving(this->Mapper, view.Volume) };
    // Both take about as long.
    ffd::RunBoth(
      parallelFor,
      [&] {
        tiles = this->Coherence.Begin(sources, scene, region, this->Cache.GetPullBack().RestBounds,
          this->Mapper->GetFrameCoherenceTolerance(), this->Colors.Floats, this->FirstVisible);
      },
      [&] { made = std::make_unique<const ffd::RayCaster>(scene, settings); });
    image.Reaches = this->Coherence.GetReaches();
  }
  else
  {
    made = std::make_unique<const ffd::RayCaster>(scene, settings, parallelFor);
    this->Coherence.Clear();
    this->FirstVisible.resize(layers ? rays : 0);
    for (int tile = 0; tile < made->GetNumberOfTiles(image); ++tile)
    {
      tiles.push_back({ tile, ffd::RayCaster::AllSubtiles });
    }
  }
  const ffd::RayCaster& caster = *made;
  const auto groupOf = [&](const vtkFFDFrameCoherence::Part& tile) {
    return caster.GetGroup(tile.Tile, image);
  };
  SortByGroup(caster, image, tiles);
  const double part = FindPart(tiles, region.Rays);
  this->ReusedFraction = 1.0 - part;
  this->Intervals = caster.ClassifiesIntervals();
  image.Depths = layers ? this->FirstVisible.data() : outDepths;

  Workers workers(parallelFor);
  // Observers may change the options.
  const bool collect = this->Mapper->GetCollectStatistics() != 0;
  this->FinalWindow = this->Mapper->GetFinalColorWindow();
  this->FinalLevel = this->Mapper->GetFinalColorLevel();
  std::atomic<std::size_t> next{ 0 };
  std::mutex mutex;
  std::vector<vtkFFDFrameCoherence::Part> stopped; // tiles that were taken and are not finished
  // A worker takes the tiles of a group together; near the end fewer, so that all workers are busy.
  // What is counted must not depend on that.
  const std::size_t shares = 2 * workers.GetSize();
  const auto take = [&](std::size_t end) {
    std::size_t first = next;
    std::size_t last = first;
    do
    {
      const std::size_t most =
        collect ? tiles.size() : std::min(end, first + (tiles.size() - first) / shares);
      last = first < end ? first + 1 : first;
      while (last > first && last < most && groupOf(tiles[last]) == groupOf(tiles[first]))
      {
        ++last;
      }
    } while (!next.compare_exchange_weak(first, last));
    return std::make_pair(first, last);
  };
  bool aborted = !frame.ReportCasting(0.0);
  const bool wantsBytes = view.AsBytes && view.AsBytes();
  const bool asBytes = wantsBytes && !reuses;
  this->Colors.Bytes.resize(wantsBytes ? 4 * rays : 0);
  this->Colors.Floats.resize(asBytes ? 0 : 4 * rays);
  image.Colors = this->Colors.Floats.data();
  BegunTiles begunTiles;
  const auto finish = [&](const vtkFFDFrameCoherence::Part& tile, const ffd::CastImage& colors,
                        Worker& worker) {
    this->ApplyFinalColors(colors, tile);
    const ffd::RayCaster::TileRange range(tile.Tile, region.Rays);
    const glm::ivec2& first = range.First;
    if (view.IsDrawn && !reuses)
    {
      worker.Visible.AddPixels(
        colors.GetColor(first.x, first.y), colors.GetColorsInRow(), first, range.End);
    }
    for (int y = first.y; asBytes && y < range.End.y; ++y)
    {
      const std::size_t at = static_cast<std::size_t>(y) * image.Width + first.x;
      ffd::WritePixelBytes(colors.GetColor(first.x, y),
        static_cast<std::size_t>(range.End.x - first.x), view.Premultiplied,
        &this->Colors.Bytes[4 * at]);
    }
  };
  // What finish() makes of a picture of bytes through which nothing can be seen.
  const auto clear = [&](int tile) {
    const ffd::RayCaster::TileRange range(tile, region.Rays);
    const std::size_t width = static_cast<std::size_t>(range.End.x - range.First.x);
    for (int y = range.First.y; y < range.End.y; ++y)
    {
      const std::size_t at = static_cast<std::size_t>(y) * image.Width + range.First.x;
      std::fill_n(&this->Colors.Bytes[4 * at], 4 * width, static_cast<unsigned char>(0));
      if (image.Depths)
      {
        std::fill_n(image.Depths + at, width, 1.0f);
      }
    }
  };
  if (tiles.empty() && !aborted)
  {
    frame.ReportCasting(1.0);
  }
  const std::size_t most = view.HasTimeEstimate || !frame.IsFollowed()
    ? tiles.size()
    : tiles.size() / LeastReports + 1; // of tiles between reports
  while (next < tiles.size() && !aborted)
  {
    const ffd::Deadline due = frame.GetNextReport();
    const std::size_t end = std::min(tiles.size(), next + most);
    parallelFor.RunWorkers([&](int number) {
      Worker& worker = workers.Get(number);
      do
      {
        const auto [first, last] = take(end);
        if (first == last)
        {
          return;
        }
        for (std::size_t i = first; i < last; ++i)
        {
          vtkFFDFrameCoherence::Part& tile = tiles[i];
          if (asBytes && caster.IsTileEmpty(tile.Tile, image))
          {
            clear(tile.Tile);
            continue;
          }
          // A tile that stops evaluates some of the deformation again: that is not to be counted.
          const bool late = !collect && i > first && vtkFFDFrame::Clock::now() >= due;
          const ffd::CastImage colors = asBytes
            ? worker.GetTile(image, ffd::RayCaster::TileRange(tile.Tile, region.Rays))
            : image;
          if (!late)
          {
            if (asBytes && tile.First != 0)
            {
              const std::lock_guard<std::mutex> lock(mutex);
              begunTiles.Restore(tile.Tile, worker);
            }
            tile.First = caster.RenderTile(tile.Tile, colors, worker.Scratch, tile.Subtiles,
              tile.First, collect ? ffd::NoDeadline : due);
          }
          if (late || tile.First != 0)
          {
            const std::lock_guard<std::mutex> lock(mutex);
            stopped.push_back(tile);
            if (asBytes && !late)
            {
              begunTiles.Keep(tile.Tile, worker);
            }
          }
          else
          {
            finish(tile, colors, worker);
          }
        }
      } while (vtkFFDFrame::Clock::now() < due);
    });
    std::size_t begun = next;
    for (const vtkFFDFrameCoherence::Part& tile : stopped)
    {
      tiles[--begun] = tile;
    }
    stopped.clear();
    next = begun;
    aborted = !frame.ReportCasting(static_cast<double>(begun) / static_cast<double>(tiles.size()));
  }
  if (aborted)
  {
    return false;
  }
  if (reuses)
  {
    this->Visible = FindVisible(this->Colors.Floats, region.Rays, parallelFor);
    // The next frame takes up the floats.
    parallelFor(wantsBytes ? rays : 0, [&](std::size_t first, std::size_t last) {
      ffd::WritePixelBytes(&this->Colors.Floats[4 * first], last - first, view.Premultiplied,
        &this->Colors.Bytes[4 * first]);
    });
  }
  else
  {
    this->Visible = ffd::VisibleRectangle();
    workers.ForEach([&](const Worker& each) { this->Visible.Add(each.Visible); });
  }

  if (collect)
  {
    ffd::CastStatistics total;
    workers.ForEach(
      [&](const Worker& each) { total.Add(ffd::RayCaster::GetStatistics(each.Scratch)); });
    this->Mapper->GetStatistics()->SetCounts(total.Rays, total.Segments, total.SegmentLength,
      total.Samples, total.VisibleSamples, total.DistanceLookups, total.Evaluations,
      total.Unconverged);
  }
  unfinished.SetFinished();
  return true;
}

//------------------------------------------------------------------------------
/// The depths where rays end: at the farthest geometry of their pixels. Thin geometry would end
/// those of the pixels beside it, too. The nearest are for CastLayers().
const float* vtkFFDFrameCaster::FindRayDepths(
  const vtkFFDImageRegion& region, const glm::ivec2& pixels)
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
  this->MakeParallelFor()(
    static_cast<std::size_t>(region.Rays.y), [&](std::size_t first, std::size_t last) {
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
/// After Cast() with these depths: where geometry is nearer in some of the pixels of a ray, what is
/// seen in front of it. In front of the first visible sample that is nothing; a second ray is cast
/// to the nearest geometry behind that.
vtkFFDImageDisplay::Layers vtkFFDFrameCaster::CastLayers(const View& view, const glm::ivec2& pixels)
{
  const vtkFFDImageRegion& region = view.Region;
  const vtkFFDFrameScene views(
    this->Mapper, this->Cache, view.Renderer, view.Volume, region, nullptr);
  const ffd::CastScene& scene = views.Get();
  const ffd::BlendMode mode = scene.Blend.Mode;
  const bool startsAtSample =
    mode == ffd::BlendMode::Composite || mode == ffd::BlendMode::Isosurface;
  const glm::ivec2& rays = region.Rays;
  const std::size_t count = this->RayDepths.size();
  const Footprints footprints(region, pixels);
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
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
        if (!(this->NearestDepths[at] < this->RayDepths[at]) ||
          this->Colors.Floats[4 * at + 3] == 0.0f)
        {
          continue;
        }
        float* const layers = &this->LayerDepths[3 * at];
        if (startsAtSample)
        {
          const float start = this->FirstVisible[at];
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
        const auto toDepth = [&](double t) {
          return static_cast<float>(camera.ToDepth(ray.Origin + t * ray.Direction));
        };
        const float start = startsAtSample ? this->FirstVisible[at] : toDepth(from);
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
  this->CastNearer(view, scene);
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
/// The rays that end at NearDepths; those of depth 0 are as they were cast.
void vtkFFDFrameCaster::CastNearer(const View& view, ffd::CastScene scene)
{
  const vtkFFDImageRegion& region = view.Region;
  scene.Depths = this->NearDepths.data();
  const ffd::RayCaster caster(scene,
    vtkFFDFramePlan::MakeSettings(
      this->Mapper, this->Cache, view.Volume, view.Interactive, view.Region.Step));
  this->NearColors = this->Colors.Floats;
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
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  Workers workers(parallelFor);
  std::atomic<int> nextTile{ 0 };
  parallelFor.RunWorkers([&](int number) {
    Worker& worker = workers.Get(number);
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
      this->ApplyFinalColors(image, part);
      forEachRay(tile, [&](std::size_t at) {
        if (this->NearDepths[at] == 0.0f)
        {
          std::copy_n(&this->Colors.Floats[4 * at], 4, &this->NearColors[4 * at]);
        }
      });
      const ffd::RayCaster::TileRange range(tile, region.Rays);
      worker.Visible.AddPixels(
        image.GetColor(range.First.x, range.First.y), image.Width, range.First, range.End);
    }
  });
  workers.ForEach([&](const Worker& each) { this->Visible.Add(each.Visible); });
}

//------------------------------------------------------------------------------
/// Window and level of the colors of a finished tile.
void vtkFFDFrameCaster::ApplyFinalColors(
  const ffd::CastImage& image, const vtkFFDFrameCoherence::Part& tile) const
{
  const double window = this->FinalWindow;
  const double level = this->FinalLevel;
  if (window == 1.0 && level == 0.5)
  {
    return;
  }
  const float scale = static_cast<float>(1.0 / window);
  const float bias = static_cast<float>(0.5 - level / window);
  const ffd::RayCaster::TileRange range(tile.Tile, { image.Width, image.Height });
  for (int y = range.First.y; y < range.End.y; ++y)
  {
    for (int x = range.First.x; x < range.End.x; ++x)
    {
      const glm::ivec2 subtile = (glm::ivec2(x, y) - range.First) / ffd::RayCaster::SubtileSize;
      if ((tile.Subtiles >> (subtile.x + 2 * subtile.y) & 1u) == 0)
      {
        continue;
      }
      float* const pixel = image.GetColor(x, y);
      for (int c = 0; c < 3; ++c)
      {
        pixel[c] = std::clamp(pixel[c] * scale + bias * pixel[3], 0.0f, 1.0f);
      }
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDFrameCaster::ReleaseImages()
{
  this->Coherence.Clear();
  this->Colors = Picture();
  std::vector<float>().swap(this->WindowDepths);
  std::vector<float>().swap(this->RayDepths);
  std::vector<float>().swap(this->NearestDepths);
  std::vector<float>().swap(this->FirstVisible);
  std::vector<float>().swap(this->NearDepths);
  std::vector<float>().swap(this->LayerDepths);
  std::vector<float>().swap(this->NearColors);
}
