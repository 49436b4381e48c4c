// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDArrayRanges.h
 * @brief   finds the ranges of arrays, and lets the arrays keep them
 *
 * Private to this module: not installed, not wrapped.
 */
#ifndef vtkFFDArrayRanges_h
#define vtkFFDArrayRanges_h

class vtkDataSetAttributes;

/**
 * Finds the ranges of the components of all arrays, as vtkDataArray::GetRange() and
 * GetFiniteRange() do, which then return them at once. Those walk through the array once each, one
 * value at a time; ParaView asks for both whenever there are new values, in the thread that
 * renders. Arrays that are not laid out as vtkAOSDataArrayTemplate are left alone.
 */
void vtkFFDFindArrayRanges(vtkDataSetAttributes* attributes);

#endif
