// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldHeader.h"

#include "FFDBinaryNumbers.h"
#include "FFDFieldHeaderChecks.h"
#include "FFDGridIndex.h"
#include "FFDTextNumbers.h"

#include <cmath>
#include <cstdint>

namespace ffd
{
namespace
{

using Number = FieldHeader::Number;

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

} // namespace

//------------------------------------------------------------------------------
std::size_t FieldHeader::GetNumberOfNodes() const { return GridSize(this->Grid.Size); }

//------------------------------------------------------------------------------
std::size_t FieldHeader::GetNumberSize() const { return SizeOf(this->Type); }

//------------------------------------------------------------------------------
std::size_t FieldHeader::GetDataSize() const
{
  return 3 * this->GetNumberOfNodes() * this->GetNumberSize();
}

//------------------------------------------------------------------------------
bool SetFieldGrid(FieldHeader& header, const glm::dmat3& axes, std::string& error)
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

//------------------------------------------------------------------------------
std::string_view WithoutHere(std::string_view name)
{
  return name.substr(0, 2) == "./" ? name.substr(2) : name;
}

//------------------------------------------------------------------------------
bool IsPlainFileName(std::string_view name)
{
  return !name.empty() && name.size() < 256 && name != "." && name != ".." &&
    name.find_first_of(std::string_view("/\\\0", 3)) == std::string_view::npos;
}

//------------------------------------------------------------------------------
bool IsFileList(std::string_view name)
{
  std::string_view rest = name;
  return TakeWord(rest) == "LIST" ||
    (name.find('%') != std::string_view::npos && !Trim(rest).empty());
}

//------------------------------------------------------------------------------
bool ReadFieldSize(const std::vector<double>& numbers, std::size_t first, glm::ivec3& size)
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

//------------------------------------------------------------------------------
bool DecodeField(
  const FieldHeader& header, const unsigned char* data, TransformStep& step, std::string& error)
{
  const std::size_t count = header.GetNumberOfNodes();
  const std::size_t size = header.GetNumberSize();
  step.Type = TransformStep::Kind::Field;
  step.Grid = header.Grid;
  step.Values.resize(count);
  const std::size_t rowLength = static_cast<std::size_t>(header.Grid.Size.x);
  const std::size_t rows = static_cast<std::size_t>(header.Grid.Size.y);
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
    if (header.HoldsPositions)
    {
      const glm::dvec3 index(i % rowLength, i / rowLength % rows, i / rowLength / rows);
      step.Values[i] -= header.Grid.Origin + header.Grid.Direction * (index * header.Grid.Spacing);
    }
  }
  return true;
}

} // namespace ffd
