// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldHeader.h"

#include "FFDFieldHeaderChecks.h"
#include "FFDTextNumbers.h"

#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace ffd
{
namespace
{

using Number = FieldHeader::Number;

/// "(x,y,z)".
bool ReadNrrdVector(std::string_view text, glm::dvec3& v)
{
  text = Trim(text);
  if (text.size() < 2 || text.front() != '(' || text.back() != ')')
  {
    return false;
  }
  text = text.substr(1, text.size() - 2);
  for (int a = 0; a < 3; ++a)
  {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (a == 2) ||
      !ReadNumber(Trim(text.substr(0, comma)), v[a]))
    {
      return false;
    }
    text.remove_prefix(a == 2 ? text.size() : comma + 1);
  }
  return true;
}

/// The fields of a header, by their names as FindNrrdField() gives them.
using NrrdFields = std::map<std::string, std::string_view>;

/// A number for each axis of the array. "nan" stands for one that is not known.
bool ReadNrrdAxes(
  std::string_view text, const char* name, std::vector<double>& numbers, std::string& error)
{
  bool readable = true;
  for (std::string_view word = TakeWord(text); !word.empty(); word = TakeWord(text))
  {
    double number = std::numeric_limits<double>::quiet_NaN();
    // That of the axis of the vectors may be anything.
    readable = readable && (numbers.empty() || ToLower(word) == "nan" || ReadNumber(word, number));
    numbers.push_back(number);
  }
  if (!readable || numbers.size() != 4)
  {
    error = std::string("the ") + name + " are not one number for each of the four axes";
    return false;
  }
  return true;
}

/// Where the nodes are if each axis tells it by itself, without a space.
bool PlaceNrrdAxes(NrrdFields& fields, glm::dmat3& axes, glm::dvec3& origin, std::string& error)
{
  const std::string_view spacings = fields["spacings"];
  const std::string_view mins = fields["axis mins"];
  if (spacings.empty() && mins.empty() && fields["axis maxs"].empty())
  {
    return true;
  }
  if (fields.count("space") != 0 || fields.count("space dimension") != 0)
  {
    error = "there is a space without space directions, so that the spacings, axis mins or axis "
            "maxs do not tell where it lies";
    return false;
  }
  if (spacings.empty())
  {
    error = "there are axis mins or axis maxs without spacings, which is not supported";
    return false;
  }
  std::vector<double> spacing;
  std::vector<double> min;
  if (!ReadNrrdAxes(spacings, "spacings", spacing, error) ||
    (!mins.empty() && !ReadNrrdAxes(mins, "axis mins", min, error)))
  {
    return false;
  }
  glm::dvec3 steps(spacing[1], spacing[2], spacing[3]);
  for (int a = 0; a < 3; ++a)
  {
    steps[a] = std::isnan(steps[a]) ? 1.0 : steps[a];
    axes[a] *= steps[a];
  }
  origin = FindNrrdOrigin(min, fields["centers"], 1, steps);
  return true;
}

} // namespace

//------------------------------------------------------------------------------
bool LooksLikeNrrd(std::string_view bytes) { return bytes.substr(0, 7) == "NRRD000"; }

