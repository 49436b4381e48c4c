#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frame times, edit times, voxels and memory of the ParaView plugin on 1, 2 and 4 processes.

    Module/CMake/with-xvfb.sh /usr/bin/python3 Testing/Benchmarks/paraview_parallel.py BUILD [SIZE [RANKS...]]

BUILD is a build folder with the plugin. A file of SIZE^3 floats (default 200) is written, read by as
many processes as RANKS say (default 1 2 4), and shown at rest, bent and twisted. Prints a table: per
process at most, voxels held for rendering, times the reader ran for an edit, seconds for an edit with
its frame and for a frame alone, and MB of resident memory.
"""

import glob
import os
import subprocess
import sys
import tempfile

EDITS = 5


def scene(file, half):
    """In pvbatch."""
    import resource
    import time
    from paraview import servermanager, simple
    simple.LoadPlugin(os.environ["FFD_PARAVIEW_PLUGIN"], ns=vars(simple))
    rank = servermanager.vtkProcessModule.GetProcessModule().GetPartitionId()
    reader = simple.XMLImageDataReader(FileName=[file])
    runs = [0]

    def count(*_):
        runs[0] += 1
    reader.SMProxy.GetClientSideObject().AddObserver("StartEvent", count)
    view = simple.CreateView("RenderView")
    view.ViewSize = [600, 500]
    view.UseFXAA = 0
    lattice = simple.FFDLattice(Input=reader)
    simple.Show(lattice, view)
    simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0,
                                                          180, 0.02, 0.5, 0, 280, 0.1, 0.5, 0]
    view.CameraPosition = [5.0 * half, 3.0 * half, 4.0 * half]
    view.CameraFocalPoint = [0.0, 0.0, 0.0]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    for shape, strength in (("None", 0.0), ("Bend", 0.6), ("Twist", 2.0)):
        lattice.Shape = shape
        lattice.Strength = strength
        simple.Render(view)
        simple.Render(view)
        runs[0] = 0
        edit = frame = 0.0
        for step in range(EDITS):
            start = time.perf_counter()
            lattice.Strength = strength * (1.0 + 0.01 * (step + 1))
            lattice.DisplacementScale = 1.0 - 0.01 * (step + 1)
            simple.Render(view)
            edit += time.perf_counter() - start
            start = time.perf_counter()
            view.CameraPosition = [5.0 * half, 3.0 * half, (4.0 + 0.02 * step) * half]
            simple.Render(view)
            frame += time.perf_counter() - start
        volumes = view.SMProxy.GetRenderer().GetVolumes()
        volumes.InitTraversal()
        image = volumes.GetNextVolume().GetMapper().GetInputDataObject(0, 0)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        sys.stdout.write("RANK %d %s %d %g %g %g %d\n" % (
            rank, shape, image.GetNumberOfPoints() if image else 0, runs[0] / EDITS,
            edit / EDITS, frame / EDITS, memory))
        sys.stdout.flush()


def environment(build):
    """As that of the tests of the plugin."""
    build = os.path.abspath(build)
    home = tempfile.mkdtemp(prefix="ffd-paraview.")
    return {**os.environ, "HOME": home, "XDG_RUNTIME_DIR": home,
            "PYTHONPATH": os.path.join(build, "paraview-prefix/lib/python3/dist-packages"),
            "FFD_PARAVIEW_PLUGIN": glob.glob(os.path.join(
                build, "paraview/lib/paraview-*/plugins/FFDVolume/FFDVolume.so"))[0],
            "LIBGL_ALWAYS_SOFTWARE": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_mpi_yield_when_idle": "1",
            "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}


def main(build, size=200, ranks=(1, 2, 4)):
    """Start the processes, print the table."""
    env = environment(build)
    half = size // 2
    file = os.path.join(env["HOME"], "volume.vti")
    subprocess.run(
        [sys.executable, "-c",
         "from paraview import simple\n"
         "w = simple.Wavelet(WholeExtent=[%d, %d] * 3)\n"
         "simple.SaveData(%r, proxy=w, CompressorType='None')" % (-half, size - half - 1, file)],
        env=env, check=True)
    print("volume of %d^3 floats, %s of load before" % (size, os.getloadavg()[0]))
    print("%-10s %5s %12s %8s %10s %10s %8s" % (
        "shape", "ranks", "voxels", "reads", "edit s", "frame s", "MB"))
    for count in ranks:
        result = subprocess.run(
            ["mpiexec", "-np", str(count), "pvbatch", "--symmetric", os.path.abspath(__file__),
             "--scene", file, str(half)],
            env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if result.returncode != 0:
            sys.exit("pvbatch failed:\n" + result.stdout)
        rows = [line.split()[2:] for line in result.stdout.splitlines()
                if line.startswith("RANK ")]
        for shape in ("None", "Bend", "Twist"):
            worst = [max(float(row[i]) for row in rows if row[0] == shape) for i in range(1, 6)]
            print("%-10s %5d %12d %8.1f %10.3f %10.3f %8d" % (shape, count, *worst))
        sys.stdout.flush()


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == "--scene":
        scene(sys.argv[2], int(sys.argv[3]))
    elif len(sys.argv) > 1:
        main(sys.argv[1], *map(int, sys.argv[2:3]),
             **({"ranks": tuple(map(int, sys.argv[3:]))} if len(sys.argv) > 3 else {}))
    else:
        sys.exit(__doc__)
