// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformReader.h"

#include "vtkFFDClassicLocale.h"
#include "vtkFFDGuard.h"
#include "vtkFFDImageDataFile.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDOptions.h"
#include "vtkFFDSplineTransform.h"
#include "vtkFFDSumTransform.h"
#include "vtkFFDTransformFiles.h"

#include "vtkBoundingBox.h"
#include "vtkCallbackCommand.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkGeneralTransform.h"
#include "vtkGridTransform.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTransform.h"
#include "vtkUTF8TextCodec.h"
#include "vtkXMLImageDataReader.h"

#include "vtksys/SystemTools.hxx"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <sstream>
#include <string>

vtkStandardNewMacro(vtkFFDTransformReader);
vtkFFDGuardedProcessRequestMacro(vtkFFDTransformReader);

namespace
{

/// A .vti may not claim more data than its size can hold: zlib's and LZMA's best are far below.
constexpr double LargestCompression = 8192.0;
constexpr double LargestLength = 1e12;
constexpr double LargestXMLOverhead = 1048576.0;

/// Collects the errors of the readers behind, for one message of ours.
void CollectError(vtkObject*, unsigned long, void* clientData, void* callData)
{
  std::string& text = *static_cast<std::string*>(clientData);
  if (text.empty() && callData)
  {
    text = static_cast<const char*>(callData);
    text = text.substr(0, text.find_last_not_of(" \n") + 1);
    const std::size_t colon = text.find("): ");
    text = colon == std::string::npos ? text : text.substr(colon + 3);
  }
}

/// A message that names what a file holds, as far as it is a text: observers in Python get no
/// message that is not UTF-8.
std::string MakeReadable(std::string message)
{
  std::istringstream bytes(message);
  if (!vtkNew<vtkUTF8TextCodec>()->IsValid(bytes))
  {
    std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c >= 0x80; }, '?');
  }
  return message;
}

vtkSmartPointer<vtkImageData> MakeImage(const ffd::TransformStep& step)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  const ffd::TransformGrid& grid = step.Grid;
  image->SetDimensions(grid.Size.x, grid.Size.y, grid.Size.z);
  image->SetOrigin(grid.Origin.x, grid.Origin.y, grid.Origin.z);
  image->SetSpacing(grid.Spacing.x, grid.Spacing.y, grid.Spacing.z);
  vtkNew<vtkDoubleArray> values;
  values->SetName("Displacement");
  values->SetNumberOfComponents(3);
  values->SetNumberOfTuples(static_cast<vtkIdType>(step.Values.size()));
  for (std::size_t i = 0; i < step.Values.size(); ++i)
  {
    values->SetTypedTuple(static_cast<vtkIdType>(i), &step.Values[i].x);
  }
  image->GetPointData()->SetScalars(values);
  return image;
}

vtkSmartPointer<vtkTransform> MakeLinear(const glm::dmat3& matrix, const glm::dvec3& offset)
{
  auto transform = vtkSmartPointer<vtkTransform>::New();
  vtkNew<vtkMatrix4x4> elements;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      elements->SetElement(row, column, matrix[column][row]);
    }
    elements->SetElement(row, 3, offset[row]);
  }
  transform->SetMatrix(elements);
  return transform;
}

/// A grid step whose axes are those of space.
vtkSmartPointer<vtkAbstractTransform> MakeGrid(const ffd::TransformStep& step, bool sum)
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(step);
  if (step.Type == ffd::TransformStep::Kind::Spline && step.Order != 3)
  {
    auto spline = vtkSmartPointer<vtkFFDSplineTransform>::New();
    spline->SetSplineOrder(step.Order);
    spline->SetRepeatBorder(sum);
    spline->SetDisplacementGrid(image);
    return spline;
  }
  if (step.Type == ffd::TransformStep::Kind::Spline)
  {
    auto lattice = vtkSmartPointer<vtkFFDLattice>::New();
    lattice->SetBorderMode(sum ? VTK_BSPLINE_EDGE : VTK_BSPLINE_ZERO);
    lattice->FromImageData(image);
    return lattice;
  }
  auto grid = vtkSmartPointer<vtkGridTransform>::New();
  grid->SetDisplacementGridData(image);
  grid->SetInterpolationModeToLinear();
  return step.IsInverse ? grid->GetInverse() : grid;
}

