// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What an edit is said to have moved at most, and where, against the maps before and after it; and
// which tiles of a picture that concerns.
#include "FFDClipToBox.h"
#include "FFDPullBackChange.h"
#include "FFDTileHistory.h"

#include "RandomLattice.h"

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

using namespace ffd;

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

constexpr PullBackKind Kinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

/// A lattice before and after an edit of some of its control points.
struct Edited
{
  Edited(RandomLattice& random, PullBackKind kind, BorderMode border, double amount)
  {
    const glm::ivec3 nodes(random.Integer(4, 9), random.Integer(4, 7), random.Integer(4, 7));
    glm::dvec3 spacing = random.Vector(4.0, 12.0);
    spacing.y *= random.Integer(0, 1) ? 1.0 : -1.0;
    const glm::dvec3 origin = random.Vector(-20.0, 20.0);
    std::vector<glm::dvec3> displacements(static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z);
    for (glm::dvec3& d : displacements)
    {
      d = amount * random.Vector(-1.0, 1.0) * spacing;
    }
    this->Old = BSplineField(nodes, origin, spacing, displacements.data(), 1.0, border);
    const int edits = random.Integer(1, 3);
    for (int e = 0; e < edits; ++e)
    {
      const int at = random.Integer(0, static_cast<int>(displacements.size()) - 1);
      displacements[static_cast<std::size_t>(at)] +=
        0.3 * amount * random.Vector(-1.0, 1.0) * spacing;
    }
    this->New = BSplineField(nodes, origin, spacing, displacements.data(), 1.0, border);
    this->Before = PullBack(&this->Old, kind, 1e-10);
    this->After = PullBack(&this->New, kind, 1e-10);
    const glm::dvec3 last = origin + spacing * glm::dvec3(nodes - 1);
    this->Rest = { glm::min(origin, last), glm::max(origin, last) };
    const PullBackBounds mapBounds(this->After);
    const Box region{ this->Rest.Min - 10.0, this->Rest.Max + 10.0 };
    this->Limits = mapBounds.GetLimits();
    this->Inverts = InvertsTheField(kind);
    // Displacements by a twentieth of the spacing cannot fold.
    this->Found = FindChange(this->Before, this->After, this->Limits,
      this->Inverts ? this->Rest : region, 3.0, nullptr, this->Change);
  }

  /// How far the rest point of p has moved.
  double ChangedAt(const glm::dvec3& p) const
  {
    PullBackStatus status;
    return glm::length(this->After.Evaluate(p, status) - this->Before.Evaluate(p, status));
  }

  /// How far what was at p has moved, in the sense of PullBackChange.
  double MovedAt(const glm::dvec3& p) const
  {
    if (this->After.GetKind() != PullBackKind::Exact)
    {
      return this->ChangedAt(p);
    }
    PullBackStatus status;
    const glm::dvec3 q = this->Before.Evaluate(p, status);
    return glm::length(q + this->New.Displacement(q) - p);
  }

  /// Whether one of the maps leads into the volume: else it does not matter.
  bool Matters(const glm::dvec3& p) const
  {
    PullBackStatus status;
    const auto inside = [&](const glm::dvec3& q) {
      return glm::all(glm::greaterThanEqual(q, this->Rest.Min)) &&
        glm::all(glm::lessThanEqual(q, this->Rest.Max));
    };
    return inside(this->After.Evaluate(p, status)) || inside(this->Before.Evaluate(p, status));
  }

  BSplineField Old;
  BSplineField New;
  PullBack Before;
  PullBack After;
  PullBackLimits Limits;
  Box Rest;
  bool Inverts = false;
  bool Found = false;
  PullBackChange Change;
};

