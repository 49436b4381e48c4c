# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A long still frame is preceded by a coarse one, tells how far it is, is aborted by input, and is
made again later."""

import time
import unittest

import ffdinput
import vtkffd
import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import VTK_DOUBLE_MAX
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (
    vtkRenderer,
    vtkRenderWindow,
    vtkRenderWindowInteractor,
    vtkVolume,
)
from vtkmodules.vtkRenderingUI import vtkGenericRenderWindowInteractor


class InteractiveFrames(unittest.TestCase):
    def setUp(self):
        source = vtkRTAnalyticSource()
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputConnection(source.GetOutputPort())
        # Slow: many samples, of which each counts, by one thread.
        self.mapper.SetSampleDistance(0.002)
        self.mapper.SetInteractiveSampleDistance(1.0)
        self.mapper.SetNumberOfThreads(1)
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
        self.timer = 0

    def tearDown(self):
        self.frames.SetInteractor(None)
        # In VTK 9.5 a loop serves the timers of all interactors, and ends when one says so.
        self.interactor.DestroyTimer(self.timer)

    def frames_of_a_window(self, longest_wait):
        interactor = vtkGenericRenderWindowInteractor()
        interactor.SetRenderWindow(self.window)
        interactor.Initialize()
        frames = vtkffd.vtkFFDInteractiveFrames()
        frames.SetInteractor(interactor)
        frames.SetLongestWait(longest_wait)
        self.mapper.SetSampleDistance(0.5)
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

    def test_coarse_abort_still(self):
        expected = self.frames.GetExpectedStillTime
        self.assertEqual(expected(self.window), VTK_DOUBLE_MAX)
        self.window.Render()
        self.assertTrue(self.frames.IsStillFrameDue())
        self.assertGreater(self.mapper.GetExpectedStillTime(), 0.3)
        self.assertEqual(expected(self.window), self.mapper.GetExpectedStillTime())
        self.mapper.AutoAdjustSampleDistancesOff()
        self.assertEqual(expected(self.window), 0.0)
        self.mapper.AutoAdjustSampleDistancesOn()
        self.assertEqual(expected(None), 0.0)
        values = []
        end = time.monotonic() + 1000.0

        def on_progress(_caller, _event):
            values.append(self.frames.GetProgress())
            if len(values) == 5:
                self.frames.Abort()
                # The still frame that follows is fast enough.
                self.mapper.SetSampleDistance(0.5)

        def on_timer(_caller, _event):
            done = len(values) > 6 and not self.frames.IsStillFrameDue()
            if done or time.monotonic() > end:
                self.interactor.TerminateApp()

        self.frames.AddObserver("ProgressEvent", on_progress)
        self.timer = self.interactor.CreateRepeatingTimer(50)
        self.interactor.AddObserver("TimerEvent", on_timer, -1.0)
        self.interactor.Start()
        self.assertEqual(self.frames.GetNumberOfAbortedFrames(), 1)
        self.assertFalse(self.frames.IsStillFrameDue())
        self.assertEqual(values[:5], sorted(values[:5]))
        self.assertLess(values[4], 0.5)
        self.assertEqual(self.mapper.GetProgress(), 1.0)

    def test_input_aborts(self):
        """All in one event loop: VTK's for X does not start twice."""
        self.window.SetWindowName("Slow")
        self.window.Render()
        window = int(self.window.GetGenericWindowId().split("_")[1], 16)
        ffdinput.focus(window)
        ffdinput.move_in(window, 100, 100)
        inputs = {"wheel": lambda: ffdinput.click(ffdinput.WHEEL_UP),
                  "button": lambda: ffdinput.click(ffdinput.LEFT),
                  "key": lambda: ffdinput.strike("Left"),
                  # As one presses it before a click.
                  "modifier": lambda: ffdinput.strike("Shift_L")}
        distances = dict.fromkeys(inputs, 0.002)
        distances["modifier"] = 0.006
        tries = 0
        names = list(inputs)
        aborted, seconds, given, titles = {}, {}, [], set()
        end = time.monotonic() + 1000.0

        def on_progress(_caller, _event):
            # So early that the input comes in before the frame ends by itself.
            early = self.frames.GetProgress() < 0.5
            if not given and early and "%" in self.window.GetWindowName():
                inputs[names[0]]()
                given.append(time.monotonic())
                # The still frame that follows is fast enough.
                self.mapper.SetSampleDistance(0.5)

        def on_end(_caller, _event):
            if given and names:
                seconds.setdefault(names[0], time.monotonic() - given[0])
                aborted.setdefault(names[0], self.frames.GetNumberOfAbortedFrames())

        def on_timer(_caller, _event):
            nonlocal tries
            if names and given and not self.frames.IsStillFrameDue():
                name, wanted = names[0], len(inputs) - len(names) + 1
                titles.add(self.window.GetWindowName())
                given.clear()
                if name != "modifier" and aborted.get(name) != wanted and tries < 3:
                    # A busy machine brought the input when the frame was done.
                    tries += 1
                    distances[name] *= 0.5
                    aborted.pop(name, None)
                    seconds.pop(name, None)
                else:
                    names.pop(0)
                if names:
                    self.mapper.SetSampleDistance(distances[names[0]])
                    self.window.Render()
            elif names and not given and not self.frames.IsStillFrameDue():
                # Too fast for the input to come in between.
                self.mapper.SetSampleDistance(0.5 * self.mapper.GetSampleDistance())
                self.window.Render()
            if not names or time.monotonic() > end:
                self.interactor.TerminateApp()

        self.frames.AddObserver("ProgressEvent", on_progress)
        self.window.AddObserver("EndEvent", on_end)
        self.timer = self.interactor.CreateRepeatingTimer(50)
        self.interactor.AddObserver("TimerEvent", on_timer, -1.0)
        self.interactor.Start()
        self.assertEqual(aborted, {"wheel": 1, "button": 2, "key": 3, "modifier": 3})
        self.assertEqual(titles, {"Slow"})
        for name in ("wheel", "button", "key"):
            self.assertLess(seconds[name], 0.5, name)

    def test_title_stays(self):
        self.window.SetWindowName("Mine")
        self.frames.ShowProgressInTitleOff()
        self.mapper.SetSampleDistance(0.01)
        names = set()
        self.frames.AddObserver("ProgressEvent",
                                lambda *_: names.add(self.window.GetWindowName()))
        self.frames.RenderStill()
        self.assertEqual(names, {"Mine"})


if __name__ == "__main__":
    unittest.main()
