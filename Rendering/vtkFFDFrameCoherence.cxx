// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameCoherence.h"

#include "FFDDistanceMap.h"
#include "FFDMatrixBounds.h"
#include "FFDRayCaster.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace
{

constexpr int TileSize = ffd::RayCaster::TileSize;

/// Size of the parts of the lattice that are told apart, voxels.
constexpr double Resolution = 8.0;

/// Pixels of a tile; 0 where tiles do not lie on whole pixels.
int FindTilePixels(double step)
{
  const double pixels = TileSize * step;
  return pixels == std::floor(pixels) ? static_cast<int>(pixels) : 0;
}

bool IsSame(const ffd::Blending& a, const ffd::Blending& b)
{
  // The rest depends on what Sources tells of.
  return a.Mode == b.Mode &&
    std::equal(a.IsoValues.begin(), a.IsoValues.end(), b.IsoValues.begin(), b.IsoValues.end(),
      [](const ffd::IsoValue& x, const ffd::IsoValue& y) {
        return x.Value == y.Value && x.Colour == y.Colour && x.Opacity == y.Opacity;
      });
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDFrameCoherence::vtkFFDFrameCoherence()
  : Quarters(ffd::RayCaster::QuarterSize)
{
}

//------------------------------------------------------------------------------
void vtkFFDFrameCoherence::Clear()
{
  if (!this->Quarters.IsEmpty())
  {
    this->Quarters.Clear();
    this->LastField.reset();
    std::vector<float>().swap(this->LastDepths);
  }
}

//------------------------------------------------------------------------------
std::size_t vtkFFDFrameCoherence::GetMemorySize() const
{
  return this->Quarters.GetMemorySize() +
    (this->LastField ? this->LastField->GetCoefficients().size() * sizeof(glm::dvec3) : 0);
}

//------------------------------------------------------------------------------
void vtkFFDFrameCoherence::Align(vtkFFDImageRegion& region) const
{
  const glm::ivec2 size(glm::ceil(glm::dvec2(region.Rays) * region.Step));
  glm::ivec2 end = glm::min(region.Origin + size, region.Viewport);
  if (const int tile = FindTilePixels(region.Step))
  {
    region.Origin -= region.Origin % tile;
    end = glm::min((end + (tile - 1)) / tile * tile, region.Viewport);
    region.Rays = glm::ivec2(glm::ceil(glm::dvec2(end - region.Origin) / region.Step));
    return;
  }
  const vtkFFDImageRegion& last = this->LastRegion;
  const glm::ivec2 lastEnd(glm::dvec2(last.Origin) + glm::dvec2(last.Rays) * last.Step);
  if (!this->Quarters.IsEmpty() && region.Viewport == last.Viewport && region.Step == last.Step &&
    glm::all(glm::lessThanEqual(last.Origin, region.Origin)) &&
    glm::all(glm::greaterThanEqual(lastEnd, end)))
  {
    region = last;
  }
}

//------------------------------------------------------------------------------
/// Whether nothing but control points has changed, and how many tiles the picture has moved by.
bool vtkFFDFrameCoherence::Continues(const Sources& sources, const ffd::CastScene& scene,
  const vtkFFDImageRegion& region, glm::ivec2& shift) const
{
  const vtkFFDImageRegion& last = this->LastRegion;
  if (this->Quarters.IsEmpty() || !(sources == this->LastSources) ||
    region.Viewport != last.Viewport || region.Step != last.Step || !this->LastWasOneToOne ||
    !IsSame(scene.Blend, this->LastBlend) ||
    scene.Camera.DataToNdc != this->LastCamera.DataToNdc ||
    scene.Camera.Eye != this->LastCamera.Eye ||
    scene.Camera.Parallel != this->LastCamera.Parallel ||
    scene.Material.TwoSided != this->LastMaterial.TwoSided ||
    !(scene.Material.Lights == this->LastMaterial.Lights))
  {
    return false;
  }
  const glm::ivec2 moved = region.Origin - last.Origin;
  shift = glm::ivec2(0);
  if (moved == glm::ivec2(0))
  {
    return true;
  }
  const int tile = FindTilePixels(region.Step);
  if (tile == 0 || moved % tile != glm::ivec2(0))
  {
    return false;
  }
  shift = moved / tile;
  return true;
}

//------------------------------------------------------------------------------
std::vector<vtkFFDFrameCoherence::Part> vtkFFDFrameCoherence::Begin(const Sources& sources,
  const ffd::CastScene& scene, const vtkFFDImageRegion& region, const ffd::Box& restBounds,
  double tolerance, std::vector<float>& colours, std::vector<float>& firstVisible)
{
  const ffd::PullBack& map = *scene.Map;
  const bool inverts = ffd::InvertsTheField(map.GetKind());
  const ffd::Box deformed{ glm::min(scene.DeformedBounds.Min, this->LastDeformedBounds.Min),
    glm::max(scene.DeformedBounds.Max, this->LastDeformedBounds.Max) };
  const ffd::PullBack last(this->LastField.get(), this->LastKind, map.GetTolerance());
  // What is leaped over is not seen.
  const auto isEmpty = [&scene](const ffd::Box& rest) {
    const ffd::VolumeView& volume = scene.Volume;
    const glm::dvec3 middle = volume.ToIndex(0.5 * (rest.Min + rest.Max));
    const glm::dvec3 half = ffd::Absolute(volume.DataToIndex) * (0.5 * (rest.Max - rest.Min));
    return scene.Distances->IsEmptyIn(
      middle - half, middle + half, volume.UpperIndex(), volume.Margin);
  };
  ffd::PullBackChange change;
  glm::ivec2 shift(0);
  // A frame that follows no edit is a picture of its own: nothing stays inexact.
  if (this->Continues(sources, scene, region, shift) &&
    ffd::FindChange(last, map, scene.Limits, inverts ? restBounds : deformed,
      Resolution * scene.VoxelSize, scene.Distances ? isEmpty : ffd::IsEmptyAtRest(), change) &&
    !change.IsEmpty())
  {
    // Tiles are two quarters wide.
    this->Quarters.Continue(region.Rays, 2 * shift, colours, this->LastDepths, &firstVisible);
    this->Quarters.NoteDepths(
      this->LastDepths.empty() ? nullptr : this->LastDepths.data(), scene.Depths, scene.Camera);
    this->Quarters.NoteChange(change, scene.Camera, tolerance);
  }
  else
  {
    this->Quarters.Start(region.Rays);
  }
  const std::size_t rays =
    static_cast<std::size_t>(region.Rays.x) * static_cast<std::size_t>(region.Rays.y);
  colours.resize(4 * rays);
  if (!firstVisible.empty())
  {
    firstVisible.resize(rays);
  }
  this->LastSources = sources;
  this->LastRegion = region;
  this->LastCamera = scene.Camera;
  this->LastMaterial = scene.Material;
  this->LastBlend = scene.Blend;
  this->LastDeformedBounds = scene.DeformedBounds;
  this->LastField = std::make_unique<ffd::BSplineField>(*map.GetField());
  this->LastKind = map.GetKind();
  this->LastWasOneToOne = !inverts || scene.Limits.OneToOne;
  this->LastDepths.clear();
  if (scene.Depths)
  {
    this->LastDepths.assign(scene.Depths, scene.Depths + rays);
  }
  return this->TakePartsToCast(region.Rays);
}

//------------------------------------------------------------------------------
std::vector<vtkFFDFrameCoherence::Part> vtkFFDFrameCoherence::TakePartsToCast(
  const glm::ivec2& rays)
{
  constexpr int size = ffd::RayCaster::QuarterSize;
  const int quartersPerRow = (rays.x + size - 1) / size;
  const int tilesPerRow = (rays.x + TileSize - 1) / TileSize;
  const int rows = (rays.y + TileSize - 1) / TileSize;
  std::vector<unsigned int> quarters(
    static_cast<std::size_t>(tilesPerRow) * static_cast<std::size_t>(rows));
  for (int at : this->Quarters.TakeTilesToCast())
  {
    const int x = at % quartersPerRow;
    const int y = at / quartersPerRow;
    quarters[static_cast<std::size_t>(y / 2 * tilesPerRow + x / 2)] |= 1u << (x % 2 + 2 * (y % 2));
  }
  std::vector<Part> parts;
  for (std::size_t tile = 0; tile < quarters.size(); ++tile)
  {
    if (quarters[tile] != 0)
    {
      parts.push_back({ static_cast<int>(tile), quarters[tile] });
    }
  }
  return parts;
}
