// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The bounds are proofs: nothing that is sampled may ever leave them.
#include "FFDPullBackBounds.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

using namespace ffd;

namespace
{

constexpr PullBackKind AllKinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

bool Inverts(PullBackKind kind)
{
  return kind == PullBackKind::Exact || kind == PullBackKind::FirstOrderOfInverse;
}

glm::dvec3 PointIn(RandomLattice& random, const Box& box)
{
  return box.Min + (box.Max - box.Min) * random.Vector(0.0, 1.0);
}

bool Holds(const Box& box, const glm::dvec3& p, double slack = 0.0)
{
  return glm::all(glm::greaterThanEqual(p, box.Min - slack)) &&
    glm::all(glm::lessThanEqual(p, box.Max + slack));
}

/// dPhi/dp at the point of a region: deformed space, or the rest point for kinds that invert.
glm::dmat3 JacobianAt(const BSplineField& field, PullBackKind kind, const glm::dvec3& p)
{
  glm::dmat3 d;
  field.Displacement(p, d);
  switch (kind)
  {
    case PullBackKind::FirstOrder:
      return glm::dmat3(1.0) - d;
    case PullBackKind::Forward:
      return glm::dmat3(1.0) + d;
    case PullBackKind::Exact:
      return glm::inverse(glm::dmat3(1.0) + d);
    case PullBackKind::FirstOrderOfInverse:
      return glm::dmat3(2.0) - glm::inverse(glm::dmat3(1.0) + d);
  }
  return d;
}

/// Bounds over one sub-cell of T^-1 from those of T, step by step and in double precision: what the
/// vector code must not be wider than, nor closer.
struct InverseReference
{
  bool Bounded = false;
  glm::dmat3 Min;
  glm::dmat3 Max;
  double Second = 0.0;
  double Third = 0.0;

