# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The web editor in a headless Chromium, by real mouse events: edits, sliders, uploads, screenshots;
sessions do not see each other's, and what a stranger sends reads no file of the server. Skipped where
Chromium is not installed, or trame is neither installed nor to be had."""

import asyncio
import gzip
import io
import os
import re
import shutil
import sys
import unittest

import ffdpackages

PACKAGES = ffdpackages.require("trame_rca.widgets.rca", ffdpackages.TRAME)

import aiohttp  # noqa: E402
import ffdbrowser  # noqa: E402
import numpy as np  # noqa: E402
import vtkffd  # noqa: E402
from PIL import Image  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkCoordinate, vtkRenderer, vtkRenderWindow  # noqa: E402

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.path.join(SOURCE, "Examples", "Python", "web_editor.py")
DATA = os.environ["FFD_TEST_DATA"]
WORK = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "web_editor")
SECRET = "a-secret-of-the-server"
PICTURE = "document.querySelector('#view img.image-display-area')"
BOX = "(r => [r.x, r.y, r.width, r.height])(document.querySelector('#view').getBoundingClientRect())"


def control_point(box):
    """Where the page shows the control point (2, 0, 3) of the engine's lattice at rest."""
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(6, 6, 6)
    bounds = (0.0, 255.0, 0.0, 255.0, 0.0, 127.0)
    lattice.FitToBounds(bounds)
    window, renderer, place = vtkRenderWindow(), vtkRenderer(), vtkCoordinate()
    window.SetOffScreenRendering(1)
    window.SetSize(round(box[2]), round(box[3]))
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetPosition(0.75, -1.0, 0.55)
    camera.SetViewUp(0.0, 0.0, 1.0)
    renderer.ResetCamera(bounds)
    point = [0.0, 0.0, 0.0]
    lattice.GetRestPoint(2, 0, 3, point)
    place.SetCoordinateSystemToWorld()
    place.SetValue(point)
    x, y = place.GetComputedDisplayValue(renderer)
    return box[0] + x, box[1] + box[3] - y


class Visit:
    """A page of the editor."""

    def __init__(self, page):
        self.page = page

    async def begin(self):
        await self.page.wait_for(PICTURE + " && " + PICTURE + ".naturalWidth > 0")
        await self.settled()
        self.box = await self.page.evaluate(BOX)
        return self

    async def view(self):
        """The pixels of the view."""
        image = Image.open(io.BytesIO(await self.page.screenshot()))
        x, y, width, height = (round(value) for value in await self.page.evaluate(BOX))
        return np.asarray(image.convert("RGB")).astype(int)[y:y + height, x:x + width]

    async def settled(self):
        """The view, when it stays as it is."""
        last = None
        for _ in range(60):
            # The session answers when it is not rendering.
            await self.page.evaluate("trame.client.getConnection().getSession()"
                                     ".call('trame.state.get', []).then(() => 1)")
            await asyncio.sleep(0.7)
            view = await self.view()
            if last is not None and view.shape == last.shape and np.array_equal(view, last):
                return view
            last = view
        raise TimeoutError("the view does not come to rest")

    async def edits(self, pattern):
        """Wait until the page tells of such edits."""
        return await self.page.wait_for(
            "(t => /%s/.test(t) ? t : null)(document.querySelector('#edits').innerText)" % pattern)

    async def message(self, pattern):
        return await self.page.wait_for(
            "(t => /%s/.test(t) ? t : null)(document.querySelector('#message').innerText)" % pattern)

    async def slide(self, name, pixels):
        x, y = await self.page.evaluate(
            "(r => [r.x + r.width / 2, r.y + r.height / 2])(document.querySelector('#%s')"
            ".closest('.v-slider').querySelector('.v-slider-thumb').getBoundingClientRect())" % name)
        await self.page.drag((x, y), (x + pixels, y), 3)

    async def upload(self, path):
        document = await self.page.call("DOM.getDocument")
        node = await self.page.call("DOM.querySelector", nodeId=document["root"]["nodeId"],
                                    selector="input[type=file]")
        await self.page.call("DOM.setFileInputFiles", nodeId=node["nodeId"], files=[path])


