// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketScene_h
#define FFDPacketScene_h

#include "FFDCastScene.h"
#include "FFDExport.h"
#include "FFDPacketField.h"
#include "FFDPacketGrid.h"
#include "FFDPacketMask.h"
#include "FFDPacketPlane.h"
#include "FFDPacketRays.h"
#include "FFDPacketTable.h"
#include "FFDPacketVolume.h"
#include "FFDParallelFor.h"
#include "FFDTileBounds.h"
#include "FFDTileSegment.h"
#include "FFDVisibleSpace.h"
#include "Optics/FFDOpticalFunctions.h"
#include "Reference/FFDRayIntegrator.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace ffd
{

/// A light for packets, in the space of Shading, relative to where that has PacketScene::Center;
/// its colors include the coefficients of the material.
struct PacketLight
{
  bool Positional = false;
  bool Cone = false;
  bool Attenuates = false;   ///< with the distance
  bool HasHighlight = false; ///< some of Specular is not zero
  bool IsGray = false;       ///< Diffuse and Specular have no hue
  float Position[3] = {};
  float Towards[3] = {};
  float Axis[3] = {};
  float Diffuse[3] = {};
  float Specular[3] = {};
  float Attenuation[3] = {};
  float ConeCosine = 0.0f;
  float ConeExponent = 0.0f;
};

/// The code that takes the samples of packets, by blend modes.
enum class PacketSampling
{
  Composite,
  Extreme, ///< Maximum, Minimum
  Sum,     ///< Average, Additive
  Surface, ///< Isosurface
  Slice
};

/// What composites of one component have besides a transfer function and light: a constant of their
/// loops, in which what is not used costs nothing.
enum class CompositeOptions
{
  None,
  GradientOpacity, ///< and nothing else
  Plane,           ///< a two-dimensional transfer function, and nothing else
  Any
};

/// A point of rest space and where T takes it, local coordinates.
struct PacketSeed
{
  float Point[3];
  float Image[3];
  float Inverse[9];  ///< of the Jacobian matrix of T there, row by row
  float Determinant; ///< of the Jacobian matrix
};

/// A material, and the lights on it in the space of Shading.
struct PacketSurface
{
  float SpecularPower = 1.0f;
  int WholeSpecularPower = -1; ///< that, or -1 where it is 0, no whole number or large
  /// Smaller cosines have the highlight of this one, next to nothing: their powers would be
  /// denormal numbers, which many processors take a hundred times as long for.
  float SmallestCosine = 0.0f;
  float Ambient[3] = {};           ///< of all lights
  PacketLight Headlights;          ///< the sums of their colors
  std::vector<PacketLight> Lights; ///< the others
};

/// A value, as fetched, whose isosurface is shown: Value less Excess, which is not negative and
/// smaller than what floats can tell.
struct PacketSurfaceValue
{
  float Value;
  float Excess;
  float Color[3];
  float Opacity;
};

/// Factors of the opacity over PacketScene::OpacityLength, by the length of Scale times the
/// gradient as fetched.
struct PacketGradientOpacity
{
  const float* Factors = nullptr; ///< null: there are none
  int Size = 0;
  PiecewiseOptics Pieces; ///< the same as straight lines
  float Scale[3] = {};
  float ZeroUpTo = 0.0f; ///< factors are zero up to this squared length, unless it is 0
};

/// Values between these, as fetched, may be visible, no others. Without space leaping all are
/// looked up.
struct ValueRange
{
  float Low = -std::numeric_limits<float>::infinity();
  float High = std::numeric_limits<float>::infinity();
};

/// Optical properties of one of several components; its transfer table has the same number.
struct PacketComponent
{
  PacketGradientOpacity Gradients;
  PacketPlane Plane;   ///< in the place of the table and of Gradients
  float Weight = 1.0f; ///< of its opacity
  bool ByTable = true; ///< whether its table alone tells what is transparent
  ValueRange Visible;
  PacketSurface Surface;
};

/// An IntervalTable in the form that packet kernels read: a load of 128 bits gives all of an entry.
struct PacketIntegrals
{
  struct Entry
  {
    std::uint32_t Words[4]; ///< extinction and its change to the next entry, floats; the integral
  };
  std::vector<Entry> Entries;
  float Units = 1.0f;
  float Margin = 0.0f;     ///< TransferTable::GetMargin()
  float VisibleLow = 0.0f; ///< as fetched
  float VisibleHigh = 0.0f;
};

/// A channel of a blend mode that does not composite: an independent component, or all dependent
/// ones together.
struct PacketChannel
{
  /// As fetched (PacketVolume): the ends of the range of what is blended.
  float Low = 0.0f;
  float High = 1.0f;
  float AverageMin = 0.0f;
  float AverageMax = 0.0f;
  float Weight = 1.0f;
  float AdditiveDistance = 1.0f; ///< of Blending
  int Component = 0;             ///< that the range is of
};

/// Bounds of the values of a channel, in whose codes extremes are compared with them.
struct PacketPeaks
{
  const ValuePeaks* Values = nullptr;
  /// Extremes, as fetched times the sign of ValuePeaks, less Low and times Scale are codes. Low
  /// stands for -1: none.
  double Low = 0.0;
  double Scale = 0.0;
  double High = 0.0; ///< the largest value
};

/**
 * A frame in the form the packet kernels read: single precision, positions relative to a point
 * near the volume ("local" coordinates: data coordinates less Center).
 */
struct PacketScene
{
  std::uint64_t Number = 0; ///< no other scene has it, nor had it before
  CastSettings Settings;
  const CastScene* Source = nullptr;
  PacketSampling Sampling = PacketSampling::Composite;

  PacketVolume Volume;
  PacketGrid Grid;
  bool HidesSamples = false; ///< whether there is a binary mask, or a hidden cell
  float Lower = 0.0f;        ///< the box that holds all samples, index coordinates
  float Upper[3] = {};

  bool Identity = false;
  PullBackKind Kind = PullBackKind::Exact;
  PacketField Field;
  static constexpr int SeedsPerAxis = 7; ///< of the volume
  /// In vectors of 16.
  static constexpr std::size_t LargestNumberOfSeeds =
    (SeedsPerAxis * SeedsPerAxis * SeedsPerAxis + 15) / 16 * 16;
  std::vector<PacketSeed> Seeds; ///< over the volume, where Newton's method starts from nowhere
  /// Image of the seeds by component, and of more that are far away, to whole vectors.
  std::array<std::vector<float>, 3> SeedImages;
  bool Folds = false;       ///< whether T is known to turn parts of the volume inside out, or flat
  float Orientation = 1.0f; ///< sign of the determinant of T where it does not
  float Nowhere = 0.0f;     ///< local coordinates, beyond all others, of points without a pull-back
  float Tolerance = 0.0f;   ///< of the inverse at samples, data units
  float NodeTolerance = 0.0f; ///< the same at nodes of interpolants
  glm::dvec3 Center{ 0.0 };   ///< FindMiddle(), data coordinates
  float LocalToIndex[9] = {};
  float IndexOffset[3] = {}; ///< of local to index coordinates of the whole
  float IndexShift[3] = {};  ///< of the voxels here in those, whole numbers
  float RestMin[3] = {};     ///< FindRestBox(), index coordinates before the shift
  float RestMax[3] = {};
  float IndexToLocal[9] = {};
  float GradientToRest[9] = {};        ///< by index coordinates to by data coordinates
  float LocalToLights[9] = {};         ///< to the space of Shading
  float GradientToLights[9] = {};      ///< by data coordinates to by those of that space, scaled
  float IndexGradientToLights[9] = {}; ///< the same by index coordinates, undeformed

  PacketRays Rays;
  float BoundsMin[3] = {}; ///< deformed bounds, local
  float BoundsMax[3] = {};
  std::vector<std::array<float, 4>> ClippingPlanes; ///< local, see CastScene
  Cropping::Spaces CropSpace = Cropping::Spaces::None;
  float CropLow[3] = {}; ///< index coordinates or local ones
  float CropHigh[3] = {};
  int CropFlags = 0;
  bool Intervals = false; ///< Blending::UsesIntervals()
  CompositeOptions Options = CompositeOptions::Any;
  bool Inner = false; ///< compositing of one component: the samples of a part have a loop
  bool InnerComponents =
    false; ///< the same of two components, or of four dependent ones, in reach of offsets
  bool InnerBlending = false; ///< the same of extremes, sums and surfaces
  bool InnerChannels = false; ///< the same of extremes of two or four components
  /// Values that blend modes compare samples with, as fetched (PacketVolume).
  float ValueLow = 0.0f; ///< ends of their range
  float ValueHigh = 1.0f;
  /// Rays end when their extreme reaches this, a value times the sign of ValuePeaks: no larger one
  /// exists, or it would not change the picture.
  float LastExtreme = std::numeric_limits<float>::infinity();
  std::vector<PacketPeaks> Peaks; ///< of the channels of extremes, with space leaping; else empty
  float AverageMin = 0.0f;
  float AverageMax = 0.0f;
  std::vector<PacketSurfaceValue> IsoValues; ///< ascending; visible ones
  bool Slices =
    false; ///< rays take a sample where dot(SliceNormal, local) is SliceOffset, no other
  float SliceNormal[3] = {};
  float SliceOffset = 0.0f;
  bool Parallel = false;
  float Eye[3] = {}; ///< in the space of the lights

  float PositionTolerance = 0.1f; ///< of interpolants, voxels
  float VoxelsPerUnit = 1.0f;     ///< lengths in data units to lengths in voxels
  float ShortestSegment = 0.5f;   ///< voxels
  int SamplesPerRoot = 1;         ///< of the longest segments
  /// Longer segments cross many cells of the lattice, voxels: whatever halving them has gained, it
  /// will gain more when they cross few.
  float LongestPlain = std::numeric_limits<float>::infinity();
  int RootSide = TileSide; ///< pixels along each side of these, at least of a tile
  int SamplesPerPart = 1;  ///< of a segment, that are tested for emptiness together, at least
  TileBounds Seen;         ///< of what may be visible, local coordinates
  /// The same wherever it is, local coordinates; null where T is known to be one to one.
  std::shared_ptr<VisibleSpaceOnDemand> Space;
  std::shared_ptr<VolumeSpace> WholeSpace; ///< likewise
  bool LeapsSegments = false;              ///< whether segments are tested for emptiness as a whole
  const unsigned char* Distances = nullptr;
  int Blocks[3] = {};
  float LastBlock[3] = {};

  PacketTable Table; ///< and behind it those of the labels
  PacketMask Mask;
  ValueRange Visible; ///< of one component

  /// Whether intervals that end at samples are classified, not samples: they are empty only if
  /// their beginnings are, too.
  bool ClassifiesIntervals = false;
  PacketIntegrals Integrals;

  PacketPlane Plane;               ///< in the place of the first table
  PacketGradientOpacity Gradients; ///< of the first component, unless labels have theirs
  bool OpacityByGradient = false;  ///< whether extinctions depend on gradients
  float OpacityLength = 1.0f;      ///< over which opacities of composited samples are
  bool OpacityIsInterval = false;  ///< whether samples stand for intervals of that length
  bool ByExtinctions = false; ///< whether composited samples are those of one table, over intervals
                              ///< of many lengths

  /// Several components; else there are none here.
  ComponentKind KindOfComponents = ComponentKind::Independent;
  std::vector<PacketComponent> Components; ///< independent ones, or all dependent ones as one
  float ColorScale = 1.0f;                 ///< takes values that are colors to [0, 1]
  std::size_t ColorTable = 0;              ///< of ColorOpacity: number of the table of colors,
  PacketPlane ColorPlane;                  ///< or the plane, over values of the first component
  std::vector<PacketChannel> Channels;     ///< where they are not composited

  bool Shade = false;
  bool NormalsOfOpacity = false; ///< where something is shaded
  /// Whether the squares of gradients that are multiplied by GradientToLights may be beyond single
  /// precision.
  bool FarGradients = false;
  /// Whether gradients take ClippedValues, by component and as fetched, for values behind clipping
  /// planes.
  bool ClipsGradients = false;
  float ClippedValues[Blending::LargestNumberOfComponents] = {};
  bool TwoSided = true;
  PacketSurface Surface; ///< of the first component
};

/// Makes a scene, but for what FillTable(), SetSeen() and SetPullBack() add. `scene` and `frame`
/// must outlive it.
PacketScene MakePacketScene(
  const CastScene& scene, const CastSettings& settings, const IntegrationFrame& frame);

/// Sets what samples look up in PacketScene::Table.
void FillTable(PacketScene& p);

/// Sets what may be visible of each tile.
void SetSeen(const ParallelFor& parallelFor, PacketScene& p);

/// Sets the field of the pull-back, its tolerances, and the points of its seeds.
void SetPullBack(PacketScene& p);

/// Sets PacketScene::Space and WholeSpace, after SetPullBack().
void SetSpace(PacketScene& p);

/// Keeps the seeds where T has the orientation that it has at most of them, and does not press the
/// volume flat, lists their images, and tells whether there are others (PacketScene::Folds).
FFD_RENDERING_EXPORT void KeepSeeds(PacketScene& p);

} // namespace ffd

#endif
