# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The example programs run, and their pictures show what they should."""

import glob
import os
import shutil
import subprocess
import sys
import unittest
from unittest import mock

import ffdvolumefiles
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BACKGROUND = np.array((26, 28, 33))


WINDOW = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
print(vtkRenderWindow().GetClassName())
"""


def start(name, *arguments):
    program = os.path.join(SOURCE, "Examples", "Python", name + ".py")
    return subprocess.run([sys.executable, program, *arguments], capture_output=True, text=True,
                          check=False)


def run(name, *arguments):
    output = os.path.join(os.environ["FFD_TEST_TEMPORARY"], name)
    shutil.rmtree(output, ignore_errors=True)
    return output, start(name, "--output", output, *arguments)


def read(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(
        height, width, -1)[..., :3].astype(int)


class TestExamples(unittest.TestCase):
    def test_falling_head(self):
        output, result = run("falling_head", "--seconds", "0.2", "--rate", "20", "--size", "120")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("5 frames", result.stdout)
        frames = [read(path) for path in sorted(glob.glob(os.path.join(output, "frame*.png")))]
        self.assertEqual(len(frames), 5)
        # Skin is red rather than blue, the floor is not; rows begin at the bottom.
        centers = [np.argwhere(frame[..., 0] > frame[..., 2] + 15)[:, 0].mean() for frame in frames]
        self.assertLess(centers[1], centers[0])
        self.assertLess(centers[3], centers[1] - 5)
        # From rest: the second half of the way is faster.
        self.assertGreater(centers[2] - centers[3], centers[0] - centers[1])

    def test_registration_viewer(self):
        output, result = run("registration_viewer", "--size", "120", "--fields", "4")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("Elastix", result.stdout)
        picture = read(os.path.join(output, "registration.png"))
        self.assertEqual(picture.shape, (240, 240, 3))
        after, checker = picture[:120, :120], picture[:120, 120:]
        fixed, before = picture[120:, :120], picture[120:, 120:]

        def shown(part):
            return np.abs(part - BACKGROUND).max(axis=-1) > 20

        for part in (after, fixed, before):
            self.assertGreater(shown(part).mean(), 0.05)
        # Fields of either, and the moving head lies on the fixed one only after the registration.
        np.testing.assert_array_equal(checker[:30, :30], fixed[:30, :30])
        np.testing.assert_array_equal(checker[:30, 30:60], after[:30, 30:60])
        outside_before = (shown(before) & ~shown(fixed)).sum() / shown(before).sum()
        outside_after = (shown(after) & ~shown(fixed)).sum() / shown(after).sum()
        self.assertLess(outside_after, 0.5 * outside_before)

    def test_registration_viewer_reads_what_it_names(self):
        path = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "example_body")
        ffdvolumefiles.write_nrrd(path + ".nrrd", "right-anterior-superior")
        ffdvolumefiles.write_nifti(path + ".nii.gz", "sform")
        output, result = run("registration_viewer", "--fixed", path + ".nrrd", "--moving",
                             path + ".nii.gz", "--thresholds", "300", "300", "--size", "60")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        # Before the registration the two lie on each other, but for their colors.
        picture = read(os.path.join(output, "registration.png"))
        shown = np.abs(picture - BACKGROUND).max(axis=-1) > 20
        self.assertGreater(shown[60:, :60].mean(), 0.05)
        self.assertLess((shown[60:, :60] != shown[60:, 60:]).mean(), 0.03)

    def test_without_a_display(self):
        """VTK's wheels render without one; a window on the screen needs it everywhere."""
        environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
        renders = "vtkXOpenGLRenderWindow" not in subprocess.run(
            [sys.executable, "-c", WINDOW], env=environment, stdout=subprocess.PIPE, text=True,
            stderr=subprocess.DEVNULL, check=True).stdout
        for name, *arguments in (("deform_surface",), ("falling_head",), ("paper_figures",),
                                 ("render_deformed",),
                                 ("registration_viewer", "--interactive", "--size", "50")):
            for display in (None, ":977"):
                with self.subTest((name, display)), mock.patch.dict(os.environ):
                    os.environ.pop("DISPLAY", None)
                    if display:
                        os.environ["DISPLAY"] = display
                    _, result = run(name, *arguments)
                    if renders and "--interactive" not in arguments:
                        self.assertEqual(result.returncode, 0, result.stderr)
                        continue
                    self.assertEqual(result.returncode, 1)
                    self.assertIn(name + ": no window can be opened", result.stderr)
                    if not renders:
                        self.assertEqual(len(result.stderr.splitlines()), 1)

    def test_errors_are_told(self):
        for arguments, text in ((("--transform", "/no/such/file"), "/no/such/file"),
                                (("--fixed", "/no/such.vti"), "/no/such.vti")):
            _, result = run("registration_viewer", *arguments)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(text, result.stderr)
        file = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "no_folder")
        with open(file, "w", encoding="ascii"):
            pass
        for name, option, *values in (
                ("falling_head", "--rate", "0"), ("falling_head", "--seconds", "-1"),
                ("falling_head", "--seconds", "nan"), ("falling_head", "--stiffness", "-5"),
                ("falling_head", "--size", "0"), ("animate_lattice", "--size", "100000"),
                ("deform_surface", "--size", "-4"), ("deform_surface", "--strength", "nan"),
                ("paper_figures", "--size", "0"), ("registration_viewer", "--fields", "0"),
                ("registration_viewer", "--thresholds", "nan", "4"),
                ("lattice_editor", "--lattice", "no_such.vti", "--screenshot", "a.png"),
                ("lattice_editor", "--screenshot", "a.jpg")):
            with self.subTest((name, option)):
                result = start(name, option, *values)
                self.assertNotEqual(result.returncode, 0)
                self.assertNotIn("Traceback", result.stderr)
                self.assertIn(option[2:], result.stderr.splitlines()[-1])
        for name in ("animate_lattice", "deform_surface", "paper_figures", "falling_head"):
            with self.subTest(name):
                result = start(name, "--output", os.path.join(file, "within"))
                self.assertNotEqual(result.returncode, 0)
                self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
                self.assertIn("no_folder", result.stderr)


if __name__ == "__main__":
    unittest.main()
