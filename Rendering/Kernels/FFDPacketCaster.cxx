// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketCaster.h"

#include "FFDRounding.h"
#include "FFDSamplePhase.h"
#include "FFDScalarDispatch.h"
#include "FFDSimdTargets.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

// The packet kernels are compiled once for every instruction set of FFDSimdTargets.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FFDPacketCaster.cxx"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "FFDSimdTile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

int CastTileOfAnyType(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  return ForFetched(scene.Volume.Type, [&](auto zero) {
    return CastTile<decltype(zero)>(scene, x0, y0, subtiles, image, scratch, first, deadline);
  });
}

/// Sets the side of roots: tiles share them where interpolants over several tiles are close enough
/// around most of five points. `quarter`: of the edges of the deformed bounds of the whole.
void ChooseRootSide(const glm::dvec3& quarter, PacketScene& scene)
{
  constexpr int Points = 5;
  constexpr double Corners[Points][3] = { { 0.0, 0.0, 0.0 }, { -1.0, -1.0, -1.0 },
    { 1.0, 1.0, -1.0 }, { 1.0, -1.0, 1.0 }, { -1.0, 1.0, 1.0 } };
  const CameraView& camera = scene.Source->Camera;
  const CameraView::PixelRows rows = camera.GetPixelRows();
  const ImageMap near(scene.NdcToLocal, camera, -1.0);
  const ImageMap far(scene.NdcToLocal, camera, 1.0);
  const double length = scene.SamplesPerRoot * scene.Settings.SampleDistance;
  const auto scratch = std::make_unique<PacketScratch>();
  scene.RootSide = SharedRootSide;
  int seen = 0;
  int close = 0;
  for (const double* corner : Corners)
  {
    const glm::dvec3 p = scene.Center + quarter * glm::dvec3(corner[0], corner[1], corner[2]);
    const glm::dvec4 point(p, 1.0);
    const double w = glm::dot(rows.W, point);
    const glm::dvec2 at = glm::dvec2(glm::dot(rows.X, point), glm::dot(rows.Y, point)) / w;
    const ViewRay ray = camera.MakeRay(at.x, at.y);
    const double t = glm::dot(p - ray.Origin, ray.Direction);
    // Behind the camera, or farther aside than any picture is wide.
    if (!(w > 0.0 && t >= 0.0 && t < ray.Far && std::max(std::abs(at.x), std::abs(at.y)) < 1e5))
    {
      continue;
    }
    // The same in all parts of an image.
    const glm::dvec2 origin(camera.PixelOrigin);
    const glm::ivec2 first(glm::floor(at + origin) - 0.5 * scene.RootSide - origin);
    SegmentTrees trees(scene, *scratch, near, far, first.x, first.y);
    ++seen;
    close += trees.IsRootClose(static_cast<int>(t / length)) ? 1 : 0;
  }
  scene.RootSide = 2 * close > seen ? SharedRootSide : TileSide;
}

void MoveSeeds(PacketScene& scene)
{
  const Df d;
  const std::size_t count = scene.Seeds.size();
  for (std::size_t first = 0; first < count; first += hn::Lanes(d))
  {
    HWY_ALIGN float p[3][16];
    const auto at = [&](std::size_t lane) -> PacketSeed& {
      return scene.Seeds[std::min(first + lane, count - 1)];
    };
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      for (int a = 0; a < 3; ++a)
      {
        p[a][lane] = at(lane).Point[a];
      }
    }
    const Vec3 point{ hn::Load(d, p[0]), hn::Load(d, p[1]), hn::Load(d, p[2]) };
    const NewtonStep step = FindNewtonStep(scene.Field, point, point);
    const Vec3 image = Add(point, step.Residual);
    HWY_ALIGN float inverse[9][16];
    for (int column = 0; column < 3; ++column)
    {
      const auto unit = [&](int a) { return Splat(a == column ? 1.0f : 0.0f); };
      const Vec3 moved = step.Apply({ unit(0), unit(1), unit(2) });
      hn::Store(moved.x, d, inverse[column]);
      hn::Store(moved.y, d, inverse[3 + column]);
      hn::Store(moved.z, d, inverse[6 + column]);
    }
    HWY_ALIGN float determinants[16];
    hn::Store(step.Inverse, d, determinants);
    hn::Store(image.x, d, p[0]);
    hn::Store(image.y, d, p[1]);
    hn::Store(image.z, d, p[2]);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      PacketSeed& seed = at(lane);
      seed.Positive = determinants[lane] > 0.0f;
      for (int a = 0; a < 3; ++a)
      {
        seed.Image[a] = p[a][lane];
      }
      for (int i = 0; i < 9; ++i)
      {
        seed.Inverse[i] = inverse[i][lane];
      }
    }
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ffd
{
namespace
{

HWY_EXPORT(CastTileOfAnyType);
HWY_EXPORT(ChooseRootSide);
HWY_EXPORT(MoveSeeds);

/// Length of the parts of a segment that are tested for emptiness, voxels.
constexpr double PartLength = 2.0;

/// Tolerance of nodes, as a part of that of positions.
constexpr double NodeTolerance = 0.1;

/// The error of positions in single precision, relative to their size.
constexpr double SinglePrecision = 4e-7;

/// The largest specular power that is found by multiplications.
constexpr float LargestWholePower = 128.0f;

/// The largest number of bytes that a 32-bit offset leads over.
constexpr double LargestReach = 2147483647.0;

/// Voxels of the largest slice, in elements: a 32-bit offset leads over it and to two others.
constexpr double LargestSlice = LargestReach / 3.0;

template <class Vector>
void Copy(const Vector& from, float to[3])
{
  for (int a = 0; a < 3; ++a)
  {
    to[a] = static_cast<float>(from[a]);
  }
}

void CopyRows(const glm::dmat3& from, float to[9])
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      to[3 * row + column] = static_cast<float>(from[column][row]);
    }
  }
}

