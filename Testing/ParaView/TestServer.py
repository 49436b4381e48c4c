#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A client and a server of two processes give the picture of one process; the volume stays on the
server."""

import contextlib
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import servermanager, simple

import ffdlink
import ffdparaview as ffd
import ffdprocess

ffd.load()


def show(view):
    lattice = simple.FFDLattice(Input=ffd.make_wavelet(), Shape="Twist", Strength=1.5)
    simple.Show(lattice, view)
    ffd.set_functions()
    return lattice


def show_blocks(view):
    """A volume with a lattice for each block, and a surface that comes after it."""
    wavelet = ffd.make_wavelet()
    ends = ((-15, -3), (3, 15))
    blocks = [simple.ExtractSubset(Input=wavelet, VOI=[*x, *y, *z])
              for x in ends for y in ends for z in ends]
    lattice = simple.FFDLattice(
        Input=simple.GroupDatasets(Input=blocks), Shape="Bend", Strength=0.7, LatticePerBlock=1)
    simple.Show(lattice, view)
    ffd.set_functions(opaque=True)
    simple.Render(view)
    simple.Show(simple.Sphere(Radius=4.0, Center=[0.0, -30.0, 10.0]), view)
    simple.Render(view)


def find_places(view, pixels=((80, 70), (70, 85), (92, 62))):
    """Where the key P would put a point, for some pixels."""
    places = []
    for pixel in pixels:
        place, normal = [0.0] * 3, [0.0] * 3
        if not view.SMProxy.ConvertDisplayToPointOnSurface(list(pixel), place, normal):
            raise AssertionError("Nothing is picked at %r." % (pixel,))
        places.append(place)
    return places


@contextlib.contextmanager
def serve(port, *command, **environment):
    """Runs a server that accepts a client at a port; at the end the client is its own server again."""
    server = subprocess.Popen(
        [*command, "pvserver", "--server-port=%d" % port],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, **environment})
    try:
        for line in server.stdout:
            if "Accepting" in line:
                break
        simple.Disconnect()
        yield
    finally:
        simple.Disconnect()
        ffdprocess.stop(server)
        server.stdout.close()
        simple.Connect()
        ffd.load()


class TestServer(unittest.TestCase):
    def test_two_processes(self):
        view = ffd.make_view()
        show(view)
        local = ffd.picture(view, "local")
        places = find_places(view)
        port = ffdprocess.find_port()
        with serve(port, "mpiexec", "-np", "2"):
            simple.Connect("localhost", port)
            ffd.load(remote=True)
            view = ffd.make_view()
            lattice = show(view)
            remote = ffd.picture(view, "remote")
            self.assertEqual(
                servermanager.ActiveConnection.GetNumberOfDataPartitions(), 2)
            self.assertLess(np.abs(remote - local).mean(), 0.5)
            self.assertLessEqual(ffd.differ(remote, local)[0], 8)
            # Places below the pointer, of voxels of one of the processes.
            np.testing.assert_allclose(find_places(view), places, atol=0.02)
            # An edit comes through.
            lattice.Strength = 0.2
            self.assertGreater(
                np.abs(ffd.picture(view, "edited") - remote).mean(), 1.0)
            # So do edits of a volume beyond the LOD threshold while the scene moves.
            view.LODThreshold = 0.0
            view.LODResolution = 1.0
            simple.GetDisplayProperties(lattice, view).FFDAdaptInteractiveQuality = 0
            lattice.Strength = 1.5
            # Such pictures are sent with fewer bits.
            self.assertLess(ffd.differ(ffd.moving_picture(view), local)[1], 2.0)

    def test_blocks(self):
        """Blocks of a volume are picked on a server as here, and so is what comes after them."""
        pixels = ((80, 70), (70, 85), (60, 60), (105, 60), (19, 109))

        def find():
            view = ffd.make_view()
            show_blocks(view)
            clicked = [servermanager._getPyProxy(view.SMProxy.Pick(*pixel)).Input.GetXMLName()
                       for pixel in pixels]
            self.assertEqual(clicked, ["FFDLattice"] * 4 + ["SphereSource"])
            return find_places(view, pixels)

        here = find()
        port = ffdprocess.find_port()
        with serve(port):
            simple.Connect("localhost", port)
            ffd.load(remote=True)
            np.testing.assert_allclose(find(), here, atol=0.02)

    def test_other_version(self):
        """A server with another version of the plugin: one message, which names both, and begins so
        where ParaView's list of messages shows it, which leaves out what is before the first colon."""
        folder = tempfile.mkdtemp(prefix="version.", dir=ffd.TEMPORARY)
        with open(ffd.PLUGIN, "rb") as library:
            content = library.read()
        self.assertIn(b"0.1.0\0", content)
        copy = os.path.join(folder, "FFDVolume.so")
        with open(copy, "wb") as library:
            library.write(content.replace(b"0.1.0\0", b"0.0.9\0"))
        port = ffdprocess.find_port()
        with serve(port, PV_PLUGIN_PATH=""):
            simple.Connect("localhost", port)
            simple.LoadPlugin(copy, remote=True, ns=vars(simple))
            ffd.load()
            with ffd.Errors(event="WarningEvent") as warnings:
                view = ffd.make_view()
                show(view)
                ffd.picture(view, "other version")
            told = [text for text in warnings.text if "0.0.9" in text]
            self.assertEqual(len(told), 1, warnings.text)
            self.assertIn("0.1.0", told[0])
            shown = re.fullmatch(r"[\w ]+: In .*, line \d+\n[^:]*:(.*)", told[0].strip(), re.DOTALL)
            self.assertTrue(shown.group(1).startswith(" The plugin FFDVolume is of version"), told)

    def test_slow_link(self):
        """50 ms and 20 Mbit/s away: an edit sends the control points, and no voxels come."""
        sent = {}
        for size in (5, 9):
            port = ffdprocess.find_port()
            with serve(port, PV_PLUGIN_PATH=os.path.dirname(ffd.PLUGIN)):
                with ffdlink.SlowLink(port) as link:
                    simple.Connect("localhost", link.port)
                    ffd.load()
                    view = ffd.make_view()
                    lattice = simple.FFDLattice(Input=ffd.make_wavelet(60), Resolution=[size] * 3)
                    simple.Show(lattice, view)
                    ffd.set_functions()
                    simple.Render(view)
                    points = [0.0] * 3 * size ** 3
                    before = link.count()
                    for step in range(4):
                        points[3 * (size ** 3 // 2) + 2] = 2.0 + step
                        lattice.Displacements = points
                        simple.Render(view)
                    sent[size], received = [
                        (b - a) / 4 for a, b in zip(before, link.count())]
                    sys.stdout.write(
                        "%d^3 control points (%d bytes): an edit sends %d bytes and gets %d\n"
                        % (size, 8 * len(points), sent[size], received))
                    # A picture of 160 x 140 pixels, and what ParaView asks for; voxels are 7 MB.
                    self.assertLess(received, 400e3)
                    self.assertGreater(sent[size], 8 * len(points))
                    simple.Disconnect()
        # What is sent besides the control points is the same.
        numbers = 8 * 3 * (9 ** 3 - 5 ** 3)
        self.assertLess(sent[9] - sent[5], 3 * numbers)
        self.assertLess(sent[5], 60e3)


if __name__ == "__main__":
    unittest.main()
