#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Check the rules of the source tree that no compiler checks.

usage: check_layers.py [SOURCE]     check the tree SOURCE (default: the one this file lies in)
       check_layers.py --self-test  plant one violation of each rule in a scratch tree, and check
                                    that it is found and that the clean tree passes

The rules:
  kernel-include     files in a folder named Kernels include the standard library, GLM, Highway,
                     Eigen and kernel headers that their layer may see; never a vtk*.h. No Eigen in
                     files that are compiled for several instruction sets
  layer              a module includes headers of the modules below it only, as LAYERS says: the
                     deformation (Module), then volumes, then filters or rendering; files, physics and
                     widgets stand on the deformation alone. Its vtk.module names no others of ours
  export             a symbol is exported by the macro of its own module: FFD_CORE_EXPORT in
                     Module/Kernels, VTKFFDCORE_EXPORT in Module
  plugin-only        headers of ParaView and Qt only in paraview-plugin
  installed-private  an installed header (of a class that its folder's CMakeLists.txt lists in
                     set(classes ...), or one in set(headers ...)) includes no GLM, Highway, Eigen
                     or kernel header, and no header of ours that is not installed
  one-class          an installed header of a class exports one class, named as the file; other
                     headers export none
  spdx               each source file names its copyright and license in its first lines
  ascii              sources hold only ASCII characters
"""

import os
import re
import subprocess
import sys
import tempfile

SOURCE_SUFFIXES = (".h", ".hpp", ".txx", ".cxx", ".cpp", ".in", ".cmake", ".py", ".sh", ".xml",
                   ".module", ".md", ".yml", ".yaml", ".json", ".supp", ".txt", ".plugin")
CODE_SUFFIXES = (".h", ".hpp", ".txx", ".cxx", ".cpp")
SPDX_SUFFIXES = CODE_SUFFIXES + (".cmake", ".py", ".sh")
# Folders of the modules, and the further ones whose headers, kernels or not, each may use.
LAYERS = {
    "Module": (),
    "Module/Volumes": ("Module",),
    "Filters": ("Module", "Module/Volumes"),
    "Filters/IO": ("Module",),
    "Filters/Physics": ("Module",),
    "Rendering": ("Module", "Module/Volumes"),
    "Rendering/Widgets": ("Module",),
}
MODULES = {
    "Core": "Module",
    "Volumes": "Module/Volumes",
    "Filters": "Filters",
    "IO": "Filters/IO",
    "Physics": "Filters/Physics",
    "Rendering": "Rendering",
    "Widgets": "Rendering/Widgets",
}
# The standard library's headers have no suffix; these C ones are the exception.
C_HEADERS = {"assert.h", "float.h", "inttypes.h", "limits.h", "math.h", "stddef.h", "stdint.h",
             "stdio.h", "stdlib.h", "string.h"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^">]+)[">]', re.MULTILINE)
CLASS_LIST = re.compile(r"^set\(classes\s([^)]*)\)", re.MULTILINE)
HEADER_LIST = re.compile(r"^set\(headers\s([^)]*)\)", re.MULTILINE)
EXPORTED_CLASS = re.compile(r"^\s*class\s+\w+_EXPORT\s+(\w+)[^;]*?\{", re.MULTILINE)
# A macro where it is used, not where it is defined.
EXPORT = re.compile(r"^(?![ \t]*#).*?\b((?:VTKFFD|FFD_)\w*EXPORT)\b", re.MULTILINE)
MODULE_NAME = re.compile(r"\bFFD::(\w+)")
PLUGIN_HEADER = re.compile(r"^(vtkPV|vtkSM(?!P)|vtkSI(?!m)|pq|pv|Q[A-Z]|Qt[A-Z])\w*(\.h)?$|^Qt\w*/")
SKIPPED_FOLDERS = {".git", "__pycache__", "output", "Data"}


def source_files(root):
    """Paths, relative to root, of the tree's text files; build folders are left out."""
    found = []
    for folder, subfolders, names in os.walk(root):
        subfolders[:] = sorted(
            name for name in subfolders
            if name not in SKIPPED_FOLDERS and not name.startswith("build")
            and not os.path.exists(os.path.join(folder, name, "CMakeCache.txt")))
        for name in sorted(names):
            path = os.path.join(folder, name)
            relative = os.path.relpath(path, root)
            if not os.path.islink(path) and (
                    name.endswith(SOURCE_SUFFIXES) or relative == os.path.join(".ci", "run")
                    or name in (".clang-format", ".clang-tidy", ".gitignore", "LICENSE")):
                found.append(relative)
    return found


