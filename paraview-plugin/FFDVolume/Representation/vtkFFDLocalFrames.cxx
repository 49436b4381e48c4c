// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLocalFrames.h"

#include "vtkFFDVersions.h"

#include "vtkCameraPass.h"
#include "vtkCommand.h"
#include "vtkLightsPass.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkProp.h"
#include "vtkPVRenderView.h"
#include "vtkPVSynchronizedRenderer.h"
#include "vtkRenderer.h"
#include "vtkRenderPass.h"
#include "vtkRenderPassCollection.h"
#include "vtkRenderState.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSequencePass.h"
#include "vtkSmartPointer.h"
#include "vtkSMSession.h"
#include "vtkSMViewProxy.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWeakPointer.h"
#include VTK_FFD_OPENGL_HEADER

#include <algorithm>
#include <array>

namespace
{

/// Frames a second that ParaView asks for when a scene is still are fewer, others more.
constexpr double InteractiveRate = 0.1;

/// Draws a picture, and over it a widget.
class PicturePass : public vtkRenderPass
{
public:
  static PicturePass* New();
  vtkTypeMacro(PicturePass, vtkRenderPass);

  void Render(const vtkRenderState* state) override
  {
    this->NumberOfRenderedProps = 0;
    vtkRenderer* renderer = state->GetRenderer();
    this->DrawPicture(renderer);
    if (this->Widget)
    {
      this->NumberOfRenderedProps += this->Widget->RenderOpaqueGeometry(renderer);
      this->NumberOfRenderedProps += this->Widget->RenderTranslucentPolygonalGeometry(renderer);
      this->NumberOfRenderedProps += this->Widget->RenderOverlay(renderer);
    }
  }

