// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What is kept of the bounds for the rays: proofs over boxes of deformed space.
#include "FFDDeformedSpaceBounds.h"
#include "FFDEighthPowers.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

using namespace ffd;

namespace
{

constexpr PullBackKind AllKinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

bool Inverts(PullBackKind kind)
{
  return kind == PullBackKind::Exact || kind == PullBackKind::FirstOrderOfInverse;
}

/// Every element by a thread of its own, last ones first.
void Scattered(
  std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& work)
{
  std::vector<std::thread> threads;
  for (std::size_t i = count; i-- > 0;)
  {
    threads.emplace_back([&work, i]() { work(i, i + 1); });
    if (threads.size() == 4 || i == 0)
    {
      for (std::thread& thread : threads)
      {
        thread.join();
      }
      threads.clear();
    }
  }
}

struct Setting
{
  Box Rest;
  Box Region;
  double Resolution;
  int MostCells;
};

Setting RandomSetting(RandomLattice& random, const BSplineField& field)
{
  Setting s;
  random.Region(field, 1.0, 6.0, s.Rest.Min, s.Rest.Max);
  s.Resolution = random.Number(0.05, 1.0) * glm::length(field.GetSpacing());
  s.Region = { s.Rest.Min - s.Resolution, s.Rest.Max + s.Resolution };
  s.MostCells = random.Integer(1, 600);
  return s;
}

bool Same(const MapBounds& a, const MapBounds& b)
{
  return a.JacobianMin == b.JacobianMin && a.JacobianMax == b.JacobianMax &&
    a.SecondDerivative == b.SecondDerivative && a.ThirdDerivative == b.ThirdDerivative;
}

} // namespace

TEST(DeformedSpaceBounds, ContainSampledJacobiansAndCurves)
{
  RandomLattice random(41);
  int bounded = 0;
  int curves = 0;
  double tightest2 = 0.0;
  double tightest3 = 0.0;
  for (int l = 0; l < 480; ++l)
  {
    const PullBackKind kind = AllKinds[l / 3 % 4];
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-3.0, 0.1)), AllBorders[l % 3], l % 8 == 0 ? 1 : 4);
    const PullBack map(&field, kind, 1e-12);
    const PullBackBounds mapBounds(map);
    const Setting s = RandomSetting(random, field);
    const DeformedSpaceBounds bounds(map, mapBounds, s.Region, s.Rest, s.Resolution, s.MostCells);
    for (int b = 0; b < 12; ++b)
    {
      // Boxes in the region and far out of it: any has an answer.
      Box box;
      random.Region(field, b < 8 ? 1.0 : 9.0, b % 2 == 0 ? 0.5 : 3.0, box.Min, box.Max);
      const MapBounds over = bounds.Over(box);
      const bool finite = std::isfinite(over.ThirdDerivative);
      bounded += finite ? 1 : 0;
      const auto pointIn = [&]() {
        return box.Min + (box.Max - box.Min) * random.Vector(0.0, 1.0);
      };
      for (int i = 0; i < 8; ++i)
      {
        PullBackStatus status;
        glm::dmat3 jacobian;
        map.Evaluate(pointIn(), jacobian, status);
        if (!status.Converged)
        {
          continue;
        }
        for (int e = 0; e < 9; ++e)
        {
          // The point is where T is within the tolerance of it only.
          const double slack = 1e-9 * (1.0 + std::abs(jacobian[e / 3][e % 3]));
          ASSERT_GE(jacobian[e / 3][e % 3], over.JacobianMin[e / 3][e % 3] - slack);
          ASSERT_LE(jacobian[e / 3][e % 3], over.JacobianMax[e / 3][e % 3] + slack);
        }
      }
      if (!finite || !bounds.IsOneToOne())
      {
        continue;
      }
      // A piece of a ray: the chord and the parabola through three points.
      const glm::dvec3 p0 = pointIn();
      const glm::dvec3 p1 = pointIn();
      const double length = glm::distance(p0, p1);
      const double t = random.Number(0.1, 0.9);
      PullBackStatus status[4];
      const glm::dvec3 q0 = map.Evaluate(p0, status[0]);
      const glm::dvec3 q1 = map.Evaluate(p1, status[1]);
      const glm::dvec3 middle = map.Evaluate(0.5 * (p0 + p1), status[2]);
      const glm::dvec3 q = map.Evaluate(p0 + t * (p1 - p0), status[3]);
      if (!std::all_of(status, status + 4, [](const PullBackStatus& x) { return x.Converged; }))
      {
        continue;
      }
      ++curves;
      const double chord = glm::distance(q, q0 + t * (q1 - q0));
      const double limit2 = over.SecondDerivative * length * length * t * (1.0 - t) / 2.0;
      ASSERT_LE(chord, limit2 + 1e-9);
      const glm::dvec3 quadratic = q0 * (2.0 * (t - 0.5) * (t - 1.0)) +
        middle * (4.0 * t * (1.0 - t)) + q1 * (2.0 * t * (t - 0.5));
      const double limit3 =
        over.ThirdDerivative * length * length * length * std::abs(t * (t - 0.5) * (t - 1.0)) / 6.0;
      ASSERT_LE(glm::distance(q, quadratic), limit3 + 1e-9);
      tightest2 = std::max(tightest2, chord / (limit2 + 1e-9));
      tightest3 = std::max(tightest3, glm::distance(q, quadratic) / (limit3 + 1e-9));
    }
  }
  // Bounds that are always infinite, or far too large, would pass the above.
  EXPECT_GT(bounded, 2000);
  EXPECT_GT(curves, 1500);
  EXPECT_GT(tightest2, 0.3);
  EXPECT_GT(tightest3, 0.1);
}

