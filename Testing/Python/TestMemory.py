# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What does not fit into the memory is refused with an error that says how large it is; the process
goes on, and objects keep what they have. The limit is one of the process, so that these tests mean
the same on any machine."""

import contextlib
import os
import resource
import unittest

import vtkffd
from vtkmodules.vtkCommonCore import VTK_FLOAT, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkVolume

LEFT = 400 * 2**20


@contextlib.contextmanager
def memory_left(size):
    """Let this process allocate only so many bytes more."""
    with open("/proc/self/statm", encoding="ascii") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


class Log:
    CallDataType = "string0"

    def __init__(self, item):
        self.messages = []
        item.AddObserver("ErrorEvent", self)

    def __call__(self, _caller, _event, message):
        self.messages.append(message)


def huge_grid(n):
    """An image without any array."""
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    return image


def make_volume(n=8):
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    image.AllocateScalars(VTK_FLOAT, 1)
    image.GetPointData().GetScalars().Fill(1.0)
    return image


class TestMemory(unittest.TestCase):
    def refused(self, item, call, text):
        log = Log(item)
        with memory_left(LEFT):
            result = call()
        self.assertEqual(len(log.messages), 1, log.messages)
        self.assertIn(text, log.messages[0])
        self.assertIn("available", log.messages[0])
        return result

    def test_lattice(self):
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(18, 18, 18)
        lattice.SetDisplacement(3, 3, 3, 1, 2, 3)
        moved = lattice.TransformPoint(0.1, 0.1, 0.1)
        self.refused(lattice, lambda: lattice.SetDimensions(1024, 1024, 1024),
                     "1024 x 1024 x 1024 control points take 77.3 GB")
        self.assertEqual(self.refused(lattice, lambda: lattice.Refine(64, 64, 64),
                                      "963 x 963 x 963 control points take"), 0)
        self.assertEqual(self.refused(lattice, lambda: lattice.Extend(64) and lattice.Extend(64),
                                      "274 x 274 x 274 control points take"), 0)
        self.assertEqual(lattice.GetDimensions(), (146, 146, 146))
        lattice.SetDimensions(18, 18, 18)
        fresh = vtkffd.vtkFFDLattice()
        fresh.SetDimensions(18, 18, 18)
        fresh.SetDisplacement(3, 3, 3, 1, 2, 3)
        self.assertEqual(fresh.TransformPoint(0.1, 0.1, 0.1), moved)

    def test_filters(self):
        source = vtkffd.vtkFFDLatticeSource()
        source.SetDimensions(1024, 1024, 1024)
        self.refused(source, source.Update, "1024 x 1024 x 1024 control points")
        resample = vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(make_volume())
        resample.SetDeformation(vtkffd.vtkFFDLattice())
        resample.SetOutputExtent(0, 2999, 0, 2999, 0, 2999)
        self.refused(resample, resample.Update, "3000 x 3000 x 3000 points take 108 GB")
        resample.SetOutputExtent(0, 9, 0, 9, 0, 9)
        resample.Update()
        self.assertEqual(resample.GetOutput().GetNumberOfPoints(), 1000)
        jacobian = vtkffd.vtkFFDJacobian()
        jacobian.SetInputData(huge_grid(1200))
        jacobian.SetDeformation(vtkffd.vtkFFDLattice())
        self.refused(jacobian, jacobian.Update, "The determinants of 1728000000 points")

    def test_mapper(self):
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(make_volume())
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0, 0.5)
        volume = vtkVolume()
        volume.GetProperty().SetScalarOpacity(opacity)
        volume.SetMapper(mapper)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        renderer.ResetCamera()
        image = vtkImageData()
        self.assertEqual(mapper.RenderToImage(renderer, volume, 8, 8, image), 1)
        self.assertEqual(self.refused(
            mapper, lambda: mapper.RenderToImage(renderer, volume, 16384, 16384, image),
            "16384 x 16384 pixels take 4.29 GB"), 0)
        self.assertEqual(image.GetDimensions(), (8, 8, 1))
        self.assertEqual(mapper.RenderToImage(renderer, volume, 9, 9, image), 1)

    def test_what_no_check_foresees(self):
        # The allocator of VTK throws here: the guard of the pipeline turns that into an error.
        points = vtkPoints()
        points.SetDataTypeToDouble()
        points.SetNumberOfPoints(20000000)
        points.GetData().Fill(0.0)
        data = vtkPolyData()
        data.SetPoints(points)
        geometry = vtkffd.vtkFFDDeformGeometry()
        geometry.SetInputData(data)
        geometry.SetDeformation(vtkffd.vtkFFDLattice())
        log = Log(geometry)
        with memory_left(200 * 2**20):
            geometry.Update()
        self.assertIn("more memory was needed", log.messages[-1])

    def test_writer(self):
        writer = vtkffd.vtkFFDTransformWriter()
        writer.SetTransform(vtkffd.vtkFFDLattice())
        writer.SetReferenceImage(huge_grid(500))
        for suffix in ("mha", "nrrd", "nii"):
            name = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "huge." + suffix)
            writer.SetFileName(name)
            self.assertEqual(self.refused(
                writer, writer.Write, "The displacements at 125000000 points"), 0)
            self.assertFalse(os.path.exists(name))
            writer.RemoveAllObservers()


if __name__ == "__main__":
    unittest.main()
