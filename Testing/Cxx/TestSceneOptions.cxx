// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What else is in the scene: opaque geometry before, inside and behind the volume; lights of all
// kinds; interpolation; and that the camera frames the deformed volume. Against VTK's mappers.
#include "FFDTestScenes.h"

#include "vtkActor.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"

#include <string>

namespace
{

void CheckIntermixing(ffdTest::Scene& scene, vtkImageData* image, ffdTest::Checks& checks)
{
  scene.SetInput(image);
  scene.SetSampleDistance(0.5);
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.0);
  scene.Property->ShadeOff();
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(16.0);
  sphere->SetThetaResolution(32);
  sphere->SetPhiResolution(32);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(sphere->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.2, 0.9, 0.3);
  scene.Renderer->AddActor(actor);

  double bounds[6];
  image->GetBounds(bounds);
  const double middle[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
    0.5 * (bounds[4] + bounds[5]) };
  scene.SetCamera({ 0.0, 0.0, 0.8, false, false }, bounds);
  const double depth = bounds[3] - bounds[2];
  ffdTest::Picture before[3];
  const char* const names[3] = { "in front", "inside", "behind" };
  const double offsets[3] = { -0.7, 0.0, 0.7 };
  // Room for the sphere between the clipping planes.
  const double larger[6] = { bounds[0], bounds[1], bounds[2] - depth, bounds[3] + depth, bounds[4],
    bounds[5] };
  scene.Renderer->ResetCameraClippingRange(larger);
  for (int i = 0; i < 3; ++i)
  {
    actor->SetPosition(middle[0], middle[1] + offsets[i] * depth, middle[2]);
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Picture fixed = scene.Render(scene.Fixed);
    const ffdTest::Picture gpu = scene.Render(scene.Gpu);
    const ffdTest::Distance oursFixed = scene.Compare(ours, fixed);
    const ffdTest::Distance gpuFixed = scene.Compare(gpu, fixed);
    std::ostringstream figures;
    figures << "\n      ours-fixed " << oursFixed << "\n      gpu-fixed  " << gpuFixed
            << "\n      ours-gpu   " << scene.Compare(ours, gpu);
    // The window stretches the picture of vtkFixedPointVolumeRayCastMapper by half a pixel, hence
    // a margin: see Scene::RenderFixedRays.
    checks.Expect(oursFixed.Pixels > 1500 && oursFixed.Mean <= 1.1 * gpuFixed.Mean &&
        oursFixed.P99 <= gpuFixed.P99 + 2.0,
      std::string("sphere ") + names[i], figures.str());
    scene.Ours->IntermixIntersectingGeometryOff();
    before[i] = scene.Render(scene.Ours);
    scene.Ours->IntermixIntersectingGeometryOn();
    const double change = scene.Compare(ours, before[i]).Mean;
    checks.Expect(i == 2 || change > 0.2, std::string("intermixing matters, sphere ") + names[i],
      "mean change without " + std::to_string(change));
  }
  scene.Renderer->RemoveActor(actor);
}

