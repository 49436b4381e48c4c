# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Deformations as registration gives them: displacements on the points of an image, splines of many
control points."""

import resource
import sys
import threading
import unittest

import numpy as np
import vtkffd
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the window's implementation)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonTransforms import vtkGeneralTransform, vtkThinPlateSplineTransform
from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform, vtkGridTransform
from vtkmodules.vtkImagingCore import vtkImageBSplineCoefficients
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume)

SIDE = 64
TOLERANCE = 0.1


def make_volume():
    volume = vtkImageData()
    volume.SetDimensions(SIDE, SIDE, SIDE)
    z, y, x = np.meshgrid(*3 * [np.arange(SIDE)], indexing="ij")
    values = 128 + 60 * np.sin(.3 * x) * np.cos(.2 * y) + 60 * np.sin(.25 * z)
    volume.GetPointData().SetScalars(numpy_to_vtk(values.astype(np.uint8).ravel(), 1))
    return volume


def make_displacements(nodes):
    """Smooth displacements of up to 6 voxels on the box of the volume, not zero at its faces."""
    image = vtkImageData()
    image.SetDimensions(nodes, nodes, nodes)
    image.SetSpacing(*3 * [(SIDE - 1) / (nodes - 1)])
    z, y, x = np.meshgrid(*3 * [np.linspace(-1, 1, nodes)], indexing="ij")
    field = np.stack([6 * np.sin(2 * x + y) * np.cos(1.5 * z), 5 * np.cos(2 * y + .5 * z),
                      4 * np.sin(x + 2 * z)], -1)
    image.GetPointData().SetScalars(numpy_to_vtk(field.reshape(-1, 3), 1))
    return image


def make_spline(nodes):
    coefficients = vtkImageBSplineCoefficients()
    coefficients.SetInputData(make_displacements(nodes))
    coefficients.Update()
    spline = vtkBSplineTransform()
    spline.SetCoefficientData(coefficients.GetOutput())
    return spline


def make_general(transform):
    general = vtkGeneralTransform()
    general.Concatenate(transform)
    return general


class Scene:
    def __init__(self, deformation):
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(make_volume())
        self.mapper.SetAutoAdjustSampleDistances(0)
        self.mapper.SetSampleDistance(1)
        self.mapper.SetPositionTolerance(TOLERANCE)
        self.mapper.SetDeformation(deformation)
        self.warnings = []
        self.mapper.AddObserver("WarningEvent", lambda *_: self.warnings.append(1))
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        opacity, color = vtkPiecewiseFunction(), vtkColorTransferFunction()
        opacity.AddPoint(60, 0)
        opacity.AddPoint(255, .2)
        color.AddRGBPoint(0, .2, .3, .6)
        color.AddRGBPoint(255, 1, .9, .7)
        self.volume.GetProperty().SetScalarOpacity(opacity)
        self.volume.GetProperty().SetColor(color)
        self.volume.GetProperty().ShadeOn()
        self.volume.GetProperty().SetInterpolationTypeToLinear()
        self.window, self.renderer = vtkRenderWindow(), vtkRenderer()
        self.window.SetOffScreenRendering(1)
        self.window.AddRenderer(self.renderer)
        self.renderer.AddVolume(self.volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(120, 90, 200)
        camera.SetFocalPoint(*3 * [SIDE / 2])
        self.renderer.ResetCameraClippingRange()

    def render(self):
        image = vtkImageData()
        self.mapper.RenderToImage(self.renderer, self.volume, 160, 160, image)
        return vtk_to_numpy(image.GetPointData().GetScalars()).astype(float)


class TestRegistration(unittest.TestCase):
    def test_grids_on_the_points_of_the_image_are_followed_up_to_its_faces(self):
        for nodes, interpolation in ((SIDE, "Linear"), (SIDE, "Cubic"), (12, "Cubic")):
            with self.subTest(nodes=nodes, interpolation=interpolation):
                grid = vtkGridTransform()
                grid.SetDisplacementGridData(make_displacements(nodes))
                getattr(grid, "SetInterpolationModeTo" + interpolation)()
                scene = Scene(grid)
                scene.render()
                self.assertEqual(scene.warnings, [])
                rng = np.random.default_rng(1)
                errors = []
                for _ in range(600):
                    rest = rng.uniform(0, SIDE - 1, 3)
                    # Some near a face.
                    axis = rng.integers(3)
                    rest[axis] = rng.choice([rest[axis], .5, SIDE - 1.5])
                    found = [0.0, 0.0, 0.0]
                    scene.mapper.GetRestPosition(grid.TransformPoint(rest), found)
                    errors.append(np.linalg.norm(np.subtract(found, rest)))
                self.assertLess(max(errors), 2 * TOLERANCE)
                self.assertLess(np.mean(errors), .3 * TOLERANCE)

    def test_a_grid_that_folds_is_not_inverted_by_vtk(self):
        """VTK would warn at each point at which its inverse does not converge."""
        displacements = make_displacements(12)
        noise = np.random.default_rng(2).normal(size=(12 ** 3, 3))
        displacements.GetPointData().SetScalars(numpy_to_vtk(8 * noise, 1))
        grid = vtkGridTransform()
        grid.SetDisplacementGridData(displacements)
        grid.SetInterpolationModeToCubic()
        messages = []
        for transform in (grid, grid.GetInverse()):
            transform.AddObserver("WarningEvent",
                                  lambda *_: messages.append(threading.current_thread()))
        scene = Scene(grid)
        self.assertGreater(np.ptp(scene.render()), 50)
        self.assertEqual(messages, [])
        # Where its inverse is asked for, its messages come from the thread that runs the program.
        for inverse in (grid.GetInverse(), make_general(grid.GetInverse())):
            vtkffd.vtkFFDLattice().FitToTransform(inverse, 3 * [0, SIDE - 1], 1, 4)
            self.assertEqual(set(messages), {threading.main_thread()})
            messages.clear()

    def test_threads_sample_transforms_as_one_does(self):
        rng = np.random.default_rng(4)
        spline = vtkThinPlateSplineTransform()
        places = rng.uniform(0, SIDE, (12, 3))
        for name, points in (("Source", places), ("Target", places + rng.normal(size=(12, 3)))):
            landmarks = vtkPoints()
            landmarks.SetData(numpy_to_vtk(points, 1))
            getattr(spline, "Set%sLandmarks" % name)(landmarks)
        spline.SetBasisToR2LogR()
        straight = Scene(None).render()
        for deformation in (spline, make_general(spline), spline.GetInverse()):
            pictures = []
            for threads in (1, 3):
                scene = Scene(deformation)
                scene.mapper.SetNumberOfThreads(threads)
                scene.mapper.SetPositionTolerance(.5)
                pictures.append(scene.render())
            np.testing.assert_array_equal(*pictures)
            self.assertGreater(np.abs(pictures[0] - straight).mean(), .5)

    def test_modes_that_look_beyond_the_image_have_fields_of_their_own(self):
        grid = vtkGridTransform()
        grid.SetDisplacementGridData(make_displacements(16))
        grid.SetInterpolationModeToCubic()
        kept = Scene(grid)
        for mode in ("Exact", "PullBack", "FirstOrder", "Exact"):
            with self.subTest(mode=mode):
                anew = Scene(grid)
                for scene in (kept, anew):
                    getattr(scene.mapper, "SetInverseModeTo" + mode)()
                np.testing.assert_array_equal(kept.render(), anew.render())

    def test_splines_of_many_control_points_show_the_same(self):
        few = Scene(make_spline(24)).render()
        self.assertGreater(few.mean(), 20)
        many = Scene(make_spline(80))
        picture = many.render()
        self.assertLess(np.abs(picture - few).mean(), .3)
        # A second frame, from what was kept.
        np.testing.assert_array_equal(many.render(), picture)
        # These look beyond the faces, where the splines end in steps of their own.
        for mode in ("FirstOrder", "PullBack"):
            pictures = []
            for nodes in (24, 80):
                scene = Scene(make_spline(nodes))
                getattr(scene.mapper, "SetInverseModeTo" + mode)()
                pictures.append(scene.render())
            self.assertLess(np.abs(pictures[1] - pictures[0]).mean(), .8)

    @unittest.skipUnless(sys.platform == "linux", "ru_maxrss is in KB")
    def test_a_spline_of_many_control_points_takes_little_memory(self):
        spline = make_spline(100)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        Scene(spline).render()
        taken = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        # The control points twice, in double and in single precision, take 43 MB.
        self.assertLess(taken / 1024, 350)


if __name__ == "__main__":
    unittest.main()
