// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The lattice as a value, and its map: what keeps the map keeps it, bounds hold, bad values are
// named.
#include "FFDFunctionFit.h"
#include "FFDGridIndex.h"
#include "FFDLattice.h"
#include "FFDLatticeMap.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

using namespace ffd;

namespace
{

Lattice MakeRandom(RandomLattice& random, double amount, BorderMode border = BorderMode::Edge)
{
  // One after the other: the order of arguments differs between processors.
  const glm::dvec3 low = random.Vector(-20.0, 20.0);
  const glm::dvec3 size = random.Vector(3.0, 20.0);
  glm::ivec3 nodes;
  for (int a = 0; a < 3; ++a)
  {
    nodes[a] = random.Integer(4, 7);
  }
  Lattice lattice(nodes, { low, low + size });
  for (glm::dvec3& d : lattice.Net.Values)
  {
    d = amount * random.Vector(-1.0, 1.0) * lattice.Spacing;
  }
  lattice.Border = border;
  return lattice;
}

/// A point of the domain, or up to `margin` spacings outside.
glm::dvec3 MakePoint(RandomLattice& random, const Lattice& lattice, double margin = 0.0)
{
  const Box domain = lattice.GetDomain();
  return glm::mix(domain.Min - margin * lattice.Spacing, domain.Max + margin * lattice.Spacing,
    random.Vector(0.0, 1.0));
}

double LargestDifference(
  RandomLattice& random, const Lattice& a, const Lattice& b, double margin = 0.0)
{
  const BSplineField first = a.MakeField();
  const BSplineField second = b.MakeField();
  double largest = 0.0;
  for (int n = 0; n < 200; ++n)
  {
    const glm::dvec3 p = MakePoint(random, a, margin);
    largest = std::max(largest, glm::length(first.Displacement(p) - second.Displacement(p)));
  }
  return largest;
}

bool IsSame(const Lattice& a, const Lattice& b)
{
  return a.Net.Nodes == b.Net.Nodes && a.Net.Values == b.Net.Values && a.Origin == b.Origin &&
    a.Spacing == b.Spacing && a.Border == b.Border && a.Scale == b.Scale && a.Inverse == b.Inverse;
}

} // namespace

TEST(Lattice, DefaultIsTheIdentityOverTheUnitCube)
{
  const Lattice lattice;
  EXPECT_EQ(lattice.FindProblem(), "");
  EXPECT_EQ(lattice.Net.Nodes, glm::ivec3(4));
  EXPECT_EQ(lattice.GetDomain().Min, glm::dvec3(0.0));
  EXPECT_EQ(lattice.GetDomain().Max, glm::dvec3(1.0));
  EXPECT_TRUE(lattice.IsIdentity());
  EXPECT_TRUE(lattice.MakeField().IsZero());
}

TEST(Lattice, ControlPointsAreNumberedXFastest)
{
  Lattice lattice({ 4, 5, 6 }, { glm::dvec3(0.0), { 2.0, 6.0, 12.0 } });
  std::size_t index = 0;
  for (int k = 0; k < 6; ++k)
  {
    for (int j = 0; j < 5; ++j)
    {
      for (int i = 0; i < 4; ++i, ++index)
      {
        ASSERT_EQ(lattice.IndexOf({ i, j, k }), index);
        ASSERT_EQ(lattice.IndicesOf(index), glm::ivec3(i, j, k));
        ASSERT_TRUE(lattice.HasPoint({ i, j, k }));
      }
    }
  }
  EXPECT_EQ(index, lattice.Net.Values.size());
  EXPECT_FALSE(lattice.HasPoint({ 4, 0, 0 }));
  EXPECT_FALSE(lattice.HasPoint({ 0, -1, 0 }));
  EXPECT_EQ(lattice.GetRestPoint({ 1, 1, 1 }), glm::dvec3(0.0));
  EXPECT_EQ(lattice.GetRestPoint({ 2, 3, 4 }), glm::dvec3(2.0, 6.0, 12.0));
  lattice.Net.Values[lattice.IndexOf({ 2, 3, 4 })] = { 1.0, 2.0, 3.0 };
  EXPECT_EQ(lattice.GetControlPoint(lattice.IndexOf({ 2, 3, 4 })), glm::dvec3(3.0, 8.0, 15.0));
  const std::vector<glm::dvec3> points = lattice.GetControlPoints();
  ASSERT_EQ(points.size(), index);
  for (std::size_t p = 0; p < index; ++p)
  {
    ASSERT_EQ(points[p], lattice.GetControlPoint(p));
  }
}

