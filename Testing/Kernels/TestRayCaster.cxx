// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The ray caster against closed forms and against an integration written for this test alone.
#include "FFDRayCaster.h"
#include "RandomLattice.h"
#include "TestVolume.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

using namespace ffd;

namespace
{

constexpr int Size = 20;   // pixels a side
constexpr double Eye = 60; // distance of the camera from the centre of the volume

/// A scene of a volume with unit voxels, seen along -z by a perspective camera.
struct Stage
{
  Stage(const TestVolume& volume, const BSplineField* field, PullBackKind kind,
    const TransferTable& table)
    : Table(table)
    , Map(field, kind, 1e-9)
    , MapBounds(Map)
    , Blocks(volume.View, SerialFor)
    , Distances(Blocks, Table)
  {
    const Box rest{ glm::dvec3(0.0), volume.View.UpperIndex() };
    this->Scene.Volume = volume.View;
    this->Scene.DeformedBounds = this->MapBounds.DeformedBounds(rest);
    this->SpaceBounds = DeformedSpaceBounds(this->Map, this->MapBounds,
      { this->Scene.DeformedBounds.Min - 20.0, this->Scene.DeformedBounds.Max + 20.0 }, rest, 4.0);
    this->Scene.Table = &this->Table;
    this->Scene.Distances = &this->Distances;
    this->Scene.Map = &this->Map;
    this->Scene.Bounds = &this->SpaceBounds;
    const glm::dvec3 centre = 0.5 * rest.Max;
    this->Camera = centre + glm::dvec3(0.0, 0.0, Eye);
    this->Scene.Camera.WorldToNdc = glm::perspective(0.35, 1.0, 20.0, 120.0) *
      glm::lookAt(this->Camera, centre, glm::dvec3(0.0, 1.0, 0.0));
    this->Scene.Camera.NdcToWorld = glm::inverse(this->Scene.Camera.WorldToNdc);
    this->Scene.Camera.ImageSize = glm::ivec2(Size);
    this->Scene.Camera.NdcPerPixel = glm::dvec2(2.0 / Size);
    this->Settings.Reference = true;
  }

  /// Premultiplied RGBA.
  std::vector<float> Render()
  {
    const RayCaster caster(this->Scene, this->Settings);
    std::vector<float> colours(4 * Size * Size, -1.0f);
    this->Depths.assign(Size * Size, -1.0f);
    CastImage image{ Size, Size, colours.data(), this->Depths.data() };
    RayCaster::Scratch scratch;
    for (int tile = caster.GetNumberOfTiles(image); tile-- > 0;)
    {
      caster.RenderTile(tile, image, scratch);
    }
    this->Statistics = RayCaster::GetStatistics(scratch);
    return colours;
  }

  /// The viewing ray of a pixel from the angles of the camera; t = 0 on the near plane.
  void Ray(int x, int y, glm::dvec3& origin, glm::dvec3& direction) const
  {
    const double half = std::tan(0.5 * 0.35);
    direction = glm::normalize(glm::dvec3(
      half * (2.0 * (x + 0.5) / Size - 1.0), half * (2.0 * (y + 0.5) / Size - 1.0), -1.0));
    origin = this->Camera + direction * (20.0 / -direction.z);
  }

  /// Samples every `h` along the straight viewing rays, each pulled back for itself.
  std::vector<double> Integrate(const TestVolume& volume, double h) const
  {
    std::vector<double> alpha;
    const glm::dvec3 upper = volume.View.UpperIndex();
    for (int pixel = 0; pixel < Size * Size; ++pixel)
    {
      glm::dvec3 origin;
      glm::dvec3 direction;
      this->Ray(pixel % Size, pixel / Size, origin, direction);
      double depth = 0.0;
      for (int i = 0; i < 100.0 / h; ++i)
      {
        PullBackStatus status;
        const glm::dvec3 q = this->Map.Evaluate(origin + i * h * direction, status);
        const bool inside = q.x >= 0.0 && q.y >= 0.0 && q.z >= 0.0 && q.x <= upper.x &&
          q.y <= upper.y && q.z <= upper.z;
        depth += inside ? h * this->Table.Lookup(volume.Interpolate(q)).Extinction : 0.0;
      }
      alpha.push_back(1.0 - std::exp2(-depth));
    }
    return alpha;
  }

