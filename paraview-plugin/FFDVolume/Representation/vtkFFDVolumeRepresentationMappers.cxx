// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the mappers of the representation are given before a frame.
#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDShownArray.h"
#include "vtkFFDVolumeRepresentationInternals.h"

#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPVRenderView.h"
#include "vtkRenderWindow.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace
{

/// Largest factor by which interactive images are coarser, in each way.
constexpr double LargestCoarsening = 10.0;

/// Make a box of data coordinates the smallest one along the axes of the image that holds it, in
/// the coordinates that cropping planes of rest space have: origin + index x spacing.
void TakeIntoFrame(vtkImageData* image, double box[6])
{
  if (image->GetDirectionMatrix()->IsIdentity())
  {
    return;
  }
  const ffdparts::Bounds world = { box[0], box[1], box[2], box[3], box[4], box[5] };
  vtkNew<vtkMatrix4x4> toIndex;
  toIndex->DeepCopy(image->GetPhysicalToIndexMatrix());
  const ffdparts::Bounds indices = ffdparts::Transform(world, toIndex);
  for (int i = 0; i < 6; ++i)
  {
    box[i] = image->GetOrigin()[i / 2] + indices[i] * image->GetSpacing()[i / 2];
  }
}

} // namespace

//------------------------------------------------------------------------------
/// Finds the components of the image that are rendered, as ParaView's own Volume does.
vtkFFDShownComponents vtkFFDVolumeRepresentation::FindShown(vtkImageData* image)
{
  vtkFFDShownComponents shown;
  shown.Color.Array = vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0));
  vtkColorTransferFunction* colors =
    this->Property ? this->Property->GetRGBTransferFunction(0) : nullptr;
  if (colors && colors->GetVectorMode() == vtkScalarsToColors::COMPONENT)
  {
    shown.Color.Component = colors->GetVectorComponent();
  }
  const auto choose = [image](const std::string& name, int association, int component) {
    vtkFFDShownComponent chosen;
    chosen.Array.Name = name;
    chosen.Array.OfCells = association == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    vtkDataArray* array = chosen.Array.FindIn(image);
    // After the last component ParaView lists the magnitude.
    chosen.Component = array && component < array->GetNumberOfComponents()
      ? component
      : vtkFFDShownComponent::Magnitude;
    return array ? chosen : vtkFFDShownComponent();
  };
  if (this->UsesPlane())
  {
    if (!this->UseGradientForTransfer2D)
    {
      shown.Second = choose(
        this->ColorArray2Name, this->ColorArray2FieldAssociation, this->ColorArray2Component);
    }
    return shown;
  }
  if (this->UseSeparateOpacityArray)
  {
    shown.Opacity = choose(
      this->OpacityArrayName, this->OpacityArrayFieldAssociation, this->OpacityArrayComponent);
    return shown;
  }
  vtkDataArray* array = shown.Color.Array.FindIn(image);
  const int components = array ? array->GetNumberOfComponents() : 0;
  if ((this->MultiComponentsMapping || !this->MapScalars) && (components == 2 || components == 4))
  {
    shown.Color.Component = vtkFFDShownComponent::All;
  }
  return shown;
}

//------------------------------------------------------------------------------
/// Whether a two-dimensional transfer function is to be used, and there is one.
bool vtkFFDVolumeRepresentation::UsesPlane()
{
  return this->UseTransfer2D && this->Property && this->Property->GetTransferFunction2D(0);
}

//------------------------------------------------------------------------------
/// Give the property a larger table of a two-dimensional function, made as VTK's mappers make
/// theirs: ParaView's has 10 x 10 texels, and linear interpolation between these would be another
/// function.
void vtkFFDVolumeRepresentation::UpdateTable()
{
  constexpr int Least = 256;
  vtkInternals& in = *this->Internals;
  vtkImageData* table = this->Property->GetTransferFunction2D(0);
  if (table != in.FineTable->GetOutput())
  {
    in.Table = table;
  }
  const int* size = in.Table->GetDimensions();
  if (!in.Table->GetPointData()->GetScalars() || (size[0] >= Least && size[1] >= Least))
  {
    return;
  }
  in.FineTable->SetInputData(in.Table);
  in.FineTable->SetOutputDimensions(std::max(size[0], Least), std::max(size[1], Least), 1);
  in.FineTable->Update();
  this->Property->SetTransferFunction2D(in.FineTable->GetOutput());
}