def layer_of(path):
    """The library folder that holds path, else None."""
    for layer in sorted(LAYERS, key=len, reverse=True):
        if path.replace(os.sep, "/").startswith(layer + "/"):
            return layer
    return None


def is_kernel(path):
    return "Kernels" in os.path.dirname(path).split(os.sep) and layer_of(path) is not None


def may_use(layer):
    return f"{layer} may use only " + ", ".join((layer, *LAYERS[layer]))


class Checker:
    def __init__(self, root):
        self.root = root
        self.violations = []
        self.files = source_files(root)
        # Headers that are installed: those of the classes, and those without any, that the layers'
        # CMakeLists.txt list.
        self.installed = set()
        self.without_class = set()
        for layer in LAYERS:
            listing = os.path.join(root, layer, "CMakeLists.txt")
            if os.path.exists(listing):
                with open(listing, encoding="utf-8") as file:
                    text = re.sub(r"#.*", "", file.read())
                for names in CLASS_LIST.findall(text):
                    self.installed.update(os.path.join(layer, name + ".h")
                                          for name in names.split())
                for names in HEADER_LIST.findall(text):
                    self.without_class.update(os.path.join(layer, name) for name in names.split())
        self.installed |= self.without_class
        # Our headers by file name: names are unique (checked), since headers flatten at install.
        self.headers = {}
        for path in self.files:
            if layer_of(path) is None or not path.endswith(CODE_SUFFIXES):
                continue
            name = os.path.basename(path)
            if path.endswith((".h", ".hpp", ".txx")):
                if name in self.headers:
                    self.report("layer", path, 1,
                                f"has the same name as {self.headers[name]}; headers are "
                                "included by name alone")
                self.headers[name] = path

    def report(self, rule, path, line, message):
        self.violations.append((rule, path, line, message))

    def run(self):
        for path in self.files:
            with open(os.path.join(self.root, path), "rb") as file:
                data = file.read()
            for number, line in enumerate(data.split(b"\n"), 1):
                if not line.isascii():
                    self.report("ascii", path, number, "holds a character that is not ASCII")
            text = data.decode("ascii", "replace")
            if path.endswith(SPDX_SUFFIXES) or path.endswith("CMakeLists.txt"):
                head = "\n".join(text.split("\n")[:5])
                if text.strip() and not ("SPDX-FileCopyrightText:" in head
                                         and "SPDX-License-Identifier: BSD-3-Clause" in head):
                    self.report("spdx", path, 1,
                                "has no SPDX lines at its start (copy them from another file)")
            if path.endswith(CODE_SUFFIXES):
                self.check_includes(path, text)
                if layer_of(path) is not None:
                    self.check_exports(path, text)
                    if path.endswith(".h") and not is_kernel(path):
                        self.check_class(path, text)
            if os.path.basename(path) == "vtk.module" and layer_of(path) is not None:
                self.check_module(path, text)
        return self.violations

    def check_module(self, path, text):
        """The vtk.module of a folder names itself and the modules that it may use."""
        layer = layer_of(path)
        for match in MODULE_NAME.finditer(text):
            named = MODULES.get(match.group(1))
            if named != layer and named not in LAYERS[layer]:
                self.report("layer", path, text.count("\n", 0, match.start()) + 1,
                            f"names {match.group()}; {may_use(layer)}")

    def check_exports(self, path, text):
        layer = layer_of(path)
        module = next(name for name, folder in MODULES.items() if folder == layer).upper()
        expected = f"FFD_{module}_EXPORT" if is_kernel(path) else f"VTKFFD{module}_EXPORT"
        for match in EXPORT.finditer(text):
            if match.group(1) != expected:
                self.report("export", path, text.count("\n", 0, match.start(1)) + 1,
                            f"exports by {match.group(1)}; its module's macro is {expected}")

    def check_includes(self, path, text):
        # Compiled once for each instruction set: inline functions of others would get mixed up.
        vectorized = path.endswith("-inl.h") or "hwy/foreach_target.h" in text
        for match in INCLUDE.finditer(text):
            quote, header = match.groups()
            line = text.count("\n", 0, match.start(2)) + 1
            name = os.path.basename(header)
            if PLUGIN_HEADER.match(header) and not path.startswith("paraview-plugin" + os.sep):
                self.report("plugin-only", path, line,
                            f"includes {header}; ParaView and Qt belong into paraview-plugin")
            if is_kernel(path):
                self.check_kernel_include(path, line, header, quote, vectorized)
            elif layer_of(path) is not None:
                self.check_class_include(path, line, header, name)

    def check_kernel_include(self, path, line, header, quote, vectorized):
        own = self.headers.get(os.path.basename(header))
        if header.startswith(("glm/", "hwy/")):
            return
        if header.startswith(("Eigen/", "unsupported/Eigen/")) and not vectorized:
            return
        if quote == "<" and (re.fullmatch(r"[a-z_]+", header) or header in C_HEADERS):
            return
        if own is not None and is_kernel(own):
            self.check_layer(path, line, own, layer_of(own))
            return
        # foreach_target.h of Highway includes the file itself, by a macro: no quoted path.
        self.report("kernel-include", path, line,
                    f"includes {header}; kernels may include the standard library, GLM, Highway, "
                    "Eigen (not for several instruction sets) and kernel headers only")

    def check_class_include(self, path, line, header, name):
        own = self.headers.get(name)
        if path in self.installed and (header.startswith(("glm/", "hwy/", "Eigen/", "unsupported/"))
                                       or (own is not None and own not in self.installed)):
            self.report("installed-private", path, line,
                        f"includes {header}, which is not installed; forward declare, or move "
                        "it into the .cxx")
        if own is None or own == path:
            # A module header (vtkFFD<Component>Module.h) belongs to the layer that writes it.
            generated = re.fullmatch(r"vtkFFD(\w+)Module\.h", name)
            if not generated or generated.group(1) not in MODULES:
                return
            layer = MODULES[generated.group(1)]
        else:
            layer = layer_of(own)
        self.check_layer(path, line, header, layer)

    def check_layer(self, path, line, header, layer):
        if layer != layer_of(path) and layer not in LAYERS[layer_of(path)]:
            self.report("layer", path, line,
                        f"includes {header} of {layer}; {may_use(layer_of(path))}")

    def check_class(self, path, text):
        classes = EXPORTED_CLASS.findall(text)
        if path not in self.installed or path in self.without_class:
            if classes:
                self.report("one-class", path, 1,
                            f"exports {', '.join(classes)} but is no installed class; list it "
                            "under set(classes ...) in the folder's CMakeLists.txt")
            return
        expected = os.path.basename(path)[:-2]
        if classes != [expected]:
            self.report("one-class", path, 1,
                        f"must export the class {expected} and no other; it exports "
                        + (", ".join(classes) or "none"))


