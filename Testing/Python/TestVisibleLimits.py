# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Space leaping changes no picture where scalars lie at the limits of what is visible: plateaus at
the first value of a ramp, data far from zero, fill values far from the data."""

import unittest

import numpy
import vtkffd
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkRenderer, vtkVolume

SIZE = 32
PIXELS = 80
POST_INTERPOLATED = vtkffd.vtkFFDInverseRayVolumeMapper.POST_INTERPOLATED
PRE_INTEGRATED = vtkffd.vtkFFDInverseRayVolumeMapper.PRE_INTEGRATED


def plateau(low, height, top, dtype):
    """A plateau with a block of `top` in it, and some slices of `low`."""
    values = numpy.full((SIZE, SIZE, SIZE), height, float)
    values[10:20, 10:20, 10:20] = top
    values[:3] = low
    return values.astype(dtype)


class TestVisibleLimits(unittest.TestCase):
    def make(self, values, opacities):
        image = vtkImageData()
        image.SetDimensions(*reversed(values.shape))
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(image)
        self.mapper.SetAutoAdjustSampleDistances(False)
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        properties = self.volume.GetProperty()
        properties.SetInterpolationTypeToLinear()
        opacity, color = vtkPiecewiseFunction(), vtkColorTransferFunction()
        for value, height in opacities:
            opacity.AddPoint(value, height)
        low, high = opacities[0][0], opacities[-1][0]
        color.AddRGBPoint(low, 1, 1, 1)
        color.AddRGBPoint(high, 1, 0.3, 0)
        properties.SetScalarOpacity(opacity)
        properties.SetColor(color)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        self.renderer.GetActiveCamera().SetPosition(1, 0.4, 0.3)
        self.renderer.ResetCamera()

    def render(self, leaping, reference=False):
        self.mapper.SetSpaceLeaping(leaping)
        self.mapper.SetReferenceKernels(reference)
        image = vtkImageData()
        self.assertEqual(
            self.mapper.RenderToImage(self.renderer, self.volume, PIXELS, PIXELS, image), 1)
        return vtk_to_numpy(image.GetPointData().GetScalars()).astype(int)

    def check(self, name, least, most):
        """Between `least` and `most` of the pixels are visible, in all pictures the same ones."""
        with self.subTest(name):
            mapper = self.mapper
            everything = self.render(mapper.OFF)
            for leaping in (mapper.SEGMENT, mapper.LIPSCHITZ):
                leapt = self.render(leaping)
                self.assertLessEqual(abs(leapt - everything).max(), 1, leaping)
            for leaping in (mapper.OFF, mapper.LIPSCHITZ):
                exact = self.render(leaping, True)
                away = (abs(exact - everything).max(axis=1) > 24).mean()
                self.assertLess(away, 0.01, "reference kernels")
            visible = (everything[:, 3] > 0).mean()
            self.assertGreater(visible, least)
            self.assertLess(visible, most)

    def test_plateaus_at_the_beginning_of_a_step(self):
        for dtype, offset, span in (
                ("u1", 0, 255), ("u2", 0, 60000), ("i4", -70000, 210000), ("f4", 0.0, 0.3),
                ("f4", 1000.1, 0.6), ("f8", 1000.1, 0.6)):
            height = offset + 2 * span // 3 if dtype[0] != "f" else offset + span / 3
            values = plateau(offset, height, offset + span, dtype)
            # As the scalars are rounded.
            height = float(values[5, 5, 5])
            self.make(values, ((offset, 0), (height, 0), (height + 1e-6 * span, 0.9),
                               (offset + span, 0.9)))
            for classification in (POST_INTERPOLATED, PRE_INTEGRATED):
                self.mapper.SetClassification(classification)
                self.check(f"{dtype} from {offset}, {classification}", 0.02, 0.4)

    def test_maxima_end_no_ray_too_early(self):
        values = plateau(1000.0, 1000.2, 1000.33, "f4")
        height = float(values[5, 5, 5])
        self.make(values, ((1000, 0.9), (height, 0.9), (height + 1e-6, 0), (1000.33, 0)))
        self.mapper.SetBlendModeToMaximumIntensity()
        self.check("falls to zero above the plateau", 0.02, 0.9)

    def test_fill_values(self):
        z, y, x = numpy.mgrid[:SIZE, :SIZE, :SIZE] - SIZE / 2
        for dtype in ("f4", "f8"):
            for fill in (-1e6, -1e13, -1e20, -9.99e33, 1e20, 9.99e33):
                values = numpy.exp(-(x * x + y * y + z * z) / 60).astype(dtype)
                values[:2] = fill
                self.make(values, ((0.2, 0), (0.9, 0.8)))
                everything = self.render(self.mapper.OFF)
                for leaping in (self.mapper.SEGMENT, self.mapper.LIPSCHITZ):
                    for reference in (False, True):
                        with self.subTest(dtype=dtype, fill=fill, reference=reference):
                            leapt = self.render(leaping, reference)
                            self.assertLessEqual(abs(leapt - everything).max(), 2)
                self.assertGreater((everything[:, 3] > 0).mean(), 0.04)


if __name__ == "__main__":
    unittest.main()
