# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The type stub of the package: complete, believed by mypy for the programs of the tutorial, and of use
for wrong ones. help() says what a method does. Skipped where mypy is missing."""

import ast
import importlib.util
import io
import os
import pathlib
import pydoc
import re
import subprocess
import sys
import tempfile
import unittest

import vtkffd

SKIPPED = 77
PACKAGE = pathlib.Path(vtkffd.__file__).parent
TUTORIAL = pathlib.Path(__file__).resolve().parents[2] / "Module" / "Documentation" / "tutorial.md"

WRONG = """
import vtkffd

lattice = vtkffd.vtkFFDLattice()
lattice.SetDimensions("8", 8, 8)
vtkffd.vtkFFDInverseRayVolumeMapper().SetInverseMode(0.5)
vtkffd.vtkFFDLatice()
"""


def check_types(code):
    """The status and the output of mypy."""
    with tempfile.TemporaryDirectory(dir=os.environ["FFD_TEST_TEMPORARY"]) as folder:
        path = os.path.join(folder, "program.py")
        with open(path, "w", encoding="utf-8") as file:
            file.write(code)
        # What is installed mypy finds by itself. VTK's own modules may have no stubs.
        path_of_stubs = "" if "site-packages" in PACKAGE.parts else str(PACKAGE.parent)
        result = subprocess.run(
            [sys.executable, "-m", "mypy", "--ignore-missing-imports",
             "--cache-dir", os.path.join(os.environ["FFD_TEST_TEMPORARY"], "mypy"), path],
            env=dict(os.environ, MYPYPATH=path_of_stubs), capture_output=True, text=True)
        return result.returncode, result.stdout + result.stderr


class TestStubs(unittest.TestCase):
    def test_every_class_and_method_is_there(self):
        self.assertTrue((PACKAGE / "py.typed").exists())
        tree = ast.parse((PACKAGE / "__init__.pyi").read_text(encoding="utf-8"))
        classes = {node.name: {member.name for member in node.body
                               if isinstance(member, (ast.FunctionDef, ast.ClassDef))}
                   for node in tree.body if isinstance(node, ast.ClassDef)}
        self.assertEqual(sorted(classes), sorted(vtkffd.__all__))
        for name, members in classes.items():
            methods = {key for key, value in vars(getattr(vtkffd, name)).items()
                       if callable(value) and not key.startswith("__")}
            self.assertEqual(methods - members, set(), name)

    def test_right_programs(self):
        blocks = re.findall(r"^```python\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.M | re.S)
        self.assertGreater(len(blocks), 3)
        status, output = check_types("\n".join(blocks))
        self.assertEqual(status, 0, output)

    def test_wrong_program(self):
        status, output = check_types(WRONG)
        self.assertNotEqual(status, 0)
        for line in (5, 6, 7):
            self.assertIn("program.py:%d: error" % line, output)

    def test_help(self):
        text = io.StringIO()
        pydoc.Helper(output=text)(vtkffd.vtkFFDLattice.SetDimensions)
        self.assertIn("Number of control points per axis", text.getvalue())
        for name in vtkffd.__all__:
            self.assertIn("Superclass", getattr(vtkffd, name).__doc__, name)


if __name__ == "__main__":
    if importlib.util.find_spec("mypy") is None:
        print("skipped: mypy is not installed; Module/CMake/setup-debian.sh --documentation installs it")
        sys.exit(SKIPPED)
    unittest.main()
