// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The options of the representation, most of which are those of its mapper.
#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDShownGeometry.h"

#include "vtkPVDataRepresentation.h"
#include "vtkVolumeProperty.h"

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
void vtkFFDVolumeRepresentation::SetBlendMode(int mode)
{
  if (mode != this->Mapper->GetBlendMode())
  {
    this->Mapper->SetBlendMode(mode);
    // Another partition among processes.
    this->MarkMoved();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetCropping(int cropping)
{
  this->Mapper->SetCropping(cropping != 0);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetCroppingSpace(int space)
{
  this->Mapper->SetCroppingSpace(space);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOpacityLength(int length)
{
  this->Mapper->SetOpacityLength(length);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetUseJittering(vtkTypeBool jittering)
{
  this->Mapper->SetUseJittering(jittering);
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
void vtkFFDVolumeRepresentation::FollowOlder(vtkObject* older)
{
  vtkFFDShownGeometry::Follow(older);
  if (auto* representation = vtkPVDataRepresentation::SafeDownCast(older))
  {
    representation->MarkModified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetNumberOfThreads(int threads)
{
  this->Threads = threads;
  this->Mapper->SetNumberOfThreads(threads > 0 ? threads : this->SharedThreads);
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
/// Not the superclass's: the property has it only where functions are one-dimensional.
void vtkFFDVolumeRepresentation::SetScalarOpacityUnitDistance(double length)
{
  this->UnitDistance = length;
  if (this->Property && !this->UsesPlane())
  {
    this->Property->SetScalarOpacityUnitDistance(length);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetImageSampleDistance(double pixels)
{
  if (!(pixels >= 0.25 && pixels <= 8.0))
  {
    vtkErrorMacro(<< "ImageSampleDistance must be from 0.25 to 8 pixels, not " << pixels << ".");
    return;
  }
  this->ImageSampleDistance = pixels;
  this->Mapper->SetImageSampleDistance(pixels);
  this->Mapper->SetMinimumImageSampleDistance(pixels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetAdaptInteractiveQuality(bool adapt)
{
  this->Mapper->SetAutoAdjustSampleDistances(adapt);
}

//------------------------------------------------------------------------------
bool vtkFFDVolumeRepresentation::GetAdaptInteractiveQuality()
{
  return this->Mapper->GetAutoAdjustSampleDistances() != 0;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::RenderNextAtRate(double rate) { this->NextRate = rate; }

//------------------------------------------------------------------------------
/// Bounds that the view is given are those in the scene, as are the boxes of a partition.
void vtkFFDVolumeRepresentation::MarkMoved() { this->MarkModified(); }

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPosition(double x, double y, double z)
{
  this->Superclass::SetPosition(x, y, z);
  this->MarkMoved();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetScale(double x, double y, double z)
{
  this->Superclass::SetScale(x, y, z);
  this->MarkMoved();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOrientation(double x, double y, double z)
{
  this->Superclass::SetOrientation(x, y, z);
  this->MarkMoved();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOrigin(double x, double y, double z)
{
  this->Superclass::SetOrigin(x, y, z);
  this->MarkMoved();
}
