// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDInverseRayVolumeMapper.h"

#include "vtkFFDBlendingView.h"
#include "vtkFFDFrame.h"
#include "vtkFFDFrameCache.h"
#include "vtkFFDFrameCoherence.h"
#include "vtkFFDGuard.h"
#include "vtkFFDImageDisplay.h"
#include "vtkFFDImageRegion.h"
#include "vtkFFDKernelViews.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDProbeView.h"
#include "vtkFFDRayStatistics.h"
#include "vtkFFDTracedRays.h"

#include "FFDRayCaster.h"
#include "FFDSampleClassifier.h"
#include "FFDSingularMatrix.h"
#include "FFDSurfaceSearch.h"

#include "vtkAbstractTransform.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCamera.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkContourValues.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkGarbageCollector.h"
#include "vtkHardwareSelector.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseVectorKey.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderPass.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDInverseRayVolumeMapper);

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Longest piece when the curvature bound sets the length, voxels.
constexpr double LongestAutomaticSegment = 64.0;

/// Longest piece that can be asked for, and longest minimum, voxels: beyond, a ray would have none.
constexpr double LongestSegment = 1e4;
constexpr double LongestMinimum = 64.0;

/// Longest piece of ERROR_BOUND, voxels.
constexpr double LongestPiece = 64.0;

/// Reports of the progress of a frame of which no time is known; else the clock says when.
constexpr std::size_t LeastReports = 16;

/// The image sample distance stays as it is if it need not change by more than this part of it, and
/// is rounded up to so many steps a pixel: then tiles lie on whole pixels.
constexpr double StepHysteresis = 0.15;
constexpr double StepsPerPixel = 8.0;

constexpr int LargestImageSide = 16384;

/// The square of a difference to it is still a number. (By default it is -1e299.)
constexpr double LargestClippedIntensity = 1e100;

/// Of an image while it is made: colours and depth as floats, and what they become.
constexpr double BytesPerPixel = 28.0;

/// Shortest piece and sample distance, voxels: below, an image would take for ever.
constexpr double ShortestLength = 1e-3;

/// Narrow [from, to] to what of a ray is in a box; false if nothing is.
bool ClipToBox(const glm::dvec3& origin, const glm::dvec3& direction, const ffd::Box& box,
  double& from, double& to)
{
  for (int a = 0; a < 3; ++a)
  {
    const double t1 = (box.Min[a] - origin[a]) / direction[a];
    const double t2 = (box.Max[a] - origin[a]) / direction[a];
    // Along a face these are not numbers, which cut nothing off.
    from = std::max(from, std::min(t1, t2));
    to = std::min(to, std::max(t1, t2));
  }
  return from < to;
}

/// Which part of an image of `rays` some quarters of tiles are, by their number.
double FindPart(const std::vector<vtkFFDFrameCoherence::Part>& tiles, const glm::ivec2& rays)
{
  std::size_t count = 0;
  for (const vtkFFDFrameCoherence::Part& tile : tiles)
  {
    count += std::bitset<4>(tile.Quarters).count();
  }
  // At the border of the image there may be fewer quarters to a tile.
  const glm::ivec2 all =
    (rays + ffd::RayCaster::QuarterSize - 1) / ffd::RayCaster::QuarterSize;
  return std::min(1.0, static_cast<double>(count) / std::max(1, all.x * all.y));
}

/// `colours`, premultiplied, as a picture of bytes.
void WriteColours(
  const std::vector<float>& colours, int width, int height, bool premultiplied, vtkImageData* image)
{
  image->SetExtent(0, width - 1, 0, height - 1, 0, 0);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  auto* bytes = static_cast<unsigned char*>(image->GetScalarPointer());
  const auto toByte = [](float value) {
    return static_cast<unsigned char>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
  };
  const std::size_t count = 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < count; i += 4)
  {
    const float alpha = colours[i + 3];
    const float scale = premultiplied ? 1.0f : alpha > 0.0f ? 1.0f / alpha : 0.0f;
    for (std::size_t c = 0; c < 3; ++c)
    {
      bytes[i + c] = toByte(colours[i + c] * scale);
    }
    bytes[i + 3] = toByte(alpha);
  }
}

/// Depths, 0 to 1, as numbers of a type: 255 or 65535 times as large as integers.
template <typename T>
void WriteDepths(const std::vector<float>& depths, double scale, T* numbers)
{
  for (std::size_t i = 0; i < depths.size(); ++i)
  {
    const double depth = std::clamp(static_cast<double>(depths[i]), 0.0, 1.0);
    numbers[i] = static_cast<T>(scale == 1.0 ? depth : scale * depth + 0.5);
  }
}

/// What of an image of rays is shown and pickable: more than VTK's GPU mapper takes for empty.
constexpr float LeastPickedAlpha = 3.0f / 255.0f;

/// Whether a pass of a selector reads what the volume draws.
bool IsPassRead(vtkHardwareSelector* selector)
{
  const int field = selector->GetFieldAssociation();
  switch (selector->GetCurrentPass())
  {
    case vtkHardwareSelector::POINT_ID_LOW24:
    case vtkHardwareSelector::POINT_ID_HIGH24:
      return field == vtkDataObject::FIELD_ASSOCIATION_POINTS;
    case vtkHardwareSelector::CELL_ID_LOW24:
    case vtkHardwareSelector::CELL_ID_HIGH24:
      return field == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    default:
      return true;
  }
}

/// Whether a pass of depth peeling asks for the volume between translucent surfaces: it wants the
/// shader of the volume changed, and what is drawn without that is not a picture.
bool IsPeeled(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkInformation* keys = volume->GetPropertyKeys();
  vtkInformationObjectBaseVectorKey* passes = vtkOpenGLRenderPass::RenderPasses();
  if (!renderer->GetUseDepthPeelingForVolumes() || !keys || !keys->Has(passes))
  {
    return false;
  }
  for (int i = 0; i < passes->Length(keys); ++i)
  {
    if (passes->Get(keys, i)->IsA("vtkDepthPeelingPass"))
    {
      return true;
    }
  }
  return false;
}

} // namespace

//------------------------------------------------------------------------------
/// Everything that is kept between frames, each with what it was made from.
class vtkFFDInverseRayVolumeMapper::vtkInternals
{
public:
  explicit vtkInternals(vtkFFDInverseRayVolumeMapper* self)
    : Self(self)
  {
  }

  bool Update(vtkVolumeProperty* property, std::string& message);
  bool Prepare(vtkVolume* volume, std::string& message);
  bool Refuse(const char* what) const;
  static bool CheckView(vtkRenderer* renderer, vtkVolume* volume, std::string& message);

  ffd::CastSettings MakeSettings(vtkVolume* volume, double voxelSize, bool interactive) const;
  ffd::CastScene MakeScene(vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& region,
    const float* depths);
  void MakeClassifier(ffd::CastScene& scene, vtkVolumeProperty* property);
  bool Cast(vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& region,
    const float* depths, bool interactive, bool window, float* outDepths);
  vtkFFDParallelFor MakeParallelFor() const;
  class Footprints;
  void FindRayDepths(const vtkFFDImageRegion& region, const glm::ivec2& pixels);
  vtkFFDImageDisplay::Layers CastLayers(vtkRenderer* renderer, vtkVolume* volume,
    const vtkFFDImageRegion& region, const glm::ivec2& pixels, bool interactive);
  void CastNearer(vtkVolume* volume, ffd::CastScene scene, const vtkFFDImageRegion& region,
    bool interactive);
  void ApplyFinalColours(const vtkFFDImageRegion& region, const vtkFFDFrameCoherence::Part& tile,
    std::vector<float>& colours) const;
  bool CanReuse(vtkVolume* volume) const;
  void ReleaseImages();
  double FindStillTime(const glm::ivec2& pixels, bool interactive) const;
  vtkMTimeType FindSceneTime(vtkVolume* volume) const;
  double FindStep(double allotted, const glm::ivec2& pixels) const;
  bool IsCroppedToBox() const;
  ffd::Box UncroppedBounds() const;
  ffd::Box VisibleBounds() const;
  vtkFFDImageRegion FindRegion(
    vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& whole);
  bool IsMoving(vtkVolume* volume) const;
  vtkIdType FindIdentifier(const glm::dvec3& deformed, bool cells) const;
  void PaintIdentifiers(
    vtkHardwareSelector* selector, const ffd::CameraView& camera, const std::vector<float>& depths);
  void MoveToBackface(const ffd::CameraView& camera, std::vector<float>& depths) const;
  double EstimateTime() const { return this->TimePerRay * this->LastPixels; }

  vtkFFDInverseRayVolumeMapper* Self;

  // Of the frame in progress, null without: nothing of the following changes then but by the frame.
  vtkFFDFrame* Frame = nullptr;
  bool Prepared = false; // the frame is past its preparation
  bool Quiet = false;    // it does not report now

  vtkFFDFrameCache Cache;
  ffd::Box WholeBounds; // deformed, of which a clip box shows a part

  // Of a frame.
  ffd::Shading Lighting;
  std::unique_ptr<ffd::SampleClassifier> Classifier;

  /// Where a picture in the window lies, and what the camera sees there.
  struct View
  {
    bool Complete = false;
    vtkFFDImageRegion Region;
    glm::dmat4 DataToNdc{ 1.0 };

