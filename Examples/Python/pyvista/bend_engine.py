# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A volume at rest and deformed, the lattice from numpy.

usage: bend_engine.py [PICTURE.png]
"""

import os
import sys

import numpy as np
import pyvista as pv
import vtkffd.pyvista  # noqa: F401

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../Testing/Data")
LOOK = {"cmap": "gray", "clim": (60, 255), "opacity": [0.0, 0.3, 0.5, 0.8], "shade": True}

engine = pv.read(os.path.join(DATA, "engine.vti"))
lattice = engine.ffd.lattice(8)

# Control points as numpy arrays of shape (8, 8, 8, 3): the middle of the block is lifted.
x, y, _ = np.moveaxis(lattice.rest_points - engine.center, -1, 0)
lattice.displacements[..., 2] = 70.0 * np.exp(-(x * x + y * y) / 80.0**2)

plotter = pv.Plotter(shape=(1, 2), window_size=(1000, 450))
for column, deformation in enumerate((None, lattice)):
    plotter.subplot(0, column)
    actor = plotter.add_deformed_volume(engine, deformation, show_scalar_bar=False, **LOOK)
    actor.prop.interpolation_type = "linear"
    if deformation is lattice:
        plotter.add_mesh(lattice.net(), style="wireframe", color="steelblue", opacity=0.3)
plotter.link_views()
plotter.subplot(0, 0)
plotter.camera_position = [(560, -480, 390), (128, 128, 85), (0, 0, 1)]
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
