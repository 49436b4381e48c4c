# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The filters that deform, resample and look into a deformation, and functional transforms."""

import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersGeneral import vtkTransformFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkImageReslice, vtkImageShiftScale
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkLight,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)


def make_volume(n=20):
    k, j, i = np.mgrid[0:n, 0:n, 0:n].astype(float)
    values = 100.0 + 50.0 * np.sin(0.4 * i) * np.cos(0.3 * j) + k
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    return image


def make_lattice(image, strength=0.8):
    source = vtkffd.vtkFFDLatticeSource()
    source.SetBounds(image.GetBounds())
    source.SetDimensions(6, 6, 6)
    source.SetShapeToRandom()
    source.SetSeed(3)
    source.SetStrength(strength)
    return source.GetLattice()


def scalars(filter_):
    return vtk_to_numpy(filter_.GetOutput().GetPointData().GetScalars())


class TestVolumeFilters(unittest.TestCase):
    def setUp(self):
        self.image = make_volume()
        self.lattice = make_lattice(self.image)

    def test_resample_equals_reslice(self):
        reslice = vtkImageReslice()
        reslice.SetInputData(self.image)
        reslice.SetResliceTransform(self.lattice)
        reslice.SetInterpolationModeToLinear()
        reslice.BorderOff()
        reslice.Update()
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(self.image)
        resample.SetDeformation(self.lattice)
        resample.SetInverseModeToPullBack()
        resample.SetOutputExtent(self.image.GetExtent())
        resample.Update()
        np.testing.assert_allclose(scalars(resample), scalars(reslice), atol=1e-3)
        self.assertEqual(resample.GetInverseModeAsString(), "PULL_BACK")

    def test_resampled_at_rest_equals_the_input(self):
        rng = np.random.default_rng(5)
        values = rng.normal(size=(6, 6, 6)) * 10.0 ** rng.integers(0, 18, (6, 6, 6))
        values[3, 3, 4] = np.nan
        values[2, 4, 2] = np.inf
        image = vtkImageData()
        image.SetDimensions(6, 6, 6)
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(image)
        resample.Update()
        np.testing.assert_array_equal(scalars(resample), values.ravel())

    def test_resample_covers_the_deformed_volume(self):
        # The coordinate itself as scalar: the output holds the inverse.
        n = 20
        x = np.mgrid[0:n, 0:n, 0:n][2].astype(float)
        self.image.GetPointData().SetScalars(numpy_to_vtk(x.ravel(), deep=True))
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(self.image)
        resample.SetDeformation(self.lattice)
        resample.SetBackgroundLevel(-1000.0)
        resample.Update()
        output = resample.GetOutput()
        bounds = np.array(output.GetBounds())
        for p in ((0, 0, 0), (19, 0, 19), (19, 19, 19), (0, 10, 0)):
            q = np.array(self.lattice.TransformPoint(p))
            self.assertTrue(np.all(q >= bounds[::2]) and np.all(q <= bounds[1::2]))
        values = scalars(resample)
        inverse = self.lattice.GetInverse()
        inside = np.flatnonzero(values > -500.0)
        self.assertGreater(len(inside), 1000)
        for i in inside[::97]:
            self.assertAlmostEqual(values[i], inverse.TransformPoint(output.GetPoint(i))[0],
                                   delta=0.03)
        self.assertEqual(resample.GetNumberOfUnconvergedPoints(), 0)

    def test_keyframes_follow_the_time(self):
        rest = vtkffd.vtkFFDLattice()
        rest.DeepCopy(self.lattice)
        rest.Reset()
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(self.image)
        deform.AddKeyframe(0.0, rest)
        deform.AddKeyframe(2.0, self.lattice)
        deform.UpdateTimeStep(0.5)
        between = vtkffd.vtkFFDLattice()
        self.assertEqual(between.ReadFrom(deform.GetOutput()), 1)
        np.testing.assert_allclose(vtk_to_numpy(between.GetDisplacements()),
                                   0.25 * vtk_to_numpy(self.lattice.GetDisplacements()),
                                   atol=1e-12)
        self.assertEqual(deform.InterpolateKeyframes(2.0, between), 1)
        np.testing.assert_allclose(vtk_to_numpy(between.GetDisplacements()),
                                   vtk_to_numpy(self.lattice.GetDisplacements()), atol=1e-12)
        self.assertEqual(deform.GetKeyframeInterpolationAsString(), "LINEAR")

    def test_fold_free_limit(self):
        source = vtkffd.vtkFFDLatticeSource()
        source.SetDimensions(7, 7, 7)
        source.SetShapeToRandom()
        source.SetStrength(6.0)
        self.assertFalse(source.GetLattice().IsFoldFree())
        source.FoldFreeOn()
        self.assertGreaterEqual(source.GetLattice().GetMinimumJacobianBound(), 0.05)
        self.assertLess(source.GetFoldFreeFactor(), 1.0)

    def test_geometry_equals_transform_filter(self):
        sphere = vtkSphereSource()
        sphere.SetCenter(9.0, 10.0, 9.0)
        sphere.SetRadius(5.0)
        expected = vtkTransformFilter()
        expected.SetInputConnection(sphere.GetOutputPort())
        expected.SetTransform(self.lattice)
        expected.Update()
        moved = vtkffd.vtkFFDDeformGeometry()
        moved.SetInputConnection(sphere.GetOutputPort())
        moved.SetDeformation(self.lattice)
        moved.Update()
        for get in (lambda data: data.GetPoints().GetData(),
                    lambda data: data.GetPointData().GetNormals()):
            np.testing.assert_allclose(vtk_to_numpy(get(moved.GetOutput())),
                                       vtk_to_numpy(get(expected.GetOutput())), atol=1e-5)

    def test_geometry_without_points(self):
        errors = []

        def note(_caller, _event, text):
            errors.append(text)

        note.CallDataType = "string0"
        image = vtkImageData()
        image.SetDimensions(3, 3, 3)
        geometry = vtkffd.vtkFFDDeformGeometry()
        geometry.AddObserver("ErrorEvent", note)
        geometry.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        geometry.SetInputDataObject(image)
        geometry.Update()
        self.assertEqual(len(errors), 1, errors)
        self.assertIn("vtkImageData", errors[0])
        self.assertIn("vtkImageDataToPointSet", errors[0])

    def test_a_map_that_is_not_a_number_folds(self):
        matrix = vtkMatrix4x4()
        matrix.SetElement(1, 1, float("nan"))
        transform = vtkTransform()
        transform.SetMatrix(matrix)
        image = vtkImageData()
        image.SetDimensions(4, 3, 2)
        jacobian = vtkffd.vtkFFDJacobian()
        jacobian.SetInputData(image)
        jacobian.SetDeformation(transform)
        jacobian.Update()
        mask = vtk_to_numpy(jacobian.GetOutput().GetPointData().GetArray("FoldMask"))
        self.assertEqual(mask.tolist(), [1] * 24)
        self.assertEqual(jacobian.GetNumberOfFoldedPoints(), 24)

    def test_jacobian_of_known_maps(self):
        jacobian = vtkffd.vtkFFDJacobian()
        jacobian.SetInputData(self.image)
        twist = vtkffd.vtkFFDBarrTransform()
        twist.SetDeformationTypeToTwist()
        twist.FitToBounds(self.image.GetBounds())
        twist.SetAngle(80.0)
        jacobian.SetDeformation(twist)
        jacobian.Update()
        np.testing.assert_allclose(scalars(jacobian), 1.0, atol=1e-6)
        self.assertEqual(jacobian.GetNumberOfFoldedPoints(), 0)
        jacobian.SetDeformation(make_lattice(self.image, 6.0))
        jacobian.Update()
        determinant = scalars(jacobian)
        mask = vtk_to_numpy(jacobian.GetOutput().GetPointData().GetArray("FoldMask"))
        np.testing.assert_array_equal(mask, determinant <= 0.0)
        self.assertEqual(jacobian.GetNumberOfFoldedPoints(), mask.sum())
        self.assertGreater(mask.sum(), 0)

    def test_distance_map_equals_search(self):
        n = 20
        values = np.zeros((n, n, n), np.uint8)
        seeds = np.array([(3, 4, 5), (15, 2, 11)])
        for i, j, k in seeds:
            values[k, j, i] = 200
        self.image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(100.0, 0.0)
        opacity.AddPoint(200.0, 1.0)
        distance = vtkffd.vtkFFDDistanceMap()
        distance.SetInputData(self.image)
        distance.SetScalarOpacity(opacity)
        distance.SetResolutionToVoxels()
        distance.Update()
        k, j, i = np.mgrid[0:n, 0:n, 0:n]
        expected = np.min([np.maximum.reduce([abs(i - s[0]), abs(j - s[1]), abs(k - s[2])])
                           for s in seeds], axis=0)
        np.testing.assert_array_equal(scalars(distance).reshape(n, n, n), expected)
        distance.SetResolutionToBlocks()
        distance.Update()
        self.assertEqual(distance.GetOutput().GetDimensions(), (5, 5, 5))
        self.assertEqual(scalars(distance).min(), 0)

    def test_functional_transforms_and_their_inverses(self):
        deflector = vtkffd.vtkFFDRayDeflector()
        deflector.SetCenter(9.0, 9.0, 9.0)
        deflector.SetRadius(8.0)
        deflector.SetVector(2.0, 1.0, 0.0)
        self.assertTrue(deflector.IsFoldFree())
        np.testing.assert_allclose(deflector.TransformPoint(9.0, 9.0, 9.0), (11.0, 10.0, 9.0))
        bend = vtkffd.vtkFFDBarrTransform()
        bend.SetAxis(0)
        bend.SetRange(0.0, 2.0)
        bend.SetAngle(90.0)
        bend.SetBendAxis(2)
        radius = 4.0 / np.pi
        np.testing.assert_allclose(bend.TransformPoint(2.0, 0.0, 0.0), (radius, 0.0, radius),
                                   atol=1e-12)
        for transform in (deflector, bend):
            p = (1.5, 0.25, 0.5)
            back = transform.GetInverse().TransformPoint(transform.TransformPoint(p))
            np.testing.assert_allclose(back, p, atol=1e-12)

    def test_ray_tracer_follows_equation_3(self):
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(self.image)
        mapper.SetDeformation(self.lattice)
        mapper.SetInverseModeToFirstOrder()
        mapper.SetSegmentationToGreedyAngle()
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0.0, 0.0)
        opacity.AddPoint(200.0, 0.1)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 1.0, 1.0, 1.0)
        prop = vtkVolumeProperty()
        prop.SetScalarOpacity(opacity)
        prop.SetColor(color)
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        renderer.ResetCamera(self.image.GetBounds())

        def make_tracer():
            made = vtkffd.vtkFFDRayTracer()
            made.SetRenderer(renderer)
            made.SetVolume(volume)
            made.SetImageSize(60, 40)
            made.AddPixel(30, 20)
            made.AddPixel(25, 22)
            return made

        tracer = make_tracer()
        tracer.Update()
        rest = tracer.GetOutput(0)
        viewing = tracer.GetOutput(1)
        self.assertEqual(rest.GetNumberOfLines(), 2)
        np.testing.assert_array_equal(vtk_to_numpy(rest.GetCellData().GetArray("Pixel")),
                                      [[30, 20], [25, 22]])
        for i in range(rest.GetNumberOfPoints()):
            p = np.array(viewing.GetPoint(i))
            np.testing.assert_allclose(rest.GetPoint(i),
                                       2.0 * p - self.lattice.TransformPoint(p), atol=1e-9)
        # It follows what leads to the volume, and the lights.
        prop.ShadeOn()

        def colors(item):
            item.Update()
            return vtk_to_numpy(item.GetOutput(0).GetCellData().GetArray("Color")).tolist()

        light = vtkLight()
        shift = vtkImageShiftScale()
        shift.SetInputData(self.image)
        mapper.SetInputConnection(shift.GetOutputPort())
        for change in (lambda: shift.SetScale(0.5), lambda: renderer.AddLight(light),
                       lambda: light.SetPosition(300, 200, 100), lambda: light.SetColor(1, 0, 0),
                       lambda: self.image.GetPointData().GetScalars().Fill(90.0),
                       lambda: renderer.RemoveLight(light)):
            change()
            self.image.Modified()
            before = colors(tracer)
            self.assertEqual(before, colors(make_tracer()))
        samples = vtk_to_numpy(rest.GetCellData().GetArray("Samples"))
        leaps = vtk_to_numpy(tracer.GetOutput(2).GetPointData().GetArray("Leap"))
        self.assertEqual(samples.sum(), (leaps == 0).sum())
        self.assertGreater(samples.sum(), 10)


if __name__ == "__main__":
    unittest.main()
