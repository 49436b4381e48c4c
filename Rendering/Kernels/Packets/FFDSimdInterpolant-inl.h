// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Interpolation over a square of pixels and along its rays. Included once per target of Highway.
#if defined(FFD_SIMD_INTERPOLANT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_INTERPOLANT_INL_H_
#undef FFD_SIMD_INTERPOLANT_INL_H_
#else
#define FFD_SIMD_INTERPOLANT_INL_H_
#endif

#include "FFDTileSegment.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Cubic Lagrange weights at u in [0, 3] for nodes 0, 1, 2, 3.
HWY_INLINE void LagrangeWeights(Vf u, Vf w[4])
{
  const Vf b = hn::Sub(u, Splat(1.0f));
  const Vf c = hn::Sub(u, Splat(2.0f));
  const Vf e = hn::Sub(u, Splat(3.0f));
  const Vf sixth = Splat(1.0f / 6.0f);
  const Vf half = Splat(0.5f);
  w[0] = hn::Neg(hn::Mul(hn::Mul(sixth, b), hn::Mul(c, e)));
  w[1] = hn::Mul(hn::Mul(half, u), hn::Mul(c, e));
  w[2] = hn::Neg(hn::Mul(hn::Mul(half, u), hn::Mul(b, e)));
  w[3] = hn::Mul(hn::Mul(sixth, u), hn::Mul(b, c));
}

/// The derivatives of LagrangeWeights() by u.
HWY_INLINE void LagrangeSlopes(Vf u, Vf w[4])
{
  const Vf b = hn::Sub(u, Splat(1.0f));
  const Vf c = hn::Sub(u, Splat(2.0f));
  const Vf e = hn::Sub(u, Splat(3.0f));
  const auto pairs = [](Vf x, Vf y, Vf z) {
    return hn::MulAdd(x, y, hn::MulAdd(x, z, hn::Mul(y, z)));
  };
  const Vf sixth = Splat(1.0f / 6.0f);
  const Vf half = Splat(0.5f);
  w[0] = hn::Neg(hn::Mul(sixth, pairs(b, c, e)));
  w[1] = hn::Mul(half, pairs(u, c, e));
  w[2] = hn::Neg(hn::Mul(half, pairs(u, b, e)));
  w[3] = hn::Mul(sixth, pairs(u, b, c));
}

/// Weights of four nodes along one axis for four targets.
using AxisMatrix = float[4][4]; // [target][node]

/// Interpolates the values of 4 x 4 targets from those of 4 x 4 nodes.
HWY_INLINE void TransformNodes(
  const float* nodes, const AxisMatrix& x, const AxisMatrix& y, float* targets)
{
  const hn::CappedTag<float, 4> d4;
  HWY_ALIGN float byNode[4][4]; // of x, by node
  for (int i = 0; i < 4; ++i)
  {
    for (int a = 0; a < 4; ++a)
    {
      byNode[i][a] = x[a][i];
    }
  }
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d4))
  {
    const auto rowOf = [&](const float* row) {
      auto sum = hn::Mul(hn::Set(d4, row[0]), hn::Load(d4, byNode[0] + c));
      sum = hn::MulAdd(hn::Set(d4, row[1]), hn::Load(d4, byNode[1] + c), sum);
      sum = hn::MulAdd(hn::Set(d4, row[2]), hn::Load(d4, byNode[2] + c), sum);
      return hn::MulAdd(hn::Set(d4, row[3]), hn::Load(d4, byNode[3] + c), sum);
    };
    const auto r0 = rowOf(nodes);
    const auto r1 = rowOf(nodes + 4);
    const auto r2 = rowOf(nodes + 8);
    const auto r3 = rowOf(nodes + 12);
    for (int b = 0; b < 4; ++b)
    {
      auto sum = hn::Mul(hn::Set(d4, y[b][0]), r0);
      sum = hn::MulAdd(hn::Set(d4, y[b][1]), r1, sum);
      sum = hn::MulAdd(hn::Set(d4, y[b][2]), r2, sum);
      sum = hn::MulAdd(hn::Set(d4, y[b][3]), r3, sum);
      hn::Store(sum, d4, targets + 4 * b + c);
    }
  }
}

