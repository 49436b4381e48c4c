#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two and four processes give the picture of one, and each holds a part of the voxels."""

import os
import re
import subprocess
import sys
import unittest

import ffdparaview as ffd

SCENES = [name + opaque for name in ("identity", "smooth", "strong") for opaque in "01"]


def run(ranks):
    """Pictures by scene, and for each scene the voxels of each process."""
    here = os.path.dirname(os.path.abspath(__file__))
    prefix = os.path.join(ffd.TEMPORARY, "ParaView.parallel%d" % ranks)
    result = subprocess.run(
        ["mpiexec", "-np", str(ranks), "pvbatch", "--symmetric",
         os.path.join(here, "ParallelScenes.py"), prefix],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        env={**os.environ, "PYTHONPATH": here + os.pathsep + os.environ.get("PYTHONPATH", "")})
    sys.stdout.write("".join(
        line + "\n" for line in result.stdout.splitlines() if line.startswith("RANK")))
    if result.returncode != 0:
        raise RuntimeError("pvbatch on %d processes failed:\n%s" % (ranks, result.stdout))
    voxels = {scene: [] for scene in SCENES}
    for scene, count in re.findall(r"RANK \d+ (\w+) voxels (\d+)", result.stdout):
        voxels[scene].append(int(count))
    return {scene: ffd.read_picture("%s.%s.png" % (prefix, scene)) for scene in SCENES}, voxels


class TestParallel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.one, cls.voxels = run(1)

    def check(self, ranks, most):
        several, voxels = run(ranks)
        for scene in SCENES:
            with self.subTest(scene=scene, ranks=ranks):
                self.assertGreater(ffd.lit(self.one[scene]), 500)
                largest, mean = ffd.differ(several[scene], self.one[scene])
                self.assertLessEqual(largest, 8)
                self.assertLessEqual(mean, 0.5)
        whole = self.voxels["identity0"][0]
        self.assertEqual(whole, 41 ** 3)
        for scene in ("identity0", "smooth0"):
            self.assertEqual(len(voxels[scene]), ranks)
            self.assertLess(max(voxels[scene]), most[scene] * whole, scene)

    def test_two(self):
        self.check(2, {"identity0": 0.62, "smooth0": 0.85})

    def test_four(self):
        self.check(4, {"identity0": 0.42, "smooth0": 0.7})


if __name__ == "__main__":
    unittest.main()
