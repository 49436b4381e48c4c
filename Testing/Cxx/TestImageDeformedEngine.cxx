// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// An engine block bent to the side: its edges are curves, its bores stay round.
#include "FFDTestScenes.h"

int TestImageDeformedEngine(int argc, char* argv[])
{
  ffdTest::Scene scene(300);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "engine");
  double bounds[6];
  image->GetBounds(bounds);
  const vtkSmartPointer<vtkBSplineTransform> bend = ffdTest::MakeTransform(bounds, 8,
    [](const ffdTest::Vec3&, const ffdTest::Vec3& r)
    { return ffdTest::Vec3{ 50.0 * std::cos(vtkMath::Pi() * (r[2] - 0.5)), 0.0, 0.0 }; });
  scene.SetInput(image);
  scene.Ours->SetDeformation(bend);
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 1.0);
  scene.SetShading(0.1, 0.7, 0.2, 10.0);
  scene.SetCamera({ 20.0, 20.0, 1.0, false, false }, scene.Ours->GetBounds());
  scene.Volume->SetMapper(scene.Ours);
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
