# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The programs of the tutorial run as they are printed, and make the pictures that they name."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TUTORIAL = SOURCE / "Module" / "Documentation" / "tutorial.md"


def programs():
    """The Python code of each section of the tutorial, by its title."""
    for section in re.split(r"^## ", TUTORIAL.read_text(encoding="utf-8"), flags=re.M)[1:]:
        blocks = re.findall(r"^```python\n(.*?)^```", section, re.M | re.S)
        if blocks:
            yield section.splitlines()[0], "\n".join(blocks)


class TestTutorial(unittest.TestCase):
    def run_section(self, title, code):
        with tempfile.TemporaryDirectory(dir=os.environ["FFD_TEST_TEMPORARY"]) as folder:
            os.symlink(SOURCE / "Testing", os.path.join(folder, "Testing"))
            result = subprocess.run([sys.executable, "-c", code], cwd=folder,
                                    capture_output=True, text=True)
            output = result.stdout + result.stderr
            self.assertEqual(result.returncode, 0, output)
            self.assertNotIn("ERR|", output)
            self.assertNotIn("ERROR", output)
            pictures = sorted(pathlib.Path(folder).glob("*.png"))
            for path in pictures:
                reader = vtkPNGReader()
                reader.SetFileName(str(path))
                reader.Update()
                colors = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
                self.assertGreater(np.count_nonzero(colors[:, 3] > 100), 0.05 * len(colors), path.name)
            return len(pictures), output

    def test_programs(self):
        made = {}
        for title, code in programs():
            with self.subTest(section=title):
                made[title[0]], output = self.run_section(title, code)
                if title[0] == "2":
                    self.assertIn("fold free: True", output)
        self.assertEqual(made, {"1": 2, "2": 0, "3": 1, "5": 4})


if __name__ == "__main__":
    unittest.main()
