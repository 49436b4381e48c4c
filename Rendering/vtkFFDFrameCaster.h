// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrameCaster
 * @brief   casts the rays of a frame, with progress, and keeps its picture
 *
 * Private to this module: not installed, not wrapped. Parts of the last picture of a kind are shown
 * again where vtkFFDFrameCoherence says so. The mapper and its cache must outlive it.
 */
#ifndef vtkFFDFrameCaster_h
#define vtkFFDFrameCaster_h

#include "vtkFFDFinalColors.h"
#include "vtkFFDFrameCoherence.h"
#include "vtkFFDFrameLayers.h"
#include "vtkFFDImageDisplay.h"
#include "vtkFFDImageRegion.h"
#include "vtkFFDParallelFor.h"

#include "FFDCastScene.h"
#include "FFDVisibleRectangle.h"

#include "vtkType.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace ffd
{
class RayCaster;
}

class vtkFFDFrame;
class vtkFFDFrameCache;
class vtkFFDInverseRayVolumeMapper;
class vtkRenderer;
class vtkVolume;

class vtkFFDFrameCaster
{
public:
  vtkFFDFrameCaster(vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache);
  ~vtkFFDFrameCaster();
  vtkFFDFrameCaster(const vtkFFDFrameCaster&) = delete;
  vtkFFDFrameCaster& operator=(const vtkFFDFrameCaster&) = delete;

  /// Colors of an image, 4 numbers a ray: as floats or as bytes, the others are empty, or both.
  struct Picture
  {
    std::vector<float> Floats; ///< premultiplied
    std::vector<unsigned char> Bytes;
  };

  /// What pictures are made for. The last one of each kind is kept: a coarse frame, as a click
  /// makes one, or an image that is not shown, does not take the still picture away.
  enum class Purpose
  {
    Moving, ///< frames in a window, and still ones that nothing is reused of
    Still,  ///< StillFrameCoherence of the mapper
    Other   ///< images and selectors
  };

  /// Pictures are of that kind from now on.
  void Begin(Purpose purpose) { this->Now = &this->Kept[static_cast<std::size_t>(purpose)]; }

  /// Input of a cast.
  struct View
  {
    vtkRenderer* Renderer = nullptr;
    vtkVolume* Volume = nullptr;
    vtkFFDImageRegion Region;
    bool Interactive = false;     ///< see vtkFFDFramePlan::PlaceRays()
    bool InWindow = false;        ///< else it is for a selector or an image
    bool IsDrawn = false;         ///< in a window or for a selector
    bool HasTimeEstimate = false; ///< about how long it takes
    /// Whether to make bytes; empty: floats. Asked when observers have been told of the start, as
    /// they may change what is drawn into.
    std::function<bool()> AsBytes;
    bool Premultiplied = true;     ///< of bytes
    vtkMTimeType SettingsTime = 0; ///< of the mapper, without its deformation
  };

  /**
   * Make the picture. `depths`, one a ray, or null: those of what is already drawn; `outDepths`, or
   * null: those of the first visible samples. False after an abort.
   */
  bool Cast(vtkFFDFrame& frame, const View& view, const float* depths, float* outDepths);

  /// What was cast last, of the kind.
  Picture& GetPicture() { return this->Now->Colors; }

  /// Whether there is memory for a picture of bytes already.
  bool HoldsBytes(std::size_t rays) const { return this->Now->Colors.Bytes.capacity() >= 4 * rays; }

  /// What is visible of it if it is drawn, and after CastLayers() of these, too.
  const ffd::VisibleRectangle& GetVisible() const { return this->Now->Visible; }

  /// Window depths of the pixels of a frame: to be written to before Cast().
  std::vector<float>& GetWindowDepths() { return this->Layers.GetWindowDepths(); }

  /// Depths of the rays, for Cast(): rays may be farther apart than pixels.
  const float* FindRayDepths(const vtkFFDImageRegion& region, const glm::ivec2& pixels);

  /// After Cast() with the depths of FindRayDepths(), see vtkFFDImageDisplay.
  vtkFFDImageDisplay::Layers CastLayers(const View& view, const glm::ivec2& pixels);

  /// Whether the frame may show parts of the last one again, see FrameCoherence and
  /// StillFrameCoherence of the mapper.
  bool CanReuse(vtkVolume* volume) const;

  vtkFFDFrameCoherence& GetCoherence() { return this->Now->Coherence; }

  /// Of what pictures are told by, in bytes.
  std::size_t GetCoherenceSize() const;

  double GetReusedFraction() const { return this->ReusedFraction; }

  /// Seconds of the last Cast() before its rays, which do not depend on their number.
  double GetPreparationTime() const { return this->PreparationTime; }

  /// Whether the last frame was cast with Classification::Intervals.
  bool ClassifiesIntervals() const { return this->Intervals; }

  /// The images are as large as the window, and made anew with every frame.
  void ReleaseImages();

private:
  vtkFFDParallelFor MakeParallelFor() const;
  ffd::CastSettings MakeSettings(const View& view) const;
  std::unique_ptr<const ffd::RayCaster> MakeCaster(const View& view, const ffd::CastScene& scene,
    bool layers, bool reuses, ffd::CastImage& image,
    std::vector<vtkFFDFrameCoherence::Part>& tiles);

  vtkFFDInverseRayVolumeMapper* Mapper; // not owned
  const vtkFFDFrameCache& Cache;

  struct KeptPicture
  {
    Picture Colors;
    ffd::VisibleRectangle Visible;
    std::vector<float> FirstVisible; // depths of the samples of its rays; empty where not needed
    vtkFFDFrameCoherence Coherence;
  };

  std::array<KeptPicture, 3> Kept; // by Purpose
  KeptPicture* Now = &Kept[0];
  vtkFFDFinalColors FinalColors; // of the frame in progress
  vtkFFDFrameLayers Layers;
  double ReusedFraction = 0.0;
  double PreparationTime = 0.0;
  bool Intervals = false;
};

#endif
