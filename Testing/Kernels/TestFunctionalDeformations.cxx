// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Barr's global deformations and ray deflectors: inverse, Jacobian and the forms they are known by.
#include "FFDBarrDeformation.h"
#include "FFDRayDeflector.h"

#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{

using Barr = ffd::BarrDeformation;
using Deflector = ffd::RayDeflector;

/// Inverse and Jacobian of a map at a point.
template <class Map>
void CheckAt(const Map& map, const glm::dvec3& p, double kink)
{
  glm::dmat3 jacobian;
  const glm::dvec3 moved = map.Forward(p, jacobian);
  EXPECT_EQ(moved, map.Forward(p));
  EXPECT_LT(glm::length(map.Inverse(moved) - p), 1e-10 * (1.0 + glm::length(p)));
  constexpr double h = 1e-5;
  if (std::abs(kink) < 2.0 * h)
  {
    return;
  }
  for (int b = 0; b < 3; ++b)
  {
    glm::dvec3 step(0.0);
    step[b] = h;
    const glm::dvec3 slope = (map.Forward(p + step) - map.Forward(p - step)) / (2.0 * h);
    EXPECT_LT(glm::length(slope - jacobian[b]), 1e-6 * (1.0 + glm::length(slope)));
  }
}

} // namespace

TEST(Barr, InverseAndJacobian)
{
  RandomLattice random(3);
  for (int test = 0; test < 300; ++test)
  {
    Barr map;
    map.Kind = static_cast<Barr::Shape>(test % 3);
    map.U = random.Integer(0, 2);
    map.V = (map.U + random.Integer(1, 2)) % 3;
    map.Center = random.Vector(-2.0, 2.0);
    map.Low = map.Center[map.U] - random.Number(0.5, 2.0);
    map.High = map.Center[map.U] + random.Number(0.5, 2.0);
    map.Angle = random.Number(-3.0, 3.0);
    map.Scale[0] = random.Number(0.2, 2.0);
    map.Scale[1] = random.Number(0.2, 2.0);
    map.Smooth = test % 2 == 0;
    const double curvature = std::abs(map.Angle) / (map.High - map.Low);
    for (int n = 0; n < 30; ++n)
    {
      glm::dvec3 p = map.Center + random.Vector(-3.0, 3.0);
      if (map.Kind == Barr::Shape::Bend)
      {
        // On the near side of the center of curvature, and so short beyond the ends that the
        // straight parts do not meet.
        p[map.V] = map.Center[map.V] + random.Number(-0.9, 0.9) / std::max(curvature, 0.3);
        p[map.U] = random.Number(map.Low - 0.3, map.High + 0.3);
      }
      CheckAt(map, p, std::min(std::abs(p[map.U] - map.Low), std::abs(p[map.U] - map.High)));
    }
  }
}

TEST(Barr, KnownForms)
{
  Barr map;
  map.U = 2;
  map.Low = 0.0;
  map.High = 2.0;
  map.Kind = Barr::Shape::Taper;
  map.Scale[0] = 1.0;
  map.Scale[1] = 0.5;
  EXPECT_LT(glm::length(map.Forward({ 2.0, 4.0, 1.0 }) - glm::dvec3(1.5, 3.0, 1.0)), 1e-14);
  EXPECT_LT(glm::length(map.Forward({ 2.0, 4.0, 9.0 }) - glm::dvec3(1.0, 2.0, 9.0)), 1e-14);
  EXPECT_LT(glm::length(map.Forward({ 2.0, 4.0, -9.0 }) - glm::dvec3(2.0, 4.0, -9.0)), 1e-14);

  // Twist keeps volume and turns right-handed.
  map.Kind = Barr::Shape::Twist;
  map.Angle = std::acos(-1.0);
  EXPECT_LT(glm::length(map.Forward({ 1.0, 0.0, 1.0 }) - glm::dvec3(0.0, 1.0, 1.0)), 1e-14);
  glm::dmat3 jacobian;
  map.Forward({ 0.3, 0.7, 1.3 }, jacobian);
  EXPECT_NEAR(glm::determinant(jacobian), 1.0, 1e-14);

  // Bend: the center line keeps its length and becomes a quarter circle about (0, 0, 1/k).
  map.Kind = Barr::Shape::Bend;
  map.U = 0;
  map.V = 2;
  map.Angle = 0.5 * std::acos(-1.0);
  const double radius = 2.0 / map.Angle;
  for (double x = 0.0; x <= 2.0; x += 0.25)
  {
    const glm::dvec3 p = map.Forward({ x, 0.4, 0.0 }, jacobian);
    EXPECT_NEAR(std::hypot(p.x, p.z - radius), radius, 1e-13);
    EXPECT_NEAR(glm::length(jacobian[0]), 1.0, 1e-13);
    EXPECT_EQ(p.y, 0.4);
  }
  EXPECT_LT(glm::length(map.Forward({ 2.0, 0.0, 0.0 }) - glm::dvec3(radius, 0.0, radius)), 1e-13);
  // Beyond the end it goes straight on: upwards.
  EXPECT_LT(
    glm::length(map.Forward({ 3.0, 0.0, 0.0 }) - glm::dvec3(radius, 0.0, radius + 1.0)), 1e-13);
  // No angle, and next to none: no deformation, and nothing divided by zero.
  for (const double angle : { 0.0, 1e-300, 1e-14 })
  {
    map.Angle = angle;
    EXPECT_LT(glm::length(map.Forward({ 1.0, 2.0, 3.0 }) - glm::dvec3(1.0, 2.0, 3.0)), 1e-12);
  }
  // The profile between the ends.
  map.Kind = Barr::Shape::Taper;
  map.U = 2;
  map.Smooth = true;
  EXPECT_NEAR(map.Forward({ 1.0, 0.0, 1.0 }).x, 0.75, 1e-14);
  EXPECT_GT(map.Forward({ 1.0, 0.0, 0.5 }).x, 0.875 + 0.01);
}

