// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The B-spline field and the inverse of T, a point a lane. Included once per target of Highway.
#if defined(FFD_SIMD_SPLINE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SPLINE_INL_H_
#undef FFD_SIMD_SPLINE_INL_H_
#else
#define FFD_SIMD_SPLINE_INL_H_
#endif

#include "FFDPacketField.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Position of every lane on one axis of the lattice.
struct SplineAxis
{
  Vi Cell;
  Vf Weights[4];
  Vf Slopes[4]; // by data units; zero outside of the lattice
};

template <bool WithSlopes>
HWY_INLINE void LocateOnAxis(
  Vf p, float origin, float inverseSpacing, float lo, float hi, SplineAxis& axis)
{
  const Di di;
  const Vf x = hn::Mul(hn::Sub(p, Splat(origin)), Splat(inverseSpacing));
  const Vf c = Clamp(x, Splat(lo), Splat(hi));
  // The cell of the last point is the one that ends there.
  const Vf cell = hn::Min(hn::Floor(c), Splat(hi - 1.0f));
  axis.Cell = hn::ConvertTo(di, cell);
  const Vf u = hn::Sub(c, cell);
  const Vf v = hn::Sub(Splat(1.0f), u);
  const Vf sixth = Splat(1.0f / 6.0f);
  const Vf u2 = hn::Mul(u, u);
  const Vf v2 = hn::Mul(v, v);
  axis.Weights[0] = hn::Mul(sixth, hn::Mul(v2, v));
  axis.Weights[3] = hn::Mul(sixth, hn::Mul(u2, u));
  // 4 - 6 u^2 + 3 u^3, and its mirror image.
  axis.Weights[1] = hn::Mul(
    sixth, hn::MulAdd(u2, hn::MulAdd(Splat(3.0f), u, Splat(-6.0f)), Splat(4.0f)));
  axis.Weights[2] = hn::Mul(
    sixth, hn::MulAdd(v2, hn::MulAdd(Splat(3.0f), v, Splat(-6.0f)), Splat(4.0f)));
  if constexpr (WithSlopes)
  {
    const Mf inside = hn::And(hn::Gt(x, Splat(lo)), hn::Lt(x, Splat(hi)));
    const Vf toData = hn::IfThenElseZero(inside, Splat(inverseSpacing));
    axis.Slopes[0] = hn::Mul(toData, hn::Mul(Splat(-0.5f), v2));
    axis.Slopes[3] = hn::Mul(toData, hn::Mul(Splat(0.5f), u2));
    axis.Slopes[1] =
      hn::Mul(toData, hn::Mul(u, hn::MulAdd(Splat(1.5f), u, Splat(-2.0f))));
    axis.Slopes[2] =
      hn::Mul(toData, hn::Mul(hn::Neg(v), hn::MulAdd(Splat(1.5f), v, Splat(-2.0f))));
  }
}

/**
 * D of every lane, and with WithSlopes its Jacobian by columns (dx, dy, dz). Neighbouring lanes
 * mostly share a lattice cell, so the cells are dealt with one after the other, each with its
 * control points broadcast to all lanes.
 */
