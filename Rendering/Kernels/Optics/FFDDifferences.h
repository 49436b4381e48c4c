// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDDifferences_h
#define FFDDifferences_h

#include "FFDAxisMap.h"
#include "FFDCellMask.h"
#include "FFDVolumeView.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>

namespace ffd
{

/// Whether one of the cells whose scalars are interpolated at a voxel coordinate is hidden.
inline bool TouchesHidden(const VolumeView& v, const CellMask& hidden, const glm::dvec3& voxel)
{
  const glm::ivec3 lower(glm::floor(voxel));
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::ivec3 cell = lower + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
    if (hidden.Has(glm::clamp(cell, glm::ivec3(0), v.Dimensions - 1)))
    {
      return true;
    }
  }
  return false;
}

/**
 * Shortens the difference [before, after] along an axis, where voxels are points, to the cell of
 * `inside`, which is shown, and its neighbors as far as these are shown, too.
 */
inline void KeepShown(
  const CellMask& hidden, const glm::dvec3& inside, int axis, double& before, double& after)
{
  // A position on the upper face of a cell is one of the next cell: values are taken just below it.
  constexpr double Below = 1e-9;
  const glm::ivec3 last = hidden.GetCells() - 1;
  glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(inside)), glm::ivec3(0), last);
  const int first = cell[axis];
  while (++cell[axis] <= std::min(static_cast<int>(after), last[axis]))
  {
    if (hidden.Has(cell))
    {
      after = cell[axis] - Below;
      break;
    }
  }
  cell[axis] = first;
  while (--cell[axis] >= static_cast<int>(before))
  {
    if (hidden.Has(cell))
    {
      before = cell[axis] + 1;
      break;
    }
  }
}

/**
 * Finds the gradient of a field, by index coordinates, at a voxel coordinate, from differences over
 * one voxel to each side. At the faces of the volume they are over less, so that the gradient of a
 * linear field is exact everywhere. `nearest`: the gradient of the nearest voxel, as that of
 * vtkGPUVolumeRayCastMapper, whose textures are not interpolated then either.
 *
 * Hidden cells do not count: differences end at them. Where voxels are cells themselves, the
 * gradient beside hidden ones is that of the nearest cell.
 *
 * `field(position, nearest)`: the value at a voxel coordinate, or of the nearest voxel.
 */
template <class Field>
glm::dvec3 FindDifferences(const VolumeView& v, const glm::dvec3& voxel, bool nearest,
  const CellMask* hidden, const Field& field)
{
  const glm::dvec3 last(v.Dimensions - 1);
  const glm::dvec3 inside = glm::clamp(voxel, glm::dvec3(0.0), last);
  const glm::dvec3 closest = glm::min(glm::floor(inside + 0.5), last);
  glm::dvec3 gradient(0.0);
  for (int a = 0; a < 3; ++a)
  {
    bool snap = nearest;
    glm::dvec3 low = nearest ? closest : inside;
    glm::dvec3 high = low;
    const auto part = [&](double at) {
      low[a] = std::max(at - 1.0, 0.0);
      high[a] = std::min(at + 1.0, last[a]);
    };
    part(low[a]);
    if (hidden && v.Margin > 0.0)
    {
      snap = snap || TouchesHidden(v, *hidden, inside) || TouchesHidden(v, *hidden, low) ||
        TouchesHidden(v, *hidden, high);
      if (snap)
      {
        low = closest;
        high = closest;
        part(closest[a]);
        low[a] = hidden->Has(glm::ivec3(low)) ? closest[a] : low[a];
        high[a] = hidden->Has(glm::ivec3(high)) ? closest[a] : high[a];
      }
    }
    else if (hidden)
    {
      KeepShown(*hidden, inside, a, low[a], high[a]);
    }
    if (high[a] > low[a])
    {
      const double width =
        v.Axes ? v.Axes->ToIndex(a, high[a]) - v.Axes->ToIndex(a, low[a]) : high[a] - low[a];
      gradient[a] = (field(high, snap) - field(low, snap)) / width;
    }
  }
  return gradient;
}

} // namespace ffd

#endif
