// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDOpticsFromProperty.h"

#include "FFDRounding.h"

#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

namespace ffd
{
namespace
{

/// Entries of the table of a gradient opacity.
constexpr int GradientTable = 1024;

/// Labels of a label map.
constexpr int LargestLabel = 65535;

/**
 * Colors of a function with logarithmic scale. Those that follow a path through the color space are
 * interpolated in one table of VTK, whose steps of the logarithm are equal: VTK looks for the path
 * in each call, which takes hundredths of a second.
 */
class LogarithmicColors
{
public:
  /// For places from `low` to `high`; `low` is positive. Keeps a pointer to the function.
  LogarithmicColors(vtkColorTransferFunction* function, double low, double high)
    : Function(function)
    , Low(low)
  {
    if (function->GetColorSpace() == VTK_CTF_LAB_CIEDE2000 && high > low)
    {
      this->Path.resize(3 * static_cast<std::size_t>(Last + 1));
      function->GetTable(low, high, Last + 1, this->Path.data());
      this->PerDecade = Last / std::log10(high / low);
    }
  }

  void Find(double x, double color[3]) const
  {
    if (this->Path.empty())
    {
      this->Function->GetColor(x, color);
      return;
    }
    const double at =
      std::clamp(this->PerDecade * std::log10(x / this->Low), 0.0, static_cast<double>(Last));
    const int entry = std::min(static_cast<int>(at), Last - 1);
    const double* const from = &this->Path[3 * static_cast<std::size_t>(entry)];
    for (int c = 0; c < 3; ++c)
    {
      color[c] = from[c] + (at - entry) * (from[c + 3] - from[c]);
    }
  }

private:
  static constexpr int Last = 65535;

