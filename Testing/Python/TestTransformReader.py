# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDTransformReader: files of ITK and elastix against what these tools do to points."""

import glob
import gzip
import json
import math
import os
import resource
import shutil
import struct
import time
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNIFTIImageReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

FOLDER = os.path.join(os.environ["FFD_TEST_DATA"], "Transforms")
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
SPLINE = """#Insight Transform File V1.0
#Transform 0
Transform: BSplineTransform_double_3_3
Parameters: %s
FixedParameters: 4 4 4 -1 -1 -1 1 1 1 1 0 0 0 1 0 0 0 1
"""


def golden(name):
    with open(os.path.join(FOLDER, name), encoding="ascii") as file:
        return json.load(file)


def read(name, coordinates="LPS"):
    reader = vtkffd.vtkFFDTransformReader()
    reader.SetFileName(os.path.join(FOLDER, name))
    getattr(reader, "SetCoordinatesTo" + coordinates)()
    return reader


def largest_error(transform, pairs, flip=(1.0, 1.0, 1.0)):
    flip = np.array(flip)
    return max(np.abs(np.array(transform.TransformPoint(flip * p)) - flip * q).max()
               for p, q in pairs)


class Errors:
    """The error messages of an object."""

    def __init__(self, item):
        self.messages = []
        item.AddObserver("ErrorEvent", self.add)

    def add(self, _caller, _event, message=""):
        self.messages.append(message)

    add.CallDataType = "string0"


