# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the vector kernels look up beside a table: their pictures against the reference kernels."""

import itertools
import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIZE = (30, 34, 28)
PIXELS = 48
#: Where time or samples count: in small pictures rays are further apart, and leap less.
PIXELS_COUNTED = 96


def points(*pairs):
    function = vtkPiecewiseFunction()
    for x, y in pairs:
        function.AddPoint(x, y)
    return function


def scalars_image(values):
    image = vtkImageData()
    image.SetDimensions(*SIZE)
    image.SetSpacing(1.0, 0.9, 1.2)
    image.GetPointData().SetScalars(numpy_to_vtk(numpy.ascontiguousarray(values), deep=True))
    return image


class TestPacketLooks(unittest.TestCase):
    def setUp(self):
        z, y, x = numpy.mgrid[0:SIZE[2], 0:SIZE[1], 0:SIZE[0]].astype(float)
        blobs = (numpy.exp(-((x - 12) ** 2 + (y - 15) ** 2 + (z - 14) ** 2) / 60)
                 + 0.8 * numpy.exp(-((x - 21) ** 2 + (y - 20) ** 2 + (z - 12) ** 2) / 40)
                 + 0.05 * numpy.sin(x) * numpy.cos(1.3 * y))
        self.field = numpy.clip(blobs / blobs.max(), 0.0, 1.0)
        self.second = numpy.clip((x + y) / (SIZE[0] + SIZE[1]), 0.0, 1.0)
        self.labels = ((x > 14).astype(int) + 2 * (y > 16)).astype(numpy.uint8)

    def make(self, kind, deformed):
        scale = {"u1": 255, "i1": 120, "u2": 4000, "i2": 3000, "f4": 1.0, "f8": 1e6, "i4": 1e6}[kind]
        image = scalars_image((self.field * scale).astype(kind).ravel())
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetSampleDistance(0.7)
        if deformed:
            source = vtkffd.vtkFFDLatticeSource()
            source.SetBounds(image.GetBounds())
            source.SetShape(source.TWIST)
            source.SetStrength(0.6)
            source.Update()
            mapper.SetDeformation(source.GetLattice())
        prop = vtkVolumeProperty()
        prop.SetInterpolationTypeToLinear()
        prop.ShadeOn()
        prop.SetScalarOpacity(points((0.1 * scale, 0.0), (0.5 * scale, 0.2), (scale, 0.6)))
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 0.2, 0.3, 1.0)
        color.AddRGBPoint(scale, 1.0, 0.6, 0.2)
        prop.SetColor(color)
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop)
        return scale, mapper, prop, volume

    def set_plane(self, prop, nearest=False):
        # Colors and opacities that change along both axes; invisible at low scalars.
        v, u = numpy.mgrid[0:9, 0:17] / numpy.array([8.0, 16.0]).reshape(2, 1, 1)
        texels = numpy.stack([u, 1.0 - v, 0.5 + 0.5 * u * v,
                              numpy.where(u > 0.2, 0.5 * u * (0.2 + 0.8 * v), 0.0)], axis=-1)
        texels[6, 12, 3] = 1.0
        plane = vtkImageData()
        plane.SetDimensions(17, 9, 1)
        plane.GetPointData().SetScalars(
            numpy_to_vtk(texels.reshape(-1, 4).astype(numpy.float32), deep=True))
        prop.SetTransferFunction2D(plane)
        prop.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)
        if nearest:
            prop.SetInterpolationTypeToNearest()

    def picture(self, mapper, volume, reference, depths=None, pixels=PIXELS, clipping=None):
        mapper.SetReferenceKernels(reference)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(70.0, 60.0, 90.0)
        camera.SetFocalPoint(15.0, 15.0, 16.0)
        camera.SetViewAngle(26.0)
        renderer.ResetCameraClippingRange()
        if clipping:
            camera.SetClippingRange(*clipping)
        image = vtkImageData()
        self.assertEqual(mapper.RenderToImage(renderer, volume, pixels, pixels, image, depths), 1)
        return vtk_to_numpy(image.GetPointData().GetScalars()).astype(float)

    def compare(self, mapper, volume, what, mean=0.15, tail=3.0):
        fast = self.picture(mapper, volume, False)
        slow = self.picture(mapper, volume, True)
        self.assertGreater((slow[:, 3] > 20).mean(), 0.1, what)
        difference = numpy.abs(fast - slow).max(axis=1)
        self.assertLess(difference.mean(), mean, what)
        self.assertLess(numpy.percentile(difference, 99.5), tail, what)
        return fast

    def test_the_reference_is_as_close_as_positions_are(self):
        # An inverse to a hundredth of a voxel is no oracle of positions to a thousandth.
        _, mapper, prop, volume = self.make("f4", True)
        prop.SetScalarOpacity(points((0.0, 0.0), (0.29, 0.0), (0.3, 1.0), (0.31, 0.0)))
        mapper.SetPositionTolerance(0.001)
        picture = self.picture(mapper, volume, True)
        mapper.SetInverseTolerance(1e-6)
        true = self.picture(mapper, volume, True)
        self.assertGreater((true[:, 3] > 20).mean(), 0.05)
        self.assertLess(numpy.abs(picture - true).mean(), 0.02)

    def test_pictures_do_not_depend_on_the_clipping_range(self):
        for mode in ("Composite", "MaximumIntensity", "MinimumIntensity", "AverageIntensity",
                     "Additive", "IsoSurface", "Slice"):
            for deformed in (False, True):
                with self.subTest(mode=mode, deformed=deformed):
                    scale, mapper, prop, volume = self.make("u1", deformed)
                    getattr(mapper, "SetBlendModeTo" + mode)()
                    prop.GetIsoSurfaceValues().SetValue(0, 0.4 * scale)
                    if mode != "Composite":
                        prop.SetScalarOpacity(points((0.0, 0.3), (scale, 0.9)))
                    middle = mapper.GetInput().GetCenter()
                    plane = vtkPlane()
                    plane.SetOrigin(middle)
                    plane.SetNormal(1.0, 2.0, 3.0)
                    prop.SetSliceFunction(plane)
                    near, far = (self.picture(mapper, volume, False, pixels=150, clipping=clipping)
                                 for clipping in ((60.0, 200.0), (21.7, 1234.5)))
                    self.assertGreater((near[:, 3] > 0).mean(), 0.1)
                    self.assertLess((near != far).mean(), 1e-4)

    def test_pictures_are_close_to_those_of_exact_positions(self):
        # A lit surface of fine structure, through which an error of a tenth of a voxel shows. Where
        # segments end depends on the size, and so does how far below the tolerance they are.
        means = []
        shapes = vtkffd.vtkFFDLatticeSource
        for size in (72, 96):
            z, y, x = numpy.mgrid[0:size, 0:size, 0:size] / 2.5
            values = (numpy.sin(x) * numpy.cos(y) + numpy.sin(y) * numpy.cos(z) +
                      numpy.sin(z) * numpy.cos(x))
            image = vtkImageData()
            image.SetDimensions(size, size, size)
            image.GetPointData().SetScalars(numpy_to_vtk(
                numpy.clip(128 + 60 * values, 0, 255).astype("u1").ravel(), deep=True))
            _, mapper, prop, volume = self.make("u1", False)
            mapper.SetInputData(image)
            mapper.SetSampleDistance(1.0)
            mapper.PremultipliedAlphaOn()
            prop.SetScalarOpacity(points((150, 0.0), (165, 1.0)))
            renderer = vtkRenderer()
            renderer.AddVolume(volume)
            renderer.GetActiveCamera().SetPosition(5.0, 3.0, 2.0)
            renderer.GetActiveCamera().SetViewUp(0.0, 0.0, 1.0)
            for shape, strength in ((shapes.WAVE, 1.0), (shapes.BULGE, 0.25), (shapes.BULGE, 0.5),
                                    (shapes.RANDOM, 1.0)):
                lattice = vtkffd.vtkFFDLattice()
                lattice.SetDimensions(8, 8, 8)
                lattice.FitToBounds(image.GetBounds(), 0.0)
                shapes.ApplyShape(lattice, shape, strength)
                mapper.SetDeformation(lattice)
                renderer.GetActiveCamera().SetViewAngle(30.0)
                renderer.ResetCamera()
                renderer.GetActiveCamera().Zoom(1.3)
                renderer.ResetCameraClippingRange()
                pictures = []
                for tolerance in (0.1, 0.005):
                    mapper.SetPositionTolerance(tolerance)
                    out = vtkImageData()
                    self.assertEqual(mapper.RenderToImage(renderer, volume, 192, 192, out), 1)
                    pictures.append(
                        vtk_to_numpy(out.GetPointData().GetScalars())[:, :3].astype(float))
                means.append(numpy.abs(pictures[0] - pictures[1]).mean())
        self.assertLess(numpy.mean(means), 0.16, means)

    def test_rays_far_apart(self):
        """They share no queries: each goes on to its next sample that may be visible by itself."""
        size = 130
        z, y, x = numpy.mgrid[0:size, 0:size, 0:size] / 6.0
        field = numpy.clip(0.5 + 0.25 * (numpy.sin(x) * numpy.cos(y) + numpy.sin(y) * numpy.cos(z)
                                         + numpy.sin(z) * numpy.cos(x)), 0.0, 1.0)
        values = (255 * field).astype("u1")
        second = values[:, ::-1, :]
        labels = ((x > 10) + 2 * (y > 9)).astype("u1")

        def image(*components):
            made = vtkImageData()
            made.SetDimensions(size, size, size)
            stacked = numpy.stack([each.ravel() for each in components], axis=1)
            made.GetPointData().SetScalars(numpy_to_vtk(stacked, deep=True))
            return made

        def crop(mapper, _prop):
            mapper.CroppingOn()
            mapper.SetCroppingRegionPlanes(20.3, 100.2, 10.4, 110.6, 30.1, 120.7)

        def clip(mapper, _prop):
            plane = vtkPlane()
            plane.SetOrigin(60.0, 66.0, 70.0)
            plane.SetNormal(1.0, 0.4, -0.3)
            mapper.AddClippingPlane(plane)

        def pair(mapper, _prop):
            mapper.SetInputData(image(values, second))

        def dependent(mapper, prop):
            mapper.SetInputData(image(second, values))
            prop.IndependentComponentsOff()

        def label(mapper, prop):
            mapper.SetMaskInput(image(labels))
            mapper.SetMaskTypeToLabelMap()
            prop.SetLabelScalarOpacity(2, points((150, 0.0), (200, 0.7)))

        def gradient(_mapper, prop):
            prop.SetGradientOpacity(points((3, 0.0), (12, 1.0)))

        def pre_integrate(mapper, _prop):
            mapper.SetClassificationToPreIntegrated()

        def surfaces(mapper, prop):
            mapper.SetBlendModeToIsoSurface()
            prop.GetIsoSurfaceValues().SetValue(0, 150.0)
            prop.GetIsoSurfaceValues().SetValue(1, 200.0)

        def maximum(mapper, _prop):
            mapper.SetBlendModeToMaximumIntensity()

        def minimum(mapper, prop):
            mapper.SetBlendModeToMinimumIntensity()
            prop.SetScalarOpacity(points((0, 0.7), (90, 0.3), (120, 0.0)))

        def maxima(mapper, prop):
            pair(mapper, prop)
            maximum(mapper, prop)

        def average(mapper, _prop):
            mapper.SetBlendModeToAverageIntensity()

        def add(mapper, prop):
            mapper.SetBlendModeToAdditive()
            prop.SetScalarOpacity(points((140, 0.0), (170, 0.01), (255, 0.02)))

        for option, deformed in itertools.product(
                (lambda *_: None, crop, clip, pair, dependent, label, gradient, pre_integrate, surfaces,
                 maximum, minimum, maxima, average, add),
                (False, True)):
            with self.subTest(option=option.__name__, deformed=deformed):
                _, mapper, prop, volume = self.make("u1", False)
                mapper.SetInputData(image(values))
                mapper.SetPositionTolerance(0.01)
                for component in range(2):
                    prop.SetShade(component, 1)
                    prop.SetScalarOpacity(component, points((140, 0.0), (170, 0.4), (255, 0.5)))
                    prop.SetColor(component, prop.GetRGBTransferFunction(0))
                option(mapper, prop)
                if deformed:
                    source = vtkffd.vtkFFDLatticeSource()
                    source.SetBounds(mapper.GetInput().GetBounds())
                    source.SetShape(source.TWIST)
                    source.SetStrength(0.4)
                    source.Update()
                    mapper.SetDeformation(source.GetLattice())
                renderer = vtkRenderer()
                renderer.AddVolume(volume)
                camera = renderer.GetActiveCamera()
                camera.SetPosition(0.5, 0.7, 1.0)
                renderer.ResetCamera()
                pictures = []
                # Rays are 10 to 20 voxels apart.
                for reference in (False, True):
                    mapper.SetReferenceKernels(reference)
                    both = []
                    for pixels in (11, 20):
                        out = vtkImageData()
                        self.assertEqual(
                            mapper.RenderToImage(renderer, volume, pixels, pixels, out), 1)
                        both.append(vtk_to_numpy(out.GetPointData().GetScalars()).astype(float))
                    pictures.append(numpy.concatenate(both))
                self.assertGreater((pictures[1][:, 3] > 20).mean(), 0.1)
                difference = numpy.abs(pictures[0] - pictures[1]).max(axis=1)
                self.assertLess(difference.mean(), 0.6)
                self.assertLess(numpy.percentile(difference, 97), 4.0)

    def test_planes(self):
        for kind, deformed, nearest in itertools.product(
                ("u1", "u2", "f4", "f8"), (False, True), (False, True)):
            with self.subTest(kind=kind, deformed=deformed, nearest=nearest):
                scale, mapper, prop, volume = self.make(kind, deformed)
                self.set_plane(prop, nearest)
                tail = 60.0 if nearest else 3.0  # a voxel is another one by a rounding error
                by_gradient = self.compare(mapper, volume, "gradient", 1.5 if nearest else 0.15, tail)
                image = mapper.GetInput()
                axis = numpy_to_vtk((self.second * 900).astype(numpy.int16).ravel(), deep=True)
                axis.SetName("second")
                image.GetPointData().AddArray(axis)
                prop.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)
                volume.GetProperty().SetTransferFunction2D(prop.GetTransferFunction2D())
                mapper.SetTransfer2DYAxisArray("second")
                by_array = self.compare(mapper, volume, "array", 1.5 if nearest else 0.15, tail)
                self.assertGreater(numpy.abs(by_array - by_gradient).mean(), 1.0)
                # The same without skipping what is invisible.
                mapper.SetSpaceLeapingToOff()
                self.compare(mapper, volume, "no leaping", 1.5 if nearest else 0.15, tail)

    def test_planes_behind_a_mask(self):
        scale, mapper, prop, volume = self.make("u1", True)
        self.set_plane(prop)
        without = self.compare(mapper, volume, "no mask")
        mapper.SetMaskInput(scalars_image((self.labels > 1).astype(numpy.uint8).ravel()))
        mapper.SetMaskTypeToBinary()
        masked = self.compare(mapper, volume, "mask", 0.3, 20.0)
        self.assertGreater(numpy.abs(masked - without).mean(), 1.0)

    def make_components(self, components, dependent, kind, deformed):
        """Scenes of several components, shaded."""
        scale, mapper, prop, volume = self.make(kind, deformed)
        fields = [self.field, self.field[:, ::-1], self.field[:, :, ::-1], self.field[::-1]]
        values = numpy.stack([f.ravel() for f in fields[:components]], axis=-1)
        mapper.SetInputData(scalars_image((values * scale).astype(kind)))
        prop.SetIndependentComponents(not dependent)
        for c in range(1, components):
            color = vtkColorTransferFunction()
            color.AddRGBPoint(0.0, *numpy.roll([0.2, 0.3, 1.0], c))
            color.AddRGBPoint(scale, *numpy.roll([1.0, 0.6, 0.2], c))
            prop.SetColor(c, color)
            prop.SetScalarOpacity(c, points((0.2 * scale, 0.0), (scale, 0.6)))
            prop.SetComponentWeight(c, 1.0 - 0.2 * c)
            prop.SetSpecular(c, 0.3)
            prop.SetSpecularPower(c, 10.0)
        return scale, mapper, prop, volume

    COMPONENTS = ((2, False), (3, False), (4, False), (2, True), (3, True), (4, True))

    def component_scenes(self):
        """Parameters of make_components(): values that are colors are of few types."""
        for (components, dependent), (kind, deformed) in itertools.product(
                self.COMPONENTS, (("u1", False), ("u1", True), ("i2", True), ("f4", False), ("f8", True))):
            if kind == "u1" or not dependent or components == 2:
                yield components, dependent, kind, deformed

    def count_lookups(self, mapper, volume):
        """Of distances to what is visible, for each ray: more where rays are sampled one at a time."""
        mapper.CollectStatisticsOn()
        self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
        mapper.CollectStatisticsOff()
        return mapper.GetStatistics().GetDistanceLookupsPerRay()

    def test_planes_of_components(self):
        for scene in self.component_scenes():
            with self.subTest(scene=scene):
                scale, mapper, prop, volume = self.make_components(*scene)
                plain = self.count_lookups(mapper, volume)
                self.set_plane(prop)
                for c in range(1, scene[0]):
                    prop.SetTransferFunction2D(c, prop.GetTransferFunction2D(0))
                by_gradient = self.compare(mapper, volume, "gradient")
                axis = numpy.stack([self.second.ravel() * 900, self.field.ravel()], axis=-1)
                for name, values in (("one", axis[:, 0]), ("first of two", axis)):
                    array = numpy_to_vtk(
                        numpy.ascontiguousarray(values.astype(numpy.int16)), deep=True)
                    array.SetName(name)
                    mapper.GetInput().GetPointData().AddArray(array)
                    mapper.SetTransfer2DYAxisArray(name)
                    by_array = self.compare(mapper, volume, name)
                    self.assertGreater(numpy.abs(by_array - by_gradient).mean(), 0.5)
                self.assertLess(self.count_lookups(mapper, volume), 1.3 * plain)

    def test_normals_of_opacities_of_components(self):
        for scene in self.component_scenes():
            with self.subTest(scene=scene):
                scale, mapper, prop, volume = self.make_components(*scene)
                plain = self.count_lookups(mapper, volume)
                before = self.picture(mapper, volume, False)
                mapper.ComputeNormalFromOpacityOn()
                picture = self.compare(mapper, volume, "normals of the opacity", 0.2)
                self.assertGreater(numpy.abs(picture - before).mean(), 0.05)
                self.assertLess(self.count_lookups(mapper, volume), 1.3 * plain)
                prop.SetGradientOpacity(0, points((0.0, 0.2), (0.1 * scale, 1.0)))
                self.compare(mapper, volume, "and gradient opacities", 0.2)
                self.set_plane(prop)
                for c in range(1, scene[0]):
                    prop.SetTransferFunction2D(c, prop.GetTransferFunction2D(0))
                self.compare(mapper, volume, "and planes", 0.2)

    def test_normals_of_level_opacities(self):
        """What is constant has no normal, wherever between entries of the table it begins."""
        for begin in (22.0, 22.000176133920135, 41.7, 63.123):
            with self.subTest(begin=begin):
                _, mapper, prop, volume = self.make("u1", False)
                prop.SetScalarOpacity(points((begin, 0.0), (begin + 20.0, 0.9)))
                before = self.picture(mapper, volume, False)
                mapper.ComputeNormalFromOpacityOn()
                picture = self.compare(mapper, volume, "level", 0.2)
                self.assertGreater(numpy.abs(picture - before).mean(), 0.05)

    def set_labels(self, scale, mapper, prop, blend):
        mapper.SetMaskInput(scalars_image(self.labels.ravel()))
        mapper.SetMaskTypeToLabelMap()
        mapper.SetMaskBlendFactor(blend)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 0.0, 1.0, 0.0)
        for label in (1, 3):
            prop.SetLabelColor(label, color)
            prop.SetLabelScalarOpacity(label, points((0.2 * scale, 0.0), (scale, 0.9)))

    def test_labels_and_planes(self):
        for kind, deformed, blend in itertools.product(("u1", "f4"), (False, True), (1.0, 0.4)):
            with self.subTest(kind=kind, deformed=deformed, blend=blend):
                scale, mapper, prop, volume = self.make(kind, deformed)
                plain = self.count_lookups(mapper, volume)
                self.set_plane(prop)
                without = self.compare(mapper, volume, "a plane")
                self.set_labels(scale, mapper, prop, blend)
                prop.SetLabelGradientOpacity(1, points((0.0, 1.0), (0.08 * scale, 0.2)))
                picture = self.compare(mapper, volume, "and labels", 0.3, 20.0)
                self.assertGreater(numpy.abs(picture - without).mean(), 0.5)
                self.assertLess(self.count_lookups(mapper, volume), 1.3 * plain)
                axis = numpy_to_vtk((self.second * 900).astype(numpy.int16).ravel(), deep=True)
                axis.SetName("second")
                mapper.GetInput().GetPointData().AddArray(axis)
                mapper.SetTransfer2DYAxisArray("second")
                self.compare(mapper, volume, "over another array", 0.3, 20.0)

    def test_labels_of_dependent_components(self):
        for (components, planes), deformed, blend in itertools.product(
                itertools.product((2, 3, 4), (False, True)), (False, True), (1.0, 0.4)):
            with self.subTest(components=components, planes=planes, deformed=deformed, blend=blend):
                scale, mapper, prop, volume = self.make_components(components, True, "u1", deformed)
                if planes:
                    self.set_plane(prop)
                prop.SetGradientOpacity(points((0.0, 0.2), (0.1 * scale, 1.0)))
                plain = self.count_lookups(mapper, volume)
                without = self.compare(mapper, volume, "no labels")
                self.set_labels(scale, mapper, prop, blend)
                prop.SetLabelGradientOpacity(1, points((0.0, 1.0), (0.08 * scale, 0.2)))
                picture = self.compare(mapper, volume, "labels", 0.3, 20.0)
                self.assertGreater(numpy.abs(picture - without).mean(), 0.5)
                self.assertLess(self.count_lookups(mapper, volume), 1.3 * plain)

    def test_gradients_beside_clipping_planes(self):
        for scene in ((1, False, "u1", True), (1, False, "f4", False), *self.component_scenes()):
            with self.subTest(scene=scene):
                scale, mapper, prop, volume = (
                    self.make_components(*scene) if scene[0] > 1 else self.make(*scene[2:]))
                plane = vtkPlane()
                plane.SetOrigin(15.0, 15.0, 16.0)
                plane.SetNormal(-1.0, -0.3, -0.4)
                mapper.AddClippingPlane(plane)
                plain = self.count_lookups(mapper, volume)
                before = self.picture(mapper, volume, False)
                prop.SetUseClippedVoxelIntensity(1)
                far = self.compare(mapper, volume, "clipped voxels", 0.2, 6.0)
                self.assertGreater(numpy.abs(far - before).mean(), 0.05)
                self.assertLess(self.count_lookups(mapper, volume), 1.3 * plain)
                prop.SetClippedVoxelIntensity(0.3 * scale)
                near = self.compare(mapper, volume, "of a value", 0.2, 6.0)
                self.assertGreater(numpy.abs(far - near).mean(), 0.01)
                prop.SetGradientOpacity(points((0.0, 0.2), (0.1 * scale, 1.0)))
                mapper.ComputeNormalFromOpacityOn()
                self.compare(mapper, volume, "of the opacity", 0.2, 6.0)

    def test_gradient_opacities_of_labels(self):
        for kind, deformed, blend in itertools.product(("u1", "i2", "f4"), (False, True), (1.0, 0.4)):
            with self.subTest(kind=kind, deformed=deformed, blend=blend):
                scale, mapper, prop, volume = self.make(kind, deformed)
                self.set_labels(scale, mapper, prop, blend)
                without = self.compare(mapper, volume, "labels", 0.3, 20.0)
                prop.SetGradientOpacity(points((0.0, 0.2), (0.1 * scale, 1.0)))
                prop.SetLabelGradientOpacity(1, points((0.0, 1.0), (0.08 * scale, 0.0)))
                weighed = self.compare(mapper, volume, "weighed labels", 0.3, 20.0)
                self.assertGreater(numpy.abs(weighed - without).mean(), 0.5)

    def test_values_that_labels_alone_show(self):
        for deformed, blend in itertools.product((False, True), (1.0, 0.4)):
            with self.subTest(deformed=deformed, blend=blend):
                scale, mapper, prop, volume = self.make("u1", deformed)
                prop.SetScalarOpacity(points((0.6 * scale, 0.0), (0.7 * scale, 0.5)))
                base = self.picture(mapper, volume, False)
                mapper.SetMaskInput(scalars_image(self.labels.ravel()))
                mapper.SetMaskTypeToLabelMap()
                mapper.SetMaskBlendFactor(blend)
                for label in (1, 3):
                    prop.SetLabelScalarOpacity(label, points(
                        (0.05 * scale, 0.0), (0.1 * scale, 0.4), (0.2 * scale, 0.4), (0.3 * scale, 0.0)))
                shown = self.compare(mapper, volume, "labels", 0.3, 20.0)
                self.assertGreater((shown[:, 3] > base[:, 3] + 20).mean(), 0.1)
                mapper.SetSpaceLeapingToOff()
                self.assertLess(numpy.abs(self.picture(mapper, volume, False) - shown).max(), 1.5)

    def test_gradient_opacities(self):
        # Opacities are those of the interval, or weighed over another length than that.
        for kind, length in itertools.product(("u1", "f4"), ("WORLD", "MATERIAL")):
            with self.subTest(kind=kind, length=length):
                scale, mapper, prop, volume = self.make(kind, True)
                mapper.SetOpacityLength(getattr(mapper, length))
                without = self.compare(mapper, volume, "values")
                prop.SetGradientOpacity(points((0.04 * scale, 0.0), (0.1 * scale, 1.0)))
                weighed = self.compare(mapper, volume, "weighed", 0.3, 20.0)
                self.assertGreater(numpy.abs(weighed - without).mean(), 0.5)

    def test_isosurfaces(self):
        levels = {"one": (0.4,), "three": (0.25, 0.5, 0.7)}
        for kind, deformed, number in itertools.product(
                ("u1", "i1", "u2", "i2", "f4", "f8", "i4"), (False, True), levels):
            with self.subTest(kind=kind, deformed=deformed, number=number):
                scale, mapper, prop, volume = self.make(kind, deformed)
                mapper.SetBlendModeToIsoSurface()
                prop.SetScalarOpacity(points((0.0, 0.3), (scale, 1.0)))
                for i, level in enumerate(levels[number]):
                    prop.GetIsoSurfaceValues().SetValue(i, level * scale)
                shown = self.compare(mapper, volume, "surfaces")
                if number == "three":
                    # Crossed from either side, cropped and clipped by its depths alike.
                    mapper.CroppingOn()
                    mapper.SetCroppingRegionPlanes(5, 22, 6, 26, 8, 30)
                    self.assertGreater(
                        numpy.abs(self.compare(mapper, volume, "cropped", 0.3, 12.0) - shown).mean(), 1.0)

    def test_isosurfaces_at_values_that_voxels_have(self):
        # A plateau belongs to the side that it is on in double precision, too.
        self.field = numpy.floor(255.0 * self.field) / 255.0
        for interpolation in (0, 1):
            scale, mapper, prop, volume = self.make("f4", False)
            mapper.SetBlendModeToIsoSurface()
            prop.SetInterpolationType(interpolation)
            prop.SetScalarOpacity(points((0.0, 0.3), (scale, 0.9)))
            prop.GetIsoSurfaceValues().SetValue(0, 0.4)
            self.compare(mapper, volume, "plateaus", 0.02, 1.5)

    def make_extremes(self, field, kind, deformed, minimum):
        """A cube of scalars from 0 to 1, of which rays show the extremes."""
        scale, mapper, prop, volume = self.make(kind, deformed)
        prop.ShadeOff()
        size = len(field)
        image = vtkImageData()
        image.SetDimensions(size, size, size)
        image.SetSpacing(*(n / (size - 1.0) for n in SIZE))
        values = scale * ((1.0 - field) if minimum else field)
        image.GetPointData().SetScalars(numpy_to_vtk(values.astype(kind).ravel(), deep=True))
        mapper.SetInputData(image)
        mapper.SetSampleDistance(0.3)
        mapper.SetBlendMode(
            mapper.MINIMUM_INTENSITY_BLEND if minimum else mapper.MAXIMUM_INTENSITY_BLEND)
        return scale, mapper, prop, volume

    def test_extremes_leave_out_what_cannot_change_them(self):
        size = 90
        z, y, x = numpy.mgrid[0:size, 0:size, 0:size] / (size - 1.0)
        field = (0.5 * x * y + 0.1 * numpy.sin(40 * z) ** 2
                 + 0.4 * numpy.exp(-80 * ((x - 0.6) ** 2 + (y - 0.6) ** 2 + (z - 0.8) ** 2)))
        for kind, deformed, minimum in itertools.product(
                ("u1", "i2", "f4", "f8"), (False, True), (False, True)):
            with self.subTest(kind=kind, deformed=deformed, minimum=minimum):
                scale, mapper, prop, volume = self.make_extremes(field, kind, deformed, minimum)
                ends = (0.9, 0.1) if minimum else (0.05, 0.9)
                prop.SetScalarOpacity(points((0.0, ends[0]), (scale, ends[1])))
                mapper.CollectStatisticsOn()
                # Packets have colors of 10 bits.
                self.compare(mapper, volume, "extremes", mean=0.2)
                fast = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                few = mapper.GetStatistics().GetSamplesPerRay()
                mapper.SetSpaceLeapingToOff()
                every = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                many = mapper.GetStatistics().GetSamplesPerRay()
                self.assertLess(numpy.abs(fast - every).max(), 1.01)
                self.assertLess(few, 0.7 * many)

    def test_extremes_have_the_depths_where_rays_meet_them_first(self):
        size = 60
        z, y, x = numpy.mgrid[0:size, 0:size, 0:size] / (size - 1.0)
        field = 0.5 * x * y
        # Rays cross several of these balls, all of one value.
        for center in ((0.7, 0.6, 0.8), (0.4, 0.4, 0.4), (0.2, 0.6, 0.2), (0.6, 0.3, 0.7)):
            distance = sum((a - b) ** 2 for a, b in zip((x, y, z), center))
            field[distance < 0.04] = 0.8
        for kind, deformed, minimum in itertools.product(("u1", "f4"), (False, True), (False, True)):
            with self.subTest(kind=kind, deformed=deformed, minimum=minimum):
                scale, mapper, prop, volume = self.make_extremes(field, kind, deformed, minimum)
                prop.SetScalarOpacity(points((0.0, 0.5), (scale, 0.5)))
                depths = []
                for leaping in (mapper.LIPSCHITZ, mapper.OFF):
                    mapper.SetSpaceLeaping(leaping)
                    found = vtkImageData()
                    self.picture(mapper, volume, False, found)
                    depths.append(vtk_to_numpy(found.GetPointData().GetScalars()).copy())
                self.assertGreater((depths[0] < 1.0).mean(), 0.1)
                self.assertLess(numpy.abs(depths[0] - depths[1]).max(), 1e-6)

    def test_boxes_of_many_blocks_along_an_axis(self):
        """Rays of a packet that are many voxels apart along one axis leap over what is empty alone."""
        for axis, deformed in itertools.product(range(3), (False, True)):
            for stretch in (5, 9, 14, 30):
                with self.subTest(axis=axis, deformed=deformed, stretch=stretch):
                    scale, mapper, prop, volume = self.make("u1", deformed)
                    prop.SetScalarOpacity(points((0.0, 0.0), (0.3 * scale, 0.0), (scale, 0.9)))
                    dimensions = [stretch * n if a == axis else n for a, n in enumerate(SIZE)]
                    z, y, x = (numpy.linspace(0.0, 1.0, n) for n in dimensions[::-1])
                    field = numpy.zeros((len(z), len(y), len(x)))
                    for a, b, c in ((0.5, 0.5, 0.4), (0.3, 0.7, 0.6), (0.8, 0.4, 0.7), (0.2, 0.25, 0.3)):
                        squares = ((x - a) ** 2, (y - b)[:, None] ** 2, (z - c)[:, None, None] ** 2)
                        field += numpy.exp(-sum(squares) / 0.001)
                    image = vtkImageData()
                    image.SetDimensions(*dimensions)
                    image.SetSpacing(*(SIZE[a] / (n - 1.0) for a, n in enumerate(dimensions)))
                    image.GetPointData().SetScalars(numpy_to_vtk(
                        (scale * field.clip(0.0, 1.0)).astype("u1").ravel(), deep=True))
                    mapper.SetInputData(image)
                    mapper.CollectStatisticsOn()
                    leaping = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                    few = mapper.GetStatistics().GetSamplesPerRay()
                    mapper.SetSpaceLeapingToOff()
                    every = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                    many = mapper.GetStatistics().GetSamplesPerRay()
                    self.assertGreater((every[:, 3] > 0).mean(), 0.005)
                    self.assertLess(numpy.abs(leaping - every).max(), 1.01)
                    self.assertLess(few, 0.3 * many)

    def test_what_masks_hide_is_leaped_over(self):
        size = 70
        z, y, x = numpy.mgrid[0:size, 0:size, 0:size] / (size - 1.0)
        field = 0.6 + 0.3 * numpy.sin(9 * x + 5 * y) * numpy.cos(7 * z)
        balls = [((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 < r ** 2)
                 for a, b, c, r in ((0.3, 0.4, 0.7, 0.08), (0.6, 0.6, 0.8, 0.1), (0.02, 0.5, 0.5, 0.06))]
        modes = {"composite": "SetBlendModeToComposite", "pre-integrated": "SetClassificationToPreIntegrated",
                 "maximum": "SetBlendModeToMaximumIntensity", "average": "SetBlendModeToAverageIntensity",
                 "surfaces": "SetBlendModeToIsoSurface"}
        masks = (("u1", 0, 255), ("f4", -1.0, 0.25), ("i2", 0, 3))
        for (kind, low, high), deformed, components, mode in itertools.product(
                masks, (False, True), (1, 2), modes):
            if components == 2 and mode != "composite":
                continue
            with self.subTest(mask=kind, deformed=deformed, components=components, mode=mode):
                scale, mapper, prop, volume = self.make("u1", deformed)
                # An opacity that leaves nothing else to leap over.
                for c in range(components):
                    prop.SetScalarOpacity(c, points((0.0, 0.02), (scale, 0.05)))
                    prop.SetShade(c, 1)
                for i in range(6):
                    prop.GetIsoSurfaceValues().SetValue(i, (0.4 + 0.08 * i) * scale)
                image = vtkImageData()
                image.SetDimensions(size, size, size)
                image.SetSpacing(*(n / (size - 1.0) for n in SIZE))
                values = numpy.repeat((scale * field).astype("u1").reshape(-1, 1), components, axis=1)
                image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
                mask = vtkImageData()
                mask.CopyStructure(image)
                mask.GetPointData().SetScalars(numpy_to_vtk(
                    numpy.where(balls[0] | balls[2], high, low).astype(kind).ravel(), deep=True))
                mapper.SetInputData(image)
                mapper.SetMaskInput(mask)
                mapper.SetMaskTypeToBinary()
                mapper.SetSampleDistance(0.3)
                getattr(mapper, modes[mode])()
                mapper.CollectStatisticsOn()
                for _ in range(2):
                    mapper.SetSpaceLeapingToLipschitz()
                    leaping = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                    few = mapper.GetStatistics().GetSamplesPerRay()
                    mapper.SetSpaceLeapingToOff()
                    every = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                    many = mapper.GetStatistics().GetSamplesPerRay()
                    self.assertGreater((every[:, 3] > 0).mean(), 0.004)
                    self.assertLess(numpy.abs(leaping - every).max(), 1.01)
                    if mode == "composite":
                        self.assertLess(few, 0.3 * many)
                    # Another mask in the same memory.
                    vtk_to_numpy(mask.GetPointData().GetScalars())[:] = numpy.where(
                        balls[1], high, low).ravel()
                    mask.GetPointData().GetScalars().Modified()

    def test_what_is_cropped_is_leaped_over(self):
        scale, mapper, prop, volume = self.make("u1", False)
        size = 64
        image = vtkImageData()
        image.SetDimensions(size, size, size)
        image.SetSpacing(*(n / (size - 1.0) for n in SIZE))
        noise = numpy.random.default_rng(1).integers(0, scale, size ** 3, dtype="u1")
        image.GetPointData().SetScalars(numpy_to_vtk(noise, deep=True))
        mapper.SetInputData(image)
        mapper.CollectStatisticsOn()
        prop.SetScalarOpacity(points((0.8 * scale, 0.0), (scale, 0.5)))
        mapper.SetCroppingRegionPlanes(*(a * n for n in SIZE for a in (0.3, 0.6)))
        shape = vtkffd.vtkFFDLatticeSource()
        shape.SetBounds(image.GetBounds())
        shape.SetShape(shape.TWIST)
        shape.Update()
        for deformation, flags in itertools.product((None, shape.GetLattice()), (0x2000, 0x6003)):
            mapper.SetDeformation(deformation)
            mapper.SetCroppingRegionFlags(flags)
            looks = []
            for cropping in (0, 1):
                mapper.SetCropping(cropping)
                mapper.SetSpaceLeapingToLipschitz()
                leaping = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
                looks.append(mapper.GetStatistics().GetNumberOfDistanceLookups())
            mapper.SetSpaceLeapingToOff()
            every = self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
            self.assertGreater((every[:, 3] > 0).mean(), 0.004)
            numpy.testing.assert_allclose(leaping, every, atol=1.01)
            if flags == 0x2000:
                self.assertLess(looks[1], 0.7 * looks[0])

    def make_waves(self, *size):
        """Bytes that rise and fall along all axes, whose tops are visible; what is done is counted."""
        _, mapper, prop, volume = self.make("u1", False)
        image = vtkImageData()
        image.SetDimensions(*size)
        z, y, x = numpy.indices(size[::-1])
        values = 127 + 100 * numpy.sin(0.4 * x) * numpy.cos(0.5 * y) * numpy.cos(0.4 * z)
        image.GetPointData().SetScalars(numpy_to_vtk(values.astype("u1").ravel(), deep=True))
        mapper.SetInputData(image)
        mapper.CollectStatisticsOn()
        prop.SetScalarOpacity(points((130.0, 0.0), (190.0, 0.4)))
        return image, mapper, volume

    def test_rays_through_bent_plates(self):
        # Their lattices have cells far shorter than rays are in front of them and behind.
        image, mapper, volume = self.make_waves(160, 160, 12)
        for name, strength, most in (("TWIST", 0.05, 6.0), ("TWIST", 0.2, 12.0), ("TAPER", 0.2, 12.0)):
            shape = vtkffd.vtkFFDLatticeSource()
            shape.SetBounds(image.GetBounds())
            shape.SetDimensions(8, 8, 8)
            shape.SetShape(getattr(shape, name))
            shape.SetStrength(strength)
            shape.Update()
            mapper.SetDeformation(shape.GetLattice())
            self.compare(mapper, volume, (name, strength), mean=0.4, tail=10.0)
            self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
            self.assertLess(mapper.GetStatistics().GetEvaluationsPerRay(), most)

    def test_rays_through_fine_lattices(self):
        # Segments cross many cells of the lattice before they are short enough.
        image, mapper, volume = self.make_waves(64, 64, 64)
        random = numpy.random.default_rng(1)
        for side, part, most in ((16, 0.2, 4.0), (32, 0.1, 8.0), (48, 0.1, 16.0)):
            lattice = vtkffd.vtkFFDLattice()
            lattice.SetDimensions(side, side, side)
            lattice.FitToBounds(image.GetBounds())
            moves = part * 64.0 / (side - 3) * random.uniform(-1.0, 1.0, (side**3, 3))
            vtk_to_numpy(lattice.GetDisplacements())[:] = moves
            lattice.GetDisplacements().Modified()
            mapper.SetDeformation(lattice)
            self.compare(mapper, volume, (side, part), mean=0.4, tail=10.0)
            self.picture(mapper, volume, False, pixels=400)
            self.assertLess(mapper.GetStatistics().GetEvaluationsPerRay(), most)

    def test_extremes_end_where_nothing_beyond_them_shows(self):
        # Dark air in front of it makes a minimum invisible, whatever comes behind.
        scale, mapper, prop, volume = self.make("u1", False)
        prop.ShadeOff()
        prop.SetScalarOpacity(points((0.3 * scale, 0.0), (0.4 * scale, 0.8)))
        mapper.SetBlendModeToMinimumIntensity()
        self.field = 0.35 + 0.6 * self.field
        self.field[:, :, 12:] *= 0.5
        values = vtk_to_numpy(mapper.GetInput().GetPointData().GetScalars())
        values[:] = (scale * self.field).astype("u1").ravel()
        mapper.GetInput().GetPointData().GetScalars().Modified()
        mapper.CollectStatisticsOn()
        self.compare(mapper, volume, "minimum")
        self.picture(mapper, volume, False, pixels=PIXELS_COUNTED)
        self.assertLess(mapper.GetStatistics().GetSamplesPerRay(), 12.0)


if __name__ == "__main__":
    unittest.main()