int SizeOf(ScalarType type)
{
  return DispatchScalarType(type, [](auto zero) { return static_cast<int>(sizeof(zero)); });
}

/// Types whose values single precision does not hold.
bool IsWide(ScalarType type) { return SizeOf(type) > 2 && type != ScalarType::Float32; }

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

/// Whether no cell has neighbors on all sides.
bool IsThin(const VolumeView& v)
{
  return std::min({ v.Dimensions.x, v.Dimensions.y, v.Dimensions.z }) < 4;
}

/// Whether the vector code can fetch these voxels.
bool CanFetchPackets(const VolumeView& v)
{
  const double slice = static_cast<double>(v.Increments[2]);
  return v.Increments[0] == v.Components &&
    (IsThin(v) ? slice * v.Dimensions.z <= LargestReach : slice <= LargestSlice);
}

/// Whether the vector code can look up the voxels of a mask, if there is one: by the number of a
/// row through all slices.
bool CanLookUpMask(const VolumeView& v)
{
  return !v.Scalars ||
    (v.Increments[0] == 1 && v.Increments[2] == v.Increments[1] * v.Dimensions.y &&
      static_cast<double>(v.Dimensions.y) * v.Dimensions.z <= LargestReach);
}

/// Whether 32-bit offsets lead over the voxels of the second axis of a two-dimensional transfer
/// function, of which four and more lie side by side.
bool IsAxisInReach(const VolumeView& v)
{
  return v.Increments[0] == 1 && v.Dimensions.x >= 4 &&
    static_cast<double>(v.Increments[2]) * v.Dimensions.z * SizeOf(v.Type) <= LargestReach;
}

/// Whether the vector code can take the samples of this scene; else each ray has a RayIntegrator.
bool CanTakeSamples(const CastScene& scene, const SampleClassifier& classifier)
{
  const OpticalFunctions& functions = classifier.GetFunctions();
  const int components = scene.Volume.Components;
  const bool hides = classifier.GetHidden() != nullptr;
  // Gradients that only the reference functions find.
  const bool rare = (classifier.ClipsGradients() && (hides || scene.Volume.Axes)) ||
    (classifier.HasNormalsOfOpacity() && hides && components > 1);
  return !rare && CanFetchPackets(scene.Volume) && CanLookUpMask(classifier.GetMask().Volume) &&
    components <= SampleClassifier::LargestNumberOfComponents &&
    (functions.Kind != ComponentKind::Independent ||
      static_cast<int>(functions.Components.size()) == components);
}

/// The component of the voxels whose values an entry of OpticalFunctions::Components is looked up
/// for; of those of a luminance, which have the same scale, the first.
int FindDensityComponent(ComponentKind kind, int entry)
{
  switch (kind)
  {
    case ComponentKind::ColorOpacity:
      return 1;
    case ComponentKind::Rgb:
      return 0;
    case ComponentKind::Rgba:
      return 3;
    default:
      return entry;
  }
}

/// A value of a component as packets fetch it (PacketVolume).
double AsFetched(const PacketVolume& volume, int component, double value)
{
  return (value - volume.Shift[component]) * volume.Scale[component];
}

/// Adds a transfer table; its range is that of the values of a component as fetched.
void AddTable(const TransferTable& table, int component, PacketScene& scene)
{
  scene.Table.Add(table, static_cast<float>(AsFetched(scene.Volume, component, table.GetLow())),
    static_cast<float>(table.GetScale() / scene.Volume.Scale[component]));
}

/// The scale that takes gradients of a component as packets fetch them, differences over two voxels
/// scaled as the values, to vectors whose length is the magnitude.
glm::dvec3 FindMagnitudeScale(
  const SampleClassifier& classifier, const PacketVolume& volume, int component)
{
  return classifier.GetMagnitudeScale() * (0.5 / volume.Scale[component]);
}

