// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPullBackChange.h"

#include "FFDBSplineBasis.h"
#include "FFDSplineGrid.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace ffd
{

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// A cell is cut into so many parts an axis at most, and there are so many in all.
constexpr int MostPartsPerCell = 16;
constexpr std::size_t MostParts = 100000;

/// Parts of the cells [First, End) of one axis.
struct AxisParts
{
  int First = 0;
  int End = 0;
  int PerCell = 1;
  std::vector<std::array<double, 4>> Largest; ///< value of each of the 4 basis functions, by part
  std::vector<std::array<double, 4>> AtEnds;  ///< their values at the ends, by end
  std::vector<double> Ends;                   ///< data coordinate of each end

  int Count() const { return (this->End - this->First) * this->PerCell; }
  /// First of the 4 control points that count in a part, or at the end before it.
  int NodeOf(int part) const
  {
    return this->First + std::min(part, this->Count() - 1) / this->PerCell - 1;
  }
};

AxisParts MakeParts(const BSplineField& field, int axis, int first, int end, double resolution)
{
  AxisParts parts;
  parts.First = first;
  parts.End = end;
  const double spacing = field.GetSpacing()[axis];
  parts.PerCell =
    std::clamp(static_cast<int>(std::lround(std::abs(spacing) / resolution)), 1, MostPartsPerCell);
  const double step = 1.0 / parts.PerCell;
  for (int i = 0; i <= parts.Count(); ++i)
  {
    // The last end is that of the last cell, not the start of the next one.
    const int cell = std::min(i, parts.Count() - 1) / parts.PerCell;
    const double u = (i - cell * parts.PerCell) * step;
    std::array<double, 4> here;
    BSplineWeights(u, here.data());
    parts.AtEnds.push_back(here);
    parts.Ends.push_back(field.GetOrigin()[axis] + spacing * (first + cell + u));
    if (i < parts.Count())
    {
      // Each of the four segments is monotone, so the largest value is at an end.
      std::array<double, 4> next;
      BSplineWeights(u + step, next.data());
      std::array<double, 4> largest;
      std::transform(here.begin(), here.end(), next.begin(), largest.begin(),
        [](double a, double b) { return std::max(a, b); });
      parts.Largest.push_back(largest);
    }
  }
  return parts;
}

/// All three axes: at the parts, by their largest weights, or at their ends, by the values there.
template <class T>
Grid<T> SumOver(const Grid<T>& nodes, const AxisParts parts[3], bool ends)
{
  Grid<T> sums = nodes;
  for (int a = 0; a < 3; ++a)
  {
    std::vector<int> offsets;
    for (int i = 0; i < parts[a].Count() + (ends ? 1 : 0); ++i)
    {
      offsets.push_back(parts[a].NodeOf(i) - (parts[a].First - 1));
    }
    sums = SumAlong(sums, a, ends ? parts[a].AtEnds : parts[a].Largest, offsets);
  }
  return sums;
}

/// Parts of which nothing can be seen have not moved.
void ForgetEmptyParts(
  const AxisParts parts[3], const IsEmptyAtRest& isEmpty, PullBackChange& change)
{
  std::size_t part = 0;
  for (int k = 0; k < change.Parts.z; ++k)
  {
    for (int j = 0; j < change.Parts.y; ++j)
    {
      for (int i = 0; i < change.Parts.x; ++i, ++part)
      {
        if (!(change.Moved[part] > 0.0))
        {
          continue;
        }
        const glm::ivec3 at(i, j, k);
        Box rest;
        for (int a = 0; a < 3; ++a)
        {
          const double* ends = &parts[a].Ends[static_cast<std::size_t>(at[a])];
          rest.Min[a] = std::min(ends[0], ends[1]);
          rest.Max[a] = std::max(ends[0], ends[1]);
        }
        if (isEmpty(rest))
        {
          change.Moved[part] = 0.0;
        }
      }
    }
  }
}

/// The control points, those of the border included, that an edit has changed, and by how much.
struct Edit
{
  glm::ivec3 Low{ std::numeric_limits<int>::max() / 2 };
  glm::ivec3 High{ std::numeric_limits<int>::min() / 2 };
  double Largest = 0.0;
};

/// False where a displacement is not a number.
bool FindEdit(const BSplineField& old, const BSplineField& now, Edit& edit)
{
  const glm::ivec3 padded = now.GetPaddedNodes();
  std::size_t n = 0;
  for (int k = 0; k < padded.z; ++k)
  {
    for (int j = 0; j < padded.y; ++j)
    {
      for (int i = 0; i < padded.x; ++i, ++n)
      {
        const glm::dvec3& was = old.GetCoefficients()[n];
        const glm::dvec3& is = now.GetCoefficients()[n];
        if (was != is)
        {
          const glm::ivec3 node = glm::ivec3(i, j, k) - BSplineField::Padding;
          edit.Low = glm::min(edit.Low, node);
          edit.High = glm::max(edit.High, node);
          const double by = glm::length(is - was);
          if (!(by < Infinity))
          {
            return false;
          }
          edit.Largest = std::max(edit.Largest, by);
        }
      }
    }
  }
  return true;
}

bool HaveSameGrid(const BSplineField& a, const BSplineField& b)
{
  return a.GetNodes() == b.GetNodes() && a.GetOrigin() == b.GetOrigin() &&
    a.GetSpacing() == b.GetSpacing() && a.GetBorder() == b.GetBorder();
}

} // namespace

