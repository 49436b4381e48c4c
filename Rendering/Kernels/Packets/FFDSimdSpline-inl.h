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

#include <algorithm>
#include <cstddef>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Control points along an axis that lanes are evaluated over together, at most.
constexpr int LargestSupport = 8;
/// Cells of an axis whose supports have that many.
constexpr int LargestSpread = LargestSupport - 3;
/// More control points for each lane take longer than lane by lane.
constexpr int PointsPerLane = 20;

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
  axis.Weights[1] =
    hn::Mul(sixth, hn::MulAdd(u2, hn::MulAdd(Splat(3.0f), u, Splat(-6.0f)), Splat(4.0f)));
  axis.Weights[2] =
    hn::Mul(sixth, hn::MulAdd(v2, hn::MulAdd(Splat(3.0f), v, Splat(-6.0f)), Splat(4.0f)));
  if constexpr (WithSlopes)
  {
    const Mf inside = hn::And(hn::Gt(x, Splat(lo)), hn::Lt(x, Splat(hi)));
    const Vf toData = hn::IfThenElseZero(inside, Splat(inverseSpacing));
    axis.Slopes[0] = hn::Mul(toData, hn::Mul(Splat(-0.5f), v2));
    axis.Slopes[3] = hn::Mul(toData, hn::Mul(Splat(0.5f), u2));
    axis.Slopes[1] = hn::Mul(toData, hn::Mul(u, hn::MulAdd(Splat(1.5f), u, Splat(-2.0f))));
    axis.Slopes[2] = hn::Mul(toData, hn::Mul(hn::Neg(v), hn::MulAdd(Splat(1.5f), v, Splat(-2.0f))));
  }
}

/// Weights of the control points along an axis that some lanes need, the same ones for all lanes.
struct SplineSupport
{
  int Count; ///< control points
  Vf Weights[LargestSupport];
  Vf Slopes[LargestSupport];
};

/// The number of control points along an axis that `lanes` need, those of cells from `first` on.
HWY_INLINE int CountSupport(const SplineAxis& axis, Mf lanes, int first)
{
  const Di di;
  const Vi cells = hn::Sub(axis.Cell, hn::Set(di, first));
  return 4 + hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElseZero(hn::RebindMask(di, lanes), cells)));
}

/// `count`: CountSupport(), at most LargestSupport.
template <bool WithSlopes>
HWY_INLINE void SpreadOverSupport(
  const SplineAxis& axis, int first, int count, SplineSupport& support)
{
  const Df d;
  const Di di;
  const Vi cells = hn::Sub(axis.Cell, hn::Set(di, first));
  const int last = count - 4;
  support.Count = count;
  if (last == 0)
  {
    for (int i = 0; i < 4; ++i)
    {
      support.Weights[i] = axis.Weights[i];
      support.Slopes[i] = WithSlopes ? axis.Slopes[i] : hn::Zero(d);
    }
    return;
  }
  for (int n = 0; n < count; ++n)
  {
    Vf weight = hn::Zero(d);
    Vf slope = hn::Zero(d);
    for (int i = std::max(0, n - last); i <= std::min(n, 3); ++i)
    {
      const Mf here = hn::RebindMask(d, hn::Eq(cells, hn::Set(di, n - i)));
      weight = hn::IfThenElse(here, axis.Weights[i], weight);
      if constexpr (WithSlopes)
      {
        slope = hn::IfThenElse(here, axis.Slopes[i], slope);
      }
    }
    support.Weights[n] = weight;
    support.Slopes[n] = slope;
  }
}

/// A displacement, and with slopes its Jacobian by columns.
struct FieldValue
{
  Vec3 Displacement;
  Vec3 Dx;
  Vec3 Dy;
  Vec3 Dz;
};

HWY_INLINE FieldValue Select(Mf lanes, const FieldValue& yes, const FieldValue& no)
{
  return { Select(lanes, yes.Displacement, no.Displacement), Select(lanes, yes.Dx, no.Dx),
    Select(lanes, yes.Dy, no.Dy), Select(lanes, yes.Dz, no.Dz) };
}

