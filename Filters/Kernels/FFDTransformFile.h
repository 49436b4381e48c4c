// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTransformFile_h
#define FFDTransformFile_h

#include "FFDControlNet.h"
#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace ffd
{

/// A regular grid in space: point (i, j, k) is Origin + Direction * ((i, j, k) * Spacing).
struct TransformGrid
{
  glm::ivec3 Size{ 0 };
  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 Spacing{ 1.0 };
  glm::dmat3 Direction{ 1.0 }; // column a is the unit vector of axis a; orthonormal, left-handed too
};

/**
 * One map of a chain as registration tools write them, in the file's own coordinates:
 * - Linear: x -> Matrix * x + Offset.
 * - Spline: x -> x + uniform cubic B-spline of Values, a control point at each node of Grid.
 * - Field: x -> x + Values, displacements at the nodes of Grid, linearly interpolated.
 */
struct TransformStep
{
  enum class Kind
  {
    Linear,
    Spline,
    Field
  };
  Kind Type = Kind::Linear;
  glm::dmat3 Matrix{ 1.0 };
  glm::dvec3 Offset{ 0.0 };
  TransformGrid Grid;
  std::vector<glm::dvec3> Values; // x fastest
  bool IsSum = false;             // a spline that a linear map was added to
};

/// ITK's text format: the steps in the order in which they are applied.
struct ItkTransform
{
  std::vector<TransformStep> Steps;
};

/// One elastix parameter file.
struct ElastixTransform
{
  TransformStep Step;
  /// File of the transform that is applied before (or added to) this one; empty: none.
  std::string InitialFile;
  /// HowToCombineTransforms "Add": initial(x) + step(x) - x, instead of step(initial(x)).
  bool Add = false;
  /// Grid of the fixed image; Size 0 where the file does not tell.
  TransformGrid FixedImage;
};

/**
 * Read a text transform of ITK (3D Slicer, ANTs; "#Insight Transform File V1.0"): the types
 * BSplineTransform and BSplineDeformableTransform (cubic), DisplacementFieldTransform,
 * AffineTransform, MatrixOffsetTransformBase, TranslationTransform, Euler3DTransform,
 * VersorRigid3DTransform, Similarity3DTransform, IdentityTransform and a CompositeTransform of
 * them, 3-D, float or double. Returns false and what is wrong. What is allocated is bounded by a
 * small multiple of the text's length, whatever the text says. Every number of the result is
 * finite and at most 1e12 in magnitude, spacings are positive, directions orthonormal.
 */
FFD_KERNEL_EXPORT bool ParseItkTransform(
  std::string_view text, ItkTransform& transform, std::string& error);

/**
 * Read a TransformParameters.*.txt of elastix: BSplineTransform and RecursiveBSplineTransform
 * (cubic), AffineTransform, EulerTransform, SimilarityTransform, TranslationTransform. As above.
 */
FFD_KERNEL_EXPORT bool ParseElastixTransform(
  std::string_view text, ElastixTransform& transform, std::string& error);

/// Whether a text starts as these formats do.
FFD_KERNEL_EXPORT bool LooksLikeItkTransform(std::string_view text);
FFD_KERNEL_EXPORT bool LooksLikeElastixTransform(std::string_view text);

/// The text of a chain of steps; numbers have the digits that give the same double back.
FFD_KERNEL_EXPORT std::string FormatItkTransform(const std::vector<TransformStep>& steps);

/// The text of a spline step for transformix, with the grid of the image it is to write.
FFD_KERNEL_EXPORT std::string FormatElastixTransform(
  const TransformStep& spline, const TransformGrid& fixedImage);

/// Empty when the grid is usable (sizes from `smallest` to 1024), else what is wrong with it.
FFD_KERNEL_EXPORT std::string FindGridProblem(const TransformGrid& grid, int smallest);

/**
 * The same step in coordinates whose first two axes point the other way: ITK's LPS (left,
 * posterior, superior) to RAS (right, anterior, superior) and back. T' = F T F, F = diag(-1, -1, 1).
 */
FFD_KERNEL_EXPORT void FlipTransformStep(TransformStep& step);

/**
 * Turn a Spline or Field step whose direction is a permutation of the axes, with signs, into the
 * same one with the identity as direction: nodes reordered. False for other directions, the step
 * unchanged. Entries within 1e-12 of 0 and 1 count as these.
 */
FFD_KERNEL_EXPORT bool AlignTransformStep(TransformStep& step);

/**
 * a(x) + b(x) - x as one step in `a`, elastix's "Add": of two linear maps, or of a linear map and a
 * spline, which reproduces it exactly within its grid. False for others, `a` unchanged.
 */
FFD_KERNEL_EXPORT bool AddTransformStep(TransformStep& a, const TransformStep& b);

} // namespace ffd

#endif
