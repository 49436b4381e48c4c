// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBoxImages.h"

#include "Bounds/FFDMatrixBounds.h"
#include "FFDBSplineBasis.h"
#include "FFDFieldCache.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace ffd
{
namespace
{

constexpr int MostAlongAxis = 64;

} // namespace

//------------------------------------------------------------------------------
BoxGrid::BoxGrid(const Box& bounds, double number, double smallestEdge)
  : First(bounds.Min)
{
  const glm::dvec3 extent = glm::max(bounds.Max - bounds.Min, glm::dvec3(1e-30));
  const double volume = extent.x * extent.y * extent.z;
  const double edge = std::max(smallestEdge, std::cbrt(volume / number));
  for (int a = 0; a < 3; ++a)
  {
    const double count = std::ceil(extent[a] / edge - 1e-9);
    this->Count[a] = static_cast<int>(std::clamp(count, 1.0, double{ MostAlongAxis }));
  }
  this->Edge = extent / glm::dvec3(this->Count);
}

//------------------------------------------------------------------------------
Grid<glm::dvec3> CopyCoefficients(
  const BSplineField& field, const glm::ivec3& first, const glm::ivec3& end)
{
  Grid<glm::dvec3> nodes(end - first + 3);
  for (int k = 0; k < nodes.Size.z; ++k)
  {
    for (int j = 0; j < nodes.Size.y; ++j)
    {
      for (int i = 0; i < nodes.Size.x; ++i)
      {
        nodes.At(i, j, k) = field.Coefficient(first.x - 1 + i, first.y - 1 + j, first.z - 1 + k);
      }
    }
  }
  return nodes;
}

//------------------------------------------------------------------------------
BoxImages::BoxImages(const BoxGrid& boxes, const BSplineField* field, double sign)
  : Boxes(boxes)
  , Sign(sign)
  , Corners(boxes.Count + 1)
{
  for (int a = 0; a < 3; ++a)
  {
    this->IsInCells[a].assign(static_cast<std::size_t>(boxes.Count[a]), true);
  }
  if (field)
  {
    this->FindDisplacements(*field);
  }
}

//------------------------------------------------------------------------------
Box BoxImages::Find(const glm::ivec3& index) const
{
  // Outside of the cells, where D is constant along an axis, its second differences do not tell how
  // it bends at their end: there it is any of those of the corners anywhere in the box.
  bool inCells = true;
  for (int a = 0; a < 3; ++a)
  {
    inCells = inCells && this->IsInCells[a][static_cast<std::size_t>(index[a])];
  }
  const Box box = this->Boxes.Get(index);
  Box image{ glm::dvec3(std::numeric_limits<double>::max()),
    glm::dvec3(std::numeric_limits<double>::lowest()) };
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::ivec3 upper(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::ivec3 at = index + upper;
    const glm::dvec3& d = this->Corners.At(at.x, at.y, at.z);
    const glm::dvec3 p = glm::mix(box.Min, box.Max, glm::dvec3(upper));
    image.Min = glm::min(image.Min, d + (inCells ? p : box.Min));
    image.Max = glm::max(image.Max, d + (inCells ? p : box.Max));
  }
  return { image.Min - this->Bulge, image.Max + this->Bulge };
}

//------------------------------------------------------------------------------
glm::dmat3 BoxImages::FindMeanJacobian(const glm::ivec3& first, const glm::ivec3& end) const
{
  glm::dmat3 sum(0.0);
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::bvec3 upper((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0);
    const glm::dvec3& d = this->Corners.At(
      upper.x ? end.x : first.x, upper.y ? end.y : first.y, upper.z ? end.z : first.z);
    for (int a = 0; a < 3; ++a)
    {
      sum[a] += upper[a] ? d : -d;
    }
  }
  glm::dmat3 jacobian(1.0);
  for (int a = 0; a < 3; ++a)
  {
    jacobian[a] += sum[a] / (4.0 * this->Boxes.Edge[a] * (end[a] - first[a]));
  }
  return jacobian;
}

//------------------------------------------------------------------------------
void BoxImages::FindDisplacements(const BSplineField& field)
{
  std::vector<std::array<double, 4>> weights[3];
  std::vector<int> cells[3];
  glm::ivec3 first(0);
  glm::ivec3 end(0);
  for (int a = 0; a < 3; ++a)
  {
    const double firstCell = field.GetFirstCell()[a];
    const double endCell = field.GetEndCell()[a];
    for (int i = 0; i <= this->Boxes.Count[a]; ++i)
    {
      const double u = (this->Boxes.At(a, i) - field.GetOrigin()[a]) / field.GetSpacing()[a];
      if (!(u >= firstCell - 1e-9 && u <= endCell + 1e-9))
      {
        for (int side = std::max(i - 1, 0); side < std::min(i + 1, this->Boxes.Count[a]); ++side)
        {
          this->IsInCells[a][static_cast<std::size_t>(side)] = false;
        }
      }
      const double inside = std::clamp(u, firstCell, endCell);
      const int cell = std::clamp(
        static_cast<int>(std::floor(inside)), field.GetFirstCell()[a], field.GetEndCell()[a] - 1);
      std::array<double, 4> w;
      BSplineWeights(inside - cell, w.data());
      weights[a].push_back(w);
      cells[a].push_back(cell);
    }
    first[a] = *std::min_element(cells[a].begin(), cells[a].end());
    end[a] = *std::max_element(cells[a].begin(), cells[a].end()) + 1;
    for (int& cell : cells[a])
    {
      cell -= first[a];
    }
  }
  Grid<glm::dvec3> nodes = CopyCoefficients(field, first, end);
  for (glm::dvec3& node : nodes.Values)
  {
    node *= this->Sign;
  }
  this->Bulge = FindBulge(nodes, this->Boxes.Edge / glm::abs(field.GetSpacing()));
  this->Corners = std::move(nodes);
  for (int a = 0; a < 3; ++a)
  {
    this->Corners = SumAlong(this->Corners, a, weights[a], cells[a]);
  }
}

//------------------------------------------------------------------------------
std::shared_ptr<const BoxImages> FindBoxImages(
  const CastScene& scene, const BoxGrid& boxes, double sign)
{
  const BSplineField* const field = scene.Map->IsIdentity() ? nullptr : scene.Map->GetField();
  return scene.KeptOfField && field ? scene.KeptOfField->FindBoxImages(boxes, *field, sign)
                                    : std::make_shared<const BoxImages>(boxes, field, sign);
}

//------------------------------------------------------------------------------
Box FindBoundsAtRest(const VolumeView& volume)
{
  const glm::dvec3 low = volume.LowerIndex();
  const glm::dvec3 high = volume.UpperIndex();
  const glm::dvec3 middle = volume.FirstVoxel + volume.IndexToData * (0.5 * (low + high));
  const glm::dvec3 half = Absolute(volume.IndexToData) * (0.5 * (high - low));
  return { middle - half, middle + half };
}

//------------------------------------------------------------------------------
bool ShowsNothing(const CastScene& scene, const Box& box, double around)
{
  const VolumeView& volume = scene.Volume;
  const glm::dvec3 middle = volume.ToIndex(0.5 * (box.Min + box.Max));
  const glm::dvec3 half = Absolute(volume.DataToIndex) * (0.5 * (box.Max - box.Min)) + around;
  return scene.Distances->IsEmptyIn(
    middle - half, middle + half, volume.UpperIndex(), volume.Margin);
}

} // namespace ffd