  InverseReference(const SubCellBounds& forward, const CellDerivatives& cell)
  {
    glm::dmat3 centre;
    glm::dmat3 delta;
    for (int e = 0; e < 9; ++e)
    {
      const double lo = -static_cast<double>(forward.Value[SubCellBounds::NegatedJacobianMin + e]);
      const double hi = forward.Value[SubCellBounds::JacobianMax + e];
      centre[e / 3][e % 3] = 0.5 * (lo + hi);
      delta[e / 3][e % 3] = 0.5 * (hi - lo);
    }
    if (!(glm::determinant(centre) > 1e-9))
    {
      return;
    }
    const glm::dmat3 inverse = glm::inverse(centre);
    glm::dmat3 size;
    for (int e = 0; e < 9; ++e)
    {
      size[e / 3][e % 3] = std::abs(inverse[e / 3][e % 3]);
    }
    const glm::dmat3 w = size * delta;
    double rows = 0.0;
    double columns = 0.0;
    for (int i = 0; i < 3; ++i)
    {
      rows = std::max(rows, w[0][i] + w[1][i] + w[2][i]);
      columns = std::max(columns, w[i][0] + w[i][1] + w[i][2]);
    }
    if (!(std::min(rows, columns) < 0.999))
    {
      return;
    }
    this->Bounded = true;
    const glm::dmat3 spread = glm::inverse(glm::dmat3(1.0) - w) * w * size;
    this->Min = inverse - spread;
    this->Max = inverse + spread;
    const glm::dmat3 largest = size + spread;
    // |Q'| by rows, then J Q'' = -T2[Q', Q'] and J Q''' = -T3[Q', Q', Q'] - 3 T2[Q', Q''].
    const glm::dmat3 transposed = glm::transpose(largest);
    glm::dvec3 speed;
    for (int i = 0; i < 3; ++i)
    {
      speed[i] = glm::length(transposed[i]);
    }
    constexpr int pair[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
    constexpr int triple[3][6] = { { 0, 1, 2, 3, 4, 5 }, { 1, 3, 4, 6, 7, 8 },
      { 2, 4, 5, 7, 8, 9 } };
    const auto second = [&](const glm::dvec3& q, const glm::dvec3& r)
    {
      glm::dvec3 sum(0.0);
      for (int bc = 0; bc < 9; ++bc)
      {
        const float* h = cell.Second[pair[bc / 3][bc % 3]];
        sum += q[bc / 3] * r[bc % 3] * glm::dvec3(h[0], h[1], h[2]);
      }
      return sum;
    };
    glm::dvec3 cube(0.0);
    for (int bcd = 0; bcd < 27; ++bcd)
    {
      const float* h = cell.Third[triple[bcd / 9][pair[bcd / 3 % 3][bcd % 3]]];
      cube += speed[bcd / 9] * speed[bcd / 3 % 3] * speed[bcd % 3] * glm::dvec3(h[0], h[1], h[2]);
    }
    const glm::dvec3 turn = largest * second(speed, speed);
    const glm::dvec3 twist = largest * (cube + 3.0 * second(speed, turn));
    // And by norms, which are seldom closer.
    double frobenius = 0.0;
    double rowSum = 0.0;
    double columnSum = 0.0;
    for (int i = 0; i < 3; ++i)
    {
      frobenius += glm::dot(largest[i], largest[i]);
      rowSum = std::max(rowSum, transposed[i].x + transposed[i].y + transposed[i].z);
      columnSum = std::max(columnSum, largest[i].x + largest[i].y + largest[i].z);
    }
    const double alpha = std::sqrt(std::min(frobenius, rowSum * columnSum));
    const double t2 = forward.Value[SubCellBounds::Second];
    const double t3 = forward.Value[SubCellBounds::Third];
    this->Second = std::min(glm::length(turn), std::pow(alpha, 3.0) * t2);
    this->Third = std::min(
      glm::length(twist), std::pow(alpha, 4.0) * t3 + 3.0 * std::pow(alpha, 5.0) * t2 * t2);
  }
};

} // namespace

TEST(PullBackBounds, InverseIsThatOfTheReference)
{
  RandomLattice random(29);
  int bounded = 0;
  int unbounded = 0;
  for (int l = 0; l < 60; ++l)
  {
    const BSplineField field = random.Field(
      std::pow(10.0, random.Number(-3.0, 0.2)), AllBorders[l % 3], l % 5 == 0 ? 1 : 4);
    const PullBackBounds forward(PullBack(&field, PullBackKind::Forward, 1e-3));
    const PullBackBounds exact(PullBack(&field, PullBackKind::Exact, 1e-3));
    const PullBackBounds mirrored(PullBack(&field, PullBackKind::FirstOrderOfInverse, 1e-3));
    const glm::ivec3 size = forward.GetSize();
    const glm::ivec3 cells = size / 2 + 1;
    bool all = true;
    for (int k = 0; k < size.z; ++k)
    {
      for (int j = 0; j < size.y; ++j)
      {
        for (int i = 0; i < size.x; ++i)
        {
          const glm::ivec3 at(i, j, k);
          const glm::ivec3 cell = (at + 1) / 2;
          const InverseReference reference(forward.GetSubCell(at),
            exact.GetDerivatives()[static_cast<std::size_t>(
              cell.x + cells.x * (cell.y + cells.y * cell.z))]);
          const SubCellBounds& one = exact.GetSubCell(at);
          const SubCellBounds& other = mirrored.GetSubCell(at);
          all = all && reference.Bounded;
          ++(reference.Bounded ? bounded : unbounded);
          ASSERT_EQ(reference.Bounded, std::isfinite(one.Value[SubCellBounds::Third]));
          if (!reference.Bounded)
          {
            ASSERT_EQ(std::count_if(one.Value, one.Value + 18,
                        [](float v) { return std::isinf(v) && v > 0.0f; }),
              18);
            continue;
          }
          const auto near = [](double bound, double expected, double scale)
          {
            // What is stored is rounded upwards, also that of T.
            return bound >= expected - 3e-6 * scale && bound <= expected + 3e-6 * scale;
          };
          double scale = 1.0;
          for (int e = 0; e < 9; ++e)
          {
            scale = std::max({ scale, std::abs(reference.Min[e / 3][e % 3]),
              std::abs(reference.Max[e / 3][e % 3]) });
          }
          // An inverse is as sensitive as it is large.
          scale *= scale;
          for (int e = 0; e < 9; ++e)
          {
            const double unit = e % 4 == 0 ? 2.0 : 0.0;
            const double min = reference.Min[e / 3][e % 3];
            const double max = reference.Max[e / 3][e % 3];
            ASSERT_TRUE(near(-one.Value[SubCellBounds::NegatedJacobianMin + e], min, scale));
            ASSERT_TRUE(near(one.Value[SubCellBounds::JacobianMax + e], max, scale));
            ASSERT_TRUE(
              near(-other.Value[SubCellBounds::NegatedJacobianMin + e], unit - max, scale));
            ASSERT_TRUE(near(other.Value[SubCellBounds::JacobianMax + e], unit - min, scale));
          }
          for (const SubCellBounds* bounds : { &one, &other })
          {
            const double second = bounds->Value[SubCellBounds::Second];
            const double third = bounds->Value[SubCellBounds::Third];
            ASSERT_NEAR(second, reference.Second, 1e-5 * scale * reference.Second + 1e-30);
            ASSERT_NEAR(third, reference.Third, 1e-5 * scale * reference.Third + 1e-30);
          }
        }
      }
    }
    // Else the determinant may still prove it.
    ASSERT_TRUE(exact.IsProvenInvertible() || !all);
  }
  EXPECT_GT(bounded, 20000);
  EXPECT_GT(unbounded, 2000);
}

TEST(PullBackBounds, IdentityIsExact)
{
  const BSplineField zero;
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds bounds(PullBack(&zero, kind, 1e-3));
    EXPECT_EQ(bounds.RegionsAreInRestSpace(), Inverts(kind));
    const Box box{ glm::dvec3(-1.0), glm::dvec3(2.0) };
    const MapBounds over = bounds.Over(box);
    EXPECT_EQ(over.JacobianMin, glm::dmat3(1.0));
    EXPECT_EQ(over.JacobianMax, glm::dmat3(1.0));
    EXPECT_EQ(over.SecondDerivative, 0.0);
    EXPECT_EQ(over.ThirdDerivative, 0.0);
    EXPECT_EQ(bounds.DisplacementOver(box).Max, glm::dvec3(0.0));
    EXPECT_EQ(bounds.DeformedBounds(box).Min, box.Min);
    EXPECT_EQ(bounds.DeformedBounds(box).Max, box.Max);
  }
}

