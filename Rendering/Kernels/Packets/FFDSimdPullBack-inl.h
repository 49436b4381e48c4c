// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Evaluates the pull-back and its Jacobian, a point a lane. Included once per target of Highway.
#if defined(FFD_SIMD_PULL_BACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PULL_BACK_INL_H_
#undef FFD_SIMD_PULL_BACK_INL_H_
#else
#define FFD_SIMD_PULL_BACK_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSpline-inl.h"

#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Finds the seed of each lane whose image is nearest to p.
HWY_INLINE Vi FindNearestSeeds(const PacketScene& scene, const Vec3& p)
{
  const Df d;
  const Di di;
  // Lanes mostly are neighbors: few seeds are about as near to the first lane as the nearest one,
  // and the nearest to any lane is among those that are farther by at most twice the way to it.
  const Vec3 first{ Splat(hn::GetLane(p.x)), Splat(hn::GetLane(p.y)), Splat(hn::GetLane(p.z)) };
  const Vec3 apart = Sub(p, first);
  HWY_ALIGN float squares[PacketScene::LargestNumberOfSeeds];
  Vf least = Splat(1e37f);
  for (std::size_t i = 0; i < PacketScene::LargestNumberOfSeeds; i += hn::Lanes(d))
  {
    const Vec3 image{ hn::LoadU(d, scene.SeedImages[0].data() + i),
      hn::LoadU(d, scene.SeedImages[1].data() + i), hn::LoadU(d, scene.SeedImages[2].data() + i) };
    const Vec3 path = Sub(image, first);
    const Vf square = Dot(path, path);
    hn::Store(square, d, squares + i);
    least = hn::Min(least, square);
  }
  const float most =
    std::sqrt(SmallestLane(least)) + 2.0f * std::sqrt(LargestLane(Dot(apart, apart)));
  const float limit = 1.001f * most * most;
  least = Splat(1e37f);
  Vi nearest = hn::Zero(di);
  for (std::size_t i = 0; i < scene.Seeds.size(); ++i)
  {
    // Written so that what is not a number excludes nothing.
    if (!(squares[i] > limit))
    {
      const Vec3 path = Sub(p,
        { Splat(scene.SeedImages[0][i]), Splat(scene.SeedImages[1][i]),
          Splat(scene.SeedImages[2][i]) });
      const Vf square = Dot(path, path);
      nearest = hn::IfThenElse(
        hn::RebindMask(di, hn::Lt(square, least)), hn::Set(di, static_cast<int>(i)), nearest);
      least = hn::Min(square, least);
    }
  }
  return nearest;
}

/**
 * Brings lanes nearer to T^-1(p) that are farther from it than Newton's method may step, as where a
 * lattice has many cells from seed to seed, or is a small part of the volume: by steps as long as
 * T(q) - p, each of which counts where it brings T(q) nearer to p.
 */
HWY_NOINLINE inline Vec3 Approach(
  const PacketScene& scene, const Vec3& p, const Vec3& start, Mf lanes)
{
  constexpr int mostSteps = 4;
  const auto findResidual = [&](const Vec3& at) {
    return Add(Sub(at, p), Displacement(scene.Field, at));
  };
  Vec3 q = start;
  Vec3 residual = findResidual(q);
  for (int i = 0; i < mostSteps && !hn::AllFalse(Df(), lanes); ++i)
  {
    const Vec3 next = Sub(q, residual);
    const Vec3 left = findResidual(next);
    lanes = hn::And(lanes, hn::Lt(Dot(left, left), Dot(residual, residual)));
    q = Select(lanes, next, q);
    residual = Select(lanes, left, residual);
  }
  return q;
}

/**
 * Estimates T^-1(p) of each lane without a start: by a step of Newton's method from the nearest of
 * PacketScene::Seeds, and by Approach() from where that is too short.
 */
HWY_NOINLINE inline Vec3 FindColdStart(const PacketScene& scene, const Vec3& p)
{
  const Df d;
  const Di di;
  const Vi nearest = FindNearestSeeds(scene, p);
  HWY_ALIGN int seeds[16];
  HWY_ALIGN float point[3][16], image[3][16], inverse[9][16];
  hn::Store(nearest, di, seeds);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
  {
    const PacketSeed& seed = scene.Seeds[static_cast<std::size_t>(seeds[lane])];
    for (int a = 0; a < 3; ++a)
    {
      point[a][lane] = seed.Point[a];
      image[a][lane] = seed.Image[a];
    }
    for (int i = 0; i < 9; ++i)
    {
      inverse[i][lane] = seed.Inverse[i];
    }
  }
  const auto load = [&](const float(*rows)[16]) -> Vec3 {
    return { hn::Load(d, rows[0]), hn::Load(d, rows[1]), hn::Load(d, rows[2]) };
  };
  const Vec3 path = Sub(p, load(image));
  const Vec3 step{ Dot(path, load(inverse)), Dot(path, load(inverse + 3)),
    Dot(path, load(inverse + 6)) };
  const Vf length = hn::Sqrt(Dot(step, step));
  Vf norm = hn::Zero(d);
  for (const auto& row : inverse)
  {
    const Vf entry = hn::Load(d, row);
    norm = hn::MulAdd(entry, entry, norm);
  }
  const Vf limit =
    FindStepLimit(scene.Field, hn::Mul(hn::Sqrt(norm), Splat(scene.Field.SecondDerivative)));
  const Vec3 q =
    MulAdd(hn::Min(Splat(1.0f), hn::Div(limit, hn::Max(length, Splat(1e-30f)))), step, load(point));
  const Mf isFar = hn::Gt(length, limit);
  return HWY_LIKELY(hn::AllFalse(d, isFar)) ? q : Approach(scene, p, q, isFar);
}

