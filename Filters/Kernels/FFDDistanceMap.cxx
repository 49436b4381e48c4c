// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDistanceMap.h"

#include <glm/common.hpp>

#include <algorithm>
#include <limits>

namespace ffd
{
namespace
{

constexpr int LargestDistance = 255;

/**
 * One axis of the Chebyshev distance transform: out[i] = min over j of max(|i - j|, in[j]). The
 * three axes one after the other give the transform in space. The search from each point stops at
 * the distance found so far, so it is short wherever the volume is not empty.
 */
void TransformLine(std::uint8_t* line, int count, std::size_t stride, std::vector<int>& work)
{
  work.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
  {
    work[i] = line[i * stride];
  }
  for (int i = 0; i < count; ++i)
  {
    // Only neighbours closer than the value found so far can lower it.
    int best = work[i];
    for (int gap = 1; gap < best; ++gap)
    {
      if (i - gap >= 0)
      {
        best = std::min(best, std::max(gap, work[i - gap]));
      }
      if (i + gap < count)
      {
        best = std::min(best, std::max(gap, work[i + gap]));
      }
      if (i - gap < 0 && i + gap >= count)
      {
        break;
      }
    }
    line[i * stride] = static_cast<std::uint8_t>(best);
  }
}

} // namespace

//------------------------------------------------------------------------------
DistanceMap::DistanceMap(const MinMaxBlocks& blocks, const TransferTable& table)
  : Blocks(blocks.GetBlocks())
{
  const std::size_t count = blocks.GetNumberOfBlocks();
  this->Distances.resize(count + 3);
  for (std::size_t i = 0; i < count; ++i)
  {
    const MinMaxBlocks::Limits limits = blocks.GetLimits(i);
    this->Distances[i] = table.IsTransparent(limits.Min, limits.Max) ? LargestDistance : 0;
  }

  std::vector<int> work;
  const std::size_t nx = this->Blocks.x;
  const std::size_t nxy = nx * this->Blocks.y;
  for (int k = 0; k < this->Blocks.z; ++k)
  {
    for (int j = 0; j < this->Blocks.y; ++j)
    {
      TransformLine(&this->Distances[k * nxy + j * nx], this->Blocks.x, 1, work);
    }
  }
  for (int k = 0; k < this->Blocks.z; ++k)
  {
    for (int i = 0; i < this->Blocks.x; ++i)
    {
      TransformLine(&this->Distances[k * nxy + i], this->Blocks.y, nx, work);
    }
  }
  for (int j = 0; j < this->Blocks.y; ++j)
  {
    for (int i = 0; i < this->Blocks.x; ++i)
    {
      TransformLine(&this->Distances[j * nx + i], this->Blocks.z, nxy, work);
    }
  }
}

//------------------------------------------------------------------------------
bool DistanceMap::FindEmptyBox(
  const glm::dvec3& q, const glm::dvec3& upper, EmptyBox& box) const
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  int side = -1;
  double farthest = 0.0;
  bool above = false;
  for (int a = 0; a < 3; ++a)
  {
    const double below = -q[a];
    const double beyond = q[a] - upper[a];
    if (below > farthest)
    {
      farthest = below;
      side = a;
      above = false;
    }
    if (beyond > farthest)
    {
      farthest = beyond;
      side = a;
      above = true;
    }
  }
  if (side >= 0)
  {
    box.Min = glm::dvec3(-Infinity);
    box.Max = glm::dvec3(Infinity);
    (above ? box.Min : box.Max)[side] = above ? upper[side] : 0.0;
    return true;
  }
  if (!(q.x >= 0.0 && q.y >= 0.0 && q.z >= 0.0))
  {
    // Not a number: nothing is known.
    return false;
  }
  const glm::ivec3 block =
    glm::min(glm::ivec3(q) / MinMaxBlocks::BlockSize, this->Blocks - 1);
  const int distance = this->GetDistance(block);
  if (distance == 0)
  {
    return false;
  }
  box.Min = glm::dvec3((block - (distance - 1)) * MinMaxBlocks::BlockSize);
  box.Max = glm::dvec3((block + distance) * MinMaxBlocks::BlockSize);
  return true;
}

} // namespace ffd
