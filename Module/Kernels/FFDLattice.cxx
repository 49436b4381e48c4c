// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLattice.h"

#include "FFDGridIndex.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ffd
{
namespace
{

/// False for what is not a number, too.
bool IsWithinRange(const glm::dvec3& v)
{
  return std::abs(v.x) <= Lattice::LargestLength && std::abs(v.y) <= Lattice::LargestLength &&
    std::abs(v.z) <= Lattice::LargestLength;
}

} // namespace

//------------------------------------------------------------------------------
Lattice::Lattice()
{
  this->Net.Nodes = glm::ivec3(MinimumNodes);
  this->Net.Values.assign(GridSize(this->Net.Nodes), glm::dvec3(0.0));
}

//------------------------------------------------------------------------------
Lattice::Lattice(ControlNet net, const glm::dvec3& origin, const glm::dvec3& spacing)
  : Net(std::move(net))
  , Origin(origin)
  , Spacing(spacing)
{
}

//------------------------------------------------------------------------------
Lattice::Lattice(const glm::ivec3& nodes, const Box& domain)
{
  this->Net.Nodes = nodes;
  this->Net.Values.assign(GridSize(nodes), glm::dvec3(0.0));
  this->SetDomain(domain);
}

//------------------------------------------------------------------------------
bool Lattice::HasPossibleDimensions() const
{
  const glm::ivec3& n = this->Net.Nodes;
  return std::min({ n.x, n.y, n.z }) >= MinimumNodes && std::max({ n.x, n.y, n.z }) <= MaximumNodes;
}

//------------------------------------------------------------------------------
std::string Lattice::FindProblem() const
{
  for (int a = 0; a < 3; ++a)
  {
    const int n = this->Net.Nodes[a];
    if (n < MinimumNodes || n > MaximumNodes)
    {
      return "the dimensions must be from 4 to 1024 control points per axis, axis " +
        std::to_string(a) + " has " + std::to_string(n);
    }
    const double first = this->Origin[a];
    const double last = this->Origin[a] + (n - 1) * this->Spacing[a];
    if (!(std::abs(first) <= LargestLength && std::abs(last) <= LargestLength) ||
      !(this->Spacing[a] >= 1.0 / LargestLength))
    {
      return "origin and spacing must be finite and the spacing positive on every axis, "
             "coordinates at most 1e100 and the spacing at least 1e-100";
    }
  }
  const std::size_t count = GridSize(this->Net.Nodes);
  if (this->Net.Values.size() != count)
  {
    return "there are " + std::to_string(this->Net.Values.size()) + " displacements for " +
      std::to_string(count) + " control points";
  }
  if (!std::isfinite(this->Scale))
  {
    return "the displacement scale is not finite";
  }
  const double factor = std::max(1.0, std::abs(this->Scale));
  for (std::size_t i = 0; i < count; ++i)
  {
    if (!IsWithinRange(factor * this->Net.Values[i]))
    {
      return "the displacement of control point " + std::to_string(i) +
        " is not finite or, with the displacement scale, exceeds 1e100";
    }
  }
  const int border = static_cast<int>(this->Border);
  if (border < static_cast<int>(BorderMode::Edge) ||
    border > static_cast<int>(BorderMode::ZeroAtBorder))
  {
    return "the border mode is " + std::to_string(border) + ", not 0, 1 or 2";
  }
  return std::string();
}

//------------------------------------------------------------------------------
bool Lattice::HasPoint(const glm::ivec3& at) const
{
  return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
    glm::all(glm::lessThan(at, this->Net.Nodes));
}

//------------------------------------------------------------------------------
std::size_t Lattice::IndexOf(const glm::ivec3& at) const { return GridIndex(at, this->Net.Nodes); }

//------------------------------------------------------------------------------
glm::ivec3 Lattice::IndicesOf(std::size_t point) const
{
  const int n = static_cast<int>(point);
  const glm::ivec3& nodes = this->Net.Nodes;
  return { n % nodes.x, n / nodes.x % nodes.y, n / nodes.x / nodes.y };
}

//------------------------------------------------------------------------------
glm::dvec3 Lattice::GetRestPoint(const glm::ivec3& at) const
{
  return this->Origin + glm::dvec3(at) * this->Spacing;
}

//------------------------------------------------------------------------------
glm::dvec3 Lattice::GetControlPoint(std::size_t point) const
{
  return this->GetRestPoint(this->IndicesOf(point)) + this->Net.Values[point];
}

//------------------------------------------------------------------------------
std::vector<glm::dvec3> Lattice::GetControlPoints() const
{
  std::vector<glm::dvec3> points = this->Net.Values;
  std::size_t point = 0;
  for (int k = 0; k < this->Net.Nodes.z; ++k)
  {
    for (int j = 0; j < this->Net.Nodes.y; ++j)
    {
      for (int i = 0; i < this->Net.Nodes.x; ++i, ++point)
      {
        points[point] = this->GetRestPoint({ i, j, k }) + points[point];
      }
    }
  }
  return points;
}

//------------------------------------------------------------------------------
bool Lattice::IsIdentity() const
{
  return this->Scale == 0.0 ||
    std::all_of(this->Net.Values.begin(), this->Net.Values.end(),
      [](const glm::dvec3& d) { return d == glm::dvec3(0.0); });
}

//------------------------------------------------------------------------------
Box Lattice::GetDomain() const
{
  return { this->Origin + this->Spacing,
    this->Origin + glm::dvec3(this->Net.Nodes - 2) * this->Spacing };
}

//------------------------------------------------------------------------------
int Lattice::SetDomain(const Box& domain)
{
  const glm::dvec3 spacing = (domain.Max - domain.Min) / glm::dvec3(this->Net.Nodes - 3);
  const glm::dvec3 origin = domain.Min - spacing;
  for (int a = 0; a < 3; ++a)
  {
    if (!(std::abs(origin[a]) <= LargestLength) ||
      !(std::abs(domain.Max[a] + spacing[a]) <= LargestLength) ||
      !(spacing[a] >= 1.0 / LargestLength) || !(domain.Min[a] + spacing[a] > domain.Min[a]))
    {
      return a;
    }
  }
  this->Spacing = spacing;
  this->Origin = origin;
  return -1;
}

//------------------------------------------------------------------------------
Lattice Lattice::Resize(const glm::ivec3& nodes) const
{
  const glm::ivec3& old = this->Net.Nodes;
  if (nodes == old)
  {
    return *this;
  }
  Lattice result = *this;
  for (int a = 0; a < 3; ++a)
  {
    result.Spacing[a] = this->Spacing[a] * (old[a] - 3) / (nodes[a] - 3);
    result.Origin[a] = this->Origin[a] + this->Spacing[a] - result.Spacing[a];
  }
  if (this->IsIdentity())
  {
    result.Net.Nodes = nodes;
    result.Net.Values.assign(GridSize(nodes), glm::dvec3(0.0));
  }
  else
  {
    result.Net = ResizeControlNet(this->Net, nodes);
  }
  return result;
}

//------------------------------------------------------------------------------
Lattice Lattice::Refine(const glm::ivec3& factors) const
{
  Lattice result = *this;
  result.Net = RefineControlNet(this->Net, factors);
  result.Spacing = this->Spacing / glm::dvec3(factors);
  result.Origin = this->Origin + (this->Spacing - result.Spacing);
  return result;
}

//------------------------------------------------------------------------------
Lattice Lattice::Extend(int layers) const
{
  const glm::ivec3& old = this->Net.Nodes;
  Lattice result = *this;
  result.Origin = this->Origin - static_cast<double>(layers) * this->Spacing;
  result.Net.Nodes = old + 2 * layers;
  result.Net.Values.clear();
  result.Net.Values.reserve(GridSize(result.Net.Nodes));
  for (int k = -layers; k < old.z + layers; ++k)
  {
    for (int j = -layers; j < old.y + layers; ++j)
    {
      for (int i = -layers; i < old.x + layers; ++i)
      {
        const glm::ivec3 nearest = glm::clamp(glm::ivec3(i, j, k), glm::ivec3(0), old - 1);
        const bool keeps = nearest == glm::ivec3(i, j, k) || this->Border == BorderMode::Edge;
        result.Net.Values.push_back(
          keeps ? this->Net.Values[this->IndexOf(nearest)] : glm::dvec3(0.0));
      }
    }
  }
  return result;
}

//------------------------------------------------------------------------------
void Lattice::Take(const FittedNet& fit)
{
  this->Origin = fit.GetOrigin();
  this->Spacing = fit.GetSpacing();
  this->Net = fit.Net;
  this->Border = BorderMode::Edge;
  this->Scale = 1.0;
  this->Inverse = false;
}

//------------------------------------------------------------------------------
BSplineField Lattice::MakeField() const
{
  return BSplineField(this->Net.Nodes, this->Origin, this->Spacing, this->Net.Values.data(),
    this->Scale, this->Border);
}

//------------------------------------------------------------------------------
bool WidenFlatAxes(Box& box)
{
  const glm::dvec3 extent = box.Max - box.Min;
  double thinnest = std::numeric_limits<double>::max();
  for (int a = 0; a < 3; ++a)
  {
    thinnest = extent[a] > 0.0 ? std::min(thinnest, extent[a]) : thinnest;
  }
  if (thinnest == std::numeric_limits<double>::max())
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    if (box.Max[a] == box.Min[a])
    {
      box.Min[a] -= 0.5 * thinnest;
      box.Max[a] += 0.5 * thinnest;
    }
  }
  return true;
}

} // namespace ffd
