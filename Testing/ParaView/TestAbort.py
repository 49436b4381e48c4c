#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A long frame shows its progress in ParaView's window, and a mouse button aborts it."""

import json
import os
import subprocess
import tempfile
import unittest

from ffdparaview import PLUGIN, TEMPORARY


class TestAbort(unittest.TestCase):
    def test_abort(self):
        folder = tempfile.mkdtemp(prefix="abort.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        script = os.path.join(folder, "abort.xml")
        log = os.path.join(folder, "log")
        # Time for the interaction, and for the still frame after it.
        with open(script, "w", encoding="ascii") as file:
            file.write('<?xml version="1.0" ?>\n<pqevents>\n'
                       '<pqevent object="pqClientMainWindow" command="pause" arguments="8000"/>\n'
                       '</pqevents>\n')
        result = subprocess.run(
            ["paraview", "--dr", "--test-directory=" + folder, "--test-script=" + script,
             "--script=" + os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                        "AbortScene.py"), "--exit"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=240,
            env={**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder,
                 "PV_PLUGIN_PATH": os.path.dirname(PLUGIN), "FFD_ABORT_LOG": log})
        self.assertEqual(result.returncode, 0, result.stdout)
        with open(log, encoding="ascii") as file:
            whole, aborted, *later = [json.loads(line) for line in file]
        self.assertFalse(whole["aborted"])
        self.assertGreaterEqual(whole["progress"].count("FFD Volume"), 3)
        self.assertTrue(aborted["aborted"])
        self.assertLess(aborted["seconds"], 0.7 * whole["seconds"])
        # When the button is up the frame is made after all.
        self.assertFalse(later[-1]["aborted"])


if __name__ == "__main__":
    unittest.main()
