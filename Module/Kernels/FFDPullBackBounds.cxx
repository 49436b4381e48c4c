// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBackBounds.h"

#include "FFDMatrixBounds.h"

#include "FFDJacobianDeterminant.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ffd
{
namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

Box EmptyBox() { return { glm::dvec3(Infinity), glm::dvec3(-Infinity) }; }

void Include(Box& box, const Box& other)
{
  box.Min = glm::min(box.Min, other.Min);
  box.Max = glm::max(box.Max, other.Max);
}

Box Intersect(const Box& a, const Box& b)
{
  return { glm::max(a.Min, b.Min), glm::min(a.Max, b.Max) };
}

/// Bezier coefficients of one axis over [u0, u1] of a cell from its four control points: the
/// blossom of the cell polynomial at (u0,u0,u0), (u0,u0,u1), (u0,u1,u1), (u1,u1,u1).
void SetBlossomWeights(double u0, double u1, double w[4][4])
{
  for (int b = 0; b < 4; ++b)
  {
    double c[4][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } };
    for (int level = 1; level <= 3; ++level)
    {
      const double u = level > 3 - b ? u1 : u0;
      const double span = 4 - level;
      for (int i = 0; i + level < 4; ++i)
      {
        // De Boor over the uniform knots -2 ... 3 of the cell [0, 1].
        const double lower = i + level - 3;
        const double t = (u - lower) / span;
        for (int j = 0; j < 4; ++j)
        {
          c[i][j] = (1.0 - t) * c[i][j] + t * c[i + 1][j];
        }
      }
    }
    std::copy_n(c[0], 4, w[b]);
  }
}

/// Where sub-cell i of an axis lies, data coordinates; the constant outside ones are infinite.
struct Interval
{
  double Min;
  double Max;
};

Interval GetEnds(const BSplineField& field, int axis, int i)
{
  const double h = field.GetSpacing()[axis];
  const double origin = field.GetOrigin()[axis];
  const int begin = field.GetFirstCell()[axis];
  const int size = 2 * (field.GetEndCell()[axis] - begin) + 2;
  const double lower = begin + 0.5 * (i - 1);
  const double from = origin + (i == 0 ? -Infinity : lower) * h;
  const double to = origin + (i == size - 1 ? Infinity : lower + 0.5) * h;
  return { std::min(from, to), std::max(from, to) };
}

/// The cell of a sub-cell; of the constant outside ones that beside it.
int CellOfSubCell(const BSplineField& field, int axis, int i)
{
  const int begin = field.GetFirstCell()[axis];
  return std::clamp(begin + (i - 1) / 2, begin, field.GetEndCell()[axis] - 1);
}

/// Least and largest entries of matrices, as their middle and half their difference.
struct MatrixRange
{
  glm::dmat3 Centre;
  glm::dmat3 Spread;
};

/// I + sign * dD/dp over a sub-cell.
MatrixRange GetJacobian(const SubCellBounds& bounds, double sign)
{
  MatrixRange range;
  for (int i = 0; i < 9; ++i)
  {
    const double low = -static_cast<double>(bounds.Value[SubCellBounds::NegatedJacobianMin + i]);
    const double high = bounds.Value[SubCellBounds::JacobianMax + i];
    range.Centre[i / 3][i % 3] = (i % 4 == 0 ? 1.0 : 0.0) + sign * 0.5 * (low + high);
    range.Spread[i / 3][i % 3] = 0.5 * (high - low);
  }
  return range;
}

/**
 * The inverses of all matrices of a range. With J = C + E, |E| <= Delta entry-wise, W = |C^-1|
 * Delta: J^-1 - C^-1 = -C^-1 E J^-1, so |J^-1 - C^-1| <= (W + W^2 + ...) |C^-1| = (I - W)^-1 W
 * |C^-1| when the spectral radius of W is below one; the largest row or column sum proves that.
 * Returns false where it is not shown so, and where a determinant is not positive: space is turned
 * inside out.
 */
