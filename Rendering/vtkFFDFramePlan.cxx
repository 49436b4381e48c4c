// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFramePlan.h"

#include "vtkFFDFrameCache.h"
#include "vtkFFDFrameScene.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDViewFromRenderer.h"

#include "FFDRayCaster.h"

#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Longest segment when the curvature bound sets the length, voxels.
constexpr double LongestAutomaticSegment = 64.0;

/// Longest segment that can be asked for, and longest minimum, voxels: beyond, a ray would have
/// none.
constexpr double LongestSegment = 1e4;
constexpr double LongestMinimum = 64.0;

/// Longest segment of ERROR_BOUND, voxels.
constexpr double LongestInterpolant = 64.0;

/// Part of the time of a moving frame in which its picture is made; drawing that takes the rest.
constexpr double PartOfPicture = 0.8;

/// The rays may always take these parts of the time of the preparation, and of the fixed time of
/// the picture, which is only inferred.
constexpr double PartOfPreparation = 0.25;
constexpr double PartOfFixedTime = 0.1;

/// Time of a ray for each pixel, as a part of the fixed time, at least: no ray takes no time.
constexpr double LeastPartOfRays = 0.01;

/// Time of a moving frame as a part of that of a still one, whose samples are closer: before the
/// first one.
constexpr double PartOfStillTime = 0.5;

/// The image sample distance falls by no more than this from frame to frame: how much longer a
/// frame with many more rays takes is uncertain.
constexpr double LargestRefinement = 0.5;

/// Standard deviations, as parts of the times: of both parts at first and at most, of their changes
/// from frame to frame, and of the measured time. The fixed part changes less: a scene whose rays
/// take longer and longer, and are cast farther and farther apart, is not to look like one in which
/// they do not matter.
constexpr double LargestDeviation = 0.3;
constexpr double ChangeOfFixedTime = 0.03;
constexpr double ChangeOfTimeOfRays = 0.1;
constexpr double MeasurementNoise = 0.1;

/// The part of the variances that the next frame starts from: they stay finite where the step does.
constexpr double KeptVariance = 0.95;

/// The image sample distance stays as it is between these parts of the one that is wanted, and is
/// rounded up to so many steps a pixel: then tiles lie on whole pixels.
constexpr double LeastOfWanted = 0.97;
constexpr double MostOfWanted = 1.25;
constexpr double StepsPerPixel = 8.0;

/// Shortest segment and sample distance, voxels: below, an image would take for ever.
constexpr double ShortestLength = 1e-3;

double Square(double x) { return x * x; }

} // namespace

//------------------------------------------------------------------------------
ffd::CastSettings vtkFFDFramePlan::MakeSettings(vtkFFDInverseRayVolumeMapper* mapper,
  const vtkFFDFrameCache& cache, vtkVolume* volume, bool interactive, double step)
{
  const double voxelSize = cache.GetVoxelSize();
  ffd::CastSettings settings;
  settings.Segments = mapper->GetSegmentation() == vtkFFDInverseRayVolumeMapper::GREEDY_ANGLE
    ? ffd::Segmentation::GreedyAngle
    : ffd::Segmentation::ErrorBound;
  settings.Leaping = !cache.GetDistances() ? ffd::SpaceLeaping::Off
    : mapper->GetSpaceLeaping() == vtkFFDInverseRayVolumeMapper::SEGMENT
    ? ffd::SpaceLeaping::Segment
    : ffd::SpaceLeaping::Lipschitz;
  settings.Opacity = mapper->GetOpacityLength() == vtkFFDInverseRayVolumeMapper::WORLD
    ? ffd::OpacityLength::Deformed
    : ffd::OpacityLength::Material;
  settings.TerminationTransmittance = static_cast<float>(mapper->GetEarlyRayTerminationThreshold());
  settings.CountsRays = mapper->GetCollectStatistics() != 0;
  settings.Reference = mapper->GetReferenceKernels() != 0;
  settings.Shade = volume->GetProperty()->GetShade(0) != 0;
  settings.Jitter = mapper->GetUseJittering() != 0;
  settings.SampleDistance =
    std::max(mapper->FindSampleDistance(voxelSize, interactive), ShortestLength * voxelSize);

  // A process that has a part of the volume may lack what is before it on its rays.
  const int classification = mapper->GetClassification();
  const ffd::TransferTable& table = cache.GetFunctions().Components[0].Table;
  if (!mapper->HasClipBox &&
    (classification == vtkFFDInverseRayVolumeMapper::PRE_INTEGRATED ||
      (classification == vtkFFDInverseRayVolumeMapper::AUTO &&
        ffd::IsSteep(table, settings.SampleDistance))))
  {
    settings.Classify = ffd::Classification::Intervals;
  }

  const double angle = vtkMath::RadiansFromDegrees(mapper->GetAngleThreshold());
  const double shortest =
    std::clamp(mapper->GetMinimumSegmentLength(), ShortestLength, LongestMinimum);
  double longest = std::min(mapper->GetMaximumSegmentLength(), LongestSegment);
  if (longest == 0.0)
  {
    longest = LongestAutomaticSegment;
    const ffd::BoundedPullBack& map = cache.GetPullBack();
    const double rate = settings.Segments == ffd::Segmentation::GreedyAngle
      ? map.Bounds.FindLargestTurnRate(
          ffd::InvertsTheField(map.Map.GetKind()) ? map.RestBounds : map.DeformedBounds)
      : 0.0;
    if (rate > 0.0)
    {
      // The rate is per data unit; so is the shortest edge of a voxel.
      longest = std::min(longest, angle / (rate * voxelSize));
    }
  }
  const double longestInterpolant = mapper->GetMaximumSegmentLength() == 0.0
    ? LongestInterpolant
    : std::min(longest, LongestInterpolant);
  longest = std::max(longest, shortest);
  settings.Polyline.AngleThreshold = angle;
  settings.Polyline.MinimumLength = shortest * voxelSize;
  settings.Polyline.MaximumLength = longest * voxelSize;
  settings.ErrorBound.LongestSegment = std::max(longestInterpolant, shortest) * voxelSize;
  settings.ErrorBound.ShortestSegment = shortest * voxelSize;
  // Where rays are some pixels apart nobody sees errors of less than a pixel.
  settings.ErrorBound.PositionTolerance =
    (interactive ? std::max(1.0, step) : 1.0) * mapper->GetPositionTolerance();
  return settings;
}

