#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Write the transform files of this folder, and points.json: what ITK says they do to points.

Needs SimpleITK (pip install SimpleITK), which no test needs: the files are in the repository.
"""

import json
import os
import random

import SimpleITK as sitk

FOLDER = os.path.dirname(os.path.abspath(__file__))
RANDOM = random.Random(7)
# Orthonormal, no axis along another.
OBLIQUE = [0.8, -0.6, 0.0, 0.48, 0.64, -0.6, 0.36, 0.48, 0.8]
FLIPPED = [0.0, -1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0]
IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
CENTER = (10.0, -5.0, 4.0)


def number(low, high):
    return round(RANDOM.uniform(low, high), 6)


def spline(direction, origin):
    transform = sitk.BSplineTransform(3, 3)
    transform.SetTransformDomainOrigin(origin)
    transform.SetTransformDomainDirection(direction)
    transform.SetTransformDomainPhysicalDimensions((40.0, 30.0, 24.0))
    transform.SetTransformDomainMeshSize((4, 3, 2))
    transform.SetParameters([number(-2.0, 2.0) for _ in transform.GetParameters()])
    return transform


def field(direction, origin):
    image = sitk.Image((6, 5, 4), sitk.sitkVectorFloat64, 3)
    image.SetOrigin(origin)
    image.SetSpacing((8.0, 7.5, 8.0))
    image.SetDirection(direction)
    for k in range(4):
        for j in range(5):
            for i in range(6):
                image[i, j, k] = (number(-2.0, 2.0), number(-2.0, 2.0), number(-2.0, 2.0))
    return image


def field_transform(image):
    # The transform takes the image away.
    return sitk.DisplacementFieldTransform(sitk.Image(image))


def inside(direction, origin, size):
    """Points well within a box that starts at the origin."""
    points = []
    for _ in range(12):
        local = [RANDOM.uniform(0.05, 0.95) * length for length in size]
        points.append([origin[row] + sum(direction[3 * row + column] * local[column]
                                         for column in range(3)) for row in range(3)])
    return points


def main():
    expected = {}

    def record(name, transform, points):
        expected[name] = [[point, list(transform.TransformPoint(point))] for point in points]

    def write(name, transform, points):
        sitk.WriteTransform(transform, os.path.join(FOLDER, name))
        record(name, transform, points)

    origin = (-3.0, 7.0, 11.0)
    box = (40.0, 30.0, 24.0)
    for name, direction in (("identity", IDENTITY), ("flipped", FLIPPED), ("oblique", OBLIQUE)):
        write("bspline_%s.tfm" % name, spline(direction, origin), inside(direction, origin, box))
        image = field(direction, origin)
        grid = (40.0, 30.0, 24.0)
        points = inside(direction, origin, grid)
        write("field_%s.tfm" % name, field_transform(image), points)
        floats = sitk.Cast(image, sitk.sitkVectorFloat32)
        for suffix, compress in ((".mha", False), (".mhd", False), (".nrrd", False),
                                 (".nii", False), ("_z.mha", True), ("_z.nrrd", True),
                                 (".nii.gz", True)):
            if name != "oblique" and suffix not in (".mha", ".nrrd", ".nii"):
                continue
            file = "field_%s%s" % (name, suffix)
            sitk.WriteImage(floats, os.path.join(FOLDER, file), useCompression=compress)
            record(file, field_transform(image), points)

    anywhere = inside(IDENTITY, (-50.0, -50.0, -50.0), (100.0, 100.0, 100.0))
    euler = sitk.Euler3DTransform(CENTER, 0.3, -0.4, 0.5, (1.0, 2.0, 3.0))
    write("euler.tfm", euler, anywhere)
    zyx = sitk.Euler3DTransform(euler)
    zyx.SetComputeZYX(True)
    write("euler_zyx.tfm", zyx, anywhere)
    affine = sitk.AffineTransform([1.1, 0.1, -0.2, 0.05, 0.9, 0.1, 0.0, -0.1, 1.2],
                                  (4.0, -3.0, 2.0), CENTER)
    write("affine.tfm", affine, anywhere)
    write("translation.tfm", sitk.TranslationTransform(3, (1.0, -2.0, 3.5)), anywhere)
    versor = sitk.VersorRigid3DTransform()
    versor.SetCenter(CENTER)
    versor.SetRotation((1.0, 2.0, -1.0), 0.7)
    versor.SetTranslation((3.0, 2.0, 1.0))
    write("versor.tfm", versor, anywhere)
    similarity = sitk.Similarity3DTransform()
    similarity.SetCenter(CENTER)
    similarity.SetRotation((1.0, 2.0, -1.0), 0.7)
    similarity.SetTranslation((3.0, 2.0, 1.0))
    similarity.SetScale(1.25)
    write("similarity.tfm", similarity, anywhere)
    composite = sitk.CompositeTransform(3)
    composite.AddTransform(affine)
    composite.AddTransform(euler)
    composite.AddTransform(spline(IDENTITY, origin))  # applied first
    write("composite.tfm", composite, inside(IDENTITY, origin, box))

    with open(os.path.join(FOLDER, "points.json"), "w", encoding="ascii") as file:
        json.dump(expected, file, indent=None, separators=(",", ":"))
        file.write("\n")


if __name__ == "__main__":
    main()
