// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Opacity by the magnitude of the gradient. Against VTK's mappers, undeformed, with equal settings;
// their magnitudes differ from each other: vtkFixedPointVolumeRayCastMapper interpolates those of
// the voxels, which it keeps in 8 bits, the GPU mapper and ours find them where the sample is.
#include "FFDTestOptics.h"

#include <algorithm>

namespace
{

vtkSmartPointer<vtkPiecewiseFunction> MakeFunction(
  const std::vector<std::pair<double, double>>& points)
{
  auto function = vtkSmartPointer<vtkPiecewiseFunction>::New();
  for (const auto& point : points)
  {
    function->AddPoint(point.first, point.second);
  }
  return function;
}

/// A step of 100 within a ball of 0.4 and another in a core of it, blurred.
double Shells(int, const ffdTest::Vec3& p)
{
  const double r = 0.5 * ffdTest::Ball(p, { 0.5, 0.48, 0.5 }, 0.8) / 255.0;
  return 110.0 / (1.0 + std::exp(-60.0 * (r - 0.25))) +
    120.0 / (1.0 + std::exp(-60.0 * (r - 0.38)));
}

void CheckOne(ffdTest::Scene& scene, const std::string& name, vtkImageData* image,
  const ffdTest::Transfer& transfer, vtkPiecewiseFunction* gradients, double unit, double step,
  ffdTest::Checks& checks)
{
  scene.SetInput(image);
  scene.SetSampleDistance(step);
  scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
  ffdTest::SetTransfer(scene.Property, transfer, unit);
  scene.Property->ShadeOff();
  scene.Property->SetGradientOpacity(gradients);
  scene.Property->DisableGradientOpacityOn();
  const ffdTest::Picture without = scene.Render(scene.Ours);
  scene.Property->DisableGradientOpacityOff();
  const ffdTest::Picture ours = scene.Render(scene.Ours);
  // VTK 9.1's GPU mapper does not see that the function is enabled again.
  scene.Gpu->Modified();
  scene.Property->Modified();
  const ffdTest::Picture gpu = scene.Render(scene.Gpu);
  const ffdTest::Picture fixed = scene.RenderFixedRays();
  const ffdTest::Distance oursGpu = scene.Compare(ours, gpu);
  const ffdTest::Distance gpuFixed = scene.Compare(gpu, fixed);
  std::ostringstream figures;
  figures << "\n      ours-gpu   " << oursGpu << "\n      ours-fixed " << scene.Compare(ours, fixed)
          << "\n      gpu-fixed  " << gpuFixed;
  checks.Expect(oursGpu.Pixels > 1500 && gpuFixed.Pixels > 1500 &&
      (oursGpu.Mean <= 2.0 || oursGpu.Mean <= gpuFixed.Mean),
    name, figures.str());
  checks.ExpectAtLeast(name + ", matters", scene.Compare(ours, without).Mean, 5.0);
  ffdTest::CheckSamePictures(scene, name, checks);
  scene.SetShadingAsGpuMapper(0.2, 0.7, 0.3, 20.0);
  scene.Gpu->Modified();
  scene.Property->Modified();
  const ffdTest::Distance shaded = scene.Compare(scene.Render(scene.Ours), scene.Render(scene.Gpu));
  checks.Expect(
    shaded.Mean <= 6.0, name + ", shaded", ffdTest::ToString(shaded) + " (mean at most 6)");
  ffdTest::CheckSamePictures(scene, name + ", shaded", checks);
  scene.Property->SetInterpolationTypeToNearest();
  ffdTest::CheckSamePictures(scene, name + ", shaded, nearest", checks);
}

void CheckComponents(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  const auto image = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 2, ffdTest::FourFields);
  scene.SetInput(image);
  scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
  scene.Property->SetInterpolationTypeToLinear();
  ffdTest::SetComponent(
    scene.Property, 0, { { 20, 1.0, 0.2, 0.1, 0.0 }, { 255, 1.0, 0.9, 0.3, 0.3 } });
  ffdTest::SetComponent(
    scene.Property, 1, { { 10, 0.1, 0.3, 1.0, 0.0 }, { 255, 0.9, 1.0, 1.0, 0.3 } });
  const ffdTest::Picture without = scene.Render(scene.Ours);
  // The balls fall by 255 over 0.3 of 39 voxels: 21.8 a voxel, and are flat nowhere but outside.
  scene.Property->SetGradientOpacity(0, MakeFunction({ { 0.0, 0.2 }, { 21.8, 0.8 } }));
  const ffdTest::Picture first = scene.Render(scene.Ours);
  const ffdTest::Distance firstFixed = scene.Compare(first, scene.RenderFixedRays());
  checks.Expect(firstFixed.Pixels > 1500 && firstFixed.Mean <= 2.5, "of the first component",
    ffdTest::ToString(firstFixed) + " from the fixed-point mapper (mean at most 2.5)");
  scene.Property->SetGradientOpacity(1, MakeFunction({ { 0.0, 1.0 }, { 21.8, 0.3 } }));
  const ffdTest::Picture both = scene.Render(scene.Ours);
  const ffdTest::Distance bothFixed = scene.Compare(both, scene.RenderFixedRays());
  checks.Expect(bothFixed.Mean <= 2.5, "of both components",
    ffdTest::ToString(bothFixed) + " from the fixed-point mapper (mean at most 2.5)");
  checks.ExpectAtLeast("the first matters", scene.Compare(first, without).Mean, 2.0);
  checks.ExpectAtLeast("the second matters", scene.Compare(first, both).Mean, 5.0);
  ffdTest::CheckSamePictures(scene, "of both components", checks);
}

