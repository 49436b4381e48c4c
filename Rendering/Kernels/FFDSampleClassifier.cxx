// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSampleClassifier.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace ffd
{

//------------------------------------------------------------------------------
SampleClassifier::SampleClassifier(const VolumeView& volume, Interpolation interpolation,
  const TransferTable& table, const Shading& material, bool shade)
  : Volume(volume)
  , Table(table)
  , Material(material)
  , Fetch(SelectSampleFunctions(volume.Type, interpolation))
  , Shade(shade)
{
}

//------------------------------------------------------------------------------
void SampleClassifier::Values(const glm::dvec3& q, double* values) const
{
  values[0] = this->Fetch.Value(this->Volume, q);
}

//------------------------------------------------------------------------------
SampleClassifier::Look SampleClassifier::Classify(
  const glm::dvec3& q, const double* values, const NormalSource& normals) const
{
  const TransferTable::Sample sample = this->Table.Lookup(values[0]);
  if (!(sample.Extinction > 0.0f))
  {
    return { sample.Colour, 0.0f };
  }
  return { this->Light(0, q, sample.Colour, normals), sample.Extinction };
}

//------------------------------------------------------------------------------
glm::vec4 SampleClassifier::ClassifyValue(int, double value) const
{
  const TransferTable::Sample sample = this->Table.Lookup(value);
  const double opacity =
    1.0 - std::exp2(-static_cast<double>(sample.Extinction) * this->Table.GetUnitDistance());
  return glm::vec4(sample.Colour, static_cast<float>(opacity));
}

//------------------------------------------------------------------------------
glm::vec3 SampleClassifier::Light(
  int, const glm::dvec3& q, const glm::vec3& colour, const NormalSource& normals) const
{
  if (!this->Shade)
  {
    return colour;
  }
  const glm::dvec3 gradient = normals.ToWorld(this->Fetch.Gradient(this->Volume, q));
  const double magnitude = glm::length(gradient);
  const glm::dvec3 normal = magnitude > 0.0 && std::isfinite(magnitude) ? -gradient / magnitude
                                                                        : glm::dvec3(0.0);
  return this->Material.Shade(colour, normals.GetPosition(), normal, normals.GetToEye());
}

} // namespace ffd
