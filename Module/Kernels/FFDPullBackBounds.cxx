// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBackBounds.h"

#include "FFDBSplineBasis.h"
#include "FFDControlNet.h"
#include "FFDJacobianDeterminant.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
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

bool InvertsTheField(PullBackKind kind)
{
  return kind == PullBackKind::Exact || kind == PullBackKind::FirstOrderOfInverse;
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
  const bool regular = ComputeSubCellBounds(
    field, grid, this->Kind, this->SubCells, this->Derivatives, parallelFor);
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
