#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shape a volume by hand: a window with a volume, the lattice that deforms it, and
vtkFFDLatticeWidget between the two. In the window: h for help.

VOLUME is a .vti file, any image file VTK can read (.mhd, .nii, .nrrd, ...), a legacy .vtk file or a
folder of DICOM slices; default: the engine block. Examples/Cxx/LatticeEditor is the same in C++.
"""

import argparse
import os
import sys

import numpy
import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingUI  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkImageBlend, vtkImageExtractComponents
from vtkmodules.vtkImagingStatistics import vtkImageHistogram
from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkInteractorEventRecorder,
    vtkRenderer,
    vtkRenderWindow,
    vtkRenderWindowInteractor,
    vtkTextActor,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)

import vtkffd
from display import has_display, no_display

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")
REP = vtkffd.vtkFFDLatticeRepresentation
BACKGROUND = (0.10, 0.11, 0.13)

HELP = """\
left        select; shift adds, ctrl toggles
drag        move; from outside with shift/ctrl: region
x y z       along an axis; with shift: across it
g r s       handle: move, turn, scale
a A I       all, none, invert    + - grow, shrink
alt x y z   rows; with shift: planes
o  wheel    soft editing, radius    O falloff
m l v       symmetry, lock, fold guard
d           grab the volume itself; shift-click pins
arrows      nudge; shift far, ctrl fine
Delete      reset selection; shift point, ctrl all
ctrl z y    undo, redo    Escape  cancel

