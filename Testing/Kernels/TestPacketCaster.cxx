// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The packet kernels of every instruction set that this machine has against the reference
// kernels: same samples, so the same picture but for single precision.
#include "EveryTarget.h"
#include "FFDAxisMap.h"
#include "FFDRayCaster.h"
#include "FFDScalarDispatch.h"
#include "Optics/FFDSampleClassifier.h"
#include "Packets/FFDPiecewiseOptics.h"
#include "TestVolume.h"

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace
{

using namespace ffd;

/// Values at which all ten types agree: whole numbers from 0 to 100.
double BlobValue(const glm::dvec3& p)
{
  const double a =
    std::exp(-0.02 * glm::dot(p - glm::dvec3(14, 12, 11), p - glm::dvec3(14, 12, 11)));
  const double b =
    std::exp(-0.03 * glm::dot(p - glm::dvec3(25, 18, 14), p - glm::dvec3(25, 18, 14)));
  return std::round(100.0 * std::min(1.0, a + 0.8 * b));
}

const glm::ivec3 WholeVolume(39, 31, 27);

/// A scene with everything a frame needs, and two ways to render it.
class TestScene
{
public:
  /// `wholeRange`: the values are spread over all that integers of the type can be. `dims`: of a
  /// part in the middle of the whole volume.
  explicit TestScene(ScalarType type, std::uint32_t seed = 1, bool wholeRange = false,
    const glm::ivec3& dims = WholeVolume)
    : Random(seed)
  {
    const glm::ivec3 first = (WholeVolume - dims) / 2;
    this->Scene.Volume.Dimensions = dims;
    this->Scene.Volume.Type = type;
    this->Scene.Volume.Increments[0] = 1;
    this->Scene.Volume.Increments[1] = dims.x;
    this->Scene.Volume.Increments[2] = static_cast<std::int64_t>(dims.x) * dims.y;
    this->Scene.Volume.IndexToData = glm::dmat3(1.0, 0, 0, 0, 1.2, 0, 0, 0, 1.5);
    this->Scene.Volume.DataToIndex = glm::inverse(this->Scene.Volume.IndexToData);
    this->Scene.Volume.FirstVoxel =
      glm::dvec3(100.0, -50.0, 7.0) + this->Scene.Volume.IndexToData * glm::dvec3(first);
    DispatchScalarType(type, [&](auto zero) {
      using T = decltype(zero);
      if (wholeRange)
      {
        this->First = static_cast<double>(std::numeric_limits<T>::lowest());
        this->Last = static_cast<double>(std::numeric_limits<T>::max());
      }
      // Room behind the last voxel would hide reads beyond it from the sanitizer.
      this->Bytes.resize(static_cast<std::size_t>(dims.x) * dims.y * dims.z * sizeof(T));
      T* voxel = reinterpret_cast<T*>(this->Bytes.data());
      for (int k = 0; k < dims.z; ++k)
      {
        for (int j = 0; j < dims.y; ++j)
        {
          for (int i = 0; i < dims.x; ++i)
          {
            const double part = 0.01 * BlobValue(glm::dvec3(first + glm::ivec3(i, j, k)));
            *voxel++ = static_cast<T>(std::round(this->First + part * (this->Last - this->First)));
          }
        }
      }
    });
    this->Scene.Volume.Scalars = this->Bytes.data();
    this->MakeBlocks();
    this->SetLeastVisible(20.0);
    this->Scene.VoxelSize = 1.0;
    Light headlight;
    headlight.Headlight = true;
    headlight.Ambient = glm::vec3(1.0f);
    this->Scene.Material.Lights.push_back(headlight);
    this->Settings.Shade = true;
    this->Settings.TerminationTransmittance = 1.0f / 255.0f;
    this->Settings.ErrorBound.PositionTolerance = 0.01;
    this->SetDeformation(0.0, PullBackKind::Exact);
  }

  /// Bytes that are 0 but for a few single voxels of 100.
  void SetSingleVoxels(int count)
  {
    std::fill(this->Bytes.begin(), this->Bytes.end(), char(0));
    std::uniform_int_distribution<std::size_t> place(0, this->Bytes.size() - 1);
    for (int i = 0; i < count; ++i)
    {
      this->Bytes[place(this->Random)] = 100;
    }
    this->MakeBlocks();
    this->SetLeastVisible(20.0);
  }

  /// Adds noise of up to `size`, of 100, so that neighbors differ.
  void AddNoise(double size)
  {
    std::uniform_real_distribution<double> uniform(-size, size);
    DispatchScalarType(this->Scene.Volume.Type, [&](auto zero) {
      using T = decltype(zero);
      T* const voxels = reinterpret_cast<T*>(this->Bytes.data());
      for (std::size_t i = 0; i < this->Bytes.size() / sizeof(T); ++i)
      {
        voxels[i] = static_cast<T>(std::round(
          std::clamp(static_cast<double>(voxels[i]) + uniform(this->Random), 0.0, 100.0)));
      }
    });
    this->MakeBlocks();
  }

  /// Values are transparent up to 20, and their opacity over the unit distance rises to 0.8. Colors
  /// go up and down `waves` times.
  void SetFunction(double waves, double unitDistance)
  {
    const auto part = [this](double value) {
      return (value - this->First) / (this->Last - this->First);
    };
    this->UseTable(MakeTable(
      this->First, this->Last, 1601, [=](double value) { return std::max(0.0, part(value) - 0.2); },
      [=](double value) {
        const double wave = 0.5 + 0.5 * std::sin(6.28 * waves * part(value));
        return glm::dvec3(part(value), wave, 1.0 - wave);
      },
      unitDistance));
  }

  /// Lines between random points, some of which are steps or transparent; `size`: entries.
  void SetRandomFunction(std::size_t size, double unitDistance)
  {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto at = [&] { return uniform(this->Random); };
    std::vector<double> places{ 0.0, 1.0 };
    for (int i = 0; i < 12; ++i)
    {
      places.push_back(at() < 0.2 ? places.back() + 1e-4 : at());
    }
    std::sort(places.begin(), places.end());
    std::vector<glm::dvec4> points;
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      points.emplace_back(at(), at(), at(), at() < 0.3 ? 0.0 : std::pow(at(), 3.0));
    }
    const auto find = [=](double value) {
      const double x = (value - this->First) / (this->Last - this->First);
      std::size_t i = 0;
      while (i + 2 < places.size() && x >= places[i + 1])
      {
        ++i;
      }
      const double part = (x - places[i]) / std::max(places[i + 1] - places[i], 1e-9);
      return glm::mix(points[i], points[i + 1], std::clamp(part, 0.0, 1.0));
    };
    this->UseTable(MakeTable(
      this->First, this->Last, size, [=](double value) { return find(value).a; },
      [=](double value) { return glm::dvec3(find(value)); }, unitDistance));
  }

  /// Values up to `least` of 0 to 100 are transparent.
  void SetLeastVisible(double least)
  {
    std::vector<float> rgb(3 * 1601);
    std::vector<float> opacity(1601);
    for (std::size_t i = 0; i < opacity.size(); ++i)
    {
      const float v = static_cast<float>(i) / 16.0f;
      rgb[3 * i] = v / 100.0f;
      rgb[3 * i + 1] = 0.6f;
      rgb[3 * i + 2] = 1.0f - v / 100.0f;
      opacity[i] = std::max(0.0f, 0.004f * (v - static_cast<float>(least)));
    }
    this->UseTable(
      TransferTable(this->First, this->Last, opacity.size(), rgb.data(), opacity.data(), 1.0));
  }

  /// Random displacements of a 7^3 lattice over the volume, smoothed; `size` in data units.
  void SetDeformation(double size, PullBackKind kind)
  {
    std::vector<glm::dvec3> displacements(343);
    std::uniform_real_distribution<double> uniform(-size, size);
    for (glm::dvec3& d : displacements)
    {
      d = glm::dvec3(uniform(this->Random), uniform(this->Random), uniform(this->Random));
    }
    this->SetLattice(7, displacements, kind);
  }

  /// Smooth displacements of a lattice of nodes^3 control points over the volume, not zero at its
  /// faces, and random ones.
  void SetFineDeformation(int nodes, double size, double noise, PullBackKind kind)
  {
    std::vector<glm::dvec3> displacements;
    std::uniform_real_distribution<double> uniform(-noise, noise);
    for (int n = 0; n < nodes * nodes * nodes; ++n)
    {
      const glm::dvec3 at =
        glm::dvec3(n % nodes, n / nodes % nodes, n / (nodes * nodes)) / double(nodes - 1);
      displacements.push_back(size *
          glm::dvec3(
            std::sin(2.0 * at.x + 3.0 * at.z), std::cos(2.0 * at.y), std::sin(at.x - at.y)) +
        glm::dvec3(uniform(this->Random), uniform(this->Random), uniform(this->Random)));
    }
    this->SetLattice(nodes, displacements, kind);
  }

  /// The second control points from the border lie at the faces of the volume.
  void SetLattice(int nodes, const std::vector<glm::dvec3>& displacements, PullBackKind kind)
  {
    const VolumeView& v = this->Scene.Volume;
    const glm::dvec3 extent = v.IndexToData * v.UpperIndex();
    const glm::dvec3 spacing = extent / double(nodes - 3);
    this->Field =
      BSplineField(glm::ivec3(nodes), v.FirstVoxel - spacing, spacing, displacements.data());
    this->Map = PullBack(&this->Field, kind, 0.005);
    const PullBackBounds mapBounds(this->Map);
    const Box rest{ v.FirstVoxel, v.FirstVoxel + extent };
    this->Scene.DeformedBounds = mapBounds.DeformedBounds(rest);
    this->Scene.Limits = mapBounds.GetLimits();
    this->Scene.Map = &this->Map;
  }

  /// `scale`: of the matrix of the volume.
  void SetCamera(bool perspective, int width, int height,
    const glm::dvec3& fromCenter = glm::dvec3(60.0, 40.0, 90.0),
    const glm::dvec3& scale = glm::dvec3(1.0))
  {
    const glm::dvec3 center(119.0, -32.0, 26.0);
    const glm::dvec3 eye = center + fromCenter;
    const glm::dmat4 view = glm::lookAt(eye, center, glm::dvec3(0.0, 1.0, 0.0));
    const double aspect = static_cast<double>(width) / height;
    const glm::dmat4 projection = perspective
      ? glm::perspective(0.6, aspect, 30.0, 300.0)
      : glm::ortho(-35.0 * aspect, 35.0 * aspect, -35.0, 35.0, 30.0, 300.0);
    const glm::dmat4 volume = glm::scale(glm::translate(glm::dmat4(1.0), center), scale);
    this->Scene.Camera.DataToNdc = projection * view * glm::translate(volume, -center);
    this->Scene.Camera.NdcToData = glm::inverse(this->Scene.Camera.DataToNdc);
    this->Scene.Camera.ImageSize = glm::ivec2(width, height);
    this->Scene.Camera.NdcPerPixel = 2.0 / glm::dvec2(width, height);
    this->Scene.Camera.NdcOrigin = glm::dvec2(-1.0);
  }

  /// After a change of Scene.Blend: the distance map of what counts. False: nothing is leaped over.
  bool UpdateLeaps()
  {
    TransferTable leaps;
    const bool any = MakeLeapTable(this->Scene.Blend, this->Table, leaps);
    if (any)
    {
      this->Distances = DistanceMap(this->Blocks, leaps);
    }
    this->Settings.Leaping = any ? SpaceLeaping::Lipschitz : SpaceLeaping::Off;
    return any;
  }

  void SetBlendMode(BlendMode mode)
  {
    Blending& blend = this->Scene.Blend;
    blend.Mode = mode;
    std::fill(std::begin(blend.Low), std::end(blend.Low), 0.0);
    std::fill(std::begin(blend.High), std::end(blend.High), 100.0);
    blend.AverageMin = 30.0;
    blend.AverageMax = 70.0;
    blend.IsoValues = { { 25.0, glm::vec3(0.2f, 0.7f, 0.9f), 0.3f },
      { 60.5, glm::vec3(0.9f, 0.5f, 0.1f), 0.8f } };
    blend.SliceOrigin = glm::dvec3(119.0, -32.0, 26.0);
    blend.SliceNormal = glm::normalize(glm::dvec3(1.0, 2.0, 4.0));
  }

  /// Makes neighbors along x components of one voxel.
  void SplitIntoComponents()
  {
    VolumeView& volume = this->Scene.Volume;
    volume.Components = 2;
    volume.Dimensions.x /= 2;
    volume.Increments[0] = 2;
    volume.IndexToData[0].x = 2.0;
    volume.DataToIndex = glm::inverse(volume.IndexToData);
  }

  struct Picture
  {
    std::vector<float> Colors;
    std::vector<float> Depths;
    std::vector<float> Reaches; // of the subtiles of tiles
    CastStatistics Statistics;
    int Stops = 0; // of tiles
  };

  /// `subtiles`: of each tile, see RayCaster::RenderTile(); other pixels are -1. `deadline`: after
  /// which a tile stops, to be gone on with at once.
  Picture Render(
    bool reference, unsigned int subtiles = RayCaster::AllSubtiles, Deadline deadline = NoDeadline)
  {
    CastSettings settings = this->Settings;
    settings.Reference = reference;
    const RayCaster caster(this->Scene, settings);
    const glm::ivec2 size = this->Scene.Camera.ImageSize;
    Picture picture;
    picture.Colors.assign(4 * static_cast<std::size_t>(size.x) * size.y, -1.0f);
    picture.Depths.assign(static_cast<std::size_t>(size.x) * size.y, -1.0f);
    CastImage image;
    image.Width = size.x;
    image.Height = size.y;
    image.Colors = picture.Colors.data();
    image.Depths = picture.Depths.data();
    const glm::ivec2 parts = (size + RayCaster::SubtileSize - 1) / RayCaster::SubtileSize;
    picture.Reaches.assign(static_cast<std::size_t>(parts.x) * parts.y, -1.0f);
    image.Reaches = picture.Reaches.data();
    auto scratch = std::make_unique<RayCaster::Scratch>();
    for (int tile = 0; tile < caster.GetNumberOfTiles(image); ++tile)
    {
      int next = 0;
      do
      {
        next = caster.RenderTile(tile, image, *scratch, subtiles, next, deadline);
        picture.Stops += next > 0 ? 1 : 0;
      } while (next > 0);
    }
    picture.Statistics = RayCaster::GetStatistics(*scratch);
    return picture;
  }

  CastScene Scene;
  CastSettings Settings;

private:
  void UseTable(const TransferTable& table)
  {
    this->Table = table;
    this->Distances = DistanceMap(this->Blocks, this->Table);
    this->Scene.Table = &this->Table;
    this->Scene.Distances = &this->Distances;
  }

  void MakeBlocks() { this->Blocks = MinMaxBlocks(this->Scene.Volume, ParallelFor()); }

  double First = 0.0; ///< values of the blob's 0 and 100
  double Last = 100.0;
  std::mt19937 Random;
  std::vector<char> Bytes;
  MinMaxBlocks Blocks;
  TransferTable Table;
  DistanceMap Distances;
  BSplineField Field;
  PullBack Map;
};

