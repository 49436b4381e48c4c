# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Headers against their code: each documented default of an option that a class can be asked for,
the tables of options that the documentation makes of them, and what the header of the mapper says of
the scenes that the reference kernels render."""

import pathlib
import re
import sys
import unittest

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume)

import vtkffd

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "Module" / "Documentation"))
import build_site  # noqa: E402 # pylint: disable=wrong-import-position
import header_options  # noqa: E402 # pylint: disable=wrong-import-position

GETTER = re.compile(r"vtkGet(?:Vector\d)?Macro\((\w+)")
# "Default: 0.1.", "Defaults: 1 and 10.", "default 0.05", "Default FREE, the plane of the view"
DEFAULT = re.compile(r"\b[Dd]efaults?:? +([-\w./]+(?:(?:, | and )[-\w./]+)*)")
# Setters with a getter that are no options: parts of what a class holds, and what belongs to VTK.
NO_OPTIONS = {"ControlPoint", "Displacement", "Displacements", "SelectedPoints",
              "AbortExecute", "Enabled", "Interactor", "Representation"}
WORDS = {"on": 1, "off": 0, "none": None, "null": None}


def documented(header):
    """(getter names, documented defaults) of the groups of a header that have both."""
    groups = r"/\*\*(.*?)\*/(.*?)(?=/\*\*|///@\}|///@\{|\Z)"
    for comment, code in re.findall(groups, header.read_text(), re.S):
        names = GETTER.findall(code)
        text = re.sub(r"\s*\n\s*\* ?", " ", comment)
        defaults = [[word.rstrip(".") for word in re.split(r", | and ", words)]
                    for words in DEFAULT.findall(text)]
        if names and defaults:
            yield names, defaults


def value_of(cls, word):
    """What a documented default stands for; ValueError for prose."""
    if word in WORDS:
        return WORDS[word]
    if re.fullmatch(r"[A-Z]\w+", word) and hasattr(cls, word):
        return getattr(cls, word)
    numerator, _, denominator = word.partition("/")
    return float(numerator) / float(denominator or 1)


def values_of(cls, words):
    """The values that words begin with: "5, as the paper" is 5. ValueError for prose."""
    values = [value_of(cls, words[0])]
    for word in words[1:]:
        try:
            values.append(value_of(cls, word))
        except ValueError:
            break
    return values


class TestDefaults(unittest.TestCase):
    def test_defaults_are_those_of_the_headers(self):
        checked = 0
        for header in sorted(SOURCE.glob("[FMR]*/**/vtkFFD*.h")):
            cls = getattr(vtkffd, header.stem, None)
            groups = list(documented(header)) if cls else []
            thing = cls() if groups else None
            for names, defaults in groups:
                got = []
                for name in names:
                    value = getattr(thing, "Get" + name)()
                    got.extend(value if isinstance(value, tuple) else [value])
                try:
                    wanted = [value for words in defaults for value in values_of(cls, words)]
                except ValueError:
                    continue  # prose, as "that of the input"
                if len(names) == 1 and len(wanted) == 1 and wanted[0] is not None:
                    wanted *= len(got)
                if len(wanted) == len(got):
                    checked += 1
                    with self.subTest(header=header.name, names=names):
                        self.assertEqual(got, wanted)
        self.assertGreater(checked, 80)


class TestTablesOfOptions(unittest.TestCase):
    def test_defaults_are_those_of_the_classes(self):
        """Each option of a table has a default: that of the class, or prose."""
        compared = 0
        for header in sorted(SOURCE.glob("[FMR]*/**/vtkFFD*.h")):
            text = header.read_text(encoding="utf-8")
            cls = getattr(vtkffd, header.stem, None)
            rows = list(header_options.groups_of_options(text)) if cls else []
            # Of an abstract class: one of a class that is derived from it.
            made = {vtkffd.vtkFFDWarpTransform: vtkffd.vtkFFDSumTransform}.get(cls, cls)
            thing = made() if rows else None
            for names, values, defaults, _ in rows:
                for name, value, default in zip(names, values, defaults, strict=True):
                    with self.subTest(cls=header.stem, option=name):
                        # The coefficients of a lattice are its own: there is nothing to tell of them.
                        self.assertTrue(default or name == "CoefficientData")
                        try:
                            wanted = [value_of(cls, word) for word in default.split(", ")]
                            got = getattr(thing, "Get" + name)()
                        except (TypeError, ValueError):
                            continue  # prose, or a getter with arguments
                        if wanted[0] is None:
                            continue  # "none, which means ..."
                        got = list(got) if isinstance(got, tuple) else [got]
                        self.assertEqual(got, wanted * (len(got) // len(wanted)), value)
                        compared += 1
        self.assertGreater(compared, 150)

    def test_no_option_is_missing(self):
        """A setter with a getter, be it that of the superclass, has a row."""
        for name, header in sorted(build_site.public_headers(SOURCE).items()):
            text = header.read_text(encoding="utf-8")
            cls = getattr(vtkffd, name)
            rows = {option for names, *_ in header_options.groups_of_options(text)
                    for option in names}
            declared = header_options.public_part(text)
            options = set(re.findall(r"\bSet(\w+)\([^)]", declared))
            options.update(re.findall(r"\bvtkSet\w*Macro\((\w+)", declared))
            getters = {option for option in options if hasattr(cls, "Get" + option)}
            with self.subTest(cls=name):
                self.assertEqual(getters - rows - NO_OPTIONS, set())

    def test_rows(self):
        """Options in the order of the comment's defaults, and all of what they may be."""
        header = """class A
{
public:
  ///@{
  /**
   * Length and count. Defaults: 0.5 and 3.
   */
  void SetLength(double length);
  vtkGetMacro(Length, double);
  vtkSetClampMacro(Count, int, 1, 9);
  vtkGetMacro(Count, int);
  ///@}

  ///@{
  /**
   * The kind. Default: B.
   */
  vtkSetMacro(Kind, int);
  vtkGetMacro(Kind, int);
  void SetKindToA() { this->SetKind(A); }
  void SetKindToB()
  {
    this->SetKind(B);
  }
  ///@}

  ///@{
  /**
   * Point i.
   */
  void SetPoint(int i, double x);
  double GetPoint(int i);
  ///@}

protected:
"""
        rows = [row[:3] for row in header_options.groups_of_options(header)]
        self.assertEqual(rows, [(["Length", "Count"], ["number", "1 to 9"], ["0.5", "3"]),
                                (["Kind"], ["`A`, `B`"], ["B"])])


