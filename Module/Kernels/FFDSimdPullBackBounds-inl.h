// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// From bounds of the displacement to those of a pull-back, for many sub-cells at a time. Included
// once per target of Highway.
#if defined(FFD_SIMD_PULL_BACK_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PULL_BACK_BOUNDS_INL_H_
#undef FFD_SIMD_PULL_BACK_BOUNDS_INL_H_
#else
#define FFD_SIMD_PULL_BACK_BOUNDS_INL_H_
#endif

#include "FFDSubCellBounds.h"

#include <hwy/highway.h>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

/// Lanes per block on every target, so that buffers have a fixed size.
constexpr int BlockLanes = 16;

/// Bounds over a block of sub-cells, as in SubCellBounds.
struct BoundsBlock
{
  HWY_ALIGN float Value[SubCellBounds::Size][BlockLanes];
};

/// Bounds of the derivatives of one order over a block of cells, as in CellDerivatives.
struct DerivativesBlock
{
  HWY_ALIGN float Entry[10][3][BlockLanes]; ///< each derivative by component
  HWY_ALIGN float Norm[BlockLanes];         ///< of the whole tensor
};

/// The inverse of a map is found in double precision.
using TagD = hn::CappedTag<double, 8>;
using TagOfD = hn::Rebind<float, TagD>;
using VecD = hn::Vec<TagD>;
using MaskD = hn::Mask<TagD>;

struct Vector3D
{
  VecD x;
  VecD y;
  VecD z;
};

/// Columns.
struct Matrix3D
{
  Vector3D Column[3];
};

HWY_INLINE VecD LoadPromoted(const float* from)
{
  return hn::PromoteTo(TagD(), hn::Load(TagOfD(), from));
}

/// Store floats that are not below x; infinity for what is not a number. One relative step of
/// 2^-22 covers the cast and the sum.
HWY_INLINE void StoreRoundedUp(VecD x, float* to)
{
  const TagD d;
  const TagOfD f;
  // Clamped first, as casts of what floats cannot hold differ between machines.
  constexpr double most = 3e38;
  const auto limit = hn::Set(d, most);
  const auto clamped = hn::Max(hn::IfThenElse(hn::Le(x, limit), x, limit), hn::Neg(limit));
  const auto single = hn::DemoteTo(f, clamped);
  const auto above = hn::Add(hn::MulAdd(hn::Abs(single), hn::Set(f, 2.4e-7f), single),
    hn::Set(f, std::numeric_limits<float>::min()));
  const auto infinite = hn::Ge(single, hn::Set(f, static_cast<float>(most)));
  hn::Store(
    hn::IfThenElse(infinite, hn::Set(f, std::numeric_limits<float>::infinity()), above), f, to);
}