TEST(Lattice, ProblemsAreNamed)
{
  const auto expect = [](const char* words, void (*spoil)(Lattice&)) {
    Lattice lattice;
    spoil(lattice);
    EXPECT_NE(lattice.FindProblem().find(words), std::string::npos)
      << "'" << lattice.FindProblem() << "' does not say: " << words;
  };
  expect("axis 1 has 3", [](Lattice& l) { l.Net.Nodes.y = 3; });
  expect("axis 2 has 1025", [](Lattice& l) { l.Net.Nodes.z = 1025; });
  expect("64 displacements for 80", [](Lattice& l) { l.Net.Nodes.x = 5; });
  expect("spacing positive", [](Lattice& l) { l.Spacing.x = 0.0; });
  expect("spacing positive", [](Lattice& l) { l.Spacing.y = -1.0; });
  expect("finite", [](Lattice& l) { l.Origin.z = std::nan(""); });
  expect("scale is not finite", [](Lattice& l) { l.Scale = std::nan(""); });
  expect("control point 5", [](Lattice& l) { l.Net.Values[5].y = std::nan(""); });
  expect("control point 63", [](Lattice& l) { l.Net.Values[63].z = -1.1e100; });
  expect("control point 7", [](Lattice& l) {
    l.Net.Values[7].x = 1e99;
    l.Scale = -11.0;
  });
  expect("border mode is 3", [](Lattice& l) { l.Border = static_cast<BorderMode>(3); });
}

TEST(Lattice, DomainMovesTheControlPointsAndKeepsDisplacements)
{
  RandomLattice random(1);
  Lattice lattice = MakeRandom(random, 0.3);
  const std::vector<glm::dvec3> displacements = lattice.Net.Values;
  EXPECT_EQ(lattice.SetDomain({ { 1.0, 2.0, 3.0 }, { 5.0, 7.0, 9.0 } }), -1);
  EXPECT_LT(glm::length(lattice.GetDomain().Min - glm::dvec3(1.0, 2.0, 3.0)), 1e-12);
  EXPECT_LT(glm::length(lattice.GetDomain().Max - glm::dvec3(5.0, 7.0, 9.0)), 1e-12);
  EXPECT_EQ(lattice.Net.Values, displacements);

  const Lattice before = lattice;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const glm::dvec3 zero(0.0);
  EXPECT_EQ(lattice.SetDomain({ zero, { 1.0, 0.0, 1.0 } }), 1);
  EXPECT_EQ(lattice.SetDomain({ zero, { 1.0, 1.0, -1.0 } }), 2);
  EXPECT_EQ(lattice.SetDomain({ { nan, 0.0, 0.0 }, glm::dvec3(1.0) }), 0);
  EXPECT_EQ(lattice.SetDomain({ zero, { 1.0, 1e101, 1.0 } }), 1);
  // The spacing is lost, except along an axis of one cell.
  EXPECT_GE(lattice.SetDomain({ glm::dvec3(1e17), glm::dvec3(1e17 + 16.0) }), 0);
  EXPECT_TRUE(IsSame(lattice, before));
}

TEST(Lattice, FlatAxesAreWidened)
{
  Box box{ { 0.0, 5.0, -1.0 }, { 8.0, 5.0, 1.0 } };
  EXPECT_TRUE(WidenFlatAxes(box));
  EXPECT_EQ(box.Min, glm::dvec3(0.0, 4.0, -1.0));
  EXPECT_EQ(box.Max, glm::dvec3(8.0, 6.0, 1.0));
  Box point{ glm::dvec3(3.0), glm::dvec3(3.0) };
  EXPECT_FALSE(WidenFlatAxes(point));
  EXPECT_EQ(point.Max, glm::dvec3(3.0));
}

