# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: a volume with a lattice, the control point (2, 2, 2)
in the middle of the view. FFD_DRAG_FRAMES is a file for the pixels of the last frame, as the window has
them, those of the last one while the mouse button was down, and the number of frames."""

import os

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

simple.GetSettingsProxy("GeneralSettings").AutoApply = 0
wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
lattice = simple.FFDLattice(Input=wavelet, Resolution=[5, 5, 5], Shape="Bend", Strength=0.3)
view = simple.GetActiveViewOrCreate("RenderView")
view.UseFXAA = 0
view.OrientationAxesVisibility = 0
view.CameraPosition = [75.0, 45.0, 60.0]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
simple.Show(lattice, view)
simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0,
                                                      180, 0.1, 0.5, 0, 280, 0.3, 0.5, 0]
simple.SetActiveSource(lattice)
simple.Render(view)
window = view.GetRenderWindow()
frames = [0]
pictures = {}


def note(*_):
    """Write down what the window shows."""
    frames[0] += 1
    width, height = window.GetActualSize()
    pixels = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, pixels)
    pictures["picture"] = vtk_to_numpy(pixels).reshape(height, width, 4)[::-1, :, :3]
    if window.GetDesiredUpdateRate() > 1.0:
        pictures["dragging"] = pictures["picture"]
    np.savez(os.environ["FFD_DRAG_FRAMES"], count=frames[0], **pictures)


window.AddObserver("EndEvent", note)