/// Sets the mask of a scene, and the tables and gradient opacities of its labels.
void SetMask(const SampleClassifier& classifier, PacketScene& scene)
{
  const MaskView& mask = classifier.GetMask();
  PacketMask& p = scene.Mask;
  p.Scalars = mask.Volume.Scalars;
  p.Type = mask.Volume.Type;
  for (int a = 0; a < 3; ++a)
  {
    p.Dimensions[a] = mask.Volume.Dimensions[a];
  }
  p.RowIncrement = mask.Volume.Increments[1];
  p.SameGrid = mask.SameGrid;
  CopyRows(classifier.GetToMask(), p.FromIndex);
  Copy(classifier.GetMaskOffset(), p.Offset);
  p.Labels = mask.Labels;
  p.BlendFactor = mask.BlendFactor;
  if (!mask.Labels || !(mask.BlendFactor > 0.0f))
  {
    return;
  }
  const OpticalFunctions& functions = classifier.GetFunctions();
  const int component = scene.Volume.Components > 1 ? FindDensityComponent(functions.Kind, 0) : 0;
  std::vector<const GradientOpacity*> gradients{ &functions.Components[0].Gradients };
  for (const LabelOptics& label : functions.Labels)
  {
    AddTable(label.Table, component, scene);
    gradients.push_back(&label.Gradients);
  }
  for (const int index : functions.LabelIndices)
  {
    p.Tables.push_back(index + 1);
  }
  if (std::all_of(gradients.begin(), gradients.end(),
        [](const GradientOpacity* opacity) { return opacity->IsEmpty(); }))
  {
    return;
  }
  // Magnitudes in entries of the finest factors: in units of the scalars squares may be beyond
  // single precision.
  double finest = 0.0;
  for (const GradientOpacity* opacity : gradients)
  {
    finest = opacity->IsEmpty() ? finest : std::max(finest, opacity->GetScale());
  }
  for (const GradientOpacity* opacity : gradients)
  {
    const std::vector<float> factors =
      opacity->IsEmpty() ? std::vector<float>(2, 1.0f) : opacity->GetFactors();
    p.GradientRanges.push_back(
      { static_cast<std::int32_t>(p.GradientFactors.size()), static_cast<float>(factors.size() - 1),
        static_cast<float>(opacity->GetScale() / finest), 0 });
    p.GradientFactors.insert(p.GradientFactors.end(), factors.begin(), factors.end());
  }
  Copy(FindMagnitudeScale(classifier, scene.Volume, component) * finest, p.MagnitudeScale);
}

/// The voxels of an image with one component.
PacketVolume MakePacketVolume(const VolumeView& v, bool nearest)
{
  PacketVolume packet;
  packet.Scalars = v.Scalars;
  packet.Type = v.Type;
  for (int a = 0; a < 3; ++a)
  {
    packet.Dimensions[a] = v.Dimensions[a];
  }
  packet.IncrementY = static_cast<int>(v.Increments[1]);
  packet.IncrementZ = static_cast<int>(v.Increments[2]);
  packet.ElementSize = SizeOf(v.Type);
  packet.Nearest = nearest;
  if (packet.ElementSize <= 2)
  {
    packet.Integers = MakePacketIntegers(
      packet.ElementSize, v.Type == ScalarType::Int8 || v.Type == ScalarType::Int16);
  }
  return packet;
}

