#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Let the CT head fall onto the floor, as a jelly of springs, and write the frames as PNG.

The lattice is a body (vtkFFDMassSpring); each frame renders the same volume with the lattice of that
moment. Needs a display, or Module/CMake/with-xvfb.sh in front. A film from the frames, for instance:
ffmpeg -framerate 30 -i output/fall/frame%03d.png fall.mp4
"""

import argparse
import os
import sys
import time

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)

import vtkffd
from display import require_display
from options import make_folder, number, pixels

HEAD = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data",
                    "cthead.vti")
GRAVITY = 9810.0  # mm / s^2; down is +z in this volume
DROP = 120.0  # mm, from the chin to the floor
STEP = 1.0 / 600.0  # s, of the simulation


def make_property():
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in ((60, 0.0), (75, 0.25), (110, 0.3), (140, 0.9), (255, 0.95)):
        opacity.AddPoint(scalar, alpha)
    color = vtkColorTransferFunction()
    for point in ((60, 0.85, 0.6, 0.48), (110, 0.9, 0.7, 0.58), (140, 0.98, 0.94, 0.86)):
        color.AddRGBPoint(*point)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    return prop


def make_body(bounds, stiffness):
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(8, 8, 8)
    lattice.FitToBounds(bounds)
    body = vtkffd.vtkFFDMassSpring()
    body.SetLattice(lattice)
    body.SetTimeStep(STEP)
    body.SetMass(4.5)  # kg
    body.SetStructuralStiffness(stiffness)
    body.SetShearStiffness(0.5 * stiffness)
    body.SetBendStiffness(0.25 * stiffness)
    body.SetDamping(1.0)
    body.SetGravity(0.0, 0.0, GRAVITY)
    body.SetInitialSpin(1.5, 0.6, 0.0)
    body.FloorOn()
    body.SetFloorOrigin(0.0, 0.0, bounds[5] + DROP)
    body.SetFloorNormal(0.0, 0.0, -1.0)
    return body


def make_scene(image, body, size):
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputData(image)
    mapper.SetDeformation(body.GetLattice())
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(make_property())
    bounds = image.GetBounds()
    floor = bounds[5] + DROP
    plane = vtkPlaneSource()
    plane.SetOrigin(bounds[0] - 250.0, bounds[2] - 250.0, floor)
    plane.SetPoint1(bounds[1] + 250.0, bounds[2] - 250.0, floor)
    plane.SetPoint2(bounds[0] - 250.0, bounds[3] + 250.0, floor)
    plane.SetResolution(12, 12)
    plane_mapper = vtkPolyDataMapper()
    plane_mapper.SetInputConnection(plane.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(plane_mapper)
    actor.GetProperty().SetColor(0.35, 0.42, 0.5)
    actor.GetProperty().EdgeVisibilityOn()
    actor.GetProperty().SetEdgeColor(0.25, 0.3, 0.36)
    actor.GetProperty().LightingOff()
    renderer = vtkRenderer()
    renderer.SetBackground(0.10, 0.11, 0.13)
    renderer.AddActor(actor)
    renderer.AddVolume(volume)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(-0.7, -1.0, -0.35)
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetViewUp(0.0, 0.0, -1.0)
    renderer.ResetCamera(bounds[0] - 40.0, bounds[1] + 40.0, bounds[2] - 40.0, bounds[3] + 40.0,
                         bounds[4], floor)
    camera.Zoom(1.35)
    renderer.ResetCameraClippingRange()
    return window


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default=os.path.join("output", "fall"),
                        help="folder for the frames")
    parser.add_argument("--seconds", type=number(0.0), default=1.5, help="time to simulate")
    parser.add_argument("--rate", type=float, default=60.0,
                        help="frames per simulated second; 600 is the most")
    parser.add_argument("--size", type=pixels, default=512, help="pixels of a side")
    parser.add_argument("--stiffness", type=number(0.0), default=500.0,
                        help="of the springs along the axes, N/m")
    arguments = parser.parse_args()
    require_display("falling_head")
    make_folder(arguments.output)
    if not 0.0 < arguments.rate <= 600.0:
        sys.exit("the rate must be above 0 and at most 600 frames per second")
    reader = vtkXMLImageDataReader()
    reader.SetFileName(HEAD)
    reader.Update()
    body = make_body(reader.GetOutput().GetBounds(), arguments.stiffness)
    window = make_scene(reader.GetOutput(), body, arguments.size)
    simulation = drawing = 0.0
    frames = int(arguments.seconds * arguments.rate) + 1
    for frame in range(frames):
        start = time.perf_counter()
        steps = round(frame / arguments.rate / STEP) - round(body.GetTime() / STEP)
        if body.Step(steps) != 1:
            sys.exit("the simulation failed")
        simulation += time.perf_counter() - start
        start = time.perf_counter()
        window.Render()
        drawing += time.perf_counter() - start
        capture = vtkWindowToImageFilter()
        capture.SetInput(window)
        capture.ReadFrontBufferOff()
        writer = vtkPNGWriter()
        writer.SetInputConnection(capture.GetOutputPort())
        writer.SetFileName(os.path.join(arguments.output, "frame%03d.png" % frame))
        writer.Write()
        if writer.GetErrorCode() != 0:
            sys.exit("cannot write into %s: is the folder writable?" % arguments.output)
    print("%d frames in %s" % (frames, arguments.output))
    print("  simulation: %6.1f ms a frame" % (1e3 * simulation / frames))
    print("  drawing:    %6.1f ms a frame" % (1e3 * drawing / frames))


if __name__ == "__main__":
    main()
