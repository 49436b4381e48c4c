#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""FFD Lattice and FFD Volume take multi-block and partitioned data sets, and rectilinear grids: the
pictures are those of the same volume as one image, on one process and on several."""

import os
import subprocess
import unittest

import ffdparaview as ffd

HERE = os.path.dirname(os.path.abspath(__file__))
BLOCKS = ("vtkMultiBlockDataSet", "vtkPartitionedDataSet", "vtkPartitionedDataSetCollection")
SCENES = ("image", *BLOCKS, "hole", "unlike", "linear", "rectilinear")
PER_BLOCK = [name + state for name in ("per block", "one by one") for state in ("", " edited", " moved")]


def run(ranks):
    prefix = os.path.join(ffd.TEMPORARY, "ParaView.blocks%d" % ranks)
    result = subprocess.run(
        ["mpiexec", "-np", str(ranks), "pvbatch", "--symmetric",
         os.path.join(HERE, "BlockScenes.py"), prefix],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        env={**os.environ, "PYTHONPATH": HERE + os.pathsep + os.environ.get("PYTHONPATH", "")})
    if result.returncode != 0 or "ERR|" in result.stdout:
        raise RuntimeError("pvbatch on %d processes failed:\n%s" % (ranks, result.stdout))
    names = [name + edited for name in SCENES for edited in ("", " edited")] + ["contour", *PER_BLOCK]
    return {name: ffd.read_picture("%s.%s.png" % (prefix, name)) for name in names}


class TestBlocks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.one = run(1)

    def test_blocks_are_the_image(self):
        for edited in ("", " edited"):
            whole = self.one["image" + edited]
            self.assertGreater(ffd.lit(whole), 1000)
            for kind in BLOCKS:
                self.assertLessEqual(ffd.differ(self.one[kind + edited], whole)[0], 2, kind)
            # Seven of eight; and a part of fewer voxels.
            self.assertGreater(ffd.differ(self.one["hole" + edited], whole)[1], 0.5)
            self.assertGreater(ffd.differ(self.one["unlike" + edited], whole)[1], 0.1)
            self.assertLess(ffd.differ(self.one["unlike" + edited], whole)[1], 6.0)
        self.assertGreater(ffd.differ(self.one["image"], self.one["image edited"])[1], 1.0)

    def test_lattice_per_block(self):
        """The picture is that of the blocks one by one, each extracted with its lattice."""
        for state in ("", " edited", " moved"):
            blocks = self.one["per block" + state]
            self.assertGreater(ffd.lit(blocks), 1000)
            self.assertLessEqual(ffd.differ(blocks, self.one["one by one" + state])[0], 2, state)
            self.assertGreater(ffd.differ(blocks, self.one["image"])[1], 2.0)
        self.assertGreater(ffd.differ(self.one["per block"], self.one["per block edited"])[1], 1.0)

    def test_rectilinear(self):
        """A linear function is the same on steps of any length, but for its faces."""
        for edited in ("", " edited"):
            linear = self.one["linear" + edited]
            self.assertGreater(ffd.lit(linear), 1000)
            self.assertLess(ffd.differ(self.one["rectilinear" + edited], linear)[1], 1.0)

    def test_several_processes(self):
        several = run(4)
        for scene, picture in self.one.items():
            with self.subTest(scene=scene):
                largest, mean = ffd.differ(several[scene], picture)
                # What lies on other points is interpolated.
                self.assertLessEqual(mean, 1.0 if "linear" in scene else 0.5)
                if not scene.startswith(("linear", "rectilinear", "unlike")):
                    self.assertLessEqual(largest, 8)


if __name__ == "__main__":
    unittest.main()
