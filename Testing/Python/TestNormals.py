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