/// The two-dimensional transfer function of one entry of OpticalFunctions::Components, over values
/// of `component` of the voxels.
PacketPlane MakePlane(const SampleClassifier& classifier, const ComponentOptics& optics,
  const PacketVolume& v, int component)
{
  const TransferPlane& plane = optics.Plane;
  PacketPlane p;
  p.Texels = &plane.GetTexels()[0].x;
  p.Size[0] = plane.GetWidth();
  p.Size[1] = plane.GetHeight();
  // Magnitudes are in texels: in units of the scalars squares may be beyond single precision.
  const VolumeView& axis = classifier.GetSecondAxis();
  const bool byGradient = !axis.Scalars;
  const double unit = byGradient ? plane.GetScale().y : 1.0;
  p.Low[0] = static_cast<float>(AsFetched(v, component, plane.GetLow().x));
  p.Low[1] = static_cast<float>(plane.GetLow().y * unit);
  p.Scale[0] = static_cast<float>(plane.GetScale().x / v.Scale[component]);
  p.Scale[1] = byGradient ? 1.0f : static_cast<float>(plane.GetScale().y);
  p.Nearest = plane.IsNearest();
  p.UnitDistance = static_cast<float>(optics.Table.GetUnitDistance());
  Copy(FindMagnitudeScale(classifier, v, component) * unit, p.MagnitudeScale);
  p.SecondAxis = MakePacketVolume(axis, v.Nearest);
  std::copy_n(axis.Increments, 3, p.AxisIncrements);
  p.AxisByLane = axis.Scalars && !IsAxisInReach(axis);
  return p;
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

/// Removes the seeds in the parts of the volume that T turns inside out, if it folds.
void KeepOneOrientation(PacketScene& scene)
{
  const auto positive = std::count_if(
    scene.Seeds.begin(), scene.Seeds.end(), [](const PacketSeed& seed) { return seed.Positive; });
  const bool most = 2 * positive >= static_cast<std::ptrdiff_t>(scene.Seeds.size());
  scene.Orientation = most ? 1.0f : -1.0f;
  scene.Folds = positive != 0 && positive != static_cast<std::ptrdiff_t>(scene.Seeds.size());
  scene.Seeds.erase(std::remove_if(scene.Seeds.begin(), scene.Seeds.end(),
                      [&](const PacketSeed& seed) { return seed.Positive != most; }),
    scene.Seeds.end());
}

/// The range of values of which, in `size` entries, those from the first to the last one show
/// something; entry 0 stands for `low`, and there are `scale` entries a unit. `guard`: entries
/// before and behind, at least one.
ValueRange MakeVisibleRange(
  int first, int last, int size, float low, float scale, double guard = 1.0)
{
  // Rounded outwards: entries may be nearer to each other than single precision tells.
  constexpr float Infinite = std::numeric_limits<float>::infinity();
  const auto valueAt = [&](double entry) {
    return entry / static_cast<double>(scale) + static_cast<double>(low);
  };
  return { first == 0 ? -Infinite : RoundDown(valueAt(first - guard)),
    last == size - 1 ? Infinite : RoundUp(valueAt(last + guard)) };
}

/// `range`: of the table as packets have it.
ValueRange FindVisibleRange(const TransferTable& table, const PacketTable::Range& range)
{
  const float* const entries = table.GetEntries();
  const auto isVisible = [&](int i) { return entries[4 * static_cast<std::size_t>(i) + 3] > 0.0f; };
  const int size = static_cast<int>(table.GetSize());
  int first = 0;
  while (first < size && !isVisible(first))
  {
    ++first;
  }
  int last = size - 1;
  while (last >= first && !isVisible(last))
  {
    --last;
  }
  return MakeVisibleRange(first, last, size, range.Low, range.Scale);
}

/// `packet`: of the plane.
ValueRange FindVisibleRange(const TransferPlane& plane, const PacketPlane& packet)
{
  const glm::ivec2 visible = plane.FindVisibleColumns();
  // A little more than one entry against rounding errors.
  return MakeVisibleRange(
    visible.x, visible.y, packet.Size[0], packet.Low[0], packet.Scale[0], 1.01);
}

/// Widens a range by those of the labels, if they are looked up.
void AddVisibleLabels(
  const OpticalFunctions& functions, const PacketScene& scene, ValueRange& range)
{
  for (std::size_t i = 0; i < functions.Labels.size() && !scene.Mask.Tables.empty(); ++i)
  {
    const ValueRange ofLabel =
      FindVisibleRange(functions.Labels[i].Table, scene.Table.GetRange(i + 1));
    range = { std::min(range.Low, ofLabel.Low), std::max(range.High, ofLabel.High) };
  }
}

PacketLight MakePacketLight(
  const Light& light, const Reflectance& material, const glm::dvec3& center)
{
  PacketLight packet;
  packet.Positional = light.Positional;
  packet.Cone = light.ConeCosine >= -1.0;
  packet.ConeCosine = static_cast<float>(light.ConeCosine);
  packet.ConeExponent = static_cast<float>(light.ConeExponent);
  Copy(light.Position - center, packet.Position);
  Copy(light.Towards, packet.Towards);
  Copy(light.Axis, packet.Axis);
  Copy(material.Ambient * light.Ambient, packet.Ambient);
  Copy(material.Diffuse * light.Diffuse, packet.Diffuse);
  Copy(material.Specular * light.Specular, packet.Specular);
  Copy(light.Attenuation, packet.Attenuation);
  return packet;
}

/// `reflectance`: of one component.
PacketSurface MakeSurface(
  const Shading& material, const Reflectance& reflectance, const glm::dvec3& center)
{
  PacketSurface surface;
  const float power = reflectance.SpecularPower;
  surface.SpecularPower = power;
  if (power == std::floor(power) && power <= LargestWholePower)
  {
    surface.WholeSpecularPower = static_cast<int>(power);
  }
  for (const Light& light : material.Lights)
  {
    const PacketLight packet = MakePacketLight(light, reflectance, center);
    if (!light.Headlight)
    {
      surface.Lights.push_back(packet);
      continue;
    }
    for (int c = 0; c < 3; ++c)
    {
      surface.Headlights.Ambient[c] += packet.Ambient[c];
      surface.Headlights.Diffuse[c] += packet.Diffuse[c];
      surface.Headlights.Specular[c] += packet.Specular[c];
    }
  }
  return surface;
}

PacketGradientOpacity MakeGradientOpacity(const GradientOpacity& opacity,
  const SampleClassifier& classifier, const PacketVolume& volume, int component)
{
  PacketGradientOpacity packet;
  if (!opacity.IsEmpty())
  {
    packet.Factors = opacity.GetFactors().data();
    packet.Size = static_cast<int>(opacity.GetFactors().size());
    Copy(FindMagnitudeScale(classifier, volume, component) * opacity.GetScale(), packet.Scale);
    const float* const end = packet.Factors + packet.Size;
    const float* const some =
      std::find_if(packet.Factors, end, [](float factor) { return factor > 0.0f; });
    const float zeros = static_cast<float>(some - packet.Factors);
    packet.ZeroUpTo = some == end ? std::numeric_limits<float>::infinity()
                                  : std::max(zeros - 1.0f, 0.0f) * std::max(zeros - 1.0f, 0.0f);
  }
  return packet;
}

/// Adds the optical properties of several components; the tables of the first one and of labels
/// are there already.
/// `leaps`: whether values that are not visible are left out.
void AddComponents(const SampleClassifier& classifier, const Shading& material,
  const glm::dvec3& center, bool leaps, PacketScene& scene)
{
  const OpticalFunctions& functions = classifier.GetFunctions();
  scene.KindOfComponents = functions.Kind;
  scene.ColorScale = static_cast<float>(functions.ColorScale);
  for (const ComponentOptics& optics : functions.Components)
  {
    const int ofVoxels =
      FindDensityComponent(functions.Kind, static_cast<int>(scene.Components.size()));
    if (!scene.Components.empty())
    {
      AddTable(optics.Table, ofVoxels, scene);
    }
    PacketComponent component;
    component.Gradients = MakeGradientOpacity(optics.Gradients, classifier, scene.Volume, ofVoxels);
    component.UnitDistance = static_cast<float>(optics.Table.GetUnitDistance());
    component.Weight = optics.Weight;
    const bool byPlane = !optics.Plane.IsEmpty();
    component.ByTable = !byPlane && scene.Mask.Tables.empty();
    if (byPlane)
    {
      component.Plane = MakePlane(classifier, optics, scene.Volume, ofVoxels);
    }
    if (leaps)
    {
      component.Visible = byPlane
        ? FindVisibleRange(optics.Plane, component.Plane)
        : FindVisibleRange(optics.Table, scene.Table.GetRange(scene.Components.size()));
      AddVisibleLabels(functions, scene, component.Visible);
    }
    scene.OpacityByGradient = scene.OpacityByGradient || component.Gradients.Factors ||
      (byPlane && !component.Plane.SecondAxis.Scalars);
    component.Surface = MakeSurface(material, optics.Surface, center);
    scene.Components.push_back(component);
  }
  if (functions.Kind == ComponentKind::ColorOpacity)
  {
    scene.ColorTable = scene.Table.GetSize();
    AddTable(functions.Colors, 0, scene);
    if (!functions.Components[0].Plane.IsEmpty())
    {
      scene.ColorPlane = MakePlane(classifier, functions.Components[0], scene.Volume, 0);
    }
  }
}

/// The abilities of the vector code that a frame needs.
struct FrameKind
{
  bool Composites = false; ///< vector code composites
  bool Components = false; ///< vector code composites or blends several components
  bool Masked = false;     ///< a mask or a label map is looked up
  bool Plane = false;      ///< one component has a two-dimensional transfer function
  bool Leaps = false;      ///< values that are not visible are left out
};

/// Decides who takes the samples, vector code or the integrators of the rays.
FrameKind SetSampling(
  const CastScene& scene, const CastSettings& settings, const SampleClassifier& c, PacketScene& p)
{
  // What is plain is fetched by packets, or they are not used at all.
  const bool vectors = !settings.PerRay && (c.IsPlain() || CanTakeSamples(scene, c));
  const bool composites = vectors && scene.Blend.Mode == BlendMode::Composite;
  const bool blends = vectors && scene.Blend.Mode != BlendMode::Composite;
  p.Sampling = composites || blends ? SamplingOf(scene.Blend.Mode) : PacketSampling::PerRay;
  p.Intervals = scene.Blend.UsesIntervals();
  FrameKind kind;
  kind.Composites = composites;
  kind.Components = vectors && scene.Volume.Components > 1;
  const MaskView& mask = c.GetMask();
  // Labels count where one component, or dependent ones, are composited.
  kind.Masked = vectors && mask.Volume.Scalars &&
    (!mask.Labels || (composites && c.GetFunctions().Components.size() == 1));
  kind.Plane = vectors && !kind.Components && !c.GetFunctions().Components[0].Plane.IsEmpty();
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
  p.Reference = SelectSampleFunctions(v.Type, scene.VolumeInterpolation);
  p.Nearest = SelectSampleFunctions(v.Type, Interpolation::Nearest);
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
        p.Volume.Shift[c] = table->GetLow();
        p.Volume.Scale[c] = table->GetScale();
      }
    }
  }
  p.Lower = static_cast<float>(v.LowerIndex().x);
  Copy(v.UpperIndex(), p.Upper);
}

