// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDViewFromRenderer.h"

#include "vtkCamera.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkRenderer.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

glm::dvec3 Normalized(const glm::dvec3& d)
{
  const double length = glm::length(d);
  return length > 0.0 && std::isfinite(length) ? d / length : glm::dvec3(0.0, 0.0, -1.0);
}

glm::dvec3 Direction(const double from[3], const double to[3])
{
  return Normalized(glm::dvec3(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
}

glm::vec3 Scaled(const double color[3], double intensity)
{
  return glm::vec3(color[0] * intensity, color[1] * intensity, color[2] * intensity);
}

/// Finds where a light is and what it shines at. Lights that follow the camera are where the
/// renderer puts them when it is drawn in a window, which it may never have been, or not since the
/// camera has moved.
void PlaceLight(vtkRenderer* renderer, vtkLight* light, double position[3], double focus[3])
{
  vtkCamera* const camera = renderer->GetActiveCamera();
  if (renderer->GetLightFollowCamera() && light->LightTypeIsHeadlight())
  {
    camera->GetPosition(position);
    camera->GetFocalPoint(focus);
  }
  else if (renderer->GetLightFollowCamera() && light->LightTypeIsCameraLight())
  {
    const glm::dmat4 toWorld = ToMatrix(camera->GetCameraLightTransformMatrix());
    const auto transform = [&toWorld](const double* from, double to[3]) {
      const glm::dvec3 at(toWorld * glm::dvec4(from[0], from[1], from[2], 1.0));
      std::copy_n(&at.x, 3, to);
    };
    transform(light->GetPosition(), position);
    transform(light->GetFocalPoint(), focus);
  }
  else
  {
    light->GetTransformedPosition(position);
    light->GetTransformedFocalPoint(focus);
  }
}

/// In the space of Shading: the world moved by `origin`, in the unit of length `unit`.
Light MakeLight(vtkRenderer* renderer, vtkLight* source, const glm::dvec3& origin, double unit)
{
  Light light;
  light.Headlight = source->LightTypeIsHeadlight() && !source->GetPositional();
  double position[3];
  double focus[3];
  PlaceLight(renderer, source, position, focus);
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
  // Exactly -1 where a step is a pixel.
  view.NdcOrigin = 2.0 * (origin - region.Step * glm::dvec2(view.PixelOrigin)) / viewport - 1.0;
  // Where the camera looks from with the matrices of the user that it may have.
  view.Eye =
    glm::dvec3(glm::inverse(ToMatrix(camera->GetModelViewTransformMatrix()) * dataToWorld)[3]);
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
      shading.Lights.push_back(MakeLight(renderer, light, glm::dvec3(dataToWorld[3]), unit));
      intensity = light->GetIntensity();
    }
  }
  // As vtkRenderer makes one when it draws in a window where none is on.
  if (shading.Lights.empty() && renderer->GetAutomaticLightCreation())
  {
    Light headlight;
    headlight.Headlight = true;
    shading.Lights.push_back(headlight);
  }
  // A single headlight of intensity 1 lights the ambient term, too, although the ambient color of
  // VTK's lights is black: so does vtkGPUVolumeRayCastMapper.
  if (shading.Lights.size() == 1 && shading.Lights[0].Headlight && intensity == 1.0)
  {
    shading.Lights[0].Ambient = glm::vec3(1.0f);
  }
  return shading;
}

} // namespace ffd