/// The sum over Nx x y.Count x z.Count control points from `corner` on.
template <bool WithSlopes, int Nx>
HWY_INLINE void SumOverColumns(const float* corner, std::ptrdiff_t stepY, std::ptrdiff_t stepZ,
  const SplineSupport& x, const SplineSupport& y, const SplineSupport& z, FieldValue& value)
{
  const Vf zero = hn::Zero(Df());
  const Vec3 nothing{ zero, zero, zero };
  Vec3 sum = nothing;
  Vec3 sumX = nothing;
  Vec3 sumY = nothing;
  Vec3 sumZ = nothing;
  for (int k = 0; k < z.Count; ++k, corner += stepZ)
  {
    Vec3 plane = nothing;
    Vec3 planeX = nothing;
    Vec3 planeY = nothing;
    const float* c = corner;
    for (int j = 0; j < y.Count; ++j, c += stepY)
    {
      Vec3 row = Scale(x.Weights[0], Broadcast(c));
      Vec3 slope = nothing;
      if constexpr (WithSlopes)
      {
        slope = Scale(x.Slopes[0], Broadcast(c));
      }
      for (int i = 1; i < Nx; ++i)
      {
        const Vec3 point = Broadcast(c + 3 * i);
        row = MulAdd(x.Weights[i], point, row);
        if constexpr (WithSlopes)
        {
          slope = MulAdd(x.Slopes[i], point, slope);
        }
      }
      plane = MulAdd(y.Weights[j], row, plane);
      if constexpr (WithSlopes)
      {
        planeY = MulAdd(y.Slopes[j], row, planeY);
        planeX = MulAdd(y.Weights[j], slope, planeX);
      }
    }
    sum = MulAdd(z.Weights[k], plane, sum);
    if constexpr (WithSlopes)
    {
      sumX = MulAdd(z.Weights[k], planeX, sumX);
      sumY = MulAdd(z.Weights[k], planeY, sumY);
      sumZ = MulAdd(z.Slopes[k], plane, sumZ);
    }
  }
  value = { sum, sumX, sumY, sumZ };
}

/// The sum over the control points of a support along each axis, from `corner` on.
template <bool WithSlopes>
HWY_INLINE void SumOverSupport(const float* corner, std::ptrdiff_t stepY, std::ptrdiff_t stepZ,
  const SplineSupport support[3], FieldValue& value)
{
  const auto sum = [&](auto columns) {
    SumOverColumns<WithSlopes, decltype(columns)::value>(
      corner, stepY, stepZ, support[0], support[1], support[2], value);
  };
  switch (support[0].Count)
  {
    case 4:
      sum(std::integral_constant<int, 4>());
      break;
    case 5:
      sum(std::integral_constant<int, 5>());
      break;
    case 6:
      sum(std::integral_constant<int, 6>());
      break;
    case 7:
      sum(std::integral_constant<int, 7>());
      break;
    default:
      sum(std::integral_constant<int, LargestSupport>());
      break;
  }
}

