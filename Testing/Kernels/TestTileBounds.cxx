// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Boxes that hold what may be seen through the tiles of an image, and where in space something may
// be seen: against visible points that are taken forward, and against pictures of all rays.
#include "Bounds/FFDMatrixBounds.h"
#include "Bounds/FFDPullBackBounds.h"
#include "FFDBoxOrientation.h"
#include "FFDFieldCache.h"
#include "FFDRayCaster.h"
#include "FFDTileBounds.h"
#include "FFDVisibleSpace.h"
#include "Packets/FFDTileSegment.h"

#include "RandomLattice.h"
#include "TestVolume.h"

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

using namespace ffd;

namespace
{

constexpr int Width = 150;
constexpr int Height = 110;

/// Opaque above 30.
TransferTable Opaque()
{
  std::vector<float> rgb;
  std::vector<float> opacity;
  for (int i = 0; i < 256; ++i)
  {
    rgb.insert(rgb.end(), { 1.0f, 0.8f, 0.6f });
    opacity.push_back(i > 30 ? 0.5f : 0.0f);
  }
  return TransferTable(0.0, 255.0, opacity.size(), rgb.data(), opacity.data(), 1.0);
}

/// A volume in a random lattice, seen from somewhere.
struct Scenery
{
  Scenery(RandomLattice& random, int run, PullBackKind kind)
    : Volume(ScalarType::UInt8,
        glm::ivec3(random.Integer(20, 70), random.Integer(20, 70), random.Integer(20, 70)),
        [&](int i, int j, int k) {
          // Some balls in air, or no air at all.
          const glm::dvec3 p(i, j, k);
          return run % 2 == 0 || glm::distance(p, glm::dvec3(12.0)) < 5.0 ||
              glm::distance(p, glm::dvec3(30, 14, 9)) < 3.0
            ? 100.0
            : 0.0;
        })
    , Table(Opaque())
  {
    const double amount = std::pow(10.0, random.Number(-1.0, 1.2));
    std::vector<glm::dvec3> displacements(216);
    for (glm::dvec3& d : displacements)
    {
      d = amount * random.Vector(-1.0, 1.0);
    }
    // The lattice ends within the volume in some scenes.
    const double spacing = run % 4 == 0 ? 9.0 : 16.0;
    this->Field =
      BSplineField(glm::ivec3(6), glm::dvec3(-4.0), glm::dvec3(spacing, -spacing, spacing),
        displacements.data(), 1.0, run % 3 == 0 ? BorderMode::Edge : BorderMode::Zero);
    this->Map = PullBack(run % 11 == 0 ? nullptr : &this->Field, kind, 1e-9);
    this->MapBounds.reset(new PullBackBounds(this->Map));
    // Voxels of unequal edges, along tilted axes.
    VolumeView& view = this->Volume.View;
    view.FirstVoxel = glm::dvec3(-1.0, run % 4 == 0 ? -20.0 : -60.0, 2.0);
    if (run % 5 == 1)
    {
      view.IndexToData = glm::dmat3(glm::rotate(glm::dmat4(1.0), 0.4, glm::dvec3(1.0, 2.0, 0.5))) *
        glm::dmat3(0.8, 0.0, 0.0, 0.0, 1.1, 0.0, 0.0, 0.0, 0.7);
      view.DataToIndex = glm::inverse(view.IndexToData);
    }
    this->Blocks = MinMaxBlocks(view, ParallelFor());
    this->Distances = DistanceMap(this->Blocks, this->Table);
    const glm::dvec3 half = Absolute(view.IndexToData) * (0.5 * view.UpperIndex());
    const glm::dvec3 middle = view.FirstVoxel + view.IndexToData * (0.5 * view.UpperIndex());
    this->Scene.Volume = view;
    this->Scene.DeformedBounds = this->MapBounds->DeformedBounds({ middle - half, middle + half });
    this->Scene.Limits = this->MapBounds->GetLimits();
    this->Scene.Table = &this->Table;
    this->Scene.Distances = &this->Distances;
    this->Scene.Map = &this->Map;
    this->Scene.VoxelSize = run % 5 == 1 ? 0.7 : 1.0;
    this->LookAt(random, run, middle);
  }

