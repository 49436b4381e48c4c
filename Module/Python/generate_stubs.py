# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Write the type stub of the package vtkffd, __init__.pyi, from what VTK's wrappers say in the docstrings
of its methods. VTK has vtkmodules.generate_pyi for its own modules, which Debian's packages lack.

usage: generate_stubs.py OUTPUT, with vtkffd on the path
"""

import re
import sys

import vtkffd

SIMPLE = {"int", "float", "str", "bool", "None"}
HEADER = '''# Made by Module/Python/generate_stubs.py; do not edit.
"""Volume rendering of deformed image data with VTK."""
from typing import Any, List, MutableSequence, Optional, Sequence, Tuple, overload

'''


def home_of(name):
    """The module of VTK that a class comes from, or None."""
    for module in list(sys.modules.values()):
        module_name = getattr(module, "__name__", "")
        if module_name.startswith("vtkmodules.vtk") and name in vars(module):
            return module_name
    return None


class Stub:
    def __init__(self):
        self.imports = set()

    def class_name(self, name):
        if name in vtkffd.__all__:
            return name
        home = home_of(name)
        if home is None:
            return "Any"
        self.imports.add(home)
        return home + "." + name

    def type_of(self, text, argument):
        """The annotation for a type as VTK writes it."""
        text = text.strip()
        if text in SIMPLE:
            return text
        parts = [part.strip() for part in text[1:-1].split(",")]
        if text.startswith("(") and all(part in SIMPLE for part in parts):
            return ("Sequence[%s]" % parts[0]) if argument else "Tuple[%s]" % ", ".join(parts)
        if text.startswith("[") and all(part in SIMPLE for part in parts):
            return "MutableSequence[%s]" % parts[0]
        if re.fullmatch(r"vtk\w+", text):
            name = self.class_name(text)
            return "Optional[%s]" % name if argument and name != "Any" else name
        return "Any"

    def signature(self, line):
        """One line of a docstring as a function of the stub."""
        match = re.fullmatch(r"(\w+)\((.*?)\)(?: -> (.*))?", line)
        if not match:
            return None
        name, arguments, result = match.groups()
        words = re.split(r",\s*(?![^()\[\]]*[)\]])", arguments) if arguments else []
        written = []
        for index, word in enumerate(words):
            word = word.strip()
            if word == "self":
                written.append("self")
                continue
            parts = re.fullmatch(r"(\w+):([^=]*)(=.*)?", word)
            if not parts:
                return None
            parameter = parts.group(1) if not parts.group(1).startswith("_arg") else "value%d" % index
            written.append("%s: %s%s" % (parameter, self.type_of(parts.group(2), True),
                                         " = ..." if parts.group(3) else ""))
        text = "    def %s(%s) -> %s: ...\n" % (name, ", ".join(written), self.type_of(result or "None", False))
        return text if words[:1] == ["self"] else "    @staticmethod\n" + text

    def method(self, member):
        """All signatures of a method."""
        lines = re.sub(r"\n {4,}", " ", member.__doc__ or "").split("\n")
        found = [self.signature(lines[at]) for at in range(len(lines) - 1)
                 if lines[at + 1].startswith("C++:")]
        found = list(dict.fromkeys(text for text in found if text))
        if len(found) > 1:
            return "".join("    @overload\n" + text for text in found)
        return "".join(found)

    def write_class(self, cls):
        base = cls.__mro__[1]
        lines = ["class %s(%s):\n" % (cls.__name__, self.class_name(base.__name__))]
        for name, member in sorted(vars(cls).items()):
            if name.startswith("__"):
                continue
            if isinstance(member, type):
                lines.append("    class %s(int): ...\n" % name)
            elif isinstance(member, int):
                kind = type(member).__name__
                lines.append("    %s: %s\n" % (name, "int" if kind == "int" else '"%s.%s"' % (
                    cls.__name__, kind)))
            elif callable(member):
                lines.append(self.method(member))
        if len(lines) == 1:
            lines.append("    ...\n")
        return "".join(lines)

    def write(self, path):
        classes = [self.write_class(getattr(vtkffd, name)) for name in vtkffd.__all__]
        # VTK's own modules have stubs in some packages, in others none: then their classes are Any.
        imports = "".join("import %s  # type: ignore\n" % name for name in sorted(self.imports))
        with open(path, "w", encoding="utf-8") as file:
            file.write(HEADER + imports + "\n__version__: str\n__all__: List[str]\n\n" + "\n".join(classes))


if __name__ == "__main__":
    Stub().write(sys.argv[1])
