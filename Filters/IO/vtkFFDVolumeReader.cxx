// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeReader.h"

#include "vtkFFDArrayRanges.h"
#include "vtkFFDClassicLocale.h"
#include "vtkFFDDataFiles.h"
#include "vtkFFDFileAccess.h"
#include "vtkFFDGuard.h"
#include "vtkFFDSliceHeader.h"
#include "vtkFFDStoredVoxels.h"

#include "FFDBinaryNumbers.h"
#include "FFDSingularMatrix.h"

#include "vtkByteSwap.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDICOMImageReader.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkImageReader2Factory.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkMetaImageReader.h"
#include "vtkNew.h"
#include "vtkNIFTIImageHeader.h"
#include "vtkNIFTIImageReader.h"
#include "vtkNrrdReader.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredPointsReader.h"
#include "vtkXMLImageDataReader.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <vtksys/FStream.hxx>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iterator>
#include <limits>
#include <locale>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDVolumeReader);

namespace
{

using Pipeline = vtkStreamingDemandDrivenPipeline;
using vtkFFDDataFiles::Find;

/// Bytes of a file in which its header is looked for.
constexpr std::size_t LargestHeader = 65536;

/// LPS has x and y the other way round.
const glm::dvec3 FromRas(-1.0, -1.0, 1.0);

/// Position of voxel (0, 0, 0), and the steps from voxel to voxel.
struct Placement
{
  glm::dvec3 Origin{ 0.0 };
  glm::dmat3 Steps{ 1.0 };
};

/// Whether the origin is finite, and the steps have directions of three axes.
bool IsPlace(const Placement& place)
{
  glm::dmat3 directions = place.Steps;
  for (int a = 0; a < 3; ++a)
  {
    directions[a] /= glm::length(directions[a]);
  }
  return !ffd::IsSingular(directions) && std::isfinite(glm::length(place.Origin));
}

/// What the numbers of a file mean: Slope times what is stored, plus Intercept.
struct Scaling
{
  double Slope = 1.0;
  double Intercept = 0.0;
  int Type = VTK_FLOAT;

