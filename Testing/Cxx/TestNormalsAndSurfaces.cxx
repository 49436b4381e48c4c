// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Each part of the surface and of the lights matters and is what VTK's mappers make of it; normals
// of the opacity are those of a volume whose scalars are the opacity.
#include "FFDTestOptics.h"

namespace
{

double Smooth(int, const ffdTest::Vec3& p) { return ffdTest::FourFields(3, p); }

void CheckSurface(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  const auto image = ffdTest::MakeImage(40, VTK_FLOAT, 1, Smooth);
  scene.SetInput(image);
  scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
  scene.SetSampleDistance(0.5);
  ffdTest::SetTransfer(scene.Property,
    { { 40, 0.9, 0.4, 0.2, 0.0 }, { 60, 0.9, 0.6, 0.2, 0.4 }, { 255, 0.3, 0.6, 0.8, 0.6 } }, 1.0);
  scene.SetShadingAsGpuMapper(0.2, 0.5, 0.3, 20.0);
  const ffdTest::Picture before = scene.Render(scene.Ours);
  const auto check = [&](const std::string& name, double least) {
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    scene.Gpu->Modified();
    scene.Property->Modified();
    const ffdTest::Distance gpu = scene.Compare(ours, scene.Render(scene.Gpu));
#ifdef VTK_FFD_GPU_MAPPER_REFLECTS_HIGHLIGHTS
    const bool comparable = name.compare(0, 8, "specular") != 0;
#else
    const bool comparable = true;
#endif
    checks.Expect(gpu.Pixels > 1500 && (gpu.Mean <= 4.0 || !comparable), name,
      ffdTest::ToString(gpu) + " from the GPU mapper (mean at most 4)");
    checks.ExpectAtLeast(name + ", matters", scene.Compare(before, ours).Mean, least);
  };
  scene.SetShadingAsGpuMapper(0.6, 0.5, 0.3, 20.0);
  check("ambient", 10.0);
  scene.SetShadingAsGpuMapper(0.2, 0.9, 0.3, 20.0);
  check("diffuse", 10.0);
  scene.SetShading(0.2, 0.5, 0.9, 20.0);
  check("specular", 2.0);
  scene.SetShading(0.2, 0.5, 0.3, 2.0);
  check("specular power", 4.0);
  scene.SetShadingAsGpuMapper(0.2, 0.5, 0.3, 20.0);
  scene.Headlight->SetDiffuseColor(1.0, 0.2, 0.2);
  check("diffuse color", 4.0);
  scene.Headlight->SetDiffuseColor(1.0, 1.0, 1.0);
  scene.SetShading(0.2, 0.5, 0.3, 20.0);
  scene.Headlight->SetSpecularColor(0.0, 1.0, 0.0);
  check("specular color", 0.5);
  scene.Headlight->SetSpecularColor(1.0, 1.0, 1.0);
  // Only at full intensity does a headlight light the ambient term whatever its color; in the GPU
  // mapper others do so with white.
  scene.SetShadingAsGpuMapper(0.2, 0.5, 0.3, 20.0);
  scene.SetWhiteAmbientLight(false);
  scene.Headlight->SetIntensity(0.5);
  check("intensity", 10.0);
  scene.Headlight->SetIntensity(1.0);

  // The ambient color of lights that are not a single headlight.
  scene.Headlight->SetLightTypeToSceneLight();
  scene.Headlight->SetFocalPoint(0.0, 0.0, 0.0);
  scene.Headlight->SetPosition(0.4, -1.0, 0.5);
  scene.SetShadingAsGpuMapper(0.6, 0.3, 0.0, 20.0);
  scene.Headlight->SetAmbientColor(0.0, 0.0, 0.0);
  const ffdTest::Picture dark = scene.Render(scene.Ours);
  scene.Headlight->SetAmbientColor(0.1, 0.9, 0.3);
  const ffdTest::Picture green = scene.Render(scene.Ours);
  checks.ExpectAtLeast("ambient color, matters", scene.Compare(dark, green).Mean, 10.0);
}

void CheckNormalFromOpacity(ffdTest::Checks& checks)
{
  // The opacity falls where the scalars rise on: a shell, whose inner side is lit otherwise.
  const std::vector<std::array<double, 2>> points = { { 30.0, 0.0 }, { 120.0, 0.3 }, { 200.0, 0.0 },
    { 255.0, 0.0 } };
  vtkNew<vtkPiecewiseFunction> opacity;
  for (const std::array<double, 2>& p : points)
  {
    opacity->AddPoint(p[0], p[1]);
  }
  ffdTest::Scene scene;
  const auto image = ffdTest::MakeImage(60, VTK_FLOAT, 1, Smooth);
  scene.SetInput(image);
  scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
  ffdTest::SetTransfer(scene.Property, { { 0, 1.0, 1.0, 1.0, 0.0 } }, 1.0);
  scene.Property->SetScalarOpacity(opacity);
  scene.SetShadingAsGpuMapper(0.1, 0.8, 0.3, 20.0);
  // Sides matter only if lights are not two-sided.
  scene.Renderer->TwoSidedLightingOff();
  const ffdTest::Picture byScalars = scene.Render(scene.Ours);
  scene.Ours->ComputeNormalFromOpacityOn();
  const ffdTest::Picture byOpacity = scene.Render(scene.Ours);
  checks.ExpectAtLeast(
    "normals of the opacity, matter", scene.Compare(byScalars, byOpacity).Mean, 5.0);
  ffdTest::CheckSamePictures(scene, "normals of the opacity", checks);

  // The oracle: a volume of opacities.
  const auto opacities = ffdTest::MakeImage(60, VTK_FLOAT, 1,
    [&](int c, const ffdTest::Vec3& p) { return opacity->GetValue(Smooth(c, p)); });
  vtkNew<vtkPiecewiseFunction> identity;
  identity->AddPoint(0.0, 0.0);
  identity->AddPoint(1.0, 1.0);
  scene.Ours->ComputeNormalFromOpacityOff();
  scene.Ours->SetInputData(opacities);
  scene.Property->SetScalarOpacity(identity);
  const ffdTest::Distance d = scene.Compare(byOpacity, scene.Render(scene.Ours));
  // Opacities of interpolated scalars are not interpolated opacities at the tip of the ramp.
  checks.Expect(d.Pixels > 1500 && d.Mean <= 4.0, "normals of the opacity",
    ffdTest::ToString(d) + " from a volume of opacities (mean at most 4)");
}

} // namespace

int TestNormalsAndSurfaces(int, char*[])
{
  ffdTest::Checks checks;
  CheckSurface(checks);
  CheckNormalFromOpacity(checks);
  return checks.Result();
}
