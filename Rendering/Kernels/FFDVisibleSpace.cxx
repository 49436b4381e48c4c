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
struct BoxSize
{
  double Number;
  double SmallestEdge;
};
constexpr BoxSize FewVisibleBoxes{ 32768.0, 4.0 };
constexpr BoxSize ManyVisibleBoxes{ 131072.0, 2.0 };
constexpr BoxSize VolumeBoxes{ 4096.0, 4.0 };

/// So many evaluations, each lane counted, take longer than all of the boxes; where T folds they
/// are the first of many.
constexpr std::int64_t ManyEvaluations = 250000;
constexpr std::int64_t ManyEvaluationsOfFolds = 25000;
constexpr std::int64_t WorkOfManyBoxes = 4;

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

/// Cuts a box at rest.
BoxGrid Cut(const CastScene& scene, const Box& restBounds, const BoxSize& size)
{
  return BoxGrid(restBounds, size.Number, size.SmallestEdge * scene.VoxelSize);
}

/// The images of the boxes in which something may be visible.
std::vector<SpaceCells::LocalBox> FindVisibleImages(const CastScene& scene, double orientation,
  double tolerance, double reach, const glm::dvec3& origin, SpaceCache::Boxes by)
{
  const BoxGrid boxes = Cut(scene, FindBoundsAtRest(scene.Volume),
    by == SpaceCache::Boxes::Few ? FewVisibleBoxes : ManyVisibleBoxes);
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
  const BoxGrid boxes = Cut(scene, restBounds, VolumeBoxes);
  const auto images = FindBoxImages(scene, boxes, 1.0);
  const double around = FindMargin(scene, reach);
  std::vector<SpaceCells::LocalBox> found;
  ForIndices(glm::ivec3(0), boxes.Count, 1, [&](const glm::ivec3& index) {
    found.push_back(ToLocal(images->Find(index), around, origin));
  });
  return found;
}

/// Whether the cells of a scene can be kept: all that they follow from is known by its value.
bool HasCache(const CastScene& scene)
{
  return scene.KeptOfSpace && scene.KeptOfField && !scene.Volume.Axes;
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
bool SpaceSettings::operator==(const SpaceSettings& other) const
{
  return this->Orientation == other.Orientation && this->Tolerance == other.Tolerance &&
    this->Reach == other.Reach && this->Origin == other.Origin &&
    this->FirstVoxel == other.FirstVoxel && this->IndexToData == other.IndexToData &&
    this->Field == other.Field;
}

//------------------------------------------------------------------------------
SpaceCache::Kept SpaceCache::Find(const SpaceSettings& settings) const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Settings == settings ? this->Last : Kept();
}

//------------------------------------------------------------------------------
void SpaceCache::Keep(const SpaceSettings& settings, const Kept& kept)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Settings = settings;
  this->Last = kept;
}

//------------------------------------------------------------------------------
std::size_t SpaceCache::GetMemorySize() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Last.Cells ? this->Last.Cells->GetMemorySize() : 0;
}

//------------------------------------------------------------------------------
VisibleSpace::VisibleSpace(const CastScene& scene, double orientation, double tolerance,
  double reach, const glm::dvec3& origin, SpaceCache::Boxes by)
  : SpaceCells(FindVisibleImages(scene, orientation, tolerance, reach, origin, by))
{
}

//------------------------------------------------------------------------------
VolumeSpace::VolumeSpace(
  const CastScene& scene, const Box& restBounds, double reach, const glm::dvec3& origin)
  : Scene(scene)
  , RestBounds(restBounds)
  , Reach(reach)
  , Origin(origin)
{
}

//------------------------------------------------------------------------------
const SpaceCells& VolumeSpace::Get()
{
  std::call_once(this->Once, [this] {
    this->Cells.emplace(FindVolumeImages(this->Scene, this->RestBounds, this->Reach, this->Origin));
  });
  return *this->Cells;
}

//------------------------------------------------------------------------------
VisibleSpaceOnDemand::VisibleSpaceOnDemand(const CastScene& scene, double orientation,
  double tolerance, double reach, const glm::dvec3& origin)
  : Scene(scene)
{
  this->Settings = { orientation, tolerance, reach, origin, scene.Volume.FirstVoxel,
    scene.Volume.IndexToData, scene.KeptOfField ? scene.KeptOfField->GetNumber() : 0 };
  if (HasCache(scene))
  {
    this->Before = scene.KeptOfSpace->Find(this->Settings);
    this->Begun = this->Before.By == SpaceCache::Boxes::Many;
    this->Made = this->Before.Cells.get();
  }
}

//------------------------------------------------------------------------------
std::shared_ptr<const SpaceCells> VisibleSpaceOnDemand::MakeBy(SpaceCache::Boxes boxes) const
{
  const SpaceSettings& settings = this->Settings;
  return std::make_shared<const VisibleSpace>(
    this->Scene, settings.Orientation, settings.Tolerance, settings.Reach, settings.Origin, boxes);
}

//------------------------------------------------------------------------------
void VisibleSpaceOnDemand::Make()
{
  this->Begun = true;
  this->Cells = this->MakeBy(SpaceCache::Boxes::Few);
  this->Made = this->Cells.get();
}

//------------------------------------------------------------------------------
void VisibleSpaceOnDemand::NoteWork(std::int64_t evaluations)
{
  if (this->Begun.load(std::memory_order_relaxed))
  {
    return;
  }
  const std::int64_t most =
    (this->Settings.Orientation != 0.0 ? ManyEvaluationsOfFolds : ManyEvaluations) *
    (this->Before.Cells ? WorkOfManyBoxes : 1);
  const std::int64_t before = this->Evaluations.fetch_add(evaluations, std::memory_order_relaxed);
  // Others go on with what there is meanwhile.
  if (before + evaluations >= most && !this->Begun.exchange(true))
  {
    const SpaceCache::Boxes by =
      this->Before.Cells ? SpaceCache::Boxes::Many : SpaceCache::Boxes::Few;
    this->Cells = this->MakeBy(by);
    if (HasCache(this->Scene))
    {
      this->Scene.KeptOfSpace->Keep(this->Settings, { this->Cells, by });
    }
    this->Made.store(this->Cells.get(), std::memory_order_release);
  }
}

} // namespace ffd