bool FindInverse(const MatrixRange& range, MatrixRange& inverse)
{
  const double determinant = glm::determinant(range.Centre);
  // Also refuses what is not a number, and what is so near to singular that the inverse is
  // rounding.
  if (!(determinant > 1e-9 && determinant < 1e30))
  {
    return false;
  }
  inverse.Centre = glm::inverse(range.Centre);
  const glm::dmat3 size = Absolute(inverse.Centre);
  const glm::dmat3 w = size * range.Spread;
  if (!(std::min(LargestRowSum(w), LargestRowSum(glm::transpose(w))) < 0.999))
  {
    return false;
  }
  inverse.Spread = glm::inverse(glm::dmat3(1.0) - w) * w * size;
  for (int column = 0; column < 3; ++column)
  {
    constexpr double rounding = 1e-9;
    inverse.Spread[column] += rounding * (1.0 + size[column]);
  }
  return true;
}

/// Of all matrices of a range, at least: |A|_2 <= sqrt(|A|_1 |A|_inf).
double BoundNorm(const MatrixRange& range)
{
  const glm::dmat3 largest = Absolute(range.Centre) + range.Spread;
  return std::sqrt(LargestRowSum(largest) * LargestRowSum(glm::transpose(largest)));
}

/// Of |d^2 D(o + t d) / dt^2| / |d|^2 over a cell: second derivatives are convex combinations of
/// second differences of the control points that count there.
double BoundSecondDerivative(const BSplineField& field, const glm::ivec3& cell)
{
  const glm::dvec3 h = glm::abs(field.GetSpacing());
  double sum = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a; b < 3; ++b)
    {
      glm::ivec3 alongA(0);
      glm::ivec3 alongB(0);
      alongA[a] = 1;
      alongB[b] = 1;
      const glm::ivec3 end = 4 - alongA - alongB;
      double largest = 0.0;
      for (int i = 0; i < end.x * end.y * end.z; ++i)
      {
        const glm::ivec3 at =
          cell - 1 + glm::ivec3(i % end.x, i / end.x % end.y, i / (end.x * end.y));
        const auto c = [&](const glm::ivec3& n) { return field.Coefficient(n.x, n.y, n.z); };
        largest = std::max(
          largest, glm::length(c(at + alongA + alongB) - c(at + alongA) - c(at + alongB) + c(at)));
      }
      const double second = largest / (h[a] * h[b]);
      sum += (a == b ? 1.0 : 2.0) * second * second;
    }
  }
  return std::sqrt(sum);
}

/// Range of the control points, and so of D; all there is when one is not a number.
Box FindHull(const BSplineField& field)
{
  Box hull = EmptyBox();
  for (const glm::dvec3& c : field.GetCoefficients())
  {
    if (!std::isfinite(c.x + c.y + c.z))
    {
      return { glm::dvec3(-Infinity), glm::dvec3(Infinity) };
    }
    Include(hull, { c, c });
  }
  // More than what bounds over sub-cells are rounded by.
  const glm::dvec3 slack = 1e-4 * glm::max(glm::abs(hull.Min), glm::abs(hull.Max));
  return { hull.Min - slack, hull.Max + slack };
}

