// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFoldGuard.h"

#include "Bounds/FFDJacobianDeterminant.h"
#include "FFDBSplineField.h"
#include "FFDGridIndex.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

namespace ffd
{
namespace
{

constexpr int Bisections = 8;
constexpr double BoundTolerance = 1e-2;

/// The part of two nets that the cells which differ depend on.
struct Part
{
  ControlNet Before;
  ControlNet After;

  double Bound(const glm::dvec3& spacing, double fraction) const
  {
    std::vector<glm::dvec3> mixed(this->Before.Values.size());
    for (std::size_t n = 0; n < mixed.size(); ++n)
    {
      mixed[n] = glm::mix(this->Before.Values[n], this->After.Values[n], fraction);
    }
    const BSplineField field(this->Before.Nodes, glm::dvec3(0.0), spacing, mixed.data());
    return BoundJacobianDeterminant(field, glm::ivec3(1), this->Before.Nodes - 2, BoundTolerance)
      .Min;
  }
};

/// Empty: nothing differs, or nothing that the domain depends on.
Part FindPart(const ControlNet& before, const ControlNet& after)
{
  const glm::ivec3 n = before.Nodes;
  glm::ivec3 low = n;
  glm::ivec3 high(-1);
  for (int k = 0; k < n.z; ++k)
  {
    for (int j = 0; j < n.y; ++j)
    {
      for (int i = 0; i < n.x; ++i)
      {
        const std::size_t at = GridIndex(i, j, k, n);
        if (before.Values[at] != after.Values[at])
        {
          low = glm::min(low, glm::ivec3(i, j, k));
          high = glm::max(high, glm::ivec3(i, j, k));
        }
      }
    }
  }
  Part part;
  // Control point i counts in the cells i - 2 ... i + 1; the domain's are 1 ... n - 3.
  const glm::ivec3 first = glm::max(low - 2, glm::ivec3(1));
  const glm::ivec3 last = glm::min(high + 1, n - 3);
  if (glm::any(glm::lessThan(last, first)))
  {
    return part;
  }
  const glm::ivec3 size = last - first + 4;
  part.Before.Nodes = size;
  part.After.Nodes = size;
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      for (int i = 0; i < size.x; ++i)
      {
        const std::size_t at = GridIndex(first - 1 + glm::ivec3(i, j, k), n);
        part.Before.Values.push_back(before.Values[at]);
        part.After.Values.push_back(after.Values[at]);
      }
    }
  }
  return part;
}

} // namespace

//------------------------------------------------------------------------------
FoldLimit LimitFold(
  const ControlNet& before, const ControlNet& after, const glm::dvec3& spacing, double minimum)
{
  const Part part = FindPart(before, after);
  if (part.Before.Values.empty())
  {
    return FoldLimit();
  }
  double bound = part.Bound(spacing, 1.0);
  if (bound >= minimum)
  {
    return { 1.0, bound };
  }
  const double start = part.Bound(spacing, 0.0);
  const double limit = start < minimum ? start : minimum;
  if (bound >= limit)
  {
    return { 1.0, bound };
  }
  FoldLimit result{ 0.0, start };
  double high = 1.0;
  for (int step = 0; step < Bisections; ++step)
  {
    const double middle = 0.5 * (result.Fraction + high);
    bound = part.Bound(spacing, middle);
    if (bound >= limit)
    {
      result = { middle, bound };
    }
    else
    {
      high = middle;
    }
  }
  return result;
}

} // namespace ffd
