// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDJacobianDeterminant.h"
#include "FFDBSplineField.h"
#include "FFDFoldGuard.h"
#include "RandomLattice.h"

#include <glm/matrix.hpp>
#include <gtest/gtest.h>

using namespace ffd;

namespace
{

ControlNet Zeros(int n)
{
  return { glm::ivec3(n), std::vector<glm::dvec3>(static_cast<std::size_t>(n * n * n)) };
}

double Smallest(const ControlNet& net, const glm::dvec3& spacing)
{
  const BSplineField field(net.Nodes, glm::dvec3(0.0), spacing, net.Values.data());
  return BoundJacobianDeterminant(field, glm::ivec3(1), net.Nodes - 2, 1e-3).Min;
}

ControlNet Mix(const ControlNet& a, const ControlNet& b, double t)
{
  ControlNet mixed = a;
  for (std::size_t n = 0; n < mixed.Values.size(); ++n)
  {
    mixed.Values[n] += t * (b.Values[n] - a.Values[n]);
  }
  return mixed;
}

} // namespace

TEST(FoldGuard, ShearedSlabStopsAtItsClosedForm)
{
  // All control points compressed along x: D_x = -c x, so det J = 1 - c everywhere in the domain.
  const glm::dvec3 spacing(2.0, 1.0, 0.5);
  ControlNet after = Zeros(6);
  for (int i = 0; i < 216; ++i)
  {
    after.Values[static_cast<std::size_t>(i)].x = -2.0 * spacing.x * (i % 6);
  }
  // det J = 1 - 2 t on the way: 0.1 is reached at t = 0.45.
  const FoldLimit limit = LimitFold(Zeros(6), after, spacing, 0.1);
  EXPECT_LE(limit.Fraction, 0.45);
  EXPECT_GT(limit.Fraction, 0.45 - 0.01);
  EXPECT_GE(limit.Determinant, 0.1);
  EXPECT_NEAR(limit.Determinant, 1.0 - 2.0 * limit.Fraction, 0.011);
}

TEST(FoldGuard, WhatDoesNotFoldIsLeftAlone)
{
  RandomLattice random(81);
  for (int l = 0; l < 20; ++l)
  {
    // Choi and Lee: below 0.4 spacings nothing folds.
    ControlNet after = Zeros(7);
    for (glm::dvec3& d : after.Values)
    {
      d = 0.3 * random.Vector(-1.0, 1.0);
    }
    const FoldLimit limit = LimitFold(Zeros(7), after, glm::dvec3(1.0), 0.0);
    EXPECT_EQ(limit.Fraction, 1.0);
    EXPECT_LE(limit.Determinant, Smallest(after, glm::dvec3(1.0)) + 2e-3);
  }
  EXPECT_EQ(LimitFold(Zeros(5), Zeros(5), glm::dvec3(1.0), 0.5).Fraction, 1.0);
}

TEST(FoldGuard, TheStateAtTheLimitIsUnfoldedAndNearIt)
{
  RandomLattice random(82);
  int clamped = 0;
  for (int l = 0; l < 40; ++l)
  {
    ControlNet before = Zeros(8);
    for (glm::dvec3& d : before.Values)
    {
      d = 0.15 * random.Vector(-1.0, 1.0);
    }
    ControlNet after = before;
    // One control point, anywhere, far.
    after.Values[static_cast<std::size_t>(random.Integer(0, 511))] += random.Vector(-6.0, 6.0);
    const double minimum = 0.05;
    ASSERT_GE(Smallest(before, glm::dvec3(1.0)), minimum);
    const FoldLimit limit = LimitFold(before, after, glm::dvec3(1.0), minimum);
    EXPECT_GE(Smallest(Mix(before, after, limit.Fraction), glm::dvec3(1.0)), minimum);
    if (limit.Fraction < 1.0)
    {
      ++clamped;
      EXPECT_GT(limit.Fraction, 0.0);
      // A little farther it no longer is (bound within 1 %, bisection within 1/256).
      EXPECT_LT(Smallest(Mix(before, after, limit.Fraction + 2.0 / 256.0), glm::dvec3(1.0)),
        minimum + 0.04);
    }
  }
  EXPECT_GT(clamped, 15);
}

TEST(FoldGuard, AFoldedLatticeMayBeUnfoldedButNotFoldedFurther)
{
  ControlNet folded = Zeros(6);
  folded.Values[6 * 36 / 2 + 15] = { 5.0, 0.0, 0.0 };
  ASSERT_LT(Smallest(folded, glm::dvec3(1.0)), 0.0);
  ControlNet worse = Mix(Zeros(6), folded, 1.5);
  EXPECT_LT(LimitFold(folded, worse, glm::dvec3(1.0), 0.0).Fraction, 0.05);
  ControlNet better = Mix(Zeros(6), folded, 0.8);
  EXPECT_EQ(LimitFold(folded, better, glm::dvec3(1.0), 0.0).Fraction, 1.0);
}

TEST(FoldGuard, CornersOutsideTheDomainCannotFoldIt)
{
  // Control point 0 of 4 per axis touches the one cell of the domain; of a corner that is far from
  // a cell nothing is asked.
  ControlNet after = Zeros(4);
  after.Values[0] = glm::dvec3(50.0);
  EXPECT_LT(LimitFold(Zeros(4), after, glm::dvec3(1.0), 0.1).Fraction, 1.0);
  after = Zeros(4);
  after.Values[0] = glm::dvec3(1e-3);
  EXPECT_EQ(LimitFold(Zeros(4), after, glm::dvec3(1.0), 0.1).Fraction, 1.0);
}
