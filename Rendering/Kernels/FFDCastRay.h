// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCastRay_h
#define FFDCastRay_h

#include "Bounds/FFDBox.h"
#include "FFDCameraView.h"
#include "FFDCastScene.h"

#include <glm/vec3.hpp>

namespace ffd
{

/// The viewing ray of a pixel, cut to the part that is cast, and the places of its samples.
struct CastRay
{
  ViewRay Viewing;
  double From = 0.0; ///< t
  double To = 0.0;
  double Jitter = 0.0; ///< shift of its samples, as a part of an interval
  double Phase = 0.0;  ///< shift from the multiples of the sample distance, likewise (FindPhase())
  int X = 0;           ///< pixel
  int Y = 0;

  /// The point at t, data coordinates.
  glm::dvec3 At(double t) const { return this->Viewing.At(t); }
};

/// Makes the ray of pixel (x, y) and cuts it to the depths that are drawn already, the clipping
/// planes and the deformed bounds; false if nothing of it is left. `restBox`: FindRestBox().
bool MakeCastRay(const CastScene& scene, const CastSettings& settings, const Box& restBox, int x,
  int y, CastRay& ray);

} // namespace ffd

#endif
