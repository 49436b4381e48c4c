// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDicomSlices.h"

#include "vtkFFDDicomSliceHeader.h"
#include "vtkFFDFileAccess.h"
#include "vtkFFDTextHeader.h"

#include "vtkDICOMImageReader.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"

#include <glm/geometric.hpp>

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

namespace
{

using vtkFFDTextHeader::ReadStart;

/// Whether the first bytes of a file are those of DICOM, behind a preamble.
bool HasMark(const std::string& bytes)
{
  return bytes.size() > 128 && bytes.compare(128, 4, "DICM") == 0;
}

constexpr char NoSlices[] = "no DICOM slices were found in it";

/// Tells the files, in the order of the slices.
class SliceReader : public vtkDICOMImageReader
{
public:
  static SliceReader* New() { VTK_STANDARD_NEW_BODY(SliceReader); }
  vtkTypeMacro(SliceReader, vtkDICOMImageReader);
  using vtkDICOMImageReader::GetDICOMFileName;
  using vtkDICOMImageReader::GetNumberOfDICOMFileNames;
};

/// Distances between columns and between rows as the tag Pixel Spacing (0028,0030) has them, in the
/// reverse order. Versions of VTK differ in whether they turn it.
void ReadPixelSpacing(const char* path, glm::dvec3& spacing)
{
  const std::string bytes = ReadStart(path);
  const std::string tag("\x28\0\x30\0", 4);
  for (std::size_t at = bytes.find(tag); at != std::string::npos; at = bytes.find(tag, at + 1))
  {
    // A text of a few numbers after 4 bytes of type and length, explicit or implicit.
    const std::vector<double> numbers =
      vtkFFDTextHeader::ReadNumbers(bytes.substr(std::min(at + 8, bytes.size()), 40));
    constexpr double tolerance = 1e-5;
    if (numbers.size() >= 2 && std::abs(numbers[0] - spacing.x) < tolerance * spacing.x &&
      std::abs(numbers[1] - spacing.y) < tolerance * spacing.y)
    {
      std::swap(spacing.x, spacing.y); // it came as it is in the file
      return;
    }
  }
}

/// Position and orientation of one slice, LPS.
struct Slice
{
  glm::dvec3 Position{ 0.0 };
  glm::dvec3 Right{ 0.0 };
  glm::dvec3 Down{ 0.0 };
  std::string Syntax;
};

class SliceFolder : public vtkFFDVolumeFile
{
public:
  using vtkFFDVolumeFile::vtkFFDVolumeFile;
  std::string FindProblem() const override;
  std::string Explain(const std::string&) const override { return NoSlices; }

protected:
  std::string FindVoxels(Header&) const override
  {
    auto* const reader = SliceReader::SafeDownCast(this->GetReader());
    return reader->GetNumberOfDICOMFileNames() == 0 ? NoSlices : "";
  }
  std::string FindPlacement(Header& header) const override;

private:
  Slice ReadSlice(const char* path) const;
};

Slice SliceFolder::ReadSlice(const char* path) const
{
  vtkNew<vtkDICOMImageReader> reader;
  this->Watch(reader);
  reader->SetFileName(path);
  reader->UpdateInformation();
  Slice slice;
  const float* position = reader->GetImagePositionPatient();
  const float* orientation = reader->GetImageOrientationPatient();
  for (int a = 0; a < 3; ++a)
  {
    slice.Position[a] = position[a];
    slice.Right[a] = orientation[a];
    slice.Down[a] = orientation[a + 3];
  }
  slice.Syntax = reader->GetTransferSyntaxUID();
  slice.Syntax = slice.Syntax.c_str(); // up to the padding
  return slice;
}

/// What a slice is called in what is said of it.
std::string NameSlice(const std::string& path)
{
  return "the slice '" + vtksys::SystemTools::GetFilenameName(path) + "' ";
}

/// The problem of a file that ends in its header or before its pixels do, or that lacks a size or a
/// value.
std::string FindSliceProblem(const std::string& path, const vtkFFDDicomSliceHeader& slice)
{
  std::size_t size = 0;
  std::string problem;
  if (!vtkFFDFileAccess::FindSize(path, size, problem))
  {
    return problem;
  }
  if (size < slice.End)
  {
    return NameSlice(path) + "is not whole: it has " + std::to_string(size) + " bytes of " +
      std::to_string(slice.End);
  }
  if (slice.Pixels == vtkFFDDicomSliceHeader::FOUND && !slice.HasSize())
  {
    return NameSlice(path) +
      "has pixels, but lacks Rows (0028,0010), Columns (0028,0011) or Bits Allocated (0028,0100)";
  }
  return slice.Empty
    ? NameSlice(path) + "has no value of " + slice.Empty + ", which VTK's reader needs"
    : std::string();
}

/// Slices must be of one size and whole; where they are not at equal distances a warning tells it.
/// Returns the problem.
std::string CheckSlices(SliceReader* reader, int slices, std::string& warning)
{
  using Header = vtkFFDDicomSliceHeader;
  const auto describe = [](const Header& slice) {
    return std::to_string(slice.Columns) + " x " + std::to_string(slice.Rows) + " pixels of " +
      std::to_string(slice.Samples) + " x " + std::to_string(slice.Bits) + " bits";
  };
  Header first;
  std::vector<glm::dvec3> places;
  for (int i = 0; i < slices; ++i)
  {
    const char* const path = reader->GetDICOMFileName(i);
    const std::string start = ReadStart(path);
    const Header slice = Header::Parse(start);
    first = i == 0 ? slice : first;
    if (slice.HasSize() && first.HasSize() && !slice.HasSizeOf(first))
    {
      return NameSlice(path) + "has " + describe(slice) + ", '" +
        vtksys::SystemTools::GetFilenameName(reader->GetDICOMFileName(0)) + "' " + describe(first) +
        "; slices of one size are needed, so move the others into another folder";
    }
    if (slice.IsFraction != first.IsFraction)
    {
      return NameSlice(path) + "and '" +
        vtksys::SystemTools::GetFilenameName(reader->GetDICOMFileName(0)) +
        "' differ in whether Rescale Slope (0028,1053) and Rescale Intercept (0028,1052) are whole "
        "numbers, which VTK's reader mixes up; write slices with one slope and intercept first, or "
        "one file of another format";
    }
    const std::string problem = FindSliceProblem(path, slice);
    if (!problem.empty())
    {
      return problem;
    }
    if (slice.Pixels == Header::NONE && start.size() < vtkFFDTextHeader::LargestSize)
    {
      return NameSlice(path) + "has no pixels";
    }
    if (slice.HasPosition)
    {
      places.emplace_back(slice.Position[0], slice.Position[1], slice.Position[2]);
    }
  }
  if (slices < 3 || places.size() != static_cast<std::size_t>(slices))
  {
    return std::string();
  }
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i)
  {
    const double distance = glm::length(places[i] - places[i - 1]);
    least = std::min(least, distance);
    most = std::max(most, distance);
  }
  if (most > 1.1 * least)
  {
    std::ostringstream text;
    text << "the slices are at distances from " << least << " to " << most
         << " mm, as where one is missing or there twice; they are placed at equal ones";
    warning = text.str();
  }
  return std::string();
}