  bool IsNone() const { return this->Slope == 1.0 && this->Intercept == 0.0; }
};

/// Keeps the first complaint of a reader, and all of them from being printed.
class Complaint : public vtkCommand
{
public:
  static Complaint* New() { return new Complaint; }
  void Execute(vtkObject*, unsigned long event, void* data) override
  {
    if (event == vtkCommand::ErrorEvent && this->Text.empty())
    {
      // Without where in VTK's sources it comes from.
      const std::string text = data ? static_cast<const char*>(data) : "it is malformed";
      const std::size_t start = text.find("): ");
      this->Text = start == std::string::npos ? text : text.substr(start + 3);
      this->Text = this->Text.substr(0, this->Text.find('\n'));
    }
  }
  std::string Text;
};

/// Listens to what vtkDataReader says of numbers that are missing, which is no event of its own: it
/// is only printed, and the memory of these numbers stays as it is.
class ShortLegacyFile
{
public:
  explicit ShortLegacyFile(Complaint* heard)
    : Heard(heard)
    , Shown(vtkObject::GetGlobalWarningDisplay())
  {
    vtkObject::GlobalWarningDisplayOn(); // else there is no event
    this->Command->SetClientData(this);
    this->Command->SetCallback([](vtkObject*, unsigned long, void* self, void* data) {
      const std::string text = data ? static_cast<const char*>(data) : "";
      if (text.find("Error reading ") != std::string::npos)
      {
        static_cast<ShortLegacyFile*>(self)->Heard->Text =
          "its numbers are fewer than its header says, or damaged";
      }
    });
    this->Tag = this->Window->AddObserver(vtkCommand::WarningEvent, this->Command);
  }
  ~ShortLegacyFile()
  {
    this->Window->RemoveObserver(this->Tag);
    vtkObject::SetGlobalWarningDisplay(this->Shown);
  }
  ShortLegacyFile(const ShortLegacyFile&) = delete;
  void operator=(const ShortLegacyFile&) = delete;

private:
  Complaint* Heard;
  vtkTypeBool Shown;
  unsigned long Tag = 0;
  vtkNew<vtkCallbackCommand> Command;
  vtkSmartPointer<vtkOutputWindow> Window{ vtkOutputWindow::GetInstance() };
};

/// Tells the files, in the order of the slices.
class SliceReader : public vtkDICOMImageReader
{
public:
  static SliceReader* New() { VTK_STANDARD_NEW_BODY(SliceReader); }
  vtkTypeMacro(SliceReader, vtkDICOMImageReader);
  using vtkDICOMImageReader::GetDICOMFileName;
  using vtkDICOMImageReader::GetNumberOfDICOMFileNames;
};

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

std::string ReadStart(const char* path)
{
  std::string bytes(LargestHeader, '\0');
  vtksys::ifstream file(path, std::ios::in | std::ios::binary);
  file.read(&bytes[0], static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// Whether a file is one of DICOM.
bool IsSlice(const char* path)
{
  constexpr std::size_t preamble = 128;
  std::string bytes(preamble + 4, '\0');
  vtksys::ifstream file(path, std::ios::in | std::ios::binary);
  file.read(&bytes[0], static_cast<std::streamsize>(bytes.size()));
  return file && bytes.compare(preamble, 4, "DICM") == 0;
}

/// Whether a file begins with more than any key of MetaImage, and no space. vtkMetaImageReader
/// reads the first word of .mha and .mhd files into 8000 bytes to see whether it knows them; where
/// VTK was built with GCC 10 or before, as its wheels are, nothing stops it there.
bool BeginsWithLongWord(const char* path)
{
  return ReadStart(path).find_first_of(" \t\n\v\f\r") >= 4000;
}

/// "key<separator> value" lines of the header of a text format, until an empty line. Keys of NRRD,
/// and the words of the format after them, are the same in capital letters: small ones are given.
vtkFFDDataFiles::Fields ReadFields(const char* path, char separator)
{
  vtkFFDDataFiles::Fields fields;
  std::istringstream lines(ReadStart(path));
  std::string line;
  const char* const blank = " \t\r";
  while (std::getline(lines, line) && line.find_first_not_of(blank) != std::string::npos)
  {
    const std::size_t at = line.find(separator);
    if (at != std::string::npos)
    {
      const std::size_t end = line.find_last_not_of(blank, at == 0 ? 0 : at - 1);
      const std::size_t from = line.find_first_not_of(blank, at + 1);
      std::string key = line.substr(0, end + 1);
      std::string value = from == std::string::npos
        ? std::string()
        : line.substr(from, line.find_last_not_of(blank) + 1 - from);
      if (separator == ':')
      {
        key = vtksys::SystemTools::LowerCase(key);
        value = key == "space" || key == "encoding" || key == "endian"
          ? vtksys::SystemTools::LowerCase(value)
          : value;
      }
      fields[key] = value;
      if (line.compare(0, 15, "ElementDataFile") == 0)
      {
        break; // what follows may be the voxels
      }
    }
  }
  return fields;
}

/// The numbers of a text, whatever is between them.
std::vector<double> ReadNumbers(std::string text)
{
  for (char& c : text)
  {
    c = c == '(' || c == ')' || c == ',' || c == '\\' ? ' ' : c;
  }
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  std::string word;
  while (words >> word)
  {
    std::istringstream number(word);
    number.imbue(std::locale::classic());
    double value;
    if (vtksys::SystemTools::LowerCase(word) == "nan")
    {
      numbers.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    else if (number >> value)
    {
      numbers.push_back(value);
    }
  }
  return numbers;
}

glm::dvec3 ToVector(const std::vector<double>& numbers, std::size_t first)
{
  return { numbers[first], numbers[first + 1], numbers[first + 2] };
}

/// Rows of the matrix are the directions of the axes of the image.
bool PlaceMetaImage(
  const vtkFFDDataFiles::Fields& fields, const glm::dvec3& spacing, Placement& place)
{
  const std::vector<double> matrix =
    ReadNumbers(Find(fields, { "TransformMatrix", "Rotation", "Orientation" }));
  const std::vector<double> origin = ReadNumbers(Find(fields, { "Offset", "Position", "Origin" }));
  if (matrix.size() != 9)
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    place.Steps[a] = spacing[a] * ToVector(matrix, 3 * static_cast<std::size_t>(a));
  }
  place.Origin = origin.size() == 3 ? ToVector(origin, 0) : glm::dvec3(0.0);
  return true;
}

/// How many files the data of a NRRD are in, where it says that these are several.
int CountSlices(const vtkFFDDataFiles::Fields& fields)
{
  const std::vector<double> sizes = ReadNumbers(Find(fields, { "sizes" }));
  return sizes.empty() ? 1 : static_cast<int>(glm::clamp(sizes.back(), 1.0, 65536.0));
}

/// Finds what would hang VTK's reader: a header that holds zeros or does not end, or data files
/// that do not end; and sizes that are none. Empty: none.
std::string FindNrrdProblem(const char* path)
{
  const std::string text = ReadStart(path);
  const std::size_t end = std::min(text.find("\n\n"), text.find("\n\r\n"));
  if (end == std::string::npos && (text.size() == LargestHeader || text.back() != '\n'))
  {
    return "it cannot be read: its header does not end (with an empty line, or with the last line "
           "of "
           "the file)";
  }
  if (text.substr(0, end).find('\0') != std::string::npos)
  {
    return "it cannot be read: its header holds zero bytes";
  }
  const vtkFFDDataFiles::Fields fields = ReadFields(path, ':');
  return vtkFFDDataFiles::FindNrrdProblem(path, text, fields, 0.0, CountSlices(fields));
}

/// Position of the first voxel of a NRRD without a "space origin", along its own axes from `first`
/// on. "axis mins" are where the voxels begin, that is the border of the first cell or, where
/// "centers" says so, the first node; cells are the default, as in teem and ITK.
glm::dvec3 FindAxisMins(
  const vtkFFDDataFiles::Fields& fields, std::size_t first, const glm::dvec3& spacing)
{
  std::vector<double> mins = ReadNumbers(Find(fields, { "axis mins", "axismins" }));
  const std::vector<std::string> centers =
    vtkFFDDataFiles::ToWords(Find(fields, { "centers", "centerings" }));
  glm::dvec3 origin(0.0);
  for (std::size_t a = 0; a < 3 && mins.size() >= first + 3; ++a)
  {
    const bool isNode = centers.size() > first + a && centers[first + a] == "node";
    const int axis = static_cast<int>(a);
    origin[axis] = mins[first + a] + (isNode ? 0.0 : 0.5 * spacing[axis]);
    origin[axis] = std::isfinite(origin[axis]) ? origin[axis] : 0.0;
  }
  return origin;
}

bool PlaceNrrd(const vtkFFDDataFiles::Fields& fields, int rows, bool turnsRows,
  const vtkFFDStoredVoxels& stored, Placement& place)
{
  const std::vector<double> steps = ReadNumbers(Find(fields, { "space directions" }));
  const std::vector<double> origin = ReadNumbers(Find(fields, { "space origin" }));
  const std::vector<double> spacings = ReadNumbers(Find(fields, { "spacings" }));
  const bool hasSpacings = spacings.size() == 3 || spacings.size() == 4;
  if (steps.empty() && stored.Components > 0 &&
    (hasSpacings || !Find(fields, { "axis mins", "axismins" }).empty()))
  {
    // That of the axis without a direction may be "nan".
    const auto axis = static_cast<std::size_t>(stored.FirstAxis);
    glm::dvec3 spacing(1.0);
    for (std::size_t a = 0; hasSpacings && a < 3; ++a)
    {
      spacing[static_cast<int>(a)] = spacings[(spacings.size() == 4 ? axis : 0) + a];
      place.Steps[static_cast<int>(a)] *= spacing[static_cast<int>(a)];
    }
    place.Origin = origin.size() == 3 ? ToVector(origin, 0) : FindAxisMins(fields, axis, spacing);
    return true;
  }
  if (steps.size() != 9)
  {
    return false;
  }
  const std::string space = Find(fields, { "space" });
  glm::dvec3 toLps(1.0);
  if (space == "right-anterior-superior" || space == "ras")
  {
    toLps = FromRas;
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
    place.Origin += static_cast<double>(rows - 1) * place.Steps[1];
    place.Steps[1] = -place.Steps[1];
  }
  return true;
}

/// Whether the columns of a matrix are finite, and directions of three axes.
bool HasDirections(vtkMatrix4x4* matrix)
{
  Placement place;
  for (int r = 0; r < 3; ++r)
  {
    place.Origin[r] = matrix->GetElement(r, 3);
    for (int a = 0; a < 3; ++a)
    {
      place.Steps[a][r] = matrix->GetElement(r, a);
    }
  }
  return IsPlace(place);
}

bool PlaceNifti(vtkNIFTIImageReader* reader, const glm::dvec3& spacing, Placement& place)
{
  vtkMatrix4x4* matrix = reader->GetSFormMatrix();
  // Some programs write a code for an sform, and zeros.
  if (!matrix || (reader->GetQFormMatrix() && !HasDirections(matrix)))
  {
    matrix = reader->GetQFormMatrix();
  }
  // The lowest three bits of the header's xyzt_units are the unit of length.
  constexpr int meters = 1;
  constexpr int microns = 3;
  const int unit = reader->GetNIFTIHeader()->GetXYZTUnits() & 7;
  const double toMillimeters = unit == meters ? 1e3 : unit == microns ? 1e-3 : 1.0;
  if (!matrix)
  {
    place.Steps = glm::dmat3(0.0);
    for (int a = 0; a < 3; ++a)
    {
      place.Steps[a][a] = toMillimeters * spacing[a];
    }
    return true;
  }
  for (int r = 0; r < 3; ++r)
  {
    for (int a = 0; a < 3; ++a)
    {
      place.Steps[a][r] = toMillimeters * FromRas[r] * spacing[a] * matrix->GetElement(r, a);
    }
    place.Origin[r] = toMillimeters * FromRas[r] * matrix->GetElement(r, 3);
  }
  return true;
}

/// VTK's reader gives what is stored. A slope of zero, or none that is a number, says that this is
/// meant; colors are as they are.
Scaling FindScaling(vtkNIFTIImageReader* reader, int storedType)
{
  constexpr int rgb = 128;
  constexpr int rgba = 2304;
  const int kind = reader->GetNIFTIHeader()->GetDataType();
  const double slope = reader->GetRescaleSlope();
  const double intercept = reader->GetRescaleIntercept();
  Scaling scaling;
  if (slope != 0.0 && std::isfinite(slope) && kind != rgb && kind != rgba)
  {
    scaling.Slope = slope;
    scaling.Intercept = std::isfinite(intercept) ? intercept : 0.0;
  }
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

/// What VTK's reader does not check: it crashes on types that it does not know, and takes the
/// header for voxels where that says so.
std::string FindNiftiProblem(const char* path)
{
  constexpr std::size_t first = 348;  // bytes of the header of NIfTI-1
  constexpr std::size_t second = 540; // and NIfTI-2, which they begin with
  const std::string bytes = ReadNiftiHeader(path, second);
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

template <class From, class To>
void Rescale(const From* from, To* to, vtkIdType count, const Scaling& scaling)
{
  vtkSMPTools::For(0, count, [from, to, scaling](vtkIdType first, vtkIdType last) {
    for (vtkIdType i = first; i < last; ++i)
    {
      to[i] = static_cast<To>(scaling.Slope * static_cast<double>(from[i]) + scaling.Intercept);
    }
  });
}

/// The scalars that are meant, in the place of those that are stored.
void ReplaceScalars(vtkPointData* data, const Scaling& scaling)
{
  vtkDataArray* const stored = data->GetScalars();
  const auto meant =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(scaling.Type));
  meant->SetNumberOfComponents(stored->GetNumberOfComponents());
  meant->SetNumberOfTuples(stored->GetNumberOfTuples());
  const std::string name = stored->GetName() ? stored->GetName() : "";
  const vtkIdType count = stored->GetNumberOfValues();
  void* const to = meant->GetVoidPointer(0);
  switch (stored->GetDataType())
  {
    vtkTemplateMacro(scaling.Type == VTK_FLOAT
        ? Rescale(static_cast<const VTK_TT*>(stored->GetVoidPointer(0)), static_cast<float*>(to),
            count, scaling)
        : Rescale(static_cast<const VTK_TT*>(stored->GetVoidPointer(0)), static_cast<double*>(to),
            count, scaling));
    default:
      return;
  }
  meant->SetName(name.c_str());
  data->SetScalars(meant);
}

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
      ReadNumbers(bytes.substr(std::min(at + 8, bytes.size()), 40));
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

Slice ReadSlice(const char* path, vtkCommand* complaint)
{
  vtkNew<vtkDICOMImageReader> reader;
  reader->AddObserver(vtkCommand::ErrorEvent, complaint);
  reader->AddObserver(vtkCommand::WarningEvent, complaint);
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

} // namespace

//------------------------------------------------------------------------------
class vtkFFDVolumeReader::vtkInternals
{
public:
  vtkSmartPointer<vtkAlgorithm> Reader;
  vtkNew<Complaint> Heard;
  Placement Place;
  bool HasPlace = false;
  Scaling Scales;
  vtkFFDStoredVoxels Stored;
  vtkMTimeType OpenedTime = 0;
  std::string Problem;
  std::string Warning;

  void Watch(vtkAlgorithm* reader)
  {
    reader->AddObserver(vtkCommand::ErrorEvent, this->Heard);
    reader->AddObserver(vtkCommand::WarningEvent, this->Heard);
    this->Reader = reader;
  }

  template <class ReaderT>
  ReaderT* Make(const char* path)
  {
    vtkNew<ReaderT> reader;
    reader->SetFileName(path);
    this->Watch(reader);
    return reader;
  }

  bool Open(const char* path);
  void PlaceSlices(SliceReader* reader, int rows, int slices, const glm::dvec3& spacing);
  void FindPlace(const char* path);
  bool LeaveOutDirections();
  int GetStoredType();
  bool CheckSlices(SliceReader* reader, int slices);
  vtkSmartPointer<vtkImageData> ReadStored();
};

//------------------------------------------------------------------------------
/// Choose a reader and let it read the header.
bool vtkFFDVolumeReader::vtkInternals::Open(const char* path)
{
  using vtksys::SystemTools;
  this->Reader = nullptr;
  this->HasPlace = false;
  this->Scales = Scaling();
  this->Stored = vtkFFDStoredVoxels();
  this->Problem.clear();
  this->Warning.clear();
  this->Heard->Text.clear();
  if (!path || !*path)
  {
    this->Problem = "no file is named; call SetFileName()";
    return false;
  }
  if (!SystemTools::FileExists(path))
  {
    this->Problem = "there is no such file or folder";
    return false;
  }
  const std::string ending = SystemTools::LowerCase(SystemTools::GetFilenameLastExtension(path));
  const bool folder = SystemTools::FileIsDirectory(path);
  std::size_t size = 0;
  if (folder)
  {
    this->Problem = vtkFFDDataFiles::FindFolderProblem(path);
  }
  else if (vtkFFDFileAccess::FindSize(path, size, this->Problem))
  {
    this->Problem = ending == ".hdr" || ending == ".img" || ending == ".gz"
      ? vtkFFDDataFiles::FindPairProblem(path)
      : std::string();
  }
  if (!this->Problem.empty())
  {
    return false;
  }
  if (!folder && IsSlice(path))
  {
    return this->Open(SystemTools::GetFilenamePath(SystemTools::CollapseFullPath(path)).c_str());
  }
  if (folder)
  {
    vtkNew<SliceReader> slices;
    slices->SetDirectoryName(path);
    this->Watch(slices);
  }
  else if (ending == ".vti")
  {
    auto* xml = this->Make<vtkXMLImageDataReader>(path);
    xml->SetReaderErrorObserver(this->Heard);
    xml->SetParserErrorObserver(this->Heard);
  }
  else if (ending == ".vtk")
  {
    this->Make<vtkStructuredPointsReader>(path);
  }
  else if (vtkNew<vtkNIFTIImageReader>()->CanReadFile(path))
  {
    this->Problem = FindNiftiProblem(path);
    if (!this->Problem.empty())
    {
      return false;
    }
    this->Make<vtkNIFTIImageReader>(path);
  }
  else if (ReadStart(path).compare(0, 4, "NRRD") == 0)
  {
    // Not asked by CanReadFile(), which reads as far as the first line goes.
    this->Problem = FindNrrdProblem(path);
    if (!this->Problem.empty())
    {
      return false;
    }
    this->Make<PlainNrrdReader>(path);
  }
  else
  {
    vtkSmartPointer<vtkImageReader2> found;
    if ((ending != ".mha" && ending != ".mhd") || !BeginsWithLongWord(path))
    {
      found.TakeReference(vtkImageReader2Factory::CreateImageReader2(path));
    }
    if (!found)
    {
      this->Problem = "VTK has no reader for it (.vti, .vtk, .mhd, .nii, .nrrd and image files are "
                      "known, and folders of DICOM slices)";
      return false;
    }
    found->SetFileName(path);
    this->Watch(found);
  }
  this->Reader->UpdateInformation();
  if (this->Heard->Text.empty() && vtkXMLImageDataReader::SafeDownCast(this->Reader))
  {
    this->Heard->Text = vtkFFDDataFiles::FindXmlProblem(path);
  }
  if (this->Heard->Text.empty())
  {
    this->FindPlace(path);
  }
  if (vtkMetaImageReader::SafeDownCast(this->Reader) &&
    this->Heard->Text.compare(0, 17, "Unknown data type") == 0)
  {
    this->Heard->Text = "VTK does not know its ElementType '" +
      Find(ReadFields(path, '='), { "ElementType" }) +
      "'; write whole numbers of up to 4 bytes, float or double";
  }
  if (!this->Heard->Text.empty())
  {
    this->Problem =
      folder ? "no DICOM slices were found in it" : "it cannot be read: " + this->Heard->Text;
  }
  return this->Problem.empty();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeReader::vtkInternals::FindPlace(const char* path)
{
  auto* dicom = SliceReader::SafeDownCast(this->Reader);
  auto* nifti = vtkNIFTIImageReader::SafeDownCast(this->Reader);
  auto* nrrd = vtkNrrdReader::SafeDownCast(this->Reader);
  const bool isMeta = vtkMetaImageReader::SafeDownCast(this->Reader) != nullptr;
  std::string text;
  vtkFFDDataFiles::Fields fields;
  if (nrrd || isMeta)
  {
    text = ReadStart(path);
    fields = ReadFields(path, nrrd ? ':' : '=');
  }
  vtkInformation* info = this->Reader->GetOutputInformation(0);
  if (!info->Has(Pipeline::WHOLE_EXTENT()) && nrrd)
  {
    this->Problem = "it cannot be read: VTK does not know its type '" + Find(fields, { "type" }) +
      "'; write whole numbers, float or double";
    return;
  }
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  glm::dvec3 spacing(1.0);
  info->Get(Pipeline::WHOLE_EXTENT(), extent);
  if (info->Has(vtkDataObject::SPACING()))
  {
    info->Get(vtkDataObject::SPACING(), &spacing.x);
  }
  int size[3];
  for (int a = 0; a < 3; ++a)
  {
    size[a] = extent[2 * a + 1] - extent[2 * a] + 1;
  }
  int components = 1;
  auto* numbers = vtkImageReader2::SafeDownCast(this->Reader);
  if (numbers)
  {
    components = numbers->GetNumberOfScalarComponents();
  }
  if (nrrd)
  {
    this->Stored = vtkFFDDataFiles::FindNrrdVoxels(path, text, fields);
    if (this->Stored.Components > 0)
    {
      std::copy_n(this->Stored.Size.data(), 3, size);
      components = this->Stored.Components;
    }
  }
  if (dicom && dicom->GetNumberOfDICOMFileNames() == 0)
  {
    this->Problem = "no DICOM slices were found in it";
    return;
  }
  if (size[0] < 2 || size[1] < 2 || size[2] < 2)
  {
    std::ostringstream problem;
    problem << "it is " << size[0] << " x " << size[1] << " x " << size[2]
            << " voxels; a volume has at least two along each axis";
    this->Problem = problem.str();
    return;
  }
  this->Place = Placement();
  double bytes = 1.0 * size[0] * size[1] * size[2];
  if (isMeta)
  {
    this->Stored = vtkFFDDataFiles::FindMetaImageVoxels(path, text, fields);
  }
  if (numbers)
  {
    bytes *= 1.0 * components * vtkDataArray::GetDataTypeSize(this->GetStoredType());
  }
  if (dicom)
  {
    this->PlaceSlices(dicom, size[1], size[2], spacing);
  }
  else if (nifti)
  {
    this->HasPlace = PlaceNifti(nifti, spacing, this->Place);
    this->Scales = FindScaling(nifti, nifti->GetDataScalarType());
  }
  else if (nrrd)
  {
    this->Problem =
      vtkFFDDataFiles::FindNrrdProblem(path, text, fields, bytes, CountSlices(fields));
    const bool isOurs = this->Stored.Form != vtkFFDStoredVoxels::OF_VTK;
    this->HasPlace = PlaceNrrd(
      fields, size[1], nrrd->GetFileLowerLeft() == 0 && !isOurs, this->Stored, this->Place);
  }
  else if (isMeta)
  {
    this->Problem = vtkFFDDataFiles::FindMetaImageProblem(path, text, fields, bytes, size[2]);
    if (this->Problem.empty() && this->Stored.Type >= 0 &&
      this->Stored.Form == vtkFFDStoredVoxels::OF_VTK)
    {
      this->Problem = "its ElementType '" + Find(fields, { "ElementType" }) +
        "' is read from one file without a HeaderSize only; write MET_INT or MET_UINT";
    }
    this->HasPlace = PlaceMetaImage(fields, spacing, this->Place);
  }
}

//------------------------------------------------------------------------------
/// VTK's type of the scalars in the file.
int vtkFFDVolumeReader::vtkInternals::GetStoredType()
{
  auto* const reader = vtkImageReader2::SafeDownCast(this->Reader);
  return this->Stored.Type >= 0 ? this->Stored.Type : reader->GetDataScalarType();
}

//------------------------------------------------------------------------------
/// Leaves out directions that are none, and takes 1 for a spacing and 0 for an origin that VTK's
/// reader gives and that are none; returns whether there were any.
bool vtkFFDVolumeReader::vtkInternals::LeaveOutDirections()
{
  const bool bad = this->HasPlace && !IsPlace(this->Place);
  this->HasPlace = this->HasPlace && !bad;
  vtkInformation* const info = this->Reader->GetOutputInformation(0);
  if (this->HasPlace || !info->Has(vtkDataObject::SPACING()) || !info->Has(vtkDataObject::ORIGIN()))
  {
    return bad;
  }
  glm::dvec3 spacing(1.0);
  info->Get(vtkDataObject::SPACING(), &spacing.x);
  for (int a = 0; bad && this->Stored.Components > 0 && a < 3; ++a)
  {
    spacing[a] = glm::length(this->Place.Steps[a]); // VTK's may be of other axes
  }
  const double* const origin = info->Get(vtkDataObject::ORIGIN());
  Placement place;
  bool replaced = bad;
  for (int a = 0; a < 3; ++a)
  {
    const bool hasStep = std::isfinite(spacing[a]) && spacing[a] != 0.0;
    const bool hasOrigin = std::isfinite(origin[a]);
    place.Steps[a][a] = hasStep ? spacing[a] : 1.0;
    place.Origin[a] = hasOrigin ? origin[a] : 0.0;
    replaced = replaced || !hasStep || !hasOrigin;
  }
  if (replaced)
  {
    this->Place = place;
    this->HasPlace = true;
  }
  return replaced;
}

//------------------------------------------------------------------------------
/// The image of voxels that are not left to VTK's reader; null after a problem.
vtkSmartPointer<vtkImageData> vtkFFDVolumeReader::vtkInternals::ReadStored()
{
  auto* reader = vtkImageReader2::SafeDownCast(this->Reader);
  vtkInformation* const info = reader->GetOutputInformation(0);
  auto image = vtkSmartPointer<vtkImageData>::New();
  const std::array<int, 3>& size = this->Stored.Size;
  const bool isKnown = this->Stored.Components > 0;
  if (isKnown)
  {
    image->SetDimensions(size.data());
  }
  else
  {
    image->SetExtent(info->Get(Pipeline::WHOLE_EXTENT()));
  }
  image->SetSpacing(info->Get(vtkDataObject::SPACING()));
  image->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
  image->AllocateScalars(this->GetStoredType(),
    isKnown ? this->Stored.Components : reader->GetNumberOfScalarComponents());
  vtkDataArray* const numbers = image->GetPointData()->GetScalars();
  if (!numbers || numbers->GetNumberOfTuples() < image->GetNumberOfPoints())
  {
    throw std::bad_alloc();
  }
  if (vtkMetaImageReader::SafeDownCast(reader))
  {
    numbers->SetName("MetaImage"); // as VTK's reader
  }
  const std::string problem = this->Stored.Read(numbers);
  if (!problem.empty())
  {
    this->Problem = "it cannot be read: " + problem;
    return nullptr;
  }
  return image;
}

//------------------------------------------------------------------------------
/// Slices must be of one size and whole; where they are not at equal distances a warning tells it.
bool vtkFFDVolumeReader::vtkInternals::CheckSlices(SliceReader* reader, int slices)
{
  const auto parse = [](const char* path) { return vtkFFDSliceHeader::Parse(ReadStart(path)); };
  const auto name = [](const char* path) {
    return "the slice '" + vtksys::SystemTools::GetFilenameName(path) + "' ";
  };
  const auto describe = [](const vtkFFDSliceHeader& slice) {
    return std::to_string(slice.Columns) + " x " + std::to_string(slice.Rows) + " pixels of " +
      std::to_string(slice.Samples) + " x " + std::to_string(slice.Bits) + " bits";
  };
  const vtkFFDSliceHeader first = parse(reader->GetDICOMFileName(0));
  std::vector<glm::dvec3> places;
  for (int i = 0; i < slices; ++i)
  {
    const char* const path = reader->GetDICOMFileName(i);
    const vtkFFDSliceHeader slice = parse(path);
    std::size_t size = 0;
    if (slice.HasSize() && first.HasSize() && !slice.HasSizeOf(first))
    {
      this->Problem = name(path) + "has " + describe(slice) + ", '" +
        vtksys::SystemTools::GetFilenameName(reader->GetDICOMFileName(0)) + "' " + describe(first) +
        "; slices of one size are needed, so move the others into another folder";
      return false;
    }
    if (vtkFFDFileAccess::FindSize(path, size, this->Problem) && size < slice.End)
    {
      this->Problem = name(path) + "is not whole: it has " + std::to_string(size) + " bytes of " +
        std::to_string(slice.End);
    }
    if (!this->Problem.empty())
    {
      return false;
    }
    if (slice.HasPosition)
    {
      places.emplace_back(slice.Position[0], slice.Position[1], slice.Position[2]);
    }
  }
  if (slices < 3 || places.size() != static_cast<std::size_t>(slices))
  {
    return true;
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
    this->Warning = text.str();
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeReader::vtkInternals::PlaceSlices(
  SliceReader* reader, int rows, int slices, const glm::dvec3& spacing)
{
  const Slice first = ReadSlice(reader->GetDICOMFileName(0), this->Heard);
  const Slice last = ReadSlice(reader->GetDICOMFileName(slices - 1), this->Heard);
  // Implicit, and explicit of either byte order.
  if (first.Syntax.compare(0, 17, "1.2.840.10008.1.2") == 0 && first.Syntax.size() > 17 &&
    first.Syntax != "1.2.840.10008.1.2.1" && first.Syntax != "1.2.840.10008.1.2.2")
  {
    this->Problem = "its slices are compressed (transfer syntax " + first.Syntax +
      "), which VTK cannot read; write them uncompressed first, for instance with gdcmconv --raw";
    return;
  }
  if (!this->CheckSlices(reader, slices))
  {
    return;
  }
  glm::dvec3 distance = spacing;
  ReadPixelSpacing(reader->GetDICOMFileName(0), distance);
  // VTK's reader turns the rows, so that the last one comes first, and sorts the slices against the
  // normal of the plane.
  this->Place.Steps[0] = distance.x * first.Right;
  this->Place.Steps[1] = -distance.y * first.Down;
  this->Place.Steps[2] = (last.Position - first.Position) / static_cast<double>(slices - 1);
  if (!(glm::length(this->Place.Steps[2]) > 0.0))
  {
    this->Place.Steps[2] = -distance.z * glm::cross(first.Right, first.Down);
  }
  this->Place.Origin = first.Position - static_cast<double>(rows - 1) * this->Place.Steps[1];
  this->HasPlace = true;
}

//------------------------------------------------------------------------------
vtkFFDVolumeReader::vtkFFDVolumeReader()
  : Internals(new vtkInternals)
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkFFDVolumeReader::~vtkFFDVolumeReader() { this->SetFileName(nullptr); }

//------------------------------------------------------------------------------
void vtkFFDVolumeReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Problem: " << this->Internals->Problem << "\n";
}

//------------------------------------------------------------------------------
const char* vtkFFDVolumeReader::GetProblem() { return this->Internals->Problem.c_str(); }

//------------------------------------------------------------------------------
int vtkFFDVolumeReader::Fail()
{
  vtkErrorMacro(<< (this->FileName ? this->FileName : "(no file)") << ": "
                << this->Internals->Problem << ".");
  this->GetOutputDataObject(0)->Initialize();
  return 0;
}

//------------------------------------------------------------------------------
int vtkFFDVolumeReader::CanReadFile(const char* fileName)
{
  const vtkFFDClassicLocale numbers;
  return vtkFFDGuarded(
    this, "CanReadFile", 0, [&] { return vtkInternals().Open(fileName) ? 1 : 0; });
}

//------------------------------------------------------------------------------
int vtkFFDVolumeReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  const vtkFFDClassicLocale numbers;
  vtkInternals& in = *this->Internals;
  if (!in.Reader || in.OpenedTime != this->GetMTime())
  {
    const bool opened = in.Open(this->FileName);
    in.OpenedTime = this->GetMTime();
    if (!opened)
    {
      in.Reader = nullptr;
      return this->Fail();
    }
    if (!in.Warning.empty())
    {
      vtkWarningMacro(<< this->FileName << ": " << in.Warning << ".");
    }
    if (in.LeaveOutDirections())
    {
      vtkWarningMacro(
        << this->FileName
        << ": the directions, spacing or origin of its axes are singular, zero or not "
           "finite; they are left out.");
    }
  }
  vtkInformation* info = output->GetInformationObject(0);
  vtkInformation* from = in.Reader->GetOutputInformation(0);
  info->CopyEntry(from, Pipeline::WHOLE_EXTENT());
  info->CopyEntry(from, vtkDataObject::ORIGIN());
  info->CopyEntry(from, vtkDataObject::SPACING());
  info->CopyEntry(from, vtkDataObject::DIRECTION());
  if (from->Has(vtkDataObject::POINT_DATA_VECTOR()))
  {
    info->CopyEntry(from, vtkDataObject::POINT_DATA_VECTOR(), 1);
  }
  if (in.Stored.Components > 0)
  {
    const std::array<int, 3>& size = in.Stored.Size;
    info->Set(Pipeline::WHOLE_EXTENT(), 0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1);
    vtkDataObject::SetPointDataActiveScalarInfo(info, -1, in.Stored.Components);
  }
  if (in.Stored.Type >= 0)
  {
    vtkDataObject::SetPointDataActiveScalarInfo(info, in.Stored.Type, -1);
  }
  if (!in.Scales.IsNone())
  {
    vtkDataObject::SetPointDataActiveScalarInfo(info, in.Scales.Type, -1);
  }
  if (in.HasPlace)
  {
    double spacing[3];
    double direction[9];
    for (int a = 0; a < 3; ++a)
    {
      spacing[a] = glm::length(in.Place.Steps[a]);
      for (int r = 0; r < 3; ++r)
      {
        direction[3 * r + a] = in.Place.Steps[a][r] / spacing[a];
      }
    }
    info->Set(vtkDataObject::ORIGIN(), &in.Place.Origin.x, 3);
    info->Set(vtkDataObject::SPACING(), spacing, 3);
    info->Set(vtkDataObject::DIRECTION(), direction, 9);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDVolumeReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  const vtkFFDClassicLocale numbers;
  vtkInternals& in = *this->Internals;
  vtkInformation* info = output->GetInformationObject(0);
  vtkImageData* image = vtkImageData::GetData(info);
  image->Initialize();
  if (!in.Reader)
  {
    return 0; // has been told
  }
  vtkSmartPointer<vtkImageData> read;
  try
  {
    if (in.Stored.Form != vtkFFDStoredVoxels::OF_VTK)
    {
      read = in.ReadStored();
    }
    else
    {
      const std::unique_ptr<ShortLegacyFile> listens(
        vtkStructuredPointsReader::SafeDownCast(in.Reader) ? new ShortLegacyFile(in.Heard)
                                                           : nullptr);
      in.Reader->Update();
      read = vtkImageData::SafeDownCast(in.Reader->GetOutputDataObject(0));
    }
  }
  catch (const std::exception&)
  {
    in.Heard->Text = "there is not enough memory for it";
  }
  if (!in.Heard->Text.empty())
  {
    in.Problem = "it cannot be read: " + in.Heard->Text;
  }
  else if (in.Problem.empty() &&
    (!read || read->GetNumberOfPoints() == 0 || !read->GetPointData()->GetScalars()))
  {
    in.Problem = "it holds no image with point scalars";
  }
  if (!in.Problem.empty())
  {
    in.Reader = nullptr;
    return this->Fail();
  }
  image->ShallowCopy(read);
  if (!in.Scales.IsNone())
  {
    ReplaceScalars(image->GetPointData(), in.Scales);
  }
  vtkFFDFindArrayRanges(image->GetPointData());
  if (in.HasPlace)
  {
    image->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
    image->SetSpacing(info->Get(vtkDataObject::SPACING()));
    image->SetDirectionMatrix(info->Get(vtkDataObject::DIRECTION()));
  }
  // The voxels live on in the output alone.
  in.Reader->GetOutputDataObject(0)->ReleaseData();
  return 1;
}