/// The largest bound of all parts that a point may be in; `within`: of those that are no farther
/// away than that times what they have moved by.
double BoundAt(const PullBackChange& change, const glm::dvec3& p, double within = 0.0)
{
  const int row = change.Parts.x + 1;
  const int layer = row * (change.Parts.y + 1);
  double largest = 0.0;
  std::size_t part = 0;
  for (int k = 0; k < change.Parts.z; ++k)
  {
    for (int j = 0; j < change.Parts.y; ++j)
    {
      for (int i = 0; i < change.Parts.x; ++i, ++part)
      {
        glm::dvec3 low(Infinity);
        glm::dvec3 high(-Infinity);
        for (int c = 0; c < 8; ++c)
        {
          const glm::dvec3& corner = change.Corners[static_cast<std::size_t>(
            i + (c & 1) + row * (j + (c >> 1 & 1)) + layer * (k + (c >> 2)))];
          low = glm::min(low, corner - change.Margin - within * change.Moved[part]);
          high = glm::max(high, corner + change.Margin + within * change.Moved[part]);
        }
        if (glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high)))
        {
          largest = std::max(largest, change.Moved[part]);
        }
      }
    }
  }
  return largest;
}

/// `flatness`: by which the matrix of the volume presses it flat along an axis.
CameraView RandomCamera(
  RandomLattice& random, const Box& bounds, const glm::ivec2& size, double flatness = 1.0)
{
  const double radius = glm::length(bounds.Max - bounds.Min);
  const glm::dvec3 target = 0.5 * (bounds.Min + bounds.Max);
  const glm::dvec3 eye =
    target + glm::normalize(random.Vector(-1.0, 1.0) + 1e-3) * radius * random.Number(0.3, 2.0);
  CameraView camera;
  camera.Parallel = random.Integer(0, 2) == 0;
  const glm::dmat4 projection = camera.Parallel
    ? glm::ortho(
        -0.5 * radius, 0.5 * radius, -0.5 * radius, 0.5 * radius, 0.05 * radius, 5.0 * radius)
    : glm::perspective(random.Number(0.4, 1.2), 1.0, 0.05 * radius, 5.0 * radius);
  camera.DataToNdc = projection *
    glm::lookAt(eye, target, glm::normalize(random.Vector(-1.0, 1.0) + glm::dvec3(1e-3, 0.0, 0.0)));
  glm::dvec3 scale(1.0);
  scale[random.Integer(0, 2)] = 1.0 / flatness;
  const glm::dmat4 flat = glm::scale(glm::translate(glm::dmat4(1.0), target), scale);
  camera.DataToNdc *= glm::translate(flat, -target);
  camera.NdcToData = glm::inverse(camera.DataToNdc);
  camera.ImageSize = size;
  camera.NdcPerPixel = 2.0 / glm::dvec2(size);
  camera.Eye = glm::dvec3(glm::inverse(glm::translate(flat, -target)) * glm::dvec4(eye, 1.0));
  return camera;
}

} // namespace

TEST(PullBackChange, BoundsWhatMoves)
{
  RandomLattice random(11);
  int checked = 0;
  int bounded = 0;
  for (PullBackKind kind : Kinds)
  {
    double closest = 0.0;
    for (BorderMode border : AllBorders)
    {
      for (int repeat = 0; repeat < 4; ++repeat)
      {
        const Edited edited(random, kind, border, 0.05);
        ASSERT_TRUE(edited.Found);
        ASSERT_FALSE(edited.Change.IsEmpty());
        for (int i = 0; i < 400; ++i)
        {
          const glm::dvec3 p = random.Point(edited.New, 1.5);
          if (!edited.Matters(p))
          {
            continue;
          }
          const double moved = edited.MovedAt(p);
          const double bound = BoundAt(edited.Change, p);
          ASSERT_LE(moved, bound + 1e-8);
          // Outside of all parts nothing is different in any sense.
          ASSERT_TRUE(bound > 0.0 || edited.ChangedAt(p) < 1e-8);
          ++checked;
          bounded += moved > 1e-3 ? 1 : 0;
          closest = moved > 1e-3 ? std::max(closest, moved / bound) : closest;
        }
      }
    }
    // Bounds that are met nearly: nothing much closer could be said.
    EXPECT_GT(closest, kind == PullBackKind::FirstOrderOfInverse ? 0.7 : 0.85);
  }
  EXPECT_GT(checked, 3000);
  EXPECT_GT(bounded, 500);
}