//------------------------------------------------------------------------------
/// Set what opacities are over. The GPU mapper of ParaView's own Volume takes those of
/// two-dimensional functions for each sample, at vtkVolumeMapper::SpacingAdjustedSampleDistance()
/// of the whole volume. `whole`: bounds of it at rest, uninitialized if the image is all of it.
void vtkFFDVolumeRepresentation::UpdateUnitDistance(vtkImageData* image, const double whole[6])
{
  double length = this->UnitDistance;
  if (this->UsesPlane())
  {
    double spacing[3];
    image->GetSpacing(spacing);
    ffdparts::Extent extent;
    std::copy_n(this->WholeExtent, 6, extent.begin());
    const bool part = ffdparts::IsEmpty(extent) && vtkMath::AreBoundsInitialized(whole);
    if (ffdparts::IsEmpty(extent))
    {
      image->GetExtent(extent.data());
    }
    double cells = 1.0;
    for (int a = 0; a < 3; ++a)
    {
      cells *=
        part ? (whole[2 * a + 1] - whole[2 * a]) / spacing[a] : extent[2 * a + 1] - extent[2 * a];
    }
    length = (spacing[0] + spacing[1] + spacing[2]) / 6.0 *
      std::min(1.0, 0.01 + 0.99 * std::cbrt(std::max(cells, 0.0)) / 100.0);
  }
  if (length > 0.0)
  {
    this->Property->SetScalarOpacityUnitDistance(length);
  }
}

//------------------------------------------------------------------------------
/// Give the volumes after the first the options, the place and the look of that.
void vtkFFDVolumeRepresentation::UpdateOtherVolumes()
{
  vtkInternals& in = *this->Internals;
  const bool changed = in.OptionsTime != this->Mapper->GetMTime();
  for (std::size_t i = 1; i < in.AllShown.size(); ++i)
  {
    if (changed)
    {
      in.AllShown[i]->Mapper->ShallowCopy(this->Mapper);
    }
    vtkVolume* actor = in.AllShown[i]->Actor;
    actor->SetOrigin(this->Actor->GetOrigin());
    actor->SetPosition(this->Actor->GetPosition());
    actor->SetScale(this->Actor->GetScale());
    actor->SetOrientation(this->Actor->GetOrientation());
    actor->SetUserMatrix(this->Actor->GetUserMatrix());
    actor->SetPickable(this->Actor->GetPickable());
    actor->SetVisibility(this->Actor->GetVisibility());
    actor->SetProperty(this->Property);
  }
}

//------------------------------------------------------------------------------
/// Give a mapper the image, with what to render as point data.
void vtkFFDVolumeRepresentation::UpdateRenderedImage(std::size_t which, vtkImageData* image)
{
  vtkInternals::Shown& volume = *this->Internals->AllShown[which];
  vtkFFDInverseRayVolumeMapper* mapper = volume.Mapper;
  if (!image)
  {
    mapper->RemoveAllInputs();
    return;
  }
  const vtkFFDShownComponents shown = this->FindShown(image);
  volume.Rendered.Update(image, shown);
  if (mapper->GetInputDataObject(0, 0) != volume.Rendered.GetImage())
  {
    mapper->SetInputDataObject(volume.Rendered.GetImage());
  }
  mapper->SelectScalarArray(shown.Color.Array.Name.c_str());
  mapper->SetScalarMode(VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);
  const bool dependent =
    !shown.Opacity.Array.Name.empty() || shown.Color.Component == vtkFFDShownComponent::All;
  if (this->Property && which == 0)
  {
    this->Property->SetIndependentComponents(!dependent);
    this->Property->SetTransferFunctionMode(
      this->UsesPlane() ? vtkVolumeProperty::TF_2D : vtkVolumeProperty::TF_1D);
    if (this->UsesPlane())
    {
      this->UpdateTable();
    }
  }
  mapper->SetTransfer2DYAxisArray(
    shown.Second.Array.Name.empty() ? nullptr : vtkFFDShownComponents::SecondName);

  ffdparts::Bounds clip;
  ffdparts::Bounds whole = ffdparts::NoBounds;
  if (!vtkFFDVoxelDistribution::ReadBounds(image, clip, whole))
  {
    // All of space, and yet a box: the tiles of the picture are then as with several processes.
    const ffdparts::Bounds nothing{};
    clip = ffdparts::OpenOutwards(nothing, nothing);
  }
  mapper->SetClipBox(clip.data());
  mapper->SetWholeBounds(whole.data());
  if (this->Property && which == 0)
  {
    this->UpdateUnitDistance(image, whole.data());
  }
  std::array<double, 2> range{ { 1.0, -1.0 } };
  if (!dependent)
  {
    vtkFFDVoxelDistribution::ReadRange(image, shown.Color.Array, shown.Color.Component, range);
  }
  mapper->SetWholeScalarRange(range.data());
  mapper->SetDeformation(volume.Rendered.GetLattice());
}

