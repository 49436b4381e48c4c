// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Without deformation the picture is the one that exact interpolation gives: that of
// vtkOpenGLGPUVolumeRayCastMapper on floats, whose textures of bytes are less exact.
// vtkFixedPointVolumeRayCastMapper, which rounds interpolated whole numbers up and quantizes
// normals, is the yardstick: on the data as they are we are at most half as far from the GPU mapper
// on floats.
// - With functions that suit the volumes, unshaded, shaded with VTK's default light, and shaded
//   with a light of white ambient color, which brings VTK's two mappers closer. Unshaded, the
//   picture is that of a plain ray caster in double precision, too, see RenderExactly.
// - With a steep opacity function on all volumes, where half a unit would show, with long and short
//   steps.
// Settings are equal, in one process, with Mesa's software rasterizer. The rays of
// vtkFixedPointVolumeRayCastMapper are compared as they are: in a window it stretches its picture
// by up to half a pixel.
#include "FFDTestScenes.h"

#include <algorithm>
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
};

enum class Light
{
  Unshaded,
  Plain,
  WhiteAmbient
};

/// The image for all mappers, as floats for the GPU mapper.
void SetInputs(ffdTest::Scene& scene, vtkImageData* image)
{
  scene.SetInput(image);
  scene.Gpu->SetInputData(ffdTest::AsFloats(image));
}

/// Ours is at most half as far from the GPU mapper as VTK's other mapper.
void CheckHalfAsFar(ffdTest::Scene& scene, const ffdTest::Picture& ours,
  const ffdTest::Picture& fixed, const std::string& name, ffdTest::Checks& checks)
{
  const ffdTest::Picture gpu = scene.Render(scene.Gpu);
  const ffdTest::Distance oursGpu = scene.Compare(ours, gpu);
  const ffdTest::Distance gpuFixed = scene.Compare(gpu, fixed);
  std::ostringstream figures;
  figures << "ours-gpu " << oursGpu << ", fixed-gpu " << gpuFixed << " (at most half the mean)";
  checks.Expect(
    gpuFixed.Pixels > 250 && oursGpu.Mean <= 0.5 * gpuFixed.Mean && oursGpu.P99 <= gpuFixed.P99,
    name, figures.str());
}

void CheckCase(ffdTest::Scene& scene, vtkImageData* image, vtkAbstractTransform* identity,
  const std::string& volume, const Case& c, ffdTest::Checks& checks)
{
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
      scene.SetShadingAsGpuMapper(c.Material[0], c.Material[1], c.Material[2], c.Material[3]);
    }
    else
    {
      scene.Property->ShadeOff();
    }
    scene.Ours->SetDeformation(nullptr);
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Picture fixed = scene.RenderFixedRays();

    const char* const lights[] = { ", unshaded", ", shaded", ", shaded, white ambient light" };
    const std::string name = volume + ", " + c.Name + lights[static_cast<int>(light)] + ", step " +
      std::to_string(step).substr(0, 4);
    CheckHalfAsFar(scene, ours, fixed, name, checks);
    if (!shaded)
    {
      const ffdTest::Distance exact =
        scene.Compare(ours, ffdTest::RenderExactly(scene, image, c.SampleDistance));
      // Rounding to bytes, and the light that early ray termination leaves out: 1/255.
      checks.Expect(exact.Mean <= 1.0 && exact.P99 <= 2.0, name + ", exact",
        ffdTest::ToString(exact) + " (mean at most 1, p99 2)");
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
  SetInputs(scene, image);
  for (const Case& c : cases)
  {
    CheckCase(scene, image, identity, name, c, checks);
  }
}

/// Opacity from 0 to 0.9 over 20 of 255 parts of the range.
void CheckSteep(
  ffdTest::Scene& scene, vtkImageData* image, const std::string& volume, ffdTest::Checks& checks)
{
  SetInputs(scene, image);
  scene.Ours->SetDeformation(nullptr);
  scene.SetWhiteAmbientLight(false);
  const double unit = image->GetScalarRange()[1] / 255.0;
  const double* spacing = image->GetSpacing();
  const double voxel = std::min({ spacing[0], spacing[1], spacing[2] });
  ffdTest::SetTransfer(scene.Property,
    { { 0.0, 0.2, 0.3, 0.9, 0.0 }, { 40.0 * unit, 0.3, 0.4, 0.7, 0.0 },
      { 60.0 * unit, 0.9, 0.6, 0.2, 0.9 }, { 255.0 * unit, 1.0, 1.0, 1.0, 0.9 } },
    voxel);
  scene.SetCamera({ 30.0, 20.0, 1.0, false, false }, image->GetBounds());
  for (const bool shaded : { false, true })
  {
    scene.SetShadingAsGpuMapper(0.1, 0.7, 0.2, 10.0);
    scene.Property->SetShade(shaded);
    for (const double step : { 1.0, 0.4 })
    {
      scene.SetSampleDistance(step * voxel);
      const std::string name = volume + ", steep" + (shaded ? ", shaded" : "") + ", step " +
        std::to_string(step).substr(0, 4);
      CheckHalfAsFar(scene, scene.Render(scene.Ours), scene.RenderFixedRays(), name, checks);
    }
  }
}

} // namespace

int TestIdentityAgainstVTK(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(100);
  for (const char* name : { "cthead", "engine", "fuel", "headsq", "hydrogen", "neghip", "nucleon" })
  {
    CheckSteep(scene, ffdTest::ReadVolume(argc, argv, name), name, checks);
  }
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
        { 75.0, 10.0, 1.0, false, true } } },
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
