// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDImageDisplay.h"

#include "vtkFFDVersions.h"

#include "FFDPixelBytes.h"

#include "vtkNew.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"
#include VTK_FFD_OPENGL_HEADER

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace
{

const char* const VertexShader = R"(//VTK::System::Dec
in vec4 ndCoordIn;
in vec2 texCoordIn;
uniform vec4 rectangle;
uniform vec4 pixels;
out vec2 texCoord;
out vec2 pixelCoord;
void main()
{
  gl_Position = vec4(mix(rectangle.xy, rectangle.zw, texCoordIn), ndCoordIn.zw);
  texCoord = texCoordIn;
  pixelCoord = gl_Position.xy * pixels.xy + pixels.zw;
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

/// The same with layers, interpolated by hand: each ray has depths of its own.
const char* const LayerFragmentShader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
in vec2 pixelCoord;
uniform sampler2D image;
uniform sampler2D nearImage;
uniform sampler2D rayDepths;
uniform sampler2D pixelDepths;
vec4 colorOf(ivec2 ray, float depth)
{
  vec3 d = texelFetch(rayDepths, ray, 0).rgb;
  vec4 farColor = texelFetch(image, ray, 0);
  if (depth >= d.b)
  {
    return farColor;
  }
  vec4 nearColor = texelFetch(nearImage, ray, 0);
  if (depth >= d.g)
  {
    return mix(nearColor, farColor, (depth - d.g) / (d.b - d.g));
  }
  return depth <= d.r ? vec4(0.0) : nearColor * ((depth - d.r) / (d.g - d.r));
}
void main()
{
  float depth = texelFetch(pixelDepths,
    clamp(ivec2(floor(pixelCoord)), ivec2(0), textureSize(pixelDepths, 0) - 1), 0).r;
  ivec2 last = textureSize(image, 0) - 1;
  vec2 at = texCoord * vec2(last + 1) - 0.5;
  ivec2 low = clamp(ivec2(floor(at)), ivec2(0), last);
  ivec2 high = clamp(ivec2(floor(at)) + 1, ivec2(0), last);
  vec2 part = fract(at);
  vec4 below = mix(colorOf(low, depth), colorOf(ivec2(high.x, low.y), depth), part.x);
  vec4 above = mix(colorOf(ivec2(low.x, high.y), depth), colorOf(high, depth), part.x);
  gl_FragData[0] = mix(below, above, part.y);
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

/// What is visible of an image, with a pixel around it to be interpolated to; empty if nothing is.
Rectangle FindPart(const vtkFFDImageDisplay::Image& image)
{
  Rectangle part = { { 0, 0 }, { 0, 0 } };
  if (!image.Visible.IsEmpty())
  {
    const int size[2] = { image.Width, image.Height };
    for (int a = 0; a < 2; ++a)
    {
      part.Low[a] = std::max(image.Visible.GetLow()[a] - 1, 0);
      part.High[a] = std::min(image.Visible.GetHigh()[a] + 1, size[a]);
    }
  }
  return part;
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

/// Keeps what is drawn from all but the first of the buffers of colors, as long as it lives: passes
/// such as vtkSSAOPass have positions and normals of surfaces in others, for which the quad has no
/// values.
class OnlyFirstColors
{
public:
  OnlyFirstColors()
  {
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &this->Count);
    this->Count = std::min<GLint>(this->Count, static_cast<GLint>(this->Masks.size()));
    for (GLint i = 1; i < this->Count; ++i)
    {
      const GLuint buffer = static_cast<GLuint>(i);
      glGetBooleani_v(GL_COLOR_WRITEMASK, buffer, this->Masks[buffer].data());
      glColorMaski(buffer, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    }
  }
  ~OnlyFirstColors()
  {
    for (GLint i = 1; i < this->Count; ++i)
    {
      const GLuint buffer = static_cast<GLuint>(i);
      const std::array<GLboolean, 4>& mask = this->Masks[buffer];
      glColorMaski(buffer, mask[0], mask[1], mask[2], mask[3]);
    }
  }
  OnlyFirstColors(const OnlyFirstColors&) = delete;
  void operator=(const OnlyFirstColors&) = delete;

private:
  GLint Count = 0;
  std::array<std::array<GLboolean, 4>, 8> Masks{};
};

/// How OpenGL finds pixels in memory, for as long as it lives: rows of `width` pixels (0: those
/// that are transferred) without gaps. Whoever else draws in the context may have left it
/// otherwise, or have bound a buffer that pixels would go to.
class PixelStorage
{
public:
  enum Direction
  {
    Read,
    Upload
  };
  explicit PixelStorage(Direction direction, GLint width = 0)
    : Names(direction == Read ? ForReading : ForUploads)
  {
    for (std::size_t i = 0; i < this->Values.size(); ++i)
    {
      glGetIntegerv(this->Names.Parameters[i], &this->Values[i]);
      glPixelStorei(this->Names.Parameters[i], i == 0 ? 1 : i == 1 ? width : 0);
    }
    glGetIntegerv(this->Names.Binding, &this->Buffer);
    glBindBuffer(this->Names.Target, 0);
  }
  ~PixelStorage()
  {
    for (std::size_t i = 0; i < this->Values.size(); ++i)
    {
      glPixelStorei(this->Names.Parameters[i], this->Values[i]);
    }
    glBindBuffer(this->Names.Target, static_cast<GLuint>(this->Buffer));
  }
  PixelStorage(const PixelStorage&) = delete;
  void operator=(const PixelStorage&) = delete;

private:
  struct NameSet
  {
    std::array<GLenum, 5> Parameters; ///< first the alignment and the width of rows
    GLenum Target;
    GLenum Binding;
  };
  static constexpr NameSet ForReading = { { GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH,
                                            GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS,
                                            GL_PACK_SWAP_BYTES },
    GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING };
  static constexpr NameSet ForUploads = { { GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH,
                                            GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
                                            GL_UNPACK_SWAP_BYTES },
    GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING };

  const NameSet& Names;
  std::array<GLint, 5> Values{};
  GLint Buffer = 0;
};

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
  for (int a = 0; a < 2 && glIsEnabled(GL_SCISSOR_TEST); ++a)
  {
    plain = plain && rectangle[a] >= scissor[a] &&
      rectangle[a] + rectangle[2 + a] <= scissor[a] + scissor[2 + a];
  }
  if (!plain || buffers[0] == GL_NONE)
  {
    return 0;
  }
  const auto find = [buffer = static_cast<GLenum>(buffers[0])](GLenum property) {
    GLint value = 0;
    glGetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, buffer, property, &value);
    return value;
  };
  return find(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_TEXTURE &&
      find(GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL) == 0 && glGetError() == GL_NO_ERROR
    ? static_cast<GLuint>(find(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME))
    : 0;
}

/// Reads RGBA of a rectangle of pixels from the first buffer that is drawn into.
void ReadDrawn(const int rectangle[4], unsigned char* pixels)
{
  GLint drawn = 0;
  GLint read = 0;
  GLint buffer = GL_NONE;
  GLint before = GL_NONE;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(drawn));
  glGetIntegerv(GL_DRAW_BUFFER0, &buffer);
  glGetIntegerv(GL_READ_BUFFER, &before);
  glReadBuffer(static_cast<GLenum>(buffer));
  {
    const PixelStorage storage(PixelStorage::Read);
    glReadPixels(
      rectangle[0], rectangle[1], rectangle[2], rectangle[3], GL_RGBA, GL_UNSIGNED_BYTE, pixels);
  }
  glReadBuffer(static_cast<GLenum>(before));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
}

} // namespace

//------------------------------------------------------------------------------
struct vtkFFDImageDisplay::Resources
{
  vtkNew<vtkTextureObject> Texture;
  vtkNew<vtkTextureObject> NearTexture;
  vtkNew<vtkTextureObject> RayDepths;
  vtkNew<vtkTextureObject> PixelDepths;
  std::unique_ptr<vtkOpenGLQuadHelper> Quad;
  std::unique_ptr<vtkOpenGLQuadHelper> LayerQuad;
  std::vector<unsigned char> Blended;
  vtkWeakPointer<vtkOpenGLRenderWindow> Window;

  /// Fill a texture with a rectangle of an image of `components` numbers a pixel.
  template <class T>
  bool Fill(vtkTextureObject* texture, const T* image, int components, int width,
    const Rectangle& rectangle, int filter)
  {
    constexpr bool AreFloats = std::is_same<T, float>::value;
    constexpr int Type = AreFloats ? VTK_FLOAT : VTK_UNSIGNED_CHAR;
    const auto columns = static_cast<unsigned int>(rectangle.Width());
    const auto rows = static_cast<unsigned int>(rectangle.Height());
    texture->SetContext(this->Window);
    const PixelStorage storage(PixelStorage::Upload, width);
    if (texture->GetHandle() == 0 || texture->GetWidth() != columns ||
      texture->GetHeight() != rows || texture->GetVTKDataType() != Type)
    {
      texture->ReleaseGraphicsResources(this->Window);
      if (!texture->Create2DFromRaw(columns, rows, components, Type, nullptr))
      {
        return false;
      }
    }
    texture->Bind();
    const std::ptrdiff_t first =
      static_cast<std::ptrdiff_t>(width) * rectangle.Low[1] + rectangle.Low[0];
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, rectangle.Width(), rectangle.Height(),
      texture->GetFormat(Type, components, false), AreFloats ? GL_FLOAT : GL_UNSIGNED_BYTE,
      image + components * first);
    texture->SetWrapS(vtkTextureObject::ClampToEdge);
    texture->SetWrapT(vtkTextureObject::ClampToEdge);
    texture->SetMinificationFilter(filter);
    texture->SetMagnificationFilter(filter);
    return true;
  }

  /// Puts a part of an image of bytes, pixel by pixel, over what is drawn already, without drawing
  /// it. `rectangle`: as for Draw(), `viewport`: FindViewport(). False where that is not possible.
  bool Blend(
    const Image& image, const Rectangle& part, const double rectangle[4], const int viewport[4])
  {
    int pixels[4] = { 0, 0, part.Width(), part.Height() };
    for (int a = 0; a < 2; ++a)
    {
      const double corner = 0.5 * (rectangle[a] + 1.0) * viewport[2 + a];
      pixels[a] = viewport[a] + static_cast<int>(std::lround(corner)) + part.Low[a];
    }
    const GLuint texture = FindDrawnTexture(pixels);
    if (texture == 0)
    {
      return false;
    }
    const std::size_t width = static_cast<std::size_t>(part.Width());
    this->Blended.resize(4 * width * static_cast<std::size_t>(part.Height()));
    ReadDrawn(pixels, this->Blended.data());
    unsigned char* below = this->Blended.data();
    for (int y = part.Low[1]; y < part.High[1]; ++y, below += 4 * width)
    {
      const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y) * image.Width + part.Low[0];
      ffd::BlendPixelBytes(image.Bytes + 4 * first, width, below);
    }
    const PixelStorage storage(PixelStorage::Upload);
    GLint bound = 0;
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
    glBindTexture(GL_TEXTURE_2D, texture);
    // Else it is one of another kind, and what is bound is another texture.
    bool done = glGetError() == GL_NO_ERROR;
    if (done)
    {
      glTexSubImage2D(GL_TEXTURE_2D, 0, pixels[0], pixels[1], pixels[2], pixels[3], GL_RGBA,
        GL_UNSIGNED_BYTE, this->Blended.data());
      done = glGetError() == GL_NO_ERROR;
    }
    glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(bound));
    return done;
  }

  /// The program of a quad, made if need be and ready; null if it does not compile.
  vtkShaderProgram* Ready(std::unique_ptr<vtkOpenGLQuadHelper>& quad, const char* fragmentShader)
  {
    if (!quad)
    {
      quad.reset(new vtkOpenGLQuadHelper(this->Window, VertexShader, fragmentShader, nullptr));
    }
    else
    {
      this->Window->GetShaderCache()->ReadyShaderProgram(quad->Program);
    }
    return quad->Program && quad->Program->GetCompiled() ? quad->Program : nullptr;
  }
};

