// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDClipToBox_h
#define FFDClipToBox_h

#include "Bounds/FFDBox.h"

#include <glm/vec3.hpp>

#include <algorithm>

namespace ffd
{

/// Narrows [from, to] to the part of a line inside a box; false when nothing is left.
inline bool ClipToBox(
  const glm::dvec3& origin, const glm::dvec3& direction, const Box& box, double& from, double& to)
{
  for (int a = 0; a < 3; ++a)
  {
    if (direction[a] == 0.0)
    {
      if (origin[a] < box.Min[a] || origin[a] > box.Max[a])
      {
        return false;
      }
      continue;
    }
    const double t0 = (box.Min[a] - origin[a]) / direction[a];
    const double t1 = (box.Max[a] - origin[a]) / direction[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from < to;
}

} // namespace ffd

#endif
