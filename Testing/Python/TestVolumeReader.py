# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDVolumeReader: every voxel of every format is where the file says, in LPS; what cannot be
read is named."""

import gzip
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import unittest
import zlib

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject, vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkIOImage import vtkNIFTIImageWriter
from vtkmodules.vtkIOLegacy import vtkStructuredPointsWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

import ffdvolumefiles as files

WORK = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "VolumeReader")


class TestVolumeReader(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        os.makedirs(os.path.join(WORK, "empty"))
        files.write_meta(os.path.join(WORK, "turned.mha"))

    def read(self, name):
        reader = vtkffd.vtkFFDVolumeReader()
        reader.SetFileName(os.path.join(WORK, name))
        reader.Update()
        return reader

    def check_places(self, name, tolerance=1e-4):
        reader = self.read(name)
        self.assertEqual(reader.GetProblem(), "")
        image = reader.GetOutput()
        self.assertEqual(image.GetNumberOfPoints(), numpy.prod(files.SIZE))
        # What filters are told before they are given the data.
        info = reader.GetOutputInformation(0)
        numpy.testing.assert_allclose(info.Get(vtkImageData.ORIGIN()), image.GetOrigin())
        numpy.testing.assert_allclose(info.Get(vtkImageData.SPACING()), image.GetSpacing())
        matrix = image.GetDirectionMatrix()
        numpy.testing.assert_allclose(
            [info.Get(vtkImageData.DIRECTION(), n) for n in range(9)],
            [matrix.GetElement(n // 3, n % 3) for n in range(9)])
        scalars = vtk_to_numpy(image.GetPointData().GetScalars())
        values = files.voxels()
        for k, j, i in numpy.ndindex(values.shape):
            p = files.position(i, j, k)
            index = [0.0] * 3
            image.TransformPhysicalPointToContinuousIndex(p, index)
            nearest = [int(round(n)) for n in index]
            self.assertLess(numpy.abs(numpy.subtract(index, nearest)).max(), tolerance,
                            (name, i, j, k))
            point = image.ComputePointId(nearest)
            self.assertEqual(scalars[point], values[k, j, i], (name, i, j, k))
        return reader

    def test_nifti(self):
        for name, form in (("sform.nii", "sform"), ("sform.nii.gz", "sform"),
                           ("qform.nii.gz", "qform")):
            with self.subTest(name):
                files.write_nifti(os.path.join(WORK, name), form)
                self.check_places(name)
        files.write_nifti(os.path.join(WORK, "meters.nii"), "sform", 1000.0, 1)
        self.check_places("meters.nii")
        files.write_nifti(os.path.join(WORK, "microns.nii"), "qform", 0.001, 3)
        self.check_places("microns.nii", 1e-3)

    def test_nifti_values(self):
        """scl_slope and scl_inter, at 112 of the header; of colors, at 70, they say nothing."""
        path = os.path.join(WORK, "scaled.nii")
        files.write_nifti(path, "sform")
        with open(path, "rb") as file:
            plain = file.read()
        stored = files.voxels().ravel()
        nan = numpy.nan
        for slope, intercept, factor, offset in (
                (1.0, 0.0, 1, 0), (0.0, 5.0, 1, 0), (nan, nan, 1, 0), (1.0, -1024.0, 1, -1024),
                (0.25, 0.0, 0.25, 0), (-2.0, 3.0, -2, 3), (2.0, nan, 2, 0)):
            for kind, code, bits in (("<u2", 512, 16), (">f4", 16, 32), ("<i4", 8, 32)):
                with self.subTest((slope, intercept, kind)):
                    order = kind[0]
                    content = bytearray(plain[:352])
                    if order == ">":
                        for form, at, count in (("i", 0, 1), ("h", 40, 8), ("f", 76, 11),
                                                ("h", 252, 2), ("f", 256, 18)):
                            values = struct.unpack_from("<%d%s" % (count, form), content, at)
                            struct.pack_into(">%d%s" % (count, form), content, at, *values)
                    struct.pack_into(order + "2h", content, 70, code, bits)
                    struct.pack_into(order + "2f", content, 112, slope, intercept)
                    with open(path, "wb") as file:
                        file.write(content + stored.astype(kind).tobytes())
                    reader = self.read("scaled.nii")
                    self.assertEqual(reader.GetProblem(), "")
                    scalars = reader.GetOutput().GetPointData().GetScalars()
                    self.assertEqual(scalars.GetName(), "NIFTI")
                    numpy.testing.assert_array_equal(
                        vtk_to_numpy(scalars), factor * stored.astype(float) + offset)
                    # Filters are told the type before they are given the data.
                    info = vtkDataObject.GetActiveFieldInformation(
                        reader.GetOutputInformation(0), 0, 0)
                    self.assertEqual(info.Get(vtkDataObject.FIELD_ARRAY_TYPE()),
                                     scalars.GetDataType())

    def test_nrrd(self):
        for name, space, compressed in (("lps.nrrd", "left-posterior-superior", True),
                                        ("ras.nrrd", "right-anterior-superior", False),
                                        ("detached.nhdr", "left-posterior-superior", False)):
            with self.subTest(name):
                files.write_nrrd(os.path.join(WORK, name), space, compressed)
                self.check_places(name)

    def test_nrrd_of_either_byte_order(self):
        # VTK's reader turns the bytes of raw data alone.
        stored = files.voxels()
        path = os.path.join(WORK, "order.nrrd")
        for kind, name in (("u2", "unsigned short"), ("f4", "float"), ("f8", "double")):
            for order, endian in (("<", "little"), (">", "big")):
                for encoding, pack in (("raw", bytes), ("gzip", gzip.compress)):
                    with self.subTest((name, endian, encoding)):
                        header = ("NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\n"
                                  "endian: %s\nencoding: %s\n\n"
                                  % (name, *files.SIZE, endian, encoding))
                        with open(path, "wb") as file:
                            file.write(header.encode("ascii")
                                       + pack(stored.astype(order + kind).tobytes()))
                        image = self.read("order.nrrd").GetOutput()
                        numpy.testing.assert_array_equal(
                            vtk_to_numpy(image.GetPointData().GetScalars()), stored.ravel())

    def test_nrrd_after_all_of_vtk(self):
        # "import vtk" puts vtkPNrrdReader, which needs MPI, in the place of vtkNrrdReader.
        path = os.path.join(WORK, "all.nrrd")
        files.write_nrrd(path, "left-posterior-superior")
        result = subprocess.run(
            [sys.executable, "-c", "import sys, vtk, vtkffd\n"
             "reader = vtkffd.vtkFFDVolumeReader()\n"
             "reader.SetFileName(sys.argv[1])\n"
             "reader.Update()\n"
             "print(*reader.GetOutput().GetDimensions(), reader.GetProblem())", path],
            capture_output=True, text=True, check=True)
        self.assertEqual(result.stdout.split(), [str(n) for n in files.SIZE], result.stderr)

    def test_what_is_no_volume(self):
        """CanReadFile() prints nothing, also not what VTK's readers say of files of others."""
        heard = []
        window = vtkOutputWindow.GetInstance()
        tags = [window.AddObserver(event, lambda *_: heard.append(event))
                for event in ("ErrorEvent", "WarningEvent")]
        reader = vtkffd.vtkFFDVolumeReader()
        for ending in ("tga", "txt", "vti", "vtk", "mhd", "nii", "nrrd", "png", "dcm"):
            path = os.path.join(WORK, "other." + ending)
            for content in (b"", b"A text that is no volume, whatever its name says. " * 20):
                with open(path, "wb") as file:
                    file.write(content)
                self.assertEqual(reader.CanReadFile(path), 0, path)
        for tag in tags:
            window.RemoveObserver(tag)
        self.assertEqual(heard, [])

    def test_metaimage(self):
        self.check_places("turned.mha")

    def test_dicom(self):
        for downward in (False, True):
            name = "dicom%d" % downward
            files.write_dicom(os.path.join(WORK, name), downward=downward)
            self.check_places(name)
        # One of the slices is its folder.
        self.assertEqual(vtkffd.vtkFFDVolumeReader().CanReadFile(os.path.join(WORK, name, "IM0002")), 1)
        self.check_places(os.path.join(name, "IM0002"))

    def test_slices_that_do_not_fit(self):
        """VTK's reader copies as many voxels of each slice as the first has, and tells no gap."""
        def change(path):
            with open(path, "rb") as file:
                content = file.read()
            tag = b"\x28\0\x10\0"
            at = content.index(tag) + (8 if content[content.index(tag) + 4:][:2] == b"US" else 8)
            rows = struct.unpack_from("<H", content, at)[0]
            with open(path, "wb") as file:
                file.write(content[:at] + struct.pack("<H", rows + 40) + content[at + 2:])

        def cut(path):
            os.truncate(path, os.path.getsize(path) - 1)

        def unname(path):
            """The name of its series has no bytes: VTK's reader threw an exception."""
            with open(path, "rb") as file:
                content = file.read()
            with open(path, "wb") as file:
                file.write(re.sub(rb"(\x20\0\x0e\0UI)..", rb"\1\0\0", content, flags=re.DOTALL))

        def cut_header(path):
            """VTK's reader crashed."""
            os.truncate(path, 557)

        def cut_pixels(path):
            """At the end of an element; the slice showed what the memory held."""
            with open(path, "rb") as file:
                os.truncate(path, file.read().index(b"\xe0\x7f\x10\0"))

        def replacing(old, new):
            def act(path):
                with open(path, "rb") as file:
                    content = file.read()
                self.assertIn(old, content)
                with open(path, "wb") as file:
                    file.write(content.replace(old, new))
            return act

        # VTK's reader crashed of the first three, and wrote real numbers where it had memory for whole
        # ones of the last.
        empty = replacing(b"\x18\0\x50\0DS\4\0002.5 ", b"\x18\0\x50\0DS\0\0")  # Slice Thickness may be
        # What follows is no length.
        damage_type = replacing(b"\x18\0\x50\0DS\4\0", b"\x18\0\x50\0D\x99\4\x96")
        # There is no such element, and it is out of order.
        rename_columns = replacing(b"\x28\0\x11\0US", b"\0\0\x11\0US")
        # The length has four bytes then, as in files of some scanners.
        leave_out_type = replacing(b"\x18\0\x50\0DS\4\0", b"\x18\0\x50\0\4\0\0\0")
        rescale = replacing(b"\x28\0\x53\x10DS\2\0001 ", b"\x28\0\x53\x10DS\4\0000.5 ")

        for number, (act, problem, warnings) in enumerate((
                (damage_type, "is not whole", 0), (leave_out_type, "", 0),
                (rename_columns, "lacks Rows (0028,0010), Columns", 0),
                (rescale, "differ in whether Rescale Slope", 0),
                (cut_header, "is not whole", 0), (cut_pixels, "has no pixels", 0),
                (empty, "no value of Slice Thickness", 0), (lambda path: None, "", 0), (os.remove, "", 1), (cut, "is not whole", 0),
                (change, "slices of one size", 0), (unname, "the slice 'IM0005' ", 0))):
            folder = os.path.join(WORK, "slices%d" % number)
            files.write_dicom(folder)
            act(os.path.join(folder, sorted(os.listdir(folder))[4]))
            reader = vtkffd.vtkFFDVolumeReader()
            told = []
            reader.AddObserver("ErrorEvent", lambda *_: None)
            reader.AddObserver("WarningEvent", lambda *_, told=told: told.append(True))
            reader.SetFileName(folder)
            reader.Update()
            self.assertIn(problem, reader.GetProblem())
            self.assertEqual((problem == "", warnings), (reader.GetProblem() == "", len(told)), folder)

    def test_image_data(self):
        reader = self.read("turned.mha")
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(reader.GetOutput())
        writer.SetFileName(os.path.join(WORK, "turned.vti"))
        writer.Write()
        self.check_places("turned.vti")
        legacy = vtkStructuredPointsWriter()
        legacy.SetInputData(reader.GetOutput())
        legacy.SetFileName(os.path.join(WORK, "legacy.vtk"))
        legacy.Write()
        self.assertEqual(self.read("legacy.vtk").GetOutput().GetDimensions(), files.SIZE)

    def test_ranges(self):
        """Arrays know their ranges, those that VTK finds, without being asked."""
        random = numpy.random.default_rng(5)
        image = vtkImageData()
        image.SetDimensions(7, 9, 5)
        count = image.GetNumberOfPoints()
        odd = random.normal(size=count)
        odd[[3, 200, 314]] = numpy.nan, numpy.inf, -numpy.inf
        arrays = {"bytes": random.integers(3, 250, count).astype(numpy.uint8),
                  "shorts": random.integers(-900, 900, count).astype(numpy.int16),
                  "long": random.integers(-2**40, 2**40, count),
                  "floats": random.normal(size=count).astype(numpy.float32),
                  "odd": odd,
                  "vectors": random.normal(size=(count, 3)),
                  "nothing": numpy.full(count, numpy.nan)}
        for name, values in arrays.items():
            array = numpy_to_vtk(values, deep=True)
            array.SetName(name)
            image.GetPointData().AddArray(array)
        image.GetPointData().SetActiveScalars("bytes")
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(image)
        writer.SetDataModeToBinary()
        writer.SetFileName(os.path.join(WORK, "ranges.vti"))
        writer.Write()
        read = self.read("ranges.vti").GetOutput().GetPointData()
        for name in arrays:
            found, alone = read.GetArray(name), image.GetPointData().GetArray(name)
            keys = (found.PER_COMPONENT(), found.PER_FINITE_COMPONENT())
            self.assertEqual([found.GetInformation().Has(key) for key in keys],
                             [int(name != "nothing")] * 2, name)
            for c in range(found.GetNumberOfComponents()):
                self.assertEqual(found.GetRange(c), alone.GetRange(c), name)
                self.assertEqual(found.GetFiniteRange(c), alone.GetFiniteRange(c), name)
            # No longer those that were kept.
            found.SetComponent(0, 0, 255.0)
            found.Modified()
            self.assertGreaterEqual(found.GetRange(0)[1], 255.0, name)

    def test_what_cannot_be_read(self):
        with open(os.path.join(WORK, "bad.vti"), "w", encoding="ascii") as file:
            file.write("this is no XML")
        with open(os.path.join(WORK, "text.txt"), "w", encoding="ascii") as file:
            file.write("words")
        files.write_dicom(os.path.join(WORK, "jpeg"), "1.2.840.10008.1.2.4.70")
        # VTK's own reader never comes back from these.
        files.write_nrrd(os.path.join(WORK, "body.nhdr"), "left-posterior-superior")
        with open(os.path.join(WORK, "body.nhdr"), "rb") as file:
            header = file.read()
        vector = (b"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 2 2\n"
                  b"space directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n" + bytes(24))
        # What a download leaves that went wrong.
        for name, content in (("zero.nhdr", header.replace(b"kinds", b"kin\0s")),
                              ("endless.nhdr", header.rstrip()),
                              # VTK's own reader crashes of these.
                              ("capital.nrrd", vector.replace(b"dimension: 4", b"Dimension: 4")),
                              ("late.nrrd", vector.replace(b"dimension: 4\nsizes: 3 2 2 2",
                                                           b"sizes: 3 2 2 2\ndimension: 4")),
                              ("page.nii.gz", b"<!DOCTYPE html>"), ("page.nrrd", b"<!DOCTYPE html>"),
                              ("bytes.vtk", b"\x89\xd0\xff\n\xfe"), ("nothing.mha", b"")):
            with open(os.path.join(WORK, name), "wb") as file:
                file.write(content)
        cases = (("missing.nii", "no such file"), ("bad.vti", "cannot be read"),
                 ("text.txt", "no reader"), ("empty", "no DICOM slices"),
                 ("page.nii.gz", "not what '.nii.gz' says"), ("page.nrrd", "not what '.nrrd' says"),
                 ("bytes.vtk", "not what '.vtk' says"), ("nothing.mha", "it is empty"),
                 ("capital.nrrd", "'dimension' and 'sizes' in this order"),
                 ("late.nrrd", "'dimension' and 'sizes' in this order"), ("zero.nhdr", "zero bytes"), ("endless.nhdr", "does not end"),
                 ("jpeg", "compressed (transfer syntax 1.2.840.10008.1.2.4.70)"),
                 (os.path.join(os.environ["FFD_TEST_DATA"], "Baseline",
                               "TestImageDeformedHead.png"), "300 x 300 x 1 voxels"))
        for name, text in cases:
            reader = vtkffd.vtkFFDVolumeReader()
            told = []
            reader.AddObserver("ErrorEvent", lambda *_: told.append(True))
            # Nothing of what was read before is left.
            reader.SetFileName(os.path.join(WORK, "turned.mha"))
            reader.Update()
            self.assertGreater(reader.GetOutput().GetNumberOfPoints(), 0)
            reader.SetFileName(os.path.join(WORK, name))
            reader.Update()
            self.assertIn(text, reader.GetProblem())
            self.assertEqual(len(told), 1, name)
            self.assertEqual(reader.GetOutput().GetNumberOfPoints(), 0)
            reader.SetFileName(os.path.join(WORK, "turned.mha"))
            reader.Update()
            self.assertEqual(reader.GetProblem(), "")
            self.assertGreater(reader.GetOutput().GetNumberOfPoints(), 0)
    def test_data_files(self):
        """VTK's readers wait for pipes, read to the end of what has none, and leave memory as it is
        where MetaImage names what is not there."""
        values = files.voxels()
        for k, plane in enumerate(values):
            plane.tofile(os.path.join(WORK, "slice%d.raw" % k))
        values.tofile(os.path.join(WORK, "whole.raw"))
        values[1:].tofile(os.path.join(WORK, "short.raw"))
        os.mkfifo(os.path.join(WORK, "pipe.raw"))
        os.mkfifo(os.path.join(WORK, "pipe.nii"))
        os.makedirs(os.path.join(WORK, "pipes"))
        os.mkfifo(os.path.join(WORK, "pipes", "slice"))
        slices = "".join("slice%d.raw\n" % k for k in range(len(values)))
        size = "%d %d %d" % files.SIZE
        # What is there is read, by name, in slices, with something in front of it.
        cases = [("whole.raw", ""), ("slice%d.raw 0 9 1", ""), ("slice%d.raw 0", ""),
                 ("LIST\n" + slices, ""), (os.path.join(WORK, "whole.raw"), ""),
                 ("short.raw", "fewer bytes"), ("pipe.raw", "no regular file"),
                 ("none.raw", "cannot be opened"), ("slice%d.raw 1 10 1", "'slice10.raw'"),
                 ("slice%d.raw 0 9 0", "names no file"), ("slice%s%n.raw 0 9 1", "names no file"),
                 ("LIST\nslice0.raw\n", "names no file"), ("LISTED.raw", "list of files"),
                 ("LIST 3\nwhole.raw\n", "list of files"), ("LOCAL\n" + 9 * "x", "fewer bytes")]
        content = {"data%d.mhd" % n: ("ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = %s\n"
                                      "ElementType = MET_USHORT\nElementDataFile = %s\n"
                                      % (size, data), problem)
                   for n, (data, problem) in enumerate(cases)}
        nrrd = ("NRRD0004\ntype: unsigned short\ndimension: 3\nsizes: %s\nendian: little\n"
                "encoding: raw\ndata file: " % size)
        for n, (data, problem) in enumerate((("whole.raw", ""), ("slice%d.raw 0 9 1", ""),
                                             ("LIST\n" + slices, ""),
                                             ("slice%s%n.raw 0 9 1", "no pattern"),
                                             ("pipe.raw", "no regular file"))):
            content["data%d.nhdr" % n] = nrrd + data + "\n", problem
        for name, (text, problem) in content.items():
            with open(os.path.join(WORK, name), "w", encoding="ascii") as file:
                file.write(text)
        content.update({"pipe.nii": ("", "no regular file"), "pipes": ("", "no regular file"),
                        "endless.mha": ("", "not what")})
        with open(os.path.join(WORK, "endless.mha"), "wb") as file:
            file.truncate(1 << 40)
        signal.alarm(60)  # instead of waiting for ever
        for name, (_, problem) in content.items():
            reader = vtkffd.vtkFFDVolumeReader()
            reader.AddObserver("ErrorEvent", lambda *_: None)
            reader.SetFileName(os.path.join(WORK, name))
            reader.Update()
            self.assertIn(problem, reader.GetProblem(), name)
            self.assertEqual(problem == "", reader.GetProblem() == "", name)
            if not problem:
                scalars = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
                numpy.testing.assert_array_equal(scalars, values.ravel(), name)
        signal.alarm(0)
        os.remove(os.path.join(WORK, "endless.mha"))

    def check_contents(self, cases):
        """Files by name: what is in them, and the problem with it, or the array and the spacing."""
        signal.alarm(60)  # instead of waiting for ever
        for name, (content, problem, *read) in cases.items():
            with self.subTest(name):
                with open(os.path.join(WORK, name), "wb") as file:
                    file.write(content)
                reader = vtkffd.vtkFFDVolumeReader()
                reader.AddObserver("ErrorEvent", lambda *_: None)
                reader.AddObserver("WarningEvent", lambda *_: None)
                reader.SetFileName(os.path.join(WORK, name))
                reader.Update()
                self.assertIn(problem, reader.GetProblem())
                self.assertEqual(problem == "", reader.GetProblem() == "")
                if not problem:
                    image = reader.GetOutput()
                    values, spacing = read
                    scalars = vtk_to_numpy(image.GetPointData().GetScalars())
                    numpy.testing.assert_array_equal(scalars.ravel(), values.ravel())
                    self.assertEqual(image.GetPointData().GetScalars().GetNumberOfComponents(),
                                     scalars.size // image.GetNumberOfPoints())
                    self.assertEqual(image.GetDimensions(), (5, 4, 3))
                    self.assertEqual(image.GetSpacing(), spacing)
        signal.alarm(0)

    def test_encodings_of_nrrd(self):
        """Numbers as text and what is short, damaged or no size, of which VTK's reader makes voxels of
        what the memory held; small first sizes and four axes, of which it makes other volumes."""
        values = numpy.arange(60, dtype="<i2").reshape(3, 4, 5)
        plain = values.tobytes()
        packed = gzip.compress(plain)
        text = b", ".join(b"%d" % v for v in values.ravel())
        three = numpy.repeat(values.ravel(), 3)
        spaced = "space: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3)\n"
        steps = (1.0, 2.0, 3.0)

        def header(encoding, more=spaced, sizes="5 4 3", dimension=3, kind="short"):
            return ("NRRD0004\ntype: %s\ndimension: %d\n%ssizes: %s\nendian: little\nencoding: %s\n\n"
                    % (kind, dimension, more, sizes, encoding)).encode()

        first = "space: LPS\nspace directions: none (1,0,0) (0,2,0) (0,0,3)\n"
        last = "space: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3) none\n"
        cases = {
            "raw.nrrd": (header("raw") + plain, "", values, steps),
            "packed.nrrd": (header("gzip") + packed, "", values, steps),
            "members.nrrd": (header("gz") + gzip.compress(plain[:9]) + gzip.compress(plain[9:]), "",
                             values, steps),
            "text.nrrd": (header("ascii") + text, "", values, steps),
            "capitals.nrrd": (header("raw").replace(b"space directions", b"Space Directions") + plain, "",
                              values, steps),
            "spacings.nrrd": (header("raw", "spacings: 1 2 3\n") + plain, "", values, steps),
            "first.nrrd": (header("raw", first, "3 5 4 3", 4) + three.tobytes(), "", three, steps),
            "last.nrrd": (header("gzip", last, "5 4 3 2", 4) + gzip.compress(plain + plain), "", values,
                          steps),
            "singular.nrrd": (header("raw", spaced.replace("0,2,0", "0,0,0")) + plain, "", values,
                              (1.0, 1.0, 3.0)),
            "nan.nrrd": (header("raw", spaced.replace("0,2,0", "0,nan,0")) + plain, "", values,
                         (1.0, 1.0, 3.0)),
            "short.nrrd": (header("raw") + plain[:-1], "fewer bytes"),
            "short_packed.nrrd": (header("gzip") + gzip.compress(plain[:-1]), "119 bytes, 120 are needed"),
            "cut.nrrd": (header("gzip") + packed[:-12], "are needed"),
            "damaged.nrrd": (header("gzip") + b"x" * 90, "damaged"),
            "short_text.nrrd": (header("ascii") + b"1 2 3", "3 numbers, 60 are needed"),
            "words.nrrd": (header("ascii") + b"words", "0 numbers"),
            "large.nrrd": (header("ascii") + b"70000 " * 60, "does not hold"),
            "none.nhdr": (header("raw")[:-1], "names no data file"),
            "zero.nrrd": (header("raw", sizes="5 0 3") + plain, "'5 0 3'"),
            "negative.nrrd": (header("raw", sizes="5 -4 3") + plain, "'5 -4 3'"),
            "few.nrrd": (header("raw", sizes="5 4") + plain, "'5 4'"),
            "many.nrrd": (header("gzip", sizes="65537 65537 2", kind="uint8") + gzip.compress(b"0" * 262146),
                          "8590196738 are needed"),
            "half.nrrd": (header("raw", kind="half") + plain, "does not know its type 'half'")}
        self.check_contents(cases)

    def test_encodings_of_metaimage(self):
        """What is short or damaged, of which VTK's reader makes voxels of what the memory held."""
        values = numpy.arange(60, dtype="<i2").reshape(3, 4, 5)
        packed = zlib.compress(values.tobytes())
        text = b" ".join(b"%d" % v for v in values.ravel())
        steps = (1.0, 2.0, 3.0)

        def header(more, binary=True, size="5 4 3", spacing="1 2 3"):
            return ("ObjectType = Image\nNDims = 3\nBinaryData = %s\n%sDimSize = %s\nElementSpacing = %s\n"
                    "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
                    % (binary, more, size, spacing)).encode()

        true = "CompressedData = True\n"
        self.check_contents({
            "packed.mha": (header(true + "CompressedDataSize = %d\n" % len(packed)) + packed, "", values,
                           steps),
            "no_size.mha": (header(true) + packed, "", values, steps),
            "big.mha": (header(true + "BinaryDataByteOrderMSB = True\n")
                        + zlib.compress(values.astype(">i2").tobytes()), "", values, steps),
            "text.mha": (header("", False) + text, "", values, steps),
            "zero.mha": (header("", spacing="1 0 3") + values.tobytes(), "", values, (1.0, 1.0, 3.0)),
            "cut.mha": (header(true) + packed[:-9], "are needed"),
            "damaged.mha": (header(true) + b"x" * 90, "damaged"),
            "short.mha": (header(true) + zlib.compress(b"12345"), "5 bytes, 120 are needed"),
            "short_text.mha": (header("", False) + b"1 2 3", "3 numbers, 60 are needed"),
            "large_text.mha": (header("", False, "2000 2000 2000") + b"1 2 3", "3 numbers, 8000000000"),
            "no_channels.mha": (header("ElementNumberOfChannels = 0\n") + values.tobytes(),
                                "ElementNumberOfChannels"),
            # VTK's reader fills arrays of ten numbers by as many: it did not end, or crashed.
            "dimensions.mha": (header("").replace(b"NDims = 3", b"NDims = 4294967297") + values.tobytes(),
                               "a volume has 3 dimensions"),
            "more.mha": (header("NDims = 4000\n") + values.tobytes(), "a volume has 3 dimensions"),
            "broken.mha": (header("").replace(b"NDims = 3", b"NDims =\n99999") + values.tobytes(),
                           "a volume has 3 dimensions"),
            "no_data.mha": (header("").replace(b"ElementDataFile", b"ElementData"), "no ElementDataFile")})

    def test_files_of_vtk_that_are_not_whole(self):
        """VTK's readers make voxels of what the memory held, and an image without scalars ended the program."""
        values = numpy.arange(60, dtype="<i2").reshape(3, 4, 5)
        image = vtkImageData()
        image.SetDimensions(5, 4, 3)
        image.SetSpacing(1.0, 2.0, 3.0)
        scalars = numpy_to_vtk(values.ravel(), deep=True)
        scalars.SetName("scalars")
        image.GetPointData().SetScalars(scalars)

        def write(writer, name, *options):
            writer.SetInputData(image)
            writer.SetFileName(os.path.join(WORK, name))
            for option in options:
                getattr(writer, option)()
            writer.Write()
            with open(os.path.join(WORK, name), "rb") as file:
                return file.read()

        xml = write(vtkXMLImageDataWriter(), "whole.vti", "SetDataModeToAppended", "EncodeAppendedDataOff",
                    "SetCompressorTypeToNone")
        text = write(vtkXMLImageDataWriter(), "text.vti", "SetDataModeToAscii")
        legacy = write(vtkStructuredPointsWriter(), "whole.vtk", "SetFileTypeToBinary")
        words = write(vtkStructuredPointsWriter(), "words.vtk", "SetFileTypeToASCII")
        image.GetPointData().RemoveArray("scalars")
        bare = write(vtkXMLImageDataWriter(), "bare.vti")
        no_origin = re.sub(rb"ORIGIN [^\n]*\n", b"", re.sub(rb"SPACING [^\n]*\n", b"SPACING 1 0 3\n", words))
        steps = (1.0, 2.0, 3.0)
        self.check_contents({
            "whole.vti": (xml, "", values, steps), "whole.vtk": (legacy, "", values, steps),
            "words.vtk": (words, "", values, steps), "no_origin.vtk": (no_origin, "", values, (1.0, 1.0, 3.0)),
            "cut.vti": (xml[:-120], "it is not whole"), "cut.vtk": (legacy[:-99], "fewer than its header says"),
            "cut_words.vtk": (words[:-99], "fewer than its header says"),
            "bare.vti": (bare, "no image with point scalars"),
            "bare.vtk": (legacy[:legacy.index(b"POINT_DATA")], "no image with point scalars"),
            "type.vti": (text.replace(b'type="Int16"', b'type="Foo"'), "no image with point scalars")})

    def test_errors_that_a_program_does_not_want_to_see(self):
        """VTK tells of a file that is cut off by an error, of which there is no event where
        GlobalWarningDisplayOff() has been called: voxels were what the memory held."""
        values = numpy.random.default_rng(1).integers(0, 1000, 8000)
        image = vtkImageData()
        image.SetDimensions(20, 20, 20)
        image.GetPointData().SetScalars(numpy_to_vtk(values.astype("i2"), deep=True))
        path = os.path.join(WORK, "cut.nii.gz")
        writer = vtkNIFTIImageWriter()
        writer.SetInputData(image)
        writer.SetFileName(path)
        writer.Write()
        os.truncate(path, os.path.getsize(path) // 2)
        vtkObject.GlobalWarningDisplayOff()
        try:
            self.assertIn("truncated", self.read("cut.nii.gz").GetProblem())
            self.assertEqual(vtkObject.GetGlobalWarningDisplay(), 0)
        finally:
            vtkObject.GlobalWarningDisplayOn()

    def test_headers_of_nifti(self):
        """A type that VTK's reader crashes on, and voxels that begin in the header."""
        values = numpy.arange(60, dtype="<i2").reshape(3, 4, 5)

        def header(kind=4, start=352.0, spacing=2.0):
            content = bytearray(352)
            struct.pack_into("<i", content, 0, 348)
            struct.pack_into("<8h", content, 40, 3, 5, 4, 3, 1, 1, 1, 1)
            struct.pack_into("<2h", content, 70, kind, 16)
            struct.pack_into("<4f", content, 76, 1.0, 1.0, spacing, 3.0)
            struct.pack_into("<f", content, 108, start)
            content[344:348] = b"n+1\0"
            return bytes(content)

        data = values.tobytes()
        self.check_contents({
            "plain.nii": (header() + data, "", values, (1.0, 2.0, 3.0)),
            "packed.nii.gz": (gzip.compress(header() + data), "", values, (1.0, 2.0, 3.0)),
            "quad.nii": (header(1536) + 8 * data, "NIfTI type 1536"),
            "quad.nii.gz": (gzip.compress(header(1536) + 8 * data), "NIfTI type 1536"),
            "bits.nii": (header(1) + data, "NIfTI type 1,"),
            "inside.nii": (header(start=0.0) + data, "byte 0 (vox_offset)"),
            "nowhere.nii": (header(start=math.nan) + data, "byte nan (vox_offset)")})

    def test_nifti_sform_of_zeros(self):
        """The qform is taken where there is one, without a warning."""
        for sform in (0.0, math.nan):
            files.write_nifti(os.path.join(WORK, "qform.nii"), "qform")
            with open(os.path.join(WORK, "qform.nii"), "r+b") as file:
                file.seek(254)
                file.write(struct.pack("<h", 1))
                file.seek(280)
                file.write(struct.pack("<12f", *[sform] * 12))
            self.check_places("qform.nii")

    def test_axis_mins_of_nrrd(self):
        """The origin of old NRRD files, of cells or nodes; "space origin" goes before it. Fields have several
        names, words of the format are the same in capital letters, and key/value pairs are no fields."""
        values = numpy.arange(60, dtype="<i2").reshape(3, 4, 5)

        def origin(*lines, sizes="5 4 3", data=values):
            count = len(sizes.split())
            with open(os.path.join(WORK, "mins.nrrd"), "wb") as file:
                file.write(("NRRD0001\ntype: short\ndimension: %d\nsizes: %s\nencoding: raw\n"
                            "endian: little\n%s\n\n" % (count, sizes, "\n".join(lines)))
                           .encode("ascii") + data.tobytes())
            image = self.read("mins.nrrd").GetOutput()
            self.assertEqual(image.GetDimensions(), (5, 4, 3))
            return tuple(image.GetSpacing()), tuple(image.GetOrigin())

        spacings, mins = "spacings: 2 3 4", "axis mins: -10 20 30"
        cells, nodes = (-9.0, 21.5, 32.0), (-10.0, 20.0, 30.0)
        self.assertEqual(origin(spacings, mins), ((2, 3, 4), cells))
        self.assertEqual(origin(spacings, mins, "centers: cell cell cell"), ((2, 3, 4), cells))
        self.assertEqual(origin(spacings, mins, "centers: node node node"), ((2, 3, 4), nodes))
        self.assertEqual(origin(mins, "centerings: node node node"), ((1, 1, 1), nodes))
        self.assertEqual(origin(spacings, "axis mins: nan 20 NaN"), ((2, 3, 4), (0.0, 21.5, 0.0)))
        self.assertEqual(origin(spacings, mins, "space dimension: 3", "space origin: (7,8,9)"),
                         ((2, 3, 4), (7.0, 8.0, 9.0)))
        self.assertEqual(origin(spacings, mins, "Centers: Node NODE node"), ((2, 3, 4), nodes))
        self.assertEqual(origin(spacings, mins, "SpaceDimension: 3", "SpaceOrigin: (7,8,9)"),
                         ((2, 3, 4), (7.0, 8.0, 9.0)))
        self.assertEqual(origin("SpaceDirections: (2,0,0) (0,3,0) (0,0,4)", "space: LPS", "space origin: (7,8,9)"),
                         ((2, 3, 4), (7.0, 8.0, 9.0)))
        self.assertEqual(origin(spacings, mins, "space origin:=(7,8,9)"), ((2, 3, 4), cells))
        self.assertEqual(origin(spacings + " 1", mins + " 0", "kinds: Space Space Space Time", sizes="5 4 3 2",
                                data=numpy.stack([values, values])), ((2, 3, 4), cells))
        two = numpy.repeat(values[..., None], 2, 3)
        self.assertEqual(origin("spacings: NaN 2 3 4", "axis mins: NaN -10 20 30",
                                "centers: ??? node node node", sizes="2 5 4 3", data=two),
                         ((2, 3, 4), nodes))

    def test_unknown_fields_of_nrrd(self):
        """A misspelled field is left out, which a warning tells."""
        start = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 2 2\n# a comment: text\nkey:=value\n"
        for fields, expected in (
                ("space: LPS\nSpace Origin: (1,2,3)\nencoding: raw\n\n", None),
                ("space: LPS\nspcae origin: (1,2,3)\nencoding: raw\n\n", "'spcae origin'"),
                ("encoding: raw\ndata file: LIST\n./a:1.raw\n./a:2.raw\n", None)):
            name = os.path.join(WORK, "unknown.nrrd")
            for part in ("a:1.raw", "a:2.raw"):
                with open(os.path.join(WORK, part), "wb") as file:
                    file.write(bytes(20))
            with open(name, "wb") as file:
                file.write((start + fields).encode("ascii"))
                file.write(bytes(40) if fields.endswith("\n\n") else b"")
            told = []

            def tell(_reader, _event, message, told=told):
                told.append(message)
            tell.CallDataType = "string0"
            reader = vtkffd.vtkFFDVolumeReader()
            reader.AddObserver("WarningEvent", tell)
            reader.SetFileName(name)
            reader.Update()
            self.assertEqual((reader.GetProblem(), len(told)), ("", 0 if expected is None else 1))
            if expected is not None:
                self.assertIn(expected, told[0])

    def test_long_of_metaimage(self):
        """It has four bytes, as in MetaIO; VTK's reader takes it for eight."""
        values = numpy.arange(-5, 55).reshape(3, 4, 5)

        def content(kind, data, extra=""):
            return ("ObjectType = Image\nNDims = 3\nBinaryData = %s\nBinaryDataByteOrderMSB = False\n"
                    "%sElementSpacing = 1 2 3\nDimSize = 5 4 3\nElementType = %s\n"
                    "ElementDataFile = LOCAL\n" % ("False" if extra == "text" else "True",
                                                   "" if extra == "text" else extra,
                                                   kind)).encode("ascii") + data

        small = values.astype("<i4")
        packed = zlib.compress(small.tobytes())
        words = " ".join(str(value) for value in values.ravel()).encode("ascii")
        whole = values - values.min() + 2**31
        wide = content("MET_LONG", b"").replace(b"LOCAL", b"long%d.raw 0 2 1")
        for k in range(3):
            small[k].tofile(os.path.join(WORK, "long%d.raw" % k))
        self.check_contents({
            "long.mha": (content("MET_LONG", small.tobytes()), "", small, (1.0, 2.0, 3.0)),
            "whole.mha": (content("MET_ULONG", whole.astype("<u4").tobytes()), "", whole,
                          (1.0, 2.0, 3.0)),
            "packed.mha": (content("MET_LONG", packed, "CompressedData = True\n"), "", small,
                           (1.0, 2.0, 3.0)),
            "words.mha": (content("MET_LONG", words, "text"), "", small, (1.0, 2.0, 3.0)),
            "files.mha": (wide, "read from one file"),
            "wide.mha": (content("MET_LONG_LONG", values.astype("<i8").tobytes()),
                         "ElementType 'MET_LONG_LONG'")})

    def test_directions_that_are_none(self):
        with open(os.path.join(WORK, "turned.mha"), "rb") as file:
            content = file.read()
        head, tail = content.split(b"TransformMatrix = ", 1)
        with open(os.path.join(WORK, "flat.mha"), "wb") as file:
            file.write(head + b"TransformMatrix = 1 0 0 1 0 0 0 0 1\n" + tail.split(b"\n", 1)[1])
        reader = vtkffd.vtkFFDVolumeReader()
        told = []
        reader.AddObserver("WarningEvent", lambda *_: told.append(True))
        reader.SetFileName(os.path.join(WORK, "flat.mha"))
        reader.Update()
        self.assertEqual((len(told), reader.GetProblem()), (1, ""))
        self.assertEqual(reader.GetOutput().GetDirectionMatrix().GetElement(1, 0), 0.0)


if __name__ == "__main__":
    unittest.main()
