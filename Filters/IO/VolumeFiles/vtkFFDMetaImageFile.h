// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDMetaImageFile.h
 * @brief   reads MetaImage: .mha and .mhd
 *
 * Private to this module: not installed, not wrapped. vtkMetaImageReader leaves out directions, and
 * hands on whatever the memory held where data are missing.
 */
#ifndef vtkFFDMetaImageFile_h
#define vtkFFDMetaImageFile_h

#include "vtkFFDVolumeFile.h"

#include <memory>
#include <string>

class vtkImageReader2;

namespace vtkFFDMetaImageFile
{

/// Whether a file begins with more than any key of MetaImage, and no space. vtkMetaImageReader
/// reads the first word of .mha and .mhd files into 8000 bytes to see whether it knows them; where
/// VTK was built with GCC 10 or before, as its wheels are, nothing stops it there.
bool BeginsWithLongWord(const std::string& path);

/// The file of a reader that vtkImageReader2Factory has found; null, unless it is one of MetaImage.
std::unique_ptr<vtkFFDVolumeFile> Open(
  const std::string& path, vtkImageReader2* found, vtkCommand* errors);

} // namespace vtkFFDMetaImageFile

#endif
