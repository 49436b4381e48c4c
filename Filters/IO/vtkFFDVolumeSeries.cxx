// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeSeries.h"

#include "vtkFFDArrayRanges.h"
#include "vtkFFDGuard.h"
#include "vtkFFDPipeline.h"
#include "vtkFFDTransformFiles.h"
#include "vtkFFDVolumeReader.h"

#include "vtkArrayDispatch.h"
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <list>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

vtkStandardNewMacro(vtkFFDVolumeSeries);
vtkFFDProcessRequestInTimeMacro(vtkFFDVolumeSeries);

namespace
{

/// Steps that are kept whatever their size: two to be interpolated, and one read ahead.
constexpr std::size_t LeastKept = 3;

/// Times are sums of decimals: a step is not to be missed by a rounding error, in steps.
constexpr double Rounding = 1e-9;

/// The step before a place between steps.
int FindStep(double place) { return static_cast<int>(std::floor(place + Rounding)); }

/// The result of reading a file.
struct Volume
{
  vtkSmartPointer<vtkImageData> Image;
  std::string Problem;
};

/// Read a file, in any thread: errors and warnings of the reader are kept from the application's
/// window.
Volume ReadVolume(const std::string& name)
{
  Volume volume;
  try
  {
    vtkNew<vtkFFDVolumeReader> reader;
    vtkNew<vtkCallbackCommand> ignore;
    ignore->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
    reader->AddObserver(vtkCommand::ErrorEvent, ignore);
    reader->AddObserver(vtkCommand::WarningEvent, ignore);
    reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, ignore);
    reader->SetFileName(name.c_str());
    reader->Update();
    volume.Problem = reader->GetProblem();
    if (volume.Problem.empty())
    {
      volume.Image = vtkSmartPointer<vtkImageData>::New();
      volume.Image->ShallowCopy(reader->GetOutput());
      if (volume.Image->GetNumberOfPoints() == 0)
      {
        volume.Image = nullptr;
        volume.Problem = "there is nothing in it";
      }
    }
  }
  catch (const std::exception& problem)
  {
    volume.Image = nullptr;
    volume.Problem = std::string("reading failed: ") + problem.what();
  }
  return volume;
}

/// (1 - t) a + t b with 0 < t < 1, rounded for whole numbers. What is infinite stays so.
template <typename Value>
Value Mix(Value a, Value b, double t)
{
  if (a == b)
  {
    return a;
  }
  const double x = (1.0 - t) * static_cast<double>(a) + t * static_cast<double>(b);
  if constexpr (std::is_integral<Value>::value)
  {
    // Between both: doubles round whole numbers of 64 bits, the largest ones to one that is too
    // large.
    const double rounded = std::floor(x + 0.5);
    const auto [low, high] = std::minmax(a, b);
    return rounded <= static_cast<double>(low) ? low
      : rounded >= static_cast<double>(high)   ? high
                                               : static_cast<Value>(rounded);
  }
  return static_cast<Value>(x);
}

/// Mixes arrays with values of one type, in any layout.
struct Blend
{
  template <typename From, typename To>
  void operator()(From* a, To* b, double t, vtkDataArray* result) const
  {
    using Value = vtk::GetAPIType<From>;
    const auto from = vtk::DataArrayValueRange(a);
    const auto to = vtk::DataArrayValueRange(b);
    auto out = vtk::DataArrayValueRange(static_cast<From*>(result)); // of a->NewInstance()
    constexpr vtkIdType grain = 65536;
    vtkSMPTools::For(0, from.size(), grain, [&](vtkIdType begin, vtkIdType end) {
      for (vtkIdType i = begin; i < end; ++i)
      {
        const Value x = from[i];
        const Value y = to[i];
        out[i] = Mix(x, y, t);
      }
    });
  }
};

/// Replace in `result`, a shallow copy of `from`, the arrays that `to` has, too.
void BlendArrays(
  vtkDataSetAttributes* from, vtkDataSetAttributes* to, double t, vtkDataSetAttributes* result)
{
  vtkDataArray* scalars = from->GetScalars();
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* a = from->GetArray(i);
    vtkDataArray* b = a && a->GetName() ? to->GetArray(a->GetName()) : nullptr;
    if (!b || a->GetDataType() != b->GetDataType() ||
      a->GetNumberOfValues() != b->GetNumberOfValues() ||
      a->GetNumberOfComponents() != b->GetNumberOfComponents())
    {
      continue;
    }
    auto blended = vtkSmartPointer<vtkDataArray>::Take(a->NewInstance());
    blended->SetName(a->GetName());
    blended->SetNumberOfComponents(a->GetNumberOfComponents());
    blended->SetNumberOfTuples(a->GetNumberOfTuples());
    if (vtkArrayDispatch::Dispatch2SameValueType::Execute(a, b, Blend(), t, blended))
    {
      // In the place of that of the same name.
      result->AddArray(blended);
      if (a == scalars)
      {
        result->SetActiveScalars(a->GetName());
      }
    }
  }
}

