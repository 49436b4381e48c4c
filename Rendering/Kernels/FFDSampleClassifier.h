// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSampleClassifier_h
#define FFDSampleClassifier_h

#include "FFDCameraView.h"
#include "FFDExport.h"
#include "FFDSampling.h"
#include "FFDShading.h"
#include "FFDTransferTable.h"
#include "FFDVolumeView.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace ffd
{

/// Where a sample stands in the world: what its normals and its lighting are found from, on demand.
class NormalSource
{
public:
  NormalSource(const ViewRay& ray, const CameraView& camera, double t)
    : Ray(ray)
    , Camera(camera)
    , T(t)
  {
  }
  virtual ~NormalSource() = default;

  /// The gradient by world coordinates of a field on the deformed volume, from that by index
  /// coordinates of the field at rest: J_Phi^T grad f.
  virtual glm::dvec3 ToWorld(const glm::dvec3& byIndex) const = 0;

  glm::dvec3 GetPosition() const { return this->Ray.Origin + this->T * this->Ray.Direction; }

  /// Unit vector.
  glm::dvec3 GetToEye() const { return this->Camera.ToEye(this->Ray, this->GetPosition()); }

private:
  const ViewRay& Ray;
  const CameraView& Camera;
  double T;
};

/**
 * What a sample of the volume at rest looks like. Immutable, one for a frame, used by any number
 * of threads. Positions are index coordinates inside of the volume.
 */
class FFD_KERNEL_EXPORT SampleClassifier
{
public:
  static constexpr int LargestNumberOfComponents = 4;

  /// `shade`: whether colours are lit. What is referred to must outlive the classifier.
  SampleClassifier(const VolumeView& volume, Interpolation interpolation,
    const TransferTable& table, const Shading& material, bool shade);

  /// Whether there is nothing but one component and its table: what the vector code of the
  /// packets does.
  bool IsPlain() const { return true; }

  int GetNumberOfComponents() const { return 1; }

  /// Whether there is nothing at `q`, whatever its values.
  bool IsHidden(const glm::dvec3&) const { return false; }

  /// Interpolated value of each component.
  void Values(const glm::dvec3& q, double* values) const;

  struct Look
  {
    glm::vec3 Colour;
    float Extinction; ///< per world unit; 0: transparent
  };

  /// The sample at `q`, whose values are `values`, lit if the material is shaded.
  Look Classify(const glm::dvec3& q, const double* values, const NormalSource& normals) const;

  /// Colour (not premultiplied, not lit) and opacity of a value, over the opacity unit distance.
  glm::vec4 ClassifyValue(int component, double value) const;

  /// A colour at `q` lit by the material of a component, with the normal of its scalars; the
  /// colour itself where nothing is shaded.
  glm::vec3 Light(int component, const glm::dvec3& q, const glm::vec3& colour,
    const NormalSource& normals) const;

private:
  const VolumeView& Volume;
  const TransferTable& Table;
  const Shading& Material;
  SampleFunctions Fetch;
  bool Shade;
};

} // namespace ffd

#endif
