// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTileHistory.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace ffd
{

namespace
{

/// Pixels of one picture in the next one; `channels` floats each.
void Rearrange(const glm::ivec2& from, const glm::ivec2& to, const glm::ivec2& shift, int channels,
  std::vector<float>& values)
{
  std::vector<float> moved(static_cast<std::size_t>(channels) * static_cast<std::size_t>(to.x) *
    static_cast<std::size_t>(to.y));
  const glm::ivec2 first = glm::max(glm::ivec2(0), -shift);
  const glm::ivec2 end = glm::min(to, from - shift);
  for (int y = first.y; y < end.y && first.x < end.x; ++y)
  {
    const std::size_t source = static_cast<std::size_t>(y + shift.y) * from.x + first.x + shift.x;
    const std::size_t target = static_cast<std::size_t>(y) * to.x + first.x;
    std::copy_n(values.data() + static_cast<std::size_t>(channels) * source,
      static_cast<std::size_t>(channels) * (end.x - first.x),
      moved.data() + static_cast<std::size_t>(channels) * target);
  }
  values.swap(moved);
}

/// The largest length of (x . d, y . d) for any d of unit length.
double FindLargestStretch(const glm::dvec3& x, const glm::dvec3& y)
{
  const double xx = glm::dot(x, x);
  const double yy = glm::dot(y, y);
  return std::sqrt(0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), glm::dot(x, y)));
}

} // namespace

/**
 * Projects the corners of parts, and then the parts: their places in the image and distances from
 * the near plane. Rays begin there, so a point beyond it by d is at d at least along a ray.
 */
class TileHistory::Projection
{
public:
  Projection(const PullBackChange& change, const CameraView& camera)
  {
    const CameraView::PixelRows rows = camera.GetPixelRows();
    glm::dvec4 nearPlane = rows.W + glm::row(camera.DataToNdc, 2);
    nearPlane /= glm::length(glm::dvec3(nearPlane));
    const glm::dvec3 ofDepth(rows.W);
    // A motion by d of what is seen at (x, y) at a depth moves it in the image by ((X - x W) . d,
    // (Y - y W) . d) / depth, to first order.
    const auto stretchAt = [&](double x, double y) {
      return FindLargestStretch(glm::dvec3(rows.X) - x * ofDepth, glm::dvec3(rows.Y) - y * ofDepth);
    };
    const double nearDepth = glm::dot(rows.W, glm::dvec4(camera.ToData({ 0.0, 0.0, -1.0 }), 1.0));
    double most = 0.0;
    for (double x : { 0.0, static_cast<double>(camera.ImageSize.x) })
    {
      for (double y : { 0.0, static_cast<double>(camera.ImageSize.y) })
      {
        most = std::max(most, stretchAt(x, y) / nearDepth);
      }
    }
    this->MostPixels = static_cast<float>(most);
    this->DepthPerLength = static_cast<float>(glm::length(ofDepth));

    // The largest extent along a row of a margin to all sides.
    const auto marginAlong = [&change](const glm::dvec3& row) {
      return glm::dot(glm::abs(row), change.Margin);
    };
    const double depthMargin = marginAlong(glm::dvec3(rows.W));
    const double nearMargin = marginAlong(glm::dvec3(nearPlane));
    const std::size_t count = change.Corners.size();
    for (std::vector<float>* values : { &this->LowX, &this->HighX, &this->LowY, &this->HighY,
           &this->Nearest, &this->Depth, &this->Stretch })
    {
      values->resize(count);
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      const glm::dvec3 p = change.Corners[i];
      const auto along = [&p](const glm::dvec4& row) {
        return row.x * p.x + row.y * p.y + row.z * p.z + row.w;
      };
      const double depth = along(rows.W);
      // Moved by d the corner is at (X . (p + d)) / (depth + W . d), which differs from where
      // it is by ((X - x W) . d) / (depth + W . d). A part moves with its corners.
      const auto project = [&](const glm::dvec4& row, float& low, float& high) {
        const double at = along(row) / depth;
        const double margin = marginAlong(glm::dvec3(row) - at * ofDepth) / (depth - depthMargin);
        low = static_cast<float>(at - margin);
        high = static_cast<float>(at + margin);
        return at;
      };
      const double x = project(rows.X, this->LowX[i], this->HighX[i]);
      const double y = project(rows.Y, this->LowY[i], this->HighY[i]);
      this->Nearest[i] = static_cast<float>(along(nearPlane) - nearMargin);
      this->Depth[i] = static_cast<float>(depth - depthMargin);
      this->Stretch[i] = static_cast<float>(stretchAt(x, y));
    }
    // The least and the largest of neighboring corners, axis by axis.
    glm::ivec3 size = change.Parts + 1;
    for (int axis = 2; axis >= 0; --axis)
    {
      const auto reduce = [&](std::vector<float>& values, const auto& choose) {
        Reduce(values, size, axis, choose);
      };
      const auto least = [](float a, float b) { return std::min(a, b); };
      const auto largest = [](float a, float b) { return std::max(a, b); };
      reduce(this->LowX, least);
      reduce(this->LowY, least);
      reduce(this->Nearest, least);
      reduce(this->Depth, least);
      reduce(this->HighX, largest);
      reduce(this->HighY, largest);
      reduce(this->Stretch, largest);
      --size[axis];
    }
  }

