#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Catalyst: the script of the documentation renders a deformed volume while ParaView's example of a
simulation runs."""

import glob
import os
import subprocess
import tempfile
import unittest

import ffdparaview as ffd

SOURCE = os.path.dirname(os.environ["FFD_PARAVIEW_SOURCE"])
SCRIPT = os.path.join(SOURCE, "Examples", "Python", "paraview_in_situ.py")


class TestInSitu(unittest.TestCase):
    def run_simulation(self, *command):
        """The pictures of two steps of the simulation, run by these processes."""
        folder = tempfile.mkdtemp(prefix="insitu.", dir=ffd.TEMPORARY)
        result = subprocess.run(
            [*command, "-m", "paraview.demos.wavelet_miniapp", "-t", "2", "--size", "31", "-s", SCRIPT],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, cwd=folder,
            env={**os.environ, "PV_PLUGIN_PATH": os.path.dirname(os.path.dirname(ffd.PLUGIN))})
        self.assertEqual(result.returncode, 0, result.stdout)
        pictures = sorted(glob.glob(os.path.join(folder, "**", "*.png"), recursive=True))
        self.assertEqual(len(pictures), 2, result.stdout)
        return [ffd.read_picture(picture) for picture in pictures]

    def test_script(self):
        first, second = self.run_simulation("pvbatch")
        self.assertEqual(first.shape, (400, 400, 3))
        self.assertEqual(first.shape, second.shape)
        self.assertGreater(ffd.lit(first, 100), 1000)
        # The simulation goes on, and the lattice with it.
        self.assertGreater(abs(first - second).mean(), 1.0)
        # Two processes make the same pictures, but for the opacity unit distance, which ParaView picks by the
        # data of each.
        for one, two in zip((first, second), self.run_simulation("mpiexec", "-np", "2", "pvbatch", "--symmetric")):
            self.assertEqual(one.shape, two.shape)
            self.assertLess(abs(one - two).mean(), 4.0)


if __name__ == "__main__":
    unittest.main()
