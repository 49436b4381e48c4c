# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDFitLattice: landmarks, fields and transforms, its options and its errors."""

import os
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform, vtkTransform
from vtkmodules.vtkImagingCore import vtkImageShiftScale
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

BOUNDS = (0.0, 40.0, -10.0, 20.0, 5.0, 25.0)
RNG = np.random.default_rng(4)


def points_of(array):
    points = vtkPoints()
    points.SetDataTypeToDouble()
    for p in array:
        points.InsertNextPoint(p)
    return points


def random_points(count):
    return RNG.uniform(BOUNDS[::2], BOUNDS[1::2], (count, 3))


def bend(p):
    return p + np.stack([2.0 * np.sin(0.1 * p[:, 1]), 0.02 * p[:, 0] ** 2 * 0.5,
                         np.cos(0.12 * p[:, 0] + 0.1 * p[:, 2])], axis=1)


def apply(transform, points):
    return np.array([transform.TransformPoint(p) for p in points])


def make_field(function, noise=0.0, count=(21, 19, 17)):
    image = vtkImageData()
    image.SetExtent(2, count[0] + 1, -3, count[1] - 4, 0, count[2] - 1)
    spacing = [(BOUNDS[2 * a + 1] - BOUNDS[2 * a]) / (count[a] - 1) for a in range(3)]
    image.SetSpacing(spacing)
    image.SetOrigin(BOUNDS[0] - 2 * spacing[0], BOUNDS[2] + 3 * spacing[1], BOUNDS[4])
    nodes = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
    values = function(nodes) - nodes + noise * RNG.standard_normal(nodes.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(values.astype(np.float32), deep=True))
    return image


class Log:
    CallDataType = "string0"

    def __init__(self, item, event="ErrorEvent"):
        self.messages = []
        item.AddObserver(event, self)

    def __call__(self, _caller, _event, message):
        self.messages.append(message)


