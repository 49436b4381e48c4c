// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDirectManipulation.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace ffd;

namespace
{

std::vector<glm::dvec3> CopyNet(const BSplineField& field)
{
  const glm::ivec3 n = field.GetNodes();
  std::vector<glm::dvec3> values;
  for (int i = 0; i < n.x * n.y * n.z; ++i)
  {
    values.push_back(field.Coefficient(i % n.x, i / n.x % n.y, i / (n.x * n.y)));
  }
  return values;
}

BSplineField Changed(const BSplineField& field, const DirectManipulation& change)
{
  std::vector<glm::dvec3> values = CopyNet(field);
  for (std::size_t n = 0; n < change.Nodes.size(); ++n)
  {
    values[change.Nodes[n]] += change.Changes[n];
  }
  return BSplineField(
    field.GetNodes(), field.GetOrigin(), field.GetSpacing(), values.data(), 1.0, field.GetBorder());
}

} // namespace

TEST(DirectManipulation, ControlWeightsReproduceTheField)
{
  RandomLattice random(71);
  for (BorderMode border : AllBorders)
  {
    for (int l = 0; l < 30; ++l)
    {
      const BSplineField field = random.Field(1.0, border, l % 4 + 1);
      const std::vector<glm::dvec3> net = CopyNet(field);
      for (int i = 0; i < 60; ++i)
      {
        const glm::dvec3 p = random.Point(field, 4.0);
        std::size_t nodes[BSplineField::MaximumSupport];
        double weights[BSplineField::MaximumSupport];
        const int count = field.ControlWeights(p, nodes, weights);
        glm::dvec3 sum(0.0);
        for (int n = 0; n < count; ++n)
        {
          ASSERT_LT(nodes[n], net.size());
          for (int m = 0; m < n; ++m)
          {
            ASSERT_NE(nodes[n], nodes[m]);
          }
          sum += weights[n] * net[nodes[n]];
        }
        EXPECT_LT(glm::distance(sum, field.Displacement(p)), 1e-12);
      }
    }
  }
}

TEST(DirectManipulation, OnePointIsTheClosedForm)
{
  // Hsu, Hughes and Kaufman: change_n = B_n / (sum of B^2) * move.
  RandomLattice random(72);
  for (int l = 0; l < 60; ++l)
  {
    const BSplineField field = random.Field(1.0, BorderMode::Edge);
    const glm::dvec3 p = random.Point(field, -1.0);
    const glm::dvec3 move = random.Vector(-2.0, 2.0);
    const DirectManipulation change = MoveMaterial(field, {}, { { p, move } });
    std::size_t nodes[BSplineField::MaximumSupport];
    double weights[BSplineField::MaximumSupport];
    const int count = field.ControlWeights(p, nodes, weights);
    double squares = 0.0;
    for (int n = 0; n < count; ++n)
    {
      squares += weights[n] * weights[n];
    }
    ASSERT_EQ(static_cast<int>(change.Nodes.size()), count);
    for (int n = 0; n < count; ++n)
    {
      const auto at = std::find(change.Nodes.begin(), change.Nodes.end(), nodes[n]);
      ASSERT_NE(at, change.Nodes.end());
      EXPECT_LT(glm::distance(change.Changes[static_cast<std::size_t>(at - change.Nodes.begin())],
                  weights[n] / squares * move),
        1e-12);
    }
    EXPECT_LT(glm::distance(change.Achieved[0], move), 1e-12);
    const BSplineField after = Changed(field, change);
    EXPECT_LT(glm::distance(after.Displacement(p), field.Displacement(p) + move), 1e-12);
  }
}