/// Finds the range of values of one component outside of which nothing is visible.
ValueRange FindVisibleRange(
  const CastScene& scene, const OpticalFunctions& functions, const PacketScene& p)
{
  ValueRange range = p.Plane.Texels ? FindVisibleRange(functions.Components[0].Plane, p.Plane)
                                    : FindVisibleRange(*scene.Table, p.Table.GetRange(0));
  AddVisibleLabels(functions, p, range);
  return range;
}

/// Sets the transfer functions, masks and gradient opacities, and the range of visible values. The
/// volume is set already.
void SetOptics(
  const CastScene& scene, const SampleClassifier& classifier, const FrameKind& kind, PacketScene& p)
{
  const int component =
    kind.Components ? FindDensityComponent(classifier.GetFunctions().Kind, 0) : 0;
  AddTable(*scene.Table, component, p);
  p.UnitDistance = static_cast<float>(scene.Table->GetUnitDistance());
  p.ReferenceLength = static_cast<float>(classifier.GetReferenceLength());
  if (kind.Masked)
  {
    SetMask(classifier, p);
  }
  const bool vectors = p.Sampling != PacketSampling::PerRay;
  VolumeView even = scene.Volume;
  even.Axes = nullptr;
  p.Grid =
    vectors ? MakePacketGrid(scene.Volume, classifier.GetHidden()) : MakePacketGrid(even, nullptr);
  if (vectors)
  {
    p.HidesSamples = p.Grid.Hidden || (p.Mask.Scalars && !p.Mask.Labels);
  }
  if (kind.Plane)
  {
    p.Plane = MakePlane(classifier, classifier.GetFunctions().Components[0], p.Volume, 0);
  }
  const bool byTable = !kind.Plane && !kind.Components && p.Mask.Tables.empty();
  if (kind.Leaps && !kind.Components)
  {
    p.Visible = FindVisibleRange(scene, classifier.GetFunctions(), p);
  }
  if (kind.Composites && byTable)
  {
    p.Gradients = MakeGradientOpacity(classifier.GetGradientOpacity(), classifier, p.Volume, 0);
  }
  p.ReferenceIsInterval = p.Settings.Opacity == OpacityLength::Deformed &&
    p.Settings.SampleDistance == classifier.GetReferenceLength();
  p.OpacityByGradient = p.Gradients.Factors || !p.Mask.GradientRanges.empty() ||
    (kind.Plane && !p.Plane.SecondAxis.Scalars);
}

