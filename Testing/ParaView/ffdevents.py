# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Events for the event player of ParaView's graphical client, and the names of its widgets."""

import json
import os
import shutil
import subprocess
import tempfile

PLUGIN = os.environ["FFD_PARAVIEW_PLUGIN"]
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
HERE = os.path.dirname(os.path.abspath(__file__))

WINDOW = "pqClientMainWindow/"
VIEW = WINDOW + ("centralwidget/MultiViewWidget/CoreWidget/qt_tabwidget_stackedwidget/"
                 "MultiViewWidget1/Container/Frame.0/CentralWidgetFrame/Viewport")
PROPERTIES = WINDOW + "propertiesDock/propertiesPanel/"
BROWSER = WINDOW + "pipelineBrowserDock/pipelineBrowser"
PANEL = PROPERTIES + ("scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/"
                      "PropertiesFrame/ProxyPanel/FFDLattice/Controls/")
SELECTION = PANEL + "SelectionGroup/"
EDITING = PANEL + "EditingGroup/"
DISPLAY = PANEL + "DisplayGroup/"


def write_translation(folder):
    """A transform file, in the folder; returns its path. It maps fixed points to moving ones, by the
    vector (3, -7, 11): a volume is moved by the opposite."""
    path = os.path.join(folder, "shift.tfm")
    with open(path, "w", encoding="ascii") as file:
        file.write("#Insight Transform File V1.0\n#Transform 0\n"
                   "Transform: TranslationTransform_double_3_3\nParameters: 3 -7 11\n"
                   "FixedParameters:\n")
    return path


class Events:
    """Events for ParaView's player."""

    def __init__(self):
        self.lines = []

    def add(self, target, command, arguments=""):
        self.lines.append('<pqevent object="%s" command="%s" arguments="%s"/>'
                          % (target, command, arguments))

    def drag(self, *places):
        """With the left button, from place to place; (0, 0) to (1, 1), from the top left."""
        self.add(VIEW, "mousePress", "(%g,%g,1,1,0)" % places[0])
        for place in places[1:]:
            self.add(VIEW, "mouseMove", "(%g,%g,0,1,0)" % place)
        self.add(VIEW, "mouseRelease", "(%g,%g,1,0,0)" % places[-1])
        self.wait()

    def click(self, button):
        self.add(button, "activate")
        self.wait()

    def toggle(self, group):
        """Open or close a part of the lattice's panel."""
        self.add(group.rstrip("/") + "Toggle", "set_boolean", "true")
        self.wait()

    def menu(self, menu, action):
        self.add(WINDOW + "menubar/" + menu, "activate", action)
        self.wait()

    def set(self, widget, kind, value):
        self.add(widget, "set_" + kind, value)
        if kind == "string":
            self.add(widget, "key", "16777220")
        self.wait()

    def check(self, target, name, value):
        """A property of a widget (text, visible, ...) has this value; else ParaView ends with an error."""
        self.lines.append('<pqcheck object="%s" property="%s" arguments="%s"/>' % (target, name, value))

    def wait(self):
        # Auto-apply and the panel wait for the event loop only: timers of zero. The player finds the window
        # sooner than what is in it.
        self.add(WINDOW.rstrip("/"), "pause", "100")

    def write(self, path):
        """Write the events into a file; returns its path."""
        with open(path, "w", encoding="ascii") as file:
            file.write('<?xml version="1.0" ?>\n<pqevents>\n%s\n</pqevents>\n'
                       % "\n".join(self.lines))
        return path

    def play(self, name, auto_apply, baseline=None, options=(), step=1.0, blocks=False):
        """Returns the log of the filter and the Python trace. `options`: more of the command line;
        `step`: pixels from ray to ray; `blocks`: of the volume, which have a lattice each."""
        folder = tempfile.mkdtemp(prefix="panel.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        script = self.write(os.path.join(folder, name + ".xml"))
        log = os.path.join(folder, "log")
        trace = os.path.join(folder, "trace")
        command = ["paraview", "--dr", *options, "--script=" + os.path.join(HERE, "PanelScene.py"),
                   "--test-directory=" + folder, "--test-script=" + script]
        if baseline:
            command += ["--test-baseline=" + baseline, "--test-threshold=10"]
        command.append("--exit")
        result = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
            env={**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder,
                 "PV_PLUGIN_PATH": os.path.dirname(PLUGIN), "FFD_PANEL_LOG": log,
                 "FFD_PANEL_TRACE": trace, "FFD_PANEL_AUTO_APPLY": str(int(auto_apply)),
                 "FFD_PANEL_STEP": str(step), "FFD_PANEL_BLOCKS": str(int(blocks)),
                 "FFD_PANEL_FXAA": str(int(baseline is not None))})
        for image in os.listdir(folder):
            if image.endswith(".png"):
                shutil.copy(os.path.join(folder, image), TEMPORARY)
        if result.returncode != 0:
            raise AssertionError("ParaView ended with %d:\n%s" % (result.returncode, result.stdout))
        for word in ("ERR|", "ERROR:", "Warning:"):
            if word in result.stdout:
                raise AssertionError("ParaView complained:\n" + result.stdout)
        with open(log, encoding="ascii") as file:
            states = [json.loads(line) for line in file]
        with open(trace, encoding="utf-8") as file:
            return states, file.read()
