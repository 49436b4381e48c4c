# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far lit pictures of a crumpled lattice are from those of the reference kernels, as the
docstring of PositionTolerance says: normals of the default kernels are those of interpolated rays."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIDE = 96  # voxels
POINTS = 20  # control points an axis
MOST = 3.0  # voxels that each is moved by, at most, along each axis
PIXELS = 128


class TestNormals(unittest.TestCase):

    def setUp(self):
        z, y, x = numpy.meshgrid(*3 * [numpy.arange(SIDE)], indexing="ij")
        values = (100 + 60 * numpy.sin(0.11 * x) * numpy.cos(0.09 * y) +
                  50 * numpy.sin(0.1 * z + 0.05 * x))
        image = vtkImageData()
        image.SetDimensions(SIDE, SIDE, SIDE)
        image.GetPointData().SetScalars(
            numpy_to_vtk(values.astype(numpy.float32).ravel(), deep=True))
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(POINTS, POINTS, POINTS)
        lattice.FitToBounds(image.GetBounds())
        moves = numpy.random.RandomState(2).uniform(-MOST, MOST, (POINTS,) * 3 + (3,))
        for k, j, i in numpy.ndindex(POINTS, POINTS, POINTS):
            lattice.SetDisplacement(i, j, k, *moves[k, j, i])
        self.assertTrue(lattice.IsFoldFree())
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        self.mapper.SetDeformation(lattice)
        self.mapper.SetSampleDistance(0.5)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(110, 0)
        opacity.AddPoint(150, 0.5)
        self.color = vtkColorTransferFunction()
        self.property = vtkVolumeProperty()
        self.property.SetScalarOpacity(opacity)
        self.property.SetColor(self.color)
        self.property.SetInterpolationTypeToLinear()
        self.property.SetAmbient(0.1)
        self.property.SetDiffuse(0.9)
        self.property.SetSpecular(0.3)
        self.property.SetSpecularPower(20)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetFocalPoint(48, 48, 48)
        camera.SetPosition(138, 118, 238)
        camera.SetClippingRange(50, 500)

    def render(self, reference):
        picture = vtkImageData()
        self.mapper.SetReferenceKernels(reference)
        self.assertTrue(
            self.mapper.RenderToImage(self.renderer, self.volume, PIXELS, PIXELS, picture))
        return vtk_to_numpy(picture.GetPointData().GetScalars()).astype(float)

    def differences(self):
        """Of the covered pixels, the largest of the three channels."""
        a, b = self.render(True), self.render(False)
        covered = (a[:, 3] > 0) | (b[:, 3] > 0)
        self.assertGreater(covered.sum(), 5000)
        return numpy.abs(a - b)[covered, :3].max(axis=1)

    def test_lit_pictures_follow_the_reference(self):
        self.property.ShadeOn()
        self.color.AddRGBPoint(0, 1, 1, 1)
        for tolerance, mean, most in ((0.1, 0.5, 5), (0.02, 0.2, 2)):
            self.mapper.SetPositionTolerance(tolerance)
            differences = self.differences()
            self.assertLess(differences.mean(), mean)
            self.assertLessEqual(numpy.percentile(differences, 99), most)

    def test_normals_of_the_opacity_follow_the_reference(self):
        """With all that samples of one component may look up, and at the faces of the volume, which
        this object reaches."""
        self.property.ShadeOn()
        self.color.AddRGBPoint(0, 1, 1, 1)
        self.mapper.SetPositionTolerance(0.02)
        of_values = self.render(False)
        self.mapper.ComputeNormalFromOpacityOn()
        self.assertGreater(numpy.abs(self.render(False) - of_values).mean(), 1)
        image = self.mapper.GetInput()
        floats = image.GetPointData().GetScalars()
        labels = vtkImageData()
        labels.CopyStructure(image)
        labels.GetPointData().SetScalars(numpy_to_vtk(
            (numpy.arange(SIDE ** 3) % SIDE > SIDE / 2).astype(numpy.uint8), deep=True))
        plane = vtkImageData()
        plane.SetDimensions(64, 2, 1)
        plane.SetSpacing(4, 100, 1)
        opacity = numpy.clip((numpy.arange(128) % 64 - 28) / 10, 0, 1) * 0.5
        plane.GetPointData().SetScalars(
            numpy_to_vtk(numpy.stack(4 * [opacity], 1).astype(numpy.float32), deep=True))
        plane.GetPointData().GetScalars().SetName("opacity")
        gradients = vtkPiecewiseFunction()
        gradients.AddPoint(0, 0)
        gradients.AddPoint(5, 1)

        def scalars(kind):
            image.GetPointData().SetScalars(
                numpy_to_vtk(vtk_to_numpy(floats).astype(kind), deep=True))

        def label_map(on):
            self.property.SetLabelScalarOpacity(1, self.property.GetScalarOpacity())
            self.mapper.SetMaskTypeToLabelMap()
            self.mapper.SetMaskInput(labels if on else None)

        changes = (
            ("floats", lambda on: None),
            ("bytes", lambda on: scalars("u1" if on else "f4")),
            ("doubles", lambda on: scalars("f8" if on else "f4")),
            ("nearest", lambda on: self.property.SetInterpolationType(0 if on else 1)),
            ("labels", label_map),
            ("gradient opacity", lambda on: self.property.SetGradientOpacity(
                gradients if on else None)),
            ("2-D function", lambda on: (
                self.property.SetTransferFunction2D(plane),
                self.property.SetTransferFunctionMode(1 if on else 0))),
            ("pre-integrated", lambda on: self.mapper.SetClassification(1 if on else 0)),
        )
        for name, change in changes:
            with self.subTest(name):
                change(True)
                differences = self.differences()
                # Which voxel is the nearest one depends on positions within the tolerance.
                self.assertLess(differences.mean(), 1.5 if name == "nearest" else 0.3)
                if name != "nearest":
                    self.assertLessEqual(numpy.percentile(differences, 99), 4)
                change(False)

    def test_nothing_is_missing_at_the_faces(self):
        """D that goes on linearly outside of this lattice folds, and led rays out of the volume."""
        self.property.ShadeOff()
        for value, *rgb in ((90, 1, 0, 0), (130, 0, 1, 0), (170, 0, 0, 1), (210, 1, 1, 1)):
            self.color.AddRGBPoint(value, *rgb)
        self.mapper.SetPositionTolerance(0.005)
        differences = self.differences()
        self.assertLess(differences.mean(), 0.1)
        self.assertLessEqual(numpy.percentile(differences, 99.9), 3)


if __name__ == "__main__":
    unittest.main()
