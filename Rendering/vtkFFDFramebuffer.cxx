// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFramebuffer.h"

#include "vtkFFDPixelStorage.h"
#include "vtkFFDVersions.h"

#include "FFDPixelBytes.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include VTK_FFD_OPENGL_HEADER

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace
{

/// Forget errors of OpenGL from before. (Without a context there is no end of them.)
void ClearErrors()
{
  for (int i = 0; i < 100 && glGetError() != GL_NO_ERROR; ++i)
  {
  }
}

/// A property of an attachment of the framebuffer that is drawn into.
GLint GetAttachment(GLenum attachment, GLenum property)
{
  GLint value = 0;
  glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, property, &value);
  return value;
}

/// Has OpenGL read from the framebuffer that is drawn into, for as long as it lives. Not through
/// vtkOpenGLState, which knows what it has bound: it is bound again in the end.
class ReadsDrawn
{
public:
  ReadsDrawn()
  {
    GLint drawn = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &this->Before);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(drawn));
  }
  ~ReadsDrawn() { glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(this->Before)); }
  ReadsDrawn(const ReadsDrawn&) = delete;
  void operator=(const ReadsDrawn&) = delete;

private:
  GLint Before = 0;
};

/// The format of the depths of the framebuffer that is drawn into; 0 if it has none. Depths are
/// copied between framebuffers only if their formats are the same.
GLenum FindDepthFormat()
{
  GLint drawn = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
  const bool ofWindow = drawn == 0;
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

/// Makes depths of the buffer those of the viewing volume, where they are a part of 0 to 1 only.
void UndoDepthRange(float* depths, std::size_t count)
{
  GLfloat range[2] = { 0.0f, 1.0f };
  glGetFloatv(GL_DEPTH_RANGE, range);
  if ((range[0] == 0.0f && range[1] == 1.0f) || range[0] == range[1])
  {
    return;
  }
  std::transform(depths, depths + count, depths, [&range](float depth) {
    return std::clamp((depth - range[0]) / (range[1] - range[0]), 0.0f, 1.0f);
  });
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
    const GLenum noColors = GL_NONE;
    glDrawBuffers(1, &noColors);
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

/// Whether OpenGL is a rasterizer on the CPU, of Mesa: there a quad takes longer than to blend in
/// memory.
bool IsSoftware()
{
  const auto* const name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return name && (std::strstr(name, "llvmpipe") || std::strstr(name, "softpipe"));
}

/// The texture of bytes that all is drawn into as it is, with a sample a pixel, so that pixels of a
/// rectangle may be put there without being drawn; 0 if it is another kind of framebuffer.
GLuint FindDrawnTexture(const int rectangle[4])
{
  GLint samples = 0;
  GLint buffers[2] = { GL_NONE, GL_NONE };
  GLint scissor[4] = { 0, 0, 0, 0 };
  GLboolean mask[4] = { GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE };
  glGetIntegerv(GL_SAMPLES, &samples);
  glGetIntegerv(GL_DRAW_BUFFER0, &buffers[0]);
  glGetIntegerv(GL_DRAW_BUFFER1, &buffers[1]);
  glGetIntegerv(GL_SCISSOR_BOX, scissor);
  glGetBooleanv(GL_COLOR_WRITEMASK, mask);
  bool plain = samples == 0 && buffers[1] == GL_NONE && !glIsEnabled(GL_STENCIL_TEST) &&
    std::all_of(mask, mask + 4, [](GLboolean writes) { return writes == GL_TRUE; });
  const bool all = !glIsEnabled(GL_SCISSOR_TEST);
  for (int a = 0; a < 2; ++a)
  {
    plain = plain &&
      (all ||
        (rectangle[a] >= scissor[a] &&
          rectangle[a] + rectangle[2 + a] <= scissor[a] + scissor[2 + a]));
  }
  if (!plain || buffers[0] == GL_NONE)
  {
    return 0;
  }
  const auto find = [buffer = static_cast<GLenum>(buffers[0])](
                      GLenum property) { return GetAttachment(buffer, property); };
  return find(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_TEXTURE &&
      find(GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL) == 0 && glGetError() == GL_NO_ERROR
    ? static_cast<GLuint>(find(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME))
    : 0;
}

/// Reads RGBA of a rectangle of pixels from the first buffer that is drawn into.
void ReadDrawn(const int rectangle[4], unsigned char* pixels)
{
  const ReadsDrawn reads;
  GLint buffer = GL_NONE;
  GLint before = GL_NONE;
  glGetIntegerv(GL_DRAW_BUFFER0, &buffer);
  glGetIntegerv(GL_READ_BUFFER, &before);
  glReadBuffer(static_cast<GLenum>(buffer));
  {
    const vtkFFDPixelStorage storage(vtkFFDPixelStorage::Read);
    glReadPixels(
      rectangle[0], rectangle[1], rectangle[2], rectangle[3], GL_RGBA, GL_UNSIGNED_BYTE, pixels);
  }
  glReadBuffer(static_cast<GLenum>(before));
}

} // namespace

//------------------------------------------------------------------------------
void vtkFFDFramebuffer::Flush(vtkRenderer* renderer)
{
  if (vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()))
  {
    glFlush();
  }
}

//------------------------------------------------------------------------------
/// Not to those of sRGB: these are not equally far apart.
bool vtkFFDFramebuffer::DrawsBytes(vtkRenderer* renderer)
{
  if (!vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()))
  {
    return false;
  }
  GLint buffer = GL_NONE;
  glGetIntegerv(GL_DRAW_BUFFER, &buffer);
  // Of windows only the left and right ones have properties.
  const GLint attachment = buffer == GL_BACK ? GL_BACK_LEFT
    : buffer == GL_FRONT                     ? GL_FRONT_LEFT
                                             : buffer;
  if (attachment == GL_NONE)
  {
    return false;
  }
  ClearErrors();
  const auto find = [attachment = static_cast<GLenum>(attachment)](
                      GLenum property) { return GetAttachment(attachment, property); };
  const bool bytes = find(GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE) == 8 &&
    find(GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_UNSIGNED_NORMALIZED &&
    (find(GL_FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING) != GL_SRGB ||
      glIsEnabled(GL_FRAMEBUFFER_SRGB) != GL_TRUE);
  return glGetError() == GL_NO_ERROR && bytes;
}

//------------------------------------------------------------------------------
void vtkFFDFramebuffer::FindViewport(vtkRenderer* renderer, int viewport[4])
{
  if (auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()))
  {
    window->GetState()->vtkglGetIntegerv(GL_VIEWPORT, viewport);
    return;
  }
  renderer->GetTiledSizeAndOrigin(&viewport[2], &viewport[3], &viewport[0], &viewport[1]);
}

