# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDLatticeSource and vtkFFDDeformVolume from Python."""

import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkMultiBlockDataSet, vtkPolyData


class TestFilters(unittest.TestCase):
    def test_source_and_deform_volume(self):
        volume = vtkImageData()
        volume.SetDimensions(10, 10, 10)
        volume.AllocateScalars(3, 1)
        source = vtkffd.vtkFFDLatticeSource()
        source.SetBounds(volume.GetBounds())
        source.SetDimensions(6, 6, 6)
        source.SetShapeToTwist()
        source.SetStrength(0.5)
        self.assertEqual(source.GetShapeAsString(), "Twist")
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(volume)
        deform.SetLatticeConnection(source.GetOutputPort())
        deform.Update()
        self.assertTrue(vtkffd.vtkFFDLattice.HasLattice(deform.GetOutput()))
        self.assertFalse(vtkffd.vtkFFDLattice.HasLattice(volume))
        lattice = vtkffd.vtkFFDLattice()
        self.assertEqual(lattice.ReadFrom(deform.GetOutput()), 1)
        np.testing.assert_array_equal(
            vtk_to_numpy(lattice.GetDisplacements()),
            vtk_to_numpy(source.GetLattice().GetDisplacements()))

    def test_lattice_of_another_volume(self):
        """The lattice that is attached to the second input is taken, not its voxels: labels have that of
        their image."""
        image, labels = vtkImageData(), vtkImageData()
        for each in (image, labels):
            each.SetDimensions(10, 10, 10)
            each.AllocateScalars(3, 1)
        lattice = vtkffd.vtkFFDLattice()
        lattice.FitToBounds(image.GetBounds())
        lattice.SetDisplacement(1, 2, 1, 0.5, -0.25, 1.0)
        lattice.AttachTo(image)
        deform = vtkffd.vtkFFDDeformVolume()
        deform.SetInputData(labels)
        deform.SetLatticeData(image)
        deform.Update()
        found = vtkffd.vtkFFDLattice()
        self.assertEqual(found.ReadFrom(deform.GetOutput()), 1)
        np.testing.assert_array_equal(
            vtk_to_numpy(found.GetDisplacements()), vtk_to_numpy(lattice.GetDisplacements()))
        self.assertEqual(found.GetDomain(), lattice.GetDomain())

    def test_geometry_by_the_lattice_of_blocks(self):
        """That of all blocks, if they have the same one."""
        lattices = [vtkffd.vtkFFDLattice() for _ in range(2)]
        for which, lattice in enumerate(lattices):
            lattice.SetDomain(0.0, 9.0, 0.0, 9.0, 0.0, 9.0)
            for i, j, k in np.ndindex(*lattice.GetDimensions()):
                lattice.SetDisplacement(i, j, k, 1.0 + which, 0.0, 0.0)
        points = vtkPoints()
        points.InsertNextPoint(4.0, 5.0, 6.0)
        surface = vtkPolyData()
        surface.SetPoints(points)
        for which, moved in (((0, 0), 5.0), ((1, 1), 6.0), ((0, 1), None), ((0, None), None)):
            blocks = vtkMultiBlockDataSet()
            for i, each in enumerate(which):
                image = vtkImageData()
                image.SetDimensions(10, 10, 10)
                if each is not None:
                    lattices[each].AttachTo(image)
                blocks.SetBlock(i, image)
            errors = []

            def note(_caller, _event, text, errors=errors):
                errors.append(text)

            note.CallDataType = "string0"
            geometry = vtkffd.vtkFFDDeformGeometry()
            geometry.AddObserver("ErrorEvent", note)
            geometry.SetInputData(surface)
            geometry.SetLatticeData(blocks)
            geometry.Update()
            self.assertEqual(geometry.GetOutput().GetPoint(0)[0], 4.0 if moved is None else moved)
            self.assertEqual(len(errors), int(moved is None), errors)
            self.assertTrue(all("a lattice each" in text for text in errors), errors)

    def test_every_shape_is_fold_free_at_full_strength(self):
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(8, 8, 8)
        shapes = vtkffd.vtkFFDLatticeSource
        for shape in (shapes.BEND, shapes.TWIST, shapes.TAPER, shapes.BULGE, shapes.WAVE,
                      shapes.RANDOM):
            with self.subTest(shape):
                self.assertEqual(shapes.ApplyShape(lattice, shape, 1.0), 1)
                self.assertFalse(lattice.IsIdentity())
                self.assertTrue(lattice.IsFoldFree())
        self.assertEqual(shapes.ApplyShape(lattice, shapes.IDENTITY, 1.0), 1)
        self.assertTrue(lattice.IsIdentity())


if __name__ == "__main__":
    unittest.main()
