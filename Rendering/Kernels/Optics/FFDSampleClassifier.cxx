// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSampleClassifier.h"

#include "FFDAxisMap.h"
#include "FFDDifferences.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Extinction that gives an interval an opacity.
double ExtinctionOver(double opacity, double length)
{
  const double perLength =
    opacity < 1.0 ? -std::log2(1.0 - opacity) : TransferTable::OpaqueExtinction;
  return std::min(perLength / length, 1e30);
}

double Luminance(const double* rgb)
{
  return LuminanceWeights[0] * rgb[0] + LuminanceWeights[1] * rgb[1] + LuminanceWeights[2] * rgb[2];
}

} // namespace

//------------------------------------------------------------------------------
/// Gradients at a sample, found once when they are first asked for.
class SampleClassifier::Point
{
public:
  /// Gradients of what is looked up for opacity, or of the intensity.
  Point(const SampleClassifier& classifier, int component, const glm::dvec3& q,
    const NormalSource& normals, bool ofIntensity = false)
    : Classifier(classifier)
    , Component(component)
    , Q(q)
    , Normals(normals)
    , OfIntensity(ofIntensity)
  {
  }
  const glm::dvec3& GetGradient()
  {
    if (!this->HasGradient)
    {
      this->Gradient =
        this->Classifier.FindGradient(this->Component, this->Q, this->OfIntensity, this->Normals);
      this->HasGradient = true;
    }
    return this->Gradient;
  }
  double GetMagnitude() { return this->Classifier.FindMagnitude(this->GetGradient()); }
  const glm::dvec3& GetPosition() const { return this->Q; }

private:
  const SampleClassifier& Classifier;
  int Component;
  glm::dvec3 Q;
  const NormalSource& Normals;
  bool OfIntensity;
  glm::dvec3 Gradient{ 0.0 };
  bool HasGradient = false;
};

//------------------------------------------------------------------------------
/// The sides of the clipping planes as seen from a sample, the deformation being linear around it.
class SampleClassifier::ClippedSpace
{
public:
  /// `q`: index coordinates of the sample.
  ClippedSpace(
    const std::vector<glm::dvec4>& planes, const glm::dvec3& q, const NormalSource& normals)
    : Q(q)
  {
    if (planes.empty())
    {
      return;
    }
    // Gradients go from rest to deformed space by the transposed inverse of what steps do.
    const glm::dmat3 ofGradients(normals.ToDeformed(glm::dvec3(1.0, 0.0, 0.0)),
      normals.ToDeformed(glm::dvec3(0.0, 1.0, 0.0)), normals.ToDeformed(glm::dvec3(0.0, 0.0, 1.0)));
    const glm::dmat3 ofPlanes = glm::inverse(ofGradients);
    for (const glm::dvec4& plane : planes)
    {
      // The sample is shown, whatever is rounded, and so is what lies along the plane from it.
      const glm::dvec3 normal = ofPlanes * glm::dvec3(plane);
      const double offset = glm::dot(plane, glm::dvec4(normals.GetPosition(), 1.0));
      this->Planes.emplace_back(normal, std::max(offset, 0.0) + Slack * glm::length(normal));
    }
  }

  /// Whether a position, index coordinates, is clipped.
  bool Has(const glm::dvec3& index) const
  {
    return std::any_of(this->Planes.begin(), this->Planes.end(), [&](const glm::dvec4& plane) {
      return glm::dot(glm::dvec3(plane), index - this->Q) + plane.w < 0.0;
    });
  }

private:
  static constexpr double Slack = 1e-3; // voxels

  glm::dvec3 Q;
  std::vector<glm::dvec4> Planes; // of index coordinates relative to the sample
};

//------------------------------------------------------------------------------
/// Color before lighting, and extinction, of which `Factor` is still to be multiplied to the
/// opacity of an interval of the reference length.
struct SampleClassifier::Emission
{
  glm::vec3 Color;
  double Extinction;
  double Factor;