  vtkNew<vtkUnsignedCharArray> Pixels; // four components
  std::array<int, 2> Size{ { 0, 0 } };
  vtkWeakPointer<vtkProp> Widget;

private:
  void DrawPicture(vtkRenderer* renderer)
  {
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
    vtkOpenGLState* openGL = window->GetState();
    openGL->vtkglClearDepth(1.0);
    openGL->vtkglDepthMask(GL_TRUE);
    openGL->vtkglClear(GL_DEPTH_BUFFER_BIT);
    const vtkOpenGLState::ScopedglEnableDisable blend(openGL, GL_BLEND);
    const vtkOpenGLState::ScopedglEnableDisable depthTest(openGL, GL_DEPTH_TEST);
    const vtkOpenGLState::ScopedglEnableDisable scissor(openGL, GL_SCISSOR_TEST);
    openGL->vtkglDisable(GL_BLEND);
    openGL->vtkglDisable(GL_DEPTH_TEST);
    openGL->vtkglDisable(GL_SCISSOR_TEST);
    window->DrawPixels(0, 0, this->Size[0] - 1, this->Size[1] - 1, 4, VTK_UNSIGNED_CHAR,
      this->Pixels->GetPointer(0));
  }
};

vtkStandardNewMacro(PicturePass);

/// A member of ParaView's view that is for its subclasses.
struct View : vtkPVRenderView
{
  static vtkPVSynchronizedRenderer* GetSynchronizer(vtkPVRenderView* view)
  {
    return view->*(&View::SynchronizedRenderers);
  }
};

std::array<int, 2> GetSize(vtkRenderWindow* window)
{
  std::array<int, 2> size;
  std::copy_n(window->GetActualSize(), 2, size.begin());
  return size;
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDLocalFrames::vtkInternals
{
public:
  vtkWeakPointer<vtkPVRenderView> View;
  vtkWeakPointer<vtkRenderer> Renderer; // of what the server renders
  vtkWeakPointer<vtkRenderWindowInteractor> Interactor;
  unsigned long EndTag = 0;
  unsigned long RenderTag = 0;
  vtkNew<PicturePass> Picture; // of size 0: none is kept
  bool Local = false;          // a frame is being made here

  /// After the server's picture has been drawn, before other layers are.
  void Keep(vtkObject*, unsigned long, void*)
  {
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(this->Renderer->GetRenderWindow());
    if (this->Local || this->Renderer->GetSelector() || !window)
    {
      return;
    }
    this->Picture->Size = { { 0, 0 } };
    const int* tiles = window->GetTileScale();
    // While the scene moves frames follow each other, and nobody drags the lattice meanwhile.
    const bool isMoving = window->GetDesiredUpdateRate() > InteractiveRate;
    if (!this->View || !::View::GetSynchronizer(this->View)->GetEnabled() || tiles[0] != 1 ||
      tiles[1] != 1 || isMoving)
    {
      return;
    }
    const std::array<int, 2> size = GetSize(window);
    if (window->GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 0, this->Picture->Pixels) ==
      VTK_OK)
    {
      this->Picture->Size = size;
    }
  }

  /// Returns whether the frame is made here, and nobody else is to make it.
  bool Render(vtkObject*, unsigned long, void*)
  {
    vtkRenderWindow* window = this->Renderer ? this->Renderer->GetRenderWindow() : nullptr;
    if (!window || this->Picture->Size[0] == 0 || this->Picture->Size != GetSize(window))
    {
      return false;
    }
    vtkPVSynchronizedRenderer* synchronizer = ::View::GetSynchronizer(this->View);
    const vtkSmartPointer<vtkRenderPass> pass = this->Renderer->GetPass();
    this->Local = true;
    synchronizer->SetEnabled(false); // the view sets it for each of its own frames
    vtkNew<vtkRenderPassCollection> passes;
    passes->AddItem(vtkNew<vtkLightsPass>());
    passes->AddItem(this->Picture);
    vtkNew<vtkSequencePass> sequence;
    sequence->SetPasses(passes);
    vtkNew<vtkCameraPass> frame;
    frame->SetDelegatePass(sequence);
    this->Renderer->SetPass(frame);
    window->Render();
    this->Renderer->SetPass(pass);
    synchronizer->SetEnabled(true);
    this->Local = false;
    return true;
  }
};

//------------------------------------------------------------------------------
vtkFFDLocalFrames::vtkFFDLocalFrames()
  : Internals(new vtkInternals)
{
}

//------------------------------------------------------------------------------
vtkFFDLocalFrames::~vtkFFDLocalFrames() { this->SetView(nullptr); }

//------------------------------------------------------------------------------
void vtkFFDLocalFrames::SetView(vtkSMViewProxy* proxy)
{
  vtkInternals& in = *this->Internals;
  this->End();
  if (in.Renderer)
  {
    in.Renderer->RemoveObserver(in.EndTag);
  }
  this->Forget();
  in.Renderer = nullptr;
  in.View = vtkPVRenderView::SafeDownCast(proxy ? proxy->GetClientSideObject() : nullptr);
  if (!in.View || !proxy->GetSession() || !proxy->GetSession()->IsA("vtkSMSessionClient"))
  {
    return;
  }
  in.Renderer = in.View->GetRenderer();
  in.Interactor = in.View->GetInteractor();
  // The server's picture comes at the same event.
  in.EndTag = in.Renderer->AddObserver(vtkCommand::EndEvent, &in, &vtkInternals::Keep, -1.0f);
}

//------------------------------------------------------------------------------
void vtkFFDLocalFrames::Begin(vtkProp* widget)
{
  vtkInternals& in = *this->Internals;
  this->End();
  in.Picture->Widget = widget;
  if (in.Renderer && in.Interactor)
  {
    in.RenderTag =
      in.Interactor->AddObserver(vtkCommand::RenderEvent, &in, &vtkInternals::Render, 1.0f);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLocalFrames::End()
{
  vtkInternals& in = *this->Internals;
  if (in.Interactor && in.RenderTag != 0)
  {
    in.Interactor->RemoveObserver(in.RenderTag);
  }
  in.RenderTag = 0;
}

//------------------------------------------------------------------------------
void vtkFFDLocalFrames::Forget() { this->Internals->Picture->Size = { { 0, 0 } }; }