TEST(DirectManipulation, PinsHoldAndTheNormIsTheSmallest)
{
  RandomLattice random(73);
  int shared = 0;
  for (int l = 0; l < 60; ++l)
  {
    const BSplineField field = random.Field(1.0, AllBorders[l % 3], 6);
    std::vector<MaterialMove> constraints;
    for (int w = 0; w < 5; ++w)
    {
      constraints.push_back({ random.Point(field, -1.0), glm::dvec3(0.0) });
    }
    constraints.push_back({ random.Point(field, -1.0), random.Vector(-1.0, 1.0) });
    const DirectManipulation change = MoveMaterial(field, {}, constraints);
    const BSplineField after = Changed(field, change);
    for (const MaterialMove& constraint : constraints)
    {
      EXPECT_LT(glm::distance(after.Displacement(constraint.RestPoint),
                  field.Displacement(constraint.RestPoint) + constraint.Move),
        1e-9);
    }
    // Smallest norm: orthogonal to every direction that moves no point. Such directions: any net,
    // less what MoveMaterial needs to give each point the move that this net gives it.
    std::vector<glm::dvec3> net(CopyNet(field).size());
    for (glm::dvec3& d : net)
    {
      d = random.Vector(-1.0, 1.0);
    }
    const BSplineField any(
      field.GetNodes(), field.GetOrigin(), field.GetSpacing(), net.data(), 1.0, field.GetBorder());
    std::vector<MaterialMove> same = constraints;
    for (MaterialMove& constraint : same)
    {
      constraint.Move = any.Displacement(constraint.RestPoint);
    }
    const DirectManipulation fulfil = MoveMaterial(field, {}, same);
    for (std::size_t n = 0; n < fulfil.Nodes.size(); ++n)
    {
      net[fulfil.Nodes[n]] -= fulfil.Changes[n];
    }
    glm::dvec3 product(0.0);
    double size = 0.0;
    for (std::size_t n = 0; n < change.Nodes.size(); ++n)
    {
      product += change.Changes[n] * net[change.Nodes[n]];
      size += glm::dot(change.Changes[n], change.Changes[n]);
    }
    EXPECT_LT(glm::length(product), 1e-9 * (1.0 + std::sqrt(size)));
    shared += size > 1.0 ? 1 : 0;
  }
  EXPECT_GT(shared, 10);
}

TEST(DirectManipulation, LockedPointsStay)
{
  RandomLattice random(74);
  for (int l = 0; l < 40; ++l)
  {
    const BSplineField field = random.Field(1.0, BorderMode::Edge, 6);
    const glm::ivec3 n = field.GetNodes();
    std::vector<unsigned char> locked(static_cast<std::size_t>(n.x * n.y * n.z), 0);
    for (unsigned char& lock : locked)
    {
      lock = random.Integer(0, 2) == 0 ? 1 : 0;
    }
    const glm::dvec3 p = random.Point(field, -2.0);
    const glm::dvec3 move = random.Vector(-1.0, 1.0);
    const DirectManipulation change = MoveMaterial(field, locked, { { p, move } });
    EXPECT_LT(glm::distance(change.Achieved[0], move), 1e-12);
    for (std::size_t node : change.Nodes)
    {
      EXPECT_FALSE(locked[node]);
    }
  }
}

TEST(DirectManipulation, ConstraintsThatCannotBeMetAreTold)
{
  RandomLattice random(75);
  const BSplineField field = random.Field(1.0, BorderMode::Zero, 5);
  const glm::dvec3 p = random.Point(field, -1.0);
  // The same point twice: the pin wins, since it comes first.
  DirectManipulation change =
    MoveMaterial(field, {}, { { p, glm::dvec3(0.0) }, { p, glm::dvec3(1.0, 0.0, 0.0) } });
  EXPECT_LT(glm::length(change.Achieved[1]), 1e-12);
  // Outside a lattice that ends in zeros nothing moves.
  change = MoveMaterial(field, {}, { { field.GetOrigin() - 9.0 * field.GetSpacing(), p } });
  EXPECT_TRUE(change.Nodes.empty());
  EXPECT_EQ(change.Achieved[0], glm::dvec3(0.0));
  // All locked.
  const glm::ivec3 n = field.GetNodes();
  change = MoveMaterial(
    field, std::vector<unsigned char>(static_cast<std::size_t>(n.x * n.y * n.z), 1), { { p, p } });
  EXPECT_TRUE(change.Nodes.empty());
  // None.
  EXPECT_TRUE(MoveMaterial(field, {}, {}).Nodes.empty());
}
