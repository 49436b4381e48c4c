// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDTextHeader.h
 * @brief   reads the lines of text in front of the voxels of a NRRD or MetaImage
 *
 * Private to this module: not installed, not wrapped.
 */
#ifndef vtkFFDTextHeader_h
#define vtkFFDTextHeader_h

#include <glm/vec3.hpp>

#include <cstddef>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace vtkFFDTextHeader
{

/// Bytes of a file in which its header is looked for.
constexpr std::size_t LargestSize = 65536;

/// The first bytes of a file, or all of a shorter one.
std::string ReadStart(const std::string& path, std::size_t bytes = LargestSize);

/// "key separator value" of the lines of a header.
using Fields = std::map<std::string, std::string>;

/// "key<separator> value" lines of the header of a text format, until an empty line. Keys of NRRD
/// are as ffd::FindNrrdField() has them, where it knows them, and the words of the format after
/// them are in small letters, as capital ones mean the same.
Fields ReadFields(const std::string& text, char separator);

/// The value of the first of some keys that a header has, or an empty text.
std::string Find(const Fields& fields, std::initializer_list<const char*> names);

/// The words of a text, between blanks.
std::vector<std::string> ToWords(const std::string& text);

/// The numbers of a text, whatever is between them.
std::vector<double> ReadNumbers(std::string text);

/// Three of these numbers.
glm::dvec3 ToVector(const std::vector<double>& numbers, std::size_t first);

} // namespace vtkFFDTextHeader

#endif
