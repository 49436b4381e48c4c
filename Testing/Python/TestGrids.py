# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rectilinear grids and blanking: in all blend modes as the reference kernels, and about as fast as a
plain image.

    python3 TestGrids.py [--scenes FIRST:END]      the test alone runs the first few random scenes
"""

import argparse
import itertools
import sys
import unittest

import numpy
import vtkffd
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the window's implementation)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import (
    vtkImageData, vtkPiecewiseFunction, vtkPlane, vtkRectilinearGrid)
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

import ffdrandom

MODES = {"composite": 0, "maximum": 1, "minimum": 2, "average": 3, "additive": 4, "isosurface": 5,
         "slice": 6}
TYPES = ["uint8", "int8", "uint16", "int16", "int32", "float32", "float64"]
SIDE = 40.0
SIZE = 96


def make_positions(kind, n, random):
    """Coordinates from 0 to SIDE."""
    even = numpy.linspace(0.0, 1.0, n)
    if kind == "even":
        steps = even
    elif kind == "power":
        steps = even ** random.uniform(0.7, 2.5)
    elif kind == "random":
        steps = numpy.concatenate([[0.0], numpy.cumsum(random.uniform(0.1, 2.0, n - 1))])
    else: # clustered: steps differ by up to a million
        steps = numpy.concatenate(
            [[0.0], numpy.cumsum(10.0 ** random.uniform(-6.0 * (n > 8), 0.0, n - 1))])
    return SIDE * steps / steps[-1]


def make_field(x, y, z, random):
    """Smooth blobs, 0 to 100."""
    value = numpy.zeros_like(x)
    for _ in range(int(random.integers(2, 5))):
        center = SIDE * random.uniform(0.25, 0.75, 3)
        width = SIDE * random.uniform(0.15, 0.4)
        distance = (x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2
        value = numpy.maximum(value, numpy.exp(-distance / width ** 2))
    return numpy.round(100.0 * value)


def make_ghosts(kind, dims, random):
    """Flags of points or cells, x fastest."""
    n = [numpy.arange(d) / max(d - 1, 1) for d in dims[::-1]]
    z, y, x = numpy.meshgrid(*n, indexing="ij")
    if kind == "half":
        hidden = x + 0.3 * y > random.uniform(0.4, 0.9)
    elif kind == "ball":
        hidden = (x - 0.5) ** 2 + (y - 0.6) ** 2 + (z - 0.4) ** 2 < random.uniform(0.02, 0.12)
    else:
        hidden = random.random(x.shape) < random.choice([0.01, 0.2])
    return hidden.ravel().astype(numpy.uint8)


def make_data(positions, values, of_cells, image=False):
    """A grid, or an image of equal steps, of components that are flat arrays."""
    if image:
        data = vtkImageData()
        data.SetDimensions(*[len(p) for p in positions])
        data.SetSpacing(*[SIDE / (len(p) - 1) for p in positions])
    else:
        data = vtkRectilinearGrid()
        data.SetDimensions(*[len(p) for p in positions])
        for p, put in zip(positions, (data.SetXCoordinates, data.SetYCoordinates,
                                      data.SetZCoordinates)):
            put(numpy_to_vtk(p, deep=True))
    array = numpy_to_vtk(
        numpy.stack(values, axis=-1) if len(values) > 1 else values[0], deep=True)
    array.SetName("values")
    (data.GetCellData() if of_cells else data.GetPointData()).SetScalars(array)
    return data


def add_ghosts(data, kind, of_cells, random):
    dims = [d - (1 if of_cells else 0) for d in data.GetDimensions()]
    ghosts = numpy_to_vtk(make_ghosts(kind, dims, random), deep=True)
    ghosts.SetName("vtkGhostType")
    (data.GetCellData() if of_cells else data.GetPointData()).AddArray(ghosts)


def make_property(components, random):
    prop = vtkVolumeProperty()
    for c in range(components):
        opacity = vtkPiecewiseFunction()
        low = random.uniform(10.0, 40.0)
        opacity.AddPoint(low, 0.0)
        opacity.AddPoint(low + random.uniform(10.0, 40.0), random.choice([0.1, 0.5, 0.95]))
        color = vtkColorTransferFunction()
        for value in (0.0, 30.0, 60.0, 100.0):
            color.AddRGBPoint(value, *random.random(3))
        prop.SetScalarOpacity(c, opacity)
        prop.SetColor(c, color)
        prop.SetScalarOpacityUnitDistance(c, random.uniform(0.5, 2.0))
        prop.SetSpecular(c, random.choice([0.0, 0.5]))
    return prop


def make_lattice(random):
    net = vtkffd.vtkFFDLatticeSource()
    net.SetBounds(*(3 * [0.0, SIDE]))
    net.SetDimensions(5, 5, 5)
    net.SetShapeToTwist()
    net.SetStrength(random.uniform(0.2, 0.7))
    return net.GetLattice()


class Scene(ffdrandom.RandomScene):
    """One random scene; `number` decides everything."""

    def __init__(self, number):
        super().__init__(number)
        r = self.random
        self.words = [str(number)]
        self.uneven = self.chance(0.7)
        self.of_cells = self.chance(0.35, "cells")
        components = int(self.choose([1, 2, 3, 4], [0.64, 0.12, 0.12, 0.12]))
        kind = self.choose(TYPES if components < 3 else TYPES[:1])
        kinds = ["power", "random", "clustered", "even"]
        positions = [make_positions(
            self.choose(kinds) if self.uneven else "even", int(r.integers(5, 34)), r)
            for _ in range(3)]
        at = [0.5 * (p[1:] + p[:-1]) if self.of_cells else p for p in positions]
        z, y, x = numpy.meshgrid(*at[::-1], indexing="ij")
        fields = [make_field(x, y, z, r).ravel() for _ in range(components)]
        self.data = make_data(
            positions, [f.astype(kind) for f in fields], self.of_cells, not self.uneven)
        self.blanked = not self.uneven or self.chance(0.5)
        if self.blanked:
            of_cells = self.chance(0.5, "hidden cells")
            add_ghosts(self.data, self.choose(["half", "ball", "noise"]), of_cells, r)
        self.prop = make_property(components, r)
        self.prop.SetInterpolationType(0 if self.chance(0.15, "nearest") else 1)
        self.prop.SetIndependentComponents(components == 1 or self.chance(0.5, "independent"))
        self.prop.SetShade(1 if self.chance(0.6, "shade") else 0)
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.data)
        self.mapper.SetScalarModeToDefault()
        mode = self.choose(list(MODES), [0.58, 0.07, 0.07, 0.07, 0.07, 0.07, 0.07])
        self.mode = mode
        self.mapper.SetBlendMode(MODES[mode])
        self.mapper.SetNumberOfThreads(1)
        self.mapper.SetAutoAdjustSampleDistances(0)
        self.mapper.SetSampleDistance(r.choice([0.4, 0.7, 1.0]))
        if mode == "average":
            self.mapper.SetAverageIPScalarRange(5.0, 90.0)
        self.prop.GetIsoSurfaceValues().SetValue(0, r.uniform(30.0, 60.0))
        plane = vtkPlane()
        plane.SetOrigin(3 * [0.5 * SIDE])
        plane.SetNormal(*r.normal(size=3))
        self.prop.SetSliceFunction(plane)
        if self.chance(0.2, "gradient opacity"):
            gradients = vtkPiecewiseFunction()
            gradients.AddPoint(0.0, r.choice([0.0, 0.2]))
            gradients.AddPoint(r.uniform(2.0, 15.0), 1.0)
            self.prop.SetGradientOpacity(0, gradients)
        if components == 1 and self.chance(0.15, "normals of opacity"):
            self.mapper.ComputeNormalFromOpacityOn()
        if self.chance(0.2, "pre-integrated"):
            self.mapper.SetClassificationToPreIntegrated()
        if self.chance(0.15, "binary mask"):
            self.set_mask(vtkffd.vtkFFDInverseRayVolumeMapper.BinaryMaskType)
        elif components == 1 and self.chance(0.15, "label map"):
            self.set_mask(vtkffd.vtkFFDInverseRayVolumeMapper.LabelMapMaskType)
        if self.chance(0.2, "cropping"):
            self.mapper.CroppingOn()
            self.mapper.SetCroppingRegionPlanes(*(SIDE * numpy.sort(r.random((3, 2))).ravel()))
            self.mapper.SetCroppingRegionFlags(int(r.integers(1, 1 << 27)))
        if self.chance(0.2, "clipping"):
            clip = vtkPlane()
            clip.SetOrigin(3 * [0.5 * SIDE])
            clip.SetNormal(*r.normal(size=3))
            self.mapper.AddClippingPlane(clip)
        if self.chance(0.2, "jitter"):
            self.mapper.UseJitteringOn()
        if self.chance(0.7, "deformed"):
            self.mapper.SetDeformation(make_lattice(r))
        if self.chance(0.3, "whole tables"):
            self.mapper.SetSpaceLeapingToOff()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.prop)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetParallelProjection(1 if self.chance(0.3, "parallel") else 0)
        camera.Azimuth(r.uniform(-180.0, 180.0))
        camera.Elevation(r.uniform(-60.0, 60.0))
        self.renderer.ResetCamera(*(3 * [0.0, SIDE]))

    def set_mask(self, kind):
        dims = [d - (1 if self.of_cells else 0) for d in self.data.GetDimensions()]
        mask = vtkImageData()
        mask.SetDimensions(*dims)
        mask.GetPointData().SetScalars(
            numpy_to_vtk(1 - make_ghosts("ball", dims, self.random), deep=True))
        self.mapper.SetMaskInput(mask)
        self.mapper.SetMaskType(kind)
        if kind == self.mapper.LabelMapMaskType:
            self.mapper.SetMaskBlendFactor(self.random.choice([0.5, 1.0]))
            color = vtkColorTransferFunction()
            color.AddRGBPoint(0.0, 0.1, 0.9, 0.2)
            self.prop.SetLabelColor(1, color)
            self.prop.SetLabelScalarOpacity(1, self.prop.GetScalarOpacity())

    def render(self):
        colors = vtkImageData()
        depths = vtkImageData()
        if self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, colors, depths) != 1:
            raise RuntimeError("not rendered")
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(SIZE, SIZE, 4).astype(float)
        rgba[..., :3] *= rgba[..., 3:] / 255.0
        return rgba, vtk_to_numpy(depths.GetPointData().GetScalars()).reshape(SIZE, SIZE)

    def compare(self):
        """How much the picture differs from that of the reference kernels: the mean, the part of
        pixels that differ much, and that of those whose depths do."""
        fast, near = self.render()
        self.mapper.ReferenceKernelsOn()
        reference, far = self.render()
        self.mapper.ReferenceKernelsOff()
        difference = numpy.abs(fast - reference).max(axis=-1)
        return (difference.mean(), (difference > 16.0).mean(),
                (numpy.abs(near - far) > 2e-3).mean(), (reference[..., 3] > 10.0).mean())


class TestGrids(unittest.TestCase):
    scenes = range(24)

    def test_random_scenes(self):
        seen = 0
        failed = []
        for number in self.scenes:
            scene = Scene(number)
            mean, much, moved, covered = scene.compare()
            words = " ".join(scene.words)
            seen += covered > 0.01
            # Beside blanked cells, values of cells are constant: extremes are there, or there.
            anywhere = scene.mode in ("maximum", "minimum") and scene.of_cells and scene.blanked
            wrong = mean > 0.4 or much > 0.01 or (moved > 0.03 and not anywhere)
            print(f"{'WRONG ' if wrong else ''}{mean:.3f} {much:.4f} {moved:.4f} {covered:.2f} {words}",
                  flush=True)
            if wrong:
                failed.append(words)
        self.assertEqual(failed, [])
        self.assertGreater(seen, len(self.scenes) // 2)

    def test_equal_steps_are_those_of_an_image(self):
        """Whatever they are rounded to; and what is no rounding counts."""
        random = numpy.random.default_rng(3)
        values = numpy_to_vtk(random.integers(0, 256, 20 * 24 * 28).astype(numpy.uint8), deep=True)
        image = vtkImageData()
        image.SetDimensions(20, 24, 28)
        image.SetOrigin(0.5, -3.0, 7.0)
        image.SetSpacing(0.7, 0.3, 0.5)
        pictures = {}
        for kind in ("image", "even", "uneven"):
            data = image
            if kind != "image":
                data = vtkRectilinearGrid()
                data.SetDimensions(20, 24, 28)
                for a, name in enumerate("XYZ"):
                    n = image.GetDimensions()[a]
                    steps = numpy.arange(n) * image.GetSpacing()[a]
                    if kind == "uneven":
                        steps[n // 2] += 0.3 * image.GetSpacing()[a]
                    steps = (image.GetOrigin()[a] + steps).astype(numpy.float32)
                    getattr(data, f"Set{name}Coordinates")(numpy_to_vtk(steps, deep=True))
            data.GetPointData().SetScalars(values)
            mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
            mapper.SetInputData(data)
            volume = vtkVolume()
            volume.SetMapper(mapper)
            opacity = vtkPiecewiseFunction()
            opacity.AddPoint(0.0, 0.0)
            opacity.AddPoint(255.0, 0.3)
            volume.GetProperty().SetScalarOpacity(opacity)
            volume.GetProperty().ShadeOn()
            volume.GetProperty().SetInterpolationTypeToLinear()
            renderer = vtkRenderer()
            renderer.AddVolume(volume)
            renderer.ResetCamera(image.GetBounds())
            colors = vtkImageData()
            self.assertEqual(mapper.RenderToImage(renderer, volume, SIZE, SIZE, colors, None), 1)
            pictures[kind] = vtk_to_numpy(colors.GetPointData().GetScalars()).astype(int)
        self.assertLess(numpy.abs(pictures["even"] - pictures["image"]).max(), 3)
        self.assertGreater(numpy.abs(pictures["uneven"] - pictures["image"]).max(), 20)

    def test_hidden_cells_hold_anything(self):
        # Beside them values are those of the nearest cells; most of them are hidden for a reason.
        n = 16
        random = numpy.random.default_rng(3)
        positions = 3 * [make_positions("even", n + 1, random)]
        hidden = make_ghosts("noise", 3 * [n], random)
        noise = random.uniform(20.0, 100.0, (2, n ** 3)).astype("float32")
        scene = Scene(0)
        scene.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        scene.mapper.SetAutoAdjustSampleDistances(0)
        scene.mapper.SetDeformation(make_lattice(random))
        scene.prop = make_property(2, random)
        scene.prop.SetInterpolationTypeToLinear()
        scene.volume.SetMapper(scene.mapper)
        scene.volume.SetProperty(scene.prop)
        for components, shade, reference in itertools.product((1, 2), (0, 1), (0, 1)):
            with self.subTest(components=components, shade=shade, reference=reference):
                scene.prop.SetShade(shade)
                scene.mapper.SetReferenceKernels(reference)
                pictures = []
                for value in (50.0, numpy.nan):
                    values = noise[:components].copy()
                    values[:, hidden != 0] = value
                    data = make_data(positions, list(values), True, True)
                    ghosts = numpy_to_vtk(hidden, deep=True)
                    ghosts.SetName("vtkGhostType")
                    data.GetCellData().AddArray(ghosts)
                    scene.mapper.SetInputData(data)
                    pictures.append(scene.render()[0])
                self.assertGreater((pictures[0][..., 3] > 10.0).mean(), 0.1)
                self.assertLessEqual(numpy.abs(pictures[1] - pictures[0]).max(), 2.0)

    def test_masks_of_cells(self):
        # As a mask whose points are where the centers of the cells are.
        n = 16
        random = numpy.random.default_rng(4)
        positions = 3 * [make_positions("even", n + 1, random)]
        step = SIDE / n
        shown = {count: 1 - make_ghosts("ball", 3 * [count], random) for count in (n, n + 1)}

        def make_mask(cells, *attributes):
            mask = vtkImageData()
            mask.SetDimensions(*(3 * [n + (1 if cells else 0)]))
            mask.SetSpacing(*(3 * [step]))
            mask.SetOrigin(*(3 * [0.0 if cells else 0.5 * step]))
            for name in attributes:
                count = n + (1 if cells and name == "GetPointData" else 0)
                getattr(mask, name)().SetScalars(numpy_to_vtk(shown[count], deep=True))
            return mask

        points = make_mask(False, "GetPointData")
        whole = vtkImageData()
        whole.SetDimensions(*(3 * [n + 1]))
        whole.SetSpacing(*(3 * [step]))
        whole.GetPointData().SetScalars(numpy_to_vtk(shown[n + 1], deep=True))
        cells = make_mask(True, "GetCellData")
        both = make_mask(True, "GetCellData", "GetPointData")
        scene = Scene(0)
        scene.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        scene.mapper.SetDeformation(make_lattice(random))
        scene.prop = make_property(1, random)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 0.1, 0.9, 0.2)
        scene.prop.SetLabelColor(1, color)
        scene.volume.SetMapper(scene.mapper)
        scene.volume.SetProperty(scene.prop)
        for of_cells, kind, reference in itertools.product((False, True), (0, 1), (0, 1)):
            with self.subTest(of_cells=of_cells, kind=kind, reference=reference):
                values = random.uniform(20.0, 100.0, (n if of_cells else n + 1) ** 3)
                scene.mapper.SetInputData(
                    make_data(positions, [values.astype("float32")], of_cells, True))
                scene.mapper.SetMaskType(kind)
                scene.mapper.SetReferenceKernels(reference)
                pictures = []
                for mask in (points, cells, points if of_cells else whole, both, None):
                    scene.mapper.SetMaskInput(mask)
                    pictures.append(scene.render()[0])
                for first, second in ((0, 1), (2, 3)):
                    self.assertLessEqual(numpy.abs(pictures[first] - pictures[second]).max(), 1.0)
                    self.assertGreater(numpy.abs(pictures[first] - pictures[4]).mean(), 0.2)

    def count_lookups(self, change, mode):
        """Of distances to what is visible, for each ray of a picture of an image, a grid, or a blanked image."""
        n = 64
        random = numpy.random.default_rng(7)
        even = 3 * [make_positions("even", n, random)]
        steps = numpy.arange(n) + 0.08 * (n - 1) * numpy.sin(2.0 * numpy.pi * even[0] / SIDE)
        positions = 3 * [SIDE * steps / (n - 1)] if change == "grid" else even
        z, y, x = numpy.meshgrid(*positions[::-1], indexing="ij")
        scene = Scene(0)
        data = make_data(
            positions, [make_field(x, y, z, numpy.random.default_rng(8)).ravel().astype("uint8")],
            False, change != "grid")
        if change == "blanking":
            add_ghosts(data, "ball", True, random)
        scene.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        scene.mapper.SetInputData(data)
        scene.mapper.SetBlendMode(MODES[mode])
        scene.mapper.CollectStatisticsOn()
        scene.mapper.SetAutoAdjustSampleDistances(0)
        scene.mapper.SetSampleDistance(0.25)
        scene.mapper.SetDeformation(make_lattice(random))
        scene.prop = make_property(1, random)
        scene.prop.ShadeOn()
        scene.prop.GetIsoSurfaceValues().SetValue(0, 50.0)
        scene.volume.SetMapper(scene.mapper)
        scene.volume.SetProperty(scene.prop)
        scene.render()
        return scene.mapper.GetStatistics().GetDistanceLookupsPerRay()

    def test_grids_are_sampled_by_vectors(self):
        for mode in ("composite", "maximum", "isosurface"):
            plain = self.count_lookups("image", mode)
            counts = [self.count_lookups(change, mode) for change in ("grid", "blanking")]
            # Each of the rays that are sampled one at a time looks for itself.
            self.assertLess(max(counts), 2.0 * plain, mode)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes")
    options, rest = parser.parse_known_args()
    if options.scenes:
        TestGrids.scenes = range(*map(int, options.scenes.split(":")))
    unittest.main(argv=[sys.argv[0]] + rest)
