// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDImageDisplay.h"

#include "vtkFFDParallelFor.h"

#include "vtkNew.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

namespace
{

// OpenGL names, by value: the header that has them differs between versions of VTK.
constexpr unsigned int GlBlend = 0x0BE2;
constexpr unsigned int GlDepthTest = 0x0B71;
constexpr unsigned int GlOne = 1;
constexpr unsigned int GlOneMinusSourceAlpha = 0x0303;

const char* const VertexShader = R"(//VTK::System::Dec
in vec4 ndCoordIn;
in vec2 texCoordIn;
uniform vec4 rectangle;
out vec2 texCoord;
void main()
{
  gl_Position = vec4(mix(rectangle.xy, rectangle.zw, texCoordIn), ndCoordIn.zw);
  texCoord = texCoordIn;
}
)";

const char* const FragmentShader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D image;
void main()
{
  gl_FragData[0] = clamp(texture2D(image, texCoord), 0.0, 1.0);
}
)";

/// A rectangle of pixels, from the first to one past the last.
struct Rectangle
{
  int Low[2];
  int High[2];
  int Width() const { return this->High[0] - this->Low[0]; }
  int Height() const { return this->High[1] - this->Low[1]; }
};

/// What holds no pixel, and does not count in the hull of several.
constexpr int Beyond = std::numeric_limits<int>::max();
constexpr Rectangle Nothing = { { Beyond, Beyond }, { 0, 0 } };

/// What there is to be seen of some rows of an image.
Rectangle FindVisible(int width, int firstRow, int lastRow, const float* colours)
{
  Rectangle found = Nothing;
  for (int y = firstRow; y < lastRow; ++y)
  {
    const float* row = colours + 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(y);
    const auto isVisible = [row](int x)
    {
      std::uint64_t halves[2];
      std::memcpy(halves, row + 4 * x, sizeof(halves));
      return (halves[0] | halves[1]) != 0;
    };
    int first = 0;
    while (first < width && !isVisible(first))
    {
      ++first;
    }
    if (first == width)
    {
      continue;
    }
    // Not beyond what is known to be visible.
    int end = width;
    while (end > found.High[0] && !isVisible(end - 1))
    {
      --end;
    }
    found.Low[0] = std::min(found.Low[0], first);
    found.High[0] = end;
    found.Low[1] = std::min(found.Low[1], y);
    found.High[1] = y + 1;
  }
  return found;
}

/// What there is to be seen of an image, with a pixel around it to be interpolated to; empty if
/// nothing is.
Rectangle FindVisible(
  int width, int height, const float* colours, const vtkFFDParallelFor& parallelFor)
{
  Rectangle found = Nothing;
  std::mutex mutex;
  parallelFor(static_cast<std::size_t>(height),
    [&](std::size_t first, std::size_t last)
    {
      const Rectangle rows =
        FindVisible(width, static_cast<int>(first), static_cast<int>(last), colours);
      const std::lock_guard<std::mutex> lock(mutex);
      for (int a = 0; a < 2; ++a)
      {
        found.Low[a] = std::min(found.Low[a], rows.Low[a]);
        found.High[a] = std::max(found.High[a], rows.High[a]);
      }
    });
  const int size[2] = { width, height };
  for (int a = 0; a < 2; ++a)
  {
    found.Low[a] = std::max(found.Low[a] - 1, 0);
    found.High[a] = std::min(found.High[a] + 1, size[a]);
  }
  return found;
}

} // namespace

//------------------------------------------------------------------------------
struct vtkFFDImageDisplay::Resources
{
  vtkNew<vtkTextureObject> Texture;
  std::unique_ptr<vtkOpenGLQuadHelper> Quad;
  vtkWeakPointer<vtkOpenGLRenderWindow> Window;
  std::vector<float> Visible; // part of the image
};

//------------------------------------------------------------------------------
vtkFFDImageDisplay::vtkFFDImageDisplay()
  : Gl(new Resources)
{
}

//------------------------------------------------------------------------------
vtkFFDImageDisplay::~vtkFFDImageDisplay() = default;

