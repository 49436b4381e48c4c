// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBackBounds.h"

#include "FFDBSplineBasis.h"
#include "FFDControlNet.h"
#include "FFDJacobianDeterminant.h"
#include "FFDMatrixBounds.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

Box EmptyBox()
{
  return { glm::dvec3(Infinity), glm::dvec3(-Infinity) };
}

void Include(Box& box, const Box& other)
{
  box.Min = glm::min(box.Min, other.Min);
  box.Max = glm::max(box.Max, other.Max);
}

bool Contains(const Box& box, const Box& other)
{
  return glm::all(glm::lessThanEqual(box.Min, other.Min)) &&
    glm::all(glm::lessThanEqual(other.Max, box.Max));
}

Box Intersect(const Box& a, const Box& b)
{
  return { glm::max(a.Min, b.Min), glm::min(a.Max, b.Max) };
}

/// A float that is not below x. One relative step of 2^-22 covers the cast and the sum; far
/// cheaper than std::nextafter, and this runs 20 times per sub-cell.
float RoundUp(double x)
{
  // Clamped first, as the cast of a value past the range of float is undefined; the step takes
  // the upper limit to infinity only for values that are infinite or next to it.
  const float f = static_cast<float>(std::min(x, 3e38));
  return x > 3e38 ? std::numeric_limits<float>::infinity()
                  : f + std::abs(f) * 2.4e-7f + std::numeric_limits<float>::min();
}

void SetUnbounded(SubCellBounds& bounds)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::fill_n(bounds.Value + SubCellBounds::NegatedJacobianMin, 18, infinity);
  bounds.Value[SubCellBounds::Second] = infinity;
  bounds.Value[SubCellBounds::Third] = infinity;
}

/// Inverse times determinant, in straight-line code that compilers vectorise.
glm::dmat3 Adjugate(const glm::dmat3& m)
{
  return glm::transpose(
    glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])));
}

double LargestColumnSum(const glm::dmat3& m)
{
  return std::max({ m[0].x + m[0].y + m[0].z, m[1].x + m[1].y + m[1].z, m[2].x + m[2].y + m[2].z });
}

/// Bounds of T2[q, r] for the second derivatives of a cell: sum over b, c of |H_bc| q_b r_c.
glm::dvec3 ApplySecond(const CellDerivatives& cell, const glm::dvec3& q, const glm::dvec3& r)
{
  const double pairs[6] = { q.x * r.x, q.x * r.y + q.y * r.x, q.x * r.z + q.z * r.x, q.y * r.y,
    q.y * r.z + q.z * r.y, q.z * r.z };
  glm::dvec3 sum(0.0);
  for (int i = 0; i < 6; ++i)
  {
    sum += pairs[i] * glm::dvec3(cell.Second[i][0], cell.Second[i][1], cell.Second[i][2]);
  }
  return sum;
}

/// Bounds of T3[q, q, q].
glm::dvec3 ApplyThird(const CellDerivatives& cell, const glm::dvec3& q)
{
  const double triples[10] = { q.x * q.x * q.x, 3.0 * q.x * q.x * q.y, 3.0 * q.x * q.x * q.z,
    3.0 * q.x * q.y * q.y, 6.0 * q.x * q.y * q.z, 3.0 * q.x * q.z * q.z, q.y * q.y * q.y,
    3.0 * q.y * q.y * q.z, 3.0 * q.y * q.z * q.z, q.z * q.z * q.z };
  glm::dvec3 sum(0.0);
  for (int i = 0; i < 10; ++i)
  {
    sum += triples[i] * glm::dvec3(cell.Third[i][0], cell.Third[i][1], cell.Third[i][2]);
  }
  return sum;
}

/**
 * Turn bounds of D's derivatives into those of the inverse of T(X) = X + D(X), over the same
 * sub-cell of rest space. With J = C + E, |E| <= Delta entry-wise, W = |C^-1| Delta:
 * J^-1 - C^-1 = -C^-1 E J^-1, so |J^-1 - C^-1| <= (W + W^2 + ...) |C^-1| = (I - W)^-1 W |C^-1|
 * when the spectral radius of W is below one; the largest row or column sum proves that.
 */
