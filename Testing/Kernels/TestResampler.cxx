// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The resampled volume against the pull-back evaluated, and the volume interpolated, point by
// point.
#include "FFDResampler.h"

#include "RandomLattice.h"
#include "TestVolume.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace
{

constexpr ffd::PullBackKind AllKinds[] = { ffd::PullBackKind::FirstOrder, ffd::PullBackKind::Exact,
  ffd::PullBackKind::Forward, ffd::PullBackKind::FirstOrderOfInverse };

double Smooth(int i, int j, int k)
{
  return 100.0 + 40.0 * std::sin(0.3 * i) * std::cos(0.2 * j) + k;
}

/// A volume of side 20 within a smooth lattice; the fields of the tests live in it.
struct Scene
{
  explicit Scene(ffd::ScalarType type, double amount, int stride = 1)
    : Volume(type, { 20, 18, 16 }, Smooth, stride)
  {
    this->Volume.View.IndexToData = glm::dmat3(0.0);
    this->Volume.View.IndexToData[0][0] = 0.5;
    this->Volume.View.IndexToData[1][1] = 0.6;
    this->Volume.View.IndexToData[2][2] = 0.7;
    this->Volume.View.DataToIndex = glm::inverse(this->Volume.View.IndexToData);
    this->Volume.View.FirstVoxel = glm::dvec3(3.0, -2.0, 1.0);
    RandomLattice random(5);
    std::vector<glm::dvec3> displacements(6 * 6 * 6);
    for (glm::dvec3& d : displacements)
    {
      d = random.Vector(-amount, amount);
    }
    this->Field = ffd::BSplineField(
      glm::ivec3(6), glm::dvec3(0.0, -5.0, -2.0), glm::dvec3(3.2, 3.4, 3.6), displacements.data());
    this->Grid.Origin = this->Volume.View.FirstVoxel;
    this->Grid.IndexToData = this->Volume.View.IndexToData;
  }

  std::vector<double> Run(const ffd::PullBack& map, const ffd::ResampleSettings& settings,
    const glm::ivec3& first, const glm::ivec3& last, std::int64_t* unconverged = nullptr) const
  {
    const ffd::Resampler resampler(this->Volume.View, map, this->Grid, settings);
    const glm::ivec3 count = last - first + 1;
    const std::size_t values = static_cast<std::size_t>(count.x) * count.y * count.z *
      static_cast<std::size_t>(this->Volume.View.Increments[0]);
    std::vector<double> storage(values);
    const std::int64_t missed = resampler.Resample(first, last, storage.data(), ffd::ParallelFor());
    if (unconverged)
    {
      *unconverged = missed;
    }
    return ffd::DispatchScalarType(this->Volume.View.Type, [&](auto zero) {
      using T = decltype(zero);
      const T* from = reinterpret_cast<const T*>(storage.data());
      return std::vector<double>(from, from + values);
    });
  }

  TestVolume Volume;
  ffd::BSplineField Field;
  ffd::ImageGrid Grid;
};

} // namespace

TEST(Resampler, EqualsThePullBackPointByPoint)
{
  Scene scene(ffd::ScalarType::Float64, 0.5);
  const glm::ivec3 first(-3, -2, -4);
  const glm::ivec3 last(22, 20, 19);
  for (const ffd::PullBackKind kind : AllKinds)
  {
    const double tolerance = 1e-3;
    const ffd::PullBack map(&scene.Field, kind, tolerance);
    for (const bool unique : { false, true })
    {
      ffd::ResampleSettings settings;
      settings.Background = -5.0;
      settings.UniqueInverse = unique;
      std::int64_t unconverged = -1;
      const std::vector<double> values = scene.Run(map, settings, first, last, &unconverged);
      EXPECT_EQ(unconverged, 0);
      std::size_t at = 0;
      int inside = 0;
      for (int k = first.z; k <= last.z; ++k)
      {
        for (int j = first.y; j <= last.y; ++j)
        {
          for (int i = first.x; i <= last.x; ++i, ++at)
          {
            ffd::PullBackStatus status;
            const glm::dvec3 q = scene.Volume.View.ToIndex(
              map.Evaluate(scene.Grid.ToData(glm::dvec3(i, j, k)), status));
            const glm::dvec3 upper = scene.Volume.View.UpperIndex();
            // Within the tolerance of the border both answers are right.
            const glm::dvec3 depth = glm::min(q, upper - q);
            const double least = std::min({ depth.x, depth.y, depth.z });
            if (std::abs(least) < 0.02)
            {
              continue;
            }
            if (least < 0.0)
            {
              EXPECT_EQ(values[at], -5.0);
              continue;
            }
            ++inside;
            // The slope of the volume is below 15 a voxel, and the tolerance 1/500 of a voxel.
            EXPECT_NEAR(values[at], scene.Volume.Interpolate(q),
              kind == ffd::PullBackKind::Exact || kind == ffd::PullBackKind::FirstOrderOfInverse
                ? 0.1
                : 1e-9);
          }
        }
      }
      EXPECT_GT(inside, 2000);
    }
  }
}

