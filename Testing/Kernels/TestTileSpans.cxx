// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What TileSpans claims are proofs: no ray of the tile may ever break them.
#include "FFDTileSpans.h"

#include "FFDCurvePiece.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace ffd;

namespace
{

constexpr PullBackKind Kinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

glm::dmat3 RandomRotation(RandomLattice& random)
{
  const glm::dvec3 x = glm::normalize(random.Vector(-1.0, 1.0) + glm::dvec3(1e-3));
  const glm::dvec3 z = glm::normalize(glm::cross(x, random.Vector(-1.0, 1.0)));
  return { x, glm::cross(z, x), z };
}

/// A 16 x 16 tile of a camera that looks at a lattice, perspective or parallel.
struct Tile
{
  Tile(RandomLattice& random, const BSplineField& field)
  {
    const glm::dvec3 size = field.GetSpacing() * glm::dvec3(field.GetNodes() - 1);
    // The volume's matrix: rotation, anisotropic scale, translation.
    glm::dmat3 linear = RandomRotation(random);
    for (int a = 0; a < 3; ++a)
    {
      linear[a] *= random.Number(0.5, 2.0);
    }
    this->DataToWorld = glm::dmat4(linear);
    this->DataToWorld[3] = glm::dvec4(random.Vector(-10.0, 10.0), 1.0);
    this->WorldToData = glm::inverse(this->DataToWorld);
    const double radius = glm::length(linear * size);
    const glm::dvec3 target =
      glm::dvec3(this->DataToWorld * glm::dvec4(random.Point(field, 0.0), 1.0));
    const glm::dvec3 eye =
      target + glm::normalize(random.Vector(-1.0, 1.0) + 1e-3) * radius * random.Number(0.3, 3.0);
    const bool parallel = random.Integer(0, 3) == 0;
    const glm::dmat4 projection = parallel
      ? glm::ortho(-radius, radius, -radius, radius, 0.01 * radius, 5.0 * radius)
      : glm::perspective(random.Number(0.3, 1.9), 1.0, 0.01 * radius, 5.0 * radius);
    const glm::dvec3 up = glm::normalize(random.Vector(-1.0, 1.0) + 1e-3);
    this->Camera.WorldToNdc = projection * glm::lookAt(eye, target, up);
    this->Camera.NdcToWorld = glm::inverse(this->Camera.WorldToNdc);
    const int pixels = random.Integer(0, 2) ? 256 : 48;
    this->Camera.ImageSize = glm::ivec2(pixels);
    this->Camera.NdcPerPixel = glm::dvec2(2.0 / pixels);
    this->X = random.Integer(0, pixels / 16 - 1) * 16;
    this->Y = random.Integer(0, pixels / 16 - 1) * 16;
    this->Length = 3.0 * radius;
  }

  void Ray(double x, double y, glm::dvec3& origin, glm::dvec3& direction) const
  {
    const ViewRay ray = this->Camera.MakeRay(this->X + x + 0.5, this->Y + y + 0.5);
    origin = glm::dvec3(this->WorldToData * glm::dvec4(ray.Origin, 1.0));
    direction = glm::dvec3(this->WorldToData * glm::dvec4(ray.Direction, 0.0));
  }

  CameraView Camera;
  glm::dmat4 DataToWorld;
  glm::dmat4 WorldToData;
  int X = 0;
  int Y = 0;
  double Length = 0.0;
};

void Start(TileSpans& spans, const Tile& tile, const DeformedSpaceBounds& bounds,
  const SpanSettings& settings, const glm::dmat3& dataToIndex)
{
  glm::dvec3 origins[4];
  glm::dvec3 directions[4];
  for (int c = 0; c < 4; ++c)
  {
    tile.Ray(c & 1 ? 15.0 : 0.0, c & 2 ? 15.0 : 0.0, origins[c], directions[c]);
  }
  spans.Start(bounds, settings, dataToIndex, origins, directions, 0.0, tile.Length);
}

struct Tally
{
  int Bounded = 0;
  int Unbounded = 0;
  int Pieces = 0;
  double WorstShare = 0.0; // of the bound that is used up
  double WorstRadius = 0.0;
};

/// Compare random pieces of random rays with the true curve.
void CheckLattice(RandomLattice& random, const BSplineField& field, PullBackKind kind, Tally& tally)
{
  const PullBack map(&field, kind, 1e-11);
  const PullBackBounds mapBounds(map);
  const Box region{ field.GetOrigin() - 40.0,
    field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes()) + 40.0 };
  const DeformedSpaceBounds bounds(map, mapBounds, region, region, 0.5);
  const Tile tile(random, field);
  // Voxels: a rotated, anisotropic direction matrix.
  glm::dmat3 indexToData = RandomRotation(random);
  for (int a = 0; a < 3; ++a)
  {
    indexToData[a] *= random.Number(0.02, 0.2);
  }
  const glm::dmat3 dataToIndex = glm::inverse(indexToData);
  SpanSettings settings;
  settings.Length = random.Number(0.1, 2.0);
  settings.LargestLevel = random.Integer(0, 6);
  settings.PositionTolerance = std::pow(10.0, random.Number(-3.0, 0.0));
  TileSpans spans;
  Start(spans, tile, bounds, settings, dataToIndex);

