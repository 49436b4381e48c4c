// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed, not wrapped.
#ifndef vtkFFDInverseRayVolumeMapperInternals_h
#define vtkFFDInverseRayVolumeMapperInternals_h

#include "vtkFFDFrame.h"
#include "vtkFFDFrameCache.h"
#include "vtkFFDFrameCaster.h"
#include "vtkFFDFramePlan.h"
#include "vtkFFDImageDisplay.h"
#include "vtkFFDImageRegion.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDRayStatistics.h"

#include "vtkContourValues.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"
#include "vtkWeakPointer.h"

#include <glm/mat4x4.hpp>

#include <string>
#include <vector>

/// The parts of a mapper that frames are made by, and what is kept between frames.
class vtkFFDInverseRayVolumeMapper::vtkInternals
{
public:
  explicit vtkInternals(vtkFFDInverseRayVolumeMapper* self)
    : Self(self)
  {
  }

  /// Bring the cache up to date for a picture. False, with a message, if there is none.
  bool Update(vtkVolumeProperty* property, std::string& message);
  bool Prepare(vtkVolume* volume, std::string& message);
  bool Refuse(const char* what) const;
  bool CanMakeImage(const char* method, int width, int height) const;
  static bool CheckView(vtkRenderer* renderer, vtkVolume* volume, std::string& message);
  vtkFFDParallelFor MakeParallelFor() const;
  bool CanRender(vtkRenderer* renderer, vtkVolume* volume);
  vtkFFDImageRegion FindRegion(vtkRenderer* renderer, vtkVolume* volume,
    const vtkFFDImageRegion& whole, const int viewport[4]);
  const float* FindDepths(vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& region,
    const glm::ivec2& pixels, const int viewport[4]);
  vtkMTimeType FindSceneTime(vtkVolume* volume) const;
  void ReleaseImages();
  void KeepPicture(bool reuses, bool moving);

  vtkFFDInverseRayVolumeMapper* Self;

  // The frame in progress, or null. Meanwhile only the frame changes the following members.
  vtkFFDFrame* Frame = nullptr;
  bool Prepared = false; // the frame is past its preparation
  bool Quiet = false;    // it does not report now

  vtkFFDFrameCache Cache;
  vtkFFDFramePlan Plan;
  vtkFFDFrameCaster Caster{ Self, Cache };
  vtkFFDImageDisplay Display;

  /// The place of a picture in the window, and the view of the camera there.
  struct View
  {
    bool Complete = false;
    vtkWeakPointer<vtkRenderer> Renderer;
    vtkWeakPointer<vtkVolume> Volume;
    vtkFFDImageRegion Region;
    glm::dmat4 DataToNdc{ 1.0 };
    ffd::VisibleRectangle Visible;
    const vtkFFDFrameCaster::Picture* Picture = nullptr; // where it is kept

    bool IsSameAs(const View& other) const
    {
      return this->Complete && this->Renderer == other.Renderer && this->Volume == other.Volume &&
        this->Region.Viewport == other.Region.Viewport && this->DataToNdc == other.DataToNdc;
    }
  };

  void PassOnPicture(const View& view);
  void Draw(const View& view, const vtkFFDImageDisplay::Layers& layers);

  View Shown;                             // the picture of the last frame in a window
  View Last;                              // the one before, for a frame that is aborted
  vtkFFDFrameCaster::Picture LastPicture; // that, where the caster has made another one of it
  std::vector<float> VisibleDepths;       // of the first visible samples, where these are asked for
  vtkNew<vtkImageData> ColorImage;        // the last frame that became an image
  std::vector<float> ImageDepths;         // of that
  vtkNew<vtkContourValues> DepthPassContourValues;
  bool ToldOfPeeling = false;
  vtkNew<vtkFFDRayStatistics> Statistics;
};

#endif
