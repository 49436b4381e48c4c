// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDElastixTransform_h
#define FFDElastixTransform_h

#include "FFDExport.h"
#include "FFDTransformStep.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ffd
{

/// One elastix parameter file: a step, or the file or the files that hold what stands in its place.
struct ElastixTransform
{
  TransformStep Step;
  /// (Transform "File"): a file of ITK with the transform; empty: Step.
  std::string TransformFile;
  /// WeightedCombinationTransform: parameter files, and what their displacements are multiplied by.
  std::vector<std::string> SubFiles;
  std::vector<double> Weights;
  /// File of the transform that is applied before (or added to) this one; empty: none.
  std::string InitialFile;
  /// HowToCombineTransforms "Add": initial(x) + step(x) - x, instead of step(initial(x)).
  bool Add = false;
  /// A stack, of which Step is one step: their number (0: no stack), the time of the first one, and
  /// from one to the next.
  std::size_t StackSize = 0;
  double StackOrigin = 0.0;
  double StackSpacing = 1.0;
  /// Grid of the fixed image; Size 0 where the file does not tell.
  TransformGrid FixedImage;
};

/// Most steps of a stack.
constexpr double LargestStack = 65536.0;

/**
 * Read a TransformParameters.*.txt of elastix: BSplineTransform and RecursiveBSplineTransform of
 * order 1 to 3, AffineTransform, AffineLogTransform, EulerTransform,
 * SimilarityTransform, TranslationTransform, WeightedCombinationTransform and File; and of a stack
 * of these (BSplineStackTransform, EulerStackTransform, AffineLogStackTransform,
 * TranslationStackTransform) step `stackIndex`, counted from 0. Returns false and what is wrong.
 * What is allocated is bounded by a small multiple of the text's length. Every number of the result
 * is finite and at most 1e12, spacings are positive, directions orthonormal.
 */
FFD_IO_EXPORT bool ParseElastixTransform(std::string_view text, ElastixTransform& transform,
  std::string& error, std::size_t stackIndex = 0);

/// Whether a text starts as this format does.
FFD_IO_EXPORT bool LooksLikeElastixTransform(std::string_view text);

/// The text of a spline step for transformix, with the grid of the image it is to write.
FFD_IO_EXPORT std::string FormatElastixTransform(
  const TransformStep& spline, const TransformGrid& fixedImage);

} // namespace ffd

#endif
