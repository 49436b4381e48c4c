# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: a scene, and a log of what the filter is
told. From the environment: FFD_PANEL_LOG, a line of JSON for each update of the filter,
FFD_PANEL_TRACE, the Python trace so far, FFD_PANEL_STEP, the pixels from ray to ray, FFD_PANEL_BLOCKS,
whether the volume is two blocks with a lattice each, with edits that do not say what resolution they are meant
for, and FFD_PANEL_FXAA, whether edges are smoothed."""

import json
import os

import ffdlog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple, smtrace
from paraview.servermanager import vtkSMTrace

settings = simple.GetSettingsProxy("GeneralSettings")
settings.AutoApply = int(os.environ["FFD_PANEL_AUTO_APPLY"])
wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
per_block = int(os.environ["FFD_PANEL_BLOCKS"])
if per_block:
    wavelet = simple.GroupDatasets(Input=[
        simple.ExtractSubset(Input=wavelet, VOI=[*x, -15, 15, -15, 15]) for x in ((-15, 0), (0, 15))])
lattice = simple.FFDLattice(Input=wavelet, Resolution=[5, 5, 5], LatticePerBlock=per_block,
                            Displacements=[0.0, 0.0, 1.0] * 125 * per_block)
view = simple.GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [0.0, 0.0, 0.0]
view.OrientationAxesVisibility = 0
# Smoothing of edges takes longer than all the rest of a frame.
view.UseFXAA = int(os.environ["FFD_PANEL_FXAA"])
shown = simple.Show(lattice, view)
shown.FFDImageSampleDistance = float(os.environ["FFD_PANEL_STEP"])
simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0,
                                                      180, 0.1, 0.5, 0, 280, 0.3, 0.5, 0]
# The control point in the middle, (2, 2, 2), is in the middle of the view.
view.CameraPosition = [75.0, 45.0, 60.0]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
simple.SetActiveSource(lattice)
simple.Render(view)

smtrace.start_trace()
WIDGET = ("HandleMode", "Falloff", "ProportionalRadius", "LockBoundary", "FoldGuard",
          "InteriorVisibility", "LineMode", "DisplacementScale")


def describe_widget():
    """Options of the lattice widget in the view, as the representation that draws it prints them;
    it is not among the sources, and its class is not known to Python."""
    shown = view.SMProxy.GetProperty("HiddenRepresentations")
    for proxy in map(shown.GetProxy, range(shown.GetNumberOfProxies())):
        if proxy.GetXMLName() == "FFDLatticeWidgetRepresentation":
            widget = proxy.GetClientSideObject()
            values = dict(line.strip().partition(": ")[::2]
                          for line in str(widget.GetRepresentation()).splitlines())
            return {"Visible": widget.GetWidget().GetEnabled(),
                    "OutlineBounds": json.loads("[%s]" % values["OutlineBounds"]),
                    **{name: float(values[name]) for name in WIDGET}}
    return {}


def count_volumes():
    """Volumes in the view whose voxels are in this process."""
    volumes = view.SMProxy.GetRenderer().GetVolumes()
    mappers = [volumes.GetItemAsObject(i).GetMapper()
               for i in range(volumes.GetNumberOfItems())]
    return sum(mapper is not None and mapper.GetInputDataObject(0, 0) is not None
               for mapper in mappers)


log = ffdlog.open_log("FFD_PANEL_LOG")
seen = {}  # the widget in the last frame


def note(*_):
    """Write down what the filter has."""
    log({
        "resolution": list(lattice.Resolution),
        "displacements_resolution": list(lattice.DisplacementsResolution),
        "displacements": list(lattice.Displacements),
        "widget": describe_widget(), "seen": seen, "volumes": count_volumes()})
    with open(os.environ["FFD_PANEL_TRACE"], "w", encoding="utf-8") as trace:
        trace.write(vtkSMTrace.GetActiveTracer().GetCurrentTrace())


def act_as_script(*_):
    """Where the displacement scale has become 0.25."""
    if lattice.DisplacementScale == 0.25 and lattice.Resolution[0] == 5:
        lattice.Resolution = [7, 5, 5]


def replace_edits(*_):
    """By a script, where the opacity has become 0.5; the edits have another resolution than the lattice."""
    if shown.Opacity == 0.5:
        lattice.Displacements = [1.0] * 3 * 5 * 5 * 5


lattice.SMProxy.AddObserver("UpdateDataEvent", note)
lattice.SMProxy.AddObserver("UpdateDataEvent", act_as_script)
shown.SMProxy.GetProperty("Opacity").AddObserver("ModifiedEvent", replace_edits)
view.GetRenderWindow().AddObserver("EndEvent", lambda *_: seen.update(describe_widget()))
