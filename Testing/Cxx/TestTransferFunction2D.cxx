// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Two-dimensional transfer functions: over the magnitude of the gradient, or over another array.
// Undeformed against vtkGPUVolumeRayCastMapper, with equal settings; it does not correct their
// opacity for the sample distance, so that is the unit distance. And other properties of transfer
// functions: color spaces, logarithmic scale, colors beyond the range.
#include "FFDTestOptics.h"

namespace
{

double Shells(int, const ffdTest::Vec3& p)
{
  const double r = 0.5 * ffdTest::Ball(p, { 0.5, 0.48, 0.5 }, 0.8) / 255.0;
  return 110.0 / (1.0 + std::exp(-40.0 * (r - 0.25))) +
    120.0 / (1.0 + std::exp(-40.0 * (r - 0.38)));
}

/// Texels by their place, relative to the ranges.
vtkSmartPointer<vtkImageData> MakePlane(
  int width, int height, const std::function<std::array<double, 4>(double, double)>& texel)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_FLOAT, 4);
  for (int j = 0; j < height; ++j)
  {
    for (int i = 0; i < width; ++i)
    {
      const std::array<double, 4> rgba =
        texel(width > 1 ? i / (width - 1.0) : 0.5, height > 1 ? j / (height - 1.0) : 0.5);
      for (int c = 0; c < 4; ++c)
      {
        image->SetScalarComponentFromDouble(i, j, 0, c, rgba[static_cast<std::size_t>(c)]);
      }
    }
  }
  return image;
}

/// Colors by the scalar, opacity where both are large.
std::array<double, 4> Rise(double x, double y)
{
  return { x, 0.3 + 0.5 * y, 1.0 - x, x > 0.15 ? 0.08 * std::min(1.0, 2.0 * y) : 0.0 };
}

void CheckGradient(ffdTest::Checks& checks)
{
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_FLOAT })
  {
    ffdTest::Scene scene;
    const auto image = ffdTest::MakeImage(40, type, 1, Shells);
    scene.SetInput(image);
    scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
    ffdTest::SetTransfer(
      scene.Property, { { 5, 1.0, 1.0, 1.0, 0.0 }, { 230, 1.0, 1.0, 1.0, 0.2 } }, 0.25);
    scene.SetSampleDistance(0.25);
    const ffdTest::Picture oneD = scene.Render(scene.Ours);
    scene.Property->SetTransferFunction2D(MakePlane(64, 32, Rise));
    scene.Property->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
    const std::string name = std::string("over the gradient, ") + vtkImageScalarTypeNameMacro(type);
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Distance d = scene.Compare(ours, scene.Render(scene.Gpu));
    checks.Expect(d.Pixels > 1500 && d.Mean <= 3.0, name,
      ffdTest::ToString(d) + " from the GPU mapper (mean at most 3)");
    checks.ExpectAtLeast(name + ", matters", scene.Compare(ours, oneD).Mean, 20.0);
    ffdTest::CheckSamePictures(scene, name, checks);
    // Opacities are over another length than that of the intervals.
    scene.SetSampleDistance(0.5);
    ffdTest::CheckSamePictures(scene, name + ", longer intervals", checks);
    scene.SetSampleDistance(0.25);
    scene.SetShadingAsGpuMapper(0.2, 0.7, 0.3, 20.0);
    ffdTest::CheckSamePictures(scene, name + ", shaded", checks);
    scene.Property->ShadeOff();
    // The second axis matters: without it another picture.
    scene.Property->SetTransferFunction2D(
      MakePlane(64, 32, [](double x, double) { return Rise(x, 0.5); }));
    checks.ExpectAtLeast(
      name + ", its second axis", scene.Compare(ours, scene.Render(scene.Ours)).Mean, 10.0);
    // Constant over it, it is a one-dimensional function.
    vtkNew<vtkColorTransferFunction> color;
    vtkNew<vtkPiecewiseFunction> opacity;
    const double* range = image->GetScalarRange();
    const double width = range[1] - range[0];
    scene.Property->SetTransferFunction2D(MakePlane(512, 1, [](double x, double) {
      return std::array<double, 4>{ x, 0.5, 1.0 - x, 0.1 * x };
    }));
    const ffdTest::Picture constant = scene.Render(scene.Ours);
    color->AddRGBPoint(range[0], 0.0, 0.5, 1.0);
    color->AddRGBPoint(range[0] + width, 1.0, 0.5, 0.0);
    opacity->AddPoint(range[0], 0.0);
    opacity->AddPoint(range[0] + width, 0.1);
    scene.Property->SetColor(color);
    scene.Property->SetScalarOpacity(opacity);
    scene.Property->SetTransferFunctionMode(vtkVolumeProperty::TF_1D);
    const ffdTest::Distance flat = scene.Compare(constant, scene.Render(scene.Ours));
    checks.Expect(flat.Pixels > 1500 && flat.Mean <= 0.5, name + ", constant over it",
      ffdTest::ToString(flat) + " from a one-dimensional function");
  }
}

