// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// MATLAB's level 4 format, of which ITK uses columns of float or double.
#include "FFDItkTransform.h"

#include "FFDBinaryNumbers.h"

namespace ffd
{
namespace
{

constexpr std::size_t HeaderSize = 20;
constexpr std::uint64_t LongestName = 256;

/// The type field MOPT of a matrix: byte order, reserved, precision, kind of matrix.
struct MatrixType
{
  bool Known = false;
  bool BigEndian = false;
  std::size_t NumberSize = 8;
};

/**
 * Double or float, not complex, not text, not sparse. ITK (vnl) adds 100 to the type of a matrix
 * that is stored row by row, which is the same for a column.
 */
MatrixType ReadMatrixType(std::string_view bytes)
{
  MatrixType type;
  for (const bool big : { false, true })
  {
    const std::uint64_t bits = LoadBits(BytesAt(bytes, 0), 4, big);
    const std::uint64_t digits = bits % 1000;
    if (bits == digits + (big ? 1000 : 0) &&
      (digits == 0 || digits == 10 || digits == 100 || digits == 110))
    {
      type.Known = true;
      type.BigEndian = big;
      type.NumberSize = digits % 100 == 10 ? 4 : 8;
      return type;
    }
  }
  return type;
}

/// The next column of numbers, and its name.
bool TakeColumn(
  std::string_view& bytes, std::string_view& name, std::vector<double>& values, std::string& error)
{
  const MatrixType type = bytes.size() >= HeaderSize ? ReadMatrixType(bytes) : MatrixType();
  if (!type.Known)
  {
    error = bytes.size() >= HeaderSize
      ? "a matrix is not one of float or double numbers of MATLAB level 4"
      : "the file ends in the middle";
    return false;
  }
  const auto word = [&](
                      std::size_t i) { return LoadBits(BytesAt(bytes, 4 * i), 4, type.BigEndian); };
  const std::uint64_t rows = word(1);
  const std::uint64_t columns = word(2);
  const std::uint64_t nameSize = word(4);
  if (columns != 1 || word(3) != 0 || nameSize == 0 || nameSize > LongestName)
  {
    error = "a matrix is not one column of real numbers with a name";
    return false;
  }
  bytes.remove_prefix(HeaderSize);
  // Both fit 64 bits: 2^32 rows of 8 bytes.
  if (nameSize + rows * type.NumberSize > bytes.size())
  {
    error = "the file ends in the middle";
    return false;
  }
  name = bytes.substr(0, static_cast<std::size_t>(nameSize));
  name = name.substr(0, name.find('\0'));
  bytes.remove_prefix(static_cast<std::size_t>(nameSize));
  values.resize(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = type.NumberSize == 4 ? LoadFloat(BytesAt(bytes, 4 * i), type.BigEndian)
                                     : LoadDouble(BytesAt(bytes, 8 * i), type.BigEndian);
  }
  bytes.remove_prefix(values.size() * type.NumberSize);
  return true;
}

} // namespace

//------------------------------------------------------------------------------
bool LooksLikeMatlabTransform(std::string_view bytes)
{
  constexpr std::string_view transform = "Transform";
  return bytes.size() > HeaderSize && ReadMatrixType(bytes).Known &&
    bytes.substr(HeaderSize, LongestName).find(transform) != std::string_view::npos;
}

//------------------------------------------------------------------------------
bool ParseMatlabTransform(std::string_view bytes, TransformStep& step, std::string& error)
{
  error.clear();
  std::string_view type;
  std::string_view fixedName;
  std::vector<double> parameters;
  std::vector<double> fixed;
  if (!TakeColumn(bytes, type, parameters, error) || !TakeColumn(bytes, fixedName, fixed, error))
  {
    return false;
  }
  if (IsItkComposite(type))
  {
    error = "it is a CompositeTransform, of which this format keeps only a part. Write it as .tfm "
            "or .h5";
    return false;
  }
  if (!bytes.empty())
  {
    error = "there are several transforms, and nothing that says how they go together";
    return false;
  }
  return MakeItkStep(type, parameters, fixed, step, error);
}

} // namespace ffd
