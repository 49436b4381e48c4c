#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""ClipBox: pictures of the boxes of a partition, blended in order, are the picture of the whole;
no sample is taken twice or left out."""

import os
import unittest

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import (vtkDataSetAttributes, vtkImageData,
                                           vtkPiecewiseFunction)
from vtkmodules.vtkCommonCore import vtkLogger, vtkUnsignedCharArray
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty)

import vtkffd

SIZE = 96


def read(name):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(os.path.join(os.environ["FFD_TEST_DATA"], name))
    reader.Update()
    return reader.GetOutput()


class Scene:
    def __init__(self, strength, opaque, image=None):
        self.image = image or read("engine.vti")
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.CollectStatisticsOn()
        self.mapper.SetEarlyRayTerminationThreshold(0.0)
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(7, 7, 7)
        self.lattice.FitToBounds(read("engine.vti").GetBounds())
        vtkffd.vtkFFDLatticeSource.ApplyShape(
            self.lattice, vtkffd.vtkFFDLatticeSource.TWIST, strength)
        self.mapper.SetDeformation(self.lattice)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(60, 0.0)
        opacity.AddPoint(120, 1.0 if opaque else 0.05)
        opacity.AddPoint(255, 1.0 if opaque else 0.3)
        colors = vtkColorTransferFunction()
        colors.AddRGBPoint(0, 0.2, 0.1, 0.0)
        colors.AddRGBPoint(255, 1.0, 0.9, 0.5)
        prop = vtkVolumeProperty()
        prop.SetColor(colors)
        prop.SetScalarOpacity(opacity)
        prop.SetScalarOpacityUnitDistance(2.0)
        prop.SetInterpolationTypeToLinear()
        prop.ShadeOn()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(prop)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        self.renderer.GetActiveCamera().SetPosition(1.0, 0.7, 0.8)
        self.renderer.ResetCamera()

    def picture(self):
        """Premultiplied RGBA, 0 to 1, and the number of samples."""
        colors = vtkImageData()
        self_ok = self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, colors)
        assert self_ok == 1
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).astype(float) / 255.0
        rgba[:, :3] *= rgba[:, 3:]
        return rgba, self.mapper.GetStatistics().GetNumberOfSamples()


def partition(bounds):
    """Four boxes of unequal size: x cut once, each half cut in y. Infinite outwards."""
    x = bounds[0] + 0.43 * (bounds[1] - bounds[0])
    low = bounds[2] + 0.61 * (bounds[3] - bounds[2])
    high = bounds[2] + 0.29 * (bounds[3] - bounds[2])
    inf = float("inf")
    # Front to back from a camera at large x, y, z: larger x first, then larger y.
    return [(x, inf, high, inf, -inf, inf), (x, inf, -inf, high, -inf, inf),
            (-inf, x, low, inf, -inf, inf), (-inf, x, -inf, low, -inf, inf)]


class TestClipBox(unittest.TestCase):
    def check_partition(self, strength, opaque):
        scene = Scene(strength, opaque)
        whole, samples = scene.picture()
        self.assertGreater(samples, 10000)
        total = 0
        blended = np.zeros_like(whole)
        for box in partition(scene.mapper.GetBounds()):
            scene.mapper.SetClipBox(box)
            part, count = scene.picture()
            self.assertGreater(count, 0)
            self.assertLess(count, samples)
            total += count
            blended += (1.0 - blended[:, 3:]) * part
        # Leaps end elsewhere in a part.
        self.assertLess(abs(total - samples), 1e-4 * samples)
        difference = np.abs(blended - whole) * 255.0
        self.assertLessEqual(difference.max(), 5.0)
        self.assertLess(difference.mean(), 0.25)

    def test_identity_semi_transparent(self):
        self.check_partition(0.0, False)

    def test_identity_opaque(self):
        self.check_partition(0.0, True)

    def test_strong_semi_transparent(self):
        self.check_partition(2.0, False)

    def test_strong_opaque(self):
        self.check_partition(2.0, True)

    def count(self, scene, box):
        """Samples, and visible ones, of the rays in a box; of all of space if there is none."""
        scene.mapper.RemoveClipBox()
        if box:
            scene.mapper.SetClipBox(box)
        scene.picture()
        statistics = scene.mapper.GetStatistics()
        return np.array([statistics.GetNumberOfSamples(), statistics.GetNumberOfVisibleSamples()])

    def check_cut(self, scene, axis, at, message):
        """Of two boxes that share a face, exactly one takes each sample."""
        inf = float("inf")
        lower, upper = [-inf, inf] * 3, [-inf, inf] * 3
        lower[2 * axis + 1] = upper[2 * axis] = at
        parts = self.count(scene, lower) + self.count(scene, upper)
        self.assertEqual(parts.tolist(), self.count(scene, None).tolist(), message)

    def test_every_sample_in_one_box(self):
        """Rounding neither leaves out a sample beside the face of two boxes nor takes it twice."""
        random = np.random.default_rng(1)
        for strength in (0.0, 1.0):
            scene = Scene(strength, False)
            # Leaps end elsewhere in a part.
            scene.mapper.SetSpaceLeapingToOff()
            camera = scene.renderer.GetActiveCamera()
            bounds = np.reshape(scene.mapper.GetBounds(), (3, 2))
            for view in range(30):
                camera.SetPosition(*random.normal(size=3))
                camera.SetFocalPoint(0.0, 0.0, 0.0)
                scene.renderer.ResetCamera()
                camera.Zoom(random.uniform(1.0, 3.0))
                axis = random.integers(3)
                at = bounds[axis] @ (lambda part: (1.0 - part, part))(random.uniform(0.3, 0.7))
                self.check_cut(scene, axis, at, (strength, view))

    def test_samples_just_before_a_face(self):
        """What rays share begins at the first sample, though that lies a little before the face."""
        scene = Scene(0.0, False)
        scene.mapper.SetSpaceLeapingToOff()
        scene.mapper.SetSampleDistance(1.0)
        scene.mapper.LockSampleDistanceToInputSpacingOff()
        scene.mapper.SetDeformation(None)
        bounds = scene.mapper.GetBounds()
        camera = scene.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetPosition(0.0, 0.0, 1.0)
        scene.renderer.ResetCamera()
        # Samples lie at n + 0.9999 from the near plane, a hundredth before multiples from the volume.
        near = bounds[5] + 20.0 + 0.0099
        distance = camera.GetPosition()[2] - near
        camera.SetClippingRange(distance, distance + 1000.0)
        for n in range(21, 145):
            self.check_cut(scene, 2, near - (n + 0.9999) - 0.0005, n)

    def test_all_and_none(self):
        scene = Scene(1.0, False)
        whole, samples = scene.picture()
        scene.mapper.SetClipBox(-1e6, 1e6, -1e6, 1e6, -1e6, 1e6)
        same, count = scene.picture()
        self.assertEqual(count, samples)
        self.assertTrue(np.array_equal(whole, same))
        for outside in ((1e5, 1e6, -1e6, 1e6, -1e6, 1e6), (-1e6, 1e6, -1e6, 1e6, -1e6, -1e5)):
            scene.mapper.SetClipBox(outside)
            nothing, count = scene.picture()
            self.assertEqual(count, 0)
            self.assertEqual(nothing.max(), 0.0)
        scene.mapper.RemoveClipBox()
        again, count = scene.picture()
        self.assertEqual(count, samples)

    def test_rays_within_a_box_are_those_of_the_whole(self):
        """Rays share evaluations with those of their tile, and tiles lie on whole multiples of the
        window: where what is seen begins changes nothing of the rays that lie within a box."""
        scene = Scene(2.0, True)
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetSize(SIZE, SIZE)
        window.AddRenderer(scene.renderer)
        camera = scene.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetPosition(0.0, 0.0, 1.0)
        scene.renderer.ResetCamera()

        def render():
            pixels = vtkUnsignedCharArray()
            window.Render()
            window.GetPixelData(0, 0, SIZE - 1, SIZE - 1, 0, pixels, 0)
            return vtk_to_numpy(pixels).reshape(SIZE, SIZE, 3).astype(int)

        whole = render()
        bounds = scene.mapper.GetBounds()
        scene.mapper.SetClipBox(0.5 * (bounds[0] + bounds[1]), 1e9, -1e9, 1e9, -1e9, 1e9)
        part = render()
        cut = part.any(axis=(0, 2)).argmax()
        self.assertGreater(cut, whole.any(axis=(0, 2)).argmax() + 10)
        self.assertGreater(whole[:, cut + 1:].max(), 100)
        # The window rounds its texture elsewhere; other tiles change ten times as many bytes.
        difference = np.abs(part - whole)[:, cut + 1:]
        self.assertLessEqual(difference.max(), 1)
        self.assertLessEqual((difference > 0).sum(), 4)

    def test_part_of_the_volume(self):
        """A box needs only the voxels that it is pulled back to."""
        scene = Scene(1.0, False)
        # Blocks of a part lie elsewhere, so leaps end elsewhere: the samples are compared without.
        scene.mapper.SetSpaceLeapingToOff()
        bounds = scene.mapper.GetBounds()
        middle = 0.5 * (bounds[4] + bounds[5])
        box = (-1e9, 1e9, -1e9, 1e9, -float("inf"), middle)
        scene.mapper.SetClipBox(box)
        wanted, samples = scene.picture()
        part = vtkImageData()
        part.DeepCopy(scene.image)
        inverse = vtkffd.vtkFFDLattice()
        inverse.DeepCopy(scene.lattice)
        inverse.Inverse()
        needed = [0.0] * 6
        inverse.GetDeformedBounds(list(bounds[:5]) + [middle], needed)
        extent = list(part.GetExtent())
        for a in range(3):
            lower = part.GetOrigin()[a] + extent[2 * a] * part.GetSpacing()[a]
            first = int(np.floor((needed[2 * a] - lower) / part.GetSpacing()[a])) - 3
            last = int(np.ceil((needed[2 * a + 1] - lower) / part.GetSpacing()[a])) + 3
            extent[2 * a] = max(extent[2 * a], first)
            extent[2 * a + 1] = min(extent[2 * a + 1], last)
        voxels = part.GetNumberOfPoints()
        part.Crop(extent)
        self.assertLess(part.GetNumberOfPoints(), 0.6 * voxels)
        alone = Scene(1.0, False, part)
        alone.mapper.SetClipBox(box)
        alone.mapper.SetWholeBounds(scene.image.GetBounds())
        self.assertEqual(alone.mapper.GetBounds(), bounds)
        alone.mapper.SetSpaceLeapingToOff()
        alone.renderer.GetActiveCamera().DeepCopy(scene.renderer.GetActiveCamera())
        got, count = alone.picture()
        self.assertLess(abs(count - samples), 1e-4 * samples)
        self.assertLessEqual(np.abs(got - wanted).max() * 255.0, 4.0)

    def check_part(self, rng, prepare=lambda mapper: None, hidden=0):
        """Makes a scene of a random volume, and one of no more of it than a random box needs;
        their pictures must be equal to the last bit. `hidden`: slices that are blanked."""
        size = 41
        image = vtkImageData()
        image.SetDimensions(size, size, size)
        image.SetOrigin(rng.uniform(-50.0, 50.0, 3))
        image.SetSpacing(rng.uniform(0.5, 2.0, 3))
        waves = rng.uniform(12.0, 54.0, 3) / 10.0
        x, y, z = np.meshgrid(*3 * [np.linspace(-1.0, 1.0, size)], indexing="ij")
        values = (128.0 + 60.0 * np.sin(waves[0] * x) + 40.0 * np.cos(waves[1] * y) +
                  25.0 * np.sin(waves[2] * z * x))
        scalar_type = (np.uint8, np.float32)[rng.integers(2)]
        image.GetPointData().SetScalars(
            numpy_to_vtk(np.clip(values, 0, 255).astype(scalar_type).ravel(), deep=True))
        if hidden:
            ghosts = np.zeros(size ** 3, np.uint8)
            ghosts[:hidden * size * size] = vtkDataSetAttributes.HIDDENPOINT
            array = numpy_to_vtk(ghosts, deep=True)
            array.SetName(vtkDataSetAttributes.GhostArrayName())
            image.GetPointData().AddArray(array)
        shapes = vtkffd.vtkFFDLatticeSource
        shape = (shapes.TWIST, shapes.BEND, shapes.BULGE, shapes.TAPER)[rng.integers(4)]
        strength = rng.uniform(0.2, 1.5)
        opaque = bool(rng.integers(2))

        def make(data):
            scene = Scene(0.0, opaque, data)
            scene.lattice.FitToBounds(image.GetBounds())
            shapes.ApplyShape(scene.lattice, shape, strength)
            opacity = scene.volume.GetProperty().GetScalarOpacity()
            opacity.RemoveAllPoints()
            opacity.AddPoint(120, 0.0)
            opacity.AddPoint(124, 1.0 if opaque else 0.1)
            opacity.AddPoint(255, 1.0 if opaque else 0.3)
            prepare(scene.mapper)
            return scene

        whole = make(image)
        whole.renderer.ResetCamera(whole.mapper.GetBounds())
        bounds = np.reshape(whole.mapper.GetBounds(), (3, 2))
        box = bounds.copy()
        for a in range(3):
            cut = bounds[a, 0] + rng.uniform(0.3, 0.7) * (bounds[a, 1] - bounds[a, 0])
            side = rng.integers(3 if a > 0 else 2)
            if side < 2:
                box[a, side] = cut
        needed = [0.0] * 6
        inverse = vtkffd.vtkFFDLattice()
        inverse.DeepCopy(whole.lattice)
        inverse.Inverse()
        inverse.GetDeformedBounds(box.ravel(), needed)
        extent = list(image.GetExtent())
        for a in range(3):
            # The inverse is a fitted lattice: some voxels more than the box needs.
            first, last = ((needed[2 * a + i] - image.GetOrigin()[a]) / image.GetSpacing()[a]
                           for i in (0, 1))
            extent[2 * a] = max(extent[2 * a], int(np.floor(first)) - 8)
            extent[2 * a + 1] = min(extent[2 * a + 1], int(np.ceil(last)) + 8)
        part = vtkImageData()
        part.DeepCopy(image)
        part.Crop(extent)
        box[box == bounds] = np.tile((-np.inf, np.inf), (3, 1))[box == bounds]
        alone = make(part)
        alone.renderer.GetActiveCamera().DeepCopy(whole.renderer.GetActiveCamera())
        alone.mapper.SetWholeBounds(image.GetBounds())
        alone.mapper.SetWholeScalarRange(image.GetScalarRange())
        for scene in (whole, alone):
            scene.mapper.SetClipBox(box.ravel())
        wanted, samples = whole.picture()
        got, _ = alone.picture()
        self.assertGreater(samples, 100)
        # Rays that are integrated one by one are rounded otherwise.
        self.assertLessEqual(255.0 * np.abs(got - wanted).max(), 1.01 if hidden else 0.0)
        return whole, alone, part.GetNumberOfPoints() / image.GetNumberOfPoints()

    def test_parts_take_the_same_samples(self):
        """Positions of samples are rounded as in the whole: no sample is on the other side of a
        face, and no normal is another one."""
        rng = np.random.default_rng(7)
        parts = [self.check_part(rng)[2] for _ in range(24)]
        self.assertLess(np.mean(parts), 0.8)

    def test_cropped_parts(self):
        """Cropping planes at rest between voxels: their numbers count from another voxel."""
        rng = np.random.default_rng(11)

        def crop(mapper):
            b = np.reshape(mapper.GetDataSetInput().GetBounds(), (3, 2))
            mapper.SetCropping(True)
            mapper.SetCroppingRegionFlags(0x7FFDFFF)
            if not planes:
                planes.extend(np.ravel(b[:, :1] + rng.uniform((0.2, 0.6), (0.4, 0.8), (3, 2)) *
                                       (b[:, 1:] - b[:, :1])))
            mapper.SetCroppingRegionPlanes(*planes)

        for _ in range(6):
            planes = []
            self.check_part(rng, crop)

    def test_parts_with_hidden_voxels(self):
        """Rays that are integrated one by one."""
        rng = np.random.default_rng(5)
        for _ in range(6):
            self.check_part(rng, hidden=8)

    def test_traced_part(self):
        """Rays are traced through a part as through the whole."""
        rng = np.random.default_rng(5)
        whole, alone, fraction = self.check_part(rng)
        self.assertLess(fraction, 0.9)
        outputs = []
        for scene in (whole, alone):
            scene.mapper.SetSpaceLeapingToOff()
            tracer = vtkffd.vtkFFDRayTracer()
            tracer.SetRenderer(scene.renderer)
            tracer.SetVolume(scene.volume)
            tracer.SetImageSize(SIZE, SIZE)
            tracer.AddPixelGrid(7, 7)
            tracer.Update()
            outputs.append([vtk_to_numpy(tracer.GetOutput(i).GetPoints().GetData())
                            for i in (0, 2)])
        for i in (0, 1):
            self.assertGreater(len(outputs[0][i]), 50)
            np.testing.assert_allclose(outputs[1][i], outputs[0][i], atol=1e-4)

    def test_range_of_the_whole(self):
        """Tables and blend modes of a part are those of the whole whose range it is told."""
        size = 25
        image = vtkImageData()
        image.SetDimensions(size, size, size)
        ramp = np.repeat(np.linspace(0.0, 100.0, size), size * size).astype(np.float32)
        scalars = numpy_to_vtk(ramp, deep=True)
        scalars.SetName("ramp")
        image.GetPointData().SetScalars(scalars)
        cut = 0.5 * (size - 1) - 0.25
        box = (-1e9, 1e9, -1e9, 1e9, -float("inf"), cut)

        def make(data):
            scene = Scene(0.0, False, data)
            scene.mapper.SetDeformation(None)
            scene.mapper.SetSpaceLeapingToOff()
            scene.mapper.SetBlendModeToAverageIntensity()
            scene.mapper.SetClipBox(box)
            scene.mapper.SetWholeBounds(image.GetBounds())
            opacity = scene.volume.GetProperty().GetScalarOpacity()
            opacity.RemoveAllPoints()
            opacity.AddPoint(0, 1.0)
            opacity.AddPoint(100, 1.0)
            scene.renderer.ResetCamera(image.GetBounds())
            return scene

        def gray(scene):
            return scene.picture()[0][:, 0]

        wanted = gray(make(image))
        self.assertGreater(wanted.max(), 0.3)
        part = vtkImageData()
        part.DeepCopy(image)
        part.Crop((0, size - 1, 0, size - 1, 0, (size - 1) // 2 + 2))
        scene = make(part)
        self.assertEqual(scene.mapper.GetWholeScalarRange(), (1.0, -1.0))
        alone = gray(scene)
        self.assertGreater((alone - wanted).max(), 0.15)
        scene.mapper.SetWholeScalarRange(0.0, 100.0)
        self.assertLessEqual(np.abs(gray(scene) - wanted).max(), 1.5 / 255.0)
        # A copy has it; without one it is the range of the part again.
        copy = vtkffd.vtkFFDInverseRayVolumeMapper()
        copy.ShallowCopy(scene.mapper)
        self.assertEqual(copy.GetWholeScalarRange(), (0.0, 100.0))
        scene.mapper.SetWholeScalarRange(1.0, -1.0)
        self.assertTrue(np.array_equal(gray(scene), alone))

        # A part that holds no number at all.
        vtk_to_numpy(part.GetPointData().GetScalars())[:] = np.nan
        part.GetPointData().GetScalars().Modified()
        scene = make(part)
        scene.mapper.SetWholeScalarRange(0.0, 100.0)
        self.assertEqual(gray(scene).max(), 0.0)
        scene.mapper.SetWholeScalarRange(1.0, -1.0)
        verbosity = vtkLogger.GetCurrentVerbosityCutoff()
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        errors = []
        scene.mapper.AddObserver("ErrorEvent", lambda o, e: errors.append(e))
        self.assertEqual(
            scene.mapper.RenderToImage(scene.renderer, scene.volume, SIZE, SIZE, vtkImageData()), 0)
        self.assertEqual(len(errors), 1)
        # Ranges that are none change nothing.
        scene.mapper.SetWholeScalarRange(2.0, 5.0)
        for bad in (float("nan"), float("inf")):
            scene.mapper.SetWholeScalarRange(0.0, bad)
            self.assertEqual(scene.mapper.GetWholeScalarRange(), (2.0, 5.0))
        self.assertEqual(len(errors), 3)
        vtkLogger.SetStderrVerbosity(verbosity)

    def test_bad_box(self):
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetClipBox(0, 1, 0, 1, 0, 1)
        verbosity = vtkLogger.GetCurrentVerbosityCutoff()
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        for bad in ((1, 0, 0, 1, 0, 1), (0, 1, 0, float("nan"), 0, 1)):
            errors = []
            mapper.AddObserver("ErrorEvent", lambda o, e: errors.append(e))
            mapper.SetClipBox(bad)
            self.assertEqual(len(errors), 1)
            mapper.RemoveObservers("ErrorEvent")
            box = [0.0] * 6
            mapper.GetClipBox(box)
            self.assertEqual(box, [0, 1, 0, 1, 0, 1])
        errors = []
        mapper.AddObserver("ErrorEvent", lambda o, e: errors.append(e))
        mapper.SetWholeBounds(0, 1, 0, 1, 0, float("inf"))
        self.assertEqual(len(errors), 1)
        self.assertEqual(mapper.GetWholeBounds(), (1, -1, 1, -1, 1, -1))
        vtkLogger.SetStderrVerbosity(verbosity)


if __name__ == "__main__":
    unittest.main()
