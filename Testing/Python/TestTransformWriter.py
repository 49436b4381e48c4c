# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDTransformWriter: what is written is read back, and in the form that VTK's readers see."""

import os
import resource
import shutil
import signal
import stat
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonTransforms import vtkGeneralTransform, vtkTransform
from vtkmodules.vtkFiltersHybrid import vtkBSplineTransform, vtkGridTransform
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNIFTIImageReader

TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
POINTS = np.random.default_rng(1).uniform([1, 1, 1], [39, 29, 19], (30, 3))


def make_lattice():
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(6, 5, 4)
    lattice.SetDomain(0.0, 40.0, 0.0, 30.0, 0.0, 20.0)
    vtkffd.vtkFFDLatticeSource.ApplyShape(lattice, vtkffd.vtkFFDLatticeSource.RANDOM, 1.0, 5)
    return lattice


def make_linear():
    linear = vtkTransform()
    linear.Translate(3.0, -2.0, 1.0)
    linear.RotateWXYZ(20.0, 1.0, 2.0, 3.0)
    linear.Scale(1.1, 0.9, 1.2)
    return linear


def make_reference():
    image = vtkImageData()
    image.SetDimensions(17, 13, 9)
    image.SetSpacing(2.5, 2.5, 2.5)
    return image


def apply(transform, points=POINTS):
    return np.array([transform.TransformPoint(p) for p in points])


def write(name, transform, reference=None, coordinates="LPS", file_format=None):
    writer = vtkffd.vtkFFDTransformWriter()
    errors = []
    writer.AddObserver("ErrorEvent", Recorder(errors))
    writer.SetFileName(os.path.join(TEMPORARY, name))
    writer.SetTransform(transform)
    writer.SetReferenceImage(reference)
    getattr(writer, "SetCoordinatesTo" + coordinates)()
    if file_format is not None:
        writer.SetFileFormat(file_format)
    result = writer.Write()
    assert (result == 0) == (len(errors) == 1), errors
    return errors[0] if errors else None


class Recorder:
    CallDataType = "string0"

    def __init__(self, messages):
        self.messages = messages

    def __call__(self, _caller, _event, message):
        self.messages.append(message)


def read(name, coordinates="LPS"):
    reader = vtkffd.vtkFFDTransformReader()
    reader.SetFileName(os.path.join(TEMPORARY, name))
    getattr(reader, "SetCoordinatesTo" + coordinates)()
    return reader.GetTransform(), reader


