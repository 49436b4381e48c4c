#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Write the files itk_* of this folder, and itk_points.json: what ITK says they do to points.

Every linear transform of ITK, splines of order 1 and 2, fields and composites, as text, HDF5, MATLAB
and MINC. Needs itk 5.4 and SimpleITK 2.5 (pip install itk SimpleITK; only the latter writes MINC),
which no test needs: the files are in the repository.
"""

import json
import math
import os
import random

import itk
import SimpleITK as sitk

FOLDER = os.path.dirname(os.path.abspath(__file__))
RANDOM = random.Random(11)
IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1]
FLIPPED = [0, -1, 0, 0, 0, 1, -1, 0, 0]
CENTER = [10.0, -5.0, 4.0]
VERSOR = [0.1, 0.2, -0.15]
MATRIX = [1.1, 0.1, -0.2, 0.05, 0.9, 0.1, 0.0, -0.1, 1.2]
SHIFT = [4.0, -3.0, 2.0]
SCALE = [1.1, 0.9, 1.25]
ANGLES = [0.3, -0.4, 0.5]
LINEAR = {
    "ScaleTransform": (SCALE, CENTER),
    "ScaleLogarithmicTransform": ([0.1, -0.2, 0.3], CENTER),
    "ScalableAffineTransform": (MATRIX + SHIFT, CENTER),
    "CenteredAffineTransform": (MATRIX + CENTER + SHIFT, [0.0, 0.0, 0.0]),
    "CenteredEuler3DTransform": (ANGLES + CENTER + SHIFT, [0.0, 0.0, 0.0, 1.0]),
    "VersorTransform": (VERSOR, CENTER),
    "Rigid3DTransform": ([0.8, -0.6, 0.0, 0.48, 0.64, -0.6, 0.36, 0.48, 0.8] + SHIFT, CENTER),
    "QuaternionRigidTransform": (VERSOR + [math.sqrt(0.9275)] + SHIFT, CENTER),
    "ScaleVersor3DTransform": (VERSOR + SHIFT + SCALE, CENTER),
    "ScaleSkewVersor3DTransform": (VERSOR + SHIFT + SCALE + [0.1, -0.2, 0.3, 0.05, -0.07, 0.15],
                                   CENTER),
    "ComposeScaleSkewVersor3DTransform": (VERSOR + SHIFT + SCALE + [0.1, -0.2, 0.3], CENTER)}
DIMENSIONLESS = {"VersorTransform", "CenteredEuler3DTransform", "Rigid3DTransform",
                 "QuaternionRigidTransform", "ScaleVersor3DTransform",
                 "ScaleSkewVersor3DTransform", "ComposeScaleSkewVersor3DTransform"}


def numbers(values):
    array = itk.OptimizerParameters[itk.D](len(values))
    for i, value in enumerate(values):
        array[i] = float(value)
    return array


def make(kind, parameters, fixed):
    transform = kind.New()
    transform.SetFixedParameters(numbers(fixed))
    transform.SetParameters(numbers(parameters))
    return transform


def linear(name):
    kind = getattr(itk, name)
    return make(kind[itk.D] if name in DIMENSIONLESS else kind[itk.D, 3], *LINEAR[name])


def grid_numbers(size, planar_count=3):
    return [round(RANDOM.uniform(-2.0, 2.0), 3)
            for _ in range(planar_count * size[0] * size[1] * size[2])]


def with_numbers(transform, size, direction):
    fixed = size + [-3.0, 7.0, 11.0] + [8.0, 9.0, 10.0] + direction
    transform.SetFixedParameters(fixed)
    transform.SetParameters(grid_numbers(size))
    return transform, fixed


def spline(order, direction):
    return with_numbers(sitk.BSplineTransform(3, order), [4 + order, 3 + order, 2 + order],
                        direction)


def field(direction):
    return with_numbers(sitk.DisplacementFieldTransform(3), [5, 4, 3], direction)


def as_sitk(name):
    """A linear transform of SimpleITK, which has some."""
    transform = getattr(sitk, name)() if name in DIMENSIONLESS else getattr(sitk, name)(3)
    transform.SetFixedParameters(LINEAR[name][1])
    transform.SetParameters(LINEAR[name][0])
    return transform


def inside(fixed, order, low=0.05, high=0.95):
    """Points in the region where all control points exist."""
    points = []
    for _ in range(10):
        index = [(order - 1) / 2.0 + RANDOM.uniform(low, high) * (n - order) for n in fixed[:3]]
        points.append([fixed[3 + r] + sum(fixed[9 + 3 * r + c] * index[c] * fixed[6 + c]
                                          for c in range(3)) for r in range(3)])
    return points


def main():
    expected = {}
    anywhere = [[RANDOM.uniform(-50.0, 50.0) for _ in range(3)] for _ in range(4)]

    def record(name, transform, points):
        expected[name] = [[p, list(transform.TransformPoint(p))] for p in points]

    def write(name, transform, points):
        sitk.WriteTransform(transform, os.path.join(FOLDER, name))
        record(name, transform, points)

    for name in LINEAR:
        writer = itk.TransformFileWriterTemplate[itk.D].New()
        writer.SetFileName(os.path.join(FOLDER, "itk_" + name + ".tfm"))
        transform = linear(name)
        writer.SetInput(transform)
        writer.Update()
        record("itk_" + name + ".tfm", transform, anywhere)
    for suffix in (".mat", ".xfm"):
        write("itk_linear" + suffix, as_sitk("ScaleSkewVersor3DTransform"), anywhere)
    for order in (1, 2):
        for direction, name in ((IDENTITY, ""), (FLIPPED, "_flipped")):
            transform, fixed = spline(order, direction)
            write("itk_spline%d%s.tfm" % (order, name), transform, inside(fixed, order))
    transform, fixed = spline(3, IDENTITY)
    write("itk_spline.mat", transform, inside(fixed, 3))
    # The one that is added last is applied first.
    linears = [as_sitk("ScaleTransform"), as_sitk("VersorTransform")]
    transform, fixed = spline(2, IDENTITY)
    write("itk_composite.h5", sitk.CompositeTransform(linears + [transform]), inside(fixed, 2))
    transform, fixed = field(IDENTITY)
    points = inside(fixed, 1)
    write("itk_composite.xfm", sitk.CompositeTransform(linears + [transform]), points)
    transform, fixed = field(FLIPPED)
    write("itk_field.h5", transform, inside(fixed, 1))
    # The same packed, as ANTs does.
    reader = itk.TransformFileReaderTemplate[itk.D].New()
    reader.SetFileName(os.path.join(FOLDER, "itk_field.h5"))
    reader.Update()
    writer = itk.TransformFileWriterTemplate[itk.D].New()
    writer.SetFileName(os.path.join(FOLDER, "itk_field_z.h5"))
    writer.SetUseCompression(True)
    writer.SetInput(reader.GetTransformList()[0])
    writer.Update()
    expected["itk_field_z.h5"] = expected["itk_field.h5"]
    with open(os.path.join(FOLDER, "itk_points.json"), "w", encoding="ascii") as file:
        json.dump(expected, file, separators=(",", ":"))
        file.write("\n")


if __name__ == "__main__":
    main()
