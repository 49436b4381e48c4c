// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeFile.h"

#include "FFDBinaryNumbers.h"
#include "FFDTextNumbers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace ffd
{
namespace
{

using Attributes = std::map<std::string_view, std::string_view>;

/// The name and the attributes of a tag; false when it is not well formed.
bool ReadTag(std::string_view tag, std::string_view& name, Attributes& attributes)
{
  attributes.clear();
  name = TakeWord(tag);
  for (tag = Trim(tag); !tag.empty(); tag = Trim(tag))
  {
    const std::size_t equals = tag.find('=');
    if (equals == std::string_view::npos)
    {
      return false;
    }
    const std::string_view key = Trim(tag.substr(0, equals));
    tag = Trim(tag.substr(equals + 1));
    const std::size_t end = tag.empty() || (tag[0] != '"' && tag[0] != '\'')
      ? std::string_view::npos
      : tag.find(tag[0], 1);
    if (end == std::string_view::npos || !attributes.emplace(key, tag.substr(1, end - 1)).second)
    {
      return false;
    }
    tag.remove_prefix(end + 1);
  }
  return true;
}

std::string_view Get(const Attributes& attributes, std::string_view key)
{
  const auto found = attributes.find(key);
  return found == attributes.end() ? std::string_view() : found->second;
}

bool IsOneOf(std::string_view word, std::initializer_list<std::string_view> words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// A whole number within limits, or no attribute of that name.
bool IsIntegerOrMissing(
  const Attributes& attributes, std::string_view key, double smallest, double largest)
{
  const auto found = attributes.find(key);
  double value = smallest;
  return found == attributes.end() ||
    (found->second.find_first_not_of("-0123456789") == std::string_view::npos &&
      ReadNumber(found->second, value) && value >= smallest && value <= largest);
}

/// Attributes of an array; empty, or what is wrong.
std::string FindArrayProblem(const Attributes& attributes, double fileSize)
{
  if (!IsOneOf(Get(attributes, "type"),
        { "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float32",
          "Float64" }))
  {
    return "an array has the type " + Quote(Get(attributes, "type"));
  }
  if (!IsOneOf(Get(attributes, "format"), { "ascii", "binary", "appended" }) ||
    (Get(attributes, "format") == "appended") != (attributes.count("offset") != 0))
  {
    return "an array has the format " + Quote(Get(attributes, "format"));
  }
  if (!IsIntegerOrMissing(attributes, "NumberOfComponents", 1.0, 9.0) ||
    !IsIntegerOrMissing(attributes, "NumberOfTuples", 0.0, fileSize) ||
    !IsIntegerOrMissing(attributes, "offset", 0.0, fileSize))
  {
    return "the NumberOfComponents, NumberOfTuples or offset of an array is out of range";
  }
  return std::string();
}

/// Offset and expected number of the bytes of an array.
struct LatticeFileArray
{
  std::string_view Data; // from the start of the array to the end of the file
  std::size_t Size = 0;  // bytes, decompressed
  bool Ascii = false;
  bool Base64 = true;
};

/// The first bytes of a base64 text, as many as there are up to `count`.
std::vector<unsigned char> DecodeFirst(
  std::string_view text, std::size_t count, Base64Decoder decode)
{
  std::vector<unsigned char> bytes(count);
  const std::size_t length = std::min(text.size(), (count + 2) / 3 * 4);
  bytes.resize(decode(
    reinterpret_cast<const unsigned char*>(text.data()), length, bytes.data(), bytes.size()));
  return bytes;
}

/// The block sizes that a compressed array begins with, which VTK's reader trusts.
std::string FindBlockProblem(const LatticeFileArray& array, bool compressed, std::size_t word,
  bool bigEndian, Base64Decoder decode)
{
  const auto read = [&](std::size_t words, std::vector<std::uint64_t>& values) {
    std::vector<unsigned char> bytes = array.Base64
      ? DecodeFirst(array.Data, words * word, decode)
      : std::vector<unsigned char>(array.Data.begin(),
          array.Data.begin() +
            static_cast<std::ptrdiff_t>(std::min(array.Data.size(), words * word)));
    values.clear();
    for (std::size_t i = 0; (i + 1) * word <= bytes.size(); ++i)
    {
      values.push_back(LoadBits(bytes.data() + i * word, word, bigEndian));
    }
    return values.size() == words;
  };
  const std::string problem = "the sizes of the data of an array do not fit it";
  std::vector<std::uint64_t> sizes;
  if (array.Ascii)
  {
    return std::string();
  }
  if (!compressed)
  {
    return read(1, sizes) && sizes[0] == array.Size ? std::string() : problem;
  }
  if (!read(1, sizes) || sizes[0] > array.Data.size() || !read(3 + sizes[0], sizes))
  {
    return problem;
  }
  const std::uint64_t blocks = sizes[0];
  const std::uint64_t size = sizes[1];
  const std::uint64_t last = sizes[2];
  const std::uint64_t whole = blocks - (last != 0 && blocks > 0 ? 1 : 0);
  // A block is allocated whole, even when the array is shorter.
  constexpr std::uint64_t largestBlock = std::uint64_t(1) << 26;
  if (size > largestBlock || last > size || whole * size + last != array.Size)
  {
    return problem;
  }
  std::uint64_t stored = 0;
  for (std::size_t i = 3; i < sizes.size(); ++i)
  {
    stored += std::min<std::uint64_t>(sizes[i], array.Data.size() + 1);
  }
  return stored <= array.Data.size() ? std::string() : problem;
}

std::size_t SizeOfVTKType(std::string_view type)
{
  const std::size_t digit = type.find_first_of("1368");
  const std::string_view bits = type.substr(std::min(digit, type.size()));
  return bits == "8" ? 1 : bits == "16" ? 2 : bits == "32" ? 4 : 8;
}

/// Attributes of any element; empty, or what is wrong. `extent` is that of the image.
std::string FindElementProblem(
  std::string_view name, const Attributes& attributes, double fileSize, std::string_view& extent)
{
  if (!IsOneOf(name,
        { "VTKFile", "ImageData", "Piece", "PointData", "CellData", "FieldData", "DataArray",
          "InformationKey", "Value", "AppendedData" }))
  {
    return "the element " + Quote(name) + " is not expected";
  }
  if (name == "DataArray")
  {
    return FindArrayProblem(attributes, fileSize);
  }
  if (name == "VTKFile" &&
    (Get(attributes, "type") != "ImageData" ||
      !IsOneOf(Get(attributes, "version"), { "0.1", "1.0", "2.0", "2.1", "2.2" }) ||
      !IsOneOf(Get(attributes, "byte_order"), { "LittleEndian", "BigEndian" }) ||
      !IsOneOf(Get(attributes, "header_type"), { "", "UInt32", "UInt64" }) ||
      !IsOneOf(Get(attributes, "compressor"),
        { "", "vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor" })))
  {
    return "its type, version, byte_order, header_type or compressor is not supported";
  }
  if (name == "AppendedData" && !IsOneOf(Get(attributes, "encoding"), { "raw", "base64" }))
  {
    return "the encoding of its data is " + Quote(Get(attributes, "encoding"));
  }
  if (name == "ImageData")
  {
    std::vector<double> numbers;
    std::string error;
    extent = Get(attributes, "WholeExtent");
    bool usable = ReadNumbers(extent, "extent", numbers, error) && numbers.size() == 6;
    for (std::size_t a = 0; a < 3 && usable; ++a)
    {
      const double n = numbers[2 * a + 1] - numbers[2 * a] + 1.0;
      usable = n >= 4.0 && n <= 1024.0 && std::abs(numbers[2 * a]) <= 1e9 && n == std::floor(n) &&
        numbers[2 * a] == std::floor(numbers[2 * a]);
    }
    if (!usable)
    {
      return "its extent " + Quote(extent) + " is not one of 4 to 1024 control points per axis";
    }
  }
  if (name == "Piece" && (extent.empty() || Get(attributes, "Extent") != extent))
  {
    return "it is not one piece";
  }
  return std::string();
}

} // namespace

//------------------------------------------------------------------------------
std::string FindLatticeFileProblem(std::string_view bytes, Base64Decoder decode)
{
  constexpr int largestDepth = 8;
  const double fileSize = static_cast<double>(bytes.size());
  std::string_view extent;
  std::vector<std::string_view> open;
  bool image = false;
  bool piece = false;
  Attributes file;
  struct Waiting
  {
    LatticeFileArray Array;
    std::size_t Offset = 0; // in the appended data
  };
  std::vector<Waiting> waiting;
  while (true)
  {
    const std::size_t begin = bytes.find('<');
    const std::size_t end = begin == std::string_view::npos ? begin : bytes.find('>', begin);
    if (end == std::string_view::npos)
    {
      return "it ends in the middle";
    }
    std::string_view tag = bytes.substr(begin + 1, end - begin - 1);
    bytes.remove_prefix(end + 1);
    if (!tag.empty() && (tag[0] == '?' || tag[0] == '!'))
    {
      if (!open.empty())
      {
        return "there is a declaration inside of it";
      }
      continue;
    }
    if (!tag.empty() && tag[0] == '/')
    {
      if (open.empty() || Trim(tag.substr(1)) != open.back())
      {
        return "the end of " + Quote(tag.substr(1)) + " is not expected";
      }
      open.pop_back();
      if (open.empty())
      {
        break;
      }
      continue;
    }
    const bool whole = !tag.empty() && tag.back() == '/';
    tag.remove_suffix(whole ? 1 : 0);
    std::string_view name;
    Attributes attributes;
    if (!ReadTag(tag, name, attributes))
    {
      return "the tag " + Quote(tag) + " is not well formed";
    }
    const std::string problem = FindElementProblem(name, attributes, fileSize, extent);
    if (!problem.empty())
    {
      return problem;
    }
    if ((name == "ImageData" && image) || (name == "Piece" && piece) ||
      open.size() >= largestDepth || open.empty() != (name == "VTKFile"))
    {
      return "the element " + Quote(name) + " is not expected there";
    }
    if (name == "VTKFile")
    {
      file = attributes;
    }
    if (name == "DataArray")
    {
      // Tuples of field data have an attribute; those of points and cells follow from the extent.
      std::vector<double> numbers;
      std::string error;
      double tuples = 1.0;
      const bool cells = open.back() == "CellData";
      ReadNumbers(extent, "extent", numbers, error);
      for (std::size_t axis = 0; axis < 3 && numbers.size() == 6; ++axis)
      {
        tuples *= numbers[2 * axis + 1] - numbers[2 * axis] + (cells ? 0.0 : 1.0);
      }
      double components = 1.0;
      ReadNumber(Get(attributes, "NumberOfComponents"), components);
      if (open.back() == "FieldData" && !ReadNumber(Get(attributes, "NumberOfTuples"), tuples))
      {
        return "a field-data array has no NumberOfTuples";
      }
      Waiting array;
      array.Array.Size =
        static_cast<std::size_t>(tuples * components) * SizeOfVTKType(Get(attributes, "type"));
      array.Array.Ascii = Get(attributes, "format") == "ascii";
      double offset = 0.0;
      if (ReadNumber(Get(attributes, "offset"), offset))
      {
        array.Offset = static_cast<std::size_t>(offset);
      }
      else
      {
        // Behind the names of the array's range, if any.
        std::size_t start = 0;
        while (start < bytes.size() && (bytes[start] == ' ' || bytes[start] == '\n'))
        {
          ++start;
        }
        array.Array.Data = bytes.substr(start);
      }
      waiting.push_back(array);
    }
    image = image || name == "ImageData";
    piece = piece || name == "Piece";
    if (name == "AppendedData")
    {
      // No XML from here on.
      const std::size_t start = bytes.find('_');
      const std::string_view data =
        bytes.substr(start == std::string_view::npos ? bytes.size() : start + 1);
      for (Waiting& array : waiting)
      {
        if (array.Array.Data.data() == nullptr && !array.Array.Ascii)
        {
          array.Array.Data = data.substr(std::min(array.Offset, data.size()));
          array.Array.Base64 = Get(attributes, "encoding") == "base64";
        }
      }
      break;
    }
    if (!whole)
    {
      open.push_back(name);
    }
  }
  if (!image || !piece)
  {
    return "there is no image in it";
  }
  const bool compressed = !Get(file, "compressor").empty();
  const std::size_t word = Get(file, "header_type") == "UInt64" ? 8 : 4;
  for (const Waiting& array : waiting)
  {
    const std::string problem = FindBlockProblem(
      array.Array, compressed, word, Get(file, "byte_order") == "BigEndian", decode);
    if (!problem.empty())
    {
      return problem;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::size_t FindLargestLatticeFile(std::string_view head)
{
  // Point data as text, two more arrays like them, and all else.
  constexpr double bytesPerPoint = 300.0;
  constexpr double overhead = 1048576.0;
  const std::size_t tag = head.find("<ImageData");
  if (tag == std::string_view::npos)
  {
    return static_cast<std::size_t>(overhead);
  }
  std::string_view name;
  Attributes attributes;
  std::vector<double> numbers;
  std::string error;
  double points = 1.0;
  if (!ReadTag(head.substr(tag + 1, head.find('>', tag) - tag - 1), name, attributes) ||
    !ReadNumbers(Get(attributes, "WholeExtent"), "extent", numbers, error) || numbers.size() != 6)
  {
    return static_cast<std::size_t>(overhead);
  }
  for (std::size_t a = 0; a < 3; ++a)
  {
    points *= std::min(std::max(numbers[2 * a + 1] - numbers[2 * a] + 1.0, 1.0), 1024.0);
  }
  return static_cast<std::size_t>(overhead + bytesPerPoint * points);
}

} // namespace ffd