def check(root):
    violations = Checker(root).run()
    for rule, path, line, message in violations:
        print(f"{path}:{line}: [{rule}] {message}", file=sys.stderr)
    return violations


SPDX_CXX = ("// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors\n"
            "// SPDX-License-Identifier: BSD-3-Clause\n")

CLEAN_TREE = {
    "Module/CMakeLists.txt": "set(classes\n  vtkFFDLow)\nset(headers vtkFFDNames.h)\n",
    "Module/vtkFFDNames.h": '#include "vtkVersionMacros.h"\n',
    "Filters/CMakeLists.txt": "set(classes\n  # of the pipeline\n  vtkFFDMiddle)\n",
    "Rendering/CMakeLists.txt": "set(classes vtkFFDTop)\nset(glue vtkFFDGlue.cxx)\n",
    "Rendering/vtkFFDGlue.h": '#include "FFDHigh.h"\n#include <glm/vec3.hpp>\n',
    "Module/vtk.module": "NAME\n  FFD::Core\n",
    "Module/Volumes/Kernels/FFDView.h": '#include "FFDBase.h"\n',
    "Rendering/vtk.module": "NAME\n  FFD::Rendering\nDEPENDS\n  FFD::Core\n  FFD::Volumes\n",
    "Rendering/Widgets/vtk.module": "NAME\n  FFD::Widgets\nDEPENDS\n  FFD::Core\n",
    "Module/Kernels/FFDBase.h": "#include <vector>\n#include <glm/vec3.hpp>\n",
    "Module/vtkFFDLow.h": '#include "vtkFFDCoreModule.h"\n#include "vtkFFDNames.h"\n'
                          "class VTKFFDCORE_EXPORT vtkFFDLow : public vtkObject\n{\n};\n",
    "Module/vtkFFDLow.cxx": '#include "vtkFFDLow.h"\n#include "FFDBase.h"\n#include <cmath>\n',
    "Filters/vtkFFDMiddle.h": '#include "vtkFFDFiltersModule.h"\n'
                              "class VTKFFDFILTERS_EXPORT vtkFFDMiddle : public vtkObject\n{\n};\n",
    "Rendering/Kernels/FFDHigh.cxx": '#include "FFDBase.h"\n#include <hwy/highway.h>\n'
                                     "#include <cstdint>\n#include <math.h>\n",
    "Rendering/Kernels/FFDHigh.h": "#include <string>\nclass FFD_RENDERING_EXPORT High\n{\n};\n",
    "Rendering/vtkFFDTop.h": '#include "vtkFFDRenderingModule.h"\n'
                             "class VTKFFDRENDERING_EXPORT vtkFFDTop : public vtkVolumeMapper\n"
                             "{\n};\n",
    "Rendering/Widgets/vtkFFDHandle.cxx": '#include "vtkFFDLow.h"\n',
    "paraview-plugin/Panel.cxx": '#include "vtkFFDTop.h"\n#include <QWidget>\n'
                                 '#include "vtkPVRenderView.h"\n',
}

