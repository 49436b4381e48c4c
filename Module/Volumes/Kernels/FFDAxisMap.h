// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDAxisMap_h
#define FFDAxisMap_h

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace ffd
{

/**
 * The positions of the voxels of a rectilinear grid in the index coordinates of its VolumeView,
 * which are those of a grid of the same size and bounds with equal steps. Positions along rays are
 * in these index coordinates, since they are linear in space; only when a voxel is asked for are
 * they looked up.
 */
class AxisMap
{
public:
  AxisMap() = default;

  /**
   * `positions`: index coordinates along each axis, strictly rising, two or more, that stand for
   * the voxel coordinates first, first + step, ... Between them the map is linear. For points these
   * are the points themselves (first 0, step 1), for cells their faces and centers in turn (first
   * -1/2, step 1/2).
   */
  AxisMap(std::vector<double> positions[3], double first, double step)
    : First(first)
    , Step(step)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->Positions[a] = std::move(positions[a]);
    }
  }

  /// Voxel coordinate (whole numbers at voxels) of an index coordinate; clamped to the grid.
  double ToVoxel(int axis, double index) const
  {
    const std::vector<double>& p = this->Positions[axis];
    if (!(index > p.front()))
    {
      return this->First;
    }
    if (index >= p.back())
    {
      return this->First + this->Step * static_cast<double>(p.size() - 1);
    }
    const std::size_t i =
      static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), index) - p.begin()) - 1;
    return this->First + this->Step * (static_cast<double>(i) + (index - p[i]) / (p[i + 1] - p[i]));
  }
  glm::dvec3 ToVoxel(const glm::dvec3& index) const
  {
    return { this->ToVoxel(0, index.x), this->ToVoxel(1, index.y), this->ToVoxel(2, index.z) };
  }

  /// Index coordinate of a voxel coordinate; clamped to the grid.
  double ToIndex(int axis, double voxel) const
  {
    const std::vector<double>& p = this->Positions[axis];
    const double last = static_cast<double>(p.size() - 1);
    const double at = std::min(std::max(0.0, (voxel - this->First) / this->Step), last);
    const std::size_t i = std::min(static_cast<std::size_t>(at), p.size() - 2);
    return p[i] + (at - static_cast<double>(i)) * (p[i + 1] - p[i]);
  }

  /// Whether no position is farther than `tolerance` from where equal steps have it.
  bool IsEven(double tolerance) const
  {
    for (const std::vector<double>& p : this->Positions)
    {
      for (std::size_t i = 0; i < p.size(); ++i)
      {
        const double even = this->First + this->Step * static_cast<double>(i);
        if (!(std::abs(p[i] - even) <= tolerance))
        {
          return false;
        }
      }
    }
    return true;
  }

  /// The positions that stand for the voxel coordinates GetFirst(), GetFirst() + GetStep(), ...
  const std::vector<double>& GetPositions(int axis) const { return this->Positions[axis]; }
  double GetFirst() const { return this->First; }
  double GetStep() const { return this->Step; }

private:
  std::vector<double> Positions[3];
  double First = 0.0;
  double Step = 1.0;
};

} // namespace ffd

#endif
