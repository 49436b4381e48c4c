// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDRenderAbort.h"

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqServerManagerModel.h"
#include "pqView.h"

#include "vtkCommand.h"
#include "vtkRenderWindow.h"
#include "vtkSMRenderViewProxy.h"

#include <QApplication>
#include <QTimer>
#include <QWidget>

#include <algorithm>

#ifdef FFD_HAS_X11
#include <X11/keysym.h>
#include <X11/Xlib.h>
// Macros that are names of Qt's.
#undef None
#undef KeyPress
#undef Bool
#undef Status
#endif

namespace
{

/// Milliseconds between looks whether the interaction that aborted a frame is over.
constexpr int Interval = 100;

/// Still frames are wanted at less than this rate.
constexpr double StillRate = 1.0;

} // namespace

//------------------------------------------------------------------------------
pqFFDRenderAbort::pqFFDRenderAbort(QObject* parentObject)
  : QObject(parentObject)
  , Again(new QTimer(this))
{
  this->Again->setInterval(Interval);
  QObject::connect(this->Again, SIGNAL(timeout()), this, SLOT(renderAgain()));
}

//------------------------------------------------------------------------------
pqFFDRenderAbort::~pqFFDRenderAbort() { this->shutdown(); }

//------------------------------------------------------------------------------
void pqFFDRenderAbort::startup()
{
#ifdef FFD_HAS_X11
  if (QGuiApplication::platformName() == "xcb")
  {
    this->Display = XOpenDisplay(nullptr);
  }
#endif
  if (!this->Display || !pqApplicationCore::instance())
  {
    return;
  }
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, SIGNAL(viewAdded(pqView*)), this, SLOT(watch(pqView*)));
  for (pqView* view : model->findItems<pqView*>())
  {
    this->watch(view);
  }
}

//------------------------------------------------------------------------------
void pqFFDRenderAbort::shutdown()
{
  this->Again->stop();
#ifdef FFD_HAS_X11
  if (this->Display)
  {
    XCloseDisplay(static_cast<::Display*>(this->Display));
  }
#endif
  this->Display = nullptr;
}

//------------------------------------------------------------------------------
void pqFFDRenderAbort::watch(pqView* view)
{
  auto* proxy = vtkSMRenderViewProxy::SafeDownCast(view->getViewProxy());
  if (vtkRenderWindow* window = proxy ? proxy->GetRenderWindow() : nullptr)
  {
    pqCoreUtilities::connect(
      window, vtkCommand::AbortCheckEvent, this, SLOT(checkAbort(vtkObject*)));
  }
}

//------------------------------------------------------------------------------
void pqFFDRenderAbort::checkAbort(vtkObject* caller)
{
  auto* window = vtkRenderWindow::SafeDownCast(caller);
  if (!this->Display || !window || window->GetDesiredUpdateRate() >= StillRate)
  {
    return;
  }
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  for (pqView* view : model->findItems<pqView*>())
  {
    auto* proxy = vtkSMRenderViewProxy::SafeDownCast(view->getViewProxy());
    if (proxy && proxy->GetRenderWindow() == window && this->isPressed(view))
    {
      window->SetAbortRender(1);
      this->Aborted = view;
      this->Again->start();
    }
  }
}

//------------------------------------------------------------------------------
bool pqFFDRenderAbort::isPressed(pqView* view)
{
#ifdef FFD_HAS_X11
  auto* display = static_cast<::Display*>(this->Display);
  QWidget* widget = view->widget();
  if (!display || !widget || !widget->isVisible())
  {
    return false;
  }
  Window root;
  Window child;
  int x;
  int y;
  int inWindow[2];
  unsigned int buttons = 0;
  if (XQueryPointer(display, DefaultRootWindow(display), &root, &child, &x, &y, &inWindow[0],
        &inWindow[1], &buttons) &&
    (buttons & (Button1Mask | Button2Mask | Button3Mask | Button4Mask | Button5Mask)) != 0)
  {
    const QPoint place = QPoint(x, y) / widget->devicePixelRatioF();
    return widget->rect().contains(widget->mapFromGlobal(place));
  }
  if (!QApplication::activeWindow())
  {
    return false;
  }
  char keys[32];
  XQueryKeymap(display, keys);
  for (const KeySym modifier : { XK_Shift_L, XK_Shift_R, XK_Control_L, XK_Control_R, XK_Alt_L,
         XK_Alt_R, XK_Meta_L, XK_Meta_R, XK_Super_L, XK_Super_R, XK_Caps_Lock, XK_Num_Lock })
  {
    const unsigned int code = XKeysymToKeycode(display, modifier);
    keys[code / 8] = static_cast<char>(keys[code / 8] & ~(1 << code % 8));
  }
  return std::any_of(keys, keys + sizeof(keys), [](char bits) { return bits != 0; });
#else
  (void)view;
  return false;
#endif
}

//------------------------------------------------------------------------------
void pqFFDRenderAbort::renderAgain()
{
  if (this->Aborted && this->isPressed(this->Aborted))
  {
    return;
  }
  this->Again->stop();
  if (this->Aborted)
  {
    this->Aborted->render();
  }
  this->Aborted = nullptr;
}
