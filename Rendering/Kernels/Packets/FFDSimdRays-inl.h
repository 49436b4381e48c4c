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
struct RayPacket
{
  Vec3 Origin;
  Vec3 Direction;
  Vf From;
  Vf To;
};

/// Maps image positions to local coordinates at one depth: an affine map to homogeneous
/// coordinates. With most cameras the last homogeneous coordinate is the same everywhere.
struct ImageMap
{
  float Base[4]; // of the whole image
  float PerX[4];
  float PerY[4];
  float Column; // of image position (0, 0) in the whole image
  float Row;
  bool Affine; ///< whether the last coordinate is one everywhere
  float Last;  ///< if so, what all coordinates were divided by

  ImageMap(const glm::dmat4& ndcToLocal, const CameraView& camera, double ndcDepth)
    : Column(static_cast<float>(camera.PixelOrigin.x))
    , Row(static_cast<float>(camera.PixelOrigin.y))
  {
    glm::dvec4 base =
      ndcToLocal * glm::dvec4(camera.NdcOrigin.x, camera.NdcOrigin.y, ndcDepth, 1.0);
    glm::dvec4 perX = ndcToLocal[0] * camera.NdcPerPixel.x;
    glm::dvec4 perY = ndcToLocal[1] * camera.NdcPerPixel.y;
    // Matrices and their inverses leave rounding errors, over an image of some thousand pixels.
    const double rounding = 1e-13 * std::abs(base.w);
    this->Affine = std::max(std::abs(perX.w), std::abs(perY.w)) <= rounding;
    this->Last = static_cast<float>(base.w);
    if (this->Affine)
    {
      const double scale = 1.0 / base.w;
      base = glm::dvec4(scale * glm::dvec3(base), 1.0);
      perX = glm::dvec4(scale * glm::dvec3(perX), 0.0);
      perY = glm::dvec4(scale * glm::dvec3(perY), 0.0);
    }
    for (int c = 0; c < 4; ++c)
    {
      this->Base[c] = static_cast<float>(base[c]);
      this->PerX[c] = static_cast<float>(perX[c]);
      this->PerY[c] = static_cast<float>(perY[c]);
    }
  }

  HWY_INLINE Vec3 At(Vf x, Vf y) const
  {
    const Vec3 at{ this->Coordinate(0, x, y), this->Coordinate(1, x, y),
      this->Coordinate(2, x, y) };
    return HWY_LIKELY(this->Affine) ? at : Scale(this->InverseW(x, y), at);
  }

  /// The last homogeneous coordinate, by which At() divides.
  HWY_INLINE Vf LastAt(Vf x, Vf y) const
  {
    return this->Affine ? Splat(this->Last) : this->Coordinate(3, x, y);
  }

  /// At() and its derivatives by x and y.
  HWY_INLINE Vec3 At(Vf x, Vf y, Vec3& byX, Vec3& byY) const
  {
    const Vec3 at = this->At(x, y);
    byX = Broadcast(this->PerX);
    byY = Broadcast(this->PerY);
    if (HWY_UNLIKELY(!this->Affine))
    {
      const Vf inverse = this->InverseW(x, y);
      byX = Scale(inverse, Sub(byX, Scale(Splat(this->PerX[3]), at)));
      byY = Scale(inverse, Sub(byY, Scale(Splat(this->PerY[3]), at)));
    }
    return at;
  }

private:
  HWY_INLINE Vf Coordinate(int c, Vf x, Vf y) const
  {
    return hn::MulAdd(Splat(this->PerX[c]), hn::Add(x, Splat(this->Column)),
      hn::MulAdd(Splat(this->PerY[c]), hn::Add(y, Splat(this->Row)), Splat(this->Base[c])));
  }

  HWY_INLINE Vf InverseW(Vf x, Vf y) const
  {
    return hn::Div(Splat(1.0f), this->Coordinate(3, x, y));
  }
};

/// Rays through image positions, near plane to far plane. `inverseLength`: 1 / To.
HWY_INLINE RayPacket MakeRays(
  const ImageMap& near, const ImageMap& far, Vf x, Vf y, Vf& inverseLength)
{
  RayPacket rays;
  rays.Origin = near.At(x, y);
  const Vec3 path = Sub(far.At(x, y), rays.Origin);
  rays.From = hn::Zero(Df());
  rays.To = hn::Sqrt(Dot(path, path));
  inverseLength = hn::Div(Splat(1.0f), rays.To);
  rays.Direction = Scale(inverseLength, path);
  return rays;
}

