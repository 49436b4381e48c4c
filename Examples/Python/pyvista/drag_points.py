# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shape a volume with the mouse; after each edit the lattice says whether it folds.

usage: drag_points.py [PICTURE.png]
"""

import os
import sys

import pyvista as pv
import vtkffd.pyvista  # noqa: F401

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../Testing/Data")


def report(lattice):
    folds = "no folds" if lattice.IsFoldFree() else "it may fold"
    print(f"moved at most {abs(lattice.displacements).max():.1f}, {folds}", flush=True)


head = pv.read(os.path.join(DATA, "headsq.vti"))
lattice = head.ffd.lattice(6)
plotter = pv.Plotter(window_size=(700, 650))
actor = plotter.add_deformed_volume(
    head, lattice, cmap="pink", clim=(500, 2000), opacity=[0.0, 0.5, 0.3, 0.6, 0.8, 1.0],
    shade=True, show_scalar_bar=False)
actor.prop.interpolation_type = "linear"
widget = plotter.add_lattice_widget(lattice, actor, report)

# What the mouse does can be done by script, too.
representation = widget.GetLatticeRepresentation()
representation.SelectPoint(3, 1, 2)
representation.GrowSelection()
representation.TranslateSelection(0.0, -45.0, 0.0)

plotter.camera_position = [(480, -680, 20), head.center, (0, 0, -1)]
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