  /// From outside, or from inside of the volume; perspective or parallel.
  void LookAt(RandomLattice& random, int run, const glm::dvec3& middle)
  {
    CameraView& camera = this->Scene.Camera;
    const double distance = run % 6 == 5 ? 5.0 : 160.0;
    const glm::dvec3 eye = middle + distance * glm::normalize(random.Vector(-1.0, 1.0));
    camera.Parallel = run % 7 == 3;
    const double aspect = static_cast<double>(Width) / Height;
    const glm::dmat4 projection = camera.Parallel
      ? glm::ortho(-40.0 * aspect, 40.0 * aspect, -40.0, 40.0, 1.0, 400.0)
      : glm::perspective(0.6, aspect, 0.5, 400.0);
    camera.DataToNdc = projection * glm::lookAt(eye, middle, glm::dvec3(0.1, 1.0, 0.2));
    camera.NdcToData = glm::inverse(camera.DataToNdc);
    camera.ImageSize = glm::ivec2(Width, Height);
    camera.NdcPerPixel = glm::dvec2(2.0 / Width, 2.0 / Height);
    camera.Eye = eye;
    if (run % 3 == 1)
    {
      // The image is a part of a larger one.
      camera.PixelOrigin = glm::ivec2(64, 32);
      camera.NdcOrigin -= glm::dvec2(camera.PixelOrigin) * camera.NdcPerPixel;
    }
  }

  std::vector<float> Render(SpaceLeaping leaping, bool countsRays = true)
  {
    CastSettings settings;
    settings.Leaping = leaping;
    settings.CountsRays = countsRays;
    const RayCaster caster(this->Scene, settings);
    std::vector<float> colors(4 * Width * Height, -1.0f);
    std::vector<float> depths(Width * Height, -1.0f);
    const CastImage image{ Width, Height, colors.data(), depths.data() };
    RayCaster::Scratch scratch;
    for (int tile = 0; tile < caster.GetNumberOfTiles(image); ++tile)
    {
      caster.RenderTile(tile, image, scratch);
    }
    this->Statistics = RayCaster::GetStatistics(scratch);
    colors.insert(colors.end(), depths.begin(), depths.end());
    return colors;
  }

  TestVolume Volume;
  TransferTable Table;
  BSplineField Field;
  PullBack Map;
  std::unique_ptr<PullBackBounds> MapBounds;
  MinMaxBlocks Blocks;
  DistanceMap Distances;
  CastScene Scene;
  CastStatistics Statistics;
};

/// A parallel view along -y onto (32, 32, 32), `pixels` wide and high, which show twice `half`.
CameraView LookAlongY(int pixels, double half)
{
  CameraView camera;
  camera.DataToNdc = glm::ortho(-half, half, -half, half, 1.0, 400.0) *
    glm::lookAt(glm::dvec3(32.0, 200.0, 32.0), glm::dvec3(32.0), glm::dvec3(0.0, 0.0, 1.0));
  camera.ImageSize = glm::ivec2(pixels);
  camera.NdcPerPixel = glm::dvec2(2.0 / pixels);
  return camera;
}

/// The box of the tile of such a view that a point is seen through; null if nothing is known.
const TileBounds::Limits* FindBox(
  const TileBounds& bounds, const CameraView& camera, const glm::dvec3& p)
{
  const double half = 0.5 * camera.ImageSize.x;
  const glm::dvec2 pixel = half + half * glm::dvec2(camera.DataToNdc * glm::dvec4(p, 1.0));
  const glm::ivec2 tile = glm::ivec2(pixel) / TileSide * TileSide;
  return bounds.Find(tile.x, tile.y);
}

constexpr PullBackKind Kinds[] = { PullBackKind::Exact, PullBackKind::FirstOrder,
  PullBackKind::Forward };

bool Holds(const TileBounds::Limits& box, const glm::dvec3& p)
{
  bool holds = true;
  for (int a = 0; a < 3; ++a)
  {
    holds =
      holds && p[a] >= static_cast<double>(box.Min[a]) && p[a] <= static_cast<double>(box.Max[a]);
  }
  return holds;
}

} // namespace

