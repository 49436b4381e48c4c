// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed, not wrapped.
#ifndef vtkFFDImageRegion_h
#define vtkFFDImageRegion_h

#include <glm/vec2.hpp>

/// A rectangle of viewport pixels and the grid of rays over it.
struct vtkFFDImageRegion
{
  vtkFFDImageRegion() = default;
  /// A ray for each pixel of a viewport.
  explicit vtkFFDImageRegion(const glm::ivec2& viewport)
    : Viewport(viewport)
    , Rays(viewport)
    , Aspect(static_cast<double>(viewport.x) / viewport.y)
  {
  }

  glm::ivec2 Viewport{ 0 }; ///< pixels of the whole viewport
  glm::ivec2 Origin{ 0 };   ///< first pixel, in the viewport
  glm::ivec2 Rays{ 0 };     ///< rays per row and column
  double Step = 1.0;        ///< pixels between rays
  double Aspect = 1.0;      ///< width over height of what the camera shows in the viewport
  bool Stereo = false;      ///< as the eye sees it that a window renders for, if it does
};

#endif
