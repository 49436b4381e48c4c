#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The lattice widget from Python: every edit by script, events, mouse and keys."""

import itertools
import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdTypeArray, vtkUnsignedCharArray
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkRenderWindowInteractor

REP = vtkffd.vtkFFDLatticeRepresentation
WIDGET = vtkffd.vtkFFDLatticeWidget


class TestRepresentation(unittest.TestCase):
    def setUp(self):
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(6, 6, 6)
        self.lattice.SetDomain(0, 30, 0, 30, 0, 30)
        self.rep = REP()
        self.rep.SetLattice(self.lattice)

    def displacements(self):
        return vtk_to_numpy(self.lattice.GetDisplacements()).reshape(6, 6, 6, 3)

    def hear(self, event):
        """The texts of the events of the representation from now on."""
        texts = []

        def on_event(_caller, _event, text):
            texts.append(text)
        on_event.CallDataType = "string0"
        self.rep.AddObserver(event, on_event)
        return texts

    def test_select_and_edit(self):
        rep = self.rep
        self.assertEqual(rep.SelectPoint(2, 2, 2), 1)
        self.assertEqual(rep.SelectPoint(3, 2, 2, REP.ADD), 1)
        self.assertEqual(rep.GetNumberOfSelectedPoints(), 2)
        self.assertEqual(rep.TranslateSelection(1, 2, 3), 1)
        numpy.testing.assert_array_equal(self.displacements()[2, 2, 3], (1, 2, 3))
        self.assertEqual(rep.GetLastEdit(), "Translate")
        changed = vtkIdTypeArray()
        rep.GetChangedPoints(changed)
        numpy.testing.assert_array_equal(vtk_to_numpy(changed), (86, 87))
        self.assertEqual(rep.ScaleSelection(2, 1, 1), 1)
        self.assertEqual(rep.RotateSelection(45, 0, 0, 1), 1)
        for _ in range(3):
            self.assertEqual(rep.Undo(), 1)
        self.assertTrue(self.lattice.IsIdentity())
        self.assertEqual(rep.GetNumberOfRedos(), 3)
        self.assertEqual(rep.Redo(), 1)
        numpy.testing.assert_array_equal(self.displacements()[2, 2, 2], (1, 2, 3))
        self.assertEqual(rep.ResetAll(), 1)
        rep.SelectPlanes(2)
        self.assertEqual(rep.GetNumberOfSelectedPoints(), 36)
        rep.SetSelectedPoints(numpy_to_vtkIdTypeArray(numpy.array([0, 5, 215]), deep=True))
        chosen = vtkIdTypeArray()
        rep.GetSelectedPoints(chosen)
        numpy.testing.assert_array_equal(vtk_to_numpy(chosen), (0, 5, 215))

    def test_options(self):
        rep = self.rep
        rep.ProportionalEditingOn()
        rep.SetProportionalRadius(15.0)
        rep.SetFalloff(REP.LINEAR)
        rep.SelectPoint(2, 2, 2)
        rep.TranslateSelection(3, 0, 0)
        self.assertAlmostEqual(self.displacements()[2, 2, 1, 0], 1.0)
        rep.ResetAll()
        rep.ProportionalEditingOff()
        rep.SetSymmetry(0, 0, 1)
        rep.TranslateSelection(0, 1, 2)
        numpy.testing.assert_array_equal(self.displacements()[3, 2, 2], (0, 1, -2))
        rep.ResetAll()
        rep.SetSymmetry(0, 0, 0)
        rep.SetFoldGuard(REP.GUARD_CLAMP)
        rep.TranslateSelection(100, 0, 0)
        self.assertTrue(self.lattice.IsFoldFree())

    def test_without_a_renderer(self):
        """As a prop of a renderer that it was not told of, or is told to forget."""
        renderer, window = vtkRenderer(), vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetSize(60, 60)
        window.AddRenderer(renderer)
        renderer.AddViewProp(self.rep)
        renderer.ResetCamera(0, 30, 0, 30, 0, 30)

        def picture():
            window.Render()
            pixels = vtkUnsignedCharArray()
            window.GetPixelData(0, 0, 59, 59, 0, pixels, 0)
            return vtk_to_numpy(pixels).astype(int)

        selected, cleared = [], []
        for known in (None, renderer, None):
            self.rep.SetRenderer(known)
            self.rep.SelectPoint(2, 2, 2)
            selected.append(picture())
            self.rep.ClearSelection()
            cleared.append(picture())
        changed = [numpy.count_nonzero(a != b) for a, b in zip(selected, cleared, strict=True)]
        self.assertGreater(changed[0], 0)
        self.assertGreater(changed[1], changed[0])  # the handle takes the renderer
        self.assertGreater(changed[1], changed[2])
        numpy.testing.assert_array_equal(cleared[2], cleared[1])

    def test_direct_manipulation(self):
        rep = self.rep
        self.assertEqual(rep.AddPin(10, 10, 10), 1)
        self.assertEqual(rep.MoveMaterial((15, 15, 15), (18, 16, 15)), 1)
        numpy.testing.assert_allclose(
            self.lattice.TransformPoint(15, 15, 15), (18, 16, 15), atol=1e-5)
        numpy.testing.assert_allclose(
            self.lattice.TransformPoint(10, 10, 10), (10, 10, 10), atol=1e-9)
        pin = [0, 0, 0]
        rep.GetPin(0, pin)
        numpy.testing.assert_allclose(pin, (10, 10, 10), atol=1e-9)

    def test_moves_that_are_too_far(self):
        """What vtkFFDLattice refuses, the representation does, too, and the lattice goes on."""
        errors = self.hear("ErrorEvent")
        rep = self.rep
        rep.SelectPoint(2, 2, 2)
        rep.SelectPoint(3, 2, 2, REP.ADD)
        self.lattice.SetDisplacement(2, 2, 2, 0.5, 0, 0)
        before = self.displacements().copy()
        for move in (lambda: rep.TranslateSelection(1e300, 0, 0),
                     lambda: rep.TranslateSelection(0, -1.01e100, 0),
                     lambda: rep.ScaleSelection(1e300, 1, 1),
                     lambda: rep.MoveMaterial((5, 5, 5), (5, 5, 1e101)),
                     lambda: rep.SetControlPoint(1, 1, 1, 1e300, 0, 0)):
            self.assertEqual(move(), 0)
            self.assertEqual(len(errors), 1)
            self.assertIn("more than 1e100", errors.pop())
            numpy.testing.assert_array_equal(self.displacements(), before)
        self.assertEqual(rep.GetNumberOfUndos(), 0)
        self.assertEqual(rep.TranslateSelection(0, 1e99, 0), 1)
        self.assertEqual(rep.Undo(), 1)
        self.assertFalse(errors)

    def test_events_carry_the_name(self):
        names = self.hear("WidgetValueChangedEvent")
        self.rep.SelectPoint(0, 0, 0)
        self.rep.TranslateSelection(1, 0, 0)
        self.rep.Undo()
        self.rep.Redo()
        self.rep.ResetSelection()
        self.rep.SetControlPoint(1, 1, 1, 9, 9, 9)
        self.rep.MoveMaterial((15, 15, 15), (16, 15, 15))
        self.assertEqual(
            names, ["Translate", "Undo", "Redo", "Reset", "Set", "Material"])

    def test_errors_are_visible(self):
        errors = self.hear("ErrorEvent")
        self.assertEqual(self.rep.SelectPoint(9, 9, 9), 0)
        self.assertEqual(self.rep.TranslateSelection(float("nan"), 0, 0), 0)
        self.assertEqual(len(errors), 2)
        self.assertIn("(9, 9, 9)", errors[0])
        self.assertIn("not finite", errors[1])