bool BoundInverse(SubCellBounds& bounds, const CellDerivatives& cell)
{
  glm::dmat3 centre(1.0);
  glm::dmat3 delta;
  for (int i = 0; i < 9; ++i)
  {
    const double lo = -static_cast<double>(bounds.Value[SubCellBounds::NegatedJacobianMin + i]);
    const double hi = bounds.Value[SubCellBounds::JacobianMax + i];
    centre[i / 3][i % 3] += 0.5 * (lo + hi);
    delta[i / 3][i % 3] = 0.5 * (hi - lo);
  }
  const double determinant = glm::determinant(centre);
  // Also refuses NaN and a matrix so near to singular that its inverse is mostly rounding. A
  // negative one turns space inside out: T folds, and other points have the same image.
  if (!(determinant > 1e-9) || !(determinant < 1e30))
  {
    SetUnbounded(bounds);
    return false;
  }
  const glm::dmat3 inverse = Adjugate(centre) * (1.0 / determinant);
  const glm::dmat3 size = Absolute(inverse);
  const glm::dmat3 w = size * delta;
  const double radius = std::min(LargestRowSum(w), LargestColumnSum(w));
  if (!(radius < 0.999))
  {
    SetUnbounded(bounds);
    return false;
  }
  const glm::dmat3 remaining = glm::dmat3(1.0) - w;
  const glm::dmat3 spread =
    Adjugate(remaining) * (w * size) * (1.0 / glm::determinant(remaining));
  // The arithmetic above is in double precision: its error is far below this.
  constexpr double roundingSlack = 1e-9;
  glm::dmat3 largest;
  for (int i = 0; i < 9; ++i)
  {
    const double middle = inverse[i / 3][i % 3];
    const double radiusOfEntry = spread[i / 3][i % 3] + roundingSlack * (1.0 + std::abs(middle));
    bounds.Value[SubCellBounds::NegatedJacobianMin + i] = RoundUp(radiusOfEntry - middle);
    bounds.Value[SubCellBounds::JacobianMax + i] = RoundUp(radiusOfEntry + middle);
    largest[i / 3][i % 3] = std::abs(middle) + radiusOfEntry;
  }
  // |A|_2 <= sqrt(|A|_1 |A|_inf) and <= the Frobenius norm.
  const double frobenius = std::sqrt(glm::dot(largest[0], largest[0]) +
    glm::dot(largest[1], largest[1]) + glm::dot(largest[2], largest[2]));
  const double alpha =
    std::min(frobenius, std::sqrt(LargestRowSum(largest) * LargestColumnSum(largest)));
  // From T(Q(t)) = P + t d: J Q'' = -T2[Q', Q'] and J Q''' = -T3[Q', Q', Q'] - 3 T2[Q', Q''].
  const double t2 = bounds.Value[SubCellBounds::Second];
  const double t3 = bounds.Value[SubCellBounds::Third];
  const double alpha3 = alpha * alpha * alpha;
  // The same component by component: much closer where the deformation has a direction, as most
  // have, and never the only bound. |Q'_i| is at most the length of row i of J^-1.
  const glm::dmat3 rows = glm::transpose(largest);
  const glm::dvec3 speed(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2]));
  const glm::dvec3 turn = largest * ApplySecond(cell, speed, speed);
  const glm::dvec3 twist =
    largest * (ApplyThird(cell, speed) + 3.0 * ApplySecond(cell, speed, turn));
  bounds.Value[SubCellBounds::Second] = RoundUp(std::min(alpha3 * t2, glm::length(turn)));
  bounds.Value[SubCellBounds::Third] = RoundUp(
    std::min(alpha * alpha3 * (t3 + 3.0 * alpha * t2 * t2), glm::length(twist)));
  return true;
}

bool InvertsTheField(PullBackKind kind)
{
  return kind == PullBackKind::Exact || kind == PullBackKind::FirstOrderOfInverse;
}

