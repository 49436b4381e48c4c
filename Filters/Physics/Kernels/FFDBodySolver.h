// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBodySolver_h
#define FFDBodySolver_h

#include "FFDExport.h"
#include "FFDGridIndex.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/// Loads that act on a body; they may change from step to step.
struct BodyLoads
{
  glm::dvec3 Gravity{ 0.0 };
  double Damping = 0.0; // 1 / s
  /// Force on each point; empty: none.
  std::vector<glm::dvec3> Forces;
  /// 1 for points that are held at Targets, else 0.
  std::vector<char> Pinned;
  std::vector<glm::dvec3> Targets;
  bool Floor = false; // springs only
  glm::dvec3 FloorNormal{ 0.0, 0.0, 1.0 };
  double FloorHeight = 0.0;   // along the normal
  double FloorFriction = 0.0; // 1 / s
  /// 1 for points that the floor stops.
  std::vector<char> Touches;
};

/// A regular grid of point masses that deforms in time. Index: x fastest.
class FFD_PHYSICS_EXPORT BodySolver
{
public:
  /// Equal masses.
  BodySolver(
    const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing, double totalMass);
  virtual ~BodySolver();

  /// One step in time. False when the system of equations cannot be solved.
  virtual bool Step(double h, const BodyLoads& loads) = 0;
  /// Finds the state of equilibrium. False if there is none (a body that nothing holds).
  virtual bool Settle(const BodyLoads& loads) = 0;
  virtual double GetElasticEnergy() const = 0;
  double GetKineticEnergy() const;
  /// Energy of gravity and forces, 0 at the rest positions.
  double GetLoadEnergy(const BodyLoads& loads) const;

  std::size_t GetSize() const { return this->Rest.size(); }
  std::size_t Index(int i, int j, int k) const { return GridIndex(i, j, k, this->Nodes); }

  glm::ivec3 Nodes;
  glm::dvec3 Spacing;
  std::vector<double> Masses;
  std::vector<glm::dvec3> Rest;
  std::vector<glm::dvec3> Positions;
  std::vector<glm::dvec3> Velocities;
};

/// The free points by number, in order; pinned ones are -1. `count` becomes the number of free
/// ones.
std::vector<int> NumberFreePoints(const std::vector<char>& pinned, int& count);

} // namespace ffd

#endif
