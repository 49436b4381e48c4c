#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Filters in pipelines whose data change with time, that are asked for parts, or that have blocks."""

import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkCommonDataModel import (
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkPiecewiseFunction,
    vtkPolyData,
)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkImageShiftScale, vtkRTAnalyticSource
from vtkmodules.vtkImagingGeneral import vtkImageGradient

SHIFT = 20.0


def make_image(n=8, value=100.0):
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    image.AllocateScalars(11, 1)
    image.GetPointData().GetScalars().Fill(value)
    return image


def make_lattice(image, shift=0.0):
    lattice = vtkffd.vtkFFDLattice()
    lattice.FitToBounds(image.GetBounds())
    vtk_to_numpy(lattice.GetDisplacements())[:, 0] = shift
    lattice.Modified()
    return lattice


def make_animation(image):
    """The volume moves along x, from where it is at time 0 by SHIFT until time 1."""
    deform = vtkffd.vtkFFDDeformVolume()
    deform.SetInputData(image)
    deform.AddKeyframe(0.0, make_lattice(image))
    deform.AddKeyframe(1.0, make_lattice(image, SHIFT))
    return deform


class Fields(VTKPythonAlgorithmBase):
    """Displacements by the time along x, on a grid that has as many points as the time and 5 more."""

    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")

    def RequestInformation(self, _request, _inputs, outputs):
        info = outputs.GetInformationObject(0)
        times = (0.0, 1.0, 2.0)
        info.Set(vtkStreamingDemandDrivenPipeline.TIME_STEPS(), times, 3)
        info.Set(vtkStreamingDemandDrivenPipeline.TIME_RANGE(), (0.0, 2.0), 2)
        info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), (0, 4, 0, 4, 0, 4), 6)
        return 1

    def RequestData(self, _request, _inputs, outputs):
        info = outputs.GetInformationObject(0)
        key = vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
        image = vtkImageData.GetData(outputs)
        image.SetDimensions(5, 5, 5)
        image.AllocateScalars(11, 3)
        vtk_to_numpy(image.GetPointData().GetScalars())[:] = (info.Get(key) if info.Has(key) else 0, 0, 0)
        return 1