  bool IsVisible() const { return this->Extinction > 0.0 && this->Factor > 0.0; }
  double Opacity(double length) const
  {
    return OpacityOver(this->Extinction, length) * this->Factor;
  }
};

//------------------------------------------------------------------------------
SampleClassifier::SampleClassifier(const ClassifierInputs& inputs)
  : In(inputs)
  , Fetch(SelectSampleFunctions(inputs.Volume.Type, inputs.VolumeInterpolation))
  , FetchNearest(SelectSampleFunctions(inputs.Volume.Type, Interpolation::Nearest))
  , FetchMask(SelectSampleFunctions(inputs.Mask.Volume.Type, Interpolation::Nearest))
  , FetchSecondAxis(SelectSampleFunctions(inputs.SecondAxis.Type, inputs.VolumeInterpolation))
{
  const VolumeView& volume = this->In.Volume;
  for (int c = 0; c < std::min(volume.Components, LargestNumberOfComponents); ++c)
  {
    this->ComponentViews[c] = GetComponent(volume, c);
  }
  const glm::dvec3 edges(glm::length(volume.IndexToData[0]), glm::length(volume.IndexToData[1]),
    glm::length(volume.IndexToData[2]));
  this->MagnitudeScale = (edges.x + edges.y + edges.z) / (3.0 * edges);
  const MaskView& mask = this->In.Mask;
  if (mask.Volume.Scalars && !mask.SameGrid)
  {
    this->ToMask = mask.Volume.DataToIndex * volume.IndexToData;
    this->MaskOffset = mask.Volume.ToIndex(volume.FirstVoxel);
  }
  this->MayHide = this->In.Hidden || (mask.Volume.Scalars && !mask.Labels);
  const OpticalFunctions& functions = *this->In.Functions;
  const ComponentOptics& first = functions.Components[0];
  const auto all = [&](auto has) {
    return std::all_of(functions.Components.begin(), functions.Components.end(), has);
  };
  const bool clipped = !this->In.ClippingPlanes.empty();
  const bool noGradients =
    all([](const ComponentOptics& optics) { return optics.Gradients.IsEmpty(); });
  const bool noLabelGradients = std::all_of(functions.Labels.begin(), functions.Labels.end(),
    [](const LabelOptics& label) { return label.Gradients.IsEmpty(); });
  const bool noPlanes = all([](const ComponentOptics& optics) { return optics.Plane.IsEmpty(); });
  this->ClippedGradients = clipped &&
    (!noGradients || !noLabelGradients || (!noPlanes && !this->In.SecondAxis.Scalars) ||
      first.Shade);
  this->NormalsOfOpacity = this->In.NormalFromOpacity && first.Shade;
}

//------------------------------------------------------------------------------
SampleClassifier::SampleClassifier(const VolumeView& volume, Interpolation interpolation,
  const TransferTable& table, const Shading& material, bool shade)
  : OwnFunctions(new OpticalFunctions)
  , Fetch(SelectSampleFunctions(volume.Type, interpolation))
  , FetchNearest(SelectSampleFunctions(volume.Type, Interpolation::Nearest))
{
  this->In.Volume = volume;
  this->In.VolumeInterpolation = interpolation;
  this->In.Material = &material;
  this->In.Functions = this->OwnFunctions.get();
  this->ComponentViews[0] = GetComponent(volume, 0);
  this->OwnFunctions->Components.resize(1);
  this->OwnFunctions->Components[0].Table = table;
  this->OwnFunctions->Components[0].Shade = shade;
  this->OwnFunctions->Components[0].Surface = material;
}

//------------------------------------------------------------------------------
bool SampleClassifier::IsOneFunction() const
{
  const OpticalFunctions& functions = *this->In.Functions;
  const ComponentOptics& first = functions.Components[0];
  return functions.Kind == ComponentKind::Independent && functions.Components.size() == 1 &&
    first.Gradients.IsEmpty() && first.Plane.IsEmpty() && !this->In.Mask.Volume.Scalars &&
    !this->In.Hidden && this->In.VolumeInterpolation == Interpolation::Linear;
}

