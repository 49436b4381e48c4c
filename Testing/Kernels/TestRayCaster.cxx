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
#include <string>
#include <vector>

using namespace ffd;

namespace
{

constexpr int Size = 20;   // pixels a side
constexpr double Eye = 60; // distance of the camera from the center of the volume

/// A scene of a volume with unit voxels, seen along -z by a perspective camera.
struct Stage
{
  Stage(const TestVolume& volume, const BSplineField* field, PullBackKind kind,
    const TransferTable& table)
    : Table(table)
    , Map(field, kind, 1e-9)
    , MapBounds(Map)
    , Blocks(volume.View, ParallelFor())
    , Distances(Blocks, Table)
  {
    const Box rest{ glm::dvec3(0.0), volume.View.UpperIndex() };
    this->Scene.Volume = volume.View;
    this->Scene.DeformedBounds = this->MapBounds.DeformedBounds(rest);
    this->Scene.Limits = this->MapBounds.GetLimits();
    this->Scene.Table = &this->Table;
    this->Scene.Distances = &this->Distances;
    this->Scene.Map = &this->Map;
    const glm::dvec3 center = 0.5 * rest.Max;
    this->Camera = center + glm::dvec3(0.0, 0.0, Eye);
    this->Scene.Camera.DataToNdc = glm::perspective(0.35, 1.0, 20.0, 120.0) *
      glm::lookAt(this->Camera, center, glm::dvec3(0.0, 1.0, 0.0));
    this->Scene.Camera.NdcToData = glm::inverse(this->Scene.Camera.DataToNdc);
    this->Scene.Camera.ImageSize = glm::ivec2(Size);
    this->Scene.Camera.NdcPerPixel = glm::dvec2(2.0 / Size);
    this->Settings.Reference = true;
  }

  /// Premultiplied RGBA.
  std::vector<float> Render()
  {
    const RayCaster caster(this->Scene, this->Settings);
    std::vector<float> colors(4 * Size * Size, -1.0f);
    this->Depths.assign(Size * Size, -1.0f);
    CastImage image{ Size, Size, colors.data(), this->Depths.data() };
    RayCaster::Scratch scratch;
    for (int tile = caster.GetNumberOfTiles(image); tile-- > 0;)
    {
      caster.RenderTile(tile, image, scratch);
    }
    this->Statistics = RayCaster::GetStatistics(scratch);
    return colors;
  }

  /// The viewing ray of a pixel from the angles of the camera; t = 0 on the near plane.
  void Ray(int x, int y, glm::dvec3& origin, glm::dvec3& direction) const
  {
    const double half = std::tan(0.5 * 0.35);
    direction = glm::normalize(glm::dvec3(
      half * (2.0 * (x + 0.5) / Size - 1.0), half * (2.0 * (y + 0.5) / Size - 1.0), -1.0));
    origin = this->Camera + direction * (20.0 / -direction.z);
  }