//------------------------------------------------------------------------------
vtkFFDImageDisplay::vtkFFDImageDisplay()
  : Gl(new Resources)
{
}

//------------------------------------------------------------------------------
vtkFFDImageDisplay::~vtkFFDImageDisplay() = default;

//------------------------------------------------------------------------------
bool vtkFFDImageDisplay::Draw(vtkRenderer* renderer, const Image& image, const Layers& layers,
  const double rectangle[4], bool pixelByPixel)
{
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window)
  {
    return false;
  }
  // A window may have been deleted, or have released its resources, without telling the mapper: it
  // was not in a renderer then.
  Resources& gl = *this->Gl;
  if (gl.Window != window || (gl.Quad && !gl.Quad->Program) ||
    (gl.LayerQuad && !gl.LayerQuad->Program))
  {
    this->ReleaseGraphicsResources(gl.Window);
  }
  gl.Window = window;

  // Most of the bounds of a volume is empty.
  const Rectangle part = FindPart(image);
  if (part.Width() <= 0 || part.Height() <= 0)
  {
    return true;
  }
  if (pixelByPixel && image.Bytes && !layers.Colors && IsSoftware())
  {
    int viewport[4];
    FindViewport(renderer, viewport);
    ClearErrors();
    const bool blended = gl.Blend(image, part, rectangle, viewport);
    ClearErrors();
    if (blended)
    {
      return true;
    }
  }
  // Nearest, so that rounding does not blend neighbors of a picture with a ray for each pixel.
  const int filter = pixelByPixel ? vtkTextureObject::Nearest : vtkTextureObject::Linear;
  const Rectangle all = { { 0, 0 }, { layers.Pixels[0], layers.Pixels[1] } };
  const auto fill = [&](vtkTextureObject* texture, const auto* numbers, int components, int width,
                      const Rectangle& of) {
    return gl.Fill(texture, numbers, components, width, of, filter);
  };
  const bool filled = image.Bytes ? fill(gl.Texture, image.Bytes, 4, image.Width, part)
                                  : fill(gl.Texture, image.Floats, 4, image.Width, part);
  if (!filled ||
    (layers.Colors &&
      (!fill(gl.NearTexture, layers.Colors, 4, image.Width, part) ||
        !fill(gl.RayDepths, layers.Depths, 3, image.Width, part) ||
        !fill(gl.PixelDepths, layers.PixelDepths, 1, layers.Pixels[0], all))))
  {
    return false;
  }
  std::unique_ptr<vtkOpenGLQuadHelper>& quad = layers.Colors ? gl.LayerQuad : gl.Quad;
  vtkShaderProgram* program = gl.Ready(quad, layers.Colors ? LayerFragmentShader : FragmentShader);
  if (!program)
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

  const double pixel[2] = { (rectangle[2] - rectangle[0]) / image.Width,
    (rectangle[3] - rectangle[1]) / image.Height };
  float corners[4];
  float pixels[4];
  for (int a = 0; a < 2; ++a)
  {
    corners[a] = static_cast<float>(rectangle[a] + pixel[a] * part.Low[a]);
    corners[2 + a] = static_cast<float>(rectangle[a] + pixel[a] * part.High[a]);
    pixels[a] = 0.5f * static_cast<float>(layers.Viewport[a]);
    pixels[2 + a] = pixels[a] - static_cast<float>(layers.Origin[a]);
  }
  program->SetUniform4f("rectangle", corners);
  program->SetUniform4f("pixels", pixels);
  std::vector<std::pair<const char*, vtkTextureObject*>> textures{ { "image", gl.Texture } };
  if (layers.Colors)
  {
    textures.insert(textures.end(),
      { { "nearImage", gl.NearTexture }, { "rayDepths", gl.RayDepths },
        { "pixelDepths", gl.PixelDepths } });
  }
  for (const auto& texture : textures)
  {
    texture.second->Activate();
    program->SetUniformi(texture.first, texture.second->GetTextureUnit());
  }
  {
    const OnlyFirstColors keepOthers;
    quad->Render();
  }
  for (const auto& texture : textures)
  {
    texture.second->Deactivate();
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDImageDisplay::Flush(vtkRenderer* renderer)
{
  if (vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()))
  {
    glFlush();
  }
}

