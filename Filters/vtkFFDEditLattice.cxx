// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDEditLattice.h"

#include "vtkFFDContentTime.h"
#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFFDOptions.h"

#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataObjectTree.h"
#include "vtkDataSet.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDataObjectMetaDataKey.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkRectilinearGrid.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDEditLattice);

vtkInformationKeyMacro(vtkFFDEditLattice, LATTICE, DataObjectMetaData);

namespace
{

const char* const GeometryModeName = "FFDGeometryMode";

/// sum += from, of the size of the lattice.
void AddDisplacements(vtkFFDLattice* sum, const double* from)
{
  vtkDoubleArray* to = sum->GetDisplacements();
  for (vtkIdType i = 0; i < to->GetNumberOfValues(); ++i)
  {
    to->SetValue(i, to->GetValue(i) + from[i]);
  }
  sum->Modified();
}

std::size_t CountValues(const int sizes[3])
{
  return 3 * static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]) *
    static_cast<std::size_t>(sizes[2]);
}

/// Which of two lattices so many values are meant for; null: neither, or there are none.
const int* FindSizes(std::size_t values, const int meant[3], const int own[3])
{
  const int* sizes = values == CountValues(meant) ? meant : own;
  return values > 0 && values == CountValues(sizes) ? sizes : nullptr;
}

/// `bounds` enlarged by `other`, either of which may be those of nothing.
void AddBounds(double bounds[6], const double other[6])
{
  if (other[0] <= other[1] && other[2] <= other[3] && other[4] <= other[5])
  {
    for (int a = 0; a < 6; a += 2)
    {
      bounds[a] = std::min(bounds[a], other[a]);
      bounds[a + 1] = std::max(bounds[a + 1], other[a + 1]);
    }
  }
}

/// Enlarges bounds to those of all processes, which all call it.
void ReduceBounds(double bounds[6])
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  if (!controller || controller->GetNumberOfProcesses() == 1)
  {
    return;
  }
  double mine[6];
  double all[6];
  for (int i = 0; i < 6; ++i)
  {
    mine[i] = i % 2 == 0 ? bounds[i] : -bounds[i];
  }
  controller->AllReduce(mine, all, 6, vtkCommunicator::MIN_OP);
  for (int i = 0; i < 6; ++i)
  {
    bounds[i] = i % 2 == 0 ? all[i] : -all[i];
  }
}

/// Whether bounds are those of a place: finite, and not those of nothing.
bool AreFinite(const double bounds[6])
{
  return std::all_of(bounds, bounds + 6, [](double value) { return std::isfinite(value); }) &&
    bounds[0] <= bounds[1] && bounds[2] <= bounds[3] && bounds[4] <= bounds[5];
}

/// The largest of all processes, which all call it.
std::size_t FindLargest(std::size_t value)
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  const auto mine = static_cast<vtkIdType>(value);
  vtkIdType largest = mine;
  if (controller && controller->GetNumberOfProcesses() > 1)
  {
    controller->AllReduce(&mine, &largest, 1, vtkCommunicator::MAX_OP);
  }
  return static_cast<std::size_t>(largest);
}

constexpr double NoBounds[6] = { VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX,
  VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX };

} // namespace

//------------------------------------------------------------------------------
vtkFFDEditLattice::vtkFFDEditLattice() = default;

//------------------------------------------------------------------------------
vtkFFDEditLattice::~vtkFFDEditLattice() = default;

