# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far cut rays are from the true ones: runs the program ffd_position_error and reads its CSV."""

import csv
import os
import subprocess

import vtkffd
from experiments import Check


def find_program():
    """The program of the build tree that vtkffd was imported from, or None."""
    package = os.path.dirname(os.path.abspath(vtkffd.__file__))
    path = os.path.join(package, "..", "..", "bin", "ffd_position_error")
    return os.path.normpath(path) if os.path.exists(path) else None


def run(program, quick, progress):
    """Rows as dictionaries, or None without a program."""
    program = program or find_program()
    if program is None:
        return None
    progress("position error")
    command = [program] + (["--quick"] if quick else [])
    output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return list(csv.DictReader(output.splitlines()))


def table(rows):
    header = ["deformation", "inverse", "segmentation", "parameter", "segments per 100 voxels",
              "evaluations a ray", "largest (voxels)", "mean (voxels)"]
    return header, [
        [r["deformation"], r["inverse"], r["segmentation"], r["parameter"],
         r["segments_per_100_voxels"], r["evaluations_per_ray"], r["largest_error"],
         r["mean_error"]] for r in rows]


def check(rows):
    """ERROR_BOUND keeps its tolerance wherever the deformation is one to one."""
    bound = [r for r in rows if r["segmentation"] == "ERROR_BOUND"
             and not (r["deformation"] == "random 45" and r["inverse"] == "EXACT")]
    worst = max(float(r["largest_error"]) / float(r["parameter"]) for r in bound)
    return [Check(
        "position.error_bound", "samples never exceed the tolerance",
        "at most %.0f %% of it" % (100.0 * worst), worst <= 1.0)]
