# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkffd.pyvista: PyVista's arguments mean what they mean there, lattices are numpy arrays, the widget
moves them, and the gallery runs. Skipped where PyVista is neither installed nor to be had."""

import gc
import glob
import os
import subprocess
import sys
import unittest
import weakref

import ffdpackages

os.environ["PYVISTA_OFF_SCREEN"] = "true"
PACKAGES = ffdpackages.require("pyvista", ffdpackages.PYVISTA)

import numpy as np  # noqa: E402
import pyvista as pv  # noqa: E402
import vtkffd  # noqa: E402
import vtkffd.pyvista  # noqa: E402
from vtkmodules.vtkCommonTransforms import vtkTransform  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkVolume  # noqa: E402

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SIZE = (160, 140)


def ellipsoid():
    """Values fall from 200 in the middle to 0 at the outside, in floats."""
    grid = pv.ImageData(dimensions=(40, 36, 32), spacing=(1.0, 1.0, 1.5), origin=(5.0, -3.0, 2.0))
    offset = (np.array(grid.points) - grid.center) / (18.0, 12.0, 20.0)
    grid["density"] = np.clip(200.0 * (1.2 - np.linalg.norm(offset, axis=1)), 0.0, None).astype("f4")
    return grid


class Scene:
    """An off-screen plotter whose pictures can be compared."""

    def __init__(self):
        self.plotter = pv.Plotter(window_size=SIZE)
        self.plotter.set_background("white")

    def picture(self):
        self.plotter.camera_position = [(90, -70, 80), (24, 15, 25), (0, 0, 1)]
        self.plotter.show(auto_close=False)
        self.plotter.render()
        return self.plotter.screenshot(return_img=True).astype(int)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.plotter.close()


def show(method, *arguments, **options):
    with Scene() as scene:
        actor = getattr(scene.plotter, method)(*arguments, show_scalar_bar=False, **options)
        actor.prop.interpolation_type = "linear"
        return scene.picture()


class TestArguments(unittest.TestCase):
    def test_undeformed_it_is_add_volume(self):
        """Every argument has the effect that it has in add_volume()."""
        grid = ellipsoid()
        matrix = np.diag((0.7, 1.2, 0.9, 1.0))
        tables = [pv.LookupTable("hot", scalar_range=(0, 240)) for _ in range(2)]
        for table in tables:
            table.apply_opacity("sigmoid_5")
        plain = show("add_deformed_volume", grid, cmap="viridis")
        for options in ({}, {"cmap": "hot"}, {"clim": (60.0, 150.0)}, {"rng": 150.0},
                        {"opacity": "sigmoid_8"}, {"opacity": [0.0, 0.9, 0.0, 0.2]},
                        {"blending": "maximum"}, {"shade": True, "ambient": 0.4, "specular": 0.0},
                        {"opacity_unit_distance": 20.0}, {"flip_scalars": True},
                        {"user_matrix": matrix}, {"n_colors": 3}, {"cmap": tables[0]}):
            with self.subTest(options):
                arguments = {"cmap": "viridis", **options}
                ours = show("add_deformed_volume", grid, **arguments)
                if arguments["cmap"] is tables[0]:
                    arguments["cmap"] = tables[1]  # PyVista writes into the table
                theirs = show("add_volume", grid, mapper="gpu", **arguments)
                self.assertLess(np.abs(ours - theirs).mean(), 1.0)
                if options:
                    self.assertGreater(np.abs(ours - plain).mean(), 2.0)

    def test_scalars(self):
        grid = ellipsoid()
        grid["other"] = np.ascontiguousarray(grid.points[:, 2])
        chosen = show("add_deformed_volume", grid, scalars="other")
        given = show("add_deformed_volume", grid, scalars=np.array(grid["other"]))
        self.assertGreater(np.abs(chosen - show("add_deformed_volume", grid,
                                                scalars="density")).mean(), 3.0)
        np.testing.assert_array_equal(chosen, given)
        self.assertEqual(grid.array_names, ["density", "other"])
        array = np.array(grid["density"]).reshape(grid.dimensions, order="F")
        with Scene() as scene:
            actor = scene.plotter.add_deformed_volume(array, resolution=(2.0, 1.0, 1.0))
            self.assertAlmostEqual(actor.bounds[1], 2.0 * (array.shape[0] - 1), delta=0.1)
        cells = pv.ImageData(dimensions=(9, 9, 9))
        cells.cell_data["c"] = np.arange(512.0)
        with Scene() as scene:
            self.assertEqual(scene.plotter.add_deformed_volume(cells).mapper.scalar_range,
                             (0.0, 511.0))

        # All mappers take the same arrays to the points.
        cells = ellipsoid()
        cells.cell_data["c"] = np.array(cells.point_data_to_cell_data()["density"])
        cells.cell_data["density"] = np.where(cells.cell_centers().points[:, 2] < cells.center[2],
                                              cells.cell_data["c"], 0.0)
        lattice = cells.ffd.lattice(5, "bend", 0.4)
        different = []
        for options in ({"scalars": "c"}, {"scalars": "c", "preference": "cell"},
                        {"scalars": "density"}, {"scalars": "density", "preference": "cell"}):
            with self.subTest(options):
                ours, gpu = (show("add_deformed_volume", cells, lattice, mapper=mapper, **options)
                             for mapper in ("inverse_ray", "gpu"))
                self.assertLess(np.abs(ours - gpu).mean(), 1.0)
                different.append(ours)
        np.testing.assert_array_equal(different[0], different[1])
        self.assertGreater(np.abs(different[2] - different[3]).mean(), 3.0)
        np.testing.assert_array_equal(different[2], show("add_deformed_volume", ellipsoid(), lattice))
        self.assertEqual(cells.cell_data.keys(), ["c", "density"])
        self.assertEqual(cells.point_data.keys(), ["density"])
        cells.ffd.attach(lattice)
        np.testing.assert_array_equal(show("add_deformed_volume", cells, scalars="c"), different[0])

        steps = np.linspace(0.0, 30.0, 31)
        bent = pv.RectilinearGrid(steps**1.1, steps, steps)
        bent["d"] = np.ascontiguousarray(bent.points[:, 0])
        self.assertLess(show("add_deformed_volume", bent).mean(), 254.0)

    def test_mappers_agree_on_the_deformed_volume(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice(6, "taper", 0.8)
        for options in ({}, {"clim": (20.0, 180.0), "inverse_mode": "first_order"}):
            with self.subTest(options):
                bent = show("add_deformed_volume", grid, lattice, **options)
                copied, fixed = (show("add_deformed_volume", grid, lattice, mapper=mapper, **options)
                                 for mapper in ("gpu", "fixed_point"))
                at_rest = show("add_volume", grid, mapper="gpu",
                               **{k: v for k, v in options.items() if k != "inverse_mode"})
                self.assertLess(np.abs(bent - copied).mean(), 1.0)
                self.assertGreater(np.abs(bent - at_rest).mean(), 5.0)
                # VTK's mapper of this name draws the same copy in one of two ways, 5 or 6 apart.
                self.assertLess(np.abs(fixed - copied).mean(), np.abs(fixed - at_rest).mean())

    def test_scalar_bar_goes_with_the_actor(self):
        with Scene() as scene:
            actor = scene.plotter.add_deformed_volume(
                ellipsoid(), scalar_bar_args={"n_labels": 3}, clim=(10.0, 90.0))
            self.assertEqual(list(scene.plotter.scalar_bars.keys()), ["density"])
            bar = scene.plotter.scalar_bars["density"]
            self.assertEqual(bar.GetNumberOfLabels(), 3)
            self.assertEqual(bar.GetLookupTable().GetRange(), (10.0, 90.0))
            scene.plotter.remove_actor(actor)
            self.assertEqual(len(scene.plotter.scalar_bars.keys()), 0)

    def test_wrong_arguments(self):
        grid = ellipsoid()
        flags = ellipsoid()
        flags["inside"] = np.array(flags["density"]) > 100.0
        with Scene() as scene:
            add = scene.plotter.add_deformed_volume
            for error, text, arguments, options in (
                    (TypeError, "vtkAbstractTransform", (grid, "twist"), {}),
                    (TypeError, "PolyData", (pv.Sphere(),), {}),
                    (ValueError, "pull_back", (grid,), {"inverse_mode": "inverse"}),
                    (ValueError, "voxels", (grid,), {"position_tolerance": 0.0}),
                    (ValueError, "position_tolerance nan", (grid,), {"position_tolerance": np.nan}),
                    (TypeError, "position_tolerance 'a'", (grid,), {"position_tolerance": "a"}),
                    (TypeError, "fixed_point", (grid,), {"mapper": "fast"}),
                    (TypeError, "tint", (grid,), {"tint": "red"}),
                    (TypeError, "'inside' are bool", (flags,), {"scalars": "inside"}),
                    *((TypeError, "'inside' are bool", (flags, grid.ffd.lattice(4)),
                       {"scalars": "inside", "mapper": mapper}) for mapper in ("gpu", "fixed_point")),
                    (pv.MissingDataError, "'none'", (grid,), {"scalars": "none"})):
                with self.subTest(options):
                    with self.assertRaisesRegex(error, text):
                        add(*arguments, **options)
            self.assertEqual(len(scene.plotter.actors), 0)


class TestLattices(unittest.TestCase):
    def test_numpy(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice((4, 5, 6))
        self.assertEqual(lattice.dimensions, (4, 5, 6))
        self.assertEqual(lattice.displacements.shape, (4, 5, 6, 3))
        point = [0.0, 0.0, 0.0]
        for ijk in ((0, 0, 0), (3, 1, 2), (1, 4, 5)):
            lattice.GetRestPoint(*ijk, point)
            np.testing.assert_allclose(lattice.rest_points[ijk], point)
            lattice.displacements[ijk] = (1.0, 2.0, ijk[0])
            lattice.GetDisplacement(*ijk, point)
            self.assertEqual(point, [1.0, 2.0, ijk[0]])
        time = lattice.GetMTime()
        lattice.displacements[1] += 1.0
        self.assertGreater(lattice.GetMTime(), time)
        lattice.displacements = (2.0, -1.0, 0.5)
        np.testing.assert_allclose(lattice.transform((10.0, 5.0, 20.0)), (12.0, 4.0, 20.5))
        lattice.points = lattice.rest_points * 2.0
        inside = np.array(grid.center) + ((1.0, 2.0, 3.0), (-4.0, 0.0, 5.0))
        np.testing.assert_allclose(lattice.transform(inside), 2.0 * inside)
        np.testing.assert_allclose(np.array(lattice.net().points).reshape(6, 5, 4, 3),
                                   lattice.points.transpose(2, 1, 0, 3))
        other = vtkffd.pyvista.Lattice(8, grid.bounds, 0.0).apply_shape("twist", 0.5)
        self.assertAlmostEqual(np.abs(other.displacements
                                      - grid.ffd.lattice(8, "twist", 0.5).displacements).max(), 0.0)
        for make in (lambda: grid.ffd.lattice(3), lambda: grid.ffd.lattice(5.5),
                     lambda: grid.ffd.lattice(5, "knot"), lambda: grid.ffd.lattice(5, "bend", np.nan),
                     lambda: vtkffd.pyvista.Lattice(5, (1, 0, 0, 1, 0, 1)),
                     lambda: vtkffd.pyvista.Lattice(5, displacements=np.inf),
                     lambda: vtkffd.pyvista.Lattice(5, displacements=np.zeros((4, 5, 5, 3))),
                     lambda: lattice.transform(((1.0, 2.0),))):
            self.assertRaises(ValueError, make)
        self.assertTrue(np.isfinite(lattice.displacements).all())

    def test_messages_say_what_to_give(self):
        grid = ellipsoid()
        lattice, point = grid.ffd.lattice(5), pv.PolyData([[1.0, 2.0, 3.0]])
        make = vtkffd.pyvista.Lattice
        for error, text, call in (
                *((ValueError, "dimensions .*: one integer or three",
                   lambda bad=bad: make(bad)) for bad in (
                       (4, 4), 4.0, None, "5", (4, 4, 3), [[4], [5, 6]])),
                *((ValueError, "bounds .*xmin, xmax", lambda bad=bad: make(5, bad))
                  for bad in ((0, 1), "box", (0, 1, 0, 1, 0, np.nan), (0, None, 0, 1, 0, 1))),
                (ValueError, "bounds .* are too large", lambda: make(5, (0, 1e300, 0, 1, 0, 1))),
                (ValueError, "bounds .* are a point", lambda: make(5, (1, 1, 2, 2, 3, 3))),
                (ValueError, "bounds .* are a point", lambda: point.ffd.lattice()),
                (ValueError, "bounds .*xmin, xmax", lambda: pv.PolyData().ffd.lattice()),
                (ValueError, "background_value nan: a finite number",
                 lambda: grid.ffd.resample(lattice, background_value=np.nan)),
                (ValueError, "spacing .* finite",
                 lambda: grid.ffd.resample(lattice, spacing=(1.0, np.inf, 1.0))),
                (TypeError, "background_value 'air': a number",
                 lambda: grid.ffd.resample(lattice, background_value="air")),
                (ValueError, "strength inf: a finite", lambda: make().apply_shape("bend", np.inf)),
                (TypeError, "strength None: a number", lambda: make().apply_shape("bend", None))):
            with self.subTest(text):
                self.assertRaisesRegex(error, text, call)

    def test_pictures_follow_the_lattice(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice(5)
        with Scene() as scene:
            actor = scene.plotter.add_deformed_volume(grid, lattice, show_scalar_bar=False)
            actor.prop.interpolation_type = "linear"
            self.assertIs(actor.mapper.lattice, lattice)
            before = scene.picture()
            lattice.displacements[2, 2, 2] += (0.0, 0.0, 25.0)
            after = scene.picture()
        self.assertGreater(np.abs(after - before).mean(), 2.0)
        np.testing.assert_array_equal(after, show("add_deformed_volume", grid, lattice))

    def test_meshes_images_and_files(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice(6, "bend", 0.6)
        surface = grid.contour([100.0])
        warped = surface.ffd.warp(lattice)
        self.assertIsInstance(warped, pv.PolyData)
        np.testing.assert_allclose(warped.points, lattice.transform(surface.points), atol=1e-4)
        self.assertEqual(grid.ffd.warp(lattice).dimensions, grid.dimensions)

        # The isosurface of the deformed image is the deformed isosurface.
        image = grid.ffd.resample(lattice, spacing=(0.8, 0.8, 0.8), interpolation="cubic")
        np.testing.assert_allclose(image.spacing, 0.8)
        _, closest = warped.find_closest_cell(image.contour([100.0]).points[::50],
                                              return_closest_point=True)
        np.testing.assert_allclose(closest, image.contour([100.0]).points[::50], atol=0.15)

        self.assertIsNone(grid.ffd.attached)
        grid.ffd.attach(lattice)
        path = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "pyvista_attached.vti")
        grid.save(path)
        read = pv.read(path)
        np.testing.assert_allclose(read.ffd.attached.displacements, lattice.displacements)
        np.testing.assert_array_equal(show("add_deformed_volume", read),
                                      show("add_deformed_volume", grid, lattice))
        grid.ffd.attach(None)
        self.assertIsNone(grid.ffd.attached)

        for error, call in ((TypeError, lambda: surface.ffd.resample(lattice)),
                            (TypeError, lambda: surface.ffd.warp(grid)),
                            (TypeError, lambda: grid.ffd.attach(vtkTransform())),
                            (ValueError, lambda: grid.ffd.resample(lattice, spacing=(1, 0, 1))),
                            (ValueError, lambda: grid.ffd.resample(lattice, spacing=(1e-9, 1, 1))),
                            (ValueError, lambda: vtkffd.pyvista.Lattice(2**40)),
                            (ValueError, lambda: vtkffd.pyvista.Lattice().apply_shape(
                                "random", seed=2**40)),
                            (ValueError, lambda: grid.ffd.resample(lattice, interpolation="best"))):
            self.assertRaises(error, call)


class TestWidget(unittest.TestCase):
    def test_drag(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice(5)
        calls = []
        with Scene() as scene:
            actor = scene.plotter.add_deformed_volume(grid, lattice, show_scalar_bar=False)
            widget = scene.plotter.add_lattice_widget(
                lattice, actor, lambda *arguments: calls.append(arguments), pass_widget=True)
            scene.picture()
            before = scene.picture()
            renderer = scene.plotter.renderer
            renderer.SetWorldPoint(*lattice.points[2, 0, 2], 1.0)
            renderer.WorldToDisplay()
            x, y = (int(round(value)) for value in renderer.GetDisplayPoint()[:2])
            interactor = scene.plotter.iren.interactor
            for event, place in (("MouseMoveEvent", 0), ("LeftButtonPressEvent", 0),
                                 ("MouseMoveEvent", 10), ("MouseMoveEvent", 20),
                                 ("LeftButtonReleaseEvent", 20)):
                interactor.SetEventInformation(x + place, y)
                interactor.InvokeEvent(event)
            moved = np.argwhere(np.abs(lattice.displacements).max(axis=-1) > 0.1)
            self.assertEqual(moved.tolist(), [[2, 0, 2]])
            self.assertEqual(calls, [(lattice, widget)])
            self.assertGreater(np.abs(scene.picture() - before).mean(), 0.2)
            with_widget = scene.picture()
            scene.plotter.clear_lattice_widgets()
            self.assertFalse(widget.GetEnabled())
            self.assertGreater(np.abs(scene.picture() - with_widget).mean(), 1.0)

    def test_callbacks_that_remove_widgets(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice(5)
        for event, again, close in ((event, again, close) for event in ("start", "end", "always")
                                    for again, close in ((False, False), (True, False), (False, True))):
            with self.subTest(event=event, again=again, close=close), Scene() as scene:
                plotter, calls = scene.plotter, []

                def remove(_lattice, plotter=plotter, calls=calls, again=again, close=close):
                    calls.append(1)
                    for _ in range(2):
                        plotter.clear_lattice_widgets()
                        if again:
                            plotter.add_lattice_widget(lattice)
                    if close:
                        plotter.close()

                actor = plotter.add_deformed_volume(grid, lattice, show_scalar_bar=False)
                plotter.add_lattice_widget(lattice, actor, remove, interaction_event=event)
                scene.picture()
                renderer, interactor = plotter.renderer, plotter.iren.interactor
                renderer.SetWorldPoint(*lattice.points[2, 0, 2], 1.0)
                renderer.WorldToDisplay()
                x, y = (int(round(value)) for value in renderer.GetDisplayPoint()[:2])
                for name, place in (("MouseMoveEvent", 0), ("LeftButtonPressEvent", 0),
                                    ("MouseMoveEvent", 10), ("LeftButtonReleaseEvent", 10)):
                    interactor.SetEventInformation(x + place, y)
                    interactor.InvokeEvent(name)
                self.assertEqual(calls, [1])

    def test_events_and_errors(self):
        grid = ellipsoid()
        lattice = grid.ffd.lattice(5)
        with Scene() as scene:
            for bad in ({"callback": 3}, {"lattice": vtkTransform()}):
                with self.assertRaises(TypeError):
                    scene.plotter.add_lattice_widget(**{"lattice": lattice, **bad})
            with self.assertRaisesRegex(ValueError, "always"):
                scene.plotter.add_lattice_widget(lattice, interaction_event="often")
            for actor in ("x", grid):
                with self.assertRaisesRegex(TypeError, "actor must be the pyvista.Volume"):
                    scene.plotter.add_lattice_widget(lattice, actor)
            for bounds in ((0, 1, 0, 1, 0, np.nan), (0, 1), (1, 1, 1, 1, 1, 1)):
                with self.assertRaisesRegex(ValueError, "bounds .*"):
                    scene.plotter.add_lattice_widget(lattice, bounds=bounds)
            # Volumes that VTK's classes have made.
            volume = vtkVolume()
            for bounds in ([0.0, 1.0] * 3, list(grid.bounds)):  # without a mapper: the lattice's domain
                widget = scene.plotter.add_lattice_widget(vtkffd.pyvista.Lattice(), volume)
                outline = [0.0] * 6
                widget.GetLatticeRepresentation().GetOutlineBounds(outline)
                np.testing.assert_allclose(outline, bounds)
                mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
                mapper.SetInputData(grid)
                volume.SetMapper(mapper)
            scene.plotter.clear_lattice_widgets()
            # It is a function, too.
            widget = vtkffd.pyvista.lattice_widget(scene.plotter, lattice, interaction_event="always")
            self.assertTrue(widget.GetEnabled())
        # Closed with the widget on: nothing is left behind.
        plotter, widget = weakref.ref(scene.plotter), None
        scene = None
        gc.collect()
        self.assertIsNone(plotter())


class TestGallery(unittest.TestCase):
    def test_examples(self):
        environment = dict(os.environ)
        if PACKAGES:
            environment["PYTHONPATH"] = PACKAGES + os.pathsep + environment["PYTHONPATH"]
        programs = sorted(glob.glob(os.path.join(SOURCE, "Examples/Python/pyvista/*.py")))
        self.assertEqual(len(programs), 6)
        for program in programs:
            name = os.path.basename(program)[:-3]
            with self.subTest(name):
                path = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "pyvista_%s.png" % name)
                image = path[:-4] + ".vti"
                for old in (path, image):
                    if os.path.exists(old):
                        os.remove(old)
                arguments = [path, image] if name == "export_image" else [path]
                result = subprocess.run([sys.executable, program, *arguments], env=environment,
                                        capture_output=True, text=True, check=False)
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                picture = pv.read(path)
                pixels = np.array(picture.active_scalars)[:, :3].astype(int)
                shown = np.abs(pixels - pixels[len(pixels) // 2 // 100]).max(axis=1) > 20
                self.assertGreater(shown.mean(), 0.03)
                if name == "export_image":
                    self.assertEqual(pv.read(image).spacing, (2.0, 2.0, 2.0))
                # Beside the volume at rest the picture of the deformed one.
                if name in ("bend_engine", "move_surface", "export_image"):
                    width, height, _ = picture.dimensions
                    rows = pixels.reshape(height, width, 3)
                    left, right = rows[:, 5:width // 2 - 5], rows[:, width // 2 + 5:width - 5]
                    self.assertGreater(np.abs(left - right).mean(), 2.0)


if __name__ == "__main__":
    unittest.main()