/// Mean and largest difference of two pictures, in 1 / 255.
struct Difference
{
  double Mean = 0.0;
  double Largest = 0.0;
};

Difference Compare(const std::vector<float>& a, const std::vector<float>& b)
{
  Difference difference;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    const double d = 255.0 * std::abs(static_cast<double>(a[i]) - b[i]);
    EXPECT_TRUE(std::isfinite(a[i]));
    difference.Mean += d / static_cast<double>(a.size());
    difference.Largest = std::max(difference.Largest, d);
  }
  return difference;
}

/// Both pictures show something, and the same. Single precision moves a sample across the edge of
/// a block or a ray now and then, hence the allowance for single pixels.
void ExpectSamePicture(TestScene& scene, double largest = 6.0)
{
  const TestScene::Picture reference = scene.Render(true);
  EXPECT_GT(reference.Statistics.VisibleSamples, 1000);
  ForEveryTarget([&] {
    const TestScene::Picture packets = scene.Render(false);
    const Difference colors = Compare(packets.Colors, reference.Colors);
    EXPECT_LT(colors.Mean, 0.05);
    EXPECT_LT(colors.Largest, largest);
    const Difference depths = Compare(packets.Depths, reference.Depths);
    EXPECT_LT(depths.Mean, 0.2);
    // The rays of a packet leap together.
    const double samples = static_cast<double>(packets.Statistics.Samples);
    const double ratio = samples / static_cast<double>(reference.Statistics.Samples);
    EXPECT_GT(ratio, 0.98);
    EXPECT_LT(ratio, scene.Settings.Leaping == SpaceLeaping::Off ? 1.02 : 10.0);
    EXPECT_NEAR(
      static_cast<double>(packets.Statistics.Rays) / static_cast<double>(reference.Statistics.Rays),
      1.0, 0.01);
  });
}

