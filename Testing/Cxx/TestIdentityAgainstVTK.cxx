// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Without deformation the picture is that of VTK's own volume mappers. The two of them differ
// from each other, by rounding and by where they put samples, so they are each other's yardstick.
// Unshaded:
// - our picture is that of a plain ray caster in double precision, see RenderExactly;
// - we are no farther from vtkFixedPointVolumeRayCastMapper than vtkOpenGLGPUVolumeRayCastMapper
//   is. The rays of the former are compared as they are: in a window it stretches its picture by
//   up to half a pixel.
// Shaded:
// - we are at most half as far from vtkOpenGLGPUVolumeRayCastMapper as
//   vtkFixedPointVolumeRayCastMapper, which quantizes its normals, is: with VTK's default light at
//   the sample distance of the unshaded pictures; and with a light of white ambient colour, which
//   brings VTK's two mappers closer, at shorter ones: we take the samples of
//   vtkFixedPointVolumeRayCastMapper, the GPU mapper takes others, and with long steps that hides
//   the shading.
// Settings are equal, in one process, with Mesa's software rasteriser.
#include "FFDTestScenes.h"

#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace
{

struct Case
{
  std::string Name;
  ffdTest::Transfer Points;
  double Unit;
  double SampleDistance;
  double ShadedSampleDistance;
  std::array<double, 4> Material; // ambient, diffuse, specular, power
  ffdTest::View Camera;
  /// How much farther than the GPU mapper we may be, mean. From inside, with every ray opaque, early
  /// ray termination shows: after 1/255 in ours and the GPU's, after 1/128 in the other.
  double Margin = 0.0;
};

enum class Light
{
  Unshaded,
  Plain,
  WhiteAmbient
};

void CheckCase(ffdTest::Scene& scene, vtkImageData* image, vtkAbstractTransform* identity,
  const std::string& volume, const Case& c, ffdTest::Checks& checks)
{
  scene.SetInput(image);
  ffdTest::SetTransfer(scene.Property, c.Points, c.Unit);
  scene.SetCamera(c.Camera, image->GetBounds());
  for (const Light light : { Light::Unshaded, Light::Plain, Light::WhiteAmbient })
  {
    const bool shaded = light != Light::Unshaded;
    const double step = light == Light::WhiteAmbient ? c.ShadedSampleDistance : c.SampleDistance;
    scene.SetSampleDistance(step);
    scene.SetWhiteAmbientLight(light == Light::WhiteAmbient);
    if (shaded)
    {
      scene.SetShading(c.Material[0], c.Material[1], c.Material[2], c.Material[3]);
    }
    else
    {
      scene.Property->ShadeOff();
    }
    scene.Ours->SetDeformation(nullptr);
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Picture fixed = scene.RenderFixedRays();
    const ffdTest::Picture gpu = scene.Render(scene.Gpu);

    const char* const lights[] = { ", unshaded", ", shaded", ", shaded, white ambient light" };
    const std::string name = volume + ", " + c.Name + lights[static_cast<int>(light)] + ", step " +
      std::to_string(step).substr(0, 4);
    const ffdTest::Distance oursFixed = scene.Compare(ours, fixed);
    const ffdTest::Distance oursGpu = scene.Compare(ours, gpu);
    const ffdTest::Distance gpuFixed = scene.Compare(gpu, fixed);
    std::ostringstream figures;
    figures << "\n      ours-fixed " << oursFixed << "\n      ours-gpu   " << oursGpu
            << "\n      gpu-fixed  " << gpuFixed;
    const bool visible = gpuFixed.Pixels > 3000;
    if (shaded)
    {
      checks.Expect(visible && oursGpu.Mean <= 0.5 * gpuFixed.Mean && oursGpu.P99 <= gpuFixed.P99,
        name, figures.str());
    }
    else
    {
      const ffdTest::Picture exact = ffdTest::RenderExactly(scene, image, c.SampleDistance);
      const ffdTest::Distance oursExact = scene.Compare(ours, exact);
      const ffdTest::Distance fixedExact = scene.Compare(fixed, exact);
      figures << "\n      ours-exact " << oursExact << "\n      fixed-exact " << fixedExact
              << "\n      gpu-exact  " << scene.Compare(gpu, exact);
      // Rounding to bytes, and the light that early ray termination leaves out: 1/255.
      checks.Expect(oursExact.Mean <= 1.0 && oursExact.P99 <= 2.0, name + ", exact",
        ffdTest::ToString(oursExact) + " (mean at most 1, p99 2)");
      checks.Expect(visible && oursFixed.Mean <= gpuFixed.Mean + c.Margin &&
          oursFixed.P99 <= gpuFixed.P99,
        name, figures.str());
    }
    // The lattice evaluates to the position itself up to rounding, so bytes may round either way.
    if (shaded)
    {
      scene.Ours->SetDeformation(identity);
      const ffdTest::Distance lattice = scene.Compare(ours, scene.Render(scene.Ours));
      checks.Expect(lattice.Mean <= 0.01 && lattice.Max <= 1.0, name + ", identity lattice",
        ffdTest::ToString(lattice) + " (mean at most 0.01, max 1)");
    }
  }
}

void CheckVolume(ffdTest::Scene& scene, vtkImageData* image, const std::string& name,
  const std::vector<Case>& cases, ffdTest::Checks& checks)
{
  const vtkSmartPointer<vtkBSplineTransform> identity =
    ffdTest::MakeTransform(image->GetBounds(), 6, [](const ffdTest::Vec3&, const ffdTest::Vec3&) {
      return ffdTest::Vec3{ 0.0, 0.0, 0.0 };
    });
  for (const Case& c : cases)
  {
    CheckCase(scene, image, identity, name, c, checks);
  }
}

} // namespace

