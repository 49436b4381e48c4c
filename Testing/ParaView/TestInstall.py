#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The installed plugin, moved elsewhere, is found by PV_PLUGIN_PATH and works, and goes on to where a script loads
that of the build, too."""

import glob
import os
import shutil
import subprocess
import tempfile
import unittest

PLUGIN = os.environ["FFD_PARAVIEW_PLUGIN"]
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
# .../lib/paraview-5.*/plugins/FFDVolume/FFDVolume.so in the build of the plugin.
BUILD = os.path.abspath(os.path.join(os.path.dirname(PLUGIN), *[os.pardir] * 4))

SCRIPT = """
import os
from paraview import servermanager, simple

def show():
    lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-10, 10] * 3), Shape="Twist")
    view = simple.CreateView("RenderView")
    display = simple.Show(lattice, view)
    simple.Render(view)
    return display

display = show()
libraries = sorted({line.split()[-1] for line in open("/proc/self/maps") if "FFD" in line})
print("REPRESENTATION", display.Representation)
print("LIBRARIES", *libraries)
simple.LoadPlugin(os.environ["FFD_PARAVIEW_PLUGIN"], remote=False)
print("TWICE", show().Representation)
simple.ResetSession()
print("RESET", show().Representation)
"""


class TestInstall(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="plugin.", dir=TEMPORARY)

    def tearDown(self):
        shutil.rmtree(self.folder)

    def test_found_by_path(self):
        prefix = os.path.join(self.folder, "prefix")
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], check=True,
                       stdout=subprocess.PIPE)
        moved = os.path.join(self.folder, "moved")
        os.rename(prefix, moved)
        found = glob.glob(os.path.join(moved, "**", "FFDVolume.so"), recursive=True)
        self.assertEqual(len(found), 1, found)
        self.assertRegex(found[0], r"/lib/paraview-5\.\d+/plugins/FFDVolume/FFDVolume\.so$")
        script = os.path.join(self.folder, "script.py")
        with open(script, "w", encoding="ascii") as file:
            file.write(SCRIPT)
        result = subprocess.run(
            ["pvbatch", script], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            check=False, env={**os.environ, "PV_PLUGIN_PATH": os.path.dirname(found[0])})
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("REPRESENTATION 'FFD Volume'", result.stdout)
        # A second file of the plugin, which ParaView would take for more properties of its own proxies.
        for when in ("TWICE", "RESET"):
            self.assertIn(when + " 'FFD Volume'", result.stdout)
        self.assertIn("nothing is taken from \"%s\"" % PLUGIN, result.stdout)
        self.assertNotIn("already exists", result.stdout)
        libraries = [line for line in result.stdout.splitlines()
                     if line.startswith("LIBRARIES")][0].split()[1:]
        self.assertGreaterEqual(len(libraries), 5, libraries)
        for library in libraries:
            # The build is not needed any more.
            self.assertTrue(library.startswith(moved), library)


if __name__ == "__main__":
    unittest.main()
