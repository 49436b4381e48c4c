# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""To be imported before paraview.simple: sessions begin sooner. For each of its functions ParaView searches
all proxies for a help text, which takes longer than all the rest, in each new session and after a reset."""

import atexit

from paraview import servermanager
from vtkmodules.vtkCommonCore import vtkGarbageCollector

if hasattr(servermanager, "ProxyNamespace"):
    servermanager.ProxyNamespace.getDocumentation = lambda self, name: ""


def collect_at_end():
    """For scripts that end soon: for each object that goes VTK searches what it holds for loops of references,
    which takes a quarter of the time of many short scenes; now once, at the end."""
    vtkGarbageCollector.DeferredCollectionPush()
    atexit.register(vtkGarbageCollector.DeferredCollectionPop)
