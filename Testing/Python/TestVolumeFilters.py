# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The filters that deform, resample and look into a deformation, and functional transforms."""

import time
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkMultiBlockDataSet, vtkPiecewiseFunction
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkCommonExecutionModel import (
    vtkAlgorithm,
    vtkStreamingDemandDrivenPipeline,
    vtkTrivialProducer,
)
from vtkmodules.vtkCommonTransforms import vtkLandmarkTransform, vtkTransform
from vtkmodules.vtkFiltersCore import vtkPassThrough
from vtkmodules.vtkFiltersGeneral import vtkTransformFilter
from vtkmodules.vtkFiltersHybrid import vtkGridTransform
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkImageReslice, vtkImageShiftScale
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkLight,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)


# Control points that are moved with their neighbors, and by how much.
FOLDING_EDITS = (((1, 3, 2), (-1.423, -0.2289, -0.4154)),
                 ((2, 2, 2), (0.6266, -1.0873, 0.8217)))


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


def vtkffd_errors(to):
    """Observer of errors that appends their texts."""
    def note(_, event, text):
        to.append(text)
    note.CallDataType = "string0"
    return note


def scalars(filter_):
    return vtk_to_numpy(filter_.GetOutputDataObject(0).GetPointData().GetScalars())


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

    def test_faces_that_stay_keep_their_voxels(self):
        """Of a volume that is deformed inside only, by a lattice or by a field that one stands for."""
        values = vtk_to_numpy(self.image.GetPointData().GetScalars())
        moved = np.zeros((9, 9, 9, 3))
        moved[3:-3, 3:-3, 3:-3] = np.random.default_rng(1).normal(size=(3, 3, 3, 3))
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(9, 9, 9)
        lattice.FitToBounds(self.image.GetBounds())
        lattice.SetDisplacements(numpy_to_vtk(moved.reshape(-1, 3), deep=True))
        field = vtkImageData()
        field.SetDimensions(9, 9, 9)
        field.SetSpacing(*[19.0 / 8.0] * 3)
        field.GetPointData().SetScalars(numpy_to_vtk(moved.reshape(-1, 3), deep=True))
        warp = vtkGridTransform()
        warp.SetDisplacementGridData(field)
        warp.SetInterpolationModeToCubic()
        for deformation in (lattice, warp):
            for mode in range(3):
                with self.subTest(deformation=deformation.GetClassName(), mode=mode):
                    resample = vtkffd.vtkFFDResampleVolume()
                    resample.SetInputData(self.image)
                    resample.SetDeformation(deformation)
                    resample.SetInverseMode(mode)
                    resample.SetBackgroundLevel(-1000.0)
                    resample.SetOutputExtent(self.image.GetExtent())
                    resample.Update()
                    self.assertEqual(np.count_nonzero(scalars(resample) == -1000.0), 0)
                    faces = np.ones((20, 20, 20), dtype=bool)
                    faces[1:-1, 1:-1, 1:-1] = False
                    np.testing.assert_allclose(scalars(resample)[faces.ravel()],
                                               values[faces.ravel()], atol=3.0)

    def test_bounds_of_dense_lattices_are_found_once(self):
        """They take longer than the voxels: an update that needs no new ones is a short one."""
        size = 44
        moved = np.random.default_rng(1).normal(size=(size ** 3, 3)) * 0.05
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(size, size, size)
        lattice.FitToBounds(self.image.GetBounds())
        lattice.SetDisplacements(numpy_to_vtk(moved, deep=True))
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(self.image)
        resample.SetDeformation(lattice)
        times = []
        for background in range(6):
            resample.SetBackgroundLevel(background)
            # Of the processor: other work on the machine must not fail the test.
            start = time.process_time()
            resample.Update()
            times.append(time.process_time() - start)
        print("seconds:", np.round(times, 3))
        self.assertLess(min(times[1:]), 0.4 * times[0])

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

    def test_geometry_by_the_inverse_of_an_affine_fit(self):
        # VTK's inverse of it is another fit.
        rng = np.random.default_rng(5)
        landmarks = [vtkPoints(), vtkPoints()]
        for x in rng.uniform(0.0, 100.0, (8, 3)):
            landmarks[0].InsertNextPoint(x)
            landmarks[1].InsertNextPoint(1.1 * x + rng.uniform(-15.0, 15.0, 3))
        fit = vtkLandmarkTransform()
        fit.SetModeToAffine()
        fit.SetSourceLandmarks(landmarks[0])
        fit.SetTargetLandmarks(landmarks[1])
        sphere = vtkSphereSource()
        sphere.SetCenter(50.0, 40.0, 60.0)
        sphere.SetRadius(20.0)
        sphere.Update()
        deform = vtkffd.vtkFFDDeformGeometry()
        deform.SetInputData(sphere.GetOutput())
        deform.SetDeformation(fit)
        deform.SetInverseModeToPullBack()
        deform.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
        deform.Update()
        for i in range(0, sphere.GetOutput().GetNumberOfPoints(), 7):
            np.testing.assert_allclose(fit.TransformPoint(deform.GetOutput().GetPoint(i)),
                                       sphere.GetOutput().GetPoint(i), atol=1e-4)

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

    def test_distance_map_of_a_turned_image(self):
        self.image.SetOrigin(5.0, -3.0, 2.0)
        self.image.SetSpacing(1.0, 2.0, 0.5)
        self.image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
        distances = vtkffd.vtkFFDDistanceMap()
        distances.SetInputData(self.image)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(150.0, 0.0)
        opacity.AddPoint(160.0, 1.0)
        distances.SetScalarOpacity(opacity)
        distances.SetResolutionToBlocks()
        distances.Update()
        output = distances.GetOutput()
        expected = [0.0, 0.0, 0.0]
        for index in ((0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 2, 3)):
            # Blocks of four cells each.
            self.image.TransformContinuousIndexToPhysicalPoint([4 * i + 2 for i in index], expected)
            point = output.GetPoint(output.ComputePointId(index))
            np.testing.assert_allclose(point, expected, atol=1e-9)

    def test_direction_behind_filters_that_drop_it(self):
        """VTK's filters do not announce the direction of what they pass through."""
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(150.0, 0.0)
        opacity.AddPoint(160.0, 1.0)
        rest = vtkffd.vtkFFDLattice()
        rest.FitToBounds(self.image.GetBounds())
        source = vtkTrivialProducer()
        source.SetOutput(self.image)
        through = vtkPassThrough()
        through.SetInputConnection(source.GetOutputPort())
        sixty = (0.5, -0.75 ** 0.5, 0, 0.75 ** 0.5, 0.5, 0, 0, 0, 1)
        for direction in ((-1, 0, 0, 0, -1, 0, 0, 0, 1), sixty, (0, 1, 0, 0, 0, 1, 1, 0, 0)):
            self.image.SetOrigin(5.0, -3.0, 2.0)
            self.image.SetDirectionMatrix(*direction)
            lattice = make_lattice(self.image)
            attach = vtkffd.vtkFFDDeformVolume()
            attach.SetLattice(lattice)
            edit = vtkffd.vtkFFDEditLattice()
            edit.SetDimensions(4, 4, 4)
            results = []
            for producer in (source, through):
                for filter_ in (attach, edit):
                    filter_.SetInputConnection(producer.GetOutputPort())
                pipelines = []
                for deformation, before in ((rest, producer), (lattice, producer), (None, attach),
                                            (None, edit), (lattice, edit)):
                    resample = vtkffd.vtkFFDResampleVolume()
                    resample.SetInputConnection(before.GetOutputPort())
                    resample.SetDeformation(deformation)
                    resample.SetBackgroundLevel(-1000.0)
                    pipelines.append(resample)
                for resolution in (vtkffd.vtkFFDDistanceMap.VOXELS, vtkffd.vtkFFDDistanceMap.BLOCKS):
                    distances = vtkffd.vtkFFDDistanceMap()
                    distances.SetInputConnection(producer.GetOutputPort())
                    distances.SetScalarOpacity(opacity)
                    distances.SetResolution(resolution)
                    pipelines.append(distances)
                jacobian = vtkffd.vtkFFDJacobian()
                jacobian.SetInputConnection(producer.GetOutputPort())
                jacobian.SetDeformation(lattice)
                pipelines += [jacobian, edit]
                for filter_ in pipelines:
                    filter_.Update()
                results.append([filter_.GetOutput() for filter_ in pipelines])
                # Without deformation the output is the input.
                np.testing.assert_array_equal(scalars(pipelines[0]), scalars(source))
                # A part has the values of the whole.
                whole = results[-1][1]
                extent = whole.GetExtent()
                middle = (extent[4] + extent[5]) // 2
                values = vtk_to_numpy(whole.GetPointData().GetScalars()).reshape(
                    whole.GetDimensions()[::-1])[middle - extent[4]].copy()
                whole = vtkImageData()
                whole.DeepCopy(pipelines[1].GetOutput())
                results[-1][1] = whole
                pipelines[1].Modified()
                pipelines[1].UpdateExtent((*extent[:4], middle, middle))
                np.testing.assert_array_equal(
                    vtk_to_numpy(pipelines[1].GetOutput().GetPointData().GetScalars()), values.ravel())
                # What our filters pass on they announce.
                for filter_ in (attach, edit, jacobian, pipelines[5], pipelines[6]):
                    self.assertEqual(
                        bool(filter_.GetOutputInformation(0).Has(vtkImageData.DIRECTION())),
                        producer is source, filter_.GetClassName())
            for known, dropped in zip(*results):
                self.assertEqual(known.GetExtent(), dropped.GetExtent())
                np.testing.assert_array_equal(known.GetBounds(), dropped.GetBounds())
                np.testing.assert_array_equal(
                    vtk_to_numpy(known.GetPointData().GetScalars()),
                    vtk_to_numpy(dropped.GetPointData().GetScalars()))
                for i in range(9):
                    self.assertEqual(dropped.GetDirectionMatrix().GetElement(i // 3, i % 3),
                                     self.image.GetDirectionMatrix().GetElement(i // 3, i % 3))
            attached = [vtkffd.vtkFFDLattice(), vtkffd.vtkFFDLattice()]
            for i in range(2):
                self.assertEqual(attached[i].ReadFrom(results[i][-1]), 1)
                np.testing.assert_allclose(attached[i].GetDomain(), self.image.GetBounds(), atol=1e-9)

    def test_direction_takes_few_voxels(self):
        """That of an image that is not announced is asked for with as few of them as possible."""
        asked = []

        class Source(VTKPythonAlgorithmBase):
            def __init__(self):
                super().__init__(nInputPorts=0, outputType="vtkImageData")

            def RequestInformation(self, request, inputs, outputs):
                info = outputs.GetInformationObject(0)
                info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), (0, 19) * 3, 6)
                info.Set(vtkAlgorithm.CAN_PRODUCE_SUB_EXTENT(), 1)
                return 1

            def RequestData(self, request, inputs, outputs):
                info = outputs.GetInformationObject(0)
                extent = info.Get(vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT())
                asked.append(extent)
                image = vtkImageData.GetData(outputs)
                image.SetExtent(extent)
                image.SetDirectionMatrix(-1, 0, 0, 0, 1, 0, 0, 0, -1)
                values = np.arange(image.GetNumberOfPoints(), dtype=float)
                image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
                return 1

        source = Source()
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputConnection(source.GetOutputPort())
        rest = vtkffd.vtkFFDLattice()
        rest.FitToBounds((-19, 0, 0, 19, -19, 0))
        resample.SetDeformation(rest)
        resample.UpdateInformation()
        self.assertEqual(asked, [(0, 1) * 3])
        resample.Update()
        self.assertEqual(asked[1:], [(0, 19) * 3])
        self.assertEqual(resample.GetOutput().GetBounds(), (-19.0, 0.0, 0.0, 19.0, -19.0, 0.0))
        np.testing.assert_array_equal(scalars(resample), np.arange(8000.0))
        resample.SetInverseModeToPullBack()
        resample.Update()
        self.assertEqual(len(asked), 2)

    def test_distance_map_beside_extremes(self):
        # A value that stands for no data is far from all others; what is visible stays the same.
        values = np.zeros((16, 16, 16))
        values[4:12, 4:12, 4:12] = 50.0
        opacity = vtkPiecewiseFunction()
        for value, alpha in ((40.0, 0.0), (50.0, 1.0), (60.0, 0.0)):
            opacity.AddPoint(value, alpha)
        image = vtkImageData()
        image.SetDimensions(16, 16, 16)
        for dtype in (np.float32, np.float64):
            for extreme in (0.0, 1e6, 1e8, -1e9, 1e20, -1e30):
                values[0, 0, 0] = extreme
                image.GetPointData().SetScalars(numpy_to_vtk(values.astype(dtype).ravel(),
                                                             deep=True))
                image.Modified()
                distances = vtkffd.vtkFFDDistanceMap()
                distances.SetInputData(image)
                distances.SetScalarOpacity(opacity)
                distances.SetResolutionToVoxels()
                distances.Update()
                self.assertEqual((scalars(distances) == 0).sum(), 512, (dtype, extreme))
                # Extremes of blocks are rounded outwards.
                distances.SetResolutionToBlocks()
                distances.Update()
                blocks = scalars(distances).reshape(4, 4, 4)
                self.assertTrue((blocks[:3, :3, :3] == 0).all(), (dtype, extreme))
                self.assertTrue(extreme < 0.0 or (blocks == 0).sum() == 27, (dtype, extreme))

    def test_jacobian_keeps_the_scalars(self):
        self.image.GetPointData().GetScalars().SetName("density")
        jacobian = vtkffd.vtkFFDJacobian()
        jacobian.SetInputData(self.image)
        jacobian.SetDeformation(self.lattice)
        jacobian.Update()
        arrays = jacobian.GetOutput().GetPointData()
        self.assertEqual(arrays.GetScalars().GetName(), "JacobianDeterminant")
        self.assertEqual(arrays.GetNumberOfArrays(), 3)
        np.testing.assert_array_equal(vtk_to_numpy(arrays.GetArray("density")),
                                      vtk_to_numpy(self.image.GetPointData().GetScalars()))

    def test_blocks_with_lattices(self):
        # The blocks come from filters, which must not be brought up to date among them.
        blocks = vtkMultiBlockDataSet()
        for i, size in enumerate((12, 15)):
            image = make_volume(size)
            image.SetOrigin(30.0 * i, 0.0, 0.0)
            blocks.SetBlock(i, image)
        edit = vtkffd.vtkFFDEditLattice()
        edit.SetInputDataObject(blocks)
        edit.SetDimensions(4, 4, 4)
        edit.LatticePerBlockOn()
        edit.SetNumberOfDisplacements(64)
        edit.SetDisplacement(21, 2.0, 0.0, 0.0)
        attach = vtkffd.vtkFFDDeformVolume()
        attach.SetInputDataObject(blocks)
        attach.SetLattice(self.lattice)
        for source in (edit, attach):
            through = vtkPassThrough()
            through.SetInputConnection(source.GetOutputPort())
            for producer in (source, through):
                resample = vtkffd.vtkFFDResampleVolume()
                resample.SetInputConnection(producer.GetOutputPort())
                for _ in range(2):
                    resample.Update()
                    output = resample.GetOutputDataObject(0)
                    self.assertEqual(output.GetNumberOfBlocks(), 2)
                    for i in range(2):
                        alone = vtkffd.vtkFFDResampleVolume()
                        alone.SetInputData(source.GetOutputDataObject(0).GetBlock(i))
                        alone.Update()
                        np.testing.assert_array_equal(
                            vtk_to_numpy(output.GetBlock(i).GetPointData().GetScalars()),
                            scalars(alone))
                    source.Modified()

    def test_arrays_that_do_not_exist_are_named(self):
        for filter_ in (vtkffd.vtkFFDResampleVolume(), vtkffd.vtkFFDDistanceMap()):
            filter_.SetInputData(self.image)
            if filter_.IsA("vtkFFDDistanceMap"):
                opacity = vtkPiecewiseFunction()
                opacity.AddPoint(0.0, 1.0)
                filter_.SetScalarOpacity(opacity)
            else:
                filter_.SetDeformation(self.lattice)
            filter_.SetInputArrayToProcess(0, 0, 0, 0, "nope")
            errors = []
            filter_.AddObserver("ErrorEvent", vtkffd_errors(errors))
            filter_.Update()
            self.assertIn('"nope"', errors[0])

    def test_folds_outside_of_the_volume_lose_nothing(self):
        # Two edits with the fold guard: proven not to fold in the volume, but beyond it.
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(5, 5, 5)
        representation = vtkffd.vtkFFDLatticeRepresentation()
        representation.SetLattice(lattice)
        representation.SetFoldGuard(1)
        for point, move in FOLDING_EDITS:
            representation.SelectPoint(*point)
            representation.GrowSelection()
            representation.TranslateSelection(*move)
        self.assertTrue(lattice.IsFoldFree())
        n = 20
        image = vtkImageData()
        image.SetDimensions(n, n, n)
        image.SetSpacing(3 * [1.0 / (n - 1)])
        image.GetPointData().SetScalars(numpy_to_vtk(np.full(n**3, 100.0), deep=True))
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetDeformation(lattice)
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(image)
        resample.SetDeformation(lattice)
        resample.SetOutputSpacing(3 * [1e-6])
        resample.SetOutputExtent(0, 1, 0, 1, 0, 1)
        rest = [0.0, 0.0, 0.0]
        for x in np.random.default_rng(1).uniform(0.02, 0.98, (1500, 3)):
            y = lattice.TransformPoint(*x)
            self.assertEqual(mapper.GetRestPosition(y, rest), 1)
            np.testing.assert_allclose(rest, x, atol=1e-5)
            resample.SetOutputOrigin(y)
            resample.Update()
            self.assertEqual(scalars(resample).min(), 100.0, f"{x} at {y}")

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

    def test_transforms_that_turn_far(self):
        """What lies beyond where a pull-back leads into the volume does not show it once more."""
        half = 10
        image = make_volume(2 * half + 1)
        image.SetOrigin(-half, -half, -half)
        prop = vtkVolumeProperty()
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(40, 0.05)
        opacity.AddPoint(170, 0.3)
        prop.SetScalarOpacity(opacity)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(40, 1.0, 0.4, 0.0)
        color.AddRGBPoint(170, 0.0, 0.6, 1.0)
        prop.SetColor(color)
        prop.SetInterpolationTypeToLinear()
        for name, angle, scale in (("half a turn", 180, (1, 1, 1)), ("turn", 120, (1, 1, 1)),
                                   ("mirror", 0, (-1, 1, 1)), ("flip", 180, (2, 1, 1))):
            with self.subTest(transform=name):
                transform = vtkTransform()
                transform.Translate(3, 2, -1)
                transform.RotateZ(angle)
                transform.Scale(scale)
                self.check_turned(image, prop, transform)

    def check_turned(self, image, prop, transform):
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetDeformation(transform)
        mapper.SetInverseModeToPullBack()
        plain = vtkffd.vtkFFDInverseRayVolumeMapper()
        inverse = vtkMatrix4x4()
        vtkMatrix4x4.Invert(transform.GetMatrix(), inverse)
        pictures = []
        volumes = []
        for each, matrix in ((plain, inverse), (mapper, vtkMatrix4x4())):
            each.SetInputData(image)
            volume = vtkVolume()
            volume.SetMapper(each)
            volume.SetProperty(prop)
            volume.SetUserMatrix(matrix)
            renderer = vtkRenderer()
            renderer.AddVolume(volume)
            renderer.ResetCamera(-40, 40, -40, 40, -40, 40)
            picture = vtkImageData()
            self.assertEqual(each.RenderToImage(renderer, volume, 80, 80, picture), 1)
            pictures.append(vtk_to_numpy(picture.GetPointData().GetScalars()).astype(float))
            volumes.append(volume)
        self.assertGreater(pictures[0][:, 3].max(), 50.0)
        self.assertLess(np.abs(pictures[0] - pictures[1]).mean(), 0.3)
        wanted = np.array(volumes[0].GetBounds())
        size = (wanted[1::2] - wanted[::2]).repeat(2)
        self.assertTrue(np.all(np.abs(volumes[1].GetBounds() - wanted) < 0.15 * size))

        filtered = vtkffd.vtkFFDResampleVolume()
        filtered.SetInputData(image)
        filtered.SetDeformation(transform)
        filtered.SetInverseModeToPullBack()
        filtered.SetBackgroundLevel(-1000.0)
        filtered.SetOutputExtent(-60, 80, -60, 80, -20, 40)
        filtered.Update()
        resampled = filtered.GetOutput()
        found = vtk_to_numpy(resampled.GetPointData().GetScalars()) > -999.0
        k, j, i = np.unravel_index(np.flatnonzero(found), resampled.GetDimensions()[::-1])
        places = np.stack([i - 60, j - 60, k - 20], axis=1) + np.array(image.GetOrigin())
        self.assertGreater(len(places), 100)
        for place in places[::97]:
            self.assertLess(np.abs(transform.TransformPoint(*place)).max(), 10.1)
        rest = [0.0] * 3
        for place in ((60.0, 60.0, 0.0), (-70.0, 3.0, 50.0), (2.0, 1.0, 0.0)):
            self.assertEqual(mapper.GetRestPosition(place, rest), 1)
            self.assertLess(np.abs(np.subtract(rest, transform.TransformPoint(place))).max(), 0.1)

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
