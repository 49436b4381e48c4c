// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDDataFiles.h
 * @brief   looks at the files that headers of volumes name, before VTK's readers open them
 *
 * Private to this module: not installed, not wrapped. VTK's readers hang on pipes; that of
 * MetaImage leaves the memory of the voxels as it is where a file is missing or short, and hands
 * the names of slices to printf().
 */
#ifndef vtkFFDDataFiles_h
#define vtkFFDDataFiles_h

#include "vtkFFDStoredVoxels.h"

#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace vtkFFDDataFiles
{

/// "key separator value" of the lines of a header.
using Fields = std::map<std::string, std::string>;

/// The value of the first of some keys that a header has, or an empty text.
std::string Find(const Fields& fields, std::initializer_list<const char*> names);

/// The words of a text, between blanks.
std::vector<std::string> ToWords(const std::string& text);

/// Each function returns what is wrong, a sentence without its full stop, or an empty text. Paths
/// are those of the header, `text` is how the header begins, as far as it was read.

/// Finds the problem of a MetaImage of so many bytes in so many slices.
std::string FindMetaImageProblem(
  const std::string& path, const std::string& text, const Fields& fields, double bytes, int slices);

/// Finds the problem of a NRRD of so many bytes, which is to be found before VTK's reader opens it
/// with 0 for them: not known yet.
std::string FindNrrdProblem(
  const std::string& path, const std::string& text, const Fields& fields, double bytes, int slices);

/// Finds voxels that are not to be left to VTK's reader. The header is one without a problem, the
/// keys of a NRRD are in small letters.
vtkFFDStoredVoxels FindMetaImageVoxels(
  const std::string& path, const std::string& text, const Fields& fields);
vtkFFDStoredVoxels FindNrrdVoxels(
  const std::string& path, const std::string& text, const Fields& fields);

/// Finds the problem of an XML file that was cut off: VTK's reader fills numbers that are not
/// packed with what the memory held.
std::string FindXmlProblem(const std::string& path);

/// Finds the problem of a pair of files, .hdr and .img.
std::string FindPairProblem(const std::string& path);

/// Finds the problem of a folder, whose files are all opened.
std::string FindFolderProblem(const std::string& path);

} // namespace vtkFFDDataFiles

#endif
