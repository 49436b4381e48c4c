// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrameScene
 * @brief   what the kernels cast the rays of a frame through
 *
 * Private to this module: not installed, not wrapped. Views of a cache for one camera, in data
 * coordinates; the cache must outlive it, and stay as it is.
 */
#ifndef vtkFFDFrameScene_h
#define vtkFFDFrameScene_h

#include "FFDCastScene.h"
#include "Optics/FFDSampleClassifier.h"
#include "Optics/FFDShading.h"

#include <memory>

class vtkFFDFrameCache;
class vtkFFDInverseRayVolumeMapper;
class vtkRenderer;
class vtkVolume;
class vtkVolumeProperty;
struct vtkFFDImageRegion;

class vtkFFDFrameScene
{
public:
  /// `depths`: of what is already drawn, see ffd::CastScene.
  vtkFFDFrameScene(vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache,
    vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& region, const float* depths);
  ~vtkFFDFrameScene();
  vtkFFDFrameScene(const vtkFFDFrameScene&) = delete;
  vtkFFDFrameScene& operator=(const vtkFFDFrameScene&) = delete;

  const ffd::CastScene& Get() const { return this->Scene; }

  /// The deformed bounds, as far as they are neither cropped nor clipped by the clip box; without
  /// volume if nothing is left of them.
  static ffd::Box FindVisibleBounds(
    vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache);

private:
  void MakeClassifier(vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache,
    vtkVolumeProperty* property);

  ffd::CastScene Scene;
  ffd::Box WholeBounds; // deformed, of which a clip box shows a part
  ffd::Shading Lighting;
  std::unique_ptr<ffd::SampleClassifier> Classifier;
};

#endif
