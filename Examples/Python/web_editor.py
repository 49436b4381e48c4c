# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shape a volume in the browser: the program renders, the page shows the pictures and sends the mouse.

usage: web_editor.py [VOLUME] [--host HOST] [--port PORT] [--sessions N] [--upload-limit MB]

Open the address that it prints. Drag control points, or switch to "Grab the volume"; everything else turns
the camera. The panel has ready shapes, the transfer function, before and after, undo, a screenshot, and
takes a volume of the visitor's own (one .vti, .nrrd, .nii or .nii.gz file).

Each visitor gets a process of its own, which ends a minute after the page is closed; the page's address
holds the key to it. The program listens to this machine only, unless --host says otherwise; put a web
server that encrypts in front of it then. Files of the server are read only if VOLUME names them.

Needs the Python packages trame, trame-vuetify and trame-rca, and a display (xvfb-run makes one).
"""

import argparse
import asyncio
import errno
import math
import os
import re
import secrets
import signal
import socket
import sys
import tempfile
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
DEFAULT_VOLUME = os.path.join(HERE, "..", "..", "Testing", "Data", "engine.vti")
UPLOADS = (".vti", ".nrrd", ".nii.gz", ".nii")  # see find_problem()
SHAPES = ("identity", "bend", "twist", "taper", "bulge", "wave")
COLORS = {
    "bone": ((0.45, 0.30, 0.25), (0.86, 0.65, 0.48), (0.95, 0.88, 0.76), (1.0, 1.0, 1.0)),
    "ice": ((0.05, 0.15, 0.35), (0.25, 0.55, 0.80), (0.70, 0.90, 0.95), (1.0, 1.0, 1.0)),
    "fire": ((0.20, 0.02, 0.02), (0.80, 0.25, 0.05), (1.00, 0.75, 0.20), (1.0, 1.0, 0.9)),
}
LARGEST_PICTURE = 2048  # pixels each way
LARGEST_MESSAGE = 16 << 20  # bytes; pages send what is larger than 4 or 10 MB in parts
IDLE = 60  # seconds that a session outlives its page

# What is too large is not sent at all. A session checks it, too.
CHECK_UPLOAD = """
trame.utils.uploads = {
  check(files, limit) {
    const file = [].concat(files || [])[0] || null;
    if (file && file.size > limit) {
      trame.state.set("message", `${file.name.slice(0, 80)}: more than ${limit / 2 ** 20} MB`);
      return null;
    }
    return file;
  }
};
"""


def number(value, low, high):
    """What a page sends is anything: a number within the range, or None."""
    try:
        value = float(value)
    except (OverflowError, TypeError, ValueError):
        return None
    return min(max(value, low), high) if math.isfinite(value) else None


def find_problem(suffix, content):
    """What is wrong with an upload, or None. It must hold its voxels itself: where a header names another
    file, readers would open that one, whoever's it is. Readers are chosen by content, too."""
    if suffix == ".nii.gz":
        try:
            content = zlib.decompressobj(wbits=31).decompress(content, 348)
        except zlib.error:
            return "this is no gzip file"
    if suffix.startswith(".nii") and content[344:347] != b"n+1":
        return "this is no NIfTI file of one piece"
    if suffix == ".nrrd" and not content.startswith(b"NRRD000"):
        return "this is no NRRD file"
    if suffix == ".nrrd" and re.search(rb"data\s*file", content, re.IGNORECASE):
        return "its voxels are in another file"
    return None


# ----------------------------------------------------------------------------------------------------
# A session: one visitor, one process.

