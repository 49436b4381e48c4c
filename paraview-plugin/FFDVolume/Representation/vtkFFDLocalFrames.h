// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkFFDLocalFrames_h
#define vtkFFDLocalFrames_h

#include "vtkFFDParaViewModule.h" // For export macro

#include <memory> // for std::unique_ptr

class vtkProp;
class vtkSMViewProxy;

/**
 * Frames of a client while a widget is dragged, and nothing else of the picture changes: the server
 * is not asked for it again. What the server has rendered last is kept, with the widget where it
 * was then, and drawn again below the widget. Without a server, or where the client renders the
 * scene itself, frames are made as ever.
 */
class VTKFFDPARAVIEW_EXPORT vtkFFDLocalFrames
{
public:
  vtkFFDLocalFrames();
  ~vtkFFDLocalFrames();

  /// The view that is watched, null for none: its pictures are kept.
  void SetView(vtkSMViewProxy* view);

  ///@{
  /// Between the two, frames that the interactor of the view asks for are made here.
  void Begin(vtkProp* widget);
  void End();
  ///@}

  /// What the server shows is to change: the next frame is one of the server.
  void Forget();

private:
  vtkFFDLocalFrames(const vtkFFDLocalFrames&) = delete;
  void operator=(const vtkFFDLocalFrames&) = delete;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
