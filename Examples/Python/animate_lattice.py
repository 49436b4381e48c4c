#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Animate keyframed lattices: one picture a frame.

The CT head nods, turns and comes back to rest. The deformation of every frame is interpolated
between keyframes by vtkFFDDeformVolume, following the time of the pipeline; the volume itself is
never resampled. No window or display is needed.

    PYTHONPATH=build/python Examples/Python/animate_lattice.py --frames 60
    ffmpeg -framerate 25 -i output/animation/frame_%04d.png animation.mp4
"""

import argparse
import os
import sys
import time

from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkImageBlend
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)

import vtkffd
from options import make_folder, pixels

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")

# (time, shape, strength) of the keyframes.
KEYFRAMES = [
    (0.0, "IDENTITY", 0.0),
    (1.0, "BEND", 0.5),
    (2.0, "TWIST", -0.6),
    (3.0, "BULGE", 0.7),
    (4.0, "IDENTITY", 0.0),
]


def make_property():
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in [(60, 0.0), (75, 0.25), (110, 0.3), (140, 0.9), (255, 0.95)]:
        opacity.AddPoint(scalar, alpha)
    color = vtkColorTransferFunction()
    for point in [(60, 0.85, 0.6, 0.48), (110, 0.9, 0.7, 0.58), (140, 0.98, 0.94, 0.86),
                  (255, 1.0, 1.0, 0.97)]:
        color.AddRGBPoint(*point)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    prop.SetSpecular(0.3)
    prop.SetSpecularPower(20.0)
    return prop


def make_animation(reader):
    """The volume with a lattice at each keyframe."""
    deform = vtkffd.vtkFFDDeformVolume()
    deform.SetInputConnection(reader.GetOutputPort())
    for when, shape, strength in KEYFRAMES:
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(8, 8, 8)
        lattice.FitToBounds(reader.GetOutput().GetBounds())
        source = vtkffd.vtkFFDLatticeSource
        source.ApplyShape(lattice, getattr(source, shape), strength)
        deform.AddKeyframe(when, lattice)
    deform.SetKeyframeInterpolationToSpline()
    return deform


def background(size, color):
    image = vtkImageData()
    image.SetDimensions(size, size, 1)
    image.AllocateScalars(3, 4)
    for component, value in enumerate(color + (255,)):
        image.GetPointData().GetScalars().FillComponent(component, value)
    return image


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default="output", help="the frames go to animation/ in there")
    parser.add_argument("--frames", type=int, default=40, help="number of frames, 2 or more")
    parser.add_argument("--size", type=pixels, default=400, help="width and height in pixels")
    arguments = parser.parse_args()
    if arguments.frames < 2:
        sys.exit("--frames must be 2 or more")
    folder = os.path.join(arguments.output, "animation")
    make_folder(folder)

    reader = vtkXMLImageDataReader()
    reader.SetFileName(os.path.join(DATA, "cthead.vti"))
    reader.Update()
    deform = make_animation(reader)
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputConnection(deform.GetOutputPort())
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(make_property())
    renderer = vtkRenderer()
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    bounds = reader.GetOutput().GetBounds()
    camera.SetFocalPoint([0.5 * (bounds[2 * a] + bounds[2 * a + 1]) for a in range(3)])
    camera.SetPosition([f + d for f, d in zip(camera.GetFocalPoint(), (-0.6, -1.0, -0.15))])
    camera.SetViewUp(0.0, 0.0, -1.0)
    # Room for every shape: the camera stands still.
    diagonal = sum((bounds[2 * a + 1] - bounds[2 * a]) ** 2 for a in range(3)) ** 0.5
    renderer.ResetCamera([value + side * 0.1 * diagonal
                          for value, side in zip(bounds, (-1, 1) * 3)])
    camera.Dolly(1.7)
    renderer.ResetCameraClippingRange([value + side * diagonal
                                       for value, side in zip(bounds, (-1, 1) * 3)])

    writer = vtkPNGWriter()
    blend = vtkImageBlend()
    picture = vtkImageData()
    blend.AddInputData(background(arguments.size, (25, 28, 33)))
    blend.AddInputData(picture)
    writer.SetInputConnection(blend.GetOutputPort())
    first, last = KEYFRAMES[0][0], KEYFRAMES[-1][0]
    seconds = 0.0
    for frame in range(arguments.frames):
        when = first + (last - first) * frame / (arguments.frames - 1)
        start = time.perf_counter()
        deform.UpdateTimeStep(when)
        if not mapper.RenderToImage(renderer, volume, arguments.size, arguments.size, picture):
            sys.exit("frame %d could not be rendered" % frame)
        seconds += time.perf_counter() - start
        picture.Modified()
        writer.SetFileName(os.path.join(folder, "frame_%04d.png" % frame))
        writer.Write()
    print("%d frames of %d x %d in %s, %.0f ms a frame"
          % (arguments.frames, arguments.size, arguments.size, folder,
             1e3 * seconds / arguments.frames))


if __name__ == "__main__":
    main()