  /// t of the first sample from the near plane on: those from the face of the volume at rest on are
  /// whole steps behind it, less a hundredth.
  static double FindFirst(
    const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& upper, double h)
  {
    double enter = 0.0;
    for (int a = 0; a < 3; ++a)
    {
      const double face = direction[a] > 0.0 ? 0.0 : upper[a];
      enter = std::max(enter, (face - origin[a]) / direction[a]);
    }
    return std::fmod(enter + 0.99 * h, h);
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
      const double first = FindFirst(origin, direction, upper, h);
      for (int i = 0; i < 100.0 / h; ++i)
      {
        PullBackStatus status;
        const glm::dvec3 q = this->Map.Evaluate(origin + (first + i * h) * direction, status);
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
  Stage stage(volume, nullptr, PullBackKind::Exact, Ramp());
  stage.Settings.Segments = Segmentation::ErrorBound;
  // The very same samples, so the very same image but for rounding.
  Compare(stage.Render(), stage.Integrate(volume, 1.0), 1e-5, 2e-5);
  EXPECT_EQ(stage.Statistics.Evaluations, 0);
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
    stage.Settings.ErrorBound.PositionTolerance = 0.01;
    stage.Settings.Polyline.AngleThreshold = 0.01;
    Compare(stage.Render(), stage.Integrate(volume, 0.1), 2e-3, 2e-2);
  }
}

TEST(RayCaster, DeformedAndMaterialOpacityOfAStretchedSlab)
{
  const TestVolume slab(ScalarType::UInt8, glm::ivec3(17), [](int, int, int) { return 100.0; });
  const double extinction = 0.05; // per data unit
  const TransferTable table =
    MakeTable(0.0, 200.0, 3, [extinction](double) { return 1.0 - std::exp2(-extinction); });
  for (const double slope : { 0.0, 0.5, -0.3 })
  {
    const BSplineField field = Stretch(slope);
    for (const OpacityLength length : { OpacityLength::Deformed, OpacityLength::Material })
    {
      for (const Segmentation segments : { Segmentation::ErrorBound, Segmentation::GreedyAngle })
      {
        Stage stage(slab, &field, PullBackKind::Exact, table);
        stage.Settings.Opacity = length;
        stage.Settings.Segments = segments;
        stage.Settings.SampleDistance = 0.05;
        const std::vector<float> image = stage.Render();
        // The central ray runs along z: 16 voxels at rest.
        const double path = 16.0 * (length == OpacityLength::Deformed ? 1.0 + slope : 1.0);
        const std::size_t center = 4 * (Size / 2 * Size + Size / 2);
        EXPECT_NEAR(image[center + 3], 1.0 - std::exp2(-extinction * path), 4e-3)
          << "slope " << slope;
        EXPECT_NEAR(image[center], image[center + 3], 1e-5); // white, premultiplied
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
    const double first = Stage::FindFirst(origin, direction, volume.View.UpperIndex(), 1.0);
    for (int i = 0; i < 100000; ++i)
    {
      const double t = first + i * 0.001;
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
  EXPECT_EQ(stage.Statistics.Samples, samples);
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
  const std::size_t center = Size / 2 * Size + Size / 2;
  EXPECT_NEAR(stage.Depths[center],
    stage.Scene.Camera.ToDepth(stage.Camera - glm::dvec3(0.0, 0.0, Eye - 8.0)), 0.01);
  EXPECT_EQ(stage.Depths[0], 1.0f);
  const std::vector<float> inFront(Size * Size, 0.01f);
  stage.Scene.Depths = inFront.data();
  for (const float channel : stage.Render())
  {
    ASSERT_EQ(channel, 0.0f);
  }
}

namespace
{

/// The scalar of the tests of blend modes at rest: linear, so interpolated without error.
double Slope(const glm::dvec3& q) { return 10.0 + 2.0 * q.x + 1.0 * q.y + 3.0 * q.z; }

double SlopeAt(int i, int j, int k) { return Slope(glm::dvec3(i, j, k)); }

/// Gray and opacity are functions of the scalar that the tests can repeat.
TransferTable SlopeTable()
{
  return MakeTable(
    0.0, 128.0, 4097, [](double x) { return 0.2 + 0.005 * x; },
    [](double x) { return glm::dvec3(x / 128.0, 0.5, 1.0 - x / 128.0); });
}

void SetBlend(Stage& stage, BlendMode mode)
{
  stage.Scene.Blend.Mode = mode;
  stage.Scene.Blend.Low[0] = 10.0;
  stage.Scene.Blend.High[0] = 106.0;
  stage.Settings.Leaping = SpaceLeaping::Off;
  stage.Settings.SampleDistance = 0.02;
}

/// Parts of the viewing rays of a stage in the volume at rest, if that is stretched along z.
struct Chord
{
  double From = 0.0;
  double To = 120.0;
  glm::dvec3 Origin;
  glm::dvec3 Direction; // per unit of t

  Chord(const Stage& stage, int pixel, double stretch)
  {
    stage.Ray(pixel % Size, pixel / Size, this->Origin, this->Direction);
    this->Origin.z /= stretch;
    this->Direction.z /= stretch;
    for (int a = 0; a < 3; ++a)
    {
      const double t0 = (0.0 - this->Origin[a]) / this->Direction[a];
      const double t1 = (16.0 - this->Origin[a]) / this->Direction[a];
      this->From = std::max(this->From, std::min(t0, t1));
      this->To = std::min(this->To, std::max(t0, t1));
    }
  }
  double Length() const { return this->To - this->From; }
  glm::dvec3 At(double t) const { return this->Origin + t * this->Direction; }
};

} // namespace

// Maxima, minima, means and integrals of a linear field along straight rays through a volume that
// is stretched along z; rays one by one and in packets.
TEST(RayCaster, ProjectionsOfALinearField)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(17), SlopeAt);
  const double stretch = 1.5;
  const BSplineField field = Stretch(stretch - 1.0);
  const TransferTable table = SlopeTable();
  for (const bool reference : { true, false })
  {
    for (const BlendMode mode :
      { BlendMode::Maximum, BlendMode::Minimum, BlendMode::Average, BlendMode::Additive })
    {
      SCOPED_TRACE("mode " + std::to_string(static_cast<int>(mode)));
      Stage stage(volume, &field, PullBackKind::Exact, table);
      SetBlend(stage, mode);
      stage.Settings.Reference = reference;
      stage.Scene.Blend.AverageMin = 40.0;
      stage.Scene.Blend.AverageMax = 70.0;
      stage.Scene.Blend.UnitDistance[0] = 20.0;
      const std::vector<float> image = stage.Render();
      int hit = 0;
      for (int pixel = 0; pixel < Size * Size; ++pixel)
      {
        const Chord chord(stage, pixel, stretch);
        const float* rgba = &image[4 * static_cast<std::size_t>(pixel)];
        if (chord.Length() < 2.0)
        {
          continue;
        }
        const double ends[2] = { Slope(chord.At(chord.From)), Slope(chord.At(chord.To)) };
        if (mode == BlendMode::Maximum || mode == BlendMode::Minimum)
        {
          const bool first = (ends[0] > ends[1]) == (mode == BlendMode::Maximum);
          const double value = ends[first ? 0 : 1];
          const double opacity = 0.2 + 0.005 * value;
          EXPECT_NEAR(rgba[3], opacity, 1e-3);
          EXPECT_NEAR(rgba[0], opacity * value / 128.0, 1.5e-3);
          EXPECT_NEAR(rgba[1], opacity * 0.5, 1e-3);
          const double depth = stage.Scene.Camera.ToDepth(
            stage.Scene.Camera.MakeRay(pixel % Size + 0.5, pixel / Size + 0.5).Origin +
            (first ? chord.From : chord.To) *
              stage.Scene.Camera.MakeRay(pixel % Size + 0.5, pixel / Size + 0.5).Direction);
          EXPECT_NEAR(stage.Depths[static_cast<std::size_t>(pixel)], depth, 1e-3);
          ++hit;
          continue;
        }
        // Opacity times relative value is quadratic along the ray: Simpson's rule is exact.
        const double rate = (ends[1] - ends[0]) / chord.Length();
        double a = chord.From;
        double b = chord.To;
        if (mode == BlendMode::Average)
        {
          const double t0 = chord.From + (40.0 - ends[0]) / rate;
          const double t1 = chord.From + (70.0 - ends[0]) / rate;
          a = std::max(a, std::min(t0, t1));
          b = std::min(b, std::max(t0, t1));
          if (b - a < 1.0)
          {
            continue;
          }
        }
        const auto integrand = [&](double t) {
          const double value = Slope(chord.At(t));
          return (0.2 + 0.005 * value) * (value - 10.0) / 96.0;
        };
        const double mean = (integrand(a) + 4.0 * integrand(0.5 * (a + b)) + integrand(b)) / 6.0;
        const double expected =
          mode == BlendMode::Average ? mean : std::min(1.0, mean * (b - a) / 20.0);
        EXPECT_EQ(rgba[3], 1.0f);
        EXPECT_NEAR(rgba[0], expected, mode == BlendMode::Average ? 4e-3 : 1e-3);
        EXPECT_EQ(rgba[0], rgba[1]);
        EXPECT_EQ(rgba[0], rgba[2]);
        ++hit;
      }
      EXPECT_GT(hit, 100);
    }
  }
}

// Isosurfaces of a linear field are planes: the ray meets them at a known t, at any sample
// distance, with a known normal; two of them, semi-transparent, blend.
TEST(RayCaster, IsosurfacesOfALinearField)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(17), SlopeAt);
  const double stretch = 1.5;
  const BSplineField field = Stretch(stretch - 1.0);
  const TransferTable table = SlopeTable();
  const glm::vec3 colors[2] = { glm::vec3(0.9f, 0.3f, 0.1f), glm::vec3(0.2f, 0.5f, 0.8f) };
  for (const double step : { 0.31, 1.0, 3.0 })
  {
    for (const int kind : { 0, 1, 2 })
    {
      for (const bool crop : { false, true })
      {
        SCOPED_TRACE("step " + std::to_string(step) + ", kind " + std::to_string(kind));
        Stage stage(volume, &field, PullBackKind::Exact, table);
        SetBlend(stage, BlendMode::Isosurface);
        stage.Settings.Reference = kind == 0;
        stage.Settings.ErrorBound.PositionTolerance = 1e-3;
        stage.Settings.Segments = kind == 1 ? Segmentation::GreedyAngle : Segmentation::ErrorBound;
        stage.Settings.SampleDistance = step;
        stage.Settings.Shade = true;
        Light headlight;
        headlight.Headlight = true;
        stage.Scene.Material.Lights = { headlight };
        stage.Scene.Material.Ambient = 0.0f;
        stage.Scene.Material.Diffuse = 1.0f;
        stage.Scene.Material.Specular = 0.0f;
        stage.Scene.Blend.IsoValues = { { 43.7, colors[0], 0.4f }, { 71.3, colors[1], 0.6f } };
        if (crop)
        {
          stage.Scene.Crop.Space = Cropping::Spaces::Rest;
          stage.Scene.Crop.Low = glm::dvec3(4.0, 3.0, 2.0);
          stage.Scene.Crop.High = glm::dvec3(12.0, 13.0, 14.5);
          stage.Scene.Crop.Flags = 1 << 13;
        }
        const std::vector<float> image = stage.Render();
        const glm::dvec3 normal = glm::normalize(glm::dvec3(2.0, 1.0, 3.0 / stretch));
        int hits = 0;
        int misses = 0;
        for (int pixel = 0; pixel < Size * Size; ++pixel)
        {
          const Chord chord(stage, pixel, stretch);
          const ViewRay ray = stage.Scene.Camera.MakeRay(pixel % Size + 0.5, pixel / Size + 0.5);
          const double lit = std::abs(glm::dot(normal, ray.Direction));
          // From the camera the field falls.
          glm::dvec3 color(0.0);
          double light = 1.0;
          double firstT = 1e9;
          bool close = false;
          bool interior = true; // central differences are one-sided on the faces
          for (const int i : { 1, 0 })
          {
            const IsoValue& iso = stage.Scene.Blend.IsoValues[static_cast<std::size_t>(i)];
            const double t = (iso.Value - Slope(chord.Origin)) / (Slope(chord.Direction) - 10.0);
            const glm::dvec3 q = chord.At(t);
            const glm::dvec3 lo = crop ? stage.Scene.Crop.Low : glm::dvec3(0.0);
            const glm::dvec3 hi = crop ? stage.Scene.Crop.High : glm::dvec3(16.0);
            bool inside = true;
            for (int a = 0; a < 3; ++a)
            {
              inside = inside && q[a] >= lo[a] && q[a] <= hi[a];
              close = close || std::abs(q[a] - lo[a]) < 1e-2 || std::abs(q[a] - hi[a]) < 1e-2;
            }
            if (inside)
            {
              firstT = std::min(firstT, t);
              interior = interior && std::min({ q.x, q.y, q.z }) > 1.01 &&
                std::max({ q.x, q.y, q.z }) < 14.99;
              color += light * iso.Opacity * lit * glm::dvec3(colors[i]);
              light *= 1.0 - iso.Opacity;
            }
          }
          if (close)
          {
            continue;
          }
          const float* rgba = &image[4 * static_cast<std::size_t>(pixel)];
          EXPECT_NEAR(rgba[3], 1.0 - light, 1e-5) << "pixel " << pixel;
          for (int c = 0; c < 3 && interior; ++c)
          {
            EXPECT_NEAR(rgba[c], color[c], 2e-3) << "pixel " << pixel;
          }
          const float depth = stage.Depths[static_cast<std::size_t>(pixel)];
          if (firstT < 1e8)
          {
            EXPECT_NEAR(
              depth, stage.Scene.Camera.ToDepth(ray.Origin + firstT * ray.Direction), 2e-5);
            ++hits;
          }
          else
          {
            EXPECT_EQ(depth, 1.0f);
            ++misses;
          }
        }
        EXPECT_GT(hits, 50);
        EXPECT_GT(misses, 50);
      }
    }
  }
}

// Values on a plane through the stretched volume.
TEST(RayCaster, SliceOfALinearField)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(17), SlopeAt);
  const double stretch = 1.5;
  const BSplineField field = Stretch(stretch - 1.0);
  Stage stage(volume, &field, PullBackKind::Exact, SlopeTable());
  SetBlend(stage, BlendMode::Slice);
  stage.Scene.Blend.SliceOrigin = glm::dvec3(8.0, 8.0, 11.0);
  stage.Scene.Blend.SliceNormal = glm::normalize(glm::dvec3(0.3, -0.2, 1.0));
  // Colors of the tables of packets have 10 bits.
  const double color = 0.5 / 1023.0;
  for (const bool reference : { true, false })
  {
    stage.Settings.Reference = reference;
    const std::vector<float> image = stage.Render();
    EXPECT_GT(stage.Statistics.Samples, 0);
    EXPECT_LE(stage.Statistics.Samples, stage.Statistics.Rays);
    int hits = 0;
    int misses = 0;
    for (int pixel = 0; pixel < Size * Size; ++pixel)
    {
      const ViewRay ray = stage.Scene.Camera.MakeRay(pixel % Size + 0.5, pixel / Size + 0.5);
      const double t =
        glm::dot(stage.Scene.Blend.SliceNormal, stage.Scene.Blend.SliceOrigin - ray.Origin) /
        glm::dot(stage.Scene.Blend.SliceNormal, ray.Direction);
      glm::dvec3 q = ray.Origin + t * ray.Direction;
      const float depth = static_cast<float>(stage.Scene.Camera.ToDepth(q));
      q.z /= stretch;
      const float* rgba = &image[4 * static_cast<std::size_t>(pixel)];
      const double nearest = std::min({ q.x, q.y, q.z, 16.0 - q.x, 16.0 - q.y, 16.0 - q.z });
      if (nearest > 1e-6)
      {
        const double value = Slope(q);
        EXPECT_NEAR(rgba[3], 0.2 + 0.005 * value, 1e-5);
        EXPECT_NEAR(rgba[0], rgba[3] * value / 128.0, reference ? 1e-4 : color);
        EXPECT_NEAR(stage.Depths[static_cast<std::size_t>(pixel)], depth, 1e-6);
        ++hits;
      }
      else if (nearest < -1e-6)
      {
        EXPECT_EQ(rgba[3], 0.0f);
        EXPECT_EQ(stage.Depths[static_cast<std::size_t>(pixel)], 1.0f);
        ++misses;
      }
    }
    EXPECT_GT(hits, 100);
    EXPECT_GT(misses, 50);
  }
}