TEST(TileBounds, HoldWhatMayBeVisible)
{
  RandomLattice random(7);
  const glm::dvec3 origin(3.0, -2.0, 1.0);
  for (const PullBackKind kind : Kinds)
  {
    int seen = 0;
    int empty = 0;
    int tiles = 0;
    for (int run = 0; run < 120; ++run)
    {
      const Scenery scenery(random, run, kind);
      const CameraView& camera = scenery.Scene.Camera;
      const TileBounds bounds(scenery.Scene, 0.1, 0.0, origin);
      for (int y = 0; y < Height; y += TileSide)
      {
        for (int x = 0; x < Width; x += TileSide)
        {
          const TileBounds::Limits* const box = bounds.Find(x, y);
          ASSERT_NE(box, nullptr);
          ++tiles;
          empty += box->IsEmpty() ? 1 : 0;
        }
      }
      for (int point = 0; point < 4000; ++point)
      {
        const VolumeView& view = scenery.Scene.Volume;
        glm::dvec3 index = random.Vector(0.0, 1.0) * view.UpperIndex();
        if (point % 2 == 0)
        {
          const int axis = point / 2 % 3;
          index[axis] = point / 6 % 2 == 0 ? 0.0 : view.UpperIndex()[axis];
        }
        // Where it is seen: T is known, of other pull-backs some point is tried.
        glm::dvec3 p = view.FirstVoxel + view.IndexToData * index;
        if (kind == PullBackKind::Exact)
        {
          p += scenery.Map.IsIdentity() ? glm::dvec3(0.0) : scenery.Field.Displacement(p);
        }
        else
        {
          const Box& deformed = scenery.Scene.DeformedBounds;
          p = glm::mix(deformed.Min, deformed.Max, random.Vector(0.0, 1.0));
          PullBackStatus status;
          index = view.ToIndex(scenery.Map.Evaluate(p, status));
          if (glm::any(glm::lessThan(index, glm::dvec3(0.0))) ||
            glm::any(glm::greaterThan(index, view.UpperIndex())))
          {
            continue;
          }
        }
        const glm::dvec4 clip = camera.DataToNdc * glm::dvec4(p, 1.0);
        const glm::dvec2 pixel =
          (glm::dvec2(clip) / clip.w - camera.ToNdc(0.0, 0.0)) / camera.NdcPerPixel;
        if (!(scenery.Volume.Interpolate(index) > 31.0) || clip.w <= 0.0 ||
          std::abs(clip.z) > clip.w || pixel.x < 0.0 || pixel.y < 0.0 || pixel.x >= Width ||
          pixel.y >= Height)
        {
          continue;
        }
        ++seen;
        const glm::ivec2 tile = glm::ivec2(pixel) / TileSide * TileSide;
        ASSERT_TRUE(Holds(*bounds.Find(tile.x, tile.y), p - origin)) << "run " << run;
      }
    }
    EXPECT_GT(seen, 2000);
    EXPECT_GT(empty, tiles / 4);
  }
}

// A ball that is moved as a whole: what random lattices do in a box is much the same both ways.
TEST(TileBounds, HoldWhatIsMoved)
{
  const glm::dvec3 ball(20.0);
  const TestVolume volume(ScalarType::UInt8, glm::ivec3(64), [ball](int i, int j, int k) {
    return glm::distance(glm::dvec3(i, j, k), ball) < 3.0 ? 100.0 : 0.0;
  });
  const TransferTable table = Opaque();
  const MinMaxBlocks blocks(volume.View, ParallelFor());
  const DistanceMap distances(blocks, table);
  const glm::dvec3 d(24.0, 0.0, 24.0);
  const std::vector<glm::dvec3> displacements(6 * 6 * 6, d);
  const BSplineField field(
    glm::ivec3(6), glm::dvec3(-8.0), glm::dvec3(16.0), displacements.data(), 1.0, BorderMode::Edge);
  for (const PullBackKind kind : Kinds)
  {
    const PullBack map(&field, kind, 1e-9);
    CastScene scene;
    scene.Volume = volume.View;
    scene.DeformedBounds = { glm::dvec3(-40.0), glm::dvec3(104.0) };
    scene.Distances = &distances;
    scene.Map = &map;
    scene.Camera = LookAlongY(256, 72.0);
    const TileBounds bounds(scene, 0.1, 0.0, glm::dvec3(0.0));
    const auto find = [&](const glm::dvec3& p) { return *FindBox(bounds, scene.Camera, p); };
    const glm::dvec3 there = kind == PullBackKind::Forward ? ball - d : ball + d;
    const glm::dvec3 elsewhere = kind == PullBackKind::Forward ? ball + d : ball - d;
    EXPECT_TRUE(Holds(find(there), there));
    EXPECT_TRUE(find(elsewhere).IsEmpty());
  }
}

