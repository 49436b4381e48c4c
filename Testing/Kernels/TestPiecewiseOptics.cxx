// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTransferTable.h"
#include "Packets/FFDPiecewiseOptics.h"
#include "TestVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

using namespace ffd;

namespace
{

/// A channel of the pieces at a value, as packets find it.
double Find(const PiecewiseOptics& optics, int channel, double value)
{
  const double x =
    std::clamp(value, static_cast<double>(optics.Begin[0]), static_cast<double>(optics.End));
  int piece = 0;
  while (piece + 1 < optics.Pieces && x >= static_cast<double>(optics.Begin[piece + 1]))
  {
    ++piece;
  }
  const PiecewiseOptics::Channel& of = optics.Channels[channel];
  return static_cast<double>(of.Begin[piece]) +
    (x - static_cast<double>(optics.Begin[piece])) * static_cast<double>(of.Slope[piece]);
}

double FindOpacity(const PiecewiseOptics& optics, double value)
{
  return std::max(0.0, Find(optics, 0, value));
}

PiecewiseOptics FindPieces(const TransferTable& table)
{
  return FindPiecewiseOptics(table, table.GetLow(), table.GetScale(), table.GetUnitDistance());
}

double OpacityOf(double extinction) { return 1.0 - std::exp2(-extinction); }

} // namespace

TEST(PiecewiseOptics, LinesBetweenPointsAreOnePieceEach)
{
  const auto ramp = [](double x) { return 0.9 * std::clamp((x - 70.0) / 20.0, 0.0, 1.0); };
  const TransferTable table = MakeTable(0.0, 255.0, 1021, ramp);
  const PiecewiseOptics optics = FindPieces(table);
  EXPECT_EQ(optics.Pieces, 3);
  for (double x = -20.0; x < 280.0; x += 0.37)
  {
    EXPECT_NEAR(FindOpacity(optics, x), ramp(x), 1e-3) << x;
  }
}

TEST(PiecewiseOptics, TellsWhatTheTableTells)
{
  // Points that are no entries, curves, colors with points of their own.
  std::vector<float> rgb;
  std::vector<float> opacities;
  constexpr std::size_t Size = 1024;
  for (std::size_t i = 0; i < Size; ++i)
  {
    const double x = static_cast<double>(i) / (Size - 1);
    rgb.push_back(static_cast<float>(std::min(1.0, 3.0 * x)));
    rgb.push_back(static_cast<float>(std::abs(2.0 * x - 1.0)));
    rgb.push_back(static_cast<float>(0.1 * x * x));
    opacities.push_back(static_cast<float>(std::max(0.0, 0.6 - 2.0 * std::abs(x - 0.4))));
  }
  const TransferTable table(-500.0, 1500.0, Size, rgb.data(), opacities.data(), 1.0);
  const PiecewiseOptics optics = FindPieces(table);
  ASSERT_GT(optics.Pieces, 4);
  for (double x = -600.0; x < 1600.0; x += 0.71)
  {
    const TransferTable::Sample sample = table.Lookup(x);
    const double opacity = OpacityOf(static_cast<double>(sample.Extinction));
    EXPECT_NEAR(FindOpacity(optics, x), opacity, 3e-3 * opacity + 1e-4) << x;
    for (int c = 0; c < 3; ++c)
    {
      EXPECT_NEAR(Find(optics, c + 1, x), static_cast<double>(sample.Color[c]), 1.1 / 1024.0) << x;
    }
  }
}

TEST(PiecewiseOptics, TransparentIsWhatTheTableHasTransparent)
{
  const auto tents = [](double x) {
    return std::max({ 0.0, 0.5 - std::abs(x - 50.0) / 10.0, 0.8 - std::abs(x - 80.0) / 10.0 });
  };
  const TransferTable table = MakeTable(0.0, 100.0, 1001, tents);
  const PiecewiseOptics optics = FindPieces(table);
  ASSERT_GT(optics.Pieces, 0);
  for (double x = -1.0; x < 101.0; x += 0.0021)
  {
    // Both are 0 up to a thousandth of an entry beyond a transparent one; here all but there.
    const double entry = x * 10.0;
    if (std::abs(entry - std::round(entry)) > 0.01)
    {
      EXPECT_EQ(FindOpacity(optics, x) > 0.0, table.Lookup(x).Extinction > 0.0f) << x;
    }
  }
  const double inside = 0.5 * static_cast<double>(table.GetMargin()) / table.GetScale();
  EXPECT_EQ(FindOpacity(optics, 45.0 + inside), 0.0);
  EXPECT_GT(FindOpacity(optics, 45.0 + 4.0 * inside), 0.0);
  EXPECT_EQ(FindOpacity(optics, 55.0 - inside), 0.0);
}

TEST(PiecewiseOptics, UnitDistanceAndOpaqueEnds)
{
  const float rgb[] = { 0.0f, 0.0f, 0.0f, 0.5f, 0.5f, 0.5f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f,
    1.0f, 1.0f, 1.0f };
  const float opacity[] = { 0.0f, 0.25f, 0.5f, 0.75f, 1.0f };
  const TransferTable table(0.0, 4.0, 5, rgb, opacity, 7.0);
  const PiecewiseOptics optics = FindPieces(table);
  EXPECT_EQ(optics.Pieces, 0) << "Pieces of few entries that change much are left to the table.";
  const TransferTable fine =
    MakeTable(0.0, 4.0, 401, [](double x) { return std::min(1.0, 0.25 * x); });
  const PiecewiseOptics line = FindPieces(fine);
  EXPECT_EQ(line.Pieces, 1);
  EXPECT_NEAR(FindOpacity(line, 1.0), 0.25, 1e-3);
  EXPECT_NEAR(FindOpacity(line, 9.0), 1.0, 1e-6);
}

