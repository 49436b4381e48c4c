// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeReader.h"

#include "vtkFFDArrayRanges.h"
#include "vtkFFDClassicLocale.h"
#include "vtkFFDDicomSlices.h"
#include "vtkFFDFileAccess.h"
#include "vtkFFDGuard.h"
#include "vtkFFDImageDataFile.h"
#include "vtkFFDMetaImageFile.h"
#include "vtkFFDNiftiFile.h"
#include "vtkFFDNrrdFile.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkImageReader2Collection.h"
#include "vtkImageReader2Factory.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <glm/geometric.hpp>

#include <vtksys/SystemTools.hxx>

#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDVolumeReader);

namespace
{

using Pipeline = vtkStreamingDemandDrivenPipeline;
using Placement = vtkFFDVolumeFile::Placement;

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

/// Lets VTK's objects tell of errors, by events, where a program has turned that off for itself by
/// vtkObject::GlobalWarningDisplayOff(). What the executive of the reader adds is not printed.
/// Several threads may read.
class ErrorsTold
{
public:
  explicit ErrorsTold(vtkAlgorithm* reader)
    : Executive(reader->GetExecutive())
  {
    State& state = GetState();
    const std::lock_guard<std::mutex> lock(state.Mutex);
    if (state.Readers++ == 0)
    {
      state.TurnedOn = !vtkObject::GetGlobalWarningDisplay();
      vtkObject::GlobalWarningDisplayOn();
    }
    vtkNew<vtkCallbackCommand> ignore;
    this->Tag = this->Executive->AddObserver(vtkCommand::ErrorEvent, ignore);
  }
  ~ErrorsTold()
  {
    this->Executive->RemoveObserver(this->Tag);
    State& state = GetState();
    const std::lock_guard<std::mutex> lock(state.Mutex);
    if (--state.Readers == 0 && state.TurnedOn)
    {
      vtkObject::GlobalWarningDisplayOff();
    }
  }
  ErrorsTold(const ErrorsTold&) = delete;
  void operator=(const ErrorsTold&) = delete;

private:
  struct State
  {
    std::mutex Mutex;
    int Readers = 0;
    bool TurnedOn = false;
  };
  static State& GetState()
  {
    static State state;
    return state;
  }

