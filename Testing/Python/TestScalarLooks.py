# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Components, masks, cells and gradient opacity of the mapper from Python, against closed forms."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIZE = 11
LENGTH = SIZE - 1


def constant(value):
    """A function, of opacity or a channel of colour."""
    function = vtkPiecewiseFunction()
    function.AddPoint(0, value)
    return function


def colour(red, green, blue):
    function = vtkColorTransferFunction()
    function.AddRGBPoint(0, red, green, blue)
    return function


class TestScalarLooks(unittest.TestCase):
    """Seen along -z by a parallel camera, through 10 units of constant opacity."""

    def setUp(self):
        self.image = vtkImageData()
        self.image.SetDimensions(SIZE, SIZE, SIZE)
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.SetSampleDistance(0.05)
        self.mapper.SetEarlyRayTerminationThreshold(0.0)
        self.prop = vtkVolumeProperty()
        self.prop.SetInterpolationTypeToLinear()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.prop)
        self.renderer = vtkRenderer()
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(4.0)
        camera.SetPosition(5.0, 5.0, 100.0)
        camera.SetFocalPoint(5.0, 5.0, 5.0)
        camera.SetClippingRange(50.0, 150.0)

    def set_points(self, values):
        self.image.GetPointData().SetScalars(numpy_to_vtk(
            numpy.ascontiguousarray(values, dtype=numpy.float32), deep=True))

    def set_functions(self, component, opacity, red, green, blue):
        self.prop.SetScalarOpacity(component, constant(opacity))
        self.prop.SetColor(component, colour(red, green, blue))

    def render(self, x=16, y=16):
        colours = vtkImageData()
        self.assertEqual(
            self.mapper.RenderToImage(self.renderer, self.volume, 32, 32, colours), 1)
        rgba = vtk_to_numpy(colours.GetPointData().GetScalars()).reshape(32, 32, 4)
        return [int(c) for c in rgba[y, x]]

    def expect(self, expected, x=16, y=16, delta=2):
        for found, wanted in zip(self.render(x, y), expected):
            self.assertAlmostEqual(found, 255.0 * wanted, delta=delta)

    def test_independent_components(self):
        self.set_points(numpy.ones((SIZE ** 3, 2)))
        self.set_functions(0, 0.05, 1.0, 0.0, 0.0)
        self.set_functions(1, 0.05, 0.0, 1.0, 0.0)
        # Two of opacity a make the opacity a, and colours c1 + c2.
        self.expect([1.0, 1.0, 0.0, 1.0 - 0.95 ** LENGTH])
        self.prop.SetComponentWeight(1, 0.0)
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.95 ** LENGTH])

    def test_dependent_components(self):
        values = numpy.ones((SIZE ** 3, 4)) * [0.2, 0.4, 0.6, 1.0]
        self.set_points(values)
        self.set_functions(0, 0.1, 1.0, 1.0, 1.0)
        self.prop.IndependentComponentsOff()
        self.expect([0.2, 0.4, 0.6, 1.0 - 0.9 ** LENGTH])

    def test_gradient_opacity(self):
        z, _, _ = numpy.mgrid[0:SIZE, 0:SIZE, 0:SIZE]
        self.set_points(z.ravel() * 2.0)
        self.set_functions(0, 0.1, 1.0, 1.0, 1.0)
        gradients = vtkPiecewiseFunction()
        gradients.AddPoint(0.0, 0.0)
        gradients.AddPoint(4.0, 1.0)
        self.prop.SetGradientOpacity(gradients)
        # Half of the opacity of each sample; less at the faces, where gradients are one-sided.
        self.expect([1.0, 1.0, 1.0, 1.0 - 0.9 ** (LENGTH / 2)], delta=6)
        self.prop.DisableGradientOpacityOn()
        self.expect([1.0, 1.0, 1.0, 1.0 - 0.9 ** LENGTH])

    def test_masks(self):
        self.set_points(numpy.ones(SIZE ** 3))
        self.set_functions(0, 0.1, 1.0, 0.0, 0.0)
        _, _, x = numpy.mgrid[0:SIZE, 0:SIZE, 0:SIZE]
        mask = vtkImageData()
        mask.SetDimensions(SIZE, SIZE, SIZE)
        mask.GetPointData().SetScalars(
            numpy_to_vtk((x.ravel() > 5).astype(numpy.uint8) * 3, deep=True))
        self.mapper.SetMaskInput(mask)
        self.assertIs(self.mapper.GetMaskInput(), mask)
        self.mapper.SetMaskTypeToBinary()
        self.assertEqual(self.mapper.GetMaskType(), self.mapper.BinaryMaskType)
        self.assertEqual(self.render(x=8)[3], 0)
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.9 ** LENGTH], x=24)
        self.mapper.SetMaskTypeToLabelMap()
        self.prop.SetLabelColor(3, colour(0.0, 0.0, 1.0))
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.9 ** LENGTH], x=8)
        self.expect([0.0, 0.0, 1.0, 1.0 - 0.9 ** LENGTH], x=24)
        self.mapper.SetMaskBlendFactor(0.5)
        self.expect([0.5, 0.0, 0.5, 1.0 - 0.9 ** LENGTH], x=24)
        self.mapper.SetMaskInput(None)
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.9 ** LENGTH], x=24)

    def test_cells(self):
        self.image.GetCellData().SetScalars(
            numpy_to_vtk(numpy.ones(LENGTH ** 3, dtype=numpy.float32), deep=True))
        self.set_functions(0, 0.1, 1.0, 1.0, 0.0)
        self.expect([1.0, 1.0, 0.0, 1.0 - 0.9 ** LENGTH])


if __name__ == "__main__":
    unittest.main()
