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

/// Equal boxes, aligned with the axes of data coordinates.
struct BoxGrid
{
  glm::dvec3 First; ///< lowest corner
  glm::dvec3 Edge;
  glm::ivec3 Count;

  BoxGrid(const Box& bounds, double voxel)
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

  Box Get(const glm::ivec3& index) const
  {
    const glm::dvec3 low = this->First + glm::dvec3(index) * this->Edge;
    return { low, low + this->Edge };
  }
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

/// Bounds of what x + sign * D(x) makes of boxes.
class BoxImages
{
public:
  /// `field`: D, null for zero.
  BoxImages(const BoxGrid& boxes, const BSplineField* field, double sign)
    : Boxes(boxes)
    , Corners(boxes.Count + 1)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->IsInCells[a].assign(static_cast<std::size_t>(boxes.Count[a]), true);
    }
    if (field)
    {
      this->FindDisplacements(*field, sign);
    }
  }

  /// The hull of the images of the corners, and of what D is in between. Outside of the cells,
  /// where D is constant along an axis, its second differences do not tell how it bends at their
  /// end: there it is any of those of the corners anywhere in the box.
  Box Find(const glm::ivec3& index) const
  {
    bool inCells = true;
    for (int a = 0; a < 3; ++a)
    {
      inCells = inCells && this->IsInCells[a][static_cast<std::size_t>(index[a])];
    }
    const Box box = this->Boxes.Get(index);
    Box image{ glm::dvec3(std::numeric_limits<double>::max()),
      glm::dvec3(std::numeric_limits<double>::lowest()) };
    for (int corner = 0; corner < 8; ++corner)
    {
      const glm::ivec3 upper(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::ivec3 at = index + upper;
      const glm::dvec3& d = this->Corners.At(at.x, at.y, at.z);
      const glm::dvec3 p = glm::mix(box.Min, box.Max, glm::dvec3(upper));
      image.Min = glm::min(image.Min, d + (inCells ? p : box.Min));
      image.Max = glm::max(image.Max, d + (inCells ? p : box.Max));
    }
    return { image.Min - this->Bulge, image.Max + this->Bulge };
  }

private:
  void FindDisplacements(const BSplineField& field, double sign)
  {
    std::vector<std::array<double, 4>> weights[3];
    std::vector<int> cells[3];
    glm::ivec3 first(0);
    glm::ivec3 end(0);
    for (int a = 0; a < 3; ++a)
    {
      const double firstCell = field.GetFirstCell()[a];
      const double endCell = field.GetEndCell()[a];
      for (int i = 0; i <= this->Boxes.Count[a]; ++i)
      {
        const double u = (this->Boxes.At(a, i) - field.GetOrigin()[a]) / field.GetSpacing()[a];
        if (!(u >= firstCell - 1e-9 && u <= endCell + 1e-9))
        {
          for (int side = std::max(i - 1, 0); side < std::min(i + 1, this->Boxes.Count[a]); ++side)
          {
            this->IsInCells[a][static_cast<std::size_t>(side)] = false;
          }
        }
        const double inside = std::clamp(u, firstCell, endCell);
        const int cell = std::clamp(
          static_cast<int>(std::floor(inside)), field.GetFirstCell()[a], field.GetEndCell()[a] - 1);
        std::array<double, 4> w;
        BSplineWeights(inside - cell, w.data());
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
          nodes.At(i, j, k) =
            sign * field.Coefficient(first.x - 1 + i, first.y - 1 + j, first.z - 1 + k);
        }
      }
    }
    this->Bulge = FindBulge(nodes, this->Boxes.Edge / glm::abs(field.GetSpacing()));
    this->Corners = std::move(nodes);
    for (int a = 0; a < 3; ++a)
    {
      this->Corners = SumAlong(this->Corners, a, weights[a], cells[a]);
    }
  }

  const BoxGrid& Boxes;
  Grid<glm::dvec3> Corners;       ///< displacements of the corners of boxes
  glm::dvec3 Bulge{ 0.0 };        ///< largest distance of D from what it is at corners interpolated
  std::vector<bool> IsInCells[3]; ///< by the box along each axis
};

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
  const BoxGrid boxes(isForward ? FindBounds(volume) : scene.DeformedBounds, scene.VoxelSize);
  const BoxImages images(boxes, map.IsIdentity() ? nullptr : map.GetField(),
    map.GetKind() == PullBackKind::FirstOrder ? -1.0 : 1.0);
  const CameraView::PixelRows rows = scene.Camera.GetPixelRows();
  const double around = reach + Guard * scene.VoxelSize;
  const glm::dvec2 lastTile(tiles - 1);
  Grid<VisibleBox> visible(boxes.Count);
  const auto findRow = [&](int j, int k) {
    for (int i = 0; i < boxes.Count.x; ++i)
    {
      const Box box = boxes.Get({ i, j, k });
      const Box rest = isForward ? box : images.Find({ i, j, k });
      const glm::dvec3 middle = volume.ToIndex(0.5 * (rest.Min + rest.Max));
      const glm::dvec3 half =
        Absolute(volume.DataToIndex) * (0.5 * (rest.Max - rest.Min)) + (tolerance + Guard);
      if (scene.Distances->IsEmptyIn(
            middle - half, middle + half, volume.UpperIndex(), volume.Margin))
      {
        continue;
      }
      Box deformed = isForward ? images.Find({ i, j, k }) : box;
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
