# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the mapper keeps between frames: every setter of what a picture is made from is called
between two frames. The second one is that of a new scene with the same settings, and nothing is
made anew that does not depend on the setting. Setters are found by introspection and classified in
CLASSES: one that is not fails the test.

    python3 TestFrameCache.py --survey [mapper ...]      print CLASSES
"""

import collections
import re
import sys
import textwrap
import unittest

import numpy as np
import vtkffd
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (the window's implementation)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from ffdsetters import (OBJECTS, argument_lists, call, make_mask, make_plane, setters)
from TestHostileValues import make_image, make_lattice, make_property
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import (vtkDoubleArray, vtkFloatArray, vtkUnsignedCharArray,
                                      vtkVersion)
from vtkmodules.vtkCommonDataModel import (vtkImageData, vtkPiecewiseFunction, vtkRectilinearGrid)
from vtkmodules.vtkCommonMath import vtkMatrix3x3
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty)

SIDE = 24
#: vtkFFDInverseRayVolumeMapper::CachedParts, a letter each: limits of the blocks, field and bounds
#: of the deformation, transfer functions, distances.
PARTS = "LFBTD"


def make_color():
    color = vtkColorTransferFunction()
    color.AddRGBPoint(0, 1.0, 0.0, 0.0)
    color.AddRGBPoint(100, 0.0, 1.0, 0.3)
    return color


def without_zero(color):
    """A function that begins above 0, so that it has a logarithmic scale."""
    color.RemoveAllPoints()
    color.AddRGBPoint(1e-3, 0.8, 0.1, 0.0)
    color.AddRGBPoint(1024.0, 0.2, 1.0, 1.0)
    return color


def make_function(high=0.3):
    function = vtkPiecewiseFunction()
    function.AddPoint(0, 0.0)
    function.AddPoint(100, high)
    return function


def make_gradient(high=1.0):
    function = vtkPiecewiseFunction()
    function.AddPoint(0, 0.4)
    function.AddPoint(20, high)
    return function


def make_function_2d():
    image = vtkImageData()
    image.SetDimensions(16, 16, 1)
    image.AllocateScalars(10, 4)  # VTK_FLOAT
    vtk_to_numpy(image.GetPointData().GetScalars())[:] = np.linspace(0, 0.8, 16 * 16)[:, None]
    return image


def make_direction():
    matrix = vtkMatrix3x3()
    matrix.SetElement(0, 0, -1.0)
    return matrix


def make_coordinates(power=1.2):
    return numpy_to_vtk(11.0 * (np.arange(12.0) / 11.0) ** power, deep=True)


#: Windows by their size: a scene that is drawn takes the place of the last one.
WINDOWS = {}


def show_in_window(renderer, side):
    window = WINDOWS.get(side)
    if not window:
        window = WINDOWS[side] = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(side, side)
    if not window.HasRenderer(renderer):
        for other in list(window.GetRenderers()):
            window.RemoveRenderer(other)
        window.AddRenderer(renderer)
    return window


class Scene:
    """A deformed volume with a mask, functions of its labels, gradient opacity and a clipping
    plane. `grid`: rectilinear; `vectors`: of two components, without a mask."""

    def __init__(self, grid=False, vectors=False, windows=False):
        self.windows = windows
        scalars = make_image().GetPointData().GetScalars()
        scalars.SetName("scalars")
        if vectors:
            values = vtk_to_numpy(scalars)
            scalars = numpy_to_vtk(np.stack([values, values[::-1]], axis=1), deep=True)
            scalars.SetName("scalars")
        self.scalars = scalars
        self.image = vtkRectilinearGrid() if grid else vtkImageData()
        self.image.SetDimensions(12, 12, 12)
        if grid:
            self.image.SetXCoordinates(make_coordinates())
            self.image.SetYCoordinates(make_coordinates(1.0))
            self.image.SetZCoordinates(make_coordinates(0.9))
        self.image.GetPointData().SetScalars(scalars)
        second = vtkFloatArray()
        second.DeepCopy(numpy_to_vtk(np.arange(12.0 ** 3)))
        second.SetName("second")
        self.second = second
        self.image.GetPointData().AddArray(second)
        self.lattice = make_lattice()
        self.lattice.SetDisplacement(2, 2, 2, 3.0, 1.0, 0.0)
        self.property = make_property()
        self.property.SetGradientOpacity(make_gradient())
        self.property.SetTransferFunction2D(make_function_2d())
        self.property.SetTransferFunctionMode(0)
        self.property.SetLabelColor(1, make_color())
        self.property.SetLabelScalarOpacity(1, make_function())
        self.property.SetLabelGradientOpacity(1, make_gradient(0.9))
        self.mask = make_mask()
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.SetDeformation(self.lattice)
        self.mapper.SetAutoAdjustSampleDistances(0)
        self.mapper.SetClipBox(-5.0, 10.0, -5.0, 20.0, -5.0, 20.0)
        self.plane = make_plane()
        self.mapper.AddClippingPlane(self.plane)
        if vectors:
            self.mapper.SetVectorModeToMagnitude()
        else:
            self.mapper.SetMaskInput(self.mask)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        self.renderer.SetBackground(0.1, 0.2, 0.3)
        self.renderer.GetActiveCamera().SetPosition(1.0, 2.0, 5.0)
        self.renderer.GetActiveCamera().SetFocalPoint(0.0, 0.0, 0.0)
        self.renderer.ResetCamera((0, 11, 0, 11, 0, 11))
        self.renderer.GetActiveCamera().SetClippingRange(5.0, 500.0)
        self.mapper.AddObserver("ErrorEvent", lambda *_: None)

    def image_of(self):
        image = vtkImageData()
        if not self.mapper.RenderToImage(self.renderer, self.volume, SIDE, SIDE, image):
            return np.zeros(0)
        return vtk_to_numpy(image.GetPointData().GetScalars()).ravel().copy()

    def pictures(self):
        image = self.image_of()
        return np.concatenate([image, self.window_of()]) if self.windows else image

    def window_of(self, side=SIDE):
        window = show_in_window(self.renderer, side)
        self.renderer.GetActiveCamera().SetClippingRange(5.0, 500.0)
        window.Render()
        pixels = vtkUnsignedCharArray()
        window.GetPixelData(0, 0, side - 1, side - 1, 0, pixels, 0)
        return vtk_to_numpy(pixels).ravel().copy()

    def count_builds(self):
        return [self.mapper.GetNumberOfBuilds(part) for part in range(len(PARTS))]


def parts_made(before, after):
    return "".join(letter for letter, a, b in zip(PARTS, before, after) if b != a)


class Subject:
    """An object of the scene whose setters are called."""

    def __init__(self, find, cls, scene, extra=(), objects=None, arguments=None, only=""):
        self.find = find
        self.only = only
        self.cls = cls
        self.scene = scene
        self.extra = extra
        self.objects = {**OBJECTS, **(objects or {})}
        self.arguments = arguments or {}

    def make(self):
        scene = self.scene()
        return scene, self.find(scene)

    def calls(self):
        _scene, item = self.make()
        for name, types in setters(self.cls, self.extra):
            if name in NOT_CALLED or not re.search(self.only, name):
                continue
            if name in self.arguments:
                for arguments in self.arguments[name]:
                    yield name, arguments
                continue
            for arguments in argument_lists(item, name, types, self.objects):
                yield name, arguments


#: Setters by what they do in the scenes below: whether a picture is another one, and which PARTS
#: are made anew.
CLASSES = {
    "mapper": {
        "": """
            AddClippingPlane AddInputConnection AddInputDataObject AutoAdjustSampleDistancesOff
            AutoAdjustSampleDistancesOn ClampDepthToBackfaceOff ClampDepthToBackfaceOn
            CollectStatisticsOff CollectStatisticsOn ComputeNormalFromOpacityOff CroppingOff
            FrameCoherenceOff FrameCoherenceOn InteractiveAdjustSampleDistancesOff
            InteractiveAdjustSampleDistancesOn IntermixIntersectingGeometryOff
            IntermixIntersectingGeometryOn LockSampleDistanceToInputSpacingOff
            LockSampleDistanceToInputSpacingOn PremultipliedAlphaOff ReferenceKernelsOff
            ReleaseDataFlagOff ReleaseDataFlagOn RemoveClippingPlane RenderToImageOff
            SelectScalarArray SetAngleThreshold SetArrayAccessMode SetAutoAdjustSampleDistances
            SetAverageIPScalarRange SetBlendModeToComposite SetClampDepthToBackface
            SetClassification SetClassificationToAuto SetClassificationToPostInterpolated
            SetClassificationToPreIntegrated
            SetCollectStatistics SetCroppingRegionFlags SetCroppingRegionFlagsToCross
            SetCroppingRegionFlagsToFence SetCroppingRegionFlagsToInvertedCross
            SetCroppingRegionFlagsToInvertedFence SetCroppingRegionFlagsToSubVolume
            SetCroppingRegionPlanes SetCroppingSpace SetCroppingSpaceToDeformed
            SetCroppingSpaceToRest SetDepthImageScalarType SetDepthImageScalarTypeToFloat
            SetDepthImageScalarTypeToUnsignedChar SetDepthImageScalarTypeToUnsignedShort
            SetFrameCoherence SetFrameCoherenceTolerance SetGlobalIlluminationReach
            SetInputArrayToProcess
            SetInteractiveAdjustSampleDistances SetInteractiveSampleDistance
            SetInteractiveUpdateRate SetIntermixIntersectingGeometry SetInterpolationMode
            SetInterpolationModeToCubic SetInterpolationModeToLinear
            SetInterpolationModeToNearestNeighbor SetInverseModeToExact
            SetLockSampleDistanceToInputSpacing SetLowResMode SetMaskTypeToLabelMap
            SetMaxMemoryFraction SetMaxMemoryInBytes SetMaximumImageSampleDistance SetMinimumImageSampleDistance
            SetMinimumSegmentLength SetNumberOfThreads SetOpacityLengthToWorld SetPartitions
            SetProgress SetProgressObserver SetProgressShiftScale SetProgressText
            SetReleaseDataFlag SetReportProgress SetRequestedRenderMode
            SetRequestedRenderModeToAnari
            SetRequestedRenderModeToDefault SetRequestedRenderModeToGPU
            SetRequestedRenderModeToOSPRay SetRequestedRenderModeToRayCast
            SetScalarModeToDefault SetScalarModeToUsePointData SetSegmentationToErrorBound
            SetStillFrameCoherence StillFrameCoherenceOff StillFrameCoherenceOn
            SetSharedDepthTexture SetSpaceLeaping SetSpaceLeapingToLipschitz
            SetSpaceLeapingToOff SetSpaceLeapingToSegment SetTransfer2DYAxisArray SetUseDepthPass
            SetVectorComponent
            SetVectorModeToMagnitude SetVolumetricScatteringBlending UseDepthPassOff
            UseDepthPassOn UseJitteringOff""",
        "B": """
            SetInverseTolerance""",
        "TD": """
            SetColorRangeType SetGradientOpacityRangeType SetScalarOpacityRangeType
            SetWholeScalarRange""",
        "picture": """
            ComputeNormalFromOpacityOn PremultipliedAlphaOn ReferenceKernelsOn
            RemoveAllClippingPlanes RemoveAllInputConnections RemoveAllInputs RemoveClipBox
            RemoveInputConnection RenderToImageOn SetBlendModeToSlice SetClipBox
            SetClippingPlanes SetComputeNormalFromOpacity
            SetEarlyRayTerminationThreshold SetFinalColorLevel SetFinalColorWindow
            SetImageSampleDistance SetInputConnection SetMaskBlendFactor SetMaximumSegmentLength
            SetOpacityLength SetOpacityLengthToMaterial SetPositionTolerance
            SetPremultipliedAlpha SetReferenceKernels SetRenderToImage SetSampleDistance
            SetScalarMode SetScalarModeToUseCellData SetScalarModeToUseCellFieldData
            SetScalarModeToUsePointFieldData SetSegmentation SetSegmentationToGreedyAngle
            SetUseJittering UseJitteringOn""",
        "picture B": """
            SetInverseMode SetInverseModeToFirstOrder SetInverseModeToPullBack SetWholeBounds""",
        "picture D": """
            CroppingOn SetCropping
            SetBlendMode SetBlendModeToAdditive SetBlendModeToAverageIntensity
            SetBlendModeToIsoSurface SetBlendModeToMaximumIntensity
            SetBlendModeToMinimumIntensity""",
        "picture FB": """
            SetDeformation""",
        "picture LBTD": """
            SetInputData SetInputDataObject""",
        "picture LTD": """
            SetVectorMode SetVectorModeToComponent SetVectorModeToDisabled""",
        "picture TD": """
            SetMaskInput SetMaskType SetMaskTypeToBinary""",
    },
    "property": {
        "": """
            DisableGradientOpacityOff IndependentComponentsOn SetInterpolationTypeToLinear
            UseClippedVoxelIntensityOff""",
        "TD": """
            IndependentComponentsOff SetClippedVoxelIntensity SetComponentWeight
            SetIndependentComponents SetLabelColor SetLabelScalarOpacity SetSliceFunction
            ShadeOn""",
        "picture TD": """
            DisableGradientOpacityOn SetAmbient SetColor SetDiffuse SetDisableGradientOpacity
            SetGradientOpacity SetInterpolationType SetInterpolationTypeToNearest
            SetLabelGradientOpacity SetScalarOpacity SetScalarOpacityUnitDistance SetShade
            SetSpecular SetSpecularPower SetTransferFunction2D SetTransferFunctionMode
            SetUseClippedVoxelIntensity ShadeOff UseClippedVoxelIntensityOn""",
    },
    "image": {
        "": """
            GlobalReleaseDataFlagOff GlobalReleaseDataFlagOn SetAxisUpdateExtent
            SetScalarComponentFromDouble SetScalarComponentFromFloat""",
        "LTD": """
            SetFieldData""",
        "picture LBTD": """
            SetDimensions SetDirectionMatrix SetExtent SetOrigin SetSpacing""",
    },
    "grid": {
        "": """
            GlobalReleaseDataFlagOff GlobalReleaseDataFlagOn""",
        "LTD": """
            SetFieldData""",
        "picture LBTD": """
            SetDimensions SetExtent""",
        "picture LTD": """
            SetXCoordinates SetYCoordinates SetZCoordinates""",
    },
    "lattice": {
        "": """
            SetBorderModeToEdge SetCoefficientConnection SetCoefficientData SetInverseIterations
            SetInverseTolerance""",
        "FB": """
            Refine SetBorderMode SetBorderModeToZero SetBorderModeToZeroAtBorder""",
        "picture FB": """
            FitToBounds Inverse Reset SetControlPoint SetDimensions SetDisplacement
            SetDisplacementScale SetDisplacements SetDomain""",
    },
    "opacity": {
        "": """
            AllowDuplicateScalarsOff ClampingOn GlobalReleaseDataFlagOff GlobalReleaseDataFlagOn
            RemovePoint UseLogScaleOff""",
        "T": """
            AllowDuplicateScalarsOn ClampingOff SetAllowDuplicateScalars SetClamping
            SetFieldData""",
        "picture": """
            RemoveAllPoints""",
        "picture T": """
            AddPoint AddSegment SetNodeValue""",
        "picture TD": """
            RemovePointByIndex SetUseLogScale UseLogScaleOn""",
    },
    "color": {
        "": """
            AllowDuplicateScalarsOff ClampingOn HSVWrapOn IndexedLookupOff RemovePoint SetAlpha
            SetColorSpaceToRGB SetRange SetScaleToLinear SetVectorModeToComponent
            UseAboveRangeColorOff UseBelowRangeColorOff""",
        "T": """
            AllowDuplicateScalarsOn ClampingOff HSVWrapOff IndexedLookupOn RemoveAnnotation
            SetAboveRangeColor SetAllowDuplicateScalars SetAnnotation SetAnnotations
            SetBelowRangeColor SetClamping SetHSVWrap SetIndexedLookup SetNanColor
            SetNanColorRGBA SetNanOpacity SetUseAboveRangeColor SetUseBelowRangeColor
            SetVectorComponent SetVectorMode SetVectorModeToMagnitude SetVectorModeToRGBColors
            SetVectorSize UseAboveRangeColorOn UseBelowRangeColorOn""",
        "picture": """
            RemoveAllPoints""",
        "picture T": """
            AddHSVPoint AddHSVSegment AddRGBPoint AddRGBSegment SetColorSpace
            SetColorSpaceToDiverging SetColorSpaceToHSV SetColorSpaceToLab
            SetColorSpaceToLabCIEDE2000 SetColorSpaceToStep SetNodeValue""",
        "picture TD": """
            SetScale SetScaleToLog10""",
    },
    "representation": {
        "": """
            AddConsumer AddEstimatedRenderTime CullHiddenOn DragableOff DragableOn
            InteriorVisibilityOn LabelVisibilityOff LabelVisibilityOn LineVisibilityOn
            LockBoundaryOff NeedToRenderOff NeedToRenderOn OutlineVisibilityOn PickableOff
            PickableOn PickingManagedOff PickingManagedOn PointVisibilityOn
            ProportionalEditingOff ProportionalEditingOn RemoveConsumer SelectPlanes
            SelectRegion SelectRows SetAllocatedRenderTime SetConstraint SetDragable
            SetEstimatedRenderTime SetFalloff SetFoldGuard SetHandleMode SetHiddenOpacity
            SetLabelVisibility SetLockedLayers SetManipulationMode SetMinimumDeterminant
            SetNeedToRender SetNudgeStep SetPickTolerance SetPickable SetPickingManaged
            SetPlaceFactor SetPropertyKeys SetProportionalEditing SetProportionalRadius
            SetRenderTimeMultiplier SetSelectedPoints SetShaderProperty SetSurfacePicker
            SetSurfacePoint SetSymmetry SetTransformHandleSize SetUndoMemoryLimit SetUseBounds
            UseBoundsOff UseBoundsOn VisibilityOn""",
        "picture": """
            AddPin AddPinAtWorld CullHiddenOff InteriorVisibilityOff LineVisibilityOff
            LockBoundaryOn OutlineVisibilityOff PointVisibilityOff SelectAll SelectPoint
            SetControlPoint SetCullHidden SetHandleSize SetInteriorVisibility SetLattice
            SetLineMode SetLineVisibility SetLockBoundary SetOutlineBounds SetOutlineVisibility
            SetPointVisibility SetProp SetVisibility VisibilityOff""",
    },
}

#: Setters that are not called, with the reason.
NOT_CALLED = {
    "SetExecutive": "replaces the pipeline",
    "SetDefaultExecutivePrototype": "is static: all algorithms would change",
    "SetInformation": "replaces the keys of the pipeline",
    "SetCellOrderAndRationalWeights": "reads through None (VTK 9.1)",
    "SetInverse": "changes its argument",
    "SetRenderer": "is where the representation is drawn",
    "SetAbortExecute": "is of one frame",
    "AbortExecuteOn": "is of one frame",
    "AbortExecuteOff": "is of one frame",
}
FUNCTIONS = {"vtkColorTransferFunction": make_color, "vtkPiecewiseFunction": make_function,
             "vtkImplicitFunction": make_plane, "vtkImageData": make_function_2d}
#: VTK reads through None, or makes a default when it is asked for, which the next frame sees.
OF_PROPERTY = {"SetTransferFunction2D": [[make_function_2d()]],
               "SetScalarOpacity": [[make_function()]],
               "SetColor": [[make_color()], [make_function()]]}


class LatticeScene(Scene):
    """With the representation of the lattice, which the mapper's volume is not shown with."""

    def __init__(self):
        super().__init__()
        self.renderer.RemoveVolume(self.volume)
        self.representation = vtkffd.vtkFFDLatticeRepresentation()
        self.representation.SetLattice(self.lattice)
        self.representation.SetRenderer(self.renderer)
        self.renderer.AddViewProp(self.representation)

    def pictures(self):
        self.representation.BuildRepresentation()
        return np.concatenate([self.window_of(100), self.representation.GetBounds() or ()])


