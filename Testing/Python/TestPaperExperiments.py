# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's experiments, small: the report is whole, and its trends are those of the paper."""

import csv
import importlib.util
import math
import os
import sys
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.path.normpath(os.path.join(HERE, "..", "..", "Examples", "paper_experiments"))
sys.path.insert(0, PROGRAM)

import experiments  # noqa: E402
import scene  # noqa: E402


class TestPaperExperiments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # The program's own __main__.py under a name of its own: this file is __main__ here.
        spec = importlib.util.spec_from_file_location(
            "paper_experiments", os.path.join(PROGRAM, "__main__.py"))
        program = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(program)
        cls.folder = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "paper_experiments")
        cls.checks = {c.name: c for c in program.run(cls.folder, size=96, quick=True)}

    def read(self, name):
        with open(os.path.join(self.folder, name), newline="", encoding="ascii") as stream:
            return list(csv.DictReader(stream))

    def test_every_check_is_met(self):
        for name, check in self.checks.items():
            with self.subTest(name):
                self.assertTrue(check.met, "wanted: %s; measured: %s" % (
                    check.wanted, check.measured))
        self.assertGreaterEqual(len(self.checks), 25)

    def test_report_is_whole(self):
        with open(os.path.join(self.folder, "report.md"), encoding="ascii") as stream:
            text = stream.read()
        for name in ("table1.png", "figure5_smooth.png", "figure5_random.png", "figure8.png"):
            self.assertIn("(%s)" % name, text)
            with open(os.path.join(self.folder, name), "rb") as stream:
                self.assertEqual(stream.read(8), b"\x89PNG\r\n\x1a\n")
            self.assertGreater(os.path.getsize(os.path.join(self.folder, name)), 10000)
        for numbers in experiments.PAPER_TABLE.values():
            self.assertIn(" | ".join("%.2f" % n for n in numbers), text)
        for name in self.checks:
            self.assertIn(name, text)

    def test_table_is_made_of_the_counts(self):
        counts = {(r["deformation"], r["magnitude"], r["method"], r["opacity"], r["optimized"]): r
                  for r in self.read("counts.csv")}
        for row in self.read("table1.csv"):
            if row["deformation"] == "the paper's":
                continue
            opacity = {v: k for k, v in scene.OPACITY_TITLES.items()}[row["opacity"]]
            for magnitude in scene.TABLE_MAGNITUDES:
                shape = row["deformation"] if magnitude else "none"
                key = (shape, str(magnitude), row["rendered by"])
                optimized = counts[key + (opacity, "1")]
                unoptimized = counts[key + ("opaque", "0")]
                self.assertEqual(float(unoptimized["distance_lookups_per_ray"]), 0.0)
                ratio = float(unoptimized["samples_per_ray"]) / (
                    float(optimized["samples_per_ray"]) +
                    float(optimized["distance_lookups_per_ray"]))
                self.assertAlmostEqual(
                    float(row["magnitude %d" % magnitude]) / ratio, 1.0, delta=0.01)

    def test_counts_are_those_of_the_paper(self):
        """A ray along an axis of a volume without anything in it: every count is known."""
        image = scene.read_engine()
        lattice = scene.make_lattice(image, "smooth", 0)
        mapper = scene.make_mapper(image, lattice, "paper", optimized=False)
        prop = scene.make_property("sparse")
        prop.GetScalarOpacity().RemoveAllPoints()
        prop.GetScalarOpacity().AddPoint(0.0, 0.0)
        counts = scene.render(image, mapper, prop, 96, scene.COUNTING_DISTANCE).counts
        self.assertGreater(counts.rays, 1000)
        self.assertEqual(counts.lookups, 0.0)
        self.assertEqual(counts.visible_samples, 0.0)
        # What the rays have inside of the volume is as long as their segments together, and has a
        # sample every half voxel, one more for what is left of each segment.
        length = counts.segments_per_ray * counts.segment_length
        self.assertGreaterEqual(counts.samples, length / scene.SAMPLE_DISTANCE - 1.0)
        self.assertLessEqual(counts.samples, length / scene.SAMPLE_DISTANCE + 2.0)
        # With leaping nothing is sampled, and there is at least one look-up a segment.
        mapper = scene.make_mapper(image, lattice, "paper")
        leaping = scene.render(image, mapper, prop, 96, scene.COUNTING_DISTANCE).counts
        self.assertEqual(leaping.samples, 0.0)
        self.assertAlmostEqual(leaping.segments_per_ray, counts.segments_per_ray)
        self.assertLessEqual(leaping.lookups, 1.05 * leaping.segments_per_ray)
        self.assertGreaterEqual(leaping.lookups, 0.9 * leaping.segments_per_ray)

    def test_fixed_segments_have_their_length(self):
        image = scene.read_engine()
        lattice = scene.make_lattice(image, "random", 30)
        for length in (2.0, 4.0):
            mapper = scene.make_mapper(image, lattice, "paper", optimized=False)
            mapper.SetMinimumSegmentLength(length)
            mapper.SetMaximumSegmentLength(length)
            counts = scene.render(image, mapper, scene.make_property("opaque", False), 96,
                                  scene.COUNTING_DISTANCE).counts
            # All but the last of each ray.
            whole = counts.segments_per_ray * counts.segment_length / length
            self.assertGreaterEqual(counts.segments_per_ray, whole)
            self.assertLessEqual(counts.segments_per_ray, whole + 1.0)

    def test_roughness(self):
        """A plane is as smooth as a plane; a chessboard of height h has its height."""
        plane = scene.numpy.add.outer(scene.numpy.arange(20.0), scene.numpy.arange(20.0))
        self.assertAlmostEqual(experiments.depth_roughness(plane + 0.5, plane), 0.0)
        board = 0.25 * (-1.0) ** scene.numpy.add.outer(range(20), range(20))
        self.assertAlmostEqual(experiments.depth_roughness(plane + board, plane), 0.5)
        nothing = scene.numpy.full((20, 20), math.inf)
        self.assertEqual(experiments.depth_roughness(nothing, nothing), 0.0)


if __name__ == "__main__":
    unittest.main()
