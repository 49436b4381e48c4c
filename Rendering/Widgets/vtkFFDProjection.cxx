// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDProjection.h"

#include "vtkCamera.h"
#include "vtkInteractorObserver.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkProp3D.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkWindow.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

namespace
{

/// Pixels by which things reach over their bounds: wide lines, large points.
constexpr double HidingMargin = 12.0;

} // namespace

//------------------------------------------------------------------------------
vtkFFDProjection::vtkFFDProjection(vtkRenderer* renderer)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const vtkMatrix4x4* matrix =
    camera->GetCompositeProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1.0, 1.0);
  for (int r = 0; r < 4; ++r)
  {
    for (int c = 0; c < 4; ++c)
    {
      this->WorldToClip[c][r] = matrix->GetElement(r, c);
    }
  }
  const int* origin = renderer->GetOrigin();
  const int* size = renderer->GetSize();
  this->Origin = { origin[0], origin[1] };
  this->Size = { std::max(1, size[0]), std::max(1, size[1]) };
  const vtkMatrix4x4* projection =
    camera->GetProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1.0, 1.0);
  this->Parallel = camera->GetParallelProjection() != 0;
  this->DepthSlope = projection->GetElement(2, 2);
  this->DepthOffset = projection->GetElement(2, 3);
  // Not from the options of the camera: it may have matrices of the user, too, or be off-axis.
  const glm::dmat4 clipToWorld = glm::inverse(this->WorldToClip);
  const glm::dvec3 right(clipToWorld[0]);
  const glm::dvec3 up(clipToWorld[1]);
  this->Right = glm::normalize(right);
  this->Up = glm::normalize(up);
  this->PixelPerDepth = 2.0 * glm::length(up) / this->Size.y;
}

//------------------------------------------------------------------------------
bool vtkFFDProjection::operator==(const vtkFFDProjection& other) const
{
  return this->WorldToClip == other.WorldToClip && this->Origin == other.Origin &&
    this->Size == other.Size && this->PixelPerDepth == other.PixelPerDepth &&
    this->Parallel == other.Parallel && this->DepthSlope == other.DepthSlope &&
    this->DepthOffset == other.DepthOffset;
}

//------------------------------------------------------------------------------
bool vtkFFDProjection::ToDisplay(const glm::dvec3& world, glm::dvec3& display) const
{
  const glm::dvec4 clip = this->WorldToClip * glm::dvec4(world, 1.0);
  if (!(clip.w > 0.0))
  {
    return false;
  }
  const glm::dvec3 view = glm::dvec3(clip) / clip.w;
  // As vtkViewport::ViewToDisplay().
  const glm::dvec2 pixel = this->Origin + 0.5 * (glm::dvec2(view) + 1.0) * this->Size;
  display = { pixel.x, pixel.y, view.z };
  return true;
}

//------------------------------------------------------------------------------
glm::dvec3 vtkFFDProjection::GetSight(const glm::dvec3& world) const
{
  const glm::dvec3 ndc = vtkFFDTransformPoint(this->WorldToClip, world);
  const glm::dvec3 near =
    vtkFFDTransformPoint(glm::inverse(this->WorldToClip), { ndc.x, ndc.y, -1.0 });
  return glm::normalize(near - world);
}

//------------------------------------------------------------------------------
double vtkFFDProjection::GetPixelSize(const glm::dvec3& world) const
{
  const glm::dvec4 clip = this->WorldToClip * glm::dvec4(world, 1.0);
  return clip.w > 0.0 ? clip.w * this->PixelPerDepth : 0.0;
}

//------------------------------------------------------------------------------
double vtkFFDProjection::GetPointShift(double pixels) const
{
  // A pixel is PixelPerDepth w long, and w is the distance from the camera, or 1 if parallel.
  const double part = pixels * this->PixelPerDepth;
  return this->Parallel ? part * this->DepthSlope
                        : this->DepthOffset * part / std::max(1.0 - part, 0.5);
}

