// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketCaster.h"

#include "FFDSimdTargets.h"
#include "FFDTileCasters.h"

#include <algorithm>
#include <cmath>
#include <memory>

// The packet kernels are compiled once for every instruction set of FFDSimdTargets.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "Packets/FFDPacketCaster.cxx"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "FFDSimdPullBack-inl.h"
#include "FFDSimdSegmentTrees-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Sets the side of roots: tiles share them where interpolants over several tiles are close enough
/// around most of five points. `quarter`: of the edges of the deformed bounds of the whole.
void ChooseRootSide(const glm::dvec3& quarter, PacketScene& scene)
{
  constexpr int Points = 5;
  constexpr double Corners[Points][3] = { { 0.0, 0.0, 0.0 }, { -1.0, -1.0, -1.0 },
    { 1.0, 1.0, -1.0 }, { 1.0, -1.0, 1.0 }, { -1.0, 1.0, 1.0 } };
  const CameraView& camera = scene.Source->Camera;
  const CameraView::PixelRows rows = camera.GetPixelRows();
  const double length = scene.SamplesPerRoot * scene.Settings.SampleDistance;
  const auto scratch = std::make_unique<PacketScratch>();
  scene.RootSide = SharedRootSide;
  int seen = 0;
  int close = 0;
  for (const double* corner : Corners)
  {
    const glm::dvec3 p = scene.Center + quarter * glm::dvec3(corner[0], corner[1], corner[2]);
    const glm::dvec4 point(p, 1.0);
    const double w = glm::dot(rows.W, point);
    const glm::dvec2 at = glm::dvec2(glm::dot(rows.X, point), glm::dot(rows.Y, point)) / w;
    const ViewRay ray = camera.MakeRay(at.x, at.y);
    const double t = ray.FindNearestT(p);
    // Behind the camera, or farther aside than any picture is wide.
    if (!(w > 0.0 && t >= 0.0 && t < ray.Far && std::max(std::abs(at.x), std::abs(at.y)) < 1e5))
    {
      continue;
    }
    // The same in all parts of an image.
    const glm::dvec2 origin(camera.PixelOrigin);
    const glm::ivec2 first(glm::floor(at + origin) - 0.5 * scene.RootSide - origin);
    SegmentTrees trees(scene, *scratch, first.x, first.y);
    ++seen;
    const double inRoots = (t - camera.FindMiddleT(ray, scene.Center)) / length;
    close += trees.IsRootClose(static_cast<int>(std::floor(inRoots))) ? 1 : 0;
  }
  scene.RootSide = 2 * close > seen ? SharedRootSide : TileSide;
}

void MoveSeeds(PacketScene& scene)
{
  const Df d;
  const std::size_t count = scene.Seeds.size();
  for (std::size_t first = 0; first < count; first += hn::Lanes(d))
  {
    HWY_ALIGN float p[3][16];
    const auto at = [&](std::size_t lane) -> PacketSeed& {
      return scene.Seeds[std::min(first + lane, count - 1)];
    };
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      for (int a = 0; a < 3; ++a)
      {
        p[a][lane] = at(lane).Point[a];
      }
    }
    const Vec3 point{ hn::Load(d, p[0]), hn::Load(d, p[1]), hn::Load(d, p[2]) };
    const NewtonStep step = FindNewtonStep(scene.Field, point, point);
    const Vec3 image = Add(point, step.Residual);
    HWY_ALIGN float inverse[9][16];
    for (int column = 0; column < 3; ++column)
    {
      const auto unit = [&](int a) { return Splat(a == column ? 1.0f : 0.0f); };
      const Vec3 moved = step.Apply({ unit(0), unit(1), unit(2) });
      hn::Store(moved.x, d, inverse[column]);
      hn::Store(moved.y, d, inverse[3 + column]);
      hn::Store(moved.z, d, inverse[6 + column]);
    }
    HWY_ALIGN float inverseDeterminants[16];
    hn::Store(step.Inverse, d, inverseDeterminants);
    hn::Store(image.x, d, p[0]);
    hn::Store(image.y, d, p[1]);
    hn::Store(image.z, d, p[2]);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      PacketSeed& seed = at(lane);
      seed.Determinant = 1.0f / inverseDeterminants[lane];
      for (int a = 0; a < 3; ++a)
      {
        seed.Image[a] = p[a][lane];
      }
      for (int i = 0; i < 9; ++i)
      {
        seed.Inverse[i] = inverse[i][lane];
      }
    }
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <glm/geometric.hpp>

