#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Examples/paraview.sh, and loading the plugin by hand on client and server, as the documentation says."""

import glob
import os
import subprocess
import tempfile
import time
import unittest

import ffdprocess
from ffdevents import PROPERTIES, Events

PLUGIN = os.environ["FFD_PARAVIEW_PLUGIN"]
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
DATA = os.environ["FFD_TEST_DATA"]
BASELINE = os.environ["FFD_TEST_BASELINE"]
SOURCE = os.path.dirname(os.environ["FFD_PARAVIEW_SOURCE"])
START = os.path.join(SOURCE, "Examples", "paraview.sh")

SCRIPT = """
import sys
from paraview.simple import *
lattice = FFDLattice(Input=OpenDataFile(sys.argv[1]), Shape="Twist")
view = CreateView("RenderView")
print("SHOWN", Show(lattice, view).Representation)
Render(view)
print("PROCESSES", servermanager.ActiveConnection.GetNumberOfDataPartitions())
"""

CLIENT = """
import sys
from paraview import simple
simple.Connect("localhost", int(sys.argv[1]))
view = simple.CreateView("RenderView")
wavelet = simple.Wavelet(WholeExtent=[-8, 8] * 3)
older = simple.Slice(Input=wavelet)
simple.Show(older, view)
for plugin in sys.argv[2:]:
    simple.LoadPlugin(plugin, remote=True, ns=vars(simple))
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
lattice = simple.FFDLattice(Input=wavelet, Shape="Twist")
print("SHOWN", simple.Show(lattice, view).Representation)
simple.Render(view)
simple.Hide(lattice, view)
older.Input = lattice
simple.Render(view)
print("FOLLOWS", view.SMProxy.GetRenderer().ComputeVisiblePropBounds()[1] > 1.0)
"""


OPEN = """
import sys
from paraview import simple
simple.Connect("localhost", int(sys.argv[1]))
with open(sys.argv[2]) as file:
    exec(file.read())
print("SHOWN", sorted(name for name, number in simple.GetSources()))
"""


