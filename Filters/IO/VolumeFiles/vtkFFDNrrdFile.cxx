// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDNrrdFile.h"

#include "FFDFieldHeader.h"

#include "vtkFFDDataFiles.h"
#include "vtkFFDTextHeader.h"

#include "vtkByteSwap.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkNrrdReader.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace
{

using vtkFFDTextHeader::Find;
using vtkFFDTextHeader::ReadNumbers;
using vtkFFDTextHeader::ToVector;
using vtkFFDTextHeader::ToWords;

/// VTK's own, where object factories have vtkPNrrdReader in its place, as after Python's
/// "import vtk": that one does not read without an MPI controller.
class PlainNrrdReader : public vtkNrrdReader
{
public:
  static PlainNrrdReader* New() { VTK_STANDARD_NEW_BODY(PlainNrrdReader); }
  vtkTypeMacro(PlainNrrdReader, vtkNrrdReader);

protected:
  /// VTK leaves the bytes of packed numbers in the order of the file.
  int ReadDataGZip(vtkImageData* output) override
  {
    const vtkTypeBool swaps = this->SwapBytes;
    this->SwapBytes = 0;
    const int done = this->Superclass::ReadDataGZip(output);
    this->SwapBytes = swaps;
    if (done && swaps)
    {
      vtkDataArray* const scalars = output->GetPointData()->GetScalars();
      vtkByteSwap::SwapVoidRange(scalars->GetVoidPointer(0),
        static_cast<std::size_t>(scalars->GetNumberOfValues()),
        static_cast<std::size_t>(scalars->GetDataTypeSize()));
    }
    return done;
  }
};

/// The empty line that ends the header of a NRRD, unless the file ends with the header.
struct NrrdHeaderEnd
{
  std::size_t Begin; ///< none: npos
  std::size_t Data;  ///< behind the line; none: 0
};

NrrdHeaderEnd FindNrrdHeaderEnd(const std::string& text)
{
  const std::size_t plain = text.find("\n\n");
  const std::size_t returns = text.find("\n\r\n");
  const std::size_t begin = std::min(plain, returns);
  return { begin, begin == std::string::npos ? 0 : begin + (plain < returns ? 2 : 3) };
}

/// How many files the data of a NRRD are in, where it says that these are several.
int CountSlices(const vtkFFDTextHeader::Fields& fields)
{
  const std::vector<double> sizes = ReadNumbers(Find(fields, { "sizes" }));
  return sizes.empty() ? 1 : static_cast<int>(glm::clamp(sizes.back(), 1.0, 65536.0));
}

/// The numbers of dimensions and sizes of a NRRD, as they stand there.
std::string FindNrrdSizesProblem(const vtkFFDTextHeader::Fields& fields)
{
  const std::string sizes = Find(fields, { "sizes" });
  const std::vector<std::string> words = ToWords(sizes);
  bool plain = !words.empty();
  for (const std::string& word : words)
  {
    plain = plain && word.find_first_not_of("0123456789") == std::string::npos &&
      word.size() < 10 && std::atol(word.c_str()) > 0;
  }
  const std::string dimension = Find(fields, { "dimension" });
  return plain && std::to_string(words.size()) == dimension ? std::string()
                                                            : "its sizes are '" + sizes +
      "', its dimension '" + dimension + "': as many whole numbers from 1 to 999999999 are needed";
}

/// Whether VTK's reader takes the first axis for that of components before it knows any axes, and
/// crashes: it knows them by fields in lower case alone, the dimension before the sizes.
bool HasComponentsWithoutSizes(const std::string& text)
{
  std::istringstream lines(text);
  std::string line;
  bool hasDimension = false;
  bool hasSizes = false;
  bool hasComponents = false;
  while (std::getline(lines, line) && line.find_first_not_of(" \t\r") != std::string::npos)
  {
    const std::string key = line.substr(0, line.find(": "));
    hasDimension = hasDimension || key == "dimension" || key == "space" || key == "space dimension";
    hasSizes = hasSizes || (key == "sizes" && hasDimension);
    if (key == "space directions" || (key == "spacings" && hasDimension))
    {
      const std::vector<std::string> axes = ToWords(line.substr(key.size() + 1));
      const std::vector<double> first = ReadNumbers(axes.empty() ? std::string() : axes[0]);
      hasComponents = !axes.empty() &&
        std::all_of(first.begin(), first.end(), [](double number) { return number == 0.0; });
    }
  }
  return hasComponents && !hasSizes;
}

/// Whether numbers of a NRRD are written as text.
bool IsText(const std::string& encoding)
{
  return encoding == "ascii" || encoding == "text" || encoding == "txt";
}

/// Whether the last of the four axes of a NRRD is none of space, as that of times.
bool IsLastNotOfSpace(const vtkFFDTextHeader::Fields& fields)
{
  const std::string directions = Find(fields, { "space directions" });
  if (!directions.empty())
  {
    return ToWords(directions)[0] != "none";
  }
  const std::vector<std::string> kinds = ToWords(Find(fields, { "kinds" }));
  return kinds.size() == 4 && (kinds[0] == "domain" || kinds[0] == "space");
}

/// Where the fields place the voxels, whose rows VTK's reader may turn.
std::optional<vtkFFDVolumeFile::Placement> PlaceNrrd(
  const vtkFFDTextHeader::Fields& fields, const vtkFFDVolumeFile::Header& header, bool turnsRows)
{
  const vtkFFDStoredVoxels& stored = header.Stored;
  vtkFFDVolumeFile::Placement place;
  const std::vector<double> steps = ReadNumbers(Find(fields, { "space directions" }));
  const std::vector<double> origin = ReadNumbers(Find(fields, { "space origin" }));
  const std::vector<double> spacings = ReadNumbers(Find(fields, { "spacings" }));
  const bool hasSpacings = spacings.size() == 3 || spacings.size() == 4;
  if (steps.empty() && stored.Components > 0 &&
    (hasSpacings || !Find(fields, { "axis mins" }).empty()))
  {
    // That of the axis without a direction may be "nan".
    const auto axis = static_cast<std::size_t>(stored.FirstAxis);
    glm::dvec3 spacing(1.0);
    for (std::size_t a = 0; hasSpacings && a < 3; ++a)
    {
      spacing[static_cast<int>(a)] = spacings[(spacings.size() == 4 ? axis : 0) + a];
      place.Steps[static_cast<int>(a)] *= spacing[static_cast<int>(a)];
    }
    place.Origin = origin.size() == 3
      ? ToVector(origin, 0)
      : ffd::FindNrrdOrigin(
          ReadNumbers(Find(fields, { "axis mins" })), Find(fields, { "centers" }), axis, spacing);
    return place;
  }
  if (steps.size() != 9)
  {
    return std::nullopt;
  }
  const std::string space = Find(fields, { "space" });
  glm::dvec3 toLps(1.0);
  if (space == "right-anterior-superior" || space == "ras")
  {
    toLps = vtkFFDVolumeFile::Placement::FromRas;
  }
  else if (space == "left-anterior-superior" || space == "las")
  {
    toLps.y = -1.0;
  }
  for (int a = 0; a < 3; ++a)
  {
    place.Steps[a] = toLps * ToVector(steps, 3 * static_cast<std::size_t>(a));
  }
  place.Origin = origin.size() == 3 ? toLps * ToVector(origin, 0) : glm::dvec3(0.0);
  // VTK's reader turns the rows of uncompressed data in spaces that it takes for left-handed.
  if (turnsRows && Find(fields, { "encoding" }) == "raw")
  {
    place.Origin += static_cast<double>(header.Size[1] - 1) * place.Steps[1];
    place.Steps[1] = -place.Steps[1];
  }
  return place;
}

/// Tells of a field that NRRD has not, as one that is misspelled; its default counts then. The
/// files of a list are none.
std::string FindUnknownField(const vtkFFDTextHeader::Fields& fields)
{
  const bool hasList = Find(fields, { "data file" }).compare(0, 4, "LIST") == 0;
  for (const auto& [key, ignored] : fields)
  {
    if (!hasList && ffd::FindNrrdField(key).empty())
    {
      return "the header has a field '" + key + "', which NRRD has not; it is left out";
    }
  }
  return std::string();
}

class NrrdFile : public vtkFFDVolumeFile
{
public:
  NrrdFile(
    const std::string& path, const std::string& start, vtkAlgorithm* reader, vtkCommand* errors)
    : vtkFFDVolumeFile(path, reader, errors)
    , Text(start)
  {
  }
  std::string FindProblem() const override;

protected:
  std::string FindVoxels(Header& header) const override;
  std::string FindPlacement(Header& header) const override;

private:
  std::string FindDataProblem(double bytes) const;
  vtkFFDStoredVoxels FindStoredVoxels() const;

  const std::string Text;
  const NrrdHeaderEnd End = FindNrrdHeaderEnd(this->Text);
  const vtkFFDTextHeader::Fields Fields = vtkFFDTextHeader::ReadFields(this->Text, ':');
};

/// Finds what would hang VTK's reader: a header that holds zeros or does not end, or data files
/// that do not end; and sizes that are none.
std::string NrrdFile::FindProblem() const
{
  if (this->End.Begin == std::string::npos &&
    (this->Text.size() == vtkFFDTextHeader::LargestSize || this->Text.back() != '\n'))
  {
    return "it cannot be read: its header does not end (with an empty line, or with the last line "
           "of the file)";
  }
  if (this->Text.substr(0, this->End.Begin).find('\0') != std::string::npos)
  {
    return "it cannot be read: its header holds zero bytes";
  }
  if (HasComponentsWithoutSizes(this->Text))
  {
    return "it cannot be read: VTK's reader needs the fields 'dimension' and 'sizes' in this "
           "order, in lower case";
  }
  return this->FindDataProblem(0.0);
}

std::string NrrdFile::FindVoxels(Header& header) const
{
  vtkInformation* const info = this->GetReader()->GetOutputInformation(0);
  if (!info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    return "it cannot be read: VTK does not know its type '" + Find(this->Fields, { "type" }) +
      "'; write whole numbers, float or double";
  }
  header.Stored = this->FindStoredVoxels();
  if (header.Stored.Components > 0)
  {
    header.Size = header.Stored.Size;
  }
  return std::string();
}

std::string NrrdFile::FindPlacement(Header& header) const
{
  auto* const reader = vtkNrrdReader::SafeDownCast(this->GetReader());
  const bool isOfVtk = header.Stored.Form == vtkFFDStoredVoxels::OF_VTK;
  header.Warning = FindUnknownField(this->Fields);
  header.Place = PlaceNrrd(this->Fields, header, reader->GetFileLowerLeft() == 0 && isOfVtk);
  return this->FindDataProblem(this->CountBytes(header));
}

/// Finds the problem of sizes and data files of so many bytes; 0: not known yet.
std::string NrrdFile::FindDataProblem(double bytes) const
{
  const std::string sizes = FindNrrdSizesProblem(this->Fields);
  if (!sizes.empty())
  {
    return sizes;
  }
  const std::string encoding = Find(this->Fields, { "encoding" });
  const double least = encoding == "raw" ? bytes : 0.0;
  const std::string value = Find(this->Fields, { "data file" });
  if (value.empty())
  {
    return this->End.Data == 0 ? "its header ends with the file, and names no data file"
                               : vtkFFDDataFiles::FindProblem(this->Path,
                                   std::filesystem::path(this->Path).filename().string(),
                                   static_cast<double>(this->End.Data) + least);
  }
  std::vector<std::string> names = { value };
  const int slices = CountSlices(this->Fields);
  const bool isList = value.compare(0, 4, "LIST") == 0;
  const bool isPattern = value.find('%') != std::string::npos;
  if (isList)
  {
    names = vtkFFDDataFiles::LinesAfter(this->Text, "data", slices);
  }
  else if (isPattern)
  {
    names = vtkFFDDataFiles::ExpandPattern(value, slices);
    if (names.empty())
    {
      return "its data file is '" + value + "', which is no pattern as 'slice%03d.raw 1 9 1'";
    }
  }
  if ((isList || isPattern) && IsText(encoding))
  {
    return "its numbers are text in several files, which cannot be read here: write raw ones";
  }
  return vtkFFDDataFiles::FindProblem(
    this->Path, names, std::max(1.0, isList || isPattern ? least / slices : least));
}

/// Finds voxels that are not to be left to VTK's reader.
vtkFFDStoredVoxels NrrdFile::FindStoredVoxels() const
{
  vtkFFDStoredVoxels voxels;
  const std::string value = Find(this->Fields, { "data file" });
  const std::string encoding = Find(this->Fields, { "encoding" });
  const std::vector<std::string> sizes = ToWords(Find(this->Fields, { "sizes" }));
  if (value.compare(0, 4, "LIST") == 0 || value.find('%') != std::string::npos ||
    sizes.size() < 3 || sizes.size() > 4)
  {
    return voxels;
  }
  voxels.Form = IsText(encoding)             ? vtkFFDStoredVoxels::TEXT
    : encoding == "gzip" || encoding == "gz" ? vtkFFDStoredVoxels::PACKED
                                             : vtkFFDStoredVoxels::RAW;
  // One of four axes has no direction: the components, or the times, of which the first is read.
  const std::size_t first = sizes.size() == 4 && !IsLastNotOfSpace(this->Fields) ? 1 : 0;
  for (std::size_t a = 0; a < 3; ++a)
  {
    voxels.Size[a] = std::atoi(sizes[first + a].c_str());
  }
  voxels.FirstAxis = static_cast<int>(first);
  voxels.Components = first == 1 ? std::atoi(sizes[0].c_str()) : 1;
  voxels.Path = value.empty() ? this->Path : vtkFFDDataFiles::Resolve(this->Path, value);
  voxels.Offset = value.empty() ? this->End.Data : 0;
  voxels.BigEndian = Find(this->Fields, { "endian" }) == "big";
  return voxels;
}

} // namespace

//------------------------------------------------------------------------------
std::unique_ptr<vtkFFDVolumeFile> vtkFFDNrrdFile::Open(const std::string& path, vtkCommand* errors)
{
  // Not asked by CanReadFile(), which reads as far as the first line goes.
  const std::string start = vtkFFDTextHeader::ReadStart(path);
  if (start.compare(0, 4, "NRRD") != 0)
  {
    return nullptr;
  }
  vtkNew<PlainNrrdReader> reader;
  reader->SetFileName(path.c_str());
  return std::make_unique<NrrdFile>(path, start, reader, errors);
}
