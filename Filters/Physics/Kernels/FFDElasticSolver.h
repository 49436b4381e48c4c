// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDElasticSolver_h
#define FFDElasticSolver_h

#include "FFDBodySolver.h"
#include "FFDExport.h"

#include <memory>

namespace ffd
{

/**
 * Linear elasticity of an isotropic solid, a hexahedron with incompatible modes (Wilson, Taylor,
 * Doherty and Ghaboussi 1973; no locking in bending) for each cell, its mass lumped at its corners,
 * Newmark's method of constant average acceleration: without damping the energy is conserved
 * exactly.
 */
class FFD_PHYSICS_EXPORT ElasticSolver : public BodySolver
{
public:
  ElasticSolver(const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing,
    double totalMass, double young, double poisson);
  ~ElasticSolver() override;

  bool Step(double h, const BodyLoads& loads) override;
  bool Settle(const BodyLoads& loads) override;
  double GetElasticEnergy() const override;

private:
  struct Internals;
  std::unique_ptr<Internals> Data;
};

} // namespace ffd

#endif
