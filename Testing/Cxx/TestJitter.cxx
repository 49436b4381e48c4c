// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Jittering trades the rings of coarse samples for noise: averaged over a few pixels the picture is
// nearer to that of very many samples. The noise is the same every time.
#include "FFDTestBlend.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

/// Averages over 5 x 5 pixels.
ffdTest::Picture Blurred(const ffdTest::Picture& in)
{
  ffdTest::Picture out = in;
  constexpr int R = 2;
  for (int y = R; y + R < in.Height; ++y)
  {
    for (int x = R; x + R < in.Width; ++x)
    {
      for (int c = 0; c < 3; ++c)
      {
        int sum = 0;
        for (int i = 0; i < (2 * R + 1) * (2 * R + 1); ++i)
        {
          const int at = (y + i / (2 * R + 1) - R) * in.Width + x + i % (2 * R + 1) - R;
          sum += in.Rgb[static_cast<std::size_t>(3 * at + c)];
        }
        out.Rgb[static_cast<std::size_t>(3 * (y * in.Width + x) + c)] =
          static_cast<unsigned char>(sum / ((2 * R + 1) * (2 * R + 1)));
      }
    }
  }
  return out;
}

} // namespace

int TestJitter(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(200);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "engine", 2);
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 1.0);
  scene.SetShading(0.2, 0.7, 0.1, 10.0);
  scene.SetInput(image);
  checks.Expect(scene.Ours->GetUseJittering() == 0, "default", "off");
  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  for (const bool deformed : { false, true })
  {
    for (const int segmentation : { Mapper::ERROR_BOUND, Mapper::GREEDY_ANGLE })
    {
      scene.Ours->SetDeformation(deformed ? transform : nullptr);
      scene.Ours->SetSegmentation(segmentation);
      scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, scene.Ours->GetBounds());
      const std::string name =
        std::string(deformed ? "deformed, " : "at rest, ") + scene.Ours->GetSegmentationAsString();
      scene.SetSampleDistance(0.05 * voxel);
      const ffdTest::Picture fine = scene.Render(scene.Ours);
      scene.SetSampleDistance(2.0 * voxel);
      const ffdTest::Picture rings = scene.Render(scene.Ours);
      scene.Ours->UseJitteringOn();
      const ffdTest::Picture noise = scene.Render(scene.Ours);
      checks.ExpectAtLeast(name + ", mean change", scene.Compare(rings, noise).Mean, 1.0);
      checks.ExpectAtMost(
        name + ", once more", scene.Compare(noise, scene.Render(scene.Ours)).Max, 0.0);
      const double before = scene.Compare(Blurred(rings), Blurred(fine)).Mean;
      const double after = scene.Compare(Blurred(noise), Blurred(fine)).Mean;
      checks.ExpectAtMost(
        name + ", mean distance from many samples, averaged", after, 0.95 * before);
      ffdTest::CheckLeaping(scene, name, true, checks);
      if (segmentation == Mapper::ERROR_BOUND)
      {
        scene.Ours->ReferenceKernelsOn();
        const ffdTest::Distance kernels = scene.Compare(noise, scene.Render(scene.Ours));
        scene.Ours->ReferenceKernelsOff();
        checks.Expect(kernels.Mean <= 0.5, name + ", reference kernels",
          ffdTest::ToString(kernels) + " (mean at most 0.5)");
      }
      scene.Ours->UseJitteringOff();
    }
  }
  scene.Ours->SetSegmentationToErrorBound();

  // Surfaces and slices are exact.
  scene.Property->GetIsoSurfaceValues()->SetValue(0, 120.0);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(image->GetCenter());
  plane->SetNormal(1.0, 1.0, 0.5);
  scene.Property->SetSliceFunction(plane);
  for (const int blend : { Mapper::ISOSURFACE_BLEND, Mapper::SLICE_BLEND })
  {
    scene.Ours->SetBlendMode(blend);
    const ffdTest::Picture off = scene.Render(scene.Ours);
    scene.Ours->UseJitteringOn();
    checks.ExpectAtMost(blend == Mapper::SLICE_BLEND ? "slice" : "isosurface",
      scene.Compare(off, scene.Render(scene.Ours)).Max, 0.0);
    scene.Ours->UseJitteringOff();
  }
  return checks.Result();
}
