// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldHeader.h"

#include "FFDBinaryNumbers.h"
#include "FFDFieldHeaderChecks.h"
#include "FFDSingularMatrix.h"

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
constexpr int NiftiMeters = 1;
constexpr int NiftiMillimeters = 2;
constexpr int NiftiMicrons = 3;
constexpr int NiftiSpaceUnits = 7; // bits of xyzt_units
// What SPM and NiftyReg call what they write, as intent_name; both are in RAS.
constexpr std::string_view SpmMapping = "Mapping";
constexpr std::string_view NiftyRegTransform = "NREG_TRANS";
constexpr double NiftyRegPositions = 0.0;
constexpr double NiftyRegDisplacements = 1.0;

/// Finds what the vectors are. False for what is neither displacements nor positions.
bool FindMeaning(
  std::string_view name, int intent, double parameter, FieldHeader& header, std::string& error)
{
  header.VectorsInRas = intent == NiftiDisplacementIntent;
  if (name == SpmMapping)
  {
    header.VectorsInRas = true;
    header.HoldsPositions = true;
  }
  else if (name == NiftyRegTransform)
  {
    header.VectorsInRas = true;
    header.HoldsPositions = parameter == NiftyRegPositions;
    if (!header.HoldsPositions && parameter != NiftyRegDisplacements)
    {
      error = "it holds control points or velocities of NiftyReg; write displacements with "
              "reg_transform -disp";
      return false;
    }
  }
  return true;
}

} // namespace

//------------------------------------------------------------------------------
double FindNiftiUnit(int units)
{
  const int length = units & NiftiSpaceUnits;
  return length == NiftiMeters ? 1e3 : length == NiftiMicrons ? 1e-3 : 1.0;
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
  // As in NIfTI's own library, what is no number is no scaling.
  header.Intercept = std::isfinite(header.Intercept) ? header.Intercept : 0.0;
  if (header.Slope == 0.0 || !std::isfinite(header.Slope))
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
  bool hasSform = integer(254) > 0;
  const bool hasQform = integer(252) > 0;
  if (hasSform)
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
    // Some programs write a code for an sform, and zeros.
    hasSform = !hasQform || (finite && !IsSingular(axes));
  }
  if (!hasSform)
  {
    axes = glm::dmat3(1.0);
    origin = glm::dvec3(0.0);
    finite = true;
    for (int a = 0; a < 3; ++a)
    {
      finite = finite && std::isfinite(pixel[a + 1]);
    }
    if (hasQform) // a quaternion, and a sign that mirrors z
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
  // RAS in the file's units of length to LPS in millimeters.
  const double length = FindNiftiUnit(static_cast<unsigned char>(bytes[123]));
  const glm::dvec3 flip(-length, -length, length);
  origin *= flip;
  for (int a = 0; a < 3; ++a)
  {
    axes[a] *= flip;
  }
  const std::string_view name = bytes.substr(328, 16);
  return FindMeaning(name.substr(0, name.find('\0')), integer(68), real(56), header, error) &&
    SetFieldGrid(header, axes, error);
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
  bytes[123] = NiftiMillimeters;
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
