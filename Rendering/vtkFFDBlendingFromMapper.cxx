// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDBlendingFromMapper.h"

#include "vtkFFDOpticsFromProperty.h"

#include "vtkColorTransferFunction.h"
#include "vtkContourValues.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkVolumeMapper.h"
#include "vtkVolumeProperty.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

namespace ffd
{
namespace
{

/// `low` to `high`: where values are compared with, black and white.
void SetRange(Blending& blend, int channel, double low, double high)
{
  // A range of one value is white.
  blend.Low[channel] = low < high ? low : low - 1.0;
  blend.High[channel] = high;
}

void SetRanges(const ScalarFacts& facts, Blending& blend)
{
  if (facts.Kind == ComponentKind::Independent)
  {
    for (int c = 0; c < static_cast<int>(facts.Ranges.size()); ++c)
    {
      const MinMaxBlocks::Limits& range = facts.Ranges[static_cast<std::size_t>(c)];
      SetRange(blend, c, range.Min, range.Max);
    }
    return;
  }
  if (blend.Mode == BlendMode::Maximum || blend.Mode == BlendMode::Minimum)
  {
    const MinMaxBlocks::Limits range = FindDensityRange(facts, 0);
    SetRange(blend, 0, range.Min, range.Max);
  }
  else if (facts.Kind == ComponentKind::ColorOpacity || blend.Mode == BlendMode::Isosurface)
  {
    const MinMaxBlocks::Limits range = FindIntensityRange(facts, 0);
    SetRange(blend, 0, range.Min, range.Max);
  }
  else
  {
    // Black and white of values that are colors are those of the colors.
    SetRange(blend, 0, 0.0, 1.0 / FindColorScale(facts.Type));
  }
}

/// The scalar that the opacity of an isosurface is looked up for. Of dependent components, as in
/// vtkGPUVolumeRayCastMapper, that at the same part of the range of what opacity is looked up for.
double FindDensityOfIso(const ScalarFacts& facts, double value)
{
  if (facts.Kind == ComponentKind::Independent || facts.Kind == ComponentKind::Rgb)
  {
    return value;
  }
  const MinMaxBlocks::Limits from = FindIntensityRange(facts, 0);
  const MinMaxBlocks::Limits to = FindDensityRange(facts, 0);
  return from.Min < from.Max
    ? to.Min + (value - from.Min) / (from.Max - from.Min) * (to.Max - to.Min)
    : to.Min;
}

bool MakeIsoValues(
  vtkVolumeProperty* property, const ScalarFacts& facts, Blending& blend, std::string& message)
{
  vtkContourValues* values = property->GetIsoSurfaceValues();
  const int c = blend.IsoComponent;
  vtkPiecewiseFunction* opacity = property->GetScalarOpacity(c);
  const bool gray = property->GetColorChannels(c) == 1;
  for (int i = 0; i < values->GetNumberOfContours(); ++i)
  {
    const double value = values->GetValue(i);
    if (!std::isfinite(value))
    {
      std::ostringstream why;
      why << "Value " << i << " of vtkVolumeProperty::GetIsoSurfaceValues() is " << value
          << "; it must be a number. Nothing is drawn.";
      message = why.str();
      return false;
    }
    double rgb[3];
    if (facts.Kind == ComponentKind::Rgb || facts.Kind == ComponentKind::Rgba)
    {
      std::fill_n(rgb, 3, std::clamp(value * FindColorScale(facts.Type), 0.0, 1.0));
    }
    else if (gray)
    {
      std::fill_n(rgb, 3, property->GetGrayTransferFunction(c)->GetValue(value));
    }
    else
    {
      property->GetRGBTransferFunction(c)->GetColor(value, rgb);
    }
    blend.IsoValues.push_back({ value, glm::vec3(rgb[0], rgb[1], rgb[2]),
      std::clamp(
        static_cast<float>(opacity->GetValue(FindDensityOfIso(facts, value))), 0.0f, 1.0f) });
  }
  const auto less = [](const IsoValue& a, const IsoValue& b) { return a.Value < b.Value; };
  const auto same = [](const IsoValue& a, const IsoValue& b) { return a.Value == b.Value; };
  std::vector<IsoValue>& isos = blend.IsoValues;
  std::sort(isos.begin(), isos.end(), less);
  isos.erase(std::unique(isos.begin(), isos.end(), same), isos.end());
  return true;
}

bool MakeSlice(vtkVolumeProperty* property, Blending& blend, std::string& message)
{
  vtkPlane* plane = vtkPlane::SafeDownCast(property->GetSliceFunction());
  if (!plane)
  {
    message = "Slice blending needs a vtkPlane; set one with "
              "vtkVolumeProperty::SetSliceFunction(). Nothing is drawn.";
    return false;
  }
  const double* origin = plane->GetOrigin();
  const double* normal = plane->GetNormal();
  blend.SliceOrigin = glm::dvec3(origin[0], origin[1], origin[2]);
  blend.SliceNormal = glm::dvec3(normal[0], normal[1], normal[2]);
  const double length = glm::length(blend.SliceNormal);
  if (!(length > 0.0) || !std::isfinite(length) ||
    !std::isfinite(glm::dot(blend.SliceOrigin, blend.SliceOrigin)))
  {
    message = "The origin or the normal of the plane of vtkVolumeProperty::SetSliceFunction() is "
              "not a number, or the normal has no length. Nothing is drawn.";
    return false;
  }
  blend.SliceNormal /= length;
  return true;
}

} // namespace

//------------------------------------------------------------------------------
bool MakeBlending(vtkVolumeMapper* mapper, vtkVolumeProperty* property, const ScalarFacts& facts,
  Blending& blend, std::string& message)
{
  blend = Blending();
  if (facts.Kind == ComponentKind::Independent && property->GetIndependentComponents())
  {
    for (int c = 0; c < static_cast<int>(facts.Ranges.size()); ++c)
    {
      blend.Weight[c] = property->GetComponentWeight(c);
      blend.IsoComponent =
        blend.Weight[c] > blend.Weight[blend.IsoComponent] ? c : blend.IsoComponent;
    }
  }
  for (int c = 0; c < Blending::LargestNumberOfComponents; ++c)
  {
    blend.UnitDistance[c] = property->GetScalarOpacityUnitDistance(c);
  }
  switch (mapper->GetBlendMode())
  {
    case vtkVolumeMapper::COMPOSITE_BLEND:
      break;
    case vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND:
      blend.Mode = BlendMode::Maximum;
      break;
    case vtkVolumeMapper::MINIMUM_INTENSITY_BLEND:
      blend.Mode = BlendMode::Minimum;
      break;
    case vtkVolumeMapper::ADDITIVE_BLEND:
      blend.Mode = BlendMode::Additive;
      break;
    case vtkVolumeMapper::AVERAGE_INTENSITY_BLEND:
    {
      blend.Mode = BlendMode::Average;
      const double* range = mapper->GetAverageIPScalarRange();
      if (!(range[0] <= range[1]))
      {
        std::ostringstream why;
        why << "AverageIPScalarRange is (" << range[0] << ", " << range[1]
            << "); its ends must be numbers and ascend. Nothing is drawn.";
        message = why.str();
        return false;
      }
      blend.AverageMin = range[0];
      blend.AverageMax = range[1];
      break;
    }
    case vtkVolumeMapper::ISOSURFACE_BLEND:
      blend.Mode = BlendMode::Isosurface;
      if (!MakeIsoValues(property, facts, blend, message))
      {
        return false;
      }
      break;
    case vtkVolumeMapper::SLICE_BLEND:
      blend.Mode = BlendMode::Slice;
      if (!MakeSlice(property, blend, message))
      {
        return false;
      }
      break;
    default:
      message = "Blend mode " + std::to_string(mapper->GetBlendMode()) +
        " is unknown; choose one of vtkVolumeMapper::BlendModes, for instance with "
        "SetBlendModeToComposite(). Nothing is drawn.";
      return false;
  }
  SetRanges(facts, blend);
  return true;
}

//------------------------------------------------------------------------------
bool HaveSameLeaps(const Blending& a, const Blending& b)
{
  const auto same = [](const IsoValue& x, const IsoValue& y) {
    return x.Value == y.Value && (x.Opacity > 0.0f) == (y.Opacity > 0.0f);
  };
  return a.Mode == b.Mode && a.AverageMin == b.AverageMin && a.AverageMax == b.AverageMax &&
    a.IsoComponent == b.IsoComponent &&
    std::equal(
      a.IsoValues.begin(), a.IsoValues.end(), b.IsoValues.begin(), b.IsoValues.end(), same);
}

} // namespace ffd