TEST(RayDeflector, InverseAndJacobian)
{
  RandomLattice random(4);
  for (int test = 0; test < 300; ++test)
  {
    Deflector map;
    map.Kind = static_cast<Deflector::Shape>(test % 3);
    map.Center = random.Vector(-2.0, 2.0);
    map.Radius = random.Number(0.5, 4.0);
    map.Vector = random.Vector(-0.3, 0.3) * map.Radius;
    map.Angle = random.Number(-4.0, 4.0);
    map.Factor = random.Number(0.1, 2.4);
    EXPECT_TRUE(map.IsFoldFree());
    for (int n = 0; n < 30; ++n)
    {
      const glm::dvec3 p = map.Center + map.Radius * random.Vector(-0.9, 0.9);
      CheckAt(map, p, 1.0);
    }
    const glm::dvec3 outside = map.Center + glm::dvec3(0.0, 1.01 * map.Radius, 0.0);
    EXPECT_EQ(map.Forward(outside), outside);
    EXPECT_EQ(map.Inverse(outside), outside);
  }
}

TEST(RayDeflector, KnownForms)
{
  Deflector map;
  map.Center = glm::dvec3(1.0);
  map.Radius = 2.0;
  map.Vector = glm::dvec3(0.0, 0.5, 0.0);
  // All of the vector at the center; at half the radius (3/4)^3 of it.
  EXPECT_LT(glm::length(map.Forward(map.Center) - glm::dvec3(1.0, 1.5, 1.0)), 1e-14);
  EXPECT_NEAR(map.Forward({ 2.0, 1.0, 1.0 }).y, 1.0 + 0.5 * 27.0 / 64.0, 1e-14);
  map.Kind = Deflector::Shape::Scale;
  map.Factor = 2.0;
  EXPECT_NEAR(map.Forward({ 2.0, 1.0, 1.0 }).x, 1.0 + 1.0 + 27.0 / 64.0, 1e-14);
  map.Kind = Deflector::Shape::Rotate;
  map.Angle = 64.0 / 27.0 * 0.5 * std::acos(-1.0);
  EXPECT_LT(glm::length(map.Forward({ 2.0, 1.0, 1.0 }) - glm::dvec3(1.0, 1.0, 0.0)), 1e-14);
}

TEST(RayDeflector, TheFoldLimitsAreSharp)
{
  for (const auto kind : { Deflector::Shape::Translate, Deflector::Shape::Scale })
  {
    for (const double part : { 0.99, 1.01 })
    {
      Deflector map;
      map.Kind = kind;
      map.Radius = 3.0;
      map.Vector = glm::dvec3(0.0, 0.0, part * 3.0 * std::sqrt(5.0) / (6.0 * 0.64));
      map.Factor = 1.0 + part * 49.0 / 32.0;
      double least = 1.0;
      for (int n = 0; n <= 3000; ++n)
      {
        glm::dmat3 jacobian;
        map.Forward({ 0.0, 0.0, n * 1e-3 }, jacobian);
        least = std::min(least, glm::determinant(jacobian));
      }
      EXPECT_EQ(map.IsFoldFree(), part < 1.0);
      EXPECT_EQ(least > 0.0, part < 1.0);
    }
  }
  Deflector map;
  map.Kind = Deflector::Shape::Scale;
  map.Factor = 0.0;
  EXPECT_FALSE(map.IsFoldFree());
}
