# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDTransformSeries: transform files as lattices of a pipeline, in time."""

import json
import os
import shutil
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

FOLDER = os.path.join(os.environ["FFD_TEST_DATA"], "Transforms")
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
POINTS = np.random.default_rng(1).uniform(9.0, 27.0, (40, 3))


def path(name):
    return os.path.join(FOLDER, name)


def series(*names, **options):
    item = vtkffd.vtkFFDTransformSeries()
    for name in names:
        item.AddFileName(path(name))
    for name, value in options.items():
        getattr(item, "Set" + name)(value)
    return item


def apply(transform, points=POINTS):
    return np.array([transform.TransformPoint(p) for p in points])


def read(name, stack_index=0):
    reader = vtkffd.vtkFFDTransformReader()
    reader.SetFileName(path(name))
    reader.SetStackIndex(stack_index)
    return reader


def lattice_of(item, time=None):
    """What the output says."""
    if time is None:
        item.Update()
    else:
        item.UpdateTimeStep(time)
    lattice = vtkffd.vtkFFDLattice()
    return lattice if lattice.FromImageData(item.GetOutput()) else None


def times_of(item):
    item.UpdateInformation()
    info = item.GetOutputInformation(0)
    key = item.GetExecutive().TIME_STEPS()
    return list(info.Get(key)) if info.Has(key) else []


class Errors:
    def __init__(self, item, event="ErrorEvent"):
        self.messages = []
        item.AddObserver(event, self.add)

    def add(self, _caller, _event, message=""):
        self.messages.append(message)

    add.CallDataType = "string0"


