// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "EveryTarget.h"
#include "FFDMinMaxBlocks.h"
#include "FFDValuePeaks.h"
#include "RandomLattice.h"
#include "TestVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace ffd;

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

/// Extremes of the numbers among the voxels that a block's trilinear samples use.
MinMaxBlocks::Limits BruteForce(const TestVolume& volume, const glm::ivec3& block)
{
  MinMaxBlocks::Limits limits{ Infinity, -Infinity };
  volume.ForEach([&](int i, int j, int k) {
    const glm::ivec3 from = block * MinMaxBlocks::BlockSize;
    const glm::ivec3 to = from + MinMaxBlocks::BlockSize;
    const double value = volume.At(i, j, k);
    if (i >= from.x && j >= from.y && k >= from.z && i <= to.x && j <= to.y && k <= to.z &&
      !std::isnan(value))
    {
      limits.Min = std::min(limits.Min, value);
      limits.Max = std::max(limits.Max, value);
    }
  });
  return limits;
}

template <class Check>
void ForEachBlock(const MinMaxBlocks& blocks, const Check& check)
{
  const glm::ivec3 n = blocks.GetBlocks();
  std::size_t index = 0;
  for (int k = 0; k < n.z; ++k)
  {
    for (int j = 0; j < n.y; ++j)
    {
      for (int i = 0; i < n.x; ++i)
      {
        check(glm::ivec3(i, j, k), blocks.GetLimits(glm::ivec3(i, j, k)));
        ++index;
      }
    }
  }
  EXPECT_EQ(index, blocks.GetNumberOfBlocks());
}

} // namespace

TEST(MinMaxBlocks, BlocksCoverTheCells)
{
  // 2 voxels are 1 cell, 5 voxels 4 cells: one block; 6 voxels need a second one.
  const auto blocks = [](int n) {
    const TestVolume volume(
      ScalarType::UInt8, glm::ivec3(n, 2, 2), [](int, int, int) { return 0.0; });
    return MinMaxBlocks(volume.View, ParallelFor()).GetBlocks();
  };
  EXPECT_EQ(blocks(2), glm::ivec3(1));
  EXPECT_EQ(blocks(5), glm::ivec3(1));
  EXPECT_EQ(blocks(6), glm::ivec3(2, 1, 1));
  EXPECT_EQ(blocks(9), glm::ivec3(2, 1, 1));
  EXPECT_EQ(blocks(10), glm::ivec3(3, 1, 1));
}

TEST(MinMaxBlocks, ContainBruteForceLimitsForEveryType)
{
  ForEveryTarget([] {
    RandomLattice random(1);
    for (const ScalarType type : AllScalarTypes)
    {
      for (int run = 0; run < 12; ++run)
      {
        // Some rows are longer than vectors.
        const glm::ivec3 size(
          random.Integer(2, run < 3 ? 200 : 14), random.Integer(2, 14), random.Integer(2, 14));
        // Ranges from a few codes to more than a word can count; signed where the type is.
        const bool isByte = type == ScalarType::Int8 || type == ScalarType::UInt8;
        const double width = isByte ? 100.0 : std::pow(10.0, 1 + run % 4);
        const bool isUnsigned = type == ScalarType::UInt8 || type == ScalarType::UInt16 ||
          type == ScalarType::UInt32 || type == ScalarType::UInt64;
        const double base = isUnsigned ? 0.0 : -0.4 * width;
        const TestVolume volume(
          type, size, [&](int i, int, int) { return base + i + width * random.Number(0.0, 1.0); },
          1 + run % 3);
        const MinMaxBlocks blocks(volume.View, ParallelFor());

        const MinMaxBlocks::Limits all = blocks.GetRange();
        double lo = Infinity;
        double hi = -Infinity;
        volume.ForEach([&](int i, int j, int k) {
          lo = std::min(lo, volume.At(i, j, k));
          hi = std::max(hi, volume.At(i, j, k));
        });
        EXPECT_EQ(all.Min, lo);
        EXPECT_EQ(all.Max, hi);

        const bool isWhole = type != ScalarType::Float32 && type != ScalarType::Float64;
        const bool isShort = type == ScalarType::Int16 || type == ScalarType::UInt16;
        const bool exact = isWhole && (hi - lo <= 255.0 || isShort);
        const double code = exact ? 0.0 : (hi - lo) / 65535.0;
        const double rounding = exact ? 0.0 : 1e-12 * width;
        ForEachBlock(blocks, [&](const glm::ivec3& block, const MinMaxBlocks::Limits& limits) {
          const MinMaxBlocks::Limits truth = BruteForce(volume, block);
          ASSERT_LE(limits.Min, truth.Min + rounding);
          ASSERT_GE(limits.Max, truth.Max - rounding);
          // A bit and seven between the limits of the parent.
          const MinMaxBlocks::Limits parent = blocks.GetParentLimits(block / 2);
          ASSERT_LE(parent.Min, limits.Min);
          ASSERT_GE(parent.Max, limits.Max);
          const double unit = exact ? 1.0 : code;
          const double parentWidth = std::max(parent.Max - parent.Min, 127.0 * unit);
          const double slack = 2.0 * code + rounding;
          ASSERT_GE(limits.Min, truth.Min - slack - parentWidth / 2.0 - unit);
          ASSERT_LE(limits.Max,
            truth.Max + slack + (parentWidth > 127.0 * unit ? parentWidth / 127.0 + unit : 0.0));
        });
      }
    }
  });
}

