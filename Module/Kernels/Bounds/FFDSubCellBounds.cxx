// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSimdTargets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "Bounds/FFDSubCellBounds.cxx"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
#include <hwy/highway.h>

#include "Bounds/FFDMatrixBounds.h"
#include "Bounds/FFDSimdMatrixBounds-inl.h"
#include "Bounds/FFDSubCellBounds.h"
#include "FFDRounding.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#ifndef FFDSubCellBounds_cxx
#define FFDSubCellBounds_cxx
namespace ffd
{
namespace
{

/// Weights of control points Base ... Base + 3 (in padded indices) in the four Bezier coefficients
/// of a (sub-)cell of one axis.
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
  int Lanes;              ///< cells of x including the two constant ones
  bool ZeroOutside;       ///< the constant lanes, first and last, are zero
  float CoefficientScale; ///< largest magnitude of a coefficient, rounded up
  float RangeScale[4];    ///< of a normalized value and of first differences along x, y, z
  bool Mirrored[4];       ///< negative spacing: minimum and maximum of the derivative swap
  float Shift[3];         ///< constant part of the field, not in Coefficients
  const std::vector<AxisPiece>* Half[3]; ///< per sub-cell of y, z
};

/// Sub-cells of a cell along an axis, First ... End - 1; the constant outside cells have one.
struct SubCellsOfCell
{
  int First;
  int End;
  SubCellsOfCell(int cell, int subCells)
    : First(cell == 0 ? 0 : 2 * cell - 1)
    , End(cell == 0 ? 1 : std::min(2 * cell + 1, subCells))
  {
  }
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

/// Lanes per block on every target, so that buffers have a fixed size.
constexpr int BlockLanes = 16;
using Tag = hn::CappedTag<float, BlockLanes>;

/// Bounds over a block of sub-cells, as in SubCellBounds.
struct BoundsBlock
{
  HWY_ALIGN float Value[SubCellBounds::Size][BlockLanes];
};

/// One component of a net of up to 4^3 coefficients, [z][y][x][lane].
struct ComponentNet
{
  HWY_ALIGN float Value[64 * BlockLanes];
};

/// w[0] * from[i] + ... + w[3] * from[i + 3 * stride], for count values, which is whole vectors.
HWY_INLINE void Contract(
  const float* w, const float* from, std::ptrdiff_t stride, std::ptrdiff_t count, float* to)
{
  const Tag d;
  const auto w0 = hn::Set(d, w[0]);
  const auto w1 = hn::Set(d, w[1]);
  const auto w2 = hn::Set(d, w[2]);
  const auto w3 = hn::Set(d, w[3]);
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t i = 0; i < count; i += step)
  {
    const auto low =
      hn::MulAdd(w1, hn::LoadU(d, from + i + stride), hn::Mul(w0, hn::LoadU(d, from + i)));
    const auto high = hn::MulAdd(w2, hn::LoadU(d, from + i + 2 * stride), low);
    hn::StoreU(hn::MulAdd(w3, hn::LoadU(d, from + i + 3 * stride), high), d, to + i);
  }
}

/// Contract y and z: rows[c][bz][by][x] for all x of one (y piece, z piece).
HWY_INLINE void ContractPlane(const BoundsInput& in, const AxisPiece& piece, float* plane)
{
  const std::ptrdiff_t slice = static_cast<std::ptrdiff_t>(in.Padded.y) * in.RowLength;
  for (int c = 0; c < 3; ++c)
  {
    const float* from = in.Coefficients + (c * in.Padded.z + piece.Base) * slice;
    for (int b = 0; b < 4; ++b)
    {
      Contract(piece.Weight[b], from, slice, slice, plane + (c * 4 + b) * slice);
    }
  }
}

HWY_INLINE void ContractRows(
  const BoundsInput& in, const AxisPiece& piece, const float* plane, float* rows)
{
  const std::ptrdiff_t n = in.RowLength;
  // Room for whole vectors follows, where all is zero.
  const std::ptrdiff_t used = (in.Lanes + 3 + BlockLanes - 1) / BlockLanes * BlockLanes;
  for (int cz = 0; cz < 12; ++cz)
  {
    const float* from = plane + (static_cast<std::ptrdiff_t>(cz) * in.Padded.y + piece.Base) * n;
    for (int b = 0; b < 4; ++b)
    {
      Contract(piece.Weight[b], from, n, used, rows + (cz * 4 + b) * n);
    }
  }
}

/// Bezier coefficients along x of cells from the control points that count there.
struct Bezier
{
  hn::Vec<Tag> b0;
  hn::Vec<Tag> b1;
  hn::Vec<Tag> b2;
  hn::Vec<Tag> b3;

