#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A surface and a volume, deformed together.

The skin of the CT head is a volume; the bone is a surface that was contoured from it at rest, and
a few landmarks are points. vtkFFDInverseRayVolumeMapper bends the rays through the volume,
vtkFFDDeformGeometry moves the surface and the points by the same lattice, so that they stay where
they belong. Left at rest, right deformed.

    PYTHONPATH=build/python Examples/Python/deform_surface.py

Pictures need an X display; Module/CMake/with-xvfb.sh provides one.
"""

import argparse
import os

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  registers the OpenGL classes
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkGlyph3D
from vtkmodules.vtkFiltersSources import vtkSphereSource
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

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")


def make_skin():
    """Translucent, so that the bone shows through."""
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in [(55, 0.0), (70, 0.06), (110, 0.05), (130, 0.0)]:
        opacity.AddPoint(scalar, alpha)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(55, 0.9, 0.62, 0.5)
    color.AddRGBPoint(130, 0.95, 0.75, 0.65)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    return prop


def make_landmarks(surface, count=24):
    """Points spread over the surface."""
    points = vtkPoints()
    step = max(1, surface.GetNumberOfPoints() // count)
    for i in range(step // 2, surface.GetNumberOfPoints(), step):
        points.InsertNextPoint(surface.GetPoint(i))
    landmarks = vtkPolyData()
    landmarks.SetPoints(points)
    return landmarks


def add_geometry(renderer, source, color):
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color)
    actor.GetProperty().SetSpecular(0.3)
    renderer.AddActor(actor)


def moved(data, deform):
    """Geometry that follows the lattice of the volume."""
    geometry = vtkffd.vtkFFDDeformGeometry()
    geometry.SetInputData(data)
    geometry.SetLatticeConnection(deform.GetOutputPort())
    return geometry


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default="output", help="folder for the picture")
    parser.add_argument("--size", type=pixels, default=512, help="height in pixels")
    parser.add_argument("--strength", type=number(-100.0, 100.0), default=0.8, help="of the twist")
    arguments = parser.parse_args()
    require_display("deform_surface")
    make_folder(arguments.output)

    reader = vtkXMLImageDataReader()
    reader.SetFileName(os.path.join(DATA, "cthead.vti"))
    reader.Update()
    image = reader.GetOutput()
    contour = vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, 135)
    contour.Update()
    bone = contour.GetOutput()
    landmarks = make_landmarks(bone)

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(2 * arguments.size, arguments.size)
    camera = None
    for side, strength in enumerate((0.0, arguments.strength)):
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(8, 8, 8)
        lattice.FitToBounds(image.GetBounds())
        source = vtkffd.vtkFFDLatticeSource
        source.ApplyShape(lattice, source.TWIST, strength)
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(image)
        deform.SetLattice(lattice)

        renderer = vtkRenderer()
        renderer.SetViewport(0.5 * side, 0.0, 0.5 * side + 0.5, 1.0)
        renderer.SetBackground(0.10, 0.11, 0.13)
        add_geometry(renderer, moved(bone, deform), (0.95, 0.92, 0.82))
        ball = vtkSphereSource()
        ball.SetRadius(0.015 * image.GetLength())
        points = moved(landmarks, deform)
        glyphs = vtkGlyph3D()
        glyphs.SetInputConnection(points.GetOutputPort())
        glyphs.SetSourceConnection(ball.GetOutputPort())
        add_geometry(renderer, glyphs, (0.2, 0.7, 1.0))
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputConnection(deform.GetOutputPort())
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(make_skin())
        renderer.AddVolume(volume)
        window.AddRenderer(renderer)
        if camera is None:
            camera = renderer.GetActiveCamera()
            camera.SetFocalPoint(0.0, 0.0, 0.0)
            camera.SetPosition(-0.6, -1.0, -0.15)
            camera.SetViewUp(0.0, 0.0, -1.0)
            renderer.ResetCamera(image.GetBounds())
            camera.Dolly(1.2)
        else:
            renderer.SetActiveCamera(camera)
        renderer.ResetCameraClippingRange()
    window.Render()
    capture = vtkWindowToImageFilter()
    capture.SetInput(window)
    capture.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    path = os.path.join(arguments.output, "surface.png")
    writer.SetFileName(path)
    writer.SetInputConnection(capture.GetOutputPort())
    writer.Write()
    print("%d triangles and %d landmarks moved with the volume: %s"
          % (bone.GetNumberOfPolys(), landmarks.GetNumberOfPoints(), path))


if __name__ == "__main__":
    main()
