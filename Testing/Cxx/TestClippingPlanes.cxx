// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Clipping planes of the world: without deformation the pictures of VTK's own mappers, with one
// that of the resampled volume, clipped.
#include "FFDTestBlend.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

} // namespace

int TestClippingPlanes(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::AsFloats(ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0));
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  const double middle[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
    0.5 * (bounds[4] + bounds[5]) };
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.0);
  scene.SetInput(image);
  // Short: samples count from other places in each mapper.
  scene.SetSampleDistance(0.2 * voxel);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, bounds);
  const ffdTest::Picture whole = scene.Render(scene.Ours);

  vtkNew<vtkPlane> first;
  first->SetOrigin(middle[0] + 0.11, middle[1], middle[2]);
  first->SetNormal(1.0, 0.4, -0.3);
  vtkNew<vtkPlane> second;
  second->SetOrigin(middle[0], middle[1], middle[2] + 5.2 * voxel);
  second->SetNormal(0.1, 0.0, -3.0); // any length
  const auto compare = [&](const std::string& name) {
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Picture gpu = scene.Render(scene.Gpu);
    const ffdTest::Picture fixed = scene.RenderFixedRays();
    const ffdTest::Distance toFixed = scene.Compare(ours, fixed);
    const ffdTest::Distance toGpu = scene.Compare(ours, gpu);
    const ffdTest::Distance apart = scene.Compare(gpu, fixed);
    std::ostringstream figures;
    figures << "\n      ours-fixed " << toFixed << "\n      ours-gpu   " << toGpu
            << "\n      gpu-fixed  " << apart;
    // VTK's two mappers are each other's yardstick, as in TestIdentityAgainstVTK. Where we are all
    // but equal to the GPU mapper, as with that of VTK 9.5, hundredths decide.
    const double most = apart.Mean + 0.05;
    checks.Expect(toFixed.Pixels > 750 && toFixed.Mean <= most && toGpu.Mean <= most,
      name + ", no farther from them than they are from each other", figures.str());
    return ours;
  };
  ffdTest::ForAllMappers(scene, [&](vtkVolumeMapper* m) { m->AddClippingPlane(first); });
  const ffdTest::Picture one = compare("one plane");
  checks.ExpectAtLeast("one plane, mean change", scene.Compare(one, whole).Mean, 5.0);
  ffdTest::ForAllMappers(scene, [&](vtkVolumeMapper* m) { m->AddClippingPlane(second); });
  const ffdTest::Picture two = compare("two planes");
  checks.ExpectAtLeast("two planes, mean change", scene.Compare(two, one).Mean, 5.0);
  // The planes stay where they are when the volume moves.
  scene.Volume->SetOrientation(10.0, -5.0, 10.0);
  compare("volume turned");
  scene.Volume->SetOrientation(0.0, 0.0, 0.0);
  // A plane that is moved is looked at anew.
  second->SetNormal(0.1, 0.0, 3.0);
  checks.ExpectAtLeast("plane turned around, mean change",
    scene.Compare(compare("plane turned around"), two).Mean, 5.0);
  scene.SetCamera({ 30.0, 30.0, 1.0, true, false }, bounds);
  compare("parallel projection");

  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  scene.Ours->SetDeformation(transform);
  const vtkSmartPointer<vtkImageData> voxels = ffdTest::Resample(image, transform, 0.5, 0.0);
  scene.Gpu->SetInputData(voxels);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, voxels->GetBounds());
  for (const int blend : { Mapper::COMPOSITE_BLEND, Mapper::MAXIMUM_INTENSITY_BLEND })
  {
    ffdTest::SetBlendMode(scene, blend);
    const std::string name = blend == Mapper::COMPOSITE_BLEND ? "composite" : "maximum";
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Distance d = scene.Compare(ours, scene.Render(scene.Gpu));
    checks.Expect(d.Pixels > 1500 && d.Psnr >= 28.0, "deformed, " + name,
      ffdTest::ToString(d) + " from the resampled volume (at least 28 dB)");
    ffdTest::CheckLeaping(scene, "deformed, " + name, true, checks);
    scene.Ours->ReferenceKernelsOn();
    const ffdTest::Distance kernels = scene.Compare(ours, scene.Render(scene.Ours));
    scene.Ours->ReferenceKernelsOff();
    checks.Expect(kernels.Mean <= 0.2, name + ", reference kernels",
      ffdTest::ToString(kernels) + " (mean at most 0.2)");
  }
  ffdTest::SetBlendMode(scene, Mapper::COMPOSITE_BLEND);
  scene.Ours->SetDeformation(nullptr);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, bounds);
  scene.Ours->RemoveAllClippingPlanes();
  checks.ExpectAtMost("removed", scene.Compare(whole, scene.Render(scene.Ours)).Max, 0.0);
  // Nothing is left.
  first->SetOrigin(middle[0] + 1e5, middle[1], middle[2]);
  scene.Ours->AddClippingPlane(first);
  const ffdTest::Bytes none = ffdTest::RenderBytes(scene, 60);
  checks.ExpectAtMost("all clipped: largest byte",
    none.Colors.empty() ? 256 : *std::max_element(none.Colors.begin(), none.Colors.end()), 0);
  return checks.Result();
}
