// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDImageDataFile.h
 * @brief   reads VTK's own image data: .vti and legacy .vtk
 *
 * Private to this module: not installed, not wrapped. Both have readers that
 * hand on whatever the memory held where numbers are missing.
 */
#ifndef vtkFFDImageDataFile_h
#define vtkFFDImageDataFile_h

#include "vtkFFDVolumeFile.h"

#include <memory>
#include <string>

namespace vtkFFDImageDataFile
{

/// Finds the problem of an XML file that was cut off: VTK's reader fills numbers that are not
/// packed with what the memory held.
std::string FindXmlProblem(const std::string& path);

/// A file of one of these extensions, else null.
std::unique_ptr<vtkFFDVolumeFile> Open(const std::string& path, vtkCommand* errors);

} // namespace vtkFFDImageDataFile

#endif
