#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Assemble a vtk-sdk wheel for Linux, for the test of our wheel alone.

VTK publishes its SDK for Linux in its own package registry; PyPI has that of VTK 9.5.0 for macOS. Where
only PyPI can be reached, a working one is made of three parts:

- headers and CMake package of the macOS vtk-sdk, told of Linux: names of libraries, no Cocoa;
- the libraries of the Linux wheel of the same VTK;
- the wrapping tools of Debian 13, VTK 9.3, from the mirror that apt is configured for. They know nothing
  of three kinds of hints of VTK 9.5, which are made empty in its headers.

usage: assemble_sdk.py FOLDER   writes vtk_sdk-9.5.0-<tag>.whl there, for the interpreter that runs it

Ends with status 77 and "skipped: ..." where a part cannot be had.
"""

import base64
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

VTK = "9.5.0"
SKIPPED = 77
SUITE = "trixie"
TOOLS_VERSION = "9.3"
# The hints that the tools do not know.
UNKNOWN_HINTS = r"\[\[vtk::(?:propexclude|unblockthreads|marshal\w+(?:\(.*\))?)\]\]"
# The tools are called as those of VTK 9.5 are: these write files of dependencies, and one source of a
# module in the place of two.
WRAP = """#!/bin/sh
if [ "$1" = -MF ]; then
  : >"$2"
  shift 2
