// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDImageDisplay.h"

#include "vtkFFDFramebuffer.h"
#include "vtkFFDPixelStorage.h"
#include "vtkFFDVersions.h"

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
  /// The number of its first pixel in rows of `width`.
  std::ptrdiff_t FirstPixel(int width) const
  {
    return static_cast<std::ptrdiff_t>(width) * this->Low[1] + this->Low[0];
  }
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
  std::vector<unsigned char> Blended; ///< memory of vtkFFDFramebuffer::BlendPixels()
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
    const vtkFFDPixelStorage storage(vtkFFDPixelStorage::Upload, width);
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
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, rectangle.Width(), rectangle.Height(),
      texture->GetFormat(Type, components, false), AreFloats ? GL_FLOAT : GL_UNSIGNED_BYTE,
      image + components * rectangle.FirstPixel(width));
    texture->SetWrapS(vtkTextureObject::ClampToEdge);
    texture->SetWrapT(vtkTextureObject::ClampToEdge);
    texture->SetMinificationFilter(filter);
    texture->SetMagnificationFilter(filter);
    return true;
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
  if (pixelByPixel && image.Bytes && !layers.Colors)
  {
    int viewport[4];
    vtkFFDFramebuffer::FindViewport(renderer, viewport);
    int pixels[4] = { 0, 0, part.Width(), part.Height() };
    for (int a = 0; a < 2; ++a)
    {
      const double corner = 0.5 * (rectangle[a] + 1.0) * viewport[2 + a];
      pixels[a] = viewport[a] + static_cast<int>(std::lround(corner)) + part.Low[a];
    }
    const unsigned char* const first = image.Bytes + 4 * part.FirstPixel(image.Width);
    if (vtkFFDFramebuffer::BlendPixels(pixels, first, image.Width, gl.Blended))
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
  std::vector<unsigned char>().swap(this->Gl->Blended);
  this->Gl->Window = nullptr;
}
