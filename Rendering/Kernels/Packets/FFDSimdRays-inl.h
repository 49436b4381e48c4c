// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Viewing rays of packets. Included once per target of Highway.
#if defined(FFD_SIMD_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_RAYS_INL_H_
#undef FFD_SIMD_RAYS_INL_H_
#else
#define FFD_SIMD_RAYS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDSamplePhase.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// A packet of viewing rays, local coordinates: P(t) = Origin + t * Direction, t in data units.
/// Origin is where PacketRays begins to count t.
struct RayPacket
{
  Vec3 Origin;
  Vec3 Direction;
  Vf From;
  Vf To;
};

/// An affine function at image positions.
HWY_INLINE Vf Evaluate(const PacketRays& image, const PacketRays::Affine& of, Vf x, Vf y)
{
  return hn::MulAdd(Splat(of[1]), hn::Add(x, Splat(image.Column)),
    hn::MulAdd(Splat(of[2]), hn::Add(y, Splat(image.Row)), Splat(of[0])));
}

HWY_INLINE Vec3 Evaluate(const PacketRays& image, const PacketRays::Affine (&of)[3], Vf x, Vf y)
{
  return { Evaluate(image, of[0], x, y), Evaluate(image, of[1], x, y),
    Evaluate(image, of[2], x, y) };
}

/// What lies between the point of a ray that is nearest to the local origin and where t is zero.
/// `direction`, `moment`: of unit length, and with that.
HWY_INLINE Vf FindShift(const PacketRays& image, const Vec3& direction, const Vec3& moment)
{
  const Vf distance = Splat(image.EyeDistance);
  const Vf along = Dot(Broadcast(image.Eye), direction);
  // CameraView::FindMiddleT()
  const Vf behind = hn::Div(Dot(moment, moment), hn::Max(hn::Sub(distance, along), Splat(1e-30f)));
  return hn::IfThenElse(hn::Gt(along, hn::Zero(Df())), hn::Add(distance, along), behind);
}

/// Finds Origin and Direction of rays through image positions, which takes less than to store and
/// read them. `inverseLength`: of PacketRays::Direction there.
HWY_INLINE void FindLines(const PacketRays& image, Vf x, Vf y, Vf inverseLength, RayPacket& rays)
{
  rays.Direction = Scale(inverseLength, Evaluate(image, image.Direction, x, y));
  const Vec3 moment = Scale(inverseLength, Evaluate(image, image.Moment, x, y));
  rays.Origin =
    MulAdd(FindShift(image, rays.Direction, moment), rays.Direction, Cross(rays.Direction, moment));
}

/// Finds t of rays at a plane.
HWY_INLINE Vf TimeAtPlane(const float plane[4], const RayPacket& rays)
{
  const Vec3 normal = Broadcast(plane);
  return hn::Neg(
    hn::Div(hn::Add(Dot(normal, rays.Origin), Splat(plane[3])), Dot(normal, rays.Direction)));
}

/// Rays through image positions, near plane to far plane. `inverseLength`: as FindLines().
HWY_INLINE RayPacket MakeRays(const PacketRays& image, Vf x, Vf y, Vf& inverseLength)
{
  const Vec3 direction = Evaluate(image, image.Direction, x, y);
  inverseLength = hn::Div(Splat(1.0f), hn::Sqrt(Dot(direction, direction)));
  RayPacket rays;
  FindLines(image, x, y, inverseLength, rays);
  rays.From = TimeAtPlane(image.NearPlane, rays);
  rays.To = TimeAtPlane(image.FarPlane, rays);
  return rays;
}

/**
 * Window depths along rays. What is linear along a ray is so in homogeneous coordinates, too; so
 * the depth at the part s of the way from the near to the far plane is s / (s + (1 - s) k), with k
 * the quotient of the last coordinates at the far and at the near plane. No term is negative:
 * little is lost to rounding.
 */
struct WindowDepths
{
  Vf Near;   ///< t at the near plane
  Vf Length; ///< from plane to plane
  Vf Ratio;  ///< k

  /// Of the rays through image positions.
  WindowDepths(const PacketRays& image, const RayPacket& rays, Vf x, Vf y)
    : Near(TimeAtPlane(image.NearPlane, rays))
    , Length(hn::Sub(TimeAtPlane(image.FarPlane, rays), this->Near))
    , Ratio(hn::Div(Evaluate(image, image.FarW, x, y), Evaluate(image, image.NearW, x, y)))
  {
  }

