// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDVisibleSpace.h"

#include "FFDBoxImages.h"
#include "FFDBoxOrientation.h"
#include "FFDFieldCache.h"
#include "FFDPullBack.h"

#include <glm/common.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace ffd
{
namespace
{

/// About so many boxes in all, and no smaller than so many voxels.
constexpr double NumberOfVisibleBoxes = 32768.0;
constexpr double NumberOfVolumeBoxes = 4096.0;
constexpr double SmallestEdge = 4.0;

/// So many evaluations, each lane counted, take longer than all of the boxes; where T folds they
/// are the first of many.
constexpr std::int64_t ManyEvaluations = 250000;
constexpr std::int64_t ManyEvaluationsOfFolds = 25000;

/// Calls visit(index) for every `step`-th index of each axis from `first` on, before `end`.
template <class Visit>
void ForIndices(const glm::ivec3& first, const glm::ivec3& end, int step, const Visit& visit)
{
  for (int k = first.z; k < end.z; k += step)
  {
    for (int j = first.y; j < end.y; j += step)
    {
      for (int i = first.x; i < end.x; i += step)
      {
        visit(glm::ivec3(i, j, k));
      }
    }
  }
}

/// A box in data coordinates with something around it, data units; `origin`: of the result.
SpaceCells::LocalBox ToLocal(const Box& box, double around, const glm::dvec3& origin)
{
  return { glm::vec3(box.Min - around - origin), glm::vec3(box.Max + around - origin) };
}

/// Kept around images, data units.
double FindMargin(const CastScene& scene, double reach)
{
  return reach + BoxGuard * scene.VoxelSize;
}

/// The images of the boxes in which something may be visible.
std::vector<SpaceCells::LocalBox> FindVisibleImages(const CastScene& scene, double orientation,
  double tolerance, double reach, const glm::dvec3& origin)
{
  const BoxGrid boxes(
    FindBoundsAtRest(scene.Volume), NumberOfVisibleBoxes, SmallestEdge * scene.VoxelSize);
  const auto images = FindBoxImages(scene, boxes, 1.0);
  const auto isEmpty = [&](
                         const Box& box) { return ShowsNothing(scene, box, tolerance + BoxGuard); };
  std::optional<BoxOrientation> orientations;
  if (orientation != 0.0 && scene.Map->GetField())
  {
    const BSplineField& field = *scene.Map->GetField();
    const ThirdDerivatives third = scene.KeptOfField
      ? scene.KeptOfField->FindThirdDerivatives(field)
      : BoundThirdDerivatives(field);
    orientations.emplace(*images, field, third, orientation);
  }
  const auto areHidden = [&](const glm::ivec3& first, const glm::ivec3& end) {
    return isEmpty({ boxes.Get(first).Min, boxes.Get(end - 1).Max }) ||
      (orientations && orientations->AreTurnedOver(first, end));
  };
  const double around = FindMargin(scene, reach);
  std::vector<SpaceCells::LocalBox> found;
  // Eight neighbors are mostly empty, or turned over, together.
  ForIndices(glm::ivec3(0), boxes.Count, 2, [&](const glm::ivec3& first) {
    const glm::ivec3 end = glm::min(first + 2, boxes.Count);
    if (areHidden(first, end))
    {
      return;
    }
    ForIndices(first, end, 1, [&](const glm::ivec3& index) {
      if (!areHidden(index, index + 1))
      {
        found.push_back(ToLocal(images->Find(index), around, origin));
      }
    });
  });
  return found;
}

/// The images of all boxes of the whole volume.
std::vector<SpaceCells::LocalBox> FindVolumeImages(
  const CastScene& scene, const Box& restBounds, double reach, const glm::dvec3& origin)
{
  const BoxGrid boxes(restBounds, NumberOfVolumeBoxes, SmallestEdge * scene.VoxelSize);
  const auto images = FindBoxImages(scene, boxes, 1.0);
  const double around = FindMargin(scene, reach);
  std::vector<SpaceCells::LocalBox> found;
  ForIndices(glm::ivec3(0), boxes.Count, 1, [&](const glm::ivec3& index) {
    found.push_back(ToLocal(images->Find(index), around, origin));
  });
  return found;
}

/// Whether cells of a scene can be kept: all that they follow from is known by its value.
bool HasCache(const CastScene& scene)
{
  return scene.KeptOfSpace && scene.KeptOfField && !scene.Volume.Axes;
}

/// Of the whole volume.
SpaceSettings MakeSettings(
  const CastScene& scene, const Box& restBounds, double reach, const glm::dvec3& origin)
{
  SpaceSettings settings;
  settings.Reach = reach;
  settings.Origin = origin;
  settings.RestBounds = restBounds;
  settings.FirstVoxel = scene.Volume.FirstVoxel;
  settings.IndexToData = scene.Volume.IndexToData;
  settings.Field = scene.KeptOfField ? scene.KeptOfField->GetNumber() : 0;
  return settings;
}

/// The cells that are kept of a scene, or those of make(), which are kept from now on.
template <class Make>
std::shared_ptr<const SpaceCells> FindOrMake(
  const CastScene& scene, SpaceCache::Kinds kind, const SpaceSettings& settings, const Make& make)
{
  if (!HasCache(scene))
  {
    return make();
  }
  std::shared_ptr<const SpaceCells> cells = scene.KeptOfSpace->Find(kind, settings);
  if (!cells)
  {
    cells = make();
    scene.KeptOfSpace->Keep(kind, settings, cells);
  }
  return cells;
}

} // namespace

//------------------------------------------------------------------------------
SpaceCells::SpaceCells(const std::vector<LocalBox>& boxes)
  : Rows(std::size_t{ Cells } * Cells, 0)
{
  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high(-std::numeric_limits<float>::max());
  for (const LocalBox& box : boxes)
  {
    low = glm::min(low, box.Low);
    high = glm::max(high, box.High);
  }
  for (int a = 0; a < 3; ++a)
  {
    this->Low[a] = low[a];
    this->PerCell[a] = static_cast<float>(Cells) / std::max(high[a] - low[a], 1e-30f);
  }
  for (const LocalBox& box : boxes)
  {
    this->Include(box);
  }
}

//------------------------------------------------------------------------------
SpaceCells::Range SpaceCells::Find(const float low[3], const float high[3]) const
{
  Range range;
  for (int a = 0; a < 3; ++a)
  {
    const auto toCell = [this, a](float x) {
      // Limited first: it may be too large for a whole number.
      const float at = (x - this->Low[a]) * this->PerCell[a];
      return static_cast<int>(std::floor(std::clamp(at, -1.0f, static_cast<float>(Cells))));
    };
    range.First[a] = std::max(toCell(low[a]), 0);
    range.Last[a] = std::min(toCell(high[a]), Cells - 1);
  }
  return range;
}

//------------------------------------------------------------------------------
std::uint64_t SpaceCells::FindMask(const Range& range)
{
  constexpr std::uint64_t all = ~std::uint64_t{ 0 };
  const int first = range.First[0];
  const int last = range.Last[0];
  return first > last ? 0 : (all << first) & (all >> (Cells - 1 - last));
}

//------------------------------------------------------------------------------
void SpaceCells::Include(const LocalBox& box)
{
  const Range range = this->Find(glm::value_ptr(box.Low), glm::value_ptr(box.High));
  const std::uint64_t mask = FindMask(range);
  for (int k = range.First[2]; k <= range.Last[2]; ++k)
  {
    for (int j = range.First[1]; j <= range.Last[1]; ++j)
    {
      this->Rows[static_cast<std::size_t>(k * Cells + j)] |= mask;
    }
  }
}

//------------------------------------------------------------------------------
bool SpaceCells::Meets(const float low[3], const float high[3]) const
{
  const Range range = this->Find(low, high);
  const std::uint64_t mask = FindMask(range);
  for (int k = range.First[2]; k <= range.Last[2]; ++k)
  {
    for (int j = range.First[1]; j <= range.Last[1]; ++j)
    {
      if ((this->Rows[static_cast<std::size_t>(k * Cells + j)] & mask) != 0)
      {
        return true;
      }
    }
  }
  return false;
}

//------------------------------------------------------------------------------
VisibleSpace::VisibleSpace(const CastScene& scene, double orientation, double tolerance,
  double reach, const glm::dvec3& origin)
  : SpaceCells(FindVisibleImages(scene, orientation, tolerance, reach, origin))
{
}

//------------------------------------------------------------------------------
bool SpaceSettings::operator==(const SpaceSettings& other) const
{
  return this->Orientation == other.Orientation && this->Tolerance == other.Tolerance &&
    this->Reach == other.Reach && this->Origin == other.Origin &&
    this->RestBounds == other.RestBounds && this->FirstVoxel == other.FirstVoxel &&
    this->IndexToData == other.IndexToData && this->Field == other.Field;
}

//------------------------------------------------------------------------------
std::shared_ptr<const SpaceCells> SpaceCache::Find(Kinds kind, const SpaceSettings& settings) const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const Kept& last = this->Last[static_cast<std::size_t>(kind)];
  return last.Cells && last.Settings == settings ? last.Cells : nullptr;
}

