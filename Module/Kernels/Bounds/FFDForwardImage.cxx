// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDForwardImage.h"

#include "FFDGridIndex.h"

#include "Bounds/FFDSubCellBounds.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ffd
{
namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

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

/// Unions of 4 neighbors along an axis; `size` is that of the grid, which becomes smaller by 3.
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
      const Box* first = &boxes[GridIndex(0, j, k, from)];
      for (int i = 0; i < size.x; ++i, ++first)
      {
        Box sum = *first;
        sum.Include(first[stride]);
        sum.Include(first[2 * stride]);
        sum.Include(first[3 * stride]);
        *to++ = sum;
      }
    }
  }
}

/// The parts of a region in the sub-cells of one axis.
struct AxisParts
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
      const SubCellEnds ends = FindSubCellEnds(field, axis, i);
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
      const int cell = FindCellOfSubCell(field, axis, i);
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

/// Add one component of the image under T of the parts of a cell, tight.
void IncludeImage(const BSplineField& field, const AxisParts axes[3], const glm::ivec3& cell,
  int component, Box& image)
{
  double net[64];
  double* to = net;
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* row = &field.Coefficient(axes[0].FirstCell + cell.x - 1,
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

} // namespace

//------------------------------------------------------------------------------
Box FindForwardImage(const BSplineField& field, const Box& region)
{
  Box image = Box::Empty();
  glm::ivec3 first;
  glm::ivec3 last;
  if (!FindSubCells(field, region, first, last))
  {
    return image;
  }
  const AxisParts axes[3] = { AxisParts(field, 0, region, first.x, last.x),
    AxisParts(field, 1, region, first.y, last.y), AxisParts(field, 2, region, first.z, last.z) };
  const glm::ivec3 cells(static_cast<int>(axes[0].Cells.size()),
    static_cast<int>(axes[1].Cells.size()), static_cast<int>(axes[2].Cells.size()));
  if (glm::any(glm::equal(cells, glm::ivec3(0))))
  {
    return image;
  }
  // The points that each cell may reach: its rest box moved by the hull of its control points.
  glm::ivec3 size = cells + 3;
  std::vector<Box> reaches;
  reaches.reserve(GridSize(size));
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
  Box farthest = Box::Empty();
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
  // Cells that may reach farthest come first: nearly all others are within their image already.
  for (int a = 0; a < 3; ++a)
  {
    IncludeImage(field, axes, lowest[a], a, image);
    IncludeImage(field, axes, highest[a], a, image);
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
            IncludeImage(field, axes, at, a, image);
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
