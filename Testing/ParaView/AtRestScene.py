# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: two volumes, each with a lattice. The first is
shown by the representation FFD_REST_TYPE, or goes through a filter that drops the lattice, the second is
shown by FFD Volume."""

import os

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

simple.GetSettingsProxy("GeneralSettings").AutoApply = 0
view = simple.GetActiveViewOrCreate("RenderView")
view.UseFXAA = 0
for name, kind in (("First", os.environ["FFD_REST_TYPE"]), ("Second", "FFD Volume")):
    wavelet = simple.Wavelet(registrationName=name + "Data", WholeExtent=[-9, 9] * 3)
    dropped = kind == "lattice dropped"
    lattice = simple.FFDLattice(
        registrationName=name + "Lattice" if dropped else name, Input=wavelet, Shape="Twist")
    if dropped:
        sliced = simple.Slice(Input=simple.TemporalStatistics(Input=lattice), registrationName=name)
        simple.Show(sliced, view)
        continue
    display = simple.Show(lattice, view)
    display.SetRepresentationType(kind)
    simple.ColorBy(display, ("POINTS", "RTData"))
simple.ResetCamera(view)
simple.Render(view)