/// Unions of 4 neighbours along an axis; `size` is that of the grid, which becomes smaller by 3.
void UniteAlong(int axis, glm::ivec3& size, std::vector<Box>& boxes)
{
  const std::ptrdiff_t stride = axis == 0 ? 1
    : axis == 1                           ? size.x
                                          : static_cast<std::ptrdiff_t>(size.x) * size.y;
  const glm::ivec3 from = size;
  size[axis] -= 3;
  Box* to = boxes.data();
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      // In place: what is read lies at or behind what is written.
      const Box* first = boxes.data() +
        static_cast<std::ptrdiff_t>(from.x) * (j + static_cast<std::ptrdiff_t>(from.y) * k);
      for (int i = 0; i < size.x; ++i, ++first)
      {
        Box sum = *first;
        Include(sum, first[stride]);
        Include(sum, first[2 * stride]);
        Include(sum, first[3 * stride]);
        *to++ = sum;
      }
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
std::size_t PullBackBounds::CellIndex(const glm::ivec3& cell) const
{
  const glm::ivec3 at = cell - this->Field->GetFirstCell();
  const glm::ivec3 size = this->Field->GetEndCell() - this->Field->GetFirstCell();
  return static_cast<std::size_t>(at.x) +
    static_cast<std::size_t>(size.x) *
    (static_cast<std::size_t>(at.y) +
      static_cast<std::size_t>(size.y) * static_cast<std::size_t>(at.z));
}

//------------------------------------------------------------------------------
std::size_t PullBackBounds::Update(const PullBack& pullBack, const ParallelFor& parallelFor)
{
  this->Field = pullBack.IsIdentity() ? nullptr : pullBack.GetField();
  this->Kind = pullBack.GetKind();
  this->Tolerance = pullBack.GetTolerance();
  this->ProvenInvertible = true;
  if (!this->Field || !InvertsTheField(this->Kind))
  {
    this->InverseNorms.clear();
    return 0;
  }
  const BSplineField& field = *this->Field;
  const CellRange cells = this->FindChangedCells();
  const glm::ivec3 size = glm::max(cells.End - cells.First, 0);
  const std::size_t count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
    static_cast<std::size_t>(size.z);
  // Nothing is kept if memory runs out on the way.
  std::vector<float> norms = std::move(this->InverseNorms);
  this->InverseNorms.clear();
  if (count > 0)
  {
    const glm::ivec3 all = field.GetEndCell() - field.GetFirstCell();
    norms.resize(static_cast<std::size_t>(all.x) * static_cast<std::size_t>(all.y) *
      static_cast<std::size_t>(all.z));
    this->BoundInverse(cells, parallelFor, norms);
    this->NumberOfNodes = field.GetNodes();
    this->Spacing = field.GetSpacing();
    this->Border = field.GetBorder();
    this->Nodes.clear();
    for (int k = 0; k < this->NumberOfNodes.z; ++k)
    {
      for (int j = 0; j < this->NumberOfNodes.y; ++j)
      {
        const glm::dvec3* row = &field.Coefficient(0, j, k);
        this->Nodes.insert(this->Nodes.end(), row, row + this->NumberOfNodes.x);
      }
    }
  }
  this->ProveInvertible(norms);
  this->InverseNorms = std::move(norms);
  return count;
}

//------------------------------------------------------------------------------
/// The cells in which D is not what it was at the last update.
CellRange PullBackBounds::FindChangedCells() const
{
  const BSplineField& field = *this->Field;
  const glm::ivec3 nodes = field.GetNodes();
  if (this->InverseNorms.empty() || this->NumberOfNodes != nodes ||
    this->Spacing != field.GetSpacing() || this->Border != field.GetBorder())
  {
    return { field.GetFirstCell(), field.GetEndCell() };
  }
  glm::ivec3 low = nodes;
  glm::ivec3 high(-1);
  const glm::dvec3* last = this->Nodes.data();
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      const glm::dvec3* row = &field.Coefficient(0, j, k);
      for (int i = 0; i < nodes.x; ++i)
      {
        if (*last++ != row[i])
        {
          low = glm::min(low, glm::ivec3(i, j, k));
          high = glm::max(high, glm::ivec3(i, j, k));
        }
      }
    }
  }
  if (high.x < 0)
  {
    return {};
  }
  CellRange cells;
  for (int a = 0; a < 3; ++a)
  {
    // The outermost control points count in the border, too.
    cells.First[a] =
      low[a] == 0 ? field.GetFirstCell()[a] : std::max(low[a] - 2, field.GetFirstCell()[a]);
    cells.End[a] = high[a] == nodes[a] - 1 ? field.GetEndCell()[a]
                                           : std::min(high[a] + 2, field.GetEndCell()[a]);
  }
  return cells;
}

