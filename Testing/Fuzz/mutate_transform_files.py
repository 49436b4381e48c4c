#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Give mutated transform files to vtkFFDTransformReader, with all that VTK does behind it.

Works in child processes of limited memory; a file that ends one, or that gives a transform that
is not finite, is kept in the output folder. PYTHONPATH is that of the package vtkffd.
"""

import argparse
import glob
import math
import os
import random
import resource
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
WORDS = (b"nan", b"inf", b"-1", b"0", b"1e309", b"4294967296", b"9223372036854775807", b"1e-320",
         b"\n", b" ", b"\0", b"=", b"(", b")", b"<", b"/>", b"3", b"100000")
GRID = ("MNI Transform File\nTransform_Type = Grid_Transform;\n"
        "Displacement_Volume = %s;\n")
FILES_PER_CHILD = 500
MEMORY = 2 << 30


def mutate(data, other, rng):
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4, 8))):
        at = rng.randrange(len(data) + 1)
        kind = rng.randrange(7)
        if kind == 0 and data:
            data[min(at, len(data) - 1)] = rng.randrange(256)
        elif kind == 1:
            data[at:at + rng.choice((1, 4, 64))] = b""
        elif kind == 2:
            data[at:at] = rng.choice(WORDS)
        elif kind == 3:
            data[at:at + rng.randrange(1, 9)] = rng.choice(WORDS)
        elif kind == 4:
            del data[at:]
        elif kind == 5:
            start = rng.randrange(len(other) + 1)
            data[at:at] = other[start:start + rng.choice((8, 64, 512))]
        else:
            # A number of the header.
            digits = [i for i in range(min(len(data), 2000)) if 48 <= data[i] <= 57]
            if digits:
                i = rng.choice(digits)
                data[i:i + 1] = rng.choice((b"0", b"9", b"99999", b"-1", b"1e9"))
    return bytes(data)


def child(path, seed, folders):
    import vtkffd
    from vtkmodules.vtkCommonCore import vtkObject
    vtkObject.GlobalWarningDisplayOff()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    rng = random.Random(seed)
    seeds = []
    for folder in folders:
        for name in sorted(glob.glob(os.path.join(folder, "*"))):
            if os.path.isfile(name) and not name.endswith((".py", ".json", ".raw")):
                with open(name, "rb") as file:
                    seeds.append((name, file.read()))
    taken = 0
    for _ in range(FILES_PER_CHILD):
        name, data = rng.choice(seeds)
        with open(path, "wb") as file:
            file.write(mutate(data, rng.choice(seeds)[1], rng))
        reader = vtkffd.vtkFFDTransformReader()
        reader.SetFileName(path)
        if name.endswith(".mnc"):
            # Volumes are read by way of a file that names them.
            with open(path + ".xfm", "w", encoding="ascii") as file:
                file.write(GRID % os.path.basename(path))
            reader.SetFileName(path + ".xfm")
        transform = reader.GetTransform()
        if transform is not None:
            taken += 1
            point = transform.TransformPoint(1.0, 2.0, 3.0)
            if not all(math.isfinite(x) for x in point):
                print("not finite", point)
                sys.exit(3)
    print(taken)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--output", default="fuzz-output")
    parser.add_argument("--seeds", nargs="*", default=[
        os.path.join(ROOT, "Testing", "Data", "Transforms"),
        os.path.join(ROOT, "Testing", "Data", "Fuzz")])
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        child(arguments.child[0], int(arguments.child[1]), arguments.seeds)
        return 0
    os.makedirs(arguments.output, exist_ok=True)
    end = time.monotonic() + arguments.seconds
    runs = taken = found = 0
    while time.monotonic() < end:
        path = os.path.join(arguments.output, "current")
        run = subprocess.run(
            [sys.executable, __file__, "--child", path, str(runs), "--seeds", *arguments.seeds],
            capture_output=True, text=True, check=False)
        if run.returncode != 0:
            found += 1
            os.replace(path, os.path.join(arguments.output, "found-%d" % runs))
            print("seed %d: exit status %d\n%s%s" % (runs, run.returncode, run.stdout,
                                                     run.stderr[-2000:]), flush=True)
        else:
            taken += int(run.stdout)
        runs += 1
    print("%d files, %d taken as transforms, %d failures" % (runs * FILES_PER_CHILD, taken, found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
