# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestParallel.py with pvbatch --symmetric: scripts of this folder one after the other, which takes
less time than a session each. Arguments: the scripts with their arguments, divided by "+"."""

import os
import runpy
import sys

import ffdsession  # before paraview.simple
from paraview import simple

ffdsession.collect_at_end()
words = sys.argv[1:]
while words:
    end = words.index("+") if "+" in words else len(words)
    sys.argv = words[:end]
    runpy.run_path(os.path.join(os.path.dirname(ffdsession.__file__), sys.argv[0]))
    words = words[end + 1:]
    for view in simple.GetRenderViews():
        simple.Delete(view)
    for source in list(simple.GetSources().values()):
        simple.Delete(source)
