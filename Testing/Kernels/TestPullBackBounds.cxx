// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The bounds are proofs: nothing that is sampled may ever leave them.
#include "Bounds/FFDPullBackBounds.h"
#include "EveryTarget.h"
#include "FFDGridIndex.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace ffd;

namespace
{

constexpr PullBackKind AllKinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

glm::dvec3 PointIn(RandomLattice& random, const Box& box)
{
  return box.Min + (box.Max - box.Min) * random.Vector(0.0, 1.0);
}

bool Holds(const Box& box, const glm::dvec3& p, double slack = 0.0)
{
  return glm::all(glm::greaterThanEqual(p, box.Min - slack)) &&
    glm::all(glm::lessThanEqual(p, box.Max + slack));
}

} // namespace

TEST(PullBackBounds, IdentityIsExact)
{
  const BSplineField zero;
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds bounds(PullBack(&zero, kind, 1e-3));
    const Box box{ glm::dvec3(-1.0), glm::dvec3(2.0) };
    EXPECT_EQ(bounds.FindLargestTurnRate(box), 0.0);
    EXPECT_EQ(bounds.DisplacementOver(box).Max, glm::dvec3(0.0));
    EXPECT_EQ(bounds.DeformedBounds(box).Min, box.Min);
    EXPECT_EQ(bounds.DeformedBounds(box).Max, box.Max);
  }
}

TEST(PullBackBounds, ContainSampledDisplacements)
{
  RandomLattice random(21);
  for (int l = 0; l < 1500; ++l)
  {
    // Sizes from 1 control point (constant along the axis), strengths from tame to folded.
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-3.0, 0.3)), AllBorders[l % 3], l % 5 == 0 ? 1 : 4);
    const PullBackBounds bounds(PullBack(&field, AllKinds[l / 3 % 4], 1e-3));
    for (int r = 0; r < 6; ++r)
    {
      Box region;
      random.Region(field, 3.0, r < 3 ? 0.6 : 3.0, region.Min, region.Max);
      const Box range = bounds.DisplacementOver(region);
      for (int i = 0; i < 25; ++i)
      {
        ASSERT_TRUE(Holds(range, field.Displacement(PointIn(random, region))));
      }
    }
  }
}

TEST(PullBackBounds, AreTheSameWithEveryTarget)
{
  RandomLattice random(33);
  for (int l = 0; l < 30; ++l)
  {
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-3.0, 0.3)), AllBorders[l % 3], 4);
    const PullBack pullBack(&field, AllKinds[l / 3 % 4], 1e-3);
    const glm::dvec3 corner = random.Vector(-30.0, 30.0);
    const Box box{ corner, corner + random.Vector(0.1, 20.0) };
    const PullBackBounds best(pullBack);
    const Box expected = best.DisplacementOver(box);
    const double slack = 1e-5 * (1.0 + glm::length(expected.Max - expected.Min));
    ForEveryTarget([&] {
      const PullBackBounds bounds(pullBack);
      const Box found = bounds.DisplacementOver(box);
      EXPECT_LT(glm::length(found.Min - expected.Min), slack);
      EXPECT_LT(glm::length(found.Max - expected.Max), slack);
      const double turn = best.FindLargestTurnRate(box);
      if (std::isfinite(turn))
      {
        EXPECT_NEAR(bounds.FindLargestTurnRate(box), turn, 1e-3 * turn);
      }
      else
      {
        EXPECT_EQ(bounds.FindLargestTurnRate(box), turn);
      }
    });
  }
}

