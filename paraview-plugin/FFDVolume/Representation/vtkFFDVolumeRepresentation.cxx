// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCellData.h"
#include "vtkCellDataToPointData.h"
#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkPVLODVolume.h"
#include "vtkPVRenderView.h"
#include "vtkPVView.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkPolyDataMapper.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkVolumeProperty.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <array>
#include <cmath>

vtkStandardNewMacro(vtkFFDVolumeRepresentation);

namespace
{

using Bounds = std::array<double, 6>;

bool IsValid(const Bounds& bounds)
{
  return bounds[0] <= bounds[1] && bounds[2] <= bounds[3] && bounds[4] <= bounds[5];
}

/// A component of an array, or the magnitude of its tuples for component -1.
vtkSmartPointer<vtkDataArray> ExtractComponent(vtkDataArray* from, int component)
{
  vtkSmartPointer<vtkDataArray> to;
  const int components = from->GetNumberOfComponents();
  if (component >= 0)
  {
    to.TakeReference(from->NewInstance());
    to->SetNumberOfTuples(from->GetNumberOfTuples());
    to->CopyComponent(0, from, std::min(component, components - 1));
    return to;
  }
  to.TakeReference(vtkDataArray::CreateDataArray(VTK_FLOAT));
  to->SetNumberOfTuples(from->GetNumberOfTuples());
  vtkSMPTools::For(0, from->GetNumberOfTuples(),
    [from, components, array = to.Get()](vtkIdType first, vtkIdType last)
    {
      for (vtkIdType i = first; i < last; ++i)
      {
        double square = 0.0;
        for (int c = 0; c < components; ++c)
        {
          const double value = from->GetComponent(i, c);
          square += value * value;
        }
        array->SetComponent(i, 0, std::sqrt(square));
      }
    });
  return to;
}

bool HaveSameGeometry(vtkImageData* a, vtkImageData* b)
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      if (a->GetDirectionMatrix()->GetElement(row, column) !=
        b->GetDirectionMatrix()->GetElement(row, column))
      {
        return false;
      }
    }
  }
  return std::equal(a->GetExtent(), a->GetExtent() + 6, b->GetExtent()) &&
    std::equal(a->GetOrigin(), a->GetOrigin() + 3, b->GetOrigin()) &&
    std::equal(a->GetSpacing(), a->GetSpacing() + 3, b->GetSpacing());
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDVolumeRepresentation::vtkInternals
{
public:
  // What the mapper renders: the geometry of the delivered image and one array of one component on
  // its points. It is left alone when only the lattice changes, so that the mapper keeps what it
  // has found out about the voxels.
  vtkNew<vtkImageData> Rendered;
  vtkNew<vtkFFDLattice> Lattice;
  vtkMTimeType LatticeTime = 0;
  vtkWeakPointer<vtkDataArray> SourceArray;
  vtkMTimeType SourceTime = 0;
  int SourceComponent = -2;

  // Finds deformed bounds: they depend on the bounds and the lattice alone.
  vtkNew<vtkFFDInverseRayVolumeMapper> BoundsFinder;

  Bounds FindDeformedBounds(const Bounds& rest, vtkImageData* withLattice, int inverseMode)
  {
    vtkNew<vtkImageData> corners;
    corners->SetDimensions(2, 2, 2);
    corners->SetOrigin(rest[0], rest[2], rest[4]);
    corners->SetSpacing(rest[1] - rest[0], rest[3] - rest[2], rest[5] - rest[4]);
    corners->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    std::fill_n(static_cast<unsigned char*>(corners->GetScalarPointer()), 8, 0);
    if (withLattice && vtkFFDLattice::HasLattice(withLattice))
    {
      vtkNew<vtkFFDLattice> lattice;
      if (lattice->ReadFrom(withLattice))
      {
        lattice->AttachTo(corners);
      }
    }
    this->BoundsFinder->SetInputData(corners);
    this->BoundsFinder->SetInverseMode(inverseMode);
    this->BoundsFinder->SetInverseTolerance(1e-3);
    Bounds deformed;
    this->BoundsFinder->GetBounds(deformed.data());
    this->BoundsFinder->SetInputData(static_cast<vtkImageData*>(nullptr));
    return IsValid(deformed) ? deformed : rest;
  }
};

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::vtkFFDVolumeRepresentation()
  : Mapper(vtkFFDInverseRayVolumeMapper::New())
  , Internals(new vtkInternals)
{
  this->VolumeMapper.TakeReference(this->Mapper);
}

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::~vtkFFDVolumeRepresentation() = default;

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "Mapper:\n";
  this->Mapper->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::FillInputPortInformation(int, vtkInformation* info)
{
  // Wider than what can be rendered: RequestData says what is wrong.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  return this->Superclass::RequestUpdateExtent(request, inputs, outputs);
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::RequestData(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkMath::UninitializeBounds(this->DataBounds);
  this->DataSize = 0;
  std::fill_n(this->WholeExtent, 6, 0);
  vtkSmartPointer<vtkImageData> image;
  if (inputs[0]->GetNumberOfInformationObjects() == 1)
  {
    vtkInformation* info = inputs[0]->GetInformationObject(0);
    vtkDataObject* input = vtkDataObject::GetData(info);
    vtkImageData* inputImage = vtkImageData::SafeDownCast(input);
    if (input && !inputImage)
    {
      vtkErrorMacro(<< "The representation \"FFD Volume\" renders image data, and this is a "
                    << input->GetClassName()
                    << ". Apply the filter \"Resample To Image\" first, or choose another "
                       "representation.");
    }
    else if (inputImage)
    {
      vtkStreamingDemandDrivenPipeline::GetWholeExtent(info, this->WholeExtent);
      image = vtkSmartPointer<vtkImageData>::New();
      image->ShallowCopy(inputImage);
    }
  }
  if (image && image->GetNumberOfPoints() > 0)
  {
    Bounds rest;
    image->GetBounds(rest.data());
    const Bounds deformed =
      this->Internals->FindDeformedBounds(rest, image, this->Mapper->GetInverseMode());
    std::copy(deformed.begin(), deformed.end(), this->DataBounds);
    this->DataSize = image->GetActualMemorySize();
    this->Cache = image;
    this->Actor->SetEnableLOD(0);
    this->OutlineSource->SetBounds(this->DataBounds);
    this->OutlineSource->Update();
  }
  else
  {
    // A client, or a rank without data: an empty data object for the delivery, and the outline.
    this->Cache = vtkSmartPointer<vtkPartitionedDataSet>::New();
    this->VolumeMapper->RemoveAllInputs();
    this->Actor->SetEnableLOD(1);
  }
  return this->vtkVolumeRepresentation::RequestData(request, inputs, outputs);
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::ProcessViewRequest(
  vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo)
{
  if (request == vtkPVView::REQUEST_RENDER())
  {
    // Not the superclass's: it connects the mapper to what was delivered.
    if (!this->vtkVolumeRepresentation::ProcessViewRequest(request, inInfo, outInfo))
    {
      return 0;
    }
    vtkAlgorithmOutput* producer = vtkPVRenderView::GetPieceProducer(inInfo, this, 0);
    vtkImageData* image = producer
      ? vtkImageData::SafeDownCast(
          producer->GetProducer()->GetOutputDataObject(producer->GetIndex()))
      : nullptr;
    this->UpdateMapperParameters();
    this->UpdateRenderedImage(image);
    if (image)
    {
      this->UpdateSampleDistances(image);
    }
    this->OutlineMapper->SetInputConnection(vtkPVRenderView::GetPieceProducer(inInfo, this, 1));
    return 1;
  }
  return this->Superclass::ProcessViewRequest(request, inInfo, outInfo);
}

//------------------------------------------------------------------------------
/// Give the mapper the image, with the array to render as point data of one component.
void vtkFFDVolumeRepresentation::UpdateRenderedImage(vtkImageData* image)
{
  vtkInternals& in = *this->Internals;
  if (!image)
  {
    this->VolumeMapper->RemoveAllInputs();
    return;
  }
  vtkInformation* info = this->GetInputArrayInformation(0);
  const char* named =
    info && info->Has(vtkDataObject::FIELD_NAME()) ? info->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  const char* name = named ? named : "";
  const bool cells = info && info->Has(vtkDataObject::FIELD_ASSOCIATION()) &&
    info->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  int component = -1;
  vtkColorTransferFunction* colours =
    this->Property ? this->Property->GetRGBTransferFunction(0) : nullptr;
  if (colours && colours->GetVectorMode() == vtkScalarsToColors::COMPONENT)
  {
    component = colours->GetVectorComponent();
  }
  vtkDataArray* source = cells ? image->GetCellData()->GetArray(name)
                               : image->GetPointData()->GetArray(name);
  const vtkMTimeType time = source ? source->GetMTime() : 0;
  if (in.SourceArray != source || in.SourceTime != time || in.SourceComponent != component ||
    !HaveSameGeometry(in.Rendered, image))
  {
    in.SourceArray = source;
    in.SourceTime = time;
    in.SourceComponent = component;
    vtkSmartPointer<vtkDataArray> array = source;
    if (array && cells)
    {
      vtkNew<vtkImageData> onlyThis;
      onlyThis->CopyStructure(image);
      onlyThis->GetCellData()->AddArray(array);
      vtkNew<vtkCellDataToPointData> average;
      average->SetInputData(onlyThis);
      average->Update();
      array = average->GetOutput()->GetPointData()->GetArray(name);
    }
    if (array && array->GetNumberOfComponents() > 1)
    {
      array = ExtractComponent(array, component);
      array->SetName(name);
    }
    in.Rendered->Initialize();
    in.Rendered->CopyStructure(image);
    if (array)
    {
      in.Rendered->GetPointData()->AddArray(array);
    }
  }
  if (this->VolumeMapper->GetInputDataObject(0, 0) != in.Rendered)
  {
    this->VolumeMapper->SetInputData(in.Rendered);
  }
  this->VolumeMapper->SelectScalarArray(name);
  this->VolumeMapper->SetScalarMode(VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);

  if (!vtkFFDLattice::HasLattice(image))
  {
    this->Mapper->SetDeformation(nullptr);
  }
  else
  {
    const vtkMTimeType fields = image->GetFieldData()->GetMTime();
    if (fields != in.LatticeTime)
    {
      in.Lattice->ReadFrom(image);
      in.LatticeTime = fields;
    }
    this->Mapper->SetDeformation(in.Lattice);
  }
}

//------------------------------------------------------------------------------
/// The mapper takes distances in world units.
void vtkFFDVolumeRepresentation::UpdateSampleDistances(vtkImageData* image)
{
  if (this->SampleDistance == 1.0)
  {
    this->Mapper->LockSampleDistanceToInputSpacingOn();
    return;
  }
  double spacing[3];
  image->GetSpacing(spacing);
  this->Actor->ComputeMatrix();
  vtkMatrix4x4* matrix = this->Actor->GetMatrix();
  vtkMatrix3x3* direction = image->GetDirectionMatrix();
  double voxel = VTK_DOUBLE_MAX;
  for (int a = 0; a < 3; ++a)
  {
    const double edge[4] = { direction->GetElement(0, a) * spacing[a],
      direction->GetElement(1, a) * spacing[a], direction->GetElement(2, a) * spacing[a], 0.0 };
    double moved[4];
    matrix->MultiplyPoint(edge, moved);
    voxel = std::min(voxel, vtkMath::Norm(moved));
  }
  if (voxel > 0.0)
  {
    this->Mapper->SetSampleDistance(this->SampleDistance * voxel);
    this->Mapper->SetInteractiveSampleDistance(2.0 * this->SampleDistance * voxel);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::UpdateMapperParameters()
{
  // Not the superclass's: it selects the array that UpdateRenderedImage() may have to derive from.
  vtkInformation* info = this->GetInputArrayInformation(0);
  const char* name =
    info && info->Has(vtkDataObject::FIELD_NAME()) ? info->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  if (this->Actor->GetMapper() != this->VolumeMapper)
  {
    this->Actor->SetMapper(this->VolumeMapper);
  }
  this->Actor->SetVisibility(name && name[0]);
  if (this->Property)
  {
    this->Property->SetIndependentComponents(true);
    this->Property->SetTransferFunctionMode(vtkVolumeProperty::TF_1D);
  }
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDVolumeRepresentation::GetNumberOfLocalVoxels()
{
  vtkImageData* image = vtkImageData::SafeDownCast(this->Cache);
  return image ? image->GetNumberOfPoints() : 0;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetInverseMode(int mode)
{
  if (mode != this->Mapper->GetInverseMode())
  {
    this->Mapper->SetInverseMode(mode);
    // The bounds change.
    this->MarkModified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOpacityLength(int length)
{
  this->Mapper->SetOpacityLength(length);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetSpaceLeaping(int leaping)
{
  this->Mapper->SetSpaceLeaping(leaping);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetSegmentation(int segmentation)
{
  this->Mapper->SetSegmentation(segmentation);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetInverseTolerance(double voxels)
{
  this->Mapper->SetInverseTolerance(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPositionTolerance(double voxels)
{
  this->Mapper->SetPositionTolerance(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetAngleThreshold(double degrees)
{
  this->Mapper->SetAngleThreshold(degrees);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetMinimumSegmentLength(double voxels)
{
  this->Mapper->SetMinimumSegmentLength(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetMaximumSegmentLength(double voxels)
{
  this->Mapper->SetMaximumSegmentLength(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetEarlyRayTerminationThreshold(double transmittance)
{
  this->Mapper->SetEarlyRayTerminationThreshold(transmittance);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetNumberOfThreads(int threads)
{
  this->Mapper->SetNumberOfThreads(threads);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetSampleDistance(double voxels)
{
  if (!(voxels >= 0.05 && voxels <= 10.0))
  {
    vtkErrorMacro(<< "SampleDistance must be from 0.05 to 10 voxels, not " << voxels
                  << "; it stays " << this->SampleDistance << ".");
    return;
  }
  this->SampleDistance = voxels;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetImageSampleDistance(double pixels)
{
  if (!(pixels >= 0.25 && pixels <= 8.0))
  {
    vtkErrorMacro(<< "ImageSampleDistance must be from 0.25 to 8 pixels, not " << pixels << ".");
    return;
  }
  this->Mapper->SetImageSampleDistance(pixels);
  this->Mapper->SetMinimumImageSampleDistance(pixels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetAdaptInteractiveQuality(bool adapt)
{
  this->Mapper->SetAutoAdjustSampleDistances(adapt);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPosition(double x, double y, double z)
{
  this->Superclass::SetPosition(x, y, z);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetScale(double x, double y, double z)
{
  this->Superclass::SetScale(x, y, z);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOrientation(double x, double y, double z)
{
  this->Superclass::SetOrientation(x, y, z);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOrigin(double x, double y, double z)
{
  this->Superclass::SetOrigin(x, y, z);
}