/// Replace the interval of every Jacobian entry by diagonal * I + sign * interval.
void Reflect(SubCellBounds& bounds, double diagonal, bool negate)
{
  for (int i = 0; i < 9; ++i)
  {
    double lo = bounds.Value[SubCellBounds::NegatedJacobianMin + i]; // -min
    double hi = bounds.Value[SubCellBounds::JacobianMax + i];
    if (negate)
    {
      std::swap(lo, hi);
    }
    const double unit = i % 4 == 0 ? diagonal : 0.0;
    bounds.Value[SubCellBounds::NegatedJacobianMin + i] = RoundUp(lo - unit);
    bounds.Value[SubCellBounds::JacobianMax + i] = RoundUp(hi + unit);
  }
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

} // namespace

//------------------------------------------------------------------------------
PullBackBounds::PullBackBounds(const PullBack& pullBack, const ParallelFor& parallelFor)
  : RestRegions(InvertsTheField(pullBack.GetKind()))
  , Kind(pullBack.GetKind())
  , Tolerance(pullBack.GetTolerance())
{
  if (!pullBack.IsIdentity())
  {
    this->Find(*pullBack.GetField(), SubCellGrid(*pullBack.GetField()), parallelFor);
  }
}

//------------------------------------------------------------------------------
PullBackBounds::PullBackBounds(const PullBack& pullBack, const CellRange& cells,
  const glm::ivec3& factors, const ParallelFor& parallelFor)
  : RestRegions(InvertsTheField(pullBack.GetKind()))
  , Kind(pullBack.GetKind())
  , Tolerance(pullBack.GetTolerance())
{
  if (pullBack.IsIdentity())
  {
    return;
  }
  // The control points that count in these cells.
  const BSplineField& field = *pullBack.GetField();
  ControlNet net;
  net.Nodes = cells.End - cells.First + 3;
  for (int k = 0; k < net.Nodes.z; ++k)
  {
    for (int j = 0; j < net.Nodes.y; ++j)
    {
      for (int i = 0; i < net.Nodes.x; ++i)
      {
        const glm::ivec3 at = cells.First - 1 + glm::ivec3(i, j, k);
        net.Values.push_back(field.Coefficient(at.x, at.y, at.z));
      }
    }
  }
  if (factors != glm::ivec3(1))
  {
    net = RefineControlNet(net, factors);
  }
  // Its second control point rests where that of the first cell does.
  const glm::dvec3 spacing = field.GetSpacing() / glm::dvec3(factors);
  const glm::dvec3 origin =
    field.GetOrigin() + glm::dvec3(cells.First) * field.GetSpacing() - spacing;
  this->Refined =
    std::make_shared<const BSplineField>(net.Nodes, origin, spacing, net.Values.data());
  const CellRange refined{ glm::ivec3(1), glm::ivec3(1) + factors * (cells.End - cells.First) };
  this->Find(*this->Refined, SubCellGrid(refined), parallelFor);

  SubCellBounds unbounded;
  std::fill_n(unbounded.Value, SubCellBounds::Size, std::numeric_limits<float>::infinity());
  const glm::ivec3 last = this->Size - 1;
  for (int k = 0; k <= last.z; ++k)
  {
    for (int j = 0; j <= last.y; ++j)
    {
      const bool outside = k == 0 || j == 0 || k == last.z || j == last.y;
      for (int i = 0; i <= last.x; i += outside ? 1 : last.x)
      {
        this->SubCells[this->IndexOf(i, j, k)] = unbounded;
      }
    }
  }
}

