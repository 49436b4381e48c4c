// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTransformStep_h
#define FFDTransformStep_h

#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace ffd
{

/// A regular grid in space: point (i, j, k) is Origin + Direction * ((i, j, k) * Spacing).
struct TransformGrid
{
  glm::ivec3 Size{ 0 };
  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 Spacing{ 1.0 };
  glm::dmat3 Direction{
    1.0
  }; // column a is the unit vector of axis a; orthonormal, left-handed too
};

struct TransformStep;

/// A chain of steps, first applied first, and how much its displacement counts in a sum.
struct TransformTerm
{
  double Weight = 1.0;
  std::vector<TransformStep> Steps;
};

/**
 * One map of a chain as registration tools write them, in the file's own coordinates:
 * - Linear: x -> Matrix * x + Offset.
 * - Spline: x -> x + uniform B-spline of Values, of degree Order, a control point at each node of
 *   Grid.
 * - Field: x -> x + Values, displacements at the nodes of Grid, linearly interpolated.
 * - Sum: x -> x + the sum over Terms of Weight * (term(x) - x).
 */
struct TransformStep
{
  enum class Kind
  {
    Linear,
    Spline,
    Field,
    Sum
  };
  Kind Type = Kind::Linear;
  glm::dmat3 Matrix{ 1.0 };
  glm::dvec3 Offset{ 0.0 };
  TransformGrid Grid;
  std::vector<glm::dvec3> Values; // x fastest
  int Order = 3;                  // of a spline: 1 to 3
  bool IsSum = false;             // a spline that a linear map was added to
  bool IsInverse = false;         // a field whose inverse is the map
  std::vector<TransformTerm> Terms;
};

/// Most steps of a chain, those of its sums counted.
constexpr std::size_t LargestChain = 64;

/// Empty when the grid is usable (sizes from `smallest` to 1024), else what is wrong with it.
FFD_IO_EXPORT std::string FindGridProblem(const TransformGrid& grid, int smallest);

/// A collapsed linear map has no inverse, and nothing can be shown through it.
FFD_IO_EXPORT bool IsSingular(const TransformStep& step);

/// x -> matrix (x - center) + center + translation.
FFD_IO_EXPORT void SetCentered(TransformStep& step, const glm::dmat3& matrix,
  const glm::dvec3& center, const glm::dvec3& translation);

/**
 * The same step in coordinates whose first two axes point the other way: ITK's LPS (left,
 * posterior, superior) to RAS (right, anterior, superior) and back. T' = F T F, F = diag(-1, -1,
 * 1).
 */
FFD_IO_EXPORT void FlipTransformStep(TransformStep& step);

/**
 * Turn a Spline or Field step whose direction is a permutation of the axes, with signs, into the
 * same one with the identity as direction: nodes reordered. False for other directions, the step
 * unchanged. Entries within 1e-12 of 0 and 1 count as these.
 */
FFD_IO_EXPORT bool AlignTransformStep(TransformStep& step);

/**
 * a(x) + b(x) - x as one step in `a`, elastix's "Add": of two linear maps, of a linear map and a
 * spline, which reproduces it exactly within its grid, and of two splines of one order on one grid.
 * False for others, `a` unchanged.
 */
FFD_IO_EXPORT bool AddTransformStep(TransformStep& a, const TransformStep& b);

} // namespace ffd

#endif
