// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrame.h"

#include "vtkFFDGuard.h"

#include "vtkCollection.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkProp.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkRenderPass.h"
#include "vtkRenderWindow.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"

#include <algorithm>
#include <utility>

namespace
{

/// Time between reports: a part of what has passed, so that short frames report, too.
constexpr double ShortestInterval = 0.01;
constexpr double LongestInterval = 0.05;
constexpr double IntervalPart = 0.5;

/// Frames while the scene moves are not aborted by their window sooner than this: else a stream of
/// events would leave none.
constexpr double LeastPatience = 0.05;

/// Progress at which the preparation ends at the latest.
constexpr double PreparationEnd = 0.5;

/// Keeps objects until the renderer is done with them, then forgets them and itself.
class Keeper : public vtkCommand
{
public:
  static Keeper* New() { return new Keeper; }
  vtkTypeMacro(Keeper, vtkCommand);

  void Execute(vtkObject* caller, unsigned long, void*) override
  {
    const vtkSmartPointer<Keeper> self(this);
    caller->RemoveObserver(this);
    if (this->RemoveMapper && this->Volume->GetMapper() == this->Mapper)
    {
      this->Volume->SetMapper(nullptr);
    }
    // They have been drawn since they were removed.
    for (vtkProp* prop : this->Props)
    {
      prop->ReleaseGraphicsResources(this->Window);
    }
    this->Props.clear();
    if (this->Pass)
    {
      this->Pass->ReleaseGraphicsResources(this->Window);
      this->Pass = nullptr;
    }
    this->Volume = nullptr;
    this->Mapper = nullptr;
    this->Window = nullptr;
  }

