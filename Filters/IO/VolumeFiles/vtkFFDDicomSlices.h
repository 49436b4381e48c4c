// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDDicomSlices.h
 * @brief   reads a folder of DICOM slices
 *
 * Private to this module: not installed, not wrapped. vtkDICOMImageReader turns rows, and leaves
 * out position and orientation of the patient.
 */
#ifndef vtkFFDDicomSlices_h
#define vtkFFDDicomSlices_h

#include "vtkFFDVolumeFile.h"

#include <memory>
#include <string>

namespace vtkFFDDicomSlices
{

/// Whether a file is one of DICOM.
bool IsSlice(const std::string& path);

/// Any folder.
std::unique_ptr<vtkFFDVolumeFile> Open(const std::string& folder, vtkCommand* errors);

} // namespace vtkFFDDicomSlices

#endif