class TestFitLattice(unittest.TestCase):
    def setUp(self):
        self.fit = vtkffd.vtkFFDFitLattice()
        self.errors = Log(self.fit)
        self.warnings = Log(self.fit, "WarningEvent")

    def test_landmarks(self):
        source = random_points(80)
        self.fit.SetSourceLandmarks(points_of(source))
        self.fit.SetTargetLandmarks(points_of(bend(source)))
        self.fit.SetTolerance(0.05)
        lattice = self.fit.GetLattice()
        self.assertEqual(self.errors.messages + self.warnings.messages, [])
        error = np.linalg.norm(apply(lattice, source) - bend(source), axis=1)
        self.assertAlmostEqual(error.max(), self.fit.GetMaximumError(), 9)
        self.assertLessEqual(error.max(), 0.05)
        self.assertAlmostEqual(np.sqrt(np.mean(error ** 2)), self.fit.GetRootMeanSquareError(), 9)
        # The default bounds hold all landmarks, in place and moved.
        domain = np.array(lattice.GetDomain())
        both = np.concatenate([source, bend(source)])
        self.assertTrue((domain[::2] < both.min(axis=0)).all())
        self.assertTrue((domain[1::2] > both.max(axis=0)).all())
        # Between landmarks, too, and not worse than twice a thin plate through them.
        plate = vtkThinPlateSplineTransform()
        plate.SetSourceLandmarks(self.fit.GetSourceLandmarks())
        plate.SetTargetLandmarks(self.fit.GetTargetLandmarks())
        plate.SetBasisToR()
        inner = random_points(300) * 0.7 + np.array([6.0, 1.5, 4.5])
        ours = np.linalg.norm(apply(lattice, inner) - bend(inner), axis=1).mean()
        theirs = np.linalg.norm(apply(plate, inner) - bend(inner), axis=1).mean()
        self.assertLess(ours, 2.0 * theirs)

    def test_contradictions_are_averaged_and_errors_are_true(self):
        source = random_points(20)
        off = RNG.normal(0.0, 3.0, source.shape)
        self.fit.SetSourceLandmarks(points_of(np.concatenate([source, source])))
        self.fit.SetTargetLandmarks(points_of(np.concatenate([source + off, source - off])))
        possible = np.sqrt(np.mean(np.sum(off ** 2, axis=1)))
        last = np.inf
        for smoothness, cells in ((1e-6, 1), (1e-6, 8), (0.0, 1), (0.0, 8)):
            self.fit.SetSmoothness(smoothness)
            self.fit.SetMaximumCells(cells)
            lattice = self.fit.GetLattice()
            error = np.concatenate([apply(lattice, source) - source - off,
                                    apply(lattice, source) - source + off])
            error = np.linalg.norm(error, axis=1)
            rms = np.sqrt(np.mean(error ** 2))
            self.assertAlmostEqual(rms, self.fit.GetRootMeanSquareError(), 9)
            self.assertAlmostEqual(error.max(), self.fit.GetMaximumError(), 9)
            self.assertLess(rms, 1.5 * possible if cells == 1 else 1.01 * possible)
            self.assertLessEqual(rms, np.inf if cells == 1 else last)
            last = rms

    def test_errors_of_landmarks_out_of_the_bounds_are_true(self):
        source = random_points(60)
        self.fit.SetSourceLandmarks(points_of(source))
        self.fit.SetTargetLandmarks(points_of(bend(source)))
        self.fit.SetBounds(10, 30, -5, 15, 10, 20)
        self.fit.SetMaximumCells(4)
        lattice = self.fit.GetLattice()
        error = np.linalg.norm(apply(lattice, source) - bend(source), axis=1)
        self.assertAlmostEqual(error.max(), self.fit.GetMaximumError(), 9)

    def test_edited_landmarks_are_fitted_again(self):
        source = points_of(random_points(6))
        target = vtkPoints()
        target.DeepCopy(source)
        self.fit.SetSourceLandmarks(source)
        self.fit.SetTargetLandmarks(target)
        self.assertTrue(np.allclose(apply(self.fit.GetLattice(), [[1, 2, 8]]), [[1, 2, 8]]))
        for i in range(6):
            target.SetPoint(i, np.array(target.GetPoint(i)) + (1, 0, 0))
        target.Modified()
        self.assertTrue(np.allclose(apply(self.fit.GetLattice(), [[1, 2, 8]]), [[2, 2, 8]]))

    def test_weights_and_smoothness(self):
        source = random_points(50)
        target = bend(source)
        target[3] += 5.0  # an outlier
        self.fit.SetSourceLandmarks(points_of(source))
        self.fit.SetTargetLandmarks(points_of(target))
        self.fit.SetMaximumCells(2)
        self.fit.SetSmoothness(1e-3)

        def error_of_outlier():
            return np.linalg.norm(apply(self.fit.GetLattice(), source[3:4]) - target[3:4])

        plain = error_of_outlier()
        weights = vtkDoubleArray()
        for i in range(50):
            weights.InsertNextValue(1e4 if i == 3 else 1.0)
        self.fit.SetLandmarkWeights(weights)
        self.assertLess(error_of_outlier(), 0.2 * plain)
        self.fit.SetLandmarkWeights(None)
        self.fit.SetSmoothness(0.0)
        loose = self.fit.GetLattice() and self.fit.GetRootMeanSquareError()
        self.fit.SetSmoothness(1.0)
        self.assertGreater(self.fit.GetLattice() and self.fit.GetRootMeanSquareError(), loose)
        self.assertIn("instead of the Tolerance", self.warnings.messages[0])

    def test_field(self):
        self.fit.SetInputData(make_field(bend))
        self.fit.SetTolerance(0.01)
        lattice = self.fit.GetLattice()
        self.assertEqual(self.errors.messages + self.warnings.messages, [])
        np.testing.assert_allclose(lattice.GetDomain(), BOUNDS, atol=1e-5)
        points = random_points(200)
        self.assertLess(np.abs(apply(lattice, points) - bend(points)).max(), 0.03)
        coarse = lattice.GetDimensions()
        self.fit.SetTolerance(1e-3)
        self.assertGreater(self.fit.GetLattice().GetDimensions(), coarse)
        self.fit.SetMaximumCells(4)
        self.assertEqual(self.fit.GetLattice().GetDimensions(), (7, 7, 7))
        self.assertEqual(len(self.warnings.messages), 1)

    def test_noise_of_a_field_is_averaged(self):
        self.fit.SetInputData(make_field(bend, 0.5))
        self.fit.SetMaximumCells(4)
        points = random_points(200)
        error = apply(self.fit.GetLattice(), points) - bend(points)
        self.assertLess(np.sqrt(np.mean(error ** 2)), 0.15)
        self.assertAlmostEqual(self.fit.GetRootMeanSquareError(), 0.5 * np.sqrt(3.0), 1)

    def test_transform_as_the_mapper_does(self):
        linear = vtkTransform()
        linear.RotateZ(20.0)
        self.fit.SetTransform(linear)
        self.fit.SetBounds(BOUNDS)
        points = random_points(50)
        np.testing.assert_allclose(apply(self.fit.GetLattice(), points), apply(linear, points),
                                   atol=1e-10)
        linear.RotateX(20.0)
        np.testing.assert_allclose(apply(self.fit.GetLattice(), points), apply(linear, points),
                                   atol=1e-10)
        source = random_points(20)
        plate = vtkThinPlateSplineTransform()
        plate.SetSourceLandmarks(points_of(source))
        plate.SetTargetLandmarks(points_of(bend(source)))
        plate.SetBasisToR()
        self.fit.SetTransform(plate)
        self.fit.SetTolerance(0.05)
        other = vtkffd.vtkFFDLattice()
        error = other.FitToTransform(plate, BOUNDS, 0.05, 64)
        self.assertEqual(error, self.fit.GetLattice() and self.fit.GetMaximumError())
        self.assertEqual(other.GetDimensions(), self.fit.GetLattice().GetDimensions())
        np.testing.assert_array_equal(apply(other, points), apply(self.fit.GetLattice(), points))
        self.fit.SetTransform(plate.GetInverse())
        images = apply(plate, points)
        within = ((images > BOUNDS[::2]) & (images < BOUNDS[1::2])).all(axis=1)
        self.assertGreater(within.sum(), 5)
        moved = apply(self.fit.GetLattice(), images[within][:5])
        np.testing.assert_allclose(moved, points[within][:5], atol=0.3)

    def test_in_a_pipeline_and_a_file(self):
        shift = vtkImageShiftScale()
        shift.SetInputData(make_field(bend))
        shift.SetScale(2.0)
        shift.SetOutputScalarTypeToDouble()
        self.fit.SetInputConnection(shift.GetOutputPort())
        path = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "fitted.vti")
        writer = vtkXMLImageDataWriter()
        writer.SetInputConnection(self.fit.GetOutputPort())
        writer.SetFileName(path)
        writer.Write()
        reader = vtkXMLImageDataReader()
        reader.SetFileName(path)
        reader.Update()
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.FromImageData(reader.GetOutput()), 1)
        self.assertEqual(lattice.GetDimensions(), self.fit.GetLattice().GetDimensions())
        points = random_points(20)
        expected = points + 2.0 * (bend(points) - points)
        self.assertLess(np.abs(apply(lattice, points) - expected).max(), 0.2)
        shift.SetScale(1.0)
        self.assertLess(np.abs(apply(self.fit.GetLattice(), points) - bend(points)).max(), 0.2)

    def test_progress_and_abort(self):
        self.fit.SetInputData(make_field(bend))
        progress = []
        self.fit.AddObserver("ProgressEvent", lambda *_: progress.append(self.fit.GetProgress()))
        self.assertIsNotNone(self.fit.GetLattice())
        self.assertGreater(len(progress), 2)
        self.fit.AddObserver("ProgressEvent", lambda *_: self.fit.SetAbortExecute(1))
        self.fit.SetTolerance(1e-3)
        self.assertIsNone(self.fit.GetLattice())
        self.assertIn("aborted", self.warnings.messages[0])
        self.assertEqual(self.fit.GetOutput().GetNumberOfPoints(), 0)
        self.fit.Update()
        self.assertEqual(self.fit.GetOutput().GetNumberOfPoints(), 0)
        # The next fit is made.
        self.fit.RemoveObservers("ProgressEvent")
        self.fit.Modified()
        self.assertIsNotNone(self.fit.GetLattice())
        self.assertGreater(self.fit.GetOutput().GetNumberOfPoints(), 0)

    def test_abort_once(self):
        """The output is empty until something changes, though the pipeline asks for information again."""
        self.fit.SetInputData(make_field(bend))
        self.fit.SetTolerance(1e-3)
        calls = []

        def abort(*_):
            calls.append(1)
            if len(calls) == 1:
                self.fit.SetAbortExecute(1)

        self.fit.AddObserver("ProgressEvent", abort)
        for _ in range(2):
            self.fit.Update()
            self.assertEqual(self.fit.GetOutput().GetNumberOfPoints(), 0)
            self.assertEqual(len(self.warnings.messages), 1)
        self.fit.Modified()
        self.fit.Update()
        self.assertGreater(self.fit.GetOutput().GetNumberOfPoints(), 0)

    def test_observers_that_take_the_transform(self):
        """The last reference to it may go while it is fitted."""
        transform = vtkffd.vtkFFDLattice()
        transform.SetDimensions(5, 5, 5)
        transform.FitToBounds(BOUNDS)
        transform.SetControlPoint(2, 2, 2, 15.0, 3.0, 12.0)
        expected = transform.TransformPoint(20.0, 5.0, 15.0)
        self.fit.SetTransform(transform)
        self.fit.SetBounds(BOUNDS)
        self.fit.SetTolerance(0.01)
        del transform
        self.fit.AddObserver("ProgressEvent", lambda *_: self.fit.SetTransform(None))
        self.fit.Update()
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.FromImageData(self.fit.GetOutput()), 1)
        np.testing.assert_allclose(lattice.TransformPoint(20.0, 5.0, 15.0), expected, atol=0.02)

    def test_flat_fields(self):
        for origin, bounds in ((0.0, None), (-1.5, (0, 8, 0, 8, -3.0, 1.0)), (2.7, (0, 8, 0, 8, 1, 5))):
            with self.subTest(origin=origin):
                image = vtkImageData()
                image.SetDimensions(9, 9, 1)
                image.SetOrigin(0.0, 0.0, origin)
                image.GetPointData().SetScalars(
                    numpy_to_vtk(np.tile((1.0, 0.0, -2.0), (81, 1)), deep=True))
                self.fit.SetInputData(image)
                self.fit.SetBounds(*(bounds or (1, -1) * 3))
                lattice = self.fit.GetLattice()
                self.assertIsNotNone(lattice, self.errors.messages)
                values = vtk_to_numpy(lattice.GetDisplacements())
                np.testing.assert_allclose(values, np.tile((1.0, 0.0, -2.0), (len(values), 1)),
                                           atol=1e-3)

    def test_bounds_that_no_lattice_can_have(self):
        """A lattice over another box was made of them."""
        transform = vtkTransform()
        transform.Translate(1.0, 2.0, 3.0)
        self.fit.SetTransform(transform)
        for bounds in ((0, 10, 10, 0, 0, 10), (0, 10, 0, 10, 10, 0), (0, 1, 3, 2, 0, 1), (0,) * 6,
                       (5, 5, 10, 0, 0, 5), (0, 1, 0, 1e-320, 0, 1), (0, 1, -1e308, 1e308, 0, 1)):
            with self.subTest(bounds=bounds):
                self.fit.SetBounds(*bounds)
                self.assertIsNone(self.fit.GetLattice())
                self.assertEqual(len(self.errors.messages), 1, self.errors.messages)
                self.assertIn("The bounds are not usable", self.errors.messages.pop())
        self.fit.SetBounds(0, 10, 4, 4, 0, 6)
        self.assertEqual(self.fit.GetLattice().GetDomain(), (0, 10, 1, 7, 0, 6))
        self.fit.SetBounds(1, -1, 1, -1, 1, -1)
        self.fit.SetTransform(None)
        voxel = vtkImageData()
        voxel.SetDimensions(1, 1, 1)
        voxel.GetPointData().SetScalars(numpy_to_vtk(np.ones((1, 3)), deep=True))
        self.fit.SetInputData(voxel)
        self.assertIsNone(self.fit.GetLattice())
        self.assertIn("a single point", self.errors.messages.pop())

    def test_bad_input_is_named(self):
        fit = self.fit

        def expect(text):
            fit.Modified()
            self.assertIsNone(fit.GetLattice())
            self.assertEqual(fit.GetMaximumError(), -1.0)
            self.assertEqual(fit.GetOutput().GetNumberOfPoints(), 0)
            self.assertEqual(len(self.errors.messages), 1, self.errors.messages)
            self.assertIn(text, self.errors.messages.pop())

        expect("nothing to fit")
        fit.SetTransform(vtkTransform())
        expect("SetBounds")
        fit.SetBounds(0, 1, 0, 1, 0, 1)
        self.assertIsNotNone(fit.GetLattice())
        fit.SetSourceLandmarks(points_of([[0, 0, 0]]))
        expect("more than one thing")
        fit.SetTransform(None)
        expect("as many source as target")
        fit.SetTargetLandmarks(points_of([[0, 0, 0], [1, 1, 1]]))
        expect("as many source as target")
        fit.SetTargetLandmarks(points_of([[0, 0, np.nan]]))
        expect("not finite")
        fit.SetTargetLandmarks(points_of([[0, 0, 1]]))
        weights = vtkDoubleArray()
        weights.InsertNextValue(-1.0)
        fit.SetLandmarkWeights(weights)
        expect("weight of landmark 0")
        weights.InsertNextValue(1.0)
        expect("one weight per pair")
        fit.SetSourceLandmarks(None)
        fit.SetTargetLandmarks(None)
        scalars = vtkImageData()
        scalars.SetDimensions(3, 3, 3)
        scalars.AllocateScalars(10, 1)
        fit.SetInputData(scalars)
        expect("3 components")
        field = make_field(bend)
        field.SetDirectionMatrix(0, 1, 0, 1, 0, 0, 0, 0, 1)
        fit.SetInputData(field)
        expect("direction matrix")
        for call in (lambda: fit.SetTolerance(0.0), lambda: fit.SetTolerance(np.nan),
                     lambda: fit.SetSmoothness(-1.0),
                     lambda: fit.SetBounds(0, np.nan, 0, 1, 0, 1)):
            call()
            self.assertEqual(len(self.errors.messages), 1)
            self.errors.messages.clear()


if __name__ == "__main__":
    unittest.main()
