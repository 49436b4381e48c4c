// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDPullBackBounds.h"

#include "FFDGridIndex.h"

#include "Bounds/FFDForwardImage.h"
#include "Bounds/FFDJacobianDeterminant.h"
#include "Bounds/FFDMatrixBounds.h"
#include "Bounds/FFDSubCellBounds.h"

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

/// I + sign * dD/dp over a sub-cell.
MatrixRange GetJacobian(const SubCellBounds& bounds, double sign)
{
  MatrixRange range;
  for (int i = 0; i < 9; ++i)
  {
    const double low = -static_cast<double>(bounds.Value[SubCellBounds::NegatedJacobianMin + i]);
    const double high = bounds.Value[SubCellBounds::JacobianMax + i];
    range.Center[i / 3][i % 3] = (i % 4 == 0 ? 1.0 : 0.0) + sign * 0.5 * (low + high);
    range.Spread[i / 3][i % 3] = 0.5 * (high - low);
  }
  return range;
}

/// An upper bound of |d^2 D(o + t d) / dt^2| / |d|^2 over a cell: second derivatives are convex
/// combinations of second differences of the control points that count there.
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

/// A bound of how fast a deformed ray turns where dT/dp, or for FirstOrder dPhi/dp, and the second
/// derivative of D are bounded, see PullBackBounds::FindLargestTurnRate().
double BoundTurnRate(PullBackKind kind, const MatrixRange& jacobian, double second)
{
  MatrixRange inverse;
  if (!FindInverse(jacobian, inverse))
  {
    return Infinity;
  }
  const double norm = BoundNorm(inverse);
  const double rate = norm * second;
  if (kind == PullBackKind::Exact)
  {
    // From T(Q(t)) = P + t d: J_T Q'' = -T''[Q', Q'].
    return rate * norm;
  }
  if (kind == PullBackKind::FirstOrderOfInverse)
  {
    MatrixRange slowest;
    return FindInverse({ glm::dmat3(2.0) - inverse.Center, inverse.Spread }, slowest)
      ? rate * norm * norm * BoundNorm(slowest)
      : Infinity;
  }
  return rate;
}

/// Largest differences of control points at the faces of a lattice, by axes.
struct BorderDifferences
{
  double Second[3] = {};   ///< along an axis, at the faces across it
  double Mixed[3][3] = {}; ///< across the faces of the first axis, and along the second one
  double Third = 0.0;      ///< of those along a second and third axis, or the second one again
  glm::dvec3 Spacing;

  explicit BorderDifferences(const BSplineField& field)
    : Spacing(glm::abs(field.GetSpacing()))
  {
    for (int a = 0; a < 3; ++a)
    {
      for (const bool high : { false, true })
      {
        this->Include(field, a, high);
      }
    }
    for (int a = 0; a < 3; ++a)
    {
      this->Second[a] = std::sqrt(this->Second[a]);
      for (double& mixed : this->Mixed[a])
      {
        mixed = std::sqrt(mixed);
      }
    }
    this->Third = std::sqrt(this->Third);
  }

  /// A bound of the norm of the change of the Jacobian up to so many cells beyond a face, or beyond
  /// an edge or a corner, and to where D is constant.
  double BoundChange(int cells) const
  {
    const double reach = cells + 3;
    double squared = 0.0;
    for (int b = 0; b < 3; ++b)
    {
      double change = 2.0 * this->Second[b] + (reach + 2.0) * reach * this->Third;
      for (int a = 0; a < 3; ++a)
      {
        change += a == b ? 0.0 : reach * this->Mixed[a][b];
      }
      squared += change * change / (this->Spacing[b] * this->Spacing[b]);
    }
    return std::sqrt(squared);
  }

private:
  /// Squares, at first.
  void Include(const BSplineField& field, int a, bool high)
  {
    const glm::ivec3 nodes = field.GetNodes();
    const int b = (a + 1) % 3;
    const int c = (a + 2) % 3;
    // The difference between the control points `depth` and depth + 1 from the face.
    const auto across = [&](int depth, int j, int k) {
      glm::ivec3 outer(0);
      outer[a] = high ? nodes[a] - 1 - depth : depth;
      outer[b] = std::min(j, nodes[b] - 1);
      outer[c] = std::min(k, nodes[c] - 1);
      glm::ivec3 inner = outer;
      inner[a] += high ? -1 : 1;
      return field.Coefficient(inner.x, inner.y, inner.z) -
        field.Coefficient(outer.x, outer.y, outer.z);
    };
    for (int k = 0; k < nodes[c]; ++k)
    {
      for (int j = 0; j < nodes[b]; ++j)
      {
        const auto keep = [](double& largest, const glm::dvec3& difference) {
          largest = std::max(largest, glm::dot(difference, difference));
        };
        keep(this->Second[a], across(1, j, k) - across(0, j, k));
        for (int depth = 0; depth < 2; ++depth)
        {
          const glm::dvec3 d = across(depth, j, k);
          const glm::dvec3 dj = across(depth, j + 1, k);
          const glm::dvec3 dk = across(depth, j, k + 1);
          keep(this->Mixed[a][b], dj - d);
          keep(this->Mixed[a][c], dk - d);
          keep(this->Third, across(depth, j + 1, k + 1) - dj - dk + d);
          keep(this->Third, across(depth, j + 2, k) - 2.0 * dj + d);
          keep(this->Third, across(depth, j, k + 2) - 2.0 * dk + d);
        }
      }
    }
  }
};

