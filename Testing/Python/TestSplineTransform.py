# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDSplineTransform and vtkFFDSumTransform: values, derivatives, inverses, copies."""

import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonTransforms import vtkGeneralTransform, vtkTransform


def make_lattice(border):
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(6, 5, 7)
    lattice.SetDomain(0.0, 30.0, 10.0, 30.0, -5.0, 35.0)
    lattice.SetBorderMode(border)
    random = np.random.default_rng(2)
    values = vtk_to_numpy(lattice.GetDisplacements())
    values[:] = random.uniform(-1.5, 1.5, values.shape)
    lattice.Modified()
    return lattice


def make_grid(lattice):
    grid = vtkImageData()
    lattice.ToImageData(grid)
    return grid


def make_spline(order, lattice):
    spline = vtkffd.vtkFFDSplineTransform()
    spline.SetSplineOrder(order)
    spline.SetDisplacementGrid(make_grid(lattice))
    return spline


def make_sum():
    total = vtkffd.vtkFFDSumTransform()
    total.AddTransform(make_spline(2, make_lattice(1)), 0.7)
    linear = vtkTransform()
    linear.Translate(3, 2, 1)
    linear.RotateWXYZ(20, 1, 2, 3)
    total.AddTransform(linear, 0.5)
    return total


POINTS = np.random.default_rng(3).uniform([1, 11, -4], [29, 29, 34], (30, 3))
ANYWHERE = np.random.default_rng(4).uniform([-40, -30, -60], [70, 70, 90], (200, 3))


def apply(transform, points):
    return np.array([transform.TransformPoint(p) for p in points])


class Errors:
    CallDataType = "string0"

    def __init__(self, item):
        self.messages = []
        item.AddObserver("ErrorEvent", self)

    def __call__(self, _caller, _event, message):
        self.messages.append(message)


