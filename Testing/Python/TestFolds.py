# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the deformation folds, or nearly does, the picture is that of the volume moved forward,
without holes, by all kernels.

A solid block is bent until its inner side folds. Its points are moved by T and projected: pixels that
points well within the block reach, at which T keeps their orientation, must be opaque, and pixels that
no point of the block comes near to must be empty.
"""

import unittest

import numpy
import vtkffd
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the window's implementation)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume)

VOXELS = (64, 64, 32)
SIZE = 200


def make_block(voxels=VOXELS):
    image = vtkImageData()
    image.SetDimensions(*voxels)
    values = numpy.full(numpy.prod(voxels), 200, numpy.uint8)
    image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    return image


def make_lattice(image, shape, strength, points=(8, 8, 8)):
    source = vtkffd.vtkFFDLatticeSource()
    source.SetBounds(image.GetBounds())
    source.SetDimensions(*points)
    source.SetShape(shape)
    source.SetStrength(strength)
    source.Update()
    return source.GetLattice()


def make_mapper(image, lattice):
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputData(image)
    mapper.SetDeformation(lattice)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(0.5)
    return mapper


def moved_points(lattice, margin):
    """Points of the block at least `margin` voxels within it that T moves, keeping orientation."""
    step = 0.5
    axes = [numpy.arange(margin, n - 1 - margin + 1e-6, step) for n in VOXELS]
    grid = numpy.stack(numpy.meshgrid(*axes, indexing="ij"), -1)
    points, images = vtkPoints(), vtkPoints()
    images.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(grid.reshape(-1, 3)))
    lattice.TransformPoints(points, images)
    moved = vtk_to_numpy(images.GetData()).reshape(grid.shape).copy()
    slopes = [numpy.gradient(moved, step, axis=a) for a in range(3)]
    determinants = numpy.einsum("...i,...i", slopes[0], numpy.cross(slopes[1], slopes[2]))
    return moved.reshape(-1, 3), determinants.reshape(-1)


class TestFolds(unittest.TestCase):
    def render(self, mapper, center, path=(90.0, 60.0, 180.0), opacities=((0, 1.0), (255, 1.0))):
        volume = vtkVolume()
        volume.SetMapper(mapper)
        opacity, color = vtkPiecewiseFunction(), vtkColorTransferFunction()
        for value, height in opacities:
            opacity.AddPoint(value, height)
        color.AddRGBPoint(0, 1, 1, 1)
        volume.GetProperty().SetScalarOpacity(opacity)
        volume.GetProperty().SetColor(color)
        renderer, window = vtkRenderer(), vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetSize(SIZE, SIZE)
        window.AddRenderer(renderer)
        renderer.AddVolume(volume)
        camera = renderer.GetActiveCamera()
        camera.SetFocalPoint(*center)
        camera.SetPosition(*(center + numpy.array(path)))
        camera.SetViewUp(0, 1, 0)
        renderer.ResetCameraClippingRange(mapper.GetBounds())
        colors = vtkImageData()
        self.assertEqual(mapper.RenderToImage(renderer, volume, SIZE, SIZE, colors), 1)
        pixels = vtk_to_numpy(colors.GetPointData().GetScalars())
        return renderer, pixels.reshape(SIZE, SIZE, -1)[..., 3]

    def project(self, renderer, points):
        camera = renderer.GetActiveCamera()
        matrix = camera.GetCompositeProjectionTransformMatrix(1.0, -1, 1)
        rows = numpy.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
        homogeneous = numpy.c_[points, numpy.ones(len(points))] @ rows.T
        return (homogeneous[:, :2] / homogeneous[:, 3:] * 0.5 + 0.5) * SIZE

    def check(self, shape, strength, folds):
        image = make_block()
        lattice = make_lattice(image, shape, strength)
        mapper = make_mapper(image, lattice)
        bounds = numpy.array(mapper.GetBounds()).reshape(3, 2)
        renderer, alpha = self.render(mapper, bounds.mean(axis=1))
        inner, determinants = moved_points(lattice, 1.5)
        self.assertEqual((determinants < 0).any(), folds)

        covered = numpy.zeros((SIZE, SIZE), bool)
        at = numpy.floor(self.project(renderer, inner[determinants > 0.05])).astype(int)
        at = at[((at >= 0) & (at < SIZE)).all(axis=1)]
        covered[at[:, 1], at[:, 0]] = True
        self.assertGreater(covered.sum(), 3000)
        holes = covered & (alpha < 128)
        self.assertLess(holes.sum() / covered.sum(), 0.001, "pixels without what is there")

        reached = numpy.zeros((SIZE, SIZE), bool)
        outer, _ = moved_points(lattice, 0.0)
        for dy in (-1.5, 0, 1.5):
            for dx in (-1.5, 0, 1.5):
                at = numpy.floor(self.project(renderer, outer) + (dx, dy)).astype(int)
                at = at[((at >= 0) & (at < SIZE)).all(axis=1)]
                reached[at[:, 1], at[:, 0]] = True
        self.assertEqual(((alpha > 0) & ~reached).sum(), 0, "pixels with what is not there")
        return mapper

    def test_bend_that_folds(self):
        self.check(vtkffd.vtkFFDLatticeSource.BEND, 2, True)

    def test_bend_that_does_not(self):
        self.check(vtkffd.vtkFFDLatticeSource.BEND, 0.7, False)

    def test_strong_bends_by_all_kernels(self):
        """Beside the volume T folds where its lattice ends; in it a bend of 1 does not, and its rays
        enter it at any sample. One of 2 folds: the reference kernels show the same branch."""
        source = vtkRTAnalyticSource()
        source.SetWholeExtent(-20, 20, -20, 20, -20, 20)
        source.Update()
        for size, strength in ((4, 1), (6, 1.2), (6, 2)):
            lattice = make_lattice(
                source.GetOutput(), vtkffd.vtkFFDLatticeSource.BEND, strength, (size, size, size))
            self.assertEqual(lattice.IsFoldFree(), strength < 2)
            mapper = make_mapper(source.GetOutput(), lattice)
            mapper.SetSampleDistance(1.0)
            alphas = []
            for reference in (False, True):
                mapper.SetReferenceKernels(reference)
                _, alpha = self.render(
                    mapper, numpy.zeros(3), (100.0, 60.0, 80.0), ((140, 0.0), (180, 0.3), (280, 1.0)))
                alphas.append(alpha.astype(int))
            far = (numpy.abs(alphas[0] - alphas[1]) > 20).sum()
            with self.subTest(size=size, strength=strength):
                self.assertGreater((alphas[1] > 0).sum(), 3000)
                self.assertLessEqual(far, 12)  # edges

    def test_slender_blocks_by_all_kernels(self):
        """Bends turn a third of a slender block inside out: many rest points beside the block lead
        to where it is, and samples follow some that lead nowhere."""
        for voxels, points, strength, path in (
                ((16, 38, 31), (8, 6, 6), 1.31, (31.4, 111.1, -42.8)),
                ((38, 34, 50), (5, 8, 4), 1.82, (122.1, -51.5, -22.3)),
                ((17, 47, 50), (8, 6, 5), 1.2, (-59.0, -86.9, -121.2))):
            image = make_block(voxels)
            lattice = make_lattice(image, vtkffd.vtkFFDLatticeSource.BEND, strength, points)
            mapper = make_mapper(image, lattice)
            center = numpy.array(image.GetBounds()).reshape(3, 2).mean(axis=1)
            for classification in (mapper.POST_INTERPOLATED, mapper.PRE_INTEGRATED):
                mapper.SetClassification(classification)
                alphas = []
                for reference in (False, True):
                    mapper.SetReferenceKernels(reference)
                    _, alpha = self.render(mapper, center, path, ((0, 0.9), (255, 0.9)))
                    alphas.append(alpha.astype(int))
                far = (numpy.abs(alphas[0] - alphas[1]) > 40).sum()
                with self.subTest(voxels=voxels, classification=classification):
                    self.assertGreater((alphas[1] > 128).sum(), 3000)
                    self.assertLessEqual(far, 18)  # edges

    def test_all_points_of_tapers_that_nearly_fold_converge(self):
        """Far from where they start, steps of Newton's method need the Jacobian of where they are."""
        for voxels, points, strength in (((87, 69, 44), 7, 1.166), ((68, 62, 112), 10, 1.405)):
            image = make_block(voxels)
            lattice = make_lattice(
                image, vtkffd.vtkFFDLatticeSource.TAPER, strength, (points, points, points))
            self.assertTrue(lattice.IsFoldFree())
            mapper = make_mapper(image, lattice)
            mapper.CollectStatisticsOn()
            center = numpy.array(image.GetBounds()).reshape(3, 2).mean(axis=1)
            generator = numpy.random.default_rng(5)
            for _ in range(6):
                path = generator.normal(size=3)
                path *= generator.uniform(1.2, 2.5) * max(voxels) / numpy.linalg.norm(path)
                _, alpha = self.render(mapper, center, path, ((0, 0.05), (255, 0.05)))
                with self.subTest(voxels=voxels, path=path):
                    self.assertGreater((alpha > 0).sum(), 1000)
                    statistics = mapper.GetStatistics()
                    self.assertEqual(statistics.GetNumberOfUnconvergedPoints(), 0)

    def test_rays_are_not_followed_where_the_block_is_not(self):
        """A taper that presses the block into a plane and beyond leaves gaps along most rays."""
        image = make_block()
        mapper = make_mapper(image, make_lattice(image, vtkffd.vtkFFDLatticeSource.TAPER, 2))
        mapper.CollectStatisticsOn()
        _, alpha = self.render(mapper, numpy.array([32.0, 32.0, 16.0]))
        self.assertGreater((alpha > 0).sum(), 30000)
        statistics = mapper.GetStatistics()
        # 75 where samples in gaps start from those before them.
        self.assertLess(
            statistics.GetNumberOfEvaluations() / statistics.GetNumberOfRays(), 40)

    def test_small_edits_do_not_blink(self):
        """Pictures of a little more of a bend that folds differ by the movement alone."""
        alphas = []
        for strength in (2, 2.002):
            image = make_block()
            mapper = make_mapper(
                image, make_lattice(image, vtkffd.vtkFFDLatticeSource.BEND, strength))
            _, alpha = self.render(mapper, numpy.array([32.0, 10.0, 16.0]))
            alphas.append(alpha > 128)
        changed = (alphas[0] != alphas[1]).sum()
        self.assertGreater(alphas[0].sum(), 3000)
        self.assertLess(changed / alphas[0].sum(), 0.01)


if __name__ == "__main__":
    unittest.main()
