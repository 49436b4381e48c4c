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
#include "vtkFFDTileQueue.h"
#include "vtkFFDTileWorkers.h"
#include "vtkFFDViewFromRenderer.h"

#include "FFDPixelBytes.h"
#include "FFDRayCaster.h"

#include "vtkMatrix4x4.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>

#include <algorithm>
#include <bitset>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace
{

/// Reports of the progress of a frame, at least, of which no time is known and which somebody
/// follows; else the clock alone says when.
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

/// Takes up the tiles of a picture as workers cast them.
class PictureOfTiles
{
public:
  /// `bytes`: an image of these is wanted, whose tiles are cast by the workers into floats of their
  /// own. Else the floats of the picture are those of `image`.
  PictureOfTiles(vtkFFDFrameCaster::Picture& picture, const ffd::CastImage& image,
    const vtkFFDFinalColors& finalColors, bool bytes, bool premultiplied)
    : Picture(picture)
    , Image(image)
    , FinalColors(finalColors)
    , Bytes(bytes)
    , Premultiplied(premultiplied)
  {
  }

  bool IsOfBytes() const { return this->Bytes; }

  /// The image that a worker is to cast a tile into; colors of a tile that has been begun are
  /// there.
  ffd::CastImage Open(const vtkFFDFrameCoherence::Part& part, vtkFFDTileWorker& worker)
  {
    ffd::CastImage image = this->Image;
    if (this->Bytes)
    {
      image.Colors = worker.Colors.data();
      image.FirstColor = this->FindRange(part).First;
      image.ColorsInRow = ffd::RayCaster::TileSize;
      if (part.First != 0)
      {
        const std::lock_guard<std::mutex> lock(this->Mutex);
        const std::vector<float>& colors = this->Begun.at(part.Tile);
        std::copy(colors.begin(), colors.end(), worker.Colors.begin());
      }
    }
    return image;
  }

  /// A tile is not finished: it will be opened again.
  void Keep(const vtkFFDFrameCoherence::Part& part, const vtkFFDTileWorker& worker)
  {
    if (this->Bytes)
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      this->Begun[part.Tile].assign(worker.Colors.begin(), worker.Colors.end());
    }
  }

  /// `findVisible`: note what is visible of the tile.
  void Finish(const vtkFFDFrameCoherence::Part& part, const ffd::CastImage& colors,
    vtkFFDTileWorker& worker, bool findVisible)
  {
    this->FinalColors.Apply(colors, part);
    const ffd::RayCaster::TileRange range = this->FindRange(part);
    const glm::ivec2& first = range.First;
    if (findVisible)
    {
      worker.Visible.AddPixels(
        colors.GetColor(first.x, first.y), colors.GetColorsInRow(), first, range.End);
    }
    for (int y = first.y; this->Bytes && y < range.End.y; ++y)
    {
      ffd::WritePixelBytes(colors.GetColor(first.x, y),
        static_cast<std::size_t>(range.End.x - first.x), this->Premultiplied,
        &this->Picture.Bytes[4 * this->FindPixel(first.x, y)]);
    }
  }

  /// What Finish() makes of a tile of a picture of bytes through which nothing can be seen.
  void Clear(const vtkFFDFrameCoherence::Part& part)
  {
    const ffd::RayCaster::TileRange range = this->FindRange(part);
    const std::size_t width = static_cast<std::size_t>(range.End.x - range.First.x);
    for (int y = range.First.y; y < range.End.y; ++y)
    {
      const std::size_t at = this->FindPixel(range.First.x, y);
      std::fill_n(&this->Picture.Bytes[4 * at], 4 * width, static_cast<unsigned char>(0));
      if (this->Image.Depths)
      {
        std::fill_n(this->Image.Depths + at, width, 1.0f);
      }
    }
  }

private:
  ffd::RayCaster::TileRange FindRange(const vtkFFDFrameCoherence::Part& part) const
  {
    return { part.Tile, glm::ivec2(this->Image.Width, this->Image.Height) };
  }
  std::size_t FindPixel(int x, int y) const
  {
    return static_cast<std::size_t>(y) * this->Image.Width + x;
  }

  vtkFFDFrameCaster::Picture& Picture;
  const ffd::CastImage& Image;
  const vtkFFDFinalColors& FinalColors;
  bool Bytes;
  bool Premultiplied;
  std::mutex Mutex;
  std::map<int, std::vector<float>> Begun; // colors of the tiles of bytes that are not finished
};

/// Casts the tiles of a queue into a picture.
class TileCaster
{
public:
  /// Keeps references. `mayStop`: tiles may stop where they are due, and be begun again.
  /// `findVisible`: note what is visible of the tiles.
  TileCaster(const ffd::RayCaster& caster, const ffd::CastImage& image, PictureOfTiles& picture,
    vtkFFDTileQueue& queue, bool mayStop, bool findVisible)
    : Caster(caster)
    , Image(image)
    , Picture(picture)
    , Queue(queue)
    , MayStop(mayStop)
    , FindsVisible(findVisible)
  {
  }

