# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The examples of the filters run, and write pictures that show something."""

import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

EXAMPLES = os.path.join(
    os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))),
    "Examples", "Python")


def read(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[..., :3] * 1.0


def covered(picture):
    """Part of the picture that is not background, which is the lower left corner."""
    return np.mean(np.abs(picture - picture[0, 0]).max(axis=2) > 20)


def count(picture, color):
    """Pixels of about a color."""
    return np.sum(np.abs(picture - 255.0 * np.array(color)).max(axis=2) < 50)


class TestFilterExamples(unittest.TestCase):
    def run_example(self, name, *arguments):
        folder = tempfile.mkdtemp(dir=os.environ.get("FFD_TEST_TEMPORARY"))
        run = subprocess.run(
            [sys.executable, os.path.join(EXAMPLES, name), "--output", folder, *arguments],
            capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertNotIn("ERR|", run.stderr)
        return folder

    def test_animation(self):
        folder = self.run_example("animate_lattice.py", "--frames", "5", "--size", "120")
        frames = [read(os.path.join(folder, "animation", "frame_%04d.png" % i)) for i in range(5)]
        for frame in frames:
            self.assertEqual(frame.shape, (120, 120, 3))
            self.assertGreater(covered(frame), 0.1)
        # The first and the last keyframe are the same, the others are not.
        np.testing.assert_array_equal(frames[0], frames[4])
        for a, b in ((0, 1), (1, 2), (2, 3)):
            self.assertGreater(np.abs(frames[a] - frames[b]).mean(), 2.0)

    def test_surface_and_volume(self):
        folder = self.run_example("deform_surface.py", "--size", "200")
        picture = read(os.path.join(folder, "surface.png"))
        self.assertEqual(picture.shape, (200, 400, 3))
        rest, deformed = picture[:, :200], picture[:, 200:]
        for half in (rest, deformed):
            self.assertGreater(covered(half), 0.1)
            # Landmarks, blue: the surface moved with the volume, or they would be inside or gone.
            self.assertGreater(np.sum(half[..., 2] > half[..., 0] + 60), 20)
        self.assertGreater(np.abs(rest - deformed).mean(), 3.0)

    def test_figures_of_the_paper(self):
        folder = self.run_example("paper_figures.py", "--size", "256")
        green, orange, red = (0.3, 0.85, 0.35), (1.0, 0.6, 0.1), (0.95, 0.3, 0.25)
        figure2 = read(os.path.join(folder, "figure2.png"))
        self.assertEqual(count(figure2[:, :256], green), 0)
        self.assertGreater(count(figure2[:, 256:], green), 300)
        figure3 = read(os.path.join(folder, "figure3.png"))
        self.assertGreater(count(figure3, red), 50)
        self.assertGreater(count(figure3, green), 50)
        figure4 = read(os.path.join(folder, "figure4.png"))
        self.assertGreater(count(figure4, orange), 10)


if __name__ == "__main__":
    unittest.main()
