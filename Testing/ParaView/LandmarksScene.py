# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestLandmarks.py in ParaView's graphical client: a volume at rest in one view, and bent in the
other, as contours; a poly line for each, and the lattice that is fitted to them. Which line is placed
next goes to the file FFD_LANDMARKS_LOG, and then the fit, as lines of JSON."""

import ffdlog
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

simple.GetSettingsProxy("GeneralSettings").AutoApply = 1
wavelet = simple.Wavelet(WholeExtent=[-15, 15] * 3)
bent = simple.FFDLattice(Input=wavelet, Resolution=[4, 4, 4], Displacements=[3.0, -2.0, 4.0] * 64)
views = [simple.GetActiveViewOrCreate("RenderView")]
layout = simple.GetLayout(views[0])
views.append(simple.CreateView("RenderView"))
layout.SplitHorizontal(0, 0.5)
layout.AssignView(2, views[1])
lines, contours = [], []
for view, data in zip(views, (wavelet, bent)):
    view.UseFXAA = 0
    view.CameraPosition = [75.0, 45.0, 60.0]
    view.CameraFocalPoint = [0.0, 0.0, 0.0]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    contour = simple.Contour(Input=data, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
    simple.Show(contour, view)
    contours.append(contour)
    lines.append(simple.PolyLineSource(Points=[40.0, 0.0, 0.0, 0.0, 40.0, 0.0]))
    simple.Show(lines[-1], view)
    simple.Render(view)
fit = simple.FFDFitLattice(SourceLandmarks=lines[0], TargetLandmarks=lines[1], Volume=wavelet)
log = ffdlog.open_log("FFD_LANDMARKS_LOG")
state = {"line": -1, "next": 0}


def write(**line):
    log(line)


def distance(number, place):
    """From what the view shows: the contour, moved in the second one."""
    surface = contours[number].SMProxy.GetClientSideObject().GetOutputDataObject(0)
    rest = [place[i] - (0.0, 0.0, 0.0, 3.0, -2.0, 4.0)[3 * number + i] for i in range(3)]
    nearest = surface.GetPoint(surface.FindPoint(rest))
    return sum((a - b) ** 2 for a, b in zip(rest, nearest)) ** 0.5


def ask_for(number):
    """Make a line and its view the active ones, as a click in the pipeline browser and the view."""
    state["line"] = state["next"] = number
    simple.SetActiveView(views[number])
    simple.SetActiveSource(lines[number])
    for show in ("ShowInteractiveWidgets", "Show3DWidgets"):
        if hasattr(simple, show):
            getattr(simple, show)(lines[number])
            break
    simple.Render(views[number])
    # Told once the event loop has shown the line's widget.
    views[number].GetInteractor().CreateOneShotTimer(1)


def note(*_):
    """Go on where a line is complete."""
    number = state["line"]
    if state["next"] != number:
        return
    points = list(lines[number].Points)
    placed = (points[:3] != [40.0, 0.0, 0.0]) + (points[3:] != [0.0, 40.0, 0.0])
    if placed == 2:
        state["next"] = number + 1
    write(placed=placed)


def go_on(*_):
    """When the pointer moves, for ParaView is applying the points when it tells of them."""
    if state["next"] == 1 and state["line"] == 0:
        ask_for(1)
    elif state["next"] == 2 and state["line"] == 1:
        state["line"] = 2
        show_fit()


def show_fit():
    """The landmarks where the fitted lattice moves them to, with their residuals."""
    fit.UpdatePipeline()
    fit.UpdatePropertyInformation()
    simple.Hide(lines[1], views[1])
    landmarks = simple.Show(simple.OutputPort(fit, 1), views[1])
    simple.ColorBy(landmarks, ("POINTS", "Residual"))
    landmarks.SetScalarBarVisibility(views[1], True)
    landmarks.SetRepresentationType("Points")
    landmarks.PointSize = 14.0
    simple.GetDisplayProperties(contours[1], views[1]).Opacity = 0.3
    simple.Render(views[1])
    write(before=list(lines[0].Points), after=list(lines[1].Points),
          largest=fit.GetPropertyValue("LargestResidual"),
          distances=[distance(number, lines[number].Points[3 * i:3 * i + 3])
                     for number in (0, 1) for i in (0, 1)])


for view in views:
    view.GetInteractor().AddObserver("MouseMoveEvent", go_on)
    view.GetInteractor().AddObserver("LeftButtonReleaseEvent", lambda *_: write(clicked=state["line"]))
    view.GetInteractor().AddObserver("TimerEvent", lambda *_: write(asked=state["line"]))
for each in lines:
    each.SMProxy.AddObserver("UpdateDataEvent", note)
ask_for(0)