  TransferTable Table;
  PullBack Map;
  PullBackBounds MapBounds;
  MinMaxBlocks Blocks;
  DistanceMap Distances;
  DeformedSpaceBounds SpaceBounds;
  CastScene Scene;
  CastSettings Settings;
  CastStatistics Statistics;
  glm::dvec3 Camera;
  std::vector<float> Depths;
};

/// Smooth: no sample falls on an edge.
double Ball(int i, int j, int k)
{
  const double r = glm::length(glm::dvec3(i - 8.2, j - 7.1, k - 8.0));
  return 100.0 * std::exp(-r * r / 18.0);
}

TransferTable Ramp(double most = 0.5)
{
  return MakeTable(
    0.0, 100.0, 4097, [most](double x) { return x < 5.0 ? 0.0 : most * (x - 5.0) / 95.0; });
}

/// D = slope * z along z: T stretches by 1 + slope, affine around the volume.
BSplineField Stretch(double slope)
{
  std::vector<glm::dvec3> displacements;
  for (int n = 0; n < 40 * 40 * 40; ++n)
  {
    displacements.push_back(glm::dvec3(0.0, 0.0, slope * (n / 1600 * 4.0 - 72.0)));
  }
  return BSplineField(glm::ivec3(40), glm::dvec3(-72.0), glm::dvec3(4.0), displacements.data());
}

void Compare(
  const std::vector<float>& image, const std::vector<double>& alpha, double mean, double most)
{
  double sum = 0.0;
  double visible = 0.0;
  for (std::size_t i = 0; i < alpha.size(); ++i)
  {
    const double error = std::abs(image[4 * i + 3] - alpha[i]);
    ASSERT_LE(error, most) << "pixel " << i << ": " << image[4 * i + 3] << ", " << alpha[i];
    sum += error;
    visible = std::max(visible, alpha[i]);
  }
  EXPECT_LE(sum / static_cast<double>(alpha.size()), mean);
  EXPECT_GT(visible, 0.2);
}

} // namespace

TEST(RayCaster, IdentityIsTheStraightRayCast)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(17), Ball);
  for (const Segmentation segments : { Segmentation::ErrorBound })
  {
    Stage stage(volume, nullptr, PullBackKind::Exact, Ramp());
    stage.Settings.Segments = segments;
    // The very same samples, so the very same image but for rounding.
    Compare(stage.Render(), stage.Integrate(volume, 1.0), 1e-5, 2e-5);
    EXPECT_EQ(stage.Statistics.Evaluations, 0);
  }
}

TEST(RayCaster, DeformedIsThePullBackOfEverySample)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(17), Ball);
  RandomLattice random(1);
  for (int run = 0; run < 12; ++run)
  {
    std::vector<glm::dvec3> displacements(216);
    for (glm::dvec3& d : displacements)
    {
      d = random.Vector(-1.5, 1.5);
    }
    const BSplineField field(
      glm::ivec3(6), glm::dvec3(-2.0), glm::dvec3(4.0), displacements.data());
    const PullBackKind kinds[] = { PullBackKind::Exact, PullBackKind::FirstOrder,
      PullBackKind::Forward };
    Stage stage(volume, &field, kinds[run % 3], Ramp());
    stage.Settings.Segments = run % 2 ? Segmentation::GreedyAngle : Segmentation::ErrorBound;
    stage.Settings.SampleDistance = 0.1;
    stage.Settings.Spans.PositionTolerance = 0.01;
    stage.Settings.Polyline.AngleThreshold = 0.01;
    Compare(stage.Render(), stage.Integrate(volume, 0.1), 2e-3, 2e-2);
  }
}

TEST(RayCaster, WorldAndMaterialOpacityOfAStretchedSlab)
{
  const TestVolume slab(ScalarType::UInt8, glm::ivec3(17), [](int, int, int) { return 100.0; });
  const double extinction = 0.05; // per world unit
  const TransferTable table =
    MakeTable(0.0, 200.0, 3, [extinction](double) { return 1.0 - std::exp2(-extinction); });
  for (const double slope : { 0.0, 0.5, -0.3 })
  {
    const BSplineField field = Stretch(slope);
    for (const OpacityLength length : { OpacityLength::World, OpacityLength::Material })
    {
      for (const Segmentation segments : { Segmentation::ErrorBound, Segmentation::GreedyAngle })
      {
        Stage stage(slab, &field, PullBackKind::Exact, table);
        stage.Settings.Opacity = length;
        stage.Settings.Segments = segments;
        stage.Settings.SampleDistance = 0.05;
        const std::vector<float> image = stage.Render();
        // The central ray runs along z: 16 voxels at rest.
        const double path = 16.0 * (length == OpacityLength::World ? 1.0 + slope : 1.0);
        const std::size_t centre = 4 * (Size / 2 * Size + Size / 2);
        EXPECT_NEAR(image[centre + 3], 1.0 - std::exp2(-extinction * path), 4e-3)
          << "slope " << slope;
        EXPECT_NEAR(image[centre], image[centre + 3], 1e-5); // white, premultiplied
      }
    }
  }
}

