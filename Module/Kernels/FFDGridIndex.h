// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDGridIndex_h
#define FFDGridIndex_h

#include <glm/vec3.hpp>

#include <cstddef>

namespace ffd
{

/// Number of the points of a grid, in 64 bits.
inline std::size_t GridSize(const glm::ivec3& size)
{
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
    static_cast<std::size_t>(size.z);
}

///@{
/// Place of point (i, j, k) in the array of a grid, x fastest, in 64 bits: i + nx (j + ny k).
inline std::size_t GridIndex(int i, int j, int k, const glm::ivec3& size)
{
  return static_cast<std::size_t>(i) +
    static_cast<std::size_t>(size.x) *
    (static_cast<std::size_t>(j) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(k));
}
inline std::size_t GridIndex(const glm::ivec3& at, const glm::ivec3& size)
{
  return GridIndex(at.x, at.y, at.z, size);
}
///@}

} // namespace ffd

#endif
