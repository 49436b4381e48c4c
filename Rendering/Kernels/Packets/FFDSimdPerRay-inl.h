// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rays of packets that are integrated one by one. Included once per target of Highway.
#if defined(FFD_SIMD_PER_RAY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PER_RAY_INL_H_
#undef FFD_SIMD_PER_RAY_INL_H_
#else
#define FFD_SIMD_PER_RAY_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"
#include "Reference/FFDRayIntegrator.h"
#include "Reference/FFDSegmentSampler.h"

#include "FFDSimdCurve-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdNormals-inl.h"
#include "FFDSimdRays-inl.h"

#include <algorithm>
#include <cstddef>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Hands the samples of a packet to the RayIntegrator of each ray.
class LaneIntegrators
{
public:
  /// Keeps references.
  LaneIntegrators(const PacketScene& scene, PacketScratch& scratch, const RayPacket& rays,
    PacketState& state, PacketNormals& normals)
    : Scene(scene)
    , Integrators(scratch.Integrators)
    , Statistics(scratch.Statistics)
    , Rays(rays)
    , State(state)
    , Normals(normals)
  {
  }

  /// Begins the packet whose first pixel is (x0, y0), `width` pixels wide, before its samples.
  HWY_NOINLINE void Begin(int x0, int y0, int width)
  {
    const Df d;
    HWY_ALIGN float from[16], to[16];
    hn::Store(this->Rays.From, d, from);
    hn::Store(this->Rays.To, d, to);
    this->Integrators.resize(hn::MaxLanes(Df()));
    for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane)
    {
      this->Integrators[static_cast<std::size_t>(lane)].Begin(*this->Scene.Frame,
        this->Scene.Source->Camera.MakeRay(x0 + lane % width + 0.5, y0 + lane / width + 0.5),
        static_cast<double>(from[lane]), static_cast<double>(to[lane]));
    }
  }

  /// Hands a sample of each lane to the RayIntegrator of its ray.
  HWY_NOINLINE void Take(const PacketCurve& curve, Vf s, Mf sampled)
  {
    const Df d;
    HWY_ALIGN float at[16], interval[16], t0[16], dt[16], flag[16];
    HWY_ALIGN float terms[3 * TileLayers][16];
    hn::Store(s, d, at);
    hn::Store(curve.PerStep, d, interval);
    hn::Store(curve.T0, d, t0);
    hn::Store(curve.Dt, d, dt);
    hn::Store(hn::IfThenElseZero(sampled, Splat(1.0f)), d, flag);
    for (int k = 0; k < TileLayers; ++k)
    {
      hn::Store(curve.Position.Terms[k].x, d, terms[3 * k]);
      hn::Store(curve.Position.Terms[k].y, d, terms[3 * k + 1]);
      hn::Store(curve.Position.Terms[k].z, d, terms[3 * k + 2]);
    }
    HWY_ALIGN float done[16] = {};
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      if (flag[lane] == 0.0f)
      {
        continue;
      }
      CurveSegment segment;
      for (int k = 0; k < TileLayers; ++k)
      {
        segment.Terms[k] =
          glm::dvec3(terms[3 * k][lane], terms[3 * k + 1][lane], terms[3 * k + 2][lane]);
      }
      for (int a = 0; a < 3; ++a)
      {
        segment.Terms[0][a] -= this->Scene.IndexShift[a];
      }
      const LaneSegment one(this->Normals, curve, lane, segment, static_cast<double>(t0[lane]),
        static_cast<double>(dt[lane]));
      const RayIntegrator::Outcome outcome = this->Integrators[lane].AddSample(
        one, static_cast<double>(at[lane]), static_cast<double>(interval[lane]));
      this->Statistics.VisibleSamples += outcome.Visible ? 1 : 0;
      done[lane] = outcome.Done ? 1.0f : 0.0f;
    }
    this->State.Alive = hn::AndNot(hn::Gt(hn::Load(d, done), hn::Zero(d)), this->State.Alive);
  }

  /// Finds the pixels of the rays, after their last samples.
  HWY_NOINLINE void End()
  {
    const Df d;
    HWY_ALIGN float r[16], g[16], b[16], transmittance[16], t[16];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      const RayIntegrator::Result result = this->Integrators[lane].End();
      r[lane] = result.Color.r;
      g[lane] = result.Color.g;
      b[lane] = result.Color.b;
      transmittance[lane] = result.Transmittance;
      t[lane] = static_cast<float>(std::min(result.FirstVisible, 1e30));
    }
    this->State.Out.Color = { hn::Load(d, r), hn::Load(d, g), hn::Load(d, b) };
    this->State.Out.Transmittance = hn::Load(d, transmittance);
    this->State.Out.FirstVisible = hn::Load(d, t);
  }

private:
  /// The segment of one ray of the packet, as its RayIntegrator takes it.
  class LaneSegment : public SampledSegment
  {
  public:
    LaneSegment(PacketNormals& normals, const PacketCurve& curve, std::size_t lane,
      const CurveSegment& segment, double t0, double dt)
      : SampledSegment(segment, t0, dt)
      , Normals(normals)
      , OfAll(curve)
      , Lane(lane)
    {
    }

    glm::dvec3 GradientToDeformed(double s, const glm::dvec3& byIndex) const override
    {
      return this->Normals.GradientOfRay(this->OfAll, this->Lane, static_cast<float>(s), byIndex);
    }

  private:
    PacketNormals& Normals;
    const PacketCurve& OfAll;
    std::size_t Lane;
  };

  const PacketScene& Scene;
  std::vector<RayIntegrator>& Integrators; ///< of the lanes
  CastStatistics& Statistics;
  const RayPacket& Rays;
  PacketState& State;
  PacketNormals& Normals;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
