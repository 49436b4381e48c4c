# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestAbort.py in ParaView's graphical client: a mouse button is pressed during a long frame.
From the environment: FFD_ABORT_LOG, lines of JSON."""

import ctypes
import json
import os
import threading
import time

from paraview import servermanager, simple

lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-60, 60] * 3), Shape="Twist")
view = simple.GetActiveViewOrCreate("RenderView")
display = simple.Show(lattice, view)
display.FFDNumberOfThreads = 1
display.FFDShade = 1
display.FFDSampleDistance = 0.1
simple.GetOpacityTransferFunction("RTData").Points = [37, 0.001, 0.5, 0, 280, 0.002, 0.5, 0]
view.ResetCamera()
simple.Render(view)

log = open(os.environ["FFD_ABORT_LOG"], "w", encoding="ascii")  # open until the end
handler = servermanager.ActiveConnection.Session.GetProgressHandler()
progress = []
handler.AddObserver("ProgressEvent", lambda *_: progress.append(handler.GetLastProgressText()))
begin = 0.0


def note(*_):
    """Write down how a frame ended."""
    log.write(json.dumps({"seconds": time.monotonic() - begin, "progress": progress,
                          "aborted": view.GetRenderWindow().GetAbortRender()}) + "\n")
    log.flush()
    progress.clear()


x11 = ctypes.CDLL("libX11.so.6")
xtest = ctypes.CDLL("libXtst.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
server = ctypes.c_void_p(x11.XOpenDisplay(None))


def press():
    """The left button, in the view, for a while."""
    time.sleep(0.3)
    xtest.XTestFakeMotionEvent(server, -1, *middle, 0)
    xtest.XTestFakeButtonEvent(server, 1, 1, 0)
    x11.XFlush(server)
    time.sleep(1.0)
    xtest.XTestFakeButtonEvent(server, 1, 0, 0)
    x11.XFlush(server)


middle = (700, 400)  # of a screen of 1280 x 1024 that ParaView fills
view.SMProxy.AddObserver("EndEvent", note)
for frame in range(2):
    if frame == 1:
        threading.Thread(target=press).start()
    begin = time.monotonic()
    simple.Render(view)