# rule, file, text appended to it (or the file's whole text when it is new)
VIOLATIONS = (
    ("kernel-include", "Module/Kernels/FFDBase.h", '#include "vtkMath.h"\n'),
    ("kernel-include", "Module/Kernels/FFDBase.h", "#include <vtkSMPTools.h>\n"),
    ("kernel-include", "Rendering/Kernels/FFDHigh.cxx", "#  include <boost/any.hpp>\n"),
    ("kernel-include", "Rendering/Kernels/FFDSimdHigh-inl.h", "#include <Eigen/Core>\n"),
    ("kernel-include", "Rendering/Kernels/FFDHigh.cxx",
     "#include <hwy/foreach_target.h>\n#include <Eigen/Core>\n"),
    ("kernel-include", "Rendering/Kernels/FFDHigh.cxx", '#include "vtkFFDLow.h"\n'),
    ("layer", "Module/Kernels/FFDBase.h", '#include "FFDHigh.h"\n'),
    ("layer", "Module/vtkFFDLow.cxx", '#include "vtkFFDMiddle.h"\n'),
    ("layer", "Module/vtkFFDLow.cxx", '#include "FFDView.h"\n'),
    ("layer", "Rendering/vtkFFDTop.cxx", '#include "vtkFFDMiddle.h"\n'),
    ("layer", "Rendering/Widgets/vtkFFDHandle.cxx", '#include "FFDView.h"\n'),
    ("layer", "Rendering/Widgets/vtk.module", "PRIVATE_DEPENDS\n  FFD::Rendering\n"),
    ("export", "Rendering/Kernels/FFDHigh.h", "void FFD_CORE_EXPORT Cast();\n"),
    ("export", "Module/vtkFFDGuard.h", "FFD_CORE_EXPORT void vtkFFDGuard();\n"),
    ("layer", "Module/vtkFFDLow.cxx", '#include "FFDHigh.h"\n'),
    ("layer", "Filters/vtkFFDMiddle.h", '#include "vtkFFDRenderingModule.h"\n'),
    ("layer", "Rendering/Widgets/vtkFFDHandle.cxx", '#include "vtkFFDMiddle.h"\n'),
    ("layer", "Rendering/Widgets/vtkFFDHandle.cxx", '#include "vtkFFDTop.h"\n'),
    ("layer", "Filters/Kernels/FFDBase.h", "#include <vector>\n"),
    ("plugin-only", "Rendering/vtkFFDTop.cxx", "#include <QWidget>\n"),
    ("plugin-only", "Rendering/vtkFFDTop.cxx", '#include "vtkPVRenderView.h"\n'),
    ("installed-private", "Module/vtkFFDLow.h", "#include <glm/mat3x3.hpp>\n"),
    ("installed-private", "Rendering/vtkFFDTop.h", '#include "FFDHigh.h"\n'),
    ("installed-private", "Module/vtkFFDLow.h", "#include <hwy/highway.h>\n"),
    ("installed-private", "Module/vtkFFDLow.h", "#include <Eigen/Core>\n"),
    ("installed-private", "Rendering/vtkFFDTop.h", '#include "vtkFFDGlue.h"\n'),
    ("one-class", "Rendering/vtkFFDGlue.h", "class VTKFFDRENDERING_EXPORT vtkFFDGlue\n{\n};\n"),
    ("installed-private", "Module/vtkFFDNames.h", "#include <glm/vec3.hpp>\n"),
    ("one-class", "Module/vtkFFDNames.h", "class VTKFFDCORE_EXPORT vtkFFDOther\n{\n};\n"),
    ("one-class", "Module/vtkFFDLow.h", "class VTKFFDCORE_EXPORT vtkFFDOther\n{\n};\n"),
    ("ascii", "Module/vtkFFDLow.cxx", "// na\u00efve\n"),
    ("spdx", "Testing/Cxx/TestNew.cxx", "int TestNew() { return 0; }\n"),
)


