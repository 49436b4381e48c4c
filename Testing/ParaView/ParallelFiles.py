# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestParallel.py with pvbatch --symmetric: transforms in time, volumes in time, and a fit to
landmarks. Arguments: the prefix of the pictures, and files of volumes in time."""

import os
import sys

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdparaview as ffd

ffd.load()
view = ffd.make_view((120, 100))
wavelet = ffd.make_wavelet(15)
scene = simple.GetAnimationScene()


def show(name, data, times=(0.0,)):
    display = simple.Show(data, view)
    display.SetRepresentationType("FFD Volume")
    # Named: a client of its own, as each process is here, does not see the array of the first one.
    simple.ColorBy(display, ("POINTS", "RTData"))
    ffd.set_functions()
    for time in times:
        scene.AnimationTime = time
        view.ViewTime = time
        simple.Render(view)
        simple.SaveScreenshot("%s.%s %g.png" % (sys.argv[1], name, time), view)
    simple.Hide(data, view)


reader = simple.FFDTransformReader(
    FileNames=[os.path.join(ffd.DATA, "Transforms", "elastix5_stack.txt")])
show("stack", simple.FFDApplyTransform(Input=wavelet, Transform=reader), (1.0, 1.25, 2.5))

BEFORE = [-8, -8, -8, 8, -8, 0, 0, 9, 3, 2, 3, 9, -5, 4, -7, 6, 6, 6]
AFTER = [-6, -9, -8, 9, -5, 1, 1, 6, 5, 3, 5, 6, -8, 4, -4, 6, 9, 6]
fit = simple.FFDFitLattice(SourceLandmarks=simple.PolyLineSource(Points=BEFORE),
                           TargetLandmarks=simple.PolyLineSource(Points=AFTER), Volume=wavelet)
show("fit", simple.FFDApplyTransform(Input=wavelet, Transform=simple.OutputPort(fit, 0)))
volumes = simple.FFDVolumeReader(FileNames=sys.argv[2:], Interpolation="Linear")
show("volumes", simple.FFDLattice(Input=volumes, Shape="Twist"), (0.0, 0.5, 1.0))
