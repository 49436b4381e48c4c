// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSampling.h"
#include "RandomLattice.h"
#include "TestVolume.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#if defined(__unix__)
#include <sys/mman.h>
#endif

using namespace ffd;

namespace
{

constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

void ExpectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance)
{
  ASSERT_LE(glm::length(a - b), tolerance)
    << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

} // namespace

TEST(Sampling, LinearFunctionsAreReproducedInEveryType)
{
  RandomLattice random(1);
  for (const ScalarType type : AllScalarTypes)
  {
    for (const int stride : { 1, 3 })
    {
      // Whole numbers from 3 to 3 + 2 * 8 + 3 * 6 + 5 * 10 = 87 fit every type.
      const TestVolume volume(
        type, glm::ivec3(9, 7, 11), [](int i, int j, int k) { return 3 + 2 * i + 3 * j + 5 * k; },
        stride);
      const SampleFunctions f = SelectSampleFunctions(type, Interpolation::Linear);
      const glm::dvec3 upper = volume.View.UpperIndex();
      for (int s = 0; s < 300; ++s)
      {
        const glm::dvec3 q = upper * random.Vector(0.0, 1.0);
        ASSERT_NEAR(f.Value(volume.View, q), 3.0 + 2.0 * q.x + 3.0 * q.y + 5.0 * q.z, 1e-12);
        // Central differences are exact where both neighbors lie inside.
        const glm::dvec3 inner = 1.0 + (upper - 2.0) * random.Vector(0.0, 1.0);
        ExpectNear(f.Gradient(volume.View, inner), glm::dvec3(2.0, 3.0, 5.0), 1e-12);
      }
      EXPECT_EQ(f.Value(volume.View, glm::dvec3(0.0)), 3.0);
      EXPECT_EQ(f.Value(volume.View, upper), 87.0);
    }
  }
}

TEST(Sampling, EqualsTheInterpolationFormula)
{
  RandomLattice random(2);
  const TestVolume volume(ScalarType::Float64, glm::ivec3(5, 6, 7),
    [&](int, int, int) { return random.Number(-1.0, 1.0); });
  const SampleFunctions f = SelectSampleFunctions(ScalarType::Float64, Interpolation::Linear);
  for (int s = 0; s < 2000; ++s)
  {
    const glm::dvec3 q = volume.View.UpperIndex() * random.Vector(0.0, 1.0);
    ASSERT_NEAR(f.Value(volume.View, q), volume.Interpolate(q), 1e-14);
  }
}

TEST(Sampling, NearestTakesTheNearestVoxel)
{
  RandomLattice random(3);
  const TestVolume volume(
    ScalarType::UInt8, glm::ivec3(5, 6, 7), [&](int, int, int) { return random.Integer(0, 255); });
  const SampleFunctions f = SelectSampleFunctions(ScalarType::UInt8, Interpolation::Nearest);
  for (int s = 0; s < 2000; ++s)
  {
    const glm::dvec3 q = volume.View.UpperIndex() * random.Vector(0.0, 1.0);
    const glm::ivec3 n(glm::floor(q + 0.5));
    ASSERT_EQ(f.Value(volume.View, q), volume.At(n.x, n.y, n.z));
  }
}

TEST(Sampling, GradientOfQuadraticFunctions)
{
  // Central differences are exact for quadratics at voxels; between them the trilinear values
  // bend by less than the second difference.
  const auto quadratic = [](const glm::dvec3& p) {
    return p.x * p.x + 0.5 * p.y * p.y - p.z * p.z + p.x * p.y;
  };
  const TestVolume volume(ScalarType::Float64, glm::ivec3(9),
    [&](int i, int j, int k) { return quadratic(glm::dvec3(i, j, k)); });
  const SampleFunctions f = SelectSampleFunctions(ScalarType::Float64, Interpolation::Linear);
  RandomLattice random(4);
  for (int s = 0; s < 500; ++s)
  {
    const glm::dvec3 q = glm::floor(1.0 + 6.999 * random.Vector(0.0, 1.0));
    ExpectNear(
      f.Gradient(volume.View, q), glm::dvec3(2.0 * q.x + q.y, q.y + q.x, -2.0 * q.z), 1e-12);
  }
}

TEST(Sampling, GradientOfALinearFunctionUpToTheFaces)
{
  const auto linear = [](int i, int j, int k) { return i + 10 * j + 100 * k; };
  RandomLattice random(5);
  for (const int n : { 2, 3, 4, 7 })
  {
    const TestVolume volume(ScalarType::Float32, glm::ivec3(n), linear);
    for (const double margin : { 0.0, 0.5 })
    {
      VolumeView view = volume.View;
      view.Margin = margin;
      for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Nearest })
      {
        const SampleFunctions f = SelectSampleFunctions(ScalarType::Float32, interpolation);
        const glm::dvec3 slope(1.0, 10.0, 100.0);
        ExpectNear(f.Gradient(view, view.LowerIndex()), slope, 1e-12);
        ExpectNear(f.Gradient(view, view.UpperIndex()), slope, 1e-12);
        for (int s = 0; s < 200; ++s)
        {
          const glm::dvec3 q =
            view.LowerIndex() + (view.UpperIndex() - view.LowerIndex()) * random.Vector(0.0, 1.0);
          ExpectNear(f.Gradient(view, q), slope, 1e-10);
        }
      }
    }
  }
}

