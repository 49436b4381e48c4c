// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Curved lattice lines of a twisted lattice, the warning color of the fold guard, the handle that
// turns, proportional editing, locked points, a constraint, no interior.
#include "FFDTestScenes.h"

#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeSource.h"

int TestImageLatticeCurved(int argc, char* argv[])
{
  ffdTest::Scene scene(400);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(7, 6, 5);
  lattice->SetDomain(0.0, 40.0, 0.0, 30.0, 0.0, 20.0);
  vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::TWIST, 0.7);
  scene.Renderer->RemoveVolume(scene.Volume);
  vtkNew<vtkFFDLatticeRepresentation> rep;
  rep->SetLattice(lattice);
  rep->SetRenderer(scene.Renderer);
  scene.Renderer->AddViewProp(rep);
  rep->SetLineMode(vtkFFDLatticeRepresentation::CURVED);
  rep->InteriorVisibilityOff();
  rep->SetHandleSize(12.0);
  rep->SetHandleMode(vtkFFDLatticeRepresentation::HANDLE_ROTATE);
  rep->SetFoldGuard(vtkFFDLatticeRepresentation::GUARD_WARN);
  rep->SetMinimumDeterminant(0.9);
  rep->ProportionalEditingOn();
  rep->SetConstraint(vtkFFDLatticeRepresentation::ALONG_Y);
  rep->LockBoundaryOn();
  rep->SetLockedLayers(1);
  rep->SelectPoint(6, 5, 4);
  rep->SelectPoint(5, 5, 4, vtkFFDLatticeRepresentation::ADD);
  rep->TranslateSelection(-30.0, 0.0, 0.0); // nothing: both are locked
  rep->SetLockedLayers(0);
  rep->TranslateSelection(-30.0, 0.0, 0.0);
  rep->SetLockedLayers(1);
  scene.SetCamera({ 25.0, 35.0, 0.9, false, false }, rep->GetBounds());
  return ffdTest::CompareWithBaseline(scene, argc, argv);
}
