// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDImageDisplay
 * @brief   blends a ray cast image into the viewport of a renderer
 *
 * Private to this module: not installed, not wrapped. The image holds premultiplied RGBA and is
 * drawn over a rectangle of the viewport. Rays already end at the geometry that was drawn before;
 * where there are fewer of them than pixels, layers tell what ends at the geometry of each pixel.
 */
#ifndef vtkFFDImageDisplay_h
#define vtkFFDImageDisplay_h

#include "FFDVisibleRectangle.h"

#include <memory>

class vtkRenderer;
class vtkWindow;

class vtkFFDImageDisplay
{
public:
  vtkFFDImageDisplay();
  ~vtkFFDImageDisplay();
  vtkFFDImageDisplay(const vtkFFDImageDisplay&) = delete;
  vtkFFDImageDisplay& operator=(const vtkFFDImageDisplay&) = delete;

  struct Image
  {
    int Width = 0;
    int Height = 0;
    ///@{
    /// Premultiplied RGBA, rows bottom up; one may be null. Bytes are drawn in less time.
    const float* Floats = nullptr;
    const unsigned char* Bytes = nullptr;
    ///@}
    ffd::VisibleRectangle Visible; ///< of it and its layers
  };

  /**
   * Layers of a picture with fewer rays than pixels, to be composed with the geometry of each
   * pixel. Of each ray `Depths` are three window depths that ascend: up to the first there is
   * nothing, at the second the color is the one in `Colors`, from the third on that of the image,
   * and in between it is interpolated.
   */
  struct Layers
  {
    const float* Colors = nullptr; ///< null: there are no layers
    const float* Depths = nullptr;
    const float* PixelDepths = nullptr; ///< of pixels, rows bottom up
    int Pixels[2] = { 0, 0 };           ///< columns and rows of them
    int Origin[2] = { 0, 0 };           ///< of the first one in the viewport
    int Viewport[2] = { 1, 1 };         ///< pixels of the viewport
  };

  /**
   * Draw an image and its layers over the rectangle (xmin, ymin, xmax, ymax) of the viewport, in
   * normalized device coordinates. With layers the image is one of floats. `pixelByPixel`: each
   * pixel of the image lies on one of the window; an image of bytes is then blended without being
   * drawn, where that takes less time. Returns false when the window of the renderer is not an
   * OpenGL one or refuses the texture.
   */
  bool Draw(vtkRenderer* renderer, const Image& image, const Layers& layers,
    const double rectangle[4], bool pixelByPixel);

  void ReleaseGraphicsResources(vtkWindow* window);

private:
  struct Resources;
  std::unique_ptr<Resources> Gl;
};

#endif
