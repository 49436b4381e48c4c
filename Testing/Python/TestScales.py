# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scalars and lengths of any order of magnitude, and one value far away from all others, which stands
for no data."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIDE = 24
PIXELS = 60


def make_values():
    """From 0 to 100: waves, steep and flat."""
    z, y, x = numpy.mgrid[0:SIDE, 0:SIDE, 0:SIDE] / (SIDE - 1.0)
    return 50.0 + 50.0 * numpy.sin(9.0 * x + 4.0 * y) * numpy.cos(7.0 * y - 5.0 * z)


class Scene:
    def __init__(self, values, unit=1.0, deformed=False, spacing=1.0):
        """`unit`: of the scalars, in that of `values`, which are ramps' from 0 to 100."""
        self.unit = unit
        self.image = vtkImageData()
        self.image.SetDimensions(SIDE, SIDE, SIDE)
        self.image.SetSpacing(*3 * [spacing])
        self.image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        self.errors = []
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.AddObserver("ErrorEvent", self.note)
        self.mapper.SetInputData(self.image)
        self.mapper.SetSampleDistance(0.5 * spacing)
        if deformed:
            source = vtkffd.vtkFFDLatticeSource()
            source.SetBounds(self.image.GetBounds())
            source.SetShapeToTwist()
            source.SetStrength(0.5)
            source.Update()
            self.mapper.SetDeformation(source.GetLattice())
        self.property = vtkVolumeProperty()
        self.property.SetInterpolationTypeToLinear()
        self.property.SetScalarOpacity(self.ramp((0, 0), (55, 0), (90, 0.5)))
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 1.0, 0.3, 0.1)
        color.AddRGBPoint(100.0 * unit, 0.4, 1.0, 0.9)
        self.property.SetColor(color)
        self.property.SetScalarOpacityUnitDistance(spacing)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.renderer = vtkRenderer()
        middle = 0.5 * (SIDE - 1) * spacing
        camera = self.renderer.GetActiveCamera()
        camera.SetFocalPoint(middle, middle, middle)
        camera.SetPosition(middle + 60 * spacing, middle + 35 * spacing, middle + 45 * spacing)
        camera.SetClippingRange(20 * spacing, 200 * spacing)

    def note(self, _caller, _event, text=""):
        self.errors.append(text)

    note.CallDataType = "string0"

    def ramp(self, *points):
        function = vtkPiecewiseFunction()
        for value, opacity in points:
            function.AddPoint(value * self.unit, opacity)
        return function

    def render(self):
        colors = vtkImageData()
        done = self.mapper.RenderToImage(self.renderer, self.volume, PIXELS, PIXELS, colors)
        assert done == 1, self.errors
        return vtk_to_numpy(colors.GetPointData().GetScalars()).astype(int)


