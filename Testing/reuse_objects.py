#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compiler launcher of tests that build the tree once more: takes object files from another build by Ninja
where the command is the same. Set CMAKE_CXX_COMPILER_LAUNCHER to

    <python>;-I;-S;reuse_objects.py;<this build's folder>;<the other build's folder>

Commands are the same if they differ by the build's folder, and by optimization, warnings and the macros
for symbols of shared libraries, at most. Sources and headers that are generated must have the same content,
but for the visibility of symbols. No source or header may be younger than the object file. Everything else
is compiled.
"""

import json
import os
import re
import shlex
import subprocess
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
    """A generated file's text, with <build> for the folder, and without the visibility of symbols."""
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        text = file.read().replace(folder + "/", "<build>/")
    return re.sub(r'__attribute__\(\(visibility\("\w+"\)\)\)', "", text)


def list_dependencies(directory, output):
    """The source and the headers of an object file, as Ninja has noted them."""
    lines = subprocess.run(["ninja", "-t", "deps", output], cwd=directory, stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL, text=True, check=True).stdout.splitlines()
    if not lines or not lines[0].endswith("(VALID)"):
        raise ValueError("no valid dependencies of " + output)
    return [os.path.normpath(os.path.join(directory, line.strip())) for line in lines[1:] if line]


def find_object(command, build, other):
    """The other build's object file that this command would make, and what that depends on; or None."""
    source = find_argument(command, "-c")
    if source is None or find_argument(command, "-o") is None:
        return None

    def move(path, start, end):
        return end + path[len(start):] if path.startswith(start + "/") else path

    twin = move(os.path.abspath(source), build, other)
    try:
        with open(os.path.join(other, "compile_commands.json"), encoding="utf-8") as file:
            entry = next((each for each in json.load(file) if each["file"] == twin), None)
        if entry is None:
            return None
        words = shlex.split(entry["command"])
        words = words[words.index(command[0]):]  # without a launcher
        if normalize(drop_output(words), other) != normalize(drop_output(command), build):
            return None
        output = find_argument(words, "-o")
        found = os.path.join(entry["directory"], output)
        time = os.path.getmtime(found)
        dependencies = [found]
        for path in list_dependencies(entry["directory"], output):
            own = move(path, other, build)
            if os.path.getmtime(path) > time or own != path and read(path, other) != read(own, build):
                return None
            dependencies.append(own)
        return found, dependencies
    except (OSError, ValueError, subprocess.SubprocessError):
        return None


def main(build, other, *command):
    """Copy the object file, or become the compiler; returns the status."""
    reused = find_object(list(command), os.path.abspath(build), os.path.abspath(other))
    if reused is None:
        os.execvp(command[0], command)
    found, dependencies = reused
    target = find_argument(command, "-o")
    with open(found, "rb") as source, open(target, "wb") as copy:
        copy.write(source.read())
    note = find_argument(command, "-MF")
    if note:
        with open(note, "w", encoding="utf-8") as file:
            file.write("%s: %s\n" % (target, " ".join(path.replace(" ", "\\ ") for path in dependencies)))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
