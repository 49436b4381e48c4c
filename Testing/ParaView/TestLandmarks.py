#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pairs of landmarks, placed by pointer and keys in two views, fit a lattice; their residuals are shown.
ParaView gets its input from outside, as from a user."""

import json
import os
import subprocess
import sys
import tempfile
import time
import unittest

import ffdparaview as ffd

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "Python"))
import ffdinput  # noqa: E402

# Pixels of ParaView's window, which is in the upper left corner: two places on what each view shows.
PLACES = (((480, 440), (520, 480)), ((900, 400), (940, 440)))


class TestLandmarks(unittest.TestCase):
    def test_two_views(self):
        folder = tempfile.mkdtemp(prefix="landmarks.", dir=ffd.TEMPORARY)
        os.chmod(folder, 0o700)
        log = os.path.join(folder, "log")
        with open(os.path.join(folder, "output"), "w", encoding="utf-8") as output:
            paraview = subprocess.Popen(
                ["paraview", "--dr", "--script=" + os.path.join(HERE, "LandmarksScene.py")],
                stdout=output, stderr=subprocess.STDOUT,
                env={**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder,
                     "PV_PLUGIN_PATH": os.path.dirname(ffd.PLUGIN), "FFD_LANDMARKS_LOG": log})

        seen = 0

        def wait_for(word, value=None):
            """The next line of the log with that word, and value, if there is one."""
            nonlocal seen
            end = time.monotonic() + 1000.0
            while time.monotonic() < end:
                self.assertIsNone(paraview.poll())
                if os.path.exists(log):
                    with open(log, encoding="ascii") as file:
                        lines = file.read().split("\n")[:-1]
                    while seen < len(lines):
                        line = json.loads(lines[seen])
                        seen += 1
                        if word in line and value in (None, line[word]):
                            return line
                time.sleep(0.05)
            with open(os.path.join(folder, "output"), encoding="utf-8") as output:
                self.fail("There is no %s %s: %s" % (word, value, output.read()))

        try:
            for places in PLACES:
                wait_for("asked")
                for key, pixel in zip((1, 2), places):
                    # The view that is clicked has the keys.
                    ffdinput.move(*pixel)
                    ffdinput.click(ffdinput.LEFT)
                    wait_for("clicked")
                    ffdinput.strike(str(key))
                    wait_for("placed", key)
                ffdinput.move(*places[0])
            fitted = wait_for("distances")
        finally:
            paraview.kill()
            paraview.wait()
        # On what was seen: the second view shows the volume moved by (3, -2, 4).
        self.assertLess(max(fitted["distances"]), 1.0)
        self.assertLess(fitted["largest"], 0.1)
        self.assertNotEqual(fitted["before"], fitted["after"])


if __name__ == "__main__":
    unittest.main()
