// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPolyline.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace ffd;

namespace
{

constexpr PullBackKind Kinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

double Angle(const glm::dvec3& a, const glm::dvec3& b)
{
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

std::vector<PolylineVertex> Walk(PolylineWalker& walker)
{
  std::vector<PolylineVertex> vertices{ walker.GetVertex() };
  while (vertices.size() < 100000 && walker.Next())
  {
    vertices.push_back(walker.GetVertex());
  }
  return vertices;
}

/// The pseudo-code of section 4.5, with the paper's names; the length is clamped before the point
/// is placed, and the last point is the end of the ray.
std::vector<double> WalkAsThePaper(const PullBack& map, const PolylineSettings& settings,
  const glm::dvec3& start, const glm::dvec3& directionOfOriginalRay, double end, int& unconverged)
{
  const auto inverseTransform = [&](double t) {
    PullBackStatus status;
    const glm::dvec3 q = map.Evaluate(start + t * directionOfOriginalRay, status);
    unconverged += status.Converged ? 0 : 1;
    return q;
  };
  double oldLength = settings.MinimumLength;
  glm::dvec3 oldDirection = directionOfOriginalRay;
  double oldPoint = 0.0;
  glm::dvec3 oldInverse = inverseTransform(oldPoint);
  std::vector<double> points{ oldPoint };
  while (oldPoint < end)
  {
    double length = std::min(2.0 * oldLength, settings.MaximumLength);
    for (;;)
    {
      const double step = std::min(length, end - oldPoint);
      const double point = step < end - oldPoint ? oldPoint + step : end;
      const glm::dvec3 inverse = inverseTransform(point);
      const glm::dvec3 direction = inverse - oldInverse;
      if (step > settings.MinimumLength && Angle(direction, oldDirection) > settings.AngleThreshold)
      {
        length = std::max(0.5 * length, settings.MinimumLength);
        continue;
      }
      oldPoint = point;
      oldInverse = inverse;
      oldDirection = direction;
      oldLength = length;
      points.push_back(point);
      break;
    }
  }
  return points;
}

} // namespace

TEST(Polyline, StraightRaysDoubleUpToTheMaximum)
{
  const PullBack identity;
  PolylineSettings settings;
  const glm::dvec3 origin(1.0, 2.0, 3.0);
  const glm::dvec3 direction(0.0, 0.6, 0.8);
  PolylineWalker walker(identity, settings, origin, direction, 0.0, 34.0, true);
  const std::vector<PolylineVertex> vertices = Walk(walker);
  // The first try is twice the minimum of 0.5: 1, 2, 4, 8, 8, 8 and what is left.
  const double expected[] = { 0.0, 1.0, 3.0, 7.0, 15.0, 23.0, 31.0, 34.0 };
  ASSERT_EQ(vertices.size(), std::size(expected));
  for (std::size_t i = 0; i < vertices.size(); ++i)
  {
    EXPECT_EQ(vertices[i].T, expected[i]);
    EXPECT_LE(glm::length(vertices[i].Rest - (origin + expected[i] * direction)), 1e-12);
    EXPECT_EQ(vertices[i].Jacobian, glm::dmat3(1.0));
  }
}

TEST(Polyline, SegmentsHaveFixedLengthWhenMinimumIsMaximum)
{
  RandomLattice random(1);
  const BSplineField field = random.Field(1.0, BorderMode::Edge);
  const PullBack map(&field, PullBackKind::FirstOrder, 1e-6);
  PolylineSettings settings;
  settings.MinimumLength = 2.0;
  settings.MaximumLength = 2.0;
  settings.AngleThreshold = 1e-3;
  PolylineWalker walker(
    map, settings, random.Point(field, 1.0), glm::dvec3(0.0, 0.6, 0.8), 5.0, 22.5, false);
  const std::vector<PolylineVertex> vertices = Walk(walker);
  ASSERT_EQ(vertices.size(), 10u);
  for (std::size_t i = 0; i < 9; ++i)
  {
    EXPECT_DOUBLE_EQ(vertices[i].T, 5.0 + 2.0 * static_cast<double>(i));
  }
  EXPECT_EQ(vertices.back().T, 22.5);
}

TEST(Polyline, AMaximumBelowTheMinimumCountsAsTheMinimum)
{
  PolylineSettings settings;
  settings.MinimumLength = 2.0;
  settings.MaximumLength = 1.0;
  const PullBack identity;
  PolylineWalker walker(
    identity, settings, glm::dvec3(0.0), glm::dvec3(1.0, 0.0, 0.0), 0.0, 6.0, false);
  EXPECT_EQ(Walk(walker).size(), 4u);
}

TEST(Polyline, IsTheAlgorithmOfSection45)
{
  RandomLattice random(2);
  int folded = 0;
  std::size_t segments = 0;
  for (int run = 0; run < 300; ++run)
  {
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.0, 0.3)), BorderMode::Edge);
    const PullBack map(&field, Kinds[run % 4], 1e-9);
    PolylineSettings settings;
    settings.MinimumLength = random.Number(0.02, 0.3);
    settings.MaximumLength = random.Number(0.3, 8.0);
    settings.AngleThreshold = random.Number(0.02, 0.4);
    const glm::dvec3 origin = random.Point(field, 1.0);
    const glm::dvec3 direction = glm::normalize(random.Point(field, 1.0) - origin);
    const double end = random.Number(0.5, 15.0);
    PolylineWalker walker(map, settings, origin, direction, 0.0, end, false);
    const std::vector<PolylineVertex> vertices = Walk(walker);
    int unconverged = 0;
    const std::vector<double> expected =
      WalkAsThePaper(map, settings, origin, direction, end, unconverged);
    ASSERT_EQ(vertices.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
    {
      ASSERT_NEAR(vertices[i].T, expected[i], 1e-12);
    }
    ASSERT_EQ(vertices.back().T, end);
    ASSERT_EQ(walker.GetUnconverged(), unconverged);
    folded += unconverged > 0 ? 1 : 0;
    segments += expected.size();

    glm::dvec3 last = direction;
    for (std::size_t i = 1; i < vertices.size(); ++i)
    {
      const glm::dvec3 segment = vertices[i].Rest - vertices[i - 1].Rest;
      if (vertices[i].T - vertices[i - 1].T > settings.MinimumLength * (1.0 + 1e-9))
      {
        ASSERT_LE(Angle(segment, last), settings.AngleThreshold * (1.0 + 1e-9));
      }
      last = segment;
    }
  }
  EXPECT_GT(segments, 3000u);
  EXPECT_GT(folded, 0);
}

TEST(Polyline, CountsEvaluations)
{
  RandomLattice random(3);
  const BSplineField field = random.Field(0.3, BorderMode::Edge);
  const PullBack map(&field, PullBackKind::FirstOrder, 1e-6);
  PolylineSettings settings;
  settings.MinimumLength = 1.0;
  settings.MaximumLength = 1.0;
  PolylineWalker walker(
    map, settings, random.Point(field, 0.0), glm::dvec3(1.0, 0.0, 0.0), 0.0, 10.0, false);
  const std::size_t vertices = Walk(walker).size();
  EXPECT_EQ(walker.GetEvaluations(), static_cast<std::int64_t>(vertices));
}
