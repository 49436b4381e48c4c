// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDNiftiFile.h"

#include "vtkFFDFileAccess.h"

#include "FFDBinaryNumbers.h"
#include "FFDFieldHeader.h"

#include "vtkDataArray.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkNIFTIImageHeader.h"
#include "vtkNIFTIImageReader.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <system_error>

namespace
{

/// Whether the columns of a matrix are finite, and directions of three axes.
bool HasDirections(vtkMatrix4x4* matrix)
{
  vtkFFDVolumeFile::Placement place;
  for (int r = 0; r < 3; ++r)
  {
    place.Origin[r] = matrix->GetElement(r, 3);
    for (int a = 0; a < 3; ++a)
    {
      place.Steps[a][r] = matrix->GetElement(r, a);
    }
  }
  return place.IsValid();
}

vtkFFDVolumeFile::Placement PlaceNifti(vtkNIFTIImageReader* reader, const glm::dvec3& spacing)
{
  vtkFFDVolumeFile::Placement place;
  vtkMatrix4x4* matrix = reader->GetSFormMatrix();
  // Some programs write a code for an sform, and zeros.
  if (!matrix || (reader->GetQFormMatrix() && !HasDirections(matrix)))
  {
    matrix = reader->GetQFormMatrix();
  }
  const double toMillimeters = ffd::FindNiftiUnit(reader->GetNIFTIHeader()->GetXYZTUnits());
  if (!matrix)
  {
    place.Steps = glm::dmat3(0.0);
    for (int a = 0; a < 3; ++a)
    {
      place.Steps[a][a] = toMillimeters * spacing[a];
    }
    return place;
  }
  for (int r = 0; r < 3; ++r)
  {
    for (int a = 0; a < 3; ++a)
    {
      place.Steps[a][r] = toMillimeters * place.FromRas[r] * spacing[a] * matrix->GetElement(r, a);
    }
    place.Origin[r] = toMillimeters * place.FromRas[r] * matrix->GetElement(r, 3);
  }
  return place;
}

/// VTK's reader gives what is stored. A slope of zero, or none that is a number, says that this is
/// meant; colors are as they are.
vtkFFDVolumeFile::Scaling FindScaling(vtkNIFTIImageReader* reader)
{
  constexpr int rgb = 128;
  constexpr int rgba = 2304;
  const int kind = reader->GetNIFTIHeader()->GetDataType();
  const double slope = reader->GetRescaleSlope();
  const double intercept = reader->GetRescaleIntercept();
  vtkFFDVolumeFile::Scaling scaling;
  if (slope != 0.0 && std::isfinite(slope) && kind != rgb && kind != rgba)
  {
    scaling.Slope = slope;
    scaling.Intercept = std::isfinite(intercept) ? intercept : 0.0;
  }
  const int storedType = reader->GetDataScalarType();
  // Single precision holds all integers of 16 bits.
  const bool small = vtkDataArray::GetDataTypeSize(storedType) <= 2;
  scaling.Type = small || storedType == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE;
  return scaling;
}

/// The first bytes of the header of a NIfTI file or of a pair of files, decompressed.
std::string ReadNiftiHeader(const std::string& path, std::size_t size)
{
  std::string header = path;
  const std::size_t image = path.rfind(".img");
  for (const char* ending : { ".hdr", ".hdr.gz" })
  {
    const bool isPair = image != std::string::npos && image + 7 >= path.size();
    const std::string other = path.substr(0, isPair ? image : 0) + ending;
    if (isPair && vtksys::SystemTools::FileExists(other) && header == path)
    {
      header = other;
    }
  }
  std::string bytes;
  std::string ignored;
  const auto proceed = [] { return true; };
  vtkFFDFileAccess::ReadBytes(header, 0, size, bytes, proceed, ignored);
  if (vtkFFDFileAccess::IsGzip(bytes))
  {
    vtkFFDFileAccess::ReadCompressed(header, 0, size, bytes, proceed, ignored);
  }
  bytes.resize(size, '\0');
  return bytes;
}

class NiftiFile : public vtkFFDVolumeFile
{
public:
  using vtkFFDVolumeFile::vtkFFDVolumeFile;
  std::string FindProblem() const override;

protected:
  std::string FindPlacement(Header& header) const override
  {
    auto* const reader = vtkNIFTIImageReader::SafeDownCast(this->GetReader());
    header.Place = PlaceNifti(reader, header.Spacing);
    header.Scales = FindScaling(reader);
    return std::string();
  }
};

/// What VTK's reader does not check: it crashes on types that it does not know, and takes the
/// header for voxels where that says so.
std::string NiftiFile::FindProblem() const
{
  constexpr std::size_t first = 348;  // bytes of the header of NIfTI-1
  constexpr std::size_t second = 540; // and NIfTI-2, which they begin with
  const std::string bytes = ReadNiftiHeader(this->Path, second);
  const auto begins = [&bytes](std::size_t size, bool bigEndian) {
    return ffd::LoadBits(ffd::BytesAt(bytes, 0), 4, bigEndian) == size;
  };
  const bool bigEndian = begins(first, true) || begins(second, true);
  const bool isSecond = begins(second, bigEndian);
  const int kind =
    static_cast<std::int16_t>(ffd::LoadBits(ffd::BytesAt(bytes, isSecond ? 12 : 70), 2, bigEndian));
  constexpr int known[] = { 2, 4, 8, 16, 32, 64, 128, 256, 512, 768, 1024, 1280, 1792, 2304 };
  if (std::find(std::begin(known), std::end(known), kind) == std::end(known))
  {
    return "it cannot be read: its voxels are of the NIfTI type " + std::to_string(kind) +
      ", which VTK does not know; write whole numbers, float or double";
  }
  const double start = isSecond ? static_cast<double>(static_cast<std::int64_t>(
                                    ffd::LoadBits(ffd::BytesAt(bytes, 168), 8, bigEndian)))
                                : ffd::LoadFloat(ffd::BytesAt(bytes, 108), bigEndian);
  const std::size_t least = isSecond ? second : first;
  if (bytes.compare(isSecond ? 4 : 344, 2, "n+") == 0 && !(start >= static_cast<double>(least)))
  {
    std::ostringstream text;
    text << "it cannot be read: its voxels begin at byte " << start
         << " (vox_offset), within its header of " << least << " bytes";
    return text.str();
  }
  return std::string();
}

} // namespace

//------------------------------------------------------------------------------
std::string vtkFFDNiftiFile::FindPairProblem(const std::string& path)
{
  namespace fs = std::filesystem;
  const std::string last = vtkFFDVolumeFile::FindEnding(path);
  if (last != ".hdr" && last != ".img" && last != ".gz")
  {
    return std::string();
  }
  fs::path stem = fs::path(path);
  stem.replace_extension(stem.extension() == ".gz" ? "" : stem.extension());
  for (const char* ending : { ".hdr", ".img", ".hdr.gz", ".img.gz" })
  {
    fs::path other = stem;
    other.replace_extension(ending);
    std::error_code ignored;
    std::size_t size = 0;
    std::string error;
    if (fs::exists(other, ignored) && !vtkFFDFileAccess::FindSize(other.string(), size, error))
    {
      return other.filename().string() + ", which belongs to it: " + error;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::unique_ptr<vtkFFDVolumeFile> vtkFFDNiftiFile::Open(const std::string& path, vtkCommand* errors)
{
  vtkNew<vtkNIFTIImageReader> reader;
  reader->SetFileName(path.c_str());
  return reader->CanReadFile(path.c_str()) ? std::make_unique<NiftiFile>(path, reader, errors)
                                           : nullptr;
}
