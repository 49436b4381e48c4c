// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameCoherence.h"

#include "FFDBoxImages.h"
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

} // namespace

namespace ffd
{

//------------------------------------------------------------------------------
bool FixedView::operator==(const FixedView& other) const
{
  return this->DataToNdc == other.DataToNdc && this->Eye == other.Eye &&
    this->Parallel == other.Parallel && this->Viewport == other.Viewport &&
    this->Step == other.Step;
}

//------------------------------------------------------------------------------
bool FixedLight::operator==(const FixedLight& other) const
{
  return this->Lights == other.Lights && this->TwoSided == other.TwoSided;
}

//------------------------------------------------------------------------------
bool FixedBlend::operator==(const FixedBlend& other) const
{
  return this->Mode == other.Mode &&
    std::equal(this->IsoValues.begin(), this->IsoValues.end(), other.IsoValues.begin(),
      other.IsoValues.end(), [](const IsoValue& a, const IsoValue& b) {
        return a.Value == b.Value && a.Color == b.Color && a.Opacity == b.Opacity;
      });
}

//------------------------------------------------------------------------------
Made MakeFixedScene(FixedScene&, StageTools&, std::uint64_t, std::uint64_t, std::uint64_t,
  const Source<vtkVolumeProperty>&, const glm::dmat4&, bool, bool, const FixedView&,
  const FixedLight&, const FixedBlend&)
{
  return Made::Anew;
}

} // namespace ffd

//------------------------------------------------------------------------------
vtkFFDFrameCoherence::vtkFFDFrameCoherence()
  : Subtiles(ffd::RayCaster::SubtileSize)
{
}

//------------------------------------------------------------------------------
void vtkFFDFrameCoherence::Clear()
{
  if (!this->Subtiles.IsEmpty())
  {
    this->Subtiles.Clear();
    this->LastField.reset();
    std::vector<float>().swap(this->LastDepths);
  }
}

//------------------------------------------------------------------------------
std::size_t vtkFFDFrameCoherence::GetMemorySize() const
{
  // The control points of LastField are those of the deformation, which counts them.
  return this->Subtiles.GetMemorySize();
}

//------------------------------------------------------------------------------
void vtkFFDFrameCoherence::Align(vtkFFDImageRegion& region) const
{
  const glm::ivec2 size(glm::ceil(glm::dvec2(region.Rays) * region.Step));
  glm::ivec2 end = glm::min(region.Origin + size, region.Viewport);
  if (const int tile = FindTilePixels(region.Step))
  {
    region.Origin -= region.Origin % (ffd::RayCaster::GroupSize / TileSize * tile);
    end = glm::min((end + (tile - 1)) / tile * tile, region.Viewport);
    region.Rays = glm::ivec2(glm::ceil(glm::dvec2(end - region.Origin) / region.Step));
    return;
  }
  const vtkFFDImageRegion& last = this->LastRegion;
  const glm::ivec2 lastEnd(glm::dvec2(last.Origin) + glm::dvec2(last.Rays) * last.Step);
  if (!this->Subtiles.IsEmpty() && region.Viewport == last.Viewport && region.Step == last.Step &&
    glm::all(glm::lessThanEqual(last.Origin, region.Origin)) &&
    glm::all(glm::greaterThanEqual(lastEnd, end)))
  {
    region = last;
  }
}

//------------------------------------------------------------------------------
/// Whether nothing but control points and the place of the region has changed; notes the scene.
bool vtkFFDFrameCoherence::IsSameScene(
  const Sources& sources, const ffd::CastScene& scene, const vtkFFDImageRegion& region)
{
  const std::int64_t last = this->Scene.GetNumberOfBuilds();
  ffd::StageTools tools;
  this->Order.Begin();
  this->Scene.Update(tools, sources.Settings, sources.Voxels, sources.Functions, sources.Property,
    sources.DataToWorld, sources.Interactive, sources.Still,
    { scene.Camera.DataToNdc, scene.Camera.Eye, scene.Camera.Parallel, region.Viewport,
      region.Step },
    { scene.Material.Lights, scene.Material.TwoSided },
    { scene.Blend.Mode, scene.Blend.IsoValues });
  return this->Scene.GetNumberOfBuilds() == last;
}

