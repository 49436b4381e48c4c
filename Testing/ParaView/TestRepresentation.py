#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The representation and the filters in one process, as a ParaView user meets them in Python."""

import os
import re
import time
import unittest

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import servermanager, simple, smstate
from vtkmodules.vtkCommonTransforms import vtkTransform

import ffdparaview as ffd

ffd.load()


class TestRepresentation(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        ffd.load()
        self.view = ffd.make_view()
        self.wavelet = ffd.make_wavelet()

    def show(self, **properties):
        self.lattice = simple.FFDLattice(Input=self.wavelet, **properties)
        self.display = simple.Show(self.lattice, self.view)
        self.opacity = ffd.set_functions()
        return ffd.picture(self.view, "representation")

    def test_default_is_ours_and_shows_something(self):
        picture = self.show()
        self.assertEqual(self.display.Representation, "FFD Volume")
        self.assertEqual(self.display.ColorArrayName[1], "RTData")
        self.assertGreater(ffd.lit(picture), 1000)

    def test_bounds_are_found_once(self):
        """For an edit by the representation, before the frame of the mapper; whatever else is shown."""
        self.show(Shape="Twist", Strength=2.0)
        mapper = self.view.GetRenderer().GetVolumes().GetItemAsObject(0).GetMapper()
        for strength in (1.0, 1.5, 0.5):
            self.lattice.Strength = strength
            simple.Render(self.view)
        builds = re.search(r"NumberOfBuilds: (\d+) (\d+) (\d+)", str(mapper)).groups()
        self.assertGreater(int(builds[1]), 3)
        self.assertEqual(int(builds[2]), 0)

    def test_still_pictures_are_shown_again(self):
        """Where what else is shown changes: as ParaView does for a widget below the pointer."""
        self.show(Shape="Twist", Strength=1.0)
        mapper = self.view.GetRenderer().GetVolumes().GetItemAsObject(0).GetMapper()

        def reused():
            return float(re.search(r"ReusedFraction: (\S+)", str(mapper)).group(1))
        sphere = simple.Sphere(Center=[0.0, 14.0, 14.0], Radius=4.0)
        display = simple.Show(sphere, self.view)
        for change in (lambda: None, lambda: setattr(sphere, "Center", [4.0, 14.0, 14.0]),
                       lambda: setattr(display, "DiffuseColor", [1.0, 0.0, 0.0])):
            change()
            again = ffd.picture(self.view, "again")
            self.assertGreater(reused(), 0.2)
            # As a frame that is cast as a whole.
            for distance in (2.0, 1.0):
                self.display.FFDSampleDistance = distance
                simple.Render(self.view)
                self.assertEqual(reused(), 0.0)
            whole = ffd.picture(self.view, "whole")
            self.assertTrue(np.array_equal(again, whole))
        for each in ("Azimuth", "Strength"):
            if each == "Azimuth":
                self.view.GetActiveCamera().Azimuth(10.0)
            else:
                self.lattice.Strength = 0.5
            simple.Render(self.view)
            self.assertEqual(reused(), 0.0, each)

    def test_progress_keeps_what_is_bound(self):
        """What draws the progress may bind other buffers: those of before are bound again after it, and none
        that have been deleted since."""
        self.show()
        handler = servermanager.ActiveConnection.Session.GetProgressHandler()
        interval = handler.GetProgressInterval()
        handler.SetProgressInterval(0.0)
        state = self.view.GetRenderWindow().GetState()
        sphere = simple.Sphere()
        simple.Show(sphere, self.view)
        simple.Hide(self.lattice, self.view)
        simple.Render(self.view)
        state.Reset()
        simple.Delete(sphere)
        del sphere
        simple.Show(self.lattice, self.view)
        shown = []

        def look(*_):
            for texture in (0x84C1, 0x84C0):  # VTK looks for errors of OpenGL when it chooses one
                state.vtkglActiveTexture(texture)
            shown.append(1)
        tag = handler.AddObserver("ProgressEvent", look, -2.0)
        with ffd.Errors(event="WarningEvent") as warnings:
            simple.Render(self.view)
        handler.RemoveObserver(tag)
        handler.SetProgressInterval(interval)
        self.assertTrue(shown)
        self.assertEqual(warnings.text, [])

    def test_switching_picks_an_array(self):
        """In solid color a volume would be blank."""
        display = simple.Show(self.wavelet, self.view)
        display.SetRepresentationType("Outline")
        simple.ColorBy(display, None)
        self.assertFalse(display.ColorArrayName[1])
        display.SetRepresentationType("FFD Volume")
        self.assertEqual(display.ColorArrayName[1], "RTData")
        ffd.set_functions()
        ours = ffd.picture(self.view, "ours")
        self.assertGreater(ffd.lit(ours), 1000)
        # Without a lattice it is ParaView's own volume, up to rounding and where samples lie.
        display.SetRepresentationType("Volume")
        display.VolumeRenderingMode = "Ray Cast Only"
        own = ffd.picture(self.view, "own")
        self.assertLess(np.abs(ours - own).mean(), 2.0)
        display.SetRepresentationType("Surface")
        self.assertGreater(np.abs(ffd.picture(self.view, "surface") - own).mean(), 10.0)
        display.SetRepresentationType("FFD Volume")
        self.assertEqual(ffd.differ(ffd.picture(self.view, "again"), ours)[0], 0)

    def test_switching_keeps_options(self):
        """What FFD Volume and ParaView's own volume both have is the same in both."""
        self.show()
        values = {"Shade": 1, "BlendMode": 1, "ScalarOpacityUnitDistance": 0.3}

        def get(name):
            return self.display.SMProxy.GetProperty(name).GetElement(0)

        for name, value in values.items():
            setattr(self.display, "FFD" + name, value)
        self.display.UseSeparateOpacityArray = 1
        self.display.SetRepresentationType("Volume")
        for name, value in values.items():
            self.assertEqual(get(name), value, name)
        self.display.Shade = 0
        self.display.SetRepresentationType("FFD Volume")
        self.assertEqual(self.display.FFDShade, 0)
        self.assertEqual(get("FFDBlendMode"), 1)
        # A state has both, and those of the representation that was not shown may be others.
        self.display.SMProxy.GetProperty("Shade").SetElement(0, 1)
        self.display.SetRepresentationType("Outline")
        self.display.SetRepresentationType("FFD Volume")
        self.assertEqual(self.display.FFDShade, 0)
        self.assertEqual(self.display.UseSeparateOpacityArray, 1)

    def test_switching_keeps_the_cropping_box(self):
        self.show()
        self.display.FFDUseCropping = 1
        self.display.FFDCroppingScale = [0.5, 1.0, 1.0]
        self.display.FFDCroppingOrigin = [3.0, 0.0, 0.0]
        self.display.SetRepresentationType("Volume")
        self.assertEqual(self.display.UseCropping, 1)
        self.assertEqual(list(self.display.CroppingScale), [0.5, 1.0, 1.0])
        self.assertEqual(list(self.display.CroppingOrigin), [3.0, 0.0, 0.0])
        self.display.CroppingScale = [1.0, 0.5, 1.0]
        self.display.SetRepresentationType("FFD Volume")
        self.assertEqual(list(self.display.FFDCroppingScale), [1.0, 0.5, 1.0])

    def test_animated_properties(self):
        """There are tracks for what varies in time, and for nothing else of the lattice."""
        self.show()

        def tracks(proxy):
            iterator = proxy.SMProxy.NewPropertyIterator()
            iterator.Begin()
            names = set()
            while not iterator.IsAtEnd():
                found = iterator.GetProperty()
                if found.GetAnimateable() and not found.GetInformationOnly():
                    names.add(iterator.GetKey())
                iterator.Next()
            return names

        self.assertEqual(tracks(self.lattice) - {"Input"},
                         {"Strength", "DisplacementScale", "Displacements"})
        self.assertEqual(
            {name for name in tracks(self.display) if name.startswith("FFD")},
            {"FFDCroppingOrigin", "FFDCroppingScale", "FFDIsosurfaceValues",
             "FFDScalarOpacityUnitDistance", "FFDShade", "FFDSliceFunction"})

    def test_saved_defaults(self):
        """"Save as default" keeps the shape for new lattices, but not what was done to this one by hand."""
        settings = servermanager.vtkSMSettings.GetInstance()
        lattice = simple.FFDLattice(
            Input=self.wavelet, Resolution=[5, 5, 5], DisplacementsResolution=[4, 4, 4], Shape="Twist",
            Displacements=[1.0] * 192)
        settings.SetProxySettings(lattice.SMProxy, None)
        try:
            other = simple.FFDLattice(Input=self.wavelet)
        finally:
            settings.ClearAllSettings()
        self.assertEqual((other.Shape, list(other.Resolution)), ("Twist", [5, 5, 5]))
        self.assertEqual(list(other.DisplacementsResolution), [0, 0, 0])
        self.assertEqual(len(other.Displacements), 0)

    def test_tooltips(self):
        """Everything that the properties panel shows has one."""
        self.show()
        fit = simple.FFDFitLattice(SourceLandmarks=simple.Line(), TargetLandmarks=simple.Line())
        for proxy in (self.lattice, self.display, fit):
            iterator = proxy.SMProxy.NewPropertyIterator()
            iterator.Begin()
            while not iterator.IsAtEnd():
                shown = iterator.GetProperty()
                name = iterator.GetKey()
                ours = proxy != self.display or name.startswith("FFD")
                if ours and shown.GetPanelVisibility() in ("default", "advanced"):
                    text = shown.GetDocumentation()
                    self.assertTrue(text and text.GetDescription().strip(), name)
                iterator.Next()

    def test_transfer_functions(self):
        before = self.show()
        self.opacity.Points = [37, 0, 0.5, 0, 280, 0, 0.5, 0]
        self.assertEqual(ffd.lit(ffd.picture(self.view, "transparent")), 0)
        ffd.set_functions(opaque=True)
        opaque = ffd.picture(self.view, "opaque")
        self.assertGreater(opaque.sum(), 1.2 * before.sum())
        colors = simple.GetColorTransferFunction("RTData")
        colors.RGBPoints = [37, 1, 0, 0, 280, 1, 0, 0]
        red = ffd.picture(self.view, "red")
        self.assertEqual(red[:, :, 1:].max(), 0)
        self.assertGreater(red[:, :, 0].max(), 200)

    def test_shapes_and_displacements(self):
        pictures = [self.show()]
        for shape in ("Bend", "Twist", "Taper", "Bulge", "Wave", "Random"):
            self.lattice.Shape = shape
            pictures.append(ffd.picture(self.view, shape))
        for i, a in enumerate(pictures):
            for b in pictures[:i]:
                self.assertGreater(np.abs(a - b).mean(), 1.0)
        self.lattice.Shape = "Twist"
        for name, value, default in (("Strength", 0.3, 1.0), ("DisplacementScale", 0.5, 1.0),
                                     ("Padding", 0.3, 0.0), ("Resolution", [4] * 3, [6] * 3)):
            twisted = ffd.picture(self.view, "twisted")
            setattr(self.lattice, name, value)
            self.assertGreater(np.abs(ffd.picture(self.view, name) - twisted).mean(), 0.1, name)
            setattr(self.lattice, name, default)
        self.lattice.Shape = "Random"
        random = ffd.picture(self.view, "random")
        self.lattice.Seed = 7
        self.assertGreater(np.abs(ffd.picture(self.view, "seed") - random).mean(), 0.3)

    def test_displacements_translate(self):
        """All control points moved alike move the volume, and its bounds with it."""
        at_rest = self.show(Resolution=[4, 4, 4])
        self.lattice.Displacements = [0.0, 0.0, 6.0] * 64
        moved = ffd.picture(self.view, "moved")
        self.assertGreater(np.abs(moved - at_rest).mean(), 5.0)
        self.view.CameraPosition = [75.0, 45.0, 66.0]
        self.view.CameraFocalPoint = [0.0, 0.0, 6.0]
        followed = ffd.picture(self.view, "followed")
        self.assertLess(np.abs(followed - at_rest).mean(), 1.0)
        # Finer: the same map.
        self.lattice.DisplacementsResolution = [4, 4, 4]
        self.lattice.Resolution = [8, 8, 8]
        self.assertLess(np.abs(ffd.picture(self.view, "finer") - followed).mean(), 0.2)

    def test_camera_reset_uses_deformed_bounds(self):
        self.show(Resolution=[4, 4, 4], Displacements=[100.0, 0.0, 0.0] * 64)
        self.view.ResetCamera()
        simple.Render(self.view)
        self.assertAlmostEqual(self.view.CameraFocalPoint[0], 100.0, delta=1.0)
        self.assertGreater(ffd.lit(ffd.picture(self.view, "reset")), 1000)

    def test_options(self):
        """Each option changes the picture, but for those that must not."""
        self.show(Shape="Twist", Strength=1.0)
        reference = ffd.picture(self.view, "reference")
        for name, value, default in (
                ("FFDInverseMode", "First Order", "Exact"),
                ("FFDInverseMode", "Pull Back", "Exact"), ("FFDSampleDistance", 0.25, 1.0),
                ("FFDImageSampleDistance", 4.0, 1.0), ("FFDOpacityLength", "Material", "World"),
                ("FFDShade", 1, 0), ("FFDScalarOpacityUnitDistance", 0.3,
                                    self.display.FFDScalarOpacityUnitDistance),
                ("FFDEarlyRayTermination", 0.6, 1.0 / 255.0), ("FFDJittering", 1, 0),
                ("FFDSegmentation", "Greedy Angle", "Error Bound")):
            setattr(self.display, name, value)
            changed = ffd.picture(self.view, name)
            self.assertGreater(ffd.differ(changed, reference)[0], 1, name)
            setattr(self.display, name, default)
            self.assertLessEqual(
                ffd.differ(ffd.picture(self.view, "back"), reference)[0], 2, name)
        for name, value in (("FFDSpaceLeaping", "Off"), ("FFDNumberOfThreads", 1),
                            ("FFDPositionTolerance", 0.01), ("FFDInverseTolerance", 0.001)):
            setattr(self.display, name, value)
            self.assertLessEqual(
                ffd.differ(ffd.picture(self.view, name), reference)[0], 12, name)

    def test_level_of_detail(self):
        """Interactive pictures follow the LOD settings of the view."""
        self.show(Shape="Twist")
        ffd.set_functions(opaque=True)
        self.display.FFDSampleDistance = 0.5
        self.view.LODThreshold = 0.0
        self.view.LODResolution = 1.0
        still = ffd.picture(self.view, "still")
        fine = ffd.moving_picture(self.view)
        self.assertEqual(fine.shape, still.shape)
        self.assertLessEqual(ffd.differ(fine, still)[0], 3)
        self.view.LODResolution = 0.2
        coarse = ffd.moving_picture(self.view)
        self.assertGreater(ffd.differ(coarse, still)[0], 8)
        # The same samples below the threshold, and all rays where the machine keeps up. The view
        # looks at the threshold when it updates.
        self.view.LODThreshold = 1000.0
        self.lattice.Seed = 2
        self.assertLess(ffd.differ(ffd.moving_picture(self.view), still)[1],
                        ffd.differ(coarse, still)[1])
        # Without giving way.
        self.view.LODThreshold = 0.0
        self.lattice.Seed = 3
        self.display.FFDAdaptInteractiveQuality = 0
        self.assertLessEqual(ffd.differ(ffd.moving_picture(self.view), still)[0], 3)

    def test_edits_while_moving(self):
        """A volume beyond the LOD threshold is shown while it is dragged, and as it is edited."""
        first = self.show(Shape="Twist")
        self.view.LODThreshold = 0.0
        self.view.LODResolution = 1.0
        self.display.FFDAdaptInteractiveQuality = 0
        for strength in (2.0, -1.0):
            self.lattice.Strength = strength
            moving = ffd.moving_picture(self.view)
            self.assertGreater(ffd.differ(moving, first)[1], 1.0)
            still = ffd.picture(self.view, "edited")
            self.assertLessEqual(ffd.differ(moving, still)[0], 3)
            first = still

    def test_blend_modes(self):
        """Each mode gives another picture."""
        composite = self.show(Shape="Twist")
        for mode in ("Maximum Intensity", "Minimum Intensity", "Average Intensity", "Additive",
                     "Isosurface", "Slice"):
            self.display.FFDBlendMode = mode
            self.display.FFDIsosurfaceValues = [150.0]
            with ffd.Errors() as errors:
                picture = ffd.picture(self.view, "blend")
            self.assertGreater(ffd.differ(picture, composite)[1], 1.0, mode)
            self.assertEqual(errors.text, [], mode)
            # The least value along a ray is one of the transparent ones.
            if mode != "Minimum Intensity":
                self.assertGreater(ffd.lit(picture), 0, mode)
        self.display.FFDBlendMode = "Composite"
        self.assertEqual(ffd.differ(ffd.picture(self.view, "composite"), composite)[0], 0)

    def test_cropping(self):
        whole = self.show(Shape="Twist")
        self.display.FFDUseCropping = 1
        self.display.FFDCroppingScale = [1.0, 1.0, 0.5]
        self.display.FFDCroppingOrigin = [0.0, 0.0, 7.5]
        with ffd.Errors() as errors:
            cropped = ffd.picture(self.view, "cropped")
        self.assertEqual(errors.text, [])
        # The upper half of it.
        middle = whole.shape[0] // 2
        self.assertLess(ffd.lit(cropped), 0.8 * ffd.lit(whole))
        self.assertLess(np.abs(cropped - whole)[middle + 20:].mean(),
                        np.abs(cropped - whole)[:middle - 20].mean())
        # A twist bends cuts across x; those of deformed space are straight.
        self.display.FFDCroppingScale = [0.5, 1.0, 1.0]
        self.display.FFDCroppingOrigin = [7.5, 0.0, 0.0]
        cropped = ffd.picture(self.view, "bent")
        self.display.FFDCroppingSpace = "Deformed"
        straight = ffd.picture(self.view, "straight")
        self.assertGreater(np.abs(straight - cropped).mean(), 0.3)
        self.assertLess(ffd.lit(straight), 0.95 * ffd.lit(whole))
        self.display.FFDCroppingScale = [1.0, 1.0, 1.0]
        self.display.FFDCroppingOrigin = [0.0, 0.0, 0.0]
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "box"), whole)[0], 3)
        self.display.FFDUseCropping = 0
        self.assertEqual(ffd.differ(ffd.picture(self.view, "uncropped"), whole)[0], 0)

    def test_cropping_of_oriented_volumes(self):
        """The box of the defaults is the whole volume; half of it is that half of the volume."""
        for direction in ([-1, 0, 0, 0, -1, 0, 0, 0, 1], [0, 1, 0, 0, 0, -1, 1, 0, 0],
                          [0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1]):
            source = ffd.make_source("vtkImageData", [2, 17] * 3,
                                     "output.SetOrigin(5, -3, 2); output.SetDirectionMatrix(%s)" %
                                     ", ".join(map(str, direction)))
            for data in (simple.FFDLattice(Input=source, Shape="Twist"), source):
                display = simple.Show(data, self.view)
                display.SetRepresentationType("FFD Volume")
                simple.ColorBy(display, ("POINTS", "RTData"))
                ffd.set_functions()
                bounds = np.array(source.GetDataInformation().GetBounds())
                middle = (bounds[::2] + bounds[1::2]) / 2.0
                self.view.CameraFocalPoint = middle
                self.view.CameraPosition = middle + [0.0, 0.0, 60.0]
                self.view.CameraViewUp = [0.0, 1.0, 0.0]
                whole = ffd.picture(self.view, "oriented")
                self.assertGreater(ffd.lit(whole), 1000)
                display.FFDUseCropping = 1
                self.assertLessEqual(ffd.differ(ffd.picture(self.view, "oriented box"), whole)[0], 3)
                if data is source and 0.8 not in direction:
                    display.FFDCroppingScale = [0.5, 1.0, 1.0]
                    display.FFDCroppingOrigin = [0.5 * bounds[1], 0.0, 0.0]
                    half = ffd.picture(self.view, "oriented half")
                    columns = whole.shape[1] // 2
                    self.assertEqual(ffd.lit(half[:, :columns - 2]), 0)
                    self.assertGreater(ffd.lit(half[:, columns:]), 0.98 * ffd.lit(whole[:, columns:]))
                    display.FFDCroppingScale = [1.0, 1.0, 1.0]
                    display.FFDCroppingOrigin = [0.0, 0.0, 0.0]
                display.FFDUseCropping = 0
                simple.Hide(data, self.view)

    def test_trace(self):
        """A Python trace of a session gives the session again."""
        from paraview import smtrace
        smtrace.start_trace()
        lattice = simple.FFDLattice(registrationName="Lattice", Input=self.wavelet)
        display = simple.Show(lattice, self.view)
        lattice.Shape = "Bend"
        lattice.Resolution = [4, 4, 4]
        lattice.Displacements = list(np.linspace(-2.0, 2.0, 192))
        display.FFDInverseMode = "First Order"
        text = smtrace.stop_trace()
        for words in ("FFDLattice(", "registrationName='Lattice'", "Show("):
            self.assertIn(words, text)
        # ParaView traces changes of properties where its windows apply them (TestPanel.py); a
        # state has all of them.
        state = smstate.get_state()
        for words in ("lattice.Shape = 'Bend'", "lattice.Resolution = [4, 4, 4]",
                      "lattice.Displacements = [-2.0", "FFDInverseMode = 'First Order'"):
            self.assertIn(words, state)

    def test_filters(self):
        """Resampling gives the same picture; geometry moves with the volume."""
        deformed = self.show(Shape="Twist", Strength=1.0)
        simple.Hide(self.lattice, self.view)
        resampled = simple.FFDResampleToImage(Input=self.lattice)
        display = simple.Show(resampled, self.view)
        self.assertEqual(display.Representation, "FFD Volume")
        ffd.set_functions()
        self.assertLess(np.abs(ffd.picture(self.view, "resampled") - deformed).mean(), 2.0)
        simple.Hide(resampled, self.view)
        self.lattice.Shape = "None"
        self.lattice.Resolution = [4, 4, 4]
        self.lattice.Displacements = [0.0, 5.0, 0.0] * 64
        ball = simple.Sphere(Radius=3.0)
        moved = simple.FFDDeformGeometry(Input=ball, Lattice=self.lattice)
        moved.UpdatePipeline()
        bounds = moved.GetDataInformation().GetBounds()
        rest = ball.GetDataInformation().GetBounds()
        for a, shift in enumerate((0.0, 5.0, 0.0)):
            self.assertAlmostEqual(bounds[2 * a], rest[2 * a] + shift, places=4)
            self.assertAlmostEqual(bounds[2 * a + 1], rest[2 * a + 1] + shift, places=4)

    def test_vectors_and_cells(self):
        """Components and magnitudes of vectors, and cell data."""
        gradient = simple.Gradient(Input=self.wavelet, ScalarArray=["POINTS", "RTData"])
        display = simple.Show(gradient, self.view)
        display.SetRepresentationType("FFD Volume")
        simple.ColorBy(display, ("POINTS", "Gradient", "Magnitude"))
        display.RescaleTransferFunctionToDataRange(False, True)
        magnitude = ffd.picture(self.view, "magnitude")
        self.assertGreater(ffd.lit(magnitude), 1000)
        simple.ColorBy(display, ("POINTS", "Gradient", "X"))
        display.RescaleTransferFunctionToDataRange(False, True)
        component = ffd.picture(self.view, "component")
        self.assertGreater(ffd.lit(component), 1000)
        self.assertGreater(np.abs(component - magnitude).mean(), 1.0)
        simple.Hide(gradient, self.view)
        cells = simple.PointDatatoCellData(Input=self.wavelet)
        display = simple.Show(cells, self.view)
        display.SetRepresentationType("FFD Volume")
        simple.ColorBy(display, ("CELLS", "RTData"))
        ffd.set_functions()
        self.assertGreater(ffd.lit(ffd.picture(self.view, "cells")), 1000)

    def test_surfaces(self):
        """A surface in front hides the volume, one inside is seen through it, one behind, too."""
        self.show()
        ffd.set_functions(opaque=True)
        volume = ffd.picture(self.view, "volume")
        middle = volume.shape[0] // 2, volume.shape[1] // 2
        ball = simple.Sphere(Radius=4.0, Center=[37.5, 22.5, 30.0])
        display = simple.Show(ball, self.view)
        display.ColorArrayName = [None, ""]
        display.DiffuseColor = [0.0, 1.0, 0.0]
        display.AmbientColor = [0.0, 1.0, 0.0]
        front = ffd.picture(self.view, "front")[middle]
        self.assertGreater(front[1], 100)
        self.assertLess(front[0] + front[2], 60)
        ball.Center = [-37.5, -22.5, -30.0]
        behind = ffd.picture(self.view, "behind")[middle]
        self.assertLessEqual(np.abs(behind - volume[middle]).max(), 3)
        ball.Center = [0.0, 0.0, 0.0]
        ffd.set_functions(opaque=False)
        inside = ffd.picture(self.view, "inside")[middle]
        simple.Hide(ball, self.view)
        without = ffd.picture(self.view, "without")[middle]
        self.assertGreater(np.abs(inside - without).max(), 20)
        self.assertGreater(inside[0], 15)

    def test_points_in_coarse_pictures(self):
        """Small things in the volume, as control points are, leave no dark marks where there are
        fewer rays than pixels."""
        self.show(Shape="Twist", Resolution=[4, 4, 4])
        self.opacity.Points = [37, 0, 0.5, 0, 140, 0.1, 0.5, 0, 180, 0.3, 0.5, 0, 280, 0.6, 0.5, 0]
        without = ffd.picture(self.view, "without points")
        points = simple.Show(simple.GroupDatasets(Input=[
            simple.Sphere(Radius=0.5, Center=[8.0 * (i % 3 - 1), 8.0 * (i // 3 % 3 - 1), 8.0 * (i // 9 - 1)])
            for i in range(27)]), self.view)
        points.ColorArrayName = [None, ""]
        points.AmbientColor = points.DiffuseColor = [0.9, 1.0, 0.9]
        fine = ffd.picture(self.view, "fine points")
        self.assertGreater(ffd.differ(fine, without)[0], 20)
        self.display.FFDImageSampleDistance = 4.0
        coarse = ffd.picture(self.view, "coarse points")
        self.assertLess((fine - coarse).max(), 50)

    def test_several_rays_a_pixel(self):
        """Still pictures have them whether or not the quality of moving ones adapts."""
        self.show(Shape="Twist")
        ffd.set_functions(opaque=True)
        pictures = {}
        for adapt in (0, 1):
            self.display.FFDAdaptInteractiveQuality = adapt
            for step in (1.0, 0.5):
                self.display.FFDImageSampleDistance = step
                pictures[adapt, step] = ffd.picture(self.view, "rays %d %g" % (adapt, step))
        self.assertGreater(ffd.differ(pictures[0, 0.5], pictures[0, 1.0])[1], 0.02)
        for step in (1.0, 0.5):
            self.assertEqual(ffd.differ(pictures[0, step], pictures[1, step])[0], 0)

    def test_translucent_things(self):
        """Axes grids and translucent surfaces, which the view draws by depth peeling, stand beside
        the volume; the view's setting stays."""
        self.show(Shape="Twist")
        ffd.set_functions(opaque=True)
        volume = ffd.picture(self.view, "volume")
        shown = volume.max(axis=2) > 12
        self.view.AxesGrid.Visibility = 1
        grid = ffd.picture(self.view, "grid")
        difference = np.abs(grid - volume).max(axis=2)
        self.assertLess((difference[shown] > 3).mean(), 0.1)
        # Lines and numbers around it.
        self.assertGreater(int((difference[~shown] > 40).sum()), 50)
        self.assertLess((difference[~shown] > 3).mean(), 0.3)
        self.view.AxesGrid.Visibility = 0
        ball = simple.Sphere(Radius=5.0, Center=[0.0, -28.0, 14.0])
        display = simple.Show(ball, self.view)
        display.ColorArrayName = [None, ""]
        # Samples begin at the near plane, which is at another place with the ball.
        opaque = ffd.picture(self.view, "opaque")
        display.Opacity = 0.5
        translucent = ffd.picture(self.view, "translucent")
        difference = np.abs(translucent - opaque).max(axis=2)
        self.assertEqual(difference[shown].max(), 0)
        self.assertGreater(int((difference > 40).sum()), 100)
        self.assertLess((difference > 3).mean(), 0.1)
        self.assertEqual(self.view.SMProxy.GetRenderer().GetUseDepthPeelingForVolumes(), True)
        # Nor does it go when the volume is not there.
        simple.Delete(self.lattice)
        simple.Render(self.view)
        self.assertEqual(self.view.SMProxy.GetRenderer().GetUseDepthPeelingForVolumes(), True)

    def test_smoothing_of_edges(self):
        """FXAA, which the view applies to what is drawn before volumes, is left out where that is nothing;
        the view's setting stays."""
        renderer = self.view.SMProxy.GetRenderer()
        used = []
        renderer.AddObserver("StartEvent", lambda *_: used.append(renderer.GetUseFXAA()), -1.0)
        self.view.Background = [0.4, 0.2, 0.6]
        self.show(Shape="Twist")

        def smoothed(name, is_used):
            self.view.UseFXAA = 1
            picture = ffd.picture(self.view, name)
            self.assertEqual(used[-1], is_used, name)
            self.assertTrue(renderer.GetUseFXAA(), name)
            return picture

        left_out = smoothed("volume not smoothed", False)
        # The same background, which is not known to be of one color.
        self.view.BackgroundColorMode = "Gradient"
        self.view.Background2 = list(self.view.Background)
        # Rasterizers may round it otherwise (Mesa 25: by 1 of 255).
        self.assertLessEqual(ffd.differ(smoothed("volume smoothed", True), left_out)[0], 1)
        self.view.BackgroundColorMode = "Single Color"
        # Whatever else is drawn is smoothed.
        outline = simple.Show(self.wavelet, self.view, "UniformGridRepresentation")
        outline.SetRepresentationType("Outline")
        lines = smoothed("lines smoothed", True)
        self.view.UseFXAA = 0
        self.assertGreater(ffd.differ(ffd.picture(self.view, "lines"), lines)[0], 20)
        outline.SetRepresentationType("Volume")
        smoothed("two volumes", False)
        outline.Visibility = 0
        self.view.AxesGrid.Visibility = 1
        smoothed("grid smoothed", True)
        self.view.AxesGrid.Visibility = 0
        self.view.CenterAxesVisibility = 1
        smoothed("center smoothed", True)
        self.view.CenterAxesVisibility = 0
        self.display.Visibility = 0
        smoothed("nothing", True)

    def test_state_file(self):
        picture = self.show(Shape="Twist", Strength=1.3, Resolution=[4, 4, 4],
                            Displacements=list(np.linspace(-2.0, 2.0, 192)))
        self.display.FFDShade = 1
        self.display.FFDSampleDistance = 0.7
        picture = ffd.picture(self.view, "state")
        state = os.path.join(ffd.TEMPORARY, "ParaView.state.pvsm")
        simple.SaveState(state)
        simple.ResetSession()
        ffd.load()
        simple.LoadState(state)
        view = simple.GetActiveViewOrCreate("RenderView")
        self.assertEqual(ffd.differ(ffd.picture(view, "restored"), picture)[0], 0)

    def test_python_state(self):
        self.show(Shape="Bend", Strength=0.8, Resolution=[4, 4, 4],
                  Displacements=list(np.linspace(-2.0, 2.0, 192)))
        self.display.FFDInverseMode = "First Order"
        self.display.FFDOpacityLength = "Material"
        picture = ffd.picture(self.view, "pystate")
        text = smstate.get_state()
        self.assertIn("FFDLattice(", text)
        simple.ResetSession()
        ffd.load()
        exec(compile(text, "state", "exec"), {"__name__": "state"})  # pylint: disable=exec-used
        view = simple.GetActiveViewOrCreate("RenderView")
        # Settings of the application, as this one, are not in a Python state.
        view.UseFXAA = 0
        largest, mean = ffd.differ(ffd.picture(view, "pyrestored"), picture)
        self.assertLessEqual(largest, 24)
        self.assertLess(mean, 0.05)

    def test_animation(self):
        """Strength and control points are keyframed; frames are saved."""
        self.show(Shape="Twist", Strength=0.0, Resolution=[4, 4, 4],
                  Displacements=[0.0, 0.0, 0.0] * 64)
        scene = simple.GetAnimationScene()
        scene.PlayMode = "Sequence"
        scene.NumberOfFrames = 3
        strength = simple.GetAnimationTrack("Strength", proxy=self.lattice)
        strength.KeyFrames = [simple.CompositeKeyFrame(KeyTime=0.0, KeyValues=[0.0]),
                              simple.CompositeKeyFrame(KeyTime=1.0, KeyValues=[2.0])]
        point = simple.GetAnimationTrack("Displacements", 3 * 42 + 2, self.lattice)
        point.KeyFrames = [simple.CompositeKeyFrame(KeyTime=0.0, KeyValues=[0.0]),
                           simple.CompositeKeyFrame(KeyTime=1.0, KeyValues=[25.0])]
        name = os.path.join(ffd.TEMPORARY, "ParaView.frame.png")
        simple.SaveAnimation(name, self.view, FrameWindow=[0, 2])
        frames = [ffd.read_picture(name.replace(".png", ".%04d.png" % i)) for i in range(3)]
        self.assertGreater(np.abs(frames[1] - frames[0]).mean(), 1.0)
        self.assertGreater(np.abs(frames[2] - frames[1]).mean(), 1.0)
        scene.GoToLast()
        self.assertAlmostEqual(self.lattice.Strength, 2.0)
        self.assertAlmostEqual(self.lattice.Displacements[3 * 42 + 2], 25.0)
        self.assertLess(ffd.differ(ffd.picture(self.view, "last"), frames[2])[1], 0.2)
        point.Enabled = 0
        self.lattice.Displacements = [0.0, 0.0, 0.0] * 64
        self.assertGreater(np.abs(ffd.picture(self.view, "nopoint") - frames[2]).mean(), 0.5)

    def test_file_with_lattice(self):
        """A .vti that was saved with its lattice is shown deformed."""
        deformed = self.show(Shape="Twist", Strength=1.5)
        name = os.path.join(ffd.TEMPORARY, "ParaView.lattice.vti")
        simple.SaveData(name, proxy=self.lattice)
        simple.Hide(self.lattice, self.view)
        reader = simple.XMLImageDataReader(FileName=[name])
        display = simple.Show(reader, self.view)
        display.SetRepresentationType("FFD Volume")
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "file"), deformed)[0], 6)
        # A second lattice starts from that of the file.
        simple.Hide(reader, self.view)
        more = simple.FFDLattice(Input=reader)
        simple.Show(more, self.view)
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "chained"), deformed)[0], 12)
        more.UseInputLattice = 0
        self.assertGreater(np.abs(ffd.picture(self.view, "fresh") - deformed).mean(), 2.0)

    def test_files_without_the_whole_lattice(self):
        """Formats that do not keep field data as they are: an error says so in the words of ParaView, of
        each block once."""
        self.show(Shape="Twist")
        simple.Hide(self.lattice, self.view)
        blocks = simple.GroupDatasets(Input=[self.lattice, simple.FFDLattice(
            Input=simple.Wavelet(WholeExtent=[15, 25, -15, 15, -15, 15]), Shape="Bend")])
        for ending, data, kind, count in (
                ("xmf", self.lattice, "FFD Volume", 1), ("xmf", self.lattice, "Surface", 1),
                ("e", simple.Clip(Input=self.lattice), "Surface", 1), ("xmf", blocks, "FFD Volume", 2)):
            name = os.path.join(ffd.TEMPORARY, "ParaView.partly." + ending)
            simple.SaveData(name, proxy=data)
            reader = simple.OpenDataFile(name)
            with ffd.Errors() as errors:
                display = simple.Show(reader, self.view)
                display.SetRepresentationType(kind)
                simple.Render(self.view)
                sliced = simple.Slice(Input=reader)
                simple.Show(sliced, self.view)
                simple.Render(self.view)
            simple.Delete(sliced)
            simple.Delete(reader)
            self.assertEqual(len(errors.text), count, errors.text)
            self.assertTrue(errors.say("at rest", "Exodus and Xdmf", ".vti"), errors.text)
            self.assertNotIn("AttachTo", errors.text[0])

    def test_comparative_view(self):
        """It starts with FFD Volume as other views do."""
        view = simple.CreateView("ComparativeRenderView")
        display = simple.Show(simple.FFDLattice(Input=ffd.make_wavelet(9)), view)
        self.assertEqual(display.Representation, "FFD Volume")

    def test_selection(self):
        """The volume is selected as ParaView's own is, unless it is not pickable."""
        before = self.show(Shape="Twist")
        ball = simple.Sphere(Radius=3.0, Center=[30.0, 18.0, 20.0])
        shown = simple.Show(ball, self.view)
        shown.ColorArrayName = [None, ""]
        behind = simple.Sphere(Radius=3.0, Center=[-20.0, 16.0, -12.0])
        simple.Show(behind, self.view)
        simple.Render(self.view)
        rectangle = [0, 0, 159, 139]

        def selected():
            return [source.SMProxy.GetSelectionInput(0) is not None
                    for source in (self.lattice, ball, behind)]

        # ParaView selects of one data set at a time.
        simple.SelectSurfacePoints(Rectangle=rectangle, View=self.view)
        self.assertEqual(selected(), [True, False, False])
        simple.ClearSelection(self.lattice)
        display = simple.GetDisplayProperties(self.lattice, self.view)
        display.Pickable = 0
        for select in (simple.SelectSurfacePoints, simple.SelectSurfaceCells):
            simple.Show(ball, self.view)
            for expected in ([False, True, False], [False, False, True]):
                select(Rectangle=rectangle, View=self.view)
                self.assertEqual(selected(), expected, select.__name__)
                for source in (self.lattice, ball, behind):
                    simple.ClearSelection(source)
                simple.Hide(ball, self.view)
        display.Pickable = 1
        for select in (simple.SelectPointsThrough, simple.SelectCellsThrough):
            select(Rectangle=rectangle, View=self.view)
            self.assertEqual(selected(), [True, False, False], select.__name__)
            simple.ClearSelection(self.lattice)
        simple.SelectSurfaceCells(Polygon=[5, 5, 150, 5, 80, 130], View=self.view)
        for source in (self.lattice, ball, behind):
            simple.ClearSelection(source)
        # Picking one thing, as a click does, on the volume and beside it.
        for x, y in ((80, 70), (2, 2)):
            self.view.SMProxy.Pick(x, y)
        simple.Hide(ball, self.view)
        simple.Hide(behind, self.view)
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "selection"), before)[0], 2)

    def test_transformed_before_the_first_frame(self):
        """Nothing is cut by planes of the camera that are those of another box."""
        for change in ({"Orientation": [0.0, 0.0, 45.0]}, {"Orientation": [0.0, 0.0, 180.0]},
                       {"Scale": [-1.0, 1.0, 1.0]}):
            with self.subTest(change):
                self.lattice = simple.FFDLattice(Input=self.wavelet)
                self.display = simple.Show(self.lattice, self.view)
                self.opacity = ffd.set_functions(opaque=True)
                for name, value in change.items():
                    setattr(self.display, name, value)
                first = ffd.picture(self.view, "first")
                self.assertGreater(ffd.lit(first), 1000)
                self.display.Position = [0.0, 0.0, 1.0]
                simple.Render(self.view)
                self.display.Position = [0.0, 0.0, 0.0]
                self.assertLess(ffd.differ(ffd.picture(self.view, "later"), first)[1], 0.1)
                simple.Delete(self.display)
                simple.Delete(self.lattice)

    def test_transform(self):
        """Place, rotation and scale of the representation: as if the camera had moved, and half as
        wide along y."""
        self.show(Shape="Twist")
        ffd.set_functions(opaque=True)
        before = ffd.picture(self.view, "untransformed")
        self.assertGreater(ffd.lit(before), 1000)
        x, y, z = self.view.CameraPosition
        ffd.translate(self.display, [5.0, 0.0, 6.0])
        self.assertGreater(np.abs(ffd.picture(self.view, "position") - before).mean(), 2.0)
        self.view.CameraPosition = [x + 5.0, y, z + 6.0]
        self.view.CameraFocalPoint = [5.0, 0.0, 6.0]
        self.assertLess(ffd.differ(ffd.picture(self.view, "followed"), before)[1], 0.05)
        # The clipping planes of the camera follow, too.
        ffd.translate(self.display, [0.0, 900.0, 0.0])
        self.view.CameraPosition = [x, y + 900.0, z]
        self.view.CameraFocalPoint = [0.0, 900.0, 0.0]
        self.assertLess(ffd.differ(ffd.picture(self.view, "far away"), before)[1], 0.05)
        near, far = self.view.GetActiveCamera().GetClippingRange()
        self.assertLess(far - near, 300.0)
        ffd.translate(self.display, [0.0, 0.0, 0.0])
        self.view.CameraFocalPoint = [0.0, 0.0, 0.0]
        self.display.Orientation = [0.0, 0.0, 90.0]
        self.view.CameraPosition = [-y, x, z]
        self.assertLess(ffd.differ(ffd.picture(self.view, "rotation"), before)[1], 0.45)
        self.display.Orientation = [0.0, 0.0, 0.0]
        self.view.CameraPosition = [100.0, 0.0, 0.0]
        self.view.CameraParallelProjection = 1
        self.view.CameraParallelScale = 30.0
        sizes = []
        for scale in ([1.0, 1.0, 1.0], [1.0, 0.5, 1.0]):
            self.display.Scale = scale
            seen = ffd.picture(self.view, "scale").max(axis=2) > 0
            sizes.append([np.ptp(np.nonzero(seen.any(axis=axis))[0]) + 1 for axis in (0, 1)])
        self.assertAlmostEqual(sizes[1][0], 0.5 * sizes[0][0], delta=2)
        self.assertAlmostEqual(sizes[1][1], sizes[0][1], delta=1)

    def test_volumes_behind_each_other_with_a_user_view_transform(self):
        """One that looks from the other side is like a camera there."""
        self.show()
        simple.Show(simple.FFDLattice(
            Input=self.wavelet, Resolution=[4, 4, 4], Displacements=[-35.0, -18.0, -24.0] * 64),
            self.view)
        simple.ResetCamera(self.view)
        camera = self.view.GetActiveCamera()
        around = vtkTransform()
        around.Translate(0.0, 0.0, -camera.GetDistance())
        around.RotateY(180.0)
        around.Translate(0.0, 0.0, camera.GetDistance())
        camera.SetUserViewTransform(around)
        pictures = [ffd.picture(self.view, "transformed").astype(int)]
        camera.SetUserViewTransform(None)
        camera.OrthogonalizeViewUp()
        camera.Azimuth(180.0)
        pictures.append(ffd.picture(self.view, "moved").astype(int))
        self.assertGreater(ffd.lit(pictures[0]), 1000)
        self.assertLess(np.abs(pictures[0] - pictures[1]).mean(), 0.3)

    def test_turned_blocks(self):
        """Blocks with direction matrices of their own are where ParaView's Volume shows them, not in all of
        the box around each, and take nothing from each other."""
        def cube(angle, x, y):
            source = simple.ProgrammableSource(OutputDataSetType="vtkImageData")
            source.ScriptRequestInformation = """
from paraview import util
util.SetOutputWholeExtent(self, [0, 15, 0, 15, 0, 15])
"""
            source.Script = """
import math
import numpy
c, s = math.cos(%g), math.sin(%g)
image = self.GetOutput()
image.SetDimensions(16, 16, 16)
image.SetOrigin(%g, %g, 0)
image.SetDirectionMatrix(c, -s, 0, s, c, 0, 0, 0, 1)
output.PointData.append(numpy.full(4096, %g), "RTData")
""" % (angle, angle, x, y, 100.0 + 2.0 * x)
            return source

        group = simple.GroupDatasets(Input=[cube(0.5, 0.0, 0.0), cube(-0.4, 11.0, -6.0)])
        display = simple.Show(group, self.view)
        simple.ColorBy(display, ("POINTS", "RTData"))
        simple.GetColorTransferFunction("RTData").RGBPoints = [90, 1, 0, 0, 110, 1, 0, 0, 111, 0, 1, 0,
                                                               130, 0, 1, 0]
        simple.GetOpacityTransferFunction("RTData").Points = [0, 1, 0.5, 0, 200, 1, 0.5, 0]
        self.view.CameraPosition = [15.0, 5.0, 90.0]
        self.view.CameraFocalPoint = [15.0, 5.0, 8.0]
        self.view.CameraViewUp = [0.0, 1.0, 0.0]
        pictures = []
        for kind in ("Volume", "FFD Volume"):
            display.SetRepresentationType(kind)
            pictures.append(ffd.picture(self.view, "turned " + kind).astype(int))
        for channel in (0, 1):
            theirs, ours = (picture[..., channel] > 40 for picture in pictures)
            self.assertGreater(theirs.sum(), 1000)
            self.assertLess((theirs != ours).sum(), 0.12 * theirs.sum())

    def test_many_unlike_blocks(self):
        """Many small blocks of unlike voxels, as those of AMR, take little more time than few: not each that of
        the whole volume."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonDataModel import vtkImageData, vtkMultiBlockDataSet

        def show(count):
            blocks = vtkMultiBlockDataSet()
            for i in range(count):
                image = vtkImageData()
                image.SetDimensions(3, 3, 3)
                image.SetSpacing([0.5 if i % 2 else 0.7] * 3)
                # The first two are corners of the volume.
                image.SetOrigin([119.0 * i] * 3 if i < 2 else [7 * i % 79, 11 * i % 79, 13 * i % 79])
                array = numpy_to_vtk(np.full(27, i % 10, np.float32), deep=True)
                array.SetName("values")
                image.GetPointData().SetScalars(array)
                blocks.SetBlock(i, image)
            source = simple.TrivialProducer()
            source.GetClientSideObject().SetOutput(blocks)
            source.UpdatePipeline()
            display = simple.Show(source, self.view)
            simple.ColorBy(display, ("POINTS", "values"))
            began = time.process_time()
            display.SetRepresentationType("FFD Volume")
            simple.ResetCamera(self.view)
            simple.Render(self.view)
            spent = time.process_time() - began
            simple.Hide(source, self.view)
            return spent

        show(8)
        few, many = show(50), show(1500)
        self.assertLess(many, 8.0 * few, (few, many))

    def test_sample_distance_is_of_the_data(self):
        """A scaled volume is sampled at the same voxels: seen from as much farther away it is the
        same picture."""
        self.show(Shape="Twist")
        ffd.set_functions(opaque=True)
        before = ffd.picture(self.view, "unscaled")
        position = list(self.view.CameraPosition)
        for scale in (10.0, 0.1):
            self.display.Scale = [scale] * 3
            self.view.CameraPosition = [scale * x for x in position]
            scaled = ffd.picture(self.view, "scaled")
            # But for where on the rays, from the near plane on, the samples begin.
            self.assertLess(ffd.differ(scaled, before)[1], 0.45, scale)
            volumes = self.view.SMProxy.GetRenderer().GetVolumes()
            mapper = str(volumes.GetItemAsObject(0).GetMapper())
            self.assertIn(" SampleDistance: 1\n", mapper, scale)


class TestWrongInput(unittest.TestCase):
    """ParaView's usual errors, and no crash."""

    def setUp(self):
        simple.ResetSession()
        ffd.load()
        self.view = ffd.make_view()

    def test_nothing_is_left_of_data_that_went(self):
        """Not the outline either, where the input becomes empty or flat."""
        subset = simple.ExtractSubset(Input=ffd.make_wavelet(10), VOI=[-10, 10] * 3)
        display = simple.Show(subset, self.view)
        simple.ColorBy(display, ("POINTS", "RTData"))
        display.SetRepresentationType("FFD Volume")
        ffd.set_functions()
        before = ffd.picture(self.view, "whole")
        self.assertGreater(ffd.lit(before), 1000)
        for extent in ([5, -5, -10, 10, -10, 10], [0, 0, -10, 10, -10, 10]):
            subset.VOI = extent
            with ffd.Errors():
                self.assertEqual(ffd.lit(ffd.picture(self.view, "gone")), 0, extent)
            subset.VOI = [-10, 10] * 3
            self.assertLess(ffd.differ(ffd.picture(self.view, "back again"), before)[1], 0.01)

    def test_lattice_refuses_other_data(self):
        unstructured = simple.Tetrahedralize(Input=simple.Wavelet(
            WholeExtent=[-3, 3, -3, 3, -3, 3]))
        table = simple.ProgrammableSource(OutputDataSetType="vtkTable", Script="pass")
        for wrong in (simple.Sphere(), unstructured, table):
            with ffd.Errors() as errors:
                lattice = simple.FFDLattice(Input=wrong)
                lattice.UpdatePipeline()
            self.assertTrue(errors.say("vtkImageData"), errors.text)
            simple.Delete(lattice)

    def test_rectilinear(self):
        grid = simple.ProgrammableSource(
            OutputDataSetType="vtkRectilinearGrid",
            Script="""
from paraview import vtk
import numpy as np
from paraview.vtk.util.numpy_support import numpy_to_vtk
output.SetDimensions(5, 5, 5)
for name in 'XYZ':
    a = vtk.vtkDoubleArray()
    for i in range(5): a.InsertNextValue(i * i)
    getattr(output, 'Set%sCoordinates' % name)(a)
s = vtk.vtkDoubleArray(); s.SetName('s'); s.SetNumberOfTuples(125); s.Fill(1.0)
output.GetPointData().AddArray(s)
""",
            ScriptRequestInformation="""
executive = self.GetExecutive()
executive.GetOutputInformation(0).Set(executive.WHOLE_EXTENT(), 0, 4, 0, 4, 0, 4)
""")
        lattice = simple.FFDLattice(Input=grid, Resolution=[4, 4, 4], Displacements=[0.0, 0.0, 5.0] * 64)
        display = simple.Show(lattice, self.view)
        self.assertEqual(display.Representation, "FFD Volume")
        simple.ColorBy(display, ("POINTS", "s"))
        simple.GetOpacityTransferFunction("s").Points = [0, 1, 0.5, 0, 2, 1, 0.5, 0]
        self.assertGreater(ffd.lit(ffd.picture(self.view, "rectilinear")), 500)
        np.testing.assert_allclose(self.view.SMProxy.GetRenderer().ComputeVisiblePropBounds(),
                                   [0, 16, 0, 16, 5, 21], atol=0.1)

    def test_lattice_per_block(self):
        """Surfaces are moved by the lattices of their blocks, and FFD Volume shows each with its own."""
        wavelet = simple.Wavelet(WholeExtent=[-10, 10, -10, 10, -10, 10])
        blocks = simple.GroupDatasets(Input=[
            simple.ExtractSubset(Input=wavelet, VOI=[*x, -10, 10, -10, 10]) for x in ((-10, 0), (0, 10))])
        lattice = simple.FFDLattice(Input=blocks, Shape="Bend")
        display = simple.Show(lattice, self.view)
        display.SetRepresentationType("Surface")
        pictures = [ffd.picture(self.view, "one lattice")]
        lattice.LatticePerBlock = 1
        pictures.append(ffd.picture(self.view, "lattice per block"))
        self.assertGreater(ffd.differ(*pictures)[1], 2.0)
        display.SetRepresentationType("FFD Volume")
        simple.ColorBy(display, ("POINTS", "RTData"))
        ffd.set_functions()

        def bounds():
            simple.Render(self.view)
            return np.array(self.view.SMProxy.GetRenderer().ComputeVisiblePropBounds())

        each = ffd.picture(self.view, "volume per block")
        moved = bounds()
        # Options and the box of cropping, which is one over all blocks, hold for all of them.
        for name, value, default in (
                ("FFDShade", 1, 0), ("FFDBlendMode", 1, 0), ("FFDSampleDistance", 8.0, 1.0),
                ("FFDUseCropping", 1, 0), ("Scale", [0.5] * 3, [1.0] * 3)):
            setattr(display, name, value)
            if name == "FFDUseCropping":
                display.FFDCroppingScale = [1.0, 0.5, 0.5]
            picture = ffd.picture(self.view, "per block " + name)
            for half in (picture[:, :75] - each[:, :75], picture[:, 85:] - each[:, 85:]):
                self.assertGreater(np.abs(half).mean(), 0.1, name)
            setattr(display, name, default)
        np.testing.assert_array_equal(ffd.picture(self.view, "per block again"), each)
        self.assertEqual(bounds().tolist(), moved.tolist())
        # Blocks that are no longer there, and a representation that is hidden, leave nothing behind.
        simple.Hide(lattice, self.view)
        self.assertEqual(ffd.lit(ffd.picture(self.view, "per block hidden")), 0)
        simple.Show(lattice, self.view)
        np.testing.assert_array_equal(ffd.picture(self.view, "per block shown"), each)
        lattice.LatticePerBlock = 0
        self.assertGreater(ffd.lit(ffd.picture(self.view, "volume of blocks")), 1000)

    def test_blocks_without_the_array(self):
        """Blocks that lack the array are not shown, whichever they are; nothing complains."""
        def make_block(half, name):
            named = simple.Calculator(Input=ffd.make_wavelet(half), ResultArrayName=name, Function="RTData")
            return simple.PassArrays(Input=named, PointDataArrays=[name])

        blocks = [make_block(8, "A"), make_block(12, "B")]
        for name in "AB":
            simple.GetColorTransferFunction(name).RescaleTransferFunction(37.0, 280.0)
            simple.GetOpacityTransferFunction(name).RescaleTransferFunction(37.0, 280.0)
        lattice = simple.FFDLattice(Input=simple.GroupDatasets(Input=blocks), Shape="Twist", LatticePerBlock=1)
        display = simple.Show(lattice, self.view)
        with ffd.Errors() as errors:
            pictures = []
            for name in "ABA":
                simple.ColorBy(display, ("POINTS", name))
                pictures.append(ffd.picture(self.view, "block " + name))
        self.assertEqual(errors.text, [])
        self.assertGreater(ffd.lit(pictures[0]), 200)
        self.assertGreater(ffd.lit(pictures[1]), 1.5 * ffd.lit(pictures[0]))
        self.assertEqual(ffd.differ(pictures[2], pictures[0])[0], 0)

    def test_flat_image(self):
        wavelet = simple.Wavelet(WholeExtent=[-10, 10, -10, 10, 0, 0])
        lattice = simple.FFDLattice(Input=wavelet, Shape="Bend")
        display = simple.Show(lattice, self.view)
        with ffd.Errors() as errors:
            display.SetRepresentationType("FFD Volume")
            picture = ffd.picture(self.view, "flat")
        self.assertEqual(ffd.lit(picture), 0)
        self.assertTrue(errors.say("FFD Volume", "21 x 21 x 1"), errors.text)

    def test_geometry_that_cannot_be_rendered(self):
        """The mapper's words, once for each change."""
        def coordinates(numbers):
            return """
for axis in "XYZ":
    a = vtk.vtkDoubleArray()
    for x in (%s): a.InsertNextValue(float(x))
    getattr(output, "Set%%sCoordinates" %% axis)(a)
""" % numbers

        image, grid = "vtkImageData", "vtkRectilinearGrid"
        for kind, good, wrong, word in (
                (grid, coordinates("0, 1, 3, 4"), coordinates("0, 1, 1, 4"), "do not rise"),
                (grid, coordinates("0, 1, 3, 4"), coordinates("4, 3, 1, 0"), "do not rise"),
                (grid, coordinates("0, 1, 3, 4"), coordinates("0, 'nan', 3, 4"), "coordinates"),
                (image, "", "output.SetSpacing(1, 0, 1)", "spacing"),
                (image, "", "output.SetSpacing(1, float('nan'), 1)", "spacing"),
                (image, "", "output.SetOrigin(float('nan'), 0, 0)", "origin"),
                (image, "", "output.SetSpacing(1e30, 1e30, 1e30)", "cannot be rendered"),
                (image, "", "output.SetSpacing(1e-30, 1e-30, 1e-30)", "cannot be rendered")):
            sources = [ffd.make_source(kind, [0, 3] * 3, script) for script in (good, wrong)]
            data = simple.PassArrays(Input=sources[0], PointDataArrays=["RTData"])
            display = simple.Show(data, self.view)
            display.SetRepresentationType("FFD Volume")
            simple.ColorBy(display, ("POINTS", "RTData"))
            ffd.set_functions()
            self.view.CameraPosition = [8.0, 9.0, 10.0]
            before = ffd.picture(self.view, "right geometry")
            self.assertGreater(ffd.lit(before), 300)
            for _ in range(2):
                data.Input = sources[1]
                with ffd.Errors() as errors:
                    for _ in range(3):
                        self.assertEqual(ffd.lit(ffd.picture(self.view, "wrong geometry")), 0)
                self.assertEqual(len(errors.text), 1, (wrong, errors.text))
                self.assertTrue(errors.say(word), errors.text)
                data.Input = sources[0]
                with ffd.Errors() as errors:
                    after = ffd.picture(self.view, "right geometry again")
                self.assertEqual(errors.text, [])
                self.assertLess(ffd.differ(after, before)[1], 0.01)
            # A lattice is not put over what has no place.
            if kind == image and "nan" in wrong:
                lattice = simple.FFDLattice(Input=sources[1])
                with ffd.Errors() as errors:
                    lattice.UpdatePipeline()
                self.assertTrue(errors.say("not finite", "without a lattice"), errors.text)
                simple.Delete(lattice)
            simple.Delete(data)

    def test_array_that_is_not_there(self):
        data = simple.PassArrays(Input=ffd.make_wavelet(8), PointDataArrays=["RTData"])
        for source in (data, simple.FFDLattice(Input=data, Shape="Bend")):
            display = simple.Show(source, self.view)
            display.SetRepresentationType("FFD Volume")
            simple.ColorBy(display, ("POINTS", "RTData"))
            ffd.set_functions()
            before = ffd.picture(self.view, "array")
            for wrong in ("missing", "RTData"):
                display.ColorArrayName = ["POINTS", wrong]
                data.PointDataArrays = ["RTData"] if wrong == "missing" else []
                with ffd.Errors() as errors:
                    for _ in range(3):
                        self.assertEqual(ffd.lit(ffd.picture(self.view, "missing array")), 0)
                self.assertEqual(len(errors.text), 1, errors.text)
                self.assertTrue(errors.say("FFD Volume", '"%s"' % wrong), errors.text)
                display.ColorArrayName = ["POINTS", "RTData"]
                data.PointDataArrays = ["RTData"]
                with ffd.Errors() as errors:
                    after = ffd.picture(self.view, "array again")
                self.assertEqual(errors.text, [])
                self.assertLess(ffd.differ(after, before)[1], 0.01)
            display.ColorArrayName = ["POINTS", ""]
            with ffd.Errors() as errors:
                ffd.picture(self.view, "no array")
            self.assertEqual(errors.text, [])
            simple.Hide(source, self.view)

    def test_not_a_number(self):
        """What is not a number is transparent; the rest is drawn as ever."""
        wavelet = simple.Wavelet(WholeExtent=[-10, 10, -10, 10, -10, 10])
        # Without a replacement the calculator makes no array, by itself it puts 0.
        calculator = simple.Calculator(
            Input=wavelet, ResultArrayName="some", ReplacementValue=float("nan"))
        lattice = simple.FFDLattice(Input=calculator, Shape="Bend")
        lits = []
        for function in ("sqrt(RTData - 150)^2 + 150", "RTData"):
            calculator.Function = function
            display = simple.Show(lattice, self.view)
            simple.ColorBy(display, ("POINTS", "some"))
            opacity = simple.GetOpacityTransferFunction("some")
            opacity.Points = [37, 0.5, 0.5, 0, 280, 0.5, 0.5, 0]
            with ffd.Errors():
                lits.append(ffd.lit(ffd.picture(self.view, "nan")))
        self.assertGreater(lits[0], 1000)
        self.assertLess(lits[0], 0.9 * lits[1])

    def test_bad_values(self):
        wavelet = simple.Wavelet(WholeExtent=[-10, 10, -10, 10, -10, 10])
        lattice = simple.FFDLattice(Input=wavelet, Resolution=[4, 4, 4])
        lattice.Displacements = [1.0, 2.0, 3.0]
        with ffd.Errors() as errors:
            lattice.UpdatePipeline()
        self.assertTrue(errors.say("1 displacements", "64", "DisplacementsResolution"), errors.text)
        with ffd.Errors() as errors:
            lattice.Displacements = [float("nan")] * 192
            lattice.UpdatePipeline()
        self.assertTrue(errors.say("must be finite"), errors.text)
        # A number too many is not left out without a word.
        lattice.Displacements = [1.0] * 192
        lattice.UpdatePipeline()
        for count in (1, 191, 193):
            with ffd.Errors() as errors:
                lattice.Displacements = [2.0] * count
                lattice.UpdatePipeline()
            self.assertTrue(errors.say("Displacements", "%d numbers" % count), errors.text)
        # What no lattice can hold has nothing to do with files.
        lattice.Displacements = []
        lattice.Shape = "Twist"
        display = simple.Show(lattice, self.view)
        display.SetRepresentationType("FFD Volume")
        simple.Render(self.view)
        with ffd.Errors() as errors:
            lattice.DisplacementScale = 1e300
            simple.Render(self.view)
        self.assertTrue(errors.say("at rest", "exceeds 1e100"), errors.text)
        self.assertFalse(errors.say("Exodus"), errors.text)

    def test_hostile_values(self):
        """Every number of ours can be set to anything: no crash, and with the value of before the
        picture is that of before."""
        wavelet = simple.Wavelet(WholeExtent=[-8, 8] * 3)
        lattice = simple.FFDLattice(Input=wavelet, Shape="Twist", Resolution=[4, 4, 4])
        lattice.Displacements = [0.1, 0.2, 0.3] * 64
        display = simple.Show(lattice, self.view)
        display.FFDUseCropping = 1
        ffd.set_functions()
        before = ffd.picture(self.view, "hostile")
        self.assertGreater(ffd.lit(before), 500)
        ours = ("Position", "Scale", "Orientation", "Origin", "Ambient", "Diffuse", "Specular",
                "SpecularPower")
        swept = self.sweep(lattice, before)
        swept += self.sweep(display, before,
                            lambda name: name.startswith("FFD") or name in ours)
        for name in ("Strength", "Displacements", "FFDSampleDistance", "Scale"):
            self.assertIn(name, swept)

    def sweep(self, proxy, before, wanted=lambda name: True):
        """Set numbers to what they should not be, and back: the picture must be that of before."""
        swept = []
        # By their names, where Python has labels.
        iterator = proxy.SMProxy.NewPropertyIterator()
        iterator.Begin()
        names = []
        while not iterator.IsAtEnd():
            names.append(iterator.GetKey())
            iterator.Next()
        for name in names:
            smproperty = proxy.SMProxy.GetProperty(name)
            if smproperty.GetInformationOnly() or not wanted(name) or (
                    not smproperty.GetClassName() in (
                        "vtkSMDoubleVectorProperty", "vtkSMIntVectorProperty")):
                continue
            values = [smproperty.GetElement(i) for i in range(smproperty.GetNumberOfElements())]
            if not values:
                continue
            hostile = (0, -1, -(2 ** 31), 2 ** 31 - 1)
            if smproperty.GetClassName() == "vtkSMDoubleVectorProperty":
                hostile = (0.0, -1.0, 1e-300, 1e300, -1e300, float("inf"), float("-inf"),
                           float("nan"))
            swept.append(name)
            with ffd.Errors():
                for value in hostile:
                    for i in range(len(values)):
                        smproperty.SetElement(i, value)
                    proxy.SMProxy.UpdateVTKObjects()
                    simple.Render(self.view)
            for i, value in enumerate(values):
                smproperty.SetElement(i, value)
            proxy.SMProxy.UpdateVTKObjects()
            # But for where the near plane is, from which samples are counted.
            largest, mean = ffd.differ(ffd.picture(self.view, "hostile"), before)
            self.assertLessEqual(largest, 12, name)
            self.assertLess(mean, 0.2, name)
        return swept

    def test_hostile_values_of_filters(self):
        wavelet = simple.Wavelet(WholeExtent=[-8, 8] * 3)
        lattice = simple.FFDLattice(Input=wavelet, Shape="Twist", Resolution=[4, 4, 4])
        ffd.set_functions()
        for make, expected in (
                (lambda: simple.FFDResampleToImage(
                    Input=lattice, Scalars=["POINTS", "RTData"]),
                 {"InverseMode", "Interpolation", "BackgroundLevel"}),
                (lambda: simple.FFDDeformGeometry(
                    Input=simple.Sphere(Radius=6.0), Lattice=lattice),
                 {"InverseMode", "TransformAllInputVectors", "PassRestPositions"})):
            filtered = make()
            simple.Show(filtered, self.view)
            before = ffd.picture(self.view, "hostile")
            self.assertGreater(ffd.lit(before), 300)
            self.assertEqual(set(self.sweep(filtered, before)), expected)
            simple.Hide(filtered, self.view)

    def test_hostile_values_of_the_widget(self):
        """The proxy that the panel drags control points with."""
        manager = servermanager.ProxyManager()
        widget = servermanager._getPyProxy(
            manager.NewProxy("representations", "FFDLatticeWidgetRepresentation"))
        widget.Enabled = 1
        widget.Domain = [-8.0, 8.0] * 3
        widget.OutlineBounds = [-8.0, 8.0] * 3
        widget.Dimensions = [4, 4, 4]
        widget.BaseDimensions = [4, 4, 4]
        widget.BaseDisplacements = [0.5, 0.0, 0.0] * 64
        widget.EditDimensions = [4, 4, 4]
        widget.Displacements = [0.0, 1.0, 0.0] * 64
        widget.Selection = [5.0]
        widget.UpdateVTKObjects()
        self.view.SMProxy.GetProperty("HiddenRepresentations").AddProxy(widget.SMProxy)
        self.view.SMProxy.UpdateVTKObjects()
        before = ffd.picture(self.view, "hostile")
        self.assertGreater(ffd.lit(before), 500)
        swept = self.sweep(widget, before)
        for name in ("Domain", "Dimensions", "OutlineBounds", "Displacements", "Selection",
                     "ProportionalRadius", "Falloff", "Symmetry", "Enabled"):
            self.assertIn(name, swept)
        self.view.SMProxy.GetProperty("HiddenRepresentations").RemoveProxy(widget.SMProxy)


if __name__ == "__main__":
    unittest.main()
