// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketScene.h"

#include "FFDFieldCache.h"
#include "FFDFunctionCache.h"
#include "FFDPacketOptics.h"
#include "FFDRounding.h"
#include "FFDSamplePhase.h"
#include "FFDSingleArrays.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace ffd
{
namespace
{

/// Length of the parts of a segment that are tested for emptiness, voxels.
constexpr double PartLength = 2.0;
/// The length of roots of the smallest volumes, voxels.
constexpr double LeastRoot = 4.0;

/// Cells of the lattice in PacketScene::LongestPlain.
constexpr double CellsInSegment = 3.0;

/// How far D goes on linearly beyond a lattice that is one to one, voxels, and for how many cells
/// beyond others.
constexpr double LinearReach = 64.0;
constexpr int CellsOfUnknown = 4;

/// Where a flat lattice, as of a plate, has cells of which so many make up that reach, more is done
/// to know for how many.
constexpr int ShortCells = 6;
/// Control points of larger ones, of which PullBackLimits::LinearCells tells.
constexpr std::size_t LargestFlatLattice = 2000;

/// Cells of a field that reach as far along each axis, data units.
glm::ivec3 FindCellsOfReach(const BSplineField& field, double reach)
{
  return glm::ivec3(glm::min(glm::ceil(reach / glm::abs(field.GetSpacing())), 1e6));
}

/// For how many cells beyond the lattice, of a T that is one to one, D goes on linearly.
glm::ivec3 FindLinearCells(const CastScene& scene, FieldCache& cache)
{
  const BSplineField& field = *scene.Map->GetField();
  const glm::ivec3 reach = FindCellsOfReach(field, LinearReach * scene.VoxelSize);
  const int longest = std::max({ reach.x, reach.y, reach.z });
  const bool isFlat =
    longest >= ShortCells && longest > 2 * std::min({ reach.x, reach.y, reach.z });
  if (isFlat && GridSize(field.GetNodes()) <= LargestFlatLattice)
  {
    return cache.FindProvenCells(field, reach);
  }
  return glm::ivec3(std::min(scene.Limits.LinearCells, longest));
}

/// Tolerance of nodes, as a part of that of positions.
constexpr double NodeTolerance = 0.1;

/// The error of positions in single precision, relative to their size.
constexpr double SinglePrecision = 4e-7;

/// Determinants of the Jacobian that are smaller, by the largest one, are those of where T presses
/// the volume flat: rounding decides about their signs.
constexpr float SmallestDeterminant = 1e-4f;

/// Types whose values single precision does not hold.
bool IsWide(ScalarType type) { return SizeOf(type) > 2 && type != ScalarType::Float32; }

/// Whether single precision may not hold what Shift and Scale make of scalars of these ranges.
bool MayOverflow(const std::vector<MinMaxBlocks::Limits>& ranges, const PacketVolume& v)
{
  const auto isLarge = [](double value) { return !(std::abs(value) <= LargestSingle); };
  for (int c = 0; c < v.Components; ++c)
  {
    const MinMaxBlocks::Limits& range = ranges[static_cast<std::size_t>(c)];
    if (isLarge((range.Min - v.Shift[c]) * v.Scale[c]) ||
      isLarge((range.Max - v.Shift[c]) * v.Scale[c]))
    {
      return true;
    }
  }
  return false;
}

/// Where values are near to zero: at the first of a table or, where a table begins far from all
/// values but one, which stands for no data, at the end of the others.
double FindShift(const TransferTable& table, const MinMaxBlocks::Limits& common)
{
  const double low = table.GetLow();
  const double width = common.Max - common.Min;
  return low < common.Min - width ? common.Min : low > common.Max + width ? common.Max : low;
}

/// Lets packets read integers of 32 bits as such where the ranges of all components allow it. Shift
/// and Scale are known.
void SetWords(const std::vector<MinMaxBlocks::Limits>& ranges, PacketVolume& v)
{
  if (v.ElementSize != 4)
  {
    return;
  }
  for (int c = 0; c < v.Components; ++c)
  {
    constexpr double Reach = 2147483648.0;
    const MinMaxBlocks::Limits& range = ranges[static_cast<std::size_t>(c)];
    const double origin = std::clamp(std::round(v.Shift[c]), range.Min, range.Max);
    if (!(range.Max - origin < Reach && origin - range.Min <= Reach))
    {
      return;
    }
    v.Words[c] = { static_cast<std::int32_t>(
                     static_cast<std::uint32_t>(static_cast<std::int64_t>(origin))),
      static_cast<float>(v.Scale[c]), static_cast<float>((origin - v.Shift[c]) * v.Scale[c]) };
  }
  v.HasWords = true;
}

PacketSampling SamplingOf(BlendMode mode)
{
  switch (mode)
  {
    case BlendMode::Maximum:
    case BlendMode::Minimum:
      return PacketSampling::Extreme;
    case BlendMode::Average:
    case BlendMode::Additive:
      return PacketSampling::Sum;
    case BlendMode::Isosurface:
      return PacketSampling::Surface;
    case BlendMode::Slice:
      return PacketSampling::Slice;
    default:
      return PacketSampling::Composite;
  }
}

/// Bounds in data coordinates of a box of index coordinates.
Box FindBounds(const VolumeView& volume, const Box& index)
{
  Box bounds{ glm::dvec3(1e300), glm::dvec3(-1e300) };
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 part(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::dvec3 at =
      volume.FirstVoxel + volume.IndexToData * glm::mix(index.Min, index.Max, part);
    bounds.Min = glm::min(bounds.Min, at);
    bounds.Max = glm::max(bounds.Max, at);
  }
  return bounds;
}

/// Decides which code takes the samples.
FrameKind SetSampling(
  const CastScene& scene, const CastSettings& settings, const SampleClassifier& c, PacketScene& p)
{
  p.Sampling = SamplingOf(scene.Blend.Mode);
  p.Intervals = scene.Blend.UsesIntervals();
  FrameKind kind;
  kind.Composites = scene.Blend.Mode == BlendMode::Composite;
  kind.Components = scene.Volume.Components > 1;
  const MaskView& mask = c.GetMask();
  // Labels count where one component, or dependent ones, are composited.
  kind.Masked = mask.Volume.Scalars &&
    (!mask.Labels || (kind.Composites && c.GetFunctions().Components.size() == 1));
  kind.Plane = !kind.Components && !c.GetFunctions().Components[0].Plane.IsEmpty();
  kind.Leaps = settings.Leaping != SpaceLeaping::Off;
  return kind;
}

/// The table that values of a component are made relative to; null where they are colors.
const TransferTable* FindTable(
  const CastScene& scene, const OpticalFunctions& functions, int component)
{
  switch (functions.Kind)
  {
    case ComponentKind::ColorOpacity:
      return component == 0 ? &functions.Colors : scene.Table;
    case ComponentKind::Rgb:
      return nullptr;
    case ComponentKind::Rgba:
      return component == 3 ? scene.Table : nullptr;
    default:
      return component == 0 ? scene.Table
                            : &functions.Components[static_cast<std::size_t>(component)].Table;
  }
}

/// Sets the voxels, how values are scaled when they are fetched, and where samples begin and end.
void SetVolume(const CastScene& scene, const OpticalFunctions& functions,
  const CastSettings& settings, const FrameKind& kind, PacketScene& p)
{
  const VolumeView& v = scene.Volume;
  p.Volume = MakePacketVolume(v, scene.VolumeInterpolation == Interpolation::Nearest);
  p.Volume.Components = kind.Components ? v.Components : 1;
  const double slice = static_cast<double>(v.Increments[2]) * p.Volume.ElementSize;
  const double reach = std::floor(std::min(settings.LargestReach, LargestReach) / slice) - 4.0;
  p.Volume.SlicesInReach = IsThin(v) ? -1
    : reach < v.Dimensions.z         ? static_cast<int>(std::max(reach, 1.0))
                                     : 0;
  if (IsWide(v.Type))
  {
    for (int c = 0; c < 8; ++c)
    {
      // Behind the last component those of the next voxel follow.
      const TransferTable* const table =
        kind.Components ? FindTable(scene, functions, c % 4 % v.Components) : scene.Table;
      if (table)
      {
        constexpr double LargestFetched = 1e36;
        const double width = static_cast<double>(table->GetSize() - 1) / table->GetScale();
        p.Volume.Shift[c] = scene.CommonRanges
          ? FindShift(*table, (*scene.CommonRanges)[static_cast<std::size_t>(c % 4 % v.Components)])
          : table->GetLow();
        p.Volume.Scale[c] = width > WidestFunctions ? LargestFetched / width : table->GetScale();
      }
    }
    if (scene.Ranges)
    {
      p.Volume.MayOverflow = MayOverflow(*scene.Ranges, p.Volume);
      SetWords(*scene.Ranges, p.Volume);
    }
  }
  p.Lower = static_cast<float>(v.LowerIndex().x);
  Copy(v.UpperIndex(), p.Upper);
}

/// Sets the local coordinates, the deformed bounds in them, and the maps to and from index
/// coordinates. `rest`: FindRestBox().
void SetCoordinates(const CastScene& scene, const Box& rest, PacketScene& p)
{
  const VolumeView& v = scene.Volume;
  const Box& bounds = scene.DeformedBounds;
  const Box& whole = GetWholeDeformed(scene);
  p.Center = FindMiddle(scene);
  Copy(bounds.Min - p.Center, p.BoundsMin);
  Copy(bounds.Max - p.Center, p.BoundsMax);
  p.Nowhere = static_cast<float>(1e3 * glm::length(whole.Max - whole.Min));
  CopyRows(v.DataToIndex, p.LocalToIndex);
  const glm::dvec3 shift =
    scene.WholeAtRest ? -glm::round(v.ToIndex(scene.WholeAtRest->Min)) : glm::dvec3(0.0);
  Copy(v.ToIndex(p.Center) + shift, p.IndexOffset);
  Copy(shift, p.IndexShift);
  Copy(rest.Min + shift, p.RestMin);
  Copy(rest.Max + shift, p.RestMax);
  CopyRows(v.IndexToData, p.IndexToLocal);
  CopyRows(glm::transpose(v.DataToIndex), p.GradientToRest);
  const Blending& blend = scene.Blend;
  const glm::dvec3 normal = glm::normalize(blend.SliceNormal);
  Copy(normal, p.SliceNormal);
  p.SliceOffset = static_cast<float>(glm::dot(normal, blend.SliceOrigin - p.Center));
  p.Rays = PacketRays(scene.Camera, p.Center);
}

/// Adds the seeds of Newton's method, which lie at rest in the volume.
void AddSeeds(const VolumeView& v, const Box& rest, const Box& restBounds, PacketScene& p)
{
  // Rounded to a power of two, points are the same to the last bit in all parts of a whole.
  const double extent = glm::length(restBounds.Max - restBounds.Min);
  const double unit = std::exp2(std::floor(std::log2(1e-3 * extent)));
  constexpr int side = PacketScene::SeedsPerAxis;
  for (int i = 0; i < side * side * side; ++i)
  {
    const glm::dvec3 part(i % side, i / side % side, i / side / side);
    const glm::dvec3 at = v.FirstVoxel +
      v.IndexToData * glm::mix(rest.Min, rest.Max, part / static_cast<double>(side - 1));
    PacketSeed seed;
    Copy(unit * glm::round((at - p.Center) / unit), seed.Point);
    p.Seeds.push_back(seed);
  }
}

/// Sets the lengths of segments and of their parts, and the tolerance of interpolants.
void SetSegments(const CastScene& scene, const CastSettings& settings, PacketScene& p)
{
  const Box& whole = GetWholeDeformed(scene);
  const double distance = settings.SampleDistance;
  const double voxel = scene.VoxelSize;
  p.VoxelsPerUnit = static_cast<float>(1.0 / voxel);
  p.PositionTolerance = static_cast<float>(std::max(settings.ErrorBound.PositionTolerance,
    SinglePrecision * glm::length(whole.Max - whole.Min) / voxel));
  p.ShortestSegment = static_cast<float>(settings.ErrorBound.ShortestSegment / voxel);
  // Powers of two, so that segments can be halved down to a sample.
  const auto powerOfTwo = [](double most) {
    return 1 << static_cast<int>(std::clamp(std::floor(std::log2(most) + 1e-6), 0.0, 20.0));
  };
  // Roots that are much longer than the volume is wide would be halved in vain.
  const glm::dvec3 extent = whole.Max - whole.Min;
  const double widest = std::max({ extent.x, extent.y, extent.z, LeastRoot * voxel });
  p.SamplesPerRoot = powerOfTwo(std::min(settings.ErrorBound.LongestSegment, widest) / distance);
  if (const BSplineField* const field = scene.Map->IsIdentity() ? nullptr : scene.Map->GetField())
  {
    const glm::dvec3& spacing = field->GetSpacing();
    p.LongestPlain =
      static_cast<float>(CellsInSegment * std::max({ spacing.x, spacing.y, spacing.z }) / voxel);
  }
  p.SamplesPerPart = powerOfTwo(PartLength * voxel / distance);
}

/// Sets the clipping planes and the cropping region. The coordinates are set already.
void SetClipping(const CastScene& scene, PacketScene& p)
{
  for (const glm::dvec4& plane : scene.ClippingPlanes)
  {
    const double length = glm::length(glm::dvec3(plane));
    const double offset = plane.w + glm::dot(glm::dvec3(plane), p.Center);
    p.ClippingPlanes.push_back(
      { static_cast<float>(plane.x / length), static_cast<float>(plane.y / length),
        static_cast<float>(plane.z / length), static_cast<float>(offset / length) });
  }
  p.CropSpace = scene.Crop.Space;
  p.CropFlags = scene.Crop.Flags;
  if (p.CropSpace == Cropping::Spaces::Deformed)
  {
    Copy(scene.Crop.Low - p.Center, p.CropLow);
    Copy(scene.Crop.High - p.Center, p.CropHigh);
    return;
  }
  // Rounded as those of the whole: taking the shift off again is exact.
  for (int a = 0; a < 3; ++a)
  {
    const float shift = p.IndexShift[a];
    p.CropLow[a] = ToFinite(scene.Crop.Low[a] + static_cast<double>(shift)) - shift;
    p.CropHigh[a] = ToFinite(scene.Crop.High[a] + static_cast<double>(shift)) - shift;
  }
}

/// Sets the distance map of empty-space queries.
void SetLeaping(const CastScene& scene, const CastSettings& settings, PacketScene& p)
{
  p.LeapsSegments = scene.Distances && settings.Leaping == SpaceLeaping::Lipschitz;
  if (scene.Distances && settings.Leaping != SpaceLeaping::Off && !p.Slices)
  {
    p.Distances = scene.Distances->GetData();
    for (int a = 0; a < 3; ++a)
    {
      p.Blocks[a] = scene.Distances->GetBlocks()[a];
      p.LastBlock[a] = static_cast<float>(p.Blocks[a] - 1);
    }
  }
}

/// What must be empty before a sample, data units: intervals are empty only if they lie in empty
/// space as a whole.
double FindReach(const PacketScene& p)
{
  return p.Intervals || p.ClassifiesIntervals ? p.Settings.SampleDistance : 0.0;
}

} // namespace

//------------------------------------------------------------------------------
PacketScene MakePacketScene(
  const CastScene& scene, const CastSettings& settings, const IntegrationFrame& frame)
{
  static std::atomic<std::uint64_t> scenes{ 0 };
  PacketScene p;
  p.Number = ++scenes;
  p.Settings = settings;
  p.Source = &scene;
  const SampleClassifier& classifier = *frame.Classifier;
  const Box rest = FindRestBox(scene.Volume, scene.WholeAtRest);

  const FrameKind kind = SetSampling(scene, settings, classifier, p);
  SetVolume(scene, classifier.GetFunctions(), settings, kind, p);
  SetOptics(scene, classifier, kind, p);
  SetClippedValues(scene, classifier, p);
  SetIntegrals(scene, frame.Intervals, p);
  SetBlending(scene, classifier.GetFunctions(), kind, p);
  SetCoordinates(scene, rest, p);
  SetSegments(scene, settings, p);
  SetClipping(scene, p);
  SetLeaping(scene, settings, p);
  SetShading(scene, settings, classifier, p);

  p.Inner =
    p.Sampling == PacketSampling::Composite && !p.Intervals && !kind.Components && !p.Grid.Snaps;
  const bool isPair = p.KindOfComponents == ComponentKind::Independent && p.Volume.Components == 2;
  const bool isDependent =
    p.KindOfComponents == ComponentKind::ColorOpacity || p.KindOfComponents == ComponentKind::Rgba;
  p.InnerComponents = kind.Components && !p.Grid.Snaps && p.Sampling == PacketSampling::Composite &&
    p.Volume.SlicesInReach == 0 && (isPair || (isDependent && p.Components[0].Weight > 0.0f));
  p.InnerBlending = (p.Sampling == PacketSampling::Extreme || p.Sampling == PacketSampling::Sum ||
                      p.Sampling == PacketSampling::Surface) &&
    !kind.Components && !kind.Masked && !p.HidesSamples;
  p.InnerChannels = p.Sampling == PacketSampling::Extreme && !p.Grid.Snaps && !kind.Masked &&
    !p.HidesSamples && p.Volume.SlicesInReach == 0 &&
    (p.Volume.Components == 2 || p.Volume.Components == 4);
  const bool isPlain = p.Inner && p.CropSpace == Cropping::Spaces::None && !p.NormalsOfOpacity &&
    !p.ClipsGradients && !p.Mask.Scalars && !p.Grid.ChangesGradients();
  p.Options = !isPlain    ? CompositeOptions::Any
    : kind.Plane          ? CompositeOptions::Plane
    : p.OpacityByGradient ? CompositeOptions::GradientOpacity
                          : CompositeOptions::None;
  return p;
}

//------------------------------------------------------------------------------
void FillTable(PacketScene& p)
{
  FunctionCache* const kept = p.Source->KeptOfFunctions;
  p.Table.Fill(kept ? kept->FindContents(p.Table) : p.Table.MakeContents());
}

//------------------------------------------------------------------------------
void SetSeen(const ParallelFor& parallelFor, PacketScene& p)
{
  if (p.LeapsSegments && !p.Slices)
  {
    p.Seen = TileBounds(
      *p.Source, static_cast<double>(p.PositionTolerance), FindReach(p), p.Center, parallelFor);
  }
}

//------------------------------------------------------------------------------
void SetSpace(PacketScene& p)
{
  if (p.Slices || p.Identity || p.Kind != PullBackKind::Exact || p.Source->Limits.OneToOne)
  {
    return;
  }
  const VolumeView& volume = p.Source->Volume;
  const Box restBounds = FindBounds(volume, FindRestBox(volume, p.Source->WholeAtRest));
  p.WholeSpace = std::make_shared<VolumeSpace>(*p.Source, restBounds, FindReach(p), p.Center);
  if (p.LeapsSegments)
  {
    p.Space = std::make_shared<VisibleSpaceOnDemand>(*p.Source,
      p.Folds ? static_cast<double>(p.Orientation) : 0.0, static_cast<double>(p.PositionTolerance),
      FindReach(p), p.Center);
    // Counts must not depend on when it is made.
    if (p.Settings.CountsRays)
    {
      p.Space->Make();
    }
  }
}

//------------------------------------------------------------------------------
void SetPullBack(PacketScene& p)
{
  const CastScene& scene = *p.Source;
  p.Identity = scene.Map->IsIdentity();
  p.Kind = scene.Map->GetKind();
  const Box& whole = GetWholeDeformed(scene);
  // Single precision cannot tell residuals smaller than this.
  const double resolution = 2e-6 * glm::length(whole.Max - whole.Min);
  // Nodes must be far closer than what is interpolated between them.
  const double tolerance =
    NodeTolerance * p.Settings.ErrorBound.PositionTolerance * scene.VoxelSize;
  p.Tolerance =
    static_cast<float>(std::max(std::min(scene.Map->GetTolerance(), tolerance), resolution));
  p.NodeTolerance = static_cast<float>(std::max(tolerance, resolution));
  if (p.Identity)
  {
    return;
  }
  const Box rest = FindRestBox(scene.Volume, scene.WholeAtRest);
  const Box restBounds = FindBounds(scene.Volume, rest);
  FieldCache own;
  FieldCache& cache = scene.KeptOfField ? *scene.KeptOfField : own;
  // What goes on linearly may fold where D as it is does not, and lead Newton's method out of the
  // volume: where T is known to be one to one, it must stay so.
  glm::ivec3 cells(0);
  if (InvertsTheField(p.Kind))
  {
    cells = scene.Limits.OneToOne ? FindLinearCells(scene, cache) : glm::ivec3(CellsOfUnknown);
  }
  p.Field = cache.FindPacketField(*scene.Map->GetField(), restBounds, cells);
  p.Field.SetCenter(p.Center);
  if (InvertsTheField(p.Kind))
  {
    p.Field.Rounding =
      static_cast<float>(SinglePrecision * static_cast<double>(p.Field.GetLargestCoefficient()));
    p.Field.LargestRounding = static_cast<float>(NodeTolerance * scene.VoxelSize);
    AddSeeds(scene.Volume, rest, restBounds, p);
  }
}

//------------------------------------------------------------------------------
void KeepSeeds(PacketScene& p)
{
  float largest = 0.0f;
  for (const PacketSeed& seed : p.Seeds)
  {
    largest = std::max(largest, std::abs(seed.Determinant));
  }
  const auto hasSign = [least = SmallestDeterminant * largest](float sign) {
    return [=](const PacketSeed& seed) { return sign * seed.Determinant > least; };
  };
  const auto positive = std::count_if(p.Seeds.begin(), p.Seeds.end(), hasSign(1.0f));
  const auto negative = std::count_if(p.Seeds.begin(), p.Seeds.end(), hasSign(-1.0f));
  const auto all = static_cast<std::ptrdiff_t>(p.Seeds.size());
  p.Orientation = positive >= negative ? 1.0f : -1.0f;
  p.Folds = positive != all && negative != all;
  const auto kept = std::stable_partition(p.Seeds.begin(), p.Seeds.end(), hasSign(p.Orientation));
  if (kept != p.Seeds.begin())
  {
    p.Seeds.erase(kept, p.Seeds.end());
  }
  for (int a = 0; a < 3; ++a)
  {
    constexpr float FarAway = 1e18f;
    std::vector<float>& images = p.SeedImages[static_cast<std::size_t>(a)];
    images.assign(PacketScene::LargestNumberOfSeeds, FarAway);
    std::transform(p.Seeds.begin(), p.Seeds.end(), images.begin(),
      [a](const PacketSeed& seed) { return seed.Image[a]; });
  }
}

} // namespace ffd
