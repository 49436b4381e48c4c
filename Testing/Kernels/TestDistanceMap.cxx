// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "EveryTarget.h"
#include "FFDDistanceMap.h"
#include "FFDSampling.h"
#include "RandomLattice.h"
#include "TestVolume.h"

#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

using namespace ffd;

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

bool Holds(const EmptyBox& box, const glm::dvec3& q)
{
  return glm::all(glm::greaterThanEqual(q, box.Min)) && glm::all(glm::lessThanEqual(q, box.Max));
}

/// Rows of more blocks than vectors hold, not a multiple of these; every second time of few.
glm::ivec3 MakeDimensions(RandomLattice& random, int run)
{
  const int rows = run % 2 == 0 ? 4 : 20;
  return { random.Integer(2, run % 2 == 0 ? 900 : 40), random.Integer(2, 2 * rows),
    random.Integer(2, 2 * rows) };
}

/// Random voxels of 200 in a volume of zeros; zero is transparent.
struct SparseVolume
{
  SparseVolume(RandomLattice& random, int largest, double density)
    : SparseVolume(random,
        glm::ivec3(
          random.Integer(2, largest), random.Integer(2, largest), random.Integer(2, largest)),
        density)
  {
  }
  SparseVolume(RandomLattice& random, const glm::ivec3& dimensions, double density)
    : Volume(ScalarType::UInt8, dimensions,
        [&](int, int, int) { return random.Number(0.0, 1.0) < density ? 200.0 : 0.0; })
    , Table(MakeTable(0.0, 200.0, 201, [](double x) { return x > 0.0 ? 0.5 : 0.0; }))
    , Blocks(Volume.View, ParallelFor())
    , Map(Blocks, Table)
  {
  }
  TestVolume Volume;
  TransferTable Table;
  MinMaxBlocks Blocks;
  DistanceMap Map;
};

bool MayBeVisible(const TestVolume& volume, const glm::ivec3& block)
{
  bool visible = false;
  const glm::ivec3 from = block * MinMaxBlocks::BlockSize;
  const glm::ivec3 to = glm::min(from + MinMaxBlocks::BlockSize, volume.View.Dimensions - 1);
  for (int k = from.z; k <= to.z; ++k)
  {
    for (int j = from.y; j <= to.y; ++j)
    {
      for (int i = from.x; i <= to.x; ++i)
      {
        visible = visible || volume.At(i, j, k) > 0.0;
      }
    }
  }
  return visible;
}

} // namespace

// A frame that is aborted ends them by an exception, between two layers.
TEST(DistanceMap, BlocksAndDistancesAreMadeInLayers)
{
  int left = 0;
  const ParallelFor parallelFor = [&left](std::size_t count, const ParallelFor::Work& work) {
    for (std::size_t i = 0; i < count; ++i)
    {
      if (left == 0)
      {
        throw std::runtime_error("aborted");
      }
      --left;
      work(i, i + 1);
    }
  };
  for (const ScalarType type : { ScalarType::UInt8, ScalarType::Int16, ScalarType::Float32 })
  {
    const TestVolume volume(type, glm::ivec3(50), [](int i, int, int) { return i % 40; });
    const TransferTable table =
      MakeTable(0.0, 40.0, 41, [](double x) { return x > 30.0 ? 0.5 : 0.0; });
    left = 5;
    EXPECT_THROW(MinMaxBlocks(volume.View, parallelFor), std::runtime_error);
    EXPECT_EQ(left, 0);
    const MinMaxBlocks blocks(volume.View, ParallelFor());
    left = 5;
    EXPECT_THROW(DistanceMap(blocks, table, parallelFor), std::runtime_error);
    EXPECT_EQ(left, 0);
  }
}

