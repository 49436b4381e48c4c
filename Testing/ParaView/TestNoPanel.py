#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The plugin as it is built for servers, FFD_PARAVIEW_GUI=OFF: no Qt in it, and the representation
works.

The folder of the build is kept, so that it is brought up to date the next time. What is compiled as in the
main build is taken from there (reuse_objects.py), the rest is compiled without optimization.
"""

import os
import subprocess
import unittest

TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
SOURCE = os.environ["FFD_PARAVIEW_SOURCE"]
PARAVIEW = os.environ["FFD_PARAVIEW_DIR"]
PYTHON = os.environ["FFD_PYTHON"]
BUILD = os.environ["FFD_BUILD_DIR"]
REUSE = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "reuse_objects.py")

SCRIPT = """
from paraview import simple
lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-8, 8] * 3), Shape="Twist")
view = simple.CreateView("RenderView")
view.ViewSize = [100, 100]
display = simple.Show(lattice, view)
simple.Render(view)
lattice.UpdatePipeline()
libraries = sorted({line.split()[-1] for line in open("/proc/self/maps") if ".so" in line})
print("REPRESENTATION", display.Representation)
print("LIBRARIES", *(name for name in libraries if "FFD" in name or "Qt" in name))
"""


def run(*command, **environment):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            check=False, env={**os.environ, **environment})
    if result.returncode != 0:
        raise AssertionError("%s failed:\n%s" % (" ".join(command), result.stdout[-8000:]))
    return result.stdout


class TestNoPanel(unittest.TestCase):
    def test_build_and_load(self):
        build = os.path.join(TEMPORARY, "paraview-without-panel")
        # Set in the environment, where the list needs no quotes for CMake.
        launcher = ";".join([PYTHON, "-I", "-S", REUSE, build, os.path.join(BUILD, "paraview")])
        configured = run(
            "cmake", "-G", "Ninja", "-S", SOURCE, "-B", build, "-DFFD_PARAVIEW_GUI=OFF",
            "-DParaView_DIR=" + PARAVIEW, "-DPython3_EXECUTABLE=" + PYTHON,
            "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_INSTALL_LIBDIR=lib",
            "-DCMAKE_CXX_FLAGS_RELEASE=-O0",
            "-DFFD_KERNEL_OBJECTS=" + os.path.join(BUILD, "kernel-objects.cmake"),
            # Not to be found.
            "-DCMAKE_DISABLE_FIND_PACKAGE_Qt5=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_Qt6=ON",
            CMAKE_CXX_COMPILER_LAUNCHER=launcher)
        self.assertIn("Qt panel: OFF", configured)
        run("cmake", "--build", build, "--parallel", str(os.cpu_count()))
        plugin = os.path.join(build, "lib", os.path.basename(PARAVIEW), "plugins", "FFDVolume")
        for library in os.listdir(plugin):
            if library.endswith(".so"):
                self.assertNotRegex(run("ldd", os.path.join(plugin, library)), "Qt[56]", library)
        script = os.path.join(build, "load.py")
        with open(script, "w", encoding="ascii") as file:
            file.write(SCRIPT)
        output = run("pvbatch", script, PV_PLUGIN_PATH=plugin)
        self.assertIn("REPRESENTATION 'FFD Volume'", output)
        libraries = output[output.index("LIBRARIES"):].split()[1:]
        self.assertGreaterEqual(len(libraries), 5, libraries)
        for library in libraries:
            self.assertTrue(library.startswith(plugin), library)


if __name__ == "__main__":
    unittest.main()
