#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Check what pyproject.toml says of the wheel: the version of the project is CMake's, one minor version of
VTK is meant everywhere, and the licenses are there. Builds nothing."""

import glob
import os
import re
import sys

try:
    import tomllib
except ImportError: # Python 3.10 and before
    print("skipped: this Python has no module tomllib")
    sys.exit(77)

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def read(*path):
    with open(os.path.join(SOURCE, *path), encoding="utf-8") as file:
        return file.read()


def read_project():
    return tomllib.loads(read("pyproject.toml"))


def cmake_version():
    return re.search(r"project\(FFD\s+VERSION ([0-9.]+)", read("CMakeLists.txt")).group(1)


def vtk_minor():
    """The minor version of VTK that the wheel is for, as "9.5"."""
    return read_project()["tool"]["scikit-build"]["cmake"]["define"]["FFD_WHEEL_VTK"]


def main():
    project = read_project()
    settings = project["tool"]["scikit-build"]
    version = re.search(settings["metadata"]["version"]["regex"], read("CMakeLists.txt"))
    assert version and version.group("value") == cmake_version(), "pyproject.toml finds no version"
    assert "version" in project["project"]["dynamic"]

    minor = re.escape(vtk_minor())
    requirements = project["build-system"]["requires"]
    for package in ("vtk-sdk", "vtk"):
        assert any(re.fullmatch(package + "==" + minor + r"\.\d+", line) for line in requirements), \
            "the build requirement %s is not one of VTK %s" % (package, vtk_minor())
    assert "vtk==%s.*" % vtk_minor() in project["project"]["dependencies"]
    assert re.search(r"vtk==%s\." % minor, read("README.md")), "README.md names another VTK for the wheel"

    for pattern in project["project"]["license-files"]:
        assert glob.glob(os.path.join(SOURCE, pattern)), "there is no " + pattern
    for library in ("Highway", "GLM", "Eigen"):
        assert library in read("Module", "Python", "licenses", library + ".txt")
    print("the wheel is vtkffd %s for VTK %s" % (cmake_version(), vtk_minor()))


if __name__ == "__main__":
    main()
