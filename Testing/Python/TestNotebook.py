# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The notebook runs from its first cell to its last, and its pictures and figures are what it says. Where
this VTK and PyVista can show a window in the page, its widget is one, and the mouse in a headless
Chromium moves a control point of the kernel's lattice. Skipped where PyVista, or what runs notebooks,
is neither installed nor to be had."""

import asyncio
import base64
import importlib.util
import io
import os
import re
import unittest
import urllib.request

import ffdpackages

FOLDERS = [folder for folder in (ffdpackages.require("pyvista", ffdpackages.PYVISTA),
                                 ffdpackages.require("nbclient, ipykernel", ffdpackages.NOTEBOOK))
           if folder]

import nbclient  # noqa: E402
import nbformat  # noqa: E402
import numpy as np  # noqa: E402
import vtkffd  # noqa: E402
from PIL import Image  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkCoordinate, vtkRenderer, vtkRenderWindow  # noqa: E402

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NOTEBOOK = os.path.join(SOURCE, "Examples", "Notebooks", "deformed_volumes.ipynb")
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
WIDGET = "application/vnd.jupyter.widget-view+json"
# What the notebook asks for.
NEEDED = ("vtkmodules.vtkWebCore", "trame_vtk", "trame_vuetify", "ipywidgets", "nest_asyncio2")
INTERACTIVE = all(importlib.util.find_spec(name) for name in NEEDED)
PICTURE = "document.querySelector('img[src^=\"blob:\"]')"
BOX = ("(e => { if (!e || !e.complete) return null; const r = e.getBoundingClientRect(); "
       "return r.width > 400 ? [r.x, r.y, r.width, r.height] : null; })(%s)" % PICTURE)


def nearest_corner(box):
    """Where the page shows the control point (4, 0, 4) of the engine's lattice at rest."""
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(5, 5, 5)
    lattice.FitToBounds((0.0, 255.0, 0.0, 255.0, 0.0, 127.0))
    window, renderer, place = vtkRenderWindow(), vtkRenderer(), vtkCoordinate()
    window.SetOffScreenRendering(1)
    window.SetSize(round(box[2]), round(box[3]))
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(520, -440, 350)
    camera.SetFocalPoint(128, 128, 80)
    camera.SetViewUp(0, 0, 1)
    point = [0.0, 0.0, 0.0]
    lattice.GetRestPoint(4, 0, 4, point)
    place.SetCoordinateSystemToWorld()
    place.SetValue(point)
    x, y = place.GetComputedDisplayValue(renderer)
    return box[0] + x, box[1] + box[3] - y


async def shoot(page, name):
    """What the page shows, as numbers; a copy is kept as a file."""
    png = await page.screenshot(os.path.join(TEMPORARY, name))
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


async def shoot_at_rest(page, name, other):
    """What the page shows once nothing has changed for two seconds, and is not the other picture; what
    it shows after two minutes, if that does not come."""
    picture = await shoot(page, name)
    for _ in range(60):
        last = picture
        await asyncio.sleep(2.0)
        picture = await shoot(page, name)
        if np.array_equal(last, picture) and changed(other, picture) > 0.002:
            break
    return picture


def changed(first, second):
    """The part of the pixels that changed clearly."""
    return (np.abs(first - second).max(axis=-1) > 30).mean()


async def drag_corner(address):
    """Open the widget's page and drag the corner; the part of the picture that changes."""
    import ffdbrowser
    async with ffdbrowser.Browser() as browser:
        page = await browser.open(address)
        await page.wait_for(BOX)
        # The window has taken the size of the page by then.
        before = await shoot_at_rest(page, "notebook_before.png", 255)
        start = nearest_corner(await page.wait_for(BOX))
        await page.drag(start, (start[0] - 90, start[1] - 60))
        return changed(before, await shoot_at_rest(page, "notebook_after.png", before))


class TestNotebook(unittest.TestCase):
    def use_widget(self, address):
        """What somebody does who reads the notebook; how many points have moved then."""
        with urllib.request.urlopen(address, timeout=60) as answer:
            self.assertEqual(answer.status, 200)
        try:
            import ffdbrowser
        except ImportError:  # aiohttp
            return 0
        if ffdbrowser.find() is None:
            return 0
        self.assertGreater(asyncio.run(drag_corner(address)), 0.002)
        return 1

    def test_runs(self):
        os.environ["PYTHONPATH"] = os.pathsep.join([*FOLDERS, os.environ["PYTHONPATH"]])
        with open(NOTEBOOK, encoding="utf-8") as file:
            notebook = nbformat.read(file, as_version=4)
        nbformat.validate(notebook)
        self.assertEqual([cell.outputs for cell in notebook.cells if cell.cell_type == "code"
                          and cell.outputs], [])
        client = nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={
            "metadata": {"path": os.path.dirname(NOTEBOOK)}})
        text, pictures, widgets, moved = "", [], 0, 0
        with client.setup_kernel():
            for index, cell in enumerate(notebook.cells):
                client.execute_cell(cell, index)
                for output in cell.get("outputs", []):
                    data = output.get("data", {})
                    if WIDGET in data:
                        widgets += 1
                        html = client.widget_state[data[WIDGET]["model_id"]]["value"]
                        moved += self.use_widget(re.search('src="([^"]+)"', html).group(1))
                    elif "image/png" in data:
                        pictures.append(data["image/png"])
                    # What draws in the page warns of what is not there.
                    elif output.get("name") == "stderr" and not INTERACTIVE:
                        self.fail(output)
                    text += output.get("text", "")
        self.assertRegex(text, "moved by at most 5[0-9]")
        self.assertIn("cannot fold: True", text)
        self.assertIn("the mouse has moved %d of 125" % moved, text)
        ratio = float(re.search(r"after to before: ([0-9.]+)", text).group(1))
        self.assertAlmostEqual(ratio, 1.0, delta=0.1)
        self.assertEqual((len(pictures), widgets), (2, 1) if INTERACTIVE else (3, 0))
        pixels = []
        for number, picture in enumerate(pictures):
            image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
            image.save(os.path.join(TEMPORARY, "notebook%d.png" % number))
            pixels.append(np.asarray(image).astype(int))
            self.assertGreater((np.ptp(pixels[-1], axis=-1) > 30).mean(), 0.05)
        self.assertGreater(np.abs(pixels[0] - pixels[1]).mean(), 5.0)


if __name__ == "__main__":
    unittest.main()
