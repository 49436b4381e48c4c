# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Blend modes, cropping and clipping planes of the mapper from Python, against closed forms."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIZE = 21


class TestBlendModes(unittest.TestCase):
    """Scalars are 10 z, from 0 to 200, seen along -z by a parallel camera; the colors are the
    scalars over 200, red only."""

    def setUp(self):
        z = numpy.arange(SIZE, dtype=numpy.float32) * 10
        image = vtkImageData()
        image.SetDimensions(SIZE, SIZE, SIZE)
        image.GetPointData().SetScalars(
            numpy_to_vtk(numpy.repeat(z, SIZE * SIZE), deep=True))
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        self.mapper.SetSampleDistance(0.05)
        self.opacity = vtkPiecewiseFunction()
        self.opacity.AddPoint(0, 0.5)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0, 0.0, 0.0, 0.0)
        color.AddRGBPoint(200, 1.0, 0.0, 0.0)
        self.prop = vtkVolumeProperty()
        self.prop.SetScalarOpacity(self.opacity)
        self.prop.SetColor(color)
        self.prop.SetInterpolationTypeToLinear()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.prop)
        self.renderer = vtkRenderer()
        self.camera = self.renderer.GetActiveCamera()
        self.camera.ParallelProjectionOn()
        self.camera.SetParallelScale(8.0)
        self.camera.SetPosition(10.0, 10.0, 100.0)
        self.camera.SetFocalPoint(10.0, 10.0, 10.0)
        self.camera.SetClippingRange(50.0, 150.0)

    def render(self):
        """RGBA of the middle of the picture, the z that its depth stands for, and the picture."""
        colors = vtkImageData()
        depths = vtkImageData()
        self.assertEqual(
            self.mapper.RenderToImage(self.renderer, self.volume, 32, 32, colors, depths), 1)
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(32, 32, 4)
        depth = vtk_to_numpy(depths.GetPointData().GetScalars()).reshape(32, 32)[16, 16]
        return [int(c) for c in rgba[16, 16]], 100.0 - (50.0 + 100.0 * depth), rgba

    def stretch(self, factor):
        """Deform by z -> factor z."""
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(5, 5, 5)
        lattice.FitToBounds((0, 20, 0, 20, 0, 20), 0.0)
        d = vtk_to_numpy(lattice.GetDisplacements()).reshape(5, 5, 5, 3)
        for k in range(5):
            rest = [0.0, 0.0, 0.0]
            lattice.GetRestPoint(0, 0, k, rest)
            d[k, :, :, 2] = (factor - 1.0) * rest[2]
        lattice.Modified()
        self.mapper.SetDeformation(lattice)

    def test_extremes(self):
        self.mapper.SetBlendModeToMaximumIntensity()
        pixel, z, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255, delta=2)
        self.assertAlmostEqual(pixel[3], 128, delta=1)
        self.assertAlmostEqual(z, 20.0, delta=0.1)
        self.mapper.SetBlendModeToMinimumIntensity()
        pixel, z, _ = self.render()
        self.assertAlmostEqual(pixel[0], 0, delta=2)
        self.assertAlmostEqual(z, 0.0, delta=0.1)

    def test_sums(self):
        self.mapper.SetBlendModeToAverageIntensity()
        self.mapper.SetAverageIPScalarRange(100, 200)
        pixel, _, _ = self.render()
        # Values of 0.5 to 1 of the range, half opaque.
        self.assertAlmostEqual(pixel[0], 255 * 0.75 * 0.5, delta=2)
        self.assertEqual(pixel[3], 255)
        self.mapper.SetBlendModeToAdditive()
        self.prop.SetScalarOpacityUnitDistance(20.0)
        pixel, _, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255 * 0.5 * 0.5, delta=2)
        self.stretch(1.5)
        pixel, _, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255 * 0.5 * 0.5 * 1.5, delta=2)

    def test_isosurface(self):
        self.mapper.SetBlendModeToIsoSurface()
        values = self.prop.GetIsoSurfaceValues()
        values.SetValue(0, 123.4)
        pixel, z, _ = self.render()
        self.assertAlmostEqual(z, 12.34, delta=1e-3)
        self.assertAlmostEqual(pixel[0], 255 * 123.4 / 200, delta=2)
        self.assertAlmostEqual(pixel[3], 128, delta=1)
        self.stretch(1.5)
        self.assertAlmostEqual(self.render()[1], 1.5 * 12.34, delta=0.02)
        values.SetNumberOfContours(2)
        values.SetValue(1, 50.0)
        self.assertAlmostEqual(self.render()[0][3], 191, delta=1)

    def test_no_isosurface(self):
        # Nothing, and no error.
        self.mapper.SetBlendModeToIsoSurface()
        self.prop.GetIsoSurfaceValues().SetNumberOfContours(0)
        for reference in (False, True):
            self.mapper.SetReferenceKernels(reference)
            self.assertEqual(list(self.render()[0]), [0, 0, 0, 0])

    def test_slice(self):
        self.mapper.SetBlendModeToSlice()
        plane = vtkPlane()
        plane.SetOrigin(0.0, 0.0, 12.0)
        plane.SetNormal(0.0, 0.0, -1.0)
        self.prop.SetSliceFunction(plane)
        pixel, z, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255 * 120 / 200, delta=2)
        self.assertAlmostEqual(z, 12.0, delta=1e-3)
        self.stretch(1.5)
        self.assertAlmostEqual(self.render()[0][0], 255 * 120 / 200 / 1.5, delta=2)

    def test_cropping(self):
        self.stretch(1.5)
        self.mapper.SetBlendModeToMaximumIntensity()
        self.mapper.CroppingOn()
        self.mapper.SetCroppingRegionPlanes(0, 20, 0, 20, 3, 12)
        self.assertEqual(self.mapper.GetCroppingSpaceAsString(), "REST")
        pixel, z, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255 * 120 / 200, delta=2)
        self.assertAlmostEqual(z, 18.0, delta=0.1)
        self.mapper.SetCroppingSpaceToDeformed()
        pixel, z, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255 * 80 / 200, delta=2)
        self.assertAlmostEqual(z, 12.0, delta=0.1)
        # What is above and below instead, and nothing of the left half.
        self.mapper.SetCroppingRegionPlanes(10, 20, 0, 20, 3, 12)
        self.mapper.SetCroppingRegionFlags(1 << (1 + 3) | 1 << (1 + 3 + 18))
        pixel, z, rgba = self.render()
        self.assertAlmostEqual(pixel[0], 255, delta=2)
        self.assertEqual(rgba[:, :15, 3].max(), 0)
        self.assertGreater(rgba[:, 17:, 3].min(), 0)

    def test_clipping_planes(self):
        self.mapper.SetBlendModeToMaximumIntensity()
        plane = vtkPlane()
        plane.SetOrigin(0.0, 0.0, 9.0)
        plane.SetNormal(0.0, 0.0, -2.0)
        self.mapper.AddClippingPlane(plane)
        pixel, z, _ = self.render()
        self.assertAlmostEqual(pixel[0], 255 * 90 / 200, delta=2)
        self.assertAlmostEqual(z, 9.0, delta=0.1)
        # It stays where it is when the volume is moved.
        self.volume.SetPosition(0.0, 0.0, 3.0)
        self.assertAlmostEqual(self.render()[0][0], 255 * 60 / 200, delta=2)

    def test_options(self):
        mapper = self.mapper
        before = self.render()[2].copy()
        self.assertEqual(mapper.GetUseJittering(), 0)
        mapper.SetSampleDistance(1.7)  # no sample on a face
        coarse = self.render()[2].copy()
        mapper.UseJitteringOn()
        jittered = self.render()[2]
        self.assertGreater(jittered[8:24, 8:24].std(axis=(0, 1)).max(), 0.5)
        self.assertLess(coarse[8:24, 8:24].std(axis=(0, 1)).max(), 0.01)
        mapper.UseJitteringOff()
        mapper.SetSampleDistance(0.05)
        mapper.SetFinalColorWindow(-1.0)
        inverted = self.render()[2]
        self.assertAlmostEqual(int(inverted[16, 16, 0]), 255 - int(before[16, 16, 0]), delta=2)
        self.assertIn("FinalColorWindow: -1", str(mapper))
        self.assertIn("CroppingSpace: REST", str(mapper))
        self.assertIn("UseJittering: 0", str(mapper))


if __name__ == "__main__":
    unittest.main()