// A bump of the deformed volume between the corners of the boxes that it is cut into.
TEST(TileBounds, HoldWhatBulges)
{
  const TestVolume volume(ScalarType::UInt8, glm::ivec3(64), [](int, int, int) { return 100.0; });
  const TransferTable table = Opaque();
  const MinMaxBlocks blocks(volume.View, ParallelFor());
  const DistanceMap distances(blocks, table);
  // Boxes of 7.875 voxels: one control point in the middle of a face of one of them is moved.
  const glm::dvec3 top(4.5 * 7.875, 4.5 * 7.875, 63.0);
  std::vector<glm::dvec3> displacements(9 * 9 * 9);
  displacements[4 + 9 * (4 + 9 * 7)] = glm::dvec3(0.0, 0.0, 12.0);
  const BSplineField field(
    glm::ivec3(9), top - 8.0 * glm::dvec3(4.0, 4.0, 7.0), glm::dvec3(8.0), displacements.data());
  const PullBack map(&field, PullBackKind::Exact, 1e-9);
  CastScene scene;
  scene.Volume = volume.View;
  scene.Distances = &distances;
  scene.Map = &map;
  scene.Camera = LookAlongY(128, 60.0);
  const glm::dvec3 p = top + field.Displacement(top);
  const TileBounds bounds(scene, 0.1, 0.0, glm::dvec3(0.0));
  const TileBounds::Limits* const box = FindBox(bounds, scene.Camera, p);
  ASSERT_NE(box, nullptr);
  EXPECT_TRUE(Holds(*box, p));
}

TEST(TileBounds, ChangeNoPicture)
{
  RandomLattice random(8);
  int visible = 0;
  std::int64_t with = 0;
  std::int64_t without = 0;
  for (int run = 0; run < 80; ++run)
  {
    Scenery scenery(random, run, Kinds[run % 3]);
    const std::vector<float> all = scenery.Render(SpaceLeaping::Off);
    const std::int64_t rays = scenery.Statistics.Rays;
    without += scenery.Statistics.Evaluations;
    visible += *std::max_element(all.begin(), all.begin() + 4 * Width * Height) > 0.0f ? 1 : 0;
    ASSERT_EQ(scenery.Render(SpaceLeaping::Lipschitz), all) << "run " << run;
    with += scenery.Statistics.Evaluations;
    EXPECT_EQ(scenery.Statistics.Rays, rays);
    const std::int64_t evaluations = scenery.Statistics.Evaluations;
    ASSERT_EQ(scenery.Render(SpaceLeaping::Lipschitz, false), all) << "run " << run;
    EXPECT_LE(scenery.Statistics.Rays, rays);
    // VisibleSpace is made later where nothing is counted.
    EXPECT_GE(scenery.Statistics.Evaluations, evaluations);
  }
  EXPECT_GT(visible, 50);
  EXPECT_LT(with, without);
}

