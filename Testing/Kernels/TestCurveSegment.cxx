// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDCurveSegment.h"
#include "RandomLattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace ffd;

TEST(CurveSegment, ParabolaPassesThroughItsThreePoints)
{
  RandomLattice random(1);
  for (int run = 0; run < 100; ++run)
  {
    const glm::dvec3 a = random.Vector(-9.0, 9.0);
    const glm::dvec3 m = random.Vector(-9.0, 9.0);
    const glm::dvec3 b = random.Vector(-9.0, 9.0);
    const CurveSegment segment = CurveSegment::Parabola(a, m, b);
    ASSERT_LE(glm::length(segment.At(0.0) - a), 1e-12);
    ASSERT_LE(glm::length(segment.At(0.5) - m), 1e-12);
    ASSERT_LE(glm::length(segment.At(1.0) - b), 1e-12);
    const double h = 1e-6;
    const double s = random.Number(0.1, 0.9);
    ASSERT_LE(
      glm::length(segment.Velocity(s) - (segment.At(s + h) - segment.At(s - h)) / (2.0 * h)), 1e-7);
    const CurveSegment line = CurveSegment::Line(a, b);
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

TEST(ScheduleWithRemainder, IntervalsFillTheSegment)
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

TEST(ScheduleWithRemainder, AbsurdLengthsStayCountable)
{
  for (const double length : { 1e12, 1e300, std::numeric_limits<double>::infinity(),
         std::numeric_limits<double>::quiet_NaN() })
  {
    const SampleSchedule schedule = ScheduleWithRemainder(length, 1.0);
    EXPECT_GE(schedule.Count, 0);
    EXPECT_LE(schedule.Count, LargestSampleCount);
    EXPECT_TRUE(std::isfinite(schedule.Position(schedule.Count)));
  }
}
