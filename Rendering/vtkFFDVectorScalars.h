// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDVectorScalars
 * @brief   array of one component that is rendered in the place of one with several
 *
 * Private to this module: not installed, not wrapped. The array is made again only when what it is
 * made from changes.
 */
#ifndef vtkFFDVectorScalars_h
#define vtkFFDVectorScalars_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>

class vtkDataArray;
class vtkFFDParallelFor;

class vtkFFDVectorScalars
{
public:
  /// What stands for the magnitude, in the place of the number of a component.
  static constexpr int Magnitude = -1;

  /// A component of the vectors, of their type, or their magnitude, float (double, where float does
  /// not hold the type). `component` must be one of theirs.
  vtkDataArray* Update(
    vtkDataArray* vectors, int component, const vtkFFDParallelFor& parallelFor);

  /// Free the array.
  void Clear();

  std::size_t GetMemorySize() const;

private:
  vtkSmartPointer<vtkDataArray> Vectors;
  vtkMTimeType Time = 0;
  int Component = 0;
  vtkSmartPointer<vtkDataArray> Scalars;
};

#endif