//------------------------------------------------------------------------------
void PullBackBounds::BoundInverse(
  const CellRange& cells, const ParallelFor& parallelFor, std::vector<float>& norms) const
{
  const SubCellGrid grid(cells);
  SubCellBoundsVector subCells;
  ComputeSubCellBounds(*this->Field, grid, subCells, parallelFor);
  const glm::ivec3 size = cells.End - cells.First;
  RunFor(parallelFor, static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z),
    [&](std::size_t firstRow, std::size_t endRow) {
      for (std::size_t row = firstRow; row < endRow; ++row)
      {
        glm::ivec3 at(0, static_cast<int>(row) % size.y, static_cast<int>(row) / size.y);
        for (; at.x < size.x; ++at.x)
        {
          double largest = 0.0;
          for (int i = 0; i < 8; ++i)
          {
            const glm::ivec3 s = 2 * at + 1 + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
            MatrixRange inverse;
            const bool regular =
              FindInverse(GetJacobian(subCells[grid.Index(s.x, s.y, s.z)], 1.0), inverse);
            largest = regular ? std::max(largest, BoundNorm(inverse)) : Infinity;
            if (!regular)
            {
              break;
            }
          }
          norms[this->CellIndex(cells.First + at)] = largest < Infinity
            ? std::nextafter(static_cast<float>(largest), std::numeric_limits<float>::infinity())
            : std::numeric_limits<float>::quiet_NaN();
        }
      }
    });
}

//------------------------------------------------------------------------------
/// Far from the lattice T is a translation, so it is one to one if it folds nowhere. The
/// determinant tells of the cells over which the inverse is not bounded.
void PullBackBounds::ProveInvertible(std::vector<float>& norms)
{
  const glm::ivec3 first = this->Field->GetFirstCell();
  const glm::ivec3 size = this->Field->GetEndCell() - first;
  CellRange unknown{ this->Field->GetEndCell(), first };
  std::size_t n = 0;
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      for (int i = 0; i < size.x; ++i, ++n)
      {
        if (std::isnan(norms[n]))
        {
          const glm::ivec3 cell = first + glm::ivec3(i, j, k);
          unknown.First = glm::min(unknown.First, cell);
          unknown.End = glm::max(unknown.End, cell + 1);
        }
      }
    }
  }
  if (glm::any(glm::greaterThanEqual(unknown.First, unknown.End)))
  {
    return;
  }
  constexpr double loosely = 0.1;
  this->ProvenInvertible =
    BoundJacobianDeterminant(*this->Field, unknown.First, unknown.End, loosely).Min > 0.0;
  if (this->ProvenInvertible)
  {
    std::replace_if(
      norms.begin(), norms.end(), [](float norm) { return std::isnan(norm); },
      std::numeric_limits<float>::infinity());
  }
}

//------------------------------------------------------------------------------
/// Sub-cells [first, last] per axis that touch `region`; false when there are none.
bool PullBackBounds::FindSubCells(const Box& region, glm::ivec3& first, glm::ivec3& last) const
{
  if (region.IsEmpty())
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    const double h = this->Field->GetSpacing()[a];
    double lo = (region.Min[a] - this->Field->GetOrigin()[a]) / h;
    double hi = (region.Max[a] - this->Field->GetOrigin()[a]) / h;
    if (h < 0.0)
    {
      std::swap(lo, hi);
    }
    const double begin = this->Field->GetFirstCell()[a];
    const double end = this->Field->GetEndCell()[a];
    // A face within rounding of the region counts as touched. Clamped before the cast.
    constexpr double touch = 1e-9;
    lo = std::clamp(2.0 * (lo - begin) - touch, -1.0, 2.0 * (end - begin) + 1.0);
    hi = std::clamp(2.0 * (hi - begin) + touch, -1.0, 2.0 * (end - begin));
    // Sub-cell s covers [s - 1, s]: both ends count.
    first[a] = std::max(0, static_cast<int>(std::ceil(lo)));
    last[a] = static_cast<int>(std::floor(hi)) + 1;
  }
  return true;
}

//------------------------------------------------------------------------------
bool PullBackBounds::TouchesKink(const Box& region) const
{
  if (this->Field->GetBorder() != BorderMode::ZeroAtBorder)
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    if (this->Field->GetNodes()[a] == 1)
    {
      continue;
    }
    const double h = this->Field->GetSpacing()[a];
    const double touch = 1e-9 * std::abs(h);
    for (const int cell : { this->Field->GetFirstCell()[a], this->Field->GetEndCell()[a] })
    {
      const double plane = this->Field->GetOrigin()[a] + cell * h;
      if (region.Min[a] - touch <= plane && plane <= region.Max[a] + touch)
      {
        return true;
      }
    }
  }
  return false;
}

