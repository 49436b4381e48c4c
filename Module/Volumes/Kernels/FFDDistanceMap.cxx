// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDistanceMap.h"

#include "FFDGridIndex.h"
#include "FFDRowSteps.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

namespace ffd
{
namespace
{

static_assert(DistanceMap::NearCode == LargestBlockDistance + 1, "smaller codes are distances");

/// Rows of a plane in a search along the third axis.
constexpr int RowsAtOnce = 4;

/// Calls take(block, index) for the blocks of the parents from `first` on, before `end`; `index`:
/// of the block in the grid of blocks.
template <class Take>
void ForChildren(
  const glm::ivec3& first, const glm::ivec3& end, const glm::ivec3& blocks, const Take& take)
{
  const glm::ivec3 low = 2 * first;
  const glm::ivec3 high = glm::min(2 * end, blocks);
  for (int k = low.z; k < high.z; ++k)
  {
    for (int j = low.y; j < high.y; ++j)
    {
      std::size_t index = GridIndex(low.x, j, k, blocks);
      for (int i = low.x; i < high.x; ++i, ++index)
      {
        take(glm::ivec3(i, j, k), index);
      }
    }
  }
}

/// Tells empty blocks of several components by their limits.
class LimitsTest
{
public:
  LimitsTest(
    const std::vector<const MinMaxBlocks*>& components, const DistanceMap::IsEmpty& isEmpty)
    : Components(components)
    , IsEmpty(isEmpty)
  {
  }

  /// Makes the distances of the blocks of a row of parents LargestBlockDistance where they are
  /// empty, 0 elsewhere.
  void FindOccupancy(int y, int z, std::uint8_t* distances) const
  {
    const MinMaxBlocks& blocks = *this->Components[0];
    for (int x = 0; x < blocks.GetParents().x; ++x)
    {
      const glm::ivec3 parent(x, y, z);
      const bool all =
        this->Ask([&parent](const MinMaxBlocks& each) { return each.GetParentLimits(parent); });
      ForChildren(
        parent, parent + 1, blocks.GetBlocks(), [&](const glm::ivec3& block, std::size_t index) {
          const bool empty =
            all || this->Ask([&block](const MinMaxBlocks& each) { return each.GetLimits(block); });
          distances[index] = empty ? LargestBlockDistance : std::uint8_t(0);
        });
    }
  }

private:
  template <class Get>
  bool Ask(const Get& get) const
  {
    MinMaxBlocks::Limits limits[4];
    for (std::size_t c = 0; c < this->Components.size(); ++c)
    {
      limits[c] = get(*this->Components[c]);
    }
    return this->IsEmpty(limits);
  }

  const std::vector<const MinMaxBlocks*>& Components;
  const DistanceMap::IsEmpty& IsEmpty;
};

/// Tells empty blocks of one component by their codes.
class CodesTest
{
public:
  CodesTest(const MinMaxBlocks& blocks, const TransferTable& table)
    : Blocks(blocks)
  {
    // From the last code down: the first step from code to code in which something is visible.
    const auto isVisible = [&](int from, int to) {
      const MinMaxBlocks::Limits limits = blocks.Decode({ from, to });
      return !table.IsTransparent(limits.Min, limits.Max);
    };
    const int last = blocks.GetLastCode();
    this->FirstVisible.resize(static_cast<std::size_t>(last) + 1);
    int next = last + 1;
    for (int code = last; code >= 0; --code)
    {
      next = code < last && isVisible(code, code + 1) ? code + 1 : next;
      this->FirstVisible[static_cast<std::size_t>(code)] = isVisible(code, code) ? code : next;
    }
  }

