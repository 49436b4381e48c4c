# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by TestParallel.py with pvbatch --symmetric: pictures of some scenes, and what each process
holds. Arguments: the prefix of the pictures, and a file that one process reads alone."""

import re
import resource
import sys
import time

import ffdsession  # noqa: F401, before paraview.simple
from paraview import servermanager, simple

import ffdparaview as ffd

ffd.load()
rank = servermanager.vtkProcessModule.GetProcessModule().GetPartitionId()
view = ffd.make_view((120, 100))
wavelet = ffd.make_wavelet(20)
wavelet_object = wavelet.SMProxy.GetClientSideObject()
view.CameraPosition = [100.0, 60.0, 80.0]
lattice = simple.FFDLattice(Input=wavelet)
simple.Show(lattice, view)
balls = []
for center, color in (((8.0, 3.0, 9.0), (1.0, 0.0, 0.0)), ((30.0, 10.0, 22.0), (0.0, 1.0, 0.0)),
                       ((-30.0, -12.0, -20.0), (0.0, 0.3, 1.0))):
    ball = simple.Sphere(Radius=6.0, Center=center, ThetaResolution=24, PhiResolution=24)
    display = simple.Show(ball, view)
    display.ColorArrayName = [None, ""]
    display.DiffuseColor = color
    balls.append(display)


def show(name, source, settings=(False, True)):
    """Pictures, translucent and opaque, and a line of what this process has of them."""
    for opaque in settings:
        opacity = ffd.set_functions(opaque)
        if name == "Minimum":
            # The least value of a ray is one of those that are transparent otherwise.
            opacity.Points = [37, 0.2, 0.5, 0, 280, 1, 0.5, 0]
        simple.Render(view)
        start = time.perf_counter()
        simple.Render(view)
        seconds = time.perf_counter() - start
        simple.SaveScreenshot("%s.%s%d.png" % (sys.argv[1], name, opaque), view)
        volumes = view.SMProxy.GetRenderer().GetVolumes()
        volumes.InitTraversal()
        mapper = volumes.GetNextVolume().GetMapper()
        image = mapper.GetInputDataObject(0, 0)
        voxels = image.GetNumberOfPoints() if image else 0
        given = source.GetOutputDataObject(0).GetNumberOfPoints()
        # The end of the line in the same write: the lines of several processes meet in one stream.
        sys.stdout.write(
            "RANK %d %s%d voxels %d of the source %d frame %.3f s memory %d MB threads %s bounds %r\n" % (
                rank, name, opaque, voxels, given, seconds,
                resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
                re.search(r"NumberOfThreads: (\d+)", str(mapper)).group(1),
                mapper.GetBounds() if image else None))
        sys.stdout.flush()


for scene, shape, strength in (("identity", "None", 0.0), ("smooth", "Bend", 0.6),
                               ("strong", "Twist", 2.0), ("edited", "Twist", 1.98)):
    lattice.Shape = shape
    lattice.Strength = strength
    show(scene, wavelet_object)
# While the scene moves, beyond the LOD threshold; without the balls, which processes coarsen by themselves.
for ball in balls:
    ball.Visibility = 0
view.LODThreshold = 0.0
view.LODResolution = 1.0
view.ImageReductionFactor = 1
simple.GetDisplayProperties(lattice, view).FFDAdaptInteractiveQuality = 0
lattice.Strength = 1.5
ffd.moving_picture(view, "%s.moving.png" % sys.argv[1] if rank == 0 else None)
view.LODThreshold = 1000.0
for ball in balls:
    ball.Visibility = 1
lattice.Strength = 1.98
# Modes other than composite: the first process does them alone.
lattice_display = simple.GetDisplayProperties(lattice, view)
lattice_display.FFDIsosurfaceValues = [150.0, 210.0]
for mode in ("Maximum Intensity", "Minimum Intensity", "Average Intensity", "Additive",
             "Isosurface", "Slice"):
    lattice_display.FFDBlendMode = mode
    show(mode.split()[0], wavelet_object, [mode == "Isosurface"])
lattice_display.FFDBlendMode = "Composite"
# Other voxels, the same lattice.
wavelet.XFreq = 30.0
show("changed", wavelet_object)
# Integers, and a step of the opacity: samples that are not the same ones show most.
steps = simple.Calculator(Input=wavelet, ResultArrayName="steps", ResultArrayType="Int",
                          Function="(coordsX + coordsY + coordsZ + 60) / 8 + RTData / 50")
wavelet.XFreq = 60.0
simple.Delete(lattice)
lattice = simple.FFDLattice(Input=steps, Shape="Twist", Strength=1.5)
simple.ColorBy(simple.Show(lattice, view), ("POINTS", "steps"))
simple.GetColorTransferFunction("steps").RescaleTransferFunction(0.0, 20.0)
simple.GetOpacityTransferFunction("steps").Points = [0, 0, 0.5, 0, 9, 0, 0.5, 0,
                                                     9.4, 0.6, 0.5, 0, 20, 1, 0.5, 0]
show("steps", wavelet_object, [False])
# A reader that gives all to the first process and nothing to the others.
simple.Delete(lattice)
reader = simple.LegacyVTKReader(FileNames=[sys.argv[2]])
lattice = simple.FFDLattice(Input=reader, Shape="Bend", Strength=0.66, DisplacementScale=1 / 1.1)
display = simple.Show(lattice, view)
display.SetRepresentationType("FFD Volume")
# Named: a client of its own, as each process is here, does not see the array of the first one.
simple.ColorBy(display, ("POINTS", "RTData"))
show("alone", reader.SMProxy.GetClientSideObject())
