# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Blend modes, cropping and clipping planes of the mapper from Python, against closed forms."""

import itertools
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


class TestComponentsAndMasks(unittest.TestCase):
    """Blend modes of several components, with masks, and with what does not count in them: the
    fast kernels against the reference kernels."""

    MODES = {"maximum": 1, "minimum": 2, "average": 3, "additive": 4, "isosurface": 5, "slice": 6}

    @classmethod
    def setUpClass(cls):
        size = 40
        z, y, x = numpy.mgrid[0:size, 0:size, 0:size].astype(float)

        def blob(center, width, height):
            distance = sum((p - c)**2 for p, c in zip((x, y, z), center))
            return numpy.round(height * numpy.exp(-distance / width))

        cls.fields = [blob((14, 20, 20), 90, 250), blob((26, 18, 22), 120, 200),
                      blob((20, 28, 15), 60, 230), blob((20, 20, 20), 200, 240)]
        cls.size = size
        net = vtkffd.vtkFFDLatticeSource()
        net.SetBounds(0, size - 1, 0, size - 1, 0, size - 1)
        net.SetDimensions(6, 6, 6)
        net.SetShapeToTwist()
        net.SetStrength(0.5)
        cls.lattice = net.GetLattice()

    def make_image(self, fields, dtype):
        image = vtkImageData()
        image.SetDimensions(3 * [self.size])
        image.GetPointData().SetScalars(numpy_to_vtk(
            numpy.stack([f.ravel() for f in fields], axis=-1).astype(dtype), deep=True))
        return image

    def make_scene(self, components, dtype, dependent, mode, deform=True):
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        # Of the blobs the least values that a ray meets are nothing that is seen.
        fields = [250.0 - f if mode == "minimum" else f for f in self.fields[:components]]
        mapper.SetInputData(self.make_image(fields, dtype))
        mapper.SetBlendMode(self.MODES[mode])
        mapper.SetDeformation(self.lattice if deform else None)
        mapper.SetNumberOfThreads(1)
        mapper.SetAverageIPScalarRange(10.0, 180.0)
        prop = vtkVolumeProperty()
        prop.SetIndependentComponents(not dependent)
        for c in range(components):
            opacity = vtkPiecewiseFunction()
            opacity.AddPoint(20.0 + 10.0 * c, 0.0)
            opacity.AddPoint(150.0, 0.9)
            color = vtkColorTransferFunction()
            color.AddRGBPoint(0.0, *numpy.roll([0.2, 0.3, 0.9], c))
            color.AddRGBPoint(250.0, *numpy.roll([1.0, 0.6, 0.1], c))
            prop.SetScalarOpacity(c, opacity)
            prop.SetColor(c, color)
            # Isosurfaces are those of the component with the largest weight: of the last one.
            prop.SetComponentWeight(c, 1.0 - 0.2 * ((c + 1) % components))
            prop.SetScalarOpacityUnitDistance(c, 20.0 if mode == "additive" else 1.0 + 0.5 * c)
        plane = vtkPlane()
        plane.SetOrigin(20.0, 20.0, 20.0)
        plane.SetNormal(0.3, 0.2, 1.0)
        prop.SetSliceFunction(plane)
        for i, value in enumerate((60.0, 120.0)):
            prop.GetIsoSurfaceValues().SetValue(i, value)
        prop.SetShade(0, mode == "isosurface")
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop)
        return mapper, prop, volume

    def render(self, mapper, volume, size=64):
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        renderer.GetActiveCamera().Azimuth(25)
        renderer.ResetCamera(0, self.size - 1, 0, self.size - 1, 0, self.size - 1)
        colors = vtkImageData()
        depths = vtkImageData()
        self.assertEqual(mapper.RenderToImage(renderer, volume, size, size, colors, depths), 1)
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(size, size, 4).astype(float)
        rgba[..., :3] *= rgba[..., 3:] / 255.0
        return rgba, vtk_to_numpy(depths.GetPointData().GetScalars()).reshape(size, size)

    def compare(self, mapper, volume, what):
        fast, depths = self.render(mapper, volume)
        mapper.ReferenceKernelsOn()
        reference, far = self.render(mapper, volume)
        mapper.ReferenceKernelsOff()
        self.assertGreater((reference[..., 3] > 10.0).sum(), 100, what)
        self.assertLess(numpy.abs(fast - reference).mean(), 0.15, what)
        self.assertGreater((numpy.abs(depths - far) < 1e-3).mean(), 0.97, what)
        return fast

    def test_components_equal_those_of_the_reference_kernels(self):
        for components, dependent in ((2, False), (3, False), (4, False), (2, True), (3, True),
                                      (4, True)):
            for mode in self.MODES:
                for dtype in (numpy.uint8, numpy.int16, numpy.float32, numpy.float64, numpy.int32):
                    if dependent and components > 2 and dtype != numpy.uint8:
                        continue # values that are colors
                    what = f"{components}, {dependent}, {mode}, {dtype}"
                    mapper, _, volume = self.make_scene(components, dtype, dependent, mode)
                    picture = self.compare(mapper, volume, what)
                    if dtype == numpy.uint8:
                        expected = picture
                        mapper.SetSpaceLeapingToOff()
                        off = self.render(mapper, volume)[0]
                        numpy.testing.assert_allclose(off, picture, atol=1.0, err_msg=what)
                    self.assertLess(numpy.abs(picture - expected).mean(), 0.1, what)

    @staticmethod
    def count_samples(mapper):
        statistics = mapper.GetStatistics()
        return statistics.GetSamplesPerRay() * statistics.GetNumberOfRays()

    def test_extremes_of_components_leap(self):
        # Noise beside the blobs: bounds of parts must hold for each component by itself.
        random = numpy.random.default_rng(7)
        fields = [numpy.kron(f, numpy.ones((3, 3, 3))) for f in self.fields]
        fields = [numpy.clip(f + random.integers(0, 10, f.shape), 0, 255) for f in fields]
        for mode, components, dtype in itertools.product(
                ("maximum", "minimum"), (2, 3, 4), (numpy.uint8, numpy.float32)):
            what = f"{mode}, {components}, {dtype}"
            mapper, _, volume = self.make_scene(components, dtype, False, mode)
            image = vtkImageData()
            image.SetDimensions(3 * [3 * self.size])
            image.SetSpacing(3 * [(self.size - 1) / (3 * self.size - 1)])
            image.GetPointData().SetScalars(numpy_to_vtk(numpy.stack(
                [255.0 - f.ravel() if mode == "minimum" else f.ravel()
                 for f in fields[:components]], axis=-1).astype(dtype), deep=True))
            mapper.SetInputData(image)
            mapper.CollectStatisticsOn()
            leaping, near = self.render(mapper, volume, size=200)
            samples = self.count_samples(mapper)
            mapper.SetSpaceLeapingToOff()
            all_samples, far = self.render(mapper, volume, size=200)
            # Of the least values, which are opaque where no blob is, only bounds of values tell.
            most = 0.75 if mode == "maximum" else 1.0
            self.assertLess(samples, most * self.count_samples(mapper), what)
            numpy.testing.assert_allclose(leaping, all_samples, atol=1.0, err_msg=what)
            # Depths are those of the first component that is seen.
            self.assertGreater((numpy.abs(near - far) < 1e-5).mean(), 0.99, what)

    def test_extremes_of_rays_that_are_far_apart(self):
        # A pixel is several voxels wide: each ray leaves out what is below its own extreme.
        random = numpy.random.default_rng(9)
        cells = [numpy.kron(random.integers(0, 256, (8, 8, 8)), numpy.ones((16, 16, 16)))
                 for _ in range(2)]
        size = cells[0].shape[0]
        for mode, components, dtype, deform in itertools.product(
                ("maximum", "minimum"), (1, 2), (numpy.uint8, numpy.float32), (False, True)):
            what = f"{mode}, {components}, {dtype}, {deform}"
            mapper, prop, volume = self.make_scene(components, dtype, False, mode, deform)
            image = vtkImageData()
            image.SetDimensions(3 * [size])
            image.SetSpacing(3 * [(self.size - 1) / (size - 1)])
            image.GetPointData().SetScalars(numpy_to_vtk(numpy.stack(
                [cell.ravel() for cell in cells[:components]], axis=-1).astype(dtype), deep=True))
            mapper.SetInputData(image)
            for c in range(components):
                prop.GetScalarOpacity(c).RemoveAllPoints()
                prop.GetScalarOpacity(c).AddPoint(0.0, 0.5)
            mapper.CollectStatisticsOn()
            leaping, near = self.render(mapper, volume, size=16)
            samples = self.count_samples(mapper)
            mapper.SetSpaceLeapingToOff()
            all_samples, far = self.render(mapper, volume, size=16)
            most = 0.7 if components == 1 else 0.9
            self.assertLess(samples, most * self.count_samples(mapper), what)
            numpy.testing.assert_allclose(leaping, all_samples, atol=1.0, err_msg=what)
            self.assertGreater((numpy.abs(near - far) < 1e-5).mean(), 0.99, what)

    def test_masks(self):
        half = numpy.ones((self.size, self.size, self.size))
        half[:, :, :17] = 0.0
        for components in (1, 2):
            for mode in self.MODES:
                mapper, _, volume = self.make_scene(components, numpy.uint8, False, mode)
                before = self.render(mapper, volume)[0]
                mapper.SetMaskInput(self.make_image([half], numpy.uint8))
                mapper.SetMaskTypeToBinary()
                picture = self.compare(mapper, volume, f"{components}, {mode}")
                self.assertGreater(numpy.abs(picture - before).mean(), 0.2, mode)

    def set_planes(self, prop, components, minimum=False):
        """Two-dimensional functions, whose last row looks as large gradients do; others are clear."""
        values = numpy.linspace(0.0, 250.0, 64)
        for c in range(components):
            texels = numpy.zeros((8, 64, 4), numpy.float32)
            parts = 1.0 - values / 250.0 if minimum else values / 250.0
            texels[..., :3] = numpy.stack([parts, 1.0 - parts, 0.5 + 0.3 * parts], axis=-1)[:, (
                numpy.arange(3) + c) % 3]
            texels[-1, :, 3] = (1.2 * parts - 0.1 * c - 0.2).clip(0.0, 0.8)
            plane = vtkImageData()
            plane.SetDimensions(64, 8, 1)
            plane.GetPointData().SetScalars(numpy_to_vtk(texels.reshape(-1, 4), deep=True))
            prop.SetTransferFunction2D(c, plane)
        prop.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)

    def test_planes(self):
        # Gradients count as large, and another array does not count.
        for components, dependent in ((1, False), (2, False), (4, False), (2, True), (3, True)):
            for mode in self.MODES:
                for dtype in (numpy.uint8, numpy.float64):
                    if dependent and components > 2 and dtype != numpy.uint8:
                        continue # values that are colors
                    what = f"{components}, {dependent}, {mode}, {dtype}"
                    mapper, prop, volume = self.make_scene(components, dtype, dependent, mode)
                    before = self.render(mapper, volume)[0]
                    self.set_planes(prop, components, mode == "minimum")
                    picture = self.compare(mapper, volume, what)
                    if mode != "isosurface":
                        self.assertGreater(numpy.abs(picture - before).mean(), 0.3, what)
                    mapper.SetSpaceLeapingToOff()
                    off = self.render(mapper, volume)[0]
                    numpy.testing.assert_allclose(off, picture, atol=1.01, err_msg=what)
                    array = numpy_to_vtk(self.fields[3].ravel(), deep=True)
                    array.SetName("second")
                    mapper.GetInput().GetPointData().AddArray(array)
                    mapper.SetTransfer2DYAxisArray("second")
                    numpy.testing.assert_allclose(
                        self.render(mapper, volume)[0], off, atol=1.01, err_msg=what)

    def test_normals_of_surfaces(self):
        # Those of the opacity, and those that count clipped voxels.
        for components in (1, 2):
            for dtype in (numpy.uint8, numpy.float32):
                what = f"{components}, {dtype}"
                mapper, prop, volume = self.make_scene(components, dtype, False, "isosurface")
                for c in range(components):
                    # Of one opacity everywhere on the surfaces: nothing there has a normal.
                    prop.GetScalarOpacity(c).RemoveAllPoints()
                    prop.GetScalarOpacity(c).AddPoint(20.0, 0.0)
                    prop.GetScalarOpacity(c).AddPoint(30.0, 0.9)
                before = self.render(mapper, volume)[0]
                mapper.ComputeNormalFromOpacityOn()
                picture = self.compare(mapper, volume, what)
                self.assertGreater(numpy.abs(picture - before).mean(), 0.1, what)
                mapper.ComputeNormalFromOpacityOff()
                plane = vtkPlane()
                plane.SetOrigin(20.0, 20.0, 20.0)
                plane.SetNormal(-1.0, 0.2, 0.3)
                mapper.AddClippingPlane(plane)
                clipped = self.compare(mapper, volume, what)
                prop.SetUseClippedVoxelIntensity(1)
                picture = self.compare(mapper, volume, what)
                self.assertGreater(numpy.abs(picture - clipped).mean(), 0.02, what)

    def count_lookups(self, mapper, volume):
        """Of distances to what is visible, for each ray: more where rays are sampled one at a time."""
        mapper.CollectStatisticsOn()
        self.render(mapper, volume, size=96)
        return mapper.GetStatistics().GetDistanceLookupsPerRay()

    def test_planes_and_labels_are_looked_up_by_vectors(self):
        half = numpy.ones((self.size, self.size, self.size))
        half[:, :, :17] = 2.0
        for mode in ("maximum", "minimum", "isosurface"):
            plain = self.count_lookups(*self.make_scene(1, numpy.uint8, False, mode)[::2])
            mapper, prop, volume = self.make_scene(1, numpy.uint8, False, mode)
            self.set_planes(prop, 1, mode == "minimum")
            planes = self.count_lookups(mapper, volume)
            mapper, _, volume = self.make_scene(1, numpy.uint8, False, mode)
            mapper.SetMaskInput(self.make_image([half], numpy.uint8))
            mapper.SetMaskTypeToLabelMap()
            labels = self.count_lookups(mapper, volume)
            self.assertLess(max(planes, labels), 1.6 * plain, mode)

    def test_what_does_not_count_keeps_vectors(self):
        # As gradient opacity, or counts for any kernel.
        gradient = vtkPiecewiseFunction()
        gradient.AddPoint(0.0, 0.0)
        gradient.AddPoint(50.0, 1.0)
        mask = self.make_image([numpy.ones((self.size, self.size, self.size))], numpy.uint8)
        for mode in ("maximum", "average", "isosurface"):
            mapper, prop, volume = self.make_scene(1, numpy.uint8, False, mode)
            expected = self.render(mapper, volume, size=96)[0]
            lookups = [self.count_lookups(mapper, volume)]
            prop.SetGradientOpacity(gradient)
            picture = self.render(mapper, volume, size=96)[0]
            numpy.testing.assert_array_equal(picture, expected)
            lookups.append(self.count_lookups(mapper, volume))
            prop.DisableGradientOpacityOn()
            mapper.SetMaskInput(mask)
            mapper.SetMaskTypeToBinary()
            picture = self.render(mapper, volume, size=96)[0]
            numpy.testing.assert_allclose(picture, expected, atol=1.0)
            lookups.append(self.count_lookups(mapper, volume))
            for components in (2, 4):
                mapper, _, volume = self.make_scene(components, numpy.uint8, False, mode)
                lookups.append(self.count_lookups(mapper, volume))
            self.assertLess(max(lookups), 1.6 * lookups[0], mode)


if __name__ == "__main__":
    unittest.main()