//------------------------------------------------------------------------------
/// Finds the number of tiles that the picture has moved by; false if that is no whole number.
bool vtkFFDFrameCoherence::FindShift(const vtkFFDImageRegion& region, glm::ivec2& shift) const
{
  const glm::ivec2 moved = region.Origin - this->LastRegion.Origin;
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
/// Go on from the last picture, whose scene was the same, after an edit. False where that cannot
/// be.
bool vtkFFDFrameCoherence::FollowEdit(const ffd::CastScene& scene, const vtkFFDImageRegion& region,
  const ffd::Box& restBounds, double tolerance, std::vector<float>& colors,
  std::vector<float>& firstVisible)
{
  const ffd::PullBack& map = *scene.Map;
  const bool inverts = ffd::InvertsTheField(map.GetKind());
  const ffd::Box deformed{ glm::min(scene.DeformedBounds.Min, this->LastDeformedBounds.Min),
    glm::max(scene.DeformedBounds.Max, this->LastDeformedBounds.Max) };
  const ffd::PullBack last(this->LastField.get(), this->LastKind, map.GetTolerance());
  // Nothing can be seen in space that rays leap over.
  const auto isEmpty = [&scene](
                         const ffd::Box& rest) { return ffd::ShowsNothing(scene, rest, 0.0); };
  ffd::PullBackChange change;
  glm::ivec2 shift(0);
  // A frame that follows no edit is a picture of its own: nothing stays inexact.
  if (!this->LastWasOneToOne || !this->FindShift(region, shift) ||
    !ffd::FindChange(last, map, scene.Limits, inverts ? restBounds : deformed,
      Resolution * scene.VoxelSize, scene.Distances ? isEmpty : ffd::IsEmptyAtRest(), change) ||
    change.IsEmpty())
  {
    return false;
  }
  // Tiles are two subtiles wide.
  this->Subtiles.Continue(region.Rays, 2 * shift, colors, this->LastDepths, &firstVisible);
  this->Subtiles.RecordDepths(
    this->LastDepths.empty() ? nullptr : this->LastDepths.data(), scene.Depths, scene.Camera);
  this->Subtiles.RecordChange(change, scene.Camera, tolerance);
  return true;
}

//------------------------------------------------------------------------------
/// Go on from the last still picture, if that was of the same scene and nothing has been edited.
bool vtkFFDFrameCoherence::FollowStill(const ffd::CastScene& scene, const vtkFFDImageRegion& region)
{
  const ffd::PullBack& map = *scene.Map;
  if (region.Origin != this->LastRegion.Origin || region.Rays != this->LastRegion.Rays ||
    map.GetKind() != this->LastKind || !(*map.GetField() == *this->LastField))
  {
    return false;
  }
  this->Subtiles.RecordOtherDepths(this->LastDepths.empty() ? nullptr : this->LastDepths.data(),
    scene.Depths, ffd::RayCaster::GroupSize / ffd::RayCaster::SubtileSize);
  return true;
}

//------------------------------------------------------------------------------
std::vector<vtkFFDFrameCoherence::Part> vtkFFDFrameCoherence::Begin(const Sources& sources,
  const ffd::CastScene& scene, const vtkFFDImageRegion& region, const ffd::Box& restBounds,
  double tolerance, std::vector<float>& colors, std::vector<float>& firstVisible)
{
  const bool same = this->IsSameScene(sources, scene, region) && !this->Subtiles.IsEmpty();
  if (!same ||
    !(sources.Still ? this->FollowStill(scene, region)
                    : this->FollowEdit(scene, region, restBounds, tolerance, colors, firstVisible)))
  {
    this->Subtiles.Start(region.Rays);
  }
  const std::size_t rays =
    static_cast<std::size_t>(region.Rays.x) * static_cast<std::size_t>(region.Rays.y);
  colors.resize(4 * rays);
  if (!firstVisible.empty())
  {
    firstVisible.resize(rays);
  }
  const ffd::PullBack& map = *scene.Map;
  this->LastRegion = region;
  this->LastDeformedBounds = scene.DeformedBounds;
  this->LastField = std::make_unique<ffd::BSplineField>(*map.GetField());
  this->LastKind = map.GetKind();
  this->LastWasOneToOne = !ffd::InvertsTheField(map.GetKind()) || scene.Limits.OneToOne;
  this->LastDepths.clear();
  if (scene.Depths)
  {
    this->LastDepths.assign(scene.Depths, scene.Depths + rays);
  }
  return this->CollectPartsToCast(region.Rays);
}

//------------------------------------------------------------------------------
std::vector<vtkFFDFrameCoherence::Part> vtkFFDFrameCoherence::CollectPartsToCast(
  const glm::ivec2& rays)
{
  constexpr int size = ffd::RayCaster::SubtileSize;
  const int subtilesPerRow = (rays.x + size - 1) / size;
  const int tilesPerRow = (rays.x + TileSize - 1) / TileSize;
  const int rows = (rays.y + TileSize - 1) / TileSize;
  std::vector<unsigned int> subtiles(
    static_cast<std::size_t>(tilesPerRow) * static_cast<std::size_t>(rows));
  for (int at : this->Subtiles.CollectTilesToCast())
  {
    const int x = at % subtilesPerRow;
    const int y = at / subtilesPerRow;
    subtiles[static_cast<std::size_t>(y / 2 * tilesPerRow + x / 2)] |= 1u << (x % 2 + 2 * (y % 2));
  }
  std::vector<Part> parts;
  for (std::size_t tile = 0; tile < subtiles.size(); ++tile)
  {
    if (subtiles[tile] != 0)
    {
      parts.push_back({ static_cast<int>(tile), subtiles[tile] });
    }
  }
  return parts;
}
