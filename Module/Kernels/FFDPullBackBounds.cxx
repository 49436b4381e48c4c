// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBackBounds.h"

#include "FFDMatrixBounds.h"

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

Box EmptyBox() { return { glm::dvec3(Infinity), glm::dvec3(-Infinity) }; }

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
  const bool regular =
    ComputeSubCellBounds(field, grid, this->Kind, this->SubCells, this->Derivatives, parallelFor);
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
PullBackBounds::SubCellEnds::SubCellEnds(const PullBackBounds& bounds)
{
  for (int a = 0; a < 3; ++a)
  {
    const double h = bounds.Field->GetSpacing()[a];
    const double origin = bounds.Field->GetOrigin()[a];
    for (int i = 0; i < bounds.Size[a]; ++i)
    {
      const double lower = bounds.Cells.First[a] + 0.5 * (i - 1);
      const double from = origin + (i == 0 ? -Infinity : lower) * h;
      const double to = origin + (i == bounds.Size[a] - 1 ? Infinity : lower + 0.5) * h;
      this->Min[a].push_back(std::min(from, to));
      this->Max[a].push_back(std::max(from, to));
    }
  }
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
SubCellBounds PullBackBounds::Union(
  const glm::ivec3& first, const glm::ivec3& last, const ParallelFor& parallelFor) const
{
  std::vector<SubCellBounds> slices(static_cast<std::size_t>(last.z - first.z + 1));
  RunFor(parallelFor, slices.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
    {
      const int z = first.z + static_cast<int>(k);
      slices[k] = this->Union({ first.x, first.y, z }, { last.x, last.y, z });
    }
  });
  SubCellBounds sum = slices.front();
  for (const SubCellBounds& slice : slices)
  {
    for (int v = 0; v < SubCellBounds::Size; ++v)
    {
      sum.Value[v] = std::max(sum.Value[v], slice.Value[v]);
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
MapBounds PullBackBounds::Over(const Box& region, const ParallelFor& parallelFor) const
{
  MapBounds result;
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->Field || !this->FindSubCells(region, first, last))
  {
    return result;
  }
  const SubCellBounds sum =
    parallelFor ? this->Union(first, last, parallelFor) : this->Union(first, last);
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
      return this->Preimage(rest, -1.0);
    case PullBackKind::Forward:
      return this->Preimage(rest, 1.0);
    case PullBackKind::Exact:
      // A converged Q has T(Q) within the tolerance of P.
      box = grow(this->ForwardImage(rest, parallelFor), this->Tolerance);
      if (!this->ProvenInvertible)
      {
        Include(box, this->Preimage(rest, -1.0));
      }
      return box;
    case PullBackKind::FirstOrderOfInverse:
    {
      // With P = T(Q) + e, |e| <= tolerance: Phi(P) = 2P - Q = Q + 2 D(Q) + 2 e.
      const Box grown = grow(rest, 2.0 * this->Tolerance);
      const SubCellEnds ends(*this);
      glm::ivec3 s;
      for (s.z = 0; s.z < this->Size.z; ++s.z)
      {
        for (s.y = 0; s.y < this->Size.y; ++s.y)
        {
          for (s.x = 0; s.x < this->Size.x; ++s.x)
          {
            const Box d = this->GetDisplacement(s);
            const Box reach{ grown.Min - 2.0 * d.Max, grown.Max - 2.0 * d.Min };
            const Box q = Intersect(ends.GetBox(s), reach);
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
  const SubCellEnds ends(*this);
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
        const Box part = Intersect(ends.GetBox(s), reach);
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
/// The parts of a region in the sub-cells of one axis.
struct PullBackBounds::AxisParts
{
  struct Part
  {
    double Min; // data coordinates
    double Max;
    int Base;              // the first of the control points that count there
    BezierWeights Rest;    // of the component along the axis: with where the Bezier points rest
    BezierWeights Weights; // of the others
  };
  std::vector<Part> Parts;

  AxisParts(const BSplineField& field, int axis, const Box& region, const SubCellEnds& ends,
    int first, int last)
  {
    const int begin = field.GetFirstCell()[axis];
    const int end = field.GetEndCell()[axis];
    const double h = field.GetSpacing()[axis];
    for (int i = first; i <= last; ++i)
    {
      Part part;
      part.Min = std::max(ends.Min[axis][static_cast<std::size_t>(i)], region.Min[axis]);
      part.Max = std::min(ends.Max[axis][static_cast<std::size_t>(i)], region.Max[axis]);
      // Outside the clamped range both ends coincide and D is constant along the axis.
      const double u0 = std::clamp<double>((part.Min - field.GetOrigin()[axis]) / h, begin, end);
      const double u1 = std::clamp<double>((part.Max - field.GetOrigin()[axis]) / h, begin, end);
      const int cell = std::clamp(begin + (i - 1) / 2, begin, end - 1);
      double weights[4][4];
      SetBlossomWeights(u0 - cell, u1 - cell, weights);
      part.Base = cell - 1;
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
      this->Parts.push_back(part);
    }
  }
};

//------------------------------------------------------------------------------
void PullBackBounds::IncludeImage(
  const AxisParts axes[3], const glm::ivec3& at, int component, Box& image) const
{
  const BSplineField& field = *this->Field;
  const AxisParts::Part& x = axes[0].Parts[static_cast<std::size_t>(at.x)];
  const AxisParts::Part& y = axes[1].Parts[static_cast<std::size_t>(at.y)];
  const AxisParts::Part& z = axes[2].Parts[static_cast<std::size_t>(at.z)];
  double net[64];
  double* to = net;
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* row = &field.Coefficient(x.Base, y.Base + j, z.Base + k);
      for (int i = 0; i < 4; ++i)
      {
        *to++ = row[i][component];
      }
    }
  }
  double range[2];
  FindBezierRange(net, component == 0 ? x.Rest : x.Weights, component == 1 ? y.Rest : y.Weights,
    component == 2 ? z.Rest : z.Weights, range);
  image.Min[component] = std::min(image.Min[component], range[0]);
  image.Max[component] = std::max(image.Max[component], range[1]);
}

//------------------------------------------------------------------------------
Box PullBackBounds::ForwardImage(const Box& region, const ParallelFor& parallelFor) const
{
  Box image = EmptyBox();
  glm::ivec3 first;
  glm::ivec3 last;
  if (!this->FindSubCells(region, first, last))
  {
    return image;
  }
  const SubCellEnds ends(*this);
  // Without those that are only within rounding of the region.
  for (int a = 0; a < 3; ++a)
  {
    while (first[a] <= last[a] && ends.Max[a][static_cast<std::size_t>(first[a])] < region.Min[a])
    {
      ++first[a];
    }
    while (first[a] <= last[a] && ends.Min[a][static_cast<std::size_t>(last[a])] > region.Max[a])
    {
      --last[a];
    }
  }
  if (glm::any(glm::greaterThan(first, last)))
  {
    return image;
  }
  const AxisParts axes[3] = { AxisParts(*this->Field, 0, region, ends, first.x, last.x),
    AxisParts(*this->Field, 1, region, ends, first.y, last.y),
    AxisParts(*this->Field, 2, region, ends, first.z, last.z) };
  const glm::ivec3 count = last - first + 1;
  const auto reachOf = [&](const glm::ivec3& at) {
    const AxisParts::Part& x = axes[0].Parts[static_cast<std::size_t>(at.x)];
    const AxisParts::Part& y = axes[1].Parts[static_cast<std::size_t>(at.y)];
    const AxisParts::Part& z = axes[2].Parts[static_cast<std::size_t>(at.z)];
    const Box d = this->GetDisplacement(first + at);
    return Box{ glm::dvec3(x.Min, y.Min, z.Min) + d.Min, glm::dvec3(x.Max, y.Max, z.Max) + d.Max };
  };
  // Those that may reach farthest come first, by their boxes: of the others nearly all are within
  // their image already and cost a comparison each.
  std::vector<Box> rows(static_cast<std::size_t>(count.y) * static_cast<std::size_t>(count.z));
  RunFor(parallelFor, rows.size(), [&](std::size_t firstRow, std::size_t endRow) {
    for (std::size_t r = firstRow; r < endRow; ++r)
    {
      glm::ivec3 of(0, static_cast<int>(r) % count.y, static_cast<int>(r) / count.y);
      Box row = EmptyBox();
      for (; of.x < count.x; ++of.x)
      {
        Include(row, reachOf(of));
      }
      rows[r] = row;
    }
  });
  glm::ivec3 lowest[3] = { glm::ivec3(0), glm::ivec3(0), glm::ivec3(0) };
  glm::ivec3 highest[3] = { glm::ivec3(0), glm::ivec3(0), glm::ivec3(0) };
  for (int a = 0; a < 3; ++a)
  {
    int low = 0;
    int high = 0;
    for (int r = 0; r < count.y * count.z; ++r)
    {
      const Box& row = rows[static_cast<std::size_t>(r)];
      low = row.Min[a] < rows[static_cast<std::size_t>(low)].Min[a] ? r : low;
      high = row.Max[a] > rows[static_cast<std::size_t>(high)].Max[a] ? r : high;
    }
    lowest[a] = { 0, low % count.y, low / count.y };
    highest[a] = { 0, high % count.y, high / count.y };
    for (int i = 1; i < count.x; ++i)
    {
      const glm::ivec3 one(i, lowest[a].y, lowest[a].z);
      const glm::ivec3 other(i, highest[a].y, highest[a].z);
      lowest[a] = reachOf(one).Min[a] < reachOf(lowest[a]).Min[a] ? one : lowest[a];
      highest[a] = reachOf(other).Max[a] > reachOf(highest[a]).Max[a] ? other : highest[a];
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    this->IncludeImage(axes, lowest[a], a, image);
    this->IncludeImage(axes, highest[a], a, image);
  }
  const Box* row = rows.data();
  glm::ivec3 at;
  for (at.z = 0; at.z < count.z; ++at.z)
  {
    for (at.y = 0; at.y < count.y; ++at.y, ++row)
    {
      for (at.x = 0; at.x < count.x && !Contains(image, *row); ++at.x)
      {
        const Box reach = reachOf(at);
        for (int a = 0; a < 3; ++a)
        {
          if (reach.Min[a] < image.Min[a] || reach.Max[a] > image.Max[a])
          {
            this->IncludeImage(axes, at, a, image);
          }
        }
      }
    }
  }
  // Rounding of the sums above.
  const glm::dvec3 slack = 1e-12 *
    (glm::max(glm::abs(image.Min), glm::abs(image.Max)) + glm::abs(this->Field->GetSpacing()));
  return { image.Min - slack, image.Max + slack };
}

//------------------------------------------------------------------------------
PullBackLimits PullBackBounds::GetLimits() const
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  const MapBounds everywhere = this->Over({ glm::dvec3(-Infinity), glm::dvec3(Infinity) });
  PullBackLimits limits;
  limits.OneToOne = !this->RestRegions || this->ProvenInvertible;
  const glm::dmat3 low = Absolute(everywhere.JacobianMin);
  const glm::dmat3 high = Absolute(everywhere.JacobianMax);
  const glm::dmat3 largest(
    glm::max(low[0], high[0]), glm::max(low[1], high[1]), glm::max(low[2], high[2]));
  limits.LargestStretch = std::sqrt(LargestRowSum(largest) * LargestRowSum(glm::transpose(largest)));
  return limits;
}

} // namespace ffd
