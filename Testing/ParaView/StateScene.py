# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestStates.py with several processes: loads a state and saves a picture of its view.
Arguments: the state, the picture."""

import sys

import ffdsession  # noqa: F401, before paraview.simple
from paraview import simple

import ffdparaview as ffd

ffd.load()
simple.LoadState(sys.argv[1])
view = simple.GetActiveViewOrCreate("RenderView")
simple.Render(view)
simple.SaveScreenshot(sys.argv[2], view)