//------------------------------------------------------------------------------
/// Bounds over the sub-cells first ... last of the field.
class PullBackBounds::SubCells
{
public:
  SubCells(const BSplineField& field, const glm::ivec3& first, const glm::ivec3& last,
    const ParallelFor& parallelFor)
    : Range(FindCells(field, first, last))
    , Grid(this->Range)
    , Shift(2 * (this->Range.First - field.GetFirstCell()))
  {
    ComputeSubCellBounds(field, this->Grid, this->Bounds, parallelFor);
  }

  const SubCellBounds& At(const glm::ivec3& s) const
  {
    const glm::ivec3 at = s - this->Shift;
    return this->Bounds[this->Grid.Index(at.x, at.y, at.z)];
  }

  Box GetDisplacement(const glm::ivec3& s) const
  {
    const SubCellBounds& bounds = this->At(s);
    Box box;
    for (int a = 0; a < 3; ++a)
    {
      box.Min[a] = -bounds.Value[SubCellBounds::NegatedMin + a];
      box.Max[a] = bounds.Value[SubCellBounds::Max + a];
    }
    return box;
  }

private:
  /// Those on either side of a part of the field are bounded with its outermost cells alone.
  static CellRange FindCells(
    const BSplineField& field, const glm::ivec3& first, const glm::ivec3& last)
  {
    CellRange cells;
    for (int a = 0; a < 3; ++a)
    {
      const auto cellOf = [&](int s) { return CellOfSubCell(field, a, s); };
      cells.First[a] = cellOf(first[a]);
      cells.End[a] = cellOf(last[a]) + 1;
    }
    return cells;
  }

  CellRange Range;
  SubCellGrid Grid;
  glm::ivec3 Shift;
  SubCellBoundsVector Bounds;
};

//------------------------------------------------------------------------------
Box PullBackBounds::DisplacementOver(const Box& region) const
{
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !this->FindSubCells(region, first, last))
  {
    return Box();
  }
  return this->UnionOfSubCells(
    first, last, [](const Box&, const Box& d) { return d; }, ParallelFor());
}

//------------------------------------------------------------------------------
/// Union of what reach(box, d) gives for the sub-cells first ... last, where `box` is where one
/// lies and `d` the range of D over it.
template <class Reach>
Box PullBackBounds::UnionOfSubCells(const glm::ivec3& first, const glm::ivec3& last,
  const Reach& reach, const ParallelFor& parallelFor) const
{
  const SubCells subCells(*this->Field, first, last, parallelFor);
  Box sum = EmptyBox();
  glm::ivec3 s;
  for (s.z = first.z; s.z <= last.z; ++s.z)
  {
    for (s.y = first.y; s.y <= last.y; ++s.y)
    {
      for (s.x = first.x; s.x <= last.x; ++s.x)
      {
        Box box;
        for (int a = 0; a < 3; ++a)
        {
          const Interval along = GetEnds(*this->Field, a, s[a]);
          box.Min[a] = along.Min;
          box.Max[a] = along.Max;
        }
        const Box part = reach(box, subCells.GetDisplacement(s));
        if (!part.IsEmpty())
        {
          Include(sum, part);
        }
      }
    }
  }
  return sum;
}

//------------------------------------------------------------------------------
/// {P : P + factor * D(P) in rest}.
Box PullBackBounds::Preimage(const Box& rest, double factor, const ParallelFor& parallelFor) const
{
  const auto move = [&rest, factor](const Box& d) {
    return factor < 0.0 ? Box{ rest.Min + d.Min, rest.Max + d.Max }
                        : Box{ rest.Min - d.Max, rest.Max - d.Min };
  };
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->FindSubCells(move(FindHull(*this->Field)), first, last))
  {
    return EmptyBox();
  }
  // Constant sub-cells are unbounded, their intersection with the reach is not.
  return this->UnionOfSubCells(
    first, last, [&move](const Box& box, const Box& d) { return Intersect(box, move(d)); },
    parallelFor);
}

