# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestAbort.py in ParaView's graphical client: a volume in two views side by side, whose still frames
take some second each. How frames begin and end goes to the file FFD_ABORT_LOG as lines of JSON."""

import time

import ffdlog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

FRAME = 1.5  # seconds of a processor: what other processes take must not make frames shorter
SHORTEST = 0.05  # of the distances between samples that the representation takes, voxels

log = ffdlog.open_log("FFD_ABORT_LOG")


def write(**line):
    log({"time": time.monotonic(), **line})


lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-90, 90] * 3), Shape="Twist")
left = simple.GetActiveViewOrCreate("RenderView")
layout = simple.GetLayout(left)
layout.SplitHorizontal(layout.GetViewLocation(left), 0.5)
right = simple.CreateView("RenderView")
simple.AssignViewToLayout(view=right, layout=layout)
views = (left, right)
displays = [simple.Show(lattice, view) for view in views]
simple.GetOpacityTransferFunction("RTData").Points = [37, 0.001, 0.5, 0, 280, 0.002, 0.5, 0]
for view, display in zip(views, displays):
    display.FFDNumberOfThreads = 1
    display.FFDShade = 1
    # Not by ResetCamera(): the layout may not have its sizes yet, and one view's frames be far shorter.
    view.CameraPosition = [0.0, 0.0, 600.0]
    view.CameraFocalPoint = [0.0, 0.0, 0.0]
    simple.Render(view)
start = time.process_time()
displays[0].FFDSampleDistance = 0.5
simple.Render(left)
distance = max(SHORTEST, 0.5 * (time.process_time() - start) / FRAME)
for view, display in zip(views, displays):
    display.FFDSampleDistance = distance
    simple.Render(view)


def observe(number, window):
    def note(event):
        return lambda *_: write(event=event, view=number, still=window.GetDesiredUpdateRate() < 1.0,
                                aborted=bool(window.GetAbortRender()))

    # After the plugin's observers at the beginning, before them at the end.
    window.AddObserver("StartEvent", note("begin"), -1.0)
    window.AddObserver("EndEvent", note("end"), 1.0)


for i, view in enumerate(views):
    observe(i, view.GetRenderWindow())
simple.SetActiveSource(lattice)


def edit(*_):
    lattice.Strength = 0.5 if lattice.Strength > 0.55 else 0.6
    for each in views:
        simple.Render(each)


left.GetRenderWindow().GetInteractor().AddObserver("EnterEvent", edit)
write(event="ready")