  /// As LimitsTest does.
  void FindOccupancy(int y, int z, std::uint8_t* distances) const
  {
    this->Blocks.FindReaching(y, z, this->FirstVisible, distances);
  }

private:
  const MinMaxBlocks& Blocks;
  /// The least maximum with which blocks are visible whose minimum is a code.
  std::vector<int> FirstVisible;
};

} // namespace

//------------------------------------------------------------------------------
bool DistanceMap::Cover::Hides(const glm::ivec3& block, std::size_t index) const
{
  if (this->Hidden && !this->Hidden->empty() && (*this->Hidden)[index] != 0)
  {
    return true;
  }
  if (!this->Mask)
  {
    return false;
  }
  const MinMaxBlocks::Limits limits = this->Mask->GetLimits(block);
  return limits.Min > limits.Max || limits.Max <= 0.0;
}

//------------------------------------------------------------------------------
DistanceMap::DistanceMap(const MinMaxBlocks& blocks, const TransferTable& table,
  const ParallelFor& parallelFor, const MinMaxBlocks* mask, const std::vector<std::uint8_t>* hidden)
{
  const Cover cover{ mask, hidden };
  if (blocks.GetNumberOfBlocks() > static_cast<std::size_t>(blocks.GetLastCode()))
  {
    this->Build(blocks, CodesTest(blocks, table), cover, parallelFor);
    return;
  }
  const IsEmpty isEmpty = [&table](const MinMaxBlocks::Limits* limits) {
    return table.IsTransparent(limits->Min, limits->Max);
  };
  this->Build(blocks, LimitsTest({ &blocks }, isEmpty), cover, parallelFor);
}

//------------------------------------------------------------------------------
DistanceMap::DistanceMap(const std::vector<const MinMaxBlocks*>& components, const IsEmpty& isEmpty,
  const ParallelFor& parallelFor, const MinMaxBlocks* mask, const std::vector<std::uint8_t>* hidden)
{
  this->Build(*components[0], LimitsTest(components, isEmpty), { mask, hidden }, parallelFor);
}

//------------------------------------------------------------------------------
template <class Test>
void DistanceMap::Build(
  const MinMaxBlocks& blocks, const Test& test, const Cover& cover, const ParallelFor& parallelFor)
{
  this->Blocks = blocks.GetBlocks();
  this->Codes.resize(blocks.GetNumberOfBlocks() + 3);
  const auto run = [&parallelFor](int count, const std::function<void(int)>& work) {
    parallelFor(static_cast<std::size_t>(count), [&work](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
      {
        work(static_cast<int>(i));
      }
    });
  };
  run(blocks.GetParents().z,
    [&](int plane) { this->FindOccupancy(blocks.GetParents(), test, cover, plane); });
  run(this->Blocks.z, [this](int k) { this->TransformPlane(k); });
  const std::size_t nx = static_cast<std::size_t>(this->Blocks.x);
  const std::size_t nxy = nx * static_cast<std::size_t>(this->Blocks.y);
  // Rows that lie side by side are searched together.
  run((this->Blocks.y + RowsAtOnce - 1) / RowsAtOnce, [&](int group) {
    const int j = group * RowsAtOnce;
    const int rows = std::min(RowsAtOnce, this->Blocks.y - j);
    const std::size_t count = static_cast<std::size_t>(this->Blocks.z);
    std::vector<std::uint8_t> work(count * DistanceSteps::LinesAtOnce);
    GetDistanceSteps().TransformLines(&this->Codes[static_cast<std::size_t>(j) * nx], count, nxy,
      static_cast<std::size_t>(rows) * nx, work.data());
  });
  // Each plane needs the zeros of the next one: every second plane at a time, so that no thread
  // reads what another one writes.
  for (const int parity : { 0, 1 })
  {
    run((this->Blocks.z + 1 - parity) / 2,
      [this, parity](int pair) { this->AddNeighbors(2 * pair + parity); });
  }
}

//------------------------------------------------------------------------------
template <class Test>
void DistanceMap::FindOccupancy(
  const glm::ivec3& parents, const Test& test, const Cover& cover, int parentPlane)
{
  for (int y = 0; y < parents.y; ++y)
  {
    test.FindOccupancy(y, parentPlane, this->Codes.data());
  }
  if (!cover.IsNeeded())
  {
    return;
  }
  const glm::ivec3 first(0, 0, parentPlane);
  ForChildren(first, { parents.x, parents.y, parentPlane + 1 }, this->Blocks,
    [this, &cover](const glm::ivec3& block, std::size_t index) {
      if (this->Codes[index] == 0 && cover.Hides(block, index))
      {
        this->Codes[index] = LargestBlockDistance;
      }
    });
}

//------------------------------------------------------------------------------
void DistanceMap::TransformPlane(int k)
{
  const std::size_t nx = static_cast<std::size_t>(this->Blocks.x);
  std::uint8_t* const plane = &this->Codes[GridIndex(0, 0, k, this->Blocks)];
  const DistanceSteps steps = GetDistanceSteps();
  std::vector<std::uint8_t> work(6 * nx, LargestBlockDistance);
  for (int j = 0; j < this->Blocks.y; ++j)
  {
    steps.FindDistances(plane + static_cast<std::size_t>(j) * nx, nx, work.data());
  }
  steps.TransformPlane(plane, nx, static_cast<std::size_t>(this->Blocks.y));
}

//------------------------------------------------------------------------------
void DistanceMap::AddNeighbors(int k)
{
  const std::size_t nx = static_cast<std::size_t>(this->Blocks.x);
  const std::vector<std::uint8_t> nothing(nx, LargestBlockDistance);
  const DistanceSteps steps = GetDistanceSteps();
  const auto row = [&](int y, int z) -> const std::uint8_t* {
    const bool exists = y < this->Blocks.y && z < this->Blocks.z;
    return exists ? &this->Codes[GridIndex(0, y, z, this->Blocks)] : nothing.data();
  };
  for (int j = 0; j < this->Blocks.y; ++j)
  {
    steps.AddNeighbors(&this->Codes[GridIndex(0, j, k, this->Blocks)], row(j + 1, k), row(j, k + 1),
      row(j + 1, k + 1), nx);
  }
}

//------------------------------------------------------------------------------
bool DistanceMap::IsAnythingVisible() const
{
  const std::size_t count = std::max<std::size_t>(this->Codes.size(), 3) - 3;
  return count > 0 && std::memchr(this->Codes.data(), 0, count) != nullptr;
}

//------------------------------------------------------------------------------
bool DistanceMap::FindEmptyBox(
  const glm::dvec3& q, const glm::dvec3& upper, EmptyBox& box, double margin) const
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  int side = -1;
  double farthest = 0.0;
  bool above = false;
  for (int a = 0; a < 3; ++a)
  {
    const double below = -margin - q[a];
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
    (above ? box.Min : box.Max)[side] = above ? upper[side] : -margin;
    return true;
  }
  if (!(q.x >= -margin && q.y >= -margin && q.z >= -margin))
  {
    // Not a number: nothing is known.
    return false;
  }
  const glm::ivec3 block = glm::min(glm::ivec3(q) / MinMaxBlocks::BlockSize, this->Blocks - 1);
  const int distance = this->GetDistance(block);
  if (distance == 0)
  {
    return false;
  }
  box.Min = glm::dvec3((block - (distance - 1)) * MinMaxBlocks::BlockSize);
  box.Max = glm::dvec3((block + distance) * MinMaxBlocks::BlockSize);
  return true;
}