HWY_INLINE VecD Dot(const Vector3D& a, const Vector3D& b)
{
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE VecD Length(const Vector3D& a) { return hn::Sqrt(Dot(a, a)); }

HWY_INLINE Vector3D Cross(const Vector3D& a, const Vector3D& b)
{
  return { hn::NegMulAdd(b.y, a.z, hn::Mul(a.y, b.z)), hn::NegMulAdd(b.z, a.x, hn::Mul(a.z, b.x)),
    hn::NegMulAdd(b.x, a.y, hn::Mul(a.x, b.y)) };
}

HWY_INLINE Vector3D Multiply(const Matrix3D& m, const Vector3D& v)
{
  const auto row = [&](VecD a, VecD b, VecD c) {
    return hn::MulAdd(a, v.x, hn::MulAdd(b, v.y, hn::Mul(c, v.z)));
  };
  return { row(m.Column[0].x, m.Column[1].x, m.Column[2].x),
    row(m.Column[0].y, m.Column[1].y, m.Column[2].y),
    row(m.Column[0].z, m.Column[1].z, m.Column[2].z) };
}

HWY_INLINE Matrix3D Multiply(const Matrix3D& a, const Matrix3D& b)
{
  return { { Multiply(a, b.Column[0]), Multiply(a, b.Column[1]), Multiply(a, b.Column[2]) } };
}

HWY_INLINE Matrix3D Scale(const Matrix3D& m, VecD s)
{
  Matrix3D to;
  for (int i = 0; i < 3; ++i)
  {
    to.Column[i] = { hn::Mul(m.Column[i].x, s), hn::Mul(m.Column[i].y, s),
      hn::Mul(m.Column[i].z, s) };
  }
  return to;
}

HWY_INLINE Matrix3D Absolute(const Matrix3D& m)
{
  Matrix3D to;
  for (int i = 0; i < 3; ++i)
  {
    to.Column[i] = { hn::Abs(m.Column[i].x), hn::Abs(m.Column[i].y), hn::Abs(m.Column[i].z) };
  }
  return to;
}

/// I - m.
HWY_INLINE Matrix3D OneMinus(const Matrix3D& m)
{
  const auto one = hn::Set(TagD(), 1.0);
  const Vector3D* c = m.Column;
  return { { { hn::Sub(one, c[0].x), hn::Neg(c[0].y), hn::Neg(c[0].z) },
    { hn::Neg(c[1].x), hn::Sub(one, c[1].y), hn::Neg(c[1].z) },
    { hn::Neg(c[2].x), hn::Neg(c[2].y), hn::Sub(one, c[2].z) } } };
}

/// Inverse times determinant.
HWY_INLINE Matrix3D Adjugate(const Matrix3D& m, VecD& determinant)
{
  const Vector3D a = Cross(m.Column[1], m.Column[2]);
  const Vector3D b = Cross(m.Column[2], m.Column[0]);
  const Vector3D c = Cross(m.Column[0], m.Column[1]);
  determinant = Dot(m.Column[0], a);
  return { { { a.x, b.x, c.x }, { a.y, b.y, c.y }, { a.z, b.z, c.z } } };
}

HWY_INLINE VecD LargestOf(VecD a, VecD b, VecD c) { return hn::Max(a, hn::Max(b, c)); }

HWY_INLINE VecD LargestRowSum(const Matrix3D& m)
{
  const Vector3D* c = m.Column;
  return LargestOf(hn::Add(c[0].x, hn::Add(c[1].x, c[2].x)),
    hn::Add(c[0].y, hn::Add(c[1].y, c[2].y)), hn::Add(c[0].z, hn::Add(c[1].z, c[2].z)));
}

HWY_INLINE VecD LargestColumnSum(const Matrix3D& m)
{
  const Vector3D* c = m.Column;
  return LargestOf(hn::Add(c[0].x, hn::Add(c[0].y, c[0].z)),
    hn::Add(c[1].x, hn::Add(c[1].y, c[1].z)), hn::Add(c[2].x, hn::Add(c[2].y, c[2].z)));
}

/// sum += factor * the derivative's bounds by component.
HWY_INLINE void AddDerivative(
  const DerivativesBlock& cells, int derivative, int lane, VecD factor, Vector3D& sum)
{
  const float(*entry)[BlockLanes] = cells.Entry[derivative];
  sum.x = hn::MulAdd(factor, LoadPromoted(entry[0] + lane), sum.x);
  sum.y = hn::MulAdd(factor, LoadPromoted(entry[1] + lane), sum.y);
  sum.z = hn::MulAdd(factor, LoadPromoted(entry[2] + lane), sum.z);
}

HWY_INLINE Vector3D NoVector() { return { hn::Zero(TagD()), hn::Zero(TagD()), hn::Zero(TagD()) }; }

/// Bounds of T2[q, r] for the second derivatives of cells: sum over b, c of |H_bc| q_b r_c.
HWY_INLINE Vector3D ApplySecond(
  const DerivativesBlock& second, int lane, const Vector3D& q, const Vector3D& r)
{
  Vector3D sum = NoVector();
  AddDerivative(second, 0, lane, hn::Mul(q.x, r.x), sum);
  AddDerivative(second, 1, lane, hn::MulAdd(q.x, r.y, hn::Mul(q.y, r.x)), sum);
  AddDerivative(second, 2, lane, hn::MulAdd(q.x, r.z, hn::Mul(q.z, r.x)), sum);
  AddDerivative(second, 3, lane, hn::Mul(q.y, r.y), sum);
  AddDerivative(second, 4, lane, hn::MulAdd(q.y, r.z, hn::Mul(q.z, r.y)), sum);
  AddDerivative(second, 5, lane, hn::Mul(q.z, r.z), sum);
  return sum;
}

/// Bounds of T3[q, q, q].
HWY_INLINE Vector3D ApplyThird(const DerivativesBlock& third, int lane, const Vector3D& q)
{
  const auto three = hn::Set(TagD(), 3.0);
  const auto xx = hn::Mul(q.x, q.x);
  const auto yy = hn::Mul(q.y, q.y);
  const auto zz = hn::Mul(q.z, q.z);
  const auto x3 = hn::Mul(three, q.x);
  const auto y3 = hn::Mul(three, q.y);
  const auto z3 = hn::Mul(three, q.z);
  Vector3D sum = NoVector();
  AddDerivative(third, 0, lane, hn::Mul(xx, q.x), sum);
  AddDerivative(third, 1, lane, hn::Mul(xx, y3), sum);
  AddDerivative(third, 2, lane, hn::Mul(xx, z3), sum);
  AddDerivative(third, 3, lane, hn::Mul(yy, x3), sum);
  AddDerivative(third, 4, lane, hn::Mul(hn::Add(x3, x3), hn::Mul(q.y, q.z)), sum);
  AddDerivative(third, 5, lane, hn::Mul(zz, x3), sum);
  AddDerivative(third, 6, lane, hn::Mul(yy, q.y), sum);
  AddDerivative(third, 7, lane, hn::Mul(yy, z3), sum);
  AddDerivative(third, 8, lane, hn::Mul(zz, y3), sum);
  AddDerivative(third, 9, lane, hn::Mul(zz, q.z), sum);
  return sum;
}

/**
 * Turn bounds of D's derivatives into those of the inverse of T(X) = X + D(X), over the same
 * sub-cells of rest space. With J = C + E, |E| <= Delta entry-wise, W = |C^-1| Delta:
 * J^-1 - C^-1 = -C^-1 E J^-1, so |J^-1 - C^-1| <= (W + W^2 + ...) |C^-1| = (I - W)^-1 W |C^-1|
 * when the spectral radius of W is below one; the largest row or column sum proves that.
 * Unbounded where that cannot be shown. `mirrored`: those of 2P - T^-1(P) instead. Returns whether
 * all of the first `count` lanes are bounded.
 */
inline bool BoundInverse(const DerivativesBlock& second, const DerivativesBlock& third,
  bool mirrored, int count, BoundsBlock& bounds)
{
  const TagD d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, 0.5);
  const auto one = hn::Set(d, 1.0);
  const auto three = hn::Set(d, 3.0);
  // What is unbounded: more than floats can hold.
  const auto unbounded = hn::Set(d, 1e300);
  float(*negatedMin)[BlockLanes] = bounds.Value + SubCellBounds::NegatedJacobianMin;
  float(*max)[BlockLanes] = bounds.Value + SubCellBounds::JacobianMax;
  bool allBounded = true;
  for (int l = 0; l < count; l += step)
  {
    Matrix3D centre;
    Matrix3D delta;
    for (int column = 0; column < 3; ++column)
    {
      VecD middle[3];
      VecD spread[3];
      for (int row = 0; row < 3; ++row)
      {
        const auto lo = LoadPromoted(negatedMin[3 * column + row] + l);
        const auto hi = LoadPromoted(max[3 * column + row] + l);
        middle[row] = hn::Mul(half, hn::Sub(hi, lo));
        middle[row] = row == column ? hn::Add(one, middle[row]) : middle[row];
        spread[row] = hn::Mul(half, hn::Add(hi, lo));
      }
      centre.Column[column] = { middle[0], middle[1], middle[2] };
      delta.Column[column] = { spread[0], spread[1], spread[2] };
    }
    VecD determinant;
    const Matrix3D adjugate = Adjugate(centre, determinant);
    const Matrix3D inverse = Scale(adjugate, hn::Div(one, determinant));
    const Matrix3D size = Absolute(inverse);
    const Matrix3D w = Multiply(size, delta);
    const auto radius = hn::Min(LargestRowSum(w), LargestColumnSum(w));
    // Also refuses what is not a number and a matrix so near to singular that its inverse is mostly
    // rounding. A negative one turns space inside out: T folds, and other points have the same
    // image.
    const MaskD regular =
      hn::And(hn::And(hn::Gt(determinant, hn::Set(d, 1e-9)), hn::Lt(determinant, hn::Set(d, 1e30))),
        hn::Lt(radius, hn::Set(d, 0.999)));
    const MaskD used = hn::FirstN(d, static_cast<std::size_t>(count - l));
    allBounded = allBounded && hn::AllTrue(d, hn::Or(regular, hn::Not(used)));

    VecD remainingDeterminant;
    const Matrix3D remaining = Adjugate(OneMinus(w), remainingDeterminant);
    const Matrix3D spread =
      Scale(Multiply(remaining, Multiply(w, size)), hn::Div(one, remainingDeterminant));
    // The arithmetic above is in double precision: its error is far below this.
    const auto roundingSlack = hn::Set(d, 1e-9);
    Matrix3D largest;
    for (int column = 0; column < 3; ++column)
    {
      const VecD middles[3] = { inverse.Column[column].x, inverse.Column[column].y,
        inverse.Column[column].z };
      const VecD spreads[3] = { spread.Column[column].x, spread.Column[column].y,
        spread.Column[column].z };
      VecD most[3];
      for (int row = 0; row < 3; ++row)
      {
        const auto magnitude = hn::Abs(middles[row]);
        const auto reach = hn::Add(spreads[row], hn::Mul(roundingSlack, hn::Add(one, magnitude)));
        most[row] = hn::Add(magnitude, reach);
        auto lower = hn::Sub(reach, middles[row]);
        auto upper = hn::Add(reach, middles[row]);
        if (mirrored)
        {
          const auto diagonal = hn::Set(d, row == column ? 2.0 : 0.0);
          const auto swapped = lower;
          lower = hn::Sub(upper, diagonal);
          upper = hn::Add(swapped, diagonal);
        }
        StoreRoundedUp(hn::IfThenElse(regular, lower, unbounded), negatedMin[3 * column + row] + l);
        StoreRoundedUp(hn::IfThenElse(regular, upper, unbounded), max[3 * column + row] + l);
      }
      largest.Column[column] = { most[0], most[1], most[2] };
    }
    // |A|_2 <= sqrt(|A|_1 |A|_inf) and <= the Frobenius norm.
    const auto frobenius = hn::Add(Dot(largest.Column[0], largest.Column[0]),
      hn::Add(
        Dot(largest.Column[1], largest.Column[1]), Dot(largest.Column[2], largest.Column[2])));
    const auto alpha =
      hn::Sqrt(hn::Min(frobenius, hn::Mul(LargestRowSum(largest), LargestColumnSum(largest))));
    // From T(Q(t)) = P + t d: J Q'' = -T2[Q', Q'] and J Q''' = -T3[Q', Q', Q'] - 3 T2[Q', Q''].
    const auto t2 = LoadPromoted(second.Norm + l);
    const auto t3 = LoadPromoted(third.Norm + l);
    const auto alpha3 = hn::Mul(alpha, hn::Mul(alpha, alpha));
    // The same component by component: much closer where the deformation has a direction, as most
    // have, and never the only bound. |Q'_i| is at most the length of row i of J^-1.
    const Vector3D* columns = largest.Column;
    const Vector3D speed{ Length({ columns[0].x, columns[1].x, columns[2].x }),
      Length({ columns[0].y, columns[1].y, columns[2].y }),
      Length({ columns[0].z, columns[1].z, columns[2].z }) };
    const Vector3D turn = Multiply(largest, ApplySecond(second, l, speed, speed));
    const Vector3D bend = ApplySecond(second, l, speed, turn);
    Vector3D cube = ApplyThird(third, l, speed);
    cube = { hn::MulAdd(three, bend.x, cube.x), hn::MulAdd(three, bend.y, cube.y),
      hn::MulAdd(three, bend.z, cube.z) };
    const Vector3D twist = Multiply(largest, cube);
    const auto secondMost = hn::Min(hn::Mul(alpha3, t2), Length(turn));
    const auto thirdMost = hn::Min(
      hn::Mul(hn::Mul(alpha, alpha3), hn::MulAdd(hn::Mul(three, alpha), hn::Mul(t2, t2), t3)),
      Length(twist));
    StoreRoundedUp(
      hn::IfThenElse(regular, secondMost, unbounded), bounds.Value[SubCellBounds::Second] + l);
    StoreRoundedUp(
      hn::IfThenElse(regular, thirdMost, unbounded), bounds.Value[SubCellBounds::Third] + l);
  }
  return allBounded;
}

/// Replace the bounds of D's Jacobian by those of I + D's, or `negate`, I - D's.
inline void AddIdentity(bool negate, BoundsBlock& bounds)
{
  const TagD d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int entry = 0; entry < 9; ++entry)
  {
    const auto unit = hn::Set(d, entry % 4 == 0 ? 1.0 : 0.0);
    float* negatedMin = bounds.Value[SubCellBounds::NegatedJacobianMin + entry];
    float* max = bounds.Value[SubCellBounds::JacobianMax + entry];
    for (int l = 0; l < BlockLanes; l += step)
    {
      const auto lower = LoadPromoted((negate ? max : negatedMin) + l);
      const auto upper = LoadPromoted((negate ? negatedMin : max) + l);
      StoreRoundedUp(hn::Sub(lower, unit), negatedMin + l);
      StoreRoundedUp(hn::Add(upper, unit), max + l);
    }
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
