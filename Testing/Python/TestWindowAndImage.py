# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The window casts the part of it that the volume covers, RenderToImage() all of the image: the rays
of a pixel are the same, to the last bit. In noise, taken from the nearest voxel behind a mask of
noise, a sample that is moved by the last bit now and then is another voxel's."""

import itertools
import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkPlaneSource
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkColorTransferFunction, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkVolume,
    vtkWindowToImageFilter)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

SIZE = 30
WIDTH, HEIGHT = 200, 190


def make_image(values):
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE)
    image.GetPointData().SetScalars(numpy_to_vtk(values.astype(numpy.uint8), deep=True))
    return image


def pixels_of(image):
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(HEIGHT, WIDTH, -1)[..., :3].astype(int)


class TestWindowAndImage(unittest.TestCase):
    def make_scene(self, number):
        random = numpy.random.default_rng(number)
        image = make_image(random.integers(0, 100, SIZE ** 3))
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        self.mapper.SetMaskInput(make_image(random.random(SIZE ** 3) < 0.5))
        self.mapper.SetMaskTypeToBinary()
        self.mapper.AutoAdjustSampleDistancesOff()
        self.mapper.PremultipliedAlphaOn()
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(5, 5, 5)
        lattice.FitToBounds(image.GetBounds())
        lattice.SetDisplacements(numpy_to_vtk(random.normal(size=(125, 3)), deep=True))
        self.mapper.SetDeformation(lattice)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0.0, 0.9)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 1.0, 0.2, 0.0)
        color.AddRGBPoint(100.0, 0.0, 1.0, 0.8)
        self.volume.GetProperty().SetScalarOpacity(opacity)
        self.volume.GetProperty().SetColor(color)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        # In the upper right of the window, so that the part starts in its middle.
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(*random.normal(size=3))
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        self.renderer.ResetCamera()
        camera.SetWindowCenter(-0.35, -0.3)

    def show(self, width, height):
        window = vtkRenderWindow()
        window.SetMultiSamples(0)
        window.OffScreenRenderingOn()
        window.SetSize(width, height)
        window.AddRenderer(self.renderer)
        window.Render()
        return window

    def count_differences(self):
        colors = vtkImageData()
        self.assertEqual(
            self.mapper.RenderToImage(self.renderer, self.volume, WIDTH, HEIGHT, colors), 1)
        window = self.show(WIDTH, HEIGHT)
        picture = vtkWindowToImageFilter()
        picture.SetInput(window)
        picture.ShouldRerenderOff()
        picture.ReadFrontBufferOff()
        picture.Update()
        image = pixels_of(colors)
        self.assertGreater((image.max(axis=2) > 50).sum(), 3000)
        self.assertEqual(image[:32].max(), 0)
        self.assertEqual(image[:, :32].max(), 0)
        return int((abs(image - pixels_of(picture.GetOutput())).max(axis=2) > 1).sum())

    def test_fast_kernels(self):
        different = []
        for number in range(10):
            self.make_scene(number)
            different.append(self.count_differences())
        print("pixels that differ:", different)
        self.assertEqual(sum(different), 0)

    def test_reference_kernels(self):
        self.make_scene(3)
        self.mapper.ReferenceKernelsOn()
        self.assertEqual(self.count_differences(), 0)

    def test_tiles_that_show_nothing(self):
        """Tiles without a ray are as those whose rays, which are counted, meet nothing; not as in the picture before."""
        self.make_scene(5)

        def render():
            images = vtkImageData(), vtkImageData()
            self.assertEqual(
                self.mapper.RenderToImage(self.renderer, self.volume, WIDTH, HEIGHT, *images), 1)
            return [vtk_to_numpy(image.GetPointData().GetScalars()) for image in images]

        camera = self.renderer.GetActiveCamera()
        camera.SetWindowCenter(0.0, 0.0)
        camera.Zoom(4.0)
        self.assertGreater(render()[0].reshape(-1, 4)[:, 3].min(), 0)
        camera.Zoom(0.2)
        colors, depths = render()
        self.mapper.CollectStatisticsOn()
        expected = render()
        self.assertGreater(colors.max(), 50)
        self.assertGreater((depths == 1.0).mean(), 0.5)
        self.assertTrue((colors == expected[0]).all())
        self.assertTrue((depths == expected[1]).all())

    def test_blending(self):
        """Over what was drawn before, in windows that take pixels and in those of several samples a pixel, which do not."""
        self.make_scene(6)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0.0, 0.0)
        opacity.AddPoint(100.0, 0.2)
        self.volume.GetProperty().SetScalarOpacity(opacity)
        behind = vtkRenderer()
        behind.SetBackground(0.7, 0.1, 0.3)
        plane = vtkPlaneSource()
        plane.SetNormal(*self.renderer.GetActiveCamera().GetDirectionOfProjection())
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(plane.GetOutputPort())
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.SetScale(500.0)
        actor.SetPosition(*numpy.add(self.volume.GetCenter(), numpy.multiply(40.0, plane.GetNormal())))

        def render(samples):
            window = vtkRenderWindow()
            window.SetMultiSamples(samples)
            window.SetAlphaBitPlanes(1)
            window.OffScreenRenderingOn()
            window.SetSize(WIDTH, HEIGHT)
            window.SetNumberOfLayers(2)
            window.AddRenderer(behind)
            window.AddRenderer(self.renderer)
            window.Render()
            self.assertEqual(window.GetMultiSamples(), samples)
            pixels = vtkUnsignedCharArray()
            window.GetRGBACharPixelData(0, 0, WIDTH - 1, HEIGHT - 1, 0, pixels)
            for each in behind, self.renderer:
                window.RemoveRenderer(each)
            return vtk_to_numpy(pixels).reshape(HEIGHT, WIDTH, 4).astype(int)

        renderer = self.renderer
        scenes = {
            "black": lambda: None,
            "color": lambda: renderer.SetBackground(0.2, 0.5, 0.9),
            "half of the window": lambda: renderer.SetViewport(0.31, 0.0, 1.0, 0.83),
            "alpha": lambda: renderer.SetBackgroundAlpha(0.4),
            "gradient": lambda: (renderer.GradientBackgroundOn(), renderer.SetBackground2(0.0, 0.8, 0.1)),
            "over another renderer": lambda: renderer.SetLayer(1),
            "before a plane": lambda: (renderer.AddActor(actor), renderer.ResetCameraClippingRange())}
        pictures = []
        for name, change in scenes.items():
            change()
            picture = render(0)
            self.assertLessEqual(abs(picture - render(4)).max(), 1, name)
            self.volume.VisibilityOff()
            changed = abs(picture - render(0)).max(axis=2) > 8
            self.volume.VisibilityOn()
            self.assertGreater(changed.sum(), 2000, name)
            self.assertLess(changed.mean(), 0.6, name)
            pictures.append(picture)
        for one, other in itertools.combinations(pictures, 2):
            self.assertGreater(abs(one - other).max(), 8)

    def test_few_pixels(self):
        """Windows of a few pixels, with rays that are farther or less far apart than these, and geometry."""
        self.make_scene(4)
        self.renderer.GetActiveCamera().SetWindowCenter(0.0, 0.0)
        cube = vtkCubeSource()
        cube.SetBounds(12.0, 18.0, 12.0, 18.0, 12.0, 18.0)
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(cube.GetOutputPort())
        actor = vtkActor()
        actor.SetMapper(mapper)
        self.renderer.AddActor(actor)
        for width, height in ((1, 1), (2, 2), (1, 5), (3, 3)):
            for distance in (0.3, 1.0, 1.5, 2.0, 100.0):
                with self.subTest(size=(width, height), distance=distance):
                    self.mapper.SetImageSampleDistance(distance)
                    window = self.show(width, height)
                    pixels = vtkUnsignedCharArray()
                    window.GetPixelData(0, 0, width - 1, height - 1, 0, pixels, 0)
                    if distance <= 2.0:  # else the only ray may lie outside of the window
                        self.assertGreater(vtk_to_numpy(pixels).max(), 50)
                    window.RemoveRenderer(self.renderer)


if __name__ == "__main__":
    unittest.main()
