# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestAbort.py in ParaView's graphical client: a volume whose still frames take some two seconds,
or as long as with the sample distance FFD_ABORT_DISTANCE, and with FFD_ABORT_ALL=1 the moving ones, too.
The distance, and how frames begin and end, go to the file FFD_ABORT_LOG as lines of JSON."""

import os
import time

import ffdlog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import servermanager, simple
from paraview.vtk.vtkCommonCore import vtkUnsignedCharArray

FRAME = 2.0  # seconds of a processor: what other processes take must not make frames shorter
SHORTEST = 0.05  # of the distances between samples that the representation takes, voxels

log = ffdlog.open_log("FFD_ABORT_LOG")


def write(**line):
    log({"time": time.monotonic(), **line})


lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-130, 130] * 3), Shape="Twist")
view = simple.GetActiveViewOrCreate("RenderView")
display = simple.Show(lattice, view)
display.FFDNumberOfThreads = 1
display.FFDShade = 1
simple.GetOpacityTransferFunction("RTData").Points = [37, 0.001, 0.5, 0, 280, 0.002, 0.5, 0]
all_long = os.environ.get("FFD_ABORT_ALL") == "1"
if all_long:
    view.LODThreshold = 100000.0
view.ResetCamera()
distance = float(os.environ.get("FFD_ABORT_DISTANCE", "0.5"))


def render_other():
    """Another picture: one that is there already would be shown again, in no time."""
    display.FFDSampleDistance = 2.0 * distance
    simple.Render(view)
    display.FFDSampleDistance = distance


render_other()
if "FFD_ABORT_DISTANCE" not in os.environ:
    # A server's processor time is not known here.
    remote = servermanager.ActiveConnection.IsRemote()
    clock = time.monotonic if remote else time.process_time
    start = clock()
    simple.Render(view)
    distance = max(SHORTEST, distance * (clock() - start) / FRAME)
    render_other()
write(event="scene", distance=distance)

handler = servermanager.ActiveConnection.Session.GetProgressHandler()
window = view.GetRenderWindow()
progress = []
handler.AddObserver("ProgressEvent", lambda *_: progress.append(handler.GetLastProgressText()))


def begin(*_):
    # Still frames are wanted at less than one a second.
    write(event="begin", still=window.GetDesiredUpdateRate() < 1.0)
    progress.clear()


def find_color():
    """Of the middle of the frame; None where that does not matter."""
    if not all_long:
        return None
    width, height = window.GetSize()
    values = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(width // 2, height // 2, width // 2, height // 2, 0, values)
    return [values.GetValue(i) for i in range(3)]


def end(*_):
    write(event="end", still=window.GetDesiredUpdateRate() < 1.0,
          aborted=bool(window.GetAbortRender()), progress=progress.count("FFD Volume"),
          size=list(window.GetSize()), color=find_color())


# After the plugin's observers at the beginning, before them at the end.
window.AddObserver("StartEvent", begin, -1.0)
window.AddObserver("EndEvent", end, 1.0)
simple.Render(view)
swaps = []
window.AddObserver("StartEvent", lambda *_: swaps.append(bool(window.GetSwapBuffers())))
simple.SaveScreenshot(os.environ["FFD_ABORT_LOG"] + ".png", view)
write(event="screenshot", swaps=any(swaps))
write(event="ready")