//------------------------------------------------------------------------------
Box PullBackBounds::DeformedBounds(const Box& rest, const ParallelFor& parallelFor) const
{
  if (rest.IsEmpty())
  {
    return EmptyBox();
  }
  if (!this->Field)
  {
    return rest;
  }
  const auto grow = [](Box box, double by) -> Box {
    return box.IsEmpty() ? box : Box{ box.Min - by, box.Max + by };
  };
  Box box = EmptyBox();
  switch (this->Kind)
  {
    case PullBackKind::FirstOrder:
      return this->Preimage(rest, -1.0, parallelFor);
    case PullBackKind::Forward:
      return this->Preimage(rest, 1.0, parallelFor);
    case PullBackKind::Exact:
      // A converged Q has T(Q) within the tolerance of P.
      box = grow(this->ForwardImage(rest), this->Tolerance);
      if (!this->ProvenInvertible)
      {
        Include(box, this->Preimage(rest, -1.0, parallelFor));
      }
      return box;
    case PullBackKind::FirstOrderOfInverse:
    {
      // With P = T(Q) + e, |e| <= tolerance: Phi(P) = 2P - Q = Q + 2 D(Q) + 2 e.
      const Box grown = grow(rest, 2.0 * this->Tolerance);
      const auto reach = [&grown](const Box& d) {
        return Box{ grown.Min - 2.0 * d.Max, grown.Max - 2.0 * d.Min };
      };
      glm::ivec3 first;
      glm::ivec3 last;
      if (this->FindSubCells(reach(FindHull(*this->Field)), first, last))
      {
        box = this->UnionOfSubCells(
          first, last,
          [&reach](const Box& at, const Box& d) {
            const Box q = Intersect(at, reach(d));
            return q.IsEmpty() ? q : Box{ q.Min + d.Min, q.Max + d.Max };
          },
          parallelFor);
      }
      box = grow(box, this->Tolerance);
      if (!this->ProvenInvertible)
      {
        Include(box, this->Preimage(rest, 1.0, parallelFor));
      }
      return box;
    }
  }
  return box;
}

//------------------------------------------------------------------------------
/// The parts of a region in the sub-cells of one axis.
struct PullBackBounds::AxisParts
{
  struct Part
  {
    double Min; // data coordinates
    double Max;
    BezierWeights Rest;    // of the component along the axis: with where the Bezier points rest
    BezierWeights Weights; // of the others
  };
  struct Cell
  {
    int First; // part
    int End;
    double Min; // of its parts
    double Max;
  };
  std::vector<Part> Parts;
  std::vector<Cell> Cells;
  int FirstCell = 0; // of the field

  AxisParts(const BSplineField& field, int axis, const Box& region, int first, int last)
  {
    const int begin = field.GetFirstCell()[axis];
    const int end = field.GetEndCell()[axis];
    const double h = field.GetSpacing()[axis];
    for (int i = first; i <= last; ++i)
    {
      const Interval ends = GetEnds(field, axis, i);
      // Without those that are only within rounding of the region.
      if (ends.Max < region.Min[axis] || ends.Min > region.Max[axis])
      {
        continue;
      }
      Part part;
      part.Min = std::max(ends.Min, region.Min[axis]);
      part.Max = std::min(ends.Max, region.Max[axis]);
      // Outside the clamped range both ends coincide and D is constant along the axis.
      const double u0 = std::clamp<double>((part.Min - field.GetOrigin()[axis]) / h, begin, end);
      const double u1 = std::clamp<double>((part.Max - field.GetOrigin()[axis]) / h, begin, end);
      const int cell = CellOfSubCell(field, axis, i);
      double weights[4][4];
      SetBlossomWeights(u0 - cell, u1 - cell, weights);
      for (int b = 0; b < 4; ++b)
      {
        part.Weights.Shift[b] = 0.0;
        for (int c = 0; c < 4; ++c)
        {
          part.Weights.Weight[c][b] = weights[b][c];
        }
      }
      part.Rest = part.Weights;
      for (int b = 0; b < 4; ++b)
      {
        part.Rest.Shift[b] = part.Min + (part.Max - part.Min) * (b / 3.0);
      }
      const int n = static_cast<int>(this->Parts.size());
      if (this->Cells.empty())
      {
        this->FirstCell = cell;
      }
      if (cell - this->FirstCell == static_cast<int>(this->Cells.size()))
      {
        this->Cells.push_back({ n, n, part.Min, part.Max });
      }
      Cell& of = this->Cells.back();
      of.End = n + 1;
      of.Min = std::min(of.Min, part.Min);
      of.Max = std::max(of.Max, part.Max);
      this->Parts.push_back(part);
    }
  }
};