TEST(PacketCaster, EveryTargetIsTested)
{
  const std::int64_t supported = hwy::SupportedTargets();
  std::int64_t tested = 0;
  ForEveryTarget([&] {
    const std::int64_t targets = hwy::SupportedTargets();
    tested |= targets & -targets; // the best one
  });
  EXPECT_EQ(tested, supported & HWY_TARGETS);
#if HWY_ARCH_X86
  // With Highway 1.0 plain C++ takes the place of SSE2.
  constexpr std::int64_t vectors = HWY_SSE2 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL;
  EXPECT_EQ(HWY_TARGETS & ~(HWY_SCALAR | HWY_EMU128), vectors);
  EXPECT_NE(tested & HWY_AVX2, 0) << "A machine without AVX2 does not test all kernels.";
#elif HWY_ARCH_ARM
  EXPECT_NE(tested & (HWY_NEON | HWY_NEON_WITHOUT_AES), 0);
#endif
}

TEST(PacketCaster, AllScalarTypes)
{
  for (const ScalarType type : { ScalarType::Int8, ScalarType::UInt8, ScalarType::Int16,
         ScalarType::UInt16, ScalarType::Int32, ScalarType::UInt32, ScalarType::Int64,
         ScalarType::UInt64, ScalarType::Float32, ScalarType::Float64 })
  {
    SCOPED_TRACE("type " + std::to_string(static_cast<int>(type)));
    TestScene scene(type);
    scene.SetCamera(true, 61, 45); // no whole number of tiles
    ExpectSamePicture(scene);
    scene.SetLeastVisible(-60.0); // at faces, too
    ExpectSamePicture(scene, 30.0);
  }
}

/// Integers of 16 bits and less are interpolated as such: with all their bits, and signs.
TEST(PacketCaster, WholeRangeOfIntegers)
{
  for (const ScalarType type : { ScalarType::Int8, ScalarType::UInt8, ScalarType::Int16,
         ScalarType::UInt16, ScalarType::Int32, ScalarType::UInt32 })
  {
    for (const double leastVisible : { 20.0, -60.0 }) // the second one: at faces, too
    {
      SCOPED_TRACE("type " + std::to_string(static_cast<int>(type)));
      TestScene scene(type, 1, true);
      scene.SetLeastVisible(leastVisible);
      scene.SetCamera(true, 61, 45);
      ExpectSamePicture(scene, leastVisible < 0.0 ? 30.0 : 6.0);
    }
  }
}

TEST(PacketCaster, AllPullBacksAndCameras)
{
  for (const double size : { 0.0, 1.0, 3.0 })
  {
    for (const PullBackKind kind : { PullBackKind::FirstOrder, PullBackKind::Exact,
           PullBackKind::Forward, PullBackKind::FirstOrderOfInverse })
    {
      for (const bool perspective : { true, false })
      {
        SCOPED_TRACE("size " + std::to_string(size) + ", kind " +
          std::to_string(static_cast<int>(kind)) + (perspective ? ", perspective" : ", parallel"));
        TestScene scene(ScalarType::UInt8, 5);
        scene.SetDeformation(size, kind);
        scene.SetCamera(perspective, 64, 64);
        ExpectSamePicture(scene);
      }
    }
  }
}

/// Lanes lie in cells far from each other; D goes on linearly beyond the lattice, or not.
TEST(PacketCaster, ManyControlPoints)
{
  for (const PullBackKind kind :
    { PullBackKind::FirstOrder, PullBackKind::Exact, PullBackKind::Forward })
  {
    for (const double noise : { 0.0, 0.15 })
    {
      for (const double leastVisible : { 20.0, -60.0 }) // the second one: at faces, too
      {
        SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + ", noise " +
          std::to_string(noise) + ", visible from " + std::to_string(leastVisible));
        TestScene scene(ScalarType::UInt8, 5);
        scene.SetLeastVisible(leastVisible);
        scene.SetFineDeformation(35, 1.5, noise, kind);
        const bool extended = scene.Scene.Limits.LinearCells > 0;
        EXPECT_EQ(extended, kind == PullBackKind::Exact && noise == 0.0);
        scene.SetCamera(true, 64, 64);
        // A sample at a face may be in the volume in one picture alone.
        ExpectSamePicture(scene, leastVisible < 0.0 ? 160.0 : 6.0);
      }
    }
  }
}

/// The matrix of the volume presses it flat: in its coordinates planes of the camera are oblique to
/// the rays, which begin far from each other and from the volume.
TEST(PacketCaster, FlatVolumes)
{
  for (const glm::dvec3& scale : { glm::dvec3(0.1, 1.0, 1.0), glm::dvec3(1.0, 1e-3, 1.0),
         glm::dvec3(1.0, 1.0, 1e-5), glm::dvec3(0.01, 1.0, 100.0) })
  {
    for (const PullBackKind kind : { PullBackKind::FirstOrder, PullBackKind::Exact })
    {
      for (const double size : { 0.0, 1.0 })
      {
        for (const bool perspective : { true, false })
        {
          SCOPED_TRACE("scale " + std::to_string(scale.x) + ", " + std::to_string(scale.y) + ", " +
            std::to_string(scale.z) + ", size " + std::to_string(size) + ", kind " +
            std::to_string(static_cast<int>(kind)) +
            (perspective ? ", perspective" : ", parallel"));
          TestScene scene(ScalarType::UInt8, 5);
          scene.SetDeformation(size, kind);
          scene.SetCamera(perspective, 64, 64, glm::dvec3(60.0, 40.0, 90.0), scale);
          ExpectSamePicture(scene);
          const CastStatistics statistics = scene.Render(false).Statistics;
          EXPECT_LT(statistics.Evaluations, 200 * statistics.Rays);
        }
      }
    }
  }
}

