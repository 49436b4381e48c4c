// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "EveryTarget.h"

#include "FFDPixelBytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace
{

/// All but rounding, which may be that of a multiplication and addition in one.
double FindByte(double value)
{
  return std::isnan(value) ? 0.0 : 255.0 * std::clamp(value, 0.0, 1.0);
}

/// Whether the bytes are those of the colors; none is written but theirs.
void Check(const std::vector<float>& colors, std::size_t pixels, bool premultiplied)
{
  constexpr std::uint8_t untouched = 77;
  std::vector<std::uint8_t> bytes(4 * pixels + 64, untouched);
  ffd::WritePixelBytes(colors.data(), pixels, premultiplied, bytes.data());
  for (std::size_t i = 0; i < pixels; ++i)
  {
    const float alpha = colors[4 * i + 3];
    const float scale = premultiplied ? 1.0f : alpha > 0.0f ? 1.0f / alpha : 0.0f;
    for (std::size_t c = 0; c < 4; ++c)
    {
      const float value = colors[4 * i + c];
      const double expected = FindByte(c < 3 ? value * scale : value);
      ASSERT_LE(std::abs(bytes[4 * i + c] - expected), 0.5 + 1e-4)
        << "pixel " << i << " of " << pixels << ", channel " << c << ": " << value;
    }
  }
  EXPECT_TRUE(std::all_of(
    bytes.begin() + 4 * pixels, bytes.end(), [](std::uint8_t b) { return b == untouched; }));
}

} // namespace

TEST(PixelBytes, AreRoundedColors)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<float> color(-0.2f, 1.3f);
  ffd::ForEveryTarget([&] {
    for (std::size_t pixels : { 0, 1, 3, 4, 15, 16, 17, 64, 131 })
    {
      std::vector<float> colors(4 * pixels);
      std::generate(colors.begin(), colors.end(), [&] { return color(random); });
      Check(colors, pixels, true);
      Check(colors, pixels, false);
    }
  });
}

TEST(PixelBytes, AreThoseOfAllBytes)
{
  std::vector<float> colors(4 * 256);
  for (std::size_t i = 0; i < colors.size(); ++i)
  {
    colors[i] = static_cast<float>(i / 4) / 255.0f;
  }
  ffd::ForEveryTarget([&] {
    std::vector<std::uint8_t> bytes(colors.size());
    ffd::WritePixelBytes(colors.data(), 256, true, bytes.data());
    for (std::size_t i = 0; i < bytes.size(); ++i)
    {
      ASSERT_EQ(bytes[i], i / 4);
    }
  });
}

TEST(PixelBytes, OfWhatIsNoColor)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> colors = { nan, infinity, -infinity, 1e30f, 0.5f, -1e30f, nan, nan, 0.2f,
    0.1f, 1e-3f, 0.0f, nan, nan, nan, nan, 1e-40f, 1e-40f, 0.0f, 1e-40f };
  ffd::ForEveryTarget([&] {
    std::uint8_t bytes[20];
    ffd::WritePixelBytes(colors.data(), 5, true, bytes);
    const std::uint8_t expected[16] = { 0, 255, 0, 255, 128, 0, 0, 0, 51, 26, 0, 0, 0, 0, 0, 0 };
    EXPECT_TRUE(std::equal(expected, expected + 16, bytes));
    ffd::WritePixelBytes(colors.data(), 5, false, bytes);
    // Without alpha, or with none that is a number.
    EXPECT_TRUE(std::all_of(bytes + 4, bytes + 16, [](std::uint8_t b) { return b == 0; }));
  });
}

TEST(PixelBytes, AreBlended)
{
  // All bytes over all, with all alphas; colors that are brighter than their alpha, too.
  std::vector<std::uint8_t> over;
  std::vector<std::uint8_t> below;
  for (int alpha = 0; alpha < 256; ++alpha)
  {
    for (int b = 0; b < 256; ++b)
    {
      for (int c = 0; c < 3; ++c)
      {
        over.push_back(static_cast<std::uint8_t>((alpha * (c + 1) / 2 + 5 * c) % 256));
        below.push_back(static_cast<std::uint8_t>((b + 85 * c) % 256));
      }
      over.push_back(static_cast<std::uint8_t>(alpha));
      below.push_back(static_cast<std::uint8_t>(b));
    }
  }
  ffd::ForEveryTarget([&] {
    for (std::size_t pixels : { over.size() / 4, std::size_t{ 1 }, std::size_t{ 13 } })
    {
      std::vector<std::uint8_t> blended = below;
      ffd::BlendPixelBytes(over.data(), pixels, blended.data());
      for (std::size_t i = 0; i < blended.size(); ++i)
      {
        const double seen = below[i] * (255.0 - over[i / 4 * 4 + 3]) / 255.0;
        ASSERT_EQ(
          blended[i], i < 4 * pixels ? std::min(255.0, over[i] + std::floor(seen + 0.5)) : below[i])
          << "byte " << i << " of " << pixels << " pixels";
      }
    }
  });
}