//------------------------------------------------------------------------------
bool DistanceMap::IsEmptyIn(
  const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& upper, double margin) const
{
  // Written so that what is not a number is not known to be empty.
  if (glm::any(glm::lessThan(high, glm::dvec3(-margin))) || glm::any(glm::greaterThan(low, upper)))
  {
    return true;
  }
  glm::ivec3 first;
  glm::ivec3 last;
  for (int a = 0; a < 3; ++a)
  {
    if (!(low[a] <= high[a]))
    {
      return false;
    }
    const double largest = this->Blocks[a] - 1;
    first[a] = static_cast<int>(std::clamp(low[a] / MinMaxBlocks::BlockSize, 0.0, largest));
    last[a] = static_cast<int>(std::clamp(high[a] / MinMaxBlocks::BlockSize, 0.0, largest));
  }
  const glm::ivec3 behind = last - first;
  if (std::max(behind.x, std::max(behind.y, behind.z)) <= 1)
  {
    return this->IsEmptyFrom(first, behind.x + 2 * behind.y + 4 * behind.z);
  }
  const glm::ivec3 middle = (first + last) / 2;
  const int distance = this->GetDistance(middle);
  const glm::ivec3 reach = glm::max(middle - first, last - middle);
  if (distance == 0 || distance > std::max(reach.x, std::max(reach.y, reach.z)))
  {
    return distance > 0;
  }
  for (int k = first.z; k <= last.z; ++k)
  {
    for (int j = first.y; j <= last.y; ++j)
    {
      // Those before the distance are empty, too.
      for (int i = first.x; i <= last.x;)
      {
        const int clear = this->GetDistance({ i, j, k });
        if (clear == 0)
        {
          return false;
        }
        i += clear;
      }
    }
  }
  return true;
}

} // namespace ffd