//------------------------------------------------------------------------------
void PullBackBounds::Find(
  const BSplineField& field, const SubCellGrid& grid, const ParallelFor& parallelFor)
{
  this->Field = &field;
  this->Size = grid.Size;
  this->Cells = { grid.FirstCell, grid.FirstCell + grid.Size / 2 - 1 };
  ComputeSubCellBounds(field, grid, this->SubCells, &this->Derivatives, parallelFor);
  const glm::ivec3 cells = grid.GetCells();
  const auto cellOf = [&](std::size_t subCell) -> const CellDerivatives&
  {
    const int index = static_cast<int>(subCell);
    const int i = SubCellGrid::CellOf(index % grid.Size.x);
    const int j = SubCellGrid::CellOf(index / grid.Size.x % grid.Size.y);
    const int k = SubCellGrid::CellOf(index / grid.Size.x / grid.Size.y);
    return this->Derivatives[static_cast<std::size_t>(i) +
      static_cast<std::size_t>(cells.x) *
        (static_cast<std::size_t>(j) +
          static_cast<std::size_t>(cells.y) * static_cast<std::size_t>(k))];
  };
  std::atomic<bool> regular{ true };
  const std::size_t slice =
    static_cast<std::size_t>(grid.Size.x) * static_cast<std::size_t>(grid.Size.y);
  RunFor(parallelFor, static_cast<std::size_t>(grid.Size.z),
    [&](std::size_t first, std::size_t last)
    {
      bool all = true;
      for (std::size_t index = first * slice; index < last * slice; ++index)
      {
        SubCellBounds& bounds = this->SubCells[index];
        switch (this->Kind)
        {
          case PullBackKind::FirstOrder:
            Reflect(bounds, 1.0, true);
            break;
          case PullBackKind::Forward:
            Reflect(bounds, 1.0, false);
            break;
          case PullBackKind::Exact:
            all = BoundInverse(bounds, cellOf(index)) && all;
            break;
          case PullBackKind::FirstOrderOfInverse:
            all = BoundInverse(bounds, cellOf(index)) && all;
            Reflect(bounds, 2.0, true);
            break;
        }
      }
      if (!all)
      {
        regular = false;
      }
    });
  this->ProvenInvertible = this->ProvenInvertible && regular;
  if (this->RestRegions && !this->Refined && !this->ProvenInvertible)
  {
    // Far from the lattice T is a translation, so it is one to one if it folds nowhere.
    constexpr double loosely = 0.1;
    const Range determinant =
      BoundJacobianDeterminant(field, field.GetFirstCell(), field.GetEndCell(), loosely);
    this->ProvenInvertible = determinant.Min > 0.0;
  }
}

//------------------------------------------------------------------------------
bool PullBackBounds::FindSubCells(
  const Box& region, glm::ivec3& first, glm::ivec3& last) const
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
    const double begin = this->Cells.First[a];
    const double end = this->Cells.End[a];
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
Box PullBackBounds::GetSubCellBox(const glm::ivec3& subCell) const
{
  Box box;
  for (int a = 0; a < 3; ++a)
  {
    const double h = this->Field->GetSpacing()[a];
    const double lower = this->Cells.First[a] + 0.5 * (subCell[a] - 1);
    double lo = subCell[a] == 0 ? -Infinity : lower;
    double hi = subCell[a] == this->Size[a] - 1 ? Infinity : lower + 0.5;
    lo = this->Field->GetOrigin()[a] + lo * h;
    hi = this->Field->GetOrigin()[a] + hi * h;
    box.Min[a] = std::min(lo, hi);
    box.Max[a] = std::max(lo, hi);
  }
  return box;
}