/// Where nodes of a tile are too far apart for the deformation, those of its subtiles may do: the
/// pictures are the same, and few points are pulled back ray by ray.
TEST(PacketCaster, NodesOfSubtiles)
{
  for (const PullBackKind kind : { PullBackKind::FirstOrder, PullBackKind::Exact })
  {
    SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)));
    TestScene scene(ScalarType::UInt8, 5);
    scene.SetDeformation(0.7, kind);
    scene.SetCamera(true, 240, 200);
    ExpectSamePicture(scene);
    const CastStatistics statistics = scene.Render(false).Statistics;
    // A ray takes some 20 samples, and Newton's method more than one evaluation for each.
    EXPECT_LT(statistics.Evaluations, (kind == PullBackKind::Exact ? 10 : 5) * statistics.Rays);
  }
}

/// Voxels at the faces of the volume are visible: there are none beyond them to fetch.
TEST(PacketCaster, Faces)
{
  for (const ScalarType type : { ScalarType::Int8, ScalarType::UInt8, ScalarType::UInt16,
         ScalarType::Float32, ScalarType::Float64, ScalarType::Int32 })
  {
    for (const double size : { 0.0, 1.0 })
    {
      for (const double side : { 1.0, -1.0 })
      {
        SCOPED_TRACE("type " + std::to_string(static_cast<int>(type)) + ", size " +
          std::to_string(size) + ", side " + std::to_string(side));
        TestScene scene(type, 7);
        scene.SetLeastVisible(-60.0);
        scene.SetDeformation(size, PullBackKind::Exact);
        scene.SetCamera(true, 64, 64, side * glm::dvec3(60.0, 40.0, 90.0));
        scene.Settings.ErrorBound.PositionTolerance = 0.001;
        // Single precision takes a sample at a face for inside or outside.
        ExpectSamePicture(scene, 40.0);
      }
    }
  }
}

/// Samples at the faces of the volume and outside of it, which vectors of bytes take from windows
/// of voxels: those of all instruction sets are equal.
TEST(PacketCaster, FacesOfAllTargets)
{
  for (int corner = 0; corner < 8; ++corner)
  {
    SCOPED_TRACE("corner " + std::to_string(corner));
    TestScene scene(corner % 2 == 0 ? ScalarType::UInt8 : ScalarType::Int8, 7);
    scene.SetLeastVisible(-60.0);
    scene.SetDeformation(1.0, PullBackKind::Forward);
    scene.SetCamera(true, 64, 64,
      glm::dvec3((corner & 1) != 0 ? 60.0 : -60.0, (corner & 2) != 0 ? 50.0 : -50.0,
        corner < 4 ? 70.0 : -70.0));
    std::vector<float> first;
    ForEveryTarget([&] {
      const std::vector<float> colors = scene.Render(false).Colors;
      if (first.empty())
      {
        first = colors;
      }
      EXPECT_LT(Compare(colors, first).Mean, 2e-3);
    });
  }
}

TEST(PacketCaster, Options)
{
  for (int option = 0; option < 6; ++option)
  {
    SCOPED_TRACE("option " + std::to_string(option));
    TestScene scene(ScalarType::UInt8, 3);
    scene.SetDeformation(1.5, PullBackKind::Exact);
    scene.SetCamera(true, 64, 48);
    std::vector<float> depths(64 * 48, 1.0f);
    Light light;
    switch (option)
    {
      case 0:
        scene.Settings.Shade = false;
        break;
      case 1:
        scene.Scene.VolumeInterpolation = Interpolation::Nearest;
        break;
      case 2:
        scene.Settings.Opacity = OpacityLength::Material;
        break;
      case 3:
        scene.Settings.SampleDistance = 0.37;
        break;
      case 4:
        for (std::size_t i = 0; i < depths.size(); i += 3)
        {
          depths[i] = 0.72f;
        }
        scene.Scene.Depths = depths.data();
        break;
      default:
        light.Towards = glm::normalize(glm::dvec3(1.0, 2.0, 0.5));
        light.Diffuse = glm::vec3(1.0f, 0.3f, 0.2f);
        scene.Scene.Material.Lights.push_back(light);
        light.Positional = true;
        light.Position = glm::dvec3(160.0, 0.0, 60.0);
        light.Attenuation = glm::dvec3(1.0, 0.01, 2e-4);
        light.ConeCosine = std::cos(0.9);
        light.Axis = glm::normalize(glm::dvec3(-41.0, -32.0, -34.0));
        scene.Scene.Material.Lights.push_back(light);
        scene.Scene.Material.TwoSided = false;
        break;
    }
    // Single precision takes a position between two voxels for nearest to the other one.
    ExpectSamePicture(scene, option == 1 ? 12.0 : 6.0);
  }
}

/// Transfer functions of few and many pieces, which are looked up in registers, and of too many.
TEST(PacketCaster, TransferFunctions)
{
  std::vector<int> pieces;
  for (const double waves : { 0.0, 0.3, 0.6, 8.0 })
  {
    for (const double unitDistance : { 0.7, 1.0, 4.0 })
    {
      for (const OpacityLength length : { OpacityLength::Deformed, OpacityLength::Material })
      {
        SCOPED_TRACE(std::to_string(waves) + " waves, unit distance " +
          std::to_string(unitDistance) + ", opacity length " +
          std::to_string(static_cast<int>(length)));
        TestScene scene(ScalarType::UInt8, 7);
        scene.SetFunction(waves, unitDistance);
        scene.SetDeformation(1.5, PullBackKind::Exact);
        scene.SetCamera(true, 64, 48);
        scene.Settings.SampleDistance = 0.7;
        scene.Settings.Opacity = length;
        ExpectSamePicture(scene);
        const TransferTable& table = *scene.Scene.Table;
        pieces.push_back(FindPiecewiseOptics(table, table.GetLow(), table.GetScale(), 0.7).Pieces);
      }
    }
  }
  const auto isBetween = [](int first, int last) {
    return [=](int count) { return count >= first && count <= last; };
  };
  // None, few, those of one vector of 16 and of two.
  EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), isBetween(0, 0)));
  EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), isBetween(1, 8)));
  EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), isBetween(9, 16)));
  EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), isBetween(17, 32)));
}

TEST(PacketCaster, RandomTransferFunctions)
{
  const ScalarType types[] = { ScalarType::UInt8, ScalarType::Float32, ScalarType::Int16 };
  const BlendMode modes[] = { BlendMode::Composite, BlendMode::Average, BlendMode::Maximum };
  const char* const more = std::getenv("FFD_FUNCTION_SCENES");
  const int count = more ? std::atoi(more) : 30;
  for (int i = 0; i < count; ++i)
  {
    SCOPED_TRACE("scene " + std::to_string(i));
    TestScene scene(types[i % 3], static_cast<unsigned int>(i));
    scene.SetRandomFunction(i % 2 == 0 ? 1601 : 257, i % 4 == 0 ? 0.7 : 0.3 + 0.4 * (i % 7));
    scene.SetDeformation(1.0, PullBackKind::Exact);
    scene.SetCamera(true, 48, 40);
    scene.Settings.SampleDistance = 0.7;
    scene.Settings.Shade = i % 5 != 0;
    scene.SetBlendMode(modes[i / 3 % 3]);
    scene.UpdateLeaps();
    const TestScene::Picture reference = scene.Render(true);
    ForEveryTarget([&] {
      const TestScene::Picture packets = scene.Render(false);
      const Difference colors = Compare(packets.Colors, reference.Colors);
      // Single precision takes a sample for one at the other side of a step.
      EXPECT_LT(colors.Mean, 0.15);
    });
  }
}