//------------------------------------------------------------------------------
vtkFFDImageRegion vtkFFDFramePlan::FindRegion(
  const ffd::Box& visible, vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& whole)
{
  vtkFFDImageRegion region = whole;
  region.Rays = glm::ivec2(0);
  if (glm::any(glm::lessThanEqual(visible.Max, visible.Min)))
  {
    return region;
  }
  const glm::dmat4 toNdc =
    ffd::MakeCameraView(renderer, whole, ffd::ToMatrix(volume->GetMatrix())).DataToNdc;
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
  // Rays of tiles share evaluations: with the same groups of tiles a picture is the same in a
  // window, as an image, and in the boxes of several processes, whatever part of the viewport it
  // covers.
  region.Origin = glm::ivec2(first);
  region.Origin -= region.Origin % ffd::RayCaster::GroupSize;
  region.Rays = glm::ivec2(last) - region.Origin;
  return region;
}

//------------------------------------------------------------------------------
/// As VTK's ray casters: a second or more is time for a still picture.
bool vtkFFDFramePlan::IsMoving(vtkFFDInverseRayVolumeMapper* mapper, vtkVolume* volume)
{
  return volume->GetAllocatedRenderTime() < 1.0 / mapper->GetInteractiveUpdateRate();
}

//------------------------------------------------------------------------------
double vtkFFDFramePlan::FindDistance(double seconds) const
{
  const double least = PartOfPreparation * this->Preparation + PartOfFixedTime * this->FixedTime;
  const double left =
    std::max(seconds - this->Preparation - this->FixedTime, std::min(seconds, least));
  return this->TimeOfRays > 0.0 ? std::sqrt(this->TimeOfRays / left) : 0.0;
}

//------------------------------------------------------------------------------
double vtkFFDFramePlan::FindStep(vtkFFDInverseRayVolumeMapper* mapper, double allotted) const
{
  const double least = mapper->GetMinimumImageSampleDistance();
  const double most = std::max(least, mapper->GetMaximumImageSampleDistance());
  const double wanted =
    std::clamp(std::max(allotted > 0.0 ? this->FindDistance(PartOfPicture * allotted) : 1.0,
                 LargestRefinement * this->LastStep),
      least, most);
  // Frames of another distance have nothing in common with the last one.
  if (this->LastStep >= least && this->LastStep <= most &&
    this->LastStep >= LeastOfWanted * wanted && this->LastStep <= MostOfWanted * wanted)
  {
    return this->LastStep;
  }
  return std::min(most, std::ceil(wanted * StepsPerPixel) / StepsPerPixel);
}