def without_modules():
    """The environment of a user, who knows nothing of the folders of the build."""
    return {name: value for name, value in os.environ.items()
            if name not in ("PYTHONPATH", "PV_PLUGIN_PATH", "LD_PRELOAD", "OMPI_ALLOW_RUN_AS_ROOT",
                            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM")}


class TestStart(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="start.", dir=TEMPORARY)
        os.chmod(self.folder, 0o700)
        self.environment = {
            **without_modules(), "FFD_SKIP_BUILD": "1", "HOME": self.folder,
            "XDG_RUNTIME_DIR": self.folder}

    def script(self, text):
        path = os.path.join(self.folder, "script.py")
        with open(path, "w", encoding="ascii") as file:
            file.write(text)
        return path

    def start(self, *arguments, **environment):
        result = subprocess.run(
            [START, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            check=False, env={**self.environment, **environment})
        self.assertEqual(result.returncode, 0, result.stdout)
        for word in ("ERR|", "ERROR:", "Warning:"):
            self.assertNotIn(word, result.stdout)
        return result.stdout

    def test_samples_are_readable(self):
        """Raw data are what ParaView 5.11 cannot read with newer versions of expat."""
        samples = glob.glob(os.path.join(DATA, "*.vti"))
        self.assertGreaterEqual(len(samples), 7)
        for name in samples:
            with open(name, "rb") as file:
                head = file.read(2000)
            self.assertIn(b'format="binary"', head, name)
            self.assertNotIn(b'format="appended"', head, name)

    def test_python(self):
        """pvpython and pvbatch, without a display, and with several processes."""
        script = self.script(SCRIPT)
        volume = os.path.join(DATA, "nucleon.vti")
        for command, processes in ((["pvpython"], 1), (["pvbatch"], 1), (["-n", "2", "pvbatch"], 2)):
            text = self.start(*command, script, volume, DISPLAY="")
            self.assertIn("SHOWN 'FFD Volume'", text)
            self.assertIn("PROCESSES %d\n" % processes, text)

    def test_window(self):
        """The volume is open with a lattice; a twist is applied by hand. A script of Python
        makes the scene."""
        events = Events()
        events.set(PROPERTIES + "scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/"
                   "PropertiesFrame/ProxyPanel/Shape/ComboBox", "string", "Twist")
        events.click(PROPERTIES + "Accept")
        self.start(os.path.join(DATA, "nucleon.vti"), "--dr", "--test-directory=" + self.folder,
                   "--test-script=" + events.write(os.path.join(self.folder, "start.xml")),
                   "--test-baseline=" + os.path.join(BASELINE, "ParaView.TestStart.png"),
                   "--test-threshold=10", "--exit")

    def connect(self, server, *arguments, script=CLIENT, **environment):
        """A client of a server, which is stopped at the end; returns the client's output."""
        port = ffdprocess.find_port()
        with subprocess.Popen(
                [*server, "--server-port=%d" % port], stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, text=True, env=self.environment) as process:
            try:
                for line in process.stdout:
                    if "Accepting" in line:
                        break
                return self.start("pvpython", self.script(script), str(port), *arguments, **environment)
            finally:
                ffdprocess.stop(process)

    def test_window_of_server_without_plugin(self):
        """ParaView's window says so, once, and what to do."""
        port = ffdprocess.find_port()
        path = os.path.join(self.folder, "output")
        with open(path, "w", encoding="utf-8") as output, subprocess.Popen(
                ["pvserver", "--server-port=%d" % port], stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, text=True, env=self.environment) as server:
            try:
                for line in server.stdout:
                    if "Accepting" in line:
                        break
                with subprocess.Popen(
                        ["paraview", "--dr", "--server-url=cs://localhost:%d" % port], stdout=output,
                        stderr=subprocess.STDOUT,
                        env={**self.environment, "PV_PLUGIN_PATH": os.path.dirname(PLUGIN)}) as window:
                    try:
                        text = self.wait_for(path, "WARN|")
                    finally:
                        window.kill()
            finally:
                ffdprocess.stop(server)
        for words in ("The server has no plugin FFDVolume", "Manage Plugins"):
            self.assertEqual(text.count(words), 1, text)
        self.assertEqual(text.count("|"), 1, text)

    def wait_for(self, path, words):
        """Until a file has the words, and some seconds more; returns what is in it."""
        end = time.monotonic() + 1000.0
        while time.monotonic() < end:
            with open(path, encoding="utf-8") as file:
                if words in file.read():
                    break
            time.sleep(0.5)
        time.sleep(3.0)
        with open(path, encoding="utf-8") as file:
            return file.read()

    def test_client_and_server(self):
        """Client and server that have the plugin from their start: there is nothing to load."""
        self.assertIn("SHOWN 'FFD Volume'", self.connect([START, "pvserver"]))

    def test_volume_on_server(self):
        """paraview.sh opens the volume on a server, too; without a lattice if that has no plugin."""
        for server, shown in (([START, "pvserver"], "SHOWN ['FFD Lattice', 'nucleon.vti']"),
                              (["pvserver"], "SHOWN ['nucleon.vti']")):
            text = self.connect(
                server, os.path.join(SOURCE, "Examples", "Python", "paraview_volume.py"), script=OPEN,
                FFD_PARAVIEW_VOLUME=os.path.join(DATA, "nucleon.vti"))
            self.assertIn(shown, text)

    def test_server_without_plugin(self):
        """The client loads the plugin there. A slice that was shown before follows a lattice, too."""
        text = self.connect(["pvserver"], PLUGIN)
        self.assertIn("SHOWN 'FFD Volume'", text)
        self.assertIn("FOLLOWS True", text)


if __name__ == "__main__":
    unittest.main()
