// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformSeries.h"

#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDTransformFiles.h"
#include "vtkFFDTransformReader.h"

#include "vtkAbstractTransform.h"
#include "vtkCallbackCommand.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkFFDTransformSeries);
vtkFFDGuardedProcessRequestMacro(vtkFFDTransformSeries);

namespace
{

/// Half the edge of the region of linear transforms that tell none, data units.
constexpr double LargestCoordinate = 5000.0;

/// Keeps the first error of a reader, without where in the source it is from.
void KeepError(vtkObject*, unsigned long, void* clientData, void* callData)
{
  std::string& text = *static_cast<std::string*>(clientData);
  if (text.empty() && callData)
  {
    text = static_cast<const char*>(callData);
    text.erase(text.find_last_not_of(" \n") + 1);
    const std::size_t start = text.find("): ");
    text.erase(0, start == std::string::npos ? 0 : start + 3);
  }
}

/// Whether the control points of two lattices are those of one grid.
bool HaveSameGrid(vtkFFDLattice* a, vtkFFDLattice* b)
{
  int sizes[2][3];
  double domains[2][6];
  a->GetDimensions(sizes[0]);
  b->GetDimensions(sizes[1]);
  a->GetDomain(domains[0]);
  b->GetDomain(domains[1]);
  bool same = std::equal(sizes[0], sizes[0] + 3, sizes[1]) &&
    a->GetBorderMode() == b->GetBorderMode() && a->GetInverseFlag() == b->GetInverseFlag();
  for (int i = 0; i < 6; ++i)
  {
    const double extent = domains[0][i | 1] - domains[0][i & ~1];
    same = same && std::abs(domains[0][i] - domains[1][i]) <= 1e-9 * extent;
  }
  return same;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDTransformSeries::vtkFFDTransformSeries()
{
  this->SetNumberOfInputPorts(0);
  vtkMath::UninitializeBounds(this->Region);
}

//------------------------------------------------------------------------------
vtkFFDTransformSeries::~vtkFFDTransformSeries() = default;

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileNames: " << this->FileNames.size() << "\n";
  for (const std::string& name : this->FileNames)
  {
    os << indent.GetNextIndent() << name << "\n";
  }
  os << indent << "Coordinates: " << (this->Coordinates == 0 ? "LPS" : "RAS") << "\n";
  os << indent << "FitBounds:";
  for (const double bound : this->FitBounds)
  {
    os << " " << bound;
  }
  os << "\n" << indent << "FitTolerance: " << this->FitTolerance << "\n";
  os << indent << "MaximumCells: " << this->MaximumCells << "\n";
  os << indent << "PullBack: " << this->PullBack << "\n";
  os << indent << "TimeStart: " << this->TimeStart << "\n";
  os << indent << "TimeSpacing: " << this->TimeSpacing << "\n";
  os << indent << "Interpolation: " << (this->Interpolation == STEP ? "STEP" : "LINEAR") << "\n";
  os << indent << "Steps: " << this->Steps.size() << "\n";
  os << indent << "LatticeError: " << this->LatticeError << "\n";
}

//------------------------------------------------------------------------------
/// Marks all that was read from files, or made of it, as out of date.
void vtkFFDTransformSeries::ChangeFiles()
{
  this->IsRead = false;
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::AddFileName(const char* name)
{
  if (!name || !*name)
  {
    vtkErrorMacro("AddFileName: there is no name. Give that of a transform file.");
    return;
  }
  this->FileNames.emplace_back(name);
  this->ChangeFiles();
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::RemoveAllFileNames()
{
  if (!this->FileNames.empty())
  {
    this->FileNames.clear();
    this->ChangeFiles();
  }
}

//------------------------------------------------------------------------------
int vtkFFDTransformSeries::GetNumberOfFileNames() const
{
  return static_cast<int>(this->FileNames.size());
}

//------------------------------------------------------------------------------
const char* vtkFFDTransformSeries::GetFileName(int index) const
{
  return index >= 0 && index < this->GetNumberOfFileNames()
    ? this->FileNames[static_cast<std::size_t>(index)].c_str()
    : nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::Reload() { this->ChangeFiles(); }

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetCoordinates(int coordinates)
{
  if (coordinates != vtkFFDTransformReader::LPS && coordinates != vtkFFDTransformReader::RAS)
  {
    vtkErrorMacro("SetCoordinates: " << coordinates << " is no system. Give 0 (LPS) or 1 (RAS).");
    return;
  }
  if (this->Coordinates != coordinates)
  {
    this->Coordinates = coordinates;
    this->ChangeFiles();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetFitBounds(const double bounds[6])
{
  if (!bounds || std::any_of(bounds, bounds + 6, [](double b) { return !std::isfinite(b); }))
  {
    vtkErrorMacro("SetFitBounds: the bounds are " << (bounds ? "not finite" : "null")
                                                  << ". Give six finite numbers.");
    return;
  }
  if (!std::equal(bounds, bounds + 6, this->FitBounds))
  {
    std::copy_n(bounds, 6, this->FitBounds);
    this->ChangeFiles();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetFitBounds(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double bounds[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetFitBounds(bounds);
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetFitTolerance(double tolerance)
{
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
  {
    vtkErrorMacro(
      "SetFitTolerance: the tolerance is " << tolerance << ". Give a positive distance.");
    return;
  }
  if (this->FitTolerance != tolerance)
  {
    this->FitTolerance = tolerance;
    this->ChangeFiles();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetMaximumCells(int cells)
{
  cells = std::clamp(cells, 1, 256);
  if (this->MaximumCells != cells)
  {
    this->MaximumCells = cells;
    this->ChangeFiles();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetTimeStart(double time)
{
  if (!std::isfinite(time))
  {
    vtkErrorMacro("SetTimeStart: the time is " << time << ". Give a finite one.");
    return;
  }
  if (this->TimeStart != time)
  {
    this->TimeStart = time;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformSeries::SetTimeSpacing(double spacing)
{
  if (!(spacing > 0.0) || !std::isfinite(spacing))
  {
    vtkErrorMacro(
      "SetTimeSpacing: the time between files is " << spacing << ". Give a positive one.");
    return;
  }
  if (this->TimeSpacing != spacing)
  {
    this->TimeSpacing = spacing;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDTransformSeries::GetNumberOfSteps() const { return static_cast<int>(this->Steps.size()); }

//------------------------------------------------------------------------------
double vtkFFDTransformSeries::GetStepTime(int index) const
{
  if (this->HasOwnTimes && index >= 0 && index < this->GetNumberOfSteps())
  {
    return this->Steps[static_cast<std::size_t>(index)].Time;
  }
  return this->TimeStart + index * this->TimeSpacing;
}

//------------------------------------------------------------------------------
int vtkFFDTransformSeries::CanReadFile(const char* fileName)
{
  return vtkFFDGuarded(
    this, "CanReadFile", 0, [&] { return fileName && vtkFFDIsTransformFile(fileName) ? 1 : 0; });
}

//------------------------------------------------------------------------------
bool vtkFFDTransformSeries::ReadFiles()
{
  if (!this->IsRead)
  {
    this->Steps.clear();
    this->HasOwnTimes = false;
    this->LatticeError = 0.0;
    vtkMath::UninitializeBounds(this->Region);
    // Errors are told once.
    this->IsRead = true;
    if (!this->ReadAllFiles())
    {
      this->Steps.clear();
    }
  }
  return !this->Steps.empty();
}

//------------------------------------------------------------------------------
bool vtkFFDTransformSeries::ReadAllFiles()
{
  if (this->FileNames.empty())
  {
    vtkErrorMacro("There is no file to read. Call AddFileName().");
    return false;
  }
  if (this->FitBounds[0] <= this->FitBounds[1])
  {
    std::copy_n(this->FitBounds, 6, this->Region);
  }
  std::string problem;
  vtkNew<vtkCallbackCommand> keep;
  keep->SetCallback(KeepError);
  keep->SetClientData(&problem);
  vtkNew<vtkFFDTransformReader> reader;
  reader->AddObserver(vtkCommand::ErrorEvent, keep);
  reader->SetCoordinates(this->Coordinates);
  for (std::size_t i = 0; i < this->FileNames.size(); ++i)
  {
    this->UpdateProgress(static_cast<double>(i) / static_cast<double>(this->FileNames.size()));
    if (!this->ReadFile(reader, i, problem))
    {
      vtkErrorMacro(<< (problem.empty()
                        ? "The transform file " + this->FileNames[i] + " could not be read."
                        : problem));
      return false;
    }
  }
  if (!this->MakeAlike())
  {
    vtkErrorMacro("The transforms in " << this->FileNames.front()
                                       << " and the files after it could not be approximated by "
                                          "lattices: they give points that are not finite.");
    return false;
  }
  if (this->LatticeError > this->FitTolerance)
  {
    vtkWarningMacro("Transforms, the first of them in "
      << this->FileNames.front() << ", are approximated by lattices with an error of "
      << this->LatticeError << " instead of the FitTolerance of " << this->FitTolerance
      << ". Allow more MaximumCells, or set FitBounds to the region that matters.");
  }
  return true;
}

//------------------------------------------------------------------------------
/// Add the steps of a file.
bool vtkFFDTransformSeries::ReadFile(
  vtkFFDTransformReader* reader, std::size_t index, std::string& problem)
{
  reader->SetFileName(this->FileNames[index].c_str());
  reader->SetStackIndex(0);
  if (!this->AddStep(reader, 0.0, problem))
  {
    return false;
  }
  const int size = reader->GetStackSize();
  if (size > 0 && this->FileNames.size() > 1)
  {
    problem = "The transform file " + this->FileNames[index] +
      " is a stack, a series by itself: it must be the only file.";
    return false;
  }
  if (size > 0)
  {
    this->HasOwnTimes = true;
    this->Steps.back().Time = reader->GetStackTime(0);
  }
  for (int i = 1; i < size; ++i)
  {
    this->UpdateProgress(static_cast<double>(i) / size);
    reader->SetStackIndex(i);
    if (!this->AddStep(reader, reader->GetStackTime(i), problem))
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
/// Add what the reader has read, as its lattice, or else one that is fitted at once: the transform
/// may be a large field.
bool vtkFFDTransformSeries::AddStep(
  vtkFFDTransformReader* reader, double time, std::string& problem)
{
  vtkAbstractTransform* transform = reader->GetTransform();
  if (!transform)
  {
    return false;
  }
  if (this->Region[0] > this->Region[1])
  {
    reader->GetDomain(this->Region);
  }
  Step step;
  step.Time = time;
  step.IsPullBack = reader->GetFileFormat() != vtkFFDTransformReader::LATTICE;
  step.IsExact = vtkFFDLattice::SafeDownCast(transform) != nullptr;
  step.Lattice = vtkSmartPointer<vtkFFDLattice>::New();
  if (step.IsExact)
  {
    step.Lattice->DeepCopy(transform);
  }
  else if (!this->Fit(step, transform))
  {
    problem = std::string("The transform file ") + reader->GetFileName() +
      " cannot be approximated by a lattice: it gives points that are not finite.";
    return false;
  }
  this->Steps.push_back(step);
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDTransformSeries::Fit(Step& step, vtkAbstractTransform* transform)
{
  // Of linear transforms alone nothing is lost anywhere.
  static constexpr double l = LargestCoordinate;
  static constexpr double everywhere[6] = { -l, l, -l, l, -l, l };
  const double error = step.Lattice->FitToTransform(transform,
    this->Region[0] <= this->Region[1] ? this->Region : everywhere, this->FitTolerance,
    this->MaximumCells);
  this->LatticeError = std::max(this->LatticeError, error);
  return error >= 0.0;
}

//------------------------------------------------------------------------------
/// Lattices of one grid, which can be interpolated.
bool vtkFFDTransformSeries::MakeAlike()
{
  vtkFFDLattice* first = this->Steps.front().Lattice;
  const bool alike = std::all_of(this->Steps.begin(), this->Steps.end(), [&](const Step& step) {
    return step.IsExact == this->Steps.front().IsExact && HaveSameGrid(first, step.Lattice);
  });
  if (alike)
  {
    return true;
  }
  int sizes[3] = { 4, 4, 4 };
  double domain[6];
  double region[6];
  first->GetDomain(domain);
  std::copy_n(this->Region[0] <= this->Region[1] ? this->Region : domain, 6, region);
  std::copy_n(region, 6, this->Region);
  for (Step& step : this->Steps)
  {
    step.Lattice->GetDomain(domain);
    if (step.IsExact || !std::equal(domain, domain + 6, region))
    {
      vtkNew<vtkFFDLattice> exact;
      exact->DeepCopy(step.Lattice);
      if (!this->Fit(step, exact))
      {
        return false;
      }
      step.IsExact = false;
    }
    for (int a = 0; a < 3; ++a)
    {
      sizes[a] = std::max(sizes[a], step.Lattice->GetDimensions()[a]);
    }
  }
  for (Step& step : this->Steps)
  {
    step.Lattice->SetDimensions(sizes);
  }
  return true;
}

//------------------------------------------------------------------------------
/// Whether times between steps have a meaning; else an error tells why not.
bool vtkFFDTransformSeries::CanInterpolate()
{
  const double last = this->GetStepTime(this->GetNumberOfSteps() - 1);
  if (!std::isfinite(last))
  {
    vtkErrorMacro("The time of the last of "
      << this->GetNumberOfSteps() << " files is not finite. Give a smaller TimeStart ("
      << this->TimeStart << ") or TimeSpacing (" << this->TimeSpacing << ").");
    return false;
  }
  const auto other = std::find_if(this->Steps.begin(), this->Steps.end(),
    [&](const Step& step) { return step.IsPullBack != this->Steps.front().IsPullBack; });
  if (this->PullBack && this->Interpolation == LINEAR && other != this->Steps.end())
  {
    const bool pulls = other->IsPullBack;
    const std::string& name =
      this->FileNames[static_cast<std::size_t>(other - this->Steps.begin())];
    vtkErrorMacro("The transform file "
      << (pulls ? name : this->FileNames.front()) << " leads from deformed positions to those at "
      << "rest, but " << (pulls ? this->FileNames.front() : name)
      << " the other way. Give files of one kind, or set Interpolation to STEP.");
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
int vtkFFDTransformSeries::GetLatticeAt(double time, vtkFFDLattice* lattice)
{
  if (!lattice || !std::isfinite(time))
  {
    vtkErrorMacro("GetLatticeAt: "
      << (lattice ? "the time is not finite" : "the lattice to fill is null") << ".");
    return 0;
  }
  if (!vtkFFDGuarded(this, "GetLatticeAt", false, [this] { return this->ReadFiles(); }) ||
    !this->CanInterpolate())
  {
    return 0;
  }
  int next = 0;
  while (next < this->GetNumberOfSteps() && this->GetStepTime(next) <= time)
  {
    ++next;
  }
  const int before = std::max(next - 1, 0);
  next = std::min(next, this->GetNumberOfSteps() - 1);
  const Step& from = this->Steps[static_cast<std::size_t>(before)];
  const Step& to = this->Steps[static_cast<std::size_t>(next)];
  lattice->DeepCopy(from.Lattice);
  if (this->Interpolation == LINEAR && next > before)
  {
    const double start = this->GetStepTime(before);
    const double t = (time - start) / (this->GetStepTime(next) - start);
    const double factors[2] = { (1.0 - t) * from.Lattice->GetDisplacementScale(),
      t * to.Lattice->GetDisplacementScale() };
    const double* a = from.Lattice->GetDisplacements()->GetPointer(0);
    const double* b = to.Lattice->GetDisplacements()->GetPointer(0);
    vtkDoubleArray* sum = lattice->GetDisplacements();
    for (vtkIdType i = 0; i < sum->GetNumberOfValues(); ++i)
    {
      sum->SetValue(i, factors[0] * a[i] + factors[1] * b[i]);
    }
    lattice->SetDisplacementScale(1.0);
    lattice->Modified();
  }
  if (this->PullBack && from.IsPullBack)
  {
    lattice->Inverse();
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDTransformSeries::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = outputs->GetInformationObject(0);
  info->Remove(Pipeline::TIME_STEPS());
  info->Remove(Pipeline::TIME_RANGE());
  if (!this->ReadFiles() || !this->CanInterpolate())
  {
    this->GetOutputDataObject(0)->Initialize();
    return 0;
  }
  vtkFFDLattice* lattice = this->Steps.front().Lattice;
  vtkFFDDescribeLatticeImage(lattice, info);
  if (this->Steps.size() > 1)
  {
    std::vector<double> times;
    for (int i = 0; i < this->GetNumberOfSteps(); ++i)
    {
      times.push_back(this->GetStepTime(i));
    }
    const double range[2] = { times.front(), times.back() };
    info->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
    info->Set(Pipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDTransformSeries::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!output || !this->ReadFiles())
  {
    return 0;
  }
  vtkInformation* info = outputs->GetInformationObject(0);
  const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
    ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
    : this->GetStepTime(0);
  vtkNew<vtkFFDLattice> lattice;
  if (!this->GetLatticeAt(time, lattice) || !lattice->ToImageData(output))
  {
    return 0;
  }
  if (this->Steps.size() > 1)
  {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
  }
  return 1;
}