  HWY_INLINE explicit Bezier(const float* from)
  {
    const Tag d;
    const auto sixth = hn::Set(d, 1.0f / 6.0f);
    const auto third = hn::Set(d, 1.0f / 3.0f);
    const auto two = hn::Set(d, 2.0f);
    const auto four = hn::Set(d, 4.0f);
    const auto c0 = hn::LoadU(d, from);
    const auto c1 = hn::LoadU(d, from + 1);
    const auto c2 = hn::LoadU(d, from + 2);
    const auto c3 = hn::LoadU(d, from + 3);
    this->b0 = hn::Mul(hn::Add(hn::MulAdd(four, c1, c0), c2), sixth);
    this->b1 = hn::Mul(hn::MulAdd(two, c1, c2), third);
    this->b2 = hn::Mul(hn::MulAdd(two, c2, c1), third);
    this->b3 = hn::Mul(hn::Add(hn::MulAdd(four, c2, c1), c3), sixth);
  }
};

/// Bezier coefficients of one component of either half of a block of cells.
HWY_INLINE void ContractHalves(const BoundsInput& in, const float* rows, int lane0, int component,
  ComponentNet& left, ComponentNet& right)
{
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto two = hn::Set(d, 2.0f);
  const auto three = hn::Set(d, 3.0f);
  const auto half = hn::Set(d, 0.5f);
  const auto quarter = hn::Set(d, 0.25f);
  const auto eighth = hn::Set(d, 0.125f);
  for (int row = 0; row < 16; ++row)
  {
    const float* from =
      rows + static_cast<std::ptrdiff_t>(component * 16 + row) * in.RowLength + lane0;
    float* toLeft = left.Value + row * 4 * BlockLanes;
    float* toRight = right.Value + row * 4 * BlockLanes;
    for (int l = 0; l < BlockLanes; l += step)
    {
      const Bezier b(from + l);
      const auto middle =
        hn::Mul(hn::Add(hn::MulAdd(three, hn::Add(b.b1, b.b2), b.b0), b.b3), eighth);
      hn::Store(b.b0, d, toLeft + l);
      hn::Store(hn::Mul(hn::Add(b.b0, b.b1), half), d, toLeft + BlockLanes + l);
      hn::Store(hn::Mul(hn::Add(hn::MulAdd(two, b.b1, b.b0), b.b2), quarter), d,
        toLeft + 2 * BlockLanes + l);
      hn::Store(middle, d, toLeft + 3 * BlockLanes + l);
      hn::Store(middle, d, toRight + l);
      hn::Store(
        hn::Mul(hn::Add(hn::MulAdd(two, b.b2, b.b1), b.b3), quarter), d, toRight + BlockLanes + l);
      hn::Store(hn::Mul(hn::Add(b.b2, b.b3), half), d, toRight + 2 * BlockLanes + l);
      hn::Store(b.b3, d, toRight + 3 * BlockLanes + l);
    }
  }
}

/// Range of one component of the net and of its first differences along x, y, z.
struct ComponentRange
{
  HWY_ALIGN float Min[4][BlockLanes]; ///< value, x, y, z
  HWY_ALIGN float Max[4][BlockLanes];
};

/// Ranges of four values in a row and of their differences.
struct RowRange
{
  hn::Vec<Tag> Least;
  hn::Vec<Tag> Most;

