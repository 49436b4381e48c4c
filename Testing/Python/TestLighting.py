# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lighting of the mapper against its closed form: matrices, deformations, lights, cameras.

The scalars rise linearly and are opaque from a level on, so that a plane is seen whose normal and
position are known. VTK's mappers draw some of the same scenes, their error is printed: both light
volumes whose matrix does not scale all axes alike otherwise (the GPU mapper but for lights along an
axis), and so does vtkGPUVolumeRayCastMapper with several lights: it leaves the color out of the
ambient term and shows the highlight of the last light only.
"""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkLight, vtkLightKit, vtkRenderer, vtkRenderWindow, vtkVolume,
    vtkVolumeProperty, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

SIZE = 33
PIXELS = 48
COLOR = numpy.array([0.9, 0.6, 0.3])
MIDDLE = numpy.full(3, (SIZE - 1) / 2.0)


def normalized(vectors):
    return vectors / numpy.linalg.norm(vectors, axis=-1, keepdims=True)


def from_vtk(matrix):
    return numpy.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])


def to_vtk(matrix):
    result = vtkMatrix4x4()
    result.DeepCopy(numpy.asarray(matrix, dtype=float).ravel().tolist())
    return result


class LitPlane:
    """A plane in a volume, a renderer, and what the plane must look like."""

    def __init__(self, gradient):
        self.gradient = normalized(numpy.array(gradient, dtype=float))
        z, y, x = numpy.mgrid[0:SIZE, 0:SIZE, 0:SIZE]
        values = numpy.stack([x, y, z], axis=-1) - MIDDLE
        values = 100.0 + 8.0 * values @ self.gradient
        self.image = vtkImageData()
        self.image.SetDimensions(SIZE, SIZE, SIZE)
        self.image.GetPointData().SetScalars(
            numpy_to_vtk(values.ravel().astype(numpy.float32), deep=True))
        self.prop = vtkVolumeProperty()
        self.prop.SetInterpolationTypeToLinear()
        self.prop.ShadeOn()
        opacity = vtkPiecewiseFunction()
        for x, a in ((0.0, 0.0), (99.9, 0.0), (100.1, 1.0), (300.0, 1.0)):
            opacity.AddPoint(x, a)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, *COLOR)
        self.prop.SetScalarOpacity(opacity)
        self.prop.SetColor(color)
        self.prop.SetAmbient(0.2)
        self.prop.SetDiffuse(0.6)
        self.prop.SetSpecular(0.2)
        self.prop.SetSpecularPower(8.0)
        self.volume = vtkVolume()
        self.volume.SetProperty(self.prop)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        self.ours = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.ours.SetInputData(self.image)
        self.ours.SetSampleDistance(0.1)
        self.volume.SetMapper(self.ours)
        self.matrix = numpy.eye(4)
        self.affine = numpy.eye(3)

    def transform(self, matrix):
        """Of data to the world, about the middle of the volume."""
        self.matrix = numpy.eye(4)
        self.matrix[:3, :3] = matrix
        self.matrix[:3, 3] = [5.0, -3.0, 2.0] - self.matrix[:3, :3] @ MIDDLE
        self.volume.SetUserMatrix(to_vtk(self.matrix))

    def deform(self, affine):
        """A lattice that maps by a matrix about the middle of the volume."""
        self.affine = numpy.array(affine, dtype=float)
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(6, 6, 6)
        lattice.FitToBounds(self.image.GetBounds(), 0.1)
        points = vtk_to_numpy(lattice.GetDisplacements())
        rest = [0.0] * 3
        for i in range(6 ** 3):
            lattice.GetRestPoint(i % 6, i // 6 % 6, i // 36, rest)
            points[i] = (self.affine - numpy.eye(3)) @ (rest - MIDDLE)
        lattice.GetDisplacements().Modified()
        lattice.Modified()
        self.ours.SetDeformation(lattice)

    def look(self, direction, parallel=False):
        """Along a direction of the data at the middle of the volume."""
        camera = self.renderer.GetActiveCamera()
        focus = (self.matrix @ numpy.append(MIDDLE, 1.0))[:3]
        scale = abs(numpy.linalg.det(self.matrix[:3, :3])) ** (1.0 / 3.0)
        camera.SetFocalPoint(focus)
        camera.SetPosition(focus - 60.0 * scale * normalized(
            self.matrix[:3, :3] @ numpy.array(direction)))
        camera.SetViewUp(0.1, 1.0, 0.2)
        camera.SetParallelProjection(parallel)
        camera.SetViewAngle(5.0)
        camera.SetParallelScale(2.0 * scale)
        camera.SetClippingRange(5.0 * scale, 150.0 * scale)

    def light(self, **options):
        light = vtkLight()
        for name, value in options.items():
            setter = getattr(light, "Set" + name)
            setter(*value) if isinstance(value, tuple) else setter(value)
        self.renderer.AddLight(light)
        light.SetLightTypeToSceneLight()
        return light

    def headlight(self, **options):
        light = self.light(**options)
        light.SetLightTypeToHeadlight()
        return light

    def render_image(self):
        colors = vtkImageData()
        depths = vtkImageData()
        assert self.ours.RenderToImage(
            self.renderer, self.volume, PIXELS, PIXELS, colors, depths) == 1
        rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(-1, 4)
        return rgba[:, :3].astype(float), vtk_to_numpy(depths.GetPointData().GetScalars())

    def render_window(self, mapper):
        """By one of VTK's mappers."""
        mapper.SetInputData(self.image)
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetSampleDistance(0.1)
        window = vtkRenderWindow()
        window.SetMultiSamples(0)
        window.OffScreenRenderingOn()
        window.SetSize(PIXELS, PIXELS)
        window.AddRenderer(self.renderer)
        self.volume.SetMapper(mapper)
        window.Render()
        pixels = vtkWindowToImageFilter()
        pixels.SetInput(window)
        pixels.ShouldRerenderOff()
        pixels.Update()
        self.volume.SetMapper(self.ours)
        window.RemoveRenderer(self.renderer)
        colors = vtk_to_numpy(pixels.GetOutput().GetPointData().GetScalars())
        return colors.reshape(-1, 3).astype(float)

    def expected(self, depths):
        """Colors of the plane at the pixels."""
        camera = self.renderer.GetActiveCamera()
        to_ndc = from_vtk(camera.GetCompositeProjectionTransformMatrix(1.0, -1.0, 1.0))
        eye = numpy.linalg.inv(from_vtk(camera.GetModelViewTransformMatrix()))[:3, 3]
        y, x = numpy.mgrid[0:PIXELS, 0:PIXELS]
        ndc = numpy.stack([2.0 * (x.ravel() + 0.5) / PIXELS - 1.0,
                           2.0 * (y.ravel() + 0.5) / PIXELS - 1.0, 2.0 * depths - 1.0,
                           numpy.ones(PIXELS * PIXELS)], axis=-1)
        world = ndc @ numpy.linalg.inv(to_ndc).T
        world = world[:, :3] / world[:, 3:]
        linear = self.matrix[:3, :3] @ self.affine
        normal = normalized(-numpy.linalg.inv(linear).T @ self.gradient)
        to_eye = normalized(eye - world)
        lights = [self.renderer.GetLights().GetItemAsObject(i)
                  for i in range(self.renderer.GetLights().GetNumberOfItems())]
        ambient, diffuse, specular = numpy.zeros(3), 0.0, 0.0
        for light in lights:
            intensity = light.GetIntensity()
            strength = numpy.ones(len(world))
            to_light = to_eye
            if light.GetPositional():
                path = numpy.array(light.GetPosition()) - world
                distance = numpy.linalg.norm(path, axis=-1)
                to_light = path / distance[:, None]
                constant, linear, quadratic = light.GetAttenuationValues()
                strength = 1.0 / (constant + linear * distance + quadratic * distance ** 2)
            elif not light.LightTypeIsHeadlight():
                to_light = normalized(numpy.array(light.GetPosition()) -
                                      numpy.array(light.GetFocalPoint()))[None, :]
            if len(lights) == 1 and light.LightTypeIsHeadlight() and intensity == 1.0:
                ambient = numpy.ones(3)
            else:
                ambient = ambient + intensity * numpy.array(light.GetAmbientColor())
            n_dot_l = numpy.sum(normal * to_light, axis=-1)
            n_dot_h = numpy.sum(normal * normalized(to_light + to_eye), axis=-1)
            if self.renderer.GetTwoSidedLighting():
                n_dot_l, n_dot_h = abs(n_dot_l), abs(n_dot_h)
            n_dot_l, n_dot_h = n_dot_l.clip(0.0), n_dot_h.clip(0.0)
            diffuse = diffuse + (strength * n_dot_l)[:, None] * intensity * numpy.array(
                light.GetDiffuseColor())
            highlight = numpy.where(n_dot_h > 0.0, n_dot_h ** self.prop.GetSpecularPower(), 0.0)
            specular = specular + (strength * highlight)[:, None] * intensity * numpy.array(
                light.GetSpecularColor())
        lit = COLOR * (self.prop.GetAmbient() * ambient + self.prop.GetDiffuse() * diffuse) + \
            self.prop.GetSpecular() * specular
        return 255.0 * lit.clip(0.0, 1.0)