//------------------------------------------------------------------------------
/// Add one component of the image under T of the parts of a cell, tight.
void PullBackBounds::IncludeImage(
  const AxisParts axes[3], const glm::ivec3& cell, int component, Box& image) const
{
  double net[64];
  double* to = net;
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* row = &this->Field->Coefficient(axes[0].FirstCell + cell.x - 1,
        axes[1].FirstCell + cell.y - 1 + j, axes[2].FirstCell + cell.z - 1 + k);
      for (int i = 0; i < 4; ++i)
      {
        *to++ = row[i][component];
      }
    }
  }
  const auto partsOf = [&](int axis) {
    return axes[axis].Cells[static_cast<std::size_t>(cell[axis])];
  };
  for (int k = partsOf(2).First; k < partsOf(2).End; ++k)
  {
    for (int j = partsOf(1).First; j < partsOf(1).End; ++j)
    {
      for (int i = partsOf(0).First; i < partsOf(0).End; ++i)
      {
        const int at[3] = { i, j, k };
        const BezierWeights* weights[3];
        for (int a = 0; a < 3; ++a)
        {
          const AxisParts::Part& part = axes[a].Parts[static_cast<std::size_t>(at[a])];
          weights[a] = a == component ? &part.Rest : &part.Weights;
        }
        double range[2];
        FindBezierRange(net, *weights[0], *weights[1], *weights[2], range);
        image.Min[component] = std::min(image.Min[component], range[0]);
        image.Max[component] = std::max(image.Max[component], range[1]);
      }
    }
  }
}

//------------------------------------------------------------------------------
/// Image of `region` under T, tight.
Box PullBackBounds::ForwardImage(const Box& region) const
{
  Box image = EmptyBox();
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->FindSubCells(region, first, last))
  {
    return image;
  }
  const BSplineField& field = *this->Field;
  const AxisParts axes[3] = { AxisParts(field, 0, region, first.x, last.x),
    AxisParts(field, 1, region, first.y, last.y), AxisParts(field, 2, region, first.z, last.z) };
  const glm::ivec3 cells(static_cast<int>(axes[0].Cells.size()),
    static_cast<int>(axes[1].Cells.size()), static_cast<int>(axes[2].Cells.size()));
  if (glm::any(glm::equal(cells, glm::ivec3(0))))
  {
    return image;
  }
  // What each cell may reach: where it rests and the hull of the control points that count there.
  glm::ivec3 size = cells + 3;
  std::vector<Box> reaches;
  reaches.reserve(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
    static_cast<std::size_t>(size.z));
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      const glm::dvec3* row = &field.Coefficient(
        axes[0].FirstCell - 1, axes[1].FirstCell - 1 + j, axes[2].FirstCell - 1 + k);
      for (int i = 0; i < size.x; ++i)
      {
        reaches.push_back({ row[i], row[i] });
      }
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    UniteAlong(a, size, reaches);
  }
  glm::ivec3 lowest[3];
  glm::ivec3 highest[3];
  Box farthest = EmptyBox();
  Box* reach = reaches.data();
  glm::ivec3 at;
  for (at.z = 0; at.z < cells.z; ++at.z)
  {
    for (at.y = 0; at.y < cells.y; ++at.y)
    {
      for (at.x = 0; at.x < cells.x; ++at.x, ++reach)
      {
        for (int a = 0; a < 3; ++a)
        {
          const AxisParts::Cell& along = axes[a].Cells[static_cast<std::size_t>(at[a])];
          reach->Min[a] += along.Min;
          reach->Max[a] += along.Max;
          if (reach->Min[a] < farthest.Min[a])
          {
            farthest.Min[a] = reach->Min[a];
            lowest[a] = at;
          }
          if (reach->Max[a] > farthest.Max[a])
          {
            farthest.Max[a] = reach->Max[a];
            highest[a] = at;
          }
        }
      }
    }
  }
  if (!std::isfinite(glm::length(farthest.Min) + glm::length(farthest.Max)))
  {
    return { glm::dvec3(-Infinity), glm::dvec3(Infinity) };
  }
  // Those that may reach farthest come first: nearly all others are within their image already.
  for (int a = 0; a < 3; ++a)
  {
    this->IncludeImage(axes, lowest[a], a, image);
    this->IncludeImage(axes, highest[a], a, image);
  }
  reach = reaches.data();
  for (at.z = 0; at.z < cells.z; ++at.z)
  {
    for (at.y = 0; at.y < cells.y; ++at.y)
    {
      for (at.x = 0; at.x < cells.x; ++at.x, ++reach)
      {
        for (int a = 0; a < 3; ++a)
        {
          if (reach->Min[a] < image.Min[a] || reach->Max[a] > image.Max[a])
          {
            this->IncludeImage(axes, at, a, image);
          }
        }
      }
    }
  }
  // Rounding of the sums above.
  const glm::dvec3 slack =
    1e-12 * (glm::max(glm::abs(image.Min), glm::abs(image.Max)) + glm::abs(field.GetSpacing()));
  return { image.Min - slack, image.Max + slack };
}