fi
folder="$(dirname "$0")"
LD_LIBRARY_PATH="$folder" exec "$0-9.3" "$@"
"""
INIT = """#!/bin/sh
folder="$(dirname "$0")"
LD_LIBRARY_PATH="$folder" "$0-9.3" "$1" "$2.init" "$2.impl" && cat "$2.init" "$2.impl" >"$2"
"""
TOOLS = {"vtkWrapHierarchy": WRAP, "vtkWrapPython": WRAP, "vtkWrapPythonInit": INIT}
METADATA = "Metadata-Version: 2.1\nName: vtk-sdk\nVersion: %s\nSummary: Assembled for a test\n"


def skip(reason):
    print("skipped: " + reason)
    sys.exit(SKIPPED)


def run(what, *command, **options):
    """Run what needs the network; without success the test is skipped."""
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600,
                                **options)
    except (OSError, subprocess.TimeoutExpired) as error:
        skip("%s (%s)" % (what, error))
    if result.returncode != 0:
        lines = (result.stderr or result.stdout).strip().splitlines()
        skip("%s (%s)" % (what, lines[-1] if lines else "no message"))
    return result.stdout


def download_wheel(work, package, *options):
    """The folder in which the wheel of a package is unpacked."""
    folder = os.path.join(work, package)
    run("%s %s cannot be had from the package index" % (package, VTK),
        sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:",
        "--disable-pip-version-check", "--dest", folder, *options, "%s==%s" % (package, VTK))
    for wheel in glob.glob(os.path.join(folder, "*.whl")):
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(folder)
        os.remove(wheel)
    return folder


def mirror():
    """The mirror of Debian that apt is configured for."""
    targets = run("apt knows no mirror", "apt-get", "indextargets", "--format", "$(LABEL) $(REPO_URI)",
                  "Created-By: Packages")
    for line in targets.splitlines():
        label, _, address = line.partition(" ")
        if label == "Debian":
            return address
    return skip("apt is not configured for any mirror of Debian")


def download_tools(work):
    """The folder in which the wrapping tools of Debian are unpacked; nothing is installed."""
    apt = os.path.join(work, "apt")
    for folder in ("lists/partial", "archives/partial", "tools"):
        os.makedirs(os.path.join(apt, folder))
    sources = os.path.join(apt, "sources.list")
    with open(sources, "w", encoding="ascii") as file:
        file.write("deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] %s %s main\n" % (
            mirror(), SUITE))
    settings = {
        "Dir::Etc::SourceList": sources, "Dir::Etc::SourceParts": "/dev/null",
        "Dir::State::Lists": os.path.join(apt, "lists"), "Dir::State::status": "/dev/null",
        "Dir::Cache": apt, "Dir::Cache::Archives": os.path.join(apt, "archives"),
        "Acquire::Languages": "none", "APT::Sandbox::User": "", "APT::Update::Error-Mode": "any"}
    options = [word for name, value in settings.items() for word in ("-o", "%s=%s" % (name, value))]
    what = "the wrapping tools of Debian's %s cannot be had" % SUITE
    run(what, "apt-get", *options, "update")
    run(what, "apt-get", *options, "download", "vtk9", "python3-vtk9", "libvtk" + TOOLS_VERSION, cwd=apt)
    tools = os.path.join(apt, "tools")
    for package in glob.glob(os.path.join(apt, "*.deb")):
        run(what, "dpkg-deb", "--extract", package, tools)
    return tools


def edit(path, *replacements):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for pattern, replacement in replacements:
        text, count = re.subn(pattern, replacement, text, flags=re.MULTILINE)
        if count == 0:
            raise RuntimeError("%s: there is nothing like %s" % (path, pattern))
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def assemble(sdk, wheel, tools):
    """Turn the unpacked SDK of macOS into one for Linux, in place. The folder with the package vtk_sdk."""
    content = os.path.join(sdk, "vtk_sdk", "content")
    headers = os.path.join(content, "vtk-%s.data" % VTK, "headers")
    cmake = os.path.join(headers, "cmake")
    for folder in ("build", "bin", "vtkmodules"):
        shutil.rmtree(os.path.join(content, folder))

    # Libraries lie as in the wheel, whose paths between them are relative.
    for name in ("vtkmodules", "vtk.libs"):
        os.mkdir(os.path.join(content, name))
        for library in glob.glob(os.path.join(wheel, name, "lib*.so*")):
            os.rename(library, os.path.join(content, name, os.path.basename(library)))
    for name in ("VTK-targets-release.cmake", os.path.join("viskores", "ViskoresTargets-release.cmake")):
        edit(os.path.join(cmake, name),
             (r"/build/lib\.macosx-[^/]*/vtkmodules/\.dylibs/(lib[\w.-]*)\.dylib", r"/vtkmodules/\1.so"),
             (r"@rpath/(lib[\w.-]*)\.dylib", r"\1.so"))
    edit(os.path.join(cmake, "VTK-targets-release.cmake"),
         (r"(libvtkWrappingPythonCore)3\.10", r"\g<1>%d.%d" % sys.version_info[:2]))
    # What is not there is not used: VTK's Python modules, Java.
    for name in ("VTK-targets-release.cmake", "VTKPython-targets-release.cmake"):
        edit(os.path.join(cmake, name), (r"^list\(APPEND _cmake_import_check_files_for_.*\n", ""))
    edit(os.path.join(cmake, "VTK-targets.cmake"), (r";-framework Cocoa", ""))
    include = os.path.join(headers, "vtk-" + VTK.rpartition(".")[0])
    edit(os.path.join(include, "vtkRenderingOpenGLConfigure.h"),
         (r"^#define VTK_USE_COCOA$", "#define VTK_USE_X"))
    edit(os.path.join(include, "vtkWrappingHints.h"), (UNKNOWN_HINTS, ""))

    os.mkdir(os.path.join(content, "bin"))
    library = "libvtkWrappingTools-%s.so.1" % TOOLS_VERSION
    found = glob.glob(os.path.join(tools, "usr", "lib", "*", library))
    shutil.copy(found[0], os.path.join(content, "bin", library))
    for tool, script in TOOLS.items():
        program = "%s-%s" % (tool, TOOLS_VERSION)
        shutil.copy(os.path.join(tools, "usr", "bin", program), os.path.join(content, "bin", program))
        path = os.path.join(content, "bin", tool)
        with open(path, "w", encoding="ascii") as file:
            file.write(script)
        os.chmod(path, 0o755)
    return os.path.join(sdk, "vtk_sdk")


def write_wheel(package, output):
    """Pack the folder of a package as a wheel, uncompressed, with the entry point of the SDK."""
    tag = "cp{0}{1}-cp{0}{1}-{2}".format(*sys.version_info[:2], re.sub(
        r"[.-]", "_", sysconfig.get_platform()))
    name = "vtk_sdk-%s-%s.whl" % (VTK, tag)
    information = "vtk_sdk-%s.dist-info/" % VTK
    record = []
    with zipfile.ZipFile(os.path.join(output, name + ".part"), "w") as archive:
        def add(target, content, mode=0o644):
            entry = zipfile.ZipInfo(target)
            entry.external_attr = (0o100000 | mode) << 16
            archive.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
            record.append("%s,sha256=%s,%d" % (target, digest, len(content)))

        for folder, _, files in os.walk(package):
            for file in files:
                path = os.path.join(folder, file)
                with open(path, "rb") as stream:
                    add(os.path.relpath(path, os.path.dirname(package)), stream.read(),
                        os.stat(path).st_mode & 0o777)
        for file, text in (("METADATA", METADATA % VTK),
                           ("WHEEL", "Wheel-Version: 1.0\nGenerator: assemble_sdk\n"
                                     "Root-Is-Purelib: false\nTag: %s\n" % tag),
                           ("entry_points.txt", "[cmake.prefix]\nany = vtk_sdk.cmake\n")):
            add(information + file, text.encode("ascii"))
        record.append(information + "RECORD,,")
        archive.writestr(information + "RECORD", "\n".join(record) + "\n")
    os.replace(os.path.join(output, name + ".part"), os.path.join(output, name))
    return os.path.join(output, name)


def main(output):
    if sys.platform != "linux" or os.uname().machine != "x86_64":
        skip("an SDK is assembled for Linux on x86_64 only")
    os.makedirs(output, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=output) as work:
        sdk = download_wheel(work, "vtk-sdk", "--platform=macosx_10_9_x86_64", "--python-version=3.10")
        wheel = download_wheel(work, "vtk")
        package = assemble(sdk, wheel, download_tools(work))
        print(write_wheel(package, output))


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__)
        sys.exit(2)
    main(os.path.abspath(sys.argv[1]))