  HWY_INLINE void IncludeDifferences(
    hn::Vec<Tag> v0, hn::Vec<Tag> v1, hn::Vec<Tag> v2, hn::Vec<Tag> v3)
  {
    const auto e0 = hn::Sub(v1, v0);
    const auto e1 = hn::Sub(v2, v1);
    const auto e2 = hn::Sub(v3, v2);
    this->Least = hn::Min(this->Least, hn::Min(e0, hn::Min(e1, e2)));
    this->Most = hn::Max(this->Most, hn::Max(e0, hn::Max(e1, e2)));
  }
  HWY_INLINE void Include(hn::Vec<Tag> v0, hn::Vec<Tag> v1, hn::Vec<Tag> v2, hn::Vec<Tag> v3)
  {
    this->Least = hn::Min(this->Least, hn::Min(hn::Min(v0, v1), hn::Min(v2, v3)));
    this->Most = hn::Max(this->Most, hn::Max(hn::Max(v0, v1), hn::Max(v2, v3)));
  }
};

HWY_INLINE void FindRange(const float* net, ComponentRange& range)
{
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  constexpr int x = BlockLanes;
  constexpr int y = 4 * BlockLanes;
  constexpr int z = 16 * BlockLanes;
  const auto most = hn::Set(d, std::numeric_limits<float>::max());
  const RowRange none{ most, hn::Neg(most) };
  for (int l = 0; l < BlockLanes; l += step)
  {
    RowRange value = none;
    RowRange alongX = none;
    RowRange alongY = none;
    RowRange alongZ = none;
    const float* plane = net + l;  // z = j
    const float* row = net + l;    // y = i of that
    const float* column = net + l; // x = i of that
    const float* depth = net + l;  // y = j and x = i
    for (int j = 0; j < 4; ++j, plane += z, column = plane)
    {
      for (int i = 0; i < 4; ++i, row += y, column += x, depth += x)
      {
        const auto v0 = hn::Load(d, row);
        const auto v1 = hn::Load(d, row + x);
        const auto v2 = hn::Load(d, row + 2 * x);
        const auto v3 = hn::Load(d, row + 3 * x);
        value.Include(v0, v1, v2, v3);
        alongX.IncludeDifferences(v0, v1, v2, v3);
        alongY.IncludeDifferences(hn::Load(d, column), hn::Load(d, column + y),
          hn::Load(d, column + 2 * y), hn::Load(d, column + 3 * y));
        alongZ.IncludeDifferences(hn::Load(d, depth), hn::Load(d, depth + z),
          hn::Load(d, depth + 2 * z), hn::Load(d, depth + 3 * z));
      }
    }
    const RowRange ranges[4] = { value, alongX, alongY, alongZ };
    for (int a = 0; a < 4; ++a)
    {
      hn::Store(ranges[a].Least, d, range.Min[a] + l);
      hn::Store(ranges[a].Most, d, range.Max[a] + l);
    }
  }
}

/// Relative to coefficients of magnitude <= 1: rounding of the coefficients to float, of three
/// contractions and of the differences, counted generously.
constexpr float RoundingUnit = 1.0f / 16777216.0f; // 2^-24
constexpr float ValueSlack = 32.0f * RoundingUnit;
constexpr float FirstSlack = 80.0f * RoundingUnit;

/// Zeros for the lanes of a block that are outside of a lattice that is zero there.
HWY_INLINE void ClearOutside(const BoundsInput& in, int lane0, float* lanes)
{
  // Odd reflection leaves non-zero control points next to the outside.
  if (in.ZeroOutside && lane0 == 0)
  {
    lanes[0] = 0.0f;
  }
  if (in.ZeroOutside && in.Lanes - 1 - lane0 < BlockLanes)
  {
    lanes[in.Lanes - 1 - lane0] = 0.0f;
  }
}

/// Ranges of normalized differences -> bounds in data units, minima negated, slack added.
HWY_INLINE void ScaleRange(
  const BoundsInput& in, int lane0, int component, ComponentRange& range, BoundsBlock& bounds)
{
  const Tag d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int a = 0; a < 4; ++a)
  {
    const int lower =
      a == 0 ? SubCellBounds::NegatedMin : SubCellBounds::NegatedJacobianMin + 3 * (a - 1);
    const int upper = a == 0 ? SubCellBounds::Max : SubCellBounds::JacobianMax + 3 * (a - 1);
    ClearOutside(in, lane0, range.Min[a]);
    ClearOutside(in, lane0, range.Max[a]);
    const auto slack = hn::Set(d, a == 0 ? ValueSlack : FirstSlack);
    const auto scale = hn::Set(d, in.RangeScale[a]);
    // The shift that was subtracted from the coefficients concerns the value only.
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
      hn::Store(hn::MulAdd(hn::Abs(lo), rounding, lo), d, bounds.Value[lower + component] + l);
      hn::Store(hn::MulAdd(hn::Abs(hi), rounding, hi), d, bounds.Value[upper + component] + l);
    }
  }
}

