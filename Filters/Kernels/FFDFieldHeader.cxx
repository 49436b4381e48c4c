// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldHeader.h"

#include "FFDBinaryNumbers.h"
#include "FFDTextNumbers.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

namespace ffd
{
namespace
{

using Number = FieldHeader::Number;

constexpr std::size_t NiftiHeaderSize = 348;
constexpr std::size_t NiftiDataOffset = 352;
constexpr int NiftiVectorIntent = 1007;
constexpr int NiftiFloat64 = 64;
constexpr int NiftiDisplacementIntent = 1006;
constexpr int NiftiMetres = 1;
constexpr int NiftiMillimetres = 2;
constexpr int NiftiMicrons = 3;
constexpr int NiftiSpaceUnits = 7; // bits of xyzt_units

std::size_t SizeOf(Number type)
{
  switch (type)
  {
    case Number::Int8:
    case Number::UInt8:
      return 1;
    case Number::Int16:
    case Number::UInt16:
      return 2;
    case Number::Float64:
      return 8;
    default:
      return 4;
  }
}

/// Common checks, and axes as columns that carry the spacing, to directions and spacings.
bool SetGrid(FieldHeader& header, const glm::dmat3& axes, std::string& error)
{
  TransformGrid& grid = header.Grid;
  for (int a = 0; a < 3; ++a)
  {
    const glm::dvec3& axis = axes[a];
    grid.Spacing[a] = std::sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
    grid.Direction[a] = axis / (grid.Spacing[a] > 0.0 ? grid.Spacing[a] : 1.0);
  }
  error = FindGridProblem(grid, 1);
  if (error.empty() && header.GetNumberOfNodes() > LargestField)
  {
    error = "the field has more than 2^27 voxels";
  }
  return error.empty();
}

/// A file in the same folder, no path: a header from elsewhere shall not open what it likes.
bool IsPlainFileName(std::string_view name)
{
  return !name.empty() && name.size() < 256 && name != "." && name != ".." &&
    name.find_first_of(std::string_view("/\\\0", 3)) == std::string_view::npos;
}

/// What MetaImage and NRRD headers name several files by: LIST, or a printf pattern and its range.
bool IsFileList(std::string_view name)
{
  std::string_view rest = name;
  return TakeWord(rest) == "LIST" ||
    (name.find('%') != std::string_view::npos && !Trim(rest).empty());
}

bool ReadBool(std::string_view text, bool& value)
{
  value = text == "True" || text == "true" || text == "1";
  return value || text == "False" || text == "false" || text == "0";
}

/// Exactly three whole numbers from 1 on.
bool ReadSize(const std::vector<double>& numbers, std::size_t first, glm::ivec3& size)
{
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double n = numbers[first + a];
    if (!(n >= 1.0 && n <= 1e9) || n != std::floor(n))
    {
      return false;
    }
    size[static_cast<int>(a)] = static_cast<int>(n);
  }
  return true;
}

double LoadNumber(const unsigned char* bytes, Number type, bool bigEndian)
{
  const std::uint64_t bits = LoadBits(bytes, SizeOf(type), bigEndian);
  switch (type)
  {
    case Number::Int8:
      return static_cast<std::int8_t>(bits);
    case Number::UInt8:
    case Number::UInt16:
    case Number::UInt32:
      return static_cast<double>(bits);
    case Number::Int16:
      return static_cast<std::int16_t>(bits);
    case Number::Int32:
      return static_cast<std::int32_t>(bits);
    case Number::Float32:
      return LoadFloat(bytes, bigEndian);
    case Number::Float64:
      return LoadDouble(bytes, bigEndian);
  }
  return 0.0;
}

glm::dmat3 Rows(const std::vector<double>& numbers)
{
  return glm::transpose(glm::dmat3(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4],
    numbers[5], numbers[6], numbers[7], numbers[8]));
}

} // namespace

//------------------------------------------------------------------------------
std::size_t FieldHeader::GetNumberOfNodes() const
{
  return static_cast<std::size_t>(this->Grid.Size.x) * static_cast<std::size_t>(this->Grid.Size.y) *
    static_cast<std::size_t>(this->Grid.Size.z);
}

