// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTransformStep.h"

#include "FFDGridIndex.h"
#include "FFDSingularMatrix.h"
#include "FFDTextNumbers.h"

#include <glm/matrix.hpp>

#include <cmath>

namespace ffd
{
namespace
{

constexpr int LargestGrid = 1024;
constexpr double DirectionTolerance = 1e-3;

} // namespace

//------------------------------------------------------------------------------
bool IsSingular(const TransformStep& step)
{
  return step.Type == TransformStep::Kind::Linear && IsSingular(step.Matrix);
}

//------------------------------------------------------------------------------
void SetCentered(TransformStep& step, const glm::dmat3& matrix, const glm::dvec3& center,
  const glm::dvec3& translation)
{
  step.Type = TransformStep::Kind::Linear;
  step.Matrix = matrix;
  step.Offset = center + translation - matrix * center;
}

//------------------------------------------------------------------------------
std::string FindGridProblem(const TransformGrid& grid, int smallest)
{
  for (int a = 0; a < 3; ++a)
  {
    if (grid.Size[a] < smallest || grid.Size[a] > LargestGrid)
    {
      return "the grid has " + std::to_string(grid.Size[a]) + " nodes along axis " +
        std::to_string(a) + ", not from " + std::to_string(smallest) + " to 1024";
    }
    if (!(grid.Spacing[a] >= 1.0 / LargestNumber && grid.Spacing[a] <= LargestNumber))
    {
      std::string text = "the spacing of the grid along axis " + std::to_string(a) + " is ";
      AppendNumber(text, grid.Spacing[a]);
      return text + ", not from 1e-12 to 1e12";
    }
    if (!(std::abs(grid.Origin[a]) <= LargestNumber))
    {
      return "the origin of the grid is not a finite number of at most 1e12";
    }
    for (int b = 0; b < 3; ++b)
    {
      const glm::dvec3& u = grid.Direction[a];
      const glm::dvec3& v = grid.Direction[b];
      const double product = u.x * v.x + u.y * v.y + u.z * v.z;
      if (!(std::abs(product - (a == b ? 1.0 : 0.0)) <= DirectionTolerance))
      {
        return "the directions of the grid are not orthonormal";
      }
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
void FlipTransformStep(TransformStep& step)
{
  const glm::dvec3 flip(-1.0, -1.0, 1.0);
  for (TransformTerm& term : step.Terms)
  {
    for (TransformStep& inner : term.Steps)
    {
      FlipTransformStep(inner);
    }
  }
  if (step.Type == TransformStep::Kind::Linear)
  {
    for (int column = 0; column < 3; ++column)
    {
      step.Matrix[column] *= flip * flip[column];
    }
    step.Offset *= flip;
    return;
  }
  step.Grid.Origin *= flip;
  for (int column = 0; column < 3; ++column)
  {
    step.Grid.Direction[column] *= flip;
  }
  for (glm::dvec3& value : step.Values)
  {
    value *= flip;
  }
}

//------------------------------------------------------------------------------
bool AlignTransformStep(TransformStep& step)
{
  if (step.Type == TransformStep::Kind::Linear || step.Type == TransformStep::Kind::Sum)
  {
    return false;
  }
  // Axis a of the grid runs along axis target[a] of space.
  constexpr double tolerance = 1e-12;
  const TransformGrid& old = step.Grid;
  glm::ivec3 target(-1);
  glm::ivec3 used(0);
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      const double entry = std::abs(old.Direction[a][b]);
      if (std::abs(entry - 1.0) <= tolerance)
      {
        target[a] = b;
        ++used[b];
      }
      else if (entry > tolerance)
      {
        return false;
      }
    }
    if (target[a] < 0)
    {
      return false;
    }
  }
  if (used != glm::ivec3(1))
  {
    return false;
  }
  TransformGrid grid;
  grid.Origin = old.Origin;
  glm::ivec3 reversed(0);
  for (int a = 0; a < 3; ++a)
  {
    const int b = target[a];
    grid.Size[b] = old.Size[a];
    grid.Spacing[b] = old.Spacing[a];
    if (old.Direction[a][b] < 0.0)
    {
      reversed[a] = 1;
      grid.Origin[b] -= (old.Size[a] - 1) * old.Spacing[a];
    }
  }
  std::vector<glm::dvec3> values(step.Values.size());
  std::size_t from = 0;
  glm::ivec3 i;
  for (i.z = 0; i.z < old.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < old.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < old.Size.x; ++i.x)
      {
        glm::ivec3 to;
        for (int a = 0; a < 3; ++a)
        {
          to[target[a]] = reversed[a] ? old.Size[a] - 1 - i[a] : i[a];
        }
        values[GridIndex(to, grid.Size)] = step.Values[from++];
      }
    }
  }
  step.Grid = grid;
  step.Values = std::move(values);
  return true;
}

//------------------------------------------------------------------------------
bool AddTransformStep(TransformStep& a, const TransformStep& b)
{
  using Kind = TransformStep::Kind;
  if (a.Type == Kind::Linear && b.Type == Kind::Linear)
  {
    a.Matrix += b.Matrix - glm::dmat3(1.0);
    a.Offset += b.Offset;
    return true;
  }
  if (a.Type == Kind::Spline && b.Type == Kind::Spline && a.Order == b.Order &&
    a.Grid.Size == b.Grid.Size && a.Grid.Origin == b.Grid.Origin &&
    a.Grid.Spacing == b.Grid.Spacing && a.Grid.Direction == b.Grid.Direction)
  {
    for (std::size_t i = 0; i < a.Values.size(); ++i)
    {
      a.Values[i] += b.Values[i];
    }
    a.IsSum = a.IsSum || b.IsSum;
    return true;
  }
  if (!((a.Type == Kind::Spline && b.Type == Kind::Linear) ||
        (a.Type == Kind::Linear && b.Type == Kind::Spline)))
  {
    return false;
  }
  TransformStep spline = a.Type == Kind::Spline ? a : b;
  const TransformStep& linear = a.Type == Kind::Spline ? b : a;
  // B-splines have linear precision: a linear displacement of the control points is one of space.
  const glm::dmat3 matrix = linear.Matrix - glm::dmat3(1.0);
  std::size_t id = 0;
  glm::ivec3 i;
  for (i.z = 0; i.z < spline.Grid.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < spline.Grid.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < spline.Grid.Size.x; ++i.x)
      {
        const glm::dvec3 node =
          spline.Grid.Origin + spline.Grid.Direction * (glm::dvec3(i) * spline.Grid.Spacing);
        spline.Values[id++] += matrix * node + linear.Offset;
      }
    }
  }
  spline.IsSum = true;
  a = std::move(spline);
  return true;
}

} // namespace ffd