class TestWidget(unittest.TestCase):
    def setUp(self):
        self.renderer = vtkRenderer()
        self.window = vtkRenderWindow()
        self.window.SetSize(300, 300)
        self.window.AddRenderer(self.renderer)
        self.interactor = vtkRenderWindowInteractor()
        self.interactor.SetRenderWindow(self.window)
        self.interactor.SetInteractorStyle(vtkInteractorStyleTrackballCamera())
        self.set_up_widget()
        self.renderer.ResetCamera()
        self.window.Render()

    def set_up_widget(self):
        self.widget = WIDGET()
        self.widget.SetInteractor(self.interactor)
        self.rep = self.widget.GetLatticeRepresentation()
        self.rep.PlaceWidget((0, 10, 0, 10, 0, 10))
        self.lattice = self.rep.GetLattice()
        self.widget.On()

    def tearDown(self):
        self.widget.Off()

    def send(self, event, x, y, key=None, ctrl=0):
        self.interactor.SetEventInformation(x, y, ctrl, 0, "\0", 0, key)
        self.interactor.InvokeEvent(event)

    def display(self, i, j, k):
        p = [0, 0, 0]
        self.lattice.GetControlPoint(i, j, k, p)
        self.renderer.SetWorldPoint(*p, 1)
        self.renderer.WorldToDisplay()
        return [round(v) for v in self.renderer.GetDisplayPoint()[:2]]

    def test_drag_and_undo(self):
        events = []
        for name in ("StartInteractionEvent", "InteractionEvent", "EndInteractionEvent",
                     "WidgetValueChangedEvent"):
            self.widget.AddObserver(name, lambda _caller, event: events.append(event))
        x, y = self.display(3, 3, 3)
        self.send("MouseMoveEvent", x, y)
        self.assertEqual(self.rep.GetHoveredPoint(), 63)
        self.send("LeftButtonPressEvent", x, y)
        self.send("MouseMoveEvent", x - 30, y - 20)
        self.assertEqual(self.widget.IsInteracting(), 1)
        self.send("LeftButtonReleaseEvent", x - 30, y - 20)
        self.assertEqual(self.display(3, 3, 3), [x - 30, y - 20])
        self.assertEqual(events, ["StartInteractionEvent", "InteractionEvent",
                                  "WidgetValueChangedEvent", "EndInteractionEvent"])
        self.send("KeyPressEvent", x, y, "z", 1)
        self.assertTrue(self.lattice.IsIdentity())
        self.assertEqual(self.widget.Perform(WIDGET.RedoEdit), 1)
        self.assertFalse(self.lattice.IsIdentity())

    def test_others_edit_during_a_drag(self):
        """What the drag does not move keeps what it is given, also when the drag is undone or cancelled."""
        def displacement(*point):
            found = [0.0] * 3
            self.lattice.GetDisplacement(*point, found)
            return found

        other = REP()
        other.SetLattice(self.lattice)
        other.SelectPoint(1, 2, 0)
        for number, end in enumerate(("Undo", "CancelInteraction"), 1):
            x, y = self.display(3, 3, 3)
            self.send("MouseMoveEvent", x, y)
            self.send("LeftButtonPressEvent", x, y)
            self.lattice.SetDisplacement(2, 2, 2, 0, number, 0)
            self.send("MouseMoveEvent", x - 10, y - 10)
            self.lattice.SetDisplacement(1, 1, 1, 0, 0, number)
            self.assertEqual(other.TranslateSelection(1, 0, 0), 1)
            self.lattice.SetDisplacement(3, 3, 3, 9, 9, 9) # moved by the drag
            if end == "Undo":
                self.send("MouseMoveEvent", x - 30, y - 20)
                self.assertEqual(self.display(3, 3, 3), [x - 30, y - 20])
                self.send("LeftButtonReleaseEvent", x - 30, y - 20)
                changed = vtkIdTypeArray()
                self.rep.GetChangedPoints(changed)
                numpy.testing.assert_array_equal(vtk_to_numpy(changed), [63])
            getattr(self.rep, end)()
            self.assertEqual(displacement(3, 3, 3), [0, 0, 0])
            self.assertEqual(displacement(2, 2, 2), [0, number, 0])
            self.assertEqual(displacement(1, 1, 1), [0, 0, number])
            self.assertEqual(displacement(1, 2, 0), [number, 0, 0])
        self.assertEqual(other.Undo(), 1)
        self.assertEqual(displacement(1, 2, 0), [1, 0, 0])

    def test_it_is_off_before_the_highlight_goes(self):
        """ParaView turns a widget off that it finds on when its representation changes."""
        x, y = self.display(3, 3, 3)
        for press in (False, True):
            self.widget.On()
            self.send("MouseMoveEvent", x, y)
            self.assertEqual(self.rep.GetHoveredPoint(), 63)
            if press:
                self.send("LeftButtonPressEvent", x, y)
                self.send("MouseMoveEvent", x + 5, y)
            seen = []
            tag = self.rep.AddObserver(
                "ModifiedEvent", lambda *_, to=seen: to.append(self.widget.GetEnabled()))
            self.widget.Off()
            self.rep.RemoveObserver(tag)
            self.assertGreater(len(seen), 0)
            self.assertEqual(set(seen), {0})
            self.assertEqual(self.rep.GetHoveredPoint(), -1)
            self.assertEqual(self.widget.IsInteracting(), 0)
            self.send("LeftButtonReleaseEvent", x, y)

    def test_surface_by_observer(self):
        self.rep.SetManipulationMode(REP.VOLUME)
        self.rep.AddObserver("StartPickEvent", lambda *_: self.rep.SetSurfacePoint(5, 5, 10))
        self.send("LeftButtonPressEvent", 150, 150)
        self.send("MouseMoveEvent", 170, 150)
        self.send("LeftButtonReleaseEvent", 170, 150)
        self.assertEqual(self.rep.GetLastEdit(), "Material")
        moved = self.lattice.TransformPoint(5, 5, 10)
        self.renderer.SetWorldPoint(5, 5, 10, 1)
        self.renderer.WorldToDisplay()
        before = self.renderer.GetDisplayPoint()
        self.renderer.SetWorldPoint(*moved, 1)
        self.renderer.WorldToDisplay()
        self.assertAlmostEqual(self.renderer.GetDisplayPoint()[0], before[0] + 20, places=2)
        self.assertAlmostEqual(self.renderer.GetDisplayPoint()[1], before[1], places=2)

    def test_no_surface_at_no_place(self):
        for x, y in ((float("nan"), 3.0), (3.0, float("inf"))):
            self.assertEqual(self.rep.PickSurface(x, y, [0.0] * 3), 0)

    def test_parts_that_go(self):
        """A scene may end while a point is dragged, its parts in any order, or lose one of them to an observer."""
        def drag():
            self.setUp()
            x, y = self.display(3, 3, 3)
            self.send("MouseMoveEvent", x, y)
            self.send("LeftButtonPressEvent", x, y)
            self.send("MouseMoveEvent", x - 30, y - 20)
            self.assertEqual(self.widget.IsInteracting(), 1)

        self.widget.Off()
        for order in itertools.permutations(("interactor", "window", "renderer", "widget")):
            with self.subTest(order=order):
                drag()
                del self.rep, self.lattice
                for part in order:
                    delattr(self, part)
        for name, lose in self.losses().items():
            with self.subTest(lost=name):
                drag()
                lose()
                self.send("MouseMoveEvent", 100, 100)
                self.send("LeftButtonReleaseEvent", 100, 100)
                self.widget.Off()
            for event in ("StartInteractionEvent", "InteractionEvent", "EndInteractionEvent",
                          "SelectionChangedEvent", "WidgetValueChangedEvent"):
                with self.subTest(lost=name, event=event):
                    self.setUp()
                    self.widget.AddObserver(event, lambda *_, lose=lose: lose())
                    x, y = self.display(3, 3, 3)
                    for place in ((x - 30, y - 20), (x, y)):
                        self.send("MouseMoveEvent", x, y)
                        self.send("LeftButtonPressEvent", x, y)
                        self.send("MouseMoveEvent", *place)
                        self.send("LeftButtonReleaseEvent", *place)
                    for key, control in (("Tab", 0), ("z", 1), ("Delete", 0), ("Escape", 0), ("r", 0)):
                        self.send("KeyPressEvent", x, y, key, control)
                        self.send("CharEvent", x, y, key, control)
                    self.widget.Off()

    def losses(self):
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.AddRenderer(vtkRenderer())
        other = vtkRenderWindowInteractor()
        other.SetRenderWindow(window)
        return {
            "widget": lambda: self.widget.Off(),
            "window": lambda: self.interactor.SetRenderWindow(None),
            "renderer": lambda: self.window.RemoveRenderer(self.renderer),
            "interactor": lambda: self.widget.SetInteractor(None),
            "other interactor": lambda: self.widget.SetInteractor(other),
            "representation": lambda: self.widget.SetRepresentation(None),
            "lattice": lambda: self.rep.SetLattice(None),
        }

    def test_parts_that_observers_of_changes_take(self):
        """Changes are told while the widget is switched off, or loses its interactor, too."""
        ends = {"off": lambda: self.widget.Off(),
                "without": lambda: self.widget.SetInteractor(None),
                "moved": lambda: self.send("MouseMoveEvent", 100, 100)}
        for name, lose in self.losses().items():
            for source, end, pressed, times in itertools.product(
                    ("rep", "lattice"), ends, (False, True), (1, 9)):
                with self.subTest(lost=name, source=source, end=end, pressed=pressed, times=times):
                    self.set_up_widget()
                    self.window.Render()
                    x, y = self.display(3, 3, 3)
                    self.send("MouseMoveEvent", x, y)
                    if pressed:
                        self.send("LeftButtonPressEvent", x, y)
                        self.send("MouseMoveEvent", x - 30, y - 20)
                    calls = []

                    def tell(*_, calls=calls, times=times, lose=lose):
                        calls.append(1)
                        if len(calls) <= times:
                            lose()

                    getattr(self, source).AddObserver("ModifiedEvent", tell)
                    interactor = self.interactor
                    ends[end]()
                    self.widget.SetRepresentation(self.rep)
                    self.widget.Off()
                    self.assertEqual(self.widget.GetEnabled(), 0)
                    # Nothing is left that would follow the mouse.
                    before = self.rep.GetHoveredPoint()
                    interactor.SetEventInformation(x, y, 0, 0, "\0", 0, None)
                    interactor.InvokeEvent("MouseMoveEvent")
                    self.assertEqual(self.rep.GetHoveredPoint(), before)
                    # Each case has the same window: those that VTK has made stay open.
                    self.rep.RemoveAllObservers()
                    self.lattice.RemoveAllObservers()
                    self.interactor.SetRenderWindow(self.window)
                    self.window.RemoveRenderer(self.renderer)
                    self.window.AddRenderer(self.renderer)

    def test_interactor_that_goes_during_a_drag_of_the_camera(self):
        """The style of the interactor has the focus then, and no other observer hears that it is deleted."""
        self.send("MouseMoveEvent", 2, 2)
        self.send("LeftButtonPressEvent", 2, 2)
        self.assertEqual(self.interactor.GetInteractorStyle().GetState(), 1)
        self.window.SetInteractor(None)
        self.interactor = None
        self.assertIsNone(self.widget.GetInteractor())
        self.assertEqual(self.widget.GetEnabled(), 0)
        self.widget.Off()

    def test_widget_that_goes_during_a_drag(self):
        """Its representation may stay, with another widget, and the window draws still pictures again."""
        x, y = self.display(3, 3, 3)
        self.send("MouseMoveEvent", x, y)
        self.send("LeftButtonPressEvent", x, y)
        self.send("MouseMoveEvent", x - 30, y - 20)
        self.assertEqual(self.rep.IsInteracting(), 1)
        self.widget = None
        self.assertEqual(self.rep.IsInteracting(), 0)
        self.assertTrue(self.lattice.IsIdentity())
        self.assertEqual(
            self.window.GetDesiredUpdateRate(), self.interactor.GetStillUpdateRate())
        self.send("LeftButtonReleaseEvent", x - 30, y - 20)
        self.widget = WIDGET()
        self.widget.SetInteractor(self.interactor)
        self.widget.SetRepresentation(self.rep)
        self.widget.On()
        self.test_drag_and_undo()

    def test_observers_that_end_the_widget(self):
        """The last reference to it may go while it works."""
        def end(*_):
            if self.widget is not None:
                self.widget.Off()
            self.widget = self.rep = None

        def drag():
            self.send("LeftButtonPressEvent", x, y)
            self.send("MouseMoveEvent", x - 30, y - 20)
            self.send("LeftButtonReleaseEvent", x - 30, y - 20)

        def press_key():
            for event in ("KeyPressEvent", "CharEvent"):
                self.send(event, x, y, "Up")

        def cancel():
            self.send("LeftButtonPressEvent", x, y)
            self.send("MouseMoveEvent", x - 30, y - 20)
            self.send("KeyPressEvent", x, y, "Escape")

        self.widget.Off()
        for act, event in itertools.product(
                (drag, press_key, cancel),
                ("StartInteractionEvent", "InteractionEvent", "EndInteractionEvent",
                 "WidgetValueChangedEvent", "SelectionChangedEvent")):
            with self.subTest(act=act.__name__, event=event):
                self.setUp()
                x, y = self.display(3, 3, 3)
                self.send("MouseMoveEvent", x, y)
                if event != "SelectionChangedEvent":
                    self.rep.SelectPoint(3, 3, 3)
                gone = []
                self.widget.AddObserver("DeleteEvent", lambda *_, gone=gone: gone.append(True))
                self.widget.AddObserver(event, end)
                self.rep = None
                act()
                self.assertEqual(bool(gone), self.widget is None)
                if act is drag:
                    self.assertTrue(gone)
                self.window.Render()
                if self.widget is not None:
                    self.widget.Off()
        self.setUp()

    def test_matrices_of_the_camera(self):
        """Nudges go along the window, and the handle is as long as it should be in it."""
        turn, mirror, larger = vtkTransform(), vtkTransform(), vtkTransform()
        turn.RotateZ(90.0)
        mirror.Scale(-1.0, 1.0, 1.0)
        larger.Scale(1.5, 1.5, 1.5)

        def show_off_axis(camera):
            camera.UseOffAxisProjectionOn()
            camera.SetScreenBottomLeft(-5.0, -5.0, 5.0)
            camera.SetScreenBottomRight(15.0, -5.0, 5.0)
            camera.SetScreenTopRight(15.0, 15.0, 5.0)
            camera.SetEyePosition((8.0, 2.0, 60.0))
            camera.SetClippingRange(1.0, 200.0)

        views = {
            "plain": lambda _: None,
            "user view": lambda camera: camera.SetUserViewTransform(turn),
            "model": lambda camera: camera.SetModelTransformMatrix(larger.GetMatrix()),
            "mirrored": lambda camera: camera.SetUserTransform(mirror),
            "parallel": lambda camera: camera.ParallelProjectionOn(),
            "off-axis": show_off_axis}
        for name, change in views.items():
            with self.subTest(view=name):
                self.tearDown()
                self.setUp()
                change(self.renderer.GetActiveCamera())
                self.window.Render()
                self.rep.SelectPoint(2, 2, 2)
                self.window.Render()
                arm = self.rep.GetTransformHandleSize()
                x, y = self.display(2, 2, 2)
                along = {"user view": (0, 1), "mirrored": (-1, 0)}.get(name, (1, 0))
                for length, state in ((0.9, REP.OnHandle), (1.4, REP.Outside)):
                    self.assertEqual(self.rep.ComputeInteractionState(
                        round(x + length * arm * along[0]),
                        round(y + length * arm * along[1])), state)
                self.assertEqual(self.rep.NudgeSelection(40.0, 0.0), 1)
                after = self.display(2, 2, 2)
                self.assertGreater(after[0], x + 20)
                self.assertLessEqual(abs(after[1] - y), 1)
                self.assertEqual(self.rep.NudgeSelection(0.0, 40.0), 1)
                self.assertLessEqual(abs(self.display(2, 2, 2)[0] - after[0]), 1)
                self.assertGreater(self.display(2, 2, 2)[1], y + 20)

    def test_other_buttons_in_a_drag(self):
        """They neither move the camera nor keep the drag from its end."""
        for button in ("Right", "Middle"):
            with self.subTest(button=button):
                x, y = self.display(3, 3, 3)
                camera = self.renderer.GetActiveCamera().GetPosition()
                self.send("MouseMoveEvent", x, y)
                self.send("LeftButtonPressEvent", x, y)
                self.send("MouseMoveEvent", x - 10, y - 10)
                self.send(button + "ButtonPressEvent", x - 10, y - 10)
                self.send("MouseMoveEvent", x - 20, y - 10)
                moved = self.display(3, 3, 3)
                self.assertEqual(moved, [x - 20, y - 10])
                self.send("LeftButtonReleaseEvent", x - 20, y - 10)
                self.assertEqual(self.widget.IsInteracting(), 0)
                self.send(button + "ButtonReleaseEvent", x - 20, y - 10)
                self.send("MouseMoveEvent", x - 60, y - 60)
                self.assertEqual(self.display(3, 3, 3), moved)
                self.assertEqual(self.renderer.GetActiveCamera().GetPosition(), camera)
                # Without a drag they are the camera's, as ever.
                self.send(button + "ButtonPressEvent", 5, 5)
                self.send("MouseMoveEvent", 25, 40)
                self.send(button + "ButtonReleaseEvent", 25, 40)
                self.assertNotEqual(self.renderer.GetActiveCamera().GetPosition(), camera)

    def test_another_lattice_in_a_drag(self):
        """An observer that gives the lattice, or another one, more points or fewer ends the drag."""
        def resize(size):
            self.rep.GetLattice().SetDimensions(size, size, size)

        def replace(size):
            lattice = vtkffd.vtkFFDLattice()
            lattice.SetDimensions(size, size, size)
            lattice.SetDomain(0, 10, 0, 10, 0, 10)
            self.rep.SetLattice(lattice)

        self.rep.AddObserver("StartPickEvent", lambda *_: self.rep.SetSurfacePoint(5, 5, 10))
        for mode, change, size in itertools.product(
                (REP.CONTROL_POINTS, REP.VOLUME), (resize, replace), (4, 9)):
            with self.subTest(mode=mode, change=change.__name__, size=size):
                self.rep.SetManipulationMode(mode)
                replace(6)
                self.lattice = self.rep.GetLattice()
                self.window.Render()
                x, y = self.display(3, 3, 4) if mode == REP.CONTROL_POINTS else (150, 150)
                self.send("MouseMoveEvent", x, y)
                self.send("LeftButtonPressEvent", x, y)
                self.assertEqual(self.widget.IsInteracting(), 1)

                def on_modified(rep, _event):
                    rep.RemoveObserver(observer)
                    change(size)
                observer = self.rep.AddObserver("ModifiedEvent", on_modified)
                self.send("MouseMoveEvent", x + 20, y)
                self.send("MouseMoveEvent", x + 30, y)
                self.send("LeftButtonReleaseEvent", x + 30, y)
                self.assertEqual(self.rep.GetLattice().GetDimensions(), (size,) * 3)
                self.assertTrue(self.rep.GetLattice().IsIdentity())
                self.assertEqual(self.widget.IsInteracting(), 0)


if __name__ == "__main__":
    unittest.main()