class TestTransformSeries(unittest.TestCase):
    def test_each_kind_of_file(self):
        """Within the tolerance it is what the file says, and nothing has to be set for it."""
        for name, tolerance in (("elastix5_chain.txt", 0.1), ("elastix5_euler.txt", 1e-9),
                                ("itk_linear.mat", 1e-9), ("itk_linear.xfm", 1e-9),
                                ("itk_field.h5", 0.1), ("field_oblique.nii.gz", 0.1),
                                ("itk_spline2.tfm", 0.1)):
            with self.subTest(name):
                reader = read(name)
                domain = [0.0] * 6
                reader.GetDomain(domain)
                points = POINTS
                if domain[0] <= domain[1] and "elastix" not in name:
                    low, high = np.array(domain[::2]), np.array(domain[1::2])
                    points = low + (high - low) * (0.3 + 0.4 * (POINTS - 9.0) / 18.0)
                lattice = lattice_of(series(name, PullBack=0))
                self.assertEqual(lattice.GetInverseFlag(), 0)
                difference = np.abs(apply(lattice, points) - apply(reader.GetTransform(), points))
                self.assertLess(difference.max(), tolerance)
                self.assertEqual(times_of(series(name)), [])

    def test_pull_back(self):
        """The deformation is the inverse of what the file says."""
        forward = lattice_of(series("elastix5_chain.txt", PullBack=0))
        back = lattice_of(series("elastix5_chain.txt"))
        self.assertEqual(back.GetInverseFlag(), 1)
        np.testing.assert_allclose(apply(back, apply(forward)), POINTS, atol=2e-3)

    def test_a_lattice_is_as_its_file_says(self):
        lattice = lattice_of(series("lattice.vti"))
        self.assertEqual(lattice.GetInverseFlag(), 0)
        np.testing.assert_array_equal(
            vtk_to_numpy(lattice.GetDisplacements()),
            vtk_to_numpy(read("lattice.vti").GetLattice().GetDisplacements()))

    def test_stack(self):
        """The steps of a stack are at its times, and between them is the mean."""
        item = series("elastix5_stack.txt", PullBack=0, FitTolerance=0.02)
        self.assertEqual(times_of(item), [1.0, 1.5, 2.0, 2.5])
        self.assertEqual([item.GetStepTime(i) for i in range(item.GetNumberOfSteps())],
                         [1.0, 1.5, 2.0, 2.5])
        with open(path("elastix5_points.json"), encoding="ascii") as file:
            for start, end in json.load(file)["elastix5_stack.txt"]:
                moved = lattice_of(item, start[3]).TransformPoint(start[:3])
                np.testing.assert_allclose(moved, end[:3], atol=0.02)
        self.assertEqual(item.GetOutput().GetInformation().Get(item.GetOutput().DATA_TIME_STEP()),
                         start[3])
        at = {time: apply(lattice_of(item, time)) for time in (1.5, 1.6, 2.0, -7.0, 1.0, 9.0, 2.5)}
        np.testing.assert_allclose(at[1.6], 0.8 * at[1.5] + 0.2 * at[2.0], atol=1e-9)
        np.testing.assert_array_equal(at[-7.0], at[1.0])
        np.testing.assert_array_equal(at[9.0], at[2.5])
        np.testing.assert_array_equal(apply(lattice_of(item)), at[2.5])  # the time asked for last
        item.SetInterpolationToStep()
        np.testing.assert_array_equal(apply(lattice_of(item, 1.6)), at[1.5])

    def test_files_of_different_kinds_in_time(self):
        """They become lattices of one grid."""
        names = ("elastix5_euler.txt", "elastix5_spline1.txt", "elastix5_chain.txt")
        item = series(*names, PullBack=0, TimeStart=2.0, TimeSpacing=0.5,
                      FitBounds=[0, 40, 0, 40, 0, 40])
        self.assertEqual(times_of(item), [2.0, 2.5, 3.0])
        for i, name in enumerate(names):
            lattice = lattice_of(item, 2.0 + 0.5 * i)
            difference = np.abs(apply(lattice) - apply(read(name).GetTransform()))
            self.assertLess(difference.max(), 0.15)
            self.assertEqual(lattice.GetDomain(), (0, 40, 0, 40, 0, 40))
        self.assertGreater(item.GetLatticeError(), 0.0)
        self.assertLess(item.GetLatticeError(), 0.1)
        coarse = series(*names, FitTolerance=5.0)
        coarse.Update()
        self.assertLess(coarse.GetOutput().GetNumberOfPoints(), item.GetOutput().GetNumberOfPoints())
        capped = series(*names, MaximumCells=4)
        warnings = Errors(capped, "WarningEvent")
        capped.Update()
        self.assertEqual(capped.GetOutput().GetDimensions(), (7, 7, 7))
        self.assertIn("MaximumCells", warnings.messages[0])

    def test_lattices_in_time_stay_what_they_are(self):
        """Of one grid they are taken over, scale by scale; others are fitted."""
        lattice = read("lattice.vti").GetLattice()
        writer = vtkXMLImageDataWriter()
        names = []
        for scale in (1.0, 3.0):
            image = vtkImageData()
            lattice.SetDisplacementScale(scale)
            lattice.ToImageData(image)
            names.append(os.path.join(TEMPORARY, "series%g.vti" % scale))
            writer.SetFileName(names[-1])
            writer.SetInputData(image)
            writer.Write()
        item = series(*names)
        lattice.SetDisplacementScale(2.0)
        domain = np.array(lattice.GetDomain())
        points = domain[::2] + (domain[1::2] - domain[::2]) * (POINTS - 9.0) / 18.0
        np.testing.assert_allclose(
            apply(lattice_of(item, 0.5), points), apply(lattice, points), atol=1e-12)
        self.assertEqual(item.GetLatticeError(), 0.0)
        lattice.SetDimensions(9, 8, 7)
        lattice.SetDisplacement(4, 4, 3, 2.0, 0.0, 0.0)
        lattice.SetDisplacementScale(1.0)
        lattice.ToImageData(image)
        writer.SetFileName(names[1])
        writer.SetInputData(image)
        writer.Write()
        item.Reload()
        difference = apply(lattice_of(item, 1.0), points) - apply(lattice, points)
        self.assertLess(np.abs(difference).max(), 0.1)
        self.assertGreater(item.GetLatticeError(), 0.0)

    def test_coordinates(self):
        flip = np.array([-1.0, -1.0, 1.0])
        lps = lattice_of(series("elastix5_euler.txt", PullBack=0))
        ras = lattice_of(series("elastix5_euler.txt", PullBack=0, Coordinates=1))
        np.testing.assert_allclose(apply(ras, POINTS * flip), apply(lps) * flip, atol=1e-9)

    def test_of_a_volume(self):
        """The filter that attaches the lattice has the times of both inputs, and follows."""
        volume = vtkImageData()
        volume.SetDimensions(4, 4, 4)
        volume.SetSpacing(10, 10, 10)
        volume.AllocateScalars(3, 1)
        item = series("elastix5_stack.txt")
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(volume)
        deform.SetLatticeConnection(item.GetOutputPort())
        self.assertEqual(times_of(deform), [1.0, 1.5, 2.0, 2.5])
        lattice = vtkffd.vtkFFDLattice()
        for time in (1.0, 2.2):
            deform.UpdateTimeStep(time)
            self.assertEqual(lattice.ReadFrom(deform.GetOutput()), 1)
            np.testing.assert_array_equal(
                vtk_to_numpy(lattice.GetDisplacements()),
                vtk_to_numpy(lattice_of(item, time).GetDisplacements()))
            self.assertEqual(lattice.GetInverseFlag(), 1)
        # Keyframes are what counts where there are any.
        deform.AddKeyframe(7.0, lattice)
        self.assertEqual(times_of(deform), [7.0])

    def test_linear_transforms_of_a_volume(self):
        """They have no region of their own; the lattice gets that of the volume, and it is shown where
        the transform says, in bounds that are tight."""
        volume = vtkImageData()
        volume.SetDimensions(4, 4, 4)
        volume.SetSpacing(10, 10, 10)
        volume.AllocateScalars(3, 1)
        corners = np.array(np.meshgrid(*[(0.0, 30.0)] * 3)).reshape(3, 8).T
        for matrix, offset, warned in (
                ([0.8, 0.1, 0, -0.1, 0.9, 0.05, 0, 0, 1.1], [3, -7, 11], 0),
                ([-1, 0, 0, 0, -1, 0, 0, 0, 1], [0, 0, 0], 1)):
            name = os.path.join(TEMPORARY, "affine.tfm")
            with open(name, "w", encoding="ascii") as file:
                file.write("#Insight Transform File V1.0\n#Transform 0\n"
                           "Transform: AffineTransform_double_3_3\nParameters: %s\n"
                           "FixedParameters: 0 0 0\n" % " ".join(map(str, matrix + offset)))
            for pull_back in (1, 0):
                item = series(name, PullBack=pull_back)
                item.Update()
                self.assertGreater(np.prod(item.GetOutput().GetSpacing()), 1e9)
                deform = vtkffd.vtkFFDDeformVolume()
                deform.SetInputData(volume)
                deform.SetLatticeConnection(item.GetOutputPort())
                warnings = Errors(deform, "WarningEvent")
                deform.Update()
                self.assertEqual(len(warnings.messages), warned, warnings.messages)
                if warned:
                    continue
                lattice = vtkffd.vtkFFDLattice()
                lattice.ReadFrom(deform.GetOutput())
                m = np.reshape(matrix, (3, 3))
                moved = (np.linalg.solve(m, (corners - offset).T).T if pull_back
                         else corners @ m.T + offset)
                np.testing.assert_allclose(apply(lattice, corners), moved, atol=1e-3)
                mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
                mapper.SetInputData(deform.GetOutput())
                bounds = np.array(mapper.GetBounds())
                np.testing.assert_allclose(bounds[::2], moved.min(axis=0), atol=2.0)
                np.testing.assert_allclose(bounds[1::2], moved.max(axis=0), atol=2.0)

    def test_what_can_be_read(self):
        item = vtkffd.vtkFFDTransformSeries()
        for name in ("euler.tfm", "elastix5_stack.txt", "itk_field.h5", "itk_linear.mat",
                     "itk_linear.xfm", "field_flipped.nrrd", "field_oblique.nii.gz",
                     "field_oblique.mhd"):
            self.assertEqual(item.CanReadFile(path(name)), 1, name)
        for name in ("points.json", "lattice.vti", "no_such_file", "field_oblique.raw"):
            self.assertEqual(item.CanReadFile(path(name)), 0, name)
        # A volume, and no vectors.
        scalar = os.path.join(TEMPORARY, "scalar.nrrd")
        with open(scalar, "wb") as file:
            file.write(b"NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
                       b"endian: little\n\n" + bytes(32))
        self.assertEqual(item.CanReadFile(scalar), 0)
        self.assertEqual(item.CanReadFile(None), 0)

    def test_errors(self):
        for names, words in (
                ((), "no file to read"),
                (("no_such_file.tfm",), "no_such_file.tfm"),
                (("elastix5_euler.txt", "points.json"), "points.json"),
                (("elastix5_euler.txt", "elastix5_stack.txt"), "must be the only file")):
            item = series(*names)
            errors = Errors(item)
            executive = Errors(item.GetExecutive())
            item.Update()
            self.assertEqual(len(errors.messages), 1, errors.messages)
            self.assertIn(words, errors.messages[0])
            self.assertEqual(item.GetNumberOfSteps(), 0)
            self.assertLessEqual(len(executive.messages), 1)
            # Nothing is left of a file before.
            item.RemoveAllFileNames()
            item.AddFileName(path("elastix5_euler.txt"))
            item.Update()
            self.assertGreater(item.GetOutput().GetNumberOfPoints(), 0)
            item.RemoveAllFileNames()
            for name in names:
                item.AddFileName(path(name))
            item.Update()
            self.assertEqual(item.GetOutput().GetNumberOfPoints(), 0)
        # Of lattices the forward deformation is known, of other files the inverse.
        for names in (("lattice.vti", "euler.tfm"), ("euler.tfm", "lattice.vti")):
            item = series(*names)
            errors = Errors(item)
            self.assertEqual(item.GetLatticeAt(0.5, vtkffd.vtkFFDLattice()), 0)
            self.assertEqual(len(errors.messages), 1)
            self.assertIn(path("lattice.vti") + " the other way", errors.messages[0])
            item.SetInterpolationToStep()
            flags = [lattice_of(item, time).GetInverseFlag() for time in (0.0, 1.0)]
            self.assertEqual(flags, [int(name == "euler.tfm") for name in names])
            item.SetInterpolationToLinear()
            item.SetPullBack(0)
            self.assertEqual(lattice_of(item, 0.5).GetInverseFlag(), 0)
            self.assertEqual(len(errors.messages), 1)
        item = series("euler.tfm", "euler.tfm", TimeStart=1e308, TimeSpacing=1e308)
        item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        errors = Errors(item)
        self.assertEqual(times_of(item), [])
        self.assertIn("not finite", errors.messages[0])
        item = series("euler.tfm")
        errors = Errors(item)
        for name, value in (("Coordinates", 2), ("FitTolerance", 0.0), ("TimeSpacing", 0.0),
                            ("TimeStart", float("nan")), ("FitBounds", [float("inf")] * 6)):
            before = getattr(item, "Get" + name)()
            getattr(item, "Set" + name)(value)
            self.assertEqual(getattr(item, "Get" + name)(), before)
        item.AddFileName("")
        self.assertEqual(len(errors.messages), 6, errors.messages)
        item.SetMaximumCells(1000)
        self.assertEqual(item.GetMaximumCells(), 256)
        self.assertIsNone(item.GetFileName(1))
        self.assertEqual(item.GetFileName(0), path("euler.tfm"))
        item.RemoveAllFileNames()
        self.assertEqual(item.GetNumberOfFileNames(), 0)

    def test_work(self):
        """What does not change what is read reads nothing."""
        copy = os.path.join(TEMPORARY, "series.txt")
        shutil.copy(path("elastix5_euler.txt"), copy)
        item = series(copy, copy)
        item.Update()
        os.remove(copy)
        errors = Errors(item)
        item.SetPullBack(0)
        item.SetInterpolationToStep()
        item.SetTimeSpacing(2.0)
        item.SetTimeStart(3.0)
        self.assertEqual(times_of(item), [3.0, 5.0])
        self.assertEqual(lattice_of(item, 4.0).GetInverseFlag(), 0)
        self.assertEqual(errors.messages, [])
        item.Reload()
        item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        item.Update()
        self.assertEqual(len(errors.messages), 1)


if __name__ == "__main__":
    unittest.main()