class TestSplineTransform(unittest.TestCase):
    def test_cubic_ones_are_lattices(self):
        for border, repeat in ((1, False), (0, True)):  # VTK_BSPLINE_ZERO, VTK_BSPLINE_EDGE
            lattice = make_lattice(border)
            spline = make_spline(3, lattice)
            spline.SetRepeatBorder(repeat)
            points = POINTS if repeat else np.vstack([POINTS, ANYWHERE])
            np.testing.assert_allclose(apply(spline, points), apply(lattice, points), atol=1e-12)

    def test_values_are_sums_of_centered_splines(self):
        grid = make_grid(make_lattice(1))
        values = vtk_to_numpy(grid.GetPointData().GetScalars())
        nodes = np.array([grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())])

        def linear(t):
            return np.maximum(1.0 - np.abs(t), 0.0)

        def quadratic(t):
            t = np.abs(t)
            return np.where(t < 0.5, 0.75 - t * t, 0.5 * np.maximum(1.5 - t, 0.0) ** 2)

        for order, basis in ((1, linear), (2, quadratic)):
            spline = make_spline(order, make_lattice(1))
            for p in np.vstack([POINTS, ANYWHERE[:40]]):
                weights = basis((p - nodes) / grid.GetSpacing()).prod(axis=1)
                np.testing.assert_allclose(spline.TransformPoint(p), p + weights @ values, atol=1e-12)

    def test_the_border_is_repeated(self):
        spline = make_spline(2, make_lattice(1))
        far = (15.0, 20.0, 1e9)
        np.testing.assert_array_equal(spline.TransformPoint(far), far)
        spline.RepeatBorderOn()
        edge = np.subtract(spline.TransformPoint(far), far)
        self.assertGreater(np.abs(edge).max(), 0.01)
        near = (15.0, 20.0, 1e3)
        np.testing.assert_allclose(np.subtract(spline.TransformPoint(near), near), edge, atol=1e-6)

    def test_derivatives_inverses_and_copies(self):
        for transform in (make_spline(1, make_lattice(1)), make_spline(2, make_lattice(1)),
                          make_sum()):
            with self.subTest(str(transform)[:60]):
                copy = transform.MakeTransform()
                copy.DeepCopy(transform)
                np.testing.assert_array_equal(apply(copy, POINTS), apply(transform, POINTS))
                transform.SetInverseTolerance(1e-10)
                inverse = transform.GetInverse()
                # Of an inverse that nobody has asked for anything yet.
                copy = inverse.MakeTransform()
                copy.DeepCopy(inverse)
                np.testing.assert_array_equal(apply(copy, POINTS), apply(inverse, POINTS))
                moved = apply(transform, POINTS)
                self.assertGreater(np.abs(moved - POINTS).max(), 0.5)
                np.testing.assert_allclose(apply(inverse, moved), POINTS, atol=1e-7)
                step = 1e-6
                for p in POINTS[:8]:
                    q = [0.0] * 3
                    jacobian = [[0.0] * 3 for _ in range(3)]
                    transform.InternalTransformDerivative(p, q, jacobian)
                    np.testing.assert_allclose(q, transform.TransformPoint(p), atol=1e-13)
                    differences = np.array([
                        np.subtract(transform.TransformPoint(p + step * e),
                                    transform.TransformPoint(p - step * e)) / (2 * step)
                        for e in np.eye(3)]).T
                    np.testing.assert_allclose(jacobian, differences, atol=1e-7)

    def test_sums(self):
        total = make_sum()
        spline, linear = total.GetTransform(0), total.GetTransform(1)
        wanted = POINTS + 0.7 * (apply(spline, POINTS) - POINTS) + 0.5 * (
            apply(linear, POINTS) - POINTS)
        np.testing.assert_allclose(apply(total, POINTS), wanted, atol=1e-12)
        self.assertEqual((total.GetNumberOfTransforms(), total.GetWeight(1)), (2, 0.5))
        # A term that changes is a change.
        before = total.GetMTime()
        linear.Translate(1.0, 0.0, 0.0)
        self.assertGreater(total.GetMTime(), before)
        self.assertGreater(np.abs(apply(total, POINTS) - wanted).max(), 0.1)
        total.RemoveAllTransforms()
        np.testing.assert_array_equal(apply(total, POINTS), POINTS)

    def test_bad_input(self):
        total = make_sum()
        errors = Errors(total)
        chain = vtkGeneralTransform()
        chain.Concatenate(total)
        for call in (lambda: total.AddTransform(None), lambda: total.AddTransform(total),
                     lambda: total.AddTransform(chain),
                     lambda: total.AddTransform(vtkTransform(), np.nan)):
            before = len(errors.messages)
            call()
            self.assertEqual(len(errors.messages), before + 1)
        self.assertEqual(total.GetNumberOfTransforms(), 2)
        self.assertEqual((total.GetTransform(-1), total.GetTransform(2)), (None, None))
        self.assertEqual(total.GetWeight(9), 0.0)
        spline = make_spline(2, make_lattice(1))
        errors = Errors(spline)
        np.testing.assert_array_equal(np.isnan(spline.TransformPoint(np.nan, 0.0, 0.0))[1:], False)
        spline.SetSplineOrder(9)
        self.assertEqual(spline.GetSplineOrder(), 3)
        grid = spline.GetDisplacementGrid()
        for change in (lambda: vtk_to_numpy(grid.GetPointData().GetScalars()).fill(np.inf),
                       lambda: grid.GetPointData().SetScalars(numpy_to_vtk(np.zeros(3), deep=True)),
                       lambda: grid.GetPointData().SetScalars(None)):
            before = len(errors.messages)
            change()
            grid.Modified()
            np.testing.assert_array_equal(spline.TransformPoint(1.0, 2.0, 3.0), (1, 2, 3))
            self.assertEqual(len(errors.messages), before + 1)
        spline.SetDisplacementGrid(None)
        np.testing.assert_array_equal(spline.TransformPoint(1.0, 2.0, 3.0), (1, 2, 3))

    def test_how_inverses_are_found(self):
        for transform in (make_spline(2, make_lattice(1)), make_sum(), vtkffd.vtkFFDBarrTransform(),
                          vtkffd.vtkFFDRayDeflector()):
            with self.subTest(transform.GetClassName()):
                errors = Errors(transform)
                transform.SetInverseTolerance(0.125)
                transform.SetInverseIterations(7)
                time = transform.GetMTime()
                for value in (np.nan, np.inf, -1.0, 0.0):
                    transform.SetInverseTolerance(value)
                    self.assertIn("SetInverseTolerance: the tolerance is", errors.messages.pop())
                for value in (-5, 0):
                    transform.SetInverseIterations(value)
                    self.assertIn("SetInverseIterations: the number is %d" % value,
                                  errors.messages.pop())
                self.assertEqual(transform.GetInverseTolerance(), 0.125)
                self.assertEqual(transform.GetInverseIterations(), 7)
                self.assertEqual(transform.GetMTime(), time)


if __name__ == "__main__":
    unittest.main()
