# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestParallel.py with pvbatch --symmetric: pictures of a volume that lights make brighter than white.
Argument: the prefix of the pictures."""

import sys

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdparaview as ffd

def show_volume(view, intensity):
    display = simple.Show(lattice, view)
    display.FFDShade = 1
    display.Ambient = 0.1
    display.Diffuse = 0.7
    display.Specular = 1.0
    display.SpecularPower = 20.0
    light = simple.AddLight(view)
    light.Coords = "Camera"
    light.Intensity = intensity


ffd.load()
view = ffd.make_view((120, 100))
view.CameraPosition = [100.0, 60.0, 80.0]
lattice = simple.FFDLattice(Input=ffd.make_wavelet(20))
show_volume(view, 0.4)
simple.GetColorTransferFunction("RTData").RGBPoints = [37, 0.9, 0.6, 0.4, 280, 1.0, 1.0, 0.9]
# In the volume, shining behind it, and in front of it.
balls = [simple.Sphere(Radius=6.0, Center=center, ThetaResolution=24, PhiResolution=24)
         for center in ((8.0, 3.0, 9.0), (-30.0, -12.0, -20.0), (30.0, 10.0, 22.0))]
for ball in balls:
    shown = simple.Show(ball, view)
    shown.ColorArrayName = [None, ""]
    shown.DiffuseColor = [0.2, 0.9, 1.0]
    shown.Specular = 1.0 if ball is balls[1] else 0.0


def picture(name, view=view):
    simple.SaveScreenshot("%s.%s.png" % (sys.argv[1], name), view, ImageResolution=[200, 180])


for shape, strength in (("Bend", 1.0), ("Twist", 2.0), ("Taper", 1.0), ("Bulge", 1.0),
                        ("Random", 1.0)):
    lattice.Shape = shape
    lattice.Strength = strength
    simple.GetOpacityTransferFunction("RTData").Points = [
        37, 0, 0.5, 0, 140, 0, 0.5, 0, 180, 0.1, 0.5, 0, 280, 0.3, 0.5, 0]
    picture(shape)
view.Background = [1.0, 1.0, 1.0]
picture("White")
view.UseFXAA = 1
picture("FXAA")
view.UseFXAA = 0
view.Background = [0.0, 0.0, 0.0]
simple.GetOpacityTransferFunction("RTData").Points = [
    37, 0.02, 0.5, 0, 140, 0.02, 0.5, 0, 180, 0.9, 0.5, 0, 280, 0.9, 0.5, 0]
picture("Dense")
# Some boxes are out of sight, and all surfaces are of some processes. None in the volume: where a
# sample is just at a surface, rounding of the depth decides whether it is before it.
simple.Hide(balls[0], view)
simple.Hide(balls[1], view)
view.CameraPosition = [50.0, -6.0, 60.0]
view.CameraFocalPoint = [16.07, -8.05, 14.0]
picture("Near")
view.CameraParallelProjection = 1
view.CameraParallelScale = 20.0
picture("Flat")
simple.Hide(lattice, view)
picture("Hidden")
simple.Show(lattice, view)
picture("Again")
# Passes that process the finished picture; of several processes ParaView gives them no depths.
simple.GetOpacityTransferFunction("RTData").Points = [
    37, 0, 0.5, 0, 140, 0, 0.5, 0, 180, 0.1, 0.5, 0, 280, 0.3, 0.5, 0]
lattice.Shape = "Bend"
for name in ("EDL", "Tones"):
    other = ffd.make_view((120, 100), "RenderViewWithEDL" if name == "EDL" else "RenderView")
    other.CameraPosition = [100.0, 60.0, 80.0]
    show_volume(other, 1.0)
    other.UseToneMapping = 1 if name == "Tones" else 0
    picture(name, other)