/// The region in which a grid defines the map: all of a field, the supported cells of a spline.
void AddRegion(const ffd::TransformGrid& grid, double layers, vtkBoundingBox& box)
{
  for (int corner = 0; corner < 8; ++corner)
  {
    glm::dvec3 index;
    for (int a = 0; a < 3; ++a)
    {
      index[a] = ((corner >> a) & 1) != 0 ? grid.Size[a] - 1 - layers : layers;
    }
    const glm::dvec3 p = grid.Origin + grid.Direction * (index * grid.Spacing);
    box.AddPoint(p.x, p.y, p.z);
  }
}

/// The region of the first grid of a chain, if it has one.
void AddFirstRegion(const std::vector<ffd::TransformStep>& steps, vtkBoundingBox& box)
{
  for (const ffd::TransformStep& step : steps)
  {
    for (const ffd::TransformTerm& term : step.Terms)
    {
      if (!box.IsValid())
      {
        AddFirstRegion(term.Steps, box);
      }
    }
    if (!box.IsValid() && step.Grid.Size.x > 0)
    {
      AddRegion(step.Grid,
        step.Type == ffd::TransformStep::Kind::Spline ? 0.5 * (step.Order - 1) : 0.0, box);
    }
  }
}

vtkSmartPointer<vtkAbstractTransform> MakeChain(std::vector<ffd::TransformStep>& steps);

/// Append what one step is to a chain; the step is used up.
void AppendStep(ffd::TransformStep& step, std::vector<vtkSmartPointer<vtkAbstractTransform>>& chain)
{
  if (step.Type == ffd::TransformStep::Kind::Linear)
  {
    chain.push_back(MakeLinear(step.Matrix, step.Offset));
    return;
  }
  if (step.Type == ffd::TransformStep::Kind::Sum)
  {
    auto sum = vtkSmartPointer<vtkFFDSumTransform>::New();
    for (ffd::TransformTerm& term : step.Terms)
    {
      sum->AddTransform(MakeChain(term.Steps), term.Weight);
    }
    chain.push_back(sum);
    return;
  }
  // A sum has displacements at the border that must not fade out.
  const bool sum = step.IsSum;
  if (ffd::AlignTransformStep(step))
  {
    chain.push_back(MakeGrid(step, sum));
    return;
  }
  // Into the frame of the grid, deform, and back.
  const glm::dmat3 toSpace = step.Grid.Direction;
  const glm::dmat3 toGrid = glm::inverse(toSpace);
  step.Grid.Origin = toGrid * step.Grid.Origin;
  step.Grid.Direction = glm::dmat3(1.0);
  for (glm::dvec3& value : step.Values)
  {
    value = toGrid * value;
  }
  chain.push_back(MakeLinear(toGrid, glm::dvec3(0.0)));
  chain.push_back(MakeGrid(step, sum));
  chain.push_back(MakeLinear(toSpace, glm::dvec3(0.0)));
}