// What a clipping plane and cropping in deformed space leave of a slab, by its integral.
TEST(RayCaster, ClippedAndCroppedSlab)
{
  const TestVolume slab(ScalarType::UInt8, glm::ivec3(17), [](int, int, int) { return 106.0; });
  const BSplineField field = Stretch(0.5);
  for (const bool reference : { true, false })
  {
    for (int option = 0; option < 3; ++option)
    {
      Stage stage(
        slab, &field, PullBackKind::Exact, MakeTable(0.0, 128.0, 4097, [](double) { return 0.5; }));
      SetBlend(stage, BlendMode::Additive);
      stage.Settings.Reference = reference;
      stage.Scene.Blend.UnitDistance[0] = 30.0;
      if (option == 0)
      {
        // Deformed: 0 to 24 along z, of which what is above 9 remains.
        stage.Scene.ClippingPlanes = { glm::dvec4(0.0, 0.0, 2.0, -18.0) };
      }
      else
      {
        // Below 4 and above 13 of deformed space, or of the volume at rest.
        stage.Scene.Crop.Space = option == 1 ? Cropping::Spaces::Deformed : Cropping::Spaces::Rest;
        stage.Scene.Crop.Low = glm::dvec3(-100.0, -100.0, 4.0);
        stage.Scene.Crop.High = glm::dvec3(100.0, 100.0, 13.0);
        stage.Scene.Crop.Flags = 1 << (1 + 3) | 1 << (1 + 3 + 18);
      }
      const std::vector<float> image = stage.Render();
      const double paths[3] = { 15.0, 24.0 - 9.0, 1.5 * (16.0 - 9.0) };
      const std::size_t center = 4 * (Size / 2 * Size + Size / 2);
      EXPECT_NEAR(image[center], 0.5 * paths[option] / 30.0, 2e-3) << "option " << option;
      EXPECT_EQ(image[center + 3], 1.0f);
    }
  }
}