  HWY_INLINE Vf ToT(Vf depth) const
  {
    const Vf beyond = hn::Mul(depth, this->Ratio);
    return hn::MulAdd(
      this->Length, hn::Div(beyond, hn::Add(beyond, hn::Sub(Splat(1.0f), depth))), this->Near);
  }

  HWY_INLINE Vf ToDepth(Vf t) const
  {
    const Vf way = hn::Sub(t, this->Near);
    const Vf rest = hn::Mul(hn::Sub(this->Length, way), this->Ratio);
    return hn::Div(way, hn::Add(way, rest));
  }
};

/**
 * The derivatives of P(t) by pixels: Spread(t) * AcrossX from column to column, at right angles to
 * the ray, likewise from row to row. This is exact for all projective cameras, whose rays meet in
 * the eye or are parallel.
 */
struct RaySpread
{
  Vec3 AcrossX;
  Vec3 AcrossY;
  Vf Base; ///< of Spread()
  Vf PerT;

  /// Finds the spread of the rays through image positions.
  RaySpread(const PacketRays& image, const RayPacket& rays, Vf x, Vf y)
  {
    const Vec3& direction = rays.Direction;
    const Vf inverseLength =
      hn::Div(Splat(1.0f), Dot(Evaluate(image, image.Direction, x, y), direction));
    // Spread() is one where t is zero, or at the near plane behind that: not in the eye, where it
    // is zero.
    const Vf middle = hn::Max(TimeAtPlane(image.NearPlane, rays), hn::Zero(Df()));
    // With D = d / |d| the change of D is that of d at right angles to D, over |d|. That of the
    // point nearest to the local origin, D x m / |d|, is across the ray D x m' less what the length
    // of d changes by.
    const Vf along = Dot(rays.Origin, direction);
    const Vec3 nearest = Sub(rays.Origin, Scale(along, direction));
    const auto find = [&](int coefficient, Vec3& across) {
      const auto take = [&](const PacketRays::Affine(&of)[3]) {
        return Scale(inverseLength,
          { Splat(of[0][coefficient]), Splat(of[1][coefficient]), Splat(of[2][coefficient]) });
      };
      const Vec3 byPixel = take(image.Direction);
      const Vf stretch = Dot(byPixel, direction);
      const Vec3 turn = Sub(byPixel, Scale(stretch, direction));
      across = MulAdd(hn::Add(middle, along), turn,
        Sub(Cross(direction, take(image.Moment)), Scale(stretch, nearest)));
      return turn;
    };
    const Vec3 turn = find(1, this->AcrossX);
    find(2, this->AcrossY);
    this->PerT = hn::Div(Dot(turn, this->AcrossX), Dot(this->AcrossX, this->AcrossX));
    this->Base = hn::NegMulAdd(middle, this->PerT, Splat(1.0f));
  }

  HWY_INLINE Vf Spread(Vf t) const { return hn::MulAdd(t, this->PerT, this->Base); }
};

/// Narrows [From, To] to the deformed bounds and the shown side of the clipping planes. `seen`, if
/// not null: a box that is not empty; [seenFrom, seenTo] is where the rays are in it.
HWY_INLINE void ClipToBounds(const PacketScene& scene, const TileBounds::Limits* seen,
  RayPacket& rays, Vf& seenFrom, Vf& seenTo)
{
  for (const std::array<float, 4>& plane : scene.ClippingPlanes)
  {
    const Vec3 normal{ Splat(plane[0]), Splat(plane[1]), Splat(plane[2]) };
    const Vf slope = Dot(normal, rays.Direction);
    const Vf start = hn::Add(Dot(normal, rays.Origin), Splat(plane[3]));
    const Vf zero = hn::Zero(Df());
    const Vf tiny = Splat(1e-30f);
    // A slope of zero becomes a very small one: then the plane cuts all of the ray away or nothing.
    const Mf up = hn::Ge(slope, zero);
    const Vf safe = hn::IfThenElse(up, hn::Max(slope, tiny), hn::Min(slope, hn::Neg(tiny)));
    const Vf t = hn::Neg(hn::Div(start, safe));
    rays.From = hn::IfThenElse(up, hn::Max(rays.From, t), rays.From);
    rays.To = hn::IfThenElse(up, rays.To, hn::Min(rays.To, t));
  }
  seenFrom = Splat(-1e30f);
  seenTo = Splat(1e30f);
  const auto clip = [&](Vf o, Vf v, int axis) {
    // A direction of zero becomes a very small one: then the slab bounds all of the line or none.
    const Vf tiny = Splat(1e-30f);
    const Vf safe = hn::IfThenElse(hn::Lt(hn::Abs(v), tiny), tiny, v);
    const Vf inverse = Reciprocal(safe);
    const auto cut = [&](float lo, float hi, Vf& from, Vf& to) {
      const Vf a = hn::Mul(hn::Sub(Splat(lo), o), inverse);
      const Vf b = hn::Mul(hn::Sub(Splat(hi), o), inverse);
      from = hn::Max(from, hn::Min(a, b));
      to = hn::Min(to, hn::Max(a, b));
    };
    cut(scene.BoundsMin[axis], scene.BoundsMax[axis], rays.From, rays.To);
    if (seen)
    {
      cut(seen->Min[axis], seen->Max[axis], seenFrom, seenTo);
    }
  };
  clip(rays.Origin.x, rays.Direction.x, 0);
  clip(rays.Origin.y, rays.Direction.y, 1);
  clip(rays.Origin.z, rays.Direction.z, 2);
}

