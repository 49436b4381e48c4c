// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FFDSubCellBounds.cxx"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
#include <hwy/highway.h>

#include "FFDSubCellBounds.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#ifndef FFDSubCellBounds_cxx
#define FFDSubCellBounds_cxx
namespace ffd
{
namespace
{

/// Lanes per block on every target, so that buffers have a fixed size.
constexpr int BlockLanes = 16;

/// How the four Bezier coefficients of a (sub-)cell of one axis follow from control points
/// Base ... Base + 3 (in padded indices).
struct AxisPiece
{
  int Base = 0;
  float Weight[4][4] = {};
};

/// Everything the SIMD code needs, coefficients divided by their largest magnitude.
struct BoundsInput
{
  glm::ivec3 Padded;
  const float* Coefficients; ///< [component][z][y][x], x padded to RowLength
  int RowLength;
  int Lanes; ///< cells of x including the two constant ones
  const float* LaneScale; ///< per lane, 0 where the outside of x is zero
  float CoefficientScale; ///< largest magnitude of a coefficient, rounded up
  float InverseLength[3]; ///< smallest spacing over the spacing of each axis, <= 1
  float SecondScale;      ///< from derivatives in units of that smallest spacing
  float ThirdScale;
  float RangeScale[4]; ///< of a normalised value and of first differences along x, y, z
  bool Mirrored[4];    ///< negative spacing: minimum and maximum of the derivative swap
  float Shift[3];      ///< constant part of the field, not in Coefficients
  const std::vector<AxisPiece>* Half[3]; ///< per sub-cell of y, z
  const std::vector<AxisPiece>* Full[3]; ///< per cell of y, z, the constant ones included
};

} // namespace
} // namespace ffd
#endif

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, BlockLanes>;

/// 3 components of a net of up to 4^3 coefficients, [component][z][y][x][lane].
struct Net
{
  HWY_ALIGN float Value[3 * 64 * BlockLanes];
};

/// Contract y and z: rows[c][bz][by][x] for all x of one (y piece, z piece).
HWY_INLINE void ContractPlane(const BoundsInput& in, const AxisPiece& piece, float* plane)
{
  const std::ptrdiff_t slice = static_cast<std::ptrdiff_t>(in.Padded.y) * in.RowLength;
  for (int c = 0; c < 3; ++c)
  {
    const float* from = in.Coefficients + (c * in.Padded.z + piece.Base) * slice;
    for (int b = 0; b < 4; ++b)
    {
      const float* w = piece.Weight[b];
      float* to = plane + (c * 4 + b) * slice;
      for (std::ptrdiff_t i = 0; i < slice; ++i)
      {
        to[i] = w[0] * from[i] + w[1] * from[i + slice] + w[2] * from[i + 2 * slice] +
          w[3] * from[i + 3 * slice];
      }
    }
  }
}

HWY_INLINE void ContractRows(
  const BoundsInput& in, const AxisPiece& piece, const float* plane, float* rows)
{
  const std::ptrdiff_t n = in.RowLength;
  for (int cz = 0; cz < 12; ++cz)
  {
    const float* from = plane + (static_cast<std::ptrdiff_t>(cz) * in.Padded.y + piece.Base) * n;
    for (int b = 0; b < 4; ++b)
    {
      const float* w = piece.Weight[b];
      float* to = rows + (cz * 4 + b) * n;
      // What follows stays zero: room for whole vectors only.
      for (std::ptrdiff_t i = 0; i < in.Lanes + 3; ++i)
      {
        to[i] = w[0] * from[i] + w[1] * from[i + n] + w[2] * from[i + 2 * n] + w[3] * from[i + 3 * n];
      }
    }
  }
}

enum class Part
{
  Whole,
  Left,
  Right
};