TEST(Lattice, RefinementKeepsTheMapInTheDomain)
{
  RandomLattice random(2);
  for (int trial = 0; trial < 10; ++trial)
  {
    Lattice lattice = MakeRandom(random, 1.0);
    lattice.Scale = 0.7;
    const Lattice finer = lattice.Refine({ 2, 1, 3 });
    EXPECT_EQ(finer.FindProblem(), "");
    EXPECT_EQ(finer.Net.Nodes, (lattice.Net.Nodes - 3) * glm::ivec3(2, 1, 3) + 3);
    EXPECT_LT(glm::length(finer.GetDomain().Min - lattice.GetDomain().Min), 1e-12);
    EXPECT_LT(glm::length(finer.GetDomain().Max - lattice.GetDomain().Max), 1e-12);
    EXPECT_LT(LargestDifference(random, lattice, finer), 1e-13 * glm::length(lattice.Spacing));
    // The same numbers of control points by the other name.
    EXPECT_EQ(lattice.Resize(finer.Net.Nodes).Net.Values, finer.Net.Values);
  }
}

TEST(Lattice, ResizeKeepsTheDomainAndTheShape)
{
  RandomLattice random(3);
  const Lattice lattice = MakeRandom(random, 0.5);
  const Lattice other = lattice.Resize(lattice.Net.Nodes + glm::ivec3(1, 3, 2));
  EXPECT_EQ(other.FindProblem(), "");
  EXPECT_EQ(other.Net.Nodes, lattice.Net.Nodes + glm::ivec3(1, 3, 2));
  EXPECT_LT(glm::length(other.GetDomain().Min - lattice.GetDomain().Min), 1e-12);
  EXPECT_LT(glm::length(other.GetDomain().Max - lattice.GetDomain().Max), 1e-12);
  // As far as more control points can tell: theirs move by up to half of a spacing.
  EXPECT_LT(LargestDifference(random, lattice, other), 0.1 * glm::length(lattice.Spacing));
  EXPECT_TRUE(IsSame(lattice.Resize(lattice.Net.Nodes), lattice));
  EXPECT_TRUE(Lattice().Resize({ 9, 5, 6 }).IsIdentity());
}

TEST(Lattice, ExtensionKeepsTheMapEverywhere)
{
  RandomLattice random(4);
  for (const BorderMode border : { BorderMode::Edge, BorderMode::Zero })
  {
    const Lattice lattice = MakeRandom(random, 1.0, border);
    for (const int layers : { 1, 3 })
    {
      const Lattice wider = lattice.Extend(layers);
      EXPECT_EQ(wider.FindProblem(), "");
      EXPECT_EQ(wider.Net.Nodes, lattice.Net.Nodes + 2 * layers);
      EXPECT_LT(LargestDifference(random, lattice, wider, 8.0), 1e-12);
    }
  }
}

TEST(Lattice, FitFollowsADisplacement)
{
  // An affine displacement is in the space of the splines, so the first net is exact.
  DisplacementSampler affine;
  affine.Sample = [](const std::vector<glm::dvec3>& points, std::vector<glm::dvec3>& values) {
    values.clear();
    for (const glm::dvec3& p : points)
    {
      values.push_back({ 1.0 + 0.1 * p.y, 0.2 * p.x - 0.1 * p.z, -2.0 });
    }
    return true;
  };
  const Box domain{ { -1.0, 2.0, 5.0 }, { 3.0, 5.0, 13.0 } };
  Lattice lattice;
  lattice.Scale = 3.0;
  lattice.Inverse = true;
  lattice.Border = BorderMode::Zero;
  FitLimits limits;
  limits.Tolerance = 1e-9;
  FunctionFit fit(affine, domain.Min, domain.Max - domain.Min);
  EXPECT_EQ(fit.Run(limits), FitStatus::Reached);
  EXPECT_LE(fit.GetNet().LargestError, 1e-9);
  EXPECT_GE(fit.GetNet().LargestError, 0.0);
  lattice.Take(fit.GetNet());
  EXPECT_EQ(lattice.FindProblem(), "");
  EXPECT_EQ(lattice.Scale, 1.0);
  EXPECT_FALSE(lattice.Inverse);
  EXPECT_EQ(lattice.Border, BorderMode::Edge);
  EXPECT_LT(glm::length(lattice.GetDomain().Max - domain.Max), 1e-12);
  const glm::dvec3 at(0.3, 3.3, 11.1);
  EXPECT_LT(
    glm::length(lattice.MakeField().Displacement(at) - glm::dvec3(1.0 + 0.33, 0.06 - 1.11, -2.0)),
    1e-12);

  DisplacementSampler bad;
  bad.Sample = [&](const std::vector<glm::dvec3>& points, std::vector<glm::dvec3>& values) {
    affine.Sample(points, values);
    return false;
  };
  EXPECT_EQ(FunctionFit(bad, domain.Min, glm::dvec3(1.0)).Run(limits), FitStatus::NotFinite);
}

