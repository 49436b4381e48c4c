// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDInteractiveFrames
 * @brief   shows a coarse picture before each long still one, and lets new input abort that
 *
 * For applications in which a user moves a scene with vtkFFDInverseRayVolumeMapper: give it the
 * interactor, and keep it for as long as the window is used. From then on, whoever calls
 * vtkRenderWindow::Render():
 *
 * - A still frame that its mappers expect to take longer than LongestWait is preceded by a coarse
 *   one, made as while the scene moves, unless the window shows that already. The still frame
 *   follows from the event loop of the interactor. Mappers with AutoAdjustSampleDistances off have
 *   no coarse frames and do not count, and before the interactor is initialized all frames are
 *   still ones.
 * - A mouse button, the wheel or a key aborts a still frame: within some 100 ms the event loop goes
 *   on with it, and the window goes on to show the coarse picture. The still frame is made when the
 *   interaction is over.
 * - The window's title tells how far a long still frame is (ShowProgressInTitle), and so does
 *   ProgressEvent with GetProgress(), for other ways to show it: what is in the window itself, like
 *   a vtkTextActor, changes with the next frame only.
 *
 * A frame is a still one when the desired update rate of the window is as vtkRenderWindowInteractor
 * has it when nothing moves: a second or more for each renderer. Input aborts frames by itself
 * under X11, keys but for modifiers alone included, and elsewhere as far as the window's
 * GetEventPending() knows of it; otherwise call Abort().
 *
 * Not for programs without an event loop, which would get coarse pictures: there each frame is to
 * be what it is asked to be. RenderStill() makes a still frame at once, for a screenshot by
 * vtkWindowToImageFilter, which is not to render itself (ShouldRerenderOff()). For a scaled one it
 * has to: SetInteractor(nullptr) before, and the interactor again after it.
 *
 * @sa
 * vtkFFDInverseRayVolumeMapper::GetExpectedStillTime vtkRenderWindow::CheckAbortStatus
 */
#ifndef vtkFFDInteractiveFrames_h
#define vtkFFDInteractiveFrames_h

#include "vtkFFDRenderingModule.h" // For export macro
#include "vtkObject.h"

#include <memory> // For std::unique_ptr

class vtkRenderWindow;
class vtkRenderWindowInteractor;

class VTKFFDRENDERING_EXPORT vtkFFDInteractiveFrames : public vtkObject
{
public:
  static vtkFFDInteractiveFrames* New();
  vtkTypeMacro(vtkFFDInteractiveFrames, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The interactor with the window to look after, which must have its window already; null: none.
   * Default: null. It is not kept alive.
   */
  void SetInteractor(vtkRenderWindowInteractor* interactor);
  vtkRenderWindowInteractor* GetInteractor();
  ///@}

  ///@{
  /**
   * Seconds that a still frame may take without a coarse one before it. The first frame, of which
   * nothing is known, counts as longer. Not negative. Default: 0.3.
   */
  void SetLongestWait(double seconds);
  vtkGetMacro(LongestWait, double);
  ///@}

  ///@{
  /**
   * Whether the window's title tells how far a still frame is, once that takes longer than
   * LongestWait; the title is as before when the frame ends. Default: on.
   */
  vtkSetMacro(ShowProgressInTitle, bool);
  vtkGetMacro(ShowProgressInTitle, bool);
  vtkBooleanMacro(ShowProgressInTitle, bool);
  ///@}

  /// Progress of the current still frame, 0 to 1; 1 when there is none.
  vtkGetMacro(Progress, double);

  /**
   * Seconds that the volumes in the window are expected to take in a still frame, of those that the
   * window shows, that have a vtkFFDInverseRayVolumeMapper, and that have coarse frames
   * (AutoAdjustSampleDistances): 0 if there is none or no window, VTK_DOUBLE_MAX if nothing is
   * known of one of them yet.
   */
  static double GetExpectedStillTime(vtkRenderWindow* window);

  /// Whether the window shows a coarse picture that a still one is to follow.
  bool IsStillFrameDue();

  /// Number of still frames that have been aborted.
  vtkGetMacro(NumberOfAbortedFrames, int);

  /// Abort the still frame in progress, if there is one; it is made again later.
  void Abort();

  /// Make a still frame now, as a whole.
  void RenderStill();

protected:
  vtkFFDInteractiveFrames();
  ~vtkFFDInteractiveFrames() override;

private:
  vtkFFDInteractiveFrames(const vtkFFDInteractiveFrames&) = delete;
  void operator=(const vtkFFDInteractiveFrames&) = delete;

  double LongestWait = 0.3;
  bool ShowProgressInTitle = true;
  double Progress = 1.0;
  int NumberOfAbortedFrames = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
