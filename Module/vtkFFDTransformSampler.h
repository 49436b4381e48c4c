// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDTransformSampler_h
#define vtkFFDTransformSampler_h

#include "vtkFFDCoreModule.h" // For export macro

#include "FFDFunctionFit.h"

class vtkAbstractTransform;

/**
 * Samples the displacements of a transform for its fit by ffd::FunctionFit. Each call updates the
 * transform, which the sampler keeps alive. Threads of `parallelFor` share the work where no
 * message can come of it: only inverses have some, of points at which they do not converge. Details
 * are those of the grids and splines that the transform, its parts or its terms are given on, as
 * large as the smallest spacing where these may turn them, and places the source landmarks of a
 * thin-plate spline that is not a part.
 */
VTKFFDCORE_EXPORT ffd::DisplacementSampler vtkFFDMakeTransformSampler(
  vtkAbstractTransform* transform, const ffd::ParallelFor& parallelFor);

#endif