//------------------------------------------------------------------------------
/// Say why an image is not shown, once for each change of it. ParaView renders no volume without
/// bounds, so that the mapper would not say it.
void vtkFFDVolumeRepresentation::ReportProblem(std::size_t which, bool hasArray)
{
  vtkInternals::Shown& volume = *this->Internals->AllShown[which];
  const vtkMTimeType time = std::max(volume.Rendered.GetImage()->GetMTime(),
    volume.Rendered.GetLattice() ? volume.Rendered.GetLattice()->GetMTime() : 0);
  const auto color = vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0));
  if (color.Name.empty() || volume.ReportTime == time)
  {
    return;
  }
  volume.ReportTime = time;
  if (!hasArray)
  {
    vtkErrorMacro(<< "The representation \"FFD Volume\" shows nothing: the data have no "
                  << (color.OfCells ? "cell" : "point") << " array \"" << color.Name
                  << "\". Choose another one to color by.");
    return;
  }
  if (!vtkMath::AreBoundsInitialized(volume.Mapper->GetBounds()))
  {
    // The mapper refuses that, too, and says why.
    double point[3] = { 0.0, 0.0, 0.0 };
    volume.Mapper->GetRestPosition(point, point);
  }
}

//------------------------------------------------------------------------------
/// The mapper takes distances in units of the data, before the matrix of the actor.
void vtkFFDVolumeRepresentation::UpdateSampleDistances(
  vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image, vtkPVRenderView* view, bool useLOD)
{
  const double lodResolution = view ? view->GetLODResolution() : 1.0;
  const double coarser =
    std::min(1.0 / std::max(lodResolution, 1.0 / LargestCoarsening), LargestCoarsening);
  mapper->SetMaximumImageSampleDistance(
    this->ImageSampleDistance * std::min(coarser * coarser, LargestCoarsening));
  double spacing[3];
  image->GetSpacing(spacing);
  vtkMatrix3x3* direction = image->GetDirectionMatrix();
  double voxel = VTK_DOUBLE_MAX;
  for (int a = 0; a < 3; ++a)
  {
    const double edge[3] = { direction->GetElement(0, a) * spacing[a],
      direction->GetElement(1, a) * spacing[a], direction->GetElement(2, a) * spacing[a] };
    voxel = std::min(voxel, vtkMath::Norm(edge));
  }
  if (voxel > 0.0)
  {
    const double distance = this->SampleDistance * voxel;
    mapper->SetSampleDistance(distance);
    // What moving frames take is left as it is before a still one: that may be shown again then.
    vtkRenderWindow* window = view ? view->GetRenderWindow() : nullptr;
    if (useLOD || !window || window->GetDesiredUpdateRate() > mapper->GetInteractiveUpdateRate())
    {
      mapper->SetInteractiveSampleDistance(useLOD ? coarser * distance : distance);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::UpdateCropping(
  vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image)
{
  if (!mapper->GetCropping())
  {
    return;
  }
  // Those of the whole, of which this may be a part.
  const bool deformed = mapper->GetCroppingSpace() == vtkFFDInverseRayVolumeMapper::DEFORMED;
  double bounds[6];
  mapper->GetWholeBounds(bounds);
  if (vtkDataArray* all = image->GetFieldData()->GetArray(vtkInternals::AllBoundsName))
  {
    for (int i = 0; i < 6; ++i)
    {
      bounds[i] = all->GetComponent(deformed ? 6 + i : i, 0);
    }
  }
  else if (deformed)
  {
    mapper->GetBounds(bounds);
  }
  else if (!vtkMath::AreBoundsInitialized(bounds))
  {
    image->GetBounds(bounds);
  }
  double planes[6];
  for (int i = 0; i < 6; ++i)
  {
    planes[i] = this->CroppingOrigin[i / 2] + this->CroppingScale[i / 2] * bounds[i];
  }
  if (!deformed)
  {
    TakeIntoFrame(image, planes);
  }
  for (int a = 0; a < 3; ++a)
  {
    if (planes[2 * a] > planes[2 * a + 1])
    {
      std::swap(planes[2 * a], planes[2 * a + 1]);
    }
  }
  mapper->SetCroppingRegionPlanes(planes);
}