// The grids hold what PullBackBounds says of the points that can get into a box, and no more than
// what their cells and codes add.
TEST(DeformedSpaceBounds, AreAsCloseAsTheMapsOwn)
{
  RandomLattice random(42);
  double sum = 0.0;
  int count = 0;
  for (int l = 0; l < 60; ++l)
  {
    // A translation by whole cells and a little more: where points come from is known exactly.
    const PullBackKind kind = AllKinds[l % 4];
    const BSplineField field = random.Field(0.02, BorderMode::Edge);
    const PullBack map(&field, kind, 1e-9);
    const PullBackBounds mapBounds(map);
    const Box rest{ field.GetOrigin(),
      field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes() - 1) };
    const double least =
      std::min({ field.GetSpacing().x, field.GetSpacing().y, field.GetSpacing().z });
    // Coarse enough to need no refined lattice.
    const DeformedSpaceBounds bounds(map, mapBounds, rest, rest, least, 100000);
    for (int b = 0; b < 20; ++b)
    {
      const glm::dvec3 p = rest.Min + (rest.Max - rest.Min) * random.Vector(0.1, 0.9);
      const Box box{ p, p + 0.01 * least };
      // All of the cells that the box can touch, and the sub-cells that reach into them.
      const double reach = 1.1 * least + 0.05 * glm::length(field.GetSpacing());
      const Box around{ box.Min - field.GetSpacing() - reach,
        box.Max + field.GetSpacing() + reach };
      const MapBounds own = mapBounds.Over(around);
      const MapBounds over = bounds.Over(box);
      ASSERT_LE(over.SecondDerivative, own.SecondDerivative * 1.1 + 1e-6);
      ASSERT_LE(over.ThirdDerivative, own.ThirdDerivative * 1.1 + 1e-6);
      const MapBounds all = mapBounds.Over({ rest.Min - 100.0, rest.Max + 100.0 });
      for (int e = 0; e < 9; ++e)
      {
        // One step of a code.
        const double step =
          (all.JacobianMax[e / 3][e % 3] - all.JacobianMin[e / 3][e % 3]) / 120.0 + 1e-6;
        ASSERT_GE(over.JacobianMin[e / 3][e % 3], own.JacobianMin[e / 3][e % 3] - step);
        ASSERT_LE(over.JacobianMax[e / 3][e % 3], own.JacobianMax[e / 3][e % 3] + step);
      }
      sum += over.SecondDerivative / mapBounds.Over(box).SecondDerivative;
      ++count;
    }
  }
  EXPECT_LT(sum / count, 3.0);
}

