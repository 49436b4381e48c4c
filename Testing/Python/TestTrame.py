# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkffd.trame: what pages that draw the scene themselves are sent of a deformed volume. Skipped where
trame-vtk or PyVista is neither installed nor to be had."""

import gc
import json
import os
import subprocess
import sys
import unittest
import warnings
import weakref

import ffdpackages

PACKAGES = [folder for folder in (
    ffdpackages.require("trame_vtk.modules.vtk.serializers", ffdpackages.TRAME_VTK),
    ffdpackages.require("pyvista", ffdpackages.PYVISTA)) if folder]

import numpy as np  # noqa: E402
import vtkffd  # noqa: E402
import vtkffd.trame  # noqa: E402
import vtkmodules.vtkRenderingOpenGL2  # noqa: E402, F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: E402, F401
from trame_vtk.modules.vtk import serializers  # noqa: E402
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonDataModel import (  # noqa: E402
    vtkImageData, vtkPiecewiseFunction, vtkRectilinearGrid)
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkVolume  # noqa: E402

PYVISTA_PROGRAM = """
import pyvista
import vtkffd.pyvista
grid = pyvista.ImageData(dimensions=(5, 5, 5))
grid["value"] = grid.points[:, 0]
plotter = pyvista.Plotter(off_screen=True)
actor = plotter.add_deformed_volume(grid, grid.ffd.lattice())
from trame_vtk.modules.vtk.serializers import registry
assert actor.mapper.GetClassName() in registry.SERIALIZERS
"""


def ball():
    image = vtkImageData()
    image.SetDimensions(20, 20, 20)
    grid = np.stack(np.meshgrid(*[np.arange(20.0)] * 3, indexing="ij")) - 9.5
    values = np.clip(10.0 - np.linalg.norm(grid, axis=0), 1.0, None)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F").astype("f4"), deep=True))
    image.GetPointData().GetScalars().SetName("value")
    return image


class TestPages(unittest.TestCase):
    def setUp(self):
        serializers.initialize_serializers()
        self.image = ball()
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(5, 5, 5)
        self.lattice.FitToBounds(self.image.GetBounds())
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(1.0, 0.0)
        opacity.AddPoint(10.0, 1.0)
        self.volume.GetProperty().SetScalarOpacity(opacity)
        self.window, renderer = vtkRenderWindow(), vtkRenderer()
        self.window.SetOffScreenRendering(1)
        self.window.AddRenderer(renderer)
        renderer.AddVolume(self.volume)

    def sent(self):
        """The mapper as a page is told of it, its voxels, and their dimensions; or None."""
        context = serializers.SynchronizationContext()
        context.ignore_last_dependencies = True
        scene = serializers.serialize(
            None, self.window, serializers.reference_id(self.window), context, 0)
        json.dumps(scene)

        def find(part):
            if part["id"] == serializers.reference_id(self.mapper):
                return part
            parts = (find(child) for child in part.get("dependencies", ()) if child)
            return next((part for part in parts if part), None)
        mapper = find(scene)
        if mapper is None:
            return None
        data, = mapper["dependencies"]
        field, = data["properties"]["fields"]
        array = context.data_array_cache[field["hash"]]["array"]
        extent = data["properties"]["extent"]
        size = [last - first + 1 for first, last in zip(extent[::2], extent[1::2])]
        return mapper, np.array(vtk_to_numpy(array)), size

    def test_what_nothing_deforms_is_sent_itself(self):
        mapper, voxels, size = self.sent()
        self.assertEqual(mapper["type"], "vtkVolumeMapper")
        self.assertEqual(size, [20, 20, 20])
        np.testing.assert_array_equal(voxels, vtk_to_numpy(self.image.GetPointData().GetScalars()))

    def test_the_page_follows_the_lattice(self):
        self.mapper.SetDeformation(self.lattice)
        for distance in (0.0, 6.0, 9.0):
            for i in range(5):
                for j in range(5):
                    for k in range(5):
                        self.lattice.SetDisplacement(i, j, k, distance, 0.0, 0.0)
            mapper, voxels, size = self.sent()
            self.assertEqual(mapper["type"], "vtkVolumeMapper")
            # The material has moved along x; what surrounds it is not seen.
            voxels = voxels.reshape(size, order="F")
            x = np.arange(size[0]) * 1.0
            weights = (voxels - 1.0).sum(axis=(1, 2))
            extent = mapper["dependencies"][0]["properties"]["extent"]
            self.assertAlmostEqual((weights * (x + extent[0])).sum() / weights.sum(), 9.5 + distance,
                                   delta=0.05)
            self.assertEqual(voxels.min(), 1.0)
        # An attached one.
        self.mapper.SetDeformation(None)
        self.lattice.AttachTo(self.image)
        self.assertEqual(self.sent()[2], size)

    def test_the_page_shows_the_scalars_that_are_chosen(self):
        other = vtk_to_numpy(self.image.GetPointData().GetScalars()) * -2.0
        array = numpy_to_vtk(other, deep=True)
        array.SetName("other")
        self.image.GetPointData().AddArray(array)
        self.mapper.SetScalarModeToUsePointFieldData()
        self.mapper.SelectScalarArray("other")
        np.testing.assert_array_equal(self.sent()[1], other)
        self.mapper.SelectScalarArray(1)
        self.mapper.SetDeformation(self.lattice)
        np.testing.assert_array_equal(self.sent()[1], other)
        self.mapper.SetScalarModeToDefault()
        np.testing.assert_array_equal(self.sent()[1], other * -0.5)
        for choose in (self.mapper.SetScalarModeToUseCellData,
                       lambda: self.mapper.SetScalarModeToUsePointFieldData(),
                       lambda: self.mapper.SetScalarModeToUseCellFieldData()):
            choose()
            self.mapper.SelectScalarArray("missing")
            with self.assertWarnsRegex(UserWarning, "left out of the page"):
                self.assertIsNone(self.sent())

    def test_samples_of_mirrored_images_are_apart(self):
        self.image.SetSpacing(-1.0, 2.0, 1.0)
        self.assertEqual(self.sent()[0]["properties"]["sampleDistance"], 1.0)

    def test_others_are_left_out_aloud(self):
        grid = vtkRectilinearGrid()
        grid.SetDimensions(3, 3, 3)
        for data in (grid, vtkImageData(), None):
            with self.subTest(type(data).__name__), warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                if data is None:
                    self.mapper.RemoveAllInputs()
                else:
                    self.mapper.SetInputDataObject(data)
                self.assertIsNone(self.sent())
                self.assertIn("left out of the page", str(caught[0].message))

    def test_pyvista_needs_no_import_of_it(self):
        environment = dict(os.environ)
        environment["PYTHONPATH"] = os.pathsep.join((*PACKAGES, environment["PYTHONPATH"]))
        result = subprocess.run([sys.executable, "-c", PYVISTA_PROGRAM], env=environment,
                                capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_copies_go_with_their_mappers(self):
        self.mapper.SetDeformation(self.lattice)
        self.sent()
        image = weakref.ref(self.image)
        self.window.Finalize()
        self.window = self.volume = self.mapper = self.image = None
        gc.collect()
        self.assertIsNone(image())


if __name__ == "__main__":
    unittest.main()