TEST(Lattice, FitGoesOnWhereItStopped)
{
  // Curved along x alone.
  DisplacementSampler wave;
  std::size_t taken = 0;
  wave.Sample = [&](const std::vector<glm::dvec3>& points, std::vector<glm::dvec3>& values) {
    values.clear();
    taken += points.size();
    for (const glm::dvec3& p : points)
    {
      values.push_back({ 0.0, std::sin(12.0 * p.x), 0.1 * p.z });
    }
    return true;
  };
  FitLimits limits;
  limits.Tolerance = 1e-3;
  const glm::dvec3 lower(0.0);
  const glm::dvec3 extent(1.0);
  FunctionFit whole(wave, lower, extent);
  EXPECT_EQ(whole.Run(limits), FitStatus::Reached);
  const FittedNet& expected = whole.GetNet();
  EXPECT_GT(expected.Cells.x, 8);
  EXPECT_EQ(expected.Cells.y, 4);
  EXPECT_EQ(expected.Cells.z, 4);

  FunctionFit fit(wave, lower, extent);
  limits.MaximumCells = 8;
  EXPECT_EQ(fit.Run(limits), FitStatus::NotReached);
  EXPECT_EQ(fit.GetNet().Cells, glm::ivec3(8, 4, 4));
  EXPECT_GT(fit.GetNet().LargestError, limits.Tolerance);
  taken = 0;
  limits.MaximumCells = 64;
  EXPECT_EQ(fit.Run(limits), FitStatus::Reached);
  EXPECT_EQ(fit.GetNet().Cells, expected.Cells);
  EXPECT_EQ(fit.GetNet().Net.Values, expected.Net.Values);
  // What was sampled is not sampled again.
  EXPECT_LE(taken + 17 * 17 * 17, GridSize(glm::max(2 * expected.Cells, 16) + 1));
}

