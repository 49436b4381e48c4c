// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrameLayers
 * @brief   finds what is seen in front of geometry where a picture has fewer rays than pixels
 *
 * Private to this module: not installed, not wrapped. A ray ends at the farthest geometry of its
 * pixels. Where geometry is nearer in some of them, layers tell what the volume shows in front of
 * it, see vtkFFDImageDisplay::Layers.
 */
#ifndef vtkFFDFrameLayers_h
#define vtkFFDFrameLayers_h

#include "vtkFFDImageDisplay.h"
#include "vtkFFDImageRegion.h"

#include "FFDVisibleRectangle.h"

#include <glm/vec2.hpp>

#include <vector>

class vtkFFDFinalColors;
class vtkFFDParallelFor;

namespace ffd
{
struct CastScene;
struct CastSettings;
}

class vtkFFDFrameLayers
{
public:
  /// The picture that the layers are of.
  struct Picture
  {
    const std::vector<float>& Colors;       ///< premultiplied, 4 numbers a ray
    const std::vector<float>& FirstVisible; ///< window depths of the first visible samples
    const vtkFFDFinalColors& FinalColors;
  };

  /// Window depths of the pixels of a frame: to be written to before the picture is cast.
  std::vector<float>& GetWindowDepths() { return this->WindowDepths; }

  /// Window depths of the rays of that picture.
  const float* FindRayDepths(const vtkFFDImageRegion& region, const glm::ivec2& pixels,
    const vtkFFDParallelFor& parallelFor);

  /// Cast the layers of a picture with the depths of FindRayDepths(). `scene`: without depths.
  /// What is visible of them is added to `visible`.
  vtkFFDImageDisplay::Layers Cast(const ffd::CastScene& scene, const ffd::CastSettings& settings,
    const vtkFFDImageRegion& region, const glm::ivec2& pixels, const Picture& picture,
    const vtkFFDParallelFor& parallelFor, ffd::VisibleRectangle& visible);

  /// The images are as large as the window, and made anew with every frame.
  void ReleaseImages();

private:
  void CastNearer(ffd::CastScene scene, const ffd::CastSettings& settings,
    const vtkFFDImageRegion& region, const Picture& picture, const vtkFFDParallelFor& parallelFor,
    ffd::VisibleRectangle& visible);

  std::vector<float> WindowDepths;
  std::vector<float> RayDepths;     // of the rays, where these are not the pixels: the farthest
  std::vector<float> NearestDepths; // and the nearest of their pixels
  std::vector<float> NearDepths;    // of rays that end before them; 0 where there is none
  std::vector<float> NearColors;
  std::vector<float> LayerDepths; // see vtkFFDImageDisplay::Layers
};

#endif