/// Bezier coefficients along x of a block of cells, whole or one half of each.
template <Part part>
HWY_INLINE void ContractBlock(const BoundsInput& in, const float* rows, int lane0, Net& net)
{
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto sixth = hn::Set(d, 1.0f / 6.0f);
  const auto third = hn::Set(d, 1.0f / 3.0f);
  const auto two = hn::Set(d, 2.0f);
  const auto three = hn::Set(d, 3.0f);
  const auto four = hn::Set(d, 4.0f);
  const auto half = hn::Set(d, 0.5f);
  const auto quarter = hn::Set(d, 0.25f);
  const auto eighth = hn::Set(d, 0.125f);
  for (int row = 0; row < 48; ++row)
  {
    const float* from = rows + static_cast<std::ptrdiff_t>(row) * in.RowLength + lane0;
    float* to = net.Value + static_cast<std::ptrdiff_t>(row) * 4 * BlockLanes;
    for (int l = 0; l < BlockLanes; l += step)
    {
      const auto scale = hn::LoadU(d, in.LaneScale + lane0 + l);
      const auto c0 = hn::Mul(hn::LoadU(d, from + l), scale);
      const auto c1 = hn::Mul(hn::LoadU(d, from + l + 1), scale);
      const auto c2 = hn::Mul(hn::LoadU(d, from + l + 2), scale);
      const auto c3 = hn::Mul(hn::LoadU(d, from + l + 3), scale);
      const auto b0 = hn::Mul(hn::Add(hn::MulAdd(four, c1, c0), c2), sixth);
      const auto b1 = hn::Mul(hn::MulAdd(two, c1, c2), third);
      const auto b2 = hn::Mul(hn::MulAdd(two, c2, c1), third);
      const auto b3 = hn::Mul(hn::Add(hn::MulAdd(four, c2, c1), c3), sixth);
      const auto middle = hn::Mul(hn::Add(hn::MulAdd(three, hn::Add(b1, b2), b0), b3), eighth);
      if (part == Part::Whole)
      {
        hn::Store(b0, d, to + l);
        hn::Store(b1, d, to + BlockLanes + l);
        hn::Store(b2, d, to + 2 * BlockLanes + l);
        hn::Store(b3, d, to + 3 * BlockLanes + l);
      }
      else if (part == Part::Left)
      {
        hn::Store(b0, d, to + l);
        hn::Store(hn::Mul(hn::Add(b0, b1), half), d, to + BlockLanes + l);
        hn::Store(
          hn::Mul(hn::Add(hn::MulAdd(two, b1, b0), b2), quarter), d, to + 2 * BlockLanes + l);
        hn::Store(middle, d, to + 3 * BlockLanes + l);
      }
      else
      {
        hn::Store(middle, d, to + l);
        hn::Store(
          hn::Mul(hn::Add(hn::MulAdd(two, b2, b1), b3), quarter), d, to + BlockLanes + l);
        hn::Store(hn::Mul(hn::Add(b2, b3), half), d, to + 2 * BlockLanes + l);
        hn::Store(b3, d, to + 3 * BlockLanes + l);
      }
    }
  }
}

/// Range of one component of the net and of its first differences along x, y, z.
struct ComponentRange
{
  HWY_ALIGN float Min[4][BlockLanes]; ///< value, x, y, z
  HWY_ALIGN float Max[4][BlockLanes];
};

HWY_INLINE void FindRange(const float* net, ComponentRange& range)
{
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  // Element strides of a step along x, y, z.
  constexpr int strides[3] = { BlockLanes, 4 * BlockLanes, 16 * BlockLanes };
  for (int l = 0; l < BlockLanes; l += step)
  {
    const float* base = net + l;
    // Four chains each: one would wait for the latency of every minimum.
    auto lo0 = hn::Load(d, base);
    auto lo1 = hn::Load(d, base + BlockLanes);
    auto lo2 = hn::Load(d, base + 2 * BlockLanes);
    auto lo3 = hn::Load(d, base + 3 * BlockLanes);
    auto hi0 = lo0;
    auto hi1 = lo1;
    auto hi2 = lo2;
    auto hi3 = lo3;
    for (int i = 4; i < 64; i += 4)
    {
      const float* four = base + i * BlockLanes;
      const auto v0 = hn::Load(d, four);
      const auto v1 = hn::Load(d, four + BlockLanes);
      const auto v2 = hn::Load(d, four + 2 * BlockLanes);
      const auto v3 = hn::Load(d, four + 3 * BlockLanes);
      lo0 = hn::Min(lo0, v0);
      lo1 = hn::Min(lo1, v1);
      lo2 = hn::Min(lo2, v2);
      lo3 = hn::Min(lo3, v3);
      hi0 = hn::Max(hi0, v0);
      hi1 = hn::Max(hi1, v1);
      hi2 = hn::Max(hi2, v2);
      hi3 = hn::Max(hi3, v3);
    }
    const auto lo = hn::Min(hn::Min(lo0, lo1), hn::Min(lo2, lo3));
    const auto hi = hn::Max(hn::Max(hi0, hi1), hn::Max(hi2, hi3));
    hn::Store(lo, d, range.Min[0] + l);
    hn::Store(hi, d, range.Max[0] + l);
    for (int a = 0; a < 3; ++a)
    {
      const int along = strides[a];
      const int other1 = strides[(a + 1) % 3];
      const int other2 = strides[(a + 2) % 3];
      auto least = hn::Set(d, std::numeric_limits<float>::max());
      auto most = hn::Neg(least);
      for (int j = 0; j < 4; ++j)
      {
        for (int i = 0; i < 4; ++i)
        {
          const float* row = base + i * other1 + j * other2;
          const auto v0 = hn::Load(d, row);
          const auto v1 = hn::Load(d, row + along);
          const auto v2 = hn::Load(d, row + 2 * along);
          const auto v3 = hn::Load(d, row + 3 * along);
          const auto e0 = hn::Sub(v1, v0);
          const auto e1 = hn::Sub(v2, v1);
          const auto e2 = hn::Sub(v3, v2);
          least = hn::Min(least, hn::Min(e0, hn::Min(e1, e2)));
          most = hn::Max(most, hn::Max(e0, hn::Max(e1, e2)));
        }
      }
      hn::Store(least, d, range.Min[a + 1] + l);
      hn::Store(most, d, range.Max[a + 1] + l);
    }
  }
}

