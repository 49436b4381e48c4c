# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDTransformWriter: what is written is read back, and in the form that VTK's readers see."""

import os
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
        from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform
        self.assertIn("vtkThinPlateSplineTransform", write("w.tfm", vtkThinPlateSplineTransform()))
        writer = vtkffd.vtkFFDTransformWriter()
        errors = []
        writer.AddObserver("ErrorEvent", Recorder(errors))
        self.assertEqual(writer.Write(), 0)
        writer.SetFileFormat(99)
        writer.SetCoordinates(-1)
        self.assertEqual(len(errors), 3)
        self.assertEqual((writer.GetFileFormat(), writer.GetCoordinates()), (0, 0))


if __name__ == "__main__":
    unittest.main()