def differ(one, other):
    return np.abs(one - other).mean()


class TestWebEditor(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        asyncio.get_running_loop().set_debug(False)  # it tells of every step that took 0.1 s
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(WORK)
        environment = dict(os.environ)
        if PACKAGES:
            environment["PYTHONPATH"] = PACKAGES + os.pathsep + environment["PYTHONPATH"]
        self.server = await asyncio.create_subprocess_exec(
            sys.executable, PROGRAM, "--port", "0", "--sessions", "2", "--upload-limit", "1",
            env=environment, stdout=asyncio.subprocess.PIPE)
        line = (await self.server.stdout.readline()).decode()
        self.address = re.search(r"http://\S+", line).group()

    async def asyncTearDown(self):
        self.server.terminate()
        await self.server.wait()

    async def test_editor(self):
        async with ffdbrowser.Browser() as browser, ffdbrowser.Browser() as another:
            mine = await Visit(await browser.open(self.address)).begin()
            other = await Visit(await another.open(self.address)).begin()
            rest, other_rest = await mine.settled(), await other.settled()
            self.assertLess(differ(rest, other_rest), 0.5)

            # A control point by the mouse.
            start = control_point(mine.box)
            await mine.page.drag(start, (start[0] + 20, start[1] - 70))
            await mine.edits("^1 edits, moved by [1-9]")
            moved = await mine.settled()
            self.assertGreater(differ(moved, rest), 1.0)
            await mine.page.screenshot(os.path.join(WORK, "moved.png"))
            await other.edits("^0 edits, moved by 0$")
            self.assertLess(differ(await other.settled(), other_rest), 0.5)

            await mine.page.click("#undo")
            await mine.edits("^0 edits, moved by 0$")
            await mine.page.click("#redo")
            await mine.edits("^1 edits, moved by [1-9]")
            await mine.page.click("#reset")
            await mine.edits("moved by 0$")

            # The volume itself.
            await mine.page.click("#grab")
            center = [mine.box[0] + 0.42 * mine.box[2], mine.box[1] + 0.55 * mine.box[3]]
            await mine.page.drag(center, (center[0] - 20, center[1] + 60))
            await mine.edits("moved by [1-9]")
            await mine.page.screenshot(os.path.join(WORK, "grabbed.png"))
            await mine.page.click("#reset")

            # Shapes, sliders, before and after, without the lattice.
            await mine.page.click("#show_lattice")
            plain = await mine.settled()
            await mine.page.evaluate("trame.state.set('shape', 'twist')")
            await mine.edits("moved by [1-9]")
            twisted = await mine.settled()
            await mine.slide("strength", 25)
            stronger = await mine.settled()
            await mine.page.screenshot(os.path.join(WORK, "twisted.png"))
            await mine.slide("threshold", 30)
            sparser = await mine.settled()
            await mine.page.click("#deformed")
            before = await mine.settled()
            for pair in ((plain, twisted), (twisted, stronger), (stronger, sparser),
                         (sparser, before)):
                self.assertGreater(differ(*pair), 1.0)

            # The camera, and a screenshot.
            await mine.page.drag((mine.box[0] + 30, mine.box[1] + 30),
                                 (mine.box[0] + 130, mine.box[1] + 60))
            self.assertGreater(differ(await mine.settled(), before), 1.0)
            await mine.page.call("Page.setDownloadBehavior", behavior="allow", downloadPath=WORK)
            await mine.page.click("#screenshot")
            path = os.path.join(WORK, "volume.png")
            for _ in range(200):
                if os.path.exists(path):
                    break
                await asyncio.sleep(0.2)
            await asyncio.sleep(0.5)
            taken = np.asarray(Image.open(path).convert("RGB")).astype(int)
            view = await mine.settled()
            self.assertEqual(taken.shape, view.shape)
            self.assertLess(differ(taken, view), 2.0)

    async def test_strangers(self):
        def write(name, content):
            path = os.path.join(WORK, name)
            with open(path, "wb") as file:
                file.write(content)
            return path

        secret = write("secret.raw", (SECRET * 30).encode()[:512])
        meta = ("ObjectType = Image\nNDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\n"
                "ElementDataFile = %s\n")
        nrrd = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n"
                "data file: %s\n\n")
        async with ffdbrowser.Browser() as browser:
            visit = await Visit(await browser.open(self.address)).begin()
            await visit.upload(os.path.join(DATA, "fuel.vti"))
            await visit.message("fuel.vti: 64 x 64 x 64 voxels")
            await visit.page.click("#show_lattice")
            fuel = await visit.settled()
            await visit.page.screenshot(os.path.join(WORK, "uploaded.png"))
            for path in (write("a.mha", (meta % secret).encode()),
                         write("b.nii", (meta % secret).encode()),
                         write("c.nrrd", (nrrd % secret).encode()),
                         write("i.nrrd", (nrrd % secret).replace(
                             "encoding", "content: a\r\rb\nencoding").replace(
                                 "data file", "DataFile").encode()),
                         write("j.nrrd", (meta % secret).encode()),
                         write("k.nii.gz", gzip.compress(bytes(344) + b"ni1" + bytes(10))),
                         write("d.mhd", (meta % secret).encode()),
                         write("e.vti", b"<VTKFile"), write("f.nii", b""),
                         write("g.vti", b" " * (5 << 20)), write("h.txt", b"text")):
                name = os.path.basename(path)
                with self.subTest(name):
                    await visit.upload(path)
                    text = await visit.message(name.replace(".", "[.]") + ": ")
                    self.assertNotRegex(text, "[0-9] voxels")
                    self.assertEqual("more than 1 MB" in text, name == "g.vti")
                    self.assertNotIn("ffd-upload", text)
                    self.assertLess(differ(await visit.settled(), fuel), 0.5)
            # Nonsense for every value that a page can set.
            for name, value in (("shape", "'../../etc/passwd'"), ("shape", "{}"), ("points", "1e300"),
                                ("strength", "'x'"), ("opacity", "null"), ("colors", "'__class__'"),
                                ("threshold", "NaN"), ("upload", "{name: 3}"), ("upload", "17"),
                                ("upload", "{name: '/etc/passwd', content: '/etc/passwd'}")):
                await visit.page.evaluate("trame.state.set(%r, %s)" % (name, value))
            await visit.page.evaluate(
                "trame.client.getConnection().getSession().call('trame.rca.size', "
                "['view', 0, {w: 1e9, h: 1e9, p: 1}])")
            for name, value in (("strength", "0.5"), ("points", "6"), ("shape", "'taper'")):
                await visit.page.evaluate("trame.state.set(%r, %s)" % (name, value))
            await visit.edits("moved by [1-9]")

            # Addresses: other files, other keys, more visitors than there is room for.
            page = await visit.page.evaluate("location.href")
            async with aiohttp.ClientSession() as client:
                for address in (page.replace("index.html", "%2e%2e/%2e%2e/%2e%2e/etc/passwd"),
                                page.replace("index.html", "..%2f..%2f..%2f..%2fetc%2fpasswd"),
                                page.replace("index.html", "/etc/passwd"),
                                self.address + "s/unknown/index.html", self.address + "etc/passwd"):
                    async with client.get(aiohttp.client.URL(address, encoded=True)) as answer:
                        self.assertIn(answer.status, (403, 404), address)
                        self.assertNotIn("root:", await answer.text())
                async with client.get(self.address) as answer:
                    self.assertEqual(answer.status, 200)
                async with client.get(self.address) as answer:
                    self.assertEqual(answer.status, 503)


if __name__ == "__main__":
    if ffdbrowser.find() is None:
        print("skipped: chromium is not installed")
        sys.exit(ffdpackages.SKIPPED)
    unittest.main()