// What moves is T^-1, however little of it is left in 2P - T^-1(P).
TEST(PullBackChange, FirstOrderOfTheInverseMovesAsTheInverse)
{
  const glm::ivec3 nodes(7);
  std::vector<glm::dvec3> displacements;
  for (int i = 0; i < 343; ++i)
  {
    displacements.push_back(-0.4 * (glm::dvec3(i % 7, i / 7 % 7, i / 49) - 3.0));
  }
  const auto makeField = [&] {
    return BSplineField(nodes, glm::dvec3(0.0), glm::dvec3(1.0), displacements.data());
  };
  const BSplineField old = makeField();
  displacements[171].x += 0.01;
  const BSplineField now = makeField();
  const PullBack before(&old, PullBackKind::FirstOrderOfInverse, 1e-10);
  const PullBack after(&now, PullBackKind::FirstOrderOfInverse, 1e-10);
  PullBackChange change;
  ASSERT_TRUE(FindChange(before, after, PullBackBounds(after).GetLimits(),
    { glm::dvec3(0.0), glm::dvec3(6.0) }, 0.5, nullptr, change));
  PullBackStatus status;
  const glm::dvec3 p(3.0);
  const double moved = glm::length(after.Evaluate(p, status) - before.Evaluate(p, status));
  EXPECT_GT(moved, 1e-3);
  EXPECT_LE(moved, BoundAt(change, p));
}

