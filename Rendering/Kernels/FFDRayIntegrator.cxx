// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDRayIntegrator.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace ffd
{
namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Of a sample on a piece.
class PieceNormals : public NormalSource
{
public:
  PieceNormals(
    const ViewRay& ray, const CameraView& camera, const SampledPiece& piece, double s)
    : NormalSource(ray, camera, piece.T0 + s * piece.Dt)
    , Piece(piece)
    , S(s)
  {
  }
  glm::dvec3 ToWorld(const glm::dvec3& byIndex) const override
  {
    return this->Piece.GradientToWorld(this->S, byIndex);
  }

private:
  const SampledPiece& Piece;
  double S;
};

} // namespace

//------------------------------------------------------------------------------
void RayIntegrator::Begin(const IntegrationFrame& frame, const ViewRay& ray)
{
  this->Frame = &frame;
  this->Ray = ray;
  this->Colour = glm::vec3(0.0f);
  this->Transmittance = 1.0f;
  this->FirstVisible = Infinity;
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::AddSample(
  const SampledPiece& piece, double s, double interval)
{
  return this->Composite(piece, s, interval);
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::Composite(
  const SampledPiece& piece, double s, double interval)
{
  const IntegrationFrame& frame = *this->Frame;
  // Packets round otherwise when they find out whether it is inside.
  const glm::dvec3 q =
    glm::clamp(piece.Curve.At(s), glm::dvec3(0.0), frame.Scene->Volume.UpperIndex());
  double values[SampleClassifier::LargestNumberOfComponents];
  frame.Classifier->Values(q, values);
  const SampleClassifier::Look look = frame.Classifier->Classify(
    q, values, PieceNormals(this->Ray, frame.Scene->Camera, piece, s));
  if (!(look.Extinction > 0.0f))
  {
    return { false, false, 0.0f };
  }
  // Length by which the opacity of the sample is corrected, world units.
  const double length = frame.Settings->Opacity == OpacityLength::World
    ? interval * piece.Dt
    : interval * glm::length(frame.RestToWorld * piece.Curve.Velocity(s));
  const float transmittance = frame.Transmittance(look.Extinction * static_cast<float>(length));
  this->FirstVisible = std::min(this->FirstVisible, piece.T0 + s * piece.Dt);
  this->Colour += (this->Transmittance * (1.0f - transmittance)) * look.Colour;
  this->Transmittance *= transmittance;
  return { true, this->Transmittance < frame.Settings->TerminationTransmittance,
    look.Extinction };
}

} // namespace ffd
