// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDFieldHeader_h
#define FFDFieldHeader_h

#include "FFDExport.h"
#include "FFDTransformStep.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ffd
{

/**
 * Stores the header of a displacement field, which has three numbers per voxel of a 3-D image. The
 * grid is in LPS coordinates, whatever the format keeps.
 */
struct FFD_IO_EXPORT FieldHeader
{
  enum class Number
  {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Float32,
    Float64
  };
  TransformGrid Grid;
  Number Type = Number::Float32;
  bool BigEndian = false;
  /// All x, then all y, then all z (NIfTI); else the three numbers of a voxel together.
  bool Planar = false;
  /// The data are one zlib or gzip stream.
  bool Compressed = false;
  /// File of the data in the header's folder; empty: the same file.
  std::string DataFile;
  /// Offset of the data, bytes; for NIfTI in the (decompressed) file.
  std::size_t Offset = 0;
  /// The vectors are in RAS (NIfTI's intent 1006, SPM, NiftyReg), not in LPS.
  bool VectorsInRas = false;
  /// The vectors are where the nodes are moved to, not by how much.
  bool HoldsPositions = false;
  /// Displacement = Slope * number + Intercept.
  double Slope = 1.0;
  double Intercept = 0.0;

  std::size_t GetNumberOfNodes() const;
  std::size_t GetNumberSize() const;
  /// Bytes of all numbers.
  std::size_t GetDataSize() const;
};

/// Bytes from the start of a file that hold any header that is accepted.
constexpr std::size_t LargestFieldHeader = 65536;
/// Nodes of the largest field that is accepted: 512^3.
constexpr std::size_t LargestField = std::size_t(1) << 27;

///@{
/**
 * Read the header in `bytes`, the start of a file. Return false and what is wrong: not three
 * dimensions and three components, sizes out of range, directions that are not orthonormal, data
 * in another folder, an encoding that is not supported. ITK's conventions: the vectors are in LPS
 * as they are; MetaImage's geometry is LPS, NRRD's as its "space" says, or as its spacings and axis
 * mins say without one, that of NIfTI is RAS, from the sform where there is one, else from the
 * qform, else from the pixel sizes, in millimeters after its xyzt_units (meters, millimeters,
 * microns); vectors of NIfTI's intent 1006 are RAS, as those of SPM (intent name "Mapping",
 * positions) and NiftyReg ("NREG_TRANS", positions or displacements), and in none of its files they
 * are scaled by the units.
 */
FFD_IO_EXPORT bool ParseMetaImageHeader(
  std::string_view bytes, FieldHeader& header, std::string& error);
FFD_IO_EXPORT bool ParseNrrdHeader(std::string_view bytes, FieldHeader& header, std::string& error);
FFD_IO_EXPORT bool ParseNiftiHeader(
  std::string_view bytes, FieldHeader& header, std::string& error);
///@}

FFD_IO_EXPORT bool LooksLikeMetaImage(std::string_view bytes);
FFD_IO_EXPORT bool LooksLikeNrrd(std::string_view bytes);
FFD_IO_EXPORT bool LooksLikeNifti(std::string_view bytes);

/// The name that a field of NRRD has here, of the several that the format has for some, in capital
/// letters or not: "axis mins" for "AxisMins". Empty: the format has no such field.
FFD_IO_EXPORT std::string FindNrrdField(std::string_view name);

/**
 * Where the first node of an array in a NRRD without a "space origin" lies along its axes, from
 * `first` on: "axis mins" are where the first cell begins or, if "centers" says so, the first node;
 * cells are the default, as in teem and ITK. 0 where that is not known, or no number.
 */
FFD_IO_EXPORT glm::dvec3 FindNrrdOrigin(const std::vector<double>& mins, std::string_view centers,
  std::size_t first, const glm::dvec3& spacing);

/// Whether an ElementDataFile of MetaImage says that the data are behind the header.
FFD_IO_EXPORT bool IsLocalData(std::string_view name);

/// Millimeters in a unit of length of NIfTI, of its xyzt_units; 1 where there is none.
FFD_IO_EXPORT double FindNiftiUnit(int units);

/**
 * Numbers as they lie in a file to the displacements of `step` (a Field over header.Grid). `data`
 * has header.GetDataSize() bytes. False when one is not finite or exceeds 1e12.
 */
FFD_IO_EXPORT bool DecodeField(
  const FieldHeader& header, const unsigned char* data, TransformStep& step, std::string& error);

/// Header of an NRRD file (attached data, raw, little endian doubles, LPS) of this grid.
FFD_IO_EXPORT std::string FormatNrrdHeader(const TransformGrid& grid);
/// Whether a MetaImage header can name this file of data, for MetaIO (VTK, ITK) as well.
FFD_IO_EXPORT bool CanNameDataFile(std::string_view name);
/// Header of a MetaImage (.mha: local data, raw, little endian doubles; .mhd: in `dataFile`).
FFD_IO_EXPORT std::string FormatMetaImageHeader(
  const TransformGrid& grid, const std::string& dataFile);
/// The 352 bytes before the data of a NIfTI-1 file (.nii, little endian doubles, planar, sform).
FFD_IO_EXPORT std::string FormatNiftiHeader(const TransformGrid& grid);

} // namespace ffd

#endif
