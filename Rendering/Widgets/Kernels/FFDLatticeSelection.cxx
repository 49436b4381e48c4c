// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeSelection.h"

#include "FFDGridIndex.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

glm::ivec3 IndicesOf(const glm::ivec3& nodes, std::size_t point)
{
  const int n = static_cast<int>(point);
  return { n % nodes.x, n / nodes.x % nodes.y, n / (nodes.x * nodes.y) };
}

/// Points that have a neighbor with set == value.
PointSet FindNeighbors(const glm::ivec3& nodes, const PointSet& set, unsigned char value)
{
  PointSet result(set.size(), 0);
  for (std::size_t point = 0; point < set.size(); ++point)
  {
    const glm::ivec3 at = IndicesOf(nodes, point);
    for (int a = 0; a < 3 && !result[point]; ++a)
    {
      for (int step = -1; step <= 1; step += 2)
      {
        glm::ivec3 other = at;
        other[a] += step;
        if (other[a] >= 0 && other[a] < nodes[a] && set[GridIndex(other, nodes)] == value)
        {
          result[point] = 1;
        }
      }
    }
  }
  return result;
}

} // namespace

//------------------------------------------------------------------------------
PointSet GrowSelection(const glm::ivec3& nodes, const PointSet& set)
{
  PointSet result = FindNeighbors(nodes, set, 1);
  for (std::size_t point = 0; point < set.size(); ++point)
  {
    result[point] = result[point] | set[point];
  }
  return result;
}

//------------------------------------------------------------------------------
PointSet ShrinkSelection(const glm::ivec3& nodes, const PointSet& set)
{
  PointSet result = FindNeighbors(nodes, set, 0);
  for (std::size_t point = 0; point < set.size(); ++point)
  {
    result[point] = set[point] && !result[point] ? 1 : 0;
  }
  return result;
}

//------------------------------------------------------------------------------
PointSet SelectRows(const glm::ivec3& nodes, const PointSet& set, int axis)
{
  PointSet result(set.size(), 0);
  for (std::size_t point = 0; point < set.size(); ++point)
  {
    if (set[point])
    {
      glm::ivec3 at = IndicesOf(nodes, point);
      for (at[axis] = 0; at[axis] < nodes[axis]; ++at[axis])
      {
        result[GridIndex(at, nodes)] = 1;
      }
    }
  }
  return result;
}

//------------------------------------------------------------------------------
PointSet SelectPlanes(const glm::ivec3& nodes, const PointSet& set, int axis)
{
  std::vector<bool> planes(static_cast<std::size_t>(nodes[axis]), false);
  for (std::size_t point = 0; point < set.size(); ++point)
  {
    if (set[point])
    {
      planes[static_cast<std::size_t>(IndicesOf(nodes, point)[axis])] = true;
    }
  }
  PointSet result(set.size(), 0);
  for (std::size_t point = 0; point < set.size(); ++point)
  {
    result[point] = planes[static_cast<std::size_t>(IndicesOf(nodes, point)[axis])] ? 1 : 0;
  }
  return result;
}

//------------------------------------------------------------------------------
PointSet BoundaryPoints(const glm::ivec3& nodes, int layers)
{
  PointSet result(GridSize(nodes), 0);
  for (std::size_t point = 0; point < result.size(); ++point)
  {
    const glm::ivec3 at = IndicesOf(nodes, point);
    for (int a = 0; a < 3; ++a)
    {
      if (at[a] < layers || at[a] >= nodes[a] - layers)
      {
        result[point] = 1;
      }
    }
  }
  return result;
}

//------------------------------------------------------------------------------
std::size_t MirrorPoint(const glm::ivec3& nodes, std::size_t point, int axis)
{
  glm::ivec3 at = IndicesOf(nodes, point);
  at[axis] = nodes[axis] - 1 - at[axis];
  return GridIndex(at, nodes);
}

//------------------------------------------------------------------------------
PointSet MirrorSelection(const glm::ivec3& nodes, const PointSet& set, const bool mirror[3])
{
  PointSet result = set;
  for (int a = 0; a < 3; ++a)
  {
    if (mirror[a])
    {
      const PointSet before = result;
      for (std::size_t point = 0; point < set.size(); ++point)
      {
        result[point] = before[point] | before[MirrorPoint(nodes, point, a)];
      }
    }
  }
  return result;
}

//------------------------------------------------------------------------------
void MirrorChanges(const glm::ivec3& nodes, std::vector<glm::dvec3>& changes, const bool mirror[3],
  std::size_t active)
{
  const glm::ivec3 middle = IndicesOf(nodes, active);
  for (int a = 0; a < 3; ++a)
  {
    if (!mirror[a])
    {
      continue;
    }
    const bool upper = 2 * middle[a] > nodes[a] - 1;
    for (std::size_t point = 0; point < changes.size(); ++point)
    {
      const int side = 2 * IndicesOf(nodes, point)[a] - (nodes[a] - 1);
      if (side == 0)
      {
        changes[point][a] = 0.0;
      }
      else if ((side > 0) != upper)
      {
        changes[point] = changes[MirrorPoint(nodes, point, a)];
        changes[point][a] = -changes[point][a];
      }
    }
  }
}

//------------------------------------------------------------------------------
double GetFalloff(Falloff falloff, double t)
{
  if (!(t < 1.0))
  {
    return 0.0;
  }
  if (t <= 0.0)
  {
    return 1.0;
  }
  switch (falloff)
  {
    case Falloff::Smooth:
      return 1.0 - t * t * (3.0 - 2.0 * t);
    case Falloff::Linear:
      return 1.0 - t;
    case Falloff::Sphere:
      return std::sqrt(1.0 - t * t);
    case Falloff::Sharp:
      return (1.0 - t) * (1.0 - t);
    case Falloff::Constant:
      break;
  }
  return 1.0;
}

//------------------------------------------------------------------------------
std::vector<double> SoftWeights(
  const std::vector<glm::dvec3>& positions, const PointSet& set, double radius, Falloff falloff)
{
  std::vector<double> weights(positions.size(), 0.0);
  std::vector<glm::dvec3> selected;
  for (std::size_t point = 0; point < positions.size(); ++point)
  {
    if (set[point])
    {
      weights[point] = 1.0;
      selected.push_back(positions[point]);
    }
  }
  if (!(radius > 0.0))
  {
    return weights;
  }
  for (std::size_t point = 0; point < positions.size(); ++point)
  {
    if (set[point])
    {
      continue;
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& other : selected)
    {
      const glm::dvec3 between = positions[point] - other;
      nearest = std::min(nearest, glm::dot(between, between));
    }
    if (nearest < radius * radius)
    {
      weights[point] = GetFalloff(falloff, std::sqrt(nearest) / radius);
    }
  }
  return weights;
}

} // namespace ffd