/// A derivative of a tricubic: differences of order X, Y, Z, which leave this many coefficients.
template <int X, int Y, int Z>
struct Order
{
  static constexpr int Size[3] = { 4 - X, 4 - Y, 4 - Z };
  template <int Axis>
  using Next = Order<X + (Axis == 0), Y + (Axis == 1), Z + (Axis == 2)>;
  /// Number of times the derivative occurs in the full symmetric tensor: (X+Y+Z)! / (X! Y! Z!).
  static constexpr double Copies()
  {
    constexpr double factorial[4] = { 1.0, 1.0, 2.0, 6.0 };
    return factorial[X + Y + Z] / (factorial[X] * factorial[Y] * factorial[Z]);
  }
  /// From differences of Bezier coefficients to the derivative, unit spacing.
  static constexpr double Factor()
  {
    constexpr double falling[4] = { 1.0, 3.0, 6.0, 6.0 };
    return falling[X] * falling[Y] * falling[Z];
  }
};

constexpr int AxisStride[3] = { BlockLanes, 4 * BlockLanes, 16 * BlockLanes };

/// Differences of a net along an axis; `From` is the order of the net.
template <class From, int Axis>
HWY_INLINE void Difference(const Net& from, Net& to)
{
  using To = typename From::template Next<Axis>;
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int row = 0; row < 3 * To::Size[2]; ++row)
  {
    const std::ptrdiff_t plane =
      static_cast<std::ptrdiff_t>(row / To::Size[2] * 4 + row % To::Size[2]) * AxisStride[2];
    for (int y = 0; y < To::Size[1]; ++y)
    {
      for (int x = 0; x < To::Size[0]; ++x)
      {
        const std::ptrdiff_t at = plane + y * AxisStride[1] + x * AxisStride[0];
        for (int l = 0; l < BlockLanes; l += step)
        {
          const float* v = from.Value + at + l;
          hn::Store(hn::Sub(hn::Load(d, v + AxisStride[Axis]), hn::Load(d, v)), d, to.Value + at + l);
        }
      }
    }
  }
}

/// Largest length of the vectors of a difference of a net, and largest magnitude of each of their
/// components; norms are convex, so these bound them over the cell.
template <class From, int Axis>
HWY_INLINE void LargestDifference(
  const Net& from, float* length, float (*components)[BlockLanes])
{
  using To = typename From::template Next<Axis>;
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int l = 0; l < BlockLanes; l += step)
  {
    auto most = hn::Zero(d);
    auto mostA = most;
    auto mostB = most;
    auto mostC = most;
    for (int z = 0; z < To::Size[2]; ++z)
    {
      for (int y = 0; y < To::Size[1]; ++y)
      {
        for (int x = 0; x < To::Size[0]; ++x)
        {
          const float* v =
            from.Value + z * AxisStride[2] + y * AxisStride[1] + x * AxisStride[0] + l;
          const float* w = v + AxisStride[Axis];
          const auto a = hn::Sub(hn::Load(d, w), hn::Load(d, v));
          const auto b =
            hn::Sub(hn::Load(d, w + 64 * BlockLanes), hn::Load(d, v + 64 * BlockLanes));
          const auto c =
            hn::Sub(hn::Load(d, w + 128 * BlockLanes), hn::Load(d, v + 128 * BlockLanes));
          most = hn::Max(most, hn::MulAdd(a, a, hn::MulAdd(b, b, hn::Mul(c, c))));
          mostA = hn::Max(mostA, hn::Abs(a));
          mostB = hn::Max(mostB, hn::Abs(b));
          mostC = hn::Max(mostC, hn::Abs(c));
        }
      }
    }
    hn::Store(hn::Sqrt(most), d, length + l);
    hn::Store(mostA, d, components[0] + l);
    hn::Store(mostB, d, components[1] + l);
    hn::Store(mostC, d, components[2] + l);
  }
}

