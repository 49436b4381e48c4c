// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDPendingInput.h"

#include "vtkRenderWindow.h"

#ifdef FFD_HAS_X11
#include <algorithm>
#include <vector>

#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace
{

struct PendingInput
{
  Window Place;
  bool HasButton = false;
  std::vector<XKeyEvent> Keys;
};

/// Notes what is in the queue and takes nothing out. It must not ask the server, as for keys'
/// names.
Bool RecordEvent(Display*, XEvent* event, XPointer data)
{
  auto* pending = reinterpret_cast<PendingInput*>(data);
  if (event->xany.window == pending->Place)
  {
    pending->HasButton = pending->HasButton || event->type == ButtonPress;
    if (event->type == KeyPress)
    {
      pending->Keys.push_back(event->xkey);
    }
  }
  return False;
}

} // namespace
#endif

//------------------------------------------------------------------------------
bool HasPendingInput(vtkRenderWindow* window)
{
#ifdef FFD_HAS_X11
  if (window->IsA("vtkXOpenGLRenderWindow"))
  {
    auto* display = static_cast<Display*>(window->GetGenericDisplayId());
    PendingInput pending;
    pending.Place = reinterpret_cast<Window>(window->GetGenericWindowId());
    if (!display || !pending.Place || !window->GetShowWindow())
    {
      return false;
    }
    XEvent none;
    XCheckIfEvent(display, &none, RecordEvent, reinterpret_cast<XPointer>(&pending));
    return pending.HasButton ||
      std::any_of(pending.Keys.begin(), pending.Keys.end(),
        [](XKeyEvent& key) { return !IsModifierKey(XLookupKeysym(&key, 0)); });
  }
#endif
  return window->GetEventPending() != 0;
}
