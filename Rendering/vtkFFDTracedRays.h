// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDTracedRays
 * @brief   makes the outputs of vtkFFDRayTracer from traced rays
 *
 * Private to this module: not installed, not wrapped.
 */
#ifndef vtkFFDTracedRays_h
#define vtkFFDTracedRays_h

#include "FFDCastScene.h"
#include "FFDTracedRay.h"

#include <memory>

class vtkPolyData;

class vtkFFDTracedRays
{
public:
  /// `viewingRays` and `samples` may be null; the scene outlives this object.
  vtkFFDTracedRays(
    const ffd::CastScene& scene, vtkPolyData* rays, vtkPolyData* viewingRays, vtkPolyData* samples);
  ~vtkFFDTracedRays();

  /// A ray without segments, which misses the volume, leaves nothing: VTK has no empty polylines.
  void Add(const ffd::TracedRay& ray, int x, int y);

  /// Hand over to the outputs.
  void Finish();

private:
  struct Output;

  void AddVertex(const ffd::TracedRay& ray, const glm::dvec3& index, double t);
  void AddSamples(const ffd::TracedRay& ray);

  const ffd::CastScene& Scene;
  std::unique_ptr<Output> Rays;
  std::unique_ptr<Output> ViewingRays;
  std::unique_ptr<Output> Samples;
  int Count = 0;
};

#endif
