#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What ParaView's own Volume can do, against that volume, where nothing is deformed: opacity of another
array, several components, colors as they are, two-dimensional functions, several volumes; and what
ParaView makes of views: files of pictures, animations and scenes."""

import os
import unittest

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdparaview as ffd

ffd.load()

ARRAYS = """
import numpy as np
from paraview.vtk.util.numpy_support import numpy_to_vtk
half = 15
executive = self.GetExecutive()
output.SetExtent(-half, half, -half, half, -half, half)
axis = np.linspace(-1.0, 1.0, 2 * half + 1)
z, y, x = np.meshgrid(axis, axis, axis, indexing='ij')
ball = 1.0 - np.sqrt(x * x + y * y + z * z)
def add(name, *parts, scale=1.0):
    values = np.stack([np.broadcast_to(part, x.shape).ravel() for part in parts], axis=1)
    kind = np.uint8 if scale > 1.0 else np.float32
    array = numpy_to_vtk((scale * values).astype(kind), deep=True)
    array.SetName(name)
    output.GetPointData().AddArray(array)
add('slope', 0.5 + 0.5 * x)
add('ball', np.clip(ball, 0.0, 1.0))
add('vectors', x, y, z)
add('two', 0.5 + 0.5 * x, np.clip(ball, 0.0, 1.0))
add('rgba', 0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.5 + 0.5 * z, np.clip(ball, 0.0, 0.3), scale=255.0)
"""

INFORMATION = """
executive = self.GetExecutive()
executive.GetOutputInformation(0).Set(executive.WHOLE_EXTENT(), -15, 15, -15, 15, -15, 15)
"""


def make_arrays():
    return simple.ProgrammableSource(
        OutputDataSetType="vtkImageData", Script=ARRAYS, ScriptRequestInformation=INFORMATION)


class TestAsVolume(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        ffd.load()
        self.view = ffd.make_view()

    def set_functions(self, name):
        simple.GetColorTransferFunction(name).RescaleTransferFunction(0.0, 1.0)
        opacity = simple.GetOpacityTransferFunction(name)
        opacity.Points = [0, 0, 0.5, 0, 0.2, 0, 0.5, 0, 0.7, 0.4, 0.5, 0, 1, 0.6, 0.5, 0]

    def compare(self, display, name, least=0.93):
        """Pictures of the two volumes that ParaView has now. They look alike; how bright translucent
        things are depends on the distances between samples, which are not the same."""
        pictures = []
        for kind in ("Volume", "FFD Volume"):
            display.SetRepresentationType(kind)
            pictures.append(ffd.picture(self.view, "as volume %s %s" % (name, kind)))
        self.assertGreater(ffd.lit(pictures[0]), 1000)
        alike = np.corrcoef(pictures[0].ravel(), pictures[1].ravel())[0, 1]
        self.assertGreater(alike, least, name)
        return pictures[1]

    def show(self, array):
        source = make_arrays()
        display = simple.Show(source, self.view)
        display.SetRepresentationType("FFD Volume")
        simple.ColorBy(display, ("POINTS", array))
        self.set_functions(array)
        return display

    def test_opacity_array(self):
        display = self.show("slope")
        plain = self.compare(display, "plain")
        display.OpacityArrayName = ["POINTS", "ball"]
        display.UseSeparateOpacityArray = 1
        self.assertEqual(display.FFDUseSeparateOpacityArray, 1)
        self.assertEqual(list(display.FFDOpacityArrayName), ["POINTS", "ball"])
        separate = self.compare(display, "separate")
        # Nothing at the corners of the picture's volume, which are outside of the ball.
        self.assertLess(ffd.lit(separate), 0.8 * ffd.lit(plain))
        # By the names in the group of FFD Volume.
        display.FFDUseSeparateOpacityArray = 0
        self.assertEqual(display.UseSeparateOpacityArray, 0)
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "again"), plain)[0], 1)
        display.FFDOpacityArrayName = ["POINTS", "vectors"]
        display.FFDUseSeparateOpacityArray = 1
        first = ffd.picture(self.view, "opacity component")
        display.FFDOpacityComponent = 2
        self.assertGreater(np.abs(ffd.picture(self.view, "another") - first).mean(), 1.0)

    def test_two_components(self):
        display = self.show("two")
        alone = ffd.picture(self.view, "one component")
        display.MultiComponentsMapping = 1
        both = self.compare(display, "two components")
        self.assertGreater(np.abs(both - alone).mean(), 2.0)
        # By the name in the group of FFD Volume: the panel shows ParaView's for its own Volume alone.
        self.assertEqual(display.FFDMultiComponentsMapping, 1)
        display.FFDMultiComponentsMapping = 0
        self.assertEqual(display.MultiComponentsMapping, 0)
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "one again"), alone)[0], 1)

    def test_colors_as_they_are(self):
        display = self.show("rgba")
        simple.GetOpacityTransferFunction("rgba").Points = [0, 0, 0.5, 0, 255, 1, 0.5, 0]
        mapped = ffd.picture(self.view, "mapped")
        display.MapScalars = 0
        direct = self.compare(display, "direct")
        self.assertGreater(np.abs(direct - mapped).mean(), 2.0)
        # All three colors somewhere.
        for channel in range(3):
            others = [c for c in range(3) if c != channel]
            self.assertGreater((direct[:, :, channel] - direct[:, :, others].max(axis=2)).max(), 40)

    def test_plane(self):
        """Two-dimensional functions, on the gradient and on another array."""
        display = self.show("ball")
        line = ffd.picture(self.view, "line")
        plane = simple.GetTransferFunction2D("ball")
        plane.RescaleTransferFunction(0.0, 1.0, 0.0, 1.0)
        plane.Boxes = [0.3, 0.0, 0.5, 0.5, 1.0, 0.2, 0.1, 0.8]
        display.TransferFunction2D = plane
        display.UseTransfer2D = 1
        self.assertEqual(display.FFDUseTransfer2D, 1)
        gradient = self.compare(display, "gradient")
        self.assertGreater(np.abs(gradient - line).mean(), 2.0)
        display.ColorArray2Name = ["POINTS", "slope"]
        display.UseGradientForTransfer2D = 0
        array = self.compare(display, "array", least=0.8)
        self.assertGreater(np.abs(array - gradient).mean(), 1.0)
        display.UseGradientForTransfer2D = 1
        # As opaque as ParaView's volume, whatever the distance of the samples and the unit distance is.
        plane.Boxes = [0.3, 0.0, 0.5, 0.5, 1.0, 0.2, 0.1, 0.2]
        for shade in (0, 1):
            display.FFDShade = shade
            display.SetRepresentationType("Volume")
            own = ffd.picture(self.view, "plane of Volume")
            display.SetRepresentationType("FFD Volume")
            for distance, unit in ((1.0, 3.0 ** 0.5), (0.25, 3.0 ** 0.5), (1.0, 0.3)):
                display.FFDSampleDistance = distance
                display.FFDScalarOpacityUnitDistance = unit
                ours = ffd.picture(self.view, "plane %g %g" % (distance, unit))
                self.assertLess(np.abs(ours - own).mean(), 0.5, (shade, distance, unit))
                # VTK's mapper does not cut lit colors of such functions at white, as it does others.
                most = 32 if shade else 24
                self.assertLess(ffd.differ(ours, own)[0], most, (shade, distance, unit))
        display.FFDShade = 0
        display.FFDSampleDistance = 1.0
        # Between the texels of ParaView's table, 10 x 10, the function is that of its volume.
        plane.Boxes = [0.4, 0.0, 0.2, 1.0, 0.6, 0.6, 0.6, 0.3]
        ours = ffd.picture(self.view, "narrow box")
        display.SetRepresentationType("Volume")
        own = ffd.picture(self.view, "narrow box of Volume")
        display.SetRepresentationType("FFD Volume")
        self.assertLess(ffd.differ(ours, own)[1], 0.2)
        self.assertLessEqual(ffd.differ(ours, own)[0], 8)
        # Edits of the function are shown.
        plane.Boxes = [0.3, 0.0, 0.5, 0.5, 1.0, 0.2, 0.1, 0.8]
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "gradient again"), gradient)[0], 1)
        # The unit distance is that of one-dimensional functions again.
        display.FFDUseTransfer2D = 0
        self.assertGreater(ffd.differ(ffd.picture(self.view, "line of unit 0.3"), line)[1], 1.0)
        display.FFDScalarOpacityUnitDistance = 3.0 ** 0.5
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "line again"), line)[0], 1)

    def test_deformed(self):
        """All of it on a deformed volume: it moves, as its surface does."""
        display = self.show("slope")
        simple.Hide(simple.GetActiveSource(), self.view)
        lattice = simple.FFDLattice(
            Input=simple.GetActiveSource(), Resolution=[4, 4, 4],
            Displacements=[0.0, 0.0, 9.0] * 64)
        display = simple.Show(lattice, self.view)
        display.SetRepresentationType("FFD Volume")
        simple.ColorBy(display, ("POINTS", "slope"))
        display.OpacityArrayName = ["POINTS", "ball"]
        display.UseSeparateOpacityArray = 1
        moved = ffd.picture(self.view, "moved opacity")
        lattice.DisplacementScale = 0.0
        self.view.CameraPosition = [75.0, 45.0, 51.0]
        self.view.CameraFocalPoint = [0.0, 0.0, -9.0]
        # But for where on the rays the samples begin.
        self.assertLess(ffd.differ(ffd.picture(self.view, "moved camera"), moved)[1], 0.45)

    def test_several_volumes(self):
        """Side by side, and one before the other."""
        pictures = {}
        wavelet = ffd.make_wavelet(10)
        lattices = [simple.FFDLattice(
            Input=wavelet, Resolution=[4, 4, 4], Displacements=[x, y, 0.0] * 64)
            for x, y in ((9.0, -15.0), (-9.0, 15.0))]
        for shown in (0, 1, 2):
            for n, lattice in enumerate(lattices):
                if shown in (n, 2):
                    simple.Show(lattice, self.view)
                else:
                    simple.Hide(lattice, self.view)
            ffd.set_functions()
            pictures[shown] = ffd.picture(self.view, "volume %d" % shown)
        beside = np.maximum(pictures[0], pictures[1])
        for n in (0, 1):
            self.assertGreater(ffd.lit(pictures[n]), 300)
        overlap = (pictures[0].max(axis=2) > 0) & (pictures[1].max(axis=2) > 0)
        # But for where on the rays, from the near plane on, the samples begin.
        self.assertLess(np.abs(pictures[2] - beside)[~overlap].mean(), 0.2)
        # In line, the nearer one hides the other, whichever was shown first.
        ffd.set_functions(opaque=True)
        for near in (0, 1):
            for n, lattice in enumerate(lattices):
                sign = 1 if n == near else -1
                lattice.Displacements = [15.0 * sign, 9.0 * sign, 12.0 * sign] * 64
                simple.Show(lattice, self.view)
            both = ffd.picture(self.view, "in line")
            simple.Hide(lattices[1 - near], self.view)
            alone = ffd.picture(self.view, "near one")
            middle = both.shape[0] // 2, both.shape[1] // 2
            self.assertLessEqual(np.abs(both[middle] - alone[middle]).max(), 4)


class TestFiles(unittest.TestCase):
    """What ParaView saves of a view."""

    def setUp(self):
        simple.ResetSession()
        ffd.load()
        self.view = ffd.make_view()
        self.lattice = simple.FFDLattice(Input=ffd.make_wavelet(), Shape="Twist")
        self.display = simple.Show(self.lattice, self.view)
        ffd.set_functions()
        self.picture = ffd.picture(self.view, "to be saved")

    def test_screenshot_of_another_size(self):
        """Larger, by tiles that ParaView puts together, and on a transparent background."""
        path = os.path.join(ffd.TEMPORARY, "ParaView.large.png")
        simple.SaveScreenshot(path, self.view, ImageResolution=[320, 280])
        large = ffd.read_picture(path)
        self.assertEqual(large.shape, (280, 320, 3))
        smaller = large.reshape(140, 2, 160, 2, 3).mean(axis=(1, 3))
        self.assertLess(np.abs(smaller - self.picture).mean(), 1.5)
        simple.SaveScreenshot(path, self.view, TransparentBackground=1)
        self.assertLess(ffd.differ(ffd.read_picture(path), self.picture)[1], 40)
        self.assertLessEqual(ffd.differ(ffd.picture(self.view, "after"), self.picture)[0], 1)

    def test_animation(self):
        scene = simple.GetAnimationScene()
        scene.PlayMode = "Sequence"
        scene.NumberOfFrames = 3
        track = simple.GetAnimationTrack("Strength", proxy=self.lattice)
        from paraview.simple import CompositeKeyFrame
        track.KeyFrames = [CompositeKeyFrame(KeyTime=0.0, KeyValues=[0.0]),
                           CompositeKeyFrame(KeyTime=1.0, KeyValues=[1.0])]
        path = os.path.join(ffd.TEMPORARY, "ParaView.film.png")
        simple.SaveAnimation(path, self.view, ImageResolution=[160, 140], FrameWindow=[0, 2])
        frames = [ffd.read_picture(path.replace(".png", ".%04d.png" % n)) for n in range(3)]
        self.assertLess(ffd.differ(frames[2], self.picture)[1], 0.3)
        for a, b in ((0, 1), (1, 2)):
            self.assertGreater(np.abs(frames[a] - frames[b]).mean(), 0.5)

    def test_animation_cache(self):
        """With ParaView's cache of geometry each step of two deformed volumes is made once, and shown right
        from then on; what is kept does not grow with the number of loops."""
        simple.Hide(self.lattice, self.view)
        lattices = []
        for half, shape, place in ((12, "Twist", 17.0), (9, "Bend", -17.0)):
            moved = simple.FFDLattice(Input=ffd.make_wavelet(half), Resolution=[4, 4, 4],
                                      Displacements=[place, -1.4 * place, 0.0] * 64)
            lattices.append(simple.FFDLattice(Input=moved, Shape=shape, Strength=0.0))
            simple.Show(lattices[-1], self.view)
        ffd.set_functions()
        scene = simple.GetAnimationScene()
        scene.PlayMode = "Sequence"
        steps = 5
        scene.NumberOfFrames = steps
        scene.StartTime, scene.EndTime = 0.0, 1.0
        for lattice in lattices:
            track = simple.GetAnimationTrack("Strength", proxy=lattice)
            track.KeyFrames = [simple.CompositeKeyFrame(KeyTime=0.0, KeyValues=[0.0]),
                               simple.CompositeKeyFrame(KeyTime=1.0, KeyValues=[1.0])]
        updates = [0]
        lattices[0].SMProxy.AddObserver(
            "UpdateDataEvent", lambda *_: updates.__setitem__(0, updates[0] + 1))

        def play(name):
            pictures = []
            for step in range(steps):
                scene.AnimationTime = step / (steps - 1)
                pictures.append(ffd.picture(self.view, name))
            return pictures

        def memory():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        settings = simple.GetSettingsProxy("GeneralSettings")
        before = settings.CacheGeometryForAnimation
        try:
            # On first: what is made without a cache is kept as that of the first time.
            settings.CacheGeometryForAnimation = 1
            play("cached")
            self.assertEqual(updates[0], steps - 1)  # it was at the first one already
            cached = [play("cached again") for _ in range(2)]
            used = memory()
            for _ in range(20):
                play("cached loops")
            self.assertEqual(updates[0], steps - 1)
            self.assertLess(memory() - used, 5e6)
            settings.CacheGeometryForAnimation = 0
            expected = play("not cached")
            for a, b in zip(expected, expected[1:]):
                self.assertGreater(np.abs(a - b).mean(), 0.5)
            for loop in cached:
                for step in range(steps):
                    # But for where on the rays, from the near plane on, the samples begin.
                    self.assertLess(ffd.differ(loop[step], expected[step])[1], 0.05, step)
        finally:
            settings.CacheGeometryForAnimation = before

    def test_scene(self):
        """Surfaces are exported as they are shown; that the volume is not in the file is said."""
        contour = simple.Contour(
            Input=self.lattice, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
        simple.Show(contour, self.view)
        simple.Render(self.view)
        shown = contour.GetDataInformation().GetBounds()
        for kind in ("vtp", "x3d", "gltf"):
            path = os.path.join(ffd.TEMPORARY, "ParaView.scene." + kind)
            for volume in (True, False):
                (simple.Show if volume else simple.Hide)(self.lattice, self.view)
                with ffd.Errors(event="WarningEvent") as warnings:
                    simple.ExportView(path, self.view)
                self.assertEqual(
                    warnings.say("FFD Volume", "not in the exported scene"), volume, warnings.text)
            self.assertGreater(os.path.getsize(path), 1000, kind)
        reader = simple.XMLPolyDataReader(
            FileName=[os.path.join(ffd.TEMPORARY, "ParaView.scene.vtp")])
        reader.UpdatePipeline()
        moved = simple.FFDDeformGeometry(Input=contour)
        moved.UpdatePipeline()
        exported = reader.GetDataInformation().GetBounds()
        np.testing.assert_allclose(exported, moved.GetDataInformation().GetBounds(), atol=1e-3)
        self.assertGreater(np.abs(np.array(exported) - shown).max(), 0.5)

    def test_drawings(self):
        """Files of drawings hold a picture of the volume, or it is said that they do not; those for the
        web hold the volume at rest, which is said."""
        simple.Show(self.lattice, self.view)
        simple.Render(self.view)
        for kind, mark in (("pdf", b"/Subtype /Image"), ("eps", b"colorimage"), ("svg", b"<image")):
            path = os.path.join(ffd.TEMPORARY, "ParaView.drawing." + kind)
            with ffd.Errors(event="WarningEvent") as warnings:
                simple.ExportView(path, self.view)
            with open(path, "rb") as file:
                holds = mark in file.read()
            self.assertTrue(holds or kind == "svg", kind)
            self.assertEqual(warnings.say("FFD Volume", "no pictures into SVG"), not holds, warnings.text)
            self.assertEqual(len(warnings.text), int(not holds), warnings.text)
        with ffd.Errors(event="WarningEvent") as warnings:
            simple.ExportView(os.path.join(ffd.TEMPORARY, "ParaView.web.vtkjs"), self.view)
        self.assertTrue(warnings.say("FFD Volume", "at rest in the exported scene"), warnings.text)


if __name__ == "__main__":
    unittest.main()