/// Lanes first ... end - 1 of a block: every second sub-cell from `to` on.
HWY_INLINE void StoreBounds(const BoundsBlock& bounds, int first, int end, SubCellBounds* to)
{
  int v = 0;
#if HWY_TARGET != HWY_SCALAR
  // Four by four values and lanes are transposed at once.
  const hn::FixedTag<float, 4> d;
  for (; v + 4 <= SubCellBounds::Size; v += 4)
  {
    for (int l = first / 4 * 4; l < end; l += 4)
    {
      const auto r0 = hn::Load(d, bounds.Value[v] + l);
      const auto r1 = hn::Load(d, bounds.Value[v + 1] + l);
      const auto r2 = hn::Load(d, bounds.Value[v + 2] + l);
      const auto r3 = hn::Load(d, bounds.Value[v + 3] + l);
      const auto low01 = hn::InterleaveLower(d, r0, r1);
      const auto low23 = hn::InterleaveLower(d, r2, r3);
      const auto high01 = hn::InterleaveUpper(d, r0, r1);
      const auto high23 = hn::InterleaveUpper(d, r2, r3);
      const hn::Vec<decltype(d)> lanes[4] = { hn::ConcatLowerLower(d, low23, low01),
        hn::ConcatUpperUpper(d, low23, low01), hn::ConcatLowerLower(d, high23, high01),
        hn::ConcatUpperUpper(d, high23, high01) };
      for (int i = 0; i < 4; ++i)
      {
        if (l + i >= first && l + i < end)
        {
          hn::StoreU(lanes[i], d, to[2 * (l + i - first)].Value + v);
        }
      }
    }
  }
#endif
  for (; v < SubCellBounds::Size; ++v)
  {
    for (int l = first; l < end; ++l)
    {
      to[2 * (l - first)].Value[v] = bounds.Value[v][l];
    }
  }
}

/// Stores the bounds of sub-cells.
class BoundsStore
{
public:
  BoundsStore(const SubCellGrid& grid, SubCellBounds* bounds)
    : Grid(grid)
    , Bounds(bounds)
  {
  }

  /// Whether it takes sub-cells sy, sz.
  bool Wants(int, int) const { return true; }

  /// Those of the left and right halves of cells, `all` along x with the constant ones outside.
  HWY_INLINE void Take(const BoundsBlock (&halves)[2], int lane0, int all, int sy, int sz) const
  {
    SubCellBounds* const row = this->Bounds + this->Grid.Index(0, sy, sz);
    const int lanes = std::min(BlockLanes, all - lane0);
    // The first and the last lane of all are the constant outside: a single sub-cell each.
    const int skipped = lane0 == 0 ? 1 : 0;
    const int beyond = lane0 + lanes == all ? 1 : 0;
    if (skipped > 0)
    {
      StoreBounds(halves[1], 0, 1, row);
    }
    StoreBounds(halves[0], skipped, lanes, row + 2 * (lane0 + skipped) - 1);
    StoreBounds(halves[1], skipped, lanes - beyond, row + 2 * (lane0 + skipped));
  }

private:
  const SubCellGrid& Grid;
  SubCellBounds* Bounds;
};

/// Finds bounds of the norms of the inverses of J_T over cells: the largest of their sub-cells.
class InverseNorms
{
public:
  /// `norms`: of the cells of the grid but the constant ones, x fastest; zeros.
  InverseNorms(const SubCellGrid& grid, float* norms)
    : Size((grid.Size - 2) / 2)
    , Norms(norms)
  {
  }

  bool Wants(int sy, int sz) const
  {
    return sy > 0 && sy <= 2 * this->Size.y && sz > 0 && sz <= 2 * this->Size.z;
  }