TEST(TileBounds, KnowNothingOfMirroredInverses)
{
  RandomLattice random(9);
  Scenery scenery(random, 1, PullBackKind::FirstOrderOfInverse);
  const glm::dvec3 origin(0.0);
  EXPECT_EQ(TileBounds(scenery.Scene, 0.1, 0.0, origin).Find(0, 0), nullptr);
  scenery.Map = PullBack(&scenery.Field, PullBackKind::Exact, 1e-9);
  const TileBounds exact(scenery.Scene, 0.1, 0.0, origin);
  ASSERT_NE(exact.Find(0, 0), nullptr);
  ASSERT_NE(exact.Find(TileSide, TileSide), nullptr);
  // No tile begins there.
  EXPECT_EQ(exact.Find(1, 0), nullptr);
  EXPECT_EQ(exact.Find(-TileSide, 0), nullptr);
  EXPECT_EQ(exact.Find(10 * TileSide, 0), nullptr);
  scenery.Scene.Distances = nullptr;
  EXPECT_EQ(TileBounds(scenery.Scene, 0.1, 0.0, origin).Find(0, 0), nullptr);
  EXPECT_EQ(TileBounds().Find(0, 0), nullptr);
}

TEST(VisibleSpace, MeetsWhatMayBeVisible)
{
  RandomLattice random(10);
  const glm::dvec3 origin(3.0, -2.0, 1.0);
  int seen = 0;
  int empty = 0;
  int boxes = 0;
  for (int run = 0; run < 120; ++run)
  {
    const Scenery scenery(random, run, PullBackKind::Exact);
    // What has either orientation may be visible, or what keeps that of space alone.
    const double orientation = run / 12 % 2;
    const VisibleSpace space(scenery.Scene, orientation, 0.1, 0.0, origin,
      run % 2 == 0 ? SpaceCache::Boxes::Few : SpaceCache::Boxes::Many);
    const auto meets = [&](const glm::dvec3& p, double half) {
      const glm::vec3 low(p - half - origin);
      const glm::vec3 high(p + half - origin);
      return space.Meets(&low.x, &high.x);
    };
    for (int point = 0; point < 2000; ++point)
    {
      const VolumeView& view = scenery.Scene.Volume;
      const glm::dvec3 index = random.Vector(0.0, 1.0) * view.UpperIndex();
      const glm::dvec3 q = view.FirstVoxel + view.IndexToData * index;
      glm::dvec3 p = q;
      glm::dmat3 jacobian(0.0);
      if (!scenery.Map.IsIdentity())
      {
        p += scenery.Field.Displacement(q, jacobian);
      }
      const bool turned = glm::determinant(glm::dmat3(1.0) + jacobian) <= 0.0;
      if (scenery.Volume.Interpolate(index) > 31.0 && (orientation == 0.0 || !turned))
      {
        ++seen;
        ASSERT_TRUE(meets(p, 0.0) && meets(p, 3.0)) << "run " << run;
      }
      const Box& deformed = scenery.Scene.DeformedBounds;
      ++boxes;
      empty += meets(glm::mix(deformed.Min, deformed.Max, random.Vector(0.0, 1.0)), 1.0) ? 0 : 1;
    }
    EXPECT_FALSE(meets(glm::dvec3(1e30), 1.0));
    EXPECT_FALSE(meets(glm::dvec3(-1e30), 1.0));
  }
  EXPECT_GT(seen, 20000);
  EXPECT_GT(empty, boxes / 4);
}

TEST(VolumeSpace, HoldsAllOfTheWhole)
{
  RandomLattice random(14);
  const glm::dvec3 origin(3.0, -2.0, 1.0);
  int outside = 0;
  int points = 0;
  for (int run = 0; run < 60; ++run)
  {
    const Scenery scenery(random, run, PullBackKind::Exact);
    // The volume is a part of something larger.
    const VolumeView& view = scenery.Scene.Volume;
    Box whole = FindBoundsAtRest(view);
    whole.Min -= random.Vector(0.0, 20.0);
    whole.Max += random.Vector(0.0, 20.0);
    VolumeSpace space(scenery.Scene, whole, 0.0, origin);
    const SpaceCells& cells = space.Get();
    EXPECT_EQ(&space.Get(), &cells);
    const auto isMarked = [&](const glm::dvec3& p) {
      int cell[3];
      for (int a = 0; a < 3; ++a)
      {
        cell[a] = static_cast<int>(std::floor(
          (static_cast<float>(p[a] - origin[a]) - cells.GetLow(a)) * cells.GetCellsPerLength(a)));
        if (cell[a] < 0 || cell[a] >= SpaceCells::Cells)
        {
          return false;
        }
      }
      return cells.IsMarked(cell[0], cell[1], cell[2]);
    };
    Box images{ glm::dvec3(1e30), glm::dvec3(-1e30) };
    for (int point = 0; point < 2000; ++point)
    {
      const glm::dvec3 q = glm::mix(whole.Min, whole.Max, random.Vector(0.0, 1.0));
      const glm::dvec3 p = scenery.Map.IsIdentity() ? q : q + scenery.Field.Displacement(q);
      ASSERT_TRUE(isMarked(p)) << "run " << run;
      images = { glm::min(images.Min, p), glm::max(images.Max, p) };
    }
    for (int point = 0; point < 2000; ++point)
    {
      ++points;
      outside += isMarked(glm::mix(images.Min, images.Max, random.Vector(-0.1, 1.1))) ? 0 : 1;
    }
    EXPECT_FALSE(isMarked(glm::dvec3(1e6)));
  }
  EXPECT_GT(outside, points / 10);
}

