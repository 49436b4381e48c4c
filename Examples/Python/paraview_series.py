#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A volume that breathes, in ParaView's player: a volume and a displacement field for each phase.

    Examples/paraview.sh pvpython Examples/Python/paraview_series.py
    Examples/paraview.sh pvpython Examples/Python/paraview_series.py \\
        --volumes phase*.nii.gz --transforms field*.nii.gz --picture breathing.png

Without files a series of its own: the engine block, brighter and darker, in 8 phases. Plays it some
times, interpolated between the phases, and prints how many frames a second that made.
"""

import argparse
import math
import os
import tempfile
import time

import numpy as np
from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data")


def write_image(path, values, spacing):
    """A MetaImage, of numbers or of vectors."""
    with open(path, "wb") as file:
        file.write(("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                    "CompressedData = False\nOffset = 0 0 0\nElementSpacing = %g %g %g\n"
                    "DimSize = %d %d %d\nElementNumberOfChannels = %d\nElementType = %s\n"
                    "ElementDataFile = LOCAL\n" % (
                        *spacing, *values.shape[2::-1], 1 if values.ndim == 3 else 3,
                        "MET_UCHAR" if values.ndim == 3 else "MET_FLOAT")).encode("ascii"))
        file.write(values.tobytes())


def make_series(folder, phases, size):
    """Volumes of size^3 voxels, and fields that say for each point of a phase where it was at rest."""
    resampled = simple.ResampleToImage(
        Input=simple.OpenDataFile(os.path.join(DATA, "engine.vti")), SamplingDimensions=[size] * 3)
    resampled.UpdatePipeline()
    image = simple.servermanager.Fetch(resampled)
    rest = vtk_to_numpy(image.GetPointData().GetArray(0)).reshape((size,) * 3).astype(float)
    simple.Delete(resampled)
    nodes = 24
    grid = np.moveaxis(np.array(np.meshgrid(*[np.linspace(-1, 1, nodes)] * 3, indexing="ij")), 0, -1)
    volumes, transforms = [], []
    for phase in range(phases):
        breath = 0.5 - 0.5 * math.cos(2 * math.pi * phase / phases)
        volumes.append(os.path.join(folder, "volume%02d.mha" % phase))
        write_image(volumes[-1], (rest * (1.0 - 0.15 * breath)).astype(np.uint8), (1.0,) * 3)
        z, y, x = np.moveaxis(grid, -1, 0)
        swell = np.cos(0.5 * math.pi * x) * np.cos(0.5 * math.pi * y) * np.cos(0.5 * math.pi * z)
        field = 0.12 * size * breath * swell[..., None] * np.stack([-x, -y, 0.7 - z], axis=-1)
        transforms.append(os.path.join(folder, "field%02d.mha" % phase))
        write_image(transforms[-1], field.astype("<f4"), ((size - 1.0) / (nodes - 1.0),) * 3)
    return volumes, transforms


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--volumes", nargs="+", help="a file for each phase, or one for all")
    parser.add_argument("--transforms", nargs="+", help="a file for each phase, or a stack of elastix")
    parser.add_argument("--phases", type=int, default=8, help="of the series that is made")
    parser.add_argument("--size", type=int, default=128, help="voxels along each axis of that")
    parser.add_argument("--frames", type=int, default=4, help="pictures from phase to phase")
    parser.add_argument("--loops", type=int, default=3, help="how often it is played")
    parser.add_argument("--quality", type=float, default=0.5,
                        help="1: a ray for each pixel, and a sample for each voxel")
    parser.add_argument("--pixels", type=int, nargs=2, default=[512, 512], help="of the view")
    parser.add_argument("--picture", help="file of a picture in the middle of the series")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if not options.volumes or not options.transforms:
            options.volumes, options.transforms = make_series(folder, options.phases, options.size)
        play(options)


def show(options, view):
    """Volumes and transforms in the view, and the times of the player; returns the reader of the volumes."""
    volumes = simple.FFDVolumeReader(FileNames=options.volumes)
    transforms = simple.FFDTransformReader(FileNames=options.transforms)
    volume = simple.FFDApplyTransform(Input=volumes, Transform=transforms)
    if options.pixels:
        view.ViewSize = options.pixels
    display = simple.Show(volume, view)
    display.FFDSampleDistance = 1.0 / options.quality
    display.FFDImageSampleDistance = 1.0 / options.quality
    name = display.ColorArrayName[1]
    low, high = volume.PointData[name].GetRange(0)
    simple.GetColorTransferFunction(name).RescaleTransferFunction(low, high)
    simple.GetOpacityTransferFunction(name).Points = [
        low, 0.0, 0.5, 0.0, low + 0.3 * (high - low), 0.0, 0.5, 0.0,
        low + 0.5 * (high - low), 0.15, 0.5, 0.0, high, 0.8, 0.5, 0.0]
    view.ResetCamera(False)
    view.CameraPosition = np.add(view.CameraFocalPoint, [2.2 * options.size, 1.6 * options.size,
                                                         1.3 * options.size])
    view.CameraViewUp = [0.0, 0.0, 1.0]
    simple.Render(view)
    set_times(list(transforms.TimestepValues) or list(volumes.TimestepValues), options)
    return volumes


def set_times(times, options):
    scene = simple.GetAnimationScene()
    scene.StartTime, scene.EndTime = times[0], times[-1]
    scene.PlayMode = "Sequence"
    scene.NumberOfFrames = (len(times) - 1) * options.frames + 1


def play(options):
    view = simple.CreateView("RenderView")
    volumes = show(options, view)
    scene = simple.GetAnimationScene()
    for loop in range(options.loops):
        start = time.perf_counter()
        used = time.process_time()
        scene.GoToFirst()
        scene.Play()
        seconds = time.perf_counter() - start
        volumes.UpdatePipelineInformation()
        print("loop %d: %.1f frames a second (%.0f ms of processor time a frame), files read so far: %d"
              % (loop + 1, scene.NumberOfFrames / seconds,
                 1e3 * (time.process_time() - used) / scene.NumberOfFrames,
                 volumes.GetPropertyValue("NumberOfReads")))
    if options.picture:
        scene.AnimationTime = 0.5 * (scene.StartTime + scene.EndTime)
        simple.Render(view)
        simple.SaveScreenshot(options.picture, view)
        print("wrote", options.picture)


if __name__ == "__main__":
    main()
