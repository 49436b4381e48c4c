#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the pointer is: what it rests on, and where the keys 1 and 2 put the ends of a ruler, is one place
of what is seen. ParaView gets its input from outside, as from a user: mouse and keys."""

import json
import os
import subprocess
import sys
import tempfile
import time
import unittest

import ffdparaview as ffd
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "Python"))
import ffdinput  # noqa: E402

# Pixels of ParaView's window, which is in the upper left corner: two of the volume or slice, one beside.
PLACES = ((800, 500), (760, 560))
BESIDE = (400, 650)


class TestPointer(unittest.TestCase):
    def setUp(self):
        folder = tempfile.mkdtemp(prefix="pointer.", dir=ffd.TEMPORARY)
        os.chmod(folder, 0o700)
        self.folder, self.log, self.seen, self.process = folder, os.path.join(folder, "log"), 0, None

    def tearDown(self):
        if self.process:
            self.process.kill()
            self.process.wait()

    def start(self, blend="Composite", sliced=""):
        self.process = subprocess.Popen(
            ["paraview", "--dr", "--script=" + os.path.join(HERE, "PointerScene.py")],
            env={**os.environ, "HOME": self.folder, "XDG_RUNTIME_DIR": self.folder,
                 "PV_PLUGIN_PATH": os.path.dirname(ffd.PLUGIN), "FFD_POINTER_LOG": self.log,
                 "FFD_POINTER_BLEND": blend, "FFD_POINTER_SLICE": sliced})
        self.next("ready")
        ffdinput.focus(ffdinput.find_window("ParaView 5"))

    def wait_until(self, find):
        """What it finds, unless that is false."""
        end = time.monotonic() + 1000.0
        while time.monotonic() < end:
            self.assertIsNone(self.process.poll())
            found = find()
            if found:
                return found
            time.sleep(0.05)
        return self.fail("That does not happen.")

    def next(self, event):
        """The values of the next line of the log of such an event, those before it are left out."""
        def find():
            if os.path.exists(self.log):
                with open(self.log, encoding="ascii") as file:
                    lines = file.read().split("\n")[:-1]
                while self.seen < len(lines):
                    line = json.loads(lines[self.seen])
                    self.seen += 1
                    if line["event"] == event:
                        return line
            return None

        return np.array(self.wait_until(find)["values"])

    def rest_on(self, place, event):
        """Let the pointer rest at a pixel; returns what is told of it."""
        ffdinput.move(*place)
        return self.next(event)

    def check_ruler(self, event):
        """Rests the pointer and strikes keys; returns the places of the pointer."""
        found = []
        for key, place in zip("12", PLACES):
            found.append(self.rest_on(place, event))
            self.assertEqual(found[-1][0], 1.0)
            ffdinput.strike(key)
            ends = self.next("ruler").reshape(2, 3)
            np.testing.assert_allclose(ends[int(key) - 1], found[-1][1:4], atol=1e-3)
        self.assertGreater(np.linalg.norm(found[0][1:4] - found[1][1:4]), 2.0)
        # Deformed, and not by the same vector.
        moves = [each[1:4] - each[4:7] for each in found]
        self.assertGreater(np.linalg.norm(moves[0]), 0.3)
        self.assertGreater(np.linalg.norm(moves[0] - moves[1]), 0.1)
        return found

    def test_volume(self):
        """The place where the volume has an opacity of 0.05, inside of it or on its face."""
        self.start()
        for found in self.check_ruler("hover"):
            self.assertTrue(abs(found[7] - 116.7) < 0.1 or
                            (found[7] > 116.7 and max(map(abs, found[4:7])) > 14.99), found)
        self.assertEqual(self.rest_on(BESIDE, "hover")[0], 0.0)

    def test_status_bar(self):
        """It tells what the pointer rests on, until the pointer leaves the view, and the window."""
        self.start()
        window = ffdinput.find_window("ParaView 5")
        width, height = 1100, 900
        ffdinput.resize(window, width, height)

        def is_empty():
            """Whether the bar is of one color."""
            pixels = ffdinput.read_pixels(window, 8, height - 18, width // 4, 10)
            return pixels == pixels[:4] * (len(pixels) // 4)

        self.rest_on(PLACES[0], "hover")
        self.wait_until(lambda: not is_empty())
        self.rest_on(BESIDE, "hover")
        self.wait_until(is_empty)
        self.rest_on(PLACES[0], "hover")
        self.wait_until(lambda: not is_empty())
        ffdinput.move(width + 100, height + 50)
        self.wait_until(is_empty)

    def test_blend_mode(self):
        """The place of the largest value, where the picture shows those."""
        self.start(blend="Maximum Intensity")
        for found in self.check_ruler("hover"):
            self.assertGreater(found[7], 130.0)
            self.assertLess(max(map(abs, found[4:7])), 14.9)

    def test_slice(self):
        """A slice of a bent volume: a tool tip, none beside it, and ruler ends on the slice."""
        self.check_slice("1")

    def test_moved_slice(self):
        """The same by FFD Deform Geometry, whose output has no lattice."""
        self.check_slice("moved")

    def check_slice(self, sliced):
        self.start(sliced=sliced)
        for key, place in zip("12", PLACES):
            ffdinput.move(*place)
            self.wait_until(lambda: ffdinput.count_popups() == 1)
            ffdinput.strike(key)
            end = self.next("ruler").reshape(2, 3)[int(key) - 1]
            # The bend leaves z as it is, in which the plane at rest is below this.
            self.assertLess(abs(end[2] - 2.0), 9.0)
            ffdinput.move(*BESIDE)
            self.wait_until(lambda: ffdinput.count_popups() == 0)


if __name__ == "__main__":
    unittest.main()
