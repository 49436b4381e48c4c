#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures 2 to 4 of the paper, drawn with what vtkFFDRayTracer puts out.

figure2.png  left: the deformed engine block, and viewing rays through it; right: the same picture
             made the other way round, the block at rest and the inversely deformed rays
figure3.png  one viewing ray: its points P (white), where the deformation takes them (red), and
             the points 2P - T(P) that the ray is followed along instead (green), equation (3)
figure4.png  segments of a deformed ray between their vertices (green), equidistant samples
             (blue), and the shorter interval at the end of each segment, whose opacity is
             corrected (orange)

    PYTHONPATH=build/python Examples/Python/paper_figures.py

Pictures need an X display; Module/CMake/with-xvfb.sh provides one.
"""

import argparse
import os

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  registers the OpenGL classes
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPiecewiseFunction, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkGlyph3D, vtkTubeFilter
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
from options import make_folder, pixels

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")
WHITE, RED, GREEN = (0.95, 0.95, 0.95), (0.95, 0.3, 0.25), (0.3, 0.85, 0.35)
BLUE, ORANGE = (0.35, 0.65, 1.0), (1.0, 0.6, 0.1)
TRACED = 256  # pixels a side of the picture whose rays are traced


def make_lattice(image):
    """An S along y."""
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(8, 10, 6)
    lattice.FitToBounds(image.GetBounds())
    nx, ny, nz = lattice.GetDimensions()
    displacements = vtk_to_numpy(lattice.GetDisplacements()).reshape(nz, ny, nx, 3)
    # Node 1 rests at the lower end of the domain, node ny - 2 at the upper one.
    along = (np.arange(ny) - 1.0) / (ny - 3.0)
    displacements[..., 0] = 26.0 * np.sin(2.0 * np.pi * along)[None, :, None]
    lattice.Modified()
    return lattice


def make_volume(image, lattice):
    """The engine block; deformed by the paper's method if there is a lattice."""
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in [(70, 0.0), (100, 0.06), (170, 0.08), (200, 0.6), (255, 0.7)]:
        opacity.AddPoint(scalar, alpha)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(70, 0.75, 0.6, 0.45)
    color.AddRGBPoint(170, 0.6, 0.68, 0.8)
    color.AddRGBPoint(255, 0.9, 0.95, 1.0)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputData(image)
    mapper.SetDeformation(lattice)
    mapper.SetInverseModeToFirstOrder()
    mapper.SetSegmentationToGreedyAngle()
    mapper.SetMaximumSegmentLength(8.0)
    mapper.SetSpaceLeapingToOff()
    mapper.SetEarlyRayTerminationThreshold(0.0)
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    return volume