HWY_INLINE void TransformNodes(
  const NodeVectors& nodes, const AxisMatrix& x, const AxisMatrix& y, NodeVectors& targets)
{
  for (int a = 0; a < 3; ++a)
  {
    TransformNodes(nodes[a].data(), x, y, targets[a].data());
  }
}

/// Takes the values at the four nodes of a cubic to its Bezier coefficients.
constexpr AxisMatrix ToBezier = { { 1.0f, 0.0f, 0.0f, 0.0f },
  { -5.0f / 6.0f, 3.0f, -1.5f, 1.0f / 3.0f }, { 1.0f / 3.0f, -1.5f, 3.0f, -5.0f / 6.0f },
  { 0.0f, 0.0f, 0.0f, 1.0f } };

/// The cubic Lagrange weight of node i at u in [0, 3], one number.
constexpr float LagrangeWeight(int i, float u)
{
  float w = 1.0f;
  for (int m = 0; m < 4; ++m)
  {
    w *= m == i ? 1.0f : (u - static_cast<float>(m)) / static_cast<float>(i - m);
  }
  return w;
}

/// Weights for four positions in [0, 1] of the way from the first node to the last.
struct NodePositions
{
  AxisMatrix Weight;
  explicit NodePositions(const float at[4])
  {
    for (int a = 0; a < 4; ++a)
    {
      for (int i = 0; i < 4; ++i)
      {
        this->Weight[a][i] = LagrangeWeight(i, 3.0f * at[a]);
      }
    }
  }
};

HWY_INLINE Vec3 LoadNodes(const NodeVectors& nodes, std::size_t first)
{
  const Df d;
  return { hn::Load(d, nodes[0].data() + first), hn::Load(d, nodes[1].data() + first),
    hn::Load(d, nodes[2].data() + first) };
}

HWY_INLINE void StoreNodes(const Vec3& v, NodeVectors& nodes, std::size_t first)
{
  const Df d;
  hn::Store(v.x, d, nodes[0].data() + first);
  hn::Store(v.y, d, nodes[1].data() + first);
  hn::Store(v.z, d, nodes[2].data() + first);
}

/// A polynomial of degree 4 at s, by Horner's scheme; `terms`: of s^0 to s^4.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V EvaluateQuartic(D, const V terms[TileLayers], V s)
{
  V sum = hn::MulAdd(s, terms[4], terms[3]);
  sum = hn::MulAdd(s, sum, terms[2]);
  sum = hn::MulAdd(s, sum, terms[1]);
  return hn::MulAdd(s, sum, terms[0]);
}

/// The terms of the middle curve of a block (TileSegment::MiddleTerms) from coordinate `c` on, as
/// many coordinates as D has lanes.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void LoadMiddleTerms(
  D d, const TileSegment& segment, int block, std::size_t c, V terms[TileLayers])
{
  for (std::size_t k = 0; k < TileLayers; ++k)
  {
    terms[k] = hn::Load(d, segment.MiddleTerms[k][static_cast<std::size_t>(block)].data() + c);
  }
}

/// A quartic in s: terms of s^0 to s^4.
struct Quartic
{
  Vec3 Terms[TileLayers];

  HWY_INLINE Vec3 At(Vf s) const
  {
    return MulAdd(s,
      MulAdd(
        s, MulAdd(s, MulAdd(s, this->Terms[4], this->Terms[3]), this->Terms[2]), this->Terms[1]),
      this->Terms[0]);
  }
  HWY_INLINE Vec3 Slope(Vf s) const
  {
    const Vec3 cubic =
      MulAdd(s, Scale(Splat(4.0f), this->Terms[4]), Scale(Splat(3.0f), this->Terms[3]));
    return MulAdd(s, MulAdd(s, cubic, Scale(Splat(2.0f), this->Terms[2])), this->Terms[1]);
  }
};

