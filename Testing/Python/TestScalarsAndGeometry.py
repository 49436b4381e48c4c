# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The picture depends on the scalars and on where they are, not on how either is stored: scalar
types, offsets and scales, extents, spacings, direction matrices, matrices of the vtkVolume."""
import os
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util import vtkConstants
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)

import vtkffd

SIZE = 120

# Scalars of the test volume lie in 0..127 and fit all types.
INTEGER_TYPES = {
    "VTK_CHAR": np.int8,
    "VTK_SIGNED_CHAR": np.int8,
    "VTK_UNSIGNED_CHAR": np.uint8,
    "VTK_SHORT": np.int16,
    "VTK_UNSIGNED_SHORT": np.uint16,
    "VTK_INT": np.int32,
    "VTK_UNSIGNED_INT": np.uint32,
    "VTK_LONG_LONG": np.int64,
    "VTK_UNSIGNED_LONG_LONG": np.uint64,
    "VTK_LONG": np.int64,
    "VTK_UNSIGNED_LONG": np.uint64,
    "VTK_ID_TYPE": np.int64,
}
FLOAT_TYPES = {"VTK_FLOAT": np.float32, "VTK_DOUBLE": np.float64}


def rotation(axis, degrees):
    """Matrix that turns about an axis (Rodrigues)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * (k @ k)


