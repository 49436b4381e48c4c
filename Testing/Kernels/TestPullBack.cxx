// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBack.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace ffd;

namespace
{

constexpr PullBackKind AllKinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

bool IsFinite(const glm::dvec3& v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

} // namespace

TEST(PullBack, NoFieldIsTheIdentity)
{
  const BSplineField zero;
  for (const PullBackKind kind : AllKinds)
  {
    for (const PullBack& pullBack : { PullBack(nullptr, kind, 1e-3), PullBack(&zero, kind, 1e-3) })
    {
      PullBackStatus status;
      glm::dmat3 jacobian;
      const glm::dvec3 p(1.0, 2.0, 3.0);
      EXPECT_TRUE(pullBack.IsIdentity());
      EXPECT_EQ(pullBack.Evaluate(p, jacobian, status), p);
      EXPECT_EQ(jacobian, glm::dmat3(1.0));
      EXPECT_TRUE(status.Converged);
      EXPECT_EQ(status.Evaluations, 0);
    }
  }
}

TEST(PullBack, FirstOrderIsEquationThree)
{
  RandomLattice random(11);
  for (const BorderMode border : AllBorders)
  {
    const BSplineField field = random.Field(2.0, border);
    for (int i = 0; i < 100; ++i)
    {
      const glm::dvec3 p = random.Point(field, 3.0);
      PullBackStatus status;
      const glm::dvec3 t = p + field.Displacement(p);
      EXPECT_LT(glm::distance(PullBack(&field, PullBackKind::FirstOrder, 1e-3).Evaluate(p, status),
                  2.0 * p - t),
        1e-12);
      EXPECT_EQ(status.Evaluations, 1);
      EXPECT_LT(
        glm::distance(PullBack(&field, PullBackKind::Forward, 1e-3).Evaluate(p, status), t), 1e-12);
    }
  }
}

// Choi and Lee (2000): displacements under about 0.48 spacings keep the cubic B-spline injective.
TEST(PullBack, ExactInvertsFoldFreeLattices)
{
  RandomLattice random(12);
  long evaluations = 0;
  long points = 0;
  for (const BorderMode border : AllBorders)
  {
    for (int l = 0; l < 150; ++l)
    {
      const double amount = random.Number(0.0, 0.4);
      const BSplineField field = random.Field(amount, border);
      const double tolerance = std::pow(10.0, random.Number(-10.0, -2.0));
      const PullBack exact(&field, PullBackKind::Exact, tolerance);
      for (int i = 0; i < 40; ++i)
      {
        const glm::dvec3 p = random.Point(field, 3.0);
        PullBackStatus status;
        const glm::dvec3 q = exact.Evaluate(p, status);
        ASSERT_TRUE(status.Converged);
        ASSERT_LE(glm::distance(q + field.Displacement(q), p), tolerance * 1.0001);
        if (tolerance > 1e-3)
        {
          evaluations += status.Evaluations;
          ++points;
        }
      }
    }
  }
  // The cost promised for a tolerance of a hundredth of a spacing.
  EXPECT_LT(static_cast<double>(evaluations) / static_cast<double>(points), 4.5);
}

// A map that shears thin cells enlarges what rounding leaves of positions far from the origin.
TEST(PullBack, ThinCellsFarFromTheOrigin)
{
  RandomLattice random(5);
  for (const double place : { 1e3, 1e5, 1e7 })
  {
    const glm::dvec3 origin(0.0, 0.0, place);
    const glm::dvec3 spacing(20.0, 20.0, 2e-10 * place);
    std::vector<glm::dvec3> displacements(8 * 8 * 8);
    for (glm::dvec3& d : displacements)
    {
      d = random.Vector(-0.3, 0.3) * spacing;
    }
    const BSplineField field(
      glm::ivec3(8), origin, spacing, displacements.data(), 1.0, BorderMode::Zero);
    const PullBack exact(&field, PullBackKind::Exact, 1e-3 * spacing.z);
    for (int i = 0; i < 2000; ++i)
    {
      const glm::dvec3 q = origin + spacing * random.Vector(2.0, 5.0);
      PullBackStatus status;
      const glm::dvec3 back = exact.Evaluate(q + field.Displacement(q), status);
      ASSERT_TRUE(status.Converged) << place;
      ASSERT_LT(glm::length((back - q) / spacing), 0.05) << place;
    }
  }
}

TEST(PullBack, JacobiansAreTheDerivativesOfThePullBack)
{
  RandomLattice random(13);
  for (const PullBackKind kind : AllKinds)
  {
    for (int l = 0; l < 50; ++l)
    {
      const BSplineField field = random.Field(0.35, AllBorders[l % 2]);
      const PullBack pullBack(&field, kind, 1e-13);
      const glm::dvec3 p = random.Point(field, 2.5);
      PullBackStatus status;
      glm::dmat3 jacobian;
      const glm::dvec3 q = pullBack.Evaluate(p, jacobian, status);
      ASSERT_TRUE(status.Converged);
      EXPECT_LT(glm::distance(q, pullBack.Evaluate(p, status)), 1e-12);
      const glm::dmat3 found = pullBack.FindJacobian(p, q);
      for (int c = 0; c < 3; ++c)
      {
        EXPECT_LT(glm::distance(found[c], jacobian[c]), 1e-9);
        glm::dvec3 step(0.0);
        step[c] = 1e-5;
        const glm::dvec3 slope =
          (pullBack.Evaluate(p + step, status) - pullBack.Evaluate(p - step, status)) / 2e-5;
        EXPECT_LT(glm::distance(slope, jacobian[c]), 1e-5);
      }
    }
  }
}

TEST(PullBack, FirstOrderOfInverseMirrorsTheExactInverse)
{
  RandomLattice random(14);
  const BSplineField field = random.Field(0.4, BorderMode::Edge);
  for (int i = 0; i < 100; ++i)
  {
    const glm::dvec3 p = random.Point(field, 2.0);
    PullBackStatus status;
    const glm::dvec3 q = PullBack(&field, PullBackKind::Exact, 1e-9).Evaluate(p, status);
    EXPECT_LT(
      glm::distance(
        PullBack(&field, PullBackKind::FirstOrderOfInverse, 1e-9).Evaluate(p, status), 2.0 * p - q),
      1e-12);
  }
}

TEST(PullBack, FoldedLatticesGiveDefinedResults)
{
  RandomLattice random(15);
  int failed = 0;
  for (const BorderMode border : AllBorders)
  {
    for (int l = 0; l < 60; ++l)
    {
      const BSplineField field = random.Field(random.Number(0.8, 5.0), border);
      const PullBack exact(&field, PullBackKind::Exact, 1e-4);
      const PullBack mirrored(&field, PullBackKind::FirstOrderOfInverse, 1e-4);
      for (int i = 0; i < 20; ++i)
      {
        const glm::dvec3 p = random.Point(field, 4.0);
        PullBackStatus status;
        glm::dmat3 jacobian;
        const glm::dvec3 q = exact.Evaluate(p, jacobian, status);
        ASSERT_TRUE(IsFinite(q));
        ASSERT_TRUE(IsFinite(jacobian[0]) && IsFinite(jacobian[1]) && IsFinite(jacobian[2]));
        if (status.Converged)
        {
          ASSERT_LE(glm::distance(q + field.Displacement(q), p), 1.001e-4);
        }
        else
        {
          ++failed;
          glm::dmat3 slope;
          ASSERT_LT(glm::distance(q, p - field.Displacement(p, slope)), 1e-12);
          ASSERT_LT(glm::distance(jacobian[1], glm::dvec3(0, 1, 0) - slope[1]), 1e-12);
        }
        // Bounded work even where nothing converges.
        ASSERT_LT(status.Evaluations, 3000);
        const int evaluations = status.Evaluations;
        ASSERT_EQ(exact.Evaluate(p, status), q);
        ASSERT_EQ(status.Evaluations, evaluations);
        ASSERT_TRUE(IsFinite(mirrored.Evaluate(p, jacobian, status)));
      }
    }
  }
  EXPECT_GT(failed, 10);
}

TEST(PullBack, CollapsedLatticeFallsBackToFirstOrder)
{
  // D(X) = c - X for all X of the domain: T maps it all to the point c, J = 0.
  const glm::ivec3 nodes(6);
  const glm::dvec3 center(2.5);
  std::vector<glm::dvec3> d;
  for (int i = 0; i < 216; ++i)
  {
    d.push_back(center - glm::dvec3(i % 6, i / 6 % 6, i / 36));
  }
  const BSplineField field(nodes, glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  const PullBack exact(&field, PullBackKind::Exact, 1e-3);
  PullBackStatus status;
  glm::dmat3 jacobian;
  const glm::dvec3 p(2.0, 2.5, 3.0);
  const glm::dvec3 q = exact.Evaluate(p, jacobian, status);
  EXPECT_TRUE(IsFinite(q));
  if (!status.Converged)
  {
    EXPECT_LT(glm::distance(q, 2.0 * p - center), 1e-12);
  }
  // The center itself is reached, but with no inverse Jacobian there.
  EXPECT_TRUE(IsFinite(exact.Evaluate(center, jacobian, status)));
  EXPECT_FALSE(status.Converged);
  EXPECT_LT(glm::distance(jacobian[0], glm::dvec3(2, 0, 0)), 1e-9);
}

TEST(PullBack, HugeFinitePointsStayFinite)
{
  RandomLattice random(16);
  for (const BorderMode border : AllBorders)
  {
    const BSplineField field = random.Field(0.4, border);
    for (const PullBackKind kind : AllKinds)
    {
      PullBackStatus status;
      for (const double size : { 1e6, 1e12, 1e100, 1e200 })
      {
        const glm::dvec3 p(size, -size, 0.0);
        const glm::dvec3 q = PullBack(&field, kind, 1e-3).Evaluate(p, status);
        EXPECT_TRUE(IsFinite(q)) << size;
        EXPECT_LE(glm::distance(q / size, p / size), 1e-5) << size;
      }
    }
  }
}

TEST(SolveInverse, StartDoesNotMatterWhereTheInverseIsUnique)
{
  RandomLattice random(17);
  for (int l = 0; l < 100; ++l)
  {
    const BSplineField field = random.Field(0.35, AllBorders[l % 3]);
    const glm::dvec3 p = random.Point(field, 1.0);
    glm::dvec3 q1;
    glm::dvec3 q2;
    int evaluations = 0;
    ASSERT_TRUE(SolveInverse(field, p, p, 1e-11, q1, evaluations));
    ASSERT_TRUE(SolveInverse(field, p, random.Point(field, 2.0), 1e-11, q2, evaluations));
    EXPECT_LT(glm::distance(q1, q2), 1e-8);
    EXPECT_GE(evaluations, 2);
  }
}

// Where Newton's method alone does not arrive, the way from no displacement to the whole one mostly
// does, and the tangent leads along it: without it the corrector takes three times as much.
TEST(SolveInverse, ContinuationSolvesWhatNewtonDoesNot)
{
  RandomLattice random(16);
  int tried = 0;
  int solved = 0;
  int evaluations = 0;
  for (int l = 0; l < 300; ++l)
  {
    const BSplineField field = random.Field(2.0, AllBorders[l % 3]);
    for (int i = 0; i < 40; ++i)
    {
      const glm::dvec3 p = random.Point(field, 1.0);
      glm::dvec3 q;
      int byNewton = 0;
      if (SolveInverseNear(field, p, p, 1e-6, q, byNewton))
      {
        continue;
      }
      ++tried;
      int all = 0;
      if (SolveInverse(field, p, p, 1e-6, q, all))
      {
        ASSERT_LE(glm::distance(q + field.Displacement(q), p), 1.001e-6);
        ++solved;
        evaluations += all - byNewton;
      }
    }
  }
  EXPECT_GT(tried, 500);
  EXPECT_GT(solved, 0.9 * tried);
  EXPECT_LT(evaluations, 40 * solved);
}

TEST(SolveInverse, LargeSmoothDeformationsConverge)
{
  // A 100 degree bend about z over the lattice: far from its first-order inverse, no fold.
  const glm::ivec3 nodes(12, 6, 5);
  const double radius = 8.0;
  std::vector<glm::dvec3> d;
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      for (int i = 0; i < nodes.x; ++i)
      {
        const glm::dvec3 x(i - 5.5, j - 2.5, k - 2.0);
        const double angle = x.x / radius;
        const double r = radius - x.y;
        d.push_back(glm::dvec3(r * std::sin(angle), radius - r * std::cos(angle), x.z) - x);
      }
    }
  }
  const BSplineField field(nodes, glm::dvec3(-5.5, -2.5, -2.0), glm::dvec3(1.0), d.data());
  RandomLattice random(18);
  for (int i = 0; i < 300; ++i)
  {
    const glm::dvec3 x = random.Point(field, -1.0);
    const glm::dvec3 p = x + field.Displacement(x);
    PullBackStatus status;
    const glm::dvec3 q = PullBack(&field, PullBackKind::Exact, 1e-8).Evaluate(p, status);
    ASSERT_TRUE(status.Converged);
    EXPECT_LT(glm::distance(q + field.Displacement(q), p), 1.001e-8);
  }
}