/// Lanes without a pull-back, to which InvertFrom() gives a point far outside of the volume.
HWY_INLINE Mf IsNowhere(const PacketScene& scene, const Vec3& q)
{
  return hn::Gt(hn::Abs(q.x), Splat(0.1f * scene.Nowhere));
}

/**
 * Solves T(q) = p for every lane by Newton's method from `start`, local coordinates. Where T folds,
 * several rest points lead to p: those count where T does not turn space inside out. This holds
 * outside of the volume, too, or rays would follow a wrong branch past it. Lanes that find no such
 * point start again from the nearest seed; if that fails, nothing lies at p, and they get a point
 * far outside (IsNowhere()). `step`: the last step.
 */
HWY_INLINE Vec3 InvertFrom(const PacketScene& scene, const Vec3& p, const Vec3& start,
  float tolerance, Mf active, NewtonStep& step, CastStatistics& statistics)
{
  // Few steps where T folds: there many points have no solution.
  const int mostSteps = scene.Folds ? 5 : 13;
  const int mostStepsAgain = scene.Folds ? 7 : 13;
  const Df d;
  Vec3 q = start;
  int evaluations = 0;
  const auto solve = [&](Mf lanes, int steps, Vec3& at, NewtonStep& last) {
    const Mf solved =
      SolveInverse(scene.Field, p, tolerance, lanes, steps, !scene.Folds, at, last, evaluations);
    const Mf kept = hn::Gt(hn::Mul(last.Inverse, Splat(scene.Orientation)), hn::Zero(d));
    return hn::And(solved, kept);
  };
  // A start without a pull-back is no start.
  const Mf cold = IsNowhere(scene, start);
  if (HWY_UNLIKELY(!hn::AllFalse(d, cold)))
  {
    q = Select(cold, FindColdStart(scene, p), q);
  }
  Mf stuck = hn::AndNot(solve(active, mostSteps, q, step), active);
  if (HWY_UNLIKELY(!hn::AllFalse(d, stuck)))
  {
    const Mf again = hn::AndNot(cold, stuck);
    if (!hn::AllFalse(d, again))
    {
      Vec3 other = FindColdStart(scene, p);
      NewtonStep last;
      const Mf solved = solve(again, mostStepsAgain, other, last);
      q = Select(hn::And(again, solved), other, q);
      stuck = hn::AndNot(hn::And(again, solved), stuck);
    }
    const Vf outside = Splat(scene.Nowhere);
    q = Select(stuck, { outside, outside, outside }, q);
    statistics.Unconverged += static_cast<std::int64_t>(hn::CountTrue(d, stuck));
  }
  statistics.Evaluations +=
    static_cast<std::int64_t>(evaluations) * static_cast<std::int64_t>(hn::CountTrue(d, active));
  return q;
}

/// Takes T^-1(p) to Phi(p), or Phi(p) to T^-1(p), for the kinds that invert T.
HWY_INLINE Vec3 MirrorAt(const PacketScene& scene, const Vec3& p, const Vec3& q)
{
  return scene.Kind == PullBackKind::FirstOrderOfInverse ? Sub(Add(p, p), q) : q;
}

/// Evaluates Phi(p) of every lane for the kinds that do not invert T, local coordinates.
HWY_INLINE Vec3 EvaluateForward(const PacketScene& scene, const Vec3& p)
{
  const Vec3 displacement = Displacement(scene.Field, p);
  return scene.Kind == PullBackKind::FirstOrder ? Sub(p, displacement) : Add(p, displacement);
}

/**
 * Evaluates Phi(p) of every lane in `active`, local coordinates. `start`: an estimate of it.
 * `move`, if not null: on entry a change of p, on return the change of Phi(p), to first order; not
 * changed by the kinds that do not invert T.
 */
HWY_INLINE Vec3 PullBackFrom(const PacketScene& scene, const Vec3& p, const Vec3& start,
  float tolerance, Mf active, CastStatistics& statistics, Vec3* move = nullptr)
{
  if (scene.Identity)
  {
    return p;
  }
  if (InvertsTheField(scene.Kind))
  {
    NewtonStep step;
    const Vec3 q =
      InvertFrom(scene, p, MirrorAt(scene, p, start), tolerance, active, step, statistics);
    if (move)
    {
      *move = MirrorAt(scene, *move, step.Apply(*move));
    }
    return MirrorAt(scene, p, q);
  }
  statistics.Evaluations += static_cast<std::int64_t>(hn::CountTrue(Df(), active));
  return EvaluateForward(scene, p);
}

/// Estimates Phi(p) of every lane without a start.
HWY_INLINE Vec3 EstimatePullBack(const PacketScene& scene, const Vec3& p)
{
  const bool inverse = !scene.Identity && InvertsTheField(scene.Kind);
  return inverse ? MirrorAt(scene, p, FindColdStart(scene, p)) : p;
}

/// Evaluates dPhi/dP of every lane, by columns, at deformed points p whose rest points are q, local
/// coordinates.
HWY_INLINE void PullBackJacobian(
  const PacketScene& scene, const Vec3& p, const Vec3& q, Vec3& a, Vec3& b, Vec3& c)
{
  const Vf one = Splat(1.0f);
  const bool inverse = InvertsTheField(scene.Kind);
  // The kinds that invert T evaluate the field at T^-1(p).
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
    const Vf s = Reciprocal(safe);
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