TEST(PullBackBounds, LargestStretchHoldsInverseJacobians)
{
  RandomLattice random(29);
  int bounded = 0;
  double tightest = 0.0;
  for (int l = 0; l < 300; ++l)
  {
    const BSplineField field = random.Field(
      std::pow(10.0, random.Number(-3.0, -0.3)), AllBorders[l % 3], l % 5 == 0 ? 1 : 4);
    const PullBackKind kind = l % 2 == 0 ? PullBackKind::Exact : PullBackKind::FirstOrderOfInverse;
    const PullBackLimits limits = PullBackBounds(PullBack(&field, kind, 1e-3)).GetLimits();
    if (std::isinf(limits.LargestStretch))
    {
      continue;
    }
    EXPECT_TRUE(limits.OneToOne);
    ++bounded;
    for (int i = 0; i < 200; ++i)
    {
      glm::dmat3 d;
      field.Displacement(random.Point(field, 3.0), d);
      const glm::dmat3 jacobian = glm::inverse(glm::dmat3(1.0) + d);
      const double stretch =
        glm::length(jacobian * glm::normalize(random.Vector(-1.0, 1.0) + 1e-6));
      ASSERT_LE(stretch, limits.LargestStretch);
      tightest = std::max(tightest, stretch / limits.LargestStretch);
    }
  }
  EXPECT_GT(bounded, 150);
  EXPECT_GT(tightest, 0.7);
}

// Along one axis the bound is the largest stretch itself, whatever the Jacobian does within a cell.
TEST(PullBackBounds, LargestStretchOfOneAxisIsAttained)
{
  RandomLattice random(31);
  const glm::ivec3 nodes(6, 1, 1);
  double tightest = 0.0;
  for (int l = 0; l < 100; ++l)
  {
    std::vector<glm::dvec3> displacements(6);
    for (glm::dvec3& d : displacements)
    {
      d.x = random.Number(-0.6, 0.6);
    }
    const BSplineField field(nodes, glm::dvec3(0.0), glm::dvec3(1.0), displacements.data());
    const double bound =
      PullBackBounds(PullBack(&field, PullBackKind::Exact, 1e-3)).GetLimits().LargestStretch;
    double stretch = 0.0;
    for (int i = -300; i <= 800; ++i)
    {
      glm::dmat3 d;
      field.Displacement({ 0.01 * i, 0.0, 0.0 }, d);
      stretch = std::max(stretch, std::abs(1.0 / (1.0 + d[0].x)));
    }
    ASSERT_LE(stretch, bound);
    tightest = std::max(tightest, stretch > 2.0 ? stretch / bound : 0.0);
  }
  EXPECT_GT(tightest, 0.95);
}

TEST(PullBackBounds, TurnRateBoundsTheTurning)
{
  RandomLattice random(5);
  int bounded = 0;
  double tightest = 0.0;
  for (int run = 0; run < 400; ++run)
  {
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.5, -0.3)), BorderMode::Edge);
    const PullBack map(&field, AllKinds[run % 4], 1e-12);
    const double rate =
      PullBackBounds(map).FindLargestTurnRate({ glm::dvec3(-1e6), glm::dvec3(1e6) });
    if (!std::isfinite(rate))
    {
      continue;
    }
    ++bounded;
    for (int s = 0; s < 40; ++s)
    {
      const glm::dvec3 direction = glm::normalize(random.Vector(-1.0, 1.0) + 1e-6);
      const glm::dvec3 p = random.Point(field, 1.0);
      const double h = 1e-3;
      PullBackStatus status;
      glm::dmat3 before;
      glm::dmat3 after;
      map.Evaluate(p, before, status);
      map.Evaluate(p + h * direction, after, status);
      const glm::dvec3 a = before * direction;
      const glm::dvec3 b = after * direction;
      const double turned = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      ASSERT_LE(turned, rate * h * (1.0 + 1e-6) + 1e-9);
      tightest = std::max(tightest, turned / (rate * h));
    }
  }
  EXPECT_GT(bounded, 100);
  // The bound is of use: not orders of magnitude too large.
  EXPECT_GT(tightest, 0.05);
}

