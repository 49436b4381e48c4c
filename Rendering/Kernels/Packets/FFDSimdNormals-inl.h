// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Finds normals of the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_NORMALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_NORMALS_INL_H_
#undef FFD_SIMD_NORMALS_INL_H_
#else
#define FFD_SIMD_NORMALS_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdCurve-inl.h"
#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSegmentTrees-inl.h"
#include "FFDSimdShading-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Lights the samples of a packet: finds gradients in deformed space, J_Phi^T grad f.
class PacketNormals
{
public:
  /// (x, y): first pixel of the packet, from that of the roots; `rows`: rows of its pixels from y
  /// on. Keeps references to all but the numbers.
  PacketNormals(const PacketScene& scene, const SegmentTrees& trees, const RayPacket& rays, int x,
    int y, Vf rows)
    : Scene(scene)
    , Trees(trees)
    , Rays(rays)
    , X(x)
    , Y(y)
    , Rows(rows)
  {
    this->Eye.ToEye =
      Normalize(Scale(Splat(-1.0f), Transform(this->Scene.LocalToLights, rays.Direction)));
  }

  /// Begins another curve.
  HWY_INLINE void BeginCurve() { this->HaveSlopes = false; }

  /// Lights `color`. `byIndex`: grad f by index coordinates at q, the position at s of the curve.
  HWY_INLINE Vec3 Light(const PacketSurface& surface, const PacketCurve& curve, const Vec3& q,
    const Vec3& color, const Vec3& byIndex, Vf s, Vf t)
  {
    // In the space of the lights; only the direction counts.
    Vec3 gradient;
    if (this->Scene.Identity)
    {
      gradient = Transform(this->Scene.IndexGradientToLights, byIndex);
    }
    else if (curve.Interpolated && HWY_LIKELY(this->HasFrame()))
    {
      gradient = this->GradientFromFrame(curve, byIndex, s);
    }
    else
    {
      gradient =
        Transform(this->Scene.GradientToLights, this->GradientFromField(Copy(q), Copy(byIndex), t));
    }
    const auto position = [&] {
      return Transform(
        this->Scene.LocalToLights, MulAdd(t, this->Rays.Direction, this->Rays.Origin));
    };
    return Shade(this->Scene, surface, color, gradient, this->Eye, position);
  }

  /// Finds where the deformation takes steps of one voxel along each axis from q, the position at s
  /// of the curve, as if it were linear; local coordinates.
  HWY_NOINLINE void FindSteps(const PacketCurve& curve, const Vec3& q, Vf s, Vf t, Vec3 (&steps)[3])
  {
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    const Vec3 axes[3] = { { one, zero, zero }, { zero, one, zero }, { zero, zero, one } };
    // Steps in deformed space, and what they are at rest, by index coordinates.
    Vec3 deformed[3];
    Vec3 rest[3];
    if (this->Scene.Identity)
    {
      for (int a = 0; a < 3; ++a)
      {
        steps[a] = Transform(this->Scene.IndexToLocal, axes[a]);
      }
      return;
    }
    if (curve.Interpolated && this->HasFrame())
    {
      if (!this->HaveSlopes)
      {
        this->FindSlopes(curve);
      }
      const Vf spread = this->Spread(t);
      deformed[0] = Scale(spread, this->AcrossX);
      deformed[1] = Scale(spread, this->AcrossY);
      deformed[2] = this->Rays.Direction;
      rest[0] = this->SlopeX.At(s);
      rest[1] = this->SlopeY.At(s);
      rest[2] = this->SlopeT.At(s);
    }
    else
    {
      const Vec3 p = MulAdd(t, this->Rays.Direction, this->Rays.Origin);
      PullBackJacobian(this->Scene, p, WholeToLocal(this->Scene, IndexToWhole(this->Scene, q)),
        rest[0], rest[1], rest[2]);
      for (int a = 0; a < 3; ++a)
      {
        deformed[a] = axes[a];
        rest[a] = Transform(this->Scene.LocalToIndex, rest[a]);
      }
    }
    const Vec3 x = Cross(rest[1], rest[2]);
    const Vec3 y = Cross(rest[2], rest[0]);
    const Vec3 z = Cross(rest[0], rest[1]);
    const Vf inverse = hn::Div(one, Dot(rest[0], x));
    const auto step = [&](Vf ofX, Vf ofY, Vf ofZ) {
      return Scale(
        inverse, MulAdd(ofX, deformed[0], MulAdd(ofY, deformed[1], Scale(ofZ, deformed[2]))));
    };
    steps[0] = step(x.x, y.x, z.x);
    steps[1] = step(x.y, y.y, z.y);
    steps[2] = step(x.z, y.z, z.z);
  }

private:
  /**
   * Along columns, rows and the ray parameter both the deformed points P and the rest points Q are
   * known, so the gradient G by P solves G . P_x = g . Q_x, and so on for y and t. The derivatives
   * of Q are those of the interpolant. Returns G times Spread(), in the space of the lights.
   */
  HWY_INLINE Vec3 GradientFromFrame(const PacketCurve& curve, const Vec3& byIndex, Vf s)
  {
    if (HWY_UNLIKELY(!this->HaveSlopes))
    {
      this->FindSlopes(curve);
    }
    const Vf spread = this->Spread(curve.TimeAt(s));
    const Vf gt = Dot(byIndex, this->SlopeT.At(s));
    const Vf gx = Dot(byIndex, this->SlopeX.At(s));
    const Vf gy = Dot(byIndex, this->SlopeY.At(s));
    return MulAdd(
      gx, this->NormalX, MulAdd(gy, this->NormalY, Scale(hn::Mul(gt, spread), this->NormalT)));
  }

