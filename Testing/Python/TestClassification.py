# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pre-integrated classification: much nearer to small sample distances than samples are, the same with
all kernels, leaps and scalar types, and samples are classified where it is not for them."""

import os
import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

Mapper = vtkffd.vtkFFDInverseRayVolumeMapper
SIZE = 96


class Scene:
    """A volume of the test data with a step from transparent to `top` at a scalar."""

    def __init__(self, name, step, top=1.0, shade=True, width=2.0):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(os.path.join(os.environ["FFD_TEST_DATA"], name + ".vti"))
        reader.Update()
        self.image = reader.GetOutput()
        self.mapper = Mapper()
        self.mapper.SetInputData(self.image)
        self.mapper.PremultipliedAlphaOn()
        self.property = vtkVolumeProperty()
        self.property.SetInterpolationTypeToLinear()
        self.property.SetShade(shade)
        self.opacity = vtkPiecewiseFunction()
        self.set_step(step, top, width)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, 0.9, 0.5, 0.3)
        color.AddRGBPoint(255.0, 0.5, 0.9, 1.0)
        self.property.SetColor(color)
        self.property.SetScalarOpacity(self.opacity)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(0.4, -1.0, 0.6)
        camera.SetViewUp(0.0, 0.0, 1.0)
        self.renderer.ResetCamera()
        camera.Zoom(1.4)

    def set_step(self, step, top, width=2.0):
        self.opacity.RemoveAllPoints()
        self.opacity.AddPoint(step - 0.5 * width, 0.0)
        self.opacity.AddPoint(step + 0.5 * width, top)

    def deform(self):
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(6, 6, 6)
        lattice.FitToBounds(self.image.GetBounds())
        vtkffd.vtkFFDLatticeSource.ApplyShape(lattice, 3, 0.4, 7)
        self.mapper.SetDeformation(lattice)
        self.renderer.ResetCamera()

    def render(self, classification, distance=None, depths=None):
        self.mapper.SetClassification(classification)
        self.mapper.SetLockSampleDistanceToInputSpacing(distance is None)
        if distance is not None:
            self.mapper.SetSampleDistance(distance * min(self.image.GetSpacing()))
        colors = vtkImageData()
        if self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, colors, depths) != 1:
            raise AssertionError("no picture")
        # Over black.
        return vtk_to_numpy(colors.GetPointData().GetScalars()).astype(float)[:, :3]


def distance_of(a, b):
    return numpy.abs(a - b).mean()


class TestClassification(unittest.TestCase):
    def test_options(self):
        mapper = Mapper()
        self.assertEqual(mapper.GetClassification(), Mapper.POST_INTERPOLATED)
        self.assertEqual(mapper.GetUsedClassification(), Mapper.POST_INTERPOLATED)
        names = ["POST_INTERPOLATED", "PRE_INTEGRATED", "AUTO"]
        for value, name in enumerate(names):
            mapper.SetClassification(value)
            self.assertEqual(mapper.GetClassificationAsString(), name)
            self.assertIn("Classification: " + name, str(mapper))
        mapper.SetClassificationToPreIntegrated()
        self.assertEqual(mapper.GetClassification(), Mapper.PRE_INTEGRATED)
        mapper.SetClassificationToAuto()
        self.assertEqual(mapper.GetClassification(), Mapper.AUTO)
        mapper.SetClassificationToPostInterpolated()
        self.assertEqual(mapper.GetClassification(), Mapper.POST_INTERPOLATED)
        mapper.SetClassification(7)
        self.assertEqual(mapper.GetClassification(), Mapper.AUTO)

    def test_nearer_to_the_truth(self):
        for name, step in (("engine", 80.0), ("fuel", 30.0)):
            for deformed in (False, True):
                for shade in (False, True):
                    scene = Scene(name, step, shade=shade)
                    if deformed:
                        scene.deform()
                    truth = scene.render(Mapper.POST_INTERPOLATED, 0.05)
                    post = distance_of(truth, scene.render(Mapper.POST_INTERPOLATED))
                    pre = distance_of(truth, scene.render(Mapper.PRE_INTEGRATED))
                    self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.PRE_INTEGRATED)
                    quarter = distance_of(truth, scene.render(Mapper.POST_INTERPOLATED, 0.25))
                    what = f"{name}, deformed {deformed}, shade {shade}: {post} {quarter} {pre}"
                    self.assertLess(pre, 0.4 * post, what)
                    if name == "engine":
                        self.assertLess(pre, 0.5 * quarter, what)

    def test_faces_of_bent_volumes(self):
        """Intervals begin at the faces of what is visible there, not at the sample before."""
        scene = Scene("fuel", 30.0)
        axis = numpy.arange(24)
        waves = [numpy.sin(0.7 * axis + phase) for phase in (0.0, 1.0, 2.0)]
        values = 127.0 + 40.0 * (waves[0][:, None, None] + waves[1][:, None] + waves[2])
        scene.image = vtkImageData()
        scene.image.SetDimensions(24, 24, 24)
        scene.image.GetPointData().SetScalars(
            numpy_to_vtk(values.ravel().astype(numpy.float32), deep=True))
        scene.mapper.SetInputData(scene.image)
        scene.opacity.RemoveAllPoints()
        scene.opacity.AddPoint(0.0, 0.5)
        scene.opacity.AddPoint(255.0, 0.5)
        color = scene.property.GetRGBTransferFunction()
        color.RemoveAllPoints()
        color.AddRGBPoint(20.0, 1.0, 0.0, 0.0)
        color.AddRGBPoint(130.0, 0.0, 1.0, 0.0)
        color.AddRGBPoint(240.0, 0.0, 0.0, 1.0)
        scene.property.ShadeOff()
        scene.deform()
        for reference in (False, True):
            with self.subTest(reference=reference):
                scene.mapper.SetReferenceKernels(reference)
                truth = scene.render(Mapper.PRE_INTEGRATED, 0.05)
                post = distance_of(truth, scene.render(Mapper.POST_INTERPOLATED))
                pre = distance_of(truth, scene.render(Mapper.PRE_INTEGRATED))
                self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.PRE_INTEGRATED)
                self.assertLess(pre, 0.5 * post, f"{pre} {post}")

    def test_same_with_all_kernels(self):
        for name, step, top in (("fuel", 30.0, 0.3), ("engine", 80.0, 1.0)):
            for deformed in (False, True):
                for length in (Mapper.WORLD, Mapper.MATERIAL):
                    scene = Scene(name, step, top)
                    scene.mapper.SetOpacityLength(length)
                    if deformed:
                        scene.deform()
                    fast = scene.render(Mapper.PRE_INTEGRATED)
                    what = f"{name}, deformed {deformed}, length {length}"
                    scene.mapper.SetSpaceLeapingToOff()
                    off = scene.render(Mapper.PRE_INTEGRATED)
                    self.assertLess(numpy.abs(fast - off).max(), 2.0, what)
                    scene.mapper.SetSpaceLeapingToLipschitz()
                    scene.mapper.ReferenceKernelsOn()
                    reference = scene.render(Mapper.PRE_INTEGRATED)
                    self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.PRE_INTEGRATED)
                    self.assertLess(distance_of(fast, reference), 0.5 if deformed else 0.1, what)

    def test_same_with_all_types(self):
        scene = Scene("fuel", 30.0, 0.5)
        scene.deform()
        expected = scene.render(Mapper.PRE_INTEGRATED)
        values = vtk_to_numpy(scene.image.GetPointData().GetScalars())
        for kind in ("uint16", "int16", "float32", "float64", "int32"):
            scene.image.GetPointData().SetScalars(numpy_to_vtk(values.astype(kind), deep=True))
            scene.image.Modified()
            picture = scene.render(Mapper.PRE_INTEGRATED)
            self.assertLess(numpy.abs(picture - expected).max(), 3.0, kind)
            self.assertLess(distance_of(picture, expected), 0.05, kind)

    def test_shells_between_samples(self):
        # Values from 0 to 10 over a voxel, seen where they are 5: samples at whole voxels miss it.
        values = numpy.zeros((8, 8, 8), dtype=numpy.uint8)
        values[4:] = 10
        image = vtkImageData()
        image.SetDimensions(8, 8, 8)
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        scene = Scene("fuel", 5.0)
        scene.image = image
        scene.mapper.SetInputData(image)
        scene.opacity.RemoveAllPoints()
        for value, opacity in ((4.0, 0.0), (4.5, 0.5), (5.5, 0.5), (6.0, 0.0)):
            scene.opacity.AddPoint(value, opacity)
        scene.property.ShadeOff()
        camera = scene.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(3.5, 3.5, 3.5)
        camera.SetPosition(3.5, 3.5, 30.0)
        camera.SetViewUp(0.0, 1.0, 0.0)
        camera.SetParallelScale(2.0)
        camera.SetClippingRange(10.0, 50.0)
        truth = scene.render(Mapper.POST_INTERPOLATED, 0.01)
        self.assertGreater(truth.max(axis=1).min(), 10.0)
        depths = vtkImageData()
        picture = scene.render(Mapper.PRE_INTEGRATED, depths=depths)
        self.assertLess(numpy.abs(picture - truth).max(), 2.0)
        z = 30.0 - (10.0 + 40.0 * vtk_to_numpy(depths.GetPointData().GetScalars()))
        self.assertLess(numpy.abs(z - 3.5).max(), 0.1)

    def test_samples_where_it_is_not_for(self):
        def gradient(scene):
            function = vtkPiecewiseFunction()
            function.AddPoint(0.0, 0.0)
            function.AddPoint(20.0, 1.0)
            scene.property.SetGradientOpacity(function)

        def plane(scene):
            texels = vtkImageData()
            texels.SetDimensions(4, 2, 1)
            rgba = numpy.tile(numpy.array([0.5, 0.5, 0.5, 0.1], dtype=numpy.float32), (8, 1))
            texels.GetPointData().SetScalars(numpy_to_vtk(rgba, deep=True))
            scene.property.SetTransferFunctionMode(1)
            scene.property.SetTransferFunction2D(texels)

        def components(scene):
            values = vtk_to_numpy(scene.image.GetPointData().GetScalars())
            scene.image.GetPointData().SetScalars(
                numpy_to_vtk(numpy.stack([values, values], axis=-1), deep=True))

        def mask(scene, binary):
            volume = vtkImageData()
            volume.CopyStructure(scene.image)
            ones = numpy.ones(scene.image.GetNumberOfPoints(), dtype=numpy.uint8)
            volume.GetPointData().SetScalars(numpy_to_vtk(ones, deep=True))
            scene.mapper.SetMaskInput(volume)
            scene.mapper.SetMaskType(0 if binary else 1)

        def blank(scene):
            ghosts = numpy.zeros(scene.image.GetNumberOfPoints(), dtype=numpy.uint8)
            ghosts[5] = 2
            array = numpy_to_vtk(ghosts, deep=True)
            array.SetName("vtkGhostType")
            scene.image.GetPointData().AddArray(array)

        cases = {
            "nearest": lambda scene: scene.property.SetInterpolationTypeToNearest(),
            "maximum": lambda scene: scene.mapper.SetBlendModeToMaximumIntensity(),
            "isosurface": lambda scene: scene.mapper.SetBlendModeToIsoSurface(),
            "polyline": lambda scene: scene.mapper.SetSegmentationToGreedyAngle(),
            "clip box": lambda scene: scene.mapper.SetClipBox(-1e9, 1e9, -1e9, 1e9, -1e9, 1e9),
            "gradient opacity": gradient,
            "plane": plane,
            "components": components,
            "binary mask": lambda scene: mask(scene, True),
            "label map": lambda scene: mask(scene, False),
            "blanked": blank,
        }
        for name, change in cases.items():
            with self.subTest(name):
                scene = Scene("fuel", 30.0, 0.5)
                change(scene)
                post = scene.render(Mapper.POST_INTERPOLATED)
                pre = scene.render(Mapper.PRE_INTEGRATED)
                self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.POST_INTERPOLATED)
                self.assertEqual(numpy.abs(post - pre).max(), 0.0)

    def test_cropping_and_clipping(self):
        for space in (Mapper.REST, Mapper.DEFORMED):
            scene = Scene("fuel", 30.0, 1.0)
            scene.mapper.SetCropping(1)
            scene.mapper.SetCroppingSpace(space)
            scene.mapper.SetCroppingRegionPlanes(20.3, 90.0, 0.0, 31.4, -1.0, 90.0)
            scene.mapper.SetCroppingRegionFlags(0x2000)
            truth = scene.render(Mapper.POST_INTERPOLATED, 0.05)
            post = distance_of(truth, scene.render(Mapper.POST_INTERPOLATED))
            picture = scene.render(Mapper.PRE_INTEGRATED)
            self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.PRE_INTEGRATED)
            self.assertLess(distance_of(truth, picture), 0.75 * post)
            scene.mapper.ReferenceKernelsOn()
            self.assertLess(
                distance_of(picture, scene.render(Mapper.PRE_INTEGRATED)), 0.1)

    def test_automatic(self):
        scene = Scene("fuel", 30.0, 1.0)
        scene.render(Mapper.AUTO)
        self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.PRE_INTEGRATED)
        # Gentle for a thin interval.
        scene.set_step(60.0, 0.3, 100.0)
        auto = scene.render(Mapper.AUTO)
        self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.POST_INTERPOLATED)
        self.assertEqual(numpy.abs(auto - scene.render(Mapper.POST_INTERPOLATED)).max(), 0.0)
        # Steep, but over a small distance hardly visible.
        scene.set_step(30.0, 0.8)
        scene.render(Mapper.AUTO)
        self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.PRE_INTEGRATED)
        scene.render(Mapper.AUTO, 0.05)
        self.assertEqual(scene.mapper.GetUsedClassification(), Mapper.POST_INTERPOLATED)


if __name__ == "__main__":
    unittest.main()