/// Relative to coefficients of magnitude <= 1: rounding of the coefficients to float, of three
/// contractions and of the differences, counted generously.
constexpr float RoundingUnit = 1.0f / 16777216.0f; // 2^-24
constexpr float ValueSlack = 32.0f * RoundingUnit;
constexpr float FirstSlack = 80.0f * RoundingUnit;
constexpr float SecondSlack = 256.0f * RoundingUnit;
constexpr float ThirdSlack = 512.0f * RoundingUnit;

/// Ranges of normalised differences -> bounds in data units, minima negated, slack added.
HWY_INLINE void ScaleRange(const BoundsInput& in, int component, ComponentRange& range)
{
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int a = 0; a < 4; ++a)
  {
    const auto slack = hn::Set(d, a == 0 ? ValueSlack : FirstSlack);
    const auto scale = hn::Set(d, in.RangeScale[a]);
    // Of the value only: what was subtracted from the coefficients.
    const auto shift = hn::Set(d, a == 0 ? in.Shift[component] : 0.0f);
    for (int l = 0; l < BlockLanes; l += step)
    {
      auto lo = hn::Sub(slack, hn::Load(d, range.Min[a] + l));
      auto hi = hn::Add(slack, hn::Load(d, range.Max[a] + l));
      if (in.Mirrored[a])
      {
        const auto swapped = lo;
        lo = hi;
        hi = swapped;
      }
      lo = hn::Sub(hn::Mul(lo, scale), shift);
      hi = hn::Add(hn::Mul(hi, scale), shift);
      // The addition of the shift rounds.
      const auto rounding = hn::Set(d, 4.0f * RoundingUnit);
      hn::Store(hn::MulAdd(hn::Abs(lo), rounding, lo), d, range.Min[a] + l);
      hn::Store(hn::MulAdd(hn::Abs(hi), rounding, hi), d, range.Max[a] + l);
    }
  }
}

template <Part part>
HWY_INLINE void StoreRanges(const BoundsInput& in, const SubCellGrid& grid, const float* rows,
  int lane0, int sy, int sz, Net& net, SubCellBounds* bounds)
{
  ContractBlock<part>(in, rows, lane0, net);
  const int lanes = std::min(BlockLanes, in.Lanes - lane0);
  SubCellBounds* row = bounds + grid.Index(0, sy, sz);
  for (int c = 0; c < 3; ++c)
  {
    ComponentRange range;
    FindRange(net.Value + c * 64 * BlockLanes, range);
    ScaleRange(in, c, range);
    for (int l = 0; l < lanes; ++l)
    {
      // Cell lane 0 and the last one are the constant outside: a single sub-cell each.
      const int lane = lane0 + l;
      const int sx = lane == 0 ? 0 : 2 * lane - 1 + (part == Part::Right ? 1 : 0);
      if (sx >= grid.Size.x)
      {
        continue;
      }
      float* v = row[sx].Value + c;
      v[SubCellBounds::NegatedMin] = range.Min[0][l];
      v[SubCellBounds::Max] = range.Max[0][l];
      for (int a = 0; a < 3; ++a)
      {
        v[SubCellBounds::NegatedJacobianMin + 3 * a] = range.Min[a + 1][l];
        v[SubCellBounds::JacobianMax + 3 * a] = range.Max[a + 1][l];
      }
    }
  }
}

/// Derivatives of one order of a block of cells, one after the other as CellDerivatives has them.
struct DerivativeSums
{
  HWY_ALIGN float Square[BlockLanes] = {};       ///< sum of squares over the full tensor
  HWY_ALIGN float Entry[10][3][BlockLanes] = {}; ///< each derivative by component
  int Count = 0;                                 ///< derivatives so far
};

