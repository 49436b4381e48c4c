// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrame
 * @brief   guards a frame of a volume mapper that is in progress
 *
 * Private to this module: not installed, not wrapped. Observers of the frame's events may do
 * anything: change or delete what is being rendered, or call the mapper again. The guard keeps
 * alive what the frame reads, lets the mapper tell such calls from others (they see the frame's
 * snapshot, are refused, or are put off until its end), and is the one place that reports progress
 * and asks for an abort.
 *
 * Events come from the thread that renders, while no other one works on the frame: first
 * StartEvent and VolumeMapperRenderStartEvent, then VolumeMapperRenderProgressEvent and
 * ProgressEvent with values that do not fall, then VolumeMapperRenderEndEvent and EndEvent, however
 * the frame ends.
 */
#ifndef vtkFFDFrame_h
#define vtkFFDFrame_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <chrono>
#include <functional>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkObject;
class vtkProp;
class vtkRenderer;
class vtkRenderPass;
class vtkRenderWindow;
class vtkVolume;
class vtkVolumeMapper;

class vtkFFDFrame
{
public:
  using Clock = std::chrono::steady_clock;

  /// Thrown through the kernels that prepare a frame when it is aborted, in the thread that
  /// renders.
  struct Aborted
  {
  };

  /// Puts itself into `current`, which must be null, until it is deleted. `window`: what shows the
  /// frame and may abort it, or null.
  vtkFFDFrame(vtkFFDFrame*& current, vtkVolumeMapper* mapper, vtkRenderer* renderer,
    vtkVolume* volume, vtkRenderWindow* window);
  ~vtkFFDFrame();
  vtkFFDFrame(const vtkFFDFrame&) = delete;
  vtkFFDFrame& operator=(const vtkFFDFrame&) = delete;

  /// Keep the arrays that the frame reads alive; their memory must stay where it is.
  void Hold(const std::vector<vtkDataArray*>& arrays);

  /// Carried out once the frame is over, when it counts no more as in progress.
  void AtEnd(std::function<void()> work) { this->Deferred.push_back(std::move(work)); }

  /// Whether the progress events are invoked. Default: true.
  void SetReportsProgress(bool reports) { this->ReportsProgress = reports; }
  /// Whether somebody observes the progress.
  bool IsFollowed() const;

  /// When to report next.
  Clock::time_point GetNextReport() const { return this->NextReport; }
  bool HasReported() const { return this->Started; }
  double GetSeconds() const;
  /// The last of ReportCasting().
  double GetCastPart() const { return this->CastPart; }

  /// Reports the part, 0 to 1, of the present loop of the preparation that is done. The number of
  /// loops is not known beforehand. Throws Aborted.
  void ReportPreparation(double part);
  /// Reports the part of the picture that has been cast, 0 to 1. Returns whether to go on.
  bool ReportCasting(double part);

private:
  bool Report(double progress);
  bool IsIntact() const;
  void KeepAlive();

  struct HeldArray
  {
    vtkSmartPointer<vtkDataArray> Array;
    const void* Data;
    vtkIdType Size;
  };

  vtkFFDFrame*& Current;
  vtkSmartPointer<vtkVolumeMapper> Mapper;
  vtkSmartPointer<vtkRenderer> Renderer;
  vtkSmartPointer<vtkVolume> Volume;
  vtkSmartPointer<vtkRenderWindow> Window;
  std::vector<vtkSmartPointer<vtkProp>> Props; // of the renderer
  vtkSmartPointer<vtkRenderPass> Pass;         // of the renderer
  std::vector<HeldArray> Arrays;
  std::vector<std::function<void()>> Deferred;
  bool WasMapper; // of the volume
  Clock::time_point Begin;
  Clock::time_point NextReport;
  double Patience; // seconds in which the window does not abort
  bool ReportsProgress = true;
  bool Started = false;
  bool Casting = false;
  double Progress = 0.0;
  double CastPart = 0.0;
  double Base = 0.0;     // of Progress, before the present loop
  double LastPart = 0.0; // of that loop
};

#endif
