// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDViewFrames
 * @brief   what a view does for a deformed volume while it renders a frame
 *
 * Private to this module. Before the frame: volumes are put in order, and what pictures of volumes
 * cannot take part in, or need not, is turned off until its end. During it: progress is told, and
 * clients of servers may abort it.
 */
#ifndef vtkFFDViewFrames_h
#define vtkFFDViewFrames_h

#include "vtkNew.h"
#include "vtkObject.h"
#include "vtkWeakPointer.h"

#include <array>
#include <functional>

class vtkFFDInverseRayVolumeMapper;
class vtkFFDServerPass;
class vtkOpenGLState;
class vtkPVSession;
class vtkRenderer;
class vtkRenderWindow;

class vtkFFDViewFrames : public vtkObject
{
public:
  static vtkFFDViewFrames* New();
  vtkTypeMacro(vtkFFDViewFrames, vtkObject);

  /// Whether a frame that begins shows the volume; not before this is set does one show it.
  void SetQuestion(std::function<bool()> isShown);

  /// A mapper that renders a part of the volume; those from before Connect() tell progress, too.
  void AddMapper(vtkFFDInverseRayVolumeMapper* mapper);

  ///@{
  /// The renderer of the view, between that the volume is added and that it is removed.
  void Connect(vtkRenderer* renderer);
  void Disconnect(vtkRenderer* renderer);
  ///@}

protected:
  vtkFFDViewFrames();
  ~vtkFFDViewFrames() override;

private:
  vtkFFDViewFrames(const vtkFFDViewFrames&) = delete;
  void operator=(const vtkFFDViewFrames&) = delete;

  void FollowSession();
  void Begin(vtkObject* renderer, unsigned long event, void* data);
  void ContinueVolume(vtkObject* mapper, unsigned long event, void* data);
  void KeepContext();
  void TakeContextBack();
  void End(vtkObject* renderer, unsigned long event, void* data);

  std::function<bool()> IsShown;
  vtkWeakPointer<vtkFFDInverseRayVolumeMapper> FirstMapper;
  std::array<unsigned long, 2> Observers{ { 0, 0 } }; // of the renderer
  bool HasOwnRenderer = false;          // no other process renders the scene or shows it
  vtkWeakPointer<vtkPVSession> Session; // whose progress is told

  // Of the frame in progress.
  bool TookPeelingOff = false;
  bool TookSmoothingOff = false;
  vtkWeakPointer<vtkRenderWindow> Window;
  vtkWeakPointer<vtkOpenGLState> KeptState; // of the window, while progress is shown
  double ProgressInterval = 0.0;            // of the session before the frame; 0: not changed
  vtkNew<vtkFFDServerPass> Pass;
};

#endif
