// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBSplineBasis.h"
#include "FFDBSplineField.h"
#include "RandomLattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace ffd;

namespace
{

/// A field whose coefficients are f at the control points.
BSplineField Sampled(const std::function<glm::dvec3(const glm::dvec3&)>& f, const glm::ivec3& nodes,
  const glm::dvec3& origin, const glm::dvec3& spacing)
{
  std::vector<glm::dvec3> d;
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      for (int i = 0; i < nodes.x; ++i)
      {
        d.push_back(f(origin + glm::dvec3(i, j, k) * spacing));
      }
    }
  }
  return BSplineField(nodes, origin, spacing, d.data());
}

} // namespace

TEST(BSplineBasis, WeightsSumToOneAndTheirDerivativesToZero)
{
  for (int i = 0; i <= 100; ++i)
  {
    const double u = i / 100.0;
    double w[4];
    double d[4];
    BSplineWeights(u, w);
    BSplineDerivativeWeights(u, d);
    EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1.0, 1e-15);
    EXPECT_NEAR(d[0] + d[1] + d[2] + d[3], 0.0, 1e-15);
    // Linear precision: the control points' abscissae reproduce the parameter.
    EXPECT_NEAR(-w[0] + w[2] + 2.0 * w[3], u, 1e-15);
    EXPECT_NEAR(-d[0] + d[2] + 2.0 * d[3], 1.0, 1e-15);
    for (double weight : w)
    {
      EXPECT_GE(weight, 0.0);
    }
  }
}

TEST(BSplineField, AffineNetGivesTheAffineMap)
{
  const glm::dmat3 a(
    glm::dvec3(0.1, -0.2, 0.05), glm::dvec3(0.3, 0.02, -0.1), glm::dvec3(0.0, 0.2, 0.15));
  const glm::dvec3 b(3.0, -4.0, 5.0);
  const auto affine = [&](const glm::dvec3& p) { return a * p + b; };
  const BSplineField field = Sampled(affine, { 6, 5, 7 }, { 1.0, -2.0, 3.0 }, { 0.5, 2.0, 1.25 });
  RandomLattice random(1);
  for (int i = 0; i < 200; ++i)
  {
    // One spacing inside, where no border coefficient takes part.
    const glm::dvec3 p = random.Point(field, -1.0);
    glm::dmat3 j;
    const glm::dvec3 d = field.Displacement(p, j);
    for (int r = 0; r < 3; ++r)
    {
      EXPECT_NEAR(d[r], affine(p)[r], 1e-12);
      EXPECT_NEAR(field.Displacement(p)[r], d[r], 1e-13);
      for (int c = 0; c < 3; ++c)
      {
        EXPECT_NEAR(j[c][r], a[c][r], 1e-12);
      }
    }
  }
}

TEST(BSplineField, QuadraticNetGivesTheQuadraticPlusAThird)
{
  // The uniform cubic B-spline with coefficients i^2 is x^2 + 1/3 (second moment of the basis).
  const BSplineField field = Sampled(
    [](const glm::dvec3& p) { return p * p; }, { 8, 8, 8 }, glm::dvec3(0.0), glm::dvec3(1.0));
  RandomLattice random(2);
  for (int i = 0; i < 100; ++i)
  {
    const glm::dvec3 p = random.Point(field, -1.0);
    glm::dmat3 j;
    const glm::dvec3 d = field.Displacement(p, j);
    for (int a = 0; a < 3; ++a)
    {
      EXPECT_NEAR(d[a], p[a] * p[a] + 1.0 / 3.0, 1e-12);
      EXPECT_NEAR(j[a][a], 2.0 * p[a], 1e-12);
    }
  }
}

TEST(BSplineField, JacobianIsTheDerivativeInEveryBorderMode)
{
  RandomLattice random(3);
  for (const BorderMode border : AllBorders)
  {
    for (int i = 0; i < 100; ++i)
    {
      const BSplineField field = random.Field(1.0, border, 1);
      const glm::dvec3 p = random.Point(field, 3.0);
      glm::dmat3 j;
      field.Displacement(p, j);
      for (int c = 0; c < 3; ++c)
      {
        glm::dvec3 step(0.0);
        step[c] = 1e-6;
        const glm::dvec3 slope =
          (field.Displacement(p + step) - field.Displacement(p - step)) / 2e-6;
        for (int r = 0; r < 3; ++r)
        {
          EXPECT_NEAR(slope[r], j[c][r], 1e-5);
        }
      }
    }
  }
}

TEST(BSplineField, OutsideTheBorderTheFieldIsConstantOrZero)
{
  RandomLattice random(4);
  for (const BorderMode border : AllBorders)
  {
    const BSplineField field = random.Field(1.0, border);
    const glm::dvec3 far = field.GetOrigin() - 100.0 * field.GetSpacing();
    const glm::dvec3 expected =
      border == BorderMode::Edge ? field.Coefficient(0, 0, 0) : glm::dvec3(0.0);
    for (int a = 0; a < 3; ++a)
    {
      EXPECT_NEAR(field.Displacement(far)[a], expected[a], 1e-14);
    }
  }
}

TEST(BSplineField, ZeroAndNaN)
{
  const BSplineField identity;
  EXPECT_TRUE(identity.IsZero());
  EXPECT_EQ(identity.Displacement(glm::dvec3(1e300, -5.0, 0.0)), glm::dvec3(0.0));
  RandomLattice random(5);
  const BSplineField field = random.Field(1.0, BorderMode::Edge);
  EXPECT_FALSE(field.IsZero());
  // Must not index with it.
  field.Displacement(glm::dvec3(std::nan("")));
  EXPECT_TRUE(std::isfinite(field.Displacement(glm::dvec3(-1e300, 1e300, 0.0)).x));
}

TEST(BSplineField, ExtendedLinearly)
{
  RandomLattice random(19);
  for (int run = 0; run < 20; ++run)
  {
    const BSplineField field = random.Field(1.0, AllBorders[run % 3]);
    const int cells = run % 5;
    const BSplineField extended = ExtendLinearly(field, glm::ivec3(cells));
    EXPECT_EQ(extended.GetNodes(), field.GetNodes() + 2 * cells);
    const glm::dvec3 low = field.GetOrigin() + field.GetSpacing();
    const glm::dvec3 high =
      field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes() - 2);
    for (int i = 0; i < 50; ++i)
    {
      const glm::dvec3 p = glm::mix(low, high, random.Vector(0.0, 1.0));
      EXPECT_LT(glm::distance(extended.Displacement(p), field.Displacement(p)), 1e-12);
      // On a line across each face D is linear, from the outermost control point on.
      for (int a = 0; a < 3 && cells > 1; ++a)
      {
        glm::dvec3 q[3] = { p, p, p };
        for (int n = 0; n < 3; ++n)
        {
          q[n][a] = field.GetOrigin()[a] - field.GetSpacing()[a] * (cells - 1) * 0.5 * n;
        }
        const glm::dvec3 second = extended.Displacement(q[0]) - 2.0 * extended.Displacement(q[1]) +
          extended.Displacement(q[2]);
        EXPECT_LT(glm::length(second), 1e-9);
      }
    }
  }
}
