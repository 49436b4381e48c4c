// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDRenderAbort_h
#define pqFFDRenderAbort_h

#include <QObject>
#include <QPointer>

class QTimer;
class pqView;
class vtkObject;

/**
 * Lets new input abort long still frames of the views of this process.
 *
 * ParaView renders in the thread that handles input, so input waits until a frame is there. FFD
 * Volume asks the render window now and then whether to go on; this class answers, from what the X
 * server says of the pointer and the keyboard at that moment: no event is taken or handled before
 * the frame is over. A mouse button that is pressed in the view, or a key while ParaView has the
 * keyboard, aborts the frame, and the view goes on to show the picture that it has. The still frame
 * is made once nothing is pressed any more. Elsewhere than under X nothing is aborted.
 */
class pqFFDRenderAbort : public QObject
{
  Q_OBJECT

public:
  pqFFDRenderAbort(QObject* parent = nullptr);
  ~pqFFDRenderAbort() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

private Q_SLOTS:
  void watch(pqView* view);
  void checkAbort(vtkObject* window);
  void renderAgain();

private:
  Q_DISABLE_COPY(pqFFDRenderAbort)

  bool isPressed(pqView* view);

  void* Display = nullptr; // a connection of its own to the X server
  QTimer* Again;
  QPointer<pqView> Aborted;
};

#endif
