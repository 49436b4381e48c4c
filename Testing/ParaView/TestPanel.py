#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's graphical client, played by its own event player: the lattice is dragged in the view
and edited in the panel, applied, undone and traced."""

import json
import contextlib
import os
import sqlite3
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import ffdlink
import ffdprocess
from ffdevents import (
    BROWSER, DISPLAY, EDITING, HERE, PANEL, PLUGIN, PROPERTIES, SELECTION, TEMPORARY, VIEW, WINDOW,
    Events, write_translation)

BASELINE = os.environ["FFD_TEST_BASELINE"]

def moved(state):
    """Indices of the control points that are displaced."""
    values = state["displacements"]
    return [i // 3 for i in range(0, len(values), 3) if any(values[i:i + 3])]


def find_environment(folder, **variables):
    """Of a ParaView that keeps its settings in a folder and finds the plugin."""
    return {**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder,
            "PV_PLUGIN_PATH": os.path.dirname(PLUGIN), **variables}


def find_command(scene, folder, events, *options):
    """Of a ParaView that runs a script, plays the events and ends."""
    return ["paraview", "--dr", *options, "--script=" + os.path.join(HERE, scene),
            "--test-directory=" + folder,
            "--test-script=" + events.write(os.path.join(folder, "events.xml")), "--exit"]


def play(command, environment):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False, env=environment)


MIDDLE = 2 + 5 * (2 + 5 * 2)
SCALE = PROPERTIES + ("scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/PropertiesFrame/ProxyPanel/"
                      "DisplacementScale/DoubleRangeWidget/DoubleLineEdit")
OPACITY = SCALE.replace("PropertiesFrame", "DisplayFrame").replace("DisplacementScale", "Opacity")


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
        port = ffdprocess.find_port()
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
                ffdprocess.stop(server)
        self.assertEqual([moved(state) for state in states], [[MIDDLE]])
        self.assertEqual(states[0]["widget"]["Visible"], 1)
        self.assertEqual(states[0]["volumes"], 0)

    def test_before_apply(self):
        """What is not applied yet. Control and Z take back a drag, and shift, or ParaView's control and Y,
        brings it again, while what is typed into the search box hides the panel of the lattice, and not the
        lattice; not while the mouse button is down. Reset takes back a drag. The search box finds the lattice's
        controls by their names, and opens the part where they are until it is something else; tooltips are
        those of the controls. A lattice that the user has hidden stays so."""
        control, shift = 0x04000000, 0x02000000
        rest, half, whole = (0.5, 0.5), (0.55, 0.4), (0.6, 0.3)
        events = Events()

        def type_words(words):
            events.set(PROPERTIES + "SearchBox/SearchLineEdit", "string", words)

        def strike(modifiers, key="Z"):
            events.add(VIEW, "keyEvent", "6:%d:%d:%s:0:1" % (ord(key), modifiers, key.lower()))
            events.wait()

        type_words("strength")
        events.drag(rest, whole)
        events.drag(whole, half)
        events.click(PROPERTIES + "Accept")
        events.drag(half, whole)
        events.drag(whole, rest)
        strike(control)
        events.click(PROPERTIES + "Accept")
        events.drag(whole, half)
        strike(control)
        strike(control | shift)
        events.click(PROPERTIES + "Accept")
        events.drag(half, whole)
        strike(control)
        strike(control, "Y")
        events.click(PROPERTIES + "Accept")
        # While the mouse button is down, and after it.
        events.drag(whole, rest)
        events.add(VIEW, "mousePress", "(%g,%g,1,1,0)" % rest)
        events.add(VIEW, "mouseMove", "(%g,%g,0,1,0)" % half)
        strike(control)
        events.add(VIEW, "mouseRelease", "(%g,%g,1,0,0)" % half)
        events.wait()
        events.click(PROPERTIES + "Accept")
        events.drag(half, whole)
        strike(control)
        events.drag(half, whole)
        events.click(PROPERTIES + "Accept")
        # The next Apply has nothing of what was reset.
        type_words("")
        events.drag(whole, rest)
        events.click(PROPERTIES + "Reset")
        events.set(PANEL + "Resolution_0", "int", "6")
        events.click(PROPERTIES + "Accept")

        def search(words, found, opened=None):
            type_words(words)
            events.check(PANEL + "Refine", "visible", str(found).lower())
            for group in (SELECTION, EDITING, DISPLAY):
                events.check(group.rstrip("/"), "visible", str(group == opened).lower())

        search("refine", True)
        search("resolution", True)
        search("symmetry", True, EDITING)
        search("strength", False)
        search("fold guard", True, EDITING)
        search("curved", True, DISPLAY)
        search("selected", True, SELECTION)
        # What the user has opened stays open.
        type_words("")
        events.toggle(DISPLAY)
        search("curved", True, DISPLAY)
        events.set(PANEL + "show3DWidget", "boolean", "false")
        search("strength", False)
        search("resolution", True, DISPLAY)
        events.check(PANEL + "show3DWidget", "checked", "false")
        events.set(PANEL + "Resolution_0", "int", "7")
        events.click(PROPERTIES + "Accept")
        states, _ = events.play("before", auto_apply=False)
        self.assertEqual(len(states), 8, states)
        heights = [state["displacements"][3 * MIDDLE + 2] for state in states[:6]]
        for height, expected in zip(heights, (0.5, 1.0, 0.5, 1.0, 0.5, 1.0)):
            self.assertAlmostEqual(height, 17.7 * expected, delta=1.0, msg=heights)
        dragged, reset, searched = states[5:]
        self.assertEqual(reset["resolution"], [6, 5, 5])
        self.assertEqual(reset["displacements"], dragged["displacements"])
        self.assertEqual(reset["widget"]["Visible"], 1)
        self.assertEqual(searched["resolution"], [7, 5, 5])
        self.assertEqual(searched["widget"]["Visible"], 0)
        # That of what the lattice deforms: of the volume; see test_outline.
        self.assertEqual(searched["widget"]["OutlineBounds"], [-15.0, 15.0] * 3)

    def test_outline(self):
        """The outline is that of the block that the lattice deforms. Another resolution, also that of ParaView's
        Restore Defaults, and its undo keep edits, those of a script as well as those of the panel."""
        events = Events()
        restore = PROPERTIES + ("scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/"
                                "PropertiesButtons/PropertiesRestoreDefaults")
        for size in "67":
            events.set(PANEL + "Resolution_0", "int", size)
            events.click(PROPERTIES + "Accept")
        events.click(restore)
        # Rendered again, which updates the filter.
        events.drag((0.02, 0.02), (0.02, 0.02))
        events.menu("menu_Edit", "actionEditUndo")
        events.drag((0.02, 0.02), (0.02, 0.02))
        events.toggle(SELECTION)
        events.click(SELECTION + "SelectAll")
        events.set(SELECTION + "Center_2", "string", "5")
        events.click(PROPERTIES + "Accept")
        events.click(restore)
        events.drag((0.02, 0.02), (0.02, 0.02))
        for _ in range(2):
            events.menu("menu_Edit", "actionEditUndo")
            events.drag((0.02, 0.02), (0.02, 0.02))
        states, _ = events.play("outline", auto_apply=False, blocks=True)
        self.assertEqual(states[1]["widget"]["OutlineBounds"], [0.0] + [15.0, -15.0] * 2 + [15.0])
        sizes = [(state["resolution"], state["displacements_resolution"], len(state["displacements"]) // 3)
                 for state in states]
        script, panel = ([5, 5, 5], 125), ([7, 5, 5], 175)
        self.assertEqual(sizes, [([6, 5, 5], *script), ([7, 5, 5], *script), ([6, 6, 6], *script),
                                 ([7, 5, 5], *script), ([7, 5, 5], *panel), ([6, 6, 6], *panel),
                                 ([7, 5, 5], *panel), ([7, 5, 5], *script)])

    def test_undo_of_applied_edit(self):
        """Undo of the menu takes back what was applied, with what was dragged since, which control and Z do not
        bring again. After a drag the lattice is that of the filter, which was updated in the middle of it.
        The resolution of a script keeps edits. Edits that a script has replaced before they were applied are not,
        nor is their resolution."""
        events = Events()
        events.drag((0.5, 0.5), (0.6, 0.3))
        events.click(PROPERTIES + "Accept")
        events.drag((0.6, 0.3), (0.55, 0.4))
        events.menu("menu_Edit", "actionEditUndo")
        events.add(VIEW, "keyEvent", "6:%d:%d:z:0:1" % (ord("Z"), 0x04000000))
        events.wait()
        events.set(PANEL + "Resolution_0", "int", "6")
        events.click(PROPERTIES + "Accept")
        events.set(PANEL + "Resolution_0", "int", "5")
        events.click(PROPERTIES + "Accept")
        events.add(VIEW, "mousePress", "(0.5,0.5,1,1,0)")
        events.add(VIEW, "mouseMove", "(0.55,0.4,0,1,0)")
        events.set(SCALE, "string", "0.5")
        events.click(PROPERTIES + "Accept")
        events.add(VIEW, "mouseRelease", "(0.55,0.4,1,0,0)")
        events.wait()
        events.set(SCALE, "string", "0.25")
        events.click(PROPERTIES + "Accept")
        events.drag((0.02, 0.02), (0.02, 0.02))
        events.toggle(SELECTION)
        events.click(SELECTION + "SelectAll")
        events.set(SELECTION + "Center_2", "string", "5")
        events.set(OPACITY, "string", "0.5")
        events.click(PROPERTIES + "Accept")
        states, _ = events.play("applied", auto_apply=False)
        replaced = states.pop()
        self.assertEqual(replaced["displacements_resolution"], [5, 5, 5])
        self.assertEqual(replaced["displacements"], [1.0] * 3 * 5 * 5 * 5)
        self.assertEqual(moved(states[0]), [MIDDLE])
        sizes = [state["resolution"][0] for state in states]
        undone, again, updated, after, last = states[-5:]
        self.assertEqual(sizes[-5:], [6, 5, 5, 5, 7])
        self.assertEqual(moved(undone), [], [moved(state) for state in states])
        self.assertEqual(moved(again), [])
        self.assertEqual(moved(updated), [MIDDLE])
        self.assertEqual(updated["seen"]["DisplacementScale"], 1.0)
        self.assertEqual(after["seen"]["DisplacementScale"], 0.5)
        self.assertEqual(last["displacements_resolution"], [5, 5, 5])
        self.assertEqual(last["displacements"], updated["displacements"])

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

    def test_help_pages(self):
        """The pages that the panel's question mark opens are part of the plugin."""
        pages = os.path.join(os.environ["FFD_BUILD_DIR"], "paraview", "FFDVolume", "help", "FFDVolume.qch")
        with sqlite3.connect(pages) as book:
            names = {name for name, in book.execute("SELECT Name FROM FileNameTable")}
        for name in ("filters.FFDLattice", "filters.FFDResampleToImage", "filters.FFDDeformGeometry",
                     "sources.FFDTransformReader", "representations.FFDVolumeRepresentation"):
            self.assertIn(name + ".html", names)

    def test_controls(self):
        """Resolution, refinement, numeric entry, options, reset and help."""
        events = Events()
        # The question mark of the panel opens ParaView's window of help, on the page of the filter.
        events.click(PROPERTIES + "Help")
        events.check("pqHelpWindow/1QTextBrowser0", "documentTitle", "FFD Lattice")
        events.add("pqHelpWindow/contentsDock", "keyEvent", "6:16777216:0::0:1")
        events.drag((0.5, 0.5), (0.6, 0.3))
        events.set(PANEL + "Resolution_0", "int", "7")
        events.click(PANEL + "Refine")
        for group in (SELECTION, EDITING):
            events.toggle(group)
        events.click(SELECTION + "SelectAll")
        events.set(SELECTION + "Center_2", "string", "5")
        events.click(PANEL + "Reset")
        events.set(PANEL + "Resolution_0", "int", "5")
        events.set(PANEL + "Resolution_1", "int", "5")
        events.set(PANEL + "Resolution_2", "int", "5")
        events.click(SELECTION + "SelectNone")
        events.set(EDITING + "Constraint", "string", "Z axis")
        events.set(EDITING + "SymmetryX", "boolean", "true")
        events.drag((0.5, 0.5), (0.6, 0.3))
        events.click(PANEL + "Reset")
        events.set(EDITING + "Constraint", "string", "Free")
        events.set(EDITING + "SoftEditing", "boolean", "true")
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
        self.assertEqual(shifted["displacements_resolution"], [11, 7, 7])
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
        # The neighbors follow; the mirrored edit of the middle keeps it in the mid-plane.
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

        for group in (SELECTION, EDITING, DISPLAY):
            events.toggle(group)

        def drag(*places):
            events.drag(*places)
            events.click(SELECTION + "SelectNone")
            events.click(PANEL + "Reset")

        # Control points are 7.5 apart.
        events.set(EDITING + "SoftEditing", "boolean", "true")
        events.set(EDITING + "SoftRadius", "string", "8")
        drag(*near)
        events.set(EDITING + "SoftRadius", "string", "11")
        drag(*near)
        events.set(EDITING + "Falloff", "string", "Constant")
        drag(*near)
        events.set(EDITING + "LockBoundary", "boolean", "true")
        drag(*near)
        events.set(EDITING + "LockBoundary", "boolean", "false")
        events.set(EDITING + "SoftEditing", "boolean", "false")
        drag(*far)
        events.set(EDITING + "FoldGuard", "string", "Stop Edits")
        drag(*far)
        events.set(EDITING + "FoldGuard", "string", "Warn")
        drag(*far)

        # The selected control point is the line of the table.
        events.drag((0.5, 0.5), (0.5, 0.5))

        def move(height):
            events.add(SELECTION + "Points", "editAccepted", "0.2,%g" % height)
            events.wait()

        events.set(EDITING + "Handle", "string", "Turn")
        move(1)
        events.set(EDITING + "Handle", "string", "Scale")
        events.set(DISPLAY + "InteriorPoints", "boolean", "false")
        move(2)
        events.set(EDITING + "Handle", "string", "None")
        events.set(DISPLAY + "CurvedLines", "boolean", "true")
        move(3)
        # What is hidden is not dragged.
        events.set(DISPLAY + "InteriorPoints", "boolean", "true")
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

    def open_transform(self, selected, *options, then=(), **variables):
        """File > Open of a transform file, and Apply, and once more for each of the other places in the
        pipeline browser, selected then; returns what ParaView says, the pipeline (None if the view was not
        rendered), and the file."""
        folder = tempfile.mkdtemp(prefix="files.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        path = write_translation(folder)
        events = Events()
        for place in (None, *then):
            if place:
                events.add(BROWSER, "currentChanged", place)
                events.wait()
            events.menu("menu_File", "actionFileOpen")
            events.add(WINDOW + "FileOpenDialog", "filesSelected", path)
            events.wait()
            events.click(PROPERTIES + "Accept")
        # Rendered again, even if there is nothing new to show.
        events.drag((0.5, 0.5), (0.5, 0.5))
        log = os.path.join(folder, "log")
        result = play(find_command("FilesScene.py", folder, events, *options), find_environment(
            folder, FFD_FILES_LOG=log, FFD_FILES_SELECTED=selected, **variables))
        self.assertEqual(result.returncode, 0, result.stdout)
        state = None
        if os.path.exists(log):
            with open(log, encoding="ascii") as file:
                state = json.load(file)
        return result.stdout, state, path

    def test_transform_file(self):
        """File > Open of a transform file with a volume selected applies it to the volume, and Apply
        shows that."""
        said, state, _ = self.open_transform("volume")
        for word in ("ERR|", "ERROR:", "Warning:"):
            self.assertNotIn(word, said)
        self.assertEqual(sorted(state["sources"]),
                         ["FFDApplyTransform", "FFDTransformReader", "RTAnalyticSource"])
        self.assertEqual(state["active"], "FFDApplyTransform")
        self.assertEqual(state["visible"], ["FFDApplyTransform"])
        for bound, expected in zip(state["bounds"], (-18, 12, -8, 22, -26, 4)):
            self.assertAlmostEqual(bound, expected, delta=0.01)

    def test_transform_file_alone(self):
        """With a contour selected one message says that nothing is applied, why, and what to do; with a
        source whose file is missing that it has no data."""
        said, state, path = self.open_transform("contour", then=["/0/1|0"])
        self.assertEqual(sorted(state["sources"]), ["Contour", "FFDTransformReader", "FFDTransformReader",
                                                    "LegacyVTKFileReader", "RTAnalyticSource"])
        text = " ".join(said.split())
        self.assertEqual(text.count("is opened, but not applied"), 2, said)
        self.assertIn(path + " is opened, but not applied to Contour1, which is selected: it is no volume (an "
                      "image), but \"Polygonal Mesh\". Select Wavelet1, and choose Filters > FFD > FFD Apply "
                      "Transform with shift.tfm as the transform.", text)
        self.assertIn(path + " is opened, but not applied to Gone, which is selected: it has no data. Select "
                      "a volume, and choose Filters > FFD > FFD Apply Transform with shift.tfm as the transform.",
                      text)

    def test_transform_file_elsewhere(self):
        """The volume that was selected is the client's, and the file is opened on a server: the message says
        that."""
        port = ffdprocess.find_port()
        with subprocess.Popen(
                ["pvserver", "--server-port=%d" % port], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                text=True, env={**os.environ, "PV_PLUGIN_PATH": os.path.dirname(PLUGIN)}) as server:
            try:
                for line in server.stdout:
                    if "Accepting" in line:
                        break
                said, _, path = self.open_transform(
                    "elsewhere", "--multi-servers", FFD_FILES_PORT=str(port))
            finally:
                ffdprocess.stop(server)
        text = " ".join(said.split())
        self.assertEqual(text.count("is opened, but not applied"), 1, said)
        self.assertIn(path + " is opened, but not applied to Wavelet1, which is selected: it is on another "
                      "server. Select a volume of the server that has the file, and choose Filters", text)

    def test_hover(self):
        """The pointer rests on the volume, beside it, and on it again, which a server of two processes
        has: what is seen there, and where that is at rest."""
        places = ((0.5, 0.5), (0.02, 0.05), (0.45, 0.55))
        found = {}
        for ranks in (0, 2):
            folder = tempfile.mkdtemp(prefix="hover.", dir=TEMPORARY)
            os.chmod(folder, 0o700)
            events = Events()
            for place in places:
                events.add(VIEW, "mouseMove", "(%g,%g,0,0,0)" % place)
                events.add(VIEW, "pause", "1500")
            log = os.path.join(folder, "log")
            environment = find_environment(folder, FFD_HOVER_LOG=log)
            options = []
            server = None
            if ranks:
                port = ffdprocess.find_port()
                server = subprocess.Popen(
                    ["mpiexec", "-np", str(ranks), "pvserver", "--server-port=%d" % port],
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
                for line in server.stdout:
                    if "Accepting" in line:
                        break
                options = ["--server-url=cs://localhost:%d" % port]
            try:
                result = play(
                    find_command("HoverScene.py", folder, events, *options), environment)
            finally:
                if server:
                    ffdprocess.stop(server)
                    server.stdout.close()
            self.assertEqual(result.returncode, 0, result.stdout)
            with open(log, encoding="ascii") as file:
                found[ranks] = [json.loads(line) for line in file]
            self.assertEqual([line[0] for line in found[ranks]], [1, 0, 1])
            for line in (found[ranks][0], found[ranks][2]):
                for shown, rest, shift in zip(line[1:4], line[4:7], (3, -7, 11)):
                    self.assertAlmostEqual(shown - rest, shift, delta=0.02)
                # Where it is visible: an opacity of 0.05, inside of the volume or on its face.
                self.assertGreater(line[7], 143.9)
                self.assertTrue(line[7] < 144.1 or max(map(abs, line[4:7])) > 14.99, line)
        for here, there in zip(found[0], found[2]):
            for a, b in zip(here, there):
                self.assertAlmostEqual(a, b, delta=0.1)

    def drag_without_apply(self, moves, server):
        """Drag a control point, and end ParaView without Apply. Returns the last frame, the last one while
        the mouse button was down, the number of frames, and the bytes that the client has sent and received;
        without a server 0."""
        folder = tempfile.mkdtemp(prefix="drag.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        frames = os.path.join(folder, "frames.npz")
        environment = find_environment(folder, FFD_DRAG_FRAMES=frames)
        events = Events()
        events.add(VIEW, "pause", "500")
        events.drag((0.5, 0.5), *[(0.5 + 0.1 * i / moves, 0.5 - 0.2 * i / moves)
                                  for i in range(1, moves + 1)])
        events.add(VIEW, "pause", "500")
        command = find_command("DragScene.py", folder, events)
        counts = [0, 0]
        with contextlib.ExitStack() as stack:
            if server:
                port = ffdprocess.find_port()
                process = stack.enter_context(subprocess.Popen(
                    ["pvserver", "--server-port=%d" % port], env=environment, text=True,
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT))
                stack.callback(process.kill)
                for line in process.stdout:
                    if "Accepting" in line:
                        break
                link = stack.enter_context(ffdlink.SlowLink(port, delay=0.0))
                command.append("--server-url=cs://localhost:%d" % link.port)
            result = play(command, environment)
            if server:
                counts = link.count()
        self.assertEqual(result.returncode, 0, result.stdout)
        saved = np.load(frames)
        return saved["picture"].astype(int), saved["dragging"].astype(int), int(saved["count"]), counts

    def test_hover_mode(self):
        """ParaView's tooltip of the cell below the pointer, once its mode is chosen, stays when the pointer
        rests; ours comes without it. Rich text, as ParaView's, is wrapped."""
        folder = tempfile.mkdtemp(prefix="mode.", dir=TEMPORARY)
        os.chmod(folder, 0o700)
        events = Events()

        def rest(place, isRich):
            events.add(VIEW, "mouseMove", "(%g,%g,0,0,0)" % place)
            events.add(VIEW, "pause", "1500")
            events.check("qtooltip_label", "wordWrap", isRich)

        rest((0.5, 0.5), "false")
        # Not the button, whose number is another one in each version of ParaView.
        events.add(VIEW.partition("/CentralWidgetFrame")[0] + "/actionHoveringSurfaceCells", "activate")
        if os.environ["FFD_PARAVIEW_DIR"].endswith("5.11"):  # later ones do not explain the mode
            events.add(WINDOW + "CoreUtilitiesPromptUser/qt_msgbox_buttonbox/1QPushButton0", "activate")
        rest((0.45, 0.55), "true")
        result = play(find_command("HoverScene.py", folder, events), find_environment(
            folder, FFD_HOVER_LOG=os.path.join(folder, "log")))
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_drag_is_local(self):
        """Before Apply only the control points travel to a server, and no pictures come back; the
        client shows the server's volume below the lattice, which it draws with the handle below the mouse."""
        expected, shown, _, _ = self.drag_without_apply(40, False)
        _, _, few, before = self.drag_without_apply(4, True)
        picture, dragging, many, after = self.drag_without_apply(40, True)
        self.assertGreaterEqual(many - few, 30)
        sent, received = [(b - a) / 36 for a, b in zip(before, after)]
        sys.stdout.write("a step of a drag: %d bytes sent, %d received\n" % (sent, received))
        self.assertGreater(sent, 0)
        # 125 control points, and what they are packed into. A picture is of 130 kB; the server makes one
        # more or less before the drag.
        self.assertLess(sent, 2 * 125 * 24)
        self.assertLess(abs(received), 20e3)
        self.assertEqual(picture.shape, expected.shape)
        self.assertLess(np.abs(picture - expected).mean(), 1.0)
        self.assertGreater(picture.std(), 10.0)
        height, width = dragging.shape[:2]
        rows, columns = (slice(int(size * place) - 4, int(size * place) + 5)
                         for size, place in ((height, 0.3), (width, 0.6)))
        self.assertLess(np.abs(dragging - shown)[rows, columns].mean(), 10.0)
        self.assertGreater(np.abs(dragging - dragging[0, 0])[rows, columns].mean(), 15.0)

    def test_at_rest(self):
        """The pipeline browser and the status bar name what is shown at rest, as long as it is."""
        text = WINDOW + "statusbar/FFDAtRest"
        marks = BROWSER + "/qt_scrollarea_viewport/FFDAtRestMarks"
        for kind in ("Volume", "lattice dropped"):
            folder = tempfile.mkdtemp(prefix="rest.", dir=TEMPORARY)
            os.chmod(folder, 0o700)
            events = Events()
            events.add(VIEW, "pause", "500")

            def check(shown):
                events.check(text, "visible", "true")
                events.check(text, "text", "First is shown at rest (%s)" % shown)
                events.check(marks, "marked", "First")

            check(kind)
            if kind == "Volume":
                # Other representations.
                events.add(BROWSER, "currentChanged", "/0/0/0|0")
                for shown in ("FFD Volume", "Slice", "FFD Volume"):
                    events.add(WINDOW + "representationToolbar/displayRepresentation/comboBox",
                               "set_string", shown)
                    events.add(VIEW, "pause", "500")
                    if shown == "Slice":
                        check(shown)
                    else:
                        events.check(text, "visible", "false")
                        events.check(marks, "marked", "")
            result = play(find_command("AtRestScene.py", folder, events),
                          find_environment(folder, FFD_REST_TYPE=kind))
            self.assertEqual(result.returncode, 0, result.stdout)
            # No window of messages over the view.
            self.assertNotIn("shows the data at rest", result.stdout)
            self.assertNotIn("are shown at rest", result.stdout)


if __name__ == "__main__":
    unittest.main()
