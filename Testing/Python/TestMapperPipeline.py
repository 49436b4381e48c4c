#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mapper at the end of a pipeline with time; every option is copied and printed."""

import unittest
from time import sleep

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkImagingCore import vtkExtractVOI, vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty)
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

import vtkffd

SIZE = 64
N = 20


def ball(time):
    """A ball that moves along x and grows, as an image of its own."""
    k, j, i = np.mgrid[0:N, 0:N, 0:N].astype(float)
    r = np.sqrt((i - 5.0 - 8.0 * time) ** 2 + (j - 9.0) ** 2 + (k - 10.0) ** 2)
    image = vtkImageData()
    image.SetDimensions(N, N, N)
    array = numpy_to_vtk(
        np.maximum(0.0, 100.0 * (1.0 + time) * (1.0 - r / 7.0)).ravel(), deep=True)
    array.SetName("ball")
    image.GetPointData().SetScalars(array)
    return image


class MovingBall(VTKPythonAlgorithmBase):
    """A source with time steps 0, 0.5 and 1, and anything between."""

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(
            self, nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self.executions = 0

    def RequestInformation(self, _request, _inputs, outputs):
        info = outputs.GetInformationObject(0)
        info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), 0, N - 1, 0, N - 1, 0, N - 1)
        info.Set(vtkStreamingDemandDrivenPipeline.TIME_STEPS(), [0.0, 0.5, 1.0], 3)
        info.Set(vtkStreamingDemandDrivenPipeline.TIME_RANGE(), [0.0, 1.0], 2)
        return 1

    def RequestData(self, _request, _inputs, outputs):
        info = outputs.GetInformationObject(0)
        key = vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
        time = info.Get(key) if info.Has(key) else 0.0
        self.executions += 1
        vtkImageData.GetData(outputs).ShallowCopy(ball(time))
        return 1


class Scene:
    def __init__(self):
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(5, 5, 5)
        self.lattice.FitToBounds((0, N - 1, 0, N - 1, 0, N - 1))
        self.lattice.SetDisplacement(2, 2, 2, 3.0, 2.0, 0.0)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(10, 0.0)
        opacity.AddPoint(100, 0.4)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0, 0.0, 0.0, 1.0)
        color.AddRGBPoint(200, 1.0, 0.5, 0.0)
        prop = vtkVolumeProperty()
        prop.SetScalarOpacity(opacity)
        prop.SetColor(color)
        prop.SetInterpolationTypeToLinear()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(prop)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetFocalPoint(10, 10, 10)
        camera.SetPosition(25, 20, 60)
        camera.SetClippingRange(10, 120)

    def picture(self):
        out = vtkImageData()
        assert self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, out) == 1
        return vtk_to_numpy(out.GetPointData().GetScalars()).astype(int)


