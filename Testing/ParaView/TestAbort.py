#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A long frame shows its progress in ParaView's window; the mouse, its wheel and keys abort it; one that
the user asked for is preceded by a coarse one. ParaView gets its input from outside, as from a user."""

import json
import os
import subprocess
import sys
import tempfile
import time
import unittest

from ffdparaview import PLUGIN, TEMPORARY

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "Python"))
import ffdinput  # noqa: E402

# Pixels of ParaView's window, which is in the upper left corner: a place of the view beside the
# volume, and the button that resets the camera.
BACKGROUND = (500, 300)
RESET_CAMERA = (781, 81)


class TestAbort(unittest.TestCase):
    def setUp(self):
        folder = tempfile.mkdtemp(prefix="abort.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        self.log = os.path.join(folder, "log")
        self.seen = 0
        self.process = subprocess.Popen(
            ["paraview", "--dr", "--script=" + os.path.join(HERE, "AbortScene.py")],
            env={**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder,
                 "PV_PLUGIN_PATH": os.path.dirname(PLUGIN), "FFD_ABORT_LOG": self.log})

    def tearDown(self):
        self.process.kill()
        self.process.wait()

    def next(self, event, seconds=200.0, **wanted):
        """The next line of the log of such an event, those before it are left out."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.assertIsNone(self.process.poll())
            if os.path.exists(self.log):
                with open(self.log, encoding="ascii") as file:
                    lines = file.read().split("\n")[:-1]
                while self.seen < len(lines):
                    line = json.loads(lines[self.seen])
                    self.seen += 1
                    if line["event"] == event and all(line[k] == wanted[k] for k in wanted):
                        return line
            time.sleep(0.02)
        self.fail("There was no %s with %s." % (event, wanted))

    def abort_by(self, act):
        """Act in the next still frame; it must end soon, and without a picture."""
        self.next("begin", still=True)
        time.sleep(0.2)
        now = time.monotonic()
        act()
        line = self.next("end", still=True)
        self.assertTrue(line["aborted"])
        self.assertLess(line["time"] - now, 0.5 * self.whole)

    def test_abort(self):
        begin = self.next("begin", still=True)
        end = self.next("end", still=True)
        self.whole = end["time"] - begin["time"]
        self.assertFalse(end["aborted"])
        self.assertGreaterEqual(end["progress"], 3)
        # A screenshot is not a coarse picture, whatever the user did before.
        self.assertFalse(self.next("screenshot")["swaps"])
        # What the window's first events bring about.
        self.next("ready")
        time.sleep(1.0)

        # A turn of the camera, and the still frame after it.
        ffdinput.move(*BACKGROUND)
        ffdinput.press(ffdinput.LEFT)
        self.next("begin", still=False)
        ffdinput.move(BACKGROUND[0] + 40, BACKGROUND[1] + 10)
        self.next("end", still=False)
        ffdinput.release(ffdinput.LEFT)
        self.abort_by(lambda: ffdinput.click(ffdinput.WHEEL_DOWN))
        self.abort_by(lambda: ffdinput.strike("Left"))
        # The button is held for a while: the frame is made when it is up.
        self.abort_by(lambda: ffdinput.press(ffdinput.LEFT))
        ffdinput.release(ffdinput.LEFT)
        self.next("end", still=True, aborted=False)

        # Not after a moving frame, but a still one.
        time.sleep(0.5)
        ffdinput.move(*RESET_CAMERA)
        ffdinput.click(ffdinput.LEFT)
        coarse = self.next("begin")
        self.assertFalse(coarse["still"])
        ffdinput.move(*BACKGROUND)
        self.abort_by(lambda: ffdinput.click(ffdinput.WHEEL_UP))
        self.next("end", still=True, aborted=False)


if __name__ == "__main__":
    unittest.main()