/// The bounds of T(rest). Where T is one to one, what lies within goes to what lies within, so that
/// the faces tell.
Box FindImage(const BSplineField& field, const Box& rest, bool oneToOne)
{
  if (!oneToOne)
  {
    return FindForwardImage(field, rest);
  }
  Box image = Box::Empty();
  for (int a = 0; a < 3; ++a)
  {
    Box low = rest;
    Box high = rest;
    low.Max[a] = rest.Min[a];
    high.Min[a] = rest.Max[a];
    image.Include(FindForwardImage(field, low));
    image.Include(FindForwardImage(field, high));
  }
  return image;
}

/// Range of the control points, and so of D; all there is when one is not a number.
Box FindHull(const BSplineField& field)
{
  Box hull = Box::Empty();
  for (const glm::dvec3& c : field.GetCoefficients())
  {
    if (!std::isfinite(c.x + c.y + c.z))
    {
      return { glm::dvec3(-Infinity), glm::dvec3(Infinity) };
    }
    hull.Include({ c, c });
  }
  // More than what bounds over sub-cells are rounded by.
  const glm::dvec3 slack = 1e-4 * glm::max(glm::abs(hull.Min), glm::abs(hull.Max));
  return { hull.Min - slack, hull.Max + slack };
}

} // namespace

//------------------------------------------------------------------------------
std::size_t PullBackBounds::CellIndex(const glm::ivec3& cell) const
{
  const glm::ivec3 at = cell - this->Field->GetFirstCell();
  const glm::ivec3 size = this->Field->GetEndCell() - this->Field->GetFirstCell();
  return GridIndex(at, size);
}

