// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTracedRays.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace
{

/// Lines that a parabola is drawn with.
constexpr int LinesPerCurve = 8;

/// The segment that begins at a vertex.
struct Segment
{
  int Index = -1;
  double Length = 0.0;
  double RestLength = 0.0;
  int Samples = 0;
  int Leaps = 0;
  bool Passed = false;
};

unsigned char ToByte(float value)
{
  return static_cast<unsigned char>(std::min(std::max(value, 0.0f), 1.0f) * 255.0f + 0.5f);
}

template <class Array>
void Prepare(Array* array, const char* name, int components = 1)
{
  array->SetName(name);
  array->SetNumberOfComponents(components);
}

} // namespace

//------------------------------------------------------------------------------
/// One polydata in the making.
struct vtkFFDTracedRays::Output
{
  explicit Output(vtkPolyData* target)
    : Target(target)
  {
    this->Points->SetDataTypeToDouble();
    Prepare(this->T.Get(), "T");
    Prepare(this->SegmentIndex.Get(), "Segment");
    Prepare(this->SegmentLength.Get(), "SegmentLength");
    Prepare(this->RestLength.Get(), "RestLength");
    Prepare(this->SampleCount.Get(), "Samples");
    Prepare(this->LeapCount.Get(), "Leaps");
    Prepare(this->Passed.Get(), "Passed");
    Prepare(this->Ray.Get(), "Ray");
    Prepare(this->Leap.Get(), "Leap");
    Prepare(this->Interval.Get(), "Interval");
    Prepare(this->Opacity.Get(), "Opacity");
    Prepare(this->Pixel.Get(), "Pixel", 2);
    Prepare(this->Segments.Get(), "Segments");
    Prepare(this->RaySamples.Get(), "Samples");
    Prepare(this->RayVisible.Get(), "VisibleSamples");
    Prepare(this->RayLeaps.Get(), "Leaps");
    Prepare(this->Terminated.Get(), "Terminated");
    Prepare(this->Color.Get(), "Color", 4);
  }

  void AddSegment(const Segment& segment)
  {
    this->SegmentIndex->InsertNextValue(segment.Index);
    this->SegmentLength->InsertNextValue(segment.Length);
    this->RestLength->InsertNextValue(segment.RestLength);
    this->SampleCount->InsertNextValue(segment.Samples);
    this->LeapCount->InsertNextValue(segment.Leaps);
    this->Passed->InsertNextValue(segment.Passed ? 1 : 0);
  }

  vtkPolyData* Target;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Cells;
  // Arrays of the points.
  vtkNew<vtkDoubleArray> T;
  vtkNew<vtkIntArray> SegmentIndex;
  vtkNew<vtkDoubleArray> SegmentLength;
  vtkNew<vtkDoubleArray> RestLength;
  vtkNew<vtkIntArray> SampleCount;
  vtkNew<vtkIntArray> LeapCount;
  vtkNew<vtkUnsignedCharArray> Passed;
  // Arrays of the samples.
  vtkNew<vtkIntArray> Ray;
  vtkNew<vtkUnsignedCharArray> Leap;
  vtkNew<vtkDoubleArray> Interval;
  vtkNew<vtkDoubleArray> Opacity;
  // Arrays of the rays.
  vtkNew<vtkIntArray> Pixel;
  vtkNew<vtkIntArray> Segments;
  vtkNew<vtkIntArray> RaySamples;
  vtkNew<vtkIntArray> RayVisible;
  vtkNew<vtkIntArray> RayLeaps;
  vtkNew<vtkUnsignedCharArray> Terminated;
  vtkNew<vtkUnsignedCharArray> Color;
};

//------------------------------------------------------------------------------
vtkFFDTracedRays::vtkFFDTracedRays(
  const ffd::CastScene& scene, vtkPolyData* rays, vtkPolyData* viewingRays, vtkPolyData* samples)
  : Scene(scene)
  , Rays(new Output(rays))
  , ViewingRays(viewingRays ? new Output(viewingRays) : nullptr)
  , Samples(samples ? new Output(samples) : nullptr)
{
}

//------------------------------------------------------------------------------
vtkFFDTracedRays::~vtkFFDTracedRays() = default;

//------------------------------------------------------------------------------
void vtkFFDTracedRays::AddVertex(const ffd::TracedRay& ray, const glm::dvec3& index, double t)
{
  const glm::dvec3 rest = this->Scene.Volume.FirstVoxel + this->Scene.Volume.IndexToData * index;
  this->Rays->Points->InsertNextPoint(&rest.x);
  this->Rays->T->InsertNextValue(t);
  if (this->ViewingRays)
  {
    const glm::dvec3 p = ray.Viewing.Origin + t * ray.Viewing.Direction;
    this->ViewingRays->Points->InsertNextPoint(&p.x);
    this->ViewingRays->T->InsertNextValue(t);
  }
}

