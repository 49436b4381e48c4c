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


class Interactor(vtk.vtkRenderWindowInteractor):
    """An interactor that does not wait for a user."""

    def Start(self):  # pylint: disable=invalid-name
        pass


def save_picture(window, name, **_):
    """In the place of vtk.test.Testing.compareImage: keep the picture in the folder after -T."""
    saved.append(name)
    capture = vtk.vtkWindowToImageFilter()
    capture.SetInput(window)
    writer = vtk.vtkPNGWriter()
    folder = sys.argv[sys.argv.index("-T") + 1]
    writer.SetFileName(os.path.join(folder, os.path.basename(name)))
    writer.SetInputConnection(capture.GetOutputPort())
    writer.Write()


saved = []


def main():
    mapper, test = sys.argv[1:3]
    sys.argv = sys.argv[2:]
    vtk.test.Testing.compareImage = lambda window, name, threshold=10: save_picture(window, name)
    if mapper == "ffd":
        import vtkffd  # pylint: disable=import-outside-toplevel

        for name in MAPPERS:
            setattr(vtk, name, vtkffd.vtkFFDInverseRayVolumeMapper)
    vtk.vtkRenderWindowInteractor = Interactor
    sys.path.insert(0, os.path.dirname(test))
    sys.dont_write_bytecode = True
    try:
        left = runpy.run_path(test, run_name="__main__")
    except SystemExit:
        left = {}
    # Tests without a comparison of their own leave it to VTK's driver.
    windows = [value for value in left.values() if isinstance(value, vtk.vtkRenderWindow)]
    if windows and not saved:
        save_picture(windows[0], os.path.basename(test).replace(".py", ".png"))


main()
