// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDNiftiFile.h
 * @brief   reads NIfTI: .nii, .nii.gz, and pairs of .hdr and .img
 *
 * Private to this module: not installed, not wrapped. vtkNIFTIImageReader gives what
 * is stored, without its scaling, and crashes on types that it does not know.
 */
#ifndef vtkFFDNiftiFile_h
#define vtkFFDNiftiFile_h

#include "vtkFFDVolumeFile.h"

#include <memory>
#include <string>

namespace vtkFFDNiftiFile
{

/// Finds the problem of a pair of files, .hdr and .img, before anything opens one of them.
std::string FindPairProblem(const std::string& path);

/// A file that vtkNIFTIImageReader knows, else null.
std::unique_ptr<vtkFFDVolumeFile> Open(const std::string& path, vtkCommand* errors);

} // namespace vtkFFDNiftiFile

#endif
