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
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 0.7);
  double places[3][3] = { { 60.0, -60.0, 60.0 }, { 140.0, 90.0, 60.0 }, { 220.0, 330.0, 60.0 } };
  const double colours[3][3] = { { 0.9, 0.2, 0.2 }, { 0.2, 0.9, 0.2 }, { 0.2, 0.4, 1.0 } };
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
    actor->GetProperty()->SetColor(colours[i][0], colours[i][1], colours[i][2]);
    scene.Renderer->AddActor(actor);
  }
  const double all[6] = { 0.0, 255.0, -100.0, 370.0, 0.0, 150.0 };
  scene.SetCamera({ 0.0, 25.0, 1.0, false, false }, all);
  scene.Volume->SetMapper(scene.Ours);
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
