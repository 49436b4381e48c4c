#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Open a volume in ParaView with a lattice to shape it by; Examples/paraview.sh runs this.

The environment variable FFD_PARAVIEW_VOLUME names the file.
"""

import os

from paraview import simple

name = os.environ["FFD_PARAVIEW_VOLUME"]


def is_dicom(path):
    """Whether this is a folder, of DICOM slices, or one of these."""
    if os.path.isdir(path):
        return True
    with open(path, "rb") as file:
        return file.read(132)[128:] == b"DICM"


# A server may lack the plugin, which says so itself: the volume is shown as it is.
plugin = hasattr(simple, "FFDLattice")
if plugin and is_dicom(name):
    volume = simple.FFDVolumeReader(FileNames=[name])
else:
    volume = simple.OpenDataFile(name)
if volume is None:
    raise SystemExit("ParaView has no reader for '%s'." % name)
simple.RenameSource(os.path.basename(name), volume)
view = simple.GetActiveViewOrCreate("RenderView")
shown = simple.FFDLattice(registrationName="FFD Lattice", Input=volume) if plugin else volume
simple.Show(shown, view)
simple.SetActiveSource(shown)
simple.ResetCamera(view)
simple.Render(view)