class TestScalarsAndGeometry(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(os.path.join(os.environ["FFD_TEST_DATA"], "fuel.vti"))
        reader.Update()
        image = reader.GetOutput()
        cls.shape = image.GetDimensions()[::-1]
        values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(cls.shape)
        cls.values = (values // 2).astype(np.int64)

    def make_image(self, values, spacing=(1, 1, 1), origin=(0, 0, 0), start=(0, 0, 0),
                   direction=None, array_type=None):
        image = vtkImageData()
        nz, ny, nx = values.shape
        image.SetExtent(start[0], start[0] + nx - 1, start[1], start[1] + ny - 1,
                        start[2], start[2] + nz - 1)
        image.SetSpacing(spacing)
        image.SetOrigin(origin)
        if direction is not None:
            image.SetDirectionMatrix(np.asarray(direction, float).ravel())
        array = numpy_to_vtk(np.ascontiguousarray(values).ravel(), 1, array_type)
        image.GetPointData().SetScalars(array)
        return image

    def render(self, image, deformation=None, matrix=None, scale=1.0, offset=0.0, bounds=None,
               interpolation="Linear", unit=1.0):
        """
        RGBA of the image, with transfer functions of scale * scalar + offset. `unit`: of lengths,
        which are those before the matrix.
        """
        def at(scalar):
            return scale * scalar + offset

        opacity = vtkPiecewiseFunction()
        color = vtkColorTransferFunction()
        for scalar, alpha, rgb in ((5, 0, (0.2, 0.3, 0.9)), (20, 0.05, (0.2, 0.8, 0.7)),
                                   (60, 0.3, (0.9, 0.7, 0.2)), (120, 0.9, (1, 0.2, 0.1))):
            opacity.AddPoint(at(scalar), alpha)
            color.AddRGBPoint(at(scalar), *rgb)
        prop = vtkVolumeProperty()
        prop.SetScalarOpacity(opacity)
        prop.SetColor(color)
        prop.ShadeOn()
        prop.SetScalarOpacityUnitDistance(unit)
        getattr(prop, "SetInterpolationTypeTo" + interpolation)()
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetDeformation(deformation)
        mapper.SetSampleDistance(0.5 * unit)
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop)
        if matrix is not None:
            m = vtkMatrix4x4()
            m.DeepCopy(np.asarray(matrix, float).ravel())
            volume.SetUserMatrix(m)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        camera = renderer.GetActiveCamera()
        camera.Azimuth(35)
        camera.Elevation(25)
        renderer.ResetCamera(bounds or volume.GetBounds())
        camera.Zoom(1.5)
        renderer.ResetCameraClippingRange(bounds or volume.GetBounds())
        out = vtkImageData()
        self.assertEqual(mapper.RenderToImage(renderer, volume, SIZE, SIZE, out), 1)
        rgba = vtk_to_numpy(out.GetPointData().GetScalars()).reshape(SIZE, SIZE, 4).astype(float)
        rgba[..., :3] *= rgba[..., 3:] / 255
        self.assertGreater((rgba[..., 3] > 10).sum(), 400, "nothing to compare")
        return rgba

    def assert_same(self, a, b, name, mean=0.02, largest=1.0):
        """Bytes may round either way, and colors are rounded before they meet their alpha."""
        d = np.abs(a - b).max(axis=2)
        seen = d[(a[..., 3] > 0) | (b[..., 3] > 0)]
        print(f"{name}: mean {seen.mean():.4f} max {seen.max():.2f} over {seen.size} px")
        self.assertLessEqual(seen.mean(), mean, name)
        self.assertLessEqual(seen.max(), largest + 0.01, name)

    def bend(self, bounds, amplitude=6.0, n=7):
        net = vtkImageData()
        net.SetDimensions(n, n, n)
        low, high = np.asarray(bounds[::2]), np.asarray(bounds[1::2])
        spacing = (high - low) / (n - 3)
        net.SetSpacing(spacing)
        net.SetOrigin(low - spacing)
        d = np.zeros((n, n, n, 3))
        d[..., 0] = amplitude * np.cos(np.pi * ((np.arange(n) - 1) / (n - 3) - 0.5))[:, None, None]
        net.GetPointData().SetScalars(numpy_to_vtk(d.reshape(-1, 3), 1))
        transform = vtkBSplineTransform()
        transform.SetCoefficientData(net)
        return transform

    def test_scalar_types(self):
        reference = self.render(self.make_image(self.values.astype(np.uint8)))
        for name, dtype in {**INTEGER_TYPES, **FLOAT_TYPES}.items():
            image = self.make_image(self.values.astype(dtype),
                                    array_type=getattr(vtkConstants, name))
            self.assertEqual(image.GetScalarType(), getattr(vtkConstants, name))
            self.assert_same(self.render(image), reference, name)

    def render_components(self, values, scales, dependent, deformation, lookups):
        """
        RGBA of an image of several components, an array of each: the values scaled and shifted by
        (scale, offset), as are their functions. `lookups` of distances to what is visible, for
        each ray: appended to.
        """
        image = self.make_image(values[0])
        image.GetPointData().SetScalars(numpy_to_vtk(np.stack(
            [component.ravel() for component in values], axis=-1), deep=True))
        prop = vtkVolumeProperty()
        prop.SetIndependentComponents(not dependent)
        for c in range(1 if dependent else len(scales)):
            # Of two dependent components the second one is looked up for opacity.
            scale, offset = scales[-1] if dependent else scales[c]
            of_color, color_offset = scales[c]
            opacity = vtkPiecewiseFunction()
            color = vtkColorTransferFunction()
            for scalar, alpha, rgb in ((5, 0, (0.2, 0.3, 0.9)), (20, 0.05, (0.2, 0.8, 0.7)),
                                       (60, 0.3, (0.9, 0.7, 0.2)), (120, 0.9, (1, 0.2, 0.1))):
                opacity.AddPoint(scale * scalar + offset, alpha)
                color.AddRGBPoint(of_color * scalar + color_offset, *np.roll(rgb, c))
            prop.SetScalarOpacity(c, opacity)
            prop.SetColor(c, color)
            prop.SetShade(c, 1)
            prop.SetComponentWeight(c, 1.0 - 0.2 * c)
            gradient = vtkPiecewiseFunction()
            gradient.AddPoint(0.0, 0.2)
            gradient.AddPoint(20.0 * scale, 1.0)
            prop.SetGradientOpacity(c, gradient)
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetDeformation(deformation)
        mapper.CollectStatisticsOn()
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        renderer.GetActiveCamera().Azimuth(35)
        renderer.ResetCamera(volume.GetBounds())
        renderer.GetActiveCamera().Zoom(1.5)
        out = vtkImageData()
        self.assertEqual(mapper.RenderToImage(renderer, volume, SIZE, SIZE, out), 1)
        lookups.append(mapper.GetStatistics().GetDistanceLookupsPerRay())
        rgba = vtk_to_numpy(out.GetPointData().GetScalars()).reshape(SIZE, SIZE, 4).astype(float)
        rgba[..., :3] *= rgba[..., 3:] / 255
        self.assertGreater((rgba[..., 3] > 10).sum(), 400, "nothing to compare")
        return rgba

    def test_components_of_types_beyond_single_precision(self):
        plain = [(1, 0)] * 4
        # A few values of a large range would be lost if all components were scaled as the first.
        scaled = {np.int32: [(1, 0), (10**7, -64 * 10**7), (3, 10**9), (1, 2**31 - 200)],
                  np.uint32: [(1, 0), (3 * 10**7, 5), (1, 4 * 10**9), (2, 7)],
                  np.int64: [(10**15, -64 * 10**15), (1, 10**12), (7, 0), (10**9, 1)],
                  np.uint64: [(7 * 10**16, 10**15), (1, 10**13), (1, 0), (5, 3)],
                  np.float64: [(1e-6, 10.0), (1e30, -5e31), (1.0, 1e9), (1e-30, 0.0)]}
        for count, dependent in ((2, False), (3, False), (4, False), (2, True)):
            values = [np.roll(self.values, 5 * c, axis=c % 3) for c in range(count)]
            for deformation in (None, self.bend((0, 63, 0, 63, 0, 63))):
                lookups = []
                expected = self.render_components(
                    [v.astype(np.uint8) for v in values], plain[:count], dependent, deformation,
                    lookups)
                for dtype, scales in scaled.items():
                    with self.subTest(dtype=dtype, count=count, dependent=dependent):
                        picture = self.render_components(
                            [(v.astype(object) * s + o).astype(dtype)
                             for v, (s, o) in zip(values, scales)],
                            scales[:count], dependent, deformation, lookups)
                        self.assert_same(picture, expected, f"{count} x {np.dtype(dtype)}",
                                         mean=0.15, largest=4.0)
                        # Each of the rays that are sampled one at a time looks for itself.
                        self.assertLess(lookups[-1], 1.3 * lookups[0])

    def test_negative_and_scaled_scalars(self):
        reference = self.render(self.make_image(self.values.astype(np.uint8)))
        for dtype, scale, offset in (
                (np.int8, 1, -64), (np.int16, 1, -1000), (np.int16, 200, -12800),
                (np.uint16, 500, 1000), (np.int32, 10000000, -640000000),
                (np.uint32, 30000000, 5), (np.int64, 10**15, -64 * 10**15),
                (np.uint64, 7 * 10**16, 10**15), (np.float32, 0.001, -0.05),
                (np.float64, 1e-6, 10.0), (np.float64, 1e30, -5e31)):
            values = (self.values * scale + offset).astype(dtype)
            picture = self.render(self.make_image(values), scale=scale, offset=offset)
            # Small integers have table entries of their own, others are interpolated.
            self.assert_same(picture, reference, f"{np.dtype(dtype)} * {scale} + {offset}",
                             mean=0.1, largest=2.0)

    def test_extent_is_a_shift_of_the_origin(self):
        values = self.values.astype(np.uint8)
        spacing = (1.0, 0.8, 1.3)
        moved = self.make_image(values, spacing, (10.0, 20.0, 30.0), (-5, 7, -11))
        origin = (10.0 - 5 * 1.0, 20.0 + 7 * 0.8, 30.0 - 11 * 1.3)
        plain = self.make_image(values, spacing, origin)
        np.testing.assert_allclose(moved.GetBounds(), plain.GetBounds(), atol=1e-12)
        for deformation in (None, self.bend(plain.GetBounds())):
            self.assert_same(self.render(moved, deformation), self.render(plain, deformation),
                             "extent", mean=0.001)

    def test_direction_is_a_user_matrix(self):
        values = self.values.astype(np.uint8)
        origin = np.array([3.0, -20.0, 8.0])
        mirror = np.diag([-1.0, 1.0, 1.0])
        for name, direction in (("rotated", rotation((1, 2, -1), 40)), ("mirrored", mirror),
                                ("rotated and mirrored", rotation((0, 1, 2), 70) @ mirror)):
            turned = self.make_image(values, (1, 1, 1.5), origin, direction=direction)
            plain = self.make_image(values, (1, 1, 1.5), origin)
            matrix = np.eye(4)
            matrix[:3, :3] = direction
            matrix[:3, 3] = origin - direction @ origin
            bounds = turned.GetBounds()
            self.assert_same(self.render(turned, bounds=bounds),
                             self.render(plain, matrix=matrix, bounds=bounds), name, mean=0.05)
        # The mirror image is another picture, or the above would prove little.
        plain = self.make_image(values, (1, 1, 1.5))
        matrix = np.eye(4)
        matrix[0, 0] = -1
        matrix[0, 3] = 63
        mirrored = self.render(plain, matrix=matrix, bounds=plain.GetBounds())
        self.assertGreater(np.abs(mirrored - self.render(plain)).mean(), 1.0)

    def test_deformation_is_in_data_coordinates(self):
        # Rest points of a rotated image lie in rotated places: a bend along the world's x, seen
        # from the same place, is the bend along that direction of the unrotated image.
        values = self.values.astype(np.uint8)
        quarter = rotation((0, 0, 1), 90)
        turned = self.make_image(np.ascontiguousarray(values), (1, 1, 1), (63, 0, 0),
                                 direction=quarter)
        # The same scalars, stored in the world's order.
        stored = np.ascontiguousarray(np.swapaxes(values, 1, 2)[:, :, ::-1])
        plain = self.make_image(stored)
        np.testing.assert_allclose(turned.GetBounds(), plain.GetBounds(), atol=1e-9)
        bend = self.bend(plain.GetBounds())
        self.assert_same(self.render(turned, bend), self.render(plain, bend), "turned, bent")

    def test_spacing_is_a_scale(self):
        # But that lengths are those before the matrix: it makes a volume no denser.
        values = self.values.astype(np.uint8)
        larger = self.make_image(values, (2, 2, 2))
        plain = self.make_image(values)
        matrix = np.diag([2.0, 2.0, 2.0, 1.0])
        scaled = self.render(plain, matrix=matrix)
        self.assert_same(self.render(larger, unit=2.0), scaled, "spacing", mean=0.05)
        self.assertGreater(np.abs(self.render(larger) - scaled).mean(), 1.0)

    def test_any_matrix(self):
        # A matrix with scales and a shear after one that the image can hold as its direction: lengths
        # are those before the matrix, so only what keeps them may be on either side.
        values = self.values.astype(np.uint8)
        matrix = np.eye(4)
        matrix[:3, :3] = rotation((1, 1, 0), 30)
        matrix[:3, 3] = (5, -3, 2)
        after = np.eye(4)
        after[:3, :3] = np.diag([1.2, 0.8, 1.5]) @ [[1, 0.4, 0], [0, 1, -0.3], [0.2, 0, 1]]
        plain = self.make_image(values)
        other = self.make_image(values, (1, 1, 1), (5, -3, 2),
                                direction=rotation((1, 1, 0), 30))
        bounds = (-20, 120, -60, 80, -60, 120)
        self.assert_same(self.render(other, matrix=after, bounds=bounds),
                         self.render(plain, matrix=after @ matrix, bounds=bounds),
                         "rotation, scales and shear", mean=0.1)

    def test_nearest_interpolation(self):
        # Constant voxels: finer voxels of the same values are the same picture.
        values = self.values[:32, :32, :32].astype(np.uint8)
        # Thrice as fine: nearest voxels then split at the same places.
        fine = values.repeat(3, 0).repeat(3, 1).repeat(3, 2)[1:-1, 1:-1, 1:-1]
        coarse = self.make_image(values)
        finer = self.make_image(fine, (1 / 3, 1 / 3, 1 / 3))
        np.testing.assert_allclose(coarse.GetBounds(), finer.GetBounds(), atol=1e-9)
        pictures = []
        for image in (coarse, finer):
            # Gradients differ, so unshaded: alpha depends on the scalars alone.
            pictures.append(self.render(image, interpolation="Nearest")[..., 3])
        d = np.abs(pictures[0] - pictures[1])[pictures[0] > 0]
        print("nearest: mean", d.mean(), "max", d.max())
        self.assertLessEqual(d.mean(), 0.1)
        linear = self.render(coarse)[..., 3]
        self.assertGreater(np.abs(linear - pictures[0]).mean(), 0.5)


if __name__ == "__main__":
    unittest.main()