//------------------------------------------------------------------------------
/// Dependent components share the functions of the first one.
const ComponentOptics& SampleClassifier::OpticsOf(int component) const
{
  const OpticalFunctions& functions = *this->In.Functions;
  return functions
    .Components[functions.Kind == ComponentKind::Independent ? static_cast<std::size_t>(component)
                                                             : 0];
}

//------------------------------------------------------------------------------
/// The value that is looked up for opacity, and whose gradient is the normal.
double SampleClassifier::DensityOf(int component, const double* values) const
{
  switch (this->In.Functions->Kind)
  {
    case ComponentKind::ColorOpacity:
      return values[1];
    case ComponentKind::Rgb:
      return Luminance(values);
    case ComponentKind::Rgba:
      return values[3];
    case ComponentKind::Independent:
    default:
      return values[component];
  }
}

//------------------------------------------------------------------------------
double SampleClassifier::FindIntensity(int channel, const double* values) const
{
  switch (this->In.Functions->Kind)
  {
    case ComponentKind::ColorOpacity:
    case ComponentKind::Rgba:
      return values[0];
    case ComponentKind::Rgb:
      return Luminance(values);
    case ComponentKind::Independent:
    default:
      return values[channel];
  }
}

//------------------------------------------------------------------------------
bool SampleClassifier::HasDirectColors() const
{
  return this->In.Functions->Kind == ComponentKind::Rgb ||
    this->In.Functions->Kind == ComponentKind::Rgba;
}

//------------------------------------------------------------------------------
/// The color of values that are colors; values that are not numbers are black.
glm::vec3 SampleClassifier::DirectColor(const double* values) const
{
  glm::vec3 color;
  for (int c = 0; c < 3; ++c)
  {
    const double value = values[c] * this->In.Functions->ColorScale;
    color[c] = value > 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f;
  }
  return color;
}

//------------------------------------------------------------------------------
glm::dvec3 SampleClassifier::ToVoxel(const glm::dvec3& q) const
{
  return this->In.Volume.Axes ? this->In.Volume.Axes->ToVoxel(q) : q;
}

//------------------------------------------------------------------------------
glm::dvec3 SampleClassifier::ToIndex(const glm::dvec3& voxel) const
{
  const AxisMap* axes = this->In.Volume.Axes;
  return axes
    ? glm::dvec3(axes->ToIndex(0, voxel.x), axes->ToIndex(1, voxel.y), axes->ToIndex(2, voxel.z))
    : voxel;
}

//------------------------------------------------------------------------------
void SampleClassifier::Values(const glm::dvec3& q, double* values) const
{
  const glm::dvec3 voxel = this->ToVoxel(q);
  if (this->In.Hidden && this->In.Volume.Margin > 0.0 &&
    TouchesHidden(this->In.Volume, *this->In.Hidden, voxel))
  {
    this->FetchNearest.Values(this->In.Volume, voxel, values);
    return;
  }
  this->Fetch.Values(this->In.Volume, voxel, values);
}

//------------------------------------------------------------------------------
double SampleClassifier::MaskAt(const glm::dvec3& q) const
{
  const MaskView& mask = this->In.Mask;
  if (mask.SameGrid)
  {
    return this->FetchMask.Value(mask.Volume, this->ToVoxel(q));
  }
  const glm::dvec3 m = this->ToMask * q + this->MaskOffset;
  const glm::dvec3 beyond = glm::max(-0.5 - m, m - (glm::dvec3(mask.Volume.Dimensions) - 0.5));
  return beyond.x <= 0.0 && beyond.y <= 0.0 && beyond.z <= 0.0
    ? this->FetchMask.Value(mask.Volume, m)
    : 0.0;
}