  for (int s = 0; s < 24; ++s)
  {
    glm::dvec3 origin;
    glm::dvec3 direction;
    const int x = random.Integer(0, 15);
    const int y = random.Integer(0, 15);
    tile.Ray(x, y, origin, direction);
    // The nearest of the 4 x 4 nodes.
    glm::dvec3 nodeOrigin;
    glm::dvec3 nodeDirection;
    tile.Ray(5.0 * std::round(x / 5.0), 5.0 * std::round(y / 5.0), nodeOrigin, nodeDirection);
    const auto curve = [&](double t) {
      PullBackStatus status;
      return dataToIndex * map.Evaluate(origin + t * direction, status);
    };
    const int index = static_cast<int>(random.Number(0.0, tile.Length) / settings.Length);
    const TileSpans::Span& span = spans.Get(index);
    ASSERT_GE(span.Level, 0);
    ASSERT_LE(span.Level, settings.LargestLevel);
    // Only the shortest pieces may be worse than they should be, and those of which nothing is known.
    if (span.Level < settings.LargestLevel && std::isfinite(span.PositionError))
    {
      ASSERT_LE(span.PositionError, settings.PositionTolerance);
    }
    if (!span.Bounded)
    {
      ++tally.Unbounded;
      continue;
    }
    ++tally.Bounded;
    const double dt = settings.Length / (1 << span.Level);
    const double t0 = index * settings.Length + random.Integer(0, (1 << span.Level) - 1) * dt;
    const CurvePiece piece = CurvePiece::Parabola(curve(t0), curve(t0 + 0.5 * dt), curve(t0 + dt));
    ++tally.Pieces;
    glm::dvec3 last = curve(t0);
    for (int i = 1; i <= 24; ++i)
    {
      const double u = i / 24.0;
      const glm::dvec3 q = curve(t0 + u * dt);
      const double error = glm::length(q - piece.At(u));
      ASSERT_LE(error, span.PositionError + 1e-7)
        << "kind " << static_cast<int>(kind) << ", border " << static_cast<int>(field.GetBorder());
      if (span.PositionError > 1e-6)
      {
        tally.WorstShare = std::max(tally.WorstShare, error / span.PositionError);
      }
      PullBackStatus status;
      const glm::dvec3 node =
        dataToIndex * map.Evaluate(nodeOrigin + (t0 + u * dt) * nodeDirection, status);
      for (int a = 0; a < 3; ++a)
      {
        ASSERT_LE(std::abs(q[a] - node[a]), span.NodeRadius[a] + 1e-6)
          << "kind " << static_cast<int>(kind);
        tally.WorstRadius =
          std::max(tally.WorstRadius, std::abs(q[a] - node[a]) / (span.NodeRadius[a] + 1e-9));
      }
      const glm::dvec3 velocity = (q - last) / (dt / 24.0);
      for (int a = 0; a < 3; ++a)
      {
        const double slack = 1e-6 + 1e-7 * std::abs(velocity[a]) / dt;
        ASSERT_GE(velocity[a], span.VelocityMin[a] - slack)
          << "kind " << static_cast<int>(kind) << ", border "
          << static_cast<int>(field.GetBorder());
        ASSERT_LE(velocity[a], span.VelocityMax[a] + slack)
          << "kind " << static_cast<int>(kind) << ", border "
          << static_cast<int>(field.GetBorder());
      }
      last = q;
    }
  }
}

/// Displacements that follow a sine: the usual, smooth case.
BSplineField SmoothField(RandomLattice& random, double amount)
{
  const glm::ivec3 nodes(random.Integer(5, 10), random.Integer(5, 10), random.Integer(5, 10));
  const glm::dvec3 wave = random.Vector(0.1, 0.8);
  const glm::dvec3 phase = random.Vector(0.0, 6.0);
  std::vector<glm::dvec3> displacements;
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      for (int i = 0; i < nodes.x; ++i)
      {
        const glm::dvec3 p = wave * glm::dvec3(j, k, i) + phase;
        displacements.push_back(amount * glm::dvec3(std::sin(p.x), std::sin(p.y), std::sin(p.z)));
      }
    }
  }
  return BSplineField(
    nodes, random.Vector(-5.0, 5.0), random.Vector(0.8, 1.5), displacements.data());
}

} // namespace

