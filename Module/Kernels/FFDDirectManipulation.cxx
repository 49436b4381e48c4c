// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDirectManipulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ffd
{
namespace
{

/// Part of a row that must be left when what the earlier rows span is taken away.
constexpr double Independence = 1e-4;

using Row = std::vector<double>;

double Dot(const Row& a, const Row& b)
{
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

} // namespace

//------------------------------------------------------------------------------
DirectManipulation MoveMaterial(const BSplineField& field, const std::vector<unsigned char>& locked,
  const std::vector<MaterialMove>& constraints)
{
  struct Weights
  {
    std::size_t Nodes[BSplineField::MaximumSupport];
    double Values[BSplineField::MaximumSupport];
    int Count;
  };
  DirectManipulation result;
  std::vector<Weights> weights(constraints.size());
  for (std::size_t w = 0; w < constraints.size(); ++w)
  {
    Weights& at = weights[w];
    at.Count = field.ControlWeights(constraints[w].RestPoint, at.Nodes, at.Values);
    int kept = 0;
    for (int n = 0; n < at.Count; ++n)
    {
      if (locked.empty() || !locked[at.Nodes[n]])
      {
        at.Nodes[kept] = at.Nodes[n];
        at.Values[kept] = at.Values[n];
        ++kept;
      }
    }
    at.Count = kept;
    result.Nodes.insert(result.Nodes.end(), at.Nodes, at.Nodes + at.Count);
  }
  std::sort(result.Nodes.begin(), result.Nodes.end());
  result.Nodes.erase(std::unique(result.Nodes.begin(), result.Nodes.end()), result.Nodes.end());

  const std::size_t columns = result.Nodes.size();
  std::vector<Row> rows(constraints.size(), Row(columns, 0.0));
  std::vector<Row> basis; // orthonormal
  std::vector<glm::dvec3> amounts;
  for (std::size_t w = 0; w < constraints.size(); ++w)
  {
    Row& row = rows[w];
    for (int n = 0; n < weights[w].Count; ++n)
    {
      const auto at =
        std::lower_bound(result.Nodes.begin(), result.Nodes.end(), weights[w].Nodes[n]);
      row[static_cast<std::size_t>(at - result.Nodes.begin())] = weights[w].Values[n];
    }
    Row rest = row;
    glm::dvec3 missing = constraints[w].Move;
    // Modified Gram-Schmidt, twice: the second time removes what rounding has left of the first.
    for (int pass = 0; pass < 2; ++pass)
    {
      for (std::size_t b = 0; b < basis.size(); ++b)
      {
        const double part = Dot(basis[b], rest);
        for (std::size_t c = 0; c < columns; ++c)
        {
          rest[c] -= part * basis[b][c];
        }
        missing -= part * amounts[b];
      }
    }
    const double length = std::sqrt(Dot(rest, rest));
    const double whole = std::sqrt(Dot(row, row));
    if (!(length > Independence * whole) || !(whole > 0.0))
    {
      continue;
    }
    for (double& value : rest)
    {
      value /= length;
    }
    basis.push_back(std::move(rest));
    amounts.push_back(missing / length);
  }

  result.Changes.assign(columns, glm::dvec3(0.0));
  for (std::size_t b = 0; b < basis.size(); ++b)
  {
    for (std::size_t c = 0; c < columns; ++c)
    {
      result.Changes[c] += basis[b][c] * amounts[b];
    }
  }
  for (const Row& row : rows)
  {
    glm::dvec3 achieved(0.0);
    for (std::size_t c = 0; c < columns; ++c)
    {
      achieved += row[c] * result.Changes[c];
    }
    result.Achieved.push_back(achieved);
  }
  return result;
}

} // namespace ffd
