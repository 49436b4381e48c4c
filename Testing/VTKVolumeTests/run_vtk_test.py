# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run one of VTK's Python tests, with our mapper in the place of VTK's if the first argument is ffd."""

import os
import runpy
import sys

import vtk
import vtk.test.Testing

MAPPERS = (
    "vtkFixedPointVolumeRayCastMapper",
    "vtkGPUVolumeRayCastMapper",
    "vtkOpenGLGPUVolumeRayCastMapper",
    "vtkSmartVolumeMapper",
)


def save_picture(window, name, **_):
    """In the place of vtk.test.Testing.compareImage: keep the picture in the folder after -T."""
    capture = vtk.vtkWindowToImageFilter()
    capture.SetInput(window)
    writer = vtk.vtkPNGWriter()
    folder = sys.argv[sys.argv.index("-T") + 1]
    writer.SetFileName(os.path.join(folder, os.path.basename(name)))
    writer.SetInputConnection(capture.GetOutputPort())
    writer.Write()


def main():
    mapper, test = sys.argv[1:3]
    sys.argv = sys.argv[2:]
    vtk.test.Testing.compareImage = lambda window, name, threshold=10: save_picture(window, name)
    if mapper == "ffd":
        import vtkffd  # pylint: disable=import-outside-toplevel

        for name in MAPPERS:
            setattr(vtk, name, vtkffd.vtkFFDInverseRayVolumeMapper)
    sys.path.insert(0, os.path.dirname(test))
    sys.dont_write_bytecode = True
    runpy.run_path(test, run_name="__main__")


main()
