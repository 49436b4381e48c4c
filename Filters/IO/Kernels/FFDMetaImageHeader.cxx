// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldHeader.h"

#include "FFDFieldHeaderChecks.h"
#include "FFDTextNumbers.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <map>

namespace ffd
{
namespace
{

using Number = FieldHeader::Number;

/// As MetaIO: the first letter tells.
bool ReadBool(std::string_view text, bool& value)
{
  const std::string_view first = text.substr(0, 1);
  value = first == "T" || first == "t" || first == "1";
  return value || first == "F" || first == "f" || first == "0";
}

glm::dmat3 Rows(const std::vector<double>& numbers)
{
  return glm::transpose(glm::dmat3(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4],
    numbers[5], numbers[6], numbers[7], numbers[8]));
}

} // namespace

//------------------------------------------------------------------------------
bool LooksLikeMetaImage(std::string_view bytes)
{
  std::string_view text = bytes.substr(0, LargestFieldHeader);
  const std::string_view line = TakeLine(text);
  const std::string_view key = Trim(line.substr(0, line.find('=')));
  return line.find('=') != std::string_view::npos &&
    (key == "ObjectType" || key == "NDims" || key == "Comment" || key == "ObjectSubType");
}

//------------------------------------------------------------------------------
bool ParseMetaImageHeader(std::string_view bytes, FieldHeader& header, std::string& error)
{
  header = FieldHeader();
  error.clear();
  std::string_view text = bytes.substr(0, LargestFieldHeader);
  std::map<std::string_view, std::string_view> keys;
  bool complete = false;
  while (!text.empty() && !complete)
  {
    const std::string_view line = Trim(TakeLine(text));
    if (line.empty())
    {
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos)
    {
      error = "the line " + Quote(line) + " of the header has no '='";
      return false;
    }
    std::string_view key = Trim(line.substr(0, equals));
    // Older names of the same.
    key = key == "Position" || key == "Origin" ? "Offset" : key;
    key = key == "Rotation" || key == "Orientation" ? "TransformMatrix" : key;
    key = key == "ElementByteOrderMSB" ? "BinaryDataByteOrderMSB" : key;
    const std::string_view value = Trim(line.substr(equals + 1));
    // Some programs write an older name beside the newer one.
    if (key != "Comment" && keys.emplace(key, value).first->second != value)
    {
      error = "there are two lines of " + Quote(key) + " that differ";
      return false;
    }
    complete = key == "ElementDataFile";
  }
  if (!complete)
  {
    error = "there is no line ElementDataFile in the first 64 kB";
    return false;
  }
  const auto value = [&keys](std::string_view key, std::string_view otherwise) {
    const auto found = keys.find(key);
    return found == keys.end() ? otherwise : found->second;
  };
  if (value("ObjectType", "Image") != "Image" || value("NDims", "3") != "3" ||
    value("ElementNumberOfChannels", "1") != "3")
  {
    error = "it is no 3-D image with 3 channels (ObjectType, NDims, ElementNumberOfChannels)";
    return false;
  }
  if (value("HeaderSize", "0") != "0")
  {
    error = "HeaderSize is not supported";
    return false;
  }
  bool binary = true;
  if (!ReadBool(value("BinaryData", "True"), binary) || !binary)
  {
    error = "the data are text; only BinaryData = True is supported";
    return false;
  }
  if (!ReadBool(value("BinaryDataByteOrderMSB", "False"), header.BigEndian) ||
    !ReadBool(value("CompressedData", "False"), header.Compressed))
  {
    error = "BinaryDataByteOrderMSB or CompressedData is neither True nor False";
    return false;
  }
  static const std::map<std::string_view, Number> types = { { "MET_CHAR", Number::Int8 },
    { "MET_UCHAR", Number::UInt8 }, { "MET_SHORT", Number::Int16 },
    { "MET_USHORT", Number::UInt16 }, { "MET_INT", Number::Int32 }, { "MET_UINT", Number::UInt32 },
    { "MET_FLOAT", Number::Float32 }, { "MET_DOUBLE", Number::Float64 } };
  const auto type = types.find(value("ElementType", ""));
  if (type == types.end())
  {
    error =
      "ElementType is " + Quote(value("ElementType", "")) + ", not a scalar type that is known";
    return false;
  }
  header.Type = type->second;

  std::vector<double> size;
  std::vector<double> offset;
  std::vector<double> spacing;
  std::vector<double> matrix;
  if (!ReadNumbers(value("DimSize", ""), "DimSize", size, error) ||
    !ReadNumbers(value("Offset", "0 0 0"), "Offset", offset, error) ||
    !ReadNumbers(
      value("ElementSpacing", value("ElementSize", "1 1 1")), "ElementSpacing", spacing, error) ||
    !ReadNumbers(value("TransformMatrix", "1 0 0 0 1 0 0 0 1"), "TransformMatrix", matrix, error) ||
    !HasCount(size, 3, "DimSize", error) || !HasCount(offset, 3, "Offset", error) ||
    !HasCount(spacing, 3, "ElementSpacing", error) ||
    !HasCount(matrix, 9, "TransformMatrix", error))
  {
    return false;
  }
  if (!ReadFieldSize(size, 0, header.Grid.Size))
  {
    error = "DimSize holds no positive integers";
    return false;
  }
  header.Grid.Origin = { offset[0], offset[1], offset[2] };
  // Row a of the matrix is the direction of axis a.
  glm::dmat3 axes = glm::transpose(Rows(matrix));
  for (int a = 0; a < 3; ++a)
  {
    if (!(spacing[static_cast<std::size_t>(a)] > 0.0))
    {
      error = "ElementSpacing is not positive";
      return false;
    }
    axes[a] *= spacing[static_cast<std::size_t>(a)];
  }
  const std::string_view file = WithoutHere(value("ElementDataFile", ""));
  if (IsLocalData(file))
  {
    header.Offset = static_cast<std::size_t>(text.data() - bytes.data());
  }
  else if (IsFileList(file) || !IsPlainFileName(file))
  {
    error = "ElementDataFile is " + Quote(file) + ", not LOCAL or one file in the same folder";
    return false;
  }
  else
  {
    header.DataFile = std::string(file);
  }
  return SetFieldGrid(header, axes, error);
}