  vtkSmartPointer<vtkRenderWindow> Window;
  std::vector<vtkSmartPointer<vtkProp>> Props; ///< those that were removed
  vtkSmartPointer<vtkRenderPass> Pass;         ///< one that was replaced
  vtkSmartPointer<vtkVolume> Volume;
  vtkSmartPointer<vtkVolumeMapper> Mapper;
  bool RemoveMapper = false;
};

vtkFFDFrame::Clock::duration ToDuration(double seconds)
{
  return std::chrono::duration_cast<vtkFFDFrame::Clock::duration>(
    std::chrono::duration<double>(seconds));
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDFrame::vtkFFDFrame(vtkFFDFrame*& current, vtkVolumeMapper* mapper, vtkRenderer* renderer,
  vtkVolume* volume, vtkRenderWindow* window)
  : Current(current)
  , Mapper(mapper)
  , Renderer(renderer)
  , Volume(volume)
  , Window(window)
  , WasMapper(volume->GetMapper() == mapper)
  , Begin(Clock::now())
  , NextReport(Begin + ToDuration(ShortestInterval))
{
  this->Current = this;
  if (window)
  {
    this->Pass = renderer->GetPass();
    // Observers of the collection may be in the middle of it.
    vtkCollectionSimpleIterator at;
    vtkPropCollection* const props = renderer->GetViewProps();
    props->InitTraversal(at);
    while (vtkProp* const prop = props->GetNextProp(at))
    {
      this->Props.emplace_back(prop);
    }
  }
  const double allotted = volume->GetAllocatedRenderTime();
  this->Patience = allotted < 1.0 ? std::max(LeastPatience, 2.0 * allotted) : 0.0;
  mapper->SetAbortExecute(0);
}

//------------------------------------------------------------------------------
/// No exception of an observer may leave a destructor, nor keep the rest from being done.
vtkFFDFrame::~vtkFFDFrame()
{
  const auto invoke = [this](unsigned long event) {
    vtkFFDGuard(this->Mapper, "Render", [&] { this->Mapper->InvokeEvent(event, nullptr); });
  };
  if (this->Started)
  {
    invoke(vtkCommand::VolumeMapperRenderEndEvent);
    invoke(vtkCommand::EndEvent);
  }
  this->Current = nullptr;
  for (const std::function<void()>& work : this->Deferred)
  {
    vtkFFDGuard(this->Mapper, "Render", work);
  }
  vtkFFDGuard(this->Mapper, "Render", [this] { this->KeepAlive(); });
}

//------------------------------------------------------------------------------
/// The volume and the renderer go on with what an observer may have removed: they get it until the
/// renderer is done.
void vtkFFDFrame::KeepAlive()
{
  if (!this->Window)
  {
    return;
  }
  const bool removed = this->WasMapper && !this->Volume->GetMapper();
  const auto isKept = [](const vtkSmartPointer<vtkProp>& prop) {
    return prop->GetReferenceCount() > 1;
  };
  this->Props.erase(
    std::remove_if(this->Props.begin(), this->Props.end(), isKept), this->Props.end());
  if (this->Pass && this->Pass->GetReferenceCount() > 1)
  {
    this->Pass = nullptr;
  }
  if (!removed && this->Props.empty() && !this->Pass && this->Volume->GetReferenceCount() > 1 &&
    this->Mapper->GetReferenceCount() > 1)
  {
    return;
  }
  if (removed)
  {
    this->Volume->SetMapper(this->Mapper);
  }
  vtkNew<Keeper> keeper;
  keeper->Window = this->Window;
  keeper->Props = std::move(this->Props);
  keeper->Pass = this->Pass;
  keeper->Volume = this->Volume;
  keeper->Mapper = this->Mapper;
  keeper->RemoveMapper = removed;
  this->Renderer->AddObserver(vtkCommand::EndEvent, keeper);
}

//------------------------------------------------------------------------------
void vtkFFDFrame::Hold(const std::vector<vtkDataArray*>& arrays)
{
  for (vtkDataArray* array : arrays)
  {
    // Other layouts are read from a copy of the array's own.
    this->Arrays.push_back({ array,
      array->HasStandardMemoryLayout() ? array->GetVoidPointer(0) : nullptr, array->GetSize() });
  }
}

//------------------------------------------------------------------------------
bool vtkFFDFrame::IsIntact() const
{
  return std::all_of(this->Arrays.begin(), this->Arrays.end(), [](const HeldArray& held) {
    return !held.Data ||
      (held.Array->GetSize() >= held.Size && held.Array->GetVoidPointer(0) == held.Data);
  });
}

//------------------------------------------------------------------------------
double vtkFFDFrame::GetSeconds() const
{
  return std::chrono::duration<double>(Clock::now() - this->Begin).count();
}

//------------------------------------------------------------------------------
bool vtkFFDFrame::IsFollowed() const
{
  return this->ReportsProgress &&
    (this->Mapper->HasObserver(vtkCommand::VolumeMapperRenderProgressEvent) ||
      this->Mapper->HasObserver(vtkCommand::ProgressEvent));
}

//------------------------------------------------------------------------------
void vtkFFDFrame::ReportPreparation(double part)
{
  if (part <= this->LastPart)
  {
    this->Base = this->Progress;
  }
  this->LastPart = part;
  if (!this->Report(this->Base + 0.5 * (PreparationEnd - this->Base) * part))
  {
    throw Aborted();
  }
}

//------------------------------------------------------------------------------
bool vtkFFDFrame::ReportCasting(double part)
{
  if (!this->Casting)
  {
    this->Casting = true;
    this->Base = this->Progress;
  }
  this->CastPart = part;
  // A finished picture is shown, whatever has happened since.
  return this->Report(this->Base + (1.0 - this->Base) * part) || part >= 1.0;
}

//------------------------------------------------------------------------------
bool vtkFFDFrame::Report(double progress)
{
  if (!this->Started)
  {
    this->Started = true;
    this->Mapper->InvokeEvent(vtkCommand::StartEvent, nullptr);
    this->Mapper->InvokeEvent(vtkCommand::VolumeMapperRenderStartEvent, nullptr);
  }
  this->Progress = std::max(this->Progress, progress);
  if (this->ReportsProgress)
  {
    double value = this->Progress;
    this->Mapper->InvokeEvent(vtkCommand::VolumeMapperRenderProgressEvent, &value);
    this->Mapper->UpdateProgress(this->Progress);
  }
  if (progress < 1.0 && !this->IsIntact())
  {
    vtkErrorWithObjectMacro(this->Mapper,
      "The memory of an array that is being rendered was changed by an observer of the mapper's "
      "events: the frame ends without a picture. Give the mapper another array instead.");
    return false;
  }
  const double seconds = this->GetSeconds();
  const bool aborted = this->Mapper->GetAbortExecute() != 0 ||
    (this->Window && seconds >= this->Patience &&
      (this->Window->GetAbortRender() || this->Window->CheckAbortStatus()));
  this->NextReport = Clock::now() +
    ToDuration(std::clamp(IntervalPart * seconds, ShortestInterval, LongestInterval));
  return !aborted;
}