/// Whole powers are multiplied, others are not.
TEST(PacketCaster, SpecularPowers)
{
  for (const float power : { 0.0f, 1.0f, 7.0f, 7.5f, 128.0f, 200.0f })
  {
    SCOPED_TRACE("power " + std::to_string(power));
    TestScene scene(ScalarType::UInt8, 3);
    scene.SetCamera(true, 64, 48);
    scene.Scene.Material.Specular = 0.8f;
    scene.Scene.Material.SpecularPower = power;
    ExpectSamePicture(scene);
    // Those of small cosines are zero: denormal numbers take processors a hundred times as long.
    Light light;
    light.Towards = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
    light.Specular = glm::vec3(1.0f);
    scene.Scene.Material.Lights.push_back(light);
    ForEveryTarget([&] {
      std::feclearexcept(FE_UNDERFLOW);
      scene.Render(false);
      EXPECT_FALSE(std::fetestexcept(FE_UNDERFLOW));
    });
  }
}

TEST(PacketCaster, OffsetsFromANearSlice)
{
  // As in volumes of 2 GiB and more: offsets reach over some slices only, also where the rays of a
  // packet are farther from each other.
  for (const ScalarType type :
    { ScalarType::UInt8, ScalarType::Int16, ScalarType::Float32, ScalarType::Float64 })
  {
    for (const BlendMode mode : { BlendMode::Composite, BlendMode::Maximum, BlendMode::Isosurface })
    {
      SCOPED_TRACE("mode " + std::to_string(static_cast<int>(mode)));
      TestScene scene(type, 3);
      scene.SetDeformation(3.0, PullBackKind::Exact);
      scene.SetCamera(true, 61, 45);
      scene.SetBlendMode(mode);
      scene.UpdateLeaps();
      ForEveryTarget([&] {
        scene.Settings.LargestReach = 2147483647.0;
        const TestScene::Picture all = scene.Render(false);
        scene.Settings.LargestReach = 1.0;
        const TestScene::Picture near = scene.Render(false);
        EXPECT_GT(all.Statistics.VisibleSamples, 100);
        EXPECT_LE(Compare(near.Colors, all.Colors).Largest, 0.01);
        EXPECT_LE(Compare(near.Depths, all.Depths).Largest, 0.01);
      });
    }
  }
}

constexpr BlendMode AllModes[] = { BlendMode::Composite, BlendMode::Maximum, BlendMode::Minimum,
  BlendMode::Average, BlendMode::Additive, BlendMode::Isosurface, BlendMode::Slice };

TEST(PacketCaster, ThinVolumes)
{
  // No cell has neighbors on all sides.
  for (const glm::ivec3& dims :
    { glm::ivec3(39, 31, 2), glm::ivec3(39, 31, 3), glm::ivec3(39, 2, 27), glm::ivec3(3, 31, 27),
      glm::ivec3(2, 31, 27), glm::ivec3(2, 3, 27), glm::ivec3(3, 2, 2) })
  {
    SCOPED_TRACE(
      std::to_string(dims.x) + " " + std::to_string(dims.y) + " " + std::to_string(dims.z));
    for (const ScalarType type : { ScalarType::UInt8, ScalarType::Int16, ScalarType::Float64 })
    {
      for (const BlendMode mode : AllModes)
      {
        SCOPED_TRACE("mode " + std::to_string(static_cast<int>(mode)));
        TestScene scene(type, 3, false, dims);
        scene.SetDeformation(type == ScalarType::Int16 ? 0.0 : 0.1, PullBackKind::Exact);
        scene.Settings.ErrorBound.PositionTolerance = 0.002;
        scene.SetCamera(true, 61, 45);
        scene.SetBlendMode(mode);
        scene.UpdateLeaps();
        const TestScene::Picture reference = scene.Render(true);
        ForEveryTarget([&] {
          const TestScene::Picture packets = scene.Render(false);
          // Pixels on the edge of what is hit are hit or not.
          const Difference colors = Compare(packets.Colors, reference.Colors);
          EXPECT_LT(
            colors.Mean, mode == BlendMode::Additive || mode == BlendMode::Isosurface ? 0.3 : 0.1);
          // The one was not rendered as the other.
          EXPECT_TRUE(mode != BlendMode::Composite || colors.Largest > 0.0);
          EXPECT_LT(Compare(packets.Depths, reference.Depths).Mean, 0.2);
          EXPECT_TRUE(dims.x < 4 || mode == BlendMode::Slice || packets.Statistics.Samples > 100);
        });
      }
    }
  }
}

TEST(PacketCaster, BlendModes)
{
  for (const BlendMode mode : AllModes)
  {
    for (const ScalarType type : { ScalarType::UInt8, ScalarType::Float64 })
    {
      SCOPED_TRACE("mode " + std::to_string(static_cast<int>(mode)));
      TestScene scene(type, 3);
      scene.SetDeformation(1.5, PullBackKind::Exact);
      scene.SetCamera(true, 61, 45);
      scene.SetBlendMode(mode);
      scene.UpdateLeaps();
      const TestScene::Picture reference = scene.Render(true);
      ForEveryTarget([&] {
        const TestScene::Picture packets = scene.Render(false);
        const Difference colors = Compare(packets.Colors, reference.Colors);
        // Pixels on the edge of what is hit are hit or not.
        EXPECT_LT(colors.Mean, mode == BlendMode::Additive ? 0.3 : 0.1);
        EXPECT_LT(Compare(packets.Depths, reference.Depths).Mean, 0.2);
        const double samples = static_cast<double>(packets.Statistics.Samples);
        EXPECT_GT(samples, 100);
        // The rays of a packet leap together.
        const double ratio = samples / static_cast<double>(reference.Statistics.Samples);
        // Minima end where nothing below them can be seen.
        EXPECT_GT(ratio,
          mode == BlendMode::Isosurface  ? 0.7
            : mode == BlendMode::Minimum ? 0.05
                                         : 0.95);
        EXPECT_LT(ratio, 10.0);
      });
    }
  }
}

/// A two-dimensional function of values from 0 to 100, visible from 20 on.
TransferPlane MakePlane(bool nearest)
{
  constexpr int Width = 26;
  constexpr int Height = 5;
  std::vector<float> texels;
  for (int i = 0; i < Width * Height; ++i)
  {
    const float x = static_cast<float>(i % Width) / (Width - 1);
    const float y = static_cast<float>(i / Width) / (Height - 1);
    texels.insert(
      texels.end(), { x, 1.0f - y, 0.4f, std::max(0.0f, 0.4f * (x - 0.2f) * (0.3f + 0.7f * y)) });
  }
  return TransferPlane(
    Width, Height, texels.data(), glm::dvec2(0.0), glm::dvec2(100.0, 25.0), nearest);
}

