// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDImageDisplay.h"

#include "vtkNew.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

#include <memory>

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

} // namespace

//------------------------------------------------------------------------------
struct vtkFFDImageDisplay::Resources
{
  vtkNew<vtkTextureObject> Texture;
  std::unique_ptr<vtkOpenGLQuadHelper> Quad;
  vtkWeakPointer<vtkOpenGLRenderWindow> Window;
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
  const double rectangle[4])
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

  vtkTextureObject* texture = this->Gl->Texture;
  texture->SetContext(window);
  // A texture of the same size is filled again only if it is made again.
  texture->ReleaseGraphicsResources(window);
  if (!texture->Create2DFromRaw(static_cast<unsigned int>(width),
        static_cast<unsigned int>(height), 4, VTK_FLOAT, const_cast<float*>(colours)))
  {
    return false;
  }
  texture->SetWrapS(vtkTextureObject::ClampToEdge);
  texture->SetWrapT(vtkTextureObject::ClampToEdge);
  texture->SetMinificationFilter(vtkTextureObject::Linear);
  texture->SetMagnificationFilter(vtkTextureObject::Linear);

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
  const float corners[4] = { static_cast<float>(rectangle[0]), static_cast<float>(rectangle[1]),
    static_cast<float>(rectangle[2]), static_cast<float>(rectangle[3]) };
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
  this->Gl->Window = nullptr;
}
