# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A Catalyst script: a picture of the deformed volume of each step of a simulation, in the folder
datasets/. With ParaView's example of a simulation, Wavelet:

    Examples/paraview.sh pvbatch -m paraview.demos.wavelet_miniapp -t 10 -s Examples/Python/paraview_in_situ.py
"""

from paraview.simple import *  # pylint: disable=wildcard-import,unused-wildcard-import

data = TrivialProducer(registrationName="input")
lattice = FFDLattice(Input=data, Shape="Twist")
view = CreateView("RenderView", ViewSize=[400, 400])
display = Show(lattice, view)
display.RescaleTransferFunctionToDataRange(False, True)
view.ResetCamera()
pictures = CreateExtractor("PNG", view, registrationName="pictures")
pictures.Writer.FileName = "deformed_{timestep:04d}.png"


def catalyst_execute(info):
    """The lattice moves with the simulation."""
    lattice.Strength = 0.5 * (1 + info.timestep)
