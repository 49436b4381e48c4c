// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBoxOrientation.h"

#include "FFDBSplineBasis.h"
#include "FFDBSplineField.h"
#include "FFDSplineGrid.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// The sum of products of an entry of each vector, of different axes: a determinant with all signs
/// alike.
double FindPermanent(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
  return a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) +
    a.z * (b.x * c.y + b.y * c.x);
}

} // namespace

//------------------------------------------------------------------------------
ThirdDerivatives BoundThirdDerivatives(const BSplineField& field)
{
  ThirdDerivatives third;
  const Grid<glm::dvec3> nodes = CopyCoefficients(field, field.GetFirstCell(), field.GetEndCell());
  const glm::dvec3 perCell = 1.0 / glm::abs(field.GetSpacing());
  for (int a = 0; a < 3; ++a)
  {
    const Grid<glm::dvec3> byOne = FindDifferences(nodes, a);
    for (int b = a; b < 3; ++b)
    {
      const Grid<glm::dvec3> byTwo = FindDifferences(byOne, b);
      for (int c = b; c < 3; ++c)
      {
        const glm::dvec3 largest =
          FindLargest(FindDifferences(byTwo, c)) * (perCell[a] * perCell[b] * perCell[c]);
        int axes[3] = { a, b, c };
        do
        {
          third.Largest[axes[0]][axes[1]][axes[2]] = largest;
        } while (std::next_permutation(axes, axes + 3));
      }
    }
  }
  return third;
}

/// Derivatives of T at a point, a column for each axis, and the derivatives of these by each axis.
struct BoxOrientation::Expansion
{
  glm::dmat3 Jacobian{ 1.0 };
  glm::dmat3 Change[3]{ glm::dmat3(0.0), glm::dmat3(0.0), glm::dmat3(0.0) };
};

//------------------------------------------------------------------------------
BoxOrientation::BoxOrientation(const BoxImages& images, const BSplineField& field,
  const ThirdDerivatives& third, double orientation)
  : Images(images)
  , Field(field)
  , Third(third)
  , Orientation(orientation)
{
}

//------------------------------------------------------------------------------
/// Whether D has second derivatives that change as the third ones say, everywhere in a box: outside
/// of the cells it is constant along an axis.
bool BoxOrientation::HasDerivatives(const Box& box) const
{
  const glm::dvec3 low = (box.Min - this->Field.GetOrigin()) / this->Field.GetSpacing();
  const glm::dvec3 high = (box.Max - this->Field.GetOrigin()) / this->Field.GetSpacing();
  bool has = true;
  for (int a = 0; a < 3; ++a)
  {
    const int first = this->Field.GetFirstCell()[a];
    const int end = this->Field.GetEndCell()[a];
    has = has && first < end && std::min(low[a], high[a]) >= first - 1e-9 &&
      std::max(low[a], high[a]) <= end + 1e-9;
  }
  return has;
}

//------------------------------------------------------------------------------
BoxOrientation::Expansion BoxOrientation::Expand(const glm::dvec3& middle) const
{
  // Weights of the 4 control points along each axis, of their derivatives and second derivatives.
  double weights[3][3][4];
  glm::ivec3 cell;
  for (int a = 0; a < 3; ++a)
  {
    const double u = (middle[a] - this->Field.GetOrigin()[a]) / this->Field.GetSpacing()[a];
    cell[a] = std::clamp(static_cast<int>(std::floor(u)), this->Field.GetFirstCell()[a],
      this->Field.GetEndCell()[a] - 1);
    BSplineWeights(u - cell[a], weights[a][0]);
    BSplineDerivativeWeights(u - cell[a], weights[a][1]);
    BSplineSecondDerivativeWeights(u - cell[a], weights[a][2]);
    for (int n = 0; n < 4; ++n)
    {
      weights[a][1][n] /= this->Field.GetSpacing()[a];
      weights[a][2][n] /= this->Field.GetSpacing()[a] * this->Field.GetSpacing()[a];
    }
  }
  Expansion expansion;
  for (int n = 0; n < 64; ++n)
  {
    const glm::ivec3 at(n & 3, n >> 2 & 3, n >> 4);
    const glm::ivec3 node = cell - 1 + at;
    const glm::dvec3& d = this->Field.Coefficient(node.x, node.y, node.z);
    const auto weigh = [&](const glm::ivec3& order) {
      return weights[0][order.x][at.x] * weights[1][order.y][at.y] * weights[2][order.z][at.z];
    };
    for (int a = 0; a < 3; ++a)
    {
      glm::ivec3 order(0);
      ++order[a];
      expansion.Jacobian[a] += weigh(order) * d;
      for (int b = 0; b <= a; ++b)
      {
        glm::ivec3 both = order;
        ++both[b];
        expansion.Change[b][a] += weigh(both) * d;
      }
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a + 1; b < 3; ++b)
    {
      expansion.Change[b][a] = expansion.Change[a][b];
    }
  }
  return expansion;
}

//------------------------------------------------------------------------------
bool BoxOrientation::AreTurnedOver(const glm::ivec3& first, const glm::ivec3& end) const
{
  // Most boxes are not, which this tells in much less time.
  if (this->Orientation * glm::determinant(this->Images.FindMeanJacobian(first, end)) > 0.0)
  {
    return false;
  }
  const Box box{ this->Images.GetBoxes().Get(first).Min, this->Images.GetBoxes().Get(end - 1).Max };
  if (!this->HasDerivatives(box))
  {
    return false;
  }
  const glm::dvec3 half = 0.5 * (box.Max - box.Min);
  const Expansion at = this->Expand(0.5 * (box.Min + box.Max));
  const glm::dmat3& j = at.Jacobian;
  // The Jacobian at the distance (x, y, z) from the middle is j + x Change[0] + y Change[1]
  // + z Change[2], to within `rest`, an entry each, and its largest change is `spread`.
  glm::dmat3 rest(0.0);
  glm::dmat3 spread(0.0);
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      for (int c = 0; c < 3; ++c)
      {
        rest[a] += this->Third.Largest[a][b][c] * (0.5 * half[b] * half[c]);
      }
      spread[a] += glm::abs(at.Change[b][a]) * half[b];
    }
  }
  spread += rest;
  // The determinant is linear in each column: products of one, two and three columns that change.
  double change = FindPermanent(spread[0], spread[1], spread[2]);
  glm::dvec3 slope(0.0);
  for (int a = 0; a < 3; ++a)
  {
    const int next = (a + 1) % 3;
    const int last = (a + 2) % 3;
    const glm::dvec3 cofactors = glm::cross(j[next], j[last]);
    for (int b = 0; b < 3; ++b)
    {
      slope[b] += glm::dot(cofactors, at.Change[b][a]);
    }
    change += glm::dot(glm::abs(cofactors), rest[a]) +
      FindPermanent(glm::abs(j[a]), spread[next], spread[last]);
  }
  change += glm::dot(glm::abs(slope), half) + 1e-9;
  return this->Orientation * glm::determinant(j) < -change;
}

} // namespace ffd