  /// Casts a round of at most so many tiles, which ends when it is due.
  void CastRound(const vtkFFDParallelFor& parallelFor, vtkFFDTileWorkers& workers,
    std::size_t mostTiles, ffd::Deadline due)
  {
    this->Queue.BeginRound(mostTiles);
    parallelFor.RunWorkers([&](int number) { this->CastShares(workers.Get(number), due); });
    this->Queue.EndRound();
  }

private:
  static bool IsLate(ffd::Deadline due) { return vtkFFDFrame::Clock::now() >= due; }

  void CastShares(vtkFFDTileWorker& worker, ffd::Deadline due)
  {
    do
    {
      const vtkFFDTileQueue::Share share = this->Queue.Take();
      if (share.IsEmpty())
      {
        return;
      }
      for (std::size_t i = share.First; i < share.End; ++i)
      {
        this->CastTile(this->Queue.Get(i), i > share.First && IsLate(due), due, worker);
      }
    } while (!IsLate(due));
  }

  void CastTile(
    vtkFFDTileQueue::Tile tile, bool isLate, ffd::Deadline due, vtkFFDTileWorker& worker)
  {
    if (this->Picture.IsOfBytes() && this->Caster.IsTileEmpty(tile.Tile, this->Image))
    {
      this->Picture.Clear(tile);
      return;
    }
    if (this->MayStop && isLate)
    {
      this->Queue.PutBack(tile);
      return;
    }
    const ffd::CastImage colors = this->Picture.Open(tile, worker);
    tile.First = this->Caster.RenderTile(tile.Tile, colors, worker.Scratch, tile.Subtiles,
      tile.First, this->MayStop ? due : ffd::NoDeadline);
    if (tile.First != 0)
    {
      this->Picture.Keep(tile, worker);
      this->Queue.PutBack(tile);
      return;
    }
    this->Picture.Finish(tile, colors, worker, this->FindsVisible);
  }

