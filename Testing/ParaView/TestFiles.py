#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Transform files in ParaView: opened, applied to a volume, and played as a series in time; and lattices
that are fitted to landmarks."""

import contextlib
import io
import os
import sys
import unittest
from unittest import mock

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdevents
import ffdparaview as ffd

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))
import ffdvolumefiles  # noqa: E402

ffd.load()

TRANSFORMS = os.path.join(ffd.DATA, "Transforms")
EXAMPLES = os.path.join(os.path.dirname(os.environ["FFD_PARAVIEW_SOURCE"]), "Examples", "Python")
SHIFT = np.repeat((3.0, -7.0, 11.0), 2)


class TestFiles(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        ffd.load()
        self.view = ffd.make_view()
        self.wavelet = ffd.make_wavelet()
        ffd.set_functions()

    def shown_bounds(self):
        simple.Render(self.view)
        return np.array(self.view.SMProxy.GetRenderer().ComputeVisiblePropBounds())

    def test_open_and_apply(self):
        """Shown as FFD Volume, where the registration says, and so are slices; the other options count."""
        reader = simple.OpenDataFile(ffdevents.write_translation(ffd.TEMPORARY))
        self.assertEqual(reader.SMProxy.GetXMLName(), "FFDTransformReader")
        volume = simple.FFDApplyTransform(Input=self.wavelet, Transform=reader)
        display = simple.Show(volume, self.view)
        self.assertEqual(display.Representation, "FFD Volume")
        rest = np.array([-15.0, 15.0] * 3)
        np.testing.assert_allclose(self.shown_bounds(), rest - SHIFT, atol=0.01)
        shown = ffd.picture(self.view, "files shift")
        # What it looks like: the volume itself, moved.
        simple.Hide(volume, self.view)
        moved = simple.Show(self.wavelet, self.view)
        moved.SetRepresentationType("FFD Volume")
        ffd.translate(moved, list(-SHIFT[::2]))
        self.assertGreater(ffd.lit(shown), 500)
        self.assertLess(ffd.differ(ffd.picture(self.view, "files moved"), shown)[1], 0.2)
        simple.Hide(self.wavelet, self.view)
        contour = simple.Contour(Input=volume, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
        simple.Show(contour, self.view)
        at_rest = np.array(contour.GetDataInformation().GetBounds())
        np.testing.assert_allclose(self.shown_bounds(), at_rest - SHIFT, atol=0.01)
        reader.PullBack = 0
        np.testing.assert_allclose(self.shown_bounds(), at_rest + SHIFT, atol=0.01)
        reader.Coordinates = "RAS"
        np.testing.assert_allclose(
            self.shown_bounds(), at_rest + SHIFT * [-1, -1, -1, -1, 1, 1], atol=0.01)

    def test_open_volumes(self):
        """NIfTI volumes are opened as such, fields as transforms."""
        from vtkmodules.vtkIOImage import vtkNIFTIImageWriter
        names = [os.path.join(ffd.TEMPORARY, "volume%d.nii" % i) for i in range(2)]
        self.wavelet.UpdatePipeline()
        for name in names:
            writer = vtkNIFTIImageWriter()
            writer.SetFileName(name)
            writer.SetInputData(simple.servermanager.Fetch(self.wavelet))
            writer.Write()
        volumes = simple.OpenDataFile(names)
        self.assertEqual(volumes.SMProxy.GetXMLName(), "FFDVolumeReader")
        self.assertEqual(list(volumes.TimestepValues), [0.0, 1.0])
        self.assertEqual(simple.Show(volumes, self.view).Representation, "FFD Volume")
        field = simple.OpenDataFile(os.path.join(TRANSFORMS, "field_oblique.nii"))
        self.assertEqual(field.SMProxy.GetXMLName(), "FFDTransformReader")

    def test_open_dicom(self):
        """File > Open of a slice offers the reader of its folder that keeps the orientation."""
        folder = os.path.join(ffd.TEMPORARY, "paraview-dicom")
        ffdvolumefiles.write_dicom(folder)
        slices = [os.path.join(folder, name) for name in os.listdir(folder)]
        for i, name in enumerate(slices):
            if not name.endswith(".dcm"):
                os.replace(name, name + ".dcm")
                slices[i] = name + ".dcm"
        factory = simple.servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
        readers = factory.GetReaders(slices[0], simple.servermanager.ActiveConnection.Session)
        names = [readers.GetString(i) for i in range(readers.GetNumberOfStrings())]
        self.assertIn("FFDDICOMReader", names)
        for name in (folder, slices[0]):
            volume = simple.FFDDICOMReader(FileName=name)
            volume.UpdatePipeline()
            image = simple.servermanager.Fetch(volume)
            self.assertEqual(image.GetDimensions(), ffdvolumefiles.SIZE)
            for i, j, k in ((0, 0, 0), (3, 4, 5), (11, 10, 9), (10, 5, 4)):
                place = ffdvolumefiles.position(i, j, k)
                # Within the outermost voxels, whatever is rounded.
                point = image.FindPoint(place + 1e-3 * (ffdvolumefiles.position(5, 5, 5) - place))
                np.testing.assert_allclose(image.GetPoint(point), place, atol=1e-3)
                self.assertEqual(image.GetPointData().GetScalars().GetTuple1(point),
                                 ffdvolumefiles.voxels()[k, j, i])
            self.assertEqual(simple.Show(volume, self.view).Representation, "FFD Volume")

    def test_resample(self):
        """Of what has not been read yet, so that no array could be chosen."""
        lattice = simple.FFDLattice(Input=simple.Wavelet(WholeExtent=[-5, 5] * 3), Shape="Bend")
        resampled = simple.FFDResampleToImage(Input=lattice)
        with ffd.Errors() as errors:
            resampled.UpdatePipeline()
        self.assertEqual(errors.text, [])
        self.assertEqual(resampled.PointData.keys(), ["RTData"])
        self.assertGreater(resampled.PointData["RTData"].GetRange()[1], 200.0)

    def test_oriented_volume(self):
        """ParaView does not pass on the direction of a volume; filters find it."""
        name = os.path.join(ffd.TEMPORARY, "oriented.nhdr")
        np.arange(4096, dtype=np.float32).tofile(os.path.join(ffd.TEMPORARY, "oriented.raw"))
        for row in ("(-1,0,0) (0,-1,0)", "(.8,.6,0) (-.6,.8,0)"):
            with open(name, "w", encoding="ascii") as file:
                file.write("NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\n"
                           "sizes: 16 16 16\nspace directions: %s (0,0,1)\nendian: little\n"
                           "encoding: raw\nspace origin: (5,-3,2)\ndata file: oriented.raw\n" % row)
            volume = simple.FFDVolumeReader(FileNames=[name])
            volume.UpdatePipeline()
            bounds = np.array(volume.GetDataInformation().GetBounds())
            for shape in ("None", "Twist"):
                lattice = simple.FFDLattice(Input=volume, Shape=shape)
                resampled = simple.FFDResampleToImage(Input=lattice, BackgroundLevel=-1.0)
                resampled.UpdatePipeline()
                information = resampled.GetDataInformation()
                if shape == "None":
                    np.testing.assert_allclose(information.GetBounds(), bounds, atol=1e-9)
                    self.assertEqual(resampled.PointData[0].GetRange(), (0.0, 4095.0))
                else:
                    output = resampled.SMProxy.GetClientSideObject().GetOutputDataObject(0)
                    values = ffd.vtk_to_numpy(output.GetPointData().GetScalars())
                    self.assertGreater(np.count_nonzero(values >= 0.0), 3000)
            # Landmarks within it: the lattice covers all of it, with its margin of control points.
            middle = (bounds[::2] + bounds[1::2]) / 2.0
            before = middle + [[-2, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
            lines = [simple.PolyLineSource(Points=points.ravel().tolist())
                     for points in (before, before + [0.5, 0.3, 0.0])]
            fit = simple.FFDFitLattice(SourceLandmarks=lines[0], TargetLandmarks=lines[1], Volume=volume)
            fit.UpdatePipeline()
            points = fit.SMProxy.GetClientSideObject().GetOutputDataObject(0)
            covered = np.array(points.GetBounds()).reshape(3, 2)
            covered += np.outer(points.GetSpacing(), (1.0, -1.0))
            np.testing.assert_allclose(covered.ravel(), bounds, atol=1e-9)

    def test_series(self):
        """A stack of elastix is played: at its times, and between them."""
        reader = simple.FFDTransformReader(
            FileNames=[os.path.join(TRANSFORMS, "elastix5_stack.txt")])
        volume = simple.FFDApplyTransform(Input=self.wavelet, Transform=reader)
        simple.Show(volume, self.view)
        self.assertEqual(list(reader.TimestepValues), [1.0, 1.5, 2.0, 2.5])
        scene = simple.GetAnimationScene()
        scene.UpdateAnimationUsingDataTimeSteps()
        self.assertEqual((scene.StartTime, scene.EndTime), (1.0, 2.5))
        pictures = {}
        for time in (1.0, 1.25, 1.5, 2.5):
            scene.AnimationTime = time
            pictures[time] = ffd.picture(self.view, "files time %g" % time)
        for earlier, later in ((1.0, 1.25), (1.25, 1.5), (1.5, 2.5)):
            self.assertGreater(ffd.differ(pictures[earlier], pictures[later])[1], 0.3)
        reader.Interpolation = "Step"
        scene.AnimationTime = 1.25
        self.assertLess(ffd.differ(ffd.picture(self.view, "files step"), pictures[1.0])[1], 0.05)
        # The player steps through them.
        shown = []
        self.view.SMProxy.AddObserver("EndEvent", lambda *_: shown.append(self.view.ViewTime))
        scene.PlayMode = "Snap To TimeSteps"
        scene.Play()
        self.assertLessEqual({1.5, 2.0, 2.5}, set(shown))
        # Files of their own, with times that are asked for.
        files = simple.FFDTransformReader(
            FileNames=[os.path.join(TRANSFORMS, name) for name in (
                "elastix5_euler.txt", "elastix5_chain.txt")], TimeStart=2.0, TimeSpacing=0.25)
        self.assertEqual(list(files.TimestepValues), [2.0, 2.25])

    def test_volumes_in_time(self):
        """The example plays a volume and a field for each phase; each file is read once."""
        sys.path.insert(0, EXAMPLES)
        import paraview_series
        picture = os.path.join(ffd.TEMPORARY, "ParaView.files breathing.png")
        output = io.StringIO()
        with mock.patch.object(sys, "argv", [
                "paraview_series.py", "--size=24", "--phases=3", "--frames=2", "--loops=2",
                "--pixels", "120", "100", "--picture", picture]), \
                contextlib.redirect_stdout(output):
            paraview_series.main()
        self.assertIn("loop 2", output.getvalue())
        self.assertIn("files read so far: 3\n", output.getvalue())
        self.assertGreater(ffd.lit(np.abs(ffd.read_picture(picture) - ffd.read_picture(
            picture)[0, 0])), 1000)
        # What the example leaves at its default.
        volumes = simple.FindSource("FFDVolumeReader1")
        names = [os.path.join(ffd.TEMPORARY, "phase%d.mha" % i) for i in range(2)]
        for name, value in zip(names, (0, 100)):
            paraview_series.write_image(name, np.full((4, 4, 4), value, np.uint8), (1.0,) * 3)
        volumes.FileNames = names
        volumes.TimeStart = 5.0
        volumes.TimeSpacing = 2.0
        volumes.UpdatePipelineInformation()
        self.assertEqual(list(volumes.TimestepValues), [5.0, 7.0])

        def value_at(time):
            volumes.UpdatePipeline(time)
            return volumes.PointData[0].GetRange(0)[0]

        self.assertEqual([value_at(time) for time in (5.0, 6.0, 7.0)], [0.0, 0.0, 100.0])
        volumes.Interpolation = "Linear"
        self.assertEqual(value_at(6.0), 50.0)
        reader = volumes.SMProxy.GetClientSideObject()
        volumes.CacheSize = 7
        volumes.Prefetch = 0
        volumes.UpdatePipeline(5.0)
        for line in ("CacheSize: 7", "Prefetch: 0"):
            self.assertIn(line, str(reader))

    def test_landmarks(self):
        """Pairs of points, as two poly lines that are placed by mouse, move a volume; residuals are
        told."""
        before = np.array([[-8, -8, -8], [8, -8, 0], [0, 9, 3], [2, 3, 9], [-5, 4, -7], [6, 6, 6]], float)
        after = before + np.stack([2 * np.sin(before[:, 1] / 5), 1 + 0 * before[:, 0],
                                   -0.2 * before[:, 0]], axis=1)
        lines = [simple.PolyLineSource(Points=points.ravel().tolist()) for points in (before, after)]
        fit = simple.FFDFitLattice(SourceLandmarks=lines[0], TargetLandmarks=lines[1])

        def residuals():
            fit.UpdatePipeline()
            fit.UpdatePropertyInformation()
            data = simple.servermanager.Fetch(fit, idx=1)
            self.assertEqual(data.GetNumberOfPoints(), 12)
            points = np.array([data.GetPoint(i) for i in range(12)])
            np.testing.assert_allclose(points[6:], after, atol=1e-5)
            distances = np.linalg.norm(points[:6] - points[6:], axis=1)
            values = ffd.vtk_to_numpy(data.GetPointData().GetArray("Residual"))
            np.testing.assert_allclose(values, np.concatenate([distances, np.zeros(6)]), atol=1e-9)
            vectors = ffd.vtk_to_numpy(data.GetPointData().GetArray("ResidualVector"))
            np.testing.assert_allclose(vectors[:6], points[6:] - points[:6], atol=1e-9)
            largest = fit.GetPropertyValue("LargestResidual")
            self.assertAlmostEqual(largest, distances.max(), places=9)
            self.assertAlmostEqual(fit.GetPropertyValue("RootMeanSquareResidual"),
                                   np.sqrt((distances ** 2).mean()), places=9)
            return largest

        self.assertLess(residuals(), 0.1)
        small = fit.GetDataInformation(0).GetBounds()
        fit.Volume = self.wavelet
        self.assertLess(residuals(), 0.1)
        large = fit.GetDataInformation(0).GetBounds()
        self.assertLess(large[0], min(small[0], -15.0))
        self.assertGreater(large[5], 15.0)
        moved = simple.FFDApplyTransform(Input=self.wavelet, Transform=simple.OutputPort(fit, 0))
        simple.Show(moved, self.view)
        rest = np.array([-15.0, 15.0] * 3)
        self.assertGreater(np.abs(self.shown_bounds() - rest).max(), 1.0)
        shown = ffd.picture(self.view, "files landmarks")
        fit.Tolerance = 1e-3
        fine = residuals()
        self.assertLess(fine, 1e-3)
        fit.MaximumCells = 1
        fit.Smoothness = 100.0
        self.assertGreater(residuals(), 0.2)
        self.assertEqual(fit.GetDataInformation(0).GetNumberOfPoints(), 64)
        fit.MaximumCells = 64
        fit.Smoothness = 1e-6
        # The mouse moves a landmark.
        lines[1].Points = (after + 2.0).ravel().tolist()
        after = after + 2.0
        self.assertLess(residuals(), 1e-3)
        self.assertGreater(ffd.differ(ffd.picture(self.view, "files landmarks moved"), shown)[1], 1.0)
        with ffd.Errors() as errors:
            lines[1].Points = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
            fit.UpdatePipeline()
        self.assertTrue(errors.say("6 source landmarks", "2 target landmarks"), errors.text)
        self.assertEqual(len(errors.text), 1, errors.text)

    def test_errors(self):
        """Say which file, and the volume is shown undeformed."""
        broken = os.path.join(ffd.TEMPORARY, "broken.tfm")
        with open(broken, "w", encoding="ascii") as file:
            file.write("#Insight Transform File V1.0\n")
        with ffd.Errors() as errors:
            reader = simple.FFDTransformReader(FileNames=[broken])
            reader.UpdatePipeline()
        self.assertTrue(errors.say("broken.tfm", "no transform"), errors.text)

    def test_state(self):
        """A state restores files and options."""
        reader = simple.FFDTransformReader(
            FileNames=[os.path.join(TRANSFORMS, "elastix5_stack.txt")], FitTolerance=0.05)
        volume = simple.FFDApplyTransform(Input=self.wavelet, Transform=reader)
        simple.Show(volume, self.view)
        simple.GetAnimationScene().AnimationTime = 1.5
        before = ffd.picture(self.view, "files before")
        state = os.path.join(ffd.TEMPORARY, "files.pvsm")
        simple.SaveState(state)
        simple.ResetSession()
        ffd.load()
        simple.LoadState(state)
        after = ffd.picture(simple.GetActiveView(), "files after")
        self.assertLess(ffd.differ(before, after)[1], 0.01)


if __name__ == "__main__":
    unittest.main()