//------------------------------------------------------------------------------
void SpaceCache::Keep(
  Kinds kind, const SpaceSettings& settings, const std::shared_ptr<const SpaceCells>& cells)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Last[static_cast<std::size_t>(kind)] = { settings, cells };
}

//------------------------------------------------------------------------------
std::size_t SpaceCache::GetMemorySize() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::size_t size = 0;
  for (const Kept& each : this->Last)
  {
    size += each.Cells ? each.Cells->GetMemorySize() : 0;
  }
  return size;
}

//------------------------------------------------------------------------------
VolumeSpace::VolumeSpace(
  const CastScene& scene, const Box& restBounds, double reach, const glm::dvec3& origin)
  : Scene(scene)
  , Settings(MakeSettings(scene, restBounds, reach, origin))
{
}

//------------------------------------------------------------------------------
const SpaceCells& VolumeSpace::Get()
{
  std::call_once(this->Once, [this] {
    const SpaceSettings& settings = this->Settings;
    this->Cells = FindOrMake(this->Scene, SpaceCache::Kinds::Whole, settings, [&] {
      return std::make_shared<const SpaceCells>(
        FindVolumeImages(this->Scene, settings.RestBounds, settings.Reach, settings.Origin));
    });
  });
  return *this->Cells;
}

//------------------------------------------------------------------------------
VisibleSpaceOnDemand::VisibleSpaceOnDemand(const CastScene& scene, double orientation,
  double tolerance, double reach, const glm::dvec3& origin)
  : Scene(scene)
  , Settings(MakeSettings(scene, FindBoundsAtRest(scene.Volume), reach, origin))
{
  this->Settings.Orientation = orientation;
  this->Settings.Tolerance = tolerance;
  if (HasCache(scene) && scene.KeptOfSpace->Find(SpaceCache::Kinds::Visible, this->Settings))
  {
    this->Make();
  }
}

//------------------------------------------------------------------------------
void VisibleSpaceOnDemand::Make()
{
  // Others go on without it meanwhile.
  if (!this->Begun.exchange(true))
  {
    const SpaceSettings& settings = this->Settings;
    this->Cells = FindOrMake(this->Scene, SpaceCache::Kinds::Visible, settings, [&] {
      return std::make_shared<const VisibleSpace>(
        this->Scene, settings.Orientation, settings.Tolerance, settings.Reach, settings.Origin);
    });
    this->Made.store(this->Cells.get(), std::memory_order_release);
  }
}

//------------------------------------------------------------------------------
void VisibleSpaceOnDemand::NoteWork(std::int64_t evaluations)
{
  const std::int64_t before = this->Evaluations.fetch_add(evaluations, std::memory_order_relaxed);
  if (before + evaluations >=
    (this->Settings.Orientation != 0.0 ? ManyEvaluationsOfFolds : ManyEvaluations))
  {
    this->Make();
  }
}

} // namespace ffd