//------------------------------------------------------------------------------
bool vtkFFDFramebuffer::ReadDepths(vtkRenderer* renderer, const int rectangle[4], float* depths)
{
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window)
  {
    return false;
  }
  GLint samples = 0;
  glGetIntegerv(GL_SAMPLES, &samples);
  ClearErrors();
  const GLenum format = FindDepthFormat();
  bool ok = format != 0;
  if (ok)
  {
    const ReadsDrawn reads;
    const vtkFFDPixelStorage storage(vtkFFDPixelStorage::Read);
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
    UndoDepthRange(
      depths, static_cast<std::size_t>(rectangle[2]) * static_cast<std::size_t>(rectangle[3]));
  }
  ClearErrors();
  return ok;
}

//------------------------------------------------------------------------------
bool vtkFFDFramebuffer::BlendPixels(const int rectangle[4], const unsigned char* pixels, int width,
  std::vector<unsigned char>& memory)
{
  if (!IsSoftware())
  {
    return false;
  }
  ClearErrors();
  bool done = false;
  if (const GLuint texture = FindDrawnTexture(rectangle))
  {
    const std::size_t row = static_cast<std::size_t>(rectangle[2]);
    memory.resize(4 * row * static_cast<std::size_t>(rectangle[3]));
    ReadDrawn(rectangle, memory.data());
    for (std::size_t y = 0; y < static_cast<std::size_t>(rectangle[3]); ++y)
    {
      ffd::BlendPixelBytes(
        pixels + 4 * y * static_cast<std::size_t>(width), row, memory.data() + 4 * y * row);
    }
    const vtkFFDPixelStorage storage(vtkFFDPixelStorage::Upload);
    GLint bound = 0;
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
    glBindTexture(GL_TEXTURE_2D, texture);
    // Else it is one of another kind, and what is bound is another texture.
    if (glGetError() == GL_NO_ERROR)
    {
      glTexSubImage2D(GL_TEXTURE_2D, 0, rectangle[0], rectangle[1], rectangle[2], rectangle[3],
        GL_RGBA, GL_UNSIGNED_BYTE, memory.data());
      done = glGetError() == GL_NO_ERROR;
    }
    glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(bound));
  }
  ClearErrors();
  return done;
}