// Samples beside an upper face where blocks end, too, belong to the last block.
TEST(RayCaster, LeapingKeepsSamplesAtTheFaces)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    for (const bool reference : { true, false })
    {
      SCOPED_TRACE("axis " + std::to_string(axis));
      const TestVolume volume(ScalarType::UInt8, glm::ivec3(17),
        [axis](int i, int j, int k) { return glm::ivec3(i, j, k)[axis] == 16 ? 100.0 : 0.0; });
      Stage stage(volume, nullptr, PullBackKind::Exact, Ramp(0.9));
      glm::dvec3 eye(8.0);
      eye[axis] -= Eye;
      glm::dvec3 up(0.0);
      up[(axis + 1) % 3] = 1.0;
      stage.Scene.Camera.Parallel = true;
      stage.Scene.Camera.DataToNdc =
        glm::ortho(-7.0, 7.0, -7.0, 7.0, 20.0, 120.0) * glm::lookAt(eye, glm::dvec3(8.0), up);
      stage.Scene.Camera.NdcToData = glm::inverse(stage.Scene.Camera.DataToNdc);
      stage.Settings.Reference = reference;
      stage.Settings.Leaping = SpaceLeaping::Off;
      const std::vector<float> off = stage.Render();
      EXPECT_GT(*std::max_element(off.begin(), off.end()), 0.8f);
      stage.Settings.Leaping = SpaceLeaping::Lipschitz;
      const std::vector<float> on = stage.Render();
      for (std::size_t i = 0; i < off.size(); ++i)
      {
        ASSERT_EQ(on[i], off[i]) << "pixel " << i / 4;
      }
    }
  }
}