// xy + yz + zx bends most along the diagonal, and only by mixed derivatives.
TEST(PullBackBounds, TurnRateCountsMixedDerivatives)
{
  const glm::ivec3 nodes(6);
  const glm::dvec3 across = 1e-3 * glm::normalize(glm::dvec3(1.0, -1.0, 0.0));
  const glm::dvec3 middle(2.5);
  std::vector<glm::dvec3> displacements;
  for (int i = 0; i < 216; ++i)
  {
    const glm::dvec3 x = glm::dvec3(i % 6, i / 6 % 6, i / 36) - middle;
    displacements.push_back((x.x * x.y + x.y * x.z + x.z * x.x) * across);
  }
  const BSplineField field(nodes, glm::dvec3(0.0), glm::dvec3(1.0), displacements.data());
  const glm::dvec3 diagonal = glm::normalize(glm::dvec3(1.0));
  for (const PullBackKind kind : AllKinds)
  {
    const PullBack map(&field, kind, 1e-12);
    const double rate = PullBackBounds(map).FindLargestTurnRate({ middle - 0.1, middle + 0.1 });
    glm::dmat3 before;
    glm::dmat3 after;
    PullBackStatus status;
    constexpr double h = 1e-2;
    map.Evaluate(middle, before, status);
    map.Evaluate(middle + h * diagonal, after, status);
    const double turned = glm::length(after * diagonal - before * diagonal) / h;
    EXPECT_NEAR(turned, 2e-3, 1e-4);
    EXPECT_LE(turned, rate);
    EXPECT_GT(turned, 0.7 * rate);
  }
}

TEST(PullBackBounds, KinkAtTheZeroBorderIsUnbounded)
{
  RandomLattice random(23);
  const BSplineField field = random.Field(0.02, BorderMode::ZeroAtBorder);
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds bounds(PullBack(&field, kind, 1e-3));
    const glm::dvec3 plane = field.GetOrigin() - field.GetSpacing();
    Box region{ plane + 0.1 * field.GetSpacing(), plane + 0.9 * field.GetSpacing() };
    EXPECT_TRUE(std::isfinite(bounds.FindLargestTurnRate(region)));
    region.Min.y = plane.y - 0.1;
    EXPECT_TRUE(std::isinf(bounds.FindLargestTurnRate(region)));
  }
}

TEST(PullBackBounds, AffineLatticeIsTight)
{
  // D = A X: every derivative bound is sharp up to single precision, but for the faces.
  const glm::dmat3 a(
    glm::dvec3(0.2, 0.1, 0.0), glm::dvec3(-0.3, 0.1, 0.05), glm::dvec3(0.0, 0.0, -0.25));
  std::vector<glm::dvec3> d;
  for (int i = 0; i < 512; ++i)
  {
    d.push_back(a * glm::dvec3(i % 8, i / 8 % 8, i / 64) + glm::dvec3(1000.0, 0.0, -50.0));
  }
  const BSplineField field(glm::ivec3(8), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds bounds(PullBack(&field, kind, 1e-3));
    EXPECT_LT(bounds.FindLargestTurnRate({ glm::dvec3(1.6), glm::dvec3(5.4) }), 1e-9);
    EXPECT_GT(bounds.FindLargestTurnRate({ glm::dvec3(-1.0), glm::dvec3(5.4) }), 1e-2);
    const Box rest{ glm::dvec3(1.6), glm::dvec3(5.4) };
    if (kind == PullBackKind::Exact)
    {
      const Box image = bounds.DeformedBounds(rest);
      EXPECT_NEAR(image.Max.x, 5.4 + 0.2 * 5.4 - 0.3 * 1.6 + 1000.0, 1e-2);
    }
  }
}