  HWY_INLINE void Take(const BoundsBlock (&halves)[2], int lane0, int all, int sy, int sz) const
  {
    const MatrixTag d;
    const hn::Rebind<float, MatrixTag> df;
    const int step = static_cast<int>(hn::Lanes(d));
    float* const row = this->Norms + GridIndex(0, (sy - 1) / 2, (sz - 1) / 2, this->Size);
    HWY_ALIGN float found[BlockLanes];
    for (int l = 0; l < BlockLanes; l += step)
    {
      const MatrixLanes largest =
        hn::Max(BoundNormOfInverses(halves[0], l), BoundNormOfInverses(halves[1], l));
      // Rounded up.
      const auto norm = hn::DemoteTo(df, hn::Mul(largest, hn::Set(d, 1.0 + 4.0 * RoundingUnit)));
      hn::StoreU(norm, df, found + l);
    }
    const int end = std::min(BlockLanes, all - 1 - lane0);
    for (int l = lane0 == 0 ? 1 : 0; l < end; ++l)
    {
      float& norm = row[lane0 + l - 1];
      norm = std::max(norm, found[l]);
    }
  }

private:
  static HWY_INLINE MatrixLanes BoundNormOfInverses(const BoundsBlock& bounds, int lane)
  {
    const MatrixTag d;
    const hn::Rebind<float, MatrixTag> df;
    const MatrixLanes half = hn::Set(d, 0.5);
    VectorMatrix center;
    VectorMatrix spread;
    for (int i = 0; i < 9; ++i)
    {
      const auto load = [&](int value) {
        return hn::PromoteTo(d, hn::LoadU(df, bounds.Value[value + i] + lane));
      };
      const MatrixLanes negated = load(SubCellBounds::NegatedJacobianMin);
      const MatrixLanes high = load(SubCellBounds::JacobianMax);
      center.Entry[i % 3][i / 3] =
        hn::MulAdd(half, hn::Sub(high, negated), hn::Set(d, i % 4 == 0 ? 1.0 : 0.0));
      spread.Entry[i % 3][i / 3] = hn::Mul(half, hn::Add(high, negated));
    }
    return BoundNormOfInverse(center, spread);
  }

  glm::ivec3 Size;
  float* Norms;
};

/// Bounds over the sub-cells of some slices of cells, for a BoundsStore or InverseNorms.
template <class Taker>
class SliceBounder
{
public:
  SliceBounder(const BoundsInput& in, const SubCellGrid& grid, const Taker& taker)
    : In(in)
    , Grid(grid)
    , Result(taker)
    , Plane(12 * static_cast<std::size_t>(in.Padded.y) * static_cast<std::size_t>(in.RowLength))
    , Rows(48 * static_cast<std::size_t>(in.RowLength))
  {
  }

  /// Sub-cells of slice cz of cells.
  void AddSlice(int cz)
  {
    const SubCellsOfCell z(cz, this->Grid.Size.z);
    for (int sz = z.First; sz < z.End; ++sz)
    {
      ContractPlane(
        this->In, (*this->In.Half[2])[static_cast<std::size_t>(sz)], this->Plane.data());
      for (int sy = 0; sy < this->Grid.Size.y; ++sy)
      {
        if (this->Result.Wants(sy, sz))
        {
          this->AddRow(sy, sz);
        }
      }
    }
  }

private:
  void AddRow(int sy, int sz)
  {
    ContractRows(this->In, (*this->In.Half[1])[static_cast<std::size_t>(sy)], this->Plane.data(),
      this->Rows.data());
    ComponentNet left;
    ComponentNet right;
    ComponentRange range;
    BoundsBlock bounds[2];
    for (int lane0 = 0; lane0 < this->In.Lanes; lane0 += BlockLanes)
    {
      for (int c = 0; c < 3; ++c)
      {
        ContractHalves(this->In, this->Rows.data(), lane0, c, left, right);
        FindRange(left.Value, range);
        ScaleRange(this->In, lane0, c, range, bounds[0]);
        FindRange(right.Value, range);
        ScaleRange(this->In, lane0, c, range, bounds[1]);
      }
      this->Result.Take(bounds, lane0, this->In.Lanes, sy, sz);
    }
  }

  const BoundsInput& In;
  const SubCellGrid& Grid;
  const Taker Result;
  std::vector<float> Plane; // what the weights of half of a slice make
  std::vector<float> Rows;  // of such a plane
};