/// Square[lane] += Copies * (factor * (length of the differences + slack))^2.
template <class From, int Axis>
HWY_INLINE void AddSquare(const Net& from, float factor, float slack, DerivativeSums& sums)
{
  using To = typename From::template Next<Axis>;
  HWY_ALIGN float length[BlockLanes];
  float(*entry)[BlockLanes] = sums.Entry[sums.Count++];
  LargestDifference<From, Axis>(from, length, entry);
  const float size = factor * static_cast<float>(To::Factor());
  for (int l = 0; l < BlockLanes; ++l)
  {
    const float term = size * (length[l] + slack);
    sums.Square[l] += static_cast<float>(To::Copies()) * term * term;
    for (int component = 0; component < 3; ++component)
    {
      entry[component][l] = size * (entry[component][l] + slack);
    }
  }
}

template <class From, int Axis>
HWY_INLINE void AddThird(
  const BoundsInput& in, const Net& twice, float factor, DerivativeSums& sums)
{
  AddSquare<From, Axis>(twice, factor * in.InverseLength[Axis], ThirdSlack, sums);
}

/// Second derivatives of `first` along Axis and on to the third ones along Axis ... 2.
template <class First, int Axis>
HWY_INLINE void AddSecond(const BoundsInput& in, const Net& first, float factor, Net& twice,
  DerivativeSums& second, DerivativeSums& third)
{
  using Second = typename First::template Next<Axis>;
  const float next = factor * in.InverseLength[Axis];
  AddSquare<First, Axis>(first, next, SecondSlack, second);
  Difference<First, Axis>(first, twice);
  if constexpr (Axis == 0)
  {
    AddThird<Second, 0>(in, twice, next, third);
  }
  if constexpr (Axis <= 1)
  {
    AddThird<Second, 1>(in, twice, next, third);
  }
  AddThird<Second, 2>(in, twice, next, third);
}

/// Norm bounds of the second and third derivatives of a block of cells:
/// |sum d_a d_b H_ab| <= |d|^2 sqrt(sum |H_ab|^2) by Cauchy and Schwarz; likewise the third.
HWY_INLINE void FindHigherDerivatives(const BoundsInput& in, const Net& net,
  DerivativeSums& secondSquare, DerivativeSums& thirdSquare)
{
  Net first;
  Net twice;
  using None = Order<0, 0, 0>;
  Difference<None, 0>(net, first);
  AddSecond<Order<1, 0, 0>, 0>(in, first, in.InverseLength[0], twice, secondSquare, thirdSquare);
  AddSecond<Order<1, 0, 0>, 1>(in, first, in.InverseLength[0], twice, secondSquare, thirdSquare);
  AddSecond<Order<1, 0, 0>, 2>(in, first, in.InverseLength[0], twice, secondSquare, thirdSquare);
  Difference<None, 1>(net, first);
  AddSecond<Order<0, 1, 0>, 1>(in, first, in.InverseLength[1], twice, secondSquare, thirdSquare);
  AddSecond<Order<0, 1, 0>, 2>(in, first, in.InverseLength[1], twice, secondSquare, thirdSquare);
  Difference<None, 2>(net, first);
  AddSecond<Order<0, 0, 1>, 2>(in, first, in.InverseLength[2], twice, secondSquare, thirdSquare);
  // The sums above round, too.
  constexpr float roundUp = 1.0f + 64.0f * RoundingUnit;
  for (int l = 0; l < BlockLanes; ++l)
  {
    secondSquare.Square[l] = std::sqrt(secondSquare.Square[l]) * in.SecondScale * roundUp;
    thirdSquare.Square[l] = std::sqrt(thirdSquare.Square[l]) * in.ThirdScale * roundUp;
    for (int component = 0; component < 3; ++component)
    {
      for (int i = 0; i < secondSquare.Count; ++i)
      {
        secondSquare.Entry[i][component][l] *= in.SecondScale * roundUp;
      }
      for (int i = 0; i < thirdSquare.Count; ++i)
      {
        thirdSquare.Entry[i][component][l] *= in.ThirdScale * roundUp;
      }
    }
  }
}

HWY_INLINE void StoreDerivatives(
  const DerivativeSums& second, const DerivativeSums& third, int lane, CellDerivatives& cell)
{
  for (int component = 0; component < 3; ++component)
  {
    for (int i = 0; i < 6; ++i)
    {
      cell.Second[i][component] = second.Entry[i][component][lane];
    }
    for (int i = 0; i < 10; ++i)
    {
      cell.Third[i][component] = third.Entry[i][component][lane];
    }
  }
}

