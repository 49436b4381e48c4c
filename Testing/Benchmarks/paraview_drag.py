#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a step of a drag, and of the slider of Strength, takes in ParaView beside the frame of the mapper.

    Examples/paraview.sh pvpython Testing/Benchmarks/paraview_drag.py [--size 256] [--steps 30]

A step changes one control point (or Strength), updates the pipeline, and renders as while the scene moves.
It is compared with moving the camera by a little and rendering, which is the mapper's frame and what ParaView
does for each frame anyway. The three are measured in turns, in wall-clock and in processor time; then the still
picture. Each frame of the volume as it moves is looked at once: one without the volume ends this.
"""

import argparse
import os
import statistics
import time

from paraview import simple
from paraview.modules.vtkRemotingViews import vtkPVRenderView  # noqa: F401
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray


def measure(act, step, view):
    """Wall-clock and processor time of act(step) and a moving frame after it, ms."""
    start, used = time.perf_counter(), time.process_time()
    act(step)
    view.SMProxy.InteractiveRender()
    return 1e3 * (time.perf_counter() - start), 1e3 * (time.process_time() - used)


def shows_volume(view):
    """Whether the window's last frame has more than a background in the middle."""
    window = view.GetRenderWindow()
    width, height = window.GetActualSize()
    pixels = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 1, pixels)
    middle = (height // 2) * width + width // 2
    return pixels.GetTuple(0) != pixels.GetTuple(middle)


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

    acts = (("frame alone", turn), ("drag", drag), ("Strength", slide))
    times = {name: [] for name, _ in acts}
    for step in range(-3, options.steps):
        for name, act in acts:
            taken = measure(act, step, view)
            if step < 0:
                if not shows_volume(view):
                    raise RuntimeError("The frame does not show the volume: " + name)
            else:
                times[name].append(taken)
    base = [statistics.median(values) for values in zip(*times["frame alone"])]
    for name, values in times.items():
        medians = [statistics.median(each) for each in zip(*values)]
        print("%-12s %7.1f ms (%+.1f), %7.1f ms of processor time (%+.1f)" % (
            name, medians[0], medians[0] - base[0], medians[1], medians[1] - base[1]))
    start, used = time.perf_counter(), time.process_time()
    simple.Render(view)
    print("%-12s %7.1f ms, %7.1f ms of processor time" % (
        "still", 1e3 * (time.perf_counter() - start), 1e3 * (time.process_time() - used)))


if __name__ == "__main__":
    main()
