# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: a volume that is selected, or what FFD_FILES_SELECTED
says: a contour of it, beside a file that does not exist, or the volume while another server is the active
one, at the port FFD_FILES_PORT (elsewhere). When the view of the volume is rendered, FFD_FILES_LOG gets what
the pipeline is: a line of JSON."""

import json
import os

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
view = simple.GetActiveViewOrCreate("RenderView")
view.UseFXAA = 0
view.OrientationAxesVisibility = 0
view.CameraPosition = [75.0, 45.0, 60.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
simple.Show(wavelet, view).SetRepresentationType("Outline")
simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0,
                                                      180, 0.1, 0.5, 0, 280, 0.3, 0.5, 0]
selected = wavelet
if os.environ["FFD_FILES_SELECTED"] == "contour":
    selected = simple.Contour(Input=wavelet, Isosurfaces=[150.0])
    simple.Show(selected, view)
    simple.LegacyVTKReader(registrationName="Gone", FileNames=[os.environ["FFD_FILES_LOG"] + ".vtk"])
simple.SetActiveSource(selected)
simple.Render(view)
if os.environ["FFD_FILES_SELECTED"] == "elsewhere":
    simple.Connect("localhost", int(os.environ["FFD_FILES_PORT"]))


def shows(source):
    display = simple.GetRepresentation(source, view)
    return bool(display and display.Visibility)


def note(*_):
    """Write down what there is and what is shown."""
    with open(os.environ["FFD_FILES_LOG"], "w", encoding="ascii") as log:
        sources = simple.GetSources()
        active = simple.GetActiveSource()
        json.dump({
            "sources": [source.SMProxy.GetXMLName() for source in sources.values()],
            "visible": [source.SMProxy.GetXMLName() for source in sources.values()
                        if shows(source)],
            "active": active.SMProxy.GetXMLName() if active else None,
            "bounds": list(view.SMProxy.GetRenderer().ComputeVisiblePropBounds())}, log)


view.SMProxy.AddObserver("EndEvent", note)