/// Bounds of the lengths, along each axis, of the second derivative of quartics for s from 0 to 1:
/// the largest of its Bezier coefficients.
HWY_INLINE Vec3 FindLargestCurvature(const Quartic& curve)
{
  const auto along = [&](Vf Vec3::*axis) {
    const Vf b0 = hn::Mul(Splat(2.0f), curve.Terms[2].*axis);
    const Vf b1 = hn::MulAdd(Splat(3.0f), curve.Terms[3].*axis, b0);
    const Vf b2 = hn::MulAdd(
      Splat(12.0f), curve.Terms[4].*axis, hn::MulAdd(Splat(6.0f), curve.Terms[3].*axis, b0));
    return hn::Max(hn::Abs(b0), hn::Max(hn::Abs(b1), hn::Abs(b2)));
  };
  return { along(&Vec3::x), along(&Vec3::y), along(&Vec3::z) };
}

/// A cubic in s: terms of s^0 to s^3.
struct Cubic
{
  Vec3 Terms[TileLayers - 1];

  Cubic() = default;
  /// `scale` times the derivative of a quartic.
  Cubic(const Quartic& quartic, Vf scale)
  {
    for (int k = 1; k < TileLayers; ++k)
    {
      this->Terms[k - 1] = Scale(hn::Mul(scale, Splat(static_cast<float>(k))), quartic.Terms[k]);
    }
  }

  HWY_INLINE Vec3 At(Vf s) const
  {
    return MulAdd(
      s, MulAdd(s, MulAdd(s, this->Terms[3], this->Terms[2]), this->Terms[1]), this->Terms[0]);
  }
};

HWY_INLINE Quartic LoadQuartic(const std::array<NodeVectors, TileLayers>& terms, std::size_t first)
{
  Quartic curve;
  for (int k = 0; k < TileLayers; ++k)
  {
    curve.Terms[k] = LoadNodes(terms[static_cast<std::size_t>(k)], first);
  }
  return curve;
}

/// Evaluates the quartics of all nodes at s.
HWY_INLINE void FindLayer(
  const std::array<NodeVectors, TileLayers>& terms, float s, NodeVectors& layer)
{
  for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(Df()))
  {
    StoreNodes(LoadQuartic(terms, i).At(Splat(s)), layer, i);
  }
}

/// The weighted sum of the four nodes of a row.
HWY_INLINE Vf InterpolateRow(const float* row, const Vf weights[4])
{
  Vf sum = hn::Mul(weights[0], Splat(row[0]));
  sum = hn::MulAdd(weights[1], Splat(row[1]), sum);
  sum = hn::MulAdd(weights[2], Splat(row[2]), sum);
  return hn::MulAdd(weights[3], Splat(row[3]), sum);
}

/// Finds the quartics through layers at s = 0, 1/4, 1/2, 3/4 and 1.
HWY_INLINE void FitQuartics(
  const std::array<NodeVectors, TileLayers>& layers, std::array<NodeVectors, TileLayers>& terms)
{
  // Weights of the differences to the first layer: these lose no digits.
  constexpr float weights[4][4] = { { 16.0f, -12.0f, 16.0f / 3.0f, -1.0f },
    { -208.0f / 3.0f, 76.0f, -112.0f / 3.0f, 22.0f / 3.0f },
    { 96.0f, -128.0f, 224.0f / 3.0f, -16.0f },
    { -128.0f / 3.0f, 64.0f, -128.0f / 3.0f, 32.0f / 3.0f } };
  const Df d;
  for (std::size_t a = 0; a < 3; ++a)
  {
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vf start = hn::Load(d, layers[0][a].data() + i);
      Vf difference[4];
      for (std::size_t k = 0; k < 4; ++k)
      {
        difference[k] = hn::Sub(hn::Load(d, layers[k + 1][a].data() + i), start);
      }
      hn::Store(start, d, terms[0][a].data() + i);
      for (std::size_t k = 0; k < 4; ++k)
      {
        Vf sum = hn::Mul(Splat(weights[k][0]), difference[0]);
        sum = hn::MulAdd(Splat(weights[k][1]), difference[1], sum);
        sum = hn::MulAdd(Splat(weights[k][2]), difference[2], sum);
        sum = hn::MulAdd(Splat(weights[k][3]), difference[3], sum);
        hn::Store(sum, d, terms[k + 1][a].data() + i);
      }
    }
  }
}

/// Extends a range by the 16 values of a component.
HWY_INLINE void ExtendRange(const float* values, float& low, float& high)
{
  const Df d;
  for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
  {
    const Vf v = hn::Load(d, values + i);
    low = std::min(low, SmallestLane(v));
    high = std::max(high, LargestLane(v));
  }
}