TEST(SpaceCache, KeepsWhatFollowsFromTheSameSettings)
{
  RandomLattice random(15);
  Scenery scenery(random, 0, PullBackKind::Exact);
  CastScene& scene = scenery.Scene;
  SpaceCache cache;
  FieldCache field;
  FieldCache otherField;
  scene.KeptOfSpace = &cache;
  scene.KeptOfField = &field;
  SpaceSettings settings{ 1.0, 0.1, 0.5, { 3.0, -2.0, 1.0 } };
  // Whether something is known before any work, as it is after the next frame's.
  const auto isKept = [&] {
    VisibleSpaceOnDemand space(
      scene, settings.Orientation, settings.Tolerance, settings.Reach, settings.Origin);
    const bool known = space.Find() != nullptr;
    space.NoteWork(100000000);
    EXPECT_NE(space.Find(), nullptr);
    return known;
  };
  const auto expectKeptOnce = [&isKept] {
    EXPECT_FALSE(isKept());
    EXPECT_TRUE(isKept());
    EXPECT_TRUE(isKept());
  };
  EXPECT_EQ(cache.GetMemorySize(), 0u);
  expectKeptOnce();
  EXPECT_EQ(cache.GetMemorySize(), std::size_t{ SpaceCells::Cells } * SpaceCells::Cells * 8);
  settings.Orientation = 0.0;
  expectKeptOnce();
  settings.Tolerance = 0.2;
  expectKeptOnce();
  settings.Reach = 0.6;
  expectKeptOnce();
  settings.Origin.y = 2.0;
  expectKeptOnce();
  scene.KeptOfField = &otherField;
  expectKeptOnce();
  scene.Volume.FirstVoxel.x += 1.0;
  expectKeptOnce();
  scene.Volume.IndexToData *= 1.5;
  expectKeptOnce();
  // What is not known by its value is not kept.
  scene.KeptOfField = nullptr;
  EXPECT_FALSE(isKept());
  EXPECT_FALSE(isKept());
}

TEST(SpaceCache, WhatIsAskedForAgainIsMadeByMoreBoxes)
{
  RandomLattice random(17);
  int fewer = 0;
  for (int run = 0; run < 20; ++run)
  {
    Scenery scenery(random, run, PullBackKind::Exact);
    SpaceCache cache;
    FieldCache field;
    scenery.Scene.KeptOfSpace = &cache;
    scenery.Scene.KeptOfField = &field;
    const auto count = [&](std::int64_t evaluations) {
      VisibleSpaceOnDemand space(scenery.Scene, 1.0, 0.1, 0.5, glm::dvec3(0.0));
      space.NoteWork(evaluations);
      double marked = 0.0;
      double volume = 1.0;
      for (int a = 0; a < 3; ++a)
      {
        volume /= static_cast<double>(space.Find()->GetCellsPerLength(a));
      }
      for (int cell = 0; cell < 64 * 64 * 64; ++cell)
      {
        marked += space.Find()->IsMarked(cell % 64, cell / 64 % 64, cell / 64 / 64) ? volume : 0.0;
      }
      return marked;
    };
    const double first = count(30000);
    // That takes longer: little work is not enough for it.
    EXPECT_EQ(count(30000), first);
    const double second = count(100000);
    EXPECT_LE(second, 1.02 * first);
    EXPECT_EQ(count(0), second);
    EXPECT_EQ(count(1000000), second);
    fewer += second < 0.97 * first ? 1 : 0;
  }
  EXPECT_GT(fewer, 10);
}

