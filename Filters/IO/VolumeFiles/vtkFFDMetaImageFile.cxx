// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDMetaImageFile.h"

#include "FFDFieldHeader.h"

#include "vtkFFDDataFiles.h"
#include "vtkFFDTextHeader.h"

#include "vtkMetaImageReader.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

namespace
{

using vtkFFDTextHeader::Find;

/// Those that VTK's reader has room for.
constexpr double LargestDimensions = 10.0;

bool IsTrue(const std::string& value)
{
  return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
}

/// Rows of the matrix are the directions of the axes of the image.
std::optional<vtkFFDVolumeFile::Placement> PlaceMetaImage(
  const vtkFFDTextHeader::Fields& fields, const glm::dvec3& spacing)
{
  using vtkFFDTextHeader::ToVector;
  const std::vector<double> matrix =
    vtkFFDTextHeader::ReadNumbers(Find(fields, { "TransformMatrix", "Rotation", "Orientation" }));
  const std::vector<double> origin =
    vtkFFDTextHeader::ReadNumbers(Find(fields, { "Offset", "Position", "Origin" }));
  if (matrix.size() != 9)
  {
    return std::nullopt;
  }
  vtkFFDVolumeFile::Placement place;
  for (int a = 0; a < 3; ++a)
  {
    place.Steps[a] = spacing[a] * ToVector(matrix, 3 * static_cast<std::size_t>(a));
  }
  place.Origin = origin.size() == 3 ? ToVector(origin, 0) : glm::dvec3(0.0);
  return place;
}

class MetaImageFile : public vtkFFDVolumeFile
{
public:
  using vtkFFDVolumeFile::vtkFFDVolumeFile;
  std::string FindProblem() const override;
  std::string Explain(const std::string& error) const override;

protected:
  std::string FindPlacement(Header& header) const override;

private:
  std::string FindDataProblem(double bytes, int slices) const;
  vtkFFDStoredVoxels FindStoredVoxels() const;

