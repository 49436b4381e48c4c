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
    def test_script(self):
        folder = tempfile.mkdtemp(prefix="insitu.", dir=ffd.TEMPORARY)
        result = subprocess.run(
            ["pvbatch", "-m", "paraview.demos.wavelet_miniapp", "-t", "2", "--size", "31",
             "-s", SCRIPT],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, cwd=folder,
            env={**os.environ, "PV_PLUGIN_PATH": os.path.dirname(os.path.dirname(ffd.PLUGIN))})
        self.assertEqual(result.returncode, 0, result.stdout)
        pictures = sorted(glob.glob(os.path.join(folder, "**", "*.png"), recursive=True))
        self.assertEqual(len(pictures), 2, result.stdout)
        first, second = map(ffd.read_picture, pictures)
        self.assertEqual(first.shape, second.shape)
        self.assertGreater(ffd.lit(first, 100), 1000)
        # The simulation goes on, and the lattice with it.
        self.assertGreater(abs(first - second).mean(), 1.0)


if __name__ == "__main__":
    unittest.main()
