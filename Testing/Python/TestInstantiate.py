# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every public class is in the package vtkffd, can be made and printed, and is documented."""

import glob
import os
import re
import subprocess
import sys
import unittest

import vtkffd
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ABSTRACT = ("vtkFFDWarpTransform",)
FOLDERS = ("Module", "Filters", "Rendering", os.path.join("Rendering", "Widgets"))


def public_classes():
    """Names of the classes that the installed headers declare."""
    names = []
    for folder in FOLDERS:
        for path in sorted(glob.glob(os.path.join(SOURCE, folder, "vtkFFD*.h"))):
            with open(path, encoding="ascii") as header:
                names += re.findall(r"^class \w+_EXPORT (vtkFFD\w+)", header.read(), re.MULTILINE)
    return names


class TestInstantiate(unittest.TestCase):
    def test_every_public_class_is_exported(self):
        names = public_classes()
        self.assertIn("vtkFFDLattice", names)
        for name in names:
            with self.subTest(name):
                self.assertIn(name, vtkffd.__all__)

    def test_every_class_can_be_made_and_printed(self):
        self.assertTrue(vtkffd.__all__)
        for name in vtkffd.__all__:
            with self.subTest(name):
                cls = getattr(vtkffd, name)
                self.assertTrue(issubclass(cls, vtkObject))
                if name in ABSTRACT:
                    self.assertRaisesRegex(TypeError, "abstract", cls)
                    continue
                instance = cls()
                self.assertEqual(instance.GetClassName(), name)
                self.assertIn(name, str(instance))
                if not issubclass(cls, vtkAlgorithm):
                    # The executive of an algorithm holds a reference to it.
                    self.assertEqual(instance.GetReferenceCount(), 1)

    def test_missing_vtk_is_explained(self):
        # Another interpreter's VTK must not be found either: block vtkmodules by a finder.
        code = (
            "import sys\n"
            "class Block:\n"
            "    def find_spec(self, name, path=None, target=None):\n"
            "        if name.split('.')[0] == 'vtkmodules':\n"
            "            raise ImportError('blocked')\n"
            "sys.meta_path.insert(0, Block())\n"
            "import vtkffd\n")
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                             check=False)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("vtkffd needs VTK's Python modules", run.stderr)
        self.assertIn("python3-vtk9", run.stderr)


if __name__ == "__main__":
    unittest.main()
