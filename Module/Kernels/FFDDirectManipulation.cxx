// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDirectManipulation.h"

#include <Eigen/Dense>

#include <algorithm>

namespace ffd
{
namespace
{

/// Part of a row that must be left when what the earlier rows span is taken away.
constexpr double Independence = 1e-4;

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

  const auto columns = static_cast<Eigen::Index>(result.Nodes.size());
  const auto count = static_cast<Eigen::Index>(constraints.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(columns, count); // a column for each constraint
  Eigen::MatrixXd basis(columns, count);                        // orthonormal
  Eigen::Matrix3Xd amounts(3, count);
  Eigen::Index rank = 0;
  for (Eigen::Index w = 0; w < count; ++w)
  {
    const Weights& at = weights[static_cast<std::size_t>(w)];
    for (int n = 0; n < at.Count; ++n)
    {
      const auto node = std::lower_bound(result.Nodes.begin(), result.Nodes.end(), at.Nodes[n]);
      rows(node - result.Nodes.begin(), w) = at.Values[n];
    }
    Eigen::VectorXd rest = rows.col(w);
    const glm::dvec3& move = constraints[static_cast<std::size_t>(w)].Move;
    Eigen::Vector3d missing(move.x, move.y, move.z);
    // Gram-Schmidt, twice: the second time removes what rounding has left of the first.
    for (int pass = 0; pass < 2; ++pass)
    {
      const Eigen::VectorXd parts = basis.leftCols(rank).transpose() * rest;
      rest -= basis.leftCols(rank) * parts;
      missing -= amounts.leftCols(rank) * parts;
    }
    const double length = rest.norm();
    if (length > Independence * rows.col(w).norm())
    {
      basis.col(rank) = rest / length;
      amounts.col(rank) = missing / length;
      ++rank;
    }
  }

  const Eigen::Matrix3Xd changes = amounts.leftCols(rank) * basis.leftCols(rank).transpose();
  const Eigen::Matrix3Xd achieved = changes * rows;
  for (Eigen::Index c = 0; c < columns; ++c)
  {
    result.Changes.emplace_back(changes(0, c), changes(1, c), changes(2, c));
  }
  for (Eigen::Index w = 0; w < count; ++w)
  {
    result.Achieved.emplace_back(achieved(0, w), achieved(1, w), achieved(2, w));
  }
  return result;
}

} // namespace ffd