class Window:
    """The render window as trame-rca asks for it: pictures, a size, and events."""

    BUTTONS = ("LeftButton", "MiddleButton", "RightButton")

    def __init__(self, window, interactor):
        from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter
        self.window, self.interactor = window, interactor
        self.scale = 1.0  # pixels of the picture for one of the page
        self.pressed = set()  # of BUTTONS
        self.capture = vtkWindowToImageFilter()
        self.capture.SetInput(window)
        self.capture.ReadFrontBufferOff()
        self.capture.ShouldRerenderOff()

    @property
    def img_cols_rows(self):
        import numpy
        from vtkmodules.util.numpy_support import vtk_to_numpy
        self.window.Render()
        self.capture.Modified()
        self.capture.Update()
        columns, rows, _ = self.capture.GetOutput().GetDimensions()
        pixels = vtk_to_numpy(self.capture.GetOutput().GetPointData().GetScalars())
        return numpy.ascontiguousarray(pixels.reshape(rows, columns, -1)[::-1, :, :3]), columns, rows

    def process_resize_event(self, width, height):
        width, height = (number(pixels, 0, 1e9) or 0.0 for pixels in (width, height))
        # One scale for both axes: the page shows the picture across the whole view.
        self.scale = min(1.0, LARGEST_PICTURE / max(width, height, 1))
        self.interactor.UpdateSize(*(max(round(self.scale * pixels), 16)
                                     for pixels in (width, height)))

    def process_interaction_event(self, event):
        kind = event.get("type")
        x, y = (number(event.get(axis), -1e6, 1e6) for axis in "xy")
        flags = [1 if event.get(name) else 0 for name in ("controlKey", "shiftKey", "altKey")]
        if x is None or y is None:
            x, y = self.interactor.GetEventPosition()
        else:
            x, y = self.scale * x, self.scale * y
        key = str(event.get("key", ""))[:16].encode("utf-8", "ignore").decode("utf-8")
        self.interactor.SetEventInformation(
            int(x), int(y), flags[0], flags[1], key if len(key) == 1 and key.isascii() else "\0", 0,
            key)
        self.interactor.SetAltKey(flags[2])
        if kind in ("MouseMove", "MouseEnter", "MouseLeave"):
            self.interactor.InvokeEvent("MouseMoveEvent")
        elif kind in [button + "Press" for button in self.BUTTONS]:
            self.pressed.add(kind[:-len("Press")])
            self.interactor.InvokeEvent(kind + "Event")
        elif kind in [button + "Release" for button in self.BUTTONS]:
            self.pressed.discard(kind[:-len("Release")])
            self.interactor.InvokeEvent(kind + "Event")
        elif kind == "MouseWheel":
            spin = number(event.get("spinY"), -10.0, 10.0) or 0.0
            self.interactor.InvokeEvent(
                "MouseWheelBackwardEvent" if spin > 0.0 else "MouseWheelForwardEvent")

    def release_buttons(self):
        """A page that is gone cannot say that it does."""
        while self.pressed:
            self.interactor.InvokeEvent(self.pressed.pop() + "ReleaseEvent")


