// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketOptics.h"

#include "FFDRounding.h"
#include "FFDSingleArrays.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

namespace ffd
{
namespace
{

/// The largest specular power that is found by multiplications.
constexpr float LargestWholePower = 128.0f;

/// Of single precision.
constexpr float LargestBelowOne = 1.0f - 0.5f * std::numeric_limits<float>::epsilon();

/// Highlights below this are invisible, and far above denormal numbers.
constexpr float SmallestHighlight = 1e-20f;

/// Whether 32-bit offsets lead over the voxels of the second axis of a two-dimensional transfer
/// function, of which four and more lie side by side.
bool IsAxisInReach(const VolumeView& v)
{
  return v.Increments[0] == 1 && v.Dimensions.x >= 4 &&
    static_cast<double>(v.Increments[2]) * v.Dimensions.z * SizeOf(v.Type) <= LargestReach;
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
  const double low = AsFetched(scene.Volume, component, table.GetLow());
  const double scale = table.GetScale() / scene.Volume.Scale[component];
  const double length = scene.Sampling == PacketSampling::Composite
    ? static_cast<double>(scene.OpacityLength)
    : table.GetUnitDistance();
  scene.Table.Add({ &table, low, scale, length, !scene.ByExtinctions });
}

/// Whether opacities of composited samples are more than those of one table.
bool WeighsOpacities(const SampleClassifier& classifier, const FrameKind& kind)
{
  const OpticalFunctions& functions = classifier.GetFunctions();
  const auto hasGradients = [](const auto& optics) { return !optics.Gradients.IsEmpty(); };
  const bool labeled = kind.Masked && classifier.GetMask().Labels;
  return kind.Plane || functions.Components.size() > 1 ||
    !functions.Components[0].Plane.IsEmpty() || hasGradients(functions.Components[0]) ||
    (labeled &&
      (classifier.GetMask().BlendFactor < 1.0f ||
        std::any_of(functions.Labels.begin(), functions.Labels.end(), hasGradients)));
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
  p.InReach = static_cast<double>(p.RowIncrement) * p.Dimensions[1] * p.Dimensions[2] <=
    scene.Settings.LargestReach;
  if (mask.Blocks)
  {
    p.Blocks = mask.Blocks->GetLabels();
    p.BlocksPerRow = mask.Blocks->GetSize().x;
    p.BlocksPerSlice = mask.Blocks->GetSize().x * mask.Blocks->GetSize().y;
  }
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

/// The two-dimensional transfer function of one entry of OpticalFunctions::Components, over values
/// of `component` of the voxels.
PacketPlane MakePlane(const SampleClassifier& classifier, const ComponentOptics& optics,
  const PacketVolume& v, int component)
{
  const TransferPlane& plane = optics.Plane;
  PacketPlane p;
  p.Intervals = plane.GetIntervals().data();
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
  Copy(material.Diffuse * light.Diffuse, packet.Diffuse);
  Copy(material.Specular * light.Specular, packet.Specular);
  Copy(light.Attenuation, packet.Attenuation);
  packet.Attenuates = light.Attenuation != glm::dvec3(1.0, 0.0, 0.0);
  const auto isSome = [](float part) { return part != 0.0f; };
  packet.HasHighlight = std::any_of(std::begin(packet.Specular), std::end(packet.Specular), isSome);
  const auto isGray = [](const float(&c)[3]) { return c[0] == c[1] && c[1] == c[2]; };
  packet.IsGray = isGray(packet.Diffuse) && isGray(packet.Specular);
  return packet;
}

/// `reflectance`: of one component.
PacketSurface MakeSurface(
  const Shading& material, const Reflectance& reflectance, const glm::dvec3& center)
{
  PacketSurface surface;
  const float power = reflectance.SpecularPower;
  surface.SpecularPower = power;
  surface.SmallestCosine =
    power > 0.0f ? std::min(std::pow(SmallestHighlight, 1.0f / power), LargestBelowOne) : 0.0f;
  // To the power of 0 what light does not reach would be 1, too.
  if (power == std::floor(power) && power > 0.0f && power <= LargestWholePower)
  {
    surface.WholeSpecularPower = static_cast<int>(power);
  }
  for (const Light& light : material.Lights)
  {
    const glm::vec3 ambient = reflectance.Ambient * light.Ambient;
    const PacketLight packet = MakePacketLight(light, reflectance, center);
    for (int c = 0; c < 3; ++c)
    {
      surface.Ambient[c] += ambient[c];
      if (light.Headlight)
      {
        surface.Headlights.Diffuse[c] += packet.Diffuse[c];
        surface.Headlights.Specular[c] += packet.Specular[c];
      }
    }
    if (!light.Headlight)
    {
      surface.Lights.push_back(packet);
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
    packet.Pieces = FindPiecewiseFactors(opacity.GetFactors());
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

/// Finds the range of values of one component outside of which nothing is visible.
ValueRange FindVisibleRange(
  const CastScene& scene, const OpticalFunctions& functions, const PacketScene& p)
{
  ValueRange range = p.Plane.Intervals ? FindVisibleRange(functions.Components[0].Plane, p.Plane)
                                       : FindVisibleRange(*scene.Table, p.Table.GetRange(0));
  AddVisibleLabels(functions, p, range);
  return range;
}

/// A limit of values as it is fetched, finite: floats are fetched as they are.
float LimitAsFetched(const CastScene& scene, const PacketScene& p, int component, double value)
{
  constexpr double largest = std::numeric_limits<float>::max();
  return scene.Volume.Type == ScalarType::Float32
    ? static_cast<float>(std::clamp(value, -largest, largest))
    : ToFinite(AsFetched(p.Volume, component, value));
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
    const auto fetched = [&](double value) { return LimitAsFetched(scene, p, component, value); };
    PacketChannel channel;
    channel.Component = component;
    channel.Low = fetched(blend.Low[i]);
    channel.High = fetched(blend.High[i]);
    channel.AverageMin = fetched(blend.AverageMin);
    channel.AverageMax = fetched(blend.AverageMax);
    channel.Weight = static_cast<float>(blend.Weight[i]);
    channel.AdditiveDistance = static_cast<float>(blend.UnitDistance[i]);
    p.Channels.push_back(channel);
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
  return HasShortScalars(v) ? RangeOfFewBytes : range * v.Scale[component];
}

/// What gradients are multiplied by, of which only the direction counts.
struct GradientScale
{
  double Factor = 1.0;
  bool LeavesFar = false; ///< see PacketScene::FarGradients
};

/// Finds a scale by which the squares of gradients between values that functions tell apart are not
/// beyond single precision, nor any gradient itself: values may lie far beyond those, as what
/// stands for no data does.
GradientScale FindGradientScale(
  const CastScene& scene, const SampleClassifier& classifier, const PacketScene& p)
{
  constexpr double LargestGradient = 1e15;
  constexpr double LargestOfWide = 1e18;
  constexpr double LargestOfAll = 1e36;
  constexpr double LargestFactor = 1e35;
  constexpr double NearRange = 100.0;
  const TransferTable& table = *scene.Table;
  const int component =
    p.Volume.Components > 1 ? FindDensityComponent(classifier.GetFunctions().Kind, 0) : 0;
  const bool ofValues = !classifier.HasNormalsOfOpacity();
  double range = ofValues
    ? static_cast<double>(table.GetSize() - 1) / table.GetScale() * p.Volume.Scale[component]
    : 1.0;
  for (const float clipped : p.ClippedValues)
  {
    range = std::max(range, static_cast<double>(std::abs(clipped)));
  }
  double most = range;
  for (int c = 0; ofValues && scene.Ranges && c < p.Volume.Components; ++c)
  {
    const MinMaxBlocks::Limits& limits = (*scene.Ranges)[static_cast<std::size_t>(c)];
    // What is fetched stays within LargestSingle, but for floats.
    constexpr double Largest = std::numeric_limits<float>::max();
    most = std::max(most, std::min((limits.Max - limits.Min) * p.Volume.Scale[c], Largest));
  }
  const bool wide = ofValues && range > WidestFunctions * p.Volume.Scale[component];
  const double largest = wide ? LargestOfWide : LargestGradient;
  const glm::dmat3& ofData = scene.Material.GetGradientToLights();
  const glm::dmat3 ofIndex = ofData * glm::transpose(scene.Volume.DataToIndex);
  double scale = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const double factor = glm::length(ofIndex[a]);
    scale = std::min({ scale, largest / (range * factor), LargestOfAll / (most * factor),
      LargestFactor / factor, LargestFactor / glm::length(ofData[a]) });
  }
  return { std::isfinite(scale) && scale > 0.0 ? scale : 1.0,
    (ofValues && !scene.Ranges) || wide || most > NearRange * range };
}

} // namespace

//------------------------------------------------------------------------------
void SetOptics(
  const CastScene& scene, const SampleClassifier& classifier, const FrameKind& kind, PacketScene& p)
{
  const int component =
    kind.Components ? FindDensityComponent(classifier.GetFunctions().Kind, 0) : 0;
  const bool deformed = p.Settings.Opacity == OpacityLength::Deformed;
  const bool weighs = WeighsOpacities(classifier, kind);
  const double length =
    deformed && !weighs ? p.Settings.SampleDistance : classifier.GetReferenceLength();
  p.ByExtinctions = kind.Composites && !deformed && !weighs;
  p.OpacityLength = static_cast<float>(length);
  p.OpacityIsInterval = deformed && p.Settings.SampleDistance == length;
  AddTable(*scene.Table, component, p);
  if (kind.Masked)
  {
    SetMask(classifier, p);
  }
  p.Grid = MakePacketGrid(scene.Volume, classifier.GetHidden());
  p.HidesSamples = p.Grid.Hidden || (p.Mask.Scalars && !p.Mask.Labels);
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
  p.OpacityByGradient = p.Gradients.Factors || !p.Mask.GradientRanges.empty() ||
    (kind.Plane && !p.Plane.SecondAxis.Scalars);
}

//------------------------------------------------------------------------------
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

//------------------------------------------------------------------------------
void SetBlending(
  const CastScene& scene, const OpticalFunctions& functions, const FrameKind& kind, PacketScene& p)
{
  // Of several components only surfaces have values here: of the one that they are of.
  const int component =
    kind.Components && functions.Kind == ComponentKind::Independent ? scene.Blend.IsoComponent : 0;
  const auto asFetched = [&](double value) { return AsFetched(p.Volume, component, value); };
  const auto fetched = [&](double value) { return LimitAsFetched(scene, p, component, value); };
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

//------------------------------------------------------------------------------
void SetClippedValues(const CastScene& scene, const SampleClassifier& classifier, PacketScene& p)
{
  // So far away from all others that gradients point from one to them; the squares of their
  // differences are numbers in single precision.
  constexpr double Far = 1e6;
  p.ClipsGradients = classifier.ClipsGradients();
  for (int c = 0; c < p.Volume.Components && p.ClipsGradients; ++c)
  {
    const double far = Far * FindRangeOfValues(scene, p.Volume, c);
    const double low = AsFetched(p.Volume, c, scene.Table->GetLow());
    const double clipped = AsFetched(p.Volume, c, classifier.GetClippedIntensity());
    p.ClippedValues[c] = ToFinite(std::clamp(clipped, low - far, low + far));
  }
}

//------------------------------------------------------------------------------
void SetShading(const CastScene& scene, const CastSettings& settings,
  const SampleClassifier& classifier, PacketScene& p)
{
  p.Shade = settings.Shade;
  p.TwoSided = scene.Material.TwoSided;
  const glm::dmat3& toLights = scene.Material.GetToLights();
  CopyRows(toLights, p.LocalToLights);
  const GradientScale scale = FindGradientScale(scene, classifier, p);
  p.FarGradients = scale.LeavesFar;
  const glm::dmat3 toSpace = scale.Factor * scene.Material.GetGradientToLights();
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
  p.NormalsOfOpacity = p.Shade && classifier.HasNormalsOfOpacity();
  if (p.NormalsOfOpacity)
  {
    p.Table.AddOpacities();
  }
}

} // namespace ffd
