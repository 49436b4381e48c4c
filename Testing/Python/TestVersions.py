#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Beside a VTK that it was not built for, the package says so before it loads anything."""

import os
import subprocess
import sys
import tempfile
import unittest

import vtkmodules

IMPORT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "ffdimport.py")


def import_beside(version):
    """What "import vtkffd" says where the VTK that comes first claims to be of this version, and the
    libraries of VTK that are loaded then."""
    with tempfile.TemporaryDirectory(dir=os.environ["FFD_TEST_TEMPORARY"]) as folder:
        package = os.path.join(folder, "vtkmodules")
        os.mkdir(package)
        with open(os.path.join(package, "__init__.py"), "w", encoding="ascii") as file:
            # All else is that of the VTK that is there, its functions as its modules.
            file.write('exec(open(%r).read())\n__version__ = "%s"\n__path__ = __path__ + %r\n' % (
                vtkmodules.__file__, version, list(vtkmodules.__path__)))
        path = os.pathsep.join([folder, os.environ["PYTHONPATH"]])
        output = subprocess.run([sys.executable, IMPORT], env={**os.environ, "PYTHONPATH": path},
                                stdout=subprocess.PIPE, text=True, check=True).stdout
    said, libraries = output.split("LIBRARIES")
    return said, libraries.split()


class TestVersions(unittest.TestCase):
    def test_another_vtk_is_refused_by_name(self):
        major, minor, *_ = vtkmodules.__version__.split(".")
        for version in ("%d.%s.0" % (int(major) + 1, minor), "%s.%d.2" % (major, int(minor) + 1),
                        "%s.%s1.0" % (major, minor)):
            said, libraries = import_beside(version)
            self.assertIn("built for VTK %s.%s." % (major, minor), said)
            self.assertIn("is of VTK %s (" % version, said)
            self.assertEqual(libraries, [])

    def test_a_patch_of_the_same_vtk_is_taken(self):
        major, minor, *_ = vtkmodules.__version__.split(".")
        said, libraries = import_beside("%s.%s.99" % (major, minor))
        self.assertEqual(said.strip(), "imported")
        self.assertTrue(any("libvtkFFDCore" in name for name in libraries))


if __name__ == "__main__":
    unittest.main()
