# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every setter of the mapper, called by an observer of each event of a frame, in a window and of
RenderToImage(): the frame shows what it began with or, while it is still prepared, all of the change,
and the next one is that of a new mapper on which the same setter was called between frames. Setters are found by introspection; values are those of the
getters, and others.

    python3 TestMapperObservers.py [SETTER]      one setter alone
"""

import sys
import unittest

import numpy as np
import vtkffd
import vtkmodules.vtkRenderingFreeType  # noqa: F401 (text)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the window's implementation)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from ffdsetters import argument_lists, call, make_mask, make_plane, setters
from TestHostileValues import make_image, make_lattice, make_property
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import (vtkActor, vtkDataSetMapper, vtkRenderer, vtkRenderWindow,
                                         vtkTextActor, vtkVolume)
from vtkmodules.vtkRenderingOpenGL2 import vtkRenderStepsPass, vtkSSAAPass
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

SIDE = 24
EVENTS = ("StartEvent", "VolumeMapperRenderStartEvent", "VolumeMapperRenderProgressEvent",
          "ProgressEvent", "VolumeMapperRenderEndEvent", "EndEvent")
#: When nothing is prepared any more.
LATE = {"ProgressEvent", "VolumeMapperRenderEndEvent", "EndEvent"}
#: Not a setting of the mapper, with the reason.
NOT_CALLED = {
    "SetExecutive": "replaces the pipeline that runs the event",
    "SetDefaultExecutivePrototype": "is static: all algorithms would change",
    "SetInformation": "replaces the keys of the pipeline",
    "SetProgress": "is called by the frame itself",
    "SetProgressObserver": "takes the progress events away",
    "SetProgressText": "is text of the progress events",
    "SetProgressShiftScale": "scales the progress events",
}
#: The frame in progress is meant to change.
# The last one is of VTK 9.3.
ABORTS = {"SetAbortExecute", "AbortExecuteOn", "SetAbortExecuteAndUpdateTime"}


class Scene:
    """A window with a deformed volume, whose mapper is replaced for each check."""

    def __init__(self):
        self.image = make_image()
        self.lattice = make_lattice()
        self.volume = vtkVolume()
        self.volume.SetProperty(make_property())
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        self.renderer.SetBackground(0.1, 0.2, 0.3)
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(SIDE, SIDE)
        self.window.AddRenderer(self.renderer)
        self.plane = make_plane()
        self.new_mapper()
        self.renderer.GetActiveCamera().SetPosition(1.0, 2.0, 5.0)
        self.renderer.GetActiveCamera().SetFocalPoint(0.0, 0.0, 0.0)
        self.renderer.ResetCamera((0, 11, 0, 11, 0, 11))

    def new_mapper(self):
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.SetDeformation(self.lattice)
        self.mapper.SetAutoAdjustSampleDistances(0)
        self.mapper.AddClippingPlane(self.plane)
        self.mapper.SetMaskInput(MASK)
        self.errors = []
        self.mapper.AddObserver("ErrorEvent", self.on_error)
        self.volume.SetMapper(self.mapper)
        return self.mapper

    def on_error(self, _caller, _event, message=""):
        self.errors.append(message)

    on_error.CallDataType = "string0"

    def render(self):
        self.renderer.GetActiveCamera().SetClippingRange(5.0, 500.0)
        self.window.Render()
        pixels = vtkUnsignedCharArray()
        self.window.GetPixelData(0, 0, SIDE - 1, SIDE - 1, 0, pixels, 0)
        return vtk_to_numpy(pixels).copy()

    def to_image(self):
        image = vtkImageData()
        if not self.mapper.RenderToImage(self.renderer, self.volume, SIDE, SIDE, image):
            return np.zeros(0)
        return vtk_to_numpy(image.GetPointData().GetScalars()).copy()


MASK = make_mask()


class TestMapperObservers(unittest.TestCase):
    def test_every_setter_in_every_event(self):
        scene = Scene()
        frames = (scene.render, scene.to_image)
        before = [frame() for frame in frames]
        for picture in before:
            self.assertGreater(len(np.unique(picture)), 20)
        called = set()
        changing = set()
        for name, types in setters(vtkffd.vtkFFDInverseRayVolumeMapper):
            if name in NOT_CALLED or (ONLY and name != ONLY):
                continue
            for arguments in argument_lists(scene.mapper, name, types):
                scene.new_mapper()
                for frame in frames:
                    frame()
                if not call(scene.mapper, name, arguments):
                    continue
                called.add(name)
                expected = [frame() for frame in frames]
                if not np.array_equal(before[0], expected[0]):
                    changing.add(name)
                for event in EVENTS:
                    self.check(scene, 0, (before, expected), name, arguments, [event])
                self.check(scene, 1, (before, expected), name, arguments, EVENTS)
                self.check(scene, 1, (before, expected), name, arguments, ["ProgressEvent"])
        self.assertTrue(ONLY or (len(called) > 150 and len(changing) > 40),
                        (len(called), sorted(changing)))

    def test_settings_made_during_a_canonical_view_stay(self):
        scene = Scene()
        mapper = scene.mapper
        image = vtkImageData()
        image.SetDimensions(SIDE, SIDE, 1)

        def change(*_):
            mapper.SetBlendModeToAdditive()
            mapper.SetCropping(1)

        for observed in (False, True):
            if observed:
                mapper.AddObserver("ProgressEvent", change)
            mapper.CreateCanonicalView(scene.volume, image, 1, (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
            self.assertEqual((mapper.GetBlendMode(), mapper.GetCropping()),
                             (vtkVolumeMapper.ADDITIVE_BLEND, 1) if observed else (0, 0))

    def test_other_props_are_removed_by_observers(self):
        """The renderer goes on with them, although nobody else has them any more."""
        scene = Scene()
        without = scene.render()

        def volume():
            mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
            mapper.SetInputData(scene.image)
            other = vtkVolume()
            other.SetMapper(mapper)
            other.SetProperty(make_property())
            other.SetPosition(3.0, 3.0, 3.0)
            return other

        def text():
            other = vtkTextActor()
            other.SetInput("busy")
            return other

        def actor():
            other = vtkActor()
            other.SetMapper(vtkDataSetMapper())
            other.GetMapper().SetInputData(scene.image)
            other.SetPosition(6.0, 0.0, 0.0)
            return other

        for make in (volume, text, actor):
            for event in EVENTS:
                with self.subTest(make.__name__, event=event):
                    mapper = scene.new_mapper()
                    scene.renderer.AddViewProp(make())
                    expected = scene.render()
                    self.assertFalse(np.array_equal(expected, without))

                    def remove(*_):
                        if scene.renderer.GetViewProps().GetNumberOfItems() > 1:
                            scene.renderer.RemoveViewProp(scene.renderer.GetViewProps().GetLastProp())

                    mapper.AddObserver(event, remove)
                    np.testing.assert_array_equal(scene.render(), expected)
                    np.testing.assert_array_equal(scene.render(), without)
                    self.assertEqual(scene.errors, [])

    def test_the_mask_is_removed_by_observers(self):
        """Also by those of the progress of what is found before a frame looks at the mask: of many
        voxels, by one thread, that takes several steps."""
        side = 224
        values = np.tile(np.arange(side) % 100.0, side * side)
        mask = np.zeros(side ** 3, np.uint8)
        mask[side ** 3 // 2:] = 1

        def make(array):
            image = vtkImageData()
            image.SetDimensions(side, side, side)
            image.SetSpacing([11.0 / (side - 1)] * 3)
            image.GetPointData().SetScalars(numpy_to_vtk(array))
            return image

        scene = Scene()
        for event in EVENTS:
            with self.subTest(event=event):
                mapper = scene.new_mapper()
                mapper.SetNumberOfThreads(1)
                mapper.SetInputData(make(values))
                mapper.SetMaskInput(make(mask))
                mapper.SetMaskTypeToBinary()
                mapper.AddObserver(event, lambda *_, m=mapper: m.SetMaskInput(None))
                self.assertGreater(len(np.unique(scene.to_image())), 20)
                self.assertIsNone(mapper.GetMaskInput())
                self.assertEqual(scene.errors, [])

    def test_the_pass_is_replaced_by_observers(self):
        """The renderer goes on with the one that draws."""
        scene = Scene()
        steps = vtkRenderStepsPass()
        scene.renderer.SetPass(steps)
        expected = scene.render()
        for event in EVENTS:
            with self.subTest(event=event):
                mapper = scene.new_mapper()

                def replace(*_):
                    smooth = vtkSSAAPass()
                    smooth.SetDelegatePass(vtkRenderStepsPass())
                    scene.renderer.SetPass(smooth)

                replace()
                smoothed = scene.render()
                self.assertFalse(np.array_equal(smoothed, expected))
                mapper.AddObserver(event, replace)
                np.testing.assert_array_equal(scene.render(), smoothed)
                mapper.RemoveAllObservers()
                scene.renderer.GetPass().ReleaseGraphicsResources(scene.window)
                scene.renderer.SetPass(steps)
                np.testing.assert_array_equal(scene.render(), expected)
                self.assertEqual(scene.errors, [])

    def check(self, scene, frame, pictures, name, arguments, events):
        """`frame`: 0 in the window, 1 as an image. ProgressEvent: that of the end."""
        mapper = scene.new_mapper()
        render = (scene.render, scene.to_image)[frame]
        before, expected = (each[frame] for each in pictures)
        calls = []

        def once(_caller, event):
            if event not in calls and (event != "ProgressEvent" or mapper.GetProgress() >= 1.0):
                calls.append(event)
                call(mapper, name, arguments)

        tags = [mapper.AddObserver(event, once) for event in events]
        during = render()
        for tag in tags:
            mapper.RemoveObserver(tag)
        after = render()
        with self.subTest(setter=name, arguments=arguments, events=events, image=frame):
            self.assertTrue(calls, "no event came")
            late = calls[0] in LATE
            if name not in ABORTS and (late or not np.array_equal(during, expected)):
                np.testing.assert_array_equal(during, before, "the frame in progress changed")
            np.testing.assert_array_equal(after, expected, "the next frame")


ONLY = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else None

if __name__ == "__main__":
    unittest.main()
