// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Pulls the samples of a packet back, one after the other. Included once per target of Highway.
#if defined(FFD_SIMD_SAMPLE_FOLLOWER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SAMPLE_FOLLOWER_INL_H_
#undef FFD_SIMD_SAMPLE_FOLLOWER_INL_H_
#else
#define FFD_SIMD_SAMPLE_FOLLOWER_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The lanes whose points are in marked cells; local coordinates.
HWY_INLINE Mf IsMarked(const SpaceCells& cells, const Vec3& p)
{
  const Df d;
  constexpr auto last = static_cast<float>(SpaceCells::Cells - 1);
  Mf within = hn::FirstN(d, hn::Lanes(d));
  HWY_ALIGN int index[3][16];
  const auto find = [&](Vf x, int a) {
    const Vf cell =
      hn::Floor(hn::Mul(hn::Sub(x, Splat(cells.GetLow(a))), Splat(cells.GetCellsPerLength(a))));
    const Vf known = Clamp(cell, hn::Zero(d), Splat(last));
    within = hn::And(within, hn::Eq(cell, known));
    StoreIndices(Truncate(known), index[a]);
  };
  find(p.x, 0);
  find(p.y, 1);
  find(p.z, 2);
  HWY_ALIGN float marked[16];
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
  {
    marked[lane] = cells.IsMarked(index[0][lane], index[1][lane], index[2][lane]) ? 1.0f : 0.0f;
  }
  return hn::And(within, hn::Gt(hn::Load(d, marked), hn::Zero(d)));
}

/**
 * Follows T^-1 along the rays of a packet, from sample to sample. Where the volume cannot be, rays
 * have no pull-back (IsNowhere()); behind such a gap they start anew.
 */
class SampleFollower
{
public:
  /// Keeps references to all but the phase of the samples.
  SampleFollower(
    const PacketScene& scene, const RayPacket& rays, Vf phase, CastStatistics& statistics)
    : Scene(scene)
    , Rays(rays)
    , Phase(phase)
    , Statistics(statistics)
    , Cells(scene.WholeSpace ? &scene.WholeSpace->Get() : nullptr)
    , InGap(hn::FirstN(Df(), 0))
  {
  }

  /// t of the sample n.
  HWY_INLINE Vf TimeOf(int n) const
  {
    return hn::Mul(hn::Add(this->Phase, Splat(static_cast<float>(n))),
      Splat(static_cast<float>(this->Scene.Settings.SampleDistance)));
  }

  /// The rest points of the sample n, index coordinates of the whole; n is one more from call to
  /// call. `start`: estimates of them. `alive`: other rays keep these.
  HWY_INLINE Vec3 Find(int n, const Vec3& start, Mf alive)
  {
    const Vec3 p = MulAdd(this->TimeOf(n), this->Rays.Direction, this->Rays.Origin);
    if (!this->Cells)
    {
      return this->PullBack(n, p, start, alive, hn::FirstN(Df(), 0));
    }
    const Mf inGap = hn::Not(IsMarked(*this->Cells, p));
    const Mf entering = hn::AndNot(inGap, this->InGap);
    this->InGap = inGap;
    const Vec3 q = this->PullBack(n, p, start, hn::AndNot(inGap, alive), entering);
    const Vf far = Splat(this->Scene.Nowhere);
    return Select(inGap, LocalToWhole(this->Scene, { far, far, far }), q);
  }

private:
  /// Samples between two searches for a pull-back in the volume along a ray that has none.
  static constexpr int SamplesOfNothing = 4;

  /// `entering`: lanes that come out of a gap.
  HWY_INLINE Vec3 PullBack(int n, const Vec3& p, const Vec3& start, Mf active, Mf entering)
  {
    const Vec3 local = WholeToLocal(this->Scene, start);
    const bool searches = n % SamplesOfNothing == 0;
    if (!searches)
    {
      // A position without a pull-back is likely to be followed by another one.
      active = hn::And(active, hn::Or(entering, hn::Not(IsNowhere(this->Scene, local))));
    }
    if (hn::AllFalse(Df(), active))
    {
      return start;
    }
    const Vec3 q = LocalToWhole(this->Scene,
      PullBackFrom(this->Scene, p, local, this->Scene.Tolerance, active, this->Statistics));
    return Select(active, searches ? this->PreferVolume(p, q, active) : q, start);
  }

  /// Where T folds, a rest point in the volume counts before the one beside it, q, that was
  /// followed along the ray. p: the deformed points.
  HWY_INLINE Vec3 PreferVolume(const Vec3& p, const Vec3& q, Mf active)
  {
    const Df d;
    if (!this->Scene.Folds)
    {
      return q;
    }
    const auto isInVolume = [this](const Vec3& at) {
      const auto within = [this](Vf x, int a) {
        return hn::And(
          hn::Ge(x, Splat(this->Scene.RestMin[a])), hn::Le(x, Splat(this->Scene.RestMax[a])));
      };
      return hn::And(within(at.x, 0), hn::And(within(at.y, 1), within(at.z, 2)));
    };
    const Mf nowhere = IsNowhere(this->Scene, WholeToLocal(this->Scene, q));
    const Mf beside = hn::AndNot(hn::Or(nowhere, isInVolume(q)), active);
    if (hn::AllFalse(d, beside))
    {
      return q;
    }
    const Vf far = Splat(this->Scene.Nowhere);
    const Vec3 other = LocalToWhole(this->Scene,
      PullBackFrom(
        this->Scene, p, { far, far, far }, this->Scene.Tolerance, beside, this->Statistics));
    return Select(hn::And(beside, isInVolume(other)), other, q);
  }

  const PacketScene& Scene;
  const RayPacket& Rays;
  Vf Phase;
  CastStatistics& Statistics;
  const SpaceCells* Cells; ///< of PacketScene::WholeSpace, or null
  Mf InGap;                ///< where the sample before was
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