Tab         before / after
[ ]         show more, less of the volume
c n t       curved lines, labels, lattice on/off
F2          refine the lattice (twice the cells)
F5 F9       save, load the lattice (lattice.vti)
F12         save a picture (picture.png)
h q         help, quit"""


class Problem(Exception):
    """What is wrong, in words for the user."""


class Complaints:
    """While it lasts, what VTK complains about is collected, not printed."""

    def __enter__(self):
        self.window = vtkStringOutputWindow()
        self.previous = vtkOutputWindow.GetInstance()
        vtkOutputWindow.SetInstance(self.window)
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        return self

    def __exit__(self, *_):
        vtkOutputWindow.SetInstance(self.previous)
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_INFO)

    def first(self):
        text = self.window.GetOutput()
        return text.split("): ", 1)[-1].split("\n", 1)[0] if text else ""


def read_volume(path):
    """The volume as vtkImageData; Problem if it cannot be used."""
    reader = vtkffd.vtkFFDVolumeReader()
    reader.SetFileName(path)
    with Complaints():
        reader.Update()
    if reader.GetProblem():
        raise Problem(reader.GetProblem())
    image = reader.GetOutput()
    scalars = image.GetPointData().GetScalars()
    if scalars.GetNumberOfComponents() > 1:
        print("lattice_editor: of %d components the first is shown"
              % scalars.GetNumberOfComponents())
        first = vtkImageExtractComponents()
        first.SetInputData(image)
        first.SetComponents(0)
        first.Update()
        image = first.GetOutput()
    return image


def find_threshold(image):
    """The useful range of the scalars, and the one that parts them best (Otsu 1979)."""
    histogram = vtkImageHistogram()
    histogram.SetInputData(image)
    histogram.AutomaticBinningOn()
    histogram.SetMaximumNumberOfBins(1024)
    histogram.GenerateHistogramImageOff()
    histogram.Update()
    counts = vtk_to_numpy(histogram.GetHistogram()).astype(float)
    width, origin = histogram.GetBinSpacing(), histogram.GetBinOrigin()
    bins = numpy.arange(len(counts))
    below = numpy.cumsum(counts)
    above = below[-1] - below
    sums = numpy.cumsum(counts * bins)
    # A few bright voxels do not stretch the range.
    low, high = origin, origin + width * float(numpy.argmax(above <= 0.0005 * below[-1]))
    valid = (below > 0) & (above > 0)
    threshold = origin
    if valid.any():
        gap = numpy.zeros_like(below)
        gap[valid] = sums[valid] / below[valid] - (sums[-1] - sums[valid]) / above[valid]
        threshold += width * (float(numpy.argmax(below * above * gap * gap)) + 0.5)
    if not high > low:
        high = low + 1.0
    return low, high, min(max(threshold, low), high)


def write_picture(picture, path):
    writer = vtkPNGWriter()
    writer.SetInputConnection(picture.GetOutputPort())
    writer.SetFileName(path)
    with Complaints() as complaints:
        writer.Write()
    if complaints.first() or writer.GetErrorCode() != 0:
        raise Problem("%s cannot be written: %s" % (path, complaints.first()))


class Editor:
    def __init__(self, volume, points, lattice):
        self.image = read_volume(volume)
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(points, points, points)
        self.lattice.FitToBounds(self.image.GetBounds())
        if lattice:
            self.load_lattice(lattice)
        self.low, self.high, self.threshold = find_threshold(self.image)
        self.property = vtkVolumeProperty()
        self.set_transfer_functions()
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.SetDeformation(self.lattice)
        self.mapper.StillFrameCoherenceOn()  # the widget renders where the pointer comes to a point
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.set_scene()
        self.message = "h: help"
        self.before = False
        self.used_key = False

    def set_transfer_functions(self):
        t, low = self.threshold, self.low
        high = max(self.high, t + 1e-6 * (self.high - low))
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(t - 0.08 * (high - low), 0.0)
        opacity.AddPoint(t + 0.04 * (high - low), 0.35)
        opacity.AddPoint(high, 0.9)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(low, 0.45, 0.30, 0.25)
        color.AddRGBPoint(t, 0.86, 0.65, 0.48)
        color.AddRGBPoint(0.5 * (t + high), 0.95, 0.88, 0.76)
        color.AddRGBPoint(high, 1.0, 1.0, 1.0)
        self.property.SetScalarOpacity(opacity)
        self.property.SetColor(color)
        self.property.SetScalarOpacityUnitDistance(min(self.image.GetSpacing()))
        self.property.SetInterpolationTypeToLinear()
        self.property.ShadeOn()
        self.property.SetSpecular(0.25)
        self.property.SetSpecularPower(20.0)

    def set_scene(self):
        """The volume, seen from the front."""
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(*BACKGROUND)
        self.renderer.AddVolume(self.volume)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(0.75, -1.0, 0.55)
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetViewUp(0.0, 0.0, 1.0)
        self.renderer.ResetCamera()

    def start(self, size, interactive=False):
        self.window = vtkRenderWindow()
        self.window.SetSize(*size)
        self.window.SetMultiSamples(0)
        self.window.SetWindowName("vtkFFD lattice editor")
        self.window.AddRenderer(self.renderer)
        self.interactor = vtkRenderWindowInteractor()
        self.interactor.SetRenderWindow(self.window)
        self.interactor.SetInteractorStyle(vtkInteractorStyleTrackballCamera())
        self.frames = vtkffd.vtkFFDInteractiveFrames()
        self.status, self.help = vtkTextActor(), vtkTextActor()
        for text in (self.status, self.help):
            text.GetTextProperty().SetFontFamilyToCourier()
            text.GetTextProperty().SetFontSize(14)
            text.GetTextProperty().SetColor(0.9, 0.9, 0.9)
            self.renderer.AddViewProp(text)
        self.status.SetPosition(10, 8)
        self.help.SetInput(HELP)
        self.help.GetTextProperty().SetBackgroundColor(0.0, 0.0, 0.0)
        self.help.GetTextProperty().SetBackgroundOpacity(0.7)
        self.help.SetPosition(10, 40)
        self.help.VisibilityOff()

        self.widget = vtkffd.vtkFFDLatticeWidget()
        self.rep = self.widget.GetLatticeRepresentation()
        self.rep.SetLattice(self.lattice)
        self.rep.SetProp(self.volume)
        self.rep.SetOutlineBounds(self.image.GetBounds())
        # The volume's own surface is what is grabbed, not the lattice in front of it.
        self.picker = vtkffd.vtkFFDVolumePicker()
        self.picker.PickFromListOn()
        self.picker.AddPickList(self.volume)
        self.rep.SetSurfacePicker(self.picker)
        # Before the frame is drawn, so that it tells of what the frame shows.
        self.renderer.AddObserver("StartEvent", lambda *_: self.show_status())
        self.widget.SetInteractor(self.interactor)
        self.widget.KeyPressActivationOff()
        self.widget.SetDefaultRenderer(self.renderer)
        self.widget.AddObserver("WidgetValueChangedEvent", lambda *_: self.say(
            self.rep.GetLastEdit().lower(), False))
        # Ahead of the interactor style, behind the widget (0.5).
        self.key_tag = self.interactor.AddObserver("KeyPressEvent", self.on_key_event, 0.3)
        self.char_tag = self.interactor.AddObserver("CharEvent", self.on_char_event, 0.3)
        self.interactor.Initialize()
        self.renderer.ResetCamera()
        self.widget.On()
        self.renderer.ResetCameraClippingRange()
        if interactive:
            # Coarse pictures before long still ones, which new input aborts.
            self.frames.SetInteractor(self.interactor)
        self.window.Render()
        # Once more for the time of a frame that is not the first.
        self.window.Render()

    def interact(self):
        self.interactor.Start()
        self.frames.SetInteractor(None)

    def say(self, text, aloud=True):
        self.message = text
        if aloud:
            print("lattice_editor: " + text, flush=True)

    def show_status(self):
        rep = self.rep
        parts = ["%4.0f ms " % (1e3 * self.renderer.GetLastRenderTimeInSeconds()),
                 "BEFORE" if self.before else "after",
                 " %d selected" % rep.GetNumberOfSelectedPoints()]
        if rep.GetConstraint() != REP.FREE:
            parts.append(("", "along x", "along y", "along z", "across x", "across y",
                          "across z")[rep.GetConstraint()])
        if rep.GetProportionalEditing():
            falloff = ("smooth", "linear", "sphere", "sharp", "constant")[rep.GetFalloff()]
            parts.append(" soft %s %.1f" % (falloff, rep.GetEffectiveRadius()))
        parts += [" mirror " + axis for axis, on in zip("xyz", rep.GetSymmetry()) if on]
        if rep.GetLockBoundary():
            parts.append(" locked")
        if rep.GetFoldGuard() == REP.GUARD_CLAMP:
            parts.append(" no folds")
        elif rep.GetFoldGuard() == REP.GUARD_WARN:
            parts.append(" FOLDED" if rep.IsFolded() else " fold warning")
        if rep.GetManipulationMode() == REP.VOLUME:
            parts.append(" grab the volume")
        parts += [" undo %d" % rep.GetNumberOfUndos(), " " + self.message]
        self.status.SetInput(" ".join(parts))

    def on_key_event(self, caller, _event):
        self.used_key = self.on_key(caller.GetKeySym())
        caller.GetCommand(self.key_tag).SetAbortFlag(1 if self.used_key else 0)

    def on_char_event(self, caller, _event):
        caller.GetCommand(self.char_tag).SetAbortFlag(1 if self.used_key else 0)
        self.used_key = False

    def on_key(self, key):
        """True if the key meant something."""
        rep = self.rep
        try:
            if key == "h":
                self.help.SetVisibility(not self.help.GetVisibility())
            elif key == "Tab":
                self.before = not self.before
                self.mapper.SetDeformation(None if self.before else self.lattice)
                self.widget.SetEnabled(0 if self.before else 1)
            elif key in ("bracketleft", "bracketright"):
                step = 0.02 * (self.high - self.low) * (-1.0 if key == "bracketleft" else 1.0)
                self.threshold = min(max(self.threshold + step, self.low), self.high)
                self.set_transfer_functions()
            elif key == "c":
                rep.SetLineMode(
                    REP.STRAIGHT if rep.GetLineMode() == REP.CURVED else REP.CURVED)
            elif key == "n":
                rep.SetLabelVisibility(not rep.GetLabelVisibility())
            elif key == "t":
                self.widget.SetEnabled(not self.widget.GetEnabled())
            elif key == "F2":
                if max(self.lattice.GetDimensions()) <= 32 and self.lattice.Refine(2):
                    self.say("%d x %d x %d control points (undo starts anew)"
                             % self.lattice.GetDimensions())
                else:
                    self.say("the lattice is fine enough")
            elif key == "F5":
                self.save_lattice("lattice.vti")
                self.say("lattice.vti saved")
            elif key == "F9":
                self.load_lattice("lattice.vti")
                self.say("lattice.vti loaded")
            elif key == "F12":
                self.save_picture("picture.png")
                self.say("picture.png saved")
            else:
                return False
        except Problem as problem:
            self.say(str(problem))
        self.window.Render()
        return True

    def save_picture(self, path):
        if self.frames.GetInteractor():
            self.frames.RenderStill()
        else:
            self.window.Render()
        capture = vtkWindowToImageFilter()
        capture.SetInput(self.window)
        capture.ShouldRerenderOff()
        capture.ReadFrontBufferOff()
        write_picture(capture, path)

    def save_volume_picture(self, path, size):
        """Without a window: the volume alone."""
        picture, back = vtkImageData(), vtkImageData()
        if not self.mapper.RenderToImage(self.renderer, self.volume, *size, picture):
            raise Problem("%s cannot be made" % path)
        back.DeepCopy(picture)
        for channel, value in enumerate((*BACKGROUND, 1.0)):
            back.GetPointData().GetScalars().FillComponent(channel, round(255.0 * value))
        blend = vtkImageBlend()
        blend.AddInputData(back)
        blend.AddInputData(picture)
        write_picture(blend, path)

    def save_lattice(self, path):
        image = vtkImageData()
        self.lattice.ToImageData(image)
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(image)
        writer.SetDataModeToBinary()  # that every ParaView reads
        writer.SetFileName(path)
        with Complaints() as complaints:
            written = writer.Write()
        if not written or complaints.first():
            raise Problem("%s cannot be written: %s" % (path, complaints.first()))

    def load_lattice(self, path):
        if not os.path.isfile(path):
            raise Problem("the lattice %s cannot be loaded: there is no such file" % path)
        reader = vtkXMLImageDataReader()
        reader.SetFileName(path)
        # The lattice says itself what is wrong with an image.
        with Complaints() as complaints:
            reader.Update()
            adopted = not complaints.first() and self.lattice.FromImageData(reader.GetOutput())
        if not adopted:
            raise Problem("%s is no lattice: %s" % (path, complaints.first()))

    def play(self, path):
        player = vtkInteractorEventRecorder()
        player.SetInteractor(self.interactor)
        player.SetFileName(path)
        player.On()
        player.Play()
        player.Off()


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="in the window:\n" + HELP)
    parser.add_argument("volume", nargs="?", default=os.path.join(DATA, "engine.vti"))
    parser.add_argument("--points", type=int, default=6, help="control points per axis, 4 to 64")
    parser.add_argument("--lattice", help="start with a saved lattice")
    parser.add_argument("--size", type=int, nargs=2, default=(1000, 800), metavar=("W", "H"))
    parser.add_argument("--play", help="play recorded events, then end")
    parser.add_argument("--screenshot", help="write a picture (.png), then end")
    parser.add_argument("--save-lattice", help="write the lattice (.vti) at the end")
    arguments = parser.parse_args()
    if not 4 <= arguments.points <= 64:
        sys.exit("lattice_editor: --points: from 4 to 64 control points per axis")
    if min(arguments.size) < 100 or max(arguments.size) > 16384:
        sys.exit("lattice_editor: --size: from 100 to 16384 pixels each way")
    if arguments.screenshot and not arguments.screenshot.lower().endswith(".png"):
        sys.exit("lattice_editor: --screenshot: the name of a .png file")
    if arguments.play and not os.path.isfile(arguments.play):
        sys.exit("lattice_editor: %s cannot be played: there is no such file" % arguments.play)
    try:
        editor = Editor(arguments.volume, arguments.points, arguments.lattice)
    except Problem as problem:
        text = str(problem)
        sys.exit("lattice_editor: " + (
            text if "lattice" in text else "%s: %s" % (arguments.volume, text)))
    unattended = arguments.screenshot or arguments.save_lattice
    window = has_display(on_screen=not arguments.play and not unattended)
    if not window and (arguments.play or not unattended):
        sys.exit("lattice_editor: " + no_display())
    if window:
        editor.start(arguments.size, not arguments.play and not unattended)
    if arguments.play:
        editor.play(arguments.play)
    elif not unattended:
        editor.interact()
    try:
        if arguments.screenshot and window:
            editor.save_picture(arguments.screenshot)
        elif arguments.screenshot:
            print("lattice_editor: %s The picture shows the volume alone." % no_display())
            editor.save_volume_picture(arguments.screenshot, arguments.size)
        if arguments.save_lattice:
            editor.save_lattice(arguments.save_lattice)
    except Problem as problem:
        sys.exit("lattice_editor: " + str(problem))


if __name__ == "__main__":
    main()