TEST(Resampler, TheCheckedInverseStaysWithinTheTolerance)
{
  // Scalars that are the coordinates themselves: the value is the rest point.
  Scene scene(ffd::ScalarType::Float64, 0.8);
  const double tolerance = 1e-4;
  const ffd::PullBack map(&scene.Field, ffd::PullBackKind::Exact, tolerance);
  ASSERT_TRUE(ffd::PullBackBounds(map).IsProvenInvertible());
  ffd::ResampleSettings settings;
  settings.UniqueInverse = true;
  settings.Background = std::numeric_limits<double>::quiet_NaN();
  const glm::ivec3 last(19, 17, 15);
  std::vector<double> q[3];
  for (int a = 0; a < 3; ++a)
  {
    scene.Volume.Fill(
      [&scene, a](int i, int j, int k) { return scene.Grid.ToData(glm::dvec3(i, j, k))[a]; });
    q[a] = scene.Run(map, settings, glm::ivec3(0), last);
  }
  std::size_t at = 0;
  int checked = 0;
  for (int k = 0; k <= last.z; ++k)
  {
    for (int j = 0; j <= last.y; ++j)
    {
      for (int i = 0; i <= last.x; ++i, ++at)
      {
        const glm::dvec3 rest(q[0][at], q[1][at], q[2][at]);
        if (!std::isnan(rest.x))
        {
          ++checked;
          const glm::dvec3 p = scene.Grid.ToData(glm::dvec3(i, j, k));
          EXPECT_LE(
            glm::length(rest + scene.Field.Displacement(rest) - p), tolerance * (1.0 + 1e-6));
        }
      }
    }
  }
  EXPECT_GT(checked, 3000);
}

TEST(Resampler, DoesNotDependOnHowTheGridIsSplit)
{
  Scene scene(ffd::ScalarType::UInt8, 0.7);
  for (const ffd::PullBackKind kind : AllKinds)
  {
    const ffd::PullBack map(&scene.Field, kind, 1e-3);
    ffd::ResampleSettings settings;
    settings.UniqueInverse = true;
    settings.Interpolation = ffd::ResampleInterpolation::Cubic;
    const std::vector<double> whole = scene.Run(map, settings, { -2, -3, -1 }, { 21, 19, 17 });
    const std::vector<double> part = scene.Run(map, settings, { 3, 2, 5 }, { 12, 13, 11 });
    std::size_t at = 0;
    for (int k = 5; k <= 11; ++k)
    {
      for (int j = 2; j <= 13; ++j)
      {
        for (int i = 3; i <= 12; ++i, ++at)
        {
          EXPECT_EQ(
            part[at], whole[static_cast<std::size_t>((i + 2) + 24 * ((j + 3) + 23 * (k + 1)))]);
        }
      }
    }
  }
}