TEST(PullBackBounds, ContainSampledDisplacementsAndJacobians)
{
  RandomLattice random(21);
  long samples = 0;
  for (int l = 0; l < 1500; ++l)
  {
    // Sizes from 1 control point (constant along the axis), strengths from tame to folded.
    const BSplineField field = random.Field(
      std::pow(10.0, random.Number(-3.0, 0.3)), AllBorders[l % 3], l % 5 == 0 ? 1 : 4);
    const PullBackKind kind = AllKinds[l / 3 % 4];
    const PullBackBounds bounds(PullBack(&field, kind, 1e-3));
    for (int r = 0; r < 6; ++r)
    {
      Box region;
      random.Region(field, 3.0, r < 3 ? 0.6 : 3.0, region.Min, region.Max);
      const MapBounds over = bounds.Over(region);
      const Box range = bounds.DisplacementOver(region);
      for (int i = 0; i < 25; ++i)
      {
        const glm::dvec3 p = PointIn(random, region);
        ASSERT_TRUE(Holds(range, field.Displacement(p)));
        const glm::dmat3 jacobian = JacobianAt(field, kind, p);
        for (int e = 0; e < 9; ++e)
        {
          ASSERT_GE(jacobian[e / 3][e % 3], over.JacobianMin[e / 3][e % 3]);
          ASSERT_LE(jacobian[e / 3][e % 3], over.JacobianMax[e / 3][e % 3]);
        }
        ++samples;
      }
    }
  }
  EXPECT_EQ(samples, 1500 * 6 * 25);
}

