// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDCurvePiece.h"
#include "RandomLattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace ffd;

TEST(CurvePiece, ParabolaPassesThroughItsThreePoints)
{
  RandomLattice random(1);
  for (int run = 0; run < 100; ++run)
  {
    const glm::dvec3 a = random.Vector(-9.0, 9.0);
    const glm::dvec3 m = random.Vector(-9.0, 9.0);
    const glm::dvec3 b = random.Vector(-9.0, 9.0);
    const CurvePiece piece = CurvePiece::Parabola(a, m, b);
    ASSERT_LE(glm::length(piece.At(0.0) - a), 1e-12);
    ASSERT_LE(glm::length(piece.At(0.5) - m), 1e-12);
    ASSERT_LE(glm::length(piece.At(1.0) - b), 1e-12);
    const double h = 1e-6;
    const double s = random.Number(0.1, 0.9);
    ASSERT_LE(
      glm::length(piece.Velocity(s) - (piece.At(s + h) - piece.At(s - h)) / (2.0 * h)), 1e-7);
    const CurvePiece line = CurvePiece::Line(a, b);
    ASSERT_LE(glm::length(line.At(0.25) - (0.75 * a + 0.25 * b)), 1e-12);
    ASSERT_EQ(line.Velocity(0.7), b - a);
  }
}

// Section 4.4: (integer)(length / sampleStep) whole intervals and the rest as one more.
TEST(ScheduleWithRemainder, WholeIntervalsAndTheRest)
{
  const SampleSchedule schedule = ScheduleWithRemainder(3.25, 1.0);
  ASSERT_EQ(schedule.Count, 4);
  EXPECT_DOUBLE_EQ(schedule.Position(0), 0.0);
  EXPECT_DOUBLE_EQ(schedule.Position(3) * 3.25, 3.0);
  EXPECT_DOUBLE_EQ(schedule.Interval(2) * 3.25, 1.0);
  EXPECT_DOUBLE_EQ(schedule.Interval(3) * 3.25, 0.25);

  const SampleSchedule whole = ScheduleWithRemainder(3.0, 1.0);
  ASSERT_EQ(whole.Count, 3);
  EXPECT_DOUBLE_EQ(whole.Interval(2) * 3.0, 1.0);
  // Ten times 0.1 is not quite 1: a remainder of rounding errors is none.
  EXPECT_EQ(ScheduleWithRemainder(0.1 * 10.0, 0.1).Count, 10);
  EXPECT_EQ(ScheduleWithRemainder(0.99999999999, 0.1).Count, 10);

  const SampleSchedule shorter = ScheduleWithRemainder(0.25, 1.0);
  ASSERT_EQ(shorter.Count, 1);
  EXPECT_DOUBLE_EQ(shorter.Interval(0), 1.0);
  const SampleSchedule collapsed = ScheduleWithRemainder(0.0, 1.0);
  ASSERT_EQ(collapsed.Count, 1);
  EXPECT_DOUBLE_EQ(collapsed.Interval(0), 1.0);
  EXPECT_DOUBLE_EQ(collapsed.Position(0), 0.0);
}

TEST(ScheduleWithRemainder, IntervalsFillThePiece)
{
  RandomLattice random(2);
  for (int run = 0; run < 2000; ++run)
  {
    const double length = random.Number(0.0, 20.0);
    const double distance = random.Number(0.05, 3.0);
    const SampleSchedule schedule = ScheduleWithRemainder(length, distance);
    double sum = 0.0;
    for (int i = 0; i < schedule.Count; ++i)
    {
      ASSERT_NEAR(schedule.Position(i), sum, 1e-9);
      sum += schedule.Interval(i);
    }
    ASSERT_NEAR(sum, 1.0, 1e-5);
    const double ratio = length / distance;
    ASSERT_GE(schedule.Count, static_cast<int>(ratio));
    ASSERT_LE(schedule.Count, static_cast<int>(ratio) + 1);
  }
}

TEST(ScheduleEvenly, ClippingRemovesSamplesAndMovesNone)
{
  RandomLattice random(3);
  for (int run = 0; run < 2000; ++run)
  {
    const double length = random.Number(0.0, 20.0);
    const double distance = random.Number(0.1, 3.0);
    const SampleSchedule all = ScheduleEvenly(length, distance, -1.0, 2.0);
    ASSERT_EQ(all.Count, std::max(1, static_cast<int>(std::round(length / distance))));
    ASSERT_DOUBLE_EQ(all.Count * all.Step, 1.0);
    const double from = random.Number(-0.3, 1.2);
    const double to = from + random.Number(0.0, 1.2);
    std::vector<double> expected;
    for (int i = 0; i < all.Count; ++i)
    {
      if (all.Position(i) >= from && all.Position(i) < to)
      {
        expected.push_back(all.Position(i));
      }
    }
    const SampleSchedule clipped = ScheduleEvenly(length, distance, from, to);
    ASSERT_EQ(clipped.Count, static_cast<int>(expected.size()));
    for (int i = 0; i < clipped.Count; ++i)
    {
      ASSERT_NEAR(clipped.Position(i), expected[static_cast<std::size_t>(i)], 1e-14);
      // Each stands for a whole interval, the last one as well.
      ASSERT_EQ(clipped.Interval(i), all.Step);
    }
  }
}

TEST(ScheduleEvenly, AdjacentClipsShareNoSample)
{
  for (int cut = 0; cut <= 40; ++cut)
  {
    const double at = cut / 40.0;
    const int before = ScheduleEvenly(8.0, 1.0, 0.0, at).Count;
    const int after = ScheduleEvenly(8.0, 1.0, at, 1.0).Count;
    ASSERT_EQ(before + after, 8) << at;
  }
}

TEST(Schedules, AbsurdLengthsStayCountable)
{
  for (const double length : { 1e12, 1e300, std::numeric_limits<double>::infinity(),
         std::numeric_limits<double>::quiet_NaN() })
  {
    for (const SampleSchedule& schedule :
      { ScheduleWithRemainder(length, 1.0), ScheduleEvenly(length, 1.0, 0.0, 1.0) })
    {
      EXPECT_GE(schedule.Count, 0);
      EXPECT_LE(schedule.Count, LargestSampleCount);
      EXPECT_TRUE(std::isfinite(schedule.Position(schedule.Count)));
    }
  }
}
