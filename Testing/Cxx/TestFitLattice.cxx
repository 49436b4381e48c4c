// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDFitLattice: landmarks, a field and a transform of the same map give the same lattice.
#include "FFDTestHelpers.h"

#include "vtkDataArray.h"
#include "vtkFFDFitLattice.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"

namespace
{

const double Bounds[6] = { 0.0, 20.0, -5.0, 10.0, 3.0, 11.0 };

double Error(vtkFFDLattice* lattice, vtkAbstractTransform* truth, double margin)
{
  FFDRandom random(6);
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i)
  {
    double p[3];
    double q[3];
    double r[3];
    for (int a = 0; a < 3; ++a)
    {
      const double edge = margin * (Bounds[2 * a + 1] - Bounds[2 * a]);
      p[a] = random.Number(Bounds[2 * a] + edge, Bounds[2 * a + 1] - edge);
    }
    lattice->TransformPoint(p, q);
    truth->TransformPoint(p, r);
    worst = std::max(worst, FFDDistance(q, r));
  }
  return worst;
}

} // namespace

int TestFitLattice(int, char*[])
{
  vtkNew<vtkFFDLattice> truth;
  truth->SetDimensions(5, 5, 5);
  truth->FitToBounds(Bounds, 0.1);
  FFDRandom random(9);
  random.Shape(truth, 0.2);

  vtkNew<vtkFFDFitLattice> fit;
  vtkNew<FFDErrorLog> log;
  log->Watch(fit);
  FFD_CHECK(fit->GetLattice() == nullptr && log->Had("nothing to fit"));
  fit->SetBounds(Bounds);
  fit->SetTolerance(0.01);
  fit->SetTransform(truth);
  FFD_CHECK(fit->GetLattice() != nullptr && fit->GetMaximumError() <= 0.01);
  FFD_CHECK(Error(fit->GetLattice(), truth, 0.0) < 0.02);
  fit->SetTransform(nullptr);

  vtkNew<vtkImageData> field;
  field->SetDimensions(41, 31, 17);
  field->SetOrigin(0.0, -5.0, 3.0);
  field->SetSpacing(0.5, 0.5, 0.5);
  field->AllocateScalars(VTK_DOUBLE, 3);
  for (vtkIdType i = 0; i < field->GetNumberOfPoints(); ++i)
  {
    double p[3];
    double q[3];
    field->GetPoint(i, p);
    truth->TransformPoint(p, q);
    for (int a = 0; a < 3; ++a)
    {
      field->GetPointData()->GetScalars()->SetComponent(i, a, q[a] - p[a]);
    }
  }
  fit->SetInputData(field);
  FFD_CHECK(fit->GetLattice() != nullptr && fit->GetMaximumError() <= 0.01);
  FFD_CHECK(fit->GetRootMeanSquareError() < fit->GetMaximumError());
  FFD_CHECK(Error(fit->GetLattice(), truth, 0.0) < 0.02);
  FFD_CHECK(fit->GetOutput()->GetNumberOfPoints() == fit->GetLattice()->GetNumberOfControlPoints());
  fit->SetInputData(nullptr);

  vtkNew<vtkPoints> source;
  vtkNew<vtkPoints> target;
  source->SetDataTypeToDouble();
  target->SetDataTypeToDouble();
  for (int i = 0; i < 400; ++i)
  {
    double p[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = random.Number(Bounds[2 * a], Bounds[2 * a + 1]);
    }
    source->InsertNextPoint(p);
    truth->TransformPoint(p, p);
    target->InsertNextPoint(p);
  }
  fit->SetSourceLandmarks(source);
  fit->SetTargetLandmarks(target);
  FFD_CHECK(fit->GetLattice() != nullptr && fit->GetMaximumError() <= 0.01);
  FFD_CHECK(Error(fit->GetLattice(), truth, 0.1) < 0.5);
  FFD_CHECK(log->Count == 0);
  target->SetPoint(5, std::nan(""), 0.0, 0.0);
  target->Modified();
  FFD_CHECK(fit->GetLattice() == nullptr && log->Had("not finite"));
  return EXIT_SUCCESS;
}
