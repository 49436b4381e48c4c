# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: a volume that is selected, or with
FFD_FILES_SELECTED=contour a contour of it. When the client renders, FFD_FILES_LOG gets what the pipeline
is: a line of JSON."""

import json
import os

from paraview import simple

wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
view = simple.GetActiveViewOrCreate("RenderView")
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
simple.SetActiveSource(selected)
simple.Render(view)


def note(*_):
    """Write down what there is and what is shown."""
    with open(os.environ["FFD_FILES_LOG"], "w", encoding="ascii") as log:
        sources = simple.GetSources()
        json.dump({
            "sources": [source.SMProxy.GetXMLName() for source in sources.values()],
            "visible": [source.SMProxy.GetXMLName() for source in sources.values()
                        if simple.GetRepresentation(source, view).Visibility],
            "active": simple.GetActiveSource().SMProxy.GetXMLName(),
            "bounds": list(view.SMProxy.GetRenderer().ComputeVisiblePropBounds())}, log)


view.SMProxy.AddObserver("EndEvent", note)
