// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDClipToBox_h
#define FFDClipToBox_h

#include "Bounds/FFDBox.h"

#include <glm/vec3.hpp>

#include <algorithm>

namespace ffd
{

/// Narrow [from, to] to what of a ray is in a box; false if nothing is.
inline bool ClipToBox(
  const glm::dvec3& origin, const glm::dvec3& direction, const Box& box, double& from, double& to)
{
  for (int a = 0; a < 3; ++a)
  {
    const double t1 = (box.Min[a] - origin[a]) / direction[a];
    const double t2 = (box.Max[a] - origin[a]) / direction[a];
    // Along a face these are not numbers, which cut nothing off.
    from = std::max(from, std::min(t1, t2));
    to = std::min(to, std::max(t1, t2));
  }
  return from < to;
}

} // namespace ffd

#endif
