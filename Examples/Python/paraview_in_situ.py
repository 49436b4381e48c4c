# script-version: 2.0
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A Catalyst script: a picture of the deformed volume at each step of a simulation. With ParaView's
example of a simulation:

    Examples/paraview.sh pvbatch -m paraview.demos.wavelet_miniapp -t 10 -s Examples/Python/paraview_in_situ.py

Several processes, -n 4, need --symmetric after pvbatch, for the simulation runs in each.
"""

from paraview import simple

data = simple.TrivialProducer(registrationName="input")
scene = {}


def catalyst_execute(info):
    """The pipeline is made at the first step, when there are data; the lattice moves with the steps."""
    if not scene:
        scene["lattice"] = simple.FFDLattice(Input=data, Shape="Twist")
        scene["view"] = simple.CreateView("RenderView")
        display = simple.Show(scene["lattice"], scene["view"])
        display.RescaleTransferFunctionToDataRange(False, True)
        simple.ResetCamera(scene["view"])
    scene["lattice"].Strength = 0.5 * (1 + info.timestep)
    simple.SaveScreenshot("deformed_%04d.png" % info.timestep, scene["view"], ImageResolution=[400, 400])