  const ffd::RayCaster& Caster;
  const ffd::CastImage& Image;
  PictureOfTiles& Picture;
  vtkFFDTileQueue& Queue;
  bool MayStop;
  bool FindsVisible;
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
ffd::CastSettings vtkFFDFrameCaster::MakeSettings(const View& view) const
{
  return vtkFFDFramePlan::MakeSettings(
    this->Mapper, this->Cache, view.Volume, view.Interactive, view.Region.Step);
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
/// Make the caster of a picture, and find the tiles that it must cast. `layers`: see
/// FirstVisible.
std::unique_ptr<const ffd::RayCaster> vtkFFDFrameCaster::MakeCaster(const View& view,
  const ffd::CastScene& scene, bool layers, bool reuses, ffd::CastImage& image,
  std::vector<vtkFFDFrameCoherence::Part>& tiles)
{
  const std::size_t rays =
    static_cast<std::size_t>(image.Width) * static_cast<std::size_t>(image.Height);
  if (layers == this->Now->FirstVisible.empty() || !reuses)
  {
    this->Now->Coherence.Clear();
    this->Now->FirstVisible.resize(layers ? rays : 0);
  }
  const ffd::CastSettings settings = this->MakeSettings(view);
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  if (!reuses)
  {
    auto caster = std::make_unique<const ffd::RayCaster>(scene, settings, parallelFor);
    for (int tile = 0; tile < caster->GetNumberOfTiles(image); ++tile)
    {
      tiles.push_back({ tile, ffd::RayCaster::AllSubtiles });
    }
    return caster;
  }
  const vtkFFDFrameCoherence::Sources sources = { view.SettingsTime, this->Cache.GetVoxelsVersion(),
    this->Cache.GetFunctionsVersion(), ffd::FindSource(view.Volume->GetProperty()),
    ffd::ToMatrix(view.Volume->GetMatrix()), view.Interactive,
    !vtkFFDFramePlan::IsMoving(this->Mapper, view.Volume) };
  std::unique_ptr<const ffd::RayCaster> caster;
  // Both take about as long.
  ffd::RunBoth(
    parallelFor,
    [&] {
      tiles = this->Now->Coherence.Begin(sources, scene, view.Region,
        this->Cache.GetPullBack().RestBounds, this->Mapper->GetFrameCoherenceTolerance(),
        this->Now->Colors.Floats, this->Now->FirstVisible);
    },
    [&] { caster = std::make_unique<const ffd::RayCaster>(scene, settings); });
  image.Reaches = this->Now->Coherence.GetReaches();
  return caster;
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCaster::Cast(
  vtkFFDFrame& frame, const View& view, const float* depths, float* outDepths)
{
  const double begin = frame.GetSeconds();
  UnfinishedFrame unfinished(this->Now->Coherence);
  const vtkFFDImageRegion& region = view.Region;
  const vtkFFDFrameScene scene(
    this->Mapper, this->Cache, view.Renderer, view.Volume, region, depths);
  ffd::CastImage image;
  image.Width = region.Rays.x;
  image.Height = region.Rays.y;
  const bool layers = view.InWindow && depths && region.Step > 1.0;
  const bool reuses = view.InWindow && this->CanReuse(view.Volume);
  std::vector<vtkFFDFrameCoherence::Part> tiles;
  const std::unique_ptr<const ffd::RayCaster> caster =
    this->MakeCaster(view, scene.Get(), layers, reuses, image, tiles);
  this->PreparationTime = frame.GetSeconds() - begin;
  this->ReusedFraction = 1.0 - FindPart(tiles, region.Rays);
  this->Intervals = caster->ClassifiesIntervals();
  image.Depths = layers ? this->Now->FirstVisible.data() : outDepths;

  // Observers may change the options, and what is drawn into.
  const bool counts = this->Mapper->GetCollectStatistics() != 0;
  this->FinalColors = { this->Mapper->GetFinalColorWindow(), this->Mapper->GetFinalColorLevel() };
  bool done = frame.ReportCasting(0.0);
  const bool wantsBytes = view.AsBytes && view.AsBytes();
  const bool asBytes = wantsBytes && !reuses;
  const std::size_t rays =
    static_cast<std::size_t>(image.Width) * static_cast<std::size_t>(image.Height);
  this->Now->Colors.Bytes.resize(wantsBytes ? 4 * rays : 0);
  this->Now->Colors.Floats.resize(asBytes ? 0 : 4 * rays);
  image.Colors = this->Now->Colors.Floats.data();

  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  vtkFFDTileWorkers workers(parallelFor);
  vtkFFDTileQueue queue(std::move(tiles), *caster, image, workers.GetSize(), counts);
  PictureOfTiles picture(this->Now->Colors, image, this->FinalColors, asBytes, view.Premultiplied);
  // A tile that stops evaluates some of the deformation again: that is not to be counted.
  TileCaster tileCaster(*caster, image, picture, queue, !counts, view.IsDrawn && !reuses);
  const std::size_t mostInRound = view.HasTimeEstimate || !frame.IsFollowed()
    ? queue.GetSize()
    : queue.GetSize() / LeastReports + 1;
  if (queue.IsEmpty() && done)
  {
    frame.ReportCasting(1.0);
  }
  while (!queue.IsEmpty() && done)
  {
    tileCaster.CastRound(parallelFor, workers, mostInRound, frame.GetNextReport());
    done = frame.ReportCasting(queue.GetFinishedPart());
  }
  if (!done)
  {
    return false;
  }
  if (reuses)
  {
    this->Now->Visible = FindVisible(this->Now->Colors.Floats, region.Rays, parallelFor);
    // The next frame takes up the floats.
    parallelFor(wantsBytes ? rays : 0, [&](std::size_t first, std::size_t last) {
      ffd::WritePixelBytes(&this->Now->Colors.Floats[4 * first], last - first, view.Premultiplied,
        &this->Now->Colors.Bytes[4 * first]);
    });
  }
  else
  {
    this->Now->Visible = workers.FindVisible();
  }
  if (counts)
  {
    const ffd::CastStatistics total = workers.GetStatistics();
    this->Mapper->GetStatistics()->SetCounts(total.Rays, total.Segments, total.SegmentLength,
      total.Samples, total.VisibleSamples, total.DistanceLookups, total.Evaluations,
      total.Unconverged);
  }
  unfinished.SetFinished();
  return true;
}

//------------------------------------------------------------------------------
vtkFFDImageDisplay::Layers vtkFFDFrameCaster::CastLayers(const View& view, const glm::ivec2& pixels)
{
  const vtkFFDFrameScene scene(
    this->Mapper, this->Cache, view.Renderer, view.Volume, view.Region, nullptr);
  return this->Layers.Cast(scene.Get(), this->MakeSettings(view), view.Region, pixels,
    { this->Now->Colors.Floats, this->Now->FirstVisible, this->FinalColors },
    this->MakeParallelFor(), this->Now->Visible);
}

//------------------------------------------------------------------------------
const float* vtkFFDFrameCaster::FindRayDepths(
  const vtkFFDImageRegion& region, const glm::ivec2& pixels)
{
  return this->Layers.FindRayDepths(region, pixels, this->MakeParallelFor());
}

//------------------------------------------------------------------------------
std::size_t vtkFFDFrameCaster::GetCoherenceSize() const
{
  std::size_t size = 0;
  for (const KeptPicture& kept : this->Kept)
  {
    size += kept.Coherence.GetMemorySize();
  }
  return size;
}

//------------------------------------------------------------------------------
void vtkFFDFrameCaster::ReleaseImages()
{
  for (KeptPicture& kept : this->Kept)
  {
    kept.Coherence.Clear();
    kept.Colors = Picture();
    std::vector<float>().swap(kept.FirstVisible);
  }
  this->Layers.ReleaseImages();
}