#if HWY_TARGET != HWY_SCALAR
/// Sums up each lane of `lanes` by itself, over its own 4 x 4 x 4 control points, x, y and z of one
/// at a time: the same operations as SumOverSupport(). `points`: of the cell 0 of each axis.
template <bool WithSlopes>
HWY_NOINLINE void SumLaneByLane(const float* points, std::ptrdiff_t stepY, std::ptrdiff_t stepZ,
  const SplineAxis axes[3], Mf lanes, FieldValue& value)
{
  const Df d;
  const hn::FixedTag<float, 4> d4;
  using V4 = hn::Vec<decltype(d4)>;
  constexpr std::size_t count = hn::MaxLanes(Df());
  constexpr int vectors = WithSlopes ? 4 : 1;
  HWY_ALIGN int cells[3][count];
  HWY_ALIGN float weights[3][4][count];
  HWY_ALIGN float slopes[3][4][count];
  HWY_ALIGN float sums[4][4 * count];
  for (int a = 0; a < 3; ++a)
  {
    hn::Store(axes[a].Cell, Di(), cells[a]);
    for (int i = 0; i < 4; ++i)
    {
      hn::Store(axes[a].Weights[i], d, weights[a][i]);
      if constexpr (WithSlopes)
      {
        hn::Store(axes[a].Slopes[i], d, slopes[a][i]);
      }
    }
  }
  for (int v = 0; v < vectors; ++v)
  {
    std::fill_n(sums[v], 4 * hn::Lanes(d), 0.0f);
  }
  HWY_ALIGN float wanted[count];
  hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, wanted);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
  {
    if (wanted[lane] == 0.0f)
    {
      continue;
    }
    V4 x[4];
    V4 xSlope[4];
    V4 y[4];
    V4 ySlope[4];
    for (int i = 0; i < 4; ++i)
    {
      x[i] = hn::Set(d4, weights[0][i][lane]);
      y[i] = hn::Set(d4, weights[1][i][lane]);
      if constexpr (WithSlopes)
      {
        xSlope[i] = hn::Set(d4, slopes[0][i][lane]);
        ySlope[i] = hn::Set(d4, slopes[1][i][lane]);
      }
    }
    V4 sum = hn::Zero(d4);
    V4 sumX = sum;
    V4 sumY = sum;
    V4 sumZ = sum;
    const float* corner = points + 3 * static_cast<std::ptrdiff_t>(cells[0][lane]) +
      stepY * cells[1][lane] + stepZ * cells[2][lane];
    for (int k = 0; k < 4; ++k, corner += stepZ)
    {
      V4 plane = hn::Zero(d4);
      V4 planeX = plane;
      V4 planeY = plane;
      const float* c = corner;
      for (int j = 0; j < 4; ++j, c += stepY)
      {
        const V4 first = hn::LoadU(d4, c);
        V4 row = hn::Mul(x[0], first);
        V4 slope = hn::Zero(d4);
        if constexpr (WithSlopes)
        {
          slope = hn::Mul(xSlope[0], first);
        }
        for (int i = 1; i < 4; ++i)
        {
          const V4 point = hn::LoadU(d4, c + 3 * i);
          row = hn::MulAdd(x[i], point, row);
          if constexpr (WithSlopes)
          {
            slope = hn::MulAdd(xSlope[i], point, slope);
          }
        }
        plane = hn::MulAdd(y[j], row, plane);
        if constexpr (WithSlopes)
        {
          planeY = hn::MulAdd(ySlope[j], row, planeY);
          planeX = hn::MulAdd(y[j], slope, planeX);
        }
      }
      const V4 z = hn::Set(d4, weights[2][k][lane]);
      sum = hn::MulAdd(z, plane, sum);
      if constexpr (WithSlopes)
      {
        sumX = hn::MulAdd(z, planeX, sumX);
        sumY = hn::MulAdd(z, planeY, sumY);
        sumZ = hn::MulAdd(hn::Set(d4, slopes[2][k][lane]), plane, sumZ);
      }
    }
    hn::Store(sum, d4, sums[0] + 4 * lane);
    if constexpr (WithSlopes)
    {
      hn::Store(sumX, d4, sums[1] + 4 * lane);
      hn::Store(sumY, d4, sums[2] + 4 * lane);
      hn::Store(sumZ, d4, sums[3] + 4 * lane);
    }
  }
  Vec3* const results[4] = { &value.Displacement, &value.Dx, &value.Dy, &value.Dz };
  for (int v = 0; v < vectors; ++v)
  {
    Vf unused;
    hn::LoadInterleaved4(d, sums[v], results[v]->x, results[v]->y, results[v]->z, unused);
  }
}
#endif

/**
 * D of every lane, and with WithSlopes its Jacobian by columns (dx, dy, dz). Lanes are mostly near
 * to each other: those that are within a few cells of the lattice are summed up over all control
 * points that any of them needs, each broadcast to all lanes, unless these are so many that it
 * takes less to sum up each lane by itself. What a lane gets does not depend on the others: control
 * points that it does not need weigh nothing.
 */