//------------------------------------------------------------------------------
bool FindChange(const PullBack& before, const PullBack& after, const PullBackLimits& limits,
  const Box& region, double resolution, const IsEmptyAtRest& isEmpty, PullBackChange& change)
{
  change = PullBackChange();
  if (!before.GetField() || !after.GetField() || before.GetKind() != after.GetKind() ||
    !HaveSameGrid(*before.GetField(), *after.GetField()))
  {
    return false;
  }
  const BSplineField& old = *before.GetField();
  const BSplineField& now = *after.GetField();
  const bool inverts = InvertsTheField(after.GetKind());
  if (inverts && !limits.OneToOne)
  {
    return false;
  }
  Edit edit;
  if (!FindEdit(old, now, edit))
  {
    return false;
  }
  const glm::ivec3 first = glm::max(edit.Low - 2, now.GetFirstCell());
  const glm::ivec3 end = glm::min(edit.High + 2, now.GetEndCell());
  if (glm::any(glm::lessThanEqual(end, first)))
  {
    return true;
  }
  AxisParts parts[3];
  std::size_t count = 1;
  for (int a = 0; a < 3; ++a)
  {
    parts[a] = MakeParts(now, a, first[a], end[a], resolution);
    change.Parts[a] = parts[a].Count();
    count *= static_cast<std::size_t>(parts[a].Count());
  }
  if (count > MostParts)
  {
    return false;
  }

  Grid<double> edits(end - first + 3);
  Grid<glm::dvec3> nodes(end - first + 3);
  for (int k = 0; k < nodes.Size.z; ++k)
  {
    for (int j = 0; j < nodes.Size.y; ++j)
    {
      for (int i = 0; i < nodes.Size.x; ++i)
      {
        const glm::ivec3 at = first - 1 + glm::ivec3(i, j, k);
        nodes.At(i, j, k) = old.Coefficient(at.x, at.y, at.z);
        edits.At(i, j, k) = glm::length(now.Coefficient(at.x, at.y, at.z) - nodes.At(i, j, k));
      }
    }
  }
  change.Moved = SumOver(edits, parts, false).Values;

  // The first and the last part of the field go on for ever: as far as they matter.
  glm::dvec3 lowest = region.Min;
  glm::dvec3 highest = region.Max;
  if (inverts)
  {
    const double largest = std::numeric_limits<double>::max();
    const double stretch = std::min(limits.LargestStretch, largest);
    const double reach = std::min(stretch * edit.Largest, largest);
    lowest -= reach;
    highest += reach;
    if (after.GetKind() == PullBackKind::FirstOrderOfInverse)
    {
      for (double& moved : change.Moved)
      {
        moved *= stretch;
      }
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    const bool ascending = now.GetSpacing()[a] > 0.0;
    const auto extend = [&](double& at, bool down) {
      at = down ? std::min(at, lowest[a]) : std::max(at, highest[a]);
    };
    if (first[a] == now.GetFirstCell()[a])
    {
      extend(parts[a].Ends.front(), ascending);
    }
    if (end[a] == now.GetEndCell()[a])
    {
      extend(parts[a].Ends.back(), !ascending);
    }
  }

  if (isEmpty && after.GetKind() == PullBackKind::Exact)
  {
    ForgetEmptyParts(parts, isEmpty, change);
  }

  Grid<glm::dvec3> corners(change.Parts + 1);
  if (inverts)
  {
    corners = SumOver(nodes, parts, true);
    change.Margin =
      FindBulge(nodes, 1.0 / glm::dvec3(parts[0].PerCell, parts[1].PerCell, parts[2].PerCell));
  }
  for (int k = 0; k < corners.Size.z; ++k)
  {
    for (int j = 0; j < corners.Size.y; ++j)
    {
      for (int i = 0; i < corners.Size.x; ++i)
      {
        corners.At(i, j, k) += glm::dvec3(parts[0].Ends[static_cast<std::size_t>(i)],
          parts[1].Ends[static_cast<std::size_t>(j)], parts[2].Ends[static_cast<std::size_t>(k)]);
      }
    }
  }
  change.Corners = std::move(corners.Values);
  return true;
}

} // namespace ffd
