// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The lattice around a bent engine block: a selection with its handle, points behind and within the
// volume dimmed, the deformed outline.
#include "FFDTestScenes.h"

#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeSource.h"

int TestImageLatticeVolume(int argc, char* argv[])
{
  ffdTest::Scene scene(400);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "engine");
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->FitToBounds(image->GetBounds());
  vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::BEND, 0.5);
  scene.SetInput(image);
  scene.Ours->SetDeformation(lattice);
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 1.0);
  scene.SetShading(0.1, 0.7, 0.2, 10.0);
  scene.Volume->SetMapper(scene.Ours);
  vtkNew<vtkFFDLatticeRepresentation> rep;
  rep->SetLattice(lattice);
  rep->SetProp(scene.Volume);
  rep->SetOutlineBounds(image->GetBounds());
  rep->SetRenderer(scene.Renderer);
  scene.Renderer->AddViewProp(rep);
  rep->SelectPoint(5, 2, 4);
  rep->SelectRows(1);
  rep->AddPinAtWorld(rep->GetLattice()->TransformPoint(128.0, 128.0, 60.0));
  scene.SetCamera({ 35.0, 30.0, 1.25, false, false }, rep->GetBounds());
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
