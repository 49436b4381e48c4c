# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestParallel.py: what picks, selections and probes of FFD Volume find, into a file of JSON.
Arguments: the file, and the files of blocks with one lattice and of blocks with one each."""

import json
import sys

import ffdsession  # before paraview.simple
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

import ffdparaview as ffd

ffdsession.collect_at_end()
ffd.load()


def values(source):
    source.UpdatePipeline()
    points = servermanager.Fetch(source).GetPointData()
    return [vtk_to_numpy(points.GetArray(name)).ravel().tolist()
            for name in ("RTData", "vtkValidPointMask", "RestPosition")]


def find(data, **settings):
    view = ffd.make_view()
    lattice = simple.FFDLattice(Input=data, Shape="Bend", Strength=0.7, **settings)
    simple.Show(lattice, view)
    ffd.set_functions(opaque=True)
    other = ffd.make_view()  # shows it by another mapping
    simple.Show(lattice, other).FFDInverseMode = "Pull Back"
    simple.Render(view)
    simple.Render(other)
    found = {"places": [], "other places": [], "clicks": [], "selected": {}, "probes": []}

    # Places that widgets take from the picture, and what a click selects.
    for x, y in ((80, 70), (70, 85), (95, 60), (60, 60), (2, 2)):
        place, normal = [0.0] * 3, [0.0] * 3
        for name, shown in (("places", view), ("other places", other)):
            hit = shown.SMProxy.ConvertDisplayToPointOnSurface([x, y], place, normal)
            found[name].append([hit, *(round(x, 6) for x in place)])
        found["clicks"].append(view.SMProxy.Pick(x, y) is not None)

    for name in ("SelectSurfacePoints", "SelectSurfaceCells", "SelectCellsThrough"):
        getattr(simple, name)(Rectangle=[60, 50, 100, 90], View=view)
        selection = lattice.SMProxy.GetSelectionInput(0)
        extract = simple.ExtractSelection(
            Input=lattice, Selection=servermanager._getPyProxy(selection))
        extract.UpdatePipeline()
        extracted = extract.GetDataInformation()
        # Points of cells are those of the pieces, whose faces have them twice.
        found["selected"][name] = [extracted.GetNumberOfCells(), extracted.GetBounds()]
        simple.ClearSelection(lattice)

    for place in ((2.0, -3.0, 4.0), (-9.0, 5.0, -1.5), (10.0, 1.0, 9.0), (40.0, 0.0, 0.0)):
        probe = simple.ProbeLocation(Input=lattice, ProbeType="Fixed Radius Point Source")
        probe.ProbeType.Center = list(place)
        found["probes"].append(values(probe))
    found["line"] = values(simple.PlotOverLine(
        Input=lattice, Point1=[-9.0, -8.0, -9.0], Point2=[11.0, 9.0, 12.0],
        SamplingPattern="Sample Uniformly", Resolution=100))
    return found


found = {
    "image": find(ffd.make_wavelet()),
    "blocks": find(simple.OpenDataFile(sys.argv[2])),
    "lattices": find(simple.OpenDataFile(sys.argv[3]), LatticePerBlock=True),
}
with open(sys.argv[1], "w", encoding="ascii") as file:
    json.dump(found, file)