//------------------------------------------------------------------------------
bool SampleClassifier::FindHidden(const glm::dvec3& q) const
{
  if (this->In.Hidden)
  {
    // Cells of voxels that are points begin at these, voxels that are cells have theirs around.
    const glm::dvec3 cell = glm::floor(this->ToVoxel(q) + this->In.Volume.Margin);
    const glm::ivec3 last = this->In.Hidden->GetCells() - 1;
    if (this->In.Hidden->Has(glm::clamp(glm::ivec3(cell), glm::ivec3(0), last)))
    {
      return true;
    }
  }
  const MaskView& mask = this->In.Mask;
  return mask.Volume.Scalars && !mask.Labels && !(this->MaskAt(q) > 0.0);
}

//------------------------------------------------------------------------------
/// FindDifferences() of a field that is given the functions to fetch scalars with.
template <class Field>
glm::dvec3 SampleClassifier::Difference(const glm::dvec3& voxel, const Field& field) const
{
  return FindDifferences(this->In.Volume, voxel,
    this->In.VolumeInterpolation == Interpolation::Nearest, this->In.Hidden,
    [&](const glm::dvec3& at, bool nearest) {
      return field(nearest ? this->FetchNearest : this->Fetch, at);
    });
}

//------------------------------------------------------------------------------
/// The gradient, by index coordinates, of the value that normals belong to.
glm::dvec3 SampleClassifier::FindGradient(
  int component, const glm::dvec3& q, bool ofIntensity, const NormalSource& normals) const
{
  const OpticalFunctions& functions = *this->In.Functions;
  const glm::dvec3 voxel = this->ToVoxel(q);
  const ClippedSpace clipped(this->In.ClippingPlanes, q, normals);
  const auto of = [&](int c) -> glm::dvec3 {
    const VolumeView& view = this->ComponentViews[c];
    if (!this->In.ClippingPlanes.empty())
    {
      return this->Difference(voxel, [&](const SampleFunctions& fetch, const glm::dvec3& at) {
        return clipped.Has(this->ToIndex(at)) ? this->In.ClippedIntensity : fetch.Value(view, at);
      });
    }
    return view.Axes || this->In.Hidden
      ? this->Difference(voxel,
          [&](const SampleFunctions& fetch, const glm::dvec3& at) { return fetch.Value(view, at); })
      : this->Fetch.Gradient(view, voxel);
  };
  switch (functions.Kind)
  {
    case ComponentKind::ColorOpacity:
      return of(ofIntensity ? 0 : 1);
    case ComponentKind::Rgb:
      return LuminanceWeights[0] * of(0) + LuminanceWeights[1] * of(1) +
        LuminanceWeights[2] * of(2);
    case ComponentKind::Rgba:
      return of(ofIntensity ? 0 : 3);
    case ComponentKind::Independent:
    default:
      return of(component);
  }
}

//------------------------------------------------------------------------------
glm::dvec3 SampleClassifier::FindOpacityGradient(
  int component, const glm::dvec3& q, const NormalSource& normals) const
{
  const ClippedSpace clipped(this->In.ClippingPlanes, q, normals);
  return this->Difference(
    this->ToVoxel(q), [&](const SampleFunctions& fetch, const glm::dvec3& voxel) {
      double values[LargestNumberOfComponents];
      fetch.Values(this->In.Volume, voxel, values);
      if (clipped.Has(this->ToIndex(voxel)))
      {
        std::fill_n(values, LargestNumberOfComponents, this->In.ClippedIntensity);
      }
      return static_cast<double>(
        this->ClassifyValue(component, this->DensityOf(component, values)).a);
    });
}

//------------------------------------------------------------------------------
double SampleClassifier::FindMagnitude(const glm::dvec3& gradient) const
{
  const double magnitude = glm::length(gradient * this->MagnitudeScale);
  return std::isnan(magnitude) ? 0.0 : magnitude;
}

