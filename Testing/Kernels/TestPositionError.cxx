// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// ERROR_BOUND never exceeds its tolerance where it says so: random lattices, cameras and voxels, all
// inverse modes, along the rays and between the nodes of a tile.
#include "PositionError.h"
#include "RandomLattice.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <cmath>

using namespace ffd;

namespace
{

/// FIRST_ORDER, EXACT, PULL_BACK, and FIRST_ORDER of a transform that is given inverted.
constexpr PullBackKind Kinds[] = { PullBackKind::FirstOrder, PullBackKind::Exact,
  PullBackKind::Forward, PullBackKind::FirstOrderOfInverse };

glm::dmat3 RandomRotation(RandomLattice& random)
{
  const glm::dvec3 x = glm::normalize(random.Vector(-1.0, 1.0) + glm::dvec3(1e-3));
  const glm::dvec3 z = glm::normalize(glm::cross(x, random.Vector(-1.0, 1.0)));
  return { x, glm::cross(z, x), z };
}

/// A lattice, a volume in it, and a camera that looks at it.
struct Scene
{
  Scene(RandomLattice& random, const BSplineField& field, PullBackKind kind)
    : Map(&field, kind, 1e-11)
  {
    const glm::dvec3 size = field.GetSpacing() * glm::dvec3(field.GetNodes() - 1);
    glm::dmat3 linear = RandomRotation(random);
    for (int a = 0; a < 3; ++a)
    {
      linear[a] *= random.Number(0.5, 2.0);
    }
    glm::dmat4 dataToWorld(linear);
    dataToWorld[3] = glm::dvec4(random.Vector(-10.0, 10.0), 1.0);
    this->WorldToData = glm::inverse(dataToWorld);
    const double radius = glm::length(linear * size);
    const glm::dvec3 target(dataToWorld * glm::dvec4(random.Point(field, 0.0), 1.0));
    const glm::dvec3 eye =
      target + glm::normalize(random.Vector(-1.0, 1.0) + 1e-3) * radius * random.Number(0.2, 3.0);
    const bool parallel = random.Integer(0, 3) == 0;
    const glm::dmat4 projection = parallel
      ? glm::ortho(-radius, radius, -radius, radius, 0.01 * radius, 5.0 * radius)
      : glm::perspective(random.Number(0.3, 2.2), 1.0, 0.01 * radius, 5.0 * radius);
    const glm::dvec3 up = glm::normalize(random.Vector(-1.0, 1.0) + 1e-3);
    this->Camera.WorldToNdc = projection * glm::lookAt(eye, target, up);
    this->Camera.NdcToWorld = glm::inverse(this->Camera.WorldToNdc);
    this->Pixels = 32 << random.Integer(0, 4);
    this->Camera.ImageSize = glm::ivec2(this->Pixels);
    this->Camera.NdcPerPixel = glm::dvec2(2.0 / this->Pixels);
    this->Length = 3.0 * radius;

    glm::dmat3 indexToData = RandomRotation(random);
    for (int a = 0; a < 3; ++a)
    {
      // From some twenty to some two hundred voxels along the lattice.
      indexToData[a] *= radius * random.Number(0.005, 0.02);
    }
    this->DataToIndex = glm::inverse(indexToData);
    this->Voxel = std::min({ glm::length(linear * indexToData[0]),
      glm::length(linear * indexToData[1]), glm::length(linear * indexToData[2]) });
    const PullBackBounds mapBounds(this->Map);
    const Box region{ field.GetOrigin() - 3.0 * size, field.GetOrigin() + 4.0 * size };
    this->Bounds = DeformedSpaceBounds(this->Map, mapBounds, region, region, 0.1 * size.x);
  }