//------------------------------------------------------------------------------
bool vtkFFDFramePlan::PlaceRays(
  vtkFFDInverseRayVolumeMapper* mapper, vtkVolume* volume, bool shown, vtkFFDImageRegion& region)
{
  const glm::ivec2 pixels = region.Rays;
  const bool interactive =
    shown && mapper->GetAutoAdjustSampleDistances() && IsMoving(mapper, volume);
  region.Step = shown ? mapper->GetImageSampleDistance() : 1.0;
  this->Pixels = shown ? static_cast<double>(pixels.x) * pixels.y : this->Pixels;
  if (shown && mapper->GetAutoAdjustSampleDistances())
  {
    region.Step = interactive ? this->FindStep(mapper, volume->GetAllocatedRenderTime())
                              : mapper->GetMinimumImageSampleDistance();
  }
  this->LastStep = interactive ? region.Step : 0.0;
  region.Rays = glm::max(glm::ivec2(1), glm::ivec2(glm::ceil(glm::dvec2(pixels) / region.Step)));
  return interactive;
}

//------------------------------------------------------------------------------
void vtkFFDFramePlan::RecordFrame(
  vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache, const Frame& frame)
{
  if (frame.CastPart >= 1.0)
  {
    this->RecordTimes(frame);
  }
  this->RecordStillTime(mapper, cache, frame);
}

//------------------------------------------------------------------------------
/// A Kalman filter whose state is the two parts of the time of a picture. Frames with other numbers
/// of rays tell the parts from each other.
void vtkFFDFramePlan::RecordTimes(const Frame& frame)
{
  this->Preparation = frame.Preparation;
  const double rays = 1.0 / (frame.Step * frame.Step); // as a part of one for each pixel
  const double ofRays = std::max(0.0, frame.Picture - this->FixedTime);
  const double measured =
    frame.Interactive ? frame.Picture : this->FixedTime + PartOfStillTime * ofRays;
  std::array<double, 3>& p = this->Covariance;
  if (!this->HasTimeEstimate())
  {
    this->TimeOfRays = measured / rays;
    p = { Square(LargestDeviation * measured), 0.0, Square(LargestDeviation * this->TimeOfRays) };
    this->TimedPixels = this->Pixels;
  }
  const double morePixels = this->Pixels / this->TimedPixels;
  this->TimedPixels = this->Pixels;
  this->TimeOfRays *= morePixels;
  const double expected = this->FixedTime + rays * this->TimeOfRays;
  double excess = measured - expected;
  if (frame.ReusedFraction > 0.0 && excess < 0.0)
  {
    // Part of a picture tells the least that all of it would take.
    return;
  }
  if (frame.Interactive)
  {
    // One long frame may have waited for something else; a second one has not.
    const double before = std::max(0.0, std::exchange(this->LastExcess, excess));
    excess = std::min(excess, before);
  }
  p[0] = KeptVariance * p[0] + Square(ChangeOfFixedTime * expected);
  p[1] = KeptVariance * p[1] * morePixels;
  p[2] = KeptVariance * p[2] * Square(morePixels) +
    Square(ChangeOfTimeOfRays * (this->FixedTime + this->TimeOfRays));
  const double withFixed = p[0] + rays * p[1];
  const double withRays = p[1] + rays * p[2];
  const double noise = Square(MeasurementNoise * expected);
  const double variance = withFixed + rays * withRays;
  if (!(variance > 0.0))
  {
    return;
  }
  // A time that is far from the expected one shows that less was known than was thought.
  const double less = std::max(1.0, Square(excess) / (variance + noise));
  const double gain = less / (less * variance + noise);
  this->FixedTime = std::max(0.0, this->FixedTime + excess * gain * withFixed);
  this->TimeOfRays =
    std::max(LeastPartOfRays * this->FixedTime, this->TimeOfRays + excess * gain * withRays);
  p[0] = less * (p[0] - gain * withFixed * withFixed);
  p[1] = less * (p[1] - gain * withFixed * withRays);
  p[2] = less * (p[2] - gain * withRays * withRays);
  const double largest = Square(LargestDeviation * (this->FixedTime + this->TimeOfRays));
  const double kept = std::min(1.0, largest / std::max(p[0], p[2]));
  for (double& element : p)
  {
    element *= kept;
  }
}

//------------------------------------------------------------------------------
/// A still frame of the same scene needs no other preparation: that is not counted.
void vtkFFDFramePlan::RecordStillTime(
  vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache, const Frame& frame)
{
  if (!frame.Interactive)
  {
    // The time of an aborted frame is extrapolated from the part that was cast.
    const double time = frame.CastPart > 0.0 ? frame.Picture / frame.CastPart : this->StillTime;
    this->StillTime = frame.ReusedFraction > 0.0 ? std::max(this->StillTime, time) : time;
    return;
  }
  const double voxelSize = cache.GetVoxelSize();
  const double samples =
    mapper->FindSampleDistance(voxelSize, true) / mapper->FindSampleDistance(voxelSize, false);
  const double step = mapper->GetMinimumImageSampleDistance();
  this->StillTime = this->FixedTime + this->TimeOfRays * std::max(1.0, samples) / (step * step);
}
