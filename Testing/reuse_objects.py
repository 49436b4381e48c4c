#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compiler launcher of tests that build the tree once more: takes object files from another build where the
command is the same. Set CMAKE_CXX_COMPILER_LAUNCHER to

    <python>;-I;-S;reuse_objects.py;<this build's folder>;<the other build's folder>

Commands are the same if they differ by the build's folder, and by optimization, warnings and the macros
for symbols of shared libraries, at most. A generated source must also have the same content. Everything else
is compiled.
"""

import json
import os
import re
import shlex
import sys


def normalize(words, folder):
    """The words that decide what is compiled, with <build> for the folder."""
    own = re.compile(re.escape(folder) + r"(?=/|$)")
    words = [own.sub("<build>", word) for word in words]
    return [word for word in words
            if not re.match(r"-O.?$|-DNDEBUG$|-D\w+_EXPORTS$|-DH5_BUILT_AS_DYNAMIC_LIB$|-W|-MD$", word)]


def find_argument(words, name):
    """What follows an option; None without it."""
    return words[words.index(name) + 1] if name in words[:-1] else None


def drop_output(words):
    """The command without the names of its output and of the file with its dependencies."""
    left = list(words)
    for name in ("-o", "-MF", "-MT", "-MQ"):
        if name in left[:-1]:
            i = left.index(name)
            del left[i:i + 2]
    return left


def read(path, folder):
    """A file's text, with <build> for the folder."""
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        return file.read().replace(folder + "/", "<build>/")


def find_object(command, build, other):
    """The other build's object file that this command would make, or None."""
    source = find_argument(command, "-c")
    if source is None or find_argument(command, "-o") is None:
        return None
    source = os.path.abspath(source)
    generated = source.startswith(build + "/")
    twin = other + source[len(build):] if generated else source
    try:
        with open(os.path.join(other, "compile_commands.json"), encoding="utf-8") as file:
            entry = next((each for each in json.load(file) if each["file"] == twin), None)
        if entry is None:
            return None
        words = shlex.split(entry["command"])
        words = words[words.index(command[0]):]  # without a launcher
        if normalize(drop_output(words), other) != normalize(drop_output(command), build):
            return None
        if generated and read(twin, other) != read(source, build):
            return None
        found = os.path.join(entry["directory"], find_argument(words, "-o"))
        # Not one that is older than its source.
        return found if os.path.getmtime(found) >= os.path.getmtime(twin) else None
    except (OSError, ValueError):
        return None


def main(build, other, *command):
    """Copy the object file, or become the compiler; returns the status."""
    found = find_object(list(command), os.path.abspath(build), os.path.abspath(other))
    if found is None:
        os.execvp(command[0], command)
    target = find_argument(command, "-o")
    with open(found, "rb") as source, open(target, "wb") as copy:
        copy.write(source.read())
    dependencies = find_argument(command, "-MF")
    if dependencies:
        with open(dependencies, "w", encoding="utf-8") as file:
            file.write("%s: %s %s\n" % (target, *(
                path.replace(" ", "\\ ") for path in (found, find_argument(command, "-c")))))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