/// Sets what intervals are classified by. The volume is set already.
void SetIntegrals(const CastScene& scene, const IntervalTable& table, PacketScene& p)
{
  p.ClassifiesIntervals = !table.IsEmpty();
  if (!p.ClassifiesIntervals)
  {
    return;
  }
  PacketIntegrals& to = p.Integrals;
  const float* const entries = scene.Table->GetEntries();
  const auto extinctionAt = [&](std::size_t i) {
    return static_cast<float>(
      std::min(static_cast<double>(entries[4 * i + 3]), table.GetLargestExtinction()));
  };
  to.Entries.resize(scene.Table->GetSize() - 1);
  for (std::size_t i = 0; i < to.Entries.size(); ++i)
  {
    const float extinction = extinctionAt(i);
    const float change = extinctionAt(i + 1) - extinction;
    std::uint32_t* const words = to.Entries[i].Words;
    std::memcpy(&words[0], &extinction, sizeof(float));
    std::memcpy(&words[1], &change, sizeof(float));
    words[2] = table.GetIntegrals()[i];
    words[3] = 0;
  }
  to.Units = static_cast<float>(table.GetUnits());
  to.Margin = scene.Table->GetMargin();
  const auto fetched = [&](double value) { return ToSingle(AsFetched(p.Volume, 0, value)); };
  to.VisibleLow = fetched(table.GetVisibleLow());
  to.VisibleHigh = fetched(table.GetVisibleHigh());
}

/// Adds the channels of a scene whose components are not composited. The volume is set already.
void AddChannels(const CastScene& scene, const OpticalFunctions& functions, PacketScene& p)
{
  const Blending& blend = scene.Blend;
  for (std::size_t i = 0; i < functions.Components.size(); ++i)
  {
    // Extremes are those of densities, sums those of intensities.
    const int c = static_cast<int>(i);
    const int component =
      p.Sampling == PacketSampling::Extreme || functions.Kind == ComponentKind::Independent
      ? FindDensityComponent(functions.Kind, c)
      : 0;
    const auto fetched = [&](double value) {
      return ToFinite(AsFetched(p.Volume, component, value));
    };
    PacketChannel channel;
    channel.Low = fetched(blend.Low[i]);
    channel.High = fetched(blend.High[i]);
    channel.AverageMin = fetched(blend.AverageMin);
    channel.AverageMax = fetched(blend.AverageMax);
    channel.Weight = static_cast<float>(blend.Weight[i]);
    channel.UnitDistance = static_cast<float>(functions.Components[i].Table.GetUnitDistance());
    channel.AdditiveDistance = static_cast<float>(blend.UnitDistance[i]);
    p.Channels.push_back(channel);
  }
}

/// Sets what the blend modes compare values with. The optics are set already.
void SetBlending(
  const CastScene& scene, const OpticalFunctions& functions, const FrameKind& kind, PacketScene& p)
{
  // Of several components only surfaces have values here: of the one that they are of.
  const int component =
    kind.Components && functions.Kind == ComponentKind::Independent ? scene.Blend.IsoComponent : 0;
  const auto asFetched = [&](double value) { return AsFetched(p.Volume, component, value); };
  const auto fetched = [&](double value) { return ToFinite(asFetched(value)); };
  p.ValueLow = fetched(scene.Blend.Low[0]);
  p.ValueHigh = fetched(scene.Blend.High[0]);
  const bool maximum = scene.Blend.Mode == BlendMode::Maximum;
  p.LastExtreme =
    maximum ? std::min(p.ValueHigh, p.Visible.High) : std::min(-p.ValueLow, -p.Visible.Low);
  if (p.Sampling == PacketSampling::Extreme && kind.Leaps && scene.Peaks)
  {
    for (const ValuePeaks& peaks : *scene.Peaks)
    {
      const int channel = kind.Components
        ? FindDensityComponent(functions.Kind, static_cast<int>(p.Peaks.size()))
        : 0;
      // Minima are found as maxima of the negated values.
      const double shift = maximum ? p.Volume.Shift[channel] : -p.Volume.Shift[channel];
      const double scale = p.Volume.Scale[channel];
      const double step = peaks.GetStep() * scale;
      p.Peaks.push_back({ &peaks, (peaks.GetLow() - shift) * scale - step, 1.0 / step,
        (peaks.GetHigh() - shift) * scale });
    }
  }
  if (kind.Components && !kind.Composites)
  {
    AddChannels(scene, functions, p);
  }
  p.Slices = scene.Blend.Mode == BlendMode::Slice;
  p.AverageMin = fetched(scene.Blend.AverageMin);
  p.AverageMax = fetched(scene.Blend.AverageMax);
  for (const IsoValue& iso : scene.Blend.IsoValues)
  {
    if (iso.Opacity > 0.0f)
    {
      const double exact = std::clamp(asFetched(iso.Value), -1e37, 1e37);
      const float value = RoundUp(exact);
      p.IsoValues.push_back({ value, ToFinite(static_cast<double>(value) - exact),
        { iso.Color.r, iso.Color.g, iso.Color.b }, iso.Opacity });
    }
  }
}