//------------------------------------------------------------------------------
SampleClassifier::Emission SampleClassifier::FindEmission(
  int component, const glm::dvec3& q, const double* values, Point& point) const
{
  const OpticalFunctions& functions = *this->In.Functions;
  const ComponentOptics& optics = this->OpticsOf(component);
  const double density = this->DensityOf(component, values);
  Emission emission{ glm::vec3(0.0f), 0.0, 1.0 };
  if (!optics.Plane.IsEmpty())
  {
    double second;
    if (this->In.SecondAxis.Scalars)
    {
      second = this->FetchSecondAxis.Value(this->In.SecondAxis, this->ToVoxel(q));
    }
    else
    {
      second = point.GetMagnitude();
    }
    glm::vec4 texel = optics.Plane.Lookup(density, second);
    emission.Extinction =
      texel.a > 0.0f ? ExtinctionOver(texel.a, optics.Table.GetUnitDistance()) : 0.0;
    if (functions.Kind == ComponentKind::ColorOpacity)
    {
      texel = optics.Plane.Lookup(values[0], second);
    }
    emission.Color = glm::vec3(texel);
  }
  else
  {
    const TransferTable::Sample sample = optics.Table.Lookup(density);
    emission.Extinction = sample.Extinction;
    if (emission.Extinction > 0.0 && !optics.Gradients.IsEmpty())
    {
      emission.Factor = optics.Gradients(point.GetMagnitude());
    }
    emission.Color = functions.Kind == ComponentKind::ColorOpacity
      ? functions.Colors.Lookup(values[0]).Color
      : sample.Color;
  }
  if (this->HasDirectColors())
  {
    emission.Color = this->DirectColor(values);
  }
  return emission;
}

//------------------------------------------------------------------------------
SampleClassifier::Emission SampleClassifier::FindLabelEmission(
  const LabelOptics& label, const double* values, Point& point) const
{
  const TransferTable::Sample sample = label.Table.Lookup(this->DensityOf(0, values));
  Emission emission{ sample.Color, sample.Extinction, 1.0 };
  if (emission.Extinction > 0.0 && !label.Gradients.IsEmpty())
  {
    emission.Factor = label.Gradients(point.GetMagnitude());
  }
  return emission;
}

//------------------------------------------------------------------------------
glm::vec3 SampleClassifier::LitColor(
  int component, const glm::vec3& color, Point& point, const NormalSource& normals) const
{
  const ComponentOptics& optics = this->OpticsOf(component);
  if (!optics.Shade)
  {
    return color;
  }
  const Shading& material = *this->In.Material;
  const glm::dvec3 gradient = material.GetGradientToLights() *
    normals.ToDeformed(this->In.NormalFromOpacity
        ? this->FindOpacityGradient(component, point.GetPosition(), normals)
        : point.GetGradient());
  const double magnitude = glm::length(gradient);
  const glm::dvec3 normal =
    magnitude > 0.0 && std::isfinite(magnitude) ? -gradient / magnitude : glm::dvec3(0.0);
  return material.Shade(optics.Surface, color, material.GetToLights() * normals.GetPosition(),
    normal, glm::normalize(material.GetToLights() * normals.GetToEye()));
}

//------------------------------------------------------------------------------
SampleClassifier::Appearance SampleClassifier::ToAppearance(const Emission& emission) const
{
  const double length = this->In.ReferenceLength;
  return { emission.Color,
    static_cast<float>(emission.Factor == 1.0 ? emission.Extinction
                                              : ExtinctionOver(emission.Opacity(length), length)) };
}