TEST(SpaceCache, ChangesNoPicture)
{
  RandomLattice random(16);
  for (int run = 0; run < 20; ++run)
  {
    Scenery scenery(random, run, PullBackKind::Exact);
    const std::vector<float> expected = scenery.Render(SpaceLeaping::Lipschitz);
    SpaceCache cache;
    FieldCache field;
    scenery.Scene.KeptOfSpace = &cache;
    scenery.Scene.KeptOfField = &field;
    for (int frame = 0; frame < 3; ++frame)
    {
      ASSERT_EQ(scenery.Render(SpaceLeaping::Lipschitz), expected) << run;
      ASSERT_EQ(scenery.Render(SpaceLeaping::Lipschitz, false), expected) << run;
    }
  }
}

TEST(BoxOrientation, ProvesWhatIsTurnedOver)
{
  RandomLattice random(12);
  int turnedOver = 0;
  int negative = 0;
  for (int run = 0; run < 60; ++run)
  {
    const BSplineField field = random.Field(
      random.Number(0.3, 2.0), run % 2 == 0 ? BorderMode::Edge : BorderMode::ZeroAtBorder);
    const double orientation = run % 3 == 0 ? -1.0 : 1.0;
    const glm::dvec3 lower = random.Point(field, 0.5);
    const glm::dvec3 extent = field.GetSpacing() * random.Vector(0.5, 5.0);
    const BoxGrid boxes({ lower, lower + extent }, random.Integer(100, 250000), 1e-3);
    const BoxImages images(boxes, &field, 1.0);
    const BoxOrientation orientations(images, field, BoundThirdDerivatives(field), orientation);
    for (int n = 0; n < 5000; ++n)
    {
      const glm::ivec3 first(random.Vector(0.0, 1.0) * glm::dvec3(boxes.Count));
      const glm::ivec3 end = glm::min(first + random.Integer(1, 2), boxes.Count);
      const bool told = orientations.AreTurnedOver(first, end);
      // How many are told is counted among some; what is told must be true of all.
      const bool counted = n < 300;
      if (!told && !counted)
      {
        continue;
      }
      const Box box{ boxes.Get(first).Min, boxes.Get(end - 1).Max };
      bool all = true;
      for (int point = 0; point < 20; ++point)
      {
        // The corners, and points between them.
        const glm::dvec3 part =
          point < 8 ? glm::dvec3(point & 1, point >> 1 & 1, point >> 2) : random.Vector(0.0, 1.0);
        glm::dmat3 jacobian;
        field.Displacement(glm::mix(box.Min, box.Max, part), jacobian);
        all = all && orientation * glm::determinant(glm::dmat3(1.0) + jacobian) < 1e-9;
      }
      ASSERT_TRUE(all || !told) << "run " << run;
      turnedOver += told && counted ? 1 : 0;
      negative += all && counted ? 1 : 0;
    }
  }
  EXPECT_GT(negative, 2000);
  EXPECT_GT(turnedOver, negative / 3);
}