/// The box that the volume, or the whole that it is a part of, takes up when it is deformed.
const Box& GetWholeDeformed(const CastScene& scene)
{
  return scene.WholeDeformed ? *scene.WholeDeformed : scene.DeformedBounds;
}

/// Sets the local coordinates, the deformed bounds in them, and the maps to and from index
/// coordinates. `rest`: FindRestBox().
void SetCoordinates(const CastScene& scene, const Box& rest, PacketScene& p)
{
  const VolumeView& v = scene.Volume;
  const Box& bounds = scene.DeformedBounds;
  const Box& whole = GetWholeDeformed(scene);
  p.Center = 0.5 * (whole.Min + whole.Max);
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
  p.NdcToLocal = glm::translate(glm::dmat4(1.0), -p.Center) * scene.Camera.NdcToData;
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
  HWY_DYNAMIC_DISPATCH(MoveSeeds)(p);
  KeepOneOrientation(p);
  for (int a = 0; a < 3; ++a)
  {
    constexpr float FarAway = 1e18f;
    std::vector<float>& images = p.SeedImages[static_cast<std::size_t>(a)];
    images.assign(PacketScene::LargestNumberOfSeeds, FarAway);
    std::transform(p.Seeds.begin(), p.Seeds.end(), images.begin(),
      [a](const PacketSeed& seed) { return seed.Image[a]; });
  }
}

/// Sets the field of the pull-back, its tolerances and its seeds. The coordinates are set already.
void SetPullBack(
  const CastScene& scene, const CastSettings& settings, const Box& rest, PacketScene& p)
{
  p.Identity = scene.Map->IsIdentity();
  p.Kind = scene.Map->GetKind();
  const Box& whole = GetWholeDeformed(scene);
  // Single precision cannot tell residuals smaller than this.
  const double resolution = 2e-6 * glm::length(whole.Max - whole.Min);
  // Nodes must be far closer than what is interpolated between them.
  const double tolerance = NodeTolerance * settings.ErrorBound.PositionTolerance * scene.VoxelSize;
  p.Tolerance =
    static_cast<float>(std::max(std::min(scene.Map->GetTolerance(), tolerance), resolution));
  p.NodeTolerance = static_cast<float>(std::max(tolerance, resolution));
  if (p.Identity)
  {
    return;
  }
  const Box restBounds = FindBounds(scene.Volume, rest);
  // Only where T is not known to be one to one: what goes on linearly may fold where D as it is
  // does not, and lead Newton's method out of the volume.
  const bool extended = InvertsTheField(p.Kind) && !scene.Limits.OneToOne;
  p.Field.Assign(*scene.Map->GetField(), p.Center, extended ? &restBounds : nullptr);
  if (InvertsTheField(p.Kind))
  {
    p.Field.Rounding =
      static_cast<float>(SinglePrecision * static_cast<double>(p.Field.FindLargestCoefficient()));
    p.Field.LargestRounding = static_cast<float>(NodeTolerance * scene.VoxelSize);
    AddSeeds(scene.Volume, rest, restBounds, p);
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
  p.SamplesPerRoot = powerOfTwo(settings.ErrorBound.LongestSegment / distance);
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
    p.LeapsRays = p.Sampling == PacketSampling::PerRay;
  }
}

/// Sets what may be visible of each tile. Segments and leaping are set already.
void SetSeen(const CastScene& scene, const CastSettings& settings, const ParallelFor& parallelFor,
  PacketScene& p)
{
  if (p.LeapsSegments && !p.Slices)
  {
    // Intervals are empty only if they lie in empty space as a whole.
    const bool intervals = p.Intervals || p.ClassifiesIntervals;
    p.Seen = TileBounds(scene, static_cast<double>(p.PositionTolerance),
      intervals ? settings.SampleDistance : 0.0, p.Center, parallelFor);
  }
}

/// The range of the values of a component, as fetched, or a wider one.
double FindRangeOfValues(const CastScene& scene, const PacketVolume& v, int component)
{
  // That of voxels of few bytes; else those of the table and of the blend mode.
  constexpr double RangeOfFewBytes = 65536.0;
  const TransferTable& table = *scene.Table;
  double range = static_cast<double>(table.GetSize() - 1) / table.GetScale();
  for (int c = 0; c < Blending::LargestNumberOfComponents; ++c)
  {
    range = std::max(range, scene.Blend.High[c] - scene.Blend.Low[c]);
  }
  return v.ElementSize <= 2 ? RangeOfFewBytes : range * v.Scale[component];
}

/// Sets what gradients count beside clipping planes. The optics are set already.
void SetClippedValues(const CastScene& scene, const SampleClassifier& classifier, PacketScene& p)
{
  // So far away from all others that gradients point from one to them; the squares of their
  // differences are numbers in single precision.
  constexpr double Far = 1e6;
  p.ClipsGradients = p.Sampling != PacketSampling::PerRay && classifier.ClipsGradients();
  for (int c = 0; c < p.Volume.Components && p.ClipsGradients; ++c)
  {
    const double far = Far * FindRangeOfValues(scene, p.Volume, c);
    const double low = AsFetched(p.Volume, c, scene.Table->GetLow());
    const double clipped = AsFetched(p.Volume, c, classifier.GetClippedIntensity());
    p.ClippedValues[c] = ToFinite(std::clamp(clipped, low - far, low + far));
  }
}

