// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDDataFiles.h
 * @brief   finds the files that headers of NRRD and MetaImage name, before VTK's readers open them
 *
 * Private to this module: not installed, not wrapped. VTK's readers hang on pipes; that of
 * MetaImage leaves the memory of the voxels as it is where a file is missing or short, and hands
 * the names of slices to printf().
 */
#ifndef vtkFFDDataFiles_h
#define vtkFFDDataFiles_h

#include <initializer_list>
#include <string>
#include <vector>

namespace vtkFFDDataFiles
{

/// A path in the header; an absolute one stays as it is.
std::string Resolve(const std::string& header, const std::string& name);

/// The files that "pattern first last step" names; with fewer numbers as MetaImage has it. Empty
/// after an error.
std::vector<std::string> ExpandPattern(const std::string& value, int slices);

/// The lines that follow the one that begins with a key.
std::vector<std::string> LinesAfter(const std::string& text, const std::string& key, int most);

/// Finds the problem of a file that a header names, perhaps without one of these endings.
std::string FindProblem(const std::string& header, const std::string& name, double leastBytes,
  std::initializer_list<const char*> endings = { "" });

/// Finds the first problem of such files.
std::string FindProblem(
  const std::string& header, const std::vector<std::string>& names, double leastBytes);

} // namespace vtkFFDDataFiles

#endif
