// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// An engine block, semi-transparent, in waves, seen in parallel projection: first-order inverse.
#include "FFDTestScenes.h"

int TestImageSemiTransparentEngine(int argc, char* argv[])
{
  ffdTest::Scene scene(300);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "engine");
  const vtkSmartPointer<vtkBSplineTransform> waves =
    ffdTest::MakeTransform(image->GetBounds(), 8, ffdTest::BendAndWaves(30.0));
  scene.SetInput(image);
  scene.Ours->SetDeformation(waves);
  scene.Ours->SetInverseModeToFirstOrder();
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.5);
  scene.SetCamera({ 35.0, 40.0, 1.0, true, false }, scene.Ours->GetBounds());
  scene.Volume->SetMapper(scene.Ours);
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
