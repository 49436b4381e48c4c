// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeSelection.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <numeric>

using namespace ffd;

namespace
{

const glm::ivec3 Nodes(5, 6, 7);

std::size_t At(int i, int j, int k) { return static_cast<std::size_t>(i + 5 * (j + 6 * k)); }

PointSet Empty() { return PointSet(5 * 6 * 7, 0); }

int Count(const PointSet& set) { return std::accumulate(set.begin(), set.end(), 0); }

} // namespace

TEST(LatticeSelection, GrowAndShrink)
{
  PointSet set = Empty();
  set[At(2, 2, 2)] = 1;
  set = GrowSelection(Nodes, set);
  EXPECT_EQ(Count(set), 7);
  EXPECT_TRUE(set[At(3, 2, 2)] && set[At(2, 1, 2)] && set[At(2, 2, 3)]);
  set = ShrinkSelection(Nodes, set);
  EXPECT_EQ(Count(set), 1);
  EXPECT_TRUE(set[At(2, 2, 2)]);
  EXPECT_EQ(Count(ShrinkSelection(Nodes, set)), 0);
  // A corner has three neighbors; all selected does not shrink at the ends of the lattice.
  set = Empty();
  set[At(4, 5, 6)] = 1;
  EXPECT_EQ(Count(GrowSelection(Nodes, set)), 4);
  EXPECT_EQ(Count(ShrinkSelection(Nodes, PointSet(210, 1))), 210);
}

TEST(LatticeSelection, RowsAndPlanes)
{
  PointSet set = Empty();
  set[At(1, 2, 3)] = 1;
  set[At(3, 2, 3)] = 1;
  EXPECT_EQ(Count(SelectRows(Nodes, set, 0)), 5);
  EXPECT_EQ(Count(SelectRows(Nodes, set, 1)), 12);
  EXPECT_TRUE(SelectRows(Nodes, set, 2)[At(3, 2, 6)]);
  EXPECT_EQ(Count(SelectPlanes(Nodes, set, 0)), 2 * 42);
  EXPECT_EQ(Count(SelectPlanes(Nodes, set, 1)), 35);
  EXPECT_TRUE(SelectPlanes(Nodes, set, 2)[At(0, 0, 3)]);
}

TEST(LatticeSelection, Boundary)
{
  EXPECT_EQ(Count(BoundaryPoints(Nodes, 0)), 0);
  EXPECT_EQ(Count(BoundaryPoints(Nodes, 1)), 210 - 3 * 4 * 5);
  EXPECT_EQ(Count(BoundaryPoints(Nodes, 2)), 210 - 1 * 2 * 3);
  EXPECT_EQ(Count(BoundaryPoints(Nodes, 3)), 210);
}

TEST(LatticeSelection, MirrorImages)
{
  EXPECT_EQ(MirrorPoint(Nodes, At(1, 2, 3), 0), At(3, 2, 3));
  EXPECT_EQ(MirrorPoint(Nodes, At(1, 2, 3), 1), At(1, 3, 3));
  EXPECT_EQ(MirrorPoint(Nodes, At(1, 2, 3), 2), At(1, 2, 3));
  const bool both[3] = { true, true, false };
  PointSet set = Empty();
  set[At(1, 2, 3)] = 1;
  EXPECT_EQ(Count(MirrorSelection(Nodes, set, both)), 4);
  std::vector<glm::dvec3> changes(210, glm::dvec3(0.0));
  changes[At(1, 2, 3)] = { 1.0, 2.0, 3.0 };
  changes[At(3, 2, 3)] = { 9.0, 9.0, 9.0 }; // on the other side: overwritten
  changes[At(2, 0, 0)] = { 5.0, 6.0, 7.0 }; // in the mid-plane of x
  MirrorChanges(Nodes, changes, both, At(1, 2, 3));
  EXPECT_EQ(changes[At(1, 2, 3)], glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(changes[At(3, 2, 3)], glm::dvec3(-1.0, 2.0, 3.0));
  EXPECT_EQ(changes[At(1, 3, 3)], glm::dvec3(1.0, -2.0, 3.0));
  EXPECT_EQ(changes[At(3, 3, 3)], glm::dvec3(-1.0, -2.0, 3.0));
  EXPECT_EQ(changes[At(2, 0, 0)], glm::dvec3(0.0, 6.0, 7.0));
  EXPECT_EQ(changes[At(2, 5, 0)], glm::dvec3(0.0, -6.0, 7.0));
  // From the upper half when the active point lies there.
  changes.assign(210, glm::dvec3(0.0));
  changes[At(4, 0, 0)] = { 1.0, 0.0, 0.0 };
  const bool x[3] = { true, false, false };
  MirrorChanges(Nodes, changes, x, At(4, 0, 0));
  EXPECT_EQ(changes[At(0, 0, 0)], glm::dvec3(-1.0, 0.0, 0.0));
}

TEST(LatticeSelection, SoftWeights)
{
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < 210; ++i)
  {
    positions.push_back(glm::dvec3(i % 5, i / 5 % 6, i / 30));
  }
  PointSet set = Empty();
  set[At(1, 1, 1)] = 1;
  set[At(3, 1, 1)] = 1;
  const std::vector<double> weights = SoftWeights(positions, set, 2.0, Falloff::Linear);
  EXPECT_EQ(weights[At(1, 1, 1)], 1.0);
  EXPECT_EQ(weights[At(2, 1, 1)], 0.5);
  EXPECT_EQ(weights[At(4, 1, 1)], 0.5);
  EXPECT_NEAR(weights[At(1, 2, 2)], 1.0 - std::sqrt(2.0) / 2.0, 1e-15);
  EXPECT_EQ(weights[At(1, 3, 1)], 0.0);
  EXPECT_EQ(SoftWeights(positions, set, 0.0, Falloff::Constant)[At(2, 1, 1)], 0.0);
  EXPECT_EQ(SoftWeights(positions, set, 2.0, Falloff::Constant)[At(2, 1, 1)], 1.0);
  EXPECT_EQ(SoftWeights(positions, Empty(), 2.0, Falloff::Constant)[0], 0.0);
}

TEST(LatticeSelection, Falloffs)
{
  for (Falloff f : { Falloff::Smooth, Falloff::Linear, Falloff::Sphere, Falloff::Sharp })
  {
    EXPECT_EQ(GetFalloff(f, 0.0), 1.0);
    EXPECT_EQ(GetFalloff(f, 1.0), 0.0);
    EXPECT_EQ(GetFalloff(f, 7.0), 0.0);
    for (double t = 0.05; t < 1.0; t += 0.05)
    {
      EXPECT_LT(GetFalloff(f, t), GetFalloff(f, t - 0.05));
    }
  }
  EXPECT_EQ(GetFalloff(Falloff::Smooth, 0.5), 0.5);
  EXPECT_EQ(GetFalloff(Falloff::Linear, 0.25), 0.75);
  EXPECT_NEAR(GetFalloff(Falloff::Sphere, 0.6), 0.8, 1e-15);
  EXPECT_EQ(GetFalloff(Falloff::Sharp, 0.5), 0.25);
  EXPECT_EQ(GetFalloff(Falloff::Constant, 0.99), 1.0);
}
