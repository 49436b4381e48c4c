#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The lattice editors in C++ and Python, run as their users do: recorded events end in the same
lattice and a picture that shows it; files that cannot be used are named with what is wrong.

usage: TestLatticeEditor.py PROGRAM   (the C++ editor)
"""

import os
import subprocess
import sys
import unittest

import numpy
import vtkffd
import ffdvolumefiles
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkMetaImageWriter, vtkPNGReader
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

DATA = os.environ["FFD_TEST_DATA"]
WORK = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "LatticeEditor")
SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PROGRAM = sys.argv.pop(1)
EDITORS = {
    "cxx": [PROGRAM],
    "python": [sys.executable, os.path.join(SOURCE, "Examples", "Python", "lattice_editor.py")],
}


def key(symbol, code=0, modifiers=0):
    return "".join("%s 200 150 %d %d 0 %s\n" % (event, modifiers, code, symbol)
                   for event in ("KeyPressEvent", "CharEvent", "KeyReleaseEvent"))


# Grab the volume in the middle of the window and pull it up; look at it before and after; refine
# (which changes nothing but the control points); take the lines off their straight course.
RECORDING = (
    "# StreamVersion 1.1\n" + key("d", 100) +
    "MouseMoveEvent 200 150 0 0 0 d\nLeftButtonPressEvent 200 150 0 0 0 d\n"
    "MouseMoveEvent 205 165 0 0 0 d\nMouseMoveEvent 210 180 0 0 0 d\n"
    "LeftButtonReleaseEvent 210 180 0 0 0 d\n" +
    key("Tab", 9) + key("Tab", 9) + key("F2") + key("c", 99) + key("h", 104) + key("h", 104))


def run(editor, *arguments, environment=None):
    return subprocess.run([*EDITORS[editor], *arguments], cwd=WORK, capture_output=True, text=True,
                          check=False, env=environment)


# Without X, and with a server that is not there.
NO_DISPLAY = [{name: value for name, value in os.environ.items() if name != "DISPLAY"},
              {**os.environ, "DISPLAY": ":977"}]


def read_image(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(
        image.GetDimensions()[1], image.GetDimensions()[0], -1).astype(int)


class TestLatticeEditor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        os.makedirs(os.path.join(WORK, "empty"), exist_ok=True)
        with open(os.path.join(WORK, "recording.log"), "w", encoding="ascii") as file:
            file.write(RECORDING)
        with open(os.path.join(WORK, "bad.vti"), "w", encoding="ascii") as file:
            file.write("this is no XML")
        with open(os.path.join(WORK, "bad.mhd"), "w", encoding="ascii") as file:
            file.write("ObjectType = Image\nNDims = 3\nDimSize = 9 9 9\n"
                       "ElementType = MET_UCHAR\nElementDataFile = gone.raw\n")
        with open(os.path.join(WORK, "text.txt"), "w", encoding="ascii") as file:
            file.write("words")

    def test_recorded_session(self):
        lattices = {}
        for editor in EDITORS:
            with self.subTest(editor):
                result = run(editor, os.path.join(DATA, "fuel.vti"), "--size", "400", "300",
                             "--play", "recording.log", "--screenshot", editor + ".png",
                             "--save-lattice", editor + ".vti")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn("control points", result.stdout)
                reader = vtkXMLImageDataReader()
                reader.SetFileName(os.path.join(WORK, editor + ".vti"))
                reader.Update()
                lattice = vtkffd.vtkFFDLattice()
                self.assertEqual(lattice.FromImageData(reader.GetOutput()), 1)
                self.assertEqual(lattice.GetDimensions(), (9, 9, 9))
                lattices[editor] = vtk_to_numpy(lattice.GetDisplacements()).copy()
                self.assertGreater(numpy.abs(lattices[editor]).max(), 1.0)
                # The volume, not only background and lines, is in the middle of the picture.
                picture = read_image(os.path.join(WORK, editor + ".png"))
                self.assertEqual(picture.shape[:2], (300, 400))
                middle = picture[100:220, 140:260]
                self.assertGreater((middle.max(axis=2) - middle.min(axis=2) > 15).mean(), 0.1)
        numpy.testing.assert_allclose(lattices["cxx"], lattices["python"], atol=1e-9)

    def test_files_of_other_kinds(self):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(os.path.join(DATA, "fuel.vti"))
        writer = vtkMetaImageWriter()
        writer.SetInputConnection(reader.GetOutputPort())
        writer.SetFileName(os.path.join(WORK, "fuel.mhd"))
        writer.Write()
        # Constant scalars, none of them finite: no threshold to be found, no crash.
        flat = vtkImageData()
        flat.SetDimensions(5, 5, 5)
        flat.AllocateScalars(10, 1)
        flat.GetPointData().GetScalars().Fill(7.0)
        flat_writer = vtkXMLImageDataWriter()
        flat_writer.SetInputData(flat)
        flat_writer.SetFileName(os.path.join(WORK, "flat.vti"))
        flat_writer.Write()
        for editor in EDITORS:
            for name in ("fuel.mhd", "flat.vti"):
                with self.subTest((editor, name)):
                    result = run(editor, name, "--size", "200", "150", "--points", "4",
                                 "--screenshot", "kind.png")
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(result.stderr, "")

    def test_patients_are_the_right_way_round(self):
        """The same volume from files of all kinds: the same picture."""
        ffdvolumefiles.write_dicom(os.path.join(WORK, "dicom"))
        ffdvolumefiles.write_nifti(os.path.join(WORK, "body.nii"), "qform")
        ffdvolumefiles.write_nifti(os.path.join(WORK, "body.nii.gz"), "sform")
        ffdvolumefiles.write_nrrd(os.path.join(WORK, "body.nrrd"), "right-anterior-superior")
        ffdvolumefiles.write_nrrd(os.path.join(WORK, "body.nhdr"), "left-posterior-superior")
        image = vtkImageData()
        image.SetDimensions(*ffdvolumefiles.SIZE)
        image.SetSpacing(*ffdvolumefiles.SPACING)
        image.SetOrigin(*ffdvolumefiles.ORIGIN)
        image.SetDirectionMatrix(*ffdvolumefiles.DIRECTION.ravel())
        values = ffdvolumefiles.voxels()
        for name, voxels in (("body.vti", values), ("turned.vti", values[::-1, ::-1])):
            image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
            writer = vtkXMLImageDataWriter()
            writer.SetInputData(image)
            writer.SetFileName(os.path.join(WORK, name))
            writer.Write()

        def picture(editor, name):
            # Without lattice and status line.
            result = run(editor, name, "--size", "240", "200", "--screenshot", "body.png",
                         environment=NO_DISPLAY[0])
            self.assertEqual(result.returncode, 0, result.stderr)
            return read_image(os.path.join(WORK, "body.png"))

        expected = picture("cxx", "body.vti")
        self.assertGreater(numpy.abs(picture("cxx", "turned.vti") - expected).mean(), 2.0)
        for editor, name in (("cxx", "dicom"), ("cxx", "body.nii"), ("cxx", "body.nrrd"),
                             ("python", "dicom"), ("python", "body.nii.gz"),
                             ("python", "body.nhdr")):
            with self.subTest((editor, name)):
                self.assertLess(numpy.abs(picture(editor, name) - expected).mean(), 0.5)

    def test_without_a_display(self):
        for editor in EDITORS:
            for environment in NO_DISPLAY:
                with self.subTest((editor, environment.get("DISPLAY"))):
                    fuel = os.path.join(DATA, "fuel.vti")
                    result = run(editor, fuel, environment=environment)
                    self.assertEqual(result.returncode, 1)
                    self.assertIn("no window can be opened", result.stderr)
                    self.assertEqual(len(result.stderr.splitlines()), 1)
                    # What needs no window goes on.
                    result = run(editor, fuel, "--size", "120", "100", "--screenshot", "alone.png",
                                 "--save-lattice", "alone.vti", environment=environment)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertIn("volume alone", result.stdout)
                    picture = read_image(os.path.join(WORK, "alone.png"))
                    self.assertEqual(picture.shape[:2], (100, 120))
                    self.assertEqual(picture[0, 0].tolist()[:3], [26, 28, 33])
                    self.assertGreater((numpy.ptp(picture[..., :3], axis=2) > 15).mean(), 0.02)
                    os.remove(os.path.join(WORK, "alone.png"))
                    os.remove(os.path.join(WORK, "alone.vti"))

    def test_status_line_is_that_of_its_frame(self):
        sys.path.insert(0, os.path.dirname(EDITORS["python"][1]))
        from lattice_editor import Editor
        editor = Editor(os.path.join(DATA, "fuel.vti"), 4, None)
        editor.start((300, 200))
        shown = []
        # When the props are drawn.
        editor.renderer.AddObserver("StartEvent", lambda *_: shown.append(
            editor.status.GetInput()), -1.0)
        before = os.getcwd()
        os.chdir(WORK)
        try:
            for symbol, text in (("F5", "saved"), ("F2", "control points"), ("F9", "loaded")):
                shown.clear()
                editor.on_key(symbol)
                self.assertIn(text, shown[-1])
        finally:
            os.chdir(before)
        editor.rep.SelectPoint(1, 1, 1)
        editor.rep.TranslateSelection(1.0, 0.0, 0.0)
        editor.window.Render()
        self.assertIn("1 selected", shown[-1])
        self.assertIn("undo 1", shown[-1])

    def test_saved_picture_is_the_still_one(self):
        sys.path.insert(0, os.path.dirname(EDITORS["python"][1]))
        from lattice_editor import Editor
        pictures = []
        for interactive in (False, True):
            editor = Editor(os.path.join(DATA, "fuel.vti"), 4, None)
            editor.mapper.SetSampleDistance(0.02)
            editor.mapper.SetInteractiveSampleDistance(3.0)
            editor.start((200, 150), interactive)
            editor.status.VisibilityOff()
            editor.frames.SetLongestWait(0.0)
            if interactive:
                editor.renderer.GetActiveCamera().Modified()
                editor.window.Render()
                self.assertTrue(editor.frames.IsStillFrameDue())
            editor.save_picture(os.path.join(WORK, "saved.png"))
            pictures.append(read_image(os.path.join(WORK, "saved.png")))
            editor.frames.SetInteractor(None)
        self.assertGreater((numpy.ptp(pictures[0], axis=2) > 15).mean(), 0.02)
        self.assertLessEqual(numpy.abs(pictures[0] - pictures[1]).max(), 1)

    def test_bad_files_are_named(self):
        cases = (
            (("missing.vti",), "missing.vti: there is no such file or folder"),
            (("bad.vti",), "bad.vti: it cannot be read"),
            (("bad.mhd",), "bad.mhd: the data file 'gone.raw' that it names: it cannot be opened"),
            (("text.txt",), "text.txt: VTK has no reader for it"),
            (("empty",), "empty: no DICOM slices were found in it"),
            ((os.path.join(DATA, "Baseline", "TestImageDeformedHead.png"),), "300 x 300 x 1 voxels"),
            (("--lattice", "missing.vti"), "missing.vti cannot be loaded"),
            (("--lattice", "bad.vti"), "bad.vti is no lattice"),
            (("--lattice", os.path.join(DATA, "fuel.vti")), "is no lattice"),
            (("--points", "3"), "from 4 to 64"),
            (("--size", "1", "1"), "--size"),
            (("--play", "missing.log"), "missing.log cannot be played"),
            (("--nonsense",), "--nonsense"),
        )
        for editor in EDITORS:
            for arguments, text in cases:
                with self.subTest((editor, arguments)):
                    # Were it opened, it would not wait for a user.
                    result = run(editor, *arguments, "--screenshot", "unused.png")
                    self.assertNotEqual(result.returncode, 0)
                    self.assertIn(text, result.stderr)
                    self.assertNotIn("Traceback", result.stderr)


if __name__ == "__main__":
    unittest.main()