/// Bounds over the sub-cells of cells of slices firstZ ... endZ - 1.
void BoundSlices(
  const BoundsInput& in, const SubCellGrid& grid, SubCellBounds* bounds, int firstZ, int endZ)
{
  SliceBounder<BoundsStore> bounder(in, grid, BoundsStore(grid, bounds));
  for (int cz = firstZ; cz < endZ; ++cz)
  {
    bounder.AddSlice(cz);
  }
}

/// The norms of the inverses over the cells of those slices.
void BoundInversesOfSlices(
  const BoundsInput& in, const SubCellGrid& grid, float* norms, int firstZ, int endZ)
{
  SliceBounder<InverseNorms> bounder(in, grid, InverseNorms(grid, norms));
  for (int cz = firstZ; cz < endZ; ++cz)
  {
    bounder.AddSlice(cz);
  }
}

/// See FindBezierRange() of the header.
void FindRangeOfBezier(const double* net, const BezierWeights& x, const BezierWeights& y,
  const BezierWeights& z, double range[2])
{
  const hn::CappedTag<double, 4> d;
  const int step = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN double plane[16];
  HWY_ALIGN double row[4];
  HWY_ALIGN double least[4];
  HWY_ALIGN double most[4];
  std::fill_n(least, 4, std::numeric_limits<double>::infinity());
  std::fill_n(most, 4, -std::numeric_limits<double>::infinity());
  for (int bz = 0; bz < 4; ++bz)
  {
    for (int i = 0; i < 16; i += step)
    {
      auto sum = hn::Mul(hn::Set(d, z.Weight[0][bz]), hn::LoadU(d, net + i));
      for (int k = 1; k < 4; ++k)
      {
        sum = hn::MulAdd(hn::Set(d, z.Weight[k][bz]), hn::LoadU(d, net + 16 * k + i), sum);
      }
      hn::Store(sum, d, plane + i);
    }
    for (int by = 0; by < 4; ++by)
    {
      for (int i = 0; i < 4; i += step)
      {
        auto sum = hn::Mul(hn::Set(d, y.Weight[0][by]), hn::Load(d, plane + i));
        for (int j = 1; j < 4; ++j)
        {
          sum = hn::MulAdd(hn::Set(d, y.Weight[j][by]), hn::Load(d, plane + 4 * j + i), sum);
        }
        hn::Store(sum, d, row + i);
      }
      const auto shift = hn::Set(d, y.Shift[by] + z.Shift[bz]);
      for (int i = 0; i < 4; i += step)
      {
        auto sum = hn::Mul(hn::Set(d, row[0]), hn::LoadU(d, x.Weight[0] + i));
        for (int j = 1; j < 4; ++j)
        {
          sum = hn::MulAdd(hn::Set(d, row[j]), hn::LoadU(d, x.Weight[j] + i), sum);
        }
        sum = hn::Add(hn::Add(hn::LoadU(d, x.Shift + i), shift), sum);
        hn::Store(hn::Min(hn::Load(d, least + i), sum), d, least + i);
        hn::Store(hn::Max(hn::Load(d, most + i), sum), d, most + i);
      }
    }
  }
  range[0] = std::min({ least[0], least[1], least[2], least[3] });
  range[1] = std::max({ most[0], most[1], most[2], most[3] });
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffd
{
namespace
{
HWY_EXPORT(BoundSlices);
HWY_EXPORT(BoundInversesOfSlices);
HWY_EXPORT(FindRangeOfBezier);

/// Weights from B-spline to Bezier coefficients of the lower or the upper half of a cell.
void SetWeights(int half, float w[4][4])
{
  const double b[4][4] = { { 1 / 6.0, 4 / 6.0, 1 / 6.0, 0 }, { 0, 4 / 6.0, 2 / 6.0, 0 },
    { 0, 2 / 6.0, 4 / 6.0, 0 }, { 0, 1 / 6.0, 4 / 6.0, 1 / 6.0 } };
  const double split[2][4][4] = {
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
        sum += split[half][i][k] * b[k][j];
      }
      w[i][j] = static_cast<float>(sum);
    }
  }
}

/// The pieces of one axis: constant outside, halves of cells, constant outside.
std::vector<AxisPiece> MakePieces(const SubCellGrid& grid, int axis)
{
  const int first = grid.FirstCell[axis];
  std::vector<AxisPiece> pieces(static_cast<std::size_t>(grid.Size[axis]));
  for (int i = 0; i < grid.Size[axis] - 2; ++i)
  {
    AxisPiece& piece = pieces[static_cast<std::size_t>(i) + 1];
    piece.Base = first + i / 2 - 1 + BSplineField::Padding;
    SetWeights(i % 2, piece.Weight);
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

/// Bounds the sub-cells of any slabs of a part of a field.
class SlabBounder
{
public:
  /// `cells`: the part. Keeps a reference.
  SlabBounder(const BSplineField& field, const CellRange& cells)
    : Field(field)
  {
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
    // Far below the range of single precision, which a derivative must not leave.
    constexpr double limit = 1e30;
    const glm::dvec3 offset = glm::abs(shift);
    if (zero || !finite || !(largest * steepest < limit) ||
      !(std::max({ offset.x, offset.y, offset.z }) < limit))
    {
      this->SameBound = zero ? 0.0f : std::numeric_limits<float>::infinity();
      return;
    }
    const SubCellGrid grid(cells);
    BoundsInput& in = this->Input;
    in.Padded = field.GetPaddedNodes();
    in.Lanes = grid.Size.x / 2 + 1;
    // Room for the last block of lanes and the three further control points of its last cell.
    constexpr int blockLanes = HWY_NAMESPACE::BlockLanes;
    in.RowLength = ((in.Lanes + blockLanes - 1) / blockLanes + 1) * blockLanes;
    // Not smaller than what keeps the scaled bounds normal numbers.
    in.CoefficientScale = std::nextafter(
      static_cast<float>(std::max(largest, 1e-30)), std::numeric_limits<float>::infinity());
    in.RangeScale[0] = in.CoefficientScale;
    in.Mirrored[0] = false;
    for (int a = 0; a < 3; ++a)
    {
      // Three times the difference over half a spacing.
      const double factor = 6.0 / field.GetSpacing()[a];
      in.RangeScale[a + 1] = static_cast<float>(std::abs(factor) * in.CoefficientScale);
      in.Mirrored[a + 1] = factor < 0.0;
      in.Shift[a] = static_cast<float>(shift[a]);
    }
    in.ZeroOutside = field.GetBorder() == BorderMode::ZeroAtBorder && field.GetNodes().x > 1;
    this->CopyCoefficients(grid.FirstCell.x, shift);
  }

  /// `grid`: of cells of the part, all of them along x.
  void Bound(
    const SubCellGrid& grid, SubCellBoundsVector& bounds, const ParallelFor& parallelFor) const
  {
    bounds.resize(grid.Count());
    if (this->SameBound)
    {
      SubCellBounds all;
      std::fill_n(all.Value, SubCellBounds::Size, *this->SameBound);
      std::fill(bounds.begin(), bounds.end(), all);
      return;
    }
    this->ForSlices(grid, parallelFor, [&](const BoundsInput& in, int first, int end) {
      HWY_DYNAMIC_DISPATCH(BoundSlices)(in, grid, bounds.data(), first, end);
    });
  }

  /// See ffd::BoundInverseNorms(). `grid`: as for Bound().
  void BoundInverses(
    const SubCellGrid& grid, std::vector<float>& norms, const ParallelFor& parallelFor) const
  {
    const std::size_t count = GridSize((grid.Size - 2) / 2);
    if (this->SameBound)
    {
      const float identity = RoundUp(BoundNorm({ glm::dmat3(1.0), glm::dmat3(2e-9) }));
      norms.assign(
        count, *this->SameBound == 0.0f ? identity : std::numeric_limits<float>::quiet_NaN());
      return;
    }
    norms.assign(count, 0.0f);
    this->ForSlices(grid, parallelFor, [&](const BoundsInput& in, int first, int end) {
      HWY_DYNAMIC_DISPATCH(BoundInversesOfSlices)(in, grid, norms.data(), first, end);
    });
    for (float& norm : norms)
    {
      norm = std::isfinite(norm) ? norm : std::numeric_limits<float>::quiet_NaN();
    }
  }

private:
  /// Calls work(input, first, end) for slices of cells of a grid, the constant ones included.
  template <class Work>
  void ForSlices(const SubCellGrid& grid, const ParallelFor& parallelFor, const Work& work) const
  {
    BoundsInput in = this->Input;
    const std::vector<AxisPiece> halfY = MakePieces(grid, 1);
    const std::vector<AxisPiece> halfZ = MakePieces(grid, 2);
    in.Coefficients = this->Coefficients.data();
    in.Half[0] = nullptr;
    in.Half[1] = &halfY;
    in.Half[2] = &halfZ;
    parallelFor(
      static_cast<std::size_t>(grid.GetCells().z), [&](std::size_t first, std::size_t end) {
        work(in, static_cast<int>(first), static_cast<int>(end));
      });
  }

  void CopyCoefficients(int firstCell, const glm::dvec3& shift)
  {
    const BoundsInput& in = this->Input;
    const std::size_t row = static_cast<std::size_t>(in.RowLength);
    const std::size_t slice = row * static_cast<std::size_t>(in.Padded.y);
    const std::size_t volume = slice * static_cast<std::size_t>(in.Padded.z);
    this->Coefficients.assign(3 * volume, 0.0f);
    for (int k = 0; k < in.Padded.z; ++k)
    {
      for (int j = 0; j < in.Padded.y; ++j)
      {
        for (int l = 0; l < in.Lanes + 3; ++l)
        {
          // Lane l is cell FirstCell - 1 + l, which begins with the control point before it. The
          // outside cells continue the outermost coefficient: constant, as the field there.
          const int i = std::clamp(firstCell - 2 + l, -BSplineField::Padding,
            this->Field.GetNodes().x - 1 + BSplineField::Padding);
          const glm::dvec3& c =
            this->Field.Coefficient(i, j - BSplineField::Padding, k - BSplineField::Padding);
          for (int a = 0; a < 3; ++a)
          {
            this->Coefficients[static_cast<std::size_t>(a) * volume +
              static_cast<std::size_t>(k) * slice + static_cast<std::size_t>(j) * row +
              static_cast<std::size_t>(l)] =
              static_cast<float>((c[a] - shift[a]) / in.CoefficientScale);
          }
        }
      }
    }
  }

  const BSplineField& Field;
  std::optional<float> SameBound; ///< of all sub-cells
  BoundsInput Input{};
  std::vector<float> Coefficients;
};

} // namespace

//------------------------------------------------------------------------------
void FindBezierRange(const double net[64], const BezierWeights& x, const BezierWeights& y,
  const BezierWeights& z, double range[2])
{
  HWY_DYNAMIC_DISPATCH(FindRangeOfBezier)(net, x, y, z, range);
}

//------------------------------------------------------------------------------
void ComputeSubCellBounds(const BSplineField& field, const SubCellGrid& grid,
  SubCellBoundsVector& bounds, const ParallelFor& parallelFor)
{
  const CellRange cells{ grid.FirstCell, grid.FirstCell + (grid.Size - 2) / 2 };
  SlabBounder(field, cells).Bound(grid, bounds, parallelFor);
}

//------------------------------------------------------------------------------
std::vector<float> BoundInverseNorms(
  const BSplineField& field, const CellRange& cells, const ParallelFor& parallelFor)
{
  std::vector<float> norms;
  SlabBounder(field, cells).BoundInverses(SubCellGrid(cells), norms, parallelFor);
  return norms;
}

//------------------------------------------------------------------------------
void ForSlabsOfSubCells(const BSplineField& field, const CellRange& cells,
  const ParallelFor& parallelFor,
  const std::function<void(const SubCellGrid&, const SubCellBoundsVector&)>& work)
{
  constexpr std::size_t most = std::size_t(1) << 20; // sub-cells of a slab, about 100 MB
  const glm::ivec3 size = SubCellGrid(cells).Size;
  const std::size_t slices =
    most / (static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  const int thickness =
    std::max(1, static_cast<int>(std::min<std::size_t>(slices / 2, 1 << 20)) - 1); // cells
  const SlabBounder bounder(field, cells);
  SubCellBoundsVector bounds;
  for (int z = cells.First.z; z < cells.End.z; z += thickness)
  {
    CellRange slab = cells;
    slab.First.z = z;
    slab.End.z = std::min(z + thickness, cells.End.z);
    const SubCellGrid grid(slab);
    bounder.Bound(grid, bounds, parallelFor);
    work(grid, bounds);
  }
}

} // namespace ffd
#endif
