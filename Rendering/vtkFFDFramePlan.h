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

#include <array>

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

  /// A frame in a window, and the seconds that it took.
  struct Frame
  {
    double Preparation; ///< before the picture: what the scene, not the number of rays, makes long
    double Picture;
    double CastPart; ///< of the picture, 0 to 1; less than 1 after an abort
    double Step;     ///< pixels between the rays
    bool Interactive;
    double ReusedFraction;
  };

  /// After a frame in a window.
  void RecordFrame(
    vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache, const Frame& frame);

  bool HasTimeEstimate() const { return this->TimedPixels > 0.0; }
  /// Seconds that a frame like the last one is expected to take with a ray for each pixel.
  double EstimateTime() const { return this->Preparation + this->FixedTime + this->TimeOfRays; }
  /// Seconds that a still picture is expected to take.
  double GetStillTime() const { return this->StillTime; }

  /**
   * Pixels between rays with which a frame like the last one takes so many seconds. A frame whose
   * rays take a small part of its time is no shorter with fewer of them: they are then given more
   * than what is left to them, though never more than `seconds`.
   */
  double FindDistance(double seconds) const;

private:
  double FindStep(vtkFFDInverseRayVolumeMapper* mapper, double allotted) const;
  void RecordTimes(const Frame& frame);
  void RecordStillTime(
    vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache, const Frame& frame);

  // The time of a frame while the scene moves, in seconds: that of its preparation, and of the
  // picture a fixed part and that of a ray for each pixel.
  double Preparation = 0.0;
  double FixedTime = 0.0;
  double TimeOfRays = 0.0;
  std::array<double, 3> Covariance{}; // of FixedTime, of it with TimeOfRays, of TimeOfRays
  double TimedPixels = 0.0;           // of the region that TimeOfRays is the time of
  double LastExcess = 0.0;            // of the last frame over what was expected
  double Pixels = 0.0;                // of the region of the last frame
  double StillTime = 0.0;
  double LastStep = 0.0; // pixels, of the last frame while the scene moved
};

#endif