  /// Bounds how far something moves in the image that moves by a length, in pixels. `visible`:
  /// whether all of the part lies behind the near plane.
  float FindMotion(std::size_t part, float length, bool visible) const
  {
    const float depth = this->Depth[part] - length * this->DepthPerLength;
    return length * (visible && depth > 0.0f ? this->Stretch[part] / depth : this->MostPixels);
  }

  // Limits of each part with its margin.
  std::vector<float> LowX;
  std::vector<float> HighX;
  std::vector<float> LowY;
  std::vector<float> HighY;
  std::vector<float> Nearest;
  std::vector<float> Depth;   ///< by which FindMotion() divides
  std::vector<float> Stretch; ///< pixels by length, times Depth

private:
  template <class Choose>
  static void Reduce(
    std::vector<float>& values, const glm::ivec3& size, int axis, const Choose& choose)
  {
    std::size_t inner = 1;
    for (int a = 0; a < axis; ++a)
    {
      inner *= static_cast<std::size_t>(size[a]);
    }
    const std::size_t length = static_cast<std::size_t>(size[axis]);
    const std::size_t outer = values.size() / (inner * length);
    const std::size_t row = (length - 1) * inner;
    std::vector<float> chosen(outer * row);
    for (std::size_t o = 0; o < outer; ++o)
    {
      const float* from = values.data() + o * length * inner;
      float* to = chosen.data() + o * row;
      for (std::size_t i = 0; i < row; ++i)
      {
        to[i] = choose(from[i], from[i + inner]);
      }
    }
    values.swap(chosen);
  }

  float MostPixels;     ///< by length, anywhere in the image
  float DepthPerLength; ///< the most that Depth changes by
};

//------------------------------------------------------------------------------
void TileHistory::Clear()
{
  this->Size = glm::ivec2(0);
  this->Count = glm::ivec2(0);
  std::vector<Tile>().swap(this->Tiles);
  std::vector<float>().swap(this->Reaches);
}

//------------------------------------------------------------------------------
void TileHistory::Start(const glm::ivec2& size)
{
  this->Size = size;
  this->Count = this->FindTiles(size);
  const std::size_t count =
    static_cast<std::size_t>(this->Count.x) * static_cast<std::size_t>(this->Count.y);
  this->Tiles.assign(count, Tile());
  this->Reaches.assign(count, std::numeric_limits<float>::infinity());
}

//------------------------------------------------------------------------------
void TileHistory::Continue(const glm::ivec2& size, const glm::ivec2& shift,
  std::vector<float>& colors, std::vector<float>& depths, std::vector<float>* firstVisible)
{
  if (size == this->Size && shift == glm::ivec2(0))
  {
    return;
  }
  const TileHistory last = *this;
  this->Start(size);
  for (int y = 0; y < this->Count.y; ++y)
  {
    for (int x = 0; x < this->Count.x; ++x)
    {
      const glm::ivec2 tile(x, y);
      const glm::ivec2 old = tile + shift;
      // Tiles at the border may have been smaller.
      const glm::ivec2 pixels = glm::min(size - tile * this->TileSize, glm::ivec2(this->TileSize));
      const glm::ivec2 had = glm::min(last.Size - old * this->TileSize, glm::ivec2(this->TileSize));
      if (old.x >= 0 && old.y >= 0 && old.x < last.Count.x && old.y < last.Count.y && pixels == had)
      {
        const std::size_t to = static_cast<std::size_t>(y) * this->Count.x + x;
        const std::size_t from = static_cast<std::size_t>(old.y) * last.Count.x + old.x;
        this->Tiles[to] = last.Tiles[from];
        this->Reaches[to] = last.Reaches[from];
      }
    }
  }
  Rearrange(last.Size, size, shift * this->TileSize, 4, colors);
  if (!depths.empty())
  {
    Rearrange(last.Size, size, shift * this->TileSize, 1, depths);
  }
  if (firstVisible && !firstVisible->empty())
  {
    Rearrange(last.Size, size, shift * this->TileSize, 1, *firstVisible);
  }
}

//------------------------------------------------------------------------------
void TileHistory::RecordChange(
  const PullBackChange& change, const CameraView& camera, double tolerance)
{
  const Projection parts(change, camera);
  for (std::size_t part = 0; part < change.Moved.size(); ++part)
  {
    if (change.Moved[part] > 0.0)
    {
      this->RecordPart(parts, part, change.Moved[part]);
    }
  }
  for (Tile& tile : this->Tiles)
  {
    tile.Moved += tile.MovedNow;
    tile.MovedNow = 0.0f;
    tile.Holds = tile.Holds && tile.Moved <= static_cast<float>(tolerance);
  }
}