TEST(Sampling, NearestGradientIsThatOfTheNearestVoxel)
{
  RandomLattice random(6);
  const TestVolume volume(
    ScalarType::UInt8, glm::ivec3(5, 6, 7), [&](int, int, int) { return random.Integer(0, 255); });
  const SampleFunctions f = SelectSampleFunctions(ScalarType::UInt8, Interpolation::Nearest);
  for (int s = 0; s < 500; ++s)
  {
    const glm::dvec3 q = volume.View.UpperIndex() * random.Vector(0.0, 1.0);
    const glm::ivec3 n(glm::floor(q + 0.5));
    glm::dvec3 expected;
    for (int a = 0; a < 3; ++a)
    {
      glm::ivec3 low = n;
      glm::ivec3 high = n;
      low[a] = std::max(n[a] - 1, 0);
      high[a] = std::min(n[a] + 1, volume.View.Dimensions[a] - 1);
      expected[a] =
        (volume.At(high.x, high.y, high.z) - volume.At(low.x, low.y, low.z)) / (high[a] - low[a]);
    }
    ExpectNear(f.Gradient(volume.View, q), expected, 1e-12);
  }
}

TEST(Sampling, TwoVoxelsPerAxisAreEnough)
{
  const TestVolume volume(
    ScalarType::Int16, glm::ivec3(2), [](int i, int j, int k) { return i + 2 * j + 4 * k; });
  const SampleFunctions f = SelectSampleFunctions(ScalarType::Int16, Interpolation::Linear);
  EXPECT_DOUBLE_EQ(f.Value(volume.View, glm::dvec3(0.5)), 3.5);
  EXPECT_DOUBLE_EQ(f.Value(volume.View, glm::dvec3(1.0)), 7.0);
  ExpectNear(f.Gradient(volume.View, glm::dvec3(0.5)), glm::dvec3(1.0, 2.0, 4.0), 1e-12);
}

TEST(Sampling, NotANumberSpreadsToItsNeighborsOnly)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(6),
    [](int i, int j, int k) { return i == 3 && j == 3 && k == 3 ? NaN : 1.0; });
  const SampleFunctions f = SelectSampleFunctions(ScalarType::Float32, Interpolation::Linear);
  EXPECT_TRUE(std::isnan(f.Value(volume.View, glm::dvec3(2.5, 3.5, 3.0))));
  EXPECT_EQ(f.Value(volume.View, glm::dvec3(1.5, 3.5, 3.0)), 1.0);
}

#if defined(__unix__) && !defined(__SANITIZE_THREAD__)
TEST(Sampling, IndicesBeyond32Bits)
{
  // 2^32 voxels of which only the touched pages exist.
  const glm::ivec3 size(2048, 2048, 1024);
  const std::size_t bytes = static_cast<std::size_t>(2048) * 2048 * 1024;
  void* memory = mmap(
    nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  VolumeView view;
  view.Scalars = memory;
  view.Type = ScalarType::UInt8;
  view.Dimensions = size;
  view.Increments[0] = 1;
  view.Increments[1] = 2048;
  view.Increments[2] = 2048 * 2048;
  auto* voxels = static_cast<unsigned char*>(memory);
  voxels[bytes - 1] = 200;
  // Where an index of 32 bits would wrap to.
  voxels[0] = 77;
  voxels[(std::size_t{ 1 } << 31) + 5] = 90; // voxel (5, 0, 512)

  const SampleFunctions f = SelectSampleFunctions(ScalarType::UInt8, Interpolation::Linear);
  const glm::dvec3 upper = view.UpperIndex();
  EXPECT_EQ(f.Value(view, upper), 200.0);
  EXPECT_DOUBLE_EQ(f.Value(view, upper - glm::dvec3(0.0, 0.0, 0.5)), 100.0);
  ExpectNear(f.Gradient(view, upper), glm::dvec3(200.0), 1e-12);
  EXPECT_EQ(f.Value(view, glm::dvec3(5.0, 0.0, 512.0)), 90.0);
  const SampleFunctions nearest = SelectSampleFunctions(ScalarType::UInt8, Interpolation::Nearest);
  EXPECT_EQ(nearest.Value(view, upper), 200.0);
  munmap(memory, bytes);
}
#endif
