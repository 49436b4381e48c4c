// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDPullBackBounds.h"
#include "RandomLattice.h"
#include "Reference/FFDSurfaceSearch.h"
#include "TestVolume.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>

using namespace ffd;

namespace
{

int NoLabel(const SurfacePoint&) { return 0; }

} // namespace

/// Without deformation the point at which a sphere is met is known.
TEST(SurfaceSearch, FindsASphere)
{
  const TestVolume volume(
    ScalarType::UInt8, glm::ivec3(40, 40, 40), [](int, int, int) { return 0; }, 1);
  const glm::dvec3 center(20.0, 18.0, 21.0);
  const auto inBall = [&](const SurfacePoint& p) { return glm::length(p.Index - center) < 9.0; };
  RandomLattice random(3);
  int hits = 0;
  for (int i = 0; i < 200; ++i)
  {
    const glm::dvec3 origin(random.Number(-10.0, 50.0), random.Number(-10.0, 50.0), -30.0);
    const glm::dvec3 to = random.Vector(8.0, 32.0);
    const double stretch = random.Number(0.01, 100.0);
    const glm::dvec3 direction = stretch * glm::normalize(to - origin);
    const glm::dvec3 toCenter =
      center - volume.View.DataToIndex * (origin - volume.View.FirstVoxel);
    const glm::dvec3 step = volume.View.DataToIndex * direction;
    const double b = glm::dot(toCenter, step) / glm::dot(step, step);
    const double closest2 = glm::dot(toCenter, toCenter) - b * b * glm::dot(step, step);
    SurfacePoint hit;
    SurfacePoint before;
    const bool found = SurfaceSearch(volume.View, PullBack(), origin, direction)
                         .FindFirst(0.0, 200.0 / stretch, inBall, NoLabel, hit, before);
    if (closest2 > 81.0)
    {
      EXPECT_FALSE(found);
      continue;
    }
    const double t = b - std::sqrt((81.0 - closest2) / glm::dot(step, step));
    if (closest2 > 80.9 || t > 199.0 / stretch || t < 0.0)
    {
      continue;
    }
    ASSERT_TRUE(found);
    ++hits;
    EXPECT_NEAR(hit.T * stretch, t * stretch, 1e-9);
    EXPECT_LT(before.T, hit.T);
    EXPECT_TRUE(inBall(hit));
    EXPECT_FALSE(inBall(before));
  }
  EXPECT_GT(hits, 50);
}

/// Under a deformation the ends of the search are consistent, positions exact, and nothing of a
/// voxel's thickness lies before the hit.
TEST(SurfaceSearch, FollowsTheDeformation)
{
  RandomLattice random(7);
  int hits = 0;
  int proven = 0;
  for (int i = 0; i < 40; ++i)
  {
    const BSplineField field = random.Field(0.25, BorderMode::Edge);
    const TestVolume volume(
      ScalarType::UInt8, glm::ivec3(24, 24, 24), [](int, int, int) { return 0; }, 1);
    const PullBack map(&field, PullBackKind::Exact, 0.01);
    const glm::dvec3 origin = random.Vector(-30.0, 30.0);
    const glm::dvec3 direction =
      volume.View.FirstVoxel + volume.View.IndexToData * random.Vector(4.0, 19.0) - origin;
    const SurfaceSearch search(volume.View, map, origin, direction);
    const bool oneToOne = PullBackBounds(map).IsProvenInvertible();
    proven += oneToOne ? 1 : 0;
    const SurfaceSearch quick(volume.View, map, origin, direction, oneToOne);
    const auto condition = [](const SurfacePoint& p) {
      return std::abs(p.Index.x + 0.7 * p.Index.y - 14.0) < 1.0 && p.Index.z > 3.0;
    };
    SurfacePoint hit;
    SurfacePoint before;
    const bool found = search.FindFirst(0.0, 2.0, condition, NoLabel, hit, before);
    const double end = found ? hit.T - 1e-9 : 2.0;
    for (double t = 0.0; t < end; t += 0.002)
    {
      const glm::dvec3 index = search.Evaluate(t).Index;
      ASSERT_LT(glm::length(quick.Evaluate(t).Index - index), 1e-6);
      // Not even the corners of the condition.
      ASSERT_FALSE(std::abs(index.x + 0.7 * index.y - 14.0) < 0.9 && index.z > 4.0);
    }
    if (found)
    {
      ++hits;
      glm::dvec3 displacement = field.Displacement(hit.Rest);
      EXPECT_LT(glm::length(hit.Rest + displacement - hit.Deformed), 1e-7);
      EXPECT_LT(glm::length(hit.Deformed - (origin + hit.T * direction)), 1e-9);
      // dPhi/dP by differences.
      const glm::dmat3 jacobian = search.EvaluateJacobian(hit);
      const SurfaceSearch across(volume.View, map, hit.Deformed, glm::dvec3(0.3, -0.8, 0.5));
      const glm::dvec3 difference =
        (across.Evaluate(1e-4).Rest - across.Evaluate(-1e-4).Rest) / 2e-4;
      EXPECT_LT(glm::length(difference - jacobian * glm::dvec3(0.3, -0.8, 0.5)), 1e-3);
    }
  }
  EXPECT_GT(hits, 15);
  EXPECT_GT(proven, 5);
}

/// A region that the ray touches for a hundredth of a step is found by its label.
TEST(SurfaceSearch, LooksIntoEveryRegion)
{
  const TestVolume volume(
    ScalarType::UInt8, glm::ivec3(24, 24, 24), [](int, int, int) { return 0; }, 1);
  const SurfaceSearch search(
    volume.View, PullBack(), volume.View.FirstVoxel, volume.View.IndexToData * glm::dvec3(1.0));
  const auto sliver = [](const SurfacePoint& p) {
    return p.Index.x > 7.001 && p.Index.y < 7.004 ? 1 : 0;
  };
  const auto inSliver = [&](const SurfacePoint& p) { return sliver(p) == 1; };
  const auto label = [](const SurfacePoint& p) {
    return (p.Index.x > 7.001 ? 1 : 0) + (p.Index.y < 7.004 ? 2 : 0);
  };
  SurfacePoint hit;
  SurfacePoint before;
  ASSERT_TRUE(search.FindFirst(0.0, 20.0, inSliver, label, hit, before));
  EXPECT_NEAR(hit.Index.x, 7.001, 1e-9);
  // At the start, where nothing comes before; and an empty stretch.
  ASSERT_TRUE(search.FindFirst(7.002, 20.0, inSliver, label, hit, before));
  EXPECT_EQ(hit.T, 7.002);
  EXPECT_EQ(before.T, 7.002);
  EXPECT_FALSE(search.FindFirst(7.01, 20.0, inSliver, label, hit, before));
  EXPECT_FALSE(search.FindFirst(3.0, 2.0, inSliver, label, hit, before));
}
