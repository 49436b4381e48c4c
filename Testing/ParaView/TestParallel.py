#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Several processes give the picture of one, highlights included, and each holds a part
of the voxels: fewer, the more processes there are."""

import functools
import json
import os
import re
import subprocess
import sys
import unittest

import ffdsession  # noqa: F401, before paraview.simple
import numpy as np
from paraview import simple

import ffdparaview as ffd

NAMES = ("identity", "smooth", "strong", "edited", "changed", "alone")
BLENDS = ("Maximum0", "Minimum0", "Average0", "Additive0", "Isosurface1", "Slice0")
SCENES = [name + opaque for name in NAMES for opaque in "01"] + [*BLENDS, "steps0"]
VOLUME = os.path.join(ffd.TEMPORARY, "ParaView.alone.vtk")
FILES = [os.path.join(ffd.TEMPORARY, "ParaView.time%d.vti" % step) for step in (0, 1)]

SHAPES = ("Bend", "Twist", "Taper", "Bulge", "Random")
HIGHLIGHTS = (*SHAPES, "White", "FXAA", "Dense", "Near", "Flat", "Hidden", "Again",
              "EDL", "Tones")
TIMES = ("stack 1", "stack 1.25", "stack 2.5", "fit 0", "volumes 0", "volumes 0.5", "volumes 1")
VOLUMES = ("beside", "translucent", "inline", "opposite", "parallel", "edited", "hidden", "placed",
           "turned")


def find_prefix(name, ranks):
    """Of the pictures of a script on so many processes."""
    return os.path.join(ffd.TEMPORARY, "ParaView.%s%d" % (name, ranks))


@functools.lru_cache(maxsize=None)
def run_session(ranks):
    """What the scripts put out on so many processes, in one session."""
    commands = []
    if ranks != 3:
        simple.SaveData(VOLUME, proxy=ffd.make_wavelet(20))
        commands.append(["ParallelScenes.py", find_prefix("parallel", ranks), VOLUME])
    if ranks in (1, 3):
        wavelet = ffd.make_wavelet(12)
        for path, frequency in zip(FILES, (60.0, 30.0)):
            wavelet.XFreq = frequency
            simple.SaveData(path, proxy=wavelet)
        commands.append(["ParallelFiles.py", find_prefix("time", ranks), *FILES])
        commands.append(["ParallelVolumes.py", find_prefix("volumes", ranks)])
    # The last one, as it changes colors.
    commands.append(["ParallelHighlights.py", find_prefix("highlights", ranks)])
    here = os.path.dirname(os.path.abspath(__file__))
    arguments = [word for command in commands for word in ("+", *command)][1:]
    result = subprocess.run(
        ["mpiexec", "-np", str(ranks), "pvbatch", "--symmetric",
         os.path.join(here, "ParallelSession.py"), *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        env={**os.environ, "PYTHONPATH": here + os.pathsep + os.environ.get("PYTHONPATH", "")})
    if result.returncode != 0:
        raise RuntimeError("pvbatch on %d processes failed:\n%s" % (ranks, result.stdout))
    return result.stdout


def read_pictures(name, ranks, scenes):
    """By scene."""
    run_session(ranks)
    return {scene: ffd.read_picture("%s.%s.png" % (find_prefix(name, ranks), scene)) for scene in scenes}


def compare_processes(test, name, scenes, least_lit, least_difference):
    """Each scene of a script has a picture of its own, the same on one and on three processes."""
    pictures = {ranks: read_pictures(name, ranks, scenes) for ranks in (1, 3)}
    for i, (scene, picture) in enumerate(pictures[1].items()):
        test.assertGreater(ffd.lit(picture), least_lit, scene)
        for other in scenes[:i]:
            test.assertGreater(
                ffd.differ(picture, pictures[1][other])[1], least_difference, (scene, other))
        with test.subTest(scene=scene):
            largest, mean = ffd.differ(pictures[3][scene], picture)
            test.assertLessEqual(largest, 8)
            test.assertLessEqual(mean, 0.5)


def run(ranks):
    """Pictures by scene; for each scene the voxels of each process, those of its source, and the
    bounds of the deformed volume as each process with voxels has them."""
    output = run_session(ranks)
    sys.stdout.write("".join(
        line + "\n" for line in output.splitlines() if line.startswith("RANK")))
    voxels = {scene: [] for scene in SCENES}
    given = {scene: [] for scene in SCENES}
    bounds = {scene: set() for scene in SCENES}
    for scene, count, source, box in re.findall(
            r"RANK \d+ (\w+) voxels (\d+) of the source (\d+) .* bounds (.*)", output):
        voxels[scene].append(int(count))
        given[scene].append(int(source))
        if box != "None":
            bounds[scene].add(box)
    if ranks > 1:
        # The processes of one host share its processors; one alone takes all (0).
        threads = [int(count) for count in re.findall(
            r"RANK \d+ identity0 .* threads (\d+)", output)]
        if len(threads) != ranks or not 0 < sum(threads) <= max(ranks, os.cpu_count()):
            raise AssertionError("%d processes have %s threads" % (ranks, threads))
    return read_pictures("parallel", ranks, (*SCENES, "moving")), voxels, given, bounds


class TestParallel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.one, cls.voxels, _, cls.bounds = run(1)

    def check(self, ranks, most):
        several, voxels, given, bounds = run(ranks)
        for scene in SCENES:
            with self.subTest(scene=scene, ranks=ranks):
                self.assertGreater(ffd.lit(self.one[scene]), 500)
                largest, mean = ffd.differ(several[scene], self.one[scene])
                self.assertLessEqual(largest, 8)
                self.assertLessEqual(mean, 0.5)
                # The lattice is the same on all of them, to the last bit.
                self.assertEqual(bounds[scene], self.bounds[scene])
        # While the scene moves; the still picture of it has not been made.
        self.assertGreater(ffd.lit(several["moving"]), 500)
        self.assertLessEqual(ffd.differ(several["moving"], self.one["moving"])[0], 8)
        whole = self.voxels["identity0"][0]
        self.assertEqual(whole, 41 ** 3)
        for name, part in most.items():
            with self.subTest(voxels=name, ranks=ranks):
                self.assertEqual(len(voxels[name + "0"]), ranks)
                self.assertLess(max(voxels[name + "0"]), part * whole)
        # Modes other than composite have all voxels in the first process; each is another picture.
        for i, scene in enumerate(BLENDS):
            with self.subTest(scene=scene, ranks=ranks):
                self.assertEqual(sum(count >= 0.9 * whole for count in voxels[scene]), 1)
                for other in (*BLENDS[:i], "edited0"):
                    self.assertGreater(
                        ffd.differ(several[scene], several[other])[1], 1.0, other)
        # The source is asked for a piece; pieces share the voxels between them.
        for name in ("smooth0", "strong0", "changed0"):
            self.assertLess(max(given[name]), 1.1 / ranks * whole)
        self.assertEqual(sorted(given["alone0"]), [0] * (ranks - 1) + [whole])
        self.assertGreater(ffd.differ(self.one["changed0"], self.one["edited0"])[1], 0.5)

    # With three voxels around a box, half of the cube is 24 of 41 layers, a quarter 14.
    def test_two(self):
        self.check(2, {"identity": 0.6, "smooth": 0.63, "strong": 0.63, "alone": 0.63})

    def test_four(self):
        self.check(4, {"identity": 0.36, "smooth": 0.43, "strong": 0.48, "alone": 0.43})


class TestHighlights(unittest.TestCase):
    """Bright lights: what is brighter than its alpha would make the bytes that IceT adds wrap around."""

    def test_highlights(self):
        pictures = {ranks: read_pictures("highlights", ranks, HIGHLIGHTS) for ranks in (1, 2, 3, 4)}
        for scene, picture in pictures[1].items():
            self.assertGreater(ffd.lit(picture), 1000, scene)
            for ranks in (2, 3, 4):
                with self.subTest(scene=scene, ranks=ranks):
                    # ParaView smooths the edges of the finished picture with several processes,
                    # those of the surfaces alone with one.
                    expected = pictures[2][scene] if scene == "FXAA" else picture
                    # What processes the finished picture makes more of how its bytes were rounded,
                    # which decides, at a few pixels, whether FXAA sees an edge.
                    most = 32 if scene in ("EDL", "Tones") else 8
                    difference = np.abs(pictures[ranks][scene] - expected).max(axis=2)
                    few = 10 if scene == "FXAA" else 0
                    self.assertLessEqual((difference > most).sum(), few)


class TestTime(unittest.TestCase):
    """Transforms and volumes in time, and fits to landmarks."""

    def test_picks(self):
        """Picks, selections and probes of FFD Volume on several processes find what they find on one."""
        blocks = os.path.join(ffd.TEMPORARY, "ParaView.blocks %s.vtm")
        wavelet = ffd.make_wavelet()
        # Lattices are kept apart by a gap.
        for kind, ends in (("blocks", ((-15, 2), (2, 15))), ("lattices", ((-15, -3), (3, 15)))):
            pieces = [simple.ExtractSubset(Input=wavelet, VOI=[*x, *y, *z])
                      for x in ends for y in ends for z in ends]
            simple.SaveData(blocks % kind, proxy=simple.GroupDatasets(Input=pieces), DataMode="Ascii")
        found = {}
        for ranks in (1, 3):  # three show unlike numbers of blocks
            path = os.path.join(ffd.TEMPORARY, "ParaView.picks %d.json" % ranks)
            ffd.run("ParallelPicks.py", path, blocks % "blocks", blocks % "lattices", ranks=ranks)
            with open(path, encoding="ascii") as file:
                found[ranks] = json.load(file)
        for kind, one in found[1].items():
            self.assertEqual([place[0] for place in one["places"]], [True] * 4 + [False])
            for place, other in zip(one["places"][:4], one["other places"]):
                self.assertNotEqual(place, other)
            for selected in one["selected"].values():
                self.assertGreater(selected[0], 100)
            for name, expected in one.items():
                with self.subTest(kind=kind, found=name):
                    self.assertEqual(found[3][kind][name], expected)

    def test_time(self):
        compare_processes(self, "time", TIMES, 500, 0.15)


class TestSeveralVolumes(unittest.TestCase):
    """Volumes beside and behind each other share the boxes of the processes."""

    def test_volumes(self):
        compare_processes(self, "volumes", VOLUMES, 1000, 0.5)


if __name__ == "__main__":
    unittest.main()