//------------------------------------------------------------------------------
bool IsLocalData(std::string_view name)
{
  return name == "LOCAL" || name == "Local" || name == "local";
}

//------------------------------------------------------------------------------
bool CanNameDataFile(std::string_view name)
{
  const bool printable = std::none_of(name.begin(), name.end(),
    [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '%'; });
  // MetaIO takes all that begins with LIST for a list of files.
  return IsPlainFileName(name) && printable && Trim(name) == name && name.substr(0, 4) != "LIST" &&
    !IsLocalData(name);
}

//------------------------------------------------------------------------------
std::string FormatMetaImageHeader(const TransformGrid& grid, const std::string& dataFile)
{
  std::string text = "ObjectType = Image\nNDims = 3\nBinaryData = True\n"
                     "BinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix =";
  const auto vector = [&text](const glm::dvec3& v) {
    for (int a = 0; a < 3; ++a)
    {
      text += ' ';
      AppendNumber(text, v[a]);
    }
  };
  for (int a = 0; a < 3; ++a)
  {
    vector(grid.Direction[a]);
  }
  text += "\nOffset =";
  vector(grid.Origin);
  text += "\nElementSpacing =";
  vector(grid.Spacing);
  text += "\nDimSize =";
  for (int a = 0; a < 3; ++a)
  {
    text += ' ' + std::to_string(grid.Size[a]);
  }
  return text + "\nElementNumberOfChannels = 3\nElementType = MET_DOUBLE\nElementDataFile = " +
    (dataFile.empty() ? std::string("LOCAL") : dataFile) + "\n";
}

} // namespace ffd