/// One transform of all steps; they are used up.
vtkSmartPointer<vtkAbstractTransform> MakeChain(std::vector<ffd::TransformStep>& steps)
{
  std::vector<vtkSmartPointer<vtkAbstractTransform>> chain;
  for (ffd::TransformStep& step : steps)
  {
    AppendStep(step, chain);
  }
  if (chain.empty())
  {
    return vtkSmartPointer<vtkTransform>::New(); // an empty composite
  }
  if (chain.size() == 1)
  {
    return chain.front();
  }
  auto general = vtkSmartPointer<vtkGeneralTransform>::New();
  general->PostMultiply();
  for (const auto& link : chain)
  {
    general->Concatenate(link);
  }
  return general;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDTransformReader::vtkFFDTransformReader()
  : FileName(nullptr)
  , Coordinates(LPS)
  , FitBounds{ 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 }
  , FitTolerance(0.1)
  , MaximumCells(64)
  , StackIndex(0)
  , StackSize(0)
  , StackOrigin(0.0)
  , StackSpacing(1.0)
  , LatticeError(0.0)
  , FileFormat(UNKNOWN)
  , Domain{ 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 }
  , LatticeIsExact(false)
  , LatticeIsMade(false)
  , FitFailed(false)
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkFFDTransformReader::~vtkFFDTransformReader() { this->SetFileName(nullptr); }

//------------------------------------------------------------------------------
void vtkFFDTransformReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Coordinates: " << (this->Coordinates == LPS ? "LPS" : "RAS") << "\n";
  os << indent << "FitBounds:";
  for (const double bound : this->FitBounds)
  {
    os << " " << bound;
  }
  os << "\n" << indent << "FitTolerance: " << this->FitTolerance << "\n";
  os << indent << "MaximumCells: " << this->MaximumCells << "\n";
  os << indent << "StackIndex: " << this->StackIndex << "\n";
  os << indent << "StackSize: " << this->StackSize << "\n";
  os << indent << "FileFormat: " << this->GetFileFormatAsString() << "\n";
  os << indent << "LatticeError: " << this->LatticeError << "\n";
  os << indent << "Transform: " << (this->Transform ? this->Transform->GetClassName() : "(none)")
     << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::SetCoordinates(int coordinates)
{
  if (coordinates != LPS && coordinates != RAS)
  {
    vtkErrorMacro("SetCoordinates: " << coordinates << " is no system. Give LPS or RAS.");
    return;
  }
  if (this->Coordinates != coordinates)
  {
    this->Coordinates = coordinates;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::SetFitBounds(const double bounds[6])
{
  vtkFFDSetBounds(this, "SetFitBounds", this->FitBounds, bounds);
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::SetFitBounds(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double bounds[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetFitBounds(bounds);
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::SetFitTolerance(double tolerance)
{
  vtkFFDSetTolerance(this, "SetFitTolerance", this->FitTolerance, tolerance);
}

//------------------------------------------------------------------------------
double vtkFFDTransformReader::GetStackTime(int index) const
{
  return this->StackOrigin + index * this->StackSpacing;
}

//------------------------------------------------------------------------------
const char* vtkFFDTransformReader::GetFileFormatAsString()
{
  static const char* const names[] = { "Unknown", "ItkText", "Elastix", "MetaImage", "NRRD",
    "NIfTI", "Lattice", "ItkHDF5", "Matlab", "MINC" };
  return names[this->FileFormat];
}

//------------------------------------------------------------------------------
int vtkFFDTransformReader::CanReadFile(const char* fileName)
{
  return fileName && vtkFFDDetectTransformFormat(fileName) != UNKNOWN;
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDTransformReader::GetTransform()
{
  return this->ReadFile() ? this->Transform : nullptr;
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDTransformReader::GetLattice()
{
  return this->ReadFile() && this->MakeLattice() ? this->Lattice.GetPointer() : nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::GetDomain(double bounds[6])
{
  this->ReadFile();
  std::copy(this->Domain, this->Domain + 6, bounds);
}

//------------------------------------------------------------------------------
bool vtkFFDTransformReader::ReadFile()
{
  if (this->ReadTime > this->GetMTime())
  {
    return this->Transform != nullptr;
  }
  const vtkFFDClassicLocale numbers;
  this->ReadAnyFile();
  // The result, or the error, is up to date now: setting error codes and progress has modified the
  // object.
  this->ReadTime.Modified();
  return this->Transform != nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::ReadAnyFile()
{
  this->Transform = nullptr;
  this->LatticeIsExact = false;
  this->LatticeIsMade = false;
  this->FitFailed = false;
  this->LatticeError = 0.0;
  this->StackSize = 0;
  this->FileFormat = UNKNOWN;
  vtkMath::UninitializeBounds(this->Domain);
  this->SetErrorCode(vtkErrorCode::NoError);
  if (!this->FileName || !*this->FileName)
  {
    vtkErrorMacro("No file to read. Call SetFileName().");
    this->SetErrorCode(vtkErrorCode::NoFileNameError);
    return;
  }
  std::string error;
  vtkFFDTransformFile file;
  file.StackIndex = static_cast<std::size_t>(this->StackIndex);
  try
  {
    const auto proceed = [this](double done) {
      this->UpdateProgress(0.8 * done);
      return !this->GetAbortExecute();
    };
    if (vtkFFDReadTransformFile(this->FileName, file, proceed, error))
    {
      file.Format == LATTICE ? this->ReadLatticeFile() : this->UseFile(file);
    }
  }
  catch (const std::bad_alloc&)
  {
    error = "it needs more memory than there is";
  }
  catch (const std::exception& problem)
  {
    error = std::string("reading failed: ") + problem.what();
  }
  this->FileFormat = file.Format;
  if (!error.empty())
  {
    this->Transform = nullptr;
    this->LatticeIsMade = false;
    vtkErrorMacro(
      "The transform file " << this->FileName << " cannot be used: " << MakeReadable(error) << ".");
    this->SetErrorCode(vtksys::SystemTools::FileExists(this->FileName)
        ? vtkErrorCode::FileFormatError
        : vtkErrorCode::FileNotFoundError);
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::UseFile(vtkFFDTransformFile& file)
{
  this->StackSize = static_cast<int>(file.StackSize);
  this->StackOrigin = file.StackOrigin;
  this->StackSpacing = file.StackSpacing;
  vtkBoundingBox region;
  if (file.FixedImage.Size.x > 0)
  {
    if (this->Coordinates == RAS)
    {
      ffd::TransformStep image;
      image.Type = ffd::TransformStep::Kind::Field;
      image.Grid = file.FixedImage;
      ffd::FlipTransformStep(image);
      file.FixedImage = image.Grid;
    }
    AddRegion(file.FixedImage, 0, region);
  }
  if (this->Coordinates == RAS)
  {
    for (ffd::TransformStep& step : file.Steps)
    {
      ffd::FlipTransformStep(step);
    }
  }
  AddFirstRegion(file.Steps, region);
  this->Transform = MakeChain(file.Steps);
  if (vtkFFDLattice* const lattice = vtkFFDLattice::SafeDownCast(this->Transform))
  {
    this->Lattice->DeepCopy(lattice);
    this->LatticeIsExact = true;
    this->LatticeIsMade = true;
  }
  if (region.IsValid())
  {
    region.GetBounds(this->Domain);
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformReader::ReadLatticeFile()
{
  std::string problem = vtkFFDFindLatticeFileProblem(this->FileName);
  problem = problem.empty() ? vtkFFDImageDataFile::FindXmlProblem(this->FileName) : problem;
  if (!problem.empty())
  {
    vtkErrorMacro("The lattice file " << this->FileName << " cannot be used: " << problem << ".");
    this->SetErrorCode(vtkErrorCode::FileFormatError);
    return;
  }
  vtkNew<vtkXMLImageDataReader> reader;
  vtkNew<vtkCallbackCommand> collect;
  collect->SetCallback(CollectError);
  collect->SetClientData(&problem);
  reader->AddObserver(vtkCommand::ErrorEvent, collect);
  reader->SetFileName(this->FileName);
  reader->UpdateInformation();
  // The parser is an object of its own, which exists now.
  vtkInformation* info = reader->GetOutputInformation(0);
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  if (problem.empty() && info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  }
  double points = 1.0;
  for (int a = 0; a < 3 && problem.empty(); ++a)
  {
    const double n = static_cast<double>(extent[2 * a + 1]) - extent[2 * a] + 1.0;
    points *= n;
    if (!(n >= 4.0 && n <= 1024.0))
    {
      problem = "it has not from 4 to 1024 control points along axis " + std::to_string(a);
    }
  }
  const double size = static_cast<double>(vtksys::SystemTools::FileLength(this->FileName));
  if (problem.empty() && 24.0 * points > LargestCompression * size + LargestXMLOverhead)
  {
    problem = "it claims more control points than it can hold";
  }
  if (problem.empty())
  {
    reader->Update();
  }
  vtkImageData* image = reader->GetOutput();
  vtkDataArray* scalars = image ? image->GetPointData()->GetScalars() : nullptr;
  if (problem.empty() &&
    (!scalars || scalars->GetNumberOfComponents() != 3 ||
      scalars->GetNumberOfTuples() != image->GetNumberOfPoints()))
  {
    problem = "it has no point scalars with 3 components";
  }
  if (problem.empty())
  {
    // Beyond these sums of products overflow.
    const double range[3] = { scalars->GetMaxNorm(),
      image->GetCenter()[0] + image->GetCenter()[1] + image->GetCenter()[2], image->GetLength() };
    for (const double number : range)
    {
      if (!(std::abs(number) <= LargestLength))
      {
        problem = "its grid or its displacements are not finite numbers of at most 1e12";
      }
    }
  }
  vtkNew<vtkFFDLattice> lattice;
  if (problem.empty())
  {
    lattice->AddObserver(vtkCommand::ErrorEvent, collect);
    if (!lattice->FromImageData(image) && problem.empty())
    {
      problem = "it holds no lattice";
    }
  }
  if (problem.empty() && !(std::abs(lattice->GetDisplacementScale()) <= LargestLength))
  {
    problem = "its displacement scale is larger than 1e12";
  }
  if (!problem.empty())
  {
    vtkErrorMacro("The lattice file " << this->FileName << " cannot be used: " << problem << ".");
    this->SetErrorCode(vtkErrorCode::FileFormatError);
    return;
  }
  lattice->RemoveAllObservers();
  this->Transform = lattice;
  this->Lattice->DeepCopy(lattice);
  this->LatticeIsExact = true;
  this->LatticeIsMade = true;
  this->Lattice->GetDomain(this->Domain);
}

//------------------------------------------------------------------------------
bool vtkFFDTransformReader::MakeLattice()
{
  if (this->LatticeIsMade || this->FitFailed)
  {
    return this->LatticeIsMade;
  }
  const double* bounds = this->FitBounds[0] <= this->FitBounds[1] ? this->FitBounds : this->Domain;
  this->FitFailed = true;
  if (bounds[0] > bounds[1])
  {
    vtkErrorMacro("The transform file "
      << this->FileName
      << " is no lattice and tells no region to make one for. Call SetFitBounds() with the bounds "
         "of the fixed image, or use GetTransform().");
    return false;
  }
  this->UpdateProgress(0.8);
  const double error =
    this->Lattice->FitToTransform(this->Transform, bounds, this->FitTolerance, this->MaximumCells);
  if (error < 0.0)
  {
    vtkErrorMacro("The transform in " << this->FileName << ", a " << this->Transform->GetClassName()
                                      << ", could not be approximated by a lattice.");
    return false;
  }
  if (error > this->FitTolerance)
  {
    vtkWarningMacro("The transform in "
      << this->FileName << " is approximated by a lattice with an error of " << error
      << " instead of the FitTolerance of " << this->FitTolerance
      << ". GetTransform() has no such error; or allow more MaximumCells.");
  }
  this->FitFailed = false;
  this->LatticeIsMade = true;
  this->LatticeError = error;
  return true;
}

//------------------------------------------------------------------------------
int vtkFFDTransformReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  if (!this->ReadFile() || !this->MakeLattice())
  {
    return 0;
  }
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkFFDDescribeLatticeImage(this->Lattice, info);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDTransformReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!this->LatticeIsMade || !output)
  {
    return 0;
  }
  const int ok = this->Lattice->ToImageData(output);
  this->UpdateProgress(1.0);
  return ok;
}
