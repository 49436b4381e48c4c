# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A test as VTK's Python tests of volumes are written, for the test of compare_with_vtk.py."""

import vtk
import vtk.test.Testing
from vtk.util.misc import vtkGetDataRoot


class SampleVolume(vtk.test.Testing.vtkTest):
    """Renders a volume with the fixed point mapper."""

    def test(self):
        reader = vtk.vtkXMLImageDataReader()
        reader.SetFileName(vtkGetDataRoot() + "/Data/vase_1comp.vti")
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetInputConnection(reader.GetOutputPort())
        opacity = vtk.vtkPiecewiseFunction()
        opacity.AddPoint(0.0, 0.0)
        opacity.AddPoint(255.0, 0.1)
        volume = vtk.vtkVolume()
        volume.SetMapper(mapper)
        volume.GetProperty().SetScalarOpacity(opacity)
        volume.GetProperty().SetInterpolationTypeToLinear()
        renderer = vtk.vtkRenderer()
        renderer.AddVolume(volume)
        window = vtk.vtkRenderWindow()
        window.SetMultiSamples(0)
        window.SetSize(200, 200)
        window.AddRenderer(renderer)
        window.Render()
        vtk.test.Testing.compareImage(window, "SampleVolume.png", threshold=10)


if __name__ == "__main__":
    vtk.test.Testing.main([(SampleVolume, "test")])
