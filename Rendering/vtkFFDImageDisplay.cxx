// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDImageDisplay.h"

#include "vtkFFDOpenGL.h"
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
  // Not clamped: targets of bytes do so, those of floats keep what is brighter.
  gl_FragData[0] = texture2D(image, texCoord);
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

/// Forget errors of OpenGL from before. (Without a context there is no end of them.)
void ClearErrors()
{
  for (int i = 0; i < 100 && glGetError() != GL_NO_ERROR; ++i)
  {
  }
}

/// A property of the depth or stencil attachment of the framebuffer that is read from.
GLint GetAttachment(GLenum attachment, GLenum property)
{
  GLint value = 0;
  glGetFramebufferAttachmentParameteriv(GL_READ_FRAMEBUFFER, attachment, property, &value);
  return value;
}

/// The format of the depths of the framebuffer that is read from; 0 if it has none. Depths are
/// copied between framebuffers only if their formats are the same.
GLenum FindDepthFormat(bool ofWindow)
{
  const GLenum depth = ofWindow ? GL_DEPTH : GL_DEPTH_ATTACHMENT;
  const GLenum stencil = ofWindow ? GL_STENCIL : GL_STENCIL_ATTACHMENT;
  if (GetAttachment(depth, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE)
  {
    return 0;
  }
  const GLint bits = GetAttachment(depth, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE);
  const bool floats = GetAttachment(depth, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT;
  const bool withStencil =
    GetAttachment(stencil, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_NONE &&
    GetAttachment(stencil, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE) > 0;
  if (withStencil)
  {
    return floats ? GL_DEPTH32F_STENCIL8 : GL_DEPTH24_STENCIL8;
  }
  return floats  ? GL_DEPTH_COMPONENT32F
    : bits <= 16 ? GL_DEPTH_COMPONENT16
    : bits <= 24 ? GL_DEPTH_COMPONENT24
                 : GL_DEPTH_COMPONENT32;
}

/// A framebuffer with one sample for each pixel of a rectangle of the one that is read from.
class ResolvedDepths
{
public:
  ResolvedDepths(GLenum format, const int rectangle[4])
  {
    GLint drawn = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
    glGenFramebuffers(1, &this->Framebuffer);
    glGenRenderbuffers(1, &this->Depths);
    glBindRenderbuffer(GL_RENDERBUFFER, this->Depths);
    glRenderbufferStorage(GL_RENDERBUFFER, format, rectangle[2], rectangle[3]);
    glBindRenderbuffer(GL_RENDERBUFFER, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, this->Framebuffer);
    const bool withStencil = format == GL_DEPTH24_STENCIL8 || format == GL_DEPTH32F_STENCIL8;
    glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER,
      withStencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
      this->Depths);
    const GLenum noColours = GL_NONE;
    glDrawBuffers(1, &noColours);
    const bool scissor = glIsEnabled(GL_SCISSOR_TEST) == GL_TRUE;
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(rectangle[0], rectangle[1], rectangle[0] + rectangle[2],
      rectangle[1] + rectangle[3], 0, 0, rectangle[2], rectangle[3], GL_DEPTH_BUFFER_BIT,
      GL_NEAREST);
    if (scissor)
    {
      glEnable(GL_SCISSOR_TEST);
    }
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawn));
  }
  ~ResolvedDepths()
  {
    glDeleteFramebuffers(1, &this->Framebuffer);
    glDeleteRenderbuffers(1, &this->Depths);
  }
  ResolvedDepths(const ResolvedDepths&) = delete;
  void operator=(const ResolvedDepths&) = delete;

  void Read(const int size[2], float* depths) const
  {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, this->Framebuffer);
    glReadBuffer(GL_NONE);
    glReadPixels(0, 0, size[0], size[1], GL_DEPTH_COMPONENT, GL_FLOAT, depths);
  }

private:
  GLuint Framebuffer = 0;
  GLuint Depths = 0;
};

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
  vtkOpenGLState::ScopedglEnableDisable keepBlend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable keepDepthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglBlendFuncSeparate keepBlendFunction(state);
  state->vtkglEnable(GL_BLEND);
  state->vtkglDisable(GL_DEPTH_TEST);
  state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);

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
void vtkFFDImageDisplay::FindViewport(vtkRenderer* renderer, int viewport[4])
{
  if (auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()))
  {
    window->GetState()->vtkglGetIntegerv(GL_VIEWPORT, viewport);
    return;
  }
  renderer->GetTiledSizeAndOrigin(&viewport[2], &viewport[3], &viewport[0], &viewport[1]);
}

//------------------------------------------------------------------------------
bool vtkFFDImageDisplay::ReadDepths(vtkRenderer* renderer, const int rectangle[4], float* depths)
{
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window)
  {
    return false;
  }
  // Not through vtkOpenGLState, which knows what it has bound: it is bound again in the end.
  GLint drawn = 0;
  GLint read = 0;
  GLint samples = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  glGetIntegerv(GL_SAMPLES, &samples);
  ClearErrors();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(drawn));
  const GLenum format = FindDepthFormat(drawn == 0);
  bool ok = format != 0;
  if (ok)
  {
    window->GetState()->vtkglPixelStorei(GL_PACK_ALIGNMENT, 1);
    if (samples > 0)
    {
      ResolvedDepths(format, rectangle).Read(rectangle + 2, depths);
    }
    else
    {
      glReadPixels(rectangle[0], rectangle[1], rectangle[2], rectangle[3], GL_DEPTH_COMPONENT,
        GL_FLOAT, depths);
    }
    ok = glGetError() == GL_NO_ERROR;
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
  ClearErrors();
  return ok;
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
