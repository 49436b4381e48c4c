#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Look at a registration: the fixed volume, the moving one before and after, and a checkerboard.

Reads the transform that elastix, ITK or 3D Slicer wrote, and renders the moving volume deformed by
it; nothing is resampled. Without arguments: two CT heads of Testing/Data, registered by elastix.
Writes one PNG with four pictures and prints what they cost. With --interactive a window opens: drag
in any of the pictures to look around, keys + and - change the size of the checkerboard's fields, key
b shows the moving volume before instead of after the registration.
"""

import argparse
import os
import sys
import time

import numpy as np
import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkActor2D,
    vtkColorTransferFunction,
    vtkImageMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkRenderWindowInteractor,
    vtkVolume,
    vtkVolumeProperty,
)

import vtkffd
from display import require_display
from options import make_folder, number, pixels

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")
BACKGROUND = (26, 28, 33)


def read_image(path):
    reader = vtkffd.vtkFFDVolumeReader()
    reader.SetFileName(path)
    reader.Update()
    if reader.GetProblem():
        sys.exit("cannot read %s: %s" % (path, reader.GetProblem()))
    return reader.GetOutput()


def read_transform(path, coordinates):
    reader = vtkffd.vtkFFDTransformReader()
    reader.SetFileName(path)
    reader.SetCoordinates(getattr(reader, coordinates))
    transform = reader.GetTransform()
    if transform is None:
        sys.exit("cannot read the transform %s" % path)
    print("%s: a %s of the format %s" % (os.path.basename(path), transform.GetClassName(),
                                         reader.GetFileFormatAsString()))
    return transform


def make_property(threshold, top, color):
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in ((threshold, 0.0), (0.85 * threshold + 0.15 * top, 0.4), (top, 0.95)):
        opacity.AddPoint(scalar, alpha)
    colors = vtkColorTransferFunction()
    colors.AddRGBPoint(threshold, *color)
    colors.AddRGBPoint(top, 1.0, 1.0, 0.95)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(2.0)
    prop.SetColor(colors)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    return prop


class View:
    """One volume, rendered into arrays with the common camera."""

    def __init__(self, image, prop, deformation=None):
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        if deformation is not None:
            # A point of the fixed volume tells where the moving one is sampled.
            self.mapper.SetDeformation(deformation)
            self.mapper.SetInverseModeToPullBack()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(prop)

    def render(self, renderer, size):
        colors = vtkImageData()
        if self.mapper.RenderToImage(renderer, self.volume, size, size, colors, None) != 1:
            sys.exit("rendering failed")
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(size, size, 4)
        alpha = rgba[..., 3:].astype(np.float32) / 255.0
        return (rgba[..., :3] * alpha + np.array(BACKGROUND) * (1.0 - alpha)).astype(np.uint8)


def checkerboard(first, second, fields):
    cells = np.arange(first.shape[0]) * fields // first.shape[0]
    mask = (cells[:, None] + cells[None, :]) % 2 == 0
    return np.where(mask[..., None], first, second)


def to_image(rgb):
    image = vtkImageData()
    image.SetDimensions(rgb.shape[1], rgb.shape[0], 1)
    image.GetPointData().SetScalars(
        numpy_to_vtk(np.ascontiguousarray(rgb).reshape(-1, 3), deep=True))
    return image


class Viewer:
    def __init__(self, fixed, moving, transform, thresholds, size, fields):
        self.size = size
        self.fields = fields
        bone = make_property(thresholds[0], fixed.GetScalarRange()[1], (0.55, 0.72, 0.95))
        other = make_property(thresholds[1], 0.6 * moving.GetScalarRange()[1], (0.95, 0.66, 0.45))
        self.fixed = View(fixed, bone)
        self.before = View(moving, other)
        self.after = View(moving, other, transform)
        self.show_before = False
        self.renderer = vtkRenderer()
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(-0.75, -1.0, -0.1)
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetViewUp(0.0, 0.0, -1.0)
        self.renderer.ResetCamera(fixed.GetBounds())
        camera.Zoom(1.3)

    def compose(self, size=None):
        """Fixed, before, after and checkerboard, row by row from the bottom."""
        size = size or self.size
        fixed = self.fixed.render(self.renderer, size)
        before = self.before.render(self.renderer, size)
        after = self.after.render(self.renderer, size)
        other = before if self.show_before else after
        return np.vstack([np.hstack([after, checkerboard(fixed, other, self.fields)]),
                          np.hstack([fixed, before])])

    def write(self, path):
        start = time.perf_counter()
        rgb = self.compose()
        print("  three volumes of %d x %d pixels: %.0f ms" % (
            self.size, self.size, 1e3 * (time.perf_counter() - start)))
        writer = vtkPNGWriter()
        writer.SetInputData(to_image(rgb))
        writer.SetFileName(path)
        writer.Write()
        if writer.GetErrorCode() != 0 or not os.path.exists(path):
            sys.exit("cannot write %s: is the folder writable?" % path)
        print("  written to %s" % path)

    def interact(self):
        mapper = vtkImageMapper()
        mapper.SetColorWindow(255)
        mapper.SetColorLevel(127.5)
        actor = vtkActor2D()
        actor.SetMapper(mapper)
        # The pictures are drawn by us; the window's renderer only has the camera that is dragged.
        self.renderer.AddActor2D(actor)
        window = vtkRenderWindow()
        window.SetWindowName("registration: fixed, before, after, checkerboard")
        window.SetSize(2 * self.size, 2 * self.size)
        window.AddRenderer(self.renderer)
        interactor = vtkRenderWindowInteractor()
        interactor.SetRenderWindow(window)
        interactor.SetInteractorStyle(vtkInteractorStyleTrackballCamera())
        drawing = [False]

        def draw(*_):
            if not drawing[0]:
                drawing[0] = True
                mapper.SetInputData(to_image(self.compose()))
                window.Render()
                drawing[0] = False

        def on_key(caller, _event):
            key = caller.GetKeySym()
            if key in ("plus", "KP_Add", "equal"):
                self.fields = min(64, self.fields + 1)
            elif key in ("minus", "KP_Subtract"):
                self.fields = max(1, self.fields - 1)
            elif key == "b":
                self.show_before = not self.show_before
            else:
                return
            draw()

        interactor.AddObserver("KeyPressEvent", on_key)
        self.renderer.GetActiveCamera().AddObserver("ModifiedEvent", draw)
        print("keys: + and - fields of the checkerboard, b before or after, q quit")
        draw()
        interactor.Start()


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fixed", default=os.path.join(DATA, "cthead.vti"), help="fixed volume")
    parser.add_argument("--moving", default=os.path.join(DATA, "headsq.vti"), help="moving volume")
    parser.add_argument("--transform",
                        default=os.path.join(DATA, "Transforms", "elastix_bspline.txt"),
                        help="what maps points of the fixed volume to points of the moving one")
    parser.add_argument("--coordinates", choices=("LPS", "RAS"), default="LPS",
                        help="of .vti volumes; files of other formats are read in LPS")
    parser.add_argument("--thresholds", type=number(-1e30, 1e30), nargs=2, default=(110.0, 1150.0),
                        help="scalars of the fixed and the moving volume where they become visible")
    parser.add_argument("--fields", type=pixels, default=6, help="of the checkerboard, per side")
    parser.add_argument("--size", type=pixels, default=400, help="pixels of a side of each picture")
    parser.add_argument("--output", default="output", help="folder for the picture")
    parser.add_argument("--interactive", action="store_true", help="open a window")
    arguments = parser.parse_args()
    make_folder(arguments.output)
    viewer = Viewer(read_image(arguments.fixed), read_image(arguments.moving),
                    read_transform(arguments.transform, arguments.coordinates),
                    arguments.thresholds, arguments.size, arguments.fields)
    viewer.write(os.path.join(arguments.output, "registration.png"))
    if arguments.interactive:
        require_display("registration_viewer", on_screen=True)
        viewer.interact()


if __name__ == "__main__":
    main()