//------------------------------------------------------------------------------
std::size_t FieldHeader::GetNumberSize() const { return SizeOf(this->Type); }

//------------------------------------------------------------------------------
std::size_t FieldHeader::GetDataSize() const
{
  return 3 * this->GetNumberOfNodes() * this->GetNumberSize();
}

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
    if (!keys.emplace(key, Trim(line.substr(equals + 1))).second)
    {
      error = "there are two lines of " + Quote(key);
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
  if (keys.count("HeaderSize") != 0)
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
  if (!ReadSize(size, 0, header.Grid.Size))
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
  const std::string_view file = value("ElementDataFile", "");
  if (file == "LOCAL" || file == "Local" || file == "local")
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
  return SetGrid(header, axes, error);
}

//------------------------------------------------------------------------------
bool LooksLikeNrrd(std::string_view bytes) { return bytes.substr(0, 7) == "NRRD000"; }

//------------------------------------------------------------------------------
namespace
{

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

} // namespace

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
  std::map<std::string_view, std::string_view> fields;
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
    std::string_view key = Trim(line.substr(0, colon));
    key = key == "datafile" ? "data file" : key;
    if (!fields.emplace(key, Trim(line.substr(colon + 1))).second)
    {
      error = "there are two lines of " + Quote(key);
      return false;
    }
  }
  const auto value = [&fields](std::string_view key, std::string_view otherwise) {
    const auto found = fields.find(key);
    return found == fields.end() ? otherwise : found->second;
  };
  const std::string_view file = value("data file", "");
  if (!complete && file.empty())
  {
    error = "the header does not end with an empty line in the first 64 kB";
    return false;
  }
  std::vector<double> sizes;
  if (value("dimension", "") != "4" || !ReadNumbers(value("sizes", ""), "sizes", sizes, error) ||
    sizes.size() != 4 || sizes[0] != 3.0 || !ReadSize(sizes, 1, header.Grid.Size))
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
  const auto type = types.find(value("type", ""));
  if (type == types.end())
  {
    error = "the type is " + Quote(value("type", "")) + ", which is not supported";
    return false;
  }
  header.Type = type->second;
  const std::string_view encoding = value("encoding", "");
  header.Compressed = encoding == "gzip" || encoding == "gz";
  if (!header.Compressed && encoding != "raw")
  {
    error = "the encoding is " + Quote(encoding) + ", not raw or gzip";
    return false;
  }
  const std::string_view endian = value("endian", header.GetNumberSize() == 1 ? "little" : "");
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

  const std::string_view space = value("space", "left-posterior-superior");
  const bool ras = space == "right-anterior-superior" || space == "RAS";
  if (!ras && space != "left-posterior-superior" && space != "LPS")
  {
    error =
      "the space is " + Quote(space) + ", not left-posterior-superior or right-anterior-superior";
    return false;
  }
  std::string_view directions = value("space directions", "none (1,0,0) (0,1,0) (0,0,1)");
  glm::dmat3 axes(1.0);
  bool readable = TakeWord(directions) == "none";
  for (int a = 0; a < 3; ++a)
  {
    const std::size_t end = directions.find(')');
    readable = readable && end != std::string_view::npos &&
      ReadNrrdVector(directions.substr(0, end + 1), axes[a]);
    directions.remove_prefix(readable ? end + 1 : 0);
  }
  if (!readable || !Trim(directions).empty() ||
    !ReadNrrdVector(value("space origin", "(0,0,0)"), header.Grid.Origin))
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
  return SetGrid(header, axes, error);
}

//------------------------------------------------------------------------------
bool LooksLikeNifti(std::string_view bytes)
{
  return bytes.size() >= NiftiHeaderSize && bytes.substr(344, 4) == std::string_view("n+1\0", 4);
}