def write(root, path, text):
    full = os.path.join(root, path)
    os.makedirs(os.path.dirname(full), exist_ok=True)
    with open(full, "a", encoding="utf-8") as file:
        file.write(text)


def self_test():
    failures = 0
    cases = [(None, None, None), *VIOLATIONS]
    for rule, path, text in cases:
        with tempfile.TemporaryDirectory() as root:
            for name, content in CLEAN_TREE.items():
                comment = "#" if name.endswith(".txt") else "//"
                write(root, name, SPDX_CXX.replace("//", comment) + content)
            if path is not None:
                new = not os.path.exists(os.path.join(root, path))
                write(root, path, (SPDX_CXX if new and rule != "spdx" else "") + text)
            # A run of the program, so that its output and exit status are checked as well.
            run = subprocess.run([sys.executable, os.path.abspath(__file__), root],
                                 capture_output=True, text=True, check=False)
            found = re.findall(r"\[([\w-]+)\]", run.stderr)
            if found != ([rule] if rule else []) or run.returncode != (1 if rule else 0):
                failures += 1
                print(f"self-test: {rule or 'clean tree'}: {path}: {text!r}: found {found}, "
                      f"exit status {run.returncode}\n{run.stderr}", file=sys.stderr)
    if failures == 0:
        print(f"self-test: the clean tree passes and each of {len(VIOLATIONS)} planted violations "
              "is found")
    return failures


def main(arguments):
    if arguments == ["--self-test"]:
        return 1 if self_test() else 0
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        print(__doc__)
        return 0 if arguments in (["-h"], ["--help"]) else 2
    root = arguments[0] if arguments else os.path.dirname(os.path.dirname(
        os.path.abspath(__file__)))
    violations = check(root)
    if violations:
        print(f"{len(violations)} violations of the rules in {os.path.abspath(__file__)}",
              file=sys.stderr)
        return 1
    print(f"{len(source_files(root))} files follow the rules")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