    bool IsSameAs(const View& other) const
    {
      return this->Complete && this->Region.Viewport == other.Region.Viewport &&
        this->DataToNdc == other.DataToNdc;
    }
  };

  std::vector<float> Colours;
  double FinalWindow = 1.0;       // of the frame in progress
  double FinalLevel = 0.5;
  View Shown;                     // of Colours
  std::vector<float> LastColours; // of the picture before a still one, which may be aborted
  View Last;
  std::vector<float> WindowDepths; // of the pixels of the last frame
  std::vector<float> RayDepths;    // of its rays, where these are not the pixels
  std::vector<float> FirstVisible; // depths of their samples; empty where not needed
  std::vector<float> NearDepths;   // of rays that end before them; 0 where there is none
  std::vector<float> NearColours;
  std::vector<float> LayerDepths; // see vtkFFDImageDisplay::Layers
  std::vector<float> VisibleDepths; // of the first visible samples, where these are asked for
  vtkNew<vtkImageData> ColourImage; // the last frame that became an image
  std::vector<float> ImageDepths;   // of that
  vtkNew<vtkContourValues> DepthPassContourValues;
  double TimePerRay = 0.0; // seconds, of the last frame in a window
  double LastPixels = 0.0; // that it covered
  double StillTime = 0.0;  // seconds that a still picture is expected to take
  double LastStep = 0.0;   // pixels, of the last frame while the scene moved
  vtkFFDFrameCoherence Coherence;
  double ReusedFraction = 0.0;
  bool ToldOfPeeling = false;
  vtkNew<vtkFFDRayStatistics> Statistics;
  vtkFFDImageDisplay Display;
};

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Update(
  vtkVolumeProperty* property, std::string& message)
{
  ffd::StageTools tools;
  tools.Parallel = this->MakeParallelFor();
  const bool ok = this->Cache.Update(this->Self, property, tools);
  message = tools.Message;
  return ok;
}

//------------------------------------------------------------------------------
/// Update everything for the frame in progress. False after an error or, without a message, an abort.
/// What observers of the progress change meanwhile is part of the frame, what they change later is not.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Prepare(vtkVolume* volume, std::string& message)
{
  try
  {
    if (vtkAlgorithm* algorithm = this->Self->GetInputAlgorithm())
    {
      algorithm->UpdateWholeExtent();
    }
    this->Quiet = false;
    bool ok = this->Update(volume->GetProperty(), message);
    if (this->Frame->HasReported())
    {
      this->Quiet = true;
      message.clear();
      ok = this->Update(volume->GetProperty(), message);
    }
    this->Prepared = ok;
  }
  catch (const vtkFFDFrame::Aborted&)
  {
    return false;
  }
  if (this->Prepared)
  {
    this->Frame->Hold(this->Cache.GetArrays());
  }
  return this->Prepared;
}

//------------------------------------------------------------------------------
/// Whether a frame is in progress, with an error that tells so.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Refuse(const char* what) const
{
  if (this->Frame)
  {
    vtkErrorWithObjectMacro(this->Self, << what
      << " was called while the mapper renders, by an observer of its events: that is not possible. "
         "Call it after the frame, as in an observer of the render window's EndEvent.");
  }
  return this->Frame != nullptr;
}

