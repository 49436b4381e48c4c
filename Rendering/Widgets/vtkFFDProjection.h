// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDProjection_h
#define vtkFFDProjection_h

#include "FFDDragGeometry.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

class vtkProp;
class vtkProp3D;
class vtkRenderer;

/// Projects points of the world onto the window, in pixels; made once for many points.
struct vtkFFDProjection
{
  glm::dmat4 WorldToClip{ 1.0 };
  glm::dvec2 Origin{ 0.0 }; ///< lower left pixel of the viewport
  glm::dvec2 Size{ 1.0 };
  double PixelPerDepth = 0.0;        ///< world units of a pixel at clip coordinate w = 1
  glm::dvec3 Right{ 1.0, 0.0, 0.0 }; ///< unit vector of the world that points right in the window
  glm::dvec3 Up{ 0.0, 1.0, 0.0 };    ///< unit vector of the world that points up in the window
  bool Parallel = false;
  double DepthSlope = 0.0;  ///< clip coordinate z by view coordinate z
  double DepthOffset = 0.0; ///< clip coordinate z of view coordinate z = 0

  vtkFFDProjection() = default;
  explicit vtkFFDProjection(vtkRenderer* renderer);
  bool operator==(const vtkFFDProjection& other) const;

  /// Display x, y and the depth (-1 near to 1 far); false behind the camera.
  bool ToDisplay(const glm::dvec3& world, glm::dvec3& display) const;
  /// Unit vector from a point of the world to the viewer.
  glm::dvec3 GetSight(const glm::dvec3& world) const;
  /// World units of a pixel at a point; 0 behind the camera.
  double GetPixelSize(const glm::dvec3& world) const;
  /// Offset of clip coordinate z that brings points nearer by some pixels and leaves them where
  /// they are seen.
  double GetPointShift(double pixels) const;
};

/// A rectangle of pixels of the framebuffer, from its lower left corner.
struct vtkFFDPixelBox
{
  glm::ivec2 Low{ 0 };
  glm::ivec2 High{ 0 }; ///< one past the last; empty if not above Low
  bool IsEmpty() const { return this->High.x <= this->Low.x || this->High.y <= this->Low.y; }
};

/**
 * Returns the part of the window where a renderer may draw something in front of `prop`: the bounds
 * of its other visible props, or the whole window if one of them has no bounds.
 */
vtkFFDPixelBox vtkFFDFindHiding(vtkRenderer* renderer, vtkProp* prop);

/// Applies a matrix to a point, with the perspective division.
glm::dvec3 vtkFFDTransformPoint(const glm::dmat4& matrix, const glm::dvec3& p);

/// The matrix that takes the data coordinates of a prop to the world; the identity for null.
glm::dmat4 vtkFFDGetMatrix(vtkProp3D* prop);

/// Takes display coordinates (pixels, and a depth from 0 to 1) to data coordinates and back.
class vtkFFDDataView
{
public:
  vtkFFDDataView(vtkRenderer* renderer, const glm::dmat4& dataToWorld);

  glm::dvec3 ToData(const glm::dvec2& display, double depth) const;
  glm::dvec3 ToDisplay(const glm::dvec3& data) const;
  ffd::LineOfSight GetLineOfSight(const glm::dvec2& display) const;

private:
  vtkRenderer* Renderer;
  glm::dmat4 DataToWorld;
  glm::dmat4 WorldToData;
};

#endif
