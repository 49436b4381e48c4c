// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFramebuffer
 * @brief   what the framebuffer that a renderer draws into is like, and its pixels
 *
 * Private to this module: not installed, not wrapped. It leaves the state of OpenGL as it is.
 */
#ifndef vtkFFDFramebuffer_h
#define vtkFFDFramebuffer_h

#include <vector>

class vtkRenderer;

class vtkFFDFramebuffer
{
public:
  /// Lets OpenGL begin with what it was asked for, while rays are cast.
  static void Flush(vtkRenderer* renderer);

  /// Whether what is drawn now would be rounded to bytes: then an image may consist of these.
  static bool DrawsBytes(vtkRenderer* renderer);

  /**
   * The rectangle (x, y, width, height) of the framebuffer that the renderer draws into now: that
   * of a render pass, which may be larger than the window, or the part of the window that is the
   * renderer's. Empty without a window.
   */
  static void FindViewport(vtkRenderer* renderer, int viewport[4]);

  /**
   * The depths, 0 to 1, of a rectangle (x, y, width, height) of that framebuffer, one a pixel, rows
   * bottom up; of several samples a pixel one is taken. Returns false, and leaves `depths` as they
   * are, where the framebuffer has no depth that can be read.
   */
  static bool ReadDepths(vtkRenderer* renderer, const int rectangle[4], float* depths);

  /**
   * Blends pixels, premultiplied RGBA in rows of `width` of which those of the rectangle (x, y,
   * width, height) are taken, with those of the framebuffer without drawing them, if that takes
   * less time: where OpenGL is Mesa's rasterizer and draws bytes into a texture, one sample a
   * pixel. False where nothing was done, or OpenGL could not. `memory`: kept for the next time.
   */
  static bool BlendPixels(const int rectangle[4], const unsigned char* pixels, int width,
    std::vector<unsigned char>& memory);
};

#endif
