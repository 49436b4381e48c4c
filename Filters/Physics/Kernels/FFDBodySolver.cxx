// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBodySolver.h"

#include <glm/geometric.hpp>

namespace ffd
{

//------------------------------------------------------------------------------
BodySolver::BodySolver(
  const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing, double totalMass)
  : Nodes(nodes)
  , Spacing(spacing)
{
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      for (int i = 0; i < nodes.x; ++i)
      {
        this->Rest.push_back(origin + glm::dvec3(i, j, k) * spacing);
      }
    }
  }
  this->Masses.assign(this->Rest.size(), totalMass / static_cast<double>(this->Rest.size()));
  this->Positions = this->Rest;
  this->Velocities.assign(this->Rest.size(), glm::dvec3(0.0));
}

//------------------------------------------------------------------------------
BodySolver::~BodySolver() = default;

//------------------------------------------------------------------------------
double BodySolver::GetKineticEnergy() const
{
  double energy = 0.0;
  for (std::size_t i = 0; i < this->Velocities.size(); ++i)
  {
    energy += 0.5 * this->Masses[i] * glm::dot(this->Velocities[i], this->Velocities[i]);
  }
  return energy;
}

//------------------------------------------------------------------------------
double BodySolver::GetLoadEnergy(const BodyLoads& loads) const
{
  double energy = 0.0;
  for (std::size_t i = 0; i < this->Rest.size(); ++i)
  {
    glm::dvec3 force = this->Masses[i] * loads.Gravity;
    force += loads.Forces.empty() ? glm::dvec3(0.0) : loads.Forces[i];
    energy -= glm::dot(force, this->Positions[i] - this->Rest[i]);
  }
  return energy;
}

//------------------------------------------------------------------------------
std::vector<int> NumberFreePoints(const std::vector<char>& pinned, int& count)
{
  std::vector<int> numbers(pinned.size(), -1);
  count = 0;
  for (std::size_t i = 0; i < pinned.size(); ++i)
  {
    if (!pinned[i])
    {
      numbers[i] = count++;
    }
  }
  return numbers;
}

} // namespace ffd
