# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDVolumeSeries: volumes in time, interpolated, kept and read ahead."""

import os
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_SHORT
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkNIFTIImageWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
SIZE = (5, 6, 7)


def write(name, values, spacing="2 3 4", offset="1 2 3"):
    """A MetaImage of short numbers, which lies askew."""
    path = os.path.join(TEMPORARY, name)
    with open(path, "wb") as file:
        file.write(("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                    "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = %s\nElementSpacing = %s\n"
                    "DimSize = %d %d %d\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
                    % ((offset, spacing) + values.shape[::-1])).encode("ascii"))
        file.write(values.astype("<i2").tobytes())
    return path


def values_of(item):
    output = item.GetOutput()
    return vtk_to_numpy(output.GetPointData().GetScalars()).reshape(output.GetDimensions()[::-1])


def times_of(item):
    item.UpdateInformation()
    info = item.GetOutputInformation(0)
    key = item.GetExecutive().TIME_STEPS()
    return list(info.Get(key)) if info.Has(key) else []


class TestVolumeSeries(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(3)
        self.volumes = [random.integers(-900, 900, SIZE[::-1]) for _ in range(6)]
        self.files = [write("series%d.mha" % i, volume) for i, volume in enumerate(self.volumes)]

    def make(self, count=6, **options):
        item = vtkffd.vtkFFDVolumeSeries()
        self.errors = []
        item.AddObserver("ErrorEvent", self.note)
        for name in self.files[:count]:
            item.AddFileName(name)
        for name, value in options.items():
            getattr(item, "Set" + name)(value)
        return item

    def note(self, _caller, _event, message=""):
        self.errors.append(message)

    note.CallDataType = "string0"

    def test_one_volume(self):
        """As vtkFFDVolumeReader reads it, and without time."""
        item = self.make(count=1)
        item.Update()
        reader = vtkffd.vtkFFDVolumeReader()
        reader.SetFileName(self.files[0])
        reader.Update()
        np.testing.assert_array_equal(values_of(item), self.volumes[0])
        for get in ("GetOrigin", "GetSpacing", "GetExtent"):
            self.assertEqual(getattr(item.GetOutput(), get)(), getattr(reader.GetOutput(), get)())
        for output in (item.GetOutput(), reader.GetOutput()):
            self.assertEqual(output.GetDirectionMatrix().GetElement(0, 0), 0.0)
        self.assertEqual(times_of(item), [])
        self.assertEqual(item.GetNumberOfReads(), 1)

    def test_what_can_be_read(self):
        """Volumes, but no displacement fields."""
        volume = vtkImageData()
        volume.SetDimensions(4, 3, 2)
        volume.AllocateScalars(VTK_SHORT, 1)
        nifti = os.path.join(TEMPORARY, "series.nii")
        writer = vtkNIFTIImageWriter()
        writer.SetFileName(nifti)
        writer.SetInputData(volume)
        writer.Write()
        transforms = os.path.join(os.environ["FFD_TEST_DATA"], "Transforms")
        item = self.make()
        reader = vtkffd.vtkFFDVolumeReader()
        for name in (nifti, self.files[0]):
            self.assertEqual(item.CanReadFile(name), 1, name)
            self.assertEqual(reader.CanReadFile(name), 1, name)
        field = os.path.join(transforms, "field_oblique.nii.gz")
        self.assertEqual(item.CanReadFile(field), 0)
        self.assertEqual(reader.CanReadFile(field), 1)
        for name in (os.path.join(transforms, "euler.tfm"), "no_such_file.nii", None):
            self.assertEqual(item.CanReadFile(name), 0, name)
            self.assertEqual(reader.CanReadFile(name), 0, name)
        self.assertEqual(self.errors, [])

    def test_times(self):
        item = self.make(TimeStart=2.0, TimeSpacing=0.1)
        np.testing.assert_allclose(times_of(item), [2.0, 2.1, 2.2, 2.3, 2.4, 2.5])
        for step, time in enumerate(times_of(item)):
            item.UpdateTimeStep(time)
            np.testing.assert_array_equal(values_of(item), self.volumes[step])
        for time, step in ((-5.0, 0), (2.39, 3), (99.0, 5)):
            item.UpdateTimeStep(time)
            np.testing.assert_array_equal(values_of(item), self.volumes[step])

    def test_interpolation(self):
        item = self.make()
        item.SetInterpolationToLinear()
        item.UpdateTimeStep(1.3)
        expected = np.floor(0.7 * self.volumes[1] + 0.3 * self.volumes[2] + 0.5)
        self.assertLessEqual(np.abs(values_of(item) - expected).max(), 1)
        self.assertGreater((values_of(item) == expected).mean(), 0.95)
        scalars = item.GetOutput().GetPointData().GetScalars()
        self.assertTrue(scalars.GetInformation().Has(scalars.PER_COMPONENT()))
        self.assertEqual(scalars.GetRange(0), (values_of(item).min(), values_of(item).max()))
        # What is kept is not written to.
        for time in (1, 2):
            item.UpdateTimeStep(time)
            np.testing.assert_array_equal(values_of(item), self.volumes[time])

    def test_steps_that_lie_elsewhere(self):
        for offset, spacing in (("40 2 3", "2 3 4"), ("1 2 3", "2 3 5")):
            with self.subTest(offset=offset, spacing=spacing):
                self.files[1] = write("elsewhere.mha", self.volumes[1], spacing, offset)
                item = self.make()
                lattice = vtkffd.vtkFFDLattice()
                lattice.FitToBounds((-200, 200, -200, 200, -200, 200))
                resample = vtkffd.vtkFFDResampleVolume()
                resample.SetInputConnection(item.GetOutputPort())
                resample.SetDeformation(lattice)
                for step in (1, 0, 1, 2):
                    resample.UpdateTimeStep(step)
                    self.assertEqual(resample.GetOutput().GetOrigin(), item.GetOutput().GetOrigin())
                    self.assertEqual(resample.GetOutput().GetSpacing(), item.GetOutput().GetSpacing())
                    np.testing.assert_array_equal(values_of(resample), self.volumes[step])
                # There is nothing between voxels that lie elsewhere.
                item.SetInterpolationToLinear()
                item.UpdateTimeStep(2.5)
                self.assertFalse(self.errors)
                item.UpdateTimeStep(0.5)
                self.assertIn("lies elsewhere", self.errors[0])

    def test_interpolation_of_extreme_values(self):
        """The largest numbers of 64 bits became 0 or the least ones, and infinity not a number."""
        inf = np.inf
        for kind, before, after, expected in (
                ("u8", (2**64 - 1, 2**64 - 1, 100), (2**64 - 1, 0, 50), (2**64 - 1, 2**63, 75)),
                ("i8", (2**63 - 1, -2**63, 2**53 + 1), (2**63 - 1, -2**63, 2**53 + 1),
                 (2**63 - 1, -2**63, 2**53 + 1)),
                ("u1", (255, 0, 255), (255, 255, 0), (255, 128, 128)),
                ("f4", (inf, -inf, inf, 3), (inf, 1, 2, 4), (inf, -inf, inf, 3.5)),
                ("f8", (1e308, -inf), (-1e308, -inf), (0, -inf))):
            with self.subTest(kind):
                item = vtkffd.vtkFFDVolumeSeries()
                item.SetInterpolationToLinear()
                for name, values in (("before", before), ("after", after)):
                    image = vtkImageData()
                    image.SetDimensions(len(values), 2, 2)
                    scalars = numpy_to_vtk(np.tile(np.array(values, kind), 4), deep=True)
                    scalars.SetName("values")
                    image.GetPointData().SetScalars(scalars)
                    path = os.path.join(TEMPORARY, name + kind + ".vti")
                    writer = vtkXMLImageDataWriter()
                    writer.SetInputData(image)
                    writer.SetFileName(path)
                    writer.Write()
                    item.AddFileName(path)
                item.UpdateTimeStep(0.5)
                np.testing.assert_array_equal(values_of(item)[0, 0], np.array(expected, kind))

    def test_reads_ahead(self):
        """A player waits for two files; and then for none, also the second time."""
        item = self.make()
        item.UpdateTimeStep(0)
        item.WaitForPrefetch()
        self.assertEqual((item.GetNumberOfReads(), item.GetNumberOfReadsAhead()), (1, 0))
        item.UpdateTimeStep(1)
        item.WaitForPrefetch()
        self.assertEqual((item.GetNumberOfReads(), item.GetNumberOfReadsAhead()), (3, 1))
        for time in (2, 3, 4, 5, 0, 1, 2):
            item.UpdateTimeStep(time)
            np.testing.assert_array_equal(values_of(item), self.volumes[time])
        item.WaitForPrefetch()
        self.assertEqual((item.GetNumberOfReads(), item.GetNumberOfReadsAhead()), (6, 4))
        item.Reload()
        self.assertEqual(item.GetNumberOfReads(), 0)
        # Backwards.
        for time in (5, 4):
            item.UpdateTimeStep(time)
        item.WaitForPrefetch()
        self.assertEqual((item.GetNumberOfReads(), item.GetNumberOfReadsAhead()), (4, 1))
        os.remove(self.files[3])
        item.UpdateTimeStep(3)
        np.testing.assert_array_equal(values_of(item), self.volumes[3])
        # Off.
        item = self.make(count=3, Prefetch=0)
        for time in (0, 1, 2):
            item.UpdateTimeStep(time)
        item.WaitForPrefetch()
        self.assertEqual((item.GetNumberOfReads(), item.GetNumberOfReadsAhead()), (3, 0))

    def test_memory(self):
        """Beyond the limit steps are let go, and read again."""
        item = self.make(CacheSize=0, Prefetch=0)
        for time in (0, 1, 2, 3, 4, 5, 5, 4, 3, 0):
            item.UpdateTimeStep(time)
            np.testing.assert_array_equal(values_of(item), self.volumes[time])
        self.assertEqual(item.GetNumberOfReads(), 7)

    def test_parts(self):
        """Of several processes each has its part."""
        item = self.make()
        item.UpdateInformation()
        item.UpdateExtent([1, 3, 0, 5, 2, 4])
        self.assertEqual(item.GetOutput().GetExtent(), (1, 3, 0, 5, 2, 4))
        np.testing.assert_array_equal(values_of(item), self.volumes[0][2:5, :, 1:4])

    def test_a_file_that_comes_later(self):
        """As of a series that is still written: nothing is shown until it is there, then it is."""
        for ahead in (0, 1):
            late = os.path.join(TEMPORARY, "series_late.mha")
            if os.path.exists(late):
                os.remove(late)
            item = self.make(count=3, Prefetch=ahead)
            item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
            item.AddFileName(late)
            for step in range(3):
                item.UpdateTimeStep(step)
            for _ in range(2):
                item.UpdateTimeStep(3)
                self.assertIn("series_late.mha", self.errors.pop())
                self.assertEqual(item.GetOutput().GetNumberOfPoints(), 0)
                self.assertIsNone(item.GetOutput().GetPointData().GetScalars())
            write("series_late.mha", self.volumes[4])
            item.UpdateTimeStep(3)
            np.testing.assert_array_equal(values_of(item), self.volumes[4])
            self.assertFalse(self.errors)

    def test_errors(self):
        other = write("series_other.mha", self.volumes[0][:-1])
        for names, words in (((), "no file to read"), ((self.files[0], "no_such.mha"), "no_such.mha"),
                             ((self.files[0], other), "other numbers of voxels")):
            item = self.make(count=0)
            item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
            for name in names:
                item.AddFileName(name)
            item.UpdateTimeStep(1)
            self.assertEqual(len(self.errors), 1, self.errors)
            self.assertIn(words, self.errors[0])
        item = self.make()
        item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        item.Update()
        self.assertGreater(item.GetOutput().GetNumberOfPoints(), 0)
        item.RemoveAllFileNames()
        item.AddFileName("no_such.mha")
        item.Update()
        self.assertEqual(item.GetOutput().GetNumberOfPoints(), 0)
        item = self.make()
        item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        for interpolation in (item.STEP, item.LINEAR):
            item.SetInterpolation(interpolation)
            item.UpdateTimeStep(float("nan"))
        self.assertEqual(len(self.errors), 2)
        self.assertIn("not a number", self.errors[0])
        item = self.make(TimeStart=1e308, TimeSpacing=1e308)
        item.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        item.Update()
        self.assertEqual(len(self.errors), 1)
        self.assertIn("not finite", self.errors[0])
        self.assertEqual(item.GetOutput().GetNumberOfPoints(), 0)
        item = self.make()
        for name, value in (("TimeStart", float("nan")), ("TimeSpacing", -1.0)):
            before = getattr(item, "Get" + name)()
            getattr(item, "Set" + name)(value)
            self.assertEqual(getattr(item, "Get" + name)(), before)
        item.AddFileName("")
        self.assertEqual(len(self.errors), 3)
        self.assertEqual(item.GetFileName(0), self.files[0])
        self.assertIsNone(item.GetFileName(6))
        item.RemoveAllFileNames()
        self.assertEqual(item.GetNumberOfFileNames(), 0)


if __name__ == "__main__":
    unittest.main()
