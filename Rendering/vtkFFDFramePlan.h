// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFramePlan
 * @brief   finds how a frame is cast: settings, region, distance of the rays
 *
 * Private to this module: not installed, not wrapped. Remembers how long the last frame took, which
 * the distance of the rays follows while the scene moves.
 */
#ifndef vtkFFDFramePlan_h
#define vtkFFDFramePlan_h

#include "vtkFFDImageRegion.h"

#include "FFDCastScene.h"

#include <glm/vec2.hpp>

class vtkFFDFrame;
class vtkFFDFrameCache;
class vtkFFDInverseRayVolumeMapper;
class vtkRenderer;
class vtkVolume;

class vtkFFDFramePlan
{
public:
  /// `interactive`: of a picture while the scene moves, `step`: pixels between its rays. Lengths
  /// are in data units.
  static ffd::CastSettings MakeSettings(vtkFFDInverseRayVolumeMapper* mapper,
    const vtkFFDFrameCache& cache, vtkVolume* volume, bool interactive, double step);

  /// The part of a viewport in which `visible`, a box of data coordinates, is seen; without rays if
  /// it is not.
  static vtkFFDImageRegion FindRegion(const ffd::Box& visible, vtkRenderer* renderer,
    vtkVolume* volume, const vtkFFDImageRegion& whole);

  /// Whether the renderer has too little time for a still picture.
  static bool IsMoving(vtkFFDInverseRayVolumeMapper* mapper, vtkVolume* volume);

  /// Place the rays of a region that has one for each pixel; `shown`: in a window. Returns whether
  /// the picture is an interactive one.
  bool PlaceRays(
    vtkFFDInverseRayVolumeMapper* mapper, vtkVolume* volume, bool shown, vtkFFDImageRegion& region);

  /// After a frame in a window: `seconds` that it took with rays `step` pixels apart.
  void RecordFrame(double seconds, double step, bool interactive, double reusedFraction);

  /// After a frame in a window that may have been aborted: what it tells of still pictures.
  void RecordStillTime(vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache,
    const vtkFFDFrame& frame, bool interactive, double reusedFraction);

  bool HasTimeEstimate() const { return this->TimePerPixel > 0.0; }
  /// Seconds that a frame like the last one is expected to take.
  double EstimateTime() const { return this->TimePerPixel * this->Pixels; }
  /// Seconds that a still picture is expected to take.
  double GetStillTime() const { return this->StillTime; }

private:
  double FindStep(vtkFFDInverseRayVolumeMapper* mapper, double allotted) const;

  double TimePerPixel = 0.0; // seconds, of the last frame in a window, with a ray for each pixel
  double Pixels = 0.0;       // of the region of that frame
  double StillTime = 0.0;
  double LastStep = 0.0; // pixels, of the last frame while the scene moved
};

#endif
