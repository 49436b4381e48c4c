// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDWarpKernel_h
#define vtkFFDWarpKernel_h

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

/**
 * The methods of vtkWarpTransform, in both precisions, for a kernel `map` that has Forward(p),
 * Forward(p, jacobian) and Inverse(p).
 */
namespace vtkFFDWarpKernel
{

template <class T>
glm::dvec3 ToVector(const T in[3])
{
  return glm::dvec3(in[0], in[1], in[2]);
}

template <class T>
void FromVector(const glm::dvec3& p, T out[3])
{
  for (int a = 0; a < 3; ++a)
  {
    out[a] = static_cast<T>(p[a]);
  }
}

template <class T>
void FromMatrix(const glm::dmat3& m, T derivative[3][3])
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      derivative[row][column] = static_cast<T>(m[column][row]);
    }
  }
}

template <class Map, class T>
void Forward(const Map& map, const T in[3], T out[3])
{
  FromVector(map.Forward(ToVector(in)), out);
}

template <class Map, class T>
void ForwardDerivative(const Map& map, const T in[3], T out[3], T derivative[3][3])
{
  glm::dmat3 jacobian;
  FromVector(map.Forward(ToVector(in), jacobian), out);
  FromMatrix(jacobian, derivative);
}

template <class Map, class T>
void Inverse(const Map& map, const T in[3], T out[3])
{
  FromVector(map.Inverse(ToVector(in)), out);
}

/// The derivative is that of the forward map at the inverse point, as vtkWarpTransform wants it.
template <class Map, class T>
void InverseDerivative(const Map& map, const T in[3], T out[3], T derivative[3][3])
{
  const glm::dvec3 rest = map.Inverse(ToVector(in));
  glm::dmat3 jacobian;
  map.Forward(rest, jacobian);
  FromVector(rest, out);
  FromMatrix(jacobian, derivative);
}

} // namespace vtkFFDWarpKernel

#endif