//------------------------------------------------------------------------------
SubCellBounds PullBackBounds::Union(const glm::ivec3& first, const glm::ivec3& last) const
{
  SubCellBounds sum;
  std::fill_n(sum.Value, SubCellBounds::Size, -std::numeric_limits<float>::infinity());
  for (int k = first.z; k <= last.z; ++k)
  {
    for (int j = first.y; j <= last.y; ++j)
    {
      const SubCellBounds* row = this->SubCells.data() + this->IndexOf(0, j, k);
      for (int i = first.x; i <= last.x; ++i)
      {
        for (int v = 0; v < SubCellBounds::Size; ++v)
        {
          sum.Value[v] = row[i].Value[v] > sum.Value[v] ? row[i].Value[v] : sum.Value[v];
        }
      }
    }
  }
  return sum;
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
MapBounds PullBackBounds::Over(const Box& region) const
{
  MapBounds result;
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !this->FindSubCells(region, first, last))
  {
    return result;
  }
  const SubCellBounds sum = this->Union(first, last);
  for (int i = 0; i < 9; ++i)
  {
    result.JacobianMin[i / 3][i % 3] = -sum.Value[SubCellBounds::NegatedJacobianMin + i];
    result.JacobianMax[i / 3][i % 3] = sum.Value[SubCellBounds::JacobianMax + i];
  }
  const bool kink = this->TouchesKink(region);
  result.SecondDerivative = kink ? Infinity : sum.Value[SubCellBounds::Second];
  result.ThirdDerivative = kink ? Infinity : sum.Value[SubCellBounds::Third];
  return result;
}

//------------------------------------------------------------------------------
Box PullBackBounds::DisplacementOver(const Box& region) const
{
  Box box;
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !this->FindSubCells(region, first, last))
  {
    return box;
  }
  const SubCellBounds sum = this->Union(first, last);
  for (int a = 0; a < 3; ++a)
  {
    box.Min[a] = -sum.Value[SubCellBounds::NegatedMin + a];
    box.Max[a] = sum.Value[SubCellBounds::Max + a];
  }
  return box;
}

//------------------------------------------------------------------------------
Box PullBackBounds::GetDisplacement(const glm::ivec3& subCell) const
{
  const SubCellBounds& bounds = this->SubCells[this->IndexOf(subCell.x, subCell.y, subCell.z)];
  Box box;
  for (int a = 0; a < 3; ++a)
  {
    box.Min[a] = -bounds.Value[SubCellBounds::NegatedMin + a];
    box.Max[a] = bounds.Value[SubCellBounds::Max + a];
  }
  return box;
}

//------------------------------------------------------------------------------
Box PullBackBounds::DeformedBounds(const Box& rest) const
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
      return this->Preimage(rest, -1.0);
    case PullBackKind::Forward:
      return this->Preimage(rest, 1.0);
    case PullBackKind::Exact:
      // A converged Q has T(Q) within the tolerance of P.
      box = grow(this->ForwardImage(rest), this->Tolerance);
      if (!this->ProvenInvertible)
      {
        Include(box, this->Preimage(rest, -1.0));
      }
      return box;
    case PullBackKind::FirstOrderOfInverse:
    {
      // With P = T(Q) + e, |e| <= tolerance: Phi(P) = 2P - Q = Q + 2 D(Q) + 2 e.
      const Box grown = grow(rest, 2.0 * this->Tolerance);
      glm::ivec3 s;
      for (s.z = 0; s.z < this->Size.z; ++s.z)
      {
        for (s.y = 0; s.y < this->Size.y; ++s.y)
        {
          for (s.x = 0; s.x < this->Size.x; ++s.x)
          {
            const Box d = this->GetDisplacement(s);
            const Box reach{ grown.Min - 2.0 * d.Max, grown.Max - 2.0 * d.Min };
            const Box q = Intersect(this->GetSubCellBox(s), reach);
            if (!q.IsEmpty())
            {
              Include(box, Box{ q.Min + d.Min, q.Max + d.Max });
            }
          }
        }
      }
      box = grow(box, this->Tolerance);
      if (!this->ProvenInvertible)
      {
        Include(box, this->Preimage(rest, 1.0));
      }
      return box;
    }
  }
  return box;
}

//------------------------------------------------------------------------------
Box PullBackBounds::Preimage(const Box& rest, double factor) const
{
  Box box = EmptyBox();
  glm::ivec3 s;
  for (s.z = 0; s.z < this->Size.z; ++s.z)
  {
    for (s.y = 0; s.y < this->Size.y; ++s.y)
    {
      for (s.x = 0; s.x < this->Size.x; ++s.x)
      {
        const Box d = this->GetDisplacement(s);
        const Box reach = factor < 0.0 ? Box{ rest.Min + d.Min, rest.Max + d.Max }
                                       : Box{ rest.Min - d.Max, rest.Max - d.Min };
        // Constant sub-cells are unbounded, their intersection with the reach is not.
        const Box part = Intersect(this->GetSubCellBox(s), reach);
        if (!part.IsEmpty())
        {
          Include(box, part);
        }
      }
    }
  }
  return box;
}

