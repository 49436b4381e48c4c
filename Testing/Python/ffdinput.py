# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Input as from a mouse and a keyboard, for tests that run under X: it comes to programs by their
connections to the X server (extension XTEST), not by calls. Windows are X's numbers of them."""

import contextlib
import ctypes
import time

LEFT, WHEEL_UP, WHEEL_DOWN = 1, 4, 5

_x11 = ctypes.CDLL("libX11.so.6")
_xtest = ctypes.CDLL("libXtst.so.6")
_x11.XOpenDisplay.restype = ctypes.c_void_p
_x11.XStringToKeysym.restype = ctypes.c_ulong
_x11.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
_x11.XKeysymToKeycode.restype = ctypes.c_ubyte
_x11.XDefaultRootWindow.restype = ctypes.c_ulong
_server = ctypes.c_void_p(_x11.XOpenDisplay(None))


class _Attributes(ctypes.Structure):
    """XWindowAttributes."""
    _fields_ = [(name, kind) for kind, names in (
        (ctypes.c_int, ("x", "y", "width", "height", "border_width", "depth")),
        (ctypes.c_void_p, ("visual",)), (ctypes.c_ulong, ("root",)),
        (ctypes.c_int, ("window_class", "bit_gravity", "win_gravity", "backing_store")),
        (ctypes.c_ulong, ("backing_planes", "backing_pixel")), (ctypes.c_int, ("save_under",)),
        (ctypes.c_ulong, ("colormap",)), (ctypes.c_int, ("map_installed", "map_state")),
        (ctypes.c_long, ("all_event_masks", "your_event_mask", "do_not_propagate_mask")),
        (ctypes.c_int, ("override_redirect",)), (ctypes.c_void_p, ("screen",))) for name in names]


def move(x, y):
    """Move the pointer to a pixel of the screen, from its upper left corner."""
    _xtest.XTestFakeMotionEvent(_server, -1, x, y, ctypes.c_ulong(0))
    _x11.XSync(_server, 0)


def move_in(window, x, y):
    """Move the pointer to a pixel of a window, from its upper left corner."""
    _x11.XWarpPointer(_server, ctypes.c_ulong(0), ctypes.c_ulong(window), 0, 0, 0, 0, x, y)
    _x11.XSync(_server, 0)


@contextlib.contextmanager
def _windows():
    """The windows of the screen. Meanwhile nobody else can destroy one: to ask X about a window that
    is gone would end this process."""
    root, parent, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_uint()
    windows = ctypes.POINTER(ctypes.c_ulong)()
    _x11.XGrabServer(_server)
    try:
        _x11.XQueryTree(_server, ctypes.c_ulong(_x11.XDefaultRootWindow(_server)),
                        ctypes.byref(root), ctypes.byref(parent), ctypes.byref(windows),
                        ctypes.byref(count))
        yield windows[:count.value]
    finally:
        _x11.XUngrabServer(_server)
        _x11.XSync(_server, 0)
        _x11.XFree(windows)


def find_window(title):
    """The window of the screen whose title begins so, or None; without a window manager."""
    found = None
    with _windows() as windows:
        for window in windows:
            name = ctypes.c_char_p()
            if (_x11.XFetchName(_server, ctypes.c_ulong(window), ctypes.byref(name)) and
                    name.value.startswith(title.encode())):
                found = window
            _x11.XFree(name)
    return found


def count_popups():
    """The menus and tool tips that are shown: windows of the screen that no window manager would move."""
    shown = 0
    with _windows() as windows:
        for window in windows:
            attributes = _Attributes()
            if _x11.XGetWindowAttributes(
                    _server, ctypes.c_ulong(window), ctypes.byref(attributes)):
                shown += attributes.map_state == 2 and attributes.override_redirect != 0
    return shown


def resize(window, width, height):
    """Change the size of a window, in pixels."""
    _x11.XResizeWindow(_server, ctypes.c_ulong(window), width, height)
    _x11.XSync(_server, 0)


def focus(window):
    """Let the window have what keys are pressed; it must be mapped."""
    _x11.XSetInputFocus(_server, ctypes.c_ulong(window), 1, ctypes.c_ulong(0))
    _x11.XSync(_server, 0)


class _Image(ctypes.Structure):
    """The first members of XImage."""
    _fields_ = [(name, kind) for kind, names in (
        (ctypes.c_int, ("width", "height", "xoffset", "format")), (ctypes.c_void_p, ("data",)),
        (ctypes.c_int, ("byte_order", "unit", "bit_order", "pad", "depth", "bytes_per_line")))
        for name in names]


def read_pixels(window, x, y, width, height):
    """The bytes of what a rectangle of a window shows, in X's layout."""
    _x11.XGetImage.restype = ctypes.POINTER(_Image)
    image = _x11.XGetImage(_server, ctypes.c_ulong(window), x, y, width, height,
                           ctypes.c_ulong(0xffffffff), 2)
    data = ctypes.string_at(image.contents.data, image.contents.bytes_per_line * height)
    _x11.XFree(ctypes.c_void_p(image.contents.data))
    _x11.XFree(image)
    return data


def press(button, down=True):
    _xtest.XTestFakeButtonEvent(_server, button, int(down), ctypes.c_ulong(0))
    _x11.XSync(_server, 0)


def release(button):
    press(button, False)


def click(button):
    press(button)
    release(button)


def press_key(symbol, down=True):
    """Press a key by its name, as 'Left' or 'Shift_L', or release it."""
    code = _x11.XKeysymToKeycode(_server, _x11.XStringToKeysym(symbol.encode()))
    _xtest.XTestFakeKeyEvent(_server, code, int(down), ctypes.c_ulong(0))
    _x11.XSync(_server, 0)


def strike(*symbols):
    """Press keys by their names one after the other, and release them in the opposite order:
    'Control_L', 'b'."""
    for symbol in symbols:
        press_key(symbol)
    for symbol in reversed(symbols):
        press_key(symbol, False)


def wait_for_press(display):
    """Wait until a button or key that was pressed is among the events of a connection of this process to X,
    a pointer as VTK's windows have it; all events stay there."""
    found = []

    def look(_display, event, _data):
        found.append(event.contents.value in (2, 4))  # KeyPress, ButtonPress
        return 0

    look = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int), ctypes.c_void_p)(look)
    event = ctypes.create_string_buffer(24 * ctypes.sizeof(ctypes.c_long))  # XEvent
    while not any(found):
        _x11.XCheckIfEvent(ctypes.c_void_p(display), event, look, None)
        time.sleep(0.001)
