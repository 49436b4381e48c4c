// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTileBounds.h"

#include "FFDBoxImages.h"
#include "FFDPullBack.h"
#include "Packets/FFDTileSegment.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace ffd
{
namespace
{

constexpr float Huge = std::numeric_limits<float>::max();

/// About so many boxes in all, and no smaller than so many voxels.
constexpr double NumberOfBoxes = 2048.0;
constexpr double SmallestEdge = 8.0;

/// Images with fewer tiles are cast in less time than boxes take.
constexpr int FewTiles = 4;

/// The pixels that a box covers, all where it reaches behind the eye.
struct PixelRange
{
  glm::dvec2 Low{ std::numeric_limits<double>::infinity() };
  glm::dvec2 High{ -std::numeric_limits<double>::infinity() };
};

PixelRange FindPixels(const CameraView::PixelRows& rows, const Box& box)
{
  PixelRange range;
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec4 p((corner & 1) != 0 ? box.Max.x : box.Min.x,
      (corner & 2) != 0 ? box.Max.y : box.Min.y, (corner & 4) != 0 ? box.Max.z : box.Min.z, 1.0);
    const double w = glm::dot(rows.W, p);
    // Written so that NaN is behind the eye, too.
    if (!(w > 1e-6 * std::abs(rows.W.w)) || !(w > 0.0))
    {
      return { glm::dvec2(-1e9), glm::dvec2(1e9) };
    }
    const glm::dvec2 at = glm::dvec2(glm::dot(rows.X, p), glm::dot(rows.Y, p)) / w;
    range.Low = glm::min(range.Low, at);
    range.High = glm::max(range.High, at);
  }
  return range;
}

/// A box in which something may be visible, and the tiles that it may be seen through; else none.
struct VisibleBox
{
  glm::ivec2 FirstTile{ 0 };
  glm::ivec2 LastTile{ -1 };
  glm::vec3 Low{ 0.0f };
  glm::vec3 High{ 0.0f };
};

} // namespace

//------------------------------------------------------------------------------
TileBounds::TileBounds(const CastScene& scene, double tolerance, double reach,
  const glm::dvec3& origin, const ParallelFor& parallelFor)
{
  const PullBack& map = *scene.Map;
  const glm::ivec2 tiles = (scene.Camera.ImageSize + (TileSide - 1)) / TileSide;
  if (!scene.Distances || tiles.x * tiles.y < FewTiles ||
    (!map.IsIdentity() && map.GetKind() == PullBackKind::FirstOrderOfInverse))
  {
    return;
  }
  const VolumeView& volume = scene.Volume;
  const bool isForward = map.IsIdentity() || map.GetKind() == PullBackKind::Exact;
  const BoxGrid boxes(isForward ? FindBoundsAtRest(volume) : scene.DeformedBounds, NumberOfBoxes,
    SmallestEdge * scene.VoxelSize);
  const auto images =
    FindBoxImages(scene, boxes, map.GetKind() == PullBackKind::FirstOrder ? -1.0 : 1.0);
  const CameraView::PixelRows rows = scene.Camera.GetPixelRows();
  const double around = reach + BoxGuard * scene.VoxelSize;
  const glm::dvec2 lastTile(tiles - 1);
  Grid<VisibleBox> visible(boxes.Count);
  const auto findRow = [&](int j, int k) {
    for (int i = 0; i < boxes.Count.x; ++i)
    {
      const Box box = boxes.Get({ i, j, k });
      const Box rest = isForward ? box : images->Find({ i, j, k });
      if (ShowsNothing(scene, rest, tolerance + BoxGuard))
      {
        continue;
      }
      Box deformed = isForward ? images->Find({ i, j, k }) : box;
      deformed.Min -= around;
      deformed.Max += around;
      const PixelRange pixels = FindPixels(rows, deformed);
      VisibleBox& found = visible.At(i, j, k);
      found.FirstTile = glm::ivec2(glm::clamp(
        glm::floor((pixels.Low - 1.0) / double{ TileSide }), glm::dvec2(0.0), lastTile + 1.0));
      found.LastTile = glm::ivec2(glm::clamp(
        glm::floor((pixels.High + 1.0) / double{ TileSide }), glm::dvec2(-1.0), lastTile));
      found.Low = glm::vec3(deformed.Min - origin);
      found.High = glm::vec3(deformed.Max - origin);
    }
  };
  parallelFor(static_cast<std::size_t>(boxes.Count.y) * static_cast<std::size_t>(boxes.Count.z),
    [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row)
      {
        findRow(static_cast<int>(row) % boxes.Count.y, static_cast<int>(row) / boxes.Count.y);
      }
    });

  this->Tiles = tiles;
  const Limits nothing{ { Huge, Huge, Huge }, { -Huge, -Huge, -Huge } };
  this->Boxes.assign(
    static_cast<std::size_t>(tiles.x) * static_cast<std::size_t>(tiles.y), nothing);
  for (const VisibleBox& box : visible.Values)
  {
    for (int y = box.FirstTile.y; y <= box.LastTile.y; ++y)
    {
      for (int x = box.FirstTile.x; x <= box.LastTile.x; ++x)
      {
        Limits& tile = this->Boxes[static_cast<std::size_t>(y) * tiles.x + x];
        for (int a = 0; a < 3; ++a)
        {
          tile.Min[a] = std::min(tile.Min[a], box.Low[a]);
          tile.Max[a] = std::max(tile.Max[a], box.High[a]);
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
const TileBounds::Limits* TileBounds::Find(int x0, int y0) const
{
  const glm::ivec2 tile(x0 / TileSide, y0 / TileSide);
  if (x0 < 0 || y0 < 0 || tile.x >= this->Tiles.x || tile.y >= this->Tiles.y ||
    tile * TileSide != glm::ivec2(x0, y0))
  {
    return nullptr;
  }
  return &this->Boxes[static_cast<std::size_t>(tile.y) * this->Tiles.x + tile.x];
}

} // namespace ffd