//------------------------------------------------------------------------------
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
  // The extreme points of the image are mostly on the faces of the region: visit the shell first,
  // so that nearly all of the inside is within the image already and costs a comparison each.
  for (int pass = 0; pass < 2; ++pass)
  {
    glm::ivec3 s;
    for (s.z = first.z; s.z <= last.z; ++s.z)
    {
      for (s.y = first.y; s.y <= last.y; ++s.y)
      {
        for (s.x = first.x; s.x <= last.x; ++s.x)
        {
          const bool shell =
            glm::any(glm::equal(s, first)) || glm::any(glm::equal(s, last));
          if (shell != (pass == 0))
          {
            continue;
          }
          const Box part = Intersect(this->GetSubCellBox(s), region);
          const Box d = this->GetDisplacement(s);
          if (part.IsEmpty() || Contains(image, Box{ part.Min + d.Min, part.Max + d.Max }))
          {
            continue;
          }
          double weights[3][4][4];
          double rest[3][4];
          glm::ivec3 base;
          for (int a = 0; a < 3; ++a)
          {
            const double begin = field.GetFirstCell()[a];
            const double end = field.GetEndCell()[a];
            const double h = field.GetSpacing()[a];
            double u0 = std::clamp((part.Min[a] - field.GetOrigin()[a]) / h, begin, end);
            double u1 = std::clamp((part.Max[a] - field.GetOrigin()[a]) / h, begin, end);
            // Outside the clamped range both ends coincide and D is constant along the axis.
            const int cell = std::clamp(static_cast<int>(begin) + (s[a] - 1) / 2,
              static_cast<int>(begin), static_cast<int>(end) - 1);
            SetBlossomWeights(u0 - cell, u1 - cell, weights[a]);
            base[a] = cell - 1;
            for (int b = 0; b < 4; ++b)
            {
              rest[a][b] = part.Min[a] + (part.Max[a] - part.Min[a]) * (b / 3.0);
            }
          }
          // Contract z, y, x in turn: 16, 4, 1 control points per coefficient.
          glm::dvec3 planes[4][4][4];
          for (int j = 0; j < 4; ++j)
          {
            for (int i = 0; i < 4; ++i)
            {
              const glm::dvec3 c[4] = { field.Coefficient(base.x + i, base.y + j, base.z),
                field.Coefficient(base.x + i, base.y + j, base.z + 1),
                field.Coefficient(base.x + i, base.y + j, base.z + 2),
                field.Coefficient(base.x + i, base.y + j, base.z + 3) };
              for (int b = 0; b < 4; ++b)
              {
                const double* w = weights[2][b];
                planes[b][j][i] = w[0] * c[0] + w[1] * c[1] + w[2] * c[2] + w[3] * c[3];
              }
            }
          }
          for (int bz = 0; bz < 4; ++bz)
          {
            for (int by = 0; by < 4; ++by)
            {
              const double* w = weights[1][by];
              glm::dvec3 row[4];
              for (int i = 0; i < 4; ++i)
              {
                row[i] = w[0] * planes[bz][0][i] + w[1] * planes[bz][1][i] +
                  w[2] * planes[bz][2][i] + w[3] * planes[bz][3][i];
              }
              for (int bx = 0; bx < 4; ++bx)
              {
                const double* v = weights[0][bx];
                const glm::dvec3 x = glm::dvec3(rest[0][bx], rest[1][by], rest[2][bz]) +
                  (v[0] * row[0] + v[1] * row[1] + v[2] * row[2] + v[3] * row[3]);
                image.Min = glm::min(image.Min, x);
                image.Max = glm::max(image.Max, x);
              }
            }
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

} // namespace ffd
