// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "HasDisplay.h"

#include "vtkNew.h"
#include "vtkRenderWindow.h"

#ifdef EXAMPLE_HAS_X11
// Apart from the editor: the names of this header collide with others.
#include <X11/Xlib.h>
#endif

bool HasDisplay()
{
#ifdef EXAMPLE_HAS_X11
  vtkNew<vtkRenderWindow> window;
  if (window->IsA("vtkXOpenGLRenderWindow"))
  {
    Display* display = XOpenDisplay(nullptr);
    int opcode;
    int event;
    int error;
    const bool usable = display && XQueryExtension(display, "GLX", &opcode, &event, &error);
    if (display)
    {
      XCloseDisplay(display);
    }
    return usable;
  }
#endif
  return true;
}
