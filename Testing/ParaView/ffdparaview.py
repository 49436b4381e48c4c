# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the ParaView tests share: loading the plugin, scenes, pictures and their comparison.

From the environment: FFD_PARAVIEW_PLUGIN, the plugin's library; FFD_TEST_DATA, FFD_TEST_BASELINE
and FFD_TEST_TEMPORARY, folders.
"""

import os
import subprocess
import sys

import numpy as np
import ffdsession  # noqa: F401, before paraview.simple
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

PLUGIN = os.environ["FFD_PARAVIEW_PLUGIN"]
TEMPORARY = os.environ["FFD_TEST_TEMPORARY"]
DATA = os.environ["FFD_TEST_DATA"]


def load(remote=False):
    """Load the plugin; here, and on the server if there is one."""
    if remote:
        simple.LoadPlugin(PLUGIN, remote=True, ns=vars(simple))
    simple.LoadPlugin(PLUGIN, remote=False, ns=vars(simple))
    simple._DisableFirstRenderCameraReset()


def make_view(size=(160, 140), kind="RenderView"):
    view = simple.CreateView(kind)
    view.ViewSize = list(size)
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.0, 0.0, 0.0]
    # Smoothing of edges works on the picture as a whole, where several processes see only parts.
    view.UseFXAA = 0
    view.CameraPosition = [75.0, 45.0, 60.0]
    view.CameraFocalPoint = [0.0, 0.0, 0.0]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    return view


def make_wavelet(half=15):
    return simple.Wavelet(WholeExtent=[-half, half] * 3)


def make_source(kind, extent, script):
    """A source of vtkImageData or vtkRectilinearGrid: `script` sets what `output` has but the extent and
    the point array "RTData", which is 200."""
    return simple.ProgrammableSource(
        OutputDataSetType=kind,
        ScriptRequestInformation="""
executive = self.GetExecutive()
executive.GetOutputInformation(0).Set(executive.WHOLE_EXTENT(), %s)
""" % ", ".join(map(str, extent)),
        Script="""
from paraview import vtk
output = self.GetOutput()
output.SetExtent(%s)
%s
s = vtk.vtkDoubleArray(); s.SetName("RTData"); s.SetNumberOfTuples(output.GetNumberOfPoints()); s.Fill(200.0)
output.GetPointData().AddArray(s)
""" % (", ".join(map(str, extent)), script))


def set_functions(opaque=False):
    """The look of the Wavelet's array, independent of what part of it a process sees."""
    simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
    opacity = simple.GetOpacityTransferFunction("RTData")
    opacity.Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0, 180, 1.0 if opaque else 0.1, 0.5, 0,
                      280, 1.0 if opaque else 0.3, 0.5, 0]
    return opacity


def translate(display, place):
    """Move a representation; ParaView 5.13 has another name for it."""
    name = "Translation" if display.SMProxy.GetProperty("Translation") else "Position"
    setattr(display, name, place)


def read_picture(path):
    """Height x width x 3, 0 to 255."""
    from paraview.modules.vtkPVVTKExtensionsCore import vtkPVTrivialProducer  # noqa: F401
    from vtkmodules.vtkIOImage import vtkPNGReader
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(height, width, -1)[:, :, :3].astype(int)


def picture(view, name):
    """Render and return the picture; it stays in the folder for temporary files."""
    path = os.path.join(TEMPORARY, "ParaView." + name + ".png")
    simple.Render(view)
    simple.SaveScreenshot(path, view)
    return read_picture(path)


def moving_picture(view, path=None):
    """What is shown while the scene moves, with no still picture before it; height x width x 3. `path`:
    a PNG file for it."""
    from paraview.modules.vtkRemotingViews import vtkPVRenderView  # noqa: F401
    from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter
    view.Update()
    view.SMProxy.InteractiveRender()
    grab = vtkWindowToImageFilter()
    grab.SetInput(view.GetRenderWindow())
    grab.ShouldRerenderOff()
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    if path:
        from vtkmodules.vtkIOImage import vtkPNGWriter
        writer = vtkPNGWriter()
        writer.SetInputData(image)
        writer.SetFileName(path)
        writer.Write()
    width, height, _ = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(height, width, -1)[:, :, :3].astype(int)


def differ(a, b):
    """Largest and mean difference, 0 to 255."""
    difference = np.abs(a - b)
    return difference.max(), difference.mean()


def lit(a, level=12):
    """Number of pixels that show something on black."""
    return int((a.max(axis=2) > level).sum())


class Errors:
    """Counts and keeps ParaView's error messages, or warnings, within a with statement."""

    def __init__(self, event="ErrorEvent"):
        self.event = event

    def __enter__(self):
        self.window = servermanager.vtkSMProxyManager  # keeps the module loaded
        from vtkmodules.vtkCommonCore import vtkOutputWindow
        self.text = []
        self.output = vtkOutputWindow.GetInstance()
        self.tag = self.output.AddObserver(self.event, self.note)
        return self

    def note(self, _caller, _event, message=""):
        self.text.append(str(message))

    note.CallDataType = "string0"

    def __exit__(self, *_):
        self.output.RemoveObserver(self.tag)

    def say(self, *words):
        """Whether one message holds all the words."""
        return any(all(word in text for word in words) for text in self.text)


def run(*arguments, ranks=1, **environment):
    """Run a script of this folder with pvbatch; returns its output."""
    here = os.path.dirname(os.path.abspath(__file__))
    command = ["mpiexec", "-np", str(ranks), "pvbatch",
               os.path.join(here, arguments[0]), *map(str, arguments[1:])]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            env={**os.environ, **environment}, check=False)
    if result.returncode != 0:
        sys.stderr.write(result.stdout)
        raise RuntimeError("%s failed with %d" % (" ".join(command), result.returncode))
    return result.stdout
