# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Say what "import vtkffd" does: "imported", or its error; then which libraries of VTK are loaded."""

import os

try:
    import vtkffd  # noqa: F401
    print("imported")
except ImportError as error:
    print(error)
with open("/proc/self/maps", encoding="utf-8") as maps:
    libraries = {line.split()[-1] for line in maps if ".so" in line}
print("LIBRARIES", *(name for name in libraries if "vtk" in os.path.basename(name)))
