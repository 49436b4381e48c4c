#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Write the files elastix5_* of this folder, and elastix5_points.json: what transformix does to points.

Needs transformix 5.0.1 (Debian: elastix), which no test of these files needs: they are in the
repository.
"""

import json
import os
import random
import re
import subprocess
import tempfile

FOLDER = os.path.dirname(os.path.abspath(__file__))
RANDOM = random.Random(5)
SHIFT = [4.0, -3.0, 2.0]
STEPS = 4
IMAGE = """(InitialTransformParametersFileName "%s")
(HowToCombineTransforms "%s")
(FixedImageDimension 3)
(MovingImageDimension 3)
(FixedInternalImagePixelType "float")
(MovingInternalImagePixelType "float")
(Size 40 40 40)
(Index 0 0 0)
(Spacing 1 1 1)
(Origin 0 0 0)
(Direction 1 0 0 0 1 0 0 0 1)
(UseDirectionCosines "true")
(ResampleInterpolator "FinalBSplineInterpolator")
(FinalBSplineInterpolationOrder 1)
(Resampler "DefaultResampler")
(DefaultPixelValue 0)
(ResultImageFormat "mhd")
(ResultImagePixelType "float")
(CompressResultImage "false")
"""


def text(kind, parameters, initial="NoInitialTransform", combine="Compose", extra=""):
    return ('(Transform "%s")\n(NumberOfParameters %d)\n(TransformParameters %s)\n'
            % (kind, len(parameters), " ".join(map(repr, parameters)))
            + IMAGE % (initial, combine) + extra)


def linear(kind, parameters, **how):
    return text(kind, parameters, extra="(CenterOfRotationPoint 10 20 15)\n", **how)


def spline(order, spacing, **how):
    # All of the points, and where the other transforms take them, lie within the grid.
    size = int(40 / spacing) + 1 + order
    count = 3 * size ** 3
    start = -0.5 * (order - 1) * spacing
    grid = ("(GridSize %d %d %d)\n(GridIndex 0 0 0)\n(GridSpacing %g %g %g)\n"
            "(GridOrigin %g %g %g)\n(GridDirection 1 0 0 0 1 0 0 0 1)\n"
            "(BSplineTransformSplineOrder %d)\n(UseCyclicTransform \"false\")\n"
            % ((size,) * 3 + (spacing,) * 3 + (start,) * 3 + (order,)))
    return text("BSplineTransform", [round(RANDOM.uniform(-2.0, 2.0), 2) for _ in range(count)],
                extra=grid, **how)


def stack(name, steps, extra, initial="NoInitialTransform"):
    """A stack of the parameters of each step, for images of four dimensions, from time 1 on in steps of
    0.5."""
    content = text(name, [x for parameters in steps for x in parameters], initial=initial, extra=extra)
    for entry, three, fourth in (
            ("Size", "40 40 40", "4"), ("Index", "0 0 0", "0"), ("Spacing", "1 1 1", "0.5"),
            ("Origin", "0 0 0", "1"), ("FixedImageDimension", "3", None),
            ("MovingImageDimension", "3", None),
            # Of four dimensions elastix knows this type only.
            ("FixedInternalImagePixelType", '"float"', '"short"'),
            ("MovingInternalImagePixelType", '"float"', '"short"')):
        content = content.replace("(%s %s)" % (entry, three),
                                  "(%s %s)" % (entry, "4" if fourth is None else fourth
                                               if '"' in fourth else three + " " + fourth))
    content = content.replace("(Direction 1 0 0 0 1 0 0 0 1)",
                              "(Direction 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1)")
    return content + ("(StackSpacing 0.5)\n(StackOrigin 1)\n(NumberOfSubTransforms %d)\n" % len(steps))


def stacks():
    """A stack of splines after one of linear transforms."""
    own = random.Random(6)
    turns = [[round(own.uniform(-0.1, 0.1), 3) for _ in range(3)] + SHIFT for _ in range(STEPS)]
    count = 3 * 5 ** 3
    grid = ("(GridSize 5 5 5)\n(GridIndex 0 0 0)\n(GridSpacing 30 30 30)\n(GridOrigin -30 -30 -30)\n"
            "(GridDirection 1 0 0 0 1 0 0 0 1)\n(BSplineTransformSplineOrder 3)\n"
            "(UseCyclicTransform \"false\")\n")
    splines = [[round(own.uniform(-2.0, 2.0), 2) for _ in range(count)] for _ in range(STEPS)]
    return {
        "stack_euler": stack("EulerStackTransform", turns, "(CenterOfRotationPoint 10 20 15)\n"),
        "stack": stack("BSplineStackTransform", splines, grid, initial="elastix5_stack_euler.txt")}


def main():
    files = {
        "spline1": spline(1, 20.0), "spline2": spline(2, 20.0),
        "euler": linear("EulerTransform", [0.1, 0.2, -0.1] + SHIFT)}
    # Chains: a spline that is added to a spline on another grid after a linear transform.
    files["chain"] = spline(3, 30.0, initial="elastix5_euler.txt")
    files["add"] = spline(2, 25.0, initial="elastix5_chain.txt", combine="Add")
    files.update(stacks())
    for name, content in files.items():
        with open(os.path.join(FOLDER, "elastix5_%s.txt" % name), "w", encoding="ascii") as file:
            file.write(content)
    expected = {}
    for name in sorted(files):
        points = [[round(RANDOM.uniform(8.0, 28.0), 3) for _ in range(3)] for _ in range(8)]
        if "stack" in name:
            points = [[*point, 1.0 + 0.5 * (i % STEPS)] for i, point in enumerate(points)]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "points.txt")
            with open(path, "w", encoding="ascii") as file:
                file.write("point\n%d\n" % len(points)
                           + "\n".join(" ".join(map(repr, p)) for p in points) + "\n")
            result = subprocess.run(["transformix", "-def", path, "-tp", "elastix5_%s.txt" % name, "-out",
                                     folder], cwd=FOLDER, capture_output=True, text=True,
                                    check=True)
            # An initial transform that fails is left out, with no more than a message.
            assert "could not be created" not in result.stdout, result.stdout
            with open(os.path.join(folder, "outputpoints.txt"), encoding="ascii") as file:
                moved = [[float(x) for x in re.search(r"OutputPoint = \[ (.*?) \]",
                                                      line)[1].split()] for line in file]
        expected["elastix5_%s.txt" % name] = [list(pair) for pair in zip(points, moved)]
    with open(os.path.join(FOLDER, "elastix5_points.json"), "w", encoding="ascii") as file:
        json.dump(expected, file, separators=(",", ":"))
        file.write("\n")


if __name__ == "__main__":
    main()
