# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every setter of every class with values that nobody means: NaN, infinities, 0, negative, huge and
tiny numbers, None, empty objects; and every other method with None, short arrays and empty objects.

Another process makes the calls, so that a crash or a hang names the call; the classes after it are left to
a new process. A value is refused with an error, and then the next picture or result is the same as
before, or it is accepted: then what is read back is finite, and the next picture or result is made in
time, of finite numbers.
"""

import itertools
import math
import os
import re
import signal
import subprocess
import sys
import time
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkObject, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkRectilinearGrid
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkVolume, vtkVolumeProperty

#: Seconds for one call with the result after it; sanitizers take longer.
TIME_LIMIT = 200.0 if "libasan" in os.environ.get("LD_PRELOAD", "") else 20.0
NUMBERS = (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e300, -1e300, 1e-300, 1e12, -1e12)
INTEGERS = (0, -1, 2147483647, -2147483648, 1000)
#: Options of the mapper that change how a picture is made, not what it shows.
HOW_NOT_WHAT = {"SetInverseTolerance", "SetPositionTolerance", "SetMinimumSegmentLength",
                "SetMaximumSegmentLength", "SetNumberOfThreads", "SetFrameCoherenceTolerance",
                "SetInteractiveSampleDistance", "SetMinimumImageSampleDistance",
                "SetMaximumImageSampleDistance", "SetSpaceLeaping", "SetSegmentation"}
#: Setters of the pipeline and of names, and those that are asked to do something for ever.
NOT_SWEPT = {"SetFileName", "SetProgressText", "SetArrayName"}
#: Defects of VTK 9.1 in what our classes inherit: these end the process, or never return.
VTK_DEFECTS = {
    "SetInputArrayToProcess": "vtkAlgorithm uses indices, ports and connections unchecked",
    "SetInformation": "vtkAlgorithm reads through None",
    "AddClippingPlane": "vtkCollection::AddItem reads through None",
    "AddLocator": "vtkCollection::AddItem reads through None",
    "AddPickList": "vtkCollection::AddItem reads through None",
}


# -------------------------------------------------------------------------------------------------
# One instance of each class in a working scene, and what it gives.

def make_image(n=12, seed=0):
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    x = np.linspace(-1, 1, n)
    z, y, x = np.meshgrid(x, x, x, indexing="ij")
    values = 100.0 * np.exp(-2.0 * (x * x + y * y + z * z)) + seed
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel().astype(np.float32), deep=True))
    return image


def make_lattice():
    lattice = vtkffd.vtkFFDLattice()
    lattice.SetDimensions(5, 5, 5)
    lattice.FitToBounds((0, 11, 0, 11, 0, 11))
    lattice.SetDisplacement(2, 2, 2, 1.5, 0.5, 0.0)
    return lattice


def make_property():
    prop = vtkVolumeProperty()
    prop.GetScalarOpacity().AddPoint(0, 0.0)
    prop.GetScalarOpacity().AddPoint(100, 0.4)
    prop.GetRGBTransferFunction().AddRGBPoint(0, 1, 1, 0)
    prop.GetRGBTransferFunction().AddRGBPoint(100, 0, 0.5, 1)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOn()
    return prop


def array_of(data):
    """The scalars of a data object, or the points."""
    if isinstance(data, vtkPolyData):
        return vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.zeros(0)
    scalars = data.GetPointData().GetScalars() if isinstance(data, vtkImageData) else None
    return vtk_to_numpy(scalars) if scalars else np.zeros(0)


def output_of(filter_):
    filter_.Update()
    return array_of(filter_.GetOutput())


def make_scene(mapper):
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(make_property())
    renderer = vtkRenderer()
    renderer.AddVolume(volume)
    renderer.ResetCamera((0, 11, 0, 11, 0, 11))
    renderer.GetActiveCamera().Azimuth(30)
    return renderer, volume


def picture(mapper, scene):
    image = vtkImageData()
    mapper.RenderToImage(scene[0], scene[1], 40, 40, image)
    return array_of(image)


PROBES = np.array([[1.0, 2.0, 3.0], [5.0, 5.0, 5.0], [6.0, 4.0, 9.0], [20.0, 0.0, -3.0]])


def moved_points(transform):
    transform.Update()
    return np.array([transform.TransformPoint(p) for p in PROBES])


def make(name):
    """An instance of a class, and a function that gives its result as an array."""
    item = getattr(vtkffd, name)()
    image = make_image()
    if name == "vtkFFDInverseRayVolumeMapper":
        item.SetInputData(image)
        item.SetDeformation(make_lattice())
        scene = make_scene(item)
        return item, lambda: picture(item, scene)
    if name == "vtkFFDRayTracer":
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetDeformation(make_lattice())
        scene = make_scene(mapper)
        item.SetVolume(scene[1])
        item.SetRenderer(scene[0])
        item.SetImageSize(40, 40)
        item.AddPixel(20, 20)
        return item, lambda: (scene, output_of(item))[1]
    if name == "vtkFFDVolumePicker":
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetDeformation(make_lattice())
        scene = make_scene(mapper)

        def pick():
            item.Pick3DRay((5.5, 5.5, 40.0), (0.0, 0.0, 0.0, 1.0), scene[0])
            return np.array(item.GetPickPosition())
        return item, pick
    if name == "vtkFFDLattice":
        item.DeepCopy(make_lattice())
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(image)
        mapper.SetDeformation(item)
        scene = make_scene(mapper)
        return item, lambda: np.concatenate([moved_points(item).ravel(),
                                             picture(mapper, scene).ravel()])
    if name in ("vtkFFDBarrTransform", "vtkFFDRayDeflector"):
        return item, lambda: moved_points(item)
    if name == "vtkFFDFitLattice":
        source = vtkPoints()
        target = vtkPoints()
        for p in PROBES:
            source.InsertNextPoint(p)
            target.InsertNextPoint(1.1 * p)
        item.SetSourceLandmarks(source)
        item.SetTargetLandmarks(target)
        return item, lambda: output_of(item)
    if name == "vtkFFDDeformGeometry":
        sphere = vtkSphereSource()
        sphere.SetRadius(4)
        item.SetInputConnection(sphere.GetOutputPort())
        item.SetDeformation(make_lattice())
        return item, lambda: output_of(item)
    if name == "vtkFFDTransformWriter":
        item.SetTransform(make_lattice())
        return item, lambda: np.zeros(0)
    if name == "vtkFFDTransformReader":
        return item, lambda: np.zeros(0)
    if name == "vtkFFDLatticeRepresentation":
        item.SetLattice(make_lattice())

        def shape():
            item.BuildRepresentation()
            return np.array(item.GetBounds() or ())
        return item, shape
    if name == "vtkFFDDistanceMap":
        opacity = make_property().GetScalarOpacity()
        item.SetScalarOpacity(opacity)
    if name == "vtkFFDDeformVolume":
        item.SetLattice(make_lattice())
    if name in ("vtkFFDJacobian", "vtkFFDResampleVolume"):
        item.SetDeformation(make_lattice())
    if isinstance(item, vtkAlgorithm):
        if item.GetNumberOfInputPorts() > 0:
            item.SetInputData(image)
        return item, lambda: output_of(item)
    return item, lambda: np.zeros(0)


# -------------------------------------------------------------------------------------------------
# Signatures, from the docstrings of the wrapping.

def signatures(method):
    """The parameter types of each overload: "float", "int", "(float, float)", a class, ..."""
    text = re.sub(r"\n +", " ", method.__doc__ or "")  # long signatures are wrapped
    return [re.findall(r"\w+:((?:\([^)]*\)|\[[^\]]*\]|[\w.])+)", parameters)
            for parameters in re.findall(r"^\w+\(self(?:, )?(.*?)\)(?: ->.*)?$", text,
                                         re.MULTILINE)]


def is_array(kind):
    return kind.startswith(("(", "["))


def sane(kind, current):
    """A value of a type that means nothing bad."""
    if kind == "float":
        return current if isinstance(current, float) else 1.0
    if kind in ("int", "bool"):
        return current if isinstance(current, int) else 1
    if kind == "str":
        return "text"
    if is_array(kind):
        count = kind.count(",") + 1
        return [1.0 if "float" in kind else 1] * count
    return None


def hostile(kind):
    """What is tried in the place of an argument."""
    if kind == "float":
        return NUMBERS
    if kind == "int":
        return INTEGERS
    if kind == "bool":
        return (True,)
    if kind == "str":
        return (None, "", "x" * 10000, "\u00e4/..")
    if is_array(kind):
        count = kind.count(",") + 1
        values = NUMBERS if "float" in kind else INTEGERS
        return tuple([value] * count for value in values) + (None, [], [1])
    if kind.startswith("vtk") or "." in kind:
        return (None, "empty")
    return (None,)


def empty_object(kind):
    """An instance of a class of VTK or of ours, with nothing in it; None where there is none."""
    name = kind.split(".")[-1]
    if hasattr(vtkffd, name):
        return getattr(vtkffd, name)()
    import vtkmodules.all as vtk  # slow, and few need it
    try:
        made = {"vtkDataArray": vtkDoubleArray,
                "vtkAbstractTransform": vtk.vtkThinPlateSplineTransform,
                "vtkDataObject": vtk.vtkTable, "vtkAbstractMapper": vtk.vtkPolyDataMapper,
                "vtkDataSet": vtk.vtkPolyData, "vtkProp": vtk.vtkActor,
                "vtkProp3D": vtk.vtkActor}.get(name) or getattr(vtk, name)
        return made()
    except (AttributeError, TypeError):
        return None


def argument_lists(types, current):
    """Each argument hostile in turn, and all of them."""
    if not types:
        yield []
        return
    base = [sane(kind, current) for kind in types]
    for position, kind in enumerate(types):
        for value in hostile(kind):
            value = empty_object(kind) if isinstance(value, str) and value == "empty" else value
            yield base[:position] + [value] + base[position + 1:]
    if len(types) > 1 and all(kind in ("float", "int") for kind in types):
        for values in itertools.zip_longest(*(hostile(kind) for kind in types)):
            yield [hostile(kind)[0] if value is None else value
                   for kind, value in zip(types, values)]


def numbers_in(value):
    if isinstance(value, (int, float)):
        return [float(value)]
    if isinstance(value, (tuple, list)):
        return [n for each in value for n in numbers_in(each)]
    return []


# -------------------------------------------------------------------------------------------------
class Errors:
    CallDataType = "string0"

    def __init__(self, item):
        self.count = 0
        self.last = ""
        item.AddObserver("ErrorEvent", self)

    def __call__(self, _caller, _event, message):
        self.count += 1
        self.last = message


def methods_of(cls):
    """The methods of a class beyond those of vtkObject, and whether they are its own. Those that are
    not are VTK's: of these only setters are swept, and of vtkAlgorithm's those that take objects."""
    return [(method, method in cls.__dict__) for method in sorted(set(dir(cls)) - set(dir(vtkObject)))]


def sweep(name):
    """Runs in another process: prints what it does, and what is wrong."""
    print("class", name, flush=True)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    cls = getattr(vtkffd, name)
    expected = make(name)[1]()
    for method, own in methods_of(cls):
        if method in NOT_SWEPT:
            continue
        setter = re.match(r"(Set|\w+On$|\w+Off$|Add|Remove|Use)", method)
        reading = re.match(r"(Get|Is|Has|Find|Print|Compute)", method)
        if not setter and not reading:
            continue
        for types in signatures(getattr(cls, method)):
            numeric = all(re.fullmatch("[(]?(float|int).*", kind) for kind in types)
            if not own and (reading or (numeric and hasattr(vtkAlgorithm, method))):
                continue
            getter = getattr(cls, re.sub("^Set", "Get", method), None)
            for arguments in argument_lists(types, None):
                if not own and method in VTK_DEFECTS and (
                        method.startswith("Set") or arguments == [None]):
                    continue
                signal.setitimer(signal.ITIMER_REAL, TIME_LIMIT)
                print("call", method, arguments, flush=True)
                item, result = make(name)
                errors = Errors(item)
                try:
                    getattr(item, method)(*arguments)
                except (TypeError, ValueError, OverflowError, UnicodeError):
                    continue  # refused by the wrapping
                if own and setter and getter and not any(signatures(getter)):
                    try:
                        back = numbers_in(getter(item))
                    except TypeError:
                        back = []
                    if any(not math.isfinite(n) for n in back):
                        print("wrong", method, arguments, "is read back as", back, flush=True)
                refused = errors.count > 0
                after = result()
                if name == "vtkFFDInverseRayVolumeMapper" and after.shape != expected.shape:
                    # Refused when it is rendered.
                    if method in HOW_NOT_WHAT or refused:
                        print("wrong", method, arguments, "gives no picture", flush=True)
                elif not np.isfinite(after).all():
                    print("wrong", method, arguments, "gives numbers that are not finite",
                          flush=True)
                elif (name == "vtkFFDInverseRayVolumeMapper" and method in HOW_NOT_WHAT and
                      np.abs(after.astype(float) - expected).mean() > 3.0):
                    print("wrong", method, arguments, "gives another picture", flush=True)
                elif (refused or not setter) and not np.array_equal(after, expected):
                    print("wrong", method, arguments, "was refused and changes the result",
                          flush=True)
                signal.setitimer(signal.ITIMER_REAL, 0)
    print("done", flush=True)


class TestHostileValues(unittest.TestCase):
    def test_a_domain_reads_back_finite(self):
        lattice = make_lattice()
        errors = Errors(lattice)
        before = lattice.GetDomain()
        for high in (1e308, 1.7e308):
            lattice.SetDomain(0, high, 0, high, 0, high)
            self.assertEqual(lattice.GetDomain(), before)
        self.assertEqual(errors.count, 2)

    def test_a_rectilinear_grid_with_too_few_coordinates(self):
        grid = vtkRectilinearGrid()
        grid.SetDimensions(12, 12, 12)
        for axis, count in zip("XYZ", (12, 12, 5)):
            getattr(grid, f"Set{axis}Coordinates")(numpy_to_vtk(np.arange(float(count)), deep=True))
        grid.GetPointData().SetScalars(make_image().GetPointData().GetScalars())
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(grid)
        errors = Errors(mapper)
        scene = make_scene(mapper)
        self.assertEqual(mapper.RenderToImage(scene[0], scene[1], 20, 20, vtkImageData()), 0)
        self.assertEqual(errors.count, 1)
        self.assertIn("5 coordinates along axis 2 for its 12 points", errors.last)

    def test_a_small_volume_is_no_singular_one(self):
        mapper = make("vtkFFDInverseRayVolumeMapper")[0]
        renderer, volume = make_scene(mapper)
        large = picture(mapper, (renderer, volume))
        volume.SetScale(1e-5)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(1e-5 * np.array(camera.GetPosition()))
        camera.SetFocalPoint(1e-5 * np.array(camera.GetFocalPoint()))
        camera.SetClippingRange(1e-5 * np.array(camera.GetClippingRange()))
        small = picture(mapper, (renderer, volume))
        self.assertLess(np.abs(small.astype(float) - large).mean(), 1.0)

    def test_an_absurd_deformation_is_refused_at_once(self):
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(make_image())
        lattice = make_lattice()
        mapper.SetDeformation(lattice)
        scene = make_scene(mapper)
        expected = picture(mapper, scene)
        errors = Errors(mapper)
        lattice.SetDisplacementScale(-1e12)
        start = time.process_time()
        self.assertEqual(mapper.RenderToImage(scene[0], scene[1], 40, 40, vtkImageData()), 0)
        self.assertLess(time.process_time() - start, 5.0)
        self.assertIn("times as large", errors.last)
        lattice.SetDisplacementScale(1.0)
        np.testing.assert_array_equal(picture(mapper, scene), expected)

    def test_a_flat_deformation_is_told_once(self):
        """Of control points in one plane there is nothing to see."""
        mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        mapper.SetInputData(make_image())
        lattice = make_lattice()
        mapper.SetDeformation(lattice)
        mapper.SetInverseModeToExact()
        scene = make_scene(mapper)
        told = []

        def hear(_caller, _event, message):
            told.append(message)

        hear.CallDataType = "string0"
        mapper.AddObserver("WarningEvent", hear)
        expected = picture(mapper, scene)
        kept = vtkDoubleArray()
        kept.DeepCopy(lattice.GetDisplacements())
        for height in (0.0, 1e-3):  # flat, and thin
            for i, j, k in itertools.product(*(range(n) for n in lattice.GetDimensions())):
                point = [0.0] * 3
                lattice.GetRestPoint(i, j, k, point)
                lattice.SetControlPoint(i, j, k, point[0], point[1],
                                        0.5 * point[0] + height * point[2])
            for _ in range(2):
                picture(mapper, scene)
            self.assertEqual(len(told), 1)
            self.assertIn("presses the volume flat", told[0])
        lattice.SetDisplacements(kept)
        np.testing.assert_array_equal(picture(mapper, scene), expected)
        self.assertEqual(len(told), 1)

    swept = {}  # by class: the status of the process, and the lines that it printed

    def run_sweep(self, name):
        """One process sweeps this class and those after it, as far as it comes."""
        if name not in self.swept:
            run = subprocess.run(
                [sys.executable, __file__, "--sweep", *NAMES[NAMES.index(name):]], capture_output=True,
                text=True, check=False, errors="replace")
            swept, lines = name, []
            for section in re.split("^class ", run.stdout, flags=re.MULTILINE)[1:]:
                swept, *lines = section.splitlines()
                self.swept[swept] = (0, lines)
            # With the last one the process ended.
            self.swept[swept] = (run.returncode, lines or [run.stderr])
        status, lines = self.swept[name]
        wrong = [line for line in lines if line.startswith("wrong")]
        self.assertEqual(wrong, [])
        self.assertEqual((status, lines[-1:]), (0, ["done"]))


NAMES = sorted(set(vtkffd.__all__) - {"vtkFFDWarpTransform"})  # which is abstract


def add_tests():
    for name in NAMES:
        setattr(TestHostileValues, f"test_{name}",
                lambda self, name=name: self.run_sweep(name))


add_tests()

if __name__ == "__main__":
    if len(sys.argv) > 2 and sys.argv[1] == "--sweep":
        for each in sys.argv[2:]:
            sweep(each)
    else:
        unittest.main()