def move_lattice():
    lattice = make_lattice()
    lattice.FitToBounds((0, 22, 0, 11, 0, 11))
    return lattice


def make_displacements():
    array = vtkDoubleArray()
    array.SetNumberOfComponents(3)
    array.SetNumberOfTuples(125)
    array.Fill(0.7)
    return array


def make_prop():
    prop = vtkVolume()
    prop.SetPosition(1.0, 2.0, 0.0)
    return prop


SUBJECTS = {
    # Segments of the length of the volume, and shorter ones.
    "mapper": [Subject(lambda s: s.mapper, vtkffd.vtkFFDInverseRayVolumeMapper,
                       lambda: Scene(windows=True),
                       arguments={"SetMaximumSegmentLength": [[4.0], [2.0]]}),
               Subject(lambda s: s.mapper, vtkffd.vtkFFDInverseRayVolumeMapper,
                       lambda: Scene(vectors=True),
                       only="Vector|NormalFrom|RangeType|Termination|2D")],
    "property": [Subject(lambda s: s.property, vtkVolumeProperty, Scene, objects=FUNCTIONS,
                         arguments=OF_PROPERTY),
                 Subject(lambda s: s.property, vtkVolumeProperty, lambda: Scene(vectors=True),
                         objects=FUNCTIONS, arguments=OF_PROPERTY)],
    "image": [Subject(lambda s: s.image, vtkImageData, Scene,
                      arguments={"SetDirectionMatrix": [[make_direction()]]})],
    "grid": [Subject(lambda s: s.image, vtkRectilinearGrid, lambda: Scene(grid=True),
                     objects={"vtkDataArray": make_coordinates})],
    "lattice": [Subject(lambda s: s.lattice, vtkffd.vtkFFDLattice, Scene,
                        extra=("Reset", "Refine", "FitToBounds", "Inverse", "Identity"),
                        objects={"vtkDoubleArray": make_displacements,
                                 "vtkDataArray": make_displacements},
                        arguments={"SetDimensions": [[6, 6, 6]]})],
    "opacity": [Subject(lambda s: s.property.GetScalarOpacity(), vtkPiecewiseFunction,
                        lambda: Scene(vectors=True),
                        arguments={"AddPoint": [[60.0, 0.9]],
                                   "AddSegment": [[20.0, 0.9, 80.0, 0.1]],
                                   "SetNodeValue": [[1, [100.0, 0.9, 0.5, 0.0]]]})],
    "color": [Subject(lambda s: without_zero(s.property.GetRGBTransferFunction()),
                      vtkColorTransferFunction, lambda: Scene(vectors=True),
                      arguments={"AddRGBPoint": [[60.0, 1.0, 1.0, 1.0]],
                                 "AddHSVPoint": [[60.0, 0.1, 1.0, 1.0]],
                                 "AddRGBSegment": [[20.0, 1.0, 1.0, 1.0, 80.0, 0.0, 0.0, 1.0]],
                                 "AddHSVSegment": [[20.0, 0.9, 1.0, 1.0, 80.0, 0.0, 0.0, 1.0]],
                                 "SetNodeValue": [[1, [100.0, 0.9, 0.5, 0.0, 0.5, 0.0]]]})],
    "representation": [Subject(lambda s: s.representation, vtkffd.vtkFFDLatticeRepresentation,
                               LatticeScene,
                               objects={"vtkFFDLattice": move_lattice, "vtkProp3D": make_prop})],
}


