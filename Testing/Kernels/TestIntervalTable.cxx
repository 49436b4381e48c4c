// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Optics/FFDIntervalTable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <vector>

using namespace ffd;

namespace
{

/// A gray transfer table over [0, 255], of a function of the scalar that gives the extinction.
TransferTable Make(const std::function<double(double)>& extinction, std::size_t size = 1021)
{
  std::vector<float> rgb(3 * size, 0.5f);
  std::vector<float> opacities(size);
  for (std::size_t i = 0; i < size; ++i)
  {
    const double value = 255.0 * static_cast<double>(i) / static_cast<double>(size - 1);
    opacities[i] = static_cast<float>(1.0 - std::exp2(-extinction(value)));
  }
  return TransferTable(0.0, 255.0, size, rgb.data(), opacities.data(), 1.0);
}

/// The same by adding up 20000 parts of the interval.
ClassifiedInterval Integrate(const TransferTable& table, double front, double back, double length)
{
  constexpr int Parts = 20000;
  ClassifiedInterval interval{ 0.0, 0.0, 0.0 };
  double opacity = 0.0;
  for (int i = 0; i < Parts; ++i)
  {
    const double place = (i + 0.5) / Parts;
    const double value = front + place * (back - front);
    const double depth = std::min<double>(table.Lookup(value).Extinction, 256.0) * length / Parts;
    const double part = (1.0 - opacity) * (1.0 - std::exp2(-depth));
    interval.OpticalDepth += depth;
    interval.Place += part * place;
    interval.Value += part * value;
    opacity += part;
  }
  interval.Place /= opacity;
  interval.Value /= opacity;
  return interval;
}

} // namespace

//------------------------------------------------------------------------------
TEST(IntervalTable, IsExactForRamps)
{
  // Extinction grows with the scalar: that of an interval is the mean of those at its ends.
  const TransferTable table = Make([](double value) { return value / 64.0; });
  const IntervalTable intervals(table, 1.0);
  for (const double front : { 0.0, 3.1, 100.0, 254.9 })
  {
    for (const double back : { 0.0, 3.0, 99.95, 180.0, 255.0 })
    {
      const double mean = 0.5 * (front + back) / 64.0;
      EXPECT_NEAR(intervals.Classify(front, back, 1.0).OpticalDepth, mean, 2e-5 * (1.0 + mean));
      EXPECT_NEAR(intervals.Classify(front, back, 0.3).OpticalDepth, 0.3 * mean, 2e-5);
    }
  }
}

//------------------------------------------------------------------------------
TEST(IntervalTable, FindsWhereAStepIsCrossed)
{
  // Transparent below 100, full extinction from 100.05 on, between two entries.
  const TransferTable table =
    Make([](double value) { return value < 100.02 ? 0.0 : 8.0; }, 255 * 20 + 1);
  const IntervalTable intervals(table, 1.0);
  const double edge = 100.025;
  for (const double front : { 40.0, 90.0, 99.0 })
  {
    const double back = 110.0;
    const double inside = (back - edge) / (back - front);
    const ClassifiedInterval in = intervals.Classify(front, back, 1.0);
    EXPECT_NEAR(in.OpticalDepth, 8.0 * inside, 2e-3) << front;
    const ClassifiedInterval out = intervals.Classify(back, front, 1.0);
    EXPECT_NEAR(out.OpticalDepth, 8.0 * inside, 2e-3) << front;
    // The light comes from a homogeneous part behind the crossing, or before it.
    const double depth = 8.0 * inside * std::log(2.0);
    const double mean = 1.0 / depth - std::exp(-depth) / (1.0 - std::exp(-depth));
    EXPECT_NEAR(in.Place, 1.0 - inside + inside * mean, 0.03) << front;
    EXPECT_NEAR(out.Place, inside * mean, 0.03) << front;
    EXPECT_NEAR(in.Value, front + in.Place * (back - front), 1e-9);
  }
}

