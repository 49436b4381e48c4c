#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run VTK's own volume tests with vtkFFDInverseRayVolumeMapper in the mapper's place.

Each C++ and Python test in a VTK source tree that names vtkFixedPointVolumeRayCastMapper,
vtkGPUVolumeRayCastMapper, or vtkSmartVolumeMapper is run twice: as it is, and with ours by a header
that is included before it (FFDInPlaceOfVTK.h) or by names that are replaced in Python. Nothing of
VTK's tree is copied or changed. The pictures of the two runs are compared, and a table is printed:
mean and largest difference of the channels, of 255, the part of the pixels that differ by more than 16,
and how the runs ended.

    Module/CMake/with-xvfb.sh Testing/VTKVolumeTests/compare_with_vtk.py VTK_SOURCE

The sources must be of the VTK release that vtkFFD is built against. Data files that are not in the
folder given by --data are replaced by stand-ins (standin_data.py).
"""

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import standin_data

HERE = Path(__file__).resolve().parent
# The mappers, and a helper of Python tests that has one.
MAPPERS = re.compile(
    r"vtk(FixedPointVolumeRayCast|GPUVolumeRayCast|OpenGLGPUVolumeRayCast|SmartVolume)Mapper"
    r"|FixedPointRayCasterNearest"
)
FOLDERS = (
    "Rendering/Volume/Testing",
    "Rendering/VolumeOpenGL2/Testing",
)


def find_tests(source, pattern):
    """Paths, relative to `source`, of the C++ and the Python tests to run."""
    found = {"*.cxx": [], "*.py": []}
    for folder in FOLDERS:
        for suffix, tests in found.items():
            for path in sorted((source / folder).rglob(suffix)):
                text = path.read_text(encoding="utf-8", errors="replace")
                if MAPPERS.search(text) and re.search(pattern, path.stem):
                    tests.append(path.relative_to(source))
    return found["*.cxx"], found["*.py"]


def build(source, tests, work, ffd_build, jobs):
    """Install vtkFFD into the work folder and compile the C++ tests, as far as they compile."""
    prefix = work / "prefix"
    subprocess.run(
        ["cmake", "--install", ffd_build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL
    )
    configure = [
        "cmake", "-S", HERE, "-B", work, "-G", "Ninja", "-D", "CMAKE_BUILD_TYPE=Release",
        "-D", f"VTK_SOURCE={source}", "-D", f"CMAKE_PREFIX_PATH={prefix}",
        "-D", "VTK_TESTS=" + ";".join(str(test) for test in tests),
    ]  # fmt: skip
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    targets = [f"{test.stem}_{mapper}" for test in tests for mapper in ("vtk", "ffd")]
    with open(work / "build.log", "w", encoding="utf-8") as log:
        command = ["cmake", "--build", work, f"-j{jobs}", "--target", *targets, "--", "-k", "0"]
        subprocess.run(command, check=False, stdout=log, stderr=subprocess.STDOUT)


def run(command, folder, timeout, **more):
    """Run one test; returns how it ended."""
    with open(folder / "log.txt", "w", encoding="utf-8") as log:
        try:
            code = subprocess.run(
                command, cwd=folder, timeout=timeout, stdout=log, stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL, check=False, **more
            ).returncode  # fmt: skip
        except subprocess.TimeoutExpired:
            for unfinished in folder.glob("*.png"):
                unfinished.unlink()
            return "timeout"
    if code < 0:
        return f"signal {-code}"
    # Without a baseline every test that gets as far as its picture ends with 1.
    text = (folder / "log.txt").read_text(encoding="utf-8", errors="replace")
    return "errors" if re.search(r"ERROR:| ERR\|", text) else "ended"


def read_image(path):
    reader = vtk.vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars())
    return pixels.reshape(image.GetDimensions()[1], image.GetDimensions()[0], -1)[..., :3]


def compare(theirs, ours):
    """Differences of the pictures that two runs left, as text."""
    paths = [sorted(folder.glob("*.png")) for folder in (theirs, ours)]
    if not paths[0] or not paths[1]:
        return "no picture of " + ("either" if not any(paths) else "VTK" if not paths[0] else "ours")
    a, b = (read_image(each[0]) for each in paths)
    if a.shape != b.shape:
        return f"sizes differ: {a.shape} and {b.shape}"
    if numpy.ptp(a.reshape(-1, 3), axis=0).max() == 0 and numpy.array_equal(a, b):
        return "nothing but a background"
    difference = numpy.abs(a.astype(int) - b.astype(int))
    part = 100.0 * numpy.mean(difference.max(axis=2) > 16)
    return f"{difference.mean():7.2f} {difference.max():5d} {part:7.2f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("source", type=Path, help="VTK's source tree, of the release in use")
    parser.add_argument("--build", type=Path, default=HERE.parents[1] / "build", help="vtkFFD's build")
    parser.add_argument("--work", type=Path, help="folder for what is made (BUILD/vtk-volume-tests)")
    parser.add_argument("--data", type=Path, help="folder with VTK's test data, as far as at hand")
    parser.add_argument("--only", default="", help="regular expression that names of tests match")
    parser.add_argument("--timeout", type=float, default=120.0, help="seconds for each run")
    parser.add_argument(
        "--replay", action="store_true", help="replay the recorded interaction of tests that have one"
    )
    parser.add_argument(
        "--keep", action="store_true", help="keep what VTK's mappers drew in an earlier run"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel compilers")
    options = parser.parse_args()
    source = options.source.resolve()
    ffd_build = options.build.resolve()
    work = (options.work or ffd_build / "vtk-volume-tests").resolve()
    cxx_tests, python_tests = find_tests(source, options.only)
    if not cxx_tests and not python_tests:
        parser.error(f"{source} has no volume tests that match; is it VTK's source tree?")
    work.mkdir(parents=True, exist_ok=True)

    root = work / "data"
    data = root / "Data"
    data.mkdir(parents=True, exist_ok=True)
    if options.data:
        for path in options.data.resolve().rglob("*"):
            link = data / path.relative_to(options.data.resolve())
            link.parent.mkdir(parents=True, exist_ok=True)
            if path.is_file() and not link.exists():
                link.symlink_to(path)
    standin_data.make(str(data), str(HERE.parent / "Data"))
    build(source, cxx_tests, work, ffd_build, options.jobs)

    print(f"{'test':56} {'mean':>7} {'most':>5} {'> 16':>9}   VTK's run, ours")
    environment = dict(os.environ)
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(ffd_build / "python"), str(HERE), environment.get("PYTHONPATH", "")]
    )
    crashed = False
    for test in cxx_tests + python_tests:
        ends = []
        folders = []
        for mapper in ("vtk", "ffd"):
            folder = work / "pictures" / test.name / mapper
            folder.mkdir(parents=True, exist_ok=True)
            folders.append(folder)
            # How a run ended is written last: what was interrupted is not kept.
            end = folder / "end.txt"
            if options.keep and mapper == "vtk" and end.exists():
                ends.append(end.read_text(encoding="utf-8"))
                continue
            for old in (*folder.glob("*.png"), *folder.glob("end.txt")):
                old.unlink()
            common = ["-D", str(root), "-T", str(folder)]
            if test.suffix == ".py":
                script = [sys.executable, str(HERE / "run_vtk_test.py"), mapper, str(source / test)]
                ends.append(
                    run([*script, *common, "-B", "/nowhere"], folder, options.timeout, env=environment)
                )
            elif (work / f"{test.stem}_{mapper}").exists():
                program = [str(work / f"{test.stem}_{mapper}"), *common]
                if not options.replay:
                    program.append("--DisableReplay")
                ends.append(run([*program, "-V", "/nowhere/picture.png"], folder, options.timeout))
            else:
                ends.append("does not compile")
            end.write_text(ends[-1], encoding="utf-8")
        crashed = crashed or ends[1].startswith("signal")
        print(f"{test.name:56} {compare(*folders):23}   {ends[0]}, {ends[1]}", flush=True)
    return 1 if crashed else 0


if __name__ == "__main__":
    sys.exit(main())
