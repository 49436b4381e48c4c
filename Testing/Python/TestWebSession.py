# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is behind the page of the web editor, without a browser: sizes of pictures and places of the mouse,
and what the panel does to the lattice. Skipped where trame is neither installed nor to be had."""

import os
import sys
import unittest

import ffdpackages

PACKAGES = ffdpackages.require("trame_rca.widgets.rca", ffdpackages.TRAME)

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.path.join(SOURCE, "Examples", "Python", "web_editor.py")
VOLUME = os.path.join(os.environ["FFD_TEST_DATA"], "fuel.vti")
sys.path.insert(0, os.path.dirname(PROGRAM))

import numpy as np  # noqa: E402
import web_editor  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkCoordinate  # noqa: E402


class TestSession(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.session = web_editor.Session(VOLUME, 4 << 20)  # trame has one server for a process

    def mouse(self, kind, x, y):
        self.session.window.process_interaction_event({"type": kind, "x": x, "y": y})

    def place(self, i, j, k):
        """Where a control point at rest is in the picture."""
        point, place = [0.0, 0.0, 0.0], vtkCoordinate()
        self.session.lattice.GetRestPoint(i, j, k, point)
        place.SetCoordinateSystemToWorld()
        place.SetValue(point)
        return place.GetComputedDoubleDisplayValue(self.session.renderer)

    def displacements(self):
        return np.array(vtk_to_numpy(self.session.lattice.GetDisplacements()))

    def test_pictures_keep_the_shape_of_the_view(self):
        window, interactor = self.session.window, self.session.window.interactor
        for view, picture in (((800, 600), (800, 600)), ((3000, 1400), (2048, 956)),
                              ((1400, 4096), (700, 2048)), ((2048, 2048), (2048, 2048)),
                              ((10**9, 10**9), (2048, 2048)), ((3, 3), (16, 16))):
            with self.subTest(view):
                window.process_resize_event(*view)
                self.assertEqual(tuple(window.window.GetSize()), picture)
        # The mouse is where the page shows it.
        window.process_resize_event(4096, 2800)
        self.mouse("MouseMove", 3000, 1000)
        self.assertEqual(tuple(interactor.GetEventPosition()), (1500, 500))
        x, y = self.place(2, 0, 3)
        self.mouse("MouseMove", 2.0 * x, 2.0 * y)
        self.mouse("LeftButtonPress", 2.0 * x, 2.0 * y)
        self.mouse("MouseMove", 2.0 * x, 2.0 * y + 100)
        self.mouse("LeftButtonRelease", 2.0 * x, 2.0 * y + 100)
        moved = self.displacements()
        self.assertEqual(np.flatnonzero(np.abs(moved).max(axis=1)).tolist(), [2 + 6 * 6 * 3])
        window.process_resize_event(800, 600)
        self.mouse("MouseMove", 300, 100)
        self.assertEqual(tuple(interactor.GetEventPosition()), (300, 100))
        self.session.undo()
        self.assertEqual(np.abs(self.displacements()).max(), 0.0)


if __name__ == "__main__":
    unittest.main()
