# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDLattice from Python: editing with numpy, transforming, files, errors."""

import math
import os
import tempfile
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter


def catch_errors(lattice):
    """A list that collects the messages of the lattice's errors."""
    messages = []

    def observer(caller, event, message):
        messages.append(message)

    observer.CallDataType = "string0"
    lattice.AddObserver("ErrorEvent", observer)
    return messages


class TestLattice(unittest.TestCase):
    def setUp(self):
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(6, 5, 7)
        self.lattice.SetDomain(0, 30, 0, 20, 0, 10)

    def test_single_points(self):
        lattice = self.lattice
        self.assertEqual(lattice.GetDimensions(), (6, 5, 7))
        np.testing.assert_allclose(lattice.GetDomain(), (0, 30, 0, 20, 0, 10), atol=1e-12)
        rest = [0.0] * 3
        lattice.GetRestPoint(2, 1, 3, rest)
        np.testing.assert_allclose(rest, (10, 0, 5))
        lattice.SetControlPoint(2, 1, 3, 11, 1, 6)
        point = [0.0] * 3
        lattice.GetControlPoint(2, 1, 3, point)
        np.testing.assert_allclose(point, (11, 1, 6))
        lattice.SetDisplacement(2, 1, 3, (0.5, 0, 0))
        displacement = [0.0] * 3
        lattice.GetDisplacement(2, 1, 3, displacement)
        self.assertEqual(displacement, [0.5, 0.0, 0.0])
        self.assertFalse(lattice.IsIdentity())
        lattice.Reset()
        self.assertTrue(lattice.IsIdentity())

    def test_numpy_edits_all_points(self):
        lattice = self.lattice
        view = vtk_to_numpy(lattice.GetDisplacements())
        self.assertEqual(view.shape, (210, 3))
        grid = view.reshape(7, 5, 6, 3)
        grid[..., 2] += 3.0
        lattice.Modified()
        np.testing.assert_allclose(lattice.TransformPoint(15, 10, 5), (15, 10, 8))
        grid[3, 2, 4] = (1, 2, 3)
        displacement = [0.0] * 3
        lattice.GetDisplacement(4, 2, 3, displacement)
        self.assertEqual(displacement, [1.0, 2.0, 3.0])

        wave = np.zeros((7, 5, 6, 3), dtype=np.float32)
        wave[..., 1] = np.sin(np.arange(6))
        array = numpy_to_vtk(wave.reshape(-1, 3))
        self.assertEqual(lattice.SetDisplacements(array), 1)
        np.testing.assert_allclose(view, wave.reshape(-1, 3))

    def test_inverse(self):
        rng = np.random.default_rng(1)
        view = vtk_to_numpy(self.lattice.GetDisplacements())
        spacing = [0.0] * 3
        self.lattice.GetSpacing(spacing)
        view[:] = rng.uniform(-0.35, 0.35, view.shape) * spacing
        self.lattice.Modified()
        self.assertTrue(self.lattice.IsFoldFree())
        self.lattice.SetInverseTolerance(1e-9)
        inverse = self.lattice.GetInverse()
        for p in rng.uniform((-5, -5, -5), (35, 25, 15), (100, 3)):
            q = inverse.TransformPoint(*p)
            np.testing.assert_allclose(self.lattice.TransformPoint(q), p, atol=1.01e-9)

    def test_edits_of_an_inverse(self):
        """The first one, too, holds until the lattice is edited that it belongs to."""
        image = vtkImageData()
        source = vtkffd.vtkFFDLattice()
        source.SetDimensions(5, 5, 5)
        source.SetDisplacement(2, 2, 2, 0.1, 0.2, 0.3)
        self.assertEqual(source.ToImageData(image), 1)
        edits = {
            "SetDisplacement": lambda g: g.SetDisplacement(1, 1, 1, 7, 7, 7),
            "SetControlPoint": lambda g: g.SetControlPoint(1, 1, 1, 7, 7, 7),
            "SetDisplacements": lambda g: g.SetDisplacements(g.GetDisplacements()),
            "SetDimensions": lambda g: g.SetDimensions(9, 8, 7),
            "SetDomain": lambda g: g.SetDomain(0, 9, 0, 9, 0, 9),
            "FitToBounds": lambda g: g.FitToBounds((0, 9, 0, 9, 0, 9)),
            "Refine": lambda g: g.Refine(2, 2, 2),
            "Extend": lambda g: g.Extend(1),
            "Reset": lambda g: g.Reset(),
            "FromImageData": lambda g: g.FromImageData(image),
            "FitToTransform": lambda g: g.FitToTransform(source, (0, 9, 0, 9, 0, 9), 0.1, 4),
            "SetDisplacementScale": lambda g: g.SetDisplacementScale(0.5),
            "SetInverseTolerance": lambda g: g.SetInverseTolerance(0.25),
            "SetBorderMode": lambda g: g.SetBorderModeToZero(),
            "ShallowCopy": lambda g: g.ShallowCopy(source),
            "DeepCopy": lambda g: g.DeepCopy(source),
        }

        def look(g):
            return (g.GetDimensions(), g.GetDomain(), g.GetDisplacementScale(),
                    g.GetInverseTolerance(), g.GetBorderMode(),
                    vtk_to_numpy(g.GetDisplacements()).tolist())

        for name, edit in edits.items():
            with self.subTest(name):
                lattice = vtkffd.vtkFFDLattice()
                lattice.SetDimensions(6, 6, 6)
                lattice.SetDisplacement(2, 3, 2, 0.1, 0.0, 0.0)
                fresh, known = lattice.GetInverse(), vtkffd.vtkFFDLattice()
                known.DeepCopy(lattice)
                known.Inverse()
                edit(fresh)
                edit(known)
                self.assertEqual(look(fresh), look(known))
                self.assertEqual(fresh.GetInverseFlag(), known.GetInverseFlag())
                lattice.SetDisplacement(3, 3, 3, 0.2, 0.0, 0.0)
                self.assertEqual(look(fresh), look(lattice))

    def test_inverse_follows_edits_wherever_it_is_used(self):
        image = vtkImageData()
        image.SetDimensions(5, 5, 5)
        lattice = self.lattice
        inverse = lattice.GetInverse()
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(image)
        deform.SetLattice(inverse)
        keyframes = vtkffd.vtkFFDDeformVolume()
        keyframes.SetInputData(image)
        keyframes.AddKeyframe(0.0, inverse)
        total = vtkffd.vtkFFDSumTransform()
        total.AddTransform(inverse, 0.5)

        def read(item):
            found = vtkffd.vtkFFDLattice()
            self.assertEqual(found.ReadFrom(item), 1)
            return found

        def output(item):
            item.Update()
            return read(item.GetOutput())

        def attached():
            data = vtkImageData()
            inverse.AttachTo(data)
            return read(data)

        def as_image():
            data = vtkImageData()
            inverse.ToImageData(data)
            found = vtkffd.vtkFFDLattice()
            found.FromImageData(data)
            return found

        def copied(how):
            found = vtkffd.vtkFFDLattice()
            getattr(found, how)(inverse)
            return found

        p = (12.0, 9.0, 4.0)
        for step, (find) in enumerate((attached, as_image, lambda: copied("DeepCopy"),
                                       lambda: copied("ShallowCopy"), lambda: output(deform),
                                       lambda: output(keyframes), attached)):
            lattice.SetDisplacement(2, 2, 3, 1.0 + step, 0.5, 0.2)
            moved = find().TransformPoint(p)
            np.testing.assert_allclose(lattice.TransformPoint(moved), p, atol=2e-3)
            back = total.GetInverse().TransformPoint(p)
            np.testing.assert_allclose(total.TransformPoint(back), p, atol=2e-3)
        lattice.SetDimensions(7, 8, 9)
        self.assertEqual(inverse.GetDimensions(), (7, 8, 9))
        lattice.SetDisplacement(1, 1, 1, 9.0, 8.0, 7.0)
        self.assertEqual(list(inverse.GetDisplacements().GetTuple(1 + 7 * (1 + 8))), [9.0, 8.0, 7.0])

    def test_arrays_and_images_of_another_size(self):
        """Written behind the setters: an error, whatever is done with the lattice, and Reset() helps."""
        def array(change):
            return lambda lattice: change(lattice.GetDisplacements())

        def image(change):
            return lambda lattice: change(lattice.GetCoefficientData())

        for tamper in (array(lambda a: a.SetNumberOfTuples(5)), array(lambda a: a.SetNumberOfTuples(99999)),
                       array(lambda a: a.Initialize()), array(lambda a: a.SetNumberOfComponents(2)),
                       image(lambda i: i.SetDimensions(40, 40, 40)), image(lambda i: i.SetDimensions(2, 2, 2)),
                       image(lambda i: i.Initialize()), image(lambda i: i.SetExtent(5, 9, 0, 5, 0, 6))):
            lattice = vtkffd.vtkFFDLattice()
            lattice.SetDimensions(5, 6, 7)
            messages = catch_errors(lattice)
            tamper(lattice)
            lattice.Modified()
            for change in (lambda: lattice.Refine(2), lambda: lattice.Extend(1),
                           lambda: lattice.SetDimensions(6, 6, 6)):
                change()
                self.assertEqual(len(messages), 1, messages)
                self.assertIn("not usable", messages.pop())
            rep = vtkffd.vtkFFDLatticeRepresentation()
            rep.SetLattice(lattice)
            rep.SelectPoint(1, 1, 1)
            rep.TranslateSelection(1, 0, 0)
            rep.BuildRepresentation()
            deform = vtkffd.vtkFFDDeformVolume()
            other = vtkffd.vtkFFDLattice()
            other.SetDimensions(5, 6, 7)
            deform.AddObserver("ErrorEvent", lambda *_: None)
            deform.AddKeyframe(0.0, other)
            deform.AddKeyframe(1.0, lattice)
            deform.InterpolateKeyframes(0.5, vtkffd.vtkFFDLattice())
            messages.clear()
            lattice.Reset()
            self.assertEqual(lattice.Refine(2), 1)
            self.assertEqual(lattice.TransformPoint(0.2, 0.3, 0.4), (0.2, 0.3, 0.4))
            self.assertEqual(messages, [])

    def test_refine_keeps_the_shape(self):
        view = vtk_to_numpy(self.lattice.GetDisplacements())
        view[:] = np.random.default_rng(2).uniform(-2, 2, view.shape)
        self.lattice.Modified()
        before = self.lattice.TransformPoint(12.3, 4.5, 6.7)
        self.assertEqual(self.lattice.Refine(2), 1)
        self.assertEqual(self.lattice.GetDimensions(), (9, 7, 11))
        np.testing.assert_allclose(self.lattice.TransformPoint(12.3, 4.5, 6.7), before, atol=1e-12)

    def test_bounds(self):
        self.lattice.SetDisplacement(3, 2, 3, 0, 0, 4)
        bounds = [0.0] * 6
        self.lattice.GetDeformedBounds((0, 30, 0, 20, 0, 10), bounds)
        self.assertLess(bounds[0], 1e-6)
        self.assertGreaterEqual(bounds[5], 10.0)
        self.assertLess(bounds[5], 12.0)
        determinant = [0.0] * 2
        self.lattice.GetJacobianDeterminantBounds(determinant)
        self.assertLess(determinant[0], 1.0)
        self.assertGreater(determinant[1], 1.0)

    def test_travels_with_a_volume_through_a_file(self):
        self.lattice.SetDisplacement(3, 2, 3, 0.1, 0.2, 0.3)
        self.lattice.SetBorderModeToZero()
        volume = vtkImageData()
        volume.SetDimensions(4, 4, 4)
        self.assertFalse(vtkffd.vtkFFDLattice.HasLattice(volume))
        self.assertEqual(self.lattice.AttachTo(volume), 1)
        with tempfile.TemporaryDirectory(dir=os.environ.get("FFD_TEST_TEMPORARY")) as folder:
            name = os.path.join(folder, "volume.vti")
            writer = vtkXMLImageDataWriter()
            writer.SetFileName(name)
            writer.SetInputData(volume)
            self.assertEqual(writer.Write(), 1)
            reader = vtkXMLImageDataReader()
            reader.SetFileName(name)
            reader.Update()
        read = vtkffd.vtkFFDLattice()
        self.assertEqual(read.ReadFrom(reader.GetOutput()), 1)
        self.assertEqual(read.GetBorderModeAsString(), "Zero")
        np.testing.assert_array_equal(
            vtk_to_numpy(read.GetDisplacements()), vtk_to_numpy(self.lattice.GetDisplacements()))
        image = vtkImageData()
        self.assertEqual(self.lattice.ToImageData(image), 1)
        self.assertEqual(image.GetDimensions(), (6, 5, 7))
        other = vtkffd.vtkFFDLattice()
        self.assertEqual(other.FromImageData(image), 1)
        self.assertEqual(other.GetDimensions(), (6, 5, 7))
        vtkffd.vtkFFDLattice.DetachFrom(volume)
        self.assertFalse(vtkffd.vtkFFDLattice.HasLattice(volume))

    def test_lattices_that_are_not_whole(self):
        for name in ("Version", "Displacement"):
            volume = vtkImageData()
            volume.SetDimensions(4, 4, 4)
            self.lattice.AttachTo(volume)
            volume.GetFieldData().RemoveArray("FFDLattice." + name)
            self.assertTrue(vtkffd.vtkFFDLattice.HasLattice(volume))
            read = vtkffd.vtkFFDLattice()
            messages = catch_errors(read)
            self.assertEqual(read.ReadFrom(volume), 0)
            self.assertIn("FFDLattice.%s is missing" % name, messages[-1])
            # Not at rest without a word.
            deform = vtkffd.vtkFFDResampleVolume()
            deform.SetInputData(volume)
            deform_messages = catch_errors(deform)
            deform.Update()
            self.assertIn("FFDLattice.%s is missing" % name, deform_messages[-1])

    def test_fit_to_transform(self):
        transform = vtkTransform()
        transform.RotateZ(20)
        error = self.lattice.FitToTransform(transform, (0, 10, 0, 10, 0, 10), 0.01)
        self.assertGreaterEqual(error, 0.0)
        self.assertLess(error, 1e-10)
        np.testing.assert_allclose(
            self.lattice.TransformPoint(1, 2, 3), transform.TransformPoint(1, 2, 3), atol=1e-10)

    def test_copies(self):
        copy = vtkffd.vtkFFDLattice()
        copy.DeepCopy(self.lattice)
        copy.SetDisplacement(1, 1, 1, 1, 1, 1)
        self.assertTrue(self.lattice.IsIdentity())
        copy.ShallowCopy(self.lattice)
        copy.SetDisplacement(1, 1, 1, 1, 1, 1)
        self.assertFalse(self.lattice.IsIdentity())

    def test_errors_name_what_is_wrong(self):
        messages = catch_errors(self.lattice)
        for call, text in (
                (lambda: self.lattice.SetDimensions(3, 4, 4), "4 to 1024"),
                (lambda: self.lattice.SetDomain(1, 0, 0, 1, 0, 1), "inverted"),
                (lambda: self.lattice.SetDisplacement(0, 0, 0, math.nan, 0, 0), "finite"),
                (lambda: self.lattice.SetDisplacement(9, 0, 0, 0, 0, 0), "(9, 0, 0)"),
                (lambda: self.lattice.SetDisplacements(None), "null"),
                (lambda: self.lattice.ReadFrom(vtkImageData()), "missing")):
            call()
            self.assertEqual(len(messages), 1)
            self.assertIn(text, messages.pop())
        self.assertEqual(self.lattice.GetDimensions(), (6, 5, 7))
        self.assertTrue(self.lattice.IsIdentity())
        with self.assertRaises(TypeError):
            self.lattice.SetDimensions("a", 4, 4)

    def test_last_owner_frees_it_and_its_inverse(self):
        for owner in (vtkffd.vtkFFDResampleVolume, vtkffd.vtkFFDJacobian, vtkffd.vtkFFDDeformGeometry,
                      vtkffd.vtkFFDInverseRayVolumeMapper):
            with self.subTest(owner.__name__):
                image = vtkImageData()
                image.SetDimensions(5, 5, 5)
                image.AllocateScalars(3, 1)
                gone = []
                lattice = vtkffd.vtkFFDLattice()
                lattice.AddObserver("DeleteEvent", lambda *_, gone=gone: gone.append("lattice"))
                lattice.GetInverse().AddObserver(
                    "DeleteEvent", lambda *_, gone=gone: gone.append("inverse"))
                lattice.FitToBounds(image.GetBounds())
                lattice.SetDisplacement(1, 1, 1, 0.1, 0.0, 0.0)
                lattice.GetInverse().TransformPoint((1.0, 1.0, 1.0))
                user = owner()
                user.SetInputData(image)
                user.SetDeformation(lattice)
                if hasattr(user, "Update"):
                    user.Update()
                del lattice
                self.assertEqual(gone, [])
                del user
                self.assertEqual(sorted(gone), ["inverse", "lattice"])


if __name__ == "__main__":
    unittest.main()