/// What weights of a slice of pieces are contracted into.
struct Slice
{
  std::vector<float> Plane;
  std::vector<float> Rows;

  explicit Slice(const BoundsInput& in)
    : Plane(12 * static_cast<std::size_t>(in.Padded.y) * static_cast<std::size_t>(in.RowLength))
    , Rows(48 * static_cast<std::size_t>(in.RowLength))
  {
  }
};

/// Ranges of D and its first derivatives over the sub-cells of slices firstZ ... endZ - 1.
void ComputeRanges(
  const BoundsInput& in, const SubCellGrid& grid, SubCellBounds* bounds, int firstZ, int endZ)
{
  Slice slice(in);
  Net net;
  for (int sz = firstZ; sz < endZ; ++sz)
  {
    ContractPlane(in, (*in.Half[2])[sz], slice.Plane.data());
    for (int sy = 0; sy < grid.Size.y; ++sy)
    {
      ContractRows(in, (*in.Half[1])[sy], slice.Plane.data(), slice.Rows.data());
      for (int lane0 = 0; lane0 < in.Lanes; lane0 += BlockLanes)
      {
        StoreRanges<Part::Left>(in, grid, slice.Rows.data(), lane0, sy, sz, net, bounds);
        StoreRanges<Part::Right>(in, grid, slice.Rows.data(), lane0, sy, sz, net, bounds);
      }
    }
  }
}

/// Second and third derivatives over the cells of slices firstZ ... endZ - 1.
void ComputeDerivatives(const BoundsInput& in, const SubCellGrid& grid, SubCellBounds* bounds,
  CellDerivatives* derivatives, int firstZ, int endZ)
{
  Slice slice(in);
  Net net;
  const int cellsY = static_cast<int>(in.Full[1]->size());
  // A cell's sub-cells along an axis; the constant outside cells have one.
  const auto begin = [](int cell) { return cell == 0 ? 0 : 2 * cell - 1; };
  for (int cz = firstZ; cz < endZ; ++cz)
  {
    ContractPlane(in, (*in.Full[2])[cz], slice.Plane.data());
    for (int cy = 0; cy < cellsY; ++cy)
    {
      ContractRows(in, (*in.Full[1])[cy], slice.Plane.data(), slice.Rows.data());
      for (int lane0 = 0; lane0 < in.Lanes; lane0 += BlockLanes)
      {
        ContractBlock<Part::Whole>(in, slice.Rows.data(), lane0, net);
        DerivativeSums second;
        DerivativeSums third;
        FindHigherDerivatives(in, net, second, third);
        const int lanes = std::min(BlockLanes, in.Lanes - lane0);
        for (int l = 0; derivatives && l < lanes; ++l)
        {
          const std::size_t cell = static_cast<std::size_t>(lane0 + l) +
            static_cast<std::size_t>(in.Lanes) *
              (static_cast<std::size_t>(cy) +
                static_cast<std::size_t>(cellsY) * static_cast<std::size_t>(cz));
          StoreDerivatives(second, third, l, derivatives[cell]);
        }
        for (int sz = begin(cz); sz < std::min(begin(cz + 1), grid.Size.z); ++sz)
        {
          for (int sy = begin(cy); sy < std::min(begin(cy + 1), grid.Size.y); ++sy)
          {
            for (int l = 0; l < lanes; ++l)
            {
              const int end = std::min(begin(lane0 + l + 1), grid.Size.x);
              for (int sx = begin(lane0 + l); sx < end; ++sx)
              {
                float* v = bounds[grid.Index(sx, sy, sz)].Value;
                v[SubCellBounds::Second] = second.Square[l];
                v[SubCellBounds::Third] = third.Square[l];
              }
            }
          }
        }
      }
    }
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffd
{
namespace
{
HWY_EXPORT(ComputeRanges);
HWY_EXPORT(ComputeDerivatives);

/// Weights from B-spline to Bezier coefficients of a cell, or of its left or right half.
void SetWeights(int part, float w[4][4])
{
  const double b[4][4] = { { 1 / 6.0, 4 / 6.0, 1 / 6.0, 0 }, { 0, 4 / 6.0, 2 / 6.0, 0 },
    { 0, 2 / 6.0, 4 / 6.0, 0 }, { 0, 1 / 6.0, 4 / 6.0, 1 / 6.0 } };
  const double split[3][4][4] = {
    { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } },
    { { 1, 0, 0, 0 }, { .5, .5, 0, 0 }, { .25, .5, .25, 0 }, { .125, .375, .375, .125 } },
    { { .125, .375, .375, .125 }, { 0, .25, .5, .25 }, { 0, 0, .5, .5 }, { 0, 0, 0, 1 } },
  };
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      double sum = 0.0;
      for (int k = 0; k < 4; ++k)
      {
        sum += split[part][i][k] * b[k][j];
      }
      w[i][j] = static_cast<float>(sum);
    }
  }
}

/// The pieces of one axis: constant outside, cells (or their halves), constant outside.
std::vector<AxisPiece> MakePieces(const SubCellGrid& grid, int axis, int piecesPerCell)
{
  const int first = grid.FirstCell[axis];
  const int cells = grid.Size[axis] / 2 - 1;
  std::vector<AxisPiece> pieces(static_cast<std::size_t>(cells * piecesPerCell + 2));
  for (int i = 0; i < cells * piecesPerCell; ++i)
  {
    AxisPiece& piece = pieces[static_cast<std::size_t>(i) + 1];
    piece.Base = first + i / piecesPerCell - 1 + BSplineField::Padding;
    SetWeights(piecesPerCell == 1 ? 0 : 1 + i % piecesPerCell, piece.Weight);
  }
  // The constant value is that of the outermost Bezier coefficient.
  AxisPiece& low = pieces.front();
  AxisPiece& high = pieces.back();
  low.Base = pieces[1].Base;
  high.Base = pieces[pieces.size() - 2].Base;
  for (int b = 0; b < 4; ++b)
  {
    std::copy_n(pieces[1].Weight[0], 4, low.Weight[b]);
    std::copy_n(pieces[pieces.size() - 2].Weight[3], 4, high.Weight[b]);
  }
  return pieces;
}

} // namespace