/// Whether the voxels of two images lie at the same places, to a small part of one.
bool LieAlike(vtkImageData* a, vtkImageData* b)
{
  constexpr double tolerance = 1e-4; // voxels
  int extent[6];
  a->GetExtent(extent);
  const vtkMatrix4x4* const toIndex = a->GetPhysicalToIndexMatrix();
  const vtkMatrix4x4* const from = a->GetIndexToPhysicalMatrix();
  const vtkMatrix4x4* const to = b->GetIndexToPhysicalMatrix();
  double farthest[4] = { 0.0, 0.0, 0.0, 1.0 };
  for (int axis = 0; axis < 3; ++axis)
  {
    farthest[axis] = std::max(std::abs(extent[2 * axis]), std::abs(extent[2 * axis + 1]));
  }
  double way = 0.0;
  for (int row = 0; row < 3; ++row)
  {
    for (int inner = 0; inner < 3; ++inner)
    {
      for (int column = 0; column < 4; ++column)
      {
        way += std::abs(toIndex->GetElement(row, inner) *
          (to->GetElement(inner, column) - from->GetElement(inner, column)) * farthest[column]);
      }
    }
  }
  return way <= tolerance;
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDVolumeSeries::vtkInternals
{
public:
  std::vector<std::string> FileNames;
  int Reads = 0;
  int ReadsAhead = 0;

  ~vtkInternals() { this->Join(); }

  void Forget()
  {
    this->Join();
    this->Kept.clear();
    this->Reads = 0;
    this->ReadsAhead = 0;
    this->Last = -1;
  }

  /// The volume of a step; not for a second after the next call of this or of Forget().
  Volume Get(int step)
  {
    if (this->Ahead == step)
    {
      this->Join();
    }
    const auto found = std::find_if(this->Kept.begin(), this->Kept.end(),
      [step](const Entry& each) { return each.Step == step; });
    if (found != this->Kept.end() && found->Content.Image)
    {
      this->Kept.splice(this->Kept.begin(), this->Kept, found);
      return this->Kept.front().Content;
    }
    if (found != this->Kept.end())
    {
      // What could not be read may be there now.
      this->Kept.erase(found);
    }
    ++this->Reads;
    this->Kept.push_front({ step, ReadVolume(this->FileNames[static_cast<std::size_t>(step)]) });
    return this->Kept.front().Content;
  }

  /// Read what comes after the steps `first` to `last`, which were just asked for.
  void ReadAhead(int first, int last)
  {
    const int count = static_cast<int>(this->FileNames.size());
    const bool moves = this->Last >= 0 && this->Last != first;
    // From the last to the first is forwards.
    const bool backwards = moves && first < this->Last && !(first == 0 && this->Last > 1);
    const int next = ((backwards ? first - 1 : last + 1) + count) % count;
    this->IsMoving = this->IsMoving || moves;
    this->Last = first;
    if (!this->IsMoving || this->Ahead == next ||
      std::any_of(this->Kept.begin(), this->Kept.end(),
        [next](const Entry& each) { return each.Step == next; }))
    {
      return;
    }
    this->Join();
    this->Ahead = next;
    const std::string name = this->FileNames[static_cast<std::size_t>(next)];
    this->Thread = std::thread([this, name] { this->Result = ReadVolume(name); });
  }

  /// Let go of what is not among the latest, and exceeds the limit in bytes.
  void Limit(double bytes)
  {
    double sum = 0.0;
    std::size_t count = 0;
    for (auto each = this->Kept.begin(); each != this->Kept.end();)
    {
      sum += each->Content.Image ? 1024.0 * each->Content.Image->GetActualMemorySize() : 0.0;
      ++count;
      each = count > LeastKept && sum > bytes ? this->Kept.erase(each) : std::next(each);
    }
  }

  /// Wait for what is read ahead, and keep it.
  void Join()
  {
    if (this->Thread.joinable())
    {
      this->Thread.join();
      ++this->Reads;
      ++this->ReadsAhead;
      this->Kept.push_front({ this->Ahead, std::move(this->Result) });
      this->Result = Volume();
      this->Ahead = -1;
    }
  }

private:
  struct Entry
  {
    int Step;
    Volume Content;
  };
  std::list<Entry> Kept; // the latest first
  int Last = -1;         // step asked for last
  bool IsMoving = false; // more than one step was asked for
  std::thread Thread;
  int Ahead = -1; // what it reads
  Volume Result;  // of the thread, until it has ended
};

//------------------------------------------------------------------------------
vtkFFDVolumeSeries::vtkFFDVolumeSeries()
  : Internals(new vtkInternals)
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkFFDVolumeSeries::~vtkFFDVolumeSeries() = default;

//------------------------------------------------------------------------------
void vtkFFDVolumeSeries::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileNames: " << this->Internals->FileNames.size() << "\n";
  for (const std::string& name : this->Internals->FileNames)
  {
    os << indent.GetNextIndent() << name << "\n";
  }
  os << indent << "TimeStart: " << this->TimeStart << "\n";
  os << indent << "TimeSpacing: " << this->TimeSpacing << "\n";
  os << indent << "Interpolation: " << (this->Interpolation == STEP ? "STEP" : "LINEAR") << "\n";
  os << indent << "Prefetch: " << this->Prefetch << "\n";
  os << indent << "CacheSize: " << this->CacheSize << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDVolumeSeries::AddFileName(const char* name)
{
  if (!name || !*name)
  {
    vtkErrorMacro("AddFileName: there is no name. Give that of a volume.");
    return;
  }
  this->Internals->FileNames.emplace_back(name);
  this->Reload();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeSeries::RemoveAllFileNames()
{
  if (!this->Internals->FileNames.empty())
  {
    this->Internals->FileNames.clear();
    this->Reload();
  }
}

//------------------------------------------------------------------------------
int vtkFFDVolumeSeries::GetNumberOfFileNames() const
{
  return static_cast<int>(this->Internals->FileNames.size());
}

//------------------------------------------------------------------------------
const char* vtkFFDVolumeSeries::GetFileName(int index) const
{
  return index >= 0 && index < this->GetNumberOfFileNames()
    ? this->Internals->FileNames[static_cast<std::size_t>(index)].c_str()
    : nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeSeries::Reload()
{
  this->Internals->Forget();
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeSeries::SetTimeStart(double time)
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
void vtkFFDVolumeSeries::SetTimeSpacing(double spacing)
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
int vtkFFDVolumeSeries::GetNumberOfReads() { return this->Internals->Reads; }

//------------------------------------------------------------------------------
int vtkFFDVolumeSeries::GetNumberOfReadsAhead() { return this->Internals->ReadsAhead; }

//------------------------------------------------------------------------------
int vtkFFDVolumeSeries::CanReadFile(const char* fileName)
{
  return vtkFFDGuarded(this, "CanReadFile", 0, [&] {
    return fileName && !vtkFFDIsTransformFile(fileName)
      ? vtkNew<vtkFFDVolumeReader>()->CanReadFile(fileName)
      : 0;
  });
}

//------------------------------------------------------------------------------
void vtkFFDVolumeSeries::WaitForPrefetch() { this->Internals->Join(); }

//------------------------------------------------------------------------------
/// Steps from the first one to a time, of a series that has steps.
double vtkFFDVolumeSeries::FindPlace(double time)
{
  return std::clamp((time - this->TimeStart) / this->TimeSpacing, 0.0,
    static_cast<double>(this->GetNumberOfFileNames() - 1));
}

//------------------------------------------------------------------------------
int vtkFFDVolumeSeries::RequestInformation(
  vtkInformation* request, vtkInformationVector**, vtkInformationVector* outputs)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = outputs->GetInformationObject(0);
  info->Remove(Pipeline::TIME_DEPENDENT_INFORMATION());
  info->Remove(Pipeline::TIME_STEPS());
  info->Remove(Pipeline::TIME_RANGE());
  const int count = this->GetNumberOfFileNames();
  if (count == 0)
  {
    vtkErrorMacro("There is no file to read. Call AddFileName().");
    this->GetOutputDataObject(0)->Initialize();
    return 0;
  }
  const Volume first = this->Internals->Get(0);
  if (!first.Image)
  {
    vtkErrorMacro(
      "The volume " << this->GetFileName(0) << " cannot be used: " << first.Problem << ".");
    this->GetOutputDataObject(0)->Initialize();
    return 0;
  }
  info->Set(Pipeline::WHOLE_EXTENT(), first.Image->GetExtent(), 6);
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  // Steps may lie elsewhere: the executive asks again when it knows the time.
  vtkSmartPointer<vtkImageData> place = first.Image;
  if (request->Has(Pipeline::REQUEST_TIME_DEPENDENT_INFORMATION()) &&
    info->Has(Pipeline::UPDATE_TIME_STEP()) && !std::isnan(info->Get(Pipeline::UPDATE_TIME_STEP())))
  {
    const double at = this->FindPlace(info->Get(Pipeline::UPDATE_TIME_STEP()));
    const Volume shown = this->Internals->Get(FindStep(at));
    place = shown.Image ? shown.Image : place;
  }
  info->Set(vtkDataObject::ORIGIN(), place->GetOrigin(), 3);
  info->Set(vtkDataObject::SPACING(), place->GetSpacing(), 3);
  info->Set(vtkDataObject::DIRECTION(), place->GetDirectionMatrix()->GetData(), 9);
  if (vtkDataArray* scalars = first.Image->GetPointData()->GetScalars())
  {
    vtkDataObject::SetPointDataActiveScalarInfo(
      info, scalars->GetDataType(), scalars->GetNumberOfComponents());
  }
  if (count > 1)
  {
    std::vector<double> times;
    for (int i = 0; i < count; ++i)
    {
      times.push_back(this->TimeStart + i * this->TimeSpacing);
    }
    if (!std::isfinite(times.back()))
    {
      vtkErrorMacro("The time of the last of "
        << count << " files is not finite. Give a smaller "
        << "TimeStart (" << this->TimeStart << ") or TimeSpacing (" << this->TimeSpacing << ").");
      this->GetOutputDataObject(0)->Initialize();
      return 0;
    }
    const double range[2] = { times.front(), times.back() };
    info->Set(Pipeline::TIME_DEPENDENT_INFORMATION(), 1);
    info->Set(Pipeline::TIME_STEPS(), times.data(), count);
    info->Set(Pipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDVolumeSeries::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkImageData* output = vtkImageData::GetData(outputs);
  const int count = this->GetNumberOfFileNames();
  if (!output || count == 0)
  {
    return 0;
  }
  output->Initialize();
  const double time = info->Has(Pipeline::UPDATE_TIME_STEP())
    ? info->Get(Pipeline::UPDATE_TIME_STEP())
    : this->TimeStart;
  if (std::isnan(time))
  {
    vtkErrorMacro("The time that a volume is asked for is not a number.");
    return 0;
  }
  const double place = this->FindPlace(time);
  const int step = FindStep(place);
  const double part = std::max(place - step, 0.0);
  const bool between = this->Interpolation == LINEAR && part > Rounding && step + 1 < count;
  const int last = between ? step + 1 : step;
  Volume volumes[2];
  for (int i = step; i <= last; ++i)
  {
    Volume& volume = volumes[i - step];
    volume = this->Internals->Get(i);
    int whole[6];
    info->Get(Pipeline::WHOLE_EXTENT(), whole);
    if (volume.Image && !std::equal(whole, whole + 6, volume.Image->GetExtent()))
    {
      volume.Problem = "it has other numbers of voxels than the first of the series";
    }
    else if (volume.Image && i > step && !LieAlike(volumes[0].Image, volume.Image))
    {
      volume.Problem = "it lies elsewhere than " + std::string(this->GetFileName(step)) +
        ", or is of another spacing or direction, and there is nothing between both; set "
        "Interpolation to STEP";
    }
    if (!volume.Problem.empty())
    {
      vtkErrorMacro(
        "The volume " << this->GetFileName(i) << " cannot be used: " << volume.Problem << ".");
      return 0;
    }
  }
  output->ShallowCopy(volumes[0].Image);
  if (between)
  {
    BlendArrays(volumes[0].Image->GetPointData(), volumes[1].Image->GetPointData(), part,
      output->GetPointData());
    BlendArrays(volumes[0].Image->GetCellData(), volumes[1].Image->GetCellData(), part,
      output->GetCellData());
    vtkFFDFindArrayRanges(output->GetPointData());
  }
  int extent[6];
  info->Get(Pipeline::UPDATE_EXTENT(), extent);
  if (extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5])
  {
    output->Initialize(); // of a process that has no part
  }
  else if (!std::equal(extent, extent + 6, output->GetExtent()))
  {
    output->Crop(extent);
  }
  if (count > 1)
  {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    if (this->Prefetch)
    {
      this->Internals->ReadAhead(step, last);
    }
    this->Internals->Limit(1048576.0 * this->CacheSize);
  }
  return 1;
}