//------------------------------------------------------------------------------
TEST(IntervalTable, IsThatOfASampleWhereValuesAreEqual)
{
  const TransferTable table = Make([](double value) { return value < 77.0 ? 0.0 : value / 50.0; });
  const IntervalTable intervals(table, 1.0);
  for (const double value : { -5.0, 0.0, 76.9, 77.1, 200.0, 255.0, 300.0 })
  {
    const ClassifiedInterval interval = intervals.Classify(value, value, 0.7);
    // Samples are interpolated from the margin of the last transparent entry.
    EXPECT_NEAR(interval.OpticalDepth, 0.7 * static_cast<double>(table.Lookup(value).Extinction),
      value == 76.9 ? 1e-3 : 1e-6);
    EXPECT_NEAR(interval.Value, std::clamp(value, 0.0, 255.0), 1e-9);
  }
}

//------------------------------------------------------------------------------
TEST(IntervalTable, IsNearBruteForce)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double meanError = 0.0;
  int count = 0;
  for (int trial = 0; trial < 30; ++trial)
  {
    // Some steep and some gentle functions, from hardly visible to opaque.
    std::vector<double> knots(12);
    for (double& knot : knots)
    {
      knot = uniform(random) < 0.4 ? 0.0 : std::exp2(9.0 * uniform(random) - 5.0);
    }
    const double width = uniform(random) < 0.5 ? 255.0 / 11.0 : 3.0;
    const auto extinction = [&](double value) {
      const double at = value / width;
      const std::size_t i = static_cast<std::size_t>(at);
      const double a = knots[i % 12];
      return a + (at - static_cast<double>(i)) * (knots[(i + 1) % 12] - a);
    };
    const TransferTable table = Make(extinction, 5101);
    const IntervalTable intervals(table, 1.0);
    for (int i = 0; i < 10; ++i)
    {
      const double front = 255.0 * uniform(random);
      const double back = std::clamp(front + 40.0 * (uniform(random) - 0.5), 0.0, 255.0);
      const ClassifiedInterval truth = Integrate(table, front, back, 0.8);
      const ClassifiedInterval interval = intervals.Classify(front, back, 0.8);
      EXPECT_NEAR(interval.OpticalDepth, truth.OpticalDepth, 1e-3 * (1.0 + truth.OpticalDepth));
      EXPECT_TRUE(interval.Place >= 0.0 && interval.Place <= 1.0);
      if (truth.OpticalDepth > 0.01)
      {
        meanError += std::abs(interval.Place - truth.Place);
        ++count;
      }
    }
  }
  EXPECT_LT(meanError / count, 0.06);
}

//------------------------------------------------------------------------------
TEST(IntervalTable, IsExactBehindOpaqueValues)
{
  // Opaque up to 200, hardly visible behind: 16384 entries, most of them opaque.
  const TransferTable table =
    Make([](double value) { return value < 200.0 ? 1000.0
                              : value < 210.0    ? 0.0
                                                 : 0.02; }, 16384);
  const IntervalTable intervals(table, 1.0);
  EXPECT_NEAR(intervals.Classify(220.0, 240.0, 1.0).OpticalDepth, 0.02, 1e-4);
  EXPECT_NEAR(intervals.Classify(220.0, 220.1, 1.0).OpticalDepth, 0.02, 2e-3);
  EXPECT_EQ(intervals.Classify(202.0, 209.0, 1.0).OpticalDepth, 0.0);
  EXPECT_GT(intervals.Classify(205.0, 199.0, 1.0).OpticalDepth, 24.0);
}