/// Finds what gradients are multiplied by, of which only the direction counts, so that neither the
/// squares of small ones nor those of the largest ones are beyond single precision.
double FindGradientScale(
  const CastScene& scene, const SampleClassifier& classifier, const PacketScene& p)
{
  constexpr double LargestGradient = 1e15;
  constexpr double LargestFactor = 1e35;
  const TransferTable& table = *scene.Table;
  const int component =
    p.Volume.Components > 1 ? FindDensityComponent(classifier.GetFunctions().Kind, 0) : 0;
  double range = classifier.HasNormalsOfOpacity()
    ? 1.0
    : static_cast<double>(table.GetSize() - 1) / table.GetScale() * p.Volume.Scale[component];
  for (const float clipped : p.ClippedValues)
  {
    range = std::max(range, static_cast<double>(std::abs(clipped)));
  }
  const glm::dmat3& ofData = scene.Material.GetGradientToLights();
  const glm::dmat3 ofIndex = ofData * glm::transpose(scene.Volume.DataToIndex);
  double scale = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const double factor = glm::length(ofIndex[a]);
    scale = std::min({ scale, LargestGradient / (range * factor), LargestFactor / factor,
      LargestFactor / glm::length(ofData[a]) });
  }
  return std::isfinite(scale) && scale > 0.0 ? scale : 1.0;
}

/// Sets lights and materials. The coordinates are set already.
void SetShading(const CastScene& scene, const CastSettings& settings,
  const SampleClassifier& classifier, PacketScene& p)
{
  p.Shade = settings.Shade;
  p.TwoSided = scene.Material.TwoSided;
  const glm::dmat3& toLights = scene.Material.GetToLights();
  CopyRows(toLights, p.LocalToLights);
  const glm::dmat3 toSpace =
    FindGradientScale(scene, classifier, p) * scene.Material.GetGradientToLights();
  CopyRows(toSpace, p.GradientToLights);
  CopyRows(toSpace * glm::transpose(scene.Volume.DataToIndex), p.IndexGradientToLights);
  p.Parallel = scene.Camera.Parallel;
  Copy(toLights * (scene.Camera.Eye - p.Center), p.Eye);
  p.Surface = MakeSurface(scene.Material, scene.Material, toLights * p.Center);
  if (p.Volume.Components > 1)
  {
    AddComponents(
      classifier, scene.Material, toLights * p.Center, settings.Leaping != SpaceLeaping::Off, p);
  }
}

} // namespace

//------------------------------------------------------------------------------
bool PacketCaster::Supports(const CastScene& scene, const CastSettings& settings)
{
  if (settings.Reference || settings.Segments != Segmentation::ErrorBound)
  {
    return false;
  }
  // Others are fetched ray by ray, from any voxels.
  const SampleClassifier* classifier = scene.Classifier;
  const bool plain = !classifier || classifier->IsPlain();
  return !plain || CanFetchPackets(scene.Volume);
}

//------------------------------------------------------------------------------
PacketCaster::PacketCaster(const CastScene& scene, const CastSettings& settings,
  const IntegrationFrame& frame, const ParallelFor& parallelFor)
{
  static std::atomic<std::uint64_t> scenes{ 0 };
  PacketScene& p = this->Scene;
  p.Number = ++scenes;
  p.Settings = settings;
  p.Source = &scene;
  p.Frame = &frame;
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
  // Neither needs the other. The first takes longer; whoever is done with the second joins in.
  RunBoth(
    parallelFor, [&] { SetSeen(scene, settings, parallelFor, p); },
    [&] {
      SetPullBack(scene, settings, rest, p);
      if (!p.Identity)
      {
        const Box& whole = GetWholeDeformed(scene);
        HWY_DYNAMIC_DISPATCH(ChooseRootSide)(0.25 * (whole.Max - whole.Min), p);
      }
    });
  p.NormalsOfOpacity = p.Shade && classifier.HasNormalsOfOpacity();

  p.Inner =
    p.Sampling == PacketSampling::Composite && !p.Intervals && !kind.Components && !p.Grid.Snaps;
  p.InnerComponents = kind.Components && !p.Grid.Snaps && p.Sampling == PacketSampling::Composite &&
    p.Volume.SlicesInReach == 0 && p.Components[0].Weight > 0.0f &&
    (p.KindOfComponents == ComponentKind::ColorOpacity ||
      p.KindOfComponents == ComponentKind::Rgba);
  p.InnerBlending =
    (p.Sampling == PacketSampling::Extreme || p.Sampling == PacketSampling::Surface) &&
    !kind.Components && !kind.Masked && !p.HidesSamples;
  p.Plain = p.Inner && p.CropSpace == Cropping::Spaces::None && !p.OpacityByGradient &&
    !p.NormalsOfOpacity && !p.ClipsGradients && !p.Mask.Scalars && !kind.Plane &&
    !p.Grid.ChangesGradients();
}

//------------------------------------------------------------------------------
int PacketCaster::RenderTile(int x0, int y0, unsigned int subtiles, const CastImage& image,
  PacketScratch& scratch, int first, Deadline deadline) const
{
  return HWY_DYNAMIC_DISPATCH(CastTileOfAnyType)(
    this->Scene, x0, y0, subtiles, image, scratch, first, deadline);
}

} // namespace ffd

#endif