/// Lights differ in kind and color; ours against the GPU mapper's and the fixed-point mapper's.
void CheckLights(ffdTest::Scene& scene, vtkImageData* image, ffdTest::Checks& checks)
{
  scene.SetInput(image);
  scene.SetSampleDistance(0.4);
  ffdTest::SetTransfer(scene.Property,
    { { 15, 0.9, 0.7, 0.5, 0.0 }, { 40, 0.9, 0.8, 0.7, 0.5 }, { 255, 1.0, 1.0, 1.0, 0.9 } }, 1.0);
  scene.SetCamera({ 30.0, 25.0, 1.0, false, false }, image->GetBounds());
  scene.Renderer->RemoveAllLights();
  double bounds[6];
  image->GetBounds(bounds);
  const double size = bounds[1] - bounds[0];
  const double middle[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
    0.5 * (bounds[4] + bounds[5]) };

  const auto addLight = [&](double x, double y, double z, double r, double g, double b) {
    auto light = vtkSmartPointer<vtkLight>::New();
    light->SetLightTypeToSceneLight();
    light->SetFocalPoint(middle);
    light->SetPosition(middle[0] + x * size, middle[1] + y * size, middle[2] + z * size);
    light->SetColor(r, g, b);
    scene.Renderer->AddLight(light);
    return light;
  };
  const auto check = [&](const std::string& name, double decibels) {
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    // VTK 9.1's GPU mapper keeps its shader when the kind of a light changes.
    scene.Gpu->Modified();
    scene.Property->Modified();
    const ffdTest::Distance d = scene.Compare(ours, scene.Render(scene.Gpu));
    std::ostringstream figures;
    figures << d << " (at least " << decibels << " dB)";
    checks.Expect(d.Pixels > 1500 && d.Psnr >= decibels, name + ", ours-gpu", figures.str());
    return ours;
  };

  // VTK 9.1's GPU mapper overwrites the specular term of one light by the next: none here.
  scene.SetShadingAsGpuMapper(0.1, 0.8, 0.0, 1.0);
  auto red = addLight(-1.0, -2.0, 0.5, 1.0, 0.2, 0.1);
  const ffdTest::Picture one = check("one colored light", 33.0);
  auto blue = addLight(2.0, -0.5, 1.0, 0.1, 0.3, 1.0);
  const ffdTest::Picture two = check("two colored lights", 33.0);
  checks.Expect(scene.Compare(one, two).Mean > 10.0, "the second light is seen",
    ffdTest::ToString(scene.Compare(one, two)));
  blue->SetIntensity(0.4);
  check("two colored lights, one dimmed", 33.0);
  blue->SetSwitch(0);
  const ffdTest::Distance off = scene.Compare(one, scene.Render(scene.Ours));
  checks.Expect(off.Max == 0.0, "a light switched off is none", ffdTest::ToString(off));
  scene.Renderer->RemoveAllLights();

  // Positional lights stand at the camera: VTK 9.1's GPU mapper takes the place where the ray
  // enters the volume for that of the sample, which makes no difference to the direction there.
  auto lamp = addLight(0.0, 0.0, 0.0, 1.0, 0.9, 0.6);
  lamp->SetPosition(scene.Renderer->GetActiveCamera()->GetPosition());
  lamp->PositionalOn();
  lamp->SetConeAngle(180.0);
  const ffdTest::Picture positional = check("a positional light", 33.0);
  lamp->SetConeAngle(4.0);
  lamp->SetExponent(20.0);
  // Its edge is sharp, and a pixel on it may fall either way.
  const ffdTest::Picture spot = check("a spot light", 25.0);
  checks.Expect(scene.Compare(positional, spot).Mean > 10.0, "the cone is seen",
    ffdTest::ToString(scene.Compare(positional, spot)));
  lamp->SetConeAngle(180.0);
  lamp->SetAttenuationValues(2.0, 0.0, 0.0);
  const ffdTest::Picture halved = check("a positional light, attenuated", 33.0);
  lamp->SetAttenuationValues(1.0, 0.0, 0.0);
  lamp->SetIntensity(0.5);
  const ffdTest::Distance half = scene.Compare(halved, scene.Render(scene.Ours));
  checks.Expect(half.Max <= 1.0, "attenuation by two is half the intensity",
    ffdTest::ToString(half) + " (max at most 1)");
  lamp->SetIntensity(1.0);
  // From so far that the distance is the same for the whole volume, up to two percent.
  lamp->SetPosition(middle[0], middle[1] - 50.0 * size, middle[2]);
  const ffdTest::Picture far = scene.Render(scene.Ours);
  lamp->SetAttenuationValues(0.0, 1.0 / (50.0 * size), 0.0);
  const ffdTest::Distance linear = scene.Compare(far, scene.Render(scene.Ours));
  checks.Expect(linear.Max <= 6.0, "linear attenuation by one", ffdTest::ToString(linear));
  lamp->SetAttenuationValues(0.0, 0.0, 1.0 / (2500.0 * size * size));
  const ffdTest::Distance quadratic = scene.Compare(far, scene.Render(scene.Ours));
  checks.Expect(
    quadratic.Max <= 12.0, "quadratic attenuation by one", ffdTest::ToString(quadratic));
  lamp->SetAttenuationValues(0.0, 0.0, 2.0 / (2500.0 * size * size));
  const ffdTest::Distance twice = scene.Compare(far, scene.Render(scene.Ours));
  checks.Expect(twice.Mean > 10.0, "quadratic attenuation by two", ffdTest::ToString(twice));
  scene.Renderer->RemoveAllLights();

  // Two-sided lighting: from behind, only the diffuse light of back faces is left.
  addLight(1.0, 2.0, -0.5, 1.0, 1.0, 1.0);
  scene.Renderer->TwoSidedLightingOn();
  const ffdTest::Picture both = scene.Render(scene.Ours);
  scene.Renderer->TwoSidedLightingOff();
  const ffdTest::Picture front = check("a light from behind, one-sided", 30.0);
  checks.Expect(scene.Compare(both, front).Mean > 10.0, "two-sided lighting lights the other side",
    ffdTest::ToString(scene.Compare(both, front)));
  scene.Renderer->TwoSidedLightingOn();
  scene.Renderer->RemoveAllLights();
  scene.Renderer->AddLight(scene.Headlight);
}