TEST(LatticeMap, InvertsTheMap)
{
  RandomLattice random(5);
  LatticeMap map;
  for (int trial = 0; trial < 20; ++trial)
  {
    Lattice lattice = MakeRandom(random, 0.3);
    lattice.Scale = 1.5;
    const double tolerance = 1e-10 * glm::length(lattice.Spacing);
    map.Update(lattice, tolerance);
    const BSplineField field = lattice.MakeField();
    const glm::dvec3 rest = MakePoint(random, lattice);
    const glm::dvec3 p = rest + field.Displacement(rest);
    glm::dmat3 jacobian;
    const glm::dvec3 q = map.Invert(p, jacobian);
    EXPECT_EQ(q, map.Invert(p));
    EXPECT_LT(glm::length(q + field.Displacement(q) - p), 2.0 * tolerance);
    for (int b = 0; b < 3; ++b)
    {
      glm::dvec3 step(0.0);
      step[b] = 1e-5;
      const glm::dvec3 slope =
        (2.0 * step + field.Displacement(q + step) - field.Displacement(q - step)) / 2e-5;
      EXPECT_LT(glm::length(slope - jacobian[b]), 1e-6);
    }
  }
  map.Reset(1e-3);
  EXPECT_EQ(map.Invert({ 1.0, 2.0, 3.0 }), glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(map.GetDeterminantBounds().Min, 1.0);
}

TEST(LatticeMap, BoundsHoldForTheMapAndItsInverseAfterEveryEdit)
{
  RandomLattice random(6);
  for (const bool inverse : { false, true })
  {
    LatticeMap map;
    Lattice lattice = MakeRandom(random, 0.1);
    lattice.Inverse = inverse;
    for (int edit = 0; edit < 20; ++edit)
    {
      const auto point = static_cast<std::size_t>(
        random.Integer(0, static_cast<int>(lattice.Net.Values.size()) - 1));
      lattice.Net.Values[point] = 0.3 * random.Vector(-1.0, 1.0) * lattice.Spacing;
      map.Update(lattice, 1e-9);
      const BSplineField field = lattice.MakeField();
      const Box rest{ MakePoint(random, lattice, -0.2), glm::dvec3(0.0) };
      const Box object{ rest.Min,
        glm::min(rest.Min + 0.5 * lattice.Spacing, lattice.GetDomain().Max) };
      const Box deformed = map.GetDeformedBounds(object);
      const Box displacement = map.GetDisplacementBounds();
      const Range determinant = map.GetDeterminantBounds();
      for (int n = 0; n < 50; ++n)
      {
        const glm::dvec3 x = glm::mix(object.Min, object.Max, random.Vector(0.0, 1.0));
        glm::dmat3 jacobian;
        const glm::dvec3 d = field.Displacement(x, jacobian);
        const glm::dvec3 moved = inverse ? map.Invert(x) : x + d;
        for (int a = 0; a < 3; ++a)
        {
          EXPECT_GE(moved[a], deformed.Min[a] - 1e-8);
          EXPECT_LE(moved[a], deformed.Max[a] + 1e-8);
          EXPECT_GE(d[a], displacement.Min[a]);
          EXPECT_LE(d[a], displacement.Max[a]);
        }
        const double det = glm::determinant(glm::dmat3(1.0) + jacobian);
        EXPECT_GE(det, determinant.Min - 1e-9);
        EXPECT_LE(det, determinant.Max + 1e-9);
      }
      // As if there had been no edit before.
      LatticeMap fresh;
      fresh.Update(lattice, 1e-9);
      EXPECT_EQ(fresh.GetDeformedBounds(object).Max, deformed.Max);
      EXPECT_EQ(fresh.GetDisplacementBounds().Min, displacement.Min);
    }
  }
}

TEST(LatticeMap, QueriesOfSeveralThreadsSeeOneStateOrTheOther)
{
  // A reference to bounds that outlives the lock would see both: an update replaces them.
  Lattice states[2] = { Lattice({ 8, 8, 8 }, { glm::dvec3(0.0), glm::dvec3(1.0) }),
    Lattice({ 8, 8, 8 }, { glm::dvec3(0.0), glm::dvec3(1.0) }) };
  states[1].Net.Values.assign(states[1].Net.Values.size(), glm::dvec3(1000.0));
  const Box unit{ glm::dvec3(0.0), glm::dvec3(1.0) };
  LatticeMap map;
  map.Update(states[0], 1e-6);
  std::atomic<bool> done{ false };
  std::atomic<int> wrong{ 0 };
  std::atomic<int> queries{ 0 };
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
  {
    threads.emplace_back([&map, &done, &wrong, &queries, &unit] {
      while (!done)
      {
        const Box box = map.GetDeformedBounds(unit);
        const double moved = box.Min.x > 500.0 ? 1000.0 : 0.0;
        const double off = glm::length(box.Min - moved) + glm::length(box.Max - (1.0 + moved));
        ++queries;
        wrong += off < 1e-5 ? 0 : 1;
      }
    });
  }
  // A time, not a number of updates: the more often the threads take turns with the lock, the more
  // queries bound the map anew.
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  constexpr int Least = 20;
  for (int n = 1; n <= Least || queries < Least || std::chrono::steady_clock::now() < end; ++n)
  {
    map.Update(states[n % 2], 1e-6);
  }
  done = true;
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  EXPECT_EQ(wrong, 0);
}
