# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestPanel.py in ParaView's graphical client: two volumes, each with a lattice. The first is
shown by the representation FFD_REST_TYPE, the second by FFD Volume."""

import os

from paraview import simple

simple.GetSettingsProxy("GeneralSettings").AutoApply = 0
view = simple.GetActiveViewOrCreate("RenderView")
for name, kind in (("First", os.environ["FFD_REST_TYPE"]), ("Second", "FFD Volume")):
    wavelet = simple.Wavelet(registrationName=name + "Data", WholeExtent=[-9, 9] * 3)
    lattice = simple.FFDLattice(registrationName=name, Input=wavelet, Shape="Twist")
    display = simple.Show(lattice, view)
    display.SetRepresentationType(kind)
    simple.ColorBy(display, ("POINTS", "RTData"))
simple.ResetCamera(view)
simple.Render(view)