TEST(MinMaxBlocks, FullRangeOfTheIntegerTypes)
{
  ForEveryTarget([] {
    for (const ScalarType type : AllScalarTypes)
    {
      DispatchScalarType(type, [&](auto zero) {
        using T = decltype(zero);
        // The second block holds the largest value, the third the smallest.
        TestVolume volume(type, glm::ivec3(13, 2, 2), [](int, int, int) { return 0.0; });
        T* scalars = const_cast<T*>(static_cast<const T*>(volume.View.Scalars));
        scalars[6] = std::numeric_limits<T>::max();
        scalars[10] = std::numeric_limits<T>::lowest();
        const MinMaxBlocks blocks(volume.View, ParallelFor());
        const double most = static_cast<double>(std::numeric_limits<T>::max());
        const double least = static_cast<double>(std::numeric_limits<T>::lowest());
        // The largest floating-point numbers may count as infinite: differences of them are.
        const double part = std::is_floating_point_v<T> ? 1e-3 : 1.0 - 1e-4;
        EXPECT_TRUE(std::isfinite(blocks.GetRange().Max - blocks.GetRange().Min));
        EXPECT_LE(blocks.GetLimits(glm::ivec3(0, 0, 0)).Min, 0.0);
        EXPECT_GE(blocks.GetLimits(glm::ivec3(0, 0, 0)).Max, 0.0);
        EXPECT_GE(
          blocks.GetLimits(glm::ivec3(1, 0, 0)).Max, std::min(part * most, blocks.GetRange().Max));
        EXPECT_LE(blocks.GetLimits(glm::ivec3(1, 0, 0)).Min, 0.0);
        EXPECT_LE(
          blocks.GetLimits(glm::ivec3(2, 0, 0)).Min, std::max(part * least, blocks.GetRange().Min));
        EXPECT_GE(blocks.GetLimits(glm::ivec3(2, 0, 0)).Max, 0.0);
        EXPECT_LE(
          blocks.GetLimits(glm::ivec3(0, 0, 0)).Min, blocks.GetLimits(glm::ivec3(0, 0, 0)).Max);
      });
    }
  });
}

TEST(MinMaxBlocks, LimitsHoldBesideFillValues)
{
  // The range is so wide that the steps of codes, and rounding errors, are wider than the data.
  ForEveryTarget([] {
    for (const ScalarType type : { ScalarType::Float32, ScalarType::Float64 })
    {
      for (const double fill : { -1e9, -1e13, -1e16, -1e20, -9.99e33, 1e13, 1e20, 9.99e33 })
      {
        RandomLattice random(3);
        const TestVolume volume(type, glm::ivec3(14),
          [&](int, int, int k) { return k < 2 ? fill : random.Number(0.0, 1.0); });
        const MinMaxBlocks blocks(volume.View, ParallelFor());
        ForEachBlock(blocks, [&](const glm::ivec3& block, const MinMaxBlocks::Limits& limits) {
          const MinMaxBlocks::Limits truth = BruteForce(volume, block);
          ASSERT_LE(limits.Min, truth.Min) << fill;
          ASSERT_GE(limits.Max, truth.Max) << fill;
        });
      }
    }
  });
}