TEST(DeformedSpaceBounds, DoNotDependOnThreads)
{
  RandomLattice random(43);
  for (int l = 0; l < 36; ++l)
  {
    const PullBackKind kind = AllKinds[l / 3 % 4];
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.0, 0.3)), AllBorders[l % 3]);
    const PullBack map(&field, kind, 1e-4);
    const PullBackBounds one(map);
    const PullBackBounds many(map, Scattered);
    ASSERT_EQ(one.IsProvenInvertible(), many.IsProvenInvertible());
    const Setting s = RandomSetting(random, field);
    const Box deformed = one.DeformedBounds(s.Rest);
    const Box deformedByMany = many.DeformedBounds(s.Rest, Scattered);
    ASSERT_EQ(deformed.Min, deformedByMany.Min);
    ASSERT_EQ(deformed.Max, deformedByMany.Max);
    ASSERT_TRUE(Same(one.Over(s.Rest), many.Over(s.Rest, Scattered)));
    const DeformedSpaceBounds spaceOne(map, one, s.Region, s.Rest, s.Resolution, s.MostCells);
    const DeformedSpaceBounds spaceMany(
      map, many, s.Region, s.Rest, s.Resolution, s.MostCells, Scattered);
    ASSERT_EQ(spaceOne.GetMemorySize(), spaceMany.GetMemorySize());
    for (int b = 0; b < 40; ++b)
    {
      Box box;
      random.Region(field, 2.0, 2.0, box.Min, box.Max);
      ASSERT_TRUE(Same(one.Over(box), many.Over(box)));
      ASSERT_TRUE(Same(spaceOne.Over(box), spaceMany.Over(box)));
    }
  }
}

TEST(DeformedSpaceBounds, KinkAtTheZeroBorderIsUnbounded)
{
  RandomLattice random(44);
  const BSplineField field = random.Field(0.1, BorderMode::ZeroAtBorder);
  const Box rest{ field.GetOrigin() - 2.0 * field.GetSpacing(),
    field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes() + 1) };
  const double resolution = 0.1 * field.GetSpacing().x;
  for (const PullBackKind kind : AllKinds)
  {
    const PullBack map(&field, kind, 1e-6);
    const PullBackBounds mapBounds(map);
    const DeformedSpaceBounds bounds(map, mapBounds, rest, rest, resolution, 20000);
    // D is zero at the border and outside: what lies there stays.
    const glm::dvec3 plane = field.GetOrigin() - field.GetSpacing();
    const glm::dvec3 inside = field.GetOrigin() + 1.5 * field.GetSpacing();
    const glm::dvec3 onFace(plane.x, inside.y, inside.z);
    const glm::dvec3 small = 0.01 * field.GetSpacing();
    EXPECT_TRUE(std::isinf(bounds.Over({ onFace - small, onFace + small }).SecondDerivative));
    EXPECT_TRUE(std::isinf(bounds.Over({ onFace - small, onFace + small }).ThirdDerivative));
    EXPECT_TRUE(std::isfinite(bounds.Over({ inside - small, inside + small }).ThirdDerivative));
    EXPECT_TRUE(std::isfinite(bounds.Over({ onFace - small, onFace + small }).JacobianMax[0][0]) ||
      Inverts(kind));
  }
}

TEST(EighthPowers, AreFoundExactly)
{
  RandomLattice random(45);
  for (int i = 0; i < 200000; ++i)
  {
    const float ratio = static_cast<float>(std::exp2(random.Number(0.0, 60.0)));
    const int power = FindEighthPower(ratio);
    // Never a smaller number than the one that was meant, but for rounding.
    ASSERT_LE(1.0 / ratio, static_cast<double>(EighthPower(power)) * 1.000001);
    ASSERT_GE(1.0 / ratio, static_cast<double>(EighthPower(power + 1)) * 0.999999);
  }
  EXPECT_EQ(FindEighthPower(1.0f), 0);
  EXPECT_EQ(FindEighthPower(2.0f), 8);
  EXPECT_GT(FindEighthPower(std::numeric_limits<float>::infinity()), 254);
}