  const std::string Text = vtkFFDTextHeader::ReadStart(this->Path);
  const vtkFFDTextHeader::Fields Fields = vtkFFDTextHeader::ReadFields(this->Text, '=');
};

/// VTK's reader fills arrays of LargestDimensions by as many numbers as NDims says. It reads up to
/// ElementDataFile, so this is to see all of that.
std::string MetaImageFile::FindProblem() const
{
  if (Find(this->Fields, { "ElementDataFile" }).empty())
  {
    return "its header has no ElementDataFile";
  }
  std::istringstream lines(this->Text);
  std::string line;
  while (std::getline(lines, line))
  {
    const std::size_t from = std::min(line.find_first_not_of(" \t\v\f\r"), line.size());
    if (line.compare(from, 15, "ElementDataFile") == 0)
    {
      break;
    }
    if (line.compare(from, 5, "NDims") == 0)
    {
      // The last one counts for the lines behind it: all of them are checked.
      const std::size_t at = std::min(line.find_first_not_of(" \t=:", from + 5), line.size());
      const std::vector<double> numbers = vtkFFDTextHeader::ReadNumbers(line.substr(at));
      if (numbers.size() != 1 || !(numbers[0] >= 1.0 && numbers[0] <= LargestDimensions))
      {
        return "its header has '" + line.substr(from, 40) + "'; a volume has 3 dimensions";
      }
    }
  }
  return std::string();
}

std::string MetaImageFile::Explain(const std::string& error) const
{
  return vtkFFDVolumeFile::Explain(error.compare(0, 17, "Unknown data type") == 0
      ? "VTK does not know its ElementType '" + Find(this->Fields, { "ElementType" }) +
        "'; write whole numbers of up to 4 bytes, float or double"
      : error);
}

std::string MetaImageFile::FindPlacement(Header& header) const
{
  header.Stored = this->FindStoredVoxels();
  header.Place = PlaceMetaImage(this->Fields, header.Spacing);
  const std::string problem = this->FindDataProblem(this->CountBytes(header), header.Size[2]);
  const bool isOfVtk = header.Stored.Form == vtkFFDStoredVoxels::OF_VTK;
  return problem.empty() && header.Stored.Type >= 0 && isOfVtk
    ? "its ElementType '" + Find(this->Fields, { "ElementType" }) +
      "' is read from one file without a HeaderSize only; write MET_INT or MET_UINT"
    : problem;
}

/// Finds the problem of data files of so many bytes in so many slices.
std::string MetaImageFile::FindDataProblem(double bytes, int slices) const
{
  const std::string value = Find(this->Fields, { "ElementDataFile" });
  const std::string binary = Find(this->Fields, { "BinaryData" });
  const bool plain = (binary.empty() || IsTrue(binary)) &&
    !IsTrue(Find(this->Fields, { "CompressedData" })); // what is stored are the voxels
  if (!(bytes > 0.0))
  {
    return "its header gives voxels without a size (ElementNumberOfChannels)";
  }
  if (ffd::IsLocalData(value))
  {
    const std::size_t line = this->Text.find('\n', this->Text.find("ElementDataFile"));
    const double start = line == std::string::npos ? 0.0 : static_cast<double>(line + 1);
    const std::string name = std::filesystem::path(this->Path).filename().string();
    return vtkFFDDataFiles::FindProblem(this->Path, name, plain ? start + bytes : 1.0);
  }
  std::vector<std::string> names;
  // -1: in front of the voxels is what is left.
  const double head = std::max(0.0, std::atof(Find(this->Fields, { "HeaderSize" }).c_str()));
  const double least = plain ? head + bytes / slices : 1.0;
  if (value.compare(0, 4, "LIST") == 0)
  {
    // A number says how many dimensions a file has.
    if (value.size() > 4 && value != "LIST 2" && value != "LIST 2D")
    {
      return "MetaImage takes the data file '" + value +
        "' for a list of files, of which only LIST and LIST 2 (a slice a file) are read here";
    }
    names = vtkFFDDataFiles::LinesAfter(this->Text, "ElementDataFile", slices);
  }
  else if (value.find('%') != std::string::npos)
  {
    names = vtkFFDDataFiles::ExpandPattern(value, slices);
  }
  else
  {
    return vtkFFDDataFiles::FindProblem(
      this->Path, value, plain ? head + bytes : 1.0, { "", ".gz", ".Z" });
  }
  if (static_cast<int>(names.size()) < slices)
  {
    return "ElementDataFile is '" + value + "', which names no file for each of its " +
      std::to_string(slices) + " slices (LIST and a file a line, or as 'slice%03d.raw 1 9 1')";
  }
  return vtkFFDDataFiles::FindProblem(this->Path, names, least);
}

/// Finds voxels that are not to be left to VTK's reader.
vtkFFDStoredVoxels MetaImageFile::FindStoredVoxels() const
{
  vtkFFDStoredVoxels voxels;
  voxels.Name = "MetaImage"; // as VTK's reader
  const std::string type = Find(this->Fields, { "ElementType" });
  voxels.Type = type == "MET_LONG" ? VTK_INT : type == "MET_ULONG" ? VTK_UNSIGNED_INT : -1;
  const std::string value = Find(this->Fields, { "ElementDataFile" });
  const std::string binary = Find(this->Fields, { "BinaryData" });
  const bool isText = !binary.empty() && !IsTrue(binary);
  const bool isPacked = !isText && IsTrue(Find(this->Fields, { "CompressedData" }));
  const bool isList = value.compare(0, 4, "LIST") == 0 || value.find('%') != std::string::npos;
  const bool local = ffd::IsLocalData(value);
  const std::string head = Find(this->Fields, { "HeaderSize" });
  // -1: the voxels are at the end of the file.
  const bool isOfVtk =
    !isText && !isPacked && (voxels.Type < 0 || isList || std::atof(head.c_str()) < 0.0);
  voxels.Path = local ? this->Path : vtkFFDDataFiles::Resolve(this->Path, value);
  std::error_code ignored;
  if (isOfVtk || (local && !head.empty()) || !std::filesystem::exists(voxels.Path, ignored))
  {
    return voxels;
  }
  voxels.Form = isText ? vtkFFDStoredVoxels::TEXT
    : isPacked         ? vtkFFDStoredVoxels::PACKED
                       : vtkFFDStoredVoxels::RAW;
  voxels.Offset = local
    ? std::min(this->Text.find('\n', this->Text.find("ElementDataFile")), this->Text.size()) + 1
    : static_cast<std::size_t>(std::max(0.0, std::atof(head.c_str())));
  voxels.BigEndian =
    IsTrue(Find(this->Fields, { "BinaryDataByteOrderMSB", "ElementByteOrderMSB" }));
  return voxels;
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDMetaImageFile::BeginsWithLongWord(const std::string& path)
{
  const std::string ending = vtkFFDVolumeFile::FindEnding(path);
  return (ending == ".mha" || ending == ".mhd") &&
    vtkFFDTextHeader::ReadStart(path).find_first_of(" \t\n\v\f\r") >= 4000;
}

//------------------------------------------------------------------------------
std::unique_ptr<vtkFFDVolumeFile> vtkFFDMetaImageFile::Open(
  const std::string& path, vtkImageReader2* found, vtkCommand* errors)
{
  return vtkMetaImageReader::SafeDownCast(found)
    ? std::make_unique<MetaImageFile>(path, found, errors)
    : nullptr;
}