// Interpolation is what the renderer does with these bounds: the error of a chord is at most
// M2 L^2 / 8, and a quadratic through three equidistant points is off by at most M3 L^3 / (72
// sqrt 3) * ... = sqrt(3) / 216 * M3 L^3.
TEST(PullBackBounds, HigherDerivativesBoundInterpolationErrors)
{
  RandomLattice random(22);
  int bounded = 0;
  double tightest2 = 0.0;
  double tightest3 = 0.0;
  for (int l = 0; l < 1500; ++l)
  {
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-3.0, -0.3)), AllBorders[l % 3]);
    const PullBackKind kind = AllKinds[l / 3 % 4];
    const PullBack pullBack(&field, kind, 1e-13);
    const PullBackBounds bounds(pullBack);
    for (int r = 0; r < 10; ++r)
    {
      const glm::dvec3 p0 = random.Point(field, 2.5);
      const glm::dvec3 p1 = p0 + field.GetSpacing() * random.Vector(-0.7, 0.7);
      PullBackStatus status[4];
      const glm::dvec3 q0 = pullBack.Evaluate(p0, status[0]);
      const glm::dvec3 q1 = pullBack.Evaluate(p1, status[1]);
      const glm::dvec3 middle = pullBack.Evaluate(0.5 * (p0 + p1), status[2]);
      Box region{ glm::min(p0, p1), glm::max(p0, p1) };
      double t = random.Number(0.1, 0.9);
      if (Inverts(kind))
      {
        // The curve of rest points, from many of its points.
        region = { glm::dvec3(1e300), glm::dvec3(-1e300) };
        bool converged = true;
        for (int i = 0; i <= 64; ++i)
        {
          PullBackStatus s;
          const glm::dvec3 q = PullBack(&field, PullBackKind::Exact, 1e-13)
                                 .Evaluate(p0 + (p1 - p0) * (i / 64.0), s);
          converged = converged && s.Converged;
          region.Min = glm::min(region.Min, q);
          region.Max = glm::max(region.Max, q);
        }
        if (!converged)
        {
          continue;
        }
        region.Min -= 1e-3;
        region.Max += 1e-3;
      }
      const MapBounds over = bounds.Over(region);
      const glm::dvec3 q = pullBack.Evaluate(p0 + t * (p1 - p0), status[3]);
      const double length = glm::distance(p0, p1);
      const double chord = glm::distance(q, q0 + t * (q1 - q0));
      const double limit2 = over.SecondDerivative * length * length * t * (1.0 - t) / 2.0;
      ASSERT_LE(chord, limit2 + 1e-11);
      const glm::dvec3 quadratic = q0 * (2.0 * (t - 0.5) * (t - 1.0)) +
        middle * (4.0 * t * (1.0 - t)) + q1 * (2.0 * t * (t - 0.5));
      const double limit3 = over.ThirdDerivative * length * length * length *
        std::abs(t * (t - 0.5) * (t - 1.0)) / 6.0;
      ASSERT_LE(glm::distance(q, quadratic), limit3 + 1e-11);
      if (std::isfinite(limit2))
      {
        ++bounded;
        tightest2 = std::max(tightest2, chord / (limit2 + 1e-11));
        tightest3 = std::max(tightest3, glm::distance(q, quadratic) / (limit3 + 1e-11));
      }
    }
  }
  // Bounds that are always infinite, or far too large, would pass the above.
  EXPECT_GT(bounded, 9000);
  EXPECT_GT(tightest2, 0.4);
  EXPECT_GT(tightest3, 0.2);
}

TEST(PullBackBounds, KinkAtTheZeroBorderIsUnbounded)
{
  RandomLattice random(23);
  const BSplineField field = random.Field(0.3, BorderMode::ZeroAtBorder);
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds bounds(PullBack(&field, kind, 1e-3));
    const glm::dvec3 plane = field.GetOrigin() - field.GetSpacing();
    Box region{ plane + 0.1 * field.GetSpacing(), plane + 0.9 * field.GetSpacing() };
    EXPECT_TRUE(std::isfinite(bounds.Over(region).SecondDerivative));
    region.Min.y = plane.y - 0.1;
    EXPECT_TRUE(std::isinf(bounds.Over(region).SecondDerivative));
    EXPECT_TRUE(std::isinf(bounds.Over(region).ThirdDerivative));
    EXPECT_TRUE(std::isfinite(bounds.Over(region).JacobianMax[1][1]));
    region.Max.y = plane.y - 0.05;
    EXPECT_LT(bounds.Over(region).SecondDerivative, 1e-3);
  }
}

