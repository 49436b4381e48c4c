#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a step of a drag, and of the slider of Strength, takes in ParaView beside the frame of the mapper.

    Examples/paraview.sh pvpython Testing/Benchmarks/paraview_drag.py [--size 256] [--steps 30]

A step changes one control point (or Strength), updates the pipeline, and renders as while the scene moves.
It is compared with moving the camera by a little and rendering, which is the mapper's frame and what ParaView
does for each frame anyway. Both in wall-clock and in processor time; then the still picture.
"""

import argparse
import os
import statistics
import time

from paraview import simple


def measure(steps, act, view):
    """Medians of wall-clock and processor time of act(step) and a moving frame after it, ms."""
    walls, works = [], []
    for step in range(steps):
        start, used = time.perf_counter(), time.process_time()
        act(step)
        view.SMProxy.InteractiveRender()
        walls.append(1e3 * (time.perf_counter() - start))
        works.append(1e3 * (time.process_time() - used))
    return statistics.median(walls), statistics.median(works)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--size", type=int, default=256, help="voxels along each axis")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--pixels", type=int, nargs=2, default=[800, 600])
    options = parser.parse_args()
    if not hasattr(simple, "FFDLattice"):
        simple.LoadPlugin(os.environ["FFD_PARAVIEW_PLUGIN"], remote=False, ns=vars(simple))
    half = options.size // 2
    wavelet = simple.Wavelet(WholeExtent=[-half, options.size - half - 1] * 3, Maximum=255.0,
                             XFreq=60.0 * 10 / half, YFreq=30.0 * 10 / half, ZFreq=40.0 * 10 / half)
    lattice = simple.FFDLattice(Input=wavelet, Shape="Twist", Strength=2.0)
    view = simple.CreateView("RenderView")
    view.ViewSize = options.pixels
    simple.Show(lattice, view)
    simple.GetColorTransferFunction("RTData").RescaleTransferFunction(37.0, 280.0)
    simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 140, 0, 0.5, 0,
                                                          180, 0.1, 0.5, 0, 280, 0.3, 0.5, 0]
    view.ResetCamera()
    simple.Render(view)
    points = [0.0] * 3 * 6 ** 3
    middle = 3 * (2 + 6 * (2 + 6 * 2))
    lattice.Displacements = points
    position = list(view.CameraPosition)

    def turn(step):
        view.CameraPosition = [position[0] + 0.1 * (step % 2), *position[1:]]

    def drag(step):
        points[middle] = 1.0 + 0.1 * step
        lattice.Displacements = points
        view.Update()

    def slide(step):
        lattice.Strength = 2.0 - 0.001 * step
        view.Update()

    for name, act in (("frame alone", turn), ("drag", drag), ("Strength", slide)):
        measure(3, act, view)
        print("%-12s %7.1f ms, %7.1f ms of processor time" % (
            name, *measure(options.steps, act, view)))
    start, used = time.perf_counter(), time.process_time()
    simple.Render(view)
    print("%-12s %7.1f ms, %7.1f ms of processor time" % (
        "still", 1e3 * (time.perf_counter() - start), 1e3 * (time.process_time() - used)))


if __name__ == "__main__":
    main()
