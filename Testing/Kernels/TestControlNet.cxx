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

ControlNet MakeRandomNet(RandomLattice& random, const glm::ivec3& nodes)
{
  ControlNet net{ nodes, {} };
  for (int i = 0; i < nodes.x * nodes.y * nodes.z; ++i)
  {
    net.Values.push_back(random.Vector(-1.0, 1.0));
  }
  return net;
}

/// The field of a net over the unit cube.
BSplineField MakeUnitField(const ControlNet& net)
{
  const glm::dvec3 spacing = 1.0 / glm::dvec3(net.Nodes - 3);
  return BSplineField(net.Nodes, -spacing, spacing, net.Values.data());
}

double FindMeanSquareError(const ControlNet& one, const ControlNet& other)
{
  const BSplineField a = MakeUnitField(one);
  const BSplineField b = MakeUnitField(other);
  constexpr int Count = 9;
  double sum = 0.0;
  for (int i = 0; i < Count * Count * Count; ++i)
  {
    const glm::dvec3 p =
      (glm::dvec3(i % Count, i / Count % Count, i / (Count * Count)) + 0.5) / double{ Count };
    const glm::dvec3 d = a.Displacement(p) - b.Displacement(p);
    sum += glm::dot(d, d);
  }
  return sum / (Count * Count * Count);
}

double FindLargestValue(const ControlNet& net)
{
  double largest = 0.0;
  for (const glm::dvec3& value : net.Values)
  {
    largest = std::max(largest, glm::length(value));
  }
  return largest;
}

TEST(ControlNet, ResizingReproducesAffineMaps)
{
  const glm::ivec3 from(6, 9, 5);
  for (const glm::ivec3& to : { glm::ivec3(4), glm::ivec3(5, 8, 7), glm::ivec3(10, 4, 13) })
  {
    ControlNet nets[2];
    for (const bool resized : { false, true })
    {
      ControlNet& net = nets[resized ? 1 : 0];
      net.Nodes = resized ? to : from;
      for (int i = 0; i < net.Nodes.x * net.Nodes.y * net.Nodes.z; ++i)
      {
        const glm::ivec3 node(
          i % net.Nodes.x, i / net.Nodes.x % net.Nodes.y, i / (net.Nodes.x * net.Nodes.y));
        const glm::dvec3 p = glm::dvec3(node - 1) / glm::dvec3(net.Nodes - 3);
        net.Values.push_back({ 3.0 * p.x - p.y, 2.0 + p.z * p.y, p.x + 5.0 * p.z });
      }
    }
    const ControlNet found = ResizeControlNet(nets[0], to);
    ASSERT_EQ(found.Nodes, to);
    for (std::size_t i = 0; i < found.Values.size(); ++i)
    {
      EXPECT_LT(glm::distance(found.Values[i], nets[1].Values[i]), 1e-7);
    }
  }
}

TEST(ControlNet, ResizingUndoesRefinement)
{
  RandomLattice random(34);
  for (const glm::ivec3& nodes : { glm::ivec3(4), glm::ivec3(5, 4, 7), glm::ivec3(9, 8, 6) })
  {
    const ControlNet net = MakeRandomNet(random, nodes);
    for (const glm::ivec3& factors : { glm::ivec3(2), glm::ivec3(1, 3, 4), glm::ivec3(5, 1, 2) })
    {
      const ControlNet back = ResizeControlNet(RefineControlNet(net, factors), nodes);
      ASSERT_EQ(back.Nodes, nodes);
      for (std::size_t i = 0; i < net.Values.size(); ++i)
      {
        EXPECT_LT(glm::distance(back.Values[i], net.Values[i]), 1e-6);
      }
    }
  }
}

/// What a spline that takes the values at the new control points in the domain would be.
ControlNet ResizeByInterpolation(const ControlNet& net, const glm::ivec3& nodes)
{
  const BSplineField field = MakeUnitField(net);
  ControlNet samples;
  samples.Nodes = nodes - 2;
  for (int i = 0; i < samples.Nodes.x * samples.Nodes.y * samples.Nodes.z; ++i)
  {
    const glm::ivec3 node(i % samples.Nodes.x, i / samples.Nodes.x % samples.Nodes.y,
      i / (samples.Nodes.x * samples.Nodes.y));
    samples.Values.push_back(field.Displacement(glm::dvec3(node) / glm::dvec3(nodes - 3)));
  }
  return InterpolateControlNet(samples);
}

TEST(ControlNet, ResizingIsNearerThanInterpolation)
{
  RandomLattice random(35);
  const ControlNet rough = MakeRandomNet(random, glm::ivec3(8));
  ControlNet smooth = rough; // half a wave, as bent
  for (int i = 0; i < 512; ++i)
  {
    const double z = (i / 64 - 1) / 5.0 - 0.5;
    smooth.Values[static_cast<std::size_t>(i)] = { std::cos(3.14 * z), 0.0, 0.0 };
  }
  for (const int size : { 4, 5, 6, 7, 9, 12 })
  {
    SCOPED_TRACE(size);
    for (const ControlNet* net : { &rough, static_cast<const ControlNet*>(&smooth) })
    {
      const ControlNet found = ResizeControlNet(*net, glm::ivec3(size));
      const ControlNet other = ResizeByInterpolation(*net, glm::ivec3(size));
      const double error = FindMeanSquareError(found, *net);
      // Of the smooth shape next to nothing is lost by more control points.
      EXPECT_LT(error,
        net == &rough ? 0.9 * FindMeanSquareError(other, *net)
          : size < 8  ? 0.4 * FindMeanSquareError(other, *net)
                      : 1e-6);
    }
    // Control points that hardly count in the domain do not fly away. (Without what holds them
    // they were 40 to 7000 times as far as they had been.)
    EXPECT_LT(FindLargestValue(ResizeControlNet(rough, glm::ivec3(size))),
      (size < 6 ? 20.0 : 6.0) * FindLargestValue(rough));
  }
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

TEST(ControlNet, SamplesAreThoseOfTheSpline)
{
  RandomLattice random(36);
  for (int l = 0; l < 60; ++l)
  {
    const ControlNet net =
      MakeRandomNet(random, { random.Integer(4, 8), random.Integer(4, 8), random.Integer(4, 8) });
    const BSplineField field(net.Nodes, glm::dvec3(0.0), glm::dvec3(1.0), net.Values.data());
    const glm::ivec3 perCell(random.Integer(1, 4), random.Integer(1, 4), random.Integer(1, 4));
    const ControlNet samples = SampleControlNet(net, perCell);
    const glm::ivec3 n = samples.Nodes;
    ASSERT_EQ(n, (net.Nodes - 3) * perCell + 1);
    ASSERT_EQ(samples.Values.size(), static_cast<std::size_t>(n.x) * n.y * n.z);
    for (int i = 0; i < n.x * n.y * n.z; ++i)
    {
      const glm::dvec3 p =
        1.0 + glm::dvec3(i % n.x, i / n.x % n.y, i / (n.x * n.y)) / glm::dvec3(perCell);
      EXPECT_LT(
        glm::distance(field.Displacement(p), samples.Values[static_cast<std::size_t>(i)]), 1e-14);
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
