# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frames with fewer rays than pixels around thin geometry, against those of a ray for each pixel.

In fog that is the same everywhere the two differ only where rays end: at small spheres and lines
before, in and behind it, which must leave no marks around them and be as deep in the fog as they
are.
"""

import itertools
import time
import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkFiltersProgrammable import vtkProgrammableFilter
from vtkmodules.vtkFiltersSources import vtkLineSource, vtkSphereSource
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkColorTransferFunction, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkVolume,
    vtkWindowToImageFilter)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

SIZE = 21
PIXELS = 200


def add_geometry(renderer, source):
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    actor.GetProperty().SetColor(0.0, 0.4, 1.0)
    renderer.AddActor(actor)


class TestCoarseFrames(unittest.TestCase):
    def setUp(self):
        self.image = image = vtkImageData()
        image.SetDimensions(SIZE, SIZE, SIZE)
        image.GetPointData().SetScalars(
            numpy_to_vtk(numpy.full(SIZE ** 3, 100.0, dtype=numpy.float32), deep=True))
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        self.mapper.SetSampleDistance(0.1)
        self.mapper.SetInteractiveSampleDistance(0.1)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0.0, 0.08)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 1.0, 0.7, 0.2)
        self.volume.GetProperty().SetScalarOpacity(opacity)
        self.volume.GetProperty().SetColor(color)
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(0.1, 0.1, 0.2)
        self.renderer.AddVolume(self.volume)
        for x, y, z in itertools.product((-3.0, 3.0, 10.0, 17.0, 23.0), repeat=3):
            sphere = vtkSphereSource()
            sphere.SetCenter(x, y, z)
            sphere.SetRadius(0.5)
            add_geometry(self.renderer, sphere)
        for y, z in itertools.product((-3.0, 3.0, 10.0, 17.0, 23.0), repeat=2):
            line = vtkLineSource()
            line.SetPoint1(-3.0, y, z)
            line.SetPoint2(23.0, y, z)
            add_geometry(self.renderer, line)
        self.window = vtkRenderWindow()
        self.window.SetMultiSamples(0)
        self.window.OffScreenRenderingOn()
        self.window.SetSize(PIXELS, PIXELS)
        self.window.AddRenderer(self.renderer)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(40.0, 28.0, 80.0)
        camera.SetFocalPoint(10.0, 10.0, 10.0)
        camera.SetViewAngle(18.0)
        self.renderer.ResetCameraClippingRange()

    def render(self, step):
        """A frame with so many pixels between rays."""
        self.mapper.SetMinimumImageSampleDistance(step)
        self.mapper.SetMaximumImageSampleDistance(step)
        self.window.SetDesiredUpdateRate(1e9)
        self.window.Render()
        pixels = vtkWindowToImageFilter()
        pixels.SetInput(self.window)
        pixels.ShouldRerenderOff()
        pixels.ReadFrontBufferOff()
        pixels.Update()
        colors = vtk_to_numpy(pixels.GetOutput().GetPointData().GetScalars())
        return colors.reshape(PIXELS, PIXELS, 3).astype(int)

    def test_thin_geometry(self):
        fine = self.render(1.0)
        self.renderer.RemoveVolume(self.volume)
        without = self.render(1.0)
        self.renderer.AddVolume(self.volume)
        foggy = abs(fine - without).max(axis=-1) > 20
        self.assertGreater(foggy.sum(), 5000)
        for step in (2.0, 3.3, 4.0):
            with self.subTest(step=step):
                difference = abs(self.render(step) - fine).max(axis=-1)[foggy]
                print("step %g: mean %.2f, 99 %%: %d, more than 40: %.2f %%" % (
                    step, difference.mean(), numpy.percentile(difference, 99),
                    100.0 * (difference > 40).mean()))
                self.assertLess(difference.mean(), 2.5)
                self.assertLess((difference > 40).mean(), 0.01)

    def test_frames_that_show_parts_again(self):
        # While a control point is dragged and the bounds grow by it, against frames of their own.
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(7, 7, 7)
        lattice.FitToBounds(self.mapper.GetInput().GetBounds())
        self.mapper.SetDeformation(lattice)
        self.renderer.GetActiveCamera().SetViewAngle(40.0)
        # In blocks, so that the depths of neighboring rays are unlike.
        z, y, x = numpy.mgrid[0:SIZE, 0:SIZE, 0:SIZE] // 4
        values = 100.0 * ((x + y + z) % 2)
        self.mapper.GetInput().GetPointData().SetScalars(
            numpy_to_vtk(values.ravel().astype(numpy.float32), deep=True))
        opacity = self.volume.GetProperty().GetScalarOpacity()
        opacity.RemoveAllPoints()
        opacity.AddPoint(20.0, 0.0)
        opacity.AddPoint(60.0, 0.5)
        self.render(2.0)
        reused = 0.0
        for step in range(1, 5):
            lattice.SetDisplacement(0, 3, 5, -3.0 * step, 0.0, 0.0)
            again = self.render(2.0)
            reused = max(reused, self.mapper.GetReusedFraction())
            fresh = self.mapper.NewInstance()
            fresh.ShallowCopy(self.mapper)
            self.volume.SetMapper(fresh)
            self.mapper, kept = fresh, self.mapper
            difference = abs(self.render(2.0) - again).max(axis=-1)
            self.mapper = kept
            self.volume.SetMapper(kept)
            print("step %d: largest %d, more than 20: %d" % (
                step, difference.max(), (difference > 20).sum()))
            self.assertLess((difference > 20).sum(), 20)
        self.assertGreater(reused, 0.2)

    def test_time_that_rays_do_not_take(self):
        """Fewer rays would not make such frames shorter, and a still one does not take for ever."""
        # The volume gets all of the time that is allotted.
        self.renderer.RemoveAllViewProps()
        self.renderer.AddVolume(self.volume)
        self.mapper.CollectStatisticsOn()
        self.mapper.SetSampleDistance(1.0)
        self.mapper.SetInteractiveSampleDistance(1.0)
        rays = self.mapper.GetStatistics().GetNumberOfRays
        source = vtkProgrammableFilter()
        source.SetInputData(self.image)

        def execute():
            time.sleep(0.1)
            source.GetOutput().ShallowCopy(self.image)

        source.SetExecuteMethod(execute)
        ways = {"before the rays": (lambda: self.mapper.SetInputConnection(
                    source.GetOutputPort()), source.Modified),
                "with the rays": (lambda: self.mapper.AddObserver(
                    "StartEvent", lambda *_: time.sleep(0.1)), self.mapper.Modified)}
        for name, (begin, change) in ways.items():
            with self.subTest(name):
                self.mapper.RemoveAllInputs()
                self.mapper.SetInputData(self.image)
                self.window.SetDesiredUpdateRate(1e-4)
                self.window.Render()
                still = rays()
                begin()
                self.window.SetDesiredUpdateRate(20.0)
                for _ in range(12):
                    change()
                    self.window.Render()
                print("%s: %d rays of %d, %g s expected" % (
                    name, rays(), still, self.mapper.GetExpectedStillTime()))
                self.assertGreater(rays(), still / 6)
                self.assertLess(self.mapper.GetExpectedStillTime(), 1.0)

    def test_time_that_rays_take(self):
        """They are cast farther apart, also where they get slower with each frame."""
        self.renderer.RemoveAllViewProps()
        self.renderer.AddVolume(self.volume)
        self.mapper.CollectStatisticsOn()
        self.mapper.SetMaximumImageSampleDistance(100.0)
        self.window.SetDesiredUpdateRate(1e-4)
        self.window.Render()
        still = self.mapper.GetExpectedStillTime()
        rays = self.mapper.GetStatistics().GetNumberOfRays
        whole = rays()
        self.window.SetDesiredUpdateRate(10.0 / still)
        for frame in range(40):
            self.mapper.SetInteractiveSampleDistance(0.1 / 1.05 ** frame)
            self.window.Render()
        print("%d rays of %d" % (rays(), whole))
        self.assertLess(rays(), whole / 10)

    def test_without_depths(self):
        # Nothing that is drawn hides the fog.
        self.mapper.IntermixIntersectingGeometryOff()
        fine = self.render(1.0)
        self.assertLess(abs(self.render(4.0) - fine)[60:140, 60:140].max(), 4)


if __name__ == "__main__":
    unittest.main()
