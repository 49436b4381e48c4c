# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Optional Python packages for tests: those of the interpreter, or else from the package index that
pip is configured for, unpacked beside the build. Tests that cannot have them end with SKIPPED."""

import os
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
FOLDER = os.path.join(os.path.dirname(os.environ["FFD_TEST_TEMPORARY"]), "packages")

# The newest PyVista that takes VTK 9.1, with what it needs besides numpy, matplotlib and VTK, which
# are those of the system.
PYVISTA = ("pyvista==0.46.5", "scooby==0.12.1", "pooch==1.9.0", "platformdirs==4.14.7",
           "typing-extensions==4.16.0")
# trame with the parts that show pictures of a render window, whatever VTK has made it.
TRAME = ("trame==4.0.0", "trame-server==4.1.0", "trame-client==4.1.4", "trame-common==1.2.9",
         "trame-vuetify==3.3.0", "trame-rca==2.11.8", "wslink==2.6.0", "aiohttp==3.14.5",
         "aiohappyeyeballs==2.7.1", "aiosignal==1.4.0", "attrs==26.1.0", "frozenlist==1.8.0",
         "idna==3.20", "msgpack==1.2.4", "more-itertools==11.2.1", "multidict==7.2.1",
         "propcache==0.5.4", "pyyaml==6.0.3", "typing-extensions==4.16.0", "yarl==1.25.1")
# What describes scenes to pages that draw them.
TRAME_VTK = ("trame-vtk==2.11.17", "trame-client==4.1.4", "trame-common==1.2.9")
# What runs notebooks.
NOTEBOOK = ("nbclient==0.11.0", "asttokens==3.0.2", "attrs==26.1.0", "comm==0.2.3",
            "executing==2.3.0", "fastjsonschema==2.22.3", "ipykernel==7.4.0", "ipython==9.18.1",
            "ipython-pygments-lexers==1.1.1", "jsonschema==4.26.0",
            "jsonschema-specifications==2025.9.1", "jupyter-client==8.10.0",
            "jupyter-core==5.9.1", "matplotlib-inline==0.2.2", "nbformat==5.11.1",
            "nest-asyncio2==1.7.4", "packaging==26.3", "pexpect==4.9.0", "platformdirs==4.14.7",
            "prompt-toolkit==3.0.53", "psutil==7.2.2", "ptyprocess==0.7.0", "pure-eval==0.2.4",
            "pygments==2.21.0", "python-dateutil==4.0.0", "pyzmq==27.3.0", "referencing==0.37.0",
            "rpds-py==2026.9.1", "stack-data==0.6.3", "tornado==6.6.1", "traitlets==5.16.1",
            "typing-extensions==4.16.0", "wcwidth==0.9.4")


def require(module, packages):
    """The folder to put on PYTHONPATH, which is in sys.path from now on, or None if the interpreter
    has the module. Ends the process with SKIPPED if it is not to be had."""
    def has(*folder):
        environment = dict(os.environ)
        environment["PYTHONPATH"] = os.pathsep.join((*folder, environment.get("PYTHONPATH", "")))
        return subprocess.run([sys.executable, "-c", "import " + module], env=environment,
                              capture_output=True, text=True, check=False)

    if has().returncode == 0:
        return None
    # Without "=", at which wslink splits the names of folders.
    folder = os.path.join(FOLDER, packages[0].replace("==", "-"))
    if not os.path.isdir(folder):
        pip = shutil.which("pip3") or shutil.which("pip")
        if pip is None:
            _skip(module, "there is no pip")
        os.makedirs(FOLDER, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=FOLDER) as work:
            target = os.path.join(work, "packages")
            try:
                result = subprocess.run(
                    [pip, "install", "--quiet", "--no-deps", "--only-binary=:all:", "--retries=1",
                     "--timeout=30", "--disable-pip-version-check", "--python-version",
                     "%d.%d" % sys.version_info[:2], "--target", target, *packages],
                    capture_output=True, text=True, check=False, timeout=300)
            except subprocess.TimeoutExpired:
                _skip(module, "pip took too long")
            if result.returncode != 0:
                _skip(module, (result.stderr.strip().splitlines() or ["pip failed"])[-1])
            try:
                os.replace(target, folder)
            except OSError:
                if not os.path.isdir(folder):  # else another test was first
                    raise
    found = has(folder)
    if found.returncode != 0:
        _skip(module, found.stderr.strip().splitlines()[-1])
    sys.path.insert(0, folder)
    return folder


def _skip(module, reason):
    print("skipped: %s cannot be had (%s)" % (module, reason))
    sys.exit(SKIPPED)
