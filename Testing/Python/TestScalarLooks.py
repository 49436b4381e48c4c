# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Components, masks, cells and gradient opacity of the mapper from Python, against closed forms."""

import itertools
import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

SIZE = 11
LENGTH = SIZE - 1


def constant(value):
    """A function, of opacity or a channel of color."""
    function = vtkPiecewiseFunction()
    function.AddPoint(0, value)
    return function


def color(red, green, blue):
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
        self.prop.SetColor(component, color(red, green, blue))

    def render(self, x=16, y=16):
        colors = vtkImageData()
        self.assertEqual(
            self.mapper.RenderToImage(self.renderer, self.volume, 32, 32, colors), 1)
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(32, 32, 4)
        return [int(c) for c in rgba[y, x]]

    def expect(self, expected, x=16, y=16, delta=2):
        for found, wanted in zip(self.render(x, y), expected):
            self.assertAlmostEqual(found, 255.0 * wanted, delta=delta)

    def test_independent_components(self):
        self.set_points(numpy.ones((SIZE ** 3, 2)))
        self.set_functions(0, 0.05, 1.0, 0.0, 0.0)
        self.set_functions(1, 0.05, 0.0, 1.0, 0.0)
        # Two of opacity a make the opacity a, and colors c1 + c2.
        self.expect([1.0, 1.0, 0.0, 1.0 - 0.95 ** LENGTH])
        self.prop.SetComponentWeight(1, 0.0)
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.95 ** LENGTH])

    def test_dependent_components(self):
        values = numpy.ones((SIZE ** 3, 4)) * [0.2, 0.4, 0.6, 1.0]
        self.set_points(values)
        self.set_functions(0, 0.1, 1.0, 1.0, 1.0)
        self.prop.IndependentComponentsOff()
        self.expect([0.2, 0.4, 0.6, 1.0 - 0.9 ** LENGTH])

    def test_dependent_bytes(self):
        # Bytes are looked up by other ways than numbers: they look as those of the reference.
        side = 40
        z, y, x = numpy.mgrid[0:side, 0:side, 0:side] / side
        waves = [numpy.sin(7.0 * x + 3.0 * y), numpy.cos(8.0 * y - 2.0 * z),
                 numpy.sin(6.0 * z + x), numpy.sin(9.0 * x) * numpy.cos(7.0 * y + 4.0 * z)]
        self.image.SetDimensions(side, side, side)
        self.image.SetSpacing(0.25, 0.25, 0.25)
        self.mapper.SetSampleDistance(0.2)
        self.prop.IndependentComponentsOff()
        self.prop.ShadeOn()
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(4, 4, 4)
        lattice.FitToBounds(self.image.GetBounds())
        lattice.SetControlPoint(1, 2, 1, 4.2, 6.1, 3.9)
        for (kind, count), deformed in itertools.product(
                ((numpy.uint8, 2), (numpy.int8, 2), (numpy.uint8, 4)), (False, True)):
            with self.subTest(kind=kind, count=count, deformed=deformed):
                low = numpy.iinfo(kind).min
                values = numpy.stack([127.5 + 120.0 * wave.ravel() for wave in waves], axis=-1)
                values = (numpy.round(values[:, 4 - count:]) + low).astype(kind)
                self.image.GetPointData().SetScalars(
                    numpy_to_vtk(numpy.ascontiguousarray(values), deep=True))
                opacity = vtkPiecewiseFunction()
                opacity.AddPoint(low + 100.0, 0.0)
                opacity.AddPoint(low + 200.0, 0.4)
                colors = vtkColorTransferFunction()
                colors.AddRGBPoint(low, 1.0, 0.2, 0.1)
                colors.AddRGBPoint(low + 255.0, 0.1, 0.5, 1.0)
                self.prop.SetScalarOpacity(opacity)
                self.prop.SetColor(colors)
                self.mapper.SetDeformation(lattice if deformed else None)
                pictures = []
                for reference in (False, True):
                    self.mapper.SetReferenceKernels(reference)
                    picture = vtkImageData()
                    self.assertEqual(
                        self.mapper.RenderToImage(
                            self.renderer, self.volume, 64, 64, picture), 1)
                    pictures.append(
                        vtk_to_numpy(picture.GetPointData().GetScalars()).astype(int))
                self.assertGreater((pictures[1][:, 3] > 0).mean(), 0.3)
                self.assertLess(abs(pictures[0] - pictures[1]).mean(), 0.1)

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
        self.prop.SetLabelColor(3, color(0.0, 0.0, 1.0))
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.9 ** LENGTH], x=8)
        self.expect([0.0, 0.0, 1.0, 1.0 - 0.9 ** LENGTH], x=24)
        self.mapper.SetMaskBlendFactor(0.5)
        self.expect([0.5, 0.0, 0.5, 1.0 - 0.9 ** LENGTH], x=24)
        self.mapper.SetMaskInput(None)
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.9 ** LENGTH], x=24)

    def test_shading_of_components(self):
        # The flag of the first component is that of all, as with VTK's mappers.
        self.set_points(numpy.ones((SIZE ** 3, 2)))
        for c in (0, 1):
            self.set_functions(c, 0.05, 1.0, 1.0, 1.0)
            self.prop.SetAmbient(c, 0.2)
        opacity = 1.0 - 0.95 ** LENGTH
        self.prop.ShadeOff(0)
        self.prop.ShadeOn(1)
        self.expect([1.0, 1.0, 1.0, opacity])
        self.prop.ShadeOn(0)
        self.prop.ShadeOff(1)
        # Without a gradient there is the ambient term, of both components.
        self.expect([0.4, 0.4, 0.4, opacity])

    def test_vector_modes(self):
        values = numpy.ones((SIZE ** 3, 3)) * [3.0, 4.0, 12.0]
        for array in (values.astype(numpy.uint8), values, values.astype(numpy.float32)):
            with self.subTest(dtype=array.dtype):
                self.image.GetPointData().SetScalars(numpy_to_vtk(array, deep=True))
                opacity = vtkPiecewiseFunction()
                colors = vtkColorTransferFunction()
                for x in (0.0, 20.0):
                    opacity.AddPoint(x, 0.005 * x)
                    colors.AddRGBPoint(x, 0.05 * x, 0.0, 1.0)
                self.prop.SetScalarOpacity(opacity)
                self.prop.SetColor(colors)
                self.prop.SetShade(0)
                self.mapper.SetVectorModeToMagnitude()
                self.assertEqual(self.mapper.GetVectorMode(), self.mapper.MAGNITUDE)
                self.expect([0.65, 0.0, 1.0, 1.0 - (1.0 - 0.065) ** LENGTH])
                self.assertGreater(self.mapper.GetAuxiliaryMemorySize(), SIZE ** 3)
                self.mapper.SetVectorModeToComponent()
                for component, value in ((0, 3.0), (1, 4.0), (2, 12.0)):
                    self.mapper.SetVectorComponent(component)
                    self.expect([0.05 * value, 0.0, 1.0,
                                 1.0 - (1.0 - 0.005 * value) ** LENGTH])
        # Changed vectors are looked at again.
        self.image.GetPointData().GetScalars().Fill(8.0)
        self.image.GetPointData().GetScalars().Modified()
        self.expect([0.4, 0.0, 1.0, 1.0 - 0.96 ** LENGTH])
        # There is none of this number: an error, and the next picture is right.
        self.mapper.SetVectorComponent(3)
        errors = []
        self.mapper.AddObserver("ErrorEvent", lambda *_: errors.append(1))
        colors = vtkImageData()
        self.assertEqual(self.mapper.RenderToImage(self.renderer, self.volume, 8, 8, colors), 0)
        self.assertEqual(len(errors), 1)
        self.mapper.SetVectorComponent(0)
        self.expect([0.4, 0.0, 1.0, 1.0 - 0.96 ** LENGTH])
        # One component is rendered as it is.
        self.set_points(numpy.full(SIZE ** 3, 10.0))
        self.mapper.SetVectorComponent(2)
        self.expect([0.5, 0.0, 1.0, 1.0 - 0.95 ** LENGTH])
        # Independent components again.
        self.mapper.SetVectorModeToDisabled()
        self.set_points(values)
        self.set_functions(0, 0.05, 1.0, 0.0, 0.0)
        self.set_functions(1, 0.0, 0.0, 1.0, 0.0)
        self.set_functions(2, 0.0, 0.0, 1.0, 0.0)
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.95 ** LENGTH])

    def test_clipped_voxel_intensity(self):
        # Rising along x, cut across z: without it the normal is across the view, with it along.
        _, _, x = numpy.mgrid[0:SIZE, 0:SIZE, 0:SIZE]
        self.set_points(x.ravel() * 4.0)
        self.set_functions(0, 1.0, 1.0, 1.0, 1.0)
        self.prop.ShadeOn()
        self.prop.SetAmbient(0.0)
        self.prop.SetDiffuse(1.0)
        self.prop.SetSpecular(0.0)
        plane = vtkPlane()
        plane.SetOrigin(5.0, 5.0, 6.45)
        plane.SetNormal(0.0, 0.0, -1.0)
        self.mapper.AddClippingPlane(plane)
        self.expect([0.0, 0.0, 0.0, 1.0], delta=4)
        self.prop.SetClippedVoxelIntensity(0.0)
        self.prop.UseClippedVoxelIntensityOn()
        # 20 at x = 5 falls to 0 within one voxel to the front; by x it rises by 8 over two.
        lit = 20.0 / (20.0 ** 2 + 8.0 ** 2) ** 0.5
        for reference in (False, True):
            self.mapper.SetReferenceKernels(reference)
            self.expect([lit, lit, lit, 1.0], delta=4)
        # The default is as good as minus infinity.
        self.prop.SetClippedVoxelIntensity(-1e299)
        self.expect([1.0, 1.0, 1.0, 1.0], delta=2)
        # Planes cut what has been deformed: stretched along z, the voxels are farther apart.
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(5, 5, 5)
        lattice.FitToBounds(self.image.GetBounds(), 0.2)
        moved = vtk_to_numpy(lattice.GetDisplacements())
        rest = [0.0] * 3
        for i in range(5 ** 3):
            lattice.GetRestPoint(i % 5, i // 5 % 5, i // 25, rest)
            moved[i, 2] = 0.5 * (rest[2] - 5.0)
        lattice.GetDisplacements().Modified()
        lattice.Modified()
        self.mapper.SetDeformation(lattice)
        self.prop.SetClippedVoxelIntensity(0.0)
        lit = 20.0 / 1.5 / ((20.0 / 1.5) ** 2 + 8.0 ** 2) ** 0.5
        for reference in (False, True):
            self.mapper.SetReferenceKernels(reference)
            self.expect([lit, lit, lit, 1.0], delta=4)
        # Beyond a voxel from the plane nothing changes.
        self.prop.UseClippedVoxelIntensityOff()
        self.expect([0.0, 0.0, 0.0, 1.0], delta=4)

    def test_where_vtk_differs(self):
        # vtkGPUVolumeRayCastMapper draws these otherwise: gray color functions, opacities of labels
        # and of two-dimensional functions at other sample distances, gradient opacity and normals of
        # dependent components (it takes those of the first one).
        self.set_points(numpy.ones(SIZE ** 3))
        self.set_functions(0, 0.1, 1.0, 1.0, 1.0)
        self.prop.SetColor(constant(0.3))
        self.expect([0.3, 0.3, 0.3, 1.0 - 0.9 ** LENGTH])
        self.prop.SetColor(color(1.0, 0.0, 0.0))
        mask = vtkImageData()
        mask.SetDimensions(SIZE, SIZE, SIZE)
        mask.GetPointData().SetScalars(
            numpy_to_vtk(numpy.full(SIZE ** 3, 2, dtype=numpy.uint8), deep=True))
        self.mapper.SetMaskInput(mask)
        self.prop.SetLabelScalarOpacity(2, constant(0.2))
        for distance in (0.25, 0.5, 2.0):
            self.mapper.SetSampleDistance(distance)
            self.expect([1.0, 0.0, 0.0, 1.0 - 0.8 ** LENGTH])
        self.mapper.SetMaskInput(None)
        plane = vtkImageData()
        plane.SetDimensions(4, 4, 1)
        looks = numpy.tile(numpy.float32([1.0, 0.0, 0.0, 0.2]), (16, 1))
        plane.GetPointData().SetScalars(numpy_to_vtk(looks, deep=True))
        self.prop.SetTransferFunction2D(plane)
        self.prop.SetTransferFunctionMode(vtkVolumeProperty.TF_2D)  # not by itself in VTK 9.3
        for distance in (0.25, 0.5, 2.0):
            self.mapper.SetSampleDistance(distance)
            self.expect([1.0, 0.0, 0.0, 1.0 - 0.8 ** LENGTH])
        self.prop.SetTransferFunctionMode(vtkVolumeProperty.TF_1D)
        # Color and density; the gradient is that of the density.
        z, _, x = numpy.mgrid[0:SIZE, 0:SIZE, 0:SIZE]
        self.mapper.SetSampleDistance(0.05)
        self.prop.IndependentComponentsOff()
        gradients = vtkPiecewiseFunction()
        gradients.AddPoint(0.0, 0.0)
        gradients.AddPoint(2.0, 1.0)
        self.prop.SetGradientOpacity(gradients)
        self.set_points(numpy.stack([x.ravel() * 10.0, z.ravel() * 1.0], axis=-1))
        self.expect([1.0, 0.0, 0.0, 1.0 - 0.95 ** LENGTH], delta=6)
        # Of colors and density, too; so are normals, which point at the viewer here.
        ramps = [x.ravel() / 20.0, x.ravel() / 20.0, x.ravel() / 20.0, z.ravel() * 1.0]
        self.set_points(numpy.stack(ramps, axis=-1))
        self.expect([0.26, 0.26, 0.26, 1.0 - 0.95 ** LENGTH], delta=6)
        self.prop.DisableGradientOpacityOn()
        self.prop.ShadeOn()
        self.prop.SetAmbient(0.0)
        self.prop.SetDiffuse(0.8)
        self.prop.SetSpecular(0.0)
        self.expect([0.8 * 0.26] * 3 + [1.0 - 0.9 ** LENGTH])

    def pictures(self, values, side=16):
        """Of values of all voxels of a cube: by the fast kernels, and by the reference kernels."""
        self.image.SetDimensions(side, side, side)
        spacing = LENGTH / (side - 1)
        self.image.SetSpacing(spacing, spacing, spacing)
        self.image.GetPointData().SetScalars(
            numpy_to_vtk(numpy.ascontiguousarray(values), deep=True))
        found = []
        for reference in (False, True):
            self.mapper.SetReferenceKernels(reference)
            picture = vtkImageData()
            self.assertEqual(
                self.mapper.RenderToImage(self.renderer, self.volume, 64, 64, picture), 1)
            found.append(vtk_to_numpy(picture.GetPointData().GetScalars()).astype(int))
        return found

    def make_holes(self, kind, components=1):
        """Noise from 20 to 100 of 16^3 voxels, its functions, and a part of the voxels."""
        random = numpy.random.default_rng(5)
        for component in range(components):
            opacity = vtkPiecewiseFunction()
            opacity.AddPoint(10.0, 0.0)
            opacity.AddPoint(100.0, 0.3)
            self.prop.SetScalarOpacity(component, opacity)
            colors = vtkColorTransferFunction()
            colors.AddRGBPoint(0.0, 1.0, 0.2, 0.1)
            colors.AddRGBPoint(100.0, 0.1, 0.5, 1.0)
            self.prop.SetColor(component, colors)
        values = random.uniform(20.0, 100.0, (16 ** 3, components)).astype(kind)
        self.mapper.SetSampleDistance(0.4)
        return values, random.random(16 ** 3) < 0.05

    def test_holes_of_nearest_voxels(self):
        # Those beside the voxel that is nearest do not count, whatever they are.
        self.prop.SetInterpolationTypeToNearest()
        camera = self.renderer.GetActiveCamera()
        camera.Azimuth(20.0)
        for kind, components, blend in itertools.product(
                (numpy.float32, numpy.float64), (1, 2), (0, 1, 3)):
            with self.subTest(kind=kind, components=components, blend=blend):
                values, holes = self.make_holes(kind, components)
                self.mapper.SetBlendMode(blend)
                values[holes] = 5.0  # transparent
                fast, _ = self.pictures(values)
                values[holes] = numpy.nan
                with_holes, reference = self.pictures(values)
                if blend == 0:
                    self.assertLessEqual(abs(with_holes - fast).max(), 1)
                self.assertLess(abs(with_holes - reference).mean(), 0.5)
                # What is infinite is the largest value, in its own voxel.
                values[holes] = numpy.inf
                fast, reference = self.pictures(values)
                self.assertLess(abs(fast - reference).mean(), 0.5)

    def test_holes_of_colors(self):
        # The opacity is known where the color is not: the color is the first one.
        self.prop.IndependentComponentsOff()
        values, holes = self.make_holes(numpy.float32, 2)
        values[holes, 0] = numpy.nan
        fast, reference = self.pictures(values)
        self.assertLess(abs(fast - reference).mean(), 0.05)

    def test_gradients_beside_what_is_infinite(self):
        # As of the logarithm of fields that are zero somewhere. They are as large as can be.
        values, holes = self.make_holes(numpy.float32)
        values[holes] = -numpy.inf
        gradients = vtkPiecewiseFunction()
        gradients.AddPoint(0.0, 0.0)
        gradients.AddPoint(20.0, 1.0)
        self.prop.SetGradientOpacity(gradients)
        fast, reference = self.pictures(values)
        self.assertGreater((reference[:, 3] > 0).mean(), 0.3)
        self.assertLess(abs(fast - reference).mean(), 0.05)

    def test_logarithmic_paths_of_colors(self):
        # VTK looks for the path in each call: a color at a time, the table took minutes.
        self.set_functions(0, 1.0, 0.0, 0.0, 0.0)
        colors = self.prop.GetRGBTransferFunction()
        colors.RemoveAllPoints()
        colors.SetColorSpaceToLabCIEDE2000()
        colors.SetScaleToLog10()
        for x, rgb in ((0.5, (0.2, 0.3, 0.8)), (10.0, (0.9, 0.9, 0.9)), (100.0, (0.7, 0.1, 0.2))):
            colors.AddRGBPoint(x, *rgb)
        for value in (1.0, 3.0, 20.0, 70.0):
            self.set_points(numpy.linspace(value, value + 1e-3, SIZE ** 3))
            self.expect([*colors.GetColor(value), 1.0])
        # Where there is no logarithm the first color holds.
        self.set_points(numpy.linspace(-10.0, -1.0, SIZE ** 3))
        self.expect([0.2, 0.3, 0.8, 1.0])

    def show(self, value, low, high):
        """Voxels of a value, behind which others are, from `low` to `high`."""
        values = numpy.full((SIZE, SIZE * SIZE), value, dtype=numpy.float64)
        values[0] = numpy.linspace(low, high, SIZE * SIZE)
        self.image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))

    def expect_colors(self, points, low, high, change=lambda colors: None):
        """Those of a function, at its points, between and beyond them."""
        colors = vtkColorTransferFunction()
        colors.AllowDuplicateScalarsOn()
        for x, *rgb in points:
            colors.AddRGBPoint(x, *rgb)
        change(colors)
        self.set_functions(0, 1.0, 0.0, 0.0, 0.0)
        self.prop.SetColor(0, colors)
        places = [x for x, *_ in points]
        inner = numpy.linspace(low, high, 9)[1:-1]
        for value in [*places, *(x for x in inner if min(abs(x - p) for p in places) > 0.05)]:
            for reference in (False, True):
                with self.subTest(points=points, value=value, reference=reference):
                    self.mapper.SetReferenceKernels(reference)
                    self.show(value, low, high)
                    self.expect([*colors.GetColor(value), 1.0])

    def test_functions_of_one_point(self):
        for low, high in ((-1.0, 2.0), (-300.0, 500.0), (1.0, 1.5), (100.0, 101.0)):
            self.expect_colors([(1.0, 0.3, 0.9, 0.6)], low, high)

        def beyond(colors):
            colors.UseBelowRangeColorOn()
            colors.SetBelowRangeColor(0.0, 0.2, 1.0)
            colors.UseAboveRangeColorOn()
            colors.SetAboveRangeColor(1.0, 0.0, 0.4)

        self.expect_colors([(1.0, 0.3, 0.9, 0.6)], -300.0, 500.0, beyond)
        self.expect_colors([(1.0, 0.3, 0.9, 0.6), (2.0, 0.9, 0.5, 0.1)], -5.0, 8.0, beyond)

    def test_steps_at_the_last_points(self):
        for scale, low, high in ((1.0, -1.0, 80.0), (1e-3, -1e-3, 0.08)):
            step = [(20.0 * scale, 1.0, 0.0, 0.0), (40.0 * scale, 1.0, 0.0, 0.0),
                    (40.0 * scale, 0.0, 1.0, 0.0)]
            colors = vtkColorTransferFunction()
            colors.AllowDuplicateScalarsOn()
            opacity = vtkPiecewiseFunction()
            opacity.AllowDuplicateScalarsOn()
            for x, red, green, blue in step:
                colors.AddRGBPoint(x, red, green, blue)
                opacity.AddPoint(x, green)
            for value, visible in ((30.0, 0.0), (41.0, 1.0), (60.0, 1.0)):
                with self.subTest(scale=scale, value=value):
                    values = numpy.full(SIZE ** 3, value * scale)
                    values[[0, -1]] = low, high
                    self.image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
                    self.set_functions(0, 1.0, 0.0, 0.0, 0.0)
                    self.prop.SetColor(0, colors)
                    self.expect([1.0 - visible, visible, 0.0, 1.0])
                    self.prop.SetScalarOpacity(0, opacity)
                    self.prop.SetColor(0, color(0.0, 0.0, 1.0))
                    self.expect([0.0, 0.0, visible, visible])

    def test_logarithmic_functions(self):
        def logarithmic(colors):
            colors.SetScaleToLog10()

        def below(colors):
            colors.SetScaleToLog10()
            colors.UseBelowRangeColorOn()
            colors.SetBelowRangeColor(0.0, 1.0, 0.0)

        ends = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        self.expect_colors([(1.0, *ends[0]), (1e4, *ends[1])], 1.0, 2e4, logarithmic)
        self.expect_colors([(5.0, *ends[0]), (1e3, *ends[1])], 0.0, 2e3, below)
        # They are linear where they begin at 0 or below.
        for low, high in ((-100.0, -1.0), (-50.0, 50.0), (0.0, 100.0)):
            self.expect_colors([(low, *ends[0]), (high, *ends[1])], low - 20.0, high + 20.0, logarithmic)
        # Where there is no logarithm the color below the points holds.
        self.set_functions(0, 1.0, 0.0, 0.0, 0.0)
        colors = vtkColorTransferFunction()
        colors.AddRGBPoint(1.0, *ends[0])
        colors.AddRGBPoint(100.0, *ends[1])
        below(colors)
        self.prop.SetColor(0, colors)
        self.show(-20.0, -50.0, 200.0)
        self.expect([0.0, 1.0, 0.0, 1.0])
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(1e-3, 0.0)
        opacity.AddPoint(10.0, 1.0)
        opacity.UseLogScaleOn()
        self.set_functions(0, 1.0, 0.0, 0.0, 1.0)
        self.prop.SetScalarOpacity(0, opacity)
        for value in (0.0015, 0.003, 0.006):
            with self.subTest(value=value):
                values = numpy.full(SIZE ** 3, value)
                values[[0, -1]] = 0.0, 20.0
                self.set_points(values)
                self.expect([0.0, 0.0, 1.0, 1.0 - (1.0 - opacity.GetValue(value)) ** LENGTH], delta=8)

    def test_scalars_of_few_different_numbers(self):
        """Far from zero, a few thousand of the numbers that there are lie between the least and the
        largest one."""
        for kind, low, width in ((numpy.float64, 1.0, 5e-13), (numpy.int64, 2 ** 59, 2 ** 18)):
            for reference in (False, True):
                with self.subTest(kind=kind, reference=reference):
                    self.mapper.SetReferenceKernels(reference)
                    colors = vtkColorTransferFunction()
                    colors.AddRGBPoint(low, 1.0, 0.0, 0.0)
                    colors.AddRGBPoint(low + width, 0.0, 0.0, 1.0)
                    self.set_functions(0, 1.0, 0.0, 0.0, 0.0)
                    self.prop.SetColor(0, colors)
                    values = numpy.full(SIZE ** 3, low + kind(0.75 * width), dtype=kind)
                    values[:2] = low, low + kind(width)
                    self.image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
                    self.expect([0.25, 0.0, 0.75, 1.0])

    def test_cells(self):
        self.image.GetCellData().SetScalars(
            numpy_to_vtk(numpy.ones(LENGTH ** 3, dtype=numpy.float32), deep=True))
        self.set_functions(0, 0.1, 1.0, 1.0, 0.0)
        self.expect([1.0, 1.0, 0.0, 1.0 - 0.9 ** LENGTH])
        # The outer halves of the outermost cells show these, whatever the cells behind them hold.
        values = numpy.ones((LENGTH, LENGTH, LENGTH), dtype=numpy.float32)
        values[1] = numpy.nan
        self.image.GetCellData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        for reference in (False, True):
            self.mapper.SetReferenceKernels(reference)
            self.expect([1.0, 1.0, 0.0, 1.0 - 0.9 ** (LENGTH - 2)])


if __name__ == "__main__":
    unittest.main()