TEST(PullBackBounds, AffineLatticeIsTight)
{
  // D = A X: every derivative bound is sharp up to single precision.
  const glm::dmat3 a(glm::dvec3(0.2, 0.1, 0.0), glm::dvec3(-0.3, 0.1, 0.05), glm::dvec3(0.0, 0.0, -0.25));
  std::vector<glm::dvec3> d;
  for (int i = 0; i < 512; ++i)
  {
    d.push_back(a * glm::dvec3(i % 8, i / 8 % 8, i / 64) + glm::dvec3(1000.0, 0.0, -50.0));
  }
  const BSplineField field(glm::ivec3(8), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  const Box inside{ glm::dvec3(1.6), glm::dvec3(5.4) };
  for (const PullBackKind kind : AllKinds)
  {
    const PullBackBounds bounds(PullBack(&field, kind, 1e-3));
    const MapBounds over = bounds.Over(inside);
    const glm::dmat3 exact = JacobianAt(field, kind, glm::dvec3(3.0));
    for (int e = 0; e < 9; ++e)
    {
      EXPECT_NEAR(over.JacobianMin[e / 3][e % 3], exact[e / 3][e % 3], 2e-4);
      EXPECT_NEAR(over.JacobianMax[e / 3][e % 3], exact[e / 3][e % 3], 2e-4);
    }
    EXPECT_LT(over.SecondDerivative, 2e-3);
  }
}

TEST(PullBackBounds, FoldsAreUnbounded)
{
  // Neighbours 1.6 spacings towards each other along x.
  std::vector<glm::dvec3> d(6 * 6 * 6, glm::dvec3(0.0));
  for (int i = 0; i < 216; ++i)
  {
    d[static_cast<std::size_t>(i)].x = i % 6 == 2 ? 0.8 : (i % 6 == 3 ? -0.8 : 0.0);
  }
  const BSplineField field(glm::ivec3(6), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  const PullBackBounds bounds(PullBack(&field, PullBackKind::Exact, 1e-3));
  EXPECT_FALSE(bounds.IsProvenInvertible());
  const MapBounds over = bounds.Over({ glm::dvec3(2.4), glm::dvec3(2.6) });
  EXPECT_TRUE(std::isinf(over.JacobianMax[0][0]));
  EXPECT_TRUE(std::isinf(over.SecondDerivative));
  // Far from the fold all is well.
  EXPECT_TRUE(std::isfinite(bounds.Over({ glm::dvec3(-8.0), glm::dvec3(-7.0) }).SecondDerivative));
}

TEST(PullBackBounds, DeformedBoundsContainTheDeformedObject)
{
  RandomLattice random(24);
  for (int l = 0; l < 600; ++l)
  {
    const PullBackKind kind = AllKinds[l / 3 % 4];
    const BSplineField field = random.Field(
      std::pow(10.0, random.Number(-2.0, 0.4)), AllBorders[l % 3], l % 7 == 0 ? 1 : 4);
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
      if (Holds(rest, pullBack.Evaluate(p, status)))
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
  const PullBackBounds unbounded(PullBack(&broken, PullBackKind::FirstOrder, 1e-3));
  EXPECT_TRUE(std::isinf(unbounded.Over({ glm::dvec3(1.0), glm::dvec3(2.0) }).SecondDerivative));
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
    for (int e = 0; e < 9; ++e)
    {
      EXPECT_NEAR(a.Over(region).JacobianMin[e / 3][e % 3], b.Over(region).JacobianMin[e / 3][e % 3], 1e-4);
      EXPECT_NEAR(a.Over(region).JacobianMax[e / 3][e % 3], b.Over(region).JacobianMax[e / 3][e % 3], 1e-4);
    }
    EXPECT_NEAR(a.DeformedBounds(region).Max.x, b.DeformedBounds(region).Max.x, 1e-4);
  }
}

TEST(PullBackBounds, RebuildIsFast)
{
  RandomLattice random(28);
  std::vector<glm::dvec3> d(512);
  for (glm::dvec3& v : d)
  {
    v = random.Vector(-0.3, 0.3);
  }
  const BSplineField field(glm::ivec3(8), glm::dvec3(0.0), glm::dvec3(1.0), d.data());
  for (const PullBackKind kind : { PullBackKind::FirstOrder, PullBackKind::Exact })
  {
    double best = 1e300;
    for (int i = 0; i < 20; ++i)
    {
      const auto start = std::chrono::steady_clock::now();
      const PullBackBounds bounds(PullBack(&field, kind, 1e-3));
      const auto end = std::chrono::steady_clock::now();
      best = std::min(best, std::chrono::duration<double, std::milli>(end - start).count());
    }
    const char* name = kind == PullBackKind::Exact ? "ExactMicroseconds" : "FirstOrderMicroseconds";
    RecordProperty(name, static_cast<int>(1000.0 * best));
    std::cout << name << ": " << 1000.0 * best << "\n";
    // Every edit pays this. Generous, so that sanitizers and slow machines pass.
    EXPECT_LT(best, 200.0);
  }
}