/// All files of the folder are opened.
std::string SliceFolder::FindProblem() const
{
  namespace fs = std::filesystem;
  std::error_code problem;
  for (const fs::directory_entry& entry : fs::directory_iterator(this->Path, problem))
  {
    const fs::file_status status = entry.status(problem); // of what links lead to
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    {
      return entry.path().filename().string() + ", which is in it, is no regular file";
    }
    const std::string path = entry.path().string();
    const std::string start = fs::is_regular_file(status) ? ReadStart(path) : std::string();
    if (HasMark(start))
    {
      // VTK's reader crashes of headers that are cut off and of values that are missing. Pixels are
      // for CheckSlices().
      const vtkFFDDicomSliceHeader slice = vtkFFDDicomSliceHeader::Parse(start);
      const bool isForLater =
        slice.Pixels == vtkFFDDicomSliceHeader::FOUND && slice.HasSize() && !slice.Empty;
      std::string found = isForLater ? std::string() : FindSliceProblem(path, slice);
      if (!found.empty())
      {
        return found;
      }
    }
  }
  return std::string();
}

std::string SliceFolder::FindPlacement(Header& header) const
{
  auto* const reader = SliceReader::SafeDownCast(this->GetReader());
  const int slices = header.Size[2];
  const Slice first = this->ReadSlice(reader->GetDICOMFileName(0));
  const Slice last = this->ReadSlice(reader->GetDICOMFileName(slices - 1));
  // Implicit, and explicit of either byte order.
  if (first.Syntax.compare(0, 17, "1.2.840.10008.1.2") == 0 && first.Syntax.size() > 17 &&
    first.Syntax != "1.2.840.10008.1.2.1" && first.Syntax != "1.2.840.10008.1.2.2")
  {
    return "its slices are compressed (transfer syntax " + first.Syntax +
      "), which VTK cannot read; write them uncompressed first, for instance with gdcmconv --raw";
  }
  const std::string problem = CheckSlices(reader, slices, header.Warning);
  if (!problem.empty())
  {
    return problem;
  }
  glm::dvec3 distance = header.Spacing;
  ReadPixelSpacing(reader->GetDICOMFileName(0), distance);
  // VTK's reader turns the rows, so that the last one comes first, and sorts the slices against the
  // normal of the plane.
  Placement place;
  place.Steps[0] = distance.x * first.Right;
  place.Steps[1] = -distance.y * first.Down;
  place.Steps[2] = (last.Position - first.Position) / static_cast<double>(slices - 1);
  if (!(glm::length(place.Steps[2]) > 0.0))
  {
    place.Steps[2] = -distance.z * glm::cross(first.Right, first.Down);
  }
  place.Origin = first.Position - static_cast<double>(header.Size[1] - 1) * place.Steps[1];
  header.Place = place;
  return std::string();
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDDicomSlices::IsSlice(const std::string& path) { return HasMark(ReadStart(path, 132)); }

//------------------------------------------------------------------------------
std::unique_ptr<vtkFFDVolumeFile> vtkFFDDicomSlices::Open(
  const std::string& folder, vtkCommand* errors)
{
  vtkNew<SliceReader> reader;
  reader->SetDirectoryName(folder.c_str());
  return std::make_unique<SliceFolder>(folder, reader, errors);
}