TEST(MinMaxBlocks, WhatIsFarFromAllOthersTakesNoSteps)
{
  ForEveryTarget([] {
    constexpr double largest = std::numeric_limits<float>::max();
    const std::pair<ScalarType, double> fills[] = { { ScalarType::Int32, 2e9 },
      { ScalarType::UInt32, 4e9 }, { ScalarType::Int64, 1e18 }, { ScalarType::Float32, 1e4 },
      { ScalarType::Float32, 1e20 }, { ScalarType::Float32, largest },
      { ScalarType::Float64, 1e300 }, { ScalarType::Float64, std::numeric_limits<double>::max() } };
    for (const auto& [type, fill] : fills)
    {
      for (const double sign : { 1.0, -1.0 })
      {
        if (type == ScalarType::UInt32 && sign < 0.0)
        {
          continue;
        }
        // Whole parents have nothing else, and one has both.
        RandomLattice random(3);
        const double end = sign * fill;
        const auto isFilled = [](int i, int k) { return k <= 8 || (i == 12 && k == 20); };
        const TestVolume volume(type, glm::ivec3(26, 9, 26),
          [&](int i, int, int k) { return isFilled(i, k) ? end : random.Number(1000.0, 2000.0); });
        const MinMaxBlocks blocks(volume.View, ParallelFor());
        const double wide = sign > 0.0 ? blocks.GetRange().Max : blocks.GetRange().Min;
        EXPECT_EQ(wide, volume.At(0, 0, 0));
        EXPECT_GE(blocks.GetCommonRange().Min, 1000.0) << end;
        EXPECT_LE(blocks.GetCommonRange().Max, 2000.0) << end;
        int common = 0;
        ForEachBlock(blocks, [&](const glm::ivec3& block, const MinMaxBlocks::Limits& limits) {
          const MinMaxBlocks::Limits truth = BruteForce(volume, block);
          ASSERT_LE(limits.Min, truth.Min) << end;
          ASSERT_GE(limits.Max, truth.Max) << end;
          const MinMaxBlocks::Limits parent = blocks.GetParentLimits(block / 2);
          if (parent.Max <= 2001.0 && parent.Min >= 999.0)
          {
            ++common;
            ASSERT_LE(limits.Max, truth.Max + 1000.0 / 126.0) << end;
          }
          else if (block.z < 2)
          {
            ASSERT_TRUE(sign > 0.0 ? limits.Min > 2000.0 : limits.Max < 1000.0) << end;
          }
        });
        EXPECT_GT(common, 30);
      }
    }
  });
}

// Values that differ in their last bits, as those of a constant that has been computed, beside
// others that are far away from them.
TEST(MinMaxBlocks, RoundingErrorsAreNoEndsOfTheRange)
{
  for (const double common : { 0.1, 100.0, -3.0, 1e200 })
  {
    for (const double far : { 0.0, -1.0, 2.0 })
    {
      const TestVolume volume(ScalarType::Float64, glm::ivec3(61, 9, 9), [&](int i, int, int) {
        double value = i < 14 ? far * common : common;
        for (int n = 0; i >= 14 && n < i / 12; ++n)
        {
          value = std::nextafter(value, 0.0);
        }
        return value;
      });
      const MinMaxBlocks blocks(volume.View, ParallelFor());
      ForEachBlock(blocks, [&](const glm::ivec3& block, const MinMaxBlocks::Limits& limits) {
        const MinMaxBlocks::Limits truth = BruteForce(volume, block);
        ASSERT_LE(limits.Min, truth.Min) << common << ' ' << far;
        ASSERT_GE(limits.Max, truth.Max) << common << ' ' << far;
      });
    }
  }
}

