// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDBSplineFieldFromTransform_h
#define vtkFFDBSplineFieldFromTransform_h

#include "vtkFFDCoreModule.h" // For export macro

#include <string> // for std::string

class vtkBSplineTransform;

namespace ffd
{
class BSplineField;
}

/**
 * The displacement field of any vtkBSplineTransform (a vtkFFDLattice, too), for kernels: its
 * coefficients of whatever scalar type and extent, DisplacementScale and BorderMode applied.
 * Updates the transform. `inverse` is its InverseFlag: true when the transform is T^-1 rather
 * than T(X) = X + D(X). A transform without coefficients gives the zero field, as it is the
 * identity in VTK. Returns false, with the reason in `error` and the zero field, for null, for
 * other than 3 components, an empty or non-finite image, or a spacing of zero.
 */
VTKFFDCORE_EXPORT bool vtkFFDBSplineFieldFromTransform(
  vtkBSplineTransform* transform, ffd::BSplineField& field, bool& inverse, std::string& error);

#endif