/// What the vector code looks up beside tables, of one component and of several.
TEST(PacketCaster, LooksOfAllTargets)
{
  enum Options : unsigned int
  {
    Plane = 1,
    Array = 2,
    Labels = 4,
    OpacityNormals = 8,
    ClippedGradients = 16,
    Nearest = 32,
    Hidden = 64,
    Uneven = 128,
    Cells = 256
  };
  const std::vector<ScalarType> pairs = { ScalarType::UInt8, ScalarType::Float64, ScalarType::Int16,
    ScalarType::Int32, ScalarType::Float32 };
  std::size_t next = 0;
  for (const unsigned int options :
    { Plane + 0u, Plane | Array, Plane | Labels, Plane | Labels | Array, Plane | OpacityNormals,
      OpacityNormals + 0u, ClippedGradients + 0u, Plane | OpacityNormals | ClippedGradients,
      OpacityNormals | ClippedGradients | Nearest, Labels | ClippedGradients, Hidden + 0u,
      Plane | Hidden, OpacityNormals | Hidden, ClippedGradients | Hidden, Uneven + 0u,
      OpacityNormals | Uneven, ClippedGradients | Uneven, Hidden | Uneven, Hidden | Nearest,
      Hidden | Cells, Hidden | Cells | Nearest, Hidden | Cells | Uneven | OpacityNormals,
      Hidden | Uneven | OpacityNormals | ClippedGradients })
  {
    for (const ComponentKind kind : { ComponentKind::Independent, ComponentKind::ColorOpacity })
    {
      for (const int components : { 1, 2 })
      {
        const bool dependent = kind != ComponentKind::Independent;
        const bool labels = (options & Labels) != 0;
        if ((components == 1 && dependent) || (components == 2 && labels && !dependent))
        {
          continue;
        }
        SCOPED_TRACE("options " + std::to_string(options) + ", components " +
          std::to_string(components) + ", kind " + std::to_string(static_cast<int>(kind)));
        TestScene scene(components == 1 ? ScalarType::Float32 : pairs[next++ % pairs.size()], 4);
        if ((options & Hidden) != 0)
        {
          scene.AddNoise(8.0);
        }
        // Rays near each other find their voxels in windows.
        scene.SetCamera(true, components == 1 ? 45 : 90, components == 1 ? 37 : 74);
        scene.Settings.Leaping = SpaceLeaping::Off;
        VolumeView& volume = scene.Scene.Volume;
        if (components == 2)
        {
          scene.SplitIntoComponents();
        }
        scene.SetDeformation(1.0, PullBackKind::Exact);
        std::vector<unsigned char> marks(static_cast<std::size_t>(
          volume.Dimensions.x * volume.Dimensions.y * volume.Dimensions.z));
        for (std::size_t i = 0; i < marks.size(); ++i)
        {
          marks[i] = static_cast<unsigned char>(
            i / 8 % static_cast<std::size_t>(volume.Dimensions.x) * 3 % 2 + i / 5000);
        }
        VolumeView further = volume;
        further.Scalars = marks.data();
        further.Type = ScalarType::UInt8;
        further.Components = 1;
        further.Increments[0] = 1;
        further.Increments[1] = volume.Dimensions.x;
        further.Increments[2] = further.Increments[1] * volume.Dimensions.y;

        OpticalFunctions functions;
        functions.Kind = kind;
        functions.Components.resize(dependent ? 1 : static_cast<std::size_t>(components));
        for (ComponentOptics& optics : functions.Components)
        {
          scene.SetLeastVisible(&optics == &functions.Components[0] ? 20.0 : 45.0);
          optics.Table = *scene.Scene.Table;
          optics.Shade = true;
          optics.Surface = scene.Scene.Material;
          if ((options & Plane) != 0)
          {
            optics.Plane = MakePlane((options & Nearest) != 0);
          }
        }
        scene.SetLeastVisible(20.0);
        functions.Colors = *scene.Scene.Table;
        ClassifierInputs inputs;
        if (labels)
        {
          functions.Labels.resize(1);
          functions.Labels[0].Table = *scene.Scene.Table;
          functions.LabelIndices = { -1, 0 };
          inputs.Mask.Volume = further;
          inputs.Mask.Labels = true;
          inputs.Mask.BlendFactor = 0.6f;
        }
        // Voxels are cells themselves, or their corners.
        const bool cells = (options & Cells) != 0;
        const double first = cells ? -0.5 : 0.0;
        const double step = cells ? 0.5 : 1.0;
        volume.Margin = -first;
        std::vector<double> positions[3];
        for (int a = 0; a < 3; ++a)
        {
          const double length = volume.Dimensions[a] - 1 - 2.0 * first;
          for (double at = 0.0; at <= length; at += step)
          {
            positions[a].push_back(first + at * (0.7 + 0.3 * at / length));
          }
        }
        const AxisMap axes(positions, first, step);
        if ((options & Uneven) != 0)
        {
          volume.Axes = &axes;
        }
        const glm::ivec3 size = volume.Dimensions - (cells ? 0 : 1);
        CellMask hidden(size);
        for (int i = 5; i < size.x * size.y * size.z; i += 23)
        {
          hidden.Add({ i % size.x, i / size.x % size.y, i / size.x / size.y });
        }
        if ((options & Hidden) != 0)
        {
          inputs.Hidden = &hidden;
        }
        inputs.Volume = volume;
        if ((options & Nearest) != 0)
        {
          scene.Scene.VolumeInterpolation = Interpolation::Nearest;
        }
        inputs.VolumeInterpolation = scene.Scene.VolumeInterpolation;
        inputs.Functions = &functions;
        inputs.Material = &scene.Scene.Material;
        inputs.NormalFromOpacity = (options & OpacityNormals) != 0;
        if ((options & Array) != 0)
        {
          inputs.SecondAxis = further;
        }
        if ((options & ClippedGradients) != 0)
        {
          scene.Scene.ClippingPlanes = { glm::normalize(glm::dvec4(1.0, 0.3, 0.2, 0.0)) };
          glm::dvec4& plane = scene.Scene.ClippingPlanes[0];
          plane.w = -glm::dot(glm::dvec3(plane), glm::dvec3(114.0, -32.0, 26.0));
          inputs.ClippingPlanes = scene.Scene.ClippingPlanes;
          inputs.ClippedIntensity = -1e100;
        }
        const SampleClassifier classifier(inputs);
        scene.Scene.Classifier = &classifier;
        const TestScene::Picture reference = scene.Render(true);
        EXPECT_GT(reference.Statistics.VisibleSamples, 500);
        // Labels are found from their rows where there are too many for one offset.
        const std::vector<double> reaches =
          labels ? std::vector<double>{ 2147483647.0, 1.0 } : std::vector<double>{ 2147483647.0 };
        ForEveryTarget([&] {
          for (const double reach : reaches)
          {
            scene.Settings.LargestReach = reach;
            const Difference colors = Compare(scene.Render(false).Colors, reference.Colors);
            EXPECT_LT(colors.Mean, 0.01);
          }
        });
      }
    }
  }
}

TEST(PacketCaster, ExtremesOfTwoComponents)
{
  for (const ScalarType type :
    { ScalarType::UInt8, ScalarType::Int16, ScalarType::Float32, ScalarType::Float64 })
  {
    SCOPED_TRACE("type " + std::to_string(static_cast<int>(type)));
    TestScene scene(type, 4);
    // Rays near each other find their voxels in windows.
    scene.SetCamera(true, 90, 74);
    scene.SetBlendMode(BlendMode::Maximum);
    scene.Settings.Leaping = SpaceLeaping::Off;
    scene.SplitIntoComponents();
    scene.SetDeformation(1.0, PullBackKind::Exact);
    OpticalFunctions functions;
    functions.Components.resize(2);
    for (const std::size_t c : { 1, 0 })
    {
      scene.SetLeastVisible(c == 0 ? 20.0 : 45.0);
      functions.Components[c].Table = *scene.Scene.Table;
    }
    ClassifierInputs inputs;
    inputs.Volume = scene.Scene.Volume;
    inputs.Functions = &functions;
    inputs.Material = &scene.Scene.Material;
    const SampleClassifier classifier(inputs);
    scene.Scene.Classifier = &classifier;
    const TestScene::Picture reference = scene.Render(true);
    EXPECT_GT(reference.Statistics.VisibleSamples, 500);
    ForEveryTarget([&] {
      const TestScene::Picture packets = scene.Render(false);
      EXPECT_LT(Compare(packets.Colors, reference.Colors).Mean, 0.01);
      EXPECT_LT(Compare(packets.Depths, reference.Depths).Mean, 0.01);
    });
  }
}

