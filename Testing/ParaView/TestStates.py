#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""States and traces: those of the first version of the plugin are loaded, and a state that one process
wrote is loaded by four."""

import os
import unittest

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdparaview as ffd

ffd.load()

# As traced with the first version of the plugin.
FIRST_TRACE = """
from paraview.simple import *
wavelet1 = Wavelet(registrationName='Wavelet1')
wavelet1.WholeExtent = [-15, 15, -15, 15, -15, 15]
fFDLattice1 = FFDLattice(registrationName='FFDLattice1', Input=wavelet1)
fFDLattice1.Resolution = [5, 5, 5]
fFDLattice1.Shape = 'Twist'
fFDLattice1.Strength = 1.5
fFDLattice1.DisplacementScale = 0.8
fFDLattice1.Displacements = [0.0, 0.0, 3.0] * 125
fFDLattice1.DisplacementsResolution = [0, 0, 0]
fFDLattice1.Padding = 0.1
fFDLattice1.UseInputLattice = 1
fFDLattice1.BorderMode = 'Edge'
renderView1 = GetActiveViewOrCreate('RenderView')
fFDLattice1Display = Show(fFDLattice1, renderView1, 'UniformGridRepresentation')
fFDLattice1Display.Representation = 'FFD Volume'
fFDLattice1Display.FFDInverseMode = 'First Order'
fFDLattice1Display.FFDSampleDistance = 0.7
fFDLattice1Display.FFDImageSampleDistance = 1.0
fFDLattice1Display.FFDAdaptInteractiveQuality = 0
fFDLattice1Display.FFDSpaceLeaping = 'Across Pieces'
fFDLattice1Display.FFDOpacityLength = 'Material'
fFDLattice1Display.FFDSegmentation = 'Greedy Angle'
fFDLattice1Display.FFDPositionTolerance = 0.2
fFDLattice1Display.FFDInverseTolerance = 0.02
fFDLattice1Display.FFDAngleThreshold = 4.0
fFDLattice1Display.FFDMinimumSegmentLength = 0.6
fFDLattice1Display.FFDMaximumSegmentLength = 7.0
fFDLattice1Display.FFDEarlyRayTermination = 0.01
fFDLattice1Display.FFDNumberOfThreads = 2
fFDLattice1Display.FFDShade = 1
fFDLattice1Display.FFDScalarOpacityUnitDistance = 1.5
"""

LATTICE = {
    "Resolution": [5, 5, 5], "Shape": "Twist", "Strength": 1.5, "DisplacementScale": 0.8,
    "Displacements": [0.0, 0.0, 3.0] * 125, "DisplacementsResolution": [0, 0, 0], "Padding": 0.1,
    "UseInputLattice": 1, "BorderMode": "Edge"}

DISPLAY = {
    "Representation": "FFD Volume", "FFDInverseMode": "First Order", "FFDSampleDistance": 0.7,
    "FFDImageSampleDistance": 1.0, "FFDAdaptInteractiveQuality": 0,
    "FFDSpaceLeaping": "Across Pieces", "FFDOpacityLength": "Material", "FFDSegmentation": "Greedy Angle",
    "FFDPositionTolerance": 0.2, "FFDInverseTolerance": 0.02, "FFDAngleThreshold": 4.0,
    "FFDMinimumSegmentLength": 0.6, "FFDMaximumSegmentLength": 7.0, "FFDEarlyRayTermination": 0.01,
    "FFDNumberOfThreads": 2, "FFDShade": 1, "FFDScalarOpacityUnitDistance": 1.5}


class TestStates(unittest.TestCase):
    def setUp(self):
        simple.ResetSession()
        ffd.load()

    def check(self, picture=None):
        """The scene of the first version; returns its picture, of the same camera and functions."""
        lattice = simple.FindSource("FFDLattice1")
        view = simple.GetActiveViewOrCreate("RenderView")
        display = simple.GetDisplayProperties(lattice, view)
        for proxy, values in ((lattice, LATTICE), (display, DISPLAY)):
            for name, value in values.items():
                got = proxy.GetPropertyValue(name)
                self.assertEqual(list(got) if isinstance(value, list) else got, value, name)
        return ffd.picture(view, "first version")

    def test_trace_of_the_first_version(self):
        with ffd.Errors() as errors, ffd.Errors(event="WarningEvent") as warnings:
            ffd.make_view()
            exec(FIRST_TRACE, {})  # pylint: disable=exec-used
            ffd.set_functions()
            picture = self.check()
        self.assertEqual(errors.text + warnings.text, [])
        self.assertGreater(ffd.lit(picture), 1000)

    def test_state_of_the_first_version(self):
        """The file has the properties that there were then, and no others."""
        ffd.make_view()
        exec(FIRST_TRACE, {})  # pylint: disable=exec-used
        ffd.set_functions()
        expected = self.check()
        simple.ResetSession()
        ffd.load()
        path = os.path.join(ffd.DATA, "ParaView", "first_version.pvsm")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for name in ("GeometryMode", "FFDCroppingSpace", "FFDBlendMode", "FFDUseTransfer2D",
                     "FFDJittering"):
            self.assertNotIn('"%s"' % name, text)
        with ffd.Errors() as errors, ffd.Errors(event="WarningEvent") as warnings:
            simple.LoadState(path)
            picture = self.check()
        self.assertEqual(errors.text + warnings.text, [])
        self.assertLessEqual(ffd.differ(picture, expected)[0], 2)

    def test_one_process_to_four(self):
        view = ffd.make_view()
        lattice = simple.FFDLattice(
            registrationName="Lattice", Input=ffd.make_wavelet(), Shape="Twist")
        simple.Show(lattice, view)
        contour = simple.Contour(
            Input=lattice, ContourBy=["POINTS", "RTData"], Isosurfaces=[200.0])
        simple.Show(simple.Slice(Input=contour), view)
        ffd.set_functions()
        expected = ffd.picture(view, "of one process")
        path = os.path.join(ffd.TEMPORARY, "ParaView.one.pvsm")
        simple.SaveState(path)
        name = os.path.join(ffd.TEMPORARY, "ParaView.of four processes.png")
        ffd.run("StateScene.py", path, name, ranks=4)
        self.assertLess(ffd.differ(ffd.read_picture(name), expected)[1], 0.3)


if __name__ == "__main__":
    unittest.main()
