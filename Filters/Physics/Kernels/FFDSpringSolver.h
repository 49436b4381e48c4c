// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSpringSolver_h
#define FFDSpringSolver_h

#include "FFDBodySolver.h"
#include "FFDExport.h"

#include <memory>

namespace ffd
{

/**
 * Springs between neighbors along the axes (structural), the diagonals of faces and cells (shear)
 * and second neighbors along the axes (bend). Implicit Euler as a minimization, by alternating
 * directions of springs and positions (Liu, Bargteil, O'Brien and Kavan 2013): the matrix is
 * constant and factorized once. Stable at any step. The first iteration, whose directions are those
 * of the start of the step, cannot add energy (the springs' energy is below the quadratic one of
 * fixed directions and touches it at the start); should the later, more accurate ones do, the
 * velocity is reduced, or the first one taken. The floor is a bound on the points along its normal,
 * kept by contact forces (projected Gauss-Seidel on the Schur complement of the contacts).
 */
class FFD_PHYSICS_EXPORT SpringSolver : public BodySolver
{
public:
  SpringSolver(const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing,
    double totalMass, double structural, double shear, double bend);
  ~SpringSolver() override;

  bool Step(double h, const BodyLoads& loads) override;
  bool Settle(const BodyLoads& loads) override;
  double GetElasticEnergy() const override;

  int Iterations = 10;

private:
  struct Internals;
  std::unique_ptr<Internals> Data;
};

} // namespace ffd

#endif