// With every blend mode, on volumes of single voxels and on lattices from tame to folded.
TEST(RayCaster, LeapingChangesNoBlendMode)
{
  RandomLattice random(5);
  int nonEmpty = 0;
  for (int run = 0; run < 120; ++run)
  {
    const double density = std::pow(10.0, random.Number(-4.0, -1.5));
    const TestVolume volume(ScalarType::UInt8,
      glm::ivec3(random.Integer(4, 40), random.Integer(4, 40), random.Integer(4, 40)),
      [&](int, int, int) {
        return random.Number(0.0, 1.0) < density ? random.Number(50.0, 100.0) : 0.0;
      });
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
    stage.Settings.Reference = run % 2 == 0;
    stage.Settings.Segments = run % 5 == 0 ? Segmentation::GreedyAngle : Segmentation::ErrorBound;
    stage.Settings.Jitter = run % 7 == 0;
    Blending& blend = stage.Scene.Blend;
    const BlendMode modes[] = { BlendMode::Maximum, BlendMode::Isosurface, BlendMode::Average,
      BlendMode::Composite, BlendMode::Isosurface, BlendMode::Minimum };
    blend.Mode = modes[run % 6];
    blend.High[0] = 100.0;
    blend.AverageMin = 20.0;
    blend.IsoValues = { { 12.0, glm::vec3(1.0f), 0.4f }, { 40.0, glm::vec3(0.5f), 0.9f } };
    TransferTable leaps;
    ASSERT_TRUE(MakeLeapTable(blend, stage.Table, leaps));
    stage.Distances = DistanceMap(stage.Blocks, leaps);
    std::vector<float> off;
    std::vector<float> depths;
    for (const SpaceLeaping leaping :
      { SpaceLeaping::Off, SpaceLeaping::Segment, SpaceLeaping::Lipschitz })
    {
      stage.Settings.Leaping = leaping;
      const std::vector<float> image = stage.Render();
      if (leaping == SpaceLeaping::Off)
      {
        off = image;
        depths = stage.Depths;
        nonEmpty += *std::max_element(off.begin(), off.end()) > 0.0f ? 1 : 0;
        continue;
      }
      for (std::size_t i = 0; i < off.size(); ++i)
      {
        ASSERT_NEAR(image[i], off[i], 1e-4)
          << "run " << run << ", leaping " << static_cast<int>(leaping) << ", pixel " << i / 4;
      }
      for (std::size_t i = 0; i < depths.size(); ++i)
      {
        ASSERT_NEAR(stage.Depths[i], depths[i], 1e-5) << "run " << run;
      }
    }
  }
  EXPECT_GT(nonEmpty, 50);
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
    stage.Settings.Reference = run % 5 == 1;
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