def look(subject, name, arguments):
    """The pictures after a setter and those of a fresh scene, whether it has altered them, what it
    has made anew, and what a frame without any change made; None if it cannot be called."""
    kept, item = subject.make()
    before = kept.pictures()
    counts = kept.count_builds()
    if not call(item, name, arguments):
        return None
    after = kept.pictures()
    changed = kept.count_builds()
    kept.pictures()
    fresh, item = subject.make()
    call(item, name, arguments)
    return (after, fresh.pictures(), not np.array_equal(after, before), parts_made(counts, changed),
            parts_made(changed, kept.count_builds()))


def class_of(shown, made):
    return " ".join((["picture"] if shown else []) + (["".join(p for p in PARTS if p in made)]
                                                      if made else []))


def survey():
    for key, subjects in SUBJECTS.items():
        if len(sys.argv) > 2 and key not in sys.argv[2:]:
            continue
        found = collections.defaultdict(lambda: [False, set()])
        for subject in subjects:
            for name, arguments in subject.calls():
                print("...", key, name, arguments, file=sys.stderr, flush=True)
                result = look(subject, name, arguments)
                if result is None:
                    continue
                if not np.array_equal(result[0], result[1]) or result[4]:
                    print("STALE", key, name, arguments, result[4])
                found[name][0] |= result[2]
                found[name][1] |= set(result[3])
        groups = collections.defaultdict(list)
        for name, (shown, made) in found.items():
            groups[class_of(shown, made)].append(name)
        print(f'    "{key}": {{')
        for group, names in sorted(groups.items()):
            text = textwrap.fill(" ".join(names), 96, initial_indent=" " * 12,
                                 subsequent_indent=" " * 12)
            print(f'        "{group}": """\n{text}""",')
        print("    },", flush=True)


