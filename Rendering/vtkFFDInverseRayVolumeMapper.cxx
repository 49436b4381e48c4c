// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDInverseRayVolumeMapper.h"

#include "vtkFFDFrameOutput.h"
#include "vtkFFDGuard.h"
#include "vtkFFDInverseRayVolumeMapperInternals.h"
#include "vtkFFDOptions.h"
#include "vtkFFDPipeline.h"
#include "vtkFFDProbeView.h"

#include "Reference/FFDSurfaceSearch.h"

#include "vtkAbstractTransform.h"
#include "vtkAlgorithmOutput.h"
#include "vtkGarbageCollector.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPointData.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDInverseRayVolumeMapper);

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

} // namespace

//------------------------------------------------------------------------------
vtkFFDInverseRayVolumeMapper::vtkFFDInverseRayVolumeMapper()
  : ClipBox{ -Infinity, Infinity, -Infinity, Infinity, -Infinity, Infinity }
  , Internals(new vtkInternals(this))
{
}

//------------------------------------------------------------------------------
vtkFFDInverseRayVolumeMapper::~vtkFFDInverseRayVolumeMapper()
{
  this->SetDeformation(nullptr);
  this->SetMaskInput(nullptr);
  this->SetTransfer2DYAxisArray(nullptr);
}

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDInverseRayVolumeMapper, Deformation, vtkAbstractTransform);

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDInverseRayVolumeMapper::GetDeformation() { return this->Deformation; }

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDInverseRayVolumeMapper, MaskInput, vtkImageData);

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetVectorModeAsString() const
{
  static const char* const names[] = { "DISABLED", "MAGNITUDE", "COMPONENT" };
  return names[this->VectorMode - DISABLED];
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMaskBlendFactor(float factor)
{
  if (!(factor >= 0.0f && factor <= 1.0f))
  {
    vtkErrorMacro(<< "MaskBlendFactor must be from 0 to 1, not " << factor << "; it stays "
                  << this->MaskBlendFactor << ".");
    return;
  }
  if (this->MaskBlendFactor != factor)
  {
    this->MaskBlendFactor = factor;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetClamped(float& option, float value, float low, float high)
{
  // vtkSetClampMacro lets through what is not a number.
  const float clamped = value >= low ? std::min(value, high) : low;
  if (option != clamped)
  {
    option = clamped;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMaxMemoryFraction(float fraction)
{
  this->SetClamped(this->MaxMemoryFraction, fraction, 0.1f, 1.0f);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetGlobalIlluminationReach(float reach)
{
  this->SetClamped(this->GlobalIlluminationReach, reach, 0.0f, 1.0f);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetVolumetricScatteringBlending(float blending)
{
  this->SetClamped(this->VolumetricScatteringBlending, blending, 0.0f, 2.0f);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetInverseTolerance(double voxels)
{
  vtkFFDSetPositive(this, "InverseTolerance", this->InverseTolerance, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetPositionTolerance(double voxels)
{
  vtkFFDSetPositive(this, "PositionTolerance", this->PositionTolerance, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetAngleThreshold(double degrees)
{
  if (degrees >= 180.0)
  {
    vtkErrorMacro(<< "AngleThreshold must be below 180 degrees, not " << degrees << "; it stays "
                  << this->AngleThreshold << ".");
    return;
  }
  vtkFFDSetPositive(this, "AngleThreshold", this->AngleThreshold, degrees);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMinimumSegmentLength(double voxels)
{
  vtkFFDSetPositive(this, "MinimumSegmentLength", this->MinimumSegmentLength, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMaximumSegmentLength(double voxels)
{
  if (!(voxels >= 0.0 && std::isfinite(voxels)))
  {
    vtkErrorMacro(<< "MaximumSegmentLength must be a positive number, or 0, not " << voxels
                  << "; it stays " << this->MaximumSegmentLength << ".");
    return;
  }
  if (this->MaximumSegmentLength != voxels)
  {
    this->MaximumSegmentLength = voxels;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetEarlyRayTerminationThreshold(double transmittance)
{
  if (!(transmittance >= 0.0 && transmittance <= 1.0))
  {
    vtkErrorMacro(<< "EarlyRayTerminationThreshold must be from 0 to 1, not " << transmittance
                  << "; it stays " << this->EarlyRayTerminationThreshold << ".");
    return;
  }
  if (this->EarlyRayTerminationThreshold != transmittance)
  {
    this->EarlyRayTerminationThreshold = transmittance;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetSampleDistance(double distance)
{
  if (vtkFFDSetPositive(this, "SampleDistance", this->SampleDistance, distance))
  {
    this->SetLockSampleDistanceToInputSpacing(0);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetInteractiveSampleDistance(double distance)
{
  if (vtkFFDSetPositive(
        this, "InteractiveSampleDistance", this->InteractiveSampleDistance, distance) &&
    this->InteractiveSampleDistanceLocked)
  {
    this->InteractiveSampleDistanceLocked = false;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetLockSampleDistanceToInputSpacing(vtkTypeBool lock)
{
  if (this->LockSampleDistanceToInputSpacing != lock ||
    (lock && !this->InteractiveSampleDistanceLocked))
  {
    this->LockSampleDistanceToInputSpacing = lock;
    this->InteractiveSampleDistanceLocked = this->InteractiveSampleDistanceLocked || lock;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
/// Data units; `interactive`: while the scene moves. A distance that nobody has set is one of
/// voxels, whatever the other one is: 1.0 or 2.0 may be more than all of a volume.
double vtkFFDInverseRayVolumeMapper::FindSampleDistance(double voxelSize, bool interactive) const
{
  const double still = this->LockSampleDistanceToInputSpacing ? voxelSize : this->SampleDistance;
  if (!interactive)
  {
    return still;
  }
  return this->InteractiveSampleDistanceLocked ? std::max(2.0 * voxelSize, still)
                                               : this->InteractiveSampleDistance;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetImageSampleDistance(double pixels)
{
  vtkFFDSetPositive(this, "ImageSampleDistance", this->ImageSampleDistance,
    pixels > 0.0 ? std::clamp(pixels, 0.1, 100.0) : pixels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMinimumImageSampleDistance(double pixels)
{
  vtkFFDSetPositive(this, "MinimumImageSampleDistance", this->MinimumImageSampleDistance,
    pixels > 0.0 ? std::clamp(pixels, 0.1, 100.0) : pixels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMaximumImageSampleDistance(double pixels)
{
  vtkFFDSetPositive(this, "MaximumImageSampleDistance", this->MaximumImageSampleDistance,
    pixels > 0.0 ? std::clamp(pixels, 0.1, 100.0) : pixels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetFinalColorWindow(double window)
{
  if (window == 0.0 || !std::isfinite(window))
  {
    vtkErrorMacro(<< "FinalColorWindow must be a number other than 0, not " << window
                  << "; it stays " << this->FinalColorWindow << ".");
    return;
  }
  if (this->FinalColorWindow != window)
  {
    this->FinalColorWindow = window;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetFinalColorLevel(double level)
{
  if (!std::isfinite(level))
  {
    vtkErrorMacro(<< "FinalColorLevel must be a number, not " << level << "; it stays "
                  << this->FinalColorLevel << ".");
    return;
  }
  if (this->FinalColorLevel != level)
  {
    this->FinalColorLevel = level;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetCroppingSpaceAsString() const
{
  return this->CroppingSpace == DEFORMED ? "DEFORMED" : "REST";
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetClipBox(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double box[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetClipBox(box);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetClipBox(const double box[6])
{
  if (!box)
  {
    vtkErrorMacro(<< "ClipBox is null. Give (xmin, xmax, ymin, ymax, zmin, zmax).");
    return;
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(box[2 * a] <= box[2 * a + 1]))
    {
      vtkErrorMacro(<< "ClipBox: the limits " << box[2 * a] << ", " << box[2 * a + 1] << " of axis "
                    << a
                    << " are inverted or not a number. Give (xmin, xmax, ymin, ymax, zmin, zmax); "
                       "the clip box stays as it was.");
      return;
    }
  }
  if (!this->HasClipBox || !std::equal(box, box + 6, this->ClipBox))
  {
    std::copy_n(box, 6, this->ClipBox);
    this->HasClipBox = true;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::GetClipBox(double box[6]) const
{
  std::copy_n(this->ClipBox, 6, box);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::RemoveClipBox()
{
  if (this->HasClipBox)
  {
    this->SetClipBox(-Infinity, Infinity, -Infinity, Infinity, -Infinity, Infinity);
    this->HasClipBox = false;
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetWholeBounds(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double bounds[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetWholeBounds(bounds);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetWholeBounds(const double bounds[6])
{
  if (!bounds || !std::all_of(bounds, bounds + 6, [](double b) { return std::isfinite(b); }))
  {
    vtkErrorMacro(<< "WholeBounds must be finite: (xmin, xmax, ymin, ymax, zmin, zmax), or "
                     "uninitialized (1, -1, 1, -1, 1, -1). They stay as they were.");
    return;
  }
  if (!std::equal(bounds, bounds + 6, this->WholeBounds))
  {
    std::copy_n(bounds, 6, this->WholeBounds);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetWholeScalarRange(double min, double max)
{
  const double range[2] = { min, max };
  this->SetWholeScalarRange(range);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetWholeScalarRange(const double range[2])
{
  if (!range)
  {
    vtkErrorMacro(<< "WholeScalarRange is null. Give two numbers.");
    return;
  }
  if (!std::isfinite(range[0]) || !std::isfinite(range[1]))
  {
    vtkErrorMacro(<< "WholeScalarRange must be finite, not " << range[0] << ", " << range[1]
                  << "; without one give 1, -1. It stays " << this->WholeScalarRange[0] << ", "
                  << this->WholeScalarRange[1] << ".");
    return;
  }
  if (!std::equal(range, range + 2, this->WholeScalarRange))
  {
    std::copy_n(range, 2, this->WholeScalarRange);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetInverseModeAsString() const
{
  static const char* const names[] = { "FIRST_ORDER", "EXACT", "PULL_BACK" };
  return names[this->InverseMode];
}

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetSegmentationAsString() const
{
  return this->Segmentation == GREEDY_ANGLE ? "GREEDY_ANGLE" : "ERROR_BOUND";
}

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetClassificationAsString() const
{
  static const char* const names[] = { "POST_INTERPOLATED", "PRE_INTEGRATED", "AUTO" };
  return names[this->Classification];
}

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetSpaceLeapingAsString() const
{
  static const char* const names[] = { "OFF", "SEGMENT", "LIPSCHITZ" };
  return names[this->SpaceLeaping];
}

//------------------------------------------------------------------------------
const char* vtkFFDInverseRayVolumeMapper::GetOpacityLengthAsString() const
{
  return this->OpacityLength == MATERIAL ? "MATERIAL" : "WORLD";
}

//------------------------------------------------------------------------------
vtkFFDRayStatistics* vtkFFDInverseRayVolumeMapper::GetStatistics()
{
  return this->Internals->Statistics;
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDInverseRayVolumeMapper::GetNumberOfBuilds(int part)
{
  return part >= 0 && part < NUMBER_OF_CACHED_PARTS ? this->Internals->Cache.GetNumberOfBuilds(part)
                                                    : -1;
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDInverseRayVolumeMapper::GetAuxiliaryMemorySize()
{
  const vtkInternals& in = *this->Internals;
  const std::size_t size = in.Cache.GetMemorySize() + in.Caster.GetCoherenceSize();
  return static_cast<vtkTypeInt64>(size);
}

//------------------------------------------------------------------------------
double vtkFFDInverseRayVolumeMapper::GetExpectedStillTime()
{
  return this->Internals->Plan.GetStillTime();
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::GetUsedClassification()
{
  return this->Internals->Caster.ClassifiesIntervals() ? PRE_INTEGRATED : POST_INTERPOLATED;
}

//------------------------------------------------------------------------------
double vtkFFDInverseRayVolumeMapper::GetReusedFraction()
{
  return this->Internals->Caster.GetReusedFraction();
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetFrameCoherenceTolerance(double pixels)
{
  if (!(pixels >= 0.0) || !std::isfinite(pixels))
  {
    vtkErrorMacro(<< "FrameCoherenceTolerance must be a number that is not negative, not " << pixels
                  << "; it stays " << this->FrameCoherenceTolerance << ".");
    return;
  }
  if (this->FrameCoherenceTolerance != pixels)
  {
    this->FrameCoherenceTolerance = pixels;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDInverseRayVolumeMapper::GetMTime()
{
  const vtkMTimeType time = this->GetSettingsTime();
  return this->Deformation ? std::max(time, this->Deformation->GetMTime()) : time;
}

//------------------------------------------------------------------------------
/// The modification time of all but the deformation.
vtkMTimeType vtkFFDInverseRayVolumeMapper::GetSettingsTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  if (this->MaskInput)
  {
    time = std::max(time, this->MaskInput->GetMTime());
  }
  // The time of the collection is not that of the planes.
  for (int i = 0; this->ClippingPlanes && i < this->ClippingPlanes->GetNumberOfItems(); ++i)
  {
    time = std::max(time, this->ClippingPlanes->GetItem(i)->GetMTime());
  }
  return time;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::Update()
{
  vtkAlgorithmOutput* connection =
    this->GetNumberOfInputConnections(0) > 0 ? this->GetInputConnection(0, 0) : nullptr;
  if (connection)
  {
    // Others may have asked for a part of the extent since; that would be asked for again.
    // vtkAlgorithm::UpdateWholeExtent() would ask for the whole of the first output only.
    vtkFFDUpdateWhole(connection, nullptr);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::Update(int) { this->Update(); }

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetRenderToImage(vtkTypeBool on)
{
  if (this->RendersToImage != on)
  {
    this->RendersToImage = on;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::GetColorImage(vtkImageData* image)
{
  vtkImageData* colors = this->Internals->ColorImage;
  if (!image || !colors->GetPointData()->GetScalars())
  {
    vtkErrorMacro(<< "GetColorImage: "
                  << (image ? "no frame became an image yet. Call "
                              "RenderToImageOn() and render a window first."
                            : "the image is null."));
    return;
  }
  image->DeepCopy(colors);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::GetDepthImage(vtkImageData* image)
{
  const std::vector<float>& depths = this->Internals->ImageDepths;
  if (!image || depths.empty())
  {
    vtkErrorMacro(<< "GetDepthImage: "
                  << (image ? "no frame became an image yet. Call "
                              "RenderToImageOn() and render a window first."
                            : "the image is null."));
    return;
  }
  image->Initialize();
  image->SetExtent(this->Internals->ColorImage->GetExtent());
  vtkFFDWriteDepths(depths, this->DepthImageScalarType, image);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetInteractiveUpdateRate(double framesPerSecond)
{
  vtkFFDSetPositive(this, "InteractiveUpdateRate", this->InteractiveUpdateRate,
    framesPerSecond > 0.0 ? std::clamp(framesPerSecond, 1e-10, 1e10) : framesPerSecond);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::CreateCanonicalView(
  vtkVolume* volume, vtkImageData* image, int blendMode, double viewDirection[3], double viewUp[3])
{
  this->CreateCanonicalView(nullptr, volume, image, blendMode, viewDirection, viewUp);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::CreateCanonicalView(vtkRenderer* renderer, vtkVolume* volume,
  vtkVolume*, vtkImageData* image, int blendMode, double viewDirection[3], double viewUp[3])
{
  this->CreateCanonicalView(renderer, volume, image, blendMode, viewDirection, viewUp);
}

//------------------------------------------------------------------------------
float vtkFFDInverseRayVolumeMapper::GetEstimatedRenderTime(vtkRenderer*, vtkVolume*)
{
  return static_cast<float>(this->Internals->Plan.EstimateTime());
}

//------------------------------------------------------------------------------
float vtkFFDInverseRayVolumeMapper::ComputeRequiredImageSampleDistance(
  float desiredTime, vtkRenderer*, vtkVolume*)
{
  const double wanted = desiredTime > 0.0f ? this->Internals->Plan.FindDistance(desiredTime)
                                           : this->MaximumImageSampleDistance;
  return static_cast<float>(std::clamp(wanted, this->MinimumImageSampleDistance,
    std::max(this->MinimumImageSampleDistance, this->MaximumImageSampleDistance)));
}

//------------------------------------------------------------------------------
vtkContourValues* vtkFFDInverseRayVolumeMapper::GetDepthPassContourValues()
{
  return this->Internals->DepthPassContourValues;
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::GetRestPosition(const double deformed[3], double rest[3])
{
  if (!deformed || !rest)
  {
    vtkErrorMacro(<< "GetRestPosition: a point is null. Give two of three numbers.");
    return 0;
  }
  const glm::dvec3 p(deformed[0], deformed[1], deformed[2]);
  if (!std::isfinite(glm::dot(p, p)))
  {
    vtkErrorMacro(<< "GetRestPosition: the point (" << p.x << ", " << p.y << ", " << p.z
                  << ") is not finite.");
    return 0;
  }
  vtkFFDProbeView view;
  if (!this->MakeProbeView(view))
  {
    return 0;
  }
  const std::optional<ffd::Box>& domain = view.Map.GetDomain();
  if (this->Deformation && domain && !domain->Contains(p))
  {
    // Beyond it the approximation of the transform may be far off.
    this->Deformation->TransformPoint(deformed, rest);
    return 1;
  }
  const glm::dvec3 q =
    ffd::SurfaceSearch(view.Volume, view.Map, p, glm::dvec3(0.0), view.OneToOne).Evaluate(0.0).Rest;
  std::copy_n(&q.x, 3, rest);
  return 1;
}

//------------------------------------------------------------------------------
double* vtkFFDInverseRayVolumeMapper::GetBounds()
{
  if (this->Internals->Frame)
  {
    // The bounds of the volume that the frame shows, whatever its observers have changed.
    std::copy_n(this->Internals->Cache.GetReportedBounds(), 6, this->Bounds);
    return this->Bounds;
  }
  vtkMath::UninitializeBounds(this->Bounds);
  if (!this->GetDataSetInput())
  {
    return this->Bounds;
  }
  this->Update();
  vtkFFDGuard(this, "GetBounds", [this] {
    vtkInternals& in = *this->Internals;
    ffd::StageTools tools;
    tools.Parallel = in.MakeParallelFor();
    if (in.Cache.UpdateBounds(this, tools))
    {
      std::copy_n(in.Cache.GetReportedBounds(), 6, this->Bounds);
    }
  });
  return this->Bounds;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  vtkInternals& in = *this->Internals;
  in.Display.ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
  if (in.Frame)
  {
    in.Frame->AtEnd([&in] { in.ReleaseImages(); });
  }
  else
  {
    in.ReleaseImages();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::ShallowCopy(vtkAbstractMapper* mapper)
{
  if (!mapper)
  {
    vtkErrorMacro(<< "ShallowCopy: there is no mapper to copy from.");
    return;
  }
  auto* from = vtkVolumeMapper::SafeDownCast(mapper);
  if (from && from != this)
  {
    this->SetInputConnection(from->GetInputConnection(0, 0));
    this->SetScalarMode(from->GetScalarMode());
    if (from->GetArrayAccessMode() == VTK_GET_ARRAY_BY_ID)
    {
      this->SelectScalarArray(from->GetArrayId());
    }
    else
    {
      this->SelectScalarArray(from->GetArrayName());
    }
    this->SetBlendMode(from->GetBlendMode());
    this->SetAverageIPScalarRange(from->GetAverageIPScalarRange());
    this->SetCropping(from->GetCropping());
    this->SetCroppingRegionPlanes(from->GetCroppingRegionPlanes());
    this->SetCroppingRegionFlags(from->GetCroppingRegionFlags());
  }
  auto* like = vtkFFDInverseRayVolumeMapper::SafeDownCast(mapper);
  if (like && like != this)
  {
    this->SetDeformation(like->Deformation);
    this->SetInverseMode(like->InverseMode);
    this->SetInverseTolerance(like->InverseTolerance);
    this->SetSegmentation(like->Segmentation);
    this->SetPositionTolerance(like->PositionTolerance);
    this->SetAngleThreshold(like->AngleThreshold);
    this->SetMinimumSegmentLength(like->MinimumSegmentLength);
    this->SetMaximumSegmentLength(like->MaximumSegmentLength);
    this->SetSpaceLeaping(like->SpaceLeaping);
    this->SetEarlyRayTerminationThreshold(like->EarlyRayTerminationThreshold);
    this->SetOpacityLength(like->OpacityLength);
    this->SetClassification(like->Classification);
    this->SetSampleDistance(like->SampleDistance);
    this->SetInteractiveSampleDistance(like->InteractiveSampleDistance);
    this->SetLockSampleDistanceToInputSpacing(like->LockSampleDistanceToInputSpacing);
    this->InteractiveSampleDistanceLocked = like->InteractiveSampleDistanceLocked;
    this->SetImageSampleDistance(like->ImageSampleDistance);
    this->SetMinimumImageSampleDistance(like->MinimumImageSampleDistance);
    this->SetMaximumImageSampleDistance(like->MaximumImageSampleDistance);
    this->SetAutoAdjustSampleDistances(like->AutoAdjustSampleDistances);
    this->SetFrameCoherence(like->FrameCoherence);
    this->SetStillFrameCoherence(like->StillFrameCoherence);
    this->SetFrameCoherenceTolerance(like->FrameCoherenceTolerance);
    this->SetIntermixIntersectingGeometry(like->IntermixIntersectingGeometry);
    this->SetCroppingSpace(like->CroppingSpace);
    this->SetUseJittering(like->UseJittering);
    this->SetFinalColorWindow(like->FinalColorWindow);
    this->SetFinalColorLevel(like->FinalColorLevel);
    this->SetPremultipliedAlpha(like->PremultipliedAlpha);
    this->SetRenderToImage(like->RendersToImage);
    this->SetDepthImageScalarType(like->DepthImageScalarType);
    this->SetClampDepthToBackface(like->ClampDepthToBackface);
    this->SetColorRangeType(like->ColorRangeType);
    this->SetScalarOpacityRangeType(like->ScalarOpacityRangeType);
    this->SetGradientOpacityRangeType(like->GradientOpacityRangeType);
    this->SetInteractiveUpdateRate(like->InteractiveUpdateRate);
    this->SetReportProgress(like->ReportProgress);
    this->SetRequestedRenderMode(like->RequestedRenderMode);
    this->SetInteractiveAdjustSampleDistances(like->InteractiveAdjustSampleDistances);
    this->SetInterpolationMode(like->InterpolationMode);
    this->SetMaxMemoryInBytes(like->MaxMemoryInBytes);
    this->SetMaxMemoryFraction(like->MaxMemoryFraction);
    this->SetLowResMode(like->LowResMode);
    this->SetUseDepthPass(like->UseDepthPass);
    this->SetGlobalIlluminationReach(like->GlobalIlluminationReach);
    this->SetVolumetricScatteringBlending(like->VolumetricScatteringBlending);
    this->SetMaskInput(like->MaskInput);
    this->SetMaskType(like->MaskType);
    this->SetMaskBlendFactor(like->MaskBlendFactor);
    this->SetTransfer2DYAxisArray(like->Transfer2DYAxisArray);
    this->SetVectorMode(like->VectorMode);
    this->SetVectorComponent(like->VectorComponent);
    this->SetComputeNormalFromOpacity(like->ComputeNormalFromOpacity);
    like->HasClipBox ? this->SetClipBox(like->ClipBox) : this->RemoveClipBox();
    this->SetWholeBounds(like->WholeBounds);
    this->SetWholeScalarRange(like->WholeScalarRange);
    this->SetNumberOfThreads(like->NumberOfThreads);
    this->SetReferenceKernels(like->ReferenceKernels);
    this->SetCollectStatistics(like->CollectStatistics);
  }
  this->Superclass::ShallowCopy(mapper);
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::FillInputPortInformation(int port, vtkInformation* info)
{
  // Wider than what can be rendered: Render says what is wrong, the pipeline would only fail.
  if (!this->Superclass::FillInputPortInformation(port, info))
  {
    return 0;
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::ReportReferences(vtkGarbageCollector* collector)
{
  this->Superclass::ReportReferences(collector);
  // Not Deformation: a transform and its inverse hold each other, and part only when the last one
  // who holds either of them unregisters it, which the garbage collector does not do.
  vtkGarbageCollectorReport(collector, this->MaskInput, "MaskInput");
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Deformation: " << this->Deformation << "\n";
  os << indent << "InverseMode: " << this->GetInverseModeAsString() << "\n";
  os << indent << "InverseTolerance: " << this->InverseTolerance << "\n";
  os << indent << "Segmentation: " << this->GetSegmentationAsString() << "\n";
  os << indent << "PositionTolerance: " << this->PositionTolerance << "\n";
  os << indent << "AngleThreshold: " << this->AngleThreshold << "\n";
  os << indent << "MinimumSegmentLength: " << this->MinimumSegmentLength << "\n";
  os << indent << "MaximumSegmentLength: " << this->MaximumSegmentLength << "\n";
  os << indent << "SpaceLeaping: " << this->GetSpaceLeapingAsString() << "\n";
  os << indent << "EarlyRayTerminationThreshold: " << this->EarlyRayTerminationThreshold << "\n";
  os << indent << "OpacityLength: " << this->GetOpacityLengthAsString() << "\n";
  os << indent << "Classification: " << this->GetClassificationAsString() << "\n";
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "InteractiveSampleDistance: " << this->InteractiveSampleDistance << "\n";
  os << indent << "InteractiveSampleDistanceLocked: " << this->InteractiveSampleDistanceLocked
     << "\n";
  os << indent << "LockSampleDistanceToInputSpacing: " << this->LockSampleDistanceToInputSpacing
     << "\n";
  os << indent << "ImageSampleDistance: " << this->ImageSampleDistance << "\n";
  os << indent << "MinimumImageSampleDistance: " << this->MinimumImageSampleDistance << "\n";
  os << indent << "MaximumImageSampleDistance: " << this->MaximumImageSampleDistance << "\n";
  os << indent << "AutoAdjustSampleDistances: " << this->AutoAdjustSampleDistances << "\n";
  os << indent << "FrameCoherence: " << this->FrameCoherence << "\n";
  os << indent << "StillFrameCoherence: " << this->StillFrameCoherence << "\n";
  os << indent << "ReusedFraction: " << this->GetReusedFraction() << "\n";
  os << indent << "FrameCoherenceTolerance: " << this->FrameCoherenceTolerance << "\n";
  os << indent << "IntermixIntersectingGeometry: " << this->IntermixIntersectingGeometry << "\n";
  os << indent << "WholeBounds: " << this->WholeBounds[0] << ", " << this->WholeBounds[1] << ", "
     << this->WholeBounds[2] << ", " << this->WholeBounds[3] << ", " << this->WholeBounds[4] << ", "
     << this->WholeBounds[5] << "\n";
  os << indent << "WholeScalarRange: " << this->WholeScalarRange[0] << ", "
     << this->WholeScalarRange[1] << "\n";
  os << indent << "ClipBox: " << this->ClipBox[0] << ", " << this->ClipBox[1] << ", "
     << this->ClipBox[2] << ", " << this->ClipBox[3] << ", " << this->ClipBox[4] << ", "
     << this->ClipBox[5] << "\n";
  os << indent << "CroppingSpace: " << this->GetCroppingSpaceAsString() << "\n";
  os << indent << "UseJittering: " << this->UseJittering << "\n";
  os << indent << "FinalColorWindow: " << this->FinalColorWindow << "\n";
  os << indent << "FinalColorLevel: " << this->FinalColorLevel << "\n";
  os << indent << "PremultipliedAlpha: " << this->PremultipliedAlpha << "\n";
  os << indent << "RenderToImage: " << this->RendersToImage << "\n";
  os << indent << "DepthImageScalarType: " << this->DepthImageScalarType << "\n";
  os << indent << "ClampDepthToBackface: " << this->ClampDepthToBackface << "\n";
  os << indent << "ColorRangeType: " << this->ColorRangeType << "\n";
  os << indent << "ScalarOpacityRangeType: " << this->ScalarOpacityRangeType << "\n";
  os << indent << "GradientOpacityRangeType: " << this->GradientOpacityRangeType << "\n";
  os << indent << "InteractiveUpdateRate: " << this->InteractiveUpdateRate << "\n";
  os << indent << "ReportProgress: " << this->ReportProgress << "\n";
  os << indent << "RequestedRenderMode: " << this->RequestedRenderMode << "\n";
  os << indent << "InteractiveAdjustSampleDistances: " << this->InteractiveAdjustSampleDistances
     << "\n";
  os << indent << "InterpolationMode: " << this->InterpolationMode << "\n";
  os << indent << "MaxMemoryInBytes: " << this->MaxMemoryInBytes << "\n";
  os << indent << "MaxMemoryFraction: " << this->MaxMemoryFraction << "\n";
  os << indent << "LowResMode: " << this->LowResMode << "\n";
  os << indent << "UseDepthPass: " << this->UseDepthPass << "\n";
  os << indent << "GlobalIlluminationReach: " << this->GlobalIlluminationReach << "\n";
  os << indent << "VolumetricScatteringBlending: " << this->VolumetricScatteringBlending << "\n";
  os << indent << "MaskInput: " << this->MaskInput << "\n";
  os << indent << "MaskType: " << (this->MaskType == BinaryMaskType ? "Binary" : "LabelMap")
     << "\n";
  os << indent << "MaskBlendFactor: " << this->MaskBlendFactor << "\n";
  os << indent << "Transfer2DYAxisArray: "
     << (this->Transfer2DYAxisArray ? this->Transfer2DYAxisArray : "(none)") << "\n";
  os << indent << "VectorMode: " << this->GetVectorModeAsString() << "\n";
  os << indent << "VectorComponent: " << this->VectorComponent << "\n";
  os << indent << "ComputeNormalFromOpacity: " << this->GetComputeNormalFromOpacity() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "ReferenceKernels: " << this->ReferenceKernels << "\n";
  os << indent << "NumberOfBuilds:";
  for (int part = 0; part < NUMBER_OF_CACHED_PARTS; ++part)
  {
    os << " " << this->GetNumberOfBuilds(part);
  }
  os << "\n";
  os << indent << "CollectStatistics: " << this->CollectStatistics << "\n";
  os << indent << "Statistics:\n";
  this->Internals->Statistics->PrintSelf(os, indent.GetNextIndent());
}