namespace ffd
{
namespace
{

HWY_EXPORT(ChooseRootSide);
HWY_EXPORT(MoveSeeds);

/// Whether the voxels of a mask can be looked up, if there is one: by the number of a row through
/// all slices.
bool CanLookUpMask(const VolumeView& v)
{
  return !v.Scalars ||
    (v.Increments[0] == 1 && v.Increments[2] == v.Increments[1] * v.Dimensions.y &&
      static_cast<double>(v.Dimensions.y) * v.Dimensions.z <= LargestReach);
}

TileCaster* FindTileCaster(FetchedScalars scalars)
{
  switch (scalars)
  {
    case FetchedScalars::Bytes:
      return CastByteTile;
    case FetchedScalars::Shorts:
      return CastShortTile;
    case FetchedScalars::Words:
      return CastWordTile;
    case FetchedScalars::Floats:
      return CastFloatTile;
    default:
      return CastDoubleTile;
  }
}

} // namespace

//------------------------------------------------------------------------------
bool PacketCaster::Supports(const CastScene& scene, const CastSettings& settings)
{
  const SampleClassifier& classifier = *scene.Classifier;
  const OpticalFunctions& functions = classifier.GetFunctions();
  const int components = scene.Volume.Components;
  return !settings.Reference && settings.Segments == Segmentation::ErrorBound &&
    CanFetchPackets(scene.Volume) && CanLookUpMask(classifier.GetMask().Volume) &&
    components <= SampleClassifier::LargestNumberOfComponents &&
    (functions.Kind != ComponentKind::Independent ||
      static_cast<int>(functions.Components.size()) == components);
}

//------------------------------------------------------------------------------
PacketCaster::PacketCaster(const CastScene& scene, const CastSettings& settings,
  const IntegrationFrame& frame, const ParallelFor& parallelFor)
  : Scene(MakePacketScene(scene, settings, frame))
{
  PacketScene& p = this->Scene;
  // Neither needs the other. The first takes longer; whoever is done with the second joins in.
  RunBoth(
    parallelFor, [&] { SetSeen(parallelFor, p); },
    [&] {
      FillTable(p);
      SetPullBack(p);
      if (p.Identity)
      {
        return;
      }
      if (InvertsTheField(p.Kind))
      {
        HWY_DYNAMIC_DISPATCH(MoveSeeds)(p);
        KeepSeeds(p);
        if (!p.Folds)
        {
          p.Field.AllowLongSteps();
        }
      }
      const Box& whole = GetWholeDeformed(scene);
      HWY_DYNAMIC_DISPATCH(ChooseRootSide)(0.25 * (whole.Max - whole.Min), p);
    });
  SetSpace(p);
}

//------------------------------------------------------------------------------
bool PacketCaster::IsTileEmpty(int x0, int y0) const
{
  const TileBounds::Limits* const seen = this->Scene.Seen.Find(x0, y0);
  return seen && seen->IsEmpty() && !this->Scene.Settings.CountsRays;
}

//------------------------------------------------------------------------------
int PacketCaster::RenderTile(int x0, int y0, unsigned int subtiles, const CastImage& image,
  PacketScratch& scratch, int first, Deadline deadline) const
{
  TileCaster* const cast = FindTileCaster(FindFetchedScalars(this->Scene.Volume));
  return cast(this->Scene, x0, y0, subtiles, image, scratch, first, deadline);
}

} // namespace ffd

#endif