/// Takes local coordinates to index coordinates of the whole that the volume is a part of. Segments
/// are kept in these, so that the same samples are taken whatever the part is.
HWY_INLINE Vec3 LocalToWhole(const PacketScene& scene, const Vec3& local)
{
  return Add(Transform(scene.LocalToIndex, local), Broadcast(scene.IndexOffset));
}

/// FindPhase() of the rays of a packet. `near`: t at the near plane.
HWY_INLINE Vf PhaseOf(const PacketScene& scene, const RayPacket& rays, Vf near, Vf jitter)
{
  const Vf zero = hn::Zero(Df());
  Vf enter = Splat(-1e30f);
  Vf exit = Splat(1e30f);
  Vf enterSlope = zero;
  Vf exitSlope = zero;
  const auto cross = [&](Vf o, Vf v, int a) {
    const Vf slope = hn::Max(hn::Abs(v), Splat(static_cast<float>(LeastSlope)));
    const Vf inverse = hn::CopySign(Reciprocal(slope), v);
    const Vf t0 = hn::Mul(hn::Sub(Splat(scene.RestMin[a]), o), inverse);
    const Vf t1 = hn::Mul(hn::Sub(Splat(scene.RestMax[a]), o), inverse);
    const Vf first = hn::Min(t0, t1);
    const Vf last = hn::Max(t0, t1);
    enterSlope = hn::IfThenElse(hn::Gt(first, enter), slope, enterSlope);
    enter = hn::Max(enter, first);
    exitSlope = hn::IfThenElse(hn::Lt(last, exit), slope, exitSlope);
    exit = hn::Min(exit, last);
  };
  const Vec3 origin = LocalToWhole(scene, rays.Origin);
  const Vec3 direction = Transform(scene.LocalToIndex, rays.Direction);
  cross(origin.x, direction.x, 0);
  cross(origin.y, direction.y, 1);
  cross(origin.z, direction.z, 2);
  const Mf past = hn::And(hn::Gt(enter, exit), hn::Gt(exitSlope, enterSlope));
  const Vf t = hn::Max(hn::IfThenElse(past, exit, enter), near);
  const Vf x = hn::MulAdd(t, Splat(static_cast<float>(1.0 / scene.Settings.SampleDistance)),
    hn::Sub(jitter, Splat(static_cast<float>(PhaseGuard))));
  return hn::Sub(x, hn::Floor(x));
}

/// Takes index coordinates of the whole to local ones.
HWY_INLINE Vec3 WholeToLocal(const PacketScene& scene, const Vec3& whole)
{
  return Transform(scene.IndexToLocal, Sub(whole, Broadcast(scene.IndexOffset)));
}

/// Takes index coordinates of the whole to those of the voxels here, and back: numbers of voxels
/// are subtracted and added, which is exact.
HWY_INLINE Vec3 WholeToIndex(const PacketScene& scene, const Vec3& whole)
{
  return Sub(whole, Broadcast(scene.IndexShift));
}
HWY_INLINE Vec3 IndexToWhole(const PacketScene& scene, const Vec3& index)
{
  return Add(index, Broadcast(scene.IndexShift));
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
