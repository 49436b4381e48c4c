// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTransferTable.h"
#include "RandomLattice.h"
#include "TestVolume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace ffd;

namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();
}

TEST(TransferTable, InterpolatesBetweenEntries)
{
  const float rgb[] = { 0.0f, 0.5f, 1.0f, 1.0f, 0.5f, 0.0f, 0.0f, 0.0f, 0.0f };
  const float opacity[] = { 0.0f, 0.5f, 0.75f };
  const TransferTable table(-10.0, 30.0, 3, rgb, opacity, 1.0);
  const TransferTable::Sample half = table.Lookup(0.0);
  EXPECT_FLOAT_EQ(half.Color.r, 0.5f);
  EXPECT_FLOAT_EQ(half.Color.g, 0.5f);
  EXPECT_FLOAT_EQ(half.Color.b, 0.5f);
  // Halfway to 1 = -log2(1 - 0.5).
  EXPECT_NEAR(half.Extinction, 0.5f, table.GetMargin());
  EXPECT_FLOAT_EQ(table.Lookup(10.0).Extinction, 1.0f);
  EXPECT_FLOAT_EQ(table.Lookup(20.0).Extinction, 1.5f);
  EXPECT_FLOAT_EQ(table.Lookup(30.0).Extinction, 2.0f);
}

TEST(TransferTable, NextToATransparentEntryIsTransparent)
{
  const auto tent = [](double x) { return std::max(0.0, 1.0 - std::abs(x - 50.0) / 10.0); };
  const TransferTable table = MakeTable(0.0, 100.0, 101, tent);
  const double near = 0.9 * static_cast<double>(table.GetMargin());
  const double far = 1.1 * static_cast<double>(table.GetMargin());
  EXPECT_EQ(table.Lookup(40.0 + near).Extinction, 0.0f);
  EXPECT_GT(table.Lookup(40.0 + far).Extinction, 0.0f);
  EXPECT_EQ(table.Lookup(60.0 - near).Extinction, 0.0f);
  EXPECT_GT(table.Lookup(60.0 - far).Extinction, 0.0f);
  // So limits that end at such an entry are those of samples that nobody sees.
  EXPECT_TRUE(table.IsTransparent(0.0, 40.0));
  EXPECT_FALSE(table.IsTransparent(0.0, 40.0 + far));
  EXPECT_TRUE(table.IsTransparent(60.0, 100.0));
  EXPECT_FALSE(table.IsTransparent(60.0 - far, 100.0));
}

TEST(TransferTable, OutsideOfTheRange)
{
  const float rgb[] = { 0.25f, 0.25f, 0.25f, 1.0f, 1.0f, 1.0f };
  const float opacity[] = { 0.5f, 0.75f };
  const TransferTable table(0.0, 1.0, 2, rgb, opacity, 1.0);
  for (const double below : { -1e-9, -1e9, -1e300, -Infinity })
  {
    EXPECT_EQ(table.Lookup(below).Extinction, 1.0f);
    EXPECT_EQ(table.Lookup(below).Color.g, 0.25f);
  }
  for (const double above : { 1.0, 1e9, 1e300, Infinity })
  {
    EXPECT_FLOAT_EQ(table.Lookup(above).Extinction, 2.0f);
    EXPECT_FLOAT_EQ(table.Lookup(above).Color.g, 1.0f);
  }
  EXPECT_EQ(table.Lookup(NaN).Extinction, 0.0f);
  // It may be the color of a sample whose opacity is known: that of the packet kernels.
  EXPECT_EQ(table.Lookup(NaN).Color.g, 0.25f);
}

TEST(TransferTable, BadEntriesBecomeHarmless)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float rgb[] = { nan, -1.0f, 2.0f, nan, -1.0f, 2.0f, nan, -1.0f, 2.0f };
  const float opacity[] = { nan, -1.0f, 2.0f };
  const TransferTable table(0.0, 2.0, 3, rgb, opacity, 1.0);
  EXPECT_EQ(table.Lookup(0.0).Extinction, 0.0f);
  EXPECT_EQ(table.Lookup(1.0).Extinction, 0.0f);
  const TransmittanceTable transmittance;
  EXPECT_EQ(transmittance(table.Lookup(2.0).Extinction), 0.0f);
  for (const double x : { 0.0, 0.3, 1.0, 1.7, 2.0 })
  {
    EXPECT_EQ(table.Lookup(x).Color, glm::vec3(0.0f, 0.0f, 1.0f));
  }
}

