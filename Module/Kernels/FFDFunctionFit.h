// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDFunctionFit_h
#define FFDFunctionFit_h

#include "FFDExport.h"
#include "FFDLatticeFit.h"

#include <glm/vec3.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace ffd
{

/// A displacement that can be evaluated anywhere.
struct DisplacementSampler
{
  /// Finds the displacements of points; false: some are not finite.
  std::function<bool(const std::vector<glm::dvec3>& points, std::vector<glm::dvec3>& displacements)>
    Sample;
  /// The size of its details along each axis, as the spacing of the grid that it is given on; 0
  /// where that is not known.
  glm::dvec3 Detail{ 0.0 };
  /// Where it has details of any size, as at landmarks.
  std::vector<glm::dvec3> Places;
};

/**
 * A net over a box that follows a displacement: it interpolates samples at the nodes
 * (InterpolateControlNet), and the axes that err too much between them get twice the cells. Starts
 * with four cells.
 *
 * The displacement is sampled on a regular grid of 16 cells per axis, or up to 64, so that these
 * are no larger than its details; and beside that halfway between the nodes of cells at whose
 * corners the net before was in error by more than a quarter of the tolerance: in other cells what
 * four times the samples would tell is small. What is sampled is not sampled again. The errors of
 * the net are those at all of these samples and places, others counted as none.
 */
class FFD_CORE_EXPORT FunctionFit
{
public:
  /// Of the box from `lower` on, `extent` large.
  FunctionFit(DisplacementSampler sampler, const glm::dvec3& lower, const glm::dvec3& extent);
  ~FunctionFit();

  /// Refines until the tolerance is kept, or as far as is allowed. Again with other limits: from
  /// there on.
  FitStatus Run(const FitLimits& limits);

  /// As of Run(); usable if that said so.
  const FittedNet& GetNet() const;

private:
  class Internals;
  std::unique_ptr<Internals> State;
};

} // namespace ffd

#endif
