// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDVisibleSpace_h
#define FFDVisibleSpace_h

#include "FFDCastScene.h"
#include "FFDExport.h"

#include <glm/vec3.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace ffd
{

/**
 * Where something may be visible, whatever T^-1 is there: deformed space, cut into equal cells,
 * with a bit for each. It is found as TileBounds are, by taking boxes of the volume forward, of
 * which there are more here; what T turns over is not shown. Where T folds or nearly does, T^-1 is
 * the most work, and most of it is done where there is nothing.
 */
class FFD_RENDERING_EXPORT VisibleSpace
{
public:
  /// Of a scene whose pull-back is T^-1, and which has a distance map. `orientation`: the sign of
  /// the Jacobian determinant of T at rest points that are shown, 1 or -1; 0 where T is not known
  /// to fold. `tolerance`: largest distance of samples from the pull-back, voxels. `reach`: kept
  /// around what may be visible, data units. `origin`: that of the boxes of Meets(), data
  /// coordinates.
  VisibleSpace(const CastScene& scene, double orientation, double tolerance, double reach,
    const glm::dvec3& origin);

  /// Whether something may be visible in a box, relative to the origin.
  bool Meets(const float low[3], const float high[3]) const;

private:
  /// Cells along each axis.
  static constexpr int Cells = 64;

  /// Cells of a box; none if First > Last for any axis.
  struct Range
  {
    int First[3];
    int Last[3];
  };

  Range Find(const float low[3], const float high[3]) const;
  /// The bits of a range in a row.
  static std::uint64_t FindMask(const Range& range);
  void Include(const float low[3], const float high[3]);

  float Low[3] = {};
  float PerCell[3] = {};           ///< cells by length
  std::vector<std::uint64_t> Rows; ///< a bit for each cell along x, from the lowest on; y fastest
};

/// Makes the VisibleSpace of a scene where inverses turn out to be more work than that. Usable by
/// any threads.
class FFD_RENDERING_EXPORT VisibleSpaceOnDemand
{
public:
  /// As VisibleSpace(); keeps a reference to `scene`.
  VisibleSpaceOnDemand(const CastScene& scene, double orientation, double tolerance, double reach,
    const glm::dvec3& origin);

  /// What has been made, or null.
  const VisibleSpace* Find() const { return this->Made.load(std::memory_order_acquire); }

  /// Makes it, unless that has been begun.
  void Make();

  /// Notes evaluations of T; many of them in all call Make().
  void NoteWork(std::int64_t evaluations);

private:
  const CastScene& Scene;
  double Orientation;
  double Tolerance;
  double Reach;
  glm::dvec3 Origin;
  std::atomic<std::int64_t> Evaluations{ 0 };
  std::atomic<bool> Begun{ false };
  std::unique_ptr<const VisibleSpace> Space;
  std::atomic<const VisibleSpace*> Made{ nullptr };
};

} // namespace ffd

#endif