TEST(MinMaxBlocks, ThreeValuesAreToldApart)
{
  ForEveryTarget([] {
    for (const double last : { 60.0, 1e8, 1e30 })
    {
      // Each has parents of its own.
      const TestVolume volume(ScalarType::Float32, glm::ivec3(49, 2, 2), [&](int i, int, int) {
        return i <= 16 ? 0.0 : i <= 32 ? 50.0 : last;
      });
      const MinMaxBlocks blocks(volume.View, ParallelFor());
      EXPECT_EQ(blocks.GetLimits(glm::ivec3(0)).Max, 0.0) << last;
      EXPECT_NEAR(blocks.GetLimits(glm::ivec3(6, 0, 0)).Min, 50.0, 0.01) << last;
      EXPECT_NEAR(blocks.GetLimits(glm::ivec3(6, 0, 0)).Max, 50.0, 0.01) << last;
      EXPECT_NEAR(blocks.GetLimits(glm::ivec3(11, 0, 0)).Min, last, 1e-6 * last);
    }
  });
}

TEST(MinMaxBlocks, NotANumberIsLeftOut)
{
  ForEveryTarget([] {
    for (const ScalarType type : { ScalarType::Float32, ScalarType::Float64 })
    {
      // First block: numbers and NaN; second: NaN only (its first layer is shared); third:
      // infinite.
      const TestVolume volume(type, glm::ivec3(13, 2, 2), [](int i, int j, int) {
        return i >= 4 && i <= 8 ? NaN : i > 8 ? (j ? Infinity : -Infinity) : i == 2 ? NaN : i;
      });
      const MinMaxBlocks blocks(volume.View, ParallelFor());
      EXPECT_EQ(blocks.GetRange().Min, 0.0);
      EXPECT_EQ(blocks.GetRange().Max, 3.0);
      EXPECT_LE(blocks.GetLimits(glm::ivec3(0, 0, 0)).Min, 0.0);
      EXPECT_NEAR(blocks.GetLimits(glm::ivec3(0, 0, 0)).Max, 3.0, 1e-9);
      EXPECT_GT(
        blocks.GetLimits(glm::ivec3(1, 0, 0)).Min, blocks.GetLimits(glm::ivec3(1, 0, 0)).Max);
      // Infinite scalars count as the ends of the range.
      EXPECT_NEAR(blocks.GetLimits(glm::ivec3(2, 0, 0)).Min, 0.0, 1e-9);
      EXPECT_NEAR(blocks.GetLimits(glm::ivec3(2, 0, 0)).Max, 3.0, 1e-9);
    }
  });
}

TEST(MinMaxBlocks, NoNumberAtAll)
{
  for (const double value : { NaN, Infinity, -Infinity })
  {
    const TestVolume volume(
      ScalarType::Float32, glm::ivec3(6), [value](int, int, int) { return value; });
    const MinMaxBlocks blocks(volume.View, ParallelFor());
    EXPECT_GT(blocks.GetRange().Min, blocks.GetRange().Max);
  }
}

TEST(MinMaxBlocks, SameForAnySplitOfTheLoop)
{
  RandomLattice random(2);
  const TestVolume volume(ScalarType::Int16, glm::ivec3(17, 13, 22),
    [&](int, int, int) { return random.Integer(-30000, 30000); });
  const MinMaxBlocks serial(volume.View, ParallelFor());
  const MinMaxBlocks split(volume.View, [](std::size_t count, const auto& work) {
    for (std::size_t i = count; i-- > 0;)
    {
      work(i, i + 1);
    }
  });
  EXPECT_EQ(serial.GetRange().Min, split.GetRange().Min);
  ForEachBlock(serial, [&](const glm::ivec3& block, const MinMaxBlocks::Limits& limits) {
    ASSERT_EQ(limits.Min, split.GetLimits(block).Min);
    ASSERT_EQ(limits.Max, split.GetLimits(block).Max);
  });
}