//------------------------------------------------------------------------------
void vtkFFDTracedRays::AddSamples(const ffd::TracedRay& ray)
{
  Output& out = *this->Samples;
  for (std::size_t segment = 0; segment < ray.Segments.size(); ++segment)
  {
    for (std::size_t i = ray.Segments[segment].FirstSample; i < ray.Segments[segment].EndSample;
         ++i)
    {
      const ffd::TracedSample& sample = ray.Samples[i];
      const glm::dvec3 rest =
        this->Scene.Volume.FirstVoxel + this->Scene.Volume.IndexToData * sample.Index;
      const vtkIdType id = out.Points->InsertNextPoint(&rest.x);
      out.Cells->InsertNextCell(1, &id);
      out.T->InsertNextValue(sample.T);
      out.SegmentIndex->InsertNextValue(static_cast<int>(segment));
      out.Ray->InsertNextValue(this->Count);
      out.Leap->InsertNextValue(sample.Leap ? 1 : 0);
      out.Interval->InsertNextValue(sample.Interval);
      out.Opacity->InsertNextValue(1.0 - std::exp2(-sample.Extinction * sample.Interval));
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDTracedRays::Add(const ffd::TracedRay& ray, int x, int y)
{
  if (ray.Segments.empty())
  {
    return;
  }
  Output& out = *this->Rays;
  const vtkIdType first = out.Points->GetNumberOfPoints();
  int samples = 0;
  int visible = 0;
  int leaps = 0;
  for (std::size_t i = 0; i < ray.Segments.size(); ++i)
  {
    const ffd::TracedSegment& traced = ray.Segments[i];
    const glm::dmat3& toData = this->Scene.Volume.IndexToData;
    const int lines = traced.Curve.IsLine() ? 1 : LinesPerCurve;
    Segment segment;
    segment.Index = static_cast<int>(i);
    segment.Length = traced.To - traced.From;
    segment.Passed = traced.Passed;
    for (std::size_t s = traced.FirstSample; s < traced.EndSample; ++s)
    {
      (ray.Samples[s].Leap ? segment.Leaps : segment.Samples) += 1;
      visible += ray.Samples[s].Extinction > 0.0f ? 1 : 0;
    }
    samples += segment.Samples;
    leaps += segment.Leaps;
    for (int n = 0; n < lines; ++n)
    {
      segment.RestLength += glm::length(
        toData * (traced.Curve.At((n + 1.0) / lines) - traced.Curve.At(1.0 * n / lines)));
    }
    for (int n = 0; n < lines; ++n)
    {
      const double s = 1.0 * n / lines;
      this->AddVertex(ray, traced.Curve.At(s), traced.From + s * segment.Length);
      out.AddSegment(segment);
    }
  }
  this->AddVertex(ray, ray.Segments.back().Curve.At(1.0), ray.Segments.back().To);
  out.AddSegment(Segment());
  const vtkIdType count = out.Points->GetNumberOfPoints() - first;
  std::vector<vtkIdType> ids(static_cast<std::size_t>(count));
  for (vtkIdType i = 0; i < count; ++i)
  {
    ids[static_cast<std::size_t>(i)] = first + i;
  }
  out.Cells->InsertNextCell(count, ids.data());
  if (this->ViewingRays)
  {
    this->ViewingRays->Cells->InsertNextCell(count, ids.data());
  }
  if (this->Samples)
  {
    this->AddSamples(ray);
  }
  const int pixel[2] = { x, y };
  out.Pixel->InsertNextTypedTuple(pixel);
  out.Segments->InsertNextValue(static_cast<int>(ray.Segments.size()));
  out.RaySamples->InsertNextValue(samples);
  out.RayVisible->InsertNextValue(visible);
  out.RayLeaps->InsertNextValue(leaps);
  out.Terminated->InsertNextValue(ray.Terminated ? 1 : 0);
  const float alpha = ray.Color.a;
  const unsigned char color[4] = { ToByte(alpha > 0.0f ? ray.Color.r / alpha : 0.0f),
    ToByte(alpha > 0.0f ? ray.Color.g / alpha : 0.0f),
    ToByte(alpha > 0.0f ? ray.Color.b / alpha : 0.0f), ToByte(alpha) };
  out.Color->InsertNextTypedTuple(color);
  ++this->Count;
}

//------------------------------------------------------------------------------
void vtkFFDTracedRays::Finish()
{
  Output* const lines[] = { this->Rays.get(), this->ViewingRays.get() };
  Output& rays = *this->Rays;
  for (Output* out : lines)
  {
    if (!out)
    {
      continue;
    }
    out->Target->Initialize();
    out->Target->SetPoints(out->Points);
    out->Target->SetLines(out->Cells);
    out->Target->GetPointData()->AddArray(out->T);
    // Vertices and rays are the same in both spaces.
    vtkDataArray* const ofPoints[] = { rays.SegmentIndex, rays.SegmentLength, rays.RestLength,
      rays.SampleCount, rays.LeapCount, rays.Passed };
    for (vtkDataArray* array : ofPoints)
    {
      out->Target->GetPointData()->AddArray(array);
    }
    vtkDataArray* const ofRays[] = { rays.Pixel, rays.Segments, rays.RaySamples, rays.RayVisible,
      rays.RayLeaps, rays.Terminated, rays.Color };
    for (vtkDataArray* array : ofRays)
    {
      out->Target->GetCellData()->AddArray(array);
    }
  }
  if (this->Samples)
  {
    Output& out = *this->Samples;
    out.Target->Initialize();
    out.Target->SetPoints(out.Points);
    out.Target->SetVerts(out.Cells);
    vtkDataArray* const arrays[] = { out.T, out.SegmentIndex, out.Ray, out.Leap, out.Interval,
      out.Opacity };
    for (vtkDataArray* array : arrays)
    {
      out.Target->GetPointData()->AddArray(array);
    }
  }
}
