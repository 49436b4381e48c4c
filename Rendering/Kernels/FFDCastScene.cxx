// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDCastScene.h"

#include <glm/geometric.hpp>

namespace ffd
{

//------------------------------------------------------------------------------
void CastStatistics::Add(const CastStatistics& other)
{
  this->Rays += other.Rays;
  this->Segments += other.Segments;
  this->SegmentLength += other.SegmentLength;
  this->Samples += other.Samples;
  this->VisibleSamples += other.VisibleSamples;
  this->DistanceLookups += other.DistanceLookups;
  this->Evaluations += other.Evaluations;
  this->Unconverged += other.Unconverged;
}

//------------------------------------------------------------------------------
const Box& GetWholeDeformed(const CastScene& scene)
{
  return scene.WholeDeformed ? *scene.WholeDeformed : scene.DeformedBounds;
}

//------------------------------------------------------------------------------
glm::dvec3 FindMiddle(const CastScene& scene)
{
  const VolumeView& volume = scene.Volume;
  const glm::dvec3 rest = scene.WholeAtRest
    ? 0.5 * (scene.WholeAtRest->Min + scene.WholeAtRest->Max)
    : volume.FirstVoxel + volume.IndexToData * (0.5 * (volume.LowerIndex() + volume.UpperIndex()));
  const Box& whole = GetWholeDeformed(scene);
  const glm::dvec3 deformed = 0.5 * (whole.Min + whole.Max);
  return glm::length(deformed - rest) <= glm::length(whole.Max - whole.Min) ? rest : deformed;
}

} // namespace ffd
