// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed, not wrapped.
#ifndef vtkFFDVectorScalars_h
#define vtkFFDVectorScalars_h

#include "FFDStage.h"

#include "vtkSmartPointer.h"

#include <cstdint>

class vtkDataArray;

namespace ffd
{

/// Stands for the magnitude, in the place of the number of a component.
constexpr int Magnitude = -1;

/**
 * The array of one component that is rendered in the place of one with several: a component of
 * them, of their type, or their magnitude, float (double, where float does not hold the type).
 * `component` must be one of theirs, or Magnitude; `contentTime` is that of the data set.
 */
Made MakeVectorScalars(vtkSmartPointer<vtkDataArray>& scalars, StageTools& tools,
  const Source<vtkDataArray>& vectors, std::uint64_t contentTime, int component);

} // namespace ffd

#endif
