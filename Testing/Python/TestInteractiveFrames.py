# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A long still frame is preceded by a coarse one, tells how far it is, is aborted by input, and is
made again later."""

import gc
import time
import unittest

import ffdinput
import numpy as np
import vtkffd
import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_DOUBLE_MAX
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkAssembly,
    vtkCamera,
    vtkLight,
    vtkLightCollection,
    vtkLODProp3D,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkRenderWindowInteractor,
    vtkVolume,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingUI import vtkGenericRenderWindowInteractor


class InteractiveFrames(unittest.TestCase):
    def setUp(self):
        source = vtkRTAnalyticSource()
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputConnection(source.GetOutputPort())
        self.mapper.SetInteractiveSampleDistance(2.0)
        volume = vtkVolume()
        volume.SetMapper(self.mapper)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0.0, 0.001)
        opacity.AddPoint(300.0, 0.02)
        volume.GetProperty().SetScalarOpacity(opacity)
        renderer = vtkRenderer()
        renderer.AddVolume(volume)
        self.window = vtkRenderWindow()
        self.window.SetSize(200, 200)
        self.window.AddRenderer(renderer)
        self.interactor = vtkRenderWindowInteractor()
        self.interactor.SetRenderWindow(self.window)
        self.interactor.Initialize()
        self.frames = vtkffd.vtkFFDInteractiveFrames()
        self.frames.SetInteractor(self.interactor)
        # However fast the machine is: each frame reports when the rays are to be cast, at least.
        self.frames.SetLongestWait(0.0)
        self.timer = 0

    def tearDown(self):
        self.frames.SetInteractor(None)
        # In VTK 9.5 a loop serves the timers of all interactors, and ends when one says so.
        self.interactor.DestroyTimer(self.timer)
        # In VTK 9.1 no interactor may be deleted while the loop of another one runs.
        self.interactor = self.frames = self.window = self.mapper = None
        gc.collect()

    def frames_of_a_window(self, longest_wait):
        interactor = vtkGenericRenderWindowInteractor()
        interactor.SetRenderWindow(self.window)
        interactor.Initialize()
        frames = vtkffd.vtkFFDInteractiveFrames()
        frames.SetInteractor(interactor)
        frames.SetLongestWait(longest_wait)
        return interactor, frames

    def test_interactor_that_goes(self):
        interactor, frames = self.frames_of_a_window(0.0)
        self.window.Render()
        self.assertTrue(frames.IsStillFrameDue())
        self.window.SetInteractor(None)
        del interactor
        self.assertIsNone(frames.GetInteractor())
        self.mapper.SetSampleDistance(0.4)
        self.window.Render()
        self.assertFalse(frames.IsStillFrameDue())

    def test_observers_that_end_it(self):
        """The last reference to it may go while it works."""
        _interactor, frames = self.frames_of_a_window(100.0)
        kept = [frames]
        frames.AddObserver("ProgressEvent", lambda *_: kept.clear())
        del frames
        self.window.Render()
        self.assertFalse(kept)
        self.window.Render()

    def test_interactor_of_another_window(self):
        """Draws that one only: no still frame of the first can follow."""
        interactor, frames = self.frames_of_a_window(0.0)
        self.window.Render()
        self.assertTrue(frames.IsStillFrameDue())
        other = vtkRenderWindow()
        other.SetOffScreenRendering(1)
        rendered = []
        other.AddObserver("StartEvent", lambda *_: rendered.append(1))
        interactor.SetRenderWindow(other)
        time.sleep(0.4)
        for timer in range(3):
            interactor.InvokeEvent("TimerEvent", timer)
        self.assertFalse(rendered)
        self.assertFalse(frames.IsStillFrameDue())
        # Until it is told.
        frames.SetInteractor(interactor)
        frames.RenderStill()
        self.assertEqual(len(rendered), 1)

    def test_screenshots(self):
        """As the header says: the picture that the window has without coarse frames."""
        def shoot(scale, renders=True):
            to_image = vtkWindowToImageFilter()
            to_image.SetInput(self.window)
            to_image.SetScale(scale)
            to_image.ReadFrontBufferOff()
            to_image.SetShouldRerender(renders)
            to_image.Update()
            return vtk_to_numpy(to_image.GetOutput().GetPointData().GetScalars()).astype(int)

        self.frames.SetInteractor(None)
        expected = {scale: shoot(scale) for scale in (1, 2)}
        self.frames.SetInteractor(self.interactor)
        self.frames.RenderStill()
        np.testing.assert_array_equal(shoot(1, renders=False), expected[1])
        self.assertGreater(np.abs(shoot(1) - expected[1]).max(), 0)  # a coarse one
        self.frames.SetInteractor(None)
        np.testing.assert_array_equal(shoot(2), expected[2])

    def test_volume_that_goes(self):
        """A window that shows no volume of ours any more is drawn once, not for ever."""
        renderer = self.window.GetRenderers().GetFirstRenderer()
        volume = renderer.GetVolumes().GetLastProp()
        mapper = vtkFixedPointVolumeRayCastMapper()
        mapper.SetInputConnection(self.mapper.GetInputConnection(0, 0))
        ways = {
            "removed": (lambda: renderer.RemoveVolume(volume), lambda: renderer.AddVolume(volume)),
            "hidden": (volume.VisibilityOff, volume.VisibilityOn),
            "renderer": (renderer.DrawOff, renderer.DrawOn),
            "mapper": (lambda: volume.SetMapper(mapper), lambda: volume.SetMapper(self.mapper)),
        }
        for name, (hide, show) in ways.items():
            with self.subTest(name):
                interactor, frames = self.frames_of_a_window(0.0)
                self.window.Render()
                self.assertTrue(frames.IsStillFrameDue())
                hide()
                rendered = []
                tag = self.window.AddObserver("StartEvent", lambda *_: rendered.append(1))
                time.sleep(0.1)
                for timer in 3 * list(range(8)):
                    interactor.InvokeEvent("TimerEvent", timer)
                self.window.RemoveObserver(tag)
                show()
                frames.SetInteractor(None)
                self.assertEqual(len(rendered), 1)

    def test_window_after_changes(self):
        """After each of them the window does not show the scene any more."""
        renderer = self.window.GetRenderers().GetFirstRenderer()
        camera = renderer.GetActiveCamera()
        volume = renderer.GetVolumes().GetLastProp()
        light = vtkLight()
        light.SetLightTypeToSceneLight()
        renderer.AddLight(light)
        cameras = []
        for i in range(6):
            cameras.append(vtkCamera())
            cameras[i].DeepCopy(camera)
            cameras[i].Azimuth(9.0 * i)
        others = []
        for i in range(6):
            others.append(vtkVolume())
            others[i].ShallowCopy(volume)
            others[i].SetMapper(self.mapper.NewInstance())
            others[i].GetMapper().SetInputConnection(self.mapper.GetInputConnection(0, 0))
            others[i].SetPosition(3.0 * i, 0.0, 0.0)
        part = vtkVolume()
        part.ShallowCopy(volume)
        assembly = vtkAssembly()
        assembly.AddPart(part)
        levels = vtkLODProp3D()
        levels.AddLOD(self.mapper, volume.GetProperty(), 0.0)
        actor = vtkActor()
        actor.SetMapper(vtkPolyDataMapper())
        sphere = vtkSphereSource()
        actor.GetMapper().SetInputConnection(sphere.GetOutputPort())
        changes = {
            "opacity": lambda i: volume.GetProperty().SetScalarOpacityUnitDistance(2.0 + 0.1 * i),
            "camera": lambda i: camera.Azimuth(1.0),
            "older camera": lambda i: renderer.SetActiveCamera(cameras[5 - i]),
            "light intensity": lambda i: light.SetIntensity(1.0 - 0.1 * i),
            "light position": lambda i: light.SetPosition(10.0 * i, 50.0, 60.0),
            "lights": lambda i: renderer.RemoveLight(light) if i % 2 else renderer.AddLight(light),
            "two-sided": lambda i: renderer.SetTwoSidedLighting(i % 2),
            "viewport": lambda i: renderer.SetViewport(0.0, 0.0, 1.0 - 0.1 * i, 1.0),
            "background": lambda i: renderer.SetBackground(0.1 * i, 0.0, 0.0),
            "assembly": lambda i: assembly.RotateZ(9.0),
            "part of an assembly": lambda i: part.RotateZ(9.0),
            "levels of detail": lambda i: levels.RotateZ(9.0),
            "actor": lambda i: actor.SetPosition(4.0 * i, 12.0, 18.0),
            "data of an actor": lambda i: sphere.SetRadius(2.0 + i),
            "volumes": lambda i: renderer.RemoveVolume(others[i]),
        }
        shown = {"assembly": [assembly], "part of an assembly": [assembly],
                 "levels of detail": [levels], "volumes": [volume] + others}
        for name, change in changes.items():
            with self.subTest(name):
                renderer.RemoveAllViewProps()
                for prop in shown.get(name, [volume, actor]):
                    renderer.AddViewProp(prop)
                # The latest of all objects.
                volume.Modified()
                due = []
                for i in range(5):
                    change(i)
                    self.window.Render()
                    due.append(self.frames.IsStillFrameDue())
                self.assertEqual(due, 5 * [True])
                # And without a change the still one is made.
                self.window.Render()
                self.assertFalse(self.frames.IsStillFrameDue())

    def test_rays_follow_the_view(self):
        """The output of a tracer is that of a new one, also where what is new there is older."""
        renderer = self.window.GetRenderers().GetFirstRenderer()
        volume = renderer.GetVolumes().GetLastProp()
        volume.GetProperty().ShadeOn()
        old = vtkCamera()
        lights = vtkLightCollection()
        light = vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPosition(0.0, -500.0, 100.0)
        lights.AddItem(light)
        self.frames.RenderStill()
        old.DeepCopy(renderer.GetActiveCamera())
        renderer.GetActiveCamera().Azimuth(30.0)
        renderer.GetLights().GetItemAsObject(0).SetIntensity(0.9)
        volume.Modified()

        def make():
            tracer = vtkffd.vtkFFDRayTracer()
            tracer.SetRenderer(renderer)
            tracer.SetVolume(volume)
            tracer.SetImageSize(60, 60)
            tracer.AddPixelGrid(6, 6)
            return tracer

        def trace(tracer):
            tracer.Update()
            rays = tracer.GetOutput()
            return [vtk_to_numpy(array) for array in (
                rays.GetPoints().GetData(), rays.GetCellData().GetArray("Color"))]

        tracer = make()
        last = trace(tracer)
        for name, change in {
                "older lights": lambda: renderer.SetLightCollection(lights),
                "two-sided lighting": lambda: renderer.SetTwoSidedLighting(
                    not renderer.GetTwoSidedLighting()),
                "older camera": lambda: renderer.SetActiveCamera(old)}.items():
            with self.subTest(name):
                change()
                now, fresh = trace(tracer), trace(make())
                for ours, theirs in zip(now, fresh):
                    np.testing.assert_array_equal(ours, theirs)
                self.assertFalse(all(map(np.array_equal, now, last)))
                last = now
                time_of_output = tracer.GetOutput().GetMTime()
                tracer.Update()
                self.assertEqual(tracer.GetOutput().GetMTime(), time_of_output)

    def serve_events(self, is_done):
        """Until it returns true, once for each interactor: VTK's loop for X does not start twice."""
        end = time.monotonic() + 1000.0

        def on_timer(_caller, _event):
            if is_done() or time.monotonic() > end:
                self.interactor.TerminateApp()

        self.timer = self.interactor.CreateRepeatingTimer(50)
        self.interactor.AddObserver("TimerEvent", on_timer, -1.0)
        self.interactor.Start()

    def test_coarse_abort_still(self):
        expected = self.frames.GetExpectedStillTime
        self.assertEqual(expected(self.window), VTK_DOUBLE_MAX)
        self.window.Render()
        self.assertTrue(self.frames.IsStillFrameDue())
        self.assertGreater(self.mapper.GetExpectedStillTime(), 0.0)
        self.assertEqual(expected(self.window), self.mapper.GetExpectedStillTime())
        self.mapper.AutoAdjustSampleDistancesOff()
        self.assertEqual(expected(self.window), 0.0)
        self.mapper.AutoAdjustSampleDistancesOn()
        self.assertEqual(expected(None), 0.0)
        values = []

        def on_progress(_caller, _event):
            values.append(self.frames.GetProgress())
            if len(values) == 1:
                self.frames.Abort()

        self.frames.AddObserver("ProgressEvent", on_progress)
        self.serve_events(lambda: len(values) > 2 and not self.frames.IsStillFrameDue())
        self.assertEqual(self.frames.GetNumberOfAbortedFrames(), 1)
        self.assertFalse(self.frames.IsStillFrameDue())
        # Of the first frame there is only the end.
        self.assertLess(values[0], 0.5)
        self.assertEqual(values[1], 1.0)
        whole = values[2:values.index(1.0, 2)]
        self.assertLess(whole[0], 0.5)
        self.assertEqual(whole, sorted(whole))
        self.assertEqual(self.mapper.GetProgress(), 1.0)

    def test_input_aborts(self):
        """All in one event loop."""
        self.window.SetWindowName("Mine")
        self.window.Render()
        window = int(self.window.GetGenericWindowId().split("_")[1], 16)
        display = int(self.window.GetGenericDisplayId().split("_")[1], 16)
        ffdinput.focus(window)
        ffdinput.move_in(window, 100, 100)
        inputs = {"wheel": lambda: ffdinput.click(ffdinput.WHEEL_UP),
                  "button": lambda: ffdinput.click(ffdinput.LEFT),
                  "key": lambda: ffdinput.strike("Left"),
                  # As one presses it before a click.
                  "modifier": lambda: ffdinput.strike("Shift_L")}
        names = list(inputs)
        progress, aborted, titles = {}, {}, []

        def on_progress(_caller, _event):
            if names and names[0] not in progress:
                progress[names[0]] = []
                titles.append(self.window.GetWindowName())
                inputs[names[0]]()
                # The frame stands still until the input is there.
                ffdinput.wait_for_press(display)
            elif names and names[0] not in aborted:
                progress[names[0]].append(self.frames.GetProgress())
                if progress[names[0]][-1] == 1.0:
                    aborted[names[0]] = self.frames.GetNumberOfAbortedFrames()

        def go_on():
            if names and names[0] in aborted and not self.frames.IsStillFrameDue():
                titles.append(self.window.GetWindowName())
                names.pop(0)
                self.window.Render()
            return not names

        self.frames.AddObserver("ProgressEvent", on_progress)
        self.serve_events(go_on)
        self.assertEqual(aborted, {"wheel": 1, "button": 2, "key": 3, "modifier": 3})
        for name in ("wheel", "button", "key"):
            self.assertEqual(progress[name], [1.0], name)
        self.assertEqual([title.rstrip("0123456789 %") for title in titles],
                         ["Mine - rendering,", "Mine"] * 4)

    def test_title_stays(self):
        self.window.SetWindowName("Mine")
        self.frames.ShowProgressInTitleOff()
        names = set()
        self.frames.AddObserver("ProgressEvent",
                                lambda *_: names.add(self.window.GetWindowName()))
        self.frames.RenderStill()
        self.assertEqual(names, {"Mine"})


if __name__ == "__main__":
    unittest.main()
