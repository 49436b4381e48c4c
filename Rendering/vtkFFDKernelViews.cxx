// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDKernelViews.h"

#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkRenderer.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace ffd
{
namespace
{

/// Entries of a transfer table: at least, and at most (then it takes 320 kB).
constexpr int SmallestTable = 1024;
constexpr int LargestTable = 16384;

glm::dvec3 Direction(const double from[3], const double to[3])
{
  const glm::dvec3 d(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  const double length = glm::length(d);
  return length > 0.0 ? d / length : glm::dvec3(0.0, 0.0, -1.0);
}

glm::vec3 Scaled(const double colour[3], double intensity)
{
  return glm::vec3(colour[0] * intensity, colour[1] * intensity, colour[2] * intensity);
}

Light MakeLight(vtkLight* source)
{
  Light light;
  light.Headlight = source->LightTypeIsHeadlight() && !source->GetPositional();
  double position[3];
  double focus[3];
  source->GetTransformedPosition(position);
  source->GetTransformedFocalPoint(focus);
  light.Axis = Direction(position, focus);
  light.Towards = -light.Axis;
  light.Position = glm::dvec3(position[0], position[1], position[2]);
  light.Positional = source->GetPositional() != 0;
  const double intensity = source->GetIntensity();
  light.Ambient = Scaled(source->GetAmbientColor(), intensity);
  light.Diffuse = Scaled(source->GetDiffuseColor(), intensity);
  light.Specular = Scaled(source->GetSpecularColor(), intensity);
  const double* attenuation = source->GetAttenuationValues();
  light.Attenuation = glm::dvec3(attenuation[0], attenuation[1], attenuation[2]);
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

//------------------------------------------------------------------------------
bool MakeTransferTable(vtkVolumeProperty* property, const MinMaxBlocks::Limits& range,
  bool roundUp, bool integers, TransferTable& table, std::string& message)
{
  vtkPiecewiseFunction* opacity = property->GetScalarOpacity(0);
  const bool gray = property->GetColorChannels(0) == 1;
  vtkPiecewiseFunction* grayTransfer = gray ? property->GetGrayTransferFunction(0) : nullptr;
  vtkColorTransferFunction* colour = gray ? nullptr : property->GetRGBTransferFunction(0);
  if (!opacity || opacity->GetSize() < 1)
  {
    message = "The volume property has no scalar opacity function, or one without points: nothing "
              "would be visible. Set one with vtkVolumeProperty::SetScalarOpacity().";
    return false;
  }
  if (gray ? (!grayTransfer || grayTransfer->GetSize() < 1) : (!colour || colour->GetSize() < 1))
  {
    message = "The volume property has no colour function, or one without points. Set one with "
              "vtkVolumeProperty::SetColor().";
    return false;
  }
  const double unit = property->GetScalarOpacityUnitDistance(0);
  if (!(unit > 0.0) || !std::isfinite(unit))
  {
    std::ostringstream why;
    why << "The scalar opacity unit distance of the volume property is " << unit
        << "; it must be positive.";
    message = why.str();
    return false;
  }

  // What scalar the functions are asked for. Never more than the least scalar where that is what
  // the voxels hold: it is the background, and stays as transparent as it is.
  const double up = roundUp ? 0.5 : 0.0;
  const auto classified = [&](double x) { return x + std::min(up, std::max(0.0, x - range.Min)); };

  double lo = range.Min;
  double hi = range.Max;
  // Beyond their last points clamped functions are constant: spend no entries there, so that a
  // few extreme scalars do not coarsen the table.
  const bool clamped = opacity->GetClamping() && (gray ? grayTransfer->GetClamping() != 0
                                                       : colour->GetClamping() != 0);
  if (clamped)
  {
    const double* points = opacity->GetRange();
    const double* colours = gray ? grayTransfer->GetRange() : colour->GetRange();
    const double first = std::min(points[0], colours[0]);
    const double last = std::max(points[1], colours[1]);
    lo = std::min(std::max(lo, first - up), hi);
    hi = std::max(std::min(hi, last), lo);
  }
  if (!(hi - lo > 1e-12 * std::max(std::abs(lo), std::abs(hi))))
  {
    hi = lo + std::max(1.0, std::abs(lo));
  }
  int size = SmallestTable;
  if (integers && hi - lo <= LargestTable)
  {
    // A whole number of entries a unit, so that whole scalars are met exactly.
    const int width = static_cast<int>(hi - lo);
    const int perUnit = std::max(1, SmallestTable / std::max(1, width));
    lo = std::floor(lo);
    hi = lo + width + 1;
    size = perUnit * (width + 1) + 1;
  }
  else
  {
    const int needed = std::max(opacity->EstimateMinNumberOfSamples(lo, hi),
      gray ? grayTransfer->EstimateMinNumberOfSamples(lo, hi)
           : colour->EstimateMinNumberOfSamples(lo, hi));
    size = std::clamp(needed, SmallestTable, LargestTable);
  }

  std::vector<float> opacities(static_cast<std::size_t>(size));
  std::vector<float> colours(3 * static_cast<std::size_t>(size));
  opacity->GetTable(lo + up, hi + up, size, opacities.data());
  if (gray)
  {
    std::vector<float> grays(static_cast<std::size_t>(size));
    grayTransfer->GetTable(lo + up, hi + up, size, grays.data());
    for (std::size_t i = 0; i < grays.size(); ++i)
    {
      std::fill_n(&colours[3 * i], 3, grays[i]);
    }
  }
  else
  {
    colour->GetTable(lo + up, hi + up, size, colours.data());
  }
  for (int i = 0; i < size; ++i)
  {
    const double x = lo + (hi - lo) * i / (size - 1);
    if (x >= range.Min + up)
    {
      break;
    }
    double rgb[3];
    if (gray)
    {
      std::fill_n(rgb, 3, grayTransfer->GetValue(classified(x)));
    }
    else
    {
      colour->GetColor(classified(x), rgb);
    }
    std::copy_n(rgb, 3, &colours[3 * static_cast<std::size_t>(i)]);
    opacities[static_cast<std::size_t>(i)] = static_cast<float>(opacity->GetValue(classified(x)));
  }
  table = TransferTable(
    lo, hi, static_cast<std::size_t>(size), colours.data(), opacities.data(), unit);
  return true;
}

//------------------------------------------------------------------------------
CameraView MakeCameraView(vtkRenderer* renderer, const glm::ivec2& viewport,
  const glm::ivec2& origin, const glm::ivec2& size, double step)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const double aspect = static_cast<double>(viewport.x) / viewport.y;
  CameraView view;
  view.WorldToNdc = ToMatrix(camera->GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0));
  view.NdcToWorld = glm::inverse(view.WorldToNdc);
  view.ImageSize = size;
  view.PixelOrigin = glm::ivec2(glm::floor(glm::dvec2(origin) / step));
  view.NdcPerPixel = 2.0 * step / glm::dvec2(viewport);
  view.NdcOrigin = 2.0 * glm::dvec2(origin) / glm::dvec2(viewport) - 1.0;
  const double* eye = camera->GetPosition();
  view.Eye = glm::dvec3(eye[0], eye[1], eye[2]);
  view.Parallel = camera->GetParallelProjection() != 0;
  return view;
}

//------------------------------------------------------------------------------
Shading MakeShading(vtkRenderer* renderer, vtkVolumeProperty* property)
{
  Shading shading;
  shading.Ambient = static_cast<float>(property->GetAmbient(0));
  shading.Diffuse = static_cast<float>(property->GetDiffuse(0));
  shading.Specular = static_cast<float>(property->GetSpecular(0));
  shading.SpecularPower = static_cast<float>(property->GetSpecularPower(0));
  shading.TwoSided = renderer->GetTwoSidedLighting() != 0;

  vtkLightCollection* lights = renderer->GetLights();
  vtkCollectionSimpleIterator iterator;
  lights->InitTraversal(iterator);
  while (vtkLight* light = lights->GetNextLight(iterator))
  {
    if (light->GetSwitch())
    {
      shading.Lights.push_back(MakeLight(light));
    }
  }
  if (shading.Lights.empty() && lights->GetNumberOfItems() == 0)
  {
    Light headlight;
    headlight.Headlight = true;
    shading.Lights.push_back(headlight);
  }
  // A single headlight lights the ambient term, too, although the ambient colour of VTK's lights
  // is black: so does vtkGPUVolumeRayCastMapper.
  if (shading.Lights.size() == 1 && shading.Lights[0].Headlight)
  {
    shading.Lights[0].Ambient = glm::vec3(1.0f);
  }
  return shading;
}

} // namespace ffd
