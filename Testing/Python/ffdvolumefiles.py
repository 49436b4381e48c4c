# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""One small asymmetric volume, written to files of several formats by the formats' own rules, byte
by byte: what a reader makes of the axes is not taken from VTK."""

import gzip
import os
import struct

import numpy

# Index i, j, k of the volume goes along these directions of the patient (LPS), from this origin.
SIZE = (12, 11, 10)
SPACING = numpy.array((1.5, 2.0, 2.5))
ANGLE = numpy.radians(20.0)
DIRECTION = numpy.array(((numpy.cos(ANGLE), -numpy.sin(ANGLE), 0.0),
                         (numpy.sin(ANGLE), numpy.cos(ANGLE), 0.0), (0.0, 0.0, 1.0)))
ORIGIN = numpy.array((-30.0, 40.0, 15.0))
RAS = numpy.array((-1.0, -1.0, 1.0))


def position(i, j, k):
    """Where voxel (i, j, k) is, LPS."""
    return ORIGIN + DIRECTION @ (SPACING * (i, j, k))


def voxels():
    """[k, j, i]: a body with a nose on one side, a small thing on another."""
    k, j, i = numpy.meshgrid(*(numpy.arange(n) for n in SIZE[::-1]), indexing="ij")
    values = numpy.where((abs(i - 5.5) < 4) & (abs(j - 5) < 3) & (abs(k - 4.5) < 3), 700, 0)
    values[2:4, 1:3, 3:6] = 900  # low k, low j
    values[7:9, 5:7, 9:12] = 1000  # high k, high i
    return (values + i + 2 * j + 3 * k).astype("<u2")


def write_nifti(path, form, unit=1.0, code=2):
    """form: "sform", or "qform" with qfac -1, whose slices lie the other way round in the file.
    unit: millimeters of the unit of length, code: its number."""
    data = voxels()
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 512, 16)
    qfac = -1.0 if form == "qform" else 1.0
    struct.pack_into("<8f", header, 76, qfac, *(SPACING / unit), 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352.0)
    struct.pack_into("<b", header, 123, code)
    origin, matrix = RAS * ORIGIN, RAS[:, None] * DIRECTION
    if form == "qform":
        # The stored third axis is that of a right-handed system times qfac.
        data = data[::-1]
        origin = RAS * position(0, 0, SIZE[2] - 1)
        # A turn by 20 - 180 degrees about z, as a quaternion (whose real part is not negative).
        half = 0.5 * (ANGLE - numpy.pi)
        struct.pack_into("<2h", header, 252, 1, 0)
        struct.pack_into("<6f", header, 256, 0.0, 0.0, numpy.sin(half), *(origin / unit))
    else:
        struct.pack_into("<2h", header, 252, 0, 1)
        for row in range(3):
            struct.pack_into("<4f", header, 280 + 16 * row, *(matrix[row] * SPACING / unit),
                             origin[row] / unit)
    header[344:348] = b"n+1\0"
    content = bytes(header) + bytes(4) + data.tobytes()
    with open(path, "wb") as file:
        file.write(gzip.compress(content) if path.endswith(".gz") else content)


def write_nrrd(path, space, compressed=True):
    sign = RAS if space == "right-anterior-superior" else numpy.ones(3)
    directions = " ".join("(%.17g,%.17g,%.17g)" % tuple(sign * DIRECTION[:, a] * SPACING[a])
                          for a in range(3))
    data = voxels().tobytes()
    if path.endswith(".nhdr"):
        name = os.path.basename(path)[:-5] + ".raw"
        with open(os.path.join(os.path.dirname(path), name), "wb") as file:
            file.write(data)
        tail, data, compressed = "data file: %s\n" % name, b"", False
    else:
        tail = "\n"
    header = ("NRRD0004\n# comment\ntype: unsigned short\ndimension: 3\nspace: %s\n"
              "sizes: %d %d %d\nspace directions: %s\nkinds: domain domain domain\n"
              "endian: little\nencoding: %s\nspace origin: (%.17g,%.17g,%.17g)\n%s"
              % (space, *SIZE, directions, "gzip" if compressed else "raw", *(sign * ORIGIN), tail))
    with open(path, "wb") as file:
        file.write(header.encode("ascii") + (gzip.compress(data) if compressed else data))


def write_meta(path):
    numbers = " ".join("%.17g" % value for value in DIRECTION.T.ravel())
    header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
              "TransformMatrix = %s\nOffset = %.17g %.17g %.17g\nElementSpacing = %g %g %g\n"
              "DimSize = %d %d %d\nElementType = MET_USHORT\nElementDataFile = LOCAL\n"
              % (numbers, *ORIGIN, *SPACING, *SIZE))
    with open(path, "wb") as file:
        file.write(header.encode("ascii") + voxels().tobytes())


def _element(group, element, kind, value):
    value = value.encode("ascii") if isinstance(value, str) else value
    if len(value) % 2:
        value += b"\0" if kind == "UI" else b" "
    tag = struct.pack("<2H", group, element) + kind.encode("ascii")
    if kind in ("OB", "OW"):
        return tag + struct.pack("<HI", 0, len(value)) + value
    return tag + struct.pack("<H", len(value)) + value


def write_dicom(folder, syntax="1.2.840.10008.1.2.1", downward=False):
    """A series of slices, explicit VR little endian; `downward`: numbered from the top."""
    os.makedirs(folder, exist_ok=True)
    data = voxels()

    def numbers(values):
        return "\\".join("%.6f" % value for value in values)

    for k in range(SIZE[2]):
        number = SIZE[2] - k if downward else k + 1
        uid = "1.2.826.0.1.3680043.2.1125.1"
        meta = (_element(2, 1, "OB", b"\0\1") + _element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2") +
                _element(2, 3, "UI", "%s.3.%d" % (uid, number)) + _element(2, 0x10, "UI", syntax))
        body = b"".join((
            _element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"),
            _element(8, 0x18, "UI", "%s.3.%d" % (uid, number)),
            _element(8, 0x60, "CS", "CT"),
            _element(0x18, 0x50, "DS", "%g" % SPACING[2]),
            _element(0x20, 0xd, "UI", uid + ".1"),
            _element(0x20, 0xe, "UI", uid + ".2"),
            _element(0x20, 0x13, "IS", str(number)),
            _element(0x20, 0x32, "DS", numbers(position(0, 0, k))),
            _element(0x20, 0x37, "DS", numbers((*DIRECTION[:, 0], *DIRECTION[:, 1]))),
            _element(0x28, 2, "US", struct.pack("<H", 1)),
            _element(0x28, 4, "CS", "MONOCHROME2"),
            _element(0x28, 0x10, "US", struct.pack("<H", SIZE[1])),
            _element(0x28, 0x11, "US", struct.pack("<H", SIZE[0])),
            # Between rows first, then between columns.
            _element(0x28, 0x30, "DS", "%g\\%g" % (SPACING[1], SPACING[0])),
            _element(0x28, 0x100, "US", struct.pack("<H", 16)),
            _element(0x28, 0x101, "US", struct.pack("<H", 16)),
            _element(0x28, 0x102, "US", struct.pack("<H", 15)),
            _element(0x28, 0x103, "US", struct.pack("<H", 0)),
            _element(0x28, 0x1052, "DS", "0"),
            _element(0x28, 0x1053, "DS", "1"),
            _element(0x7fe0, 0x10, "OW", data[k].tobytes())))
        with open(os.path.join(folder, "IM%04d" % number), "wb") as file:
            file.write(bytes(128) + b"DICM" + _element(2, 0, "UL", struct.pack("<I", len(meta))) +
                       meta + body)
