# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDEditLattice: the lattice that plain values define, against lattices made by hand."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkMultiBlockDataSet, vtkRectilinearGrid
from vtkmodules.vtkFiltersAMR import vtkImageToAMR
from vtkmodules.vtkFiltersCore import vtkContourFilter
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource

POINTS = [(0.0, 0.0, 0.0), (3.1, -2.2, 5.0), (-9.0, 8.0, 1.0)]


def displacements(lattice):
    return vtk_to_numpy(lattice.GetDisplacements()).copy()


class TestEditLattice(unittest.TestCase):
    def setUp(self):
        self.source = vtkRTAnalyticSource()
        self.filter = vtkffd.vtkFFDEditLattice()
        self.filter.SetInputConnection(self.source.GetOutputPort())
        self.errors = []
        self.filter.AddObserver("ErrorEvent", lambda caller, event: self.errors.append(event))

    def attached(self):
        """The lattice of the output."""
        self.filter.Update()
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.ReadFrom(self.filter.GetOutput()), 1)
        return lattice

    def expected(self, dimensions, padding=0.0):
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(*dimensions)
        lattice.FitToBounds((-10, 10, -10, 10, -10, 10), padding)
        return lattice

    def test_arrays_are_shared_and_input_unchanged(self):
        lattice = self.attached()
        self.assertTrue(lattice.IsIdentity())
        self.assertIs(self.filter.GetOutput().GetPointData().GetScalars(),
                      self.source.GetOutput().GetPointData().GetScalars())
        self.assertFalse(vtkffd.vtkFFDLattice.HasLattice(self.source.GetOutput()))

    def test_shape_scale_padding(self):
        self.filter.SetDimensions(5, 6, 7)
        self.filter.SetPadding(0.25)
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.TWIST)
        self.filter.SetStrength(0.7)
        self.filter.SetDisplacementScale(0.5)
        lattice = self.attached()
        wanted = self.expected((5, 6, 7), 0.25)
        vtkffd.vtkFFDLatticeSource.ApplyShape(wanted, vtkffd.vtkFFDLatticeSource.TWIST, 0.7)
        self.assertEqual(lattice.GetDomain(), wanted.GetDomain())
        numpy.testing.assert_allclose(displacements(lattice), displacements(wanted), atol=1e-12)
        self.assertEqual(lattice.GetDisplacementScale(), 0.5)

    def test_geometry_mode(self):
        """The mode travels with the data, through other filters, too; the default needs no array."""
        kind = vtkffd.vtkFFDEditLattice
        contour = vtkContourFilter()
        contour.SetInputConnection(self.filter.GetOutputPort())
        contour.SetValue(0, 150.0)
        for mode in (kind.PULL_BACK, kind.AT_REST, kind.FIRST_ORDER, kind.EXACT):
            self.filter.SetGeometryMode(mode)
            contour.Update()
            for data in (self.filter.GetOutput(), contour.GetOutput()):
                self.assertEqual(kind.GetGeometryModeOf(data), mode)
                self.assertEqual(
                    data.GetFieldData().HasArray("FFDGeometryMode"), mode != kind.EXACT)
        # Chained: that of the last one.
        self.filter.SetGeometryMode(kind.PULL_BACK)
        second = kind()
        second.SetInputConnection(self.filter.GetOutputPort())
        second.Update()
        self.assertEqual(kind.GetGeometryModeOf(second.GetOutput()), kind.EXACT)
        self.assertEqual(kind.GetGeometryModeOf(self.source.GetOutput()), kind.EXACT)
        self.assertEqual(kind.GetGeometryModeOf(None), kind.EXACT)

    def test_seed_and_border(self):
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.RANDOM)
        first = displacements(self.attached())
        self.filter.SetSeed(2)
        self.assertGreater(abs(displacements(self.attached()) - first).max(), 0.1)
        self.filter.SetBorderMode(1)
        self.assertEqual(self.attached().GetBorderMode(), 1)

    def test_edits_are_added_and_kept(self):
        self.filter.SetDimensions(4, 4, 4)
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.BEND)
        shape = displacements(self.attached())
        edits = numpy.random.default_rng(1).uniform(-1.0, 1.0, (64, 3))
        self.filter.SetNumberOfDisplacements(64)
        for i, d in enumerate(edits):
            self.filter.SetDisplacement(i, *d)
        numpy.testing.assert_allclose(displacements(self.attached()), shape + edits, atol=1e-12)
        # The same by one call; the lattice that the user changes is made again.
        self.filter.SetNumberOfDisplacements(0)
        self.filter.SetDisplacements(numpy_to_vtk(edits))
        numpy.testing.assert_allclose(displacements(self.attached()), shape + edits, atol=1e-12)
        self.filter.GetLattice().Reset()
        self.filter.Modified()
        numpy.testing.assert_allclose(displacements(self.attached()), shape + edits, atol=1e-12)
        time = self.filter.GetMTime()
        self.filter.SetDisplacements(numpy_to_vtk(edits))
        self.assertEqual(self.filter.GetMTime(), time)
        # A finer lattice: the same map of the edits alone.
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.IDENTITY)
        coarse = self.attached()
        self.filter.SetEditDimensions(4, 4, 4)
        self.filter.SetDimensions(5, 5, 5)
        fine = self.attached()
        for p in POINTS:
            numpy.testing.assert_allclose(
                fine.TransformPoint(p), coarse.TransformPoint(p), atol=1e-9)
        # Those of the lattice itself need not say so again.
        edits = numpy.random.default_rng(2).uniform(-1.0, 1.0, (125, 3))
        self.filter.SetDisplacements(numpy_to_vtk(edits))
        numpy.testing.assert_allclose(displacements(self.attached()), edits, atol=1e-12)
        self.assertEqual(self.errors, [])
        self.filter.SetDisplacements(numpy_to_vtk(edits[1:]))
        self.assertTrue(self.attached().IsIdentity())
        self.assertEqual(len(self.errors), 1)

    def test_lattice_of_the_input(self):
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.TWIST)
        first = displacements(self.attached())
        second = vtkffd.vtkFFDEditLattice()
        second.SetInputConnection(self.filter.GetOutputPort())
        second.Update()
        numpy.testing.assert_allclose(displacements(second.GetLattice()), first, atol=1e-9)
        second.UseInputLatticeOff()
        second.Update()
        self.assertTrue(second.GetLattice().IsIdentity())

    def test_bounds_of_the_data(self):
        """Those of the volume, whatever the domain is, or of the last block."""
        self.filter.SetPadding(0.25)
        after = vtkffd.vtkFFDEditLattice()
        after.SetInputConnection(self.filter.GetOutputPort())
        after.Update()
        for each in (self.filter, after):
            self.assertEqual(each.GetLatticeDomain(), (-15.0, 15.0) * 3)
            self.assertEqual(each.GetDataBounds(), (-10.0, 10.0) * 3)
        blocks = vtkMultiBlockDataSet()
        for i in range(2):
            block = vtkImageData()
            block.SetDimensions(3, 3, 3)
            block.SetOrigin(5.0 * i, 0.0, 0.0)
            blocks.SetBlock(i, block)
        after.SetInputData(blocks)
        for per_block, first in ((False, 0.0), (True, 5.0)):
            after.SetLatticePerBlock(per_block)
            after.Update()
            self.assertEqual(after.GetDataBounds(), (first, 7.0, 0.0, 2.0, 0.0, 2.0))

    def test_amr(self):
        """One lattice is over all levels, that of the image that they are made of."""
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.TWIST)
        expected = displacements(self.attached())
        levels = vtkImageToAMR()
        levels.SetInputConnection(self.source.GetOutputPort())
        self.filter.SetInputConnection(levels.GetOutputPort())
        self.filter.Update()
        blocks = self.filter.GetOutputDataObject(0)
        self.assertEqual(blocks.GetClassName(), "vtkMultiBlockDataSet")
        count = levels.GetOutput().GetTotalNumberOfBlocks()
        self.assertGreater(count, 8)
        self.assertEqual(blocks.GetNumberOfBlocks(), count)
        self.assertEqual(blocks.GetNumberOfPoints(), levels.GetOutput().GetNumberOfPoints())
        lattice = vtkffd.vtkFFDLattice()
        for i in range(count):
            self.assertEqual(lattice.ReadFrom(blocks.GetBlock(i)), 1)
            self.assertEqual(lattice.GetDomain(), (-10.0, 10.0) * 3)
            numpy.testing.assert_allclose(displacements(lattice), expected, atol=1e-12)
        # Back to an image.
        self.filter.SetInputConnection(self.source.GetOutputPort())
        numpy.testing.assert_allclose(displacements(self.attached()), expected, atol=1e-12)

    def test_base_is_what_the_edits_are_added_to(self):
        self.filter.SetDimensions(5, 5, 5)
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.TWIST)
        self.filter.SetDisplacementScale(0.5)
        shape = displacements(self.attached())
        self.filter.SetNumberOfDisplacements(125)
        self.filter.SetDisplacement(62, 1.0, 2.0, 3.0)
        numpy.testing.assert_allclose(displacements(self.attached())[62] - shape[62], (1, 2, 3),
                                      atol=1e-12)
        base = vtk_to_numpy(self.filter.GetBaseDisplacements())
        numpy.testing.assert_allclose(base, shape, atol=1e-12)
        self.assertEqual(self.filter.GetLatticeDisplacementScale(), 0.5)

    def test_known_before_the_data(self):
        self.filter.SetShape(vtkffd.vtkFFDLatticeSource.TWIST)
        self.filter.UpdateInformation()
        info = self.filter.GetOutputInformation(0)
        points = info.Get(vtkffd.vtkFFDEditLattice.LATTICE())
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.FromImageData(points), 1)
        numpy.testing.assert_allclose(
            displacements(lattice), displacements(self.attached()), atol=1e-12)

    def test_parts_have_the_lattice_of_the_whole(self):
        self.filter.UpdateExtent((-10, 0, -10, 10, -10, 10))
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.ReadFrom(self.filter.GetOutput()), 1)
        self.assertEqual(lattice.GetDomain(), (-10, 10, -10, 10, -10, 10))

    def test_geometry_that_is_not_a_number(self):
        texts = []

        def note(_caller, _event, text):
            texts.append(text)

        note.CallDataType = "string0"
        self.filter.AddObserver("ErrorEvent", note)
        image = vtkImageData()
        image.SetDimensions(3, 3, 3)
        grid = vtkRectilinearGrid()
        grid.SetDimensions(3, 3, 3)
        for i, last in enumerate((2.0, 2.0, float("nan"))):
            getattr(grid, "Set%sCoordinates" % "XYZ"[i])(numpy_to_vtk(numpy.array([0.0, 1.0, last]), True))
        for setter, values, data in (
                ("SetOrigin", (0.0, float("nan"), 0.0), image),
                ("SetSpacing", (1.0, 1.0, float("nan")), image),
                ("SetSpacing", (1.0, float("inf"), 1.0), image), ("SetExtent", (0, 2) * 3, grid)):
            before = image.GetOrigin(), image.GetSpacing()
            getattr(data, setter)(*values)
            self.filter.SetInputDataObject(data)
            texts.clear()
            self.filter.Update()
            self.assertEqual(len(texts), 1, texts)
            self.assertIn("not finite numbers", texts[0])
            output = self.filter.GetOutputDataObject(0)
            self.assertFalse(vtkffd.vtkFFDLattice.HasLattice(output))
            image.SetOrigin(before[0])
            image.SetSpacing(before[1])
        image.SetSpacing(0.0, 0.0, 0.0)
        self.filter.SetInputDataObject(image)
        texts.clear()
        self.filter.Update()
        self.assertIn("no extent along any axis", texts[0])

    def test_bad_values(self):
        for setter, bad in (("SetDimensions", (3, 4, 4)), ("SetDimensions", (4, 65, 4)),
                            ("SetEditDimensions", (4, 0, 4)), ("SetShape", (7,)),
                            ("SetPadding", (-0.1,)), ("SetPadding", (float("nan"),)),
                            ("SetStrength", (float("inf"),)),
                            ("SetDisplacementScale", (float("nan"),)),
                            ("SetNumberOfDisplacements", (-1,)),
                            ("SetDisplacement", (0, 1.0, 2.0, 3.0))):
            self.errors.clear()
            time = self.filter.GetMTime()
            getattr(self.filter, setter)(*bad)
            self.assertEqual(len(self.errors), 1, setter)
            self.assertEqual(self.filter.GetMTime(), time, setter)
        values = numpy.full((4, 3), 1.0)
        values[2, 1] = float("nan")
        for bad in (None, numpy_to_vtk(values), numpy_to_vtk(numpy.zeros((4, 2)))):
            self.errors.clear()
            self.assertEqual(self.filter.SetDisplacements(bad), 0)
            self.assertEqual(len(self.errors), 1)
            self.assertEqual(self.filter.GetMTime(), time)
        self.filter.SetNumberOfDisplacements(5)
        self.errors.clear()
        self.assertTrue(self.attached().IsIdentity())
        self.assertEqual(len(self.errors), 1)


if __name__ == "__main__":
    unittest.main()
