// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSplineRows.h"

#include "FFDBSplineBasis.h"

#include <algorithm>

namespace ffd
{
namespace
{

/// The axis that the first column of a matrix is parallel to and the other two are normal to.
int FindRowAxis(const glm::dmat3& matrix)
{
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3;
    const int c = (a + 2) % 3;
    if (matrix[0][b] == 0.0 && matrix[0][c] == 0.0 && matrix[1][a] == 0.0 && matrix[2][a] == 0.0)
    {
      return a;
    }
  }
  return -1;
}

AxisPosition LocateInField(const BSplineField& field, const glm::dvec3& p, int a)
{
  return LocateOnAxis((p[a] - field.GetOrigin()[a]) * (1.0 / field.GetSpacing()[a]),
    field.GetFirstCell()[a], field.GetEndCell()[a]);
}

/// Weights of the derivative by data coordinates.
void FindDerivativeWeights(
  const BSplineField& field, const AxisPosition& at, int a, double weights[4])
{
  BSplineDerivativeWeights(at.U, weights);
  const double toData = at.Constant ? 0.0 : 1.0 / field.GetSpacing()[a];
  for (int n = 0; n < 4; ++n)
  {
    weights[n] *= toData;
  }
}

} // namespace

//------------------------------------------------------------------------------
SplineRows::SplineRows(const BSplineField& field, const ImageGrid& grid, int first, int last)
  : Field(&field)
  , Grid(grid)
  , First(first)
  , Count(last - first + 1)
  , Axis(FindRowAxis(grid.IndexToData))
{
  if (this->Axis < 0)
  {
    return;
  }
  const std::size_t count = static_cast<std::size_t>(this->Count);
  for (int n = 0; n < 4; ++n)
  {
    this->Weights[n].resize(count);
    this->DerivativeWeights[n].resize(count);
  }
  for (int i = 0; i < this->Count; ++i)
  {
    const AxisPosition at = LocateInField(field, this->GetPoint(i, 0, 0), this->Axis);
    double weights[4];
    double derivative[4];
    BSplineWeights(at.U, weights);
    FindDerivativeWeights(field, at, this->Axis, derivative);
    for (int n = 0; n < 4; ++n)
    {
      this->Weights[n][i] = weights[n];
      this->DerivativeWeights[n][i] = derivative[n];
    }
    const std::size_t node = static_cast<std::size_t>(at.Cell - 1 + BSplineField::Padding);
    if (this->Runs.empty() || this->Runs.back().Node != node)
    {
      this->Runs.push_back({ i, i, node });
    }
    this->Runs.back().To = i + 1;
  }
}

//------------------------------------------------------------------------------
glm::dvec3 SplineRows::GetPoint(int i, int j, int k) const
{
  return this->Grid.ToData(glm::dvec3(this->First + i, j, k));
}

//------------------------------------------------------------------------------
void SplineRows::Collapse(const double weightsB[4], const double weightsC[4], int cellB, int cellC,
  std::vector<glm::dvec3>& line) const
{
  const glm::ivec3& nodes = this->Field->GetPaddedNodes();
  const std::size_t strides[3] = { 1, static_cast<std::size_t>(nodes.x),
    static_cast<std::size_t>(nodes.x) * static_cast<std::size_t>(nodes.y) };
  const int b = (this->Axis + 1) % 3;
  const int c = (this->Axis + 2) % 3;
  const std::size_t firstB = static_cast<std::size_t>(cellB - 1 + BSplineField::Padding);
  const std::size_t firstC = static_cast<std::size_t>(cellC - 1 + BSplineField::Padding);
  const glm::dvec3* const all = this->Field->GetCoefficients().data();
  // Rows may run down their axis.
  const std::size_t first = std::min(this->Runs.front().Node, this->Runs.back().Node);
  const std::size_t end = std::max(this->Runs.front().Node, this->Runs.back().Node) + 4;
  line.assign(static_cast<std::size_t>(nodes[this->Axis]), glm::dvec3(0.0));
  for (std::size_t n = 0; n < 4; ++n)
  {
    for (std::size_t m = 0; m < 4; ++m)
    {
      const double weight = weightsB[m] * weightsC[n];
      const glm::dvec3* from = all + (firstB + m) * strides[b] + (firstC + n) * strides[c];
      for (std::size_t i = first; i < end; ++i)
      {
        line[i] += weight * from[i * strides[this->Axis]];
      }
    }
  }
}