class TestPipelineTime(unittest.TestCase):
    def test_geometry_follows_the_time_of_the_second_input(self):
        sphere = vtkSphereSource()
        image = make_image()
        geometry = vtkffd.vtkFFDDeformGeometry()
        geometry.SetInputConnection(sphere.GetOutputPort())
        animation = make_animation(image)
        geometry.SetLatticeConnection(animation.GetOutputPort())
        for time in (0.0, 0.5, 1.0, 0.25):
            geometry.UpdateTimeStep(time)
            moved = geometry.GetOutput().GetCenter()[0] - sphere.GetOutput().GetCenter()[0]
            self.assertAlmostEqual(moved, time * SHIFT, places=4)
        info = geometry.GetOutputInformation(0)
        self.assertEqual(info.Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()), (0.0, 1.0))
        # With a deformation of its own it has the times of the geometry, which are none.
        geometry.SetDeformation(make_lattice(image))
        geometry.Update()
        self.assertFalse(info.Has(vtkStreamingDemandDrivenPipeline.TIME_STEPS()))

    def test_resampled_extent_follows_the_time(self):
        image = make_image()
        resample = vtkffd.vtkFFDResampleVolume()
        animation = make_animation(image)
        resample.SetInputConnection(animation.GetOutputPort())
        for time in (0.0, 1.0, 0.5, 0.0, 1.0):
            resample.UpdateTimeStep(time)
            output = resample.GetOutput()
            first = int(time * SHIFT)
            self.assertLessEqual(output.GetExtent()[0], first)
            self.assertGreaterEqual(output.GetExtent()[1], first + 7)
            self.assertLess(output.GetExtent()[1] - output.GetExtent()[0], 11)
            self.assertEqual((vtk_to_numpy(output.GetPointData().GetScalars()) > 50.0).sum(), 512)
        # A filter behind it asks for the extent that it knows.
        shift = vtkImageShiftScale()
        shift.SetInputConnection(resample.GetOutputPort())
        errors = []
        for item in (shift, shift.GetExecutive(), resample, resample.GetExecutive()):
            item.AddObserver("ErrorEvent", lambda *_: errors.append(1))
        for time in (0.0, 0.5, 1.0):
            shift.UpdateTimeStep(time)
        self.assertEqual(errors, [])
        # Who asks for a part gets that part.
        resample.UpdateTimeStep(0.5, -1, 1, 0, (10, 12, 1, 2, 3, 3))
        self.assertEqual(resample.GetOutput().GetExtent(), (10, 12, 1, 2, 3, 3))

    def test_distances_are_from_all_of_the_volume(self):
        source = vtkRTAnalyticSource()
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(250.0, 0.0)
        opacity.AddPoint(251.0, 1.0)
        found = []
        for pieces in (1, 3):
            distances = vtkffd.vtkFFDDistanceMap()
            distances.SetResolutionToVoxels()
            distances.SetScalarOpacity(opacity)
            distances.SetInputConnection(source.GetOutputPort())
            distances.UpdatePiece(pieces - 1, pieces, 0)
            found.append(vtk_to_numpy(distances.GetOutput().GetPointData().GetScalars()))
            source = vtkRTAnalyticSource()
        np.testing.assert_array_equal(*found)

    def test_pieces_are_parts_of_the_whole(self):
        source = vtkRTAnalyticSource()
        lattice = vtkffd.vtkFFDLattice()
        lattice.FitToBounds((-10, 10) * 3)
        vtk_to_numpy(lattice.GetDisplacements())[:] = np.random.default_rng(1).uniform(-1, 1, (64, 3))
        lattice.Modified()
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputConnection(source.GetOutputPort())
        deform.SetLattice(lattice)
        for attached in (False, True):
            def make(by_data=attached):
                made = vtkffd.vtkFFDResampleVolume()
                made.SetInputConnection((deform if by_data else source).GetOutputPort())
                made.SetDeformation(None if by_data else lattice)
                return made

            def values(item):
                output = item.GetOutput()
                return output, vtk_to_numpy(output.GetPointData().GetScalars())

            whole = make()
            whole.Update()
            image, expected = values(whole)
            seen = np.zeros(len(expected), int)
            for piece in range(3):
                part = make()
                part.UpdatePiece(piece, 3, 0)
                output, found = values(part)
                ids = [image.FindPoint(output.GetPoint(i)) for i in range(len(found))]
                np.testing.assert_array_equal(found, expected[ids])
                seen[ids] += 1
                self.assertLess(len(ids), 0.5 * len(expected))
            self.assertEqual(seen.min(), 1)

    def test_fit_follows_the_time_of_the_field(self):
        fields = Fields()
        fit = vtkffd.vtkFFDFitLattice()
        fit.SetInputConnection(fields.GetOutputPort())
        for time in (0.0, 1.0, 2.0, 0.0, 2.0):
            fit.UpdateTimeStep(time)
            values = vtk_to_numpy(fit.GetOutput().GetPointData().GetScalars())
            np.testing.assert_allclose(values, [(time, 0.0, 0.0)] * len(values), atol=1e-6)

    def test_fit_takes_the_whole_field(self):
        source = vtkRTAnalyticSource()
        source.SetWholeExtent(0, 16, 0, 16, 0, 16)
        gradient = vtkImageGradient()
        gradient.SetInputConnection(source.GetOutputPort())
        gradient.SetDimensionality(3)
        gradient.UpdateExtent((3, 9, 3, 9, 3, 9))
        fit = vtkffd.vtkFFDFitLattice()
        fit.SetInputConnection(gradient.GetOutputPort())
        fit.SetTolerance(1.0)
        np.testing.assert_allclose(fit.GetLattice().GetDomain(), (0, 16, 0, 16, 0, 16), atol=1e-9)

    def test_blocks_are_resampled(self):
        blocks = vtkMultiBlockDataSet()
        for i in range(3):
            image = make_image(6, i + 1.0)
            image.SetOrigin(10.0 * i, 0.0, 0.0)
            make_lattice(image, 2.0 * i).AttachTo(image)
            blocks.SetBlock(i, image)
        lattice = vtkffd.vtkFFDLattice()
        lattice.FitToBounds((0, 25, 0, 5, 0, 5))
        for deformation in (None, lattice):
            resample = vtkffd.vtkFFDResampleVolume()
            errors = []
            for item in (resample, resample.GetExecutive()):
                item.AddObserver("ErrorEvent", lambda *_, to=errors: to.append(1))
            resample.SetDeformation(deformation)
            resample.SetInputDataObject(blocks)
            resample.Update()
            self.assertEqual(errors, [])
            output = resample.GetOutputDataObject(0)
            self.assertEqual(output.GetNumberOfBlocks(), 3)
            for i in range(3):
                block = output.GetBlock(i)
                values = vtk_to_numpy(block.GetPointData().GetScalars())
                self.assertEqual((values == i + 1.0).sum(), 216)
                inside = [block.GetPoint(p)[0] for p in np.flatnonzero(values == i + 1.0)]
                moved = 0.0 if deformation else 2.0 * i
                self.assertEqual((min(inside), max(inside)), (10.0 * i + moved, 10.0 * i + moved + 5.0))

    def test_arrays_that_are_too_short_pass(self):
        for name in ("point vectors", "point normals", "cell vectors"):
            with self.subTest(name):
                sphere = vtkSphereSource()
                sphere.GenerateNormalsOff()
                sphere.Update()
                data = vtkPolyData()
                data.DeepCopy(sphere.GetOutput())
                array = vtkFloatArray()
                array.SetName("short")
                array.SetNumberOfComponents(3)
                array.SetNumberOfTuples(2)
                array.Fill(1.0)
                attributes = data.GetCellData() if "cell" in name else data.GetPointData()
                (attributes.SetNormals if "normals" in name else attributes.SetVectors)(array)
                geometry = vtkffd.vtkFFDDeformGeometry()
                geometry.SetInputData(data)
                geometry.SetDeformation(make_lattice(make_image(), 3.0))
                geometry.TransformAllInputVectorsOn()
                geometry.Update()
                self.assertAlmostEqual(
                    geometry.GetOutput().GetCenter()[0] - data.GetCenter()[0], 3.0, places=4)


if __name__ == "__main__":
    unittest.main()
