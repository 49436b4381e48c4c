// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDWarpKernel_h
#define vtkFFDWarpKernel_h

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

/// The map of a vtkFFDWarpTransform.
class vtkFFDWarpKernel
{
public:
  virtual ~vtkFFDWarpKernel() = default;

  virtual glm::dvec3 Map(const glm::dvec3& p) const = 0;
  virtual glm::dvec3 Map(const glm::dvec3& p, glm::dmat3& jacobian) const = 0;
  virtual glm::dvec3 Invert(const glm::dvec3& p) const = 0;
};

/// That of a kernel which has Forward(p), Forward(p, jacobian) and Inverse(p).
template <class Kernel>
class vtkFFDWarpKernelOf : public vtkFFDWarpKernel, public Kernel
{
public:
  glm::dvec3 Map(const glm::dvec3& p) const override { return this->Forward(p); }
  glm::dvec3 Map(const glm::dvec3& p, glm::dmat3& jacobian) const override
  {
    return this->Forward(p, jacobian);
  }
  glm::dvec3 Invert(const glm::dvec3& p) const override { return this->Inverse(p); }
};

#endif
