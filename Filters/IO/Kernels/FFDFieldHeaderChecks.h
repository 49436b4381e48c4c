// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDFieldHeaderChecks_h
#define FFDFieldHeaderChecks_h

#include "FFDFieldHeader.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <string_view>
#include <vector>

/// Checks shared by the parsers of MetaImage, NRRD and NIfTI headers.
namespace ffd
{

/// Sets direction and spacing of the header's grid from axes, columns that carry the spacing, and
/// checks the grid. False, and what is wrong.
bool SetFieldGrid(FieldHeader& header, const glm::dmat3& axes, std::string& error);

/// The name without "./" before it, as some programs write it.
std::string_view WithoutHere(std::string_view name);

/// A file in the same folder, no path: a header from elsewhere shall not open what it likes.
bool IsPlainFileName(std::string_view name);

/// Whether a data file name of a MetaImage or NRRD header stands for several files: LIST, or a
/// printf pattern with its range.
bool IsFileList(std::string_view name);

/// Three of the numbers, from `first` on, as a size: exactly whole and 1 at least, else false.
bool ReadFieldSize(const std::vector<double>& numbers, std::size_t first, glm::ivec3& size);

} // namespace ffd

#endif
