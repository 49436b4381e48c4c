// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDFitNetToTransform_h
#define vtkFFDFitNetToTransform_h

#include "vtkFFDCoreModule.h" // For export macro

class vtkAbstractTransform;

namespace ffd
{
enum class FitStatus;
struct FitLimits;
struct FittedNet;
}

/**
 * ffd::FitNetToFunction() of the displacements of a transform over the box of `fit`. Updates the
 * transform.
 */
VTKFFDCORE_EXPORT ffd::FitStatus vtkFFDFitNetToTransform(
  vtkAbstractTransform* transform, const ffd::FitLimits& limits, ffd::FittedNet& fit);

#endif
