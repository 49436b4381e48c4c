#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Check that all C++ files are formatted as clang-format 14 formats them with .clang-format, and that no line
is longer than 100 columns.

usage: check_format.py [SOURCE]     check the tree SOURCE (default: the one this file lies in)
       check_format.py --fix        format all files; lines that are still too long are reported
       check_format.py --self-test  check that both kinds of problems are found

Other versions format otherwise. Where version 14 is missing (Debian 12: clang-format-14; elsewhere:
pip install clang-format==14.*) nothing is checked.
"""

import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

COLUMNS = 100
VERSION = "14"
AT_ONCE = 50  # files for each run of clang-format


def find_clang_format():
    for name in ("clang-format-" + VERSION, "clang-format"):
        program = shutil.which(name)
        if program:
            text = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
            if re.search(r"version %s\." % VERSION, text):
                return program
    return None


def sources(root):
    """C++ files of the tree; build folders are left out."""
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders
                            if not name.startswith(("build", ".")) and name not in ("output", "Data")
                            and not os.path.exists(os.path.join(folder, name, "CMakeCache.txt")))
        yield from (pathlib.Path(folder, name) for name in sorted(names)
                    if name.endswith((".h", ".cxx")))


def check(program, paths, root):
    """Problems of some files: the first line of each that is formatted otherwise, and lines that are too
    long."""
    problems = []
    result = subprocess.run([program, "--dry-run", "--style=file", *map(str, paths)],
                            capture_output=True, text=True)
    seen = set()
    for name, number in re.findall(r"^(.+?):(\d+):\d+: warning: ", result.stderr, re.M):
        if name not in seen:
            seen.add(name)
            problems.append("%s:%s: not formatted; check_format.py --fix" % (
                os.path.relpath(name, root), number))
    if result.returncode != 0:
        problems.append(result.stderr.strip())
    for path in paths:
        for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), 1):
            if len(line) > COLUMNS:
                problems.append("%s:%d: %d columns" % (path.relative_to(root), number, len(line)))
    return problems


def check_all(program, root):
    paths = list(sources(root))
    parts = [paths[first:first + AT_ONCE] for first in range(0, len(paths), AT_ONCE)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for problems in pool.map(lambda part: check(program, part, root), parts):
            yield from problems


def self_test(program, root):
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        shutil.copyfile(root / ".clang-format", scratch / ".clang-format")
        (scratch / "Good.cxx").write_text("int Good()\n{\n  int one = 1;\n  return one;\n}\n")
        (scratch / "Bad.cxx").write_text("int Bad() {\n    int one = 1;\n  return one;\n}\n")
        (scratch / "Long.cxx").write_text("// %s\nint Long;\n" % (100 * "x"))
        found = list(check_all(program, scratch))
    assert sorted(line.split(":")[0] for line in found) == ["Bad.cxx", "Long.cxx"], found


def main():
    root = pathlib.Path(__file__).resolve().parents[1]
    program = find_clang_format()
    if program is None:
        print("skipped: clang-format %s is not installed; Module/CMake/setup-debian.sh --documentation "
              "installs it on Debian 12" % VERSION)
        return
    if sys.argv[1:] == ["--self-test"]:
        self_test(program, root)
        return
    if sys.argv[1:] == ["--fix"]:
        subprocess.run([program, "-i", "--style=file", *map(str, sources(root))], check=True)
    elif sys.argv[1:]:
        root = pathlib.Path(sys.argv[1]).resolve()
    problems = list(check_all(program, root))
    for problem in problems:
        print(problem)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
