#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Render the engine block and the CT head, each at rest and bent by a lattice.

Writes one PNG with both side by side for each volume and prints what the pictures cost and what
the usual way, resampling the volume, would have cost. With --interactive a window opens at the
end: drag to look around, press keys 1 to 5 to change the shape, + and - its strength.
"""

import argparse
import os
import sys
import time

import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkImageReslice
from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkRenderWindow,
    vtkRenderWindowInteractor,
    vtkTextActor,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)

import vtkffd
from display import require_display
from options import make_folder

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")

SCENES = {
    "engine": {
        "file": "engine.vti",
        "title": "engine block (CT)",
        "opacity": [(60, 0.0), (90, 0.12), (150, 0.15), (175, 0.85), (255, 0.95)],
        "color": [
            (60, 0.75, 0.55, 0.35),
            (140, 0.85, 0.78, 0.65),
            (170, 0.55, 0.65, 0.85),
            (255, 0.9, 0.95, 1.0),
        ],
        "unit": 1.0,
        "shape": "BEND",
        "strength": 0.9,
        "view": ((0.75, 0.55, 1.0), (0.0, 1.0, 0.0)),
    },
    "cthead": {
        "file": "cthead.vti",
        "title": "CT head",
        "opacity": [(60, 0.0), (75, 0.25), (110, 0.3), (140, 0.9), (255, 0.95)],
        "color": [
            (60, 0.85, 0.6, 0.48),
            (110, 0.9, 0.7, 0.58),
            (140, 0.98, 0.94, 0.86),
            (255, 1.0, 1.0, 0.97),
        ],
        "unit": 1.0,
        "shape": "TWIST",
        "strength": 0.6,
        "view": ((-0.6, -1.0, -0.15), (0.0, 0.0, -1.0)),
    },
}

SHAPES = ["IDENTITY", "BEND", "TWIST", "TAPER", "BULGE", "WAVE"]


def make_property(scene):
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in scene["opacity"]:
        opacity.AddPoint(scalar, alpha)
    color = vtkColorTransferFunction()
    for point in scene["color"]:
        color.AddRGBPoint(*point)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetScalarOpacityUnitDistance(scene["unit"])
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    prop.SetSpecular(0.3)
    prop.SetSpecularPower(20.0)
    return prop


def make_lattice(image, shape, strength):
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(8, 8, 8)
    lattice.FitToBounds(image.GetBounds())
    source = vtkffd.vtkFFDLatticeSource
    source.ApplyShape(lattice, getattr(source, shape), strength)
    return lattice


def median_seconds(action, repeats=5):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return sorted(times)[len(times) // 2]


class View:
    """A volume at rest on the left, deformed on the right, seen by one camera."""

    def __init__(self, scene, size=512):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(os.path.join(DATA, scene["file"]))
        reader.Update()
        self.image = reader.GetOutput()
        self.window = vtkRenderWindow()
        self.window.SetSize(2 * size, size)
        self.window.SetMultiSamples(0)
        self.window.SetWindowName("vtkFFD: " + scene["title"])
        self.mappers = []
        self.renderers = []
        self.labels = []
        prop = make_property(scene)
        for side, text in enumerate(("at rest", "deformed")):
            mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
            mapper.SetInputData(self.image)
            volume = vtkVolume()
            volume.SetMapper(mapper)
            volume.SetProperty(prop)
            renderer = vtkRenderer()
            renderer.SetViewport(0.5 * side, 0.0, 0.5 * side + 0.5, 1.0)
            renderer.SetBackground(0.10, 0.11, 0.13)
            renderer.AddVolume(volume)
            label = vtkTextActor()
            label.SetInput("%s, %s" % (scene["title"], text))
            label.GetTextProperty().SetFontSize(18)
            label.SetPosition(12, 10)
            renderer.AddViewProp(label)
            self.window.AddRenderer(renderer)
            self.mappers.append(mapper)
            self.renderers.append(renderer)
            self.labels.append(label)
        self.set_shape(scene["shape"], scene["strength"])
        camera = self.renderers[1].GetActiveCamera()
        direction, up = scene["view"]
        camera.SetPosition(*direction)
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetViewUp(*up)
        # The bounds of the mapper are those of the deformed volume, so the bulge is in view.
        self.renderers[1].ResetCamera()
        camera.Zoom(1.35)
        self.renderers[0].SetActiveCamera(camera)

    def set_shape(self, shape, strength):
        self.shape = shape
        self.strength = strength
        self.lattice = make_lattice(self.image, shape, strength)
        self.mappers[1].SetDeformation(self.lattice)

    def write(self, path):
        self.window.Render()
        capture = vtkWindowToImageFilter()
        capture.SetInput(self.window)
        capture.ReadFrontBufferOff()
        writer = vtkPNGWriter()
        writer.SetInputConnection(capture.GetOutputPort())
        writer.SetFileName(path)
        writer.Write()
        if writer.GetErrorCode() != 0 or not os.path.exists(path):
            sys.exit("cannot write %s: is the folder writable?" % path)


def measure(view):
    """Print what a frame costs and what resampling the volume instead would."""
    dims = view.image.GetDimensions()
    print("  volume: %d x %d x %d voxels" % dims)
    mapper = view.mappers[1]
    view.renderers[0].DrawOff()
    frame = median_seconds(view.window.Render)

    step = [0.0]

    rest = [0.0, 0.0, 0.0]
    view.lattice.GetDisplacement(4, 4, 4, rest)

    def drag():
        # Move one control point and draw: what dragging it with the mouse does.
        step[0] = 1.0 - step[0]
        view.lattice.SetDisplacement(4, 4, 4, rest[0] + step[0], rest[1], rest[2])
        view.window.Render()

    edit = median_seconds(drag)
    view.renderers[0].DrawOn()
    reslice = vtkImageReslice()
    reslice.SetInputData(view.image)
    inverse = vtkffd.vtkFFDLattice()
    inverse.DeepCopy(view.lattice)
    # Resampling asks where each output voxel comes from; the lattice read as that pull-back costs
    # as much as an inverse that is known in closed form would.
    reslice.SetResliceTransform(inverse)
    reslice.SetInterpolationModeToLinear()
    start = time.perf_counter()
    reslice.Update()
    resample = time.perf_counter() - start
    print("  frame, deformed:                     %8.1f ms" % (1e3 * frame))
    print("  one control point moved -> picture:  %8.1f ms" % (1e3 * edit))
    print("  resampling the volume instead:       %8.1f ms, before its first picture"
          % (1e3 * resample))
    voxel_bytes = view.image.GetPointData().GetScalars().GetDataTypeSize()
    print("  memory besides the volume:           %8.2f %% of it"
          % (100.0 * mapper.GetAuxiliaryMemorySize() / (dims[0] * dims[1] * dims[2] * voxel_bytes)))


def interact(view):
    window = view.window
    interactor = vtkRenderWindowInteractor()
    interactor.SetRenderWindow(window)
    interactor.SetInteractorStyle(vtkInteractorStyleTrackballCamera())

    def on_key(caller, _event):
        key = caller.GetKeySym()
        if key in ("1", "2", "3", "4", "5"):
            view.set_shape(SHAPES[int(key)], view.strength)
        elif key in ("plus", "KP_Add", "equal"):
            view.set_shape(view.shape, view.strength + 0.1)
        elif key in ("minus", "KP_Subtract"):
            view.set_shape(view.shape, view.strength - 0.1)
        else:
            return
        view.labels[1].SetInput("%s, strength %.1f" % (view.shape.lower(), view.strength))
        window.Render()

    interactor.AddObserver("KeyPressEvent", on_key)
    print("keys: 1 bend, 2 twist, 3 taper, 4 bulge, 5 wave, + and - strength, q quit")
    window.Render()
    interactor.Start()


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default="output", help="folder for the pictures")
    parser.add_argument("--interactive", action="store_true", help="open a window at the end")
    arguments = parser.parse_args()
    require_display("render_deformed", on_screen=arguments.interactive)
    make_folder(arguments.output)
    for name, scene in SCENES.items():
        print(scene["title"])
        view = View(scene)
        view.window.SetOffScreenRendering(1)
        view.write(os.path.join(arguments.output, name + ".png"))
        measure(view)
    if arguments.interactive:
        interact(View(SCENES["engine"]))


if __name__ == "__main__":
    main()