//------------------------------------------------------------------------------
TEST(IntervalTable, TakesAMiddleValue)
{
  // A thin shell that both ends miss.
  const TransferTable table =
    Make([](double value) { return std::abs(value - 100.0) < 4.0 ? 6.0 : 0.0; }, 5101);
  const IntervalTable intervals(table, 1.0);
  EXPECT_EQ(intervals.Classify(80.0, 85.0, 1.0).OpticalDepth, 0.0);
  const ClassifiedInterval interval = intervals.Classify(80.0, 100.0, 85.0, 0.25, 1.0);
  EXPECT_NEAR(interval.OpticalDepth, 6.0 * (0.25 * 4.0 / 20.0 + 0.75 * 4.0 / 15.0), 0.01);
  EXPECT_GT(interval.Place, 0.2);
  EXPECT_LT(interval.Place, 0.5);
  EXPECT_GT(interval.Value, 96.0);
  EXPECT_LT(interval.Value, 100.0);
  // The light of an opaque step comes from where it is, before the middle or behind it.
  const TransferTable step = Make([](double value) { return value < 99.0 ? 0.0 : 40.0; }, 5101);
  const IntervalTable steps(step, 1.0);
  const ClassifiedInterval before = steps.Classify(80.0, 120.0, 130.0, 0.5, 1.0);
  EXPECT_NEAR(before.Place, 0.5 * 19.0 / 40.0, 0.05);
  EXPECT_NEAR(before.Value, 99.0, 3.0);
  const ClassifiedInterval behind = steps.Classify(80.0, 90.0, 120.0, 0.5, 1.0);
  EXPECT_NEAR(behind.Place, 0.5 + 0.5 * 9.0 / 30.0, 0.05);
  EXPECT_NEAR(behind.Value, 99.0, 3.0);
  // On the line between the ends it changes nothing.
  const ClassifiedInterval one = intervals.Classify(80.0, 110.0, 1.0);
  const ClassifiedInterval two = intervals.Classify(80.0, 95.0, 110.0, 0.5, 1.0);
  EXPECT_NEAR(one.OpticalDepth, two.OpticalDepth, 1e-5);
}

//------------------------------------------------------------------------------
TEST(IntervalTable, KnowsWhatMayShow)
{
  const TransferTable table =
    Make([](double value) { return value > 100.0 && value < 120.0 ? 1.0 : 0.0; });
  const IntervalTable intervals(table, 1.0);
  EXPECT_FALSE(intervals.MayShow(80.0, 80.0));
  EXPECT_TRUE(intervals.MayShow(90.0, 130.0));
  EXPECT_TRUE(intervals.MayShow(130.0, 90.0));
  EXPECT_TRUE(intervals.MayShow(80.0, 91.0));
  EXPECT_FALSE(intervals.MayShow(80.0, 88.0));
  EXPECT_TRUE(intervals.MayShow(140.0, 128.0));
  EXPECT_FALSE(intervals.MayShow(140.0, 135.0));
  EXPECT_FALSE(IntervalTable(Make([](double) { return 0.0; }), 1.0).MayShow(0.0, 255.0));
}

//------------------------------------------------------------------------------
TEST(IntervalTable, WhatIsNotANumberIsTransparent)
{
  const TransferTable table = Make([](double) { return 5.0; });
  const IntervalTable intervals(table, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(intervals.Classify(nan, 3.0, 1.0).OpticalDepth, 0.0);
  EXPECT_EQ(intervals.Classify(3.0, nan, 1.0).OpticalDepth, 0.0);
  EXPECT_FALSE(intervals.MayShow(nan, 3.0));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(intervals.Classify(3.0, infinity, 1.0).OpticalDepth, 5.0, 1e-3);
}

//------------------------------------------------------------------------------
TEST(IntervalTable, TellsSteepFunctions)
{
  const TransferTable step = Make([](double value) { return value < 100.0 ? 0.0 : 2.0; });
  EXPECT_TRUE(IsSteep(step, 1.0));
  // Over a short interval nothing is opaque.
  EXPECT_FALSE(IsSteep(step, 0.1));
  const TransferTable ramp = Make([](double value) { return value / 128.0; });
  EXPECT_FALSE(IsSteep(ramp, 1.0));
  const TransferTable shell =
    Make([](double value) { return std::abs(value - 100.0) < 1.0 ? 2.0 : 0.0; });
  EXPECT_TRUE(IsSteep(shell, 1.0));
  EXPECT_FALSE(IsSteep(Make([](double) { return 3.0; }), 1.0));
}
