// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTracedRay_h
#define FFDTracedRay_h

#include "FFDCameraView.h"
#include "FFDCurveSegment.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <vector>

namespace ffd
{

/// A position that the ray caster looked at.
struct TracedSample
{
  glm::dvec3 Index; ///< index coordinates, at rest
  double T;         ///< on the viewing ray
  double Interval;  ///< length that the sample stands for, data units on the viewing ray
  bool Leap;        ///< a look-up in the distance map from which a leap started, not a sample
  float Extinction; ///< of samples, per data unit
};

/// A segment of a deformed ray, and what was done on it.
struct TracedSegment
{
  CurveSegment Curve; ///< index coordinates
  double From;        ///< t on the viewing ray
  double To;
  bool Passed; ///< empty for certain: nothing was looked at
  std::size_t FirstSample;
  std::size_t EndSample;
};

/// A ray as it was cast for a picture.
struct TracedRay
{
  ViewRay Viewing;
  bool Hit = false; ///< whether it meets the bounds of the deformed volume
  double From = 0.0;
  double To = 0.0;
  bool Terminated = false; ///< ended early, as nothing more would show
  glm::vec4 Color{ 0.0f }; ///< premultiplied
  std::vector<TracedSegment> Segments;
  std::vector<TracedSample> Samples;
};

} // namespace ffd

#endif
