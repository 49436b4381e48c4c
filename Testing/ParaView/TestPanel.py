#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's graphical client, played by its own event player: the lattice is dragged in the view
and edited in the panel, applied, undone and traced."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest

PLUGIN = os.environ["FFD_PARAVIEW_PLUGIN"]
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
BASELINE = os.environ["FFD_TEST_BASELINE"]
HERE = os.path.dirname(os.path.abspath(__file__))

WINDOW = "pqClientMainWindow/"
VIEW = WINDOW + ("centralwidget/MultiViewWidget/CoreWidget/qt_tabwidget_stackedwidget/"
                 "MultiViewWidget1/Container/Frame.0/CentralWidgetFrame/Viewport")
PROPERTIES = WINDOW + "propertiesDock/propertiesPanel/"
BROWSER = WINDOW + "pipelineBrowserDock/pipelineBrowser"
PANEL = PROPERTIES + ("scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/"
                      "PropertiesFrame/ProxyPanel/FFDLattice/")


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

    def menu(self, menu, action):
        self.add(WINDOW + "menubar/" + menu, "activate", action)
        self.wait()

    def set(self, widget, kind, value):
        self.add(widget, "set_" + kind, value)
        if kind == "string":
            self.add(widget, "key", "16777220")
        self.wait()

    def wait(self):
        # Auto-apply and the panel wait for the event loop only: timers of zero.
        self.add(VIEW, "pause", "100")

    def play(self, name, auto_apply, baseline=None, options=(), step=1.0):
        """Returns the log of the filter and the Python trace. `options`: more of the command line;
        `step`: pixels from ray to ray."""
        folder = tempfile.mkdtemp(prefix="panel.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        script = os.path.join(folder, name + ".xml")
        log = os.path.join(folder, "log")
        trace = os.path.join(folder, "trace")
        with open(script, "w", encoding="ascii") as file:
            file.write('<?xml version="1.0" ?>\n<pqevents>\n%s\n</pqevents>\n'
                       % "\n".join(self.lines))
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
                 "FFD_PANEL_STEP": str(step)})
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