//------------------------------------------------------------------------------
void ComputeSubCellBounds(const BSplineField& field, const SubCellGrid& grid,
  std::vector<SubCellBounds>& bounds, std::vector<CellDerivatives>* derivatives,
  const ParallelFor& parallelFor)
{
  bounds.resize(grid.Count());
  if (derivatives)
  {
    const glm::ivec3 cells = grid.GetCells();
    derivatives->resize(static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) *
      static_cast<std::size_t>(cells.z));
  }
  // A translation has no derivatives: taken out, it costs the rest no digits of single precision.
  // Only where the field continues it outside; the weights of a point sum to one.
  glm::dvec3 shift(0.0);
  glm::dvec3 least = field.GetCoefficients().front();
  glm::dvec3 most = least;
  bool finite = true;
  bool zero = true;
  for (const glm::dvec3& c : field.GetCoefficients())
  {
    least = glm::min(least, c);
    most = glm::max(most, c);
    finite = finite && std::isfinite(c.x + c.y + c.z);
    zero = zero && c == glm::dvec3(0.0);
  }
  if (finite && field.GetBorder() == BorderMode::Edge)
  {
    shift = glm::dvec3(glm::vec3(0.5 * least + 0.5 * most));
  }
  const glm::dvec3 extent = glm::max(glm::abs(least - shift), glm::abs(most - shift));
  const double largest = std::max({ extent.x, extent.y, extent.z });
  const glm::dvec3 inverse = glm::abs(1.0 / field.GetSpacing());
  const double steepest = std::max({ 1.0, inverse.x, inverse.y, inverse.z });
  // Far below the range of single precision, which a third derivative must not leave.
  constexpr double limit = 1e30;
  const glm::dvec3 offset = glm::abs(shift);
  if (zero || !finite || !(largest * steepest * steepest * steepest < limit) ||
    !(std::max({ offset.x, offset.y, offset.z }) < limit))
  {
    SubCellBounds all;
    std::fill_n(
      all.Value, SubCellBounds::Size, zero ? 0.0f : std::numeric_limits<float>::infinity());
    std::fill(bounds.begin(), bounds.end(), all);
    if (derivatives)
    {
      CellDerivatives cell;
      std::fill_n(&cell.Second[0][0], 18, all.Value[0]);
      std::fill_n(&cell.Third[0][0], 30, all.Value[0]);
      std::fill(derivatives->begin(), derivatives->end(), cell);
    }
    return;
  }

  BoundsInput in;
  in.Padded = field.GetPaddedNodes();
  in.Lanes = grid.Size.x / 2 + 1;
  // Room for the last block of lanes and the three further control points of its last cell.
  in.RowLength = ((in.Lanes + BlockLanes - 1) / BlockLanes + 1) * BlockLanes;
  // Not smaller than what keeps the scaled bounds normal numbers.
  in.CoefficientScale = std::nextafter(
    static_cast<float>(std::max(largest, 1e-30)), std::numeric_limits<float>::infinity());
  const double shortest = std::max({ inverse.x, inverse.y, inverse.z });
  in.SecondScale = static_cast<float>(in.CoefficientScale * shortest * shortest);
  in.ThirdScale = static_cast<float>(in.CoefficientScale * shortest * shortest * shortest);
  in.RangeScale[0] = in.CoefficientScale;
  in.Mirrored[0] = false;
  for (int a = 0; a < 3; ++a)
  {
    // Three times the difference over half a spacing.
    const double factor = 6.0 / field.GetSpacing()[a];
    in.InverseLength[a] = static_cast<float>(inverse[a] / shortest);
    in.RangeScale[a + 1] = static_cast<float>(std::abs(factor) * in.CoefficientScale);
    in.Mirrored[a + 1] = factor < 0.0;
    in.Shift[a] = static_cast<float>(shift[a]);
  }

  const std::size_t row = static_cast<std::size_t>(in.RowLength);
  const std::size_t slice = row * static_cast<std::size_t>(in.Padded.y);
  const std::size_t volume = slice * static_cast<std::size_t>(in.Padded.z);
  std::vector<float> coefficients(3 * volume, 0.0f);
  for (int k = 0; k < in.Padded.z; ++k)
  {
    for (int j = 0; j < in.Padded.y; ++j)
    {
      for (int l = 0; l < in.Lanes + 3; ++l)
      {
        // Lane l is cell FirstCell - 1 + l, which begins with the control point before it. The
        // outside cells continue the outermost coefficient: constant, as the field there.
        const int i = std::clamp(grid.FirstCell.x - 2 + l, -BSplineField::Padding,
          field.GetNodes().x - 1 + BSplineField::Padding);
        const glm::dvec3& c =
          field.Coefficient(i, j - BSplineField::Padding, k - BSplineField::Padding);
        for (int a = 0; a < 3; ++a)
        {
          coefficients[static_cast<std::size_t>(a) * volume + static_cast<std::size_t>(k) * slice +
            static_cast<std::size_t>(j) * row + static_cast<std::size_t>(l)] =
            static_cast<float>((c[a] - shift[a]) / in.CoefficientScale);
        }
      }
    }
  }
  in.Coefficients = coefficients.data();

  // Odd reflection leaves non-zero control points next to the outside, which is zero.
  std::vector<float> laneScale(row, 1.0f);
  if (field.GetBorder() == BorderMode::ZeroAtBorder && field.GetNodes().x > 1)
  {
    laneScale[0] = 0.0f;
    laneScale[static_cast<std::size_t>(in.Lanes) - 1] = 0.0f;
  }
  in.LaneScale = laneScale.data();

  const std::vector<AxisPiece> halfY = MakePieces(grid, 1, 2);
  const std::vector<AxisPiece> halfZ = MakePieces(grid, 2, 2);
  const std::vector<AxisPiece> fullY = MakePieces(grid, 1, 1);
  const std::vector<AxisPiece> fullZ = MakePieces(grid, 2, 1);
  in.Half[0] = nullptr;
  in.Half[1] = &halfY;
  in.Half[2] = &halfZ;
  in.Full[0] = nullptr;
  in.Full[1] = &fullY;
  in.Full[2] = &fullZ;
  RunFor(parallelFor, static_cast<std::size_t>(grid.Size.z),
    [&](std::size_t first, std::size_t last)
    {
      HWY_DYNAMIC_DISPATCH(ComputeRanges)(
        in, grid, bounds.data(), static_cast<int>(first), static_cast<int>(last));
    });
  RunFor(parallelFor, fullZ.size(),
    [&](std::size_t first, std::size_t last)
    {
      HWY_DYNAMIC_DISPATCH(ComputeDerivatives)(in, grid, bounds.data(),
        derivatives ? derivatives->data() : nullptr, static_cast<int>(first),
        static_cast<int>(last));
    });
}

} // namespace ffd
#endif
