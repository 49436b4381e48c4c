// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDJacobianDeterminant.h"
#include "RandomLattice.h"

#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <vector>

using namespace ffd;

namespace
{

Range OverDomain(const BSplineField& field, double tolerance = 1e-3)
{
  return BoundJacobianDeterminant(field, glm::ivec3(1), field.GetNodes() - 2, tolerance);
}

double DeterminantAt(const BSplineField& field, const glm::dvec3& p)
{
  glm::dmat3 jacobian;
  field.Displacement(p, jacobian);
  return glm::determinant(glm::dmat3(1.0) + jacobian);
}

/// Displacement along one axis only, given per control-point index of that axis.
BSplineField AlongAxis(int axis, const std::vector<double>& d)
{
  const int n = static_cast<int>(d.size());
  std::vector<glm::dvec3> values(static_cast<std::size_t>(n * n * n), glm::dvec3(0.0));
  for (int i = 0; i < n * n * n; ++i)
  {
    const int index[3] = { i % n, i / n % n, i / (n * n) };
    values[static_cast<std::size_t>(i)][axis] = d[static_cast<std::size_t>(index[axis])];
  }
  return BSplineField(glm::ivec3(n), glm::dvec3(0.0), glm::dvec3(1.0), values.data());
}

} // namespace

TEST(JacobianDeterminant, ContainsSamplesAndIsTight)
{
  RandomLattice random(41);
  for (int l = 0; l < 60; ++l)
  {
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.0, 0.3)), AllBorders[l % 3]);
    const Range range = OverDomain(field);
    Range sampled{ 1e300, -1e300 };
    for (int i = 0; i < 20000; ++i)
    {
      const double value = DeterminantAt(field, random.Point(field, -1.0));
      sampled.Min = std::min(sampled.Min, value);
      sampled.Max = std::max(sampled.Max, value);
    }
    ASSERT_LE(range.Min, sampled.Min);
    ASSERT_GE(range.Max, sampled.Max);
    // Sampling finds the extremes up to some 5 percent; the bound promises 1e-3.
    const double extent = std::max(1.0, sampled.Max - sampled.Min);
    EXPECT_LT(sampled.Min - range.Min, 0.08 * extent);
    EXPECT_LT(range.Max - sampled.Max, 0.08 * extent);
  }
}

TEST(JacobianDeterminant, WholeSupportInEveryBorderMode)
{
  RandomLattice random(42);
  for (const BorderMode border : AllBorders)
  {
    const BSplineField field = random.Field(0.7, border);
    const Range range = BoundJacobianDeterminant(field, field.GetFirstCell(), field.GetEndCell());
    for (int i = 0; i < 5000; ++i)
    {
      const double value = DeterminantAt(field, random.Point(field, 1.99));
      if (border != BorderMode::ZeroAtBorder)
      {
        ASSERT_LE(range.Min, value);
        ASSERT_GE(range.Max, value);
      }
    }
  }
}

TEST(JacobianDeterminant, SignIsThatOfTheBounds)
{
  RandomLattice random(7);
  int positive = 0;
  int folded = 0;
  for (int n = 0; n < 40; ++n)
  {
    const BSplineField field = random.Field(0.1 * n, AllBorders[n % 3]);
    const glm::ivec3 first = field.GetFirstCell();
    const glm::ivec3 end = field.GetEndCell();
    const bool isPositive = HasPositiveJacobian(field, first, end);
    const double least = BoundJacobianDeterminant(field, first, end).Min;
    // What is closer to the sign than these bounds are to the truth may be proven.
    ASSERT_TRUE(isPositive || least <= 0.0) << n;
    ASSERT_FALSE(isPositive && least < -0.1) << n;
    positive += isPositive ? 1 : 0;
    folded += isPositive ? 0 : 1;
  }
  EXPECT_GT(positive, 5);
  EXPECT_GT(folded, 5);
}

// Determinants that cannot be told from zero take no search.
TEST(JacobianDeterminant, SquashedVolumesAreToldAtOnce)
{
  for (const glm::dvec3& scale : { glm::dvec3(1.0, 1.0, 1e-9), glm::dvec3(3e-4), glm::dvec3(1e-3) })
  {
    const int n = 8;
    std::vector<glm::dvec3> values;
    for (int i = 0; i < n * n * n; ++i)
    {
      values.push_back((scale - 1.0) * glm::dvec3(i % n, i / n % n, i / n / n));
    }
    const BSplineField field(glm::ivec3(n), glm::dvec3(0.0), glm::dvec3(1.0), values.data());
    const std::clock_t begin = std::clock();
    EXPECT_FALSE(HasPositiveJacobian(field, field.GetFirstCell(), field.GetEndCell()));
    EXPECT_LT(std::clock() - begin, 2 * CLOCKS_PER_SEC);
  }
}

