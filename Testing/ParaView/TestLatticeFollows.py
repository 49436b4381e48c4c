#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What ParaView makes of a volume with a lattice is shown deformed: slices, contours, clips, surfaces,
outlines, highlights and axes; what is not says so."""

import os
import unittest

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple
from paraview.modules.vtkRemotingViews import vtkSMParaViewPipelineControllerWithRendering

import ffdparaview as ffd
from vtkmodules.vtkCommonCore import vtkCollection

ffd.load()

SHIFT = (3.0, -7.0, 11.0)


class TestLatticeFollows(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        ffd.load()
        self.view = ffd.make_view()
        self.wavelet = ffd.make_wavelet()

    def shown_bounds(self):
        """Of all that is visible."""
        simple.Render(self.view)
        return np.array(self.view.SMProxy.GetRenderer().ComputeVisiblePropBounds())

    def show(self, source, kind=None):
        display = simple.Show(source, self.view)
        if kind:
            display.SetRepresentationType(kind)
        return display

    def lattice(self, **properties):
        return simple.FFDLattice(Input=self.wavelet, Resolution=[4, 4, 4], **properties)

    def moved_lattice(self):
        """All control points moved alike: the volume is moved as a whole."""
        return self.lattice(Displacements=SHIFT * 64)

    def test_filters(self):
        """The deformation of what filters make is that of the volume."""
        for make in (
                lambda data: simple.Slice(Input=data),
                lambda data: simple.Contour(
                    Input=data, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0]),
                lambda data: simple.Clip(Input=data),
                lambda data: simple.Threshold(
                    Input=data, Scalars=["POINTS", "RTData"], LowerThreshold=150.0,
                    UpperThreshold=300.0),
                # These drop field data by themselves.
                lambda data: simple.Elevation(Input=data),
                lambda data: simple.Elevation(Input=simple.GroupDatasets(Input=[data])),
                lambda data: simple.Outline(Input=data),
                lambda data: simple.Outline(Input=simple.GroupDatasets(Input=[data])),
                lambda data: simple.OutlineCorners(Input=data),
                lambda data: simple.ResampleWithDataset(
                    SourceDataArrays=self.wavelet, DestinationMesh=data),
                lambda data: simple.ResampleWithDataset(
                    SourceDataArrays=data, DestinationMesh=data),
                lambda data: simple.SliceWithPlane(Input=data),
                lambda data: simple.Slice(Input=simple.PointDatatoCellData(Input=data)),
                lambda data: simple.CellDatatoPointData(
                    Input=simple.PointDatatoCellData(Input=data)),
                lambda data: simple.GenerateIds(Input=data),
                # It prints what it finds of each cell.
                lambda data: simple.ValidateCells(
                    Input=simple.ExtractSubset(Input=data, VOI=[0, 2, 0, 2, 0, 2])),
                # ParaView makes values of points of those of cells in between.
                lambda data: simple.Contour(
                    Input=simple.PointDatatoCellData(Input=data), ContourBy=["POINTS", "RTData"],
                    Isosurfaces=[157.0]),
                lambda data: simple.Contour(
                    Input=simple.Gradient(Input=data, ScalarArray=["POINTS", "RTData"]),
                    ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0]),
                lambda data: simple.ExtractSubset(Input=data, VOI=[-9, 2, -9, 2, -9, 2])):
            bounds = []
            for data in (self.wavelet, self.moved_lattice()):
                made = make(data)
                self.show(made, "Surface")
                bounds.append(self.shown_bounds())
                simple.Hide(made, self.view)
            name = made.SMProxy.GetXMLName()
            np.testing.assert_allclose(
                bounds[1], bounds[0] + np.repeat(SHIFT, 2), atol=1e-3, err_msg=name)
            # The data themselves are at rest, for filters after it.
            np.testing.assert_allclose(
                made.GetDataInformation().GetBounds(), bounds[0], atol=1e-3, err_msg=name)

    def displacements(self, source, time, array="Displacement", block=None):
        """Of the control points at a time; None without a lattice."""
        source.UpdatePipeline(time)
        data = simple.servermanager.Fetch(source)
        data = data if block is None else data.GetBlock(block)
        found = data.GetFieldData().GetArray("FFDLattice." + array)
        return found and ffd.vtk_to_numpy(found).copy()

    def test_between_steps(self):
        """Temporal Interpolator makes the lattice between those of two steps, whose grids may differ:
        those of translations are about what is moved."""
        times = (0.0, 0.5, 1.0, 1.75, 2.0, 0.25, 1.5, 1.0, 0.0)
        names = []
        for i in range(3):
            names.append("%s/between%d.tfm" % (ffd.TEMPORARY, i))
            with open(names[-1], "w", encoding="ascii") as file:
                file.write("#Insight Transform File V1.0\n#Transform 0\n"
                           "Transform: TranslationTransform_double_3_3\n"
                           "Parameters: %g 0 0\nFixedParameters:\n" % (10.0 * i * i))
        moved = simple.FFDApplyTransform(
            Input=self.wavelet, Transform=simple.FFDTransformReader(FileNames=names))
        for make, block in ((lambda data: data, None),
                            (lambda data: simple.GroupDatasets(Input=[data, self.wavelet]), 0)):
            between = simple.TemporalInterpolator(Input=make(moved))
            for time in times:
                expected = np.interp(time, (0, 1, 2), (0.0, 10.0, 40.0))
                got = self.displacements(between, time, block=block)
                np.testing.assert_allclose(
                    got, np.broadcast_to([expected, 0.0, 0.0], got.shape), atol=1e-9, err_msg=str(time))
        # Steps are as they are, to the last bit.
        for time in (0.0, 1.0, 2.0):
            for array in ("Displacement", "Origin", "Spacing", "DisplacementScale"):
                np.testing.assert_array_equal(
                    self.displacements(between, time, array, 0), self.displacements(moved, time, array))

    def test_between_other_lattices(self):
        """Between lattices with a scale each the deformation is interpolated; between those of unlike
        resolution it is that of the nearer step."""
        for other, expected in (
                ({"Resolution": [4, 4, 4]}, lambda time, a, b: (1.0 - time) * a + time * b),
                ({"Resolution": [5, 4, 6]}, lambda time, a, b: a if time < 0.5 else b)):
            lattices = (self.lattice(Shape="Bend", DisplacementScale=0.5),
                        simple.FFDLattice(Input=self.wavelet, Shape="Twist", **other))
            steps, names = [], []
            for i, lattice in enumerate(lattices):
                names.append("%s/steps_%d.vti" % (ffd.TEMPORARY, i))
                simple.SaveData(names[-1], proxy=lattice, DataMode="Binary")
                steps.append(self.displacements(lattice, 0.0) *
                             self.displacements(lattice, 0.0, "DisplacementScale"))
            between = simple.TemporalInterpolator(
                Input=simple.XMLImageDataReader(FileName=names, TimeArray="None"))
            for time in (0.25, 0.75, 1.0, 0.5, 0.0):
                got = self.displacements(between, time) * self.displacements(
                    between, time, "DisplacementScale")
                np.testing.assert_allclose(got, expected(time, *steps), atol=1e-9)

    def test_representations(self):
        """Surfaces, outlines and points of the volume itself."""
        bent = self.lattice(Shape="Bend")
        kinds = {}
        for kind in ("Surface", "Surface With Edges", "Wireframe", "Points", "Outline",
                     "Feature Edges", "3D Glyphs", "Point Gaussian"):
            rest = self.show(self.wavelet, kind)
            before = ffd.picture(self.view, "rest")
            bounds = self.shown_bounds()
            simple.Hide(self.wavelet, self.view)
            self.show(bent, kind)
            kinds[kind] = ffd.picture(self.view, "follows " + kind)
            shown = self.shown_bounds()
            simple.Hide(bent, self.view)
            self.assertGreater(np.abs(kinds[kind] - before).mean(), 0.3, kind)
            self.assertGreater(np.abs(shown - bounds).max(), 1.0, kind)
            self.assertEqual(rest.Representation, kind)
        # The outline is that of the surface: not the box around it, and bent.
        surface = kinds["Surface"].max(axis=2) > 0
        outline = kinds["Outline"].max(axis=2) > 0
        outside = outline & ~np.pad(surface, 2)[2:-2, 2:-2]
        self.assertLess(outside.sum(), 0.3 * outline.sum())

    def test_points_and_cells(self):
        """Gaussians at the points of surfaces, and volumes of cells."""
        def group(data):
            return simple.GroupDatasets(Input=[simple.Clip(Input=data)])

        def threshold(data):
            return simple.Threshold(Input=data, Scalars=["POINTS", "RTData"], LowerThreshold=150.0,
                                    UpperThreshold=300.0)

        def contour(data):
            return simple.Contour(
                Input=data, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])

        self.wavelet.WholeExtent = [-10, 10] * 3
        lattice = self.moved_lattice()
        resampled = "Resample To Image"
        for make, kind, mapper in (
                (contour, "Point Gaussian", None), (group, "Point Gaussian", None),
                (threshold, "Volume", "Projected tetra"), (group, "Volume", "Projected tetra"),
                (threshold, "Volume", resampled), (group, "Volume", resampled)):
            shown = []
            for data in (self.wavelet, lattice):
                data.UpdatePipeline()
                made = make(data)
                display = self.show(made, "Surface")
                simple.ColorBy(display, ("POINTS", "RTData"))
                display.SetScalarBarVisibility(self.view, False)
                display.SetRepresentationType(kind)
                if mapper:
                    display.SelectMapper = mapper
                    display.SamplingDimensions = [40] * 3
                bounds = self.shown_bounds()
                self.view.CameraPosition = bounds[::2] + (50.0, 30.0, 40.0)
                self.view.CameraFocalPoint = bounds[::2]
                shown.append((bounds, ffd.picture(self.view, "follows cells")))
                simple.Hide(made, self.view)
            name = "%s of %s, %s" % (kind, made.SMProxy.GetXMLName(), mapper)
            np.testing.assert_allclose(
                shown[1][0], shown[0][0] + np.repeat(SHIFT, 2), atol=1e-3, err_msg=name)
            self.assertGreater(ffd.lit(shown[0][1]), 300, name)
            self.assertLess(ffd.differ(shown[0][1], shown[1][1])[1], 1.0, name)

    def test_same_as_deform_geometry(self):
        """A contour that is moved for show is what FFD Deform Geometry makes, which is not moved
        again; and its colors are those of the data."""
        twisted = self.lattice(Shape="Twist")
        gradient = simple.Gradient(Input=twisted, ScalarArray=["POINTS", "RTData"])
        contour = simple.Contour(Input=gradient, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
        display = self.show(contour)
        simple.ColorBy(display, ("POINTS", "Gradient", "X"))
        display.RescaleTransferFunctionToDataRange(False, True)
        moved_for_show = ffd.picture(self.view, "moved for show")
        simple.Hide(contour, self.view)
        for more in ({}, {"Lattice": twisted}):
            moved = simple.FFDDeformGeometry(Input=contour, **more)
            moved.UpdatePipeline()
            self.assertIsNone(
                moved.GetDataInformation().GetFieldDataInformation().GetArrayInformation(
                    "FFDLattice.Displacement"))
            display = self.show(moved)
            # The filter turns vectors, what is moved for show keeps them.
            simple.ColorBy(display, ("POINTS", "RTData"))
            by_filter = ffd.picture(self.view, "moved by filter")
            shape = by_filter.max(axis=2) > 0
            simple.Hide(moved, self.view)
            self.assertLess((shape != (moved_for_show.max(axis=2) > 0)).mean(), 1e-3)
        twisted.GeometryMode = "At Rest"
        self.show(contour)
        at_rest = ffd.picture(self.view, "at rest")
        self.assertGreater(np.abs(at_rest - moved_for_show).mean(), 2.0)

    def test_modes(self):
        """Surfaces of a volume whose Inverse is another one."""
        lattice = self.moved_lattice()
        self.show(lattice, "Surface")
        rest = np.array([-15.0, 15.0] * 3)
        shift = np.repeat(SHIFT, 2)
        for mode, sign in (("Exact", 1), ("First Order", 1), ("Pull Back", -1), ("At Rest", 0)):
            lattice.GeometryMode = mode
            np.testing.assert_allclose(self.shown_bounds(), rest + sign * shift, atol=1e-3)

    def test_edits(self):
        """The slice follows when the lattice is edited."""
        lattice = self.lattice()
        self.show(simple.Slice(Input=lattice))
        at_rest = self.shown_bounds()
        lattice.Displacements = SHIFT * 64
        np.testing.assert_allclose(
            self.shown_bounds(), at_rest + np.repeat(SHIFT, 2), atol=1e-3)
        lattice.DisplacementScale = 0.0
        np.testing.assert_allclose(self.shown_bounds(), at_rest, atol=1e-3)

    def test_blocks(self):
        """Blocks with lattices of their own, and one that has none."""
        blocks = simple.GroupDatasets(Input=[
            simple.Slice(Input=self.moved_lattice()), simple.Sphere(Radius=3.0)])
        self.show(blocks)
        bounds = self.shown_bounds()
        np.testing.assert_allclose(
            bounds, [-3.0, 3.0, -22.0, 8.0, -4.0, 26.0], atol=0.2)

    def test_merged_parts(self):
        """One data set made of parts with different lattices is warned of, once."""
        twisted, tapered = (simple.Slice(Input=self.lattice(Shape=shape)) for shape in ("Twist", "Taper"))
        plain = simple.Slice(Input=self.wavelet)
        for make, label in (
                (simple.AppendGeometry, "Append Geometry"), (simple.AppendDatasets, "Append Datasets"),
                (lambda Input: simple.MergeBlocks(Input=simple.GroupDatasets(Input=Input)), "Merge Blocks")):
            for parts, warns in (((twisted, tapered), True), ((twisted, plain), True),
                                 ((plain, tapered), True), ((twisted, twisted), False),
                                 ((plain, plain), False)):
                with ffd.Errors(event="WarningEvent") as warnings:
                    made = make(Input=list(parts))
                    for offset in (0.0, 1.0):
                        parts[0].SliceType.Origin = [offset, 0.0, 0.0]
                        made.UpdatePipeline()
                self.assertEqual(len(warnings.text), int(warns), (label, warnings.text))
                self.assertEqual(
                    warnings.say('"%s"' % label, "Group Datasets", "FFD Deform Geometry"), warns)

    def test_axes(self):
        """The data axes grid is around what is shown."""
        for data in (self.moved_lattice(), simple.Contour(
                Input=self.moved_lattice(), ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])):
            display = self.show(data, "Surface")
            bounds = self.shown_bounds()
            display.DataAxesGrid.GridAxesVisibility = 1
            simple.Render(self.view)
            axes = self.find_axes()
            np.testing.assert_allclose(axes, bounds, atol=0.1)
            display.DataAxesGrid.GridAxesVisibility = 0
            simple.Hide(data, self.view)

    def test_axes_at_rest(self):
        """Of what a representation shows at rest they are at rest."""
        display = self.show(self.moved_lattice(), "FFD Volume")
        display.DataAxesGrid.GridAxesVisibility = 1
        for kind, shift in (("FFD Volume", SHIFT), ("Volume", (0, 0, 0)), ("FFD Volume", SHIFT),
                            ("Slice", (0, 0, 0)), ("Surface", SHIFT)):
            display.SetRepresentationType(kind)
            simple.Render(self.view)
            np.testing.assert_allclose(
                self.find_axes(), [-15, 15] * 3 + np.repeat(shift, 2), atol=0.1, err_msg=kind)

    def find_axes(self):
        actors = self.view.SMProxy.GetRenderer().GetViewProps()
        for i in range(actors.GetNumberOfItems()):
            actor = actors.GetItemAsObject(i)
            if actor.IsA("vtkPVGridAxes3DActor") and actor.GetVisibility():
                return actor.GetTransformedBounds()
        self.fail("there are no axes")

    def test_selection(self):
        """The highlight of a selection is where the cells are seen."""
        lattice = self.lattice(Shape="Twist")
        self.show(lattice, "Surface")
        before = ffd.picture(self.view, "before selection")
        simple.SelectSurfaceCells(Rectangle=[75, 65, 85, 75], View=self.view)
        after = ffd.picture(self.view, "highlight")
        changed = np.argwhere(np.abs(after - before).max(axis=2) > 30)
        self.assertGreater(len(changed), 20)
        # The rectangle, and what the cells at its edge have outside.
        self.assertGreater(changed.min(), 50)
        self.assertLess(changed.max(), 100)
        simple.ClearSelection(lattice)

    def test_probes(self):
        """Probe Location and Plot Over Line give what is seen where they are: that of the data moved,
        or bent, to there."""
        places = np.array([[2.0, -3.0, 4.0], [-9.0, 5.0, -1.5], [10.0, 1.0, 9.0]])

        def probe(data, place):
            found = simple.ProbeLocation(Input=data, ProbeType="Fixed Radius Point Source")
            found.ProbeType.Center = list(place)
            found.UpdatePipeline()
            return simple.servermanager.Fetch(found)

        for mode, sign in (("Exact", -1), ("First Order", -1), ("Pull Back", 1), ("At Rest", 0)):
            moved = self.moved_lattice()
            moved.GeometryMode = mode
            for place in places:
                at_rest = place + sign * np.array(SHIFT)
                got = probe(moved, place).GetPointData()
                expected = probe(self.wavelet, at_rest).GetPointData()
                valid = expected.GetArray("vtkValidPointMask").GetValue(0)
                self.assertEqual(got.GetArray("vtkValidPointMask").GetValue(0), valid)
                if valid:
                    self.assertAlmostEqual(got.GetArray("RTData").GetValue(0),
                                           expected.GetArray("RTData").GetValue(0), delta=0.01)
                if sign != 0:
                    np.testing.assert_allclose(got.GetArray("RestPosition").GetTuple(0), at_rest, atol=1e-3)
        # A line that is straight in the picture; it is shown where it is.
        bent = self.lattice(Shape="Bend", Strength=0.7)
        line = simple.PlotOverLine(Input=bent, Point1=[-9.0, -8.0, -9.0], Point2=[11.0, 9.0, 12.0])
        line.UpdatePipeline()
        got = simple.servermanager.Fetch(line)
        values = ffd.vtk_to_numpy(got.GetPointData().GetArray("RTData"))
        valid = ffd.vtk_to_numpy(got.GetPointData().GetArray("vtkValidPointMask")) > 0
        resampled = simple.FFDResampleToImage(Input=bent)
        straight = simple.PlotOverLine(
            Input=resampled, Point1=line.Point1.GetData(), Point2=line.Point2.GetData(),
            SamplingPattern=line.SamplingPattern, Resolution=line.Resolution)
        straight.UpdatePipeline()
        self.assertGreater(valid.sum(), 0.5 * len(valid))
        fetched = simple.servermanager.Fetch(straight)
        lengths = [ffd.vtk_to_numpy(data.GetPointData().GetArray("arc_length"))
                   for data in (got, fetched)]
        expected = np.interp(lengths[0], lengths[1],
                             ffd.vtk_to_numpy(fetched.GetPointData().GetArray("RTData")))
        inside = valid.copy()
        inside[:5] = inside[-5:] = False
        self.assertLess(np.abs(values - expected)[inside].mean(), 3.0)
        rest = simple.PlotOverLine(Input=self.wavelet, Point1=line.Point1.GetData(),
                                   Point2=line.Point2.GetData())
        rest.UpdatePipeline()
        fetched = simple.servermanager.Fetch(rest)
        undeformed = np.interp(lengths[0], ffd.vtk_to_numpy(
            fetched.GetPointData().GetArray("arc_length")), ffd.vtk_to_numpy(
                fetched.GetPointData().GetArray("RTData")))
        self.assertGreater(np.abs(values - undeformed)[inside].mean(), 10.0)
        self.assertFalse(got.GetFieldData().HasArray("FFDLattice.Displacement"))

    def test_views_of_probes(self):
        """ParaView opens a chart for Plot Over Line, and a table for Probe Location, as without the plugin."""
        data = self.moved_lattice()
        for probe, kind in ((simple.PlotOverLine(Input=data), "XYChartView"),
                            (simple.ProbeLocation(Input=data), "SpreadSheetView")):
            probe.UpdatePipeline()
            controller = vtkSMParaViewPipelineControllerWithRendering()
            self.assertEqual(controller.GetPreferredViewType(probe.SMProxy, 0), kind)

    def test_probes_of_blocks(self):
        """With a lattice per block each place has the value of the block that is seen there."""
        pieces = [simple.ExtractSubset(Input=self.wavelet, VOI=[*x, -10, 10, -10, 10])
                  for x in ((-10, -2), (2, 10))]
        shape = {"Shape": "Bend", "Strength": 0.5, "Resolution": [4, 4, 4]}
        lattice = simple.FFDLattice(
            Input=simple.GroupDatasets(Input=pieces), LatticePerBlock=1, **shape)
        ways = []
        for piece, x in zip(pieces, (-6.0, 6.0)):
            alone = simple.FFDLattice(Input=piece, **shape)
            for y, z in ((0.0, 0.0), (6.0, -5.0), (-7.0, 3.0)):
                got = []
                for data in (lattice, alone):
                    found = simple.ProbeLocation(Input=data, ProbeType="Fixed Radius Point Source")
                    found.ProbeType.Center = [x, y, z]
                    found.UpdatePipeline()
                    arrays = simple.servermanager.Fetch(found).GetPointData()
                    got.append([arrays.GetArray("vtkValidPointMask").GetTuple1(0),
                                arrays.GetArray("RTData").GetValue(0),
                                *arrays.GetArray("RestPosition").GetTuple(0)])
                if got[1][0]:
                    np.testing.assert_allclose(got[0], got[1], atol=1e-3)
                    # What is there at rest is moved to the place by the lattice of the block.
                    point = simple.PointSource(Center=got[0][2:], NumberOfPoints=1, Radius=0.0)
                    moved = simple.FFDDeformGeometry(Input=point, Lattice=alone)
                    np.testing.assert_allclose(
                        simple.servermanager.Fetch(moved).GetPoint(0), (x, y, z), atol=1e-3)
                    ways.append(np.linalg.norm(np.array(got[0][2:]) - (x, y, z)))
        self.assertGreater(len(ways), 3)
        # A programmable source has brought functions of its own, named as Python's, into this module.
        self.assertGreater(np.max(ways), 1.0)

    def pick_place(self, view, pixel):
        """The place that widgets take from the picture."""
        place, normal = [0.0] * 3, [0.0] * 3
        self.assertTrue(view.SMProxy.ConvertDisplayToPointOnSurface(list(pixel), place, normal))
        return place

    def test_places_of_the_pointer(self):
        """The place that ruler, widgets and the camera's center take from the picture is on what is
        seen there: of surfaces and of FFD Volume."""
        bent = self.lattice(Shape="Bend", Strength=0.9)
        contour = simple.Contour(
            Input=bent, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
        for source, kind in ((bent, "Surface"), (contour, "Surface"), (bent, "FFD Volume")):
            self.show(source, kind)
            ffd.set_functions(opaque=True)
            simple.Render(self.view)
            # Where depths say, up to a pixel.
            renderer = self.view.SMProxy.GetRenderer()
            for x, y in ((80, 70), (70, 85), (95, 60)):
                place = self.pick_place(self.view, (x, y))
                if kind == "FFD Volume":
                    # Where it begins to be visible, as Probe Location finds.
                    probe = simple.ProbeLocation(
                        Input=bent, ProbeType="Fixed Radius Point Source")
                    probe.ProbeType.Center = place
                    probe.UpdatePipeline()
                    value = simple.servermanager.Fetch(probe).GetPointData().GetArray("RTData")
                    self.assertGreater(value.GetValue(0), 125.0)
                    self.assertLess(value.GetValue(0), 190.0)
                    continue
                simple.Render(self.view)
                renderer.SetDisplayPoint(x, y, renderer.GetZ(x, y))
                renderer.DisplayToWorld()
                world = np.array(renderer.GetWorldPoint())
                np.testing.assert_allclose(place, world[:3] / world[3], atol=0.5)
            simple.Hide(source, self.view)

    def test_places_in_views_with_one_camera(self):
        """Places of a volume that views show by mappings of their own are those of the view."""
        bent = self.lattice(Shape="Bend", Strength=0.7)
        views, displays = [self.view, ffd.make_view()], []
        for view, mapping in zip(views, ("Exact", "Pull Back")):
            displays.append(simple.Show(bent, view))
            displays[-1].SetRepresentationType("FFD Volume")
            displays[-1].FFDInverseMode = mapping
        ffd.set_functions(opaque=True)
        pixels = (80, 70), (70, 85), (85, 60)
        alone = []
        for view, display in zip(views, displays):
            for other in displays:
                other.Visibility = int(other is display)
            simple.RenderAllViews()
            alone.append([self.pick_place(view, pixel) for pixel in pixels])
        self.assertGreater(np.linalg.norm(np.subtract(*alone), axis=1).min(), 0.1)
        for display in displays:
            display.Visibility = 1
        simple.RenderAllViews()
        for which in (0, 1, 1, 0, 1):
            np.testing.assert_allclose(
                [self.pick_place(views[which], pixel) for pixel in pixels], alone[which], atol=1e-6)

    def pick_surface(self, pixel, array="RTData"):
        """What the pointer would be told of a surface at a pixel: 1 or 0, place, place at rest, value."""
        manager = simple.servermanager.ProxyManager()
        representations, sources = vtkCollection(), vtkCollection()
        self.view.SMProxy.SelectSurfaceCells([*pixel, *pixel], representations, sources, False)
        if sources.GetNumberOfItems() == 0:
            return None
        renderer = self.view.SMProxy.GetRenderer()
        picker = manager.NewProxy("misc", "FFDSurfacePicker")
        for end, name in enumerate(("PointA", "PointB")):
            renderer.SetDisplayPoint(*pixel, end)
            renderer.DisplayToWorld()
            world = renderer.GetWorldPoint()
            for a in range(3):
                picker.GetProperty(name).SetElement(a, world[a] / world[3])
        shown = representations.GetItemAsObject(0)
        picker.GetProperty("Input").SetProxy(0, shown.GetProperty("Input").GetProxy(0))
        picker.GetProperty("Selection").SetProxy(0, sources.GetItemAsObject(0))
        picker.GetProperty("ArrayName").SetElement(0, array)
        picker.UpdateVTKObjects()
        picker.InvokeCommand("Pick")
        picker.UpdatePropertyInformation()
        return [picker.GetProperty("Picked").GetElement(i) for i in range(8)]

    def test_pointer_on_surfaces(self):
        """Of a slice, a contour and the faces of a volume: the place that is seen, where it is at rest,
        and the value there."""
        bent = self.lattice(Shape="Bend", Strength=0.9)
        normal, origin = np.array([0.2, 0.3, 1.0]), np.array([0.0, 0.0, 2.0])
        sliced = simple.Slice(Input=bent, SliceType="Plane")
        sliced.SliceType.Origin, sliced.SliceType.Normal = origin, normal
        contour = simple.Contour(Input=bent, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
        for source in (sliced, contour, bent):
            self.show(source, "Surface")
            simple.Render(self.view)
            for pixel in ((80, 70), (70, 85), (92, 62)):
                place = self.pick_place(self.view, pixel)
                found = self.pick_surface(pixel)
                self.assertEqual(found[0], 1.0)
                np.testing.assert_allclose(found[1:4], place, atol=1e-6)
                rest = np.array(found[4:7])
                point = simple.PointSource(Center=rest, NumberOfPoints=1, Radius=0.0)
                moved = simple.FFDDeformGeometry(Input=point, Lattice=bent)
                # Cells are moved by their corners.
                np.testing.assert_allclose(
                    simple.servermanager.Fetch(moved).GetPoint(0), place, atol=0.05)
                self.assertGreater(np.linalg.norm(rest - place), 0.5)
                probe = simple.ProbeLocation(
                    Input=self.wavelet, ProbeType="Fixed Radius Point Source")
                probe.ProbeType.Center = rest
                value = simple.servermanager.Fetch(probe).GetPointData().GetArray("RTData")
                self.assertAlmostEqual(found[7], value.GetValue(0), delta=6.0)
                if source is sliced:
                    self.assertAlmostEqual(np.dot(rest - origin, normal), 0.0, delta=1e-5)
                if source is contour:
                    self.assertAlmostEqual(found[7], 157.0, delta=1e-3)
            simple.Hide(source, self.view)
        # Nothing is told of what has no lattice.
        self.show(self.wavelet, "Surface")
        simple.Render(self.view)
        self.assertEqual(self.pick_surface((80, 70)), [0.0] * 8)

    def test_what_stays_at_rest_says_so(self):
        """Once for each switch."""
        lattice = self.lattice(Shape="Twist")
        with ffd.Errors(event="WarningEvent") as warnings:
            display = self.show(lattice)
            simple.Render(self.view)
            self.assertEqual(warnings.text, [])
            for kind in ("Volume", "Slice"):
                display.SetRepresentationType(kind)
                for _ in range(2):
                    simple.Render(self.view)
                    lattice.Strength = 0.5 * lattice.Strength
                self.assertTrue(warnings.say('"%s"' % kind, "at rest", "FFD Volume"))
            self.assertEqual(len(warnings.text), 2, warnings.text)
            simple.Hide(lattice, self.view)
            self.show(self.wavelet, "Slice")
            simple.Render(self.view)
            self.assertEqual(len(warnings.text), 2)

    def test_dropped_lattice_says_so(self):
        """Filters that drop the lattice, and those whose output is where it is meant to be."""
        twisted = self.lattice(Shape="Twist")
        for make, drops in (
                (simple.TemporalStatistics, True),
                (lambda Input: simple.Calculator(Input=simple.PointVolumeInterpolator(
                    Input=Input, Source="Bounded Volume")), True),
                (lambda Input: simple.ResampleWithDataset(
                    SourceDataArrays=Input, DestinationMesh=self.wavelet), True),
                (simple.FFDResampleToImage, False),
                (lambda Input: simple.Calculator(Input=simple.FFDResampleToImage(Input=Input)), False),
                (lambda Input: simple.FFDDeformGeometry(Input=simple.Slice(Input=Input)), False),
                (simple.Elevation, False)):
            made = make(Input=twisted)
            with ffd.Errors(event="WarningEvent") as warnings:
                self.show(made, "Surface")
                for _ in range(2):
                    simple.Render(self.view)
                    twisted.Strength = 0.5 * twisted.Strength
            simple.Hide(made, self.view)
            name = made.SMProxy.GetXMLName()
            self.assertEqual(len(warnings.text), int(drops), (name, warnings.text))
            self.assertEqual(warnings.say("dropped", "at rest"), drops, name)

    def test_missing_transform_is_not_dropped(self):
        """A transform that is not chosen yet, or cannot be read, has said so; no filter has dropped it."""
        missing = os.path.join(ffd.TEMPORARY, "missing.tfm")
        for transform, message in ((False, "no lattice to attach"), (True, "missing.tfm")):
            with ffd.Errors() as errors, ffd.Errors(event="WarningEvent") as warnings:
                applied = simple.FFDApplyTransform(Input=self.wavelet)
                if transform:
                    applied.Transform = simple.FFDTransformReader(FileNames=[missing])
                sliced = simple.Slice(Input=applied)
                self.show(applied, "FFD Volume")
                self.show(sliced, "Surface")
                simple.Render(self.view)
            simple.Hide(applied, self.view)
            simple.Hide(sliced, self.view)
            self.assertTrue(errors.say(message), errors.text)
            self.assertEqual(warnings.text, [])

    def test_empty_data_drop_nothing(self):
        """Of a volume without voxels no filter is said to have dropped the lattice."""
        empty = simple.ProgrammableSource(OutputDataSetType="vtkImageData", Script="pass")
        with ffd.Errors(event="WarningEvent") as warnings:
            self.show(simple.FFDLattice(Input=empty), "FFD Volume")
            simple.Render(self.view)
        self.assertEqual(warnings.text, [])


if __name__ == "__main__":
    unittest.main()