//------------------------------------------------------------------------------
void vtkFFDEditLattice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Dimensions: " << this->Dimensions[0] << ", " << this->Dimensions[1] << ", "
     << this->Dimensions[2] << "\n";
  os << indent << "Padding: " << this->Padding << "\n";
  os << indent << "UseInputLattice: " << this->UseInputLattice << "\n";
  os << indent << "Shape: " << this->Shape << "\n";
  os << indent << "Strength: " << this->Strength << "\n";
  os << indent << "Seed: " << this->Seed << "\n";
  os << indent << "BorderMode: " << this->BorderMode << "\n";
  os << indent << "DisplacementScale: " << this->DisplacementScale << "\n";
  os << indent << "NumberOfDisplacements: " << this->GetNumberOfDisplacements() << "\n";
  os << indent << "EditDimensions: " << this->EditDimensions[0] << ", " << this->EditDimensions[1]
     << ", " << this->EditDimensions[2] << "\n";
  os << indent << "LatticePerBlock: " << this->LatticePerBlock << "\n";
  os << indent << "GeometryMode: " << this->GeometryMode << "\n";
  os << indent << "Lattice:\n";
  this->Lattice->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
bool vtkFFDEditLattice::SetFinite(const char* name, double& member, double value)
{
  if (!std::isfinite(value))
  {
    vtkErrorMacro(<< name << " is " << value << ", it must be a finite number; it stays " << member
                  << ".");
    return false;
  }
  if (member != value)
  {
    member = value;
    this->Modified();
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetSizes(
  const char* name, int member[3], const int sizes[3], bool zeroAllowed)
{
  if (vtkFFDAreEditSizes(this, name, member, sizes, zeroAllowed) &&
    !std::equal(sizes, sizes + 3, member))
  {
    std::copy_n(sizes, 3, member);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetDimensions(int nx, int ny, int nz)
{
  const int sizes[3] = { nx, ny, nz };
  this->SetDimensions(sizes);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetDimensions(const int dimensions[3])
{
  this->SetSizes("Dimensions", this->Dimensions, dimensions, false);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetEditDimensions(int nx, int ny, int nz)
{
  const int sizes[3] = { nx, ny, nz };
  this->SetEditDimensions(sizes);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetEditDimensions(const int dimensions[3])
{
  this->SetSizes("EditDimensions", this->EditDimensions, dimensions, true);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetPadding(double padding)
{
  if (padding < 0.0 || padding > 10.0)
  {
    vtkErrorMacro(<< "Padding is " << padding << ", it must be from 0 to 10; it stays "
                  << this->Padding << ".");
    return;
  }
  this->SetFinite("Padding", this->Padding, padding);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetShape(int shape)
{
  if (shape < vtkFFDLatticeSource::IDENTITY || shape > vtkFFDLatticeSource::RANDOM)
  {
    vtkErrorMacro(<< "Shape is " << shape << "; give one of vtkFFDLatticeSource, IDENTITY (0) to "
                  << "RANDOM (" << vtkFFDLatticeSource::RANDOM << "). It stays " << this->Shape
                  << ".");
    return;
  }
  if (this->Shape != shape)
  {
    this->Shape = shape;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetStrength(double strength)
{
  this->SetFinite("Strength", this->Strength, strength);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetDisplacementScale(double scale)
{
  this->SetFinite("DisplacementScale", this->DisplacementScale, scale);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetNumberOfDisplacements(int count)
{
  if (count < 0 || count > vtkFFDLargestEditCount)
  {
    vtkErrorMacro(<< "NumberOfDisplacements is " << count << ", it must be from 0 to "
                  << vtkFFDLargestEditCount << "; it stays " << this->GetNumberOfDisplacements()
                  << ".");
    return;
  }
  if (count != this->GetNumberOfDisplacements())
  {
    this->Displacements.resize(3 * static_cast<std::size_t>(count), 0.0);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDEditLattice::GetNumberOfDisplacements() const
{
  return static_cast<int>(this->Displacements.size() / 3);
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::SetDisplacement(int index, double dx, double dy, double dz)
{
  if (index < 0 || index >= this->GetNumberOfDisplacements())
  {
    vtkErrorMacro(<< "There is no displacement " << index << ": there are "
                  << this->GetNumberOfDisplacements()
                  << ". Call SetNumberOfDisplacements() first.");
    return;
  }
  if (!std::isfinite(dx) || !std::isfinite(dy) || !std::isfinite(dz))
  {
    vtkErrorMacro(<< "Displacement " << index << " is (" << dx << ", " << dy << ", " << dz
                  << "), it must be finite; it stays as it was.");
    return;
  }
  double* d = &this->Displacements[3 * static_cast<std::size_t>(index)];
  if (d[0] != dx || d[1] != dy || d[2] != dz)
  {
    d[0] = dx;
    d[1] = dy;
    d[2] = dz;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDEditLattice::SetDisplacements(vtkDataArray* displacements)
{
  const vtkIdType count = displacements ? displacements->GetNumberOfTuples() : 0;
  if (!displacements || (count > 0 && displacements->GetNumberOfComponents() != 3) ||
    count > vtkFFDLargestEditCount)
  {
    vtkErrorMacro(<< "SetDisplacements: the array "
                  << (displacements ? "has another shape" : "is null") << ". Give up to "
                  << vtkFFDLargestEditCount << " tuples of 3 components, x fastest.");
    return 0;
  }
  std::vector<double> values(3 * static_cast<std::size_t>(count));
  for (vtkIdType i = 0; i < count; ++i)
  {
    double* d = &values[3 * static_cast<std::size_t>(i)];
    displacements->GetTuple(i, d);
    if (!std::isfinite(d[0]) || !std::isfinite(d[1]) || !std::isfinite(d[2]))
    {
      vtkErrorMacro(<< "SetDisplacements: displacement " << i << " is (" << d[0] << ", " << d[1]
                    << ", " << d[2] << "), it must be finite; all stay as they were.");
      return 0;
    }
  }
  if (values != this->Displacements)
  {
    this->Displacements = std::move(values);
    this->Modified();
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDEditLattice::GetDisplacement(int index, double displacement[3]) const
{
  std::fill_n(displacement, 3, 0.0);
  if (index >= 0 && index < this->GetNumberOfDisplacements())
  {
    std::copy_n(&this->Displacements[3 * static_cast<std::size_t>(index)], 3, displacement);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDEditLattice::AddEdits(
  const std::vector<double>& edits, const int editDimensions[3], vtkFFDLattice* lattice)
{
  const int* own = lattice->GetDimensions();
  const int* sizes = FindSizes(edits.size(), editDimensions, own);
  if (!sizes)
  {
    return false;
  }
  if (std::equal(sizes, sizes + 3, own))
  {
    AddDisplacements(lattice, edits.data());
    return true;
  }
  vtkNew<vtkFFDLattice> resized;
  resized->DeepCopy(lattice);
  resized->Reset();
  resized->SetDimensions(sizes);
  std::copy(edits.begin(), edits.end(), resized->GetDisplacements()->GetPointer(0));
  resized->Modified();
  resized->SetDimensions(own);
  AddDisplacements(lattice, resized->GetDisplacements()->GetPointer(0));
  return true;
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDEditLattice::GetLattice() { return this->Lattice; }

//------------------------------------------------------------------------------
int vtkFFDEditLattice::GetGeometryModeOf(vtkDataObject* data)
{
  vtkFieldData* fields = data ? data->GetFieldData() : nullptr;
  vtkDataArray* mode = fields ? fields->GetArray(GeometryModeName) : nullptr;
  if (!mode || mode->GetNumberOfValues() != 1)
  {
    return EXACT;
  }
  const double value = mode->GetComponent(0, 0);
  return value == FIRST_ORDER || value == PULL_BACK || value == AT_REST ? static_cast<int>(value)
                                                                        : EXACT;
}

//------------------------------------------------------------------------------
int* vtkFFDEditLattice::GetLatticeDimensions() { return this->Lattice->GetDimensions(); }

//------------------------------------------------------------------------------
double* vtkFFDEditLattice::GetLatticeDomain() { return this->Lattice->GetDomain(); }

//------------------------------------------------------------------------------
double vtkFFDEditLattice::GetMinimumJacobianBound()
{
  return this->Lattice->GetMinimumJacobianBound();
}

//------------------------------------------------------------------------------
vtkDoubleArray* vtkFFDEditLattice::GetBaseDisplacements()
{
  return this->BaseLattice->GetDisplacements();
}

//------------------------------------------------------------------------------
double vtkFFDEditLattice::GetLatticeDisplacementScale()
{
  return this->Lattice->GetDisplacementScale();
}

//------------------------------------------------------------------------------
/// Set Lattice, for data of these bounds. Returns false when there are none.
bool vtkFFDEditLattice::MakeLattice(
  const double bounds[6], vtkFFDLattice* inputLattice, bool report)
{
  const bool ofInput = inputLattice && this->UseInputLattice;
  if (!ofInput &&
    (!AreFinite(bounds) ||
      !(bounds[0] < bounds[1] || bounds[2] < bounds[3] || bounds[4] < bounds[5])))
  {
    return false;
  }
  const int* sizes = this->Dimensions;
  if (report && !this->Displacements.empty() &&
    !FindSizes(this->Displacements.size(), this->EditDimensions, sizes))
  {
    vtkErrorMacro(
      << "There are " << this->GetNumberOfDisplacements() << " displacements, but a lattice of "
      << sizes[0] << " x " << sizes[1] << " x " << sizes[2] << " control points has "
      << CountValues(sizes) / 3
      << ". They are not used. Give as many, none, or set EditDimensions (in ParaView "
         "DisplacementsResolution) to the size of the lattice that they are meant for.");
  }
  // RequestInformation may have made them already.
  const vtkMTimeType changed =
    std::max({ this->GetMTime(), this->Lattice->GetMTime(), this->BaseLattice->GetMTime() });
  if (!ofInput && this->MadeTime > changed && std::equal(bounds, bounds + 6, this->DataBounds))
  {
    return true;
  }

  vtkNew<vtkFFDLattice> made;
  if (ofInput)
  {
    made->DeepCopy(inputLattice);
  }
  else
  {
    made->FitToBounds(bounds, this->Padding);
    made->SetBorderMode(this->BorderMode);
  }
  made->SetDimensions(this->Dimensions);

  if (this->Shape != vtkFFDLatticeSource::IDENTITY)
  {
    vtkNew<vtkDoubleArray> given;
    given->DeepCopy(made->GetDisplacements());
    vtkFFDLatticeSource::ApplyShape(made, this->Shape, this->Strength, this->Seed);
    AddDisplacements(made, given->GetPointer(0));
  }
  this->BaseLattice->DeepCopy(made);

  AddEdits(this->Displacements, this->EditDimensions, made);
  made->SetDisplacementScale(made->GetDisplacementScale() * this->DisplacementScale);
  // Times say whether a lattice changed: this one does only when its values do.
  this->Lattice->DeepCopy(made);
  this->MadeTime = vtkTimeStamp();
  if (!ofInput)
  {
    this->MadeTime.Modified();
  }
  if (vtkMath::AreBoundsInitialized(bounds))
  {
    std::copy_n(bounds, 6, this->DataBounds);
  }
  return true;
}

//------------------------------------------------------------------------------
int vtkFFDEditLattice::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkRectilinearGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  // Or else VTK would give this filter its blocks one by one, each of which would get a lattice.
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUniformGridAMR");
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDEditLattice::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
  return 1;
}

//------------------------------------------------------------------------------
vtkTypeBool vtkFFDEditLattice::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  return vtkFFDGuardedRequest(this, "vtkFFDEditLattice", outputs, [&] {
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT()))
    {
      this->MakeOutput(inputs, outputs);
      return 1;
    }
    return static_cast<int>(this->Superclass::ProcessRequest(request, inputs, outputs));
  });
}

//------------------------------------------------------------------------------
/// Set an output of the type of the input, or for an AMR a multi-block data set, as VTK does.
void vtkFFDEditLattice::MakeOutput(vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputs);
  const bool isTree = vtkDataObjectTree::SafeDownCast(input) != nullptr;
  const bool isOtherComposite = !isTree && vtkCompositeDataSet::SafeDownCast(input);
  const char* type = "vtkImageData";
  if (input)
  {
    type = isOtherComposite ? "vtkMultiBlockDataSet" : input->GetClassName();
  }
  // Uniform grids are images, for which an output that is there stays.
  if (output &&
    (output->IsA(type) || (vtkImageData::SafeDownCast(input) && output->IsA("vtkImageData"))))
  {
    return;
  }
  vtkSmartPointer<vtkDataObject> made;
  if (!input || vtkImageData::SafeDownCast(input))
  {
    made = vtkSmartPointer<vtkImageData>::New();
  }
  else if (isOtherComposite)
  {
    made = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  }
  else
  {
    made.TakeReference(input->NewInstance());
  }
  outputs->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), made);
}

//------------------------------------------------------------------------------
int vtkFFDEditLattice::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (!this->Superclass::RequestInformation(request, inputs, outputs))
  {
    return 0;
  }
  vtkInformation* in = inputs[0]->GetInformationObject(0);
  vtkInformation* out = outputs->GetInformationObject(0);
  out->Remove(LATTICE());
  if (!in || !in->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    return 1;
  }
  out->CopyEntry(in, vtkDataObject::DIRECTION());
  vtkSmartPointer<vtkFFDLattice> upstream;
  if (vtkImageData* points = vtkImageData::SafeDownCast(in->Get(LATTICE())))
  {
    upstream = vtkSmartPointer<vtkFFDLattice>::New();
    upstream = upstream->FromImageData(points) ? upstream : nullptr;
  }
  // A lattice that only the data has is not known yet.
  vtkDataObject* object = in->Get(vtkDataObject::DATA_OBJECT());
  vtkImageData* data = vtkImageData::SafeDownCast(object);
  // Nor are the bounds of other data.
  if (object && !data)
  {
    return 1;
  }
  if (!upstream && this->UseInputLattice && data && vtkFFDLattice::HasLattice(data))
  {
    return 1;
  }
  vtkNew<vtkImageData> geometry;
  // Where the direction is not announced, that of the last image is the best guess.
  vtkFFDGetWholeGeometry(in, in->Has(vtkDataObject::DIRECTION()) ? nullptr : data, geometry);
  double bounds[6];
  geometry->GetBounds(bounds);
  if (this->MakeLattice(bounds, upstream, false))
  {
    vtkNew<vtkImageData> image;
    this->Lattice->ToImageData(image);
    out->Set(LATTICE(), image);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDEditLattice::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputs);
  if (!input || !output)
  {
    vtkErrorMacro("There is no image to deform. Connect a vtkImageData to the input.");
    return 0;
  }
  if (vtkCompositeDataSet::SafeDownCast(input))
  {
    return this->RequestBlocks(input, output);
  }
  double bounds[6];
  if (auto* grid = vtkRectilinearGrid::SafeDownCast(input))
  {
    std::copy_n(NoBounds, 6, bounds);
    if (grid->GetNumberOfPoints() > 0)
    {
      AddBounds(bounds, grid->GetBounds());
    }
    ReduceBounds(bounds);
    return this->Attach(input, bounds, output);
  }
  // The image may be a part of the whole; the lattice is that of the whole.
  vtkNew<vtkImageData> geometry;
  vtkFFDGetWholeGeometry(
    inputs[0]->GetInformationObject(0), vtkImageData::SafeDownCast(input), geometry);
  geometry->GetBounds(bounds);
  return this->Attach(input, bounds, output);
}

//------------------------------------------------------------------------------
/// Make the output the input with a lattice over `bounds`. Returns false after an error.
bool vtkFFDEditLattice::Attach(vtkDataObject* input, const double bounds[6], vtkDataObject* output)
{
  output->ShallowCopy(input);
  // Field data of our own, so that the lattice is not attached to the input, too.
  vtkNew<vtkFieldData> fields;
  if (input->GetFieldData())
  {
    fields->PassData(input->GetFieldData());
  }
  fields->RemoveArray(GeometryModeName);
  if (this->GeometryMode != EXACT)
  {
    vtkNew<vtkIntArray> mode;
    mode->SetName(GeometryModeName);
    mode->InsertNextValue(this->GeometryMode);
    fields->AddArray(mode);
  }
  output->SetFieldData(fields);
  vtkDataSet* data = vtkDataSet::SafeDownCast(input);
  // Attaching changes the field data only.
  vtkFFDPassContentTime(data, vtkDataSet::SafeDownCast(output));

  vtkSmartPointer<vtkFFDLattice> attached;
  if (this->UseInputLattice && vtkFFDLattice::HasLattice(input))
  {
    attached = vtkSmartPointer<vtkFFDLattice>::New();
    if (!attached->ReadFrom(input))
    {
      return false;
    }
  }
  if (!this->MakeLattice(bounds, attached, true))
  {
    if (data->GetNumberOfPoints() > 0)
    {
      vtkErrorMacro(
        << (AreFinite(bounds)
               ? "The image has no extent along any axis"
               : "The origin, the spacing, the direction or the coordinates of the image "
                 "are not finite numbers")
        << ", it passes through without a lattice.");
    }
    return true;
  }
  return this->Lattice->AttachTo(output) != 0;
}

//------------------------------------------------------------------------------
/// The blocks of a composite data set, with one lattice or one for each; of a block several
/// processes may have parts. Called on all processes.
int vtkFFDEditLattice::RequestBlocks(vtkDataObject* input, vtkDataObject* output)
{
  auto* from = vtkCompositeDataSet::SafeDownCast(input);
  auto* to = vtkDataObjectTree::SafeDownCast(output);
  vtkSmartPointer<vtkCompositeDataIterator> iterator;
  iterator.TakeReference(from->NewIterator());
  iterator->SkipEmptyNodesOff(); // other processes may have them
  std::size_t place = 0;
  using Bounds = std::array<double, 6>;
  Bounds none;
  std::copy_n(NoBounds, 6, none.begin());
  std::vector<Bounds> bounds(1, none); // of the blocks by their place, or of all of them
  const auto visit = [&](const std::function<bool(vtkDataSet*)>& work) {
    bool done = true;
    place = 0;
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      vtkDataSet* block = vtkDataSet::SafeDownCast(iterator->GetCurrentDataObject());
      done = (!block || work(block)) && done;
      ++place;
    }
    return done;
  };
  const auto findPlaceOfLattice = [this, &place]() { return this->LatticePerBlock ? place : 0; };
  visit([&](vtkDataSet* block) {
    if (block->GetNumberOfPoints() > 0)
    {
      const std::size_t ofLattice = findPlaceOfLattice();
      bounds.resize(std::max(bounds.size(), ofLattice + 1), none);
      AddBounds(bounds[ofLattice].data(), block->GetBounds());
    }
    return true;
  });
  if (vtkDataObjectTree::SafeDownCast(from))
  {
    to->CopyStructure(from);
  }
  else
  {
    vtkMultiBlockDataSet::SafeDownCast(to)->SetNumberOfBlocks(static_cast<unsigned int>(place));
  }
  bounds.resize(FindLargest(bounds.size()), none);
  for (Bounds& each : bounds)
  {
    ReduceBounds(each.data());
  }
  return visit([&](vtkDataSet* block) {
    vtkSmartPointer<vtkDataSet> made;
    made.TakeReference(block->NewInstance());
    if (vtkDataObjectTree::SafeDownCast(from))
    {
      to->SetDataSet(iterator, made);
    }
    else
    {
      vtkMultiBlockDataSet::SafeDownCast(to)->SetBlock(static_cast<unsigned int>(place), made);
    }
    const std::size_t ofLattice = findPlaceOfLattice();
    return this->Attach(block, (ofLattice < bounds.size() ? bounds[ofLattice] : none).data(), made);
  });
}
