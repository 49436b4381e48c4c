// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDKernelViews.h"

#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

namespace ffd
{
namespace
{

/// Entries of a transfer table: at least, and at most (then it takes 320 kB).
constexpr int SmallestTable = 1024;
constexpr int LargestTable = 16384;

/// Entries of the table of a gradient opacity.
constexpr int GradientTable = 1024;

/// Labels of a label map.
constexpr int LargestLabel = 65535;

glm::dvec3 Normalized(const glm::dvec3& d)
{
  const double length = glm::length(d);
  return length > 0.0 && std::isfinite(length) ? d / length : glm::dvec3(0.0, 0.0, -1.0);
}

glm::dvec3 Direction(const double from[3], const double to[3])
{
  return Normalized(glm::dvec3(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
}

glm::vec3 Scaled(const double colour[3], double intensity)
{
  return glm::vec3(colour[0] * intensity, colour[1] * intensity, colour[2] * intensity);
}

/// In the space of Shading: the world moved by `origin`, in the unit of length `unit`.
Light MakeLight(vtkLight* source, const glm::dvec3& origin, double unit)
{
  Light light;
  light.Headlight = source->LightTypeIsHeadlight() && !source->GetPositional();
  double position[3];
  double focus[3];
  source->GetTransformedPosition(position);
  source->GetTransformedFocalPoint(focus);
  light.Axis = Direction(position, focus);
  light.Towards = -light.Axis;
  light.Position = (glm::dvec3(position[0], position[1], position[2]) - origin) / unit;
  light.Positional = source->GetPositional() != 0;
  const double intensity = source->GetIntensity();
  light.Ambient = Scaled(source->GetAmbientColor(), intensity);
  light.Diffuse = Scaled(source->GetDiffuseColor(), intensity);
  light.Specular = Scaled(source->GetSpecularColor(), intensity);
  const double* attenuation = source->GetAttenuationValues();
  light.Attenuation =
    glm::dvec3(attenuation[0], attenuation[1] * unit, attenuation[2] * unit * unit);
  // As in OpenGL, a cone of more than 90 degrees is none.
  if (source->GetConeAngle() <= 90.0)
  {
    light.ConeCosine = std::cos(vtkMath::RadiansFromDegrees(source->GetConeAngle()));
    light.ConeExponent = source->GetExponent();
  }
  return light;
}

} // namespace

//------------------------------------------------------------------------------
glm::dmat4 ToMatrix(vtkMatrix4x4* matrix)
{
  glm::dmat4 m;
  for (int row = 0; row < 4; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      m[column][row] = matrix->GetElement(row, column);
    }
  }
  return m;
}

namespace
{

/// Functions of a table; what is null is not looked up: opacity 0, black.
struct TableFunctions
{
  vtkPiecewiseFunction* Opacity = nullptr;
  vtkColorTransferFunction* Colour = nullptr;
  vtkPiecewiseFunction* Gray = nullptr; // in the place of Colour
  double Unit = 1.0;

