# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces and points that move along with the volume.

usage: move_surface.py [PICTURE.png]
"""

import os
import sys

import pyvista as pv
import vtkffd.pyvista  # noqa: F401

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../Testing/Data")

fuel = pv.read(os.path.join(DATA, "fuel.vti"))
lattice = fuel.ffd.lattice((9, 5, 5), "bend", 0.9)
surface = fuel.contour([140])
axis = pv.Line((2, 32, 32), (62, 32, 32), resolution=60).tube(radius=0.7)

plotter = pv.Plotter(shape=(1, 2), window_size=(1000, 480))
for column, deformation in enumerate((fuel.ffd.lattice(), lattice)):
    plotter.subplot(0, column)
    actor = plotter.add_deformed_volume(
        fuel, deformation, cmap="viridis", opacity=[0.0, 0.04, 0.06, 0.1, 0.1], show_scalar_bar=False)
    actor.prop.interpolation_type = "linear"
    plotter.add_mesh(surface.ffd.warp(deformation), color="orange", smooth_shading=True)
    plotter.add_mesh(axis.ffd.warp(deformation), color="white")
    plotter.set_background("black")
plotter.link_views()
plotter.camera_position = [(60, -85, 120), fuel.center, (0, 0, 1)]
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
