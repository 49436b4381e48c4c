# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A registration of two CT heads by elastix: our picture of the moving volume, bent by what elastix
found, is the picture of the volume that transformix resamples. Skipped where elastix is missing."""

import os
import re
import shutil
import subprocess
import sys
import unittest

import numpy as np
import vtkffd
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkImageReslice
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkMetaImageWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction, vtkRenderer, vtkVolume, vtkVolumeProperty)

FOLDER = os.path.join(os.environ["FFD_TEST_TEMPORARY"], "elastix")
SKIPPED = 77
SPACING = 4.0  # mm, of the volumes that are registered
FINE = 2.0  # mm, of the volume that transformix writes

COMMON = """(FixedInternalImagePixelType "float")
(MovingInternalImagePixelType "float")
(FixedImageDimension 3)
(MovingImageDimension 3)
(UseDirectionCosines "true")
(Registration "MultiResolutionRegistration")
(FixedImagePyramid "FixedSmoothingImagePyramid")
(MovingImagePyramid "MovingSmoothingImagePyramid")
(Interpolator "LinearInterpolator")
(ResampleInterpolator "FinalBSplineInterpolator")
(FinalBSplineInterpolationOrder 1)
(Resampler "DefaultResampler")
(Metric "AdvancedMattesMutualInformation")
(NumberOfHistogramBins 32)
(Optimizer "AdaptiveStochasticGradientDescent")
(HowToCombineTransforms "Compose")
(NumberOfResolutions 2)
(ImageSampler "RandomCoordinate")
(NewSamplesEveryIteration "true")
(NumberOfSpatialSamples 2000)
(MaximumNumberOfIterations 150)
(RequiredRatioOfValidSamples 0.05)
(DefaultPixelValue 0)
(WriteResultImage "false")
(ResultImageFormat "mhd")
(ResultImagePixelType "float")
(RandomSeed 1)
"""
AFFINE = COMMON + '(Transform "AffineTransform")\n(AutomaticScalesEstimation "true")\n'
SPLINE = COMMON + '(Transform "BSplineTransform")\n(FinalGridSpacingInPhysicalUnits 40.0)\n'
# The second head begins at the nose of the first.
START = """(Transform "TranslationTransform")
(NumberOfParameters 3)
(TransformParameters -27 -20 -95)
(InitialTransformParametersFileName "NoInitialTransform")
(HowToCombineTransforms "Compose")
(FixedImageDimension 3)
(MovingImageDimension 3)
"""


def run(*command):
    result = subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise RuntimeError("%s failed:\n%s" % (command[0], result.stdout[-3000:]))


def path(name):
    return os.path.join(FOLDER, name)


def save(name, text):
    with open(path(name), "w", encoding="ascii") as file:
        file.write(text)


def write_volume(source, name):
    """A volume of Testing/Data, coarse and isotropic, for elastix."""
    reader = vtkXMLImageDataReader()
    reader.SetFileName(os.path.join(os.environ["FFD_TEST_DATA"], source))
    reader.Update()
    bounds = reader.GetOutput().GetBounds()
    reslice = vtkImageReslice()
    reslice.SetInputConnection(reader.GetOutputPort())
    reslice.SetInterpolationModeToLinear()
    reslice.SetOutputOrigin(bounds[0], bounds[2], bounds[4])
    reslice.SetOutputSpacing(SPACING, SPACING, SPACING)
    reslice.SetOutputExtent(*[n for a in range(3) for n in (
        0, int((bounds[2 * a + 1] - bounds[2 * a]) / SPACING))])
    writer = vtkMetaImageWriter()
    writer.SetInputConnection(reslice.GetOutputPort())
    writer.SetCompression(False)
    writer.SetFileName(path(name))
    writer.Write()


def read_volume(name):
    reader = vtkMetaImageReader()
    reader.SetFileName(path(name))
    reader.Update()
    return reader.GetOutput()


def picture(image, deformation, bounds):
    mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
    mapper.SetInputData(image)
    if deformation is not None:
        mapper.SetDeformation(deformation)
        mapper.SetInverseModeToPullBack()
    mapper.SetSampleDistance(1.0)
    opacity = vtkPiecewiseFunction()
    for scalar, alpha in ((600, 0.0), (1000, 0.05), (1400, 0.1), (2000, 0.3), (4000, 0.5)):
        opacity.AddPoint(scalar, alpha)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(600, 0.8, 0.5, 0.4)
    color.AddRGBPoint(2000, 1.0, 1.0, 0.9)
    prop = vtkVolumeProperty()
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(4.0)
    prop.SetColor(color)
    prop.SetInterpolationTypeToLinear()
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    renderer = vtkRenderer()
    camera = renderer.GetActiveCamera()
    camera.SetPosition(-0.6, -1.0, -0.15)
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetViewUp(0.0, 0.0, -1.0)
    renderer.ResetCamera(bounds)
    colors = vtkImageData()
    if mapper.RenderToImage(renderer, volume, 300, 300, colors, None) != 1:
        raise RuntimeError("nothing was rendered")
    rgba = vtk_to_numpy(colors.GetPointData().GetScalars()).reshape(300, 300, 4).astype(float)
    # On black, as shown.
    return rgba[..., :3] * rgba[..., 3:] / 255.0


def write_png(rgb, name):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkIOImage import vtkPNGWriter
    image = vtkImageData()
    image.SetDimensions(rgb.shape[1], rgb.shape[0], 1)
    image.GetPointData().SetScalars(
        numpy_to_vtk(rgb.astype(np.uint8).reshape(-1, 3).copy(), deep=True))
    writer = vtkPNGWriter()
    writer.SetInputData(image)
    writer.SetFileName(path(name))
    writer.Write()


def psnr(a, b):
    return 10.0 * np.log10(255.0 ** 2 / np.mean((a - b) ** 2))


class TestElastix(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(FOLDER, ignore_errors=True)
        os.makedirs(path("out"))
        write_volume("cthead.vti", "fixed.mhd")
        write_volume("headsq.vti", "moving.mhd")
        save("affine.txt", AFFINE)
        save("spline.txt", SPLINE)
        grid = "(Size 64 64 57)\n(Index 0 0 0)\n(Spacing 4 4 4)\n(Origin 0 0 0)\n"
        save("start.txt", START + grid)
        run("elastix", "-f", "fixed.mhd", "-m", "moving.mhd", "-t0", path("start.txt"), "-p", "affine.txt",
            "-p", "spline.txt", "-out", "out", "-threads", "2")
        cls.reader = vtkffd.vtkFFDTransformReader()
        cls.reader.SetFileName(path("out/TransformParameters.1.txt"))
        cls.moving = read_volume("moving.mhd")

    def test_points_are_those_of_transformix(self):
        points = np.random.default_rng(1).uniform(20.0, 220.0, (50, 3))
        save("points.txt", "point\n50\n" + "\n".join(" ".join(map(repr, map(float, p)))
                                                     for p in points) + "\n")
        run("transformix", "-def", "points.txt", "-tp", "out/TransformParameters.1.txt", "-out",
            "out")
        with open(path("out/outputpoints.txt"), encoding="ascii") as file:
            expected = [[float(x) for x in line.split("OutputPoint = [")[1].split("]")[0].split()]
                        for line in file]
        transform = self.reader.GetTransform()
        ours = [transform.TransformPoint(p) for p in points]
        np.testing.assert_allclose(ours, expected, atol=1e-5)

    def test_picture_is_that_of_the_resampled_volume(self):
        with open(path("out/TransformParameters.1.txt"), encoding="ascii") as file:
            text = file.read()
        # On a finer grid than that of the registration: what is compared is the map.
        size = " ".join(str(int(n * SPACING / FINE)) for n in (64, 64, 57))
        text = re.sub(r"\(Size .*\)", "(Size %s)" % size, text)
        text = re.sub(r"\(Spacing .*\)", "(Spacing %g %g %g)" % (FINE, FINE, FINE), text)
        save("fine.txt", text)
        run("transformix", "-in", "moving.mhd", "-tp", "fine.txt", "-out", "out", "-threads", "2")
        resampled = read_volume("out/result.mhd")
        transform = self.reader.GetTransform()
        bounds = resampled.GetBounds()
        ours = picture(self.moving, transform, bounds)
        theirs = picture(resampled, None, bounds)
        undeformed = picture(self.moving, None, bounds)
        write_png(np.hstack([ours, theirs]), "pictures.png")
        value = psnr(ours, theirs)
        print("PSNR to the resampled volume: deformed %.1f dB, undeformed %.1f dB"
              % (value, psnr(undeformed, theirs)))
        self.assertGreater(theirs.max(), 100.0)
        self.assertGreater(value, 30.0)
        self.assertLess(psnr(undeformed, theirs), 25.0)

    def test_transformix_takes_what_we_write(self):
        lattice = self.reader.GetLattice()
        writer = vtkffd.vtkFFDTransformWriter()
        writer.SetTransform(lattice)
        fixed = read_volume("fixed.mhd")
        writer.SetReferenceImage(fixed)
        writer.SetFileName(path("TransformParameters.ours.txt"))
        self.assertEqual(writer.Write(), 1)
        os.makedirs(path("ours"), exist_ok=True)
        run("transformix", "-in", "moving.mhd", "-tp", "TransformParameters.ours.txt", "-out",
            "ours", "-threads", "2")
        resampled = read_volume("ours/result.mhd")
        reslice = vtkImageReslice()
        reslice.SetInputData(self.moving)
        reslice.SetInformationInput(fixed)
        reslice.SetResliceTransform(lattice)
        reslice.SetInterpolationModeToLinear()
        reslice.SetOutputScalarType(10)
        reslice.Update()
        difference = np.abs(
            vtk_to_numpy(reslice.GetOutput().GetPointData().GetScalars())
            - vtk_to_numpy(resampled.GetPointData().GetScalars()))
        # Outside of the moving volume the two differ in how they end; the rest is rounding.
        self.assertLess(np.percentile(difference, 98.0), 1.0)


if __name__ == "__main__":
    if not (shutil.which("elastix") and shutil.which("transformix")):
        print("elastix is not installed (Debian package: elastix); this test is left out")
        sys.exit(SKIPPED)
    unittest.main()
