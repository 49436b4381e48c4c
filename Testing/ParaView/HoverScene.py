# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: a volume that is moved by (3, -7, 11). What the
pointer rests on goes to the file FFD_HOVER_LOG, a line of JSON each."""

import ffdlog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

simple.GetSettingsProxy("GeneralSettings").AutoApply = 0
wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
lattice = simple.FFDLattice(Input=wavelet, Resolution=[4, 4, 4], Displacements=[3.0, -7.0, 11.0] * 64)
view = simple.GetActiveViewOrCreate("RenderView")
view.UseFXAA = 0
view.OrientationAxesVisibility = 0
view.CameraPosition = [78.0, 38.0, 71.0]
view.CameraFocalPoint = [3.0, -7.0, 11.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
display = simple.Show(lattice, view)
simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0,
                                                      180, 0.5, 0.5, 0, 280, 1, 0.5, 0]
simple.SetActiveSource(wavelet)
simple.Render(view)

log = ffdlog.open_log("FFD_HOVER_LOG")
picked = display.SMProxy.GetProperty("FFDSampleDistance").GetParent().GetProperty("FFDPicked")


def note(*_):
    """Write down what was found below the pointer."""
    log([picked.GetElement(i) for i in range(8)])


picked.AddObserver("ModifiedEvent", note)