template <bool WithSlopes>
HWY_NOINLINE void EvaluateField(
  const PacketField& field, const Vec3& p, Vec3& displacement, Vec3& dx, Vec3& dy, Vec3& dz)
{
  const Df d;
  const Di di;
  SplineAxis axes[3];
  const Vf position[3] = { p.x, p.y, p.z };
  for (int a = 0; a < 3; ++a)
  {
    LocateOnAxis<WithSlopes>(position[a], field.Origin[a], field.InverseSpacing[a],
      field.ClampMin[a], field.ClampMax[a], axes[a]);
  }
  const std::ptrdiff_t stepY = 3 * static_cast<std::ptrdiff_t>(field.StrideY);
  const std::ptrdiff_t stepZ = stepY * field.StrideZ;
  // Of the cell 0 of each axis.
  const float* const firstPoint =
    field.Coefficients->data() + field.FirstOffset * (3 + stepY + stepZ);
  FieldValue value;
  Mf todo = hn::FirstN(d, hn::Lanes(d));
  for (bool first = true; first || !hn::AllFalse(d, todo); first = false)
  {
    // Those within reach of the one that comes first along each axis.
    Mf lanes = todo;
    int least[3];
    for (int a = 2; a >= 0; --a)
    {
      const Vi far = hn::Set(di, 1 << 30);
      least[a] = hn::GetLane(
        hn::MinOfLanes(di, hn::IfThenElse(hn::RebindMask(di, lanes), axes[a].Cell, far)));
      lanes = hn::And(
        lanes, hn::RebindMask(d, hn::Lt(axes[a].Cell, hn::Set(di, least[a] + LargestSpread))));
    }
    const int counts[3] = { CountSupport(axes[0], lanes, least[0]),
      CountSupport(axes[1], lanes, least[1]), CountSupport(axes[2], lanes, least[2]) };
    FieldValue sum;
#if HWY_TARGET != HWY_SCALAR
    if (HWY_UNLIKELY(counts[0] * counts[1] * counts[2] >
          PointsPerLane * static_cast<int>(hn::CountTrue(d, lanes))))
    {
      lanes = todo;
      SumLaneByLane<WithSlopes>(firstPoint, stepY, stepZ, axes, lanes, sum);
    }
    else
#endif
    {
      SplineSupport support[3];
      for (int a = 0; a < 3; ++a)
      {
        SpreadOverSupport<WithSlopes>(axes[a], least[a], counts[a], support[a]);
      }
      SumOverSupport<WithSlopes>(firstPoint + 3 * static_cast<std::ptrdiff_t>(least[0]) +
          stepY * least[1] + stepZ * least[2],
        stepY, stepZ, support, sum);
    }
    value = first ? sum : Select(lanes, sum, value);
    todo = hn::AndNot(lanes, todo);
  }
  displacement = value.Displacement;
  dx = value.Dx;
  dy = value.Dy;
  dz = value.Dz;
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
  const auto within = [&](Vf x, int a) {
    const Vf cell = hn::Mul(hn::Sub(x, Splat(field.Origin[a])), Splat(field.InverseSpacing[a]));
    return hn::And(hn::Gt(cell, Splat(field.ClampMin[a])), hn::Lt(cell, Splat(field.ClampMax[a])));
  };
  return hn::And(within(p.x, 0), hn::And(within(p.y, 1), within(p.z, 2)));
}

/// A step of Newton's method for T(q) = p.
struct NewtonStep
{
  Vec3 Residual; ///< T(q) - p
  Vec3 Delta;    ///< J_T^-1 times that: what the step takes off q
  Vf Norm;       ///< of J_T^-1, Frobenius
  Vec3 Rows[3];  ///< of J_T^-1 times its determinant
  Vf Inverse;    ///< 1 / determinant

  /// J_T^-1 v
  HWY_INLINE Vec3 Apply(const Vec3& v) const
  {
    return Scale(
      this->Inverse, { Dot(v, this->Rows[0]), Dot(v, this->Rows[1]), Dot(v, this->Rows[2]) });
  }
};

HWY_INLINE NewtonStep FindNewtonStep(const PacketField& field, const Vec3& p, const Vec3& q)
{
  const Vf one = Splat(1.0f);
  Vec3 displacement;
  Vec3 a;
  Vec3 b;
  Vec3 c;
  EvaluateField<true>(field, q, displacement, a, b, c);
  NewtonStep step;
  step.Residual = Add(Sub(q, p), displacement);
  // Solve (I + [a b c]) delta = residual by Cramer's rule.
  a.x = hn::Add(a.x, one);
  b.y = hn::Add(b.y, one);
  c.z = hn::Add(c.z, one);
  step.Rows[0] = Cross(b, c);
  step.Rows[1] = Cross(c, a);
  step.Rows[2] = Cross(a, b);
  const Vf determinant = Dot(a, step.Rows[0]);
  // Far below what a volume that is made a thousand times smaller has, 1e-9.
  const Vf smallest = Splat(1e-12f);
  step.Inverse = Reciprocal(hn::IfThenElse(
    hn::Lt(hn::Abs(determinant), smallest), hn::CopySign(smallest, determinant), determinant));
  const auto square = [&](int row) { return Dot(step.Rows[row], step.Rows[row]); };
  step.Norm =
    hn::Mul(hn::Abs(step.Inverse), FastSqrt(hn::Add(square(0), hn::Add(square(1), square(2)))));
  step.Delta = step.Apply(step.Residual);
  return step;
}

