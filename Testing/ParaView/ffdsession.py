# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""To be imported before paraview.simple: sessions begin sooner. For each of its functions ParaView searches
all proxies for a help text, which takes longer than all the rest, in each new session and after a reset."""

from paraview import servermanager

if hasattr(servermanager, "ProxyNamespace"):
    servermanager.ProxyNamespace.getDocumentation = lambda self, name: ""