TEST(TileSpans, IdentityAndAffineMapsNeedNoHalving)
{
  RandomLattice random(1);
  // A linear displacement is affine inside of the lattice's outermost cells.
  const glm::ivec3 nodes(20);
  std::vector<glm::dvec3> displacements;
  for (int n = 0; n < 8000; ++n)
  {
    const glm::dvec3 p(n % 20, n / 20 % 20, n / 400);
    displacements.push_back(glm::dvec3(0.2 * p.x - 0.1 * p.y, 0.3 * p.z, 0.1 * p.x + 0.2 * p.y));
  }
  const BSplineField affine(nodes, glm::dvec3(-10.0), glm::dvec3(1.0), displacements.data());
  const BSplineField zero(nodes, glm::dvec3(-10.0), glm::dvec3(1.0),
    std::vector<glm::dvec3>(8000, glm::dvec3(0.0)).data());
  for (const BSplineField* field : { &affine, &zero })
  {
    const PullBack map(field, PullBackKind::FirstOrder, 1e-9);
    const PullBackBounds mapBounds(map);
    const Box region{ glm::dvec3(-3.0), glm::dvec3(3.0) };
    const DeformedSpaceBounds bounds(map, mapBounds, region, region, 0.5);
    SpanSettings settings;
    settings.Length = 0.2;
    settings.PositionTolerance = 1e-3;
    settings.LargestLevel = 10;
    const glm::dvec3 origins[4] = { { -0.9, 0.0, 0.0 }, { -0.9, 0.1, 0.0 }, { -0.9, 0.0, 0.1 },
      { -0.9, 0.1, 0.1 } };
    const glm::dvec3 directions[4] = { { 1.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 },
      { 1.0, 0.0, 0.0 } };
    TileSpans spans;
    spans.Start(bounds, settings, glm::dmat3(10.0), origins, directions, 0.0, 2.0);
    for (int i = 0; i < 10; ++i)
    {
      const TileSpans::Span& span = spans.Get(i);
      EXPECT_TRUE(span.Bounded);
      EXPECT_EQ(span.Level, 0);
      const glm::dmat3 jacobian = field == &zero
        ? glm::dmat3(1.0)
        : glm::dmat3(0.8, 0.0, -0.1, 0.1, 1.0, -0.2, 0.0, -0.3, 1.0);
      const glm::dvec3 velocity = 10.0 * jacobian[0];
      for (int a = 0; a < 3; ++a)
      {
        // The bounds keep 8 bits.
        EXPECT_NEAR(span.VelocityMin[a], velocity[a], 0.05);
        EXPECT_NEAR(span.VelocityMax[a], velocity[a], 0.05);
      }
    }
  }
}

TEST(TileSpans, BoundsHoldForSmoothLattices)
{
  RandomLattice random(2);
  Tally tally;
  for (int run = 0; run < 600 && !HasFatalFailure(); ++run)
  {
    const BSplineField field = SmoothField(random, random.Number(0.0, 0.6));
    CheckLattice(random, field, Kinds[run % 4], tally);
  }
  EXPECT_GT(tally.Bounded, 3000);
  EXPECT_GT(tally.WorstShare, 0.02); // the bound is of use
  EXPECT_GT(tally.WorstRadius, 0.5);
}

TEST(TileSpans, BoundsHoldForRandomLattices)
{
  RandomLattice random(3);
  Tally tally;
  for (int run = 0; run < 800 && !HasFatalFailure(); ++run)
  {
    // From tame to badly folded, all border modes.
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.0, 0.0)), AllBorders[run % 3]);
    CheckLattice(random, field, Kinds[run / 3 % 4], tally);
  }
  EXPECT_GT(tally.Bounded, 3000);
  EXPECT_GT(tally.Unbounded, 300);
}

TEST(TileSpans, NothingIsProvenInFolds)
{
  RandomLattice random(4);
  // T(x) = x - 3 sin-like bump: folded in the middle.
  const glm::ivec3 nodes(9);
  std::vector<glm::dvec3> displacements(729, glm::dvec3(0.0));
  displacements[4 + 9 * (4 + 9 * 4)] = glm::dvec3(8.0, 0.0, 0.0);
  const BSplineField field(nodes, glm::dvec3(0.0), glm::dvec3(1.0), displacements.data());
  const PullBack map(&field, PullBackKind::Exact, 1e-9);
  const PullBackBounds mapBounds(map);
  ASSERT_FALSE(mapBounds.IsProvenInvertible());
  const Box region{ glm::dvec3(-4.0), glm::dvec3(12.0) };
  const DeformedSpaceBounds bounds(map, mapBounds, region, region, 0.5);
  SpanSettings settings;
  settings.Length = 1.0;
  settings.LargestLevel = 3;
  glm::dvec3 origins[4];
  glm::dvec3 directions[4];
  std::fill_n(origins, 4, glm::dvec3(-2.0, 4.0, 4.0));
  std::fill_n(directions, 4, glm::dvec3(1.0, 0.0, 0.0));
  TileSpans spans;
  spans.Start(bounds, settings, glm::dmat3(1.0), origins, directions, 0.0, 12.0);
  EXPECT_FALSE(spans.Get(6).Bounded);
  // The shortest pieces would not be better than these.
  EXPECT_EQ(spans.Get(6).Level, settings.UnprovenLevel);
  settings.UnprovenLevel = 1;
  spans.Start(bounds, settings, glm::dmat3(1.0), origins, directions, 0.0, 12.0);
  EXPECT_EQ(spans.Get(6).Level, 1);
}
