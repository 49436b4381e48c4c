# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is behind the page of the web editor, without a browser: sizes of pictures and places of the mouse,
and what the panel does to the lattice. Skipped where trame is neither installed nor to be had."""

import asyncio
import glob
import os
import re
import socket
import subprocess
import sys
import unittest

import ffdpackages

PACKAGES = ffdpackages.require("trame_rca.widgets.rca", ffdpackages.TRAME)

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.path.join(SOURCE, "Examples", "Python", "web_editor.py")
VOLUME = os.path.join(os.environ["FFD_TEST_DATA"], "fuel.vti")
sys.path.insert(0, os.path.dirname(PROGRAM))

import aiohttp  # noqa: E402
import numpy as np  # noqa: E402
import web_editor  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkCoordinate  # noqa: E402


def environment():
    result = dict(os.environ)
    if PACKAGES:
        result["PYTHONPATH"] = PACKAGES + os.pathsep + result["PYTHONPATH"]
    return result


def processes():
    """Those that run, with their parents."""
    result = {}
    for path in glob.glob("/proc/[0-9]*/stat"):
        try:
            with open(path, encoding="utf-8") as file:
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except OSError:
            continue  # it has just ended
        if state != "Z":
            result[int(path.split("/")[2])] = int(parent)
    return result


def children(process):
    return [child for child, parent in processes().items() if parent == process]


class TestFront(unittest.IsolatedAsyncioTestCase):
    async def test_places_and_end(self):
        server = await asyncio.create_subprocess_exec(
            sys.executable, PROGRAM, VOLUME, "--port", "0", "--sessions", "1", env=environment(),
            stdout=asyncio.subprocess.PIPE)
        address = re.search(r"http://\S+", (await server.stdout.readline()).decode()).group()
        async with aiohttp.ClientSession() as client:
            # Programs that only ask whether the page is there take no place.
            async with client.head(address) as answer:
                self.assertEqual(answer.status, 405)
            self.assertEqual(children(server.pid), [])
            async with client.get(address, allow_redirects=False) as answer:
                self.assertEqual(answer.status, 302)
        session = children(server.pid)
        self.assertEqual(len(session), 1)
        server.terminate()
        self.assertEqual(await server.wait(), 0)
        while session[0] in processes():
            await asyncio.sleep(0.1)


class TestArguments(unittest.TestCase):
    def test_errors_are_one_line(self):
        taken = socket.create_server(("127.0.0.1", 0))
        port = str(taken.getsockname()[1])
        for arguments, text in ((("--port", port), "--port %s: it is in use; .* 0 for any" % port),
                                (("--port", "65536"), "--port: from 0.* to 65535"),
                                (("--port", "-1"), "--port: from 0"),
                                (("--host", "no.such.host.invalid"), "--host no.such.host.invalid: "),
                                (("--host", "192.0.2.1"), "--host 192.0.2.1: "),
                                (("--host", "a" * 70), "--host aaaa"), (("--host", ""), "--host: "),
                                (("--sessions", "0"), "--sessions: 1 or more"),
                                (("--sessions", "-3"), "--sessions: 1 or more"),
                                (("--upload-limit", "0"), "--upload-limit: from 1"),
                                (("--upload-limit", "-1"), "--upload-limit: from 1")):
            with self.subTest(arguments):
                result = subprocess.run(
                    [sys.executable, PROGRAM, VOLUME, *arguments,
                     *(() if "--port" in arguments else ("--port", "0"))],
                    env=environment(), capture_output=True, text=True, check=False)
                self.assertEqual((result.returncode, result.stdout), (1, ""))
                self.assertRegex(result.stderr, r"\Aweb_editor: %s.*\n\Z" % text)
        taken.close()


class TestSession(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.session = web_editor.Session(VOLUME, 4 << 20)  # trame has one server for a process
        cls.session.state.ready()

    def setUp(self):
        self.session.load(VOLUME)
        self.session.points.ClearHistory()
        self.panel(shape="identity", strength=0.5, points=6)

    def mouse(self, kind, x, y):
        self.session.window.process_interaction_event({"type": kind, "x": x, "y": y})

    def place(self, i, j, k):
        """Where a control point at rest is in the picture."""
        point, place = [0.0, 0.0, 0.0], vtkCoordinate()
        self.session.lattice.GetRestPoint(i, j, k, point)
        place.SetCoordinateSystemToWorld()
        place.SetValue(point)
        return place.GetComputedDoubleDisplayValue(self.session.renderer)

    def panel(self, **values):
        """As the page sets them."""
        self.session.state.update(values)
        self.session.state.flush()
        return self.session.state

    def displacements(self):
        return np.array(vtk_to_numpy(self.session.lattice.GetDisplacements()))

    def test_pictures_keep_the_shape_of_the_view(self):
        window, interactor = self.session.window, self.session.window.interactor
        for view, picture in (((800, 600), (800, 600)), ((3000, 1400), (2048, 956)),
                              ((1400, 4096), (700, 2048)), ((2048, 2048), (2048, 2048)),
                              ((10**9, 10**9), (2048, 2048)), ((3, 3), (16, 16))):
            with self.subTest(view):
                window.process_resize_event(*view)
                self.assertEqual(tuple(window.window.GetSize()), picture)
        # The mouse is where the page shows it.
        window.process_resize_event(4096, 2800)
        self.mouse("MouseMove", 3000, 1000)
        self.assertEqual(tuple(interactor.GetEventPosition()), (1500, 500))
        x, y = self.place(2, 0, 3)
        self.mouse("MouseMove", 2.0 * x, 2.0 * y)
        self.mouse("LeftButtonPress", 2.0 * x, 2.0 * y)
        self.mouse("MouseMove", 2.0 * x, 2.0 * y + 100)
        self.mouse("LeftButtonRelease", 2.0 * x, 2.0 * y + 100)
        moved = self.displacements()
        self.assertEqual(np.flatnonzero(np.abs(moved).max(axis=1)).tolist(), [2 + 6 * 6 * 3])
        window.process_resize_event(800, 600)
        self.mouse("MouseMove", 300, 100)
        self.assertEqual(tuple(interactor.GetEventPosition()), (300, 100))
        self.session.undo()
        self.assertEqual(np.abs(self.displacements()).max(), 0.0)

    def test_values_that_no_page_sends(self):
        """Exceptions kept the session from what else a message holds."""
        session = self.session
        for event in ({"type": "MouseMove", "x": 10**400, "y": 1}, {"type": "MouseMove", "key": "\ud800"},
                      {"type": "MouseWheel", "spinY": -10**400}, {"type": [], "x": {}, "y": [1]}):
            session.window.process_interaction_event(event)
        session.window.process_resize_event(float("nan"), 10**400)
        self.assertEqual(tuple(session.window.window.GetSize()), (16, 16))
        session.window.process_resize_event(800, 600)
        before = self.displacements()
        self.panel(opacity=10**400, strength=10**400, points=-10**400)
        self.panel(colors=["bone"])
        self.panel(colors={})
        np.testing.assert_array_equal(self.displacements(), before)
        self.panel(opacity=0.5, strength=0.5, points=6, colors="bone")
        for content in (10**9, 10**400, "text", None, ["text"], {}):  # a number was taken for a size
            self.panel(upload={"name": "a.vti", "content": content})
            self.assertEqual(session.state.message, "this is no upload")
            session.state.message = ""

    def test_edits_by_hand_outlast_sliders(self):
        session, lattice = self.session, self.session.lattice
        session.points.SetControlPoint(2, 3, 2, 20.0, 40.0, 35.0)
        edited = self.displacements()
        self.assertEqual(np.count_nonzero(edited.any(axis=1)), 1)
        # The strength of no shape.
        state = self.panel(strength=1.0)
        np.testing.assert_array_equal(self.displacements(), edited)
        self.assertEqual(state.edits, 1)
        session.undo()
        session.redo()
        np.testing.assert_array_equal(self.displacements(), edited)

        # Control points per axis: the lattice does what it did, exactly so where cells are halved.
        probes = np.random.default_rng(1).uniform(0.0, 63.0, (50, 3))
        before = np.array([lattice.TransformPoint(point) for point in probes])
        self.assertGreater(np.abs(before - probes).max(), 1.0)
        state = self.panel(points=9)
        self.assertEqual(tuple(lattice.GetDimensions()), (9, 9, 9))
        np.testing.assert_allclose([lattice.TransformPoint(point) for point in probes], before)
        self.assertEqual(state.edits, 0)

        # Shapes replace edits, and follow their strength; Reset takes the panel along.
        self.panel(shape="twist", points=6, strength=0.5)
        half = self.displacements()
        self.panel(strength=1.0)
        self.assertGreater(np.abs(self.displacements()).max(), 1.5 * np.abs(half).max())
        session.reset_lattice()
        session.state.flush()
        self.assertEqual(session.state.shape, "identity")
        self.assertEqual(np.abs(self.displacements()).max(), 0.0)
        self.assertEqual(session.state.edits, 1)
        session.undo()
        self.assertGreater(np.abs(self.displacements()).max(), 1.0)
        session.reset_lattice()
        self.panel(shape="twist", strength=0.5)
        np.testing.assert_allclose(self.displacements(), half)
        self.panel(shape="identity")
        self.assertEqual(np.abs(self.displacements()).max(), 0.0)

    def test_a_page_that_opens_ends_drags(self):
        session, camera = self.session, self.session.renderer.GetActiveCamera()
        session.window.process_resize_event(800, 600)
        x, y = self.place(2, 0, 3)
        self.mouse("MouseMove", x, y)
        self.mouse("LeftButtonPress", x, y)
        self.mouse("MouseMove", x, y + 60)
        self.assertGreater(np.abs(self.displacements()).max(), 1.0)
        session.server.controller.on_client_connected()
        for place in ((x, y + 100), (x, y - 100)):
            self.mouse("MouseMove", *place)
            self.assertEqual(np.abs(self.displacements()).max(), 0.0)
        self.assertEqual(session.state.edits, 0)
        # The camera.
        for button in ("Left", "Middle", "Right"):
            self.mouse("MouseMove", 20, 20)
            self.mouse(button + "ButtonPress", 20, 20)
            self.mouse("MouseMove", 60, 40)
            session.server.controller.on_client_connected()
            view = camera.GetPosition()
            self.mouse("MouseMove", 200, 140)
            self.assertEqual(camera.GetPosition(), view)
            self.mouse(button + "ButtonPress", 20, 20)
            self.mouse("MouseMove", 60, 40)
            self.assertNotEqual(camera.GetPosition(), view)
            self.mouse(button + "ButtonRelease", 60, 40)

    def test_uploads_that_are_too_large(self):
        content = b" " * (5 << 20)
        for sent in (content, [content[:3 << 20], content[3 << 20:]]):
            self.panel(upload={"name": "large.vti", "content": sent})
            self.assertEqual(self.session.state.message, "large.vti: more than 4 MB")
            self.assertIsNone(self.session.state.upload)


if __name__ == "__main__":
    unittest.main()