def is_classified_here(cls, name):
    """Other versions of VTK have other setters: those of its classes are classified for 9.1."""
    return cls.__module__.startswith("vtkffd") and name in cls.__dict__ or (
        vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) == (9, 1)


class TestFrameCache(unittest.TestCase):
    def check(self, key):
        classes = {name: what for what, names in CLASSES[key].items() for name in names.split()}
        self.assertEqual(len(classes), sum(len(n.split()) for n in CLASSES[key].values()))
        found = collections.defaultdict(lambda: [False, set()])
        for subject in SUBJECTS[key]:
            self.assertGreater(len(np.unique(subject.make()[0].pictures())), 20)
            for name, arguments in subject.calls():
                result = look(subject, name, arguments)
                if result is None:
                    continue
                after, expected, shown, made, again = result
                with self.subTest(setter=name, arguments=arguments):
                    np.testing.assert_array_equal(after, expected, "not that of a new scene")
                    self.assertEqual(again, "", "made anew without a change")
                    if is_classified_here(subject.cls, name):
                        self.assertIn(name, classes, "classify it")
                        shows, _, parts = classes[name].rpartition("picture")
                        self.assertLessEqual(set(made), set(parts.strip()), "need not be made anew")
                        self.assertTrue(shows or "picture" in classes[name] or not shown)
                found[name][0] |= shown
                found[name][1] |= set(made)
        if (vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) == (9, 1):
            self.assertEqual({name: class_of(*what) for name, what in found.items()}, classes)

    def test_setters_of_the_mapper(self):
        self.check("mapper")

    def test_setters_of_the_property(self):
        self.check("property")

    def test_setters_of_transfer_functions(self):
        self.check("opacity")
        self.check("color")

    def test_setters_of_the_input(self):
        self.check("image")
        self.check("grid")

    def test_setters_of_the_lattice(self):
        self.check("lattice")

    def test_setters_of_the_representation(self):
        self.check("representation")

    def test_changes_in_place(self):
        """Of what setters do not reach: contents that are written through a pointer."""
        def write(array, modified):
            values = vtk_to_numpy(array)
            values[:] = np.roll(values, len(values) // 3, axis=0)
            modified.Modified()

        def label(getter, point):
            return lambda s: getattr(s.property, getter)(1).AddPoint(*point)

        def bend(s):
            x = s.image.GetXCoordinates()
            vtk_to_numpy(x)[:] = vtk_to_numpy(make_coordinates(0.7))
            x.Modified()

        for what, options, change in (
                ("scalars", {}, lambda s: write(s.scalars, s.scalars)),
                ("scalars of the image", {}, lambda s: write(s.scalars, s.image)),
                ("vectors", {"vectors": True}, lambda s: write(s.scalars, s.scalars)),
                ("vectors of the image", {"vectors": True}, lambda s: write(s.scalars, s.image)),
                ("coordinates", {"grid": True}, bend),
                ("mask", {}, lambda s: write(s.mask.GetPointData().GetScalars(), s.mask)),
                ("plane", {}, lambda s: s.plane.SetOrigin(3.0, 3.0, 3.0)),
                ("displacements", {}, lambda s: write(s.lattice.GetDisplacements(),
                                                      s.lattice.GetDisplacements())),
                ("color of a label", {}, lambda s: s.property.GetLabelColor(1).AddRGBPoint(
                    50.0, 0.0, 0.0, 1.0)),
                ("opacity of a label", {}, label("GetLabelScalarOpacity", (50.0, 0.9))),
                ("gradient of a label", {}, label("GetLabelGradientOpacity", (5.0, 0.0)))):
            with self.subTest(what):
                kept, fresh = Scene(**options), Scene(**options)
                before = kept.image_of()
                change(kept)
                change(fresh)
                after = kept.image_of()
                self.assertFalse(np.array_equal(after, before))
                np.testing.assert_array_equal(after, fresh.image_of())

    def test_spaces_of_folds(self):
        """Where a large volume that folds may be visible is kept: not beyond what it follows from."""
        side = 177
        values = np.zeros((side, side, side), np.uint8)
        values[20:90, 30:100, 40:120] = 100
        values[120:150, 100:160, 20:60] = 60
        image = vtkImageData()
        image.SetDimensions(side, side, side)
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        lattice = vtkffd.vtkFFDLattice()
        lattice.SetDimensions(6, 6, 6)
        lattice.FitToBounds(image.GetBounds())
        vtkffd.vtkFFDLatticeSource.ApplyShape(lattice, 3, 2.5, 7)
        function = vtkPiecewiseFunction()
        function.AddPoint(40.0, 0.0)
        function.AddPoint(50.0, 0.5)
        prop = vtkVolumeProperty()
        prop.SetScalarOpacity(function)
        prop.SetColor(make_color())
        prop.SetInterpolationTypeToLinear()

        def make_mapper():
            mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
            mapper.SetInputData(image)
            mapper.SetDeformation(lattice)
            mapper.CroppingOff()
            return mapper

        def picture(mapper):
            volume = vtkVolume()
            volume.SetMapper(mapper)
            volume.SetProperty(prop)
            renderer = vtkRenderer()
            renderer.AddVolume(volume)
            renderer.GetActiveCamera().SetPosition(0.4, -1.0, 0.6)
            renderer.ResetCamera()
            colors = vtkImageData()
            self.assertEqual(mapper.RenderToImage(renderer, volume, 64, 64, colors), 1)
            return vtk_to_numpy(colors.GetPointData().GetScalars()).copy()

        def write():
            values[90:110, 30:100, 40:120] = 100
            image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))

        kept = make_mapper()
        for change in (
                lambda: None,
                lambda: lattice.SetDisplacement(2, 2, 2, 60.0, -40.0, 30.0),
                lambda: function.AddPoint(80.0, 0.0),
                lambda: image.SetSpacing(1.0, 1.2, 0.8),
                lambda: image.SetOrigin(-30.0, 20.0, 10.0),
                lambda: lattice.FitToBounds(image.GetBounds()),
                write,
                lambda: lattice.SetDisplacementScale(0.5)):
            change()
            expected = picture(make_mapper())
            for _ in range(2):
                np.testing.assert_array_equal(picture(kept), expected)
            self.assertGreater(expected.max(), 0)

    def test_grids_that_share_their_scalars(self):
        """Filters that hand content times on show the blanked points of their present input."""
        def blanked(plain):
            image = vtkImageData()
            image.ShallowCopy(plain)
            ghosts = np.zeros((12, 12, 12), np.uint8)
            ghosts[:, :, :5] = 2
            array = numpy_to_vtk(ghosts.ravel(), deep=True)
            array.SetName("vtkGhostType")
            image.GetPointData().AddArray(array)
            return image

        lattice = make_lattice()
        lattice.SetDisplacementScale(0.0)
        for make in (vtkffd.vtkFFDEditLattice, vtkffd.vtkFFDDeformVolume):
            scene = Scene()
            grids = [scene.image, blanked(scene.image)]
            scene.scalars.Modified()  # written last: both grids have its time
            scene.mapper.SetDeformation(None)
            pictures = []
            for grid in grids:
                scene.mapper.SetInputData(grid)
                pictures.append(scene.image_of())
            self.assertFalse(np.array_equal(*pictures))
            for order in ((0, 1), (1, 0)):
                with self.subTest(make.__name__, order=order):
                    algorithm = make()
                    if hasattr(algorithm, "SetLattice"):
                        algorithm.SetLattice(lattice)
                    scene.mapper.SetInputConnection(algorithm.GetOutputPort())
                    for i in order:
                        algorithm.SetInputData(grids[i])
                        np.testing.assert_array_equal(scene.image_of(), pictures[i])


if __name__ == "__main__":
    if "--survey" in sys.argv:
        survey()
    else:
        unittest.main()