  vtkColorTransferFunction* Function;
  double Low;
  double PerDecade = 0.0;   ///< steps
  std::vector<double> Path; ///< colors of Last steps, or none
};

/// Functions of a table; what is null is not looked up: opacity 0, black.
struct TableFunctions
{
  vtkPiecewiseFunction* Opacity = nullptr;
  vtkColorTransferFunction* Color = nullptr;
  vtkPiecewiseFunction* Gray = nullptr; // in the place of Color
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
    else if (this->Color)
    {
      add(this->Color->GetRange());
    }
  }
  bool IsClamped() const
  {
    return (!this->Opacity || this->Opacity->GetClamping() != 0) &&
      (!this->Gray || this->Gray->GetClamping() != 0) &&
      (this->Gray || !this->Color || this->Color->GetClamping() != 0);
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
    else if (this->Color)
    {
      most = std::max(most, this->Color->EstimateMinNumberOfSamples(lo, hi));
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
    else if (this->Color && this->HasLogarithmicColors())
    {
      // VTK has no table that reaches numbers which are not positive.
      const double step = (hi - lo) / (size - 1);
      const double least = 1e-3 * std::min(step, this->Color->GetRange()[0]);
      const LogarithmicColors colors(this->Color, std::max(lo, least), hi);
      for (int i = 0; i < size; ++i)
      {
        double color[3];
        colors.Find(std::max(lo + step * i, least), color);
        std::copy_n(color, 3, &rgb[3 * static_cast<std::size_t>(i)]);
      }
    }
    else if (this->Color)
    {
      this->Color->GetTable(lo, hi, size, rgb);
      // Where a table of VTK begins before the first point it is black there.
      const double step = (hi - lo) / (size - 1);
      const double first = std::floor((this->Color->GetRange()[0] - lo) / step);
      for (double i = std::max(0.0, first); i <= std::min(first + 1.0, size - 1.0); ++i)
      {
        const double x = lo + step * i;
        this->Color->GetTable(x, x, 1, &rgb[3 * static_cast<std::size_t>(i)]);
      }
    }
  }
  /// Red, green, blue and opacity at a place.
  std::array<double, 4> Find(double x) const
  {
    std::array<double, 4> found = {};
    if (this->Gray)
    {
      found[0] = this->Gray->GetValue(x);
    }
    else if (this->Color)
    {
      this->Color->GetTable(x, x, 1, found.data());
    }
    found[3] = this->Opacity ? this->Opacity->GetValue(x) : 0.0;
    return found;
  }
  /// Whether a function is logarithmic: VTK's are linear where they begin at 0 or below.
  bool IsLogarithmic() const
  {
    return (this->Opacity && this->Opacity->GetUseLogScale()) || this->HasLogarithmicColors();
  }

private:
  bool HasLogarithmicColors() const
  {
    return !this->Gray && this->Color && this->Color->GetScale() == VTK_CTF_LOG10 &&
      this->Color->GetRange()[0] > 0.0;
  }
};

/**
 * Table of functions over the range of a component. It does not depend on the scalar type: the same
 * values look the same as bytes and as floats.
 */
TransferTable MakeTable(const TableFunctions& functions, const MinMaxBlocks::Limits& range)
{
  double first;
  double last;
  functions.GetRange(first, last);
  if (!functions.IsClamped())
  {
    last = first - 1.0;
  }
  const TableLayout layout = LayOutTable(
    range.Min, range.Max, first, last,
    [&functions](double lo, double hi) {
      // Steps are equal, logarithmic functions bend most at their small end.
      return functions.IsLogarithmic() ? std::numeric_limits<int>::max()
                                       : functions.EstimateSamples(lo, hi);
    },
    [&functions](
      double at, double beyond) { return functions.Find(at) != functions.Find(beyond); });
  const auto size = static_cast<std::size_t>(layout.Size);
  std::vector<float> opacities(size);
  std::vector<float> colors(3 * size);
  functions.Tabulate(layout.Low, layout.High, layout.Size, colors.data(), opacities.data());
  return TransferTable(
    layout.Low, layout.High, size, colors.data(), opacities.data(), functions.Unit);
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

/// The gradient opacity of a function; none if the function has no effect.
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
  // As VTK's mappers: magnitudes up to a quarter of the range of the scalars matter. Behind its
  // last point the function is constant: that range may be far wider, as beside values that stand
  // for no data.
  double largest = range.Max > range.Min ? 0.25 * (range.Max - range.Min) : 0.25;
  const double last = function->GetRange()[1];
  if (function->GetClamping() && last > 0.0)
  {
    largest = std::min(largest, last);
  }
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
  functions.Color = gray ? nullptr : property->GetRGBTransferFunction(component);
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
          : (!functions.Color || functions.Color->GetSize() < 1)))
  {
    message = "The volume property has no color function" + which +
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
    case ComponentKind::ColorOpacity:
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
    kind = components == 2 ? ComponentKind::ColorOpacity
      : components == 3    ? ComponentKind::Rgb
                           : ComponentKind::Rgba;
  }
  if ((kind == ComponentKind::Rgb || kind == ComponentKind::Rgba) && type != ScalarType::UInt8 &&
    type != ScalarType::UInt16 && type != ScalarType::Float32 && type != ScalarType::Float64)
  {
    message = "Dependent components that are colors must be unsigned char, unsigned short, float "
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
    if (facts.NativeColors)
    {
      tables.Color = native.Truncate(tables.Color);
      tables.Gray = native.Truncate(tables.Gray);
    }
    if (facts.NativeOpacities)
    {
      tables.Opacity = native.Truncate(tables.Opacity);
    }
    TableFunctions used = tables;
    if (!independent)
    {
      used.Color = nullptr;
      used.Gray = nullptr;
    }
    optics.Table = MakeTable(used, range);
    if (facts.Kind == ComponentKind::ColorOpacity)
    {
      used = tables;
      used.Opacity = nullptr;
      functions.Colors = MakeTable(used, facts.Ranges[0]);
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
    // Weights mix independent components.
    optics.Weight = independent ? static_cast<float>(property->GetComponentWeight(c)) : 1.0f;
    // The flag of the first component counts for all, as in VTK's mappers.
    optics.Shade = property->GetShade(0) != 0;
    optics.Surface.Ambient = static_cast<float>(property->GetAmbient(c));
    optics.Surface.Diffuse = static_cast<float>(property->GetDiffuse(c));
    optics.Surface.Specular = static_cast<float>(property->GetSpecular(c));
    optics.Surface.SpecularPower = static_cast<float>(property->GetSpecularPower(c));
    if (facts.HasLabels)
    {
      for (int label : property->GetLabelMapLabels())
      {
        vtkColorTransferFunction* const color = property->GetLabelColor(label);
        vtkPiecewiseFunction* const opacity = property->GetLabelScalarOpacity(label);
        vtkPiecewiseFunction* const gradient = property->GetLabelGradientOpacity(label);
        if (label < 1 || (!color && !opacity && !gradient))
        {
          continue;
        }
        if (label > LargestLabel)
        {
          message = "The volume property has a function for label " + std::to_string(label) +
            "; labels with functions range from 1 to " + std::to_string(LargestLabel) +
            ". Number the labels anew, in MaskInput and in vtkVolumeProperty::SetLabelColor(), "
            "SetLabelScalarOpacity() and SetLabelGradientOpacity().";
          return false;
        }
        TableFunctions ofLabel = tables;
        if (color)
        {
          ofLabel.Color = color;
          ofLabel.Gray = nullptr;
        }
        if (opacity)
        {
          ofLabel.Opacity = opacity;
        }
        LabelOptics made;
        made.Table = MakeTable(ofLabel, range);
        made.Gradients = MakeGradientOpacity(gradient, range);
        functions.LabelIndices.resize(
          std::max(functions.LabelIndices.size(), static_cast<std::size_t>(label) + 1), -1);
        functions.LabelIndices[static_cast<std::size_t>(label)] =
          static_cast<int>(functions.Labels.size());
        functions.Labels.push_back(std::move(made));
      }
    }
  }
  functions.ColorScale = FindColorScale(facts.Type);
  return true;
}

} // namespace ffd