TEST(RayCaster, StatisticsCountWhatBruteForceCounts)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(17), Ball);
  Stage stage(volume, nullptr, PullBackKind::Exact, Ramp());
  stage.Settings.Leaping = SpaceLeaping::Off;
  stage.Render();
  std::int64_t rays = 0;
  std::int64_t samples = 0;
  std::int64_t visible = 0;
  for (int pixel = 0; pixel < Size * Size; ++pixel)
  {
    glm::dvec3 origin;
    glm::dvec3 direction;
    stage.Ray(pixel % Size, pixel / Size, origin, direction);
    bool meets = false;
    for (int i = 0; i < 100000; ++i)
    {
      const double t = i * 0.001;
      const glm::dvec3 q = origin + t * direction;
      if (std::min({ q.x, q.y, q.z }) >= 0.0 && std::max({ q.x, q.y, q.z }) <= 16.0)
      {
        meets = true;
        if (i % 1000 == 0)
        {
          ++samples;
          visible += stage.Table.Lookup(volume.Interpolate(q)).Extinction > 0.0f ? 1 : 0;
        }
      }
    }
    rays += meets ? 1 : 0;
  }
  EXPECT_EQ(stage.Statistics.Rays, rays);
  // A sample on a face may be counted or not.
  EXPECT_NEAR(static_cast<double>(stage.Statistics.Samples), static_cast<double>(samples), 4.0);
  EXPECT_EQ(stage.Statistics.VisibleSamples, visible);
}

TEST(RayCaster, DepthsEndRaysAndEarlyTerminationStopsThem)
{
  const TestVolume slab(ScalarType::UInt8, glm::ivec3(17), [](int, int, int) { return 100.0; });
  Stage stage(
    slab, nullptr, PullBackKind::Exact, MakeTable(0.0, 200.0, 3, [](double) { return 0.5; }));
  const std::vector<float> whole = stage.Render();
  const std::int64_t samples = stage.Statistics.Samples;
  stage.Settings.TerminationTransmittance = 0.1f;
  const std::vector<float> early = stage.Render();
  EXPECT_LT(stage.Statistics.Samples, samples / 2);
  for (std::size_t i = 3; i < whole.size(); i += 4)
  {
    ASSERT_LE(std::abs(whole[i] - early[i]), 0.1f);
  }
  const std::size_t centre = Size / 2 * Size + Size / 2;
  EXPECT_NEAR(stage.Depths[centre],
    stage.Scene.Camera.ToDepth(stage.Camera - glm::dvec3(0.0, 0.0, Eye - 8.0)), 0.01);
  EXPECT_EQ(stage.Depths[0], 1.0f);
  const std::vector<float> inFront(Size * Size, 0.01f);
  stage.Scene.Depths = inFront.data();
  for (const float channel : stage.Render())
  {
    ASSERT_EQ(channel, 0.0f);
  }
}

// Leaping takes no sample that contributes, on anything from tame to folded lattices: the images
// have identical bytes.
TEST(RayCaster, LeapingChangesNoByte)
{
  RandomLattice random(2);
  std::int64_t evaluations[3] = {};
  int nonEmpty = 0;
  for (int run = 0; run < 160; ++run)
  {
    const double density = std::pow(10.0, random.Number(-4.0, -1.5));
    const TestVolume volume(ScalarType::UInt8,
      glm::ivec3(random.Integer(4, 40), random.Integer(4, 40), random.Integer(4, 40)),
      [&](int, int, int) { return random.Number(0.0, 1.0) < density ? 100.0 : 0.0; });
    const double amount = std::pow(10.0, random.Number(-1.0, 1.0));
    std::vector<glm::dvec3> displacements(216);
    for (glm::dvec3& d : displacements)
    {
      d = amount * random.Vector(-1.0, 1.0);
    }
    const BSplineField field(glm::ivec3(6), glm::dvec3(-4.0), glm::dvec3(9.0), displacements.data(),
      1.0, AllBorders[run % 3]);
    const PullBackKind kinds[] = { PullBackKind::Exact, PullBackKind::FirstOrder,
      PullBackKind::Forward, PullBackKind::Exact };
    Stage stage(volume, &field, kinds[run / 3 % 4], Ramp(0.9));
    stage.Settings.Segments = run % 5 == 0 ? Segmentation::GreedyAngle : Segmentation::ErrorBound;
    stage.Settings.Shade = run % 7 == 0;
    std::vector<float> off;
    std::vector<float> depths;
    std::int64_t visible = 0;
    for (const SpaceLeaping leaping :
      { SpaceLeaping::Off, SpaceLeaping::Segment, SpaceLeaping::Lipschitz })
    {
      stage.Settings.Leaping = leaping;
      const std::vector<float> image = stage.Render();
      evaluations[static_cast<int>(leaping)] += stage.Statistics.Evaluations;
      if (leaping == SpaceLeaping::Off)
      {
        off = image;
        depths = stage.Depths;
        visible = stage.Statistics.VisibleSamples;
        nonEmpty += visible > 0 ? 1 : 0;
        continue;
      }
      ASSERT_EQ(stage.Statistics.VisibleSamples, visible)
        << "run " << run << ", amount " << amount << ", invertible "
        << stage.MapBounds.IsProvenInvertible();
      ASSERT_EQ(image, off);
      ASSERT_EQ(stage.Depths, depths);
    }
  }
  EXPECT_GT(nonEmpty, 60);
  EXPECT_LT(evaluations[2], evaluations[0]);
}