TEST(PacketCaster, LeapingChangesNoBlendMode)
{
  for (const BlendMode mode : AllModes)
  {
    for (const bool reference : { true, false })
    {
      SCOPED_TRACE("mode " + std::to_string(static_cast<int>(mode)));
      TestScene scene(ScalarType::UInt8, 9);
      scene.SetDeformation(2.0, PullBackKind::Exact);
      scene.SetCamera(true, 64, 64);
      scene.SetBlendMode(mode);
      if (!scene.UpdateLeaps())
      {
        EXPECT_TRUE(mode == BlendMode::Additive || mode == BlendMode::Slice);
        continue;
      }
      const auto check = [&] {
        scene.Settings.Leaping = SpaceLeaping::Off;
        const TestScene::Picture off = scene.Render(reference);
        for (const SpaceLeaping leaping : { SpaceLeaping::Segment, SpaceLeaping::Lipschitz })
        {
          scene.Settings.Leaping = leaping;
          const TestScene::Picture on = scene.Render(reference);
          EXPECT_LE(Compare(on.Colors, off.Colors).Largest, 0.01);
          EXPECT_LE(Compare(on.Depths, off.Depths).Largest, 0.01);
          // The background is the least value: nothing of it shows, nor anything else then.
          if (mode != BlendMode::Minimum)
          {
            EXPECT_LT(on.Statistics.Samples, off.Statistics.Samples);
          }
        }
      };
      if (reference)
      {
        check();
      }
      else
      {
        ForEveryTarget(check);
      }
    }
  }
}

TEST(PacketCaster, JitterCroppingAndClipping)
{
  for (int option = 0; option < 6; ++option)
  {
    for (const BlendMode mode : { BlendMode::Composite, BlendMode::Maximum, BlendMode::Isosurface })
    {
      SCOPED_TRACE(
        "option " + std::to_string(option) + ", mode " + std::to_string(static_cast<int>(mode)));
      TestScene scene(ScalarType::UInt8, 3);
      scene.SetDeformation(1.5, PullBackKind::Exact);
      scene.SetCamera(true, 61, 45);
      scene.SetBlendMode(mode);
      scene.UpdateLeaps();
      const TestScene::Picture plain = scene.Render(true);
      Cropping& crop = scene.Scene.Crop;
      switch (option)
      {
        case 0:
          scene.Settings.Jitter = true;
          break;
        case 1:
          crop.Space = Cropping::Spaces::Rest;
          crop.Low = glm::dvec3(11.0, 8.0, 9.5);
          crop.High = glm::dvec3(24.0, 20.3, 15.0);
          crop.Flags = 0x2ebdeba;
          break;
        case 2:
          crop.Space = Cropping::Spaces::Deformed;
          crop.Low = glm::dvec3(111.0, -41.0, 20.0);
          crop.High = glm::dvec3(124.0, -29.0, 30.0);
          crop.Flags = 0x7be8bef;
          break;
        case 3:
          scene.Scene.ClippingPlanes = { glm::dvec4(1.0, 0.0, 0.0, -113.0),
            glm::dvec4(0.0, 0.6, -0.8, 46.0) };
          break;
        case 4:
          scene.Settings.Jitter = true;
          crop.Space = Cropping::Spaces::Rest;
          crop.Low = glm::dvec3(5.0);
          crop.High = glm::dvec3(20.0);
          crop.Flags = 1 << 13;
          break;
        default:
          scene.Scene.ClippingPlanes = { glm::dvec4(-60.0, -40.0, -90.0, 8320.0) };
          break;
      }
      const TestScene::Picture reference = scene.Render(true);
      // The option does something, but for jitter, which isosurfaces do not take.
      const double change = Compare(reference.Colors, plain.Colors).Mean;
      if (option == 0 && mode == BlendMode::Isosurface)
      {
        EXPECT_EQ(change, 0.0);
      }
      else
      {
        EXPECT_GT(change, 1e-5);
      }
      scene.Settings.Leaping = SpaceLeaping::Off;
      EXPECT_LE(Compare(scene.Render(true).Colors, reference.Colors).Largest, 0.01);
      ForEveryTarget([&] {
        scene.Settings.Leaping = SpaceLeaping::Off;
        const TestScene::Picture off = scene.Render(false);
        EXPECT_LT(Compare(off.Colors, reference.Colors).Mean, 0.1);
        EXPECT_LT(Compare(off.Depths, reference.Depths).Mean, 0.2);
        scene.Settings.Leaping = SpaceLeaping::Lipschitz;
        const TestScene::Picture on = scene.Render(false);
        EXPECT_LE(Compare(on.Colors, off.Colors).Largest, 0.01);
      });
    }
  }
}

TEST(PacketCaster, LeapingChangesNothing)
{
  for (const PullBackKind kind : { PullBackKind::FirstOrder, PullBackKind::Exact })
  {
    // The last one folds.
    for (const double size : { 0.0, 2.0, 12.0 })
    {
      SCOPED_TRACE("size " + std::to_string(size));
      TestScene scene(ScalarType::UInt8, 9);
      scene.SetDeformation(size, kind);
      scene.SetCamera(true, 64, 64);
      ForEveryTarget([&] {
        scene.Settings.Leaping = SpaceLeaping::Off;
        const TestScene::Picture off = scene.Render(false);
        for (const SpaceLeaping leaping : { SpaceLeaping::Segment, SpaceLeaping::Lipschitz })
        {
          scene.Settings.Leaping = leaping;
          const TestScene::Picture on = scene.Render(false);
          EXPECT_LE(Compare(on.Colors, off.Colors).Largest, 0.01);
          // Where T folds samples are pulled back one by one, and none is left out.
          EXPECT_LT(on.Statistics.Samples, off.Statistics.Samples + (size > 10.0 ? 1 : 0));
        }
      });
    }
  }
}

TEST(PacketCaster, LeapingFindsSingleVoxels)
{
  // Many segments come near to what is visible, and the deformation is so strong that their first
  // interpolants err by voxels.
  for (const double size : { 3.0, 6.0, 9.0 })
  {
    SCOPED_TRACE("size " + std::to_string(size));
    TestScene scene(ScalarType::UInt8, 17);
    scene.SetSingleVoxels(6);
    scene.SetDeformation(size, PullBackKind::Exact);
    scene.SetCamera(true, 160, 160);
    ForEveryTarget([&] {
      scene.Settings.Leaping = SpaceLeaping::Off;
      const TestScene::Picture off = scene.Render(false);
      EXPECT_GT(off.Statistics.VisibleSamples, 50);
      scene.Settings.Leaping = SpaceLeaping::Lipschitz;
      const TestScene::Picture on = scene.Render(false);
      EXPECT_LE(Compare(on.Colors, off.Colors).Largest, 0.01);
      EXPECT_LT(5 * on.Statistics.Samples, off.Statistics.Samples);
    });
  }
}

TEST(PacketCaster, NothingIsEvaluatedWhereNothingCanBeSeen)
{
  TestScene scene(ScalarType::UInt8, 9);
  scene.SetLeastVisible(200.0);
  scene.SetDeformation(2.0, PullBackKind::Exact);
  scene.SetCamera(true, 64, 64);
  for (const bool reference : { false, true })
  {
    for (const SpaceLeaping leaping : { SpaceLeaping::Segment, SpaceLeaping::Lipschitz })
    {
      scene.Settings.Leaping = leaping;
      const TestScene::Picture picture = scene.Render(reference);
      EXPECT_EQ(picture.Statistics.Evaluations, 0);
      EXPECT_EQ(picture.Statistics.Segments, 0);
      EXPECT_EQ(picture.Statistics.Samples, 0);
      EXPECT_EQ(picture.Colors, std::vector<float>(picture.Colors.size(), 0.0f));
      EXPECT_EQ(picture.Depths, std::vector<float>(picture.Depths.size(), 1.0f));
    }
  }
}

