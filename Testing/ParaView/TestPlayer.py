#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A series is played in ParaView's window: each frame is rendered, and the filters in toolbars are enabled or
disabled once the player stops, not for each frame."""

import argparse
import os
import sys
import tempfile
import unittest

import ffdparaview as ffd

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Benchmarks"))
import paraview_player  # noqa: E402
import paraview_series  # noqa: E402


class TestPlayer(unittest.TestCase):
    def test_passes(self):
        folder = tempfile.mkdtemp(prefix="player.", dir=ffd.TEMPORARY)
        os.chmod(folder, 0o700)
        options = argparse.Namespace(size=24, phases=3, frames=3, passes=2, quality=0.5, pixels=[200, 160],
                                     no_fxaa=False, show="volume")
        options.volumes, options.transforms = paraview_series.make_series(folder, options.phases, options.size)
        events = paraview_player.run(options, folder)
        names = [event["event"] for event in events]
        # Before the first pass the filters may or may not have been tried for the last change of the scene.
        self.assertEqual(names[names.index("pass"):], ["pass", "menus", "pass", "menus"])
        for event in events:
            if event["event"] == "pass":
                self.assertEqual(event["frames"], 7)
                self.assertGreater(event["rendering"], 0.0)
                self.assertEqual(event["menus"], 0)


if __name__ == "__main__":
    unittest.main()