//------------------------------------------------------------------------------
bool ParseNiftiHeader(std::string_view bytes, FieldHeader& header, std::string& error)
{
  header = FieldHeader();
  error.clear();
  if (!LooksLikeNifti(bytes))
  {
    error = "it has not the header of a single NIfTI-1 file (.nii)";
    return false;
  }
  header.BigEndian = LoadBits(BytesAt(bytes, 0), 4, false) != NiftiHeaderSize;
  const bool big = header.BigEndian;
  if (LoadBits(BytesAt(bytes, 0), 4, big) != NiftiHeaderSize)
  {
    error = "the size of the header is not 348 in either byte order";
    return false;
  }
  const auto integer = [&](std::size_t offset) {
    return static_cast<int>(static_cast<std::int16_t>(LoadBits(BytesAt(bytes, offset), 2, big)));
  };
  const auto real = [&](std::size_t offset) { return LoadFloat(BytesAt(bytes, offset), big); };

  int dim[8];
  for (std::size_t i = 0; i < 8; ++i)
  {
    dim[i] = integer(40 + 2 * i);
  }
  if (dim[0] != 5 || dim[4] != 1 || dim[5] != 3)
  {
    error = "it is no field of 3 vectors components (dim must be 5, nx, ny, nz, 1, 3)";
    return false;
  }
  header.Planar = true;
  header.Grid.Size = { dim[1], dim[2], dim[3] };
  for (int a = 0; a < 3; ++a)
  {
    if (header.Grid.Size[a] < 1)
    {
      error = "a dimension is " + std::to_string(header.Grid.Size[a]);
      return false;
    }
  }
  static const std::map<int, Number> types = { { 2, Number::UInt8 }, { 4, Number::Int16 },
    { 8, Number::Int32 }, { 16, Number::Float32 }, { NiftiFloat64, Number::Float64 },
    { 256, Number::Int8 }, { 512, Number::UInt16 }, { 768, Number::UInt32 } };
  const auto type = types.find(integer(70));
  if (type == types.end())
  {
    error = "the datatype " + std::to_string(integer(70)) + " is not supported";
    return false;
  }
  header.Type = type->second;
  const double offset = real(108);
  if (!(offset >= static_cast<double>(NiftiHeaderSize) &&
        offset <= static_cast<double>(LargestFieldHeader)) ||
    offset != std::floor(offset))
  {
    error = "the data begin at no sensible place (vox_offset)";
    return false;
  }
  header.Offset = static_cast<std::size_t>(offset);
  header.Slope = real(112);
  header.Intercept = real(116);
  if (!std::isfinite(header.Slope) || !std::isfinite(header.Intercept))
  {
    error = "the scaling (scl_slope, scl_inter) is not finite";
    return false;
  }
  if (header.Slope == 0.0)
  {
    header.Slope = 1.0; // no scaling
    header.Intercept = 0.0;
  }

  glm::dmat3 axes(1.0);
  glm::dvec3& origin = header.Grid.Origin;
  double pixel[4];
  for (std::size_t i = 0; i < 4; ++i)
  {
    pixel[i] = real(76 + 4 * i);
  }
  bool finite = true;
  if (integer(254) > 0) // sform
  {
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 4; ++column)
      {
        const double entry =
          real(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(column));
        finite = finite && std::isfinite(entry);
        (column < 3 ? axes[column] : origin)[row] = entry;
      }
    }
  }
  else
  {
    for (int a = 0; a < 3; ++a)
    {
      finite = finite && std::isfinite(pixel[a + 1]);
    }
    if (integer(252) > 0) // qform: a quaternion, and a sign that mirrors z
    {
      const double b = real(256);
      const double c = real(260);
      const double d = real(264);
      origin = { real(268), real(272), real(276) };
      const double square = b * b + c * c + d * d;
      if (!(square <= 1.0 + 1e-5))
      {
        error = "the quaternion of the qform is longer than 1";
        return false;
      }
      const double a = std::sqrt(std::max(0.0, 1.0 - square));
      axes = glm::transpose(
        glm::dmat3(a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d), 2.0 * (b * d + a * c),
          2.0 * (b * c + a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d - a * b),
          2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a + d * d - c * c - b * b));
      axes[2] *= pixel[0] < 0.0 ? -1.0 : 1.0;
      finite =
        finite && std::isfinite(origin.x) && std::isfinite(origin.y) && std::isfinite(origin.z);
    }
    for (int a = 0; a < 3; ++a)
    {
      axes[a] *= std::abs(pixel[a + 1]);
    }
  }
  if (!finite)
  {
    error = "the sform, qform or pixel sizes are not finite";
    return false;
  }
  // RAS in the file's units of length to LPS in millimetres.
  const int units = static_cast<unsigned char>(bytes[123]) & NiftiSpaceUnits;
  const double length = units == NiftiMetres ? 1e3 : units == NiftiMicrons ? 1e-3 : 1.0;
  const glm::dvec3 flip(-length, -length, length);
  origin *= flip;
  for (int a = 0; a < 3; ++a)
  {
    axes[a] *= flip;
  }
  header.VectorsInRas = integer(68) == NiftiDisplacementIntent;
  return SetGrid(header, axes, error);
}

