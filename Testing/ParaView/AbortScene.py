# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestAbort.py in ParaView's graphical client: a volume whose still frames take some seconds, and
with FFD_ABORT_ALL=1 the moving ones, too."""

import os

import ffdframelog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple
from paraview.vtk.vtkCommonCore import vtkUnsignedCharArray

DISTANCE = 0.06  # between samples, voxels

lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-130, 130] * 3), Shape="Twist")
view = simple.GetActiveViewOrCreate("RenderView")
display = simple.Show(lattice, view)
display.FFDNumberOfThreads = 1
display.FFDShade = 1
display.FFDImageSampleDistance = 0.5  # four rays a pixel
simple.GetOpacityTransferFunction("RTData").Points = [37, 0.001, 0.5, 0, 280, 0.002, 0.5, 0]
all_long = os.environ.get("FFD_ABORT_ALL") == "1"
if all_long:
    view.LODThreshold = 100000.0
view.ResetCamera()
display.FFDSampleDistance = 2.0 * DISTANCE
simple.Render(view)
# Another picture: one that is there already would be shown again, in no time.
display.FFDSampleDistance = DISTANCE
window = view.GetRenderWindow()


def describe():
    """The size of the frame and the color of its middle; reading that costs, where it does not matter."""
    if not all_long:
        return {}
    width, height = window.GetSize()
    values = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(width // 2, height // 2, width // 2, height // 2, 0, values)
    return {"size": [width, height], "color": [values.GetValue(i) for i in range(3)]}


log = ffdframelog.FrameLog(window, describe)
simple.Render(view)
swaps = []
window.AddObserver("StartEvent", lambda *_: swaps.append(bool(window.GetSwapBuffers())))
simple.SaveScreenshot(os.environ["FFD_ABORT_LOG"] + ".png", view)
ffdframelog.write("screenshot", swaps=any(swaps))
ffdframelog.write("ready")