//------------------------------------------------------------------------------
/// Not to those of sRGB: these are not equally far apart.
bool vtkFFDImageDisplay::DrawsBytes(vtkRenderer* renderer)
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
  const auto find = [attachment](GLenum property) {
    GLint value = 0;
    glGetFramebufferAttachmentParameteriv(
      GL_DRAW_FRAMEBUFFER, static_cast<GLenum>(attachment), property, &value);
    return value;
  };
  const bool bytes = find(GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE) == 8 &&
    find(GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_UNSIGNED_NORMALIZED &&
    (find(GL_FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING) != GL_SRGB ||
      glIsEnabled(GL_FRAMEBUFFER_SRGB) != GL_TRUE);
  return glGetError() == GL_NO_ERROR && bytes;
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
    const PixelStorage storage(PixelStorage::Read);
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
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
  ClearErrors();
  return ok;
}

//------------------------------------------------------------------------------
void vtkFFDImageDisplay::ReleaseGraphicsResources(vtkWindow* window)
{
  for (std::unique_ptr<vtkOpenGLQuadHelper>* quad : { &this->Gl->Quad, &this->Gl->LayerQuad })
  {
    if (*quad)
    {
      (*quad)->ReleaseGraphicsResources(window);
      quad->reset();
    }
  }
  this->Gl->Texture->ReleaseGraphicsResources(window);
  this->Gl->NearTexture->ReleaseGraphicsResources(window);
  this->Gl->RayDepths->ReleaseGraphicsResources(window);
  this->Gl->PixelDepths->ReleaseGraphicsResources(window);
  this->Gl->Window = nullptr;
}