TEST(Resampler, EveryTypeAndComponentWithoutDeformation)
{
  for (const ffd::ScalarType type : AllScalarTypes)
  {
    for (const int components : { 1, 3 })
    {
      for (const auto interpolation : { ffd::ResampleInterpolation::Nearest,
             ffd::ResampleInterpolation::Linear, ffd::ResampleInterpolation::Cubic })
      {
        Scene scene(type, 0.0, components);
        ffd::ResampleSettings settings;
        settings.Interpolation = interpolation;
        settings.Background = 7.0;
        const std::vector<double> values =
          scene.Run(ffd::PullBack(), settings, { -1, 0, 0 }, { 19, 17, 15 });
        for (int k = 0; k < 16; ++k)
        {
          for (int j = 0; j < 18; ++j)
          {
            const std::size_t row = static_cast<std::size_t>(components * 21 * (j + 18 * k));
            EXPECT_EQ(values[row], 7.0);
            for (int i = 0; i < 20; ++i)
            {
              EXPECT_EQ(values[row + static_cast<std::size_t>(components * (i + 1))],
                scene.Volume.At(i, j, k));
            }
          }
        }
      }
    }
  }
}

TEST(Resampler, BordersWidenTheVolumeByUpToHalfAVoxel)
{
  Scene scene(ffd::ScalarType::Float64, 0.0);
  for (const double outside : { 0.0, 0.1, 0.4, 0.6 }) // voxels, of 0.5
  {
    scene.Grid.Origin.x = scene.Volume.View.FirstVoxel.x - 0.5 * outside;
    for (const double border : { 0.0, 0.1, 0.3, 10.0 })
    {
      ffd::ResampleSettings settings;
      settings.Background = -5.0;
      settings.Border = border;
      const double value = scene.Run(ffd::PullBack(), settings, { 0, 5, 5 }, { 1, 5, 5 })[0];
      const bool inside = outside <= std::min(border / 0.5, 0.5);
      EXPECT_EQ(value, inside ? scene.Volume.At(0, 5, 5) : -5.0) << outside << " " << border;
    }
  }
}

TEST(Resampler, WholeNumbersAreRoundedAndClamped)
{
  // Steps from the smallest to the largest value: cubics overshoot both.
  for (const ffd::ScalarType type : { ffd::ScalarType::UInt8, ffd::ScalarType::Int8 })
  {
    const double low = type == ffd::ScalarType::UInt8 ? 0.0 : -128.0;
    Scene scene(type, 0.0);
    scene.Volume.Fill([low](int i, int, int) { return i < 10 ? low : low + 255.0; });
    scene.Grid.Origin.x += 0.25; // half a voxel
    ffd::ResampleSettings settings;
    settings.Interpolation = ffd::ResampleInterpolation::Cubic;
    const std::vector<double> values =
      scene.Run(ffd::PullBack(), settings, { 0, 5, 5 }, { 18, 5, 5 });
    EXPECT_EQ(values[8], low);
    EXPECT_EQ(values[10], low + 255.0);
    EXPECT_NEAR(values[9], low + 127.5, 0.51);
    settings.Interpolation = ffd::ResampleInterpolation::Linear;
    settings.Background = 1000.0;
    const std::vector<double> linear =
      scene.Run(ffd::PullBack(), settings, { 0, 5, 5 }, { 19, 5, 5 });
    EXPECT_EQ(linear[4], low);
    EXPECT_EQ(linear[19], low + 255.0) << "the background is clamped, too";
  }
}

TEST(Resampler, VoxelsThatAreNotANumberStayWhereTheyAre)
{
  for (const ffd::ScalarType type : { ffd::ScalarType::Float32, ffd::ScalarType::Float64 })
  {
    Scene scene(type, 0.0);
    scene.Volume.Fill([](int i, int j, int k) {
      return i == 7 && j == 7 && k == 7 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
    });
    for (const auto interpolation :
      { ffd::ResampleInterpolation::Linear, ffd::ResampleInterpolation::Cubic })
    {
      ffd::ResampleSettings settings;
      settings.Interpolation = interpolation;
      const std::vector<double> values =
        scene.Run(ffd::PullBack(), settings, glm::ivec3(0), { 19, 17, 15 });
      EXPECT_EQ(std::count_if(values.begin(), values.end(), [](double v) { return v != 1.0; }), 1);
    }
  }
}