TEST(DistanceMap, BlocksOutsideOfMasksAreEmpty)
{
  RandomLattice random(7);
  int hidden = 0;
  for (int run = 0; run < 40; ++run)
  {
    // Many blocks, whose emptiness is told by codes, and few.
    const SparseVolume sparse(random, run % 2 == 0 ? 60 : 16, 0.05);
    const glm::ivec3& dimensions = sparse.Volume.View.Dimensions;
    const glm::ivec3 from(random.Integer(0, dimensions.x), random.Integer(0, dimensions.y),
      random.Integer(0, dimensions.z));
    const TestVolume mask(ScalarType::Float32, dimensions, [&](int i, int j, int k) {
      return i >= from.x && j >= from.y && k >= from.z ? 0.25 : run % 4 < 2 ? 0.0 : -3.0;
    });
    const MinMaxBlocks maskBlocks(mask.View, ParallelFor());
    const DistanceMap one(sparse.Blocks, sparse.Table, ParallelFor(), &maskBlocks);
    const DistanceMap several(
      { &sparse.Blocks },
      [&](const MinMaxBlocks::Limits* limits) {
        return sparse.Table.IsTransparent(limits->Min, limits->Max);
      },
      ParallelFor(), &maskBlocks);
    for (int k = 0; k < one.GetBlocks().z; ++k)
    {
      for (int j = 0; j < one.GetBlocks().y; ++j)
      {
        for (int i = 0; i < one.GetBlocks().x; ++i)
        {
          const glm::ivec3 block(i, j, k);
          const bool shown = MayBeVisible(mask, block);
          const bool visible = sparse.Map.GetDistance(block) == 0 && shown;
          ASSERT_EQ(one.GetDistance(block) == 0, visible) << run;
          ASSERT_EQ(several.GetDistance(block) == 0, visible) << run;
          hidden += shown ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(hidden, 1000);
}

TEST(DistanceMap, EqualsBruteForceChebyshevDistance)
{
  ForEveryTarget([] {
    RandomLattice random(1);
    for (int run = 0; run < 12; ++run)
    {
      const SparseVolume sparse(
        random, MakeDimensions(random, run), std::pow(10.0, random.Number(-5.0, -2.0)));
      const glm::ivec3 n = sparse.Map.GetBlocks();
      std::vector<glm::ivec3> visible;
      for (int i = 0; i < n.x * n.y * n.z; ++i)
      {
        const glm::ivec3 block(i % n.x, i / n.x % n.y, i / n.x / n.y);
        if (MayBeVisible(sparse.Volume, block))
        {
          visible.push_back(block);
        }
      }
      for (int i = 0; i < n.x * n.y * n.z; ++i)
      {
        const glm::ivec3 block(i % n.x, i / n.x % n.y, i / n.x / n.y);
        int nearest = 127;
        for (const glm::ivec3& other : visible)
        {
          const glm::ivec3 gap = glm::abs(block - other);
          nearest = std::min(nearest, std::max({ gap.x, gap.y, gap.z }));
        }
        ASSERT_EQ(sparse.Map.GetDistance(block), nearest);
      }
    }
  });
}

TEST(DistanceMap, BlocksKnowWhatIsBehindThem)
{
  ForEveryTarget([] {
    RandomLattice random(3);
    for (int run = 0; run < 12; ++run)
    {
      const SparseVolume sparse(
        random, MakeDimensions(random, run), std::pow(10.0, random.Number(-4.0, -2.0)));
      const glm::ivec3 n = sparse.Map.GetBlocks();
      for (int i = 0; i < 8 * n.x * n.y * n.z; ++i)
      {
        const int sides = i % 8;
        const glm::ivec3 block(i / 8 % n.x, i / 8 / n.x % n.y, i / 8 / n.x / n.y);
        bool empty = true;
        for (int j = 0; j < 8; ++j)
        {
          const glm::ivec3 other = block + glm::ivec3(j & 1, j >> 1 & 1, j >> 2);
          const bool exists = glm::all(glm::lessThan(other, n));
          empty = empty && ((j & ~sides) != 0 || !exists || !MayBeVisible(sparse.Volume, other));
        }
        ASSERT_EQ(sparse.Map.IsEmptyFrom(block, sides), empty) << sides;
      }
    }
  });
}

TEST(DistanceMap, DistancesAreCappedNotWrapped)
{
  ForEveryTarget([] {
    // More than 127 blocks from the only visible voxel.
    const TestVolume volume(ScalarType::UInt8, glm::ivec3(4 * 300 + 1, 2, 2),
      [](int i, int, int) { return i == 0 ? 200.0 : 0.0; });
    const TransferTable table =
      MakeTable(0.0, 200.0, 201, [](double x) { return x > 0.0 ? 0.5 : 0.0; });
    const DistanceMap map(MinMaxBlocks(volume.View, ParallelFor()), table);
    for (int i = 0; i < 300; ++i)
    {
      ASSERT_EQ(map.GetDistance(glm::ivec3(i, 0, 0)), std::min(i, 127));
    }
  });
}

TEST(DistanceMap, EmptyBoxesAreEmpty)
{
  RandomLattice random(2);
  int boxes = 0;
  int occupied = 0;
  for (int run = 0; run < 60; ++run)
  {
    const SparseVolume sparse(random, 50, std::pow(10.0, random.Number(-5.0, -2.5)));
    const glm::dvec3 upper = sparse.Volume.View.UpperIndex();
    const SampleFunctions fetch = SelectSampleFunctions(ScalarType::UInt8, Interpolation::Linear);
    for (int i = 0; i < 60; ++i)
    {
      const glm::dvec3 q = upper * random.Vector(0.0, 1.0);
      EmptyBox box;
      if (!sparse.Map.FindEmptyBox(q, upper, box))
      {
        ++occupied;
        continue;
      }
      ++boxes;
      ASSERT_TRUE(Holds(box, q));
      const glm::dvec3 lo = glm::max(box.Min, glm::dvec3(0.0));
      const glm::dvec3 hi = glm::min(box.Max, upper);
      for (int s = 0; s < 60; ++s)
      {
        const glm::dvec3 p = lo + (hi - lo) * random.Vector(0.0, 1.0);
        ASSERT_EQ(sparse.Table.Lookup(fetch.Value(sparse.Volume.View, p)).Extinction, 0.0f);
      }
    }
  }
  EXPECT_GT(boxes, 500);
  EXPECT_GT(occupied, 100);
}

TEST(DistanceMap, BoxesAreEmptyWhoseBlocksAre)
{
  RandomLattice random(7);
  int empty = 0;
  int occupied = 0;
  for (int run = 0; run < 60; ++run)
  {
    const SparseVolume sparse(random, 50, std::pow(10.0, random.Number(-4.0, -1.0)));
    const glm::dvec3 upper = sparse.Volume.View.UpperIndex();
    for (int i = 0; i < 200; ++i)
    {
      const glm::dvec3 a = upper * random.Vector(-0.3, 1.3);
      const glm::dvec3 b = a + random.Number(0.0, 1.0) * upper * random.Vector(-0.5, 0.5);
      const glm::dvec3 low = glm::min(a, b);
      const glm::dvec3 high = glm::max(a, b);
      bool visible = false;
      for (int n = 0; n < 300; ++n)
      {
        const glm::dvec3 p = low + (high - low) * random.Vector(0.0, 1.0);
        EmptyBox box;
        visible = visible || !sparse.Map.FindEmptyBox(p, upper, box);
      }
      const bool found = sparse.Map.IsEmptyIn(low, high, upper);
      ASSERT_FALSE(found && visible);
      // Nothing is called visible for blocks that the box does not reach.
      const glm::ivec3 first = glm::ivec3(glm::max(low, 0.0)) / MinMaxBlocks::BlockSize;
      const glm::ivec3 last = glm::min(
        glm::ivec3(glm::max(high, -1.0)) / MinMaxBlocks::BlockSize, sparse.Map.GetBlocks() - 1);
      bool any = false;
      for (int z = first.z; z <= last.z; ++z)
      {
        for (int y = first.y; y <= last.y; ++y)
        {
          for (int x = first.x; x <= last.x; ++x)
          {
            any = any || MayBeVisible(sparse.Volume, { x, y, z });
          }
        }
      }
      ASSERT_TRUE(found || any);
      empty += found ? 1 : 0;
      occupied += found ? 0 : 1;
    }
  }
  EXPECT_GT(empty, 1000);
  EXPECT_GT(occupied, 1000);
  // Half a voxel more on every side.
  const SparseVolume full(random, 20, 1.0);
  const glm::dvec3 upper = full.Volume.View.UpperIndex();
  const glm::dvec3 outside(-0.4);
  EXPECT_TRUE(full.Map.IsEmptyIn(outside - 1.0, outside, upper));
  EXPECT_FALSE(full.Map.IsEmptyIn(outside - 1.0, outside, upper, 0.5));
  const SparseVolume none(random, 20, 0.0);
  EXPECT_TRUE(none.Map.IsEmptyIn(glm::dvec3(-Infinity), glm::dvec3(Infinity), upper));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(none.Map.IsEmptyIn({ 0.0, nan, 0.0 }, upper, upper));
  EXPECT_FALSE(none.Map.IsEmptyIn(glm::dvec3(0.0), { 1.0, 1.0, nan }, upper));
}

TEST(DistanceMap, OnlyAFaceOfTheVolumeBelongsToTheOutside)
{
  RandomLattice random(3);
  const SparseVolume full(random, 20, 1.0);
  const glm::dvec3 upper = full.Volume.View.UpperIndex();
  for (int i = 0; i < 3000; ++i)
  {
    const glm::dvec3 q = upper * random.Vector(-1.0, 2.0);
    const bool inside =
      glm::all(glm::greaterThanEqual(q, glm::dvec3(0.0))) && glm::all(glm::lessThanEqual(q, upper));
    EmptyBox box;
    ASSERT_EQ(full.Map.FindEmptyBox(q, upper, box), !inside);
    if (inside)
    {
      continue;
    }
    ASSERT_TRUE(Holds(box, q));
    const glm::dvec3 p = upper * random.Vector(1e-9, 1.0 - 1e-9);
    ASSERT_FALSE(Holds(box, p));
    // The half space beyond the side that it is farthest from.
    double farthest = 0.0;
    double reach = 0.0;
    for (int a = 0; a < 3; ++a)
    {
      farthest = std::max({ farthest, -q[a], q[a] - upper[a] });
      reach = std::max({ reach, std::isfinite(box.Max[a]) ? box.Max[a] - q[a] : 0.0,
        std::isfinite(box.Min[a]) ? q[a] - box.Min[a] : 0.0 });
    }
    ASSERT_DOUBLE_EQ(reach, farthest);
  }
}

TEST(DistanceMap, NothingIsKnownOfWhatIsNotANumber)
{
  RandomLattice random(4);
  const SparseVolume empty(random, 20, 0.0);
  const glm::dvec3 upper = empty.Volume.View.UpperIndex();
  EmptyBox box;
  EXPECT_TRUE(empty.Map.FindEmptyBox(0.5 * upper, upper, box));
  for (int a = 0; a < 3; ++a)
  {
    glm::dvec3 q = 0.5 * upper;
    q[a] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(empty.Map.FindEmptyBox(q, upper, box));
    q[a] = Infinity;
    ASSERT_TRUE(empty.Map.FindEmptyBox(q, upper, box));
    EXPECT_EQ(box.Min[a], upper[a]);
  }
}