class TestTransformWriter(unittest.TestCase):
    def test_texts_are_exact(self):
        lattice = make_lattice()
        lattice.SetDisplacementScale(0.5)
        spline = vtkBSplineTransform()
        spline.SetCoefficientData(lattice.GetCoefficientData())
        spline.SetDisplacementScale(0.5)
        for name in ("w.tfm", "w.txt", "TransformParameters.w.txt", "w.vti"):
            for transform in (lattice, spline):
                for coordinates in ("LPS", "RAS"):
                    with self.subTest((name, transform.GetClassName(), coordinates)):
                        self.assertIsNone(write(name, transform, None, coordinates))
                        again, reader = read(name, coordinates)
                        self.assertEqual(again.GetClassName(), "vtkFFDLattice")
                        np.testing.assert_allclose(apply(again), apply(lattice), atol=1e-12)
                        wanted = {"w.vti": "Lattice", "TransformParameters.w.txt": "Elastix"}
                        self.assertEqual(reader.GetFileFormatAsString(),
                                         wanted.get(name, "ItkText"))
        # Raw data in .vti are what ParaView 5.11 fails at.
        with open(os.path.join(TEMPORARY, "w.vti"), "rb") as file:
            self.assertNotIn(b'encoding="raw"', file.read())
        # The other system is another transform.
        write("w.tfm", lattice, None, "RAS")
        other, _ = read("w.tfm", "LPS")
        flip = np.array([-1.0, -1.0, 1.0])
        np.testing.assert_allclose(flip * apply(other, flip * POINTS), apply(lattice), atol=1e-12)

    def test_chain_as_composite(self):
        chain = vtkGeneralTransform()
        chain.PostMultiply()
        chain.Concatenate(make_linear())
        chain.Concatenate(make_lattice())
        grid = vtkGridTransform()
        image = make_reference()
        values = np.random.default_rng(2).uniform(-1, 1, (image.GetNumberOfPoints(), 3))
        image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
        grid.SetDisplacementGridData(image)
        grid.SetDisplacementScale(2.0)
        grid.SetDisplacementShift(0.25)
        chain.Concatenate(grid)
        # Points for which all three are within their grids.
        points = np.random.default_rng(3).uniform([10, 10, 5], [18, 15, 9], (20, 3))
        for coordinates in ("LPS", "RAS"):
            self.assertIsNone(write("chain.tfm", chain, None, coordinates))
            again, _ = read("chain.tfm", coordinates)
            np.testing.assert_allclose(apply(again, points), apply(chain, points), atol=2e-4)
        self.assertIn("one spline", write("chain.vti", chain))
        self.assertIn("one spline", write("TransformParameters.chain.txt", chain))
        linear = make_linear()
        self.assertIsNone(write("linear.tfm", linear))
        np.testing.assert_allclose(apply(read("linear.tfm")[0]), apply(linear), atol=1e-12)

    def test_fields(self):
        lattice = make_lattice()
        reference = make_reference()
        nodes = np.array([reference.GetPoint(i) for i in range(reference.GetNumberOfPoints())])
        wanted = apply(lattice, nodes) - nodes
        for name in ("w.mha", "w.mhd", "w.nrrd", "w.nii"):
            for coordinates in ("LPS", "RAS"):
                with self.subTest((name, coordinates)):
                    self.assertIsNone(write(name, lattice, reference, coordinates))
                    again, reader = read(name, coordinates)
                    self.assertEqual(again.GetClassName(), "vtkGridTransform")
                    grid = again.GetDisplacementGrid()
                    self.assertEqual(grid.GetDimensions(), reference.GetDimensions())
                    np.testing.assert_allclose(grid.GetOrigin(), (0, 0, 0), atol=1e-9)
                    np.testing.assert_allclose(
                        vtk_to_numpy(grid.GetPointData().GetScalars()), wanted, atol=1e-12)
        write("w.mha", lattice, reference)
        write("w.mhd", lattice, reference)
        write("w.nii", lattice, reference)
        for name, other in (("w.mha", vtkMetaImageReader()), ("w.mhd", vtkMetaImageReader()),
                            ("w.nii", vtkNIFTIImageReader())):
            other.SetFileName(os.path.join(TEMPORARY, name))
            other.Update()
            np.testing.assert_allclose(
                vtk_to_numpy(other.GetOutput().GetPointData().GetScalars()), wanted, atol=1e-12)
        # A grid with directions, origin and an extent that does not begin at 0.
        reference.SetExtent(2, 9, -1, 5, 3, 8)
        reference.SetOrigin(1.0, 2.0, 3.0)
        reference.SetDirectionMatrix(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
        for name in ("w.mha", "w.nrrd", "w.nii"):
            self.assertIsNone(write(name, lattice, reference))
            again, _ = read(name)
            nodes = np.array([reference.GetPoint(i) for i in range(reference.GetNumberOfPoints())])
            # Not at the border: rounding decides there what is outside.
            center = nodes.mean(axis=0)
            nodes = center + 0.999 * (nodes - center)
            near = np.abs(apply(again, nodes) - apply(lattice, nodes)).max()
            self.assertLess(near, 0.05)

    def test_random_lattices_come_back_bit_by_bit(self):
        random = np.random.default_rng(7)
        for seed in range(6):
            lattice = vtkffd.vtkFFDLattice()
            lattice.SetDimensions(*map(int, random.integers(4, 8, 3)))
            low = random.uniform(-100.0, 100.0, 3)
            high = low + random.uniform(0.1, 50.0, 3)
            lattice.SetDomain(low[0], high[0], low[1], high[1], low[2], high[2])
            values = vtk_to_numpy(lattice.GetDisplacements())
            values[:] = random.normal(size=values.shape) * 10.0 ** random.integers(-12, 9)
            lattice.Modified()
            for name in ("w.tfm", "TransformParameters.w.txt", "w.vti"):
                with self.subTest((seed, name)):
                    self.assertIsNone(write(name, lattice))
                    again = read(name)[0]
                    np.testing.assert_array_equal(vtk_to_numpy(again.GetDisplacements()), values)
                    # The origin is the sum of two numbers of the domain.
                    np.testing.assert_allclose(again.GetDomain(), lattice.GetDomain(), rtol=1e-13)

    def test_splines_of_low_order(self):
        for order in (1, 2):
            image = make_reference()
            random = np.random.default_rng(order)
            image.GetPointData().SetScalars(
                numpy_to_vtk(random.normal(size=(image.GetNumberOfPoints(), 3)), deep=True))
            spline = vtkffd.vtkFFDSplineTransform()
            spline.SetSplineOrder(order)
            spline.SetDisplacementGrid(image)
            for name in ("w.tfm", "TransformParameters.w.txt"):
                self.assertIsNone(write(name, spline))
                again = read(name)[0]
                self.assertEqual(again.GetSplineOrder(), order)
                np.testing.assert_array_equal(apply(again), apply(spline))
            self.assertIn("one spline", write("w.vti", spline))
            self.assertIn("inverted", write("w.tfm", spline.GetInverse()))

    def test_grids_that_are_not_linear(self):
        image = make_reference()
        values = np.random.default_rng(3).uniform(-1, 1, (image.GetNumberOfPoints(), 3))
        image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
        grid = vtkGridTransform()
        grid.SetDisplacementGridData(image)
        grid.SetInterpolationModeToLinear()
        self.assertIsNone(write("w.tfm", grid))
        chain = vtkGeneralTransform()
        chain.Concatenate(grid)
        for mode in ("Cubic", "NearestNeighbor"):
            getattr(grid, "SetInterpolationModeTo" + mode)()
            for transform in (grid, chain):
                self.assertIn("linear", write("w.tfm", transform))

    def test_error_between_the_points_of_a_field(self):
        lattice = make_lattice()
        writer = vtkffd.vtkFFDTransformWriter()
        warnings = []
        writer.AddObserver("WarningEvent", Recorder(warnings))
        writer.SetTransform(lattice)
        writer.SetFileName(os.path.join(TEMPORARY, "w.mha"))
        image = make_reference()
        writer.SetReferenceImage(image)
        self.assertEqual(writer.GetFieldTolerance(), 0.1)
        self.assertEqual(writer.Write(), 1)
        coarse = writer.GetFieldError()
        # What the linear field misses at the centers of its cells.
        again = read("w.mha")[0]
        centers = np.array([(i + 0.5, j + 0.5, k + 0.5) for i in range(16) for j in range(12)
                            for k in range(8)]) * 2.5
        missed = np.linalg.norm(apply(again, centers) - apply(lattice, centers), axis=1).max()
        self.assertAlmostEqual(coarse, missed, delta=1e-4)
        self.assertEqual(len(warnings), 1 if coarse > 0.1 else 0)
        writer.SetFieldTolerance(0.5 * coarse)
        del warnings[:]
        self.assertEqual(writer.Write(), 1)
        self.assertEqual(len(warnings), 1)
        self.assertIn("w.mha", warnings[0])
        image.SetDimensions(65, 49, 33)
        image.SetSpacing(0.625, 0.625, 0.625)
        self.assertEqual(writer.Write(), 1)
        self.assertLess(writer.GetFieldError(), coarse / 8.0)
        self.assertEqual(len(warnings), 1)
        writer.SetFileName(os.path.join(TEMPORARY, "w.tfm"))
        self.assertEqual(writer.Write(), 1)
        self.assertEqual(writer.GetFieldError(), 0.0)

    def test_what_is_not_finite_is_not_written(self):
        for value in (np.nan, np.inf, 1e15):
            lattice = make_lattice()
            vtk_to_numpy(lattice.GetDisplacements())[7, 1] = value
            lattice.Modified()
            chain = vtkGeneralTransform()
            chain.Concatenate(lattice)
            total = vtkffd.vtkFFDSumTransform()
            total.AddTransform(lattice)
            image = make_reference()
            values = np.zeros((image.GetNumberOfPoints(), 3))
            values[9, 2] = value
            image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
            grid = vtkGridTransform()
            grid.SetDisplacementGridData(image)
            spline = vtkffd.vtkFFDSplineTransform()
            spline.SetDisplacementGrid(image)
            for transform in (lattice, chain, total, grid, spline):
                for name in ("bad.mha", "bad.mhd", "bad.nrrd", "bad.nii", "bad.tfm", "bad.vti",
                             "TransformParameters.bad.txt"):
                    with self.subTest((value, transform.GetClassName(), name)):
                        path = os.path.join(TEMPORARY, name)
                        if os.path.exists(path):
                            os.remove(path)
                        self.assertIsNotNone(write(name, transform, make_reference()))
                        self.assertFalse(os.path.exists(path))
        linear = vtkTransform()
        linear.Translate(np.nan, 0, 0)
        self.assertIn("finite", write("bad.tfm", linear))
        linear.Identity()
        linear.Scale(1, 0, 1)
        self.assertIn("singular", write("bad.tfm", linear))
        # A small scale is not singular.
        linear.Identity()
        linear.Scale(1e-5, 1e-5, 1e-5)
        self.assertIsNone(write("w.tfm", linear))
        np.testing.assert_allclose(apply(read("w.tfm")[0]), apply(linear), rtol=1e-12)

    def test_names_that_metaimage_cannot_name(self):
        lattice = make_lattice()
        reference = make_reference()
        folder = os.path.join(TEMPORARY, "names")
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        nodes = np.array([reference.GetPoint(i) for i in range(reference.GetNumberOfPoints())])
        wanted = apply(lattice, nodes) - nodes
        for name in ("100%", "%03d 1 5 1", "a:b", " leading", "trailing ", "LIST", "LISTED", "LOCAL",
                     "two words", "new\nline", "\u00c4\u00d6", ".", "x" * 240):
            with self.subTest(name):
                path = os.path.join("names", name + ".mhd")
                self.assertIsNone(write(path, lattice, reference))
                grid = read(path)[0].GetDisplacementGrid()
                np.testing.assert_array_equal(
                    vtk_to_numpy(grid.GetPointData().GetScalars()), wanted)
                other = vtkMetaImageReader()
                other.SetFileName(os.path.join(TEMPORARY, path))
                other.Update()
                np.testing.assert_array_equal(
                    vtk_to_numpy(other.GetOutput().GetPointData().GetScalars()), wanted)

    def test_a_file_is_replaced_as_a_whole(self):
        folder = os.path.join(TEMPORARY, "whole")
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        lattice = make_lattice()
        names = ("whole/w.tfm", "whole/w.vti", "whole/w.mhd", "whole/w.nii")
        for name in names:
            self.assertIsNone(write(name, lattice, make_reference()))
        files = sorted(os.listdir(folder))
        self.assertEqual(files, ["w.mhd", "w.nii", "w.raw", "w.tfm", "w.vti"])

        def contents():
            result = []
            for name in sorted(os.listdir(folder)):
                with open(os.path.join(folder, name), "rb") as file:
                    result.append((name, file.read()))
            return result

        before = contents()
        lattice.SetDisplacement(2, 2, 2, 1.0, 2.0, 3.0)
        # As on a full disk: no file grows beyond 1000 bytes.
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
            messages = [write(name, lattice, make_reference()) for name in names]
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            signal.signal(signal.SIGXFSZ, handler)
        for message in messages:
            self.assertIn("space left", message)
        self.assertEqual(contents(), before)
        # Permissions are kept, and links followed.
        target = os.path.join(folder, "w.tfm")
        os.chmod(target, 0o640)
        os.symlink("w.tfm", os.path.join(folder, "link.tfm"))
        self.assertIsNone(write("whole/link.tfm", lattice))
        self.assertTrue(os.path.islink(os.path.join(folder, "link.tfm")))
        self.assertEqual(stat.S_IMODE(os.stat(target).st_mode), 0o640)
        np.testing.assert_array_equal(apply(read("whole/w.tfm")[0]), apply(lattice))
        # So are those to files that are not there yet, by way of other links.
        os.symlink("later.tfm", os.path.join(folder, "second.tfm"))
        os.symlink(os.path.join(folder, "second.tfm"), os.path.join(folder, "first.tfm"))
        self.assertIsNone(write("whole/first.tfm", lattice))
        self.assertTrue(os.path.islink(os.path.join(folder, "first.tfm")))
        self.assertFalse(os.path.islink(os.path.join(folder, "later.tfm")))
        np.testing.assert_array_equal(apply(read("whole/later.tfm")[0]), apply(lattice))
        os.symlink("loop.tfm", os.path.join(folder, "loop.tfm"))
        here = sorted(os.listdir("."))
        for name in ("whole/loop.tfm", "whole/" + 300 * "x" + ".tfm"):
            self.assertIn("its name cannot be used", write(name, lattice))
        self.assertEqual(sorted(os.listdir(".")), here)
        # What is no file is not replaced.
        os.mkfifo(os.path.join(folder, "pipe.tfm"))
        os.makedirs(os.path.join(folder, "folder.tfm"))
        for name in ("whole/pipe.tfm", "whole/folder.tfm"):
            self.assertIn("no regular file", write(name, lattice))

    def test_a_backslash_is_a_letter(self):
        for name in ("back\\slash.mhd", "back\\slash.mha", "back\\slash.tfm"):
            self.assertIsNone(write(name, make_lattice(), make_reference()))
            self.assertTrue(os.path.isfile(os.path.join(TEMPORARY, name)))
            self.assertIsNotNone(read(name)[0])

    def test_inverted_lattices(self):
        """As images of their control points."""
        lattice = make_lattice()
        spline = vtkBSplineTransform()
        image = vtkImageData()
        lattice.ToImageData(image)
        spline.SetCoefficientData(image)
        spline.SetBorderMode(lattice.GetBorderMode())
        turned = vtkffd.vtkFFDLattice()
        turned.DeepCopy(lattice)
        turned.Inverse()
        for inverse in (lattice.GetInverse(), turned, spline.GetInverse()):
            self.assertIsNone(write("inverse.vti", inverse))
            found = read("inverse.vti")[0]
            np.testing.assert_array_equal(apply(found), apply(turned))
            self.assertIn(".vti", write("inverse.tfm", inverse))

    def test_format_overrides_the_name(self):
        writer = vtkffd.vtkFFDTransformWriter
        self.assertIsNone(write("w.dat", make_lattice(), file_format=writer.ITK_TEXT))
        self.assertEqual(read("w.dat")[1].GetFileFormatAsString(), "ItkText")
        self.assertIsNone(write("w.txt", make_lattice(), file_format=writer.ELASTIX))
        self.assertEqual(read("w.txt")[1].GetFileFormatAsString(), "Elastix")
        # elastix: the grid of the image.
        bounds = [0.0] * 6
        read("w.txt")[1].GetDomain(bounds)
        np.testing.assert_allclose(bounds, (0, 40, 0, 30, 0, 20), atol=0.2)
        self.assertIsNone(write("w.txt", make_lattice(), make_reference(),
                                file_format=writer.ELASTIX))
        read("w.txt")[1].GetDomain(bounds)
        np.testing.assert_allclose(bounds, (0, 40, 0, 30, 0, 20))

    def test_what_cannot_be_written_is_said(self):
        lattice = make_lattice()
        self.assertIn("suffix", write("w.dat", lattice))
        self.assertIn("SetReferenceImage", write("w.nrrd", lattice))
        self.assertIn("SetTransform", write("w.tfm", None))
        self.assertIn("no/such", write("no/such/w.tfm", lattice))
        self.assertIn("no/such", write("no/such/w.vti", lattice))
        self.assertIn("inverted", write("w.tfm", lattice.GetInverse()))
        chain = vtkGeneralTransform()
        chain.Concatenate(lattice)
        self.assertIn("one spline", write("w.vti", chain))
        small = vtkffd.vtkFFDLattice()
        small.SetDomain(0, 1e-13, 0, 1, 0, 1)
        for name in ("w.tfm", "w.vti"):
            self.assertIn("axis 0 is 1e-13, not from 1e-12", write(name, small))
        for _ in range(64):
            chain.Concatenate(make_lattice())
        self.assertIn("64", write("w.tfm", chain))
        from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform
        self.assertIn("vtkThinPlateSplineTransform", write("w.tfm", vtkThinPlateSplineTransform()))
        writer = vtkffd.vtkFFDTransformWriter()
        errors = []
        writer.AddObserver("ErrorEvent", Recorder(errors))
        self.assertEqual(writer.Write(), 0)
        writer.SetFileFormat(99)
        writer.SetCoordinates(-1)
        writer.SetFieldTolerance(-1.0)
        writer.SetFieldTolerance(np.nan)
        self.assertEqual(len(errors), 5)
        self.assertEqual(writer.GetFieldTolerance(), 0.1)
        self.assertEqual((writer.GetFileFormat(), writer.GetCoordinates()), (0, 0))


if __name__ == "__main__":
    unittest.main()