TEST(PullBackChange, WhatCannotBeSeenDoesNotCount)
{
  RandomLattice random(13);
  int before = 0;
  int after = 0;
  int forgotten = 0;
  for (PullBackKind kind : Kinds)
  {
    for (int repeat = 0; repeat < 12; ++repeat)
    {
      Edited edited(random, kind, AllBorders[repeat % 3], 0.05);
      ASSERT_TRUE(edited.Found);
      const std::vector<double> all = edited.Change.Moved;
      // A ball can be seen.
      const glm::dvec3 middle = random.Point(edited.New, 0.0);
      const double radius = random.Number(0.2, 1.0) * glm::length(edited.New.GetSpacing());
      const auto isSeen = [&](const glm::dvec3& q) { return glm::length(q - middle) < radius; };
      const auto isEmpty = [&](const Box& rest) {
        return !isSeen(glm::clamp(middle, rest.Min, rest.Max));
      };
      ASSERT_TRUE(FindChange(
        edited.Before, edited.After, edited.Limits, edited.Rest, 3.0, isEmpty, edited.Change));
      ASSERT_EQ(edited.Change.Moved.size(), all.size());
      for (std::size_t part = 0; part < all.size(); ++part)
      {
        ASSERT_TRUE(edited.Change.Moved[part] == all[part] || edited.Change.Moved[part] == 0.0);
        forgotten += edited.Change.Moved[part] != all[part] ? 1 : 0;
      }
      if (kind != PullBackKind::Exact)
      {
        ASSERT_EQ(edited.Change.Moved, all);
        continue;
      }
      for (int i = 0; i < 2000; ++i)
      {
        const glm::dvec3 p = random.Point(edited.New, 1.0);
        PullBackStatus status;
        const glm::dvec3 was = edited.Before.Evaluate(p, status);
        const glm::dvec3 is = edited.After.Evaluate(p, status);
        const double bound = BoundAt(edited.Change, p, 1.0) + 1e-8;
        if (isSeen(was))
        {
          ASSERT_LE(edited.MovedAt(p), bound);
          before += bound > 1e-6 ? 1 : 0;
        }
        if (isSeen(is))
        {
          ASSERT_LE(glm::length(is + edited.Old.Displacement(is) - p), bound);
          after += bound > 1e-6 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(before, 100);
  EXPECT_GT(after, 100);
  EXPECT_GT(forgotten, 100);
}

TEST(PullBackChange, ReportsOnlyEditsOfTheSameLattice)
{
  RandomLattice random(5);
  Edited edited(random, PullBackKind::Exact, BorderMode::Edge, 0.05);
  PullBackChange change;
  const auto find = [&](const PullBack& before, const PullBack& after) {
    return FindChange(before, after, edited.Limits, edited.Rest, 3.0, nullptr, change);
  };
  EXPECT_TRUE(find(edited.Before, edited.After));
  EXPECT_FALSE(change.IsEmpty());
  // No edit at all.
  EXPECT_TRUE(find(edited.After, edited.After));
  EXPECT_TRUE(change.IsEmpty());
  // Another kind, another grid, none.
  const PullBack forward(&edited.Old, PullBackKind::Forward, 1e-10);
  EXPECT_FALSE(find(forward, edited.After));
  const BSplineField other(edited.New.GetNodes(), edited.New.GetOrigin() + 1.0,
    edited.New.GetSpacing(), nullptr, 1.0, BorderMode::Edge);
  const PullBack elsewhere(&other, PullBackKind::Exact, 1e-10);
  EXPECT_FALSE(find(elsewhere, edited.After));
  const PullBack none;
  EXPECT_FALSE(find(none, edited.After));
  // A lattice that folds has no single inverse.
  const Edited folded(random, PullBackKind::Exact, BorderMode::Edge, 4.0);
  ASSERT_FALSE(folded.Limits.OneToOne);
  EXPECT_FALSE(folded.Found);
  // Not for the kinds that invert nothing.
  EXPECT_TRUE(Edited(random, PullBackKind::Forward, BorderMode::Edge, 4.0).Found);
}

TEST(TileHistory, TilesThatSeeTheChangeAreCastAgain)
{
  RandomLattice random(23);
  const glm::ivec2 size(200, 180);
  const int tilesPerRow = 13;
  int hits = 0;
  int kept = 0;
  for (int repeat = 0; repeat < 24; ++repeat)
  {
    const PullBackKind kind = Kinds[repeat % 4];
    const Edited edited(random, kind, AllBorders[repeat % 3], 0.05);
    const CameraView camera =
      RandomCamera(random, edited.Rest, size, repeat % 3 == 0 ? random.Number(1.0, 300.0) : 1.0);
    for (double tolerance : { 0.0, 0.02, 0.2 })
    {
      TileHistory tiles(16);
      tiles.Start(size);
      ASSERT_EQ(tiles.CollectTilesToCast().size(), 13u * 12u);
      // Rays that end early.
      std::vector<float> reaches(13 * 12);
      for (std::size_t i = 0; i < reaches.size(); ++i)
      {
        const glm::ivec2 tile(static_cast<int>(i) % tilesPerRow, static_cast<int>(i) / tilesPerRow);
        const ViewRay ray = camera.MakeRay(16.0 * tile.x + 8.0, 16.0 * tile.y + 8.0);
        const double middle = ray.FindNearestT(0.5 * (edited.Rest.Min + edited.Rest.Max));
        const bool ends = random.Integer(0, 1) == 0;
        reaches[i] = ends
          ? static_cast<float>(
              middle + random.Number(-0.7, 0.7) * glm::length(edited.Rest.Max - edited.Rest.Min))
          : std::numeric_limits<float>::infinity();
        tiles.GetReaches()[i] = reaches[i];
      }
      tiles.RecordChange(edited.Change, camera, tolerance);
      const std::vector<int> list = tiles.CollectTilesToCast();
      const std::set<int> cast(list.begin(), list.end());
      kept += static_cast<int>(reaches.size() - cast.size());
      for (int i = 0; i < 8000; ++i)
      {
        const glm::dvec2 pixel(random.Integer(0, size.x - 1), random.Integer(0, size.y - 1));
        const ViewRay ray = camera.MakeRay(pixel.x + 0.5, pixel.y + 0.5);
        double from = 0.0;
        double to = ray.Far;
        if (!ClipToBox(ray.Origin, ray.Direction, edited.Rest, from, to))
        {
          continue;
        }
        const double t = random.Number(from, to);
        const glm::dvec3 p = ray.At(t);
        const int tile =
          static_cast<int>(pixel.x) / 16 + tilesPerRow * (static_cast<int>(pixel.y) / 16);
        const auto distanceTo = [&p](const ViewRay& other) {
          return glm::length(glm::cross(p - other.Origin, other.Direction));
        };
        const double pixelSize = std::min(distanceTo(camera.MakeRay(pixel.x + 1.5, pixel.y + 0.5)),
          distanceTo(camera.MakeRay(pixel.x + 0.5, pixel.y + 1.5)));
        if (t > reaches[static_cast<std::size_t>(tile)] || !edited.Matters(p))
        {
          continue;
        }
        // Pixels to the sides of a perspective picture are a little larger than those in its
        // middle.
        if (edited.MovedAt(p) > std::max(1e-8, 2.0 * tolerance * pixelSize) ||
          (tolerance == 0.0 && edited.ChangedAt(p) > 1e-8))
        {
          ++hits;
          ASSERT_EQ(cast.count(tile), 1u);
        }
      }
    }
  }
  EXPECT_GT(hits, 2000);
  EXPECT_GT(kept, 1500);
}

TEST(TileHistory, EditsAddUp)
{
  RandomLattice random(3);
  const Edited edited(random, PullBackKind::Exact, BorderMode::Edge, 0.05);
  const glm::ivec2 size(64, 64);
  const CameraView camera = RandomCamera(random, edited.Rest, size);
  // How far the tile that moves most does.
  double low = 0.0;
  double high = 1e3;
  for (int i = 0; i < 40; ++i)
  {
    const double middle = 0.5 * (low + high);
    TileHistory tiles(16);
    tiles.Start(size);
    tiles.CollectTilesToCast();
    tiles.RecordChange(edited.Change, camera, middle);
    (tiles.CollectTilesToCast().empty() ? high : low) = middle;
  }
  ASSERT_GT(high, 1e-3);
  TileHistory tiles(16);
  tiles.Start(size);
  tiles.CollectTilesToCast();
  for (int edit = 1; edit <= 3; ++edit)
  {
    tiles.RecordChange(edited.Change, camera, 2.5 * high);
    EXPECT_EQ(tiles.CollectTilesToCast().empty(), edit < 3) << edit;
  }
}

TEST(TileHistory, DepthsWithinReach)
{
  const glm::ivec2 size(40, 33);
  CameraView camera;
  camera.Parallel = true;
  camera.DataToNdc = glm::ortho(0.0, 40.0, 0.0, 33.0, 0.0, 100.0);
  camera.NdcToData = glm::inverse(camera.DataToNdc);
  camera.ImageSize = size;
  camera.NdcPerPixel = 2.0 / glm::dvec2(size);
  TileHistory tiles(16);
  tiles.Start(size);
  ASSERT_EQ(tiles.CollectTilesToCast().size(), 9u);
  tiles.GetReaches()[1] = 50.0f;
  tiles.GetReaches()[4] = 50.0f;
  std::vector<float> before(40 * 33, 1.0f);
  std::vector<float> now = before;
  const auto at = [](int x, int y) { return static_cast<std::size_t>(y * 40 + x); };
  now[at(17, 3)] = 0.51f;    // tile 1, beyond its reach
  before[at(18, 20)] = 0.4f; // tile 4, nearer
  now[at(39, 32)] = 0.9f;    // tile 8, which goes on to the end
  tiles.RecordDepths(before.data(), now.data(), camera);
  EXPECT_EQ(tiles.CollectTilesToCast(), (std::vector<int>{ 4, 8 }));
  // Nothing was drawn before, and the same now.
  std::vector<float> same(40 * 33, 1.0f);
  tiles.RecordDepths(nullptr, same.data(), camera);
  EXPECT_TRUE(tiles.CollectTilesToCast().empty());
}

TEST(TileHistory, OtherDepthsInGroups)
{
  const glm::ivec2 size(70, 40);
  TileHistory tiles(16);
  tiles.Start(size);
  ASSERT_EQ(tiles.CollectTilesToCast().size(), 15u); // 5 x 3, in groups of 2 x 2
  std::vector<float> before(70 * 40, 1.0f);
  std::vector<float> now = before;
  tiles.RecordOtherDepths(before.data(), now.data(), 2);
  tiles.RecordOtherDepths(nullptr, now.data(), 2);
  tiles.RecordOtherDepths(nullptr, nullptr, 2);
  EXPECT_TRUE(tiles.CollectTilesToCast().empty());
  // However far behind what the rays reach; the groups at the border are smaller.
  tiles.GetReaches()[2] = 1e-6f;
  now[70 * 3 + 40] = 0.999f;
  before[70 * 39 + 69] = 0.5f;
  tiles.RecordOtherDepths(before.data(), now.data(), 2);
  EXPECT_EQ(tiles.CollectTilesToCast(), (std::vector<int>{ 2, 3, 7, 8, 14 }));
  tiles.RecordOtherDepths(before.data(), nullptr, 2);
  EXPECT_EQ(tiles.CollectTilesToCast(), (std::vector<int>{ 14 }));
}

TEST(TileHistory, PicturesMoveByTiles)
{
  const auto color = [](int x, int y, int c) { return static_cast<float>(1000 * y + 4 * x + c); };
  TileHistory tiles(16);
  const glm::ivec2 size(40, 48);
  std::vector<float> colors;
  std::vector<float> depths;
  for (int y = 0; y < size.y; ++y)
  {
    for (int x = 0; x < size.x; ++x)
    {
      depths.push_back(color(x, y, 7));
      for (int c = 0; c < 4; ++c)
      {
        colors.push_back(color(x, y, c));
      }
    }
  }
  tiles.Start(size);
  tiles.CollectTilesToCast();
  tiles.GetReaches()[5] = 7.0f; // tile (2, 1), 8 pixels wide
  tiles.GetReaches()[4] = 6.0f; // tile (1, 1)
  // One tile more to the left and below, three columns of pixels more to the right.
  const glm::ivec2 next(16 + 43, 16 + 48);
  std::vector<float> firstVisible = depths;
  tiles.Continue(next, glm::ivec2(-1, -1), colors, depths, &firstVisible);
  EXPECT_EQ(firstVisible.size(), depths.size());
  ASSERT_EQ(colors.size(), 4u * 59u * 64u);
  ASSERT_EQ(depths.size(), 59u * 64u);
  EXPECT_EQ(tiles.GetReaches()[2 * 4 + 2], 6.0f);
  // New tiles, and those that have become wider, are cast.
  EXPECT_EQ(tiles.CollectTilesToCast(), (std::vector<int>{ 0, 1, 2, 3, 4, 7, 8, 11, 12, 15 }));
  for (int y = 16; y < 64; ++y)
  {
    for (int x = 16; x < 48; ++x)
    {
      const std::size_t at = static_cast<std::size_t>(y * 59 + x);
      ASSERT_EQ(depths[at], color(x - 16, y - 16, 7));
      ASSERT_EQ(firstVisible[at], depths[at]);
      ASSERT_EQ(colors[4 * at + 2], color(x - 16, y - 16, 2));
    }
  }
  // And back to a part of it.
  tiles.Continue(glm::ivec2(16, 32), glm::ivec2(2, 1), colors, depths);
  EXPECT_TRUE(tiles.CollectTilesToCast().empty());
  EXPECT_EQ(tiles.GetReaches()[0], std::numeric_limits<float>::infinity());
  EXPECT_EQ(colors[0], color(16, 0, 0));
  EXPECT_EQ(depths[16], color(16, 1, 7));
}