TEST(Resampler, FoldsAreSolvedPointByPointAndCounted)
{
  Scene scene(ffd::ScalarType::Float32, 6.0);
  const ffd::PullBack map(&scene.Field, ffd::PullBackKind::Exact, 1e-3);
  EXPECT_FALSE(ffd::PullBackBounds(map).IsProvenInvertible());
  std::int64_t unconverged = 0;
  const std::vector<double> values =
    scene.Run(map, ffd::ResampleSettings(), { -6, -6, -6 }, { 25, 23, 21 }, &unconverged);
  const ffd::OrientedInverse inverse(scene.Field, 1e-3, scene.Volume.View,
    { scene.Volume.View.LowerIndex(), scene.Volume.View.UpperIndex() });
  std::int64_t expected = 0;
  for (int k = -6; k <= 21; ++k)
  {
    for (int j = -6; j <= 23; ++j)
    {
      for (int i = -6; i <= 25; ++i)
      {
        const glm::dvec3 p = scene.Grid.ToData(glm::dvec3(i, j, k));
        glm::dvec3 q;
        int evaluations = 0;
        expected += inverse.Solve(p, p, q, evaluations) ? 0 : 1;
      }
    }
  }
  EXPECT_EQ(unconverged, expected);
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }));
}

// Where T folds many times along an axis, and everything moves the same way, points that no rest
// point is found for are taken from beside those of their neighbors.
TEST(Resampler, RestRegionsHoldPointsOfFirstOrder)
{
  RandomLattice random(22);
  int unconverged = 0;
  for (int test = 0; test < 1000; ++test)
  {
    std::vector<glm::dvec3> displacements(12);
    for (glm::dvec3& d : displacements)
    {
      d.x = random.Number(1.0, 9.0);
    }
    const ffd::BSplineField field(
      glm::ivec3(12, 1, 1), glm::dvec3(0.0), glm::dvec3(1.0), displacements.data());
    const ffd::PullBack map(&field, ffd::PullBackKind::Exact, 1e-4);
    const glm::dvec3 p(random.Number(0.0, 14.0), 0.0, 0.0);
    ffd::PullBackStatus status;
    const glm::dvec3 q = map.Evaluate(p, status);
    if (status.Converged)
    {
      continue;
    }
    ++unconverged;
    const ffd::Box rest =
      ffd::FindRestRegion(map, ffd::PullBackBounds(map), { p - 1e-3, p + 1e-3 });
    EXPECT_GE(q.x, rest.Min.x);
    EXPECT_LE(q.x, rest.Max.x);
  }
  EXPECT_GT(unconverged, 20);
}

TEST(Resampler, RestRegionsHoldAllRestPoints)
{
  RandomLattice random(21);
  for (int test = 0; test < 40; ++test)
  {
    const ffd::BSplineField field = random.Field(test < 30 ? 0.3 : 3.0, AllBorders[test % 3]);
    for (const ffd::PullBackKind kind : AllKinds)
    {
      const ffd::PullBack map(&field, kind, 1e-4);
      const ffd::PullBackBounds bounds(map);
      ffd::Box box;
      random.Region(field, 1.0, 2.0, box.Min, box.Max);
      const ffd::Box rest = ffd::FindRestRegion(map, bounds, box);
      for (int n = 0; n < 60; ++n)
      {
        const glm::dvec3 p = glm::mix(box.Min, box.Max, random.Vector(0.0, 1.0));
        ffd::PullBackStatus status;
        const glm::dvec3 q = map.Evaluate(p, status);
        for (int a = 0; a < 3; ++a)
        {
          EXPECT_GE(q[a], rest.Min[a] - 1e-9);
          EXPECT_LE(q[a], rest.Max[a] + 1e-9);
        }
      }
      // Of use only if it is not much larger than the box and the displacements.
      if (test < 30)
      {
        const glm::dvec3 growth = (rest.Max - rest.Min) - (box.Max - box.Min);
        const glm::dvec3 spacing = field.GetSpacing();
        EXPECT_LT(growth.x, 2.0 * spacing.x);
      }
    }
  }
  const ffd::Box box{ glm::dvec3(1.0), glm::dvec3(2.0) };
  EXPECT_EQ(ffd::FindRestRegion(ffd::PullBack(), ffd::PullBackBounds(), box).Min, box.Min);
}
