// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameScene.h"

#include "vtkFFDFrameCache.h"
#include "vtkFFDImageRegion.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDViewFromRenderer.h"

#include "vtkMatrix4x4.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace
{

/// The square of a difference to it is still a number. (By default it is -1e299.)
constexpr double LargestClippedIntensity = 1e100;

/// Whether the cropping is that to a box of deformed space: then the rays are cut to it.
bool IsCroppedToBox(const vtkFFDFrameCache& cache)
{
  const ffd::Cropping& crop = cache.GetCropping();
  return crop.Space == ffd::Cropping::Spaces::Deformed && crop.Flags == VTK_CROP_SUBVOLUME;
}

/// The deformed bounds, as far as they are not cropped, without volume if nothing is left of them.
ffd::Box FindUncroppedBounds(const vtkFFDFrameCache& cache)
{
  ffd::Box box = cache.GetPullBack().DeformedBounds;
  if (IsCroppedToBox(cache))
  {
    const ffd::Cropping& crop = cache.GetCropping();
    box.Min = glm::max(box.Min, crop.Low);
    box.Max = glm::max(box.Min, glm::min(box.Max, crop.High));
  }
  return box;
}

} // namespace

//------------------------------------------------------------------------------
ffd::Box vtkFFDFrameScene::FindVisibleBounds(
  vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache)
{
  double clip[6];
  mapper->GetClipBox(clip);
  const ffd::Box uncropped = FindUncroppedBounds(cache);
  const glm::dvec3 lower = glm::max(uncropped.Min, glm::dvec3(clip[0], clip[2], clip[4]));
  const glm::dvec3 upper = glm::min(uncropped.Max, glm::dvec3(clip[1], clip[3], clip[5]));
  return { lower, glm::max(lower, upper) };
}

//------------------------------------------------------------------------------
vtkFFDFrameScene::vtkFFDFrameScene(vtkFFDInverseRayVolumeMapper* mapper,
  const vtkFFDFrameCache& cache, vtkRenderer* renderer, vtkVolume* volume,
  const vtkFFDImageRegion& region, const float* depths)
{
  const ffd::BoundedPullBack& map = cache.GetPullBack();
  ffd::CastScene& scene = this->Scene;
  scene.Volume = cache.GetVolume();
  vtkVolumeProperty* property = volume->GetProperty();
  scene.VolumeInterpolation = property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION
    ? ffd::Interpolation::Nearest
    : ffd::Interpolation::Linear;
  scene.Table = &cache.GetFunctions().Components[0].Table;
  scene.KeptOfFunctions = cache.GetKeptOfFunctions();
  scene.Distances = cache.GetDistances();
  scene.KeptOfSpace = scene.Distances ? cache.GetKeptOfSpace() : nullptr;
  scene.Ranges = &cache.GetRanges();
  scene.CommonRanges = &cache.GetCommonRanges();
  scene.Peaks = cache.GetPeaks();
  scene.Map = &map.Map;
  scene.Limits = map.Limits;
  scene.KeptOfField = map.KeptOfField.get();
  scene.DeformedBounds = FindVisibleBounds(mapper, cache);
  if (mapper->HasClipBox)
  {
    this->WholeBounds = FindUncroppedBounds(cache);
    scene.WholeAtRest = &map.RestBounds;
    scene.WholeDeformed = &this->WholeBounds;
  }
  scene.Blend = cache.GetBlending();
  scene.Crop = IsCroppedToBox(cache) ? ffd::Cropping() : cache.GetCropping();
  // Kernels know data coordinates alone. VTK's mappers measure lengths there, too: a volume looks
  // as dense whatever its matrix scales it by.
  const glm::dmat4 dataToWorld = ffd::ToMatrix(volume->GetMatrix());
  const glm::dmat4 worldToData = glm::inverse(dataToWorld);
  for (const glm::dvec4& plane : cache.GetClippingPlanes())
  {
    const glm::dvec4 inData = plane * dataToWorld;
    scene.ClippingPlanes.push_back(inData / glm::length(glm::dvec3(inData)));
  }
  scene.Blend.SliceOrigin = glm::dvec3(worldToData * glm::dvec4(scene.Blend.SliceOrigin, 1.0));
  scene.Blend.SliceNormal = glm::normalize(scene.Blend.SliceNormal * glm::dmat3(dataToWorld));
  scene.Material = ffd::MakeShading(renderer, property, dataToWorld);
  scene.Camera = ffd::MakeCameraView(renderer, region, dataToWorld);
  scene.Depths = depths;
  scene.VoxelSize = cache.GetVoxelSize();
  this->MakeClassifier(mapper, cache, property);
}

//------------------------------------------------------------------------------
vtkFFDFrameScene::~vtkFFDFrameScene() = default;

//------------------------------------------------------------------------------
void vtkFFDFrameScene::MakeClassifier(
  vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache, vtkVolumeProperty* property)
{
  ffd::CastScene& scene = this->Scene;
  this->Lighting = scene.Material;
  ffd::ClassifierInputs inputs;
  inputs.Volume = scene.Volume;
  inputs.VolumeInterpolation = scene.VolumeInterpolation;
  inputs.Functions = &cache.GetFunctions();
  inputs.Material = &this->Lighting;
  inputs.Mask = cache.GetMask();
  inputs.Hidden = cache.GetHidden();
  inputs.SecondAxis = cache.GetSecondAxis();
  inputs.NormalFromOpacity = mapper->GetComputeNormalFromOpacity();
  const double clippedIntensity = property->GetClippedVoxelIntensity();
  if (property->GetUseClippedVoxelIntensity() && std::isfinite(clippedIntensity))
  {
    inputs.ClippingPlanes = scene.ClippingPlanes;
    inputs.ClippedIntensity =
      std::clamp(clippedIntensity, -LargestClippedIntensity, LargestClippedIntensity);
  }
  // The length is that of still pictures, so that pictures while the scene moves look alike.
  inputs.ReferenceLength = mapper->FindSampleDistance(scene.VoxelSize, false);
  this->Classifier.reset(new ffd::SampleClassifier(inputs));
  scene.Classifier = this->Classifier.get();
}
