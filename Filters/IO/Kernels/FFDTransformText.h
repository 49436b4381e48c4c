// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Functions that the text formats of transforms share: vectors, matrices and sizes as lists of
// numbers.
#ifndef FFDTransformText_h
#define FFDTransformText_h

#include "FFDTextNumbers.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace ffd
{

inline glm::dvec3 VectorAt(const std::vector<double>& values, std::size_t first)
{
  return { values[first], values[first + 1], values[first + 2] };
}

/// Nine numbers, row by row.
inline glm::dmat3 MatrixAt(const std::vector<double>& values, std::size_t first)
{
  glm::dmat3 matrix(1.0);
  for (std::size_t row = 0; row < 3; ++row)
  {
    for (std::size_t column = 0; column < 3; ++column)
    {
      matrix[static_cast<int>(column)][static_cast<int>(row)] = values[first + 3 * row + column];
    }
  }
  return matrix;
}

/// Three whole numbers from 1 on.
inline bool SizeAt(const std::vector<double>& values, std::size_t first, glm::ivec3& size)
{
  for (int a = 0; a < 3; ++a)
  {
    const double n = values[first + static_cast<std::size_t>(a)];
    if (!(n >= 1.0 && n <= 1e9) || n != std::floor(n))
    {
      return false;
    }
    size[a] = static_cast<int>(n);
  }
  return true;
}

inline void AppendVector(std::string& text, const glm::dvec3& v)
{
  for (int a = 0; a < 3; ++a)
  {
    text += ' ';
    AppendNumber(text, v[a]);
  }
}

/// Row by row.
inline void AppendMatrix(std::string& text, const glm::dmat3& matrix)
{
  for (int row = 0; row < 3; ++row)
  {
    AppendVector(text, { matrix[0][row], matrix[1][row], matrix[2][row] });
  }
}

inline void AppendSize(std::string& text, const glm::ivec3& size)
{
  for (int a = 0; a < 3; ++a)
  {
    text += ' ' + std::to_string(size[a]);
  }
}

/// Coefficients, all x, then all y, then all z.
inline void AppendPlanar(std::string& text, const std::vector<glm::dvec3>& values)
{
  for (int a = 0; a < 3; ++a)
  {
    for (const glm::dvec3& value : values)
    {
      text += ' ';
      AppendNumber(text, value[a]);
    }
  }
}

} // namespace ffd

#endif
