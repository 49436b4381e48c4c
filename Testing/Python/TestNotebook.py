# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The notebook runs from its first cell to its last, and its pictures and figures are what it says.
Skipped where PyVista, or what runs notebooks, is neither installed nor to be had."""

import base64
import io
import os
import re
import unittest

import ffdpackages

FOLDERS = [folder for folder in (ffdpackages.require("pyvista", ffdpackages.PYVISTA),
                                 ffdpackages.require("nbclient, ipykernel", ffdpackages.NOTEBOOK))
           if folder]

import nbclient  # noqa: E402
import nbformat  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NOTEBOOK = os.path.join(SOURCE, "Examples", "Notebooks", "deformed_volumes.ipynb")


class TestNotebook(unittest.TestCase):
    def test_runs(self):
        os.environ["PYTHONPATH"] = os.pathsep.join([*FOLDERS, os.environ["PYTHONPATH"]])
        with open(NOTEBOOK, encoding="utf-8") as file:
            notebook = nbformat.read(file, as_version=4)
        nbformat.validate(notebook)
        self.assertEqual([cell.outputs for cell in notebook.cells if cell.cell_type == "code"
                          and cell.outputs], [])
        nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={
            "metadata": {"path": os.path.dirname(NOTEBOOK)}}).execute()
        outputs = [output for cell in notebook.cells if cell.cell_type == "code"
                   for output in cell.outputs]
        text = "".join(output.get("text", "") for output in outputs)
        self.assertRegex(text, "moved by at most 5[0-9]")
        self.assertIn("cannot fold: True", text)
        ratio = float(re.search(r"after to before: ([0-9.]+)", text).group(1))
        self.assertAlmostEqual(ratio, 1.0, delta=0.1)
        self.assertNotIn("stderr", [output.get("name") for output in outputs], outputs)
        pictures = [output.data["image/png"] for output in outputs
                    if "image/png" in output.get("data", {})]
        self.assertEqual(len(pictures), 2)
        pixels = []
        for number, picture in enumerate(pictures):
            image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
            image.save(os.path.join(os.environ["FFD_TEST_TEMPORARY"], "notebook%d.png" % number))
            pixels.append(np.asarray(image).astype(int))
            self.assertGreater((np.ptp(pixels[-1], axis=-1) > 30).mean(), 0.05)
        self.assertGreater(np.abs(pixels[0] - pixels[1]).mean(), 5.0)


if __name__ == "__main__":
    unittest.main()
