# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mapper has the names of VTK's volume mappers, and its frames as numpy arrays."""

import re
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkHardwareSelector, vtkRenderer, vtkRenderWindow, vtkVolume
from vtkmodules.vtkRenderingVolume import (
    vtkFixedPointVolumeRayCastMapper, vtkGPUVolumeRayCastMapper)
from vtkmodules.vtkRenderingVolumeOpenGL2 import (
    vtkOpenGLGPUVolumeRayCastMapper, vtkSmartVolumeMapper)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

import vtkffd

# What the helpers of vtkFixedPointVolumeRayCastMapper ask it for, in its fixed-point numbers, and
# the limits that the macros of VTK make of a range.
INTERNAL = re.compile(
    r"Get\w+(Min|Max)Value$|Get\w*Helper$|Get\w*(Table|TableScale|TableShift)$|Check\w+|"
    r"Compute(RayInfo)$|DisplayRenderedImage$|FixedPoint\w+|Get(Current|Previous)Scalars$|"
    r"GetFlipMIPComparison$|Get(Float|UInt)TripleFromPointer$|Get\w+Required$|"
    r"[GS]etRayCastImage$|Get(RenderWindow|RowBounds|Volume)$|InitializeRayInfo$|Lookup\w+|"
    r"Per\w+Initialization$|RenderSubVolume$|Shift\w+|ShouldUse\w+|ToFixedPoint\w+$")


class TestMapperNames(unittest.TestCase):
    def test_names(self):
        ours = set(dir(vtkffd.vtkFFDInverseRayVolumeMapper))
        for theirs in (vtkFixedPointVolumeRayCastMapper, vtkGPUVolumeRayCastMapper,
                       vtkOpenGLGPUVolumeRayCastMapper, vtkSmartVolumeMapper):
            # Not the properties in lower case, which VTK's wrapping tools make of methods by now.
            names = {name for name in dir(theirs) if name[0].isupper() and not INTERNAL.match(name)}
            self.assertGreater(len(names), 100)
            self.assertEqual(sorted(names - ours), [], theirs.__name__)

    def test_images_and_picking(self):
        image = vtkImageData()
        image.SetDimensions(10, 10, 10)
        image.AllocateScalars(4, 1)
        vtk_to_numpy(image.GetPointData().GetScalars())[:] = 100
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.GetProperty().GetScalarOpacity().AddPoint(0, 0.5)
        volume.GetProperty().GetRGBTransferFunction().AddRGBPoint(0, 1.0, 0.0, 0.0)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetSize(40, 30)
        window.AddRenderer(renderer)
        window.Render()
        mapper.RenderToImageOn()
        window.Render()
        colors = vtkImageData()
        depths = vtkImageData()
        mapper.GetColorImage(colors)
        mapper.GetDepthImage(depths)
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(30, 40, 4)
        z = vtk_to_numpy(depths.GetPointData().GetScalars()).reshape(30, 40)
        self.assertGreater(rgba[15, 20, 3], 200)
        self.assertTrue((rgba[:, :, 0] == rgba[:, :, 3]).all())
        self.assertTrue(0.0 < z[15, 20] < 1.0 and z[0, 0] == 1.0)
        mapper.RenderToImageOff()

        selector = vtkHardwareSelector()
        selector.SetRenderer(renderer)
        selector.SetArea(0, 0, 39, 29)
        selection = selector.Select()
        self.assertEqual(selection.GetNumberOfNodes(), 1)
        node = selection.GetNode(0)
        self.assertIs(node.GetProperties().Get(node.PROP()), volume)
        cells = vtk_to_numpy(node.GetSelectionList())
        # Those of the face that is seen.
        self.assertTrue((cells >= 9 * 9 * 8).all() and cells.max() < 9 * 9 * 9)
        self.assertGreater(len(numpy.unique(cells)), 70)

    def test_reduction_ratio(self):
        ratio = [0.0, 0.0, 0.0]
        vtkffd.vtkFFDInverseRayVolumeMapper().GetReductionRatio(ratio)
        self.assertEqual(ratio, [1.0, 1.0, 1.0])


if __name__ == "__main__":
    unittest.main()