TEST(MinMaxBlocks, TakeLittleMemory)
{
  for (const ScalarType type : { ScalarType::UInt8, ScalarType::UInt16 })
  {
    const TestVolume volume(
      type, glm::ivec3(65), [](int i, int j, int k) { return i * j * k % 60000; });
    const MinMaxBlocks blocks(volume.View, ParallelFor());
    const double bytes = 65.0 * 65.0 * 65.0 * (type == ScalarType::UInt8 ? 1.0 : 2.0);
    EXPECT_GT(blocks.GetMemorySize(), 0u);
    EXPECT_LT(static_cast<double>(blocks.GetMemorySize()), 0.025 * bytes);
  }
}

/// The bound of the values in a box, as it is looked up; infinite where no cell is as large.
double FindBound(const ValuePeaks& peaks, const float low[3], const float high[3])
{
  const ValuePeaks::Grid* const grid =
    peaks.FindGrid(std::max({ high[0] - low[0], high[1] - low[1], high[2] - low[2] }));
  if (!grid)
  {
    return Infinity;
  }
  glm::ivec3 cell;
  for (int a = 0; a < 3; ++a)
  {
    cell[a] = std::clamp(static_cast<int>(std::floor(low[a] / grid->Edge)), 0, grid->Size[a] - 1);
  }
  const int code = grid->Codes[GridIndex(cell, grid->Size)];
  return code == ValuePeaks::LastCode ? peaks.GetHigh() : peaks.GetLow() + code * peaks.GetStep();
}

TEST(ValuePeaks, BoundTheValuesOfBoxes)
{
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const std::pair<ScalarType, double> fills[] = { { ScalarType::UInt8, 100.0 },
    { ScalarType::Int16, 100.0 }, { ScalarType::Float32, NaN }, { ScalarType::Float32, 1e9 },
    { ScalarType::Float32, -1e9 }, { ScalarType::Float32, 3.4028234663852886e38 } };
  for (const auto& [type, fill] : fills)
  {
    const glm::ivec3 size(75, 40, 61);
    // Smooth, so that bounds can be close, and not a number, or far from all others, in some
    // voxels.
    const TestVolume volume(type, size, [&, of = fill](int i, int j, int k) {
      return i > 60 && j < 10 ? of
                              : 100.0 + 60.0 * std::sin(0.05 * i) * std::cos(0.07 * j) - 0.5 * k;
    });
    const MinMaxBlocks blocks(volume.View, ParallelFor());
    const bool sparing = type == ScalarType::UInt8;
    double looseness = 0.0;
    for (const int sign : { 1, -1 })
    {
      const ValuePeaks peaks(blocks, sign, sparing, ParallelFor());
      EXPECT_FALSE(peaks.IsEmpty());
      for (int turn = 0; turn < 80; ++turn)
      {
        float low[3];
        float high[3];
        const double edge = uniform(0.0, 32.0);
        for (int a = 0; a < 3; ++a)
        {
          low[a] = static_cast<float>(uniform(-3.0, size[a] - 1.0));
          high[a] = low[a] + static_cast<float>(uniform(0.2, 1.0) * edge);
        }
        double largest = -Infinity;
        volume.ForEach([&](int i, int j, int k) {
          const auto within = [&](int at, int a) {
            return at >= std::floor(low[a]) && at <= std::ceil(high[a]);
          };
          const double value = sign * volume.At(i, j, k);
          if (within(i, 0) && within(j, 1) && within(k, 2) && value > largest)
          {
            largest = value;
          }
        });
        const double bound = FindBound(peaks, low, high);
        EXPECT_GE(bound + 1e-9, largest);
        EXPECT_LT(bound, std::max(1e6, 1.1 * std::abs(fill)));
        looseness += std::abs(largest) < 1e6 && bound < 1e6 ? bound - largest : 0.0;
      }
      const float low[3] = { 0.0f, 0.0f, 0.0f };
      const float high[3] = { 40.0f, 1.0f, 1.0f };
      EXPECT_EQ(FindBound(peaks, low, high), Infinity);
    }
    EXPECT_LT(looseness / 160.0, sparing ? 30.0 : 28.0); // the values span some 150
  }
  EXPECT_TRUE(ValuePeaks().IsEmpty());
}