void CheckArray(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  const auto image = ffdTest::MakeImage(40, VTK_FLOAT, 1, Shells);
  const auto second = ffdTest::MakeImage(
    40, VTK_SHORT, 1, [](int, const ffdTest::Vec3& p) { return 1000.0 * p[0] - 300.0; });
  second->GetPointData()->GetScalars()->SetName("second");
  image->GetPointData()->AddArray(second->GetPointData()->GetScalars());
  scene.SetInput(image);
  scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
  ffdTest::SetTransfer(
    scene.Property, { { 5, 1.0, 1.0, 1.0, 0.0 }, { 230, 1.0, 1.0, 1.0, 0.2 } }, 0.25);
  scene.SetSampleDistance(0.25);
  const auto plane = MakePlane(32, 16, [](double x, double y) {
    return std::array<double, 4>{ y, 0.5, 1.0 - y, x > 0.2 && y > 0.35 ? 0.07 * x : 0.0 };
  });
  scene.Property->SetTransferFunction2D(plane);
  scene.Property->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
  const ffdTest::Picture byGradient = scene.Render(scene.Ours);
  scene.Ours->SetTransfer2DYAxisArray("second");
  const ffdTest::Picture ours = scene.Render(scene.Ours);
  checks.ExpectAtLeast("over an array, matters", scene.Compare(ours, byGradient).Mean, 20.0);
  ffdTest::CheckSamePictures(scene, "over an array", checks);
  scene.Gpu->SetTransfer2DYAxisArray("second");
  const ffdTest::Distance d = scene.Compare(ours, scene.Render(scene.Gpu));
  checks.Expect(d.Pixels > 1500 && d.Mean <= 3.0, "over an array",
    ffdTest::ToString(d) + " from the GPU mapper (mean at most 3)");
}

/// The colors that the transfer function itself gives for the only scalar, through the middle.
void CheckColors(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  // Almost constant, so that the table covers more than a point.
  const auto image = ffdTest::MakeImage(8, VTK_FLOAT, 1,
    [](int, const ffdTest::Vec3& p) { return p[1] == 0.0 && p[0] == 0.0 ? 0.0 : 100.0; });
  scene.SetInput(image);
  scene.SetCamera({ 0.0, 0.0, 1.0, true, false }, image->GetBounds());
  vtkNew<vtkPiecewiseFunction> opaque;
  opaque->AddPoint(0.0, 1.0);
  scene.Property->SetScalarOpacity(opaque);
  scene.Property->SetInterpolationTypeToLinear();
  const auto check = [&](const std::string& name, vtkColorTransferFunction* color, double scalar) {
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      const double value = image->GetPointData()->GetScalars()->GetComponent(i, 0);
      image->GetPointData()->GetScalars()->SetComponent(i, 0, value == 0.0 ? 0.0 : scalar);
    }
    image->GetPointData()->GetScalars()->Modified();
    image->Modified();
    scene.Property->SetColor(color);
    double expected[3];
    color->GetColor(scalar, expected);
    const std::vector<unsigned char> rgba = ffdTest::RenderRgba(scene);
    const std::size_t at = 4 * (55 * 100 + 55);
    double worst = 0.0;
    std::ostringstream figures;
    for (std::size_t c = 0; c < 3; ++c)
    {
      worst = std::max(worst, std::abs(rgba[at + c] - 255.0 * expected[c]));
      figures << int(rgba[at + c]) << " of " << 255.0 * expected[c] << ", ";
    }
    checks.Expect(worst <= 2.0, name, figures.str() + "(at most 2 apart)");
    return std::array<double, 3>{ expected[0], expected[1], expected[2] };
  };
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(10.0, 0.9, 0.2, 0.1);
  color->AddRGBPoint(1000.0, 0.1, 0.5, 0.95);
  color->SetColorSpaceToRGB();
  const auto rgb = check("RGB", color, 400.0);
  color->SetColorSpaceToHSV();
  checks.Expect(check("HSV", color, 400.0) != rgb, "HSV differs", "");
  color->SetColorSpaceToLab();
  checks.Expect(check("Lab", color, 400.0) != rgb, "Lab differs", "");
  color->SetColorSpaceToLabCIEDE2000();
  checks.Expect(check("CIEDE2000", color, 400.0) != rgb, "CIEDE2000 differs", "");
  color->SetColorSpaceToDiverging();
  checks.Expect(check("diverging", color, 400.0) != rgb, "diverging differs", "");
  color->SetColorSpaceToStep();
  checks.Expect(check("step", color, 400.0) != rgb, "step differs", "");
  color->SetColorSpaceToRGB();
  color->SetScaleToLog10();
  checks.Expect(check("logarithmic", color, 60.0) != rgb, "logarithmic differs", "");
  check("logarithmic", color, 400.0);
  color->SetScaleToLinear();
  color->SetAboveRangeColor(0.0, 1.0, 0.0);
  color->SetBelowRangeColor(1.0, 1.0, 0.0);
  check("above the range, not used", color, 1200.0);
  check("below the range, not used", color, 5.0);
  color->UseAboveRangeColorOn();
  color->UseBelowRangeColorOn();
  check("above the range", color, 1200.0);
  check("far above the range", color, 1e5);
  check("below the range", color, 5.0);
  check("within the range", color, 400.0);
  color->ClampingOff();
  check("not clamped", color, 400.0);
}

} // namespace

int TestTransferFunction2D(int, char*[])
{
  ffdTest::Checks checks;
  CheckGradient(checks);
  CheckArray(checks);
  CheckColors(checks);
  return checks.Result();
}