/// The closed form: a linear field has one magnitude, so the picture is that of an opacity function
/// times that factor. With sample and unit distances that differ, too.
void CheckLinearField(ffdTest::Scene& scene, ffdTest::Checks& checks)
{
  const auto image = ffdTest::MakeImage(
    30, VTK_FLOAT, 1, [](int, const ffdTest::Vec3& p) { return 29.0 * (0.8 * p[0] + 0.6 * p[2]); });
  scene.SetInput(image);
  scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
  const auto transfer = [](double top) {
    return ffdTest::Transfer{ { 0, 1.0, 0.1, 0.1, 0.0 }, { 45, 0.2, 0.9, 1.0, top } };
  };
  scene.SetSampleDistance(0.5);
  ffdTest::SetTransfer(scene.Property, transfer(0.2), 0.5);
  scene.Property->ShadeOff();
  scene.Property->SetGradientOpacity(MakeFunction({ { 0.0, 0.0 }, { 2.0, 1.0 } }));
  const ffdTest::Picture half = scene.Render(scene.Ours);
  scene.Property->SetGradientOpacity(MakeFunction({ { 0.0, 1.0 } }));
  const ffdTest::Picture whole = scene.Render(scene.Ours);
  ffdTest::SetTransfer(scene.Property, transfer(0.1), 0.5);
  const ffdTest::Distance apart = scene.Compare(half, scene.Render(scene.Ours));
  checks.Expect(apart.Pixels > 1500 && apart.Mean <= 0.2 && apart.Max <= 1.0, "linear field",
    ffdTest::ToString(apart) + " from half the opacity (mean at most 0.2, max 1)");
  checks.ExpectAtLeast("linear field, half matters", scene.Compare(half, whole).Mean, 20.0);
}

} // namespace

int TestGradientOpacity(int argc, char* argv[])
{
  ffdTest::Checks checks;
  {
    ffdTest::Scene scene;
    const auto shells = MakeFunction({ { 2.0, 0.0 }, { 25.0, 1.0 } });
    const ffdTest::Transfer transfer = { { 5, 0.9, 0.5, 0.2, 0.0 }, { 60, 0.9, 0.6, 0.2, 0.2 },
      { 140, 0.3, 0.6, 0.9, 0.3 }, { 230, 1.0, 1.0, 1.0, 0.5 } };
    CheckOne(scene, "shells", ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 1, Shells), transfer,
      shells, 1.0, 1.0, checks);
    CheckOne(scene, "shells, floats", ffdTest::MakeImage(40, VTK_FLOAT, 1, Shells), transfer,
      shells, 2.0, 0.5, checks);
  }
  {
    // Voxels that are not cubes. VTK 9.1's GPU mapper distorts their normals, unless the only light
    // is a headlight, as here.
    ffdTest::Scene scene;
    CheckOne(scene, "engine", ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 3), 0.0),
      ffdTest::SolidEngine(), MakeFunction({ { 5.0, 0.0 }, { 40.0, 1.0 } }), 1.5, 1.5, checks);
  }
  {
    ffdTest::Scene scene;
    CheckOne(scene, "long voxels",
      ffdTest::MakeImage(36, VTK_UNSIGNED_CHAR, 1, Shells, { 1.0, 0.7, 1.6 }),
      { { 5, 0.9, 0.5, 0.2, 0.0 }, { 60, 0.9, 0.6, 0.2, 0.2 }, { 230, 1.0, 1.0, 1.0, 0.5 } },
      MakeFunction({ { 4.0, 0.0 }, { 20.0, 1.0 } }), 1.0, 0.7, checks);
  }
  // The other types, which the fast kernels fetch in other ways.
  for (const int type : { VTK_SHORT, VTK_UNSIGNED_SHORT, VTK_INT, VTK_DOUBLE, VTK_CHAR })
  {
    ffdTest::Scene scene;
    const auto image = ffdTest::MakeImage(
      40, type, 1, [](int c, const ffdTest::Vec3& p) { return 0.5 * Shells(c, p); });
    scene.SetInput(image);
    scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
    ffdTest::SetTransfer(scene.Property,
      { { 2, 0.9, 0.5, 0.2, 0.0 }, { 30, 0.9, 0.6, 0.2, 0.2 }, { 115, 1.0, 1.0, 1.0, 0.5 } }, 1.0);
    scene.Property->SetGradientOpacity(MakeFunction({ { 1.0, 0.0 }, { 12.0, 1.0 } }));
    ffdTest::CheckSamePictures(
      scene, std::string("shells of ") + vtkImageScalarTypeNameMacro(type), checks);
  }
  CheckComponents(checks);
  {
    ffdTest::Scene scene;
    CheckLinearField(scene, checks);
  }
  return checks.Result();
}
