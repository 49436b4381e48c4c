// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The distance transform against the search over all pairs.
#include "FFDVoxelDistance.h"

#include "RandomLattice.h"
#include "TestVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace
{

std::vector<std::uint16_t> SearchAll(
  const glm::ivec3& dims, const std::vector<std::uint16_t>& marks)
{
  std::vector<glm::ivec3> seeds;
  for (std::size_t i = 0; i < marks.size(); ++i)
  {
    if (marks[i] == 0)
    {
      const int n = static_cast<int>(i);
      seeds.emplace_back(n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y));
    }
  }
  std::vector<std::uint16_t> distances(marks.size(), ffd::NothingVisible);
  for (std::size_t i = 0; i < marks.size(); ++i)
  {
    const int n = static_cast<int>(i);
    const glm::ivec3 at(n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y));
    for (const glm::ivec3& seed : seeds)
    {
      const glm::ivec3 d = glm::abs(at - seed);
      distances[i] =
        std::min(distances[i], static_cast<std::uint16_t>(std::max({ d.x, d.y, d.z })));
    }
  }
  return distances;
}

} // namespace

TEST(VoxelDistance, EqualsTheSearchOverAllPairs)
{
  RandomLattice random(31);
  for (int test = 0; test < 60; ++test)
  {
    const glm::ivec3 dims(random.Integer(1, 17), random.Integer(1, 15), random.Integer(1, 20));
    std::vector<std::uint16_t> distances(
      static_cast<std::size_t>(dims.x) * dims.y * dims.z, ffd::NothingVisible);
    const int seeds = test % 6;
    for (int s = 0; s < seeds; ++s)
    {
      distances[static_cast<std::size_t>(
        random.Integer(0, static_cast<int>(distances.size()) - 1))] = 0;
    }
    const std::vector<std::uint16_t> expected = SearchAll(dims, distances);
    EXPECT_TRUE(ffd::FindChebyshevDistances(dims, distances.data(), [](double) { return true; }));
    EXPECT_EQ(distances, expected);
  }
}

TEST(VoxelDistance, StopsWhenAsked)
{
  std::vector<std::uint16_t> distances(4 * 4 * 100, ffd::NothingVisible);
  int calls = 0;
  double last = 0.0;
  EXPECT_FALSE(ffd::FindChebyshevDistances({ 4, 4, 100 }, distances.data(), [&](double part) {
    EXPECT_GT(part, last);
    last = part;
    return ++calls < 3;
  }));
  EXPECT_EQ(calls, 3);
}

TEST(VoxelDistance, MarksWhatTheTableShows)
{
  const float rgb[] = { 1, 1, 1, 1, 1, 1, 1, 1, 1 };
  const float opacity[] = { 0.0f, 0.0f, 1.0f }; // visible above 50
  const ffd::TransferTable table(0.0, 100.0, 3, rgb, opacity, 1.0);
  for (const ffd::ScalarType type : AllScalarTypes)
  {
    for (const int stride : { 1, 3 })
    {
      const TestVolume volume(
        type, { 5, 4, 6 }, [](int i, int j, int k) { return i + 4 * j + 16 * k; }, stride);
      std::vector<std::uint16_t> marks(5 * 4 * 6, 77);
      ffd::MarkVisibleVoxels(volume.View, table, 2, 5, marks.data());
      for (int n = 0; n < 120; ++n)
      {
        const glm::ivec3 at(n % 5, n / 5 % 4, n / 20);
        const bool visible = at.x + 4 * at.y + 16 * at.z > 50;
        const std::uint16_t expected = visible ? 0 : ffd::NothingVisible;
        EXPECT_EQ(marks[static_cast<std::size_t>(n)], at.z < 2 || at.z >= 5 ? 77 : expected);
      }
    }
  }
  const TestVolume nan(ffd::ScalarType::Float32, { 2, 2, 2 },
    [](int, int, int) { return std::numeric_limits<double>::quiet_NaN(); });
  std::vector<std::uint16_t> marks(8);
  ffd::MarkVisibleVoxels(nan.View, table, 0, 2, marks.data());
  EXPECT_EQ(marks[3], ffd::NothingVisible);
}
