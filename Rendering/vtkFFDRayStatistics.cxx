// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDRayStatistics.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkFFDRayStatistics);

//------------------------------------------------------------------------------
vtkFFDRayStatistics::vtkFFDRayStatistics() = default;

//------------------------------------------------------------------------------
vtkFFDRayStatistics::~vtkFFDRayStatistics() = default;

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::PerRay(vtkTypeInt64 count) const
{
  return this->NumberOfRays > 0
    ? static_cast<double>(count) / static_cast<double>(this->NumberOfRays)
    : 0.0;
}

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::GetSegmentsPerRay() const
{
  return this->PerRay(this->NumberOfSegments);
}

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::GetAverageSegmentLength() const
{
  return this->NumberOfSegments > 0
    ? this->TotalSegmentLength / static_cast<double>(this->NumberOfSegments)
    : 0.0;
}

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::GetSamplesPerRay() const { return this->PerRay(this->NumberOfSamples); }

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::GetVisibleSamplesPerRay() const
{
  return this->PerRay(this->NumberOfVisibleSamples);
}

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::GetDistanceLookupsPerRay() const
{
  return this->PerRay(this->NumberOfDistanceLookups);
}

//------------------------------------------------------------------------------
double vtkFFDRayStatistics::GetEvaluationsPerRay() const
{
  return this->PerRay(this->NumberOfEvaluations);
}

//------------------------------------------------------------------------------
void vtkFFDRayStatistics::Reset() { this->SetCounts(0, 0, 0.0, 0, 0, 0, 0, 0); }

//------------------------------------------------------------------------------
void vtkFFDRayStatistics::SetCounts(vtkTypeInt64 rays, vtkTypeInt64 segments, double segmentLength,
  vtkTypeInt64 samples, vtkTypeInt64 visibleSamples, vtkTypeInt64 distanceLookups,
  vtkTypeInt64 evaluations, vtkTypeInt64 unconverged)
{
  this->NumberOfRays = rays;
  this->NumberOfSegments = segments;
  this->TotalSegmentLength = segmentLength;
  this->NumberOfSamples = samples;
  this->NumberOfVisibleSamples = visibleSamples;
  this->NumberOfDistanceLookups = distanceLookups;
  this->NumberOfEvaluations = evaluations;
  this->NumberOfUnconvergedPoints = unconverged;
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDRayStatistics::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "NumberOfRays: " << this->NumberOfRays << "\n";
  os << indent << "NumberOfSegments: " << this->NumberOfSegments << "\n";
  os << indent << "TotalSegmentLength: " << this->TotalSegmentLength << "\n";
  os << indent << "NumberOfSamples: " << this->NumberOfSamples << "\n";
  os << indent << "NumberOfVisibleSamples: " << this->NumberOfVisibleSamples << "\n";
  os << indent << "NumberOfDistanceLookups: " << this->NumberOfDistanceLookups << "\n";
  os << indent << "NumberOfEvaluations: " << this->NumberOfEvaluations << "\n";
  os << indent << "NumberOfUnconvergedPoints: " << this->NumberOfUnconvergedPoints << "\n";
}
