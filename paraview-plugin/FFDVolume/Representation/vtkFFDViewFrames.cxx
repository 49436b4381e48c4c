// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDViewFrames.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDServerFrames.h"
#include "vtkFFDServerPass.h"
#include "vtkFFDVolumeOrder.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkProcessModule.h"
#include "vtkPVProgressHandler.h"
#include "vtkPVSession.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"

#include <utility>

vtkStandardNewMacro(vtkFFDViewFrames);

namespace
{

/// Seconds between messages of progress, and looks for an abort, in frames of a server.
constexpr double ServerProgressInterval = 0.1;

} // namespace

//------------------------------------------------------------------------------
vtkFFDViewFrames::vtkFFDViewFrames()
{
  // Messages of progress are what a client may answer with a request for an abort.
  this->Pass->SetWait([this]() {
    if (this->FirstMapper)
    {
      this->FirstMapper->UpdateProgress(this->FirstMapper->GetProgress());
    }
  });
}

//------------------------------------------------------------------------------
vtkFFDViewFrames::~vtkFFDViewFrames() = default;

//------------------------------------------------------------------------------
void vtkFFDViewFrames::SetQuestion(std::function<bool()> isShown)
{
  this->IsShown = std::move(isShown);
}

//------------------------------------------------------------------------------
void vtkFFDViewFrames::AddMapper(vtkFFDInverseRayVolumeMapper* mapper)
{
  mapper->SetProgressText("FFD Volume");
  mapper->AddObserver(vtkCommand::ProgressEvent, this, &vtkFFDViewFrames::ContinueVolume);
  if (!this->FirstMapper)
  {
    this->FirstMapper = mapper;
  }
  if (this->Session && this->Session->GetProgressHandler())
  {
    this->Session->GetProgressHandler()->RegisterProgressEvent(mapper, 0);
  }
}

//------------------------------------------------------------------------------
void vtkFFDViewFrames::Connect(vtkRenderer* renderer)
{
  this->FollowSession();
  this->Observers = { { renderer->AddObserver(
                          vtkCommand::StartEvent, this, &vtkFFDViewFrames::Begin),
    renderer->AddObserver(vtkCommand::EndEvent, this, &vtkFFDViewFrames::End) } };
}

//------------------------------------------------------------------------------
void vtkFFDViewFrames::Disconnect(vtkRenderer* renderer)
{
  for (const unsigned long observer : this->Observers)
  {
    renderer->RemoveObserver(observer);
  }
}

//------------------------------------------------------------------------------
/// Frames show how far they are where pipelines do. A client's window is not to draw the picture
/// of its server in the OpenGL context of what shows the progress.
void vtkFFDViewFrames::FollowSession()
{
  vtkProcessModule* processes = vtkProcessModule::GetProcessModule();
  auto* session = vtkPVSession::SafeDownCast(processes && processes->GetActiveSession()
      ? processes->GetActiveSession()
      : (processes ? processes->GetSession() : nullptr));
  const auto type = vtkProcessModule::GetProcessType();
  const bool ownWindow =
    type == vtkProcessModule::PROCESS_CLIENT || type == vtkProcessModule::PROCESS_BATCH;
  const bool toClient = session && session->GetController(vtkPVSession::CLIENT);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->HasOwnRenderer = !(controller && controller->GetNumberOfProcesses() > 1) && session &&
    session->GetProcessRoles() == vtkPVSession::CLIENT_AND_SERVERS;
  if (!(ownWindow || toClient) || !session || !session->GetProgressHandler() || this->Session)
  {
    return;
  }
  this->Session = session;
  session->GetProgressHandler()->RegisterProgressEvent(this->FirstMapper, 0);
  if (toClient)
  {
    ffdserver::Listen(session);
  }
  else
  {
    session->GetProgressHandler()->AddObserver(
      vtkCommand::ProgressEvent, this, &vtkFFDViewFrames::KeepContext, 1.0f);
    session->GetProgressHandler()->AddObserver(
      vtkCommand::ProgressEvent, this, &vtkFFDViewFrames::TakeContextBack, -1.0f);
  }
}

//------------------------------------------------------------------------------
/// Called on all rendering processes alike.
void vtkFFDViewFrames::Begin(vtkObject* object, unsigned long, void*)
{
  vtkRenderer* renderer = vtkRenderer::SafeDownCast(object);
  if (!this->IsShown || !this->IsShown())
  {
    return;
  }
  this->Window = renderer->GetRenderWindow();
  ffdorder::SortVolumes(renderer);
  vtkPVProgressHandler* progress = this->Session ? this->Session->GetProgressHandler() : nullptr;
  if (progress && progress->GetProgressInterval() > ServerProgressInterval)
  {
    this->ProgressInterval = progress->GetProgressInterval();
    progress->SetProgressInterval(ServerProgressInterval);
  }
  // The passes of depth peeling ask a volume for more than a picture: what they get from mappers
  // that do not know them is garbage all over the view.
  if (renderer->GetUseDepthPeelingForVolumes())
  {
    this->TookPeelingOff = true;
    renderer->SetUseDepthPeelingForVolumes(false);
  }
  // Synchronizers of renderers, of which a session without a server has none, smooth the finished
  // picture instead.
  if (renderer->GetUseFXAA() && this->HasOwnRenderer && ffdorder::IsEmptyBeforeVolumes(renderer))
  {
    this->TookSmoothingOff = true;
    renderer->SetUseFXAA(false);
  }
  if (ffdserver::IsGroup())
  {
    this->Pass->Begin(renderer);
  }
}

//------------------------------------------------------------------------------
void vtkFFDViewFrames::ContinueVolume(vtkObject* mapper, unsigned long, void*)
{
  if (ffdserver::IsAbortAsked(this->Session))
  {
    vtkAlgorithm::SafeDownCast(mapper)->SetAbortExecute(1);
  }
}

//------------------------------------------------------------------------------
/// What shows the progress paints widgets, in OpenGL contexts of theirs. The one with the window
/// may be among them, as after its size has changed: then it binds another framebuffer, which VTK
/// does not know of, and nothing of the rest of the frame would be seen.
void vtkFFDViewFrames::KeepContext()
{
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(this->Window);
  if (window && !this->KeptState)
  {
    this->KeptState = window->GetState();
    // Pop() binds the buffers that were bound at the last Reset(), which may have been deleted
    // since.
    this->KeptState->Reset();
    this->KeptState->Push();
  }
}

//------------------------------------------------------------------------------
void vtkFFDViewFrames::TakeContextBack()
{
  if (this->Window)
  {
    this->Window->MakeCurrent();
  }
  if (this->KeptState)
  {
    this->KeptState->Pop();
    this->KeptState = nullptr;
  }
}

//------------------------------------------------------------------------------
void vtkFFDViewFrames::End(vtkObject* object, unsigned long, void*)
{
  if (this->TookPeelingOff)
  {
    this->TookPeelingOff = false;
    vtkRenderer::SafeDownCast(object)->SetUseDepthPeelingForVolumes(true);
  }
  if (this->TookSmoothingOff)
  {
    this->TookSmoothingOff = false;
    vtkRenderer::SafeDownCast(object)->SetUseFXAA(true);
  }
  if (this->ProgressInterval > 0.0 && this->Session && this->Session->GetProgressHandler())
  {
    this->Session->GetProgressHandler()->SetProgressInterval(this->ProgressInterval);
    this->ProgressInterval = 0.0;
  }
  this->Window = nullptr;
  this->Pass->End();
}
