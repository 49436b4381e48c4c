// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCastScene_h
#define FFDCastScene_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDCameraView.h"
#include "FFDCropping.h"
#include "FFDDistanceMap.h"
#include "FFDExport.h"
#include "FFDMinMaxBlocks.h"
#include "FFDPolyline.h"
#include "FFDPullBack.h"
#include "FFDSampling.h"
#include "FFDTransferTable.h"
#include "FFDValuePeaks.h"
#include "FFDVolumeView.h"
#include "Optics/FFDBlending.h"
#include "Optics/FFDShading.h"

#include <glm/vec4.hpp>

#include <chrono>
#include <cstdint>
#include <vector>

namespace ffd
{

/// The method that cuts deformed rays into segments.
enum class Segmentation
{
  ErrorBound, ///< interpolants shared by the rays of a tile, position error measured (TileSegment)
  GreedyAngle ///< the paper's polyline, section 4.5 (PolylineWalker)
};

/// The method by which rays leap over empty space.
enum class SpaceLeaping
{
  Off,
  Segment,  ///< within the current segment, as section 4.6 of the paper
  Lipschitz ///< across segments, by bounds of the motion of the deformed ray
};

/// The length that opacities are corrected by.
enum class OpacityLength
{
  Deformed, ///< of the interval on the viewing ray: the image equals that of a resampled volume
  Material  ///< of the interval in rest space, as the paper
};

/// Classification by samples or by the intervals between them.
enum class Classification
{
  Samples,  ///< the samples, each by itself
  Intervals ///< the intervals between them, as IntervalTable
};

class FieldCache;
class FunctionCache;
class SampleClassifier;
class SpaceCache;

/// Parameters of ERROR_BOUND.
struct ErrorBoundSettings
{
  double LongestSegment = 64.0;   ///< data units of the viewing ray
  double ShortestSegment = 0.5;   ///< data units of the viewing ray
  double PositionTolerance = 0.1; ///< voxels
};

struct CastSettings
{
  Segmentation Segments = Segmentation::ErrorBound;
  SpaceLeaping Leaping = SpaceLeaping::Lipschitz;
  OpacityLength Opacity = OpacityLength::Deformed;
  Classification Classify = Classification::Samples; ///< if CanClassifyIntervals()
  PolylineSettings Polyline;
  ErrorBoundSettings ErrorBound;
  double SampleDistance = 1.0;        ///< data units, along the viewing ray
  float TerminationTransmittance = 0; ///< a ray ends when less than this passes it
  bool Shade = false;
  bool Jitter = false;    ///< samples are moved on by FindJitter(); not those of isosurfaces
  bool CountsRays = true; ///< CastStatistics::Rays holds those, too, that meet nothing visible
  bool Reference = false; ///< use the reference kernels even where packets could render
  /// Bytes that offsets of voxels may lead over, at most; less than what 32 bits hold for tests.
  double LargestReach = 2147483647.0;
};

/// When work on a tile stops, to be gone on with later.
using Deadline = std::chrono::steady_clock::time_point;
constexpr Deadline NoDeadline = Deadline::max();

/// Counts of one image; the measures of section 5 of the paper.
struct CastStatistics
{
  std::int64_t Rays = 0;           ///< that meet the deformed bounds
  std::int64_t Segments = 0;       ///< segments of deformed rays that were sampled
  double SegmentLength = 0.0;      ///< their length on the viewing rays, voxels
  std::int64_t Samples = 0;        ///< interpolated scalars
  std::int64_t VisibleSamples = 0; ///< of them not fully transparent
  std::int64_t DistanceLookups = 0;
  std::int64_t Evaluations = 0; ///< of the deformation
  std::int64_t Unconverged = 0; ///< points where the inverse did not converge

  FFD_RENDERING_EXPORT void Add(const CastStatistics& other);
};

/// Everything a frame is rendered from: plain views, all of them outlive the ray caster's calls.
/// All of it is in data coordinates: viewing rays, planes and bounds in deformed space, voxels at
/// rest. Directions to lights are those of the world, see Shading.
struct CastScene
{
  VolumeView Volume;
  Interpolation VolumeInterpolation = Interpolation::Linear;
  const TransferTable* Table = nullptr;
  FunctionCache* KeptOfFunctions = nullptr; ///< of Table and those of Classifier, kept from frame
                                            ///< to frame; or null
  const SampleClassifier* Classifier = nullptr; ///< null: one component by Table and Material
  const DistanceMap* Distances = nullptr;       ///< may be null when Leaping is Off
  SpaceCache* KeptOfSpace = nullptr;            ///< of Distances, kept from frame to frame; or null
  /// Of the scalars of each component of Volume, and MinMaxBlocks::GetCommonRange() of these; null:
  /// not known.
  const std::vector<MinMaxBlocks::Limits>* Ranges = nullptr;
  const std::vector<MinMaxBlocks::Limits>* CommonRanges = nullptr;
  /// Of the channels of Maximum and Minimum, or null.
  const std::vector<ValuePeaks>* Peaks = nullptr;
  const PullBack* Map = nullptr;
  PullBackLimits Limits;             ///< of Map
  FieldCache* KeptOfField = nullptr; ///< of the field of Map, kept from frame to frame; or null
  Box DeformedBounds;                ///< data coordinates; rays are cut to them
  /// Bounds of the whole volume, at rest and deformed, if Volume and DeformedBounds are parts of
  /// one; null otherwise. They make rounding and iterations the same in all parts.
  const Box* WholeAtRest = nullptr;
  const Box* WholeDeformed = nullptr;
  Blending Blend;
  Cropping Crop;
  std::vector<glm::dvec4> ClippingPlanes; ///< shown is where dot(plane, (P, 1)) >= 0
  Shading Material;
  CameraView Camera;
  const float* Depths = nullptr; ///< window depths of what is already drawn, one per pixel, or null
  double VoxelSize = 1.0;        ///< length of the shortest voxel edge, data units
};

/// The box that the volume, or the whole that it is a part of, takes up when it is deformed.
const Box& GetWholeDeformed(const CastScene& scene);

/// The middle of the volume, or of the whole, data coordinates: at rest, so that it stays where it
/// is when the deformation is edited, unless that moves the volume away from it.
FFD_RENDERING_EXPORT glm::dvec3 FindMiddle(const CastScene& scene);

/// Image to render into, rows bottom up, premultiplied RGBA and window depth of the first visible
/// sample (1 where there is none); `Depths` may be null. `Reaches`, which may be null, has an entry
/// for each subtile of the image, x fastest: the t beyond which no ray of the subtile has been
/// followed, infinite if a ray goes on to its end or the reach is not known.
struct CastImage
{
  int Width = 0;
  int Height = 0;
  float* Colors = nullptr;
  float* Depths = nullptr;
  float* Reaches = nullptr;

  /// `Colors` may be those of a part of the image: they begin with this pixel, and have so many
  /// pixels in a row; 0: as many as the image.
  glm::ivec2 FirstColor{ 0 };
  int ColorsInRow = 0;

  int GetColorsInRow() const { return this->ColorsInRow > 0 ? this->ColorsInRow : this->Width; }

  /// The color of a pixel.
  float* GetColor(int x, int y) const
  {
    return this->Colors +
      4 *
      (static_cast<std::ptrdiff_t>(y - this->FirstColor.y) * this->GetColorsInRow() +
        (x - this->FirstColor.x));
  }
};

} // namespace ffd

#endif
