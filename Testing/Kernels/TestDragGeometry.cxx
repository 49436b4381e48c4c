// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What drags of the mouse mean, without a window: lines of sight are given.
#include "FFDDragGeometry.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include <cmath>

using namespace ffd;

namespace
{

/// The line of sight from an eye to a point.
LineOfSight See(const glm::dvec3& eye, const glm::dvec3& point)
{
  return { eye, glm::normalize(point - eye) };
}

const glm::dvec3 Eye(3.0, -4.0, 20.0);
const glm::dvec3 Anchor(1.0, 2.0, 3.0);

void ExpectNear(const glm::dvec3& a, const glm::dvec3& b)
{
  EXPECT_LT(glm::length(a - b), 1e-12) << a.x << " " << a.y << " " << a.z;
}

} // namespace

TEST(DragGeometry, ConstraintsNameAnAxis)
{
  EXPECT_EQ(GetAxis(MoveConstraint::Free), -1);
  EXPECT_EQ(GetAxis(MoveConstraint::AlongY), 1);
  EXPECT_EQ(GetAxis(MoveConstraint::AcrossZ), 2);
  EXPECT_TRUE(IsAlongAxis(MoveConstraint::AlongZ));
  EXPECT_FALSE(IsAlongAxis(MoveConstraint::AcrossX));
  EXPECT_FALSE(IsAlongAxis(MoveConstraint::Free));
}

TEST(DragGeometry, MovesFollowTheMouseAlongAnAxis)
{
  // Both lines meet the axis through the anchor, two apart.
  for (const int axis : { 0, 1 })
  {
    const glm::dvec3 move = -2.0 * GetUnitVector(axis);
    const auto found =
      FindConstrainedMove(axis == 0 ? MoveConstraint::AlongX : MoveConstraint::AlongY, Anchor,
        See(Eye, Anchor + 0.5 * GetUnitVector(axis)),
        See(Eye, Anchor + 0.5 * GetUnitVector(axis) + move));
    ASSERT_TRUE(found);
    ExpectNear(*found, move);
  }
  // A line of sight that passes by: the nearest point of the axis counts.
  const auto beside = FindConstrainedMove(MoveConstraint::AlongX, Anchor,
    { { 1.0, 5.0, 9.0 }, { 0.0, 0.0, -1.0 } }, { { 4.0, -5.0, 9.0 }, { 0.0, 0.0, -1.0 } });
  ASSERT_TRUE(beside);
  ExpectNear(*beside, { 3.0, 0.0, 0.0 });
}

TEST(DragGeometry, MovesStayInThePlaneAcrossAnAxis)
{
  const glm::dvec3 move(0.5, -1.5, 0.0);
  const auto found =
    FindConstrainedMove(MoveConstraint::AcrossZ, Anchor, See(Eye, Anchor), See(Eye, Anchor + move));
  ASSERT_TRUE(found);
  ExpectNear(*found, move);
  EXPECT_EQ(found->z, 0.0);
}

TEST(DragGeometry, WhatIsSeenEndOnIsNotMoved)
{
  const LineOfSight down{ { 1.0, 2.0, 20.0 }, { 0.0, 0.0, -1.0 } };
  const LineOfSight aside{ { 1.1, 2.0, 20.0 }, { 0.0, 0.0, -1.0 } };
  EXPECT_FALSE(FindConstrainedMove(MoveConstraint::AlongZ, Anchor, down, aside));
  EXPECT_FALSE(FindConstrainedMove(MoveConstraint::AcrossX, Anchor, down, aside));
  EXPECT_FALSE(FindDragFactor(2, Anchor, down, aside));
  EXPECT_FALSE(FindDragAngle({ 1.0, 0.0, 0.0 }, Anchor, { 0.0, 0.0, -1.0 }, down, aside));
}

TEST(DragGeometry, AnglesAreThoseAboutTheAxis)
{
  const glm::dvec3 axis(0.0, 0.0, 1.0);
  const glm::dvec3 view = glm::normalize(Anchor - Eye);
  for (const double angle : { 0.3, -2.0, 3.0 })
  {
    const auto found =
      FindDragAngle(axis, Anchor, view, See(Eye, Anchor + glm::dvec3(2.0, 0.0, 0.0)),
        See(Eye, Anchor + 0.7 * glm::dvec3(std::cos(angle), std::sin(angle), 0.0)));
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, angle, 1e-12);
  }
}

TEST(DragGeometry, FactorsNeverVanish)
{
  const auto at = [](double t) { return See(Eye, Anchor + glm::dvec3(t, 0.0, 0.0)); };
  EXPECT_NEAR(*FindDragFactor(0, Anchor, at(2.0), at(5.0)), 2.5, 1e-12);
  EXPECT_NEAR(*FindDragFactor(0, Anchor, at(-2.0), at(-1.0)), 0.5, 1e-12);
  EXPECT_EQ(*FindDragFactor(0, Anchor, at(2.0), at(-1.0)), 0.01);
}

TEST(DragGeometry, ScreenMovesObeyTheConstraint)
{
  const glm::dvec3 right(2.0, 0.0, 0.0);
  const glm::dvec3 up(0.0, 3.0, 4.0);
  ExpectNear(FindScreenMove(MoveConstraint::Free, 2.0, 5.0, right, up), { 2.0, 3.0, 4.0 });
  ExpectNear(FindScreenMove(MoveConstraint::AlongY, 2.0, 5.0, right, up), { 0.0, 7.0, 0.0 });
  ExpectNear(FindScreenMove(MoveConstraint::AcrossY, 2.0, 5.0, right, up), { 2.0, 0.0, 5.0 });
  ExpectNear(FindScreenMove(MoveConstraint::AcrossX, 2.0, 5.0, right, up), { 0.0, 3.0, 4.0 });
}
