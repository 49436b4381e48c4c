// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDeformedSpaceBounds.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

constexpr int LargestResolution = 16;

glm::dmat3 EntrywiseMin(const glm::dmat3& a, const glm::dmat3& b)
{
  return glm::dmat3(glm::min(a[0], b[0]), glm::min(a[1], b[1]), glm::min(a[2], b[2]));
}

glm::dmat3 EntrywiseMax(const glm::dmat3& a, const glm::dmat3& b)
{
  return glm::dmat3(glm::max(a[0], b[0]), glm::max(a[1], b[1]), glm::max(a[2], b[2]));
}

} // namespace

//------------------------------------------------------------------------------
MapBounds Unite(const MapBounds& a, const MapBounds& b)
{
  MapBounds both;
  both.JacobianMin = EntrywiseMin(a.JacobianMin, b.JacobianMin);
  both.JacobianMax = EntrywiseMax(a.JacobianMax, b.JacobianMax);
  both.SecondDerivative = std::max(a.SecondDerivative, b.SecondDerivative);
  both.ThirdDerivative = std::max(a.ThirdDerivative, b.ThirdDerivative);
  return both;
}

//------------------------------------------------------------------------------
DeformedSpaceBounds::DeformedSpaceBounds(
  const PullBack& pullBack, const PullBackBounds& bounds, const Box& region)
  : Region(region)
{
  if (pullBack.IsIdentity())
  {
    this->CellSize = glm::max(region.Max - region.Min, glm::dvec3(1e-300));
    this->Bounds.assign(1, MapBounds());
    return;
  }
  // About two cells a lattice cell: the sub-cells of PullBackBounds are that size.
  const glm::dvec3 spacing = glm::abs(pullBack.GetField()->GetSpacing());
  const glm::dvec3 size = region.Max - region.Min;
  for (int a = 0; a < 3; ++a)
  {
    const double cells = std::ceil(2.0 * size[a] / spacing[a]);
    this->Cells[a] = static_cast<int>(std::max(1.0, std::min<double>(LargestResolution, cells)));
    this->CellSize[a] = std::max(size[a] / this->Cells[a], 1e-300);
  }
  if (bounds.RegionsAreInRestSpace())
  {
    this->FillFromRestRegions(bounds, *pullBack.GetField());
  }
  else
  {
    this->FillFromDeformedRegions(bounds);
  }
}

//------------------------------------------------------------------------------
std::size_t DeformedSpaceBounds::IndexOf(int i, int j, int k) const
{
  return i +
    static_cast<std::size_t>(this->Cells.x) *
    (j + static_cast<std::size_t>(this->Cells.y) * static_cast<std::size_t>(k));
}

//------------------------------------------------------------------------------
glm::ivec3 DeformedSpaceBounds::CellOf(const glm::dvec3& p) const
{
  const glm::dvec3 last(this->Cells - 1);
  const glm::dvec3 x = glm::floor((p - this->Region.Min) / this->CellSize);
  return glm::ivec3(glm::max(glm::dvec3(0.0), glm::min(last, x)));
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::FillFromDeformedRegions(const PullBackBounds& bounds)
{
  this->Bounds.resize(IndexOf(0, 0, this->Cells.z));
  for (int k = 0; k < this->Cells.z; ++k)
  {
    for (int j = 0; j < this->Cells.y; ++j)
    {
      for (int i = 0; i < this->Cells.x; ++i)
      {
        Box cell;
        cell.Min = this->Region.Min + glm::dvec3(i, j, k) * this->CellSize;
        cell.Max = cell.Min + this->CellSize;
        this->Bounds[this->IndexOf(i, j, k)] = bounds.Over(cell);
      }
    }
  }
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::FillFromRestRegions(
  const PullBackBounds& bounds, const BSplineField& field)
{
  // Every rest point that maps into the region lies in the region less a displacement.
  const Box everywhere = bounds.DisplacementOver(
    { glm::dvec3(-1e300), glm::dvec3(1e300) });
  const glm::dvec3 restMin = this->Region.Min - everywhere.Max;
  const glm::dvec3 restMax = this->Region.Max - everywhere.Min;

  // Walk that box in steps of half a lattice cell, aligned with the lattice.
  const glm::dvec3 step = 0.5 * glm::abs(field.GetSpacing());
  const glm::ivec3 first(glm::floor((restMin - field.GetOrigin()) / step));
  const glm::ivec3 last(glm::floor((restMax - field.GetOrigin()) / step));
  // Cells outside of the lattice have constant displacement along that axis: one box for them all.
  const glm::ivec3 firstOutside = 2 * field.GetFirstCell() - 1;
  const glm::ivec3 lastOutside = 2 * field.GetEndCell();
  const glm::ivec3 low = glm::clamp(first, firstOutside, lastOutside);
  const glm::ivec3 high = glm::clamp(last, firstOutside, lastOutside);

  std::vector<bool> touched(IndexOf(0, 0, this->Cells.z), false);
  this->Bounds.resize(touched.size());
  for (int k = low.z; k <= high.z; ++k)
  {
    for (int j = low.y; j <= high.y; ++j)
    {
      for (int i = low.x; i <= high.x; ++i)
      {
        const glm::ivec3 at(i, j, k);
        Box rest;
        rest.Min = field.GetOrigin() + glm::dvec3(at) * step;
        rest.Max = rest.Min + step;
        for (int a = 0; a < 3; ++a)
        {
          rest.Min[a] = at[a] == low[a] ? std::min(rest.Min[a], restMin[a]) : rest.Min[a];
          rest.Max[a] = at[a] == high[a] ? std::max(rest.Max[a], restMax[a]) : rest.Max[a];
        }
        // The neighbours share this sub-cell's faces: stay off them, unless the kink of
        // ZeroAtBorder may lie there, which has to be noticed.
        const glm::dvec3 inset =
          field.GetBorder() == BorderMode::ZeroAtBorder ? glm::dvec3(0.0) : 1e-7 * step;
        const Box inner{ rest.Min + inset, rest.Max - inset };
        const MapBounds here = bounds.Over(inner);
        const Box moves = bounds.DisplacementOver(inner);
        const glm::ivec3 from = this->CellOf(rest.Min + moves.Min);
        const glm::ivec3 to = this->CellOf(rest.Max + moves.Max);
        for (int c = from.z; c <= to.z; ++c)
        {
          for (int b = from.y; b <= to.y; ++b)
          {
            for (int a = from.x; a <= to.x; ++a)
            {
              const std::size_t index = this->IndexOf(a, b, c);
              this->Bounds[index] = touched[index] ? Unite(this->Bounds[index], here) : here;
              touched[index] = true;
            }
          }
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
MapBounds DeformedSpaceBounds::Over(const Box& box) const
{
  const glm::ivec3 from = this->CellOf(box.Min);
  const glm::ivec3 to = this->CellOf(box.Max);
  MapBounds all = this->Bounds[this->IndexOf(from.x, from.y, from.z)];
  for (int k = from.z; k <= to.z; ++k)
  {
    for (int j = from.y; j <= to.y; ++j)
    {
      for (int i = from.x; i <= to.x; ++i)
      {
        all = Unite(all, this->Bounds[this->IndexOf(i, j, k)]);
      }
    }
  }
  return all;
}

} // namespace ffd
