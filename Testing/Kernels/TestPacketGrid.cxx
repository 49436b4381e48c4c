// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDAxisMap.h"
#include "FFDCellMask.h"
#include "Packets/FFDPacketGrid.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

namespace ffd
{
namespace
{

/// Positions from 0 to `last` whose steps are powers of 10 between 1 and 10^-digits.
std::vector<double> MakePositions(int count, double last, double digits, unsigned int seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponents(-digits, 0.0);
  std::vector<double> positions{ 0.0 };
  for (int i = 1; i < count; ++i)
  {
    positions.push_back(positions.back() + std::pow(10.0, exponents(random)));
  }
  for (double& each : positions)
  {
    each *= last / positions[positions.size() - 1];
  }
  positions.back() = last;
  return positions;
}

VolumeView MakeView(const AxisMap& axes, int count, double margin)
{
  VolumeView view;
  view.Dimensions = glm::ivec3(count);
  view.Margin = margin;
  view.Axes = &axes;
  return view;
}

/// Positions are found to a part of what single precision leaves of index coordinates.
void CheckPositions(double digits)
{
  constexpr int Count = 40;
  std::vector<double> positions[3];
  for (unsigned int a = 0; a < 3; ++a)
  {
    positions[a] = MakePositions(Count, Count - 1.0, digits, a + 1);
  }
  std::vector<double> copies[3] = { positions[0], positions[1], positions[2] };
  const AxisMap axes(copies, 0.0, 1.0);
  const PacketGrid grid = MakePacketGrid(MakeView(axes, Count, 0.0), nullptr);
  ASSERT_TRUE(grid.Uneven);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> places(0.0, Count - 1.0);
  for (int a = 0; a < 3; ++a)
  {
    const std::vector<double>& p = positions[a];
    for (int i = 0; i < 2000; ++i)
    {
      // At and near voxels, and anywhere.
      const double at = i < Count ? p[static_cast<std::size_t>(i)] : places(random);
      const double rounding = 4e-6;
      const double low = axes.ToVoxel(a, at - rounding);
      const double high = axes.ToVoxel(a, at + rounding);
      const double found = static_cast<double>(grid.Axes[a].ToVoxel(static_cast<float>(at)));
      EXPECT_GE(found, low - 1e-5) << at;
      EXPECT_LE(found, high + 1e-5) << at;
      const double next = std::min(at + 1.0, Count - 1.0);
      const float steepest =
        grid.Axes[a].FindSteepest(static_cast<float>(at), static_cast<float>(next));
      EXPECT_LE(axes.ToVoxel(a, next) - axes.ToVoxel(a, at),
        static_cast<double>(steepest) * (next - at) * (1.0 + 1e-5) + 1e-9);
    }
  }
}

TEST(PacketGrid, FindsVoxelsOfEvenAxes) { CheckPositions(0.0); }

TEST(PacketGrid, FindsVoxelsOfUnevenAxes) { CheckPositions(1.0); }

TEST(PacketGrid, FindsVoxelsOfClusteredAxes) { CheckPositions(6.0); }

TEST(PacketGrid, TellsWidthsOfDifferences)
{
  constexpr int Count = 9;
  // Faces and centers of cells.
  std::vector<double> positions[3];
  for (unsigned int a = 0; a < 3; ++a)
  {
    const std::vector<double> faces = MakePositions(Count + 1, Count, 0.7, a + 1);
    for (std::size_t i = 0; i < faces.size(); ++i)
    {
      if (i > 0)
      {
        positions[a].push_back(0.5 * (faces[i - 1] + faces[i]) - 0.5);
      }
      positions[a].push_back(faces[i] - 0.5);
    }
  }
  const AxisMap axes(positions, -0.5, 0.5);
  const PacketGrid grid = MakePacketGrid(MakeView(axes, Count, 0.5), nullptr);
  for (int a = 0; a < 3; ++a)
  {
    const PacketAxis& axis = grid.Axes[a];
    EXPECT_EQ(axis.LastPlace, 2.0f * (Count - 1));
    for (int i = 0; i <= static_cast<int>(axis.LastPlace); ++i)
    {
      const double voxel = 0.5 * i;
      const double width = axes.ToIndex(a, std::min(voxel + 1.0, Count - 1.0)) -
        axes.ToIndex(a, std::max(voxel - 1.0, 0.0));
      EXPECT_NEAR(static_cast<double>(axis.Widths[static_cast<std::size_t>(i)]), width, 1e-5);
      EXPECT_NEAR(static_cast<double>(axis.Places[static_cast<std::size_t>(i)]),
        axes.ToIndex(a, voxel), 1e-5);
    }
  }
}

TEST(PacketGrid, RepeatsOutermostCells)
{
  CellMask mask(glm::ivec3(9, 3, 2));
  mask.Add({ 0, 2, 0 });
  mask.Add({ 8, 1, 1 });
  const auto has = [&](int i, int j, int k) {
    const int bit = i + CellMask::Pad;
    return (mask.GetBytes()[static_cast<std::size_t>(k + CellMask::Pad) * mask.GetSliceBytes() +
              static_cast<std::size_t>(j + CellMask::Pad) * mask.GetRowBytes() +
              static_cast<std::size_t>(bit / 8)] >>
               bit % 8 &
             1) != 0;
  };
  for (int k = -2; k < 4; ++k)
  {
    for (int j = -2; j < 5; ++j)
    {
      for (int i = -2; i < 11; ++i)
      {
        const glm::ivec3 cell(std::clamp(i, 0, 8), std::clamp(j, 0, 2), std::clamp(k, 0, 1));
        const bool expected = cell == glm::ivec3(0, 2, 0) || cell == glm::ivec3(8, 1, 1);
        EXPECT_EQ(mask.Has(cell), expected);
        EXPECT_EQ(has(i, j, k), expected) << i << " " << j << " " << k;
      }
    }
  }
  EXPECT_TRUE(mask.HasAll({ 8, 1, 1 }, { 8, 1, 1 }));
  EXPECT_FALSE(mask.HasAll({ 7, 1, 1 }, { 8, 1, 1 }));
}

TEST(PacketGrid, BlocksTellOfHiddenCellsNearby)
{
  const glm::ivec3 cells(37, 18, 20);
  const glm::ivec3 hidden[] = { { 0, 0, 0 }, { 13, 5, 6 }, { 36, 17, 19 }, { 22, 9, 13 } };
  CellMask mask(cells);
  for (const glm::ivec3& cell : hidden)
  {
    mask.Add(cell);
  }
  const glm::ivec3 blocks = mask.GetBlocks();
  EXPECT_EQ(blocks, glm::ivec3(6, 3, 3));
  int some = 0;
  for (int b = 0; b < blocks.x * blocks.y * blocks.z; ++b)
  {
    const glm::ivec3 first =
      8 * glm::ivec3(b % blocks.x, b / blocks.x % blocks.y, b / blocks.x / blocks.y) -
      CellMask::Pad;
    const bool isNear =
      std::any_of(std::begin(hidden), std::end(hidden), [&](const glm::ivec3& cell) {
        const glm::ivec3 away = glm::max(first - cell, cell - (first + 7));
        return std::max({ away.x, away.y, away.z }) <= CellMask::Nearby;
      });
    some += isNear ? 1 : 0;
    EXPECT_EQ(mask.GetNearBlocks()[b], isNear ? 1 : 0) << "block " << b;
  }
  EXPECT_GT(some, 4);
  EXPECT_LT(some, blocks.x * blocks.y * blocks.z / 2);
}

} // namespace
} // namespace ffd
