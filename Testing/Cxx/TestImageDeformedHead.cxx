// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// A head, its jaw drawn in and its crown drawn out: skin, with anisotropic voxels.
#include "FFDTestScenes.h"

int TestImageDeformedHead(int argc, char* argv[])
{
  ffdTest::Scene scene(300);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "cthead");
  double bounds[6];
  image->GetBounds(bounds);
  // Slices run from the crown down.
  const vtkSmartPointer<vtkBSplineTransform> taper = ffdTest::MakeTransform(bounds, 8,
    [](const ffdTest::Vec3&, const ffdTest::Vec3& r)
    {
      const double wider = 0.35 - 0.7 * r[2];
      return ffdTest::Vec3{ 255.0 * wider * (r[0] - 0.5), 127.0 * wider * (r[1] - 0.5),
        -40.0 * (1.0 - r[2]) * std::sin(vtkMath::Pi() * r[0]) };
    });
  scene.SetInput(image);
  scene.Ours->SetDeformation(taper);
  ffdTest::SetTransfer(scene.Property, ffdTest::HeadSkin(), 1.0);
  scene.SetShading(0.1, 0.7, 0.2, 10.0);
  scene.SetCamera({ 30.0, 0.0, 1.0, false, false }, scene.Ours->GetBounds());
  scene.Renderer->GetActiveCamera()->Roll(180.0);
  scene.Volume->SetMapper(scene.Ours);
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
