# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Make stand-ins for the data files of VTK's volume tests.

VTK's source tree names its test data by checksums only. Where the real files are not at hand, these
of the same formats, types, and ranges of values let the tests run: what is compared is one mapper
with another on the same data, not a picture with VTK's baselines.
"""

import os

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def _volume(path):
    """The scalars of a .vti as an array [z, y, x], and the image."""
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(image.GetDimensions()[::-1]), image


def _image(values, spacing=(1.0, 1.0, 1.0), name="Scalars"):
    """vtkImageData of an array [z, y, x] or [z, y, x, component]."""
    image = vtk.vtkImageData()
    image.SetDimensions(values.shape[2], values.shape[1], values.shape[0])
    image.SetSpacing(spacing)
    components = values.shape[3] if values.ndim == 4 else 1
    flat = numpy.ascontiguousarray(values).reshape(-1, components)
    scalars = numpy_to_vtk(flat if components > 1 else flat[:, 0], deep=True)
    scalars.SetName(name)
    image.GetPointData().SetScalars(scalars)
    return image


def _write(writer, path, image):
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()


def _vase():
    """A hollow vase, 0 to 255, of 100 x 100 x 34 voxels."""
    z, y, x = numpy.mgrid[0:34, 0:100, 0:100].astype(float)
    radius = numpy.hypot(x - 49.5, y - 49.5)
    wall = 28.0 + 9.0 * numpy.sin(z / 33.0 * 5.0)
    values = 255.0 * numpy.exp(-(((radius - wall) / 5.0) ** 2)) * numpy.clip(z / 3.0, 0.0, 1.0)
    return values.astype(numpy.uint8)


def make(folder, volumes):
    """Write the stand-ins into `folder`, from the test volumes in the folder `volumes`.

    Files that are there already are kept.
    """

    def missing(name):
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        return None if os.path.exists(path) else path

    head, head_image = _volume(os.path.join(volumes, "headsq.vti"))
    engine, _ = _volume(os.path.join(volumes, "engine.vti"))
    neghip, _ = _volume(os.path.join(volumes, "neghip.vti"))

    path = missing("vase_1comp.vti")
    if path:
        _write(vtk.vtkXMLImageDataWriter(), path, _image(_vase()))
    path = missing("vase_4comp.vti")
    if path:
        vase = _vase()
        z, y, x = numpy.mgrid[0:34, 0:100, 0:100]
        four = numpy.stack([x * 255 // 99, y * 255 // 99, z * 255 // 33, vase], axis=3)
        _write(vtk.vtkXMLImageDataWriter(), path, _image(four.astype(numpy.uint8)))
    if missing("headsq/quarter.1"):
        for i, layer in enumerate(head):
            layer.astype("<u2").tofile(os.path.join(folder, "headsq", "quarter.%d" % (i + 1)))
    path = missing("ironProt.vtk")
    if path:
        writer = vtk.vtkStructuredPointsWriter()
        writer.SetFileTypeToBinary()
        _write(writer, path, _image(neghip))
    path = missing("tooth.nhdr")
    if path:
        tooth = engine[:112:1, ::2, ::2].astype("<u2") * 5
        tooth.tofile(os.path.join(folder, "tooth.raw"))
        with open(path, "w", encoding="ascii") as header:
            header.write(
                "NRRD0004\ntype: ushort\ndimension: 3\nsizes: %d %d %d\nspacings: 1 1 1\n"
                "endian: little\nencoding: raw\ndata file: tooth.raw\n" % tooth.shape[::-1]
            )
    path = missing("tooth_2dtransf.png")
    if path:
        gradient, value = numpy.mgrid[0:256, 0:256]
        alpha = numpy.clip(value - 90, 0, 255) * numpy.clip(gradient, 0, 60) // 60
        table = numpy.stack([value, 255 - value, gradient, alpha], axis=2)[numpy.newaxis]
        _write(vtk.vtkPNGWriter(), path, _image(table.astype(numpy.uint8)))
    path = missing("HeadMRVolume.mhd")
    if path:
        small = (head[::2, ::1, ::1].clip(0, 2560) // 4).astype(numpy.int16)
        writer = vtk.vtkMetaImageWriter()
        writer.SetRAWFileName(os.path.join(folder, "HeadMRVolume.raw"))
        _write(writer, path, _image(small, (3.2, 3.2, 3.0)))
    path = missing("hncma-atlas.vti")
    if path:
        z, y, x = numpy.mgrid[0:64, 0:64, 0:64]
        inside = (x - 32) ** 2 + (y - 32) ** 2 + (z - 32) ** 2 < 30 ** 2
        labels = numpy.where(inside, (x // 8) * 64 + (y // 8) * 8 + z // 8 + 1, 0) * 9
        _write(vtk.vtkXMLImageDataWriter(), path, _image(labels.astype(numpy.int16)))
    path = missing("RectGrid2.vtk")
    if path:
        grid = vtk.vtkRectilinearGrid()
        axes = [numpy.linspace(0.0, 1.0, n) ** 1.5 * length for n, length in ((47, 4.0), (33, 4.0), (44, 6.0))]
        grid.SetDimensions(*[len(axis) for axis in axes])
        for axis, setter in zip(axes, (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
            setter(numpy_to_vtk(axis, deep=True))
        z, y, x = numpy.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        values = 10.39 * numpy.exp(-((x - 2.0) ** 2 + (y - 2.0) ** 2 + (z - 3.0) ** 2) / 2.0)
        scalars = numpy_to_vtk(values.ravel(), deep=True)
        scalars.SetName("scalars")
        grid.GetPointData().SetScalars(scalars)
        vectors = numpy_to_vtk(numpy.repeat(values.reshape(-1, 1), 3, axis=1), deep=True)
        vectors.SetName("vectors")
        grid.GetPointData().SetVectors(vectors)
        _write(vtk.vtkRectilinearGridWriter(), path, grid)
    for name in ("sphere.slc", "neghip.slc"):
        path = missing(name)
        if path:
            z, y, x = numpy.mgrid[0:50, 0:50, 0:50] - 24.5
            sphere = numpy.clip(255.0 - 8.0 * numpy.sqrt(x * x + y * y + z * z), 0.0, 255.0)
            values = neghip if name.startswith("neghip") else sphere.astype(numpy.uint8)
            with open(path, "wb") as slc:
                # Magic number, dimensions, bits, spacing, unit, source, modification, compression;
                # an icon of one pixel; the slices.
                slc.write(b"11111 %d %d %d 8 1.0 1.0 1.0 0 0 0 0\n1 1 X123" % values.shape[::-1])
                slc.write(numpy.ascontiguousarray(values).tobytes())
    path = missing("MagnitudeImage_256x256x148")
    if path:
        values = numpy.zeros((148, 256, 256), ">u2")
        values[:128] = engine.astype(">u2") * 8
        values.tofile(path)
    path = missing("TestGPURayCastTransfer2DYScalarsTransferFunction.vti")
    if path:
        # Colors and opacities in 0 to 1; pressure along x, temperature along y.
        y, x = numpy.mgrid[0:256, 0:256] / 255.0
        table = numpy.stack([x, 1.0 - x, y, 0.3 * numpy.clip(4.0 * x - 1.0, 0.0, 1.0) * y], axis=2)
        _write(vtk.vtkXMLImageDataWriter(), path, _image(table[numpy.newaxis].astype(numpy.float32)))
    path = missing("disk_out_ref.ex2")
    if path:
        cylinder = vtk.vtkImplicitBoolean()
        cylinder.SetOperationTypeToIntersection()
        for function in (vtk.vtkCylinder(), vtk.vtkBox()):
            cylinder.AddFunction(function)
        cylinder.GetFunction().GetItemAsObject(0).SetAxis(0.0, 0.0, 1.0)
        cylinder.GetFunction().GetItemAsObject(0).SetRadius(5.75)
        cylinder.GetFunction().GetItemAsObject(1).SetBounds(-6.0, 6.0, -6.0, 6.0, -10.0, 10.1)
        z, y, x = numpy.mgrid[-10:10:21j, -6:6:25j, -6:6:25j]
        image = _image(numpy.exp(-(x * x + y * y) / 12.0) * (1.0 + 0.05 * z) * 0.03, (0.5, 0.5, 1.0), "Pres")
        image.SetOrigin(-6.0, -6.0, -10.0)
        heat = numpy_to_vtk((293.0 + 30.0 * (z + 10.0) + 4.0 * x).ravel(), deep=True)
        heat.SetName("Temp")
        image.GetPointData().AddArray(heat)
        disk = vtk.vtkExtractGeometry()
        disk.SetInputData(image)
        disk.SetImplicitFunction(cylinder)
        writer = vtk.vtkExodusIIWriter()
        writer.SetFileName(path)
        writer.SetInputConnection(disk.GetOutputPort())
        writer.Write()
    path = missing("headmr3blocks/headmr3blocks.vtm")
    if path:
        blocks = vtk.vtkMultiBlockDataSet()
        for i in range(3):
            # Neighboring blocks share a face.
            part = head[:, :, i * 21 : i * 21 + 22].clip(0, 2560) // 10
            block = _image(part.astype(numpy.int16), (3.2, 3.2, 1.5), "MetaImage")
            block.SetOrigin(i * 21 * 3.2, 0.0, 0.0)
            blocks.SetBlock(i, block)
        _write(vtk.vtkXMLMultiBlockDataWriter(), path, blocks)
    path = missing("m4_TotalDensity.cube")
    if path:
        atoms = [(6, 0.0, 0.0, 0.0), (8, 2.3, 0.0, 0.0), (1, -1.2, 1.7, 0.0), (1, -1.2, -1.7, 0.0)]
        x, y, z = numpy.mgrid[-6:6:41j, -6:6:41j, -6:6:41j]
        density = sum(n * numpy.exp(-1.5 * numpy.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2)) for n, a, b, c in atoms)
        with open(path, "w", encoding="ascii") as cube:
            cube.write("stand-in\nTotal density\n%d -6.0 -6.0 -6.0\n" % len(atoms))
            for axis in numpy.eye(3) * 0.3:
                cube.write("41 %f %f %f\n" % tuple(axis))
            for n, a, b, c in atoms:
                cube.write("%d 0.0 %f %f %f\n" % (n, a, b, c))
            for row in density.reshape(-1, 41):
                cube.write(" ".join("%.5e" % value for value in row) + "\n")