TEST(PullBackBounds, FoldsAreUnbounded)
{
  // Neighbors 1.6 spacings towards each other along x.
  std::vector<glm::dvec3> d(6 * 6 * 6, glm::dvec3(0.0));
  for (int i = 0; i < 216; ++i)
  {
    d[static_cast<std::size_t>(i)].x = i % 6 == 2 ? 0.8 : (i % 6 == 3 ? -0.8 : 0.0);
  }
  const BSplineField field(glm::ivec3(6), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  const PullBackBounds bounds(PullBack(&field, PullBackKind::Exact, 1e-3));
  EXPECT_FALSE(bounds.IsProvenInvertible());
  EXPECT_FALSE(bounds.GetLimits().OneToOne);
  EXPECT_TRUE(std::isinf(bounds.GetLimits().LargestStretch));
  EXPECT_TRUE(std::isinf(bounds.FindLargestTurnRate({ glm::dvec3(2.4), glm::dvec3(2.6) })));
}

// An edit costs what it changes, and leaves what a new object finds.
TEST(PullBackBounds, AnEditIsBoundedWhereItCounts)
{
  RandomLattice random(30);
  constexpr int side = 12;
  std::vector<glm::dvec3> d(side * side * side);
  for (const BorderMode border : AllBorders)
  {
    for (glm::dvec3& v : d)
    {
      v = random.Vector(-0.1, 0.1);
    }
    const auto makeField = [&](double spacing) {
      return BSplineField(
        glm::ivec3(side), glm::dvec3(3.0), glm::dvec3(spacing), d.data(), 1.0, border);
    };
    BSplineField field = makeField(1.0);
    PullBackBounds kept;
    const std::size_t all = kept.Update(PullBack(&field, PullBackKind::Exact, 1e-3));
    EXPECT_GE(all, static_cast<std::size_t>((side + 1) * (side + 1) * (side + 1)));
    for (int edit = 0; edit < 16; ++edit)
    {
      // In the middle, at faces and corners; every eighth one folds, and the next one mends it.
      const glm::ivec3 node(edit % 4 == 1 ? 0 : random.Integer(0, side - 1),
        edit % 4 == 2 ? side - 1 : random.Integer(0, side - 1), random.Integer(0, side - 1));
      glm::dvec3& moved = d[static_cast<std::size_t>(node.x + side * (node.y + side * node.z))];
      const glm::dvec3 before = moved;
      moved = edit % 8 == 3 ? glm::dvec3(9.0) : random.Vector(-0.1, 0.1);
      for (const bool mended : { false, true })
      {
        if (mended && edit % 8 == 3)
        {
          moved = before;
        }
        field = makeField(1.0);
        const PullBack map(&field, PullBackKind::Exact, 1e-3);
        const std::size_t cells = kept.Update(map);
        if (mended && edit % 8 != 3)
        {
          EXPECT_EQ(cells, 0u);
        }
        EXPECT_LE(cells, 5u * 5u * 5u);
        const PullBackBounds fresh(map);
        ASSERT_EQ(kept.IsProvenInvertible(), fresh.IsProvenInvertible());
        EXPECT_EQ(fresh.IsProvenInvertible(), mended || edit % 8 != 3);
        const double stretch = fresh.GetLimits().LargestStretch;
        EXPECT_TRUE(kept.GetLimits().LargestStretch == stretch ||
          std::abs(kept.GetLimits().LargestStretch / stretch - 1.0) < 1e-4);
        const Box rest{ glm::dvec3(4.0), glm::dvec3(13.0) };
        EXPECT_EQ(kept.DeformedBounds(rest).Max, fresh.DeformedBounds(rest).Max);
      }
    }
    // Another lattice is no edit.
    field = makeField(2.0);
    EXPECT_EQ(kept.Update(PullBack(&field, PullBackKind::Exact, 1e-3)), all);
  }
}

TEST(PullBackBounds, DeformedBoundsContainTheDeformedObject)
{
  RandomLattice random(24);
  for (int l = 0; l < 600; ++l)
  {
    const PullBackKind kind = AllKinds[l / 3 % 4];
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.0, 0.4)), AllBorders[l % 3], l % 7 == 0 ? 1 : 4);
    const double tolerance = 1e-5;
    const PullBack pullBack(&field, kind, tolerance);
    const PullBackBounds bounds(pullBack);
    Box rest;
    random.Region(field, l % 4 == 0 ? 4.0 : 1.0, 6.0, rest.Min, rest.Max);
    const Box deformed = bounds.DeformedBounds(rest);
    ASSERT_FALSE(deformed.IsEmpty());
    const glm::dvec3 reach = 3.0 * field.GetSpacing();
    for (int i = 0; i < 400; ++i)
    {
      if (kind == PullBackKind::Exact && i % 2 == 0)
      {
        // The image of a rest point is part of the object even if the solver finds another one.
        const glm::dvec3 q = PointIn(random, rest);
        ASSERT_TRUE(Holds(deformed, q + field.Displacement(q)));
        continue;
      }
      const glm::dvec3 p = PointIn(random, Box{ rest.Min - reach, rest.Max + reach });
      PullBackStatus status;
      if (Holds(rest, pullBack.Evaluate(p, status)) && status.Converged)
      {
        ASSERT_TRUE(Holds(deformed, p));
      }
    }
  }
}

