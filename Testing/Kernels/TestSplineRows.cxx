// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rows of displacements and Jacobians against the field, point by point.
#include "FFDSplineRows.h"

#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{

double LargestEntry(const glm::dmat3& m)
{
  double largest = 0.0;
  for (int e = 0; e < 9; ++e)
  {
    largest = std::max(largest, std::abs(m[e / 3][e % 3]));
  }
  return largest;
}

/// Every point of a few rows; returns whether the grid counts as aligned.
bool CheckRows(const ffd::BSplineField& field, const ffd::ImageGrid& grid, RandomLattice& random)
{
  const int first = random.Integer(-5, 5);
  const int last = first + random.Integer(0, 40);
  const ffd::SplineRows rows(field, grid, first, last);
  EXPECT_EQ(rows.GetCount(), last - first + 1);
  const glm::dmat3 factor(
    random.Vector(-2.0, 2.0), random.Vector(-2.0, 2.0), random.Vector(-2.0, 2.0));
  const std::size_t count = static_cast<std::size_t>(rows.GetCount());
  std::vector<double> x(count);
  std::vector<double> y(count);
  std::vector<double> z(count);
  std::vector<glm::dmat3> jacobians(count);
  ffd::SplineRows::Scratch scratch;
  for (int row = 0; row < 4; ++row)
  {
    const int j = random.Integer(-4, 9);
    const int k = random.Integer(-4, 9);
    rows.Displacements(j, k, factor, scratch, x.data(), y.data(), z.data());
    rows.Jacobians(j, k, scratch, jacobians.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      const glm::dvec3 p = grid.ToData(glm::dvec3(first + static_cast<int>(i), j, k));
      glm::dmat3 jacobian;
      const glm::dvec3 expected = factor * field.Displacement(p, jacobian);
      EXPECT_LT(glm::length(glm::dvec3(x[i], y[i], z[i]) - expected), 1e-12);
      EXPECT_LT(LargestEntry(jacobians[i] - jacobian), 1e-12);
    }
  }
  return rows.IsAligned();
}

} // namespace

TEST(SplineRows, EqualTheFieldOnGridsAlongItsAxes)
{
  RandomLattice random(11);
  for (int test = 0; test < 60; ++test)
  {
    const ffd::BSplineField field = random.Field(0.6, AllBorders[test % 3]);
    ffd::ImageGrid grid;
    grid.Origin = random.Point(field, 2.0);
    // Columns permuted and mirrored: rows along every axis.
    grid.IndexToData = glm::dmat3(0.0);
    for (int a = 0; a < 3; ++a)
    {
      const double step = random.Number(0.1, 1.2);
      grid.IndexToData[a][(a + test) % 3] = random.Integer(0, 1) ? step : -step;
    }
    EXPECT_TRUE(CheckRows(field, grid, random));
  }
}

TEST(SplineRows, EqualTheFieldOnTurnedGrids)
{
  RandomLattice random(12);
  for (int test = 0; test < 20; ++test)
  {
    const ffd::BSplineField field = random.Field(0.6, AllBorders[test % 3]);
    ffd::ImageGrid grid;
    grid.Origin = random.Point(field, 2.0);
    grid.IndexToData =
      glm::dmat3(random.Vector(0.1, 1.0), random.Vector(-1.0, -0.1), random.Vector(-1.0, 1.0));
    EXPECT_FALSE(CheckRows(field, grid, random));
    // Turned about the axis of the rows: still along it.
    grid.IndexToData =
      glm::dmat3(glm::dvec3(0.7, 0.0, 0.0), glm::dvec3(0.0, 0.5, 0.4), glm::dvec3(0.0, -0.4, 0.5));
    EXPECT_TRUE(CheckRows(field, grid, random));
  }
}

TEST(SplineRows, DoNotDependOnTheRange)
{
  RandomLattice random(13);
  const ffd::BSplineField field = random.Field(0.5, ffd::BorderMode::Edge);
  ffd::ImageGrid grid;
  grid.Origin = random.Point(field, 1.0);
  grid.IndexToData = glm::dmat3(0.31);
  const ffd::SplineRows whole(field, grid, -7, 33);
  const ffd::SplineRows part(field, grid, 5, 20);
  ffd::SplineRows::Scratch scratch;
  std::vector<double> a[3];
  std::vector<double> b[3];
  for (int c = 0; c < 3; ++c)
  {
    a[c].resize(41);
    b[c].resize(16);
  }
  whole.Displacements(3, 4, glm::dmat3(1.0), scratch, a[0].data(), a[1].data(), a[2].data());
  part.Displacements(3, 4, glm::dmat3(1.0), scratch, b[0].data(), b[1].data(), b[2].data());
  for (int c = 0; c < 3; ++c)
  {
    for (std::size_t i = 0; i < 16; ++i)
    {
      EXPECT_EQ(a[c][i + 12], b[c][i]);
    }
  }
}