//------------------------------------------------------------------------------
void SplineRows::Displacements(
  int j, int k, const glm::dmat3& factor, Scratch& scratch, double* x, double* y, double* z) const
{
  if (!this->IsAligned())
  {
    for (int i = 0; i < this->Count; ++i)
    {
      const glm::dvec3 d = factor * this->Field->Displacement(this->GetPoint(i, j, k));
      x[i] = d.x;
      y[i] = d.y;
      z[i] = d.z;
    }
    return;
  }
  const glm::dvec3 start = this->GetPoint(0, j, k);
  const int b = (this->Axis + 1) % 3;
  const int c = (this->Axis + 2) % 3;
  const AxisPosition atB = LocateInField(*this->Field, start, b);
  const AxisPosition atC = LocateInField(*this->Field, start, c);
  double weightsB[4];
  double weightsC[4];
  BSplineWeights(atB.U, weightsB);
  BSplineWeights(atC.U, weightsC);
  std::vector<glm::dvec3>& line = scratch.Lines[0];
  this->Collapse(weightsB, weightsC, atB.Cell, atC.Cell, line);
  const double* const w0 = this->Weights[0].data();
  const double* const w1 = this->Weights[1].data();
  const double* const w2 = this->Weights[2].data();
  const double* const w3 = this->Weights[3].data();
  for (const Run& run : this->Runs)
  {
    const glm::dvec3 c0 = factor * line[run.Node];
    const glm::dvec3 c1 = factor * line[run.Node + 1];
    const glm::dvec3 c2 = factor * line[run.Node + 2];
    const glm::dvec3 c3 = factor * line[run.Node + 3];
    for (int i = run.From; i < run.To; ++i)
    {
      x[i] = w0[i] * c0.x + w1[i] * c1.x + w2[i] * c2.x + w3[i] * c3.x;
      y[i] = w0[i] * c0.y + w1[i] * c1.y + w2[i] * c2.y + w3[i] * c3.y;
      z[i] = w0[i] * c0.z + w1[i] * c1.z + w2[i] * c2.z + w3[i] * c3.z;
    }
  }
}

//------------------------------------------------------------------------------
void SplineRows::Jacobians(int j, int k, Scratch& scratch, glm::dmat3* jacobians) const
{
  if (!this->IsAligned())
  {
    for (int i = 0; i < this->Count; ++i)
    {
      this->Field->Displacement(this->GetPoint(i, j, k), jacobians[i]);
    }
    return;
  }
  const glm::dvec3 start = this->GetPoint(0, j, k);
  const int a = this->Axis;
  const int b = (a + 1) % 3;
  const int c = (a + 2) % 3;
  const AxisPosition atB = LocateInField(*this->Field, start, b);
  const AxisPosition atC = LocateInField(*this->Field, start, c);
  double weightsB[4];
  double weightsC[4];
  double slopesB[4];
  double slopesC[4];
  BSplineWeights(atB.U, weightsB);
  BSplineWeights(atC.U, weightsC);
  FindDerivativeWeights(*this->Field, atB, b, slopesB);
  FindDerivativeWeights(*this->Field, atC, c, slopesC);
  this->Collapse(weightsB, weightsC, atB.Cell, atC.Cell, scratch.Lines[0]);
  this->Collapse(slopesB, weightsC, atB.Cell, atC.Cell, scratch.Lines[1]);
  this->Collapse(weightsB, slopesC, atB.Cell, atC.Cell, scratch.Lines[2]);
  for (const Run& run : this->Runs)
  {
    const glm::dvec3* const value = &scratch.Lines[0][run.Node];
    const glm::dvec3* const alongB = &scratch.Lines[1][run.Node];
    const glm::dvec3* const alongC = &scratch.Lines[2][run.Node];
    for (int i = run.From; i < run.To; ++i)
    {
      glm::dmat3 jacobian(0.0);
      for (int n = 0; n < 4; ++n)
      {
        jacobian[a] += this->DerivativeWeights[n][i] * value[n];
        jacobian[b] += this->Weights[n][i] * alongB[n];
        jacobian[c] += this->Weights[n][i] * alongC[n];
      }
      jacobians[i] = jacobian;
    }
  }
}

} // namespace ffd
