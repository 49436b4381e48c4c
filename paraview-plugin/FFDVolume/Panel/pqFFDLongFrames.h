// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDLongFrames_h
#define pqFFDLongFrames_h

#include <QList>
#include <QObject>
#include <QPointer>

#include <map>

class QTimer;
class pqServer;
class pqView;
class vtkObject;
class vtkRenderWindow;

/**
 * Shows a coarse picture before long still ones, and lets new input abort those.
 *
 * A still frame that the user asked for, as by Apply, and that FFD Volume expects to take longer
 * than 0.3 s, is made with the quality of moving ones first; the still one follows from the event
 * loop. Frames of scripts and screenshots are as they are asked to be. Of a server's frame the last
 * one tells how long it takes.
 *
 * ParaView renders in the thread that handles input, so input waits until a frame is there. FFD
 * Volume asks the render window now and then whether to go on, and the message with which a server
 * tells its progress asks the same; this class answers, from what the X server tells of the pointer
 * and the keyboard, on a connection of its own: no event is taken or handled before the frame is
 * over. A mouse button or the wheel in a view, be it another one, or a key other than a
 * modifier while ParaView has the keyboard, aborts the still frame, and the view goes on to show
 * the picture that it has. The still frame is made once nothing is pressed any more, of all views
 * that wait for one. Elsewhere than
 * under X nothing is aborted, and without the extension XInput 2 only by what is being held; nor
 * are frames of tiled displays.
 */
class pqFFDLongFrames : public QObject
{
  Q_OBJECT

public:
  pqFFDLongFrames(QObject* parent = nullptr);
  ~pqFFDLongFrames() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

  bool eventFilter(QObject* watched, QEvent* event) override;

private Q_SLOTS:
  void watch(pqView* view);
  void watchServer(pqServer* server);
  void prepareFrame(vtkObject* viewProxy, unsigned long, void* interactive);
  void beginFrame(vtkObject* window);
  void endFrame(vtkObject* window);
  void checkAbort(vtkObject* window);
  void checkServerAbort(vtkObject* progressHandler);
  void renderAgain();

private:
  Q_DISABLE_COPY(pqFFDLongFrames)

  enum class Kind
  {
    Moving,
    Coarse, ///< asked for as a still one
    Still
  };

  /// State of a window.
  struct Frames
  {
    Kind Last = Kind::Still; // the frame in progress, or the last one
    bool Coarse = false;     // the server makes a coarse one for the next
    double BeginTime = 0.0;
    double StillTime = 0.0; // of the last still one that was not aborted, seconds; 0: unknown
  };

  pqView* findView(vtkRenderWindow* window) const;
  bool mayBeCoarse(vtkRenderWindow* window) const;
  bool abortIfAsked(vtkRenderWindow* window);
  void finishLater(pqView* view, int milliseconds);
  void noteNewInput();
  bool hasInput();

  void* Display = nullptr; // a connection of its own to the X server
  int InputOpcode = 0;     // of XInput 2 there; 0: not available
  bool NewButton = false;  // pressed since the frame began
  bool NewKey = false;

  std::map<vtkRenderWindow*, Frames> Windows;
  vtkRenderWindow* Rendering = nullptr; // whose frame is in progress
  double StillRate = 0.0;
  bool Asked = false; // the user did something since the last still frame
  bool Final = false; // the frame is to be a still one
  QTimer* Again;
  QList<QPointer<pqView>> Unfinished; // show less than a still frame
};

#endif