//------------------------------------------------------------------------------
SampleClassifier::Appearance SampleClassifier::Classify(
  const glm::dvec3& q, const double* values, const NormalSource& normals) const
{
  const OpticalFunctions& functions = *this->In.Functions;
  if (functions.Components.size() > 1)
  {
    return this->ClassifyIndependent(q, values, normals);
  }
  Point point(*this, 0, q, normals);
  const MaskView& mask = this->In.Mask;
  const LabelOptics* label = mask.Volume.Scalars && mask.Labels && mask.BlendFactor > 0.0f
    ? functions.FindLabel(this->MaskAt(q))
    : nullptr;
  Emission emission;
  if (!label)
  {
    emission = this->FindEmission(0, q, values, point);
  }
  else
  {
    emission = this->FindLabelEmission(*label, values, point);
    if (mask.BlendFactor < 1.0f)
    {
      const Emission base = this->FindEmission(0, q, values, point);
      const double length = this->In.ReferenceLength;
      const double f = mask.BlendFactor;
      emission.Color = glm::mix(base.Color, emission.Color, mask.BlendFactor);
      emission.Extinction =
        ExtinctionOver((1.0 - f) * base.Opacity(length) + f * emission.Opacity(length), length);
      emission.Factor = 1.0;
    }
  }
  if (!emission.IsVisible())
  {
    return { emission.Color, 0.0f };
  }
  emission.Color = this->LitColor(0, emission.Color, point, normals);
  return this->ToAppearance(emission);
}

//------------------------------------------------------------------------------
SampleClassifier::Appearance SampleClassifier::ClassifyIndependent(
  const glm::dvec3& q, const double* values, const NormalSource& normals) const
{
  const std::vector<ComponentOptics>& components = this->In.Functions->Components;
  const double length = this->In.ReferenceLength;
  glm::vec3 color(0.0f);
  double sum = 0.0;
  double squares = 0.0;
  for (int c = 0; c < static_cast<int>(components.size()); ++c)
  {
    Point point(*this, c, q, normals);
    Emission emission = this->FindEmission(c, q, values, point);
    emission.Factor *= components[static_cast<std::size_t>(c)].Weight;
    if (emission.IsVisible())
    {
      const double opacity = emission.Opacity(length);
      color += static_cast<float>(opacity) * this->LitColor(c, emission.Color, point, normals);
      sum += opacity;
      squares += opacity * opacity;
    }
  }
  if (!(sum > 0.0))
  {
    return { color, 0.0f };
  }
  const double opacity = squares / sum;
  return { color / static_cast<float>(opacity),
    static_cast<float>(ExtinctionOver(opacity, length)) };
}

//------------------------------------------------------------------------------
glm::vec4 SampleClassifier::ClassifyValue(int component, double value) const
{
  const ComponentOptics& optics = this->OpticsOf(component);
  if (!optics.Plane.IsEmpty())
  {
    return optics.Plane.Lookup(value, 1e300);
  }
  const TransferTable::Sample sample = optics.Table.Lookup(value);
  return glm::vec4(sample.Color,
    static_cast<float>(
      OpacityOver(static_cast<double>(sample.Extinction), optics.Table.GetUnitDistance())));
}

//------------------------------------------------------------------------------
glm::vec4 SampleClassifier::ClassifyValues(int channel, const double* values) const
{
  const OpticalFunctions& functions = *this->In.Functions;
  glm::vec4 color = this->ClassifyValue(channel, this->DensityOf(channel, values));
  if (this->HasDirectColors())
  {
    color = glm::vec4(this->DirectColor(values), color.a);
  }
  else if (functions.Kind == ComponentKind::ColorOpacity)
  {
    const TransferPlane& plane = functions.Components[0].Plane;
    color = glm::vec4(plane.IsEmpty() ? functions.Colors.Lookup(values[0]).Color
                                      : glm::vec3(plane.Lookup(values[0], 1e300)),
      color.a);
  }
  return color;
}

//------------------------------------------------------------------------------
glm::vec3 SampleClassifier::Light(
  int channel, const glm::dvec3& q, const glm::vec3& color, const NormalSource& normals) const
{
  Point point(*this, channel, q, normals, true);
  return this->LitColor(channel, color, point, normals);
}

} // namespace ffd