// Three quarters of a volume are turned over; most of what they are taken to is theirs alone.
TEST(VisibleSpace, LeavesOutWhatIsTurnedOver)
{
  RandomLattice random(13);
  Scenery scenery(random, 0, PullBackKind::Exact);
  const VolumeView& volume = scenery.Scene.Volume;
  const double width = volume.UpperIndex().x;
  const double fold = volume.FirstVoxel.x + 0.75 * width;
  // T(x, y, z) = (fold + |x - fold|, y, z), but for the edge.
  const glm::dvec3 spacing(width / 12.0, 200.0, 200.0);
  const glm::dvec3 lower(volume.FirstVoxel.x - 3.0 * spacing.x, -300.0, -300.0);
  std::vector<glm::dvec3> displacements(20 * 4 * 4, glm::dvec3(0.0));
  for (int n = 0; n < 20 * 16; ++n)
  {
    const double x = lower.x + n % 20 * spacing.x;
    displacements[static_cast<std::size_t>(n)].x = std::max(2.0 * (fold - x), 0.0);
  }
  scenery.Field = BSplineField(glm::ivec3(20, 4, 4), lower, spacing, displacements.data());
  scenery.Map = PullBack(&scenery.Field, PullBackKind::Exact, 1e-9);
  const glm::dvec3 middle = volume.FirstVoxel + 0.5 * volume.UpperIndex();
  const auto meets = [&](double orientation, double part) {
    const VisibleSpace space(scenery.Scene, orientation, 0.1, 0.0, middle);
    const glm::vec3 p(fold + part * width - middle.x, 0.0, 0.0);
    return space.Meets(&p.x, &p.x);
  };
  EXPECT_TRUE(meets(0.0, 0.55) && meets(0.0, 0.1));
  EXPECT_TRUE(meets(-1.0, 0.55) && meets(-1.0, 0.1));
  EXPECT_TRUE(meets(1.0, 0.1));
  EXPECT_FALSE(meets(1.0, 0.55));
}

// Two balls behind each other, between which a lattice is crumpled: nothing is to be inverted
// there.
TEST(VisibleSpace, SparesInversesOfNothing)
{
  const TestVolume volume(ScalarType::UInt8, glm::ivec3(64, 192, 64), [](int i, int j, int k) {
    const glm::dvec3 p(i, j, k);
    const double distance =
      std::min(glm::distance(p, glm::dvec3(32, 8, 32)), glm::distance(p, glm::dvec3(32, 184, 32)));
    return distance < 5.0 ? 100.0 : 0.0;
  });
  const TransferTable table = Opaque();
  const MinMaxBlocks blocks(volume.View, ParallelFor());
  const DistanceMap distances(blocks, table);
  RandomLattice random(11);
  std::vector<glm::dvec3> displacements(9 * 25 * 9);
  for (int k = 0; k < 9; ++k)
  {
    for (int j = 8; j < 17; ++j)
    {
      for (int i = 0; i < 9; ++i)
      {
        displacements[static_cast<std::size_t>(i + 9 * (j + 25 * k))] = random.Vector(-20.0, 20.0);
      }
    }
  }
  const BSplineField field(
    glm::ivec3(9, 25, 9), glm::dvec3(0.0), glm::dvec3(8.0), displacements.data());
  const PullBack map(&field, PullBackKind::Exact, 1e-9);
  CastScene scene;
  scene.Volume = volume.View;
  scene.DeformedBounds = { glm::dvec3(-40.0), glm::dvec3(104.0, 232.0, 104.0) };
  scene.Limits.OneToOne = false;
  scene.Table = &table;
  scene.Distances = &distances;
  scene.Map = &map;
  scene.Camera = LookAlongY(128, 10.0);
  scene.Camera.NdcToData = glm::inverse(scene.Camera.DataToNdc);
  scene.Camera.NdcOrigin = glm::dvec2(-1.0);
  scene.Camera.Parallel = true;
  const auto countEvaluations = [&](SpaceLeaping leaping, std::vector<float>& colors) {
    CastSettings settings;
    settings.Leaping = leaping;
    const RayCaster caster(scene, settings);
    colors.assign(4 * 128 * 128, -1.0f);
    const CastImage image{ 128, 128, colors.data(), nullptr };
    RayCaster::Scratch scratch;
    for (int tile = 0; tile < caster.GetNumberOfTiles(image); ++tile)
    {
      caster.RenderTile(tile, image, scratch);
    }
    const CastStatistics statistics = RayCaster::GetStatistics(scratch);
    return static_cast<double>(statistics.Evaluations) / static_cast<double>(statistics.Rays);
  };
  std::vector<float> all;
  std::vector<float> seen;
  const double without = countEvaluations(SpaceLeaping::Off, all);
  const double with = countEvaluations(SpaceLeaping::Lipschitz, seen);
  EXPECT_EQ(seen, all);
  EXPECT_GT(*std::max_element(all.begin(), all.end()), 0.9f);
  EXPECT_LT(with, 0.05 * without);
}
