# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random scenes, each rendered in every way that must give the same picture.

Every scene draws its volume (type, components, spacing, direction, matrix), its deformation, its
transfer functions, lights, camera and options at random, by its number. Compared are the fast kernels
with the reference kernels, any number of threads, space leaping on and off, the window with the image
over black, and the same numbers as bytes, 16 bit and float.

    python3 TestRandomScenes.py [--scenes FIRST:END]      the test alone runs the first few
"""

import argparse
import sys
import unittest

import numpy
import vtkffd
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the window's implementation)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkLight, vtkRenderer, vtkRenderWindow, vtkVolume, vtkVolumeProperty,
    vtkWindowToImageFilter)

import ffdrandom

SIZE = 96
TYPES = ["uint8", "uint16", "int8", "int16", "int32", "float32", "float64"]
COMPOSITE, MAXIMUM, MINIMUM, AVERAGE, ADDITIVE, ISOSURFACE, SLICE = range(7)


class Scene(ffdrandom.RandomScene):
    """One random scene; `number` decides everything."""

    def __init__(self, number):
        super().__init__(number)
        self.make_volume()
        self.make_property()
        self.make_mapper()
        self.make_view()

    def make_volume(self):
        """Smooth blobs on a noise of low frequency, some hollow."""
        r = self.random
        self.components = int(self.choose([1, 2, 3, 4], [0.7, 0.1, 0.1, 0.1]))
        # Dependent colors are refused in other types.
        self.type = self.choose(TYPES if self.components < 3 else TYPES[:2])
        dims = r.integers(2, 34, 3)
        self.words.append("x".join(str(n) for n in dims))
        self.dims = dims
        z, y, x = numpy.meshgrid(*[numpy.linspace(-1.0, 1.0, n) for n in dims[::-1]], indexing="ij")
        values = []
        for _ in range(self.components):
            value = numpy.zeros_like(x)
            for _ in range(int(r.integers(1, 5))):
                center = r.uniform(-0.6, 0.6, 3)
                width = r.uniform(0.2, 0.8)
                distance = (x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2
                value = numpy.maximum(value, numpy.exp(-distance / width ** 2))
            if r.random() < 0.4:
                value = value * (0.8 + 0.2 * numpy.sin(r.uniform(2.0, 7.0) * (x + y * z)))
            values.append(value)
        # Whole numbers from 0 to 100 whatever the type: so all types can hold the same ones.
        self.values = numpy.floor(100.0 * numpy.stack(values, axis=-1) + 0.5)
        self.image = vtkImageData()
        self.image.SetDimensions(*[int(n) for n in dims])
        self.image.SetSpacing(*r.uniform(0.3, 3.0, 3))
        self.image.SetOrigin(*r.uniform(-40.0, 40.0, 3))
        if self.chance(0.3, "direction"):
            q, _ = numpy.linalg.qr(r.normal(size=(3, 3)))
            self.image.SetDirectionMatrix(*q.ravel())
        self.set_scalars(self.type)

    def set_scalars(self, kind):
        """The values as another type, unscaled: 0 to 100."""
        flat = self.values.reshape(-1, self.components).astype(kind)
        array = numpy_to_vtk(flat if self.components > 1 else flat[:, 0], deep=True)
        array.SetName("scalars")
        self.image.GetPointData().SetScalars(array)
        self.image.Modified()

    def make_property(self):
        r = self.random
        self.property = vtkVolumeProperty()
        self.property.SetInterpolationType(0 if self.chance(0.15, "nearest") else 1)
        independent = self.components == 1 or self.chance(0.5, "independent")
        self.property.SetIndependentComponents(independent)
        self.property.SetShade(1 if self.chance(0.5, "shade") else 0)
        for component in range(self.components):
            opacity = vtkPiecewiseFunction()
            low = r.uniform(5.0, 60.0)
            opacity.AddPoint(0.0, 0.0 if r.random() < 0.8 else 0.01)
            opacity.AddPoint(low, 0.0)
            opacity.AddPoint(low + r.uniform(10.0, 40.0), r.choice([0.05, 0.3, 0.9]))
            self.property.SetScalarOpacity(component, opacity)
            color = vtkColorTransferFunction()
            for value in (0.0, 30.0, 60.0, 100.0):
                color.AddRGBPoint(value, *r.random(3))
            self.property.SetColor(component, color)
            if r.random() < 0.25:
                self.words.append("gradient opacity")
                gradient = vtkPiecewiseFunction()
                gradient.AddPoint(0.0, r.choice([0.0, 0.2]))
                gradient.AddPoint(r.uniform(3.0, 20.0), 1.0)
                self.property.SetGradientOpacity(component, gradient)
            self.property.SetSpecular(component, r.choice([0.0, 0.6]))
            self.property.SetSpecularPower(component, r.choice([1.0, 10.0, 40.0]))
            self.property.SetAmbient(component, r.uniform(0.0, 0.5))
            self.property.SetScalarOpacityUnitDistance(component, r.uniform(0.3, 3.0))
        self.property.GetIsoSurfaceValues().SetValue(0, r.uniform(20.0, 60.0))

    def make_mapper(self):
        r = self.random
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.SetAutoAdjustSampleDistances(0)
        mode = self.choose(
            [COMPOSITE, MAXIMUM, MINIMUM, AVERAGE, ADDITIVE, ISOSURFACE, SLICE],
            [0.58, 0.07, 0.07, 0.07, 0.07, 0.07, 0.07])
        self.mode = mode
        self.mapper.SetBlendMode(
            {COMPOSITE: 0, MAXIMUM: 1, MINIMUM: 2, AVERAGE: 3, ADDITIVE: 4, ISOSURFACE: 5, SLICE: 6}[mode])
        self.bounds = numpy.array(self.image.GetBounds())
        lower, upper = self.bounds[::2], self.bounds[1::2]
        plane = vtkPlane()
        plane.SetOrigin(*(0.5 * (lower + upper)))
        plane.SetNormal(*r.normal(size=3))
        self.property.SetSliceFunction(plane)
        self.deformed = self.chance(0.75, "deformed")
        if self.deformed:
            lattice = vtkffd.vtkFFDLattice()
            lattice.SetDimensions(*[int(n) for n in r.integers(4, 9, 3)])
            lattice.FitToBounds(self.bounds)
            shape = int(self.choose([1, 2, 3, 4, 5, 6]))
            strength = r.uniform(0.1, 0.9)
            vtkffd.vtkFFDLatticeSource.ApplyShape(lattice, shape, strength, self.number + 1)
            self.mapper.SetDeformation(lattice)
            self.mapper.SetInverseMode(int(self.choose([0, 1, 1, 2])))
        if self.chance(0.2, "distance"):
            self.mapper.SetSampleDistance(r.uniform(0.1, 20.0))
        if self.chance(0.15, "cropping"):
            planes = numpy.sort(r.uniform(0.1, 0.9, (3, 2)), axis=1)
            planes = lower[:, None] + planes * (upper - lower)[:, None]
            self.mapper.SetCropping(1)
            self.mapper.SetCroppingRegionPlanes(*planes.ravel())
            self.mapper.SetCroppingRegionFlags(int(r.choice([0x2000, 0x2ebfeba, 0x5140145])))
            self.mapper.SetCroppingSpace(int(r.integers(0, 2)))
        if self.chance(0.15, "clipping"):
            clip = vtkPlane()
            clip.SetOrigin(*r.uniform(lower, upper))
            clip.SetNormal(*r.normal(size=3))
            self.mapper.AddClippingPlane(clip)
        if self.chance(0.1, "jitter"):
            self.mapper.UseJitteringOn()
        if self.chance(0.1, "material"):
            self.mapper.SetOpacityLength(1)
        if self.chance(0.1, "window/level"):
            self.mapper.SetFinalColorWindow(0.7)
            self.mapper.SetFinalColorLevel(0.4)

    def make_view(self):
        r = self.random
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        if self.chance(0.3, "matrix"):
            self.volume.RotateWXYZ(r.uniform(0.0, 360.0), *r.normal(size=3))
            self.volume.SetScale(*r.choice([0.5, 1.0, 3.0], 3))
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        for _ in range(int(r.choice([0, 1, 3], p=[0.6, 0.2, 0.2]))):
            self.words.append("light")
            light = vtkLight()
            light.SetPosition(*r.normal(size=3))
            light.SetFocalPoint(0.0, 0.0, 0.0)
            light.SetColor(*r.random(3))
            light.SetIntensity(r.uniform(0.3, 1.5))
            self.renderer.AddLight(light)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(*r.normal(size=3))
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetViewUp(*r.normal(size=3))
        if self.chance(0.3, "parallel"):
            camera.ParallelProjectionOn()
        self.renderer.ResetCamera()
        camera.Zoom(r.uniform(0.7, 2.0))
        if self.chance(0.1, "inside"):
            camera.SetPosition(*self.volume.GetCenter())
            camera.SetFocalPoint(*(numpy.array(self.volume.GetCenter()) + r.normal(size=3)))
        self.renderer.ResetCameraClippingRange()

    def image_of(self):
        """Premultiplied colors of RenderToImage, or None after an error."""
        colors = vtkImageData()
        self.mapper.PremultipliedAlphaOn()
        if not self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, colors):
            return None
        return vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(SIZE, SIZE, 4).astype(int)

    def distances_when_moved(self, plain):
        """How far the picture is from that of the volume moved at rest by PositionTolerance, either
        way along each of its axes: the largest of each of distance(). Positions between exact ones
        may be wrong by that much."""
        origin = numpy.array(self.image.GetOrigin())
        direction = self.image.GetDirectionMatrix()
        found = []
        for axis in range(3):
            step = numpy.array([direction.GetElement(row, axis) for row in range(3)])
            step *= self.image.GetSpacing()[axis] * self.mapper.GetPositionTolerance()
            for moved in (origin - step, origin + step):
                self.image.SetOrigin(*moved)
                found.append(distance(self.image_of(), plain))
        self.image.SetOrigin(*origin)
        return numpy.max(found, axis=0)

    def window_of(self):
        """What a window shows, over black."""
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(SIZE, SIZE)
        window.AddRenderer(self.renderer)
        window.Render()
        capture = vtkWindowToImageFilter()
        capture.SetInput(window)
        capture.ReadFrontBufferOff()
        capture.ShouldRerenderOff()
        capture.Update()
        pixels = vtk_to_numpy(capture.GetOutput().GetPointData().GetScalars())
        window.RemoveRenderer(self.renderer)
        window.Finalize()
        return pixels.reshape(SIZE, SIZE, -1)[..., :3].astype(int)


def distance(a, b):
    """Mean, 99.5th percentile and largest difference."""
    difference = numpy.abs(a - b).max(axis=2)
    return float(numpy.abs(a - b).mean()), float(numpy.percentile(difference, 99.5)), int(difference.max())


def check(number):
    """What is wrong with a scene: a list of texts."""
    scene = Scene(number)
    wrong = []

    def expect(what, a, b, mean, tail, most):
        found = distance(a, b)
        if found[0] > mean or found[1] > tail or found[2] > most:
            wrong.append("%s: mean %.2f, 99.5 %% %.0f, most %d" % ((what,) + found))

    plain = scene.image_of()
    if plain is None:
        return ["not rendered"], scene
    scene.mapper.SetNumberOfThreads(1)
    expect("threads", scene.image_of(), plain, 0.0, 0, 0)
    scene.mapper.SetNumberOfThreads(0)
    scene.mapper.SetSpaceLeapingToOff()
    expect("leaping", scene.image_of(), plain, 1.0, 1, 1)
    scene.mapper.SetSpaceLeapingToLipschitz()
    scene.mapper.ReferenceKernelsOn()
    reference = scene.image_of()
    bounds = (0.5, 16, 255)
    if scene.property.GetInterpolationType() == 0:
        # A small error of the position may turn a voxel into the next one.
        bounds = numpy.maximum(bounds, scene.distances_when_moved(reference))
    expect("reference", reference, plain, *bounds)
    scene.mapper.ReferenceKernelsOff()
    expect("window", scene.window_of(), plain[..., :3], 1.0, 1, 1)
    if scene.components < 3:
        scene.set_scalars("uint8")
        plain = scene.image_of()
        for kind in ("uint16", "float32"):
            scene.set_scalars(kind)
            expect(kind + " and bytes", scene.image_of(), plain, 0.1, 2, 2)
    return wrong, scene


class TestRandomScenes(unittest.TestCase):
    """The first scenes of the series."""

    def test_every_way_gives_the_same_picture(self):
        for number in (*range(*SCENES), *SINGLE):
            with self.subTest(scene=number):
                wrong, scene = check(number)
                self.assertFalse(wrong, "scene %d (%s): %s" % (number, ", ".join(scene.words), wrong))


SCENES = (0, 40)
#: Further ones that have failed: surfaces whose normals had lengths of what memory held before; surfaces
#: at the faces between nearest voxels; a camera inside, where normals were those of interpolants over few
#: voxels; surfaces in 16 bits; a bend that folds, where the reference kernels followed another branch.
SINGLE = (89, 481, 545, 323, 637, 638)

if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", help="first and one past the last scene, e.g. 0:400")
    options, rest = parser.parse_known_args()
    if options.scenes:
        SINGLE = ()
        SCENES = tuple(int(part) for part in options.scenes.split(":"))
    unittest.main(argv=sys.argv[:1] + rest)
