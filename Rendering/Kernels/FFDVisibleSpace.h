// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDVisibleSpace_h
#define FFDVisibleSpace_h

#include "Bounds/FFDBox.h"
#include "FFDCastScene.h"
#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace ffd
{

/// Deformed space, cut into equal cells, with a bit for each.
class FFD_RENDERING_EXPORT SpaceCells
{
public:
  /// Cells along each axis.
  static constexpr int Cells = 64;

  /// Single precision, relative to an origin.
  struct LocalBox
  {
    glm::vec3 Low;
    glm::vec3 High;
  };

  /// Marks the cells that boxes are in.
  explicit SpaceCells(const std::vector<LocalBox>& boxes);

  /// Whether any cell that a box is in is marked.
  bool Meets(const float low[3], const float high[3]) const;

  std::size_t GetMemorySize() const { return this->Rows.capacity() * sizeof(std::uint64_t); }

  float GetLow(int a) const { return this->Low[a]; }
  float GetCellsPerLength(int a) const { return this->PerCell[a]; }
  /// Numbers of cells from GetLow() on.
  bool IsMarked(int i, int j, int k) const
  {
    return (this->Rows[static_cast<std::size_t>(k * Cells + j)] >> i & 1) != 0;
  }

private:
  /// Cells of a box; none if First > Last for any axis.
  struct Range
  {
    int First[3];
    int Last[3];
  };

  Range Find(const float low[3], const float high[3]) const;
  /// The bits of a range in a row.
  static std::uint64_t FindMask(const Range& range);
  void Include(const LocalBox& box);

  float Low[3] = {};
  float PerCell[3] = {};           ///< cells by length
  std::vector<std::uint64_t> Rows; ///< a bit for each cell along x, from the lowest on; y fastest
};

/// What VisibleSpace follows from, apart from the distance map.
struct FFD_RENDERING_EXPORT SpaceSettings
{
  double Orientation = 0.0; ///< see VisibleSpace, as the next ones
  double Tolerance = 0.0;
  double Reach = 0.0;
  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 FirstVoxel{ 0.0 }; ///< see VolumeView, as the next one
  glm::dmat3 IndexToData{ 1.0 };
  std::uint64_t Field = 0; ///< FieldCache::GetNumber()

  bool operator==(const SpaceSettings& other) const;
};

/**
 * The last VisibleSpace of a distance map, kept from frame to frame. Nothing is kept beside a small
 * volume, of which it would be a large part. Threads may share a cache.
 */
class FFD_RENDERING_EXPORT SpaceCache
{
public:
  /// Blocks of a volume of which nothing is kept: cells are no more than a sixtieth of another one.
  static constexpr std::size_t FewBlocks = 30000;

  /// By how many boxes cells are found. Those of many take longer, and fewer rays are followed.
  enum class Boxes
  {
    Few,
    Many
  };

  struct Kept
  {
    std::shared_ptr<const SpaceCells> Cells;
    Boxes By = Boxes::Few;
  };

  /// The last cells, if they follow from these settings; else null.
  Kept Find(const SpaceSettings& settings) const;
  void Keep(const SpaceSettings& settings, const Kept& kept);

  std::size_t GetMemorySize() const;

private:
  mutable std::mutex Mutex;
  SpaceSettings Settings;
  Kept Last;
};

/**
 * Where something may be visible, whatever T^-1 is there. It is found as TileBounds are, by taking
 * boxes of the volume forward, of which there are more here; what T turns over is not shown. Where
 * T folds or nearly does, T^-1 is the most work, and most of it is done where there is nothing.
 */
class FFD_RENDERING_EXPORT VisibleSpace : public SpaceCells
{
public:
  /// Of a scene whose pull-back is T^-1, and which has a distance map. `orientation`: the sign of
  /// the Jacobian determinant of T at rest points that are shown, 1 or -1; 0 where T is not known
  /// to fold. `tolerance`: largest distance of samples from the pull-back, voxels. `reach`: kept
  /// around what may be visible, data units. `origin`: that of the boxes of Meets(), data
  /// coordinates. `by`: more boxes leave out more.
  VisibleSpace(const CastScene& scene, double orientation, double tolerance, double reach,
    const glm::dvec3& origin, SpaceCache::Boxes by = SpaceCache::Boxes::Few);
};

/**
 * Where T takes the volume, or the whole that it is a part of, seen or not. Elsewhere there is
 * nothing to follow along a ray from sample to sample. Which branch of T^-1 is found behind such a
 * gap must depend neither on what is visible nor on other threads: so it is made before the first
 * sample that is pulled back by itself.
 */
class FFD_RENDERING_EXPORT VolumeSpace
{
public:
  /// Keeps references to the scene and its pull-back, which is T^-1. `restBounds`: of the whole,
  /// data coordinates. `reach`, `origin`: as of VisibleSpace.
  VolumeSpace(
    const CastScene& scene, const Box& restBounds, double reach, const glm::dvec3& origin);

  /// The cells, made by the first thread that asks for them.
  const SpaceCells& Get();

private:
  const CastScene& Scene;
  Box RestBounds;
  double Reach;
  glm::dvec3 Origin;
  std::once_flag Once;
  std::optional<SpaceCells> Cells;
};

/**
 * Makes the VisibleSpace of a scene where inverses turn out to be more work than that. If it is
 * kept of a frame before, that is taken at once, and much work makes it anew, by more boxes: what
 * is kept once may well be asked for again. Usable by any threads.
 */
class FFD_RENDERING_EXPORT VisibleSpaceOnDemand
{
public:
  /// As VisibleSpace(); keeps a reference to `scene`.
  VisibleSpaceOnDemand(const CastScene& scene, double orientation, double tolerance, double reach,
    const glm::dvec3& origin);

  /// What there is, or null. It may change, what it was remains.
  const SpaceCells* Find() const { return this->Made.load(std::memory_order_acquire); }

  /// Makes it, whatever is kept, before any thread has noted work: all frames have the same one.
  void Make();

  /// Notes evaluations of T, many of which make it.
  void NoteWork(std::int64_t evaluations);

private:
  std::shared_ptr<const SpaceCells> MakeBy(SpaceCache::Boxes boxes) const;

  const CastScene& Scene;
  SpaceSettings Settings;
  SpaceCache::Kept Before; ///< of a frame before
  std::atomic<std::int64_t> Evaluations{ 0 };
  std::atomic<bool> Begun{ false };
  std::shared_ptr<const SpaceCells> Cells;
  std::atomic<const SpaceCells*> Made{ nullptr };
};

} // namespace ffd

#endif
