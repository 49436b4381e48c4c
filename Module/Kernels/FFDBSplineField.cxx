// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBSplineField.h"

#include "FFDBSplineBasis.h"
#include "FFDGridIndex.h"

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Coefficient that a border mode gives control point i: sign * c[index].
struct BorderSource
{
  int Index;
  double Sign;
};

BorderSource FindBorderSource(int i, int nodes, BorderMode border)
{
  const int last = nodes - 1;
  if (i >= 0 && i <= last)
  {
    return { i, 1.0 };
  }
  if (border == BorderMode::Edge || nodes == 1)
  {
    return { std::clamp(i, 0, last), 1.0 };
  }
  // Odd reflection about the first control point past the border gives zero there.
  if (border == BorderMode::ZeroAtBorder && (i == -2 || i == last + 2))
  {
    return { i < 0 ? 0 : last, -1.0 };
  }
  return { 0, 0.0 };
}

} // namespace

//------------------------------------------------------------------------------
BSplineField::BSplineField()
  : BSplineField(glm::ivec3(1), glm::dvec3(0.0), glm::dvec3(1.0), nullptr)
{
}

//------------------------------------------------------------------------------
BSplineField::BSplineField(const glm::ivec3& nodes, const glm::dvec3& origin,
  const glm::dvec3& spacing, const glm::dvec3* displacements, double scale, BorderMode border)
  : Nodes(nodes)
  , PaddedNodes(nodes + 2 * Padding)
  , Origin(origin)
  , Spacing(spacing)
  , InverseSpacing(1.0 / spacing)
  , Border(border)
  , Zero(true)
{
  for (int a = 0; a < 3; ++a)
  {
    const int reach = (border == BorderMode::ZeroAtBorder && nodes[a] > 1) ? 1 : 2;
    this->FirstCell[a] = -reach;
    this->EndCell[a] = nodes[a] - 1 + reach;
    this->ClampMin[a] = this->FirstCell[a];
    this->ClampMax[a] = this->EndCell[a];
  }
  const auto coefficients =
    std::make_shared<std::vector<glm::dvec3>>(GridSize(this->PaddedNodes), glm::dvec3(0.0));
  this->Coefficients = coefficients;
  if (!displacements)
  {
    return;
  }
  for (int k = -Padding; k < nodes.z + Padding; ++k)
  {
    const BorderSource sk = FindBorderSource(k, nodes.z, border);
    for (int j = -Padding; j < nodes.y + Padding; ++j)
    {
      const BorderSource sj = FindBorderSource(j, nodes.y, border);
      for (int i = -Padding; i < nodes.x + Padding; ++i)
      {
        const BorderSource si = FindBorderSource(i, nodes.x, border);
        const std::size_t from = GridIndex(si.Index, sj.Index, sk.Index, nodes);
        const glm::dvec3 c = displacements[from] * (si.Sign * sj.Sign * sk.Sign * scale);
        (*coefficients)[this->CoefficientIndex(i, j, k)] = c;
        this->Zero = this->Zero && c == glm::dvec3(0.0);
      }
    }
  }
}

//------------------------------------------------------------------------------
glm::dvec3 BSplineField::Displacement(const glm::dvec3& p) const
{
  const glm::dvec3 x = (p - this->Origin) * this->InverseSpacing;
  AxisPosition at[3];
  double w[3][4];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = LocateOnAxis(x[a], this->ClampMin[a], this->ClampMax[a]);
    BSplineWeights(at[a].U, w[a]);
  }
  glm::dvec3 sum(0.0);
  for (int k = 0; k < 4; ++k)
  {
    glm::dvec3 plane(0.0);
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* row =
        &this->Coefficient(at[0].Cell - 1, at[1].Cell - 1 + j, at[2].Cell - 1 + k);
      plane +=
        w[1][j] * (w[0][0] * row[0] + w[0][1] * row[1] + w[0][2] * row[2] + w[0][3] * row[3]);
    }
    sum += w[2][k] * plane;
  }
  return sum;
}

