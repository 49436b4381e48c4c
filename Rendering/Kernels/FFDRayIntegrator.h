// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRayIntegrator_h
#define FFDRayIntegrator_h

#include "FFDCastScene.h"
#include "FFDCurvePiece.h"
#include "FFDExport.h"
#include "FFDSampleClassifier.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <limits>

namespace ffd
{

/// What all rays of a frame are integrated with.
struct IntegrationFrame
{
  const SampleClassifier* Classifier = nullptr;
  const CastScene* Scene = nullptr;
  const CastSettings* Settings = nullptr;
  glm::dmat3 RestToWorld{ 1.0 }; ///< lengths of deformed rays: index coordinates to world
  TransmittanceTable Transmittance;
};

/**
 * A piece of a deformed ray: its parameter s stands for t = T0 + s * Dt on the viewing ray. Each ray
 * caster knows in its own way how gradients change along it.
 */
class SampledPiece
{
public:
  CurvePiece Curve; ///< index coordinates
  double T0 = 0.0;
  double Dt = 0.0;

  SampledPiece() = default;
  SampledPiece(const CurvePiece& curve, double t0, double dt)
    : Curve(curve)
    , T0(t0)
    , Dt(dt)
  {
  }
  virtual ~SampledPiece() = default;

  /// NormalSource::ToWorld() at s.
  virtual glm::dvec3 GradientToWorld(double s, const glm::dvec3& byIndex) const = 0;
};

/**
 * The state of one ray, and what its samples do to it: the blend modes. Both ray casters hand it
 * the samples that they take, in the order of the ray; the packets do so where their own vector
 * code does not apply.
 */
class FFD_KERNEL_EXPORT RayIntegrator
{
public:
  /// A new ray. `frame` must outlive its samples.
  void Begin(const IntegrationFrame& frame, const ViewRay& ray);

  struct Outcome
  {
    bool Visible;     ///< the sample shows
    bool Done;        ///< nothing that comes after it would
    float Extinction; ///< of the sample, per world unit
  };

  /// The sample at `s` of a piece, inside of the volume, which stands for an interval of length
  /// `interval` of s that starts there.
  Outcome AddSample(const SampledPiece& piece, double s, double interval);

  struct Result
  {
    glm::vec3 Colour; ///< premultiplied
    float Transmittance;
    double FirstVisible; ///< t of the first sample that shows; infinite without one
  };
  Result End() const { return { this->Colour, this->Transmittance, this->FirstVisible }; }

private:
  Outcome Composite(const SampledPiece& piece, double s, double interval);

  const IntegrationFrame* Frame = nullptr;
  ViewRay Ray{};
  glm::vec3 Colour{ 0.0f };
  float Transmittance = 1.0f;
  double FirstVisible = std::numeric_limits<double>::infinity();
};

} // namespace ffd

#endif