class TestMapperPipeline(unittest.TestCase):
    def test_time_varying_volume(self):
        scene = Scene()
        source = MovingBall()
        scene.mapper.SetInputConnection(source.GetOutputPort())
        scene.mapper.SetDeformation(scene.lattice)
        shown = []
        for time in (0.0, 1.0, 0.5, 0.5, 0.0):
            scene.mapper.GetInputAlgorithm().UpdateTimeStep(time)
            shown.append(scene.picture())
            direct = Scene()
            direct.mapper.SetInputData(ball(time))
            direct.mapper.SetDeformation(direct.lattice)
            np.testing.assert_array_equal(shown[-1], direct.picture())
        self.assertGreater(np.abs(shown[0] - shown[1]).max(), 50)
        np.testing.assert_array_equal(shown[0], shown[4])
        # The same time again executes nothing and makes nothing anew.
        self.assertEqual(source.executions, 4)
        self.assertEqual(scene.mapper.GetNumberOfBuilds(scene.mapper.MIN_MAX_BLOCKS), 4)
        self.assertEqual(scene.mapper.GetNumberOfBuilds(scene.mapper.DEFORMATION_BOUNDS), 1)

    def test_time_varying_lattice(self):
        scene = Scene()
        moved = vtkffd.vtkFFDLattice()
        moved.DeepCopy(scene.lattice)
        moved.SetDisplacement(1, 2, 2, -4.0, 0.0, 3.0)
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(ball(0.4))
        deform.AddKeyframe(0.0, scene.lattice)
        deform.AddKeyframe(1.0, moved)
        scene.mapper.SetInputConnection(deform.GetOutputPort())
        blocks = scene.mapper.MIN_MAX_BLOCKS
        for time, lattice in ((0.0, scene.lattice), (1.0, moved), (0.0, scene.lattice)):
            scene.mapper.GetInputAlgorithm().UpdateTimeStep(time)
            picture = scene.picture()
            direct = Scene()
            direct.mapper.SetInputData(ball(0.4))
            direct.mapper.SetDeformation(lattice)
            np.testing.assert_array_equal(picture, direct.picture())
        # An animation of the lattice costs nothing per voxel.
        self.assertEqual(scene.mapper.GetNumberOfBuilds(blocks), 1)
        self.assertEqual(scene.mapper.GetNumberOfBuilds(scene.mapper.DISTANCE_MAP), 1)
        self.assertEqual(scene.mapper.GetNumberOfBuilds(scene.mapper.DEFORMATION_FIELD), 3)

    def test_voxels_through_numpy(self):
        scene = Scene()
        image = ball(0.2)
        scene.mapper.SetInputData(image)
        before = scene.picture()
        voxels = vtk_to_numpy(image.GetPointData().GetScalars())
        voxels[:] = vtk_to_numpy(ball(0.9).GetPointData().GetScalars())
        image.Modified()
        after = scene.picture()
        self.assertGreater(np.abs(before - after).max(), 50)
        other = Scene()
        other.mapper.SetInputData(ball(0.9))
        np.testing.assert_array_equal(after, other.picture())

    @staticmethod
    def options():
        """Names X of the mapper for which there are both SetX and GetX of numbers."""
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        # Not of this mapper alone: about events, errors, the pipeline and references.
        foreign = {"AbortExecute", "AbortOutput", "Progress", "ProgressShiftScale", "ReferenceCount", "Debug",
                   "GlobalWarningDisplay", "ReleaseDataFlag", "ArrayAccessMode", "ArrayId",
                   # Of two ways to say the same, the one that unlocks the other is set last.
                   "LockSampleDistanceToInputSpacing"}
        names = []
        for name in sorted(n[3:] for n in dir(mapper) if n.startswith("Set")):
            getter = getattr(mapper, "Get" + name, None)
            if getter is None or name in foreign:
                continue
            try:
                value = getter()
            except TypeError:
                continue
            if isinstance(value, (int, float)) or (
                    isinstance(value, tuple) and all(isinstance(v, float) for v in value)):
                names.append(name)
        return names

    @staticmethod
    def change(mapper, name):
        """Set an option to something else; what it is then."""
        value = getattr(mapper, "Get" + name)()
        setter = getattr(mapper, "Set" + name)
        if isinstance(value, tuple):
            # Bounds and ranges: increasing, finite.
            setter(tuple(1.5 + 2.0 * i for i in range(len(value))))
        elif isinstance(value, float):
            setter(0.75 if value != 0.75 else 0.5)
        else:
            for other in (value + 1, value - 1):
                setter(other)
                if getattr(mapper, "Get" + name)() != value:
                    break
        return getattr(mapper, "Get" + name)(), value

    def test_every_option_is_copied(self):
        names = self.options()
        self.assertGreater(len(names), 20)
        self.assertIn("SampleDistance", names)
        self.assertIn("WholeBounds", names)
        for name in names:
            with self.subTest(name):
                mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
                changed, before = self.change(mapper, name)
                self.assertNotEqual(changed, before)
                copy = vtkffd.vtkFFDInverseRayVolumeMapper()
                copy.ShallowCopy(mapper)
                self.assertEqual(getattr(copy, "Get" + name)(), changed)
                # Nor does the copy of one option change another.
                for other in names:
                    self.assertEqual(
                        getattr(copy, "Get" + other)(), getattr(mapper, "Get" + other)())

    def test_every_option_is_modified_and_printed(self):
        inherited = set(dir(vtkVolumeMapper))
        for name in self.options():
            with self.subTest(name):
                mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
                time = mapper.GetMTime()
                changed, _ = self.change(mapper, name)
                self.assertGreater(mapper.GetMTime(), time)
                time = mapper.GetMTime()
                getattr(mapper, "Set" + name)(changed)
                self.assertEqual(mapper.GetMTime(), time)
                if "Set" + name in inherited:
                    continue
                text = str(mapper)
                lines = [line for line in text.splitlines()
                         if line.strip().startswith(name + ":")]
                self.assertEqual(len(lines), 1, name)
                default = [line for line in str(vtkffd.vtkFFDInverseRayVolumeMapper()).splitlines()
                           if line.strip().startswith(name + ":")]
                self.assertNotEqual(lines, default)

    def test_lock_is_copied(self):
        for lock in (0, 1):
            mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
            mapper.SetSampleDistance(2.0)
            mapper.SetLockSampleDistanceToInputSpacing(lock)
            copy = vtkffd.vtkFFDInverseRayVolumeMapper()
            copy.ShallowCopy(mapper)
            self.assertEqual(copy.GetLockSampleDistanceToInputSpacing(), lock)
            self.assertEqual(copy.GetSampleDistance(), 2.0)

    def test_each_distance_is_locked_until_it_is_set(self):
        """Of voxels that are small or large: else 1.0 and 2.0 are more than all of the volume, or less
        than can be."""
        def samples(spacing, moving, change=lambda mapper: None, copied=False):
            image = ball(0.5)
            image.SetSpacing(spacing, spacing, spacing)
            scene = Scene()
            scene.volume.GetProperty().SetScalarOpacityUnitDistance(spacing)
            scene.mapper.SetInputData(image)
            change(scene.mapper)
            if copied:
                copy = vtkffd.vtkFFDInverseRayVolumeMapper()
                copy.ShallowCopy(scene.mapper)
                scene.mapper = copy
                scene.volume.SetMapper(copy)
            scene.mapper.CollectStatisticsOn()
            scene.mapper.SetMaximumImageSampleDistance(1.0)
            scene.renderer.ResetCamera()
            window = vtkRenderWindow()
            window.OffScreenRenderingOn()
            window.SetSize(SIZE, SIZE)
            window.AddRenderer(scene.renderer)
            window.SetDesiredUpdateRate(1e9 if moving else 1e-5)
            window.Render()
            return scene.mapper.GetStatistics().GetNumberOfVisibleSamples()

        for spacing in (0.01, 1.0, 100.0):
            still, moving = samples(spacing, False), samples(spacing, True)
            self.assertGreater(moving, 500)
            self.assertGreater(still, 1.5 * moving)
            for copied in (False, True):
                with self.subTest(spacing=spacing, copied=copied):
                    self.assertEqual(still, samples(
                        spacing, False, lambda m: m.SetInteractiveSampleDistance(4 * spacing), copied))
                    self.assertEqual(moving, samples(
                        spacing, True, lambda m: m.SetSampleDistance(0.5 * spacing), copied))
                    # Moving frames take no more samples than still ones.
                    self.assertEqual(
                        *(samples(spacing, mode, lambda m: m.SetSampleDistance(4 * spacing), copied)
                          for mode in (False, True)))
                    self.assertLess(samples(
                        spacing, True, lambda m: m.SetInteractiveSampleDistance(4 * spacing), copied),
                        0.7 * moving)
                    self.assertGreater(samples(
                        spacing, False, lambda m: m.SetSampleDistance(0.5 * spacing), copied),
                        1.5 * still)

                    def lock_again(mapper):
                        mapper.SetInteractiveSampleDistance(4 * spacing)
                        mapper.LockSampleDistanceToInputSpacingOn()
                    self.assertEqual(moving, samples(spacing, True, lock_again, copied))

    def test_aborted_picture(self):
        scene = Scene()
        scene.mapper.SetInputData(ball(0.5))
        whole = scene.picture()
        tag = scene.mapper.AddObserver(
            "VolumeMapperRenderProgressEvent", lambda *_: scene.mapper.SetAbortExecute(1))
        out = vtkImageData()
        self.assertEqual(
            scene.mapper.RenderToImage(scene.renderer, scene.volume, SIZE, SIZE, out), 0)
        self.assertEqual(out.GetNumberOfPoints(), 0)
        scene.mapper.RemoveObserver(tag)
        np.testing.assert_array_equal(scene.picture(), whole)

    def test_aborted_frame_beside_another_one(self):
        """A viewport does not show the last picture of another one, whatever they have in common."""
        scene = Scene()
        scene.mapper.SetInputData(ball(0.5))
        other = vtkVolume()
        other.SetMapper(scene.mapper)
        other.SetProperty(vtkVolumeProperty())
        other.GetProperty().DeepCopy(scene.volume.GetProperty())
        other.GetProperty().GetRGBTransferFunction().AddRGBPoint(50, 0.0, 1.0, 0.0)
        beside = vtkRenderer()
        beside.AddVolume(other)
        beside.SetActiveCamera(scene.renderer.GetActiveCamera())
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(2 * SIZE, SIZE)
        for i, renderer in enumerate((scene.renderer, beside)):
            renderer.SetViewport(0.5 * i, 0.0, 0.5 * i + 0.5, 1.0)
            window.AddRenderer(renderer)

        def show():
            window.Render()
            pixels = vtkUnsignedCharArray()
            window.GetPixelData(0, 0, 2 * SIZE - 1, SIZE - 1, 0, pixels, 0)
            return np.split(vtk_to_numpy(pixels).reshape(SIZE, 2 * SIZE, 3).astype(int), 2, axis=1)

        left, right = show()
        self.assertGreater(abs(left - right).max(), 50)
        ended = []
        scene.mapper.AddObserver("EndEvent", lambda *_: ended.append(1))
        scene.mapper.AddObserver("VolumeMapperRenderProgressEvent",
                                 lambda *_: scene.mapper.SetAbortExecute(len(ended) == 1))
        shown, aborted = show()
        np.testing.assert_array_equal(shown, left)
        self.assertTrue((aborted == right).all() or (aborted == aborted[0, 0]).all())

    def test_part_of_the_extent_that_others_ask_for(self):
        """Bounds and pickers ask for the whole, as frames do."""
        source = vtkRTAnalyticSource()
        source.SetWholeExtent(0, N - 1, 0, N - 1, 0, N - 1)
        scene = Scene()
        scene.mapper.SetInputConnection(source.GetOutputPort())
        scene.mapper.SetDeformation(scene.lattice)
        bounds = scene.mapper.GetBounds()
        part = vtkExtractVOI()
        part.SetInputConnection(source.GetOutputPort())
        part.SetVOI(0, 5, 0, 5, 0, 5)
        for ask in (scene.mapper.GetBounds, scene.volume.GetBounds):
            source.Modified()
            part.Modified()
            part.Update()
            self.assertEqual(source.GetOutput().GetDimensions(), (6, 6, 6))
            self.assertEqual(ask(), bounds)

    def test_part_of_the_second_output(self):
        """The whole of the output that the mapper is connected to, whichever that is."""
        class TwoOutputs(VTKPythonAlgorithmBase):
            def __init__(self):
                super().__init__(nInputPorts=0, nOutputPorts=2, outputType="vtkImageData")

            def FillOutputPortInformation(self, _port, info):
                info.Set(vtkDataObject.DATA_TYPE_NAME(), "vtkImageData")
                return 1

            def RequestInformation(self, _request, _inputs, outputs):
                for port in range(2):
                    info = outputs.GetInformationObject(port)
                    info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), [0, N - 1] * 3, 6)
                    info.Set(vtkAlgorithm.CAN_PRODUCE_SUB_EXTENT(), 1)
                return 1

            def RequestData(self, _request, _inputs, outputs):
                for port in range(2):
                    info = outputs.GetInformationObject(port)
                    image = vtkImageData.GetData(outputs, port)
                    image.SetExtent(info.Get(vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT()))
                    image.AllocateScalars(VTK_UNSIGNED_CHAR, 1)
                    vtk_to_numpy(image.GetPointData().GetScalars())[:] = 200
                return 1

        source = TwoOutputs()
        scene = Scene()
        scene.mapper.SetInputConnection(source.GetOutputPort(1))
        scene.mapper.SetDeformation(scene.lattice)
        picture = scene.picture()
        self.assertGreater(picture.max(), 0)
        part = vtkExtractVOI()
        part.SetInputConnection(source.GetOutputPort(1))
        part.SetVOI(0, 5, 0, 5, 0, 5)
        source.Modified()
        part.Update()
        self.assertEqual(source.GetOutputDataObject(1).GetDimensions(), (6, 6, 6))
        np.testing.assert_array_equal(scene.picture(), picture)

    def test_preparation_is_aborted(self):
        """By whoever follows the progress, between two pieces of a loop."""
        class Held(MovingBall):
            """Takes so long that the frame is to report when the first piece of its first loop is done."""

            def RequestData(self, request, inputs, outputs):
                sleep(0.02)
                return MovingBall.RequestData(self, request, inputs, outputs)

        scene, source, reports = Scene(), Held(), []
        scene.mapper.SetInputConnection(source.GetOutputPort())
        scene.mapper.SetNumberOfThreads(1)
        expected = scene.picture()

        def on_progress(*_):
            reports.append(scene.mapper.GetProgress())
            scene.mapper.SetAbortExecute(1)

        tag = scene.mapper.AddObserver("ProgressEvent", on_progress)
        for _ in range(2):
            source.Modified()
            reports.clear()
            self.assertEqual(scene.mapper.RenderToImage(
                scene.renderer, scene.volume, SIZE, SIZE, vtkImageData()), 0)
            # Of a layer of blocks; the casting begins with that of no part.
            self.assertEqual(len(reports), 1)
            self.assertTrue(0.0 < reports[0] < 0.1, reports)
        scene.mapper.RemoveObserver(tag)
        np.testing.assert_array_equal(scene.picture(), expected)


if __name__ == "__main__":
    unittest.main()