  vtkSmartPointer<vtkExecutive> Executive;
  unsigned long Tag = 0;
};

/// The reader that vtkImageReader2Factory finds, or null. What the others say of the file, that it
/// is none of theirs, is not printed. They are the factory's own, for one thread at a time.
vtkSmartPointer<vtkImageReader2> FindReader(const std::string& path)
{
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  vtkNew<vtkImageReader2Collection> asked;
  vtkImageReader2Factory::GetRegisteredReaders(asked);
  std::vector<std::pair<vtkImageReader2*, unsigned long>> observed;
  vtkNew<vtkCallbackCommand> ignore;
  vtkCollectionSimpleIterator at;
  asked->InitTraversal(at);
  while (vtkImageReader2* reader = asked->GetNextImageReader2(at))
  {
    for (const unsigned long event : { vtkCommand::ErrorEvent, vtkCommand::WarningEvent })
    {
      observed.emplace_back(reader, reader->AddObserver(event, ignore));
    }
  }
  vtkSmartPointer<vtkImageReader2> found;
  found.TakeReference(vtkImageReader2Factory::CreateImageReader2(path.c_str()));
  for (const auto& [reader, tag] : observed)
  {
    reader->RemoveObserver(tag);
  }
  return found;
}

/// A file of MetaImage, or of another format that vtkImageReader2Factory knows; else null.
std::unique_ptr<vtkFFDVolumeFile> OpenByFactory(const std::string& path, vtkCommand* errors)
{
  const vtkSmartPointer<vtkImageReader2> found =
    vtkFFDMetaImageFile::BeginsWithLongWord(path) ? nullptr : FindReader(path);
  if (!found)
  {
    return nullptr;
  }
  found->SetFileName(path.c_str());
  auto file = vtkFFDMetaImageFile::Open(path, found, errors);
  return file ? std::move(file) : std::make_unique<vtkFFDVolumeFile>(path, found, errors);
}

/// The file with the reader of its format, or null.
std::unique_ptr<vtkFFDVolumeFile> OpenFile(const std::string& path, vtkCommand* errors)
{
  std::unique_ptr<vtkFFDVolumeFile> file;
  for (const auto open :
    { vtkFFDImageDataFile::Open, vtkFFDNiftiFile::Open, vtkFFDNrrdFile::Open, OpenByFactory })
  {
    file = file ? std::move(file) : open(path, errors);
  }
  return file;
}

/// Why no reader takes a file: the name tells what it should be, or it does not.
std::string FindUnknownProblem(const std::string& path)
{
  const std::string name = vtksys::SystemTools::LowerCase(path);
  for (const char* ending :
    { ".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz", ".nrrd", ".nhdr", ".mha", ".mhd",
      ".vtk", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".dcm" })
  {
    if (vtksys::SystemTools::StringEndsWith(name, ending))
    {
      return std::string("it cannot be read: its content is not what '") + ending +
        "' says; it is damaged, or a file of another kind";
    }
  }
  return "VTK has no reader for it (.vti, .vtk, .mhd, .nii, .nrrd and image files are known, and "
         "folders of DICOM slices)";
}

/// What an exception of VTK's readers means.
std::string ExplainException(const std::exception& exception)
{
  const bool noMemory = dynamic_cast<const std::bad_alloc*>(&exception) ||
    dynamic_cast<const std::length_error*>(&exception);
  return noMemory ? "there is not enough memory for it" : "it is damaged";
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDVolumeReader::vtkInternals
{
public:
  vtkNew<Complaint> Heard;
  std::unique_ptr<vtkFFDVolumeFile> File;
  vtkFFDVolumeFile::Header Header;
  vtkMTimeType OpenedTime = 0;
  std::string Problem;

  bool Open(const char* path);
  bool LeaveOutDirections();
};

//------------------------------------------------------------------------------
/// Choose a reader and let it read the header.
bool vtkFFDVolumeReader::vtkInternals::Open(const char* path)
{
  using vtksys::SystemTools;
  this->File = nullptr;
  this->Header = vtkFFDVolumeFile::Header();
  this->Problem.clear();
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
  const bool folder = SystemTools::FileIsDirectory(path);
  std::size_t size = 0;
  if (!folder && vtkFFDFileAccess::FindSize(path, size, this->Problem))
  {
    this->Problem = size == 0 ? "it is empty" : vtkFFDNiftiFile::FindPairProblem(path);
  }
  if (!this->Problem.empty())
  {
    return false;
  }
  if (!folder && vtkFFDDicomSlices::IsSlice(path))
  {
    return this->Open(SystemTools::GetFilenamePath(SystemTools::CollapseFullPath(path)).c_str());
  }
  this->File = folder ? vtkFFDDicomSlices::Open(path, this->Heard) : OpenFile(path, this->Heard);
  this->Problem = this->File ? this->File->FindProblem() : FindUnknownProblem(path);
  if (!this->Problem.empty())
  {
    return false;
  }
  const ErrorsTold errors(this->File->GetReader());
  this->File->GetReader()->UpdateInformation();
  if (this->Heard->Text.empty())
  {
    this->Problem = this->File->ReadHeader(this->Header);
  }
  if (!this->Heard->Text.empty())
  {
    this->Problem = this->File->Explain(this->Heard->Text);
  }
  return this->Problem.empty();
}

//------------------------------------------------------------------------------
/// Leaves out directions that are none, and takes 1 for a spacing and 0 for an origin that VTK's
/// reader gives and that are none; returns whether there were any.
bool vtkFFDVolumeReader::vtkInternals::LeaveOutDirections()
{
  std::optional<Placement>& place = this->Header.Place;
  const std::optional<Placement> told = place;
  const bool bad = told && !told->IsValid();
  if (bad)
  {
    place.reset();
  }
  vtkInformation* const info = this->File->GetReader()->GetOutputInformation(0);
  if (place)
  {
    return bad;
  }
  // Readers may tell one without the other.
  glm::dvec3 spacing(1.0);
  glm::dvec3 origin(0.0);
  if (info->Has(vtkDataObject::SPACING()))
  {
    info->Get(vtkDataObject::SPACING(), &spacing.x);
  }
  if (info->Has(vtkDataObject::ORIGIN()))
  {
    info->Get(vtkDataObject::ORIGIN(), &origin.x);
  }
  for (int a = 0; bad && this->Header.Stored.Components > 0 && a < 3; ++a)
  {
    spacing[a] = glm::length(told->Steps[a]); // VTK's may be of other axes
  }
  Placement plain;
  bool replaced = bad;
  for (int a = 0; a < 3; ++a)
  {
    const bool hasStep = std::isfinite(spacing[a]) && spacing[a] != 0.0;
    const bool hasOrigin = std::isfinite(origin[a]);
    plain.Steps[a][a] = hasStep ? spacing[a] : 1.0;
    plain.Origin[a] = hasOrigin ? origin[a] : 0.0;
    replaced = replaced || !hasStep || !hasOrigin;
  }
  if (replaced)
  {
    place = plain;
  }
  return replaced;
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
  if (!in.File || in.OpenedTime != this->GetMTime())
  {
    bool opened = false;
    try
    {
      opened = in.Open(this->FileName);
    }
    catch (const std::exception& exception)
    {
      in.Problem = "it cannot be read: " + ExplainException(exception);
    }
    in.OpenedTime = this->GetMTime();
    if (!opened)
    {
      in.File = nullptr;
      return this->Fail();
    }
    if (!in.Header.Warning.empty())
    {
      vtkWarningMacro(<< this->FileName << ": " << in.Header.Warning << ".");
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
  vtkInformation* from = in.File->GetReader()->GetOutputInformation(0);
  info->CopyEntry(from, Pipeline::WHOLE_EXTENT());
  info->CopyEntry(from, vtkDataObject::ORIGIN());
  info->CopyEntry(from, vtkDataObject::SPACING());
  info->CopyEntry(from, vtkDataObject::DIRECTION());
  if (from->Has(vtkDataObject::POINT_DATA_VECTOR()))
  {
    info->CopyEntry(from, vtkDataObject::POINT_DATA_VECTOR(), 1);
  }
  if (in.Header.Stored.Components > 0)
  {
    const std::array<int, 3>& size = in.Header.Stored.Size;
    info->Set(Pipeline::WHOLE_EXTENT(), 0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1);
    vtkDataObject::SetPointDataActiveScalarInfo(info, -1, in.Header.Stored.Components);
  }
  if (in.Header.Stored.Type >= 0)
  {
    vtkDataObject::SetPointDataActiveScalarInfo(info, in.Header.Stored.Type, -1);
  }
  if (!in.Header.Scales.IsNone())
  {
    vtkDataObject::SetPointDataActiveScalarInfo(info, in.Header.Scales.Type, -1);
  }
  if (in.Header.Place)
  {
    double spacing[3];
    double direction[9];
    for (int a = 0; a < 3; ++a)
    {
      spacing[a] = glm::length(in.Header.Place->Steps[a]);
      for (int r = 0; r < 3; ++r)
      {
        direction[3 * r + a] = in.Header.Place->Steps[a][r] / spacing[a];
      }
    }
    info->Set(vtkDataObject::ORIGIN(), &in.Header.Place->Origin.x, 3);
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
  if (!in.File)
  {
    return 0; // has been told
  }
  vtkSmartPointer<vtkImageData> read;
  try
  {
    const ErrorsTold errors(in.File->GetReader());
    std::string error;
    read = in.File->Read(in.Header, error);
    in.Heard->Text = error.empty() ? in.Heard->Text : error;
  }
  catch (const std::exception& exception)
  {
    in.Heard->Text = ExplainException(exception);
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
    in.File = nullptr;
    return this->Fail();
  }
  image->ShallowCopy(read);
  if (!in.Header.Scales.IsNone())
  {
    in.Header.Scales.Apply(image->GetPointData());
  }
  vtkFFDFindArrayRanges(image->GetPointData());
  if (in.Header.Place)
  {
    image->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
    image->SetSpacing(info->Get(vtkDataObject::SPACING()));
    image->SetDirectionMatrix(info->Get(vtkDataObject::DIRECTION()));
  }
  // The voxels live on in the output alone.
  in.File->GetReader()->GetOutputDataObject(0)->ReleaseData();
  return 1;
}