template <bool WithSlopes>
HWY_NOINLINE void EvaluateField(const PacketField& field, const Vec3& p, Vec3& displacement,
  Vec3& dx, Vec3& dy, Vec3& dz)
{
  const Df d;
  const Di di;
  SplineAxis ax;
  SplineAxis ay;
  SplineAxis az;
  LocateOnAxis<WithSlopes>(
    p.x, field.Origin[0], field.InverseSpacing[0], field.ClampMin[0], field.ClampMax[0], ax);
  LocateOnAxis<WithSlopes>(
    p.y, field.Origin[1], field.InverseSpacing[1], field.ClampMin[1], field.ClampMax[1], ay);
  LocateOnAxis<WithSlopes>(
    p.z, field.Origin[2], field.InverseSpacing[2], field.ClampMin[2], field.ClampMax[2], az);
  const Vi offset = hn::Set(di, field.FirstOffset);
  const Vi base = hn::Add(hn::Add(ax.Cell, offset),
    hn::Mul(hn::Set(di, field.StrideY),
      hn::Add(hn::Add(ay.Cell, offset),
        hn::Mul(hn::Set(di, field.StrideZ), hn::Add(az.Cell, offset)))));

  HWY_ALIGN int bases[16];
  hn::Store(base, di, bases);
  const Vf zero = hn::Zero(d);
  displacement = { zero, zero, zero };
  if constexpr (WithSlopes)
  {
    dx = displacement;
    dy = displacement;
    dz = displacement;
  }
  const std::size_t lanes = hn::Lanes(d);
  std::uint32_t todo = lanes == 32 ? ~0u : (1u << lanes) - 1u;
  while (todo)
  {
    const int cell = bases[hwy::Num0BitsBelowLS1Bit_Nonzero32(todo)];
    std::uint32_t same = 0;
    for (std::size_t i = 0; i < lanes; ++i)
    {
      same |= bases[i] == cell ? 1u << i : 0u;
    }
    todo &= ~same;
    Vec3 sum{ zero, zero, zero };
    Vec3 sumX = sum;
    Vec3 sumY = sum;
    Vec3 sumZ = sum;
    for (int k = 0; k < 4; ++k)
    {
      Vec3 plane{ zero, zero, zero };
      Vec3 planeX = plane;
      Vec3 planeY = plane;
      for (int j = 0; j < 4; ++j)
      {
        const float* c = field.Coefficients.data() +
          3 * (static_cast<std::size_t>(cell) +
                static_cast<std::size_t>(field.StrideY) *
                  (static_cast<std::size_t>(j) +
                    static_cast<std::size_t>(field.StrideZ) * static_cast<std::size_t>(k)));
        Vec3 row = Scale(ax.Weights[0], { Splat(c[0]), Splat(c[1]), Splat(c[2]) });
        row = MulAdd(ax.Weights[1], { Splat(c[3]), Splat(c[4]), Splat(c[5]) }, row);
        row = MulAdd(ax.Weights[2], { Splat(c[6]), Splat(c[7]), Splat(c[8]) }, row);
        row = MulAdd(ax.Weights[3], { Splat(c[9]), Splat(c[10]), Splat(c[11]) }, row);
        plane = MulAdd(ay.Weights[j], row, plane);
        if constexpr (WithSlopes)
        {
          planeY = MulAdd(ay.Slopes[j], row, planeY);
          Vec3 slope = Scale(ax.Slopes[0], { Splat(c[0]), Splat(c[1]), Splat(c[2]) });
          slope = MulAdd(ax.Slopes[1], { Splat(c[3]), Splat(c[4]), Splat(c[5]) }, slope);
          slope = MulAdd(ax.Slopes[2], { Splat(c[6]), Splat(c[7]), Splat(c[8]) }, slope);
          slope = MulAdd(ax.Slopes[3], { Splat(c[9]), Splat(c[10]), Splat(c[11]) }, slope);
          planeX = MulAdd(ay.Weights[j], slope, planeX);
        }
      }
      sum = MulAdd(az.Weights[k], plane, sum);
      if constexpr (WithSlopes)
      {
        sumX = MulAdd(az.Weights[k], planeX, sumX);
        sumY = MulAdd(az.Weights[k], planeY, sumY);
        sumZ = MulAdd(az.Slopes[k], plane, sumZ);
      }
    }
    const Mf mine = hn::RebindMask(d, hn::Eq(base, hn::Set(di, cell)));
    const auto select = [mine](const Vec3& yes, const Vec3& no) -> Vec3
    {
      return { hn::IfThenElse(mine, yes.x, no.x), hn::IfThenElse(mine, yes.y, no.y),
        hn::IfThenElse(mine, yes.z, no.z) };
    };
    displacement = select(sum, displacement);
    if constexpr (WithSlopes)
    {
      dx = select(sumX, dx);
      dy = select(sumY, dy);
      dz = select(sumZ, dz);
    }
  }
}

HWY_INLINE Vec3 Displacement(const PacketField& field, const Vec3& p)
{
  Vec3 displacement;
  Vec3 unused;
  EvaluateField<false>(field, p, displacement, unused, unused, unused);
  return displacement;
}