class TestScales(unittest.TestCase):
    def expect_same(self, picture, expected, mean=0.3):
        self.assertGreater(numpy.ptp(expected), 100)
        self.assertLess(numpy.abs(picture - expected).mean(), mean)

    def expect_kernels_alike(self, scene, mean):
        pictures = []
        for reference in (False, True):
            scene.mapper.SetReferenceKernels(reference)
            pictures.append(scene.render())
        self.expect_same(pictures[0], pictures[1], mean)

    def test_extremes_beside_no_data(self):
        maximum, minimum = (vtkffd.vtkFFDInverseRayVolumeMapper.MAXIMUM_INTENSITY_BLEND,
                            vtkffd.vtkFFDInverseRayVolumeMapper.MINIMUM_INTENSITY_BLEND)
        for kind, mode, fill in (
                (numpy.float32, maximum, -2147483648.0), (numpy.float32, maximum, -1e10),
                (numpy.float32, maximum, -1e20), (numpy.float64, maximum, -1e9),
                (numpy.int32, maximum, -1000000000), (numpy.int64, maximum, -10 ** 12),
                (numpy.float32, minimum, 1e9), (numpy.float32, minimum, 1e20),
                (numpy.uint32, minimum, 4294967295)):
            for deformed in (False, True):
                with self.subTest(kind=kind, mode=mode, fill=fill, deformed=deformed):
                    values = make_values().astype(kind)
                    values[:4] = fill
                    scene = Scene(values, deformed=deformed)
                    scene.mapper.SetBlendMode(mode)
                    scene.property.SetScalarOpacity(scene.ramp((0, 0), (100, 1)))
                    picture = scene.render()
                    scene.mapper.SetSpaceLeaping(vtkffd.vtkFFDInverseRayVolumeMapper.OFF)
                    self.expect_same(picture, scene.render(), 0.1)

    def test_no_data_beyond_single_precision(self):
        modes = ("Composite", "MaximumIntensity", "MinimumIntensity", "Additive", "IsoSurface")
        for mode in modes:
            for deformed in (False, True):
                for fill in (1e38, 3.4028234663852886e38, 1e300):
                    with self.subTest(mode=mode, deformed=deformed, fill=fill):
                        pictures = []
                        for value in (1e6, fill):
                            values = make_values()
                            values[:4] = value
                            scene = Scene(values, deformed=deformed)
                            getattr(scene.mapper, "SetBlendModeTo" + mode)()
                            scene.property.GetIsoSurfaceValues().SetValue(0, 60.0)
                            scene.property.SetScalarOpacity(scene.ramp((0, 0), (100, 0.5)))
                            pictures.append(scene.render())
                        self.expect_same(pictures[1], pictures[0])

    def test_no_data_of_the_largest_numbers(self):
        """They look as the function has them, not as the nearest of the other values."""
        for kind in (numpy.float32, numpy.float64):
            for sign in (-1, 1):
                for deformed in (False, True):
                    with self.subTest(kind=kind, sign=sign, deformed=deformed):
                        pictures = []
                        for fill in (1e6, float(numpy.finfo(kind).max)):
                            values = (50.0 + 0.4 * make_values()).astype(kind)
                            values[:4] = sign * fill
                            scene = Scene(values, deformed=deformed)
                            scene.property.SetScalarOpacity(
                                scene.ramp((0, 0), (40, 0), (70, 0.4), (100, 0)))
                            pictures.append(scene.render())
                        self.expect_same(pictures[1], pictures[0])

    def test_leaping_beside_no_data(self):
        """What is empty by the other values is leaped over, as without what stands for none."""
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper
        z, y, x = numpy.mgrid[0:SIDE, 0:SIDE, 0:SIDE] - 0.5 * (SIDE - 1)
        distance = numpy.sqrt(x * x + y * y + z * z)
        for kind, fills in ((numpy.float32, (-1, 1e5, -1e20, -3.4028234663852886e38)),
                            (numpy.float64, (-1, 1e5, -1e20, -1.7976931348623157e308)),
                            (numpy.int32, (-1, -2147483648))):
            for mode in (mapper.COMPOSITE_BLEND, mapper.MAXIMUM_INTENSITY_BLEND):
                samples = []
                for fill in fills:
                    # A ball in the middle can be seen.
                    values = numpy.maximum(100.0 - 6.0 * distance, 0.0).astype(kind)
                    values[:4] = fill
                    scene = Scene(values)
                    scene.mapper.SetBlendMode(mode)
                    scene.mapper.SetCollectStatistics(True)
                    scene.property.SetScalarOpacity(scene.ramp((70, 0), (95, 0.5), (100, 0.5), (101, 0)))
                    scene.render()
                    samples.append(scene.mapper.GetStatistics().GetSamplesPerRay())
                for fill, count in zip(fills, samples):
                    with self.subTest(kind=kind, mode=mode, fill=fill):
                        self.assertGreater(count, 1.0)
                        self.assertLess(count, 1.4 * samples[0])

    def test_gradient_opacity_beside_no_data(self):
        """The points of the function are met, however wide the range of the scalars is."""
        pictures = []
        for fill in (-100.0, -1e5, -1e20):
            values = make_values().astype(numpy.float32)
            values[:4] = fill
            scene = Scene(values)
            scene.property.SetGradientOpacity(scene.ramp((0, 0), (5, 0), (15, 1)))
            pictures.append(scene.render())
        for picture in pictures[1:]:
            self.expect_same(picture, pictures[0], 1.0)

    def test_integers_far_from_others(self):
        for kind, offset, fill in (
                (numpy.int32, 2147483000, -2147483648), (numpy.int32, -2147483648, 2147483647),
                (numpy.uint32, 4294967000, 0), (numpy.uint32, 0, 4294967295),
                (numpy.int32, 1000000000, -1147483647), (numpy.uint32, 2147483648, 0)):
            for components in (1, 2):
                for deformed in (False, True):
                    with self.subTest(
                            kind=kind, offset=offset, components=components, deformed=deformed):
                        pictures = []
                        for of in (kind, numpy.float64):
                            values = make_values().astype(numpy.int64) + offset
                            values[:4] = fill
                            scene = Scene(values.astype(of), deformed=deformed)
                            scalars = numpy.repeat(values.reshape(-1, 1), components, axis=1)
                            scene.image.GetPointData().SetScalars(
                                numpy_to_vtk(scalars.astype(of), deep=True))
                            for c in range(components):
                                opacity = vtkPiecewiseFunction()
                                for value, alpha in ((0, 0), (55, 0), (90, 0.5)):
                                    opacity.AddPoint(offset + value, alpha)
                                scene.property.SetScalarOpacity(c, opacity)
                                color = vtkColorTransferFunction()
                                color.AddRGBPoint(offset, 1.0, 0.3, 0.1)
                                color.AddRGBPoint(offset + 100.0, 0.4, 1.0, 0.9)
                                scene.property.SetColor(c, color)
                            pictures.append(scene.render())
                        self.expect_same(pictures[0], pictures[1], 0.02)

    def test_light(self):
        def isosurface(scene):
            scene.mapper.SetBlendModeToIsoSurface()
            scene.property.GetIsoSurfaceValues().SetValue(0, 60.0 * scene.unit)

        def opacity_normals(scene):
            scene.mapper.ComputeNormalFromOpacityOn()

        for change in (lambda _: None, isosurface, opacity_normals):
            for deformed in (False, True):
                expected = None
                for unit, spacing in ((1.0, 1.0), (1e-26, 1.0), (1e-15, 1.0), (1e19, 1.0), (1e30, 1.0),
                                      (1.0, 1e14), (1e-6, 1e9), (1e-20, 1e-9)):
                    with self.subTest(unit=unit, spacing=spacing, deformed=deformed):
                        scene = Scene((make_values() * unit).astype(numpy.float32), unit, deformed,
                                      spacing)
                        scene.property.ShadeOn()
                        change(scene)
                        picture = scene.render()
                        expected = picture if expected is None else expected
                        self.expect_same(picture, expected)

    def test_light_beside_no_data(self):
        pictures = []
        for fill in (-1e3, -1e12, -1e20):
            values = make_values().astype(numpy.float32)
            values[:4] = fill
            scene = Scene(values)
            scene.property.ShadeOn()
            pictures.append(scene.render().reshape(PIXELS, PIXELS, 4))
        # But at the border of the data, which is steeper.
        for picture in pictures[1:]:
            self.assertLess(numpy.median(numpy.abs(picture - pictures[0])), 1)
            self.assertLess(numpy.abs(picture - pictures[0]).mean(), 1.5)

    def test_no_data_in_the_functions(self):
        """Functions that reach to it, as default ones do, leave other values precise enough for light."""
        for kind, fill in ((numpy.int32, -2147483648), (numpy.int64, -10 ** 14), (numpy.float64, -1e14),
                           (numpy.float64, -3.4028234663852886e38), (numpy.float32, -1e14),
                           (numpy.float32, -3.4028234663852886e38),
                           (numpy.uint32, 4294967295)):
            for isosurface in (False, True):
                with self.subTest(kind=kind, fill=fill, isosurface=isosurface):
                    values = make_values().astype(kind)
                    values[:4] = fill
                    scene = Scene(values)
                    scene.property.ShadeOn()
                    color = vtkColorTransferFunction()
                    color.AddRGBPoint(min(fill, 0.0), 0.2, 0.4, 1.0)
                    color.AddRGBPoint(max(fill, 100.0), 1.0, 0.8, 0.2)
                    scene.property.SetColor(color)
                    scene.property.SetScalarOpacity(scene.ramp((0, 0.05), (100, 0.05)))
                    if isosurface:
                        scene.mapper.SetBlendModeToIsoSurface()
                        scene.property.GetIsoSurfaceValues().SetValue(0, 60.0)
                    self.expect_kernels_alike(scene, 0.5)

    def test_sums_of_the_largest_numbers(self):
        for mode in ("Additive", "AverageIntensity"):
            for sign in (-1, 1):
                with self.subTest(mode=mode, sign=sign):
                    values = make_values().astype(numpy.float32)
                    values[:4] = sign * 3.4028234663852886e38
                    scene = Scene(values)
                    scene.property.SetScalarOpacity(scene.ramp((0, 0.05), (100, 0.05)))
                    getattr(scene.mapper, "SetBlendModeTo" + mode)()
                    self.expect_kernels_alike(scene, 0.5)

    def test_magnitudes(self):
        def plane(scene):
            texels = numpy.zeros((32, 32, 4), dtype=numpy.float32)
            texels[:, :, 0] = numpy.linspace(0, 1, 32)[:, None]
            texels[:, :, 1] = 0.7
            texels[8:, 12:, 3] = 0.4
            function = vtkImageData()
            function.SetDimensions(32, 32, 1)
            function.SetSpacing(100.0 / 31 * scene.unit, 20.0 / 31 * scene.unit, 1.0)
            function.GetPointData().SetScalars(numpy_to_vtk(texels.reshape(-1, 4), deep=True))
            scene.property.SetTransferFunction2D(0, function)
            scene.property.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)

        def labels(scene):
            mask = vtkImageData()
            mask.SetDimensions(SIDE, SIDE, SIDE)
            ones = numpy.ones(SIDE ** 3, dtype=numpy.uint8)
            ones[:SIDE ** 3 // 2] = 2
            mask.GetPointData().SetScalars(numpy_to_vtk(ones, deep=True))
            scene.mapper.SetMaskInput(mask)
            scene.mapper.SetMaskTypeToLabelMap()
            scene.mapper.SetMaskBlendFactor(1.0)
            for label, most in ((1, 8), (2, 20)):
                scene.property.SetLabelScalarOpacity(label, scene.ramp((0, 0), (30, 0), (90, 0.5)))
                scene.property.SetLabelGradientOpacity(label, scene.ramp((0, 0), (most, 1)))

        for change in (plane, labels):
            expected = None
            for unit in (1.0, 1e-24, 1e-15, 1e19, 1e25):
                with self.subTest(change=change.__name__, unit=unit):
                    scene = Scene((make_values() * unit).astype(numpy.float32), unit)
                    change(scene)
                    picture = scene.render()
                    expected = picture if expected is None else expected
                    self.expect_same(picture, expected)

    @staticmethod
    def set_even_plane(scene):
        texels = numpy.full((64, 4), 0.5, dtype=numpy.float32)
        function = vtkImageData()
        function.SetDimensions(8, 8, 1)
        function.GetPointData().SetScalars(numpy_to_vtk(texels, deep=True))
        scene.property.SetTransferFunction2D(0, function)
        scene.property.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)

    def test_ranges_without_a_scale(self):
        scene = Scene(make_values() * 1e-310, 1e-310)
        self.set_even_plane(scene)
        scene.mapper.ReferenceKernelsOn()
        scene.render()

    def test_no_numbers_in_planes(self):
        """A gradient that is not a number is none, as for gradient opacity."""
        values = make_values()
        values.ravel()[::53] = numpy.nan
        scene = Scene(values)
        self.set_even_plane(scene)
        picture = scene.render()
        scene.mapper.ReferenceKernelsOn()
        self.expect_same(picture, scene.render())

    def test_cells_of_lattices(self):
        """Lattices with many cells from one start of Newton's method to the next, and lattices that
        are a small part of the volume: rays ended where the inverse was not found."""
        middle = 0.5 * (SIDE - 1)
        values = make_values()
        for face in (0, 1, -2, -1):  # nothing to see at the border
            values[face], values[:, face], values[:, :, face] = 0.0, 0.0, 0.0
        for nodes, extent, amount in ((110, SIDE - 1.0, 1.0), (4, 0.1, 0.005), (4, 1e-4, 5e-6)):
            with self.subTest((nodes, extent)):
                lattice = vtkffd.vtkFFDLattice()
                lattice.SetDimensions(nodes, nodes, nodes)
                lattice.FitToBounds(3 * (middle - 0.5 * extent, middle + 0.5 * extent))
                x = numpy.linspace(0.0, 3.0, nodes)
                z, y, x = numpy.meshgrid(x, x, x, indexing="ij")
                moves = numpy.stack((numpy.sin(x + y), numpy.cos(y), numpy.cos(x + z)), axis=-1)
                lattice.SetDisplacements(numpy_to_vtk(amount * moves.reshape(-1, 3), deep=True))
                self.assertTrue(lattice.IsFoldFree())
                scene = Scene(values)
                scene.mapper.SetDeformation(lattice)
                scene.mapper.SetInverseModeToExact()
                picture = scene.render()
                scene.mapper.ReferenceKernelsOn()
                self.expect_same(picture, scene.render())

    def test_volumes_pressed_flat(self):
        middle = 0.5 * (SIDE - 1)
        for scale in ((0.01, 1, 1), (1, 1e-6, 1), (1, 1, 1e-12), (1e-5, 0.3, 1)):
            for deformed in (False, True):
                for parallel in (False, True):
                    with self.subTest(scale=scale, deformed=deformed, parallel=parallel):
                        scene = Scene(make_values(), deformed=deformed)
                        scene.property.ShadeOn()
                        scene.volume.SetOrigin(middle, middle, middle)
                        scene.volume.SetScale(*scale)
                        scene.renderer.GetActiveCamera().SetParallelProjection(parallel)
                        scene.renderer.GetActiveCamera().SetParallelScale(15.0)
                        picture = scene.render()
                        scene.mapper.ReferenceKernelsOn()
                        self.expect_same(picture, scene.render())

    def test_rows_of_pixels_along_columns(self):
        """A screen that is seen edge-on, by a matrix, as VTK's own off-axis projections differ from
        version to version: along the rays rows and columns of pixels have nearly the same direction,
        so that derivatives along them tell no normals."""
        scene = Scene(make_values(), deformed=True)
        scene.property.ShadeOn()
        scene.mapper.SetBlendModeToIsoSurface()
        scene.property.GetIsoSurfaceValues().SetValue(0, 60.0)
        scene.mapper.SetPositionTolerance(0.01)
        middle = numpy.array(scene.image.GetCenter())
        focus = middle + (-9.7, -0.43, -11.62)
        camera = scene.renderer.GetActiveCamera()
        camera.SetPosition(middle + (4.36, 8.45, -8.18))
        camera.SetFocalPoint(focus)
        camera.SetViewUp(-0.49, -0.45, -0.31)
        projection = vtkMatrix4x4()
        projection.DeepCopy((0.006, 0.0, 0.09015, 1.8e-5, 0.0, 0.006, 0.5535, 0.0,
                             0.0, 0.0, -1.0003, -0.034, 0.0, 0.0, -1.0, 0.0))
        camera.SetExplicitProjectionTransformMatrix(projection)
        camera.UseExplicitProjectionTransformMatrixOn()
        picture = scene.render()
        scene.mapper.ReferenceKernelsOn()
        self.expect_same(picture, scene.render(), 0.05)

    def test_a_flight_through_a_volume(self):
        """Far from its middle, lit surfaces close to the eye."""
        scene = Scene(make_values(), deformed=True)
        scene.property.ShadeOn()
        scene.property.SetScalarOpacity(scene.ramp((0, 0), (55, 0), (65, 0.9)))
        camera = scene.renderer.GetActiveCamera()
        camera.SetViewAngle(100.0)
        camera.SetClippingRange(0.1, 98.0)
        middle = numpy.array(scene.image.GetCenter())
        for position in ((9.0, -8.0, 7.0), (-9.0, 6.0, 9.0), (2.0, 10.0, -8.0)):
            with self.subTest(position=position):
                camera.SetPosition(middle + position)
                camera.SetFocalPoint(middle - (3.0, 2.0, 1.0))
                scene.mapper.ReferenceKernelsOff()
                picture = scene.render()
                scene.mapper.ReferenceKernelsOn()
                self.expect_same(picture, scene.render(), 0.25)

    def test_lengths_beyond_single_precision(self):
        for spacing in (1e18, 1e-19):
            scene = Scene(make_values(), spacing=spacing)
            colors = vtkImageData()
            self.assertEqual(
                scene.mapper.RenderToImage(scene.renderer, scene.volume, 8, 8, colors), 0)
            self.assertEqual(len(scene.errors), 1)
            self.assertIn("diagonal of the volume", scene.errors[0])


if __name__ == "__main__":
    unittest.main()