def moved(state):
    """Indices of the control points that are displaced."""
    values = state["displacements"]
    return [i // 3 for i in range(0, len(values), 3) if any(values[i:i + 3])]


MIDDLE = 2 + 5 * (2 + 5 * 2)


class TestPanel(unittest.TestCase):
    def test_apply_and_undo(self):
        """A drag waits for Apply; undo and redo are ParaView's; the picture is the known one."""
        events = Events()
        events.drag((0.5, 0.5), (0.55, 0.4), (0.6, 0.3))
        events.click(PROPERTIES + "Accept")
        events.menu("menu_Edit", "actionEditUndo")
        events.menu("menu_Edit", "actionEditRedo")
        states, trace = events.play(
            "apply", auto_apply=False, baseline=os.path.join(BASELINE, "ParaView.TestPanel.png"))
        # Had the drag been applied by itself there would be more.
        self.assertEqual([moved(state) for state in states], [[MIDDLE], [], [MIDDLE]])
        self.assertEqual(states[1]["displacements"], [])
        self.assertEqual(states[0], states[2])
        self.assertEqual(states[0]["volumes"], 1)
        # Up and to the right, as the mouse.
        x, y, z = states[0]["displacements"][3 * MIDDLE:3 * MIDDLE + 3]
        self.assertGreater(z, 5.0)
        self.assertGreater(y - x, 10.0)
        self.assertIn("Displacements = [0.0, ", trace)

    def test_server(self):
        """The client of a server of two processes, which alone have the volume: the same drag, Apply
        and picture."""
        port = 21000 + os.getpid() % 9000
        with subprocess.Popen(
                ["mpiexec", "-np", "2", "pvserver", "--server-port=%d" % port],
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                env={**os.environ, "PV_PLUGIN_PATH": os.path.dirname(PLUGIN)}) as server:
            try:
                for line in server.stdout:
                    if "Accepting" in line:
                        break
                events = Events()
                events.drag((0.5, 0.5), (0.55, 0.4), (0.6, 0.3))
                events.click(PROPERTIES + "Accept")
                states, _ = events.play(
                    "server", auto_apply=False,
                    baseline=os.path.join(BASELINE, "ParaView.TestPanel.png"),
                    # Frames long enough to tell their progress, which the client must not get.
                    options=["--server-url=cs://localhost:%d" % port], step=0.5)
            finally:
                server.terminate()
        self.assertEqual([moved(state) for state in states], [[MIDDLE]])
        self.assertEqual(states[0]["widget"]["Visible"], 1)
        self.assertEqual(states[0]["volumes"], 0)

    def test_reset(self):
        """Reset takes a drag back that was not applied; the next Apply has nothing of it."""
        events = Events()
        events.drag((0.5, 0.5), (0.6, 0.3))
        events.click(PROPERTIES + "Reset")
        events.set(PANEL + "Resolution_0", "int", "6")
        events.click(PROPERTIES + "Accept")
        states, _ = events.play("reset", auto_apply=False)
        self.assertEqual(states[-1]["resolution"], [6, 5, 5])
        self.assertEqual(states[-1]["displacements"], [])

    def test_live(self):
        """With auto-apply the filter follows a drag, which is one step for undo and trace; after
        a look at another source, too."""
        events = Events()
        for source in ("/0/0|0", "/0/0/0|0"):
            events.add(BROWSER, "currentChanged", source)
            events.wait()
        events.drag((0.5, 0.5), (0.55, 0.4), (0.6, 0.3))
        events.menu("menu_Edit", "actionEditUndo")
        events.menu("menu_Edit", "actionEditRedo")
        states, trace = events.play("live", auto_apply=True)
        heights = [state["displacements"][3 * MIDDLE + 2] if state["displacements"] else 0.0
                   for state in states]
        dragged = max(heights)
        self.assertTrue(any(0.3 * dragged < height < 0.7 * dragged for height in heights), heights)
        self.assertEqual(heights[-3:], [dragged, 0.0, dragged])
        self.assertEqual(trace.count("Displacements ="), 1)

    def test_controls(self):
        """Resolution, refinement, numeric entry, options and reset."""
        events = Events()
        events.drag((0.5, 0.5), (0.6, 0.3))
        events.set(PANEL + "Resolution_0", "int", "7")
        events.click(PANEL + "Refine")
        events.click(PANEL + "SelectAll")
        events.set(PANEL + "Center_2", "string", "5")
        events.click(PANEL + "ResetLattice")
        events.set(PANEL + "Resolution_0", "int", "5")
        events.set(PANEL + "Resolution_1", "int", "5")
        events.set(PANEL + "Resolution_2", "int", "5")
        events.click(PANEL + "SelectNone")
        events.set(PANEL + "Constraint", "string", "Z axis")
        events.set(PANEL + "SymmetryX", "boolean", "true")
        events.drag((0.5, 0.5), (0.6, 0.3))
        events.click(PANEL + "ResetSelected")
        events.set(PANEL + "Constraint", "string", "Free")
        events.set(PANEL + "SoftEditing", "boolean", "true")
        events.drag((0.5, 0.5), (0.6, 0.3))
        states, _ = events.play("controls", auto_apply=True)

        # Another resolution keeps the edits, which stay those of the old one until the next edit.
        drag = states[0]["displacements"]
        finer = [s for s in states if s["resolution"] == [7, 5, 5]][-1]
        refined = [s for s in states if s["resolution"] == [11, 7, 7]]
        for state in (finer, refined[0]):
            self.assertEqual(state["displacements_resolution"], [5, 5, 5])
            self.assertEqual(state["displacements"], drag)
        shifted = [s for s in refined if len(s["displacements"]) == 3 * 11 * 7 * 7][-1]
        self.assertEqual(shifted["displacements_resolution"], [0, 0, 0])
        # All control points moved by as much; those at the edge were at rest.
        shift = shifted["displacements"][:3]
        self.assertAlmostEqual(shift[0], 0.0, places=9)
        self.assertNotAlmostEqual(shift[2], 0.0, places=1)
        heights = shifted["displacements"][2::3]
        self.assertAlmostEqual(sum(heights) / len(heights), 5.0, places=6)
        self.assertEqual(refined[-1]["displacements"], [])
        # Constrained to z.
        rest = states[states.index(refined[-1]) + 1:]
        constrained = [s for s in rest if moved(s) == [MIDDLE]][-1]
        self.assertEqual(constrained["displacements"][3 * MIDDLE:3 * MIDDLE + 2], [0.0, 0.0])
        self.assertGreater(constrained["displacements"][3 * MIDDLE + 2], 5.0)
        # The neighbours follow; the mirrored edit of the middle keeps it in the mid-plane.
        soft = rest[-1]
        self.assertGreater(len(moved(soft)), 6)
        self.assertAlmostEqual(soft["displacements"][3 * MIDDLE], 0.0, places=9)

    def test_options(self):
        """Options of editing do what they say; those of the display reach the widget."""
        middle = 3 + 7 * (3 + 7 * 3)
        near = ((0.5, 0.5), (0.53, 0.45), (0.55, 0.4))
        far = ((0.5, 0.5), (0.55, 0.4), (0.65, 0.2))
        events = Events()
        for axis in range(3):
            events.set(PANEL + "Resolution_%d" % axis, "int", "7")

        def drag(*places):
            events.drag(*places)
            events.click(PANEL + "ResetLattice")

        # Control points are 7.5 apart.
        events.set(PANEL + "SoftEditing", "boolean", "true")
        events.set(PANEL + "SoftRadius", "string", "8")
        drag(*near)
        events.set(PANEL + "SoftRadius", "string", "11")
        drag(*near)
        events.set(PANEL + "Falloff", "string", "Constant")
        drag(*near)
        events.set(PANEL + "LockBoundary", "boolean", "true")
        drag(*near)
        events.set(PANEL + "LockBoundary", "boolean", "false")
        events.set(PANEL + "SoftEditing", "boolean", "false")
        drag(*far)
        events.set(PANEL + "FoldGuard", "string", "Stop Edits")
        drag(*far)
        events.set(PANEL + "FoldGuard", "string", "Warn")
        drag(*far)

        # The selected control point is the line of the table.
        def move(height):
            events.add(PANEL + "Points", "editAccepted", "0.2,%g" % height)
            events.wait()

        events.set(PANEL + "Handle", "string", "Turn")
        move(1)
        events.set(PANEL + "Handle", "string", "Scale")
        events.set(PANEL + "InteriorPoints", "boolean", "false")
        move(2)
        events.set(PANEL + "Handle", "string", "None")
        events.set(PANEL + "CurvedLines", "boolean", "true")
        move(3)
        # What is hidden is not dragged.
        events.set(PANEL + "InteriorPoints", "boolean", "true")
        events.set(PANEL + "show3DWidget", "boolean", "false")
        events.drag(*near)
        move(4)
        events.set(PANEL + "show3DWidget", "boolean", "true")
        move(5)
        states, _ = events.play("options", auto_apply=True)

        # The last state before each reset is that of the drag; then those of the table.
        drags, rest = [], states
        for _ in range(7):
            reset = next(i for i, state in enumerate(rest) if i and not moved(state)
                         and moved(rest[i - 1]))
            drags.append(rest[reset - 1])
            rest = rest[reset + 1:]
        self.assertEqual([len(moved(state)) for state in drags], [7, 19, 19, 1, 1, 1, 1])
        sizes = [[sum(x * x for x in state["displacements"][3 * i:3 * i + 3]) ** 0.5
                  for i in moved(state)] for state in drags]
        self.assertLess(sizes[0][0], 0.5 * max(sizes[0]))
        self.assertLess(sizes[1][0], 0.5 * max(sizes[1]))
        self.assertAlmostEqual(min(sizes[2]), max(sizes[2]), places=6)
        self.assertEqual(moved(drags[3]), [middle])
        self.assertLess(sizes[5][0], 0.9 * sizes[4][0])
        self.assertAlmostEqual(sizes[6][0], sizes[4][0], places=6)
        self.assertEqual([state["widget"]["FoldGuard"] for state in drags[4:]], [0, 1, 2])

        table = {}
        while not moved(rest[0]):
            rest.pop(0)
        for state in rest:
            self.assertEqual(moved(state), [middle])
            x, y, z = state["displacements"][3 * middle:3 * middle + 3]
            self.assertEqual((x, y), (0.0, 0.0))
            table[round(z, 9)] = state["widget"]
        self.assertEqual(sorted(table), [1, 2, 3, 4, 5])
        for height, handle, interior, curved, visible in (
                (1, 2, 1, 0, 1), (2, 3, 0, 0, 1), (3, 0, 0, 1, 1), (4, 0, 1, 1, 0),
                (5, 0, 1, 1, 1)):
            self.assertEqual(
                [table[height][name] for name in
                 ("HandleMode", "InteriorVisibility", "LineMode", "Visible")],
                [handle, interior, curved, visible], height)


if __name__ == "__main__":
    unittest.main()
