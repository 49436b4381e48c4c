// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDWarpTransform.h"

#include "vtkFFDGuard.h"
#include "vtkFFDWarpKernel.h"

namespace
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
void MapPoint(const vtkFFDWarpKernel& kernel, const T in[3], T out[3])
{
  FromVector(kernel.Map(ToVector(in)), out);
}

template <class T>
void InvertPoint(const vtkFFDWarpKernel& kernel, const T in[3], T out[3])
{
  FromVector(kernel.Invert(ToVector(in)), out);
}

template <class T>
void FindDerivative(
  const vtkFFDWarpKernel& kernel, const glm::dvec3& p, glm::dvec3& image, T to[3][3])
{
  glm::dmat3 jacobian;
  image = kernel.Map(p, jacobian);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      to[row][column] = static_cast<T>(jacobian[column][row]);
    }
  }
}

template <class T>
void MapWithDerivative(const vtkFFDWarpKernel& kernel, const T in[3], T out[3], T derivative[3][3])
{
  glm::dvec3 image;
  FindDerivative(kernel, ToVector(in), image, derivative);
  FromVector(image, out);
}

/// The derivative is that of the forward map at the inverse point, as vtkWarpTransform wants it.
template <class T>
void InvertWithDerivative(
  const vtkFFDWarpKernel& kernel, const T in[3], T out[3], T derivative[3][3])
{
  const glm::dvec3 rest = kernel.Invert(ToVector(in));
  glm::dvec3 image;
  FindDerivative(kernel, rest, image, derivative);
  FromVector(rest, out);
}
}

//------------------------------------------------------------------------------
vtkFFDWarpTransform::vtkFFDWarpTransform() = default;

//------------------------------------------------------------------------------
vtkFFDWarpTransform::~vtkFFDWarpTransform() = default;

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::SetInverseTolerance(double tolerance)
{
  if (vtkFFDIsInverseTolerance(this, tolerance))
  {
    this->Superclass::SetInverseTolerance(tolerance);
  }
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::SetInverseIterations(int iterations)
{
  if (vtkFFDIsInverseIterations(this, iterations))
  {
    this->Superclass::SetInverseIterations(iterations);
  }
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::InternalDeepCopy(vtkAbstractTransform* transform)
{
  // vtkAbstractTransform::DeepCopy lets nothing but our own class through.
  vtkFFDWarpTransform* other = static_cast<vtkFFDWarpTransform*>(transform);
  // What GetInverse() made is the inverse once it has been updated.
  other->Update();
  this->InverseFlag = other->InverseFlag;
  this->InverseTolerance = other->InverseTolerance;
  this->InverseIterations = other->InverseIterations;
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::ForwardTransformPoint(const float in[3], float out[3])
{
  MapPoint(this->GetKernel(), in, out);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::ForwardTransformPoint(const double in[3], double out[3])
{
  MapPoint(this->GetKernel(), in, out);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::ForwardTransformDerivative(
  const float in[3], float out[3], float derivative[3][3])
{
  MapWithDerivative(this->GetKernel(), in, out, derivative);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::ForwardTransformDerivative(
  const double in[3], double out[3], double derivative[3][3])
{
  MapWithDerivative(this->GetKernel(), in, out, derivative);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::InverseTransformPoint(const float in[3], float out[3])
{
  InvertPoint(this->GetKernel(), in, out);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::InverseTransformPoint(const double in[3], double out[3])
{
  InvertPoint(this->GetKernel(), in, out);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::InverseTransformDerivative(
  const float in[3], float out[3], float derivative[3][3])
{
  InvertWithDerivative(this->GetKernel(), in, out, derivative);
}

//------------------------------------------------------------------------------
void vtkFFDWarpTransform::InverseTransformDerivative(
  const double in[3], double out[3], double derivative[3][3])
{
  InvertWithDerivative(this->GetKernel(), in, out, derivative);
}