TEST(PiecewiseOptics, OpacitiesOverAnyLength)
{
  const auto ramp = [](double x) { return 0.9 * std::clamp((x - 70.0) / 80.0, 0.0, 1.0); };
  const TransferTable table = MakeTable(
    0.0, 255.0, 2041, ramp, [](double) { return glm::dvec3(1.0); }, 2.0);
  int last = 0;
  for (const double length : { 2.0, 1.5, 1.0, 4.0 })
  {
    const PiecewiseOptics optics =
      FindPiecewiseOptics(table, table.GetLow(), table.GetScale(), length);
    EXPECT_EQ(optics.Length, static_cast<float>(length));
    EXPECT_GT(optics.Pieces, last) << "The more, the more it is curved.";
    last = optics.Pieces;
    for (double x = -20.0; x < 280.0; x += 0.37)
    {
      const double opacity = 1.0 - std::pow(1.0 - ramp(x), length / 2.0);
      EXPECT_NEAR(FindOpacity(optics, x), opacity, 3e-3 * opacity + 1e-4) << x;
    }
  }
  EXPECT_GT(last, 8);
}

TEST(PiecewiseOptics, NothingIsMoreThanOpaque)
{
  const TransferTable table =
    MakeTable(0.0, 255.0, 1021, [](double x) { return std::min(1.0, x / 200.0); });
  for (const double length : { 0.3, 0.5, 0.8, 1.0, 2.0, 5.0 })
  {
    SCOPED_TRACE(length);
    const PiecewiseOptics optics =
      FindPiecewiseOptics(table, table.GetLow(), table.GetScale(), length);
    EXPECT_GT(optics.Pieces, 0);
    for (double x = 0.0; x < 256.0; x += 0.031)
    {
      ASSERT_LE(FindOpacity(optics, x), 1.0 + 1e-6) << x;
    }
    EXPECT_EQ(FindOpacity(optics, 230.0), 1.0);
  }
}

TEST(PiecewiseOptics, BehindTheLastPieceNothingIsReached)
{
  const PiecewiseOptics optics =
    FindPieces(MakeTable(0.0, 255.0, 1021, [](double x) { return x / 512.0; }));
  ASSERT_EQ(optics.Pieces, 1);
  for (int i = 1; i < PiecewiseOptics::LargestNumberOfPieces; ++i)
  {
    EXPECT_GT(optics.Begin[i], 1e38f) << i;
  }
}

TEST(PiecewiseOptics, FunctionsOfManyPiecesHaveNone)
{
  const TransferTable waves =
    MakeTable(0.0, 100.0, 1001, [](double x) { return 0.5 + 0.4 * std::sin(x); });
  EXPECT_EQ(FindPieces(waves).Pieces, 0);
  const TransferTable step =
    MakeTable(0.0, 100.0, 1001, [](double x) { return x > 50.0 ? 0.9 : 0.0; });
  EXPECT_EQ(FindPieces(step).Pieces, 0);
  const TransferTable huge =
    MakeTable(-3e38, 3e38, 1001, [](double x) { return x > 0.0 ? x / 4e38 : 0.0; });
  EXPECT_EQ(FindPieces(huge).Pieces, 0) << "Differences of values are beyond single precision.";
  const TransferTable nothing = MakeTable(0.0, 100.0, 101, [](double) { return 0.0; });
  EXPECT_EQ(FindPieces(nothing).Pieces, 1);
}

TEST(PiecewiseOptics, FactorsAreThoseOfTheTable)
{
  // Between points that are no entries, from zero and back, and up to one.
  constexpr std::size_t Size = 300;
  std::vector<float> factors;
  for (std::size_t i = 0; i < Size; ++i)
  {
    const double x = static_cast<double>(i);
    const double ramp = std::clamp((x - 20.3) / 81.7, 0.0, 1.0);
    factors.push_back(static_cast<float>(x < 250.0 ? ramp : std::max(0.0, 1.0 - (x - 250.0) / 40)));
  }
  const PiecewiseOptics pieces = FindPiecewiseFactors(factors);
  ASSERT_GT(pieces.Pieces, 3);
  ASSERT_LT(pieces.Pieces, 10);
  for (double x = 0.0; x < static_cast<double>(Size + 20); x += 0.13)
  {
    const double entry = std::min(x, static_cast<double>(Size - 1));
    const std::size_t at = std::min(static_cast<std::size_t>(entry), Size - 2);
    const double before = static_cast<double>(factors[at]);
    const double behind = static_cast<double>(factors[at + 1]);
    const double expected = before + (entry - static_cast<double>(at)) * (behind - before);
    EXPECT_NEAR(FindOpacity(pieces, x), expected, 2e-3 * std::max(before, behind) + 1e-6) << x;
    if (before == 0.0 && behind == 0.0)
    {
      EXPECT_EQ(FindOpacity(pieces, x), 0.0) << x;
    }
  }
  // What curves everywhere is not of few lines.
  for (std::size_t i = 0; i < Size; ++i)
  {
    factors[i] = static_cast<float>(0.5 + 0.5 * std::sin(static_cast<double>(i)));
  }
  EXPECT_EQ(FindPiecewiseFactors(factors).Pieces, 0);
}
