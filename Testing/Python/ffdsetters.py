# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""For tests that call every setter of a class: which there are, and what they are called with."""

import re

import vtkffd
from TestHostileValues import make_image, signatures
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane, vtkPlaneCollection, vtkPlanes


def make_mask():
    mask = vtkImageData()
    mask.SetDimensions(12, 12, 12)
    mask.AllocateScalars(3, 1)  # VTK_UNSIGNED_CHAR
    values = vtk_to_numpy(mask.GetPointData().GetScalars())
    values[:] = 1
    values[:600] = 0
    return mask


def make_plane():
    plane = vtkPlane()
    plane.SetOrigin(5.0, 6.0, 5.0)
    plane.SetNormal(1.0, 0.5, 0.0)
    return plane


def make_planes():
    planes = vtkPlaneCollection()
    planes.AddItem(make_plane())
    return planes


OTHER_IMAGE = make_image(9, 5)
OBJECTS = {
    "vtkAbstractTransform": lambda: vtkffd.vtkFFDLattice(),
    "vtkImageData": make_mask,
    "vtkDataObject": lambda: OTHER_IMAGE,
    "vtkDataSet": lambda: OTHER_IMAGE,
    "vtkPlane": make_plane,
    "vtkPlaneCollection": make_planes,
    "vtkPlanes": vtkPlanes,
    "vtkTextureObject": lambda: None,
}


def setters(cls, extra=()):
    """Names of a class's setters, those of vtkObject left out, and their types of arguments."""
    for name in sorted(set(dir(cls)) - set(dir(vtkObject))):
        if name in extra or re.match(r"(Set|Add|Remove|Select)[A-Z]|\w+(On|Off)$", name):
            for types in signatures(getattr(cls, name)):
                yield name, types


def other_values(kind, current, objects):
    """Values of a type: what the getter gives, and others."""
    if kind == "float":
        now = current if isinstance(current, float) else 1.0
        return [now, 0.3 * now + 0.1, 2.0 * now + 0.5]
    if kind in ("int", "bool"):
        now = int(current) if isinstance(current, (int, bool)) else 1
        return [now, 1 - now if now in (0, 1) else 0, 2]
    if kind == "str":
        return ["scalars", None]
    if kind.startswith(("(", "[")):
        count = kind.count(",") + 1
        cast = float if "float" in kind else int
        now = list(current) if isinstance(current, tuple) and len(current) == count else None
        made = [cast(v) for v in ([2, 9] * count)[:count]]
        return ([now] if now else []) + [made]
    maker = objects.get(kind.split(".")[-1])
    return [maker(), None] if maker else [None]


def argument_lists(item, name, types, objects=OBJECTS):
    getter = getattr(item, re.sub("^Set", "Get", name), None)
    try:
        current = getter() if getter and name.startswith("Set") else None
    except TypeError:
        current = None
    if len(types) > 1 and isinstance(current, tuple) and len(current) == len(types):
        lists = [other_values(kind, value, objects) for kind, value in zip(types, current)]
    elif len(types) > 2 and set(types) == {"float"}:
        lists = [[2.0 + 7.0 * (i % 2), 3.0 + 5.0 * (i % 2)] for i in range(len(types))]
    else:
        lists = [other_values(kind, current, objects) for kind in types]
    longest = max((len(values) for values in lists), default=1)
    for i in range(1 if name == "AddClippingPlane" else longest):  # VTK crashes with None
        yield [values[min(i, len(values) - 1)] for values in lists]


def call(item, name, arguments):
    """Whether the wrapping lets the call through."""
    try:
        getattr(item, name)(*arguments)
    except (TypeError, ValueError, OverflowError):
        return False
    return True