//------------------------------------------------------------------------------
bool vtkFFDImageDisplay::Draw(vtkRenderer* renderer, int width, int height, const float* colours,
  const double rectangle[4], bool pixelByPixel, const vtkFFDParallelFor& parallelFor)
{
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window)
  {
    return false;
  }
  // A window may have been deleted, or have released its resources, without telling the mapper: it
  // was not in a renderer then.
  if (this->Gl->Window != window || (this->Gl->Quad && !this->Gl->Quad->Program))
  {
    this->ReleaseGraphicsResources(this->Gl->Window);
  }
  this->Gl->Window = window;

  // Most of the bounds of a volume is empty.
  const Rectangle part = FindVisible(width, height, colours, parallelFor);
  if (part.Width() <= 0 || part.Height() <= 0)
  {
    return true;
  }
  std::vector<float>& visible = this->Gl->Visible;
  const std::size_t rowLength = 4 * static_cast<std::size_t>(part.Width());
  visible.resize(rowLength * static_cast<std::size_t>(part.Height()));
  parallelFor(static_cast<std::size_t>(part.Height()),
    [&](std::size_t first, std::size_t last)
    {
      for (std::size_t y = first; y < last; ++y)
      {
        std::copy_n(colours +
            4 * (static_cast<std::size_t>(width) * (static_cast<std::size_t>(part.Low[1]) + y) +
                  static_cast<std::size_t>(part.Low[0])),
          rowLength, visible.data() + rowLength * y);
      }
    });

  vtkTextureObject* texture = this->Gl->Texture;
  texture->SetContext(window);
  // A texture of the same size is filled again only if it is made again.
  texture->ReleaseGraphicsResources(window);
  if (!texture->Create2DFromRaw(static_cast<unsigned int>(part.Width()),
        static_cast<unsigned int>(part.Height()), 4, VTK_FLOAT, visible.data()))
  {
    return false;
  }
  texture->SetWrapS(vtkTextureObject::ClampToEdge);
  texture->SetWrapT(vtkTextureObject::ClampToEdge);
  // Where nothing is to be interpolated, rounding must not do so a little.
  const int filter = pixelByPixel ? vtkTextureObject::Nearest : vtkTextureObject::Linear;
  texture->SetMinificationFilter(filter);
  texture->SetMagnificationFilter(filter);

  if (!this->Gl->Quad)
  {
    this->Gl->Quad.reset(new vtkOpenGLQuadHelper(window, VertexShader, FragmentShader, nullptr));
  }
  else
  {
    window->GetShaderCache()->ReadyShaderProgram(this->Gl->Quad->Program);
  }
  vtkShaderProgram* program = this->Gl->Quad->Program;
  if (!program || !program->GetCompiled())
  {
    return false;
  }

  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglEnableDisable keepBlend(state, GlBlend);
  vtkOpenGLState::ScopedglEnableDisable keepDepthTest(state, GlDepthTest);
  vtkOpenGLState::ScopedglBlendFuncSeparate keepBlendFunction(state);
  state->vtkglEnable(GlBlend);
  state->vtkglDisable(GlDepthTest);
  state->vtkglBlendFuncSeparate(GlOne, GlOneMinusSourceAlpha, GlOne, GlOneMinusSourceAlpha);

  texture->Activate();
  const double pixel[2] = { (rectangle[2] - rectangle[0]) / width,
    (rectangle[3] - rectangle[1]) / height };
  float corners[4];
  for (int a = 0; a < 2; ++a)
  {
    corners[a] = static_cast<float>(rectangle[a] + pixel[a] * part.Low[a]);
    corners[2 + a] = static_cast<float>(rectangle[a] + pixel[a] * part.High[a]);
  }
  program->SetUniform4f("rectangle", corners);
  program->SetUniformi("image", texture->GetTextureUnit());
  this->Gl->Quad->Render();
  texture->Deactivate();
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDImageDisplay::ReleaseGraphicsResources(vtkWindow* window)
{
  if (this->Gl->Quad)
  {
    this->Gl->Quad->ReleaseGraphicsResources(window);
    this->Gl->Quad.reset();
  }
  this->Gl->Texture->ReleaseGraphicsResources(window);
  std::vector<float>().swap(this->Gl->Visible);
  this->Gl->Window = nullptr;
}