void CheckInterpolation(ffdTest::Scene& scene, vtkImageData* image, ffdTest::Checks& checks)
{
  scene.SetInput(image);
  scene.SetSampleDistance(0.25);
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.0);
  scene.Property->ShadeOff();
  scene.SetCamera({ 30.0, 25.0, 2.0, false, false }, image->GetBounds());
  const ffdTest::Picture linear = scene.Render(scene.Ours);
  const ffdTest::Distance linearGpu = scene.Compare(linear, scene.Render(scene.Gpu));
  scene.Property->SetInterpolationTypeToNearest();
  const ffdTest::Picture nearest = scene.Render(scene.Ours);
  const ffdTest::Distance nearestGpu = scene.Compare(nearest, scene.Render(scene.Gpu));
  checks.Expect(linearGpu.Psnr >= 35.0, "linear interpolation, ours-gpu",
    ffdTest::ToString(linearGpu) + " (at least 35 dB)");
  checks.Expect(nearestGpu.Psnr >= 35.0, "nearest interpolation, ours-gpu",
    ffdTest::ToString(nearestGpu) + " (at least 35 dB)");
  const ffdTest::Distance change = scene.Compare(nearest, linear);
  checks.Expect(change.Mean > 2.0 * nearestGpu.Mean, "the two differ", ffdTest::ToString(change));
  scene.Property->SetInterpolationTypeToLinear();
}

/// ResetCamera frames the bulge: the picture is whole, though it leaves the bounds at rest.
void CheckBounds(ffdTest::Scene& scene, vtkImageData* image, ffdTest::Checks& checks)
{
  scene.SetInput(image);
  scene.SetSampleDistance(1.0);
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 1.0);
  scene.SetShadingAsGpuMapper(0.1, 0.7, 0.2, 10.0);
  double rest[6];
  image->GetBounds(rest);
  const vtkSmartPointer<vtkBSplineTransform> bulge =
    ffdTest::MakeTransform(rest, 8, [](const ffdTest::Vec3&, const ffdTest::Vec3& r) {
      return ffdTest::Vec3{ 90.0 * std::sin(vtkMath::Pi() * r[2]), 0.0, 40.0 * r[0] };
    });
  scene.Volume->SetMapper(scene.Ours);
  for (const int mode : { 0, 1, 2 })
  {
    scene.Ours->SetInverseMode(mode);
    scene.Ours->SetDeformation(bulge);
    const std::string name = std::string("bulge, ") + scene.Ours->GetInverseModeAsString();
    double bounds[6];
    scene.Ours->GetBounds(bounds);
    vtkCamera* camera = scene.Renderer->GetActiveCamera();
    camera->SetParallelProjection(0);
    camera->SetViewAngle(30.0);
    camera->SetFocalPoint(0.0, 0.0, 0.0);
    camera->SetPosition(0.0, -1.0, 0.0);
    camera->SetViewUp(0.0, 0.0, 1.0);
    scene.Renderer->ResetCamera();
    const ffdTest::Picture framed = scene.Render(scene.Ours);
    const std::array<unsigned char, 3> background = scene.GetBackground();
    int border = 0;
    for (int y = 0; y < framed.Height; ++y)
    {
      for (int x = 0; x < framed.Width; ++x)
      {
        if (x == 0 || y == 0 || x == framed.Width - 1 || y == framed.Height - 1)
        {
          const unsigned char* p = &framed.Rgb[3 * static_cast<std::size_t>(y * framed.Width + x)];
          border += p[0] != background[0] || p[1] != background[1] || p[2] != background[2];
        }
      }
    }
    checks.Expect(border == 0, name, std::to_string(border) + " pixels at the border of the image");
    // Not clipped: with room on all sides and between the clipping planes nothing is added.
    double range[2];
    camera->GetClippingRange(range);
    camera->SetClippingRange(0.3 * range[0], 3.0 * range[1]);
    const ffdTest::Distance clipped = scene.Compare(framed, scene.Render(scene.Ours));
    checks.Expect(clipped.Pixels > 1000 && clipped.Psnr > 28.0, name + ", clipping range",
      ffdTest::ToString(clipped) + " (other samples; at least 28 dB)");
    // What the bounds at rest would have cut off.
    scene.Renderer->ResetCamera(rest);
    const bool larger = bounds[1] > rest[1] + 20.0 || bounds[0] < rest[0] - 20.0;
    std::ostringstream figures;
    figures << "x from " << bounds[0] << " to " << bounds[1] << ", at rest " << rest[0] << " to "
            << rest[1];
    checks.Expect(larger, name + ", bounds", figures.str());
  }
  scene.Ours->SetInverseModeToExact();
  scene.Ours->SetDeformation(nullptr);
}

} // namespace

int TestSceneOptions(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(140);
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0);
  CheckIntermixing(scene, image, checks);
  // VTK 9.1's GPU mapper distorts normals of volumes that are not cubes, unless the only light is a
  // headlight.
  CheckLights(scene, ffdTest::ReadVolume(argc, argv, "hydrogen", 2), checks);
  CheckInterpolation(scene, image, checks);
  CheckBounds(scene, image, checks);
  return checks.Result();
}