class Session:
    def __init__(self, volume, upload_limit):
        import lattice_editor
        import vtkffd
        from trame.app import get_server
        from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
        from vtkmodules.vtkRenderingCore import (
            vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty)
        from vtkmodules.vtkRenderingUI import vtkGenericRenderWindowInteractor
        self.editor, self.upload_limit = lattice_editor, upload_limit
        self.lattice = vtkffd.vtkFFDLattice()
        self.shapes = vtkffd.vtkFFDLatticeSource
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetDeformation(self.lattice)
        self.mapper.StillFrameCoherenceOn()  # the widget renders where the pointer comes to a point
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.property = vtkVolumeProperty()
        self.property.ShadeOn()
        self.property.SetInterpolationTypeToLinear()
        self.property.SetSpecular(0.25)
        self.volume.SetProperty(self.property)
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(0.1, 0.11, 0.13)
        self.renderer.AddVolume(self.volume)
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(800, 600)
        window.AddRenderer(self.renderer)
        interactor = vtkGenericRenderWindowInteractor()
        interactor.SetRenderWindow(window)
        interactor.SetInteractorStyle(vtkInteractorStyleTrackballCamera())
        interactor.EnableRenderOff()
        interactor.Initialize()
        self.window = Window(window, interactor)
        self.load(volume)

        self.widget = vtkffd.vtkFFDLatticeWidget()
        self.widget.SetInteractor(interactor)
        self.widget.SetDefaultRenderer(self.renderer)
        self.widget.KeyPressActivationOff()
        self.points = self.widget.GetLatticeRepresentation()
        self.points.SetLattice(self.lattice)
        self.points.SetProp(self.volume)
        self.points.SetOutlineBounds(self.image.GetBounds())
        picker = vtkffd.vtkFFDVolumePicker()
        picker.PickFromListOn()
        picker.AddPickList(self.volume)
        self.points.SetSurfacePicker(picker)
        self.widget.AddObserver("WidgetValueChangedEvent", lambda *_: self.tell_edits())
        self.widget.On()

        self.server = get_server(client_type="vue3")
        self.state = self.server.state
        self.state.trame__title = "vtkFFD lattice editor"
        self.state.update({
            "shape": "identity", "strength": 0.5, "points": 6, "opacity": 0.5, "colors": "bone",
            "threshold": 50.0, "deformed": True, "show_lattice": True, "grab": False,
            "upload": None, "message": "", "edits": 0, "moved": 0.0})
        self.state.change("shape", "strength", "points")(self.on_shape)
        self.state.change("opacity", "colors", "threshold")(self.on_transfer)
        self.state.change("deformed", "show_lattice", "grab")(self.on_view)
        self.state.change("upload")(self.on_upload)
        self.server.trigger("screenshot")(self.screenshot)
        self.build_page()

    # What is shown

    def load(self, path):
        """Show a volume; lattice_editor.Problem if it cannot be used."""
        image = self.editor.read_volume(path)
        self.image = image
        self.low, self.high, self.otsu = self.editor.find_threshold(image)
        self.mapper.SetInputData(image)
        self.property.SetScalarOpacityUnitDistance(min(image.GetSpacing()))
        self.lattice.SetDimensions(6, 6, 6)
        self.lattice.Reset()
        self.lattice.FitToBounds(image.GetBounds())
        self.shape = "identity", 0.5  # what was applied last
        self.set_transfer(50.0, 0.5, "bone")
        camera = self.renderer.GetActiveCamera()
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetPosition(0.75, -1.0, 0.55)
        camera.SetViewUp(0.0, 0.0, 1.0)
        self.renderer.ResetCamera()

    def set_transfer(self, threshold, opacity, colors):
        """The threshold is in percent; 50 is what parts the values best."""
        from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
        from vtkmodules.vtkRenderingCore import vtkColorTransferFunction
        low, high = self.low, self.high
        if threshold < 50.0:
            at = low + (self.otsu - low) * threshold / 50.0
        else:
            at = self.otsu + (high - self.otsu) * (threshold - 50.0) / 50.0
        high = max(high, at + 1e-6 * (high - low))
        curve = vtkPiecewiseFunction()
        curve.AddPoint(at - 0.08 * (high - low), 0.0)
        curve.AddPoint(at + 0.04 * (high - low), 0.7 * opacity)
        curve.AddPoint(high, min(1.0, 1.8 * opacity))
        color = vtkColorTransferFunction()
        for value, rgb in zip((low, at, 0.5 * (at + high), high), COLORS[colors]):
            color.AddRGBPoint(value, *rgb)
        self.property.SetScalarOpacity(curve)
        self.property.SetColor(color)

    def draw(self):
        self.view.update()

    # What the page asks for

    def on_page(self, **_):
        """A page has opened, for the first time or again. A drag that is under way is that of a page
        which is gone: it is taken back."""
        if self.widget.IsInteracting():
            self.widget.Perform(self.widget.CancelDrag)
        self.window.release_buttons()
        self.tell_edits()

    def on_shape(self, shape, strength, points, **_):
        strength, points = number(strength, -2.0, 2.0), number(points, 4, 12)
        if shape not in SHAPES or strength is None or points is None:
            return
        size = (round(points),) * 3
        if size != self.lattice.GetDimensions():
            self.lattice.SetDimensions(*size)  # keeps the deformation; undo starts anew
        # Edits by hand stay, unless another shape is asked for. The strength of none means nothing.
        wanted = shape, (self.shape[1] if shape == "identity" else strength)
        if wanted != self.shape:
            self.shape = wanted
            self.shapes.ApplyShape(self.lattice, SHAPES.index(shape), strength)
            self.points.ClearHistory()
        self.tell_edits()

    def on_transfer(self, opacity, colors, threshold, **_):
        opacity, threshold = number(opacity, 0.0, 1.0), number(threshold, 0.0, 100.0)
        if isinstance(colors, str) and colors in COLORS and opacity is not None and threshold is not None:
            self.set_transfer(threshold, opacity, colors)
            self.draw()

    def on_view(self, deformed, show_lattice, grab, **_):
        self.mapper.SetDeformation(self.lattice if deformed else None)
        self.points.SetManipulationMode(
            self.points.VOLUME if grab else self.points.CONTROL_POINTS)
        self.widget.SetEnabled(1 if deformed and show_lattice else 0)
        self.draw()

    def on_upload(self, upload, **_):
        if not upload:
            return
        try:
            self.state.message = self.adopt(upload)
        except (AttributeError, KeyError, TypeError, ValueError):
            self.state.message = "this is no upload"
        self.state.upload = None

    def adopt(self, upload):
        """Show what a visitor has sent, and say what it is or what is wrong with it."""
        content = upload["content"]
        content = b"".join(content if isinstance(content, list) else [content])
        name = os.path.basename(str(upload["name"]))[:80]
        suffix = next((end for end in UPLOADS if name.lower().endswith(end)), None)
        if suffix is None:
            return "%s: one file of %s can be shown" % (name, ", ".join(UPLOADS))
        if len(content) > self.upload_limit:
            return "%s: more than %d MB" % (name, self.upload_limit >> 20)
        problem = find_problem(suffix, content)
        if problem:
            return "%s: %s" % (name, problem)
        # A folder with nothing else in it, under a name of our own.
        with tempfile.TemporaryDirectory(prefix="ffd-upload-") as folder:
            path = os.path.join(folder, "volume" + suffix)
            with open(path, "wb") as file:
                file.write(content)
            try:
                self.load(path)
            except self.editor.Problem as problem:
                return "%s: %s" % (name, str(problem).replace(path, name).replace(folder, ""))
        self.points.SetOutlineBounds(self.image.GetBounds())
        self.points.ClearHistory()
        self.state.update({"shape": "identity", "points": 6, "threshold": 50.0, "opacity": 0.5,
                           "colors": "bone", "deformed": True})
        self.tell_edits()
        return "%s: %d x %d x %d voxels" % (name, *self.image.GetDimensions())

    def undo(self):
        self.points.Undo()

    def redo(self):
        self.points.Redo()

    def reset_lattice(self):
        self.points.ResetAll()
        self.shape = "identity", self.shape[1]
        self.state.shape = "identity"
        self.tell_edits()

    def reset_camera(self):
        self.renderer.ResetCamera()
        self.draw()

    def tell_edits(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        moved = vtk_to_numpy(self.lattice.GetDisplacements())
        self.state.update({"edits": self.points.GetNumberOfUndos(),
                           "moved": round(float(abs(moved).max()), 2)})
        self.state.flush()
        self.draw()

    def screenshot(self):
        from io import BytesIO

        from PIL import Image
        pixels, _, _ = self.window.img_cols_rows
        file = BytesIO()
        Image.fromarray(pixels).save(file, "png")
        return self.server.protocol.addAttachment(file.getvalue())

    # The page

    def build_page(self):
        from trame.ui.vuetify3 import SinglePageWithDrawerLayout
        from trame.widgets import client, html
        from trame.widgets import vuetify3 as v3
        from trame_rca.widgets.rca import RemoteControlledArea

        def slider(name, label, low, high, step):
            v3.VSlider(v_model=(name,), label=label, min=low, max=high, step=step, hide_details=True,
                       density="compact", thumb_label=True, id=name, throttle=100)

        def switch(name, label):
            v3.VSwitch(v_model=(name,), label=label, hide_details=True, density="compact",
                       color="primary", id=name)

        with SinglePageWithDrawerLayout(self.server) as layout:
            layout.title.set_text("vtkFFD lattice editor")
            client.Style("html { overflow-y: hidden; }")
            client.Script(CHECK_UPLOAD)
            with layout.toolbar:
                v3.VSpacer()
                html.Span("{{ message }}", id="message", classes="mr-4")
                html.Span("{{ edits }} edits, moved by {{ moved }}", id="edits", classes="mr-4")
                v3.VBtn("Undo", click=self.undo, id="undo")
                v3.VBtn("Redo", click=self.redo, id="redo")
                v3.VBtn("Screenshot", id="screenshot", click=(
                    "utils.download('volume.png', trigger('screenshot'), 'image/png')"))
            with layout.drawer as drawer:
                drawer.width = 300
                with v3.VCardText():
                    v3.VSelect(v_model=("shape",), items=("shapes", list(SHAPES)), label="Shape",
                               density="compact", id="shape")
                    slider("strength", "Strength", -2, 2, 0.05)
                    slider("points", "Points", 4, 12, 1)
                    v3.VDivider(classes="my-3")
                    slider("threshold", "Threshold", 0, 100, 1)
                    slider("opacity", "Opacity", 0, 1, 0.02)
                    v3.VSelect(v_model=("colors",), items=("palettes", list(COLORS)), label="Colors",
                               density="compact", id="colors")
                    v3.VDivider(classes="my-3")
                    switch("deformed", "Deformed")
                    switch("show_lattice", "Lattice")
                    switch("grab", "Grab the volume")
                    v3.VBtn("Reset the lattice", click=self.reset_lattice, id="reset", block=True,
                            classes="my-1")
                    v3.VBtn("Whole volume", click=self.reset_camera, id="camera", block=True,
                            classes="my-1")
                    v3.VFileInput(model_value=("upload",), label="Your volume", density="compact",
                                  accept=",".join(UPLOADS), id="upload", update_modelValue=(
                                      "upload = utils.uploads.check($event, %d)" % self.upload_limit))
            with layout.content:
                with html.Div(id="view", style="width:100%;height:100%;overflow:hidden"):
                    area = RemoteControlledArea(name="view", display="image", send_mouse_move=True)
                    self.area = area
        self.server.controller.on_server_ready.add(self.on_ready)
        self.server.controller.on_client_connected.add(self.on_page)

        class Nothing:
            def update(self):
                pass
        self.view = Nothing()  # until there is a page

    def on_ready(self, **_):
        self.view = self.area.create_view_handler(self.window, encoder="jpeg", target_fps=20)
        print("session %d" % self.server.port, flush=True)

    def run(self):
        self.server.start(port=0, host="127.0.0.1", open_browser=False, timeout=IDLE,
                          show_connection_info=False)


# ----------------------------------------------------------------------------------------------------
# The front: hands out sessions, and passes on what pages and sessions say to each other.

class NoAddress(Exception):
    """Why the program cannot listen where it is to, in words for the user."""


def describe_problem(host, port, error):
    # asyncio of Python 3.12 and later gives no number where it could not bind any address of the host.
    if isinstance(error, (socket.gaierror, UnicodeError)) or error.errno in (
            errno.EADDRNOTAVAIL, None):
        return "--host %s: this is no name or address of this machine" % host
    if error.errno == errno.EADDRINUSE:
        return "--port %d: it is in use; give another, or 0 for any that is free" % port
    if error.errno == errno.EACCES:
        return "--port %d: this user may not listen there; give one from 1024 on" % port
    return "--host %s --port %d: %s" % (host, port, error.strerror or error)


async def serve(arguments):
    import aiohttp
    from aiohttp import web
    from yarl import URL
    sessions, processes = {}, set()
    stop = asyncio.Event()

    async def watch(key, process):
        async for _ in process.stdout:
            pass
        await process.wait()
        processes.discard(process)
        sessions.pop(key, None)

    async def begin(_):
        if len(sessions) >= arguments.sessions:
            raise web.HTTPServiceUnavailable(text="All places are taken. Try again later.\n")
        key = secrets.token_urlsafe(24)
        sessions[key] = None
        process = await asyncio.create_subprocess_exec(
            sys.executable, os.path.abspath(__file__), arguments.volume, "--session",
            "--upload-limit", str(arguments.upload_limit), stdout=asyncio.subprocess.PIPE)
        processes.add(process)
        if stop.is_set():
            process.kill()
        async for line in process.stdout:
            if line.startswith(b"session "):
                sessions[key] = process, int(line.split()[1])
                request_watch.add(asyncio.create_task(watch(key, process)))
                raise web.HTTPFound("/s/%s/index.html" % key)
        sessions.pop(key)
        processes.discard(process)
        raise web.HTTPInternalServerError(text="The session did not start.\n")

    async def pass_on(request):
        session = sessions.get(request.match_info["key"])
        if session is None:
            raise web.HTTPNotFound(text="There is no such session any more. Open / for a new one.\n")
        path = request.rel_url.raw_path.split("/", 3)[3]
        url = URL("http://127.0.0.1:%d/%s" % (session[1], path), encoded=True)
        if path == "ws":
            return await pass_on_socket(request, url)
        async with client.get(url, allow_redirects=False) as answer:
            headers = {name: answer.headers[name] for name in ("Content-Type", "Cache-Control")
                       if name in answer.headers}
            return web.Response(status=answer.status, body=await answer.read(), headers=headers)

    async def pass_on_socket(request, url):
        page = web.WebSocketResponse(max_msg_size=LARGEST_MESSAGE, heartbeat=30)
        await page.prepare(request)
        async with client.ws_connect(url, max_msg_size=0) as session:
            async def copy(source, target):
                async for message in source:
                    if message.type == aiohttp.WSMsgType.TEXT:
                        await target.send_str(message.data)
                    elif message.type == aiohttp.WSMsgType.BINARY:
                        await target.send_bytes(message.data)
            copies = [asyncio.create_task(copy(page, session)),
                      asyncio.create_task(copy(session, page))]
            await asyncio.wait(copies, return_when=asyncio.FIRST_COMPLETED)
            for task in copies:
                task.cancel()
        await page.close()
        return page

    request_watch = set()
    application = web.Application()
    application.add_routes([web.get("/", begin, allow_head=False),
                            web.get("/s/{key}/{path:.*}", pass_on)])
    runner = web.AppRunner(application)
    await runner.setup()
    site = web.TCPSite(runner, arguments.host, arguments.port)
    async with aiohttp.ClientSession(auto_decompress=True) as client:
        try:
            await site.start()
        except (OSError, UnicodeError) as error:  # UnicodeError: no name at all
            await runner.cleanup()
            raise NoAddress(describe_problem(arguments.host, arguments.port, error)) from None
        print("web_editor: open http://%s:%d/ (Ctrl+C ends it)"
              % (arguments.host, runner.addresses[0][1]), flush=True)
        try:
            asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, stop.set)
        except NotImplementedError:
            pass  # Windows
        try:
            await stop.wait()
        finally:
            stop.set()
            for process in processes:
                if process.returncode is None:
                    process.kill()
            await runner.cleanup()


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("volume", nargs="?", default=DEFAULT_VOLUME)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=8080, help="0: any that is free")
    parser.add_argument("--sessions", type=int, default=8, help="at once, from 1 (default: 8)")
    parser.add_argument("--upload-limit", type=int, default=256,
                        help="MB, from 1 to 4000 (default: 256)")
    parser.add_argument("--session", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.host:
        sys.exit("web_editor: --host: a name or address of this machine; 0.0.0.0 for all of them")
    if not 0 <= arguments.port <= 65535:
        sys.exit("web_editor: --port: from 0, any that is free, to 65535")
    if arguments.sessions < 1:
        sys.exit("web_editor: --sessions: 1 or more at once")
    if not 1 <= arguments.upload_limit <= 4000:
        sys.exit("web_editor: --upload-limit: from 1 to 4000 MB")
    try:
        import trame.ui.vuetify3  # noqa: F401
        import trame_rca.widgets.rca  # noqa: F401
    except ImportError as error:
        sys.exit("web_editor: %s. Install them: pip install trame trame-vuetify trame-rca" % error)
    sys.path.insert(0, HERE)
    import display
    display.require_display("web_editor")
    if arguments.session:
        sys.argv[1:] = []  # trame reads it, too
        Session(arguments.volume, arguments.upload_limit << 20).run()
        return
    import lattice_editor
    try:
        lattice_editor.read_volume(arguments.volume)
    except lattice_editor.Problem as problem:
        sys.exit("web_editor: %s: %s" % (arguments.volume, problem))
    try:
        asyncio.run(serve(arguments))
    except NoAddress as problem:
        sys.exit("web_editor: %s" % problem)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
