// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The pull-back and its Jacobian, a point a lane. Included once per target of Highway.
#if defined(FFD_SIMD_PULL_BACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PULL_BACK_INL_H_
#undef FFD_SIMD_PULL_BACK_INL_H_
#else
#define FFD_SIMD_PULL_BACK_INL_H_
#endif

#include "FFDPacketCaster.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSpline-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// A point of rest space for each lane whose image under T is about p: the nearest of
/// PacketScene::Seeds.
HWY_NOINLINE Vec3 FindColdStart(const PacketScene& scene, const Vec3& p)
{
  Vf least = Splat(1e37f);
  Vec3 start = p;
  for (const PacketSeed& seed : scene.Seeds)
  {
    const Vec3 path = Sub(p, Broadcast(seed.Image));
    const Vf distance = Dot(path, path);
    const Mf closer = hn::Lt(distance, least);
    least = hn::Min(distance, least);
    start = Select(closer, Broadcast(seed.Point), start);
  }
  return start;
}

/**
 * T^-1 of every lane by Newton's method from `start`, local coordinates. Lanes that it does not
 * solve start again from the nearest seed; where that does not help, T folds or nearly so, and they
 * take the point of first order.
 */
HWY_INLINE Vec3 InvertFrom(
  const PacketScene& scene, const Vec3& p, const Vec3& start, Mf active, CastStatistics& statistics)
{
  const Df d;
  Vec3 q = start;
  int evaluations = 0;
  Mf stuck =
    hn::AndNot(SolveInverse(scene.Field, p, scene.Tolerance, active, q, evaluations), active);
  if (HWY_UNLIKELY(!hn::AllFalse(d, stuck)))
  {
    Vec3 again = FindColdStart(scene, p);
    const Mf solved = SolveInverse(scene.Field, p, scene.Tolerance, stuck, again, evaluations);
    q = Select(hn::And(stuck, solved), again, q);
    stuck = hn::AndNot(solved, stuck);
    if (!hn::AllFalse(d, stuck))
    {
      q = Select(stuck, Sub(p, Displacement(scene.Field, p)), q);
      statistics.Unconverged += static_cast<std::int64_t>(hn::CountTrue(d, stuck));
    }
  }
  statistics.Evaluations +=
    static_cast<std::int64_t>(evaluations) * static_cast<std::int64_t>(hn::CountTrue(d, active));
  return q;
}

/// What T^-1(p) makes of p, or the other way round.
HWY_INLINE Vec3 MirrorAt(const PacketScene& scene, const Vec3& p, const Vec3& q)
{
  return scene.Kind == PullBackKind::FirstOrderOfInverse ? Sub(Add(p, p), q) : q;
}

/// Phi of every lane in `active`, local coordinates. `start`: about where it leads to.
HWY_INLINE Vec3 PullBackFrom(
  const PacketScene& scene, const Vec3& p, const Vec3& start, Mf active, CastStatistics& statistics)
{
  if (scene.Identity)
  {
    return p;
  }
  if (InvertsTheField(scene.Kind))
  {
    return MirrorAt(scene, p, InvertFrom(scene, p, MirrorAt(scene, p, start), active, statistics));
  }
  statistics.Evaluations += static_cast<std::int64_t>(hn::CountTrue(Df(), active));
  const Vec3 displacement = Displacement(scene.Field, p);
  return scene.Kind == PullBackKind::FirstOrder ? Sub(p, displacement) : Add(p, displacement);
}

/// The same from nowhere.
HWY_INLINE Vec3 PullBackLanes(
  const PacketScene& scene, const Vec3& p, Mf active, CastStatistics& statistics)
{
  const bool inverse = !scene.Identity && InvertsTheField(scene.Kind);
  const Vec3 start = inverse ? MirrorAt(scene, p, FindColdStart(scene, p)) : p;
  return PullBackFrom(scene, p, start, active, statistics);
}

/// About how far q is from Phi(p): for the kinds that invert T, by a step of Newton's method.
HWY_INLINE Vec3 FindPullBackError(
  const PacketScene& scene, const Vec3& p, const Vec3& q, CastStatistics& statistics)
{
  if (scene.Identity)
  {
    return Sub(q, p);
  }
  if (!InvertsTheField(scene.Kind))
  {
    const Mf all = hn::FirstN(Df(), hn::Lanes(Df()));
    return Sub(PullBackFrom(scene, p, q, all, statistics), q);
  }
  statistics.Evaluations += static_cast<std::int64_t>(hn::Lanes(Df()));
  return FindNewtonStep(scene.Field, p, MirrorAt(scene, p, q));
}

/**
 * dPhi/dP of every lane at deformed points p that come from rest points q (local coordinates), by
 * columns.
 */
HWY_INLINE void PullBackJacobian(
  const PacketScene& scene, const Vec3& p, const Vec3& q, Vec3& a, Vec3& b, Vec3& c)
{
  const Vf one = Splat(1.0f);
  const bool inverse = InvertsTheField(scene.Kind);
  // Of the kinds that invert T the field lives at T^-1(p).
  const Vec3 at = inverse ? MirrorAt(scene, p, q) : p;
  Vec3 displacement;
  EvaluateField<true>(scene.Field, at, displacement, a, b, c);
  if (scene.Kind == PullBackKind::FirstOrder)
  {
    const Vf minus = Splat(-1.0f);
    a = Scale(minus, a);
    b = Scale(minus, b);
    c = Scale(minus, c);
  }
  a.x = hn::Add(a.x, one);
  b.y = hn::Add(b.y, one);
  c.z = hn::Add(c.z, one);
  if (inverse)
  {
    // Rows of the inverse are the cross products of the columns over the determinant.
    const Vec3 r0 = Cross(b, c);
    const Vec3 r1 = Cross(c, a);
    const Vec3 r2 = Cross(a, b);
    const Vf determinant = Dot(a, r0);
    const Vf safe =
      hn::IfThenElse(hn::Lt(hn::Abs(determinant), Splat(1e-12f)), Splat(1e-12f), determinant);
    const Vf s = hn::Div(one, safe);
    a = Scale(s, { r0.x, r1.x, r2.x });
    b = Scale(s, { r0.y, r1.y, r2.y });
    c = Scale(s, { r0.z, r1.z, r2.z });
    if (scene.Kind == PullBackKind::FirstOrderOfInverse)
    {
      const Vf two = Splat(2.0f);
      const Vf minus = Splat(-1.0f);
      a = Scale(minus, a);
      b = Scale(minus, b);
      c = Scale(minus, c);
      a.x = hn::Add(a.x, two);
      b.y = hn::Add(b.y, two);
      c.z = hn::Add(c.z, two);
    }
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
