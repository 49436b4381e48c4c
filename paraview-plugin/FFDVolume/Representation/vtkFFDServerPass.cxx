// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDServerPass.h"

#include "vtkFFDServerFrames.h"

#include "vtkCameraPass.h"
#include "vtkImageProcessingPass.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkRenderer.h"
#include "vtkRenderState.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"

#if __has_include("vtkIceTCompositePass.h")
#include "vtkIceTCompositePass.h"
#define FFD_HAS_ICET
#endif

#include <utility>

vtkStandardNewMacro(vtkFFDServerPass);

//------------------------------------------------------------------------------
void vtkFFDServerPass::SetWait(std::function<void()> wait) { this->Wait = std::move(wait); }

#ifdef FFD_HAS_ICET

//------------------------------------------------------------------------------
struct vtkFFDServerPass::Place
{
  vtkSmartPointer<vtkIceTCompositePass> IceT;
  vtkSmartPointer<vtkRenderPass> Scene; // the pass that renders it
  bool RenderEmptyImages = false;
};

//------------------------------------------------------------------------------
vtkFFDServerPass::vtkFFDServerPass() = default;

//------------------------------------------------------------------------------
vtkFFDServerPass::~vtkFFDServerPass() { this->End(); }

//------------------------------------------------------------------------------
void vtkFFDServerPass::Begin(vtkRenderer* renderer)
{
  auto* processing = vtkImageProcessingPass::SafeDownCast(renderer->GetPass());
  auto* camera =
    vtkCameraPass::SafeDownCast(processing ? processing->GetDelegatePass() : renderer->GetPass());
  auto* iceT = camera ? vtkIceTCompositePass::SafeDownCast(camera->GetDelegatePass()) : nullptr;
  vtkRenderPass* scene = iceT ? iceT->GetRenderPass() : nullptr;
  // The value pass has buffers of its own, which IceT looks for. Tiles are not rendered by all
  // processes at the same time.
  if (!scene || scene->IsA("vtkFFDServerPass") || scene->IsA("vtkValuePass") ||
    !iceT->GetController() || iceT->GetController()->GetNumberOfProcesses() < 2 ||
    !iceT->GetUseOrderedCompositing() || iceT->GetDataReplicatedOnAllProcesses() ||
    iceT->GetTileDimensions()[0] != 1 || iceT->GetTileDimensions()[1] != 1 ||
    renderer->GetSelector() || renderer->GetRenderWindow()->GetMultiSamples() > 1)
  {
    return;
  }
  this->Taken.reset(new Place);
  this->Taken->IceT = iceT;
  this->Taken->Scene = scene;
  this->Taken->RenderEmptyImages = iceT->GetRenderEmptyImages();
  // Processes without anything in the picture tell the root that they have drawn it, too.
  iceT->SetRenderEmptyImages(true);
  iceT->SetRenderPass(this);
}

//------------------------------------------------------------------------------
void vtkFFDServerPass::End()
{
  if (this->Taken)
  {
    this->Taken->IceT->SetRenderEmptyImages(this->Taken->RenderEmptyImages);
    this->Taken->IceT->SetRenderPass(this->Taken->Scene);
    this->Taken.reset();
  }
}

//------------------------------------------------------------------------------
void vtkFFDServerPass::Render(const vtkRenderState* state)
{
  ffdserver::BeginPart();
  this->Taken->Scene->Render(state);
  this->NumberOfRenderedProps = this->Taken->Scene->GetNumberOfRenderedProps();
  ffdserver::EndPart(this->Wait);
}

#else

struct vtkFFDServerPass::Place
{
};

// Several processes are composited by IceT only.
vtkFFDServerPass::vtkFFDServerPass() = default;
vtkFFDServerPass::~vtkFFDServerPass() = default;
void vtkFFDServerPass::Begin(vtkRenderer*) {}
void vtkFFDServerPass::End() {}
void vtkFFDServerPass::Render(const vtkRenderState*) {}

#endif
