// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed, not wrapped.
#ifndef vtkFFDOptions_h
#define vtkFFDOptions_h

#include "vtkFFDCoreModule.h" // For export macro

class vtkObject;

///@{
/**
 * For setters of options: `member` of `self` becomes what is given, and `self` is modified where
 * that is another value. False, after an error of `self`, for what is not finite, not above 0 (but
 * bounds may be), or null. `name`: that of the option for the first one, of the setter for the
 * others.
 */
VTKFFDCORE_EXPORT bool vtkFFDSetPositive(
  vtkObject* self, const char* name, double& member, double value);
VTKFFDCORE_EXPORT bool vtkFFDSetTolerance(
  vtkObject* self, const char* name, double& member, double tolerance);
VTKFFDCORE_EXPORT bool vtkFFDSetBounds(
  vtkObject* self, const char* name, double member[6], const double bounds[6]);
///@}

///@{
/**
 * Control points per axis of lattices that are edited. Whether `sizes` are within these limits, or
 * all 0 where `zeroAllowed`; else there is an error of `self`, whose option `name` stays `member`.
 */
constexpr int vtkFFDSmallestEditSize = 4;
constexpr int vtkFFDLargestEditSize = 64;
constexpr int vtkFFDLargestEditCount =
  vtkFFDLargestEditSize * vtkFFDLargestEditSize * vtkFFDLargestEditSize;
VTKFFDCORE_EXPORT bool vtkFFDAreEditSizes(
  vtkObject* self, const char* name, const int member[3], const int sizes[3], bool zeroAllowed);
///@}

#endif
