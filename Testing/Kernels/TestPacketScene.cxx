// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The seeds of Newton's method that are kept, by the Jacobian determinants of T at them.
#include "Packets/FFDPacketScene.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

using namespace ffd;

namespace
{

/// Scene with seeds of some determinants, whose first coordinates are their numbers.
PacketScene KeepThose(const std::vector<float>& determinants)
{
  PacketScene scene;
  for (float determinant : determinants)
  {
    PacketSeed seed{};
    seed.Point[0] = static_cast<float>(scene.Seeds.size());
    seed.Image[0] = 10.0f + seed.Point[0];
    seed.Determinant = determinant;
    scene.Seeds.push_back(seed);
  }
  KeepSeeds(scene);
  EXPECT_EQ(scene.SeedImages[0].size(), PacketScene::LargestNumberOfSeeds);
  EXPECT_EQ(scene.SeedImages[0][0], 10.0f + scene.Seeds[0].Point[0]);
  EXPECT_GT(scene.SeedImages[0][scene.Seeds.size()], 1e17f);
  return scene;
}

} // namespace

TEST(KeepSeeds, KeepsAllOfOneOrientation)
{
  for (float sign : { 1.0f, -1.0f })
  {
    const PacketScene scene = KeepThose({ sign * 1.0f, sign * 0.01f, sign * 3.0f });
    EXPECT_FALSE(scene.Folds);
    EXPECT_EQ(scene.Orientation, sign);
    EXPECT_EQ(scene.Seeds.size(), 3u);
  }
}

TEST(KeepSeeds, LeavesOutWhatIsTurnedOver)
{
  const PacketScene scene = KeepThose({ -1.0f, 2.0f, 0.5f });
  EXPECT_TRUE(scene.Folds);
  EXPECT_EQ(scene.Orientation, 1.0f);
  ASSERT_EQ(scene.Seeds.size(), 2u);
  EXPECT_EQ(scene.Seeds[0].Point[0], 1.0f);
  EXPECT_EQ(KeepThose({ -1.0f, 2.0f, -0.5f }).Orientation, -1.0f);
}

// Rounding decides about the signs there.
TEST(KeepSeeds, LeavesOutWhereTheVolumeIsFlat)
{
  for (float flat : { 1e-12f, -1e-12f })
  {
    const PacketScene scene = KeepThose({ flat, flat, 2.0f, flat, 0.5f });
    EXPECT_TRUE(scene.Folds);
    EXPECT_EQ(scene.Orientation, 1.0f);
    ASSERT_EQ(scene.Seeds.size(), 2u);
    EXPECT_EQ(scene.Seeds[1].Point[0], 4.0f);
  }
}

TEST(KeepSeeds, KeepsSomeWhateverTheyAre)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  for (float all : { nan, infinite, -infinite, 0.0f })
  {
    EXPECT_EQ(KeepThose({ all, all }).Seeds.size(), 2u);
  }
  EXPECT_GE(KeepThose({ nan, infinite, 1.0f }).Seeds.size(), 1u);
}
