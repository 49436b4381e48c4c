// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Leaps of single rays of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_RAY_LEAPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_RAY_LEAPS_INL_H_
#undef FFD_SIMD_RAY_LEAPS_INL_H_
#else
#define FFD_SIMD_RAY_LEAPS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTileSegment.h"

#include "FFDSimdCurve-inl.h"
#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Leaps of the rays of a packet within a segment, each for itself, over samples of which the empty
/// cube around one of them tells that they show nothing.
class RayLeaps
{
public:
  RayLeaps(const PacketScene& scene, CastStatistics& statistics)
    : Scene(scene)
    , Statistics(statistics)
  {
  }

  /// Before the first sample of a curve.
  void Begin(const PacketCurve& curve)
  {
    const Vf scale =
      hn::Mul(Splat(static_cast<float>(FewSamples)), hn::Mul(curve.PerStep, curve.PerStep));
    this->MoveChanges = Scale(scale, FindLargestCurvature(curve.Position));
  }

  /// Finds how many samples of the segment, from those of the lanes of `querying` at q, index
  /// coordinates, which is s of a curve, are empty for certain; 0 for other lanes.
  HWY_NOINLINE Vf CountEmpty(const PacketCurve& curve, const Vec3& q, Vf s, Mf querying)
  {
    const Df d;
    if (hn::AllFalse(d, querying))
    {
      return hn::Zero(d);
    }
    const TileSegment& segment = *curve.Segment;
    float radius[3];
    for (int a = 0; a < 3; ++a)
    {
      // An interval that ends at a sample is empty if its beginning lies in the cube, too.
      radius[a] = LeapGuard +
        (this->Scene.ClassifiesIntervals ? std::max(segment.Up[a], segment.Down[a]) : 0.0f);
    }
    // Two bounds of the way: that of the rays of all of the tile over all of the segment, and that
    // of each ray over the next samples.
    const EmptyCubes cubes(this->Scene, q);
    const StepsPerUnit ofTile(segment.Up, segment.Down);
    const StepsPerUnit ofRays(Scale(curve.PerStep, curve.Position.Slope(s)), this->MoveChanges);
    const auto count = [&](const StepsPerUnit& steps) {
      return hn::Max(
        cubes.CountSteps(radius, steps), cubes.CountStepsBeside(this->Scene, radius, steps));
    };
    const Vf steps =
      hn::Max(count(ofTile), hn::Min(count(ofRays), Splat(static_cast<float>(FewSamples))));
    // An interval is empty only if its end lies in the cube, too.
    const Vf samples = this->Scene.Intervals ? steps : hn::Add(steps, Splat(1.0f));
    const Mf empty = hn::And(querying, hn::Gt(samples, hn::Zero(d)));
    this->Statistics.DistanceLookups +=
      static_cast<std::int64_t>(hn::CountTrue(d, hn::And(empty, IsInside(this->Scene, q))));
    return hn::IfThenElseZero(empty, samples);
  }

private:
  /// Samples over which single rays are bounded by themselves.
  static constexpr int FewSamples = 8;
  /// Kept between a leap and the faces of an empty cube, index units: rounding errors.
  static constexpr float LeapGuard = 2e-3f;

  const PacketScene& Scene;
  CastStatistics& Statistics;
  Vec3 MoveChanges; ///< bounds for few samples
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