//------------------------------------------------------------------------------
int BSplineField::ControlWeights(
  const glm::dvec3& p, std::size_t nodes[MaximumSupport], double weights[MaximumSupport]) const
{
  const glm::dvec3 x = (p - this->Origin) * this->InverseSpacing;
  // Per axis the control points themselves: those past the border are one of them, or none.
  int index[3][4];
  double weight[3][4];
  int count[3];
  for (int a = 0; a < 3; ++a)
  {
    const AxisPosition at = LocateOnAxis(x[a], this->ClampMin[a], this->ClampMax[a]);
    double w[4];
    BSplineWeights(at.U, w);
    count[a] = 0;
    for (int i = 0; i < 4; ++i)
    {
      const BorderSource source = FindBorderSource(at.Cell - 1 + i, this->Nodes[a], this->Border);
      const double value = source.Sign * w[i];
      int n = 0;
      while (n < count[a] && index[a][n] != source.Index)
      {
        ++n;
      }
      if (n == count[a])
      {
        index[a][n] = source.Index;
        weight[a][n] = 0.0;
        ++count[a];
      }
      weight[a][n] += value;
    }
  }
  int found = 0;
  for (int k = 0; k < count[2]; ++k)
  {
    for (int j = 0; j < count[1]; ++j)
    {
      for (int i = 0; i < count[0]; ++i)
      {
        const double value = weight[0][i] * weight[1][j] * weight[2][k];
        if (value != 0.0)
        {
          nodes[found] = GridIndex(index[0][i], index[1][j], index[2][k], this->Nodes);
          weights[found] = value;
          ++found;
        }
      }
    }
  }
  return found;
}

//------------------------------------------------------------------------------
glm::dvec3 BSplineField::Displacement(const glm::dvec3& p, glm::dmat3& jacobian) const
{
  const glm::dvec3 x = (p - this->Origin) * this->InverseSpacing;
  AxisPosition at[3];
  double w[3][4];
  double d[3][4];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = LocateOnAxis(x[a], this->ClampMin[a], this->ClampMax[a]);
    BSplineWeights(at[a].U, w[a]);
    BSplineDerivativeWeights(at[a].U, d[a]);
    const double toData = at[a].Constant ? 0.0 : this->InverseSpacing[a];
    for (double& weight : d[a])
    {
      weight *= toData;
    }
  }
  glm::dvec3 sum(0.0);
  glm::dvec3 dx(0.0);
  glm::dvec3 dy(0.0);
  glm::dvec3 dz(0.0);
  for (int k = 0; k < 4; ++k)
  {
    glm::dvec3 plane(0.0);
    glm::dvec3 planeDx(0.0);
    glm::dvec3 planeDy(0.0);
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* row =
        &this->Coefficient(at[0].Cell - 1, at[1].Cell - 1 + j, at[2].Cell - 1 + k);
      const glm::dvec3 value =
        w[0][0] * row[0] + w[0][1] * row[1] + w[0][2] * row[2] + w[0][3] * row[3];
      const glm::dvec3 slope =
        d[0][0] * row[0] + d[0][1] * row[1] + d[0][2] * row[2] + d[0][3] * row[3];
      plane += w[1][j] * value;
      planeDx += w[1][j] * slope;
      planeDy += d[1][j] * value;
    }
    sum += w[2][k] * plane;
    dx += w[2][k] * planeDx;
    dy += w[2][k] * planeDy;
    dz += d[2][k] * plane;
  }
  jacobian = glm::dmat3(dx, dy, dz);
  return sum;
}

//------------------------------------------------------------------------------
BSplineField ExtendLinearly(const BSplineField& field, const glm::ivec3& cells)
{
  glm::ivec3 size = field.GetNodes();
  std::vector<glm::dvec3> values;
  values.reserve(GridSize(size));
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      const glm::dvec3* const row = &field.Coefficient(0, j, k);
      values.insert(values.end(), row, row + size.x);
    }
  }
  // Axis by axis; what lies between the entries of a line along one is `inner` entries apart.
  std::size_t inner = 1;
  for (int a = 0; a < 3; ++a)
  {
    const int last = size[a] - 1;
    std::vector<glm::dvec3> extended;
    size[a] += 2 * cells[a];
    extended.reserve(GridSize(size));
    const std::size_t line = inner * static_cast<std::size_t>(last + 1);
    for (std::size_t first = 0; first < values.size(); first += line)
    {
      for (int i = -cells[a]; i <= last + cells[a]; ++i)
      {
        const int node = std::clamp(i, 0, last);
        const double out = std::abs(i - node);
        const int beside = i < 0 ? 1 : i > last ? last - 1 : node;
        const glm::dvec3* const c = &values[first + inner * static_cast<std::size_t>(node)];
        const glm::dvec3* const d = &values[first + inner * static_cast<std::size_t>(beside)];
        for (std::size_t n = 0; n < inner; ++n)
        {
          extended.push_back(c[n] + out * (c[n] - d[n]));
        }
      }
    }
    values.swap(extended);
    inner *= static_cast<std::size_t>(size[a]);
  }
  return BSplineField(size, field.GetOrigin() - glm::dvec3(cells) * field.GetSpacing(),
    field.GetSpacing(), values.data());
}

} // namespace ffd