//------------------------------------------------------------------------------
/// Records that the content of a part has moved.
void TileHistory::RecordPart(const Projection& parts, std::size_t part, double moved)
{
  const glm::vec2 most(this->Size);
  glm::vec2 low(0.0f);
  glm::vec2 high(most - 1.0f);
  const float distance = parts.Nearest[part] - static_cast<float>(moved);
  // Before the near plane the projection means nothing. Written so that NaN is that, too.
  const bool visible = distance > 0.0f && std::isfinite(parts.LowX[part] + parts.HighX[part]) &&
    std::isfinite(parts.LowY[part] + parts.HighY[part]);
  const float by = parts.FindMotion(part, static_cast<float>(moved), visible);
  if (visible)
  {
    // The content of the part was there before the edit or is there now; it looks larger to the
    // sides of the picture. Rays go through the middles of pixels; half a pixel more for what is
    // rounded.
    const float around = 2.0f * by;
    low = glm::clamp(glm::ceil(glm::vec2(parts.LowX[part], parts.LowY[part]) - around - 1.0f),
      glm::vec2(0.0f), most);
    high = glm::clamp(
      glm::vec2(parts.HighX[part], parts.HighY[part]) + around, glm::vec2(-1.0f), most - 1.0f);
  }
  const glm::ivec2 first(low);
  const glm::ivec2 last(glm::floor(high));
  for (int y = first.y / this->TileSize; y * this->TileSize <= last.y && y < this->Count.y; ++y)
  {
    for (int x = first.x / this->TileSize; x * this->TileSize <= last.x && x < this->Count.x; ++x)
    {
      const std::size_t at = static_cast<std::size_t>(y) * this->Count.x + x;
      if (!(distance > this->Reaches[at]))
      {
        this->Tiles[at].MovedNow = std::max(this->Tiles[at].MovedNow, by);
      }
    }
  }
}

//------------------------------------------------------------------------------
void TileHistory::RecordDepths(const float* before, const float* now, const CameraView& camera)
{
  if (!before && !now)
  {
    return;
  }
  const std::vector<float> nothing(static_cast<std::size_t>(this->TileSize), 1.0f);
  for (int y = 0; y < this->Size.y; ++y)
  {
    const std::size_t row = static_cast<std::size_t>(y) * this->Size.x;
    const std::size_t bytes = sizeof(float) * static_cast<std::size_t>(this->Size.x);
    if (before && now && std::memcmp(before + row, now + row, bytes) == 0)
    {
      continue;
    }
    std::size_t tile = static_cast<std::size_t>(y / this->TileSize) * this->Count.x;
    for (int x0 = 0; x0 < this->Size.x; x0 += this->TileSize, ++tile)
    {
      const int width = std::min(this->TileSize, this->Size.x - x0);
      const float* was = before ? before + row + x0 : nothing.data();
      const float* is = now ? now + row + x0 : nothing.data();
      if (!this->Tiles[tile].Holds || std::equal(was, was + width, is))
      {
        continue;
      }
      for (int i = 0; i < width; ++i)
      {
        const double x = x0 + i + 0.5;
        const ViewRay ray = camera.MakeRay(x, y + 0.5);
        this->Tiles[tile].Holds = this->Tiles[tile].Holds &&
          (was[i] == is[i] ||
            camera.DepthToT(ray, x, y + 0.5, std::min(was[i], is[i])) > this->Reaches[tile]);
      }
    }
  }
}

//------------------------------------------------------------------------------
void TileHistory::RecordOtherDepths(const float* before, const float* now, int groupSize)
{
  if (!before && !now)
  {
    return;
  }
  const int side = groupSize * this->TileSize;
  const std::vector<float> nothing(static_cast<std::size_t>(side), 1.0f);
  const auto isSame = [&](const glm::ivec2& first, const glm::ivec2& end) {
    for (int y = first.y; y < end.y; ++y)
    {
      const std::size_t at = static_cast<std::size_t>(y) * this->Size.x + first.x;
      const float* was = before ? before + at : nothing.data();
      const float* is = now ? now + at : nothing.data();
      if (!std::equal(was, was + (end.x - first.x), is))
      {
        return false;
      }
    }
    return true;
  };
  for (int y = 0; y < this->Size.y; y += side)
  {
    for (int x = 0; x < this->Size.x; x += side)
    {
      const glm::ivec2 first(x, y);
      const glm::ivec2 end = glm::min(first + side, this->Size);
      if (isSame(first, end))
      {
        continue;
      }
      const glm::ivec2 firstTile = first / this->TileSize;
      const glm::ivec2 endTile = this->FindTiles(end);
      for (int row = firstTile.y; row < endTile.y; ++row)
      {
        for (int column = firstTile.x; column < endTile.x; ++column)
        {
          this->Tiles[static_cast<std::size_t>(row) * this->Count.x + column].Holds = false;
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
std::vector<int> TileHistory::CollectTilesToCast()
{
  std::vector<int> tiles;
  for (std::size_t i = 0; i < this->Tiles.size(); ++i)
  {
    if (!this->Tiles[i].Holds)
    {
      tiles.push_back(static_cast<int>(i));
      this->Tiles[i] = Tile();
      this->Tiles[i].Holds = true;
      this->Reaches[i] = std::numeric_limits<float>::infinity();
    }
  }
  return tiles;
}

} // namespace ffd
