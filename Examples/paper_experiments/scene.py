# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What section 5 of the paper renders: the engine, three opacity settings, deformations of growing
magnitude, and the ways to render them.

The paper names the volume and the limits of the segments, but neither its transfer functions,
camera, control points, sample distance nor termination threshold. What is chosen here, and why, is
said beside each choice and in README.md.
"""

import math
import os
from dataclasses import dataclass

import numpy

# Lights of the renderer come from the OpenGL factory; no window is ever opened.
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

import vtkffd

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")

#: The paper's engine has 256 x 256 x 113 voxels: the slices of ours that hold something.
SLICES = 113

#: Magnitudes of table 1, and of the curves of figures 6 and 7: the largest displacement of a
#: control point per axis, in voxels.
TABLE_MAGNITUDES = (0, 15, 30, 45)
CURVE_MAGNITUDES = (0, 5, 10, 15, 20, 25, 30, 35, 40, 45)

#: Voxels. The shortest segment is half a voxel "due to the Shannon theorem" (section 4.5), so the
#: samples are taken to be as dense. A ray through empty space alone cannot do better than the
#: longest segment over this, 8 / 0.5 = 16; with one voxel it would be 8, and the speed-ups of 13.70
#: and 14.16 in table 1 would be out of reach.
SAMPLE_DISTANCE = 0.5

#: Opacity settings, (scalar, opacity) points. The ramps are chosen so that the paper's method,
#: undeformed, gets about the speed-ups of table 1: 4.43, 13.70 and 14.16.
OPACITIES = {
    "semi": ((70, 0.0), (255, 0.43)),
    "opaque": ((70, 0.0), (80, 1.0), (255, 1.0)),
    "sparse": ((170, 0.0), (190, 1.0), (255, 1.0)),
}
OPACITY_TITLES = {
    "semi": "semi-transparent",
    "opaque": "opaque",
    "sparse": "opaque with lots of empty space",
}


def read_engine():
    """The engine block, 256 x 256 x 113 voxels of edge 1."""
    path = os.path.join(DATA, "engine.vti")
    reader = vtkXMLImageDataReader()
    if not os.path.exists(path) or not reader.CanReadFile(path):
        raise SystemExit("paper_experiments: cannot read %s" % path)
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    extent = list(image.GetExtent())
    extent[5] = extent[4] + SLICES - 1
    image.Crop(extent)
    return image


def make_property(opacity, shade=True):
    alpha = vtkPiecewiseFunction()
    for scalar, value in OPACITIES[opacity]:
        alpha.AddPoint(scalar, value)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(70, 0.80, 0.66, 0.48)
    color.AddRGBPoint(150, 0.88, 0.82, 0.72)
    color.AddRGBPoint(190, 0.60, 0.70, 0.86)
    color.AddRGBPoint(255, 0.90, 0.95, 1.0)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(alpha)
    prop.SetColor(color)
    prop.SetScalarOpacityUnitDistance(1.0)
    prop.SetInterpolationTypeToLinear()
    prop.SetShade(1 if shade else 0)
    prop.SetAmbient(0.15)
    prop.SetDiffuse(0.8)
    prop.SetSpecular(0.25)
    prop.SetSpecularPower(16.0)
    return prop


def _half_cosine(u):
    return math.cos(math.pi * (u - 0.5))


def _smooth(magnitude, u):
    """Bends the whole block: half a cosine over the longest way."""
    return magnitude * numpy.array(
        [_half_cosine(u[2]), 22.0 / 45.0 * _half_cosine(u[0]), 0.0])


def _wave(magnitude, u):
    """Two periods of a sine along each axis: smooth, but as bent as eight control points allow."""
    wave = [math.sin(4.0 * math.pi * x) for x in u]
    return magnitude * numpy.array([wave[1], 0.5 * wave[2], 0.5 * wave[0]])


@dataclass(frozen=True)
class Shape:
    title: str
    side: int  # control points per axis
    move: object = None  # function of magnitude and position in 0..1; None: random


#: Deformations. The paper's is not known. With the random one the segments of the paper's method
#: fall to 1.8 voxels at 45, to where the paper says that they fall: 1.8 to 2.0.
SHAPES = {
    "smooth": Shape("smooth bend, 8 x 8 x 8 control points", 8, _smooth),
    "wave": Shape("two waves per axis, 8 x 8 x 8 control points", 8, _wave),
    "random": Shape("random, 9 x 9 x 9 control points", 9),
    "crumpled": Shape("random, 16 x 16 x 16 control points", 16),
}

#: The deformations of figures 5 to 7 and table 1; figure 8 is about a severe one.
CURVE_SHAPES = ("smooth", "wave", "random")
FIGURE8_SHAPE = "crumpled"
FIGURE8_MAGNITUDE = 30


def make_lattice(image, shape, magnitude):
    """Control points over the bounds of the image, each moved by at most `magnitude` per axis."""
    bounds = image.GetBounds()
    side = SHAPES[shape].side
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(side, side, side)
    lattice.FitToBounds(bounds)
    # The generator of numpy whose numbers are promised never to change.
    generator = numpy.random.RandomState(3)
    for k in range(side):
        for j in range(side):
            for i in range(side):
                if SHAPES[shape].move:
                    rest = [0.0, 0.0, 0.0]
                    lattice.GetRestPoint(i, j, k, rest)
                    u = [(rest[a] - bounds[2 * a]) / (bounds[2 * a + 1] - bounds[2 * a])
                         for a in range(3)]
                    move = SHAPES[shape].move(magnitude, u)
                else:
                    move = magnitude * generator.uniform(-1.0, 1.0, 3)
                lattice.SetDisplacement(i, j, k, *move)
    return lattice


#: Ways to render, in the order of the report.
METHODS = {
    "paper": "the paper's method: GREEDY_ANGLE, SEGMENT, FIRST_ORDER, MATERIAL",
    "default": "vtkFFD, default settings: ERROR_BOUND, LIPSCHITZ, EXACT, WORLD",
    "firstorder": "vtkFFD, default settings but FIRST_ORDER",
}


def make_mapper(image, lattice, method, optimized=True, sample_distance=SAMPLE_DISTANCE):
    """`optimized`: with space leaping and early ray termination, or with neither."""
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputData(image)
    mapper.SetDeformation(lattice)
    mapper.SetSampleDistance(sample_distance)
    mapper.CollectStatisticsOn()
    if method == "paper":
        mapper.SetSegmentationToGreedyAngle()
        mapper.SetMaximumSegmentLength(8.0)
        mapper.SetSpaceLeapingToSegment()
        mapper.SetInverseModeToFirstOrder()
        mapper.SetOpacityLengthToMaterial()
    elif method == "firstorder":
        mapper.SetInverseModeToFirstOrder()
    elif method != "default":
        raise ValueError("unknown method '%s'" % method)
    if not optimized:
        mapper.SetSpaceLeapingToOff()
        mapper.SetEarlyRayTerminationThreshold(0.0)
    return mapper


#: Distance of the eye, in widths of the volume. Where rays are counted, the bounds of all deformed
#: shapes must be in view, or the rays that are cut off would change the averages.
COUNTING_DISTANCE = 3.0
PICTURE_DISTANCE = 2.3


def make_renderer(image, distance):
    """A perspective camera that sees three sides of the block."""
    bounds = image.GetBounds()
    center = numpy.array([0.5 * (bounds[2 * a] + bounds[2 * a + 1]) for a in range(3)])
    direction = numpy.array([-0.75, -0.55, -1.0])
    direction /= numpy.linalg.norm(direction)
    distance *= (bounds[1] - bounds[0])
    renderer = vtkRenderer()
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*center)
    camera.SetPosition(*(center - distance * direction))
    camera.SetViewUp(0.0, 1.0, 0.0)
    camera.SetViewAngle(2.0 * math.degrees(math.atan(0.25)))
    camera.SetClippingRange(0.2 * distance, 2.0 * distance)
    return renderer


@dataclass(frozen=True)
class Counts:
    """vtkFFDRayStatistics of one picture."""

    rays: int
    segments_per_ray: float
    segment_length: float
    samples: float
    visible_samples: float
    lookups: float
    evaluations: float
    unconverged: int

    @property
    def operations(self):
        """Table 1 counts each distance look-up as a sample."""
        return self.samples + self.lookups


@dataclass(frozen=True)
class Picture:
    colors: numpy.ndarray  # height x width x 4, 8 bits, rows top down, not premultiplied
    depths: numpy.ndarray  # world units from the eye along the view direction; inf: nothing there
    counts: Counts

    def over(self, background):
        """Colors over an opaque background, height x width x 3, 0..1."""
        rgba = self.colors.astype(float) / 255.0
        alpha = rgba[:, :, 3:]
        return rgba[:, :, :3] * alpha + numpy.asarray(background) * (1.0 - alpha)


def render(image, mapper, prop, size, distance=PICTURE_DISTANCE):
    """A picture of size x size pixels, the eye `distance` widths of the volume away."""
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    renderer = make_renderer(image, distance)
    colors = vtkImageData()
    depths = vtkImageData()
    if not mapper.RenderToImage(renderer, volume, size, size, colors, depths):
        raise SystemExit("paper_experiments: the mapper could not render")
    near, far = renderer.GetActiveCamera().GetClippingRange()
    window = vtk_to_numpy(depths.GetPointData().GetScalars()).reshape(size, size)[::-1]
    window = window.astype(float)
    away = numpy.where(
        window < 1.0, near * far / (far - window * (far - near)), numpy.inf)
    rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(size, size, 4)[::-1].copy()
    s = mapper.GetStatistics()
    counts = Counts(
        s.GetNumberOfRays(), s.GetSegmentsPerRay(), s.GetAverageSegmentLength(),
        s.GetSamplesPerRay(), s.GetVisibleSamplesPerRay(), s.GetDistanceLookupsPerRay(),
        s.GetEvaluationsPerRay(), s.GetNumberOfUnconvergedPoints())
    return Picture(rgba, away, counts)
