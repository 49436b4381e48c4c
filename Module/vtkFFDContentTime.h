// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed, not wrapped.
#ifndef vtkFFDContentTime_h
#define vtkFFDContentTime_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkType.h"

class vtkDataSet;

/**
 * When the geometry and the arrays of a data set changed last: its modification time without that
 * of the field data, where lattices are attached. A filter that passes the arrays of its input on
 * and only attaches something to them says so with vtkFFDPassContentTime(): otherwise each of its
 * executions would look like a new volume, and what is derived from the voxels would be made again
 * at every edit of a lattice.
 */
VTKFFDCORE_EXPORT vtkMTimeType vtkFFDGetContentTime(vtkDataSet* data);

/// To be called at the end of RequestData(): `output` has the content of `input`. Forgotten as soon
/// as the output is modified in any way but by its field data.
VTKFFDCORE_EXPORT void vtkFFDPassContentTime(vtkDataSet* input, vtkDataSet* output);

#endif
