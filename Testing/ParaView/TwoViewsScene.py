# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestAbort.py in ParaView's graphical client: a volume in two views side by side, whose still frames
take some second each."""

import ffdframelog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

DISTANCE = 0.1  # between samples, voxels

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
    display.FFDSampleDistance = DISTANCE
    simple.Render(view)
logs = [ffdframelog.FrameLog(view.GetRenderWindow(), view=i) for i, view in enumerate(views)]
simple.SetActiveSource(lattice)


def edit(*_):
    lattice.Strength = 0.5 if lattice.Strength > 0.55 else 0.6
    for each in views:
        simple.Render(each)


left.GetRenderWindow().GetInteractor().AddObserver("EnterEvent", edit)
ffdframelog.write("ready")
