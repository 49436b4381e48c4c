// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDInteractiveFrames.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDPendingInput.h"
#include "vtkFFDSceneState.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSmartPointer.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"
#include "vtkVolumeCollection.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDInteractiveFrames);

namespace
{

/// Milliseconds from a coarse picture, or from an abort, to the still frame.
constexpr unsigned long AfterCoarse = 10;
constexpr unsigned long AfterAbort = 200;
constexpr unsigned long TimerPeriod = 20;

/// Call function(vtkFFDInverseRayVolumeMapper*) for the mappers of the volumes that the window
/// shows.
template <class Function>
void ForEachShownMapper(vtkRenderWindow* window, Function function)
{
  vtkCollectionSimpleIterator r;
  vtkRendererCollection* renderers = window->GetRenderers();
  renderers->InitTraversal(r);
  while (vtkRenderer* renderer = renderers->GetNextRenderer(r))
  {
    vtkCollectionSimpleIterator v;
    vtkVolumeCollection* volumes = renderer->GetVolumes();
    volumes->InitTraversal(v);
    while (vtkVolume* volume = volumes->GetNextVolume(v))
    {
      auto* mapper = vtkFFDInverseRayVolumeMapper::SafeDownCast(volume->GetMapper());
      if (mapper && volume->GetVisibility() && renderer->GetDraw())
      {
        function(mapper);
      }
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDInteractiveFrames::vtkInternals
{
public:
  enum class Kind
  {
    Other, ///< without a volume of ours, or nothing of our concern
    Moving,
    Coarse, ///< asked for as a still one
    Still
  };

  explicit vtkInternals(vtkFFDInteractiveFrames* self)
    : Self(self)
  {
    this->Command->SetClientData(this);
    this->Command->SetCallback([](vtkObject* caller, unsigned long event, void* data, void* call) {
      static_cast<vtkInternals*>(data)->Execute(caller, event, call);
    });
  }

  ~vtkInternals() { this->Detach(); }

  void Attach(vtkRenderWindowInteractor* interactor);
  void Detach();

  void Execute(vtkObject* caller, unsigned long event, void* data);
  void Begin();
  void End();
  void OnProgress(vtkObject* mapper);
  void ShowProgress();
  void RestoreTitle();
  void OnTimer();
  void Schedule(unsigned long milliseconds);

  bool IsStillRate() const;
  void FindMappers();

  vtkFFDInteractiveFrames* Self;
  vtkNew<vtkCallbackCommand> Command;
  vtkWeakPointer<vtkRenderWindowInteractor> Interactor;
  vtkWeakPointer<vtkRenderWindow> Window;
  std::vector<vtkWeakPointer<vtkFFDInverseRayVolumeMapper>> Mappers; // of the frame

  Kind Frame = Kind::Other; // in progress, or the last one
  bool InFrame = false;
  bool Final = false; // the frame is to be a still one
  bool Whole = false; // nor is it to be aborted
  bool Due = false;   // a still frame is to follow
  double StillRate = 0.0;
  int Timer = -1;
  double NotBefore = 0.0; // of the still frame
  double BeginTime = 0.0; // of the frame
  std::string Title;      // of the window, while another one is shown
  std::string ShownTitle;
  vtkFFDSceneState ShownState; // after the last frame that was not a still one
};

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::Attach(vtkRenderWindowInteractor* interactor)
{
  this->Detach();
  this->Interactor = interactor;
  this->Window = interactor ? interactor->GetRenderWindow() : nullptr;
  if (this->Window)
  {
    interactor->AddObserver(vtkCommand::TimerEvent, this->Command);
    for (unsigned long event :
      { vtkCommand::StartEvent, vtkCommand::EndEvent, vtkCommand::AbortCheckEvent })
    {
      this->Window->AddObserver(event, this->Command);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::Detach()
{
  if (this->InFrame)
  {
    this->End();
  }
  for (vtkFFDInverseRayVolumeMapper* mapper : this->Mappers)
  {
    if (mapper)
    {
      mapper->RemoveObserver(this->Command);
    }
  }
  this->Mappers.clear();
  if (this->Window)
  {
    this->Window->RemoveObserver(this->Command);
  }
  if (this->Interactor)
  {
    if (this->Timer >= 0)
    {
      this->Interactor->DestroyTimer(this->Timer);
    }
    this->Interactor->RemoveObserver(this->Command);
  }
  this->Timer = -1;
  this->Due = false;
  this->Frame = Kind::Other;
  this->Window = nullptr;
  this->Interactor = nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::Execute(
  vtkObject* caller, unsigned long event, void* data)
{
  // Observers may let go of the last reference: it stays until it is done.
  const vtkSmartPointer<vtkFFDInteractiveFrames> keep(this->Self);
  if (event == vtkCommand::TimerEvent)
  {
    if (this->Timer >= 0 && data && *static_cast<int*>(data) == this->Timer)
    {
      this->OnTimer();
    }
  }
  else if (event == vtkCommand::ProgressEvent)
  {
    this->OnProgress(caller);
  }
  else if (event == vtkCommand::StartEvent)
  {
    this->Begin();
  }
  else if (event == vtkCommand::EndEvent)
  {
    this->End();
  }
  else if (this->InFrame && this->Frame == Kind::Still && !this->Whole && this->Window &&
    HasPendingInput(this->Window))
  {
    this->Window->SetAbortRender(1);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDInteractiveFrames::vtkInternals::IsStillRate() const
{
  return this->Window->GetDesiredUpdateRate() *
    std::max(1, this->Window->GetRenderers()->GetNumberOfItems()) <=
    1.0;
}

//------------------------------------------------------------------------------
/// The mappers that the window shows.
void vtkFFDInteractiveFrames::vtkInternals::FindMappers()
{
  for (vtkFFDInverseRayVolumeMapper* mapper : this->Mappers)
  {
    if (mapper)
    {
      mapper->RemoveObserver(this->Command);
    }
  }
  this->Mappers.clear();
  ForEachShownMapper(this->Window, [this](vtkFFDInverseRayVolumeMapper* mapper) {
    mapper->AddObserver(vtkCommand::ProgressEvent, this->Command);
    this->Mappers.emplace_back(mapper);
  });
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::Begin()
{
  this->InFrame = true;
  this->FindMappers();
  const Kind last = this->Frame;
  this->Frame = Kind::Other;
  if (this->Mappers.empty())
  {
    // What a still frame was due for is not shown any more.
    this->Due = false;
    return;
  }
  if (!this->IsStillRate())
  {
    this->Frame = Kind::Moving;
    return;
  }
  // Between frames only: a frame modifies its renderers.
  const bool isShown = (last == Kind::Moving || last == Kind::Coarse) &&
    this->ShownState == vtkFFDFindSceneState(this->Window);
  // Without its interactor there is no event loop from which a still frame would follow.
  if (!this->Final && !isShown && this->Interactor && this->Interactor->GetInitialized() &&
    vtkFFDInteractiveFrames::GetExpectedStillTime(this->Window) > this->Self->LongestWait)
  {
    this->Frame = Kind::Coarse;
    this->StillRate = this->Window->GetDesiredUpdateRate();
    this->Window->SetDesiredUpdateRate(std::max(this->Interactor->GetDesiredUpdateRate(), 2.0));
    return;
  }
  this->Frame = Kind::Still;
  this->BeginTime = vtkTimerLog::GetUniversalTime();
  this->Self->Progress = 0.0;
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::End()
{
  if (!this->InFrame || !this->Window)
  {
    return;
  }
  this->InFrame = false;
  if (this->Frame == Kind::Coarse)
  {
    this->Window->SetDesiredUpdateRate(this->StillRate);
    this->Schedule(AfterCoarse);
  }
  if (this->Frame == Kind::Still)
  {
    this->Due = false;
    this->Self->Progress = 1.0;
    this->RestoreTitle();
    if (this->Window->GetAbortRender())
    {
      ++this->Self->NumberOfAbortedFrames;
      this->Schedule(AfterAbort);
    }
    this->Self->InvokeEvent(vtkCommand::ProgressEvent, &this->Self->Progress);
  }
  else if (this->Frame != Kind::Other)
  {
    this->ShownState = vtkFFDFindSceneState(this->Window);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::OnProgress(vtkObject* caller)
{
  const auto at = std::find(this->Mappers.begin(), this->Mappers.end(), caller);
  if (!this->InFrame || this->Frame != Kind::Still || at == this->Mappers.end())
  {
    return;
  }
  const double part = (static_cast<double>(at - this->Mappers.begin()) + (*at)->GetProgress()) /
    static_cast<double>(this->Mappers.size());
  this->Self->Progress = std::max(this->Self->Progress, part);
  this->ShowProgress();
  this->Self->InvokeEvent(vtkCommand::ProgressEvent, &this->Self->Progress);
  // The window itself asks no more than five times a second.
  if (!this->Whole && this->Window && HasPendingInput(this->Window))
  {
    this->Window->SetAbortRender(1);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::ShowProgress()
{
  if (!this->Self->ShowProgressInTitle || !this->Window || !this->Window->GetShowWindow() ||
    vtkTimerLog::GetUniversalTime() - this->BeginTime < this->Self->LongestWait)
  {
    return;
  }
  if (this->ShownTitle.empty())
  {
    const char* title = this->Window->GetWindowName();
    this->Title = title ? title : "";
  }
  const int percent = static_cast<int>(100.0 * this->Self->Progress);
  const std::string shown = this->Title + " - rendering, " + std::to_string(percent) + " %";
  if (shown != this->ShownTitle)
  {
    this->ShownTitle = shown;
    this->Window->SetWindowName(shown.c_str());
  }
}

//------------------------------------------------------------------------------
/// The title as before, unless somebody else has changed it.
void vtkFFDInteractiveFrames::vtkInternals::RestoreTitle()
{
  const char* title = this->Window->GetWindowName();
  if (!this->ShownTitle.empty() && title && this->ShownTitle == title)
  {
    this->Window->SetWindowName(this->Title.c_str());
  }
  this->ShownTitle.clear();
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::Schedule(unsigned long milliseconds)
{
  this->Due = true;
  this->NotBefore = vtkTimerLog::GetUniversalTime() + 1e-3 * static_cast<double>(milliseconds);
  if (this->Interactor && this->Timer < 0)
  {
    // A timer of X11 that is made while another one fires never fires itself.
    this->Timer = this->Interactor->CreateRepeatingTimer(TimerPeriod);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::vtkInternals::OnTimer()
{
  if (!this->Due || !this->Window || vtkTimerLog::GetUniversalTime() < this->NotBefore)
  {
    return;
  }
  if (this->Interactor->GetRenderWindow() != this->Window)
  {
    // It has got another one, and does not draw ours any more.
    this->Due = false;
    return;
  }
  if (this->InFrame || !this->IsStillRate())
  {
    this->Schedule(AfterAbort);
    return;
  }
  this->Final = true;
  this->Interactor->Render();
  this->Final = false;
}

//------------------------------------------------------------------------------
vtkFFDInteractiveFrames::vtkFFDInteractiveFrames()
  : Internals(new vtkInternals(this))
{
}

//------------------------------------------------------------------------------
vtkFFDInteractiveFrames::~vtkFFDInteractiveFrames() = default;

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::SetInteractor(vtkRenderWindowInteractor* interactor)
{
  if (interactor && !interactor->GetRenderWindow())
  {
    vtkErrorMacro("SetInteractor: the interactor has no window. Call its SetRenderWindow() first.");
    return;
  }
  // The interactor may have got another window since.
  vtkRenderWindow* const window = interactor ? interactor->GetRenderWindow() : nullptr;
  if (this->Internals->Interactor != interactor || this->Internals->Window != window)
  {
    this->Internals->Attach(interactor);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkRenderWindowInteractor* vtkFFDInteractiveFrames::GetInteractor()
{
  return this->Internals->Interactor;
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::SetLongestWait(double seconds)
{
  if (!(seconds >= 0.0) || !std::isfinite(seconds))
  {
    vtkErrorMacro("LongestWait must be a number of seconds that is not negative, not "
      << seconds << "; it stays " << this->LongestWait << ".");
    return;
  }
  if (this->LongestWait != seconds)
  {
    this->LongestWait = seconds;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkFFDInteractiveFrames::GetExpectedStillTime(vtkRenderWindow* window)
{
  double expected = 0.0;
  if (window)
  {
    ForEachShownMapper(window, [&expected](vtkFFDInverseRayVolumeMapper* mapper) {
      if (mapper->GetAutoAdjustSampleDistances())
      {
        const double time = mapper->GetExpectedStillTime();
        expected = time > 0.0 ? expected + time : VTK_DOUBLE_MAX;
      }
    });
  }
  return expected;
}

//------------------------------------------------------------------------------
bool vtkFFDInteractiveFrames::IsStillFrameDue()
{
  return this->Internals->Due && this->Internals->Window;
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::Abort()
{
  vtkInternals& in = *this->Internals;
  if (in.InFrame && in.Frame == vtkInternals::Kind::Still && in.Window)
  {
    in.Window->SetAbortRender(1);
  }
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::RenderStill()
{
  vtkInternals& in = *this->Internals;
  if (!in.Window)
  {
    vtkErrorMacro("RenderStill: there is no window. Call SetInteractor() first.");
    return;
  }
  const vtkSmartPointer<vtkFFDInteractiveFrames> keep(this);
  in.Final = true;
  in.Whole = true;
  in.Window->Render();
  in.Final = false;
  in.Whole = false;
}

//------------------------------------------------------------------------------
void vtkFFDInteractiveFrames::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Interactor: " << this->GetInteractor() << "\n";
  os << indent << "LongestWait: " << this->LongestWait << "\n";
  os << indent << "ShowProgressInTitle: " << this->ShowProgressInTitle << "\n";
  os << indent << "Progress: " << this->Progress << "\n";
  os << indent << "NumberOfAbortedFrames: " << this->NumberOfAbortedFrames << "\n";
}