//------------------------------------------------------------------------------
std::size_t PullBackBounds::Update(const PullBack& pullBack, const ParallelFor& parallelFor)
{
  this->Field = pullBack.IsIdentity() ? nullptr : pullBack.GetField();
  this->Kind = pullBack.GetKind();
  this->Tolerance = pullBack.GetTolerance();
  this->Domain = pullBack.GetDomain();
  this->ProvenInvertible = true;
  if (!this->Field || !InvertsTheField(this->Kind))
  {
    this->InverseNorms.clear();
    this->Last.reset();
    return 0;
  }
  const BSplineField& field = *this->Field;
  const CellRange cells = this->FindChangedCells();
  const glm::ivec3 size = glm::max(cells.End - cells.First, 0);
  const std::size_t count = GridSize(size);
  // Nothing is kept if memory runs out on the way.
  std::vector<float> norms = std::move(this->InverseNorms);
  this->InverseNorms.clear();
  if (count > 0)
  {
    const glm::ivec3 all = field.GetEndCell() - field.GetFirstCell();
    norms.resize(GridSize(all));
    this->BoundInverse(cells, parallelFor, norms);
    this->Last = field;
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
  if (this->InverseNorms.empty() || this->Last->GetNodes() != nodes ||
    this->Last->GetSpacing() != field.GetSpacing() || this->Last->GetBorder() != field.GetBorder())
  {
    return { field.GetFirstCell(), field.GetEndCell() };
  }
  glm::ivec3 low = nodes;
  glm::ivec3 high(-1);
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      const glm::dvec3* last = &this->Last->Coefficient(0, j, k);
      const glm::dvec3* row = &field.Coefficient(0, j, k);
      for (int i = 0; i < nodes.x; ++i)
      {
        if (last[i] != row[i])
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
  const std::vector<float> found = BoundInverseNorms(*this->Field, cells, parallelFor);
  const glm::ivec3 size = cells.End - cells.First;
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      std::copy_n(&found[GridIndex(0, j, k, size)], size.x,
        &norms[this->CellIndex(cells.First + glm::ivec3(0, j, k))]);
    }
  }
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
  this->ProvenInvertible = HasPositiveJacobian(*this->Field, unknown.First, unknown.End);
  if (this->ProvenInvertible)
  {
    std::replace_if(
      norms.begin(), norms.end(), [](float norm) { return std::isnan(norm); },
      std::numeric_limits<float>::infinity());
  }
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
/// Bounds over some sub-cells of the field, by their numbers in the whole of it.
class PullBackBounds::SubCells
{
public:
  /// Calls work(subCells, first, last) for slabs of the sub-cells first ... last, with those of
  /// each slab.
  template <class Work>
  static void ForSlabs(const BSplineField& field, const glm::ivec3& first, const glm::ivec3& last,
    const ParallelFor& parallelFor, const Work& work)
  {
    const CellRange cells = FindCells(field, first, last);
    ForSlabsOfSubCells(
      field, cells, parallelFor, [&](const SubCellGrid& grid, const SubCellBoundsVector& bounds) {
        const glm::ivec3 shift = 2 * (grid.FirstCell - field.GetFirstCell());
        glm::ivec3 from = first;
        glm::ivec3 to = last;
        // What lies on either side of a slab means nothing, unless that is the end of the part.
        if (grid.FirstCell.z > cells.First.z)
        {
          from.z = shift.z + 1;
        }
        if (grid.FirstCell.z + (grid.Size.z - 2) / 2 < cells.End.z)
        {
          to.z = shift.z + grid.Size.z - 2;
        }
        work(SubCells(grid, shift, bounds), from, to);
      });
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
  /// Keeps references.
  SubCells(const SubCellGrid& grid, const glm::ivec3& shift, const SubCellBoundsVector& bounds)
    : Grid(grid)
    , Shift(shift)
    , Bounds(bounds)
  {
  }

  /// Cells on either side of a part of the field are bounded with its outermost cells alone.
  static CellRange FindCells(
    const BSplineField& field, const glm::ivec3& first, const glm::ivec3& last)
  {
    CellRange cells;
    for (int a = 0; a < 3; ++a)
    {
      const auto cellOf = [&](int s) { return FindCellOfSubCell(field, a, s); };
      cells.First[a] = cellOf(first[a]);
      cells.End[a] = cellOf(last[a]) + 1;
    }
    return cells;
  }

  const SubCellGrid& Grid;
  glm::ivec3 Shift;
  const SubCellBoundsVector& Bounds;
};

//------------------------------------------------------------------------------
Box PullBackBounds::DisplacementOver(const Box& region) const
{
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !FindSubCells(*this->Field, region, first, last))
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
  Box sum = Box::Empty();
  SubCells::ForSlabs(*this->Field, first, last, parallelFor,
    [&](const SubCells& subCells, const glm::ivec3& from, const glm::ivec3& to) {
      glm::ivec3 s;
      for (s.z = from.z; s.z <= to.z; ++s.z)
      {
        for (s.y = from.y; s.y <= to.y; ++s.y)
        {
          for (s.x = from.x; s.x <= to.x; ++s.x)
          {
            Box box;
            for (int a = 0; a < 3; ++a)
            {
              const SubCellEnds along = FindSubCellEnds(*this->Field, a, s[a]);
              box.Min[a] = along.Min;
              box.Max[a] = along.Max;
            }
            const Box part = reach(box, subCells.GetDisplacement(s));
            if (!part.IsEmpty())
            {
              sum.Include(part);
            }
          }
        }
      }
    });
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
  if (!FindSubCells(*this->Field, move(FindHull(*this->Field)), first, last))
  {
    return Box::Empty();
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
    return Box::Empty();
  }
  if (!this->Field)
  {
    return rest;
  }
  const auto grow = [](Box box, double by) -> Box {
    return box.IsEmpty() ? box : Box{ box.Min - by, box.Max + by };
  };
  switch (this->Kind)
  {
    case PullBackKind::FirstOrder:
      return this->Preimage(rest, -1.0, parallelFor);
    case PullBackKind::Forward:
    {
      const Box box = this->Preimage(rest, 1.0, parallelFor);
      const Box known = this->Domain ? Intersect(box, *this->Domain) : box;
      return known.IsEmpty() ? Box::Empty() : known;
    }
    case PullBackKind::Exact:
      // A converged Q has T(Q) within the tolerance of P.
      return grow(FindImage(*this->Field, rest, this->ProvenInvertible), this->Tolerance);
    case PullBackKind::FirstOrderOfInverse:
    {
      // With P = T(Q) + e, |e| <= tolerance: Phi(P) = 2P - Q = Q + 2 D(Q) + 2 e.
      const Box grown = grow(rest, 2.0 * this->Tolerance);
      const auto reach = [&grown](const Box& d) {
        return Box{ grown.Min - 2.0 * d.Max, grown.Max - 2.0 * d.Min };
      };
      glm::ivec3 first;
      glm::ivec3 last;
      if (!FindSubCells(*this->Field, reach(FindHull(*this->Field)), first, last))
      {
        return Box::Empty();
      }
      const Box box = this->UnionOfSubCells(
        first, last,
        [&reach](const Box& at, const Box& d) {
          const Box q = Intersect(at, reach(d));
          return q.IsEmpty() ? q : Box{ q.Min + d.Min, q.Max + d.Max };
        },
        parallelFor);
      return grow(box, this->Tolerance);
    }
  }
  return Box::Empty();
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
  limits.LinearCells = this->FindLinearCells();
  return limits;
}

//------------------------------------------------------------------------------
/// Beyond the lattice the Jacobian of T is that of a point at its border, in the cells that are
/// bounded, and a change: T is regular if the change times a bound of the inverse is below one. The
/// change grows with the distance by the mixed differences of the control points at the border.
int PullBackBounds::FindLinearCells() const
{
  constexpr std::size_t fewControlPoints = 2000;
  constexpr double most = 0.8;
  if (this->InverseNorms.empty() || !this->ProvenInvertible)
  {
    return 0;
  }
  const BSplineField& field = *this->Field;
  const glm::ivec3 nodes = field.GetNodes();
  if (field.GetBorder() != BorderMode::Edge || GridSize(nodes) <= fewControlPoints ||
    std::min({ nodes.x, nodes.y, nodes.z }) < 4)
  {
    return 0;
  }
  // Of the cells with a control point of the border, or outside of all.
  double norm = 0.0;
  const glm::ivec3 first = field.GetFirstCell();
  const glm::ivec3 end = field.GetEndCell();
  for (int k = first.z; k < end.z; ++k)
  {
    for (int j = first.y; j < end.y; ++j)
    {
      const bool inner = k > 1 && k < nodes.z - 3 && j > 1 && j < nodes.y - 3;
      for (int i = first.x; i < end.x; ++i)
      {
        if (inner && i == 2)
        {
          i = nodes.x - 3;
        }
        norm =
          std::max(norm, static_cast<double>(this->InverseNorms[this->CellIndex({ i, j, k })]));
      }
    }
  }
  const BorderDifferences differences(field);
  for (const int cells : { 16, 12, 8, 6, 4, 3, 2 })
  {
    if (norm * differences.BoundChange(cells) < most)
    {
      return cells;
    }
  }
  return 0;
}

//------------------------------------------------------------------------------
double PullBackBounds::FindLargestTurnRate(const Box& region) const
{
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !FindSubCells(*this->Field, region, first, last))
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
  const double sign = this->Kind == PullBackKind::FirstOrder ? -1.0 : 1.0;
  double largest = 0.0;
  SubCells::ForSlabs(field, first, last, ParallelFor(),
    [&](const SubCells& subCells, const glm::ivec3& from, const glm::ivec3& to) {
      const glm::ivec3 cells = (to - 1) / 2 - (from - 1) / 2 + 1;
      for (int n = 0; n < cells.x * cells.y * cells.z && largest < Infinity; ++n)
      {
        const glm::ivec3 cell =
          (from - 1) / 2 + glm::ivec3(n % cells.x, n / cells.x % cells.y, n / (cells.x * cells.y));
        const double second = BoundSecondDerivative(field, field.GetFirstCell() + cell);
        for (int i = 0; i < 8 && second > 0.0; ++i)
        {
          const glm::ivec3 s = 2 * cell + 1 + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
          const MatrixRange jacobian = GetJacobian(subCells.At(s), sign);
          largest = std::max(largest, BoundTurnRate(this->Kind, jacobian, second));
        }
      }
    });
  return largest;
}

} // namespace ffd
