// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDVisibleRectangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

using ffd::VisibleRectangle;

namespace
{

struct Image
{
  glm::ivec2 Size;
  std::vector<float> Colors;

  explicit Image(const glm::ivec2& size)
    : Size(size)
    , Colors(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0.0f)
  {
  }

  float& At(int x, int y, int c)
  {
    return this->Colors[4 * (static_cast<std::size_t>(y) * this->Size.x + x) + c];
  }
};

/// Every pixel looked at.
void FindByBruteForce(Image& image, glm::ivec2& low, glm::ivec2& high)
{
  low = glm::ivec2(std::numeric_limits<int>::max());
  high = glm::ivec2(0);
  for (int y = 0; y < image.Size.y; ++y)
  {
    for (int x = 0; x < image.Size.x; ++x)
    {
      for (int c = 0; c < 4; ++c)
      {
        if (image.At(x, y, c) != 0.0f)
        {
          low = glm::min(low, glm::ivec2(x, y));
          high = glm::max(high, glm::ivec2(x + 1, y + 1));
        }
      }
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
TEST(VisibleRectangle, IsEmptyWithoutVisiblePixels)
{
  Image image({ 37, 11 });
  VisibleRectangle visible;
  visible.AddPixels(image.Colors.data(), 37, { 0, 0 }, image.Size);
  EXPECT_TRUE(visible.IsEmpty());
  visible.Add(VisibleRectangle());
  EXPECT_TRUE(visible.IsEmpty());
}

//------------------------------------------------------------------------------
TEST(VisibleRectangle, HoldsAnyPixelAlone)
{
  const glm::ivec2 size(21, 3);
  for (int y = 0; y < size.y; ++y)
  {
    for (int x = 0; x < size.x; ++x)
    {
      Image image(size);
      image.At(x, y, (x + y) % 4) = 1e-30f;
      VisibleRectangle visible;
      visible.AddPixels(image.Colors.data(), size.x, { 0, 0 }, size);
      EXPECT_EQ(visible.GetLow(), glm::ivec2(x, y));
      EXPECT_EQ(visible.GetHigh(), glm::ivec2(x + 1, y + 1));
    }
  }
}

//------------------------------------------------------------------------------
TEST(VisibleRectangle, TakesPartsInAnyOrder)
{
  std::mt19937 random(7);
  const auto upTo = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  for (int scene = 0; scene < 2000; ++scene)
  {
    Image image({ 1 + upTo(70), 1 + upTo(40) });
    const int pixels = upTo(scene % 3 == 0 ? 3 : 60);
    const glm::ivec2 corner(upTo(image.Size.x - 1), upTo(image.Size.y - 1));
    for (int i = 0; i < pixels; ++i)
    {
      image.At(corner.x + upTo(image.Size.x - 1 - corner.x),
        corner.y + upTo(image.Size.y - 1 - corner.y), upTo(3)) = 0.25f;
    }
    const glm::ivec2 tile(1 + upTo(33), 1 + upTo(17));
    std::vector<glm::ivec2> parts;
    for (int y = 0; y < image.Size.y; y += tile.y)
    {
      for (int x = 0; x < image.Size.x; x += tile.x)
      {
        parts.emplace_back(x, y);
      }
    }
    std::shuffle(parts.begin(), parts.end(), random);
    VisibleRectangle visible[2];
    for (const glm::ivec2& first : parts)
    {
      visible[upTo(1)].AddPixels(
        &image.At(first.x, first.y, 0), image.Size.x, first, glm::min(first + tile, image.Size));
    }
    visible[0].Add(visible[1]);
    glm::ivec2 low;
    glm::ivec2 high;
    FindByBruteForce(image, low, high);
    ASSERT_EQ(visible[0].GetLow(), low) << "scene " << scene;
    ASSERT_EQ(visible[0].GetHigh(), high) << "scene " << scene;
    ASSERT_EQ(visible[0].IsEmpty(), pixels == 0) << "scene " << scene;
  }
}
