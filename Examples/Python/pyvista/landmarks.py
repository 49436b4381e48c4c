# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A deformation by landmarks: any VTK transform takes the place of a lattice.

usage: landmarks.py [PICTURE.png]
"""

import os
import sys

import numpy as np
import pyvista as pv
import vtkffd.pyvista  # noqa: F401
from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../Testing/Data")

engine = pv.read(os.path.join(DATA, "engine.vti"))
corners = np.array(engine.outline().points)
top = np.array(engine.center) + (0.0, 0.0, 48.0)
source = np.vstack((corners, top))
target = source.copy()
target[-1] += (0.0, 0.0, 70.0)  # the middle of the top is lifted, the corners hold still

transform = vtkThinPlateSplineTransform()
transform.SetBasisToR()
transform.SetSourceLandmarks(pv.PolyData(source).GetPoints())
transform.SetTargetLandmarks(pv.PolyData(target).GetPoints())

plotter = pv.Plotter(window_size=(700, 600))
actor = plotter.add_deformed_volume(
    engine, transform, position_tolerance=0.5, cmap="copper", clim=(60, 255),
    opacity=[0.0, 0.1, 0.3, 0.9], shade=True, scalar_bar_args={"title": "density"})
actor.prop.interpolation_type = "linear"
plotter.add_points(target, color="red", point_size=12, render_points_as_spheres=True)
plotter.add_mesh(pv.Line(source[-1], target[-1]), color="red", line_width=4)
plotter.camera_position = [(560, -460, 260), engine.center, (0, 0, 1)]
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