/// Finds the Bezier coefficients, for s from 0 to 1, of quartics: terms of s^0 to s^4.
HWY_INLINE void FindBezier(const Vf terms[TileLayers], Vf coefficients[TileLayers])
{
  const Vf b0 = terms[0], b1 = terms[1], b2 = terms[2], b3 = terms[3], b4 = terms[4];
  coefficients[0] = b0;
  coefficients[1] = hn::MulAdd(Splat(0.25f), b1, b0);
  coefficients[2] = hn::MulAdd(Splat(1.0f / 6.0f), b2, hn::MulAdd(Splat(0.5f), b1, b0));
  coefficients[3] =
    hn::MulAdd(Splat(0.25f), b3, hn::MulAdd(Splat(0.5f), b2, hn::MulAdd(Splat(0.75f), b1, b0)));
  coefficients[4] = hn::Add(hn::Add(hn::Add(b0, b1), hn::Add(b2, b3)), b4);
}

/// The Bezier coefficients of an interpolant, in whose convex hull it runs.
struct BezierHull
{
  alignas(64) std::array<NodeVectors, TileLayers> Layers;
  float Beyond[NodesPerSide] = {}; ///< vectors are loaded from nodes on, beyond the last one
  float Low[3];                    ///< the box around them
  float High[3];

  explicit BezierHull(const std::array<NodeVectors, TileLayers>& terms)
  {
    alignas(64) std::array<NodeVectors, TileLayers> b;
    for (std::size_t k = 0; k < TileLayers; ++k)
    {
      TransformNodes(terms[k], ToBezier, ToBezier, b[k]);
    }
    const Df d;
    for (std::size_t a = 0; a < 3; ++a)
    {
      for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
      {
        Vf terms[TileLayers];
        for (std::size_t k = 0; k < TileLayers; ++k)
        {
          terms[k] = hn::Load(d, b[k][a].data() + i);
        }
        Vf coefficients[TileLayers];
        FindBezier(terms, coefficients);
        for (std::size_t k = 0; k < TileLayers; ++k)
        {
          hn::Store(coefficients[k], d, this->Layers[k][a].data() + i);
        }
      }
      this->Low[a] = 1e30f;
      this->High[a] = -1e30f;
      for (const NodeVectors& layer : this->Layers)
      {
        ExtendRange(layer[a].data(), this->Low[a], this->High[a]);
      }
    }
  }

  /// The largest |dQ/dx| + |dQ/dy| by steps from the first node to the last, and the largest dQ/ds
  /// and -dQ/ds, not negative.
  void GetSpeeds(float across[3], float up[3], float down[3]) const
  {
    const Df d;
    HWY_ALIGN constexpr float hasNextInRow[TileNodes] = { 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1,
      1, 0 };
    HWY_ALIGN constexpr float hasNextRow[TileNodes] = { 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 };
    for (std::size_t a = 0; a < 3; ++a)
    {
      Vf x = hn::Zero(d);
      Vf y = hn::Zero(d);
      Vf most = hn::Zero(d);
      Vf least = hn::Zero(d);
      for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
      {
        const auto change = [d, i](const float* there, const float* shown, Vf here) {
          const Vf difference = hn::Abs(hn::Sub(hn::LoadU(d, there + i), here));
          return hn::Mul(difference, hn::Load(d, shown + i));
        };
        Vf before = hn::Load(d, this->Layers[0][a].data() + i);
        for (const NodeVectors& layer : this->Layers)
        {
          const float* const v = layer[a].data();
          const Vf here = hn::Load(d, v + i);
          x = hn::Max(x, change(v + 1, hasNextInRow, here));
          y = hn::Max(y, change(v + NodesPerSide, hasNextRow, here));
          const Vf along = hn::Sub(here, before);
          most = hn::Max(most, along);
          least = hn::Min(least, along);
          before = here;
        }
      }
      across[a] = 3.0f * (LargestLane(x) + LargestLane(y));
      up[a] = 4.0f * LargestLane(most);
      down[a] = -4.0f * SmallestLane(least);
    }
  }
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