TEST(JacobianDeterminant, AffineAndIdentityAreExact)
{
  const BSplineField identity;
  EXPECT_EQ(OverDomain(identity).Min, 1.0);
  EXPECT_EQ(OverDomain(identity).Max, 1.0);
  // x shrinks to 0.25: det J = 0.25 in all of the domain.
  std::vector<double> d;
  for (int i = 0; i < 7; ++i)
  {
    d.push_back(-0.75 * i);
  }
  const Range range = OverDomain(AlongAxis(0, d), 1e-7);
  EXPECT_NEAR(range.Min, 0.25, 1e-6);
  EXPECT_NEAR(range.Max, 0.25, 1e-6);
}

// In one dimension the derivative of the spline is a mean of neighbor differences: it stays
// positive while neighbors keep their order, and loses that just past the limit when three
// neighboring differences exceed it.
TEST(JacobianDeterminant, CompressionFoldsExactlyPastItsLimit)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    for (const double step : { 0.999, 1.001 })
    {
      std::vector<double> d(9, 0.0);
      for (int i = 0; i < 9; ++i)
      {
        // Four control points in a row that each approach their neighbor by `step`.
        d[static_cast<std::size_t>(i)] = -step * std::clamp(i - 2, 0, 4);
      }
      const Range range = OverDomain(AlongAxis(axis, d), 1e-7);
      EXPECT_NEAR(range.Min, 1.0 - step, 1e-5);
      EXPECT_EQ(range.Min > 0.0, step < 1.0);
      EXPECT_EQ(HasPositiveJacobian(AlongAxis(axis, d), glm::ivec3(1), glm::ivec3(7)), step < 1.0);
    }
  }
}

TEST(JacobianDeterminant, ShearNeverFolds)
{
  // x displaced as a function of y only: det J = 1 for any strength.
  const int n = 6;
  std::vector<glm::dvec3> values(n * n * n, glm::dvec3(0.0));
  for (int i = 0; i < n * n * n; ++i)
  {
    values[static_cast<std::size_t>(i)].x = (i / n) % 2 == 0 ? 5.0 : -5.0;
  }
  const BSplineField field(glm::ivec3(n), glm::dvec3(0.0), glm::dvec3(1.0), values.data());
  const Range range = OverDomain(field);
  EXPECT_NEAR(range.Min, 1.0, 1e-4);
  EXPECT_NEAR(range.Max, 1.0, 1e-4);
}

// Choi and Lee, "Injectivity conditions of 2D and 3D uniform cubic B-spline functions" (2000):
// in three dimensions displacements below 1 / 2.4797 = 0.403 spacings per axis cannot fold.
TEST(JacobianDeterminant, SmallDisplacementsNeverFold)
{
  RandomLattice random(43);
  for (int l = 0; l < 100; ++l)
  {
    EXPECT_GT(OverDomain(random.Field(0.4, BorderMode::Edge)).Min, 0.0);
  }
}

TEST(JacobianDeterminant, NonFiniteCoefficientsAreUnbounded)
{
  std::vector<glm::dvec3> d(64, glm::dvec3(0.0));
  d[3].z = std::nan("");
  const BSplineField field(glm::ivec3(4), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  EXPECT_TRUE(std::isinf(OverDomain(field).Min));
  EXPECT_TRUE(std::isinf(OverDomain(field).Max));
}

TEST(JacobianDeterminant, HugeCoefficientsAreUnboundedAtOnce)
{
  // Of 1000 cells, none of which needs to be subdivided to know that.
  std::vector<double> displacements(13, 0.0);
  for (std::size_t i = 0; i < displacements.size(); i += 2)
  {
    displacements[i] = 1e300;
  }
  std::vector<glm::dvec3> values(13 * 13 * 13);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] =
      glm::dvec3(displacements[i % 13], displacements[i / 13 % 13], displacements[i / 169]);
  }
  const BSplineField field(glm::ivec3(13), glm::dvec3(0.0), glm::dvec3(1.0), values.data());
  const std::clock_t begin = std::clock();
  const Range range = OverDomain(field);
  EXPECT_EQ(range.Min, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(range.Max, std::numeric_limits<double>::infinity());
  // Minutes, when each cell is subdivided.
  EXPECT_LT(std::clock() - begin, 10 * CLOCKS_PER_SEC);
}