def evaluations(dimensions, components, gradient, mode, reference):
    """Evaluations of the deformation in a picture: they tell which kernels made it."""
    image = vtkImageData()
    image.SetDimensions(dimensions)
    values = np.random.RandomState(1).rand(image.GetNumberOfPoints(), components) * 255
    scalars = numpy_to_vtk(values.astype(np.float32), deep=1)
    image.GetPointData().SetScalars(scalars)
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(5, 5, 5)
    lattice.FitToBounds(image.GetBounds())
    vtkffd.vtkFFDLatticeSource.ApplyShape(lattice, vtkffd.vtkFFDLatticeSource.TWIST, 0.5)
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputData(image)
    mapper.SetDeformation(lattice)
    mapper.SetReferenceKernels(reference)
    mapper.CollectStatisticsOn()
    if mode == "GREEDY_ANGLE":
        mapper.SetSegmentationToGreedyAngle()
    elif mode:
        getattr(mapper, "SetBlendModeTo" + mode)()
    volume = vtkVolume()
    volume.SetMapper(mapper)
    prop = volume.GetProperty()
    prop.SetInterpolationTypeToLinear()
    plane = vtkPlane()
    plane.SetOrigin(image.GetCenter())
    prop.SetSliceFunction(plane)
    prop.GetIsoSurfaceValues().SetValue(0, 120)
    for c in range(components):
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0, 0.0)
        opacity.AddPoint(255, 0.5)
        prop.SetScalarOpacity(c, opacity)
        prop.SetColor(c, vtkColorTransferFunction())
        prop.GetRGBTransferFunction(c).AddRGBPoint(0, 1, 0, 0)
        if gradient:
            factor = vtkPiecewiseFunction()
            factor.AddPoint(0, 0.2)
            factor.AddPoint(60, 1.0)
            prop.SetGradientOpacity(c, factor)
    renderer = vtkRenderer()
    renderer.AddVolume(volume)
    renderer.ResetCamera()
    assert mapper.RenderToImage(renderer, volume, 48, 48, vtkImageData())
    return mapper.GetStatistics().GetNumberOfEvaluations()


class TestReferenceKernels(unittest.TestCase):
    """The scenes that the header names."""

    def check(self, always, dimensions, components=1, gradient=False, mode=""):
        both = [evaluations(dimensions, components, gradient, mode, on) for on in (0, 1)]
        with self.subTest(dimensions=dimensions, components=components, mode=mode):
            self.assertEqual(both[0] == both[1], always, both)

    def test_always(self):
        self.check(True, (12, 12, 12), mode="GREEDY_ANGLE")

    def test_only_when_asked_for(self):
        for dimensions in ((12, 12, 12), (4, 12, 12), (3, 12, 12), (12, 12, 2)):
            for mode in ("", "IsoSurface", "MaximumIntensity", "Slice"):
                self.check(False, dimensions, mode=mode)
            self.check(False, dimensions, gradient=True)
            self.check(False, dimensions, components=2)


if __name__ == "__main__":
    unittest.main()