//------------------------------------------------------------------------------
bool DecodeField(
  const FieldHeader& header, const unsigned char* data, TransformStep& step, std::string& error)
{
  const std::size_t count = header.GetNumberOfNodes();
  const std::size_t size = header.GetNumberSize();
  step.Type = TransformStep::Kind::Field;
  step.Grid = header.Grid;
  step.Values.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    for (std::size_t a = 0; a < 3; ++a)
    {
      const std::size_t index = header.Planar ? a * count + i : 3 * i + a;
      const double value =
        header.Slope * LoadNumber(data + index * size, header.Type, header.BigEndian) +
        header.Intercept;
      if (!(std::abs(value) <= LargestNumber))
      {
        error = "the displacement of voxel " + std::to_string(i) +
          " is not a finite number of at most 1e12";
        step.Values.clear();
        return false;
      }
      step.Values[i][static_cast<int>(a)] = header.VectorsInRas && a < 2 ? -value : value;
    }
  }
  return true;
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

//------------------------------------------------------------------------------
bool CanNameDataFile(std::string_view name)
{
  const bool printable = std::none_of(name.begin(), name.end(),
    [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '%'; });
  // MetaIO takes all that begins with LIST for a list of files.
  return IsPlainFileName(name) && printable && Trim(name) == name && name.substr(0, 4) != "LIST" &&
    name != "LOCAL" && name != "Local" && name != "local";
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

//------------------------------------------------------------------------------
std::string FormatNiftiHeader(const TransformGrid& grid)
{
  std::string bytes(NiftiDataOffset, '\0');
  const auto store = [&bytes](std::size_t offset, std::uint32_t bits, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
    {
      bytes[offset + i] = static_cast<char>((bits >> (8 * i)) & 255u);
    }
  };
  const auto integer = [&store](std::size_t offset, int value) {
    store(offset, static_cast<std::uint32_t>(value), 2);
  };
  const auto real = [&store](std::size_t offset, double value) {
    const float narrow = static_cast<float>(value);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &narrow, sizeof(bits));
    store(offset, bits, 4);
  };
  store(0, NiftiHeaderSize, 4);
  const int dim[8] = { 5, grid.Size.x, grid.Size.y, grid.Size.z, 1, 3, 1, 1 };
  for (std::size_t i = 0; i < 8; ++i)
  {
    integer(40 + 2 * i, dim[i]);
    real(76 + 4 * i, i >= 1 && i <= 3 ? grid.Spacing[static_cast<int>(i) - 1] : 1.0);
  }
  integer(68, NiftiVectorIntent);
  integer(70, NiftiFloat64);
  integer(72, 64);
  real(108, static_cast<double>(NiftiDataOffset));
  real(112, 1.0);
  bytes[123] = NiftiMillimetres;
  integer(254, 1); // sform: scanner coordinates, RAS
  const glm::dvec3 flip(-1.0, -1.0, 1.0);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      const double entry =
        column < 3 ? grid.Direction[column][row] * grid.Spacing[column] : grid.Origin[row];
      real(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(column),
        entry * flip[row]);
    }
  }
  bytes.replace(344, 4, std::string("n+1\0", 4));
  return bytes;
}

} // namespace ffd