TEST(TransferTable, OpacityCorrection)
{
  const TransmittanceTable transmittance;
  for (const double unit : { 0.01, 1.0, 250.0 })
  {
    for (double a = 0.0; a < 1.0; a += 0.0831)
    {
      const TransferTable table = MakeTable(
        0.0, 1.0, 2, [a](double) { return a; }, [](double) { return glm::dvec3(1.0); }, unit);
      for (double d = 1e-4; d < 60.0; d *= 1.7)
      {
        // Opacity of an interval d from that of the unit: 1 - (1 - a)^(d / u).
        const double expected = std::pow(1.0 - static_cast<float>(a), d);
        const float depth = table.Lookup(0.5).Extinction * static_cast<float>(d * unit);
        ASSERT_NEAR(transmittance(depth), expected, 4e-6) << a << " over " << d;
      }
    }
  }
}

TEST(TransferTable, FullAndNoOpacity)
{
  const TransmittanceTable transmittance;
  for (const double unit : { 1e-6, 1.0, 1e6 })
  {
    const auto white = [](double) { return glm::dvec3(1.0); };
    const TransferTable opaque = MakeTable(
      0.0, 1.0, 2, [](double) { return 1.0; }, white, unit);
    const TransferTable clear = MakeTable(
      0.0, 1.0, 2, [](double) { return 0.0; }, white, unit);
    for (const double d : { 2e-6, 1e-3, 1.0, 1e3 })
    {
      EXPECT_EQ(transmittance(opaque.Lookup(0.3).Extinction * static_cast<float>(d * unit)), 0.0f);
      EXPECT_EQ(transmittance(clear.Lookup(0.3).Extinction * static_cast<float>(d * unit)), 1.0f);
    }
    EXPECT_EQ(transmittance(opaque.Lookup(0.3).Extinction * 0.0f), 1.0f);
  }
}

TEST(TransferTable, TinyUnitDistancesStayFinite)
{
  const auto ramp = [](double x) { return x; };
  const TransferTable table = MakeTable(
    0.0, 1.0, 11, ramp, [](double) { return glm::dvec3(1.0); }, 1e-300);
  const TransmittanceTable transmittance;
  for (double x = 0.0; x <= 1.0; x += 0.05)
  {
    const float extinction = table.Lookup(x).Extinction;
    ASSERT_TRUE(std::isfinite(extinction)) << x;
    ASSERT_TRUE(std::isfinite(transmittance(extinction * 0.0f)));
    ASSERT_EQ(extinction > 0.0f, x > 0.0);
  }
}

TEST(TransferTable, TransparentIntervalsAreTransparent)
{
  RandomLattice random(1);
  int transparent = 0;
  int visible = 0;
  for (int run = 0; run < 200; ++run)
  {
    // Opacity in a few random entries only.
    const std::size_t size = static_cast<std::size_t>(random.Integer(2, 300));
    std::vector<float> opacity(size, 0.0f);
    std::vector<float> rgb(3 * size, 1.0f);
    for (int i = random.Integer(0, 4); i > 0; --i)
    {
      opacity[static_cast<std::size_t>(random.Integer(0, static_cast<int>(size) - 1))] = 0.3f;
    }
    const TransferTable table(-5.0, 17.0, size, rgb.data(), opacity.data(), 1.0);
    for (int i = 0; i < 50; ++i)
    {
      const double a = random.Number(-8.0, 20.0);
      const double b = a + random.Number(0.0, 1.0) * random.Number(0.0, 28.0);
      bool anyVisible = false;
      for (int s = 0; s <= 200; ++s)
      {
        anyVisible = anyVisible || table.Lookup(a + (b - a) * s / 200.0).Extinction > 0.0f;
      }
      const bool claim = table.IsTransparent(a, b);
      ASSERT_FALSE(claim && anyVisible) << a << " to " << b;
      transparent += claim ? 1 : 0;
      visible += anyVisible ? 1 : 0;
    }
  }
  EXPECT_GT(transparent, 1000);
  EXPECT_GT(visible, 1000);
  // Not conservative beyond need: two whole entries away from anything visible.
  const TransferTable step =
    MakeTable(0.0, 100.0, 101, [](double x) { return x >= 50.0 ? 1.0 : 0.0; });
  EXPECT_TRUE(step.IsTransparent(0.0, 48.0));
  EXPECT_FALSE(step.IsTransparent(0.0, 49.5));
  EXPECT_FALSE(step.IsTransparent(70.0, 70.0));
  EXPECT_TRUE(step.IsTransparent(1.0, 0.0));
  EXPECT_FALSE(step.IsTransparent(-Infinity, Infinity));
}

TEST(TransmittanceTable, ErrorIsBelowTheStatedBound)
{
  const TransmittanceTable transmittance;
  for (double x = 0.0; x < 30.0; x += 0.00037)
  {
    ASSERT_NEAR(transmittance(static_cast<float>(x)), std::exp2(-x), 2e-6) << x;
  }
  EXPECT_EQ(transmittance(0.0f), 1.0f);
  EXPECT_EQ(transmittance(24.0f), 0.0f);
  EXPECT_EQ(transmittance(std::numeric_limits<float>::infinity()), 0.0f);
  EXPECT_TRUE(std::isfinite(transmittance(std::numeric_limits<float>::quiet_NaN())));
}