//------------------------------------------------------------------------------
std::string FindNrrdField(std::string_view name)
{
  const std::string wanted = ToLower(name);
  if (wanted == "centerings")
  {
    return "centers";
  }
  for (const char* field : { "axis maxs", "axis mins", "block size", "byte skip", "centers",
         "content", "data file", "dimension", "encoding", "endian", "kinds", "labels", "line skip",
         "max", "measurement frame", "min", "number", "old max", "old min", "sample units", "sizes",
         "space", "space dimension", "space directions", "space origin", "space units", "spacings",
         "thicknesses", "type", "units" })
  {
    std::string joined = field;
    joined.erase(std::remove(joined.begin(), joined.end(), ' '), joined.end());
    if (wanted == field || wanted == joined)
    {
      return field;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
glm::dvec3 FindNrrdOrigin(const std::vector<double>& mins, std::string_view centers,
  std::size_t first, const glm::dvec3& spacing)
{
  glm::dvec3 origin(0.0);
  for (std::size_t axis = 0; axis < first + 3 && mins.size() >= first + 3; ++axis)
  {
    const bool isNode = ToLower(TakeWord(centers)) == "node";
    if (axis >= first)
    {
      const int a = static_cast<int>(axis - first);
      const double node = mins[axis] + (isNode ? 0.0 : 0.5 * spacing[a]);
      origin[a] = std::isfinite(node) ? node : 0.0;
    }
  }
  return origin;
}

//------------------------------------------------------------------------------
bool ParseNrrdHeader(std::string_view bytes, FieldHeader& header, std::string& error)
{
  header = FieldHeader();
  error.clear();
  if (!LooksLikeNrrd(bytes))
  {
    error = "the file does not begin with 'NRRD000'";
    return false;
  }
  std::string_view text = bytes.substr(0, LargestFieldHeader);
  TakeLine(text);
  // Names and words of the format are the same in capital letters.
  NrrdFields fields;
  bool complete = false;
  while (!text.empty() && !complete)
  {
    const std::string_view line = Trim(TakeLine(text));
    if (line.empty())
    {
      complete = true;
      continue;
    }
    if (line.front() == '#')
    {
      continue;
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
    {
      error = "the line " + Quote(line) + " of the header has no ':'";
      return false;
    }
    if (colon + 1 < line.size() && line[colon + 1] == '=')
    {
      continue; // a key/value pair, of no meaning to the format
    }
    const std::string_view name = Trim(line.substr(0, colon));
    const std::string key = FindNrrdField(name);
    // Refused as by teem and ITK: a "space origin" that is misspelled would be one of zeros.
    if (key.empty())
    {
      error = "the header has a field " + Quote(name) + ", which is none of the format";
      return false;
    }
    if (!fields.emplace(key, Trim(line.substr(colon + 1))).second)
    {
      error = "there are two lines of " + Quote(key);
      return false;
    }
  }
  const auto value = [&fields](const char* key, std::string_view otherwise) {
    const auto found = fields.find(key);
    return found == fields.end() ? otherwise : found->second;
  };
  const auto word = [&value](const char* key, std::string_view otherwise) {
    return ToLower(value(key, otherwise));
  };
  const std::string_view file = WithoutHere(value("data file", ""));
  if (!complete && file.empty())
  {
    error = "the header does not end with an empty line in the first 64 kB";
    return false;
  }
  std::vector<double> sizes;
  if (value("dimension", "") != "4" || !ReadNumbers(value("sizes", ""), "sizes", sizes, error) ||
    sizes.size() != 4 || sizes[0] != 3.0 || !ReadFieldSize(sizes, 1, header.Grid.Size))
  {
    error = "the array is " + Quote(value("sizes", "")) +
      ", not one of the four sizes 3 nx ny nz (vectors first)";
    return false;
  }
  static const std::map<std::string_view, Number> types = { { "signed char", Number::Int8 },
    { "int8", Number::Int8 }, { "int8_t", Number::Int8 }, { "uchar", Number::UInt8 },
    { "unsigned char", Number::UInt8 }, { "uint8", Number::UInt8 }, { "uint8_t", Number::UInt8 },
    { "short", Number::Int16 }, { "short int", Number::Int16 }, { "signed short", Number::Int16 },
    { "signed short int", Number::Int16 }, { "int16", Number::Int16 }, { "int16_t", Number::Int16 },
    { "ushort", Number::UInt16 }, { "unsigned short", Number::UInt16 },
    { "unsigned short int", Number::UInt16 }, { "uint16", Number::UInt16 },
    { "uint16_t", Number::UInt16 }, { "int", Number::Int32 }, { "signed int", Number::Int32 },
    { "int32", Number::Int32 }, { "int32_t", Number::Int32 }, { "uint", Number::UInt32 },
    { "unsigned int", Number::UInt32 }, { "uint32", Number::UInt32 },
    { "uint32_t", Number::UInt32 }, { "float", Number::Float32 }, { "double", Number::Float64 } };
  const auto type = types.find(word("type", ""));
  if (type == types.end())
  {
    error = "the type is " + Quote(value("type", "")) + ", which is not supported";
    return false;
  }
  header.Type = type->second;
  const std::string encoding = word("encoding", "");
  header.Compressed = encoding == "gzip" || encoding == "gz";
  if (!header.Compressed && encoding != "raw")
  {
    error = "the encoding is " + Quote(encoding) + ", not raw or gzip";
    return false;
  }
  const std::string endian = word("endian", header.GetNumberSize() == 1 ? "little" : "");
  header.BigEndian = endian == "big";
  if (!header.BigEndian && endian != "little")
  {
    error = "the endian is " + Quote(endian) + ", not little or big";
    return false;
  }
  for (const char* skip : { "line skip", "byte skip" })
  {
    if (value(skip, "0") != "0")
    {
      error = std::string("a ") + skip + " is not supported";
      return false;
    }
  }
  if (file.empty())
  {
    header.Offset = static_cast<std::size_t>(text.data() - bytes.data());
  }
  else if (IsFileList(file) || !IsPlainFileName(file))
  {
    error = "the data file is " + Quote(file) + ", not one file in the same folder";
    return false;
  }
  else
  {
    header.DataFile = std::string(file);
  }

  const std::string space = word("space", "left-posterior-superior");
  const bool ras = space == "right-anterior-superior" || space == "ras";
  if (!ras && space != "left-posterior-superior" && space != "lps")
  {
    error =
      "the space is " + Quote(space) + ", not left-posterior-superior or right-anterior-superior";
    return false;
  }
  glm::dmat3 axes(1.0);
  bool readable = true;
  if (fields.count("space directions") == 0)
  {
    if (!PlaceNrrdAxes(fields, axes, header.Grid.Origin, error))
    {
      return false;
    }
  }
  else
  {
    std::string_view directions = value("space directions", "");
    readable = TakeWord(directions) == "none";
    for (int a = 0; a < 3; ++a)
    {
      const std::size_t end = directions.find(')');
      readable = readable && end != std::string_view::npos &&
        ReadNrrdVector(directions.substr(0, end + 1), axes[a]);
      directions.remove_prefix(readable ? end + 1 : 0);
    }
    readable = readable && Trim(directions).empty();
  }
  if (!readable ||
    (fields.count("space origin") != 0 &&
      !ReadNrrdVector(value("space origin", ""), header.Grid.Origin)))
  {
    error = "the space directions or the space origin are not 'none (x,y,z) (x,y,z) (x,y,z)' and "
            "'(x,y,z)'";
    return false;
  }
  if (ras)
  {
    const glm::dvec3 flip(-1.0, -1.0, 1.0);
    header.Grid.Origin *= flip;
    for (int a = 0; a < 3; ++a)
    {
      axes[a] *= flip;
    }
  }
  return SetFieldGrid(header, axes, error);
}

//------------------------------------------------------------------------------
std::string FormatNrrdHeader(const TransformGrid& grid)
{
  std::string text = "NRRD0004\ntype: double\ndimension: 4\nspace: left-posterior-superior\n"
                     "sizes: 3";
  for (int a = 0; a < 3; ++a)
  {
    text += ' ' + std::to_string(grid.Size[a]);
  }
  const auto vector = [&text](const glm::dvec3& v) {
    text += '(';
    for (int a = 0; a < 3; ++a)
    {
      text += a == 0 ? "" : ",";
      AppendNumber(text, v[a]);
    }
    text += ')';
  };
  text += "\nspace directions: none ";
  for (int a = 0; a < 3; ++a)
  {
    vector(grid.Direction[a] * grid.Spacing[a]);
    text += a < 2 ? " " : "\n";
  }
  text += "kinds: vector domain domain domain\nendian: little\nencoding: raw\nspace origin: ";
  vector(grid.Origin);
  return text + "\n\n";
}

} // namespace ffd