//------------------------------------------------------------------------------
vtkFFDPixelBox vtkFFDFindHiding(vtkRenderer* renderer, vtkProp* prop)
{
  int size[2];
  int origin[2];
  renderer->GetTiledSizeAndOrigin(&size[0], &size[1], &origin[0], &origin[1]);
  const glm::ivec2 low(origin[0], origin[1]);
  const glm::ivec2 high = low + glm::ivec2(size[0], size[1]);
  const vtkFFDPixelBox all{ low, high };
  const int* tiles = renderer->GetVTKWindow()->GetTileScale();
  if (tiles[0] != 1 || tiles[1] != 1)
  {
    return all;
  }
  const vtkFFDProjection projection(renderer);
  vtkFFDPixelBox box{ high, low };
  vtkPropCollection* props = renderer->GetViewProps();
  vtkCollectionSimpleIterator iterator;
  props->InitTraversal(iterator);
  while (vtkProp* other = props->GetNextProp(iterator))
  {
    if (other == prop || !other->GetVisibility() || other->IsA("vtkActor2D"))
    {
      continue;
    }
    const double* bounds = other->GetBounds();
    if (!bounds)
    {
      // Data without points; what else has no bounds may be anywhere.
      if (other->IsA("vtkProp3D"))
      {
        continue;
      }
      return all;
    }
    if (!vtkMath::AreBoundsInitialized(bounds))
    {
      continue;
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      glm::dvec3 at;
      if (!projection.ToDisplay(
            { bounds[corner & 1], bounds[2 + (corner >> 1 & 1)], bounds[4 + (corner >> 2)] }, at))
      {
        return all; // around the camera
      }
      const glm::dvec2 pixel = glm::clamp(glm::dvec2(at) - projection.Origin,
        glm::dvec2(-HidingMargin), projection.Size + HidingMargin);
      box.Low = glm::min(box.Low, low + glm::ivec2(glm::floor(pixel - HidingMargin)));
      box.High = glm::max(box.High, low + glm::ivec2(glm::ceil(pixel + HidingMargin)));
    }
  }
  box.Low = glm::max(box.Low, low);
  box.High = glm::min(box.High, high);
  return box;
}

//------------------------------------------------------------------------------
glm::dvec3 vtkFFDTransformPoint(const glm::dmat4& matrix, const glm::dvec3& p)
{
  const glm::dvec4 q = matrix * glm::dvec4(p, 1.0);
  return glm::dvec3(q) / q.w;
}

//------------------------------------------------------------------------------
glm::dmat4 vtkFFDGetMatrix(vtkProp3D* prop)
{
  glm::dmat4 matrix(1.0);
  if (prop)
  {
    const vtkMatrix4x4* from = prop->GetMatrix();
    for (int r = 0; r < 4; ++r)
    {
      for (int c = 0; c < 4; ++c)
      {
        matrix[c][r] = from->GetElement(r, c);
      }
    }
  }
  return matrix;
}

//------------------------------------------------------------------------------
vtkFFDDataView::vtkFFDDataView(vtkRenderer* renderer, const glm::dmat4& dataToWorld)
  : Renderer(renderer)
  , DataToWorld(dataToWorld)
  , WorldToData(glm::inverse(dataToWorld))
{
}

//------------------------------------------------------------------------------
glm::dvec3 vtkFFDDataView::ToData(const glm::dvec2& display, double depth) const
{
  double world[4];
  vtkInteractorObserver::ComputeDisplayToWorld(this->Renderer, display.x, display.y, depth, world);
  return vtkFFDTransformPoint(this->WorldToData, { world[0], world[1], world[2] });
}

//------------------------------------------------------------------------------
glm::dvec3 vtkFFDDataView::ToDisplay(const glm::dvec3& data) const
{
  const glm::dvec3 world = vtkFFDTransformPoint(this->DataToWorld, data);
  glm::dvec3 display;
  vtkInteractorObserver::ComputeWorldToDisplay(
    this->Renderer, world.x, world.y, world.z, &display.x);
  return display;
}

//------------------------------------------------------------------------------
ffd::LineOfSight vtkFFDDataView::GetLineOfSight(const glm::dvec2& display) const
{
  const glm::dvec3 first = this->ToData(display, 0.0);
  const glm::dvec3 last = this->ToData(display, 1.0);
  return { first, glm::normalize(last - first) };
}