/// Lanes inside of the lattice, where the field has two derivatives.
HWY_INLINE Mf IsInLattice(const PacketField& field, const Vec3& p)
{
  const auto within = [&](Vf x, int a)
  {
    const Vf cell = hn::Mul(hn::Sub(x, Splat(field.Origin[a])), Splat(field.InverseSpacing[a]));
    return hn::And(hn::Gt(cell, Splat(field.ClampMin[a])), hn::Lt(cell, Splat(field.ClampMax[a])));
  };
  return hn::And(within(p.x, 0), hn::And(within(p.y, 1), within(p.z, 2)));
}

/// J_T^-1 (T(q) - p): what a step of Newton's method takes off q. `norm`: of J_T^-1, Frobenius.
HWY_INLINE Vec3 FindNewtonStep(
  const PacketField& field, const Vec3& p, const Vec3& q, Vec3& residual, Vf& norm)
{
  const Vf one = Splat(1.0f);
  Vec3 displacement;
  Vec3 a;
  Vec3 b;
  Vec3 c;
  EvaluateField<true>(field, q, displacement, a, b, c);
  residual = Add(Sub(q, p), displacement);
  // Solve (I + [a b c]) delta = residual by Cramer's rule.
  a.x = hn::Add(a.x, one);
  b.y = hn::Add(b.y, one);
  c.z = hn::Add(c.z, one);
  const Vec3 bc = Cross(b, c);
  const Vec3 ca = Cross(c, a);
  const Vec3 ab = Cross(a, b);
  const Vf determinant = Dot(a, bc);
  const Vf smallest = Splat(1e-6f);
  const Vf inverse = hn::Div(one,
    hn::IfThenElse(hn::Lt(hn::Abs(determinant), smallest), hn::CopySign(smallest, determinant),
      determinant));
  norm = hn::Mul(
    hn::Abs(inverse), hn::Sqrt(hn::Add(Dot(bc, bc), hn::Add(Dot(ca, ca), Dot(ab, ab)))));
  return Scale(inverse, { Dot(residual, bc), Dot(residual, ca), Dot(residual, ab) });
}

HWY_INLINE Vec3 FindNewtonStep(const PacketField& field, const Vec3& p, const Vec3& q)
{
  Vec3 residual;
  Vf norm;
  return FindNewtonStep(field, p, q, residual, norm);
}

/**
 * T(Q) = p for the lanes of `active` by Newton's method from `q`, with steps of limited length. A lane
 * is done when its residual is under the tolerance, or earlier, when the theorem of Newton and
 * Kantorovich bounds the error of its next iterate: with h = |J^-1| M |delta| <= 1/2 that is
 * h |delta|, M being a bound of the second derivative. What a lane gets does not depend on the
 * others. Returns the lanes that are done.
 */
HWY_INLINE Mf SolveInverse(const PacketField& field, const Vec3& p, float tolerance, Mf active,
  Vec3& q, int& evaluations)
{
  constexpr int LargestSteps = 12;
  const Df d;
  Mf done = hn::Not(active);
  for (int step = 0; step < LargestSteps; ++step)
  {
    Vec3 residual;
    Vf norm;
    const Vec3 delta = FindNewtonStep(field, p, q, residual, norm);
    ++evaluations;
    done = hn::Or(done, hn::Le(Dot(residual, residual), Splat(tolerance * tolerance)));
    if (hn::AllTrue(d, done))
    {
      break;
    }
    const Vf length = hn::Sqrt(Dot(delta, delta));
    const Vf longest = Splat(field.LongestStep);
    const Vf part = hn::Min(Splat(1.0f), hn::Div(longest, hn::Max(length, Splat(1e-30f))));
    const Vec3 next = MulAdd(hn::Neg(part), delta, q);
    const Vf h = hn::Mul(hn::Mul(norm, Splat(field.SecondDerivative)), length);
    const Mf proven = hn::And(hn::And(hn::Le(h, Splat(0.5f)),
                                hn::And(hn::Le(length, longest),
                                  hn::Le(hn::Mul(h, length), Splat(tolerance)))),
      field.Smooth ? hn::FirstN(d, hn::Lanes(d))
                   : hn::And(IsInLattice(field, q), IsInLattice(field, next)));
    q = Select(done, q, next);
    done = hn::Or(done, proven);
    if (hn::AllTrue(d, done))
    {
      break;
    }
  }
  return done;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
