// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBSplineField.h"
#include "FFDControlNet.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace ffd;

TEST(ControlNet, RefinementKeepsTheSplineOverTheDomain)
{
  RandomLattice random(31);
  for (int l = 0; l < 60; ++l)
  {
    const BSplineField coarse = random.Field(1.0, BorderMode::Edge);
    const glm::ivec3 n = coarse.GetNodes();
    ControlNet net;
    net.Nodes = n;
    for (int i = 0; i < n.x * n.y * n.z; ++i)
    {
      net.Values.push_back(coarse.Coefficient(i % n.x, i / n.x % n.y, i / (n.x * n.y)));
    }
    const glm::ivec3 factors(random.Integer(1, 4), random.Integer(1, 3), random.Integer(1, 2));
    const ControlNet fine = RefineControlNet(net, factors);
    ASSERT_EQ(fine.Nodes, (n - 3) * factors + 3);
    const glm::dvec3 spacing = coarse.GetSpacing() / glm::dvec3(factors);
    const BSplineField refined(
      fine.Nodes, coarse.GetOrigin() + coarse.GetSpacing() - spacing, spacing, fine.Values.data());
    for (int i = 0; i < 100; ++i)
    {
      const glm::dvec3 p = random.Point(coarse, -1.0);
      EXPECT_LT(glm::distance(coarse.Displacement(p), refined.Displacement(p)), 1e-13 * 20.0);
    }
  }
}

TEST(ControlNet, FactorOneChangesNothing)
{
  ControlNet net{ glm::ivec3(4), std::vector<glm::dvec3>(64, glm::dvec3(1, 2, 3)) };
  net.Values[7].x = 9.0;
  const ControlNet same = RefineControlNet(net, glm::ivec3(1));
  EXPECT_EQ(same.Nodes, net.Nodes);
  EXPECT_EQ(same.Values, net.Values);
}

TEST(ControlNet, InterpolationMeetsTheSamples)
{
  RandomLattice random(32);
  for (int l = 0; l < 60; ++l)
  {
    ControlNet samples;
    samples.Nodes = { random.Integer(2, 8), random.Integer(2, 8), random.Integer(2, 8) };
    const int count = samples.Nodes.x * samples.Nodes.y * samples.Nodes.z;
    for (int i = 0; i < count; ++i)
    {
      samples.Values.push_back(random.Vector(-1.0, 1.0));
    }
    const ControlNet net = InterpolateControlNet(samples);
    ASSERT_EQ(net.Nodes, samples.Nodes + 2);
    const BSplineField field(net.Nodes, glm::dvec3(0.0), glm::dvec3(1.0), net.Values.data());
    for (int i = 0; i < count; ++i)
    {
      const glm::ivec3 s(i % samples.Nodes.x, i / samples.Nodes.x % samples.Nodes.y,
        i / (samples.Nodes.x * samples.Nodes.y));
      EXPECT_LT(glm::distance(field.Displacement(glm::dvec3(s + 1)),
                  samples.Values[static_cast<std::size_t>(i)]),
        1e-10);
    }
  }
}

TEST(ControlNet, InterpolationReproducesPolynomials)
{
  // Linear with any number of samples, quadratic from three, cubic from four on.
  for (int m = 2; m <= 9; ++m)
  {
    for (int degree = 1; degree <= std::min(m - 1, 3); ++degree)
    {
      const auto f = [&](double x) { return std::pow(x - 2.5, degree) + 0.5 * x - 1.0; };
      ControlNet samples;
      samples.Nodes = { m, 2, 3 };
      for (int i = 0; i < m * 6; ++i)
      {
        samples.Values.push_back(glm::dvec3(f(i % m + 1), i / m % 2, i / (2 * m)));
      }
      const ControlNet net = InterpolateControlNet(samples);
      const BSplineField field(net.Nodes, glm::dvec3(0.0), glm::dvec3(1.0), net.Values.data());
      for (double x = 1.0; x <= m; x += 0.21)
      {
        const glm::dvec3 d = field.Displacement(glm::dvec3(x, 1.3, 2.2));
        EXPECT_NEAR(d.x, f(x), 1e-10 * std::pow(m, 3)) << m << " " << degree << " " << x;
        EXPECT_NEAR(d.y, 0.3, 1e-12);
        EXPECT_NEAR(d.z, 1.2, 1e-12);
      }
    }
  }
}

TEST(ControlNet, InterpolationErrorIsOfFourthOrder)
{
  const auto error = [](int cells) {
    ControlNet samples;
    samples.Nodes = { cells + 1, 2, 2 };
    for (int i = 0; i < 4 * (cells + 1); ++i)
    {
      samples.Values.push_back(glm::dvec3(std::sin(6.0 * (i % (cells + 1)) / cells), 0, 0));
    }
    const ControlNet net = InterpolateControlNet(samples);
    const BSplineField field(net.Nodes, glm::dvec3(0.0), glm::dvec3(1.0), net.Values.data());
    double worst = 0.0;
    for (int i = 0; i <= 1000; ++i)
    {
      const double x = cells * i / 1000.0;
      const double d = field.Displacement(glm::dvec3(1.0 + x, 1.5, 1.5)).x;
      worst = std::max(worst, std::abs(d - std::sin(6.0 * x / cells)));
    }
    return worst;
  };
  // Up to the ends, where natural conditions would give a factor of 4.
  EXPECT_GT(error(16) / error(32), 12.0);
}
