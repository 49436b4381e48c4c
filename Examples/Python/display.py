# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the examples can open windows. VTK ends the program where X or GLX is missing, in
off-screen windows too, so they ask before."""

import ctypes
import os
import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkRenderingCore import vtkRenderWindow

# What VTK's wheels render in where there is no display.
OFF_SCREEN = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")


def has_display(on_screen=False):
    """Whether VTK can open a window: on screen, or else on screen or off."""
    name = vtkRenderWindow().GetClassName()
    if name != "vtkXOpenGLRenderWindow":
        return not on_screen or name not in OFF_SCREEN
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return bool(os.environ.get("DISPLAY"))
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    if not display:
        return False
    numbers = [ctypes.byref(ctypes.c_int()) for _ in range(3)]
    has_glx = bool(x11.XQueryExtension(display, b"GLX", *numbers))
    x11.XCloseDisplay(display)
    return has_glx


def no_display():
    """What is wrong, in words for the user."""
    return ("no window can be opened: there is no usable X display with GLX (DISPLAY is %s). "
            "Log in to a desktop, or start the program with xvfb-run."
            % (repr(os.environ["DISPLAY"]) if os.environ.get("DISPLAY") else "not set"))


def require_display(program, on_screen=False):
    """End the program with a line that says so where no window can be opened."""
    if not has_display(on_screen):
        sys.exit("%s: %s" % (program, no_display()))
