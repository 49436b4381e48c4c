# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestParallel.py with pvbatch --symmetric: several deformed volumes in one view. Arguments: the
prefix of the pictures."""

import sys

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdparaview as ffd

ffd.load()
view = ffd.make_view((160, 120))
small, large = ffd.make_wavelet(9), ffd.make_wavelet(13)
# Twisted, and moved to a place of its own.
lattices = []
for data, place in ((small, (-26.0, 20.0, 4.0)), (large, (0.0, 0.0, 0.0)), (small, (27.0, -17.0, 0.0))):
    twisted = simple.FFDLattice(Input=data, Shape="Twist", Strength=0.5, Resolution=[4, 4, 4])
    moved = simple.FFDLattice(Input=twisted, Displacements=[*place] * 64, Resolution=[4, 4, 4])
    simple.Show(moved, view)
    lattices.append(moved)
ball = simple.Sphere(Radius=5.0, Center=(12.0, 8.0, 9.0), ThetaResolution=24, PhiResolution=24)
simple.Show(ball, view).ColorArrayName = [None, ""]


def save(name, position, opaque=True):
    view.CameraPosition = position
    ffd.set_functions(opaque)
    simple.Render(view)
    simple.SaveScreenshot("%s.%s.png" % (sys.argv[1], name), view)


save("beside", [75.0, 75.0, 60.0])
save("translucent", [75.0, 75.0, 60.0], False)
# One before the other; from the other side in the opposite order.
save("inline", [-80.0, 58.0, 14.0])
save("opposite", [80.0, -58.0, 14.0])
view.CameraParallelProjection = 1
view.CameraParallelScale = 30.0
save("parallel", [-80.0, 58.0, 14.0])
view.CameraParallelProjection = 0
# An edit of one of them; one that is gone, and one that is placed by its representation.
lattices[1].DisplacementScale = 0.5
save("edited", [-80.0, 58.0, 14.0])
simple.Hide(lattices[1], view)
save("hidden", [-80.0, 58.0, 14.0])
simple.Show(lattices[1], view)
display = simple.GetDisplayProperties(lattices[0], view)
display.Scale = [1.2, 0.8, 1.0]
ffd.translate(display, [-5.0, 12.0, -6.0])
save("placed", [-80.0, 58.0, 14.0])
# The first process renders all, as boxes do not turn.
display.Orientation = [0.0, 0.0, 20.0]
save("turned", [-80.0, 58.0, 14.0])