TEST(PullBackBounds, DeformedBoundsAreTight)
{
  RandomLattice random(25);
  for (int l = 0; l < 60; ++l)
  {
    const PullBackKind kind = AllKinds[l % 4];
    const BSplineField field = random.Field(0.3, BorderMode::Edge);
    const PullBack pullBack(&field, kind, 1e-6);
    // The whole domain, as a volume in its lattice.
    const Box rest{ field.GetOrigin() + field.GetSpacing(),
      field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes() - 2) };
    const Box deformed = PullBackBounds(pullBack).DeformedBounds(rest);
    Box sampled{ glm::dvec3(1e300), glm::dvec3(-1e300) };
    for (int i = 0; i < 30000; ++i)
    {
      const Box around{ rest.Min - field.GetSpacing(), rest.Max + field.GetSpacing() };
      const glm::dvec3 p = PointIn(random, around);
      PullBackStatus status;
      if (Holds(rest, pullBack.Evaluate(p, status)))
      {
        sampled.Min = glm::min(sampled.Min, p);
        sampled.Max = glm::max(sampled.Max, p);
      }
    }
    const double allowed = kind == PullBackKind::Exact ? 0.2 : 0.6;
    for (int a = 0; a < 3; ++a)
    {
      EXPECT_LT(deformed.Max[a] - sampled.Max[a], allowed * field.GetSpacing()[a]);
      EXPECT_LT(sampled.Min[a] - deformed.Min[a], allowed * field.GetSpacing()[a]);
    }
  }
}

// Whether T folds or not: points without a rest point show nothing.
TEST(PullBackBounds, DeformedBoundsOfFoldsAreThoseOfTheImage)
{
  RandomLattice random(26);
  int folded = 0;
  for (int l = 0; l < 20; ++l)
  {
    const BSplineField field = random.Field(2.0, BorderMode::Edge);
    const Box rest{ field.GetOrigin() + field.GetSpacing(),
      field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes() - 2) };
    const PullBackBounds bounds(PullBack(&field, PullBackKind::Exact, 1e-6));
    folded += bounds.IsProvenInvertible() ? 0 : 1;
    const Box deformed = bounds.DeformedBounds(rest);
    Box sampled = Box::Empty();
    for (int i = 0; i < 30000; ++i)
    {
      const glm::dvec3 q = PointIn(random, rest);
      const glm::dvec3 p = q + field.Displacement(q);
      sampled.Include({ p, p });
    }
    for (int a = 0; a < 3; ++a)
    {
      EXPECT_LT(deformed.Max[a] - sampled.Max[a], 0.3 * field.GetSpacing()[a]);
      EXPECT_LT(sampled.Min[a] - deformed.Min[a], 0.3 * field.GetSpacing()[a]);
    }
  }
  EXPECT_GT(folded, 15);
}

