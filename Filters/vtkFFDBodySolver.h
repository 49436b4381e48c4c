// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed. No VTK but for its copy of Eigen, which kernels may not use.
#ifndef vtkFFDBodySolver_h
#define vtkFFDBodySolver_h

#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <vector>

/// What acts on a body; may change from step to step.
struct vtkFFDBodyLoads
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
  double FloorHeight = 0.0; // along the normal
  double FloorFriction = 0.0; // 1 / s
  /// 1 for points that the floor stops.
  std::vector<char> Touches;
};

/// A regular grid of point masses that deforms in time. Index: x fastest.
class vtkFFDBodySolver
{
public:
  /// Equal masses.
  vtkFFDBodySolver(const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing,
    double totalMass);
  virtual ~vtkFFDBodySolver();

  /// One step in time. False when the system of equations cannot be solved.
  virtual bool Step(double h, const vtkFFDBodyLoads& loads) = 0;
  /// Where nothing moves any more. False when there is no such state (a body that nothing holds).
  virtual bool Settle(const vtkFFDBodyLoads& loads) = 0;
  virtual double GetElasticEnergy() const = 0;
  double GetKineticEnergy() const;
  /// Energy of gravity and forces, 0 at the rest positions.
  double GetLoadEnergy(const vtkFFDBodyLoads& loads) const;

  std::size_t GetSize() const { return this->Rest.size(); }
  std::size_t Index(int i, int j, int k) const
  {
    return static_cast<std::size_t>(i) +
      static_cast<std::size_t>(this->Nodes.x) *
      (static_cast<std::size_t>(j) +
        static_cast<std::size_t>(this->Nodes.y) * static_cast<std::size_t>(k));
  }

  glm::ivec3 Nodes;
  glm::dvec3 Spacing;
  std::vector<double> Masses;
  std::vector<glm::dvec3> Rest;
  std::vector<glm::dvec3> Positions;
  std::vector<glm::dvec3> Velocities;
};

/**
 * Springs between neighbours along the axes (structural), the diagonals of faces and cells (shear)
 * and second neighbours along the axes (bend). Implicit Euler as a minimization, by alternating
 * directions of springs and positions (Liu, Bargteil, O'Brien and Kavan 2013): the matrix is
 * constant and factorized once. Stable at any step. The first iteration, whose directions are those
 * of the start of the step, cannot add energy (the springs' energy is below the quadratic one of
 * fixed directions and touches it at the start); should the later, more accurate ones do, the
 * velocity is reduced, or the first one taken. The floor is a bound on the points along its normal,
 * kept by contact forces (projected Gauss-Seidel on the Schur complement of the contacts).
 */
class vtkFFDSpringSolver : public vtkFFDBodySolver
{
public:
  vtkFFDSpringSolver(const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing,
    double totalMass, double structural, double shear, double bend);
  ~vtkFFDSpringSolver() override;

  bool Step(double h, const vtkFFDBodyLoads& loads) override;
  bool Settle(const vtkFFDBodyLoads& loads) override;
  double GetElasticEnergy() const override;

  int Iterations = 10;

private:
  struct Internals;
  std::unique_ptr<Internals> Data;
};

/**
 * Linear elasticity of an isotropic solid, a hexahedron with incompatible modes (Wilson, Taylor,
 * Doherty and Ghaboussi 1973; no locking in bending) for each cell, its mass lumped at its corners, Newmark's method of
 * constant average acceleration: without damping the energy is conserved exactly.
 */
class vtkFFDElasticSolver : public vtkFFDBodySolver
{
public:
  vtkFFDElasticSolver(const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing,
    double totalMass, double young, double poisson);
  ~vtkFFDElasticSolver() override;

  bool Step(double h, const vtkFFDBodyLoads& loads) override;
  bool Settle(const vtkFFDBodyLoads& loads) override;
  double GetElasticEnergy() const override;

private:
  struct Internals;
  std::unique_ptr<Internals> Data;
};

#endif
