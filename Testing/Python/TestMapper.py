# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mapper from Python, as a user would use it."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import (
    vtkImageData, vtkMultiBlockDataSet, vtkPiecewiseFunction, vtkTable)
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIZE = 20


def make_block():
    """A block of scalars 100 in the middle of zeros."""
    voxels = numpy.zeros((SIZE, SIZE, SIZE), dtype=numpy.uint8)
    voxels[6:14, 6:14, 6:14] = 100
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
    return image


class TestMapper(unittest.TestCase):
    def setUp(self):
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(make_block())
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0, 0.0)
        opacity.AddPoint(100, 0.5)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0, 1.0, 0.0, 0.0)
        prop = vtkVolumeProperty()
        prop.SetScalarOpacity(opacity)
        prop.SetColor(color)
        prop.SetInterpolationTypeToLinear()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(prop)
        self.renderer = vtkRenderer()
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(9.5, 9.5, 80.0)
        camera.SetFocalPoint(9.5, 9.5, 9.5)
        camera.SetClippingRange(30.0, 120.0)
        self.errors = []
        self.mapper.AddObserver("ErrorEvent", self.on_error)

    def on_error(self, _caller, _event, message=None):
        self.errors.append(message)

    def render(self, width=40, height=30):
        colors = vtkImageData()
        depths = vtkImageData()
        self.assertEqual(self.mapper.RenderToImage(
            self.renderer, self.volume, width, height, colors, depths), 1)
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(height, width, 4)
        z = vtk_to_numpy(depths.GetPointData().GetScalars()).reshape(height, width)
        return rgba, z

    def test_render_to_numpy(self):
        rgba, depths = self.render()
        self.assertEqual(rgba.dtype, numpy.uint8)
        self.assertEqual(depths.dtype, numpy.float32)
        self.assertGreater(rgba[15, 20, 3], 240)
        self.assertEqual(tuple(rgba[15, 20, :3]), (255, 0, 0))
        self.assertEqual(tuple(rgba[0, 0]), (0, 0, 0, 0))
        self.assertTrue(0.0 < depths[15, 20] < 1.0)
        self.assertEqual(depths[0, 0], 1.0)

    def test_premultiplied_alpha(self):
        self.volume.GetProperty().SetScalarOpacityUnitDistance(20.0)
        straight, _ = self.render()
        self.mapper.PremultipliedAlphaOn()
        premultiplied, _ = self.render()
        alpha = straight[15, 20, 3]
        self.assertTrue(50 < alpha < 200)
        self.assertEqual(tuple(straight[15, 20]), (255, 0, 0, alpha))
        self.assertEqual(tuple(premultiplied[15, 20]), (alpha, 0, 0, alpha))

    def test_lattice_moves_the_picture_and_the_bounds(self):
        rest, _ = self.render()
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(4, 4, 4)
        lattice.FitToBounds(self.mapper.GetBounds(), 0.0)
        self.mapper.SetDeformation(lattice)
        same, _ = self.render()
        self.assertTrue(numpy.array_equal(rest, same))
        for k in range(4):
            for j in range(4):
                for i in range(4):
                    lattice.SetDisplacement(i, j, k, 4.0, 0.0, 0.0)
        bounds = self.mapper.GetBounds()
        # Never too small; at most the tolerance of the inverse too large.
        self.assertTrue(3.95 < bounds[0] <= 4.0)
        self.assertTrue(23.0 <= bounds[1] < 23.05)
        moved, _ = self.render()

        def middle(image):
            columns = image[:, :, 3].astype(float).sum(axis=0)
            return (columns * numpy.arange(len(columns))).sum() / columns.sum()

        self.assertGreater(middle(moved), middle(rest) + 2.0)
        self.mapper.SetDeformation(None)
        again, _ = self.render()
        self.assertTrue(numpy.array_equal(rest, again))

    def test_affine_transforms_of_any_scale(self):
        """As from meters to millimeters: bounds are those of the image, the picture is the same."""
        expected, _ = self.render()
        camera = self.renderer.GetActiveCamera()
        place, focus = camera.GetPosition(), camera.GetFocalPoint()
        corners = numpy.indices((2, 2, 2)).reshape(3, 8).T * (SIZE - 1)
        for scale in (3e-3, 1.0, 1e3):
            with self.subTest(scale=scale):
                transform = vtkTransform()
                transform.RotateX(20)
                transform.Scale(scale, scale, scale)
                self.mapper.SetDeformation(transform)
                moved = [transform.TransformPoint(*corner) for corner in corners.tolist()]
                bounds = numpy.reshape(self.mapper.GetBounds(), (3, 2)).T
                self.assertLess(numpy.abs(bounds - [numpy.min(moved, axis=0), numpy.max(moved, axis=0)])
                                .max(), 0.02 * SIZE * max(scale, 0.1))
                self.mapper.SetSampleDistance(scale)
                self.volume.GetProperty().SetScalarOpacityUnitDistance(scale)
                camera.SetPosition(transform.TransformPoint(place))
                camera.SetFocalPoint(transform.TransformPoint(focus))
                camera.SetViewUp(transform.TransformVector(0, 1, 0))
                camera.SetClippingRange(30.0 * scale, 120.0 * scale)
                # Single precision does not reach the second one where T shrinks so much.
                for tolerance in (0.01, 1e-5):
                    self.mapper.SetInverseTolerance(tolerance)
                    rgba, _ = self.render()
                    self.assertEqual(self.errors, [])
                    self.assertLess(numpy.abs(rgba.astype(int) - expected).mean(), 0.5)

    def test_options_by_name(self):
        mapper = self.mapper
        mapper.SetInverseModeToFirstOrder()
        self.assertEqual(mapper.GetInverseMode(), mapper.FIRST_ORDER)
        self.assertEqual(mapper.GetInverseModeAsString(), "FIRST_ORDER")
        mapper.SetInverseMode(mapper.PULL_BACK)
        self.assertEqual(mapper.GetInverseModeAsString(), "PULL_BACK")
        mapper.SetSegmentation(mapper.GREEDY_ANGLE)
        self.assertEqual(mapper.GetSegmentationAsString(), "GREEDY_ANGLE")
        mapper.SetSpaceLeaping(mapper.SEGMENT)
        self.assertEqual(mapper.GetSpaceLeapingAsString(), "SEGMENT")
        mapper.SetOpacityLength(mapper.MATERIAL)
        self.assertEqual(mapper.GetOpacityLengthAsString(), "MATERIAL")

    def test_statistics(self):
        self.mapper.CollectStatisticsOn()
        self.render()
        counts = self.mapper.GetStatistics()
        self.assertGreater(counts.GetNumberOfRays(), 0)
        self.assertLessEqual(counts.GetNumberOfRays(), 40 * 30)
        self.assertAlmostEqual(
            counts.GetSamplesPerRay(), counts.GetNumberOfSamples() / counts.GetNumberOfRays())
        self.assertLessEqual(counts.GetNumberOfVisibleSamples(), counts.GetNumberOfSamples())
        self.assertGreater(counts.GetAverageSegmentLength(), 0.0)

    def test_wide_angles_and_few_pixels_keep_the_position(self):
        """Tiles are wide then: their rays must not be taken for parallel or evenly spread."""
        side = 96
        x = numpy.arange(side)
        wave = 127.0 + 60.0 * numpy.sin(0.5 * x)
        voxels = (wave[:, None, None] + wave[None, :, None] + wave[None, None, :]) / 3.0
        image = vtkImageData()
        image.SetDimensions(side, side, side)
        image.GetPointData().SetScalars(
            numpy_to_vtk(voxels.astype(numpy.uint8).ravel(), deep=True))
        self.mapper.SetInputData(image)
        opacity = self.volume.GetProperty().GetScalarOpacity()
        opacity.RemoveAllPoints()
        opacity.AddPoint(127, 0.0)
        opacity.AddPoint(160, 0.2)
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(8, 8, 8)
        lattice.FitToBounds(image.GetBounds())
        displacements = vtk_to_numpy(lattice.GetDisplacements())
        displacements[:, 0] = numpy.sin(numpy.arange(512) // 64)
        lattice.Modified()
        self.mapper.SetDeformation(lattice)
        self.mapper.SetInverseModeToFirstOrder()
        self.mapper.SetPositionTolerance(0.01)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(48.0, 40.0, 120.0)
        camera.SetFocalPoint(50.0, 48.0, 0.0)
        camera.SetClippingRange(1.0, 400.0)
        for angle in (90.0, 120.0, 140.0):
            camera.SetViewAngle(angle)
            self.mapper.ReferenceKernelsOff()
            fast, _ = self.render(48, 48)
            self.mapper.ReferenceKernelsOn()
            reference, _ = self.render(48, 48)
            self.assertGreater((reference[:, :, 3] > 0).mean(), 0.1)
            difference = numpy.abs(fast.astype(int) - reference.astype(int))[:, :, 3]
            # A sample at a face of the volume is inside or outside.
            self.assertLess(difference.mean(), 0.05, "view angle %g" % angle)
            self.assertLess((difference > 1).mean(), 0.01, "view angle %g" % angle)

    def test_errors_are_visible(self):
        self.mapper.SetPositionTolerance(float("nan"))
        self.assertEqual(len(self.errors), 1)
        self.assertEqual(self.mapper.GetPositionTolerance(), 0.1)
        self.assertEqual(
            self.mapper.RenderToImage(self.renderer, self.volume, 0, 5, vtkImageData()), 0)
        self.assertEqual(len(self.errors), 2)
        for data, words in ((vtkTable(), "give an image"), (vtkMultiBlockDataSet(), "its blocks")):
            self.errors.clear()
            self.mapper.SetInputDataObject(data)
            self.assertEqual(
                self.mapper.RenderToImage(self.renderer, self.volume, 5, 5, vtkImageData()), 0)
            self.assertEqual(len(self.errors), 1)
            self.assertIn(words, self.errors[0])

    def test_frames_of_nothing(self):
        for renderer, volume in ((None, self.volume), (self.renderer, None)):
            for render in (self.mapper.Render, self.mapper.GPURender):
                self.errors.clear()
                render(renderer, volume)
                self.assertEqual(len(self.errors), 1)
                self.assertIn("is null", self.errors[0])


# VTK hands the message over only when the observer says what it is.
TestMapper.on_error.CallDataType = "string0"

if __name__ == "__main__":
    unittest.main()
