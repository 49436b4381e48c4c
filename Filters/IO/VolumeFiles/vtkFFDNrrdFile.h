// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDNrrdFile.h
 * @brief   reads NRRD: .nrrd and .nhdr
 *
 * Private to this module: not installed, not wrapped. vtkNrrdReader leaves out directions, hangs on
 * headers that do not end, and reads four axes as others.
 */
#ifndef vtkFFDNrrdFile_h
#define vtkFFDNrrdFile_h

#include "vtkFFDVolumeFile.h"

#include <memory>
#include <string>

namespace vtkFFDNrrdFile
{

/// A file that begins as a NRRD, else null.
std::unique_ptr<vtkFFDVolumeFile> Open(const std::string& path, vtkCommand* errors);

} // namespace vtkFFDNrrdFile

#endif