  void GetRange(double& first, double& last) const
  {
    first = std::numeric_limits<double>::infinity();
    last = -first;
    const auto add = [&](const double* range) {
      first = std::min(first, range[0]);
      last = std::max(last, range[1]);
    };
    if (this->Opacity)
    {
      add(this->Opacity->GetRange());
    }
    if (this->Gray)
    {
      add(this->Gray->GetRange());
    }
    else if (this->Colour)
    {
      add(this->Colour->GetRange());
    }
  }
  bool IsClamped() const
  {
    return (!this->Opacity || this->Opacity->GetClamping() != 0) &&
      (!this->Gray || this->Gray->GetClamping() != 0) &&
      (this->Gray || !this->Colour || this->Colour->GetClamping() != 0);
  }
  int EstimateSamples(double lo, double hi) const
  {
    int most = 0;
    if (this->Opacity)
    {
      most = std::max(most, this->Opacity->EstimateMinNumberOfSamples(lo, hi));
    }
    if (this->Gray)
    {
      most = std::max(most, this->Gray->EstimateMinNumberOfSamples(lo, hi));
    }
    else if (this->Colour)
    {
      most = std::max(most, this->Colour->EstimateMinNumberOfSamples(lo, hi));
    }
    return most;
  }
  void Tabulate(double lo, double hi, int size, float* rgb, float* opacity) const
  {
    const std::size_t n = static_cast<std::size_t>(size);
    std::fill_n(rgb, 3 * n, 0.0f);
    std::fill_n(opacity, n, 0.0f);
    if (this->Opacity)
    {
      this->Opacity->GetTable(lo, hi, size, opacity);
    }
    if (this->Gray)
    {
      std::vector<float> grays(n);
      this->Gray->GetTable(lo, hi, size, grays.data());
      for (std::size_t i = 0; i < n; ++i)
      {
        std::fill_n(&rgb[3 * i], 3, grays[i]);
      }
    }
    else if (this->Colour && !this->IsLogarithmic())
    {
      this->Colour->GetTable(lo, hi, size, rgb);
    }
    else if (this->Colour)
    {
      // Over a range that is not positive there is no table; the first colour holds there.
      const double least = this->Colour->GetRange()[0];
      for (int i = 0; i < size; ++i)
      {
        const double x = lo + (hi - lo) * i / (size - 1);
        double colour[3];
        this->Colour->GetColor(x > 0.0 ? x : least, colour);
        std::copy_n(colour, 3, &rgb[3 * static_cast<std::size_t>(i)]);
      }
    }
  }
  bool IsLogarithmic() const
  {
    return !this->Gray && this->Colour && this->Colour->GetScale() == VTK_CTF_LOG10;
  }
};

/**
 * Table of functions over the range of a component. It does not depend on the scalar type: the same
 * values look the same as bytes and as floats.
 */
TransferTable MakeTable(const TableFunctions& functions, const MinMaxBlocks::Limits& range)
{
  double lo = range.Min;
  double hi = range.Max;
  // Beyond their last points clamped functions are constant: spend no entries there, so that a
  // few extreme scalars do not coarsen the table. Colours below and above the range are constant
  // there, too, but begin just beyond the points.
  double first;
  double last;
  functions.GetRange(first, last);
  if (functions.IsClamped() && first <= last)
  {
    const bool beyond = !functions.Gray && functions.Colour &&
      (functions.Colour->GetUseBelowRangeColor() || functions.Colour->GetUseAboveRangeColor());
    const double margin = beyond ? std::max(1.0, 1e-3 * (last - first)) : 0.0;
    lo = std::min(std::max(lo, first - margin), hi);
    hi = std::max(std::min(hi, last + margin), lo);
  }
  if (!(hi - lo > 1e-12 * std::max(std::abs(lo), std::abs(hi))))
  {
    hi = lo + std::max(1.0, std::abs(lo));
  }
  // Steps are equal, logarithmic functions bend most at their small end.
  int size = functions.IsLogarithmic()
    ? LargestTable
    : std::clamp(functions.EstimateSamples(lo, hi), SmallestTable, LargestTable);
  const double width = std::ceil(hi) - std::floor(lo);
  if (hi - lo >= 1.0 && width < LargestTable)
  {
    // A whole number of entries a unit: whole scalars, and the points of functions that lie there,
    // are met exactly.
    lo = std::floor(lo);
    hi = lo + width;
    const int perUnit = std::max(1, static_cast<int>(size / width));
    size = perUnit * static_cast<int>(width) + 1;
  }

  std::vector<float> opacities(static_cast<std::size_t>(size));
  std::vector<float> colours(3 * static_cast<std::size_t>(size));
  functions.Tabulate(lo, hi, size, colours.data(), opacities.data());
  return TransferTable(
    lo, hi, static_cast<std::size_t>(size), colours.data(), opacities.data(), functions.Unit);
}

/// Copies of functions that are constant beyond their ranges.
class NativeFunctions
{
public:
  vtkPiecewiseFunction* Truncate(vtkPiecewiseFunction* function) { return this->Copy(function); }
  vtkColorTransferFunction* Truncate(vtkColorTransferFunction* function)
  {
    vtkColorTransferFunction* copy = this->Copy(function);
    if (copy)
    {
      copy->SetUseBelowRangeColor(0);
      copy->SetUseAboveRangeColor(0);
    }
    return copy;
  }

private:
  template <typename Function>
  Function* Copy(Function* function)
  {
    if (!function)
    {
      return nullptr;
    }
    auto copy = vtkSmartPointer<Function>::New();
    copy->DeepCopy(function);
    copy->ClampingOn();
    this->Copies.push_back(copy);
    return copy;
  }