/// How near rest positions can be told: T may shrink them far below its rounding errors.
HWY_INLINE Vf FindRounding(const PacketField& field, const NewtonStep& step)
{
  return hn::Min(hn::Mul(step.Norm, Splat(field.Rounding)), Splat(field.LargestRounding));
}

/// Most that a step of Newton's method moves a lane: the edge of a cell, or what the theorem of
/// Newton and Kantorovich allows, where a lattice is finer than its deformation. `bend`: |J^-1| M.
HWY_INLINE Vf FindStepLimit(const PacketField& field, Vf bend)
{
  const Vf longest = Splat(field.LongestStep);
  return field.Smooth ? hn::Max(longest, hn::Div(Splat(0.5f), hn::Max(bend, Splat(1e-30f))))
                      : longest;
}

/**
 * T(Q) = p for the lanes of `active` by Newton's method from `q`, with steps of limited length. A
 * lane is done with a step no longer than the tolerance or FindRounding(), or earlier: by the
 * theorem of Newton and Kantorovich with a step delta that ends within h |delta| of Q, where h =
 * |J^-1| M |delta| <= 1/2, M being a bound of the second derivative. With `chord` the second step
 * has the Jacobian of the first one, and takes half as long. It counts where it is at most half as
 * long as that: what is left then follows from both lengths. What a lane gets does not depend on
 * the others. Returns the lanes that are done; `step` is the last one.
 */
HWY_INLINE Mf SolveInverse(const PacketField& field, const Vec3& p, float tolerance, Mf active,
  int largestSteps, bool chord, Vec3& q, NewtonStep& step, int& evaluations)
{
  const Df d;
  Mf done = hn::Not(active);
  Vf first = hn::Zero(d);
  for (int i = 0; i < largestSteps && !hn::AllTrue(d, done); ++i)
  {
    const bool isChord = chord && i == 1;
    if (isChord)
    {
      step.Residual = Add(Sub(q, p), Displacement(field, q));
      step.Delta = step.Apply(step.Residual);
    }
    else
    {
      step = FindNewtonStep(field, p, q);
    }
    ++evaluations;
    const Vf squared = Dot(step.Delta, step.Delta);
    const Vf inverse = InverseSqrt(hn::Max(squared, Splat(1e-30f)));
    const Vf length = hn::Mul(squared, inverse);
    const Vf bend = hn::Mul(step.Norm, Splat(field.SecondDerivative));
    const Vf limit = FindStepLimit(field, bend);
    const Mf isWhole = hn::Le(length, limit);
    const Vf part = hn::Min(Splat(1.0f), hn::Mul(limit, inverse));
    const Vec3 next = MulAdd(hn::Neg(part), step.Delta, q);
    const Vf largest = hn::Max(Splat(tolerance), FindRounding(field, step));
    if (isChord)
    {
      // Steps become shorter by about the same factor: what is left is below length^2 / first.
      const Vf guard = Splat(4.0f);
      const Mf counts = hn::Le(hn::Add(length, length), first);
      const Mf isShort = hn::And(hn::Le(length, hn::Mul(guard, largest)),
        hn::Le(hn::Mul(guard, hn::Mul(length, length)), hn::Mul(largest, first)));
      q = Select(hn::AndNot(done, counts), next, q);
      done = hn::Or(done, hn::And(counts, hn::Or(hn::Le(length, largest), isShort)));
      continue;
    }
    const Vf h = hn::Mul(bend, length);
    Mf known = hn::And(hn::Le(h, Splat(0.5f)), isWhole);
    if (!field.Smooth)
    {
      known = hn::And(known, hn::And(IsInLattice(field, q), IsInLattice(field, next)));
    }
    q = Select(done, q, next);
    done = hn::Or(done,
      hn::Or(
        hn::Le(length, largest), hn::And(known, hn::Le(hn::Mul(h, length), Splat(tolerance)))));
    first = hn::IfThenElseZero(isWhole, length);
  }
  return done;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
