// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTileBounds.h"

#include "Bounds/FFDMatrixBounds.h"
#include "FFDBSplineBasis.h"
#include "FFDPullBack.h"
#include "FFDSplineGrid.h"
#include "Packets/FFDTileSegment.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace ffd
{
namespace
{

constexpr float Huge = std::numeric_limits<float>::max();

/// About so many boxes in all, along an axis at most, and no smaller than so many voxels.
constexpr double NumberOfBoxes = 2048.0;
constexpr int MostAlongAxis = 64;
constexpr double SmallestEdge = 8.0;

/// Images with fewer tiles are cast in less time than boxes take.
constexpr int FewTiles = 4;

/// Kept around boxes for what is rounded, voxels.
constexpr double Guard = 0.5;

/// Boxes at rest, aligned with the axes of data coordinates.
struct RestBoxes
{
  glm::dvec3 First; ///< lowest corner
  glm::dvec3 Edge;
  glm::ivec3 Count;

  RestBoxes(const Box& bounds, double voxel)
    : First(bounds.Min)
  {
    const glm::dvec3 extent = glm::max(bounds.Max - bounds.Min, glm::dvec3(1e-30));
    const double volume = extent.x * extent.y * extent.z;
    const double edge = std::max(SmallestEdge * voxel, std::cbrt(volume / NumberOfBoxes));
    for (int a = 0; a < 3; ++a)
    {
      const double count = std::ceil(extent[a] / edge - 1e-9);
      this->Count[a] = static_cast<int>(std::clamp(count, 1.0, double{ MostAlongAxis }));
    }
    this->Edge = extent / glm::dvec3(this->Count);
  }

  double At(int a, int i) const { return this->First[a] + i * this->Edge[a]; }
};

/// Bounds of the volume at rest, data coordinates.
Box FindBounds(const VolumeView& volume)
{
  const glm::dvec3 low = volume.LowerIndex();
  const glm::dvec3 high = volume.UpperIndex();
  const glm::dvec3 middle = volume.FirstVoxel + volume.IndexToData * (0.5 * (low + high));
  const glm::dvec3 half = Absolute(volume.IndexToData) * (0.5 * (high - low));
  return { middle - half, middle + half };
}

/**
 * Finds where T takes the corners of the boxes, x fastest, and the largest distance along each axis
 * of what it takes points in between to from the hull of the corners. Returns false where the field
 * is constant along an axis outside of its cells, which its second differences do not tell.
 */
bool FindCorners(
  const RestBoxes& boxes, const BSplineField* field, Grid<glm::dvec3>& corners, glm::dvec3& bulge)
{
  bulge = glm::dvec3(0.0);
  if (field)
  {
    std::vector<std::array<double, 4>> weights[3];
    std::vector<int> cells[3];
    glm::ivec3 first(0);
    glm::ivec3 end(0);
    for (int a = 0; a < 3; ++a)
    {
      for (int i = 0; i <= boxes.Count[a]; ++i)
      {
        const double u = (boxes.At(a, i) - field->GetOrigin()[a]) / field->GetSpacing()[a];
        if (!(u >= field->GetFirstCell()[a] - 1e-9 && u <= field->GetEndCell()[a] + 1e-9))
        {
          return false;
        }
        const int cell = std::clamp(
          static_cast<int>(std::floor(u)), field->GetFirstCell()[a], field->GetEndCell()[a] - 1);
        std::array<double, 4> w;
        BSplineWeights(u - cell, w.data());
        weights[a].push_back(w);
        cells[a].push_back(cell);
      }
      first[a] = *std::min_element(cells[a].begin(), cells[a].end());
      end[a] = *std::max_element(cells[a].begin(), cells[a].end()) + 1;
      for (int& cell : cells[a])
      {
        cell -= first[a];
      }
    }
    Grid<glm::dvec3> nodes(end - first + 3);
    for (int k = 0; k < nodes.Size.z; ++k)
    {
      for (int j = 0; j < nodes.Size.y; ++j)
      {
        for (int i = 0; i < nodes.Size.x; ++i)
        {
          nodes.At(i, j, k) = field->Coefficient(first.x - 1 + i, first.y - 1 + j, first.z - 1 + k);
        }
      }
    }
    bulge = FindBulge(nodes, boxes.Edge / glm::abs(field->GetSpacing()));
    corners = std::move(nodes);
    for (int a = 0; a < 3; ++a)
    {
      corners = SumAlong(corners, a, weights[a], cells[a]);
    }
  }
  for (int k = 0; k < corners.Size.z; ++k)
  {
    for (int j = 0; j < corners.Size.y; ++j)
    {
      for (int i = 0; i < corners.Size.x; ++i)
      {
        corners.At(i, j, k) += glm::dvec3(boxes.At(0, i), boxes.At(1, j), boxes.At(2, k));
      }
    }
  }
  return true;
}

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
    !(map.IsIdentity() || map.GetKind() == PullBackKind::Exact))
  {
    return;
  }
  const VolumeView& volume = scene.Volume;
  const RestBoxes boxes(FindBounds(volume), scene.VoxelSize);
  Grid<glm::dvec3> corners(boxes.Count + 1);
  glm::dvec3 bulge;
  if (!FindCorners(boxes, map.IsIdentity() ? nullptr : map.GetField(), corners, bulge))
  {
    return;
  }
  const CameraView::PixelRows rows = scene.Camera.GetPixelRows();
  const glm::dvec3 halfIndex =
    Absolute(volume.DataToIndex) * (0.5 * boxes.Edge) + (tolerance + Guard);
  const glm::dvec3 around = bulge + (reach + Guard * scene.VoxelSize);
  const glm::dvec2 lastTile(tiles - 1);
  Grid<VisibleBox> visible(boxes.Count);
  const auto findRow = [&](int j, int k) {
    for (int i = 0; i < boxes.Count.x; ++i)
    {
      const glm::dvec3 middle =
        volume.ToIndex(boxes.First + (glm::dvec3(i, j, k) + 0.5) * boxes.Edge);
      if (scene.Distances->IsEmptyIn(
            middle - halfIndex, middle + halfIndex, volume.UpperIndex(), volume.Margin))
      {
        continue;
      }
      Box box{ corners.At(i, j, k), corners.At(i, j, k) };
      for (int corner = 1; corner < 8; ++corner)
      {
        const glm::dvec3& p =
          corners.At(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
        box.Min = glm::min(box.Min, p);
        box.Max = glm::max(box.Max, p);
      }
      box.Min -= around;
      box.Max += around;
      const PixelRange pixels = FindPixels(rows, box);
      VisibleBox& found = visible.At(i, j, k);
      found.FirstTile = glm::ivec2(glm::clamp(
        glm::floor((pixels.Low - 1.0) / double{ TileSide }), glm::dvec2(0.0), lastTile + 1.0));
      found.LastTile = glm::ivec2(glm::clamp(
        glm::floor((pixels.High + 1.0) / double{ TileSide }), glm::dvec2(-1.0), lastTile));
      found.Low = glm::vec3(box.Min - origin);
      found.High = glm::vec3(box.Max - origin);
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
