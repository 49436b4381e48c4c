# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The deformed volume as an image of its own, for programs that need one, and its slices.

usage: export_image.py [PICTURE.png [IMAGE.vti]]
"""

import os
import sys

import pyvista as pv
import vtkffd.pyvista  # noqa: F401

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../Testing/Data")

head = pv.read(os.path.join(DATA, "headsq.vti"))
lattice = head.ffd.lattice(8, "bend", 1.2)
deformed = head.ffd.resample(lattice, spacing=(2.0, 2.0, 2.0), interpolation="cubic")
if len(sys.argv) > 2:
    deformed.save(sys.argv[2])

plotter = pv.Plotter(shape=(1, 2), window_size=(1000, 480))
for column, image in enumerate((head, deformed)):
    plotter.subplot(0, column)
    slices = image.slice("z", origin=(100.0, 100.0, 75.0))
    plotter.add_mesh(slices, cmap="gray", clim=(0, 2000), show_scalar_bar=False)
plotter.link_views()
plotter.camera_position = "xy"
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
