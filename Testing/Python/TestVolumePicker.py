#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkFFDVolumePicker from Python: what is under a pixel of the engine, bent."""

import os
import unittest

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow,
                                         vtkVolume, vtkVolumeProperty)

import vtkffd

SIZE = 80


class TestVolumePicker(unittest.TestCase):
    def setUp(self):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(os.path.join(os.environ["FFD_TEST_DATA"], "engine.vti"))
        reader.Update()
        self.image = reader.GetOutput()
        self.lattice = vtkffd.vtkFFDLattice()
        self.lattice.SetDimensions(6, 6, 6)
        self.lattice.FitToBounds(self.image.GetBounds())
        vtkffd.vtkFFDLatticeSource.ApplyShape(
            self.lattice, vtkffd.vtkFFDLatticeSource.TWIST, 0.4)
        self.mapper = vtkffd.vtkFFDInverseRayVolumeMapper()
        self.mapper.SetInputData(self.image)
        self.mapper.SetDeformation(self.lattice)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(90, 0.0)
        opacity.AddPoint(110, 1.0)
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0, 1.0, 1.0, 1.0)
        prop = vtkVolumeProperty()
        prop.SetScalarOpacity(opacity)
        prop.SetColor(color)
        prop.SetInterpolationTypeToLinear()
        self.volume = vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(prop)
        self.volume.SetPosition(10.0, 20.0, 30.0)
        self.renderer = vtkRenderer()
        self.renderer.AddVolume(self.volume)
        # Never opened: only its size is asked for.
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetSize(SIZE, SIZE)
        self.window.AddRenderer(self.renderer)
        self.renderer.GetActiveCamera().SetPosition(1.0, -2.0, 1.5)
        self.renderer.ResetCamera(self.volume.GetBounds())
        self.picker = vtkffd.vtkFFDVolumePicker()
        self.picker.SetVolumeOpacityIsovalue(0.5)

    def test_pick(self):
        hits = 0
        moved = 0
        for x in range(2, SIZE, 4):
            for y in range(2, SIZE, 4):
                if not self.picker.Pick(x, y, 0, self.renderer):
                    self.assertEqual(self.picker.GetPointId(), -1)
                    continue
                hits += 1
                rest = self.picker.GetRestPosition()
                mapped = self.picker.GetMapperPosition()
                back = self.lattice.TransformPoint(rest)
                for a in range(3):
                    self.assertAlmostEqual(back[a], mapped[a], 5)
                    self.assertAlmostEqual(
                        self.picker.GetPickPosition()[a], mapped[a] + (10, 20, 30)[a], 8)
                    self.assertAlmostEqual(
                        self.picker.GetCellIJK()[a] + self.picker.GetPCoords()[a], rest[a], 8)
                out = [0.0, 0.0, 0.0]
                self.assertEqual(self.mapper.GetRestPosition(mapped, out), 1)
                self.assertLess(max(abs(p - q) for p, q in zip(out, rest)), 1e-6)
                if min(self.picker.GetPCoords()) > 1e-6 and max(self.picker.GetPCoords()) < 1 - 1e-6:
                    self.assertAlmostEqual(self.picker.GetScalarValue(), 100.0, 3)
                self.assertIs(self.picker.GetMapper(), self.mapper)
                self.assertEqual(self.picker.GetComponent(), 0)
                self.assertIs(self.picker.GetViewProp(), self.volume)
                self.assertAlmostEqual(sum(n * n for n in self.picker.GetPickNormal()), 1.0, 9)
                moved += max(abs(p - q) for p, q in zip(rest, mapped)) > 5.0
        self.assertGreater(hits, 35)
        self.assertGreater(moved, 5)

    def test_depth(self):
        colors, depths = vtkImageData(), vtkImageData()
        self.assertEqual(self.mapper.RenderToImage(
            self.renderer, self.volume, SIZE, SIZE, colors, depths), 1)
        self.picker.SetVolumeOpacityIsovalue(0.0)
        near = 0
        for x in range(2, SIZE, 4):
            for y in range(2, SIZE, 4):
                depth = depths.GetScalarComponentAsDouble(x, y, 0, 0)
                if depth == 1.0 or not self.picker.Pick(x + 0.5, y + 0.5, 0, self.renderer):
                    continue
                self.renderer.SetDisplayPoint(x + 0.5, y + 0.5, depth)
                self.renderer.DisplayToWorld()
                w = self.renderer.GetWorldPoint()
                apart = sum((w[a] / w[3] - self.picker.GetPickPosition()[a]) ** 2
                            for a in range(3)) ** 0.5
                near += apart < 1.5
        self.assertGreater(near, 15)

    def test_isovalue(self):
        distances = []
        eye = self.renderer.GetActiveCamera().GetPosition()
        for isovalue in (0.0, 0.5, 0.95):
            self.picker.SetVolumeOpacityIsovalue(isovalue)
            self.assertEqual(self.picker.Pick(SIZE / 2, SIZE / 2, 0, self.renderer), 1)
            distances.append(sum((p - e) ** 2 for p, e in zip(
                self.picker.GetPickPosition(), eye)) ** 0.5)
        self.assertLess(distances[0], distances[1])
        self.assertLess(distances[1], distances[2])

    def test_range_types(self):
        # Functions that are 0 beyond their points, unless they are asked for their ranges only.
        self.mapper.SetDeformation(None)
        self.image.GetPointData().GetScalars().Fill(200)
        prop = self.volume.GetProperty()
        at = (SIZE // 2, SIZE // 2, 0, self.renderer)
        prop.GetScalarOpacity().ClampingOff()
        self.assertEqual(self.picker.Pick(*at), 0)
        self.mapper.SetScalarOpacityRangeType(self.mapper.NATIVE)
        self.assertEqual(self.picker.Pick(*at), 1)
        gradient = vtkPiecewiseFunction()
        gradient.AddPoint(10, 1.0)
        gradient.AddPoint(20, 1.0)
        gradient.ClampingOff()
        prop.SetGradientOpacity(gradient)
        self.picker.UseVolumeGradientOpacityOn()
        colors = vtkImageData()
        for type, seen in ((self.mapper.SCALAR, 0), (self.mapper.NATIVE, 1)):
            self.mapper.SetGradientOpacityRangeType(type)
            self.assertEqual(self.picker.Pick(*at), seen)
            self.mapper.RenderToImage(self.renderer, self.volume, SIZE, SIZE, colors)
            self.assertEqual(colors.GetPointData().GetScalars().GetRange(3)[1] > 0, seen)


if __name__ == "__main__":
    unittest.main()
