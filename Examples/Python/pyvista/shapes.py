# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ready shapes of a lattice, and its arguments in add_volume's words.

usage: shapes.py [PICTURE.png]
"""

import os
import sys

import pyvista as pv
import vtkffd.pyvista  # noqa: F401

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../Testing/Data")

engine = pv.read(os.path.join(DATA, "engine.vti"))
plotter = pv.Plotter(shape=(2, 2), window_size=(900, 800))
for index, shape in enumerate(("bend", "twist", "taper", "bulge")):
    plotter.subplot(index // 2, index % 2)
    actor = plotter.add_deformed_volume(
        engine, engine.ffd.lattice(8, shape, 0.8), cmap="copper", clim=(70, 255),
        opacity="sigmoid_8", show_scalar_bar=index == 3, scalar_bar_args={"title": "density"})
    actor.prop.interpolation_type = "linear"
    plotter.add_text(shape, font_size=12)
plotter.link_views()
plotter.camera_position = [(430, -350, 300), engine.center, (0, 0, 1)]
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
