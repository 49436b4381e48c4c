# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPointer.py in ParaView's graphical client: a bent volume, and a ruler, whose panel is shown. What
the pointer rests on and where the ruler ends goes to the file FFD_POINTER_LOG, a line of JSON each. With
FFD_POINTER_SLICE a slice of the volume is shown in its place, with FFD_POINTER_SLICE=moved by FFD Deform Geometry; FFD_POINTER_BLEND is a blend mode."""

import os

import ffdlog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

simple.GetSettingsProxy("GeneralSettings").AutoApply = 1
wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
lattice = simple.FFDLattice(Input=wavelet, Resolution=[6, 6, 6], Shape="Bend", Strength=0.9)
view = simple.GetActiveViewOrCreate("RenderView")
view.UseFXAA = 0
view.OrientationAxesVisibility = 0
view.CameraPosition = [75.0, 45.0, 60.0]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
display = simple.Show(lattice, view)
display.FFDBlendMode = os.environ["FFD_POINTER_BLEND"]
simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
# Visible from 100 on, and soon no more than a haze.
simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 100, 0, 0.5, 0,
                                                      200, 0.3, 0.5, 0, 280, 1, 0.5, 0]
picked = display.SMProxy.GetProperty("FFDSampleDistance").GetParent().GetProperty("FFDPicked")
if os.environ["FFD_POINTER_SLICE"]:
    simple.Hide(lattice, view)
    sliced = simple.Slice(Input=lattice, SliceType="Plane")
    sliced.SliceType.Origin = [0.0, 0.0, 2.0]
    sliced.SliceType.Normal = [0.2, 0.3, 1.0]
    shown = simple.FFDDeformGeometry(Input=sliced) if os.environ["FFD_POINTER_SLICE"] == "moved" else sliced
    simple.ColorBy(simple.Show(shown, view), ("POINTS", "RTData"))
    simple.HideInteractiveWidgets(proxy=sliced.SliceType)
ruler = simple.Ruler()
simple.Show(ruler, view)
simple.SetActiveSource(ruler)
simple.Render(view)

log = ffdlog.open_log("FFD_POINTER_LOG")


def note(event, values):
    log({"event": event, "values": values})


def note_hover(*_):
    note("hover", [picked.GetElement(i) for i in range(8)])


def note_ruler(*_):
    note("ruler", list(ruler.Point1) + list(ruler.Point2))


picked.AddObserver("ModifiedEvent", note_hover)
ruler.SMProxy.AddObserver("UpdateDataEvent", note_ruler)
# Once the event loop has shown all that.
interactor = view.GetInteractor()
interactor.AddObserver("TimerEvent", lambda *_: note("ready", []))
interactor.CreateOneShotTimer(1)
