// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDMassSpring in C++: equilibrium of hanging springs, energy, floor, handle, time.
#include "FFDTestHelpers.h"

#include "vtkFFDMassSpring.h"
#include "vtkImageData.h"

int TestMassSpring(int, char*[])
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 4, 6);
  lattice->SetDomain(0.0, 2.0, 0.0, 1.0, 0.0, 3.0);
  vtkNew<vtkFFDMassSpring> body;
  body->SetLattice(lattice);
  body->SetShearStiffness(0.0);
  body->SetBendStiffness(0.0);
  body->SetStructuralStiffness(50.0);
  body->SetMass(5.0 * 4.0 * 6.0);
  body->SetGravity(0.0, 0.0, -2.0);
  body->PinLayer(2, 5);
  FFD_CHECK(body->SolveEquilibrium() == 1);
  double d[3];
  body->GetLattice()->GetDisplacement(2, 1, 0, d);
  FFD_CHECK_NEAR(d[2], -2.0 / 50.0 * (1 + 2 + 3 + 4 + 5), 1e-9);

  // A random start, with all springs, in both models: no energy comes from nowhere.
  for (int model = 0; model < 2; ++model)
  {
    FFDRandom(4).Shape(lattice, 0.25);
    vtkNew<vtkFFDMassSpring> wild;
    wild->SetLattice(lattice);
    wild->SetModel(model);
    wild->SetGravity(0.0, 0.0, -1.0);
    wild->SetDamping(0.0);
    wild->SetTimeStep(0.05);
    double energy = wild->GetTotalEnergy();
    const double first = energy;
    for (int i = 0; i < 100; ++i)
    {
      FFD_CHECK(wild->Step() == 1);
      const double now = wild->GetTotalEnergy();
      FFD_CHECK(now <= energy + 1e-8 * (1.0 + std::abs(first)));
      energy = now;
    }
    wild->SetHandle(2, 1, 2, 1.0, 0.5, 4.0);
    FFD_CHECK(wild->Step(200) == 1);
    FFD_CHECK(std::isfinite(wild->GetTotalEnergy()));
    wild->ReleaseHandle();
    FFD_CHECK_NEAR(wild->GetTime(), 15.0, 1e-9);
    wild->Reset();
    FFD_CHECK(wild->GetTime() == 0.0 && wild->GetKineticEnergy() == 0.0);
    FFD_CHECK_NEAR(wild->GetTotalEnergy(), first, 1e-12 * first);
    wild->UpdateTimeStep(0.5);
    FFD_CHECK(wild->GetOutput()->GetNumberOfPoints() == 5 * 4 * 6);
    FFD_CHECK_NEAR(wild->GetTime(), 0.5, 1e-12);
  }

  vtkNew<vtkFFDMassSpring> falling;
  falling->SetGravity(0.0, 0.0, -9.81);
  falling->SetStructuralStiffness(500.0);
  falling->FloorOn();
  falling->SetFloorOrigin(0.0, 0.0, -1.0);
  FFD_CHECK(falling->Step(300) == 1);
  double p[3] = { 0.5, 0.5, 0.0 };
  falling->GetLattice()->TransformPoint(p, p);
  FFD_CHECK(p[2] > -1.2 && p[2] < -0.8);

  vtkNew<FFDErrorLog> log;
  log->Watch(falling);
  falling->SetMass(-1.0);
  FFD_CHECK(log->Had("SetMass"));
  falling->Pin(0, 0, 9);
  FFD_CHECK(log->Had("(0, 0, 9)"));
  return EXIT_SUCCESS;
}
