// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Opaque spheres before, half inside and behind a bent, semi-transparent engine block.
#include "FFDTestScenes.h"

#include "vtkActor.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"

int TestImageDepthIntermix(int argc, char* argv[])
{
  ffdTest::Scene scene(300);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "engine");
  double bounds[6];
  image->GetBounds(bounds);
  const vtkSmartPointer<vtkBSplineTransform> waves =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(30.0));
  scene.SetInput(image);
  scene.Ours->SetDeformation(waves);
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 3.0);
  double places[3][3] = { { 60.0, -60.0, 130.0 }, { 140.0, 90.0, 60.0 }, { 220.0, 330.0, 0.0 } };
  const double colors[3][3] = { { 0.9, 0.2, 0.2 }, { 0.2, 0.9, 0.2 }, { 0.2, 0.4, 1.0 } };
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(35.0);
  sphere->SetThetaResolution(48);
  sphere->SetPhiResolution(48);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(sphere->GetOutputPort());
  for (int i = 0; i < 3; ++i)
  {
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->SetPosition(places[i]);
    actor->GetProperty()->SetColor(colors[i][0], colors[i][1], colors[i][2]);
    scene.Renderer->AddActor(actor);
  }
  const double all[6] = { 0.0, 255.0, -100.0, 370.0, -80.0, 170.0 };
  scene.SetCamera({ 0.0, 25.0, 1.4, false, false }, all);
  scene.Volume->SetMapper(scene.Ours);
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