  std::vector<vtkSmartPointer<vtkObject>> Copies;
};

/// Of a function without any effect: none.
GradientOpacity MakeGradientOpacity(
  vtkPiecewiseFunction* function, const MinMaxBlocks::Limits& range)
{
  // Without clamping it is 0 beyond its last points.
  bool effective = function && !function->GetClamping();
  for (int i = 0; function && i < function->GetSize(); ++i)
  {
    double node[4];
    function->GetNodeValue(i, node);
    effective = effective || node[1] != 1.0;
  }
  if (!effective)
  {
    return GradientOpacity();
  }
  // As VTK's mappers: magnitudes up to a quarter of the range of the scalars matter.
  const double largest = range.Max > range.Min ? 0.25 * (range.Max - range.Min) : 0.25;
  std::vector<float> factors(GradientTable);
  function->GetTable(0.0, largest, GradientTable, factors.data());
  for (float& factor : factors)
  {
    factor = factor > 0.0f ? std::min(factor, 1.0f) : 0.0f;
  }
  return GradientOpacity(std::move(factors), largest);
}

std::string NameComponent(int component, const ScalarFacts& facts)
{
  return facts.Kind == ComponentKind::Independent && facts.Ranges.size() > 1
    ? " for component " + std::to_string(component)
    : std::string();
}

bool MakePlane(vtkVolumeProperty* property, int component, const MinMaxBlocks::Limits& range,
  const ScalarFacts& facts, TransferPlane& plane, std::string& message)
{
  vtkImageData* image = property->GetTransferFunction2D(component);
  vtkDataArray* texels = image ? image->GetPointData()->GetScalars() : nullptr;
  int dims[3] = { 0, 0, 0 };
  if (image)
  {
    image->GetDimensions(dims);
  }
  const vtkIdType count = static_cast<vtkIdType>(dims[0]) * dims[1];
  if (!texels || texels->GetDataType() != VTK_FLOAT || texels->GetNumberOfComponents() != 4 ||
    count < 1 || texels->GetNumberOfTuples() < count)
  {
    message = "The volume property is set to two-dimensional transfer functions and has none" +
      NameComponent(component, facts) +
      " that can be used: it must be an image of 4 floats (red, green, blue, opacity) a pixel. Set "
      "it with vtkVolumeProperty::SetTransferFunction2D(), or call "
      "vtkVolumeProperty::SetTransferFunctionMode(vtkVolumeProperty::TF_1D).";
    return false;
  }
  MinMaxBlocks::Limits second{ 0.0, range.Max > range.Min ? 0.25 * (range.Max - range.Min) : 0.25 };
  if (facts.HasSecondAxis)
  {
    second = facts.SecondAxis;
  }
  const auto upper = [](const MinMaxBlocks::Limits& limits) {
    return limits.Max > limits.Min ? limits.Max : limits.Min + 1.0;
  };
  plane = TransferPlane(dims[0], dims[1], static_cast<const float*>(texels->GetVoidPointer(0)),
    glm::dvec2(range.Min, second.Min), glm::dvec2(upper(range), upper(second)), facts.Nearest);
  return true;
}

/// Functions of a component of the property, checked.
bool FindTableFunctions(vtkVolumeProperty* property, int component, const ScalarFacts& facts,
  TableFunctions& functions, std::string& message)
{
  functions.Opacity = property->GetScalarOpacity(component);
  const bool gray = property->GetColorChannels(component) == 1;
  functions.Gray = gray ? property->GetGrayTransferFunction(component) : nullptr;
  functions.Colour = gray ? nullptr : property->GetRGBTransferFunction(component);
  functions.Unit = property->GetScalarOpacityUnitDistance(component);
  const std::string which = NameComponent(component, facts);
  if (!functions.Opacity || functions.Opacity->GetSize() < 1)
  {
    message = "The volume property has no scalar opacity function" + which +
      ", or one without points: nothing would be visible. Set one with "
      "vtkVolumeProperty::SetScalarOpacity().";
    return false;
  }
  const bool direct = facts.Kind == ComponentKind::Rgb || facts.Kind == ComponentKind::Rgba;
  if (!direct &&
    (gray ? (!functions.Gray || functions.Gray->GetSize() < 1)
          : (!functions.Colour || functions.Colour->GetSize() < 1)))
  {
    message = "The volume property has no colour function" + which +
      ", or one without points. Set one with vtkVolumeProperty::SetColor().";
    return false;
  }
  if (!(functions.Unit > 0.0) || !std::isfinite(functions.Unit))
  {
    std::ostringstream why;
    why << "The scalar opacity unit distance of the volume property" << which << " is "
        << functions.Unit << "; it must be positive.";
    message = why.str();
    return false;
  }
  return true;
}

} // namespace

//------------------------------------------------------------------------------
MinMaxBlocks::Limits FindDensityRange(const ScalarFacts& facts, int channel)
{
  switch (facts.Kind)
  {
    case ComponentKind::ColourOpacity:
      return facts.Ranges[1];
    case ComponentKind::Rgb:
      return FindIntensityRange(facts, channel);
    case ComponentKind::Rgba:
      return facts.Ranges[3];
    case ComponentKind::Independent:
    default:
      return facts.Ranges[static_cast<std::size_t>(channel)];
  }
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits FindIntensityRange(const ScalarFacts& facts, int channel)
{
  if (facts.Kind != ComponentKind::Rgb)
  {
    return facts.Ranges[static_cast<std::size_t>(channel)];
  }
  MinMaxBlocks::Limits luminance{ 0.0, 0.0 };
  for (std::size_t i = 0; i < 3; ++i)
  {
    luminance.Min += LuminanceWeights[i] * facts.Ranges[i].Min;
    luminance.Max += LuminanceWeights[i] * facts.Ranges[i].Max;
  }
  return luminance;
}

//------------------------------------------------------------------------------
bool FindComponentKind(vtkVolumeProperty* property, int components, ScalarType type,
  ComponentKind& kind, std::string& message)
{
  if (components > VTK_MAX_VRCOMP)
  {
    message = "The scalars have " + std::to_string(components) +
      " components; at most 4 can be rendered. Choose another array, or extract components with "
      "vtkImageExtractComponents.";
    return false;
  }
  kind = ComponentKind::Independent;
  if (components > 1 && !property->GetIndependentComponents())
  {
    kind = components == 2 ? ComponentKind::ColourOpacity
      : components == 3    ? ComponentKind::Rgb
                           : ComponentKind::Rgba;
  }
  if ((kind == ComponentKind::Rgb || kind == ComponentKind::Rgba) && type != ScalarType::UInt8 &&
    type != ScalarType::UInt16 && type != ScalarType::Float32 && type != ScalarType::Float64)
  {
    message = "Dependent components that are colours must be unsigned char, unsigned short, float "
              "or double (0 to 1). Convert them with vtkImageShiftScale, or call "
              "vtkVolumeProperty::IndependentComponentsOn().";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool MakeOpticalFunctions(vtkVolumeProperty* property, const ScalarFacts& facts,
  OpticalFunctions& functions, std::string& message)
{
  functions = OpticalFunctions();
  functions.Kind = facts.Kind;
  const bool planes = property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D;
  const bool independent = facts.Kind == ComponentKind::Independent;
  if (facts.HasLabels && independent && facts.Ranges.size() > 1)
  {
    message = "A label map needs one component, or dependent ones: there are " +
      std::to_string(facts.Ranges.size()) +
      " independent components. Remove it with SetMaskInput(nullptr), or make it binary with "
      "SetMaskTypeToBinary().";
    return false;
  }

  functions.Components.resize(independent ? facts.Ranges.size() : 1);
  for (int c = 0; c < static_cast<int>(functions.Components.size()); ++c)
  {
    ComponentOptics& optics = functions.Components[static_cast<std::size_t>(c)];
    TableFunctions tables;
    // In it opacity is looked up.
    const MinMaxBlocks::Limits range = FindDensityRange(facts, c);
    if (!FindTableFunctions(property, c, facts, tables, message))
    {
      return false;
    }
    NativeFunctions native;
    if (facts.NativeColours)
    {
      tables.Colour = native.Truncate(tables.Colour);
      tables.Gray = native.Truncate(tables.Gray);
    }
    if (facts.NativeOpacities)
    {
      tables.Opacity = native.Truncate(tables.Opacity);
    }
    TableFunctions used = tables;
    if (!independent)
    {
      used.Colour = nullptr;
      used.Gray = nullptr;
    }
    optics.Table = MakeTable(used, range);
    if (facts.Kind == ComponentKind::ColourOpacity)
    {
      used = tables;
      used.Opacity = nullptr;
      functions.Colours = MakeTable(used, facts.Ranges[0]);
    }
    if (planes && !MakePlane(property, c, range, facts, optics.Plane, message))
    {
      return false;
    }
    if (!planes && property->HasGradientOpacity(c))
    {
      vtkPiecewiseFunction* gradient = property->GetGradientOpacity(c);
      optics.Gradients =
        MakeGradientOpacity(facts.NativeGradients ? native.Truncate(gradient) : gradient, range);
    }
    optics.Weight = static_cast<float>(property->GetComponentWeight(c));
    // Of all components, as VTK's mappers have it.
    optics.Shade = property->GetShade(0) != 0;
    optics.Surface.Ambient = static_cast<float>(property->GetAmbient(c));
    optics.Surface.Diffuse = static_cast<float>(property->GetDiffuse(c));
    optics.Surface.Specular = static_cast<float>(property->GetSpecular(c));
    optics.Surface.SpecularPower = static_cast<float>(property->GetSpecularPower(c));
    if (facts.HasLabels)
    {
      for (int label : property->GetLabelMapLabels())
      {
        if (label < 1 || label > LargestLabel)
        {
          continue;
        }
        TableFunctions ofLabel = tables;
        if (vtkColorTransferFunction* colour = property->GetLabelColor(label))
        {
          ofLabel.Colour = colour;
          ofLabel.Gray = nullptr;
        }
        if (vtkPiecewiseFunction* opacity = property->GetLabelScalarOpacity(label))
        {
          ofLabel.Opacity = opacity;
        }
        LabelOptics made;
        made.Table = MakeTable(ofLabel, range);
        made.Gradients = MakeGradientOpacity(property->GetLabelGradientOpacity(label), range);
        functions.LabelIndices.resize(
          std::max(functions.LabelIndices.size(), static_cast<std::size_t>(label) + 1), -1);
        functions.LabelIndices[static_cast<std::size_t>(label)] =
          static_cast<int>(functions.Labels.size());
        functions.Labels.push_back(std::move(made));
      }
    }
  }
  functions.ColourScale = FindColourScale(facts.Type);
  return true;
}

//------------------------------------------------------------------------------
CameraView MakeCameraView(
  vtkRenderer* renderer, const vtkFFDImageRegion& region, const glm::dmat4& dataToWorld)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const glm::dvec2 viewport(region.Viewport);
  const glm::dvec2 origin(region.Origin);
  CameraView view;
  // The composite matrix is never that of an eye.
  const glm::dmat4 worldToNdc = region.Stereo
    ? ToMatrix(camera->GetProjectionTransformMatrix(region.Aspect, -1.0, 1.0)) *
      ToMatrix(camera->GetModelViewTransformMatrix())
    : ToMatrix(camera->GetCompositeProjectionTransformMatrix(region.Aspect, -1.0, 1.0));
  view.DataToNdc = worldToNdc * dataToWorld;
  view.NdcToData = glm::inverse(view.DataToNdc);
  view.ImageSize = region.Rays;
  view.PixelOrigin = glm::ivec2(glm::floor(origin / region.Step));
  view.NdcPerPixel = 2.0 * region.Step / viewport;
  view.NdcOrigin = 2.0 * origin / viewport - 1.0;
  const double* eye = camera->GetPosition();
  view.Eye =
    glm::dvec3(glm::inverse(dataToWorld) * glm::dvec4(glm::dvec3(eye[0], eye[1], eye[2]), 1.0));
  view.Parallel = camera->GetParallelProjection() != 0;
  return view;
}

//------------------------------------------------------------------------------
Shading MakeShading(
  vtkRenderer* renderer, vtkVolumeProperty* property, const glm::dmat4& dataToWorld)
{
  // Gradients are divided by squares: those of volumes that their matrix makes huge or tiny stay
  // within single precision if the unit of length is that of the volume.
  const glm::dmat3 linear(dataToWorld);
  const double unit = std::cbrt(std::abs(glm::determinant(linear)));
  Shading shading;
  shading.SetToLights(linear / unit);
  shading.Ambient = static_cast<float>(property->GetAmbient(0));
  shading.Diffuse = static_cast<float>(property->GetDiffuse(0));
  shading.Specular = static_cast<float>(property->GetSpecular(0));
  shading.SpecularPower = static_cast<float>(property->GetSpecularPower(0));
  shading.TwoSided = renderer->GetTwoSidedLighting() != 0;

  vtkLightCollection* lights = renderer->GetLights();
  double intensity = 1.0; // of the last one
  vtkCollectionSimpleIterator iterator;
  lights->InitTraversal(iterator);
  while (vtkLight* light = lights->GetNextLight(iterator))
  {
    if (light->GetSwitch())
    {
      shading.Lights.push_back(MakeLight(light, glm::dvec3(dataToWorld[3]), unit));
      intensity = light->GetIntensity();
    }
  }
  if (shading.Lights.empty() && lights->GetNumberOfItems() == 0)
  {
    Light headlight;
    headlight.Headlight = true;
    shading.Lights.push_back(headlight);
  }
  // A single headlight of intensity 1 lights the ambient term, too, although the ambient colour of
  // VTK's lights is black: so does vtkGPUVolumeRayCastMapper.
  if (shading.Lights.size() == 1 && shading.Lights[0].Headlight && intensity == 1.0)
  {
    shading.Lights[0].Ambient = glm::vec3(1.0f);
  }
  return shading;
}

} // namespace ffd