  /// RaySpread::Spread(), after FindSlopes().
  HWY_INLINE Vf Spread(Vf t) const { return hn::MulAdd(t, this->SpreadPerT, this->SpreadBase); }

  HWY_NOINLINE void FindSlopes(const PacketCurve& curve)
  {
    this->HaveSlopes = true;
    this->SlopeT = Cubic(curve.Position, hn::Div(Splat(1.0f), curve.Dt));
    Vf rows[4];
    LagrangeWeights(curve.Row, rows);
    this->SlopeX = FindPacketCurve(curve.Segment->ColumnSlopes, curve.X, rows);
    LagrangeSlopes(curve.Row, rows);
    for (Vf& row : rows)
    {
      row = hn::Mul(row, Splat(3.0f / static_cast<float>(curve.Segment->Side - 1)));
    }
    this->SlopeY = FindPacketCurve(curve.Segment->Columns, curve.X, rows);
  }

  /// Whether rows and columns of pixels lie across each other. If not, as with some oblique
  /// projections, derivatives along them do not tell a gradient.
  HWY_INLINE bool HasFrame()
  {
    if (HWY_UNLIKELY(this->Frame == FrameState::Unknown))
    {
      this->FindFrame();
    }
    return this->Frame == FrameState::Regular;
  }

  HWY_NOINLINE void FindFrame()
  {
    const RaySpread spread = this->Trees.FindSpread(this->X, this->Y, this->Rows, this->Rays);
    this->SpreadBase = spread.Base;
    this->SpreadPerT = spread.PerT;
    const Vec3& x = this->AcrossX = spread.AcrossX;
    const Vec3& y = this->AcrossY = spread.AcrossY;
    const Vec3& t = this->Rays.Direction;
    const Vec3 yt = Cross(y, t);
    const Vf area = Dot(x, yt);
    const Vf least = hn::Mul(Splat(LeastSine * LeastSine), hn::Mul(Dot(x, x), Dot(y, y)));
    this->Frame = hn::AllTrue(Df(), hn::Gt(hn::Mul(area, area), least)) ? FrameState::Regular
                                                                        : FrameState::Flat;
    const Vf inverse = hn::Div(Splat(1.0f), area);
    const auto toSpace = [&](const Vec3& normal) {
      return Transform(this->Scene.GradientToLights, Scale(inverse, normal));
    };
    this->NormalX = toSpace(yt);
    this->NormalY = toSpace(Cross(t, x));
    this->NormalT = toSpace(Cross(x, y));
  }

  /// The gradient with J_Phi of the field at the sample itself.
  HWY_NOINLINE Vec3 GradientFromField(const Vec3& index, const Vec3& byIndex, Vf t) const
  {
    const Vec3 p = MulAdd(t, this->Rays.Direction, this->Rays.Origin);
    const Vec3 q = WholeToLocal(this->Scene, IndexToWhole(this->Scene, index));
    Vec3 columns[3];
    PullBackJacobian(this->Scene, p, q, columns[0], columns[1], columns[2]);
    const Vec3 rest = Transform(this->Scene.GradientToRest, byIndex);
    return { Dot(columns[0], rest), Dot(columns[1], rest), Dot(columns[2], rest) };
  }

  const PacketScene& Scene;
  const SegmentTrees& Trees;
  const RayPacket& Rays;
  int X;
  int Y;
  Vf Rows;
  EyeDirections Eye; ///< back along the rays

  // Derivatives of the current curve by columns, rows and t, found when its first visible sample is
  // shaded.
  bool HaveSlopes = false;
  Quartic SlopeX;
  Quartic SlopeY;
  Cubic SlopeT;

  /// Of the angle between rows and columns of pixels, seen along the rays.
  static constexpr float LeastSine = 0.1f;

  // The vectors that make a gradient of derivatives along columns, rows and t.
  enum class FrameState
  {
    Unknown,
    Regular,
    Flat
  };
  FrameState Frame = FrameState::Unknown;
  Vec3 NormalX;
  Vec3 NormalY;
  Vec3 NormalT;
  Vec3 AcrossX; ///< RaySpread
  Vec3 AcrossY;
  Vf SpreadBase;
  Vf SpreadPerT;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
