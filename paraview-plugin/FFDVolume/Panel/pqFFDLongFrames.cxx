// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDLongFrames.h"

#include "pqFFDServerCheck.h"

#include "vtkFFDInteractiveFrames.h"
#include "vtkFFDServerFrames.h"
#include "vtkSMFFDVolumeRepresentationProxy.h"

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"
#include "pqView.h"

#include "vtkCommand.h"
#include "vtkPVProgressHandler.h"
#include "vtkRenderWindow.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSession.h"
#include "vtkTimerLog.h"

#include <QApplication>
#include <QEvent>
#include <QTimer>
#include <QWidget>

#include <algorithm>

#ifdef FFD_HAS_X11
#include <X11/XKBlib.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#ifdef FFD_HAS_XINPUT2
#include <X11/extensions/XInput2.h>
#endif
// Macros that are names of Qt's.
#undef None
#undef KeyPress
#undef Bool
#undef Status
#endif

namespace
{

/// Milliseconds from an abort to the still frame, and between looks whether the interaction is
/// over.
constexpr int AfterAbort = 100;

/// Milliseconds from a coarse picture, which is shown meanwhile, to the still one.
constexpr int AfterCoarse = 20;

/// Still frames are wanted at less than this rate.
constexpr double StillRateLimit = 1.0;

/// Rate of the coarse frames, as ParaView has it while the scene moves.
constexpr double CoarseRate = 5.0;

/// Seconds that a still frame may take without a coarse one before it.
constexpr double LongestWait = 0.3;

/// Let the server make coarse pictures of the volumes in the view next. False if there is none.
bool MakeServerCoarse(vtkSMViewProxy* view)
{
  bool any = false;
  vtkSMPropertyHelper all(view, "Representations");
  for (unsigned int i = 0; i < all.GetNumberOfElements(); ++i)
  {
    vtkSMProxy* each = all.GetAsProxy(i);
    vtkSMProperty* own = each ? each->GetProperty("FFDSampleDistance") : nullptr;
    auto* volume =
      vtkSMFFDVolumeRepresentationProxy::SafeDownCast(own ? own->GetParent() : nullptr);
    any = (volume && volume->RenderNextAtRate(CoarseRate)) || any;
  }
  return any;
}

#ifdef FFD_HAS_X11
bool IsModifier(::Display* display, unsigned int keycode)
{
  const KeySym key = XkbKeycodeToKeysym(display, static_cast<KeyCode>(keycode), 0, 0);
  return IsModifierKey(key);
}

/// Whether a place of the screen, in pixels of the device, is in a view.
bool IsInView(const QPoint& place)
{
  for (pqView* view : pqApplicationCore::instance()->getServerManagerModel()->findItems<pqView*>())
  {
    const QWidget* widget = view->widget();
    if (widget && widget->isVisible() &&
      widget->rect().contains(widget->mapFromGlobal(place / widget->devicePixelRatioF())))
    {
      return true;
    }
  }
  return false;
}
#endif

} // namespace

//------------------------------------------------------------------------------
pqFFDLongFrames::pqFFDLongFrames(QObject* parentObject)
  : QObject(parentObject)
  , Again(new QTimer(this))
{
  this->Again->setSingleShot(true);
  QObject::connect(this->Again, SIGNAL(timeout()), this, SLOT(renderAgain()));
}

//------------------------------------------------------------------------------
pqFFDLongFrames::~pqFFDLongFrames() { this->shutdown(); }

//------------------------------------------------------------------------------
void pqFFDLongFrames::startup()
{
  if (!pqApplicationCore::instance())
  {
    return;
  }
#ifdef FFD_HAS_X11
  if (QGuiApplication::platformName() == "xcb")
  {
    this->Display = XOpenDisplay(nullptr);
  }
#ifdef FFD_HAS_XINPUT2
  // Events of presses, not the state of the buttons: the wheel is never held.
  auto* display = static_cast<::Display*>(this->Display);
  int event;
  int error;
  int major = 2;
  int minor = 1; // from which on events come in spite of grabs
  if (display && XQueryExtension(display, "XInputExtension", &this->InputOpcode, &event, &error) &&
    XIQueryVersion(display, &major, &minor) == Success)
  {
    unsigned char bits[XIMaskLen(XI_LASTEVENT)] = {};
    XISetMask(bits, XI_RawButtonPress);
    XISetMask(bits, XI_RawKeyPress);
    XIEventMask mask;
    mask.deviceid = XIAllMasterDevices;
    mask.mask_len = sizeof(bits);
    mask.mask = bits;
    XISelectEvents(display, DefaultRootWindow(display), &mask, 1);
    XFlush(display);
  }
  else
  {
    this->InputOpcode = 0;
  }
#endif
#endif
  qApp->installEventFilter(this);
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, SIGNAL(viewAdded(pqView*)), this, SLOT(watch(pqView*)));
  for (pqView* view : model->findItems<pqView*>())
  {
    this->watch(view);
  }
  QObject::connect(model, SIGNAL(serverAdded(pqServer*)), this, SLOT(watchServer(pqServer*)));
  for (pqServer* server : model->findItems<pqServer*>())
  {
    this->watchServer(server);
  }
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::shutdown()
{
  this->Again->stop();
  if (qApp)
  {
    qApp->removeEventFilter(this);
  }
#ifdef FFD_HAS_X11
  if (this->Display)
  {
    XCloseDisplay(static_cast<::Display*>(this->Display));
  }
#endif
  this->Display = nullptr;
}