TEST(PullBackBounds, TranslationMovesTheBoxExactly)
{
  const std::vector<glm::dvec3> d(125, glm::dvec3(10.0, -20.0, 0.5));
  const BSplineField field(glm::ivec3(5), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  const Box rest{ glm::dvec3(-3.0), glm::dvec3(9.0) };
  for (const PullBackKind kind : AllKinds)
  {
    const double sign = kind == PullBackKind::Forward ? -1.0 : 1.0;
    const Box box = PullBackBounds(PullBack(&field, kind, 1e-6)).DeformedBounds(rest);
    for (int a = 0; a < 3; ++a)
    {
      // 2P - T^-1(P) = P + d, whose rest box moves back.
      const double move = (kind == PullBackKind::FirstOrderOfInverse ? -1.0 : sign) * d[0][a];
      EXPECT_NEAR(box.Min[a], rest.Min[a] + move, 1e-3);
      EXPECT_NEAR(box.Max[a], rest.Max[a] + move, 1e-3);
    }
  }
}

/// Lattices of many control points are bounded in slabs: as a whole they are as their parts.
TEST(PullBackBounds, ManyControlPoints)
{
  RandomLattice random(37);
  const glm::ivec3 nodes(40, 44, 160);
  std::vector<glm::dvec3> displacements(GridSize(nodes));
  for (glm::dvec3& d : displacements)
  {
    d = random.Vector(-0.02, 0.02);
  }
  const auto makeField = [&] {
    return BSplineField(nodes, glm::dvec3(0.0), glm::dvec3(1.0), displacements.data());
  };
  const BSplineField field = makeField();
  const PullBackBounds bounds(PullBack(&field, PullBackKind::Exact, 1e-3));
  const Box whole{ glm::dvec3(-3.0), glm::dvec3(nodes) + 2.0 };
  const glm::dvec3 middle(21.3, 33.4, 79.5);
  Box sum = Box::Empty();
  double turn = 0.0;
  for (int octant = 0; octant < 8; ++octant)
  {
    Box part = whole;
    for (int a = 0; a < 3; ++a)
    {
      ((octant >> a & 1) != 0 ? part.Min : part.Max)[a] = middle[a];
    }
    sum.Include(bounds.DisplacementOver(part));
    turn = std::max(turn, bounds.FindLargestTurnRate(part));
  }
  EXPECT_EQ(bounds.DisplacementOver(whole), sum);
  EXPECT_EQ(bounds.FindLargestTurnRate(whole), turn);
  // The largest stretch is where one control point moves farther, in any slab.
  for (const int k : { 1, 66, 158 })
  {
    glm::dvec3& moved = displacements[GridIndex(25, 30, k, nodes)];
    moved.z += 0.5;
    std::vector<glm::dvec3> near;
    for (int n = 0; n < 9 * 9 * 9; ++n)
    {
      const glm::ivec3 i = glm::clamp(
        glm::ivec3(21, 26, k - 4) + glm::ivec3(n % 9, n / 9 % 9, n / 81), glm::ivec3(0), nodes - 1);
      near.push_back(displacements[GridIndex(i.x, i.y, i.z, nodes)]);
    }
    const BSplineField part(glm::ivec3(9), glm::dvec3(0.0), glm::dvec3(1.0), near.data());
    const double stretch =
      PullBackBounds(PullBack(&part, PullBackKind::Exact, 1e-3)).GetLimits().LargestStretch;
    EXPECT_GT(stretch, 1.3);
    const BSplineField all = makeField();
    const PullBackBounds anew(PullBack(&all, PullBackKind::Exact, 1e-3));
    EXPECT_NEAR(anew.GetLimits().LargestStretch, stretch, 1e-4 * stretch) << "slice " << k;
    moved.z -= 0.5;
  }
}

/// Beyond the lattice D goes on linearly as far as T is proven to stay regular.
TEST(PullBackBounds, LinearCells)
{
  RandomLattice random(38);
  int some = 0;
  int none = 0;
  for (int run = 0; run < 24; ++run)
  {
    const glm::ivec3 nodes(random.Integer(15, 30), random.Integer(20, 30), random.Integer(15, 30));
    const glm::dvec3 spacing = random.Vector(0.5, 2.0);
    const glm::dvec3 waves = random.Vector(0.5, 4.0);
    const double size = std::pow(10.0, random.Number(-1.0, 1.0));
    const double noise = run % 4 == 0 ? random.Number(0.0, 0.3) : 0.0;
    std::vector<glm::dvec3> displacements;
    for (int n = 0; n < nodes.x * nodes.y * nodes.z; ++n)
    {
      const glm::ivec3 i(n % nodes.x, n / nodes.x % nodes.y, n / (nodes.x * nodes.y));
      const glm::dvec3 at = waves * glm::dvec3(i) / glm::dvec3(nodes);
      displacements.push_back(
        size * glm::dvec3(std::sin(at.x + at.z), std::cos(at.y) * at.z, std::sin(at.x * at.y)) +
        noise * random.Vector(-1.0, 1.0));
    }
    const BSplineField field(nodes, glm::dvec3(3.0), spacing, displacements.data());
    const PullBackLimits limits =
      PullBackBounds(PullBack(&field, PullBackKind::Exact, 1e-3)).GetLimits();
    ASSERT_TRUE(limits.OneToOne || limits.LinearCells == 0);
    some += limits.LinearCells > 0 ? 1 : 0;
    none += limits.LinearCells == 0 ? 1 : 0;
    if (limits.LinearCells == 0)
    {
      continue;
    }
    const BSplineField extended = ExtendLinearly(field, glm::ivec3(limits.LinearCells));
    for (int i = 0; i < 20000; ++i)
    {
      const glm::dvec3 p = random.Point(extended, 4.0);
      glm::dmat3 jacobian;
      const glm::dvec3 displacement = extended.Displacement(p, jacobian);
      ASSERT_GT(glm::determinant(glm::dmat3(1.0) + jacobian), 0.0) << "run " << run;
      // Within the lattice nothing has changed.
      const glm::dvec3 u = (p - field.GetOrigin()) / spacing;
      if (glm::all(glm::greaterThanEqual(u, glm::dvec3(1.0))) &&
        glm::all(glm::lessThanEqual(u, glm::dvec3(nodes) - 2.0)))
      {
        ASSERT_LT(glm::distance(displacement, field.Displacement(p)), 1e-9);
      }
    }
  }
  EXPECT_GT(some, 4);
  EXPECT_GT(none, 2);
}

TEST(PullBackBounds, EmptyAndNonFiniteInput)
{
  RandomLattice random(26);
  const BSplineField field = random.Field(0.3, BorderMode::Edge);
  const PullBackBounds bounds(PullBack(&field, PullBackKind::Exact, 1e-3));
  EXPECT_TRUE(bounds.DeformedBounds({ glm::dvec3(1.0), glm::dvec3(0.0) }).IsEmpty());
  EXPECT_TRUE(bounds.DeformedBounds({ glm::dvec3(std::nan("")), glm::dvec3(0.0) }).IsEmpty());
  // A region without limits has the bounds of all sub-cells.
  const double inf = std::numeric_limits<double>::infinity();
  const Box all{ glm::dvec3(-inf), glm::dvec3(inf) };
  EXPECT_TRUE(std::isfinite(bounds.DisplacementOver(all).Max.x));

  std::vector<glm::dvec3> d(64, glm::dvec3(0.0));
  d[21].y = std::nan("");
  const BSplineField broken(glm::ivec3(4), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  EXPECT_FALSE(PullBackBounds(PullBack(&broken, PullBackKind::Exact, 1e-3)).IsProvenInvertible());
}

TEST(PullBackBounds, NegativeSpacingIsTheMirroredLattice)
{
  RandomLattice random(27);
  std::vector<glm::dvec3> d(125);
  std::vector<glm::dvec3> mirrored(125);
  for (int i = 0; i < 125; ++i)
  {
    d[static_cast<std::size_t>(i)] = random.Vector(-0.3, 0.3);
    mirrored[static_cast<std::size_t>(i - i % 5 + 4 - i % 5)] = d[static_cast<std::size_t>(i)];
  }
  const BSplineField plain(glm::ivec3(5), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  const BSplineField flipped(
    glm::ivec3(5), glm::dvec3(4, 0, 0), glm::dvec3(-1, 1, 1), mirrored.data());
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds a(PullBack(&plain, kind, 1e-3));
    const PullBackBounds b(PullBack(&flipped, kind, 1e-3));
    const Box region{ glm::dvec3(0.7, 1.1, 2.2), glm::dvec3(0.9, 1.3, 2.3) };
    EXPECT_NEAR(a.GetLimits().LargestStretch, b.GetLimits().LargestStretch, 1e-4);
    EXPECT_NEAR(a.FindLargestTurnRate(region), b.FindLargestTurnRate(region), 1e-4);
    EXPECT_NEAR(a.DeformedBounds(region).Max.x, b.DeformedBounds(region).Max.x, 1e-4);
  }
}