int TestIdentityAgainstVTK(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  const std::array<double, 4> plain = { 0.1, 0.7, 0.2, 10.0 };
  const std::array<double, 4> shiny = { 0.2, 0.6, 0.5, 40.0 };
  const std::array<double, 4> matt = { 0.3, 0.8, 0.0, 1.0 };

  CheckVolume(scene, ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine"), 0), "engine",
    { { "semi-transparent, perspective", ffdTest::SemiTransparentEngine(), 1.0, 1.0, 0.5, plain,
        { 30.0, 30.0, 1.0, false, false } },
      { "solid, perspective", ffdTest::SolidEngine(), 1.0, 0.5, 0.5, shiny,
        { 120.0, -35.0, 1.0, false, false } },
      { "solid, parallel", ffdTest::SolidEngine(), 2.5, 0.7, 0.25, matt,
        { -50.0, 60.0, 1.2, true, false } },
      { "sparse, parallel", ffdTest::SparseEngine(), 1.0, 1.0, 0.25, plain,
        { 20.0, 15.0, 1.5, true, false } },
      { "semi-transparent, inside", ffdTest::SemiTransparentEngine(), 4.0, 0.5, 0.5, plain,
        { 75.0, 10.0, 1.0, false, true }, 0.1 } },
    checks);

  CheckVolume(scene, ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "cthead"), 0), "cthead",
    { { "skin and bone, perspective", ffdTest::HeadSkinAndBone(), 1.0, 0.7, 0.7, plain,
        { 40.0, 20.0, 1.0, false, false } },
      { "skin, perspective", ffdTest::HeadSkin(), 0.5, 1.0, 1.0, shiny,
        { -20.0, -30.0, 1.1, false, false } },
      { "bone, parallel", ffdTest::HeadBone(), 1.0, 0.5, 0.5, matt,
        { 150.0, 10.0, 1.0, true, false } } },
    checks);

  CheckVolume(scene, ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "headsq"), 0), "headsq",
    { { "soft, parallel", ffdTest::HeadsqSoft(), 1.0, 1.0, 1.0, plain,
        { 60.0, 20.0, 1.0, true, false } },
      { "skin, perspective", ffdTest::HeadsqSkin(), 2.0, 0.5, 0.5, shiny,
        { -30.0, 10.0, 1.0, false, false } },
      { "bone, perspective", ffdTest::HeadsqBone(), 1.0, 0.7, 0.7, plain,
        { 200.0, -20.0, 1.3, false, false } } },
    checks);
  return checks.Result();
}
