// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Where rays cross a slice. Included once per target of Highway.
#if defined(FFD_SIMD_SLICE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SLICE_INL_H_
#undef FFD_SIMD_SLICE_INL_H_
#else
#define FFD_SIMD_SLICE_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdCurve-inl.h"
#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Returns the rays of `alive` that cross the plane of the slice, and makes `curve`, if there are
/// any, the points of the volume where they do, at s = 0.
HWY_INLINE Mf FindSliceCurve(const PacketScene& scene, const RayPacket& rays, Mf alive,
  CastStatistics& statistics, PacketCurve& curve)
{
  // Tolerance at the faces of the volume and the ends of rays.
  constexpr float GuardInVoxels = 1e-3f;
  const Df d;
  const Vec3 normal = Broadcast(scene.SliceNormal);
  const Vf t = hn::Div(
    hn::Sub(Splat(scene.SliceOffset), Dot(normal, rays.Origin)), Dot(normal, rays.Direction));
  // Planes that touch the volume, or are clipping planes, are seen in spite of rounding errors.
  const Vf slack =
    hn::Max(Splat(GuardInVoxels / scene.VoxelsPerUnit), hn::Mul(hn::Abs(rays.To), Splat(1e-6f)));
  // False where the ray runs along the plane, too.
  const Mf crosses = hn::And(
    alive, hn::And(hn::Ge(t, hn::Sub(rays.From, slack)), hn::Lt(t, hn::Add(rays.To, slack))));
  if (hn::AllFalse(d, crosses))
  {
    return crosses;
  }
  const Vec3 p = MulAdd(t, rays.Direction, rays.Origin);
  const Vec3 local =
    PullBackFrom(scene, p, EstimatePullBack(scene, p), scene.Tolerance, crosses, statistics);
  const Vec3 q = WholeToIndex(scene, LocalToWhole(scene, local));
  const Vf near = hn::Mul(slack, Splat(scene.VoxelsPerUnit));
  const auto inside = [&](Vf x, int a) {
    const Vf clamped = Clamp(x, Splat(scene.Lower), Splat(scene.Upper[a]));
    return hn::IfThenElse(hn::Le(hn::Abs(hn::Sub(x, clamped)), near), clamped, x);
  };
  const Vf zero = hn::Zero(d);
  for (Vec3& term : curve.Position.Terms)
  {
    term = { zero, zero, zero };
  }
  curve.Position.Terms[0] = IndexToWhole(scene, { inside(q.x, 0), inside(q.y, 1), inside(q.z, 2) });
  curve.T0 = t;
  curve.Dt = Splat(static_cast<float>(scene.Settings.SampleDistance));
  curve.PerStep = Splat(1.0f);
  return crosses;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
