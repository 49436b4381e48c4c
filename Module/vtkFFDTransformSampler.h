// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDTransformSampler_h
#define vtkFFDTransformSampler_h

#include "vtkFFDCoreModule.h" // For export macro

#include "FFDLatticeFit.h"

class vtkAbstractTransform;

/**
 * Samples the displacements of a transform for the fits of ffd::FitNetToFunction() and
 * ffd::Lattice::Fit(). Each call updates the transform, which the sampler keeps alive. Threads of
 * `parallelFor` share the work where no message can come of it: only inverses have some, of points
 * at which they do not converge.
 */
VTKFFDCORE_EXPORT ffd::DisplacementSampler vtkFFDMakeTransformSampler(
  vtkAbstractTransform* transform, const ffd::ParallelFor& parallelFor);

#endif