def trace(image, volume, pixels):
    """Rays along y through the volume, of pixels (column, row) of a square picture."""
    viewer = vtkRenderer()
    viewer.AddVolume(volume)
    aim(viewer, image, (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    tracer = vtkffd.vtkFFDRayTracer()
    tracer.SetRenderer(viewer)
    tracer.SetVolume(volume)
    tracer.SetImageSize(TRACED, TRACED)
    for x, y in pixels:
        tracer.AddPixel(x, y)
    tracer.Update()
    return tracer


def aim(renderer, image, direction, up, zoom=1.0):
    """A parallel view of the volume from a direction."""
    center = image.GetCenter()
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(center)
    camera.SetPosition([c + 1000.0 * d for c, d in zip(center, direction)])
    camera.SetViewUp(up)
    camera.SetParallelScale(0.5 * image.GetLength() / zoom)
    camera.SetClippingRange(1.0, 2000.0)


def add(renderer, source, color):
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color)
    actor.GetProperty().SetAmbient(0.4)
    renderer.AddActor(actor)


def add_lines(renderer, lines, color, radius):
    tubes = vtkTubeFilter()
    tubes.SetInputData(lines)
    tubes.SetRadius(radius)
    tubes.SetNumberOfSides(12)
    add(renderer, tubes, color)


def add_points(renderer, points, color, radius):
    data = vtkPolyData()
    places = vtkPoints()
    for point in points:
        places.InsertNextPoint(point)
    data.SetPoints(places)
    ball = vtkSphereSource()
    ball.SetRadius(radius)
    ball.SetThetaResolution(20)
    ball.SetPhiResolution(20)
    glyphs = vtkGlyph3D()
    glyphs.SetInputData(data)
    glyphs.SetSourceConnection(ball.GetOutputPort())
    add(renderer, glyphs, color)


def polyline(points, closed_pairs=None):
    """One line through the points, or one for each pair of points."""
    data = vtkPolyData()
    places = vtkPoints()
    cells = vtkCellArray()
    if closed_pairs is None:
        cells.InsertNextCell(len(points))
        for point in points:
            cells.InsertCellPoint(places.InsertNextPoint(point))
    else:
        for a, b in zip(points, closed_pairs):
            cells.InsertNextCell(2)
            cells.InsertCellPoint(places.InsertNextPoint(a))
            cells.InsertCellPoint(places.InsertNextPoint(b))
    data.SetPoints(places)
    data.SetLines(cells)
    return data


def write(renderers, size, path):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(size * len(renderers), size)
    for i, renderer in enumerate(renderers):
        renderer.SetViewport(i / len(renderers), 0.0, (i + 1) / len(renderers), 1.0)
        renderer.SetBackground(0.10, 0.11, 0.13)
        window.AddRenderer(renderer)
    window.Render()
    capture = vtkWindowToImageFilter()
    capture.SetInput(window)
    capture.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(capture.GetOutputPort())
    writer.Write()
    print(path)


def vertices(polydata):
    return [polydata.GetPoint(i) for i in range(polydata.GetNumberOfPoints())]


def draw_figure_2(image, lattice, size, path):
    row = TRACED // 2
    tracer = trace(image, make_volume(image, lattice),
                   [(x, row) for x in range(TRACED // 5, TRACED * 4 // 5 + 1, TRACED // 10)])
    renderers = []
    for deformed in (True, False):
        renderer = vtkRenderer()
        aim(renderer, image, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 1.1)
        renderer.AddVolume(make_volume(image, lattice if deformed else None))
        add_lines(renderer, tracer.GetOutput(1 if deformed else 0),
                  WHITE if deformed else GREEN, 0.004 * image.GetLength())
        renderers.append(renderer)
    write(renderers, size, path)


def draw_figure_3(image, lattice, size, path):
    volume = make_volume(image, lattice)
    volume.GetMapper().SetMaximumSegmentLength(16.0)
    volume.GetMapper().SetMinimumSegmentLength(4.0)
    tracer = trace(image, volume, [(TRACED // 2, TRACED // 2)])
    p = vertices(tracer.GetOutput(1))
    p_inv = vertices(tracer.GetOutput(0))
    p_ffd = [lattice.TransformPoint(point) for point in p]
    renderer = vtkRenderer()
    aim(renderer, image, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 1.25)
    unit = image.GetLength()
    for points, color in ((p, WHITE), (p_ffd, RED), (p_inv, GREEN)):
        add_lines(renderer, polyline(points), color, 0.002 * unit)
        add_points(renderer, points, color, 0.006 * unit)
    add_lines(renderer, polyline(p_ffd, p_inv), (0.45, 0.47, 0.5), 0.001 * unit)
    write([renderer], size, path)


def draw_figure_4(image, lattice, size, path):
    volume = make_volume(image, lattice)
    # Segments are often 8 voxels long: no multiple of this distance.
    volume.GetMapper().SetSampleDistance(1.7)
    tracer = trace(image, volume, [(TRACED * 7 // 10, TRACED // 2)])
    rest = tracer.GetOutput(0)
    samples = tracer.GetOutput(2)
    segment = vtk_to_numpy(samples.GetPointData().GetArray("Segment"))
    interval = vtk_to_numpy(samples.GetPointData().GetArray("Interval"))
    last = [i + 1 == len(segment) or segment[i + 1] != segment[i] for i in range(len(segment))]
    shorter = [last[i] and i > 0 and segment[i - 1] == segment[i]
               and interval[i] < 0.999 * interval[i - 1] for i in range(len(segment))]
    places = vertices(samples)
    renderer = vtkRenderer()
    aim(renderer, image, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
    camera = renderer.GetActiveCamera()
    # Close to where the ray turns.
    center = places[len(places) // 4]
    camera.SetFocalPoint(center)
    camera.SetPosition(center[0], center[1], center[2] + 1000.0)
    camera.SetParallelScale(13.0)
    add_lines(renderer, rest, GREEN, 0.12)
    add_points(renderer, vertices(rest), GREEN, 0.3)
    add_points(renderer, [q for q, s in zip(places, shorter) if not s], BLUE, 0.2)
    add_points(renderer, [q for q, s in zip(places, shorter) if s], ORANGE, 0.34)
    write([renderer], size, path)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default="output", help="folder for the pictures")
    parser.add_argument("--size", type=pixels, default=512, help="height in pixels")
    arguments = parser.parse_args()
    require_display("paper_figures")
    make_folder(arguments.output)
    reader = vtkXMLImageDataReader()
    reader.SetFileName(os.path.join(DATA, "engine.vti"))
    reader.Update()
    image = reader.GetOutput()
    lattice = make_lattice(image)
    for number, draw in ((2, draw_figure_2), (3, draw_figure_3), (4, draw_figure_4)):
        draw(image, lattice, arguments.size,
             os.path.join(arguments.output, "figure%d.png" % number))


if __name__ == "__main__":
    main()