//------------------------------------------------------------------------------
PullBackLimits PullBackBounds::GetLimits() const
{
  PullBackLimits limits;
  limits.OneToOne = this->ProvenInvertible;
  for (const float norm : this->InverseNorms)
  {
    // The negation also catches what is not a number.
    limits.LargestStretch = !(norm <= limits.LargestStretch) ? (std::isnan(norm) ? Infinity : norm)
                                                             : limits.LargestStretch;
  }
  return limits;
}

//------------------------------------------------------------------------------
double PullBackBounds::FindLargestTurnRate(const Box& region) const
{
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !this->FindSubCells(region, first, last))
  {
    return 0.0;
  }
  if (this->TouchesKink(region))
  {
    return Infinity;
  }
  // Outside of the lattice the derivatives are some of those at its faces.
  const BSplineField& field = *this->Field;
  const glm::ivec3 size = 2 * (field.GetEndCell() - field.GetFirstCell());
  first = glm::clamp(first, glm::ivec3(1), size);
  last = glm::clamp(last, glm::ivec3(1), size);
  const SubCells subCells(field, first, last, ParallelFor());
  const glm::ivec3 cells = (last - 1) / 2 - (first - 1) / 2 + 1;
  const double sign = this->Kind == PullBackKind::FirstOrder ? -1.0 : 1.0;
  double largest = 0.0;
  for (int n = 0; n < cells.x * cells.y * cells.z; ++n)
  {
    const glm::ivec3 cell =
      (first - 1) / 2 + glm::ivec3(n % cells.x, n / cells.x % cells.y, n / (cells.x * cells.y));
    const double second = BoundSecondDerivative(field, field.GetFirstCell() + cell);
    for (int i = 0; i < 8 && second > 0.0; ++i)
    {
      const glm::ivec3 s = 2 * cell + 1 + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      MatrixRange inverse;
      if (!FindInverse(GetJacobian(subCells.At(s), sign), inverse))
      {
        return Infinity;
      }
      const double norm = BoundNorm(inverse);
      double rate = norm * second;
      if (this->Kind == PullBackKind::Exact)
      {
        // From T(Q(t)) = P + t d: J_T Q'' = -T''[Q', Q'].
        rate *= norm;
      }
      else if (this->Kind == PullBackKind::FirstOrderOfInverse)
      {
        MatrixRange slowest;
        if (!FindInverse({ glm::dmat3(2.0) - inverse.Centre, inverse.Spread }, slowest))
        {
          return Infinity;
        }
        rate *= norm * norm * BoundNorm(slowest);
      }
      largest = std::max(largest, rate);
    }
  }
  return largest;
}

} // namespace ffd
