// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldHeader.h"

#include "FFDFieldHeaderChecks.h"
#include "FFDTextNumbers.h"

#include <glm/mat3x3.hpp>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <set>

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

/// The fields of a header, by their names in small letters.
using NrrdFields = std::map<std::string, std::string_view>;

/// The value of the first of some names of a field that a header has, or an empty text.
std::string_view FindNrrdField(const NrrdFields& fields, std::initializer_list<const char*> names)
{
  for (const char* name : names)
  {
    const auto found = fields.find(name);
    if (found != fields.end())
    {
      return found->second;
    }
  }
  return {};
}

/// Numbers of the axes of space, of a list with one for each axis of the array. "nan" stands for
/// one that is not known, which leaves `v` as it is.
bool ReadNrrdAxes(std::string_view text, const char* name, glm::dvec3& v, std::string& error)
{
  TakeWord(text); // that of the axis of the vectors
  bool readable = true;
  for (int a = 0; a < 3; ++a)
  {
    const std::string_view word = TakeWord(text);
    readable = readable && (ToLower(word) == "nan" || ReadNumber(word, v[a]));
  }
  if (!readable || !Trim(text).empty())
  {
    error = std::string("the ") + name + " are not one number for each of the four axes";
    return false;
  }
  return true;
}

/// Where the nodes are if each axis tells it by itself, without a space. "axis mins" are where the
/// first cell begins or, if "centers" says so, the first node; cells are the default, as in ITK.
bool PlaceNrrdAxes(
  const NrrdFields& fields, glm::dmat3& axes, glm::dvec3& origin, std::string& error)
{
  const std::string_view spacings = FindNrrdField(fields, { "spacings" });
  const std::string_view mins = FindNrrdField(fields, { "axis mins", "axismins" });
  const std::string_view maxs = FindNrrdField(fields, { "axis maxs", "axismaxs" });
  std::string_view centers = FindNrrdField(fields, { "centers", "centerings" });
  if (spacings.empty() && mins.empty() && maxs.empty())
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
  glm::dvec3 spacing(1.0);
  glm::dvec3 min(std::numeric_limits<double>::quiet_NaN());
  if (!ReadNrrdAxes(spacings, "spacings", spacing, error) ||
    (!mins.empty() && !ReadNrrdAxes(mins, "axis mins", min, error)))
  {
    return false;
  }
  TakeWord(centers);
  for (int a = 0; a < 3; ++a)
  {
    axes[a] *= spacing[a];
    const bool isNode = ToLower(TakeWord(centers)) == "node";
    origin[a] = std::isfinite(min[a]) ? min[a] + (isNode ? 0.0 : 0.5 * spacing[a]) : 0.0;
  }
  return true;
}

} // namespace

//------------------------------------------------------------------------------
bool LooksLikeNrrd(std::string_view bytes) { return bytes.substr(0, 7) == "NRRD000"; }

//------------------------------------------------------------------------------
bool IsNrrdField(std::string_view name)
{
  static const std::set<std::string_view> names = { "axis maxs", "axis mins", "axismaxs",
    "axismins", "block size", "blocksize", "byte skip", "byteskip", "centerings", "centers",
    "content", "data file", "datafile", "dimension", "encoding", "endian", "kinds", "labels",
    "line skip", "lineskip", "max", "measurement frame", "min", "number", "old max", "old min",
    "oldmax", "oldmin", "sample units", "sampleunits", "sizes", "space", "space dimension",
    "space directions", "space origin", "space units", "spacings", "thicknesses", "type", "units" };
  return names.count(name) != 0;
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
    std::string key = ToLower(Trim(line.substr(0, colon)));
    key = key == "datafile" ? "data file" : key;
    // Refused as by teem and ITK: a "space origin" that is misspelled would be one of zeros.
    if (!IsNrrdField(key))
    {
      error = "the header has a field " + Quote(key) + ", which is none of the format";
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
    { "short", Number::Int16 }, { "int16", Number::Int16 }, { "int16_t", Number::Int16 },
    { "ushort", Number::UInt16 }, { "unsigned short", Number::UInt16 },
    { "uint16", Number::UInt16 }, { "uint16_t", Number::UInt16 }, { "int", Number::Int32 },
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
  for (const char* skip : { "line skip", "lineskip", "byte skip", "byteskip" })
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
