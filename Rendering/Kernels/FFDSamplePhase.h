// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The samples of a ray lie at whole multiples of the sample distance behind the face through
 * which it enters the volume at rest, or behind the near clipping plane if it begins inside, as in
 * vtkGPUVolumeRayCastMapper. So pictures do not depend on the clipping range. Deformed rays have
 * the phase that they have at rest: an edit of the deformation moves no samples elsewhere.
 */
#ifndef FFDSamplePhase_h
#define FFDSamplePhase_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDVolumeView.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{

/// Part of an interval by which samples lie before the multiples: rounding errors neither put a
/// sample on the first face nor the last of a whole number of intervals beyond the other one.
constexpr double PhaseGuard = 0.01;

/// Part of an interval before the start of a range of a ray, in which samples belong to the range,
/// and before its end, in which they do not: rounding errors do not decide about a sample at its
/// start.
constexpr double SampleSlack = 1e-3;

/// The least slope of rays along an axis: less counts as this much.
constexpr double LeastSlope = 1e-20;

/// The volume at rest in index coordinates. `wholeAtRest`: bounds, data coordinates, of what the
/// volume is a part of, or null.
inline Box FindRestBox(const VolumeView& volume, const Box* wholeAtRest)
{
  const Box own{ volume.LowerIndex(), volume.UpperIndex() };
  if (!wholeAtRest)
  {
    return own;
  }
  // Half the edges of the bounds are those of the box times the magnitudes of the matrix.
  glm::dmat3 magnitudes;
  for (int a = 0; a < 3; ++a)
  {
    magnitudes[a] = glm::abs(volume.IndexToData[a]);
  }
  const glm::dvec3 half = glm::inverse(magnitudes) * (0.5 * (wholeAtRest->Max - wholeAtRest->Min));
  const glm::dvec3 middle = volume.ToIndex(0.5 * (wholeAtRest->Min + wholeAtRest->Max));
  const Box whole{ middle - half, middle + half };
  // Not so where bounds do not tell the edges: turned by 45 degrees.
  return glm::all(glm::lessThanEqual(whole.Min, own.Min + 0.5)) &&
      glm::all(glm::greaterThanEqual(whole.Max, own.Max - 0.5))
    ? whole
    : own;
}

/// The part of an interval, 0 to 1, by which the samples of a ray are moved on from the multiples
/// of the sample distance. `origin`, `direction`: index coordinates; `jitter`: intervals added.
inline double FindPhase(const glm::dvec3& origin, const glm::dvec3& direction, const Box& box,
  double sampleDistance, double jitter)
{
  double enter = -1e30;
  double exit = 1e30;
  double enterSlope = 0.0;
  double exitSlope = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    const double slope = std::max(std::abs(direction[a]), LeastSlope);
    const double inverse = std::copysign(1.0 / slope, direction[a]);
    const double t0 = (box.Min[a] - origin[a]) * inverse;
    const double t1 = (box.Max[a] - origin[a]) * inverse;
    const double near = std::min(t0, t1);
    const double far = std::max(t0, t1);
    enterSlope = near > enter ? slope : enterSlope;
    enter = std::max(enter, near);
    exitSlope = far < exit ? slope : exitSlope;
    exit = std::min(exit, far);
  }
  // Rays past the box, which what is deformed may meet, go by the planes that they cross steeply:
  // the other ones they meet at very different t.
  const double t = enter > exit && exitSlope > enterSlope ? exit : enter;
  const double x = std::max(t, 0.0) / sampleDistance + jitter - PhaseGuard;
  return x - std::floor(x);
}

} // namespace ffd

#endif