TEST(PacketCaster, Subtiles)
{
  TestScene scene(ScalarType::UInt8, 4);
  scene.SetDeformation(2.0, PullBackKind::Exact);
  // The last tiles are cut in the middle of a subtile.
  const glm::ivec2 size(60, 53);
  scene.SetCamera(true, size.x, size.y);
  ForEveryTarget([&] {
    for (bool reference : { true, false })
    {
      const TestScene::Picture whole = scene.Render(reference);
      for (unsigned int subtiles : { 1u, 6u, 8u, 11u })
      {
        const TestScene::Picture part = scene.Render(reference, subtiles);
        double worst = 0.0;
        for (int y = 0; y < size.y; ++y)
        {
          for (int x = 0; x < size.x; ++x)
          {
            const std::size_t at = static_cast<std::size_t>(y) * size.x + x;
            constexpr int side = RayCaster::SubtileSize;
            const int perRow = (size.x + side - 1) / side;
            const std::size_t reach = static_cast<std::size_t>(y / side * perRow + x / side);
            const bool wanted = (subtiles >> (x / side % 2 + 2 * (y / side % 2)) & 1u) != 0;
            for (std::size_t c = 4 * at; c < 4 * at + 4; ++c)
            {
              // Newton's method starts where the first ray of a tile does.
              worst = std::max(worst,
                std::abs(static_cast<double>(part.Colors[c]) - (wanted ? whole.Colors[c] : -1.0f)));
            }
            ASSERT_EQ(part.Depths[at] >= 0.0f, wanted);
            ASSERT_EQ(part.Reaches[reach] >= 0.0f, wanted);
          }
        }
        EXPECT_LE(worst, 2.0 / 255.0) << (reference ? "reference" : "packets");
        EXPECT_LT(part.Statistics.Rays, whole.Statistics.Rays);
      }
    }
  });
}

/// A tile that stops after each packet, or each ray of the reference, and goes on, gives the same
/// pixels. Of the rays before its last stop it is not known how far they reach.
TEST(PacketCaster, TilesThatStop)
{
  TestScene scene(ScalarType::UInt8, 4);
  scene.SetDeformation(2.0, PullBackKind::Exact);
  scene.SetCamera(true, 60, 53);
  ForEveryTarget([&] {
    for (bool reference : { true, false })
    {
      const TestScene::Picture whole = scene.Render(reference);
      const TestScene::Picture stopped =
        scene.Render(reference, RayCaster::AllSubtiles, Deadline::min());
      EXPECT_EQ(whole.Stops, 0);
      EXPECT_GT(stopped.Stops, 20);
      EXPECT_EQ(stopped.Colors, whole.Colors);
      EXPECT_EQ(stopped.Depths, whole.Depths);
      EXPECT_EQ(stopped.Statistics.Rays, whole.Statistics.Rays);
      EXPECT_EQ(stopped.Statistics.Samples, whole.Statistics.Samples);
      for (std::size_t i = 0; i < whole.Reaches.size(); ++i)
      {
        EXPECT_GE(stopped.Reaches[i], whole.Reaches[i]);
      }
    }
  });
}

/// Tiles beside each other share roots where the deformation is smooth: that saves evaluations, and
/// the picture, which is close to that of the reference, depends neither on the order of tiles nor
/// on which of them a thread renders.
TEST(PacketCaster, TilesShareRoots)
{
  TestScene scene(ScalarType::UInt8);
  scene.SetCamera(true, 250, 190);
  scene.Settings.ErrorBound.PositionTolerance = 0.1;
  scene.Settings.ErrorBound.LongestSegment = 16.0;
  const auto render = [&scene](bool backwards, bool apart) {
    const RayCaster caster(scene.Scene, scene.Settings);
    TestScene::Picture picture;
    picture.Colors.assign(4 * 250 * 190, -1.0f);
    CastImage image;
    image.Width = 250;
    image.Height = 190;
    image.Colors = picture.Colors.data();
    const int tiles = caster.GetNumberOfTiles(image);
    auto scratch = std::make_unique<RayCaster::Scratch>();
    for (int i = 0; i < tiles; ++i)
    {
      scratch = apart ? std::make_unique<RayCaster::Scratch>() : std::move(scratch);
      caster.RenderTile(backwards ? tiles - 1 - i : i, image, *scratch);
      if (apart)
      {
        picture.Statistics.Add(RayCaster::GetStatistics(*scratch));
      }
    }
    if (!apart)
    {
      picture.Statistics = RayCaster::GetStatistics(*scratch);
    }
    return picture;
  };
  for (const double size : { 0.1, 12.0 })
  {
    for (const PullBackKind kind : { PullBackKind::Exact, PullBackKind::FirstOrder })
    {
      SCOPED_TRACE(size);
      scene.SetDeformation(size, kind);
      const TestScene::Picture apart = render(false, true);
      const TestScene::Picture inRows = render(false, false);
      EXPECT_GT(apart.Statistics.VisibleSamples, 10000);
      EXPECT_EQ(Compare(apart.Colors, inRows.Colors).Largest, 0.0);
      EXPECT_EQ(Compare(apart.Colors, render(true, false).Colors).Largest, 0.0);
      // In rows two tiles of each square follow each other.
      const double evaluations = static_cast<double>(inRows.Statistics.Evaluations);
      const double ofApart = static_cast<double>(apart.Statistics.Evaluations);
      if (size == 0.1)
      {
        EXPECT_LT(evaluations, 0.7 * ofApart);
        const Difference fromReference = Compare(inRows.Colors, scene.Render(true).Colors);
        EXPECT_LT(fromReference.Mean, 0.03);
        EXPECT_LT(fromReference.Largest, 5.0);
      }
    }
  }
}

TEST(PacketCaster, ReachesHoldWhatEndsTheRays)
{
  TestScene scene(ScalarType::UInt8, 4);
  scene.SetLeastVisible(5.0);
  scene.SetDeformation(2.0, PullBackKind::Exact);
  scene.Settings.TerminationTransmittance = 0.7f;
  const glm::ivec2 size(128, 128);
  scene.SetCamera(false, size.x, size.y);
  ForEveryTarget([&] {
    const TestScene::Picture picture = scene.Render(false);
    int ended = 0;
    for (int y = 0; y < size.y; ++y)
    {
      for (int x = 0; x < size.x; ++x)
      {
        const std::size_t at = static_cast<std::size_t>(y) * size.x + x;
        constexpr int side = RayCaster::SubtileSize;
        const int perRow = (size.x + side - 1) / side;
        const float reach = picture.Reaches[static_cast<std::size_t>(y / side * perRow + x / side)];
        const bool terminated = picture.Colors[4 * at + 3] > 0.3f;
        if (!terminated)
        {
          // A ray that goes on sees all that is behind.
          ASSERT_TRUE(std::isinf(reach));
        }
        else if (std::isfinite(reach))
        {
          ++ended;
          // The first visible sample is not beyond, and the near plane not in between.
          const double t = 270.0 * picture.Depths[at];
          ASSERT_LE(t, static_cast<double>(reach) + 1e-3);
          ASSERT_LT(reach, 270.0f);
        }
      }
    }
    EXPECT_GT(ended, 100);
  });
}

} // namespace