  PullBack Map;
  DeformedSpaceBounds Bounds;
  CameraView Camera;
  glm::dmat4 WorldToData{ 1.0 };
  glm::dmat3 DataToIndex{ 1.0 };
  double Voxel = 1.0; // world units
  double Length = 0.0;
  int Pixels = 0;
};

struct Claims
{
  int Lattices = 0;
  positionError::Tally Errors;
  double WorstShare = 0.0; // largest error in tolerances
};

void CheckLattice(RandomLattice& random, const BSplineField& field, PullBackKind kind,
  double tolerance, Claims& claims)
{
  const Scene scene(random, field, kind);
  SpanSettings settings;
  settings.Length = 8.0 * scene.Voxel;
  settings.LargestLevel = 4;
  settings.PositionTolerance = tolerance;
  ++claims.Lattices;
  for (int run = 0; run < 6; ++run)
  {
    const positionError::Tile tile(scene.Camera, random.Integer(0, scene.Pixels / 16 - 1) * 16,
      random.Integer(0, scene.Pixels / 16 - 1) * 16, scene.WorldToData, scene.Map,
      scene.DataToIndex);
    TileSpans spans;
    tile.Start(spans, scene.Bounds, settings, 0.0, scene.Length);
    for (int s = 0; s < 8; ++s)
    {
      const int index = static_cast<int>(random.Number(0.0, scene.Length) / settings.Length);
      const TileSpans::Span span = spans.Get(index);
      // Only at the minimum length may a piece be worse than it was asked to be, or where nothing is
      // proven.
      ASSERT_TRUE(span.PositionError <= tolerance || span.Level == settings.LargestLevel ||
        (std::isinf(span.PositionError) && span.Level == settings.UnprovenLevel));
      positionError::Tally errors;
      tile.MeasureSpan(spans, settings, index, random.Integer(0, (1 << span.Level) - 1),
        random.Integer(0, 15), random.Integer(0, 15), 16, errors);
      ASSERT_LE(errors.Largest, tolerance + 1e-7)
        << "kind " << static_cast<int>(kind) << ", border "
        << static_cast<int>(field.GetBorder()) << ", lateral " << span.Lateral << ", level "
        << span.Level;
      // Not only the tolerance: the bound itself.
      if (span.Bounded && !span.Lateral)
      {
        ASSERT_LE(std::max(errors.Largest, errors.LargestUnproven), span.PositionError + 1e-7)
          << "kind " << static_cast<int>(kind) << ", lateral " << span.Lateral;
      }
      claims.Errors.Pieces += errors.Pieces;
      claims.Errors.Proven += errors.Proven;
      claims.Errors.Lateral += errors.Lateral;
      claims.Errors.InQuarters += errors.InQuarters;
      claims.WorstShare = std::max(claims.WorstShare, errors.Largest / tolerance);
    }
  }
}

/// Displacements that follow sines: the usual, smooth case.
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

TEST(PositionError, ErrorBoundKeepsItsToleranceOnSmoothLattices)
{
  RandomLattice random(11);
  Claims claims;
  for (int run = 0; run < 400 && !HasFatalFailure(); ++run)
  {
    const BSplineField field = SmoothField(random, random.Number(0.0, 0.6));
    CheckLattice(random, field, Kinds[run % 4], std::pow(10.0, random.Number(-2.0, 0.0)), claims);
  }
  EXPECT_EQ(claims.Lattices, 400);
  // The claims are of use: most is proven, and not by far too much.
  EXPECT_GT(claims.Errors.Proven, claims.Errors.Pieces / 2);
  EXPECT_GT(claims.Errors.Lateral, claims.Errors.Pieces / 10);
  EXPECT_GT(claims.Errors.InQuarters, claims.Errors.Pieces / 50);
  EXPECT_GT(claims.WorstShare, 0.1);
}

TEST(PositionError, ErrorBoundKeepsItsToleranceOnRandomLattices)
{
  RandomLattice random(12);
  Claims claims;
  for (int run = 0; run < 600 && !HasFatalFailure(); ++run)
  {
    // From tame to badly folded, all border modes.
    const BSplineField field =
      random.Field(std::pow(10.0, random.Number(-2.0, 0.0)), AllBorders[run % 3]);
    CheckLattice(
      random, field, Kinds[run / 3 % 4], std::pow(10.0, random.Number(-2.0, 0.0)), claims);
  }
  EXPECT_EQ(claims.Lattices, 600);
  EXPECT_GT(claims.Errors.Proven, claims.Errors.Pieces / 4);
  EXPECT_LT(claims.Errors.Proven, claims.Errors.Pieces);
  EXPECT_GT(claims.WorstShare, 0.1);
}

// The measure itself: on a circle the middle of a chord of angle a is r (1 - cos(a / 2)) off.
TEST(PositionError, OfAPolylineShrinksWithTheSquareOfTheSegments)
{
  RandomLattice random(13);
  const BSplineField field = SmoothField(random, 0.4);
  const Scene scene(random, field, PullBackKind::FirstOrder);
  const positionError::Tile tile(scene.Camera, scene.Pixels / 2, scene.Pixels / 2,
    scene.WorldToData, scene.Map, scene.DataToIndex);
  double last = 0.0;
  for (const double length : { 1.0, 0.5, 0.25, 0.125 })
  {
    PolylineSettings settings;
    settings.MinimumLength = length * scene.Voxel;
    settings.MaximumLength = length * scene.Voxel;
    positionError::Tally tally;
    tile.MeasurePolyline(settings, 7.0, 7.0, 0.0, scene.Length, 16, tally);
    EXPECT_NEAR(tally.Length, scene.Length, 1e-9 * scene.Length);
    EXPECT_GT(tally.Largest, 0.0);
    EXPECT_LE(tally.LargestSideways, tally.Largest);
    EXPECT_LE(tally.Mean(), tally.Largest);
    if (last > 0.0)
    {
      EXPECT_NEAR(last / tally.Largest, 4.0, 0.5);
    }
    last = tally.Largest;
  }
}

// A smaller angle gives a smaller error and more segments, and the error is what the turn allows:
// a chord of length l whose ends turn by a is about l a / 8 off its arc.
TEST(PositionError, OfGreedyAngleFollowsTheAngle)
{
  RandomLattice random(14);
  int compared = 0;
  for (int run = 0; run < 40; ++run)
  {
    const BSplineField field = SmoothField(random, random.Number(0.2, 0.5));
    const Scene scene(random, field, Kinds[run % 4]);
    const positionError::Tile tile(scene.Camera, scene.Pixels / 2, scene.Pixels / 2,
      scene.WorldToData, scene.Map, scene.DataToIndex);
    positionError::Tally coarse;
    positionError::Tally fine;
    PolylineSettings settings;
    settings.MinimumLength = 0.1 * scene.Voxel;
    settings.MaximumLength = 16.0 * scene.Voxel;
    settings.AngleThreshold = 0.2;
    tile.MeasurePolyline(settings, 7.0, 7.0, 0.0, scene.Length, 16, coarse);
    settings.AngleThreshold = 0.02;
    tile.MeasurePolyline(settings, 7.0, 7.0, 0.0, scene.Length, 16, fine);
    EXPECT_GE(fine.Pieces, coarse.Pieces);
    if (coarse.Pieces > 10)
    {
      ++compared;
      EXPECT_LT(fine.Mean(), coarse.Mean());
    }
  }
  EXPECT_GT(compared, 20);
}