//------------------------------------------------------------------------------
bool pqFFDLongFrames::eventFilter(QObject* watched, QEvent* event)
{
  switch (event->type())
  {
    case QEvent::KeyPress:
    case QEvent::MouseButtonPress:
    case QEvent::MouseButtonRelease:
    case QEvent::Wheel:
      this->Asked = this->Asked || event->spontaneous();
      break;
    default:
      break;
  }
  return this->QObject::eventFilter(watched, event);
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::watch(pqView* view)
{
  auto* proxy = vtkSMRenderViewProxy::SafeDownCast(view->getViewProxy());
  if (vtkRenderWindow* window = proxy ? proxy->GetRenderWindow() : nullptr)
  {
    pqCoreUtilities::connect(
      proxy, vtkCommand::StartEvent, this, SLOT(prepareFrame(vtkObject*, unsigned long, void*)));
    pqCoreUtilities::connect(window, vtkCommand::StartEvent, this, SLOT(beginFrame(vtkObject*)));
    pqCoreUtilities::connect(window, vtkCommand::EndEvent, this, SLOT(endFrame(vtkObject*)));
    pqCoreUtilities::connect(
      window, vtkCommand::AbortCheckEvent, this, SLOT(checkAbort(vtkObject*)));
  }
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::watchServer(pqServer* server)
{
  vtkPVProgressHandler* handler = server->session()->GetProgressHandler();
  pqCoreUtilities::connect(
    handler, vtkCommand::ProgressEvent, this, SLOT(checkServerAbort(vtkObject*)));
}

//------------------------------------------------------------------------------
pqView* pqFFDLongFrames::findView(vtkRenderWindow* window) const
{
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  for (pqView* view : model->findItems<pqView*>())
  {
    auto* proxy = vtkSMRenderViewProxy::SafeDownCast(view->getViewProxy());
    if (proxy && proxy->GetRenderWindow() == window)
    {
      return view;
    }
  }
  return nullptr;
}

//------------------------------------------------------------------------------
/// Whether a coarse frame may come before a still one of the window.
bool pqFFDLongFrames::mayBeCoarse(vtkRenderWindow* window) const
{
  const auto found = this->Windows.find(window);
  const bool isShown = found != this->Windows.end() && found->second.Last != Kind::Still;
  // Screenshots are taken without swapping buffers.
  return this->Asked && !this->Final && !isShown && window->GetSwapBuffers();
}

//------------------------------------------------------------------------------
/// Before the server is asked for the frame.
void pqFFDLongFrames::prepareFrame(vtkObject* caller, unsigned long, void* interactive)
{
  auto* proxy = vtkSMRenderViewProxy::SafeDownCast(caller);
  vtkRenderWindow* window = proxy ? proxy->GetRenderWindow() : nullptr;
  if (!window || !ffdserver::HasRenderServer(proxy->GetSession()))
  {
    return;
  }
  const bool still = interactive && *static_cast<int*>(interactive) == 0;
  const bool mayBeCoarse = still && this->mayBeCoarse(window);
  Frames& frames = this->Windows[window];
  const bool isLong = !(frames.StillTime > 0.0) || frames.StillTime > LongestWait;
  frames.Coarse = mayBeCoarse && isLong && MakeServerCoarse(proxy);
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::beginFrame(vtkObject* caller)
{
  auto* window = vtkRenderWindow::SafeDownCast(caller);
  this->noteNewInput();
  this->NewButton = false;
  this->NewKey = false;
  pqView* view = this->findView(window);
  const bool isServers = view && ffdserver::HasRenderServer(view->getServer()->session());
  Kind kind = Kind::Still;
  if (window->GetDesiredUpdateRate() >= StillRateLimit)
  {
    kind = Kind::Moving;
  }
  else if (isServers ? this->Windows[window].Coarse
                     : this->mayBeCoarse(window) &&
        vtkFFDInteractiveFrames::GetExpectedStillTime(window) > LongestWait)
  {
    kind = Kind::Coarse;
    this->StillRate = window->GetDesiredUpdateRate();
    window->SetDesiredUpdateRate(CoarseRate);
  }
  Frames& frames = this->Windows[window];
  frames.Coarse = false;
  frames.Last = kind;
  frames.BeginTime = vtkTimerLog::GetUniversalTime();
  this->Rendering = window;
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::endFrame(vtkObject* caller)
{
  auto* window = vtkRenderWindow::SafeDownCast(caller);
  this->Rendering = nullptr;
  Frames& frames = this->Windows[window];
  if (frames.Last == Kind::Coarse)
  {
    window->SetDesiredUpdateRate(this->StillRate);
    this->finishLater(this->findView(window), AfterCoarse);
  }
  else if (frames.Last == Kind::Still && !window->GetAbortRender())
  {
    // The server shows what has not changed again: a short frame tells less of the next than a long
    // one, and nothing if the user has not asked for it.
    const double least = this->Asked ? 0.5 * frames.StillTime : frames.StillTime;
    frames.StillTime = std::max(least, vtkTimerLog::GetUniversalTime() - frames.BeginTime);
    this->Asked = false;
    this->Unfinished.removeAll(this->findView(window));
  }
}

//------------------------------------------------------------------------------
/// End the still frame in progress when there is input for its view.
bool pqFFDLongFrames::abortIfAsked(vtkRenderWindow* window)
{
  const auto found = this->Windows.find(window);
  pqView* view = this->findView(window);
  if (!this->Display || found == this->Windows.end() || found->second.Last != Kind::Still ||
    !view || !view->widget() || !view->widget()->isVisible() || !this->hasInput())
  {
    return false;
  }
  window->SetAbortRender(1);
  this->finishLater(view, AfterAbort);
  return true;
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::checkAbort(vtkObject* caller)
{
  this->abortIfAsked(vtkRenderWindow::SafeDownCast(caller));
}

//------------------------------------------------------------------------------
/// A message of progress has come: if the client waits for a picture, then from the server.
void pqFFDLongFrames::checkServerAbort(vtkObject* caller)
{
  vtkRenderWindow* window = this->Rendering;
  pqView* view = window ? this->findView(window) : nullptr;
  vtkSMSession* session = view ? view->getServer()->session() : nullptr;
  if (session && session->GetProgressHandler() == caller && ffdserver::HasRenderServer(session) &&
    !window->GetAbortRender() && this->abortIfAsked(window))
  {
    ffdserver::AskForAbort(session);
  }
}

//------------------------------------------------------------------------------
/// Read what was pressed since the last time.
void pqFFDLongFrames::noteNewInput()
{
#ifdef FFD_HAS_XINPUT2
  auto* display = static_cast<::Display*>(this->Display);
  while (display && this->InputOpcode != 0 && XPending(display) > 0)
  {
    XEvent event;
    XNextEvent(display, &event);
    if (event.type == GenericEvent && event.xcookie.extension == this->InputOpcode &&
      XGetEventData(display, &event.xcookie))
    {
      const auto* raw = static_cast<const XIRawEvent*>(event.xcookie.data);
      this->NewButton = this->NewButton || raw->evtype == XI_RawButtonPress;
      this->NewKey = this->NewKey ||
        (raw->evtype == XI_RawKeyPress &&
          !IsModifier(display, static_cast<unsigned int>(raw->detail)));
      XFreeEventData(display, &event.xcookie);
    }
  }
#endif
}

//------------------------------------------------------------------------------
/// Whether anything is or was pressed that is meant for a view.
bool pqFFDLongFrames::hasInput()
{
#ifdef FFD_HAS_X11
  auto* display = static_cast<::Display*>(this->Display);
  if (!display)
  {
    return false;
  }
  this->noteNewInput();
  Window root;
  Window child;
  int x;
  int y;
  int inWindow[2];
  unsigned int buttons = 0;
  if (XQueryPointer(display, DefaultRootWindow(display), &root, &child, &x, &y, &inWindow[0],
        &inWindow[1], &buttons) &&
    (this->NewButton ||
      (buttons & (Button1Mask | Button2Mask | Button3Mask | Button4Mask | Button5Mask)) != 0))
  {
    return IsInView(QPoint(x, y));
  }
  if (!QApplication::activeWindow())
  {
    return false;
  }
  if (this->NewKey)
  {
    return true;
  }
  char keys[32];
  XQueryKeymap(display, keys);
  for (unsigned int code = 0; code < 256; ++code)
  {
    if ((keys[code / 8] & (1 << code % 8)) != 0 && !IsModifier(display, code))
    {
      return true;
    }
  }
#endif
  return false;
}

//------------------------------------------------------------------------------
void pqFFDLongFrames::finishLater(pqView* view, int milliseconds)
{
  if (!this->Unfinished.contains(view))
  {
    this->Unfinished << view;
  }
  this->Again->start(milliseconds);
}

//------------------------------------------------------------------------------
/// Makes one still frame: input between those of several views is handled.
void pqFFDLongFrames::renderAgain()
{
  const auto isGone = [](const QPointer<pqView>& view) {
    return !view || pqFFDServerCheck::isLost(view->getServer()->session());
  };
  this->Unfinished.erase(std::remove_if(this->Unfinished.begin(), this->Unfinished.end(), isGone),
    this->Unfinished.end());
  if (this->Unfinished.isEmpty())
  {
    return;
  }
  this->noteNewInput();
  this->NewButton = false;
  this->NewKey = false;
  if (this->hasInput())
  {
    this->Again->start(AfterAbort);
    return;
  }
  const QPointer<pqView> view = this->Unfinished.takeFirst();
  this->Final = true;
  view->forceRender();
  this->Final = false;
  if (!this->Unfinished.isEmpty() && !this->Again->isActive())
  {
    this->Again->start(AfterCoarse);
  }
}
