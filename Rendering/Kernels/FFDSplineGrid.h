// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSplineGrid_h
#define FFDSplineGrid_h

#include "FFDGridIndex.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace ffd
{

/// Values on a grid, x fastest.
template <class T>
struct Grid
{
  glm::ivec3 Size{ 0 };
  std::vector<T> Values;
  explicit Grid(const glm::ivec3& size)
    : Size(size)
    , Values(GridSize(size))
  {
  }
  T& At(int i, int j, int k) { return this->Values[GridIndex(i, j, k, this->Size)]; }
  const T& At(int i, int j, int k) const { return const_cast<Grid*>(this)->At(i, j, k); }
};

/// Sums of 4 neighbors along one axis: entry i of the result is the sum over n of
/// weights[i][n] times entry offsets[i] + n.
template <class T>
Grid<T> SumAlong(const Grid<T>& from, int axis, const std::vector<std::array<double, 4>>& weights,
  const std::vector<int>& offsets)
{
  glm::ivec3 size = from.Size;
  size[axis] = static_cast<int>(weights.size());
  Grid<T> to(size);
  // Entries before and after the axis in the order of the grid.
  std::size_t inner = 1;
  for (int a = 0; a < axis; ++a)
  {
    inner *= static_cast<std::size_t>(size[a]);
  }
  const std::size_t length = static_cast<std::size_t>(from.Size[axis]);
  const std::size_t outer = from.Values.size() / (inner * length);
  T* target = to.Values.data();
  for (std::size_t o = 0; o < outer; ++o)
  {
    for (std::size_t i = 0; i < weights.size(); ++i, target += inner)
    {
      const T* source =
        from.Values.data() + (o * length + static_cast<std::size_t>(offsets[i])) * inner;
      const std::array<double, 4> w = weights[i];
      for (std::size_t n = 0; n < inner; ++n)
      {
        target[n] = w[0] * source[n] + w[1] * source[n + inner] + w[2] * source[n + 2 * inner] +
          w[3] * source[n + 3 * inner];
      }
    }
  }
  return to;
}

/// Differences of neighbors along an axis.
inline Grid<glm::dvec3> FindDifferences(const Grid<glm::dvec3>& nodes, int axis)
{
  glm::ivec3 next(0);
  next[axis] = 1;
  Grid<glm::dvec3> differences(nodes.Size - next);
  for (int k = 0; k < differences.Size.z; ++k)
  {
    for (int j = 0; j < differences.Size.y; ++j)
    {
      for (int i = 0; i < differences.Size.x; ++i)
      {
        differences.At(i, j, k) = nodes.At(i + next.x, j + next.y, k + next.z) - nodes.At(i, j, k);
      }
    }
  }
  return differences;
}

/// The largest absolute value of each axis.
inline glm::dvec3 FindLargest(const Grid<glm::dvec3>& values)
{
  glm::dvec3 largest(0.0);
  for (const glm::dvec3& value : values.Values)
  {
    largest = glm::max(largest, glm::abs(value));
  }
  return largest;
}

/// The largest difference of a cubic B-spline from what is interpolated linearly, axis by axis,
/// between points `step` cells apart. `nodes`: the coefficients.
inline glm::dvec3 FindBulge(const Grid<glm::dvec3>& nodes, const glm::dvec3& step)
{
  glm::dvec3 bulge(0.0);
  for (int a = 0; a < 3; ++a)
  {
    bulge += FindLargest(FindDifferences(FindDifferences(nodes, a), a)) * (step[a] * step[a] / 8.0);
  }
  return bulge;
}

} // namespace ffd

#endif