class TestTransformReader(unittest.TestCase):
    def test_files_of_itk_do_what_itk_does(self):
        expected = golden("points.json")
        self.assertGreaterEqual(len(expected), 25)
        for name, pairs in expected.items():
            # vtkGridTransform divides a cell into 2^16 steps; NIfTI's grids are single precision.
            tolerance = 1e-4 if name.startswith("field") else 1e-9
            with self.subTest(name):
                reader = read(name)
                transform = reader.GetTransform()
                self.assertIsNotNone(transform)
                self.assertLess(largest_error(transform, pairs), tolerance)
                ras = read(name, "RAS")
                self.assertLess(
                    largest_error(ras.GetTransform(), pairs, (-1.0, -1.0, 1.0)), tolerance)

    def test_every_format_and_type_of_itk(self):
        expected = golden("itk_points.json")
        self.assertEqual(len(expected), 22)
        formats = set()
        for name, pairs in expected.items():
            # vtkGridTransform divides a cell into 2^16 steps.
            tolerance = 1e-4 if "field" in name or name == "itk_composite.xfm" else 1e-12
            with self.subTest(name):
                reader = read(name)
                self.assertLess(largest_error(reader.GetTransform(), pairs), tolerance * 50)
                formats.add(reader.GetFileFormatAsString())
                self.assertEqual(reader.CanReadFile(reader.GetFileName()), 1)
                ras = read(name, "RAS").GetTransform()
                self.assertLess(largest_error(ras, pairs, (-1.0, -1.0, 1.0)), tolerance * 50)
        self.assertEqual(formats, {"ItkText", "ItkHDF5", "Matlab", "MINC"})

    def read_text(self, name, text):
        path = os.path.join(TEMPORARY, name)
        with open(path, "w", encoding="ascii") as file:
            file.write(text)
        reader = vtkffd.vtkFFDTransformReader()
        reader.SetFileName(path)
        transform = reader.GetTransform()
        self.assertIsNotNone(transform)
        # It belongs to the reader.
        copy = transform.MakeTransform()
        copy.DeepCopy(transform)
        return copy

    def test_quaternions_of_any_length(self):
        """As in ITK one that is not of length 1 scales, by the square of its length."""
        pairs = golden("itk_points.json")["itk_QuaternionRigidTransform.tfm"]
        with open(os.path.join(FOLDER, "itk_QuaternionRigidTransform.tfm"), encoding="ascii") as file:
            text = file.read()
        numbers = text[text.index("Parameters:"):].split()[1:8]
        center, shift = np.array((10.0, -5.0, 4.0)), np.array([float(n) for n in numbers[4:]])
        for factor in (2.0, -0.5):
            longer = " ".join(repr(factor * float(n)) for n in numbers[:4]) + " " + " ".join(numbers[4:])
            transform = self.read_text("longer.tfm", text.replace(" ".join(numbers), longer))
            scaled = [(p, center + shift + factor**2 * (q - center - shift)) for p, q in pairs]
            self.assertLess(largest_error(transform, scaled), 1e-10)

    def test_elastix_names_files_of_itk(self):
        expected = golden("itk_points.json")
        for name in ("itk_VersorTransform.tfm", "itk_ScaleTransform.tfm", "itk_composite.h5",
                     "itk_ScaleVersor3DTransform.tfm", "itk_ScaleSkewVersor3DTransform.tfm",
                     "itk_linear.mat", "itk_spline2.tfm"):
            shutil.copy(os.path.join(FOLDER, name), TEMPORARY)
            with self.subTest(name):
                file = '(Transform "File")\n(TransformFileName "out/%s")\n' % name
                transform = self.read_text("file.txt", file)
                self.assertLess(largest_error(transform, expected[name]), 1e-10)
                # As the initial transform of a translation, after which it is applied.
                chain = self.read_text("chain.txt", '(Transform "TranslationTransform")\n'
                                       '(TransformParameters 1 2 3)\n'
                                       '(InitialTransformParameterFileName "file.txt")\n')
                pairs = [(p, np.add(q, (1, 2, 3))) for p, q in expected[name]]
                self.assertLess(largest_error(chain, pairs), 1e-10)

    def test_elastix_weights_and_logarithms(self):
        with open(os.path.join(FOLDER, "elastix5_spline2.txt"), encoding="ascii") as file:
            spline = self.read_text("sub1.txt", file.read())
        angle = 0.4
        turn = self.read_text(
            "sub2.txt", '(Transform "AffineLogTransform")\n(CenterOfRotationPoint 1 2 3)\n'
            "(TransformParameters 0 %r 0 %r 0 0 0 0 %r 4 5 6)\n" % (-angle, angle, float(np.log(2.0))))
        c, s = np.cos(angle), np.sin(angle)
        matrix = np.array([[c, -s, 0], [s, c, 0], [0, 0, 2]])
        points = np.random.default_rng(5).uniform(8.0, 28.0, (10, 3))
        pairs = [(p, matrix @ (p - (1, 2, 3)) + (1, 2, 3) + (4, 5, 6)) for p in points]
        self.assertLess(largest_error(turn, pairs), 1e-12)
        for normalize, total in (("false", 1.0), ("true", 0.9)):
            both = self.read_text(
                "weighted.txt", '(Transform "WeightedCombinationTransform")\n'
                '(TransformParameters 0.6 0.3)\n(SubTransforms "sub1.txt" "sub2.txt")\n'
                '(NormalizeCombinationWeights "%s")\n' % normalize)
            pairs = [(p, p + 0.6 / total * (np.array(spline.TransformPoint(p)) - p)
                      + 0.3 / total * (np.array(turn.TransformPoint(p)) - p)) for p in points]
            self.assertLess(largest_error(both, pairs), 1e-12)

    def test_minc_inverses(self):
        pairs = golden("itk_points.json")["itk_linear.xfm"]
        with open(os.path.join(FOLDER, "itk_linear.xfm"), encoding="ascii") as file:
            text = file.read()
        back = self.read_text("i.xfm", text.replace("Linear;\n", "Linear;\nInvert_Flag = True;\n"))
        self.assertLess(largest_error(back, [(q, p) for p, q in pairs]), 1e-11)
        # A field, and after it its inverse.
        shutil.copy(os.path.join(FOLDER, "itk_composite_grid_0.mnc"), TEMPORARY)
        grid = ("Transform_Type = Grid_Transform;\n%sDisplacement_Volume = "
                "itk_composite_grid_0.mnc;\n")
        head = "MNI Transform File\n% a comment; with = signs\n"
        there = self.read_text("g.xfm", head + grid % "")
        both = self.read_text("g.xfm", head + grid % "" + grid % "Invert_Flag = True;\n")
        center = np.array((11.0, 20.0, 20.0))
        self.assertGreater(np.abs(there.TransformPoint(center) - center).max(), 0.1)
        self.assertLess(np.abs(both.TransformPoint(center) - center).max(), 2e-3)

    def field_bytes(self, name):
        with open(os.path.join(FOLDER, name), "rb") as file:
            return bytearray(file.read())

    def test_nifti_units_and_intents(self):
        # The grid in meters or microns; the vectors as they are.
        pairs = golden("points.json")["field_identity.nii"]
        for units, scale in ((1, 1e3), (2, 1.0), (3, 1e-3), (0, 1.0), (8 + 1, 1e3)):
            content = self.field_bytes("field_identity.nii")
            content[123] = units
            path = os.path.join(TEMPORARY, "units.nii")
            with open(path, "wb") as file:
                file.write(content)
            reader = vtkffd.vtkFFDTransformReader()
            reader.SetFileName(path)
            transform = reader.GetTransform()
            worst = max(np.abs(np.array(transform.TransformPoint(scale * np.array(p)))
                               - scale * np.array(p) - np.subtract(q, p)).max() for p, q in pairs)
            self.assertLess(worst, 1e-3 if scale > 1.0 else 1e-4, units)
        # Vectors of intent 1006 are RAS.
        struct.pack_into("<h", content, 68, 1006)
        content[123] = 2
        with open(path, "wb") as file:
            file.write(content)
        reader = vtkffd.vtkFFDTransformReader()
        reader.SetFileName(path)
        flipped = [(p, p + np.subtract(q, p) * (-1, -1, 1)) for p, q in pairs]
        self.assertLess(largest_error(reader.GetTransform(), flipped), 1e-4)

    def read_bytes(self, name, content):
        path = os.path.join(TEMPORARY, name)
        with open(path, "wb") as file:
            file.write(content)
        return read(path)

    def test_nifti_of_spm_and_niftyreg(self):
        # The same transform as each of them writes it: RAS, as displacements or as positions.
        for name in ("field_oblique.nii", "field_flipped.nii"):
            pairs = golden("points.json")[name]
            content = self.field_bytes(name)
            nx, ny, nz = struct.unpack_from("<3h", content, 42)
            rows = np.array(struct.unpack_from("<12f", content, 280)).reshape(3, 4)
            lps = np.frombuffer(bytes(content[352:]), "<f4").astype(float).reshape(3, nz, ny, nx)
            vectors = lps * np.array((-1, -1, 1)).reshape(3, 1, 1, 1)
            k, j, i = np.mgrid[:nz, :ny, :nx]
            nodes = np.einsum("rc,c...->r...", rows, np.stack((i, j, k, np.ones_like(i))))
            for intent, parameter, values in (("Mapping", 0, nodes + vectors),
                                              ("NREG_TRANS", 0, nodes + vectors),
                                              ("NREG_TRANS", 1, vectors)):
                with self.subTest((name, intent, parameter)):
                    struct.pack_into("<f", content, 56, parameter)
                    struct.pack_into("<16s", content, 328, intent.encode())
                    content[352:] = values.astype("<f4").tobytes()
                    transform = self.read_bytes("other.nii", content).GetTransform()
                    self.assertLess(largest_error(transform, pairs), 1e-4)
            struct.pack_into("<f", content, 56, 2)
            self.check_refused("other.nii", bytes(content), "reg_transform -disp")

    def test_legal_variants_of_fields(self):
        def check(name, *replacements, as_name=None):
            content = bytes(self.field_bytes(name))
            for old, new in replacements:
                self.assertIn(old, content)
                content = content.replace(old, new, 1)
            with self.subTest((name, replacements)):
                transform = self.read_bytes(as_name or name, content).GetTransform()
                self.assertIsNotNone(transform)
                self.assertLess(largest_error(transform, golden("points.json")[name]), 1e-4)

        shutil.copy(os.path.join(FOLDER, "field_oblique.raw"), TEMPORARY)
        mha = "field_oblique.mha"
        check(mha, (b"CompressedData", b"ElementByteOrderMSB = False\nCompressedData"))
        check(mha, (b"CenterOf", b"Position = -3 7 11\nComment = a\nComment = b\nCenterOf"))
        check(mha, (b"BinaryData = True", b"BinaryData = TRUE"), (b"MSB = False", b"MSB = FALSE"))
        check(mha, (b"CenterOf", b"HeaderSize = 0\nCenterOf"))
        check("field_oblique.mhd", (b"= field_oblique.raw", b"= ./field_oblique.raw"))
        check("field_oblique.nrrd", (b"type:", b"Type:"), (b"encoding: raw", b"Encoding: RAW"),
              (b"left-posterior-superior", b"Left-Posterior-Superior"))
        nan = struct.pack("<2f", np.nan, np.nan)
        content = self.field_bytes("field_oblique.nii")
        content[112:120] = nan
        transform = self.read_bytes("slope.nii", content).GetTransform()
        self.assertLess(largest_error(transform, golden("points.json")["field_oblique.nii"]), 1e-4)
        # Two lines that say different things are none that can be followed.
        content = bytes(self.field_bytes(mha)).replace(b"CenterOf", b"Position = 1 2 3\nCenterOf")
        self.check_refused("differs.mha", content, "two lines of 'Offset' that differ")
        content = content.replace(b"Position = 1 2 3\n", b"").replace(b"= LOCAL", b"= ./../x.raw")
        self.check_refused("outside.mha", content, "same folder")

    def test_spellings(self):
        vectors = np.random.default_rng(7).integers(0, 3, (4, 5, 6, 3))
        for kind, names in (("<i2", ("short int", "signed short", "signed short int", "int16")),
                            ("<u2", ("unsigned short int", "ushort")), ("<i4", ("signed int", "int"))):
            for name in names:
                with self.subTest(name):
                    start = ("NRRD0004\ntype: %s\ndimension: 4\nsizes: 3 6 5 4\nendian: little\n"
                             "encoding: raw\nkinds: vector domain domain domain\n\n" % name)
                    transform = self.read_bytes(
                        "types.nrrd", start.encode() + vectors.astype(kind).tobytes()).GetTransform()
                    np.testing.assert_allclose(
                        transform.TransformPoint(2.0, 1.0, 3.0), (2, 1, 3) + vectors[3, 1, 2], atol=1e-4)
        for entry in ('( Transform "TranslationTransform")', '(Transform\t"TranslationTransform")'):
            with self.subTest(entry):
                transform = self.read_text("spaces.txt", entry + "\n(TransformParameters 1 2 3)\n")
                self.assertEqual(transform.TransformPoint(0.0, 0.0, 0.0), (1.0, 2.0, 3.0))

    def test_nrrd_without_a_space(self):
        """Each axis tells by itself where the nodes are, as ITK reads it."""
        start = ("NRRD0004\ntype: double\ndimension: 4\nsizes: 3 6 5 4\nendian: little\n"
                 "encoding: raw\nkinds: vector domain domain domain\n%s\n")
        vectors = np.random.default_rng(7).uniform(-1.0, 1.0, (4, 5, 6, 3))
        spacings, mins = "spacings: nan 2 3 4\n", "axis mins: nan 10 20 30\n"
        for fields, spacing, origin in (
                ("", (1, 1, 1), (0, 0, 0)), (spacings, (2, 3, 4), (0, 0, 0)),
                (spacings + mins, (2, 3, 4), (11, 21.5, 32)),
                (spacings + mins + "centers: none cell node ???\n", (2, 3, 4), (11, 20, 32)),
                (spacings + mins.replace("axis mins", "axismins") + "centerings: none node node node\n",
                 (2, 3, 4), (10, 20, 30)),
                (spacings + "axis mins: nan 10 NaN 30\n", (2, 3, 4), (11, 0, 32)),
                (spacings + mins + "Centers: None Node NODE node\n", (2, 3, 4), (10, 20, 30)),
                ("SpaceDirections: none (2,0,0) (0,3,0) (0,0,4)\nSpaceOrigin: (1,2,3)\n", (2, 3, 4), (1, 2, 3)),
                ("space dimension: 3\nspace origin: (1,2,3)\n", (1, 1, 1), (1, 2, 3))):
            with self.subTest(fields):
                transform = self.read_bytes(
                    "axes.nrrd", (start % fields).encode() + vectors.tobytes()).GetTransform()
                nodes = np.indices((6, 5, 4)).reshape(3, -1).T
                rest = np.array(origin) + nodes * spacing
                pairs = zip(rest, rest + vectors[nodes[:, 2], nodes[:, 1], nodes[:, 0]])
                self.assertLess(largest_error(transform, pairs), 1e-4)
        for fields, expected in (
                ("space: RAS\n" + spacings, "space without space directions"),
                ("space dimension: 3\n" + spacings, "space without space directions"),
                (mins, "without spacings"), ("axis maxs: nan 3 4 5\n", "without spacings"),
                ("spacings: 2 3 4\n", "one number for each"),
                ("spacings: nan 2 3 4 5\n", "one number for each"),
                (spacings + "axis mins: nan x 2 3\n", "one number for each"),
                ("spacings: nan 2 0 4\n", "is 0, not from 1e-12"), ("spacings: nan 2 inf 4\n", "")):
            with self.subTest(fields):
                self.check_refused("axes.nrrd", (start % fields).encode() + vectors.tobytes(), expected)

    def test_gzip_of_several_members(self):
        pairs = golden("points.json")["field_oblique.nii.gz"]
        content = gzip.decompress(bytes(self.field_bytes("field_oblique.nii.gz")))
        for cuts in ((400,), (100, 352, 1000), (10, len(content) - 1)):
            parts = np.split(np.frombuffer(content, np.uint8), cuts)
            path = os.path.join(TEMPORARY, "members.nii.gz")
            with open(path, "wb") as file:
                # Bytes behind the last member are ignored.
                file.write(b"".join(gzip.compress(part.tobytes()) for part in parts) + b"\0" * 99)
            reader = vtkffd.vtkFFDTransformReader()
            reader.SetFileName(path)
            self.assertLess(largest_error(reader.GetTransform(), pairs), 1e-4)

    def test_only_regular_files(self):
        pipe = os.path.join(TEMPORARY, "pipe")
        if os.path.exists(pipe):
            os.remove(pipe)
        os.mkfifo(pipe)
        text = bytes(self.field_bytes("field_oblique.mhd")).replace(b"field_oblique.raw", b"pipe")
        self.check_refused("detached.mhd", text, "no regular file")
        for name in (pipe, "/dev/zero"):
            reader = vtkffd.vtkFFDTransformReader()
            errors = Errors(reader)
            reader.SetFileName(name)
            self.assertIsNone(reader.GetTransform())
            self.assertIn("no regular file", errors.messages[0])
            self.assertEqual(reader.CanReadFile(name), 0)

    def test_links_do_not_leave_the_folder(self):
        outer = os.path.join(TEMPORARY, "links")
        shutil.rmtree(outer, ignore_errors=True)
        os.makedirs(os.path.join(outer, "in", "below"))
        os.makedirs(os.path.join(outer, "out"))
        header = "field_oblique.mhd"
        raw = "field_oblique.raw"
        pairs = golden("points.json")[header]

        def attempt(path):
            reader = vtkffd.vtkFFDTransformReader()
            errors = Errors(reader)
            reader.SetFileName(path)
            transform = reader.GetTransform()
            if transform is not None:
                self.assertLess(largest_error(transform, pairs), 1e-4)
            return errors.messages

        inside = os.path.join(outer, "in", header)
        shutil.copy(os.path.join(FOLDER, header), inside)
        shutil.copy(os.path.join(FOLDER, raw), os.path.join(outer, "out"))
        os.symlink(os.path.join(outer, "out", raw), os.path.join(outer, "in", raw))
        self.assertIn("outside of the folder", attempt(inside)[0])
        # Below the folder is within it.
        os.remove(os.path.join(outer, "in", raw))
        shutil.copy(os.path.join(FOLDER, raw), os.path.join(outer, "in", "below"))
        os.symlink(os.path.join("below", raw), os.path.join(outer, "in", raw))
        self.assertEqual(attempt(inside), [])
        # A link to the header, with and without one to the data.
        os.symlink(inside, os.path.join(outer, "link.mhd"))
        self.assertEqual(attempt(os.path.join(outer, "link.mhd")), [])
        os.symlink(os.path.join("in", raw), os.path.join(outer, raw))
        self.assertEqual(attempt(os.path.join(outer, "link.mhd")), [])
        # By a path that begins at the current folder.
        here = os.getcwd()
        try:
            os.chdir(os.path.join(outer, "in"))
            self.assertEqual(attempt(header), [])
        finally:
            os.chdir(here)

    def test_no_more_is_read_than_the_header_says(self):
        name = os.path.join(TEMPORARY, "sparse.raw")
        with open(name, "wb") as file:
            file.truncate(6 << 30)
        text = bytes(self.field_bytes("field_oblique.mhd")).replace(b"field_oblique.raw",
                                                                    b"sparse.raw")
        begin = time.process_time()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        path = os.path.join(TEMPORARY, "sparse.mhd")
        with open(path, "wb") as file:
            file.write(text)
        reader = vtkffd.vtkFFDTransformReader()
        reader.SetFileName(path)
        self.assertIsNotNone(reader.GetTransform())
        packed = text.replace(b"CompressedData = False", b"CompressedData = True")
        self.assertNotEqual(packed, text)
        self.check_refused("sparse.mhd", packed, "damaged")
        for head in (b"#Insight Transform File V1.0\n", b"(Transform \"a\")\n",
                     b"<VTKFile type=\"ImageData\"><ImageData>", b"MNI Transform File\n"):
            with open(name, "r+b") as file:
                file.write(head)
            reader.SetFileName(name)
            self.assertIsNone(reader.GetTransform())
        self.assertLess(time.process_time() - begin, 5.0)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 100 << 10)
        os.remove(name)

    def test_bad_files_of_other_formats_are_refused_by_name(self):
        def content(name):
            return bytes(self.field_bytes(name))

        packed = content("itk_field_z.h5")
        for name, data, expected in (
                ("bad.h5", packed[:-300], "cannot be used"),
                ("bad.h5", content("itk_composite_grid_0.mnc"), "TransformGroup"),
                ("bad.h5", packed.replace(b"Transform_double_3_3", b"Transform_double_2_2"),
                 "three dimensions"),
                ("bad.mat", content("itk_linear.mat")[:-5], "ends in the middle"),
                ("bad.mat", content("itk_linear.mat") * 2, "several transforms"),
                ("bad.mat", content("itk_linear.mat").replace(b"ScaleSkew", b"ScaleSkip"),
                 "not supported"),
                ("bad.xfm", b"MNI Transform File\nTransform_Type = Linear;\n", "Linear_Transform"),
                ("bad.xfm", b"MNI Transform File\nTransform_Type = User_Transform;\n",
                 "User_Transform"),
                ("bad.xfm", b"MNI Transform File\n", "no transform"),
                ("bad.xfm", content("itk_composite.xfm").replace(b"grid_0", b"grid_7"),
                 "not in the folder"),
                ("bad.txt", b"(Transform \"File\")\n", "TransformFileName"),
                ("bad.txt", b"(Transform \"File\")\n(TransformFileName \"bad.txt\")\n",
                 "does not end")):
            with self.subTest((name, expected)):
                self.check_refused(name, data, expected)

    def test_files_of_elastix_do_what_transformix_does(self):
        expected = golden("elastix_points.json")
        expected.update(golden("elastix5_points.json"))
        self.assertEqual(len(expected), 14)
        for name, pairs in expected.items():
            if "stack" in name:
                continue
            with self.subTest(name):
                # transformix prints six decimals.
                self.assertLess(largest_error(read(name).GetTransform(), pairs), 2e-6)

    def test_stacks_of_elastix_do_what_transformix_does(self):
        expected = golden("elastix5_points.json")
        for name in ("elastix5_stack.txt", "elastix5_stack_euler.txt"):
            reader = read(name)
            for start, end in expected[name]:
                step = round((start[3] - 1.0) / 0.5)
                reader.SetStackIndex(step)
                self.assertLess(
                    largest_error(reader.GetTransform(), [(start[:3], end[:3])]), 2e-6, (name, step))
                self.assertEqual(reader.GetStackTime(step), start[3])
            self.assertEqual(reader.GetStackSize(), 4)
            self.assertEqual(reader.GetFileFormatAsString(), "Elastix")
        reader.SetStackIndex(-3)
        self.assertEqual(reader.GetStackIndex(), 0)
        reader.SetStackIndex(4)
        errors = Errors(reader)
        self.assertIsNone(reader.GetTransform())
        self.assertIn("4 steps, and none of index 4", errors.messages[0])
        self.assertIsNotNone(read("elastix5_add.txt").GetTransform())
        self.assertEqual(read("elastix5_add.txt").GetStackSize(), 0)

    def test_bad_stacks_are_refused(self):
        with open(os.path.join(FOLDER, "elastix5_stack_euler.txt"), encoding="ascii") as file:
            text = file.read()
        for old, new, expected in (
                ("(NumberOfSubTransforms 4)", "(NumberOfSubTransforms 5)", "not as many for each of 5"),
                ("(NumberOfSubTransforms 4)", "(NumberOfSubTransforms 0)", "1 to 65536"),
                ("(NumberOfSubTransforms 4)", "", "NumberOfSubTransforms"),
                ("(StackSpacing 0.5)", "(StackSpacing 0)", "not positive"),
                ("(StackOrigin 1)", "(StackOrigin no)", "StackOrigin"),
                ("(FixedImageDimension 4)", "(FixedImageDimension 3)", "is not 4"),
                ("EulerStack", "AffineDTIStack", "not supported")):
            with self.subTest((old, new)):
                self.check_refused("stack.txt", text.replace(old, new).encode(), expected)

    def test_formats_are_found_from_the_content(self):
        for name, wanted in (("euler.tfm", "ItkText"), ("elastix_bspline.txt", "Elastix"),
                             ("field_oblique.mhd", "MetaImage"), ("field_oblique_z.nrrd", "NRRD"),
                             ("field_oblique.nii.gz", "NIfTI")):
            reader = read(name)
            self.assertEqual(reader.CanReadFile(reader.GetFileName()), 1)
            self.assertIsNotNone(reader.GetTransform())
            self.assertEqual(reader.GetFileFormatAsString(), wanted)
        self.assertEqual(reader.CanReadFile(os.path.join(FOLDER, "points.json")), 0)
        self.assertEqual(reader.CanReadFile(FOLDER), 0)
        self.assertEqual(reader.CanReadFile("/no/such/file"), 0)

    def test_values_are_those_of_vtks_own_readers(self):
        for name, other in (("field_oblique.mhd", vtkMetaImageReader()),
                            ("field_oblique_z.mha", vtkMetaImageReader()),
                            ("field_identity.nii", vtkNIFTIImageReader()),
                            ("field_oblique.nii.gz", vtkNIFTIImageReader())):
            with self.subTest(name):
                reader = read(name)
                grid = reader.GetTransform()
                if grid.GetClassName() == "vtkGeneralTransform":
                    grid = grid.GetConcatenatedTransform(1)
                other.SetFileName(os.path.join(FOLDER, name))
                other.Update()
                ours = vtk_to_numpy(grid.GetDisplacementGrid().GetPointData().GetScalars())
                theirs = vtk_to_numpy(other.GetOutput().GetPointData().GetScalars())
                if reader.GetTransform() is not grid:
                    # Between two rotations the vectors are rotated; their length is not.
                    ours = np.linalg.norm(ours, axis=1)
                    theirs = np.linalg.norm(theirs, axis=1)
                np.testing.assert_allclose(np.sort(ours, axis=0), np.sort(theirs, axis=0),
                                           rtol=1e-5)

    def test_lattice_of_the_file_is_exact(self):
        reader = read("bspline_flipped.tfm")
        self.assertEqual(reader.GetTransform().GetClassName(), "vtkFFDLattice")
        self.assertLess(largest_error(reader.GetLattice(), golden("points.json")[
            "bspline_flipped.tfm"]), 1e-9)
        self.assertEqual(reader.GetLatticeError(), 0.0)
        reader.Update()
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.FromImageData(reader.GetOutput()), 1)
        np.testing.assert_array_equal(vtk_to_numpy(lattice.GetDisplacements()),
                                      vtk_to_numpy(reader.GetLattice().GetDisplacements()))
        bounds = [0.0] * 6
        reader.GetDomain(bounds)
        np.testing.assert_allclose(bounds, lattice.GetDomain(), atol=1e-9)
        # The size that the pipeline was told.
        self.assertEqual(reader.GetOutput().GetDimensions(), lattice.GetDimensions())

    def test_other_transforms_are_fitted_within_the_tolerance(self):
        reader = read("elastix_bspline.txt")
        bounds = [0.0] * 6
        reader.GetDomain(bounds)
        self.assertEqual(bounds, [0.0, 252.0, 0.0, 252.0, 0.0, 224.0])
        reader.SetFitTolerance(0.5)
        reader.Update()
        self.assertGreater(reader.GetLatticeError(), 0.0)
        self.assertLessEqual(reader.GetLatticeError(), 0.5)
        pairs = golden("elastix_points.json")["elastix_bspline.txt"]
        self.assertLess(largest_error(reader.GetLattice(), pairs), 0.5)
        coarse = reader.GetLattice().GetDimensions()
        reader.SetFitTolerance(0.02)
        self.assertLessEqual(reader.GetLattice() and reader.GetLatticeError(), 0.02)
        self.assertGreater(reader.GetLattice().GetDimensions(), coarse)
        reader.SetFitBounds(50.0, 100.0, 50.0, 100.0, 50.0, 100.0)
        np.testing.assert_allclose(reader.GetLattice().GetDomain(),
                                   [50.0, 100.0, 50.0, 100.0, 50.0, 100.0])
        reader.SetFitBounds(1, 0, 1, 0, 1, 0)
        reader.SetFitTolerance(1e-6)
        reader.SetMaximumCells(4)
        warnings = []
        reader.AddObserver("WarningEvent", lambda *_: warnings.append(1))
        self.assertEqual(reader.GetLattice().GetDimensions(), (7, 7, 7))
        self.assertEqual(len(warnings), 1)

    def test_linear_transform_needs_bounds_for_a_lattice_only(self):
        reader = read("affine.tfm")
        self.assertEqual(reader.GetTransform().GetClassName(), "vtkTransform")
        errors = Errors(reader)
        self.assertIsNone(reader.GetLattice())
        self.assertEqual(len(errors.messages), 1)
        self.assertIn("SetFitBounds", errors.messages[0])
        reader.SetFitBounds(-50.0, 50.0, -50.0, 50.0, -50.0, 50.0)
        self.assertLess(largest_error(reader.GetLattice(), golden("points.json")["affine.tfm"]),
                        1e-9)

    def test_lattice_as_vti(self):
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(5, 6, 7)
        lattice.SetDomain(0.0, 10.0, -5.0, 5.0, 2.0, 4.0)
        vtkffd.vtkFFDLatticeSource.ApplyShape(lattice, vtkffd.vtkFFDLatticeSource.RANDOM, 1.0, 3)
        image = vtkImageData()
        lattice.ToImageData(image)
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(image)
        path = os.path.join(TEMPORARY, "lattice.vti")
        writer.SetFileName(path)
        writer.Write()
        reader = vtkffd.vtkFFDTransformReader()
        reader.SetFileName(path)
        self.assertEqual(reader.GetTransform().GetClassName(), "vtkFFDLattice")
        self.assertEqual(reader.GetFileFormatAsString(), "Lattice")
        np.testing.assert_array_equal(vtk_to_numpy(reader.GetLattice().GetDisplacements()),
                                      vtk_to_numpy(lattice.GetDisplacements()))
        # A volume is no lattice.
        reader.SetFileName(os.path.join(os.environ["FFD_TEST_DATA"], "fuel.vti"))
        errors = Errors(reader)
        self.assertIsNone(reader.GetTransform())
        self.assertIn("3 components", errors.messages[0])

    def check_refused(self, name, content, expected):
        path = os.path.join(TEMPORARY, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode("ascii"))
        reader = vtkffd.vtkFFDTransformReader()
        reader.SetFileName(path)
        errors = Errors(reader)
        self.assertIsNone(reader.GetTransform())
        self.assertEqual(len(errors.messages), 1, errors.messages)
        self.assertIn(name, errors.messages[0])
        self.assertIn(expected, errors.messages[0])

    def test_names_that_are_no_text(self):
        """Of files that a file names, in Latin-1; in UTF-8 they are shown as they are."""
        with open(os.path.join(FOLDER, "elastix_affine.txt"), "rb") as file:
            elastix = file.read()
        self.assertIn(b"elastix_translation.txt", elastix)
        for name, shown in ((b"Verschiebung_\xfc.txt", "Verschiebung_?.txt"),
                            ("Verschiebung_\u00fc.txt".encode(), "Verschiebung_\u00fc.txt")):
            self.check_refused(
                "elastix_affine.txt", elastix.replace(b"elastix_translation.txt", name), shown)

    def test_byte_order_marks(self):
        """Editors of Windows put one in front of UTF-8 and UTF-16."""
        with open(os.path.join(FOLDER, "elastix_oblique.txt"), "rb") as file:
            elastix = file.read()
        texts = {"mark.tfm": (SPLINE % " ".join(["0.5"] * 192)).encode(), "mark.txt": elastix,
                 "mark.mha": bytes(self.field_bytes("field_oblique.mha")),
                 "mark.nrrd": bytes(self.field_bytes("field_oblique.nrrd"))}
        points = np.random.default_rng(1).uniform(-1.0, 3.0, (20, 3))
        for name, text in texts.items():
            with self.subTest(name):
                plain = self.read_bytes(name, text).GetTransform()
                wanted = [(p, np.array(plain.TransformPoint(p))) for p in points]
                marked = self.read_bytes(name, b"\xef\xbb\xbf" + text).GetTransform()
                self.assertIsNotNone(marked)
                self.assertEqual(largest_error(marked, wanted), 0.0)
        for encoding in ("utf-16-le", "utf-16-be"):
            text = "\ufeff" + texts["mark.tfm"].decode()
            self.check_refused("wide.tfm", text.encode(encoding), "UTF-16")

    def test_nifti_sform_of_zeros(self):
        """The qform is taken where there is one."""
        content = self.field_bytes("field_oblique.nii")
        struct.pack_into("<2h", content, 252, 1, 0)
        struct.pack_into("<6f", content, 256, 0.0, 0.0, 0.3, 4.0, 5.0, 6.0)
        points = np.random.default_rng(1).uniform(-1.0, 3.0, (20, 3))
        wanted = self.read_bytes("qform.nii", content).GetTransform()
        wanted = [(p, np.array(wanted.TransformPoint(p))) for p in points]
        for sform in (0.0, math.nan):
            struct.pack_into("<2h", content, 252, 1, 1)
            struct.pack_into("<12f", content, 280, *[sform] * 12)
            transform = self.read_bytes("zeros.nii", content).GetTransform()
            self.assertIsNotNone(transform)
            self.assertEqual(largest_error(transform, wanted), 0.0)
        struct.pack_into("<2h", content, 252, 0, 1)
        self.check_refused("zeros.nii", bytes(content), "finite")

    def test_bad_itk_files_are_refused_by_name(self):
        good = SPLINE % " ".join(["0.5"] * 192)
        for text, expected in (
                ("", "no ITK text transform"),
                ("#Insight Transform File V1.0\n", "no transform"),
                (good.replace("_3_3", "_2_2"), "three dimensions"),
                (good.replace("BSplineTransform", "KernelTransform"), "not supported"),
                (SPLINE % " ".join(["0.5"] * 191), "191 numbers instead of 192"),
                (good.replace("0.5", "nan", 1), "'nan'"),
                (good.replace("0.5", "1e400", 1), "'1e400'"),
                (good.replace("4 4 4 -1", "4 4 3 -1"), "3 nodes along axis 2"),
                (good.replace("4 4 4 -1", "100000 100000 100000 -1"), "100000 nodes"),
                (good.replace("4 4 4 -1", "4 4 4.5 -1"), "no positive integer"),
                (good.replace("-1 -1 -1 1 1 1", "-1 -1 -1 1 0 1"), "is 0, not from 1e-12"),
                (good.replace("1 0 0 0 1 0 0 0 1", "1 0 0 0 1 0 0 1 1"), "orthonormal"),
                (good + good.split("\n", 1)[1], "no CompositeTransform"),
                (good + "Parameters: 1\n", "two lines of Parameters"),
                (good + "Hello\n", "'Hello'"),
                ("#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\n"
                 "Parameters: 0 0 0 0 0 0 0 0 0 0 0 0\nFixedParameters: 0 0 0\n", "singular"),
                # The reciprocal of a number that small is none: the inverse was not a number.
                ("#Insight Transform File V1.0\nTransform: ScaleTransform_double_3_3\n"
                 "Parameters: 1 1 1e-320\nFixedParameters: 0 0 0\n", "singular"),
                # Cut off: the center is lost.
                ("#Insight Transform File V1.0\nTransform: ScaleTransform_double_3_3\n"
                 "Parameters: 1 1 2\nFixedParameters: 10 20", "not the 3 of its center"),
                ("#Insight Transform File V1.0\nTransform: Euler3DTransform_double_3_3\n"
                 "Parameters: 1 0 0 0 0 0\n", "not the 3 of its center"),
                ("#Insight Transform File V1.0\nTransform: VersorRigid3DTransform_double_3_3\n"
                 "Parameters: 1 1 1 0 0 0\nFixedParameters: 0 0 0\n", "longer than 1")):
            with self.subTest(expected):
                self.check_refused("bad.tfm", text, expected)

    def test_bad_elastix_files_are_refused_by_name(self):
        with open(os.path.join(FOLDER, "elastix_oblique.txt"), encoding="ascii") as file:
            good = file.read()
        for old, new, expected in (
                ('"BSplineTransform"', '"SplineKernelTransform"', "not supported"),
                ("(FixedImageDimension 3)", "(FixedImageDimension 2)", "FixedImageDimension"),
                ('Parameters "false"', 'Parameters "true"', "binary"),
                ("SplineOrder 3", "SplineOrder 4", "not 1, 2 or 3"),
                ("(GridSize", "(OtherSize", "(GridSize ...)"),
                ("(TransformParameters ", "(TransformParameters 7 ", "2701 numbers"),
                ('"NoInitialTransform"', '"bad.txt"', "does not end"),
                ('"NoInitialTransform"', '"missing.txt"', "missing.txt"),
                ('"Compose"', '"Multiply"', "Multiply"),
                ("(GridSize", "GridSize", "parentheses")):
            with self.subTest(expected):
                self.assertIn(old, good)
                self.check_refused("bad.txt", good.replace(old, new), expected)

    def test_comments_of_elastix(self):
        with open(os.path.join(FOLDER, "elastix_oblique.txt"), encoding="ascii") as file:
            good = file.read()
        path = os.path.join(TEMPORARY, "comment.txt")
        with open(path, "w", encoding="ascii") as file:
            file.write("// (before) it\n" + good.replace(
                "(FixedImageDimension 3)", "(FixedImageDimension 3) // in space (not in time)"))
        self.assertIsNotNone(read(path).GetTransform())

    def test_bad_fields_are_refused_by_name(self):
        def bytes_of(name):
            with open(os.path.join(FOLDER, name), "rb") as file:
                return file.read()

        for name, old, new, expected in (
                ("field_identity.mha", b"DimSize = 6 5 4", b"DimSize = 6 5 5", "data end after"),
                ("field_identity.mha", b"DimSize = 6 5 4", b"DimSize = 1024 1024 1024", "2^27"),
                ("field_identity.mha", b"DimSize = 6 5 4", b"DimSize = 500 500 500",
                 "data end after 1440 of 1500000000"),
                ("field_identity.mha", b"Channels = 3", b"Channels = 1", "3 channels"),
                ("field_identity.mha", b"MET_FLOAT", b"MET_STRING", "MET_STRING"),
                ("field_identity.mha", b"= LOCAL", b"= ../x.raw", "same folder"),
                ("field_identity.mha", b"= LOCAL", b"= missing.raw", "missing.raw"),
                ("field_oblique_z.mha", b"DimSize = 6 5 4", b"DimSize = 500 500 500",
                 "data end after 1440"),
                ("field_identity.nrrd", b"sizes: 3 6 5 4", b"sizes: 1 6 5 4", "1 6 5 4"),
                ("field_identity.nrrd", b"encoding: raw", b"encoding: bzip2", "bzip2"),
                ("field_identity.nrrd", b"left-posterior", b"left-upper", "space"),
                ("field_identity.nrrd", b"origin: (", b"origin: (1,", "space origin"),
                ("field_identity.nrrd", b"space origin", b"spcae origin", "'spcae origin', which is none"),
                ("field_identity.nrrd", b"space directions", b"spac\xe9 directions", "none of the format"),
                ("field_identity.nii", struct.pack("<8h", 5, 6, 5, 4, 1, 3, 1, 1),
                 struct.pack("<8h", 4, 6, 5, 4, 3, 1, 1, 1), "dim must be"),
                ("field_identity.nii", struct.pack("<8h", 5, 6, 5, 4, 1, 3, 1, 1),
                 struct.pack("<8h", 5, 600, 500, 400, 1, 3, 1, 1), "data end after")):
            with self.subTest((name, new)):
                content = bytes_of(name)
                self.assertIn(old, content)
                self.check_refused("bad_" + name, content.replace(old, new, 1), expected)
        content = bytearray(bytes_of("field_identity.nii"))
        content[352:356] = struct.pack("<f", float("nan"))
        self.check_refused("bad_nan.nii", bytes(content), "voxel 0 is not a finite")
        packed = bytes_of("field_oblique.nii.gz")
        self.check_refused("bad_short.nii.gz", packed[:-200], "data end after")
        self.check_refused("bad_damaged.nii.gz", packed[:700] + b"\xff" * 50 + packed[750:],
                           "cannot be used")
        self.check_refused("bad_bomb.nii.gz", gzip.compress(b"\0" * 10000000), "no ITK text")

    def test_no_file(self):
        reader = vtkffd.vtkFFDTransformReader()
        errors = Errors(reader)
        self.assertIsNone(reader.GetTransform())
        self.assertIn("SetFileName", errors.messages[0])
        reader.SetFileName("/no/such/file.tfm")
        self.assertIsNone(reader.GetTransform())
        self.assertIn("/no/such/file.tfm", errors.messages[1])
        # Once is enough: asking again repeats neither the reading nor the error.
        self.assertIsNone(reader.GetTransform())
        self.assertEqual(len(errors.messages), 2)
        for call in (lambda: reader.SetFitTolerance(0.0), lambda: reader.SetFitTolerance(np.nan),
                     lambda: reader.SetCoordinates(7),
                     lambda: reader.SetFitBounds(0, 1, 0, np.inf, 0, 1)):
            before = len(errors.messages)
            call()
            self.assertEqual(len(errors.messages), before + 1)
        self.assertEqual(reader.GetFitTolerance(), 0.1)

    def test_fuzz_corpus_gives_errors_or_finite_transforms(self):
        files = sorted(glob.glob(os.path.join(os.environ["FFD_TEST_DATA"], "Fuzz", "*")))
        self.assertTrue(files)
        taken = 0
        for name in files:
            with self.subTest(os.path.basename(name)):
                reader = vtkffd.vtkFFDTransformReader()
                reader.SetFileName(name)
                errors = Errors(reader)
                transform = reader.GetTransform()
                self.assertEqual(transform is None, len(errors.messages) == 1)
                if transform is not None:
                    taken += 1
                    self.assertTrue(np.isfinite(transform.TransformPoint(1.0, 2.0, 3.0)).all())
        self.assertGreater(taken, 0)


if __name__ == "__main__":
    unittest.main()