//------------------------------------------------------------------------------
vtkFFDParallelFor vtkFFDInverseRayVolumeMapper::vtkInternals::MakeParallelFor() const
{
  vtkFFDParallelFor::Listener listener;
  if (vtkFFDFrame* frame = this->Quiet || this->Prepared ? nullptr : this->Frame)
  {
    listener = { [frame] { return frame->GetNextReport(); },
      [frame](double part) { frame->ReportPreparation(part); } };
  }
  return vtkFFDParallelFor(this->Self->NumberOfThreads, std::move(listener));
}

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::vtkInternals::CheckView(
  vtkRenderer* renderer, vtkVolume* volume, std::string& message)
{
  volume->ComputeMatrix();
  if (ffd::IsSingular(glm::dmat3(ffd::ToMatrix(volume->GetMatrix()))))
  {
    message = "The matrix of the volume is singular or not a number: it has no inside to render. "
              "Check its scale.";
    return false;
  }
  const ffd::CameraView camera = ffd::MakeCameraView(renderer, vtkFFDImageRegion(glm::ivec2(1)));
  const ffd::ViewRay ray = camera.MakeRay(0.5, 0.5);
  if (!std::isfinite(glm::dot(ray.Origin, ray.Origin)) || !(ray.Far > 0.0) ||
    !std::isfinite(ray.Far))
  {
    message = "The camera of the renderer has no viewing ray: its position, focal point, scale or "
              "clipping range is not a number or makes the projection singular. Check them, or "
              "call ResetCamera().";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
ffd::CastSettings vtkFFDInverseRayVolumeMapper::vtkInternals::MakeSettings(
  vtkVolume* volume, double voxelSize, bool interactive) const
{
  const vtkFFDInverseRayVolumeMapper* self = this->Self;
  ffd::CastSettings settings;
  settings.Segments = self->Segmentation == GREEDY_ANGLE ? ffd::Segmentation::GreedyAngle
                                                         : ffd::Segmentation::ErrorBound;
  settings.Leaping = !this->Cache.GetDistances() ? ffd::SpaceLeaping::Off
    : self->SpaceLeaping == SEGMENT            ? ffd::SpaceLeaping::Segment
                                               : ffd::SpaceLeaping::Lipschitz;
  settings.Opacity =
    self->OpacityLength == WORLD ? ffd::OpacityLength::World : ffd::OpacityLength::Material;
  settings.TerminationTransmittance = static_cast<float>(self->EarlyRayTerminationThreshold);
  settings.InverseTolerance = self->InverseTolerance;
  settings.Reference = self->ReferenceKernels != 0;
  settings.Shade = volume->GetProperty()->GetShade(0) != 0;
  settings.Jitter = self->UseJittering != 0;
  if (self->LockSampleDistanceToInputSpacing)
  {
    settings.SampleDistance = (interactive ? 2.0 : 1.0) * voxelSize;
  }
  else
  {
    settings.SampleDistance =
      interactive ? self->InteractiveSampleDistance : self->SampleDistance;
  }

  settings.SampleDistance = std::max(settings.SampleDistance, ShortestLength * voxelSize);

  const double angle = vtkMath::RadiansFromDegrees(self->AngleThreshold);
  const double shortest = std::clamp(self->MinimumSegmentLength, ShortestLength, LongestMinimum);
  double longest = std::min(self->MaximumSegmentLength, LongestSegment);
  if (longest == 0.0)
  {
    longest = LongestAutomaticSegment;
    const ffd::BoundedPullBack& map = this->Cache.GetPullBack();
    const double rate = settings.Segments == ffd::Segmentation::GreedyAngle
      ? map.Bounds.FindLargestTurnRate(
          ffd::InvertsTheField(map.Map.GetKind()) ? map.RestBounds : map.DeformedBounds)
      : 0.0;
    if (rate > 0.0)
    {
      // The rate is per data unit; so is the shortest edge of a voxel.
      longest = std::min(longest, angle / (rate * this->Cache.GetVoxelSize()));
    }
  }
  const double longestPiece =
    self->MaximumSegmentLength == 0.0 ? LongestPiece : std::min(longest, LongestPiece);
  longest = std::max(longest, shortest);
  settings.Polyline.AngleThreshold = angle;
  settings.Polyline.MinimumLength = shortest * voxelSize;
  settings.Polyline.MaximumLength = longest * voxelSize;
  settings.Pieces.Longest = std::max(longestPiece, shortest) * voxelSize;
  settings.Pieces.Shortest = shortest * voxelSize;
  settings.Pieces.PositionTolerance = self->PositionTolerance;
  return settings;
}

//------------------------------------------------------------------------------
/// Whether the cropping is that to a box of deformed space: then the rays are cut to it.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::IsCroppedToBox() const
{
  const ffd::Cropping& crop = this->Cache.GetCropping();
  return crop.Space == ffd::Cropping::Spaces::Deformed && crop.Flags == VTK_CROP_SUBVOLUME;
}

//------------------------------------------------------------------------------
/// The deformed bounds, as far as they are not cropped, without volume if nothing is left of them.
ffd::Box vtkFFDInverseRayVolumeMapper::vtkInternals::UncroppedBounds() const
{
  ffd::Box box = this->Cache.GetPullBack().DeformedBounds;
  if (this->IsCroppedToBox())
  {
    const ffd::Cropping& crop = this->Cache.GetCropping();
    box.Min = glm::max(box.Min, crop.Low);
    box.Max = glm::max(box.Min, glm::min(box.Max, crop.High));
  }
  return box;
}

//------------------------------------------------------------------------------
/// The part of them in the clip box.
ffd::Box vtkFFDInverseRayVolumeMapper::vtkInternals::VisibleBounds() const
{
  const double* clip = this->Self->ClipBox;
  const ffd::Box uncropped = this->UncroppedBounds();
  const glm::dvec3 lower = glm::max(uncropped.Min, glm::dvec3(clip[0], clip[2], clip[4]));
  const glm::dvec3 upper = glm::min(uncropped.Max, glm::dvec3(clip[1], clip[3], clip[5]));
  return { lower, glm::max(lower, upper) };
}

//------------------------------------------------------------------------------
/// The part of a viewport that shows the volume; without rays if none does.
vtkFFDImageRegion vtkFFDInverseRayVolumeMapper::vtkInternals::FindRegion(
  vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& whole)
{
  vtkFFDImageRegion region = whole;
  region.Rays = glm::ivec2(0);
  const ffd::Box visible = this->VisibleBounds();
  if (glm::any(glm::lessThanEqual(visible.Max, visible.Min)))
  {
    return region;
  }
  const ffd::CameraView camera = ffd::MakeCameraView(renderer, whole);
  const glm::dmat4 toNdc = camera.WorldToNdc * ffd::ToMatrix(volume->GetMatrix());
  glm::dvec2 lo(Infinity);
  glm::dvec2 hi(-Infinity);
  bool behind = false;
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 p((corner & 1 ? visible.Max : visible.Min).x,
      (corner & 2 ? visible.Max : visible.Min).y, (corner & 4 ? visible.Max : visible.Min).z);
    const glm::dvec4 clip = toNdc * glm::dvec4(p, 1.0);
    // Behind the near plane the projection means nothing.
    behind = behind || !(clip.w > 0.0) || !(clip.z >= -clip.w);
    const glm::dvec2 ndc = glm::dvec2(clip) / clip.w;
    lo = glm::min(lo, ndc);
    hi = glm::max(hi, ndc);
  }
  if (behind)
  {
    lo = glm::dvec2(-1.0);
    hi = glm::dvec2(1.0);
  }
  const glm::dvec2 size(whole.Viewport);
  const glm::dvec2 first = glm::floor(0.5 * (glm::clamp(lo, -1.0, 1.0) + 1.0) * size);
  const glm::dvec2 last = glm::ceil(0.5 * (glm::clamp(hi, -1.0, 1.0) + 1.0) * size);
  // Rays of a tile share evaluations: with the same tiles a picture is the same in a window, as an
  // image, and in the boxes of several processes, whatever part of the viewport it covers.
  region.Origin = glm::ivec2(first);
  region.Origin -= region.Origin % ffd::RayCaster::TileSize;
  region.Rays = glm::ivec2(last) - region.Origin;
  return region;
}

//------------------------------------------------------------------------------
ffd::CastScene vtkFFDInverseRayVolumeMapper::vtkInternals::MakeScene(vtkRenderer* renderer,
  vtkVolume* volume, const vtkFFDImageRegion& region, const float* depths)
{
  const vtkFFDFrameCache& cache = this->Cache;
  const ffd::BoundedPullBack& map = cache.GetPullBack();
  ffd::CastScene scene;
  scene.Volume = cache.GetVolume();
  vtkVolumeProperty* property = volume->GetProperty();
  scene.VolumeInterpolation = property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION
    ? ffd::Interpolation::Nearest
    : ffd::Interpolation::Linear;
  scene.Table = &cache.GetFunctions().Components[0].Table;
  scene.Distances = cache.GetDistances();
  scene.Map = &map.Map;
  scene.Limits = map.Bounds.GetLimits();
  scene.DeformedBounds = this->VisibleBounds();
  if (this->Self->HasClipBox)
  {
    this->WholeBounds = this->UncroppedBounds();
    scene.WholeAtRest = &map.RestBounds;
    scene.WholeDeformed = &this->WholeBounds;
  }
  scene.Blend = cache.GetBlending();
  scene.Crop = this->IsCroppedToBox() ? ffd::Cropping() : cache.GetCropping();
  // The world of the kernels is the space of the data. VTK's mappers measure there, too: a volume
  // looks as dense whatever its matrix scales it by.
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
  scene.Camera = ffd::ToData(ffd::MakeCameraView(renderer, region), dataToWorld);
  scene.Depths = depths;
  scene.VoxelSize = cache.GetVoxelSize();
  this->MakeClassifier(scene, property);
  return scene;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::vtkInternals::MakeClassifier(
  ffd::CastScene& scene, vtkVolumeProperty* property)
{
  this->Lighting = scene.Material;
  ffd::ClassifierInputs inputs;
  inputs.Volume = scene.Volume;
  inputs.VolumeInterpolation = scene.VolumeInterpolation;
  inputs.Functions = &this->Cache.GetFunctions();
  inputs.Material = &this->Lighting;
  inputs.Mask = this->Cache.GetMask();
  inputs.Hidden = this->Cache.GetHidden();
  inputs.SecondAxis = this->Cache.GetSecondAxis();
  inputs.NormalFromOpacity = this->Self->GetComputeNormalFromOpacity();
  const double clippedIntensity = property->GetClippedVoxelIntensity();
  if (property->GetUseClippedVoxelIntensity() && std::isfinite(clippedIntensity))
  {
    inputs.ClippingPlanes = scene.ClippingPlanes;
    inputs.ClippedIntensity =
      std::clamp(clippedIntensity, -LargestClippedIntensity, LargestClippedIntensity);
  }
  // Of still pictures: those while the scene moves look alike.
  inputs.ReferenceLength = this->Self->LockSampleDistanceToInputSpacing
    ? scene.VoxelSize
    : this->Self->SampleDistance;
  this->Classifier.reset(new ffd::SampleClassifier(inputs));
  scene.Classifier = this->Classifier.get();
}

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Cast(vtkRenderer* renderer, vtkVolume* volume,
  const vtkFFDImageRegion& region, const float* depths, bool interactive, bool window,
  float* outDepths)
{
  const ffd::CastScene scene = this->MakeScene(renderer, volume, region, depths);
  const ffd::CastSettings settings = this->MakeSettings(volume, scene.VoxelSize, interactive);
  ffd::CastImage image;
  image.Width = region.Rays.x;
  image.Height = region.Rays.y;
  const std::size_t rays =
    static_cast<std::size_t>(image.Width) * static_cast<std::size_t>(image.Height);
  const bool layers = window && depths && region.Step > 1.0;
  if (layers == this->FirstVisible.empty())
  {
    this->Coherence.Clear();
    this->FirstVisible.resize(layers ? rays : 0);
  }
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  std::unique_ptr<const ffd::RayCaster> made;
  std::vector<vtkFFDFrameCoherence::Part> tiles;
  if (window && this->CanReuse(volume))
  {
    const vtkFFDFrameCoherence::Sources sources = { this->Self->GetSettingsTime(),
      this->Cache.GetVoxelsVersion(), this->Cache.GetFunctionsVersion(),
      ffd::FindSource(volume->GetProperty()), ffd::ToMatrix(volume->GetMatrix()), interactive };
    // Both take about as long.
    parallelFor(2,
      [&](std::size_t first, std::size_t last)
      {
        for (std::size_t task = first; task < last; ++task)
        {
          if (task == 0)
          {
            tiles = this->Coherence.Begin(sources, scene, region, this->Cache.GetPullBack().RestBounds,
              this->Self->FrameCoherenceTolerance, this->Colours, this->FirstVisible);
          }
          else
          {
            made = std::make_unique<const ffd::RayCaster>(scene, settings);
          }
        }
      });
    image.Reaches = this->Coherence.GetReaches();
  }
  else
  {
    made = std::make_unique<const ffd::RayCaster>(scene, settings);
    this->Coherence.Clear();
    this->Colours.resize(4 * rays);
    this->FirstVisible.resize(layers ? rays : 0);
    for (int tile = 0; tile < made->GetNumberOfTiles(image); ++tile)
    {
      tiles.push_back({ tile, ffd::RayCaster::AllQuarters });
    }
  }
  const ffd::RayCaster& caster = *made;
  const double part = FindPart(tiles, region.Rays);
  this->ReusedFraction = 1.0 - part;
  image.Colours = this->Colours.data();
  image.Depths = layers ? this->FirstVisible.data() : outDepths;

  std::vector<ffd::RayCaster::Scratch> scratch(
    static_cast<std::size_t>(parallelFor.GetNumberOfWorkers()));
  // Observers may change the options.
  const bool collect = this->Self->CollectStatistics != 0;
  this->FinalWindow = this->Self->FinalColorWindow;
  this->FinalLevel = this->Self->FinalColorLevel;
  std::atomic<std::size_t> next{ 0 };
  std::mutex mutex;
  std::vector<vtkFFDFrameCoherence::Part> stopped; // tiles that have begun
  bool aborted = !this->Frame->ReportCasting(0.0);
  if (tiles.empty() && !aborted)
  {
    this->Frame->ReportCasting(1.0);
  }
  const std::size_t most =
    this->TimePerRay > 0.0 ? tiles.size() : tiles.size() / LeastReports + 1; // of tiles between reports
  while (next < tiles.size() && !aborted)
  {
    const ffd::Deadline due = this->Frame->GetNextReport();
    const std::size_t end = std::min(tiles.size(), next + most);
    parallelFor.RunWorkers(
      [&](int worker)
      {
        do
        {
          const std::size_t i = next++;
          if (i >= end)
          {
            return;
          }
          vtkFFDFrameCoherence::Part& tile = tiles[i];
          // A tile that stops evaluates some of the deformation again: that is not to be counted.
          tile.First = caster.RenderTile(tile.Tile, image, scratch[static_cast<std::size_t>(worker)],
            tile.Quarters, tile.First, collect ? ffd::NoDeadline : due);
          if (tile.First == 0)
          {
            this->ApplyFinalColours(region, tile, this->Colours);
          }
          else
          {
            const std::lock_guard<std::mutex> lock(mutex);
            stopped.push_back(tile);
          }
        } while (vtkFFDFrame::Clock::now() < due);
      });
    std::size_t begun = std::min<std::size_t>(next, end);
    for (const vtkFFDFrameCoherence::Part& tile : stopped)
    {
      tiles[--begun] = tile;
    }
    stopped.clear();
    next = begun;
    aborted =
      !this->Frame->ReportCasting(static_cast<double>(begun) / static_cast<double>(tiles.size()));
  }
  if (aborted)
  {
    this->Coherence.Clear();
  }

  if (collect && !aborted)
  {
    ffd::CastStatistics total;
    for (const ffd::RayCaster::Scratch& each : scratch)
    {
      total.Add(ffd::RayCaster::GetStatistics(each));
    }
    this->Statistics->SetCounts(total.Rays, total.Segments, total.SegmentLength, total.Samples,
      total.VisibleSamples, total.DistanceLookups, total.Evaluations, total.Unconverged);
  }
  return !aborted;
}

//------------------------------------------------------------------------------
/// The rays of a frame are drawn over more pixels: those whose centres are nearer than a step.
class vtkFFDInverseRayVolumeMapper::vtkInternals::Footprints
{
public:
  Footprints(const vtkFFDImageRegion& region, const glm::ivec2& pixels)
    : Pixels(pixels)
    , Step(region.Step)
    , Reach(region.Step > 1.0 ? region.Step : 0.5)
  {
  }

  /// Calls work(depth) for the window depths, `all` of them, of the pixels of a ray.
  template <class Work>
  void ForEach(const std::vector<float>& all, int x, int y, const Work& work) const
  {
    const glm::dvec2 centre = (glm::dvec2(x, y) + 0.5) * this->Step;
    const glm::ivec2 last = this->Pixels - 1;
    const glm::ivec2 low =
      glm::clamp(glm::ivec2(glm::floor(centre - this->Reach + 0.5)), glm::ivec2(0), last);
    const glm::ivec2 high =
      glm::clamp(glm::ivec2(glm::ceil(centre + this->Reach - 0.5)) - 1, low, last);
    for (int py = low.y; py <= high.y; ++py)
    {
      for (int px = low.x; px <= high.x; ++px)
      {
        work(all[static_cast<std::size_t>(py) * this->Pixels.x + px]);
      }
    }
  }

private:
  glm::ivec2 Pixels;
  double Step;
  double Reach;
};

//------------------------------------------------------------------------------
/// The depths where rays end: at the farthest geometry of their pixels. Thin geometry would end
/// those of the pixels beside it, too.
void vtkFFDInverseRayVolumeMapper::vtkInternals::FindRayDepths(
  const vtkFFDImageRegion& region, const glm::ivec2& pixels)
{
  const std::size_t columns = static_cast<std::size_t>(region.Rays.x);
  this->RayDepths.resize(columns * static_cast<std::size_t>(region.Rays.y));
  const Footprints footprints(region, pixels);
  this->MakeParallelFor()(static_cast<std::size_t>(region.Rays.y),
    [&](std::size_t first, std::size_t last)
    {
      for (std::size_t y = first; y < last; ++y)
      {
        for (std::size_t x = 0; x < columns; ++x)
        {
          float farthest = 0.0f;
          footprints.ForEach(this->WindowDepths, static_cast<int>(x), static_cast<int>(y),
            [&farthest](float depth) { farthest = std::max(farthest, depth); });
          this->RayDepths[y * columns + x] = farthest;
        }
      }
    });
}

//------------------------------------------------------------------------------
/// After Cast() with these depths: where geometry is nearer in some of the pixels of a ray, what is
/// seen in front of it. In front of the first visible sample that is nothing; a second ray is cast
/// to the nearest geometry behind that.
vtkFFDImageDisplay::Layers vtkFFDInverseRayVolumeMapper::vtkInternals::CastLayers(
  vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& region,
  const glm::ivec2& pixels, bool interactive)
{
  const ffd::CastScene scene = this->MakeScene(renderer, volume, region, nullptr);
  const ffd::BlendMode mode = scene.Blend.Mode;
  const bool startsAtSample =
    mode == ffd::BlendMode::Composite || mode == ffd::BlendMode::Isosurface;
  const glm::ivec2& rays = region.Rays;
  const std::size_t count = this->RayDepths.size();
  const Footprints footprints(region, pixels);
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  this->NearDepths.assign(count, 0.0f); // not cast
  this->LayerDepths.assign(3 * count, -1.0f);
  std::atomic<bool> any{ false };
  parallelFor(static_cast<std::size_t>(rays.y),
    [&](std::size_t firstRow, std::size_t lastRow)
    {
      for (int y = static_cast<int>(firstRow); y < static_cast<int>(lastRow); ++y)
      {
        for (int x = 0; x < rays.x; ++x)
        {
          const std::size_t at = static_cast<std::size_t>(y) * rays.x + x;
          float nearest = 1.0f;
          const auto find = [&](float low, float high)
          {
            nearest = 1.0f;
            footprints.ForEach(this->WindowDepths, x, y,
              [&](float depth)
              { nearest = depth > low && depth < high ? std::min(nearest, depth) : nearest; });
          };
          find(-1.0f, this->RayDepths[at]);
          const glm::dvec2 p(x + 0.5, y + 0.5);
          const ffd::CameraView& camera = scene.Camera;
          const ffd::ViewRay ray = camera.MakeRay(p.x, p.y);
          double from = 0.0;
          double to = ray.Far;
          if (nearest == 1.0f ||
            !ClipToBox(ray.Origin, ray.Direction, scene.DeformedBounds, from, to))
          {
            continue;
          }
          const auto toT = [&](float depth)
          { return camera.DepthToT(ray, p.x, p.y, static_cast<double>(depth)); };
          const auto toDepth = [&](double t)
          { return static_cast<float>(camera.ToDepth(ray.Origin + t * ray.Direction)); };
          const float start = startsAtSample ? this->FirstVisible[at] : toDepth(from);
          to = std::min(to, toT(this->RayDepths[at]));
          float* depths = &this->LayerDepths[3 * at];
          std::fill_n(depths, 3, start);
          find(toDepth(toT(start) + scene.VoxelSize), toDepth(to - scene.VoxelSize));
          if (nearest < 1.0f)
          {
            this->NearDepths[at] = depths[1] = nearest;
            depths[2] = toDepth(to);
          }
          any = true;
        }
      }
    });
  if (!any)
  {
    return {};
  }
  this->CastNearer(volume, scene, region, interactive);
  vtkFFDImageDisplay::Layers layers;
  layers.Colours = this->NearColours.data();
  layers.Depths = this->LayerDepths.data();
  layers.PixelDepths = this->WindowDepths.data();
  for (int a = 0; a < 2; ++a)
  {
    layers.Pixels[a] = pixels[a];
    layers.Origin[a] = region.Origin[a];
    layers.Viewport[a] = region.Viewport[a];
  }
  return layers;
}

//------------------------------------------------------------------------------
/// The rays that end at NearDepths; those of depth 0 are as they were cast.
void vtkFFDInverseRayVolumeMapper::vtkInternals::CastNearer(
  vtkVolume* volume, ffd::CastScene scene, const vtkFFDImageRegion& region, bool interactive)
{
  scene.Depths = this->NearDepths.data();
  const ffd::RayCaster caster(scene, this->MakeSettings(volume, scene.VoxelSize, interactive));
  this->NearColours = this->Colours;
  ffd::CastImage image;
  image.Width = region.Rays.x;
  image.Height = region.Rays.y;
  image.Colours = this->NearColours.data();
  constexpr int size = ffd::RayCaster::TileSize;
  const int tilesPerRow = (image.Width + size - 1) / size;
  const auto forEachRay = [&](int tile, const auto& work)
  {
    const glm::ivec2 first(tile % tilesPerRow * size, tile / tilesPerRow * size);
    const glm::ivec2 end = glm::min(first + size, region.Rays);
    for (int y = first.y; y < end.y; ++y)
    {
      for (int x = first.x; x < end.x; ++x)
      {
        work(static_cast<std::size_t>(y) * image.Width + x);
      }
    }
  };
  const vtkFFDParallelFor parallelFor = this->MakeParallelFor();
  std::vector<ffd::RayCaster::Scratch> scratch(
    static_cast<std::size_t>(parallelFor.GetNumberOfWorkers()));
  std::atomic<int> nextTile{ 0 };
  parallelFor.RunWorkers(
    [&](int worker)
    {
      const int tiles = caster.GetNumberOfTiles(image);
      for (int tile = nextTile++; tile < tiles; tile = nextTile++)
      {
        bool any = false;
        forEachRay(tile, [&](std::size_t at) { any = any || this->NearDepths[at] > 0.0f; });
        if (!any)
        {
          continue;
        }
        const vtkFFDFrameCoherence::Part part{ tile, ffd::RayCaster::AllQuarters };
        caster.RenderTile(tile, image, scratch[static_cast<std::size_t>(worker)], part.Quarters);
        this->ApplyFinalColours(region, part, this->NearColours);
        forEachRay(tile,
          [&](std::size_t at)
          {
            if (this->NearDepths[at] == 0.0f)
            {
              std::copy_n(&this->Colours[4 * at], 4, &this->NearColours[4 * at]);
            }
          });
      }
    });
}

//------------------------------------------------------------------------------
/// Window and level of the colours of a finished tile.
void vtkFFDInverseRayVolumeMapper::vtkInternals::ApplyFinalColours(const vtkFFDImageRegion& region,
  const vtkFFDFrameCoherence::Part& tile, std::vector<float>& colours) const
{
  const double window = this->FinalWindow;
  const double level = this->FinalLevel;
  if (window == 1.0 && level == 0.5)
  {
    return;
  }
  const float scale = static_cast<float>(1.0 / window);
  const float bias = static_cast<float>(0.5 - level / window);
  constexpr int size = ffd::RayCaster::TileSize;
  const int tilesPerRow = (region.Rays.x + size - 1) / size;
  const glm::ivec2 first(tile.Tile % tilesPerRow * size, tile.Tile / tilesPerRow * size);
  const glm::ivec2 end = glm::min(first + size, region.Rays);
  for (int y = first.y; y < end.y; ++y)
  {
    for (int x = first.x; x < end.x; ++x)
    {
      const glm::ivec2 quarter = (glm::ivec2(x, y) - first) / ffd::RayCaster::QuarterSize;
      if ((tile.Quarters >> (quarter.x + 2 * quarter.y) & 1u) == 0)
      {
        continue;
      }
      float* pixel = &colours[4 * (static_cast<std::size_t>(y) * region.Rays.x + x)];
      for (int c = 0; c < 3; ++c)
      {
        pixel[c] = std::clamp(pixel[c] * scale + bias * pixel[3], 0.0f, 1.0f);
      }
    }
  }
}

//------------------------------------------------------------------------------
/// As VTK's ray casters: a second or more is time for a still picture.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::IsMoving(vtkVolume* volume) const
{
  return volume->GetAllocatedRenderTime() < 1.0 / this->Self->InteractiveUpdateRate;
}

//------------------------------------------------------------------------------
/// The point or cell of the input whose material is shown at a point of deformed space.
vtkIdType vtkFFDInverseRayVolumeMapper::vtkInternals::FindIdentifier(
  const glm::dvec3& deformed, bool cells) const
{
  const ffd::VolumeView& volume = this->Cache.GetVolume();
  const glm::dvec3 index =
    ffd::SurfaceSearch(volume, this->Cache.GetPullBack().Map, deformed, glm::dvec3(0.0)).Evaluate(0.0).Index;
  const glm::dvec3 inside = glm::clamp(index, volume.LowerIndex(), volume.UpperIndex());
  const glm::dvec3 at = (volume.Axes ? volume.Axes->ToVoxel(inside) : inside) + volume.Margin;
  int points[3] = { 2, 2, 2 };
  vtkDataSet* input = this->Self->GetInput();
  if (auto* image = vtkImageData::SafeDownCast(input))
  {
    image->GetDimensions(points);
  }
  else if (auto* grid = vtkRectilinearGrid::SafeDownCast(input))
  {
    grid->GetDimensions(points);
  }
  vtkIdType id = 0;
  for (int a = 2; a >= 0; --a)
  {
    const vtkIdType count = cells ? points[a] - 1 : points[a];
    const auto which = static_cast<vtkIdType>(std::floor(cells ? at[a] : at[a] + 0.5));
    id = id * count + std::clamp<vtkIdType>(which, 0, count - 1);
  }
  return id;
}

//------------------------------------------------------------------------------
/// What the present pass of a selector is to read from visible pixels, in the place of colours.
void vtkFFDInverseRayVolumeMapper::vtkInternals::PaintIdentifiers(
  vtkHardwareSelector* selector, const ffd::CameraView& camera, const std::vector<float>& depths)
{
  const int pass = selector->GetCurrentPass();
  const bool cells =
    pass == vtkHardwareSelector::CELL_ID_LOW24 || pass == vtkHardwareSelector::CELL_ID_HIGH24;
  const bool high =
    pass == vtkHardwareSelector::POINT_ID_HIGH24 || pass == vtkHardwareSelector::CELL_ID_HIGH24;
  const bool identifiers = cells || high || pass == vtkHardwareSelector::POINT_ID_LOW24;
  selector->BeginRenderProp();
  if (pass == vtkHardwareSelector::COMPOSITE_INDEX_PASS)
  {
    selector->RenderCompositeIndex(1); // as surfaces that are not of composite data
  }
  selector->UpdateMaximumPointId(this->Self->GetInput()->GetNumberOfPoints());
  selector->UpdateMaximumCellId(this->Self->GetInput()->GetNumberOfCells());
  float same[3] = { 0.0f, 0.0f, 0.0f };
  selector->GetPropColorValue(same);
  selector->EndRenderProp();
  const auto paint = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
    {
      float* pixel = &this->Colours[4 * i];
      const bool visible = pixel[3] > LeastPickedAlpha;
      std::copy_n(same, 3, pixel);
      if (visible && identifiers)
      {
        const glm::dvec2 centre(static_cast<double>(i % camera.ImageSize.x) + 0.5,
          static_cast<double>(i / camera.ImageSize.x) + 0.5);
        const glm::dvec2 ndc = camera.NdcOrigin + centre * camera.NdcPerPixel;
        const vtkIdType id =
          this->FindIdentifier(camera.ToWorld(glm::dvec3(ndc, 2.0 * depths[i] - 1.0)), cells);
        vtkHardwareSelector::Convert(high ? id >> 24 : id, pixel);
      }
      pixel[3] = visible ? 1.0f : 0.0f;
      for (int c = 0; c < 3 && !visible; ++c)
      {
        pixel[c] = 0.0f;
      }
    }
  };
  this->MakeParallelFor()(depths.size(), paint);
}

//------------------------------------------------------------------------------
/// Where nothing is visible, the depths at which rays leave the bounds.
void vtkFFDInverseRayVolumeMapper::vtkInternals::MoveToBackface(
  const ffd::CameraView& camera, std::vector<float>& depths) const
{
  const ffd::Box bounds = this->VisibleBounds();
  for (std::size_t i = 0; i < depths.size(); ++i)
  {
    if (this->Colours[4 * i + 3] > 0.0f)
    {
      continue;
    }
    const ffd::ViewRay ray = camera.MakeRay(static_cast<double>(i % camera.ImageSize.x) + 0.5,
      static_cast<double>(i / camera.ImageSize.x) + 0.5);
    double enter = 0.0;
    double leave = ray.Far;
    if (ClipToBox(ray.Origin, ray.Direction, bounds, enter, leave))
    {
      const glm::dvec4 clip =
        camera.WorldToNdc * glm::dvec4(ray.Origin + leave * ray.Direction, 1.0);
      depths[i] = static_cast<float>(0.5 * (clip.z / clip.w + 1.0));
    }
  }
}

//------------------------------------------------------------------------------
/// The images are as large as the window, and made anew with every frame.
void vtkFFDInverseRayVolumeMapper::vtkInternals::ReleaseImages()
{
  this->Coherence.Clear();
  std::vector<float>().swap(this->Colours);
  std::vector<float>().swap(this->LastColours);
  std::vector<float>().swap(this->WindowDepths);
  std::vector<float>().swap(this->RayDepths);
  std::vector<float>().swap(this->FirstVisible);
  std::vector<float>().swap(this->VisibleDepths);
  std::vector<float>().swap(this->NearDepths);
  std::vector<float>().swap(this->LayerDepths);
  std::vector<float>().swap(this->NearColours);
  this->Shown = View();
  this->Last = View();
}

//------------------------------------------------------------------------------
/// Changes with what a frame is made from.
vtkMTimeType vtkFFDInverseRayVolumeMapper::vtkInternals::FindSceneTime(vtkVolume* volume) const
{
  return std::max(this->Self->GetMTime(), volume->GetMTime());
}

//------------------------------------------------------------------------------
/// Seconds that a still picture of so many pixels takes, from the frame that has been made.
double vtkFFDInverseRayVolumeMapper::vtkInternals::FindStillTime(
  const glm::ivec2& pixels, bool interactive) const
{
  if (!interactive)
  {
    // What has been cast of an aborted one tells of the rest.
    const double part = this->Frame->GetCastPart();
    return part > 0.0 ? this->Frame->GetSeconds() / part : this->StillTime;
  }
  const double samples = this->Self->LockSampleDistanceToInputSpacing
    ? 2.0
    : this->Self->InteractiveSampleDistance / this->Self->SampleDistance;
  return this->TimePerRay * pixels.x * pixels.y * std::max(1.0, samples);
}

//------------------------------------------------------------------------------
/// Whether the frame may show parts of the last one again: while the scene moves only, so that no
/// still picture depends on what was drawn before it.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::CanReuse(vtkVolume* volume) const
{
  return this->Self->FrameCoherence && !this->Self->CollectStatistics &&
    this->Cache.GetBlending().Mode != ffd::BlendMode::Slice && this->IsMoving(volume);
}

//------------------------------------------------------------------------------
/// Pixels between rays, for the time allotted to a frame.
double vtkFFDInverseRayVolumeMapper::vtkInternals::FindStep(
  double allotted, const glm::ivec2& pixels) const
{
  const double least = this->Self->MinimumImageSampleDistance;
  const double most = std::max(least, this->Self->MaximumImageSampleDistance);
  const double estimate = this->TimePerRay * pixels.x * pixels.y;
  const double wanted =
    std::clamp(allotted > 0.0 ? std::sqrt(estimate / allotted) : 1.0, least, most);
  // Frames of another distance have nothing in common with the last one.
  if (this->LastStep >= least && this->LastStep <= most &&
    std::abs(this->LastStep - wanted) <= StepHysteresis * wanted)
  {
    return this->LastStep;
  }
  return std::min(most, std::ceil(wanted * StepsPerPixel) / StepsPerPixel);
}

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
vtkAbstractTransform* vtkFFDInverseRayVolumeMapper::GetDeformation()
{
  return this->Deformation;
}

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
bool vtkFFDInverseRayVolumeMapper::SetPositive(const char* name, double& member, double value)
{
  if (!(value > 0.0) || !std::isfinite(value))
  {
    vtkErrorMacro(<< name << " must be a positive number, not " << value << "; it stays "
                  << member << ".");
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
void vtkFFDInverseRayVolumeMapper::SetMaxMemoryFraction(float fraction)
{
  // vtkSetClampMacro lets through what is not a number.
  const float clamped = fraction >= 0.1f ? std::min(fraction, 1.0f) : 0.1f;
  if (this->MaxMemoryFraction != clamped)
  {
    this->MaxMemoryFraction = clamped;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetInverseTolerance(double voxels)
{
  this->SetPositive("InverseTolerance", this->InverseTolerance, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetPositionTolerance(double voxels)
{
  this->SetPositive("PositionTolerance", this->PositionTolerance, voxels);
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
  this->SetPositive("AngleThreshold", this->AngleThreshold, degrees);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMinimumSegmentLength(double voxels)
{
  this->SetPositive("MinimumSegmentLength", this->MinimumSegmentLength, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMaximumSegmentLength(double voxels)
{
  if (voxels == 0.0)
  {
    if (this->MaximumSegmentLength != 0.0)
    {
      this->MaximumSegmentLength = 0.0;
      this->Modified();
    }
    return;
  }
  this->SetPositive("MaximumSegmentLength", this->MaximumSegmentLength, voxels);
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
  if (this->SetPositive("SampleDistance", this->SampleDistance, distance))
  {
    this->SetLockSampleDistanceToInputSpacing(0);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetInteractiveSampleDistance(double distance)
{
  if (this->SetPositive("InteractiveSampleDistance", this->InteractiveSampleDistance, distance))
  {
    this->SetLockSampleDistanceToInputSpacing(0);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetImageSampleDistance(double pixels)
{
  this->SetPositive("ImageSampleDistance", this->ImageSampleDistance,
    pixels > 0.0 ? std::clamp(pixels, 0.1, 100.0) : pixels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMinimumImageSampleDistance(double pixels)
{
  this->SetPositive("MinimumImageSampleDistance", this->MinimumImageSampleDistance,
    pixels > 0.0 ? std::clamp(pixels, 0.1, 100.0) : pixels);
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetMaximumImageSampleDistance(double pixels)
{
  this->SetPositive("MaximumImageSampleDistance", this->MaximumImageSampleDistance,
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
      vtkErrorMacro(<< "ClipBox: the limits " << box[2 * a] << ", " << box[2 * a + 1]
                    << " of axis " << a
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
  const std::size_t size = in.Cache.GetMemorySize() + in.Coherence.GetMemorySize();
  return static_cast<vtkTypeInt64>(size);
}

//------------------------------------------------------------------------------
double vtkFFDInverseRayVolumeMapper::GetExpectedStillTime()
{
  return this->Internals->StillTime;
}

//------------------------------------------------------------------------------
double vtkFFDInverseRayVolumeMapper::GetReusedFraction()
{
  return this->Internals->ReusedFraction;
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
  if (vtkAlgorithmOutput* connection =
        this->GetNumberOfInputConnections(0) > 0 ? this->GetInputConnection(0, 0) : nullptr)
  {
    connection->GetProducer()->Update(connection->GetIndex());
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::Update(int)
{
  this->Update();
}

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
  vtkImageData* colours = this->Internals->ColourImage;
  if (!image || !colours->GetPointData()->GetScalars())
  {
    vtkErrorMacro(<< "GetColorImage: "
                  << (image ? "no frame became an image yet. Call "
                              "RenderToImageOn() and render a window first."
                            : "the image is null."));
    return;
  }
  image->DeepCopy(colours);
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
  image->SetExtent(this->Internals->ColourImage->GetExtent());
  switch (this->DepthImageScalarType)
  {
    case VTK_UNSIGNED_CHAR:
      image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
      WriteDepths(depths, 255.0, static_cast<unsigned char*>(image->GetScalarPointer()));
      break;
    case VTK_UNSIGNED_SHORT:
      image->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
      WriteDepths(depths, 65535.0, static_cast<unsigned short*>(image->GetScalarPointer()));
      break;
    default:
      image->AllocateScalars(VTK_FLOAT, 1);
      WriteDepths(depths, 1.0, static_cast<float*>(image->GetScalarPointer()));
      break;
  }
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::SetInteractiveUpdateRate(double framesPerSecond)
{
  this->SetPositive("InteractiveUpdateRate", this->InteractiveUpdateRate,
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
void vtkFFDInverseRayVolumeMapper::CreateCanonicalView(vtkRenderer* renderer, vtkVolume* volume,
  vtkImageData* image, int blendMode, double viewDirection[3], double viewUp[3])
{
  if (!volume || !image || !viewDirection || !viewUp)
  {
    vtkErrorMacro(<< "CreateCanonicalView needs a volume, an image and two directions; the "
                  << (!volume ? "volume" : !image ? "image" : "direction or the upward direction")
                  << " is null.");
    return;
  }
  vtkNew<vtkRenderer> canonical;
  vtkNew<vtkLight> headlight;
  vtkLightCollection* lights = renderer ? renderer->GetLights() : nullptr;
  if (lights && lights->GetNumberOfItems() > 0)
  {
    canonical->SetLightCollection(lights);
  }
  else
  {
    headlight->SetLightTypeToHeadlight();
    canonical->AddLight(headlight);
  }
  double bounds[6];
  volume->GetBounds(bounds);
  const double distance = bounds[1] - bounds[0];
  const glm::dvec3 centre(
    0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]), 0.5 * (bounds[4] + bounds[5]));
  const glm::dvec3 position =
    centre - distance * glm::dvec3(viewDirection[0], viewDirection[1], viewDirection[2]);
  vtkCamera* camera = canonical->GetActiveCamera();
  camera->SetFocalPoint(centre.x, centre.y, centre.z);
  camera->SetPosition(position.x, position.y, position.z);
  camera->SetViewUp(viewUp);
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * distance);
  canonical->ResetCameraClippingRange(bounds);

  int size[3];
  image->GetDimensions(size);
  vtkNew<vtkImageData> colours;
  const int keptBlendMode = this->BlendMode;
  const vtkTypeBool keptCropping = this->Cropping;
  const vtkTypeBool keptAlpha = this->PremultipliedAlpha;
  this->BlendMode = blendMode;
  this->Cropping = 0;
  this->PremultipliedAlpha = 1;
  const bool made =
    this->RenderToImage(canonical, volume, size[0], size[1], colours, nullptr, nullptr) == 1;
  // What an observer has set meanwhile stays.
  const auto restore = [](int& option, int was, int meanwhile)
  { option = option == meanwhile ? was : option; };
  restore(this->BlendMode, keptBlendMode, blendMode);
  restore(this->Cropping, keptCropping, 0);
  restore(this->PremultipliedAlpha, keptAlpha, 1);
  if (!made)
  {
    return;
  }
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  const auto* rgba = static_cast<const unsigned char*>(colours->GetScalarPointer());
  auto* rgb = static_cast<unsigned char*>(image->GetScalarPointer());
  for (vtkIdType i = 0; i < colours->GetNumberOfPoints(); ++i)
  {
    std::copy_n(rgba + 4 * i, 3, rgb + 3 * i);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::PreLoadData(vtkRenderer*, vtkVolume* volume)
{
  if (!volume)
  {
    vtkErrorMacro(<< "PreLoadData: the volume is null.");
    return false;
  }
  if (this->Internals->Refuse("PreLoadData()"))
  {
    return false;
  }
  if (this->GetInputAlgorithm())
  {
    this->GetInputAlgorithm()->UpdateWholeExtent();
  }
  std::string message;
  if (!this->Internals->Update(volume->GetProperty(), message))
  {
    vtkErrorMacro(<< message);
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
float vtkFFDInverseRayVolumeMapper::GetEstimatedRenderTime(vtkRenderer*, vtkVolume*)
{
  return static_cast<float>(this->Internals->EstimateTime());
}

//------------------------------------------------------------------------------
float vtkFFDInverseRayVolumeMapper::ComputeRequiredImageSampleDistance(
  float desiredTime, vtkRenderer*, vtkVolume*)
{
  const double wanted = desiredTime > 0.0f
    ? std::sqrt(this->Internals->EstimateTime() / desiredTime)
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
bool vtkFFDInverseRayVolumeMapper::MakeProbeView(vtkFFDProbeView& view)
{
  vtkInternals& in = *this->Internals;
  if (in.Frame && !in.Prepared && in.Refuse("A look at the volume"))
  {
    return false;
  }
  // During a frame it is that of the frame.
  if (!in.Frame)
  {
    if (this->GetInputAlgorithm())
    {
      this->GetInputAlgorithm()->UpdateWholeExtent();
    }
    ffd::StageTools tools;
    tools.Parallel = in.MakeParallelFor();
    bool known = false;
    if (!vtkFFDGuard(this, "The volume", [&] { known = in.Cache.UpdateProbe(this, tools); }))
    {
      return false;
    }
    if (!known)
    {
      vtkErrorMacro(<< tools.Message);
      return false;
    }
  }
  const vtkFFDFrameCache& cache = in.Cache;
  view.Crop = cache.GetCropping();
  view.Volume = cache.GetVolume();
  view.Hidden = cache.GetHidden();
  view.Mask = cache.GetMask();
  view.Map = cache.GetPullBack().Map;
  // A little more than the bounds: a ray is to be seen coming in through a face that lies on them.
  const double margin = 0.01 * cache.GetVoxelSize();
  const double* clip = this->ClipBox;
  const ffd::Box& deformed = cache.GetPullBack().DeformedBounds;
  view.Deformed = { glm::max(deformed.Min - margin, glm::dvec3(clip[0], clip[2], clip[4])),
    glm::min(deformed.Max + margin, glm::dvec3(clip[1], clip[3], clip[5])) };
  return true;
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
  const glm::dvec3 q =
    ffd::SurfaceSearch(view.Volume, view.Map, p, glm::dvec3(0.0)).Evaluate(0.0).Rest;
  std::copy_n(&q.x, 3, rest);
  return 1;
}

//------------------------------------------------------------------------------
double* vtkFFDInverseRayVolumeMapper::GetBounds()
{
  if (this->Internals->Frame)
  {
    // What the frame shows, whatever its observers have changed.
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
void vtkFFDInverseRayVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkFFDGuard(this, "Render", [&] { this->RenderInWindow(renderer, volume); });
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::RenderInWindow(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkHardwareSelector* selector = renderer->GetSelector();
  // Render passes do not look at whether a prop can be picked.
  if (selector && (!volume->GetPickable() || !IsPassRead(selector)))
  {
    return;
  }
  // Else it is for a selector or an image.
  const bool shown = !selector && !this->RendersToImage;
  vtkInternals& in = *this->Internals;
  if (IsPeeled(renderer, volume))
  {
    // A frame has several passes.
    if (!in.ToldOfPeeling)
    {
      vtkErrorMacro("UseDepthPeelingForVolumes of the renderer is on, but only VTK's GPU mapper can be "
                    "peeled together with translucent surfaces: the volume is left out. Call "
                    "UseDepthPeelingForVolumesOff() of the renderer.");
    }
    in.ToldOfPeeling = true;
    return;
  }
  in.ToldOfPeeling = false;
  if (in.Refuse("Render()"))
  {
    return;
  }
  vtkRenderWindow* window = renderer->GetRenderWindow();
  vtkFFDFrame frame(in.Frame, this, renderer, volume, window);
  frame.SetReportsProgress(this->ReportProgress);
  in.Prepared = false;
  std::string message;
  if (!in.Prepare(volume, message) || !in.CheckView(renderer, volume, message))
  {
    if (!message.empty())
    {
      vtkErrorMacro(<< message);
    }
    return;
  }

  // A render pass may draw into a framebuffer of its own, but surfaces keep the aspect ratio.
  int viewport[4];
  vtkFFDImageDisplay::FindViewport(renderer, viewport);
  if (viewport[2] < 1 || viewport[3] < 1)
  {
    return;
  }
  vtkNew<vtkTimerLog> timer;
  timer->StartTimer();
  vtkFFDImageRegion whole(glm::ivec2(viewport[2], viewport[3]));
  whole.Aspect = renderer->GetTiledAspectRatio();
  whole.Stereo = true;
  vtkFFDImageRegion region = selector || shown ? in.FindRegion(renderer, volume, whole) : whole;
  if (selector)
  {
    unsigned int area[4];
    selector->GetArea(area);
    const glm::ivec2 corner(viewport[0], viewport[1]);
    const glm::ivec2 first = glm::max(glm::ivec2(area[0], area[1]) - corner, region.Origin);
    const glm::ivec2 last =
      glm::min(glm::ivec2(area[2], area[3]) - corner, region.Origin + region.Rays - 1);
    region.Origin = first;
    region.Rays = last - first + 1;
  }
  glm::ivec2 pixels = region.Rays;
  if (pixels.x < 1 || pixels.y < 1)
  {
    return;
  }
  const bool interactive = shown && this->AutoAdjustSampleDistances && in.IsMoving(volume);
  region.Step = shown ? this->ImageSampleDistance : 1.0;
  if (shown && this->AutoAdjustSampleDistances)
  {
    const double least = this->MinimumImageSampleDistance;
    region.Step = interactive
      ? in.FindStep(volume->GetAllocatedRenderTime(), pixels)
      : std::min(std::max(1.0, least), std::max(least, this->MaximumImageSampleDistance));
  }
  in.LastStep = interactive ? region.Step : 0.0;
  region.Rays = glm::max(glm::ivec2(1), glm::ivec2(glm::ceil(glm::dvec2(pixels) / region.Step)));
  if (shown && in.CanReuse(volume))
  {
    in.Coherence.Align(region);
    pixels = glm::min(glm::ivec2(glm::ceil(glm::dvec2(region.Rays) * region.Step)),
      region.Viewport - region.Origin);
  }

  const float* depths = nullptr;
  if (this->IntermixIntersectingGeometry)
  {
    const int rectangle[4] = { viewport[0] + region.Origin.x, viewport[1] + region.Origin.y,
      pixels.x, pixels.y };
    std::vector<float>& all = in.WindowDepths;
    all.resize(static_cast<std::size_t>(pixels.x) * static_cast<std::size_t>(pixels.y));
    const bool read = vtkFFDImageDisplay::ReadDepths(renderer, rectangle, all.data());
    // Where nothing opaque was drawn there is nothing to stop at.
    if (read && std::any_of(all.begin(), all.end(), [](float depth) { return depth < 1.0f; }))
    {
      if (region.Rays != pixels)
      {
        in.FindRayDepths(region, pixels);
      }
      depths = region.Rays != pixels ? in.RayDepths.data() : all.data();
    }
  }

  float* visibleDepths = nullptr;
  if (!shown)
  {
    in.VisibleDepths.resize(
      static_cast<std::size_t>(region.Rays.x) * static_cast<std::size_t>(region.Rays.y));
    visibleDepths = in.VisibleDepths.data();
  }
  vtkInternals::View view;
  view.Region = region;
  view.DataToNdc =
    ffd::MakeCameraView(renderer, whole).WorldToNdc * ffd::ToMatrix(volume->GetMatrix());
  if (in.Shown.Complete && !(shown && in.CanReuse(volume)))
  {
    in.Colours.swap(in.LastColours);
    in.Last = in.Shown;
  }
  in.Shown.Complete = false;
  const vtkMTimeType sceneTime = in.FindSceneTime(volume);
  const bool done =
    in.Cast(renderer, volume, region, depths, interactive, shown, visibleDepths);
  timer->StopTimer();
  if (!done && !(shown && in.Last.IsSameAs(view)))
  {
    return;
  }
  if (selector && !this->GetInput())
  {
    return; // an observer has taken it away
  }
  const ffd::CameraView camera =
    ffd::ToData(ffd::MakeCameraView(renderer, region), ffd::ToMatrix(volume->GetMatrix()));
  if (selector)
  {
    in.PaintIdentifiers(selector, camera, in.VisibleDepths);
  }
  else if (!shown)
  {
    if (this->ClampDepthToBackface)
    {
      in.MoveToBackface(camera, in.VisibleDepths);
    }
    WriteColours(in.Colours, region.Rays.x, region.Rays.y, true, in.ColourImage);
    in.ImageDepths = in.VisibleDepths;
    return;
  }
  if (shown)
  {
    this->TimeToDraw = timer->GetElapsedTime();
    if (done)
    {
      // Part of a picture tells the least that all of it would take.
      const double rays = static_cast<double>(region.Rays.x) * region.Rays.y;
      const double perRay = this->TimeToDraw / rays * (interactive ? 1.0 : 0.5);
      in.TimePerRay = in.ReusedFraction > 0.0 ? std::max(in.TimePerRay, perRay) : perRay;
      in.LastPixels = static_cast<double>(pixels.x) * pixels.y;
      view.Complete = true;
      in.Shown = view;
    }
    in.StillTime = in.FindStillTime(pixels, interactive);
  }
  // After an abort the last picture: the window may be read before the next frame is there.
  const std::vector<float>& colours = done ? in.Colours : in.LastColours;
  region = done ? region : in.Last.Region;
  vtkFFDImageDisplay::Layers layers;
  if (done && depths && region.Step > 1.0 && in.FindSceneTime(volume) == sceneTime)
  {
    layers = in.CastLayers(renderer, volume, region, pixels, interactive);
  }

  const glm::dvec2 perPixel = 2.0 / glm::dvec2(region.Viewport);
  const glm::dvec2 lower = glm::dvec2(region.Origin) * perPixel - 1.0;
  const glm::dvec2 upper = lower + glm::dvec2(region.Rays) * region.Step * perPixel;
  const double rectangle[4] = { lower.x, lower.y, upper.x, upper.y };
  if (!in.Display.Draw(renderer, region.Rays.x, region.Rays.y, colours.data(), layers, rectangle,
        region.Step == 1.0, in.MakeParallelFor()))
  {
    vtkErrorMacro(<< "The image could not be drawn: the render window is not an OpenGL window or "
                     "refused a texture of "
                  << region.Rays.x << " x " << region.Rays.y << ". Use RenderToImage() there.");
  }
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::RenderToImage(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkImageData* colours, vtkImageData* depths, vtkImageData* inputDepths)
{
  return vtkFFDGuarded(this, "RenderToImage", 0, [&] {
    return this->MakeImages(renderer, volume, width, height, colours, depths, inputDepths);
  });
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::MakeImages(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkImageData* colours, vtkImageData* depths, vtkImageData* inputDepths)
{
  if (!renderer || !volume || !colours)
  {
    vtkErrorMacro(<< "RenderToImage needs a renderer, a volume and an image for the colours; the "
                  << (!renderer ? "renderer" : (!volume ? "volume" : "image")) << " is null.");
    return 0;
  }
  if (width < 1 || height < 1 || width > LargestImageSide || height > LargestImageSide)
  {
    vtkErrorMacro(<< "RenderToImage: an image of " << width << " x " << height
                  << " pixels was asked for; each side must be from 1 to " << LargestImageSide
                  << ".");
    return 0;
  }
  vtkInternals& in = *this->Internals;
  if (in.Refuse("RenderToImage()"))
  {
    return 0;
  }
  std::string message;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const float* scene = nullptr;
  if (inputDepths)
  {
    int dims[3];
    inputDepths->GetDimensions(dims);
    if (dims[0] != width || dims[1] != height || dims[2] != 1 ||
      inputDepths->GetScalarType() != VTK_FLOAT ||
      inputDepths->GetNumberOfScalarComponents() != 1 ||
      !inputDepths->GetPointData()->GetScalars() ||
      inputDepths->GetPointData()->GetScalars()->GetNumberOfTuples() <
        static_cast<vtkIdType>(pixels))
    {
      vtkErrorMacro(<< "RenderToImage: the input depths must be one float a pixel, " << width
                    << " x " << height << " x 1; they are " << dims[0] << " x " << dims[1] << " x "
                    << dims[2] << ".");
      return 0;
    }
    scene = static_cast<const float*>(inputDepths->GetScalarPointer());
  }
  vtkFFDFrame frame(in.Frame, this, renderer, volume, nullptr);
  frame.SetReportsProgress(this->ReportProgress);
  in.Prepared = false;
  if (inputDepths)
  {
    frame.Hold({ inputDepths->GetPointData()->GetScalars() });
  }
  const vtkSmartPointer<vtkImageData> keptColours(colours);
  const vtkSmartPointer<vtkImageData> keptDepths(depths);
  if (!in.Prepare(volume, message) || !in.CheckView(renderer, volume, message))
  {
    if (!message.empty())
    {
      vtkErrorMacro(<< message);
    }
    return 0;
  }
  const vtkFFDImageRegion region(glm::ivec2(width, height));
  vtkFFDRequireMemory(BytesPerPixel * static_cast<double>(pixels),
    std::to_string(width) + " x " + std::to_string(height) + " pixels",
    "Give a smaller width and height.");
  in.Shown.Complete = false;
  const bool premultiplied = this->PremultipliedAlpha != 0; // observers may change it
  std::vector<float> firstVisible(depths ? pixels : 0);
  if (!in.Cast(renderer, volume, region, scene, false, false,
        depths ? firstVisible.data() : nullptr))
  {
    return 0;
  }

  WriteColours(in.Colours, width, height, premultiplied, colours);
  if (depths)
  {
    depths->SetExtent(0, width - 1, 0, height - 1, 0, 0);
    depths->AllocateScalars(VTK_FLOAT, 1);
    std::copy(firstVisible.begin(), firstVisible.end(),
      static_cast<float*>(depths->GetScalarPointer()));
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::TraceRays(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkIdTypeArray* pixels, vtkPolyData* rays, vtkPolyData* viewingRays,
  vtkPolyData* samples)
{
  return vtkFFDGuarded(this, "TraceRays", 0, [&] {
    return this->MakeRays(renderer, volume, width, height, pixels, rays, viewingRays, samples);
  });
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::MakeRays(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkIdTypeArray* pixels, vtkPolyData* rays, vtkPolyData* viewingRays,
  vtkPolyData* samples)
{
  if (!renderer || !volume || !pixels || !rays || pixels->GetNumberOfComponents() != 2)
  {
    vtkErrorMacro(<< "TraceRays needs a renderer, a volume, two numbers for each pixel and a "
                     "vtkPolyData for the rays; one of them is null.");
    return 0;
  }
  if (width < 1 || height < 1 || width > LargestImageSide || height > LargestImageSide)
  {
    vtkErrorMacro(<< "TraceRays: an image of " << width << " x " << height
                  << " pixels was asked for; each side must be from 1 to " << LargestImageSide
                  << ".");
    return 0;
  }
  vtkInternals& in = *this->Internals;
  if (in.Refuse("TraceRays()"))
  {
    return 0;
  }
  std::string message;
  if (this->GetInputAlgorithm())
  {
    this->GetInputAlgorithm()->UpdateWholeExtent();
  }
  if (in.Update(volume->GetProperty(), message))
  {
    in.CheckView(renderer, volume, message);
  }
  if (!message.empty())
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  const vtkFFDImageRegion region(glm::ivec2(width, height));
  const ffd::CastScene scene = in.MakeScene(renderer, volume, region, nullptr);
  const ffd::RayCaster caster(scene, in.MakeSettings(volume, scene.VoxelSize, false));
  ffd::CastImage image;
  image.Width = width;
  image.Height = height;
  ffd::RayCaster::Scratch scratch;
  vtkFFDTracedRays result(scene, rays, viewingRays, samples);
  ffd::TracedRay traced;
  for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i)
  {
    const vtkIdType x = pixels->GetTypedComponent(i, 0);
    const vtkIdType y = pixels->GetTypedComponent(i, 1);
    if (x < 0 || y < 0 || x >= width || y >= height)
    {
      vtkErrorMacro(<< "TraceRays: the image of " << width << " x " << height
                    << " pixels has no pixel (" << x << ", " << y << "); it is left out.");
      continue;
    }
    caster.TraceRay(static_cast<int>(x), static_cast<int>(y), image, scratch, traced);
    result.Add(traced, static_cast<int>(x), static_cast<int>(y));
  }
  result.Finish();
  return 1;
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
    this->SetSampleDistance(like->SampleDistance);
    this->SetInteractiveSampleDistance(like->InteractiveSampleDistance);
    this->SetLockSampleDistanceToInputSpacing(like->LockSampleDistanceToInputSpacing);
    this->SetImageSampleDistance(like->ImageSampleDistance);
    this->SetMinimumImageSampleDistance(like->MinimumImageSampleDistance);
    this->SetMaximumImageSampleDistance(like->MaximumImageSampleDistance);
    this->SetAutoAdjustSampleDistances(like->AutoAdjustSampleDistances);
    this->SetFrameCoherence(like->FrameCoherence);
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
    this->SetUseDepthPass(like->UseDepthPass);
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
  vtkGarbageCollectorReport(collector, this->Deformation, "Deformation");
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
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "InteractiveSampleDistance: " << this->InteractiveSampleDistance << "\n";
  os << indent
     << "LockSampleDistanceToInputSpacing: " << this->LockSampleDistanceToInputSpacing << "\n";
  os << indent << "ImageSampleDistance: " << this->ImageSampleDistance << "\n";
  os << indent << "MinimumImageSampleDistance: " << this->MinimumImageSampleDistance << "\n";
  os << indent << "MaximumImageSampleDistance: " << this->MaximumImageSampleDistance << "\n";
  os << indent << "AutoAdjustSampleDistances: " << this->AutoAdjustSampleDistances << "\n";
  os << indent << "FrameCoherence: " << this->FrameCoherence << "\n";
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
  os << indent << "UseDepthPass: " << this->UseDepthPass << "\n";
  os << indent << "MaskInput: " << this->MaskInput << "\n";
  os << indent << "MaskType: " << (this->MaskType == BinaryMaskType ? "Binary" : "LabelMap") << "\n";
  os << indent << "MaskBlendFactor: " << this->MaskBlendFactor << "\n";
  os << indent << "Transfer2DYAxisArray: "
     << (this->Transfer2DYAxisArray ? this->Transfer2DYAxisArray : "(none)") << "\n";
  os << indent << "VectorMode: " << this->GetVectorModeAsString() << "\n";
  os << indent << "VectorComponent: " << this->VectorComponent << "\n";
  os << indent << "ComputeNormalFromOpacity: " << this->GetComputeNormalFromOpacity() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "ReferenceKernels: " << this->ReferenceKernels << "\n";
  os << indent << "CollectStatistics: " << this->CollectStatistics << "\n";
  os << indent << "Statistics:\n";
  this->Internals->Statistics->PrintSelf(os, indent.GetNextIndent());
}
