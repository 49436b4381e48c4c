// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSingleArrays_h
#define FFDSingleArrays_h

#include <glm/mat3x3.hpp>

namespace ffd
{

/// Copies a vector to single precision.
template <class Vector>
void Copy(const Vector& from, float to[3])
{
  for (int a = 0; a < 3; ++a)
  {
    to[a] = static_cast<float>(from[a]);
  }
}

/// Copies a matrix to single precision, row by row.
inline void CopyRows(const glm::dmat3& from, float to[9])
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      to[3 * row + column] = static_cast<float>(from[column][row]);
    }
  }
}

} // namespace ffd

#endif
