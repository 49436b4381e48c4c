# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestBlocks.py with pvbatch --symmetric: a volume as an image, as blocks, and as rectilinear
grids. Argument: the prefix of the pictures."""

import sys

import ffdsession  # before paraview.simple
from paraview import simple

import ffdparaview as ffd

ffdsession.collect_at_end()
ffd.load()
view = ffd.make_view()
HALF = 15
GAP = (-HALF, -5), (4, HALF)

GRID = """
import numpy as np
from paraview.vtk.util.numpy_support import numpy_to_vtk
executive = self.GetExecutive()
extent = executive.GetOutputInformation(0).Get(executive.UPDATE_EXTENT())
output.SetExtent(extent)
axes = []
for a, name in enumerate('XYZ'):
    i = np.arange(extent[2 * a], extent[2 * a + 1] + 1)
    # Steps of 1, or from 0.2 to 1.8.
    axes.append(i - 15.0 if EQUAL else -15.0 + 30.0 * (i / 30.0) ** 1.8)
    getattr(output, 'Set%sCoordinates' % name)(numpy_to_vtk(axes[-1], deep=True))
z, y, x = np.meshgrid(*axes[::-1], indexing='ij')
values = numpy_to_vtk((160.0 + 4.0 * x + 3.0 * y - 2.0 * z).ravel(), deep=True)
values.SetName('RTData')
output.GetPointData().AddArray(values)
"""

WHOLE = """
executive = self.GetExecutive()
executive.GetOutputInformation(0).Set(executive.WHOLE_EXTENT(), 0, 30, 0, 30, 0, 30)
executive.GetOutputInformation(0).Set(self.CAN_PRODUCE_SUB_EXTENT(), 1)
"""


def take_pictures(name, data, extract=None, **properties):
    """Of the data with a lattice, or with `extract` blocks of the result, each shown on its own."""
    lattice = simple.FFDLattice(Input=data, Resolution=[5, 5, 5], Shape="Twist", **properties)
    shown = [lattice] if extract is None else [
        simple.ExtractBlock(Input=lattice, Assembly="Hierarchy", Selectors=[each]) for each in extract]
    for each in shown:
        display = simple.Show(each, view)
        display.SetRepresentationType("FFD Volume")
        simple.ColorBy(display, ("POINTS", "RTData"))
    ffd.set_functions()

    def save(state):
        simple.Render(view)
        simple.SaveScreenshot("%s.%s%s.png" % (sys.argv[1], name, state), view)

    save("")
    # An edit, after which the voxels are the same.
    lattice.Strength = 0.4
    save(" edited")
    if properties.get("LatticePerBlock"):
        for each in shown:
            display = simple.GetDisplayProperties(each, view)
            display.FFDShade = 1
            ffd.translate(display, [6.0, -4.0, 2.0])
            display.Scale = [1.1, 1.0, 0.8]
        save(" moved")
    for each in [*shown, lattice]:
        simple.Delete(each)


def cut(data):
    """Eight boxes that fill it, of unlike sizes."""
    low, high = (-HALF, 3), (3, HALF)
    return [simple.ExtractSubset(Input=data, VOI=[*x, *y, *z])
            for x in (low, high) for y in (low, high) for z in (low, high)]


wavelet = ffd.make_wavelet(HALF)
take_pictures("image", wavelet)
pieces = cut(wavelet)
for kind in ("vtkMultiBlockDataSet", "vtkPartitionedDataSet", "vtkPartitionedDataSetCollection"):
    group = simple.GroupDatasets(Input=pieces)
    group.OutputType = kind
    take_pictures(kind, group)
# A lattice each, with gaps between the blocks: none gets into the bounds of another.
apart = [simple.ExtractSubset(Input=wavelet, VOI=[*x, *y, *z])
         for x in GAP for y in GAP for z in GAP]
blocks = simple.GroupDatasets(Input=apart)
names = ["/Root/Block%d" % i for i in range(len(apart))]
take_pictures("per block", blocks, LatticePerBlock=1)
take_pictures("one by one", blocks, extract=names, LatticePerBlock=1)
# A block is missing.
take_pictures("hole", simple.GroupDatasets(Input=pieces[:-1]))
# Blocks of unlike voxels.
coarse = simple.ExtractSubset(Input=wavelet, VOI=[-HALF, 3, -HALF, HALF, -HALF, HALF],
                              SampleRateI=3, SampleRateJ=2, SampleRateK=2)
fine = simple.ExtractSubset(Input=wavelet, VOI=[3, HALF, -HALF, HALF, -HALF, HALF])
take_pictures("unlike", simple.GroupDatasets(Input=[coarse, fine]))
# Surfaces of blocks move, too.
simple.Hide(wavelet, view)
lattice = simple.FFDLattice(Input=simple.GroupDatasets(Input=pieces), Shape="Twist")
contour = simple.Contour(Input=lattice, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
simple.Show(contour, view).ColorArrayName = [None, ""]
simple.Render(view)
simple.SaveScreenshot(sys.argv[1] + ".contour.png", view)
simple.Delete(contour)
# A linear function on unlike steps.
for name, equal in (("linear", True), ("rectilinear", False)):
    grid = simple.ProgrammableSource(OutputDataSetType="vtkRectilinearGrid",
                                     Script="EQUAL = %s\n" % equal + GRID,
                                     ScriptRequestInformation=WHOLE)
    take_pictures(name, grid)
