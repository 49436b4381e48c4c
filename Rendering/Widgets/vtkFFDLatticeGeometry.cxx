// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeGeometry.h"

#include "vtkFFDLattice.h"
#include "vtkFFDProjection.h"

#include "FFDBSplineBasis.h"
#include "FFDBSplineField.h"
#include "FFDLattice.h"

#include "vtkMath.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace
{

constexpr int OutlineSegments = 24;

/// Segments of a curved line per cell; fewer where the cells are many.
constexpr int SegmentsPerCell = 8;
constexpr int FewSegmentsPerCell = 4;
constexpr int ManyNodes = 12;

/// Sizes of special points, as factors of the size of a control point.
constexpr double HoveredSize = 1.4;
constexpr double SelectedSize = 1.15;

bool IsFinite(const glm::dvec3& p) { return std::isfinite(p.x + p.y + p.z); }

} // namespace

//------------------------------------------------------------------------------
vtkFFDLatticeGeometry::vtkFFDLatticeGeometry(
  const ffd::Lattice& lattice, const glm::dmat4& dataToWorld, bool interior)
  : Lattice(lattice)
  , DataToWorld(dataToWorld)
  , Interior(interior)
  , Positions(lattice.GetControlPoints())
{
  for (glm::dvec3& position : this->Positions)
  {
    position = vtkFFDTransformPoint(dataToWorld, position);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeGeometry::IsShown(std::size_t point) const
{
  if (this->Interior)
  {
    return true;
  }
  const glm::ivec3 at = this->Lattice.IndicesOf(point);
  const glm::ivec3 last = this->Lattice.Net.Nodes - 1;
  return at.x == 0 || at.y == 0 || at.z == 0 || at.x == last.x || at.y == last.y || at.z == last.z;
}

//------------------------------------------------------------------------------
/// makeLine(axis, at, points) appends the line along an axis through control point `at`, whose
/// index on that axis is 0.
template <class MakeLine>
vtkFFDLatticeGeometry::Lines vtkFFDLatticeGeometry::MakeLines(const MakeLine& makeLine) const
{
  const glm::ivec3& nodes = this->Lattice.Net.Nodes;
  Lines lines;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    glm::ivec3 at(0);
    for (at[c] = 0; at[c] < nodes[c]; ++at[c])
    {
      for (at[b] = 0; at[b] < nodes[b]; ++at[b])
      {
        const bool outer =
          at[b] == 0 || at[c] == 0 || at[b] == nodes[b] - 1 || at[c] == nodes[c] - 1;
        if (outer || this->Interior)
        {
          makeLine(axis, at, lines.Points);
          lines.Ends.push_back(lines.Points.size());
        }
      }
    }
  }
  return lines;
}

//------------------------------------------------------------------------------
vtkFFDLatticeGeometry::Lines vtkFFDLatticeGeometry::MakeStraightLines() const
{
  return this->MakeLines([this](int axis, glm::ivec3 at, std::vector<glm::dvec3>& points) {
    for (; at[axis] < this->Lattice.Net.Nodes[axis]; ++at[axis])
    {
      points.push_back(this->GetPosition(this->Lattice.IndexOf(at)));
    }
  });
}

//------------------------------------------------------------------------------
vtkFFDLatticeGeometry::Lines vtkFFDLatticeGeometry::MakeCurvedLines() const
{
  if (!this->Lattice.FindProblem().empty())
  {
    return this->MakeStraightLines();
  }
  const ffd::BSplineField field = this->Lattice.MakeField();
  const glm::ivec3& nodes = this->Lattice.Net.Nodes;
  const int segments =
    std::max({ nodes.x, nodes.y, nodes.z }) > ManyNodes ? FewSegmentsPerCell : SegmentsPerCell;
  std::vector<glm::dvec3> row;
  return this->MakeLines([&](int axis, const glm::ivec3& at, std::vector<glm::dvec3>& points) {
    // The weights across the row are those of a knot, so they are taken together first.
    constexpr double knot[3] = { 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0 };
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    row.assign(static_cast<std::size_t>(nodes[axis]) + 2, glm::dvec3(0.0));
    for (int i = -1; i <= nodes[axis]; ++i)
    {
      glm::ivec3 from;
      from[axis] = i;
      for (int v = 0; v < 3; ++v)
      {
        from[c] = at[c] + v - 1;
        for (int u = 0; u < 3; ++u)
        {
          from[b] = at[b] + u - 1;
          row[static_cast<std::size_t>(i + 1)] +=
            knot[u] * knot[v] * field.Coefficient(from.x, from.y, from.z);
        }
      }
    }
    for (int s = 0; s <= segments * (nodes[axis] - 1); ++s)
    {
      const int cell = std::min(s / segments, nodes[axis] - 2);
      const double u = static_cast<double>(s - segments * cell) / segments;
      double w[4];
      ffd::BSplineWeights(u, w);
      glm::dvec3 p = this->Lattice.GetRestPoint(at);
      p[axis] += (cell + u) * this->Lattice.Spacing[axis];
      for (int i = 0; i < 4; ++i)
      {
        p += w[i] * row[static_cast<std::size_t>(cell + i)];
      }
      points.push_back(vtkFFDTransformPoint(this->DataToWorld, p));
    }
  });
}

//------------------------------------------------------------------------------
vtkFFDLatticeGeometry::Lines vtkFFDLatticeGeometry::MakeOutline(
  vtkFFDLattice* transform, const double bounds[6]) const
{
  Lines outline;
  transform->Update();
  for (int axis = 0; axis < 3; ++axis)
  {
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    for (int corner = 0; corner < 4; ++corner)
    {
      for (int s = 0; s <= OutlineSegments; ++s)
      {
        const double t = static_cast<double>(s) / OutlineSegments;
        glm::dvec3 p;
        p[axis] = glm::mix(bounds[2 * axis], bounds[2 * axis + 1], t);
        p[b] = bounds[2 * b + (corner & 1)];
        p[c] = bounds[2 * c + (corner >> 1)];
        glm::dvec3 q;
        transform->InternalTransformPoint(&p.x, &q.x);
        outline.Points.push_back(vtkFFDTransformPoint(this->DataToWorld, q));
      }
      outline.Ends.push_back(outline.Points.size());
    }
  }
  return outline;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeGeometry::FindBounds(
  const std::vector<const Lines*>& lines, double bounds[6]) const
{
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  const auto include = [&low, &high](const glm::dvec3& p) {
    if (IsFinite(p))
    {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  };
  std::for_each(this->Positions.begin(), this->Positions.end(), include);
  for (const Lines* one : lines)
  {
    std::for_each(one->Points.begin(), one->Points.end(), include);
  }
  vtkMath::UninitializeBounds(bounds);
  for (int a = 0; a < 3 && low.x <= high.x; ++a)
  {
    bounds[2 * a] = low[a];
    bounds[2 * a + 1] = high[a];
  }
}

//------------------------------------------------------------------------------
std::vector<vtkFFDLatticeScene::Glyph> vtkFFDLatticeGeometry::MakeGlyphs(
  const ffd::LatticeEditor& editor, std::ptrdiff_t hovered, const GlyphLook& look) const
{
  const ffd::PointSet locked = editor.GetLocked();
  std::vector<vtkFFDLatticeScene::Glyph> glyphs;
  glyphs.reserve(editor.GetNumberOfPoints());
  for (std::size_t p = 0; p < editor.GetNumberOfPoints(); ++p)
  {
    if (!this->IsShown(p) || !IsFinite(this->Positions[p]))
    {
      continue;
    }
    const bool isHovered = static_cast<std::ptrdiff_t>(p) == hovered;
    const bool isSelected = editor.GetSelected()[p] != 0;
    glyphs.push_back({ this->GetPosition(p),
      look.Size *
        (isHovered       ? HoveredSize
            : isSelected ? SelectedSize
                         : 1.0),
      isHovered      ? look.Hovered
        : isSelected ? look.Selected
        : locked[p]  ? look.Locked
                     : look.Plain });
  }
  return glyphs;
}

//------------------------------------------------------------------------------
std::vector<vtkFFDLatticeScene::Label> vtkFFDLatticeGeometry::MakeLabels(
  const ffd::LatticeEditor& editor, std::ptrdiff_t hovered) const
{
  std::vector<vtkFFDLatticeScene::Label> labels;
  for (std::size_t p = 0; p < editor.GetNumberOfPoints(); ++p)
  {
    const bool named = editor.GetSelected()[p] || static_cast<std::ptrdiff_t>(p) == hovered;
    if (named && this->IsShown(p) && IsFinite(this->Positions[p]))
    {
      const glm::ivec3 at = this->Lattice.IndicesOf(p);
      labels.push_back({ this->GetPosition(p),
        std::to_string(at.x) + ", " + std::to_string(at.y) + ", " + std::to_string(at.z) });
    }
  }
  return labels;
}