/// Origin and Direction of MakeRays() again, which take less than to store and read them.
HWY_INLINE void FindLines(
  const ImageMap& near, const ImageMap& far, Vf x, Vf y, Vf inverseLength, RayPacket& rays)
{
  rays.Origin = near.At(x, y);
  rays.Direction = Scale(inverseLength, Sub(far.At(x, y), rays.Origin));
}

/**
 * Window depths along rays from the near to the far plane. What is linear along a ray is so in
 * homogeneous coordinates, too; so the depth at the part s of its length is s / (s + (1 - s) k),
 * with k the quotient of the last coordinates, ImageMap::LastAt(), at the far and at the near
 * plane. No term is negative: little is lost to rounding.
 */
struct WindowDepths
{
  Vf Length; ///< of the rays, from plane to plane
  Vf Ratio;  ///< k

  /// Of the rays through image positions.
  WindowDepths(const ImageMap& near, const ImageMap& far, Vf length, Vf x, Vf y)
    : Length(length)
    , Ratio(hn::Div(far.LastAt(x, y), near.LastAt(x, y)))
  {
  }

  HWY_INLINE Vf ToT(Vf depth) const
  {
    const Vf beyond = hn::Mul(depth, this->Ratio);
    return hn::Mul(this->Length, hn::Div(beyond, hn::Add(beyond, hn::Sub(Splat(1.0f), depth))));
  }

  HWY_INLINE Vf ToDepth(Vf t) const
  {
    const Vf rest = hn::Mul(hn::Sub(this->Length, t), this->Ratio);
    return hn::Div(t, hn::Add(t, rest));
  }
};

/**
 * The derivatives of P(t) by pixels: AlongX * D + Spread(t) * AcrossX from column to column, D
 * being the direction of the ray, likewise from row to row. AcrossX and AcrossY are at right angles
 * to D. This is exact for all projective cameras, whose rays meet in the eye or are parallel.
 */
struct RaySpread
{
  Vf AlongX;
  Vf AlongY;
  Vec3 AcrossX;
  Vec3 AcrossY;
  Vf Base; ///< of Spread()
  Vf PerT;

  /// Finds the spread of the rays through image positions.
  RaySpread(const ImageMap& near, const ImageMap& far, const RayPacket& rays, Vf x, Vf y)
  {
    Vec3 nearX, nearY, farX, farY;
    const Vec3 begin = near.At(x, y, nearX, nearY);
    const Vec3 path = Sub(far.At(x, y, farX, farY), begin);
    const Vec3& direction = rays.Direction;
    const Vf inverseLength = hn::Div(Splat(1.0f), Dot(path, direction));
    // Spread() is one where a ray is nearest to the middle of the whole, which is the origin.
    const Vf middle = hn::Max(hn::Neg(Dot(rays.Origin, direction)), hn::Zero(Df()));
    const Vf part = hn::Mul(middle, inverseLength);
    const auto across = [&](const Vec3& v) { return Sub(v, Scale(Dot(v, direction), direction)); };
    this->AlongX = Dot(nearX, direction);
    this->AlongY = Dot(nearY, direction);
    this->AcrossX = across(MulAdd(part, Sub(farX, nearX), nearX));
    this->AcrossY = across(MulAdd(part, Sub(farY, nearY), nearY));
    const Vec3 growth = Scale(inverseLength, Sub(farX, nearX));
    this->PerT = hn::Div(Dot(growth, this->AcrossX), Dot(this->AcrossX, this->AcrossX));
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

/// FindPhase() of the rays of a packet.
HWY_INLINE Vf PhaseOf(const PacketScene& scene, const RayPacket& rays, Vf jitter)
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
    const Vf near = hn::Min(t0, t1);
    const Vf far = hn::Max(t0, t1);
    enterSlope = hn::IfThenElse(hn::Gt(near, enter), slope, enterSlope);
    enter = hn::Max(enter, near);
    exitSlope = hn::IfThenElse(hn::Lt(far, exit), slope, exitSlope);
    exit = hn::Min(exit, far);
  };
  const Vec3 origin = LocalToWhole(scene, rays.Origin);
  const Vec3 direction = Transform(scene.LocalToIndex, rays.Direction);
  cross(origin.x, direction.x, 0);
  cross(origin.y, direction.y, 1);
  cross(origin.z, direction.z, 2);
  const Mf past = hn::And(hn::Gt(enter, exit), hn::Gt(exitSlope, enterSlope));
  const Vf t = hn::Max(hn::IfThenElse(past, exit, enter), zero);
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