SHEAR = [[1.0, 0.5, 0.0], [0.0, 1.2, 0.0], [0.3, 0.0, 0.8]]
TURN = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]
MATRICES = {
    "identity": numpy.eye(3), "uniform": numpy.eye(3) * 2.5, "large": numpy.eye(3) * 1e3,
    "turned": numpy.array(TURN), "1, 1, 3": numpy.diag([1.0, 1.0, 3.0]),
    "3, 1, 1": numpy.diag([3.0, 1.0, 1.0]), "mirrored": numpy.diag([-1.0, 1.0, 2.0]),
    "sheared": numpy.array(SHEAR), "turned and scaled": numpy.array(TURN) @ numpy.diag([2, 0.5, 1]),
}


class TestLighting(unittest.TestCase):
    def check(self, plane, limit=2.0):
        """By both kernels; the samples of a pixel lie up to 0.1 behind the plane."""
        for reference in (False, True):
            plane.ours.SetReferenceKernels(reference)
            colors, depths = plane.render_image()
            self.assertTrue((depths < 1.0).all())
            expected = plane.expected(depths)
            self.assertGreater(expected.max(), 20.0)
            self.assertLess(abs(colors - expected).max(), limit)
        return colors, expected

    def print_error(self, name, mapper, plane, expected):
        error = abs(plane.render_window(mapper) - expected).mean()
        print("%s, %s: mean error %.1f of 255" % (mapper.GetClassName(), name, error))
        return error

    def test_matrices(self):
        for name, matrix in MATRICES.items():
            with self.subTest(matrix=name):
                plane = LitPlane([0.5, 0.3, -0.8])
                plane.transform(matrix)
                plane.look([0.2, -0.1, -1.0])
                plane.headlight()
                _, expected = self.check(plane)
                self.print_error(name, vtkOpenGLGPUVolumeRayCastMapper(), plane, expected)
                self.print_error(name, vtkFixedPointVolumeRayCastMapper(), plane, expected)

    def test_known_numbers(self):
        # Rising by (3, 0, 3), seen along z, diffuse light only: the root of a half without a
        # matrix; with z three times as long the normal is (3, 0, 1) and less is lit.
        plane = LitPlane([3.0, 0.0, -3.0])
        plane.prop.SetAmbient(0.0)
        plane.prop.SetDiffuse(1.0)
        plane.prop.SetSpecular(0.0)
        plane.headlight()
        for factor, least, most in ((1.0, 0.70, 0.72), (3.0, 0.31, 0.33)):
            plane.transform(numpy.diag([1.0, 1.0, factor]))
            plane.look([0.0, 0.0, -1.0], parallel=True)
            colors, _ = self.check(plane)
            self.assertGreater(colors[:, 0].mean() / 255.0, least * COLOR[0])
            self.assertLess(colors[:, 0].mean() / 255.0, most * COLOR[0])

    def test_cameras_sides_and_lights(self):
        for parallel in (False, True):
            for two_sided in (False, True):
                with self.subTest(parallel=parallel, two_sided=two_sided):
                    plane = LitPlane([0.5, 0.3, -0.8])
                    plane.transform(MATRICES["turned and scaled"] @ numpy.diag([1, 1, -1]) * 2.0)
                    plane.look([-0.6, 0.5, -1.0], parallel)
                    plane.renderer.SetTwoSidedLighting(two_sided)
                    plane.light(Position=(4.0, 20.0, 30.0), FocalPoint=(0.0, 0.0, 0.0),
                                DiffuseColor=(1.0, 0.5, 0.2), AmbientColor=(0.3, 0.2, 0.1))
                    plane.light(Position=(20.0, -10.0, 30.0), FocalPoint=(0.0, 0.0, 0.0),
                                Positional=True, ConeAngle=180.0,
                                AttenuationValues=(0.5, 0.01, 0.002), SpecularColor=(0.2, 1.0, 0.5))
                    plane.headlight(Intensity=0.4)
                    _, expected = self.check(plane, 3.0)
        self.print_error("several lights", vtkOpenGLGPUVolumeRayCastMapper(), plane, expected)

    def test_highlights_of_any_power(self):
        # To the power of zero, too, what a light does not reach has no highlight.
        for two_sided in (False, True):
            for power in (-1.5, 0.0, 0.3, 1.0, 2.5, 40.0, 1e30):
                with self.subTest(two_sided=two_sided, power=power):
                    plane = LitPlane([0.5, 0.3, -0.8])
                    plane.prop.SetSpecularPower(power)
                    plane.look([0.2, -0.1, -1.0])
                    plane.renderer.SetTwoSidedLighting(two_sided)
                    plane.light(Position=(5.0, 3.0, -8.0), FocalPoint=(0.0, 0.0, 0.0))
                    plane.headlight(Intensity=0.4)
                    self.check(plane)

    def test_steep_functions(self):
        """Gradients are large beside the range of the functions, which tells their scale."""
        for width in (1e-2, 1e-4):
            with self.subTest(width=width):
                plane = LitPlane([0.5, 0.3, -0.8])
                opacity = plane.prop.GetScalarOpacity()
                opacity.RemoveAllPoints()
                opacity.AddPoint(100.0, 0.0)
                opacity.AddPoint(100.0 + width, 1.0)
                color = vtkColorTransferFunction()
                color.AddRGBPoint(100.0, *COLOR)
                plane.prop.SetColor(color)
                plane.look([0.2, -0.1, -1.0])
                plane.light(Position=(5.0, 3.0, -8.0), FocalPoint=(0.0, 0.0, 0.0))
                plane.headlight(Intensity=0.4)
                self.check(plane)

    def test_values_that_stand_for_none(self):
        """They are far beyond all others, and gradients beside them far beyond those between these."""
        for none in (-1e7, -9.96921e36, -8e37):
            with self.subTest(none=none):
                plane = LitPlane([0.5, 0.3, -0.8])
                values = vtk_to_numpy(plane.image.GetPointData().GetScalars())
                values[values < 110.0] = none
                plane.look([0.2, -0.1, -1.0])
                plane.light(Position=(-3.0, 2.0, 8.0), FocalPoint=(0.0, 0.0, 0.0))
                plane.headlight(Intensity=0.4)
                pictures = []
                for reference in (False, True):
                    plane.ours.SetReferenceKernels(reference)
                    pictures.append(plane.render_image()[0])
                self.assertGreater(pictures[1].max() - pictures[1].min(), 20.0)
                self.assertLess(abs(pictures[0] - pictures[1]).mean(), 0.5)

    def test_specular_below_zero(self):
        # Not of this world, but the same in all kernels.
        plane = LitPlane([0.5, 0.3, -0.8])
        plane.prop.SetSpecular(-0.2)
        plane.look([0.2, -0.1, -1.0])
        plane.light(Position=(-3.0, 2.0, 8.0), FocalPoint=(0.0, 0.0, 0.0))
        plane.headlight(Intensity=0.4)
        self.check(plane)

    def test_matrices_of_the_camera(self):
        """The scene turns before the camera, about what this looks at."""
        for parallel in (False, True):
            for name in ("user view", "model"):
                with self.subTest(parallel=parallel, matrix=name):
                    plane = LitPlane([0.5, 0.3, -0.8])
                    plane.look([0.2, -0.1, -1.0], parallel)
                    plane.headlight()
                    camera = plane.renderer.GetActiveCamera()
                    turn = vtkTransform()
                    turn.Translate(
                        camera.GetFocalPoint() if name == "model" else (0.0, 0.0, -60.0))
                    turn.RotateY(35.0)
                    turn.Translate([-x for x in turn.GetPosition()])
                    if name == "model":
                        camera.SetModelTransformMatrix(turn.GetMatrix())
                    else:
                        camera.SetUserViewTransform(turn)
                    self.check(plane)

    def test_deformed(self):
        for name in ("identity", "3, 1, 1", "mirrored"):
            with self.subTest(matrix=name):
                plane = LitPlane([0.5, 0.3, -0.8])
                plane.transform(MATRICES[name])
                plane.deform([[1.1, 0.2, 0.0], [0.0, 0.8, 0.1], [0.0, 0.1, 1.2]])
                plane.look([0.2, -0.1, -1.0])
                plane.light(Position=(10.0, 20.0, 30.0), FocalPoint=(0.0, 0.0, 0.0))
                self.check(plane, 3.0)

    def test_picked_normals(self):
        # Of the plane, and of what is opaque without a gradient: back along the ray.
        for name, matrix in MATRICES.items():
            with self.subTest(matrix=name):
                plane = LitPlane([0.5, 0.3, -0.8])
                plane.transform(matrix)
                plane.deform([[1.1, 0.2, 0.0], [0.0, 0.8, 0.1], [0.0, 0.1, 1.2]])
                plane.look([0.2, -0.1, -1.0])
                window = vtkRenderWindow()
                window.OffScreenRenderingOn()
                window.SetSize(PIXELS, PIXELS)
                window.AddRenderer(plane.renderer)
                picker = vtkffd.vtkFFDVolumePicker()
                picker.SetVolumeOpacityIsovalue(0.5)
                at = (PIXELS / 2, PIXELS / 2, 0.0)
                self.assertEqual(picker.Pick(*at, plane.renderer), 1)
                linear = plane.matrix[:3, :3] @ plane.affine
                expected = normalized(-numpy.linalg.inv(linear).T @ plane.gradient)
                numpy.testing.assert_allclose(picker.GetPickNormal(), expected, atol=2e-3)
                plane.image.GetPointData().GetScalars().Fill(200.0)
                plane.image.GetPointData().GetScalars().Modified()
                camera = plane.renderer.GetActiveCamera()
                camera.SetClippingRange(camera.GetDistance(), 2.0 * camera.GetDistance())
                self.assertEqual(picker.Pick(*at, plane.renderer), 1)
                numpy.testing.assert_allclose(
                    picker.GetPickNormal(), -numpy.array(camera.GetDirectionOfProjection()),
                    atol=2e-3)
                window.RemoveRenderer(plane.renderer)

    def test_headlight(self):
        # One of full intensity lights the ambient term, others do so by their ambient color.
        for intensity in (1.0, 0.5):
            for ambient in (0.0, 0.5):
                with self.subTest(intensity=intensity, ambient=ambient):
                    plane = LitPlane([0.5, 0.3, -0.8])
                    plane.look([0.2, -0.1, -1.0])
                    plane.prop.SetAmbient(0.4)
                    # Since VTK 9.2 those of the GPU mapper are Phong's.
                    plane.prop.SetSpecular(0.0)
                    plane.headlight(Intensity=intensity, AmbientColor=(ambient,) * 3)
                    _, expected = self.check(plane)
                    gpu = self.print_error(
                        "intensity %g, ambient %g" % (intensity, ambient),
                        vtkOpenGLGPUVolumeRayCastMapper(), plane, expected)
                    fixed = self.print_error(
                        "intensity %g, ambient %g" % (intensity, ambient),
                        vtkFixedPointVolumeRayCastMapper(), plane, expected)
                    # The one leaves the color out of the ambient term of a dimmed light, the other
                    # takes the ambient color of every light.
                    if intensity == 1.0 or ambient == 0.0:
                        self.assertLess(gpu, 8.0)
                    if intensity != 1.0:
                        self.assertLess(fixed, 8.0)

    def test_bright_materials(self):
        # Lit three times too bright, samples are white at most, as with VTK's GPU mapper.
        for shape in (None, numpy.eye(3) * 1.1):
            plane = LitPlane([0.0, 0.0, -1.0])
            if shape is not None:
                plane.deform(shape)
            for x in (100.1, 300.0):
                plane.prop.GetScalarOpacity().AddPoint(x, 0.05)
            plane.ours.PremultipliedAlphaOn()
            plane.prop.SetAmbient(0.5)
            plane.prop.SetDiffuse(2.5)
            plane.prop.SetSpecular(0.0)
            plane.look([0.0, 0.0, -1.0])
            plane.headlight()
            pictures = [plane.render_window(vtkOpenGLGPUVolumeRayCastMapper())]
            for reference in (False, True):
                plane.ours.SetReferenceKernels(reference)
                pictures.append(plane.render_image()[0])
            for picture in pictures:
                red, green, blue = picture.mean(axis=0)
                self.assertGreater(red, 60.0)
                self.assertLess(red, 200.0)
                self.assertAlmostEqual(green / red, 1.0, delta=0.02)
                self.assertAlmostEqual(blue / red, 3.0 * COLOR[2], delta=0.02)

    def test_lights_that_follow_the_camera(self):
        """Images have them where windows do, whatever was drawn before."""
        def kit(plane):
            plane.kit = vtkLightKit()
            plane.kit.AddLightsToRenderer(plane.renderer)

        def camera_light(plane):
            plane.light(Position=(0.6, 0.3, 1.0)).SetLightTypeToCameraLight()

        def lamp(plane):
            plane.headlight(Positional=1, ConeAngle=60.0, AttenuationValues=(0.5, 0.01, 0.0))

        def unmoved(plane):
            plane.light(Position=(40.0, 30.0, -50.0)).SetLightTypeToCameraLight()
            plane.renderer.SetLightFollowCamera(0)

        for add in (kit, camera_light, lamp, unmoved):
            with self.subTest(add.__name__):
                plane = LitPlane([0.5, 0.3, -0.8])
                plane.ours.SetAutoAdjustSampleDistances(0)
                add(plane)
                for direction in ([0.2, -0.1, -1.0], [-0.4, -0.5, 1.0]):
                    plane.look(direction)
                    image, _ = plane.render_image()
                    shown = plane.render_window(plane.ours)
                    self.assertGreater(shown.max(), 20.0)
                    self.assertLess(abs(image - shown).max(), 2.0)

    def test_no_light(self):
        """Where none is on a renderer makes one, in images, too, unless that is switched off: then it is dark."""
        for lights in (0, 1):
            for automatic in (1, 0):
                with self.subTest(lights=lights, automatic=automatic):
                    plane = LitPlane([0.5, 0.3, -0.8])
                    plane.ours.SetAutoAdjustSampleDistances(0)
                    plane.look([0.2, -0.1, -1.0])
                    plane.renderer.SetAutomaticLightCreation(automatic)
                    if lights:
                        plane.headlight(Switch=0, DiffuseColor=(1.0, 0.0, 0.0))
                    image, _ = plane.render_image()
                    shown = plane.render_window(plane.ours)
                    gpu = plane.render_window(vtkOpenGLGPUVolumeRayCastMapper())
                    self.assertEqual(image.max() > 50.0, bool(automatic))
                    self.assertLess(abs(image - shown).max(), 2.0)
                    self.assertEqual(gpu.max() > 50.0, bool(automatic))


if __name__ == "__main__":
    unittest.main()
