# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gradients at the faces of a volume, and beside what is blanked, are those of what there is: a
linear field is lit, and weighed by its gradient opacity, up to its faces as within."""
import itertools
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import (
    vtkDataSetAttributes,
    vtkImageData,
    vtkPiecewiseFunction,
)
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)

import vtkffd

SIZE = 40
SHAPE = (6, 7, 8)  # voxels along x, y, z


def linear(slope, offset, shape=SHAPE):
    """Values at voxels, z slowest."""
    z, y, x = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in shape[::-1]), indexing="ij")
    return slope[0] * x + slope[1] * y + slope[2] * z + offset


def make_image(values, cells=False):
    image = vtkImageData()
    image.SetDimensions([n + (1 if cells else 0) for n in values.shape[::-1]])
    array = numpy_to_vtk(values.ravel(), 1)
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(array)
    return image


class Scene:
    def __init__(self, image, cells=False):
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        if cells:
            self.mapper.SetScalarModeToUseCellData()
        self.property = vtkVolumeProperty()
        self.property.SetInterpolationTypeToLinear()
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0, 1, 1, 1)
        self.property.SetColor(color)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)

    def set_opacity(self, opacity):
        function = vtkPiecewiseFunction()
        function.AddPoint(0, opacity)
        self.property.SetScalarOpacity(function)

    def look_along(self, axis, sign, middle=None):
        """At a point, the center of the volume if none is given, from far away, so that the headlight
        shines along the axis."""
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        middle = middle or self.volume.GetCenter()
        position = list(middle)
        position[axis] -= 1e4 * sign
        camera.SetFocalPoint(middle)
        camera.SetPosition(position)
        camera.SetViewUp([1.0 if a == (axis + 1) % 3 else 0.0 for a in range(3)])
        camera.SetParallelScale(5)
        self.renderer.ResetCameraClippingRange()

    def render(self):
        out = vtkImageData()
        if not self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, out):
            raise AssertionError("not rendered")
        return vtk_to_numpy(out.GetPointData().GetScalars()).reshape(SIZE, SIZE, 4).astype(int)


class TestFaces(unittest.TestCase):
    def assert_lit(self, scene, name):
        """Normals and light are 45 degrees apart: cos(45 degrees) of 255 wherever anything is."""
        scene.set_opacity(1.0)
        scene.property.ShadeOn()
        scene.property.SetAmbient(0.0)
        scene.property.SetDiffuse(1.0)
        scene.property.SetSpecular(0.0)
        for reference in (0, 1):
            scene.mapper.SetReferenceKernels(reference)
            rgba = scene.render()
            seen = rgba[rgba[..., 3] > 0]
            self.assertGreater(len(seen), 300, name)
            wrong = np.abs(seen[:, :3] - 180).max()
            self.assertLessEqual(wrong, 1, f"{name}, reference {reference}")

    def test_normals(self):
        for cells, nearest, axis, sign in itertools.product((False, True), (False, True),
                                                            range(3), (-1, 1)):
            slope = np.zeros(3)
            slope[axis] = slope[(axis + 1) % 3] = 3.0
            scene = Scene(make_image(linear(slope, 5.0), cells), cells)
            scene.property.SetInterpolationType(0 if nearest else 1)
            scene.look_along(axis, sign)
            for distance in (1.0, 0.05):
                scene.mapper.SetSampleDistance(distance)
                self.assert_lit(
                    scene, f"cells {cells}, nearest {nearest}, axis {axis}, {sign}, {distance}")

    def test_normals_by_other_ways(self):
        values = linear((3.0, 0.0, 3.0), 5.0)
        # Deformed by nothing, components that depend on each other, the opacity's normals.
        for way in range(4):
            image = make_image(values)
            if way == 1:
                pairs = np.stack((values, values), axis=-1).reshape(-1, 2)
                image.GetPointData().SetScalars(numpy_to_vtk(pairs, 1))
            scene = Scene(image)
            scene.look_along(2, 1)
            scene.mapper.SetSampleDistance(0.05)
            if way == 0:
                lattice = vtkffd.vtkFFDLattice()
                lattice.SetDimensions(5, 5, 5)
                lattice.FitToBounds(image.GetBounds())
                scene.mapper.SetDeformation(lattice)
            elif way == 1:
                scene.property.IndependentComponentsOff()
            elif way == 2:
                scene.mapper.SetSegmentationToGreedyAngle()
            else:
                scene.mapper.SetBlendModeToIsoSurface()
                scene.property.GetIsoSurfaceValues().SetValue(0, 20.0)
                scene.mapper.SetSampleDistance(0.5)
            self.assert_lit(scene, f"way {way}")

    def test_normals_beside_blanked(self):
        for cells, nearest in itertools.product((False, True), (False, True)):
            values = linear((3.0, 0.0, 3.0), 5.0)
            values[:3, 2:5, 2:4] = 1e6
            image = make_image(values, cells)
            ghosts = np.zeros(values.shape, np.uint8)
            ghosts[:3, 2:5, 2:4] = (vtkDataSetAttributes.HIDDENCELL if cells
                                    else vtkDataSetAttributes.HIDDENPOINT)
            array = numpy_to_vtk(ghosts.ravel(), 1)
            array.SetName(vtkDataSetAttributes.GhostArrayName())
            (image.GetCellData() if cells else image.GetPointData()).AddArray(array)
            scene = Scene(image, cells)
            scene.property.SetInterpolationType(0 if nearest else 1)
            scene.look_along(2, 1)
            scene.mapper.SetSampleDistance(0.05)
            self.assert_lit(scene, f"cells {cells}, nearest {nearest}")

    def test_components_in_narrow_views(self):
        # Rays close to each other need few rows of voxels, beside each face other ones.
        size = 24
        random = np.random.default_rng(7)
        for components, scalars in itertools.product((2, 4), (np.uint8, np.uint16, np.float64)):
            values = random.integers(0, 256, (size ** 3, components)).astype(scalars)
            image = vtkImageData()
            image.SetDimensions(size, size, size)
            image.GetPointData().SetScalars(numpy_to_vtk(values, 1))
            for axis, sign, last in itertools.product(range(3), (-1, 1), (False, True)):
                scene = Scene(image)
                scene.property.IndependentComponentsOff()
                scene.property.ShadeOn()
                scene.set_opacity(0.0)
                scene.property.GetScalarOpacity().AddPoint(255, 0.3)
                middle = [size - 3.0 if last else 2.0] * 3
                middle[axis] = 0.5 * (size - 1)
                scene.look_along(axis, sign, middle)
                camera = scene.renderer.GetActiveCamera()
                camera.SetParallelScale(3.5)
                camera.Azimuth(0.1)
                scene.renderer.ResetCameraClippingRange()
                fast = scene.render()
                self.assertGreater(np.mean(fast[..., 3] > 0), 0.5)
                scene.mapper.ReferenceKernelsOn()
                error = np.abs(fast - scene.render())
                self.assertLess(error.mean(), 0.02, f"{components}, {scalars}, {axis}, {sign}")
                self.assertLessEqual(error.max(), 2)

    def test_gradient_opacity_of_three_slices(self):
        values = linear((0.0, 0.0, 3.0), 5.0, (12, 12, 3))
        # Of the gradient magnitudes those up to a quarter of the range of the scalars count.
        values[0, 0, 0] = 125.0
        scene = Scene(make_image(values))
        scene.set_opacity(0.5)
        function = vtkPiecewiseFunction()
        function.AddPoint(0.0, 0.0)
        function.AddPoint(6.0, 1.0)
        scene.property.SetGradientOpacity(function)
        scene.property.ShadeOff()
        scene.look_along(2, 1)
        scene.mapper.SetSampleDistance(0.1)
        sample = 0.5 * (1.0 - 0.5 ** 0.1)
        expected = 255.0 * (1.0 - (1.0 - sample) ** 20)
        for reference, interpolation in itertools.product((0, 1), (0, 1)):
            scene.mapper.SetReferenceKernels(reference)
            scene.property.SetInterpolationType(interpolation)
            middle = scene.render()[SIZE // 2, SIZE // 2]
            self.assertLessEqual(np.abs(middle[3] - expected), 1.0, f"{middle}, {expected}")


if __name__ == "__main__":
    unittest.main()
