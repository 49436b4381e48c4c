// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDeformedSpaceBounds.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace ffd
{
namespace
{

/// Cells a side, so that the grid takes at most 20 kB.
constexpr int LargestResolution = 8;

/// The upper half of the bits of a float that is not below x.
std::uint16_t RoundUp(double x)
{
  float single = static_cast<float>(x);
  if (static_cast<double>(single) < x)
  {
    single = std::nextafter(single, std::numeric_limits<float>::infinity());
  }
  std::uint32_t bits;
  std::memcpy(&bits, &single, sizeof(bits));
  // Cutting bits off makes a number smaller, and a negative one larger.
  bits += single > 0.0f ? 0xFFFFu : 0u;
  return static_cast<std::uint16_t>(bits >> 16);
}

float ToFloat(std::uint16_t upper)
{
  const std::uint32_t bits = static_cast<std::uint32_t>(upper) << 16;
  float single;
  std::memcpy(&single, &bits, sizeof(single));
  return single;
}

/// Order of CellBounds::Upper.
constexpr int NegativeJacobian = 9;
constexpr int SecondDerivative = 18;
constexpr int ThirdDerivative = 19;

} // namespace

//------------------------------------------------------------------------------
void DeformedSpaceBounds::CellBounds::Include(const MapBounds& bounds)
{
  const auto include = [this](int i, double value)
  {
    const std::uint16_t upper = RoundUp(value);
    if (ToFloat(upper) > ToFloat(this->Upper[i]))
    {
      this->Upper[i] = upper;
    }
  };
  for (int i = 0; i < 9; ++i)
  {
    include(i, bounds.JacobianMax[i / 3][i % 3]);
    include(NegativeJacobian + i, -bounds.JacobianMin[i / 3][i % 3]);
  }
  include(SecondDerivative, bounds.SecondDerivative);
  include(ThirdDerivative, bounds.ThirdDerivative);
}

//------------------------------------------------------------------------------
DeformedSpaceBounds::DeformedSpaceBounds(
  const PullBack& pullBack, const PullBackBounds& bounds, const Box& region)
  : Region(region)
{
  CellBounds nothing;
  std::fill_n(nothing.Upper, 18, RoundUp(-std::numeric_limits<double>::infinity()));
  nothing.Upper[SecondDerivative] = 0;
  nothing.Upper[ThirdDerivative] = 0;
  if (pullBack.IsIdentity())
  {
    this->Identity = true;
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
  this->Bounds.assign(this->IndexOf(0, 0, this->Cells.z), nothing);
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
  for (int k = 0; k < this->Cells.z; ++k)
  {
    for (int j = 0; j < this->Cells.y; ++j)
    {
      for (int i = 0; i < this->Cells.x; ++i)
      {
        Box cell;
        cell.Min = this->Region.Min + glm::dvec3(i, j, k) * this->CellSize;
        cell.Max = cell.Min + this->CellSize;
        this->Bounds[this->IndexOf(i, j, k)].Include(bounds.Over(cell));
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

  // The neighbours share a sub-cell's faces: stay off them. But where the field has a kink in such
  // a face, what it does to the derivatives must be seen.
  const double shrink = field.GetBorder() == BorderMode::ZeroAtBorder ? 0.0 : 1e-7;
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
        const glm::dvec3 inset = shrink * step;
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
              this->Bounds[this->IndexOf(a, b, c)].Include(here);
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
  MapBounds bounds;
  if (this->Identity)
  {
    return bounds;
  }
  const bool known = glm::all(glm::greaterThanEqual(box.Min, this->Region.Min)) &&
    glm::all(glm::lessThanEqual(box.Max, this->Region.Max));
  if (!known)
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (int column = 0; column < 3; ++column)
    {
      bounds.JacobianMin[column] = glm::dvec3(-infinity);
      bounds.JacobianMax[column] = glm::dvec3(infinity);
    }
    bounds.SecondDerivative = infinity;
    bounds.ThirdDerivative = infinity;
    return bounds;
  }
  const glm::ivec3 from = this->CellOf(box.Min);
  const glm::ivec3 to = this->CellOf(box.Max);
  float all[20];
  std::fill_n(all, 20, -std::numeric_limits<float>::infinity());
  for (int k = from.z; k <= to.z; ++k)
  {
    for (int j = from.y; j <= to.y; ++j)
    {
      for (int i = from.x; i <= to.x; ++i)
      {
        const CellBounds& cell = this->Bounds[this->IndexOf(i, j, k)];
        for (int e = 0; e < 20; ++e)
        {
          all[e] = std::max(all[e], ToFloat(cell.Upper[e]));
        }
      }
    }
  }
  for (int e = 0; e < 9; ++e)
  {
    bounds.JacobianMin[e / 3][e % 3] = -all[NegativeJacobian + e];
    bounds.JacobianMax[e / 3][e % 3] = all[e];
  }
  bounds.SecondDerivative = all[SecondDerivative];
  bounds.ThirdDerivative = all[ThirdDerivative];
  return bounds;
}

} // namespace ffd
